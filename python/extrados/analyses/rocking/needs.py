"""What analyses of rocking need of a deck: what holds the structure, how its supports move, variants of it."""

import functools
from collections.abc import Iterator

from extrados.analyses.changes import changed, read_table
from extrados.analyses.context import Context, Refused
from extrados.analyses.needs import Need
from extrados.analyses.rocking import tables
from extrados.model.errors import BadGeometry
from extrados.model.structure import Structure
from extrados.views.building import Building
from extrados.views.rockers.stack import rocks_as_stack
from extrados.views.rockers.words import refuse_stack, refuse_words


def needs(context: Context, options: tables.RockingTable) -> Iterator[Need]:
    """Steps that raise where the deck is wrong, see `analyses.needs`."""
    building, structure = context.building, context.building.structure
    if structure is None or not options.view:
        return
    stones = building.pier_blocks if structure.rocks_as == "piers" else building.blocks
    yield lambda: building.refuse_weightless(stones())
    if options.soft_base and rocks_as_stack(building):
        yield functools.partial(refuse_stack, building, options.form == "linear")
    elif building.supports.stiffness is not None and options.soft_base:
        yield lambda: _refuse_soft_base(building, options)
    else:
        yield functools.partial(refuse_words, building, options.form == "linear")
        if building.restraints:
            from extrados.views.rockers.restraints import restraints_of

            yield from restraints_of(building, stones)
    if building.initial.movements:
        from extrados.analyses.rocking.common import refuse_movements, shifts_of

        yield lambda: shifts_of(building) if isinstance(options, tables.Rocking) else refuse_movements(context)
    if isinstance(options, tables.FailureCurves) and options.variants:
        yield lambda: structures_of(context, options)


def structures_of(context: Context, options: tables.FailureCurves) -> list[Structure]:
    """The structure with each of the variants; Refused where one is wrong."""
    building, data = context.building, context.deck.data["structure"]
    found = []
    for number, change in enumerate(options.variants or [{}]):
        key = ("analysis", "variants", number)
        if "kind" in change:
            raise Refused(f"a variant can change keys of '{data['kind']}', but not the kind of the structure", (*key, "kind"))
        try:
            table = functools.reduce(lambda table, name: changed(table, name, change[name]), change, data)
            found.append(read_table(type(building.require_structure()), table))
        except (BadGeometry, Refused, ValueError) as error:
            raise Refused(f"variant {number + 1}: {error}" if options.variants else str(error), key) from None
    return found


def _refuse_soft_base(building: Building, options: tables.RockingTable) -> None:
    """Refused where a compliant base does not carry the building, or nothing but `dem` follows it there."""
    from extrados.views.rockers.soft_base import soft_base_model

    _ = soft_base_model(building, options.form == "linear").rest
