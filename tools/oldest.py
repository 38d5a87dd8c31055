"""Set up with the oldest pip and the oldest libraries that pyproject.toml allows, in a copy of the sources, and test there.

The copy lies in build/oldest. It is set up by tools/setup.sh, as a user's is; only the choice of pip is bounded, by
constraints made from pyproject.toml at each run, so that the two cannot differ.
"""

import os
import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
ROOM = ROOT / "build" / "oldest"
#: Debian 12, the oldest system supported, has this one.
PIP = "23.0.1"
#: Tests that use every library, in two minutes rather than the whole suite.
TESTS = ["tests/unit"]


def lower_bounds(project: dict) -> list[str]:
    """Each requirement `name>=version` of the project as `name==version`; those without a bound are skipped.

    Raises SystemExit when a library of the program itself has no lower bound: the supported versions would then be undefined.
    """
    own = project["project"]["dependencies"]
    extra = project["project"]["optional-dependencies"]
    pins: dict[str, str] = {}
    # The peers of the benchmarks are no part of the program.
    for text in [*own, *project["build-system"]["requires"], *(r for k, v in extra.items() if k != "bench" for r in v)]:
        found = re.fullmatch(r"([A-Za-z0-9_.-]+)>=([0-9.]+)(?:,<[0-9.]+)?", text)
        if found is None:
            if text in own:
                raise SystemExit(f"pyproject.toml: {text} needs a lower bound, name>=version")
            continue
        name, version = found.groups()
        if pins.setdefault(name, version) != version:
            raise SystemExit(f"pyproject.toml: {name} has two lower bounds, {pins[name]} and {version}")
    return [f"{name}=={version}" for name, version in sorted(pins.items())]


def others(python: Path, pins: list[str]) -> list[str]:
    """Packages of that environment in another version than required; missing packages are not listed."""
    code = "import importlib.metadata as m; [print(d.name + '==' + d.version) for d in m.distributions()]"
    listed = subprocess.run([python, "-c", code], check=True, capture_output=True, text=True).stdout.split()

    def plain(pin: str) -> tuple[str, str]:
        name, version = pin.split("==")
        return re.sub(r"[-_.]+", "-", name).lower(), re.sub(r"(\.0)+$", "", version)

    wanted = dict(map(plain, [*pins, f"pip=={PIP}"]))
    return [pin for pin in listed if wanted.get(plain(pin)[0], plain(pin)[1]) != plain(pin)[1]]


def copy_sources() -> None:
    """The sources in their present state, also uncommitted changes; environment and build of an earlier run stay."""
    listed = subprocess.run(
        ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"], cwd=ROOT, check=True, capture_output=True, text=True
    ).stdout.split("\0")
    ROOM.mkdir(parents=True, exist_ok=True)
    for old in ROOM.iterdir():
        if old.name not in (".venv", "build"):
            shutil.rmtree(old) if old.is_dir() else old.unlink()
    for name in filter(None, listed):
        if (ROOT / name).is_file():
            (ROOM / name).parent.mkdir(parents=True, exist_ok=True)
            shutil.copy2(ROOT / name, ROOM / name)


def main() -> int:
    with open(ROOT / "pyproject.toml", "rb") as stream:
        pins = lower_bounds(tomllib.load(stream))
    copy_sources()
    constraints = ROOM / "oldest.txt"
    constraints.write_text("\n".join(pins) + "\n")
    print(f"pip {PIP}, {', '.join(pins)}", flush=True)

    python = ROOM / ".venv" / "bin" / "python"
    if not python.exists():
        subprocess.run([sys.executable, "-m", "venv", ".venv"], cwd=ROOM, check=True)
        subprocess.run([python, "-m", "pip", "install", "-q", f"pip=={PIP}"], check=True)
    # The sources of the copy, and nothing of the environment that this was called from.
    env = {k: v for k, v in os.environ.items() if k not in ("PYTHONPATH", "VIRTUAL_ENV", "MAKEFLAGS")}
    env |= {"PIP_CONSTRAINT": str(constraints), "PATH": f"{python.parent}{os.pathsep}{os.environ['PATH']}"}
    subprocess.run(["sh", "tools/setup.sh"], cwd=ROOM, env=env, check=True)
    if wrong := others(python, pins):
        print(f"not the oldest after all: {', '.join(wrong)}", file=sys.stderr)
        return 1
    return subprocess.run(
        [python, "-m", "pytest", "-q", "-m", "not verify", "-n", "auto", "--maxprocesses", "8", "--dist", "worksteal", *TESTS],
        cwd=ROOM,
        env=env,
        check=False,
    ).returncode


if __name__ == "__main__":
    sys.exit(main())
