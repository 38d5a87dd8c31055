"""Blocks on sloping ground, and piers with a mass on a free head."""

import numpy as np
import pytest

from extrados.analyses.rocking.block import pose, toe_forces
from extrados.core.ground import Ground
from extrados.core.rocking import history
from extrados.limit.programme import LimitAnalysis
from extrados.model.errors import BadGeometry
from extrados.model.structures.block import Block, make_block
from extrados.schema.constants import GRAVITY
from extrados.views.building import Building

SLOPE = np.radians(3.0)
ALPHA = np.arctan2(0.5, 2.0)


def shaking(seed: int, size: float) -> np.ndarray:
    return size * np.random.default_rng(seed).normal(size=50)


def test_uplift_on_a_slope_is_known_exactly() -> None:
    """Up the slope g tan(alpha + slope), down g tan(alpha - slope); limit analysis of its stones says the same."""
    building = Building(Block(kind="block", width=1.0, height=4.0, base_slope=3.0))
    rocker = building.rocker()
    assert rocker.model.uplift == pytest.approx(np.tan([ALPHA + SLOPE, ALPHA - SLOPE]), rel=1e-12)
    assert rocker.critical == pytest.approx((ALPHA + SLOPE, ALPHA - SLOPE), rel=1e-12)
    limit = LimitAnalysis(building.blocks())
    assert limit.collapse(1)[0].gamma == pytest.approx(np.tan(ALPHA + SLOPE), rel=1e-9)
    assert limit.collapse(-1)[0].gamma == pytest.approx(-np.tan(ALPHA - SLOPE), rel=1e-9)


def test_a_slope_is_level_ground_whose_acceleration_is_turned() -> None:
    """Seen from the slope, gravity and the horizontal acceleration are turned by it: the same run with both channels."""
    a = shaking(4, 2.5)
    one = Building(Block(kind="block", width=1.0, height=4.0, base_slope=3.0)).rocker()
    level = Building(Block(kind="block", width=1.0, height=4.0)).rocker()
    c, s = np.cos(SLOPE), np.sin(SLOPE)
    along = c * a + s * GRAVITY  # apparent gravity pulls down the slope, to -x
    across = -s * a + (c - 1.0) * GRAVITY
    sloping = history(one.body, Ground(samples=a[None], step=0.1), 4.9, 0.01, tolerance=1e-11)
    turned = history(level.body, Ground(samples=np.array([along, across]), step=0.1), 4.9, 0.01, tolerance=1e-11)
    n = min(len(sloping.time), len(turned.time))
    assert sloping.impacts == turned.impacts > 2
    assert sloping.rotation[:n] == pytest.approx(turned.rotation[:n], abs=1e-8)


def test_a_block_on_a_slope_turns_about_its_toes() -> None:
    model = Building(Block(kind="block", width=1.0, height=4.0, base_slope=3.0)).rocker().model
    b = model.block
    for angle, toe in ((0.2, b.q[0]), (-0.1, b.p[0])):
        x, y, turn = pose(model, np.array([angle]))[0]
        c, s = np.cos(turn), np.sin(turn)
        arm = b.centroid[0] - toe
        assert [x, y] == pytest.approx(toe + np.array([c * arm[0] - s * arm[1], s * arm[0] + c * arm[1]]), abs=1e-12)


def test_a_slope_on_which_it_falls_by_itself_is_refused() -> None:
    with pytest.raises(BadGeometry, match="overturns under its own weight"):
        make_block(1.0, 4.0, slope=0.25)


def test_a_pier_with_a_mass_on_its_head() -> None:
    """Uplift at the half width over the height of the common centre; impact keeps the momentum about the new toe."""
    m, head, b, h = 2000.0 * 4.0, 6000.0, 0.5, 4.0
    rocker = Building(Block(kind="block", width=1.0, height=4.0, head_mass=head)).rocker()
    centre = (m * 0.5 * h + head * h) / (m + head)
    assert rocker.uplift == pytest.approx(b / centre, rel=1e-12)
    about = m * (1.0 + h * h) / 12.0 + m * (b**2 + 0.25 * h * h) + head * (b**2 + h * h)
    assert rocker.model.block.toe_inertia == pytest.approx(np.full(2, about), rel=1e-12)
    kept = m * (1.0 + h * h) / 12.0 + m * (0.25 * h * h - b**2) + head * (h * h - b**2)
    assert rocker.restitution == pytest.approx(kept / about, rel=1e-12)
    # the same limit for its stones, and a head without mass changes nothing
    assert LimitAnalysis(rocker.model.block).collapse(1)[0].gamma == pytest.approx(b / centre, rel=1e-9)
    assert make_block(1.0, 4.0, head_mass=0.0).inertia == make_block(1.0, 4.0).inertia


def test_forces_on_a_slope_hold_the_block_at_rest() -> None:
    model = Building(Block(kind="block", width=1.0, height=4.0, base_slope=3.0)).rocker().model
    still = history(model.body, Ground(samples=np.zeros((1, 2)), step=1.0), 0.5, 0.1)
    tangential, normal = toe_forces(model, still)
    assert normal == pytest.approx(np.full(6, model.block.mass[0] * GRAVITY))
    assert tangential == pytest.approx(np.zeros(6), abs=1e-9)
