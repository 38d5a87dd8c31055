"""Results of rocking dynamics: rocking, failure-domain, assessment."""

from typing import Literal, get_args

from extrados.results.curves import between, least_beside
from extrados.results.dem import DemRun
from extrados.results.fields import ResultModel, fact, maybe
from extrados.results.verdict import Demand, KindResults, Outcome, Verdict, judge

RockingOutcome = Literal["no-hinging", "recovery", "collapse"]
#: Outcome of a motion that contacts may have gone on with: blocks that only slide do not rock
WholeOutcome = Literal["no-hinging", "slid", "recovery", "collapse"]
#: Numbers of the outcomes in stored arrays, as the core counts them
NO_HINGING, RECOVERY, COLLAPSE = range(len(get_args(RockingOutcome)))
#: Number in maps of blocks that only slide, by rigid contacts; collapse of a second mode takes the one before
SLID = COLLAPSE + 2
Pulse = Literal["step", "sine", "half-sine", "rectangular", "cosine", "ricker"]


class RockingHinge(ResultModel):
    """A hinge about which parts of a mechanism turn."""

    joint: int = fact("number of the joint")
    name: str = fact("name of the joint")
    x_m: float = fact("x of the hinge", "m")
    y_m: float = fact("y of the hinge", "m")


class JointTime(ResultModel):
    """Where and when a condition of rocking first fails."""

    joint: str = fact("name of the joint; empty if the whole resting structure slides")
    time_s: float = fact("first time at which the condition fails", "s")


class Conditions(ResultModel):
    """Conditions of rocking by fixed hinges, checked along the motion up to the critical rotation: joints do not slide, and the
    thrust line stays within them."""

    friction: float | None = maybe("least coefficient of friction of the joints; null if sliding is excluded")
    required_friction: float | None = maybe(
        "greatest coefficient of friction that a joint requires during rocking; null if a joint is in tension"
    )
    slides_first: JointTime = maybe("for one run: joint and time at which friction first becomes insufficient")
    leaves_first: JointTime = maybe(
        "for one run: joint and time at which the thrust line is first outside a joint by more than 1 % of its length"
    )
    thrust_line_outside: float | None = maybe(
        "for one run: greatest distance of the thrust line beyond the end of a joint, divided by the "
        "length of the joint; negative if the line stays inside; null if a joint is in tension"
    )
    sliding: int = maybe("for many runs: number of runs in which blocks slide")
    sliding_share: float = maybe("for many runs: share of the runs in which blocks slide")
    hinges_elsewhere: int = maybe("for many runs: number of runs in which hinges form outside the rocking mechanism")
    hinges_elsewhere_share: float = maybe("for many runs: share of the runs in which hinges form outside the rocking mechanism")
    energy_astray: float = maybe(
        "after a plastic impact at all joints: share of the kinetic energy that does not belong to the mechanism in which rocking "
        "continues. If this share exceeds 0.2, impacts cause hinges outside the mechanism",
        source="Moreau 1988",
    )
    not_checked: str = fact("conditions that are not checked, with the reason; empty if all are checked")
    violated: list[str] = fact("violated conditions, one sentence each")


class RuleOutcome(ResultModel):
    """What the motion does under an impact rule."""

    rule: str = fact("impact rule: a value of [joints] `restitution`, or a higher coefficient of restitution that is tried in addition")
    restitution: float = fact(
        "coefficient of restitution (angular velocity after / before impact), limited to values from 0 "
        "to 1; for a mechanism, at the impact that starts rocking towards +x"
    )
    outcome: WholeOutcome = fact("outcome: no rocking, sliding alone, rocking and recovery, or collapse")


class RestraintForces(ResultModel):
    """A tie, damper or added hinge while the structure rocks."""

    name: str = fact("name in the deck")
    least_force_N: float = maybe("least force of a tie or damper; tension is positive", "N")
    greatest_force_N: float = maybe("greatest force of a tie or damper; tension is positive", "N")
    permanent_elongation_m: float = maybe("permanent elongation of a tie or damper at the end of the run, by yield or slip", "m")
    least_moment_Nm: float = maybe(
        "least moment of an added hinge; positive for counter-clockwise rotation of the first of the two blocks at the joint", "N*m"
    )
    greatest_moment_Nm: float = maybe(
        "greatest moment of an added hinge; positive for counter-clockwise rotation of the first of the two blocks at the joint", "N*m"
    )
    permanent_turn_rad: float = maybe("permanent rotation of an added hinge at the end of the run, by yield", "rad")


class ModeShare(ResultModel):
    """How long two stacked blocks rock in a mode."""

    mode: str = fact("mode: contacts that are open, and the side to which they open", source="Psycharis 1990")
    share: float = fact("share of the rocking time")


class StackRocking(ResultModel):
    """What two stacked blocks have besides the rotation of the lower one."""

    peak_rotation_upper_rad: float = fact("greatest rotation of the upper block; positive towards +x", "rad")
    critical_rotation_upper_rad: float = fact("slenderness angle of the upper block alone", "rad")
    uplift_as_one_g: float = fact("horizontal acceleration at which both blocks begin to rock together, as one body", "g")
    uplift_upper_g: float = fact("horizontal acceleration at which the upper block begins to rock alone", "g")
    impacts_on_ground: int = fact("number of impacts on the ground")
    impacts_between: int = fact("number of impacts at the joint between the two blocks")
    modes: list[ModeShare] = fact("share of the rocking time spent in each mode")


class SoftBaseRocking(ResultModel):
    """What a block on a compliant base has besides its rotation."""

    foundation: Literal["winkler", "two-spring"] = fact(
        "model of the base. winkler: springs along the whole base; two-spring: springs at its two edges"
    )
    rocking_period_s: float = fact("natural period of small rocking vibrations with the whole base in contact, without damping", "s")
    vertical_period_s: float = fact("natural period of the vertical vibration, without damping", "s")
    sinking_at_rest_m: float = fact("settlement of the base under self-weight, below the centre of mass", "m")
    lift_rotation_rad: float = fact("rotation at which an edge lifts off under static load", "rad")
    capacity_g: float = fact("collapse acceleration (horizontal, constant) of the block on this base; lesser value of both directions", "g")
    peak_sinking_m: float = fact("greatest settlement; of either sign", "m")
    greatest_pressure_Pa: float = maybe("for a Winkler base: greatest pressure, at an edge", "Pa")
    greatest_edge_force_N: float = maybe("for springs at the edges: greatest force of a spring", "N")
    lifted_share: float = fact("share of the time during which part of the base is lifted")
    free_share: float = fact("share of the time during which the whole base is lifted")
    energy_taken_up_J: float = fact("energy dissipated by the dashpots of the base", "J")
    rigid_outcome: RockingOutcome | None = fact("outcome on a rigid base with Housner's impact rule, for comparison; null without a result")
    rigid_peak_rotation_rad: float | None = fact("greatest rotation on a rigid base, for comparison; null without a result", "rad")


class HandOver(ResultModel):
    """The rest of the motion on rigid contacts, from the state in which a condition of the mechanism fails."""

    time_s: float = fact(
        "time at which the run with rigid contacts begins, just before a condition is violated. This run "
        "starts from the positions and velocities of the blocks at this time",
        "s",
    )
    reason: str = fact("condition that fails, with its place")
    outcome: WholeOutcome = fact("outcome of the whole motion")
    fixed_hinges_outcome: RockingOutcome = fact("outcome that the analysis with fixed hinges and without sliding would give")
    contacts: DemRun = fact("run of the blocks with rigid contacts; its times are those of the motion", source="Moreau 1988")


class Rocking(KindResults):
    """rocking: the response of the single-degree-of-freedom mechanism to a motion."""

    rotation_of: str = fact("body whose rotation is given")
    outcome: WholeOutcome = fact(
        "outcome: no rocking, sliding only, rocking and recovery, or collapse. If the run was continued "
        "with rigid contacts, this is the outcome of the continued run"
    )
    settled: bool = fact("whether the structure came to rest, or collapsed, before the run ended; if false, the outcome is open")
    collapse_half_cycle: int | None = fact("half cycle of the collapse")
    collapse_time_s: float | None = fact("time after which the structure can no longer recover", "s")
    half_cycles: int = fact("number of half cycles of rocking")
    impacts: int = fact("number of impacts")
    impact_times_s: list[float] = fact("times of the impacts", "s")
    peak_rotation_rad: float = fact("greatest rotation, positive to +x", "rad")
    peak_rotation_ratio: float = fact("greatest rotation, divided by the critical rotation (beyond it, gravity causes collapse)")
    peak_ground_acceleration_g: float = fact("greatest horizontal acceleration of the motion", "g")
    energy_supplied_J: float = fact("work of the ground", "J")
    energy_lost_at_impacts_J: float = fact("energy lost at impacts", "J")
    energy_taken_up_J: float = maybe("energy dissipated by dampers and yielding restraints", "J")
    restraints: list[RestraintForces] = maybe("restraints besides self-weight")
    rebound: float = maybe(
        "rocking against a wall: ratio of angular velocity after / before the rebound, from the deck or from three impacts"
    )
    energy_residual_ratio: float = fact(
        "greatest error of the energy balance, divided by the greatest mechanical energy or by the work of the ground, "
        "whichever is greater. On a compliant base, the range of the mechanical energy replaces its greatest value"
    )
    steps: int = fact("number of time steps of the integrator")
    rejected_steps: int = fact("number of rejected time steps")
    restitution: float | None = fact(
        "coefficient of restitution: angular velocity after / before an impact; for blocks and mechanisms, the impact "
        "that starts rocking towards +x; null on a compliant base"
    )
    restitution_to_left: float = maybe(
        "for a block or a mechanism: coefficient of restitution at the impact that starts rocking towards -x"
    )
    energy_ratio: float = maybe("for a block: ratio of kinetic energy after / before an impact", source="thesis Eq. 6.2")
    critical_rotation_rad: float = fact("critical rotation towards +x, beyond which gravity overturns the structure", "rad")
    critical_rotation_left_rad: float = maybe("for a block or a mechanism: critical rotation towards -x", "rad")
    frequency_parameter_rad_s: float = maybe("for a block or a frame: frequency parameter p", "rad/s", source="Housner 1963")
    uplift_acceleration_g: float = fact("constant horizontal acceleration at which rocking starts", "g")
    required_friction: float | None = fact("greatest coefficient of friction that a joint requires; null if a joint is in tension")
    hinges: list[RockingHinge] = maybe("for a mechanism: its hinges when it rocks towards +x")
    hinges_opposite: list[RockingHinge] = maybe("for a mechanism: its hinges when it rocks towards -x")
    restitution_thesis: float = maybe(
        'for an arch: coefficient of restitution by the impact rule "thesis" (momentum balance)', source="thesis Eq. 5.3"
    )
    restitution_energy_safe: float = maybe("for an arch: coefficient of restitution by the energy-safe projection")
    restitution_inelastic: float = maybe("for an arch: coefficient of restitution by a plastic impact at all joints", source="Moreau 1988")
    outcomes_by_rule: list[RuleOutcome] = maybe(
        "outcome by each impact rule, given if the coefficients of restitution c_v of the rules differ by a factor of more than 1.3. If "
        "plastic impacts may lose too much energy, the outcome with a higher c_v is added"
    )
    decided_by_last_digits: bool = fact(
        "whether the response is chaotic: a perturbation of the motion by 1e-6 grows by a factor of more "
        "than 1e4, or a perturbation between 1e-6 and 1e-4 changes the outcome"
    )
    perturbation_growth: float = fact(
        "growth of a perturbation, if the motion is scaled by 1 + 1e-6 or 1 - 1e-6: greatest difference "
        "of the rotations, divided by 1e-6 and by the critical rotation"
    )
    conditions: Conditions = maybe("check of the assumptions: whether joints slide, or hinges form outside the rocking mechanism")
    hand_over: HandOver = maybe(
        "given if joints slide or hinges form outside the rocking mechanism: rest of the motion, "
        "calculated with rigid contacts. All other results of the mechanism end at `hand_over.time_s`"
    )
    violated: list[str] = fact("other violated assumptions, one sentence each (chaotic response, impact rules)")
    stack: StackRocking = maybe("results of two stacked blocks")
    soft_base: SoftBaseRocking = maybe("results of a compliant base ([supports] stiffness)")
    thrust_line_residual_m: float = maybe(
        "for an arch: greatest distance between the thrust line and the last hinge, through which the line should pass", "m"
    )

    def judged(self, demand: Demand) -> Verdict:
        """The greatest rotation against the critical one; open where the run ended before it settled. Where rigid contacts went
        on, they decide."""
        if self.hand_over is not None:
            found = self.hand_over.contacts.judged(demand)
            return found.model_copy(update={"statement": f"{self.hand_over.reason} {found.statement}"})
        outcome: Outcome = "collapses" if self.outcome == "collapse" else "stands" if self.settled else "open"
        text = {
            "collapses": "Collapse under the motion",
            "stands": (
                f"No collapse under the motion. The greatest rotation is {100.0 * self.peak_rotation_ratio:.3g} % of the critical rotation"
            ),
            "open": "The run ended before the structure came to rest",
        }[outcome]
        broken = [] if self.conditions is None else self.conditions.violated
        return judge(f"{text}.", self.peak_rotation_ratio, 1.0, "of the critical rotation", outcome, violated=[*broken, *self.violated])


class ModeCurve(ResultModel):
    """Lowest failing amplitudes of a mode of collapse."""

    durations_s: list[float] = fact("durations, or periods, of the pulses", "s")
    amplitudes_g: list[float | None] = fact(
        "lowest amplitude that causes collapse, at each duration; null if it exceeds `max_amplitude`", "g"
    )
    amplitude_ratios: list[float | None] = maybe(
        "for a block: lowest amplitude that causes collapse, divided by the uplift acceleration on a rigid base"
    )


class AtAmplitudes(ResultModel):
    """Shortest failing pulses at given amplitudes."""

    amplitudes_g: list[float] = fact("amplitudes of the pulses", "g")
    mode_I_durations_s: list[float | None] = fact(
        "shortest pulse that causes collapse, with or without an impact; null if no pulse up to the longest of `durations` does", "s"
    )
    mode_II_durations_s: list[float | None] = fact(
        "shortest pulse that causes collapse without an impact; null if no pulse up to the longest of `durations` does", "s"
    )


class RuleCurve(ResultModel):
    """The failure curve by an impact rule."""

    rule: str = fact("impact rule, by its name in [joints] `restitution`")
    restitution: float = fact(
        "coefficient of restitution (angular velocity after / before impact), limited to values from 0 "
        "to 1; for a mechanism, at the impact that starts rocking towards +x"
    )
    amplitudes_g: list[float | None] = fact(
        "lowest amplitude that causes collapse, at each duration; null if it exceeds `max_amplitude`", "g"
    )


class FailureDomain(KindResults):
    """failure-domain: which pulses bring an arch or a block down."""

    sliding_from_g: list[float | None] = fact(
        "lowest amplitude of the map at which blocks slide, at each duration; null if they slide at no amplitude", "g"
    )
    hinges_elsewhere_from_g: list[float | None] = fact(
        "lowest amplitude of the map at which hinges form outside the rocking mechanism, at each "
        "duration; null if this occurs at no amplitude",
        "g",
    )
    conditions: Conditions = fact("whether blocks slide, or hinges form outside the rocking mechanism, over all pulses of the map")
    handed_over: int = maybe(
        "number of pulses of the map that were continued with rigid contacts, because joints slide or hinges form outside the rocking "
        "mechanism. At these pulses, the failure curve is accurate to one cell of the map"
    )
    amplitudes_by_rule: list[RuleCurve] = maybe(
        "failure curve by each impact rule, given if the coefficients of restitution c_v of the rules differ by a factor of more than 1.3"
    )
    rule_ratio: float | None = maybe(
        "greatest ratio of the failure amplitudes by two impact rules at the same duration; null if no "
        "duration has failure amplitudes by two rules"
    )
    pulse: Pulse = fact("shape of the pulses")
    mode_I: ModeCurve = fact("lowest amplitude that causes collapse, with or without an impact, at each duration")
    mode_II: ModeCurve = fact("lowest amplitude that causes collapse in the first half cycle (without an impact), at each duration")
    pocket_begins_g: list[float | None] = fact(
        "amplitude at which the first safe region above the failure curve begins; null if there is no such region", "g"
    )
    uplift_acceleration_g: float = fact("constant horizontal acceleration at which rocking starts", "g")
    restitution: float | None = fact("coefficient of restitution: angular velocity after / before an impact; null on a compliant base")
    natural_time_s: float = fact("time by which the durations are scaled: sqrt(R/g) for an arch, 1/p for a block", "s")
    safe_pockets: int = fact("number of durations at which an amplitude above the lowest one that causes collapse is safe again")
    at_amplitudes: AtAmplitudes = maybe(
        "shortest durations that cause collapse at the amplitudes given in the deck; calculated with fixed hinges and without sliding"
    )
    frequency_ratio: list[float] = maybe("for a block: frequency ratio omega/p of the pulses")
    pocket_begins_ratio: list[float | None] = maybe(
        "for a block: amplitude at which the first safe region begins, divided by the uplift acceleration on a rigid base"
    )
    mode_names: str = maybe("for a block: meaning of mode_I and mode_II, and their numbers in Zhang and Makris (2001)")

    def _violated(self, duration: float, amplitude: float) -> list[str]:
        """What does not hold of the assumptions for a pulse [s, g]: conditions at the neighbouring durations of the map, and impact
        rules between whose curves it lies."""
        places: list[float] = self.mode_I.durations_s
        found: list[str] = []
        slides = least_beside(places, self.sliding_from_g, duration)
        decided = self.handed_over is not None and not self.conditions.violated  # rigid contacts decided all of these
        if slides is not None and amplitude >= slides and not decided:
            found.append(
                f"For pulses of {duration:.3g} s, blocks slide from an amplitude of {slides:.3g} g upwards. Use dem, or check the friction."
            )
        elsewhere = least_beside(places, self.hinges_elsewhere_from_g, duration)
        if elsewhere is not None and amplitude >= elsewhere and not decided:
            found.append(
                f"For pulses of {duration:.3g} s, hinges form outside the rocking mechanism from an amplitude of "
                f"{elsewhere:.3g} g upwards. Use dem."
            )
        curves = [(one.rule, between(places, one.amplitudes_g, duration)) for one in self.amplitudes_by_rule or []]
        fails = {rule: capacity is not None and amplitude >= capacity for rule, capacity in curves}
        if len(set(fails.values())) > 1:
            told = ", ".join(f'"{rule}" {"collapses" if one else "stands"}' for rule, one in fails.items())
            found.append(f"The impact rule decides the outcome: {told}.")
        return found

    def judged(self, demand: Demand) -> Verdict:
        """A motion that is such a pulse [g] against the curve between its durations; without one the lowest failing
        amplitude of all is told."""
        durations, curve = self.mode_I.durations_s, self.mode_I.amplitudes_g
        if demand.pulse == self.pulse:
            duration, amplitude = demand.duration_s, demand.amplitude_g
            capacity = between(durations, curve, duration)
            if capacity is not None:
                word = "stays below" if amplitude < capacity else "reaches"
                return judge(
                    f"The motion ({amplitude:.3g} g for {duration:.3g} s) {word} the failure curve, which gives {capacity:.3g} g "
                    "at this duration.",
                    amplitude,
                    capacity,
                    "g",
                    violated=self._violated(duration, amplitude),
                )
        least = min((a for a in curve if a is not None), default=None)
        text = (
            "None of the calculated pulses causes collapse."
            if least is None
            else f"Among the {self.pulse} pulses that were run, the lowest amplitude that causes collapse is {least:.3g} g."
        )
        return judge(text, None, least, "g", violated=self.conditions.violated)


class MotionImpulse(ResultModel):
    """The primary impulse of one of the motions."""

    name: str = fact("the motion")
    amplitude_g: float = fact("amplitude of the sine, with its sign", "g")
    period_s: float = fact("period of the sine", "s")
    start_s: float = fact("time at which the sine starts", "s")
    goodness_of_fit: float = fact(
        "goodness of fit: share of the integral of the squared acceleration, over the duration of the sine, that the sine explains"
    )
    peak_ground_acceleration_g: float = fact("greatest horizontal acceleration of the motion", "g")


class CurveFit(ResultModel):
    """A failure curve as A_p/g = C1 (T_p/sqrt(R) - T_min)^C2 + gamma (thesis Eqs 5.5 and 5.8)."""

    c1: float = fact("coefficient C1 of the fit (A_p in g, T_p in s, R in m)")
    c2: float = fact("exponent C2")
    t_min_s: float = fact("period T_min below which no sine causes collapse", "s")
    gamma_g: float = fact("asymptote of the curve: acceleration at which rocking starts", "g")
    greatest_misfit: float | None = fact(
        "greatest relative difference between fitted and calculated amplitude, for amplitudes from 1.03 "
        "to 2.3 times gamma; null if no point lies in this range"
    )


class FailureCurve(ResultModel):
    """The failure curve of one structure, and what the motions do to it."""

    label: str = fact("difference from the other curves")
    durations_s: list[float] = fact("durations, or periods, of the pulses", "s")
    amplitudes_g: list[float | None] = fact("lowest amplitude that causes collapse; null if it exceeds `max_amplitude`", "g")
    uplift_acceleration_g: float = fact("constant horizontal acceleration at which rocking starts", "g")
    restitution: float | None = fact("coefficient of restitution: angular velocity after / before an impact; null on a compliant base")
    natural_time_s: float = fact("time by which the durations are scaled: sqrt(R/g) for an arch, 1/p for a block", "s")
    cycles: int = fact("number of cycles of a train of sines; 1 for all other pulses")
    static_verdicts: list[Literal["stands", "fails"]] = fact(
        "for each motion: verdict of the peak acceleration, compared with the uplift acceleration"
    )
    curve_verdicts: list[Literal["stands", "fails"] | None] = fact(
        "for each motion: verdict of the primary impulse, compared with the failure curve; "
        "null if the period of the impulse is outside the curve"
    )
    run_outcomes: list[RockingOutcome | None] = fact("for each motion: outcome of the whole motion; null without a result")
    sliding_from_g: list[float | None] = fact(
        "lowest tried amplitude (up to the failure curve) at which blocks slide, at each duration; null if they slide at none", "g"
    )
    hinges_elsewhere_from_g: list[float | None] = fact(
        "lowest tried amplitude (up to the failure curve) at which hinges form outside the rocking "
        "mechanism, at each duration; null if this occurs at none",
        "g",
    )
    conditions: Conditions = fact(
        "number of durations at which blocks slide, or hinges form outside the rocking mechanism, at an amplitude up to the failure curve"
    )
    amplitudes_by_rule: list[RuleCurve] = maybe(
        "failure curve by each impact rule, given if the coefficients of restitution c_v of the rules differ by a factor of more than 1.3"
    )
    rule_ratio: float | None = maybe(
        "greatest ratio of the failure amplitudes by two impact rules at the same duration; null if no "
        "duration has failure amplitudes by two rules"
    )
    fit: CurveFit = maybe("Eq. 5.5 of the thesis fitted to this curve (not scaled by the radius); not given for fewer than four points")
    criterion: CurveFit = maybe(
        "Eq. 5.8 of the thesis with interpolated coefficients of its Table 5.3; not given outside the range of the table"
    )


class FailureCurves(KindResults):
    """failure-curves: several structures or trains of sines beside each other, and the primary impulses of the motions."""

    pulse: Pulse = fact("shape of the pulses")
    curves: list[FailureCurve] = fact("failure curves, one for each variant and number of cycles")
    impulses: list[MotionImpulse] = fact("primary impulses of the motions in the deck; empty without a motion")
    agreement: float | None = fact(
        "share of the verdicts of the curves that agree with the outcome of the run under the whole motion; null without a comparison"
    )
    scaling_misfit: float | None = fact(
        "greatest relative difference of amplitude between two curves, with durations divided by the natural time and amplitudes by the "
        "uplift acceleration; null with one curve, or with curves for different trains",
        source="thesis Eq. 5.7",
    )

    def judged(self, demand: Demand) -> Verdict:
        """The weakest of the structures; a motion that is a sine is no demand here, as it has a curve for each."""
        lowest = [(min(failing), c.label) for c in self.curves if (failing := [a for a in c.amplitudes_g if a is not None])]
        if not lowest:
            every = [f"{c.label}: {text}" for c in self.curves for text in c.conditions.violated]
            return judge("None of the calculated pulses causes collapse of any variant.", None, None, "g", violated=every)
        least, label = min(lowest)
        violated = next(c.conditions.violated for c in self.curves if c.label == label)
        return judge(
            f"Among the {len(self.curves)} curves, the curve of {label} has the lowest amplitude: {least:.3g} g.",
            None,
            least,
            "g",
            violated=violated,
        )


class Coefficients(ResultModel):
    """A failure curve A_p/g = C1 (T_p/sqrt(R) - T_min)^C2 + gamma, T_p in s, R in m."""

    C1: float = fact("factor C1", source="thesis Eq. 5.8")
    C2: float = fact("exponent C2", source="thesis Eq. 5.8")
    T_min_s: float = fact("period below which no sine causes collapse, for R = 1 m", "s", source="thesis Eq. 5.8")
    gamma: float = fact("asymptote: amplitude (in g) at which long impulses cause collapse", source="thesis Eq. 5.8")


class PrimaryImpulse(ResultModel):
    """The single sine that explains most of a motion."""

    amplitude_g: float = fact("amplitude, with its sign", "g")
    period_s: float = fact("period", "s")
    start_s: float = fact("time at which the sine starts", "s")
    goodness_of_fit: float = fact(
        "goodness of fit: share of the integral of the squared acceleration, over the duration of the sine, that the sine explains"
    )


class AssessedImpulse(PrimaryImpulse):
    """An impulse of the motion against the failure curve."""

    rank: int = fact("1 for the primary impulse")
    explained: float = fact("share of the integral of the squared acceleration of the motion that this impulse explains")
    failing_amplitude_g: float | None = fact(
        "amplitude that causes collapse at the period of the impulse; null if the period is too short to cause collapse", "g"
    )
    failing_amplitude_own_g: float | None = fact("amplitude that causes collapse, from the curve fitted to this structure", "g")
    margin: float | None = fact(
        "safety factor: failure amplitude divided by the amplitude of the impulse; null if the period is too short to cause collapse"
    )
    verdict: Literal["stands", "fails"] = fact("verdict of the failure curve on the impulse: stands, or fails (collapse)")


class Assessment(KindResults):
    """assessment: the primary impulses of a motion against the failure curve of the structure."""

    uplift_acceleration_g: float = fact("constant horizontal acceleration at which rocking starts", "g")
    peak_ground_acceleration_g: float = fact("greatest horizontal acceleration of the motion", "g")
    static_verdict: Literal["stands", "fails"] = fact("outcome if the peak acceleration acts as a constant horizontal acceleration")
    coefficients: Coefficients = fact("coefficients of the failure curve with which the impulses are compared")
    coefficients_source: str = fact("source of the impulse")
    coefficients_of_this_arch: Coefficients = fact("coefficients of the failure curve fitted to this structure")
    restitution: float | None = fact("coefficient of restitution: angular velocity after / before an impact; null on a compliant base")
    impulses: list[AssessedImpulse] = fact("strongest impulses of the motion, each compared with the failure curve")
    verdict: Literal["stands", "fails"] = fact("verdict of the failure curve on the impulses of the motion: stands, or fails (collapse)")
    run_outcome: RockingOutcome | None = fact("outcome under the whole motion, from the equation of motion")
    margin: float | None = fact(
        "lowest safety factor of all impulses (failure amplitude divided by amplitude); null if no impulse can cause collapse"
    )
    conditions: Conditions = fact("whether blocks slide, or hinges form outside the rocking mechanism, under the whole motion")
    margins_by_rule: dict[str, float | None] = maybe(
        "safety factor by each impact rule (each with its own fitted curve), given if the coefficients of restitution c_v of the rules "
        "differ by a factor of more than 1.3; null if no impulse can cause collapse"
    )
    margin_conditions: list[str] = fact(
        "assumptions that hold under the motion, but fail under the motion times the safety factor (one sentence each). The safety "
        "factor is valid only under these assumptions"
    )
    violated: list[str] = fact("other violated assumptions, one sentence each")
    primary_impulse: PrimaryImpulse | None = fact("strongest impulse of the motion; null if the motion has none")

    def judged(self, demand: Demand) -> Verdict:
        """The impulse of the least margin against its failing amplitude [g]."""
        harmful = [
            (i.margin, i.failing_amplitude_g, i) for i in self.impulses if i.margin is not None and i.failing_amplitude_g is not None
        ]
        if not harmful:
            text = "No single impulse of the motion is long enough to cause collapse."
            if self.static_verdict == "fails":
                text += " The motion exceeds the acceleration at which rocking starts, and the criterion does not include trains of pulses."
            outcome: Outcome = "stands" if self.static_verdict == "stands" else "open"
            violated = [*self.conditions.violated, *self.violated]
            return judge(text, None, None, "g", outcome, violated=violated)
        _, failing, worst = min(harmful, key=lambda row: row[0])
        size = abs(worst.amplitude_g)
        word = "below" if size < failing else "at or above"
        conditional = "".join(f" {one}" for one in self.margin_conditions)
        return judge(
            f"The impulse of the motion ({size:.3g} g, period {worst.period_s:.3g} s) is {word} the failure amplitude of "
            f"{failing:.3g} g.{conditional}",
            size,
            failing,
            "g",
            violated=[*self.conditions.violated, *self.violated],
        )
