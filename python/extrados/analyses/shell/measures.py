"""What is read off a curve of a push: forces of walls and feet, drifts, flanges, joints and the first crack."""

from dataclasses import asdict
from typing import Any

import numpy as np

from extrados.analyses.context import Context
from extrados.analyses.shell.model import ShellModel
from extrados.analyses.shell.sections import Section, cracks, drifts, place_axes, point_places, sections
from extrados.analyses.shell.sliding import sliding_limits
from extrados.analyses.shell.tables import Pushover
from extrados.analyses.sla.events import Curve
from extrados.analyses.sla.kept import State
from extrados.analyses.sla.measures import numbers_of
from extrados.core.sla import EVENT

#: Part of the weight that walls across the push must take up or down to count as working flanges
WORKING = 0.05
#: Cosine of the angle between a wall and the push below which the wall stands across
ACROSS = 0.5


def facing_of_walls(model: ShellModel) -> np.ndarray:
    """Cosine of each wall's direction to the push: forces of a section act from the part above on the part below."""
    return np.array([float(wall.along @ model.along[:2]) for wall in model.mesh.walls])


def forces_of_walls(model: ShellModel, found: list[Section]) -> tuple[np.ndarray, np.ndarray]:
    """Shear along each wall and normal force at the feet [N]."""
    shear, normal = np.zeros(len(model.mesh.walls)), np.zeros(len(model.mesh.walls))
    for section in found:
        if section.storey == 1:
            shear[section.wall] += section.shear
            normal[section.wall] += section.normal
    return shear, normal


def numbers_of_push(context: Context, model: ShellModel, options: Pushover, curve: Curve, elastic: dict[str, Any]) -> dict[str, Any]:
    """Results of one curve."""
    numbers = numbers_of(model, options, curve)
    state = shown_state(model, curve)
    force = curve.force(model.unit)
    greatest = numbers["greatest_load_N"]
    limits = sliding_limits(model, context.building, options, elastic["under"])
    least = min(limits, key=lambda row: (round(row.base_shear_N / model.weight, 9), row.height_m), default=None)
    capacity = greatest
    if least is not None:
        capacity = None if greatest is None else min(greatest, least.base_shear_N)
        numbers |= {
            "sliding_capacity_N": least.base_shear_N,
            "sliding_level": least.level,
            "sliding": [asdict(row) | {"base_shear_N": row.base_shear_N} for row in limits],
        }
    numbers |= {
        "capacity_N": None if model.driven else capacity,
        "base_shear_coefficient": None if capacity is None or model.driven else capacity / model.weight,
        "roof_drift": None,
        "storey_drifts": [],
        "walls": [],
        "cracked_points_by_storey": [],
    }
    crack = _first_crack(model, curve)
    if crack is not None:
        numbers["first_crack"] = crack
    if state is None:
        return numbers
    base = float(force[state.event])
    seen = cracks(model, state.report)["part"] > 0.0
    storey = point_places(model)["storey"]
    numbers["cracked_points_by_storey"] = np.bincount(storey[seen], minlength=len(model.mesh.levels))[1:].tolist()
    if len(model.seats) < len(model.mesh.joints):
        numbers["joints"] = _joints(model, curve, state)
    if model.seats:
        numbers["seats"] = _seats(model, curve, elastic)
    if not model.mesh.walls:
        numbers["feet"] = _feet(context, model, options, curve, state)
        return numbers
    if not model.driven:
        height = float(model.mesh.xyz[model.control.node, 2].mean())
        numbers["roof_drift"] = numbers["greatest_load_displacement_m"] / height
    every, walls = drifts(model, state.displacement, curve.sign)
    numbers["storey_drifts"] = every.tolist()
    shear, normal = forces_of_walls(model, sections(model, state.report))
    shear0, normal0 = forces_of_walls(model, elastic["constant"])
    shear1, _ = forces_of_walls(model, elastic["pushed"])
    base = 0.0 if model.driven else base
    facing = facing_of_walls(model)
    carried = curve.sign * shear * facing
    numbers["walls"] = [
        {
            "wall": wall.name,
            "shear_N": float(carried[w]),
            "share": float(carried[w] / base) if base else 0.0,
            "normal_N": float(normal[w]),
            "normal_change_N": float(normal[w] - normal0[w]),
            "elastic_share": float((shear1[w] - shear0[w]) * facing[w] / elastic["unit"]),
            "drifts": walls[w].tolist(),
        }
        for w, wall in enumerate(model.mesh.walls)
    ]
    across = np.abs(facing) < ACROSS
    if across.any() and not across.all() and base:
        change = (normal - normal0)[across]
        up, down = float(change[change > 0].sum()), float(-change[change < 0].sum())
        numbers["flanges"] = {
            "share": float(1.0 - carried[~across].sum() / base),
            "uplift_N": up,
            "pressure_N": down,
            "working": max(up, down) > WORKING * model.weight,
        }
    return numbers


def shown_state(model: ShellModel, curve: Curve) -> State | None:
    """The state that stands for a curve: of the greatest load, where supports move the last."""
    if model.driven:
        return curve.states[-1] if curve.states else None
    return next((s for s in curve.states if s.event == curve.peak), None)


def _joints(model: ShellModel, curve: Curve, state: State) -> list[dict[str, Any]]:
    """How far each joint has come apart in a state, and in the last one that is in equilibrium."""
    last = next((s for s in reversed(curve.states) if curve.held[s.event]), state)
    rows, force = [], curve.force(model.unit)
    for joint, points in model.joints():
        if joint.floor:
            continue
        hits = np.flatnonzero((curve.events.point >= points.start) & (curve.events.point < points.stop))
        found: dict[str, Any] = {"joint": joint.name, "wall": joint.wall}
        for prefix, at in (("", state), ("last_", last)):
            found[f"{prefix}opening_m"] = max(float(at.report["strain_n"][points].max()), 0.0)
            slip = np.hypot(at.report["strain_ns"][points], at.report["strain_s"][points])
            found[f"{prefix}slip_m"] = float(slip.max())
        area = last.report["volume"][points]
        broken = (last.report["tooth_n"][points] > 1) | (last.report["tooth_s"][points] > 1)
        found["first_base_shear_N"] = float(force[hits[0]]) if len(hits) else None
        found["broken_share"] = float(area[broken].sum() / area.sum())
        rows.append(found)
    return rows


def _seats(model: ShellModel, curve: Curve, elastic: dict[str, Any]) -> list[dict[str, Any]]:
    """Load, friction and slip of each seat of a floor, and where the floor slid off."""
    rows, under = [], elastic["under"]
    force, held, slips = curve.force(model.unit), curve.held, model.slips(curve.events.monitors)
    for (joint, points), slip in zip(((j, p) for j, p in model.joints() if j.floor), slips, strict=True):
        normal = -float((under["stress_n"][points] * under["volume"][points]).sum())
        length = float(joint.thickness[0])
        off = np.flatnonzero(held & (slip[:, 0] > length))
        greatest = np.where(held[:, None], slip, 0.0).max(axis=0, initial=0.0)
        rows.append(
            {
                "floor": joint.floor,
                "wall": joint.wall,
                "normal_N": normal,
                "friction_N": joint.strength["friction"] * normal,
                "length_m": length,
                "slip_m": float(greatest[0]),
                "slip_along_m": float(greatest[1]),
                "slid_off": bool(len(off)),
                "slid_off_displacement_m": float(curve.events.monitors[off[0], 0]) if len(off) else None,
                "slid_off_base_shear_N": float(force[off[0]]) if len(off) else None,
            }
        )
    return rows


def _feet(context: Context, model: ShellModel, options: Pushover, curve: Curve, state: State) -> list[dict[str, Any]]:
    """Forces of each springing of a vault on its support in a state: outward thrust and weight."""
    borne = model.borne(options, curve, state, context.threads)
    by = {(ground.foot, ground.way): borne[k] for ground, k in model.grounds.items() if ground.x is None}
    return [
        {"foot": foot.name, "thrust_N": float(by.get((f, "out"), 0.0)), "vertical_N": float(by.get((f, "down"), 0.0))}
        for f, foot in enumerate(model.mesh.feet)
    ]


def _first_crack(model: ShellModel, curve: Curve) -> dict[str, Any] | None:
    """Where the first tooth of the push passes, or of the weight before it."""
    for events, loads in ((curve.stage_a, lambda e: np.zeros(len(e))), (curve.events, lambda _: curve.force(model.unit))):
        if events is None or not len(events):
            continue
        hits = np.flatnonzero(np.isin(events.code, [EVENT["tension"], EVENT["tension_s"]]) & (events.point >= 0))
        for k in hits:
            at = _place_of(model, int(events.point[k]))
            if at is not None:
                return at | {"base_shear_N": float(loads(events)[k])}
    return None


def _place_of(model: ShellModel, point: int) -> dict[str, Any] | None:
    """The wall, storey and place of a point; None of floors and bars."""
    place, places = 0, point_places(model)
    for part, points, layers in model.places():
        if points.start <= point < points.stop:
            k = place + (point - points.start) // layers
            at = place_axes(model)["xyz"][k]
            where = {"wall": part.name, "storey": int(places["storey"][k]), "place_m": at.tolist()}
            if part.wall < 0:
                return where | {"height_m": float(at[2] - model.mesh.levels[0])}
            return where | {"along_m": float(places["s"][k]), "height_m": float(places["z"][k])}
        place += (points.stop - points.start) // layers
    return None
