"""Run all benchmarks, or those named: python tests/bench [arch ...].

Run by its path, as a package of somebody else may be called `tests` too; its folder is then where modules are looked
for first. The peers (extra `bench`) are installed first, each on its own. Each benchmark is a process of its own: one
that fails does not stop the others, and is named at the end (exit code 1). What it told is added to history.jsonl, which
build/bench/NAME.png draws.
"""

import subprocess
import sys
from pathlib import Path

import history
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
        code, text = told(rooms[name])
        if code:
            failed.append(f"{name} (exit code {code})")
        else:
            history.append(name, text)
    print()
    for picture in history.draw():
        print(f"history: {picture}")
    for requirement, why in lacking.items():
        print(f"peer not to be had here: {requirement}: {why}")
    if failed:
        print(f"failed: {', '.join(failed)}")
    return bool(failed)


def told(script: Path) -> tuple[int, str]:
    """Exit code of a benchmark, and what it printed, which is printed here as it comes."""
    with subprocess.Popen([sys.executable, "-u", str(script)], stdout=subprocess.PIPE, text=True) as process:
        lines = []
        for line in process.stdout or ():
            print(line, end="", flush=True)
            lines.append(line)
    return process.returncode, "".join(lines)


if __name__ == "__main__":
    try:
        sys.exit(main())
    except KeyboardInterrupt:
        sys.exit(130)
