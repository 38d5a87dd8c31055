"""Elastic response spectra of codes: pseudo-acceleration [m/s^2] over period [s]."""

import csv
from collections.abc import Callable
from pathlib import Path

import numpy as np

from extrados.schema.constants import GRAVITY
from extrados.schema.files import BadFile, read

LARGEST = 1_000_000  # bytes

Spectrum = Callable[[np.ndarray], np.ndarray]

#: EN 1998-1:2004 Tables 3.2 and 3.3: S, T_B, T_C, T_D
EN1998 = {
    1: {
        "A": (1.0, 0.15, 0.4, 2.0),
        "B": (1.2, 0.15, 0.5, 2.0),
        "C": (1.15, 0.20, 0.6, 2.0),
        "D": (1.35, 0.20, 0.8, 2.0),
        "E": (1.4, 0.15, 0.5, 2.0),
    },
    2: {
        "A": (1.0, 0.05, 0.25, 1.2),
        "B": (1.35, 0.05, 0.25, 1.2),
        "C": (1.5, 0.10, 0.25, 1.2),
        "D": (1.8, 0.10, 0.30, 1.2),
        "E": (1.6, 0.05, 0.25, 1.2),
    },
}

#: NTC 2018 Table 3.2.IV: S_S = a - b F_0 a_g/g between bounds; C_C = c T_C*^e
_NTC = {
    "A": (1.0, 0.0, 1.0, 1.0, 1.0, 0.0),
    "B": (1.40, 0.40, 1.00, 1.20, 1.10, -0.20),
    "C": (1.70, 0.60, 1.00, 1.50, 1.05, -0.33),
    "D": (2.40, 1.50, 0.90, 1.80, 1.25, -0.50),
    "E": (2.00, 1.10, 1.00, 1.60, 1.15, -0.40),
}


def damping_factor(damping: float) -> float:
    """eta = sqrt(10 / (5 + xi)), not below 0.55; damping as a ratio (EN 1998-1 Eq. 3.6)."""
    return max(float(np.sqrt(10.0 / (5.0 + 100.0 * damping))), 0.55)


def _four_branches(peak: float, start: float, tb: float, tc: float, td: float) -> Spectrum:
    """start at T = 0, straight to the plateau at T_B, constant velocity from T_C, constant displacement from T_D."""

    def at(period: np.ndarray) -> np.ndarray:
        t = np.asarray(period, dtype=float)
        late = np.maximum(t, 1e-12)
        return np.select(
            [t < tb, t <= tc, t <= td], [start + (peak - start) * t / tb, np.full_like(t, peak), peak * tc / late], peak * tc * td / late**2
        )

    return at


def en1998(kind: int, ground: str, acceleration: float, damping: float = 0.05) -> Spectrum:
    """EN 1998-1:2004 Eqs 3.2 to 3.5, recommended values; acceleration a_g on ground A [m/s^2]."""
    soil, tb, tc, td = EN1998[kind][ground]
    return _four_branches(2.5 * damping_factor(damping) * acceleration * soil, acceleration * soil, tb, tc, td)


def ntc(ground: str, acceleration: float, f0: float, corner: float, topography: float = 1.0, damping: float = 0.05) -> Spectrum:
    """NTC 2018 Eqs 3.2.2 to 3.2.7; acceleration a_g [m/s^2], f0 F_0, corner T_C* [s], topography S_T."""
    a, b, low, high, c, e = _NTC[ground]
    soil = min(max(a - b * f0 * acceleration / GRAVITY, low), high) * topography
    tc = c * corner**e * corner
    td = 4.0 * acceleration / GRAVITY + 1.6
    return _four_branches(damping_factor(damping) * f0 * acceleration * soil, acceleration * soil, tc / 3.0, tc, td)


def asce7(sds: float, sd1: float, long_period: float) -> Spectrum:
    """ASCE 7-16 11.4.6, 5 % damping; sds, sd1 [m/s^2], long_period T_L [s]."""
    ts = sd1 / sds
    return _four_branches(sds, 0.4 * sds, 0.2 * ts, ts, long_period)


#: NZS 1170.5 Table 3.1, shape C_h(T) with the values for periods from 0: C_h(0), plateau, its end [s], factor and corner period
#: of the branch to 1.5 s, factor of 1/T to 3 s
_NZS = {
    "A": (1.0, 2.35, 0.3, 1.6, 0.5, 1.05),
    "B": (1.0, 2.35, 0.3, 1.6, 0.5, 1.05),
    "C": (1.33, 2.93, 0.3, 2.0, 0.5, 1.32),
    "D": (1.12, 3.0, 0.56, 2.4, 0.75, 2.14),
    "E": (1.12, 3.0, 1.0, 3.0, 1.0, 3.32),
}


def nzs1170(ground: str, hazard: float, return_factor: float, damping: float = 0.05) -> Spectrum:
    """NZS 1170.5 3.1: C(T) = C_h(T) Z R without near-fault factor, as a public implementation gives Table 3.1.

    Damping other than 5 %: sqrt(7/(2 + xi)), xi in percent, of the New Zealand guidelines; the ground at T = 0 has none.
    """
    zero, plateau, end, factor, corner, late = _NZS[ground]
    reduced = float(np.sqrt(7.0 / (2.0 + 100.0 * damping)))

    def at(period: np.ndarray) -> np.ndarray:
        t = np.asarray(period, dtype=float)
        x = np.maximum(t, 1e-12)
        high = reduced * np.select(
            [t < end, t <= 1.5, t <= 3.0],
            [np.full_like(x, plateau), np.minimum(factor * (corner / x) ** 0.75, plateau), late / x],
            3.0 * late / x**2,
        )
        low = zero + (reduced * plateau - zero) * t / 0.1
        return np.where(t < 0.1, low, high) * hazard * return_factor * GRAVITY

    return at


def tabulated(period: np.ndarray, acceleration: np.ndarray) -> Spectrum:
    """Straight lines between points of a table; constant below the first period, refused above the last."""

    def at(t: np.ndarray) -> np.ndarray:
        if np.max(t) > period[-1] * (1.0 + 1e-9):
            raise ValueError(f"the table of the spectrum ends at {period[-1]:g} s, but a period of {np.max(t):g} s is required")
        return np.interp(t, period, acceleration)

    return at


def read_table(name: str | Path, folder: Path | None = None) -> Spectrum:
    """A CSV file period_s,sa_g that a deck in `folder` names, other columns beside them; ValueError with file and line."""
    period, value = _columns(name, folder, ("period_s", "sa_g")).T
    return tabulated(period, value * GRAVITY)


def conditional_mean(name: str | Path, folder: Path | None, at: float, acceleration: float) -> Spectrum:
    """The mean of the logarithms of spectra whose acceleration at a period [s] is given [m/s^2] (Baker 2011).

    ln SA(T) = ln median + rho(T, at) epsilon sigma, epsilon the number of standard deviations by which the acceleration given exceeds the
    median at that period; medians and standard deviations from a CSV file period_s,sa_g,sigma_ln.
    """
    period, median, sigma = _columns(name, folder, ("period_s", "sa_g", "sigma_ln")).T
    if not period[0] <= at <= period[-1]:
        raise ValueError(
            f"`conditional_period` {at:g} s is outside the table of the spectrum, which covers {period[0]:g} to {period[-1]:g} s"
        )
    low, high = max(period[0], 0.01), min(period[-1], 10.0)
    t = np.unique(np.concatenate([period[(period >= low) & (period <= high)], [low, at, high]]))
    middle, spread = np.exp(np.interp(t, period, np.log(median))), np.interp(t, period, sigma)
    k = int(np.searchsorted(t, at))
    epsilon = np.log(acceleration / GRAVITY / middle[k]) / spread[k]
    return tabulated(t, middle * np.exp(correlation(t, at) * epsilon * spread) * GRAVITY)


def correlation(period: np.ndarray, at: float) -> np.ndarray:
    """Correlation of the logarithms of spectral accelerations at periods and at another, .01 to 10 s (Baker and Jayaram 2008)."""
    low, high = np.minimum(period, at), np.maximum(period, at)
    c1 = 1.0 - np.cos(0.5 * np.pi - 0.366 * np.log(high / np.maximum(low, 0.109)))
    short = np.minimum(high, 0.2)
    c2 = np.where(high < 0.2, 1.0 - 0.105 * (1.0 - 1.0 / (1.0 + np.exp(100.0 * short - 5.0))) * (high - low) / (high - 0.0099), 0.0)
    c3 = np.where(high < 0.109, c2, c1)
    c4 = c1 + 0.5 * (np.sqrt(c3) - c3) * (1.0 + np.cos(np.pi * low / 0.109))
    return np.select([high < 0.109, low > 0.109, high < 0.2], [c2, c1, np.minimum(c2, c4)], c4)


def _columns(name: str | Path, folder: Path | None, names: tuple[str, ...]) -> np.ndarray:
    """Columns of a CSV file by their names (rows, columns); ValueError with file and line."""
    try:
        file = read(name, LARGEST, folder)
        return _parse(file.path, file.text(), names)
    except (BadFile, csv.Error) as error:
        raise ValueError(f"{error}; expected a CSV file with the columns {','.join(names)}") from None


def _parse(path: Path, text: str, names: tuple[str, ...]) -> np.ndarray:
    reader = csv.reader(text.splitlines())
    header = [word.strip() for word in next(reader, [])]
    if tuple(header[: len(names)]) != names:
        raise ValueError(f"{path}:1: the header is {','.join(header)[:60]!r}, expected {','.join(names)}")
    rows: list[list[float]] = []
    for row in reader:
        if not row:
            continue
        try:
            period, *values = (float(word) for word in row[: len(names)])
        except ValueError:
            raise ValueError(f"{path}:{reader.line_num}: expected {len(names)} numbers, found {','.join(row)[:60]!r}") from None
        good = len(values) == len(names) - 1 and all(0.0 < v < 100.0 for v in values)
        if not (good and 0.0 <= period < 100.0) or (rows and period <= rows[-1][0]):
            raise ValueError(f"{path}:{reader.line_num}: the periods must increase, and the accelerations must be above zero")
        rows.append([period, *values])
    if len(rows) < 2:
        raise ValueError(f"{path}: expected at least two rows of numbers")
    return np.array(rows)
