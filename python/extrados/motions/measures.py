"""Intensity measures of spectra: Housner intensity, predominant and mean periods, Fourier spectra."""

from dataclasses import dataclass

import numpy as np

from extrados.core import motion as core

HOUSNER_BAND = (0.1, 2.5)  # s
MEAN_PERIOD_BAND = (0.25, 20.0)  # Hz
BANDWIDTH = 40.0  # b of Konno and Ohmachi's window
WINDOW = 4.0 * np.pi  # of b log10(f/fc): four lobes to either side


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


def konno_ohmachi(frequency: np.ndarray, amplitude: np.ndarray, centre: np.ndarray, bandwidth: float = BANDWIDTH) -> np.ndarray:
    """A Fourier spectrum smoothed at the frequencies `centre` [Hz]: the mean under the window
    (sin(b log10(f/fc)) / (b log10(f/fc)))^4 of Konno and Ohmachi (1998), Bull. Seism. Soc. Am. 88:228-241.

    frequency (n) [Hz], ascending; amplitude (n) of any unit; bandwidth: their b, the greater the less is smoothed.
    """
    known = frequency > 0.0
    f, x = np.log10(frequency[known]), amplitude[known]
    reach = WINDOW / bandwidth  # beyond it the window has no lobe to speak of
    smooth = np.empty(len(centre))
    for k, at in enumerate(np.log10(centre)):
        low, high = np.searchsorted(f, (at - reach, at + reach))
        low, high = min(low, len(f) - 1), max(high, min(low, len(f) - 1) + 1)
        weight = np.sinc(bandwidth * (f[low:high] - at) / np.pi) ** 4
        total = float(weight.sum())
        smooth[k] = weight @ x[low:high] / total if total > 0.0 else x[low]
    return smooth


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
