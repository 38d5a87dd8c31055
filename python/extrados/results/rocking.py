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

    joint: str = fact("name of the joint; empty where the resting structure slides")
    time_s: float = fact("first time", "s")


class Conditions(ResultModel):
    """Conditions of rocking by fixed hinges, checked along the motion up to the critical rotation: joints do not slide, and the
    thrust line stays within them."""

    friction: float | None = maybe("least coefficient of friction of the joints; null excludes sliding")
    required_friction: float | None = maybe(
        "greatest coefficient of friction that the joints need while it rocks; null where a joint comes under tension"
    )
    slides_first: JointTime = maybe("of one run: place and time at which joints first lack friction")
    leaves_first: JointTime = maybe("of one run: place and time at which the thrust line first leaves a joint by more than 1 % of it")
    thrust_line_outside: float | None = maybe(
        "of one run: how far the thrust line leaves a joint, over its length; below 0 inside; null under tension"
    )
    sliding: int = maybe("of many runs: those in which blocks slide")
    sliding_share: float = maybe("of many runs: share in which blocks slide")
    hinges_elsewhere: int = maybe("of many runs: those in which hinges form elsewhere")
    hinges_elsewhere_share: float = maybe("of many runs: share in which hinges form elsewhere")
    energy_astray: float = maybe(
        "share of the kinetic energy after an impact without rebound at all joints that lies outside the mechanism that rocks on; "
        "above 0.2 hinges form elsewhere at impacts",
        source="Moreau 1988",
    )
    not_checked: str = fact("conditions that are not checked, and why; empty where all are")
    violated: list[str] = fact("conditions that do not hold, a sentence each")


class RuleOutcome(ResultModel):
    """What the motion does under an impact rule."""

    rule: str = fact("word of [joints] restitution, or a number that discrete elements may keep")
    restitution: float = fact("rate after over before an impact, held between 0 and 1; of a mechanism to +x")
    outcome: WholeOutcome = fact("no rocking, sliding alone, rocking and recovery, or collapse")


class RestraintForces(ResultModel):
    """A tie, damper or added hinge while the structure rocks."""

    name: str = fact("as the deck calls it")
    least_force_N: float = maybe("least force, tension positive; of a tie or damper", "N")
    greatest_force_N: float = maybe("greatest force, tension positive; of a tie or damper", "N")
    permanent_elongation_m: float = maybe("residual yield or slip at the end; of a tie or damper", "m")
    least_moment_Nm: float = maybe("least moment, counter-clockwise rotation of the first block positive; of an added hinge", "N*m")
    greatest_moment_Nm: float = maybe("greatest moment; of an added hinge", "N*m")
    permanent_turn_rad: float = maybe("residual yield at the end; of an added hinge", "rad")


class ModeShare(ResultModel):
    """How long two stacked blocks rock in a mode."""

    mode: str = fact("which contacts are open, and how", source="Psycharis 1990")
    share: float = fact("share of the rocking time")


class StackRocking(ResultModel):
    """What two stacked blocks have besides the rotation of the lower one."""

    peak_rotation_upper_rad: float = fact("greatest rotation of the upper block, positive to +x", "rad")
    critical_rotation_upper_rad: float = fact("slenderness angle of the upper block by itself", "rad")
    uplift_as_one_g: float = fact("horizontal acceleration at which both as one begin to rock", "g")
    uplift_upper_g: float = fact("horizontal acceleration at which the upper block begins to rock alone", "g")
    impacts_on_ground: int = fact("impacts on the ground")
    impacts_between: int = fact("impacts at the joint between")
    modes: list[ModeShare] = fact("share of the rocking time in each mode")


class SoftBaseRocking(ResultModel):
    """What a block on a compliant base has besides its rotation."""

    foundation: Literal["winkler", "two-spring"] = fact("springs all along the base, or under both edges")
    rocking_period_s: float = fact("natural period of small rocking on the whole base, undamped", "s")
    vertical_period_s: float = fact("natural period of its motion up and down, undamped", "s")
    sinking_at_rest_m: float = fact("settlement under its weight, below its centre of mass", "m")
    lift_rotation_rad: float = fact("rotation at which an edge lifts, in equilibrium", "rad")
    capacity_g: float = fact("collapse acceleration (horizontal, constant), partly uplifted", "g")
    peak_sinking_m: float = fact("greatest settlement; of either sign", "m")
    greatest_pressure_Pa: float = maybe("of a Winkler base: greatest pressure at an edge", "Pa")
    greatest_edge_force_N: float = maybe("of springs under the edges: greatest force of one", "N")
    lifted_share: float = fact("share of the time in which part of the base is lifted")
    free_share: float = fact("share of the time in which the base does not press at all")
    energy_taken_up_J: float = fact("energy that the dashpots of the base have taken up", "J")
    rigid_outcome: RockingOutcome | None = fact("outcome on a rigid base, with Housner's impact; null: no result")
    rigid_peak_rotation_rad: float | None = fact("greatest rotation on a rigid base; null: no result", "rad")


class HandOver(ResultModel):
    """The rest of the motion on rigid contacts, from the state in which a condition of the mechanism fails."""

    time_s: float = fact("time at which places and velocities of the blocks were handed over, just before the condition fails", "s")
    reason: str = fact("condition that fails, and where")
    outcome: WholeOutcome = fact("outcome of the whole motion")
    fixed_hinges_outcome: RockingOutcome = fact("outcome that fixed hinges without sliding would have")
    contacts: DemRun = fact("the run of the blocks; its times are those of the motion", source="Moreau 1988")


class Rocking(KindResults):
    """rocking: the response of the single-degree-of-freedom mechanism to a motion."""

    rotation_of: str = fact("body to which the rotation belongs")
    outcome: WholeOutcome = fact("no rocking, sliding alone, rocking and recovery, or collapse; by rigid contacts where these went on")
    settled: bool = fact("whether it came to rest, or down, before the run ended; false leaves the outcome open")
    collapse_half_cycle: int | None = fact("half cycle of the collapse")
    collapse_time_s: float | None = fact("time from which its rotation is past recovery", "s")
    half_cycles: int = fact("half cycles of rocking")
    impacts: int = fact("number of impacts")
    impact_times_s: list[float] = fact("when they happen", "s")
    peak_rotation_rad: float = fact("greatest rotation, positive to +x", "rad")
    peak_rotation_ratio: float = fact("greatest rotation over the critical one, from which gravity causes collapse")
    peak_ground_acceleration_g: float = fact("greatest horizontal acceleration of the motion", "g")
    energy_supplied_J: float = fact("work of the ground", "J")
    energy_lost_at_impacts_J: float = fact("energy lost at impacts", "J")
    energy_taken_up_J: float = maybe("energy dissipated by dampers and yielding restraints", "J")
    restraints: list[RestraintForces] = maybe("restraints besides self-weight")
    rebound: float = maybe("against a wall: rate after over before it is thrown back, as given or by three impacts")
    energy_residual_ratio: float = fact("greatest error of the energy balance over the energy in motion")
    steps: int = fact("steps of the integrator")
    rejected_steps: int = fact("rejected steps")
    restitution: float | None = fact(
        "coefficient of restitution: angular velocity after / before an impact, of blocks and mechanisms the impact that starts rocking "
        "to +x; null on a compliant base"
    )
    restitution_to_left: float = maybe("of a block or a mechanism: coefficient of the impact that starts rocking to -x")
    energy_ratio: float = maybe("of a block: kinetic energy after over before an impact", source="thesis Eq. 6.2")
    critical_rotation_rad: float = fact("critical rotation to +x, beyond which self-weight overturns it", "rad")
    critical_rotation_left_rad: float = maybe("of a block or a mechanism: the critical rotation to -x", "rad")
    frequency_parameter_rad_s: float = maybe("of a block or a frame: p", "rad/s", source="Housner 1963")
    uplift_acceleration_g: float = fact("constant horizontal acceleration at which rocking starts", "g")
    required_friction: float | None = fact("greatest coefficient of friction needed; null where a joint comes under tension")
    hinges: list[RockingHinge] = maybe("of a mechanism: hinges, rocking to +x")
    hinges_opposite: list[RockingHinge] = maybe("of a mechanism: hinges, rocking to -x")
    restitution_thesis: float = maybe("of an arch: by the momentum balance of the thesis", source="thesis Eq. 5.3")
    restitution_energy_safe: float = maybe("of an arch: by the energy-safe projection")
    restitution_inelastic: float = maybe("of an arch: by a plastic impact at all joints", source="Moreau 1988")
    outcomes_by_rule: list[RuleOutcome] = maybe(
        "under each impact rule, where their c_v differ by more than 1.3, and by the energy that discrete elements keep where the plastic impact is unsafe"
    )
    decided_by_last_digits: bool = fact(
        "whether the response is chaotic: a perturbation of the motion by 1e-6 grows beyond 1e4, or one of 1e-6 to 1e-4 ends in another outcome"
    )
    perturbation_growth: float = fact(
        "greatest separation of histories, over the critical rotation, under a motion scaled by 1 +- 1e-6, over that perturbation"
    )
    conditions: Conditions = maybe("whether joints slide or hinges form elsewhere")
    hand_over: HandOver = maybe(
        "where joints slide or hinges form elsewhere: the rest of the motion on rigid contacts; all other results of the mechanism end there"
    )
    violated: list[str] = fact("further assumptions that were checked and do not hold: chaos, impact rules, a sentence each")
    stack: StackRocking = maybe("of two stacked blocks")
    soft_base: SoftBaseRocking = maybe("on a compliant base ([supports] stiffness)")
    thrust_line_residual_m: float = maybe("of an arch: greatest error of the closing thrust line", "m")

    def judged(self, demand: Demand) -> Verdict:
        """The greatest rotation against the critical one; open where the run ended before it settled. Where rigid contacts went
        on, they decide."""
        if self.hand_over is not None:
            found = self.hand_over.contacts.judged(demand)
            return found.model_copy(update={"statement": f"{self.hand_over.reason} {found.statement}"})
        outcome: Outcome = "collapses" if self.outcome == "collapse" else "stands" if self.settled else "open"
        text = {
            "collapses": "Collapse under the motion",
            "stands": f"No collapse under the motion: the greatest rotation is {100.0 * self.peak_rotation_ratio:.3g} % of the critical "
            "rotation",
            "open": "The run ended before the structure came to rest",
        }[outcome]
        broken = [] if self.conditions is None else self.conditions.violated
        return judge(f"{text}.", self.peak_rotation_ratio, 1.0, "", outcome, violated=[*broken, *self.violated])


class ModeCurve(ResultModel):
    """Lowest failing amplitudes of a mode of collapse."""

    durations_s: list[float] = fact("durations or periods of the pulses", "s")
    amplitudes_g: list[float | None] = fact("lowest failing amplitude at each; null if above the cap", "g")
    amplitude_ratios: list[float | None] = maybe("of a block: failing amplitudes over the uplift acceleration, that on rigid ground")


class AtAmplitudes(ResultModel):
    """Shortest failing pulses at given amplitudes."""

    amplitudes_g: list[float] = fact("amplitudes of the pulses", "g")
    mode_I_durations_s: list[float | None] = fact(
        "shortest pulse that causes collapse in either mode; null: no pulse up to the longest of `durations`", "s"
    )
    mode_II_durations_s: list[float | None] = fact(
        "shortest pulse that causes collapse without an impact; null: no pulse up to the longest of `durations`", "s"
    )


class RuleCurve(ResultModel):
    """The failure curve by an impact rule."""

    rule: str = fact("word of [joints] restitution")
    restitution: float = fact("rate after over before an impact, held between 0 and 1; of a mechanism to +x")
    amplitudes_g: list[float | None] = fact("lowest failing amplitude at each duration; null: none below the cap", "g")


class FailureDomain(KindResults):
    """failure-domain: which pulses bring an arch or a block down."""

    sliding_from_g: list[float | None] = fact("at each duration: lowest amplitude of the map at which blocks slide; null: at none", "g")
    hinges_elsewhere_from_g: list[float | None] = fact(
        "at each duration: lowest amplitude of the map at which hinges form elsewhere; null: at none", "g"
    )
    conditions: Conditions = fact("over the map: whether blocks slide or hinges form elsewhere")
    handed_over: int = maybe(
        "pulses of the map that rigid contacts decided, as joints slide or hinges form elsewhere; a curve is known to a cell of the map there"
    )
    amplitudes_by_rule: list[RuleCurve] = maybe("failure curve by each impact rule, where their c_v differ by more than 1.3")
    rule_ratio: float | None = maybe(
        "ratio of the greatest to the least failure amplitude among the impact rules, the greatest over all durations; "
        "null: no duration has failure amplitudes by two rules"
    )
    pulse: Pulse = fact("shape of the pulses")
    mode_I: ModeCurve = fact("lowest amplitudes that cause collapse, with or without an impact")
    mode_II: ModeCurve = fact("lowest amplitudes that cause collapse in the first half cycle, without an impact")
    pocket_begins_g: list[float | None] = fact("amplitude at which the first safe region above the curve begins; null: none", "g")
    uplift_acceleration_g: float = fact("constant horizontal acceleration at which rocking starts", "g")
    restitution: float | None = fact("coefficient of restitution: angular velocity after / before an impact; null on a compliant base")
    natural_time_s: float = fact("time by which the curves scale: sqrt(R/g) of an arch, 1/p of a block", "s")
    safe_pockets: int = fact("durations with safe amplitudes above a failing one")
    at_amplitudes: AtAmplitudes = maybe(
        "shortest failing durations at the amplitudes that the deck requests, by fixed hinges without sliding"
    )
    frequency_ratio: list[float] = maybe("of a block: omega/p of the pulses")
    pocket_begins_ratio: list[float | None] = maybe("of a block: pocket_begins over the uplift acceleration, that on rigid ground")
    mode_names: str = maybe("of a block: how the modes are called elsewhere")

    def _violated(self, duration: float, amplitude: float) -> list[str]:
        """What does not hold of the assumptions for a pulse [s, g]: conditions at the neighbouring durations of the map, and impact
        rules between whose curves it lies."""
        places: list[float] = self.mode_I.durations_s
        found: list[str] = []
        slides = least_beside(places, self.sliding_from_g, duration)
        decided = self.handed_over is not None and not self.conditions.violated  # rigid contacts decided all of these
        if slides is not None and amplitude >= slides and not decided:
            found.append(f"Blocks slide from {slides:.3g} g on at this duration. Use dem, or check the friction.")
        elsewhere = least_beside(places, self.hinges_elsewhere_from_g, duration)
        if elsewhere is not None and amplitude >= elsewhere and not decided:
            found.append(f"Hinges form elsewhere from {elsewhere:.3g} g on at this duration. Use dem.")
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
                    f"The motion, {amplitude:.3g} g for {duration:.3g} s, {word} the failure curve ({capacity:.3g} g there).",
                    amplitude,
                    capacity,
                    "g",
                    violated=self._violated(duration, amplitude),
                )
        failing = [a for a in curve if a is not None]
        if not failing:
            return judge("None of the calculated pulses causes collapse.", None, None, "g", violated=self.conditions.violated)
        return judge(
            f"Over the {self.pulse} pulses that were run the lowest amplitude that causes collapse is {min(failing):.3g} g.",
            None,
            min(failing),
            "g",
            violated=self.conditions.violated,
        )


class MotionImpulse(ResultModel):
    """The primary impulse of one of the motions."""

    name: str = fact("the motion")
    amplitude_g: float = fact("amplitude of the sine, with its sign", "g")
    period_s: float = fact("its period", "s")
    start_s: float = fact("when it starts", "s")
    goodness_of_fit: float = fact("share of the squared acceleration over its own span that it explains")
    peak_ground_acceleration_g: float = fact("greatest horizontal acceleration of the motion", "g")


class CurveFit(ResultModel):
    """A failure curve as A_p/g = C1 (T_p/sqrt(R) - T_min)^C2 + gamma (thesis Eqs 5.5 and 5.8)."""

    c1: float = fact("coefficient C1 (A_p in g, T_p in s, R in m)")
    c2: float = fact("exponent C2")
    t_min_s: float = fact("period T_min below which no sine causes collapse", "s")
    gamma_g: float = fact("asymptote: acceleration at which rocking starts", "g")
    greatest_misfit: float | None = fact(
        "greatest relative difference of the amplitude from the computed curve, between 1.03 and 2.3 times gamma; null: no point there"
    )


class FailureCurve(ResultModel):
    """The failure curve of one structure, and what the motions do to it."""

    label: str = fact("difference from the other curves")
    durations_s: list[float] = fact("durations or periods of the pulses", "s")
    amplitudes_g: list[float | None] = fact("lowest amplitude that causes collapse; null: none below the cap", "g")
    uplift_acceleration_g: float = fact("constant horizontal acceleration at which rocking starts", "g")
    restitution: float | None = fact("coefficient of restitution: angular velocity after / before an impact; null on a compliant base")
    natural_time_s: float = fact("time by which its curve scales: sqrt(R/g) of an arch, 1/p of a block", "s")
    cycles: int = fact("cycles of a train of sines; 1 for all other pulses")
    static_verdicts: list[Literal["stands", "fails"]] = fact("of each motion: its peak against the uplift acceleration")
    curve_verdicts: list[Literal["stands", "fails"] | None] = fact(
        "of each motion: its primary impulse against the curve; null: its period lies outside the curve"
    )
    run_outcomes: list[RockingOutcome | None] = fact("of each motion: outcome of the whole motion; null: no result")
    sliding_from_g: list[float | None] = fact(
        "at each duration: lowest amplitude tried up to the curve at which blocks slide; null: at none", "g"
    )
    hinges_elsewhere_from_g: list[float | None] = fact(
        "at each duration: lowest amplitude tried up to the curve at which hinges form elsewhere; null: at none", "g"
    )
    conditions: Conditions = fact("over the points of the curve: below how many of them blocks slide or hinges form elsewhere")
    amplitudes_by_rule: list[RuleCurve] = maybe("the curve by each impact rule, where their c_v differ by more than 1.3")
    rule_ratio: float | None = maybe(
        "ratio of the greatest to the least failure amplitude among the impact rules, the greatest over all durations; "
        "null: no duration has failure amplitudes by two rules"
    )
    fit: CurveFit = maybe("Eq. 5.5 fitted to this curve (radius not scaled); omitted with fewer than four points to fit")
    criterion: CurveFit = maybe("Eq. 5.8 with the coefficients of Table 5.3, interpolated; omitted outside the table")


class FailureCurves(KindResults):
    """failure-curves: several structures or trains of sines beside each other, and the primary impulses of the motions."""

    pulse: Pulse = fact("shape of the pulses")
    curves: list[FailureCurve] = fact("one for each variant and number of cycles")
    impulses: list[MotionImpulse] = fact("of the motions of the deck; empty without a motion")
    agreement: float | None = fact("share of verdicts by the curves that the whole motions confirm; null: none to compare")
    scaling_misfit: float | None = fact(
        "greatest relative difference of amplitude between two curves, with durations divided by the natural time and "
        "amplitudes by the uplift acceleration; null: one curve only, or curves of different trains",
        source="thesis Eq. 5.7",
    )

    def judged(self, demand: Demand) -> Verdict:
        """The weakest of the structures; a motion that is a sine is no demand here, as it has a curve for each."""
        lowest = [(min(failing), c.label) for c in self.curves if (failing := [a for a in c.amplitudes_g if a is not None])]
        if not lowest:
            every = [f"{c.label}: {text}" for c in self.curves for text in c.conditions.violated]
            return judge("None of the calculated pulses causes collapse of any of them.", None, None, "g", violated=every)
        least, label = min(lowest)
        violated = next(c.conditions.violated for c in self.curves if c.label == label)
        return judge(
            f"Of the {len(self.curves)} curves that of {label} has the lowest amplitude: {least:.3g} g.",
            None,
            least,
            "g",
            violated=violated,
        )


class Coefficients(ResultModel):
    """A failure curve A_p/g = C1 (T_p/sqrt(R) - T_min)^C2 + gamma, T_p in s, R in m."""

    C1: float = fact("factor C1", source="thesis Eq. 5.8")
    C2: float = fact("exponent C2", source="thesis Eq. 5.8")
    T_min_s: float = fact("period below which nothing fails, for R = 1 m", "s", source="thesis Eq. 5.8")
    gamma: float = fact("amplitude that long impulses need, in g", source="thesis Eq. 5.8")


class PrimaryImpulse(ResultModel):
    """The single sine that explains most of a motion."""

    amplitude_g: float = fact("amplitude, with its sign", "g")
    period_s: float = fact("period", "s")
    start_s: float = fact("when it starts", "s")
    goodness_of_fit: float = fact("share of the squared acceleration over its own span that it explains")


class AssessedImpulse(PrimaryImpulse):
    """An impulse of the motion against the failure curve."""

    rank: int = fact("1 for the primary impulse")
    explained: float = fact("share of the squared acceleration of the whole motion that it explains")
    failing_amplitude_g: float | None = fact("failing amplitude at its period; null: too short to do harm", "g")
    failing_amplitude_own_g: float | None = fact("failing amplitude by the curve fitted to this structure", "g")
    margin: float | None = fact("failing amplitude over its amplitude; null: too short to do harm")
    verdict: Literal["stands", "fails"] = fact("whether it causes collapse by the criterion")


class Assessment(KindResults):
    """assessment: the primary impulses of a motion against the failure curve of the structure."""

    uplift_acceleration_g: float = fact("constant horizontal acceleration at which it starts to rock", "g")
    peak_ground_acceleration_g: float = fact("greatest horizontal acceleration of the motion", "g")
    static_verdict: Literal["stands", "fails"] = fact("outcome of the peak acceleration applied as a constant horizontal acceleration")
    coefficients: Coefficients = fact("the failure curve that is used")
    coefficients_source: str = fact("source of the impulse")
    coefficients_of_this_arch: Coefficients = fact("the failure curve fitted to this structure")
    restitution: float | None = fact("coefficient of restitution: angular velocity after / before an impact; null on a compliant base")
    impulses: list[AssessedImpulse] = fact("the strongest impulses of the motion")
    verdict: Literal["stands", "fails"] = fact("whether one of them causes collapse by the criterion")
    run_outcome: RockingOutcome | None = fact("outcome of the whole motion by the equation of motion")
    margin: float | None = fact("least failing amplitude over amplitude; null if no impulse causes collapse")
    conditions: Conditions = fact("under the whole motion: whether blocks slide or hinges form elsewhere")
    margins_by_rule: dict[str, float | None] = maybe(
        "margin by each impact rule, from a curve fitted by it, where their c_v differ by more than 1.3; null: no impulse can do harm"
    )
    margin_conditions: list[str] = fact(
        "assumptions that hold under the motion and not under the motion times the margin, a sentence each: the margin is conditional on them"
    )
    violated: list[str] = fact("further assumptions that were checked and do not hold, a sentence each")
    primary_impulse: PrimaryImpulse | None = fact("the strongest impulse; null where the motion has none")

    def judged(self, demand: Demand) -> Verdict:
        """The impulse of the least margin against its failing amplitude [g]."""
        harmful = [
            (i.margin, i.failing_amplitude_g, i) for i in self.impulses if i.margin is not None and i.failing_amplitude_g is not None
        ]
        if not harmful:
            text = "No single impulse of the motion is long enough to cause collapse."
            if self.static_verdict == "fails":
                text += " The motion exceeds the acceleration that starts rocking, and the criterion does not cover trains of pulses."
            outcome: Outcome = "stands" if self.static_verdict == "stands" else "open"
            violated = [*self.conditions.violated, *self.violated]
            return judge(text, None, None, "g", outcome, violated=violated)
        _, failing, worst = min(harmful, key=lambda row: row[0])
        size = abs(worst.amplitude_g)
        word = "below" if size < failing else "at or above"
        conditional = "".join(f" {one}" for one in self.margin_conditions)
        return judge(
            f"The motion's impulse of {size:.3g} g over {worst.period_s:.3g} s is {word} the failing amplitude of "
            f"{failing:.3g} g.{conditional}",
            size,
            failing,
            "g",
            violated=[*self.conditions.violated, *self.violated],
        )
