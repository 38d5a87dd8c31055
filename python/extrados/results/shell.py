"""Results of the push of a building of shells."""

from typing import Literal

from extrados.results.fields import ResultModel, fact, maybe
from extrados.results.sla import SlaCurve
from extrados.results.verdict import Demand, KindResults, Verdict, capacity_alone, judge
from extrados.results.verification import Verification
from extrados.schema.quantities import three_figures


class WallShare(ResultModel):
    """What one wall carries at its foot."""

    wall: str = fact("name of the wall")
    shear_N: float = fact("in-plane shear force of the wall, along the load", "N")
    share: float = fact("share of the base shear that the wall carries at the greatest load")
    normal_N: float = fact("normal force of the wall; compression is negative", "N")
    normal_change_N: float = fact("change of the normal force from that under the constant loads; uplift is positive", "N")
    elastic_share: float = fact("share of the base shear that the wall carries before cracking")
    drifts: list[float | None] = fact("drift of each storey; null for a storey that the wall does not have")


class FirstCrack(ResultModel):
    """Where the building cracks first."""

    wall: str = fact("wall with the first crack")
    storey: int = fact("storey with the first crack, counted from 1")
    along_m: float = maybe("distance along the wall from its start; not given for a vault", "m")
    height_m: float = fact("height above the ground, or above the lowest springing", "m")
    place_m: list[float] = fact("coordinates x, y, z of the point", "m")
    base_shear_N: float = fact("base shear at the first crack", "N")


class JointMotion(ResultModel):
    """How far a joint between walls, or a bed joint in a wall, has come apart."""

    joint: str = fact("name of the joint")
    wall: str = fact("wall that contains the joint, or that abuts on another wall at the joint")
    opening_m: float = fact("greatest opening of the joint, at the greatest load", "m")
    slip_m: float = fact("greatest sliding of the joint, at the greatest load", "m")
    last_opening_m: float = fact("greatest opening of the joint, in the last equilibrium state", "m")
    last_slip_m: float = fact("greatest sliding of the joint, in the last equilibrium state", "m")
    first_base_shear_N: float | None = fact("base shear at which the bond of the joint first fails; null without failure", "N")
    broken_share: float = fact("share of the joint area where bond is partly or fully lost, in the last equilibrium state")


class SeatMotion(ResultModel):
    """How far a floor has moved off a wall on which it rests by friction."""

    floor: str = fact("floor: its number in the deck and its storey")
    wall: str = fact("wall on which the floor rests")
    normal_N: float = fact("load of the floor on its support on the wall, under the constant loads; compression is positive", "N")
    friction_N: float = fact("friction resistance of the support under the constant loads: coefficient of friction times load", "N")
    length_m: float = fact("length of the support of the floor on the wall", "m")
    slip_m: float = fact("greatest displacement of an end of the floor away from its support on the wall", "m")
    slip_along_m: float = fact("greatest displacement of an end of the floor along its support on the wall", "m")
    slid_off: bool = fact("whether an end of the floor has moved by more than the length of its support")
    slid_off_displacement_m: float | None = fact("control displacement at which the floor slid off", "m")
    slid_off_base_shear_N: float | None = fact("base shear at which the floor slid off", "N")

    @property
    def told(self) -> str:
        """Where it slid off, in words."""
        return f"{self.floor} slides off wall {self.wall}: the seat on this wall is {1e3 * self.length_m:.3g} mm long"


class FootForce(ResultModel):
    """What a foot of a vault presses on the ground with, at the greatest load or at the end of a settlement."""

    foot: str = fact("name of the foot")
    thrust_N: float = fact("outward thrust at the foot; for a dome, the sum around its circumference", "N")
    vertical_N: float = fact("vertical force of the foot on the ground, positive downwards", "N")


class Flanges(ResultModel):
    """Walls across the push, at the peak."""

    share: float = fact("share of the base shear that the walls parallel to the load do not carry in-plane")
    uplift_N: float = fact(
        "decrease of the compression at the feet of the walls perpendicular to the load, caused by the load (tension included)", "N"
    )
    pressure_N: float = fact("increase of the compression at the feet of the walls perpendicular to the load, caused by the load", "N")
    working: bool = fact("whether the walls perpendicular to the load carry an upward or downward force of more than 1/20 of the weight")


class SlidingLevel(ResultModel):
    """Coulomb's limit of a level: a base of a storey, or bed joints that cut all walls at a height."""

    level: str = fact("name of the level")
    height_m: float = fact("height of the level", "m")
    normal_N: float = fact("normal force on the level under the constant loads; compression is positive", "N")
    area_m2: float = fact("area of the walls at the level", "m^2")
    resistance_N: float = fact("sliding resistance: friction times normal force, plus cohesion times area", "N")
    shear_share: float = fact("share of the base shear that acts above the level")
    base_shear_N: float = fact("base shear at which the level slides", "N")


class PushCurve(SlaCurve):
    """The events of one sense of the push; loads are base shears."""

    capacity_N: float | None = fact(
        "greatest base shear, or the sliding limit if this is lower; null without an equilibrium state, or if the stage moves supports", "N"
    )
    sliding_capacity_N: float = maybe("lowest base shear at which a level slides by Coulomb's law", "N")
    sliding_level: str = maybe("the level that slides first")
    sliding: list[SlidingLevel] = maybe("sliding limits of all levels; not given without walls, or if sliding is excluded")
    base_shear_coefficient: float | None = fact("capacity divided by the weight")
    roof_drift: float | None = fact("roof drift: control displacement at the greatest load, divided by the height")
    storey_drifts: list[float | None] = fact("drift of each storey at the greatest load")
    walls: list[WallShare] = fact("base shear of each wall at the greatest load")
    flanges: Flanges = maybe("contribution of the transverse walls (flanges) to the base shear")
    first_crack: FirstCrack = maybe("location of the first crack; not given if nothing cracks")
    joints: list[JointMotion] = maybe("greatest opening and sliding of each joint")
    seats: list[SeatMotion] = maybe("load and slip of the floors on their supports; not given without such supports")
    feet: list[FootForce] = maybe("for a vault or dome: forces of its feet on the ground")
    cracked_points_by_storey: list[int] = fact(
        "number of cracked integration points (in the planes of the walls) at the greatest load, by storey"
    )


class StageOfPush(PushCurve):
    """One stage of several; loads are those in the direction of its own, with what stages before have left on. Of ground that
    gives way they are the forces that move it."""

    name: str = fact("name or number of the stage")
    of: Literal["push", "settlement"] = fact("kind of stage: push or settlement")
    prefix: str = fact("prefix of the array names of this stage; empty for the stage that gives the results of the analysis")
    start_load_N: float = fact("load at the start of the stage", "N")
    end_load_N: float | None = fact("load at the end of the stage", "N")


class FrameCapacity(ResultModel):
    """What the piers of the weakest storey bear by the formulas of a code."""

    code: str = fact("name of the code; if the formulas of the code for a pier differ, the least strength counts")
    base_shear_N: float = fact(
        "base shear at which the shear force in the weakest storey equals the sum of the strengths of its piers", "N"
    )
    storey: int = fact("number of the weakest storey, counted from 1")


class Variation(ResultModel):
    """The same push with another assumption."""

    name: str = fact("name of the variant")
    factors: dict[str, float] = fact("factors of the variant, from the deck")
    greatest_base_shear_N: float | None = fact("greatest base shear in equilibrium", "N")
    passed: bool = fact("whether the greatest base shear is a peak, after which the base shear decreases")
    base_shear_coefficient: float | None = fact("base shear, divided by the weight of this variant")


class Pushover(PushCurve, KindResults):
    """pushover: a building under growing horizontal forces; the curve of the first sense, and of both."""

    weight_N: float = fact("weight of walls and floors", "N")
    reference_load_N: float = fact("base shear at load multiplier 1", "N")
    pattern: str = fact("distribution of the horizontal forces")
    direction_deg: float = fact("direction of the load in plan", "deg")
    frequency_Hz: float = maybe("frequency of the mode that gives the distribution of the load", "Hz")
    modal_mass_ratio: float = maybe("participating mass ratio of the mode that gives the distribution of the load")
    cracking: str = fact("model of cracked material")
    layers: int = fact("number of integration points through the thickness of the walls")
    nodes: int = fact("nodes of the mesh")
    elements: int = fact("elements of the mesh")
    equations: int = fact("equations")
    points: int = fact("number of integration points, including those of bars")
    factor_bytes: int = fact("memory of the matrix factors, in bytes")
    minus: PushCurve = maybe("capacity curve under the load in the opposite direction")
    stages: list[StageOfPush] = maybe(
        "for a run in stages: results of each stage. If the deck names no stage, the results of the analysis are those of the main stage"
    )
    frame: list[FrameCapacity] = maybe("strengths of the piers by code formulas, in the direction of the load")
    variants: list[Variation] = maybe("results under other assumptions, for the first direction of the load")
    verification: Verification = maybe("displacement-based verification of a building given by its plan")
    band_N: list[float] = maybe("least and greatest base shear of the deck and all variants", "N")

    def judged(self, demand: Demand) -> Verdict:
        """The verification by displacement; without one the lesser capacity of the two senses, without an outcome."""
        curves = [c for c in (self, self.minus) if c is not None]
        if any(c.capacity_N is None for c in curves):
            return judge(f"No equilibrium state with a base shear was found. Reason for the end of the run: {self.stop}.", None, None, "N")
        least = min(curves, key=lambda c: c.capacity_N or 0.0)
        load, capacity = least.greatest_load_N or 0.0, least.capacity_N or 0.0
        slides, reached = capacity < load, least.greatest_acceleration_g
        unit, value = ("N", capacity) if reached is None else ("g", abs(reached) * capacity / load if load else 0.0)
        told = f"{three_figures(capacity / 1e3)} kN" + ("" if reached is None else f" ({value:.3g} g times the masses)")
        fallen = "".join(f" Then {seat.told}." for curve in curves for seat in curve.seats or [] if seat.slid_off)
        if self.verification is not None and self.verification.decides:
            return self.verification.judged(f"The greatest base shear is {told}.{fallen}")
        if slides:
            text = f"Sliding at {least.sliding_level} limits the base shear to {told}, by Coulomb's law."
            violated = [
                (
                    f"The model, which excludes this sliding, carries {three_figures(load / 1000.0)} kN: {load / capacity:.3g} "
                    "times the sliding limit."
                )
            ]
            return capacity_alone(text, value, unit, "upper", violated)
        if least.peak_load_N is None:
            text = f"The base shear has reached {told}, and the run ended before it decreased. The capacity is therefore not known."
            return capacity_alone(text, value, unit, "lower")
        return capacity_alone(f"The building can carry a base shear of {told}.{fallen}", value, unit)
