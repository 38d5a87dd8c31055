"""Results of limit analysis: tilt, thrust, moving-load, supports, sweep, survey."""

from collections.abc import Sequence
from math import inf
from typing import Literal

from extrados.results.fields import ResultModel, fact, maybe
from extrados.results.verdict import Bound, Demand, KindResults, Outcome, Verdict, judge, judge_acceleration

Side = Literal["intrados", "extrados"]
#: Ends of any joint, of arches by their sides
OpenSide = Literal["intrados", "extrados", "first end", "second end"]


class JointHinge(ResultModel):
    """A joint that hinges."""

    joint: int = fact("number of the joint")
    side: Side = fact("side on which the blocks touch")


class NamedHinge(JointHinge):
    """A joint that hinges, by its name."""

    name: str = fact("name of the joint")


class Hinge(NamedHinge):
    """A hinge of a mechanism, and its place."""

    place: str = fact("place in words: springing, haunch or crown of an arch, foot of a pier, bed or head joint")
    x_m: float = fact("x of the hinge", "m")
    y_m: float = fact("y of the hinge", "m")

    def told(self) -> str:
        """The place in words, with numbers where a stone's name alone finds nothing."""
        return f"{self.place} (x = {self.x_m:.2f}, y = {self.y_m:.2f} m)" if "joint" in self.place else self.place


class Reaction(ResultModel):
    """Force of the ground on the structure at a joint."""

    joint: int = fact("number of the joint on the ground")
    name: str = fact("its name")
    horizontal_N: float = fact("to +x", "N")
    vertical_N: float = fact("upward", "N")


class TieForce(ResultModel):
    """What a state of the structure asks of a tie, strut or spring of the deck."""

    name: str = fact("its name")
    force_N: float = fact("force in it, tension positive", "N")
    state: Literal["slack", "carries", "yields"] = fact("without force, below its yield force, or at it")


class ChainThrust(ResultModel):
    """Horizontal thrust of an arch of the structure, upright, at its left springing; at its crown where ties hold it."""

    min_N: float = fact("least", "N")
    max_N: float = fact("greatest", "N")


class Fracture(ResultModel):
    """Collapse to +x with the leeward buttress cracked."""

    stands: bool = maybe("false where the cracked structure cannot stand upright; nothing else is given then")
    cracks: bool = maybe("whether the buttress cracks before the structure collapses")
    buttress: str = maybe("name of the cracked buttress")
    collapse_acceleration_g: float = maybe("collapse acceleration with the crack", "g")
    tilt_angle_deg: float = maybe("tilt of the ground that pushes alike", "deg", source="thesis Eq. 3.1")
    ratio: float = maybe("over the collapse acceleration of the whole structure")
    crack_height_m: float = maybe("height above the base at which the crack starts", "m")
    crack_height_ratio: float = maybe("height above the base at which the crack starts, over the height of the buttress")
    resultant_from_outer_face_ratio: float = maybe("distance of the resultant from the outer face over the width there")
    hinges: list[Hinge] = maybe("hinges of the cracked structure")
    dilating: bool = maybe(
        "whether pressed joints slide in that mechanism: its collapse acceleration is then an upper bound (dilatant friction)"
    )


#: What results say of a capacity in whose mechanism pressed joints slide
DILATANT = "upper bound (dilatant friction)"


#: g: bounds that differ less are equal
SAME = 1e-6


class LoadPath(ResultModel):
    """Collapse at the end of a load path: elastic joints, self-weight first, then the push, sliding without dilatancy."""

    shear_stiffness_ratio: float = fact("shear stiffness over normal stiffness of the joints")
    collapse_acceleration_g: float | None = fact("collapse acceleration; null where the path did not end in a collapse", "g")
    certified: bool = fact("whether the certificate holds: equilibrium, |s| <= mu N and zero gap, recomputed apart from the solver")
    zero_gap_g: float | None = fact("as in non_dilatant", "g")
    equilibrium_residual: float | None = fact("as in non_dilatant")
    friction_residual: float | None = fact("as in non_dilatant")
    overlap_residual: float | None = fact("as in non_dilatant")
    reason: str = maybe("reason for a missing value")


def design_value(paths: Sequence[LoadPath] | None) -> float | None:
    """The least of the certified load paths [g]; None without any."""
    found = [p.collapse_acceleration_g for p in paths or () if p.certified and p.collapse_acceleration_g is not None]
    return min(found, default=None)


class NonDilatant(ResultModel):
    """Collapse to one side by sliding that does not dilate: the least state found, its bounds and its certificate.

    The certificate proves that collapse is possible at this load, not that less is safe.
    """

    associated_g: float | None = fact(
        "upper bound: the same with sliding that dilates; null without a collapse mechanism", "g", source="Drucker 1954"
    )
    frictionless_g: float | None = fact("lower bound: the same without friction; null if it cannot stand then", "g", source="Drucker 1954")
    starts_g: list[float] = fact("load reached from each start; the least is the result", "g")
    spread_g: float = fact("greatest less least of them: such states are not unique", "g")
    certified: bool = fact("whether the certificate holds: equilibrium, |s| <= mu N and zero gap, recomputed apart from the solver")
    zero_gap_g: float = fact(
        "|gamma - (work of friction - work of the weight)| per unit of work of the load; zero: forces and motion belong together", "g"
    )
    equilibrium_residual: float = fact("greatest force, or moment over the size, left over at a block, over the total load")
    friction_residual: float = fact("greatest excess of |s| over mu N, over the total load")
    tension_residual: float = fact("greatest tension (or crushing beyond the strength), over the total load")
    overlap_residual: float = fact("greatest overlap of the motion, over the fastest joint")
    complementarity_residual: float = fact("greatest lesser of force and motion where a joint presses and opens, or holds and slides")
    work_residual: float = fact("work of the load less that of weight and friction, over the former")


class Tilt(KindResults):
    """tilt: the constant horizontal acceleration at which a structure becomes a mechanism."""

    collapse_acceleration_g: float = fact("collapse acceleration (horizontal, constant), towards +x", "g")
    collapse_acceleration_opposite_g: float = fact("collapse acceleration (horizontal, constant), towards -x", "g")
    tilt_angle_deg: float = fact("tilt of the ground that pushes alike, to +x", "deg", source="thesis Eq. 3.1")
    tilt_angle_opposite_deg: float = fact("tilt of the ground that pushes alike, to -x", "deg")
    admissible_interval_g: list[float] = fact("accelerations between which a thrust line is admissible", "g")
    load_direction: Literal["+x"] = fact("sense of the push that hinges and friction belong to")
    hinges: list[Hinge] = fact("hinges of the mechanism")
    sliding_joints: list[int] = fact("joints that slide or part in the mechanism")
    hinges_opposite: list[Hinge] = fact("hinges of the mechanism to -x")
    dilating_joints: list[int] = maybe(
        "joints in compression that slide in the collapse mechanism to +x; the collapse acceleration is then an upper "
        "bound, because friction is dilatant in the analysis (associated friction)"
    )
    dilating_joints_opposite: list[int] = maybe("the same in the mechanism to -x")
    collapse_acceleration_non_associated_g: float = maybe(
        "sliding without dilatancy, to +x: the least certified state found, one of an interval whose upper end is the associated value",
        "g",
        source="Ferris and Tin-Loi 2001",
    )
    collapse_acceleration_non_associated_opposite_g: float = maybe("the same to -x", "g")
    collapse_acceleration_load_path_g: float = maybe(
        "design value where joints slide, to +x: least of the load paths of elastic joints with three ratios of stiffness",
        "g",
        source="elastic-frictional joints without dilatancy, incremental return; certificate as in non_dilatant",
    )
    collapse_acceleration_load_path_opposite_g: float = maybe("the same to -x", "g")
    load_paths: list[LoadPath] = maybe("load paths to +x, one a ratio of joint stiffness")
    load_paths_opposite: list[LoadPath] = maybe("load paths to -x")
    non_associated_reason: str = maybe("why no state without dilatancy is given beside an upper bound")
    touching_joints: list[int] = fact("joints whose end the thrust line touches without a hinge")
    required_friction: float | None = fact("greatest coefficient of friction that the thrust line at collapse needs")
    required_friction_joint: int = fact("the joint that needs it")
    geometric_safety_factor: float | None = fact(
        "upright: one over the least part of the joints, about their middles, that holds a thrust line, at most 100; null where the line "
        "runs through all middles within 1 % of the joints (no horizontal demand), or if not requested"
    )
    weight_N: float = fact("weight of the structure with its fill", "N")
    depth_m: float = fact("depth out of plane", "m")
    reactions: list[Reaction] = fact("forces of the ground at collapse")
    ties: list[TieForce] = maybe("forces of the ties at collapse")
    ties_opposite: list[TieForce] = maybe("forces of the ties at collapse to -x")
    thrust_min_N: float = maybe("least horizontal thrust upright, of the first arch; at the crown of an arch restrained by ties", "N")
    thrust_max_N: float = maybe("greatest horizontal thrust upright, of the first arch; at the crown of an arch restrained by ties", "N")
    thrusts: dict[str, ChainThrust] = maybe("least and greatest thrust upright of each arch, by its name")
    clear_span_m: float = maybe("clear span", "m")
    rise_m: float = maybe("rise of the intrados", "m")
    base_width_m: float = maybe("width of the base of a buttress", "m")
    height_above_ground_m: float = maybe("height of the crown above the ground", "m")
    overall_width_m: float = maybe("width over the outer buttresses", "m")
    nave_span_m: float = maybe("clear span of the nave", "m")
    left_aisle_span_m: float = maybe("clear span of the left aisle", "m")
    right_aisle_span_m: float = maybe("clear span of the right aisle", "m")
    duality_gap: float = fact("greatest difference between the bounds from equilibrium and from the mechanism", "g")
    fracture: Fracture = maybe("collapse with the leeward buttress cracked")
    non_dilatant: NonDilatant = maybe("sliding without dilatancy: bounds and certificate of the collapse to +x")
    non_dilatant_opposite: NonDilatant = maybe("sliding without dilatancy: bounds and certificate of the collapse to -x")

    def interval(self, opposite: bool = False) -> tuple[float | None, float]:
        """Least and greatest collapse acceleration [g] to +x, or to -x: equal where no pressed joint slides, the least None
        where joints slide and no state without dilatancy is known; infinite where what dilates cannot be brought down."""
        own, least, found, dilating = (
            (
                self.collapse_acceleration_opposite_g,
                self.collapse_acceleration_non_associated_opposite_g,
                self.non_dilatant_opposite,
                self.dilating_joints_opposite,
            )
            if opposite
            else (self.collapse_acceleration_g, self.collapse_acceleration_non_associated_g, self.non_dilatant, self.dilating_joints)
        )
        if found is not None:
            return least, inf if found.associated_g is None else found.associated_g
        return (None if dilating else own), own

    def _state(self, opposite: bool) -> NonDilatant | None:
        return self.non_dilatant_opposite if opposite else self.non_dilatant

    def capacity(self, opposite: bool = False) -> float:
        """Capacity [g] to +x, or to -x, by which the verdict decides: the design value where joints slide, else the least state,
        else the upper bound."""
        design = self.collapse_acceleration_load_path_opposite_g if opposite else self.collapse_acceleration_load_path_g
        least, most = self.interval(opposite)
        return design if design is not None else most if least is None else least

    def judged(self, demand: Demand) -> Verdict:
        """The lesser capacity of the two senses against the peak ground acceleration of the motion [g]."""
        return self.judged_towards(demand, (False, True))

    def judged_towards(self, demand: Demand, opposite: Sequence[bool]) -> Verdict:
        """The verdict by pushes to +x (False) or to -x (True), or the lesser of both.

        Where pressed joints slide the collapse acceleration lies in an interval: from its upper end on the structure
        collapses. The capacity is the design value, the least of the load paths; from it to the upper end the outcome is
        open, and above the least state found the verdict warns. Without a load path the capacity is the least state found,
        which is no lower bound: within the spread of the states found below it the outcome is open too. Without such a
        state the upper end is a bound, and no outcome but collapse follows from it.
        """
        intervals = [self.interval(one) for one in opposite]
        high = min(most for _, most in intervals)
        designs = [self.collapse_acceleration_load_path_opposite_g if one else self.collapse_acceleration_load_path_g for one in opposite]
        slides = [least is None or self._state(one) is not None for one, (least, _) in zip(opposite, intervals, strict=True)]
        if any(slides) and all(d is not None for d, slide in zip(designs, slides, strict=True) if slide):
            known = [least for least, _ in intervals if least is not None]
            return judge_design(min(self.capacity(one) for one in opposite), min(known, default=None), high, demand)
        if any(least is None for least, _ in intervals):
            least = min(most if least is None else least for least, most in intervals)
            return judge_dilatant(least, demand, self.non_associated_reason)
        least = min(least for least, _ in intervals if least is not None)
        if least >= high - SAME * max(1.0, high):
            return judge_acceleration(least, demand)
        found = [self._state(one) for one in opposite]
        return judge_interval(least, high, max((one.spread_g for one in found if one is not None), default=0.0), demand)


def judge_dilatant(capacity: float, demand: Demand, reason: str | None = None) -> Verdict:
    """An upper bound by dilatant friction [g] against the peak of the motion; reason: why no lower state is known."""
    found = judge_acceleration(capacity, demand, "upper")
    why = f" A state without dilatancy is not given: {reason}." if reason else ""
    return found.model_copy(update={"statement": f"{found.statement} Joints slide: {DILATANT}.{why}"})


def judge_design(design: float, least: float | None, most: float, demand: Demand) -> Verdict:
    """The least of the load paths [g], between the least state found (None: none was sought) and the upper bound, against the
    peak of the motion."""
    peak = demand.peak_g
    upper = f"the {DILATANT} is {most:.3g} g" if most < inf else "with dilatant friction no collapse mechanism exists"
    lower = "no lesser state was sought" if least is None else f"the least state found {least:.3g} g"
    text = f"Joints slide: design value of the collapse acceleration (horizontal, constant) {design:.3g} g, by load paths; {lower}; {upper}"
    if peak is None:
        return judge(f"{text}; the deck holds no single motion to compare with.", None, design, "g")
    outcome: Outcome = "collapses" if peak >= most else "open" if peak >= design else "stands"
    place = {"collapses": "at or above the upper bound", "open": "between design value and upper bound", "stands": "below the design value"}
    text = f"{text}; the peak of the motion, {peak:.3g} g, applied as a constant horizontal acceleration, is {place[outcome]}."
    if outcome == "stands" and least is not None and peak >= least:
        text += " Warning: in another state of stress at rest collapse is possible at this peak. Settlements or loads of the past may have caused it."
    return judge(text, peak, design, "g", outcome)


def judge_interval(least: float, most: float, spread: float, demand: Demand) -> Verdict:
    """A collapse acceleration between the least state found without dilatancy, one of several with a `spread`, and the
    upper bound [g]."""
    peak = demand.peak_g
    upper = f"the {DILATANT} is {most:.3g} g" if most < inf else "with dilatant friction no collapse mechanism exists"
    text = f"Collapse acceleration (horizontal, constant) in an interval: joints slide; least state found {least:.3g} g, {upper}"
    if peak is None:
        return judge(f"{text}; the deck holds no single motion to compare with.", None, least, "g")
    outcome: Outcome
    if peak >= most:
        outcome, place = "collapses", "at or above the upper bound"
    elif peak >= least:
        outcome, place = "open", "between both"
    elif peak >= least - spread:
        outcome, place = ("open", f"below the least state found by less than the spread of the states found, {spread:.3g} g")
    else:
        outcome, place = "stands", "below the least state found"
    text = f"{text}; the peak of the motion, {peak:.3g} g, applied as a constant horizontal acceleration, is {place}."
    return judge(text, peak, least, "g", outcome)


class ThrustLine(ResultModel):
    """One admissible thrust line."""

    horizontal_N: float = maybe("horizontal thrust of the chain at its left springing, or its base", "N")
    horizontal_kN_per_m: float = maybe("horizontal thrust per metre of depth", "kN/m")
    crown_N: float = maybe(
        "horizontal thrust at the crown of an arch with ties at its voussoirs: sum of the left springing and the ties; "
        "the lines of least and greatest thrust are those of the crown then",
        "N",
    )
    over_weight: float = maybe("horizontal thrust over the weight of the structure")
    required_friction: float | None = fact("greatest coefficient of friction it needs")
    required_friction_joint: str = fact("the joint that needs it")
    greatest_eccentricity_ratio: float = fact("greatest distance from the middle of a joint over its length")
    reactions: list[Reaction] = fact("forces of the ground")
    ties: list[TieForce] = maybe("forces of the ties")

    def told_kN_per_m(self, depth_m: float) -> float:
        """The horizontal thrust that answers and figures tell: that at the crown where ties hold the arch below."""
        return self.horizontal_kN_per_m if self.crown_N is None else self.crown_N / depth_m / 1e3


class Thrust(KindResults):
    """thrust: admissible thrust lines at a given horizontal acceleration."""

    gamma_g: float = fact("acceleration to +x at which the lines are drawn", "g")
    chain: str | None = fact("arch or stack to which least and greatest thrust belong; null without one")
    admissible_interval_g: list[float] = fact("accelerations between which a thrust line is admissible", "g")
    geometric_safety_factor: float | None = fact(
        "one over the least part of the joints, about their middles, that holds a thrust line, at most 100; null where the line runs "
        "through all middles within 1 % of the joints (no horizontal demand), or if not requested"
    )
    least_part_of_joints: float = maybe("the part of the joints, about their middles, that the most central line needs")
    weight_N: float = fact("weight of the structure with its fill", "N")
    depth_m: float = fact("depth out of plane", "m")
    dilating: bool = fact(
        "whether pressed joints slide in the mechanisms at the ends of the admissible interval: these are upper bounds "
        "(dilatant friction), and a line within friction does not prove that sliding without dilatancy is excluded"
    )
    duality_gap: float = fact("greatest difference between the bounds from equilibrium and from the mechanism", "g")
    least: ThrustLine = maybe("the line of least thrust")
    most: ThrustLine = maybe("the line of greatest thrust")
    central: ThrustLine = maybe("the most central line; if missing, a warning gives the reason")

    def judged(self, demand: Demand) -> Verdict:
        """The part of the joints that the most central line needs against the whole; the ratio is the safety factor."""
        part = self.least_part_of_joints
        if part is None:
            return judge("The most central thrust line was not found.", None, None)
        if self.geometric_safety_factor is None:
            text = "a thrust line runs through the middles of all joints, within 1 % of their length: no horizontal demand."
            return judge(f"At {self.gamma_g:g} g {text}", 0.0, 1.0)
        return judge(f"At {self.gamma_g:g} g a thrust line stays within the middle {100.0 * part:.3g} % of the joints.", part, 1.0)


#: Beside a verdict on a load whose partial factors are all 1
CHARACTERISTIC = "All partial factors are 1.0: characteristic loads and strengths, no code margin."


class MovingLoad(KindResults):
    """moving-load: collapse load, or adequacy factor of a train, at every place along an arch or a bridge."""

    chain: str | None = fact("arch that the load crosses; null if it crosses the whole top")
    collapse_load_N: float = fact("least collapse load over all positions; for a train, the load on the structure at collapse", "N")
    collapse_load_kN_per_m: float = fact("least load per metre of depth", "kN/m")
    worst_place_m: float = fact("x of the first axle at the governing position", "m")
    worst_place_over_span: float = fact("x of the first axle at the governing position, from the left springing, over the span")
    worst_way: Literal["+x", "-x"] = fact("direction in which the train runs at the governing position")
    hinges: list[NamedHinge] = fact("hinges of the mechanism at the governing position")
    sliding_joints: list[int] = fact("joints that slide or open in the mechanism at the governing position")
    dilating_joints: list[int] = maybe(
        "joints in compression that slide in the collapse mechanism; the collapse load is then an upper bound, because "
        "friction is dilatant in the analysis (associated friction)"
    )
    greatest_compression_N: float = fact("greatest compression across a joint at collapse, with the load at the governing position", "N")
    places_without_limit: int = fact("places at which no load of the kind causes collapse")
    ties: list[TieForce] = maybe("forces of the ties at collapse, with the load at the governing position")
    duality_gap: float = fact(
        "greatest difference, over all places, between the bounds from equilibrium and from the mechanism, in multiples of the self-weight"
    )
    load_N: float = maybe("the load that the deck gives", "N")
    safety_factor: float = maybe("collapse load over the load that the deck gives")
    train: str = maybe("name of the train; load for axles that share a force, train for the axle loads of the deck")
    adequacy_factor: float = maybe("multiple of the factored train, or load, that causes collapse")
    live_load_factor: float = maybe("partial factor times dynamic factor by which the train is multiplied before")
    permissible_factor: float = maybe(
        "permissible limit state: multiple of the train, times its serviceability and dynamic factors, up to which a thrust line "
        "exists with stresses below the permissible one and the passive pressure of service"
    )
    permissible_place_m: float = maybe("x of the first axle at which the permissible factor is least", "m")
    permissible_stress_Pa: float = maybe("permissible compressive stress under service loads", "Pa")
    characteristic: bool = maybe("whether all partial factors are 1.0: loads and strengths are characteristic")
    violated: list[str] = maybe("assumptions of a load on a bridge that the structure does not meet")

    def judged(self, demand: Demand) -> Verdict:
        """The adequacy factor of the train against 1, or the load of the deck against the least collapse load [N]."""
        text = f"Collapse load {self.collapse_load_N / 1e3:.4g} kN at the most dangerous place"
        bound: Bound | None = "upper" if self.dilating_joints else None
        more = f" Joints slide: {DILATANT}." if self.dilating_joints else ""
        judged = f"{more} {CHARACTERISTIC}" if self.characteristic else more
        violated = list(self.violated or ())
        if self.permissible_factor is not None:
            judged += f" Permissible limit state: {self.permissible_factor:.3g} times the train."
            if self.permissible_factor < 1.0:
                violated.append(
                    f"The train exceeds the permissible limit state, {self.permissible_factor:.3g}: repeated traffic may damage the "
                    "arch progressively. Limit the load or the traffic."
                )
        if self.load_N is None and self.adequacy_factor is not None:
            factored = "" if self.characteristic else "factored "
            return judge(
                f"Adequacy factor {self.adequacy_factor:.3g} on the {factored}train at the most dangerous place.{judged}",
                1.0,
                self.adequacy_factor,
                bound=bound,
                violated=violated,
            )
        if self.load_N is None:
            return judge(
                f"{text}; the deck gives no load to compare with.{more}", None, self.collapse_load_N, "N", bound=bound, violated=violated
            )
        return judge(
            f"{text}, {self.safety_factor:.3g} times the load of {self.load_N / 1e3:.4g} kN.{judged}",
            self.load_N,
            self.collapse_load_N,
            "N",
            bound=bound,
            violated=violated,
        )


class Stage(ResultModel):
    """A change of hinges while a support moves."""

    movement_m: float = fact("movement of the support from which on it holds", "m")
    hinges: list[str] = fact("the three hinges")


class JointOpening(ResultModel):
    """A joint that opens or slides under moving supports."""

    joint: int = fact("number of the joint")
    name: str = fact("its name")
    opening_mm: float = fact("how far its wider end opens", "mm")
    side: OpenSide = fact("end that opens more: of arches intrados or extrados")
    slip_mm: float = fact("how far it slides", "mm")


class MovingSupports(KindResults):
    """supports: openings under moving supports; of an arch, until it collapses."""

    movement_at_fall_m: float = maybe("movement of the support at which the arch collapses", "m")
    movement_at_fall_over_span: float = maybe("movement at collapse over the span")
    span_change_at_fall_ratio: float = maybe("growth of the span at collapse, over the span")
    thrust_at_rest_N: float = maybe("horizontal thrust at the start", "N")
    thrust_at_fall_N: float = maybe("horizontal thrust at collapse", "N")
    hinges_at_rest: list[JointHinge] = maybe("the three hinges at the start")
    hinges_at_fall: list[JointHinge] = maybe("the three hinges at collapse")
    joints_touched_at_fall: list[int] = maybe("joints where the thrust line touches a further end at collapse")
    stages: list[Stage] = maybe("from the start on, each change of hinges")
    openings: list[JointOpening] = maybe("joints that open or slide under [[initial.movements]], the widest first")
    work_J: float = maybe("work of the weight in the movements of [[initial.movements]]", "J")
    work_gap_J: float = maybe("difference between that and the work on the supports, which should be none", "J")
    reactions: list[Reaction] = maybe("forces of the ground under moving supports")
    ties: list[TieForce] = maybe("forces of the ties under moving supports")

    def judged(self, demand: Demand) -> Verdict:
        """The movement that the arch can follow [m]; the deck asks for none."""
        move = self.movement_at_fall_m
        if move is None:
            return judge("Under the given movements the structure stands with open joints; no limit is sought.", None, None, "m")
        return judge(
            f"The arch follows its support by {move:.4g} m, {100.0 * self.movement_at_fall_over_span:.3g} % of the span, "
            "before it collapses.",
            None,
            move,
            "m",
        )


class GoverningMechanism(ResultModel):
    """A mechanism that governs somewhere in a sweep."""

    number: int = fact("its number in the figures")
    hinges: str = fact("order of the hinges in words")


class Change(ResultModel):
    """A value at which another mechanism begins to govern."""

    value: float = fact("the value of the key, in its unit")
    before: int | Literal["locked"] = fact(
        "number of the mechanism below the value; 0: cannot stand, locked: no collapse mechanism", name="from"
    )
    after: int | Literal["locked"] = fact("number of the mechanism above the value; 0 or locked as below", name="to")
    collapse_acceleration_g: float | None = fact("collapse acceleration there", "g")


#: Of one section among many: it has a capacity; a certificate proves that it cannot stand (capacity 0); no load of the kind
#: brings it down; or there is no answer
SectionStatus = Literal["ok", "cannot-stand", "locked", "no-answer"]


class Gap(ResultModel):
    """A value of a sweep at which the structure has no mechanism under the load."""

    value: float = fact("the value of the key, in its unit")
    status: SectionStatus = fact("cannot-stand (capacity 0, by a certificate), locked, or no-answer (no result)")
    reason: str = fact("reason, with the certificate of a structure that cannot stand")


class Sweep(KindResults):
    """sweep: capacity and mechanism as one key of the deck varies."""

    vary: str = fact("the key that varies")
    unit: str = fact("its unit")
    mechanisms: list[GoverningMechanism] = fact("the mechanisms that govern somewhere")
    changes: list[Change] = fact("values at which another mechanism begins to govern")
    stable_limits: list[float] = fact("values at which the range ends in which it stands, in the unit of the key")
    locked_limits: list[float] = fact("values beyond which no load of the kind causes collapse")
    optimum_value: float = fact("value of the greatest capacity, in the unit of the key")
    optimum_collapse_acceleration_g: float = fact("the greatest capacity", "g")
    optimum_tilt_angle_deg: float = fact("tilt of the ground that pushes alike", "deg")
    optimum_inside: bool = fact("whether it lies inside the range")
    values: list[float] = fact("the values, in the unit of the key")
    collapse_accelerations_g: list[float | None] = fact(
        "capacity at each value; 0 for a structure that cannot stand, null without a result", "g"
    )
    upper_bound_values: list[float] = fact(
        "values at which pressed joints slide in the mechanism: the capacity is an upper bound (dilatant friction)"
    )
    gaps: list[Gap] = fact("values without a mechanism: cannot stand, locked, or no result")
    duality_gap: float = fact("greatest difference between the bounds", "g")
    fractured_collapse_accelerations_g: list[float | None] = maybe("collapse accelerations with the leeward buttress cracked", "g")
    buttress_alone_accelerations_g: list[float | None] = maybe(
        "collapse accelerations of the leeward buttress by itself", "g", source="thesis Fig. 3-4b"
    )

    def judged(self, demand: Demand) -> Verdict:
        """The greatest capacity [g]; a sweep compares, it asks for no demand."""
        best = self.optimum_collapse_acceleration_g
        unit = f" {self.unit}" if self.unit else ""
        text = f"Of the values tried, {self.vary} = {self.optimum_value:.4g}{unit} has the greatest capacity, {best:.3g} g."
        if not self.upper_bound_values:
            return judge(text, None, best, "g")
        text += f" At {len(self.upper_bound_values)} of {len(self.values)} values joints slide: {DILATANT}."
        return judge(text, None, best, "g", bound="upper")


class NoAnswerRow(ResultModel):
    """A section of a survey that cannot stand, or has no answer."""

    row: int = fact("its line in the file")
    name: str = fact("its name")
    reason: str = fact("why")


class Survey(KindResults):
    """survey: many sections from a table."""

    sections: int = fact("sections in the table")
    standing: int = fact("sections that stand")
    cannot_stand: list[NoAnswerRow] = fact(
        "sections that a certificate proves to collapse under their own weight, the first hundred; their capacity is 0"
    )
    without_answer: list[NoAnswerRow] = fact("sections without a result, the first hundred")
    upper_bounds: int = fact("sections in whose mechanism pressed joints slide: their capacity is an upper bound (dilatant friction)")
    weakest: str | None = fact("name of the weakest section; one that cannot stand has capacity 0")
    weakest_collapse_acceleration_g: float | None = fact("its capacity", "g")
    median_collapse_acceleration_g: float | None = fact("median capacity of those that stand", "g")
    sections_per_second: float = fact("speed of the survey", "1/s")
    duality_gap: float = fact("greatest difference between the bounds", "g")

    def judged(self, demand: Demand) -> Verdict:
        """The capacity of the weakest section that stands [g]; a survey asks for no demand."""
        text = f"{self.standing} of {self.sections} sections stand upright, {len(self.cannot_stand)} cannot stand"
        if self.weakest is None:
            return judge(f"{text}.", None, None, "g")
        least = self.weakest_collapse_acceleration_g
        text += f"; the weakest, {self.weakest}, has a capacity of {least:.3g} g."
        if not self.upper_bounds:
            return judge(text, None, least, "g")
        return judge(f"{text} In {self.upper_bounds} of them joints slide: {DILATANT}.", None, least, "g", bound="upper")


class Imperfections(KindResults):
    """imperfections: capacities of random surveys of the same stones, the lesser of the two senses of each."""

    count: int = fact("number of random surveys")
    deviation_m: float = fact("how far each measured point lies at most from where the given survey has it", "m")
    given_collapse_acceleration_g: float = fact("capacity of the survey that is given", "g")
    median_collapse_acceleration_g: float = fact("median capacity", "g")
    low_collapse_acceleration_g: float = fact("lower end of the band that holds nine tenths: the 5th percentile", "g")
    high_collapse_acceleration_g: float = fact("its upper end: the 95th percentile", "g")
    least_collapse_acceleration_g: float = fact("least capacity; 0 where a survey cannot stand", "g")
    greatest_collapse_acceleration_g: float = fact("greatest capacity", "g")
    cannot_stand: int = fact("surveys that a certificate proves to collapse under their own weight; they count as 0 g")
    without_answer: int = fact("surveys whose programmes gave no result; they are not counted")
    upper_bounds: int = fact("surveys in whose mechanism pressed joints slide: their capacity is an upper bound (dilatant friction)")

    def judged(self, demand: Demand) -> Verdict:
        """The 5th percentile of the capacities, or the given capacity if that is less, against the peak ground acceleration of the
        motion [g]."""
        least = min(self.low_collapse_acceleration_g, self.given_collapse_acceleration_g)
        return (judge_dilatant if self.upper_bounds else judge_acceleration)(least, demand)
