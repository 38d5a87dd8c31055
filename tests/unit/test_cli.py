"""The command line as a user meets it: exit codes, messages, Ctrl-C, no traceback."""

import json
import os
import signal
import subprocess
import sys
import tracemalloc
from pathlib import Path

import pytest

from extrados.decks.reader import DeckError, read_text
from extrados.results import store
from extrados.results.model import TableData

ROOT = Path(__file__).resolve().parents[2]
ARCH = '[structure]\nkind = "arch"\nradius = 10.0\nthickness = 1.5\nembrace = 157.5\nvoussoirs = 7\n'


def extrados(*args: str | bytes, cwd: Path | None = None, **more) -> subprocess.CompletedProcess:
    how = {"capture_output": True, "text": True, "cwd": cwd, **more}
    return subprocess.run([sys.executable, "-m", "extrados", *args], **how)


#: Decks whose programmes HiGHS and Clarabel solve
SOLVED_BY = {
    "HiGHS": """structure = { kind = "brickwork", units = 3, courses = 3, unit_length = 0.4, unit_height = 0.175 }
joints.friction = 0.6
analysis = { kind = "tilt", friction_rule = "non-associated", starts = 1 }
""",
    "Clarabel": """structure = { kind = "column", width = 0.8, height = 2.0, drums = 2 }
joints.friction = 0.6
analysis = { kind = "tilt", direction = 20.0, starts = 1 }
""",
}


@pytest.mark.parametrize("library", SOLVED_BY)
def test_no_library_adds_to_what_is_printed(tmp_path, library: str) -> None:
    """Releases of solvers may greet on standard output, as HiGHS 1.16.0 does."""
    path = deck(tmp_path, SOLVED_BY[library])
    run = extrados("run", path, "--json", "--no-figures", "--out", str(tmp_path / "o"))
    assert json.loads(run.stdout)["analyses"][0]["status"] == "ok" and not run.stderr


def deck(tmp_path: Path, text: str) -> str:
    path = tmp_path / "deck.toml"
    path.write_text(text)
    return str(path)


def test_readme_deck(tmp_path) -> None:
    run = extrados("run", str(ROOT / "cases" / "arch" / "readme.toml"), "--out", str(tmp_path / "o"))
    assert run.returncode == 0, run.stderr
    assert "The arch rocks and recovers" in run.stdout and "primary impulse" in run.stdout
    page = (tmp_path / "o" / "report.html").read_text()
    assert "http://" not in page.replace("http://www.w3.org", "") and "<script" not in page
    assert page.count("data:image/svg+xml") >= 4
    for name in ("summary.json", "results.h5", "rocking.csv", "figures/rocking-history.png"):
        assert (tmp_path / "o" / name).stat().st_size > 0


@pytest.mark.parametrize("command", ['"$1" -m extrados run - < deck.toml', '"$1" -m extrados run <(cat deck.toml)'])
def test_a_deck_comes_from_a_pipe(command: str, tmp_path: Path) -> None:
    """Its files are looked for in the current folder, its results are below results/stdin."""
    deck(tmp_path, ARCH + '[motion]\nkind = "record"\nfile = "motion.csv"\n[analysis]\nkind = "tilt"\n')
    (tmp_path / "motion.csv").write_text("time [s],acceleration [g]\n" + "".join(f"{0.01 * k:.2f},0.1\n" for k in range(50)))
    for words, code, said in (("", 0, "Results: results/stdin"), ("tlit", 2, "stdin:11: analysis.kind: unknown kind 'tlit'")):
        if words:
            (tmp_path / "deck.toml").write_text((tmp_path / "deck.toml").read_text().replace("tilt", words))
        done = subprocess.run(
            ["bash", "-c", f"{command} --no-figures", "bash", sys.executable], cwd=tmp_path, capture_output=True, text=True, timeout=120
        )
        assert done.returncode == code and said in done.stdout + done.stderr, done.stdout + done.stderr


def test_a_pipe_that_never_ends_is_no_deck(tmp_path: Path) -> None:
    done = subprocess.run(
        ["bash", "-c", 'yes | "$1" -m extrados check -', "bash", sys.executable], cwd=tmp_path, capture_output=True, text=True, timeout=120
    )
    assert done.returncode == 2 and "more than 1 MB" in done.stderr


def test_exit_codes(tmp_path) -> None:
    wrong = extrados("run", deck(tmp_path, ARCH + '[analysis]\nkind = "tlit"\n'))
    assert wrong.returncode == 2 and "deck.toml:8: analysis.kind" in wrong.stderr and "Traceback" not in wrong.stderr
    thin = ARCH.replace("1.5", "1.0").replace("157.5", "180.0").replace("voussoirs = 7", "voussoirs = 36")
    proven = extrados("run", deck(tmp_path, thin + '[analysis]\nkind = "tilt"\n'), "--out", str(tmp_path / "p"))
    assert proven.returncode == 0 and "cannot stand" in proven.stdout
    told = json.loads((tmp_path / "p" / "summary.json").read_text())["analyses"][0]
    assert told["status"] == "ok" and told["verdict"]["outcome"] == "cannot-stand"
    weightless = deck(tmp_path, ARCH + '[material]\ndensity = 0.0\n[analysis]\nkind = "tilt"\n')
    refused = extrados("run", weightless, "--out", str(tmp_path / "o"))
    assert refused.returncode == 3 and "give a density above zero" in refused.stdout
    assert json.loads((tmp_path / "o" / "summary.json").read_text())["analyses"][0]["status"] == "refused"
    missing = extrados("run", str(tmp_path / "none.toml"))
    assert missing.returncode == 2 and "no such file" in missing.stderr


def test_a_check_loads_no_library_that_it_does_not_call(tmp_path) -> None:
    """scipy.signal alone takes longer to load than a deck takes to check."""
    words = [sys.executable, "-X", "importtime", "-m", "extrados", "check", deck(tmp_path, ARCH + '[[analysis]]\nkind = "tilt"\n')]
    run = subprocess.run(words, capture_output=True, text=True, timeout=100)
    loaded = {line.rsplit("|", 1)[-1].strip() for line in run.stderr.splitlines()}
    assert run.returncode == 0 and "numpy" in loaded and not loaded & {"scipy.signal", "scipy.stats", "matplotlib"}


def test_bad_record_is_refused(tmp_path) -> None:
    (tmp_path / "r.at2").write_text("NPTS= 5, DT= 0.01\n0.1 nan 0.2 0.3 0.1\n")
    text = ARCH + '[motion]\nkind = "record"\nfile = "r.at2"\n[analysis]\nkind = "rocking"\n'
    run = extrados("run", deck(tmp_path, text), "--out", str(tmp_path / "o"))
    assert run.returncode == 3 and "r.at2:2: 'nan' is not a number" in run.stdout and "Traceback" not in run.stderr


def test_read_only_folder(tmp_path) -> None:
    """A folder that cannot hold results is named before anything is computed."""
    (tmp_path / "taken").write_text("x")
    path = deck(tmp_path, ARCH + '[analysis]\nkind = "tilt"\n')
    run = extrados("run", path, "--out", str(tmp_path / "taken" / "deeper"))
    assert run.returncode == 3 and "cannot write here" in run.stderr and "Traceback" not in run.stderr


def test_small_commands(tmp_path) -> None:
    from typer.testing import CliRunner

    from extrados.cli import app

    def call(*args: str):
        return CliRunner().invoke(app, list(args))

    assert json.loads(call("schema").stdout)["title"] == "extrados deck"
    assert "R_A" in call("explain", "radius").stdout
    assert call("explain", "raduis").exit_code == 2
    assert 'kind = "rocking"' in call("new", "rocking").stdout
    assert "  tilt             Limit analysis" in call("new").stdout and call("new", "rokking").exit_code == 2
    assert "readme.toml" in call("cases", str(ROOT / "cases")).stdout
    assert call("version").stdout.startswith("extrados 0") and call("--version").stdout == call("version").stdout
    good = deck(tmp_path, ARCH + '[analysis]\nkind = "tilt"\n')
    assert call("check", good).stdout.strip() == "ok"
    out = str(tmp_path / "o")
    assert json.loads(call("run", good, "--json", "--out", out).stdout)["analyses"][0]["status"] == "ok"
    assert call("report", out).exit_code == 0
    assert call("plot", out).exit_code == 0
    assert call("report", str(tmp_path)).exit_code == 3


def test_ctrl_c_in_a_compiled_loop(tmp_path) -> None:
    """A long response answers Ctrl-C, keeps what it has and exits with 130."""
    text = (
        ARCH.replace("10.0", "0.2").replace("1.5", "0.03")
        + '[motion]\nkind = "harmonic"\namplitude = "0.42 g"\nfrequency = 30.0\nduration = 20000.0\n'
        + '[analysis]\nkind = "rocking"\noutput_step = 1.0\ntolerance = 1e-12\n'
    )
    # The command line as it is, but Ctrl-C comes when the core is at work.
    code = (
        f"import os, signal, sys; sys.path.insert(0, {str(Path(__file__).parent)!r});"
        "from interrupting import interrupted; import extrados.core.rocking as r;"
        "r.long_call = interrupted(r.long_call, 0.5, lambda: os.kill(os.getpid(), signal.SIGINT));"
        f"sys.argv = ['extrados', 'run', {deck(tmp_path, text)!r}, '--out', {str(tmp_path / 'o')!r}, '--no-figures'];"
        "from extrados.cli import main; main()"
    )
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert run.returncode == 130, run.stdout + run.stderr
    assert "Traceback" not in run.stderr
    analysis = json.loads((tmp_path / "o" / "summary.json").read_text())["analyses"][0]
    assert analysis["status"] == "interrupted" and analysis["results"]["steps"] > 0


TILT = ARCH + '[analysis]\nkind = "tilt"\n'


def test_a_deck_gives_no_orders_to_the_terminal(tmp_path) -> None:
    """Titles, names of files, keys and complaints are shown, not obeyed; nor are they in tables."""
    nasty = "\\u001b]0;owned\\u0007\\u009b31m\\u202e"
    fine = extrados("run", deck(tmp_path, f'title = "{nasty}"\n' + TILT), "--out", str(tmp_path / "o"), "--no-figures")
    assert fine.returncode == 0 and "\\x1b]0;owned\\x07\\x9b31m\\u202e" in fine.stdout
    wrong = extrados("check", deck(tmp_path, f'"{nasty}" = 1\n' + TILT.replace("tilt", nasty)))
    (tmp_path / "a\x1b[31m.toml").write_text("")
    listed = extrados("cases", str(tmp_path))
    unknown = extrados("explain", "\x1b[31m")
    as_json = extrados("run", deck(tmp_path, f'title = "{nasty}"\n' + TILT), "--json", "--out", str(tmp_path / "o"))
    for run in (fine, wrong, listed, unknown, as_json):
        said = run.stdout + run.stderr
        assert said and not set(said) & {"\x1b", "\x07", "\x9b", "\u202e"}, said


def test_names_and_headers_of_tables_are_no_formulas(tmp_path) -> None:
    table = "".join(store.csv_parts(TableData({"=cmd": ["@x", "\x1b[31m"], "+1": [1.0, 2.0]}, {"+1": "m"})))
    assert table.splitlines() == ["'=cmd,'+1 [m]", "'@x,1.0", "\\x1b[31m,2.0"]


@pytest.mark.parametrize("text", ['"a"\n' + "a = " + "[" * 5000, "title = [\x00]"])
def test_decks_that_cannot_be_read_are_listed(tmp_path, text) -> None:
    deck(tmp_path, text)
    (tmp_path / "pipe.toml").symlink_to("/dev/zero")
    run = extrados("cases", str(tmp_path))
    assert run.returncode == 0 and run.stdout.count("(cannot be read)") == 2, run.stderr


def test_a_terminal_that_knows_ascii_alone(tmp_path) -> None:
    path = deck(tmp_path, 'title = "Gewölbe über dem Fluß, 拱"\n' + TILT)
    run = extrados("run", path, "--out", str(tmp_path / "o"), env={**os.environ, "PYTHONIOENCODING": "ascii"})
    assert run.returncode == 0 and "Gew\\xf6lbe" in run.stdout and "mechanism" in run.stdout, run.stderr


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="Linux has a full device")
@pytest.mark.parametrize("words", [["cases"], ["schema"], ["explain"], ["version"], ["new", "tilt"], ["run"]])
def test_output_to_a_full_device(tmp_path, words) -> None:
    if words == ["run"]:
        words = ["run", deck(tmp_path, TILT), "--out", str(tmp_path / "o"), "--no-figures"]
    with open("/dev/full", "w") as full:
        run = extrados(*words, cwd=ROOT, capture_output=False, stdout=full, stderr=subprocess.PIPE)
    assert run.returncode == 3 and "Traceback" not in run.stderr and "No space left" in run.stderr
    assert words[0] != "run" or (tmp_path / "o" / "summary.json").exists()


def test_output_that_is_closed_or_full_altogether(tmp_path) -> None:
    """Nothing can be told then but by the code; and no file takes the numbers of what is closed."""
    words = f"'{sys.executable}' -m extrados"
    path, out = deck(tmp_path, TILT), tmp_path / "o"
    for where in (">&- 2>&-", "<&- >&- 2>&-"):
        assert os.waitstatus_to_exitcode(os.system(f"{words} run '{path}' --out '{out}' --no-figures {where}")) == 0
        assert os.waitstatus_to_exitcode(os.system(f"{words} run none.toml {where}")) == 2
        assert json.loads((out / "summary.json").read_text())["analyses"][0]["status"] == "ok"
    if os.path.exists("/dev/full"):
        assert os.waitstatus_to_exitcode(os.system(f"{words} cases >/dev/full 2>/dev/full")) == 3


def test_words_are_not_made_pictures(tmp_path) -> None:
    run = extrados("run", str(tmp_path / "root:x:0.toml"))
    assert "root:x:0.toml: no such file" in run.stderr


@pytest.mark.parametrize("name", ["..", ".", ""])
def test_results_of_a_motion_lie_in_results(tmp_path, name) -> None:
    """`..` has no name of its own: the results were put beside the folder that is worked in."""
    place = tmp_path / "here"
    place.mkdir()
    assert "is a folder" in extrados("motion", name, "--no-figures", cwd=place).stdout
    assert os.listdir(place / "results") == ["motion"] and os.listdir(tmp_path) == ["here"]


@pytest.mark.parametrize(
    "text",
    [
        ".".join("a" * 20_000) + " = 1",
        "[" + " . ".join(["'a'"] * 20_000) + "]",
        "[x]\ny = { " + ".".join("a" * 99) + " = 1 }",
        "title" + ".b" * 50 + "." + '."c"' * 50 + " = 1",
        "a = " + "[" * 61 + "]" * 61,
    ],
    ids=["key", "header", "inline", "title", "list"],
)
def test_a_deck_that_is_nested_too_deeply(tmp_path, text) -> None:
    text = text.replace("..", ".")
    tracemalloc.start()
    try:
        with pytest.raises(DeckError, match="nested too deeply"):
            read_text(text.encode())
        assert tracemalloc.get_traced_memory()[1] < 20e6
    finally:
        tracemalloc.stop()
    (tmp_path / "deep.toml").write_text(text)
    assert extrados("cases", str(tmp_path)).stdout.strip().endswith("deep.toml: (cannot be read)")


def test_a_folder_with_a_deck_whose_name_is_no_text(tmp_path) -> None:
    with open(os.fsencode(tmp_path) + b"/b\xff.toml", "w") as file:
        file.write(ARCH + '[motion]\nkind = "record"\nfile = "extrados:el-centro-1940"\n')
    run = extrados("assess", str(tmp_path), "--no-figures", "--out", str(tmp_path / "o"))
    assert run.returncode == 0 and "b\\udcff" in run.stdout, run.stderr


def test_names_that_are_no_text(tmp_path) -> None:
    """Names of files are bytes; a deck, a record and the members of a suite may be called anything."""
    name = os.fsencode(tmp_path) + b"/d\xff\xfe.toml"
    record = b"0.1\n-0.2\n0.3\n" * 30
    suite = '[motion]\nkind = "suite"\nfolder = "."\nunit = "m/s^2"\ntime_step = 0.01\n[analysis]\nkind = "motion"\n'
    for file, content in ((name, suite.encode()), (os.fsencode(tmp_path) + b"/r\xff.csv", record)):
        with open(file, "wb") as handle:
            handle.write(content)
    run = extrados(b"run", name, cwd=tmp_path)
    assert (
        run.returncode == 0 and "d\\udcff" in (tmp_path / "results").joinpath(*os.listdir(tmp_path / "results"), "summary.json").read_text()
    )
    assert len(list(tmp_path.glob("results/*/report.html"))) == 1
    named = extrados(b"motion", os.fsencode(tmp_path) + b"/r\xff.csv", "--time-step", "0.01", "--unit", "g", cwd=tmp_path)
    assert named.returncode == 2 and "motion.file" in named.stderr and "Traceback" not in named.stderr


@pytest.mark.parametrize("channel", ["²", "٣", "9" * 5000, "-1"])
def test_a_channel_with_an_odd_digit(tmp_path, channel) -> None:
    run = extrados("motion", "extrados:el-centro-1940", "--channel", channel, cwd=tmp_path)
    assert run.returncode == 3 and "channel" in run.stdout and "Traceback" not in run.stderr


#: Where a signal comes: the line of Python that sends it to its own process
MOMENTS = {
    "as the first module is loaded": "import typer",
    "as the core is loaded": "import extrados._core",
    "as figures are drawn": "import extrados.show.report",
}


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize("moment", MOMENTS)
def test_signals_while_modules_are_loaded(tmp_path, moment, number) -> None:
    """No traceback, one code; once the answer has been printed it is there."""
    module = MOMENTS[moment].split()[1]
    code = f"""
import builtins, os, sys
real = builtins.__import__
def loads(name, globals=None, locals=None, fromlist=(), level=0):
    if name == {module!r} or (name, {module.rpartition(".")[2]!r}) == ({module.rpartition(".")[0]!r}, *(fromlist or ("",)))[:2]:
        builtins.__import__ = real
        os.kill(os.getpid(), {int(number)})
    return real(name, globals, locals, fromlist, level)
builtins.__import__ = loads
sys.argv = ["extrados", "run", {deck(tmp_path, TILT)!r}, "--out", {str(tmp_path / "o")!r}]
from extrados.__main__ import main
main()
"""
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert run.returncode == 128 + number and "Traceback" not in run.stderr, run.stderr
    assert "interrupted" in run.stderr
    if moment == "as figures are drawn":
        assert "mechanism" in run.stdout and "interrupted while drawing" in run.stderr
        assert (tmp_path / "o" / "summary.json").exists()


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize("becomes", ["SystemExit(130)", "SystemExit(1)", "ImportError('initialization failed')", "KeyboardInterrupt"])
def test_signals_that_a_library_makes_something_else_of(tmp_path, number, becomes) -> None:
    """The code is the signal's, though it came while the library evaluated a text, which CPython remembers to its end."""
    code = f"""
from extrados import cli
def app():
    try:
        exec("import os, time; os.kill(os.getpid(), {int(number)}); time.sleep(5)")
    except KeyboardInterrupt:
        raise {becomes}
cli.app = app
cli.main()
"""
    (tmp_path / "library.py").write_text(code)
    run = subprocess.run([sys.executable, "-m", "library"], capture_output=True, text=True, cwd=tmp_path)
    assert run.returncode == 128 + number and "Traceback" not in run.stderr, run.stderr


def test_ctrl_c_ends_a_computation_in_another_thread() -> None:
    """Python answers it in the main thread; the computation does not go on unseen, and the handlers come back."""
    code = """
import os, signal, threading
import numpy as np
from extrados.core import rocking
from extrados.core.ground import Ground
ground = Ground(breaks=np.array([0.0, 1e6]), linear=np.zeros((1, 1, 2)), harmonic=np.array([[[[3.0, 0.0, 12.0, 0.0]]]]))
block = rocking.block_body(1000.0, 1500.0, 2.0, 0.5, 0.5, (0.9, 0.9))
found = []
def work():
    found.append(rocking.history(block, ground, 1e6, 1.0, start_side=1, start_rotation=0.01, tolerance=1e-12))
thread = threading.Thread(target=work)
thread.start()
answered = 0
while thread.is_alive():  # the first may come before the computation has begun
    try:
        thread.join(0.1)
        os.kill(os.getpid(), signal.SIGINT)
        thread.join(0.1)
    except KeyboardInterrupt:
        answered += 1
print(found[0].interrupted, answered > 0, signal.getsignal(signal.SIGINT) is signal.default_int_handler)
"""
    run = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert run.stdout == "True True True\n", run.stdout + run.stderr


def test_more_threads_than_cores_are_not_started(tmp_path) -> None:
    words = ["--threads", "100000", "--out", str(tmp_path / "o"), "--no-figures"]
    run = extrados(
        "run", deck(tmp_path, ARCH + '[analysis]\nkind = "sweep"\nvary = "thickness"\nstart = 1.2\nstop = 2.0\ncount = 9\n'), *words
    )
    assert run.returncode == 0 and "--threads 100000 exceeds the" in run.stderr


def test_cases_away_from_the_sources(tmp_path) -> None:
    """Where there is no folder of that name the shipped ones are listed; an own one comes first."""
    shipped = extrados("cases", cwd=tmp_path)
    assert shipped.returncode == 0 and "readme.toml: " in shipped.stdout
    (tmp_path / "cases").mkdir()
    (tmp_path / "cases" / "mine.toml").write_text('title = "Mine"\n')
    assert extrados("cases", cwd=tmp_path).stdout.split() == ["cases/mine.toml:", "Mine"]


def test_a_file_of_ones_own_is_not_written_over(tmp_path) -> None:
    """An export that was edited, a page of another, the deck itself: what is new is put beside them, and said so."""
    path, out = Path(deck(tmp_path, TILT)), tmp_path / "o.json"
    export = ("export", str(path), "--to", "compas", "--out")
    for _ in range(2):  # ours, which nobody has changed, is replaced
        assert extrados(*export, str(out)).returncode == 0
    assert not (tmp_path / "o-2.json").exists()
    out.write_text(out.read_text() + "\nmine")
    run = extrados(*export, str(out))
    assert run.returncode == 0 and "o-2.json" in run.stdout and "changed later" in run.stderr
    assert out.read_text().endswith("mine") and json.loads((tmp_path / "o-2.json").read_text())
    text = path.read_text()
    assert extrados(*export, str(path)).returncode == 0 and path.read_text() == text
    assert extrados(*export, "/dev/stdout").stdout.startswith("{")
    results, page = str(tmp_path / "r"), tmp_path / "page.html"
    page.write_text("mine")
    assert extrados("run", str(path), "--no-figures", "--out", results).returncode == 0
    assert extrados("compare", results, results, "--page", str(page)).returncode == 0
    assert page.read_text() == "mine" and "<html" in (tmp_path / "page-2.html").read_text()
