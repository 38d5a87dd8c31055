"""What an analysis needs before it computes: `check` tells it and `run` refuses by it, so that the two cannot differ.

A need is a step without mechanics that raises Refused or BadGeometry with the key that is to blame; those that all
kinds share stand here, those of a package in its `needs.py`, which the steps load when they are taken.
"""

import functools
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any

from extrados import kinds, room
from extrados.analyses.context import Context, Refused
from extrados.analyses.table import Analysis
from extrados.limit.errors import CannotStand
from extrados.model.errors import BadGeometry, Key, NoView
from extrados.model.geometry.assembly import Assembly
from extrados.schema.programs import ffmpeg
from extrados.views.building import Building

if TYPE_CHECKING:
    from extrados.model.geometry.solids.assembly import SolidAssembly

Need = Callable[[], Any]
#: Share of the machine's memory that the numbers of one analysis may take
SHARE = 0.8
#: Keys that ask for solids
SPATIAL = ("direction", "rose", "pyramids", "block_size")


def complaints(context: Context, options: Analysis, building: Building) -> list[str]:
    """All that keeps an analysis of a building from being begun, each with file, line and key; empty where it can be."""
    context.building = building
    found = []
    for need in _needs(context, options):
        try:
            need()
        except (Refused, BadGeometry) as error:
            found.append(context.complaint(options, error))
        except CannotStand:  # the answer of the analysis, no fault of the deck
            continue
    return list(dict.fromkeys(found))


def _needs(context: Context, options: Analysis) -> Iterator[Need]:
    building = context.building
    for what, key in building.special_keys.items() if options.view or options.uses else ():
        if what not in options.considers:
            yield _refused(f"{options.kind} cannot include {what}: remove it from the deck of this analysis, or use {_who(what)}", key)
    if getattr(options, "animation", "none") == "mp4" and ffmpeg() is None:
        yield _refused(
            '"mp4" requires the program ffmpeg or the package imageio-ffmpeg, and neither is installed. "gif" requires neither',
            ("analysis", "animation"),
        )
    if options.needs_motion:
        yield context.refuse_motion
    if as_shell(building, options):
        yield building.shell
    elif options.view == "blocks":
        yield lambda: _bound(building, options)
    elif options.view == "shell":
        yield functools.partial(building.shell, getattr(options, "mesh", None))
    yield from kinds.load(kinds.ANALYSES[options.kind].needs)(context, options)


def refuse_memory(needed: float, what: str, cure: str, key: Key) -> None:
    """Refused, before a long run, where its numbers take more memory [bytes] than the machine has; `cure` says what takes less."""
    there = room.total()
    if needed > SHARE * there:
        raise Refused(
            f"{what} requires about {needed / 1000000000.0:.3g} GB of memory, but this machine has {there / 1000000000.0:.3g} GB; {cure}",
            key,
        )


def as_shell(building: Building, options: Analysis) -> bool:
    """Whether an analysis of stones takes this building, which has none, as shells."""
    return building.structure is not None and building.structure.kind in options.shells


def stones_of(building: Building, options: Analysis) -> "Assembly | SolidAssembly":
    """What an analysis sees of the stones: solids where it asks for them, or there is no plane section."""
    asks = any(getattr(options, key, None) is not None for key in SPATIAL) or getattr(options, "vary", None) == "direction"
    if options.solid and asks:
        return building.solids()
    try:
        return building.blocks()
    except NoView as plane:
        if not options.solid:
            raise
        try:
            return building.solids()
        except NoView:
            raise plane from None


def in_space(building: Building, options: Analysis) -> bool:
    """Whether an analysis takes the stones as solids."""
    return not isinstance(stones_of(building, options), Assembly)


def _bound(building: Building, options: Analysis) -> None:
    """The stones with their joints and ties."""
    stones = stones_of(building, options)
    building.refuse_weightless(None if isinstance(stones, Assembly) else stones)
    if isinstance(stones, Assembly):
        building.friction()
        if building.ties:
            building.anchored()
    else:
        building.friction(stones)
        if building.ties:
            building.strands()


def _refused(text: str, key: Key) -> Need:
    def refuse() -> None:
        raise Refused(text, key)

    return refuse


def _who(what: str) -> str:
    """Analyses that take into account a thing, as words."""
    able = [kind for kind, parts in kinds.ANALYSES.items() if what in kinds.load(parts.table).considers]
    return " or ".join([", ".join(able[:3]), *able[3:4]]) if len(able) <= 4 else f"{', '.join(able[:3])} and others"
