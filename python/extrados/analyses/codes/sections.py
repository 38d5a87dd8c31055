"""The bodies of a local mechanism as outlines, at rest and turned, and the walls of a plan: for pictures."""

import numpy as np

from extrados.analyses.codes.bending import Bending, HorizontalBending, VerticalBending
from extrados.analyses.codes.kinematics import Overturning
from extrados.analyses.codes.tables import LocalMechanism
from extrados.model.structures.plan import Plan

#: Share of the rotation at which the multiplier vanishes that is drawn; the rotation [rad] where it does not
SHOWN, ELSE = 0.4, 0.05
Outlines = dict[str, np.ndarray]


def body_outlines(options: LocalMechanism, body: Overturning | Bending) -> tuple[Outlines, Outlines, np.ndarray]:
    """Outlines [m] at rest and turned, and hinges (n, 2) turned. A section across the wall, outward to +x, up to +y; of horizontal bending the
    plan, along the wall to +x, outward to +y. Nothing of a corner, whose bodies are no section."""
    rotation = SHOWN * (body.ultimate() or ELSE / SHOWN)
    if isinstance(body, VerticalBending):
        return _of_vertical_bending(body, rotation, options.hinge_height)
    if isinstance(body, HorizontalBending):
        return _of_horizontal_bending(body, rotation)
    if options.mechanism == "corner":
        return {}, {}, np.empty((0, 2))
    return _of_overturning(options, body, rotation)


def _rectangle(left: float, right: float, low: float, high: float) -> np.ndarray:
    return np.array([[left, low], [right, low], [right, high], [left, high]])


def _about(points: np.ndarray, pivot: np.ndarray, rotation: float) -> np.ndarray:
    """Points turned clockwise about a pivot [rad]."""
    c, s = np.cos(rotation), np.sin(rotation)
    return (points - pivot) @ np.array([[c, -s], [s, c]]) + pivot


def _of_overturning(options: LocalMechanism, body: Overturning, rotation: float) -> tuple[Outlines, Outlines, np.ndarray]:
    thickness, foot, top = float(options.thickness or 0.0), options.hinge_height, float(options.height or 0.0)
    # the first weight is that of the wall, whose middle lies half its thickness behind its outer face
    pivot = np.array([body.weights[0].arm - 0.5 * thickness, foot])
    rest = {"wall": _rectangle(-thickness, 0.0, foot, top)}
    turned = {"wall": _about(rest["wall"], pivot, rotation)}
    if foot > 0.0:
        rest["below"] = turned["below"] = _rectangle(-thickness, 0.0, 0.0, foot)
    return rest, turned, pivot[None]


def _of_vertical_bending(body: VerticalBending, rotation: float, foot: float) -> tuple[Outlines, Outlines, np.ndarray]:
    lower, upper = body.carried(rotation)
    below = _rectangle(-body.thickness, 0.0, 0.0, body.crack)
    above = _rectangle(-body.thickness, 0.0, body.crack, body.height)
    rest = {"lower": below, "upper": above}
    turned = {"lower": np.array([lower(*p) for p in below]), "upper": np.array([upper(*p) for p in above])}
    hinges = np.array([lower(-body.setback[0], 0.0), lower(-body.thickness + body.setback[1], body.crack), upper(-body.arm, body.height)])
    up = np.array([0.0, foot])
    return {k: p + up for k, p in rest.items()}, {k: p + up for k, p in turned.items()}, hinges + up


def _of_horizontal_bending(body: HorizontalBending, rotation: float) -> tuple[Outlines, Outlines, np.ndarray]:
    half, inset = 0.5 * body.length, 0.5 * body.depth
    rest = {"left": _rectangle(0.0, half, 0.0, body.thickness), "right": _rectangle(half, body.length, 0.0, body.thickness)}
    # the halves turn about the outer edges at the side walls, which spread, and meet at mid length at the inner face
    edge, middle = np.array([0.0, body.thickness - inset]), np.array([[half, inset]])
    spread = np.array([half - _about(middle, edge, -rotation)[0, 0], 0.0])
    left = _about(rest["left"], edge, -rotation) + spread
    mirrored = np.array([body.length, 0.0]) + left * np.array([-1.0, 1.0])
    hinges = np.vstack([edge + spread, _about(middle, edge, -rotation) + spread, [body.length - edge[0] - spread[0], edge[1]]])
    return rest, {"left": left, "right": mirrored}, hinges


def plan_outlines(plan: Plan) -> Outlines:
    """The walls on the plan by name (4, 2) [m], each as thick as at its lowest storey."""
    found = {}
    for wall in plan.walls:
        start, end = np.asarray(wall.start, dtype=float), np.asarray(wall.end, dtype=float)
        along = (end - start) / wall.length
        side = 0.5 * plan.thickness_of(wall, plan.reach(wall)[0]) * np.array([-along[1], along[0]])
        found[wall.name] = np.array([start + side, end + side, end - side, start - side])
    return found
