"""Write a run's folder so that a killed run leaves either the old one or the new one, and read it back."""

import contextlib
import csv
import ctypes
import errno
import io
import json
import logging
import os
import secrets
import shutil
import tempfile
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import replace
from functools import cached_property, partial
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import BaseModel, Field, ValidationError

from extrados.results import written
from extrados.results.fields import plain
from extrados.results.model import Array, Result, Streamed, TableData
from extrados.results.typed import typed
from extrados.results.verdict import KindResults, Model, as_model
from extrados.schema import files
from extrados.schema.contained import Unreadable, read_contained
from extrados.schema.text import printable

SUMMARY = "summary.json"
STORE = "results.h5"
CSV_ROWS = 10_000  # turned into text at a time
#: Of arrays so many numbers are written or read at a time; results.h5 of more bytes leaves longer ones on disk
LARGE, SMALL = 100_000, 8_000_000
LONGEST_NAME = 200  # bytes of a folder's name: of the 255 that file systems take some are for what is added to it
LARGEST_SUMMARY = 200_000_000  # bytes: a hundred times those of the longest that was seen
REPORT = "report.html"
#: Axes along which x, y and z stand
AXES = ("axis", "axis3")
#: Reads results.h5, in so much time of the processor [s] where the file is small
READER, SECONDS = "extrados.schema.hdf5", 5
#: What an array says of itself, in the order of Array's fields
MARKS = ("unit", "about", "series")


log = logging.getLogger(__name__)


class StoreError(Exception):
    """Results cannot be written or read; the text names the file and the reason."""


def group_names(kinds: list[str]) -> list[str]:
    """One name per analysis: its kind, numbered from the second of the same kind on."""
    seen: dict[str, int] = {}
    names = []
    for kind in kinds:
        seen[kind] = seen.get(kind, 0) + 1
        names.append(kind if seen[kind] == 1 else f"{kind}-{seen[kind]}")
    return names


def rows(results: list[Result]) -> list[dict[str, Any]]:
    """What summary.json says of each analysis."""
    return [
        plain(
            {
                "name": name,
                "kind": r.kind,
                "status": r.status,
                "reason": r.reason,
                "seconds": round(r.seconds, 6),
                "answer": r.answer,
                "warnings": r.warnings,
                "verdict": r.verdict and r.verdict.as_json(),
                "assumptions": {key: a.as_json() for key, a in r.assumptions.items()},
                "results": r.results.as_json(),
            }
        )
        for name, r in zip(group_names([r.kind for r in results]), results, strict=True)
    ]


def typed_of(results: list[Result]) -> dict[str, KindResults]:
    """The results of each analysis by its name."""
    return dict(zip(group_names([r.kind for r in results]), (r.results for r in results), strict=True))


def arrays_of(results: list[Result]) -> dict[str, dict[str, Array]]:
    """The arrays of each analysis by its name; a reader of the folder finds the same."""
    return {
        name: {title: a if isinstance(a.data, Streamed) else replace(a, data=np.asarray(a.data)) for title, a in r.arrays.items()}
        for name, r in zip(group_names([r.kind for r in results]), results, strict=True)
    }


def prepare(out: Path) -> None:
    """Refuse early, before a long run, what could not be written after it."""
    out = Path(os.path.abspath(out))
    if Path.cwd().is_relative_to(out):
        raise StoreError(f"{out}: this folder contains the current folder. Give a folder for the results only, such as --out results")
    if os.path.ismount(out):
        raise StoreError(f"{out}: this folder is a mounted file system and cannot be replaced. Give a folder inside it with --out")
    if len(os.fsencode(out.name)) > LONGEST_NAME:
        raise StoreError(f"{out}: the name has more than {LONGEST_NAME} bytes. Give a shorter name with --out")
    _refuse_no_folder(out)
    try:
        out.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=out.parent):
            pass
    except OSError as error:
        raise StoreError(f"{out}: cannot write here: {reason(error)}") from None


class NewFolder:
    """A scratch folder that takes the place of `out` when the block ends well.

    What is replaced is what extrados wrote there and nobody has changed since. Where `out` holds anything else the
    results are put beside it, which is told; `place` is where they lie after the block.
    """

    def __init__(self, out: Path):
        self.out = self.place = Path(os.path.abspath(out))

    def __enter__(self) -> Path:
        _refuse_no_folder(self.out)
        try:
            self.out.parent.mkdir(parents=True, exist_ok=True)
            self.scratch = self.out.with_name(f".{self.out.name}.{secrets.token_hex(4)}")
            self.scratch.mkdir()  # with the permissions that the user's umask leaves
        except OSError as error:
            raise StoreError(f"{self.out}: cannot write here: {reason(error)}") from None
        return self.scratch

    def __exit__(self, kind: Any, error: BaseException | None, trace: Any) -> None:
        out, scratch = self.out, self.scratch
        try:
            if error is None:
                self._put()
        except OSError as wrong:
            raise StoreError(f"{out}: the results could not be written: {reason(wrong)}") from None
        finally:
            # what was written here by this process; after an exchange the scratch folder holds what was there before
            if error is not None or not self._done:
                shutil.rmtree(scratch, ignore_errors=True)
        if isinstance(error, StoreError):  # of a file inside the scratch folder: name the place the user knows
            raise StoreError(str(error).replace(str(scratch), str(out))) from None
        if isinstance(error, OSError):
            raise StoreError(f"{out}: the results could not be written: {reason(error)}") from None

    _done = False

    def _put(self) -> None:
        out, scratch = self.out, self.scratch
        written.note(scratch, written.sums_of(scratch))
        for path in sorted(scratch.rglob("*")):
            _sync(path)
        _sync(scratch)
        with written.alone(out.parent):
            strange = written.strange(out) if os.path.lexists(out) else []
            if strange or (os.path.lexists(out) and not written.is_plain_folder(out)):
                self.place = written.beside(out)
                log.warning(
                    "%s: this folder contains '%s', which extrados did not write or which was changed later. The results are in %s",
                    out,
                    strange[0] if strange else out.name,
                    self.place,
                )
            before = _exchange(scratch, self.place)
            self._done = True
            try:
                _sync(out.parent)
            finally:
                if before is not None and not written.remove(before):
                    kept = written.beside(out)  # it came while we looked
                    before.rename(kept)
                    log.warning("%s: files that were added while the results were written are in %s", out, kept)


def _refuse_no_folder(out: Path) -> None:
    if os.path.lexists(out) and not written.is_plain_folder(out):
        raise StoreError(f"{out}: this is not a folder. Give another name with --out")


def reason(error: OSError) -> str:
    """The system's words for an error; h5py wraps them in a page of its own."""
    return os.strerror(error.errno) if error.errno else str(error)


def _sync(path: Path) -> None:
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


def _exchange(scratch: Path, place: Path) -> Path | None:
    """Put `scratch` in its place, in one step where the system can (Linux renameat2); where lies what was there."""
    if not os.path.lexists(place):
        scratch.rename(place)
        return None
    with contextlib.suppress(OSError, AttributeError):
        libc = ctypes.CDLL(None, use_errno=True)
        at_cwd, exchange = -100, 2
        if libc.renameat2(at_cwd, os.fsencode(scratch), at_cwd, os.fsencode(place), exchange) == 0:
            return scratch
    aside = scratch.with_name(f"{scratch.name}.old")
    place.rename(aside)
    scratch.rename(place)
    return aside


def write(folder: Path, head: dict[str, Any], results: list[Result]) -> None:
    """Write summary.json, results.h5, tables and further files of all analyses into `folder`."""
    names = group_names([r.kind for r in results])
    try:
        _write_h5(folder / STORE, names, results)
        for name, result in zip(names, results, strict=True):
            for title, table in result.tables.items():
                suffix = name.removeprefix(result.kind)
                with open(folder / f"{title}{suffix}.csv", "w", encoding="utf-8", newline="") as file:
                    file.writelines(csv_parts(table))
            for title, content in result.files.items():
                # a second analysis of a kind keeps its files in a folder of its own, where they find each other
                target = folder / title if name == result.kind else folder / name / title
                target.parent.mkdir(parents=True, exist_ok=True)
                target.write_bytes(content)
        summary = {**head, "analyses": rows(results), "files": written.sums_of(folder)}
        text = json.dumps(plain(summary), indent=1, ensure_ascii=False)
        # names of files may hold bytes that are no text; what replaces them is JSON for the same
        (folder / SUMMARY).write_text(text + "\n", encoding="utf-8", errors="backslashreplace")
    except OSError as error:
        raise StoreError(f"{folder}: the results could not be written: {reason(error)}") from None


def csv_parts(table: TableData) -> Iterator[str]:
    """A table as CSV, some rows at a time, since the text of many takes more memory than their numbers: the header carries
    the unit after the name; numbers round-trip."""
    for number, piece in enumerate(table.pieces()):
        names = list(piece)
        units = [table.units.get(name, "") for name in names]
        columns = [np.asarray(column) for column in piece.values()]
        if len({len(column) for column in columns}) > 1:
            raise ValueError(f"columns have different lengths: {', '.join(names)}")
        if number == 0:
            yield _lines([[cell(f"{name} [{unit}]" if unit else name) for name, unit in zip(names, units, strict=True)]])
        for first in range(0, len(columns[0]) if columns else 0, CSV_ROWS):
            some = (column[first : first + CSV_ROWS].tolist() for column in columns)
            yield _lines([repr(v) if isinstance(v, float) else cell(v) for v in row] for row in zip(*some, strict=True))


def _lines(rows: Iterable[list[Any]]) -> str:
    out = io.StringIO()
    csv.writer(out, lineterminator="\n").writerows(rows)
    return out.getvalue()


def cell(value: Any) -> Any:
    """Text that a spreadsheet would take for a formula is quoted, and what a terminal would obey is escaped."""
    if not isinstance(value, str):
        return value
    quote = "'" if value.lstrip()[:1] in ("=", "+", "-", "@") else ""
    return quote + printable(value)


def _write_h5(path: Path, names: list[str], results: list[Result]) -> None:
    """One group per analysis; axes that have an array of their name become dimension scales (xarray reads them).

    Built in memory first: HDF5 on a full disk fails again and again while it closes, Python's write fails once. What is
    read from disk goes to disk, where there is room for it.
    """
    import h5py

    streamed = [len(a.data) for r in results for a in r.arrays.values() if isinstance(a.data, Streamed)]
    if streamed and shutil.disk_usage(path.parent).free < 16 * sum(streamed) + 2**26:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
    image = path if streamed else io.BytesIO()
    with h5py.File(image, "w", track_order=True) as file:
        for name, result in zip(names, results, strict=True):
            group = file.create_group(name, track_order=True)
            group.attrs["kind"] = result.kind
            group.attrs["status"] = result.status
            for title, array in result.arrays.items():
                store = _dataset(group, title, array.data)
                store.attrs["unit"] = store.attrs["units"] = array.unit
                store.attrs["about"] = printable(array.about, keep="\n")
                store.attrs["series"] = array.series
                if array.dims == (title,):
                    store.make_scale(title)
            for dim, size in _sizes(result.arrays).items():
                if dim not in group:
                    _dataset(group, dim, _along(dim, size)).make_scale(dim)
            for title, array in result.arrays.items():
                for axis, dim in enumerate(array.dims):
                    if dim != title:
                        group[title].dims[axis].attach_scale(group[dim])
                told = [n for dim in array.dims for n in beside(dim, result.arrays) if n != title]
                if told and title not in beside(array.dims[0], result.arrays):
                    group[title].attrs["coordinates"] = " ".join(told)  # as xarray and CF read them
    if isinstance(image, io.BytesIO):
        path.write_bytes(image.getbuffer())


def _dataset(group: Any, title: str, data: np.ndarray | Streamed) -> Any:
    """An array in a group; text as HDF5 has it, what lies on disk piece by piece."""
    import h5py

    if isinstance(data, Streamed):
        store = group.create_dataset(title, shape=data.shape, dtype=data.dtype)
        at = 0
        for piece in data.pieces():
            store[at : at + len(piece)] = piece
            at += len(piece)
        return store
    data = np.asarray(data)
    if data.dtype.kind in "OU":
        shown = [printable(str(text), keep="\n") for text in data.ravel()]
        data = np.array(shown, dtype=object).reshape(data.shape).astype(h5py.string_dtype())
    return group.create_dataset(title, data=data)


def _along(dim: str, size: int) -> np.ndarray | Streamed:
    """Where an axis has no array of its own: x, y and z along "axis", else numbers from 0."""
    return np.array(list("xyz"[:size]), dtype=object) if dim in AXES and size <= 3 else _numbers(size)


def beside(dim: str, arrays: Mapping[str, Array]) -> list[str]:
    """The arrays that say what stands along an axis: joint_name, joint_x, joint_y beside "joint"."""
    named = (f"{dim}_{word}" for word in ("name", "x", "y", "z"))
    return [name for name in named if name in arrays and arrays[name].dims == (dim,)]


def _numbers(size: int) -> np.ndarray | Streamed:
    """0, 1, 2, ..., along an axis."""
    if size <= LARGE:
        return np.arange(size)
    return Streamed(size, np.arange(1).dtype, lambda: (np.arange(k, min(k + LARGE, size)) for k in range(0, size, LARGE)))


def _sizes(arrays: dict[str, Array]) -> dict[str, int]:
    """The length of every axis."""
    return {dim: size for a in arrays.values() for dim, size in zip(a.dims, np.shape(a.data), strict=True)}


class Stored:
    """What a run gave, as figures and users read it; read back from its folder, or never yet written.

    folder: where it lies, None in memory; head: says what summary.json tells of program and deck; analyses: the rows
    of its analyses; arrays[analysis][name]. typed: the results of each analysis, where they are at hand.
    """

    def __init__(
        self,
        folder: Path | None,
        head: Callable[[], dict[str, Any]],
        analyses: list[dict[str, Any]],
        arrays: dict[str, dict[str, Array]],
        typed: dict[str, KindResults] | None = None,
    ):
        self.folder, self.head, self.analyses, self.arrays = folder, head, analyses, arrays
        self._typed = dict(typed or {})

    def __repr__(self) -> str:
        told = ", ".join(f"{row['name']} {row['status']}" for row in self.analyses)
        return f"<{type(self).__name__}: {told}; {'in memory' if self.folder is None else self.folder}>"

    @cached_property
    def summary(self) -> dict[str, Any]:
        """What summary.json holds (its `files` only for a run that was read back)."""
        return plain({**self.head(), "analyses": self.analyses})

    def __getitem__(self, name: str) -> KindResults:
        """The results of an analysis by its name, for instance run["tilt"].collapse_acceleration_g.

        They read as a mapping too: run["tilt"]["collapse_acceleration_g"]. StoreError where they are not what this
        version gives.
        """
        if name not in self._typed:
            self._typed[name] = self._read(self.analysis(name))
        return self._typed[name]

    def results_of(self, name: str, model: type[Model]) -> Model:
        """The results of an analysis by its name as a model of its kind; TypeError if it gave others."""
        return as_model(self[name], model)

    def analysis(self, name: str) -> dict[str, Any]:
        """All that summary.json says of an analysis by its name: kind, status, reason, answer, verdict, assumptions, results.

        KeyError names those that there are.
        """
        for row in self.analyses:
            if row["name"] == name:
                return row
        raise KeyError(f"{self._place}no analysis has the name '{name}'; the names are: {', '.join(a['name'] for a in self.analyses)}")

    def _read(self, analysis: dict[str, Any]) -> KindResults:
        try:
            return typed(analysis["kind"], analysis["results"])
        except (ValidationError, KeyError) as error:
            first = error.errors()[0] if isinstance(error, ValidationError) else {"loc": [error], "msg": "unknown kind"}
            place = ".".join(str(part) for part in first["loc"])
            raise StoreError(
                f"{self._place}the results of '{analysis['name']}' do not agree with this version of extrados: {place}: {first['msg']}"
            ) from None

    def series(self, analysis: str, name: str) -> list[Array]:
        """The arrays of an analysis that make up the series of a name, in order; none where there is no such series.

        Each says its axes by `dims` and its `unit`.
        """
        return [array for array in self.arrays[analysis].values() if array.series == name]

    def array(self, analysis: str, name: str) -> np.ndarray:
        """The numbers of an array of an analysis by its name; KeyError with the names that there are.

        `run.arrays[analysis][name]` says its axes by `dims`, so that its shape is for instance (time,) or (joint, axis), and
        its `unit`, in SI.
        """
        self.analysis(analysis)
        there = self.arrays[analysis]
        if name not in there:
            raise KeyError(f"{self._place}{analysis} has no array '{name}'; the arrays are: {', '.join(there) or 'none'}")
        return np.asarray(there[name].data)

    def dataset(self, analysis: str) -> Any:
        """The arrays of an analysis as an xarray.Dataset (xarray must be installed), each with its unit, and with the coordinates that its
        group in results.h5 has: an array where one is called as the axis, x, y, z along "axis", else numbers from 0; beside
        "joint" and "block" their names and places."""
        import xarray

        arrays = self.arrays[analysis]
        return xarray.Dataset(
            {n: (a.dims, np.asarray(a.data), {"units": a.unit, "about": a.about}) for n, a in arrays.items()},
            coords={dim: np.asarray(_along(dim, size)) for dim, size in _sizes(arrays).items() if dim not in arrays},
            attrs={"kind": analysis, "extrados": self.summary["extrados"]["version"]},
        ).set_coords([name for dim in _sizes(arrays) for name in beside(dim, arrays)])

    @property
    def _place(self) -> str:
        return "" if self.folder is None else f"{self.folder}: "


class _Assumed(BaseModel):
    """What readers rely on in summary.json; so the following."""

    value: Any
    unit: str
    origin: str = Field(alias="from")
    exceptions: bool


class _Judged(BaseModel):
    demand: float | None
    capacity: float | None
    unit: str
    ratio: float | None
    outcome: str
    statement: str


class _Row(BaseModel):
    name: str
    kind: str
    status: str
    reason: str
    seconds: float
    answer: str
    warnings: list[str]
    verdict: _Judged | None
    assumptions: dict[str, _Assumed]
    results: dict[str, Any]


class _Deck(BaseModel):
    path: Any
    sha256: Any
    resolved: dict[str, Any]


class _Program(BaseModel):
    version: str


class _Summary(BaseModel):
    extrados: _Program
    deck: _Deck
    analyses: list[_Row]
    files: dict[str, str]


def _check_shape(summary: Any) -> None:
    """ValueError where summary.json lacks what readers rely on, as that of another version may."""
    try:
        _Summary.model_validate(summary)
    except ValidationError as error:
        first = error.errors()[0]
        place = ".".join(map(str, first["loc"]))
        raise ValueError(
            f"{SUMMARY} was not written by this version of extrados: {place}: {first['msg'].partition(' or instance')[0].lower()}"
        ) from None


def _on_disk(path: Path, group: str, title: str, length: int, dtype: np.dtype) -> Streamed:
    """An array of results.h5 that is read when it is asked for."""

    def pieces() -> Iterator[np.ndarray]:
        for first in range(0, length, LARGE):
            end = min(first + LARGE, length)
            try:
                rows = read_contained(f"{READER}:parse_rows", path, ["h5py"], group=group, title=title, first=first, end=end)
            except Unreadable as error:
                raise StoreError(f"{path}: cannot be read: {error}") from None
            if rows.shape != (end - first,) or rows.dtype != dtype:
                raise StoreError(f"{path}: the array '{title}' was changed after the folder was read")
            yield rows

    return Streamed(length, dtype, pieces)


def _array(path: Path, group: str, title: str, found: dict[str, Any]) -> Array:
    """An array as `parse_arrays` found it."""
    data = found.get("data")
    if data is None:
        data = _on_disk(path, group, title, int(found["length"]), np.dtype(str(found["dtype"])))
    elif isinstance(data, list):
        data = np.array([str(text) for text in data], dtype=object).reshape(found["shape"])
    dims, marks = (tuple(str(text) for text in found[key]) for key in ("dims", "marks"))
    if len(dims) != data.ndim:
        raise ValueError(f"array '{title}' has {data.ndim} axes, but {len(dims)} axis names were given")
    return Array(data, dims, *marks)


def read(folder: str | Path) -> Stored:
    """Read a run's folder; StoreError where it is damaged. A process of its own reads results.h5, which may be another's."""
    folder = Path(folder)
    place = folder / STORE
    try:
        summary = json.loads(files.read(SUMMARY, LARGEST_SUMMARY, folder).text())
        _check_shape(summary)
        if files.sum_of(STORE, folder) != summary["files"].get(STORE):
            raise StoreError(f"{place}: this file does not agree with its checksum in {SUMMARY}, so it is damaged")
        small = place.stat().st_size <= SMALL
        found = read_contained(
            f"{READER}:parse_arrays",
            files.read(STORE, None, folder).content if small else place.absolute(),
            ["h5py"],
            SECONDS,
            marks=MARKS,
            long=None if small else LARGE,
        )
        arrays = {
            name: {title: _array(place.absolute(), name, title, one) for title, one in group.items()} for name, group in found.items()
        }
        if untold := set(arrays) - {row["name"] for row in summary["analyses"]}:
            raise StoreError(f"{place}: this file contains the array '{min(untold)}', which is not listed in {SUMMARY}")
        head = {key: value for key, value in summary.items() if key != "analyses"}
        return Stored(folder, partial(dict, head), summary["analyses"], arrays)
    except files.BadFile as error:
        raise StoreError(f"{error}; {folder} contains no results of extrados") from None
    except Unreadable as error:
        raise StoreError(f"{place}: {error}") from None
    except (OSError, ValueError, KeyError, TypeError, AttributeError, OverflowError, RecursionError) as error:
        raise StoreError(f"{folder}: the results cannot be read: {error}") from None
