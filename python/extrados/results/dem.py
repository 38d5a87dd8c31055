"""Results of discrete elements: dem (a run or a tilt test), dem-domain, dem-parameters."""

from typing import Literal

from extrados.results.curves import between
from extrados.results.fields import ResultModel, fact, maybe
from extrados.results.limit import NamedHinge
from extrados.results.verdict import Demand, KindResults, Verdict, judge, judge_acceleration

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
    "whether blocks slide, on the way to collapse, on statically indeterminate joints: the accelerations are then one state of an interval"
)
#: What a contact of solids does, in the stored array `state`: CLOSED, open at some corners, APART
ROCKS = 1


class Variation(ResultModel):
    """A run with another damping, stiffness or friction."""

    varied: Literal["damping", "stiffness", "friction"] = fact("value that was varied")
    value: float = fact("factor on damping or stiffness, or the coefficient of friction")
    beta_s: float = fact("stiffness-proportional damping", "s")
    stiffness_Pa_per_m: float = fact("greatest normal stiffness of the joints", "Pa/m")
    friction: float = fact("greatest coefficient of friction of the joints")
    damping_ratio_rotation: float = fact(
        "damping ratio (fraction of critical damping) at rotational impact, least of all joints", source="thesis Eq. 7.13"
    )
    damping_ratio_edge: float = fact(
        "damping ratio (fraction of critical damping) at edge impact, least of all joints", source="thesis Eq. 7.9"
    )
    outcome: str = fact("at-rest, slid, rocked or collapse, or why the run is not to be trusted")
    peak_rotation_rad: float = fact("greatest rotation of any block", "rad")
    bounces: int = fact("times that blocks left the ground or each other")
    airborne_time_s: float = fact("longest time that a block was without contact", "s")
    peak_slip_m: float = fact("greatest slip of joints that still touch", "m")
    energy_residual_ratio: float = fact("error of the energy balance over the total energy exchanged")


class Convergence(ResultModel):
    """How far the impulses of rigid contacts were found."""

    steps: int = fact("time steps")
    open_steps: int = fact("time steps in which the contacts did not converge")
    most_rounds: int = fact("greatest number of rounds (new impulses) of a step")
    factorisations_per_step: float = fact("sparse factorisations per step")
    worst_violation_ratio: float = fact("greatest violation of the contact law as a velocity, over that which gravity gives in a step")
    worst_violation_s: float = fact("when that was", "s")


class TieRun(ResultModel):
    """What a run asked of a tie or a damper."""

    name: str = fact("its name")
    peak_force_N: float = fact("force of the greatest magnitude in any step, tension positive", "N")
    end_force_N: float = fact("force at the end", "N")
    plastic_elongation_m: float = fact("plastic elongation at the end, of shortening negative", "m")
    state: Literal["slack", "elastic", "yielded", "viscous"] = fact(
        "without force all along, below its yield or slip force, at it once; or a viscous damper"
    )


class DemRun(KindResults):
    """dem: the blocks under a motion."""

    outcome: DemOutcome = fact("no joint opens or slides, joints slide, joints open and the blocks stand, or collapse")
    collapse_criterion: CollapseCriterion | None = fact("criterion of collapse besides the displacement; null without collapse")
    governing_block: str = fact("the block that collapsed first, else the block that moved farthest")
    collapse_time_s: float | None = fact("when the first block collapsed", "s")
    stopped: str = fact("why the run ended")
    stopped_by: list[str] = fact("the blocks that ended it")
    stop_time_s: float = fact("when it ended", "s")
    still_moving: bool = fact("whether it still moved at the end")
    peak_rotation_rad: dict[str, float] = fact("greatest rotation of each followed block, positive to +x", "rad")
    collapse_displacement_m: float = fact("displacement of a block that counts as collapse, unless the block only slides", "m")
    peak_displacement_m: float = fact("greatest displacement of any block from its settled place", "m")
    peak_slip_m: float = fact("greatest slip of joints that still touch", "m")
    residual_slip_m: float = fact("greatest slip of joints at the end", "m")
    slip_ratio: float = fact("greatest slip over the length of its joint")
    slip_limit_ratio: float = fact(
        "limit of that ratio (0.25): beyond it more than half of the lever arm to the end of the joint is lost, and the verdict is open"
    )
    slipped_joint: str | None = fact("joint of that ratio; null if no joint slides by 1 %")
    off_footing: list[str] = fact("blocks that slid beyond their footings, without a named floor")
    decided_by_last_digits: bool = fact(
        "chaotic response: under the motion times 1 + 1e-6 the displacements differ by more than a hundredth of the one that counts "
        "as collapse, or only one of both runs collapses; beyond a thousandth, also under motions up to 1e-4 apart; false without this check"
    )
    perturbation_growth: float | None = fact(
        "greatest separation of the displacements of a block, over the one that counts as collapse, under the motion times 1 + 1e-6, over "
        "that perturbation, until collapse; null where this was not checked"
    )
    perturbed_outcome: str | None = fact("outcome under the motion times 1 + 1e-6; null where this was not checked")
    violated: list[str] = fact("assumptions that were checked and do not hold: no chaos, a sentence each")
    peak_kinetic_energy_J: float = fact("greatest kinetic energy", "J")
    friction_loss_J: float = fact("energy lost in friction", "J")
    damping_loss_J: float = fact("energy lost in damping", "J")
    energy_residual_ratio: float = fact("error of the energy balance over the total energy exchanged")
    restitution_measured: float | None = fact("of a single block: median rate after over before its impacts")
    restitution_housner: float | None = fact("of a block: the momentum balance", source="Housner 1963")
    bounces: int = fact("times that blocks left the ground or each other")
    airborne_time_s: float = fact("longest time that a block was without contact", "s")
    solver: Literal["compliant", "nonsmooth"] = fact("springs at the joints, or rigid contacts; these have no stiffness")
    ties: list[TieRun] = maybe("forces of the ties over time; of bonded chains each segment")
    convergence: Convergence | None = maybe("of rigid contacts")
    joint_stiffness_min_Pa_per_m: float | None = fact("least normal stiffness of the joints", "Pa/m")
    joint_stiffness_max_Pa_per_m: float | None = fact("greatest normal stiffness of the joints", "Pa/m")
    beta_s: float | None = fact("stiffness-proportional damping", "s")
    damping_ratio_rotation: float | None = fact(
        "damping ratio (fraction of critical damping) at rotational impact, least of all joints", source="thesis Eq. 7.13"
    )
    damping_ratio_corner: float | None = fact("damping ratio (fraction of critical damping) at corner impact, least of all joints")
    damping_ratio_edge: float | None = fact(
        "damping ratio (fraction of critical damping) at edge impact, least of all joints", source="thesis Eq. 7.9"
    )
    steps: int = fact("time steps")
    settling_steps: int = fact("time steps until the building settled under its weight")
    time_step_s: float = fact("time step", "s")
    critical_step_s: float | None = fact("greatest stable time step", "s")
    contact_searches: int = fact("searches for contacts")
    animation: Literal["none", "gif", "mp4"] = fact("the animation that is drawn")
    sensitivity: list[Variation] = maybe("runs with other damping, stiffness or friction", source="thesis Tables 7.1 to 7.7")
    friction_threshold: float | None = maybe("least friction at which no joint slides; null where not found")

    def judged(self, demand: Demand) -> Verdict:
        """The greatest displacement against the one that counts as collapse [m]; open where it still moves."""
        return _judged_run(self)


#: What the capacity of a tilt test is where blocks slide on joints whose forces statics does not fix
ONE_PATH = (
    "Blocks slide on the way to collapse: the value is one state, of this load path. Without dilatancy such states form an interval, and a lower one may "
    "exist."
)


def _tilted(collapse: float, opposite: float, interval: bool, demand: Demand) -> Verdict:
    """The lesser capacity of the two senses against the peak ground acceleration of the motion [g]; an estimate that no bound is
    claimed of where it is one state of an interval."""
    found = judge_acceleration(min(collapse, opposite), demand)
    return found.model_copy(update={"statement": f"{found.statement} {ONE_PATH}"}) if interval else found


class DemTilt(KindResults):
    """dem: the constant acceleration that brings the blocks down."""

    test: Literal["tilt"] = fact("the test")
    outcome: DemOutcome = fact("collapse occurs, at these accelerations")
    collapse_acceleration_g: float = fact("constant acceleration that causes collapse, applied to +x", "g")
    collapse_acceleration_opposite_g: float = fact("constant acceleration that causes collapse, applied to -x", "g")
    tilt_angle_deg: float = fact("tilt of the ground that pushes alike, to +x", "deg")
    tilt_angle_opposite_deg: float = fact("tilt of the ground that pushes alike, to -x", "deg")
    load_direction: Literal["+x"] = fact("sense of the push that the hinges belong to")
    hinges: list[NamedHinge] = fact("hinges of the mechanism")
    hinges_opposite: list[NamedHinge] = fact("hinges of the mechanism to -x")
    peak_rotation_rad: dict[str, float] = fact("greatest rotation of each followed block, positive to +x", "rad")
    peak_slip_m: float = fact("greatest slip in the mechanism", "m")
    interval: bool = fact(INTERVAL)
    energy_residual_ratio: float = fact("error of the energy balance over the total energy exchanged")
    time_step_s: float = fact("time step", "s")
    steps: int = fact("time steps of the last run")
    solver: Literal["compliant", "nonsmooth"] = fact("springs at the joints, or rigid contacts")
    ties: list[TieRun] = maybe("forces of the ties over time; of bonded chains each segment")
    convergence: Convergence | None = maybe("of rigid contacts, in the last runs of both senses")
    beta_s: float | None = fact("stiffness-proportional damping; null of rigid contacts", "s")

    def judged(self, demand: Demand) -> Verdict:
        """The lesser capacity of the two senses against the peak ground acceleration of the motion [g]."""
        return _tilted(self.collapse_acceleration_g, self.collapse_acceleration_opposite_g, self.interval, demand)


class PairWork(ResultModel):
    """Energy that a pair of blocks, or a block and its support, lost in a run."""

    name: str = fact("both blocks; the ground is one support")
    friction_J: float = fact("by friction", "J")
    damping_J: float = fact("in dashpots, or by impacts of rigid contacts", "J")
    peak_force_N: float = fact("greatest force between them at an output time", "N")


class SolidDemRun(KindResults):
    """dem: blocks in space under a motion."""

    outcome: DemOutcome = fact("no contact opens or slides, contacts slide, contacts open and the blocks stand, or collapse")
    collapse_criterion: CollapseCriterion | None = fact("criterion of collapse besides the displacement; null without collapse")
    governing_block: str = fact("the block that collapsed first, else the block that moved farthest")
    collapse_time_s: float | None = fact("when the first block collapsed", "s")
    direction_deg: float = fact("direction in plan of the horizontal motion, from +x to +y", "deg")
    horizontal_components: int = fact("2 where a record moves the ground across that direction, too")
    stopped: str = fact("why the run ended")
    stopped_by: list[str] = fact("the blocks that ended it")
    stop_time_s: float = fact("when it ended", "s")
    still_moving: bool = fact("whether it still moved at the end")
    blocks: int = fact("stones")
    contacts: int = fact("polygons along which they touch")
    dowels: int = fact("dowels across contacts")
    dowel_slip_m: float = fact("greatest plastic slip of a dowel, slip during the initial settling under self-weight included", "m")
    dowels_out: int = fact("how many of them came out")
    peak_rotation_rad: dict[str, float] = fact("greatest rotation of each followed block", "rad")
    collapse_displacement_m: float = fact("displacement of a block that counts as collapse, unless the block only slides", "m")
    peak_displacement_m: float = fact("greatest displacement of any block from its settled place", "m")
    final_displacement_m: float = fact("greatest displacement of any block at the end", "m")
    peak_opening_m: float = fact("greatest gap at a corner of a contact that still touches", "m")
    peak_slip_m: float = fact("greatest slip of contacts that still touch", "m")
    residual_slip_m: float = fact("greatest slip of contacts at the end", "m")
    slip_ratio: float = fact("greatest slip over the least width of its contact")
    slip_limit_ratio: float = fact(
        "limit of that ratio (0.25): beyond it more than half of the lever arm to the end of the joint is lost, and the verdict is open"
    )
    slipped_joint: str | None = fact("joint of that ratio; null if no joint slides by 1 %")
    off_footing: list[str] = fact("blocks that slid beyond their footings, without a named floor")
    decided_by_last_digits: bool = fact(
        "chaotic response: under the motion times 1 + 1e-6 the displacements differ by more than a hundredth of the one that counts "
        "as collapse, or only one of both runs collapses; beyond a thousandth, also under motions up to 1e-4 apart; false without this check"
    )
    perturbation_growth: float | None = fact(
        "greatest separation of the displacements of a block, over the one that counts as collapse, under the motion times 1 + 1e-6, over "
        "that perturbation, until collapse; null where this was not checked"
    )
    perturbed_outcome: str | None = fact("outcome under the motion times 1 + 1e-6; null where this was not checked")
    violated: list[str] = fact("assumptions that were checked and do not hold: no chaos, a sentence each")
    peak_kinetic_energy_J: float = fact("greatest kinetic energy", "J")
    friction_loss_J: float = fact("energy lost in friction", "J")
    damping_loss_J: float = fact("energy lost in damping", "J")
    peak_base_shear_N: float = fact("greatest horizontal force of the ground on the blocks at an output time", "N")
    peak_base_shear_over_weight: float = fact("the same over the weight of the structure")
    joint_work: list[PairWork] = fact("pairs of blocks that lost most energy by friction, at most 20")
    energy_residual_ratio: float = fact("error of the energy balance over the total energy exchanged")
    bounces: int = fact("times that blocks left the ground or each other")
    airborne_time_s: float = fact("longest time that a block was without contact", "s")
    solver: Literal["compliant", "nonsmooth"] = fact("springs at the contacts, or rigid ones; these have no stiffness")
    ties: list[TieRun] = maybe("forces of the ties over time; of bonded chains each segment")
    convergence: Convergence | None = maybe("of rigid contacts")
    joint_stiffness_min_Pa_per_m: float | None = fact("least normal stiffness of the contacts", "Pa/m")
    joint_stiffness_max_Pa_per_m: float | None = fact("greatest normal stiffness of the contacts", "Pa/m")
    beta_s: float | None = fact("stiffness-proportional damping", "s")
    damping_ratio_rotation: float | None = fact(
        "damping ratio (fraction of critical damping) at rotational impact, least of all joints", source="thesis Eq. 7.13"
    )
    damping_ratio_corner: float | None = fact("damping ratio (fraction of critical damping) at corner impact, least of all joints")
    damping_ratio_edge: float | None = fact(
        "damping ratio (fraction of critical damping) at edge impact, least of all joints", source="thesis Eq. 7.9"
    )
    steps: int = fact("time steps")
    settling_steps: int = fact("time steps until the building settled under its weight")
    time_step_s: float = fact("time step", "s")
    critical_step_s: float | None = fact("greatest stable time step", "s")
    contact_searches: int = fact("searches for contacts")
    animation: Literal["none", "gif", "mp4"] = fact("the animation that is drawn")

    def judged(self, demand: Demand) -> Verdict:
        """As of a plane run."""
        return _judged_run(self)


class SolidDemTilt(KindResults):
    """dem: the constant acceleration along a direction that brings blocks in space down."""

    test: Literal["tilt"] = fact("the test")
    outcome: DemOutcome = fact("collapse occurs, at these accelerations")
    collapse_acceleration_g: float = fact("constant acceleration that causes collapse, applied along the direction", "g")
    collapse_acceleration_opposite_g: float = fact("collapse acceleration in the opposite direction", "g")
    tilt_angle_deg: float = fact("tilt of the ground that pushes alike, along the direction", "deg")
    tilt_angle_opposite_deg: float = fact("tilt of the ground that pushes alike, the opposite way", "deg")
    load_direction_deg: float = fact("direction in plan of the push, from +x to +y", "deg")
    blocks: int = fact("stones")
    contacts: int = fact("polygons along which they touch")
    opening_contacts: list[str] = fact("contacts that gape or slide as it begins to go, at most 20, the widest first")
    opening_contacts_opposite: list[str] = fact("contacts that open under the opposite direction")
    interval: bool = fact(INTERVAL)
    energy_residual_ratio: float = fact("error of the energy balance over the total energy exchanged")
    time_step_s: float = fact("time step", "s")
    steps: int = fact("time steps of the last run")
    solver: Literal["compliant", "nonsmooth"] = fact("springs at the contacts, or rigid ones")
    ties: list[TieRun] = maybe("forces of the ties over time; of bonded chains each segment")
    convergence: Convergence | None = maybe("of rigid contacts, in the last runs of both senses")
    beta_s: float | None = fact("stiffness-proportional damping; null of rigid contacts", "s")

    def judged(self, demand: Demand) -> Verdict:
        """The lesser capacity of the two senses against the peak ground acceleration of the motion [g]."""
        return _tilted(self.collapse_acceleration_g, self.collapse_acceleration_opposite_g, self.interval, demand)


def _judged_run(run: DemRun | SolidDemRun) -> Verdict:
    """The greatest displacement against the one that counts as collapse [m], or the slip against `SLIP_LIMIT` of its joint, whichever
    is nearer to its limit. Open where blocks still move, slid too far, slid off a footing, or where the response is chaotic."""
    most, limit, share = run.peak_displacement_m, run.collapse_displacement_m, run.slip_ratio
    violated = [f"The footing under {name} ends where {name} slides on." for name in run.off_footing] + run.violated
    unchecked = "" if run.perturbation_growth is not None else " Sensitivity to perturbations of the motion was not checked."
    if run.outcome == "collapse":
        how = f"{run.governing_block} collapses by {run.collapse_criterion}"
        text = f"{how}, and moves farther than the {1e3 * limit:.3g} mm that count as collapse.{unchecked}"
        return judge(text, max(most, limit), limit, "m", "collapses", violated=violated)
    if run.still_moving:
        return judge("The run ended while blocks still moved.", most, limit, "m", "open", violated=violated)
    slip = (
        f"Blocks slide by up to {1e3 * run.peak_slip_m:.3g} mm, {100 * share:.3g} % of the joint {run.slipped_joint} (limit "
        f"{100 * SLIP_LIMIT:g} %, where half of the lever arm to its end is lost), and by {1e3 * run.residual_slip_m:.3g} mm at the end"
    )
    if share > SLIP_LIMIT:
        text = f"{slip}: whether the support that is left suffices is not decided.{unchecked}"
        return judge(text, share, SLIP_LIMIT, "of the joint", "open", violated=violated)
    text = f"No block moves farther than {1e3 * most:.3g} mm; {1e3 * limit:.3g} mm count as collapse."
    if run.slipped_joint is not None:
        text += f" {slip}."
    text += unchecked
    if share / SLIP_LIMIT > most / limit:
        return judge(text, share, SLIP_LIMIT, "of the joint", violated=violated)
    return judge(text, most, limit, "m", "stands" if most < limit else "open", violated=violated)


Dem = DemRun | DemTilt | SolidDemRun | SolidDemTilt


class DemCurve(ResultModel):
    """Shortest failing durations with one set of joints, by one solver."""

    label: str = fact("value that was varied, or the other solver")
    solver: Literal["compliant", "nonsmooth"] = fact("springs at the joints, or rigid contacts; these have no stiffness")
    beta_s: float | None = fact("stiffness-proportional damping", "s")
    stiffness_Pa_per_m: float | None = fact("greatest normal stiffness of the joints", "Pa/m")
    friction: float = fact("greatest coefficient of friction of the joints")
    damping_ratio_rotation: float | None = fact("damping ratio (fraction of critical damping) at rotational impact, least of all joints")
    damping_ratio_corner: float | None = fact("damping ratio (fraction of critical damping) at corner impact, least of all joints")
    damping_ratio_edge: float | None = fact("damping ratio (fraction of critical damping) at edge impact, least of all joints")
    shortest_durations_s: list[float | None] = fact("at each amplitude; null if no tried value causes collapse", "s")


class CellApart(ResultModel):
    """A pulse that brings the structure down by one solver only."""

    amplitude_g: float = fact("amplitude", "g")
    duration_s: float = fact("duration", "s")
    fails_as_given: bool = fact("whether collapse occurs by the solver of the deck")
    fails_by_the_other: bool = fact("whether collapse occurs by the other solver")


class CrossCheck(ResultModel):
    """Springs and rigid contacts side by side, in every cell of amplitudes and durations."""

    cells: int = fact("cells")
    agreement_ratio: float = fact("share of cells in which both have the same outcome")
    apart: list[CellApart] = fact("cells in which they do not")


class DemDomain(KindResults):
    """dem-domain: the shortest pulses that bring the blocks down."""

    pulse: Literal["step", "sine"] = fact("shape of the pulses")
    direction_deg: float | None = maybe("of solids: direction in plan of the motion, from +x to +y", "deg")
    amplitudes_g: list[float] = fact("amplitudes of the pulses", "g")
    shortest_durations_s: list[float | None] = fact("at each amplitude; null if no tried value causes collapse", "s")
    curves: list[DemCurve] = fact("failure curves with other damping, stiffness or friction; the first is as given")
    mode_II_durations_s: list[float | None] | None = maybe(
        "shortest durations that cause collapse in the first half cycle; null without collapse at any duration that was run", "s"
    )
    convergence: Convergence | None = maybe("of rigid contacts, in all runs")
    cross_check: CrossCheck | None = maybe("by both solvers")
    energy_residual_ratio: float = fact("greatest error of the energy balances over the total energy exchanged")
    steps: int = fact("time steps of all runs")
    four_hinge_mode_I_durations_s: list[float | None] = maybe(
        "of an arch: shortest failing durations by the four-hinge mechanism, either mode", "s"
    )
    four_hinge_mode_II_durations_s: list[float | None] = maybe(
        "of an arch: shortest failing durations by the four-hinge mechanism, without an impact", "s"
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
                    f"The motion, {amplitude:.3g} g for {duration:.3g} s, is {word} the shortest failing one "
                    f"({capacity:.3g} s at that amplitude).",
                    duration,
                    capacity,
                    "s",
                )
        failing = [t for t in self.shortest_durations_s if t is not None]
        if not failing:
            return judge("None of the calculated pulses causes collapse.", None, None, "s")
        return judge(
            f"Of the {self.pulse} calculated pulses the shortest that causes collapse lasts {min(failing):.3g} s.", None, min(failing), "s"
        )


class DemParameters(KindResults):
    """dem-parameters: stiffness, impact frequencies and damping of the joints, without a run."""

    joint_stiffness_min_Pa_per_m: float = fact("least normal stiffness of the joints", "Pa/m")
    joint_stiffness_max_Pa_per_m: float = fact("greatest normal stiffness of the joints", "Pa/m")
    rotation_frequency_rad_s: float = fact("greatest frequency of rotational impact", "rad/s", source="thesis Eq. 7.20")
    corner_frequency_rad_s: float = fact("greatest frequency of corner impact", "rad/s", source="thesis Eq. 7.18")
    edge_frequency_rad_s: float = fact("greatest frequency of edge impact", "rad/s", source="thesis Eq. 7.19")
    critical_beta_rotation_s: float = fact("damping that is critical at rotational impact", "s", source="thesis Eq. 7.17")
    critical_beta_corner_s: float = fact("damping that is critical at corner impact", "s", source="thesis Eq. 7.17")
    critical_beta_edge_s: float = fact("damping that is critical at edge impact", "s", source="thesis Eq. 7.17")
    beta_s: float = fact("stiffness-proportional damping in use", "s")
    mass_damping_per_s: float = fact("mass-proportional damping in use", "1/s")
    damping_ratio_rotation: float = fact("damping ratio (fraction of critical damping) at rotational impact, least of all joints")
    damping_ratio_corner: float = fact("damping ratio (fraction of critical damping) at corner impact, least of all joints")
    damping_ratio_edge: float = fact("damping ratio (fraction of critical damping) at edge impact, least of all joints")
    convention: Literal["consistent", "thesis"] = fact("rule of the default stiffness")

    def judged(self, demand: Demand) -> Verdict:
        """Nothing is asked of the building."""
        return judge("Parameters of the joints; the analysis gives no verdict on the building.")
