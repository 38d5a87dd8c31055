"""Limit analysis on the page: capacity in both senses, lines of thrust at a tilt, hinges, mechanism, reactions.

The page calculates less than the analysis `tilt`, so that results follow a drag; the numbers are the same.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from extrados.analyses.context import Refused
from extrados.analyses.limit.common import limit_of, tie_rows
from extrados.analyses.limit.tables import LimitAnalysisTable
from extrados.limit.answer import assess, cannot_stand
from extrados.limit.errors import CannotStand
from extrados.limit.finite_motion import finite_motion
from extrados.limit.graphic import force_polygon, thrust_joint, thrust_of
from extrados.limit.lines import thrust_paths
from extrados.limit.places import place_of
from extrados.limit.programme import Immovable, LimitAnalysis, Mechanism, NoAnswer, NoEquilibrium, State
from extrados.limit.states import blended
from extrados.model.errors import NoView
from extrados.model.geometry.assembly import GROUND, Assembly
from extrados.model.geometry.chains import is_stack
from extrados.views.building import Building

#: Of a joint: so near to its end the line makes a hinge
TOUCHES = 1e-4
#: Walls of more loops take long: their lines at a tilt are left for when the hand rests
QUICK_LOOPS = 40
#: Of the greatest force: what is smaller is none
ROUNDING = 1e-12
PICTURES = 13  # of a mechanism that moves


@dataclass(frozen=True)
class View:
    """What the page wants to see: the tilt as gamma [g]; the chain whose thrust is least and greatest; the place
    [joint, share] that a line shall pass, or the thrust [N] that it shall have; which lines are drawn."""

    gamma: float = 0.0
    chain: str | None = None
    through: tuple[int, float] | None = None
    thrust: float | None = None
    lines: frozenset[str] = frozenset(("least", "most", "through", "plus"))


@dataclass
class Picture:
    """Words and arrays of a state; `limit` and its results are kept for later requests."""

    words: dict[str, Any]
    arrays: dict[str, np.ndarray]
    assembly: Assembly
    limit: LimitAnalysis | None = None
    mechanisms: dict[str, Mechanism] | None = None


def geometry(assembly: Assembly, anchor: np.ndarray) -> dict[str, np.ndarray]:
    """Outlines, joints and centroids, from the anchor [m]."""
    outlines = assembly.outlines
    arrays = {
        "outline": np.concatenate(outlines) - anchor,
        "outline_start": np.cumsum([0, *map(len, outlines)]),
        "centroid": assembly.centroid - anchor,
        "joint_p": assembly.p - anchor,
        "joint_q": assembly.q - anchor,
        "joint_block": np.column_stack([assembly.a, assembly.b]),
    }
    earth = assembly.earth
    if earth is not None:
        line = np.column_stack([earth.line.start, earth.line.end]).reshape(-1, 2)
        top = [[line[-1, 0], earth.road], [line[0, 0], earth.road]]
        arrays["earth"] = np.concatenate([line, top]) - anchor
    return arrays


def picture(building: Building, options: LimitAnalysisTable, view: View, anchor: np.ndarray) -> Picture:
    """The structure and its drawing; if it cannot stand, the words state this and there are no lines."""
    assembly = building.blocks()
    chains = assembly.chains
    chain = view.chain if view.chain in chains else first_chain(assembly)
    words: dict[str, Any] = {
        "blocks": len(assembly.mass),
        "joints": len(assembly.a),
        "depth_m": assembly.depth,
        "chains": list(chains),
        "chain": chain,
        "weight_N": float(assembly.mass.sum()) * 9.80665,
        "size_m": assembly.size,
        "gamma": view.gamma,
        "measures": assembly.measures,
    }
    made = Picture(words, geometry(assembly, anchor), assembly)
    if building.ties:
        made.arrays["ties"] = building.anchored().point.reshape(-1, 2) - anchor
    if building.dampers:
        made.arrays["dampers"] = np.array([d.flat() for d in building.dampers]).reshape(-1, 2) - anchor
    words["abutting_wall"] = building.supports.abutting_wall
    words["head_mass_kg"] = getattr(building.structure, "head_mass", None) or None
    ends = _ends(made, building, options)
    if ends is None or made.limit is None:
        return made
    limit = made.limit
    plus, minus = ends["plus"][0].gamma, -ends["minus"][0].gamma
    words["capacity"] = {"plus_g": plus, "minus_g": minus}
    words["dilating"] = {name: bool(limit.dilating(mechanism)) for name, (_, mechanism) in ends.items()}
    words["stands"] = plus >= 0.0 and minus >= 0.0
    made.mechanisms = {name: mechanism for name, (_, mechanism) in ends.items()}
    for name, (state, mechanism) in ends.items():
        if name in view.lines:
            _line(made, name, state, anchor)
        made.arrays[f"{name}_velocity"] = mechanism.velocity
        words[f"{name}_hinges"] = _hinges(assembly, mechanism, anchor)
        words[f"{name}_sliding"] = [
            {"name": assembly.joint_names[j], "at": (assembly.middle[j] - anchor).tolist()} for j in mechanism.sliding
        ]
    way = "minus" if view.gamma < 0.0 else "plus"
    words["way"], governing = way, ends[way][0]
    for row in tie_rows(building, limit.loads, governing).get("ties", []):
        words.setdefault("ties", []).append({"name": row.name, "force_N": row.force_N})
    words["required_friction"] = float(governing.friction.max())
    if not -minus <= view.gamma <= plus:
        words |= {"within": False, "falls": "plus" if view.gamma > plus else "minus"}
        words["why"] = _reason(words)
        _line(made, words["falls"], ends[words["falls"]][0], anchor)
        words["reactions"] = _reactions(assembly, ends[words["falls"]][0], anchor)
        words["reactions_of"] = words["falls"]
        _polygon(made, ends[words["falls"]][0], chain)
        return made
    words["within"] = True
    quick = len(assembly.a) - len(assembly.mass) <= QUICK_LOOPS
    shown: State | None = None
    if chain is not None and quick:
        try:
            shown = _thrusts(made, limit, view, chains[chain], anchor)
        except (NoEquilibrium, NoAnswer) as error:
            words["remark"] = str(error)
    shown = shown or governing
    words["reactions"] = _reactions(assembly, shown, anchor)
    words["reactions_of"] = "through" if "through" in words or "chosen" in words else "least" if shown is not governing else way
    _polygon(made, shown, chain)
    return made


def _ends(made: Picture, building: Building, options: LimitAnalysisTable) -> dict[str, tuple[State, Mechanism]] | None:
    """Collapse to both sides; None without it, and the words of the picture give the reason."""
    words = made.words
    if ignored := [what for what in building.special_keys if what not in options.considers]:
        words |= {"stands": None, "unknown": f"The analysis {options.kind} cannot consider {' and '.join(ignored)}."}
        return None
    limit: LimitAnalysis | None = None
    try:
        limit = made.limit = limit_of(building, options)
        words["weight_N"] = limit.loads.scale
        return {"plus": limit.collapse(1), "minus": limit.collapse(-1)}
    except Immovable as error:  # before NoAnswer, of which it is one, and no failure
        words |= {"stands": True, "immovable": str(error)}
    except NoEquilibrium:
        try:
            assert limit is not None  # making it solves nothing
            cannot_stand(limit)
            words |= {"stands": False, "falls": "weight"}
        except (NoAnswer, NoEquilibrium) as error:  # no certificate: nothing is said of the structure
            words |= {"stands": None, "unknown": str(error)}
    except (NoAnswer, NoView, Refused) as error:
        words |= {"stands": None, "unknown": str(error)}
    return None


def _thrusts(made: Picture, limit: LimitAnalysis, view: View, chain: list[int], anchor: np.ndarray) -> State:
    """States of least and greatest thrust of a chain, and the state that the view requests; the one whose reactions are shown."""
    words, assembly = made.words, made.assembly
    least, most = limit.thrust(chain, view.gamma)
    crown = thrust_joint(assembly, limit.loads, chain)
    for name, state in (("least", least), ("most", most)):
        if name in view.lines:
            _line(made, name, state, anchor)
        words[f"{name}_N"] = thrust_of(assembly, state, chain, crown)
        words[f"{name}_touches"] = _touches(assembly, state, anchor)
    shown = least
    if view.through is not None and "through" in view.lines and view.through[0] < len(assembly.a):
        shown = limit.through(*view.through, view.gamma)
        _line(made, "through", shown, anchor)
        joint = view.through[0]
        at = shown.points(assembly)[joint] - anchor
        words["through"] = {
            "joint": joint,
            "name": assembly.joint_names[joint],
            "wanted": view.through[1],
            "reached": float(shown.position[joint]),
            "at": at.tolist(),
            "thrust_N": thrust_of(assembly, shown, chain, crown),
        }
    elif view.thrust is not None and "through" in view.lines:
        low, high = words["least_N"], words["most_N"]
        share = min(max((view.thrust - low) / (high - low), 0.0), 1.0) if high > low else 0.0
        shown = blended(least, most, share)
        _line(made, "through", shown, anchor)
        words["chosen"] = {"thrust_N": thrust_of(assembly, shown, chain, crown), "wanted_N": view.thrust}
    return shown


def _reason(words: dict[str, Any]) -> str:
    """Why a tilted structure falls, in one line."""
    way, gamma = words["falls"], words["gamma"]
    capacity = words["capacity"][f"{way}_g"]
    hinges, slides = [row["where"] for row in words[f"{way}_hinges"]], words[f"{way}_sliding"]
    told = f"{abs(gamma):.3g} g exceeds the capacity of {capacity:.3g} g towards {'+x' if way == 'plus' else '−x'}"
    if hinges:
        told += f"; {len(hinges)} hinges open ({'; '.join(hinges[:4])}{'; …' if len(hinges) > 4 else ''})"
    return told + (f"; {len(slides)} joints slide" if slides else "")


def detail(made: Picture, anchor: np.ndarray) -> tuple[dict[str, Any], dict[str, np.ndarray]]:
    """Results that take longer than a movement of the mouse: mechanisms, geometric safety factor, or the reason why the
    structure cannot stand."""
    words: dict[str, Any] = {}
    arrays: dict[str, np.ndarray] = {}
    limit, assembly = made.limit, made.assembly
    if limit is None:
        return words, arrays
    if made.words["stands"] is None:
        return words, arrays
    if not made.words["stands"]:
        try:
            assess(assembly, limit=limit)
        except (CannotStand, NoEquilibrium, NoAnswer, Immovable) as error:
            words["why"] = str(error)
        return words, arrays
    shift = np.append(anchor, 0.0)
    for name, mechanism in (made.mechanisms or {}).items():
        most = finite_motion(assembly, mechanism)
        arrays[f"{name}_pose"] = most - shift
    if len(assembly.a) - len(assembly.mass) <= QUICK_LOOPS:
        try:
            state, part = limit.central(0.0)
            words["safety"] = 1.0 / part if part > 1e-6 else None
            _line(made, "central", state, anchor)
            arrays |= {key: value for key, value in made.arrays.items() if key.startswith("central_")}
        except (NoEquilibrium, NoAnswer) as error:
            words["remark"] = str(error)
    return words, arrays


def _line(made: Picture, name: str, state: State, anchor: np.ndarray) -> None:
    """The line of a state through every stone: NAME_line and NAME_start, the first vertex of each of its pieces."""
    assert made.limit is not None
    paths = thrust_paths(made.assembly, made.limit.loads, state)
    points = [path.points for path in paths] or [np.empty((0, 2))]
    made.arrays[f"{name}_line"] = np.concatenate(points) - anchor
    made.arrays[f"{name}_start"] = np.cumsum([0, *map(len, points)])


def _hinges(assembly: Assembly, mechanism: Mechanism, anchor: np.ndarray) -> list[dict[str, Any]]:
    """Where a mechanism turns, in words and places."""
    found, pivot = [], mechanism.pivot
    for j, side in mechanism.hinges:
        point = assembly.p[j] + pivot[j] * (assembly.q[j] - assembly.p[j])
        found.append(
            {"name": assembly.joint_names[j], "side": side, "where": place_of(assembly, j, point), "at": (point - anchor).tolist()}
        )
    return found


def _touches(assembly: Assembly, state: State, anchor: np.ndarray) -> list[list[float]]:
    """Where the line of a state touches the ends of joints."""
    pressed = state.normal > 1e-6 * state.normal.max()
    edge = pressed & (np.minimum(state.position, 1.0 - state.position) < TOUCHES)
    return (state.points(assembly)[edge] - anchor).tolist()


def _reactions(assembly: Assembly, state: State, anchor: np.ndarray) -> list[dict[str, Any]]:
    """Forces of the ground on the structure, with their points of action."""
    points, force = state.points(assembly), state.force(assembly)
    force = np.where(np.abs(force) > ROUNDING * np.abs(force).max(initial=0.0), force, 0.0)
    on_b = assembly.a == GROUND
    return [
        {"name": assembly.joint_names[j], "at": (points[j] - anchor).tolist(), "x_N": float(f[0]), "y_N": float(f[1])}
        for j in np.flatnonzero(on_b | (assembly.b == GROUND)).tolist()
        for f in [-force[j] if on_b[j] else force[j]]
    ]


def _polygon(made: Picture, state: State, chain: str | None) -> None:
    """Rays of the force polygon of a chain [N]."""
    if chain is not None:
        made.arrays["polygon"] = force_polygon(made.assembly, state, made.assembly.chains[chain])


def first_chain(assembly: Assembly) -> str | None:
    """The chain whose thrust is shown unless another is chosen: the first that is an arch, else the first; None of none."""
    chains = assembly.chains
    return next((name for name, joints in chains.items() if not is_stack(assembly, joints)), next(iter(chains), None))


def nearest(assembly: Assembly, point: np.ndarray, chain: str | None) -> tuple[int, float]:
    """The joint of a chain (of all, where none is given) nearest to a point, and the share of it there."""
    joints = np.array(assembly.chains[chain] if chain in assembly.chains else range(len(assembly.a)))
    p, along = assembly.p[joints], (assembly.q - assembly.p)[joints]
    share = np.clip(((point - p) * along).sum(axis=1) / (along**2).sum(axis=1), 0.0, 1.0)
    k = int(np.hypot(*(p + share[:, None] * along - point).T).argmin())
    return int(joints[k]), float(share[k])
