"""What the decks of limit analyses ask for, apart from their drivers: values of a sweep, rows of a survey, movements."""

import csv
import io
from dataclasses import dataclass
from typing import Any

import numpy as np

from extrados.analyses.context import Context, Refused
from extrados.analyses.limit.tables import Imperfections, MovingSupports, Section, Survey, Sweep, Thrust
from extrados.analyses.needs import stones_of
from extrados.model.errors import Key
from extrados.model.files import read
from extrados.model.geometry.assembly import GROUND, Assembly
from extrados.model.geometry.solids.assembly import SolidAssembly
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
    if vary == "direction":
        return "analysis", vary
    return (table, path) if table in ("structure", "material", "joints", "ties") and path else ("structure", vary)


def _is_whole(model: Table | tuple[Table, ...], table: str, path: str) -> bool:
    """True where the key takes whole numbers; Refused where there is no such key, or it holds no number."""
    place: Any = type(model)
    held: Any = list(model) if isinstance(model, tuple) else model
    for part in path.split("."):
        if isinstance(held, list):
            if not part.isdecimal() or int(part) >= len(held):
                raise Refused(f"vary: '{path}': give a number from 0 to {len(held) - 1} in place of '{part}'", VARY)
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
        raise Refused(f"'{value}': the key in `vary` has no unit, so give a plain number", at)
    try:
        return parse(value, "m/s^2" if unit == "g" else unit) / (GRAVITY if unit == "g" else 1.0)
    except ValueError as error:
        raise Refused(str(error), at) from None


def values_of(building: Building, options: Sweep) -> tuple[str, str, str, bool, np.ndarray]:
    """The table and key that vary, its unit, whether it takes whole numbers, and its values; Refused where the deck has
    no such key, or a value is none of it."""
    table, path = _placed(options.vary)
    model = options if table == "analysis" else getattr(building, table)
    if model == ():
        raise Refused("`vary` names a tie, but the deck has no [[ties]]", VARY)
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
                f"{options.file}:1: [structure] of kind '{structure.kind}' has no key '{name}'; its keys are "
                f"{', '.join(k for k in type(structure).model_fields if k != 'kind')} and 'name'",
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
    deviation = options.deviation
    if deviation is None:
        deviation = getattr(building.structure, "contact_tolerance", None)
    if deviation is None:
        raise Refused("give the key `deviation`: only `blocks` have a default for it (their `contact_tolerance`)", ("analysis",))
    stones = stones_of(building, options)
    plane = isinstance(stones, Assembly)
    extent = stones.length if isinstance(stones, Assembly) else stones.area / np.array([_diameter(p) for p in stones.polygon])
    shortest = float(extent.min())
    if 4.0 * deviation > shortest:
        raise Refused(
            f"a `deviation` of {1000.0 * deviation:.3g} mm is more than 1/4 of the {('shortest' if plane else 'narrowest')} "
            f"joint, '{stones.joint_names[int(extent.argmin())]}' ({1000.0 * shortest:.3g} mm)",
            ("analysis", "deviation"),
        )
    return float(deviation)


def _diameter(points: np.ndarray) -> float:
    """Greatest distance of two corners (k, 3) [m]."""
    return float(np.linalg.norm(points[:, None] - points[None], axis=2).max())


@dataclass(frozen=True)
class Cut:
    """A section of blocks in space: its contacts (n), and the unit vectors (n, 3) whose products with the forces on the first
    blocks of the contacts sum up to its thrust. along: the direction in words."""

    name: str
    along: str
    contacts: np.ndarray
    toward: np.ndarray


def cuts_of(building: Building, options: Thrust) -> list[Cut]:
    """The sections of a deck; without any the level cuts across x and y through the middle, and the ground. Refused where a
    section has no contact."""
    assembly = building.solids()
    points = np.concatenate([part.vertices for part in assembly.parts])
    middle = np.round(0.5 * (points.min(axis=0) + points.max(axis=0)), 9) + 0.0  # rounding is no place
    tables = options.section or [
        *(Section.model_validate({"name": f"{axis} = {middle[k]:.4g} m", axis: middle[k]}) for k, axis in enumerate("xy")),
        Section(name="ground", joints=["ground"]),
    ]
    found = []
    for number, table in enumerate(tables):
        key: Key = ("analysis", "section", number) if options.section else ("analysis",)
        contacts, above = _contacts_of(assembly, table, key)
        if len(contacts):
            found.append(_cut(assembly, table, contacts, above, middle, None if options.section else options.direction or 0.0, key))
        elif options.section:
            raise Refused(f"section '{table.name}': its cut crosses no contact between two blocks: move the cut", key)
    return found


def _contacts_of(assembly: SolidAssembly, table: Section, key: Key) -> tuple[np.ndarray, np.ndarray]:
    """Contacts of a section, and whether the first block of each is the one above, or at greater x or y."""
    a, b = assembly.a, assembly.b
    if table.joints is not None:
        wanted: set[int] = set()
        for name in table.joints:
            if name == "ground":
                wanted |= set(np.flatnonzero((a == GROUND) | (b == GROUND)).tolist())
            elif name in assembly.groups:
                wanted |= set(assembly.groups[name])
            elif name in assembly.joint_names:
                wanted.add(assembly.joint_names.index(name))
            else:
                known = ", ".join([*assembly.groups, "ground", *assembly.joint_names[:6]])
                raise Refused(f"section '{table.name}': no contact has the name '{name}'; the names are {known}, ...", (*key, "joints"))
        contacts = np.array(sorted(wanted), dtype=int)
        height = np.append(assembly.centroid[:, 2], -np.inf)  # the ground is below
        return contacts, height[a[contacts]] >= height[b[contacts]]
    axis = next(k for k, value in enumerate((table.x, table.y, table.z)) if value is not None)
    beyond = assembly.centroid[:, axis] - float((table.x, table.y, table.z)[axis] or 0.0) > 1e-9 * assembly.size
    first, second = (np.append(beyond, False)[side] for side in (a, b))  # the ground is below
    apart = first != second if axis == 2 else (first != second) & (a != GROUND) & (b != GROUND)
    contacts = np.flatnonzero(apart)
    return contacts, first[contacts]


def _cut(
    assembly: SolidAssembly, table: Section, contacts: np.ndarray, above: np.ndarray, middle: np.ndarray, otherwise: float | None, key: Key
) -> Cut:
    """The directions of the thrust at each contact of a section. A contact below the middle of the structure has no direction outward:
    the section then takes that of the load, `otherwise` [deg]; Refused if that is not given."""
    upright = table.x is not None or table.y is not None
    turn = table.toward if table.toward is not None else None if not upright else 0.0 if table.x is not None else 90.0
    way = np.array([assembly.polygon[j].mean(axis=0) for j in contacts]) - middle
    way[:, 2] = 0.0
    far = np.linalg.norm(way, axis=1)
    if turn is None and (central := np.flatnonzero(far < 1e-6 * assembly.size)).size:
        if otherwise is None:
            raise Refused(
                f"section '{table.name}': the contact '{assembly.joint_names[int(contacts[central[0]])]}' lies in "
                "the middle of the structure and has no outward direction: give the key `toward`",
                key,
            )
        turn = otherwise
    if turn is None:
        way /= far[:, None]
    else:
        way = np.tile([np.cos(np.radians(turn)), np.sin(np.radians(turn)), 0.0], (len(contacts), 1))
    on_first = above if upright else ~above  # the block whose forces count
    along = "outward" if turn is None else {0.0: "+x", 90.0: "+y"}.get(turn, f"{turn:g} deg in plan")
    return Cut(table.name, along, contacts, np.where(on_first, 1.0, -1.0)[:, None] * way)


def refuse_still(building: Building, options: MovingSupports) -> None:
    """Refused where the deck moves nothing."""
    if building.initial.movements:
        movements_of(building)
    elif options.spread == 0.0 and options.settle == 0.0:
        raise Refused("with `spread` = 0 and `settle` = 0, no support moves: give one of them another value", ("analysis",))


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
            "block_size: the blocks of this structure have no key for their size. Divide the blocks in the file, and compare "
            "both capacities",
            ("analysis", "block_size"),
        )
