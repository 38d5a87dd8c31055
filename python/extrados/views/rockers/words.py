"""What the words of a deck alone say of how its building rocks, before any mechanics."""

from extrados.model.errors import NoView
from extrados.views.blocks import Masonry


def rocks_as_block(building: Masonry) -> bool:
    """Whether all of it rocks as one block: what is one, and a wall that is one pier."""
    structure = building.structure
    assert structure is not None
    return structure.rocks_as == "block" or (structure.rocks_as == "piers" and len(building.pier_blocks().mass) == 1)


def refuse_words(building: Masonry, linear: bool = False) -> None:
    """NoView, with the key, where the words of a deck alone say that the building does not rock as one mechanism."""
    wall, ratio = building.supports.abutting_wall, building.initial.rotation_ratio
    assert building.structure is not None
    if building.structure.rocks_as == "stack":
        raise NoView(
            "two stacked blocks rock in two coordinates. Only `rocking`, `fragility`, `failure-domain`, `failure-curves`, "
            "`harmonic-map` and `dem` can follow them",
            ("structure", "kind"),
        )
    if building.supports.stiffness is not None:
        raise NoView(
            "on a compliant base a building moves in more than one coordinate. `dem` can follow this; for one block, column or wall, so "
            "can `rocking`, `fragility`, `failure-domain`, `failure-curves` and `harmonic-map`. Remove `stiffness` from [supports], or "
            "give it in [analysis.supports] of these analyses only",
            ("supports", "stiffness"),
        )
    block = rocks_as_block(building)
    if building.joints.energy_ratio is not None and not block:
        raise NoView(
            "`energy_ratio` is only for a block: give `restitution`, the ratio of angular velocity after / before an impact",
            ("joints", "energy_ratio"),
        )
    if linear and not block:
        raise NoView('form = "linear" applies to blocks and columns only', ("analysis", "form"))
    if wall is not None and not block and building.supports.rebound is None:
        raise NoView("the rule for the rebound from a wall is only for blocks: give `rebound` of [supports]", ("supports", "abutting_wall"))
    if wall is not None and ratio and wall == ("right" if ratio > 0.0 else "left"):
        raise NoView(
            f"the structure cannot start with a rotation to the {wall}, because the wall is on that side", ("initial", "rotation_ratio")
        )


def refuse_soft_base(building: Masonry) -> None:
    """NoView, with the key, where the words of a deck alone say that nothing but `dem` follows it on a compliant base."""
    key = ("supports", "stiffness")
    if not rocks_as_block(building):
        raise NoView(
            "rocking can follow a compliant base only under one block, column or wall. Remove `stiffness`, or give it only to the "
            "analysis `dem` (as [analysis.supports]), which follows a compliant base under any blocks",
            key,
        )
    if building.restraints or building.supports.abutting_wall is not None:
        raise NoView("on a compliant base a block can have no other supports: remove ties, dampers, hinges and the wall", key)
    if building.joints.energy_ratio is not None or "restitution" in building.joints.model_fields_set:
        name = "restitution" if building.joints.energy_ratio is None else "energy_ratio"
        raise NoView(
            "on a compliant base, springs and dashpots determine the impacts: remove `restitution` and "
            "`energy_ratio`, and give `damping_ratio` of [supports]",
            ("joints", name),
        )


def refuse_stack(building: Masonry, linear: bool = False) -> None:
    """NoView, with the key, where two stacked blocks have what their rocking does not consider."""
    for key in building.special_keys.values():
        raise NoView("rocking of two stacked blocks allows no ties, dampers, hinges or wall: remove them", key)
    if building.supports.stiffness is not None:
        raise NoView(
            "here, two stacked blocks can rock only on rigid ground: remove `stiffness`, or use `dem`, which follows a "
            "compliant base under any blocks",
            ("supports", "stiffness"),
        )
    if linear:
        raise NoView('form = "linear" applies to blocks and columns only', ("analysis", "form"))
    if building.joints.energy_ratio is not None or not isinstance(building.joints.restitution, str):
        name = "restitution" if building.joints.energy_ratio is None else "energy_ratio"
        raise NoView("two stacked blocks have plastic impacts at all edges: remove `restitution` and `energy_ratio`", ("joints", name))
