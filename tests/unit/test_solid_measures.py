"""Contacts of solids are measured over their least width: openings, slip and the outcome alike."""

from types import SimpleNamespace

import numpy as np
import pytest

from extrados.analyses.dem import solid_measures
from extrados.analyses.dem.measures import OPEN
from extrados.model.geometry.solids.assembly import Stone, assemble
from extrados.model.geometry.solids.polyhedra import prism
from extrados.results.dem import APART, CLOSED, ROCKS

LONG, NARROW = 4.0, 0.25


def _run(shift: np.ndarray) -> tuple[SimpleNamespace, SimpleNamespace]:
    """A beam upon a beam of 4 m by .25 m; the upper one shifted by (time, 3) [m]."""
    outline = np.array([[0.0, 0.0], [LONG, 0.0], [LONG, NARROW], [0.0, NARROW]])
    stones = [Stone(name, [prism(outline, low, low + 0.5)], 2000.0) for name, low in (("lower", 0.0), ("upper", 0.5))]
    assembly = assemble(stones, seats=[], what="beams")
    count = len(shift)
    model = SimpleNamespace(assembly=assembly, count=2, supports=SimpleNamespace(of_joint=np.zeros(len(assembly.a), dtype=int)))
    bodies = np.concatenate([assembly.centroid, np.zeros((1, 3))])  # with the ground
    place = np.tile(bodies, (count, 1, 1))
    place[:, 1] += shift
    upright = np.tile(np.eye(3), (3, 1, 1))
    run = SimpleNamespace(
        time=np.arange(float(count)), turn=np.tile(upright, (count, 1, 1, 1)), settled_turn=upright, settled=bodies, place=place
    )
    return model, run


def _between(model: SimpleNamespace) -> int:
    """The contact between the beams."""
    return int(np.flatnonzero((model.assembly.a >= 0) & (model.assembly.b >= 0))[0])


def test_beam_that_slid_by_its_width_is_apart() -> None:
    """The square root of its area is four times its width: a beam beside the other would still count as upon it."""
    model, run = _run(np.array([[0.0, 0.0, 0.0], [0.0, 0.9 * NARROW, 0.0], [0.0, 1.1 * NARROW, 0.0]]))
    assert solid_measures.widths(model) == pytest.approx(NARROW)
    between = _between(model)
    opening, slip, state = solid_measures.contacts(model, run)
    assert state[:, between].tolist() == [CLOSED, CLOSED, APART]
    assert slip[:, between] == pytest.approx([0.0, 0.9 * NARROW, 1.1 * NARROW])
    assert opening[:, between] == pytest.approx(0.0, abs=1e-12)


def test_gap_is_open_by_the_least_width() -> None:
    model, run = _run(np.array([[0.0, 0.0, 0.9 * OPEN * NARROW], [0.0, 0.0, 1.1 * OPEN * NARROW]]))
    state = solid_measures.contacts(model, run)[2]
    between = _between(model)
    assert state[:, between].tolist() == [CLOSED, APART]
    assert ROCKS not in state
