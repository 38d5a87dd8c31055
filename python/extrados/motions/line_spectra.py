"""Fourier spectra by intensity in plain data files: columns mmi, frequency_Hz, amplitude_cm_s."""

import csv
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path

import numpy as np

from extrados.core import motion as core
from extrados.schema.files import BadFile, read

SHIPPED = "boore-worden"
LARGEST = 1_000_000  # bytes
COLUMNS = ("mmi", "frequency_Hz", "amplitude_cm_s")


class SpectrumFileError(ValueError):
    """A spectrum file is wrong; the message holds file and line."""


@dataclass(frozen=True)
class LineSpectrum:
    """Fourier amplitude of the ground acceleration over intensity and frequency.

    intensity (m), frequency (n) [Hz], amplitude (m, n) [m/s]; log-log straight lines in between.
    """

    name: str
    intensity: np.ndarray
    frequency: np.ndarray
    amplitude: np.ndarray

    @property
    def band(self) -> tuple[float, float]:
        """Lowest and highest frequency [Hz]."""
        return float(self.frequency[0]), float(self.frequency[-1])

    def at(self, intensity: float, lines: np.ndarray) -> np.ndarray:
        """Amplitudes [m/s] at lines [Hz]; ValueError beyond the table."""
        (low, high), lines = self.band, np.asarray(lines, dtype=float)
        if not self.intensity[0] <= intensity <= self.intensity[-1]:
            raise ValueError(
                f"intensity {intensity:g} is outside the range of the spectrum '{self.name}': expected {self.intensity[0]:g} to "
                f"{self.intensity[-1]:g}"
            )
        if lines.min() < low * (1.0 - 1e-9) or lines.max() > high * (1.0 + 1e-9):
            raise ValueError(
                f"lines from {lines.min():g} to {lines.max():g} Hz are outside the range of the spectrum '{self.name}': expected "
                f"{low:g} to {high:g} Hz"
            )
        return core.line_spectrum(self.intensity, self.frequency, self.amplitude, intensity, lines)


def load_spectrum(name: str = SHIPPED, folder: Path | None = None) -> LineSpectrum:
    """The shipped spectrum by its name, or one in a CSV file that a deck in `folder` names."""
    if name == SHIPPED:
        return _parse((files("extrados.motions") / "spectra" / f"{SHIPPED}.csv").read_text("utf-8"), name)
    try:
        file = read(name, LARGEST, folder)
        return _parse(file.text(), str(file.path))
    except (BadFile, csv.Error) as error:
        raise SpectrumFileError(f"{error}; expected '{SHIPPED}' or a CSV file with the columns {','.join(COLUMNS)}") from None


def _parse(text: str, name: str) -> LineSpectrum:
    rows: dict[float, dict[float, float]] = {}
    reader = csv.reader(text.splitlines())
    header = tuple(word.strip() for word in next(reader, ()))
    if header != COLUMNS:
        raise SpectrumFileError(f"{name}:1: the header is {','.join(header)[:80]!r}, expected {','.join(COLUMNS)}")
    for row in reader:
        if not row or row[0].lstrip().startswith("#"):
            continue
        try:
            intensity, frequency, amplitude = (float(word) for word in row)
        except ValueError:
            raise SpectrumFileError(f"{name}:{reader.line_num}: expected three numbers, found {','.join(row)[:80]!r}") from None
        if not (0.0 < frequency < 1e4 and 0.0 < amplitude < 1e6 and 0.0 <= intensity <= 12.0):
            raise SpectrumFileError(f"{name}:{reader.line_num}: expected intensity 0 to 12, frequency and amplitude above zero")
        if frequency in rows.setdefault(intensity, {}):
            raise SpectrumFileError(f"{name}:{reader.line_num}: intensity {intensity:g} at {frequency:g} Hz occurs twice")
        rows[intensity][frequency] = amplitude
    grids = {tuple(sorted(row)) for row in rows.values()}
    if len(rows) < 2 or len(grids) != 1 or len(next(iter(grids))) < 2:
        raise SpectrumFileError(f"{name}: expected at least two intensities, all of them at the same frequencies (at least two)")
    intensities, frequencies = sorted(rows), next(iter(grids))
    table = np.array([[rows[i][f] for f in frequencies] for i in intensities]) / 100.0
    return LineSpectrum(name, np.array(intensities), np.array(frequencies), table)
