"""Intensity measures of spectra: Housner intensity, predominant and mean periods, Fourier spectra."""

from dataclasses import dataclass

import numpy as np

from extrados.core import motion as core

HOUSNER_BAND = (0.1, 2.5)  # s
MEAN_PERIOD_BAND = (0.25, 20.0)  # Hz


@dataclass(frozen=True)
class SpectralMeasures:
    """housner_intensity [m] (integral of the 5 % PSV from 0.1 to 2.5 s, Housner 1952), predominant_period [s] (greatest
    5 % PSA), velocity_period [s] (greatest 5 % PSV), mean_period [s] (Rathje et al. 1998)."""

    housner_intensity: float
    predominant_period: float
    velocity_period: float
    mean_period: float


def fourier_spectrum(acceleration: np.ndarray, step: float) -> tuple[np.ndarray, np.ndarray]:
    """Frequencies [Hz] and |X(f)| = |int a exp(-i 2 pi f t) dt| [m/s], padded to a power of two twice as long."""
    length = 1 << int(np.ceil(np.log2(2 * len(acceleration))))
    return np.arange(length // 2 + 1) / (length * step), np.abs(core.fourier(acceleration, length)) * step


def spectral_measures(acceleration: np.ndarray, step: float) -> SpectralMeasures:
    """Measures of one motion (points) [m/s^2]."""
    band = np.linspace(*HOUSNER_BAND, 121)
    wide = np.geomspace(max(0.02, 20.0 * step / 4096.0), 10.0, 241)
    psv = core.response_spectra(acceleration, step, band, [0.05]).psv[0]
    spectra = core.response_spectra(acceleration, step, wide, [0.05])
    frequency, amplitude = fourier_spectrum(acceleration, step)
    inside = (frequency >= MEAN_PERIOD_BAND[0]) & (frequency <= MEAN_PERIOD_BAND[1])
    square = amplitude[inside] ** 2
    return SpectralMeasures(
        float(np.trapezoid(psv, band)),
        float(wide[np.argmax(spectra.psa[0])]),
        float(wide[np.argmax(spectra.psv[0])]),
        float(np.sum(square / frequency[inside]) / max(np.sum(square), 1e-300)),
    )
