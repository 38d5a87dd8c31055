"""What the words of a deck alone say of how its building rocks, before any mechanics."""

from typing import TYPE_CHECKING

from extrados.building.errors import NoView

if TYPE_CHECKING:
    from extrados.building.building import Building


def rocks_as_block(building: "Building") -> bool:
    """Whether all of it rocks as one block: what is one, and a wall that is one pier."""
    structure = building.structure
    assert structure is not None
    return structure.rocks_as == "block" or (structure.rocks_as == "piers" and len(building.pier_blocks().mass) == 1)


def refuse_words(building: "Building", linear: bool = False) -> None:
    """NoView, with the key, where the words of a deck alone say that the building does not rock as one mechanism."""
    wall, ratio = building.supports.abutting_wall, building.initial.rotation_ratio
    assert building.structure is not None
    if building.structure.rocks_as == "stack":
        raise NoView(
            "two stacked blocks rock in two coordinates, which only `rocking` and `dem` follow", ("structure", "kind")
        )
    block = rocks_as_block(building)
    if linear and not block:
        raise NoView('form = "linear" is known of blocks and columns only', ("analysis", "form"))
    if wall is not None and not block and building.supports.rebound is None:
        raise NoView(
            "what throws it back from a wall is known of blocks only: give [supports] rebound",
            ("supports", "abutting_wall"),
        )
    if wall is not None and ratio and wall == ("right" if ratio > 0.0 else "left"):
        raise NoView(f"it cannot start turned to the {wall}, where the wall stands", ("initial", "rotation_ratio"))
