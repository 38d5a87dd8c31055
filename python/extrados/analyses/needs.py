"""What an analysis needs before it computes: `check` tells it and `run` refuses by it, so that the two cannot differ.

A need is a step without mechanics that raises Refused or BadGeometry with the key that is to blame; those that all
kinds share stand here, those of a room in its `needs.py`, which the steps load when they are taken.
"""

import importlib
from collections.abc import Callable, Iterator
from typing import Any

from extrados import kinds
from extrados.analyses.context import Context, Refused
from extrados.analyses.table import Analysis
from extrados.building.building import Building
from extrados.building.errors import BadGeometry, Key
from extrados.schema.programs import ffmpeg

Need = Callable[[], Any]
#: Rooms whose kinds need more than all do
ROOMS = ("limit", "rocking", "statistics", "codes", "motion", "dem", "sla")


def complaints(context: Context, options: Analysis, building: Building) -> list[str]:
    """All that keeps an analysis of a building from being begun, each with file, line and key; empty where it can be."""
    context.building = building
    found = []
    for need in _needs(context, options):
        try:
            need()
        except (Refused, BadGeometry) as error:
            found.append(context.complaint(options, error))
    return list(dict.fromkeys(found))


def _needs(context: Context, options: Analysis) -> Iterator[Need]:
    building = context.building
    for what, key in building.special_keys.items() if options.view or options.uses else ():
        if what not in options.bears:
            yield _refused(
                f"{options.kind} does not reckon with {what}: leave it out of its deck, or ask {_who(what)}", key
            )
    if getattr(options, "animation", "none") == "mp4" and ffmpeg() is None:
        yield _refused(
            '"mp4" needs the program ffmpeg or the package imageio-ffmpeg, and neither is here; "gif" needs nothing',
            ("analysis", "animation"),
        )
    if options.needs_motion:
        yield context.refuse_motion
    if options.view == "blocks":
        yield building.blocks
        yield building.friction
        if building.ties:
            yield building.anchored
    room = kinds.ANALYSES[options.kind].table.split(".")[1]
    if room in ROOMS:
        yield from importlib.import_module(f"extrados.analyses.{room}.needs").needs(context, options)


def _refused(text: str, key: Key) -> Need:
    def refuse() -> None:
        raise Refused(text, key)

    return refuse


def _who(what: str) -> str:
    """Analyses that reckon with a thing, as words."""
    able = [kind for kind, parts in kinds.ANALYSES.items() if what in kinds.load(parts.table).bears]
    return " or ".join([", ".join(able[:3]), *able[3:4]]) if len(able) <= 4 else f"{', '.join(able[:3])} and others"
