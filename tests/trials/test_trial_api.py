"""The core's Python API under random abuse: results or exceptions, and a core that still computes rightly."""

import subprocess
import sys
from pathlib import Path

import trials

SEED = 11
WORKER = Path(__file__).with_name("api_worker.py")


def abuse(trial: trials.Trial, least: int, python: list[str], **how) -> None:
    """`least` calls in processes of their own; one that dies is a failure, and the next goes on after it."""
    first = 0
    ends: dict[str, int] = {}
    while first < least:
        child = subprocess.run(
            [*python, str(WORKER), str(SEED), str(first), str(least - first)], capture_output=True, text=True, errors="replace", **how
        )
        lines = child.stdout.splitlines()
        rows = [line.split("\t") for line in lines if line[:1].isdigit()]
        assert rows, f"the set-up fails: {child.returncode}: {child.stderr[-3000:]}"
        for row in rows:
            trial.tried += 1
            if len(row) < 3 or not row[2]:
                trial.fail(f"{row[1]} ended the process with {child.returncode}: {child.stderr[-1500:]}")
            elif row[2].startswith("WRONG"):
                trial.fail(f"{row[1]}: {row[2]}")
            else:
                ends[row[2]] = ends.get(row[2], 0) + 1
        first = int(rows[-1][0]) + 1
    trial.notes.append(", ".join(f"{n} {end}" for end, n in sorted(ends.items(), key=lambda e: -e[1])))


def test_the_core_is_abused() -> None:
    trial = trials.Trial("api-abused", "wrong calls of the core's Python API that end the process or change later results")
    abuse(trial, least := trials.count_of(20_000, 120), [sys.executable])
    trial.close(least)


def test_every_function_of_the_core_is_reached() -> None:
    """A new facade gets a call in core_calls, or nothing abuses it."""
    child = subprocess.run([sys.executable, str(WORKER), "unreached"], capture_output=True, text=True, check=True)
    called_as_it_loads = {"api_support.init_libraries", "api_support.list_entry"}
    assert set(child.stdout.split()) <= called_as_it_loads | {"api_support.cancel_requested", "api_support.handle_count"}
