"""Saw-tooth laws and admissible ranges of the load multiplier (fortran/sla)."""

import numpy as np
import pytest

from extrados.core.errors import CoreError
from extrados.core.sla import Softening, intervals, largest_band, teeth

YOUNG, STRENGTH, ENERGY = 32e9, 3e6, 60.0  # thesis beam


def area(modulus: np.ndarray, strength: np.ndarray) -> float:
    """Energy under the teeth [J/m^3]."""
    strain = strength / modulus
    return float(np.sum(0.5 * strain**2 * (modulus - np.append(modulus[1:], 0.0))))


def test_ripple_of_the_thesis_beam() -> None:
    """16 teeth for p = 0.1 and h = 20 mm (thesis 4.3.1); moduli, peaks and strains by an independent script."""
    modulus, strength = teeth(Softening(STRENGTH, ENERGY, ripple=0.1, exact=False), YOUNG, 0.02)
    expected = [
        (32000.00, 3.2859, 1.0269e-4),
        (26156.92, 3.2519, 1.2432e-4),
        (21330.75, 3.2107, 1.5052e-4),
        (17344.51, 3.1607, 1.8223e-4),
        (14052.03, 3.1003, 2.2063e-4),
        (11332.56, 3.0272, 2.6712e-4),
        (9086.38, 2.9386, 3.2340e-4),
        (7231.12, 2.8313, 3.9155e-4),
        (5698.74, 2.7015, 4.7405e-4),
        (4433.06, 2.5443, 5.7394e-4),
        (3387.64, 2.3540, 6.9487e-4),
        (2524.17, 2.1236, 8.4129e-4),
        (1810.98, 1.8446, 1.0186e-3),
        (1221.91, 1.5068, 1.2332e-3),
        (735.36, 1.0979, 1.4930e-3),
        (333.48, 0.6028, 1.8076e-3),
    ]
    assert len(modulus) == 16
    np.testing.assert_allclose(modulus / 1e6, [row[0] for row in expected], atol=0.006)
    np.testing.assert_allclose(strength / 1e6, [row[1] for row in expected], atol=6e-5)
    np.testing.assert_allclose(strength / modulus, [row[2] for row in expected], rtol=6e-5)


@pytest.mark.parametrize(
    ("young", "strength", "energy", "band", "ripple", "count", "ratio"),
    [
        (32e9, 3e6, 60.0, 0.02, 0.2, 8, 0.9722),
        (32e9, 3e6, 60.0, 0.02, 0.05, 33, 0.9985),
        (6.9e9, 0.2e6, 50.0, 0.424, 0.2, 10, 1.0000),
        (6.9e9, 0.2e6, 50.0, 0.212, 0.2, 11, 0.9625),
        (32e9, 3e6, 60.0, 0.005, 0.1, 23, 1.0000),
        (32e9, 3e6, 60.0, 0.003, 0.1, 25, 0.9940),
    ],
)
def test_ripple_counts_and_energy(young, strength, energy, band, ripple, count, ratio) -> None:
    modulus, peaks = teeth(Softening(strength, energy, ripple=ripple, exact=False), young, band)
    assert len(modulus) == count
    assert area(modulus, peaks) / (energy / band) == pytest.approx(ratio, abs=6e-5)


#: law, h [m], p, teeth, last peak over ft, its strain over ft/E (an independent script)
EXACT = [
    ("linear", 0.02, 0.2, 8, 0.200, 24.3),
    ("linear", 0.02, 0.1, 16, 0.100, 23.2),
    ("linear", 0.02, 0.05, 32, 0.050, 22.5),
    ("linear", 0.1, 0.2, 5, 0.366, 3.7),
    ("linear", 0.1, 0.1, 10, 0.188, 4.0),
    ("linear", 0.1, 0.05, 19, 0.050, 4.4),
    ("exponential", 0.02, 0.2, 8, 0.287, 25.8),
    ("exponential", 0.02, 0.1, 15, 0.125, 38.7),
    ("exponential", 0.1, 0.2, 5, 0.291, 4.9),
    ("exponential", 0.1, 0.05, 18, 0.066, 7.8),
    ("hordijk", 0.02, 0.2, 7, 0.249, 40.8),
    ("hordijk", 0.02, 0.05, 29, 0.087, 43.7),
    ("hordijk", 0.1, 0.2, 4, 0.249, 8.2),
    ("hordijk", 0.1, 0.1, 9, 0.153, 8.1),
]


@pytest.mark.parametrize(("law", "band", "ripple", "count", "last", "strain"), EXACT)
def test_energy_exact_teeth(law, band, ripple, count, last, strain) -> None:
    modulus, peaks = teeth(Softening(STRENGTH, ENERGY, law, ripple), YOUNG, band)
    assert len(modulus) == count
    assert (np.diff(modulus) < 0.0).all()
    assert peaks[-1] / STRENGTH == pytest.approx(last, abs=6e-4)
    assert peaks[-1] / modulus[-1] / (STRENGTH / YOUNG) == pytest.approx(strain, abs=0.06)
    total = ENERGY / band
    if law == "hordijk":  # Gf counts from the crack strain on; its factor 5.136 is rounded
        x = np.linspace(0.0, 1.0, 400_001)
        curve = (1 + 27 * x**3) * np.exp(-6.93 * x) - 28 * x * np.exp(-6.93)
        total = STRENGTH * 5.136 * ENERGY / (STRENGTH * band) * np.trapezoid(curve, x)
    assert area(modulus, peaks) == pytest.approx(total, rel=1e-9)


def test_overshoot_is_optional() -> None:
    over, without = (teeth(Softening(STRENGTH, ENERGY, exact=exact, overshoot=False), YOUNG, 0.02)[1] for exact in (True, False))
    assert over[0] == pytest.approx(STRENGTH, rel=1e-12)
    assert without[0] == pytest.approx(STRENGTH, rel=1e-12)
    assert teeth(Softening(STRENGTH, ENERGY, exact=False), YOUNG, 0.02)[1][0] == pytest.approx(1.0953 * STRENGTH, rel=1e-4)


@pytest.mark.parametrize("law", ["linear", "exponential", "hordijk"])
def test_snap_back_is_refused_with_the_largest_band(law) -> None:
    softening = Softening(STRENGTH, ENERGY, law)
    limit = largest_band(softening, YOUNG)
    if law != "hordijk":
        assert limit == pytest.approx(2 * YOUNG * ENERGY / STRENGTH**2, rel=1e-12)
    teeth(softening, YOUNG, 0.9 * limit)
    with pytest.raises(CoreError, match="snaps back"):
        teeth(softening, YOUNG, 1.001 * limit)


def test_intervals_against_eigenvalues() -> None:
    """20 000 random pairs: inside the interval the greatest principal stress is below ft, outside above."""
    rng = np.random.default_rng(20261)
    strength = 0.7
    x = rng.standard_normal((2, 20_000, 2, 2))
    a, b = x + np.swapaxes(x, 2, 3)
    plane = [np.stack([s[:, 0, 0], s[:, 1, 1], s[:, 0, 1]], axis=1) for s in (a, b)]
    lo, hi = intervals(strength, 1.0, *plane)

    def excess(load: np.ndarray) -> np.ndarray:
        return np.linalg.eigvalsh(a + load[:, None, None] * b)[:, 1] - strength

    empty = lo > hi
    assert 7000 < empty.sum() < 8800  # 7902 in the notes' sample of the same kind
    for sample in rng.uniform(-6.0, 6.0, (40, len(a))):
        over = excess(sample) > 0.0
        assert over[empty].all()
        inside = (sample > lo) & (sample < hi) & ~empty
        assert not over[inside].any()
        assert over[~inside & ~empty & (np.minimum(np.abs(sample - lo), np.abs(sample - hi)) > 1e-9)].all()
    for end in (lo, hi):
        there = ~empty & (np.abs(end) < 1e100)
        load = np.where(there, end, 0.0)
        assert np.abs(excess(load)[there]).max() < 1e-7 * (1.0 + np.abs(load[there]).max())


def test_uniaxial_reference_is_the_degenerate_case() -> None:
    """Thesis Eq. 4.6: the quadratic term vanishes; Eq. 4.8 is left for a beam."""
    lo, hi = intervals(3.0, 1.0, [[1.25, 0.0, 0.0], [-0.4, 0.0, 0.0]], [[0.35, 0.0, 0.0], [-0.7, 0.0, 0.0]])
    assert hi[0] == pytest.approx((3.0 - 1.25) / 0.35, rel=1e-12)
    assert lo[0] < -1e10
    assert lo[1] == pytest.approx((3.0 + 0.4) / -0.7, rel=1e-12)
    assert hi[1] > 1e10


@pytest.mark.parametrize(("ft", "fc"), [(0.7, 5.3)])
def test_lateral_reduction_and_crushing_cones(ft, fc) -> None:
    """s1/ft - s2/fc <= 1 and -s2 <= fc as cones, against eigenvalues."""
    rng = np.random.default_rng(7)
    x = rng.standard_normal((2, 4000, 2, 2))
    a, b = 0.6 * (x + np.swapaxes(x, 2, 3))
    plane = [np.stack([s[:, 0, 0], s[:, 1, 1], s[:, 0, 1]], axis=1) for s in (a, b)]
    for alpha, beta, measure in (
        (ft * fc / (ft + fc), (fc - ft) / (fc + ft), lambda e: e[:, 1] / ft - e[:, 0] / fc - 1.0),
        (fc, -1.0, lambda e: -e[:, 0] - fc),
    ):
        lo, hi = intervals(alpha, beta, *plane)
        for sample in rng.uniform(-9.0, 9.0, (20, len(a))):
            over = measure(np.linalg.eigvalsh(a + sample[:, None, None] * b)) > 0.0
            inside = (sample >= lo) & (sample <= hi)
            clear = np.minimum(np.abs(sample - lo), np.abs(sample - hi)) > 1e-9
            assert (over == ~inside)[clear].all()
