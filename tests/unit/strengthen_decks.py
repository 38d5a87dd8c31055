"""Buildings to strengthen, and the results of their decks."""

from pathlib import Path
from typing import Any

from extrados.analyses.context import Context
from extrados.analyses.sequence import run_analyses, run_one
from extrados.decks.reader import make_deck
from extrados.results.strengthen import Strengthen

G = 9.80665
WALL = {"kind": "block", "width": 0.6, "height": 3.0, "depth": 1.0}
ANCHOR = {"name": "anchor", "start": [-0.3, 2.5], "start_stone": "block", "ground": [-2.3, 2.5]}
NAVE = {
    "structure": {"kind": "vault", "preset": "dejong-a"},
    "joints": {"friction": "no-sliding"},
    "tie": {"start": [-9.0, 4.0], "end": [9.0, 4.0]},
    "target": 0.2,
}
ARCH = {
    "structure": {"kind": "arch", "radius": 10.0, "thickness": 1.5, "embrace": 157.5, "voussoirs": 7},
    "joints": {"friction": "no-sliding"},
    "tie": {"start": [-6.0, 8.0], "end": [6.0, 8.0], "start_stone": "voussoir 2", "end_stone": "voussoir 6"},
    "target": 0.42,
}
CRUSHING = {**NAVE, "material": {"compressive_strength": "2 MPa"}, "target": 0.15}
COLUMN = {
    "structure": {"kind": "column", "width": 0.8, "height": 4.0, "drums": 5},
    "joints": {"friction": 0.8},
    "tie": {"start": [-0.39, 3.5], "ground": [-3.0, 3.5], "works_in": "both"},
    "target": 0.4,
}
SLIDING = {
    "structure": {"kind": "block", "width": 0.8, "height": 1.2, "depth": 1.0},
    "joints": {"friction": 0.3},
    "tie": {"start": [-0.39, 0.3], "start_stone": "block", "ground": [-3.0, 0.3], "works_in": "both"},
    "target": 0.45,
}
BUILDINGS = {"nave": NAVE, "arch": ARCH, "crushing": CRUSHING, "column": COLUMN, "sliding": SLIDING}


def run(data: dict[str, Any]) -> Any:
    """The result of the one analysis of a deck."""
    (result,) = run_analyses(Context(make_deck(data, Path.cwd()), threads=1))
    return result


def deck_of(building: dict[str, Any], **keys: Any) -> Any:
    tables = {k: building[k] for k in ("structure", "joints", "material") if k in building}
    asked = {"kind": "strengthen", "acceleration": f"{building['target']} g", "ties": [building["tie"]], **keys}
    return make_deck({**tables, "analysis": [asked]}, Path.cwd())


def strengthened(building: dict[str, Any], **keys: Any) -> Strengthen:
    deck = deck_of(building, **keys)
    result = run_one(Context(deck, 1), deck.analyses[0], deck.buildings[0])
    assert result.status == "ok", result.reason
    assert isinstance(result.results, Strengthen)
    return result.results
