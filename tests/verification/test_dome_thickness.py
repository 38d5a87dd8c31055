"""Least thickness of a hemispherical dome over the number of its rings (Heyman 1967: .042 of the radius)."""

import numpy as np
import pytest

from extrados.limit.solids import Programme, SolidLimit
from extrados.model.structures.dome import make_dome


def least_thickness(rings: int, lunes: int, friction: float | None) -> float:
    """Thickness over radius, by bisection to 1e-5."""
    low, high = 0.038, 0.046
    while high - low > 1e-5:
        middle = 0.5 * (low + high)
        stands = isinstance(SolidLimit(make_dome(1.0, middle, 180.0, rings, lunes), friction).push(0.0), Programme)
        low, high = (low, middle) if stands else (middle, high)
    return high


@pytest.mark.verify
def test_least_thickness_tends_to_heymans() -> None:
    found = np.array([least_thickness(n, 8, None) for n in (10, 20, 40)])
    assert found == pytest.approx([0.0423, 0.04265, 0.04278], abs=5e-5)
    steps = np.diff(found)
    limit = found[-1] + steps[-1] ** 2 / (steps[0] - steps[-1])  # of a geometric series
    assert limit == pytest.approx(0.042, rel=0.03)


@pytest.mark.verify
@pytest.mark.parametrize(("lunes", "friction"), [(16, None), (8, 0.7), (12, 0.5)])
def test_lunes_and_friction_do_not_matter(lunes: int, friction: float | None) -> None:
    assert least_thickness(10, lunes, friction) == pytest.approx(0.0423, abs=5e-5)
