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


def test_the_readme_quotes_the_verification_book() -> None:
    """The deviations of README, Reliability, are cells of the book's table of quantities."""
    book = (ROOT / "docs" / "verification.md").read_text(encoding="utf-8")
    rows = {re.sub(r"\[(.*?)\]\(.*?\)", r"\1", row[0]): row for row in (
        [cell.strip() for cell in line.strip("|").split("|")] for line in book.splitlines() if line.startswith("| [")
    )}  # fmt: skip
    text = (ROOT / "README.md").read_text(encoding="utf-8").partition("## Reliability")[2].partition("\n## ")[0]
    quoted = re.findall(r"^\| (.*?) \| (\d+: .*?) \|$", text, re.M)
    assert len(quoted) == 3
    assert [name for name, cell in quoted if rows[name][4] != cell] == []
    peers = rows["capacity in acceleration"][2]
    count, _, within = peers.partition(": within ")
    assert f"{count} results of other programs and methods within {within}" in re.sub(r"\s+", " ", text)


def test_the_tree_of_contributing_has_every_package() -> None:
    """And the way of a deck to a number, the block after it, names files that exist."""
    tree, way = re.findall(r"^```\n(.*?)^```", (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8"), re.S | re.M)[:2]
    named = set(re.findall(r"([\w-]+)/", tree))
    package = ROOT / "python" / "extrados"
    there = {path.parent.name for path in package.rglob("*.py")}
    there |= {
        path.parent.name
        for top in ("fortran", "c")
        for end in ("f90", "c", "h")
        for path in (ROOT / top).rglob(f"*.{end}")
    }
    assert there - named - {"extrados"} == set()
    folders = {
        path.name for top in ("fortran", "c", "python", "tests") for path in (ROOT / top).rglob("*") if path.is_dir()
    }
    assert named - folders - {"fortran", "c", "python", "tests", "cases", "tools", "build"} == set()
    files = re.findall(r"[\w/]+\.py\b", way)
    assert len(files) > 9 and [file for file in files if not list(package.rglob(file))] == []


def test_the_deck_of_the_readme_is_its_case() -> None:
    shown = re.search(r"^```toml\n(.*?)^```", (ROOT / "README.md").read_text(encoding="utf-8"), re.S | re.M)
    assert shown is not None
    case = tomllib.loads((ROOT / "cases" / "arch" / "readme.toml").read_text(encoding="utf-8"))
    del case["title"], case["note"]
    assert tomllib.loads(shown[1]) == case


def test_the_pictures_of_the_readme_are_light() -> None:
    """400 kB in all; `make pictures` makes them."""
    shown = re.findall(r"!\[.*?\]\((.*?)\)", (ROOT / "README.md").read_text(encoding="utf-8"))
    assert len(shown) == 3 and sum((ROOT / picture).stat().st_size for picture in shown) < 400_000


@pytest.mark.parametrize("deck", DECKS, ids=lambda p: f"{p.parent.name}/{p.stem}")
def test_every_case_has_expected_rows_of_a_quantity(deck: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.syspath_prepend(str(ROOT / "tools"))
    from verification_quantities import quantity_of

    rows = tomllib.loads(deck.with_suffix(".expect.toml").read_text(encoding="utf-8"))["expect"]
    assert rows and all(quantity_of(row["quantity"]) for row in rows)
