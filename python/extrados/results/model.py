"""What an analysis returns."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from extrados.results.assumptions import Assumption
from extrados.results.verdict import KindResults, Model, Verdict, as_model


class Streamed:
    """Numbers along one axis that lie on disk: `pieces()` reads them in order, in arrays that fit into memory.

    numpy functions and indices read them whole.
    """

    ndim = 1

    def __init__(self, length: int, dtype: np.dtype, pieces: Callable[[], Iterator[np.ndarray]]):
        self.shape, self.dtype, self.pieces = (length,), np.dtype(dtype), pieces

    def __len__(self) -> int:
        return self.shape[0]

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> np.ndarray:
        whole = np.empty(self.shape, self.dtype)
        at = 0
        for piece in self.pieces():
            whole[at : at + len(piece)] = piece
            at += len(piece)
        return whole if dtype is None else whole.astype(dtype)

    def __getitem__(self, index: Any) -> Any:
        return np.asarray(self)[index]

    def __reduce__(self) -> tuple[Any, ...]:
        """A pickle holds the numbers themselves: its reader may be on another machine."""
        return np.asarray, (np.asarray(self),)


@dataclass(frozen=True)
class Array:
    """A named, dimensioned array; `dims` names its axes, `unit` in SI ("" where it has none).

    series: what arrays of one kind are called together where there are several, in their order.
    """

    data: np.ndarray | Streamed
    dims: tuple[str, ...]
    unit: str = ""
    about: str = ""
    series: str = ""

    @property
    def numbers(self) -> np.ndarray:
        """The numbers, read whole where they lie on disk."""
        return np.asarray(self.data)

    def __repr__(self) -> str:
        axes = ", ".join(f"{name} {size}" for name, size in zip(self.dims, self.data.shape, strict=False))
        return f"<Array ({axes}){f' [{self.unit}]' if self.unit else ''}>"


@dataclass(frozen=True)
class TableData:
    """Columns of equal length with their units, written as NAME.csv."""

    columns: Mapping[str, np.ndarray | list]
    units: dict[str, str] = field(default_factory=dict)

    def pieces(self) -> Iterator[Mapping[str, np.ndarray | list]]:
        """The columns, some rows after the other."""
        yield self.columns


class StreamedTable(TableData):
    """A table whose rows lie on disk: `make()` gives its columns piece by piece, in the same order each time."""

    def __init__(self, make: Callable[[], Iterator[dict[str, Any]]], units: dict[str, str]):
        super().__init__({}, units)
        object.__setattr__(self, "pieces", make)

    def __reduce__(self) -> tuple[Any, ...]:
        """A pickle holds the rows themselves: its reader may be on another machine."""
        pieces = list(self.pieces())
        return TableData, ({name: np.concatenate([p[name] for p in pieces]) for name in pieces[0]}, self.units)


@dataclass
class Result:
    """The outcome of one analysis.

    status: ok, refused (the structure or the question does not allow it), failed (the computation did
    not succeed) or interrupted (partial results are kept); `reason` says why. `answer` is the result in
    words an engineer reads. `results` holds numbers and words whose keys end in their unit, in the typed model of the
    kind; it is empty where there is no result. `verdict` concludes; `assumptions` are the properties of the building
    that it rests on, by their keys. `files` maps the name of a further file (VTU, PVD, AT2, MP4) to its bytes. `parts`
    are analyses that this one has asked for itself: a run tells them after those of the deck; `asked` is the table of such a
    part with all its defaults.
    """

    kind: str
    status: str = "ok"
    reason: str = ""
    seconds: float = 0.0
    answer: str = ""
    results: KindResults = field(default_factory=KindResults)
    verdict: Verdict | None = None
    assumptions: dict[str, Assumption] = field(default_factory=dict)
    arrays: dict[str, Array] = field(default_factory=dict)
    tables: dict[str, TableData] = field(default_factory=dict)
    files: dict[str, bytes] = field(default_factory=dict)
    warnings: list[str] = field(default_factory=list)
    parts: list["Result"] = field(default_factory=list)
    asked: dict[str, Any] = field(default_factory=dict)

    def __repr__(self) -> str:
        return f"<Result of {self.kind}: {self.status}, {len(self.results.keys())} values, {len(self.arrays)} arrays>"

    def of(self, model: type[Model]) -> Model:
        """The results as a model of the kind; TypeError where the analysis gave others."""
        return as_model(self.results, model)

    def __getitem__(self, name: str) -> Any:
        """A result by its name, or an array's data."""
        return self.results[name] if name in self.results else self.arrays[name].data
