"""The documentation shows decks that are right and names tests and cases that exist."""

import importlib.util
import re
import tomllib
from pathlib import Path
from types import ModuleType
from xml.etree import ElementTree

import pytest

from extrados import kinds
from extrados.decks.reader import make_deck
from extrados.results import uncertainty

ROOT = Path(__file__).resolve().parents[2]
PAGES = [ROOT / name for name in ("README.md", "CONTRIBUTING.md", "CHANGELOG.md")] + sorted(
    page for page in (ROOT / "docs").rglob("*.md") if page.parent.name != "_made"
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
    rows = {
        re.sub(r"\[(.*?)\]\(.*?\)", r"\1", row[0]): row
        for row in ([cell.strip() for cell in line.strip("|").split("|")] for line in book.splitlines() if line.startswith("| ["))
    }
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
    there |= {path.parent.name for top in ("fortran", "c") for end in ("f90", "c", "h") for path in (ROOT / top).rglob(f"*.{end}")}
    assert there - named - {"extrados"} == set()
    folders = {path.name for top in ("fortran", "c", "python", "tests") for path in (ROOT / top).rglob("*") if path.is_dir()}
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


#: Pages that a person writes; those that include other files or that `make verify` writes are apart
WRITTEN = sorted(
    page
    for page in (ROOT / "docs").rglob("*.md")
    if page.relative_to(ROOT / "docs").parts[0] not in ("_made", "paper", "verification")
    and page.name not in ("verification.md", "changelog.md", "contributing.md", "gallery.md", "redrawn.md")
)
DRAWN = re.compile(r"^```\{drawn\} (\S+) (\S+)(?: (\S+))?\n(.+?)\n```$", re.M | re.S)
PICTURE = re.compile(r"^```\{drawn\}|^```\{figure\}|^```\{raw\} html\n:file:|^!\[|\.plot\(", re.M)


def test_every_written_page_has_a_picture() -> None:
    """But the list of differences, which is a table of records."""
    bare = [page.name for page in WRITTEN if not PICTURE.search(page.read_text(encoding="utf-8"))]
    assert len(WRITTEN) > 40 and bare == ["differences.md"]


def test_pictures_are_drawn_by_decks_at_build_time() -> None:
    """Each names a deck and an analysis that it has, and ends its caption; git keeps the pictures of the README alone."""
    drawn = [(page.name, *row) for page in WRITTEN for row in DRAWN.findall(page.read_text(encoding="utf-8"))]
    assert len(drawn) >= 30
    for page, case, analysis, _, caption in drawn:
        deck = ROOT / "cases" / f"{case}.toml"
        asked = tomllib.loads(deck.read_text(encoding="utf-8"))["analysis"]
        names = [one["kind"] for one in (asked if isinstance(asked, list) else [asked])]
        assert re.sub(r"-\d+$", "", analysis) in names or analysis in names, (page, case, analysis)
        assert caption.endswith("."), (page, caption)
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    assert {path.name for path in (ROOT / "docs" / "pictures").iterdir()} == set(re.findall(r"pictures/(\S+?\.png)", readme))


def test_the_gallery_shows_sixty_cases(monkeypatch: pytest.MonkeyPatch) -> None:
    shown = site(monkeypatch).SHOWN
    rows = [row for rows in shown.values() for row in rows]
    assert len(rows) == len(set(rows)) == 60
    assert all((ROOT / "cases" / f"{row[0]}.toml").exists() for row in rows)


def test_the_decision_diagram_leads_to_kinds_and_pages(monkeypatch: pytest.MonkeyPatch) -> None:
    """Every kind of analysis is on the page, in the diagram or in the table below it."""
    monkeypatch.syspath_prepend(str(ROOT / "tools"))
    import decision

    cases = [case for cases in decision.TREE.values() for case in cases]
    assert all((ROOT / "docs" / f"{case.page}.md").exists() for case in cases)
    named = {kind for case in cases for kind in case.kinds}
    assert named <= set(kinds.ANALYSES)
    assert [kind for kind in kinds.ANALYSES if f"`{kind}`" not in decision.table()] == []
    assert ElementTree.fromstring(decision.diagram()).tag.endswith("svg")


def test_the_page_on_uncertainty_has_every_experiment(monkeypatch: pytest.MonkeyPatch) -> None:
    """A row by hand: of bias 0.8 and scatter 0.2 the 5 % fractile is exp(-1.6449 * 0.2) / 0.8 = 0.8996 of the computed value."""
    monkeypatch.syspath_prepend(str(ROOT / "tools"))
    import uncertainty_pictures

    rows = uncertainty.read_uncertainties()
    experiments = [row for row in rows if row.comparison == "experiment"]
    assert experiments and uncertainty_pictures.table().count("\n") - 2 == len(experiments)
    assert len(uncertainty_pictures.experiments().axes[0].get_yticks()) == len(experiments)
    assert len(uncertainty_pictures.deviations().axes[0].get_yticks()) == len({row.strategy for row in rows})
    one = uncertainty.ModelUncertainty("a", ("tilt",), "b", "experiment", 3, 0.8, 0.2, "limit/oppenheim", 0.7)
    monkeypatch.setattr(uncertainty_pictures, "read_uncertainties", lambda: [one])
    assert "| a | b | 3 | 0.80 | 0.20 | 0.90 |" in uncertainty_pictures.table()


NOTEBOOKS = sorted(page for page in (ROOT / "docs" / "notebooks").glob("*.md") if page.name != "index.md")


@pytest.mark.parametrize("page", NOTEBOOKS, ids=lambda page: page.stem)
def test_notebooks_are_listed_executed_and_downloadable(page: Path) -> None:
    """`make docs` executes the cells, and stops at an error; here they compile, and a kernel is named."""
    text = page.read_text(encoding="utf-8")
    cells = re.findall(r"^```\{code-cell\} ipython3\n(.*?)^```", text, re.S | re.M)
    assert len(cells) >= 3 and all(compile(cell, page.name, "exec") for cell in cells)
    assert text.startswith("---\nfile_format: mystnb\n") and f"{{nb-download}}`{page.stem}.ipynb`" in text
    listed = (ROOT / "docs" / "notebooks" / "index.md").read_text(encoding="utf-8").partition("{toctree}")[2]
    assert page.stem in listed.split() and len(NOTEBOOKS) >= 10


def test_versions_of_the_site_are_listed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    made = site(monkeypatch)
    monkeypatch.setattr(made, "VERSIONS", tmp_path)
    for version in ("0.9.0", "0.10.0"):
        (tmp_path / version).mkdir()
        (tmp_path / version / "index.html").touch()
    made.list_versions()
    page = (tmp_path / "index.html").read_text(encoding="utf-8")
    assert page.index("0.10.0/index.html") < page.index("0.9.0/index.html") and "url=0.10.0/" in page
    assert made.broken(tmp_path) == []


def site(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """tools/site.py, whose name is that of a module of Python."""
    monkeypatch.syspath_prepend(str(ROOT / "tools"))
    spec = importlib.util.spec_from_file_location("extrados_site", ROOT / "tools" / "site.py")
    assert spec is not None and spec.loader is not None
    made = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(made)
    return made
