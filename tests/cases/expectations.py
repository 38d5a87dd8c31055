"""Cases and what is expected of them: NAME.toml beside NAME.expect.toml.

Each [[expect]] row has quantity ("rocking.impact_times_s[0]"; a key with a dot is quoted: "share['0.5']"), value (null cannot be written in
TOML: use "none"), tolerance (absolute) or relative_tolerance, kind, source, and optionally `note` and `change`, deck keys with other
values ("structure.thickness" = 0.12, "none" leaves one out). `slow = true` at the top moves a case to `make verify`. Kinds:

- exact: a closed form, or a law that holds exactly. peer: another program, or an unlike method of this one; tools/verification_origins.toml has who
  computed the number, its basis and date.
- thesis: the number or the statement is in the text of the dissertation. experiment: measured; `scatter` is that of the tests themselves
  (half the band or the standard deviation over the mean), or the words "one test".
- A tolerance above 10 % of one of these four needs `wide`, the reason why so little is proven.
- bound: `at_least` or `at_most` in place of a value: a one-sided statement of a source.
- inferred: printed elsewhere, but sizes that the print does not give were chosen so that it comes out. calibration: a factor was fitted
  to it. regression: the program against itself; `why` says why there is no outside value. None of the three verifies anything.
"""

import math
import re
import tomllib
from copy import deepcopy
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from jsonschema import Draft202012Validator

from extrados.analyses.context import Context
from extrados.decks.reader import make_deck
from extrados.results.explain import json_schema
from extrados.running.run import Run, compute

ROOT = Path(__file__).resolve().parents[2]
CASES = ROOT / "cases"
KINDS = ("exact", "peer", "thesis", "experiment", "bound", "inferred", "calibration", "regression")


@dataclass(frozen=True)
class Row:
    """One expected quantity."""

    quantity: str
    value: Any
    tolerance: float
    relative: bool
    kind: str
    source: str  # of a regression: why there is no outside value
    change: tuple[tuple[str, Any], ...]
    note: str
    limits: tuple[float, float] | None = None  # of a bound
    wide: str = ""  # why so much is allowed
    scatter: float | str = ""  # of the tests, of an experiment

    @property
    def loose(self) -> bool:
        """Whether so much is allowed that the row proves little."""
        return (
            self.kind in PROOFS
            and not isinstance(self.value, str)
            and LOOSE * abs(self.value) * (1.0 + 1e-9) < self.allowed
            and bool(self.value)
        )

    @property
    def allowed(self) -> float:
        """The greatest absolute difference."""
        return self.tolerance * abs(self.value) if self.relative else self.tolerance

    def fits(self, found: Any) -> bool:
        """True where the found value is what was expected."""
        if self.limits is not None:
            return isinstance(found, int | float) and self.limits[0] <= found <= self.limits[1]
        if isinstance(self.value, str):
            return str(found if found is not None else "none") == self.value
        return isinstance(found, int | float) and abs(found - self.value) <= self.allowed


@dataclass(frozen=True)
class Case:
    """A deck and its rows."""

    deck: Path
    rows: list[Row]
    slow: bool

    @property
    def name(self) -> str:
        return str(self.deck.relative_to(CASES).with_suffix(""))


#: Kinds of comparison, the strongest first; the others verify nothing, or only one side
PROOFS = ("exact", "peer", "thesis", "experiment")
#: Relative tolerance from which on a row must say why
LOOSE = 0.10
_KEYS = {"quantity", "value", "tolerance", "relative_tolerance", "kind", "source", "why", "change", "note", "wide"}
_OF_KIND = {"bound": {"at_least", "at_most"}, "experiment": {"scatter"}}


def _frozen(value: Any) -> Any:
    """A value of a change as part of a key of groups: lists as tuples."""
    return tuple(map(_frozen, value)) if isinstance(value, list) else value


def read_row(row: dict[str, Any], path: Path) -> Row:
    """A row as it stands in the file.

    Raises ValueError for one that lacks what its kind needs, or has keys of another.
    """
    kind, own = row["kind"], set(row)
    origin = "why" if kind == "regression" else "source"
    wrong = kind not in KINDS or own - _KEYS - _OF_KIND.get(kind, set()) or not row.get(origin) or {"why", "source"} <= own
    bound = own & {"at_least", "at_most"}
    if kind == "bound":
        wrong = wrong or not bound or own & {"value", "tolerance", "relative_tolerance"}
    if wrong or (kind == "experiment" and "scatter" not in own):
        raise ValueError(f"{path}: bad row {row}")
    limits = (row.get("at_least", -math.inf), row.get("at_most", math.inf)) if bound else None
    value = row["value"] if limits is None else " and ".join(f"{k.replace('_', ' ')} {row[k]:g}" for k in sorted(bound))
    found = Row(
        row["quantity"],
        value,
        row.get("relative_tolerance", row.get("tolerance", 0.0)),
        "relative_tolerance" in row,
        kind,
        row[origin],
        tuple(sorted((k, _frozen(v)) for k, v in row.get("change", {}).items())),
        row.get("note", ""),
        limits,
        row.get("wide", ""),
        row.get("scatter", ""),
    )
    if found.loose != bool(found.wide):
        raise ValueError(f"{path}: `wide` gives the reason of a tolerance above {LOOSE:.0%}, and of no other: {row}")
    return found


def load_cases() -> list[Case]:
    """All cases, in order of their names."""
    found = []
    for path in sorted(CASES.rglob("*.expect.toml")):
        data = tomllib.loads(path.read_text(encoding="utf-8"))
        rows = [read_row(row, path) for row in data["expect"]]
        deck = path.with_name(path.name.replace(".expect.toml", ".toml"))
        if not deck.exists():
            raise ValueError(f"{path}: no deck {deck.name} beside it")
        found.append(Case(deck, rows, data.get("slow", False)))
    return found


@cache
def origins() -> list[dict[str, str]]:
    """Who computed the numbers beside the rows (tools/verification_origins.toml)."""
    return tomllib.loads((ROOT / "tools" / "verification_origins.toml").read_text(encoding="utf-8"))["origin"]


def origin_of(row: Row) -> dict[str, str] | None:
    """The entry of a row's number; None of rows that no one else computed."""
    return next((o for o in origins() if o["kind"] == row.kind and re.search(o.get("pattern", ""), row.source)), None)


def changed(data: dict[str, Any], change: tuple[tuple[str, Any], ...]) -> dict[str, Any]:
    """A deck's data with other values, "none" leaves a key out; "analysis.0.friction" reaches into the array of analyses."""
    data = deepcopy(data)
    for dotted, value in change:
        place: Any = data
        *way, last = dotted.split(".")
        for part in way:
            place = place[int(part)] if isinstance(place, list) else place.setdefault(part, {})
        if value == "none":
            place.pop(last)
        else:
            place[last] = list(value) if isinstance(value, tuple) else value
    return data


def pick(results: dict[str, dict[str, Any]], quantity: str) -> Any:
    """The value that "analysis.key.sub[3]" names, or "analysis.key['0.5']"."""
    analysis, _, way = quantity.partition(".")
    place: Any = results[analysis]
    for quoted, bare in re.findall(r"\['([^']+)'\]|([^.\[\]]+)", way):
        part = quoted or bare
        place = place[int(part)] if isinstance(place, list) else place[part]
    return place


@cache
def summary_schema() -> Draft202012Validator:
    """The schema that every summary.json meets."""
    return Draft202012Validator(json_schema())


#: Part of the work of the loads that the energy lost may fall by from a state to the next: rounding, and the trapezium rule of steps
REGAINED = 1e-3


def energy_regained(event: dict[str, np.ndarray]) -> float:
    """The greatest fall of the energy lost (events) [J] between two states that follow each other, over the greatest work of the loads."""
    known = (event["state"] == 1) & (event["equilibrium"] == 1)
    work = float(np.abs(event["external"][known]).max(initial=0.0))
    falls = -np.diff(event["lost"])[known[1:] & known[:-1]]
    return float(falls.max(initial=0.0)) / work if work > 0.0 else 0.0


def falling_energies(run: Run) -> list[str]:
    """The curves of a run whose energy lost falls by more than REGAINED of the work of the loads, in words."""
    found = []
    for name, arrays in run.arrays.items():
        for prefix in {array.removesuffix("event_lost") for array in arrays if array.endswith("event_lost")}:
            fallen = energy_regained({key: arrays[f"{prefix}event_{key}"].data for key in ("lost", "external", "equilibrium", "state")})
            if fallen > REGAINED:
                found.append(f"{name}, {prefix}curve: energy lost falls by {fallen:.2g} of the work of the loads")
    return found


def run_of(case: Case, change: tuple[tuple[str, Any], ...]) -> Run:
    """Run the deck with the change, as a user would through Python."""
    data = changed(tomllib.loads(case.deck.read_text(encoding="utf-8")), change)
    run = compute(Context(make_deck(data, case.deck.parent), threads=2))
    summary_schema().validate(run.summary)
    return run


def results_of_run(run: Run) -> dict[str, dict[str, Any]]:
    """Analysis name -> results. A refusal is a result too: its status and reason can be expected."""
    return {a["name"]: {**a["results"], "status": a["status"], "reason": a["reason"]} for a in run.analyses}
