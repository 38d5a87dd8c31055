"""Results of sequentially linear analysis."""

from typing import Literal

from extrados.results.fields import ResultModel, fact, maybe
from extrados.results.verdict import Demand, KindResults, Verdict, capacity_alone, judge, judge_acceleration
from extrados.results.verification import Verification

#: How the names of arrays begin that belong to the first sense of the load, and to the second
PREFIXES = ("", "minus_")
#: Part of the peak to which the load drops at the ultimate displacement
DROP = 0.8


class Bilinear(ResultModel):
    """Elastic-plastic idealisation of the envelope, of equal area."""

    stiffness_N_m: float = fact("secant stiffness at 60 % of the peak", "N/m")
    yield_load_N: float = fact("load of the plateau", "N")
    yield_displacement_m: float = fact("displacement at its start", "m")
    ultimate_displacement_m: float = fact("displacement at a load of 80 % of the peak after it, or the last", "m")
    ductility: float = fact("ultimate over yield displacement")


class Makeup(ResultModel):
    """Fingerprints of what a stored damage rests on; a run goes on from another with the same ones alone."""

    stiffness: str = fact("fingerprint of moduli, Poisson's ratios, thicknesses and elements")
    tension: str = fact("fingerprint of the tensile laws, with the teeth of their saw-tooth curves and the crack bands")
    compression: str = fact("fingerprint of the crushing laws, with the teeth of their saw-tooth curves and the crack bands")
    cracking: str = fact("fingerprint of the options of cracking")


class BarForce(ResultModel):
    """What a bar of the wall, or one of [[ties]], bears; tension is positive."""

    name: str = fact("its name; bars of the wall are called by their number")
    force_at_greatest_load_N: float | None = fact(
        "force at the greatest load in equilibrium, of an embedded bar at its section of greatest force; null if that state was not kept",
        "N",
    )
    last_force_N: float | None = fact("force in the last state, likewise", "N")
    greatest_force_N: float | None = maybe(
        "force of greatest size of all states in equilibrium, of a bar that is held at its ends alone", "N"
    )
    state: Literal["slack", "carries", "yielded"] = fact("at the end: slack, carrying, or past a tooth of its strength somewhere")


class SlaCurve(ResultModel):
    """The events of one sense of the load."""

    sense: Literal["+", "-"] = fact("sense of the reference loads")
    peak_load_N: float | None = fact("greatest load in equilibrium, followed by a drop of the load or a mechanism; else null", "N")
    peak_displacement_m: float | None = fact("control displacement at the peak", "m")
    displacement_of_constant_loads_m: float = fact("control displacement under the constant loads alone", "m")
    peak_event: int | None = fact("event of the peak, from 1")
    greatest_load_N: float | None = fact("greatest load of all states, at a peak or not; null without a state", "N")
    greatest_load_displacement_m: float | None = fact("control displacement at the greatest load", "m")
    greatest_load_event: int | None = fact("event of the greatest load, from 1")
    first_event_load_N: float | None = fact("load of the first event", "N")
    events: int = fact("events of this run")
    events_before_resume: int = fact("events of the runs that this one continues")
    events_without_equilibrium: int = fact("events at which no multiplier of the load suits all points")
    events_out_of_reach: int = fact(
        "events that are no states: beyond a displacement of a tenth of the structure's size, or ten times the peak load"
    )
    first_event_without_equilibrium: int | None = fact("the first of them, from 1")
    stop: str = fact("why the run ended")
    secondary_cracks: int = fact("events of second cracks")
    damaged_points: int = fact("points that cracked")
    closings: int = fact("cracks that closed")
    crushing_events: int = fact("events of crushing")
    last_load_N: float | None = fact("load of the last event in equilibrium", "N")
    last_displacement_m: float | None = fact("control displacement of that event", "m")
    energy_residual_ratio: float = fact("error of the energy balance over the work of the loads")
    external_work_J: float | None = fact("work of all loads up to that event, along the straight way from event to event", "J")
    stored_energy_J: float | None = fact("elastic energy at that event", "J")
    dissipated_energy_J: float | None = fact(
        "energy dissipated up to that event; never negative, never decreasing. Basis: the work of the loads less the stored energy, from one "
        "state in equilibrium to the next, friction included; through events without equilibrium the area of their teeth",
        "J",
    )
    crack_energy_J: float = fact(
        "area of the teeth passed across cracks and along joints, in all events. Basis: the material laws (fracture "
        "energy), without friction and without the energy lost between states: it need not equal dissipated_energy_J",
        "J",
    )
    residual_ratio: float | None = fact("greatest measured residual of the equations; null without a measurement")
    guard_checks: int = fact("times that the residual was measured on the way")
    guard_resolutions: int = fact("times that the equations were solved again for it")
    guard_new_factors: int = fact("times that the factor was made anew for it")
    equilibrium_steps: int = maybe("steps of equilibrium iterations among the events, after equilibrium was lost under the constant loads")
    staggered_steps: int = maybe("steps among them in which damage was frozen and updated, because Newton's method stalled")
    unbalanced_steps: int = maybe("steps among them that exceed the tolerance of the residual: no states")
    equilibrium_solutions: int = maybe("linear systems solved in these steps")
    equilibrium_from_m: float = maybe("control displacement from which equilibrium iterations went on", "m")
    step_residual_ratio: float = maybe("greatest residual of a state of these steps, over the largest nodal force of an element")
    step_balance_ratio: float = maybe(
        "greatest error of the energies in these states: work of all loads less stored and dissipated energy, over the work"
    )
    released_energy_J: float = maybe(
        "energy lost as motion in these steps, where the load drops to another equilibrium; part of dissipated_energy_J", "J"
    )
    drift_height_m: float = maybe("extent of the structure across the control displacement: drifts are displacements over it", "m")
    peak_drift: float | None = maybe("drift at the peak")
    drop_displacement_m: float | None = maybe(
        "control displacement at which the envelope has dropped to 80 % of the peak; null if it has not", "m"
    )
    drop_drift: float | None = maybe("drift there")
    axial_loss_displacement_m: float | None = maybe(
        "control displacement of the last state before the constant loads were no longer carried; null if they were", "m"
    )
    axial_loss_drift: float | None = maybe("drift there")
    seconds_per_event: float = fact("computing time of an event", "s")
    events_of_constant_loads: int = fact("events while the constant loads were brought on")
    probe_loads_N: list[float | None] = maybe("load of the envelope at the probed displacements; null beyond it", "N")
    initial_stiffness_N_m: float = maybe("stiffness before the first event; none of a stage that began with equilibrium iterations", "N/m")
    peak_acceleration_g: float | None = maybe("the peak as a horizontal acceleration, where the load is an acceleration of the masses", "g")
    greatest_acceleration_g: float | None = maybe("the greatest load as a horizontal acceleration, likewise", "g")
    bars: list[BarForce] = maybe("forces of bars and ties")
    bilinear: Bilinear = maybe("idealisation of an envelope that has a rising branch and has passed its peak")


class SlaStage(SlaCurve):
    """One stage of several; loads are those in the direction of its own, with what stages before have left on."""

    name: str = fact("its name, or its number")
    prefix: str = fact("how the names of its arrays begin; empty for the stage that represents the analysis")
    start_load_N: float = fact("load at its start", "N")
    end_load_N: float | None = fact("load at its end", "N")


class Scatter(ResultModel):
    """Repetitions with other seeds of mesh and strength."""

    seeds: list[int] = fact("the seeds")
    peak_loads_N: list[float] = fact("peak load of each", "N")
    mean_N: float = fact("their mean", "N")
    coefficient_of_variation: float | None = fact("their coefficient of variation; null for a single one")
    lowest_N: float = fact("the lowest", "N")
    highest_N: float = fact("the highest", "N")


class Comparison(ResultModel):
    """The envelope over the mean of a measured curve."""

    peak_ratio: float = fact("greatest load over the measured one")
    tail_ratios: list[float | None] = fact(
        "load over the measured one at 75, 50, 25 % of its peak after the peak; null if either curve ends before"
    )
    inside_ratio: float | None = fact("part of the measured points between whose least and greatest load the envelope lies")
    half_band_ratio: float = fact("mean half width of the measured band over its mean load")


class Sla(SlaCurve, KindResults):
    """sla: cracks event by event under constant loads and growing ones; the curve of the first sense, and of both."""

    reference_load_N: float = fact("the reference loads, to which the multiplier 1 belongs", "N")
    cracking: Literal["rotating", "orthotropic", "isotropic"] = fact("how cracked material behaved")
    teeth: list[int] = fact("least and greatest number of teeth of the saw-tooth laws")
    nodes: int = fact("nodes of the mesh")
    elements: int = fact("elements of the mesh")
    equations: int = fact("equations")
    points: int = fact("integration points, those of bars too")
    makeup: Makeup = maybe("values that resume_from compares")
    minus: SlaCurve = maybe("the curve of the second sense")
    stages: list[SlaStage] = maybe("of a run in stages, each; without a name, the numbers are those of the last or main one")
    measured: Comparison = maybe("the measured curve of the deck beside the first sense's")
    scatter: Scatter = maybe("repetitions with other seeds")
    verification: Verification = maybe("displacement-based verification of a wall on which the horizontal forces of its own masses act")
    stones: bool = fact("whether the model is of blocks with joints, whose peak acceleration is a static limit load")
    hinges: list[str] = maybe("of blocks: joints that are open but for an edge at the peak")

    def judged(self, demand: Demand) -> Verdict:
        """The lesser peak of the two senses: an acceleration [g], or a load [N] that the deck does not ask for."""
        curves = [c for c in (self, self.minus) if c is not None]
        if any(c.greatest_load_N is None for c in curves):
            text = f"No state with a load was found; the run ended by: {self.stop}."
            return judge(text, None, None, "N", "open" if self.stones and demand.peak_g is not None else None)
        least = min(curves, key=lambda c: c.greatest_load_N or 0.0)
        reached, load = least.greatest_acceleration_g, f"{(least.greatest_load_N or 0.0) / 1e3:.4g} kN"
        if reached is not None and not self.stones:
            peaks = least.peak_load_N is not None
            if self.verification is not None and self.verification.decides:
                return self.verification.judged(f"The greatest base shear is {load}.")
            text = f"The wall {'carries' if peaks else 'has carried, without a peak,'} {load} ({abs(reached):.3g} g times its masses)."
            return capacity_alone(text, abs(reached), "g", None if peaks else "lower")
        if any(c.peak_load_N is None for c in curves):
            text = f"The load has reached {load} without a peak; the capacity of the building is not known"
            if reached is None or demand.peak_g is None:
                return judge(f"{text}.", None, None, "N" if reached is None else "g")
            if demand.peak_g < reached:
                return judge_acceleration(reached, demand)
            return judge(
                f"{text}; the demand of the motion is {demand.peak_g:.3g} g, {reached:.3g} g were reached.",
                demand.peak_g,
                None,
                "g",
                "open",
            )
        if reached is not None:
            return judge_acceleration(abs(reached), demand)
        return judge(f"The capacity of the building is {load} of the growing load.", None, least.greatest_load_N, "N")
