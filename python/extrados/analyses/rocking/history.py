"""What the rocking of blocks and arches share: running the history, storing it, saying it in words."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from extrados.analyses.batches import Unfinished
from extrados.analyses.context import Context, Refused
from extrados.analyses.rocking.conditions import astray_of, of_one, told
from extrados.analyses.rocking.doubts import Doubts, doubts, doubts_on_contacts
from extrados.analyses.rocking.hand_over import contacts_of, follow_contacts, leaving_time, outcome_of, stored
from extrados.analyses.rocking.tables import Rocking
from extrados.core.restraints import LENGTH
from extrados.core.rocking import Body, Response, history
from extrados.results import rocking as out
from extrados.results.fields import given
from extrados.results.model import Array, Result, TableData
from extrados.schema.constants import GRAVITY
from extrados.views.rockers.arch import ArchModel
from extrados.views.rockers.block import BlockModel
from extrados.views.rockers.rocker import Rocker

#: Numbers a history may hold in all: output times times the values at each.
LARGEST = 20_000_000
ROOM = 20_000
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
    time = leaving_time(fixed, astray_of(rocker), rocker.time_unit) if options.hand_over and not fixed.interrupted else None
    contacts = None
    if time is not None:
        contacts = contacts_of(rocker, context.building, options.form == "linear", options.tolerance)
    if contacts is not None and time is not None:
        ground = context.motion.ground
        try:
            run, result = follow_contacts(context, contacts, contacts.begin(ground, time), options.end_time, options.output_step)
        except (Refused, Unfinished) as error:
            context.warnings.append(f"Rigid contacts gave no result from {time:.3f} s: {error}")
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
    if end_time / options.output_step * width > LARGEST:
        least = end_time * width / LARGEST
        raise Refused(
            f"a history of {end_time:g} s in steps of {options.output_step:g} s is too long to store; "
            f"the least output_step that fits is {least:.2g} s",
            ("analysis", "output_step"),
        )
    settings: dict[str, Any] = {
        "tolerance": options.tolerance,
        "start_side": 1 if start_rotation >= 0.0 else -1,
        "start_rotation": abs(start_rotation),
    }
    room = ROOM
    while True:
        response = history(body, context.motion.ground, end_time, options.output_step, room=room, **settings)
        if response.events_found <= room or response.interrupted:
            return response
        room = response.events_found


def rocking_result(context: Context, ran: Ran, rocker: Rocker, of: str, friction: np.ndarray, **further: Any) -> Result:
    """Results, tables and arrays that every rocking structure has; `of` says whose rotation it is.

    friction (times, joints): coefficient of friction needed. further: the results that only this structure has.
    """
    response, doubt, over = ran.response, ran.doubt, ran.hand_over
    impacts = [(t, v) for kind, t, v in response.events if kind == "impact"]
    collapse = response.outcome == "collapse"
    energy = response.kinetic + response.potential + response.stored
    scale = max(float(np.abs(energy).max(initial=0.0)), abs(response.work), 1e-300)
    result = Result("rocking", status="interrupted" if response.interrupted else "ok")
    result.reason = f"interrupted at {response.stop_time:.3f} s" if response.interrupted else ""
    if response.events_found > len(response.events):
        result.warnings.append(f"only the first {len(response.events)} of {response.events_found} events are kept")
    if over is not None and ran.run is not None and ran.run.status != "ok":
        result.status, result.reason = ran.run.status, f"rigid contacts: {ran.run.reason}"
    settled = response.settled if over is None else not over.contacts.still_moving
    if not settled and not response.interrupted:
        result.warnings.append(
            f"the structure still rocks at the end time of {response.stop_time:g} s: the outcome is open, set a longer end_time"
        )
    r = out.Rocking(
        rotation_of=of,
        outcome=response.outcome if over is None else over.outcome,
        settled=settled,
        collapse_half_cycle=response.half_cycles if collapse else None,
        collapse_time_s=over.contacts.collapse_time_s if over else response.stop_time if collapse else None,
        half_cycles=response.half_cycles,
        impacts=response.impacts,
        impact_times_s=[t for t, _ in impacts],
        peak_rotation_rad=response.peak,
        peak_rotation_ratio=response.peak_ratio,
        peak_ground_acceleration_g=context.motion.peak / GRAVITY,
        energy_supplied_J=response.work,
        energy_lost_at_impacts_J=response.loss,
        energy_residual_ratio=float(np.abs(energy - energy[:1] - response.ledger).max(initial=0.0)) / scale,
        steps=response.steps,
        rejected_steps=response.rejected,
        decided_by_last_digits=doubt.chaotic,
        perturbation_growth=doubt.growth,
        conditions=ran.conditions,
        **given(hand_over=over, outcomes_by_rule=doubt.rules or None),
        violated=doubt.violated,
        **_held(rocker, response),
        **further,
    )
    result.results = r
    result.warnings += [*told(r.conditions), *r.violated, *doubt.warnings]
    if over is not None and ran.run is not None:
        result.warnings.append(f"Rigid contacts follow the blocks from {over.time_s:.3f} s on.")
        result.warnings += [text for text in ran.run.warnings if text not in result.warnings]
    result.tables["rocking"] = TableData(
        {
            "time": response.time,
            "rotation": response.rotation,
            "rotation_rate": response.rate,
            "ground_acceleration": response.ground,
            "vertical_acceleration": response.vertical,
            "kinetic_energy": response.kinetic,
            "potential_energy": response.potential,
            "energy_supplied_less_lost": response.ledger,
            "required_friction": friction.max(axis=1) if len(friction) else np.zeros(0),
        },
        {
            "time": "s",
            "rotation": "rad",
            "rotation_rate": "rad/s",
            "ground_acceleration": "m/s^2",
            "vertical_acceleration": "m/s^2",
            "kinetic_energy": "J",
            "potential_energy": "J",
            "energy_supplied_less_lost": "J",
        },
    )
    result.tables["rocking_events"] = TableData(
        {
            "event": [kind for kind, _, _ in response.events],
            "time": np.array([t for _, t, _ in response.events]),
            "value": np.array([v for _, _, v in response.events]),
        },
        {"time": "s", "value": "rad at peak and collapse; rad/s before impact; side at uplift"},
    )
    result.arrays = {
        "time": Array(response.time, ("time",), "s", "output times"),
        "rotation": Array(response.rotation, ("time",), "rad", f"rotation of {of}, positive to +x"),
        "rate": Array(response.rate, ("time",), "rad/s"),
        "acceleration": Array(response.acceleration, ("time",), "rad/s^2"),
        "ground": Array(response.ground, ("time",), "m/s^2", "horizontal ground acceleration"),
        "vertical": Array(response.vertical, ("time",), "m/s^2", "vertical ground acceleration"),
        "kinetic": Array(response.kinetic, ("time",), "J"),
        "potential": Array(response.potential, ("time",), "J"),
        "ledger": Array(
            response.ledger,
            ("time",),
            "J",
            "work done by the ground motion, minus the energy lost at impacts, minus the energy absorbed by restraints",
        ),
        "impact_time": Array(np.array([t for t, _ in impacts]), ("impact",), "s"),
        "required_friction": Array(friction, ("time", "joint"), "", "coefficient of friction needed"),
        **restraint_arrays(rocker, response),
        **({} if ran.run is None else stored(ran.run)),
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
        warnings.append(f"some thrust_line_times lie outside the run of {end:g} s and are not drawn")
    if not asked:
        peaks = [t for kind, t, _ in response.events if kind in ("peak", "collapse")]
        size = np.abs(np.interp(peaks, response.time, response.rotation)) if peaks else np.zeros(0)
        asked = [peaks[k] for k in np.argsort(-size)[:6]] or [0.0]
    index = np.searchsorted(response.time, np.array(asked) - 1e-9)
    return np.unique(np.clip(index, 0, len(response.time) - 1))


def drawn_times(time: np.ndarray, rotations: np.ndarray, options: Rocking) -> np.ndarray:
    """Output times at which several coordinates (coordinates, times) are drawn: those asked for, or up to six crests."""
    if not len(time):
        return np.zeros(0, dtype=int)
    if options.thrust_line_times:
        return np.unique(np.clip(np.searchsorted(time, options.thrust_line_times), 0, len(time) - 1))
    crests: list[int] = [k for q in np.abs(rotations) for k in (np.flatnonzero((q[1:-1] >= q[:-2]) & (q[1:-1] > q[2:])) + 1).tolist()]
    size = np.abs(rotations).max(axis=0)
    chosen = sorted(dict.fromkeys([*crests, int(size.argmax())]), key=lambda k: -size[k])[:6]
    return np.array(sorted(chosen))


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
        f"By rigid contacts: {ran.run.answer} {who} {before} by the assumed mechanism until {over.time_s:.3f} s, from when on contacts "
        f"follow the blocks. {over.reason}"
    )


def answer(context: Context, response: Response, who: str, falls: str, uplift: float) -> str:
    """The outcome in words: `who` is "The arch", `falls` what it does at collapse, `uplift` in g."""
    pga = context.motion.peak / GRAVITY
    upward = " (horizontal alone)" if np.any(response.vertical) else ""
    about = f"peak ground acceleration {pga:.3f} g, rocking starts at {uplift:.3f} g{upward}"
    times = [t for kind, t, _ in response.events if kind == "impact"]
    way = "+x" if response.peak > 0 else "-x"
    if response.outcome == "collapse":
        if not times:
            after = "without an impact"
        elif len(times) == 1:
            after = f"after one impact at {times[0]:.3f} s"
        else:
            after = f"after {count(response.impacts, 'impact')}, the last at {times[-1]:.3f} s"
        return (
            f"{who} {falls} to {way} in the {ordinal(response.half_cycles)} half cycle {after} (at "
            f"{response.stop_time:.2f} s its rotation is past recovery; {about})."
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
        return f"{who} does not rock: {about}; it moves with the ground as a rigid body."
    return f"{who} rocks and recovers: {rocked}"
