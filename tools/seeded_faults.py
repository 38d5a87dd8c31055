"""Number of faults that the tests detect: faults are planted one at a time in a copy, built and tested.

    python tools/seeded_faults.py [--count 80] [--seed 1] [--place build/faults] [--again] [--package NAME] [--only FILE:LINE]
    python tools/seeded_faults.py --suite properties [--python] [--count 30]

In Fortran and C a fault is a changed sign or operator, constant, comparison or bound of a loop; in Python (`--python`), at
the joins of strategies alone, a changed sign, a dropped key or filter, another set of blocks, a unit factor or an outcome. Its place
is drawn from the seed; every package gets its share. A fault counts as caught if the build, a quick test of its package or a case
fails; with `--suite properties` if the build or the property suite alone fails (tests/properties): of Python the relations that
run through the changed line, of the kernels those that call the changed module, the quickest first, and those whose results change again with
more cases. A fault that changes no result of the suite, one that no relation runs through and one that exceeds its processor time are named. Tests that fail
without a fault are found first, and skipped. The fate of each fault is kept in the place, and an interrupted run
continues from there; `--again` tries those anew that were not caught, after tests were written. Those that are not caught
are printed with their place, and all are noted for the verification book. equivalent_faults.toml names faults that change
no result, each with its reason; they are listed apart and not counted. `--list` prints the chosen faults and plants none.
"""

import argparse
import ast
import hashlib
import io
import json
import os
import random
import re
import resource
import signal
import subprocess
import sys
import time
import tokenize
import tomllib
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

sys.path.insert(0, str(Path(__file__).parent))
import apart

#: package -> tests of its own in Fortran and C, then those in Python, the quickest first, then its cases
ROOMS: dict[str, tuple[tuple[str, ...], tuple[str, ...], str]] = {
    "fortran/common": (
        ("test_dopri5", "test_motion_set", "test_motion", "test_rocking"),
        ("unit/test_motion_core.py", "unit/test_block.py", "unit/test_mechanism.py", "unit/test_statistics.py"),
        "rocking/ or arch/",
    ),
    "fortran/arch": (("test_four_hinge",), ("unit/test_mechanism.py", "verification/test_arch_rocking.py", "unit/test_border.py"), "arch/"),
    "fortran/mechanism": (
        ("test_mechanism",),
        ("unit/test_mechanism.py", "unit/test_impact.py", "unit/test_restraints.py", "verification/test_vault_rocking.py"),
        "arch/ or vault/",
    ),
    "fortran/rocking": (
        ("test_rocking",),
        (
            "unit/test_block.py",
            "unit/test_soft_base.py",
            "unit/test_stack.py",
            "unit/test_restraints.py",
            "verification/test_rocking_reference.py",
            "unit/test_statistics.py",
            "unit/test_fragility.py",
        ),
        "rocking/ or arch/",
    ),
    "fortran/motion": (("test_motion",), ("unit/test_motion_core.py", "unit/test_generated.py"), "motion/"),
    "fortran/dem": (
        ("test_dem",),
        (
            "unit/test_dem_core.py",
            "unit/test_dem_rules.py",
            "unit/test_dem_nonsmooth.py",
            "unit/test_dem_analysis.py",
            "unit/test_dem_ties.py",
        ),
        "dem/",
    ),
    "fortran/dem3": (
        (),
        ("unit/test_dem3_core.py", "unit/test_dem3_nonsmooth.py", "unit/test_dem_solids.py", "unit/test_dem_ties.py"),
        "solid/dem",
    ),
    "fortran/nonsmooth": ((), ("unit/test_dem_nonsmooth.py", "unit/test_dem3_nonsmooth.py"), "solid/dem-nonsmooth"),
    "fortran/limit": (
        (),
        ("unit/test_vertex.py", "unit/test_limit_arches.py", "unit/test_limit_vaults.py", "unit/test_limit_loads.py"),
        "limit/ or bridge/",
    ),
    "fortran/sla": (
        ("test_sla", "test_sla_margin"),
        (
            "unit/test_sla_elements.py",
            "unit/test_sla_teeth.py",
            "unit/test_sla_joints.py",
            "unit/test_sla_events.py",
            "unit/test_sla_stones.py",
            "unit/test_sla_walls.py",
        ),
        "sla/",
    ),
    "fortran/shell": (
        ("test_shell",),
        (
            "unit/test_shell_elements.py",
            "unit/test_shell_events.py",
            "unit/test_shell_vaults.py",
            "unit/test_floors.py",
            "unit/test_vault_shells.py",
            "unit/test_shell_joints.py",
        ),
        "shell/ or building/one-way",
    ),
    "fortran/frame": (
        (),
        ("unit/test_frame_elements.py", "unit/test_frame_view.py", "unit/test_frame_analyses.py", "unit/test_frame_fragility.py"),
        "frame/",
    ),
    "c/quake": (("test_quake", "test_motion"), ("unit/test_motion_core.py", "unit/test_generated.py"), "motion/"),
    "c/sparse": (("test_sparse", "test_sla"), ("unit/test_sla_events.py", "unit/test_vertex.py"), "sla/"),
    "c/common": (("test_handles", "test_threads", "test_blas"), ("unit/test_border.py", "unit/test_cli.py"), "limit/oppenheim"),
}

#: kind -> (pattern of the changed part, its replacements)
FAULTS = {
    "sign": [(r"(?<=[\w)]) \+ (?=[\w(])", " - "), (r"(?<=[\w)]) - (?=[\w(])", " + ")],
    "operator": [(r"(?<=[\w)]) \* (?=[\w(])", " / ")],
    "constant": [(r"(?<![\w.])(?:0\.5|2\.0|3\.0|4\.0|6\.0|0\.25|1\.5|12\.0)(?=_wp|\b(?!e))", None)],
    "comparison": [(r" <= ", " > "), (r" >= ", " < "), (r" < ", " >= "), (r" > ", " <= "), (r" == ", " /= ")],
    "bound": [(r"(?<=\bdo \w = )1(?=, )", "2"), (r"(?<=\bdo [ijk] = )(\w+), (\w+)$", r"\1, \2 - 1")],
}
IN_C = {" == ": " != "}
#: Faults of Python, whose texts and comments are left as they are
IN_PYTHON = {
    "sign": [(r"(?<=[\w)\]]) \+ (?=[\w(\[])", " - "), (r"(?<=[\w)\]]) - (?=[\w(\[])", " + "), (r"(?<=[=(,] )-(?=[a-z(])", "")],
    "key": [(r", (?!strict\b)\w+=[\w.]+(?=[,)])", "")],
    "filter": [(r"(?<=.) if (?:(?!\belse\b)[^\[\]{}:])+(?=[\]})])", ""), (r"(?<=[)\]]) & (?=\()", " | ")],
    "set": [
        (r"\bmin\(", "max("),
        (r"\bmax\(", "min("),
        (r"\[0\]", "[-1]"),
        (r"\[-1\]", "[0]"),
        (r"\ball\(", "any("),
        (r"\bany\(", "all("),
        (r"\.a\b(?! ?=)", ".b"),
        (r"\.b\b(?! ?=)", ".a"),
    ],
    "unit": [
        (r" / GRAVITY", ""),
        (r" \* GRAVITY", ""),
        (r"\b1e3\b", "1e6"),
        (r"\.depth\b(?! ?=)", ".depth * 2.0"),
        (r"radians\(", "degrees("),
        (r"degrees\(", "radians("),
    ],
}
#: Outcomes and their replacements; these are texts
OUTCOMES = {
    '"stands"': '"collapses"',
    '"collapses"': '"stands"',
    '"cannot-stand"': '"open"',
    '"open"': '"stands"',
    '"collapse"': '"recovery"',
    '"recovery"': '"no-hinging"',
    '"upper"': '"lower"',
    '"holds"': '"fails"',
    '"fails"': '"holds"',
    '"no-sliding"': '"sliding"',
    '"left"': '"right"',
}
#: Joins of strategies: makers of models of a building, calls of the core, makers of verdicts from its results
JOINS = (
    "analyses/conclude.py",
    "analyses/sequence.py",
    "analyses/left_out.py",
    "analyses/motion_source.py",
    "analyses/assess/asking.py",
    "analyses/assess/words.py",
    "analyses/assess/reasons_of_buildings.py",
    "analyses/assess/reasons_of_motion.py",
    "analyses/assess/reasons_of_statics.py",
    "analyses/codes/kinematics.py",
    "analyses/codes/local_mechanism.py",
    "analyses/codes/mechanisms.py",
    "analyses/codes/ntc.py",
    "analyses/codes/walls.py",
    "analyses/dem/measures.py",
    "analyses/dem/model.py",
    "analyses/dem/history.py",
    "analyses/dem/job.py",
    "analyses/dem/solid_model.py",
    "analyses/dem/standing.py",
    "analyses/dem/tilt.py",
    "analyses/limit/applied.py",
    "analyses/limit/asked.py",
    "analyses/limit/common.py",
    "analyses/limit/moving_load.py",
    "analyses/limit/solids.py",
    "analyses/limit/supports.py",
    "analyses/limit/thrust.py",
    "analyses/limit/tilt.py",
    "analyses/rocking/block.py",
    "analyses/rocking/driver.py",
    "analyses/rocking/failure_domain.py",
    "analyses/rocking/mechanism.py",
    "analyses/rocking/stack.py",
    "analyses/statistics/fragility.py",
    "analyses/statistics/levels.py",
    "analyses/statistics/summaries.py",
    "views/building.py",
    "model/properties.py",
    "model/ties.py",
    "model/geometry/assembly.py",
    "model/geometry/chains.py",
    "model/geometry/compas.py",
    "model/geometry/contacts.py",
    "model/geometry/polygons.py",
    "views/rigid.py",
    "model/geometry/solids/assembly.py",
    "model/geometry/solids/contacts.py",
    "model/geometry/solids/sections.py",
    "views/rockers/arch.py",
    "views/rockers/block.py",
    "views/rockers/frame.py",
    "views/rockers/mechanism.py",
    "views/rockers/rocker.py",
    "views/rockers/stack.py",
    "model/structures/arch.py",
    "model/structures/block.py",
    "model/structures/brickwork.py",
    "model/structures/masonry.py",
    "model/structures/stack.py",
    "results/verdict.py",
    "results/codes.py",
    "results/dem.py",
    "results/rocking.py",
    "results/statistics.py",
    "running/survey.py",
)
#: Kernels at the joins, and the modules of the core that hand them their numbers
KERNELS = {
    "fortran/api/api_arch.f90": "arch",
    "fortran/api/api_dem.f90": "dem",
    "fortran/api/api_dem3.f90": "dem3",
    "fortran/api/api_dem_run.f90": "dem",
    "fortran/api/api_limit.f90": "limit",
    "fortran/api/api_mechanism.f90": "mechanism",
    "fortran/api/api_rocking.f90": "rocking",
    "fortran/api/api_stack.f90": "stack",
    "fortran/api/api_soft_base.f90": "soft_base",
    "fortran/mechanism/blow.f90": "mechanism",
    "fortran/mechanism/impact.f90": "mechanism",
    "fortran/mechanism/linkage.f90": "mechanism",
    "fortran/mechanism/table.f90": "mechanism",
    "fortran/dem/contacts.f90": "dem",
    "fortran/dem/joint.f90": "dem",
    "fortran/dem/law.f90": "dem",
    "fortran/dem/moreau.f90": "dem",
    "fortran/dem/rigid.f90": "dem",
    "fortran/dem/loading.f90": "dem",
    "fortran/dem3/patch.f90": "dem3",
    "fortran/dem3/law.f90": "dem3",
    "fortran/dem3/moreau.f90": "dem3",
    "fortran/nonsmooth/impulses.f90": "dem",
    "fortran/limit/vertex.f90": "limit",
}
PACKAGE = "python/extrados"
#: Faults that change no result, by `Fault.change`, and why
EQUIVALENT: dict[str, str] = {
    f"{row['file']}: {row['old']}  ->  {row['new']}": row["reason"]
    for row in tomllib.loads((Path(__file__).parent / "equivalent_faults.toml").read_text(encoding="utf-8"))["fault"]
}
#: Share of the whole count of the property suite that a fault is tried with
SHARE = "0.06"
#: Modules of the property suite that all relations share
SHARED = ("asking", "buildings", "relations")
#: What a run exits with that could not plant its fault
BROKE = 2
#: How much longer a test may take with a fault than without
SLOWER = 5.0
#: Share of the cases with which relations whose results change are repeated
MORE = 0.3
#: Fates of a fault that no relation finds: a result changes, none does, no relation runs through it, the time is up
MISSED, UNCHANGED, NOWHERE, UNDECIDED = "", "no result of the suite changes", "no relation runs through it", "undecided"
NOT_CAUGHT = (MISSED, UNCHANGED, NOWHERE, UNDECIDED)


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
        """The package of the file."""
        return "/".join(self.file.split("/")[:2])

    @property
    def in_python(self) -> bool:
        """Whether it needs no build."""
        return self.file.endswith(".py")

    @property
    def change(self) -> str:
        """The change itself, without its place in the file."""
        return f"{self.file}: {self.old.strip()}  ->  {self.new.strip()}"

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


def python_faults_of(path: Path) -> list[Fault]:
    """Every fault that could be planted in a file of Python: in functions, outside of texts, comments and warnings."""
    text, name = path.read_text(encoding="utf-8"), path.relative_to(apart.ROOT).as_posix()
    lines = text.split("\n")
    bare, outcomes = list(lines), []
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        (first, start), (last, end) = token.start, token.end
        if token.type == tokenize.STRING and token.string in OUTCOMES and first == last:
            outcomes.append((first, start, end, OUTCOMES[token.string]))
        if token.type in (tokenize.STRING, tokenize.COMMENT):
            for number in range(first, last + 1):
                line = bare[number - 1]
                left, right = start if number == first else 0, end if number == last else len(line)
                bare[number - 1] = line[:left] + "\0" * (right - left) + line[right:]
    inside = {
        number
        for node in ast.walk(ast.parse(text))
        if isinstance(node, ast.FunctionDef)
        for number in range(node.body[0].lineno, (node.end_lineno or 0) + 1)
    }
    found = []
    for number in sorted(inside):
        line, code = lines[number - 1], bare[number - 1]
        if re.match(r"\s*(raise|assert|def|@|import|from)\b", code) or "warn" in code or "Array(" in code:
            continue
        for kind, changes in IN_PYTHON.items():
            for pattern, new in changes:
                for place in re.finditer(pattern, code):
                    changed = line[: place.start()] + new + line[place.end() :]
                    if kind != "filter" or " for " in code[: place.start()] or "&" in place[0]:
                        found.append(Fault(kind, name, number, line, changed))
    for number, start, end, put in outcomes:
        line = lines[number - 1]
        if number in inside and "fact(" not in line:
            found.append(Fault("outcome", name, number, line, line[:start] + put + line[end:]))
    return [fault for fault in found if _is_python([*lines[: fault.line - 1], fault.new, *lines[fault.line :]])]


def _is_python(lines: list[str]) -> bool:
    try:
        ast.parse("\n".join(lines))
    except SyntaxError:
        return False
    return True


def draw(count: int, seed: int, rooms: Iterable[str] = ROOMS, python: bool = False, joins: bool = False) -> list[Fault]:
    """Faults of packages, of all kinds: each package in proportion to the root of its size, its kinds in turn; joins: at the joins alone."""
    by_room: dict[str, list[Fault]] = {}
    if python:
        for join in JOINS:
            room = "/".join(join.split("/")[:-1])
            by_room.setdefault(room, []).extend(python_faults_of(apart.ROOT / PACKAGE / join))
    else:
        for room in rooms:
            files = sorted([*(apart.ROOT / room).glob("*.f90"), *(apart.ROOT / room).glob("*.c")])
            by_room[room] = [fault for path in files for fault in faults_of(path)]
    if joins and not python:
        by_room = {}
        for file in KERNELS:
            by_room.setdefault("/".join(file.split("/")[:2]), []).extend(faults_of(apart.ROOT / file))
    weight = {room: len(there) ** 0.5 for room, there in by_room.items()}
    chosen = []
    for room, there in by_room.items():
        rng = random.Random(f"{seed} {room}")  # of its own: a change in one package draws nothing else in the others
        share = max(1 if joins else 2, round(count * weight[room] / sum(weight.values())))
        kinds = {kind: [f for f in there if f.kind == kind] for kind in sorted({f.kind for f in there})}
        for options in kinds.values():
            rng.shuffle(options)
        if joins:  # few of a package: its kinds in no order
            kinds = dict(rng.sample(sorted(kinds.items(), key=lambda item: item[0]), len(kinds)))
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
    """Commands for a package, in order, each with its name if it names no test of its own."""
    native, python, cases = ROOMS[room]
    pytest = [apart.python(place), "-m", "pytest", "-q", "-x", "-m", "not verify", "-p", "no:cacheprovider"]
    meson = [str(Path(sys.executable).with_name("meson")), "test", "-C", str(place / "build"), "--no-rebuild", "-t", "20"]
    return [
        *([([*meson, *native], "native tests")] if native else []),
        ([*pytest, *(f"tests/{test}" for test in python)], ""),
        ([*pytest, "tests/cases", "-k", cases], ""),
    ]


@dataclass(frozen=True)
class Row:
    """A test of the property suite without a fault: seconds of a processor, digest of its results, the lines of Python that it runs through."""

    test: str
    seconds: float
    results: str
    lines: frozenset[tuple[str, int]]


def _read(kept: Path) -> list[dict[str, Any]]:
    return [json.loads(row) for row in kept.read_text(encoding="utf-8").splitlines()] if kept.exists() else []


def rows_of(kept: Path) -> list[Row]:
    """The tests noted in a file, the quickest first."""
    found = [Row(r["test"], r["seconds"], r["results"], frozenset((file, n) for file, n in r["lines"])) for r in _read(kept)]
    return sorted(found, key=lambda row: row.seconds)


def environment_of(kept: Path, **more: str) -> dict[str, str]:
    """Of a run of the property suite whose tests are noted in a file."""
    return {
        **os.environ,
        "OMP_NUM_THREADS": "1",
        "PYTHONDONTWRITEBYTECODE": "1",
        "EXTRADOS_TRIALS": SHARE,
        "EXTRADOS_TOUCHED": str(kept),
        **more,
    }


@cache  # found before the first fault is planted
def touched(place: Path) -> list[Row]:
    """Tests of the property suite without a fault, by the cases that a fault is tried with: each found once for each text of its chapter. Those
    that fail are skipped, and named."""
    folder, whole = place / "tests" / "properties", hashlib.sha256()
    for path in [*(folder / f"{name}.py" for name in SHARED), *sorted((place / PACKAGE).rglob("*.py"))]:
        if path.name != "_build_info.py":  # the same of two builds
            whole.update(path.read_bytes())
    kept = place / f"touched-{whole.hexdigest()[:12]}.jsonl"
    half = kept.with_suffix(".part")
    sources = {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in folder.glob("*.py")}

    def keep() -> list[str]:
        noted = [r for r in _read(kept) + _read(half) if r["source"] == sources.get(r["chapter"])]
        kept.write_text("".join(json.dumps(r) + "\n" for r in noted), encoding="utf-8")
        half.unlink(missing_ok=True)
        return [r["test"] for r in noted]

    # What an interrupted run has noted is kept
    words = [
        apart.python(place),
        "-m",
        "pytest",
        "-q",
        "-m",
        "not verify",
        "-n",
        "2",
        "--dist",
        "worksteal",
        "-p",
        "no:cacheprovider",
        "tests/properties",
        *(f"--deselect={test}" for test in keep()),
    ]
    environment = environment_of(half, EXTRADOS_LINES="1")
    run = subprocess.run(words, cwd=place, env=environment, capture_output=True, text=True, errors="replace")
    broken = re.findall(r"^(?:FAILED|ERROR) (\S+)", run.stdout, re.M)
    print("skipped, since they fail without a fault:", *sorted(broken or ["none"]), flush=True)
    keep()
    return rows_of(kept)


def span_of(tree: ast.Module, line: int) -> range:
    """The lines of the innermost statement around a line; of one with a body, its head."""
    around = [n for n in ast.walk(tree) if isinstance(n, ast.stmt) and n.lineno <= line <= (n.end_lineno or 0)]
    inner = max(around, key=lambda n: n.lineno)
    body = getattr(inner, "body", None)
    return range(inner.lineno, body[0].lineno if body else (inner.end_lineno or line) + 1)


def relations_of(place: Path, fault: Fault) -> list[Row]:
    """The tests of the property suite that run through the changed statement or beside the changed kernel, the quickest first."""
    rows = touched(place)
    if not fault.in_python:
        core = tuple(f"core/{name}" for name in KERNELS[fault.file].split())
        return [row for row in rows if any(file.startswith(core) for file, _ in row.lines)]
    file = fault.file.removeprefix(f"{PACKAGE}/")
    span = span_of(ast.parse((place / fault.file).read_text(encoding="utf-8")), fault.line)
    return [row for row in rows if any((file, line) in row.lines for line in span)]


@cache
def suite(place: Path, build: int) -> subprocess.Popen[str]:
    """The property suite, loaded with a build, which waits for the faults of Python and the tests to run."""
    words = [apart.python(place), "-m", "pytest", "-q", "-s", "-m", "not verify", "-n", "0", "-p", "no:cacheprovider", "tests/properties"]
    environment = environment_of(place / "unused", EXTRADOS_FAULTS="1")
    return subprocess.Popen(
        words,
        cwd=place,
        env=environment,
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
        errors="replace",
    )


def asked_of(place: Path, build: int, fault: Fault, tests: list[Row], share: float, patience: int) -> tuple[str, list[Row]]:
    """The first of some tests that fails with a fault, or one of the `NOT_CAUGHT`, and the notes of the tests before."""
    limits = {row.test: max(patience, SLOWER * row.seconds * share / float(SHARE)) for row in tests}
    kept, failed, process = place / "results.jsonl", place / "failed.txt", suite(place, build)
    kept.unlink(missing_ok=True)
    assert process.stdin is not None and process.stdout is not None
    question = {
        "file": fault.file.removeprefix(f"{PACKAGE}/"),
        "line": fault.line,
        "new": fault.new if fault.in_python else "",
        "tests": limits,
        "share": share,
        "limit": 8 * patience,
        "kept": str(kept),
        "failed": str(failed),
    }
    process.stdin.write(json.dumps(question) + "\n")
    process.stdin.flush()
    code = next((int(text.split()[1]) for text in process.stdout if text.startswith("ended: ")), None)
    if code is None or code == BROKE:
        raise RuntimeError(f"the property suite did not run with {fault}")
    by = {0: MISSED, -signal.SIGPROF: "a test that does not end", -signal.SIGXCPU: UNDECIDED, -signal.SIGKILL: UNDECIDED}
    if code == 1:
        return failed.read_text(encoding="utf-8"), rows_of(kept)
    return by.get(code, f"exit {code}"), rows_of(kept)


def failing_relation(place: Path, fault: Fault, patience: int) -> str:
    """The first test of the property suite that fails with a fault planted, the quickest first, then with more cases those
    whose results change, or all; else one of the `NOT_CAUGHT`."""
    chosen = relations_of(place, fault)
    if not chosen:
        return NOWHERE
    build = 0 if fault.in_python else time.monotonic_ns()
    by, seen = asked_of(place, build, fault, chosen, float(SHARE), patience)
    before = {row.test: row.results for row in chosen}
    turned = {row.test for row in seen if row.results != before[row.test]}
    changed = [row for row in chosen if row.test in turned]
    if by == MISSED:
        more, _ = asked_of(place, build, fault, changed or chosen, MORE, patience)
        by = (MISSED if changed else UNCHANGED) if more in NOT_CAUGHT else f"{more} with more cases"
    if build:
        suite(place, build).kill()
    return by


def failing(place: Path, room: str, patience: int) -> str:
    """The first failing test of a package, or ""."""
    environment = {**os.environ, "OMP_NUM_THREADS": "1", "PYTHONDONTWRITEBYTECODE": "1"}
    for command, name in commands(place, room):
        run = subprocess.run(
            command,
            cwd=place,
            env=environment,
            capture_output=True,
            text=True,
            errors="replace",
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_CPU, (patience, patience)),
        )
        if run.returncode in (-signal.SIGXCPU, -signal.SIGKILL):
            return "a test that does not end"
        if run.returncode:
            failed = re.search(r"^(?:FAILED|ERROR) (\S+)", run.stdout, re.M)
            return name or (failed[1] if failed else f"exit {run.returncode}: {(run.stdout + run.stderr)[-200:]}")
    return ""


def caught_by(place: Path, fault: Fault, patience: int, properties: bool = False) -> str:
    """The test that fails with a fault planted, or ""; properties: of the property suite alone."""
    if fault.in_python:
        return failing_relation(place, fault, patience)
    plant(place, fault)
    try:
        if not fault.in_python:
            try:
                apart.build(place)
            except subprocess.CalledProcessError:
                return "the build"
        return failing_relation(place, fault, patience) if properties else failing(place, fault.room, patience)
    finally:
        plant(place, fault, back=True)


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
