"""The factors of bands in the core against dense algebra."""

import numpy as np
import pytest

from extrados.core.errors import CoreError
from extrados.core.limit import BandFactor, SpringBand


def dense(band: np.ndarray) -> np.ndarray:
    n, high = band.shape
    lower = sum(np.diag(band[: n - k, k], -k) for k in range(min(high, n)))
    return lower + np.tril(lower, -1).T


# Shorter and longer than a panel of eight columns, its ends and the matrix' own, and more entries than there are equations
@pytest.mark.parametrize(("n", "width"), [(1, 0), (1, 3), (7, 2), (8, 7), (9, 8), (23, 1), (40, 13), (40, 39), (6, 20)])
def test_as_dense_algebra(n: int, width: int) -> None:
    draw = np.random.default_rng(100 * n + width)
    band = draw.uniform(-1.0, 1.0, (n, width + 1))
    band[:, 0] = draw.uniform(1.0, 3.0, n) + 2.0 * width
    matrix = dense(band)
    factor = BandFactor(band.copy())
    for _ in range(2):  # a solve leaves the factor as it is
        right = draw.uniform(-1.0, 1.0, n)
        assert factor.solve(right) == pytest.approx(np.linalg.solve(matrix, right), abs=1e-13)


@pytest.mark.parametrize("wrong", [-1.0, 0.0, np.nan, np.inf])
@pytest.mark.parametrize("place", [0, 11])
def test_what_is_not_positive_is_refused(wrong: float, place: int) -> None:
    band = np.tile([4.0, 1.0, 0.5], (12, 1))
    band[place, 0] = wrong
    with pytest.raises(CoreError, match="positive"):
        BandFactor(band)


def test_a_pivot_lost_in_rounding_is_refused() -> None:
    stiff = np.array([[1e9, -1e9], [1e9 + 1e-9, 0.0]])  # 1e-9 of the second is nothing beside 1e9
    with pytest.raises(CoreError, match="positive"):
        BandFactor(stiff)


def test_shapes_and_types_are_refused() -> None:
    for wrong in (np.ones(3), np.ones((0, 2)), np.ones((3, 2), dtype=np.float32), np.ones((2, 3)).T):
        with pytest.raises(ValueError, match="band matrix has shape"):
            BandFactor(wrong)
    with pytest.raises(ValueError, match="values for 12 equations"):
        BandFactor(np.tile([4.0, 1.0], (12, 1))).solve(np.ones(11))


@pytest.mark.parametrize("d", [2, 3])
def test_springs_as_dense_algebra(d: int) -> None:
    """Points with fewer equations than others, springs without symmetry, an order of rows that the factors must change."""
    draw = np.random.default_rng(d)
    n, m, most = 12, 30, 4
    first = draw.integers(0, n - 5, m)
    row = np.array([begin + draw.permutation(6)[:most] for begin in first])
    row[::3, -1] = -1
    arms = np.where((row >= 0)[:, None, :], draw.uniform(-1.0, 1.0, (m, d, most)), 0.0)
    springs = draw.uniform(-1.0, 1.0, (m, d, d))
    stiffness = np.zeros((n, n))
    for equations, arm, spring in zip(row, arms, springs, strict=True):
        used = equations[equations >= 0]
        stiffness[np.ix_(used, used)] += arm[:, : len(used)].T @ spring @ arm[:, : len(used)]
    band = SpringBand(arms, row, n, 5)
    for _ in range(2):
        band.lay(springs)
        assert band.factor()
        right = draw.uniform(-1.0, 1.0, (2, n))
        assert band.solve(right) == pytest.approx(np.linalg.solve(stiffness, right.T).T, abs=1e-9)
    band.lay(0.0 * springs)
    assert not band.factor()


def test_springs_outside_the_band_are_refused() -> None:
    arms, row = np.ones((1, 2, 2)), np.array([[0, 3]])
    for n, width in ((3, 2), (5, 2), (4, 4)):
        with pytest.raises(ValueError, match="equations"):
            SpringBand(arms, row, n, width)
    band = SpringBand(arms, row, 4, 3)
    with pytest.raises(ValueError, match="springs have shape"):
        band.lay(np.ones((1, 3, 3)))
    with pytest.raises(ValueError, match="right-hand sides"):
        band.solve(np.ones((1, 5)))
