"""Results of strengthen: the interventions that meet a target, what each costs, and what governs then."""

from typing import Literal

from extrados.results.fields import ResultModel, fact, maybe
from extrados.results.verdict import Demand, KindResults, Outcome, Verdict, judge
from extrados.schema.quantities import engineering


class GoverningRange(ResultModel):
    """A mechanism that governs over a range of the size of an intervention."""

    first: float = fact("size from which this mechanism governs, in the unit of the sizes")
    last: float = fact("size up to which this mechanism governs. At this size, the next mechanism begins or the curve ends")
    capacity_first: float = fact("capacity at the lower end of this range of sizes, in the unit of the target")
    capacity_last: float = fact("capacity at the upper end of this range of sizes, in the unit of the target")
    direction: str = fact("direction of the load: +x or -x; in space, the angle in plan")
    mechanism: str = fact("the mechanism in words")


class AnchorageCheck(ResultModel):
    """One check of bar and anchorage under the required force."""

    part: str = fact("part of the anchorage: bar, bearing of the plate, punching of the wall, or pull-out of the anchor")
    capacity_N: float | None = fact("capacity with the given sizes; null if the size is calculated from the force", "N")
    needed: float = fact("least size at which this part carries the required force")
    size: str = fact("name of the size in `needed`, with its unit")


class OtherVerdict(ResultModel):
    """Verdict of one strategy before and after an intervention."""

    strategy: str = fact("the strategy in words")
    before: Outcome = fact("verdict on the existing building")
    after: Outcome = fact("verdict on the strengthened building")
    margin_before: float | None = fact(
        "critical scale factor of the hazard before the intervention (or lower end of its interval); null if not known"
    )
    margin_after: float | None = fact(
        "critical scale factor of the hazard after the intervention (or lower end of its interval); null if not known"
    )


class Intervention(ResultModel):
    """One alternative: its least size, its cost, and what governs then."""

    name: str = fact("name of the intervention")
    kind: Literal["tie", "strut", "spring", "ring-beam", "hoop", "chain", "change"] = fact(
        "kind of intervention: tie, strut, spring (tension and compression), ring beam with its weight, "
        "hoop or chain in space, or change of a key"
    )
    key: str = maybe("key of the deck that the intervention changes")
    place: str = fact("place of the intervention; for a changed key, its value in the deck")
    start_m: list[float] = maybe("first end of a tie: [x, y], in space [x, y, z]; for a hoop, a point at the height of the hoop", "m")
    via_m: list[list[float]] = maybe("points through which a chain runs", "m")
    stiffness_N_m: float = maybe(
        "axial stiffness EA/L of the tie in the runs, from the deck; default: that of a steel bar with the least section", "N/m"
    )
    end_m: list[float] = maybe("second end of the tie; not given for a hoop", "m")
    unit: str = fact("unit of the sizes")
    meets_target: bool = fact("whether any of the calculated sizes meets the target")
    required_size: float | None = fact("least size that meets the target, in `unit`; null if none does")
    required_N: float | None = maybe("least yield force of the tie that meets the target; null if none does", "N")
    depth_m: float = maybe("depth (out of plane) of the masonry for which one tie acts", "m")
    greatest_capacity: float | None = fact(
        "best value of the target quantity over all sizes, in the unit of the target: the least for a probability, otherwise the greatest. "
        "Null if no collapse mechanism remains, or without a result"
    )
    capacity_after: float | None = fact("value of the target quantity with the required size, in the unit of the target")
    safety_factor_after: float | None = fact("safety factor with the required size: value divided by demand")
    next_mechanism: str = fact("governing mechanism with the required size; if no size meets the target, with the greatest size")
    bound: Literal["exact", "upper"] | None = fact(
        "type of the capacity after strengthening. exact; upper bound: joints in compression slide "
        "(dilatant friction); null: estimate by runs"
    )
    ranges: list[GoverningRange] = fact("governing mechanisms in order of increasing size")
    length_m: float = fact("length of tie", "m")
    force_N: float = fact("force of tie", "N")
    volume_m3: float = fact("volume of masonry that is added or injected", "m^3")
    cost: float | None = fact(
        "relative cost by the weights in the deck; null if the target is not met, or if no weight applies to this change"
    )
    anchorage: list[AnchorageCheck] = maybe("checks of bar and anchorage under the required force")
    adverse: list[str] = fact("adverse effects")
    verdicts: list[OtherVerdict] = maybe("verdicts of all strategies before and after the intervention")
    reason: str = fact("reason why the intervention does not suffice or has no result; empty otherwise")


class CombinedTie(ResultModel):
    """Share of one tie in the combination of least total force."""

    name: str = fact("name of the tie")
    place: str = fact("place of the tie")
    force_N: float = fact("yield force of the tie", "N")


class FragilityPair(ResultModel):
    """Probabilities of collapse before and after an intervention under the same motions."""

    name: str = fact("the intervention")
    levels: list[float] = fact("factors on the motions")
    motions: int = fact("number of motions")
    before: list[float | None] = fact("share of the motions that cause collapse of the existing building")
    before_low: list[float] = fact("lower end of the 95 % confidence interval (Wilson score) of `before`", source="Wilson 1927")
    before_high: list[float] = fact("upper end of the 95 % confidence interval (Wilson score) of `before`", source="Wilson 1927")
    after: list[float | None] = fact("share of the motions that cause collapse of the strengthened building")
    after_low: list[float] = fact("lower end of the 95 % confidence interval (Wilson score) of `after`", source="Wilson 1927")
    after_high: list[float] = fact("upper end of the 95 % confidence interval (Wilson score) of `after`", source="Wilson 1927")


class Strengthen(KindResults):
    """strengthen: alternatives that meet a target, side by side."""

    by: str = fact("analysis that measures the target")
    quantity: str = fact("name of the target quantity, in words")
    unit: str = fact("unit of the target and of all values of its quantity; empty for a factor or a probability")
    target: float = fact("the target, in `unit`")
    demand: float | None = fact("demand by which values are divided to give safety factors, in `unit`; null without a demand")
    direction: Literal["both", "+x", "-x"] | None = fact(
        "direction of the load in limit analysis; null in space, where each entry of `ranges` gives its direction"
    )
    value_before: float | None = fact("value of the target quantity for the existing building; null without a result")
    safety_factor_before: float | None = fact("safety factor of the existing building: value divided by demand")
    met_before: bool = fact("whether the existing building already meets the target")
    mechanism_before: str = fact("governing collapse mechanism of the existing building")
    interventions: list[Intervention] = fact("alternative interventions; the cheapest that meets the target comes first")
    combination: list[CombinedTie] = maybe("combination of ties with the least total force, if more than one tie carries a force")
    combination_cost: float = maybe("relative cost of the combination")
    combination_meets_target: bool = maybe(
        "whether the combination meets the target. If joints in compression slide, the target must be met without dilatancy too"
    )
    fragility: FragilityPair = maybe("probability of collapse before and after the cheapest intervention")

    def judged(self, demand: Demand) -> Verdict:
        """The existing building against the target; a target is no demand, so that no outcome follows."""
        return judge(self.statement(), self.target, self.value_before, self.unit, "not-applicable")

    @property
    def best(self) -> Intervention | None:
        """The cheapest alternative that meets the target."""
        return next((one for one in self.interventions if one.meets_target), None)

    def statement(self) -> str:
        """The conclusion in two sentences."""
        unit = f" {self.unit}" if self.unit else ""
        now = "no value" if self.value_before is None else f"{self.value_before:.3g}{unit}"
        text = f"{self.quantity} of the existing building: {now}; the target is {self.target:.3g}{unit}."
        if self.met_before:
            return f"{text} The existing building meets the target without an intervention."
        best = self.best
        if best is None:
            return f"{text} None of the calculated interventions meets the target."
        word = "Intervention" if best.cost is None else "Intervention of least relative cost"
        return f"{text} {word} that meets the target: {best.name}, {size_told(best)}."


def works_in(one: Intervention) -> str:
    """The senses in which a tie works, as `works_in` of [[ties]]."""
    return {"strut": "compression", "spring": "both", "ring-beam": "both"}.get(one.kind, "tension")


def size_told(one: Intervention) -> str:
    """The required size of an intervention in words."""
    size = one.required_size
    if size is None:
        return "no size suffices"
    if one.required_N is not None:
        depth = getattr(one, "depth_m", None)
        per = "" if depth is None else f" for the depth of {depth:.3g} m ({size / 1e3 / depth:.3g} kN/m)"
        return f"{size / 1e3:.3g} kN{per} {one.place}"
    return f"{one.key.rpartition('.')[2].replace('_', ' ')} {engineering(size, one.unit)}"
