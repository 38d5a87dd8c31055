"""Number of faults that the tests detect: faults are planted one at a time in a copy, built and tested.

    python tools/seeded_faults.py [--count 80] [--seed 1] [--place build/faults] [--again] [--package NAME] [--only FILE:LINE]
    python tools/seeded_faults.py --suite properties [--python] [--count 30]

In Fortran and C a fault is a changed sign or operator, constant, comparison or bound of a loop. In Python (`--python`), at
the joins of strategies alone, it is a changed sign, a dropped key or filter, another set of blocks, a unit factor or an outcome.
The rule of a fault of a join (faults.py) precedes the draw. Faults that change only words, schedules, files, rounding or
a constant of a kernel are not drawn. The place is drawn from the seed; every package gets its share. A fault counts as caught if
the build, a quick test of its package or a case fails; with `--suite properties` if the build or the property suite alone
fails (tests/properties): of Python the relations that
run through the changed line, of the kernels those that call the changed module, the quickest first, and those whose results change again with
more cases. A fault that changes no result of the suite, one that no relation runs through and one that exceeds its processor time are named. Tests that fail
without a fault are found first, and skipped. The fate of each fault is kept in the place, and an interrupted run
continues from there; `--again` tries those anew that were not caught, after tests were written. Those that are not caught
are printed with their place, and all are noted for the verification book. equivalent_faults.toml names faults that change
no result, each with its reason; they are listed apart and not counted. `--list` prints the chosen faults and plants none.
"""

import argparse
import json
import os
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
import apart
from fault_tests import NOT_CAUGHT, ROOMS, caught_by, failing, touched
from faults import EQUIVALENT, draw, faults_of, python_faults_of


def main() -> int:
    """Plant all; the number of faults that no test saw."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--count", type=int, default=80)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument(
        "--patience", type=int, default=300, help="seconds of a processor that the tests of a package, or one relation, may take"
    )
    parser.add_argument("--place", type=Path, default=apart.ROOT / "build" / "faults")
    parser.add_argument("--again", action="store_true", help="the faults anew that were not caught")
    parser.add_argument("--package", choices=list(ROOMS), help="faults of one package of the core alone")
    parser.add_argument("--only", help="FILE:LINE, the faults of one line")
    parser.add_argument("--suite", choices=["quick", "properties"], default="quick", help="which tests are to see them")
    parser.add_argument("--python", action="store_true", help="faults in Python at the joins, seen by the property suite")
    parser.add_argument("--list", action="store_true", help="print the faults, and plant none")
    options = parser.parse_args()
    properties = options.suite == "properties"
    if options.python and not properties:
        parser.error("--python needs --suite properties")
    chosen = draw(options.count, options.seed, [options.package] if options.package else ROOMS, options.python, properties)
    if options.only:
        file, line = options.only.split(":")
        every = python_faults_of if file.endswith(".py") else faults_of
        chosen = [fault for fault in every(apart.ROOT / file) if fault.line == int(line)]
    if options.list:
        print(*chosen, sep="\n")
        return 0
    place = options.place.resolve()
    place.mkdir(parents=True, exist_ok=True)
    apart.copy(place)
    apart.build(place, "-Dbuildtype=plain", "-Doptimization=1")
    name = "fates.json" if not properties else f"fates-properties-{'python' if options.python else 'kernels'}.json"
    kept = place / name
    fates: dict[str, str] = json.loads(kept.read_text(encoding="utf-8")) if kept.exists() else {}
    todo = [f for f in chosen if options.only or str(f) not in fates or (options.again and fates[str(f)] in NOT_CAUGHT)]
    todo.sort(key=lambda fault: fault.room)  # the tests of a package pass without a fault before its first is planted
    if properties and todo:
        touched(place)  # which passes without a fault
    for k, fault in enumerate(todo, start=1):
        if not properties and f"{fault.room} without a fault" not in fates:
            apart.build(place)  # without the last fault
            if by := failing(place, fault.room, 10 * options.patience):
                sys.exit(f"{fault.room}: {by} fails without a fault")
            print(f"{fault.room}: its tests pass", flush=True)
            fates[f"{fault.room} without a fault"] = "nothing"
        begin = time.monotonic()
        by = fates[str(fault)] = caught_by(place, fault, options.patience, properties)
        seconds = time.monotonic() - begin
        print(f"{k}/{len(todo)} {f'caught by {by}' if by not in NOT_CAUGHT else f'NOT CAUGHT {by}'} ({seconds:.0f} s) {fault}", flush=True)
        kept.write_text(json.dumps(fates, indent=1), encoding="utf-8")
    loose = [fault for fault in chosen if fates[str(fault)] in NOT_CAUGHT]
    equal = [fault for fault in loose if fault.change in EQUIVALENT]
    missed = [f"{fault} {fates[str(fault)]}".strip() for fault in loose if fault not in equal]
    tried = len(chosen) - len(equal)
    print(f"{tried - len(missed)} of {tried} caught", *missed, sep="\n")
    excluded = [f"changes no result, and counts neither way: {fault}: {EQUIVALENT[fault.change]}" for fault in equal]
    print(*excluded, sep="\n")
    if not (options.only or options.package):
        notes = apart.ROOT / "build" / "trials"
        notes.mkdir(parents=True, exist_ok=True)
        where, file = "in Fortran and C that no quick test sees", "seeded-faults.json"
        if properties:
            where = f"at the joins in {'Python' if options.python else 'Fortran'} that the property suite alone does not see"
            file = f"seeded-faults-properties-{'python' if options.python else 'kernels'}.json"
        row = {"what": f"faults planted {where}", "tried": tried, "failures": len(missed), "notes": missed + excluded}
        (notes / file).write_text(json.dumps(row, indent=1), encoding="utf-8")
    return len(missed)


if __name__ == "__main__":
    os.chdir(apart.ROOT)
    sys.exit(min(main(), 1))
