"""Results of frames of macro-elements."""

from typing import Literal

from extrados.results.fields import ResultModel, fact, maybe
from extrados.results.verdict import Demand, KindResults, Outcome, Verdict, capacity_alone, judge
from extrados.results.verification import Verification


class FrameMode(ResultModel):
    """A mode of vibration about the equilibrium under the weight."""

    frequency_Hz: float = fact("frequency of the mode", "Hz")
    period_s: float = fact("period of the mode", "s")
    mass_ratio_x: float = fact("participating mass along x, divided by the total mass of the levels above the ground")
    mass_ratio_y: float = fact("participating mass along y, divided by the total mass of the levels above the ground")


class FrameModes(KindResults):
    """frame-modes: vibration of a building as a frame of macro-elements."""

    modes: list[FrameMode] = fact("modes from the lowest frequency")
    moving_mass_kg: float = fact("total mass of the levels above the ground, which the modes move", "kg")
    weight_N: float = fact("weight of walls and floors", "N")
    piers: int = fact("piers")
    spandrels: int = fact("spandrels")
    walls: list[str] = fact("names of the walls; the arrays number the walls in this order")

    def judged(self, demand: Demand) -> Verdict:
        """Modes are neither a demand nor a capacity."""
        text = f"The first natural period is {self.modes[0].period_s:.3g} s. Vibration modes alone do not decide a limit state."
        return judge(text, None, None, "", "not-applicable")


class Modes(KindResults):
    """modes: vibration of plane blocks, all joints closed."""

    modes: list[FrameMode] = fact("vibration modes, the lowest frequency first; y is vertical")
    moving_mass_kg: float = fact("mass of blocks and fill", "kg")
    blocks: int = fact("blocks")

    def judged(self, demand: Demand) -> Verdict:
        """Modes are neither a demand nor a capacity."""
        text = f"The first natural frequency is {self.modes[0].frequency_Hz:.3g} Hz. Vibration modes alone do not decide a limit state."
        return judge(text, None, None, "", "not-applicable")


class PierLimits(ResultModel):
    """Control displacements at which the piers of a storey of a wall reach their strength, and their drift limit; null: never."""

    wall: str = fact("name of the wall")
    storey: int = fact("number of the storey, counted from 1")
    first_at_strength_m: float | None = fact("control displacement at which the first pier reaches its strength; null if none does", "m")
    all_at_strength_m: float | None = fact(
        "control displacement at which the last pier reaches its strength; null if not all piers do", "m"
    )
    first_at_limit_m: float | None = fact("control displacement at which the first pier reaches its drift limit; null if none does", "m")
    all_at_limit_m: float | None = fact(
        "control displacement at which the last pier reaches its drift limit; null if not all piers do", "m"
    )


class FailedElement(ResultModel):
    """An element beyond its drift limit."""

    element: str = fact("name of the element: wall, storey, and pier or spandrel")
    mode: Literal["flexure", "shear"] = fact("failure mode: flexure or shear")
    control_displacement_m: float = fact("control displacement at which the element reaches its drift limit", "m")


class FramePush(ResultModel):
    """One pushover."""

    name: str = fact("direction, pattern and eccentricity")
    direction_deg: float = fact("direction of the load in plan, as an angle from +x", "deg")
    sense: Literal["+", "-"] = fact("sense of the load. +: in the direction `direction_deg`; -: in the opposite direction")
    pattern: str = fact("distribution of the lateral forces")
    eccentricity: float = fact("accidental eccentricity, divided by the length of the building perpendicular to the load")
    stop: str = fact("reason why the run ended")
    lost_at: str = maybe("if the run ends without equilibrium: the node or wall that moves most, in words")
    control_displacement_m: list[float] = fact(
        "mean displacement of the masses on the control level, positive in the direction of the load", "m"
    )
    base_shear_N: list[float] = fact("base shear, positive in the direction of the load", "N")
    peak_base_shear_N: float = fact("greatest base shear", "N")
    displacement_at_peak_m: float = fact("control displacement at the greatest base shear", "m")
    drop_displacement_m: float | None = fact(
        "control displacement at which the base shear has decreased by 20 %; null if the decrease is smaller", "m"
    )
    ultimate_displacement_m: float | None = fact(
        "ultimate displacement, the least of three: 20 % decrease of the base shear; all piers of one storey of a wall at their drift "
        "limit; end of the curve without equilibrium beyond a drift limit. Null if none is reached",
        "m",
    )
    stiffness_N_m: float | None = fact(
        "secant stiffness at 10 % of the greatest base shear; null if the curve has no displacement below that load", "N/m"
    )
    period_s: float = fact("period of the mode with the greatest participating mass in the direction of the load", "s")
    equivalent_mass_kg: float = fact(
        "m*: sum of mass times mode shape over all masses; the mode shape is 1 at the control displacement", "kg"
    )
    participation_factor: float = fact("Gamma: m* divided by the sum of mass times squared mode shape")
    level_mass_kg: list[float] = fact("mass on each level, from the lowest level upwards", "kg")
    level_shape: list[float] = fact("mean of the mode shape on each level, positive in the direction of the load")
    storeys: list[PierLimits] = fact("limit events of the piers (strength and drift limit), for each storey of each wall")
    failed: list[FailedElement] = fact("elements beyond their drift limits, in the order in which they reach them")


class OutOfPlane(ResultModel):
    """The wall of least margin out of its plane, by local-mechanism."""

    factor: float | None = fact("ratio of capacity to demand of the governing check; null without such a check")
    outcome: Outcome = fact("verdict: stands, collapses, open or not-applicable")
    building_period_s: float = fact("period of the frame, from which the floor spectrum is calculated", "s")
    statement: str = fact("verdict in words")


class WallDeflection(ResultModel):
    """A wall out of its plane, with its deflection, under a constant acceleration across its plane."""

    wall: str = fact("name of the wall")
    acceleration_g: float = fact(
        "greatest constant acceleration that the wall carries; 0 if the wall has no equilibrium under its weight", "g"
    )
    deflection_m: float = fact("greatest deflection at this acceleration", "m")
    height_m: float = fact("height above the ground at which the deflection is greatest", "m")
    reached: bool = fact("whether the acceleration decreases with further deflection; if not, the acceleration is a lower bound")
    rigid_acceleration_g: float | None = fact(
        "least collapse multiplier of the wall as a rigid body that rotates out of its plane about the foot of a storey (local-mechanism, "
        "without confidence factor); null if floors restrain the wall, or if a warning says that the multiplier is not calculated",
        "g",
    )
    held_at_m: list[float] = fact("heights at which rigid floors or props restrain the wall", "m")


class FramePushover(KindResults):
    """frame-pushover: a building as a frame of macro-elements under growing horizontal forces."""

    runs: list[FramePush] = fact("all pushovers")
    governing: str = fact("name of the pushover with the least base shear")
    base_shear_N: float = fact("greatest base shear of the governing pushover", "N")
    ultimate_displacement_m: float | None = fact("ultimate displacement of the governing pushover; null if not reached", "m")
    failed: list[FailedElement] = fact(
        "elements that exceed their drift limits in the governing pushover, in the order in which they reach them"
    )
    weight_N: float = fact("weight of walls and floors", "N")
    moving_mass_kg: float = fact("total mass of the levels above the ground, which the modes move", "kg")
    control_level: int = fact("storey whose top floor gives the control displacement")
    control_height_m: float = fact("height of the control level", "m")
    piers: int = fact("piers")
    spandrels: int = fact("spandrels")
    walls: list[str] = fact("names of the walls; the arrays number the walls in this order")
    remarks: list[str] = fact("parts of the building that the frame model neglects")
    ring_beam_moment_Nm: float = maybe("greatest moment of the (elastic) ring beams in all pushovers, up to the peak of each", "N*m")
    out_of_plane: OutOfPlane = maybe("check of the walls for out-of-plane failure; only with a seismic action")
    walls_out_of_plane: list[WallDeflection] = maybe(
        "out-of-plane capacity of each wall under a constant acceleration, with deflection, cracking and crushing; the weakest wall first"
    )
    verification: Verification = maybe("displacement-based verification: all pushovers at the limit states of the code")

    @property
    def wall_below_frame(self) -> bool:
        """Whether the acceleration that a wall carries out of its plane is less than the base shear of the frame over the weight."""
        return bool(self.walls_out_of_plane) and self.walls_out_of_plane[0].acceleration_g < self.base_shear_N / self.weight_N

    def weakest_wall(self) -> str:
        """The wall that carries the least acceleration out of its plane, in words; empty without such a calculation."""
        if not self.walls_out_of_plane:
            return ""
        wall = self.walls_out_of_plane[0]
        if not wall.acceleration_g > 0.0:
            return f"Out of its plane, wall '{wall.wall}' has no equilibrium under its own weight."
        least, before = "" if wall.reached else "at least ", ""
        if self.wall_below_frame:
            then = "the wall fails first" if wall.reached else "either may fail first"
            before = f" This is less than the ratio of the base shear of the frame to the weight ({self.base_shear_N / self.weight_N:.3g}), so {then}."
        return (
            f"Out of its plane, wall '{wall.wall}' carries {least}a constant acceleration of {wall.acceleration_g:.3g} "
            f"g. Its deflection is then {1000.0 * wall.deflection_m:.3g} mm at a height of {wall.height_m:.3g} m. "
            f"Transverse walls are not included.{before}"
        )

    def judged(self, demand: Demand) -> Verdict:
        """The verification by displacement; without one the least base shear, without an outcome."""
        lost = [row.name for row in self.runs if row.stop.startswith("no equilibrium") and row.drop_displacement_m is None]
        text = f"The frame can carry a base shear of {self.base_shear_N / 1e3:.3g} kN ({self.governing})."
        if self.ring_beam_moment_Nm is not None:
            text += f" The greatest moment of the ring beams, which are modelled as elastic, is {self.ring_beam_moment_Nm / 1e3:.3g} kN m."
        if self.wall_below_frame:
            text += f" {self.weakest_wall()}"
        if self.out_of_plane is not None and self.out_of_plane.outcome in ("collapses", "cannot-stand"):
            factor = "" if self.out_of_plane.factor is None else f" (safety factor {self.out_of_plane.factor:.3g})"
            text += f" At least one wall does not satisfy the check for out-of-plane failure{factor}. {self.out_of_plane.statement}"
        if self.verification is not None and self.verification.decides:
            return self.verification.judged(text)
        if lost:
            text += f" {len(lost)} of {len(self.runs)} capacity curves end before the base shear has decreased by 20 %."
        return capacity_alone(text, self.base_shear_N, "N", "lower" if self.governing in lost else None)


FrameLimitState = Literal["strength", "first-limit", "collapse"]


class FrameLimitCurve(ResultModel):
    """Fragility at a limit state: all piers of a storey of a wall at their strength (strength); the first pier beyond its drift limit
    (first-limit); all piers of a storey of a wall beyond theirs, or no equilibrium (collapse; of pushovers also a loss of 20 % of
    the base shear)."""

    limit_state: FrameLimitState = fact("strength, first-limit or collapse")
    exceeded: int = fact(
        "number of runs that exceed the limit state; for pushovers, number of sampled buildings that exceed it under their unscaled motion"
    )
    share: float = fact("share of the runs with a result that exceed the limit state")
    share_interval: list[float] = fact("confidence interval of `share` (Wilson score, level `confidence`)")
    median_g: float | None = fact("median of the lognormal fragility curve; null if the runs are not enough to fit a curve", "g")
    dispersion: float | None = fact("logarithmic standard deviation of the fragility curve")
    median_interval_g: list[float] | None = fact("confidence interval of the median; null if not known", "g")
    probability: list[float | None] = maybe("share of the motions that exceed the limit state, at each level of intensity")


class FrameFragility(KindResults):
    """frame-fragility: probability that a building exceeds its limit states, over motions and uncertain values."""

    method: Literal["history", "pushover"] = fact("history, or pushover with N2")
    intensity: str = fact("intensity measure of the motions")
    motions: int = fact("motions")
    limit_states: list[FrameLimitCurve] = fact("fragility curves; the least severe limit state comes first")
    confidence: float = fact("level of the confidence intervals")
    uncertain: list[str] = fact("names of the uncertain values")
    histories: int = maybe("for time histories: number of runs with a result")
    buildings: int = maybe("for pushovers: number of sampled buildings")
    levels_g: list[float] = maybe("levels of the intensity", "g")
    drift_16: list[float | None] = maybe(
        "16th percentile of the greatest pier drift, at each level of intensity; null if this percentile corresponds to collapse"
    )
    drift_50: list[float | None] = maybe(
        "median of the greatest pier drift, at each level of intensity; null if the median corresponds to collapse"
    )
    drift_84: list[float | None] = maybe(
        "84th percentile of the greatest pier drift, at each level of intensity; null if this percentile corresponds to collapse"
    )
    confidence_factor: float = maybe("confidence factor of the code for the knowledge level")
    design_intensity_g: float = maybe(
        "intensity of the median motion at which the building collapses, with all strengths divided by the confidence factor", "g"
    )
    weaker_share: float = maybe(
        "share of the sampled buildings that collapse under the median motion at an intensity below `design_intensity_g`"
    )

    def judged(self, demand: Demand) -> Verdict:
        """Probabilities, which decide no limit state without an accepted one."""
        worst = self.limit_states[-1]
        median = f"The median {self.intensity} at collapse is {worst.median_g:.3g} g" if worst.median_g else "No curve of collapse"
        text = f"{median}; {worst.exceeded} runs exceed the limit state of collapse."
        return judge(text, None, None, "", "not-applicable")


class FrameHistory(KindResults):
    """frame-history: motion of a building as a frame of macro-elements."""

    stop: str = fact("reason why the run ended")
    end_time_s: float = fact("end of the calculation", "s")
    peak_displacement_m: float = fact(
        "greatest displacement of the control level relative to the ground, along the direction of the motion", "m"
    )
    peak_base_shear_N: float = fact("greatest base shear along the direction of the motion", "N")
    residual_displacement_m: float = fact("displacement of the control level at the end of the run", "m")
    peak_drift: float = fact("greatest drift (chord rotation) of a pier")
    peak_drift_element: str = fact("pier with the greatest drift")
    failed: list[FailedElement] = fact(
        "elements that exceed their drift limits, in the order in which they reach them, with the control displacement at that instant"
    )
    period_s: float = fact("period of the undamaged frame: mode with the greatest participating mass in the direction of the motion", "s")
    damping: list[float] = fact(
        "Rayleigh damping: factor of the mass matrix [1/s], and factor of the tangent stiffness of the last step [s]"
    )
    weight_N: float = fact("weight of walls and floors", "N")
    steps: int = fact("time steps")
    first_failure_s: float = maybe("time at which the first element reaches its drift limit", "s")

    def judged(self, demand: Demand) -> Verdict:
        """Open without equilibrium; else the drifts, which decide no limit state."""
        moved = (
            f"the greatest displacement is {1e3 * self.peak_displacement_m:.3g} mm and the greatest drift of a pier "
            f"{100 * self.peak_drift:.3g} %"
        )
        if self.stop != "target displacement":
            return judge(f"The calculation ends at {self.end_time_s:.3g} s ({self.stop}): {moved}.", None, None, "", "open")
        return judge(
            f"The calculation reaches the end of the motion: {moved}, and {len(self.failed)} elements are beyond their drift limits.",
            None,
            None,
            "",
            "not-applicable",
        )
