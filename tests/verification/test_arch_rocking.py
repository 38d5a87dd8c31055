"""The rocking arch against an independent model, and its invariants."""

import numpy as np
import pytest
from arch_oracle import Oracle

from extrados.core import rocking
from extrados.model.errors import NoView
from extrados.model.structures.arch import make_arch
from extrados.motions import pulses
from extrados.motions.records import locate, read_record, record_motion
from extrados.schema.constants import GRAVITY
from extrados.views.rockers.arch import ArchModel, minimum_thickness


@pytest.fixture(scope="module")
def oppenheim() -> ArchModel:
    return ArchModel(make_arch(10.0, 1.5, 157.5, 7), "thesis")


@pytest.mark.parametrize("duration", [pytest.param(0.20, marks=pytest.mark.verify), 0.27, 0.44])
def test_step_pulse_against_scipy(oppenheim, duration) -> None:
    def ground(t: float) -> float:
        return GRAVITY * (-1.0 if t < duration else 0.5 if t < 3 * duration else 0.0)

    response = rocking.history(oppenheim.body, pulses.step_pulse(-GRAVITY, duration).ground, 5.0, 0.01, tolerance=1e-10)
    found = [t for kind, t, _ in response.events if kind == "impact"]
    # SciPy must not step over the jumps: it is run piece by piece by a small maximum step
    impacts, _, fallen = Oracle(oppenheim, oppenheim.restitution).run(ground, 0.0, 1, 5.0, 2e-3)
    assert len(found) == len(impacts)
    assert found == pytest.approx(impacts, abs=2e-6)
    assert (response.outcome == "collapse") == (fallen is not None)
    if fallen:
        assert response.stop_time == pytest.approx(fallen, abs=2e-6)


def test_record_against_scipy() -> None:
    """From the uplift that leads to the largest rotation of the README's arch, through eight impacts."""
    model = ArchModel(make_arch(1.0, 0.144, 170.0, 34), "energy-safe")
    motion = record_motion(read_record(locate("extrados:el-centro-1940", None)))
    response = rocking.history(model.body, motion.ground, 5.0, 0.001, tolerance=1e-11)
    lifts = [(t, int(side)) for kind, t, side in response.events if kind == "uplift"]
    start, side = max((lift for lift in lifts if lift[0] < 2.0), key=lambda lift: lift[0])
    time, a = motion.series()
    impacts, peaks, _ = Oracle(model, model.restitution).run(lambda t: np.interp(t, time, a), start, side, 3.5, 1e-3)
    assert len(impacts) == 8 and len(peaks) >= 6
    found = [t for kind, t, _ in response.events if kind == "impact" and t > start][: len(impacts)]
    assert found == pytest.approx(impacts, abs=1e-6)
    top = [x for kind, t, x in response.events if kind == "peak" and t > start]
    for (_, theirs), ours in zip(peaks[:6], top[:6], strict=True):
        assert ours == pytest.approx(theirs, rel=1e-6, abs=1e-10)


def test_energy_is_kept_between_impacts(oppenheim) -> None:
    """Free rocking: between impacts the energy is constant, at each it falls by c_v squared."""
    quiet = pulses.constant(0.0, 10.0).ground
    start = 0.6 * oppenheim.limits.critical
    r = rocking.history(oppenheim.body, quiet, 8.0, 0.002, tolerance=1e-10, start_rotation=start)
    energy = r.kinetic + r.potential
    impacts = [t for kind, t, _ in r.events if kind == "impact"]
    assert len(impacts) > 5
    level = energy[0]
    for first, last in zip([0.0, *impacts[:5]], impacts[:6], strict=True):
        inside = energy[(r.time > first + 1e-9) & (r.time < last - 1e-9)]
        assert np.abs(inside - level).max() < 1e-8 * energy[0]
        level *= oppenheim.restitution**2
    assert r.work == 0.0


def test_similitude() -> None:
    """Eq. 5.7: lengths times s, times times sqrt(s), the same accelerations: the same rotations."""
    small, large = (ArchModel(make_arch(s, 0.15 * s, 157.5, 7), "thesis") for s in (1.0, 7.3))
    one = rocking.history(small.body, pulses.step_pulse(-9.0, 0.07).ground, 2.0, 0.01)
    two = rocking.history(large.body, pulses.step_pulse(-9.0, 0.07 * np.sqrt(7.3)).ground, 2.0 * np.sqrt(7.3), 0.01)
    assert one.outcome == two.outcome and one.impacts == two.impacts
    assert one.peak == pytest.approx(two.peak, rel=1e-7)


def test_mirror(oppenheim) -> None:
    """The mirrored motion gives the mirrored response, bit for bit."""
    one = rocking.history(oppenheim.body, pulses.sine_pulse(8.0, 0.6).ground, 6.0, 0.01)
    two = rocking.history(oppenheim.body, pulses.sine_pulse(-8.0, 0.6).ground, 6.0, 0.01)
    assert np.array_equal(one.rotation, -two.rotation)


def test_uplift_only_past_the_limit(oppenheim) -> None:
    gamma = oppenheim.collapse[0].gamma * GRAVITY
    for factor, outcome in ((1 - 1e-9, "no-hinging"), (1 + 1e-6, "recovery")):
        r = rocking.history(oppenheim.body, pulses.sine_pulse(factor * gamma, 0.5).ground, 5.0, 0.01)
        assert r.outcome == outcome


@pytest.mark.parametrize("over", [1.002, 1.0005])
def test_uplift_is_found_between_grid_points(oppenheim, over) -> None:
    """A sine whose crest lies anywhere: an excess of the limit is not missed."""
    gamma = oppenheim.collapse[0].gamma * GRAVITY
    for phase in np.linspace(0.0, 0.3, 7):
        ground = pulses.harmonic(over * gamma, 2.03, 1.0).ground
        ground.harmonic[..., 3] += phase
        assert rocking.history(oppenheim.body, ground, 1.5, 0.1).outcome != "no-hinging"
        ground.harmonic[..., 0] *= 0.9999 / over
        assert rocking.history(oppenheim.body, ground, 1.5, 0.1).outcome == "no-hinging"


def test_open_outcome(oppenheim) -> None:
    """A run that ends in mid-swing does not pretend to know the end."""
    pulse = pulses.step_pulse(-GRAVITY, 0.44).ground
    early, late = (rocking.history(oppenheim.body, pulse, end, 0.1) for end in (0.6, 5.0))
    assert not early.settled and early.outcome == "recovery"
    assert late.settled and late.outcome == "collapse"


@pytest.mark.parametrize(("ratio", "embrace", "n", "signed"), [(0.30, 140, 28, -0.143), (0.40, 120, 10, -0.836)])
def test_hinges_that_do_not_reflect(ratio, embrace, n, signed) -> None:
    """For stocky arches the mirrored mechanism would have to close further: no c_v is made up."""
    for rule in ("thesis", "energy-safe"):
        model = ArchModel(make_arch(1.0, ratio, embrace, n), rule)
        assert model.impacts.energy_safe == pytest.approx(signed, abs=1e-3)
        with pytest.raises(NoView, match="not open after"):
            _ = model.restitution
    assert ArchModel(make_arch(1.0, ratio, embrace, n), 0.4).restitution == 0.4


def test_arch_that_nothing_overturns() -> None:
    with pytest.raises(NoView, match="no horizontal load"):
        _ = ArchModel(make_arch(10.0, 1.0, 30.0, 4)).collapse


def test_threads_and_batches_do_not_change_a_bit(oppenheim) -> None:
    rng = np.random.default_rng(3)
    grounds = [rocking.Ground(samples=rng.normal(0, 4.0, (1, 400)), step=0.02) for _ in range(12)]
    index = np.arange(12)
    runs = [
        rocking.ensemble([oppenheim.body], grounds, 0 * index, index, 1.0, 12.0, threads=threads, stop_when_safe=False)
        for threads in (1, 2, 3)
    ]
    for other in runs[1:]:
        assert np.array_equal(runs[0].peak, other.peak) and np.array_equal(runs[0].outcome, other.outcome)
    alone = rocking.ensemble([oppenheim.body], [grounds[5]], [0], [0], 1.0, 12.0, stop_when_safe=False)
    assert alone.peak[0] == runs[0].peak[5]
    single = rocking.history(oppenheim.body, grounds[5], 12.0, 0.5)
    assert single.peak == runs[0].peak[5]


def test_stopping_when_safe_changes_no_outcome(oppenheim) -> None:
    durations = np.linspace(0.1, 1.0, 40)
    grounds = [pulses.step_pulse(-9.0, t).ground for t in durations]
    index = np.arange(40)
    quick, whole = (rocking.ensemble([oppenheim.body], grounds, 0 * index, index, 1.0, 60.0, stop_when_safe=s) for s in (True, False))
    assert np.array_equal(quick.outcome, whole.outcome)
    assert quick.peak == pytest.approx(whole.peak, rel=1e-12)


@pytest.mark.parametrize(
    ("ratio", "embrace", "value"),
    [(0.12, 160, 1.052), (0.12, 170, 1.148), (0.15, 170, 0.980), (0.15, 180, 1.017), (0.18, 180, 0.949), (0.21, 180, 0.877)],
)
def test_impact_where_hinge_a_is_above_the_springing(ratio, embrace, value) -> None:
    model = ArchModel(make_arch(1.0, ratio, embrace, embrace // 5), "thesis")
    assert model.impacts.thesis == pytest.approx(value, abs=6e-4)
    assert model.restitution == min(model.impacts.thesis, 1.0)
    assert bool(model.warnings) == (value > 1.0)
    assert model.impacts.energy_safe < 1.0


@pytest.mark.parametrize(
    ("ratio", "embrace", "value"), [(0.12, 140, 0.724), (0.15, 160, 0.731), (0.18, 150, 0.633), (0.21, 180, 0.618), (0.18, 180, 0.645)]
)
def test_energy_safe_impact(ratio, embrace, value) -> None:
    assert ArchModel(make_arch(1.0, ratio, embrace, embrace // 5)).impacts.energy_safe == pytest.approx(value, abs=6e-4)


@pytest.mark.parametrize(("n", "value"), [(27, 0.10678), (36, 0.10746), (180, 0.10746), (1000, 0.10748)])
def test_minimum_thickness(n, value) -> None:
    assert minimum_thickness(180.0, n) == pytest.approx(value, abs=1.1e-5)


def test_ring_sector_against_a_fine_polygon() -> None:
    """Area, centroid and inertia of a voussoir against its polygon of many sides."""
    from extrados.model.geometry.sectors import ring_sector

    inner, outer, angle = 1.3, 1.9, 0.37
    area, centre, polar = ring_sector(inner, outer, angle)
    r, t = np.meshgrid(inner + (outer - inner) * (np.arange(2000) + 0.5) / 2000, angle * ((np.arange(400) + 0.5) / 400 - 0.5))
    w = r * (outer - inner) / 2000 * angle / 400
    assert area == pytest.approx(w.sum(), rel=1e-9)
    assert centre == pytest.approx((w * r * np.cos(t)).sum() / area, rel=1e-6)
    assert polar == pytest.approx((w * ((r * np.cos(t) - centre) ** 2 + (r * np.sin(t)) ** 2)).sum(), rel=1e-5)


def test_bad_arguments_are_refused(oppenheim) -> None:
    ground = pulses.constant(1.0, 1.0).ground
    with pytest.raises(ValueError, match="restitution"):
        rocking.arch_body(oppenheim.four_hinge, 1.2)
    with pytest.raises(ValueError, match="not finite"):
        rocking.history(oppenheim.body, rocking.Ground(samples=np.array([[0.0, np.nan, 1.0]]), step=0.1), 1.0, 0.1)
    with pytest.raises(ValueError, match="positive"):
        rocking.history(oppenheim.body, ground, -1.0, 0.1)
    with pytest.raises(IndexError, match="run_body contains the index 1"):
        rocking.ensemble([oppenheim.body], [ground], [1], [0], 1.0, 1.0)


def response_to_sine(model: ArchModel, amplitude: float, period: float) -> tuple[int, float | None]:
    """Impacts, and the time of collapse, of an arch under one sine of amplitude [g]."""
    gamma, omega = model.collapse[0].gamma, 2.0 * np.pi / period
    found, _, fallen = Oracle(model, model.restitution).run(
        lambda t: -amplitude * GRAVITY * np.sin(omega * t) if t < period else 0.0,
        np.arcsin(gamma / amplitude) / omega,
        1,
        period + 8.0,
        period / 200.0,
        rtol=1e-8,
    )
    return len(found), fallen


@pytest.mark.parametrize(
    ("amplitude", "period", "impacts"), [(0.5, 1.1417, 1), pytest.param(1.0, 0.6669, 1, marks=pytest.mark.verify), (1.0, 1.4419, 0)]
)
def test_failing_sines_of_fig_5_7_against_scipy(oppenheim, amplitude: float, period: float, impacts: int) -> None:
    """`cases/arch/figure-5-7`: the arch recovers under a sine 0.1 % shorter, and collapses under one 0.1 % longer after this many impacts."""
    assert response_to_sine(oppenheim, amplitude, 0.999 * period)[1] is None
    count, time = response_to_sine(oppenheim, amplitude, 1.001 * period)
    assert count == impacts and time is not None


def test_the_failing_sine_of_arch_1_against_scipy() -> None:
    """`cases/arch/pulse-trains`: 0.24155 g at 0.3427 s by the default impact rule."""
    model = ArchModel(make_arch(0.2, 0.024, 162.0, 16), "inelastic")
    assert response_to_sine(model, 0.999 * 0.24155, 0.3427)[1] is None
    assert response_to_sine(model, 1.001 * 0.24155, 0.3427)[1] is not None
