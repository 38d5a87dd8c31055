"""What the rocking of blocks and arches share: running the history, storing it, saying it in words."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from extrados.analyses.batches import Unfinished
from extrados.analyses.context import Context, Refused
from extrados.analyses.rocking.conditions import astray_of, of_one, told
from extrados.analyses.rocking.course import Course, build_result, impact_times, keep_events, refuse_long_history
from extrados.analyses.rocking.doubts import Doubts, doubts, doubts_on_contacts
from extrados.analyses.rocking.hand_over import contacts_of, follow_contacts, leaving_time, outcome_of, stored
from extrados.analyses.rocking.tables import Rocking
from extrados.core.restraints import LENGTH
from extrados.core.rocking import Body, Response, history
from extrados.results import rocking as out
from extrados.results.fields import given
from extrados.results.model import Array, Result
from extrados.schema.constants import GRAVITY
from extrados.views.rockers.arch import ArchModel
from extrados.views.rockers.block import BlockModel
from extrados.views.rockers.rocker import Rocker

ORDINALS = ("first", "second", "third", "fourth", "fifth", "sixth", "seventh", "eighth", "ninth", "tenth")


def rest_time(rocker: Rocker) -> float:
    """How long after a motion [s] the structure has rocked itself to rest."""
    if isinstance(rocker.model, ArchModel):  # ten of its own long periods suffice
        limits = rocker.model.limits
        return float(20.0 * np.pi * np.sqrt(limits.mass * limits.critical / limits.gravity_moment))
    if isinstance(rocker.model, BlockModel):
        return 30.0 / float(rocker.model.frequency.min())
    return 40.0 * rocker.time_unit


@dataclass(frozen=True)
class Ran:
    """response: of the mechanism, until contacts go on, where they do; fixed: of the mechanism to its end; hand_over: results of the
    rest of the motion on contacts, `run` what is stored of it."""

    response: Response
    fixed: Response
    conditions: out.Conditions
    doubt: Doubts
    hand_over: out.HandOver | None = None
    run: Result | None = None


def rock(context: Context, options: Rocking, rocker: Rocker, end_time: float, width: int) -> Ran:
    """The response of a rocker, on rigid contacts from where a condition of its mechanism fails; width: see run_history."""

    def until(time: float) -> Response:
        return run_history(context, options, rocker.body, time, width, rocker.start_rotation)

    fixed = until(end_time)
    time, contacts = None, None
    if options.hand_over and not fixed.interrupted:
        time = leaving_time(fixed, astray_of(rocker), rocker.time_unit)
    if time is not None:
        contacts = contacts_of(rocker, context.building, options.form == "linear", options.tolerance)
    if contacts is not None and time is not None:
        ground = context.motion.ground
        last = options.end_time if rocker.restraints is None else end_time  # ties keep a structure rocking long
        try:
            contacts = contacts.reached(ground, time)
            run, result = follow_contacts(context, contacts, contacts.begin(ground, time), last, options.output_step)
        except (Refused, Unfinished) as error:
            context.warnings.append(f"The run with rigid contacts, from {time:.3f} s on, gave no result: {error}")
        else:
            response = until(max(time, 1e-9 * rocker.time_unit))
            conditions = of_one(rocker, fixed, handed=True)
            outcome = outcome_of(response.half_cycles > 0, run.outcome)
            over = out.HandOver(
                time_s=time, reason=conditions.violated[0], outcome=outcome, fixed_hinges_outcome=fixed.outcome, contacts=run
            )
            doubt = doubts_on_contacts(context, rocker, contacts, response, over, end_time)
            return Ran(response, fixed, conditions, doubt, over, result)
    return Ran(fixed, fixed, of_one(rocker, fixed), doubts(context, options, rocker, fixed, end_time))


def run_history(context: Context, options: Rocking, body: Body, end_time: float, width: int, start_rotation: float = 0.0) -> Response:
    """The response with its history; `width` is the number of values stored at each output time.

    start_rotation > 0 to +x [rad]. Refused where the history would not fit into memory.
    """
    refuse_long_history(end_time, options.output_step, width)
    settings: dict[str, Any] = {
        "tolerance": options.tolerance,
        "start_side": 1 if start_rotation >= 0.0 else -1,
        "start_rotation": abs(start_rotation),
    }
    return keep_events(lambda room: history(body, context.motion.ground, end_time, options.output_step, room=room, **settings))


def rocking_result(context: Context, ran: Ran, rocker: Rocker, of: str, friction: np.ndarray, **further: Any) -> Result:
    """Results of a structure that rocks as a mechanism; `of` says whose rotation it is.

    friction (times, joints): coefficient of friction needed. further: the results that only this structure has.
    """
    response, doubt, over = ran.response, ran.doubt, ran.hand_over
    energy = response.kinetic + response.potential + response.stored
    course = Course(
        of=of,
        settled=response.settled if over is None else True,  # contacts say themselves that they still move
        moves="the structure still rocks",
        half_cycles=response.half_cycles,
        potential=response.potential,
        energy=energy,
        scale=max(float(np.abs(energy).max(initial=0.0)), abs(response.work), 1e-300),
        lost="the energy lost at impacts, minus the energy absorbed by restraints",
        friction=friction,
        coordinates={"rotation": (response.rotation, "rad"), "rotation_rate": (response.rate, "rad/s")},
        event_value="at peak and collapse: rotation in rad; before an impact: angular velocity in rad/s; at uplift: 1 to +x, -1 to -x",
        chaotic=doubt.chaotic,
        growth=doubt.growth,
        violated=doubt.violated,
    )
    contacts: dict[str, Any] = {}
    if over is not None:
        run = over.contacts
        contacts = {"outcome": over.outcome, "collapse_time_s": run.collapse_time_s, "settled": not run.still_moving}
    result = build_result(
        context,
        response,
        course,
        **contacts,
        impacts=response.impacts,
        peak_rotation_rad=response.peak,
        peak_rotation_ratio=response.peak_ratio,
        energy_lost_at_impacts_J=response.loss,
        rejected_steps=response.rejected,
        conditions=ran.conditions,
        **given(hand_over=over, outcomes_by_rule=doubt.rules or None),
        **_held(rocker, response),
        **further,
    )
    result.warnings += [*told(ran.conditions), *doubt.violated, *doubt.warnings]
    if over is not None and ran.run is not None:
        if ran.run.status != "ok":
            result.status, result.reason = ran.run.status, f"rigid contacts: {ran.run.reason}"
        result.warnings.append(f"From {over.time_s:.3f} s on, the motion of the blocks is calculated with rigid contacts.")
        result.warnings += [text for text in ran.run.warnings if text not in result.warnings]
        result.arrays |= stored(ran.run)
    result.arrays |= {
        "rotation": Array(response.rotation, ("time",), "rad", f"rotation of {of}, positive to +x"),
        "rate": Array(response.rate, ("time",), "rad/s"),
        "acceleration": Array(response.acceleration, ("time",), "rad/s^2"),
        **restraint_arrays(rocker, response),
    }
    return result


def _held(rocker: Rocker, response: Response) -> dict[str, Any]:
    """Results of what holds the structure; none where nothing does."""
    held = rocker.restraints
    if held is None:
        return {}
    found: dict[str, Any] = {"energy_taken_up_J": response.spent}
    wall = [e for e, is_open in zip(held.rebound, held.open_sides, strict=True) if is_open]
    if len(wall) == 1:
        found["rebound"] = wall[0]
    rows = zip(held.members, response.least_force, response.greatest_force, response.permanent, strict=True)
    if held.members:
        found["restraints"] = [
            out.RestraintForces(name=m.name, least_force_N=low, greatest_force_N=high, permanent_elongation_m=stays)
            if m.sort == LENGTH
            else out.RestraintForces(name=m.name, least_moment_Nm=low, greatest_moment_Nm=high, permanent_turn_rad=stays)
            for m, low, high, stays in rows
        ]
    return found


def restraint_arrays(rocker: Rocker, response: Response) -> dict[str, Array]:
    """Forces of what holds the structure over time, and the energy stored in it."""
    if rocker.restraints is None or not rocker.restraints.members:
        return {}
    return {
        "stored": Array(response.stored, ("time",), "J", "energy of ties, springs and added hinges"),
        **{
            f"restraint_{k}": Array(force, ("time",), "N" if m.sort == LENGTH else "N*m", m.name)
            for k, (m, force) in enumerate(zip(rocker.restraints.members, response.forces, strict=True), start=1)
        },
    }


def snapshot_index(response: Response, options: Rocking, warnings: list[str]) -> np.ndarray:
    """Output times at which the structure is drawn: those asked for, or at up to six of the greatest rotations."""
    if not len(response.time):
        return np.zeros(0, dtype=int)
    end = float(response.time[-1])
    asked = [t for t in options.thrust_line_times if 0.0 <= t <= end + options.output_step]
    if len(asked) < len(options.thrust_line_times):
        warnings.append(f"some `thrust_line_times` are later than the end of the run at {end:g} s and are not drawn")
    if not asked:
        peaks = [t for kind, t, _ in response.events if kind in ("peak", "collapse")]
        size = np.abs(np.interp(peaks, response.time, response.rotation)) if peaks else np.zeros(0)
        asked = [peaks[k] for k in np.argsort(-size)[:6]] or [0.0]
    index = np.searchsorted(response.time, np.array(asked) - 1e-9)
    return np.unique(np.clip(index, 0, len(response.time) - 1))


def ordinal(n: int) -> str:
    """first, second, ..., tenth, 11th, 12th, 21st."""
    if n <= len(ORDINALS):
        return ORDINALS[n - 1]
    ending = "th" if n % 100 in (11, 12, 13) else {1: "st", 2: "nd", 3: "rd"}.get(n % 10, "th")
    return f"{n}{ending}"


def count(n: int, thing: str) -> str:
    """1 impact, 2 impacts."""
    return f"{n} {thing}" + ("" if n == 1 else "s")


def answer_of(context: Context, ran: Ran, who: str, falls: str, uplift: float) -> str:
    """The outcome in words, see `answer`; on rigid contacts from where these went on."""
    response, over = ran.response, ran.hand_over
    if over is None or ran.run is None:
        return answer(context, response, who, falls, uplift)
    before = f"rocks ({count(response.impacts, 'impact')})" if response.half_cycles else "rests"
    return (
        f"With rigid contacts: {ran.run.answer} {who} {before} by the assumed mechanism until {over.time_s:.3f} "
        f"s. From then on, the motion of the blocks is calculated with rigid contacts. {over.reason}"
    )


def answer(context: Context, response: Response, who: str, falls: str, uplift: float) -> str:
    """The outcome in words: `who` is "The arch", `falls` what it does at collapse, `uplift` in g."""
    pga = context.motion.peak / GRAVITY
    upward = " (horizontal alone)" if np.any(response.vertical) else ""
    about = f"peak ground acceleration {pga:.3f} g, rocking starts at {uplift:.3f} g{upward}"
    times = impact_times(response)
    way = "+x" if response.peak > 0 else "-x"
    if response.outcome == "collapse":
        if not times:
            after = "without an impact"
        elif len(times) == 1:
            after = f"after one impact at {times[0]:.3f} s"
        else:
            after = f"after {count(response.impacts, 'impact')}, the last at {times[-1]:.3f} s"
        return (
            f"{who} {falls} to {way} in the {ordinal(response.half_cycles)} half cycle {after} (at {response.stop_time:.2f} s "
            f"its rotation can no longer recover; {about})."
        )
    greatest = (
        f"greatest rotation {1e3 * abs(response.peak):.3g} mrad to {way}, {100 * response.peak_ratio:.0f} % of the rotation "
        f"from which gravity causes collapse"
    )
    rocked = f"{count(response.half_cycles, 'half cycle')}, {count(response.impacts, 'impact')}, {greatest} ({about})."
    if not response.settled:
        state = "has not rocked yet" if response.outcome == "no-hinging" else "still rocks"
        return f"{who} {state} when the run ends at {response.stop_time:.2f} s: the outcome is open. So far {rocked}"
    if response.outcome == "no-hinging":
        return f"{who} does not rock and moves with the ground as a rigid body ({about})."
    return f"{who} rocks and recovers: {rocked}"
