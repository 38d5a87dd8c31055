"""sla: sequentially linear analysis of a wall (thesis 4.2, 4.3)."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from extrados.analyses.batches import Chain, stacked, sweep
from extrados.analyses.context import Context, Refused
from extrados.analyses.sla.curve import MOST_ENVELOPE, bilinear
from extrados.analyses.sla.events import Curve, damage_before, run_curves
from extrados.analyses.sla.kept import State
from extrados.analyses.sla.model import SlaModel, build, strength_factors
from extrados.analyses.sla.tables import Sla
from extrados.building.building import Building
from extrados.core.calls import interruptible
from extrados.core.errors import Cancelled, status_code
from extrados.core.sla import EVENTS, Plane, teeth
from extrados.results import sla as out
from extrados.results.model import Array, Result, TableData
from extrados.results.sla import PREFIXES
from extrados.results.store import StoreError, read
from extrados.results.vtu import pvd, vtu
from extrados.schema.constants import GRAVITY

UNBOUNDED = 1e300
#: Open part of a joint from which it counts as a hinge, and the part of the widest opening that it must have
HINGE, WIDE = 0.95, 0.1


LEDGER = ("external", "dissipated", "crack")


@dataclass(frozen=True)
class Earlier:
    """The event of an earlier run at which a resumed one begins: its sense, the events before it, its load [N] and
    point, and the ledger [J] at it."""

    sense: str
    events: int
    load: float
    point: int
    totals: list[float]


def run(context: Context, options: Sla) -> Result:
    """All curves: both senses of the load, and the repetitions with other seeds."""
    with interruptible():  # Ctrl-C between two batches too only ends the events: what was found is kept
        return _run(context, options)


def _run(context: Context, options: Sla) -> Result:
    mesh = context.building.mesh(options.mesh)
    result = Result("sla")
    context.warnings += mesh.warnings
    model = build(mesh, options, strength_factors(mesh, options, options.strength_seed))
    damage, earlier = _resume(context, options, model)

    def chain(sign: int) -> Chain:
        mesh_of = [model.mesh.xy, [group.connect for group in model.mesh.groups], model.constant, model.reference]
        return Chain(context, "sla", [options, sign, damage, model.freedoms, *mesh_of])

    curves = run_curves(model, options, context.threads, context.progress, damage, chain)
    for curve in curves:
        _carry(curve, earlier, model.unit)
    numbers = _describe(result, model, options, curves)
    if options.seeds and not curves[-1].events.interrupted:
        numbers |= _scatter(context, options, result)
    result.results = out.Sla(**numbers)
    if any(c.events.interrupted for c in curves):
        again = "; --resume goes on from them" if context.checkpoint is not None else ""
        result.status, result.reason = "interrupted", f"interrupted; the events up to then are kept{again}"
    return result


def _resume(context: Context, options: Sla, model: SlaModel) -> tuple[np.ndarray | None, Earlier | None]:
    """The damage stored by an earlier run before the event asked for, and what had been counted at that event."""
    if options.resume_from is None:
        return None, None
    folder = Path(options.resume_from)
    folder = folder if folder.is_absolute() else context.deck.folder / folder
    try:
        stored = read(folder)
        get = {name: array.data for name, array in stored.arrays["sla"].items()}
        there, here = get["point_xy"], model.point_xy
        if len(there) != len(here):
            raise Refused(
                f"resume_from: that wall has {len(there)} points, this one {len(here)}; the mesh must be the same"
            )
        apart = float(np.abs(there - here).max())
        if apart > 1e-6 * model.mesh.size:
            raise Refused(f"resume_from: the points of that wall lie up to {apart:.3g} m away from those of this one")
        event = len(get["event_point"]) if options.resume_event is None else options.resume_event
        if event > len(get["event_point"]):
            raise Refused(f"resume_event is {event}, that run has {len(get['event_point'])} events")
        earlier = None
        if event >= 1:
            totals = [float(get[f"event_{name}"][event - 1]) for name in LEDGER]
            numbers = stored["sla"]
            before = numbers.get("events_before_resume", 0) + event - 1
            earlier = Earlier(
                numbers["sense"],
                before,
                float(get["event_load"][event - 1]),
                int(get["event_point"][event - 1]),
                totals,
            )
        damage = damage_before(
            get["damage_start"].T, get["damage_end"].T, get["event_point"][: event - 1], get["event_code"][: event - 1]
        )
        return damage, earlier
    except (StoreError, KeyError) as error:
        raise Refused(f"resume_from: {error}") from None


def _carry(curve: Curve, earlier: Earlier | None, unit: float) -> None:
    """Let the counts of a resumed curve go on, where its first event is the stored one: other loads or another sense
    begin anew."""
    events = curve.events
    if earlier is None or not len(events) or curve.sense != earlier.sense or events.point[0] != earlier.point:
        return
    if abs(events.load[0] * unit - earlier.load) > 1e-6 * abs(earlier.load):
        return
    curve.events_before = earlier.events
    for name, total in zip(LEDGER, earlier.totals, strict=True):
        shift = total - float(getattr(events, name)[0])
        getattr(events, name)[:] += shift
        if name == "crack":
            events.crack_total += shift


def _numbers(model: SlaModel, options: Sla, curve: Curve) -> dict[str, Any]:
    """Results of one curve; keys end in their unit."""
    events, peak, unit = curve.events, curve.peak, model.unit
    lost = np.flatnonzero(~events.equilibrium)
    tension = np.isin(events.code, (1, 2))
    numbers: dict[str, Any] = {
        "sense": curve.sense,
        "peak_load_N": float(events.load[peak] * unit) if peak >= 0 else None,
        **_acceleration(model, float(events.load[peak]) if peak >= 0 else None),
        "peak_displacement_m": float(events.monitors[peak, 0]) if peak >= 0 else None,
        "displacement_of_constant_loads_m": curve.before,
        "peak_event": peak + 1 if peak >= 0 else None,
        "first_event_load_N": float(events.load[0] * unit) if len(events) else None,
        "events": len(events),
        "events_before_resume": curve.events_before,
        "events_without_equilibrium": len(lost),
        "first_event_without_equilibrium": int(lost[0]) + 1 if len(lost) else None,
        "stop": events.reason or ("interrupted" if events.interrupted else "number of events"),
        "secondary_cracks": int(np.isin(events.code, (2,)).sum()),
        "damaged_points": len(np.unique(events.point[tension])),
        "closings": int(np.isin(events.code, (5, 6)).sum()),
        "crushing_events": int(np.isin(events.code, (3, 4)).sum()),
        "last_load_N": float(events.load[-1] * unit) if len(events) else None,
        "last_displacement_m": float(events.monitors[-1, 0]) if len(events) else None,
        "energy_residual_ratio": events.ledger_error,
        "external_work_J": float(events.external[-1]) if len(events) else None,
        "stored_energy_J": float(events.stored[-1]) if len(events) else None,
        "dissipated_energy_J": float(events.dissipated[-1]) if len(events) else None,
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
    if len(events):
        numbers["initial_stiffness_N_m"] = float(unit**2 / events.compliance[0])
    idea = bilinear(d - d[0], p)  # from the state under the constant loads
    if idea is not None:
        numbers["bilinear"] = {
            "stiffness_N_m": idea.stiffness, "yield_load_N": idea.yield_load,
            "yield_displacement_m": idea.yield_displacement, "ultimate_displacement_m": idea.ultimate_displacement,
            "ductility": idea.ductility,
        }  # fmt: skip
    return numbers


def _acceleration(model: SlaModel, peak: float | None) -> dict[str, float | None]:
    """The peak multiplier as an acceleration, where the reference load is one of masses alone."""
    if model.acceleration is None:
        return {}
    return {"peak_acceleration_g": None if peak is None else peak * model.acceleration / GRAVITY}


def _residual(curve: Curve) -> float | None:
    """The greatest residual that was measured, by the guard or at the end; None where none was."""
    measured = [curve.residual] if curve.residual is not None else []
    if curve.events.guard[0]:
        measured.append(float(curve.events.residual.max()))
    return max(measured, default=None)


def _tooth_counts(model: SlaModel) -> list[int]:
    """Least and greatest number of teeth of the cracking elements (of the widest and narrowest bands)."""
    laws = {}
    dry = [group.dry for group in model.mesh.groups] + [None] * len(model.groups)
    for group, without in zip(model.groups, dry, strict=False):
        if isinstance(group, Plane) and group.tension is not None:
            for k, law in enumerate(group.tension):
                if law is not None and (without is None or not without[k]):
                    band = float(group.band[k])
                    low, high = laws.get((law, float(group.young[k])), (band, band))
                    laws[law, float(group.young[k])] = (min(low, band), max(high, band))
    counts = [len(teeth(law, young, h)[0]) for (law, young), ends in list(laws.items())[:50] for h in ends]
    return [min(counts), max(counts)] if counts else [0, 0]


def _describe(result: Result, model: SlaModel, options: Sla, curves: list[Curve]) -> dict[str, Any]:
    """Arrays, tables, files and words of all curves into `result`; their numbers."""
    first = curves[0]
    numbers = {
        **_numbers(model, options, first),
        "reference_load_N": model.unit,
        "teeth": _tooth_counts(model),
        "nodes": len(model.mesh.xy),
        "elements": model.mesh.elements(),
        "equations": first.equations,
        "points": first.points,
    }
    for curve in curves[1:]:
        numbers["minus"] = _numbers(model, options, curve)
    for curve in curves:
        result.warnings += curve.warnings
        events, sense = curve.events, f" (load to {curve.sense})"
        if len(events) and events.load[0] < 0.0:
            result.warnings.append(
                f"the first event{sense} has a negative load, {events.load[0] * model.unit:.4g} N: the constant loads "
                "alone are beyond the strength somewhere"
            )
    result.arrays = _mesh_arrays(model)
    for curve, prefix in zip(curves, PREFIXES, strict=False):
        _curve_arrays(result, model, curve, prefix)
    _sections(result, model, options, first)
    _fields(result, model, curves)
    if model.mesh.has_joints:
        numbers["hinges"] = _joints(result, model, first)
        result.answer = _answer_of_stones(numbers, len(curves) > 1)
    else:
        result.answer = _answer(numbers, len(curves) > 1)
    return numbers


def _joints(result: Result, model: SlaModel, curve: Curve) -> list[str]:
    """Openings of the joints at the peak as a table; the names of the hinges: open but for an edge, and wide among them."""
    state = next((s for s in curve.states if s.event == curve.peak), None)
    if state is None:
        return []
    start = 0
    for group, points in zip(model.mesh.groups, _split(model, len(model.point_xy)), strict=True):
        start = int(points[0])
        if group.joint is not None:
            break
    joint = np.repeat(group.joint, len(points) // len(group.joint))
    rows = slice(start, start + len(joint))
    width = point_fields(model, state, result.arrays["point_band"].data)["width_n"][rows]
    area = state.report["volume"][rows]
    count = len(model.mesh.joint_names)
    share = np.bincount(joint, np.where(width > 0.0, area, 0.0), count) / np.bincount(joint, area, count)
    most = np.zeros(count)
    np.maximum.at(most, joint, width)
    result.tables["joints"] = TableData(
        {"joint": model.mesh.joint_names, "greatest_opening": most, "open_part": share}, {"greatest_opening": "m"}
    )
    hinges = np.flatnonzero((share > HINGE) & (most > WIDE * most.max()))
    return [model.mesh.joint_names[j] for j in hinges]


def _answer_of_stones(r: dict[str, Any], both: bool) -> str:
    if r["peak_load_N"] is None or r["stop"] not in ("mechanism", "no point limits the load") or not r["events"]:
        return _answer(r, both)
    by_masses = "peak_acceleration_g" in r

    def capacity(of: dict[str, Any]) -> str:
        kilonewtons = f"{of['peak_load_N'] / 1e3:.4g} kN"
        return f"an acceleration of {of['peak_acceleration_g']:.4g} g ({kilonewtons})" if by_masses else kilonewtons

    text = f"The stones become a mechanism at {capacity(r)}; joints open but do not slide."
    if names := r["hinges"]:
        shown = ", ".join(names[:6]) + (f" and {len(names) - 6} more" if len(names) > 6 else "")
        text += f" Hinges: {shown}."
    if both and r.get("minus", {}).get("peak_load_N") is not None:
        text += f" In the opposite sense: {capacity(r['minus'])}."
    return text


def _answer(r: dict[str, Any], both: bool) -> str:
    if r["events"] == 0 and r["stop"] == "no point limits the load":
        return "The load is not limited: nothing in the wall cracks or crushes under it, however large it grows."
    if r["peak_load_N"] is None:
        return f"No state of equilibrium was found in {r['events']} events; the run ended by: {r['stop']}."
    rises = r["stop"] == "number of events" and r["peak_event"] == r["events"]
    text = (
        f"The load {'still rises: it has reached' if rises else 'peaks at'} {r['peak_load_N'] / 1e3:.4g} kN with a displacement of {r['peak_displacement_m'] * 1e3:.4g} mm "
        f"(event {r['peak_event']} of {r['events']}; the run ended by: {r['stop']})."
    )
    if both and r.get("minus", {}).get("peak_load_N") is not None:
        text += f" In the opposite sense it peaks at {r['minus']['peak_load_N'] / 1e3:.4g} kN."
    lost = r["events_without_equilibrium"]
    if lost:
        text += f" {lost} events had no equilibrium, the first was event {r['first_event_without_equilibrium']}."
    return text


def _mesh_arrays(model: SlaModel) -> dict[str, Array]:
    arrays = {"node": Array(model.mesh.xy, ("nodes", "axis"), "m", "nodes of the mesh")}
    for i, group in enumerate(model.mesh.groups):
        arrays[f"elements_{i}"] = Array(
            group.connect, (f"elements_of_{i}", f"corner_{i}"), "", f"nodes of the {group.kind} elements, from 0",
            "elements",
        )  # fmt: skip
    arrays["point_xy"] = Array(model.point_xy, ("points", "axis"), "m", "integration points")
    per = [len(model.point_xy) and b.gauss[0] * b.gauss[1] for b in model.mesh.groups]
    per = [{"T3": 1, "T6": 3}.get(b.kind, n) for b, n in zip(model.mesh.groups, per, strict=True)]
    band = np.concatenate([np.repeat(h, n) for h, n in zip(model.bands, per, strict=True)])
    owner = np.repeat(np.arange(model.mesh.elements()), np.repeat(per, [len(g.connect) for g in model.mesh.groups]))
    arrays["point_element"] = Array(owner, ("points",), "", "element of the point, from 0, group after group")
    arrays["point_band"] = Array(band, ("points",), "m", "crack band width")
    if model.mesh.has_joints:
        reach = [
            h if g.joint is None else np.hypot(*(model.mesh.xy[g.connect[:, 1]] - model.mesh.xy[g.connect[:, 0]]).T) / g.gauss[0]
            for g, h in zip(model.mesh.groups, model.bands, strict=True)
        ]  # fmt: skip
        reach = np.concatenate([np.repeat(h, n) for h, n in zip(reach, per, strict=True)])
        arrays["point_reach"] = Array(reach, ("points",), "m", "length along a crack that a point stands for")
    return arrays


def _curve_arrays(result: Result, model: SlaModel, curve: Curve, prefix: str) -> None:
    e, unit = curve.events, model.unit
    dim = (f"{prefix}events",)
    limits = [_bounded(x) * unit for x in (e.limit_t, e.limit_c)]
    columns = {
        "load": (e.load * unit, "N", "load in the chosen sense"),
        "displacement": (e.monitors[:, 0], "m", "control displacement"),
        "limit_t": (limits[0], "N", "least upper limit of the load"),
        "limit_c": (limits[1], "N", "greatest lower limit of the load"),
        "stored": (e.stored, "J", "elastic energy"),
        "external": (e.external, "J", "work of all loads"),
        "dissipated": (e.dissipated, "J", "dissipated along the straight way between events"),
        "crack": (e.crack, "J", "area of the teeth passed"),
    }
    for name, (data, u, about) in columns.items():
        result.arrays[f"{prefix}event_{name}"] = Array(data, dim, u, about)
    result.arrays[f"{prefix}event_point"] = Array(e.point, dim, "", "point damaged, from 0")
    result.arrays[f"{prefix}event_code"] = Array(e.code, dim, "", "kind of event: " + ", ".join(
        f"{k} {v}" for k, v in EVENTS.items()))  # fmt: skip
    result.arrays[f"{prefix}event_equilibrium"] = Array(e.equilibrium.astype(np.int8), dim, "", "1 in equilibrium")
    if not prefix:
        for name in ("damage_start", "damage_end"):
            result.arrays[name] = Array(
                getattr(curve, name).T, ("all_points", "damage_row"), "", "damage, to go on from"
            )
    d, p = curve.envelope(unit)
    result.arrays[f"{prefix}envelope_displacement"] = Array(d, (f"{prefix}envelope",), "m", "monotone envelope")
    result.arrays[f"{prefix}envelope_load"] = Array(p, (f"{prefix}envelope",), "N", "monotone envelope")
    name = "load_displacement" + ("_minus" if prefix else "")
    result.tables[name] = TableData(
        {
            "event": np.arange(1, len(e) + 1), "load": e.load * unit, "displacement": e.monitors[:, 0],
            "equilibrium": e.equilibrium.astype(int), "point": e.point + 1,
            "kind": [EVENTS.get(int(c), "end") for c in e.code],
            "external": e.external, "stored": e.stored, "dissipated": e.dissipated,
        },
        {"load": "N", "displacement": "m", "external": "J", "stored": "J", "dissipated": "J"},
    )  # fmt: skip
    result.tables["envelope" + ("_minus" if prefix else "")] = TableData(
        {"displacement": d, "load": p}, {"displacement": "m", "load": "N"}
    )
    if curve.states:
        states = curve.states
        dims = (f"{prefix}states",)
        n = len(model.point_xy)
        result.arrays[f"{prefix}state_event"] = Array(
            np.array([s.event + 1 for s in states]), dims, "", "event, from 1"
        )
        result.arrays[f"{prefix}state_load"] = Array(np.array([s.load for s in states]) * unit, dims, "N", "load")
        result.arrays[f"{prefix}state_displacement"] = Array(
            np.stack([s.displacement for s in states]), (*dims, "nodes", "axis"), "m", "displacements of the nodes"
        )
        band = result.arrays["point_band"].data
        for field, (u, about) in {
            "width_n": ("m", "width of the first crack"), "width_s": ("m", "width of the second crack"),
            "angle": ("rad", "direction of the first crack's normal"), "stress_1": ("Pa", "greater principal stress"),
            "stress_2": ("Pa", "lesser principal stress"), "ratio_n": ("", "stiffness left across the first crack"),
            "ratio_s": ("", "stiffness left across the second crack"), "stress_angle": ("rad", "of stress_1"),
        }.items():  # fmt: skip
            data = np.stack([point_fields(model, s, band)[field][:n] for s in states])
            result.arrays[f"{prefix}state_{field}"] = Array(data, (*dims, "points"), u, about)


def point_fields(model: SlaModel, state: State, band: np.ndarray) -> dict[str, np.ndarray]:
    """Crack widths [m] and directions, principal stresses [Pa] at the plane points of a state."""
    n = len(band)
    r = {k: v[:n] for k, v in state.report.items()}
    young = np.concatenate(
        [
            np.repeat([model.mesh.materials[m].young for m in b.material], len(p) // len(b.connect))
            for b, p in zip(model.mesh.groups, _split(model, n), strict=True)
        ]
    )
    angle = np.arctan2(r["sin"], r["cos"])
    mean, half = 0.5 * (r["stress_n"] + r["stress_s"]), 0.5 * (r["stress_n"] - r["stress_s"])
    radius = np.hypot(half, r["stress_ns"])
    turn = 0.5 * np.arctan2(2.0 * r["stress_ns"], r["stress_n"] - r["stress_s"])

    def width(strain: np.ndarray, stress: np.ndarray, ratio: np.ndarray) -> np.ndarray:
        # The strain that the crack adds to the elastic one, over the band
        return np.where(ratio < 1.0, np.maximum(strain - stress / young, 0.0) * band, 0.0)

    return {
        "width_n": width(r["strain_n"], r["stress_n"], r["ratio_n"]),
        "width_s": width(r["strain_s"], r["stress_s"], r["ratio_s"]),
        "angle": angle, "ratio_n": r["ratio_n"], "ratio_s": r["ratio_s"],
        "stress_1": mean + radius, "stress_2": mean - radius, "stress_angle": angle + turn,
    }  # fmt: skip


def _bounded(limits: np.ndarray) -> np.ndarray:
    """Limits of lambda with NaN where there are none."""
    return np.where(np.abs(limits) < UNBOUNDED, limits, np.nan)


def _split(model: SlaModel, n: int) -> list[np.ndarray]:
    counts = [len(b.connect) * {"T3": 1, "T6": 3}.get(b.kind, b.gauss[0] * b.gauss[1]) for b in model.mesh.groups]
    return np.split(np.arange(n), np.cumsum(counts)[:-1])


def _sections(result: Result, model: SlaModel, options: Sla, curve: Curve) -> None:
    """Admitted ranges of the load over vertical sections at the kept states (thesis Figs 4-5, 4-6)."""
    if not curve.states:
        return
    for i, x in enumerate(options.section_x):
        away = np.abs(model.point_xy[:, 0] - x)
        near = np.flatnonzero(away <= away.min() + 1e-6 * model.mesh.size)
        near = near[np.argsort(model.point_xy[near, 1], kind="stable")]
        result.arrays[f"section_{i}_y"] = Array(
            model.point_xy[near, 1], (f"section_{i}",), "m", f"points at x = {x:g} m", "section_y"
        )
        for end in ("lo", "hi"):
            rows = np.stack([s.report[f"lambda_{end}"][near] for s in curve.states])
            result.arrays[f"section_{i}_{end}"] = Array(
                _bounded(rows) * model.unit,
                ("states", f"section_{i}"),
                "N",
                "least admitted load" if end == "lo" else "greatest admitted load",
                f"section_{end}",
            )


def _fields(result: Result, model: SlaModel, curves: list[Curve]) -> None:
    """The states as VTU, their series as PVD."""
    cells = [(b.kind, b.connect) for b in model.mesh.groups]
    band = result.arrays["point_band"].data
    for curve, name in zip(curves, ("fields", "fields_minus"), strict=False):
        series = []
        for state in curve.states:
            fields = point_fields(model, state, band)
            by_element = {
                key: np.concatenate(
                    [
                        fields[key][p].reshape(len(b.connect), -1).max(axis=1)
                        if key.startswith("width")
                        else fields[key][p].reshape(len(b.connect), -1).mean(axis=1)
                        for b, p in zip(model.mesh.groups, _split(model, len(band)), strict=True)
                    ]
                )
                for key in ("width_n", "width_s", "stress_1", "stress_2", "ratio_n", "ratio_s")
            }
            file = f"{name}/event_{state.event + 1:06d}.vtu"
            result.files[file] = vtu(model.mesh.xy, cells, {"displacement": state.displacement}, by_element)
            series.append((state.event + 1, file))
        result.files[f"{name}.pvd"] = pvd(series)


@dataclass(frozen=True)
class Repetitions:
    """Member k is the first curve again with the k-th seed of mesh or strength."""

    building: Building
    options: Sla
    random_mesh: bool

    def run(self, first: int, count: int, threads: int) -> dict[str, np.ndarray]:
        return stacked(lambda k: self._member(self.options.seeds[k], threads), first, count)

    def _member(self, seed: int, threads: int) -> dict[str, np.ndarray]:
        options = self.options.model_copy(update={"directions": self.options.directions[:1], "states": []})
        mesh = self.building.mesh(options.mesh, seed if self.random_mesh else None)
        model = build(mesh, options, strength_factors(mesh, options, seed))
        curve = run_curves(model, options, threads, lambda done, total, text: None)[0]
        if curve.events.interrupted:
            raise Cancelled(status_code("cancelled"), "repetition interrupted")
        d, p = curve.envelope(model.unit)
        rows = {
            name: np.pad(values, (0, MOST_ENVELOPE - len(d)), constant_values=np.nan)
            for name, values in (("d", d), ("p", p))
        }
        return {
            **rows,
            "points": np.array(len(d)),
            "peak_load": np.array(curve.events.load[curve.peak] * model.unit),
            "peak_displacement": np.array(curve.events.monitors[curve.peak, 0]),
        }


def _scatter(context: Context, options: Sla, result: Result) -> dict[str, out.Scatter]:
    """The curve again with other seeds of mesh and strength: its key, the band into `result`."""
    random_mesh = options.mesh.pattern == "random" or bool(getattr(context.deck.structure, "outline", None))
    if not random_mesh and options.strength_variation == 0.0:
        raise Refused('seeds ask for a random mesh (mesh.pattern = "random") or for strength_variation above 0')
    swept = sweep(
        context, "sla-seeds", Repetitions(context.building, options, random_mesh), len(options.seeds), "repetitions",
        slow=True, parallel=True,
    )  # fmt: skip
    if not swept.complete:
        result.status = "interrupted" if swept.interrupted else "failed"
        result.reason = f"among the repetitions: {swept.stopped}"
    if not len(swept.members):
        return {}
    done = [options.seeds[k] for k in swept.members]
    loads = swept["peak_load"]
    curves = [(d[:n], p[:n]) for d, p, n in zip(swept["d"], swept["p"], swept["points"], strict=True)]
    scatter = out.Scatter(
        seeds=done, peak_loads_N=loads, mean_N=loads.mean(), lowest_N=loads.min(), highest_N=loads.max(),
        coefficient_of_variation=loads.std(ddof=1) / loads.mean() if len(loads) > 1 else None,
    )  # fmt: skip
    grid = np.linspace(0.0, min(d[-1] for d, _ in curves), 200)
    rows = np.stack([np.interp(grid, d, p) for d, p in curves])
    result.arrays["scatter_displacement"] = Array(grid, ("scatter_grid",), "m", "displacements of the band")
    result.arrays["scatter_load"] = Array(rows, ("seed", "scatter_grid"), "N", "envelopes of the repetitions")
    result.tables["scatter"] = TableData(
        {"seed": done, "peak_load": loads, "peak_displacement": swept["peak_displacement"]},
        {"peak_load": "N", "peak_displacement": "m"},
    )
    result.answer += (
        f" Over {len(loads)} repetitions the peak lies between {loads.min() / 1e3:.4g} and {loads.max() / 1e3:.4g} kN."
    )
    return {"scatter": scatter}
