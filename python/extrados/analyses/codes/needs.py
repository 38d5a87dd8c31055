"""What the rules of codes need of a deck: a motion and a spectrum that can be read, of a wall what makes it a pier, of a
mechanism its sizes."""

from collections.abc import Iterator

from extrados.analyses.codes.mechanisms import overturning
from extrados.analyses.codes.tables import CodeChecks, LocalMechanism
from extrados.analyses.codes.walls import wall_parts
from extrados.analyses.context import Context, Refused
from extrados.analyses.needs import Need
from extrados.analyses.table import Analysis
from extrados.building.building import Building
from extrados.building.templates.plan import Plan


def needs(context: Context, options: Analysis) -> Iterator[Need]:
    """Steps that raise where the deck is wrong, see `analyses.needs`."""
    building, structure = context.building, context.building.structure
    if isinstance(options, LocalMechanism):
        if options.mechanism == "building":
            yield lambda: _refuse_nothing(building)
            if isinstance(structure, Plan):
                yield lambda: wall_parts(building)
        else:
            yield lambda: overturning(options, building.material.density, building.material.compressive_strength)
    if not isinstance(options, CodeChecks):
        return
    wall = structure is not None and structure.rocks_as == "piers"
    if wall:
        yield lambda: _refuse_wall(building, options)
    else:
        yield building.blocks
        if context.deck.motion is not None:
            yield context.refuse_motion
        if options.spectrum is not None:
            from extrados.analyses.codes.code_checks import spectrum_of

            yield lambda: spectrum_of(context, options.spectrum)(0.0, 0.05)
    if (wall or options.axial_load is not None) and building.material.compressive_strength is None:
        yield lambda: _refuse_weak()


def _refuse_nothing(building: Building) -> None:
    if building.structure is None:
        raise Refused('"building" needs a [structure]', ("analysis", "mechanism"))


def _refuse_wall(building: Building, options: CodeChecks) -> None:
    if options.axial_load is None:
        raise Refused("a wall is checked as a pier: give axial_load", ("analysis",))
    if len(building.pier_blocks().mass) > 1:
        raise Refused(
            "the pier rules are for a rectangle without openings: check each pier between openings as its own panel",
            ("structure",),
        )


def _refuse_weak() -> None:
    raise Refused("the pier rules need [material] compressive_strength (f_m)", ("material",))
