"""Motion: the response to the deck's motion, the map of pulses, the primary impulse."""

from collections.abc import Iterator

from extrados.analyses.context import Refused
from extrados.analyses.rocking.tables import FailureDomain, Rocking
from extrados.core.errors import CoreError
from extrados.explore import rocking
from extrados.explore.desk import Desk
from extrados.explore.frames import Reply
from extrados.explore.messages import Message
from extrados.limit.programme import NoAnswer, NoEquilibrium
from extrados.model.errors import BadGeometry

MOST_MAPS = 8


def response(desk: Desk, message: Message) -> Iterator[Reply]:
    """The response to the deck's motion, with shapes unless the page only looks for an amplitude."""
    context = desk.there().context()
    if context.deck.motion is None:
        raise Refused("the deck has no [motion]")
    drawn = rocking.curve(context.motion)
    options, building, _ = desk.analysis(Rocking, lambda: Rocking(kind="rocking"))
    context.building = building
    try:
        words, arrays = rocking.history(context, building, options, desk.anchor, message.get("still") is True)
    except (Refused, BadGeometry, NoAnswer, NoEquilibrium, CoreError) as error:
        words, arrays = {"refused": str(error)}, {}  # the motion is shown all the same
    yield Reply({"rocking": words, "deck": desk.words()}, {**arrays, **drawn})


def impulse(desk: Desk, _: Message) -> Iterator[Reply]:
    """The primary impulse of the motion, and the prediction for the building."""
    live = desk.there()
    if live.deck.motion is None:
        raise Refused("the deck has no [motion]")
    yield Reply({"impulse": rocking.impulse(live.context(), live.deck.building)})


def domain(desk: Desk, message: Message) -> Iterator[Reply]:
    """The map of pulses, coarse first and finer with each reply; kept as long as the building is the same."""
    live = desk.there()
    options, building, name = desk.analysis(FailureDomain, lambda: None)
    motion = live.deck.motion
    uplift = building.rocker(soft_base=True).uplift
    kind = None if motion is None else motion.kind
    asked = rocking.domain_options(kind, options if name else None, uplift)
    if message.get("pulse") in ("step", "sine"):
        asked = asked.model_copy(update={"pulse": message["pulse"]})
    rocker = building.rocker(asked.form == "linear", soft_base=True)
    mark = f"{asked.model_dump_json()} {rocker.body.kind} {rocker.body.parameters.tobytes().hex()} {rocker.start_rotation}"
    known = desk.maps.get(mark)
    if known is not None and known[0]["whole"]:
        words, arrays = known
        yield Reply({"domain": words}, arrays)
        return
    for old in list(desk.maps)[: 1 - MOST_MAPS]:
        del desk.maps[old]
    for step in rocking.domain(live.context(), building, asked):
        desk.maps[mark] = step
        yield Reply({"domain": step[0]}, step[1])
