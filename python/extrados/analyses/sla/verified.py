"""Verification by displacement of a wall that is pushed by the inertia of its masses."""

from dataclasses import replace

import numpy as np

from extrados.analyses.codes.actions import code_of
from extrados.analyses.codes.capacity_curve import CapacityCurve
from extrados.analyses.codes.verification import DRIFTS, Push, displaced_shape, unverified, verify
from extrados.analyses.context import Context
from extrados.analyses.sla.events import Curve
from extrados.analyses.sla.model import SlaModel
from extrados.analyses.sla.tables import Sla
from extrados.results.model import Result
from extrados.results.verification import Verification
from extrados.schema.constants import GRAVITY

#: Part of the weight below which loads without mass are rounding
ROUNDING = 1e-6


def verify_wall(context: Context, result: Result, model: SlaModel, options: Sla, curves: list[Curve]) -> Verification | None:
    """Displacement demand and capacity of all senses; conditions that the curves do not know. The masses are those of the push."""
    assert model.acceleration is not None
    along = model.reference.sum(axis=0) / np.linalg.norm(model.reference.sum(axis=0))
    mass = model.reference @ along / model.acceleration
    with model.open(options, 1) as core_model:
        shape, through = displaced_shape(core_model, model.reference, model.control, along, model.freedoms.equation >= 0)
    violated, pushes = [], []
    without = float(-model.constant[:, 1].sum() - GRAVITY * mass.sum())
    if without > ROUNDING * GRAVITY * mass.sum():
        violated.append(
            f"Vertical loads of {without / 1000.0:.3g} kN on the wall are not part of the mass on which the "
            "horizontal load acts. The period and the demand are therefore too small."
        )
    y = model.mesh.xy[:, 1]
    top = float(shape[y > y.max() - 1e-6].mean()) / float(np.ptp(y))  # drift for a unit of the control displacement
    limits = DRIFTS.get(code_of(context).jurisdiction)
    for curve in curves:
        if curve.peak < 0:
            violated.append(unverified(curve.sense))
            continue
        d, p = curve.envelope(model.unit)
        found = CapacityCurve(d - d[0], through * p, mass, shape)
        if limits is not None:
            shear, flexure = (limit / top for limit in limits)
            found = replace(found, limits={"drift": flexure} if flexure <= found.displacement[-1] else {})
            if shear < found.ultimate:
                violated.append(
                    f"Towards {curve.sense}, the wall reaches the limit drift of piers in shear ({100 * limits[0]:.2g} %) at "
                    f"{1e3 * shear:.3g} mm, before the collapse displacement. If its piers fail in shear, the curve ends there."
                )
        pushes.append(Push(curve.sense, found, float(mass.sum())))
    return verify(context, result, options.verification, pushes, violated)
