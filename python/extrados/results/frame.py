"""Results of frames of macro-elements."""

from typing import Literal

from extrados.results.fields import ResultModel, fact, maybe
from extrados.results.verdict import Demand, KindResults, Outcome, Verdict, capacity_alone, judge
from extrados.results.verification import Verification


class FrameMode(ResultModel):
    """A mode of vibration about the equilibrium under the weight."""

    frequency_Hz: float = fact("its frequency", "Hz")
    period_s: float = fact("its period", "s")
    mass_ratio_x: float = fact("ratio of the participating mass along x to the moving mass")
    mass_ratio_y: float = fact("ratio of the participating mass along y to the moving mass")


class FrameModes(KindResults):
    """frame-modes: vibration of a building as a frame of macro-elements."""

    modes: list[FrameMode] = fact("modes from the lowest frequency")
    moving_mass_kg: float = fact("masses on the levels above the ground, as moved by the modes", "kg")
    weight_N: float = fact("weight of walls and floors", "N")
    piers: int = fact("piers")
    spandrels: int = fact("spandrels")
    walls: list[str] = fact("names of the walls in the order of their numbers in the arrays")

    def judged(self, demand: Demand) -> Verdict:
        """Modes are neither a demand nor a capacity."""
        text = f"The first natural period is {self.modes[0].period_s:.3g} s. Modes alone do not decide a limit state."
        return judge(text, None, None, "", "not-applicable")


class Modes(KindResults):
    """modes: vibration of plane blocks, all joints closed."""

    modes: list[FrameMode] = fact("vibration modes, the lowest frequency first; y is vertical")
    moving_mass_kg: float = fact("mass of blocks and fill", "kg")
    blocks: int = fact("blocks")

    def judged(self, demand: Demand) -> Verdict:
        """Modes are neither a demand nor a capacity."""
        text = f"The first natural frequency is {self.modes[0].frequency_Hz:.3g} Hz. Modes alone do not decide a limit state."
        return judge(text, None, None, "", "not-applicable")


class PierLimits(ResultModel):
    """Control displacements at which the piers of a storey of a wall reach their strength, and their drift limit; null: never."""

    wall: str = fact("its name")
    storey: int = fact("the storey, from 1")
    first_at_strength_m: float | None = fact("base shear at which the first pier reaches its strength", "m")
    all_at_strength_m: float | None = fact("base shear at which the last pier reaches its strength", "m")
    first_at_limit_m: float | None = fact("base shear at which the first pier reaches its drift limit", "m")
    all_at_limit_m: float | None = fact("base shear at which the last pier reaches its drift limit", "m")


class FailedElement(ResultModel):
    """An element beyond its drift limit."""

    element: str = fact("name of the element: wall, storey, and pier or spandrel")
    mode: Literal["flexure", "shear"] = fact("failure mode: flexure or shear")
    control_displacement_m: float = fact("control displacement at which the element reaches its drift limit", "m")


class FramePush(ResultModel):
    """One pushover."""

    name: str = fact("direction, pattern and eccentricity")
    direction_deg: float = fact("on the plan", "deg")
    sense: Literal["+", "-"] = fact("sense of the load. +: along the direction; -: against it")
    pattern: str = fact("of the forces")
    eccentricity: float = fact("ratio of the accidental eccentricity to the length of the plan across the direction")
    stop: str = fact("why it ended")
    lost_at: str = maybe("where the frame moves most at the end, if no equilibrium was found")
    control_displacement_m: list[float] = fact("mean displacement, in the sense of the load, of the masses on the control level", "m")
    base_shear_N: list[float] = fact("base shear along the sense", "N")
    peak_base_shear_N: float = fact("greatest base shear", "N")
    displacement_at_peak_m: float = fact("control displacement there", "m")
    drop_displacement_m: float | None = fact(
        "control displacement at which the base shear has decreased by 20 %; null if the curve does not reach it", "m"
    )
    ultimate_displacement_m: float | None = fact(
        "ultimate displacement: the least of the displacement at 20 % decrease, of that at which all piers of one storey of a wall "
        "are at their drift limit, and of the end of a curve without equilibrium beyond a drift limit; null if the curve reaches none",
        "m",
    )
    stiffness_N_m: float | None = fact(
        "secant stiffness at a tenth of the greatest base shear; null if the curve has no displacement up to there", "N/m"
    )
    period_s: float = fact("period of the mode with the greatest participating mass in the direction", "s")
    equivalent_mass_kg: float = fact(
        "m*: sum of the products of the masses and the mode shape, which is 1 at the control displacement", "kg"
    )
    participation_factor: float = fact("Gamma: ratio of m* to the sum of the products of the masses and the squared mode shape")
    level_mass_kg: list[float] = fact("masses on the levels, from the lowest", "kg")
    level_shape: list[float] = fact("mean of the mode shape on each level, in the sense of the load")
    storeys: list[PierLimits] = fact("limit events of the piers, for each storey of each wall")
    failed: list[FailedElement] = fact("elements beyond their drift limits, in the order in which they reach them")


class OutOfPlane(ResultModel):
    """The wall of least margin out of its plane, by local-mechanism."""

    factor: float | None = fact("ratio of capacity to demand of the governing check; null without such a check")
    outcome: Outcome = fact("verdict: stands, collapses, open or not-applicable")
    building_period_s: float = fact("period of the frame, from which the floor spectrum is calculated", "s")
    statement: str = fact("verdict in words")


class WallDeflection(ResultModel):
    """A wall out of its plane, with its deflection, under a constant acceleration across its plane."""

    wall: str = fact("its name")
    acceleration_g: float = fact("greatest constant acceleration that the wall carries; 0: no equilibrium under the weight", "g")
    deflection_m: float = fact("greatest deflection at this acceleration", "m")
    height_m: float = fact("height of the greatest deflection above the ground", "m")
    reached: bool = fact("whether the acceleration decreases with further deflection; if not, it is a lower bound")
    rigid_acceleration_g: float | None = fact(
        "collapse multiplier of its weakest rigid part above a storey, by local-mechanism without confidence factor, with the same position of "
        "the hinge; null if floors hold the wall, or with a warning",
        "g",
    )
    held_at_m: list[float] = fact("heights at which rigid floors and props hold the wall", "m")


class FramePushover(KindResults):
    """frame-pushover: a building as a frame of macro-elements under growing horizontal forces."""

    runs: list[FramePush] = fact("all pushovers")
    governing: str = fact("name of the run with the least base shear")
    base_shear_N: float = fact("its greatest base shear", "N")
    ultimate_displacement_m: float | None = fact("ultimate displacement of the governing run; null if not reached", "m")
    failed: list[FailedElement] = fact("elements beyond their drift limits in the governing run, in order")
    weight_N: float = fact("weight of walls and floors", "N")
    moving_mass_kg: float = fact("masses on the levels above the ground, as moved by the modes", "kg")
    control_level: int = fact("storey whose top has the control displacement")
    control_height_m: float = fact("height of the control level", "m")
    piers: int = fact("piers")
    spandrels: int = fact("spandrels")
    walls: list[str] = fact("names of the walls in the order of their numbers in the arrays")
    remarks: list[str] = fact("parts of the building that the frame model neglects")
    ring_beam_moment_Nm: float = maybe("greatest moment of the elastic ring beams up to the peaks of all runs", "N*m")
    out_of_plane: OutOfPlane = maybe("check of the walls out of their planes; only with a seismic action")
    walls_out_of_plane: list[WallDeflection] = maybe(
        "walls out of their planes with their deflection, cracking and crushing, under a constant acceleration, the weakest first"
    )
    verification: Verification = maybe("displacement-based verification: all runs at the limit states of the code")

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
            return f"Out of its plane wall '{wall.wall}' has no equilibrium under its weight."
        least, before = "" if wall.reached else "at least ", ""
        if self.wall_below_frame:
            then = "the wall fails first" if wall.reached else "which of the two fails first is not known"
            before = f" This is less than the base shear of the frame over the weight, {self.base_shear_N / self.weight_N:.3g}: {then}."
        return (
            f"Out of its plane wall '{wall.wall}' carries {least}a constant acceleration of {wall.acceleration_g:.3g} g, with a deflection of "
            f"{1e3 * wall.deflection_m:.3g} mm at a height of {wall.height_m:.3g} m, without the transverse walls.{before}"
        )

    def judged(self, demand: Demand) -> Verdict:
        """The verification by displacement; without one the least base shear, without an outcome."""
        lost = [row.name for row in self.runs if row.stop.startswith("no equilibrium") and row.drop_displacement_m is None]
        text = f"The frame can carry a base shear of {self.base_shear_N / 1e3:.3g} kN ({self.governing})."
        if self.ring_beam_moment_Nm is not None:
            text += f" Greatest moment of the ring beams, which remain elastic: {self.ring_beam_moment_Nm / 1e3:.3g} kN m."
        if self.wall_below_frame:
            text += f" {self.weakest_wall()}"
        if self.out_of_plane is not None and self.out_of_plane.outcome in ("collapses", "cannot-stand"):
            factor = "" if self.out_of_plane.factor is None else f" (safety factor {self.out_of_plane.factor:.3g})"
            text += f" A wall does not satisfy the check of out-of-plane failure{factor}. {self.out_of_plane.statement}"
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
    exceeded: int = fact("number of runs that exceed the limit state; for pushovers the motions are not scaled")
    share: float = fact("share of the runs that have a result")
    share_interval: list[float] = fact("interval of that share (Wilson)")
    median_g: float | None = fact("median of the lognormal fragility curve; null if the runs do not determine a curve", "g")
    dispersion: float | None = fact("its logarithmic standard deviation")
    median_interval_g: list[float] | None = fact("confidence interval of the median; null if not known", "g")
    probability: list[float | None] = maybe("share of the motions that exceed the limit state, at each level of intensity")


class FrameFragility(KindResults):
    """frame-fragility: probability that a building exceeds its limit states, over motions and uncertain values."""

    method: Literal["history", "pushover"] = fact("history, or pushover with N2")
    intensity: str = fact("measure of the motions")
    motions: int = fact("motions")
    limit_states: list[FrameLimitCurve] = fact("fragility curves; the least severe limit state comes first")
    confidence: float = fact("of the intervals")
    uncertain: list[str] = fact("names of the uncertain values")
    histories: int = maybe("for time histories: number of runs with a result")
    buildings: int = maybe("for pushovers: number of sampled buildings")
    levels_g: list[float] = maybe("levels of the intensity", "g")
    drift_16: list[float | None] = maybe(
        "16th percentile of the greatest pier drift, at each level of intensity; null if this percentile is collapse"
    )
    drift_50: list[float | None] = maybe("the median of it")
    drift_84: list[float | None] = maybe(
        "84th percentile of the greatest pier drift, at each level of intensity; null if this percentile is collapse"
    )
    confidence_factor: float = maybe("confidence factor of the code, by the knowledge level")
    design_intensity_g: float = maybe(
        "intensity of the median motion at which the building collapses, if all strengths are divided by the confidence factor", "g"
    )
    weaker_share: float = maybe(
        "share of the sampled buildings that collapse at a lower intensity than that of `code_median_g`, under the same motion"
    )

    def judged(self, demand: Demand) -> Verdict:
        """Probabilities, which decide no limit state without an accepted one."""
        worst = self.limit_states[-1]
        median = f"The median {self.intensity} at collapse is {worst.median_g:.3g} g" if worst.median_g else "No curve of collapse"
        text = f"{median}; {worst.exceeded} runs exceed collapse."
        return judge(text, None, None, "", "not-applicable")


class FrameHistory(KindResults):
    """frame-history: motion of a building as a frame of macro-elements."""

    stop: str = fact("why it ended")
    end_time_s: float = fact("end of the calculation", "s")
    peak_displacement_m: float = fact(
        "greatest displacement, along the direction of the motion, of the control level relative to the ground", "m"
    )
    peak_base_shear_N: float = fact("greatest base shear along the direction of the motion", "N")
    residual_displacement_m: float = fact("at the end", "m")
    peak_drift: float = fact("greatest drift (chord rotation) of a pier")
    peak_drift_element: str = fact("that pier")
    failed: list[FailedElement] = fact("elements beyond their drift limits, in order, with the control displacement at each instant")
    period_s: float = fact(
        "initial period (undamaged frame at rest) of the mode with the greatest participating mass in the direction of the motion", "s"
    )
    damping: list[float] = fact("Rayleigh damping: factor of the mass [1/s] and factor of the last tangent stiffness [s]")
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
