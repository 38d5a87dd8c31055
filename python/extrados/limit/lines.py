"""The thrust line drawn through every stone: along chains, down piers, and between the joints of any other stone."""

from dataclasses import dataclass

import numpy as np

from extrados.limit.graphic import section_forces
from extrados.limit.loads import Loads
from extrados.limit.states import State
from extrados.model.geometry.assembly import Assembly
from extrados.model.geometry.chains import inner_stones
from extrados.model.geometry.polygons import reach

#: Of the greatest compression of a stone: joints pressed by less carry nothing.
CARRIES = 1e-4
#: A stone this many times as high as its base is long is followed section by section.
TALL = 1.2
SECTIONS = 24
SHARES = np.arange(1, SECTIONS) / SECTIONS
BEARS = 0.7  # cosine of the slope up to which a joint bears a stone from below


@dataclass(frozen=True)
class ThrustPath:
    """A piece of the thrust line: of a chain or a stone, by its name; points (k, 2) [m]; the greatest force [N] along it."""

    name: str
    points: np.ndarray
    force: float


def thrust_paths(assembly: Assembly, loads: Loads, state: State, sway: float = 1.0) -> list[ThrustPath]:
    """The thrust line of a state, through every stone that carries anything.

    Along a chain it joins the points of pressure. In a stone of two joints it leads from one to the other; down a tall one
    it is found on level sections, and what presses on its side meets it there: the lines of several arches meet on
    their pier. In any other stone the lines from all its joints meet where their forces do in the mean, and in one that
    nothing presses on they begin at its centroid. sway: the part
    of gamma that accelerates the stones' own weight to +x.
    """
    points, force = state.points(assembly), np.hypot(*state.force(assembly).T)
    found = [ThrustPath(name, points[joints], float(force[joints].max())) for name, joints in assembly.chains.items()]
    within = {b for joints in assembly.chains.values() for b in inner_stones(assembly, joints)}
    for block, joints in enumerate(assembly.bounds):
        if block in within:
            continue
        loaded = [j for j in joints if force[j] > CARRIES * max(force[i] for i in joints)]
        name = assembly.block_names[block]
        for line, carried in _through(assembly, loads, state, block, loaded, points, force, sway):
            found.append(ThrustPath(name, line, carried))
    return found


def _through(
    assembly: Assembly, loads: Loads, state: State, block: int, joints: list[int], points: np.ndarray, force: np.ndarray, sway: float
) -> list[tuple[np.ndarray, float]]:
    """Lines through one stone and their forces, from its loaded joints."""
    if not joints:
        return []
    into = np.where(assembly.a[joints] == block, 1.0, -1.0)[:, None]
    bearing = (into * assembly.normal[joints])[:, 1] > BEARS
    base = [j for j, bears in zip(joints, bearing.tolist(), strict=True) if bears]
    above = [j for j in joints if j not in base]
    tied = loads.resistance is not None and bool((loads.resistance.block == block).any())
    if tied and len(base) == 1 and not above:  # the line of what pulls at it and of the weight above each section
        return _down(assembly, loads, state, block, base[0], above, points, force, sway)
    if not above or len(joints) == 1:  # nothing presses on it: its load comes from where the stone is
        return [(np.array([assembly.centroid[block], points[j]]), float(force[j])) for j in joints]
    if len(base) == 1 and above:
        top = max(above, key=lambda j: float(points[j, 1]))
        if points[top, 1] - points[base[0], 1] > TALL * assembly.length[base[0]]:
            trunk = _down(assembly, loads, state, block, base[0], above, points, force, sway)
            if trunk:
                return trunk
    if len(joints) == 2:
        return [(points[joints], float(force[joints].max()))]
    meet = (points[joints] * force[joints, None]).sum(axis=0) / force[joints].sum()
    return [(np.array([points[j], meet]), float(force[j])) for j in joints]


def _down(
    assembly: Assembly,
    loads: Loads,
    state: State,
    block: int,
    base: int,
    above: list[int],
    points: np.ndarray,
    force: np.ndarray,
    sway: float,
) -> list[tuple[np.ndarray, float]]:
    """The line down a tall stone on level sections, and the lines that meet it from its other joints; nothing where
    no section is pressed."""
    order = sorted(above, key=lambda j: -float(points[j, 1]))
    foot = points[base]
    top = points[order[0]] if order else np.array([np.nan, assembly.outlines[block][:, 1].max()])
    levels = top[1] + SHARES * (foot[1] - top[1])
    carried, x = section_forces(assembly, block, levels, state, loads, sway)
    outline = assembly.outlines[block]
    left, right = reach(outline, levels).T
    shown = np.flatnonzero((carried[:, 1] < 0.0) & (left <= x) & (x <= right))
    if not len(shown):
        return []
    line = np.column_stack([x, levels])[shown]
    greatest = float(np.hypot(*carried[shown].T).max())
    found = [(np.vstack([top, line, foot] if order else [line, foot]), greatest)]
    for j in order[1:]:
        # The first section below all of the joint: there its force has been added.
        low = min(assembly.p[j, 1], assembly.q[j, 1], assembly.middle[j, 1])
        below = line[line[:, 1] < low]
        found.append((np.array([points[j], below[0] if len(below) else foot]), float(force[j])))
    return found
