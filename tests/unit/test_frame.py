"""Rocking frames: columns and a lintel rock as one larger block (Makris and Vassiliou 2013)."""

import numpy as np
import pytest

from extrados.core.ground import Ground
from extrados.core.rocking import history
from extrados.model.properties import Joints
from extrados.model.structures.block import Block
from extrados.model.structures.frame import Frame
from extrados.schema.constants import GRAVITY
from extrados.views.building import Building
from extrados.views.rockers.mechanism import MechanismModel

WIDTH, HEIGHT = 1.0, 6.0


def frame(columns: int = 2, **more) -> Building:
    table = {"width": WIDTH, "height": HEIGHT, "spacing": 4.0, "lintel_height": 1.5, "overhang": 0.5, **more}
    return Building(Frame(kind="frame", columns=columns, **table))


@pytest.mark.parametrize(("columns", "more"), [(2, {}), (3, {"lintel_mass": 90e3}), (5, {"lintel_mass": 1.0})])
def test_equation_of_a_frame_is_that_of_print(columns: int, more: dict) -> None:
    model = frame(columns, **more).rocker().model
    a, g = model.assembly, model.assembly.mass_ratio
    r, alpha, mass = a.radius, a.alpha, a.mass[:-1].sum()
    q = np.linspace(0.0, 1.8 * alpha, 30)
    for side in (1, -1):
        c = model.coefficients(side, q)
        assert c.mass == pytest.approx(np.full(30, 4.0 / 3.0 * mass * r**2 * (1.0 + 3.0 * g)), rel=1e-10)
        moment = mass * r * (1.0 + 2.0 * g)
        assert c.gravity_moment == pytest.approx(GRAVITY * moment * np.sin(alpha - q), abs=1e-9 * GRAVITY * moment)
        assert c.drive == pytest.approx(moment * np.cos(alpha - q), rel=1e-10)
    p = np.sqrt(0.75 * GRAVITY / r)
    assert model.frequency == pytest.approx(p * np.sqrt((1.0 + 2.0 * g) / (1.0 + 3.0 * g)), rel=1e-12)
    printed = (1.0 - 1.5 * np.sin(alpha) ** 2 + 3.0 * g * np.cos(2.0 * alpha)) / (1.0 + 3.0 * g)
    assert model.restitution == pytest.approx((printed, printed), rel=1e-12)


def test_a_frame_rocks_as_the_larger_block() -> None:
    """R larger by (1 + 3 gamma)/(1 + 2 gamma), alpha the same, the same restitution: impacts and rotations are equal."""
    one = frame().rocker()
    g, c_v = one.model.assembly.mass_ratio, one.restitution
    larger = (1.0 + 3.0 * g) / (1.0 + 2.0 * g)
    block = Block(kind="block", width=larger * WIDTH, height=larger * HEIGHT)
    other = Building(block, joints=Joints(restitution=c_v)).rocker()
    ground = Ground(samples=np.random.default_rng(3).normal(size=(1, 80)) * 2.5, step=0.05)
    found = [history(r.body, ground, 12.0, 0.01, tolerance=1e-11) for r in (one, other)]
    assert found[0].impacts == found[1].impacts > 3
    assert found[0].rotation == pytest.approx(found[1].rotation, abs=1e-9)


def test_limit_analysis_finds_the_same_frame() -> None:
    """The mechanism of limit analysis on the stones of two columns and a lintel, with the same impact."""
    building = frame()
    ours, found = building.rocker().model, MechanismModel(building.blocks(), "energy-safe")
    assert found.uplift == pytest.approx(ours.uplift, rel=1e-9)
    assert found.restitution == pytest.approx(ours.restitution, rel=1e-9)
    q = np.linspace(0.0, 0.3, 20)
    for side in (1, -1):
        theirs, mine = found.coefficients(side, q), ours.coefficients(side, q)
        assert theirs.mass == pytest.approx(mine.mass, rel=1e-9)
        assert theirs.gravity_moment == pytest.approx(mine.gravity_moment, abs=1e-9 * mine.gravity_moment[0])
    # a blow without rebound at all joints leaves as much: the frame rocks on as a frame
    assert MechanismModel(building.blocks(), "inelastic").restitution == pytest.approx(ours.restitution, rel=1e-6)


def test_forces_at_the_hinges_of_a_frame_fulfil_newton() -> None:
    model = frame().rocker().model
    c = model.coefficients(1, [0.05])
    acceleration = -c.gravity_moment[0] / c.mass[0]
    forces = model.hinge_forces([0.05], [0.0], [acceleration], [0.0], [0.0])
    assert forces.miss.max() < 1e-9
    assert (forces.normal > 0.0).all()
    # three columns share the lintel in more ways than one
    assert np.isnan(frame(3).rocker().model.hinge_forces([0.05], [0.0], [acceleration], [0.0], [0.0]).normal).all()
