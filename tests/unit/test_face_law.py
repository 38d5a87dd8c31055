"""Torsion of faces: friction of whole faces under an even pressure, beside that of their corners."""

from pathlib import Path

import numpy as np
import pytest
from test_load_path import run
from test_noisy_solids import corner, obj

from extrados.analyses.context import Context
from extrados.analyses.sequence import run_analyses
from extrados.decks.reader import make_deck
from extrados.limit.face_law import FaceLaw, mean_distance
from extrados.limit.solids import SolidLimit
from extrados.model.geometry.solids.assembly import assemble


@pytest.mark.parametrize(("b", "h"), [(1.0, 1.0), (1.0, 0.5), (0.3, 1.2)])
def test_mean_distance_of_a_rectangle(b: float, h: float) -> None:
    """By midpoints of a fine grid; pure torsion under an even pressure yields at mu N times it."""
    x, y = ((np.arange(1000) + 0.5) / 1000 - 0.5 for _ in range(2))
    assert mean_distance(np.array([b]), np.array([h]))[0] == pytest.approx(np.hypot(b * x[:, None], h * y[None]).mean(), rel=1e-5)


@pytest.mark.parametrize(
    ("friction", "direction", "other"), [(0.65, 90.0, 0.331), (0.65, 270.0, 0.311), (0.4, 90.0, 0.297), (0.4, 270.0, 0.281)]
)
def test_the_corner_of_the_reference(friction: float, direction: float, other: float) -> None:
    """Another program of the same law, whose last changes were up to .002."""
    found = FaceLaw(SolidLimit(assemble(corner()), friction)).push(direction)
    assert found.gamma == pytest.approx(other, abs=0.004) and found.spread < 0.01


def test_a_block_without_torsion_keeps_its_capacity() -> None:
    """Sliding of a block, and a block that overturns."""
    for height, friction, capacity in ((0.5, 0.4, 0.4), (4.0, 0.7, 0.25)):
        block = {"kind": "column", "width": 1.0, "height": height, "drums": 1}
        limit = SolidLimit(make_deck({"structure": block, "analysis": {"kind": "tilt"}}).building.solids(), friction)
        assert FaceLaw(limit).push(0.0).gamma == pytest.approx(capacity, abs=1e-4)


def test_both_are_reported_where_they_differ(tmp_path: Path) -> None:
    (tmp_path / "c.obj").write_text(obj(corner()))
    tables = {
        "structure": {"kind": "blocks", "file": "c.obj"},
        "joints": {"friction": 0.65},
        "analysis": {"kind": "tilt", "direction": 90.0, "rose": 4, "starts": 1},
    }
    (result,) = run_analyses(Context(make_deck(tables, tmp_path), threads=1))
    r = result.results
    assert r.collapse_acceleration_face_law_g < 0.97 * r.collapse_acceleration_g
    assert any("face law" in w and "In the mechanism along 90 degrees, contact faces twist" in w for w in result.warnings)
    without = run({"kind": "column", "width": 1.0, "height": 0.5, "drums": 1}, 0.4, direction=0.0, rose=4, face_law=True)
    assert without.results.collapse_acceleration_face_law_g == pytest.approx(0.4, abs=1e-4)
    assert not any("face law" in w for w in without.warnings)
