"""Values of cases, kept in build/verification: what one process computes, the verification book and later runs need not compute again.

A file for each case and change holds the values with the identity of all that they follow from: the program, deck, data beside it, rows.
"""

import hashlib
import json
import os
import resource
from collections.abc import Iterable
from functools import cache
from pathlib import Path
from typing import Any

from expectations import Case, pick, results_of_run, run_of

from extrados.running.run import Run
from extrados.schema.files import SHIPPED

ROOT = Path(__file__).resolve().parents[2]
KEPT = ROOT / "build" / "verification"
Change = tuple[tuple[str, Any], ...]


def checksum(paths: Iterable[Path]) -> str:
    """Of the bytes of files, and of their names."""
    total = hashlib.sha256()
    for path in sorted(paths):
        data = path.read_bytes()
        total.update(f"{path.relative_to(ROOT)} {len(data)} ".encode() + data)
    return total.hexdigest()


@cache
def program() -> str:
    """A checksum of all that computes: sources, the tables that they read, and the options of the build."""
    trees = (("fortran", "*.f90"), ("c", "*.[ch]"), *(("python/extrados", ends) for ends in ("*.py", "*.csv", "*.toml")))
    paths = {path for root, ends in trees for path in (ROOT / root).rglob(ends)}
    written = ROOT / "python" / "extrados" / "results" / "model_uncertainty.csv"  # by the book itself
    return checksum([*paths - {written}, ROOT / "meson.build"])


@cache
def data_beside(folder: Path) -> str:
    """A checksum of the data that decks of a folder may read: its files that are no decks or expectations, and shipped data."""
    shipped = [ROOT / "python" / "extrados" / file for file in SHIPPED.values()]
    shipped += [path for path in (ROOT / "python/extrados/motions/spectra").iterdir() if path.is_file()]
    return checksum([*shipped, *(path for path in folder.rglob("*") if path.is_file() and path.suffix != ".toml")])


def input_of(case: Case) -> str:
    """Identity of a case's input."""
    return checksum([case.deck]) + data_beside(case.deck.parent)


def file_of(name: str) -> Path:
    """The file of the kept values of that name."""
    return KEPT / f"{hashlib.sha256(name.encode()).hexdigest()[:24]}.json"


def load(name: str) -> dict[str, Any]:
    """The kept entry of that name; empty without one."""
    path = file_of(name)
    return json.loads(path.read_text(encoding="utf-8")) if path.exists() else {}


def keep(name: str, entry: dict[str, Any]) -> None:
    """Replace the kept entry of that name, whole at any moment."""
    KEPT.mkdir(parents=True, exist_ok=True)
    new = file_of(name).with_suffix(f".{os.getpid()}")
    new.write_text(json.dumps({"name": name, **entry}), encoding="utf-8")
    new.replace(file_of(name))


def name_of(case: Case, change: Change) -> str:
    """Name of the kept values of a case under a change of its deck."""
    return case.name + "".join(f" {key}={value!r}" for key, value in change)


def processor_seconds() -> float:
    """Processor time of this process and of the children that it waited for [s]."""
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(one.ru_utime + one.ru_stime for one in used)


def compute(case: Case, change: Change) -> tuple[Run, list[Any]]:
    """Run a case under a change and keep the values of its rows; the run, and the values in order of the rows of that change."""
    begun = processor_seconds()
    run = run_of(case, change)
    results = results_of_run(run)
    quantities = [row.quantity for row in case.rows if row.change == change]
    values = [pick(results, quantity) for quantity in quantities]
    seconds = round(processor_seconds() - begun, 1)
    keep(
        name_of(case, change),
        {"program": program(), "input": input_of(case), "quantities": quantities, "values": values, "seconds": seconds},
    )
    return run, values


def values_of(case: Case, change: Change) -> dict[str, Any] | None:
    """The kept entry of a case under a change; None without one, or for another deck, other data or other rows.

    Values, tolerances and words of the expectations may have changed since: they do not enter the computation.
    """
    was = load(name_of(case, change))
    quantities = [row.quantity for row in case.rows if row.change == change]
    return was if was.get("input") == input_of(case) and was.get("quantities") == quantities else None
