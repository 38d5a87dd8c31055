"""Calls of the system that fail once: every allocation of the core, every write of a run."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

import trials
from extrados import _core

HERE = Path(__file__).parent
pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="the shim takes the place of functions of glibc")


@pytest.fixture(scope="module")
def shim(tmp_path_factory: pytest.TempPathFactory) -> str:
    """The library that lets calls fail."""
    path = tmp_path_factory.mktemp("shim") / "shim.so"
    subprocess.run(["cc", "-shared", "-fPIC", "-O1", "-o", str(path), str(HERE / "shim.c"), "-ldl"], check=True)
    return str(path)


def worked(shim: str, script: str, *words: str) -> list[list]:
    """The lines of JSON that a worker prints with the shim preloaded."""
    environment = {**os.environ, "LD_PRELOAD": shim, "OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    child = subprocess.run(
        [sys.executable, str(HERE / script), shim, *words], capture_output=True, text=True, errors="replace", env=environment
    )
    assert child.returncode == 0, f"{child.returncode}: {child.stderr[-3000:]}"
    return [json.loads(line) for line in child.stdout.splitlines() if line.startswith("[")]


def by_the_compiler(places: set[int]) -> set[int]:
    """Of places in the core, those in procedures that the compiler writes to finalise objects: they check nothing."""
    listed = subprocess.run(["nm", "-n", "--defined-only", _core.__file__], capture_output=True, text=True, check=True)
    symbols = [(int(row[0], 16), row[2]) for row in map(str.split, listed.stdout.splitlines()) if len(row) == 3]
    owner = {place: next((name for at, name in reversed(symbols) if at <= place), "") for place in places}
    return {place for place, name in owner.items() if "___final_" in name}


def test_every_allocation_fails_once(shim: str) -> None:
    """An exception or the right result, nothing left behind, and the next call gives the right bits."""
    trial = trials.Trial("failed-allocations", "allocations of the core that fail and are not told")
    functions = () if trials.SHARE > 0.0 else ("small", "rockers")
    ends: dict[str, int] = {}
    finalised = 0
    for name, count, how, wrong in worked(shim, "allocation_worker.py", *functions):
        trial.tried += count
        for end, times in how.items():
            ends[end] = ends.get(end, 0) + times
        for text in wrong:
            place = {int(found, 16) for found in re.findall(r"_core\S*\+(0x[0-9a-f]+)", text)}
            if "dies" in text and place and by_the_compiler(place) == place:
                finalised += 1
            else:
                trial.fail(f"{name}: {text}")
    trial.notes.append(", ".join(f"{n} {end}" for end, n in sorted(ends.items(), key=lambda e: -e[1])))
    if finalised:
        trial.notes.append(f"{finalised} of them in finalisers that gfortran writes and that check nothing (16 bytes each)")
    trial.close(20)


DECK = """
[structure]
kind = "block"
width = 1.0
height = 4.0
[motion]
kind = "generated"
mmi = 8
duration = 3.0
[[analysis]]
kind = "tilt"
[[analysis]]
kind = "fragility"
count = 200
"""


@pytest.mark.verify
def test_every_write_fails_once(shim: str, tmp_path: Path) -> None:
    """The run says so, and its folder holds the results, those from before, or none; never a part, nothing beside it."""
    trial = trials.Trial("failed-writes", "writes, renames and syncs of a run that fail and are not told, or leave a part")
    deck = tmp_path / "deck.toml"
    deck.write_text(DECK)
    codes: dict[int, int] = {}
    words = ["run", str(deck), "--threads", "1", "--out", str(tmp_path / "out")]
    for k, before, code, said, found, left in worked(shim, "write_worker.py", "1", *words):
        trial.tried += 1
        codes[code] = codes.get(code, 0) + 1
        where = f"write {k}{' over earlier results' if before else ''}"
        if code not in (0, 3) or "Traceback" in said or (code == 3 and not said.strip()):
            trial.fail(f"{where}: exit {code}: {said}")
        if found not in (("whole",) if before or code == 0 else ("whole", "nothing")):
            trial.fail(f"{where}: exit {code}, and the folder is {found}")
        if [name for name in left if not name.endswith(".checkpoint")]:
            trial.fail(f"{where}: exit {code}, and {left} is left")
    trial.notes.append(", ".join(f"{n} ended with {code}" for code, n in sorted(codes.items())))
    trial.close(40)
