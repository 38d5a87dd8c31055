"""What studies of motions need of a deck: a motion that can be made, frequencies in their order."""

from collections.abc import Iterator

from extrados.analyses.context import Context, Refused
from extrados.analyses.motion import tables
from extrados.analyses.needs import Need
from extrados.analyses.table import Analysis


def needs(context: Context, options: Analysis) -> Iterator[Need]:
    """Steps that raise where the deck is wrong, see `analyses.needs`."""
    if isinstance(options, tables.ShakeTable):
        yield lambda: _refuse_backward(options)
        if context.deck.motion is not None:
            yield context.refuse_motion


def _refuse_backward(options: tables.ShakeTable) -> None:
    if options.highest <= options.lowest:
        raise Refused(f"highest = {options.highest:g} Hz is not above lowest = {options.lowest:g} Hz", ("analysis", "highest"))
