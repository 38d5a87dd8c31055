"""survey: many sections from a table, one line of results each."""

import csv
import io
import time
from dataclasses import dataclass
from typing import Any

import numpy as np

from extrados.analyses.batches import stacked, sweep
from extrados.analyses.context import Context, Refused
from extrados.analyses.limit.tables import Survey
from extrados.analyses.limit.variation import Outcome, changed, evaluate, outcomes_of, spoken
from extrados.analyses.limit.variation import read_table as read_section
from extrados.building.building import Building
from extrados.building.errors import BadGeometry
from extrados.building.files import read
from extrados.results import limit as out
from extrados.results.model import Array, Result, TableData
from extrados.schema.files import BadFile, File

LARGEST_FILE = 50_000_000  # bytes
MOST_ROWS = 200_000


def read_table(file: File) -> tuple[list[str], list[list[str]]]:
    """Header and rows of a CSV file; Refused with file and line where it is wrong."""
    path = file.path
    try:
        reader = csv.reader(io.StringIO(file.text(), newline=""))
        header = [name.strip() for name in next(reader, [])]
        rows = []
        for row in reader:
            if not any(cell.strip() for cell in row):
                continue
            if len(row) != len(header):
                raise Refused(f"{path.name}:{reader.line_num}: {len(row)} cells, the header has {len(header)}")
            rows.append([cell.strip() for cell in row])
            if len(rows) > MOST_ROWS:
                raise Refused(f"{path.name}: more than {MOST_ROWS} sections")
    except (BadFile, csv.Error) as error:
        raise Refused(f"{path.name}: is not a CSV table in UTF-8: {error}") from None
    if not header or not rows:
        raise Refused(f"{path.name}: expected a header of [structure] keys and at least one row")
    if len(set(header)) < len(header):
        raise Refused(f"{path.name}:1: a column name stands twice")
    return header, rows


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
            building = self.building.apart().having(structure=read_section(type(self.building.structure), data))
        except BadGeometry as error:
            return Outcome(reason=str(error))
        return evaluate(building, self.options, fracture=self.options.fracture)


def run(context: Context, options: Survey) -> Result:
    """The deck's structure with the keys of each row in their place; empty cells leave the deck's value."""
    model = type(context.deck.structure)
    header, rows = read_table(read(options.file, LARGEST_FILE, context.deck.folder))
    for name in header:
        if name != "name" and name.split(".")[0] not in model.model_fields:
            raise Refused(
                f"{options.file}:1: [structure] of kind '{context.deck.structure.kind}' has no key '{name}'; "
                f"it has {', '.join(k for k in model.model_fields if k != 'kind')}, and 'name'"
            )
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
    columns["reason"] = ["; ".join([o.reason] if o.reason else o.notes) for o in outcomes]
    stand = np.isfinite(gamma)
    result = Result("survey")
    r = out.Survey(
        sections=len(rows),
        standing=int(stand.sum()),
        without_answer=[
            out.NoAnswerRow(row=i + 2, name=n, reason=o.reason)
            for i, (n, o) in enumerate(zip(names, outcomes, strict=True))
            if o.reason
        ][:100],
        weakest=names[int(np.nanargmin(gamma))] if stand.any() else None,
        weakest_collapse_acceleration_g=float(np.nanmin(gamma)) if stand.any() else None,
        median_collapse_acceleration_g=float(np.nanmedian(gamma)) if stand.any() else None,
        sections_per_second=len(rows) / max(seconds, 1e-9),
        duality_gap=max(o.gap for o in outcomes),
    )
    result.results = r
    result.arrays = {
        "gamma": Array(gamma, ("section",), "g", "collapse acceleration to +x; NaN without an answer"),
        "section_name": Array(np.array(names, dtype=object), ("section",), "", "names of the sections"),
    }
    units = {"collapse_acceleration": "g", "fractured_collapse_acceleration": "g", "tilt_angle": "deg"}
    result.tables = {"survey": TableData(columns, units)}
    text = f"{int(stand.sum())} of {len(rows)} sections stand"
    if stand.any():
        text += (
            f"; the weakest is {r.weakest} with {r.weakest_collapse_acceleration_g:.4f} g, "
            f"the median {r.median_collapse_acceleration_g:.4f} g"
        )
    result.answer = text + f". {len(rows) - int(stand.sum())} rows carry a reason in survey.csv."
    return result
