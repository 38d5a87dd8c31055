"""The damping at which a single block loses at its impacts what is wanted."""

from dataclasses import replace

import numpy as np

from extrados.analyses.context import Refused
from extrados.analyses.dem import impact_rules, measures
from extrados.analyses.dem.model import JointValues, Model
from extrados.analyses.dem.trial import about_a_toe
from extrados.core import dem
from extrados.model.structures.block import BlockAssembly
from extrados.schema.constants import GRAVITY
from extrados.views.building import Building
from extrados.views.rockers.block import BlockModel

#: Fractions of critical damping at edge impact that are tried, and how closely the restitution is met.
LEAST, MOST, ACCURACY = 0.05, 20.0, 0.003
#: Of the angle at which it would overturn: where the block is let go.
START = 0.3


def beta_for_restitution(building: Building, values: JointValues) -> float:
    """beta [s] at which the first impacts of a block that is let go keep the wanted share of its rate: [joints] restitution
    where that is a number, else Housner's. Refused where no damping gives it: dashpots take what a blow without rebound takes
    (Housner 1963) at the most, and without them the block bounces."""
    block, joints = building.blocks(), building.joints
    assert isinstance(block, BlockAssembly)
    wanted = joints.restitution if isinstance(joints.restitution, float) else float(BlockModel(block).housner[0])
    if joints.energy_ratio is not None:
        wanted = float(np.sqrt(joints.energy_ratio))

    def found(ratio: float) -> float:
        beta = impact_rules.damping_constant(float(values.impact.edge.max()), ratio)
        return _restitution(Model(block, building.rigid(), replace(values, beta=beta)))

    low, high = LEAST, MOST
    most, least = found(low), found(high)
    if not least - ACCURACY <= wanted <= most:
        raise Refused(
            f"no damping of this block gives a coefficient of restitution of {wanted:.3g}: give a value from {least:.3g} to {most:.3g}",
            ("joints", "restitution" if joints.energy_ratio is None else "energy_ratio"),
        )
    while high / low > 1.01:
        middle = float(np.sqrt(low * high))
        now = found(middle)
        if abs(now - wanted) < ACCURACY:
            low = high = middle
        elif now > wanted:
            low = middle
        else:
            high = middle
    return impact_rules.damping_constant(float(values.impact.edge.max()), high)


def _restitution(model: Model) -> float:
    """Rate after over rate before the impacts of a block that is let go at an angle."""
    block = model.assembly
    assert isinstance(block, BlockAssembly)
    arm = float(np.hypot(*(block.centroid[0] - block.q[0])))
    inertia = float(block.inertia[0] + block.mass[0] * arm**2)
    swing = float(np.sqrt(inertia / (block.mass[0] * GRAVITY * arm)))
    period = 4.0 * swing * float(np.arccosh(1.0 / (1.0 - START)))  # Housner 1963, Eq. 6 [s]
    shift = about_a_toe(block, 0, START, len(model.rigid.mass))
    options = dem.Options(end_time=0.8 * period, output_step=0.001 * period)
    run = dem.run(model.bodies(), options, shift=shift)
    state = measures.hinges(model, *measures.openings(model, run))
    kept = measures.restitution(run, state, np.zeros(len(run.time)))
    return 1.0 if kept is None else kept
