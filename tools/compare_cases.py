"""Run every deck of cases/ into a folder, and compare two such folders bit for bit.

A change of the program that must not change a number is checked by

    tools/compare_cases.py run BEFORE          by the interpreter of the old build (`tools/apart.py` makes one)
    tools/compare_cases.py run AFTER           by that of the new build
    tools/compare_cases.py compare BEFORE AFTER

`run` keeps the decks that the folder holds already, so it can be stopped and started again; PART names only decks whose name
contains it. Compared are the results of summary.json and the arrays of results.h5. Times of the run are not compared.
"""

import argparse
import json
import math
import os
import subprocess
import sys
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

import h5py
import numpy as np

ROOT = Path(__file__).resolve().parents[1]
CASES = ROOT / "cases"
#: Results that measure the machine
TIMES = ("seconds", "seconds_per_event", "sections_per_second")


def decks(parts: list[str]) -> list[str]:
    """Names of the decks that contain one of the parts, or of all decks if no part is given."""
    names = sorted(str(p.relative_to(CASES).with_suffix("")) for p in CASES.rglob("*.toml") if not p.name.endswith(".expect.toml"))
    return [n for n in names if not parts or any(part in n for part in parts)]


def run(folder: Path, parts: list[str], processes: int, limit: float) -> None:
    """Run the decks into the folder, one subfolder each; a deck that takes longer than the limit [s] is named and left."""

    # NumPy's products share out their sums among the threads of OpenBLAS, which changes the last digits
    one_thread = {**os.environ, "OPENBLAS_NUM_THREADS": "1"}

    def run_deck(name: str) -> None:
        out = folder / name
        if (out / "summary.json").exists():
            return
        start = time.monotonic()
        command = [
            sys.executable,
            "-m",
            "extrados",
            "run",
            str(CASES / f"{name}.toml"),
            "--out",
            str(out),
            "--no-figures",
            "--quiet",
            "--threads",
            "1",
        ]
        try:
            code = str(subprocess.run(command, timeout=limit, capture_output=True, env=one_thread).returncode)
        except subprocess.TimeoutExpired:
            code = "stopped"
        print(f"{name}: {code}, {time.monotonic() - start:.1f} s", flush=True)

    folder.mkdir(parents=True, exist_ok=True)
    with ThreadPoolExecutor(processes) as pool:
        list(pool.map(run_deck, decks(parts)))


def numbers(place: Any, name: str) -> Iterator[tuple[str, Any]]:
    """Every value of a tree of JSON with the way to it."""
    if isinstance(place, dict):
        for key, value in place.items():
            if key not in TIMES:
                yield from numbers(value, f"{name}.{key}")
    elif isinstance(place, list):
        for i, value in enumerate(place):
            yield from numbers(value, f"{name}[{i}]")
    else:
        yield name, place


def values(folder: Path) -> dict[str, Any]:
    """All numbers and texts of the results of a run, and the bytes of its arrays."""
    summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    found = dict(numbers(summary["analyses"], "analyses"))
    arrays = folder / "results.h5"
    if arrays.exists():
        with h5py.File(arrays) as file:
            file.visititems(
                lambda name, item: found.__setitem__(f"results.h5:{name}", np.asarray(item[()])) if isinstance(item, h5py.Dataset) else None
            )
    return found


def same(a: Any, b: Any) -> bool:
    """Equal bit for bit; NaN equals NaN."""
    if isinstance(a, np.ndarray) and isinstance(b, np.ndarray):
        if a.dtype != b.dtype or a.shape != b.shape:
            return False
        return a.tolist() == b.tolist() if a.dtype.hasobject else a.tobytes() == b.tobytes()
    if isinstance(a, float) and isinstance(b, float):
        return a.hex() == b.hex() or (math.isnan(a) and math.isnan(b))
    return type(a) is type(b) and bool(a == b)


def compare(before: Path, after: Path, parts: list[str]) -> int:
    """Print every deck that differs, with its first differences, and the count; the number of decks that differ or lack."""
    wrong = counted = 0
    names = decks(parts)
    for name in names:
        folders = [before / name, after / name]
        lacking = [str(f) for f in folders if not (f / "summary.json").exists()]
        if lacking:
            wrong += 1
            print(f"{name}: no results in {', '.join(lacking)}")
            continue
        old, new = map(values, folders)
        counted += sum(v.size if isinstance(v, np.ndarray) else 1 for v in old.values())
        differing = [k for k in old | new if k not in old or k not in new or not same(old[k], new[k])]
        if differing:
            wrong += 1
            print(f"{name}: {len(differing)} of {len(old)} differ")
            for key in differing[:5]:
                a, b = (repr(side.get(key, "nothing"))[:60] for side in (old, new))
                print(f"   {key}: {a} -> {b}")
    print(f"{len(names) - wrong} of {len(names)} decks are equal bit for bit, {counted} values compared")
    return wrong


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("command", choices=("run", "compare"))
    parser.add_argument("folders", type=Path, nargs="+")
    parser.add_argument("--part", action="append", default=[])
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--limit", type=float, default=1200.0, help="seconds that one deck may take")
    asked = parser.parse_args()
    if len(asked.folders) != (1 if asked.command == "run" else 2):
        parser.error("run takes one folder, compare two")
    if asked.command == "run":
        run(asked.folders[0], asked.part, asked.processes, asked.limit)
    else:
        sys.exit(bool(compare(*asked.folders, asked.part)))


if __name__ == "__main__":
    main()
