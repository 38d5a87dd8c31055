"""Chimneys of rings: closed forms of weight and overturning, blocks that interlock, and the shell of the same wall."""

import numpy as np
import pytest

import extrados
from extrados.model.properties import Material
from extrados.model.structures.chimney import Chimney
from extrados.schema.constants import GRAVITY
from extrados.views.building import Building
from extrados.views.shell.mesh import nodal_areas
from extrados.views.shell.options import ShellOptions

DENSITY = 1900.0
TAPERED = {"kind": "chimney", "height": 12.0, "width": 2.4, "top_width": 1.6, "thickness": 0.5, "top_thickness": 0.3, "rings": 6}


def building(**change) -> Building:
    return Building(Chimney.model_validate(TAPERED | change), material=Material(density=DENSITY))


def moments(facets: int) -> tuple[float, float]:
    """Volume [m^3] and height of the centre of mass [m], by Gauss' rule, exact for polynomials of degree 5."""
    node, weight = np.polynomial.legendre.leggauss(3)
    z, dz = 6.0 * (node + 1.0), 6.0 * weight
    outer = 1.2 - 0.4 * z / 12.0
    inner = outer - (0.5 - 0.2 * z / 12.0)
    area = 0.5 * facets * np.sin(2.0 * np.pi / facets) * (outer**2 - inner**2)
    return float(dz @ area), float(dz @ (z * area) / (dz @ area))


def tilt(**change):
    joints = {"friction": change.pop("friction", 0.75)}
    direction = change.pop("direction", 0.0)
    deck = {
        "structure": TAPERED | change,
        "material": {"density": DENSITY},
        "joints": joints,
        "analysis": [{"kind": "tilt", "direction": direction}],
    }
    return extrados.run(deck)["tilt"]


@pytest.mark.parametrize(("facets", "direction", "arm"), [(16, 0.0, 1.2), (16, 11.25, 1.2 * np.cos(np.pi / 16)), (6, 0.0, 1.2)])
def test_whole_rings_overturn_about_the_base(facets: int, direction: float, arm: float) -> None:
    """About a corner of the polygon, or about the middle of a side."""
    volume, centre = moments(facets)
    found = tilt(facets=facets, direction=direction)
    assert found.collapse_acceleration_g == pytest.approx(arm / centre, rel=1e-8)
    assert found.weight_N == pytest.approx(volume * DENSITY * GRAVITY, rel=1e-10)


@pytest.mark.verify
def test_blocks_of_a_ring_are_never_stronger_than_the_ring() -> None:
    whole = tilt().collapse_acceleration_g
    few, slippery = (tilt(blocks=8, rings=4, friction=f).collapse_acceleration_g for f in (0.75, 0.3))
    assert 0.0 < slippery <= few + 1e-9 and few <= whole + 1e-9


@pytest.mark.parametrize("blocks", [1, 4, 8])
def test_blocks_do_not_overlap_and_fill_the_rings(blocks: int) -> None:
    made = building(blocks=blocks).solids()
    volume, centre = moments(16)
    assert len(made.mass) == 6 * blocks
    assert made.mass.sum() == pytest.approx(volume * DENSITY, rel=1e-10)
    assert made.mass @ made.centroid[:, 2] / made.mass.sum() == pytest.approx(centre, rel=1e-10)


def test_the_shell_weighs_what_the_wall_does() -> None:
    """A polygon of elements is a little smaller than the circle, the less the finer it is."""
    exact = 2.0 * np.pi * DENSITY * np.polynomial.Polynomial([0.95, -0.3 / 12]) * np.polynomial.Polynomial([0.5, -0.2 / 12])
    whole = float(exact.integ()(12.0))
    off = []
    for size in (0.6, 0.3):
        mesh = building().shell(ShellOptions(size=size))
        mass = sum(float((nodal_areas(mesh.xyz, p.connect).sum(axis=1) * p.thickness).sum()) * DENSITY for p in mesh.parts)
        off.append(1.0 - mass / whole)
    assert 0.0 < off[1] < 0.3 * off[0] < 0.01


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"thickness": 1.2}, "no space for a flue"),
        ({"blocks": 2}, "interlock"),
        ({"blocks": 5}, "multiple"),
        ({"rings": 400, "blocks": 100, "facets": 200}, "are allowed"),
    ],
)
def test_what_is_no_chimney_is_refused(change: dict, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        Chimney.model_validate(TAPERED | change)
