"""A page without a server: one HTML file with a structure, calculated in advance for values of a dimension and of the tilt.

The file contains the modules of the page that draw (static/), and the reply of the session for each pair of values. It uses
no network.
"""

import base64
import html
import json
import struct
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from extrados.analyses.context import Refused
from extrados.decks.reader import DeckError
from extrados.explore.answers import changes, decks, views
from extrados.explore.desk import NEW_DECK, Desk
from extrados.explore.frames import Reply
from extrados.explore.handles import Handle
from extrados.explore.messages import TOLD, Message
from extrados.results.store import StoreError

STATIC = Path(__file__).parents[1] / "static"
#: Modules of the page in the file, each after those that it imports
MODULES = ("words.js", "said.js", "dom.js", "gestures.js", "stage.js", "transport.js", "standalone.js")
#: Values of the size and of the tilt; share of the present size and of the capacity that they reach
SIZES, TILTS, REACH_SIZE, REACH_TILT = 15, 21, 0.5, 1.15
#: Tilt that the file reaches at least [g]
LEAST_TILT = 0.1
#: Bytes of the file at most
LARGEST = 3_000_000
#: Lines of thrust in the file
LINES = ["least", "most", "plus", "minus"]


@dataclass(frozen=True)
class Grid:
    """A computed structure: `label` of the size, its values as text, tilts [g], and frames (sizes, tilts) of replies."""

    title: str
    label: str
    sizes: list[str]
    tilts: list[float]
    frames: list[list[bytes]]


def standalone(desk: Desk, message: Message) -> Iterator[Reply]:
    """The page without a server of what a desk has open, in the language of the message; the share of the work that is done, until
    then."""
    words = read_words(str(message.get("language", "en")))
    for share, grid in compute_grid(desk):
        yield Reply({"share": share} if grid is None else {"share": 1.0, "page": make_page(grid, words)})


def read_words(language: str) -> dict[str, str]:
    """The catalogue of a language of the page by its two letters; empty (English) without a catalogue."""
    catalogues = {path.stem: path for path in (STATIC / "words").glob("*.json")}
    return json.loads(catalogues[language].read_text("utf-8")) if language in catalogues else {}


def write_page(folder: Path, deck: str | None, target: Path) -> None:
    """Write the page without a server of a deck in a folder, or of a new arch, to a file."""
    desk = Desk(folder, deck)
    for _ in decks.open_deck(desk, {"text": NEW_DECK, "name": "new-arch.toml"} if deck is None else {"path": deck}):
        pass
    *_, (_, grid) = compute_grid(desk)
    assert grid is not None
    try:
        target.write_text(make_page(grid), "utf-8")
    except OSError as error:
        raise StoreError(f"{target}: cannot be written: {error.strerror or error}") from None


def compute_grid(desk: Desk) -> Iterator[tuple[float, Grid | None]]:
    """Share of the work that is done, then the grid of the deck that is open, which stays as it is.

    Refused if the structure is no plane section of blocks.
    """
    if desk.picture is None:
        raise Refused("a page without a server can show only plane sections of blocks")
    capacity = desk.picture.words.get("capacity") or {"plus_g": 0.0, "minus_g": 0.0}
    work = Desk(desk.place)
    work.place = desk.place
    for _ in decks.open_deck(work, {"text": desk.document.text, "here": "same"}):
        pass
    handle = chosen_handle(work)
    far = REACH_TILT * max(capacity["plus_g"], capacity["minus_g"], LEAST_TILT)
    tilts = np.round(np.linspace(-far, far, TILTS), 4).tolist()
    wanted = [""] if handle is None else [f"{v:.4g} {handle.unit}" for v in _around(float(handle.value))]
    sizes, frames = [], []
    for k, size in enumerate(wanted):
        try:
            if handle is not None:
                next(changes.drag(work, {"handle": handle.name, "text": size}))
        except TOLD:  # no building has this size
            continue
        sizes.append(size)
        frames.append([_frame(next(views.show(work, {"gamma": tilt, "lines": LINES}))) for tilt in tilts])
        yield (k + 1) / len(wanted), None
    if not sizes:
        raise DeckError(["the structure cannot be drawn with any of the sizes tried"])
    title = desk.there().deck.title or desk.name
    yield 1.0, Grid(title, "" if handle is None else handle.label, sizes, tilts, frames)


def chosen_handle(desk: Desk) -> Handle | None:
    """The size that the file varies: the thickness, else the first length that has a handle."""
    lengths = [h for h in desk.handles.values() if h.unit == "m" and isinstance(h.value, int | float) and h.value > 0.0]
    return next((h for h in lengths if h.name == "thickness"), next(iter(lengths), None))


def _around(value: float) -> np.ndarray:
    """Values about a size, itself in the middle."""
    return value * np.linspace(1.0 - REACH_SIZE, 1.0 + REACH_SIZE, SIZES)


def _frame(reply: Reply) -> bytes:
    """A reply without the arrays that the file does not show."""
    arrays = {name: array for name, array in reply.arrays.items() if not name.endswith("velocity") and name != "polygon"}
    return Reply({"scene": reply.words["scene"]}, arrays).pack()


def make_page(grid: Grid, words: dict[str, str] | None = None) -> str:
    """The file, with a catalogue of words; Refused if it is too large."""
    frames = [frame for row in grid.frames for frame in row]
    packed = zlib.compress(b"".join(struct.pack("<I", len(frame)) + bytes(4) + frame for frame in frames), 9)
    given = {"title": grid.title, "label": grid.label, "sizes": grid.sizes, "tilts": grid.tilts, "words": words or {}}
    told = json.dumps({**given, "frames": base64.b64encode(packed).decode()}).replace("<", "\\u003c")
    sources = json.dumps([(name, (STATIC / name).read_text("utf-8")) for name in MODULES]).replace("<", "\\u003c")
    style = (STATIC / "style.css").read_text("utf-8")
    page = _PAGE.replace("{title}", html.escape(grid.title)).replace("{style}", style)
    page = page.replace("{sources}", sources).replace("{data}", told)
    if len(page.encode()) > LARGEST:
        raise Refused(
            f"the file would have {len(page) / 1e6:.1f} MB, more than the {LARGEST / 1e6:g} MB allowed: use a structure of fewer blocks"
        )
    return page


_PAGE = """<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{title}</title>
<style>{style}</style>
</head>
<body>
<noscript>This page needs JavaScript.</noscript>
<div id="extrados" class="extrados"></div>
<script type="application/json" id="modules">{sources}</script>
<script type="application/json" id="data">{data}</script>
<script type="module">
const places = {}, read = (id) => JSON.parse(document.getElementById(id).textContent);
for (const [name, source] of read("modules")) {
  const text = source.replace(/from "\\.\\/(\\w+\\.js)"/g, (_, other) => `from "${places[other]}"`);
  places[name] = URL.createObjectURL(new Blob([text], { type: "text/javascript" }));
}
const data = read("data"), { use } = await import(places["words.js"]);
use(data.words);
const { start } = await import(places["standalone.js"]);
await start(document.getElementById("extrados"), data);
</script>
</body>
</html>
"""
