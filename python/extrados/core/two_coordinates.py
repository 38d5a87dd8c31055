"""Runs of structures of two coordinates in the core: two stacked blocks, a block on a compliant base."""

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from extrados.core.calls import long_call, real
from extrados.core.errors import check, status_code
from extrados.core.ground import Ground, MotionSet
from extrados.core.rocking import OUTCOMES, check_run, events_of, output_times


class Found(NamedTuple):
    """A run. state (points, rows): values at its output times, as the module of the core orders them; counts and measures: numbers
    of the whole run, likewise; common: what of core.rocking.Course both structures give in the same places."""

    state: np.ndarray
    counts: list[int]
    measures: list[float]
    common: dict[str, Any]


def run_two(
    module: Any,
    numbers: np.ndarray,
    what: str,
    ground: Ground,
    end_time: float,
    output_step: float,
    *,
    scale: float,
    tolerance: float,
    start: npt.ArrayLike,
    room: int,
) -> Found:
    """Run the structure of `numbers` (9,) by `module` of the core under `ground` times `scale` until collapse or `end_time` [s].

    what: the structure in errors; start (4,): both coordinates, then their rates; output_step [s]; room: most events that are kept.
    """
    check_run(end_time, output_step, tolerance, scale)
    if not 1 <= room <= 10**7:
        raise ValueError(f"the number of saved events is {room}, expected 1 to 10,000,000")
    rows = int(module.rows())
    times = output_times(end_time, output_step, rows)
    with MotionSet([ground]) as motions:
        counts, measures, state, kinds, event, status = long_call(
            module.history,
            real(what, numbers, (9,)),
            motions.handle,
            1,
            np.array([scale, end_time, tolerance], dtype=float),
            real("start", start, (4,)),
            times,
            rows,
            int(room),
        )
    interrupted = status == status_code("cancelled")
    if not interrupted:
        check(status, f"rocking of {what}")
    outcome, _, _, steps, _, points, events, *_ = counted = [int(k) for k in counts]
    series = state[:, :points].T
    if not (np.isfinite(series).all() and np.isfinite(measures).all()):
        check(status_code("not_finite"), f"rocking of {what}")
    common = {
        "outcome": OUTCOMES[outcome],
        "stop_time": float(measures[2]),
        "steps": steps,
        "time": times[:points],
        **{name: series[:, 4 + k] for k, name in enumerate(("ground", "vertical", "kinetic", "potential", "ledger"))},
        "events": [(kind, when, int(place)) for kind, when, place in events_of(kinds, event, min(events, room))],
        "events_found": events,
        "interrupted": interrupted,
    }
    return Found(series, counted, [float(x) for x in measures], common)
