"""thrust: admissible thrust lines at a given acceleration, safety, reactions, friction needed (thesis 3.2)."""

import numpy as np

from extrados.analyses.context import Context, Refused
from extrados.analyses.limit.common import (
    geometry_arrays,
    graphic_arrays,
    limit_of,
    reaction_rows,
    state_arrays,
)  # fmt: skip
from extrados.analyses.limit.tables import Thrust
from extrados.building.geometry.assembly import Assembly
from extrados.limit.answer import CannotStand, assess
from extrados.limit.programme import NoEquilibrium, State
from extrados.results import limit as out
from extrados.results.model import Result, TableData


def run(context: Context, options: Thrust) -> Result:
    """Least, greatest and most central thrust line, each with its force polygon."""
    assembly: Assembly = context.building.blocks()
    limit = limit_of(context.building, options)
    chain = options.chain or next(iter(assembly.chains))
    if chain not in assembly.chains:
        raise Refused(f"chain: there is no '{chain}'; there are {', '.join(assembly.chains)}")
    springing = assembly.chains[chain][0]
    try:
        answer = assess(assembly, limit=limit)
    except CannotStand as error:
        raise Refused(f"the structure cannot stand under its own weight: {error}") from None
    low, high = answer.back_state.gamma, answer.gamma
    try:
        least, most = limit.thrust(springing, options.gamma)
        central, part = limit.central(options.gamma, start=[least, most])
    except NoEquilibrium:
        raise Refused(
            f"at {options.gamma:g} g no thrust line is admissible: the structure bears {low:.4f} to {high:.4f} g"
        ) from None
    states = {"least": least, "most": most, "central": central}
    result = Result("thrust")
    lines = {}
    for name, state in states.items():
        thrust = limit.horizontal(state, springing)
        lines[name] = out.ThrustLine(
            horizontal_N=thrust,
            horizontal_kN_per_m=thrust / assembly.depth / 1e3,
            over_weight=thrust / answer.loads.scale,
            required_friction=state.friction.max(),
            required_friction_joint=assembly.joint_names[int(state.friction.argmax())],
            greatest_eccentricity_ratio=np.abs(state.position - 0.5).max(),
            reactions=reaction_rows(answer, state),
        )
        result.tables[f"thrust_{name}"] = _table(assembly, state)
    r = out.Thrust(
        gamma_g=options.gamma,
        chain=chain,
        admissible_interval_g=[low, high],
        geometric_safety_factor=1.0 / part,
        least_part_of_joints=part,
        weight_N=answer.loads.scale,
        depth_m=assembly.depth,
        duality_gap=answer.gap,
        **lines,
    )
    result.results = r
    result.arrays = geometry_arrays(assembly)
    about = {"least": "of least thrust", "most": "of greatest thrust", "central": "that is most central"}
    for name, state in states.items():
        result.arrays.update(state_arrays(assembly, name, state, about[name]))
        result.arrays.update(graphic_arrays(answer, name, state, about[name]))
    needed = np.inf if r.central.required_friction is None else r.central.required_friction
    result.answer = (
        f"At {options.gamma:g} g the thrust of the {chain} lies between {r.least.horizontal_kN_per_m:.4g} and "
        f"{r.most.horizontal_kN_per_m:.4g} kN per metre of depth at its left springing; the most central line "
        f"({r.central.horizontal_kN_per_m:.4g} kN/m) keeps to the middle {100 * part:.1f} % of the joints "
        f"(geometric safety factor {1 / part:.2f}) and needs a friction of {needed:.2f}. "
        f"Lines are admissible from {low:.4f} to {high:.4f} g."
    )
    return result


def _table(assembly: Assembly, state: State) -> TableData:
    """Forces of each joint, per metre of depth."""
    points = state.points(assembly)
    force = state.force(assembly) / assembly.depth / 1e3
    return TableData(
        {
            "joint": assembly.joint_names,
            "normal": state.normal / assembly.depth / 1e3,
            "shear": state.shear / assembly.depth / 1e3,
            "horizontal": force[:, 0],
            "vertical": force[:, 1],
            "eccentricity": (state.position - 0.5) * assembly.length,
            "joint_length": assembly.length,
            "x": points[:, 0],
            "y": points[:, 1],
            "friction_needed": state.friction,
        },
        {
            **dict.fromkeys(("normal", "shear", "horizontal", "vertical"), "kN/m"),
            **dict.fromkeys(("eccentricity", "joint_length", "x", "y"), "m"),
        },
    )
