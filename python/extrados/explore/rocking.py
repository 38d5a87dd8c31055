"""Rocking on the page: the history with its shapes, the map of pulses that cause collapse, the primary impulse."""

import time
from collections.abc import Iterator
from typing import Any, Literal

import numpy as np

from extrados.analyses.conclude import MotionDemand
from extrados.analyses.context import Context, Refused
from extrados.analyses.rocking.conditions import Counted, astray_of, of_many, of_one, told
from extrados.analyses.rocking.failure_domain import MODE_I, Mapper, natural_durations
from extrados.analyses.rocking.history import answer, rest_time, run_history
from extrados.analyses.rocking.shapes import States, shapes
from extrados.analyses.rocking.tables import Assessment, FailureDomain, Rocking
from extrados.analyses.sequence import run_one
from extrados.model.geometry.assembly import Assembly
from extrados.motions.motion import Motion
from extrados.schema.constants import GRAVITY
from extrados.views.building import Building
from extrados.views.rockers.stack import rocks_as_stack

#: Pictures of a history, and points of its curves
MOST_PICTURES, MOST_POINTS = 600, 1600
#: Times at which a history is known
MOST_OUTPUTS = 20_000
#: What each round of the map adds: every 4th, every 2nd, every cell
STRIDES = (4, 2, 1)
#: Cells of the map that are run at once to begin with, and on a compliant base, where each takes long; how long those run
#: at once may take [s], and how fast their number may grow
CELLS, FEW, PATIENCE, GROWTH = 100, 4, 0.06, 4.0
#: Shares of the sampling at which a motion is drawn
CURVE = 1200


def history(
    context: Context, building: Building, options: Rocking, anchor: np.ndarray, still: bool
) -> tuple[dict[str, Any], dict[str, np.ndarray]]:
    """Words and arrays of a response; `still`: without shapes, as where a hand only looks for an amplitude."""
    if rocks_as_stack(building) or building.supports.stiffness is not None:
        return _in_two(context, building, options, anchor)
    rocker = building.rocker(options.form == "linear")
    motion = context.motion
    end = options.end_time or motion.end + rest_time(rocker)
    fine = options.model_copy(update={"output_step": max(options.output_step, end / MOST_OUTPUTS)})
    response = run_history(context, fine, rocker.body, end, 12, rocker.start_rotation)
    conditions = of_one(rocker, response)
    words: dict[str, Any] = {
        "outcome": response.outcome,
        "settled": response.settled,
        "half_cycles": response.half_cycles,
        "impacts": response.impacts,
        "impact_times_s": [t for kind, t, _ in response.events if kind == "impact"][:400],
        "peak_rotation_rad": response.peak,
        "peak_rotation_ratio": response.peak_ratio,
        "critical_rad": list(rocker.critical),
        "uplift_g": rocker.uplift,
        "restitution": rocker.restitution,
        "peak_ground_g": motion.peak / GRAVITY,
        "stop_time_s": response.stop_time,
        "end_time_s": end,
        "word": rocker.word,
        "answer": answer(context, response, f"The {rocker.word}", "collapses", rocker.uplift),
        "violated": conditions.violated,
        "warnings": [*told(conditions), *rocker.warnings, *motion.notes],
    }
    moving = np.flatnonzero(response.rotation)
    last = float(response.time[moving[-1]]) if len(moving) else 0.0
    words["active_s"] = min(max(1.05 * last, 1.2 * min(motion.end, end)), float(response.time[-1]) if len(response.time) else end)
    shown = min(int(np.searchsorted(response.time, words["active_s"])) + 1, len(response.time))
    keep = slice(0, shown, max(1, -(-shown // MOST_POINTS)))
    arrays = {
        "time": response.time[keep],
        "rotation": response.rotation[keep],
        "ground": response.ground[keep] / GRAVITY,
        "kinetic": response.kinetic[keep],
        "potential": response.potential[keep],
        "ledger": response.ledger[keep],
    }
    if still or not len(response.time):
        return words, arrays
    index = np.arange(0, shown, max(1, -(-shown // MOST_PICTURES)))
    states = States(*(getattr(response, k)[index] for k in ("rotation", "rate", "acceleration", "ground", "vertical")))
    made = shapes(rocker, states)
    arrays["picture_time"] = response.time[index]
    arrays["pose"] = made.pose - np.append(anchor, 0.0)
    if made.line is not None:
        arrays["line"] = made.line - anchor
    if made.friction is not None:
        arrays["friction"] = made.friction
    if building.structure is not None and building.structure.rocks_as == "piers":
        piers = building.pier_blocks()
        block = getattr(rocker.model, "block", None)
        if block is not None:  # a wall without openings, whose own place is about its foot
            foot = np.append(piers.centroid[0] - block.centroid[0], 0.0)
            arrays["pose"] = arrays["pose"] + foot
            if "line" in arrays:
                arrays["line"] = arrays["line"] + foot[:2]
        arrays |= _outlines(piers, anchor)
    return words, arrays


def _outlines(piers: Assembly, anchor: np.ndarray) -> dict[str, np.ndarray]:
    """The piers that a wall rocks by, in place of its stones."""
    return {
        "moving_outline": np.concatenate(piers.outlines) - anchor,
        "moving_start": np.cumsum([0, *map(len, piers.outlines)]),
        "moving_centroid": piers.centroid - anchor,
    }


def _in_two(context: Context, building: Building, options: Rocking, anchor: np.ndarray) -> tuple[dict[str, Any], dict[str, np.ndarray]]:
    """What rocks in two coordinates, by the analysis itself: stacked blocks, and a block on a compliant base."""
    result = run_one(context, options.model_copy(update={"animation": "gif"}), building)
    if result.status != "ok":
        raise Refused(result.reason)
    r: Any = result.results
    get = {name: array.numbers for name, array in result.arrays.items()}
    time = get["time"]
    moving = np.flatnonzero(np.abs(get["rotation"]) > 1e-3 * np.abs(get["rotation"]).max(initial=0.0))
    end = float(time[-1]) if len(time) else 1.0
    words: dict[str, Any] = {
        "outcome": r.outcome,
        "settled": r.settled,
        "half_cycles": r.half_cycles,
        "impacts": r.impacts,
        "impact_times_s": get["impact_time"].tolist()[:400],
        "peak_rotation_rad": r.peak_rotation_rad,
        "peak_rotation_ratio": r.peak_rotation_ratio,
        "critical_rad": [r.critical_rotation_rad] * 2,
        "uplift_g": r.uplift_acceleration_g,
        "restitution": r.restitution,
        "peak_ground_g": r.peak_ground_acceleration_g,
        "stop_time_s": end,
        "end_time_s": end,
        "word": building.require_structure().word,
        "answer": result.answer,
        "violated": r.judged(MotionDemand(context)).violated,
        "warnings": result.warnings,
        "active_s": min(1.05 * float(time[moving[-1]]), end) if len(moving) else end,
    }
    keep = slice(0, None, max(1, -(-len(time) // MOST_POINTS)))
    arrays = {name: get[name][keep] for name in ("time", "rotation", "kinetic", "potential", "ledger")}
    arrays["ground"] = get["ground"][keep] / GRAVITY
    if "rotation_upper" in get:
        arrays["rotation_upper"] = get["rotation_upper"][keep]
    if "film_time" in get:
        arrays |= {"picture_time": get["film_time"], "pose": get["film_pose"] - np.append(anchor, 0.0)}
    return words, arrays


def curve(motion: Motion) -> dict[str, np.ndarray]:
    """A motion as it is drawn: time [s] and acceleration [g]."""
    time = np.linspace(0.0, motion.end * 1.02, CURVE)
    return {"motion_time": time, "motion": motion.sample(time) / GRAVITY}


def impulse(context: Context, building: Building) -> dict[str, Any]:
    """The primary impulse of the motion, and whether Eq. 5.8 takes it for strong enough."""
    options = Assessment(kind="assessment")
    result = run_one(context, options, building)
    if result.status != "ok":
        return {"refused": result.reason}
    found: dict[str, Any] = result.results.as_json()
    return {
        "answer": result.answer,
        "numbers": {k: v for k, v in found.items() if not isinstance(v, dict | list)},
        "impulses": found.get("impulses", []),
    }


def domain(context: Context, building: Building, options: FailureDomain) -> Iterator[tuple[dict[str, Any], dict[str, np.ndarray]]]:
    """The map of pulses, coarse first: codes (durations, amplitudes), 255 where nothing has been run yet.

    `part` tells a reply amid a round, for structures that take long: so that a hand is answered between. It shows the round
    before once more, the first as far as it is.
    """
    rocker = building.rocker(options.form == "linear", soft_base=True)
    unit = float(np.sqrt(rocker.scale / GRAVITY))
    durations = np.array(options.durations) if options.durations else natural_durations(unit, options.pulse)
    amplitudes = np.linspace(0.0, options.max_amplitude, options.amplitudes + 1)[1:]
    mapper = Mapper(
        rocker.body, options.pulse, durations.tolist(), 40.0 * unit, context.threads, rocker.start_rotation, astray=astray_of(rocker)
    )
    seen: list[dict[str, np.ndarray]] = []
    codes = np.full((len(durations), len(amplitudes)), 255, dtype=np.uint8)
    words: dict[str, Any] = {
        "pulse": options.pulse,
        "conditions": [],
        "uplift_g": rocker.uplift,
        "mode_I": MODE_I,
        "word": rocker.word,
        "outcomes": ["does not rock", "recovers", "collapses after an impact (Mode I)", "collapses in the first half cycle (Mode II)"],
    }
    axes = {"duration": durations, "amplitude": amplitudes / GRAVITY}
    drawn, count = (STRIDES[0], codes), CELLS if building.supports.stiffness is None else FEW
    last = time.perf_counter()
    for stride in STRIDES:
        half = stride // 2
        chosen = np.zeros(codes.shape, dtype=bool)
        chosen[half::stride, half::stride] = True
        i, k = np.nonzero(chosen & (codes == 255))
        mixed = np.random.default_rng(1).permutation(len(i))  # weak pulses take no time, strong ones long
        i, k = i[mixed], k[mixed]
        done = 0
        while done < len(i):
            begin, part = time.perf_counter(), slice(done, done + count)
            seen.append(mapper.rows(i[part], amplitudes[k[part]]))
            codes[i[part], k[part]] = seen[-1]["code"]
            done += count
            now = time.perf_counter()
            count = max(1, int(count * min(GROWTH, PATIENCE / max(now - begin, 1e-9))))
            if now - last > PATIENCE and done < len(i):
                yield {**words, "stride": drawn[0], "whole": False, "part": True}, {**axes, "codes": drawn[1].copy()}
                last = time.perf_counter()
        words["conditions"] = told(of_many(rocker, Counted.of(seen), "pulses of the map")["conditions"])
        drawn = stride, codes.copy()
        yield {**words, "stride": stride, "whole": stride == 1, "part": False}, {**axes, "codes": drawn[1]}
        last = time.perf_counter()


def pulse_of(motion: Any) -> dict[str, float] | None:
    """Duration [s] and amplitude [g] of a motion table that is a pulse of the map, as a dot on it."""
    if motion is None or motion.kind not in ("step-pulse", "sine-pulse"):
        return None
    length = motion.duration if motion.kind == "step-pulse" else motion.period
    return {"duration_s": length, "amplitude_g": abs(motion.amplitude) / GRAVITY}


def domain_options(kind: str | None, asked: FailureDomain | None, uplift: float) -> FailureDomain:
    """The map that is drawn: the deck's, else 40 by 40 cells of the motion's sort of pulse, high enough to show it fall."""
    if asked is not None:
        return asked
    pulse: Literal["sine", "step"] = "sine" if kind == "sine-pulse" else "step"
    return FailureDomain(kind="failure-domain", pulse=pulse, max_amplitude=f"{max(1.5, 6.0 * uplift):.4g} g")
