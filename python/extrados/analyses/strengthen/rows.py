"""The row of an intervention: its size, place and cost, the mechanism that governs afterwards, and its adverse effects."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from extrados.analyses.strengthen.alternatives import TieAlternative, is_spatial
from extrados.analyses.strengthen.anchorage import check_anchorage
from extrados.analyses.strengthen.measures import Statics, Worth, over_demand, reached, unmet_reason
from extrados.analyses.strengthen.sizing import Sizing
from extrados.analyses.strengthen.space import SpaceStatics
from extrados.analyses.strengthen.tables import Anchorage
from extrados.model.geometry.polygons import signed_area
from extrados.model.geometry.solids.polyhedra import moments
from extrados.model.ties import Tie
from extrados.results import strengthen as out
from extrados.schema.constants import GRAVITY
from extrados.schema.quantities import engineering
from extrados.views.building import Building

#: Changes of a capacity, or of a mass, that are named
NAMED = 0.01


@dataclass(frozen=True)
class Means:
    """An intervention of a size: length of tie [m], force [N] and added masonry [m^3] cost, which is not known if not `priced`.

    tie: with its elastic stiffness [N/m] and the strengths of its anchorage; key: of the deck that is changed instead.
    """

    name: str
    kind: Any
    place: str
    unit: str
    length: float = 0.0
    force: float = 0.0
    volume: float = 0.0
    priced: bool = True
    tie: Tie | None = None
    stiffness: float = 0.0
    anchorage: Anchorage | None = None
    key: str = ""


@dataclass(frozen=True)
class Found:
    """The size that meets the target (None: no size does, for the `reason`), the greatest value of all sizes, the value at that size,
    and the mechanisms that govern over the sizes."""

    required: float | None
    greatest: float | None
    worth: Worth | None
    ranges: list[out.GoverningRange]
    reason: str


def row_of(work: Sizing, means: Means, found: Found) -> out.Intervention:
    """The row of an intervention with its size, whether the target is met, and its adverse effects."""
    worth, required, reason, tie = found.worth or Worth(None), found.required, found.reason, means.tie
    met = required is not None
    # The target is met only where the least state without dilatancy reaches it too; the size is that of the upper bound.
    unmet = unmet_reason(work.measure, worth) if met else ""
    sure = met and not unmet
    reason = unmet or reason
    more: dict[str, Any] = {"key": means.key} if means.key else {}
    if tie is not None and required is not None:
        more["stiffness_N_m"] = means.stiffness
    if tie is not None:
        more |= {"start_m": list(tie.start), "required_N": required}
        more |= {} if tie.hoop else {"end_m": list(tie.far)}
        more |= {"via_m": [list(point) for point in tie.via]} if tie.via else {}
        if work.context.building.structure is not None and not isinstance(work.measure, SpaceStatics):
            more["depth_m"] = work.context.building.blocks().depth
    adverse = _adverse_of(work, worth, means.volume if means.key.startswith("structure.") else 0.0, met)
    if met and means.anchorage is not None:
        more["anchorage"] = check_anchorage(means.force, means.anchorage)
        adverse += [
            (
                f"The {c.part} carries {c.capacity_N / 1e3:.3g} kN, less than {means.force / 1e3:.3g} kN: "
                f"{c.size.partition(' [')[0]} must be {1e3 * c.needed:.0f} mm."
            )
            for c in more["anchorage"]
            if c.capacity_N is not None and c.capacity_N < means.force
        ]
    after = worth.value if met else None
    return out.Intervention(
        name=means.name,
        kind=means.kind,
        place=means.place,
        unit=means.unit,
        meets_target=sure,
        required_size=required,
        greatest_capacity=found.greatest,
        capacity_after=after,
        safety_factor_after=over_demand(after, work.measure.demand),
        next_mechanism=worth.mechanism,
        bound=worth.bound if met else None,
        ranges=found.ranges,
        length_m=means.length,
        force_N=means.force,
        volume_m3=means.volume,
        cost=work.cost(means.length, means.force, means.volume) if met and means.priced else None,
        adverse=adverse,
        reason=reason,
        **more,
    )


def _adverse_of(work: Sizing, worth: Worth, volume: float, met: bool) -> list[str]:
    """What the intervention makes worse."""
    found = []
    before, building = work.before, work.context.building
    if met and worth.shape and before.shape and worth.shape != before.shape:
        found.append("The governing mechanism changes: the intervention moves the collapse to another part.")
    if met and worth.beside is not None and worth.beside < work.measure.target:
        found.append(
            "Joints in compression slide. Without dilatancy, the lowest collapse acceleration found for the strengthened building is "
            f"{worth.beside:.3g} g, less than the target. Increase the force, or the friction."
        )
    statics = work.measure if isinstance(work.measure, Statics) else None
    for sense, was, now in zip(statics.senses if statics else (), before.by_sense, worth.by_sense, strict=False):
        if statics is not None and now < was * (1.0 - NAMED):
            found.append(f"The capacity towards {statics.word(sense)} decreases from {was:.3g} to {now:.3g} g.")
    if volume > 0.0:
        whole = volume_of(building)
        if volume > NAMED * whole:
            density = building.material.density
            found.append(
                f"The weight increases by {engineering(volume * density * GRAVITY, 'N')} ({100.0 * volume / whole:.0f} %): check the foundation."
            )
        if building.supports.stiffness is not None and not is_spatial(building):
            stones = building.blocks()
            base = float(stones.length[(stones.a < 0) | (stones.b < 0)].sum()) * stones.depth
            sinks = volume * building.material.density * GRAVITY / (building.supports.stiffness * base)
            found.append(
                f"The base is compliant: the added weight causes a settlement of about {1e3 * sinks:.2g} mm, if it is spread over "
                "the present base."
            )
    return found


def with_lapses(work: Sizing, row: out.Intervention, curve: tuple[list[float], list[float]], grows: bool) -> out.Intervention:
    """The row, with the greater changes that do not meet the target: safety need not grow with a size."""
    if row.required_size is None:
        return row
    sizes, values = curve
    beyond = [
        size
        for size, value in zip(sizes, values, strict=True)
        if (size > row.required_size) is grows and size != row.required_size and not reached(work.measure, Worth(value))
    ]
    if not beyond:
        return row
    text = f"Of the calculated sizes above the required one, {len(beyond)} do not meet the target, for instance {beyond[0]:.4g} {row.unit}"
    return row.model_copy(update={"adverse": [*row.adverse, f"{text.rstrip()}. A larger intervention is therefore not always safer."]})


def with_debonding(row: out.Intervention, one: TieAlternative) -> out.Intervention:
    """The row of a bonded strip, with its share of the debonding force and the source of that."""
    if not one.debonds_by:
        return row
    share = "" if row.required_N is None else f"The required force is {100.0 * row.required_N / one.most:.0f} % of this debonding force. "
    told = (
        f"Debonding force of the strip: {engineering(one.most, 'N')} ({one.debonds_by}). {share}Debonding is brittle: a "
        "strip that has debonded carries no force. Limit analysis, however, assumes a tie that yields."
    )
    return row.model_copy(update={"adverse": [*row.adverse, told]})


def volume_of(building: Building) -> float:
    """Volume of the blocks [m^3]."""
    if is_spatial(building):
        return float(sum(moments(part.vertices, part.triangles)[0] for part in building.solids().parts))
    stones = building.blocks()
    return float(sum(abs(signed_area(outline)) for outline in stones.outlines)) * stones.depth


def masses_of(building: Building) -> np.ndarray:
    """Masses of the blocks [kg]."""
    return building.solids().mass if is_spatial(building) else building.blocks().mass


def middle_of(tie: Tie) -> tuple[float, float]:
    """x of the middle of a tie and its height [m]."""
    far = tie.start if tie.hoop else tie.far
    return 0.5 * (tie.start[0] + far[0]), 0.5 * (tie.start[-1] + far[-1])


def placed(tie: Tie) -> str:
    """Where a tie is, in words."""
    if tie.hoop:
        return f"at z = {tie.start[2]:.2f} m"
    start, end = (", ".join(f"{axis} = {x:.2f}" for axis, x in zip("xyz", point, strict=False)) for point in (tie.start, tie.far))
    far = "the ground at " if tie.ground is not None else ""
    return f"from {start} m to {far}{end} m"
