"""The pages on the dissertation's figures list every figure once, and name decks, tests and pictures that exist."""

import re
import sys
import tomllib
from pathlib import Path

import pytest

import extrados
from extrados import kinds

ROOT = Path(__file__).resolve().parents[2]
sys.path.append(str(ROOT / "tools"))

from dissertation import PLACE, redrawn_by, rows  # noqa: E402

#: Chapter or appendix -> number of its last figure
LAST = {"2": 8, "3": 8, "4": 17, "5": 15, "6": 10, "7": 22, "B": 4, "C": 12}
ALL = rows()
DECKS = sorted({case for row in ALL for case, _ in redrawn_by(row[2])})


def pictures(kind: str, name: str) -> list[str]:
    """Patterns of the names of the pictures that an analysis of this kind and name may have, from the source that draws them."""
    place = kinds.ANALYSES[kind].figures.split(":")[0].replace(".", "/")
    sources = [
        ROOT / "python" / "extrados" / f"{place}.py",
        *(ROOT / "python/extrados/show/limit").glob("*.py"),
        ROOT / "python/extrados/show/solid_dem.py",
    ]
    words = "".join(file.read_text(encoding="utf-8") for file in sources)
    found = [*re.findall(r'f"\{name\}([^"\s]*)"', words), ""]
    return [re.escape(name) + re.sub(r"\\?\{[^}]*\\?\}", r"(-minus|\\d+)?", end) for end in found]


@pytest.mark.parametrize("chapter", LAST)
def test_every_figure_is_listed_once_in_order(chapter: str) -> None:
    listed = [row[0] for row in ALL if row[0].split("-")[0] == chapter]
    assert listed == [f"{chapter}-{n}" for n in range(1, LAST[chapter] + 1)]


def test_every_row_is_whole() -> None:
    """Six cells; what nothing redraws says why."""
    assert all(len(row) == 6 and all(row) for row in ALL)
    assert not [row[0] for row in ALL if row[2] == "-" and row[5] == "-"]


@pytest.mark.parametrize("deck", DECKS)
def test_pictures_are_those_of_the_deck(deck: str) -> None:
    data = tomllib.loads((ROOT / "cases" / f"{deck}.toml").read_text(encoding="utf-8"))
    asked = data["analysis"] if isinstance(data["analysis"], list) else [data["analysis"]]
    may, count = ["building"], {}  # each run draws the structure
    for analysis in asked:
        kind = analysis["kind"]
        count[kind] = count.get(kind, 0) + 1
        may += pictures(kind, kind if count[kind] == 1 else f"{kind}-{count[kind]}")
    for row in ALL:
        for named, names in redrawn_by(row[2]):
            for picture in names if named == deck else []:
                assert any(re.fullmatch(pattern, picture) for pattern in may), (row[0], picture)


def test_the_count_of_each_chapter() -> None:
    """Redrawn by a deck, held by a test alone, or neither."""
    told = (PLACE / "index.md").read_text(encoding="utf-8")
    for chapter, last in LAST.items():
        of = [row for row in ALL if row[0].split("-")[0] == chapter]
        drawn = sum(".png" in row[2] for row in of)
        tested = sum("test_" in row[2] and ".png" not in row[2] for row in of)
        assert f"| {chapter} | {last} | {drawn} | {tested} | {last - drawn - tested} |" in told


def test_optimal_motion_and_single_impulses() -> None:
    """Figs 6-2 and 6-4: steps that lengthen as the rotation grows, and the share of starts from which an impulse adds energy;
    this program's own numbers, whose keys have dots that a row of the case could not name."""
    found = extrados.run(ROOT / "cases" / "rocking" / "figure-6-4.toml")["resonance"]
    spacing = found.switch_spacing_s
    assert spacing == sorted(spacing)
    assert [spacing[0], spacing[-1]] == pytest.approx([0.1604, 0.3317], abs=0.0005)
    share = found.share_of_starts_that_add
    assert [share[key] for key in ("0.125", "0.25", "0.5", "1", "2")] == pytest.approx([0.49, 0.65, 1.00, 0.96, 1.00], abs=0.01)
