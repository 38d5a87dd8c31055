"""What analyses with discrete elements need of a deck: names that are there, one elastic material, a motion."""

from collections.abc import Iterator

from extrados.analyses.context import Context, Refused
from extrados.analyses.dem import tables
from extrados.analyses.needs import Need
from extrados.building.building import Building
from extrados.building.templates.arch import ArchAssembly


def needs(context: Context, options: tables.DemTable) -> Iterator[Need]:
    """Steps that raise where the deck is wrong, see `analyses.needs`."""
    building = context.building
    yield building.refuse_mixture
    if options.merge == "three-bars":
        yield lambda: _refuse_bars(building)
    if building.initial.movements:
        yield building.moved
    if isinstance(options, tables.Dem):
        if context.deck.motion is not None and options.test == "motion":
            yield context.refuse_motion
        if options.track:
            yield lambda: refuse_untracked(building, options)


def _refuse_bars(building: Building) -> None:
    key = ("analysis", "merge")
    if not isinstance(building.blocks(), ArchAssembly):
        raise Refused('merge = "three-bars" needs an arch', key)
    if building.initial.rotation_ratio:
        raise Refused('[initial] rotation_ratio: glued voussoirs do not start rotated; merge = "none" does', key)


def refuse_untracked(building: Building, options: tables.Dem) -> None:
    """Refused where a block that is to be followed is not there."""
    names = building.blocks().block_names
    for k, name in enumerate(options.track):
        if name not in names:
            raise Refused(f"names no block '{name}'; there are {', '.join(names[:8])}", ("analysis", "track", k))
