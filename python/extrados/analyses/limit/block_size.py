"""How the capacity of solids moves with the size and the bond of their blocks: certified bounds of one partition do not show it."""

from extrados.analyses.changes import read_table
from extrados.analyses.context import Context, Refused
from extrados.analyses.limit.asked import partitions_of
from extrados.analyses.limit.solid_loads import solid_limit
from extrados.analyses.limit.tables import Tilt
from extrados.limit.errors import Immovable, NoAnswer
from extrados.limit.solids import Falls
from extrados.model.errors import BadGeometry
from extrados.results import solids as out

MOST_BLOCKS = 1500  # of a partition: some ten seconds a push
LARGE = 0.05  # of the capacity: a larger change is a warning


def by_block_size(context: Context, options: Tilt, direction: float, gamma: float) -> list[out.BlockSize]:
    """The upper bound along a direction [deg] with each of the changes, beside that of the blocks of the deck, gamma [g]."""
    building, rows = context.building, []
    changes = partitions_of(building)
    for done, change in enumerate(changes):
        context.progress(done, len(changes), "sizes of blocks")
        told = ", ".join(f"{name} = {value}" for name, value in change.items())
        blocks, found, reason = None, None, None
        try:
            data = building.structure.model_dump(exclude_unset=True)  # type: ignore[union-attr]
            other = building.apart().having(structure=read_table(type(building.require_structure()), {**data, **change}))
            blocks = len(other.solids().mass)
            if blocks > MOST_BLOCKS:
                reason = f"more than {MOST_BLOCKS} blocks"
            else:
                pushed = solid_limit(other, options).push(direction)
                found, reason = (None, "cannot stand") if isinstance(pushed, Falls) else (pushed.gamma, None)
        except (BadGeometry, Refused, Immovable, NoAnswer) as error:
            reason = str(error)
        rows.append(
            out.BlockSize(
                change=told,
                blocks=blocks,
                collapse_acceleration_g=found,
                reason=reason,
                relative_change=None if found is None else found / gamma - 1.0,
            )
        )
    return rows


def warning_of(rows: list[out.BlockSize]) -> str | None:
    """Told where a partition changes the capacity much."""
    most = max(rows, key=lambda row: abs(row.relative_change or 0.0), default=None)
    if most is None or abs(most.relative_change or 0.0) <= LARGE:
        return None
    return (
        f"The capacity depends on the size of the blocks: with {most.change} the capacity changes by {100.0 * (most.relative_change or 0.0):+.2g} "
        "%. Use the size and bond of the real blocks, or use the lowest value"
    )


def in_words(rows: list[out.BlockSize] | None) -> str:
    """The values in a sentence, with a blank before; "" without any."""
    if not rows:
        return ""
    told = [
        (f"{row.change} ({row.blocks} blocks): {row.collapse_acceleration_g:.4f} g ({100.0 * row.relative_change:+.2g} %)")
        if row.collapse_acceleration_g is not None and row.relative_change is not None
        else f"{row.change}: no value ({row.reason})"
        for row in rows
    ]
    return f" Upper bounds with other blocks: {'; '.join(told)}."
