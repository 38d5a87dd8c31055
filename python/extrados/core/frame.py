"""Frames of macro-elements in the core (fortran/frame)."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from extrados import _core
from extrados.core.calls import indices, long_call, real, room_for
from extrados.core.errors import check
from extrados.core.handles import Owner
from extrados.core.lists import entries, numbers, words

SHEAR = numbers("frame_shear")
#: Name -> number
STATE = {entry.name: entry.number for entry in entries("frame_state")}
#: Number -> word in results
STATES, STOPS = words("frame_state"), words("frame_stop")
#: A drift limit that is never reached, a strength that is never exceeded
UNLIMITED = 1e30
#: Share of its elastic stiffness that an open section keeps
RESIDUAL = 1e-8


@dataclass(frozen=True)
class MacroElement:
    """A pier (else a beam between plastic hinges) in the plane of a wall; SI units, compression positive.

    freedoms: u along the wall, w upward, rotation (counter-clockwise) of both nodes, 0-based; -1 is held. offsets: from node to
    end, along the wall and upward, of both ends. length, depth, thickness of the deformable part. strength: of the stress
    block. shear: a word of the list frame_shear; cohesion, friction, tension (f_t) its strengths, slenderness its b.
    damage: c_t, beta of the law "damage". drifts: limits in flexure and in shear; kept: share of the moments left beyond.
    moment: strength of the hinges of a beam, by_shear where its shear strength makes it. own_weight [N] of a pier: the normal force
    grows by it from the upper end to the lower one; the nodes carry half of it each.
    """

    freedoms: tuple[int, int, int, int, int, int]
    length: float
    depth: float
    thickness: float
    young: float
    shear_stiffness: float
    strength: float = UNLIMITED
    offsets: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0)
    pier: bool = True
    upright: bool = True
    shear: str = "none"
    cohesion: float = 0.0
    friction: float = 0.0
    tension: float = 0.0
    slenderness: float = 1.0
    damage: tuple[float, float] = (1.0, 0.5)
    drifts: tuple[float, float] = (UNLIMITED, UNLIMITED)
    kept: float = 0.0
    sections: int = 5
    second_order: bool = True
    moment: float = UNLIMITED
    by_shear: bool = False
    own_weight: float = 0.0

    @property
    def choices(self) -> list[int]:
        """As the core takes them."""
        law = SHEAR[self.shear]
        return [int(self.pier), int(self.upright), law, self.sections, int(self.second_order), int(self.by_shear)]

    @property
    def properties(self) -> list[float]:
        """As the core takes them."""
        area, (ct, beta) = self.depth * self.thickness, self.damage
        return [
            *self.offsets,
            self.length,
            self.depth,
            self.thickness,
            self.young,
            self.strength,
            RESIDUAL,
            self.shear_stiffness,
            self.cohesion,
            self.friction,
            self.tension,
            self.slenderness,
            ct * self.length / area,
            beta,
            max(self.cohesion, 1e-300) * ct * self.length,
            *self.drifts,
            self.kept,
            self.young * self.thickness * self.depth**3 / 12.0,
            0.0,
            self.moment,
            self.own_weight,
        ]


@dataclass(frozen=True)
class Link:
    """An elastic, perfectly plastic link: freedoms (at most 8, 0-based) and their parts in its deformation; stiffness [N/m],
    strengths against negative and positive deformation [N], prestress [N]; returns: without plastic deformation."""

    freedoms: tuple[int, ...]
    parts: tuple[float, ...]
    stiffness: float
    strengths: tuple[float, float] = (UNLIMITED, UNLIMITED)
    prestress: float = 0.0
    returns: bool = False


class Rest(NamedTuple):
    """Equilibrium under the weight: displacements (n), forces of elements (elements, 3), tangent (n, n)."""

    displacement: np.ndarray
    force: np.ndarray
    tangent: np.ndarray


@dataclass(frozen=True)
class Path:
    """States in equilibrium. displacement (states, n) [m]; force (states, elements, 3): N (compression) [N], moments at both
    ends [N m]; drift and state (states, elements), greatest chord rotation and number of the list frame_state.

    control (states) [m] and multiple (states) of a push; shear (states) [N] of a motion. loose: the freedom that moves most where a
    push has no further equilibrium.
    """

    stop: str
    displacement: np.ndarray
    force: np.ndarray
    drift: np.ndarray
    state: np.ndarray
    control: np.ndarray = field(default_factory=lambda: np.empty(0))
    multiple: np.ndarray = field(default_factory=lambda: np.empty(0))
    shear: np.ndarray = field(default_factory=lambda: np.empty(0))
    loose: int | None = None


class Frame(Owner):
    """A frame of macro-elements and links, the stiffness `linear` (n, n) of what stays elastic, its constant loads `weight` (n)
    and masses `mass` (n, n)."""

    what = "frame of macro-elements"

    def __init__(self, elements: Sequence[MacroElement], links: Sequence[Link], linear: np.ndarray, weight: np.ndarray, mass: np.ndarray):
        self.n, self.count = len(weight), len(elements)
        handle, status = _core.api_frame.new_frame(self.n)
        check(status, "frame")
        super().__init__(handle)
        freedom = indices("freedoms", np.array([e.freedoms for e in elements]).reshape(-1, 6).T + 1, self.n + 1, (6, None))
        choice = np.asfortranarray(np.array([e.choices for e in elements], dtype=np.int32).reshape(-1, 6).T)
        values = real("elements", np.array([e.properties for e in elements]).reshape(-1, 25).T, (25, None))
        check(_core.api_frame.elements(handle, self.n, choice, freedom - np.int32(1), values), "elements of a frame")
        if links:
            where, parts = np.full((8, len(links)), -1), np.zeros((8, len(links)), order="F")
            for k, link in enumerate(links):
                where[: len(link.freedoms), k], parts[: len(link.parts), k] = link.freedoms, link.parts
            found = indices("freedoms of links", where + 1, self.n + 1, (8, None)) - np.int32(1)
            laws = real("links", np.array([[k.stiffness, *k.strengths, k.prestress, float(k.returns)] for k in links]).T, (5, None))
            check(_core.api_frame.links(handle, self.n, found, parts, laws), "links of a frame")
        n = self.n
        own = real("linear", linear, (n, n)), real("weight", weight, (n,)), real("mass", mass, (n, n))
        check(_core.api_frame.loads(handle, *own), "loads of a frame")

    def at_rest(self) -> Rest:
        """Equilibrium under the weight; CoreError without one."""
        displacement, force, tangent, status = _core.api_frame.at_rest(self.handle, self.n, self.count)
        check(status, "equilibrium under the weight")
        return Rest(displacement, force.T, tangent)

    def push(
        self, pattern: np.ndarray, control: np.ndarray, target: float, steps: int = 200, drop: float = 0.5, most: int | None = None
    ) -> Path:
        """Push by a growing multiple of `pattern` (n) [N] until control . d (beyond that at rest) is `target` [m] or the
        multiple falls below `drop` of its greatest. most: states that are kept, by default as many as the steps and the search
        for drift limits take."""
        most = 2000 + 2 * steps if most is None else most
        room_for(self.n + 5 * self.count, most)
        own = real("pattern", pattern, (self.n,)), real("control", control, (self.n,))
        count, (stop, loose), curve, displacement, force, drift, state, status = long_call(
            _core.api_frame.push, self.handle, self.count, most, *own, float(target), int(steps), float(drop)
        )
        check(status, "pushover of a frame")
        kept = slice(0, int(count))
        arrays = displacement.T[kept], force.T[kept], drift.T[kept], state.T[kept]
        return Path(STOPS[int(stop)], *arrays, curve[0, kept], curve[1, kept], loose=int(loose) - 1 if loose else None)

    def move(self, unit: np.ndarray, acceleration: np.ndarray, step: float, damping: tuple[float, float]) -> Path:
        """Motion relative to the ground under its acceleration [m/s^2] at steps of `step` seconds; unit (n): displacements of a
        unit motion of the ground; damping: factors of the mass [1/s] and of the last tangent [s]."""
        most = len(acceleration)
        room_for(self.n + 5 * self.count, most)
        own = real("unit", unit, (self.n,)), real("acceleration", acceleration, (None,))
        count, stop, displacement, shear, force, drift, state, status = long_call(
            _core.api_frame.move, self.handle, self.count, *own, float(step), np.array(damping, dtype=np.float64)
        )
        check(status, "motion of a frame")
        kept = slice(0, int(count))
        return Path(STOPS[int(stop)], displacement.T[kept], force.T[kept], drift.T[kept], state.T[kept], shear=shear[kept])


def section_forces(
    properties: Sequence[float], strain: Sequence[float], past: Sequence[float] = (1.0, 1.0, 0.0, 0.0)
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Of a section (length, thickness, modulus, strength, residual share): N and M (2), their tangent (2, 2), and the ductility and
    crushed share of both edges after (4)."""
    force, tangent, after = _core.api_frame.section(
        real("properties", properties, (5,)), real("strain", strain, (2,)), real("past", past, (4,))
    )
    return force, tangent, after
