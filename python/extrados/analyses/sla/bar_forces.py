"""Forces of bars and ties: from event to event where a bar is held at its ends alone, along it at the kept states where it
is embedded."""

from typing import Any

import numpy as np

from extrados.analyses.sla.bars import PRESSURE, TAUT, TENSION, NamedBar
from extrados.analyses.sla.events import Curve
from extrados.analyses.sla.kept import State
from extrados.analyses.sla.model import SlaModel
from extrados.results.model import Array, Result, TableData
from extrados.results.sla import BarForce


def point_of(bar: NamedBar, model: SlaModel, curve: Curve) -> int:
    """The number of its first piece among all points."""
    return curve.points - sum(len(other.place) for other in model.bars) + bar.first


def history(model: SlaModel, curve: Curve) -> dict[str, np.ndarray]:
    """The force (events) [N] of each bar that is held at its ends alone, tension positive, by its name; none of an
    incremental solution."""
    ends = [bar for bar in model.bars if bar.held_at_ends]
    events, found = curve.events, {}
    if events.monitors.shape[1] != 1 + len(ends):
        return {}
    for k, bar in enumerate(ends, 1):
        point = point_of(bar, model, curve)
        code = np.where(events.point == point, events.code, 0)
        modulus = bar.modulus(curve.damage_start[:, point], code, model.behaviour.floor)
        found[bar.name] = modulus * events.monitors[:, k] * float(np.asarray(bar.group.area))
    return found


def along(bar: NamedBar, model: SlaModel, curve: Curve, state: State) -> np.ndarray:
    """The force (pieces) [N] along a bar in a state."""
    first = point_of(bar, model, curve)
    return state.report["stress_n"][first : first + len(bar.place)] * float(np.asarray(bar.group.area))


def bar_rows(model: SlaModel, curve: Curve) -> list[BarForce]:
    """What each bar and tie bears at the greatest load and at the end."""
    follow = history(model, curve)
    states = {state.event: state for state in curve.states}
    fine, rows = curve.events.equilibrium, []
    for bar in model.bars:
        ends, point = follow.get(bar.name), point_of(bar, model, curve)
        found: list[float | None] = []
        for event in (curve.peak, len(curve.events) - 1):
            if event >= 0 and ends is not None:
                found.append(float(ends[event]))
            elif event in states:
                force = along(bar, model, curve, states[event])
                found.append(float(force[np.abs(force).argmax()]))
            else:
                found.append(None)
        row: dict[str, Any] = {"name": bar.name, "force_at_greatest_load_N": found[0], "last_force_N": found[1]}
        if ends is not None and fine.any():
            row["greatest_force_N"] = float(ends[fine][np.abs(ends[fine]).argmax()])
        damage = curve.damage_end[:, point : point + len(bar.place)]
        slack = not (damage[TAUT] > 0.0).any()
        row["state"] = "slack" if slack else "yielded" if (damage[[TENSION, PRESSURE]] > 1.0).any() else "carries"
        rows.append(BarForce(**row))
    return rows


def bar_arrays(result: Result, model: SlaModel, curve: Curve, prefix: str) -> None:
    """Forces of the bars of a curve as arrays and tables into `result`; names of other curves begin with `prefix`."""
    follow, events = history(model, curve), curve.events
    for name, force in follow.items():
        number = next(k for k, bar in enumerate(model.bars) if bar.name == name)
        result.arrays[f"{prefix}bar_force_{number}"] = Array(
            force, (f"{prefix}events",), "N", f"force in {name}, tension positive", f"{prefix}bar_force"
        )
    of = f"_{prefix}".rstrip("_")
    if follow:
        result.tables[f"bar_forces{of}"] = TableData(
            {
                "event": np.arange(1, len(events) + 1),
                "load": curve.force(model.unit),
                "displacement": events.monitors[:, 0],
                "equilibrium": events.equilibrium.astype(int),
                **follow,
            },
            {"load": "N", "displacement": "m"} | dict.fromkeys(follow, "N"),
        )
    embedded = [(k, bar) for k, bar in enumerate(model.bars) if bar.name not in follow]
    if not embedded or not curve.states:
        return
    rows: dict[str, list] = {"event": [], "bar": [], "place": [], "force": []}
    for k, bar in embedded:
        force = np.stack([along(bar, model, curve, state) for state in curve.states])
        dim = f"{prefix}pieces_of_{k}"
        result.arrays[f"{prefix}bar_place_{k}"] = Array(
            bar.place, (dim,), "m", f"middles of the elements of {bar.name}, from its start", f"{prefix}bar_place"
        )
        result.arrays[f"{prefix}bar_along_{k}"] = Array(
            force, (f"{prefix}states", dim), "N", f"force along {bar.name}, tension positive", f"{prefix}bar_along"
        )
        for state, line in zip(curve.states, force, strict=True):
            rows["event"] += [state.event + 1] * len(line)
            rows["bar"] += [bar.name] * len(line)
            rows["place"] += bar.place.tolist()
            rows["force"] += line.tolist()
    result.tables[f"bars{of}"] = TableData(rows, {"place": "m", "force": "N"})
