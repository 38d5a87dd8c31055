"""Results of sequentially linear analysis."""

from typing import Literal

from extrados.results.fields import ResultModel, fact, maybe
from extrados.results.verdict import Demand, KindResults, Verdict, capacity_alone, judge, judge_acceleration
from extrados.results.verification import Verification
from extrados.schema.quantities import three_figures

#: How the names of arrays begin that belong to the first sense of the load, and to the second
PREFIXES = ("", "minus_")
#: Part of the peak to which the load drops at the ultimate displacement
DROP = 0.8


class Bilinear(ResultModel):
    """Elastic-plastic idealisation of the envelope, of equal area."""

    stiffness_N_m: float = fact("secant stiffness at 60 % of the peak load", "N/m")
    yield_load_N: float = fact("load of the plateau", "N")
    yield_displacement_m: float = fact("displacement at the start of the plateau", "m")
    ultimate_displacement_m: float = fact(
        "ultimate displacement: displacement at which the load has decreased to 80 % of the peak, "
        "or the last displacement if the decrease is smaller",
        "m",
    )
    ductility: float = fact("ductility: ultimate displacement divided by yield displacement")


class Makeup(ResultModel):
    """Fingerprints of what a stored damage rests on; a run goes on from another with the same ones alone."""

    stiffness: str = fact("checksum of the elastic data: moduli, Poisson's ratios, thicknesses and elements")
    tension: str = fact("checksum of the tensile laws: teeth of their saw-tooth curves, and crack bands")
    compression: str = fact("checksum of the crushing laws: teeth of their saw-tooth curves, and crack bands")
    cracking: str = fact("checksum of the options for cracking")


class BarForce(ResultModel):
    """What a bar of the wall, or one of [[ties]], bears; tension is positive."""

    name: str = fact("name of the bar; bars of the wall have numbers as names")
    force_at_greatest_load_N: float | None = fact(
        "force of the bar at the greatest load in equilibrium; for an embedded bar, the greatest force "
        "of its sections; null if this state was not saved",
        "N",
    )
    last_force_N: float | None = fact("force of the bar in the last state; for an embedded bar, the greatest force of its sections", "N")
    greatest_force_N: float | None = maybe(
        "greatest force in absolute value over all equilibrium states, for a bar that is attached only at its ends", "N"
    )
    state: Literal["slack", "carries", "yielded"] = fact(
        "state of the bar at the end. slack: no force; carries: loaded, strength not reached; yielded: "
        "strength reached at one point or more"
    )


class SlaCurve(ResultModel):
    """The events of one sense of the load."""

    sense: Literal["+", "-"] = fact("sense of the reference loads")
    peak_load_N: float | None = fact(
        "peak load: greatest load in equilibrium, after which the load decreases or a mechanism forms; null without a peak", "N"
    )
    peak_displacement_m: float | None = fact("control displacement at the peak", "m")
    displacement_of_constant_loads_m: float = fact("control displacement under the constant loads only", "m")
    peak_event: int | None = fact("number of the event at the peak load, counted from 1")
    greatest_load_N: float | None = fact("greatest load in all equilibrium states, with or without a peak; null without such a state", "N")
    greatest_load_displacement_m: float | None = fact("control displacement at the greatest load", "m")
    greatest_load_event: int | None = fact("number of the event at the greatest load, counted from 1")
    first_event_load_N: float | None = fact("load of the first event", "N")
    events: int = fact("number of events of this run")
    events_before_resume: int = fact("number of events in the earlier runs that this run continues")
    events_without_equilibrium: int = fact(
        "number of events for which no load multiplier satisfies the strengths at every integration point"
    )
    events_out_of_reach: int = fact(
        "number of events that are not valid states: a displacement exceeds 1/10 of the size of the "
        "structure, or a load exceeds ten times the peak load"
    )
    first_event_without_equilibrium: int | None = fact("number of the first event without equilibrium, counted from 1")
    stop: str = fact("why the run ended")
    secondary_cracks: int = fact("number of events with a second crack at a point")
    damaged_points: int = fact("number of integration points that cracked")
    closings: int = fact("number of events in which a crack closed")
    crushing_events: int = fact("number of crushing events")
    last_load_N: float | None = fact("load of the last event that is in equilibrium", "N")
    last_displacement_m: float | None = fact("control displacement of the last event that is in equilibrium", "m")
    energy_residual_ratio: float = fact("error of the energy balance, divided by the work of the loads")
    external_work_J: float | None = fact(
        "work of all loads up to the last event in equilibrium, calculated with linear changes of displacement between events", "J"
    )
    stored_energy_J: float | None = fact("elastic energy at the last event in equilibrium", "J")
    dissipated_energy_J: float | None = fact(
        "dissipated energy (with friction) up to the last event in equilibrium; it never decreases. It is the work of the loads minus "
        "the stored energy, summed from one equilibrium state to the next. For events without equilibrium, the area of their "
        "saw-tooth teeth is added",
        "J",
    )
    crack_energy_J: float = fact(
        "crack energy: area of the saw-tooth teeth that were passed at cracks and joints, in all events. "
        "It depends on the material laws only (fracture energy). Friction and energy lost between "
        "states are not included, so it can differ from `dissipated_energy_J`",
        "J",
    )
    residual_ratio: float | None = fact("greatest measured residual of the equations; null if it was not measured")
    guard_checks: int = fact("number of times that the residual was measured during the run")
    guard_resolutions: int = fact("number of times that the equations were solved again because of the residual")
    guard_new_factors: int = fact("number of times that the matrix was factorised again because of the residual")
    equilibrium_steps: int = maybe("number of steps with equilibrium iterations, used after equilibrium was lost under the constant loads")
    staggered_steps: int = maybe(
        "number of steps with equilibrium iterations in which damage was frozen and updated in turn, "
        "because Newton's method did not converge"
    )
    unbalanced_steps: int = maybe(
        "number of steps with equilibrium iterations whose residual exceeds the tolerance; they are not equilibrium states"
    )
    equilibrium_solutions: int = maybe("number of linear systems solved in the steps with equilibrium iterations")
    equilibrium_from_m: float = maybe("control displacement at which the equilibrium iterations began", "m")
    step_residual_ratio: float = maybe(
        "residual divided by the greatest nodal force of an element: greatest value of all states in steps with equilibrium iterations"
    )
    step_balance_ratio: float = maybe(
        "error of the energy balance (work of all loads minus stored and dissipated energy) divided by "
        "the work: greatest value of all states in steps with equilibrium iterations"
    )
    released_energy_J: float = maybe(
        "energy released as motion when the load drops to another equilibrium, in the steps with "
        "equilibrium iterations; part of `dissipated_energy_J`",
        "J",
    )
    drift_height_m: float = maybe(
        "length to which drifts refer: extent of the structure perpendicular to the control displacement (for a wall, its height)", "m"
    )
    peak_drift: float | None = maybe("drift at the peak")
    drop_displacement_m: float | None = maybe(
        "control displacement at which the envelope of the load has decreased to 80 % of the peak; null if not reached", "m"
    )
    drop_drift: float | None = maybe("drift at `drop_displacement_m`")
    axial_loss_displacement_m: float | None = maybe(
        "last control displacement at which the constant loads are still carried; null if they are carried to the end", "m"
    )
    axial_loss_drift: float | None = maybe("drift at `axial_loss_displacement_m`")
    seconds_per_event: float = fact("computing time of an event", "s")
    events_of_constant_loads: int = fact("number of events during the application of the constant loads")
    probe_loads_N: list[float | None] = maybe(
        "load of the envelope at the displacements given in the deck; null beyond the end of the envelope", "N"
    )
    initial_stiffness_N_m: float = maybe(
        "stiffness before the first event; not given for a stage that begins with equilibrium iterations", "N/m"
    )
    peak_acceleration_g: float | None = maybe("peak load as a horizontal acceleration, if the load is an acceleration of the masses", "g")
    greatest_acceleration_g: float | None = maybe(
        "greatest load as a horizontal acceleration, if the load is an acceleration of the masses", "g"
    )
    bars: list[BarForce] = maybe("forces of bars and ties")
    bilinear: Bilinear = maybe("bilinear idealisation of the envelope of the load; given if the envelope rises and has passed its peak")


class SlaStage(SlaCurve):
    """One stage of several; loads are those in the direction of its own, with what stages before have left on."""

    name: str = fact("name or number of the stage")
    prefix: str = fact("prefix of the array names of this stage; empty for the stage that gives the results of the analysis")
    start_load_N: float = fact("load at the start of the stage", "N")
    end_load_N: float | None = fact("load at the end of the stage", "N")


class Scatter(ResultModel):
    """Repetitions with other seeds of mesh and strength."""

    seeds: list[int] = fact("the seeds")
    peak_loads_N: list[float] = fact("peak load with each seed", "N")
    mean_N: float = fact("mean of the peak loads", "N")
    coefficient_of_variation: float | None = fact("coefficient of variation of the peak loads; null for a single seed")
    lowest_N: float = fact("lowest peak load", "N")
    highest_N: float = fact("highest peak load", "N")


class Comparison(ResultModel):
    """The envelope over the mean of a measured curve."""

    peak_ratio: float = fact("greatest calculated load, divided by the greatest measured load")
    tail_ratios: list[float | None] = fact(
        "calculated load divided by measured load, after the peak: at the displacements at which the measured load is 75, 50 and 25 "
        "% of its peak; null if one of the curves ends before"
    )
    inside_ratio: float | None = fact(
        "share of the measured points at which the calculated envelope lies between the least and the greatest measured load"
    )
    half_band_ratio: float = fact(
        "half of the distance between the least and the greatest measured load, divided by their mean; averaged over the measured displacements"
    )


class Sla(SlaCurve, KindResults):
    """sla: cracks event by event under constant loads and growing ones; the curve of the first sense, and of both."""

    reference_load_N: float = fact("reference load: the load at multiplier 1", "N")
    cracking: Literal["rotating", "orthotropic", "isotropic"] = fact("model of cracked material")
    teeth: list[int] = fact("least and greatest number of teeth of a saw-tooth law")
    nodes: int = fact("nodes of the mesh")
    elements: int = fact("elements of the mesh")
    equations: int = fact("equations")
    points: int = fact("number of integration points, including those of bars")
    makeup: Makeup = maybe("values that resume_from compares")
    minus: SlaCurve = maybe("capacity curve under the load in the opposite direction")
    stages: list[SlaStage] = maybe(
        "for a run in stages: results of each stage. If the deck names no stage, the results of the "
        "analysis are those of the last or main stage"
    )
    measured: Comparison = maybe("measured curve of the deck, compared with the calculated curve in the first direction of the load")
    scatter: Scatter = maybe("repetitions with other seeds")
    verification: Verification = maybe(
        "displacement-based verification of a wall that is loaded by the horizontal forces of its own masses"
    )
    stones: bool = fact(
        "whether the model consists of blocks with joints; the greatest load, as an acceleration, is then a static limit load"
    )
    hinges: list[str] = maybe(
        "for blocks: hinges at the peak load (joints that are open on more than 90 % of their length, by "
        "more than 1/10 of the greatest opening)"
    )

    def judged(self, demand: Demand) -> Verdict:
        """The lesser peak of the two senses: an acceleration [g], or a load [N] that the deck does not ask for."""
        curves = [c for c in (self, self.minus) if c is not None]
        if any(c.greatest_load_N is None for c in curves):
            text = f"No equilibrium state with a load was found. Reason for the end of the run: {self.stop}."
            return judge(text, None, None, "N", "open" if self.stones and demand.peak_g is not None else None)
        least = min(curves, key=lambda c: c.greatest_load_N or 0.0)
        reached, load = least.greatest_acceleration_g, f"{three_figures((least.greatest_load_N or 0.0) / 1e3)} kN"
        if reached is not None and not self.stones:
            peaks = least.peak_load_N is not None
            if self.verification is not None and self.verification.decides:
                return self.verification.judged(f"The greatest base shear is {load}.")
            text = f"The wall {('can carry' if peaks else 'carries at least')} {load} ({abs(reached):.3g} g times its masses)."
            return capacity_alone(text, abs(reached), "g", None if peaks else "lower")
        if any(c.peak_load_N is None for c in curves):
            text = f"The load has reached {load}, and the run ended before it decreased, so the capacity of the building is not known"
            if reached is None or demand.peak_g is None:
                return judge(f"{text}.", None, None, "N" if reached is None else "g")
            if demand.peak_g < reached:
                return judge_acceleration(reached, demand)
            return judge(
                f"{text}. The demand of the motion is {demand.peak_g:.3g} g; the load has reached {reached:.3g} g.",
                demand.peak_g,
                None,
                "g",
                "open",
            )
        if reached is not None:
            return judge_acceleration(abs(reached), demand)
        return judge(f"The peak of the increasing load is {load}. This is the capacity of the building.", None, least.greatest_load_N, "N")
