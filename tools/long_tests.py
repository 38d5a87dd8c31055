"""Write tests/long.txt, the tests of more than half a second of a processor, from the measured times of a run of all but the validation.

    python tools/long_tests.py [FOLDER]

Without a folder the tests are run first. Processor time of a test and of the children that it waited for: the list does not depend on
other work of the machine. A fixture that several tests share counts for the first of them. Tests that
were not measured or were skipped stay in the list.
"""

import ast
import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
LIST = ROOT / "tests" / "long.txt"
TIMES = ROOT / "build" / "times"
#: Processor time from which on a test is long [s]
LIMIT = 0.5
#: Processor time below which a test of the list was skipped [s]
SKIPPED = 0.1


def measure() -> Path:
    """Run all tests but the validation; the folder with their times."""
    TIMES.mkdir(parents=True, exist_ok=True)
    for old in TIMES.glob("*.tsv"):
        old.unlink()
    words = [sys.executable, "-m", "pytest", "-q", "-m", "not verify", "-n", "auto", "--maxprocesses", "8", "--dist", "worksteal"]
    code = subprocess.run(words, cwd=ROOT, env={**os.environ, "EXTRADOS_TIMES": str(TIMES)}, check=False).returncode
    if code not in (0, 1):  # all ran, with or without a failure
        raise SystemExit(f"the tests ended with {code}: {LIST.name} is unchanged")
    return TIMES


def long_tests(folder: Path, before: set[str]) -> list[str]:
    """Tests above the limit, by name, and those of the list before that have no time or one of a test that was skipped."""
    lines = [line.partition("\t") for path in folder.glob("*.tsv") for line in path.read_text(encoding="utf-8").splitlines()]
    seconds = {ast.literal_eval(name): float(value) for value, _, name in lines}
    return sorted(
        {name for name, value in seconds.items() if value > LIMIT} | {name for name in before if seconds.get(name, 0.0) < SKIPPED}
    )


def main() -> None:
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else measure()
    names = long_tests(folder, set(LIST.read_text(encoding="utf-8").splitlines()))
    LIST.write_text("".join(f"{name}\n" for name in names), encoding="utf-8")
    print(f"{LIST.relative_to(ROOT)}: {len(names)} tests")


if __name__ == "__main__":
    main()
