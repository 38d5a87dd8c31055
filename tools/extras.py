"""Packages of an extra of pyproject.toml, which a tool installs as it first needs them.

python tools/extras.py EXTRA ...
"""

import subprocess
import sys
import tomllib
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

PROJECT = Path(__file__).resolve().parents[1] / "pyproject.toml"


def install(extra: str) -> None:
    """Install an extra into this environment if any of its packages is missing; offline otherwise."""
    asked = tomllib.loads(PROJECT.read_text(encoding="utf-8"))["project"]["optional-dependencies"][extra]
    try:
        for line in asked:
            version(line.partition(">=")[0])
    except PackageNotFoundError:
        subprocess.run([sys.executable, "-m", "pip", "install", "-q", "--disable-pip-version-check", *asked], check=True)


if __name__ == "__main__":
    for name in sys.argv[1:]:
        install(name)
