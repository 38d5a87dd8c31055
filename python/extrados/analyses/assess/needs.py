"""What an assessment needs of a deck: to be the only one."""

from collections.abc import Iterator

from extrados.analyses.assess.tables import Assess
from extrados.analyses.context import Context, Refused
from extrados.analyses.needs import Need


def needs(context: Context, options: Assess) -> Iterator[Need]:
    """Steps that raise where the deck is wrong, see `analyses.needs`."""
    yield lambda: _refuse_second(context, options)


def _refuse_second(context: Context, options: Assess) -> None:
    first = next((a for a in context.deck.analyses if isinstance(a, Assess)), options)
    if first is not options:
        raise Refused("a deck can contain only one analysis of kind assess: write a second deck for the second hazard", ("analysis",))
