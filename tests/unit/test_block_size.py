"""The capacity of solids with blocks half as long, and in another bond."""

from typing import Any

import pytest

from extrados.analyses.context import Context
from extrados.analyses.sequence import run_analyses
from extrados.decks.reader import make_deck
from extrados.results.model import Result

DOME = {"kind": "dome", "radius": 10.0, "thickness": 1.0, "rings": 12, "lunes": 12}


def tilt(structure: dict[str, Any], **keys: Any) -> Result:
    deck = {"structure": structure, "joints": {"friction": 0.7}, "analysis": {"kind": "tilt", "direction": 0.0, "rose": 4, **keys}}
    (result,) = run_analyses(Context(make_deck(deck), threads=1))
    return result


def test_a_dome_by_its_blocks() -> None:
    """Another program on a dome without its keystone: 24 rings -1.5 %, 24 lunes -5.3 %."""
    found = tilt(DOME, block_size=True)
    rows = {row.change: row for row in found.results.block_sizes}
    assert rows["rings = 24"].relative_change == pytest.approx(0.4897 / 0.4973 - 1.0, abs=0.006)
    assert rows["lunes = 24"].relative_change == pytest.approx(0.471 / 0.497 - 1.0, abs=0.012)
    assert set(rows) == {"rings = 24", "lunes = 24", "bond = running"}
    assert "bond = running" in found.answer
    assert any("depends on the size of the blocks" in told for told in found.warnings)


def test_a_row_is_the_capacity_of_that_deck() -> None:
    """A wall in the other bond, with a tie and a load, by a deck of its own; a partition that cannot be made says why."""
    wall = {"kind": "wall", "unit_length": 0.4, "unit_height": 0.2, "thickness": 0.2, "height": 0.8, "legs": [{"length": 1.6}]}
    load = [{"x": 0.5, "y": 0.0, "force": "2 kN"}]
    rows = {row.change: row for row in tilt(wall, block_size=True, load=load).results.block_sizes}
    for change, keys in (("begins = half", {"begins": "half"}), ("unit_height = 0.1", {"unit_height": 0.1})):
        own = tilt({**wall, **keys}, load=load).results
        assert rows[change].collapse_acceleration_g == pytest.approx(own.collapse_acceleration_g, abs=1e-9)
        assert rows[change].blocks == own.blocks
    chimney = {"kind": "chimney", "height": 3.0, "width": 1.0, "thickness": 0.2, "rings": 3, "blocks": 4, "facets": 8}
    row = next(r for r in tilt(chimney, block_size=True).results.block_sizes if r.change == "blocks = 8")
    assert row.collapse_acceleration_g is None and row.reason


def test_blocks_without_a_rule_are_refused() -> None:
    square = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]
    found = tilt({"kind": "blocks", "block": [{"points": square}]}, block_size=True)
    assert found.status == "refused" and "no key for their size" in found.reason
