"""Recorded accelerograms: PEER AT2 and plain columns, read with suspicion."""

import re
from dataclasses import dataclass, field
from importlib.resources import files
from pathlib import Path

import numpy as np

from extrados.core.rocking import Ground
from extrados.motions.motion import GRAVITY, Motion

LARGEST = 200_000_000  # bytes
STRONGEST = 5.0 * GRAVITY
UNITS = {"g": GRAVITY, "m/s^2": 1.0, "cm/s^2": 0.01, "gal": 0.01, "mm/s^2": 0.001}
SHIPPED = {"el-centro-1940": "el-centro-1940.csv"}

_NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eEdD][+-]?\d{1,3})?\Z", re.ASCII)


class RecordError(ValueError):
    """A record cannot be read; the text begins with file and line."""


@dataclass(frozen=True)
class Record:
    """Samples as in the file [unit of the file] at `step` [s]; unit None where the file has none."""

    name: str
    values: np.ndarray
    step: float | None
    unit: str | None
    notes: list[str] = field(default_factory=list)


def locate(file: str, folder: Path) -> Path:
    """The file a deck means: shipped, absolute as the user wrote it, or inside the deck's folder."""
    if file.startswith("extrados:"):
        name = file.removeprefix("extrados:")
        if name not in SHIPPED:
            raise RecordError(f"{file}: no such shipped record; known are {', '.join(sorted(SHIPPED))}")
        return Path(str(files("extrados.motions").joinpath("library", SHIPPED[name])))
    if "\0" in file:
        raise RecordError(f"{file!r}: a file name cannot hold a zero byte")
    path = Path(file)
    if path.is_absolute():
        return path
    inside = (folder / path).resolve()
    if not inside.is_relative_to(folder.resolve()):
        raise RecordError(f"{file}: leads out of the deck's folder; give an absolute path if you mean it")
    return inside


def read_text(path: Path) -> str:
    """The text of a record; refuses what is no plain text file of a sensible size."""
    try:
        if not path.is_file():
            raise RecordError(f"{path}: " + ("is not a plain file" if path.exists() else "no such file"))
        size = path.stat().st_size
        if size > LARGEST:
            raise RecordError(f"{path}: is {size / 1e6:.0f} MB, a record has at most {LARGEST / 1e6:.0f} MB")
        raw = path.read_bytes()
    except OSError as error:
        raise RecordError(f"{path}: cannot be read: {error.strerror or error}") from None
    if not raw.strip():
        raise RecordError(f"{path}: is empty; expected an accelerogram")
    if raw[:2] in (b"\xff\xfe", b"\xfe\xff"):
        raise RecordError(f"{path}:1: is UTF-16 text; save it as UTF-8 or ASCII")
    if b"\0" in raw[:100_000]:
        raise RecordError(f"{path}: is a binary file; expected text")
    return raw.decode("utf-8-sig", errors="replace")


def _number(token: str, path: Path, line: int) -> float:
    if not _NUMBER.match(token):
        hint = "; the decimal sign is a point" if re.fullmatch(r"[+-]?\d+,\d+", token) else ""
        raise RecordError(f"{path}:{line}: '{token[:30]}' is not a number{hint}")
    value = float(token.replace("d", "e").replace("D", "e"))
    if not np.isfinite(value):
        raise RecordError(f"{path}:{line}: '{token[:30]}' is too large for a number")
    return value


def read_record(path: Path) -> Record:
    """Read an AT2 file or plain columns, told apart by content."""
    text = read_text(path)
    lines = text.splitlines()
    head = "\n".join(lines[:12]).upper()
    if "NPTS" in head or "PEER" in head:
        return _read_at2(path, lines)
    return _read_columns(path, lines)


def _read_at2(path: Path, lines: list[str]) -> Record:
    for at, line in enumerate(lines[:12]):
        if "NPTS" not in line.upper():
            continue
        named = re.search(r"NPTS\s*=\s*(\d+)\s*,?\s*DT\s*=\s*([\d.eE+-]+)", line, re.I)
        bare = re.match(r"\s*(\d+)\s+([\d.eE+-]+)\s+NPTS", line, re.I)
        found = named or bare
        if not found:
            raise RecordError(
                f"{path}:{at + 1}: no number of points and step here; expected 'NPTS= 4000, DT= .0100 SEC'"
            )
        count, step = int(found[1]), _number(found[2].rstrip(","), path, at + 1)
        break
    else:
        raise RecordError(f"{path}: an AT2 file without its NPTS line; expected it in the first 12 lines")
    if not step > 0.0:
        raise RecordError(f"{path}:{at + 1}: the time step is {step:g} s, expected above zero")
    values = [_number(token, path, k + 1) for k in range(at + 1, len(lines)) for token in lines[k].split()]
    notes = []
    if len(values) < count:
        raise RecordError(
            f"{path}:{len(lines)}: ends after {len(values)} of {count} values: the file is cut off or NPTS is wrong"
        )
    if len(values) > count:
        if len(values) - count > max(8, count // 100):
            raise RecordError(f"{path}:{at + 1}: NPTS is {count} but {len(values)} values follow")
        notes.append(f"{path.name}: {len(values)} values where NPTS says {count}; cut to NPTS")
    header = "\n".join(lines[: at + 1]).upper()
    unit = "g" if re.search(r"UNITS?\s+OF\s+G|IN\s+UNITS\s+OF\s+G|ACCELERATION.*\bG\b", header) else None
    return Record(path.stem, np.array(values[:count]), step, unit, notes)


def _read_columns(path: Path, lines: list[str]) -> Record:
    """One column (acceleration) or two (time, acceleration), blanks, commas, semicolons or tabs between."""
    unit, rows, header = None, [], True
    widths: int | None = None
    for number, line in enumerate(lines, start=1):
        bare = line.split("#")[0].strip() if header or not line.lstrip().startswith("#") else ""
        if not bare:
            unit = unit or _unit_in(line)
            continue
        if re.search(r"\d,\d", bare) and "." not in bare and re.match(r"[+-]?\d", bare):
            raise RecordError(f"{path}:{number}: '{bare[:40]}' holds decimal commas; the decimal sign is a point")
        tokens = [t for t in re.split(r"[\s,;]+", bare) if t]
        if header and not _NUMBER.match(tokens[0]) and not re.match(r"[+-]?(nan|inf)", tokens[0], re.I):
            unit = unit or _unit_in(line)
            if number > 60:
                raise RecordError(f"{path}:{number}: '{bare[:40]}': no numbers in the first 60 lines")
            continue
        header = False
        if widths is None:
            widths = len(tokens)
        elif len(tokens) != widths and not (widths > 2 and number == len(lines)):
            raise RecordError(f"{path}:{number}: {len(tokens)} columns where {widths} stood before")
        rows.append((number, [_number(t, path, number) for t in tokens]))
    if not rows:
        raise RecordError(f"{path}: holds no numbers; expected columns of acceleration, or time and acceleration")
    if widths == 2:
        return _two_columns(path, rows, unit)
    values = np.array([v for _, row in rows for v in row])
    return Record(path.stem, values, None, unit)


def _unit_in(line: str) -> str | None:
    low = line.lower()
    for word, unit in (("cm/s", "cm/s^2"), ("gal", "gal"), ("mm/s", "mm/s^2"), ("m/s", "m/s^2")):
        if word in low:
            return unit
    return "g" if re.search(r"[\(\[_,; ]g[\)\]\s,;]*$|\bin g\b", low) else None


def _two_columns(path: Path, rows: list[tuple[int, list[float]]], unit: str | None) -> Record:
    table = np.array([row for _, row in rows])
    if len(table) < 3:
        raise RecordError(f"{path}: only {len(table)} samples; a record has at least three")
    time, values = table.T
    steps = np.diff(time)
    step = float(np.median(steps))
    if not step > 0.0:
        raise RecordError(f"{path}:{rows[1][0]}: the time column does not ascend")
    off = np.abs(steps - step) > 0.02 * step
    if off.any():
        k = int(np.flatnonzero(off)[0])
        raise RecordError(
            f"{path}:{rows[k + 1][0]}: the time step is {steps[k]:g} s here and {step:g} s elsewhere; "
            "resample the record to equal steps"
        )
    step = float((time[-1] - time[0]) / (len(time) - 1))
    return Record(path.stem, values, float(np.round(step, 9)), unit)


def record_motion(
    record: Record,
    *,
    time_step: float | None = None,
    unit: str | None = None,
    scale: float = 1.0,
    time_scale: float = 1.0,
    source: str = "",
) -> Motion:
    """A record as a motion in SI; RecordError where step or unit are unknown or contradict the file."""
    name = source or record.name
    if record.step is not None and time_step is not None and abs(record.step - time_step) > 1e-6 * record.step:
        raise RecordError(
            f"{name}: the file says a step of {record.step:g} s, the deck {time_step:g} s; drop time_step"
        )
    step = record.step if record.step is not None else time_step
    if step is None:
        raise RecordError(f"{name}: the file has no time step; give time_step in [motion]")
    if record.unit is not None and unit is not None and UNITS[record.unit] != UNITS[unit]:
        raise RecordError(f"{name}: the file says '{record.unit}', the deck '{unit}'; drop unit")
    known = record.unit or unit
    if known is None:
        raise RecordError(f'{name}: the file has no unit; give unit = "g", "m/s^2", "cm/s^2" ... in [motion]')
    values = record.values * UNITS[known]
    if len(values) < 3:
        raise RecordError(f"{name}: only {len(values)} samples; a record has at least three")
    if np.abs(values).max() > STRONGEST:
        raise RecordError(
            f"{name}: the peak is {np.abs(values).max() / GRAVITY:.3g} g in '{known}': above 5 g, the unit is probably wrong"
        )
    ground = Ground(samples=(values * scale)[None, :], step=step * time_scale)
    return Motion(record.name, ground, list(record.notes))
