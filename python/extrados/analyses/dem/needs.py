"""What analyses with discrete elements need of a deck: names that are there, one elastic material, a motion."""

from collections.abc import Iterator
from functools import partial

import numpy as np

from extrados import room
from extrados.analyses.context import Context, Refused
from extrados.analyses.dem import tables
from extrados.analyses.dem.sampled import refuse_uncertain
from extrados.analyses.dem.solid_model import refusals, refuse_shoves, refuse_stones, wet_section
from extrados.analyses.dem.ties import refuse_rigid_ties, section_strands
from extrados.analyses.needs import SHARE, Need, stones_of
from extrados.analyses.statistics.annual import hazard_curve
from extrados.analyses.statistics.needs import refuse_few_motions
from extrados.model.errors import BadGeometry, Key
from extrados.model.geometry.anchors import moved_joints
from extrados.model.geometry.assembly import Assembly
from extrados.model.geometry.solids.assembly import SolidAssembly
from extrados.model.geometry.water import water_pressure
from extrados.model.properties import NO_SLIDING_COEFFICIENT
from extrados.model.structures.arch import ArchAssembly
from extrados.model.structures.block import BlockAssembly
from extrados.views.building import Building
from extrados.views.solids.strands import damper_strands

#: Numbers that a history holds of a block and of a joint at each time, its copies for tables included
VALUES_OF_BLOCK, VALUES_OF_JOINT = 20, 12


def needs(context: Context, options: tables.DemTable) -> Iterator[Need]:
    """Steps that raise where the deck is wrong, see `analyses.needs`."""
    building = context.building
    if isinstance(options, tables.DemFragility):
        yield from _needs_of_many(context, options)
    try:
        stones = stones_of(building, options)
    except BadGeometry:
        return  # told already
    if not isinstance(stones, Assembly):
        assert isinstance(options, tables.SpatialDem)  # the others take sections alone
        yield from _needs_of_solids(context, options, stones)
        return
    yield building.refuse_mixture
    if options.merge == "three-bars":
        yield lambda: _refuse_bars(building)
    if _rigid(options):
        yield lambda: _refuse_springs(building)
        yield lambda: _refuse_sliding_mortar(building)
    if isinstance(options, tables.SpatialDem) and options.crushing:
        yield lambda: _refuse_crushing(building, None, _rigid(options))
    if isinstance(options, tables.Dem) and options.thrust:
        yield lambda: _refuse_worn_thrust(building)
    if isinstance(options, tables.Dem) and (water := options.water) is not None:
        yield partial(_refuse_water, stones, water)
    yield lambda: refuse_rigid_ties(building)
    yield lambda: section_strands(building)
    if building.joints.damping == "restitution" and building.joints.beta is None:
        yield lambda: _refuse_restitution(building)
    if building.initial.movements:
        yield building.moved
    if isinstance(options, tables.Dem):
        yield lambda: _refuse_long(options, len(stones.block_names), len(stones.a))
        if context.deck.motion is not None and options.test == "motion":
            yield context.refuse_motion
        if options.track:
            yield lambda: refuse_untracked(stones.block_names, options)


def _needs_of_many(context: Context, options: tables.DemFragility) -> Iterator[Need]:
    """What an ensemble needs: motions, a hazard curve, uncertain values that the structure has."""
    yield lambda: refuse_uncertain(context.building, options)
    yield lambda: refuse_few_motions(context, options.count, bool(options.uncertain))
    hazard = options.hazard
    if hazard is not None:
        yield lambda: hazard_curve(hazard, context.deck.folder)


def _refuse_long(options: tables.Dem, blocks: int, joints: int) -> None:
    """Refused where the history of a run of a given length does not fit into memory."""
    if options.end_time is None:
        return
    values = VALUES_OF_BLOCK * blocks + VALUES_OF_JOINT * joints
    most = SHARE * room.total() / (8.0 * values)
    if options.end_time / options.output_step > most:
        raise Refused(
            f"a history of {options.end_time:g} s in steps of {options.output_step:g} s is too long to store: "
            f"give an `output_step` of at least {options.end_time / most:.2g} s",
            ("analysis", "output_step"),
        )


def _rigid(options: tables.DemTable) -> bool:
    """Whether rigid contacts are asked for, be it as a check of the springs."""
    return options.rigid or (isinstance(options, tables.DemDomain) and options.cross_check)


def _refuse_bars(building: Building) -> None:
    key = ("analysis", "merge")
    if not isinstance(building.blocks(), ArchAssembly):
        raise Refused('merge = "three-bars" is only for arches: remove `merge`', key)
    if building.initial.rotation_ratio:
        raise Refused('merged voussoirs cannot start with a rotation: with `rotation_ratio` of [initial], give merge = "none"', key)


def _refuse_springs(building: Building) -> None:
    """Refused where rigid contacts are asked for what only springs have."""
    if building.supports.stiffness is not None:
        text = 'rigid contacts (solver = "nonsmooth", or `cross_check`) cannot follow a compliant base: remove `stiffness`'
        raise Refused(text, ("supports", "stiffness"))


def _refuse_sliding_mortar(building: Building, solids: SolidAssembly | None = None) -> None:
    """Refused where mortar is on rigid contacts that cannot slide: Coulomb's law allows it no tension. solids: in space."""
    cohesion, tension, friction = (building.joint_property(name, solids) for name in ("cohesion", "tension", "friction"))
    if ((np.fmax(cohesion, tension) > 0.0) & (friction >= NO_SLIDING_COEFFICIENT)).any():
        raise Refused(
            'rigid contacts with friction = "no-sliding" cannot have mortar: give the coefficient of friction, or remove `cohesion` and '
            "`tension`",
            ("joints", "friction"),
        )


def _refuse_crushing(building: Building, solids: SolidAssembly | None, rigid: bool) -> None:
    """Refused where corners are to crush without a strength, on rigid contacts, or at joints with mortar."""
    key = ("analysis", "crushing")
    if building.material.compressive_strength is None:
        raise Refused("crushing of corners requires `compressive_strength` of [material]", key)
    if rigid:
        raise Refused("crushing of corners requires springs, but `cross_check` also uses rigid contacts: remove `cross_check`", key)
    for name in ("cohesion", "tension"):
        if np.nanmax(building.joint_property(name, solids), initial=0.0) > 0.0:
            raise Refused(
                "`crushing` is only for joints without mortar: remove `cohesion` and `tension`, or remove `crushing`", ("joints", name)
            )


def _refuse_water(stones: Assembly, water: tables.Water) -> None:
    """Refused where the level is not within the height of the structure or the water wets no face, for a structure with fill, and for linear
    uplift in a section with openings."""
    outline = np.concatenate(stones.outlines)
    low, high = outline.min(axis=0), outline.max(axis=0)
    if not low[1] < water.level <= high[1]:
        raise Refused(
            f"the water level is {water.level:.4g} m, but the structure extends from {low[1]:.4g} to {high[1]:.4g} m: give a level within",
            ("analysis", "water", "level"),
        )
    if stones.fill is not None:
        raise Refused("the water pressure on a structure with fill is not calculated: remove `water` or the fill", ("analysis", "water"))
    try:
        pressure = water_pressure(stones, water.level, water.side, water.uplift, water.density)
    except BadGeometry as error:
        raise Refused(str(error), ("analysis", "water", "uplift")) from None
    if not pressure.force.any():
        raise Refused(
            f"water at a level of {water.level:.4g} m on the {water.side} wets no face of the structure: give a higher level",
            ("analysis", "water", "level"),
        )


def _refuse_worn_thrust(building: Building) -> None:
    """Refused where forces are to be placed in joints that are shorter than drawn."""
    if building.joints.worn_corners > 0.0:
        raise Refused(
            "the forces and stresses of `thrust` refer to joints as drawn, but worn corners shorten the joints: remove one of both keys",
            ("joints", "worn_corners"),
        )


def _refuse_restitution(building: Building) -> None:
    if not isinstance(building.blocks(), BlockAssembly):
        raise Refused(
            'damping = "restitution" applies only to a single block: give damping = "edge", and repeat the run with other damping ratios',
            ("joints", "damping"),
        )


def _needs_of_solids(context: Context, options: tables.SpatialDem, stones: SolidAssembly) -> Iterator[Need]:
    building = context.building

    def refuse(text: str, key: Key) -> None:
        raise Refused(text, key)

    for text, key in refusals(building, options):
        yield partial(refuse, text, key)
    yield lambda: refuse_stones(stones)
    if options.crushing:
        yield lambda: _refuse_crushing(building, stones, _rigid(options))
    if _rigid(options):
        yield lambda: _refuse_sliding_mortar(building, stones)
    yield lambda: refuse_rigid_ties(building)
    yield building.strands
    yield lambda: damper_strands(building)
    if not isinstance(options, tables.Dem):
        return
    if (water := options.water) is not None:
        yield lambda: _refuse_water(wet_section(building, stones), water)
    yield lambda: refuse_shoves(building, stones)
    yield lambda: moved_joints(stones, [one.joint for one in building.initial.movements])
    yield lambda: _refuse_long(options, len(stones.block_names), len(stones.a))
    if context.deck.motion is not None and options.test == "motion":
        yield context.refuse_motion
    if options.track:
        yield lambda: refuse_untracked(stones.block_names, options)


def refuse_untracked(names: list[str], options: tables.Dem) -> None:
    """Refused where a block that is to be followed is not there."""
    for k, name in enumerate(options.track):
        if name not in names:
            raise Refused(f"no block has the name '{name}'; the first names are {', '.join(names[:8])}", ("analysis", "track", k))
