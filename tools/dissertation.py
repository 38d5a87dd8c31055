"""The pages on the dissertation's figures, docs/dissertation/*.md: each figure's row, and the pictures that redraw it."""

import re
from pathlib import Path

PLACE = Path(__file__).resolve().parents[1] / "docs" / "dissertation"
#: In the order of the chapters, the appendices last
PAGES = [PLACE / f"{name}.md" for name in ("index", *(f"chapter-{n}" for n in "34567"), "appendices")]
_ROW = re.compile(r"^\| [\dA-C]+-\d+ \|")


def rows() -> list[list[str]]:
    """The cells of each figure's row: number, content, deck that redraws it, printed, here, difference."""
    lines = [line for page in PAGES for line in page.read_text(encoding="utf-8").splitlines() if _ROW.match(line)]
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines]


def redrawn_by(cell: str) -> list[tuple[str, list[str]]]:
    """Cases that the third cell of a row names ("chapter/case"), each with the names of its pictures, which may be none."""
    return [
        (case, re.findall(r"figures/([\w-]+)\.png", pictures))
        for case, pictures in re.findall(r"`cases/([\w/-]+)`((?: `figures/[\w-]+\.png`)*)", cell)
    ]
