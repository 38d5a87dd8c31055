"""The programs that ours is measured against: extra `bench` of pyproject.toml."""

import importlib
import importlib.util
import subprocess
import sys
import tomllib
from pathlib import Path

PROJECT = Path(__file__).resolve().parents[2] / "pyproject.toml"


def install() -> dict[str, str]:
    """Install each peer on its own into this environment; those that could not be had, with pip's reason.

    What is there already is not asked for again, so that this works offline.
    """
    with open(PROJECT, "rb") as stream:
        wanted = tomllib.load(stream)["project"]["optional-dependencies"]["bench"]
    lacking = {}
    for requirement in wanted:
        print(f"peer {requirement}", flush=True)
        command = [sys.executable, "-m", "pip", "install", "-q", "--disable-pip-version-check", requirement]
        run = subprocess.run(command, capture_output=True, text=True, check=False)
        if run.returncode:
            said = [line for line in run.stderr.splitlines() if line.startswith("ERROR")]
            lacking[requirement] = said[0].removeprefix("ERROR: ") if said else run.stderr.strip()[-200:]
    importlib.invalidate_caches()
    return lacking


def has(module: str) -> bool:
    """Whether a peer's module is installed."""
    return importlib.util.find_spec(module) is not None
