"""What a sequentially linear analysis needs of a deck: a mesh with nodes at all places that it names, files that are there."""

from collections.abc import Iterator

from extrados.analyses.codes.actions import refuse_mixed
from extrados.analyses.context import Context, Refused
from extrados.analyses.needs import Need
from extrados.analyses.sla.tables import Sla
from extrados.model.errors import BadGeometry
from extrados.views.building import Building


def needs(context: Context, options: Sla) -> Iterator[Need]:
    """Steps that raise where the deck is wrong, see `analyses.needs`."""
    building = context.building
    yield lambda: _places(building, options)
    yield lambda: refuse_mixed(context, options.verification)
    if options.verification.model_fields_set and building.meshed_by_stones:
        yield _refuse_stones
    if options.measured is not None:
        from extrados.analyses.sla.measured import read_measured

        yield lambda: read_measured(context, str(options.measured))
    if options.seeds:
        from extrados.analyses.sla.repetitions import refuse_alike

        yield lambda: refuse_alike(building, options)
    if options.resume_from is not None:
        from extrados.analyses.sla.resume import read_earlier

        yield lambda: read_earlier(context, options)


def _refuse_stones() -> None:
    raise Refused("verification by displacement is only for walls without blocks", ("analysis", "verification"))


def _places(building: Building, options: Sla) -> None:
    """The mesh, and the nodes at all places of supports, loads and stages."""
    from extrados.analyses.sla.model import build, nodal_forces, refusal, strength_factors
    from extrados.analyses.sla.stages import Supports

    mesh = building.mesh(options.mesh)
    model = build(mesh, options, strength_factors(mesh, options, options.strength_seed))
    if not options.stages:
        return
    supports = Supports(model)
    try:
        for k, stage in enumerate(options.stages):
            what = f"stages[{k}]"
            supports.at(stage.hold, f"{what}.hold")
            supports.at(stage.free, f"{what}.free")
            if stage.moves:
                supports.rates(stage, f"{what}.reference[0]")
            else:
                nodal_forces(mesh, stage.reference, f"{what}.reference")
    except BadGeometry as error:
        raise refusal(error) from None
