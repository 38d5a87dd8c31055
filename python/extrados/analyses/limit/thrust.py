"""thrust: admissible thrust lines at a given acceleration, safety, reactions, friction needed (thesis 3.2)."""

import numpy as np

from extrados.analyses.context import Context, Refused
from extrados.analyses.limit.applied import chain_of
from extrados.analyses.limit.common import (
    geometry_arrays,
    graphic_arrays,
    limit_of,
    load_arrays,
    reaction_rows,
    spoken_ties,
    state_arrays,
    tie_arrays,
    tie_rows,
)
from extrados.analyses.limit.tables import Thrust
from extrados.analyses.needs import in_space
from extrados.limit.answer import Answer, assess, safety_factor
from extrados.limit.graphic import thrust_joint, thrust_of
from extrados.limit.programme import LimitAnalysis, NoAnswer, NoEquilibrium, State
from extrados.model.dimensions import with_article
from extrados.model.geometry.assembly import Assembly
from extrados.model.geometry.chains import is_stack
from extrados.results import limit as out
from extrados.results.fields import Keys, given
from extrados.results.model import Result, TableData
from extrados.schema.quantities import three_figures


def run(context: Context, options: Thrust) -> Result:
    """Least, greatest and most central thrust line, each with its force polygon; of solids the states of stress."""
    if in_space(context.building, options):
        from extrados.analyses.limit import solid_thrust  # with a solver of its own, which takes a while to load

        return solid_thrust.run(context, options)
    assembly: Assembly = context.building.blocks()
    limit = limit_of(context.building, options, forces_only=True)
    chain = chain_of(assembly, options.chain)
    answer = assess(assembly, limit=limit)
    low, high = answer.back_state.gamma, answer.gamma
    ends: dict[str, State] = {}
    result = Result("thrust")
    try:
        if chain is not None:
            ends = dict(zip(("least", "most"), limit.thrust(assembly.chains[chain], options.gamma), strict=True))
        elif not low <= options.gamma <= high:
            raise NoEquilibrium
        states, part = _with_central(limit, options.gamma, ends, result)
    except NoEquilibrium:
        raise Refused(
            f"no thrust line is admissible at {options.gamma:g} g: the structure can carry accelerations from {low:.4f} to {high:.4f} g",
            ("analysis", "gamma"),
        ) from None
    safety = None if part is None else safety_factor(part)
    lines: Keys = {}
    for name, state in states.items():
        lines[name] = out.ThrustLine(
            **_horizontal(answer, state, chain),
            required_friction=state.friction.max(),
            required_friction_joint=assembly.joint_names[int(state.friction.argmax())],
            greatest_eccentricity_ratio=np.abs(state.position - 0.5).max(),
            reactions=reaction_rows(answer, state),
            **tie_rows(context.building, answer.loads, state),
        )
        result.tables[f"thrust_{name}"] = _table(assembly, state)
    r = out.Thrust(
        gamma_g=options.gamma,
        chain=chain,
        admissible_interval_g=[low, high],
        geometric_safety_factor=safety,
        weight_N=answer.loads.scale,
        depth_m=assembly.depth,
        dilating=bool(limit.dilating(answer.mechanism) or limit.dilating(answer.back_mechanism)),
        duality_gap=answer.gap,
        **lines,
        **given(least_part_of_joints=part),
    )
    result.results = r
    result.arrays = geometry_arrays(assembly) | tie_arrays(context.building, answer.loads, states)
    result.arrays |= load_arrays(assembly, options.load)
    about = {"least": "for the least thrust", "most": "for the greatest thrust", "central": "in the most central equilibrium"}
    for name, state in states.items():
        result.arrays.update(state_arrays(assembly, name, state, about[name]))
        result.arrays.update(graphic_arrays(answer, name, state, about[name]))
    result.warnings += answer.warnings
    result.answer = _words(r, assembly)
    return result


def _with_central(limit: LimitAnalysis, gamma: float, ends: dict[str, State], result: Result) -> tuple[dict[str, State], float | None]:
    """The states with the most central one, and the part of the joints that holds it; without it, and with a warning, where
    it does not settle though a state is admissible."""
    try:
        central, part = limit.central(gamma, start=list(ends.values()))
    except (NoAnswer, NoEquilibrium) as error:
        result.warnings.append(f"the most central thrust line is not given: {error}")
        return ends, None
    return {**ends, "central": central}, part


def _horizontal(answer: Answer, state: State, chain: str | None) -> Keys:
    """Horizontal thrust of a chain, of one that ties hold at its crown too; nothing where there is none."""
    if chain is None:
        return {}
    assembly, joints = answer.assembly, answer.assembly.chains[chain]
    thrust, at = thrust_of(assembly, state, joints), thrust_joint(assembly, answer.loads, joints)
    crown = {"crown_N": thrust_of(assembly, state, joints, at)} if at else {}
    return {
        "horizontal_N": thrust,
        "horizontal_kN_per_m": thrust / assembly.depth / 1e3,
        "over_weight": thrust / answer.loads.scale,
        **crown,
    }


def _words(r: out.Thrust, assembly: Assembly) -> str:
    part, safety, central = r.least_part_of_joints, r.geometric_safety_factor, r.central
    needs = ""
    if central is not None:
        keeps = (
            "can pass within 1 % of the joint length from the middle of each joint (no horizontal demand)"
            if safety is None
            else f"stays within the central {100 * part:.1f} % of the joints (geometric safety factor {safety:.2f})"
        )
        needed = np.inf if central.required_friction is None else central.required_friction
        needs = f"{keeps} and requires a coefficient of friction of {needed:.2f}"
    if r.chain is None:
        text = (
            f"At {r.gamma_g:g} g {(f'the most central state {needs}' if needs else 'an equilibrium state is admissible')}. "
            "The blocks form no arch or column, so no minimum and maximum thrust are given."
        )
    else:
        tied = r.least.crown_N is not None
        least, most = (line.told_kN_per_m(r.depth_m) for line in (r.least, r.most))
        if central is not None and is_stack(assembly, assembly.chains[r.chain]):  # determinate: all lines are one at its base
            text = (
                f"At {r.gamma_g:g} g the most central thrust line of the stack (horizontal thrust "
                f"{three_figures(central.horizontal_kN_per_m)} kN/m at its base) {needs}."
            )
        else:
            text = (
                f"At {r.gamma_g:g} g the horizontal thrust of {with_article(r.chain)} lies between {three_figures(least)} and {three_figures(most)} kN per metre "
                f"of depth, at its {'crown' if tied else 'left springing'}"
            )
            if central is not None:
                text += f"; the most central thrust line ({three_figures(central.told_kN_per_m(r.depth_m))} kN/m) {needs}"
            text += "."
            if tied:
                shown = central or r.least
                text += f" Of this thrust, {three_figures(shown.horizontal_kN_per_m)} kN/m act at the left springing, and the ties carry the rest."
    low, high = r.admissible_interval_g
    shown = central or r.least
    text += spoken_ties(None if shown is None else shown.ties)
    bound = f" (joints slide there: {out.DILATANT})" if r.dilating else ""
    return f"{text} Thrust lines are admissible from {low:.4f} to {high:.4f} g{bound}."


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
