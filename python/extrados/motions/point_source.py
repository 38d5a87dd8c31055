"""Fourier spectra by intensity from a point source: the documented stand-in for the table behind thesis Fig. 6-5.

The spectrum of Sokolov (2002), used by the thesis, is not available to this project. Here the shape is Boore's
point source (2003, Pure Appl. Geophys. 160:635-676), and for each Mercalli intensity magnitude and distance are
those at which the random-vibration peaks of the spectrum equal the median PGA and PGV of Worden et al. (2012,
BSSA 102:204-221). `python -m extrados.motions.point_source` prints the shipped table.
"""

from dataclasses import dataclass

import numpy as np

INTENSITIES = (4, 5, 6, 7, 8, 9)
LINES = np.geomspace(0.4, 13.0, 15)

_DENSITY, _BETA, _STRESS_DROP, _KAPPA = 2.8, 3.7, 80.0, 0.04  # g/cm^3, km/s, bar, s
#: Generic rock amplification, Boore and Joyner (1997): frequency [Hz], factor
_ROCK = np.array(
    [
        (0.01, 1.00),
        (0.09, 1.10),
        (0.16, 1.18),
        (0.51, 1.42),
        (0.84, 1.58),
        (1.25, 1.74),
        (2.26, 2.06),
        (3.17, 2.25),
        (6.05, 2.58),
        (16.6, 3.13),
        (61.2, 4.00),
    ]
)


def worden_pga(intensity: float) -> float:
    """Median PGA [m/s^2] at a Mercalli intensity, Worden et al. (2012) inverted."""
    slope, offset = (3.70, -1.60) if intensity >= 4.22 else (1.55, 1.78)
    return 10.0 ** ((intensity - offset) / slope) / 100.0


def worden_pgv(intensity: float) -> float:
    """Median PGV [m/s] at a Mercalli intensity, Worden et al. (2012) inverted."""
    slope, offset = (3.16, 2.89) if intensity >= 4.56 else (1.47, 3.78)
    return 10.0 ** ((intensity - offset) / slope) / 100.0


@dataclass(frozen=True)
class PointSource:
    """Moment magnitude and distance [km] of Boore's point source on generic rock."""

    magnitude: float
    distance: float

    @property
    def moment(self) -> float:
        """Seismic moment [dyn cm]."""
        return 10.0 ** (1.5 * self.magnitude + 16.05)

    @property
    def corner(self) -> float:
        """Corner frequency [Hz]."""
        return 4.9e6 * _BETA * (_STRESS_DROP / self.moment) ** (1.0 / 3.0)

    @property
    def duration(self) -> float:
        """Of the strong part [s]: source plus path."""
        return 1.0 / self.corner + 0.05 * self.distance

    def spectrum(self, f: np.ndarray) -> np.ndarray:
        """Fourier amplitude of the acceleration |X(f)| [m/s]; f in Hz."""
        constant = 0.55 * 0.707 * 2.0 / (4.0 * np.pi * _DENSITY * _BETA**3) * 1e-20
        source = 1.0 / (1.0 + (f / self.corner) ** 2)
        r = self.distance
        spreading = 1.0 / r if r <= 40.0 else np.sqrt(40.0 / r) / 40.0
        path = np.exp(-np.pi * f**0.55 * r / (180.0 * _BETA))  # Q = 180 f^0.45
        rock = np.exp(np.interp(np.log(f), np.log(_ROCK[:, 0]), np.log(_ROCK[:, 1])))
        site = rock * np.exp(-np.pi * _KAPPA * f)
        return constant * self.moment * source * spreading * path * site * (2.0 * np.pi * f) ** 2 / 100.0

    def peaks(self) -> tuple[float, float]:
        """Expected PGA [m/s^2] and PGV [m/s] by random vibration (Cartwright and Longuet-Higgins 1956)."""
        f = np.geomspace(0.01, 60.0, 1500)
        x = self.spectrum(f)
        return self._peak(f, x), self._peak(f, x / (2.0 * np.pi * f))

    def _peak(self, f: np.ndarray, x: np.ndarray) -> float:
        m0, m2, m4 = (2.0 * np.trapezoid((2.0 * np.pi * f) ** k * x**2, f) for k in (0, 2, 4))
        crossings = self.duration / np.pi * np.sqrt(m2 / m0)
        extremes = max(2.0, self.duration / np.pi * np.sqrt(m4 / m2))
        share = min(crossings / extremes, 1.0)
        z = np.linspace(0.0, 8.0, 4001)
        factor = np.sqrt(2.0) * np.trapezoid(1.0 - (1.0 - share * np.exp(-(z**2))) ** extremes, z)
        return float(factor * np.sqrt(m0 / self.duration))


def source_of(intensity: float) -> PointSource:
    """The point source whose expected PGA and PGV are the medians of the intensity."""
    from scipy.optimize import fsolve

    target = np.log([worden_pga(intensity), worden_pgv(intensity)])

    def miss(x: np.ndarray) -> np.ndarray:
        return np.log(PointSource(x[0], np.exp(x[1])).peaks()) - target

    x, _, found, message = fsolve(miss, [3.5 + 0.45 * intensity, np.log(200.0 / intensity**1.5)], full_output=True)
    if found != 1:
        raise ArithmeticError(f"no point-source model gives the median values of intensity {intensity:g}: {message}")
    return PointSource(float(x[0]), float(np.exp(x[1])))


def table() -> str:
    """The shipped file: intensity, frequency [Hz], amplitude [cm/s]."""
    rows = ["mmi,frequency_Hz,amplitude_cm_s"]
    for intensity in INTENSITIES:
        values = source_of(intensity).spectrum(LINES) * 100.0
        rows += [f"{intensity},{f:.10g},{a:.6g}" for f, a in zip(LINES, values, strict=True)]
    return "\n".join(rows) + "\n"


if __name__ == "__main__":
    print(table(), end="")
