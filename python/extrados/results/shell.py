"""Results of the push of a building of shells."""

from typing import Literal

from extrados.results.fields import ResultModel, fact, maybe
from extrados.results.sla import SlaCurve
from extrados.results.verdict import Demand, KindResults, Verdict, capacity_alone, judge
from extrados.results.verification import Verification


class WallShare(ResultModel):
    """What one wall carries at its foot."""

    wall: str = fact("its name")
    shear_N: float = fact("in its plane, along the push", "N")
    share: float = fact("part of the base shear")
    normal_N: float = fact("compression is negative", "N")
    normal_change_N: float = fact("besides those of the constant loads; uplift is positive", "N")
    elastic_share: float = fact("part of the base shear before it cracks")
    drifts: list[float | None] = fact("drift of each storey; null where the wall has none")


class FirstCrack(ResultModel):
    """Where the building cracks first."""

    wall: str = fact("the wall")
    storey: int = fact("the storey, from 1")
    along_m: float = maybe("along the wall from its start; absent of a vault", "m")
    height_m: float = fact("over the ground, or the lowest springing", "m")
    place_m: list[float] = fact("x, y, z of the place", "m")
    base_shear_N: float = fact("under this base shear", "N")


class JointMotion(ResultModel):
    """How far a joint between walls, or a bed joint in a wall, has come apart."""

    joint: str = fact("its name")
    wall: str = fact("the wall that it is in, or that abuts there")
    opening_m: float = fact("place of greatest width, at the greatest load", "m")
    slip_m: float = fact("place of greatest sliding along its wall, at the greatest load", "m")
    last_opening_m: float = fact("place of greatest width, in the last state in equilibrium", "m")
    last_slip_m: float = fact("place of greatest sliding, in the last state in equilibrium", "m")
    first_base_shear_N: float | None = fact("base shear at which its bond first fails; null without failure", "N")
    broken_share: float = fact("part of its area that has lost some of its bond, in the last state in equilibrium")


class FootForce(ResultModel):
    """What a foot of a vault presses on the ground with, at the greatest load or at the end of a settlement."""

    foot: str = fact("its name")
    thrust_N: float = fact("outward; of a dome the sum all around", "N")
    vertical_N: float = fact("downward", "N")


class Flanges(ResultModel):
    """Walls across the push, at the peak."""

    share: float = fact("part of the base shear that is not carried by the walls in their own planes along the push")
    uplift_N: float = fact("tension and relieved compression that walls across the push take at their feet", "N")
    pressure_N: float = fact("compression added to them", "N")
    working: bool = fact("whether they take more than a twentieth of the weight up or down")


class SlidingLevel(ResultModel):
    """Coulomb's limit of a level: a base of a storey, or bed joints that cut all walls at a height."""

    level: str = fact("its name")
    height_m: float = fact("its height", "m")
    normal_N: float = fact("normal force on it under the constant loads; compression is positive", "N")
    area_m2: float = fact("area of its walls", "m^2")
    resistance_N: float = fact("friction times the normal force, and cohesion times the area", "N")
    shear_share: float = fact("part of the base shear that acts above it")
    base_shear_N: float = fact("base shear under which it slides", "N")


class PushCurve(SlaCurve):
    """The events of one sense of the push; loads are base shears."""

    capacity_N: float | None = fact(
        "greatest base shear, or the sliding limit if less; null without a state, and of ground that moves", "N"
    )
    sliding_capacity_N: float = maybe("least base shear under which a level slides by Coulomb's limit", "N")
    sliding_level: str = maybe("the level that slides first")
    sliding: list[SlidingLevel] = maybe("limits of all levels; absent without walls, and where friction excludes sliding")
    base_shear_coefficient: float | None = fact("capacity over the weight")
    roof_drift: float | None = fact("control displacement there over its height")
    storey_drifts: list[float | None] = fact("drift of each storey there")
    walls: list[WallShare] = fact("base shear of each wall there")
    flanges: Flanges = maybe("whether walls across the push work with them")
    first_crack: FirstCrack = maybe("place of its first crack; absent without cracks")
    joints: list[JointMotion] = maybe("how far its joints have come apart")
    feet: list[FootForce] = maybe("of a vault or dome: forces of its feet on the ground")
    cracked_points_by_storey: list[int] = fact("places in the planes of the walls that have cracked there, by storey")


class StageOfPush(PushCurve):
    """One stage of several; loads are those in the direction of its own, with what stages before have left on. Of ground that
    gives way they are the forces that move it."""

    name: str = fact("its name, or its number")
    of: Literal["push", "settlement"] = fact("quantity")
    prefix: str = fact("how the names of its arrays begin; empty for the stage that represents the analysis")
    start_load_N: float = fact("load at its start", "N")
    end_load_N: float | None = fact("load at its end", "N")


class FrameCapacity(ResultModel):
    """What the piers of the weakest storey bear by the formulas of a code."""

    code: str = fact("the code; of its formulas the least counts for a pier")
    base_shear_N: float = fact("base shear at which the shear in the weakest storey equals the sum of the strengths of its piers", "N")
    storey: int = fact("the weakest storey, from 1")


class Variation(ResultModel):
    """The same push with another assumption."""

    name: str = fact("its name")
    factors: dict[str, float] = fact("by the deck")
    greatest_base_shear_N: float | None = fact("greatest base shear in equilibrium", "N")
    passed: bool = fact("whether that was a peak")
    base_shear_coefficient: float | None = fact("over the weight of that variant")


class Pushover(PushCurve, KindResults):
    """pushover: a building under growing horizontal forces; the curve of the first sense, and of both."""

    weight_N: float = fact("weight of walls and floors", "N")
    reference_load_N: float = fact("base shear to which the multiplier 1 belongs", "N")
    pattern: str = fact("of the horizontal forces")
    direction_deg: float = fact("of the push on the plan", "deg")
    frequency_Hz: float = maybe("of the mode whose pattern pushes", "Hz")
    modal_mass_ratio: float = maybe("part of the mass that takes part in that mode")
    cracking: str = fact("how cracked material behaved")
    layers: int = fact("points through the thickness of the walls")
    nodes: int = fact("nodes of the mesh")
    elements: int = fact("elements of the mesh")
    equations: int = fact("equations")
    points: int = fact("integration points, those of bars too")
    factor_bytes: int = fact("memory of the factor, in bytes")
    minus: PushCurve = maybe("the curve of the second sense")
    stages: list[StageOfPush] = maybe("of a run in stages, each; without a name, the numbers are those of the main one")
    frame: list[FrameCapacity] = maybe("strengths of its piers by the formulas of codes, in the direction of the push")
    variants: list[Variation] = maybe("the first sense with other assumptions")
    verification: Verification = maybe("displacement-based verification of a building that is given in plan")
    band_N: list[float] = maybe("least and greatest base shear of all variants and the deck's own", "N")

    def judged(self, demand: Demand) -> Verdict:
        """The verification by displacement; without one the lesser capacity of the two senses, without an outcome."""
        curves = [c for c in (self, self.minus) if c is not None]
        if any(c.capacity_N is None for c in curves):
            return judge(f"No state with a base shear was found; the run ended by: {self.stop}.", None, None, "N")
        least = min(curves, key=lambda c: c.capacity_N or 0.0)
        load, capacity = least.greatest_load_N or 0.0, least.capacity_N or 0.0
        slides, reached = capacity < load, least.greatest_acceleration_g
        unit, value = ("N", capacity) if reached is None else ("g", abs(reached) * capacity / load if load else 0.0)
        told = f"{capacity / 1e3:.4g} kN" + ("" if reached is None else f" ({value:.3g} g times the masses)")
        if self.verification is not None and self.verification.decides:
            return self.verification.judged(f"The greatest base shear is {told}.")
        if slides:
            text = f"Sliding on {least.sliding_level} limits the base shear to {told}, by Coulomb's law."
            violated = [f"The model excludes that sliding and carries {load / 1e3:.4g} kN, {load / capacity:.3g} times the sliding limit."]
            return capacity_alone(text, value, unit, "upper", violated)
        if least.peak_load_N is None:
            text = f"The base shear has reached {told} without a peak; the capacity is not known."
            return capacity_alone(text, value, unit, "lower")
        return capacity_alone(f"The building carries a base shear of {told}.", value, unit)
