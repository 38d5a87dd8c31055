"""The rocking block: closed forms, limits, energy, and what decks refuse."""

import numpy as np
import pytest

import extrados
from extrados.analyses.rocking.block import pose, toe_forces
from extrados.core import rocking
from extrados.core.rocking import Ground
from extrados.decks.reader import DeckError, make_deck
from extrados.model.structures.block import make_block
from extrados.motions import pulses
from extrados.views.rockers.block import BlockModel

G = 9.80665


def rectangle(width=1.0, height=4.0, **options) -> BlockModel:
    return BlockModel(make_block(width, height), **options)


@pytest.mark.parametrize(
    ("share", "period"), [(0.1, 1.86858), (0.25, 3.18146), (0.5, 5.26783), (0.75, 8.25375), (0.9, 11.97289), (0.99, 21.19317)]
)
def test_free_period_of_the_linear_form(share: float, period: float) -> None:
    """p T = 4 acosh(1/(1 - theta0/alpha)) (Housner 1963)."""
    m = rectangle(rule=1.0, linear=True)
    p, alpha = m.frequency[0], m.alpha[0]
    r = rocking.history(m.body, pulses.constant(0.0, 1.0).ground, 1.2 * period / p, 1.0, start_rotation=share * alpha)
    peaks = [t for kind, t, _ in r.events if kind == "peak"]
    assert p * peaks[1] == pytest.approx(period, abs=1e-5)


@pytest.mark.parametrize(("share", "period"), [(0.1, 1.876796), (0.5, 5.277503), (0.9, 11.978546)])
def test_free_period_of_the_full_equations(share: float, period: float) -> None:
    """Quarter periods at alpha = 0.25 by an ODE solver at rtol 1e-12."""
    m = rectangle(np.tan(0.25), 1.0, rule=1.0)
    p = m.frequency[0]
    r = rocking.history(m.body, pulses.constant(0.0, 1.0).ground, 1.2 * period / p, 1.0, start_rotation=share * 0.25)
    assert p * [t for kind, t, _ in r.events if kind == "peak"][1] == pytest.approx(period, abs=2e-6)


def test_decay_of_free_rocking() -> None:
    """phi_n = 1 - sqrt(1 - c_E^n (1 - (1 - phi_0)^2)), linear form."""
    m = rectangle(rule=0.9, linear=True)
    r = rocking.history(m.body, pulses.constant(0.0, 1.0).ground, 8.0, 1.0, start_rotation=0.6 * m.alpha[0])
    peaks = np.abs([x for kind, _, x in r.events if kind == "peak"])[:6] / m.alpha[0]
    n = np.arange(1, 7)
    assert peaks == pytest.approx(1.0 - np.sqrt(1.0 - 0.81**n * (1.0 - 0.4**2)), abs=1e-7)


def lowest_overturning(m: BlockModel, motion, low: float, high: float) -> float:
    """Bisection on the amplitude over g alpha; the range must hold one threshold."""
    unit = G * m.alpha[0]
    for _ in range(30):
        middle = 0.5 * (low + high)
        e = rocking.ensemble([m.body], [motion], [0], [0], middle * unit, 100.0 / m.frequency[0], tolerance=1e-10)
        low, high = (low, middle) if e.outcome[0] == 2 else (middle, high)
    return high


@pytest.mark.parametrize(("x", "length"), [(1.1, 2.39790), (1.5, 1.09861), (2.0, 0.69315), (3.0, 0.40547), (4.0, 0.28768)])
def test_rectangular_pulse(x: float, length: float) -> None:
    """p t1 = ln(x/(x - 1)), linear form, no return after the pulse."""
    m = rectangle(linear=True)
    motion = pulses.pulse("rectangular", -1.0, length / m.frequency[0]).ground
    assert lowest_overturning(m, motion, 0.5 * (1.0 + x), 1.5 * x) == pytest.approx(x, abs=1e-4 * x)


@pytest.mark.parametrize("ratio", [0.0, 0.2, 0.4])
def test_pulses_on_a_block_that_starts_off_rest(ratio: float) -> None:
    """x(0) = r alpha under a rectangular pulse of a g alpha, linear form: it passes alpha on its own after p t = ln(a/(a - 1 + r)).

    The curve over durations and the durations at given amplitudes start from the same rotation; a pulse below uplift may do."""
    import extrados

    m = rectangle(linear=True)
    p, alpha = float(m.frequency[0]), float(m.alpha[0])
    lengths = np.array([0.4, 0.8, 2.0]) / p
    x = np.array([1.5, 3.0] if ratio == 0.0 else [0.95, 1.5, 3.0])
    run = extrados.run(
        {
            "structure": {"kind": "block", "width": 1.0, "height": 4.0},
            "initial": {"rotation_ratio": ratio},
            "analysis": {
                "kind": "failure-domain",
                "pulse": "rectangular",
                "form": "linear",
                "durations": lengths.tolist(),
                "amplitudes": 20,
                "accuracy": 1e-6,
                "at_amplitudes": [f"{a!r} g" for a in (x * alpha).tolist()],
            },
        },
        threads=1,
    )
    found = run["failure-domain"]
    grown = np.exp(p * lengths)
    assert found.mode_I.amplitudes_g == pytest.approx((1.0 - ratio) * alpha * grown / (grown - 1.0), abs=2e-6)
    assert found.at_amplitudes.mode_I_durations_s == found.at_amplitudes.mode_II_durations_s
    assert found.at_amplitudes.mode_I_durations_s == pytest.approx(np.log(x / (x - 1.0 + ratio)) / p, abs=2e-6)


@pytest.mark.parametrize(
    ("ratio", "half", "whole"),
    [
        (1, 1.3224, 1.4183),
        (2, 1.8007, 2.3499),
        (3, 2.2939, 3.6311),
        (4, 2.7908, 5.2390),
        (5, 3.2891, 7.1681),
        (8, 4.7871, 14.871),
        (10, 5.7865, 21.600),
    ],
)
def test_sine_pulses_without_impact(ratio: float, half: float, whole: float) -> None:
    """sqrt(x^2 - 1) +- x exp(-p (pi or 2 pi - psi)/omega) = omega/p, linear form."""
    m = rectangle(linear=True, rule=0.0)
    period = 2.0 * np.pi / (ratio * m.frequency[0])
    for motion, x in ((pulses.pulse("half-sine", -1.0, period), half), (pulses.sine_pulse(-1.0, period), whole)):
        # After an impact with c_v = 0 it can only rest, so the one threshold is that without impact.
        assert lowest_overturning(m, motion.ground, 1.01, 1.5 * x) == pytest.approx(x, abs=2e-4 * x)


@pytest.mark.parametrize(
    ("linear", "rule", "thresholds"),
    [(True, 0.9, (3.02, 6.32, 7.17)), (False, 0.9, (3.04, 6.75, 7.50)), (False, "housner", (2.95, 6.83, 7.50))],
)
def test_one_sine_at_five_times_p(linear: bool, rule: object, thresholds: tuple) -> None:
    """First overturning after an impact, end of that range, overturning without impact (Zhang and Makris 2001)."""
    radius = 0.75 * G / 2.14**2
    m = rectangle(2 * radius * np.sin(0.25), 2 * radius * np.cos(0.25), rule=rule, linear=linear)
    x = np.arange(200, 800) / 100.0
    motion = pulses.sine_pulse(-1.0, 2.0 * np.pi / (5.0 * 2.14)).ground
    zero = np.zeros(len(x), int)
    e = rocking.ensemble([m.body], [motion], zero, zero, x * G * 0.25, 20.0, threads=2)
    change = x[1:][np.diff((e.outcome == 2).astype(int)) != 0]
    assert change == pytest.approx(thresholds, abs=0.0151)


def test_fig_7_1() -> None:
    """Impacts and peaks of the block of 1 x 4 m under 0.5 g cos 10.88 t (ODE at rtol 1e-10)."""
    m = rectangle()
    r = rocking.history(m.body, pulses.harmonic(0.5 * G, 10.88 / (2 * np.pi), 5.0, "cosine").ground, 5.0, 0.01)
    impacts = [t for kind, t, _ in r.events if kind == "impact"]
    assert impacts[:10] == pytest.approx([0.2576, 0.8048, 1.0647, 1.1967, 1.5393, 1.9515, 2.1565, 2.366, 2.7574, 3.0659], abs=1e-3)
    assert len(impacts) == 16
    peaks = [x for kind, _, x in r.events if kind == "peak"][:4]
    assert peaks == pytest.approx([-0.00625, 0.05391, -0.01626, 0.00534], abs=1e-4)
    energy = r.kinetic + r.potential
    assert np.abs(energy - r.ledger).max() < 1e-7 * energy.max()


def test_general_body_is_the_rectangle() -> None:
    a = make_block(0.8, 2.5, depth=0.5, density=1900.0)
    b = make_block(mass=float(a.mass[0]), inertia=float(a.inertia[0]), centre_height=1.25, toe_right=0.4)
    assert BlockModel(b).body.parameters == pytest.approx(BlockModel(a).body.parameters, rel=1e-14)
    m = BlockModel(a)
    assert m.restitution[0] == pytest.approx(1.0 - 1.5 * np.sin(m.alpha[0]) ** 2, rel=1e-14)
    assert m.frequency[0] == pytest.approx(np.sqrt(0.75 * G / a.radius[0]), rel=1e-14)


def test_unequal_toes() -> None:
    """Mirror image: the toes exchanged and the ground reversed give the same rotation with the other sign; the impact
    keeps the angular momentum about the new toe."""
    right = BlockModel(make_block(mass=1000.0, inertia=900.0, centre_height=1.5, toe_right=0.3, toe_left=0.5))
    left = BlockModel(make_block(mass=1000.0, inertia=900.0, centre_height=1.5, toe_right=0.5, toe_left=0.3))
    run = lambda m, sign: rocking.history(m.body, pulses.sine_pulse(sign * 3.5, 0.8).ground, 6.0, 0.02)  # noqa: E731
    a, b = run(right, 1.0), run(left, -1.0)
    assert a.impacts > 2
    assert a.rotation == pytest.approx(-b.rotation, abs=1e-9)
    old, new = np.array([-0.3, 1.5]), np.array([0.5, 1.5])  # centre of mass seen from the right and the left toe
    momentum = 900.0 + 1000.0 * old @ new
    assert right.restitution[1] == pytest.approx(momentum / (900.0 + 1000.0 * new @ new), rel=1e-14)
    assert BlockModel(right.block, energy_ratio=0.5).restitution == pytest.approx(
        np.sqrt(0.5 * right.block.toe_inertia[::-1] / right.block.toe_inertia)
    )


def test_vertical_acceleration_acts_as_gravity() -> None:
    """A constant upward ground acceleration of g is a world of twice the gravity: rotations run sqrt(2) times as fast."""
    m = rectangle(0.5, 2.0)
    start = 0.5 * m.alpha[0]
    lifted = Ground(samples=np.array([[0.0, 0.0], [G, G]]), step=50.0)
    still = Ground(samples=np.zeros((2, 2)), step=50.0)
    a = rocking.history(m.body, lifted, 3.0, 0.5, start_rotation=start)
    b = rocking.history(m.body, still, 3.0 * np.sqrt(2.0), 0.5, start_rotation=start)
    times = lambda r: np.array([t for kind, t, _ in r.events if kind == "impact"])[:6]  # noqa: E731
    assert times(a) * np.sqrt(2.0) == pytest.approx(times(b), rel=1e-9)
    # Free fall of the ground takes the resistance away: any push lifts the block.
    falling = Ground(samples=np.array([[0.1, 0.1], [-G, -G]]), step=1.0)
    assert rocking.history(m.body, falling, 0.5, 0.1).half_cycles == 1


def test_rest_and_uplift() -> None:
    """Free rocking comes to rest in finite time; a later push above g tan alpha lifts it again, one below does not."""
    m = rectangle(0.1, 0.4)
    quiet, limit = 3.0, G * np.tan(m.alpha[0])
    for share, again in ((0.99, False), (1.02, True)):
        ground = Ground(samples=np.array([[0.0, 0.0, share * limit, 0.0, 0.0]]), step=quiet)
        r = rocking.history(m.body, ground, 4.0 * quiet, 0.1, start_rotation=m.alpha[0] / 32.0)
        kinds = [kind for kind, t, _ in r.events if t > quiet]
        assert "rest" in [kind for kind, t, _ in r.events if t < quiet]
        assert ("uplift" in kinds) is again
    lifts = [t for kind, t, _ in r.events if kind == "uplift"]
    assert lifts[0] == pytest.approx(quiet + quiet / 1.02, abs=1e-9)


@pytest.mark.parametrize("linear", [False, True])
def test_series_and_runge_kutta_agree(linear: bool) -> None:
    """Samples are solved by the block's Taylor series, sines by Dormand-Prince: the same motion given both ways."""
    m = rectangle(0.5, 2.0, linear=linear)
    a = np.array([[0.0, 2.0, -2.4, 2.0, 0.0], [0.0, -1.0, 3.0, 4.0, 0.0]])
    sampled = Ground(samples=a, step=0.4)
    breaks = 0.4 * np.arange(5)
    lines = np.stack([a[:, :-1], np.diff(a) / 0.4], axis=2).transpose(1, 0, 2)
    # A sine of no amplitude keeps the general integrator in charge.
    pieces = Ground(breaks=breaks, linear=lines, harmonic=np.zeros((4, 2, 1, 4)))
    one, two = (rocking.history(m.body, g, 6.0, 0.01, tolerance=1e-11, start_rotation=0.05) for g in (sampled, pieces))
    assert one.impacts > 5
    assert one.rotation == pytest.approx(two.rotation, abs=1e-8)


def test_forces_at_the_toe() -> None:
    """Newton: the moment of the toe's force about the centre of mass is the rate of angular momentum."""
    m = rectangle(0.6, 2.0)
    r = rocking.history(m.body, pulses.sine_pulse(4.0, 1.0).ground, 2.0, 0.01)
    tangential, normal = toe_forces(m, r)
    moving = r.rotation != 0.0
    place = pose(m, r.rotation)[moving]
    toe = np.where(r.rotation[moving] < 0.0, -0.3, 0.3)
    moment = (toe - place[:, 0]) * normal[moving] - (0.0 - place[:, 1]) * tangential[moving]
    assert moment == pytest.approx(-m.block.inertia[0] * r.acceleration[moving], abs=1e-8 * normal.max())
    assert normal[~moving] == pytest.approx(m.block.mass[0] * G)


def test_ensemble_does_not_depend_on_threads() -> None:
    m = rectangle(0.1, 0.4)
    rng = np.random.default_rng(3)
    grounds = [Ground(samples=rng.normal(0.0, 3.0, (1, 300)), step=0.01) for _ in range(40)]
    zero, each = np.zeros(40, int), np.arange(40)
    one, two = (rocking.ensemble([m.body], grounds, zero, each, 1.0, 4.0, threads=n) for n in (1, 2))
    assert np.array_equal(one.peak, two.peak) and np.array_equal(one.outcome, two.outcome)
    assert len(set(one.outcome)) > 1


@pytest.mark.parametrize("channels", [1, 2])
@pytest.mark.parametrize("linear", [False, True])
def test_an_ensemble_has_the_bits_of_runs_one_by_one(channels: int, linear: bool) -> None:
    """An ensemble glides over whole samples and skips calm ones; a run with its history looks into every step."""
    m = BlockModel(make_block(0.3, 1.2), linear=linear)
    rng = np.random.default_rng(8)
    t = 0.01 * np.arange(400)
    waves = [np.sin(2 * np.pi * rng.uniform(0.4, 6.0, 8)[:, None] * t + rng.uniform(0, 6.0, 8)[:, None]) for _ in range(30)]
    window = np.sin(np.pi * t / t[-1]) ** 2
    grounds = [
        Ground(samples=np.stack([w.sum(axis=0) * window, 0.5 * w.cumsum(axis=0)[3] * window])[:channels] * 1.6, step=0.01) for w in waves
    ]
    each = np.arange(len(grounds))
    e = rocking.ensemble([m.body], grounds, 0 * each, each, 1.0, 4.6, stop_when_safe=False)
    assert {1, 2} <= set(e.outcome) and e.impacts.max() > 10
    for k, ground in enumerate(grounds):
        r = rocking.history(m.body, ground, 4.6, 0.3)
        assert (r.peak, r.stop_time, r.steps, r.impacts) == (e.peak[k], e.stop_time[k], e.steps[k], e.impacts[k])


def test_an_ensemble_stops_only_past_the_greatest_rotation() -> None:
    """The ground ends while the block comes back fast from a small swing: the next one is greater, though safe."""
    m = rectangle(0.5, 2.0)
    p, uplift = float(m.frequency[0]), G * float(np.tan(m.alpha[0]))
    grounds = [pulses.pulse("cosine", a * uplift, 2.4 / p).ground for a in np.linspace(1.05, 2.5, 30)]
    each = np.arange(30)
    stopped, whole = (rocking.ensemble([m.body], grounds, 0 * each, each, 1.0, 40.0 / p, stop_when_safe=safe) for safe in (True, False))
    assert np.array_equal(stopped.outcome, whole.outcome) and (stopped.stop_time < whole.stop_time).any()
    assert stopped.peak == pytest.approx(whole.peak, rel=1e-12)


BLOCK = {"kind": "block", "width": 0.5, "height": 2.0}


@pytest.mark.parametrize(
    ("tables", "said"),
    [
        ({"joints": {"restitution": 1.2}}, "less than or equal to 1"),
        ({"joints": {"restitution": -0.1}}, "greater than or equal to 0"),
        ({"joints": {"energy_ratio": 1.5}}, "less than or equal to 1"),
        ({"joints": {"energy_ratio": 0.5, "restitution": 0.9}}, "not both"),
        ({"initial": {"rotation_ratio": 1.0}}, "less than 1"),
        ({"initial": {"rotation_ratio": -1.7}}, "greater than -1"),
    ],
)
def test_bad_properties(tables: dict, said: str) -> None:
    with pytest.raises(DeckError, match=said):
        make_deck(
            {
                "structure": BLOCK,
                "motion": {"kind": "sine-pulse", "amplitude": "1 g", "period": 1.0},
                "analysis": {"kind": "rocking"},
                **tables,
            }
        )


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"restitution": 0.9}, r"has moved to \[joints\] restitution"),
        ({"mass": 100.0}, "give only one of the two"),
        ({"width": None, "height": None, "mass": 10.0}, "missing"),
        ({"width": 0.0}, "greater than 0"),
    ],
)
def test_bad_blocks(change: dict, said: str) -> None:
    table = {k: v for k, v in {**BLOCK, **change}.items() if v is not None}
    with pytest.raises(DeckError, match=said):
        make_deck(
            {"structure": table, "motion": {"kind": "sine-pulse", "amplitude": "1 g", "period": 1.0}, "analysis": {"kind": "rocking"}}
        )


def test_stocky_block_lands_flat() -> None:
    m = BlockModel(make_block(3.0, 1.0))
    assert m.restitution[0] == 0.0 and "lands flat" in m.warnings[0]


def test_column_is_taken_as_one_body() -> None:
    """Drums of one width are the block of the same size; a tapered column keeps its mass, centre and base."""
    import extrados

    motion = {"kind": "sine-pulse", "amplitude": "0.5 g", "period": 0.6}
    one = extrados.run(
        {"structure": {"kind": "block", "width": 0.5, "height": 2.0}, "motion": motion, "analysis": {"kind": "rocking", "hand_over": False}}
    )
    two = extrados.run(
        {
            "structure": {"kind": "column", "width": 0.5, "height": 2.0, "drums": 5},
            "motion": motion,
            "analysis": {"kind": "rocking", "hand_over": False},
        }
    )
    assert two["rocking"]["impact_times_s"] == pytest.approx(one["rocking"]["impact_times_s"], abs=1e-9)
    assert two["rocking"]["peak_rotation_rad"] == pytest.approx(one["rocking"]["peak_rotation_rad"], rel=1e-9)
    tapered = {"kind": "column", "width": 0.5, "top_width": 0.4, "height": 2.0, "drums": 4}
    r = extrados.run({"structure": tapered, "motion": motion, "analysis": {"kind": "rocking", "hand_over": False}})["rocking"]
    centre = 2.0 / 3.0 * (0.5 + 2 * 0.4) / (0.5 + 0.4)  # of a trapezium
    assert r["critical_rotation_rad"] == pytest.approx(np.arctan(0.25 / centre), rel=1e-9)


def test_an_answer_names_the_energy_ratio_that_it_rests_on() -> None:
    motion = {"kind": "sine-pulse", "amplitude": "0.5 g", "period": 0.6}
    block = {"kind": "block", "width": 0.5, "height": 2.0}
    run = extrados.run({"structure": block, "motion": motion, "joints": {"energy_ratio": 0.5}, "analysis": {"kind": "rocking"}})
    rests = run.analysis("rocking")["assumptions"]
    assert rests["joints.energy_ratio"]["value"] == 0.5 and rests["joints.energy_ratio"]["from"] == "deck"
    assert "joints.restitution" not in rests and "energy ratio 0.5 (deck)" in run.analysis("rocking")["answer"]
