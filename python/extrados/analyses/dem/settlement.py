"""How far a structure that stands settles under its own weight: what its joints give, and no more."""

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu

from extrados.analyses.dem.model import JointValues, Model
from extrados.model.geometry.assembly import GROUND, Assembly
from extrados.model.geometry.polygons import distance
from extrados.schema.constants import GRAVITY

#: What stands settles by .3 to 1.2 times what its joints would give if none opened (tests/unit/test_dem_settlement.py);
#: what has gone so many times as far falls.
TIMES = 10.0
#: Of the size of the structure: however soft its joints are, no settlement goes so far.
FARTHEST = 0.2
#: Of the size: rigid contacts give nothing, but the last gaps close.
RIGID = 1e-3


def farthest_settlement(model: Model, values: JointValues | None = None, rigid: bool = False) -> float:
    """The displacement of a block beyond which it falls instead of settling [m].

    `TIMES` the greatest displacement under the own weight with all joints held closed, and twice that as the gaps of a
    survey close; at most `FARTHEST` of the size. With `values` instead of those of the model where given. On `rigid`
    contacts gaps close, and nothing else gives.
    """
    weight, gaps = closed_settlement(model, values or model.values)
    most = FARTHEST * model.size
    if rigid:
        return most if np.isnan(gaps) else min(RIGID * model.size + 2.0 * gaps, most)
    return most if np.isnan(weight + gaps) else min(TIMES * weight + 2.0 * gaps, most)


def closed_settlement(model: Model, values: JointValues) -> tuple[float, float]:
    """Greatest displacement of a block on the normal and shear springs of joints that all stay closed [m]: under the own
    weight, and as the gaps between their faces close. NaN where some block hangs on no joint."""
    rigid = model.rigid
    joint, one, two = np.array([(j, *pair) for j, pair in enumerate(rigid.joints) if pair is not None]).T
    p, q = model.assembly.p[joint], model.assembly.q[joint]
    area = model.assembly.length[joint] * rigid.depth
    apart, spring = [], []
    for share in (0.5 - np.sqrt(1 / 12), 0.5 + np.sqrt(1 / 12)):  # two points carry a linear pressure exactly
        point = p + share * (q - p)
        for axis, stiffness in (
            (model.assembly.normal[joint], values.stiffness[joint]),
            (model.assembly.tangent[joint], values.shear_stiffness[joint]),
        ):
            apart.append(_apart(axis, point, one, two, rigid.centroid)[:, : 3 * rigid.count])
            spring.append(0.5 * area * stiffness)
    rows, stiffness = sparse.vstack(apart, format="csr"), np.concatenate(spring)
    weight = np.zeros((rigid.count, 3))
    weight[:, 1] = -GRAVITY * rigid.mass[: rigid.count]
    if (load := model.load) is not None:
        weight += load[: rigid.count, :3]
    gap = _gaps(model.assembly)[joint]
    nothing = np.zeros_like(gap)
    closing = rows.T @ (stiffness * np.concatenate([gap, nothing, gap, nothing]))
    try:
        factor = splu((rows.T @ sparse.diags(stiffness) @ rows).tocsc())
    except RuntimeError:  # exactly singular
        return np.nan, np.nan
    moved = factor.solve(np.column_stack([weight.ravel(), closing])).reshape(rigid.count, 3, 2)
    far = np.hypot(moved[:, 0], moved[:, 1]).max(axis=0)
    return (float(far[0]), float(far[1])) if np.isfinite(far).all() else (np.nan, np.nan)


def _apart(axis: np.ndarray, point: np.ndarray, one: np.ndarray, two: np.ndarray, centroid: np.ndarray) -> sparse.csr_matrix:
    """How body `one` moves away from body `two` at points, along axes: (joints, 3 bodies)."""
    rows = np.repeat(np.arange(len(one)), 6).reshape(-1, 6)
    columns = np.hstack([3 * one[:, None] + np.arange(3), 3 * two[:, None] + np.arange(3)])
    arms = [point - centroid[body] for body in (one, two)]
    turns = [axis[:, 1] * arm[:, 0] - axis[:, 0] * arm[:, 1] for arm in arms]
    values = np.column_stack([axis, turns[0], -axis, -turns[1]])
    return sparse.csr_matrix((values.ravel(), (rows.ravel(), columns.ravel())), shape=(len(one), 3 * len(centroid)))


def _gaps(assembly: Assembly) -> np.ndarray:
    """Widest distance between the two faces of each joint at its ends (joints,) [m]."""
    ends = np.stack([assembly.p, assembly.q], axis=1)
    found = np.zeros(ends.shape[:2])
    for side in (assembly.a, assembly.b):
        for j in np.flatnonzero(side != GROUND):
            found[j] += distance(assembly.outlines[side[j]], ends[j])
    return found.max(axis=1)
