"""What the push of a building needs of a deck: walls and feet that it names, and of its piers' formulas a strength."""

from collections.abc import Iterator

from extrados.analyses.codes.actions import refuse_mixed
from extrados.analyses.codes.verification import demands
from extrados.analyses.context import Context, Refused
from extrados.analyses.needs import Need
from extrados.analyses.shell.tables import Pushover
from extrados.model.structures.plan import Plan
from extrados.views.building import Building


def needs(context: Context, options: Pushover) -> Iterator[Need]:
    """Steps that raise where the deck is wrong, see `analyses.needs`."""
    building = context.building
    yield lambda: _places(building, options)
    yield lambda: _verified(context, options)
    if not isinstance(building.structure, Plan):
        yield lambda: _refuse_floors(building, options)
    if options.frame is not None:
        yield lambda: pier_strength(building, options)


def _places(building: Building, options: Pushover) -> None:
    """The mesh, and its nodes at all places of drives, settlements and stages; no pattern has to be solved for that."""
    from extrados.analyses.shell.model import build

    build(building.shell(options.mesh), options.model_copy(update={"pattern": "mass"}))


def _verified(context: Context, options: Pushover) -> None:
    """The action of the verification belongs to the code of the deck, and the building has walls on a plan."""
    refuse_mixed(context, options.verification)
    if options.verification.model_fields_set and not isinstance(context.building.structure, Plan):
        raise Refused("verification by displacement requires a building given by walls in plan", ("analysis", "verification"))
    demands(context, options.verification)


def _refuse_floors(building: Building, options: Pushover) -> None:
    for k, variant in enumerate(options.variants):
        for name, what in (("floors", "floors"), ("prestress", "forces on walls")):
            if getattr(variant, name) != 1.0 and building.structure is not None:
                raise Refused(f"a structure of kind '{building.structure.kind}' has no {what}", ("analysis", "variants", k, name))


def pier_strength(building: Building, options: Pushover) -> float:
    """f_m of the formulas of piers [Pa]; Refused where the deck says none, or has no piers."""
    key = ("analysis", "frame")
    if not isinstance(building.structure, Plan):
        raise Refused("frame: piers require a building given by walls in plan", key)
    if options.drives:
        raise Refused("frame: with `drives`, the distribution of the load over the storeys is not known: remove `frame`", key)
    strength = (options.frame and options.frame.compressive_strength) or building.material.compressive_strength
    if strength is None:
        raise Refused("frame: the formulas of piers require `compressive_strength` (f_m), in this table or in [material]", key)
    return strength
