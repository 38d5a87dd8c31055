"""What limit analyses need of a deck: places of loads, names of chains, tables and keys that are there."""

import functools
from collections.abc import Iterator

from extrados.analyses.context import Context, Refused
from extrados.analyses.limit import tables
from extrados.analyses.limit.asked import cuts_of, deviation_of, refuse_still, refuse_unruled, sections_of, values_of
from extrados.analyses.needs import Need, stones_of
from extrados.analyses.table import BuildingAnalysis
from extrados.model.errors import BadGeometry, Key
from extrados.model.geometry.assembly import Assembly
from extrados.views.building import Building


def needs(context: Context, options: BuildingAnalysis) -> Iterator[Need]:
    """Steps that raise where the deck is wrong, see `analyses.needs`."""
    building = context.building
    try:
        if not isinstance(stones_of(building, options), Assembly):
            yield lambda: _refuse_of_sections(building, options)
            if getattr(options, "block_size", None):
                yield functools.partial(refuse_unruled, building)
            for k, load in enumerate(getattr(options, "load", [])):
                yield functools.partial(_place, building, load, k)
            yield from _needs_of_many(context, options)
            if isinstance(options, tables.Thrust):
                yield functools.partial(cuts_of, building, options)
            return  # solids have no chains and trains
    except BadGeometry:
        return  # told already
    if getattr(options, "mortar", "neglected") == "ductile":
        yield _refuse_mortar
    for k, load in enumerate(getattr(options, "load", [])):
        if load.z is not None:
            yield functools.partial(_refuse_height, k)
        yield functools.partial(_placed, building, load, k)
    if isinstance(options, tables.LimitAnalysisTable) and getattr(options, "fracture", False):
        yield functools.partial(refuse_fracture, building, options)
    if getattr(options, "buttress_alone", False):
        yield lambda: _refuse_alone(building)
    if (chain := getattr(options, "chain", None)) is not None:
        from extrados.analyses.limit.applied import chain_of

        yield lambda: chain_of(building.blocks(), chain)
    yield from _needs_of_many(context, options)
    match options:
        case tables.Thrust() if options.section:
            yield _refuse_sections
        case tables.MovingLoad():
            from extrados.analyses.limit.trains import fitting_train

            yield lambda: fitting_train(building, options)
        case tables.MovingSupports():
            yield lambda: refuse_still(building, options)


def _needs_of_many(context: Context, options: BuildingAnalysis) -> Iterator[Need]:
    """What sweeps, surveys and random surveys need, in the plane and in space."""
    match options:
        case tables.Sweep():
            yield lambda: values_of(context.building, options)
        case tables.Survey():
            yield lambda: sections_of(context, options)
        case tables.Imperfections():
            yield lambda: deviation_of(context.building, options)


def _refuse_sections() -> None:
    raise Refused(
        "the key `section` applies only to analyses of blocks in space: give `direction` too. To analyse the plane section, give the key "
        "`chain` instead",
        ("analysis", "section"),
    )


def _refuse_mortar() -> None:
    raise Refused(
        'mortar = "ductile" is only for blocks in space: give `direction` to analyse the blocks in space, or remove `mortar`',
        ("analysis", "mortar"),
    )


def _placed(building: Building, load: tables.AppliedLoad, number: int) -> None:
    """Refused where a load acts on no block of the section."""
    from extrados.analyses.limit.applied import pieces

    pieces(building.blocks(), load, number)


def _refuse_of_sections(building: Building, options: BuildingAnalysis) -> None:
    """Refused where a deck asks of solids what is known in a plane section alone."""
    crushes, slides = building.material.compressive_strength is not None, getattr(options, "friction_rule", "") == "non-associated"
    asked: dict[str, tuple[bool, Key]] = {
        **{name: (bool(getattr(options, name, None)), ("analysis", name)) for name in ("fracture", "buttress_alone", "chain")},
        "crushing": (crushes and isinstance(options, tables.Thrust), ("material", "compressive_strength")),
        "pyramids with crushing": (crushes and getattr(options, "pyramids", None) is not None, ("analysis", "pyramids")),
    }
    for what, (there, key) in asked.items():
        if there:
            raise Refused(f"{options.kind} of solids cannot include {what}: remove it, or analyse a plane section", key)
    mortar = getattr(options, "mortar", "neglected") == "ductile"
    if slides and (crushes or mortar):
        raise Refused(
            f'sliding without dilatancy of solids cannot include {"mortar" if mortar else "crushing"}: give friction_rule = "associated"',
            ("analysis", "friction_rule"),
        )


def _place(building: Building, load: tables.AppliedLoad, number: int) -> None:
    from extrados.analyses.limit.applied import place_of

    place_of(building.solids(), load, number)


def _refuse_height(number: int) -> None:
    raise Refused("the key `z` is only for blocks in space: in a plane section, give the height as `y`", ("analysis", "load", number, "z"))


def _refuse_alone(building: Building) -> None:
    if not building.blocks().buttresses:
        raise Refused("`buttress_alone` requires a buttress on the ground: a vault or an aisled vault", ("analysis", "buttress_alone"))


def refuse_fracture(building: Building, options: tables.LimitAnalysisTable) -> None:
    """Refused where fracture of the leeward buttress cannot be followed."""
    key = ("analysis", "fracture")
    assembly = building.blocks()
    if not assembly.buttresses:
        raise Refused("the key `fracture` requires a buttress on the ground: a vault or an aisled vault", key)
    if building.material.compressive_strength is not None or options.friction_rule != "associated":
        raise Refused(
            "the key `fracture` excludes crushing and sliding without dilatancy: remove `fracture`, or "
            'remove `compressive_strength` and give friction_rule = "associated"',
            key,
        )
    leeward = assembly.buttresses[-1]
    if building.ties and (building.anchored().block == leeward).any():
        raise Refused(
            f"a tie is anchored in {assembly.block_names[leeward]}. The analysis does not decide whether the crack separates the anchor "
            "from the rest of this buttress. Remove `fracture`, or anchor the tie at another block",
            key,
        )
