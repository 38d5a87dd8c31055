"""tilt: the horizontal acceleration at which a structure becomes a mechanism (thesis chapter 3)."""

from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from functools import partial

import numpy as np

from extrados.analyses.context import Context
from extrados.analyses.limit.common import (
    answer_of,
    collapse_beside,
    fracture_of,
    geometry_arrays,
    graphic_arrays,
    hinge_rows,
    limit_of,
    load_arrays,
    mended_capacity,
    reaction_rows,
    spoken_ties,
    state_arrays,
    tie_arrays,
    tie_rows,
)
from extrados.analyses.limit.paths import doubt, follow_beside, follow_paths
from extrados.analyses.limit.tables import Tilt
from extrados.analyses.needs import in_space
from extrados.core.calls import interruptible
from extrados.limit.answer import CENTRAL, Answer
from extrados.limit.certificate import Certificate, certify
from extrados.limit.coulomb import CoulombState
from extrados.limit.finite_motion import finite_motion
from extrados.limit.fracture import Fracture
from extrados.limit.graphic import thrust_joint, thrust_of
from extrados.limit.load_path import RATIOS
from extrados.limit.plane_path import collapse_along_path
from extrados.limit.programme import LimitAnalysis, Mechanism, NoAnswer, NoEquilibrium, State
from extrados.model.dimensions import with_article
from extrados.model.geometry.assembly import GROUND, Assembly
from extrados.results import limit as out
from extrados.results.fields import Keys
from extrados.results.model import Array, Result
from extrados.views.building import Building

__all__ = ["geometry_arrays", "run", "state_arrays"]

FILM = 90  # tilts of an animation

Paths = tuple[list[out.LoadPath], list[tuple[State, Mechanism]]]  # of one push, and the certified collapses at their ends

MOST_FOLLOWED = 80  # joints up to which load paths are followed beside an upper bound: some seconds
MOST_NAMED = 6  # hinges and sliding joints told in words


#: Above this the joints of masonry slide
USUAL_FRICTION = 0.7


def degrees(gamma: float) -> float:
    """Tilt of the ground at which gravity has a sideways part of gamma (thesis Eq. 3.1)."""
    return float(np.degrees(np.arctan(gamma)))


def run(context: Context, options: Tilt) -> Result:
    """Capacity both ways, hinges, mechanism, thrust line at collapse, least and greatest thrust upright."""
    building = context.building
    if in_space(building, options):
        from extrados.analyses.limit import solids  # with a solver of its own, which takes a while to load

        return solids.run(context, options)
    assembly: Assembly = building.blocks()
    answer, limit, asked = _answer(context, options)
    state, mechanism = answer.collapse_state, answer.mechanism
    result = Result("tilt")
    measures: Keys = assembly.measures
    fracture = _fracture(building, options, answer, result) if options.fracture else {}
    dilating = {1: limit.dilating(mechanism), -1: limit.dilating(answer.back_mechanism)}
    sliding = _without_dilatancy(context, limit, answer, dilating, result, asked)
    found = out.Tilt(
        collapse_acceleration_g=state.gamma,
        collapse_acceleration_opposite_g=-answer.back_state.gamma,
        tilt_angle_deg=degrees(state.gamma),
        tilt_angle_opposite_deg=degrees(-answer.back_state.gamma),
        admissible_interval_g=_admissible(answer, sliding),
        load_direction="+x",
        hinges=hinge_rows(assembly, mechanism.hinges, mechanism.pivot),
        sliding_joints=mechanism.sliding,
        hinges_opposite=hinge_rows(assembly, answer.back_mechanism.hinges, answer.back_mechanism.pivot),
        touching_joints=answer.touching,
        required_friction=float(state.friction.max()),
        required_friction_joint=int(state.friction.argmax()),
        geometric_safety_factor=answer.safety,
        weight_N=answer.loads.scale,
        depth_m=assembly.depth,
        reactions=reaction_rows(answer, state),
        **tie_rows(building, answer.loads, state),
        **tie_rows(building, answer.loads, answer.back_state, "ties_opposite"),
        **_thrusts(answer),
        **measures,
        duality_gap=answer.gap,
        **fracture,
        **sliding,
    )
    result.results = found
    result.arrays |= {
        **geometry_arrays(assembly),
        **state_arrays(assembly, "collapse", state, "at collapse, load to +x"),
        **graphic_arrays(answer, "collapse", state, "at collapse, load to +x"),
        "velocity": Array(mechanism.velocity, ("block", "component"), "m, m, rad", "mechanism: x, y, rotation"),
        "mechanism_pose": Array(
            finite_motion(assembly, mechanism),
            ("block", "component"),
            "m, m, rad",
            "mechanism at a finite displacement: positions of the centroids, and rotations",
        ),
        **tie_arrays(building, answer.loads, {"collapse": state}),
        **load_arrays(assembly, options.load),
    }
    if answer.least:
        first = next(iter(answer.least))
        for word, state_of in (("least", answer.least[first]), ("most", answer.most[first])):
            about = f"for the {'least' if word == 'least' else 'greatest'} thrust of {with_article(first)} without a horizontal load"
            result.arrays.update(state_arrays(assembly, word, state_of, about))
            result.arrays.update(graphic_arrays(answer, word, state_of, about))
            result.arrays.update(tie_arrays(building, answer.loads, {word: state_of}))
    if options.animation != "none":
        result.arrays |= _film(limit, answer)
    result.answer = _words(building.require_structure().word, assembly, answer, found)
    result.warnings += answer.warnings
    if closed := mended_capacity(building, options, answer.gamma):
        result.warnings.append(closed)
    needed = found.required_friction or 0.0
    if building.joints.coefficient is None and needed > USUAL_FRICTION:
        result.warnings.append(
            f"the structure requires a coefficient of friction of {needed:.2f}, but masonry has about {USUAL_FRICTION:g}, "
            "so joints slide before this load: give `friction`"
        )
    if preset := getattr(context.deck.structure, "preset", None):
        result.warnings.append(f'the dimensions of preset "{preset}" are inferred or estimated, not taken from a survey')
    return result


def _answer(context: Context, options: Tilt) -> tuple[Answer, LimitAnalysis, LimitAnalysis | None]:
    """The answer and its analysis; where the deck's analysis without dilatancy has no state, that of dilatant friction, an upper
    bound, and the analysis that the deck asks for."""
    building = context.building
    limit = limit_of(building, options)
    try:
        return answer_of(building, options, limit, context.threads), limit, None
    except NoAnswer:
        if limit.associated:
            raise
    bound = limit_of(building, options.model_copy(update={"friction_rule": "associated"}))
    return answer_of(building, options, bound), bound, limit


def _film(limit: LimitAnalysis, answer: Answer) -> dict[str, Array]:
    """Lines of least and greatest thrust of the first chain as the ground is tilted to collapse; none without a chain."""
    if not answer.least or answer.gamma <= 0.0:
        return {}
    joints = answer.assembly.chains[next(iter(answer.least))]
    at = thrust_joint(answer.assembly, answer.loads, joints)
    rows = []
    for gamma in np.linspace(0.0, answer.gamma * (1.0 - 1e-6), FILM).tolist():
        pair = limit.thrust(joints, gamma)
        rows.append([(s.points(answer.assembly)[joints], thrust_of(answer.assembly, s, joints, at)) for s in pair])
    about = "of the first arch or column of blocks, while the ground is tilted up to collapse"
    return {
        "film_tilt": Array(
            np.linspace(0.0, degrees(answer.gamma), FILM), ("film",), "deg", "tilt of the ground in each picture of the animation"
        ),
        **{
            f"film_{name}": Array(
                np.array([row[k][0] for row in rows]), ("film", "chain_joint", "axis"), "m", f"thrust line for the {word} thrust {about}"
            )
            for k, (name, word) in enumerate((("least", "least"), ("most", "greatest")))
        },
        **{
            f"film_thrust_{name}": Array(np.array([row[k][1] for row in rows]), ("film",), "N", f"{word} thrust {about}")
            for k, (name, word) in enumerate((("min", "least"), ("max", "greatest")))
        },
    }


def _thrusts(answer: Answer) -> Keys:
    """Least and greatest horizontal thrust upright of each chain [N]; the first also by the common names."""
    table = {}
    for name in answer.least:
        joints = answer.assembly.chains[name]
        at = thrust_joint(answer.assembly, answer.loads, joints)
        least, most = (thrust_of(answer.assembly, states[name], joints, at) for states in (answer.least, answer.most))
        table[name] = out.ChainThrust(min_N=least, max_N=most)
    if not table:
        return {}
    first = next(iter(table.values()))
    return {"thrust_min_N": first.min_N, "thrust_max_N": first.max_N, "thrusts": table}


def _admissible(answer: Answer, sliding: dict[str, object]) -> list[float]:
    """Accelerations between which forces find a way: how joints slide is no question there, so dilatant loads bound it."""
    low, high = answer.back_state.gamma, answer.gamma
    back, forth = (sliding.get(name) for name in ("non_dilatant_opposite", "non_dilatant"))
    if isinstance(back, out.NonDilatant) and back.associated_g is not None:
        low = -back.associated_g
    if isinstance(forth, out.NonDilatant) and forth.associated_g is not None:
        high = forth.associated_g
    return [low, high]


def _without_dilatancy(
    context: Context,
    limit: LimitAnalysis,
    answer: Answer,
    dilating: dict[int, list[int]],
    result: Result,
    asked: LimitAnalysis | None = None,
) -> Keys:
    """Least states without dilatancy and their certificates: of both senses where the deck asks for that rule, and beside
    the upper bound of associated friction of each sense in whose mechanism pressed joints slide.

    asked: the analysis without dilatancy that the deck asks for, where it gave no state in one sense or both; load paths are
    then followed with patience in each.
    """
    told: Keys = {}
    if limit.associated and limit.friction is not None:
        told |= {"dilating_joints": dilating[1], "dilating_joints_opposite": dilating[-1]}
    beside = asked or (limit.without_dilatancy() if limit.associated and any(dilating.values()) else limit)
    followed, bounds = ({}, {}) if limit.associated else _side_by_side(context, limit)
    for direction, end in ((1, ""), (-1, "_opposite")):
        try:
            if not limit.associated:
                forth, back = (answer.collapse_state, answer.mechanism), (answer.back_state, answer.back_mechanism)
                pair = forth if direction > 0 else back
            elif dilating[direction]:
                pair = collapse_beside(beside, direction) if asked is None else asked.collapse(direction)
            else:
                continue
        except (NoAnswer, NoEquilibrium) as error:
            told["non_associated_reason"] = str(error)
            if asked is not None and limit.strength is None:
                paths, _ = _paths(context, asked, [direction], patient=True)[direction]
                told |= _told_paths(paths, direction, result)
            continue
        way = "to +x" if direction > 0 else "to -x"
        if limit.strength is not None:
            result.warnings.append(
                f"Load paths {way} do not include crushing, so there is no design value. The capacity is the lowest value found."
            )
        elif limit.associated and asked is None and len(limit.assembly.a) > MOST_FOLLOWED:
            result.warnings.append(
                f"Load paths {way} are not calculated, because the structure has more than {MOST_FOLLOWED} "
                "joints, so there is no design value. The capacity is the lowest value found. To calculate load "
                'paths, give friction_rule = "non-associated".'
            )
        elif beside.coulomb[direction].falling is None:
            if direction not in followed:
                followed |= _paths(context, beside, [direction], patient=asked is not None)
            paths, ends = followed[direction]
            lowest = min(ends, key=lambda one: direction * one[0].gamma, default=pair)
            if direction * (pair[0].gamma - lowest[0].gamma) > out.SAME:
                pair = lowest  # below the states that the programmes found
            told |= _told_paths(paths, direction, result)
        found = beside.coulomb[direction]
        if direction not in bounds:
            bounds[direction] = beside.without_dilatancy_between(direction)
        lower, upper = (None if g is None else direction * g for g in bounds[direction])
        state, mechanism = pair
        assert limit.friction is not None  # joints that cannot slide need no such state
        proof = certify(limit.assembly, limit.loads, limit.friction, state, mechanism, limit.strength)
        certified = proof.holds(state.gamma)
        if certified or not limit.associated:
            told[f"collapse_acceleration_non_associated{end}_g"] = direction * state.gamma
            told[f"non_dilatant{end}"] = _least_state(found, proof, certified, lower, upper, direction)
        if found.falling is not None:
            stone = limit.assembly.block_names[found.falling]
            result.warnings.append(
                f"{stone} is carried only by friction between its neighbours. In a state without dilatancy, this "
                f"block slides out at any load, so no horizontal load {way} is carried reliably"
            )
        if not certified:
            told["non_associated_reason"] = (
                f"the state found {way} is not certified (difference between forces and mechanism {proof.zero_gap:.1e} g)"
            )
            result.warnings.append(
                f"the state without dilatancy {way} is not certified: the difference between its forces and its mechanism is {proof.zero_gap:.1e} g"
            )
    return told


def _told_paths(paths: list[out.LoadPath], direction: int, result: Result) -> Keys:
    """The keys of the load paths of one sense; a warning where some are not certified."""
    end, way = ("", "to +x") if direction > 0 else ("_opposite", "to -x")
    if told_doubt := doubt(paths, way):
        result.warnings.append(told_doubt)
    design = out.design_value(paths)
    return {f"load_paths{end}": paths} | ({} if design is None else {f"collapse_acceleration_load_path{end}_g": design})


def _least_state(
    found: CoulombState, proof: Certificate, certified: bool, lower: float | None, upper: float | None, direction: int
) -> out.NonDilatant:
    starts = [direction * g for g in found.starts]
    return out.NonDilatant(
        associated_g=upper,
        frictionless_g=lower,
        starts_g=starts,
        spread_g=max(starts) - min(starts),
        certified=certified,
        zero_gap_g=proof.zero_gap,
        equilibrium_residual=proof.equilibrium,
        friction_residual=proof.friction,
        tension_residual=proof.tension,
        overlap_residual=proof.closing,
        complementarity_residual=found.residuals.complementarity,
        work_residual=found.residuals.work,
    )


def _side_by_side(context: Context, limit: LimitAnalysis) -> tuple[dict[int, Paths], dict[int, tuple[float | None, float | None]]]:
    """Load paths to +x (1) and to -x (-1), of those that the analysis needs, and the bounds of both with and without friction."""
    followed: dict[int, Paths] = {}
    if limit.strength is None:
        followed |= _paths(context, limit, [d for d in (1, -1) if limit.coulomb[d].falling is None], patient=True)
    with interruptible(), ThreadPoolExecutor(max(1, min(2, context.threads))) as pool:
        return followed, dict(zip((1, -1), pool.map(limit.without_dilatancy_between, (1, -1)), strict=True))


def _paths(context: Context, limit: LimitAnalysis, directions: Sequence[int], *, patient: bool) -> dict[int, Paths]:
    """The load paths to +x (1) and to -x (-1), and the certified collapses at their ends."""
    ends: dict[int, dict[float, tuple[State, Mechanism]]] = {direction: {} for direction in directions}

    def follow(direction: int, ratio: float, effort: int) -> tuple[float, Certificate]:
        state, mechanism = collapse_along_path(limit, direction, ratio, effort)
        assert limit.friction is not None  # joints that cannot slide need no such state
        proof = certify(limit.assembly, limit.loads, limit.friction, state, mechanism, None)
        if proof.holds(state.gamma):
            ends[direction][ratio] = state, mechanism
        return direction * state.gamma, proof

    pushes = [partial(follow, direction) for direction in directions]
    if patient:
        rows = follow_beside(pushes, context.threads, lambda done, of: context.progress(done, of, "load paths"))
    else:
        rows = [follow_paths(push, patient=False) for push in pushes]
    return {
        direction: (found, [ends[direction][ratio] for ratio in RATIOS if ratio in ends[direction]])
        for direction, found in zip(directions, rows, strict=True)
    }


def _fracture(building: Building, options: Tilt, answer: Answer, result: Result) -> Keys:
    """The key of the capacity with a cracked buttress beside the monolithic one; its arrays go to `result`."""
    assembly = building.blocks()
    block = assembly.buttresses[-1] if assembly.buttresses else None
    try:
        found: Fracture | None = fracture_of(building, options)
        if found is not None and found.gamma <= 0.0:
            raise NoEquilibrium
    except NoEquilibrium:
        result.warnings.append("with a crack in its leeward buttress, the structure cannot stand, even without a horizontal load")
        return {"fracture": out.Fracture(stands=False)}
    if found is None or block is None:
        return {"fracture": out.Fracture(cracks=False, collapse_acceleration_g=answer.gamma, ratio=1.0)}
    outlines = found.assembly.outlines
    result.arrays.update(
        {
            "crack": Array(found.line, ("crack_end", "axis"), "m", "fracture line: points at the inner face and at the outer toe"),
            "crack_pose": Array(
                finite_motion(found.assembly, found.mechanism),
                ("block", "component"),
                "m, m, rad",
                "mechanism with the buttress cracked, at a finite displacement",
            ),
            "crack_centroid": Array(found.assembly.centroid, ("block", "axis"), "m", "centroids of the cracked blocks"),
            "crack_outline": Array(
                np.concatenate(outlines), ("crack_vertex", "axis"), "m", "outlines of the blocks with the cracked buttress"
            ),
            "crack_outline_start": Array(
                np.cumsum([0, *map(len, outlines)]),
                ("block_edge",),
                "",
                "index of the first vertex of each block; the last value is the number of all vertices",
            ),
            "crack_point": Array(found.state.points(found.assembly), ("joint", "axis"), "m", "thrust line, cracked"),
        }
    )
    told = out.Fracture(
        cracks=True,
        buttress=assembly.block_names[block],
        collapse_acceleration_g=found.gamma,
        tilt_angle_deg=degrees(found.gamma),
        ratio=found.gamma / answer.gamma,
        crack_height_m=found.height,
        crack_height_ratio=found.height_ratio,
        resultant_from_outer_face_ratio=found.section_ratio,
        hinges=hinge_rows(found.assembly, found.mechanism.hinges, found.mechanism.pivot),
        dilating=bool(LimitAnalysis(found.assembly, building.friction()).dilating(found.mechanism)),
    )
    return {"fracture": told}


def _told(found: out.Tilt) -> str:
    """In words: where capacities are upper bounds by dilatant friction, and the least states without dilatancy."""
    ends = (
        (
            "to +x",
            found.dilating_joints,
            found.non_dilatant,
            found.collapse_acceleration_non_associated_g,
            found.collapse_acceleration_load_path_g,
            found.load_paths,
        ),
        (
            "to -x",
            found.dilating_joints_opposite,
            found.non_dilatant_opposite,
            found.collapse_acceleration_non_associated_opposite_g,
            found.collapse_acceleration_load_path_opposite_g,
            found.load_paths_opposite,
        ),
    )
    bounds = [way for way, dilating, *_ in ends if dilating]
    text = f"Under the load {' and '.join(bounds)}, joints slide, so the capacity is an {out.DILATANT}. " if bounds else ""
    for way, _, r, least, design, paths in ends:
        if design is not None and paths is not None:
            text += (
                f"Without dilatancy, the design value {way} is {design:.4f} g, the lowest of {len(paths)} load paths with elastic joints. "
            )
        if r is None or least is None:
            continue
        upper = "none" if r.associated_g is None else f"{r.associated_g:.4f} g"
        lower = "nothing stands" if r.frictionless_g is None else f"{r.frictionless_g:z.4f} g"
        text += (
            f"The lowest of {len(r.starts_g)} collapse accelerations found {way} is {least:.4f} g (scatter {r.spread_g:.4f} g). The "
            f"lower bound without friction is {lower}, and the upper bound with dilatancy is {upper}. "
        )
    if found.non_associated_reason:
        text += f"Collapse without dilatancy is not given: {found.non_associated_reason}. "
    return text


def _some(names: list[str], apart: str = ", ") -> str:
    """The first of many names."""
    return apart.join(names[:MOST_NAMED]) + (f" and {len(names) - MOST_NAMED} more" if len(names) > MOST_NAMED else "")


def _sliding(assembly: Assembly, joints: Sequence[int]) -> str:
    """The joints that slide; of what slides as a whole its base."""
    grounded = np.flatnonzero((assembly.a == GROUND) | (assembly.b == GROUND)).tolist()
    if len(grounded) > 1 and set(joints) == set(grounded):
        return f"its whole base ({len(grounded)} joints)"
    return _some([assembly.joint_names[j] for j in joints])


def _words(what: str, assembly: Assembly, answer: Answer, found: out.Tilt) -> str:
    gamma, back = answer.gamma, -answer.back_state.gamma
    where = _some([h.told() for h in found.hinges], "; ")
    slides = _sliding(assembly, answer.mechanism.sliding)
    moves = ([f"hinges form at the {where}"] if where else []) + ([f"joints slide or open at {slides}"] if slides else [])
    text = (
        f"The {what} becomes a mechanism at a constant horizontal acceleration of {gamma:.4f} g, or when its base is "
        f"tilted by {degrees(gamma):.2f} degrees. In the mechanism towards +x {' and '.join(moves)}. "
    )
    if abs(back - gamma) > 1e-6 * max(1.0, abs(gamma)):
        text += f"Towards -x the collapse acceleration is {back:.4f} g ({degrees(back):.2f} degrees). "
    text += _told(found)
    needed = np.inf if found.required_friction is None else found.required_friction
    text += f"The required coefficient of friction is {needed:.2f}" + (
        f"; the geometric safety factor of the upright {what} is {answer.safety:.2f}."
        if np.isfinite(answer.safety)
        else (
            "; for self-weight alone, a thrust line passes within 1 % of the joint length from the middle of "
            f"each joint of the {what}: there is no horizontal demand."
        )
        if answer.part < CENTRAL
        else "."
    )
    text += spoken_ties(found.ties)
    fracture = found.fracture
    if fracture and fracture.cracks:
        text += (
            f"If the leeward buttress cracks, the crack runs from {fracture.crack_height_m:.2f} m above its base down to the toe. "
            f"The collapse acceleration is then {fracture.collapse_acceleration_g:.4f} g ({fracture.tilt_angle_deg:.2f} "
            f"degrees), {fracture.ratio:.2f} times the uncracked value."
        )
    elif fracture and fracture.cracks is False:
        text += " The leeward buttress does not crack before this collapse."
    return text
