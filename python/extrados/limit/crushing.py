"""Limit analysis of solids whose contacts crush: forces at the corners, within patches of bounded pressure, by second-order cones.

A quadrangle of area A and strength f carries a compression N with its centre at c if a patch of area N / f about c lies within it. The
patch is the contact itself, shortened by s1 and s2 along two axes of its plane: s1 s2 f A >= N. With S = N s and C = N (c - middle), all of

    N h_e - nu_e . C - S1 nu_e1 q_1 - S2 nu_e2 q_2 >= 0   (sides e with outward normals nu and distances h, corners q from the middle)
    N^3 <= f A S1 S2,   that is   W^2 <= S1 S2,   N^2 <= W y sqrt(f A),   y^2 <= N

are linear or second-order cones. That is safe, and exact for rectangles that turn about an axis along a side, where it is
N^2 / (2 f b) <= N h / 2 - |M|. Other polygons are divided into cells of even pressure up to f, thin near the sides: safe too.

The multipliers of equilibrium are a motion. Its bound from above is apart from the programme: points crush where they approach faster
than mu times the slip opens them, and take f max(0, mu |u_t| - u_n) of power per area. Torsion of faces is that of their corners
(limit.face_law), which this bound does not grant where pressure spreads: the lesser of both is the capacity.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import clarabel
import numpy as np
from scipy import sparse

from extrados.limit.errors import Immovable, NoAnswer
from extrados.limit.solids import LOOSE, Falls, Programme, SolidLimit, Stated, denied, solve_conic
from extrados.model.geometry.solids.assembly import SolidAssembly
from extrados.model.geometry.solids.strands import Strand

DIVISIONS = 12  # of the sides of triangles over which the power of crushing is summed
SAME = 1e-9  # of the sides of a contact
MOST = 1e4  # greatest force of a contact over the scale of force: the solver cannot resolve smaller patches
RINGS, ROUND = 8, 32  # cells from the middle of a polygon to its sides, and about it at least


@dataclass(frozen=True)
class Patches:
    """Conditions on the forces of contacts that crush: equal @ z = 0 and above @ z >= 0 of z, the compressions of all corners and then
    the unknowns of the contacts, which lie between 0 and `most`. own: first unknown of each quadrangle: S1, S2, W, y."""

    equal: sparse.csr_array
    above: sparse.csr_array
    most: np.ndarray
    own: np.ndarray


class CrushingLimit(SolidLimit):
    """The programmes of solid blocks whose contacts have a compressive strength (nj) [Pa], infinite where they do not crush."""

    def __init__(
        self,
        assembly: SolidAssembly,
        friction: float | np.ndarray | None,
        strength: np.ndarray,
        strands: Sequence[Strand] = (),
        resting: np.ndarray | None = None,
        tension: np.ndarray | None = None,
    ):
        super().__init__(assembly, friction, strands, resting, tension)
        self.strength = strength + self.tension  # the compressions count the tension of the mortar
        self.borne = np.minimum(self.strength * assembly.area / self.scale, MOST)
        crushes = np.isfinite(strength)
        sides = np.bincount(assembly.corner_joint, minlength=len(strength))
        self.quadrangles, self.polygons = np.flatnonzero(crushes & (sides == 4)), np.flatnonzero(crushes & (sides != 4))

    @cached_property
    def patches(self) -> Patches:
        """The conditions of all contacts that crush; lengths over the size."""
        one, size = self.assembly, self.assembly.size
        corners, start = len(one.corner), np.searchsorted(one.corner_joint, np.arange(len(one.a) + 1))
        own = corners + 4 * np.arange(len(self.quadrangles))
        most = [np.full(4 * len(own), np.inf)]
        above, equal, count = _Rows(), _Rows(), corners + 4 * len(own)
        for j, unknown in zip(self.quadrangles.tolist(), own.tolist(), strict=True):
            flat, at = self._flat(j) / size, np.arange(start[j], start[j + 1])
            axes = _axes(flat)
            along = flat @ np.linalg.inv(axes)
            outward = _outward(flat)
            for normal, far in zip(outward, (outward * flat).sum(axis=1).tolist(), strict=True):
                for reach in _greatest(along * (axes @ normal), SAME * far):
                    above.add(np.append(at, [unknown, unknown + 1]), np.append(far - flat @ normal, -reach))
        for j in self.polygons.tolist():
            flat, at = self._flat(j) / size, np.arange(start[j], start[j + 1])
            place, area = _cells(flat)
            cells = count + np.arange(len(area))
            for k in range(3):
                values, those = (flat[:, k], place[:, k]) if k < 2 else (np.ones(len(flat)), np.ones(len(area)))
                equal.add(np.append(at, cells), np.append(values, -those))
            most.append(self.borne[j] * area / area.sum())
            count += len(area)
        return Patches(equal.matrix(count), above.matrix(count), np.concatenate(most), own)

    def _flat(self, j: int) -> np.ndarray:
        """Corners of a contact in its plane, counter-clockwise, from its middle (k, 2) [m]."""
        frame = np.stack([tangent[j] for tangent in self.assembly.tangents], axis=1)
        return (self.assembly.polygon[j] - self.assembly.middle[j]) @ frame

    def stated(self, dead: np.ndarray, live: np.ndarray | None, sized: Sequence[int] = (), counted: np.ndarray | None = None) -> Stated:
        """Unknown of contacts that crush: their programme is that of the forces."""
        raise NoAnswer("this result is not available for contacts that crush")

    def falls(self) -> Falls | None:
        """The proof that it cannot stand without a push: a motion at less than the weights, as the blocks bear no loads too."""
        nothing = np.zeros_like(self.at_rest)
        try:
            found = self.most(nothing, self.at_rest)
        except Immovable:
            return None
        if not isinstance(found, Programme) or found.gamma >= 1.0:
            return found if isinstance(found, Falls) else None
        motion = found.motion.copy()
        motion[:, 3:] *= self.assembly.size
        try:
            return self._proven(motion.ravel(), self.at_rest)
        except NoAnswer:
            return None

    def _pushed(self, dead: np.ndarray, live: np.ndarray, method: str) -> Programme | Falls:
        forces, strands = self.matrix.shape[1], len(self.strands)
        matrix, right, cones = self._stated_forces(dead, live)
        cost = np.zeros(matrix.shape[1])
        cost[forces + strands] = -1.0
        solution = solve_conic(matrix, cost, right, cones, method)
        status, motion = str(solution.status), np.array(solution.z)[: len(dead)]
        if "DualInfeasible" in status:
            raise Immovable("no horizontal load causes collapse: the contacts restrain the blocks on all sides")
        if "PrimalInfeasible" in status and np.isfinite(motion).all():
            return self._proven(motion if dead @ motion > 0.0 else -motion, dead)
        x, power = np.array(solution.x), float(live @ motion)
        if not np.isfinite(x).all() or not np.isfinite(motion).all() or power <= 0.0:
            raise NoAnswer(f"the conic solver found no solution: {status}")
        gamma = float(x[forces + strands])
        gap = abs(float(solution.obj_val) - float(solution.obj_val_dual)) / max(1.0, abs(gamma))
        found = self._measured(dead, live, motion / power, gamma, x[:forces], x[forces : forces + strands])
        cone = max(found.cone, self._crushed(x) / np.sqrt(len(self.weight)))
        if max(found.equilibrium, cone, found.overlap, gap) > LOOSE:
            why = f"unbalanced force {found.equilibrium:.1e}, excess of shear {cone:.1e}, overlap {found.overlap:.1e}, gap {gap:.1e} g"
            raise NoAnswer(f"the conic solver stopped without a solution ({status}): {why}")
        low, high = sorted((gamma, found.upper))
        return replace(found, gamma=low, upper=high, cone=cone)

    def _stated_forces(self, dead: np.ndarray, live: np.ndarray) -> tuple[sparse.csr_array, np.ndarray, list["clarabel.SupportedCone"]]:
        """The programme of the forces: corners, dowels, strands, gamma, and the unknowns of contacts that crush."""
        corners, forces, p = len(self.mu), self.matrix.shape[1], self.patches
        first = forces + len(self.strands) + 1
        count = first + len(p.most)
        each = sparse.eye_array(count, format="csr")
        patched = sparse.vstack([each[: 3 * corners : 3], each[first:]])
        balance = sparse.hstack([self.matrix, self.pulls, sparse.csc_array(live[:, None]), sparse.csc_array((len(dead), len(p.most)))])
        smooth, stuck = np.flatnonzero(self.mu == 0.0), np.flatnonzero(~np.isfinite(self.mu))
        blocks = [balance, each[3 * smooth + 1], each[3 * smooth + 2], p.equal @ patched]
        right: list[np.ndarray] = [-dead, np.zeros(2 * len(smooth) + p.equal.shape[0])]
        cones = [clarabel.ZeroConeT(sum(map(len, right)))]
        low, high = self.tension_bounds
        pulled, flat, cells = each[forces : first - 1], np.concatenate([smooth, stuck]), np.isfinite(p.most)
        linear = [
            each[3 * flat],
            p.above @ patched,
            each[first:][cells],
            -each[first:][cells],
            pulled[np.isfinite(low)],
            -pulled[np.isfinite(high)],
        ]
        least = [np.zeros(len(flat) + p.above.shape[0] + int(cells.sum())), -p.most[cells], low[np.isfinite(low)], -high[np.isfinite(high)]]
        blocks += [-part for part in linear]
        right.append(-np.concatenate(least))
        cones.append(clarabel.NonnegativeConeT(sum(map(len, least))))
        slides = np.flatnonzero((self.mu > 0.0) & np.isfinite(self.mu))
        friction = sparse.diags_array(self.mu[slides]) @ each[3 * slides]
        self._add_cones(blocks, right, cones, (friction, each[3 * slides + 1], each[3 * slides + 2]))
        if self.assembly.keys is not None:
            weak = np.flatnonzero(np.isfinite(self.assembly.keys.strength))
            key, strength = 3 * corners + 2 * weak, self.assembly.keys.strength[weak] / self.scale
            self._add_cones(blocks, right, cones, (sparse.csr_array((len(weak), count)), each[key], each[key + 1]), strength)
        total = sparse.csr_array(
            (np.ones(corners), (self.assembly.corner_joint, np.arange(corners))), shape=(len(self.assembly.a), corners)
        )
        compression = (total @ each[: 3 * corners : 3]).tocsr()[self.quadrangles]
        s1, s2, w, y = (each[first - corners + p.own + k] for k in range(4))
        root = sparse.diags_array(np.sqrt(self.borne[self.quadrangles]))
        one = np.ones(len(p.own))
        self._add_cones(blocks, right, cones, (s1 + s2, s1 - s2, 2.0 * w))
        self._add_cones(blocks, right, cones, (root @ w + y, root @ w - y, 2.0 * compression))
        self._add_cones(blocks, right, cones, (compression, compression, 2.0 * y), one, -one)
        return sparse.vstack(blocks).tocsr(), np.concatenate(right), cones

    @staticmethod
    def _add_cones(
        blocks: list[sparse.csr_array],
        right: list[np.ndarray],
        cones: list["clarabel.SupportedCone"],
        parts: tuple[sparse.csr_array, sparse.csr_array, sparse.csr_array],
        more: np.ndarray | None = None,
        second: np.ndarray | None = None,
    ) -> None:
        """Cones |(parts[1] + second, parts[2])| <= parts[0] + more, row by row."""
        count = parts[0].shape[0]
        order = np.arange(3 * count).reshape(3, count).T.ravel()
        blocks.append(-sparse.vstack(parts).tocsr()[order])
        nothing = np.zeros(count)
        right.append(np.column_stack([nothing if more is None else more, nothing if second is None else second, nothing]).ravel())
        cones += [clarabel.SecondOrderConeT(3)] * count

    def _crushed(self, x: np.ndarray) -> float:
        """Greatest excess over the conditions of the patches of a solution, over the scale."""
        corners, p = len(self.mu), self.patches
        normal, own = x[: 3 * corners : 3], x[len(x) - len(p.most) :]
        z = np.append(normal, own)
        total = np.bincount(self.assembly.corner_joint, normal, len(self.assembly.a))[self.quadrangles]
        most = np.cbrt(self.borne[self.quadrangles] * np.maximum(z[p.own], 0.0) * np.maximum(z[p.own + 1], 0.0))
        beyond = [np.abs(p.equal @ z), -(p.above @ z), own - p.most, -own, total - most]
        return max(float(part.max(initial=0.0)) for part in beyond)

    def _denied(self, at: np.ndarray, slip: np.ndarray) -> tuple[float, float]:
        """Of contacts that crush nothing is denied but slip without friction; their power is summed over triangles."""
        crush = np.isfinite(self.strength)[self.assembly.corner_joint]
        wrong = max(denied(at[~crush], slip[~crush], self.mu[~crush]), float(slip[crush & ~np.isfinite(self.mu)].max(initial=0.0)))
        mu = np.where(np.isfinite(self.mu), self.mu, 0.0)
        closing = np.bincount(self.assembly.corner_joint, mu * slip - at[:, 0] > 0.0, len(self.assembly.a)) > 0
        return wrong, sum(self._power(j, at, mu) for j in np.flatnonzero(closing & np.isfinite(self.strength)).tolist())

    def _power(self, j: int, at: np.ndarray, mu: np.ndarray) -> float:
        """Power that the crushing of a contact takes, over the scale, of rates (nv, 3) of the corners: not less than the integral, as the
        rate of crushing is convex and here linear between the points of a grid."""
        own = np.flatnonzero(self.assembly.corner_joint == j)
        flat = self._flat(j)
        rate, share = at[own], self.assembly.share[own]
        following = np.roll(np.arange(len(own)), -1)
        middle = np.broadcast_to(share @ rate, rate.shape)
        area = 0.5 * np.abs(flat[:, 0] * flat[following, 1] - flat[:, 1] * flat[following, 0])
        weights, cells = _grid(DIVISIONS)
        nodes = np.einsum("gk,ktx->tgx", weights, np.stack([middle, rate, rate[following]]))
        crushing = mu[own[0]] * np.hypot(nodes[..., 1], nodes[..., 2]) - nodes[..., 0]
        part = _positive_part(crushing[:, cells]).sum(axis=1) / len(cells)
        return float(self.strength[j] / self.scale * (area * part).sum())


class _Rows:
    """Rows of a sparse matrix, one after the other."""

    def __init__(self) -> None:
        self.columns: list[np.ndarray] = []
        self.values: list[np.ndarray] = []

    def add(self, columns: np.ndarray, values: np.ndarray) -> None:
        """A row of values in columns."""
        self.columns.append(columns)
        self.values.append(values)

    def matrix(self, width: int) -> sparse.csr_array:
        """The matrix (rows, width)."""
        start = np.cumsum([0, *map(len, self.columns)])
        parts = (np.concatenate([np.empty(0), *self.values]), np.concatenate([np.empty(0, dtype=int), *self.columns]), start)
        return sparse.csr_array(parts, shape=(len(self.columns), width))


def _outward(flat: np.ndarray) -> np.ndarray:
    """Outward unit normals of the sides of a polygon (k, 2), counter-clockwise."""
    sides = np.roll(flat, -1, axis=0) - flat
    return np.column_stack([sides[:, 1], -sides[:, 0]]) / np.linalg.norm(sides, axis=1)[:, None]


def _cells(flat: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Centres (n, 2) and areas (n) of cells of a polygon (k, 2) about its middle: sectors of its sides, in rings that are thin outside."""
    parts = max(1, -(-ROUND // len(flat)))
    share = (np.arange(parts) / parts)[:, None, None]
    rim = ((1.0 - share) * flat + share * np.roll(flat, -1, axis=0)).transpose(1, 0, 2).reshape(-1, 2)
    after = np.roll(rim, -1, axis=0)
    sector = 0.5 * (rim[:, 0] * after[:, 1] - rim[:, 1] * after[:, 0])
    reach = 1.0 - np.linspace(1.0, 0.0, RINGS + 1) ** 2
    square, cube = np.diff(reach**2), np.diff(reach**3)
    area = square[:, None] * sector
    place = (cube / square)[:, None, None] * (rim + after) / 3.0
    return place.reshape(-1, 2), area.ravel()


def _axes(flat: np.ndarray) -> np.ndarray:
    """Two axes (2, 2) of a quadrangle (4, 2), between the middles of opposite sides."""
    middle = 0.5 * (flat + np.roll(flat, -1, axis=0))
    found = np.stack([middle[2] - middle[0], middle[3] - middle[1]])
    return found / np.linalg.norm(found, axis=1)[:, None]


def _greatest(pairs: np.ndarray, rounding: float) -> np.ndarray:
    """Those of pairs (k, 2) that no other reaches in both numbers."""
    kept: list[np.ndarray] = []
    for pair in pairs[np.lexsort((-pairs[:, 1], -pairs[:, 0]))]:
        if not any((other >= pair - rounding).all() for other in kept):
            kept.append(pair)
    return np.array(kept)


def _grid(count: int) -> tuple[np.ndarray, np.ndarray]:
    """Barycentric weights (nodes, 3) of a triangle whose sides are divided, and its triangles (count^2, 3)."""
    place = {(i, k): n for n, (i, k) in enumerate((i, k) for i in range(count + 1) for k in range(count + 1 - i))}
    weights = np.array([(count - i - k, i, k) for i, k in place]) / count
    up = [(place[i, k], place[i + 1, k], place[i, k + 1]) for i in range(count) for k in range(count - i)]
    down = [(place[i + 1, k], place[i + 1, k + 1], place[i, k + 1]) for i in range(count) for k in range(count - i - 1)]
    return weights, np.array(up + down)


def _positive_part(values: np.ndarray) -> np.ndarray:
    """Mean over triangles of the positive part of functions that are linear between their corners (..., 3)."""
    low, mid, high = np.moveaxis(np.sort(values, axis=-1), -1, 0)
    with np.errstate(divide="ignore", invalid="ignore"):
        tip = high**3 / (3.0 * (high - mid) * (high - low))
        cut = (low + mid + high) / 3.0 - low**3 / (3.0 * (mid - low) * (high - low))
    found: np.ndarray = np.select([high <= 0.0, mid <= 0.0, low < 0.0], [np.zeros_like(high), tip, cut], (low + mid + high) / 3.0)
    return found
