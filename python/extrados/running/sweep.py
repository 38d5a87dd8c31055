"""Many runs of one deck with other values of its keys, in memory."""

import copy
import hashlib
import itertools
import json
import math
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from extrados.analyses.batches import Swept, stacked
from extrados.analyses.batches import sweep as in_batches
from extrados.analyses.context import Context, default_threads
from extrados.decks.reader import Deck, DeckError, make_deck
from extrados.objects import as_deck
from extrados.results import checkpoint
from extrados.results.explain import facts
from extrados.results.typed import shapes
from extrados.results.verdict import KindResults
from extrados.running.live import Live
from extrados.running.notebook import table_of
from extrados.running.progress import Progress
from extrados.schema.quantities import unit_of
from extrados.schema.table import Table

if TYPE_CHECKING:
    import pandas
    import xarray

MOST_MEMBERS = 1_000_000  # of a grid: each keeps its values in memory before the first is computed

Tell = Callable[[float, float, str], None]


@dataclass(frozen=True)
class Members:
    """Member k is the deck with the values rows[k] of its keys; its row is a text of all single values that it gave."""

    data: dict[str, Any]
    folder: str
    keys: list[str]
    rows: list[list[Any]]

    def run(self, first: int, count: int, threads: int) -> dict[str, np.ndarray]:
        """The members of a batch, by one model that computes only what changes from one to the next."""
        live = Live(make_deck(copy.deepcopy(self.data), Path(self.folder)), threads)
        return stacked(lambda k: {"row": np.array(json.dumps(self._one(live, k)).encode())}, first, count)

    def _one(self, live: Live, k: int) -> dict[str, Any]:
        try:
            live.update(dict(zip(self.keys, self.rows[k], strict=True)))
        except DeckError as error:  # values that each fit, but not one another
            return {f"{name}.{word}": told for name in live.names for word, told in (("status", "wrong"), ("reason", str(error)))}
        found: dict[str, Any] = {_at(key): value_at(live.deck, live.names, key) for key in self.keys}
        for name in live.names:
            result = live.result(name)
            found |= {f"{name}.status": result.status, f"{name}.reason": result.reason}
            found |= {f"{name}.{key}": value for key, value in singles(result.results).items()}
            if result.verdict is not None:
                found |= {f"{name}.verdict.outcome": result.verdict.outcome, f"{name}.verdict.ratio": result.verdict.ratio}
        return found


def _at(key: str) -> str:
    """Where a row tells the value of a key as the deck took it."""
    return f"@{key}"


def singles(results: KindResults) -> dict[str, Any]:
    """The scalar results by dotted keys; lists are omitted."""

    def walk(values: Mapping[str, Any], before: str) -> dict[str, Any]:
        found: dict[str, Any] = {}
        for key, value in values.items():
            if isinstance(value, dict):
                found |= walk(value, f"{before}{key}.")
            elif not isinstance(value, list):
                found[f"{before}{key}"] = value
        return found

    return walk(results.as_json(), "")


def value_at(deck: Deck, names: Sequence[str], key: str) -> Any:
    """The value of a key in a checked deck, in SI; None if it is not a scalar."""
    holder, last = _holder(deck, names, key)
    value = getattr(holder, last, None) if isinstance(holder, Table) else None
    return value if isinstance(value, str | int | float) else None


def _holder(deck: Deck, names: Sequence[str], key: str) -> tuple[Any, str]:
    """The table that holds a key, and the key within it."""
    first, *way = key.split(".")
    place: Any = None
    if first == "analysis" and way and way[0] in names:
        place, way = deck.analyses[names.index(way[0])], way[1:]
    elif first in ("structure", "motion"):
        place = getattr(deck, first)
    else:
        place = getattr(deck.building, first, None)
    for part in way[:-1]:
        if isinstance(place, list | tuple) and part.isdecimal():
            place = place[int(part)] if int(part) < len(place) else None
        else:
            place = place.get(part) if isinstance(place, dict) else getattr(place, part, None)
    return place, way[-1] if way else ""


@dataclass(frozen=True)
class Sweep:
    """The result of a sweep: `frame()` for pandas, `dataset()` for xarray, `rows` for plain Python.

    keys: the varied keys of the deck, which are also names of columns and axes. shape: number of values of each key if all
    combinations were run, None for given rows. rows: values and results of each member by name, in SI. units and about: of
    the columns, by name. members: number of requested members.
    """

    keys: list[str]
    shape: tuple[int, ...] | None
    rows: list[dict[str, Any]] = field(repr=False)
    units: dict[str, str] = field(repr=False)
    about: dict[str, str] = field(repr=False)
    members: int
    stopped: str = ""

    def __len__(self) -> int:
        return len(self.rows)

    def __repr__(self) -> str:
        over = ", ".join(self.keys)
        told = f"; {self.stopped}" if self.stopped else ""
        return f"<Sweep over {over}: {len(self)} of {self.members} runs, {len(self.columns)} columns{told}>"

    def _repr_html_(self) -> str:
        """In a notebook: the first members, with their verdicts."""
        return table_of(repr(self)[1:-1], self.keys, self.rows, self.units)

    @cached_property
    def columns(self) -> list[str]:
        """All that any member gave, varied keys first."""
        return list(dict.fromkeys([*self.keys, *(name for row in self.rows for name in row)]))

    def column(self, name: str) -> np.ndarray:
        """The values of a column, one per member (members,), in the unit `units[name]`: numbers with NaN for missing values, or
        objects. KeyError names the available columns."""
        if name not in self.columns:
            raise KeyError(f"the sweep has no column '{name}'; its columns are {', '.join(self.columns)}")
        values = [row.get(name) for row in self.rows]
        if all(isinstance(v, bool) for v in values):
            return np.array(values, dtype=bool)
        if all(v is None or (isinstance(v, int | float) and not isinstance(v, bool)) for v in values):
            whole = all(isinstance(v, int) for v in values)
            return np.array([np.nan if v is None else v for v in values], dtype=int if whole else float)
        return np.array([v for v in values] + [None], dtype=object)[:-1]

    def frame(self) -> "pandas.DataFrame":
        """One row per member; `frame.attrs` has units and meanings by column. ImportError names the package to install."""
        pandas = _library("pandas")
        made = pandas.DataFrame({name: self.column(name) for name in self.columns})
        made.attrs = {"units": self.units, "about": self.about}
        return made

    def dataset(self) -> "xarray.Dataset":
        """Results over the varied keys as axes, with units; given rows lie along the axis `member`.

        ImportError names the package to install; ValueError if members are missing, so that the grid is incomplete.
        """
        xarray = _library("xarray")
        dims: tuple[str, ...] = ("member",)
        shape: tuple[int, ...] = (len(self.rows),)
        if self.shape is None:
            coords = {name: (dims, self.column(name), self._told(name)) for name in self.keys}
        elif len(self.rows) < self.members:
            raise ValueError(f"{self.members - len(self.rows)} runs are missing ({self.stopped}), so the grid is incomplete: use frame()")
        else:
            dims, shape = tuple(self.keys), self.shape
            coords = {}
            for axis, name in enumerate(self.keys):
                along = np.moveaxis(self.column(name).reshape(shape), axis, 0).reshape(shape[axis], -1)[:, 0]
                coords[name] = ((name,), along, self._told(name))
        data = {n: (dims, self.column(n).reshape(shape), self._told(n)) for n in self.columns if n not in self.keys}
        return xarray.Dataset(data, coords)

    def _told(self, name: str) -> dict[str, str]:
        return {"units": self.units.get(name, ""), "long_name": self.about.get(name, "")}


def _library(name: str) -> Any:
    import importlib

    try:
        return importlib.import_module(name)
    except ImportError:
        raise ImportError(f"this function needs the package {name}: pip install 'extrados[data]'") from None


def sweep(
    deck: Deck,
    over: Any,
    *,
    workers: int | str = 1,
    threads: int | None = None,
    progress: bool | Tell | None = None,
    resume: str | Path | None = None,
) -> Sweep:
    """See `extrados.sweep`."""
    for name, number in (("workers", workers), ("threads", threads)):
        if isinstance(number, int) and number < 1:
            raise ValueError(f"{name} = {number}: expected 1 or more")
    keys, rows, shape = _members(over)
    _refuse(deck, keys, rows, shape)
    scheduler = workers if isinstance(workers, str) else ""
    count = 1 if isinstance(workers, str) else workers
    each = threads or (1 if count > 1 else default_threads())
    job = Members(deck.data, str(deck.folder), keys, rows)
    bar = Progress(progress is None and not sys.stderr.isatty(), _console, lambda text: print(text, file=sys.stderr))
    tell: Tell = progress if callable(progress) else (lambda done, total, text: None) if progress is False else bar
    out = None if resume is None else Path(resume)
    identity = hashlib.sha256(f"{deck.identity} {keys} {rows}".encode()).hexdigest()
    again = out is not None and (checkpoint.folder_of(out) / checkpoint.HEAD).exists()
    whole = Deck("", "", deck.building, None, [], [], path=deck.path, folder=deck.folder, sha256=identity)
    context = Context(whole, each, tell, out=out, resume=again, scheduler=scheduler)
    try:
        found = in_batches(context, "members", job, len(rows), "members", slow=True, processes=count)
        if out is not None and found.complete:
            checkpoint.discard(out)
    finally:
        bar.stop()
        if out is not None:
            checkpoint.let_go(out)
    return _told(deck, job, shape, found)


def _console() -> Any:
    from rich.console import Console

    return Console(stderr=True)


def _members(over: Any) -> tuple[list[str], list[list[Any]], tuple[int, ...] | None]:
    """Keys, the values of each member, and the shape of their grid: None where rows were given."""
    if hasattr(over, "to_dict") and hasattr(over, "columns"):  # a DataFrame
        over = over.to_dict("records")
    if isinstance(over, Mapping):
        lists = {str(key): values for key, values in over.items() if isinstance(values, Iterable) and not isinstance(values, str)}
        axes = {key: found for key, values in lists.items() if (found := [as_deck(value) for value in values])}
        short = [key for key in over if str(key) not in axes]
        if short or not axes:
            raise DeckError([f"over: {key}: expected a list of values" for key in short] or ["over: expected at least one key"])
        if (count := math.prod(map(len, axes.values()))) > MOST_MEMBERS:
            raise DeckError([f"over: all combinations of the values give {count:,} runs, more than the {MOST_MEMBERS:,} allowed"])
        return list(axes), [list(row) for row in itertools.product(*axes.values())], tuple(map(len, axes.values()))
    given = [dict(row) for row in over]
    if not given or any(set(row) != set(given[0]) or not row for row in given):
        raise DeckError(["over: expected a list of values for each key, or rows that all have the same keys"])
    keys = [str(key) for key in given[0]]
    return keys, [[as_deck(row[key]) for key in given[0]] for row in given], None


def _refuse(deck: Deck, keys: list[str], rows: list[list[Any]], shape: tuple[int, ...] | None) -> None:
    """DeckError for keys that the deck cannot have, and for values of a grid that are wrong by themselves."""
    live = Live(deck, 1)
    wrong: dict[str, None] = {}
    first = dict(zip(keys, rows[0], strict=True))
    tried = (
        [first]
        if shape is None
        else [{**first, key: value} for k, key in enumerate(keys) for value in {repr(row[k]): row[k] for row in rows}.values()]
    )
    for changes in tried:
        try:
            live.update(changes)
        except DeckError as error:
            wrong |= dict.fromkeys(error.complaints)
    if wrong:
        raise DeckError(list(wrong))


def _told(deck: Deck, job: Members, shape: tuple[int, ...] | None, found: Swept) -> Sweep:
    """Rows under the names of their columns, with what is known of each."""
    rows = []
    for member, text in zip(found.members, found["row"] if len(found.members) else (), strict=True):
        row = json.loads(bytes(text))
        values = {}
        for key, given in zip(job.keys, job.rows[member], strict=True):
            taken = row.pop(_at(key), None)
            values[key] = given if taken is None else taken
        rows.append(values | row)
    analyses = Live(deck, 1).names
    units, about = {}, {}
    for key in job.keys:
        holder, at = _holder(deck, analyses, key)
        if isinstance(holder, Table) and at in type(holder).model_fields:
            units[key] = unit_of(type(holder), at)
            about[key] = type(holder).model_fields[at].description or ""
    for analysis, options in zip(analyses, deck.analyses, strict=True):
        for fact in (fact for model in shapes(options.kind) for fact in facts(model)):
            units[f"{analysis}.{fact.key}"], about[f"{analysis}.{fact.key}"] = fact.unit, fact.about
    columns = {name for row in rows for name in row}
    return Sweep(
        job.keys,
        shape,
        rows,
        {n: u for n, u in units.items() if n in columns},
        {n: a for n, a in about.items() if n in columns},
        len(job.rows),
        found.stopped,
    )
