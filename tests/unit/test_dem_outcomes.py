"""How a run of discrete elements ends: at rest, slid, rocked, or a collapse by a criterion that the result names."""

import numpy as np
import pytest

import extrados
from extrados.schema.constants import GRAVITY

SOLVERS = [
    pytest.param({}, id="springs"),
    pytest.param({"solver": "nonsmooth"}, id="rigid"),
    pytest.param({"direction": 0.0}, id="space"),
    pytest.param({"direction": 0.0, "solver": "nonsmooth"}, id="space-rigid"),
]
SQUAT = {"kind": "block", "width": 0.5, "height": 0.3}
SINE = {"kind": "sine-pulse", "amplitude": "0.5 g", "period": 1.0}


def run(structure: dict, motion: dict | None = None, friction: float = 0.2, **dem):
    """The result of discrete elements."""
    deck = {"structure": structure, "joints": {"friction": friction}, "analysis": [{"kind": "dem", **dem}]}
    return extrados.run(deck | ({"motion": motion} if motion else {})).results[0]


def newmark(amplitude: float, period: float, friction: float, end: float = 3.0) -> np.ndarray:
    """Slip history [m] of a rigid block on ground that moves by one sine of acceleration [m/s^2] (Newmark 1965), integrated in
    small steps: while it slides the block is accelerated by friction alone."""
    step = 1e-5
    time = np.arange(0.0, end, step)
    ground = np.where(time < period, amplitude * np.sin(2.0 * np.pi * time / period), 0.0)
    limit, rate, slip, found = friction * GRAVITY, 0.0, 0.0, []
    for a in ground:
        if rate == 0.0 and abs(a) <= limit:
            found.append(slip)
            continue
        sense = np.sign(rate) if rate != 0.0 else -np.sign(a)
        after = rate + (-a - sense * limit) * step
        rate = 0.0 if after * sense < 0.0 else after
        slip += rate * step
        found.append(slip)
    return np.array(found)


def step_slip(amplitude_g: float, duration: float, friction: float) -> float:
    """Slip [m] on ground that moves by a step pulse, a then -a / 2 for twice as long, of a block that stops within the latter."""
    a, mu = amplitude_g * GRAVITY, friction * GRAVITY
    fast = (a - mu) * duration
    braked = fast**2 / (2.0 * (mu + 0.5 * a))
    assert fast / (mu + 0.5 * a) < 2.0 * duration
    return 0.5 * fast * duration + braked


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_block_that_slides_has_not_collapsed(solver: dict) -> None:
    """0.233 m at most and 0.020 m on the other side at the end, by Newmark's sliding block."""
    found = run(SQUAT, SINE, **solver)
    exact = newmark(0.5 * GRAVITY, 1.0, 0.2)
    assert np.abs(exact).max() == pytest.approx(0.233, abs=1e-3) and abs(exact[-1]) == pytest.approx(0.020, abs=1e-3)
    assert found["outcome"] == "slid" and found["collapse_criterion"] is None and found["collapse_time_s"] is None
    assert found["peak_slip_m"] == pytest.approx(np.abs(exact).max(), rel=5e-3)
    assert found["residual_slip_m"] == pytest.approx(abs(exact[-1]), abs=1e-3)
    assert max(map(abs, found["peak_rotation_rad"].values())) < 1e-5
    # 47 % of the base: what the footing or the joint still carries is not decided, and the footing is not as wide.
    assert found["slip_ratio"] == pytest.approx(np.abs(exact).max() / 0.5, rel=5e-3)
    assert found["off_footing"] == ["block"] and found.verdict.outcome == "open"
    assert "233 mm" in found.verdict.statement and "limit 25 %" in found.verdict.statement


@pytest.mark.parametrize("solver", SOLVERS)
def test_little_sliding_stands_and_the_verdict_says_how_much(solver: dict) -> None:
    found = run(SQUAT, SINE | {"period": 0.5}, friction=0.3, **solver)
    exact = np.abs(newmark(0.5 * GRAVITY, 0.5, 0.3)).max()
    assert found["outcome"] == "slid" and 0.01 * 0.5 < exact < 0.25 * 0.5
    assert found["peak_slip_m"] == pytest.approx(exact, rel=0.02)
    assert found.verdict.outcome == "stands" and f"{1e3 * found['peak_slip_m']:.3g} mm" in found.verdict.statement


@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.parametrize(
    ("structure", "motion", "friction", "outcome", "criterion"),
    [
        (SQUAT, None, 0.2, "at-rest", None),
        (SQUAT, SINE | {"amplitude": "0.1 g"}, 0.2, "at-rest", None),
        ({"kind": "block", "width": 0.5, "height": 2.0}, SINE | {"amplitude": "0.4 g", "period": 0.3}, 0.7, "rocked", None),
        ({"kind": "block", "width": 0.5, "height": 2.0}, SINE, 0.7, "collapse", "rotation"),
    ],
    ids=["still", "weak", "rocks", "overturns"],
)
def test_outcomes(structure: dict, motion: dict | None, friction: float, outcome: str, criterion: str | None, solver: dict) -> None:
    found = run(structure, motion, friction, end_time=2.0, **solver)
    assert (found["outcome"], found["collapse_criterion"]) == (outcome, criterion), found.answer
    assert found["governing_block"] == "block"
    expected = {"collapse": "collapses"}.get(outcome, "stands")
    assert found.verdict.outcome in (expected, "open") and (found.verdict.outcome == expected or found["still_moving"])


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_block_that_slides_off_its_footing_is_open(solver: dict) -> None:
    """The footing is of the program's making: the deck names no floor."""
    long = {"kind": "step-pulse", "amplitude": "0.6 g", "duration": 0.7}
    found = run(SQUAT, long, 0.1, **solver)
    assert found["outcome"] == "collapse" and found["collapse_criterion"] == "loss of support"
    assert found.verdict.outcome == "open" and "slides off the end of its footing" in found.verdict.violated[0]


@pytest.mark.parametrize("solver", SOLVERS[1:])  # plane springs trip where the footing meets the floor
def test_a_block_that_slides_on_a_named_floor_has_slid(solver: dict) -> None:
    long = {"kind": "step-pulse", "amplitude": "0.6 g", "duration": 0.7}
    on = run(SQUAT, long, 0.1, floor=0.0, **solver)
    assert on["outcome"] == "slid" and on["off_footing"] == []
    assert on["peak_slip_m"] == pytest.approx(step_slip(0.6, 0.7, 0.1), rel=0.01)


def test_the_upper_block_of_a_stack_governs() -> None:
    """The upper block overturns; the lower one does not turn, and is not the block that is named."""
    stack = {
        "kind": "blocks",
        "block": [
            {"name": "lower", "points": [[0, 0], [1.5, 0], [1.5, 1], [0, 1]]},
            {"name": "upper", "points": [[0.6, 1], [0.9, 1], [0.9, 2.5], [0.6, 2.5]]},
        ],
    }
    found = run(stack, SINE, 0.7)
    assert found["outcome"] == "collapse" and found["governing_block"] == "upper" and found["stopped_by"] == ["upper"]
    assert abs(found["peak_rotation_rad"]["upper"]) > 0.1 > 1e3 * abs(found["peak_rotation_rad"]["lower"])
    assert "upper collapses" in found.verdict.statement


@pytest.mark.parametrize("solver", [{}, {"direction": 0.0}], ids=["plane", "space"])
def test_no_pulse_of_a_domain_fails_by_sliding(solver: dict) -> None:
    """These pulses slide the squat block and cannot overturn it: the slenderness of its base exceeds the friction."""
    keys = {"kind": "dem-domain", "pulse": "sine", "amplitudes": ["0.5 g"], "durations": [0.5, 1.0], "floor": 0.0}
    deck = {"structure": SQUAT, "joints": {"friction": 0.2}, "analysis": [keys | solver]}
    assert extrados.run(deck).results[0]["shortest_durations_s"] == [None]


def test_a_tilt_test_ends_where_blocks_slide_on() -> None:
    """Under a sustained push sliding goes on: that is collapse, at the coefficient of friction."""
    found = run(SQUAT, test="tilt")
    assert found["collapse_acceleration_g"] == pytest.approx(0.2, abs=2e-3)


@pytest.mark.parametrize("stop", [True, False])
def test_the_criterion_does_not_hang_on_where_the_run_ends(stop: bool) -> None:
    """Stopped by the core, or seen in the histories of a run that goes on."""
    tall = {"kind": "block", "width": 0.5, "height": 2.0}
    found = run(tall, SINE, 0.7, stop_at_collapse=stop, end_time=1.5, output_step=1e-3)
    assert (found["outcome"], found["collapse_criterion"]) == ("collapse", "rotation")
    assert found["collapse_time_s"] == pytest.approx(run(tall, SINE, 0.7)["collapse_time_s"], abs=2e-3)


@pytest.mark.parametrize(
    ("structure", "friction", "interval"),
    [
        ({"kind": "brickwork", "unit_length": 0.5, "unit_height": 0.25, "units": 2, "courses": 3}, 0.3, True),
        ({"kind": "arch", "radius": 10.0, "thickness": 1.5, "embrace": 157.5, "voussoirs": 7}, 0.7, False),
        ({"kind": "column", "width": 1.0, "height": 2.0, "drums": 3}, 0.2, False),
        ({"kind": "block", "width": 1.0, "height": 1.0}, 0.4, False),
    ],
)
def test_a_tilt_test_that_slides_says_that_it_is_one_state_of_an_interval(structure: dict, friction: float, interval: bool) -> None:
    """Of joints whose forces statics does not fix: a stack that slides, or an arch that only hinges, has one capacity."""
    asked = {"kind": "dem", "test": "tilt", "solver": "nonsmooth", "tilt_accuracy": 0.02}
    found = extrados.run({"structure": structure, "joints": {"friction": friction}, "analysis": asked}).results[0]
    assert found.results.interval == interval
    for text in (found.verdict.statement, found.answer):
        assert ("form an interval" in text) == interval
    assert found.verdict.bound is None


@pytest.mark.parametrize("solver", SOLVERS[:2])
def test_a_block_that_tips_over_the_end_of_its_footing_has_slid(solver: dict) -> None:
    """It slides .357 m by Newmark, past its footing of .125 m on either side, over whose end it tips by .6 mrad for two outputs."""
    flat = {"kind": "block", "width": 0.5, "height": 0.15}
    found = run(flat, SINE | {"amplitude": "0.765 g"}, friction=0.306, end_time=3.0, **solver)
    exact = np.abs(newmark(0.765 * GRAVITY, 1.0, 0.306)).max()
    assert found["peak_slip_m"] == pytest.approx(exact, rel=5e-3)
    assert found["outcome"] == "slid" and found["off_footing"] == ["block"] and found.verdict.outcome == "open"


def test_a_chaotic_run_is_open_and_says_so() -> None:
    """1 x 5 m, 2 Hz, amplitudes 1e-5 g apart: outcomes are scattered, and every run says that a millionth decides."""
    tall = {"kind": "block", "width": 1.0, "height": 5.0}
    runs = [
        run(tall, {"kind": "harmonic", "amplitude": f"{1.0 + k * 1e-5!r} g", "frequency": 2.0, "duration": 10.0}, 0.9, solver="nonsmooth")
        for k in range(5)
    ]
    assert len({found["outcome"] for found in runs}) > 1
    for found in runs:
        assert found["decided_by_last_digits"] and found["perturbation_growth"] > 1e4
        assert found.verdict.outcome == "open" and "chaotic" in found.verdict.statement


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_smooth_run_is_not_chaotic_and_one_that_is_not_checked_says_so(solver: dict) -> None:
    """The growth of free sliding is that of Newmark's block: its slip under the motion times 1 + 1e-6."""
    motion = SINE | {"period": 0.5}
    found = run(SQUAT, motion, friction=0.3, **solver)
    exact = [np.abs(newmark(scale * GRAVITY, 0.5, 0.3)).max() for scale in (0.5, 0.505)]
    growth = (exact[1] - exact[0]) / 0.01 / found["collapse_displacement_m"]
    assert found["perturbation_growth"] < 10.0 * growth and not found["violated"] and not found["decided_by_last_digits"]
    assert found["perturbed_outcome"] == found["outcome"] == "slid" and "not checked" not in found.verdict.statement
    unchecked = run(SQUAT, motion, friction=0.3, perturbed=False, **solver)
    assert unchecked["perturbation_growth"] is None and "was not checked" in unchecked.verdict.statement
    assert unchecked.verdict.outcome == "stands"


def test_the_verdict_goes_by_the_criterion_that_is_nearer_to_its_limit() -> None:
    """A slip of 12 % of a joint is half of what its limit allows; where displacements are farther from theirs, it governs."""
    found = run(SQUAT, SINE | {"period": 0.5}, friction=0.3, collapse_displacement=1.0)
    share = found["slip_ratio"] / found["slip_limit_ratio"]
    assert found["slip_limit_ratio"] == 0.25 and share > found["peak_displacement_m"] / 1.0
    assert found.verdict.ratio == pytest.approx(1.0 / share) and found.verdict.unit == "of the joint"
    assert "is halved" in found.verdict.statement and "At the end of the run" in found.verdict.statement


def test_units_of_the_table_are_of_its_columns() -> None:
    table = run(SQUAT, SINE).tables["dem"]
    assert set(table.units) == set(table.columns)
