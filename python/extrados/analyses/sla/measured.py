"""A measured curve beside the computed one: read from a file, compared at the peak and along the tail."""

import csv
from dataclasses import dataclass

import numpy as np

from extrados.analyses.context import Context, Refused
from extrados.results import sla as out
from extrados.results.model import Array
from extrados.schema import files

KEY = ("analysis", "measured")  # of the deck
LARGEST = 10_000_000  # bytes
LENGTHS = {"m": 1.0, "mm": 1e-3}
FORCES = {"N": 1.0, "kN": 1e3}
#: Parts of the measured peak at which the tail is compared
TAIL = (0.75, 0.5, 0.25)


@dataclass(frozen=True)
class Measured:
    """Displacements [m], rising, with the least and the greatest load measured there [N]."""

    displacement: np.ndarray
    least: np.ndarray
    greatest: np.ndarray

    @property
    def mean(self) -> np.ndarray:
        """Mean of the least and the greatest load (points) [N]."""
        return 0.5 * (self.least + self.greatest)


def read_measured(context: Context, file: str) -> Measured:
    """The columns `displacement (mm)`, `least (N)`, `greatest (N)` of a CSV, or `load (N)` for a single curve; lines that
    begin with # say where it is from. Refused where it is something else."""
    try:
        text = files.read(file, LARGEST, context.deck.folder).text()
    except files.BadFile as error:
        raise Refused(str(error), KEY) from None
    lines = [(k, line) for k, line in enumerate(text.splitlines(), 1) if line.strip() and not line.startswith("#")]
    if len(lines) < 3:
        raise Refused(f"{file}: expected a line of column names and at least two lines of numbers", KEY)
    try:
        rows = [next(csv.reader([line])) for _, line in lines]
    except csv.Error as error:
        raise Refused(f"{file}: is no CSV: {error}", KEY) from None
    names, scales = zip(*(_column(file, title) for title in rows[0]), strict=True)
    wanted = ("displacement", "load") if "load" in names else ("displacement", "least", "greatest")
    if sorted(names) != sorted(wanted):
        raise Refused(
            f"{file}: the columns are {', '.join(names)}; expected displacement with load, or displacement with least and greatest", KEY
        )
    values = np.empty((len(rows) - 1, len(names)))
    for k, row in enumerate(rows[1:]):
        try:
            values[k] = [float(cell) for cell in row]
        except ValueError:
            raise Refused(f"{file}:{lines[k + 1][0]}: expected {len(names)} numbers, found {','.join(row)[:60]!r}", KEY) from None
    if not np.isfinite(values).all():
        raise Refused(f"{file}: this file contains a number that is not finite", KEY)
    columns = dict(zip(names, (values * scales).T, strict=True))
    displacement = columns["displacement"]
    if not (np.diff(displacement) > 0.0).all():
        raise Refused(f"{file}: the displacements must increase from line to line", KEY)
    least, greatest = (columns.get(name, columns.get("load")) for name in ("least", "greatest"))
    assert least is not None and greatest is not None  # the head of the file has them
    if (least > greatest).any():
        raise Refused(f"{file}: there is a line in which `least` exceeds `greatest`", KEY)
    return Measured(displacement, least, greatest)


def _column(file: str, title: str) -> tuple[str, float]:
    """Name and scale of "name (unit)"."""
    name, _, unit = title.strip().rstrip(")").partition(" (")
    units = LENGTHS if name == "displacement" else FORCES
    if unit not in units:
        raise Refused(f"{file}: column '{title.strip()}': expected a unit, as in '{name} ({next(iter(units))})'", KEY)
    return name, units[unit]


def compare(measured: Measured, displacement: np.ndarray, load: np.ndarray) -> out.Comparison:
    """The envelope of a run over the mean of the tests: at the peak, and where the tests have fallen to parts of theirs."""
    mean, top = measured.mean, int(measured.mean.argmax())
    fall = slice(top, None)
    at = [
        float(np.interp(-part * mean[top], -np.minimum.accumulate(mean[fall]), measured.displacement[fall]))
        if mean[fall].min() <= part * mean[top]
        else None
        for part in TAIL
    ]
    ratios = [
        float(np.interp(d, displacement, load) / np.interp(d, measured.displacement, mean))
        if d is not None and d <= displacement[-1]
        else None
        for d in at
    ]
    known = (measured.displacement <= displacement[-1]) & (measured.displacement >= displacement[0])
    there = np.interp(measured.displacement[known], displacement, load)
    inside = (there >= measured.least[known]) & (there <= measured.greatest[known])
    spread = float(np.mean((measured.greatest - measured.least)[known] / (2.0 * mean[known]))) if known.any() else 0.0
    return out.Comparison(
        peak_ratio=float(load.max() / mean[top]),
        tail_ratios=ratios,
        inside_ratio=float(inside.mean()) if known.any() else None,
        half_band_ratio=spread,
    )


def arrays(measured: Measured) -> dict[str, Array]:
    """The measured curve, for the figure."""
    dim = ("measured",)
    return {
        "measured_displacement": Array(measured.displacement, dim, "m", "measured displacement"),
        "measured_least": Array(measured.least, dim, "N", "least measured load"),
        "measured_greatest": Array(measured.greatest, dim, "N", "greatest measured load"),
    }
