"""Drawings: closed polylines are blocks, loose lines and arcs are joined to outlines, layers say what they mean."""

import io
import itertools
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import asdict, dataclass, field, replace
from typing import Any

import numpy as np

from extrados.model.errors import BadGeometry
from extrados.model.geometry.drawing import GROUND_LAYER, MOST_BLOCKS, UNITS, Drawing, Layer, Plane, Polygon
from extrados.model.geometry.linework import net_of, place_in
from extrados.model.geometry.polygons import inside, signed_area
from extrados.schema.contained import Unreadable, read_contained
from extrados.schema.files import File

# DXF $INSUNITS -> our unit
INSUNITS = {1: "in", 2: "ft", 4: "mm", 5: "cm", 6: "m"}
SAGITTA = 2e-4  # m: how far the chords of an arc may lie from it
CURVES = {"LINE", "ARC", "LWPOLYLINE", "POLYLINE", "SPLINE", "ELLIPSE", "CIRCLE"}
#: What a drawing holds beside lines, and what to call it
LEFT_OUT = {
    "HATCH": "hatch",
    "MPOLYGON": "hatch",
    "TEXT": "text",
    "MTEXT": "text",
    "ATTDEF": "text",
    "ATTRIB": "text",
    "DIMENSION": "dimension",
    "ARC_DIMENSION": "dimension",
    "LEADER": "leader",
    "MULTILEADER": "leader",
    "MLEADER": "leader",
    "POINT": "point",
    "VIEWPORT": "viewport",
    "SOLID": "solid fill",
    "TRACE": "solid fill",
    "WIPEOUT": "wipeout",
    "IMAGE": "image",
    "PDFUNDERLAY": "underlay",
    "DWFUNDERLAY": "underlay",
    "DGNUNDERLAY": "underlay",
    "XLINE": "construction line",
    "RAY": "construction line",
    "TOLERANCE": "text",
    "OLE2FRAME": "embedded object",
}
MOST_ENTITIES = 200_000
MOST_LINES = 200_000
MOST_VERTICES = 2_000_000  # of all lines, those of arcs and curves by their chords
DEEPEST = 16  # blocks within blocks
FARTHEST = 1e15  # of a coordinate, in units of the drawing: double precision tells no unit apart beyond
FLAT = 1e-6  # of the extent of a drawing: across its plane it has less
NEAR = 0.1  # m: gaps of loose lines up to this are told


@dataclass
class _Read:
    """What has been read so far, in the unit of the drawing."""

    closed: list[tuple[str, str, np.ndarray]] = field(default_factory=list)  # layer, handle, vertices
    open: list[tuple[str, str, np.ndarray]] = field(default_factory=list)
    ground: list[np.ndarray] = field(default_factory=list)
    marks: dict[str, list[np.ndarray]] = field(default_factory=dict)
    left_out: Counter[str] = field(default_factory=Counter)
    other_layers: Counter[str] = field(default_factory=Counter)
    hidden: Counter[tuple[str, str]] = field(default_factory=Counter)  # layer, why
    vertices: int = 0


def read_dxf(
    file: File,
    unit: str | None = None,
    layers: list[str] | None = None,
    meaning: Mapping[str, Layer] | None = None,
    join_tolerance: float = 1e-3,
    sagitta: float = SAGITTA,
    plane: Plane | None = "xy",
) -> Drawing:
    """Blocks, ground and marks of a drawing. Needs the extra `dxf` (ezdxf), which reads in a process of its own.

    layers: those to read as stones, all where it is None; none where it is empty, for drawings of lines. meaning: layers that are something else than plain stones;
    GROUND is the ground. Ends of loose lines within `join_tolerance` [m] are one point; `sagitta` [m]: how far
    chords may lie from curves. plane: that of the section, the second axis upwards; None for that in which all lines lie. What the drawing does not show is not read: invisible entities, and layers that are frozen or
    off unless `layers` or `meaning` names them. BadGeometry names layer and entity; a drawing without a unit is refused
    until `unit` is given.
    """
    name = file.path.name
    try:
        found = read_contained(
            "extrados.model.geometry.dxf:parse_dxf",
            file.content,
            ["ezdxf"],
            name=name,
            unit=unit,
            layers=layers,
            meaning={layer: asdict(one) for layer, one in (meaning or {}).items()},
            join_tolerance=join_tolerance,
            sagitta=sagitta,
            plane=plane,
        )
    except Unreadable as error:
        raise BadGeometry(str(error) if error.at else f"{name}: {error}", error.at or ("structure",)) from None
    return Drawing(**{**found, "blocks": [Polygon(**block) for block in found["blocks"]]})


def parse_dxf(content: bytes, name: str, meaning: Mapping[str, Mapping[str, Any]], **how: Any) -> dict[str, Any]:
    """The fields of the Drawing in the content of a file. The contained process calls this; Unreadable gives the reason."""
    try:
        return asdict(drawing_of(content, name, meaning={k: Layer(**one) for k, one in meaning.items()}, **how))
    except BadGeometry as error:
        raise Unreadable(str(error), error.at) from None


def drawing_of(
    content: bytes,
    name: str,
    unit: str | None = None,
    layers: list[str] | None = None,
    meaning: Mapping[str, Layer] | None = None,
    join_tolerance: float = 1e-3,
    sagitta: float = SAGITTA,
    plane: Plane | None = "xy",
) -> Drawing:
    """The drawing in the content of a file, as `read_dxf` has it, read by this process."""
    document = _document(content, name)
    scale = UNITS[unit or _unit(name, int(document.header.get("$INSUNITS", 0)))]
    known = {k.upper(): v for k, v in (meaning or {}).items()}
    known.setdefault(GROUND_LAYER, Layer("ground"))
    _refuse_many(document, name)
    found = _Read()
    seen = set()
    named = {one.upper() for one in (*(layers or []), *(meaning or {}))}
    hides = _Hiding(document, named)
    for count, (entity, layer) in enumerate(_entities(document, name, hides)):
        if count >= MOST_ENTITIES:
            raise BadGeometry(_too_many(name))
        seen.add(layer)
        means = known.get(layer.upper(), Layer())
        if why := hides(entity, layer):
            found.hidden[hides.names.get(layer.upper(), layer), why] += 1
        elif means.role == "left-out":
            found.other_layers[layer] += 1
        elif means.role != "stones" or layers is None or layer in layers or layer.upper() in known:
            _take(entity, layer, means, found, name, sagitta / scale)
        else:
            found.other_layers[layer] += 1
    for missing in [one for one in (*(layers or []), *(meaning or {})) if one.upper() not in {s.upper() for s in seen}]:
        raise BadGeometry(f"{name}: layer '{missing}' does not exist; the layers are {', '.join(sorted(seen)) or 'none'}")
    notes = _project(found, plane)
    made = _drawing(found, known, name, scale, join_tolerance, layers != [])
    return replace(made, notes=(*made.notes, *(f"{name}: {note}" for note in notes)))


def _project(found: _Read, plane: Plane | None) -> list[str]:
    """Lines (n, 3) become those in the plane of the section (n, 2); None for the plane in which they all lie. What to tell of it."""
    rows = [points for _, _, points in (*found.closed, *found.open)]
    places = np.concatenate([*rows, *found.ground, *(line for lines in found.marks.values() for line in lines), np.zeros((0, 3))])
    extent = np.ptp(places, axis=0) if len(places) else np.zeros(3)
    flat = extent <= FLAT * extent.max()
    lies: Plane = "xy" if flat[2] or not flat.any() else "xz" if flat[1] else "yz"
    used = plane or lies
    axes = ["xyz".index(letter) for letter in used]
    for lines in (found.closed, found.open):
        lines[:] = [(layer, handle, points[:, axes]) for layer, handle, points in lines]
    found.ground = [points[:, axes] for points in found.ground]
    found.marks = {layer: [points[:, axes] for points in lines] for layer, lines in found.marks.items()}
    (across,) = {0, 1, 2} - set(axes)
    if not flat[across]:
        return [
            (
                f"the lines are projected to the plane {used}, although along {'xyz'[across]} they extend over {extent[across]:.4g} "
                "units of the drawing. The key `section` chooses another plane"
            )
        ]
    return [] if used == "xy" else [f"the section lies in the plane {used}: {used[0]} is horizontal, z is vertical"]


class _Hiding:
    """Why a drawing itself does not show an entity: it is invisible, its layer is frozen or off, unless the deck names that, or
    it refers to another drawing."""

    def __init__(self, document: Any, named: set[str]):
        self.elsewhere = {block.name.lower() for block in document.blocks if block.block.is_xref or block.block.is_xref_overlay}
        self.names = {layer.dxf.name.upper(): layer.dxf.name for layer in document.layers}
        self.layers = {
            layer.dxf.name.upper(): "frozen" if layer.is_frozen() else "off"
            for layer in document.layers
            if (layer.is_frozen() or layer.is_off()) and layer.dxf.name.upper() not in named
        }

    def __call__(self, entity: Any, layer: str) -> str:
        """A word, empty where the entity on the layer is shown. A layer that is off hides no reference to a block, only what of the
        block lies on the layer itself."""
        if _get(entity, "invisible", 0):
            return "invisible"
        why = self.layers.get(layer.upper(), "")
        if entity.dxftype() != "INSERT":
            return why
        if entity.dxf.name.lower() in self.elsewhere:
            return "reference to another drawing"
        return "" if why == "off" else why


def _document(data: bytes, name: str) -> Any:
    try:
        from ezdxf.filemanagement import dxf_stream_info, read
        from ezdxf.lldxf.const import DXFError
    except ImportError:
        raise BadGeometry("reading DXF requires ezdxf. Install it by pip install 'extrados[dxf]'") from None
    if data.startswith(b"AutoCAD Binary DXF"):
        raise BadGeometry(f"{name}: this is a binary DXF file: save it as text (ASCII DXF)")
    try:
        head = dxf_stream_info(io.StringIO(data[:100_000].decode("latin-1")))
        return read(io.StringIO(data.decode(head.encoding, errors="surrogateescape"), newline=None))
    except (DXFError, UnicodeError, LookupError, ValueError, ArithmeticError, OSError, StopIteration) as error:
        raise BadGeometry(f"{name}: this is not a valid DXF file: {error or 'it ends too early'}") from None


def _unit(name: str, code: int) -> str:
    if code not in INSUNITS:
        what = "the drawing has no unit ($INSUNITS = 0)" if code == 0 else f"the drawing has an unknown unit ($INSUNITS = {code})"
        raise BadGeometry(f'{name}: {what}. Give the key `unit`, such as unit = "mm" (expected one of {", ".join(UNITS)})')
    return INSUNITS[code]


def _refuse_many(document: Any, name: str) -> None:
    """BadGeometry where references to blocks come to more than MOST_ENTITIES: counted first, since to put them in their
    places takes ezdxf minutes. Those without end, or to what is not there, `_entities` tells."""
    counts: dict[str, int] = {}

    def count(entities: Iterable[Any], depth: int) -> int:
        total = 0
        for entity in entities:
            total += 1
            if entity.dxftype() == "INSERT" and depth <= DEEPEST and entity.dxf.name in document.blocks:
                block = entity.dxf.name.lower()
                if block not in counts:
                    counts[block] = 0  # while it is counted: one within itself
                    counts[block] = count(document.blocks[block], depth + 1)
                # the places of a grid without distances are one, which ezdxf finds by looking at each
                total += max(entity.dxf.row_count, 1) * max(entity.dxf.column_count, 1) * (1 + counts[block])
            if total > MOST_ENTITIES:
                raise BadGeometry(_too_many(name))
        return total

    count(document.modelspace(), 1)


def _too_many(name: str) -> str:
    return f"{name}: the drawing has more than {MOST_ENTITIES:,} entities, including those of inserted blocks"


def _entities(document: Any, name: str, hides: _Hiding) -> Iterator[tuple[Any, str]]:
    """All entities with their layers, those of block references in their places unless the reference itself is hidden; within
    a block, what lies on layer 0 lies on the layer of the reference."""

    def within(entity: Any, layer: str, depth: int) -> Iterator[tuple[Any, str]]:
        if entity.dxftype() != "INSERT" or hides(entity, layer):
            yield entity, layer
            return
        if depth > DEEPEST:
            raise BadGeometry(f"{name}: block '{entity.dxf.name}' is nested more than {DEEPEST} levels deep, or contains itself")
        if entity.dxf.name not in document.blocks:
            raise BadGeometry(f"{name}: layer '{layer}': the inserted block '{entity.dxf.name}' does not exist")
        try:
            placed = [list(one.virtual_entities()) for one in (entity.multi_insert() if entity.mcount > 1 else (entity,))]
        except MemoryError:
            raise
        except Exception as error:  # whatever ezdxf raises, at an axis of no length or a dimension without its parts
            raise BadGeometry(f"{name}: layer '{layer}': block '{entity.dxf.name}' cannot be inserted: {error}") from None
        for parts in placed:
            for part in parts:
                yield from within(part, layer if _layer(part) == "0" else _layer(part), depth + 1)

    for entity in document.modelspace():
        yield from within(entity, _layer(entity), 1)


def _get(entity: Any, name: str, default: Any) -> Any:
    """An attribute of an entity; those of unknown kinds have none."""
    return entity.dxf.get(name, default) if entity.dxf.is_supported(name) else default


def _layer(entity: Any) -> str:
    return _get(entity, "layer", "0")


def _take(entity: Any, layer: str, means: Layer, found: _Read, name: str, sagitta: float) -> None:
    """Sort one entity in; what is no line is counted as left out."""
    kind = entity.dxftype()
    if kind not in CURVES:
        if kind not in LEFT_OUT:
            raise BadGeometry(
                f"{name}: layer '{layer}', {kind}{_handle(entity)}: this entity is neither a line nor an arc. Explode it, or give "
                "the layers to read (layers = [...])"
            )
        found.left_out[LEFT_OUT[kind]] += 1
        return
    if kind == "POLYLINE" and not (entity.is_2d_polyline or entity.is_3d_polyline):
        raise BadGeometry(f"{name}: layer '{layer}', POLYLINE: this entity is a mesh; draw a section with lines")
    try:
        points = _flattened(entity, kind, sagitta)
    except BadGeometry as error:
        raise BadGeometry(f"{name}: layer '{layer}', {kind}{_handle(entity)}: {error}") from None
    if len(points) < 2:
        return
    found.vertices += len(points)
    if found.vertices > MOST_VERTICES:
        raise BadGeometry(f"{name}: the lines, and the chords of the curves, have more than {MOST_VERTICES:,} vertices")
    if means.role == "ground":
        found.ground.append(points)
    elif means.role == "joints":
        found.marks.setdefault(layer, []).append(points)
    elif getattr(entity, "is_closed", False) or _meet(points):
        found.closed.append((layer, entity.dxf.handle or "", points))
    else:
        found.open.append((layer, entity.dxf.handle or "", points))


def _handle(entity: Any) -> str:
    return f" #{entity.dxf.handle}" if entity.dxf.handle else ""


def _flattened(entity: Any, kind: str, sagitta: float) -> np.ndarray:
    """Vertices (n, 3) of a line or curve, its chords within `sagitta` of it; BadGeometry where there would be too many, or
    a number is none. Arcs are followed as arcs: the Bezier curves of ezdxf's paths leave them by 0.3 mm a metre of radius."""
    places: Iterable[Any]
    try:
        if kind in ("LWPOLYLINE", "POLYLINE"):
            places = _polyline(entity, kind, sagitta)
        elif kind == "LINE":
            places = [entity.dxf.start, entity.dxf.end]
        else:
            _refuse_wide(entity, kind, sagitta)
            places = entity.flattening(sagitta)
        found = [(p[0], p[1], p[2]) for p in itertools.islice(places, MOST_LINES + 1)]
    except BadGeometry:
        raise
    except (ArithmeticError, ValueError, IndexError, RecursionError) as error:  # of ezdxf, at a curve that is none
        raise BadGeometry(f"this curve cannot be evaluated: {error}") from None
    if len(found) > MOST_LINES:
        raise BadGeometry(_many(sagitta))
    points = np.array(found).reshape(-1, 3)
    if not np.isfinite(points).all():
        raise BadGeometry("a coordinate is not a finite number")
    if np.abs(points).max(initial=0.0) > FARTHEST:
        raise BadGeometry(f"a coordinate is larger than {FARTHEST:.0e}")
    return points


def _many(sagitta: float) -> str:
    return f"a curve requires more than {MOST_LINES:,} chords with a sagitta of {sagitta:.2g} drawing units: check the scale of the drawing"


def _refuse_wide(entity: Any, kind: str, sagitta: float) -> None:
    """BadGeometry where a curve holds what is no number, or is so wide that chords near it would fill the memory."""
    if kind == "CIRCLE":
        size = np.array([entity.dxf.radius])
    elif kind == "ARC":  # its chords are as the root of the radius, and as its share of a turn
        share = ((entity.dxf.end_angle - entity.dxf.start_angle) % 360.0 or 360.0) / 360.0
        size = np.array([entity.dxf.radius * share**2])
    elif kind == "ELLIPSE":
        size = np.array([*entity.dxf.major_axis, entity.dxf.ratio * entity.dxf.major_axis.magnitude])
    else:
        points = np.array([*entity.control_points, *entity.fit_points], dtype=float).reshape(-1, 3)
        size = np.ptp(points, axis=0) if len(points) else np.zeros(1)
        if not np.isfinite([*entity.knots, *entity.weights]).all():
            raise BadGeometry("a knot or a weight of this curve is not a finite number")
    if not np.isfinite(size).all():
        raise BadGeometry("a coordinate is not a finite number")
    if np.sqrt(np.abs(size).max() / sagitta) > MOST_LINES:  # a circle takes 2.2 times as many
        raise BadGeometry(_many(sagitta))


def _polyline(entity: Any, kind: str, sagitta: float) -> list[Any]:
    """The vertices of a polyline, with those of the chords of its arcs."""
    if kind == "POLYLINE" and entity.is_3d_polyline:
        places = [tuple(vertex.dxf.location) for vertex in entity.vertices]
        return [*places, *places[:1]] if entity.is_closed else places
    if kind == "LWPOLYLINE":
        rows = np.array(entity.get_points("xyb"), dtype=float).reshape(-1, 3)
    else:
        rows = np.array([(*v.dxf.location.vec2, v.dxf.bulge) for v in entity.vertices], dtype=float).reshape(-1, 3)
    if not np.isfinite(rows).all():
        raise BadGeometry("this entity contains a number that is not finite")
    if entity.is_closed and len(rows):
        rows = np.concatenate([rows, rows[:1]])
    flat = [rows[:1, :2]]
    count = 1
    for a, b in itertools.pairwise(rows):
        flat.append(_bulged(a[:2], b[:2], a[2], sagitta))
        count += len(flat[-1])
        if count > MOST_LINES:
            raise BadGeometry(_many(sagitta))
    return list(entity.ocs().points_to_wcs([(x, y, 0.0) for x, y in np.concatenate(flat).tolist()]))


def _bulged(a: np.ndarray, b: np.ndarray, bulge: float, sagitta: float) -> np.ndarray:
    """Points (n, 2) after a up to b along the arc of a polyline; bulge is the tangent of a quarter of its angle."""
    chord = b - a
    turn = 4.0 * np.arctan(bulge)
    half = abs(np.sin(0.5 * turn))
    if half == 0.0 or not chord.any():
        return b[None]
    radius = float(np.hypot(*chord)) / float(2.0 * half)
    # 1 - cos(t) = 2 sin(t / 2)^2, which keeps its figures where the arc is wide or nearly straight
    step = 4.0 * np.arcsin(min(np.sqrt(0.5 * sagitta / radius), 1.0))
    if not abs(turn) <= MOST_LINES * step:
        raise BadGeometry(_many(sagitta))
    count = max(int(np.ceil(abs(turn) / step)), 1)
    left = np.array([-chord[1], chord[0]])
    centre = 0.5 * (a + b) + 0.5 * left / np.tan(0.5 * turn)
    angle = turn * np.arange(1, count) / count
    arm, side = a - centre, np.array([-(a - centre)[1], (a - centre)[0]])
    return np.concatenate([centre + np.cos(angle)[:, None] * arm + np.sin(angle)[:, None] * side, b[None]])


def _meet(points: np.ndarray) -> bool:
    """Whether a line ends where it begins; ezdxf's own test is too coarse for georeferenced coordinates."""
    return len(points) > 3 and float(np.linalg.norm(points[-1] - points[0])) < 1e-6 * float(np.ptp(points, axis=0).max())


def _segments(lines: list[np.ndarray]) -> np.ndarray:
    pieces = [np.column_stack([line[:-1], line[1:]]) for line in lines]
    return np.concatenate(pieces) if pieces else np.empty((0, 4))


def _drawing(found: _Read, known: Mapping[str, Layer], name: str, scale: float, tolerance: float, stones: bool) -> Drawing:
    """Blocks with names, joined where they are loose lines. stones: whether there must be any."""
    notes, loose = [], []
    outlines = [(layer, handle, scale * points) for layer, handle, points in found.closed]
    if found.open:
        lines = [scale * points for _, _, points in found.open]
        pieces = [_segments([line]) for line in lines]
        rims = [_segments([np.concatenate([points, points[:1]])]) for _, _, points in outlines]
        if sum(map(len, [*pieces, *rims])) > MOST_LINES:
            raise BadGeometry(f"{name}: the drawing has more than {MOST_LINES} pieces of lines")
        of = np.repeat(np.arange(len(pieces) + len(rims)), [len(p) for p in (*pieces, *rims)])
        net = net_of(np.concatenate([*pieces, *rims]), tolerance, NEAR, firm=of >= len(pieces))
        closed = [points for _, _, points in outlines]
        low, high = (np.array([end(p, axis=0) for p in closed]).reshape(-1, 2) for end in (np.min, np.max))
        for face, source in zip(net.faces, net.source, strict=True):
            drawn = of[source]
            rim = np.hypot(*(np.roll(face, -1, axis=0) - face).T).sum()
            if 2.0 * signed_area(face) < tolerance * rim:
                continue  # a sliver between two lines that mean one
            place = place_in(face)
            around = np.flatnonzero((low <= place).all(axis=1) & (place <= high).all(axis=1)).tolist()
            if (drawn >= len(pieces)).all() or any(inside(closed[k], place[None])[0] for k in around):
                continue  # it lies in an outline that is closed as drawn
            layer = Counter(found.open[k][0] for k in drawn.tolist() if k < len(pieces)).most_common(1)[0][0]
            outlines.append((layer, "", face))
        loose = [(end.place, end.gap) for end in net.loose]
        notes.append(
            f"{len(outlines) - len(closed)} blocks were joined from {len(lines)} loose lines and arcs whose "
            f"ends are within {1000.0 * tolerance:g} mm (`join_tolerance`)"
        )
    if found.hidden:
        told = ", ".join(f"{n} of layer '{layer}' ({why})" for (layer, why), n in sorted(found.hidden.items()))
        notes.append(f"entities that the drawing does not display are not read: {told}")
    if not outlines and stones:
        near = [gap for _, gap in loose if gap is not None]
        hint = f"; ends of lines are at least {1000.0 * min(near):.3g} mm apart (see `join_tolerance`)" if near else ""
        hint += f"; {notes[-1]}" if found.hidden else ""
        raise BadGeometry(f"{name}: the layers read contain no closed polyline, and no lines that form a closed outline{hint}")
    if len(outlines) > MOST_BLOCKS:
        raise BadGeometry(f"{name}: more than {MOST_BLOCKS} blocks")
    if found.left_out:
        told = ", ".join(f"{n} of {what}" for what, n in sorted(found.left_out.items()))
        notes.append(f"entities that are not lines are ignored: {told}")
    if found.other_layers:
        notes.append(f"layers that are not read: {', '.join((f'{layer} ({n})' for layer, n in sorted(found.other_layers.items())))}")
    polygons, numbers = [], itertools.count(1)
    taken: Counter[str] = Counter()
    for layer, handle, points in outlines:
        title = f"{layer} #{handle}" if handle else f"{layer} {next(numbers)}"
        taken[title] += 1
        if taken[title] > 1:  # entities of a block that is referred to several times have one handle
            title = f"{title} ({taken[title]})"
        polygons.append(Polygon(title, points, layer=layer, material=known[layer.upper()].material if layer.upper() in known else None))
    ground = scale * _segments(found.ground) if found.ground else None
    marks = {layer: scale * _segments(lines) for layer, lines in found.marks.items()}
    return Drawing(polygons, ground, marks, tuple(f"{name}: {note}" for note in notes), tuple(loose))
