"""The local mechanisms of walls, from their table: one body that turns about a hinge, or two that bend."""

import math
from collections.abc import Sequence
from dataclasses import replace

from extrados.analyses.codes.bending import Bending, HorizontalBending, vertical_bending
from extrados.analyses.codes.kinematics import Overturning, Push, Weight
from extrados.analyses.codes.ntc import toothed_edge
from extrados.analyses.codes.tables import Floor, LocalMechanism, WallTie
from extrados.analyses.context import Refused
from extrados.limit.errors import CannotStand
from extrados.schema.constants import GRAVITY

#: Stress of a rectangular block, over the strength, whose resultant lies as far from the edge as that of the triangle up to the strength
BLOCK = 0.75
#: What each mechanism needs beyond density and height
NEEDS = {
    "facade": ("height", "thickness"),
    "corner": ("height", "thickness", "crack_angle"),
    "gable": ("height", "thickness", "width"),
    "parapet": ("height", "thickness"),
    "wall": ("height", "thickness"),
    "tower": ("height", "thickness"),
    "chimney": ("height", "thickness"),
    "vertical-bending": ("height", "thickness"),
    "horizontal-bending": ("height", "thickness", "width"),
}
#: Keys of some mechanisms alone, with those that use them
ONLY = {
    "crack_angle": ("corner",),
    "abutment_force": ("horizontal-bending",),
    "wings": ("facade",),
    "interlocking": ("facade",),
    "side_walls": ("facade", "gable", "parapet", "wall", "tower"),
    "ties": ("facade", "corner", "gable", "parapet", "wall", "tower", "chimney"),
}
#: Parts that are free to vibrate at a period of their own [C8.7.1.9]
FREE_TO_VIBRATE = ("parapet", "gable", "chimney")
#: Mechanisms that are a wall of the width 1 m where none is given; others are as wide as thick
AS_WIDE = ("tower", "chimney")


def body_of(options: LocalMechanism, density: float, strength: float | None) -> Overturning | Bending:
    """The mechanism of the table: a body that overturns, or two that bend; see `overturning`."""
    if options.mechanism not in ("vertical-bending", "horizontal-bending"):
        return overturning(options, density, strength)
    _refuse_sizes(options)
    return _bending(options, density, strength)


def _bending(options: LocalMechanism, density: float, strength: float | None) -> Bending:
    height, thickness = float(options.height or 0.0) - options.hinge_height, float(options.thickness or 0.0)
    width = options.width or 1.0
    weight = density * GRAVITY * thickness * width * height
    if not weight > 0.0:
        raise Refused("the moving part has no weight: give a density above zero", ("material", "density"))
    if options.mechanism == "vertical-bending":
        for k, floor in enumerate(options.floors):
            if floor.height < float(options.height or 0.0) or floor.pushing or floor.thrust:
                raise Refused(
                    "for vertical bending, floors load only the top of the wall and restrain the top: give the "
                    "`height` of the top and `load`, without `pushing` and `thrust`",
                    ("analysis", "floors", k),
                )
        load = sum(f.load for f in options.floors)
        moment = sum(f.load * (0.5 * thickness if f.arm is None else f.arm) for f in options.floors)
        return vertical_bending(height, thickness, width, weight, load, moment / load if load else 0.5 * thickness, strength)
    sway = sum(f.load * f.sways + f.pushing for f in options.floors)
    thrust = sum(f.thrust for f in options.floors)
    if options.abutment_force is None:
        if strength is None:
            raise Refused(
                "horizontal bending requires `abutment_force`, the force that each side wall resists. If the side walls do not move, "
                "give `compressive_strength` of [material] instead, which then limits the thrust",
                ("analysis",),
            )
        # H (t - a) with H = f h a is greatest at a = t/2
        return HorizontalBending(
            width, thickness, weight + sway, 0.5 * strength * height * thickness, thrust, 0.5 * thickness, crushes=True
        )
    force = float(options.abutment_force)
    depth = 0.0 if strength is None else force / (strength * height)
    if depth >= 0.5 * thickness:
        raise Refused(
            f"the strip cannot carry this thrust: it requires a compressed depth of {depth:.3g} m, but at most "
            f"half of the thickness of {thickness:g} m can be compressed",
            ("analysis", "abutment_force"),
        )
    return HorizontalBending(width, thickness, weight + sway, force, thrust, depth)


def overturning(options: LocalMechanism, density: float, strength: float | None) -> Overturning:
    """The body above the hinge; lengths m, density kg/m^3, compressive strength Pa (None: the hinge is the outer edge).

    The hinge lies within the wall where stone crushes, by 2 P/(3 f_d w): the resultant of a triangle of stress f_d. Refused, with
    the key, where a size is missing or does not fit, and where nothing that sways has weight.
    """
    _refuse_sizes(options)
    body = _corner(options, density) if options.mechanism == "corner" else _upright(options, density, strength)
    if not sum(w.weight for w in body.weights if w.sways) > 0.0:
        raise Refused("the moving part has no weight: give a density above zero", ("material", "density"))
    return body


def _refuse_sizes(options: LocalMechanism) -> None:
    missing = [name for name in NEEDS[options.mechanism] if getattr(options, name) is None]
    if missing:
        raise Refused(f"{options.mechanism} requires {' and '.join(missing)}", ("analysis",))
    top = float(options.height or 0.0)
    if options.hinge_height >= top:
        raise Refused(
            f"the hinge is at {options.hinge_height:g} m, which is not below the top of the wall, {top:g} m", ("analysis", "hinge_height")
        )
    parts: dict[str, Sequence[Floor | WallTie]] = {"floors": options.floors, "ties": options.ties}
    for name, those in parts.items():
        for k, part in enumerate(those):
            if part.height > top:
                raise Refused(f"{part.height:g} m is above the top of the wall, {top:g} m", ("analysis", name, k, "height"))
    for name, users in ONLY.items():
        if name in options.model_fields_set and getattr(options, name) and options.mechanism not in users:
            raise Refused(
                f"mechanism '{options.mechanism}' does not use `{name}`: remove this key, which is used only with {', '.join(users)}",
                ("analysis", name),
            )
    if options.interlocking is not None and options.side_walls is not None:
        raise Refused(
            "`interlocking` is for a facade that separates from its side walls, and `side_walls` for a "
            "facade that moves with parts of them: remove one of the two keys",
            ("analysis", "interlocking"),
        )
    if options.interlocking is not None and options.interlocking.unit_height > top - options.hinge_height:
        raise Refused(
            "a course is higher than the wall that rotates: give a smaller height of the units", ("analysis", "interlocking", "unit_height")
        )


def _upright(options: LocalMechanism, density: float, strength: float | None) -> Overturning:
    """A wall, a gable or a tower that turns about a hinge along it."""
    height, thickness = float(options.height or 0.0) - options.hinge_height, float(options.thickness or 0.0)
    width = options.width or (thickness if options.mechanism in AS_WIDE else 1.0)
    unit = density * GRAVITY * thickness
    if options.mechanism == "gable":
        wall = Weight(unit * width * height / 2.0, thickness / 2.0, height / 3.0)
    else:
        wall = Weight(unit * width * height, thickness / 2.0, height / 2.0)
    weights, pushes = [wall], []
    for wing in options.wings:
        low, high = max(0.0, wing.foot - options.hinge_height), wing.height - options.hinge_height
        if high > low:
            own = density * GRAVITY * wing.thickness * wing.width * (high - low)
            weights.append(Weight(own, wing.setback + wing.thickness / 2.0, 0.5 * (low + high)))
    for floor in options.floors:
        level = floor.height - options.hinge_height
        if level < 0.0:
            continue  # what lies below the hinge does not move
        weights += _of_floor(floor, thickness / 2.0, level)
        if floor.thrust:
            pushes.append(Push(floor.thrust, level))
    for tie in options.ties:
        if tie.height > options.hinge_height:
            pushes.append(Push(-tie.force, tie.height - options.hinge_height))
    if options.interlocking is not None:
        teeth = options.interlocking
        courses = int(height / teeth.unit_height * (1.0 + 1e-9))
        force, below = toothed_edge(courses, teeth.unit_height, teeth.overlap, teeth.thickness, density * GRAVITY)
        pushes.append(Push(-teeth.count * force, height - below))
    if options.side_walls is not None:
        weights, pushes = _with_side_walls(options, density, height, weights, pushes)
    if strength is not None:
        weights = set_back(weights, strength, width, thickness)
    return Overturning(tuple(weights), tuple(pushes))


def _of_floor(floor: Floor, middle: float, level: float) -> list[Weight]:
    """What a floor lays on the wall, and what only pushes it; middle: how far behind the hinge the wall's own middle is [m]."""
    arm = middle if floor.arm is None else floor.arm
    found = [Weight(floor.load, arm, level, floor.sways), Weight(floor.pushing, arm, level, rests=False)]
    return [w for w in found if w.weight > 0.0]


def set_back(weights: list[Weight], strength: float, width: float, thickness: float) -> list[Weight]:
    """Weights about a hinge that lies within the wall by 2 P/(3 f_d w), the centre of a triangle of stress up to f_d, for a strength f_d [Pa] and a width w [m]; Refused where
    that is the middle of the thickness [m], CannotStand where no stress within the strength carries the weight."""
    weight, most = sum(w.weight for w in weights if w.rests), strength * width * thickness
    if weight > most:
        raise CannotStand(
            f"the wall crushes at the hinge under its weight: the load is {weight / 1000.0:.3g} kN, but the "
            f"section carries at most {most / 1000.0:.3g} kN",
            neglects=(),
        )
    setback = 0.5 * weight / (BLOCK * strength * width)
    if setback >= thickness / 2.0:
        raise Refused(
            "under the weight, the triangle of compressive stress at the hinge is wider than the wall: the "
            f"stress exceeds {BLOCK:g} of the compressive strength",
            ("material", "compressive_strength"),
        )
    return [replace(w, arm=w.arm - setback) for w in weights]


def _with_side_walls(
    options: LocalMechanism, density: float, height: float, weights: list[Weight], pushes: list[Push]
) -> tuple[list[Weight], list[Push]]:
    """A wedge of each side wall goes with the facade, cut by a crack that rises at an angle from the hinge: a triangle of
    height h and length h tan(angle), its centre of mass at two thirds of the height and a third of the length behind."""
    side = options.side_walls
    assert side is not None and options.thickness is not None
    length = height * math.tan(math.radians(side.crack_angle))
    weight = density * GRAVITY * side.thickness * 0.5 * height * length
    wedge = Weight(side.count * weight, options.thickness + length / 3.0, 2.0 * height / 3.0)
    return [*weights, wedge], pushes


def _corner(options: LocalMechanism, density: float) -> Overturning:
    """Two walls at right angles, each torn off by a crack that rises at an angle from the foot of the corner; they turn about
    a level hinge across the outer edge, in the direction that halves the corner."""
    height = float(options.height or 0.0) - options.hinge_height
    thickness = float(options.thickness or 0.0)
    length = height * math.tan(math.radians(float(options.crack_angle or 0.0)))
    one = density * GRAVITY * thickness * 0.5 * height * length
    arm = (length / 3.0 + thickness / 2.0) / math.sqrt(2.0)
    weights = [Weight(2.0 * one, arm, 2.0 * height / 3.0)]
    pushes = []
    for floor in options.floors:
        level = floor.height - options.hinge_height
        if level >= 0.0:
            weights += _of_floor(floor, arm, level)
        if level >= 0.0 and floor.thrust:
            pushes.append(Push(floor.thrust, level))
    pushes += [Push(-t.force, t.height - options.hinge_height) for t in options.ties if t.height > options.hinge_height]
    return Overturning(tuple(weights), tuple(pushes))
