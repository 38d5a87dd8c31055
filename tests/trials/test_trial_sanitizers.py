"""The core built with sanitizers, and with the checks of Fortran: its tests and its abuse once more."""

import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from test_trial_api import abuse

import trials

sys.path.insert(0, str(trials.ROOT / "tools"))
import apart

#: Tests that call the core, room by room
TESTS = (
    "unit/test_border.py",
    "unit/test_block.py",
    "unit/test_dem_core.py",
    "unit/test_mechanism.py",
    "unit/test_motion_core.py",
    "unit/test_sla_elements.py",
    "unit/test_sla_events.py",
    "unit/test_sla_teeth.py",
    "unit/test_vertex.py",
    "unit/test_stack.py",
    "unit/test_soft_base.py",
    "unit/test_restraints.py",
    "unit/test_dem3_core.py",
    "unit/test_dem_nonsmooth.py",
    "unit/test_dem3_nonsmooth.py",
    "unit/test_shell_elements.py",
    "unit/test_shell_events.py",
    "unit/test_shell_joints.py",
)
BUILDS = {
    "sanitized": ("-Dsanitize=true", "-Dbuildtype=plain", "-Doptimization=1"),
    "checked": ("-Dchecks=true", "-Dbuildtype=plain", "-Doptimization=1"),
}


@pytest.mark.verify
@pytest.mark.parametrize("name", BUILDS)
def test_the_core_under_a_watch(name: str) -> None:
    """No report of a sanitizer, no failed check, in the tests of the core and under random abuse."""
    place = trials.ROOT / "build" / name
    place.mkdir(parents=True, exist_ok=True)
    apart.copy(place)
    apart.build(place, *BUILDS[name])
    more = {"OMP_NUM_THREADS": "2"}
    if name == "sanitized":
        # The library of C++ too: what other packages throw goes through the sanitizer, which must have found it
        libraries = [
            subprocess.run(["gcc", f"-print-file-name={name}"], capture_output=True, text=True, check=True).stdout.strip()
            for name in ("libasan.so", "libstdc++.so.6")
        ]
        # Python frees little at its end, and f2py asks for a size of zero where it has none
        more |= {
            "LD_PRELOAD": ":".join(libraries),
            "ASAN_OPTIONS": "detect_leaks=0:allocator_may_return_null=1",
            "UBSAN_OPTIONS": "print_stacktrace=1",
        }
    environment = {**os.environ, "PYTHONDONTWRITEBYTECODE": "1", **more}
    trial = trials.Trial(f"core-{name}", f"tests of the {name} core that fail, and calls that it ends")
    words = [apart.python(place), "-m", "pytest", "-q", "-p", "no:cacheprovider", *(f"tests/{test}" for test in TESTS)]
    run = subprocess.run(words, cwd=place, env=environment, capture_output=True, text=True)
    counted = {word: int(n) for n, word in re.findall(r"(\d+) (passed|failed|error)", run.stdout)}
    trial.tried += sum(counted.values())
    if run.returncode:
        trial.fail(f"tests: exit {run.returncode}: {run.stdout[-1500:]} {run.stderr[-1500:]}")
    native = subprocess.run(
        [str(Path(sys.executable).with_name("meson")), "test", "-C", str(place / "build"), "--no-rebuild", "--print-errorlogs", "-t", "20"],
        env={**environment, "LD_PRELOAD": ""},
        capture_output=True,
        text=True,
    )
    trial.tried += len(re.findall(r"^ *\d+/\d+ .* OK ", native.stdout, re.M))
    if native.returncode:
        trial.fail(f"tests in Fortran and C: {native.stdout[-2000:]}")
    abuse(trial, least := trials.count_of(5000, 50), [apart.python(place)], cwd=place, env=environment)
    trial.close(least)
