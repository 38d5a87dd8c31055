"""Run the Fortran and C tests of the build that this environment uses; exits with their status."""

import subprocess
import sys
from pathlib import Path

root = Path(__file__).resolve().parents[1]
builds = sorted(p.parent for p in root.glob("build/*/build.ninja"))
if not builds:
    sys.exit("no build folder: run make setup")
meson = Path(sys.executable).with_name("meson")
for build in builds:
    run = subprocess.run([str(meson), "test", "-C", str(build), "--print-errorlogs"], capture_output=True, text=True)
    print(run.stdout[run.stdout.find("1/") :] if run.returncode == 0 else run.stdout + run.stderr)
    if run.returncode:
        sys.exit(run.returncode)
