"""The plan of a building under the hand: its walls and openings for the page, drawn walls as the text of a deck, and the pushover
of its frame step by step."""

import re
from collections.abc import Iterator
from typing import Any

import tomlkit
from tomlkit.items import AoT
from tomlkit.items import Table as TomlTable

from extrados.analyses.frame.drawn import drawn_arrays
from extrados.analyses.frame.pushover import push_once
from extrados.analyses.frame.tables import FramePushover
from extrados.bridges.plan_drawing import written_deck
from extrados.core.frame import STATES
from extrados.decks.reader import DeckError
from extrados.explore.answers.decks import open_deck
from extrados.explore.desk import Desk
from extrados.explore.frames import Reply
from extrados.explore.messages import TOLD, BadMessage, Message, numbers
from extrados.model.structures.plan import Plan
from extrados.model.structures.plan_parts import PlanWall

#: Walls and openings of a plan, storeys of a drawn one, characters of a name
MOST_WALLS, MOST_OPENINGS, MOST_STOREYS, LONGEST_NAME = 200, 200, 10, 40
#: Blank lines before a table, which tomlkit adds at each change
SPACED = re.compile(r"\n{3,}\[")
#: The floor that a drawn building without floors of its own gets on every storey
FLOOR = {"kind": "rigid", "load": "3 kPa"}
#: A building without walls, of the masonry that drawings get
BLANK = written_deck([], [3.0], "the page", ["Floors, if any: rigid, with a load of 3 kPa."]).replace(
    'kind = "frame-pushover"', 'kind = "frame-pushover"\neccentricities = [0.0]'
)


def plan(desk: Desk, _: Message) -> Iterator[Reply]:
    """Storeys [m], walls and openings of the deck; no walls if it is no building on a plan."""
    table = _plan(desk)
    yield Reply({"plan": {"storeys": [3.0], "walls": [], "floors": 0} if table is None else _told(table)})


def draw_plan(desk: Desk, message: Message) -> Iterator[Reply]:
    """The deck with the drawn walls, opened; if it is no building yet, its text with the reasons, and the deck at hand stays.

    fresh: a deck of its own, with rigid floors if `floors` is true; else the deck at hand with all its other keys.
    """
    fresh = message.get("fresh") is True or _plan(desk) is None
    text = _text(desk, _walls(message), fresh, message.get("floors") is True, message.get("storeys"))
    try:
        yield from open_deck(desk, {"text": text} | ({"name": "building.toml"} if fresh else {"here": "same"}))
    except TOLD as error:
        complaints = error.complaints if isinstance(error, DeckError) else [str(error)]
        yield Reply({"draft": text, "trouble": [c[:2000] for c in complaints[:20]]})


def push_plan(desk: Desk, message: Message) -> Iterator[Reply]:
    """The pushover of the frame along a direction on the plan [deg]: its curve and the states of its elements at every step."""
    (direction,) = numbers([message.get("direction")], 1)
    if _plan(desk) is None:
        raise BadMessage("expected a building on a plan")
    options, building, _ = desk.analysis(FramePushover, lambda: FramePushover(kind="frame-pushover"))
    frame = building.frame(options.frame)
    row, path = push_once(frame, options, direction)
    told = {key: row[key] for key in ("peak_base_shear_N", "displacement_at_peak_m", "ultimate_displacement_m", "stop", "failed")}
    arrays = {name: array.numbers for name, array in drawn_arrays(frame).items() if name.startswith("element_")}
    yield Reply(
        {"pushed": {**told, "direction": direction, "states": STATES, "weight_N": frame.total_weight, "remarks": frame.remarks}},
        {**arrays, "control": path.control, "shear": path.multiple, "state": path.state.astype("u1")},
    )


def _plan(desk: Desk) -> Plan | None:
    table = None if desk.live is None else desk.live.deck.structure
    return table if isinstance(table, Plan) else None


def _told(table: Plan) -> dict[str, Any]:
    def wall(one: PlanWall) -> dict[str, Any]:
        openings = [{"storey": o.storey, "x": list(o.x), "z": list(o.z)} | ({"through": True} if o.through else {}) for o in one.openings]
        first, last = table.reach(one)
        return {
            "name": one.name,
            "start": list(one.start),
            "end": list(one.end),
            "thickness": one.thickness or max(one.thicknesses),
            "storeys": [first, last],
            "openings": openings,
        }

    return {"storeys": list(table.storeys), "walls": [wall(one) for one in table.walls], "floors": len(table.floors)}


def _walls(message: Message) -> list[dict[str, Any]]:
    """Walls of a message, within their bounds."""
    walls = message.get("walls")
    if not isinstance(walls, list) or len(walls) > MOST_WALLS:
        raise BadMessage(f"expected at most {MOST_WALLS} walls")
    found: list[dict[str, Any]] = []
    for wall in walls:
        name, openings = (wall.get("name"), wall.get("openings")) if isinstance(wall, dict) else (None, None)
        if not isinstance(name, str) or not name.isprintable() or not 0 < len(name) <= LONGEST_NAME:
            raise BadMessage("expected a name for each wall")
        if not isinstance(openings, list) or len(openings) > MOST_OPENINGS:
            raise BadMessage(f"expected at most {MOST_OPENINGS} openings in a wall")
        (thickness,) = numbers([wall.get("thickness")], 1)
        rows = []
        for one in openings:
            storey = one.get("storey") if isinstance(one, dict) else None
            if isinstance(storey, bool) or not isinstance(storey, int) or not 0 < storey <= MOST_STOREYS:
                raise BadMessage("expected a storey for each opening")
            through = {"through": True} if one.get("through") is True else {}
            rows.append({"storey": storey, "x": numbers(one.get("x"), 2), "z": numbers(one.get("z"), 2)} | through)
        found.append(
            {
                "name": name,
                "start": numbers(wall.get("start"), 2),
                "end": numbers(wall.get("end"), 2),
                "thickness": thickness,
                "openings": rows,
            }
        )
    return found


def _text(desk: Desk, walls: list[dict[str, Any]], fresh: bool, floors: bool, storeys: Any) -> str:
    """The deck as TOML. Walls of the deck at hand that were not changed stay as their author wrote them."""
    made = tomlkit.parse(BLANK if fresh else desk.document.text)
    structure: Any = made["structure"]
    table = None if fresh else _plan(desk)
    before = {} if table is None else {row["name"]: (row, raw) for row, raw in zip(_told(table)["walls"], structure["walls"], strict=True)}
    rows = tomlkit.aot()
    for wall in walls:
        was, raw = before.get(wall["name"], (None, None))
        unchanged = was is not None and all(was[key] == wall[key] for key in ("start", "end", "thickness", "openings"))
        rows.append(raw if unchanged and isinstance(raw, TomlTable) else _row(wall, was, raw))
    if not walls or not isinstance(structure.get("walls"), AoT):  # an array of lines gives its place to tables at the end
        structure.pop("walls", None)
    if walls:
        structure["walls"] = rows
    if fresh:
        if not isinstance(storeys, int) or isinstance(storeys, bool) or not 0 < storeys <= MOST_STOREYS:
            raise BadMessage(f"expected 1 to {MOST_STOREYS} storeys")
        structure["storeys"] = ["3.0 m"] * storeys
        if floors:
            aot = tomlkit.aot()
            for storey in range(1, storeys + 1):
                one = tomlkit.table()
                one.update({"storey": storey, **FLOOR})
                one.add(tomlkit.nl())
                aot.append(one)
            structure["floors"] = aot
    return SPACED.sub("\n\n[", tomlkit.dumps(made))


def _row(wall: dict[str, Any], was: dict[str, Any] | None, raw: Any) -> Any:
    """A wall of the text: with what its author wrote beside what was changed."""
    row = tomlkit.table()
    kept = {} if raw is None else raw.unwrap()
    row.update(kept)
    row["name"] = wall["name"]
    for key in ("start", "end"):
        if was is None or was[key] != wall[key]:
            row[key] = [round(v, 4) for v in wall[key]]
    if was is None or was["thickness"] != wall["thickness"]:
        row["thickness"] = round(wall["thickness"], 4)
        row.pop("thicknesses", None)
    if was is None or was["openings"] != wall["openings"]:
        row.pop("openings", None)
        openings = tomlkit.array()
        for k, one in enumerate(wall["openings"]):
            line = tomlkit.inline_table()
            line.update(_kept_opening(one, k, wall, was, kept))
            openings.append(line)
        if wall["openings"]:
            row["openings"] = openings.multiline(True)
    row.add(tomlkit.nl())
    return row


def _kept_opening(one: dict[str, Any], k: int, wall: dict[str, Any], was: dict[str, Any] | None, kept: dict[str, Any]) -> dict[str, Any]:
    """An opening with the other keys (a lintel) that it had: that of its number if the count is the same, else an equal one."""
    new = {"storey": one["storey"], "x": [round(v, 4) for v in one["x"]], "z": [round(v, 4) for v in one["z"]]}
    new |= {"through": True} if one.get("through") else {}
    old = [] if was is None else was["openings"]
    at = k if len(old) == len(wall["openings"]) else next((i for i, other in enumerate(old) if other == one), None)
    if at is None or at >= len(old):
        return new
    return {key: value for key, value in kept["openings"][at].items() if key not in new} | new
