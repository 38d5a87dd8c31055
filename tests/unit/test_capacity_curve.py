"""Displacement demand on a capacity curve: an example by hand, closed forms, and the same demand by other routes."""

import numpy as np
import pytest
from scipy.optimize import brentq

from extrados.analyses.codes import capacity_curve as cc
from extrados.motions.code_spectra import en1998

AG, SOIL, TB, TC = 0.15 * 9.81, 1.15, 0.2, 0.6


def spectrum(period, damping):
    """EN 1998-1 type 1, ground C, a_g 0.15 g, as code_spectra has it, with the damping factor without its lower bound."""
    plateau = 2.5 * np.sqrt(10.0 / (5.0 + 100.0 * damping))
    if period < TB:
        return AG * SOIL * (1.0 + period / TB * (plateau - 1.0))
    return AG * SOIL * plateau * min(1.0, TC / period)


def example(**more):
    """Masses of 120 and 100 t, shape 0.5 and 1: m* 160 t, Gamma 1.2308."""
    d, v = np.array([0.0, 2.0, 5.0, 10.0, 20.0, 26.0]), np.array([0.0, 300.0, 460.0, 520.0, 500.0, 416.0])
    return cc.CapacityCurve(1e-3 * d, 1e3 * v, np.array([120e3, 100e3]), np.array([0.5, 1.0]), more)


def rigid_plastic(force, start, end, mass=100e3):
    """An elastic-plastic curve of one mass: Gamma is 1."""
    d = np.array([0.0, start, end])
    return cc.CapacityCurve(d, np.array([0.0, force, force]), np.array([mass]), np.array([1.0]), {"drift": end})


def test_the_spectrum_of_the_example_is_that_of_the_code():
    periods = np.array([0.0, 0.1, 0.2356, 0.6, 1.2])
    assert [spectrum(t, 0.05) for t in periods] == pytest.approx(en1998(1, "C", AG)(periods), rel=1e-12)
    assert cc.corner_period(spectrum) == pytest.approx(TC, rel=1e-12)


def test_example_of_the_masonry_curve():
    """Printed: m* 160 t, Gamma 1.2308, k 113750 kN/m, F_y* 400.13 kN, d_y* 3.518 mm, T* 0.2356 s, q* 1.692, d* 9.713 mm, roof
    11.954 mm; SLC 1.753, SLV 1.405."""
    curve = example()
    o = cc.oscillator_of(curve)
    assert (curve.equivalent_mass, curve.ultimate) == pytest.approx((160e3, 0.026), rel=1e-12)
    assert curve.ended_by == "drop"
    printed = (1.2308, 113750e3, 400.13e3, 3.518e-3, 0.2356)
    found = (o.participation, o.law.stiffness, o.law.yield_load, o.law.yield_displacement, o.period)
    assert found == pytest.approx(printed, rel=2.5e-4)
    assert cc.strength_ratio(o, spectrum) == pytest.approx(1.692, abs=5e-4)
    demand = cc.n2_displacement(o, spectrum, TC)
    assert (1e3 * demand, 1e3 * demand * o.participation) == pytest.approx((9.713, 11.954), abs=5e-4)
    factors = [cc.n2_factor(o, spectrum, TC, cc.capacity_of(curve, o, s) / o.participation) for s in ("SLC", "SLV")]
    assert factors == pytest.approx([1.753, 1.405], abs=5e-4)


def test_example_with_the_secant_of_the_general_rule():
    """Printed: with 0.6 of the greatest force d* 8.528 mm, SLC 1.923."""
    curve = example()
    o = cc.oscillator_of(curve, cc.GENERAL)
    assert 1e3 * cc.n2_displacement(o, spectrum, TC) == pytest.approx(8.528, abs=5e-4)
    assert cc.n2_factor(o, spectrum, TC, curve.ultimate / o.participation) == pytest.approx(1.923, abs=5e-4)


def test_example_by_annex_b_and_by_the_capacity_spectrum():
    """Printed: Annex B iterated 10.104 mm; capacity spectrum 4.76 and 6.32 mm, and none before collapse with 0.33."""
    curve = example()
    _, demand = cc.annex_b(curve, spectrum, TC)
    assert 1e3 * demand == pytest.approx(10.104, abs=5e-4)
    found = [cc.capacity_spectrum_displacement(curve, spectrum, k) for k in (1.0, 0.66)]
    assert [1e3 * d for d in found] == pytest.approx([4.76, 6.32], abs=5e-3)
    assert cc.capacity_spectrum_displacement(curve, spectrum, 0.33) is None


@pytest.mark.parametrize("secant", [cc.MASONRY, cc.GENERAL])
def test_an_elastic_plastic_curve_is_its_own_idealisation(secant):
    curve = rigid_plastic(300e3, 3e-3, 21e-3)
    law = cc.oscillator_of(curve, secant).law
    assert (law.yield_load, law.yield_displacement, law.ultimate_displacement) == pytest.approx((300e3, 3e-3, 21e-3), rel=1e-9)
    other = cc.annex_b_oscillator(curve, 21e-3).law
    assert (other.yield_load, other.yield_displacement) == pytest.approx((300e3, 3e-3), rel=1e-9)


@pytest.mark.parametrize(("start", "end"), [(1e-3, 9e-3), (3e-3, 21e-3), (80e-3, 200e-3), (3e-3, 2e-3)])
def test_factor_by_the_crossing_in_the_acceleration_displacement_plane(start, end):
    """Another route: the ductility at which the inelastic spectrum S_e/R_mu meets the strength (R_mu of Vidic and others:
    linear below T_C, mu above), on a scale that is found until its displacement is the capacity."""
    curve = cc.CapacityCurve(np.array([0.0, start, 0.3]), np.array([0.0, 300e3, 300e3]), np.array([50e3, 90e3]), np.array([0.6, 1.0]), {})
    o = cc.oscillator_of(curve)
    period, strength = o.period, o.law.yield_load / o.mass
    yielded = strength * (period / (2.0 * np.pi)) ** 2

    def crossing(scale):
        felt = scale * spectrum(period, 0.05)
        if felt <= strength:
            return felt * (period / (2.0 * np.pi)) ** 2

        def reduction(mu):
            return 1.0 + (mu - 1.0) * min(period / TC, 1.0)

        mu = brentq(lambda mu: felt / reduction(mu) - strength, 1.0, 1e12, xtol=1e-13, rtol=1e-14)
        return mu * yielded

    assert cc.n2_displacement(o, spectrum, TC) == pytest.approx(crossing(1.0), rel=1e-9)
    scale = brentq(lambda s: crossing(s) - end, 1e-6, 1e6, xtol=1e-13, rtol=1e-14)
    assert cc.n2_factor(o, spectrum, TC, end) == pytest.approx(scale, rel=1e-9)


def test_factors_by_bisection_are_those_of_the_closed_form_and_of_the_spectrum():
    curve = example()
    o = cc.oscillator_of(curve)
    end = curve.ultimate / o.participation
    found = cc.greatest_factor(lambda s: cc.n2_displacement(o, lambda t, x: s * spectrum(t, x), TC), end)
    assert found == pytest.approx(cc.n2_factor(o, spectrum, TC, end), rel=1e-9)
    capacity = 8e-3
    found = cc.greatest_factor(lambda s: cc.capacity_spectrum_displacement(curve, lambda t, x: s * spectrum(t, x), 0.66), capacity)
    d, factor = cc.capacity_spectrum_factors(curve, spectrum, 0.66)
    assert found == pytest.approx(factor[d <= capacity].max(), rel=2e-3)


def test_capacities_by_limit_state():
    """20 % drop, three quarters of it, the yield point of the idealised curve and two thirds of it."""
    curve = example()
    o = cc.oscillator_of(curve)
    found = [1e3 * cc.capacity_of(curve, o, s) for s in ("SLC", "SLV", "SLD", "SLO")]
    # F_y/k = 492.5 kN/113.75 kN/mm by hand: area 11738 kN mm to 26 mm
    yielded = 26.0 - np.sqrt(26.0**2 - 2.0 * 11738.0 / 113.75)
    assert found == pytest.approx([26.0, 19.5, yielded, 2.0 / 3.0 * yielded], rel=1e-9)
    assert [cc.capacity_of(curve, o, s) for s in ("NC", "SD")] == [curve.ultimate, 0.75 * curve.ultimate]


def test_drifts_of_piers_end_the_curve_before_its_drop():
    curve = example(drift=0.015)
    assert (curve.ultimate, curve.ended_by) == (0.015, "drift")
    # areas are equal up to the limit drift: 300 + 1140 + 2450 + 510 x 5 - 2.5 x 5 kN mm, 520 to 510 kN
    area, k = 300.0 + 1140.0 + 2450.0 + 515.0 * 5.0, 364.0 / 3.2
    force = k * (15.0 - np.sqrt(15.0**2 - 2.0 * area / k))
    assert cc.oscillator_of(curve).law.yield_load * curve.participation == pytest.approx(1e3 * force, rel=1e-9)


def test_piers_at_their_strength_end_the_damage_limit_state_but_not_before_three_quarters_of_the_force():
    """0.75 x 520 kN = 390 kN is first reached at a point of the curve at 5 mm; the yield point is at 4.33 mm."""
    for strength, least in ((1e-3, 4.3296), (4.2e-3, 4.3296)):
        curve = example(strength=strength)
        assert 1e3 * cc.capacity_of(curve, cc.oscillator_of(curve), "SLD") == pytest.approx(least, abs=1e-3)
    late = example(strength=9e-3)
    assert 1e3 * cc.capacity_of(late, cc.oscillator_of(late), "SLD") == pytest.approx(4.3296, abs=1e-3)


def test_a_curve_without_a_drop_ends_where_it_ends():
    curve = cc.CapacityCurve(np.array([0.0, 1e-3, 2e-3]), np.array([0.0, 1e5, 1.1e5]), np.ones(1), np.ones(1))
    assert (curve.ultimate, curve.ended_by) == (2e-3, "end")


def test_coefficient_method_by_hand():
    """T_e 0.5 s, S_a 6 m/s^2, V_y 300 kN, W 981 kN: mu_strength 2, C_1 1 + 1/(60 x 0.25), C_2 1 + (1/0.5)^2/800."""
    mass = 100e3
    stiffness = mass * (2.0 * np.pi / 0.5) ** 2
    curve = rigid_plastic(300e3, 300e3 / stiffness, 0.2, mass)
    demand = cc.coefficient_displacement(cc.oscillator_of(curve), lambda t, x: 6.0, mass * 9.80665)
    by_hand = (1.0 + 1.0 / 15.0) * (1.0 + 4.0 / 800.0) * 6.0 * (0.5 / (2.0 * np.pi)) ** 2
    assert demand == pytest.approx(by_hand, rel=1e-9)


def test_return_periods_between_limit_states():
    """Between the points of a hazard a = c T^(1/k) the line of logarithms is exact; outside them nothing is known."""
    known = {years: 0.01 * years ** (1.0 / 2.4) for years in (50.0, 475.0, 975.0)}
    for years in (50.0, 100.0, 700.0):
        assert cc.return_period(0.01 * years ** (1.0 / 2.4), known) == pytest.approx(years, rel=1e-9)
    assert [cc.return_period(0.01 * years ** (1.0 / 2.4), known) for years in (20.0, 2000.0)] == [None, None]
    assert cc.return_period(1.5, {475.0: 1.5}) is None
