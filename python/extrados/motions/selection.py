"""Records of a suite whose spectra, each times a factor, come closest to a target (Baker and Lee 2018 without the search for a variance)."""

import csv
import os.path
from collections.abc import Sequence
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
    """A record of the suite: its number, the factor on its acceleration, that before its bounds, and the root mean square of
    ln(its spectrum / target)."""

    number: int
    factor: float
    unbounded: float
    misfit: float


def spectrum_of(motion: Motion, periods: np.ndarray, damping: float) -> np.ndarray:
    """Pseudo-acceleration of the horizontal motion (periods) [m/s^2]."""
    time, values = motion.series()
    return np.asarray(response_spectra(values[None, :], float(time[1] - time[0]), periods.tolist(), [damping]).psa).reshape(len(periods))


def choose(
    spectra: list[np.ndarray | None], periods: np.ndarray, target: Spectrum, count: int, factors: tuple[float, float], anchored: bool
) -> list[Chosen]:
    """The `count` records closest to the target, best first; fewer if some have no spectrum (None).

    The factor minimises the misfit within its bounds. anchored: the spectrum meets the target at the last period instead, which the
    misfit then does not count.
    """
    wanted = np.log(target(periods))
    compared = slice(None, -1 if anchored else None)
    found = []
    for number, psa in enumerate(spectra):
        if psa is None or not (psa > 0.0).all():
            continue
        apart = wanted - np.log(psa)
        best = float(np.exp(apart[-1] if anchored else apart.mean()))
        factor = float(np.clip(best, *factors))
        found.append(Chosen(number, factor, best, float(np.sqrt(np.mean((apart[compared] - np.log(factor)) ** 2)))))
    return sorted(found, key=lambda one: (one.misfit, one.number))[:count]


@dataclass(frozen=True)
class Row:
    """A row of a flatfile: its line, the normalised path of its record, and whether its values lie within the limits."""

    line: int
    path: str
    inside: bool


def within(name: str, limits: dict[str, list[float]], folder: Path, files: Sequence[str]) -> tuple[set[str], set[str]]:
    """The files of a suite whose values in a CSV table lie within limits, and those that the table does not list.

    The table has the columns `file` and those of the limits. A row belongs to the file of the same path, seen from the deck's folder, or
    else to the only file of the same base name. ValueError with file and line if the table is wrong or a row is ambiguous.
    """
    try:
        file = read(name, LARGEST, folder)
        rows = csv.DictReader(file.text().splitlines())
        missing = sorted({"file", *limits} - set(rows.fieldnames or ()))
        if missing:
            raise ValueError(f"{file.path}:1: column {missing[0]!r} is missing")
        listed = []
        for row in rows:
            try:
                inside = all(low <= float(row[key]) <= high for key, (low, high) in limits.items())
            except (TypeError, ValueError):
                raise ValueError(f"{file.path}:{rows.line_num}: expected numbers in {', '.join(limits)}") from None
            listed.append(Row(rows.line_num, _seen_from(folder, str(row["file"])), inside))
    except (BadFile, csv.Error) as error:
        raise ValueError(f"{error}; expected a CSV table with a column `file`") from None
    found = _rows_of({one: _seen_from(folder, one) for one in files}, listed, str(file.path))
    return {one for one, row in found.items() if row.inside}, set(files) - set(found)


def _seen_from(folder: Path, name: str) -> str:
    """A path relative to the deck's folder, normalised; one outside the folder remains absolute."""
    path, root = Path(name), folder.resolve()
    return os.path.normpath(path.relative_to(root) if path.is_relative_to(root) else path)


def _rows_of(paths: dict[str, str], rows: list[Row], table: str) -> dict[str, Row]:
    """The row of each file that the table lists; ValueError if two rows or two files fit."""
    known = set(paths.values())
    exact = {row.path for row in rows} & known
    by_path: dict[str, list[Row]] = {}
    by_name: dict[str, list[Row]] = {}
    for row in rows:
        by_path.setdefault(row.path, []).append(row)
        if row.path not in exact:
            by_name.setdefault(Path(row.path).name, []).append(row)
    same_name: dict[str, list[str]] = {}
    for path in sorted(known - exact):
        same_name.setdefault(Path(path).name, []).append(path)
    found = {}
    for file, path in paths.items():
        base = Path(path).name
        fit = by_path[path] if path in exact else by_name.get(base, [])
        if len(fit) > 1:
            raise ValueError(f"{table}:{fit[1].line}: {fit[0].path} (line {fit[0].line}) and {fit[1].path} both match the record {path}")
        rivals = [path] if path in exact else same_name[base]
        if fit and len(rivals) > 1:
            raise ValueError(
                f"{table}:{fit[0].line}: {fit[0].path} matches the records {rivals[0]} and {rivals[1]}. In the column `file`, "
                "write paths that begin in the folder of the deck"
            )
        if fit:
            found[file] = fit[0]
    return found
