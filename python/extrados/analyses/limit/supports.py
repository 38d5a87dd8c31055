"""supports: an arch whose right support spreads or settles, from rest until it falls."""

import numpy as np

from extrados.analyses.context import Context, Refused
from extrados.analyses.limit.common import geometry_arrays
from extrados.analyses.limit.tables import Supports
from extrados.building.geometry.assembly import Assembly
from extrados.building.geometry.chains import in_order
from extrados.limit.places import place_of
from extrados.limit.programme import NoEquilibrium
from extrados.limit.supports import support_movement
from extrados.results import limit as out
from extrados.results.model import Array, Result, TableData

SHOWN = (0.0, 0.25, 0.5, 0.75, 1.0)  # of the movement at the fall


def _place(arch: Assembly, hinge: tuple[int, str]) -> str:
    """Where a hinge is, in words."""
    joint, side = hinge
    return place_of(arch, joint, (arch.p if side == "intrados" else arch.q)[joint])


def run(context: Context, options: Supports) -> Result:
    """States on the way, the movement at the fall, how the thrust and the hinges change."""
    if options.spread == 0.0 and options.settle == 0.0:
        raise Refused("supports: with spread = 0 and settle = 0 nothing moves")
    arch = in_order(context.building.blocks())
    try:
        states = support_movement(arch, (options.spread, -options.settle), options.steps)
    except NoEquilibrium as error:
        raise Refused(f"the arch cannot follow the movement: {error}") from None
    movement = np.array([s.movement for s in states])
    force = np.array([s.force for s in states])
    ends = arch.p[[0, -1]]
    span = float(np.hypot(*(ends[1] - ends[0])))
    stages = [0, *[i for i in range(1, len(states)) if states[i].hinges != states[i - 1].hinges]]
    last = states[-1]
    touched = np.minimum(last.position, 1.0 - last.position) < 1e-5
    fourth = [int(k) for k in np.flatnonzero(touched) if k not in {h[0] for h in last.hinges}]
    result = Result("supports")
    r = out.Supports(
        movement_at_fall_m=float(movement[-1]),
        movement_at_fall_over_span=float(movement[-1] / span),
        span_change_at_fall_ratio=float(
            movement[-1] * options.spread / np.hypot(options.spread, options.settle) / span
        ),
        thrust_at_rest_N=float(force[0, 0]),
        thrust_at_fall_N=float(force[-1, 0]),
        hinges_at_rest=[out.JointHinge(joint=k, side=side) for k, side in states[0].hinges],
        hinges_at_fall=[out.JointHinge(joint=k, side=side) for k, side in last.hinges],
        joints_touched_at_fall=fourth,
        stages=[
            out.Stage(movement_m=movement[i], hinges=[_place(arch, hinge) for hinge in states[i].hinges])
            for i in stages
        ],
    )
    result.results = r
    shown = [int(np.abs(movement - share * movement[-1]).argmin()) for share in SHOWN]
    result.arrays = {
        **geometry_arrays(arch),
        "movement": Array(movement, ("movement",), "m", "movement of the right support"),
        "force": Array(force, ("movement", "axis"), "N", "force of the arch on the right support"),
        "energy": Array(np.array([s.energy for s in states]), ("movement",), "J", "potential energy over that at rest"),
        "hinge": Array(np.array([[h[0] for h in s.hinges] for s in states]), ("movement", "hinge_number"), "", "joints that hinge"),
        "shown_movement": Array(movement[shown], ("shown",), "m", "movements drawn"),
        "shown_pose": Array(np.array([states[i].pose for i in shown]), ("shown", "block", "component"), "m, m, rad", "places of the centroids, rotations"),
        "shown_point": Array(np.array([states[i].points for i in shown]), ("shown", "joint", "axis"), "m", "thrust line on the displaced joints"),
    }  # fmt: skip
    result.tables = {
        "supports": TableData(
            {"movement": movement, "horizontal": force[:, 0], "vertical": force[:, 1],
             "hinges": ["; ".join(f"{side} {k}" for k, side in s.hinges) for s in states]},
            {"movement": "m", "horizontal": "N", "vertical": "N"},
        )
    }  # fmt: skip
    way = "spreads" if options.spread > 0 and options.settle == 0 else "moves"
    result.answer = (
        f"The right support {way}: the arch follows on three hinges ({'; '.join(_place(arch, hinge) for hinge in states[0].hinges)}) "
        f"and falls at {movement[-1]:.4g} m, {100 * movement[-1] / span:.2f} % of the span, after "
        f"{len(stages) - 1} change{'s' if len(stages) != 2 else ''} of hinges; meanwhile the thrust goes from "
        f"{force[0, 0] / 1e3:.4g} to {force[-1, 0] / 1e3:.4g} kN."
    )
    return result
