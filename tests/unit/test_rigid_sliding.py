"""Slides of a block on rigid contacts at the default step, against Newmark's block (1965): one stop, and many reversals."""

import numpy as np
import pytest
from dem_models import G, block_on_floor, pieces
from test_dem3_core import solids

from extrados.core import dem, dem3
from extrados.core.ground import Ground
from extrados.model.geometry.solids.polyhedra import box


def newmark(amplitude: float, period: float, friction: float, cycles: int, end: float) -> tuple[np.ndarray, np.ndarray]:
    """Times [s] and slips [m] under sines of the ground, by steps of some 5 us with stops inside them."""
    t = np.linspace(0.0, end, round(end / 5e-6))
    h = t[1]
    load = np.where(t < cycles * period, -amplitude * np.sin(2.0 * np.pi * t / period), 0.0).tolist()
    slip, v, x, brake = np.zeros(len(t)), 0.0, 0.0, friction * G
    for k in range(len(t) - 1):
        sense = np.sign(v) if v else np.sign(load[k])
        if v or abs(load[k]) > brake:
            after = v + (load[k] - sense * brake) * h
            after = after if after * v >= 0.0 else 0.0
            x += 0.5 * (v + after) * h
            v = after
        slip[k + 1] = x
    return t, slip


@pytest.mark.parametrize(("amplitude", "period", "friction"), [(0.5, 0.3, 0.2), (1.0, 0.2, 0.3), (0.5, 0.15, 0.1), (0.8, 0.5, 0.15)])
def test_slides_there_and_back_are_those_of_newmark(amplitude: float, period: float, friction: float) -> None:
    """Four cycles, within .1 % of the greatest slip (1 % before reversals were of second order), in the plane and in space."""
    cycles = 4
    end, omega = cycles * period + 0.3, 2.0 * np.pi / period
    t, slip = newmark(amplitude * G, period, friction, cycles, end)
    waves = np.array([[[[amplitude * G, 0.0, omega, 0.0]]], [[[0.0, 0.0, omega, 0.0]]]])
    ground = Ground(breaks=np.array([0.0, cycles * period, 100.0]), linear=np.zeros((2, 1, 2)), harmonic=waves)
    law = dem.Law(1e9, 1e9, friction)
    plane = dem.run(block_on_floor(2.0, 0.4, law), dem.Options(end, 0.005, rigid=True), ground)
    way = (np.cos(0.5), np.sin(0.5), 0.0)
    space = dem3.run(solids([box((-1, -1, 0), (1, 1, 0.4))], law), dem3.Options(end, 0.005, rigid=True, way=way), ground)
    for run, moved in ((plane, plane.place[:, 0, 0] - plane.settled[0, 0]), (space, (space.place[:, 0] - space.settled[0]) @ way)):
        wanted = np.interp(run.time, t, slip)
        assert np.abs(moved - wanted).max() < 1e-3 * np.abs(slip).max()
        assert moved[-1] == pytest.approx(slip[-1], rel=5e-3)
        assert run.residual < 2e-3


@pytest.mark.parametrize("width", [0.5, 1.0, 4.0])
def test_a_slide_under_a_pulse_at_the_default_step(width: float) -> None:
    friction, a, t = 0.3, 0.5 * G, 0.2
    run = dem.run(block_on_floor(width, 0.2, dem.Law(1e9, 1e9, friction)), dem.Options(0.6, rigid=True), pieces([0.0, t], [a]))
    assert run.settled[0, 0] - run.place[-1, 0, 0] == pytest.approx(0.5 * a * t**2 * (a / (friction * G) - 1.0), rel=1e-4)
