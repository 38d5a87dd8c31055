"""What the decks of limit analyses ask for, apart from their drivers: values of a sweep, rows of a survey, movements."""

import csv
import io
from typing import Any

import numpy as np

from extrados.analyses.context import Context, Refused
from extrados.analyses.limit.tables import Imperfections, MovingSupports, Survey, Sweep
from extrados.model.errors import Key
from extrados.model.files import read
from extrados.model.structure import Structure
from extrados.schema.constants import GRAVITY
from extrados.schema.files import BadFile, File
from extrados.schema.quantities import parse, unit_of
from extrados.schema.table import Table
from extrados.views.building import Building

#: The key of a sweep
VARY = ("analysis", "vary")
LARGEST_FILE = 50_000_000  # bytes
MOST_ROWS = 200_000


def _placed(vary: str) -> tuple[str, str]:
    """Table and key that `vary` names; a key alone is one of [structure]."""
    table, _, path = vary.partition(".")
    return (table, path) if table in ("structure", "material", "joints", "ties") and path else ("structure", vary)


def _is_whole(model: Table | tuple[Table, ...], table: str, path: str) -> bool:
    """True where the key takes whole numbers; Refused where there is no such key, or it holds no number."""
    place: Any = type(model)
    held: Any = list(model) if isinstance(model, tuple) else model
    for part in path.split("."):
        if isinstance(held, list):
            if not part.isdecimal() or int(part) >= len(held):
                raise Refused(f"vary: '{path}': expected a number from 0 to {len(held) - 1} instead of '{part}'", VARY)
            held = held[int(part)]
            place = type(held)
            continue
        known = getattr(place, "model_fields", {})
        if part not in known:
            kind = f" of kind '{model.kind}'" if isinstance(model, Structure) else ""
            raise Refused(f"vary: [{table}]{kind} has no key '{path}'; its keys are {', '.join(known)}", VARY)
        annotation = known[part].annotation
        inner = [a for a in getattr(annotation, "__args__", ()) if hasattr(a, "model_fields")]
        place, held = inner[0] if inner else annotation, getattr(held, part, None)
    text = str(known[part].annotation)
    if not ("float" in text or "int" in text) or part == "kind":
        raise Refused(f"vary: '{path}' holds no number", VARY)
    return "int" in text and "float" not in text


def unit_at(table: type[Table], path: str) -> str:
    """Unit of a key, dotted for one of a table within the table, or of one in a list of tables."""
    place: Any = table
    *way, last = path.split(".")
    for part in way:
        if part.isdecimal():
            continue
        annotation = place.model_fields[part].annotation
        place = next((a for a in getattr(annotation, "__args__", ()) if hasattr(a, "model_fields")), annotation)
    return unit_of(place, last)


def number_of(value: float | str | None, unit: str, at: Key) -> float:
    """A value in the unit of its key; Refused where its text is no quantity of it; `at` is its key."""
    if not isinstance(value, str):
        return float(value or 0.0)
    if not unit:
        raise Refused(f"'{value}': the key to vary has no unit, so give a number", at)
    try:
        return parse(value, "m/s^2" if unit == "g" else unit) / (GRAVITY if unit == "g" else 1.0)
    except ValueError as error:
        raise Refused(str(error), at) from None


def values_of(building: Building, options: Sweep) -> tuple[str, str, str, bool, np.ndarray]:
    """The table and key that vary, its unit, whether it takes whole numbers, and its values; Refused where the deck has
    no such key, or a value is none of it."""
    table, path = _placed(options.vary)
    model = getattr(building, table)
    if model == ():
        raise Refused("vary: the deck has no [[ties]]", VARY)
    whole = _is_whole(model, table, path)
    unit = unit_at(type(model[0] if isinstance(model, tuple) else model), path)
    if options.values:
        values = np.array([number_of(value, unit, ("analysis", "values")) for value in options.values])
    else:
        start, stop = (number_of(getattr(options, end), unit, ("analysis", end)) for end in ("start", "stop"))
        values = np.linspace(start, stop, options.count)
    return table, path, unit, whole, np.unique(np.round(values)) if whole else np.sort(values)


def sections_of(context: Context, options: Survey) -> tuple[list[str], list[list[str]]]:
    """Header and rows of the table of a deck; Refused with its file and line where it is wrong."""
    key = ("analysis", "file")
    structure = context.deck.structure
    header, rows = _rows(read(options.file, LARGEST_FILE, context.deck.folder, key), key)
    for name in header:
        if structure is not None and name != "name" and name.split(".")[0] not in type(structure).model_fields:
            raise Refused(
                (
                    f"{options.file}:1: [structure] of kind '{structure.kind}' has no key '{name}'; its keys are "
                    f"{', '.join(k for k in type(structure).model_fields if k != 'kind')}and 'name'"
                ),
                key,
            )
    return header, rows


def _rows(file: File, key: Key) -> tuple[list[str], list[list[str]]]:
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
                raise Refused(f"{path.name}:{reader.line_num}: this row has {len(row)} cells, but the header has {len(header)}", key)
            rows.append([cell.strip() for cell in row])
            if len(rows) > MOST_ROWS:
                raise Refused(f"{path.name}: more than {MOST_ROWS} sections", key)
    except (BadFile, csv.Error) as error:
        raise Refused(f"{path.name}: this file is not a CSV table in UTF-8: {error}", key) from None
    if not header or not rows:
        raise Refused(f"{path.name}: expected a header of [structure] keys and at least one row", key)
    if len(set(header)) < len(header):
        raise Refused(f"{path.name}:1: a column name occurs twice", key)
    return header, rows


def deviation_of(building: Building, options: Imperfections) -> float:
    """How far a measured point may lie from its true place [m]; Refused where that is not known, or too far."""
    assembly, deviation = building.blocks(), options.deviation
    if deviation is None:
        deviation = getattr(building.structure, "contact_tolerance", None)
    if deviation is None:
        raise Refused("give the deviation of a survey. Only `blocks` have a default for it, their contact_tolerance", ("analysis",))
    shortest = float(assembly.length.min())
    if 4.0 * deviation > shortest:
        raise Refused(
            (
                f"a deviation of {1e3 * deviation:.3g} mm is more than 1/4 of the shortest joint, "
                f"'{assembly.joint_names[int(assembly.length.argmin())]}' ({1e3 * shortest:.3g} mm)"
            ),
            ("analysis", "deviation"),
        )
    return float(deviation)


def refuse_still(building: Building, options: MovingSupports) -> None:
    """Refused where the deck moves nothing."""
    if building.initial.movements:
        movements_of(building)
    elif options.spread == 0.0 and options.settle == 0.0:
        raise Refused("with spread = 0 and settle = 0 no support moves", ("analysis",))


def movements_of(building: Building) -> np.ndarray:
    """The movements (joints, 3) of the deck: dx, dy [m] and turn [rad]."""
    assembly = building.blocks()
    movement = np.zeros((len(assembly.a), 3))
    for j, one in zip(building.moved(), building.initial.movements, strict=True):
        movement[j] += one.dx, one.dy, np.radians(one.turn)
    if not movement.any():
        raise Refused("initial.movements: nothing moves", ("initial", "movements"))
    return movement


def partitions_of(building: Building) -> list[dict[str, Any]]:
    """Keys of the structure with which its blocks are half as long in one direction, or in another bond."""
    structure = building.structure
    assert structure is not None
    given = {name: getattr(structure, name) for name in (*structure.halved, *structure.bonds)}
    changes = [{name: type(given[name])(factor * given[name])} for name, factor in structure.halved.items() if given[name] is not None]
    return changes + [{name: bond} for name, bonds in structure.bonds.items() for bond in bonds if bond != given[name]]


def refuse_unruled(building: Building) -> None:
    """Refused where no rule makes the blocks."""
    if not partitions_of(building):
        raise Refused(
            (
                "block_size: the blocks of this structure have no key for their size. Divide the blocks in the file, and compare "
                "both capacities"
            ),
            ("analysis", "block_size"),
        )
