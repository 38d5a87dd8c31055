"""What statistics of rocking need of a deck: as many motions as are asked for, a hazard curve, uncertain values that its
structure has."""

from collections.abc import Iterator

from extrados import room
from extrados.analyses.context import Context, Refused
from extrados.analyses.needs import SHARE, Need, refuse_memory
from extrados.analyses.rocking import needs as rocking
from extrados.analyses.statistics import tables
from extrados.views.building import Building

#: Memory that a run at one level takes until its tables are written [bytes]; measured with 1e4 to 2e5 of them
CELL = 900


def needs(context: Context, options: rocking.tables.RockingTable) -> Iterator[Need]:
    """Steps that raise where the deck is wrong, see `analyses.needs`."""
    yield from rocking.needs(context, options)
    if isinstance(options, tables.RockingSpectrum):
        yield lambda: _refuse_of_spectra(context.building)
    if not isinstance(options, tables.Fragility):
        return
    yield lambda: _refuse_motions(context, options)
    if options.levels is not None:
        yield lambda: _refuse_cells(context, options)
    hazard = options.hazard
    if hazard is not None:
        from extrados.analyses.statistics.annual import hazard_curve

        yield lambda: hazard_curve(hazard, context.deck.folder)
    if options.uncertain:
        from extrados.analyses.statistics.uncertain import refuse_unknown

        yield lambda: refuse_unknown(context.building, sorted(options.uncertain))


def _refuse_of_spectra(building: Building) -> None:
    if building.joints.energy_ratio is not None:
        raise Refused(
            "spectra take restitution, of these blocks the square root of the energy ratio", ("joints", "energy_ratio")
        )
    if building.supports.stiffness is not None:
        raise Refused(
            "spectra are those of structures on rigid ground; leave it out, or ask `rocking` of a block",
            ("supports", "stiffness"),
        )


def _refuse_cells(context: Context, options: tables.Fragility) -> None:
    """Refused where a run at each level for each motion, or building, does not fit into memory."""
    from extrados.analyses.motion_source import how_many

    assert options.levels is not None
    count, levels = options.count or how_many(context) or 1000, len(options.levels)
    most = int(SHARE * room.total() / CELL / levels)
    refuse_memory(CELL * count * levels, f"{count} motions or buildings at {levels} levels, {count * levels:.3g} runs,",
                  f"at most {most} fit", ("analysis", "count" if options.count else "levels"))  # fmt: skip


def _refuse_motions(context: Context, options: tables.Fragility) -> None:
    """Refused where the deck has fewer motions than are asked for, or none of other durations."""
    from extrados.analyses.motion_source import how_many
    from extrados.motions.tables import Generated

    if options.durations is not None and not isinstance(context.deck.motion, Generated):
        raise Refused("needs a [motion] of kind 'generated'", ("analysis", "durations"))
    there = how_many(context)
    if there is not None and options.count is not None and options.count > there and not options.uncertain:
        raise Refused(
            f"{options.count}, but the deck has {there} motion{'s' if there > 1 else ''}: expected at most {there}",
            ("analysis", "count"),
        )
