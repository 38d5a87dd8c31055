"""Changes by the user: handles that are dragged, stepped or typed, keys that are set; and the reply when a drag ends."""

import math
import re
from collections.abc import Iterator
from typing import Any

import numpy as np

from extrados.decks.reader import DeckError
from extrados.explore import forms, statics
from extrados.explore.answers import motion
from extrados.explore.answers.views import scene
from extrados.explore.desk import Desk
from extrados.explore.document import as_written, tidy
from extrados.explore.frames import Reply
from extrados.explore.handles import Handle, rounded
from extrados.explore.messages import TOLD, BadMessage, Message, numbers, quantity
from extrados.schema.keys import unit_along

#: Halvings of the way to a value that the building does not take
HALVINGS = 12
KEY = re.compile(r"[A-Za-z_][\w-]*(\.[\w-]+){0,8}")


def drag(desk: Desk, message: Message) -> Iterator[Reply]:
    """A handle led to a place (`to`), moved by steps, or given a value as text; `ends` lets go of it."""
    handle = desk.handles.get(str(message.get("handle")))
    if handle is None:
        raise BadMessage("the drawing has no handle of this name")
    if handle.holds and desk.held is None:
        desk.held = desk.anchor
    if "to" in message:
        value = _led(handle, desk, numbers(message["to"], 2))
    elif "by" in message:
        value = _stepped(handle, desk.size, *numbers(message["by"], 2))
    else:
        value = _typed(handle, message.get("text"))
    try:
        yield _change(desk, handle.changes(value)) if "to" not in message else _towards(desk, handle, value)
    finally:
        if message.get("ends") is True or "to" not in message:
            desk.held = None


def set_keys(desk: Desk, message: Message) -> Iterator[Reply]:
    """Set keys of the deck: numbers, words, or text with units as in a deck. `rocking`: the same reply contains the response,
    for a pulse that is dragged."""
    changes = message.get("changes")
    if not isinstance(changes, dict) or not 0 < len(changes) <= 50:
        raise BadMessage("a single message may change 1 to 50 keys of the deck")
    if not all(KEY.fullmatch(key) for key in changes):
        raise BadMessage("the name of a changed key is not valid in a deck")
    reply = _change(desk, changes)
    if message.get("rocking") is True and desk.there().deck.motion is not None:
        for response in motion.response(desk, {}):
            reply.words |= response.words
            reply.arrays |= response.arrays
    yield reply


def rest(desk: Desk, _: Message) -> Iterator[Reply]:
    """The reply at the end of a drag: the text of the deck, its forms, then mechanisms and safety."""
    desk.held = None
    yield Reply({"text": desk.document.text, "forms": forms.forms_of(desk.there().deck), "name": desk.name})
    if desk.picture is not None:
        words, arrays = statics.detail(desk.picture, desk.anchor)
        yield Reply({"detail": words}, arrays)


def _led(handle: Handle, desk: Desk, to: list[float]) -> Any:
    """The value where a hand leads a handle, to as many digits as a hand means."""
    x, y = (np.array(to) + desk.anchor).tolist()
    value = handle.value_at(x, y)
    if handle.unit != "m":
        return rounded(value, max(abs(value), 1e-6))
    return [rounded(v, desk.size) for v in value] if isinstance(value, list) else rounded(value, desk.size)


def _towards(desk: Desk, handle: Handle, wanted: Any) -> Reply:
    """The handle at a value, or at the last one towards it that the building takes; `limit` says then which limit holds it."""
    inside = _clipped(handle, wanted)
    try:
        reply = _change(desk, handle.changes(inside))
        told = "" if inside == wanted else _range(handle)
    except TOLD as error:
        reached, told = _reached(desk, handle, inside, str(error))
        reply = scene(desk) if reached is None else _change(desk, handle.changes(reached))
    if told:
        reply.words["limit"] = f"Limit of {handle.label}: {told}"
    return reply


def _clipped(handle: Handle, value: Any) -> Any:
    """A value within the bounds of its handle."""
    if isinstance(value, list):
        return value
    return min(max(value, handle.least), math.inf if handle.most is None else handle.most)


def _range(handle: Handle) -> str:
    """The bounds of a handle in words."""
    return f"{handle.least:g} to {handle.most:g} {handle.unit}" if handle.most is not None else f"at least {handle.least:g} {handle.unit}"


def _reached(desk: Desk, handle: Handle, wanted: Any, why: str) -> tuple[Any, str]:
    """The last value on the way from the present one to a wanted one that the building takes, None where that is the present
    one; and why the way ends there."""
    live = desk.there()
    before, reached = live.deck, None
    now, end = np.array(handle.value, dtype=float), np.array(wanted, dtype=float)
    low, high = 0.0, 1.0
    try:
        for _ in range(HALVINGS):
            share = 0.5 * (low + high)
            value = (now + share * (end - now)).tolist()
            value = [rounded(v, desk.size) for v in value] if isinstance(value, list) else rounded(value, desk.size)
            try:
                live.update({key: _written(desk, key, one) for key, one in handle.changes(value).items()})
                live.deck.building.blocks()
                low, reached = share, value
            except TOLD as error:
                high, why = share, str(error)
    finally:
        live.back_to(before)
    return reached, why.splitlines()[0].removeprefix("deck: ")


def _stepped(handle: Handle, size: float, dx: float, dy: float) -> Any:
    """A step of the keyboard: a hundredth of the size of the value, or of the building for places."""
    if isinstance(handle.value, list):
        step = 0.002 * size
        return [rounded(handle.value[0] + dx * step, size), rounded(handle.value[1] + dy * step, size)]
    step = handle.step or 0.01 * max(abs(handle.value), 0.02 * size if handle.unit == "m" else 1e-3)
    exponent = np.floor(np.log10(step))
    step = float(np.round(step / 10.0**exponent) * 10.0**exponent)
    return max(round((handle.value + (dx + dy) * step) / step) * step, min(step, handle.least or step))


def _typed(handle: Handle, text: Any) -> Any:
    """A value as a hand types it, with unit or without."""
    if not isinstance(text, str):
        raise BadMessage("expected text")
    if isinstance(handle.value, list):
        parts = [p for p in re.split(r"[;,]\s*|\s+(?=[-+.\d])", text.strip()) if p]
        if len(parts) != 2:
            raise DeckError([f"{handle.label}: expected two numbers, x; y"])
        return [quantity(part, handle.unit, handle.label) for part in parts]
    return quantity(text, handle.unit, handle.label)


def _change(desk: Desk, changes: dict[str, Any]) -> Reply:
    """Set values in the live deck and in the text, in the form of the text, so that both give the same numbers."""
    live = desk.there()
    written = {key: _written(desk, key, value) for key, value in changes.items()}
    before = live.deck
    live.update(written)
    try:
        moved = all(key.split(".")[0] == "motion" for key in written) and desk.picture is not None
        desk.check()
        reply = Reply({"deck": desk.words()}) if moved else scene(desk)  # statics know no motion
    except BaseException:
        live.back_to(before)
        raise
    for key, value in written.items():
        desk.document.put(_way(desk, key), value)
    return reply


def _way(desk: Desk, key: str) -> list[str]:
    """The place of a key of the live deck in the text."""
    way, live = key.split("."), desk.there()
    if way[0] == "analysis" and len(way) > 1:
        index = live.names.index(way[1])
        way[:2] = ["analysis", str(index)] if isinstance(live.deck.data["analysis"], list) else ["analysis"]
    return way


def _before(desk: Desk, key: str) -> Any:
    """The value of a key in the deck, None if it is not given."""
    place: Any = desk.there().deck.data
    try:
        for part in _way(desk, key):
            place = place[int(part)] if isinstance(place, list) else place[part]
    except (KeyError, IndexError, TypeError, ValueError):
        return None
    return place


def _written(desk: Desk, key: str, value: Any) -> Any:
    """A value in the form of the text of the deck."""
    if isinstance(value, list):
        return [float(tidy(v)) if isinstance(v, float) else v for v in value]
    if isinstance(value, bool) or not isinstance(value, int | float):
        return value
    si, bare = _unit(desk, key)
    return as_written(value, _before(desk, key), si, bare)


def _unit(desk: Desk, key: str) -> tuple[str, bool]:
    """The unit of a key, and whether a number without a unit is permitted."""
    live = desk.there()
    deck, way = live.deck, key.split(".")
    table = {"structure": deck.structure, "motion": deck.motion}.get(way[0], getattr(deck.building, way[0], None))
    if way[0] == "analysis" and len(way) > 2:
        table, way = deck.analyses[live.names.index(way[1])], way[1:]
    return unit_along(type(table), way[1:]) if table is not None else ("", True)
