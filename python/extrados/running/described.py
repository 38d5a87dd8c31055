"""The description of a building for the report: dimensions, and properties with units and sources."""

from typing import Any

from extrados.decks.reader import Deck
from extrados.model.dimensions import dimensions
from extrados.model.errors import BadGeometry
from extrados.model.geometry.assembly import GROUND
from extrados.model.geometry.chains import arch_of
from extrados.motions.floors import floor_condition
from extrados.schema.quantities import unit_of
from extrados.schema.table import Table

#: Tables whose keys a report shows where they were given, and those that it shows whole
GIVEN, WHOLE = ("structure", "motion", "supports", "initial", "code"), ("material", "joints")
#: Keys of these that say nothing where they are as they are by default
QUIET: tuple[Any, ...] = (None, [], False)
#: Blocks of a building beyond which no section of it is kept for the report
MOST_DRAWN = 5000
#: Tables within a table that are listed key by key
MOST_WITHIN = 12


def described(deck: Deck) -> dict[str, Any]:
    """`dimensions` of the drawing [m], the `drawing`, `properties`: a row for each, with its unit and who set it, and `conditions` that
    hold for all analyses."""
    floor = None if deck.motion is None else deck.motion.floor
    conditions = [] if floor is None else [floor_condition(floor)]
    return {"dimensions": _dimensions(deck), "drawing": _drawing(deck), "properties": _properties(deck), "conditions": conditions}


def _drawing(deck: Deck) -> dict[str, Any]:
    """What a section is drawn from, also where every analysis refuses [m]: outlines, supports, levels of fill and surfacing with
    their ends, depth; empty of a building that is no plane section, or of very many blocks."""
    if deck.structure is None:
        return {}
    try:
        assembly = deck.building.blocks()
    except BadGeometry:
        return {}
    if len(assembly.outlines) > MOST_DRAWN:
        return {}
    grounded = [j for j, ends in enumerate(assembly.ends) if GROUND in ends]
    arches = [assembly.p[arch] for joints in assembly.chains.values() if (arch := arch_of(assembly, joints))]
    widest = max(arches, key=lambda points: abs(points[-1, 0] - points[0, 0]), default=None)
    crown = None if widest is None else widest[widest[:, 1].argmax(), 0]
    earth = assembly.earth
    return {
        "outlines": [_rounded(outline) for outline in assembly.outlines],
        "supports": [_rounded([assembly.p[j], assembly.q[j]]) for j in grounded],
        "earth": None
        if earth is None
        else {
            "start": _rounded(earth.line.start),
            "end": _rounded(earth.line.end),
            "formation": round(earth.formation, 4),
            "road": round(earth.road, 4),
        },
        "depth_m": float(assembly.depth),
        "spandrel_m": _spandrel(deck.structure),
        "crown_m": None if crown is None else float(crown),
    }


def _spandrel(structure: Any) -> float:
    """Thickness of a spandrel wall [m], 0 without."""
    walls = getattr(structure, "spandrels", None)
    return 0.0 if walls is None else float(walls.thickness)


def _rounded(points: Any) -> list[list[float]]:
    """To a tenth of a millimetre, which no drawing shows."""
    return [[round(float(x), 4) + 0.0, round(float(y), 4) + 0.0] for x, y in points]


def _dimensions(deck: Deck) -> list[dict[str, Any]]:
    if deck.structure is None:
        return []
    try:
        found = dimensions(deck.building.blocks())
    except BadGeometry:  # a wall that is seen whole, or what could not be made
        size = [(name, getattr(deck.structure, name, None)) for name in ("width", "height", "thickness")]
        return [{"name": name, "length_m": float(value)} for name, value in size if isinstance(value, float)]
    return [{"name": d.name, "length_m": d.length, "start": d.start, "end": d.end, "aside": d.aside} for d in found]


def _properties(deck: Deck) -> list[dict[str, Any]]:
    building = deck.building
    tables: dict[str, Table | None] = {name: getattr(building, name) for name in ("structure", *WHOLE, "supports", "initial")}
    tables |= {f"materials.{name}": table for name, table in building.materials.items()}
    for name in ("ties", "dampers", "hinges"):
        tables |= {f"{name}.{one.name}": one for one in getattr(building, name)}
    tables |= {"motion": deck.motion, "code": deck.code}
    return [row for name, table in tables.items() if table is not None for row in _rows(name, table)]


def _rows(name: str, table: Table) -> list[dict[str, Any]]:
    """A row for each key; tables within a table, and lists of them, key by key."""
    found: list[dict[str, Any]] = []
    for key, field in type(table).model_fields.items():
        value = getattr(table, key)
        given = key in table.model_fields_set
        if not given and (name not in WHOLE or value in QUIET):
            continue
        within = [value] if isinstance(value, Table) else value if _tables(value) else []
        if 0 < len(within) <= MOST_WITHIN:
            for k, one in enumerate(within, start=1):
                found += _rows(f"{name}.{key}{f' {k}' if len(within) > 1 else ''}", one)
            continue
        extra = field.json_schema_extra
        found.append(
            {
                "table": name,
                "key": key,
                "value": _plain(value),
                "unit": unit_of(type(table), key),
                "about": field.description or "",
                "from": "deck" if given else "default",
                "source": str(extra.get("source", "")) if isinstance(extra, dict) else "",
            }
        )
    return found


def _tables(value: Any) -> bool:
    return isinstance(value, list | tuple) and len(value) > 0 and all(isinstance(one, Table) for one in value)


def _plain(value: Any) -> Any:
    if isinstance(value, Table):
        return value.model_dump(exclude_none=True)
    if isinstance(value, list | tuple):
        return [_plain(v) for v in value]
    return value
