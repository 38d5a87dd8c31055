"""Run all benchmarks, or those named: python tests/bench [arch ...].

Run by its path, as a package of somebody else may be called `tests` too; its folder is then where modules are looked
for first. The peers (extra `bench`) are installed first, each on its own. Each benchmark is a process of its own: one
that fails does not stop the others, and is named at the end (exit code 1).
"""

import subprocess
import sys
from pathlib import Path

from peers import install

HERE = Path(__file__).resolve().parent


def main() -> int:
    rooms = {path.stem.removeprefix("bench_"): path for path in sorted(HERE.glob("bench_*.py"))}
    wanted = sys.argv[1:] or list(rooms)
    unknown = [name for name in wanted if name not in rooms]
    if unknown:
        print(f"no benchmark {', '.join(unknown)}; there are {', '.join(rooms)}", file=sys.stderr)
        return 2
    lacking = install()
    failed = []
    for name in wanted:
        print(f"\n== {name}", flush=True)
        if code := subprocess.run([sys.executable, "-u", str(rooms[name])], check=False).returncode:
            failed.append(f"{name} (exit code {code})")
    print()
    for requirement, why in lacking.items():
        print(f"peer not to be had here: {requirement}: {why}")
    if failed:
        print(f"failed: {', '.join(failed)}")
    return bool(failed)


if __name__ == "__main__":
    try:
        sys.exit(main())
    except KeyboardInterrupt:
        sys.exit(130)
