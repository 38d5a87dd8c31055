"""tilt: the horizontal acceleration at which the arch becomes a mechanism (thesis 3.3)."""

import numpy as np

from extrados.analyses.arch_model import ArchModel
from extrados.analyses.run import Context
from extrados.decks.analyses import Tilt
from extrados.limit.programme import LimitAnalysis, State
from extrados.results.model import Array, Result
from extrados.structures.assembly import Assembly


def geometry_arrays(assembly: Assembly) -> dict[str, Array]:
    """What every picture of the structure needs."""
    outlines = [np.asarray(o) for o in assembly.outlines]
    return {
        "joint_p": Array(assembly.p, ("joint", "axis"), "m", "first ends of the joints (intrados)"),
        "joint_q": Array(assembly.q, ("joint", "axis"), "m", "second ends of the joints (extrados)"),
        "outline": Array(
            np.concatenate(outlines), ("vertex", "axis"), "m", "outlines of the blocks, one after the other"
        ),
        "outline_start": Array(
            np.cumsum([0, *map(len, outlines)]),
            ("block_edge",),
            "",
            "first vertex of each block, and the end",
        ),
        "centroid": Array(assembly.centroid, ("block", "axis"), "m", "centroids of the blocks"),
    }


def state_arrays(assembly: Assembly, name: str, state: State, about: str) -> dict[str, Array]:
    """A thrust line and its forces under names that begin with `name`."""
    return {
        f"{name}_point": Array(state.points(assembly), ("joint", "axis"), "m", f"thrust line {about}"),
        f"{name}_normal": Array(state.normal, ("joint",), "N", f"compression across the joints {about}"),
        f"{name}_shear": Array(state.shear, ("joint",), "N", f"shear along the joints {about}"),
        f"{name}_friction": Array(state.friction, ("joint",), "", f"coefficient of friction needed {about}"),
    }


def run(context: Context, options: Tilt) -> Result:
    """Capacity both ways, hinges, mechanism, thrust line at collapse, least and greatest thrust upright."""
    model = ArchModel(context.structure)
    arch = model.arch
    _ = model.collapse  # refuses an arch that cannot stand, with the minimum thickness
    limit = model.limit if options.friction is None else LimitAnalysis(arch, options.friction)
    if options.friction is not None and not limit.stands():
        from extrados.analyses.run import Refused

        raise Refused(
            f"with a coefficient of friction of {options.friction:g} the arch slides apart under its own weight; "
            f"without sliding it needs {model.limit.thrust(0)[0].friction.max():.3f} at the least thrust"
        )
    state, mechanism = limit.collapse(1)
    back, _ = limit.collapse(-1)
    least, most = limit.thrust(0)
    tilt = float(np.degrees(np.arctan(state.gamma)))
    hinges = [{"joint": j, "side": side} for j, side in mechanism.hinges]
    result = Result("tilt")
    result.results = {
        "collapse_acceleration_g": state.gamma,
        "collapse_acceleration_opposite_g": -back.gamma,
        "tilt_angle_deg": tilt,
        "load_direction": "+x",
        "hinges": hinges,
        "sliding_joints": mechanism.sliding,
        "required_friction": float(state.friction.max()),
        "required_friction_joint": int(state.friction.argmax()),
        "thrust_min_N": limit.horizontal(least, 0),
        "thrust_max_N": limit.horizontal(most, 0),
        "weight_N": limit.forces.weight,
        "duality_gap": abs(state.gamma - mechanism.upper_bound),
    }
    result.arrays = {
        **geometry_arrays(arch),
        **state_arrays(arch, "collapse", state, "at collapse, load to +x"),
        **state_arrays(arch, "least", least, "of least thrust, upright"),
        **state_arrays(arch, "most", most, "of greatest thrust, upright"),
        "velocity": Array(mechanism.velocity, ("block", "component"), "m, m, rad", "mechanism: x, y, rotation"),
    }
    where = ", ".join(f"{h['side']} at joint {h['joint']}" for h in hinges)
    slides = f"; joints {', '.join(map(str, mechanism.sliding))} slide" if mechanism.sliding else ""
    result.answer = (
        f"The arch becomes a mechanism at a constant horizontal acceleration of {state.gamma:.4f} g, "
        f"or when its base is tilted by {tilt:.2f} degrees. Pushed to +x it hinges at the {where}{slides} "
        f"(joint 0 is the left springing). Friction of {result.results['required_friction']:.2f} is needed."
    )
    return result
