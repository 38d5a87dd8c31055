"""Results of limit analysis: tilt, thrust, moving-load, supports."""

from collections.abc import Sequence
from math import inf
from typing import Literal

from extrados.results.fields import ResultModel, fact, maybe
from extrados.results.verdict import Bound, Demand, KindResults, Outcome, Verdict, judge, judge_acceleration
from extrados.schema.quantities import three_figures

Side = Literal["intrados", "extrados"]
#: Ends of any joint, of arches by their sides
OpenSide = Literal["intrados", "extrados", "first end", "second end"]


class JointHinge(ResultModel):
    """A joint that hinges."""

    joint: int = fact("number of the joint")
    side: Side = fact("side at which the blocks touch (position of the hinge)")


class NamedHinge(JointHinge):
    """A joint that hinges, by its name."""

    name: str = fact("name of the joint")


class Hinge(NamedHinge):
    """A hinge of a mechanism, and its place."""

    place: str = fact("location in words: springing, haunch or crown of an arch, foot of a pier, bed joint or head joint")
    x_m: float = fact("x of the hinge", "m")
    y_m: float = fact("y of the hinge", "m")

    def told(self) -> str:
        """The place in words, with numbers where a stone's name alone finds nothing."""
        return f"{self.place} (x = {self.x_m:.2f}, y = {self.y_m:.2f} m)" if "joint" in self.place else self.place


class Reaction(ResultModel):
    """Force of the ground on the structure at a joint."""

    joint: int = fact("number of the joint that transfers this force to the ground")
    name: str = fact("name of the joint on the ground")
    horizontal_N: float = fact("horizontal force of the ground on the structure, positive towards +x", "N")
    vertical_N: float = fact("vertical force of the ground on the structure, positive upwards", "N")


class TieForce(ResultModel):
    """What a state of the structure asks of a tie, strut or spring of the deck."""

    name: str = fact("name of the tie")
    force_N: float = fact("force of the tie; tension is positive", "N")
    state: Literal["slack", "carries", "yields"] = fact(
        "state of the tie. slack: no force; carries: below the yield force; yields: at the yield force"
    )


class ChainThrust(ResultModel):
    """Horizontal thrust of an arch of the structure, upright, at its left springing; at its crown where ties hold it."""

    min_N: float = fact("minimum horizontal thrust", "N")
    max_N: float = fact("maximum horizontal thrust", "N")


class Fracture(ResultModel):
    """Collapse to +x with the leeward buttress cracked."""

    stands: bool = maybe(
        "whether the cracked structure can stand without a tilt; if false, the other results of the cracked state are not given"
    )
    cracks: bool = maybe("whether the buttress cracks before the structure collapses")
    buttress: str = maybe("name of the cracked buttress")
    collapse_acceleration_g: float = maybe("collapse acceleration with the crack", "g")
    tilt_angle_deg: float = maybe("tilt of the ground with the same effect as the collapse acceleration", "deg", source="thesis Eq. 3.1")
    ratio: float = maybe("collapse acceleration of the cracked structure, divided by that of the uncracked structure")
    crack_height_m: float = maybe("height above the base at which the crack begins", "m")
    crack_height_ratio: float = maybe("height at which the crack begins, divided by the height of the buttress")
    resultant_from_outer_face_ratio: float = maybe(
        "distance of the resultant from the outer face at the base, divided by the width of the base"
    )
    hinges: list[Hinge] = maybe("hinges of the cracked structure")
    dilating: bool = maybe(
        "whether joints in compression slide in this mechanism; the collapse acceleration is then an upper bound (dilatant friction)"
    )


#: What results say of a capacity in whose mechanism pressed joints slide
DILATANT = "upper bound (dilatant friction)"
#: And where mortar is not lost
DUCTILE = "upper bound (ductile mortar)"


#: g: bounds that differ less are equal
SAME = 1e-6


class LoadPath(ResultModel):
    """Collapse at the end of a load path: elastic joints, self-weight first, then the push, sliding without dilatancy."""

    shear_stiffness_ratio: float = fact("shear stiffness of the joints, divided by their normal stiffness")
    collapse_acceleration_g: float | None = fact("collapse acceleration; null if the load path did not end in a collapse", "g")
    certified: bool = fact(
        "whether the certificate is satisfied, recalculated independently of the solver: equilibrium, "
        "shear force |s| at most friction mu N, and zero gap"
    )
    zero_gap_g: float | None = fact("gap of the certificate, as in `non_dilatant`; null without a certificate", "g")
    equilibrium_residual: float | None = fact("greatest unbalanced force, as in `non_dilatant`; null without a certificate")
    friction_residual: float | None = fact(
        "greatest excess of shear over friction, or greatest tension, divided by the total load; null without a certificate"
    )
    overlap_residual: float | None = fact("greatest rate of overlap, as in `non_dilatant`; null without a certificate")
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
        "upper bound: collapse acceleration with dilatant sliding; null if no collapse mechanism exists", "g", source="Drucker 1954"
    )
    frictionless_g: float | None = fact(
        "lower bound: collapse acceleration without friction; null if the structure cannot stand without friction",
        "g",
        source="Drucker 1954",
    )
    starts_g: list[float] = fact("collapse acceleration found from each starting point of the search; the lowest is the result", "g")
    spread_g: float = fact(
        "difference between the highest and the lowest value of `starts_g`; collapse states without dilatancy are not unique", "g"
    )
    certified: bool = fact(
        "whether the certificate is satisfied, recalculated independently of the solver: equilibrium, "
        "shear force |s| at most friction mu N, and zero gap"
    )
    zero_gap_g: float = fact(
        "gap: collapse acceleration minus (work of friction minus work of the weight), per unit of work "
        "of the load; zero if the forces and the mechanism belong to one collapse state",
        "g",
    )
    equilibrium_residual: float = fact("greatest unbalanced force on a block (or moment divided by the size), divided by the total load")
    friction_residual: float = fact("greatest excess of the shear force |s| over the friction mu N, divided by the total load")
    tension_residual: float = fact("greatest tension (or compression beyond the strength), divided by the total load")
    overlap_residual: float = fact("greatest rate of overlap in the mechanism, divided by the rate of the fastest joint")
    complementarity_residual: float = fact(
        "error of complementarity: force and motion at the same joint (a joint that is compressed and opens, or that sticks and "
        "slides). The lesser of force and motion counts at each joint; the value is the greatest of all joints"
    )
    work_residual: float = fact(
        "error of the work balance (work of the load minus work of weight and friction), divided by the work of the load"
    )


class Tilt(KindResults):
    """tilt: the constant horizontal acceleration at which a structure becomes a mechanism."""

    collapse_acceleration_g: float = fact("collapse acceleration (horizontal, constant), towards +x", "g")
    collapse_acceleration_opposite_g: float = fact("collapse acceleration (horizontal, constant), towards -x", "g")
    tilt_angle_deg: float = fact(
        "tilt of the ground with the same effect as the collapse acceleration towards +x", "deg", source="thesis Eq. 3.1"
    )
    tilt_angle_opposite_deg: float = fact("tilt of the ground with the same effect as the collapse acceleration towards -x", "deg")
    admissible_interval_g: list[float] = fact("accelerations between which an admissible thrust line exists", "g")
    load_direction: Literal["+x"] = fact("direction of the load for which `hinges` and friction are given: always +x")
    hinges: list[Hinge] = fact("hinges of the collapse mechanism towards +x")
    sliding_joints: list[int] = fact("joints that slide or open in the collapse mechanism towards +x")
    hinges_opposite: list[Hinge] = fact("hinges of the collapse mechanism towards -x")
    dilating_joints: list[int] = maybe(
        "joints in compression that slide in the collapse mechanism towards +x. The collapse acceleration is then an "
        "upper bound, because the analysis assumes dilatant (associated) friction"
    )
    dilating_joints_opposite: list[int] = maybe("joints in compression that slide in the collapse mechanism towards -x")
    collapse_acceleration_non_associated_g: float = maybe(
        "collapse acceleration towards +x for sliding without dilatancy: the lowest of the certified "
        "states that were found. The possible values form an interval; its upper end is the value with dilatant (associated) friction",
        "g",
        source="Ferris and Tin-Loi 2001",
    )
    collapse_acceleration_non_associated_opposite_g: float = maybe(
        "collapse acceleration towards -x for sliding without dilatancy: the lowest of the certified states that were found", "g"
    )
    collapse_acceleration_load_path_g: float = maybe(
        "design value of the collapse acceleration towards +x, if joints slide: the lowest value of the load "
        "paths with elastic joints, for three ratios of joint stiffness",
        "g",
        source="collapse acceleration with elastic-frictional joints without dilatancy (incremental return "
        "mapping); the certificate is the same as in `non_dilatant`",
    )
    collapse_acceleration_load_path_opposite_g: float = maybe(
        "design value of the collapse acceleration towards -x, if joints slide: the lowest value of the load paths", "g"
    )
    load_paths: list[LoadPath] = maybe("load paths towards +x, one for each ratio of joint stiffness")
    load_paths_opposite: list[LoadPath] = maybe("load paths towards -x, one for each ratio of joint stiffness")
    non_associated_reason: str = maybe("reason for the missing collapse state without dilatancy, if only the upper bound is given")
    touching_joints: list[int] = fact("joints in which the thrust line reaches an end of the joint without forming a hinge")
    required_friction: float | None = fact("greatest coefficient of friction that the thrust line requires at collapse")
    required_friction_joint: int = fact("joint with the greatest required friction")
    geometric_safety_factor: float | None = fact(
        "geometric safety factor without tilt: 1 divided by the smallest central part of the joints that "
        "contains a thrust line (found within 0.001), at most 100. Null if not requested, or if a "
        "thrust line passes through the middle 1 % of all joints (no horizontal demand)"
    )
    weight_N: float = fact("weight of the structure, with its fill", "N")
    depth_m: float = fact("depth out of plane", "m")
    reactions: list[Reaction] = fact("reactions of the ground at collapse")
    ties: list[TieForce] = maybe("forces of the ties at collapse")
    ties_opposite: list[TieForce] = maybe("forces of the ties at collapse under load towards -x")
    thrust_min_N: float = maybe(
        "minimum horizontal thrust, under vertical loads only, of the first arch in `thrusts`: at its left springing "
        "or, for an arch with ties, at its crown",
        "N",
    )
    thrust_max_N: float = maybe(
        "maximum horizontal thrust, under vertical loads only, of the first arch in `thrusts`: at its left springing "
        "or, for an arch with ties, at its crown",
        "N",
    )
    thrusts: dict[str, ChainThrust] = maybe(
        "minimum and maximum horizontal thrust of each arch under vertical loads only, by the name of the arch"
    )
    clear_span_m: float = maybe("clear span", "m")
    rise_m: float = maybe("rise of the intrados", "m")
    base_width_m: float = maybe("width of a buttress at its base", "m")
    height_above_ground_m: float = maybe("height of the crown above the ground", "m")
    overall_width_m: float = maybe("overall width, including the outer buttresses", "m")
    nave_span_m: float = maybe("clear span of the nave", "m")
    left_aisle_span_m: float = maybe("clear span of the left aisle", "m")
    right_aisle_span_m: float = maybe("clear span of the right aisle", "m")
    duality_gap: float = fact("greatest difference between the lower bound (from equilibrium) and the upper bound (from a mechanism)", "g")
    fracture: Fracture = maybe("results of the collapse towards +x with the leeward buttress cracked")
    non_dilatant: NonDilatant = maybe("collapse towards +x by sliding without dilatancy: bounds of the acceleration, with a certificate")
    non_dilatant_opposite: NonDilatant = maybe(
        "collapse towards -x by sliding without dilatancy: bounds of the acceleration, with a certificate"
    )

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
            sought = self.non_associated_reason is not None
            return judge_design(min(self.capacity(one) for one in opposite), min(known, default=None), high, demand, sought)
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
    why = f" Collapse without dilatancy is not given: {reason}." if reason else ""
    return found.model_copy(update={"statement": f"{found.statement} Joints slide, so the capacity is an {DILATANT}.{why}"})


def judge_ductile(capacity: float, dry: float, demand: Demand) -> Verdict:
    """An upper bound by mortar that lasts until collapse [g], beside the capacity of dry joints [g], against the peak of the motion."""
    found = judge_acceleration(capacity, demand, "upper")
    more = (
        f"The joints keep their cohesion and tensile strength until collapse: {DUCTILE}. Without mortar, "
        f"the collapse acceleration is {dry:.3g} g."
    )
    return found.model_copy(update={"statement": f"{found.statement} {more}"})


def judge_design(design: float, least: float | None, most: float, demand: Demand, sought: bool = False) -> Verdict:
    """The least of the load paths [g], between the least state found (None: none is certified, or was `sought`) and the upper
    bound, against the peak of the motion."""
    peak = demand.peak_g
    upper = f"the {DILATANT} is {most:.3g} g" if most < inf else "no collapse mechanism exists with dilatant friction"
    none = "no lower value is certified" if sought else "no lower value was sought"
    lower = none if least is None else f"the lowest value found is {least:.3g} g"
    text = (
        f"Joints slide. The design value of the collapse acceleration (horizontal, constant) is {design:.3g} "
        f"g, the lowest value of the load paths with elastic joints; {lower}; {upper}"
    )
    if peak is None:
        return judge(f"{text}. There is no comparison with a demand, because the deck does not give exactly one motion.", None, design, "g")
    outcome: Outcome = "collapses" if peak >= most else "open" if peak >= design else "stands"
    place = {
        "collapses": "at or above the upper bound",
        "open": "between the design value and the upper bound",
        "stands": "below the design value",
    }
    text = f"{text}; the peak of the motion, {peak:.3g} g, applied as a constant horizontal acceleration, is {place[outcome]}."
    if outcome == "stands" and least is not None and peak >= least:
        text += (
            " Warning: the structure can collapse at this peak acceleration with another initial state of "
            "stress, which past settlements or past loads can cause."
        )
    return judge(text, peak, design, "g", outcome)


def judge_interval(least: float, most: float, spread: float, demand: Demand) -> Verdict:
    """A collapse acceleration between the least state found without dilatancy, one of several with a `spread`, and the
    upper bound [g]."""
    peak = demand.peak_g
    upper = f"the {DILATANT} is {most:.3g} g" if most < inf else "no collapse mechanism exists with dilatant friction"
    text = (
        "Joints slide, so the collapse acceleration (horizontal, constant) lies in an interval: the lowest value found is "
        f"{least:.3g} g; {upper}"
    )
    if peak is None:
        return judge(f"{text}. There is no comparison with a demand, because the deck does not give exactly one motion.", None, least, "g")
    outcome: Outcome
    if peak >= most:
        outcome, place = "collapses", "at or above the upper bound"
    elif peak >= least:
        outcome, place = "open", "between both"
    elif peak >= least - spread:
        outcome, place = (
            "open",
            (f"below the lowest value found, but the difference is less than the scatter of the values found ({spread:.3g} g)"),
        )
    else:
        outcome, place = "stands", "below the lowest value found"
    text = f"{text}; the peak of the motion, {peak:.3g} g, applied as a constant horizontal acceleration, is {place}."
    return judge(text, peak, least, "g", outcome)


class ThrustLine(ResultModel):
    """One admissible thrust line."""

    horizontal_N: float = maybe("horizontal thrust at the left springing of an arch, or at the base of a column of blocks", "N")
    horizontal_kN_per_m: float = maybe("horizontal thrust for each metre of depth", "kN/m")
    crown_N: float = maybe(
        "horizontal thrust at the crown of an arch whose voussoirs have ties: the thrust at the left "
        "springing plus the tie forces. The lines of minimum and maximum thrust then refer to the crown",
        "N",
    )
    over_weight: float = maybe("horizontal thrust, divided by the weight of the structure")
    required_friction: float | None = fact("greatest coefficient of friction that the thrust line requires")
    required_friction_joint: str = fact("joint with the greatest required friction")
    greatest_eccentricity_ratio: float = fact(
        "greatest eccentricity (distance from the middle of the joint), divided by the length of the joint"
    )
    reactions: list[Reaction] = fact("forces of the ground")
    ties: list[TieForce] = maybe("forces of the ties")

    def told_kN_per_m(self, depth_m: float) -> float:
        """The horizontal thrust that answers and figures tell: that at the crown where ties hold the arch below."""
        return self.horizontal_kN_per_m if self.crown_N is None else self.crown_N / depth_m / 1e3


class Thrust(KindResults):
    """thrust: admissible thrust lines at a given horizontal acceleration."""

    gamma_g: float = fact("acceleration towards +x for which the thrust lines are drawn", "g")
    chain: str | None = fact("arch or column of blocks whose minimum and maximum thrust are given; null if there is none")
    admissible_interval_g: list[float] = fact("accelerations between which an admissible thrust line exists", "g")
    geometric_safety_factor: float | None = fact(
        "geometric safety factor: 1 divided by the smallest central part of the joints that contains a thrust line (found within 0.001), "
        "at most 100. Null if not requested, or if a thrust line passes through the middle 1 % of all joints (no horizontal demand)"
    )
    least_part_of_joints: float = maybe("smallest central part of the joints that contains a thrust line (found within 0.001)")
    weight_N: float = fact("weight of the structure, with its fill", "N")
    depth_m: float = fact("depth out of plane", "m")
    dilating: bool = fact(
        "whether joints in compression slide in the mechanisms at the ends of `admissible_interval_g`. These ends are then upper bounds "
        "(dilatant friction), and an admissible line does not exclude sliding without dilatancy"
    )
    duality_gap: float = fact("greatest difference between the lower bound (from equilibrium) and the upper bound (from a mechanism)", "g")
    least: ThrustLine = maybe("the line of least thrust")
    most: ThrustLine = maybe("the line of greatest thrust")
    central: ThrustLine = maybe("most central thrust line; if it is missing, a warning gives the reason")

    def judged(self, demand: Demand) -> Verdict:
        """The part of the joints that the most central line needs against the whole; the ratio is the safety factor."""
        part = self.least_part_of_joints
        if part is None:
            return judge("The most central thrust line was not found.", None, None)
        if self.geometric_safety_factor is None:
            text = "a thrust line passes within 1 % of the joint length from the middle of each joint: there is no horizontal demand."
            return judge(f"At {self.gamma_g:g} g {text}", 0.0, 1.0, "of the joint")
        text = f"a thrust line exists within the central {100.0 * part:.3g} % of the joints."
        return judge(f"At {self.gamma_g:g} g {text}", part, 1.0, "of the joint")


#: Beside a verdict on a load whose partial factors are all 1
CHARACTERISTIC = "All partial factors are 1.0: loads and strengths are characteristic values, without the safety margin of a code."


class MovingLoad(KindResults):
    """moving-load: collapse load, or adequacy factor of a train, at every place along an arch or a bridge."""

    chain: str | None = fact("arch that the load crosses; null if the load crosses the top of the whole structure")
    collapse_load_N: float = fact("lowest collapse load of all positions; for a train, the total load on the structure at collapse", "N")
    collapse_load_kN_per_m: float = fact("lowest collapse load for each metre of depth", "kN/m")
    worst_place_m: float = fact(
        "x of the first axle at the governing position (lowest collapse load); for a train without "
        "axles, x of the origin of its uniform loads",
        "m",
    )
    worst_place_over_span: float = fact("distance from the left springing to the governing position, divided by the span")
    worst_way: Literal["+x", "-x"] = fact("direction of travel of the train at the governing position")
    hinges: list[NamedHinge] = fact("hinges of the collapse mechanism at the governing position")
    sliding_joints: list[int] = fact("joints that slide or open in the collapse mechanism at the governing position")
    dilating_joints: list[int] = maybe(
        "joints in compression that slide in the collapse mechanism. The collapse load is then an upper bound, because "
        "the analysis assumes dilatant (associated) friction"
    )
    greatest_compression_N: float = fact("greatest compression across a joint at collapse, with the load at the governing position", "N")
    places_without_limit: int = fact("number of positions at which no multiple of the load causes collapse")
    ties: list[TieForce] = maybe("forces of the ties at collapse, with the load at the governing position")
    duality_gap: float = fact(
        "greatest difference, over all positions, between the lower bound (from equilibrium) and the "
        "upper bound (from a mechanism), in multiples of the self-weight"
    )
    load_N: float = maybe("load given in the deck", "N")
    safety_factor: float = maybe("collapse load, divided by the load given in the deck")
    train: str = maybe('name of the train. "load": one total force, divided among the axles; "train": the deck gives the load of each axle')
    adequacy_factor: float = maybe(
        "adequacy factor: multiple of the train or load (with partial and dynamic factors) at which the bridge collapses"
    )
    live_load_factor: float = maybe(
        "live-load factor (partial factor times dynamic factor), with which the train is multiplied "
        "before the adequacy factor is calculated"
    )
    permissible_factor: float = maybe(
        "permissible limit state: greatest multiple of the train (with serviceability and dynamic factors) for which a thrust line "
        "exists within the permissible stress and the passive pressure of service"
    )
    permissible_place_m: float = maybe("x of the first axle at the position with the least permissible factor", "m")
    permissible_stress_Pa: float = maybe("permissible compressive stress under service loads", "Pa")
    characteristic: bool = maybe("whether all partial factors are 1.0, so that loads and strengths are characteristic values")
    violated: list[str] = maybe("assumptions of the bridge load that this structure does not satisfy")

    def judged(self, demand: Demand) -> Verdict:
        """The adequacy factor of the train against 1, or the load of the deck against the least collapse load [N]."""
        text = f"The collapse load is {three_figures(self.collapse_load_N / 1e3)} kN at the most dangerous position"
        bound: Bound | None = "upper" if self.dilating_joints else None
        more = f" Joints slide, so the collapse load is an {DILATANT}." if self.dilating_joints else ""
        judged = f"{more} {CHARACTERISTIC}" if self.characteristic else more
        violated = list(self.violated or ())
        if self.permissible_factor is not None:
            judged += f" Permissible limit state: satisfied up to {self.permissible_factor:.3g} times the train."
            if self.permissible_factor < 1.0:
                violated.append(
                    f"The train exceeds the permissible limit state (factor {self.permissible_factor:.3g}): repeated traffic may "
                    "damage the arch progressively. Limit the load or the traffic."
                )
        if self.load_N is None and self.adequacy_factor is not None:
            factored = "" if self.characteristic else "factored "
            return judge(
                f"The adequacy factor of the {factored}train is {self.adequacy_factor:.3g} at the most dangerous position.{judged}",
                1.0,
                self.adequacy_factor,
                "times the train",
                bound=bound,
                violated=violated,
            )
        if self.load_N is None:
            return judge(
                f"{text}. The deck gives no load for comparison.{more}", None, self.collapse_load_N, "N", bound=bound, violated=violated
            )
        return judge(
            f"{text}. This is {self.safety_factor:.3g} times the load of {three_figures(self.load_N / 1e3)} kN.{judged}",
            self.load_N,
            self.collapse_load_N,
            "N",
            bound=bound,
            violated=violated,
        )


class Stage(ResultModel):
    """A change of hinges while a support moves."""

    movement_m: float = fact("support movement at the start of this stage", "m")
    hinges: list[str] = fact("the three hinges")


class JointOpening(ResultModel):
    """A joint that opens or slides under moving supports."""

    joint: int = fact("number of the joint")
    name: str = fact("name of the joint")
    opening_mm: float = fact("opening of the joint at the end that opens more", "mm")
    side: OpenSide = fact("end of the joint that opens more; for arches intrados or extrados")
    slip_mm: float = fact("slip of the joint", "mm")


class MovingSupports(KindResults):
    """supports: openings under moving supports; of an arch, until it collapses."""

    movement_at_fall_m: float = maybe("support movement at which the arch collapses", "m")
    movement_at_fall_over_span: float = maybe("support movement at collapse, divided by the span")
    span_change_at_fall_ratio: float = maybe("increase of the span at collapse, divided by the span")
    thrust_at_rest_N: float = maybe("horizontal thrust at the start", "N")
    thrust_at_fall_N: float = maybe("horizontal thrust at collapse", "N")
    hinges_at_rest: list[JointHinge] = maybe("the three hinges at the start of the movement")
    hinges_at_fall: list[JointHinge] = maybe("the three hinges at collapse")
    joints_touched_at_fall: list[int] = maybe("joints without a hinge in which the thrust line reaches an end of the joint at collapse")
    stages: list[Stage] = maybe("stages of the movement: the start, and each change of hinges")
    openings: list[JointOpening] = maybe("joints that open or slide under [[initial.movements]]; the widest comes first")
    work_J: float = maybe("work of the weight during the movements of [[initial.movements]]", "J")
    work_gap_J: float = maybe("error of the energy balance: work of the weight minus work on the supports; zero in theory", "J")
    reactions: list[Reaction] = maybe("reactions of the ground under moving supports")
    ties: list[TieForce] = maybe("forces of the ties under moving supports")

    def judged(self, demand: Demand) -> Verdict:
        """The movement that the arch can follow [m]; the deck asks for none."""
        move = self.movement_at_fall_m
        if move is None:
            return judge(
                "The structure stands under the given movements, with open joints. The movement at which it collapses is not calculated.",
                None,
                None,
                "m",
            )
        return judge(
            f"The arch follows the movement of its support up to {move:.3g} m ({100.0 * self.movement_at_fall_over_span:.3g} "
            "% of the span), and then collapses.",
            None,
            move,
            "m",
        )
