"""dem-parameters: stiffness, impact frequencies and damping of the joints by the rules of thesis 7.3."""

import numpy as np

from extrados.analyses.context import Context
from extrados.analyses.dem import impact_rules
from extrados.analyses.dem import model as dem_model
from extrados.analyses.dem.from_deck import make_model
from extrados.analyses.dem.tables import DemParameters
from extrados.results import dem as out
from extrados.results.model import Array, Result, TableData
from extrados.schema.quantities import engineering


def run(context: Context, options: DemParameters) -> Result:
    """What a run with these options would use, and the damping constants of the three rules."""
    model = make_model(context.building, options)
    v = model.values
    result = Result("dem-parameters")
    constants = {name: impact_rules.damping_constant(float(v.impact.of(name).max())) for name in ("rotation", "corner", "edge")}
    each = {name: impact_rules.damping_ratio(v.beta, v.impact.of(name), options.mass_damping) for name in ("rotation", "corner", "edge")}
    ratios = {name: float(of_joints.min()) for name, of_joints in each.items()}
    result.results = out.DemParameters(
        joint_stiffness_min_Pa_per_m=float(v.stiffness.min()),
        joint_stiffness_max_Pa_per_m=float(v.stiffness.max()),
        **{f"{name}_frequency_rad_s": float(v.impact.of(name).max()) for name in ("rotation", "corner", "edge")},
        **{f"critical_beta_{name}_s": constants[name] for name in constants},
        beta_s=v.beta,
        mass_damping_per_s=options.mass_damping,
        **{f"damping_ratio_{name}": ratios[name] for name in ratios},
        convention=context.building.joints.stiffness_rule,
    )
    result.warnings = dem_model.warnings(model, options)
    columns: dict[str, np.ndarray | list[str]] = {
        "joint": list(model.assembly.joint_names),
        "stiffness": v.stiffness,
        "stone_length": v.length,
        "rotation_frequency": v.impact.rotation,
        "corner_frequency": v.impact.corner,
        "edge_frequency": v.impact.edge,
        **{f"damping_ratio_{name}": of_joints for name, of_joints in each.items()},
    }
    units = {"stiffness": "Pa/m", "stone_length": "m"}
    units |= {f"{name}_frequency": "rad/s" for name in ("rotation", "corner", "edge")}
    result.tables["dem_parameters"] = TableData(columns, units)
    result.arrays = {
        name: Array(np.asarray(values), ("joint",), units.get(name, "")) for name, values in columns.items() if name != "joint"
    }
    result.answer = (
        f"The joint stiffness is {engineering(v.stiffness.min(), 'Pa/m')} to {engineering(v.stiffness.max(), 'Pa/m')}. The greatest "
        f"impact frequencies are {v.impact.rotation.max():.4g} (rotation), {v.impact.corner.max():.4g} (corner) and "
        f"{v.impact.edge.max():.4g} rad/s (edge). With beta = {v.beta:.4g} s, the least damping of all joints is "
        f"{100 * ratios['rotation']:.3g} % (rotation), {100 * ratios['corner']:.3g} % (corner) and {100 * ratios['edge']:.3g} % (edge) of "
        "critical. Advice: use at least 10 % at rotational and 25 % at edge impact. "
        f"Start from 100 % at edge impact (beta = {constants['edge']:.4g} s), and vary beta."
    )
    return result
