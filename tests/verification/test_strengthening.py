"""Buildings strengthened for the peak of a record by limit analysis, then assessed by every strategy."""

from pathlib import Path
from typing import Any

import pytest

from extrados.analyses.context import Context
from extrados.analyses.sequence import run_analyses
from extrados.decks.reader import make_deck
from extrados.results.strengthen import Strengthen

RECORD = {"kind": "record", "file": "extrados:el-centro-1940"}


def on_a_roof(height: float, period: float) -> dict[str, Any]:
    """The motion at a height above the ground of a building of 10 m."""
    return {**RECORD, "floor": {"height": height, "building_height": 10.0, "building_period": period}}


#: The seven of docs/strengthening.md, and four more: tables of the deck, and the scale of the record
BUILDINGS: dict[str, tuple[dict[str, Any], float]] = {
    "garden wall": ({"structure": {"kind": "block", "width": 0.6, "height": 3.0}}, 1.0),
    "statue": ({"structure": {"kind": "block", "width": 0.5, "height": 2.0, "depth": 0.5}}, 1.0),
    "parapet": (
        {"structure": {"kind": "block", "width": 0.3, "height": 1.2}, "joints": {"friction": 0.7}, "motion": on_a_roof(9.0, 0.2)},
        1.0,
    ),
    "chimney": ({"structure": {"kind": "block", "width": 0.6, "height": 2.0, "depth": 0.6}, "motion": on_a_roof(8.0, 0.3)}, 1.0),
    "tower": ({"structure": {"kind": "block", "width": 5.0, "height": 24.0, "depth": 5.0}}, 1.0),
    "barrel vault": ({"structure": {"kind": "arch", "radius": 3.0, "thickness": 0.5, "embrace": 170.0, "voussoirs": 16}}, 1.0),
    "column": ({"structure": {"kind": "column", "width": 0.8, "height": 4.0, "drums": 4}, "joints": {"friction": 0.7}}, 1.0),
    "nave": ({"structure": {"kind": "vault", "preset": "dejong-a"}, "joints": {"friction": "no-sliding"}}, 0.6),
    "arch": ({"structure": {"kind": "arch", "radius": 1.0, "thickness": 0.18, "embrace": 170.0, "voussoirs": 20}}, 1.25),
    "statue on a pedestal": (
        {"structure": {"kind": "stack", "lower_width": 1.0, "lower_height": 1.5, "upper_width": 0.6, "upper_height": 2.0}},
        1.0,
    ),
    "pointed arch": ({"structure": {"kind": "pointed-arch", "radius": 4.0, "span": 5.0, "thickness": 0.5, "voussoirs": 16}}, 1.0),
}
#: Strategies that apply the load as limit analysis does, by other mechanics
STATIC = ("limit analysis", "sequentially linear analysis")


@pytest.mark.verify
@pytest.mark.parametrize("name", BUILDINGS)
def test_a_strengthened_building_stands_by_the_other_strategies_too(name: str) -> None:
    tables, scale = BUILDINGS[name]
    motion = {**tables.get("motion", RECORD), "scale": scale}
    asked = {"kind": "strengthen", "safety_factor": 1.0, "assess": True, "budget": 8}
    deck = make_deck({**tables, "motion": motion, "analysis": [asked]}, Path.cwd())
    (result,) = run_analyses(Context(deck, threads=2))
    r = result.results
    assert isinstance(r, Strengthen) and not r.met_before and r.best is not None
    for one in (one for one in r.interventions if one.meets_target):
        assert one.verdicts
        rows = {row.strategy: row for row in one.verdicts}
        assert rows["limit analysis"].before == "collapses" and rows["limit analysis"].margin_after == pytest.approx(1.0, rel=1e-5)
        elements = rows.get("sequentially linear analysis")
        if elements is not None and elements.margin_after is not None:  # finite elements: another method
            # a tie yields only after some movement, of which elements crack: the force of a tie is then not reached
            assert (elements.margin_before or 0.0) < elements.margin_after < 1.001
            if one.kind == "change":
                assert elements.margin_after == pytest.approx(1.0, rel=0.01)
        for row in one.verdicts:
            if row.before == "stands" and row.after in ("collapses", "cannot-stand"):
                assert any(row.strategy in text for text in one.adverse), "an adverse effect is named"
            if row.after in ("collapses", "cannot-stand"):
                assert any(f"By {row.strategy} the" in text for text in one.adverse)
