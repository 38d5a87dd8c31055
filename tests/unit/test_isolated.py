"""No code of the user's folder is run: files named like modules lie beside the deck, and no command loads them."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from extrados.schema.isolated import environment

#: Modules that this program, its libraries or a new process load, early and late
PLANTED = (
    "queue",
    "json",
    "random",
    "secrets",
    "socket",
    "numpy",
    "h5py",
    "matplotlib",
    "pydantic",
    "extrados",
    "extrados_core",
    "sitecustomize",
    "usercustomize",
    "uvicorn",
    "starlette",
    "typst",
    "PIL",
    "tomllib",
    "csv",
    "multiprocessing",
    "distributed",
)
DECK = """title = "planted"
[structure]
kind = "block"
width = 1.0
height = 4.0
[motion]
kind = "sine-pulse"
amplitude = "0.1 g"
period = 0.5
[analysis]
kind = "tilt"
"""
#: A sweep whose members are computed by other processes of this machine
SWEEP = """import extrados
if __name__ == "__main__":
    table = extrados.sweep("deck.toml", {"structure.width": [1.4, 1.5]}, workers=2)
    print(len(table.rows))
"""
SCRIPT = Path(sys.executable).with_name("extrados")


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "deck.toml").write_text(DECK)
    for name in PLANTED:
        (tmp_path / f"{name}.py").write_text(f"open({str(tmp_path / 'ran')!r}, 'a').write(__name__ + ' ')\n")
    return tmp_path


def _run(folder: Path, *command: str, **more: str) -> str:
    done = subprocess.run(command, cwd=folder, env={**os.environ, **more}, capture_output=True, text=True, timeout=300, check=False)
    assert not (folder / "ran").exists(), f"{command}: {(folder / 'ran').read_text()} was run"
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.parametrize(
    "commands",
    [
        ["check deck.toml", "run deck.toml --no-figures --out r"],
        pytest.param(
            [
                "run deck.toml --out r",
                "report r",
                "compare r r",
                "explain tilt",
                "new arch",
                "schema",
                "cases .",
                "export deck.toml --to compas",
                "assess . --out all",
                "version",
            ],
            marks=pytest.mark.verify,
        ),
    ],
    ids=["quick", "all"],
)
def test_no_command_runs_what_lies_in_its_folder(folder: Path, commands: list[str]) -> None:
    for words in commands:
        _run(folder, str(SCRIPT), *words.split())


def test_no_process_of_the_page_runs_what_lies_in_its_folder(folder: Path) -> None:
    from extrados.explore.folder import Folder

    here = os.getcwd()
    os.chdir(folder)
    try:
        lines = list(Folder(folder).compute("deck.toml"))
    finally:
        os.chdir(here)
    assert lines[-1] == ("", True), lines
    assert not (folder / "ran").exists()


def test_the_serving_process_runs_nothing_of_its_folder(folder: Path) -> None:
    page = subprocess.Popen([str(SCRIPT), "explore", "--no-browser"], cwd=folder, stdout=subprocess.PIPE, text=True)
    try:
        assert page.stdout is not None
        address = next(line for line in page.stdout if line.startswith("Page:")).split()[1]
        import urllib.request

        for _ in range(600):
            try:
                with urllib.request.urlopen(address, timeout=10) as answer:
                    assert b"script" in answer.read()
                break
            except OSError:
                assert page.poll() is None
        assert not (folder / "ran").exists()
    finally:
        page.terminate()
        page.wait(30)


def test_processes_of_a_sweep_run_nothing_of_the_folder(folder: Path, tmp_path_factory: pytest.TempPathFactory) -> None:
    script = tmp_path_factory.mktemp("elsewhere") / "script.py"  # Python itself looks beside a script
    script.write_text(SWEEP)
    assert _run(folder, sys.executable, str(script)).strip() == "2"


def test_an_empty_entry_of_the_path_is_no_way_in() -> None:
    assert environment(PYTHONPATH=f"{os.pathsep}/a{os.pathsep}{os.pathsep}/b")["PYTHONPATH"] == f"/a{os.pathsep}/b"
