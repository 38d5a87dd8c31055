"""The command line as a user meets it: exit codes, messages, Ctrl-C, no traceback."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
ARCH = '[structure]\nkind = "arch"\nradius = 10.0\nthickness = 1.5\nembrace = 157.5\nvoussoirs = 7\n'


def extrados(*args: str, cwd: Path | None = None) -> subprocess.CompletedProcess:
    return subprocess.run([sys.executable, "-m", "extrados.cli", *args], capture_output=True, text=True, cwd=cwd)


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


def test_exit_codes(tmp_path) -> None:
    wrong = extrados("run", deck(tmp_path, ARCH + '[analysis]\nkind = "tlit"\n'))
    assert wrong.returncode == 2 and "deck.toml:8: analysis.kind" in wrong.stderr and "Traceback" not in wrong.stderr
    thin = ARCH.replace("1.5", "1.0").replace("157.5", "180.0").replace("voussoirs = 7", "voussoirs = 36")
    refused = extrados("run", deck(tmp_path, thin + '[analysis]\nkind = "tilt"\n'), "--out", str(tmp_path / "o"))
    assert refused.returncode == 3 and "t/R 0.10746" in refused.stdout
    assert json.loads((tmp_path / "o" / "summary.json").read_text())["analyses"][0]["status"] == "refused"
    missing = extrados("run", str(tmp_path / "none.toml"))
    assert missing.returncode == 2 and "no such file" in missing.stderr


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
    assert "readme.toml" in call("cases", str(ROOT / "cases")).stdout
    assert call("version").stdout.startswith("extrados 0")
    good = deck(tmp_path, ARCH + '[analysis]\nkind = "tilt"\n')
    assert call("check", good).stdout.strip() == "ok"
    out = str(tmp_path / "o")
    assert json.loads(call("run", good, "--json", "--out", out).stdout)["analyses"][0]["status"] == "ok"
    assert call("report", out).exit_code == 0
    assert call("plot", out).exit_code == 0
    assert call("report", str(tmp_path)).exit_code == 3


@pytest.mark.skipif(os.name != "posix", reason="signals are POSIX")
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
