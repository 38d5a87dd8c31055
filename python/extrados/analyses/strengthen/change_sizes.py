"""The least change of a key of the deck that meets the target, and the masonry or the force that it adds."""

from typing import Any

import numpy as np

from extrados.analyses.strengthen.alternatives import ChangeAlternative
from extrados.analyses.strengthen.measures import Runs, Statics, Worth, safest, with_value
from extrados.analyses.strengthen.rows import Found, Means, row_of, volume_of, with_lapses
from extrados.analyses.strengthen.sizing import Sized, Sizing
from extrados.core.calls import stop_if_asked
from extrados.decks.reader import DeckError, make_deck
from extrados.model.errors import BadGeometry
from extrados.results import strengthen as out


def size_change(work: Sizing, one: ChangeAlternative) -> Sized:
    """The least change of a key that meets the target."""
    seen: dict[float, Worth] = {}

    def at(value: float) -> Worth:
        stop_if_asked()
        if value not in seen:
            data, keys = with_value(work.context, work.options, one.key, round(value) if one.whole else value)
            seen[value] = work.measure.of_data(data, keys) if isinstance(work.measure, Runs) else work.measure.of_data(data)
        return seen[value]

    required, worth, curve = work.bracket(at, one.start, one.stop, one.count, one.whole)
    ranges: list[out.GoverningRange] = []
    if isinstance(work.measure, Statics):
        for size, value in zip(*curve, strict=True):
            told = seen[size].mechanism
            way = work.measure.word(seen[size].sense)
            if ranges and ranges[-1].mechanism == told:
                ranges[-1] = ranges[-1].model_copy(update={"last": size, "capacity_last": value})
            elif np.isfinite(value):
                ranges.append(
                    out.GoverningRange(first=size, last=size, capacity_first=value, capacity_last=value, direction=way, mechanism=told)
                )
    greatest = safest(work.measure, curve[1])
    if required is None and greatest is not None and isinstance(work.measure, Statics):
        best = curve[0][curve[1].index(greatest)]
        data, _ = with_value(work.context, work.options, one.key, round(best) if one.whole else best)
        closely = work.measure.of_data(data, picture=True)  # without dilatancy where pressed joints slide
        worth, greatest = (worth, greatest) if closely.value is None else (closely, closely.value)
    changed_to: tuple[dict[str, Any], dict[str, Any] | None] | None = None
    if required is not None:
        changed_to = with_value(work.context, work.options, one.key, round(required) if one.whole else required)
        if isinstance(work.measure, Statics):
            worth = work.measure.of_data(changed_to[0], picture=True)
    spent = None if required is None else _spent_on(work, one, required)
    force, volume = spent or (0.0, 0.0)
    reason = "" if required is not None else worth.reason or "no value up to the greatest one considered is sufficient"
    place = f"from {one.start:.4g} {one.unit}".rstrip()
    means = Means(one.name, "change", place, one.unit, force=force, volume=volume, priced=spent is not None, key=one.key)
    row = row_of(work, means, Found(required, greatest, worth, ranges, reason))
    row = with_lapses(work, row, curve, one.stop > one.start)
    sized = Sized(row, curve, None, None, worth)
    if changed_to is not None:
        data, keys = changed_to
        sized.data = data if keys is None else None  # an option of the code changes no building
    sized.costs = [np.nan if (s := _spent_on(work, one, size)) is None else work.cost(0.0, *s) for size in curve[0]]
    return sized


def _spent_on(work: Sizing, one: ChangeAlternative, value: float) -> tuple[float, float] | None:
    """Force [N], and masonry added by a change of the structure or injected where a property of material or joints changes
    [m^3]; None where the weights say nothing of the key."""
    table = one.key.partition(".")[0]
    building = work.context.building
    if one.unit == "N":
        return abs(value - one.start), 0.0
    if (
        table not in ("structure", "material", "joints")
        or building.structure is None
        or ("blocks" in building.kind.lacks and "solids" in building.kind.lacks)
    ):
        return None
    before = volume_of(building)
    if table != "structure":
        return 0.0, before if value != one.start else 0.0
    data, _ = with_value(work.context, work.options, one.key, round(value) if one.whole else value)
    try:
        deck = make_deck({**data, "analysis": [{"kind": "tilt"}]}, work.context.deck.folder)
        return 0.0, volume_of(deck.building) - before
    except (DeckError, BadGeometry):
        return None  # no such building: its value says so
