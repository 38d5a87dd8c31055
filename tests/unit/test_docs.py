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


@pytest.mark.parametrize("deck", DECKS, ids=lambda p: f"{p.parent.name}/{p.stem}")
def test_every_case_has_expected_rows_of_a_quantity(deck: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(ROOT / "tools"))
    from verification_quantities import quantity_of

    rows = tomllib.loads(deck.with_suffix(".expect.toml").read_text(encoding="utf-8"))["expect"]
    assert rows and all(quantity_of(row["quantity"]) for row in rows)
