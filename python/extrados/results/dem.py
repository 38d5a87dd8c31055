"""Results of discrete elements: dem (a run or a tilt test), dem-domain, dem-parameters."""

from typing import Literal

from extrados.results.curves import between
from extrados.results.fields import ResultModel, fact, maybe
from extrados.results.limit import NamedHinge
from extrados.results.verdict import Demand, KindResults, Verdict, judge, judge_acceleration
from extrados.schema.quantities import three_figures

#: What a joint does, in the stored array `hinge`: hinged at its first end (intrados) or its second (extrados)
HINGED_FIRST, CLOSED, HINGED_SECOND, APART = -1, 0, 1, 2
#: How a run ends: no joint opens or slides; joints slide and none opens; joints open, and it stands; it collapses
DemOutcome = Literal["at-rest", "slid", "rocked", "collapse"]
#: By what a block that moved farther than the collapse displacement has collapsed, rather than slid
CollapseCriterion = Literal["rotation", "loss of height", "loss of support", "separation"]
#: Slip over the length of a joint up to which the support that is left is not in doubt: half of the lever arm to the end of
#: the joint, and so half of the resistance to overturning, is left then
SLIP_LIMIT = 0.25
INTERVAL = (
    "whether blocks slide before collapse at statically indeterminate joints. If so, the collapse "
    "acceleration depends on the load path, and a lower value may exist"
)
#: What a contact of solids does, in the stored array `state`: CLOSED, open at some corners, APART
ROCKS = 1


class Variation(ResultModel):
    """A run with another damping, stiffness or friction."""

    varied: Literal["damping", "stiffness", "friction"] = fact("value that was varied")
    value: float = fact("factor on damping or stiffness in this run, or coefficient of friction of this run")
    beta_s: float = fact("stiffness-proportional damping", "s")
    stiffness_Pa_per_m: float = fact("greatest normal stiffness of the joints", "Pa/m")
    friction: float = fact("greatest coefficient of friction of the joints")
    damping_ratio_rotation: float = fact(
        "damping ratio (fraction of critical damping) at rotational impact; least value of all joints", source="thesis Eq. 7.13"
    )
    damping_ratio_edge: float = fact(
        "damping ratio (fraction of critical damping) at edge impact; least value of all joints", source="thesis Eq. 7.9"
    )
    outcome: str = fact("outcome: at-rest, slid, rocked or collapse; or the reason why this run is not reliable")
    peak_rotation_rad: float = fact("greatest rotation of any block", "rad")
    bounces: int = fact("number of times that blocks separated from the ground or from each other")
    airborne_time_s: float = fact("total time that a block is without contact; greatest value of all blocks", "s")
    peak_slip_m: float = fact("greatest slip at a joint that is still in contact", "m")
    energy_residual_ratio: float = fact("error of the energy balance, divided by the total energy exchanged")


class Convergence(ResultModel):
    """How far the impulses of rigid contacts were found."""

    steps: int = fact("number of time steps")
    open_steps: int = fact("number of time steps in which the contact solver did not converge")
    most_rounds: int = fact("greatest number of iterations of the contact solver in one time step")
    factorisations_per_step: float = fact("sparse factorisations per step")
    worst_violation_ratio: float = fact(
        "greatest violation of the contact law (a velocity), divided by the velocity that gravity adds in one time step"
    )
    worst_violation_s: float = fact("time of the greatest violation", "s")


class TieRun(ResultModel):
    """What a run asked of a tie or a damper."""

    name: str = fact("name of the tie or damper")
    peak_force_N: float = fact("greatest force of the tie or damper (by absolute value) over all time steps; tension is positive", "N")
    end_force_N: float = fact("force of the tie or damper at the end of the run", "N")
    plastic_elongation_m: float = fact("plastic elongation of the tie at the end of the run; negative for shortening", "m")
    state: Literal["slack", "elastic", "yielded", "viscous"] = fact(
        "state of the tie over the run. slack: never loaded; elastic: below its yield or slip force; yielded: yielded "
        "or slipped at least once; viscous: a viscous damper"
    )


class PairWork(ResultModel):
    """Energy that a pair of blocks, or a block and its support, lost in a run."""

    name: str = fact("names of the two blocks; all supports together are called the ground")
    friction_J: float = fact("energy lost by friction", "J")
    damping_J: float = fact("energy lost in dashpots, or by impacts of rigid contacts", "J")
    peak_force_N: float = fact("greatest force between the two blocks, over the output times", "N")


class BlocksRun(KindResults):
    """What the blocks of a section and those in space have in common under a motion."""

    outcome: DemOutcome = fact("outcome: no joint opens or slides; joints slide; joints open and the blocks stand; or collapse")
    collapse_criterion: CollapseCriterion | None = fact(
        "criterion of collapse, in addition to the displacement: rotation, loss of height, loss of support or separation; "
        "null without collapse"
    )
    governing_block: str = fact("block that collapsed first; without collapse, the block that moved farthest")
    collapse_time_s: float | None = fact("time at which the first block collapsed; null without collapse", "s")
    stopped: str = fact("reason why the run ended")
    stopped_by: list[str] = fact("blocks that caused the end of the run")
    stop_time_s: float = fact("time at which the run ended", "s")
    still_moving: bool = fact("whether blocks still moved during the last 5 % of the run")
    peak_rotation_rad: dict[str, float] = fact("greatest rotation of each recorded block; positive towards +x", "rad")
    collapse_displacement_m: float = fact("displacement of a block that counts as collapse; not applied to a block that only slides", "m")
    peak_displacement_m: float = fact(
        "greatest displacement of any block from its position at rest under the constant loads, relative to the "
        "common displacement of the supports",
        "m",
    )
    peak_slip_m: float = fact("greatest slip at a joint that is still in contact", "m")
    residual_slip_m: float = fact("greatest slip of the joints at the end of the run", "m")
    slip_ratio: float = fact("greatest ratio of the slip of a joint to its length")
    slip_limit_ratio: float = fact(
        "limit of the ratio of slip to joint length (0.25). At this slip, half of the distance from the middle of the joint to its "
        "end is lost. Beyond the limit, the outcome is open (no verdict)"
    )
    slipped_joint: str | None = fact("joint with the greatest ratio of slip to length; null if no joint slides by 1 % of its length")
    off_footing: list[str] = fact("blocks that slid off their footings; only recorded if the deck gives no floor")
    decided_by_last_digits: bool = fact(
        "whether the response is chaotic. The motion is scaled by 1 + 1e-6: the response is chaotic if displacements change by more "
        "than 1/100 of the displacement that counts as collapse, or if only one of the two runs collapses. For changes above "
        "1/1000, scale factors up to 1 + 1e-4 are tried too. The value is false if the response was not checked"
    )
    perturbation_growth: float | None = fact(
        "growth of a perturbation, if the motion is scaled by 1 + 1e-6: greatest change of a displacement before collapse, divided by "
        "1e-6 and by the displacement that counts as collapse; null if this was not checked"
    )
    perturbed_outcome: str | None = fact("outcome under the motion scaled by 1 + 1e-6; null if this was not checked")
    violated: list[str] = fact("violated assumptions of the analysis, one sentence each, for instance a chaotic response")
    peak_kinetic_energy_J: float = fact("greatest kinetic energy", "J")
    friction_loss_J: float = fact("energy lost in friction", "J")
    damping_loss_J: float = fact("energy lost in damping", "J")
    peak_base_shear_N: float = fact(
        "greatest horizontal force of the ground on the blocks over the output times, at the initial contacts and at the anchors of "
        "ties and dampers. Contacts that form later are not included; if such contacts form, a warning is given",
        "N",
    )
    peak_base_shear_over_weight: float = fact("greatest horizontal force of the ground, divided by the weight of the structure")
    joint_work: list[PairWork] = fact("the pairs of blocks (at most 20) that lost most energy by friction")
    energy_residual_ratio: float = fact("error of the energy balance, divided by the total energy exchanged")
    bounces: int = fact("number of times that blocks separated from the ground or from each other")
    airborne_time_s: float = fact("total time that a block is without contact; greatest value of all blocks", "s")
    solver: Literal["compliant", "nonsmooth"] = fact(
        "model of the joints. compliant: springs; nonsmooth: rigid contacts (without stiffness)"
    )
    edge_stress_at_rest_Pa: float | None = maybe(
        "greatest compressive stress at an edge or corner of a joint, at the start of the motion, for a linear pressure without "
        "tension. Constant loads act, and the initial rotation if the deck gives one. With rigid contacts, the ground motion of the "
        "first time step acts too. Null if an edge or a corner alone carries the load",
        "Pa",
    )
    ties: list[TieRun] = maybe("force of each tie over time; for a bonded chain, the force of each of its segments")
    convergence: Convergence | None = maybe("accuracy of the contact solver (rigid contacts only)")
    joint_stiffness_min_Pa_per_m: float | None = fact("least normal stiffness of the joints", "Pa/m")
    joint_stiffness_max_Pa_per_m: float | None = fact("greatest normal stiffness of the joints", "Pa/m")
    beta_s: float | None = fact("stiffness-proportional damping", "s")
    damping_ratio_rotation: float | None = fact(
        "damping ratio (fraction of critical damping) at rotational impact; least value of all joints", source="thesis Eq. 7.13"
    )
    damping_ratio_corner: float | None = fact("damping ratio (fraction of critical damping) at corner impact; least value of all joints")
    damping_ratio_edge: float | None = fact(
        "damping ratio (fraction of critical damping) at edge impact; least value of all joints", source="thesis Eq. 7.9"
    )
    steps: int = fact("number of time steps")
    settling_steps: int = fact("number of time steps until the building was at rest under its weight, before the motion")
    time_step_s: float = fact("time step", "s")
    critical_step_s: float | None = fact("greatest stable time step", "s")
    contact_searches: int = fact("number of searches for contacts")
    animation: Literal["none", "gif", "mp4"] = fact("the animation that is drawn")

    def judged(self, demand: Demand) -> Verdict:
        """The greatest displacement against the one that counts as collapse [m], or the slip against `SLIP_LIMIT` of its joint, whichever
        is nearer to its limit. Open where blocks still move, slid too far, slid off a footing, or where the response is chaotic."""
        most, limit, share = self.peak_displacement_m, self.collapse_displacement_m, self.slip_ratio
        violated = [f"Block {name} slides off the end of its footing." for name in self.off_footing] + self.violated
        unchecked = "" if self.perturbation_growth is not None else " Whether the response is chaotic was not checked."
        if self.outcome == "collapse":
            how = f"{self.governing_block} collapses by {self.collapse_criterion}"
            text = f"{how} and moves by more than {three_figures(1000.0 * limit)} mm, the displacement that counts as collapse.{unchecked}"
            return judge(text, max(most, limit), limit, "m", "collapses", violated=violated)
        if self.still_moving:
            return judge("The run ended before the blocks came to rest.", most, limit, "m", "open", violated=violated)
        slip = (
            f"Blocks slide by up to {three_figures(1e3 * self.peak_slip_m)} mm. This is {100 * share:.3g} % of the joint length at "
            f"{self.slipped_joint} (limit {100 * SLIP_LIMIT:g} %, at which the distance from the middle of the joint to "
            f"its end is halved). At the end of the run {three_figures(1e3 * self.residual_slip_m)} mm of slip remain"
        )
        if share > SLIP_LIMIT:
            text = f"{slip}. The analysis does not decide whether the remaining contact suffices.{unchecked}"
            return judge(text, share, SLIP_LIMIT, "of the joint", "open", violated=violated)
        if most < limit:
            text = (
                f"No block moves by more than {three_figures(1000.0 * most)} mm; a displacement of {three_figures(1000.0 * limit)} "
                "mm counts as collapse."
            )
        else:
            text = (
                f"A block moves by {three_figures(1000.0 * most)} mm. This exceeds the displacement that counts as collapse "
                f"({three_figures(1000.0 * limit)} mm), but the block neither rotates nor settles as in a collapse."
            )
        if self.slipped_joint is not None:
            text += f" {slip}."
        text += unchecked
        if share / SLIP_LIMIT > most / limit:
            return judge(text, share, SLIP_LIMIT, "of the joint", violated=violated)
        return judge(text, most, limit, "m", "stands" if most < limit else "open", violated=violated)


class DemRun(BlocksRun):
    """dem: the blocks under a motion."""

    restitution_measured: float | None = fact(
        "for a single block: median, over its impacts, of the ratio of angular velocity after / before impact"
    )
    restitution_housner: float | None = fact(
        "for a block: ratio of angular velocity after / before impact, by the momentum balance", source="Housner 1963"
    )
    sensitivity: list[Variation] = maybe(
        "runs that repeat the analysis with other values of damping, stiffness or friction", source="thesis Tables 7.1 to 7.7"
    )
    friction_threshold: float | None = maybe("least coefficient of friction at which no joint slides; null if not found")
    water_force_N: list[float] = maybe(
        "force of the water pressure on all blocks, including uplift: component towards +x and upward component", "N"
    )


#: What the capacity of a tilt test is where blocks slide on joints whose forces statics does not fix
ONE_PATH = (
    "Blocks slide before collapse. Without dilatancy, the collapse acceleration then depends on the "
    "load path: the possible values form an interval, and a lower value may exist."
)


class BlocksTilt(KindResults):
    """What the tilt tests of a section and of blocks in space have in common."""

    test: Literal["tilt"] = fact("the test")
    outcome: DemOutcome = fact("outcome: no joint opens or slides; joints slide; joints open and the blocks stand; or collapse")
    collapse_acceleration_g: float = fact("constant acceleration towards +x that causes collapse", "g")
    collapse_acceleration_opposite_g: float = fact("constant acceleration towards -x that causes collapse", "g")
    tilt_angle_deg: float = fact("tilt of the ground with the same effect as the collapse acceleration towards +x", "deg")
    tilt_angle_opposite_deg: float = fact("tilt of the ground with the same effect as the collapse acceleration towards -x", "deg")
    interval: bool = fact(INTERVAL)
    energy_residual_ratio: float = fact("error of the energy balance, divided by the total energy exchanged")
    time_step_s: float = fact("time step", "s")
    steps: int = fact("number of time steps")
    solver: Literal["compliant", "nonsmooth"] = fact(
        "model of the joints. compliant: springs; nonsmooth: rigid contacts (without stiffness)"
    )
    ties: list[TieRun] = maybe("force of each tie over time; for a bonded chain, the force of each of its segments")
    convergence: Convergence | None = maybe("accuracy of the contact solver (rigid contacts only)")
    beta_s: float | None = fact("stiffness-proportional damping", "s")

    def judged(self, demand: Demand) -> Verdict:
        """The lesser capacity of the two senses against the peak ground acceleration of the motion [g]; an estimate that no bound is
        claimed of where it is one state of an interval."""
        found = judge_acceleration(min(self.collapse_acceleration_g, self.collapse_acceleration_opposite_g), demand)
        return found.model_copy(update={"statement": f"{found.statement} {ONE_PATH}"}) if self.interval else found


class DemTilt(BlocksTilt):
    """dem: the constant acceleration that brings the blocks down."""

    load_direction: Literal["+x"] = fact(
        "direction of the load for which `hinges`, `peak_rotation_rad` and `peak_slip_m` are given: always +x"
    )
    hinges: list[NamedHinge] = fact("hinges of the collapse mechanism towards +x")
    hinges_opposite: list[NamedHinge] = fact("hinges of the collapse mechanism towards -x")
    peak_rotation_rad: dict[str, float] = fact("greatest rotation of each recorded block; positive towards +x", "rad")
    peak_slip_m: float = fact("greatest slip in the mechanism", "m")
    water_force_N: list[float] = maybe(
        "force of the water pressure on all blocks, including uplift: component towards +x and upward component", "N"
    )


class SolidDemRun(BlocksRun):
    """dem: blocks in space under a motion."""

    peak_rotation_rad: dict[str, float] = fact("greatest rotation of each recorded block", "rad")
    slip_ratio: float = fact("greatest ratio of the slip of a contact to its least width")
    direction_deg: float = fact("direction of the horizontal motion in plan, as an angle from +x towards +y", "deg")
    horizontal_components: int = fact("number of horizontal components: 2 if a second record acts perpendicular to `direction_deg`")
    blocks: int = fact("number of blocks")
    contacts: int = fact("number of contacts (polygons along which blocks touch)")
    dowels: int = fact("number of dowels across contacts")
    dowel_slip_m: float = fact("greatest plastic slip of a dowel, including the slip under self-weight before the motion", "m")
    dowels_out: int = fact("number of dowels that came out of their holes")
    final_displacement_m: float = fact("greatest displacement of a block at the end of the run", "m")
    peak_opening_m: float = fact("greatest gap at a corner of a contact that is still closed elsewhere", "m")
    water_force_N: list[float] = maybe("force of the water pressure on all blocks, including uplift: towards +x and upward", "N")


class SolidDemTilt(BlocksTilt):
    """dem: the constant acceleration along a direction that brings blocks in space down."""

    collapse_acceleration_g: float = fact("constant acceleration along the load direction that causes collapse", "g")
    collapse_acceleration_opposite_g: float = fact("constant acceleration opposite to the load direction that causes collapse", "g")
    tilt_angle_deg: float = fact("tilt of the ground with the same effect as the collapse acceleration along the load direction", "deg")
    tilt_angle_opposite_deg: float = fact(
        "tilt of the ground with the same effect as the collapse acceleration in the opposite direction", "deg"
    )
    load_direction_deg: float = fact("direction of the load in plan, as an angle from +x towards +y", "deg")
    blocks: int = fact("number of blocks")
    contacts: int = fact("number of contacts (polygons along which blocks touch)")
    opening_contacts: list[str] = fact("contacts (at most 20) that open or slide at the start of collapse; the widest comes first")
    opening_contacts_opposite: list[str] = fact("contacts that open or slide under the load in the opposite direction")
    water_force_N: list[float] = maybe("force of the water pressure on all blocks, including uplift: towards +x and upward", "N")


Dem = DemRun | DemTilt | SolidDemRun | SolidDemTilt


class DemCurve(ResultModel):
    """Shortest failing durations with one set of joints, by one solver."""

    label: str = fact("name of the curve: the value that was varied, or the second solver")
    solver: Literal["compliant", "nonsmooth"] = fact(
        "model of the joints. compliant: springs; nonsmooth: rigid contacts (without stiffness)"
    )
    beta_s: float | None = fact("stiffness-proportional damping", "s")
    stiffness_Pa_per_m: float | None = fact("greatest normal stiffness of the joints", "Pa/m")
    friction: float = fact("greatest coefficient of friction of the joints")
    damping_ratio_rotation: float | None = fact(
        "damping ratio (fraction of critical damping) at rotational impact; least value of all joints"
    )
    damping_ratio_corner: float | None = fact("damping ratio (fraction of critical damping) at corner impact; least value of all joints")
    damping_ratio_edge: float | None = fact("damping ratio (fraction of critical damping) at edge impact; least value of all joints")
    shortest_durations_s: list[float | None] = fact(
        "shortest tried duration that causes collapse, at each amplitude; null if no tried duration causes collapse", "s"
    )


class CellApart(ResultModel):
    """A pulse that brings the structure down by one solver only."""

    amplitude_g: float = fact("amplitude", "g")
    duration_s: float = fact("duration", "s")
    fails_as_given: bool = fact("whether the solver of the deck predicts collapse")
    fails_by_the_other: bool = fact("whether the second solver (the one that the deck does not choose) predicts collapse")


class CrossCheck(ResultModel):
    """Springs and rigid contacts side by side, in every cell of amplitudes and durations."""

    cells: int = fact("number of cells of the map")
    agreement_ratio: float = fact("share of the cells of the map in which both solvers give the same outcome")
    apart: list[CellApart] = fact("cells of the map in which the two solvers give different outcomes")


class DemDomain(KindResults):
    """dem-domain: the shortest pulses that bring the blocks down."""

    pulse: Literal["step", "sine"] = fact("shape of the pulses")
    direction_deg: float | None = maybe("for solids: direction of the motion in plan, as an angle from +x towards +y", "deg")
    amplitudes_g: list[float] = fact("amplitudes of the pulses", "g")
    shortest_durations_s: list[float | None] = fact(
        "shortest tried duration that causes collapse, at each amplitude; null if no tried duration causes collapse", "s"
    )
    curves: list[DemCurve] = fact(
        "failure curves with other values of damping, stiffness or friction; the first curve has the values of the deck"
    )
    mode_II_durations_s: list[float | None] | None = maybe(
        "shortest duration that causes collapse in the first half cycle, at each amplitude; null if no tried duration does", "s"
    )
    convergence: Convergence | None = maybe("accuracy of the contact solver over all runs (rigid contacts only)")
    cross_check: CrossCheck | None = maybe("comparison of both solvers in every cell of the map")
    energy_residual_ratio: float = fact("error of the energy balance, divided by the total energy exchanged; greatest value of all runs")
    steps: int = fact("number of time steps of all runs")
    four_hinge_mode_I_durations_s: list[float | None] = maybe(
        "for an arch: shortest duration at which the four-hinge mechanism collapses (with or without an impact), at each amplitude", "s"
    )
    four_hinge_mode_II_durations_s: list[float | None] = maybe(
        "for an arch: shortest duration at which the four-hinge mechanism collapses without an impact, at each amplitude", "s"
    )

    def judged(self, demand: Demand) -> Verdict:
        """A motion that is such a pulse [s] against the curve between its amplitudes; without one the shortest failing
        duration of all is told."""
        if demand.pulse == self.pulse:
            duration, amplitude = demand.duration_s, demand.amplitude_g
            capacity = between(self.amplitudes_g, self.shortest_durations_s, amplitude)
            if capacity is not None:
                word = "shorter than" if duration < capacity else "at least as long as"
                return judge(
                    f"The motion has an amplitude of {amplitude:.3g} g and a duration of {duration:.3g} s. The duration is {word} the "
                    f"shortest that causes collapse at this amplitude ({capacity:.3g} s).",
                    duration,
                    capacity,
                    "s",
                )
        least = min((t for t in self.shortest_durations_s if t is not None), default=None)
        text = (
            "None of the calculated pulses causes collapse."
            if least is None
            else f"The shortest {self.pulse} pulse that causes collapse lasts {least:.3g} s."
        )
        return judge(text, None, least, "s")


class DemParameters(KindResults):
    """dem-parameters: stiffness, impact frequencies and damping of the joints, without a run."""

    joint_stiffness_min_Pa_per_m: float = fact("least normal stiffness of the joints", "Pa/m")
    joint_stiffness_max_Pa_per_m: float = fact("greatest normal stiffness of the joints", "Pa/m")
    rotation_frequency_rad_s: float = fact("greatest frequency of rotational impact", "rad/s", source="thesis Eq. 7.20")
    corner_frequency_rad_s: float = fact("greatest frequency of corner impact", "rad/s", source="thesis Eq. 7.18")
    edge_frequency_rad_s: float = fact("greatest frequency of edge impact", "rad/s", source="thesis Eq. 7.19")
    critical_beta_rotation_s: float = fact(
        "critical damping coefficient at rotational impact, to which damping ratios refer", "s", source="thesis Eq. 7.17"
    )
    critical_beta_corner_s: float = fact(
        "critical damping coefficient at corner impact, to which damping ratios refer", "s", source="thesis Eq. 7.17"
    )
    critical_beta_edge_s: float = fact(
        "critical damping coefficient at edge impact, to which damping ratios refer", "s", source="thesis Eq. 7.17"
    )
    beta_s: float = fact("stiffness-proportional damping in use", "s")
    mass_damping_per_s: float = fact("mass-proportional damping in use", "1/s")
    damping_ratio_rotation: float = fact("damping ratio (fraction of critical damping) at rotational impact; least value of all joints")
    damping_ratio_corner: float = fact("damping ratio (fraction of critical damping) at corner impact; least value of all joints")
    damping_ratio_edge: float = fact("damping ratio (fraction of critical damping) at edge impact; least value of all joints")
    convention: Literal["consistent", "thesis"] = fact("rule of the default stiffness")

    def judged(self, demand: Demand) -> Verdict:
        """Nothing is asked of the building."""
        return judge("This analysis calculates parameters of the joints and gives no verdict on the building.")
