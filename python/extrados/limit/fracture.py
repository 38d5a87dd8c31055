"""Fracture of a buttress that leans: masonry without tension leaves a wedge behind on the ground.

The crack runs straight from the outer toe to the inner face at a height h_c. Above h_c the section is
compressed all over, so that there the resultant passes through the third point b/3 from the outer face
(Heyman's rule as used by Ochsendorf; limit analysis alone would let the crack run to the top). h_c is the
height at which cracking and collapse agree.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from extrados.limit.graphic import section_forces
from extrados.limit.loads import Loads, tilt_loads
from extrados.limit.programme import Immovable, LimitAnalysis, Mechanism, NoAnswer, NoEquilibrium, State
from extrados.model.geometry.assembly import GROUND, Assembly
from extrados.model.geometry.polygons import crossings, cut, properties

THIRD = 1.0 / 3.0
HEIGHT = 1e-10  # of the greatest crack height: how closely it is found


class NoCrack(ValueError):
    """The block cannot crack in the way assumed here; the text says why."""


@dataclass(frozen=True)
class Fracture:
    """Collapse with a cracked buttress. line: crack from the inner face to the toe (2, 2) [m];
    height of its inner end over the base [m], ratio to the height of the block; distance of the resultant
    from the outer face at that level over the width there (1/3); cracked assembly, its state and mechanism."""

    gamma: float
    height: float
    height_ratio: float
    line: np.ndarray
    section_ratio: float
    assembly: Assembly
    state: State
    mechanism: Mechanism


def crack(assembly: Assembly, block: int, height: float, direction: int) -> Assembly:
    """The assembly with a block cut from its inner face, `height` above its base, to its outer toe.

    The base joint becomes the crack. direction: +1 where the outer toe is the right end of the base.
    """
    base = _base(assembly, block)
    inner, toe = _ends(assembly, block, base, height, direction)
    along = toe - inner
    up = np.array([-along[1], along[0]]) * direction
    outline = cut(assembly.outlines[block], toe, up)
    area, centroid, polar = properties(outline)
    whole = properties(assembly.outlines[block])[0]
    density = assembly.mass[block] / whole
    outlines = list(assembly.outlines)
    outlines[block] = outline
    mass, centroids, inertia = assembly.mass.copy(), assembly.centroid.copy(), assembly.inertia.copy()
    mass[block], centroids[block], inertia[block] = area * density, centroid, polar * density
    p, q = assembly.p.copy(), assembly.q.copy()
    toe_is_q = direction * (assembly.q[base, 0] - assembly.p[base, 0]) > 0.0
    p[base], q[base] = (inner, toe) if toe_is_q else (toe, inner)
    return replace(assembly, outlines=outlines, mass=mass, centroid=centroids, inertia=inertia, p=p, q=q)


def section_distance(
    assembly: Assembly, block: int, level: float, direction: int, state: State, loads: Loads, sway: float = 1.0
) -> tuple[float, float]:
    """Distance of the resultant at a horizontal section from the outer face [m], and the width there [m]."""
    at = float(section_forces(assembly, block, np.array([level]), state, loads, sway)[1][0])
    faces = crossings(assembly.outlines[block], level)
    outer, inner = (faces[-1], faces[0]) if direction > 0 else (faces[0], faces[-1])
    return direction * (outer - at), direction * (outer - inner)


def fractured_collapse(
    assembly: Assembly,
    block: int,
    direction: int = 1,
    friction: float | np.ndarray | None = None,
    loads: Callable[[Assembly], Loads] = tilt_loads,
    sway: float = 1.0,
) -> Fracture | None:
    """Collapse to one side with the buttress on that side cracked; None where it does not crack."""
    base = _base(assembly, block)
    foot = float(assembly.middle[base, 1])
    others = [j for j in assembly.joints_of(block) if j != base]
    outline = assembly.outlines[block]
    tall = float(outline[:, 1].max()) - foot
    inner_face = outline[np.isclose(outline[:, 0], _ends(assembly, block, base, 0.0, direction)[0][0])]
    limit = min([float(inner_face[:, 1].max()), *(min(assembly.p[j, 1], assembly.q[j, 1]) for j in others)]) - foot

    def at(height: float) -> tuple[float, Fracture]:
        cracked = crack(assembly, block, height, direction) if height > 0.0 else assembly
        load = loads(cracked)
        limit = LimitAnalysis(cracked, friction, loads=load)
        try:
            state, mechanism = limit.collapse(direction)
        except Immovable:
            raise
        except NoEquilibrium:
            if limit.certificate() is None:
                raise NoAnswer(
                    "whether the structure stands with the crack is not decided: neither an equilibrium state nor a "
                    "collapse mechanism was found"
                ) from None
            raise
        distance, width = section_distance(cracked, block, foot + height, direction, state, load, sway)
        line = np.array(_ends(assembly, block, base, height, direction))
        ratio = distance / width
        found = Fracture(state.gamma, height, height / tall, line, ratio, cracked, state, mechanism)
        return ratio - THIRD, found

    # The section is taken just above the base and just below the top of the inner face.
    low, high = 1e-9 * tall, limit * (1.0 - 1e-9)
    if at(low)[0] >= 0.0:
        return None
    over, found = at(high)
    if over < 0.0:
        # The crack reaches the springing: what is above it stays compressed in no section.
        return found
    while high - low > HEIGHT * limit:
        middle = 0.5 * (low + high)
        over, found = at(middle)
        low, high = (middle, high) if over < 0.0 else (low, middle)
    return found


def _base(assembly: Assembly, block: int) -> int:
    grounded = [j for j in assembly.joints_of(block).tolist() if GROUND in (assembly.a[j], assembly.b[j])]
    name = assembly.block_names[block]
    if len(grounded) != 1:
        raise NoCrack(f"{name}: the buttress has {len(grounded)} joints on the ground, but the analysis of the crack requires exactly one")
    return grounded[0]


def _ends(assembly: Assembly, block: int, base: int, height: float, direction: int) -> tuple[np.ndarray, np.ndarray]:
    """Inner end of the crack and the outer toe."""
    ends = sorted((assembly.p[base], assembly.q[base]), key=lambda point: direction * point[0])
    inner, toe = ends[0], ends[1]
    if height <= 0.0:
        return inner, toe
    level = inner[1] + height
    faces = crossings(assembly.outlines[block], level)
    if len(faces) != 2:
        raise NoCrack(f"{assembly.block_names[block]}: at {height:.4g} m above its base, the block does not have two faces")
    return np.array([faces[0] if direction > 0 else faces[1], level]), toe
