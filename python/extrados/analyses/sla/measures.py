"""What is read off a curve: loads, displacements, counts and energies, the teeth of its laws, the openings of joints."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from extrados.analyses.sla.bar_forces import bar_rows
from extrados.analyses.sla.curve import AXIAL, FAR, FAR_ABOVE, bilinear, drop_of
from extrados.analyses.sla.events import MECHANISM_REACHED, Curve
from extrados.analyses.sla.model import EventModel, SlaModel
from extrados.analyses.sla.stored import point_fields, points_of_groups
from extrados.analyses.sla.tables import Staged
from extrados.core import sla as core
from extrados.core.sla import EVENT, teeth
from extrados.results.model import Result, TableData
from extrados.schema.constants import GRAVITY

#: Open part of a joint from which it counts as a hinge, and the part of the widest opening that it must have
HINGE, WIDE = 0.9, 0.1


def numbers_of(model: EventModel, options: Staged, curve: Curve) -> dict[str, Any]:
    """Results of one curve; keys end in their unit."""
    events, greatest, unit = curve.events, curve.peak, model.unit
    last = curve.last
    peak = greatest if curve.passed(unit) else -1
    load = curve.force(unit)
    lost = np.flatnonzero(~events.equilibrium)

    def kinds(*names: str) -> np.ndarray:
        return np.isin(events.code, [EVENT[name] for name in names])

    numbers: dict[str, Any] = {
        "sense": curve.sense,
        "peak_load_N": float(load[peak]) if peak >= 0 else None,
        "greatest_load_N": float(load[greatest]) if greatest >= 0 else None,
        "greatest_load_displacement_m": float(events.monitors[greatest, 0]) if greatest >= 0 else None,
        "greatest_load_event": greatest + 1 if greatest >= 0 else None,
        **_acceleration(model, *(float(events.load[k]) if k >= 0 else None for k in (peak, greatest))),
        "peak_displacement_m": float(events.monitors[peak, 0]) if peak >= 0 else None,
        "displacement_of_constant_loads_m": curve.before,
        "peak_event": peak + 1 if peak >= 0 else None,
        "first_event_load_N": float(load[0]) if len(events) else None,
        "events": len(events),
        "events_before_resume": curve.events_before,
        "events_without_equilibrium": len(lost),
        "first_event_without_equilibrium": int(lost[0]) + 1 if len(lost) else None,
        "stop": events.reason or ("interrupted" if events.interrupted else "number of events"),
        "secondary_cracks": int(kinds("tension_s").sum()),
        "damaged_points": len(np.unique(events.point[kinds("tension", "tension_s")])),
        "closings": int(kinds("close", "close_s").sum()),
        "crushing_events": int(kinds("compression", "compression_s").sum()),
        "events_out_of_reach": int(curve.judged[1].sum()),
        "last_load_N": float(load[last]) if last >= 0 else None,
        "last_displacement_m": float(events.monitors[last, 0]) if last >= 0 else None,
        "energy_residual_ratio": events.ledger_error,
        "external_work_J": float(events.external[last]) if last >= 0 else None,
        "stored_energy_J": float(events.stored[last]) if last >= 0 else None,
        "dissipated_energy_J": float(curve.dissipated[last]) if last >= 0 else None,
        "crack_energy_J": events.crack_total,
        "residual_ratio": _residual(curve),
        "guard_checks": events.guard[0],
        "guard_resolutions": events.guard[1],
        "guard_new_factors": events.guard[2],
        "seconds_per_event": curve.seconds / max(len(events), 1),
        "events_of_constant_loads": len(curve.stage_a) - 1 if curve.stage_a is not None and len(curve.stage_a) else 0,
    }
    d, p = curve.envelope(unit)
    if options.probes:
        reached = [float(np.interp(x, d, p)) if x <= d[-1] else None for x in options.probes]
        numbers["probe_loads_N"] = reached
    if isinstance(model, SlaModel) and model.bars:
        numbers["bars"] = bar_rows(model, curve)
    if events.steps.any():
        numbers |= _of_steps(model, curve, peak, d, p)
    if len(events) and events.compliance[0] > 0.0:
        numbers["initial_stiffness_N_m"] = float(unit**2 / events.compliance[0])
    idea = bilinear(d - d[0], p) if peak >= 0 and p[0] == 0.0 else None  # from the state under the constant loads
    if idea is not None:
        numbers["bilinear"] = {
            "stiffness_N_m": idea.stiffness,
            "yield_load_N": idea.yield_load,
            "yield_displacement_m": idea.yield_displacement,
            "ultimate_displacement_m": idea.ultimate_displacement,
            "ductility": idea.ductility,
        }
    return numbers


def _of_steps(model: EventModel, curve: Curve, peak: int, d: np.ndarray, p: np.ndarray) -> dict[str, Any]:
    """Numbers of the steps of equilibrium iterations; d, p: the envelope [m], [N]; peak: its event, -1 where none was passed."""
    events, height = curve.events, model.reach
    steps = events.steps
    states = steps & events.equilibrium
    gap = np.abs(events.external - events.stored - events.lost) / np.maximum(np.abs(events.external), 1e-300)
    drop = drop_of(d, p) if peak >= 0 else None
    last = np.flatnonzero(states)
    lost = float(events.monitors[last[-1], 0]) if events.reason == AXIAL and len(last) else None

    def drift(displacement: float | None) -> float | None:
        return None if displacement is None else displacement / height

    return {
        "equilibrium_steps": int(steps.sum()),
        "staggered_steps": int((events.code == EVENT["staggered"]).sum()),
        "unbalanced_steps": int((events.code == EVENT["unbalanced"]).sum()),
        "equilibrium_solutions": events.solutions,
        "equilibrium_from_m": float(events.monitors[np.flatnonzero(steps)[0], 0]),
        "step_residual_ratio": float(events.residual[states].max(initial=0.0)),
        "step_balance_ratio": float(gap[states].max(initial=0.0)),
        "released_energy_J": events.released,
        "drift_height_m": height,
        "peak_drift": drift(float(events.monitors[peak, 0]) if peak >= 0 else None),
        "drop_displacement_m": drop,
        "drop_drift": drift(drop),
        "axial_loss_displacement_m": lost,
        "axial_loss_drift": drift(lost),
    }


def out_of_reach(curve: Curve) -> str | None:
    """A warning where events are no states because they lie beyond small displacements or far above the peak load."""
    out = curve.judged[1]
    count = int(out.sum())
    if not count or (count == 1 and out[-1] and curve.events.reason == MECHANISM_REACHED):
        return None  # the way of a mechanism, which the run ends with
    return (
        f"{count} of {len(curve.events)} events have a displacement above {FAR * curve.extent:.3g} m (1/10 of "
        f"the size of the structure), or a load above {FAR_ABOVE:g} times the greatest load. These events "
        "are not valid states and are used for no result"
    )


def _acceleration(model: EventModel, peak: float | None, greatest: float | None) -> dict[str, float | None]:
    """Multipliers as accelerations, where the reference load is one of masses alone."""
    if model.acceleration is None:
        return {}
    g = model.acceleration / GRAVITY
    return {
        "peak_acceleration_g": None if peak is None else peak * g,
        "greatest_acceleration_g": None if greatest is None else greatest * g,
    }


def _residual(curve: Curve) -> float | None:
    """The greatest residual that was measured, by the guard or at the end; None where none was."""
    measured = [curve.residual] if curve.residual is not None else []
    if curve.events.guard[0] and len(curve.events):  # none where the run ended under the constant loads
        measured.append(float(curve.events.residual.max()))
    return max(measured, default=None)


def tooth_counts(model: SlaModel) -> list[int]:
    """Least and greatest number of teeth of the cracking elements (of the widest and narrowest bands)."""
    laws: dict[tuple[core.Softening, float], tuple[float, float]] = {}
    for group, meshed in zip(model.planes, model.mesh.groups, strict=True):
        if isinstance(group.tension, Sequence):
            count = len(group.tension)
            band, young = (np.broadcast_to(values, count).tolist() for values in (group.band, group.young))
            for k, law in enumerate(group.tension):
                if law is not None and (meshed.dry is None or not meshed.dry[k]):
                    narrow, wide = (band[k], band[k]) if group.reach is None else group.reach[k].tolist()
                    low, high = laws.get((law, young[k]), (np.inf, 0.0))
                    laws[law, young[k]] = (min(low, narrow), max(high, wide))
    counts = [len(teeth(law, young, h)[0]) for (law, young), ends in list(laws.items())[:50] for h in ends]
    return [min(counts), max(counts)] if counts else [0, 0]


def joint_openings(result: Result, model: SlaModel, curve: Curve) -> list[str]:
    """Openings of the joints at the peak as a table; the names of the hinges: open but for an edge, and wide among them."""
    state = next((s for s in curve.states if s.event == curve.peak), None)
    if state is None:
        return []
    groups = zip(model.mesh.groups, points_of_groups(model, len(model.point_xy)), strict=True)
    joint_of, rows = next((group.joint, points) for group, points in groups if group.joint is not None)
    joint = np.repeat(joint_of, len(rows) // len(joint_of))
    width = point_fields(model, state)["width_n"][rows]
    area = state.report["volume"][rows]
    count = len(model.mesh.joint_names)
    share = np.bincount(joint, np.where(width > 0.0, area, 0.0), count) / np.bincount(joint, area, count)
    most = np.zeros(count)
    np.maximum.at(most, joint, width)
    columns: dict[str, np.ndarray | list[str]] = {"joint": model.mesh.joint_names, "greatest_opening": most, "open_part": share}
    units = {"greatest_opening": "m"}
    if model.slides:
        slip = np.zeros(count)
        np.maximum.at(slip, joint, np.abs(state.report["strain_ns"][rows]))
        columns["greatest_slip"], units["greatest_slip"] = slip, "m"
    result.tables["joints"] = TableData(columns, units)
    hinges = np.flatnonzero((share > HINGE) & (most > WIDE * most.max()))
    return [model.mesh.joint_names[j] for j in hinges]
