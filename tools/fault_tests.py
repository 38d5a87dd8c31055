"""Whether tests detect a fault: the tests of its package, or the relations of the property suite that run through it."""

import ast
import hashlib
import json
import os
import re
import resource
import signal
import subprocess
import sys
import time
from dataclasses import asdict, dataclass
from functools import cache
from pathlib import Path
from typing import Any

import apart
from faults import KERNELS, PACKAGE, Fault, plant

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
#: Share of the whole count of the property suite that a fault is tried with
SHARE = "0.06"
#: Modules of the property suite that all relations share
SHARED = ("asking", "buildings", "relations")
#: What a run exits with that could not plant its fault
BROKE = 2
#: How much longer a test may take with a fault than without
SLOWER = 5.0
#: Chapters of the property suite that ask kernels themselves
KERNEL_CHAPTERS = ("kernels.py", "crowds.py")
#: Share of the cases of those of less than so many seconds
OF_KERNELS, QUICK = 0.5, 0.3
#: Share of the cases with which relations whose results change are repeated
MORE = 0.3
#: Fates of a fault that no relation finds: a result changes, none does, no relation runs through it, the time is up
MISSED, UNCHANGED, NOWHERE, UNDECIDED = "", "no result of the suite changes", "no relation runs through it", "undecided"
#: Fate of one with which a test takes much longer
ENDLESS = "a test that does not end"
#: Those of them that no test caught
NOT_CAUGHT = (MISSED, UNCHANGED, NOWHERE, UNDECIDED)


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
    """A test of the property suite without a fault: the file of its text, seconds of a processor, digest of its results, the lines of
    Python that it runs through."""

    test: str
    chapter: str
    seconds: float
    results: str
    lines: frozenset[tuple[str, int]]


def _read(kept: Path) -> list[dict[str, Any]]:
    return [json.loads(row) for row in kept.read_text(encoding="utf-8").splitlines()] if kept.exists() else []


def rows_of(kept: Path) -> list[Row]:
    """The tests noted in a file, the quickest first."""
    found = [Row(r["test"], r["chapter"], r["seconds"], r["results"], frozenset((file, n) for file, n in r["lines"])) for r in _read(kept)]
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
    """The tests of the property suite that run through the changed statement, the quickest first, then those that run through its
    function, as other cases may go another way through it; beside a changed kernel, first those
    of the chapters that call kernels themselves."""
    rows = touched(place)
    if not fault.in_python:
        core = tuple(f"core/{name}" for name in KERNELS[fault.file].split())
        beside = [row for row in rows if any(file.startswith(core) for file, _ in row.lines)]
        return sorted(beside, key=lambda row: row.chapter not in KERNEL_CHAPTERS)
    file = fault.file.removeprefix(f"{PACKAGE}/")
    tree = ast.parse((place / fault.file).read_text(encoding="utf-8"))
    inside = [n for n in ast.walk(tree) if isinstance(n, ast.FunctionDef) and n.lineno <= fault.line <= (n.end_lineno or 0)]
    body = max(inside, key=lambda n: n.lineno)
    spans = (span_of(tree, fault.line), range(body.body[0].lineno, (body.end_lineno or 0) + 1))
    ranks = {row: next((k for k, span in enumerate(spans) if any((file, n) in row.lines for n in span)), None) for row in rows}
    return sorted((row for row in rows if ranks[row] is not None), key=lambda row: ranks[row] or 0)


@cache
def suite(place: Path) -> subprocess.Popen[str]:
    """The property suite, loaded without a fault, which waits for faults and the tests to run with each."""
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


@dataclass(frozen=True)
class Planted:
    """The change in a fork of the suite: a line of a file of Python, or another build of the core, or none."""

    file: str = ""
    line: int = 0
    new: str = ""
    core: str = ""


def asked_of(place: Path, planted: Planted, shares: dict[Row, float], patience: int) -> tuple[str, list[Row]]:
    """The first of some tests that fails with a fault, or one of the `NOT_CAUGHT`, and the notes of the tests before; shares: of the
    cases, by test; patience: seconds of a processor for all."""
    limits = {row.test: (max(0.25 * patience, SLOWER * row.seconds * share / float(SHARE)), share) for row, share in shares.items()}
    kept, failed, process = place / "results.jsonl", place / "failed.txt", suite(place)
    kept.unlink(missing_ok=True)
    assert process.stdin is not None and process.stdout is not None
    question = {**asdict(planted), "tests": limits, "limit": patience, "kept": str(kept), "failed": str(failed)}
    process.stdin.write(json.dumps(question) + "\n")
    process.stdin.flush()
    code = next((int(text.split()[1]) for text in process.stdout if text.startswith("ended: ")), None)
    if code is None or code == BROKE:
        raise RuntimeError(f"the property suite did not run with {planted}")
    by = {0: MISSED, -signal.SIGPROF: ENDLESS, -signal.SIGXCPU: UNDECIDED, -signal.SIGKILL: UNDECIDED}
    if code == 1:
        return failed.read_text(encoding="utf-8"), rows_of(kept)
    return by.get(code, f"exit {code}"), rows_of(kept)


@cache
def passes(place: Path, row: Row, share: float, patience: int) -> bool:
    """Whether a test passes without a fault, with a share of the cases."""
    return asked_of(place, Planted(), {row: share}, patience)[0] == MISSED


def finding(place: Path, planted: Planted, shares: dict[Row, float], patience: int) -> tuple[str, list[Row]]:
    """`asked_of`, without tests that fail without a fault too."""
    spare, passed = dict(shares), []
    while True:
        by, seen = asked_of(place, planted, spare, patience)
        passed += seen
        spare = {row: share for row, share in spare.items() if row.test not in {one.test for one in seen}}
        at = next((row for row in spare if by in (row.test, ENDLESS)), None)
        if at is None or passes(place, at, spare[at], patience):
            return by, passed
        print(f"skipped, since it fails without a fault: {at.test}", flush=True)
        del spare[at]


def failing_relation(place: Path, fault: Fault, planted: Planted, patience: int) -> str:
    """The first test of the property suite that fails with a fault planted, in the order of `relations_of`, then with more cases those
    whose results change, or all; else one of the `NOT_CAUGHT`."""
    chosen = relations_of(place, fault)
    if not chosen:
        return NOWHERE
    shares = {row: OF_KERNELS if row.chapter in KERNEL_CHAPTERS and row.seconds < QUICK else float(SHARE) for row in chosen}
    by, seen = finding(place, planted, shares, patience)
    before = {row.test: row.results for row in chosen}
    turned = {row.test for row in seen if row.results != before[row.test]}
    changed = [row for row in chosen if row.test in turned]
    if by == MISSED:
        more, _ = finding(place, planted, {row: MORE for row in changed or chosen}, patience)
        by = (MISSED if changed else UNCHANGED) if more in NOT_CAUGHT else f"{more} with more cases"
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
        planted = Planted(fault.file.removeprefix(f"{PACKAGE}/"), fault.line, fault.new)
        return failing_relation(place, fault, planted, patience)
    core = place / "cores" / f"{time.monotonic_ns()}.so"  # a new name: the loader does not load a file of the same name twice
    plant(place, fault)
    try:
        if properties:
            apart.build_core(place, core)
        else:
            apart.build(place)
    except subprocess.CalledProcessError:
        return "the build"
    else:
        return failing_relation(place, fault, Planted(core=str(core)), patience) if properties else failing(place, fault.room, patience)
    finally:
        core.unlink(missing_ok=True)
        plant(place, fault, back=True)
