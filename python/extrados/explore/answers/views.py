"""The picture: the drawing of the building, other views, and limit analysis of structures that are not plane sections."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from extrados.analyses.context import Refused
from extrados.analyses.limit.applied import block_under
from extrados.analyses.limit.tables import LimitAnalysisTable, Tilt
from extrados.analyses.sequence import run_one
from extrados.explore import bodies, statics
from extrados.explore.desk import Desk
from extrados.explore.fall import begin_fall
from extrados.explore.frames import Reply
from extrados.explore.handles import Handle, anchor_of, handles_of, load_handles, tie_handles
from extrados.explore.messages import BadMessage, Message, numbers, quantity
from extrados.model.errors import NoView
from extrados.model.geometry.assembly import Assembly

#: Greatest tilt that a hand gives the ground [g]
MOST_TILT = 2.5


def scene(desk: Desk) -> Reply:
    """The present building with its handles; both become picture and handles of the desk."""
    desk.check()
    structure = desk.there().deck.structure
    if structure is None:
        why = "The deck has no [structure], so nothing can be drawn."
        return _seen(desk, None, [], {"empty": why}, {})
    options, building, name = desk.analysis(LimitAnalysisTable, lambda: Tilt(kind="tilt"))
    try:
        assembly = building.blocks()
    except NoView as error:
        return _body(desk, str(error))
    desk.anchor = anchor_of(structure, assembly) if desk.held is None else desk.held
    if desk.view.through is not None and desk.view.through[0] >= len(assembly.a):
        desk.view = replace(desk.view, through=None)
    made = statics.picture(building, options, desk.view, desk.anchor)
    handles = [*handles_of(structure, assembly), *tie_handles(building.ties, assembly)]
    if name is not None and options.load:
        arrows, more = _loads(options.load, name, assembly, desk.anchor)
        made.words["loads"] = arrows
        handles += more
    made.words |= {"limit_analysis": name, "warnings": [*assembly.remarks, *assembly.notes]}
    return _seen(desk, made, handles, made.words, made.arrays)


def _loads(loads: list[Any], name: str, assembly: Assembly, anchor: np.ndarray) -> tuple[list[dict[str, Any]], list[Handle]]:
    """Arrows and handles of the loads of the analysis `name`."""
    surfaces = [(row.x, block_under(assembly, row.x)[1] if row.y is None else row.y) for row in loads]
    scale = 0.15 * assembly.size / (max(abs(row.force) for row in loads) or 1.0)
    arrows = [
        {
            "at": [x - anchor[0], y - anchor[1]],
            "force_N": row.force,
            "horizontal_N": row.horizontal,
            "end": None if row.x_end is None else row.x_end - anchor[0],
            "scale": scale,
        }
        for row, (x, y) in zip(loads, surfaces, strict=True)
    ]
    return arrows, list(load_handles(loads, name, surfaces, scale))


def _body(desk: Desk, why: str) -> Reply:
    """A building without stones in a plane: what there is to look at, and why there is no more."""
    deck = desk.there().deck
    meshes = [(a.mesh, b) for a, b in zip(deck.analyses, deck.buildings, strict=True) if hasattr(a, "mesh")]
    mesh, building = meshes[0] if meshes else (None, deck.building)
    words, arrays = bodies.seen(building, mesh) or ({}, {})
    desk.anchor = np.zeros(2)
    structure = deck.structure
    handles = handles_of(structure, None) if structure is not None and words.get("sort") == "elements" else []
    return _seen(desk, None, handles, {"empty": why, "seen": words or None, "gamma": 0.0}, arrays)


def _seen(desk: Desk, made: statics.Picture | None, handles: list[Handle], words: dict[str, Any], arrays: dict[str, np.ndarray]) -> Reply:
    """The reply that shows a picture, which becomes that of the desk; places of handles are relative to the anchor [m]."""
    desk.picture, desk.handles = made, {h.name: h for h in handles}
    x, y = desk.anchor.tolist()
    told = [
        {"name": h.name, "label": h.label, "unit": h.unit, "at": [h.x - x, h.y - y], "value": h.value, "along": h.along} for h in handles
    ]
    return Reply({"scene": words, "handles": told, "anchor": [x, y], "deck": desk.words()}, arrays)


def show(desk: Desk, message: Message) -> Iterator[Reply]:
    """Another view of the same building: the tilt, the chain, the place that the line shall pass or its thrust."""
    view = desk.view
    gamma, through, thrust, lines = view.gamma, view.through, view.thrust, view.lines
    limit = ""
    if "gamma" in message:
        wanted = numbers([message["gamma"]], 1)[0]
        gamma = float(np.clip(wanted, -MOST_TILT, MOST_TILT))
        limit = "" if gamma == wanted else f"Limit of Tilt of the ground: −{MOST_TILT:g} to {MOST_TILT:g} g"
    chain = message["chain"] if isinstance(message.get("chain"), str) else view.chain
    if "thrust" in message:
        thrust = None if message["thrust"] is None else _thrust(message["thrust"])
        through = None if thrust is not None else through
    if "through" in message:
        through = None if message["through"] is None else _through(desk, message["through"], chain)
        thrust = None if through is not None else thrust
    if isinstance(message.get("lines"), list):
        lines = frozenset(str(name)[:20] for name in message["lines"][:20])
    desk.view = statics.View(gamma, chain, through, thrust, lines)
    reply = scene(desk)
    yield Reply({**reply.words, "limit": limit}, reply.arrays)


def _through(desk: Desk, wanted: Any, chain: str | None) -> tuple[int, float]:
    """The joint, and the position on the joint, through which a line shall pass: given, or nearest to a point of the drawing."""
    assembly = desk.there().deck.building.blocks()
    if not isinstance(wanted, dict):
        place = np.array(numbers(wanted, 2)) + desk.anchor
        return statics.nearest(assembly, place, chain or statics.first_chain(assembly))
    joint, (share,) = wanted.get("joint"), numbers([wanted.get("share")], 1)
    if not isinstance(joint, int) or isinstance(joint, bool) or not 0 <= joint < len(assembly.a):
        raise BadMessage("the structure has no joint of this number")
    return joint, min(max(share, 0.0), 1.0)


def _thrust(wanted: Any) -> float:
    """A thrust [N] that a line shall have: a number, or text with a unit."""
    return quantity(wanted, "N", "Thrust of the line") if isinstance(wanted, str) else numbers([wanted], 1)[0]


def push(desk: Desk, _: Message) -> Iterator[Reply]:
    """Limit analysis of blocks in space, along the directions of the deck or in all directions."""
    if desk.picture is not None:
        raise BadMessage("a plane section is calculated with every drag; this request is for blocks in space")
    options, building, _name = desk.analysis(Tilt, lambda: Tilt(kind="tilt"))
    result = run_one(desk.there().context(), options, building)
    if result.status != "ok":
        raise Refused(result.reason)
    wanted = ("mechanism_pose", "rose_direction", "rose_capacity")
    arrays = {name: result.arrays[name].numbers for name in wanted if name in result.arrays}
    told = {k: v for k, v in result.results.as_json().items() if isinstance(v, int | float | str)}
    yield Reply({"push": {"answer": result.answer, "numbers": told, "warnings": result.warnings}}, arrays)


def fall(desk: Desk, _: Message) -> Iterator[Reply]:
    """The collapse of the drawn structure, one piece with each reply; ends early if the drawing has changed."""
    made = desk.picture
    if made is None or "falls" not in made.words:
        raise BadMessage("the structure does not collapse")
    _options, building, _name = desk.analysis(LimitAnalysisTable, lambda: None)
    anchor = np.append(desk.anchor, 0.0)
    for k, piece in enumerate(begin_fall(desk.there().context(), building, made)):
        words = {"first": k == 0, "done": piece.last, "stopped": piece.stopped}
        yield Reply({"fall": words}, {"fall_time": piece.time, "fall_pose": piece.pose - anchor})
        if desk.picture is not made:
            return
