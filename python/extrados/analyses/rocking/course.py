"""The course of a rocking motion: kept whole, and built into results, for mechanisms, stacked blocks and compliant bases alike."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, TypeVar

import numpy as np

from extrados.analyses.context import Context, Refused
from extrados.core import rocking
from extrados.results import rocking as out
from extrados.results.model import Array, Result, TableData
from extrados.schema.constants import GRAVITY

#: Numbers that a history may hold: output times times the values at each
LARGEST = 20_000_000
#: Events that a first run keeps
ROOM = 20_000


R = TypeVar("R", bound=rocking.Course)


@dataclass(frozen=True, kw_only=True)
class Course:
    """Values of a response that depend on the structure.

    of: body to which the rotation belongs; settled: whether the structure rests or has collapsed, else `moves` says in the warning
    what still moves; potential, energy: potential energy, and energy of the motion in all [J]; scale: energy to which the residual of the balance refers [J]; lost: sinks of energy
    that the balance subtracts from the work of the ground; friction: coefficients needed (times, joints); coordinates, further:
    columns of the table before and after accelerations and energies, with their units; event_value: meaning of the value of an
    event; chaotic, growth: of perturbed motions; violated: assumptions that do not hold.
    """

    of: str
    settled: bool
    moves: str
    half_cycles: int
    potential: np.ndarray
    energy: np.ndarray
    scale: float
    lost: str
    friction: np.ndarray
    coordinates: dict[str, tuple[np.ndarray, str]]
    further: dict[str, tuple[np.ndarray, str]] = field(default_factory=dict)
    event_value: str
    chaotic: bool
    growth: float
    violated: list[str]


def refuse_long_history(end_time: float, output_step: float, width: int) -> None:
    """Refused where a history of `width` values at each output time would not fit into memory; end_time, output_step [s]."""
    if end_time / output_step * width > LARGEST:
        least = end_time * width / LARGEST
        raise Refused(
            f"a history of {end_time:g} s in steps of {output_step:g} s is too long to store: give an "
            f"`output_step` of at least {least:.2g} s",
            ("analysis", "output_step"),
        )


def keep_events(rock: Callable[[int], R]) -> R:
    """The response with all its events; rock(room) keeps `room` of them."""
    room = ROOM
    while True:
        response = rock(room)
        if response.events_found <= room or response.interrupted:
            return response
        room = response.events_found


def impact_times(r: rocking.Course) -> list[float]:
    """Times of the impacts [s]."""
    return [t for kind, t, _ in r.events if kind == "impact"]


def build_result(context: Context, r: rocking.Course, course: Course, **further: Any) -> Result:
    """Results, tables and arrays that every rocking structure has; further: results of this structure, before those of all."""
    fell = r.outcome == "collapse"
    result = Result("rocking", status="interrupted" if r.interrupted else "ok")
    result.reason = f"interrupted at {r.stop_time:.3f} s" if r.interrupted else ""
    if r.events_found > len(r.events):
        result.warnings.append(f"only the first {len(r.events)} of {r.events_found} events are saved")
    if not course.settled and not r.interrupted:
        result.warnings.append(f"{course.moves} at the end time of {r.stop_time:g} s, so the outcome is open: give a later `end_time`")
    results = {
        "rotation_of": course.of,
        "outcome": r.outcome,
        "settled": course.settled,
        "collapse_half_cycle": course.half_cycles if fell else None,
        "collapse_time_s": r.stop_time if fell else None,
        "half_cycles": course.half_cycles,
        "impact_times_s": impact_times(r),
        "peak_ground_acceleration_g": context.motion.peak / GRAVITY,
        "energy_supplied_J": r.work,
        "energy_residual_ratio": float(np.abs(course.energy - course.energy[:1] - r.ledger).max(initial=0.0)) / course.scale,
        "steps": r.steps,
        "rejected_steps": 0,
        "decided_by_last_digits": course.chaotic,
        "perturbation_growth": course.growth,
        "violated": course.violated,
    }
    result.results = out.Rocking(**{**results, **further})
    result.tables["rocking"] = _table(r, course)
    result.tables["rocking_events"] = TableData(
        {
            "event": [kind for kind, _, _ in r.events],
            "time": np.array([t for _, t, _ in r.events]),
            "value": np.array([v for _, _, v in r.events]),
        },
        {"time": "s", "value": course.event_value},
    )
    result.arrays = {
        "time": Array(r.time, ("time",), "s", "output times"),
        "ground": Array(r.ground, ("time",), "m/s^2", "horizontal ground acceleration"),
        "vertical": Array(r.vertical, ("time",), "m/s^2", "vertical ground acceleration"),
        "kinetic": Array(r.kinetic, ("time",), "J"),
        "potential": Array(course.potential, ("time",), "J"),
        "ledger": Array(r.ledger, ("time",), "J", f"work done by the ground motion, minus {course.lost}"),
        "impact_time": Array(np.array(impact_times(r)), ("impact",), "s"),
        "required_friction": Array(course.friction, ("time", "joint"), "", "coefficient of friction needed"),
    }
    return result


def _table(r: rocking.Course, course: Course) -> TableData:
    """The history as a table."""
    columns = {
        "time": (r.time, "s"),
        **course.coordinates,
        "ground_acceleration": (r.ground, "m/s^2"),
        "vertical_acceleration": (r.vertical, "m/s^2"),
        "kinetic_energy": (r.kinetic, "J"),
        "potential_energy": (course.potential, "J"),
        "energy_supplied_less_lost": (r.ledger, "J"),
        **course.further,
        "required_friction": (course.friction.max(axis=1) if len(course.friction) else np.zeros(0), ""),
    }
    return TableData({name: values for name, (values, _) in columns.items()}, {name: unit for name, (_, unit) in columns.items() if unit})
