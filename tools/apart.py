"""A build of the program of its own, apart from that of the environment: with other options, or with faults."""

import os
import shutil
import subprocess
import sys
import sysconfig
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
#: Files of the program and its tests
PARTS = (
    "c",
    "fortran",
    "python",
    "tests",
    "cases",
    "docs",
    "tools",
    "meson.build",
    "meson.options",
    "pyproject.toml",
    "Makefile",
    "Containerfile",
    ".github",
    ".ci",
    "README.md",
    "CHANGELOG.md",
    "CONTRIBUTING.md",
    "CITATION.cff",
    "LICENSE",
)


def copy(place: Path) -> None:
    """Copy the sources to a folder, and remove files that no longer exist; unchanged files keep their times, so that
    a build there stays valid."""
    for part in PARTS:
        source = ROOT / part
        files = [source] if source.is_file() else [p for p in source.rglob("*") if p.is_file()]
        for old in [p for p in (place / part).rglob("*") if p.is_file()]:
            if not (ROOT / old.relative_to(place)).exists() and not _made(old):
                old.unlink()
        for path in files:
            if "__pycache__" in path.parts:
                continue
            target = place / path.relative_to(ROOT)
            if not target.exists() or target.read_bytes() != path.read_bytes():
                target.parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(path, target)


def _made(path: Path) -> bool:
    """Whether a build or a run has made a file."""
    return "__pycache__" in path.parts or path.name.startswith("_core") or path.name == "_build_info.py"


def build_core(place: Path, target: Path) -> None:
    """Build the compiled module of a folder that was built before, and copy it to a file; the module among the sources stays."""
    name = f"_core{sysconfig.get_config_var('EXT_SUFFIX')}"
    ninja = [str(Path(sys.executable).with_name("ninja")), "-C", str(place / "build"), f"python/{name}"]
    subprocess.run(ninja, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    target.parent.mkdir(parents=True, exist_ok=True)
    shutil.copy2(place / "build" / "python" / name, target)


def build(place: Path, *options: str) -> None:
    """Build the sources in a folder, new or again, and put the compiled module among them."""
    meson = Path(sys.executable).with_name("meson")
    environment = {**os.environ, "PATH": f"{meson.parent}{os.pathsep}{os.environ['PATH']}"}
    folder = place / "build"
    if not (folder / "build.ninja").exists():
        run = [str(meson), "setup", str(folder), str(place), "-Dwerror=false", *options]
        subprocess.run(run, check=True, env=environment, stdout=subprocess.DEVNULL)
    subprocess.run(
        [str(meson), "compile", "-C", str(folder)], check=True, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )
    package = place / "python" / "extrados"
    for made in (*(folder / "python").glob("_core*.so"), folder / "python" / "_build_info.py"):
        shutil.copy2(made, package / made.name)


def python(place: Path) -> str:
    """An interpreter that finds the program there, and so do the processes that it starts."""
    folder = place / "venv"
    if not folder.exists():
        subprocess.run([sys.executable, "-m", "venv", "--without-pip", str(folder)], check=True)
    (packages,) = folder.glob("lib/python*/site-packages")
    # Named as mere folders, those of this environment do not bring their own program with them
    others = [p for p in map(Path, sys.path) if p.is_dir() and not (p.is_relative_to(ROOT) and not p.is_relative_to(sys.prefix))]
    text = "\n".join(map(str, [place / "python", *others]))
    (packages / "apart.pth").write_text(text, encoding="utf-8")
    return str(folder / "bin" / "python")
