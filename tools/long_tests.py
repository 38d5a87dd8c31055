"""Write tests/long.txt, the tests of more than a second of a processor, from the measured times of a run of all but the validation.

    python tools/long_tests.py [FOLDER]

Without a folder the tests are run first. Processor time of a test and of the children that it waited for: the list does not depend on
other work of the machine. A fixture that several tests share counts for the first of them.
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
LIMIT = 1.0


def measure() -> Path:
    """Run all tests but the validation; the folder with their times."""
    TIMES.mkdir(parents=True, exist_ok=True)
    for old in TIMES.glob("*.tsv"):
        old.unlink()
    words = [sys.executable, "-m", "pytest", "-q", "-m", "not verify", "-n", "auto", "--maxprocesses", "8", "--dist", "worksteal"]
    subprocess.run(words, cwd=ROOT, env={**os.environ, "EXTRADOS_TIMES": str(TIMES)}, check=False)
    return TIMES


def long_tests(folder: Path) -> list[str]:
    """Tests above the limit, by name."""
    found = set()
    for path in folder.glob("*.tsv"):
        for line in path.read_text(encoding="utf-8").splitlines():
            seconds, _, name = line.partition("\t")
            if float(seconds) > LIMIT:
                found.add(ast.literal_eval(name))
    return sorted(found)


def main() -> None:
    names = long_tests(Path(sys.argv[1]) if len(sys.argv) > 1 else measure())
    LIST.write_text("".join(f"{name}\n" for name in names), encoding="utf-8")
    print(f"{LIST.relative_to(ROOT)}: {len(names)} tests")


if __name__ == "__main__":
    main()
