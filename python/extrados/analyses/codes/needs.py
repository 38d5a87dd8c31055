"""What the rules of codes need of a deck: a motion and a spectrum that can be read, of a wall what makes it a pier, of a
mechanism its sizes."""

import contextlib
from collections.abc import Iterator
from functools import partial

from extrados.analyses.codes.actions import actions, code_of, refuse_mixed
from extrados.analyses.codes.kinematics import NoMechanism
from extrados.analyses.codes.mechanisms import body_of
from extrados.analyses.codes.tables import CodeChecks, LocalMechanism
from extrados.analyses.codes.walls import wall_parts
from extrados.analyses.context import Context, Refused
from extrados.analyses.needs import Need
from extrados.analyses.table import Analysis
from extrados.model.errors import Key
from extrados.model.structures.plan import Plan
from extrados.views.building import Building

#: What of the table describes a body by itself; and where on a building it stands, which a plan says of each of its walls
OF_A_BODY = (
    "height",
    "thickness",
    "width",
    "hinge_height",
    "crack_angle",
    "abutment_force",
    "wings",
    "period",
    "floors",
    "ties",
    "side_walls",
    "interlocking",
)
OF_A_PLACE = ("base_height", "building_height", "storeys")


def needs(context: Context, options: Analysis) -> Iterator[Need]:
    """Steps that raise where the deck is wrong, see `analyses.needs`."""
    building, structure = context.building, context.building.structure
    if isinstance(options, LocalMechanism | CodeChecks):
        yield lambda: refuse_mixed(context, options)
    if isinstance(options, LocalMechanism):
        yield lambda: _refuse_elsewhere(context, options)
        if not options.of_stones(building):
            for what, key in building.special_keys.items():
                yield partial(_refuse_unheld, what, key)
        if options.mechanism == "building":
            yield lambda: _refuse_nothing(building)
            for name in sorted(options.model_fields_set & {*OF_A_BODY, *(OF_A_PLACE if isinstance(structure, Plan) else ())}):
                yield partial(_refuse_given, name)
            if isinstance(structure, Plan):
                yield lambda: _read_walls(building)
        else:
            yield lambda: body_of(options, building.material.density, building.material.compressive_strength)
    if not isinstance(options, CodeChecks):
        return
    wall = structure is not None and structure.rocks_as == "piers"
    if wall:
        yield lambda: _refuse_wall(building, options)
    else:
        yield building.blocks
        if context.deck.motion is not None:
            yield context.refuse_motion
        if options.spectrum is not None:
            yield lambda: actions(context, options)
    if (wall or options.axial_load is not None) and building.material.compressive_strength is None:
        yield lambda: _refuse_weak()


def _read_walls(building: Building) -> None:
    with contextlib.suppress(NoMechanism):  # the answer of the analysis, no fault of the deck
        wall_parts(building)


def _refuse_unheld(what: str, key: Key) -> None:
    raise Refused(
        f'local-mechanism can include {what} only for blocks with mechanism = "building". Remove it, or '
        "give the restraint of a wall as `ties` of the analysis",
        key,
    )


def _refuse_given(name: str) -> None:
    raise Refused(f'mechanism = "building" uses the value of [structure]: remove `{name}`', ("analysis", name))


def _refuse_elsewhere(context: Context, options: LocalMechanism) -> None:
    """Keys of a code that is not that of the report."""
    own = code_of(context).jurisdiction
    for name in ("one_second_acceleration", "storey"):
        if name in options.model_fields_set and own != "ASCE41":
            raise Refused(
                f"{name} is a key of the checks by ASCE 41, but the checks are by {own}. Remove the key, or give [code] "
                f'jurisdiction = "ASCE41"',
                ("analysis", name),
            )


def _refuse_nothing(building: Building) -> None:
    if building.structure is None:
        raise Refused('"building" requires a [structure]', ("analysis", "mechanism"))


def _refuse_wall(building: Building, options: CodeChecks) -> None:
    if options.axial_load is None:
        raise Refused("the wall is checked as a pier: give `axial_load`", ("analysis",))
    if len(building.pier_blocks().mass) > 1:
        raise Refused(
            "the pier rules apply to a rectangle without openings: give each pier between openings as a separate panel", ("structure",)
        )


def _refuse_weak() -> None:
    raise Refused("the pier rules require `compressive_strength` of [material] (f_m)", ("material",))
