"""survey: many sections from a table, one line of results each."""

import time
from dataclasses import dataclass
from typing import Any

import numpy as np

from extrados.analyses.batches import stacked, sweep
from extrados.analyses.changes import changed, read_table
from extrados.analyses.context import Context
from extrados.analyses.limit.asked import sections_of
from extrados.analyses.limit.outcome import Outcome, outcomes_of
from extrados.analyses.limit.tables import Survey
from extrados.analyses.limit.variation import evaluate, spoken
from extrados.model.errors import BadGeometry
from extrados.results import sweeps as out
from extrados.results.limit import DILATANT
from extrados.results.model import Array, Result, TableData
from extrados.views.building import Building


def _value(cell: str) -> Any:
    """A cell as TOML would read it: a whole number, a number, true, false or text (also a quantity with unit)."""
    if cell in ("true", "false"):
        return cell == "true"
    for kind in (int, float):
        try:
            return kind(cell)
        except ValueError:
            continue
    return cell


def _column(header: list[str], rows: list[list[str]], name: str) -> list[str]:
    return [row[header.index(name)] for row in rows] if name in header else [""] * len(rows)


@dataclass(frozen=True)
class Sections:
    """Member k is the structure of table `data` with the keys of rows[k] in their place."""

    building: Building
    data: dict[str, Any]
    header: list[str]
    rows: list[list[str]]
    options: Survey

    def run(self, first: int, count: int, threads: int) -> dict[str, np.ndarray]:
        return stacked(lambda k: self._outcome(self.rows[k]).row(), first, count)

    def _outcome(self, row: list[str]) -> Outcome:
        data = self.data
        for name, cell in zip(self.header, row, strict=True):
            if name != "name" and cell:
                data = changed(data, name, _value(cell))
        try:
            building = self.building.apart().having(structure=read_table(type(self.building.require_structure()), data))
        except BadGeometry as error:
            return Outcome(reason=str(error))
        return evaluate(building, self.options, fracture=self.options.fracture)


def run(context: Context, options: Survey) -> Result:
    """The deck's structure with the keys of each row in their place; empty cells leave the deck's value."""
    header, rows = sections_of(context, options)
    begin = time.perf_counter()
    names = [cell or f"section {i + 1}" for i, cell in enumerate(_column(header, rows, "name"))]
    job = Sections(context.building, context.deck.data["structure"], header, rows, options)
    outcomes = outcomes_of(sweep(context, "survey", job, len(rows), "survey", slow=True).whole())
    seconds = time.perf_counter() - begin
    gamma = np.array([np.nan if o.gamma is None else o.gamma for o in outcomes])
    columns: dict[str, Any] = {
        "name": names,
        "collapse_acceleration": gamma,
        "tilt_angle": np.degrees(np.arctan(gamma)),
        "mechanism": [spoken(o.signature) for o in outcomes],
    }
    if options.fracture:
        columns["fractured_collapse_acceleration"] = [np.nan if o.fractured is None else o.fractured for o in outcomes]
    for k, name in enumerate(header):
        if name != "name":
            columns[name] = [row[k] for row in rows]
    columns["status"] = [o.status for o in outcomes]
    columns["upper_bound"] = ["dilatant friction" if o.dilating else "" for o in outcomes]
    columns["reason"] = ["; ".join([o.reason] if o.reason else o.notes) for o in outcomes]
    answered, stand = np.isfinite(gamma), gamma > 0.0

    def rows_of(*wanted: out.SectionStatus) -> list[out.NoAnswerRow]:
        return [
            out.NoAnswerRow(row=i + 2, name=n, reason=o.reason)
            for i, (n, o) in enumerate(zip(names, outcomes, strict=True))
            if o.status in wanted
        ]

    fallen, without = rows_of("cannot-stand"), rows_of("no-answer", "locked")
    result = Result("survey")
    r = out.Survey(
        sections=len(rows),
        standing=int(stand.sum()),
        cannot_stand=fallen[:100],
        without_answer=without[:100],
        upper_bounds=sum(o.dilating for o in outcomes),
        weakest=names[int(np.nanargmin(gamma))] if answered.any() else None,
        weakest_collapse_acceleration_g=float(np.nanmin(gamma)) if answered.any() else None,
        median_collapse_acceleration_g=float(np.median(gamma[stand])) if stand.any() else None,
        sections_per_second=len(rows) / max(seconds, 1e-9),
        duality_gap=max(o.gap for o in outcomes),
    )
    result.results = r
    result.arrays = {
        "gamma": Array(
            gamma, ("section",), "g", "collapse acceleration towards +x; 0 for a section that cannot stand, NaN without a result"
        ),
        "section_name": Array(np.array(names, dtype=object), ("section",), "", "names of the sections"),
    }
    units = {"collapse_acceleration": "g", "fractured_collapse_acceleration": "g", "tilt_angle": "deg"}
    result.tables = {"survey": TableData(columns, units)}
    text = f"{int(stand.sum())} of {len(rows)} sections stand"
    if fallen:
        text += f"; {len(fallen)} cannot stand (capacity 0)"
    if stand.any():
        text += (
            f". The weakest is {r.weakest} with {r.weakest_collapse_acceleration_g:.4f} g; the median of the sections that "
            f"stand is {r.median_collapse_acceleration_g:.4f} g"
        )
    text += f". {len(without)} have no result." if without else "."
    if r.upper_bounds:
        text += f" In {r.upper_bounds} sections, joints slide; the capacity is then an {DILATANT}."
    result.answer = text + (" survey.csv gives the reasons." if fallen or without else "")
    return result
