"""Records of a suite whose spectra, each times a factor, come closest to a target (Baker and Lee 2018 without the search for a variance)."""

import csv
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from extrados.core.motion import response_spectra
from extrados.motions.code_spectra import Spectrum
from extrados.motions.motion import Motion
from extrados.schema.files import BadFile, read

#: Periods at which spectra are compared, in equal ratios
PERIODS = 40
LARGEST = 20_000_000


@dataclass(frozen=True)
class Chosen:
    """A record of the suite: its number, the factor on its acceleration, and the root mean square of ln(its spectrum / target)."""

    number: int
    factor: float
    misfit: float


def spectrum_of(motion: Motion, periods: np.ndarray, damping: float) -> np.ndarray:
    """Pseudo-acceleration of the horizontal motion (periods) [m/s^2]."""
    time, values = motion.series()
    return np.asarray(response_spectra(values[None, :], float(time[1] - time[0]), periods.tolist(), [damping]).psa).reshape(len(periods))


def choose(
    spectra: list[np.ndarray | None], periods: np.ndarray, target: Spectrum, count: int, factors: tuple[float, float], at: float | None
) -> list[Chosen]:
    """The `count` records closest to the target, best first; fewer where some have no spectrum (None).

    The factor minimises the misfit within its bounds; at: period [s] at which it meets the target instead.
    """
    wanted = np.log(target(periods))
    found = []
    for number, psa in enumerate(spectra):
        if psa is None or not (psa > 0.0).all():
            continue
        apart = wanted - np.log(psa)
        best = apart.mean() if at is None else np.interp(np.log(at), np.log(periods), apart)
        factor = float(np.clip(np.exp(best), *factors))
        found.append(Chosen(number, factor, float(np.sqrt(np.mean((apart - np.log(factor)) ** 2)))))
    return sorted(found, key=lambda one: (one.misfit, one.number))[:count]


def within(name: str, limits: dict[str, list[float]], folder: Path) -> set[str]:
    """Names of the files (without their folder) whose values in a CSV table lie within limits; its columns: `file`, and those of the
    limits. ValueError with file and line where the table is wrong."""
    try:
        file = read(name, LARGEST, folder)
        rows = csv.DictReader(file.text().splitlines())
        missing = sorted({"file", *limits} - set(rows.fieldnames or ()))
        if missing:
            raise ValueError(f"{file.path}:1: column {missing[0]!r} is missing")
        found = set()
        for row in rows:
            try:
                inside = all(low <= float(row[key]) <= high for key, (low, high) in limits.items())
            except (TypeError, ValueError):
                raise ValueError(f"{file.path}:{rows.line_num}: expected numbers in {', '.join(limits)}") from None
            if inside:
                found.add(Path(str(row["file"])).name)
        return found
    except (BadFile, csv.Error) as error:
        raise ValueError(f"{error}; expected a CSV table with a column `file`") from None
