"""Lines of Python, Fortran and C that the quick suite runs: three shares, and the least covered files.

    python tools/coverage.py [TESTS ...]

The program is built anew in build/coverage with gcov's counters; pytest-cov (the extra `coverage`) is installed
first if it is missing. Python line by line: build/coverage/html. The wanted shares are printed beside those found; exit code 1 below them, unless tests
are named. A whole run writes its shares into CONTRIBUTING.md.
"""

import datetime
import json
import re
import subprocess
import sys
from pathlib import Path

import apart
import extras

ROOM = apart.ROOT / "build" / "coverage"
HTML = ROOM / "html"
WANTED = {"Python": 90.0, "Fortran": 85.0, "C": 85.0}
INTERRUPTED = 2  # of pytest's exit codes: it then keeps no counts
LEAST = 8  # files of each language that are printed
#: The words of CONTRIBUTING.md that a whole run writes anew
NOTE = re.compile(r"At the last whole run \([\d-]+\) they were [\d., and]+ %")


def run(tests: list[str]) -> None:
    """The tests, Python's and those of Fortran and C, by the counted build; earlier counts are forgotten."""
    for path in [*(ROOM / "build").rglob("*.gcda"), *ROOM.glob(".coverage*")]:
        path.unlink()
    python = apart.python(ROOM)
    # In one process: the workers of xdist leave without writing the counts of the core
    options = ["--cov=extrados", "--cov-report=", "-q", "-n", "0", "-m", "not verify"]
    done = subprocess.run([python, "-m", "pytest", *options, *tests], cwd=ROOM, check=False)
    if done.returncode == INTERRUPTED:
        sys.exit("the tests were interrupted: nothing was counted")
    if not tests:
        meson = str(Path(sys.executable).with_name("meson"))
        subprocess.run([meson, "test", "-C", str(ROOM / "build"), "-q"], check=False, stdout=subprocess.DEVNULL)
    subprocess.run([python, "-m", "coverage", "html", "-q", "-d", str(HTML)], cwd=ROOM, check=True)
    subprocess.run([python, "-m", "coverage", "json", "-q", "-o", str(ROOM / "python.json")], cwd=ROOM, check=True)


def of_python() -> dict[str, tuple[int, int]]:
    """File -> lines that ran, lines."""
    files = json.loads((ROOM / "python.json").read_text())["files"]
    return {name: (f["summary"]["covered_lines"], f["summary"]["num_statements"]) for name, f in files.items()}


def of_core(folder: str) -> dict[str, tuple[int, int]]:
    """The same of the Fortran or the C sources, by gcov; a file that never ran counts with all its lines."""
    counts: dict[str, dict[int, int]] = {}
    for notes in sorted((ROOM / "build" / folder).rglob("*.gcno")):
        ran = notes.with_suffix(".gcda")
        told = subprocess.run(
            ["gcov", "--json-format", "--stdout", ran if ran.exists() else notes], cwd=ROOM / "build", capture_output=True, text=True
        )
        for file in (file for line in told.stdout.splitlines() for file in json.loads(line)["files"]):
            path = (ROOM / "build" / file["file"]).resolve()
            if path.is_relative_to(ROOM / folder):
                lines = counts.setdefault(str(path.relative_to(ROOM)), {})
                for line in file["lines"]:
                    lines[line["line_number"]] = max(lines.get(line["line_number"], 0), line["count"])
    return {name: (sum(count > 0 for count in lines.values()), len(lines)) for name, lines in counts.items()}


def tell(language: str, files: dict[str, tuple[int, int]]) -> float:
    """Print the share of a language and its least covered files; the share in percent."""
    ran, lines = (sum(pair[k] for pair in files.values()) for k in (0, 1))
    share = 100.0 * ran / max(lines, 1)
    print(f"{language:8} {share:5.1f} % of {lines} lines (wanted {WANTED[language]:g} %)")
    for name, (some, most) in sorted(files.items(), key=lambda item: item[1][0] - item[1][1])[:LEAST]:
        if some < most:
            print(f"    {most - some:4d} lines never run in {name}")
    return share


def noted(page: str, shares: dict[str, float], date: str) -> str:
    """The text of CONTRIBUTING.md with the shares of today; SystemExit if it has no place for them."""
    python, fortran, c = (f"{shares[language]:.1f}" for language in WANTED)
    made, count = NOTE.subn(f"At the last whole run ({date}) they were {python}, {fortran} and {c} %", page)
    if count != 1:
        sys.exit("CONTRIBUTING.md has no place for the shares: expected 'At the last whole run (DATE) they were A, B and C %'")
    return made


def main() -> int:
    extras.install("coverage")
    apart.copy(ROOM)
    # -O1: the optimiser would merge lines; the counters must be exact where threads count too
    apart.build(ROOM, "-Db_coverage=true", "-Doptimization=1", "-Dc_args=-fprofile-update=atomic", "-Dfortran_args=-fprofile-update=atomic")
    run(sys.argv[1:])
    found = {"Python": of_python(), "Fortran": of_core("fortran"), "C": of_core("c")}
    shares = {language: tell(language, files) for language, files in found.items()}
    print(f"Lines: {HTML}")
    if not sys.argv[1:]:
        page = apart.ROOT / "CONTRIBUTING.md"
        page.write_text(noted(page.read_text(encoding="utf-8"), shares, datetime.date.today().isoformat()), encoding="utf-8")
    return 0 if sys.argv[1:] else int(any(shares[language] < wanted for language, wanted in WANTED.items()))


if __name__ == "__main__":
    sys.exit(main())
