"""A deck of a building from an IFC model: walls and their openings by their extruded solids, storeys by their elevations.

The file is read by ifcopenshell in a process of its own. A wall is the box about its solid in the axes of its placement; an opening
is the part of the wall that the box about its solid covers.
"""

import itertools
from pathlib import Path
from typing import Any

import numpy as np

from extrados.bridges.plan_drawing import CLOSE, LEAST, MOST_WALLS, DrawnWall, WrittenWall, joined, written_deck
from extrados.decks.reader import DeckError
from extrados.model.files import LARGEST_FILE
from extrados.model.geometry.polygons import signed_area
from extrados.schema.contained import Unreadable, read_contained
from extrados.schema.files import read

#: Metres by SI prefix
PREFIX = {None: 1.0, "MILLI": 1e-3, "CENTI": 1e-2, "DECI": 1e-1, "KILO": 1e3}
#: A wall belongs to a storey of which it covers more than this part
COVERED = 0.5
#: Part of its box that the solid of a wall fills at least; others, such as curved or L-shaped ones, are no straight walls
FILLED = 0.95
#: Most corners of a profile, steps along a chain of placements or clippings
MOST_CORNERS, DEEPEST = 2000, 60


def deck_of_ifc(model: Path) -> str:
    """The text of a deck with the walls of an IFC model; DeckError says what cannot be read. Needs the extra `ifc`."""
    file = read(model, LARGEST_FILE)
    try:
        found = read_contained("extrados.bridges.plan_ifc:parse_ifc", file.content, ["ifcopenshell"])
    except Unreadable as error:
        raise DeckError([f"{model.name}: {error}"]) from None
    walls, storeys = _by_storey(found, model.name)
    said = [
        (f"Walls, openings and storeys are read from the model {model.name}. Each wall is modelled as the box around its solid."),
        *(
            [(f"{found['cut']} walls are cut, for instance gables by a roof. Their boxes are used, which adds masonry.")]
            if found["cut"]
            else []
        ),
        *([f"Not considered: {found['left']} walls whose solids are not straight boxes."] if found["left"] else []),
    ]
    return written_deck(walls, storeys, model.name, said)


def parse_ifc(content: bytes) -> dict[str, Any]:
    """Elevations of storeys, walls as a (2), b (2), thickness, foot, head and openings (s from, to, z from, to) [m]; the number of
    walls without an extruded solid that fills its box, and of walls whose solid is cut. The contained process calls this; Unreadable gives the reason."""
    try:
        import ifcopenshell
    except ImportError:
        raise Unreadable("reading IFC requires ifcopenshell. Install it by pip install 'extrados[ifc]'") from None
    model = ifcopenshell.file.from_string(content.decode("utf-8", "replace"))
    try:
        return _parsed(model)
    except RuntimeError as error:
        raise Unreadable(f"no IFC model of a schema that ifcopenshell reads, such as IFC2X3 or IFC4: {error}") from None
    except (AttributeError, TypeError, ValueError, IndexError, OverflowError) as error:
        raise Unreadable(f"an entity does not follow the schema of IFC: {error}") from None


def _parsed(model: Any) -> dict[str, Any]:
    """What `parse_ifc` gives, of an open model."""
    scale = _scale(model)
    elevations = sorted({round(scale * float(s.Elevation or 0.0), 4) for s in model.by_type("IfcBuildingStorey")})
    walls, left, cut = [], 0, 0
    every = model.by_type("IfcWall")
    if not every:
        raise Unreadable("holds no IfcWall")
    if len(every) > 10 * MOST_WALLS:
        raise Unreadable(f"the model has {len(every)} walls, but at most {10 * MOST_WALLS} are allowed")
    for wall in every:
        corners, volume = _solid(wall)
        if not volume > FILLED * np.prod(np.ptp(corners, axis=0)):
            left += 1
            continue
        walls.append(_wall(wall, corners, scale))
        cut += _is_cut(wall)
    if not walls:
        raise Unreadable("no wall has an extruded solid that is a straight box")
    return {"elevations": elevations, "walls": walls, "left": left, "cut": cut}


def _scale(model: Any) -> float:
    """Metres of the model's unit of length."""
    for unit in (one for given in model.by_type("IfcUnitAssignment") for one in given.Units):
        if getattr(unit, "UnitType", None) != "LENGTHUNIT":
            continue
        if unit.is_a("IfcSIUnit"):
            return PREFIX.get(unit.Prefix, 1.0)
        if unit.is_a("IfcConversionBasedUnit"):
            factor = unit.ConversionFactor
            return float(factor.ValueComponent.wrappedValue) * PREFIX.get(getattr(factor.UnitComponent, "Prefix", None), 1.0)
    return 1.0


def _axes(place: Any) -> np.ndarray:
    """The matrix (4, 4) of an axis placement; the identity without one."""
    made = np.eye(4)
    if place is None:
        return made
    flat = len(place.Location.Coordinates) == 2
    x = np.array([*(place.RefDirection.DirectionRatios if place.RefDirection else (1.0, 0.0, 0.0)), 0.0][:3], dtype=float)
    z = np.array([0.0, 0.0, 1.0] if flat or not place.Axis else place.Axis.DirectionRatios, dtype=float)
    z /= np.linalg.norm(z)
    x -= (x @ z) * z
    x /= np.linalg.norm(x)
    made[:3, 0], made[:3, 1], made[:3, 2] = x, np.cross(z, x), z
    made[: len(place.Location.Coordinates), 3] = place.Location.Coordinates
    return made


def _placed(element: Any) -> np.ndarray:
    """The matrix (4, 4) from the axes of an element to those of the model."""
    made, place = np.eye(4), element.ObjectPlacement
    for _ in range(DEEPEST):
        if place is None or not place.is_a("IfcLocalPlacement"):
            return made
        made = _axes(place.RelativePlacement) @ made
        place = place.PlacementRelTo
    raise Unreadable("placements are nested too deeply")


def _solid(element: Any) -> tuple[np.ndarray, float]:
    """Corners (n, 3) of the extruded solid of an element in its own axes, and its volume; a point and 0 without one."""
    shapes = element.Representation.Representations if element.Representation else ()
    for shape in shapes:
        for item in shape.Items if shape.RepresentationIdentifier in ("Body", None) else ():
            for _ in range(DEEPEST):
                if not item.is_a("IfcBooleanResult"):
                    break
                item = item.FirstOperand
            if item.is_a("IfcExtrudedAreaSolid") and (outline := _outline(item.SweptArea)) is not None:
                way = item.Depth * np.array(item.ExtrudedDirection.DirectionRatios) / np.linalg.norm(item.ExtrudedDirection.DirectionRatios)
                ends = np.concatenate([outline, outline + way])
                volume = abs(signed_area(outline[:, :2]) * way[2])
                return (_axes(item.Position) @ np.column_stack([ends, np.ones(len(ends))]).T).T[:, :3], volume
    return np.zeros((1, 3)), 0.0


def _is_cut(element: Any) -> bool:
    """Whether the solid of an element is cut by another."""
    return any(
        item.is_a("IfcBooleanResult")
        for shape in element.Representation.Representations
        for item in shape.Items
        if shape.RepresentationIdentifier == "Body"
    )


def _outline(profile: Any) -> np.ndarray | None:
    """Corners (n, 3) of a profile in its plane; None of another kind than rectangles and polygons without holes and arcs."""
    if profile.is_a("IfcRectangleProfileDef"):
        x, y = 0.5 * profile.XDim, 0.5 * profile.YDim
        flat = np.array([[-x, -y], [x, -y], [x, y], [-x, y]])
        flat = (_axes(profile.Position)[:2, [0, 1, 3]] @ np.column_stack([flat, np.ones(4)]).T).T
    elif profile.is_a("IfcArbitraryClosedProfileDef") and not profile.is_a("IfcArbitraryProfileDefWithVoids"):
        curve = profile.OuterCurve
        if curve.is_a("IfcPolyline"):
            flat = np.array([p.Coordinates[:2] for p in curve.Points])
        elif curve.is_a("IfcIndexedPolyCurve") and not any(part.is_a("IfcArcIndex") for part in curve.Segments or ()):
            flat = np.array([p[:2] for p in curve.Points.CoordList])
        else:
            return None
    else:
        return None
    return np.column_stack([flat, np.zeros(len(flat))]) if 2 < len(flat) < MOST_CORNERS else None


def _wall(wall: Any, corners: np.ndarray, scale: float) -> dict[str, Any]:
    """A wall in metres: its axis, thickness, heights and openings along it."""
    place = _placed(wall)
    low, high = corners.min(axis=0), corners.max(axis=0)
    long = 0 if high[0] - low[0] >= high[1] - low[1] else 1
    mid, ends = 0.5 * (low + high), []
    for value in (low[long], high[long]):
        point = np.array([*mid, 1.0])
        point[long], point[2] = value, low[2]
        ends.append(scale * (place @ point)[:3])
    a, b = sorted(ends, key=lambda p: (round(float(p[0]), 3), round(float(p[1]), 3)))
    way = (b - a) / np.linalg.norm(b - a)
    foot = float(a[2])
    openings = []
    for relation in wall.HasOpenings:
        opening = relation.RelatedOpeningElement
        found, volume = _solid(opening)
        if not volume > 0.0:
            raise Unreadable(f"wall {wall.Name or wall.GlobalId}: an opening has no extruded solid")
        points = scale * (_placed(opening) @ np.column_stack([found, np.ones(len(found))]).T).T[:, :3]
        s, z = (points - a) @ way, points[:, 2]
        openings.append([float(s.min()), float(s.max()), float(z.min()), float(z.max())])
    return {
        "a": a[:2].tolist(),
        "b": b[:2].tolist(),
        "thickness": scale * float(high[1 - long] - low[1 - long]),
        "foot": foot,
        "head": foot + scale * float(high[2] - low[2]),
        "openings": openings,
    }


def _by_storey(found: dict[str, Any], name: str) -> tuple[list[WrittenWall], list[float]]:
    """Walls of the deck, those above each other as one, and heights of the storeys [m]."""
    walls = found["walls"]
    ground, top = min(w["foot"] for w in walls), max(w["head"] for w in walls)
    levels = [ground, *(z for z in found["elevations"] if ground + 0.5 < z < top - 0.5), top]
    made: list[WrittenWall] = []
    for storey, (low, high) in enumerate(itertools.pairwise(levels), 1):
        own = [
            w
            for w in walls
            if min(w["head"], high) - max(w["foot"], low) > COVERED * (high - low)
            and np.hypot(*np.subtract(w["b"], w["a"])) > LEAST
            and w["thickness"] > CLOSE
        ]
        drawn = [DrawnWall(np.array(w["a"]), np.array(w["b"]), w["thickness"]) for w in own]
        if len(drawn) > MOST_WALLS:
            raise DeckError([f"{name}: storey {storey} has {len(drawn)} walls, but at most {MOST_WALLS} are allowed"])
        for before, wall in zip(own, joined(drawn), strict=True):
            shift = float((np.array(before["a"]) - wall.a) @ wall.way)
            openings = [
                (storey, max(s0 + shift, 0.0), min(s1 + shift, wall.length), max(z0 - low, 0.0), min(z1 - low, high - low - 0.05))
                for s0, s1, z0, z1 in before["openings"]
                if min(z1, high) - max(z0, low) > 0.2
            ]
            same = next(
                (m for m in made if m.last == storey - 1 and max(np.abs(m.a - wall.a).max(), np.abs(m.b - wall.b).max()) < 0.1), None
            )
            if same is None:
                made.append(WrittenWall(wall.a, wall.b, storey, [wall.thickness], openings))
            else:
                same.thicknesses.append(wall.thickness)
                same.openings.extend(openings)
    return made, [high - low for low, high in itertools.pairwise(levels)]
