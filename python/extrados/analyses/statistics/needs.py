"""What statistics of rocking need of a deck: as many motions as are asked for, a hazard curve, uncertain values that its
structure has."""

import time
from collections.abc import Iterator

from extrados import room
from extrados.analyses.batches import IN_MEMORY
from extrados.analyses.context import Context, Refused
from extrados.analyses.needs import SHARE, Need, refuse_memory
from extrados.analyses.rocking import needs as rocking
from extrados.analyses.rocking.tables import RockingTable
from extrados.analyses.statistics import tables
from extrados.views.building import Building

#: Memory that a run takes until its tables are written [bytes]: where all is kept in memory, and where rows lie on disk;
#: bytes on disk of its rows in tables and results. Measured with 1e4 to 1e6 runs at 500 levels
CELL, CELL_BESIDE_DISK, CELL_ON_DISK = 900, 60, 250
#: So many runs are foretold; their time is that of so many motions before
LONG, TRIED = 100_000, 4


def needs(context: Context, options: RockingTable) -> Iterator[Need]:
    """Steps that raise where the deck is wrong, see `analyses.needs`."""
    yield from rocking.needs(context, options)
    if isinstance(options, tables.RockingSpectrum):
        yield lambda: _refuse_of_spectra(context.building)
    if not isinstance(options, tables.Fragility):
        return
    yield lambda: _refuse_motions(context, options)
    yield lambda: _foretell(context, options)
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
            "a spectrum of blocks uses `restitution`, not `energy_ratio`: give restitution = square root of the energy ratio",
            ("joints", "energy_ratio"),
        )
    if building.supports.stiffness is not None:
        raise Refused(
            "spectra are calculated for structures on rigid ground: remove `stiffness` of [supports], or use `rocking` of a block",
            ("supports", "stiffness"),
        )


def _foretell(context: Context, options: tables.Fragility) -> None:
    """Say how many runs, how much memory and time a long analysis needs; Refused where they do not fit into memory."""
    from extrados.analyses.motion_source import how_many

    count, levels = options.count or how_many(context) or 1000, len(options.levels or [0])
    runs = count * levels * len(options.durations or [0])
    if runs < LONG:
        return
    on_disk = context.out is not None and not options.cloud and options.durations is None and runs > IN_MEMORY
    cell = CELL_BESIDE_DISK if on_disk else CELL
    of = f"{count:,} motions or buildings" + (f" at {levels} level{'s' if levels > 1 else ''}" if options.levels else "")
    key = "count" if options.count or not options.levels else "levels"
    refuse_memory(
        cell * runs,
        f"{of}, {runs:.3g} runs,",
        f"at most {int(SHARE * room.total() / cell * count / runs)} runs fit into the memory",
        ("analysis", key),
    )
    disk = f", {CELL_ON_DISK * runs / 1e9:.2g} GB of disk" if on_disk else ""
    context.tell(
        f"fragility of {of} requires {runs:.3g} runs: about {cell * runs / 1e9:.2g} GB of memory{disk} and "
        f"{_time_of(context, options, runs)}"
    )


def _time_of(context: Context, options: tables.Fragility, runs: int) -> str:
    """The time of so many runs on this machine in words, by that of a few motions."""
    from extrados.analyses.rocking.common import rocker_of
    from extrados.analyses.statistics.fragility import job_of

    few = options.model_copy(update={"count": TRIED})
    base = rocker_of(context, options)
    for _ in range(2):  # the first one loads what it needs
        begin = time.perf_counter()
        job, count, _ = job_of(context, few, base, None)
        job.run(0, count, context.threads)
        seconds = runs / count * (time.perf_counter() - begin)
    for unit, size in (("days", 86400.0), ("h", 3600.0), ("min", 60.0)):
        if seconds > 2.0 * size:
            return f"{seconds / size:.2g} {unit}"
    return f"{seconds:.2g} s"


def _refuse_motions(context: Context, options: tables.Fragility) -> None:
    """Refused where the deck has fewer motions than are asked for, or none of other durations."""
    from extrados.motions.tables import Generated

    if options.durations is not None and not isinstance(context.deck.motion, Generated):
        raise Refused("the key `durations` requires a [motion] of kind 'generated'", ("analysis", "durations"))
    refuse_few_motions(context, options.count, bool(options.uncertain))


def refuse_few_motions(context: Context, count: int | None, uncertain: bool) -> None:
    """Refused where the deck has fewer motions than are asked for, unless each acts on a building of its own."""
    from extrados.analyses.motion_source import how_many

    there = how_many(context)
    if there is not None and count is not None and count > there and not uncertain:
        raise Refused(
            f"the key `count` is {count}, but the deck has {there} motion{'s' if there > 1 else ''}: give at most {there}",
            ("analysis", "count"),
        )
