"""The certificate of a state of collapse without dilatancy, recomputed from its forces and velocities alone."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from extrados.limit.loads import Loads
from extrados.limit.states import NO_WORK, Mechanism, State
from extrados.model.geometry.assembly import GROUND, Assembly
from extrados.model.geometry.solids.assembly import SolidAssembly
from extrados.model.geometry.solids.strands import Strand

ROUNDING, CLOSING, GAP = 1e-7, 1e-6, 1e-4  # of the total load, of the fastest joint, of gamma: more certifies nothing


@dataclass(frozen=True)
class Certificate:
    """equilibrium: greatest force, or moment over the size, left over at a block; friction: greatest excess of |s| over
    mu N; tension: greatest tension, or compression beyond the strength; all over the total load. closing: greatest rate of
    overlap over the fastest joint; zero_gap [g]: |gamma - (work of friction less work of the dead loads)| for a unit of
    work of the live loads."""

    equilibrium: float
    friction: float
    tension: float
    closing: float
    zero_gap: float

    def holds(self, gamma: float) -> bool:
        """Whether collapse at gamma is proven possible, never that less is safe."""
        return (
            max(self.equilibrium, self.friction, self.tension) < ROUNDING
            and self.closing < CLOSING
            and self.zero_gap < GAP * max(abs(gamma), 0.01)
        )


def certify(
    assembly: Assembly, loads: Loads, friction: float | np.ndarray, state: State, mechanism: Mechanism, strength: float | None
) -> Certificate:
    """Equilibrium, the laws of the joints and the zero gap of a state and its mechanism, apart from any programme.

    The gap sum(N u_n + s u_t + mu N |u_t|) of a state in equilibrium is -dead.v - gamma live.v + mu sum N |u_t|, each
    term at least zero: where the sum is zero, forces and motion belong to each other. Joints that crush dissipate the most
    that n_p, n_q >= N^2 / (2 f L) allows.
    """
    nb, size, scale = len(assembly.mass), assembly.size, loads.scale
    normal, shear = state.normal, state.shear
    at_q = normal * state.position
    at_p = normal - at_q
    force, point = state.force(assembly), state.points(assembly)
    wrench = np.column_stack([force, point[:, 0] * force[:, 1] - point[:, 1] * force[:, 0]])
    left = loads.dead + state.gamma * loads.live
    if loads.resistance is not None:
        left = left + loads.resistance.on_blocks(state.mobilised, nb)
    for blocks, sign in ((assembly.a, 1.0), (assembly.b, -1.0)):
        on = blocks != GROUND
        np.add.at(left, blocks[on], sign * wrench[on])
    # Twists about the origin, and the motion of block a against block b at both ends of each joint.
    velocity = mechanism.velocity
    x, y = assembly.centroid.T
    twist = np.column_stack([velocity[:, 0] + velocity[:, 2] * y, velocity[:, 1] - velocity[:, 2] * x, velocity[:, 2]])
    grounded = np.vstack([twist, np.zeros(3)])
    relative = grounded[assembly.a] - grounded[assembly.b]

    def rate(at: np.ndarray) -> np.ndarray:
        return relative[:, :2] + relative[:, 2:] * np.column_stack([-at[:, 1], at[:, 0]])

    opening = np.stack([(rate(at) * assembly.normal).sum(axis=1) for at in (assembly.p, assembly.q)])
    slip = (rate(assembly.middle) * assembly.tangent).sum(axis=1)
    fastest = max(float(np.abs(opening).max()), float(np.abs(slip).max()), 1e-300)
    limit = np.asarray(friction) * normal
    taken = float((limit * np.abs(slip)).sum())
    bound, overlap = np.zeros(len(normal)), -opening
    if strength is not None:
        crush = 1.0 / (2.0 * strength * assembly.depth * assembly.length)
        bound = crush * normal**2
        less, more = opening.min(axis=0), opening.max(axis=0)
        turn = np.maximum(more - less, 1e-300)
        pressed = np.clip(-less / (2.0 * crush * turn), 0.0, 0.5 / crush)
        taken -= float((less * pressed + crush * turn * pressed**2).sum())
        overlap = np.zeros_like(opening)  # a joint that overlaps crushes
    if loads.resistance is not None:
        taken += loads.resistance.taken(loads.resistance.work(twist))
    live, dead = float((loads.live * twist).sum()), float((loads.dead * twist).sum())
    works = abs(live) > NO_WORK * abs(dead)
    gap = abs(state.gamma * live - (taken - dead)) / abs(live) if works else abs(taken - dead) / max(abs(dead), 1e-300)
    return Certificate(
        float(np.abs(left / np.array([1.0, 1.0, size])).max()) / scale,
        max(0.0, float((np.abs(shear) - limit).max())) / scale,
        max(0.0, float((bound - np.minimum(at_p, at_q)).max())) / scale,
        max(0.0, float(overlap.max())) / fastest,
        gap,
    )


def certify_solids(
    assembly: SolidAssembly,
    friction: np.ndarray,
    dead: np.ndarray,
    live: np.ndarray,
    gamma: float,
    force: np.ndarray,
    keyed: np.ndarray,
    motion: np.ndarray,
    strands: Sequence[Strand] = (),
    tension: np.ndarray | None = None,
) -> Certificate:
    """The same of solids, from their geometry.

    friction (corners); dead, live (nb, 6): forces [N] and moments about the centroids [N m]; force (corners, 3): compression
    and both shears [N]; keyed (keys, 2): shears of the dowels [N]; motion (nb, 6): velocities of the centroids and spins; tension
    (strands) [N].
    """
    joint, normal = assembly.corner_joint, assembly.normal
    frames = np.stack([normal, *assembly.tangents], axis=1)
    places, vectors, joints = [assembly.corner], [np.einsum("vk,vkx->vx", force, frames[joint])], [joint]
    if assembly.keys is not None:
        places.append(assembly.keys.point)
        vectors.append(np.einsum("vk,vkx->vx", keyed, frames[assembly.keys.joint, 1:]))
        joints.append(assembly.keys.joint)
    left = dead + gamma * live
    relative = []
    for at, vector, j in zip(places, vectors, joints, strict=True):
        moved = np.zeros_like(at)
        for blocks, sign in ((assembly.a[j], 1.0), (assembly.b[j], -1.0)):
            on = blocks != GROUND
            arm = at[on] - assembly.centroid[blocks[on]]
            np.add.at(left, blocks[on], sign * np.concatenate([vector[on], np.cross(arm, vector[on])], axis=1))
            moved[on] += sign * (motion[blocks[on], :3] + np.cross(motion[blocks[on], 3:], arm))
        relative.append(np.einsum("vx,vkx->vk", moved, frames[j]))
    rate = relative[0]
    slip, shear = np.hypot(*rate[:, 1:].T), np.hypot(*force[:, 1:].T)
    with np.errstate(invalid="ignore"):
        limit = np.where(force[:, 0] > 0.0, friction * force[:, 0], 0.0)
        taken = float(np.where(slip > 0.0, np.where(np.isfinite(limit), limit, 0.0) * slip, 0.0).sum())
    stuck = np.where(np.isfinite(limit), 0.0, slip)
    beyond = 0.0
    if assembly.keys is not None:
        weak, strength = np.isfinite(assembly.keys.strength), assembly.keys.strength
        taken += float((strength[weak] * np.hypot(*relative[1][weak, 1:].T)).sum())
        beyond = float((np.hypot(*keyed.T) - strength).max(initial=0.0))
        stuck = np.append(stuck, np.hypot(*relative[1][~weak, 1:].T))
    for strand, pull in zip(strands, np.zeros(len(strands)) if tension is None else tension, strict=True):
        block, place, each = strand.forces()
        wrench = np.concatenate([each, np.cross(place - assembly.centroid[block], each)], axis=1)
        np.add.at(left, block, pull * wrench)
        longer = strand.lengthening(assembly.centroid, motion)
        bound = strand.high if longer > 0.0 else strand.low
        if np.isfinite(bound):
            taken += bound * longer
        else:
            stuck = np.append(stuck, abs(longer))
        beyond = max(beyond, pull - strand.high, strand.low - pull)
    scale = float(np.abs(dead[:, :3]).sum())
    fastest = max(float(np.abs(rate).max()), 1e-300)
    power, weights = float((live * motion).sum()), float((dead * motion).sum())
    return Certificate(
        float(np.abs(left / np.array([1.0, 1.0, 1.0, *[assembly.size] * 3])).max()) / scale,
        max(0.0, float(np.where(np.isfinite(limit), shear - limit, 0.0).max()), beyond) / scale,
        max(0.0, -float(force[:, 0].min())) / scale,
        max(0.0, -float(rate[:, 0].min()), float(stuck.max())) / fastest,
        abs(gamma * power - (taken - weights)) / abs(power),
    )
