"""What is done to sampled accelerations: filters, baseline, resampling, scaling. Arrays are (..., points) [m/s^2]."""

import numpy as np

from extrados.core import motion as core
from extrados.schema.constants import GRAVITY

BASELINES = {"none": None, "mean": 0, "linear": 1, "quadratic": 2, "cubic": 3}
_ORDER = 4  # of the Butterworth filter; run forth and back it acts as twice that
MOST_SAMPLES = 5_000_000  # that a filter runs over or that resampling gives, twice those of the longest record


def baseline(acceleration: np.ndarray, step: float, kind: str) -> np.ndarray:
    """Acceleration less a trend of degree 0 to 3, fitted to the velocity so that the least of it is left.

    The trend of the velocity is a polynomial without a constant (the motion starts from rest); its derivative is taken
    off the acceleration.
    """
    degree = BASELINES[kind]
    if degree is None:
        return acceleration
    rows = np.atleast_2d(acceleration)
    t = np.linspace(0.0, 1.0, rows.shape[-1])
    span = step * (rows.shape[-1] - 1)
    powers = np.arange(1, degree + 2)
    basis = t[:, None] ** powers
    out = np.empty_like(rows)
    for k, row in enumerate(rows):
        velocity, _ = core.kinematics(row, step)
        fit = np.linalg.lstsq(basis, velocity, rcond=None)[0]
        out[k] = row - (t[:, None] ** (powers - 1) * powers) @ fit / span
    return out.reshape(acceleration.shape)


def drift(acceleration: np.ndarray, step: float) -> tuple[str, str]:
    """How the ground of a motion (points) [m/s^2] ends where it does not come to rest at its start, and what that means; two
    empty texts where it does."""
    velocity, displacement = core.kinematics(acceleration, step)
    v, d = float(velocity[-1]), float(displacement[-1])
    d = d if abs(d) > 1e-9 * np.abs(displacement).max() else 0.0
    if abs(v) > 0.1 * np.abs(velocity).max():
        mean = v / (step * (len(acceleration) - 1)) / GRAVITY
        return (
            (
                f"at the end of the motion, the ground has a velocity of {v:.3g} m/s and a displacement of {d:.3g} m, "
                f"because the mean acceleration is {mean:.2g} g"
            ),
            ('The mean acceleration acts on a structure as a sustained load. To remove it, give baseline = "quadratic" or `low_cut`.'),
        )
    if abs(d) > 0.5 * np.abs(displacement).max(initial=1e-300):
        return (
            f"at the end of the motion, the ground is displaced by {d:.3g} m from its initial position",
            ("This is a permanent displacement of the ground, or an error of the baseline with little effect on a structure."),
        )
    return "", ""


def at_rest(acceleration: np.ndarray, step: float) -> np.ndarray:
    """Motion (points) less two smooth humps over its whole length, so that velocity and displacement end at zero."""
    x = np.linspace(0.0, 1.0, len(acceleration))
    humps = np.stack([np.sin(np.pi * x) ** 2, np.sin(np.pi * x) ** 2 * (x - 0.5)])
    ends = np.array([[part[-1] for part in core.kinematics(row, step)] for row in (acceleration, *humps)])
    return acceleration - np.linalg.solve(ends[1:].T, ends[0]) @ humps


def band_pass(acceleration: np.ndarray, step: float, low: float | None, high: float | None) -> np.ndarray:
    """Zero-phase Butterworth filter of order 4, run forth and back over zero-padded ends; corners in Hz."""
    nyquist = 0.5 / step
    if (low is not None and not 0.0 < low < nyquist) or (high is not None and not 0.0 < high < nyquist):
        raise ValueError(f"corner frequencies of the filter must lie between 0 and {nyquist:g} Hz (half of the sampling rate)")
    if low is not None and high is not None and low >= high:
        raise ValueError(f"`low_cut` {low:g} Hz is not below `high_cut` {high:g} Hz")
    if low is None and high is None:
        return acceleration
    kind = "band" if low and high else "high" if low else "low"
    corner = [low, high] if low and high else (low or high)
    from scipy import signal  # takes half a second to load

    sections = signal.butter(_ORDER, corner, kind, fs=1.0 / step, output="sos")
    # Long enough for the slowest part to die out (Converse and Brady 1992: 1.5 n / f)
    slowest = low or high or nyquist
    pad = _countable(
        np.ceil(1.5 * _ORDER / slowest / step), f"a filter at {slowest:g} Hz, with its padding before and after the motion, requires"
    )
    ends = [(0, 0)] * (acceleration.ndim - 1) + [(pad, pad)]
    filtered = signal.sosfiltfilt(sections, np.pad(acceleration, ends), axis=-1, padtype=None)
    return filtered[..., pad : pad + acceleration.shape[-1]]


def resample(acceleration: np.ndarray, step: float, new_step: float) -> np.ndarray:
    """The motion at another step: the same straight lines for a finer one, low-passed first for a coarser one."""
    if not new_step > 0.0:
        raise ValueError(f"the time step is {new_step:g} s, expected above zero")
    if new_step > step * (1.0 + 1e-9):
        acceleration = band_pass(acceleration, step, None, 0.4 / new_step)
    points = acceleration.shape[-1]
    old = np.arange(points) * step
    count = _countable(np.floor(old[-1] / new_step * (1.0 + 1e-12)) + 1.0, f"a step of {new_step:g} s for {old[-1]:g} s requires")
    new = np.arange(count) * new_step
    rows = np.atleast_2d(acceleration)
    out = np.stack([np.interp(new, old, row) for row in rows])
    return out.reshape(*acceleration.shape[:-1], len(new))


def _countable(samples: float, what: str) -> int:
    """A number of samples, ValueError where there are more than memory should be taken for."""
    if not samples <= MOST_SAMPLES:
        raise ValueError(f"{what} {samples:.3g} samples, but at most {MOST_SAMPLES:,} are allowed")
    return int(samples)


def factor_to(
    acceleration: np.ndarray,
    step: float,
    *,
    pga: float | None = None,
    pgv: float | None = None,
    arias: float | None = None,
    sa: float | None = None,
    period: float | None = None,
    damping: float = 0.05,
) -> float:
    """The factor that brings a motion (points) to PGA [m/s^2], PGV [m/s], Arias intensity [m/s] or Sa(T) [m/s^2]."""
    wanted = {k: v for k, v in {"pga": pga, "pgv": pgv, "arias": arias, "sa": sa}.items() if v is not None}
    if len(wanted) != 1:
        raise ValueError("expected one of pga, pgv, arias and sa")
    name, target = next(iter(wanted.items()))
    if name == "sa":
        if period is None:
            raise ValueError("sa needs a period")
        have = float(core.response_spectra(acceleration, step, [period], [damping]).psa[0, 0])
    else:
        have = float(getattr(core.measures(acceleration, step), name)[0])
    if not have > 0.0:
        raise ValueError(f"the motion has no {name}, because the motion is zero")
    return float(np.sqrt(target / have)) if name == "arias" else target / have
