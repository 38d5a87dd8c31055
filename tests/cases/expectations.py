"""Cases and what is expected of them: NAME.toml beside NAME.expect.toml.

Each [[expect]] row has quantity ("rocking.impact_times_s[0]"), value (null cannot be written in TOML: use
"none"), tolerance (absolute) or relative_tolerance, kind (exact | thesis | experiment | peer | calibration | regression),
source, and optionally `note` and `change`, deck keys with other values ("structure.thickness" = 0.12, "none" leaves one out). A
regression compares the program with itself and has no source: `why` says why there is no outside value. `slow = true` at the top moves a case to `make verify`.
"""

import re
import tomllib
from copy import deepcopy
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from jsonschema import Draft202012Validator

from extrados.results.explain import json_schema

ROOT = Path(__file__).resolve().parents[2]
CASES = ROOT / "cases"
KINDS = ("exact", "thesis", "experiment", "peer", "calibration", "regression")


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

    @property
    def allowed(self) -> float:
        """The greatest absolute difference."""
        return self.tolerance * abs(self.value) if self.relative else self.tolerance

    def fits(self, found: Any) -> bool:
        """True where the found value is what was expected."""
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


def load_cases() -> list[Case]:
    """All cases, in order of their names."""
    found = []
    for path in sorted(CASES.rglob("*.expect.toml")):
        data = tomllib.loads(path.read_text(encoding="utf-8"))
        rows = []
        for row in data["expect"]:
            known = {
                "quantity",
                "value",
                "tolerance",
                "relative_tolerance",
                "kind",
                "source",
                "why",
                "change",
                "note",
            }
            origin = "why" if row["kind"] == "regression" else "source"
            if set(row) - known or row["kind"] not in KINDS or not row.get(origin) or {"why", "source"} <= set(row):
                raise ValueError(f"{path}: bad row {row}")
            relative = "relative_tolerance" in row
            rows.append(
                Row(
                    row["quantity"], row["value"], row.get("relative_tolerance", row.get("tolerance", 0.0)), relative,
                    row["kind"], row[origin], tuple(sorted(row.get("change", {}).items())), row.get("note", ""),
                )
            )  # fmt: skip
        deck = path.with_name(path.name.replace(".expect.toml", ".toml"))
        if not deck.exists():
            raise ValueError(f"{path}: no deck {deck.name} beside it")
        found.append(Case(deck, rows, data.get("slow", False)))
    return found


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
            place[last] = value
    return data


def pick(results: dict[str, dict[str, Any]], quantity: str) -> Any:
    """The value that "analysis.key.sub[3]" names."""
    analysis, _, way = quantity.partition(".")
    place: Any = results[analysis]
    for part in re.findall(r"[^.\[\]]+", way):
        place = place[int(part)] if isinstance(place, list) else place[part]
    return place


@cache
def summary_schema() -> Draft202012Validator:
    """The schema that every summary.json meets."""
    return Draft202012Validator(json_schema())


def results_of(case: Case, change: tuple[tuple[str, Any], ...]) -> dict[str, dict[str, Any]]:
    """Run the deck with the change, as a user would through Python; analysis name -> results."""
    from extrados.analyses.context import Context
    from extrados.decks.reader import make_deck
    from extrados.running.run import compute

    data = changed(tomllib.loads(case.deck.read_text(encoding="utf-8")), change)
    run = compute(Context(make_deck(data, case.deck.parent), threads=2))
    summary_schema().validate(run.summary)
    # A refusal is a result too: its status and reason can be expected
    return {a["name"]: {**a["results"], "status": a["status"], "reason": a["reason"]} for a in run.analyses}
