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
            "two stacked blocks rock in two coordinates, which `rocking`, `fragility`, `failure-domain`, `failure-curves`, `harmonic-map` "
            "and `dem` follow",
            ("structure", "kind"),
        )
    if building.supports.stiffness is not None:
        raise NoView(
            "on a compliant base a building moves in more than one coordinate, which `rocking`, `fragility`, "
            "`failure-domain`, `failure-curves` and `harmonic-map` (of one block, column or wall) and `dem` follow; remove "
            "it, or give it to these analyses alone ([analysis.supports] below them)",
            ("supports", "stiffness"),
        )
    block = rocks_as_block(building)
    if building.joints.energy_ratio is not None and not block:
        raise NoView(
            "the energy ratio is that of a block: give restitution, the rate after over before an impact", ("joints", "energy_ratio")
        )
    if linear and not block:
        raise NoView('form = "linear" applies to blocks and columns only', ("analysis", "form"))
    if wall is not None and not block and building.supports.rebound is None:
        raise NoView("the rebound from a wall has a rule for blocks only: give [supports] rebound", ("supports", "abutting_wall"))
    if wall is not None and ratio and wall == ("right" if ratio > 0.0 else "left"):
        raise NoView(f"it cannot start rotated to the {wall}, where the wall stands", ("initial", "rotation_ratio"))


def refuse_soft_base(building: Masonry) -> None:
    """NoView, with the key, where the words of a deck alone say that nothing but `dem` follows it on a compliant base."""
    key = ("supports", "stiffness")
    if not rocks_as_block(building):
        raise NoView(
            "rocking follows a compliant base under one block, column or wall; remove it, or give it to the analysis "
            "`dem` alone ([analysis.supports] below it), which follows it under any blocks",
            key,
        )
    if building.restraints or building.supports.abutting_wall is not None:
        raise NoView("on a compliant base nothing but the base supports a block: remove ties, dampers, hinges and the wall", key)
    if building.joints.energy_ratio is not None or "restitution" in building.joints.model_fields_set:
        name = "restitution" if building.joints.energy_ratio is None else "energy_ratio"
        raise NoView(
            "on a compliant base impacts follow from its springs and dashpots: remove restitution and energy_ratio, "
            "give [supports] damping_ratio",
            ("joints", name),
        )


def refuse_stack(building: Masonry, linear: bool = False) -> None:
    """NoView, with the key, where two stacked blocks have what their rocking does not consider."""
    for key in building.special_keys.values():
        raise NoView("two stacked blocks are not held by ties, dampers, hinges or a wall here: leave them out", key)
    if building.supports.stiffness is not None:
        raise NoView(
            "two stacked blocks rock on rigid ground here: remove it, or use `dem`, which follows a compliant base under any blocks",
            ("supports", "stiffness"),
        )
    if linear:
        raise NoView('form = "linear" applies to blocks and columns only', ("analysis", "form"))
    if building.joints.energy_ratio is not None or not isinstance(building.joints.restitution, str):
        name = "restitution" if building.joints.energy_ratio is None else "energy_ratio"
        raise NoView("two stacked blocks take plastic impacts at all edges: remove restitution and energy_ratio", ("joints", name))
