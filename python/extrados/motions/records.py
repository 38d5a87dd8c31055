"""Recorded accelerograms as motions: where files may lie, units and steps resolved, what the deck asks done to them."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from extrados.core.ground import Ground
from extrados.motions import processing
from extrados.motions.directions import rotated
from extrados.motions.formats.columns import Columns
from extrados.motions.formats.recognise import read_record as read_record
from extrados.motions.formats.record import ACCELERATION, MEAN_STEP, QUANTITIES, Record, RecordError
from extrados.motions.formats.record import read_file as read_file
from extrados.motions.motion import Motion
from extrados.schema import files
from extrados.schema.constants import GRAVITY

STRONGEST, WEAKEST = 5.0 * GRAVITY, 1e-4 * GRAVITY  # peaks of records
#: Suffixes that a folder of records may hold beside others
SUFFIXES = {
    ".at2",
    ".vt2",
    ".dt2",
    ".v1",
    ".v2",
    ".v1c",
    ".v2c",
    ".smc",
    ".asc",
    ".ns",
    ".ew",
    ".ud",
    ".ns1",
    ".ns2",
    ".ew1",
    ".ew2",
    ".ud1",
    ".ud2",
    ".acc",
    ".dat",
    ".csv",
    ".txt",
    ".th",
    ".mseed",
    ".sac",
}
MOST_RECORDS = 2000
MOST_WILD = 2  # times that a pattern may say **: each multiplies the folders that are looked into by their depth
LONGEST = 10_800.0  # s: spectra take work by a motion's length over their shortest period, however few its samples


@dataclass(frozen=True)
class Treatment:
    """What is done to a record, in this order: time scale, filter, baseline, resampling, scaling to a measure, scale.

    time_step, unit and columns stand in where the file does not say it. SI; see processing for the rest.
    """

    time_step: float | None = None
    unit: str | None = None
    columns: Columns | None = None
    time_scale: float = 1.0
    low_cut: float | None = None
    high_cut: float | None = None
    baseline: str = "none"
    resample: float | None = None
    pga: float | None = None
    pgv: float | None = None
    arias: float | None = None
    sa: float | None = None
    sa_period: float | None = None
    sa_damping: float = 0.05
    scale: float = 1.0


def locate(file: str, folder: Path) -> Path:
    """The file a deck means; RecordError where it cannot be."""
    try:
        return files.locate(file, folder)
    except files.BadFile as error:
        raise RecordError(str(error)) from None


def list_suite(names: list[str] | None, pattern: str | None, subfolder: str | None, folder: Path) -> list[Path]:
    """The files of a suite, as a deck in `folder` would name them; sorted where it gives a pattern or a folder."""
    root = folder.resolve()
    if names is not None:
        found = [locate(name, folder) for name in names]
    else:
        try:
            found = _matching(pattern, root) if pattern is not None else _records_in(locate(subfolder or ".", folder))
        except OSError as error:  # a name that is too long, a folder that may not be read
            raise RecordError(f"{pattern or subfolder}: this folder cannot be searched: {error.strerror}") from None
    if not found:
        raise RecordError(f"{folder}: no records match {pattern or subfolder or names}")
    if len(found) > MOST_RECORDS:
        raise RecordError(f"{folder}: this folder has {len(found)} records, and a suite can have at most {MOST_RECORDS}")
    # told from the deck's folder on, so that the door asks of each whether it lies within
    return [p.relative_to(root) if p.is_relative_to(root) else p for p in found]


def _matching(pattern: str, root: Path) -> list[Path]:
    """The files below `root` that match, sorted."""
    asked = Path(pattern)
    if asked.is_absolute() or ".." in asked.parts:
        raise RecordError(f"{pattern}: this path leads out of the deck's folder")
    if not asked.parts:  # "." and "./", which Path.glob of Python 3.11 answers by errors of its own
        raise RecordError(f"{pattern}: this pattern names no file")
    if (wild := asked.parts.count("**")) > MOST_WILD:
        raise RecordError(f"{pattern}: this pattern contains ** {wild} times; at most {MOST_WILD} are allowed")
    try:
        return sorted(p for p in root.glob(pattern) if p.is_file())
    except ValueError as error:
        raise RecordError(f"{pattern}: this is not a valid pattern: {error}") from None


def _records_in(folder: Path) -> list[Path]:
    """The files of a folder that have the suffix of a record, sorted."""
    if not folder.is_dir():
        raise RecordError(f"{folder}: no such folder")
    return sorted(p for p in folder.iterdir() if p.is_file() and p.suffix.lower() in SUFFIXES)


def acceleration_of(record: Record, treatment: Treatment, source: str = "") -> tuple[np.ndarray, float, list[str]]:
    """Accelerations (points) [m/s^2] and step [s] before any treatment, units and step resolved."""
    name = source or record.name
    step = treatment.time_step
    notes = list(record.notes)
    if record.step is not None and step is not None and abs(record.step - step) > 1e-6 * record.step:
        # Rounded times tell the step no closer than their rounding spread over the record.
        if abs(record.step - step) * (len(record.values) - 1) > 1.001 * record.rounded:
            raise RecordError(
                f"{name}: the file states a time step of {record.step:g} s, but the deck gives {step:g} s: remove `time_step`"
            )
        notes = [note for note in notes if MEAN_STEP not in note]
        notes.append(f"{record.name}: the `time_step` of the deck is used, because the times of the file are rounded")
    elif record.step is not None:
        step = record.step
    if step is None:
        raise RecordError(f"{name}: the file gives no time step: give `time_step`")
    units = QUANTITIES[record.quantity]
    unit = treatment.unit
    if record.unit is not None and unit is not None and units.get(record.unit) != ACCELERATION.get(unit):
        raise RecordError(f"{name}: the file states the unit '{record.unit}', but the deck gives '{unit}': remove `unit`")
    known = record.unit or unit
    if known is None:
        raise RecordError(f'{name}: the file states no unit, or several: give unit = "g", "m/s^2", "cm/s^2" ...')
    if known not in units:
        raise RecordError(f"{name}: '{known}' is not a unit of {record.quantity}; expected one of {', '.join(units)}")
    values = record.values * units[known]
    if len(values) < 3:
        raise RecordError(f"{name}: the file has only {len(values)} samples; a record has at least three")
    for _ in range({"acceleration": 0, "velocity": 1, "displacement": 2}[record.quantity]):
        values = np.gradient(values, step)
    if record.quantity != "acceleration":
        notes.append(f"{record.name}: differentiated from {record.quantity}")
    if not WEAKEST <= (peak := np.abs(values).max()) <= STRONGEST:
        side = "above 5 g" if peak > STRONGEST else "below 0.0001 g"
        fits = [u for u, size in ACCELERATION.items() if 0.02 <= peak / units[known] * size / GRAVITY <= 2.0]
        hint = f"; with the unit {' or '.join(fits)} the peak would be plausible" if fits and record.quantity == "acceleration" else ""
        raise RecordError(f"{name}: the peak is {peak / GRAVITY:.3g} g with the unit '{known}': {side}. The unit is probably wrong{hint}")
    return values, step, notes


def record_motion(
    record: Record,
    treatment: Treatment | None = None,
    *,
    second: Record | None = None,
    angle: float = 0.0,
    vertical: Record | None = None,
    source: str = "",
) -> Motion:
    """A record and its other components as a motion; RecordError where units or steps are unknown or differ.

    The horizontal acceleration is `rotated` to `angle` [deg] where there is a second component. Measures for scaling
    are those of that acceleration; all components get one factor.
    """
    do = treatment or Treatment()
    name = source or record.name
    rows, step, notes = _together(record, [r for r in (second, vertical) if r is not None], do, name)
    try:
        step *= do.time_scale
        if (lasts := step * (rows.shape[1] - 1)) > LONGEST:
            raise ValueError(f"{rows.shape[1]} samples with a step of {step:g} s last {lasts:g} s; at most {LONGEST:g} s are allowed")
        rows = processing.band_pass(rows, step, do.low_cut, do.high_cut)
        rows = processing.baseline(rows, step, do.baseline)
        if do.resample is not None:
            rows, step = processing.resample(rows, step, do.resample), do.resample
        horizontal = None if second is None else rows[:2]
        if horizontal is not None:
            rows = np.concatenate([rotated(horizontal[0], horizontal[1], angle)[None, :], rows[2:]])
        factor = do.scale
        measures = {"pga": do.pga, "pgv": do.pgv, "arias": do.arias, "sa": do.sa}
        if any(v is not None for v in measures.values()):
            factor *= processing.factor_to(rows[0], step, **measures, period=do.sa_period, damping=do.sa_damping)
    except ValueError as error:
        raise RecordError(f"{name}: {error}") from None
    if rows.shape[1] < 3:
        raise RecordError(f"{name}: resampling leaves only {rows.shape[1]} samples")
    rows = rows * factor
    horizontal = None if horizontal is None else horizontal * factor
    parts = [("", rows[0])] if horizontal is None else [("first component: ", horizontal[0]), ("second component: ", horizontal[1])]
    for which, row in [*parts, *(("vertical component: ", row) for row in rows[1:])]:
        found, meaning = processing.drift(row, step)
        if found:
            notes.append(f"{record.name}: {which}{found}. {meaning}")
    return Motion(
        record.name,
        Ground(samples=rows, step=step),
        notes,
        horizontal,
        angle,
        title=record.title,
        station=" ".join(part for part in (record.station, record.component) if part),
    )


def _together(record: Record, others: list[Record], do: Treatment, name: str) -> tuple[np.ndarray, float, list[str]]:
    """Components (components, points) [m/s^2] of one step [s], cut to the shortest, and notes."""
    values, step, notes = acceleration_of(record, do, name)
    found = [values]
    for other in others:
        # a unit in the deck stands in for all files, a unit in a file for that one
        values, its_step, more = acceleration_of(other, replace(do, unit=None if other.unit else do.unit), other.name)
        if abs(its_step - step) > 1e-9 * step:
            raise RecordError(
                f"{name}: the components have different time steps, {step:g} and {its_step:g} s ({other.name}); expected the same step"
            )
        found.append(values)
        notes += more
    lengths = [len(row) for row in found]
    if min(lengths) < max(lengths):
        shown = ", ".join(map(str, lengths))
        notes.append(f"{name}: the components have {shown} samples; the longer ones are cut to the length of the shortest")
    return np.stack([row[: min(lengths)] for row in found]), step, notes
