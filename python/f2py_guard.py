"""Run f2py and fail on what it only mutters about.

f2py maps an unknown kind to a C float, skips what it cannot parse, and returns 0 all the same.
"""

import os
import re
import subprocess
import sys

out, module, *sources = sys.argv[1:]
sources = [os.path.abspath(source) for source in sources]
run = subprocess.run(
    [sys.executable, "-m", "numpy.f2py", *sources, "-m", module, "--lower", "--freethreading-compatible", "--build-dir", out],
    capture_output=True,
    text=True,
)
said = run.stdout + run.stderr
bad = re.findall(r"^.*(?:is mapped to C|not impl|kipping|No C typespec|crackline:.*unknown).*$", said, re.M)
missing = [name for name in (f"{module}module.c", f"{module}-f2pywrappers2.f90") if not os.path.exists(os.path.join(out, name))]
if run.returncode or bad or missing:
    sys.exit("\n".join([said, "f2py guard refuses:", *bad, *(f"missing {name}" for name in missing)]))
