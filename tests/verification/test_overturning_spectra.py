"""Overturning spectra of the slender block against closed forms, and similarity of blocks of unlike size."""

import numpy as np
import pytest
from linear_block import edges, one_cosine, one_sine, outcome, rectangle
from scipy.optimize import brentq

from extrados.analyses.rocking.failure_domain import Mapper
from extrados.core import rocking
from extrados.model.structures.block import make_block
from extrados.motions.pulses import sine_pulse
from extrados.schema.constants import GRAVITY
from extrados.views.rockers.block import BlockModel
from trials import Trial

C_V = 0.9
SHAPES = {"sine": one_sine, "cosine": one_cosine, "rectangular": rectangle}


def slender(width: float = 0.5, height: float = 2.0, c_v: float = C_V, linear: bool = True) -> BlockModel:
    return BlockModel(make_block(width, height), c_v, linear=linear)


def codes(model: BlockModel, pulse: str, durations: np.ndarray, amplitudes: np.ndarray) -> np.ndarray:
    """Outcomes over (durations [s], amplitudes [m/s^2])."""
    mapper = Mapper(model.body, pulse, durations.tolist(), 60.0 / float(model.frequency[0]), 2)
    index, amplitude = np.repeat(np.arange(len(durations)), len(amplitudes)), np.tile(amplitudes, len(durations))
    return mapper.codes(index, amplitude).reshape(len(durations), len(amplitudes))


def closed(pulse: str, ratio: float, amplitude: float) -> int:
    """The outcome code by the closed form; ratio: omega/p, of a rectangle 2 pi over p times its length."""
    argument = 2.0 * np.pi / ratio if pulse == "rectangular" else ratio
    word, impacts = outcome(SHAPES[pulse](amplitude, argument), C_V)
    return {"rest": 0, "safe": 1, "down": 2 if impacts else 3}[word]


@pytest.mark.parametrize("pulse", ["sine", *(pytest.param(s, marks=pytest.mark.verify) for s in SHAPES if s != "sine")])
def test_every_outcome_of_the_spectrum_is_that_of_the_closed_form(pulse: str) -> None:
    """Zhang and Makris (2001), Figs of one-sine and one-cosine pulses; rest, safe, and both modes of overturning."""
    model = slender()
    p, alpha = float(model.frequency[0]), float(model.alpha[0])
    ratios, amplitudes = np.linspace(0.75, 8.0, 30), np.linspace(0.62, 12.0, 40)
    found = codes(model, pulse, 2.0 * np.pi / (ratios * p), amplitudes * alpha * GRAVITY)
    expected = np.array([[closed(pulse, w, a) for a in amplitudes] for w in ratios])
    assert {1, 2, 3} <= set(expected.ravel()) or pulse == "rectangular"
    trial = Trial(f"overturning_{pulse}", f"outcomes of the overturning spectrum of one {pulse} that are not those of the closed form")
    trial.tried = found.size
    trial.notes.append("omega/p 0.75 to 8, amplitudes to 12 g alpha, c_v 0.9 (Zhang and Makris 2001)")
    for i, k in np.argwhere(found != expected):
        near = {closed(pulse, ratios[i], amplitudes[k] * (1.0 + shift)) for shift in (-1e-6, 1e-6)}
        if found[i, k] not in near:
            trial.fail(f"omega/p {ratios[i]:.3f}, amplitude {amplitudes[k]:.3f}: {found[i, k]}, expected {expected[i, k]}")
    trial.close(1200, keep=True)


@pytest.mark.parametrize(
    ("pulse", "ratios"),
    [
        ("sine", (1.5, 5.0)),
        pytest.param("sine", (3.0, 6.0), marks=pytest.mark.verify),
        pytest.param("cosine", (1.5, 2.5, 3.5), marks=pytest.mark.verify),
    ],
)
def test_edges_of_the_spectrum(pulse: str, ratios: tuple[float, ...]) -> None:
    """The lowest overturning amplitude is that of the closed form to 1e-7."""
    model = slender()
    p, alpha = float(model.frequency[0]), float(model.alpha[0])
    for ratio in ratios:
        edge = edges(lambda a, w=ratio: SHAPES[pulse](a, w), C_V, np.arange(0.9, 20.0, 0.1))[0]
        around = edge * np.array([1.0 - 1e-7, 1.0 + 1e-7]) * alpha * GRAVITY
        below, above = codes(model, pulse, np.array([2.0 * np.pi / (ratio * p)]), around)[0]
        assert below < 2 <= above, (ratio, edge)


@pytest.mark.parametrize(
    ("ratio", "edge"), [(5.0, "first"), (5.5, "first"), (6.0, "first"), (3.0, "last"), (4.0, "last"), (5.0, "last"), (6.0, "last")]
)
def test_overturning_after_one_impact_past_the_pulse(ratio: float, edge: str) -> None:
    """Dimitrakopoulos and DeJong (2012): free motion keeps E = v^2 - (x - 1)^2, an impact leaves c_v^2 of v^2, and the
    block just reaches its balance where c_v^2 (1 + E) = 1 with E the energy at the end of the pulse: the first and the
    last amplitude of one sine that overturns after an impact."""
    w, end = ratio, 2.0 * np.pi / ratio

    def after_pulse(a: float) -> tuple[float, float]:
        """x and v at the end of the sine, from uplift at a sin(w t) = 1 in one swing."""
        start = np.arcsin(1.0 / a) / w
        share = a / (1.0 + w**2)
        c0, s0, t = share * np.sin(w * start) - 1.0, share * w * np.cos(w * start), end - start
        return 1.0 + c0 * np.cosh(t) + s0 * np.sinh(t), c0 * np.sinh(t) + s0 * np.cosh(t) - share * w

    def excess(a: float) -> float:
        x, v = after_pulse(a)
        return C_V**2 * (1.0 + v**2 - (x - 1.0) ** 2) - 1.0

    amplitudes = np.linspace(1.02, 9.0, 1000)
    values = np.array([excess(a) for a in amplitudes])
    rising = edge == "first"
    k = np.flatnonzero((values[:-1] < 0.0) == rising)
    k = k[(values[k] < 0.0) != (values[k + 1] < 0.0)][0]
    critical = brentq(excess, amplitudes[k], amplitudes[k + 1], xtol=1e-13)
    x, v = after_pulse(critical)
    assert x > 0.0 > v, "the impact comes after the pulse"
    model = slender()
    p, alpha = float(model.frequency[0]), float(model.alpha[0])
    around = critical * np.array([1.0 - 1e-7, 1.0 + 1e-7]) * alpha * GRAVITY
    assert codes(model, "sine", np.array([2.0 * np.pi / (ratio * p)]), around)[0].tolist() == ([1, 2] if rising else [2, 1])


@pytest.mark.parametrize("linear", [True, False])
def test_two_blocks_of_unlike_size(linear: bool) -> None:
    """Four times the size under the same pulse for twice as long turns as far, impact for impact; under a pulse
    no longer it turns less. Slender blocks of the linear form need not even be similar: omega/p, a/(g alpha) and c_v
    make the response (Dimitrakopoulos and DeJong 2012)."""
    small, large = slender(linear=linear), slender(2.0, 8.0, linear=linear)
    thin = slender(0.3, 2.0, linear=True)

    def run(model: BlockModel, share: float, cycles: float):
        alpha, p = float(model.alpha[0]), float(model.frequency[0])
        amplitude = share * GRAVITY * (alpha if linear else np.tan(alpha))
        ground = sine_pulse(amplitude, cycles / p).ground
        return rocking.history(model.body, ground, 30.0 / p, 0.5 / p)

    for share, cycles in ((1.3, 2.0), (1.8, 2.2), (2.5, 1.4), (1.3, 6.0)):
        one, four = run(small, share, cycles), run(large, share, cycles)
        assert one.outcome == four.outcome and one.impacts == four.impacts
        assert one.peak_ratio == pytest.approx(four.peak_ratio, rel=1e-7)
        points = min(len(one.time), len(four.time))
        assert np.abs(one.rotation[:points] - four.rotation[:points]).max() < 1e-7 * small.alpha[0]
        if linear:
            other = run(thin, share, cycles)
            assert (other.outcome, other.impacts) == (one.outcome, one.impacts)
            assert other.peak_ratio == pytest.approx(one.peak_ratio, rel=1e-7)
    same = sine_pulse(1.3 * GRAVITY * float(np.tan(small.alpha[0])), 2.0 / float(small.frequency[0])).ground
    peaks = [rocking.history(m.body, same, 20.0, 0.1).peak_ratio for m in (small, large)]
    assert abs(peaks[1]) < 0.5 * abs(peaks[0])


def test_what_zhang_and_makris_print() -> None:
    """omega = 5 p, c_v 0.9: 3.02, 6.32 and 7.17 by steps of 0.01, here by roots."""
    found = edges(lambda a: one_sine(a, 5.0), 0.9, np.arange(1.0, 9.0, 0.05))
    assert found == pytest.approx([3.02, 6.32, 7.17], abs=0.01)
