"""The tools of those who keep the program: a release, the history of benchmarks, the recipe of the forge."""

import importlib.util
import re
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).resolve().parents[2]


def tool(place: str) -> ModuleType:
    spec = importlib.util.spec_from_file_location(Path(place).stem, ROOT / place)
    assert spec is not None and spec.loader is not None
    made = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(made)
    return made


release, history = tool("tools/release.py"), tool("tests/bench/history.py")


@pytest.fixture
def sources(tmp_path: Path) -> Path:
    """A repository that holds what a release touches."""
    for name in ["CHANGELOG.md", *release.PLACES]:
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text((ROOT / name).read_text(encoding="utf-8"), encoding="utf-8")
    for words in (
        ["init", "-q"],
        ["config", "user.email", "a@b"],
        ["config", "user.name", "a"],
        ["add", "."],
        ["commit", "-qm", "all"],
    ):
        subprocess.run(["git", "-C", tmp_path, *words], check=True)
    return tmp_path


def test_a_release_sets_the_version_everywhere(sources: Path) -> None:
    before = release.current(sources)
    major, minor, _ = release.numbers(before)
    version = f"{major}.{minor + 1}.0"
    archive = release.release(sources, version, "2026-12-01")
    assert archive.stat().st_size > 1000 and release.current(sources) == version
    for name, (left, right) in release.PLACES.items():
        text = (sources / name).read_text(encoding="utf-8")
        assert re.search(f"{left}{re.escape(version)}{right}", text, re.M) and f"'{before}'" not in text
    log = (sources / "CHANGELOG.md").read_text(encoding="utf-8")
    assert f"## {major}.{minor + 2}.0 (unreleased)\n\n## {version} (2026-12-01)\n\n### " in log
    assert release.git(sources, "tag") == f"v{version}" and not release.git(sources, "status", "--porcelain", "-uno")
    with pytest.raises(release.Refused, match="not larger"):
        release.prepare(sources, version, "2026-12-02")
    with pytest.raises(release.Refused, match="has no news"):
        release.prepare(sources, f"{major}.{minor + 3}.0", "2026-12-02")


def test_a_release_is_refused_with_the_reason(sources: Path) -> None:
    with pytest.raises(release.Refused, match="expected three numbers"):
        release.release(sources, "next", "2026-12-01")
    (sources / "pyproject.toml").write_text("")
    with pytest.raises(release.Refused, match="holds changes"):
        release.release(sources, "9.0.0", "2026-12-01")


def test_benchmarks_have_a_history(tmp_path: Path) -> None:
    """Labels are lines without their numbers; curves need two runs, and their picture is drawn."""
    place = tmp_path / "history.jsonl"
    for seconds in (2.0, 1.5):
        history.append("arch", f"domain 40 x 40, one thread: {seconds} s (4,000 runs/s)\nno time here: 3\n", place)
    history.append("dem", "step 12.5 ns per block", place)
    entries = history.read(place)
    assert len(entries) == 3 and entries[0]["told"] == {"domain # x #, one thread: # s (# runs/s)": [2.0, "s"]}
    [(label, points)] = history.curves(entries, "arch").items()
    assert [(value, unit) for _, value, unit in points] == [(2.0, "s"), (1.5, "s")] and label.startswith("domain")
    assert history.curves(entries, "dem") == {} and history.parsed("4,000 motions/s") == {
        "# motions/s": (4000.0, "motions/s")
    }
    [picture] = history.draw(place, tmp_path / "pictures")
    assert picture.stat().st_size > 5000


def test_the_forge_calls_what_is_there() -> None:
    recipe = (ROOT / ".github" / "workflows" / "ci.yml").read_text(encoding="utf-8")
    targets = set(re.findall(r"^([\w-]+):", (ROOT / "Makefile").read_text(encoding="utf-8"), re.M))
    called = re.findall(r"run: (?:sudo )?(\S+)(?: (\S+).*)?$", recipe, re.M)
    assert len(called) == recipe.count("run: ") >= 8
    for command, word in called:
        there = (ROOT / command).exists() or command in ("git", "apt-get", "pipx")
        assert word in targets if command == "make" else there, (command, word)
    assert sys.version_info >= (3, 11)


def test_a_build_apart_holds_no_source_that_is_gone(tmp_path: Path, monkeypatch) -> None:
    apart = tool("tools/apart.py")
    root, place = tmp_path / "root", tmp_path / "place"
    for name in ("python/extrados/kept.py", "python/extrados/gone.py"):
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).write_text("")
    monkeypatch.setattr(apart, "ROOT", root)
    monkeypatch.setattr(apart, "PARTS", ("python",))
    apart.copy(place)
    made = [place / "python/extrados" / name for name in ("_core.cpython.so", "_build_info.py")]
    for path in made:
        path.write_text("")
    (root / "python/extrados/gone.py").unlink()
    apart.copy(place)
    assert sorted(place.rglob("*.*")) == sorted([place / "python/extrados/kept.py", *made])


def test_every_room_of_the_core_has_tests_that_seeded_faults_run(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(ROOT / "tools"))
    rooms = tool("tools/seeded_faults.py").ROOMS
    sources = [path for root in ("fortran", "c") for end in ("f90", "c") for path in (ROOT / root).glob(f"*/*.{end}")]
    # what hands numbers over holds no mechanics of its own
    assert {path.parent.relative_to(ROOT).as_posix() for path in sources} - {"fortran/api"} == set(rooms)
    for native, python, _ in rooms.values():
        assert all((ROOT / "tests" / name).exists() for name in python)
        assert all(any((ROOT / "tests").glob(f"*/{name}.*")) for name in native)


def test_a_site_with_a_broken_link_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(ROOT / "tools"))
    broken = tool("tools/site.py").broken
    (tmp_path / "sub").mkdir()
    (tmp_path / "sub" / "index.html").write_text('<a href="../a.html#here">a</a> <a href="https://afar">b</a>')
    (tmp_path / "a.html").write_text(
        '<h1 id="here">a</h1> <a href="sub/">b</a> <a href="#here">c</a> <img src="data:,">'
    )
    assert broken(tmp_path) == []
    (tmp_path / "b.html").write_text(
        '<a href="gone.html">a</a> <a href="a.html#gone">b</a> <script src="https://afar/x.js"></script>'
    )
    assert broken(tmp_path) == [
        "b.html: gone.html leads nowhere",
        "b.html: a.html#gone leads nowhere",
        "b.html: https://afar/x.js is loaded from the network",
    ]


def test_what_the_fortran_reference_loads_from_afar_is_taken_out(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(ROOT / "tools"))
    page = '<a><!-- Bootstrap -->\n<link href="https://x">\n<!-- Font Awesome --><b><!-- MathJax --><script src="https://y"></script><!-- Other scripts --><c>'
    assert tool("tools/site.py").FROM_AFAR.sub("", page) == "<a><!-- Font Awesome --><b><!-- Other scripts --><c>"


def test_coverage_is_noted_where_contributors_read_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(ROOT / "tools"))
    coverage, page = tool("tools/coverage.py"), (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    [told] = coverage.NOTE.findall(page)
    found = [float(number) for number in re.findall(r"\d+\.\d", told)]
    assert len(found) == 3 and all(50.0 < share <= 100.0 for share in found)
    made = coverage.noted(page, {"Python": 91.23, "Fortran": 92.0, "C": 93.0}, "2026-12-01")
    assert (
        "At the last whole run (2026-12-01) they were 91.2, 92.0 and 93.0 %" in made
        and len(coverage.NOTE.findall(made)) == 1
    )
    with pytest.raises(SystemExit, match="no place"):
        coverage.noted("nothing", {"Python": 1.0, "Fortran": 1.0, "C": 1.0}, "2026-12-01")
