"""Release a version: `make release VERSION=0.2.0`.

Sets the version in all files, dates its heading in the changelog and opens the next one, commits, tags, and packs the sources into
dist/. Wheels are made by `sudo tools/wheels.sh` from the tag. Nothing is pushed; the last line says how. Refused if the work tree holds
changes, the version is no larger than the last one, or the changelog has no news.
"""

import datetime
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
#: File -> text before the version and after it
PLACES = {
    "meson.build": (r"version: '", "'"),
    "pyproject.toml": (r'^version = "', '"'),
    "CITATION.cff": (r"^version: ", "$"),
    "tools/conda/recipe.yaml": (r'^  version: "', '"'),
}
UNRELEASED = re.compile(r"^## (\S+) \(unreleased\)\n+(?P<news>.*?)(?=^## |\Z)", re.S | re.M)


class Refused(Exception):
    """Why nothing was released."""


def numbers(version: str) -> tuple[int, ...]:
    if not re.fullmatch(r"\d+\.\d+\.\d+", version):
        raise Refused(f"'{version}' is no version: expected three numbers, as 0.2.0")
    return tuple(map(int, version.split(".")))


def current(root: Path) -> str:
    """The version that the sources have."""
    found = re.search(r'^version = "([^"]+)"', (root / "pyproject.toml").read_text(encoding="utf-8"), re.M)
    if found is None:
        raise Refused("pyproject.toml names no version")
    return found[1]


def prepare(root: Path, version: str, date: str, released: bool = True) -> list[str]:
    """Write the version and the dated changelog; the files that changed. `released`: whether the present one has a tag."""
    before = current(root)
    if numbers(version) < numbers(before) or (released and version == before):
        raise Refused(f"{version} is not larger than {before}")
    log = (root / "CHANGELOG.md").read_text(encoding="utf-8")
    found = UNRELEASED.search(log)
    if found is None or not found["news"].strip():
        raise Refused("CHANGELOG.md has no news under a heading '## VERSION (unreleased)'")
    major, minor, _ = numbers(version)
    heading = f"## {major}.{minor + 1}.0 (unreleased)\n\n## {version} ({date})\n\n"
    (root / "CHANGELOG.md").write_text(log.replace(found[0], heading + found["news"], 1), encoding="utf-8")
    for name, (left, right) in PLACES.items():
        text = (root / name).read_text(encoding="utf-8")
        made, count = re.subn(rf"({left}){re.escape(before)}({right})", rf"\g<1>{version}\g<2>", text, count=1, flags=re.M)
        if count != 1:
            raise Refused(f"{name} lacks {before}")
        (root / name).write_text(made, encoding="utf-8")
    return ["CHANGELOG.md", *PLACES]


def git(root: Path, *words: str) -> str:
    return subprocess.run(["git", "-C", str(root), *words], check=True, capture_output=True, text=True).stdout.strip()


def release(root: Path, version: str, date: str) -> Path:
    """Prepare, commit, tag and pack; the archive of the sources."""
    if git(root, "status", "--porcelain"):
        raise Refused("the work tree holds changes: commit them first")
    changed = prepare(root, version, date, released=f"v{current(root)}" in git(root, "tag").split())
    git(root, "commit", "-q", "-m", f"Version {version}", "--", *changed)
    git(root, "tag", "-a", f"v{version}", "-m", f"extrados {version}")
    archive = root / "dist" / f"extrados-{version}.tar.gz"
    archive.parent.mkdir(exist_ok=True)
    git(root, "archive", f"--prefix=extrados-{version}/", "-o", str(archive), f"v{version}")
    return archive


def main() -> int:
    try:
        if len(sys.argv) != 2:
            raise Refused("make release VERSION=0.2.0")
        archive = release(ROOT, sys.argv[1], datetime.date.today().isoformat())
    except Refused as why:
        print(f"nothing released: {why}", file=sys.stderr)
        return 1
    print(f"Sources: {archive}\nWheels:  sudo tools/wheels.sh\nPublish: git push --follow-tags")
    return 0


if __name__ == "__main__":
    sys.exit(main())
