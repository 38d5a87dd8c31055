"""The sheet on which blocks are drawn: the blocks of a deck for the page, and drawn blocks as the text of a deck."""

import re
from collections.abc import Iterator
from typing import Any

import tomlkit
from tomlkit.items import Table as TomlTable

from extrados.decks.reader import DeckError
from extrados.explore.answers.decks import open_deck
from extrados.explore.desk import Desk
from extrados.explore.frames import Reply
from extrados.explore.messages import TOLD, BadMessage, Message, numbers
from extrados.model.structures.blocks import Blocks

#: Blocks and vertices of a sheet, supports of it; characters of a name
MOST_BLOCKS, MOST_VERTICES, MOST_SUPPORTS, LONGEST_NAME = 1000, 8000, 200, 80
#: Blank lines before a block, which tomlkit adds at each change
SPACED = re.compile(r"\n{3,}\[\[structure\.block\]\]")
BLANK = """title = "A drawing"

[structure]
kind = "blocks"

[[analysis]]
kind = "tilt"
"""


def sheet(desk: Desk, _: Message) -> Iterator[Reply]:
    """Blocks (name, vertices [m]) and supports (segments [m]) of the deck; no blocks if the deck has none of its own."""
    table = _drawn(desk)
    rows = [] if table is None else table.block or []
    blocks = [{"name": row.name or f"block {k + 1}", "points": row.points} for k, row in enumerate(rows)]
    yield Reply({"sheet": {"blocks": blocks, "ground": [] if table is None else table.ground or []}})


def draw(desk: Desk, message: Message) -> Iterator[Reply]:
    """The deck with the drawn blocks and supports, opened; if it has no model yet, its text with the reasons, and the
    deck at hand stays. fresh: a deck of its own, else the deck at hand with all its other keys."""
    fresh = message.get("fresh") is True or _drawn(desk) is None
    text = _text(desk, *_shapes(message), fresh)
    try:
        yield from open_deck(desk, {"text": text} | ({"name": "drawing.toml"} if fresh else {"here": "same"}))
    except TOLD as error:
        complaints = error.complaints if isinstance(error, DeckError) else [str(error)]
        yield Reply({"draft": text, "trouble": [c[:2000] for c in complaints[:20]]})


def _drawn(desk: Desk) -> Blocks | None:
    """The table of a deck whose blocks are written in it."""
    table = None if desk.live is None else desk.live.deck.structure
    return table if isinstance(table, Blocks) and table.block is not None and table.origin is None else None


def _shapes(message: Message) -> tuple[list[tuple[str, list[list[float]]]], list[list[float]]]:
    """Blocks and supports of a message, within their bounds."""
    blocks, ground = message.get("blocks"), message.get("ground")
    if not isinstance(blocks, list) or not isinstance(ground, list):
        raise BadMessage("the sheet must contain a list of blocks and a list of supports")
    if len(blocks) > MOST_BLOCKS or len(ground) > MOST_SUPPORTS:
        raise BadMessage(f"a sheet may have at most {MOST_BLOCKS} blocks and {MOST_SUPPORTS} supports")
    found: list[tuple[str, list[list[float]]]] = []
    vertices = 0
    for block in blocks:
        name, points = (block.get("name"), block.get("points")) if isinstance(block, dict) else (None, None)
        if not isinstance(name, str) or not name.isprintable() or not 0 < len(name) <= LONGEST_NAME:
            raise BadMessage("every block of the sheet needs a name")
        if not isinstance(points, list) or (vertices := vertices + len(points)) > MOST_VERTICES:
            raise BadMessage(f"a block or support of the sheet may have at most {MOST_VERTICES} vertices")
        found.append((name, [numbers(point, 2) for point in points]))
    return found, [numbers(row, 4) for row in ground]


def _text(desk: Desk, blocks: list[tuple[str, list[list[float]]]], ground: list[list[float]], fresh: bool) -> str:
    """The deck as TOML. Blocks of the deck at hand that were not changed stay as their author wrote them."""
    made = tomlkit.parse(BLANK if fresh else desk.document.text)
    structure: Any = made["structure"]
    table = None if fresh else _drawn(desk)
    before: dict[str, list[tuple[int, Any, Any]]] = {}
    for k, (row, raw) in enumerate(zip((table.block if table else None) or [], structure.get("block", []), strict=False)):
        before.setdefault(row.name or f"block {k + 1}", []).append((k, row.points, raw))
    rows = tomlkit.aot()
    for k, (name, points) in enumerate(blocks):
        place, was, raw = before[name].pop(0) if before.get(name) else (None, None, None)
        if was == points and place == k and isinstance(raw, TomlTable):  # with its comments
            rows.append(raw)
            continue
        made_row = tomlkit.table()
        made_row.update(raw.unwrap() if raw is not None else {})
        if place != k:  # a name that followed from the place no longer does
            made_row["name"] = name
        if was != points:
            made_row["points"] = [[round(v, 6) for v in point] for point in points]
        made_row.add(tomlkit.nl())
        rows.append(made_row)
    if ground != ((table.ground if table else None) or []):
        structure.pop("ground", None)
        if ground:
            structure["ground"] = [[round(v, 6) for v in row] for row in ground]
    structure.pop("block", None)
    if blocks:
        structure["block"] = rows
    return SPACED.sub("\n\n[[structure.block]]", tomlkit.dumps(made))
