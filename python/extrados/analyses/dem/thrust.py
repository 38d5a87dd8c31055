"""Places of the forces in joints, and the stress at their ends or corners; on springs and rigid contacts, in the plane and in space.

The centre of pressure of a contact is that of the normal forces of its points. The stress is that of a pressure that is linear over the
contact, without tension, with the same force and centre (Navier).
"""

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from extrados.analyses.dem.model import Model
from extrados.analyses.dem.seen import BlocksSeen
from extrados.analyses.dem.solid_model import SolidModel
from extrados.analyses.dem.tables import Dem
from extrados.core import dem, dem3
from extrados.model.geometry.convex import hull
from extrados.results.model import Array, Result

#: Steps of Newton's method; error of the force, and of its moment over the greatest extent; shortest share of a step
STEPS, CLOSE, SHORTEST = 100, 1e-9, 1e-3
#: Of the length of a joint: slip from which the joint as drawn is not the contact
SLID = 0.05
#: Of the greatest extent of a contact: so near to the boundary a force is carried by an edge or a corner alone
NEAR = 1e-4


@dataclass(frozen=True)
class Thrust:
    """Forces on the first block of each contact (time, contact, axis) [N], their places [m], NaN without a force, and stresses at the ends
    (time, contact, 2) or at all corners (time, corner) [Pa]; infinite where a corner or an edge alone carries."""

    force: np.ndarray
    place: np.ndarray
    stress: np.ndarray

    def arrays(self) -> dict[str, Array]:
        """As results store them."""
        axes = self.force.shape[2]
        joint, axis = ("joint", "axis") if axes == 2 else ("contact", "axis3")
        at = ("time", joint, "joint_end") if axes == 2 else ("time", "corner")
        where = "first and second end of each joint" if axes == 2 else "corners of the contacts, contact by contact"
        return {
            "thrust_force": Array(self.force, ("time", joint, axis), "N", "contact force on the first block of each contact"),
            "thrust_place": Array(self.place, ("time", joint, axis), "m", "centre of pressure of each contact; NaN without a force"),
            "edge_stress": Array(
                self.stress,
                at,
                "Pa",
                f"compressive stress at the {where}, linear and without tension; infinite where a single edge or corner carries the force",
            ),
        }

    @property
    def at_rest(self) -> float | None:
        """Greatest stress at the start of the motion [Pa]; None where an edge or a corner alone carries."""
        found = float(self.stress[0].max(initial=0.0)) if len(self.stress) else np.inf
        return found if np.isfinite(found) else None


def thrust_of(model: Model | SolidModel, run: dem.Run | dem3.Run) -> Thrust:
    """Forces, places and stresses of all contacts as drawn."""
    if isinstance(model, Model):
        assert isinstance(run, dem.Run)
        return _of_section(model, run)
    assert isinstance(run, dem3.Run)
    return _of_solids(model, run)


def put_thrust(options: Dem, seen: BlocksSeen, result: Result) -> dict[str, float | None]:
    """Arrays of the thrust into `result` where the deck requests them; the key of its results."""
    if not options.thrust:
        return {}
    model, run = seen.model, seen.run
    assert isinstance(run, dem.Run | dem3.Run)
    found = thrust_of(model, run)
    if options.rigid and (degree := redundancy(model, found)):
        result.warnings.append(
            f"the forces of rigid contacts are in general not unique: at the start of the motion the contacts that carry forces have {degree} "
            "more unknowns than equations of equilibrium. The key `thrust` gives one of many states of equilibrium. With springs, "
            "the state depends on the stiffness of the joints. Limit analysis gives the least and the greatest thrust"
        )
    if seen.sliding.ratio > SLID:
        result.warnings.append(
            f"the stresses at the edges of joints refer to the joints as drawn, but joints slide by up to {100 * seen.sliding.ratio:.2g} % of "
            "their length"
        )
    if np.nanmax(model.values.tension, initial=0.0) > 0.0:
        result.warnings.append("the key `thrust` neglects the tension of mortar in the stresses and in the positions of the forces")
    if isinstance(model, SolidModel):
        sides = np.column_stack([model.assembly.a, model.assembly.b])
        result.arrays["contact_block"] = Array(sides, ("contact", "side"), "", "numbers of both blocks of each contact; -1 is the ground")
    result.arrays |= found.arrays()
    return {"edge_stress_at_rest_Pa": found.at_rest}


def redundancy(model: Model | SolidModel, thrust: Thrust) -> int:
    """Degree of static indeterminacy of the contacts that carry forces at the start: unknowns less equations of equilibrium, summed over the
    groups of blocks that touch each other. Each contact has three unknowns (in space six), as each block has equations: zero where the
    contacts form trees. A force at the boundary of a contact counts alike, since its place belongs to one state of many."""
    if not len(thrust.force):
        return 0
    loaded = np.flatnonzero(np.isfinite(thrust.place[0]).all(axis=1))
    if isinstance(model, SolidModel):
        freedoms, bodies = 6, model.sides[loaded]
    else:
        freedoms, bodies = 3, np.reshape([pair for j in loaded if (pair := model.rigid.joints[j])], (-1, 2))
    low, high = bodies.min(axis=1), bodies.max(axis=1)
    mobile = high < model.count
    graph = coo_array((np.ones(mobile.sum()), (low[mobile], high[mobile])), shape=(model.count, model.count))
    groups, group = connected_components(graph, directed=False)
    excess = np.bincount(group[low], minlength=groups) - np.bincount(group, minlength=groups)
    return freedoms * int(np.maximum(excess, 0).sum())


def _of_section(model: Model, run: dem.Run) -> Thrust:
    one, on = model.assembly, model.between
    pairs = np.reshape([pair for pair in model.rigid.joints if pair], (-1, 2))
    low, along = pairs.min(axis=1), (one.q - one.p)[on]
    now, arm = run.place[:, low], run.contact_arm
    c, s = np.cos(now[..., 2]), np.sin(now[..., 2])
    shape = (len(run.time), len(one.p))
    force, place, stress = np.zeros((*shape, 2)), np.full((*shape, 2), np.nan), np.zeros((*shape, 2))
    force[:, on] = np.where(pairs[:, :1] == low[:, None], 1.0, -1.0) * run.contact_force
    place[:, on] = now[..., :2] + np.stack([c * arm[..., 0] - s * arm[..., 1], s * arm[..., 0] + c * arm[..., 1]], axis=2)
    share = np.einsum("tjx,jx->tj", model.rigid.centroid[low] + arm - one.p[on], along) / one.length[on] ** 2
    share = np.where(share < NEAR, 0.0, np.where(share > 1.0 - NEAR, 1.0, share))
    stress[:, on] = edge_stress(run.contact_normal / (one.length[on] * one.depth), share)
    return Thrust(force, place, stress)


def edge_stress(mean: np.ndarray, share: np.ndarray) -> np.ndarray:
    """Stress at both ends (..., 2) of joints with a mean pressure [Pa] whose centre is at a share of the length from the first end."""
    stress = np.zeros((*mean.shape, 2))
    for k, near in enumerate((share, 1.0 - share)):
        # from this end: within the middle third a trapezoid, nearer a triangle over three times the distance
        with np.errstate(divide="ignore", invalid="ignore"):
            value = np.where(near >= 1.0 / 3.0, mean * (4.0 - 6.0 * near), 2.0 * mean / (3.0 * near))
        stress[..., k] = np.where(mean > 0.0, np.where(near <= 2.0 / 3.0, value, 0.0), 0.0)
    return stress


def _of_solids(model: SolidModel, run: dem3.Run) -> Thrust:
    one, sides = model.assembly, model.sides
    low, arm = sides.min(axis=1), run.contact_arm
    place = run.place[:, low] + np.einsum("tnxy,tny->tnx", run.turn[:, low], arm)
    drawn = model.bodies().centroid[low] + arm
    stress = []
    for j, (corners, first, second) in enumerate(zip(one.polygon, *one.tangents, strict=True)):
        tangents, middle = np.column_stack([first, second]), corners.mean(axis=0)
        stress.append(corner_stress((corners - middle) @ tangents, run.contact_normal[:, j], (drawn[:, j] - middle) @ tangents))
    force = np.where(sides[:, :1] == low[:, None], 1.0, -1.0) * run.contact_force
    return Thrust(force, place, np.concatenate(stress, axis=1))


def corner_stress(corners: np.ndarray, force: np.ndarray, centre: np.ndarray) -> np.ndarray:
    """Stress (time, corner) [Pa] at the corners (k, 2) [m] of a polygon under forces (time) [N] at centres (time, 2) [m]: the linear
    pressure without tension in equilibrium with them; infinite at the corner nearest to a force at the boundary, NaN where it is not found.

    The pressure max(0, p b), b = (1, x, y), minimises the convex 1/2 int max(0, p b)^2 - p w, w the force and its moments: Newton's
    method with step halving, from the pressure with tension.
    """
    middle, scale = corners.mean(axis=0), float(np.ptp(corners, axis=0).max())
    basis = np.column_stack([np.ones(len(corners)), (corners - middle) / scale])
    whole = _moments(basis)
    sign = np.sign(whole[0, 0])
    edge = hull(corners)
    along = np.roll(edge, -1, axis=0) - edge
    inward = np.stack([-along[:, 1], along[:, 0]]) / np.linalg.norm(along, axis=1)
    within = (centre[:, None] - edge[None]).transpose(0, 2, 1) * inward[None]
    borne = within.sum(axis=1).min(axis=1) > NEAR * scale
    found = np.zeros((len(force), len(corners)))
    for t in np.flatnonzero(force > 0.0):
        if not borne[t]:
            found[t, np.linalg.norm(corners - centre[t], axis=1).argmin()] = np.inf
            continue
        wanted = np.array([1.0, *((centre[t] - middle) / scale)])
        plane = np.linalg.solve(sign * whole, wanted)
        matrix = sign * _moments(_pressed(basis, plane))
        for _ in range(STEPS):
            rest = wanted - matrix @ plane
            if np.abs(rest).max() < CLOSE:
                break
            way, value = np.linalg.lstsq(matrix, rest, rcond=None)[0], (0.5 * matrix @ plane - wanted) @ plane
            share, gain = 1.0, rest @ way
            while True:
                matrix = sign * _moments(_pressed(basis, plane + share * way))
                trial = plane + share * way
                if (0.5 * matrix @ trial - wanted) @ trial <= value - 1e-4 * share * gain or share < SHORTEST:
                    break
                share *= 0.5
            plane = trial
        else:
            found[t] = np.nan
            continue
        found[t] = force[t] / scale**2 * np.maximum(basis @ plane, 0.0)
    return found


def _pressed(basis: np.ndarray, plane: np.ndarray) -> np.ndarray:
    """The part (n, 3) of a polygon (k, 3) of points (1, x, y) on which the plane (3) is above zero."""
    ahead, value = np.roll(basis, -1, axis=0), basis @ plane
    other = np.roll(value, -1)
    crosses = (value > 0.0) != (other > 0.0)
    share = np.divide(value, value - other, out=np.zeros(len(value)), where=crosses)
    both = np.stack([basis, basis + share[:, None] * (ahead - basis)], axis=1)
    found: np.ndarray = both[np.stack([value > 0.0, crosses], axis=1)]
    return found


def _moments(basis: np.ndarray) -> np.ndarray:
    """Integral (3, 3) of the products of (1, x, y) over a polygon (k, 3), negative for a clockwise one: of each triangle with the origin,
    A / 12 times the products at its corners and of their sum."""
    ahead, origin = np.roll(basis, -1, axis=0), np.array([1.0, 0.0, 0.0])
    area = 0.5 * (basis[:, 1] * ahead[:, 2] - ahead[:, 1] * basis[:, 2])
    points = np.stack([basis, ahead, np.broadcast_to(origin, basis.shape), basis + ahead + origin])
    found: np.ndarray = np.einsum("k,pki,pkj->ij", area / 12.0, points, points)
    return found
