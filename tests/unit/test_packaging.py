"""Recipes of every way to install the program ask for the same: set-up, wheels, container, conda, the page that tells of them."""

import re
import tomllib
from pathlib import Path

import pytest

from extrados.running import provenance

ROOT = Path(__file__).resolve().parents[2]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))


def text_of(name: str) -> str:
    return (ROOT / name).read_text(encoding="utf-8")


def packages(text: str) -> set[str]:
    """What the first apt-get install of a text asks for."""
    asked = re.search(r"apt-get install((?: -\S+)*)((?:\s+\\\n|\s+[a-z][\w.+-]*)+)", text)
    assert asked is not None
    return set(asked[2].replace("\\", " ").split())


def test_debian_packages_are_those_of_set_up() -> None:
    line = re.search(r'^packages="(.*)"$', text_of("tools/setup.sh"), re.M)
    assert line is not None
    wanted = set(line[1].split())
    assert {"gfortran", "libgsl-dev", "libsuitesparse-dev", "libopenblas-dev", "python3-venv"} <= wanted
    # the bare machine of wheels holds python3; that of a container gets it with python3-dev
    assert packages(text_of("tools/wheels.sh")) == packages(text_of("Containerfile")) == wanted - {"python3"}


def test_the_container_that_runs_has_a_library_for_each_it_was_built_with() -> None:
    build, _, run = text_of("Containerfile").rpartition("\nFROM ")
    linked = [*re.findall(r"lib(gsl|suitesparse|openblas)-dev", build), "gfortran", "python3"]
    assert len(linked) == 5
    for name in linked:
        beginning = {"suitesparse": "libcholmod", "python3": "python3"}.get(name, f"lib{name}")
        assert any(package.startswith(beginning) for package in packages(run)), name
    releases = re.findall(r"^FROM (\S+)", text_of("Containerfile"), re.M)
    assert len(set(releases)) == 1, "a library of one release is not that of another"


def test_the_page_of_installation_names_the_lines_of_set_up() -> None:
    page = text_of("docs/install.md")
    told = re.findall(r"^  (?:macOS|Fedora|conda): +(.*)$", text_of("tools/setup.sh"), re.M)
    assert len(told) == 3
    assert not [line for line in told if f"`{line}`" not in page]


def test_conda_builds_with_what_the_project_builds_with() -> None:
    recipe = text_of("tools/conda/recipe.yaml")
    host = re.search(r"^  host:\n((?:    - .*\n)+)", recipe, re.M)
    assert host is not None
    asked = {line.removeprefix("    - ").replace(" ", "") for line in host[1].splitlines()}
    assert set(PROJECT["build-system"]["requires"]) <= asked
    assert {"gsl", "openblas", "python", "pip"} <= asked and any(line.startswith("suitesparse") for line in asked)


def test_wheels_are_small_and_those_that_the_page_promises() -> None:
    script, page = text_of("tools/wheels.sh"), text_of("docs/install.md")
    assert "most=$((40 * 1000 * 1000))" in script
    oldest = PROJECT["project"]["requires-python"].removeprefix(">=")
    promised = re.findall(r"3\.\d+", next(line for line in page.splitlines() if "tools/wheels.sh" in line))
    assert promised and min(promised) == oldest and all(version in script for version in promised)


def test_an_installed_copy_tells_the_commit_that_it_was_built_from(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / ".git").mkdir()  # of a repository that happens to lie around
    monkeypatch.setattr(provenance, "COMMIT", "abc1234")
    monkeypatch.setattr(
        provenance, "__file__", str(tmp_path / "site-packages" / "extrados" / "running" / "provenance.py")
    )
    assert provenance.provenance()["commit"] == "abc1234"
