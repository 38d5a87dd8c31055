"""The documentation shows decks that are right and names tests and cases that exist."""

import re
import tomllib
from pathlib import Path

import pytest

from extrados.decks.reader import make_deck

ROOT = Path(__file__).resolve().parents[2]
PAGES = [ROOT / name for name in ("README.md", "CONTRIBUTING.md", "CHANGELOG.md")] + sorted(
    (ROOT / "docs").rglob("*.md")
)
DECKS = sorted(p for p in (ROOT / "cases").rglob("*.toml") if not p.name.endswith(".expect.toml"))


def decks() -> list:
    found = []
    for page in PAGES:
        for k, block in enumerate(re.findall(r"^```toml\n(.*?)^```", page.read_text(encoding="utf-8"), re.S | re.M)):
            found.append(pytest.param(block, id=f"{page.name}-{k + 1}"))
    return found


@pytest.mark.parametrize("block", decks())
def test_decks_in_the_docs_are_right(block: str) -> None:
    data = tomllib.loads(block)
    data.setdefault("analysis", {"kind": "motion" if "structure" not in data else "tilt"})
    make_deck(data)


@pytest.mark.parametrize("page", PAGES, ids=lambda p: p.name)
def test_what_the_docs_name_exists(page: Path) -> None:
    """Cases, tests and modules that a page names in backquotes, and the pages it links."""
    text = page.read_text(encoding="utf-8")
    missing = []
    for name in re.findall(r"`((?:cases|tests|tools|docs|python|fortran|c)/[\w./*-]+)`", text):
        place = name.rstrip("/")
        there = [*ROOT.glob(place), *ROOT.glob(place + ".toml")]
        if not there:
            missing.append(name)
    assert not missing
    for file in re.findall(r"`(test_\w+\.py)`", text):
        assert list((ROOT / "tests").rglob(file)), file
    tests = "".join(file.read_text(encoding="utf-8") for file in (ROOT / "tests").rglob("test_*.py"))
    for function in re.findall(r"`(test_\w+)`", text):
        assert f"def {function}(" in tests or list((ROOT / "tests").rglob(f"{function}.py")), function
    for link in re.findall(r"\]\(([\w./-]+\.\w+)(?:#[\w-]+)?\)", text):
        assert (page.parent / link).exists(), link


def test_every_difference_is_shown_by_a_case_or_a_test() -> None:
    """Each row against the dissertation names one that exists; of the rows on this program's changes each case is there."""
    text = (ROOT / "docs" / "differences.md").read_text(encoding="utf-8")
    first, _, second = text.partition("## What changed in this program")
    tests = "".join(file.read_text(encoding="utf-8") for file in (ROOT / "tests").rglob("test_*.py"))
    rows = re.findall(r"^\| (?!where|-)(.*) \|$", first, re.M)
    assert len(rows) > 25
    for row in rows:
        cases = [name for name in re.findall(r"`cases/([\w/-]+)`", row) if (ROOT / "cases" / f"{name}.toml").exists()]
        named = [
            name
            for name in re.findall(r"\b(test_\w+)", row)
            if f"def {name}(" in tests or list((ROOT / "tests").rglob(f"{name}.py"))
        ]
        assert cases or named, row
    folders = "|".join(place.name for place in (ROOT / "cases").iterdir())
    changed = re.findall(rf"`((?:{folders})/[\w*-]+)`", second)
    assert changed and not [name for name in changed if not list((ROOT / "cases").glob(f"{name}.toml"))]


def test_the_verification_book_names_cases_that_exist() -> None:
    book = (ROOT / "docs" / "verification.md").read_text(encoding="utf-8")
    folders = "|".join(place.name for place in (ROOT / "cases").iterdir())
    named = set(re.findall(rf"^\| ((?:{folders})/[\w-]+) \|", book, re.M))
    assert named and not [name for name in named if not (ROOT / "cases" / f"{name}.toml").exists()]


@pytest.mark.parametrize("deck", DECKS, ids=lambda p: f"{p.parent.name}/{p.stem}")
def test_every_case_has_expected_rows_of_a_quantity(deck: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(ROOT / "tools"))
    from verification_quantities import quantity_of

    rows = tomllib.loads(deck.with_suffix(".expect.toml").read_text(encoding="utf-8"))["expect"]
    assert rows and all(quantity_of(row["quantity"]) for row in rows)


def test_the_conda_recipe_has_the_libraries_of_the_project() -> None:
    """By the names of PyPI: two are called otherwise on conda-forge."""
    asked = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    recipe = (ROOT / "tools" / "conda" / "recipe.yaml").read_text(encoding="utf-8")
    run = re.search(r"^  run:\n((?:    - .*\n)+)", recipe, re.M)
    assert run is not None
    known = {line.removeprefix("    - ").replace(" ", "") for line in run[1].splitlines()}
    assert f"python{asked['requires-python']}" in known
    known -= {f"python{asked['requires-python']}"}
    renamed = {"matplotlib-base": "matplotlib", "typst-py": "typst"}
    for theirs, ours in renamed.items():
        known = {line.replace(theirs, ours) for line in known}
    assert known == set(asked["dependencies"])
    assert f'version: "{asked["version"]}"' in recipe
