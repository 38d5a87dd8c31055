"""Verification by displacement of a building of walls and floors."""

from dataclasses import replace
from typing import Any

import numpy as np

from extrados.analyses.codes.actions import code_of
from extrados.analyses.codes.capacity_curve import CapacityCurve
from extrados.analyses.codes.verification import DRIFTS, Push, displaced_shape, unverified, verify
from extrados.analyses.context import Context
from extrados.analyses.shell.measures import ACROSS
from extrados.analyses.shell.model import ShellModel, first_mode
from extrados.analyses.shell.sections import drifts
from extrados.analyses.shell.tables import Pushover
from extrados.analyses.sla.events import Curve
from extrados.results.model import Result
from extrados.results.verification import Verification


def verify_push(
    context: Context, result: Result, model: ShellModel, options: Pushover, curves: list[Curve], numbers: dict[str, Any]
) -> Verification | None:
    """Displacement demand and capacity of all senses; conditions that its curves do not know."""
    mass = model.mesh.mass()
    with model.open(options, 1) as core_model:
        shape, through = displaced_shape(core_model, model.reference, model.control, model.along, model.freedoms.equation >= 0)
    if options.verification.shape == "mode":
        shape, *_ = first_mode(model, options, mass)
        c = model.control
        shape = shape / float((c.share * model.along[c.direction]) @ shape[c.node])
    drifts_of_piers = DRIFTS.get(code_of(context).jurisdiction)
    pushes, violated = [], []
    for curve in curves:
        if curve.peak < 0:
            violated.append(unverified(curve.sense))
            continue
        d, p = curve.envelope(model.unit)
        found = CapacityCurve(d - d[0], through * p, mass, shape)
        if drifts_of_piers is not None:
            shear, flexure = (_drift_reached(model, curve, limit) for limit in drifts_of_piers)
            found = replace(found, limits={} if flexure is None else {"drift": flexure - curve.before})
            if shear is not None and shear - curve.before < found.ultimate:
                violated.append(
                    f"Towards {curve.sense}, a wall reaches the limit drift of piers in shear ({100 * drifts_of_piers[0]:.2g} %) at "
                    f"{1e3 * shear:.3g} mm, before the collapse displacement. If its piers fail in shear, the curve ends there."
                )
        pushes.append(Push(curve.sense, found, float(mass.sum())))
    for own in (numbers, numbers.get("minus")):
        if own is not None and own["capacity_N"] is not None and own["capacity_N"] < own["greatest_load_N"]:
            violated.append(
                f"Towards {own['sense']}, the building slides at {own['sliding_level']} under {own['capacity_N'] / 1e3:.3g} kN, "
                "but the capacity curve excludes this sliding."
            )
    return verify(context, result, options.verification, pushes, violated)


def _drift_reached(model: ShellModel, curve: Curve, limit: float) -> float | None:
    """Control displacement [m] at which a storey of a wall along the push has a drift, by straight lines between the kept
    states in equilibrium (the greatest load and the last among them); None where none reaches it."""
    along = [w for w, wall in enumerate(model.mesh.walls) if abs(float(wall.along @ model.along[:2])) >= ACROSS]
    at, most = [curve.before], [0.0]
    for state in curve.states:
        if curve.held[state.event]:
            at.append(float(curve.events.monitors[state.event, 0]))
            most.append(float(np.nanmax(drifts(model, state.displacement, curve.sign)[1][along], initial=0.0)))
    order = np.argsort(at)
    d, drift = np.array(at)[order], np.maximum.accumulate(np.array(most)[order])
    return float(np.interp(limit, drift, d)) if drift[-1] >= limit else None
