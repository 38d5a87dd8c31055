"""Torsion of faces: associated friction of whole faces under an even pressure, beside that of their corners.

Forces at the corners let the pressure of a face stand on the corners alone, which resists torsion 1.85 to 1.94 times as much as
an even pressure (rectangles of 1 : 1 to 1 : 4). Here each face has one friction: |(V1, V2, M / rho)| <= mu N, with both shears at
the centre of the pressure, the torsion M about it, and rho the mean distance of the pressed rectangle (b - 2 |e_b|) (h - 2 |e_h|)
from its middle (after Orduna and Lourenco 2005). Centre and rho are those of the solution before, so that the value is a
fixed point, not a bound.
"""

from dataclasses import dataclass

import clarabel
import numpy as np
from scipy import sparse

from extrados.limit.errors import NoAnswer
from extrados.limit.solids import SolidLimit
from extrados.model.geometry.assembly import GROUND

SOLVES, LAST = 20, 8  # and those of them that count
DAMPED = 0.5  # share by which centres and mean distances follow
SETTLED = 0.05  # of gamma: range of the last solves
THIN = 1e-3  # of a side: the pressed rectangle is no narrower
CARRIES = 1e-9  # of the weight: faces pressed by less keep their centre
ACCURACY = 1e-9


@dataclass(frozen=True)
class FaceLoad:
    """gamma: multiplier with the friction of faces, the least of the last solves [g]; spread: their range [g]."""

    gamma: float
    spread: float


def mean_distance(b: np.ndarray, h: np.ndarray) -> np.ndarray:
    """Mean distance of the points of rectangles b by h from their middles."""
    return np.hypot(b, h) / 6.0 + b**2 / (12.0 * h) * np.arcsinh(h / b) + h**2 / (12.0 * b) * np.arcsinh(b / h)


class FaceLaw:
    """The programme of one structure in which faces slide and twist as wholes."""

    def __init__(self, limit: SolidLimit):
        self.limit = limit
        one = limit.assembly
        self.faces = len(one.a)
        first, second = one.tangents
        self.frames = np.stack([one.normal, first, second], axis=1)
        self.middle, self.axes, self.sides = (np.stack(part) for part in zip(*map(self._rectangle, range(self.faces)), strict=True))
        self.mu = limit.mu[np.unique(one.corner_joint, return_index=True)[1]]

    def _rectangle(self, j: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Centroid (3), principal axes (2, 3) and sides (2) [m] of the rectangle with the area moments of a face."""
        points, frame = self.limit.assembly.polygon[j], self.frames[j]
        flat = (points - points[0]) @ frame[1:].T
        x, y = flat.T
        xn, yn = np.roll(flat, -1, axis=0).T
        cross = x * yn - xn * y
        area = 0.5 * cross.sum()
        centre = np.array([((x + xn) * cross).sum(), ((y + yn) * cross).sum()]) / (6.0 * area)
        xx = ((x * x + x * xn + xn * xn) * cross).sum() / 12.0 / area - centre[0] ** 2
        yy = ((y * y + y * yn + yn * yn) * cross).sum() / 12.0 / area - centre[1] ** 2
        xy = ((x * yn + 2.0 * x * y + 2.0 * xn * yn + xn * y) * cross).sum() / 24.0 / area - centre[0] * centre[1]
        moments, ways = np.linalg.eigh(np.array([[xx, xy], [xy, yy]]))
        return points[0] + centre @ frame[1:], ways.T @ frame[1:], np.sqrt(12.0 * np.maximum(moments, 0.0))

    def push(self, direction: float) -> FaceLoad:
        """The multiplier along a direction [deg]; NoAnswer where the solver gives up or the value does not settle."""
        dead, live = self.limit.ways(direction)
        one = self.limit.assembly
        centre, distance = self.middle.copy(), mean_distance(*self.sides.T)
        found: list[float] = []
        for _ in range(SOLVES):
            gamma, normal = self._solve(dead, live, centre, distance)
            found.append(gamma)
            total = np.bincount(one.corner_joint, normal, self.faces)
            moment = np.stack([np.bincount(one.corner_joint, normal * one.corner[:, k], self.faces) for k in range(3)], axis=1)
            presses = total > CARRIES * self.limit.weight.sum() / self.limit.scale
            at = np.where(presses[:, None], moment / np.where(presses, total, 1.0)[:, None], centre)
            off = np.abs(np.einsum("jx,jkx->jk", at - self.middle, self.axes))
            pressed = np.maximum(self.sides - 2.0 * off, THIN * self.sides)
            centre += DAMPED * (at - centre)
            distance += DAMPED * (mean_distance(*pressed.T) - distance)
        low, high = min(found[-LAST:]), max(found[-LAST:])
        if high - low > SETTLED * abs(low):
            raise NoAnswer(f"the iteration of the face law did not converge: its last values vary from {low:.4f} to {high:.4f} g")
        return FaceLoad(low, high - low)

    def _solve(self, dead: np.ndarray, live: np.ndarray, centre: np.ndarray, distance: np.ndarray) -> tuple[float, np.ndarray]:
        """Greatest multiplier and compressions of the corners, with shears at given centres and torsion over given distances."""
        limit, one = self.limit, self.limit.assembly
        corners, faces = len(limit.mu), self.faces
        keyed = limit.matrix[:, 3 * corners :]
        matrix = sparse.hstack(
            [limit.matrix[:, 0 : 3 * corners : 3], self._shears(centre, distance), keyed, limit.pulls, sparse.csc_array(live[:, None])]
        )
        n = matrix.shape[1]
        each = sparse.eye_array(n, format="csr")
        slides = np.flatnonzero(np.isfinite(self.mu))
        mu = np.where(np.isfinite(self.mu), self.mu, 0.0)[one.corner_joint]
        share = sparse.csr_array((mu, (one.corner_joint, np.arange(corners))), shape=(faces, n))
        rows = sparse.vstack([share[slides], *(each[corners + 3 * slides + k] for k in range(3))])
        order = np.arange(4 * len(slides)).reshape(4, len(slides)).T.ravel()
        blocks, right = ([matrix, -each[:corners], -rows.tocsr()[order]], [-dead, np.zeros(corners), np.zeros(4 * len(slides))])
        cones = [clarabel.ZeroConeT(len(dead)), clarabel.NonnegativeConeT(corners)]
        cones += [clarabel.SecondOrderConeT(4)] * len(slides)
        if one.keys is not None:
            for k in np.flatnonzero(np.isfinite(one.keys.strength)).tolist():
                own = corners + 3 * faces + 2 * k
                blocks += [sparse.csr_array((1, n)), -each[[own, own + 1]]]
                right += [np.array([one.keys.strength[k] / limit.scale]), np.zeros(2)]
                cones.append(clarabel.SecondOrderConeT(3))
        if limit.strands:
            own, bounds = each[n - 1 - len(limit.strands) : n - 1], limit.tension_bounds
            low, high = np.isfinite(bounds)
            blocks += [-own[low], own[high]]
            right += [-bounds[0][low], bounds[1][high]]
            cones.append(clarabel.NonnegativeConeT(int(low.sum() + high.sum())))
        cost = np.zeros(n)
        cost[-1] = -1.0
        settings = clarabel.DefaultSettings()
        settings.verbose = False
        settings.max_threads = 1
        settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = ACCURACY
        nothing = sparse.csc_array((n, n))
        found = clarabel.DefaultSolver(nothing, cost, sparse.vstack(blocks).tocsc(), np.concatenate(right), cones, settings).solve()
        if "Solved" not in str(found.status):
            raise NoAnswer(f"the conic solver found no solution for the face law: {found.status}")
        x = np.array(found.x)
        return float(x[-1]), np.maximum(x[:corners], 0.0)

    def _shears(self, centre: np.ndarray, distance: np.ndarray) -> sparse.csc_array:
        """Forces on the blocks (6 nb, 3 faces) of both shears of each face and of its torsion over the mean distance."""
        one = self.limit.assembly
        rows, cols, values = [], [], []
        for block, sense in ((one.a, 1.0), (one.b, -1.0)):
            on = np.flatnonzero(block != GROUND)
            arm = (centre[on] - one.centroid[block[on]]) / one.size
            for k in range(3):
                if k < 2:
                    way = self.frames[on, k + 1]
                    wrench = np.concatenate([way, np.cross(arm, way)], axis=1)
                else:
                    twist = self.frames[on, 0] * (distance[on] / one.size)[:, None]
                    wrench = np.concatenate([np.zeros_like(twist), twist], axis=1)
                rows.append((6 * block[on][:, None] + np.arange(6)).ravel())
                cols.append(np.repeat(3 * on + k, 6))
                values.append(sense * wrench.ravel())
        where = (np.concatenate(rows), np.concatenate(cols))
        return sparse.csc_array((np.concatenate(values), where), shape=(6 * len(one.mass), 3 * self.faces))
