"""Handles of the drawing: points that can be dragged, and the keys of the deck that follow from their places. Places are in the
coordinates of the building [m]; values are those of the deck, in SI and degrees."""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np

from extrados import kinds
from extrados.model.errors import BadGeometry
from extrados.model.geometry.assembly import GROUND, Assembly
from extrados.model.geometry.polygons import inside
from extrados.model.structure import Structure
from extrados.model.ties import Tie

#: More vertices than these are not for hands
MOST_VERTICES = 400
#: Ties with handles
MOST_TIES = 8
#: Openings of a wall whose edges have handles
MOST_OPENINGS = 6
Changes = dict[str, Any]


@dataclass(frozen=True)
class Handle:
    """A handle: its place (x, y), its value with unit, and its direction for the eye, "x", "y" or "both".

    value_at: the value where a hand leads it; changes: keys and their new values for a value. holds: the place of the
    building's origin stays while it is moved, else that of its supports.
    """

    name: str
    label: str
    unit: str
    x: float
    y: float
    value: Any
    value_at: Callable[[float, float], Any]
    changes: Callable[[Any], Changes]
    along: str = "x"
    holds: bool = False
    least: float = 0.0
    most: float | None = None
    step: float | None = field(default=None)


@dataclass(frozen=True)
class KindHandles:
    """The handles of a kind of structure: their maker (table, blocks), and the place that stays when the sizes change
    (table, blocks) [m]; None for the origin."""

    make: Callable[[Any, Any], Iterator[Handle]]
    anchor: Callable[[Any, Assembly], np.ndarray] | None = None


def kind_handles(structure: Structure) -> KindHandles | None:
    """The handles of the kind of a structure; None for a kind without handles."""
    place = kinds.STRUCTURES[structure.kind].handles
    return None if place is None else kinds.load(place)


def anchor_of(structure: Structure, assembly: Assembly) -> np.ndarray:
    """The place of the building that stays in the drawing when its sizes change [m]."""
    known = kind_handles(structure)
    return np.zeros(2) if known is None or known.anchor is None else known.anchor(structure, assembly)


def handles_of(structure: Structure, assembly: Assembly | None) -> list[Handle]:
    """The handles of a building in the order of the Tab key; assembly: its blocks, if it has any."""
    known = kind_handles(structure)
    return [] if known is None else list(known.make(structure, assembly))


def _centre_of_springings(arch: Any, _: Assembly) -> np.ndarray:
    return np.array([0.0, arch.radius * math.cos(0.5 * math.radians(arch.embrace))])


def _ground(_: Any, assembly: Assembly) -> np.ndarray:
    grounded = np.flatnonzero((assembly.a == GROUND) | (assembly.b == GROUND))
    return np.array([0.0, float(assembly.middle[grounded, 1].min())])


def _key(name: str) -> Callable[[Any], Changes]:
    return lambda value: {f"structure.{name}": value}


def _length(
    name: str,
    label: str,
    x: float,
    y: float,
    value: float,
    value_at: Callable[[float, float], float],
    along: str = "x",
    holds: bool = False,
    changes: Callable[[Any], Changes] | None = None,
) -> Handle:
    return Handle(name, label, "m", x, y, value, value_at, changes or _key(name), along, holds)


def _angle(name: str, label: str, x: float, y: float, value: float, centre: tuple[float, float]) -> Handle:
    """An angle of embrace by the place of the right springing, as seen from the centre."""

    def value_at(px: float, py: float) -> float:
        half = math.degrees(math.atan2(px - centre[0], py - centre[1]))
        return min(2.0 * (half if half > 0.0 else 180.0 if py < centre[1] else 0.1), 270.0)

    return Handle(name, label, "deg", x, y, value, value_at, _key(name), "both", True, 20.0, 270.0)


def _arch(s: Any, _: Assembly) -> Iterator[Handle]:
    r, t, half = s.radius, s.thickness * s.thickness_factor, 0.5 * math.radians(s.embrace)
    low = r * math.cos(half)
    span, rise = 2.0 * r * math.sin(half), r - low

    def by(span: float, rise: float) -> Changes:
        """Radius and embrace of an arc by its span and rise."""
        span, rise = max(span, 1e-3), max(rise, 1e-3)
        radius = (0.25 * span**2 + rise**2) / (2.0 * rise)
        return {"structure.radius": radius, "structure.embrace": math.degrees(4.0 * math.atan2(2.0 * rise, span))}

    yield _length("thickness", "Thickness", 0.0, r + 0.5 * t, s.thickness, lambda x, y: 2.0 * (y - r) / s.thickness_factor, "y", True)
    at = -0.5 * half
    yield _length("radius", "Radius of the centre line", r * math.sin(at), r * math.cos(at), r, lambda x, y: math.hypot(x, y), "both", True)
    outer = r + 0.5 * t
    yield _angle("embrace", "Angle of embrace", outer * math.sin(half), outer * math.cos(half), s.embrace, (0.0, 0.0))
    yield _length(
        "span", "Span of the centre line", -r * math.sin(half), low, span, lambda x, y: -2.0 * x, "x", False, lambda value: by(value, rise)
    )
    yield _length(
        "rise", "Rise of the centre line", 0.0, r - 0.5 * t, rise, lambda x, y: y + 0.5 * t - low, "y", False, lambda value: by(span, value)
    )


def _vault(s: Any, assembly: Assembly) -> Iterator[Handle]:
    r, t, half = s.radius, s.thickness, 0.5 * math.radians(s.embrace)
    outer = r + 0.5 * t
    base = float(_ground(s, assembly)[1])
    start = s.face if s.width_from == "face" else outer * math.sin(half)
    yield _length("buttress_width", "Width of the buttresses", start + s.buttress_width, base, s.buttress_width, lambda x, y: x - start)
    yield _length("thickness", "Thickness of the vault", 0.0, outer, t, lambda x, y: 2.0 * (y - r), "y", True)
    at = -0.4 * half
    yield _length(
        "radius", "Radius of the vault's centre line", r * math.sin(at), r * math.cos(at), r, lambda x, y: math.hypot(x, y), "both", True
    )
    yield _angle("embrace", "Angle of embrace of the vault", outer * math.sin(half), outer * math.cos(half), s.embrace, (0.0, 0.0))
    top = outer * math.cos(half) if s.height_to == "extrados" else 0.0
    across = -(start + 0.5 * s.buttress_width) if s.height_to == "extrados" else 0.0
    yield _length("height", "Height above the ground", across, top, s.height, lambda x, y: y - base, "y")
    yield _length("face", "Distance of the inner faces of the buttresses from the axis", -s.face, base, s.face, lambda x, y: -x)


def _church(s: Any, _: Assembly) -> Iterator[Handle]:
    r, t, c, half = s.radius, s.thickness, s.springing, 0.5 * math.radians(s.embrace)
    inner, outer = r - 0.5 * t, r + 0.5 * t
    side = -1.0 if s.right is not None else 1.0  # the side that the table's own keys speak of
    back = inner + s.pier_width
    top = c + outer * math.cos(half) if s.pier_top is None else s.pier_top
    yield _length("thickness", "Thickness of the nave vault", 0.0, c + outer, t, lambda x, y: 2.0 * (y - c - r), "y")
    at = -side * 0.45 * half
    yield _length(
        "radius", "Radius of the nave's centre line", r * math.sin(at), c + r * math.cos(at), r, lambda x, y: math.hypot(x, y - c), "both"
    )
    yield _length("springing", "Height of the nave's centre", 0.0, c, c, lambda x, y: y, "y")
    yield _length("pier_width", "Width of the piers", -side * back, 0.0, s.pier_width, lambda x, y: -side * x - inner)
    yield _length("pier_top", "Height of the piers", -side * 0.5 * (inner + back), top, top, lambda x, y: y, "y")
    if not s.aisles:
        return
    width = s.buttress_width
    span = s.aisle_span if s.aisle_span is not None else s.half_width - inner - s.pier_width - width
    middle, end = side * (back + 0.5 * span), back + span
    low = s.aisle_springing
    yield _length(
        "aisle_thickness",
        "Thickness of the aisle vaults",
        middle,
        low + 0.5 * span + s.aisle_thickness,
        s.aisle_thickness,
        lambda x, y: y - low - 0.5 * span,
        "y",
    )
    yield _length("aisle_springing", "Height of the aisle vaults' centres", middle, low, low, lambda x, y: y, "y")
    if s.aisle_span is not None:
        yield _length("aisle_span", "Clear span of the aisles", side * end, 0.0, span, lambda x, y: side * x - back)
        yield _length("buttress_width", "Width of the outer buttresses", side * (end + width), 0.0, width, lambda x, y: side * x - end)
    else:
        yield _length(
            "half_width",
            "Distance of the outer faces of the buttresses from the axis",
            side * s.half_width,
            0.0,
            s.half_width,
            lambda x, y: side * x,
        )
        yield _length("buttress_width", "Width of the outer buttresses", side * end, 0.0, width, lambda x, y: s.half_width - side * x)
    aisle_outer = 0.5 * span + s.aisle_thickness
    high = s.buttress_top or low + aisle_outer * math.cos(0.5 * math.radians(s.aisle_embrace))
    yield _length("buttress_top", "Height of the outer buttresses", side * (end + 0.5 * width), high, high, lambda x, y: y, "y")
    if s.flyer is not None:
        for name, label, x in (("head", "Height of the head of the flyers", back), ("foot", "Height of the foot of the flyers", end)):
            yield _length(f"flyer.{name}", label, side * x, getattr(s.flyer, name), getattr(s.flyer, name), lambda x, y: y, "y")


def _block(s: Any, _: Assembly) -> Iterator[Handle]:
    if s.width is not None and s.height is not None:
        yield _length("width", "Width", 0.5 * s.width, 0.5 * s.height, s.width, lambda x, y: 2.0 * x)
        yield _length("height", "Height", 0.0, s.height, s.height, lambda x, y: y, "y")


def _panel(s: Any, _: Assembly | None) -> Iterator[Handle]:
    if s.width is not None and s.height is not None:
        yield _length("width", "Width", s.width, 0.5 * s.height, s.width, lambda x, y: x)
        yield _length("height", "Height", 0.5 * s.width, s.height, s.height, lambda x, y: y, "y")
        yield from _openings(s.openings)


def _openings(openings: list[Any]) -> Iterator[Handle]:
    """The four edges of each opening of a wall."""
    for i, opening in enumerate(openings[:MOST_OPENINGS]):
        middle = [0.5 * sum(opening.x), 0.5 * sum(opening.y)]
        number = "" if len(openings) == 1 else f" of opening {i + 1}"
        for axis, ends, words in (("x", opening.x, ("Left", "Right")), ("y", opening.y, ("Lower", "Upper"))):
            for k, word in enumerate(words):
                x, y = (ends[k], middle[1]) if axis == "x" else (middle[0], ends[k])
                yield _length(
                    f"openings.{i}.{axis}.{k}",
                    f"{word} edge{number or ' of the opening'}",
                    x,
                    y,
                    ends[k],
                    (lambda x, y: x) if axis == "x" else (lambda x, y: y),
                    axis,
                )


def _brickwork(s: Any, _: Assembly) -> Iterator[Handle]:
    wide, high = s.units * s.unit_length, s.courses * s.unit_height
    yield _length(
        "unit_length",
        "Length of a unit (brick or block). The handle changes the length of the wall; the number of units stays the same",
        wide,
        0.5 * high,
        s.unit_length,
        lambda x, y: x / s.units,
    )
    yield _length(
        "unit_height",
        "Height of a unit (brick or block). The handle changes the height of the wall, not the number of courses",
        0.5 * wide,
        high,
        s.unit_height,
        lambda x, y: y / s.courses,
        "y",
    )
    yield from _openings(s.openings)


def _width_about(middle: float, x: float, y: float) -> float:
    """Width of what is symmetric about `middle` and ends at x."""
    return 2.0 * (x - middle)


def _height_above(low: float, x: float, y: float) -> float:
    """Height of what begins at `low` and ends at y."""
    return y - low


def _stack(s: Any, assembly: Assembly) -> Iterator[Handle]:
    """Two blocks: of each its right side and its head."""
    for name, outline in zip(("lower", "upper"), assembly.outlines, strict=True):
        (x0, y0), (x1, y1) = outline.min(axis=0).tolist(), outline.max(axis=0).tolist()
        middle = 0.5 * (x0 + x1)
        yield _length(f"{name}_width", f"Width of the {name} block", x1, 0.5 * (y0 + y1), x1 - x0, partial(_width_about, middle))
        yield _length(f"{name}_height", f"Height of the {name} block", middle, y1, y1 - y0, partial(_height_above, y0), "y")


def _frame(s: Any, assembly: Assembly) -> Iterator[Handle]:
    """The last column and the lintel."""
    *columns, lintel = assembly.outlines
    middle, first = (0.5 * float(o[:, 0].min() + o[:, 0].max()) for o in (columns[-1], columns[0]))
    top = float(lintel[:, 1].max())
    yield _length("width", "Width of the columns", middle + 0.5 * s.width, 0.5 * s.height, s.width, lambda x, y: 2.0 * (x - middle))
    yield _length("height", "Height of the columns", first, s.height, s.height, lambda x, y: y, "y")
    yield _length("lintel_height", "Height of the lintel", 0.5 * (first + middle), top, s.lintel_height, lambda x, y: y - s.height, "y")
    share = (middle - 0.5 * (first + middle)) / s.spacing  # the drawing is centred
    yield _length("spacing", "Spacing of the columns", middle, 0.0, s.spacing, lambda x, y: (x - 0.5 * (first + middle)) / share)


def _column(s: Any, assembly: Assembly) -> Iterator[Handle]:
    yield _length("width", "Width at the base", 0.5 * s.width, 0.0, s.width, lambda x, y: 2.0 * x)
    high = float(max(o[:, 1].max() for o in assembly.outlines))
    if s.height is not None:
        yield _length("height", "Height", 0.0, high, s.height, lambda x, y: y, "y")
    wide = s.top_width or s.width
    yield _length("top_width", "Width at the top", 0.5 * wide, high, wide, lambda x, y: 2.0 * x)


def _pointed(s: Any, _: Assembly) -> Iterator[Handle]:
    rise = math.sqrt(max(s.radius * s.span - 0.25 * s.span**2, 0.0))
    yield _length("thickness", "Thickness", 0.5 * s.span + s.thickness, 0.0, s.thickness, lambda x, y: x - 0.5 * s.span)
    yield _length("span", "Clear span", -0.5 * s.span, 0.0, s.span, lambda x, y: -2.0 * x)
    yield _length(
        "radius",
        "Radius of the intrados. The handle changes the rise",
        0.0,
        rise,
        s.radius,
        lambda x, y: (max(y, 0.0) ** 2 + 0.25 * s.span**2) / s.span,
        "y",
    )


def _elliptical(s: Any, _: Assembly) -> Iterator[Handle]:
    yield _length("thickness", "Thickness", 0.0, s.rise + s.thickness, s.thickness, lambda x, y: y - s.rise, "y")
    yield _length("span", "Clear span", -0.5 * s.span, 0.0, s.span, lambda x, y: -2.0 * x)
    yield _length("rise", "Rise of the intrados", 0.0, s.rise, s.rise, lambda x, y: y, "y")


def _bridge(s: Any, assembly: Assembly) -> Iterator[Handle]:
    """Each arch by its crown: rings are chains, in the order of the spans."""
    crowns = []
    for name, joints in assembly.chains.items():
        if name.startswith("pier"):
            continue
        p = assembly.p[joints]
        k = joints[int(p[:, 1].argmax())]
        crowns.append((float(assembly.p[k, 0]), k))
    for i, span in enumerate(s.spans):
        if len(crowns) % len(s.spans):
            return
        rings = len(crowns) // len(s.spans)
        k, last = crowns[i * rings][1], crowns[(i + 1) * rings - 1][1]
        p, q = assembly.p[k], assembly.q[last]
        number = "" if len(s.spans) == 1 else f" of span {i + 1}"
        for name, label, at, along in (
            ("rise", "Rise", p, lambda x, y, p=p, v=span.rise: v + y - float(p[1])),
            ("thickness", "Thickness at the crown", q, lambda x, y, q=q, v=span.thickness: v + y - float(q[1])),
        ):
            yield _length(f"spans.{i}.{name}", label + number, float(at[0]), float(at[1]), getattr(span, name), along, "y")


def _vertices(s: Any, _: Assembly) -> Iterator[Handle]:
    """Every vertex of free blocks; one that several blocks share moves in all of them."""
    if s.block is None or s.origin is not None or sum(len(b.points) for b in s.block) > MOST_VERTICES:
        return
    shared: dict[tuple[float, float], list[tuple[int, int]]] = {}
    for i, block in enumerate(s.block):
        for k, (x, y) in enumerate(block.points):
            shared.setdefault((round(x, 9), round(y, 9)), []).append((i, k))
    for (x, y), places in shared.items():
        i, k = places[0]
        names = ", ".join(dict.fromkeys(s.block[b].name or f"block {b + 1}" for b, _ in places))

        def changes(value: Any, places: list[tuple[int, int]] = places) -> Changes:
            point = [float(v) for v in value]
            return {f"structure.block.{b}.points.{v}": point for b, v in places}

        yield Handle(f"vertex-{i}-{k}", f"Vertex of {names}", "m", x, y, [x, y], lambda px, py: [px, py], changes, "both", least=-math.inf)


ARCH, VAULT = KindHandles(_arch, _centre_of_springings), KindHandles(_vault, _ground)
AISLED_VAULT, BLOCK, COLUMN, POINTED, ELLIPTICAL = (
    KindHandles(_church),
    KindHandles(_block),
    KindHandles(_column),
    KindHandles(_pointed),
    KindHandles(_elliptical),
)
BRIDGE, BLOCKS, PANEL, BRICKWORK, STACK, FRAME = (
    KindHandles(_bridge),
    KindHandles(_vertices),
    KindHandles(_panel),
    KindHandles(_brickwork),
    KindHandles(_stack),
    KindHandles(_frame),
)


def load_handles(loads: list[Any], name: str, surfaces: list[tuple[float, float]], scale: float) -> Iterator[Handle]:
    """Handles of the loads of analysis `name`: each at its place, and the end of its arrow. surfaces: where each acts;
    scale: metres that an arrow has per newton."""
    for i, (load, (x, y)) in enumerate(zip(loads, surfaces, strict=True)):
        key = f"analysis.{name}.load.{i}"
        number = "" if len(loads) == 1 else f" {i + 1}"

        def place(value: Any, key: str = key, load: Any = load) -> Changes:
            made = {f"{key}.x": value}
            if load.x_end is not None:
                made[f"{key}.x_end"] = value + load.x_end - load.x
            return made

        def force_at(px: float, py: float, y: float = y) -> float:
            return max((py - y) / scale, 0.0)

        def force_change(value: Any, key: str = key) -> Changes:
            return {f"{key}.force": value}

        yield Handle(f"load-{i}-x", f"Place of load{number}", "m", x, y, load.x, lambda px, py: px, place, "x", least=-math.inf)
        yield Handle(f"load-{i}-force", f"Weight of load{number}", "N", x, y + scale * load.force, load.force, force_at, force_change, "y")


def tie_handles(ties: list[Tie], assembly: Assembly) -> Iterator[Handle]:
    """Handles of straight ties: the height of the whole tie, and each anchorage. An anchorage in a block stays in blocks; a
    block that the deck names follows it."""
    for i, tie in enumerate(ties[:MOST_TIES]):
        if len(tie.start) != 2 or tie.via or tie.hoop:
            continue
        name, far = tie.name or f"tie {i + 1}", "end" if tie.ground is None else "ground"
        (x0, y0), (x1, y1) = tie.start, tie.far

        def moved(start: list[float], end: list[float], i: int = i, tie: Tie = tie, far: str = far) -> Changes:
            made: Changes = {}
            for which, place, before, stone in (("start", start, tie.start, "start_stone"), (far, end, tie.far, "end_stone")):
                if place == before:
                    continue
                made[f"ties.{i}.{which}"] = place
                if which != "ground" and (found := _anchorage(assembly, place, getattr(tie, stone))) is not None:
                    made[f"ties.{i}.{stone}"] = found
            return made or {f"ties.{i}.start": start}

        def level(value: float, a: float = y0, b: float = y1, xs: tuple[float, float] = (x0, x1), put: Any = moved) -> Changes:
            rise = value - 0.5 * (a + b)
            return put([xs[0], a + rise], [xs[1], b + rise])

        middle = 0.5 * (y0 + y1)
        yield Handle(
            f"tie-{i}-level", f"Height of {name}", "m", 0.5 * (x0 + x1), middle, middle, lambda x, y: y, level, "y", least=-math.inf
        )
        for which, place in (("start", tie.start), ("end", tie.far)):

            def led(value: Any, which: str = which, tie: Tie = tie, put: Any = moved) -> Changes:
                point = [float(v) for v in value]
                return put(point, tie.far) if which == "start" else put(tie.start, point)

            yield Handle(
                f"tie-{i}-{which}",
                f"{which.capitalize()} of {name}",
                "m",
                place[0],
                place[1],
                list(place),
                lambda x, y: [x, y],
                led,
                "both",
                least=-math.inf,
            )


def _anchorage(assembly: Assembly, place: list[float], given: str | None) -> str | None:
    """The block to be named at an anchorage, None if none has to be; BadGeometry outside of all blocks."""
    point = np.array([place])
    there = [k for k, outline in enumerate(assembly.outlines) if inside(outline, point)[0]]
    if not there:
        raise BadGeometry("the anchorage of a tie must lie in a block")
    names = [assembly.block_names[k] for k in there]
    return None if given is None or given in names else names[0]


def rounded(value: float, size: float) -> float:
    """A value to a thousandth of a size of its kind, as a hand means it."""
    step = 10.0 ** math.floor(math.log10(max(abs(size), 1e-9) / 500.0))
    digits = max(0, -round(math.log10(step)))
    return round(round(value / step) * step, digits + 1)
