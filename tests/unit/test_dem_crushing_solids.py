"""Faces of solids that crush on springs: closed forms, an oblique load by integration, energy, refusals."""

from dataclasses import replace

import numpy as np
import pytest
from dem_models import G, pieces

import extrados
from extrados.core import dem3
from extrados.core.dem_run import Law

DENSITY = 2000.0
FACES = ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))


def box(width: float, depth: float, bottom: float, top: float) -> np.ndarray:
    across = ((-width / 2, -depth / 2), (width / 2, -depth / 2), (width / 2, depth / 2), (-width / 2, depth / 2))
    return np.array([[x, y, z] for z in (bottom, top) for x, y in across])


def stack(count: int, height: float, depth: float, strength: float, damping: float = 2e-4) -> dem3.Solids:
    """Blocks of 1 m x depth on each other, and a support."""
    one = height / count
    shapes = [box(1.0, depth, k * one, (k + 1) * one) for k in range(count)] + [box(4.0, 4.0, -1.0, 0.0)]
    mass = DENSITY * depth * one
    inertia = mass / 12.0 * np.diag([depth**2 + one**2, 1.0 + one**2, 1.0 + depth**2])
    dry = Law(1e10, 1e10, 0.9, damping=damping)
    return dem3.Solids(
        np.array([shape.mean(axis=0) for shape in shapes]),
        np.array([mass] * count + [0.0]),
        np.array([inertia] * count + [np.eye(3)]),
        shapes,
        [FACES] * (count + 1),
        list(range(count + 1)),
        [dry, replace(dry, strength=strength)],
        {(0, count): 1, **{(k, k + 1): 1 for k in range(count - 1)}},
    )


def tips(solids: dem3.Solids, acceleration: float, angle: float = 0.0) -> bool:
    ramp = pieces([0.0, 0.5, 1.0, 1.5, 20.0], [0.25 * acceleration * k for k in (1, 2, 3, 4)])
    way = (np.cos(angle), np.sin(angle), 0.0)
    return bool(dem3.run(solids, dem3.Options(12.0, 0.1, collapse=0.3, way=way), ramp).reason == "collapse")


@pytest.mark.parametrize("share", [2.5, 10.0, 100.0])
def test_a_block_tips_about_the_middle_of_its_pressed_edge(share: float) -> None:
    """a / g = (b - W / f_c d) / h, for a strength of so many times the even pressure."""
    solids, least = stack(1, 4.0, 0.8, share * DENSITY * G * 4.0), (1.0 - 1.0 / share) / 4.0 * G
    assert not tips(solids, 0.99 * least) and tips(solids, 1.01 * least)


def test_a_column_of_drums_tips_at_its_base() -> None:
    solids, least = stack(2, 3.0, 1.0, 200e3), (1.0 - DENSITY * G * 3.0 / 200e3) / 3.0 * G
    assert not tips(solids, 0.985 * least) and tips(solids, 1.015 * least)


def test_an_oblique_push_presses_the_corner_that_is_farthest() -> None:
    """The pressed part of the base is cut off by a line, with its centroid below the resultant: 1 x .6 x 4 m at 30 degrees."""
    strength, depth, height, n = 400e3, 0.6, 4.0, 600
    x, y = np.meshgrid((np.arange(n) + 0.5) / n - 0.5, ((np.arange(n) + 0.5) / n - 0.5) * depth)
    count = round(DENSITY * G * height / strength * n**2)

    def pressed(turn: float) -> np.ndarray:
        most = np.argsort(-(x * np.cos(turn) + y * np.sin(turn)).ravel())[:count]
        return np.array([x.ravel()[most].mean(), y.ravel()[most].mean()])

    low, high = 0.1, 1.5
    for _ in range(25):
        middle = 0.5 * (low + high)
        across, along = pressed(middle)
        low, high = (middle, high) if np.arctan2(along, across) < np.pi / 6 else (low, middle)
    least = 2.0 * float(np.hypot(*pressed(low))) / height * G
    assert least / G == pytest.approx(0.1713, abs=5e-4)
    solids = stack(1, height, depth, strength)
    assert not tips(solids, 0.985 * least, np.pi / 6) and tips(solids, 1.015 * least, np.pi / 6)


@pytest.mark.parametrize(("share", "stands"), [(0.99, False), (1.02, True)])
def test_a_block_stands_up_to_its_strength(share: float, stands: bool) -> None:
    run = dem3.run(stack(1, 4.0, 0.8, share * DENSITY * G * 4.0), dem3.Options(0.1, settlement=0.01))
    assert (run.reason == "end") == stands
    if not stands:
        assert run.reason == "unsettled" and run.blamed == [0]


def test_a_great_strength_changes_little_and_the_ledger_closes() -> None:
    """A rocking block between faces that hardly crush; one that rocks without dashpots on faces that crush."""
    pulse, times = pieces([0.0, 0.3, 0.6], [0.4 * G, -0.4 * G]), np.arange(0.0, 0.7, 0.01)
    pressure = DENSITY * G * 4.0
    dry, stiff = (dem3.run(stack(1, 4.0, 0.8, fc), dem3.Options(0.7), pulse, times=times) for fc in (0.0, 1e6 * pressure))
    far = np.abs(dry.place[:, 0] - dry.place[0, 0]).max()
    assert np.abs(dry.place[:, 0] - stiff.place[:, 0]).max() < 0.01 * far
    weak = dem3.run(stack(1, 4.0, 0.8, 8.0 * pressure, damping=0.0), dem3.Options(0.7), pulse, times=times)
    assert weak.residual < 1e-3
    assert np.abs(weak.place[30, 0, 0] - weak.place[0, 0, 0]) > 1.05 * np.abs(dry.place[30, 0, 0] - dry.place[0, 0, 0])
    with pytest.raises(ValueError, match="corners can crush only with springs"):
        dem3.run(stack(1, 4.0, 0.8, pressure), dem3.Options(0.7, rigid=True))


@pytest.mark.parametrize("keys", [{}, {"direction": 0.0}], ids=["plane", "space"])
def test_a_tilted_column_of_three_drums_in_the_plane_and_in_space(keys) -> None:
    """(b - W / f_c d) / h = 0.2353 g; dashpots that do not follow the springs give 0.267 g in the plane."""
    found = extrados.run(
        {
            "structure": {"kind": "column", "width": 1.0, "height": 3.0, "drums": 3},
            "material": {"density": DENSITY, "compressive_strength": "200 kPa", "young": "5 GPa"},
            "joints": {"friction": 0.9},
            "analysis": {"kind": "dem", "test": "tilt", "crushing": True, **keys},
        }
    ).results[0]
    assert found.results.collapse_acceleration_g == pytest.approx((1.0 - DENSITY * G * 3.0 / 200e3) / 3.0, abs=1e-3)
