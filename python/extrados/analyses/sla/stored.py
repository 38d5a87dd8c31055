"""What is stored of a run: mesh, events, states and sections as arrays and tables, fields as VTU."""

from collections.abc import Sequence

import numpy as np

from extrados.analyses.sla.events import Curve
from extrados.analyses.sla.kept import State
from extrados.analyses.sla.model import SlaModel
from extrados.analyses.sla.tables import Sla
from extrados.core.sla import EVENTS
from extrados.results.model import Array, Result, TableData
from extrados.results.vtu import pvd, vtu

#: A limit of the core from here on is none
UNBOUNDED = 1e300


def mesh_arrays(model: SlaModel) -> dict[str, Array]:
    """Nodes, elements and integration points."""
    arrays = {"node": Array(model.mesh.xy, ("nodes", "axis"), "m", "nodes of the mesh")}
    for i, group in enumerate(model.mesh.groups):
        arrays[f"elements_{i}"] = Array(
            group.connect, (f"elements_of_{i}", f"corner_{i}"), "", f"numbers of the nodes of the {group.kind} elements, from 0", "elements"
        )
    arrays["point_xy"] = Array(model.point_xy, ("points", "axis"), "m", "integration points")
    per = [plane.points_each for plane in model.planes]
    band = np.concatenate([np.repeat(h, n) for h, n in zip(model.bands, per, strict=True)])
    owner = np.repeat(np.arange(model.mesh.elements()), np.repeat(per, [len(g.connect) for g in model.mesh.groups]))
    arrays["point_element"] = Array(
        owner, ("points",), "", "number of the element of each integration point, counted from 0 over all groups of elements"
    )
    arrays["point_band"] = Array(band, ("points",), "m", "width of the crack band before the integration point cracks")
    if model.mesh.has_joints:
        reach = [
            h if g.joint is None else np.hypot(*(model.mesh.xy[g.connect[:, 1]] - model.mesh.xy[g.connect[:, 0]]).T) / g.gauss[0]
            for g, h in zip(model.mesh.groups, model.bands, strict=True)
        ]
        each = np.concatenate([np.repeat(h, n) for h, n in zip(reach, per, strict=True)])
        arrays["point_reach"] = Array(each, ("points",), "m", "length along a crack that an integration point represents")
    return arrays


def events_of_curve(result: Result, unit: float, curve: Curve, prefix: str) -> None:
    """Events and envelope of a curve into `result`; unit [N] of the multiplier 1."""
    e = curve.events
    dim = (f"{prefix}events",)
    # Limits of a displacement are no loads
    limits = [_bounded(x) * (np.nan if curve.driven else unit) + curve.already for x in (e.limit_t, e.limit_c)]
    columns = {
        "load": (curve.force(unit), "N", "load in the chosen sense"),
        "displacement": (e.monitors[:, 0], "m", "control displacement"),
        "limit_t": (limits[0], "N", "upper limit of the load: least of the limits of all integration points"),
        "limit_c": (limits[1], "N", "lower limit of the load: greatest of the limits of all integration points"),
        "stored": (e.stored, "J", "elastic energy"),
        "external": (e.external, "J", "work of all loads, if displacements change linearly between events"),
        "lost": (e.lost, "J", "work of all loads that is not stored as elastic energy; it may decrease at events without equilibrium"),
        "dissipated": (curve.dissipated, "J", "energy dissipated from one equilibrium state to the next; it never decreases"),
        "crack": (e.crack, "J", "area of the teeth passed"),
        "scale": (e.scale, "", "applied share of all loads; below 1 after all loads were reduced together"),
    }
    for name, (data, u, about) in columns.items():
        result.arrays[f"{prefix}event_{name}"] = Array(data, dim, u, about)
    result.arrays[f"{prefix}event_point"] = Array(e.point, dim, "", "point damaged, from 0")
    result.arrays[f"{prefix}event_code"] = Array(e.code, dim, "", "kind of event: " + ", ".join(f"{k} {v}" for k, v in EVENTS.items()))
    result.arrays[f"{prefix}event_equilibrium"] = Array(e.equilibrium.astype(np.int8), dim, "", "1 in equilibrium")
    result.arrays[f"{prefix}event_step"] = Array(e.steps.astype(np.int8), dim, "", "1: step of equilibrium iterations, 0: event")
    result.arrays[f"{prefix}event_residual"] = Array(
        np.where(e.steps, e.residual, np.nan), dim, "", "ratio of the residual of a step to the largest nodal force of an element"
    )
    state, out = curve.judged
    result.arrays[f"{prefix}event_state"] = Array(
        np.where(out, -1, state).astype(np.int8),
        dim,
        "",
        "1: valid equilibrium state, 0: no valid state, -1: displacement or load out of range",
    )
    if not prefix:
        for name in ("damage_start", "damage_end"):
            result.arrays[name] = Array(
                getattr(curve, name).T, ("all_points", "damage_row"), "", "damage, from which a later run can continue this run"
            )
    d, p = curve.envelope(unit)
    result.arrays[f"{prefix}envelope_displacement"] = Array(d, (f"{prefix}envelope",), "m", "monotone envelope")
    result.arrays[f"{prefix}envelope_load"] = Array(p, (f"{prefix}envelope",), "N", "monotone envelope")
    of = f"_{prefix}".rstrip("_")
    name = "load_displacement" + of
    result.tables[name] = TableData(
        {
            "event": np.arange(1, len(e) + 1),
            "load": curve.force(unit),
            "displacement": e.monitors[:, 0],
            "equilibrium": e.equilibrium.astype(int),
            "state": np.where(out, -1, state).astype(int),
            "point": e.point + 1,
            "kind": [EVENTS.get(int(c), "end" if p >= 0 else "step") for c, p in zip(e.code, e.point, strict=True)],
            "residual": np.where(e.steps, e.residual, np.nan),
            "external": e.external,
            "stored": e.stored,
            "dissipated": curve.dissipated,
        },
        {"load": "N", "displacement": "m", "external": "J", "stored": "J", "dissipated": "J"},
    )
    result.tables["envelope" + of] = TableData({"displacement": d, "load": p}, {"displacement": "m", "load": "N"})


def curve_arrays(result: Result, model: SlaModel, curve: Curve, prefix: str) -> None:
    """Events, envelope and kept states of a curve into `result`; names of the opposite sense begin with `prefix`."""
    unit = model.unit
    events_of_curve(result, unit, curve, prefix)
    if curve.states:
        states = curve.states
        dims = (f"{prefix}states",)
        result.arrays[f"{prefix}state_event"] = Array(np.array([s.event + 1 for s in states]), dims, "", "event, from 1")
        if not prefix:
            result.arrays["state_damage"] = Array(
                np.stack([s.damage.T for s in states]),
                (*dims, "all_points", "damage_row"),
                "",
                "damage before the event, from which a later run can continue this run",
            )
        result.arrays[f"{prefix}state_load"] = Array(curve.force(unit)[[s.event for s in states]], dims, "N", "load")
        result.arrays[f"{prefix}state_displacement"] = Array(
            np.stack([s.displacement for s in states]), (*dims, "nodes", "axis"), "m", "displacements of the nodes"
        )
        for field, (u, about) in {
            "width_n": ("m", "width of the first crack"),
            "width_s": ("m", "width of the second crack"),
            "angle": ("rad", "direction of the normal of the first crack"),
            "stress_1": ("Pa", "greater principal stress"),
            "stress_2": ("Pa", "lesser principal stress"),
            "ratio_n": ("", "ratio of remaining to initial stiffness across the first crack"),
            "ratio_s": ("", "ratio of remaining to initial stiffness across the second crack"),
            "stress_angle": ("rad", "of stress_1"),
        }.items():
            data = np.stack([point_fields(model, s)[field] for s in states])
            result.arrays[f"{prefix}state_{field}"] = Array(data, (*dims, "points"), u, about)


def point_fields(model: SlaModel, state: State) -> dict[str, np.ndarray]:
    """Crack widths [m] and directions, principal stresses [Pa] at the plane points of a state."""
    n = len(model.point_xy)
    r = {k: v[:n] for k, v in state.report.items()}
    young = np.concatenate(
        [
            np.repeat([model.mesh.materials[m].young for m in b.material], len(p) // len(b.connect))
            for b, p in zip(model.mesh.groups, points_of_groups(model, n), strict=True)
        ]
    )
    angle = np.arctan2(r["sin"], r["cos"])
    mean, half = 0.5 * (r["stress_n"] + r["stress_s"]), 0.5 * (r["stress_n"] - r["stress_s"])
    radius = np.hypot(half, r["stress_ns"])
    turn = 0.5 * np.arctan2(2.0 * r["stress_ns"], r["stress_n"] - r["stress_s"])

    def width(strain: np.ndarray, stress: np.ndarray, ratio: np.ndarray) -> np.ndarray:
        # The strain that the crack adds to the elastic one, over the band
        return np.where(ratio < 1.0, np.maximum(strain - stress / young, 0.0) * r["band"], 0.0)

    return {
        "width_n": width(r["strain_n"], r["stress_n"], r["ratio_n"]),
        "width_s": width(r["strain_s"], r["stress_s"], r["ratio_s"]),
        "angle": angle,
        "ratio_n": r["ratio_n"],
        "ratio_s": r["ratio_s"],
        "stress_1": mean + radius,
        "stress_2": mean - radius,
        "stress_angle": angle + turn,
    }


def _bounded(limits: np.ndarray) -> np.ndarray:
    """Limits of lambda with NaN where there are none."""
    return np.where(np.abs(limits) < UNBOUNDED, limits, np.nan)


def points_of_groups(model: SlaModel, n: int) -> list[np.ndarray]:
    """The numbers of the first n points, group by group."""
    counts = [len(plane.connect) * plane.points_each for plane in model.planes]
    return np.split(np.arange(n), np.cumsum(counts)[:-1])


def sections(result: Result, model: SlaModel, options: Sla, curve: Curve) -> None:
    """Admitted ranges of the load over vertical sections at the kept states (thesis Figs 4-5, 4-6)."""
    if not curve.states:
        return
    for i, x in enumerate(options.section_x):
        away = np.abs(model.point_xy[:, 0] - x)
        near = np.flatnonzero(away <= away.min() + 1e-6 * model.mesh.size)
        near = near[np.argsort(model.point_xy[near, 1], kind="stable")]
        result.arrays[f"section_{i}_y"] = Array(
            model.point_xy[near, 1], (f"section_{i}",), "m", f"integration points at x = {x:g} m", "section_y"
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


def field_files(result: Result, model: SlaModel, curves: list[Curve], prefixes: Sequence[str]) -> None:
    """The states as VTU, their series as PVD."""
    cells = [(b.kind, b.connect) for b in model.mesh.groups]
    for curve, prefix in zip(curves, prefixes, strict=False):
        name = f"fields_{prefix}".rstrip("_")
        series = []
        for state in curve.states:
            fields = point_fields(model, state)
            by_element = {
                key: np.concatenate(
                    [
                        fields[key][p].reshape(len(b.connect), -1).max(axis=1)
                        if key.startswith("width")
                        else fields[key][p].reshape(len(b.connect), -1).mean(axis=1)
                        for b, p in zip(model.mesh.groups, points_of_groups(model, len(model.point_xy)), strict=True)
                    ]
                )
                for key in ("width_n", "width_s", "stress_1", "stress_2", "ratio_n", "ratio_s")
            }
            file = f"{name}/event_{state.event + 1:06d}.vtu"
            result.files[file] = vtu(model.mesh.xy, cells, {"displacement": state.displacement}, by_element)
            series.append((state.event + 1, file))
        result.files[f"{name}.pvd"] = pvd(series)
