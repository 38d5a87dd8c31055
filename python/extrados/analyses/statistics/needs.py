"""What statistics of rocking need of a deck: a hazard curve, uncertain values that its structure has."""

from collections.abc import Iterator

from extrados.analyses.context import Context
from extrados.analyses.needs import Need
from extrados.analyses.rocking import needs as rocking
from extrados.analyses.statistics import tables


def needs(context: Context, options: rocking.tables.RockingTable) -> Iterator[Need]:
    """Steps that raise where the deck is wrong, see `analyses.needs`."""
    yield from rocking.needs(context, options)
    if not isinstance(options, tables.Fragility):
        return
    hazard = options.hazard
    if hazard is not None:
        from extrados.analyses.statistics.annual import hazard_curve

        yield lambda: hazard_curve(hazard, context.deck.folder)
    if options.uncertain:
        from extrados.analyses.statistics.uncertain import refuse_unknown

        yield lambda: refuse_unknown(context.building, sorted(options.uncertain))
