"""How many faults in Fortran and C the quick tests see: faults are planted one at a time in a copy, built and tested.

    python tools/seeded_faults.py [--count 80] [--seed 1] [--place build/faults] [--again] [--room ROOM] [--only FILE:LINE]

A fault is a changed sign or operator, constant, comparison or bound of a loop, at a place drawn from the seed; every
room gets its share. A fault counts as caught where the build, a quick test of its room or a case fails; without a fault
all of them pass, which is seen to first. What becomes of each fault is kept in the place, and a run that was broken off
goes on from there; `--again` tries those anew that were not caught, after tests were written. Those that are not caught
are printed with their place, and all are noted for the verification book.
"""

import argparse
import json
import os
import random
import re
import resource
import signal
import subprocess
import sys
import time
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))
import apart

#: room -> tests of its own in Fortran and C, then those in Python, the quickest first, then its cases
ROOMS: dict[str, tuple[tuple[str, ...], tuple[str, ...], str]] = {
    "fortran/common": (
        ("test_dopri5", "test_motion_set", "test_motion", "test_rocking"),
        ("unit/test_motion_core.py", "unit/test_block.py", "unit/test_mechanism.py", "unit/test_statistics.py"),
        "rocking/ or arch/",
    ),
    "fortran/arch": (
        ("test_four_hinge",),
        ("unit/test_mechanism.py", "verification/test_arch_rocking.py", "unit/test_border.py"),
        "arch/",
    ),
    "fortran/mechanism": (
        ("test_mechanism",),
        ("unit/test_mechanism.py", "unit/test_impact.py", "unit/test_restraints.py", "verification/test_vault_rocking.py"),
        "arch/ or vault/",
    ),
    "fortran/rocking": (
        ("test_rocking",),
        ("unit/test_block.py", "unit/test_soft_base.py", "unit/test_stack.py", "unit/test_restraints.py",
         "verification/test_rocking_reference.py", "unit/test_statistics.py", "unit/test_fragility.py"),
        "rocking/ or arch/",
    ),
    "fortran/motion": (("test_motion",), ("unit/test_motion_core.py", "unit/test_generated.py"), "motion/"),
    "fortran/dem": (
        ("test_dem",),
        ("unit/test_dem_core.py", "unit/test_dem_rules.py", "unit/test_dem_nonsmooth.py", "unit/test_dem_analysis.py"),
        "dem/",
    ),
    "fortran/dem3": ((), ("unit/test_dem3_core.py", "unit/test_dem3_nonsmooth.py", "unit/test_dem_solids.py"), "solid/dem"),
    "fortran/nonsmooth": ((), ("unit/test_dem_nonsmooth.py", "unit/test_dem3_nonsmooth.py"), "solid/dem-nonsmooth"),
    "fortran/limit": (
        (),
        ("unit/test_vertex.py", "unit/test_limit_arches.py", "unit/test_limit_vaults.py", "unit/test_limit_loads.py"),
        "limit/ or bridge/",
    ),
    "fortran/sla": (
        ("test_sla", "test_sla_margin"),
        ("unit/test_sla_elements.py", "unit/test_sla_teeth.py", "unit/test_sla_joints.py", "unit/test_sla_events.py",
         "unit/test_sla_stones.py", "unit/test_sla_walls.py"),
        "sla/",
    ),
    "fortran/shell": (
        ("test_shell",),
        ("unit/test_shell_elements.py", "unit/test_shell_events.py", "unit/test_shell_vaults.py", "unit/test_floors.py",
         "unit/test_vault_shells.py", "unit/test_shell_joints.py"),
        "shell/ or building/one-way",
    ),
    "c/quake": (("test_quake", "test_motion"), ("unit/test_motion_core.py", "unit/test_generated.py"), "motion/"),
    "c/sparse": (("test_sparse", "test_sla"), ("unit/test_sla_events.py", "unit/test_vertex.py"), "sla/"),
    "c/common": (("test_handles", "test_threads", "test_blas"), ("unit/test_border.py", "unit/test_cli.py"), "limit/oppenheim"),
}  # fmt: skip

#: kind -> (pattern of the part that is changed, what stands in its place)
FAULTS = {
    "sign": [(r"(?<=[\w)]) \+ (?=[\w(])", " - "), (r"(?<=[\w)]) - (?=[\w(])", " + ")],
    "operator": [(r"(?<=[\w)]) \* (?=[\w(])", " / ")],
    "constant": [(r"(?<![\w.])(?:0\.5|2\.0|3\.0|4\.0|6\.0|0\.25|1\.5|12\.0)(?=_wp|\b(?!e))", None)],
    "comparison": [(r" <= ", " > "), (r" >= ", " < "), (r" < ", " >= "), (r" > ", " <= "), (r" == ", " /= ")],
    "bound": [(r"(?<=\bdo \w = )1(?=, )", "2"), (r"(?<=\bdo [ijk] = )(\w+), (\w+)$", r"\1, \2 - 1")],
}
IN_C = {" == ": " != "}


@dataclass(frozen=True)
class Fault:
    """One change of one line."""

    kind: str
    file: str
    line: int
    old: str
    new: str

    @property
    def room(self) -> str:
        """The room that the file belongs to."""
        return "/".join(self.file.split("/")[:2])

    def __str__(self) -> str:
        return f"{self.file}:{self.line}: {self.kind}: {self.old.strip()}  ->  {self.new.strip()}"


def is_code(line: str, in_c: bool) -> bool:
    """A statement, no comment, declaration or directive."""
    text = line.strip()
    if in_c:
        return bool(text) and not text.startswith(("/*", "*", "//", "#")) and text.endswith((";", "{"))
    return bool(text) and not text.startswith("!") and "::" not in text and not text.startswith(("allocate", "call "))


def faults_of(path: Path) -> list[Fault]:
    """Every fault that could be planted in a file."""
    in_c = path.suffix == ".c"
    name = path.relative_to(apart.ROOT).as_posix()
    found = []
    for number, line in enumerate(path.read_text(encoding="utf-8").split("\n"), start=1):
        if not is_code(line, in_c):
            continue
        code = line.split("/*" if in_c else "!")[0].rstrip()
        for kind, changes in FAULTS.items():
            for pattern, new in changes:
                for place in re.finditer(pattern, code):
                    if new is None:
                        put = f"{1.1 * float(place[0]):.6g}"
                    else:
                        put = place.expand(new)
                        put = IN_C.get(place[0], put) if in_c else put
                    changed = code[: place.start()] + put + code[place.end() :] + line[len(code) :]
                    found.append(Fault(kind, name, number, line, changed))
    return found


def draw(count: int, seed: int, rooms: Iterable[str] = ROOMS) -> list[Fault]:
    """Faults of rooms, of all kinds: each room by the root of what it holds, its kinds in turn."""
    by_room = {}
    for room in rooms:
        files = sorted([*(apart.ROOT / room).glob("*.f90"), *(apart.ROOT / room).glob("*.c")])
        by_room[room] = [fault for path in files for fault in faults_of(path)]
    weight = {room: len(there) ** 0.5 for room, there in by_room.items()}
    chosen = []
    for room, there in by_room.items():
        rng = random.Random(f"{seed} {room}")  # of its own: what changes in a room draws nothing else in the others
        share = max(2, round(count * weight[room] / sum(weight.values())))
        kinds = {kind: [f for f in there if f.kind == kind] for kind in FAULTS}
        for options in kinds.values():
            rng.shuffle(options)
        while share and any(kinds.values()):
            for options in kinds.values():
                if share and options:
                    chosen.append(options.pop())
                    share -= 1
    return chosen


def plant(place: Path, fault: Fault, back: bool = False) -> None:
    """Change the line of the copy, or take the change back."""
    path = place / fault.file
    lines = path.read_text(encoding="utf-8").split("\n")
    lines[fault.line - 1] = fault.old if back else fault.new
    path.write_text("\n".join(lines), encoding="utf-8")


def commands(place: Path, room: str) -> list[tuple[list[str], str]]:
    """What is run for a room, in order, and what each is called where it names no test of its own."""
    native, python, cases = ROOMS[room]
    pytest = [apart.python(place), "-m", "pytest", "-q", "-x", "-p", "no:cacheprovider"]
    meson = [
        str(Path(sys.executable).with_name("meson")),
        "test",
        "-C",
        str(place / "build"),
        "--no-rebuild",
        "-t",
        "20",
    ]
    return [
        *([([*meson, *native], "native tests")] if native else []),
        ([*pytest, *(f"tests/{test}" for test in python)], ""),
        ([*pytest, "tests/cases", "-k", cases], ""),
    ]


def failing(place: Path, room: str, patience: int) -> str:
    """The first test of a room that fails, "" where none does."""
    environment = {**os.environ, "OMP_NUM_THREADS": "1", "PYTHONDONTWRITEBYTECODE": "1"}
    for command, name in commands(place, room):
        run = subprocess.run(
            command, cwd=place, env=environment, capture_output=True, text=True, errors="replace",
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (patience, patience)),
        )  # fmt: skip
        if run.returncode in (-signal.SIGXCPU, -signal.SIGKILL):
            return "a test that does not end"
        if run.returncode:
            failed = re.search(r"^(?:FAILED|ERROR) (\S+)", run.stdout, re.M)
            return name or (failed[1] if failed else f"exit {run.returncode}: {(run.stdout + run.stderr)[-200:]}")
    return ""


def caught_by(place: Path, fault: Fault, patience: int) -> str:
    """The test that fails with a fault planted, "" where none does."""
    plant(place, fault)
    try:
        try:
            apart.build(place)
        except subprocess.CalledProcessError:
            return "the build"
        return failing(place, fault.room, patience)
    finally:
        plant(place, fault, back=True)


def main() -> int:
    """Plant all; the number of faults that no test saw."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--count", type=int, default=80)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--patience", type=int, default=300, help="seconds of a processor that a room's tests may take")
    parser.add_argument("--place", type=Path, default=apart.ROOT / "build" / "faults")
    parser.add_argument("--again", action="store_true", help="the faults anew that were not caught")
    parser.add_argument("--room", choices=list(ROOMS), help="faults of one room alone")
    parser.add_argument("--only", help="FILE:LINE, the faults of one line")
    options = parser.parse_args()
    place = options.place.resolve()
    place.mkdir(parents=True, exist_ok=True)
    apart.copy(place)
    apart.build(place, "-Dbuildtype=plain", "-Doptimization=1")
    chosen = draw(options.count, options.seed, [options.room] if options.room else ROOMS)
    if options.only:
        file, line = options.only.split(":")
        chosen = [fault for fault in faults_of(apart.ROOT / file) if fault.line == int(line)]
    kept = place / "fates.json"
    fates: dict[str, str] = json.loads(kept.read_text(encoding="utf-8")) if kept.exists() else {}
    todo = [f for f in chosen if options.only or str(f) not in fates or (options.again and not fates[str(f)])]
    todo.sort(key=lambda fault: fault.room)  # the tests of a room pass without a fault before its first is planted
    for k, fault in enumerate(todo, start=1):
        if f"{fault.room} as it is" not in fates:
            apart.build(place)  # without the last fault
            if by := failing(place, fault.room, 10 * options.patience):
                sys.exit(f"{fault.room}: {by} fails without a fault")
            print(f"{fault.room}: its tests pass", flush=True)
            fates[f"{fault.room} as it is"] = "nothing"
        begin = time.monotonic()
        by = fates[str(fault)] = caught_by(place, fault, options.patience)
        seconds = time.monotonic() - begin
        print(f"{k}/{len(todo)} {f'caught by {by}' if by else 'NOT CAUGHT'} ({seconds:.0f} s) {fault}", flush=True)
        kept.write_text(json.dumps(fates, indent=1), encoding="utf-8")
    missed = [str(fault) for fault in chosen if not fates[str(fault)]]
    print(f"{len(chosen) - len(missed)} of {len(chosen)} caught", *missed, sep="\n")
    if not (options.only or options.room):
        notes = apart.ROOT / "build" / "trials"
        notes.mkdir(parents=True, exist_ok=True)
        row = {"what": "faults planted in Fortran and C that no quick test sees", "tried": len(chosen),
               "failures": len(missed), "notes": missed}  # fmt: skip
        (notes / "seeded-faults.json").write_text(json.dumps(row, indent=1), encoding="utf-8")
    return len(missed)


if __name__ == "__main__":
    os.chdir(apart.ROOT)
    sys.exit(min(main(), 1))
