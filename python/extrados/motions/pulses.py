"""Analytic motions, exact in the core: straight lines and sines between breaks."""

import numpy as np

from extrados.core.ground import Ground
from extrados.motions.motion import Motion


def _pieces(breaks: list[float], linear: list, harmonic: list | None = None) -> Ground:
    n = len(breaks) - 1
    return Ground(
        breaks=np.array(breaks, dtype=float),
        linear=np.array(linear, dtype=float).reshape(n, 1, 2),
        harmonic=np.array(harmonic, dtype=float).reshape(n, 1, -1, 4) if harmonic else np.zeros((n, 1, 0, 4)),
    )


def constant(amplitude: float, duration: float) -> Motion:
    """Constant acceleration [m/s^2] from time zero for `duration` [s]."""
    return Motion("constant acceleration", _pieces([0.0, duration], [[amplitude, 0.0]]))


def step_pulse(amplitude: float, duration: float) -> Motion:
    """a_p for t_p, then -a_p/2 for 2 t_p (thesis 5.2.3, after Oppenheim 1992)."""
    return Motion("step pulse", _pieces([0.0, duration, 3.0 * duration], [[amplitude, 0.0], [-0.5 * amplitude, 0.0]]))


def sine_pulse(amplitude: float, period: float) -> Motion:
    """One cycle of a sine (thesis 5.2.3, Fig. 5-7)."""
    return Motion("sine pulse", _pieces([0.0, period], [[0.0, 0.0]], [[[amplitude, 0.0, 2.0 * np.pi / period, 0.0]]]))


def harmonic(
    amplitude: float, frequency: float, duration: float, phase: str = "sine", ramp: float = 0.0, carrier: float | None = None
) -> Motion:
    """amplitude sin(2 pi f t), growing over `ramp` [s] or under a carrier sin(2 pi f_c t) (thesis 5.3.2)."""
    w = 2.0 * np.pi * frequency
    phi = 0.0 if phase == "sine" else 0.5 * np.pi
    if carrier is not None:
        # sin(wc t) sin(w t + phi) as a difference of two cosines
        wc = 2.0 * np.pi * carrier
        half = 0.5 * amplitude
        terms = [[half, 0.0, w - wc, phi + 0.5 * np.pi], [-half, 0.0, w + wc, phi + 0.5 * np.pi]]
        return Motion("harmonic motion", _pieces([0.0, duration], [[0.0, 0.0]], [terms]))
    if ramp > 0.0 and ramp < duration:
        grow = [[0.0, amplitude / ramp, w, phi]]
        hold = [[amplitude, 0.0, w, phi + w * ramp]]
        return Motion("harmonic motion", _pieces([0.0, ramp, duration], [[0.0, 0.0]] * 2, [grow, hold]))
    slope = amplitude / ramp if ramp > 0.0 else 0.0
    start = 0.0 if ramp > 0.0 else amplitude
    return Motion("harmonic motion", _pieces([0.0, duration], [[0.0, 0.0]], [[[start, slope, w, phi]]]))


def pulse(shape: str, amplitude: float, period: float) -> Motion:
    """rectangular (lasting `period`), half-sine (half of it), cosine (all of it) or ricker; amplitude [m/s^2].

    The Ricker wavelet is A (1 - 2 x) exp(-x), x = (pi (t - t0)/T)^2, cut where it is below 1e-7 A, sampled at T/200.
    """
    w = 2.0 * np.pi / period
    if shape == "rectangular":
        return Motion("rectangular pulse", _pieces([0.0, period], [[amplitude, 0.0]]))
    if shape == "half-sine":
        return Motion("half-sine pulse", _pieces([0.0, 0.5 * period], [[0.0, 0.0]], [[[amplitude, 0.0, w, 0.0]]]))
    if shape == "cosine":
        return Motion("cosine pulse", _pieces([0.0, period], [[0.0, 0.0]], [[[amplitude, 0.0, w, 0.5 * np.pi]]]))
    if shape == "ricker":
        step = period / 200.0
        half = 280  # 1.4 periods each way
        x = (np.pi * np.arange(-half, half + 1) * step / period) ** 2
        return Motion("Ricker pulse", Ground(samples=(amplitude * (1.0 - 2.0 * x) * np.exp(-x))[None, :], step=step))
    raise ValueError(f"unknown pulse '{shape}': expected rectangular, half-sine, cosine or ricker")


def velocity_pulse(velocity: float, period: float, cycles: float, phase: float) -> Motion:
    """v = A/2 [1 + cos(w t/g)] cos(w t + nu) over g periods (Mavroeidis and Papageorgiou 2003).

    A [m/s], g = cycles, nu = phase [deg]. Its acceleration is the sum of three sines, exact in the core.
    """
    w, nu = 2.0 * np.pi / period, np.radians(phase)
    half = 0.5 * cycles * period  # t runs from -half to half
    terms = [[-0.5 * velocity * share * v, 0.0, v, nu - v * half] for share, v in ((1.0, w), (0.5, w + w / cycles), (0.5, w - w / cycles))]
    return Motion("velocity pulse", _pieces([0.0, 2.0 * half], [[0.0, 0.0]], [terms]))
