"""How far blocks in space that stand settle under their own weight: what their contacts give, and no more."""

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import splu

from extrados.analyses.dem.settlement import FARTHEST, RIGID, TIMES
from extrados.analyses.dem.solid_model import SolidModel
from extrados.model.geometry.solids.contacts import GROUND
from extrados.schema.constants import GRAVITY


def corner_areas(polygon: np.ndarray) -> np.ndarray:
    """What of a polygon (k, 3) each corner carries (k) [m^2]: that which lies nearer to it, seen from its middle."""
    arm = polygon - polygon.mean(axis=0)
    after = np.roll(arm, -1, axis=0)
    fan = np.cross(arm, after) @ np.cross(arm, after).sum(axis=0)
    arm = arm - (fan[:, None] * (arm + after)).sum(axis=0) / (3.0 * fan.sum())  # from the centroid of the area
    piece = 0.25 * np.linalg.norm(np.cross(arm, np.roll(arm, -1, axis=0)), axis=1)
    return piece + np.roll(piece, 1)


def farthest_settlement(model: SolidModel, rigid: bool = False) -> float:
    """The displacement of a block beyond which it falls instead of settling [m]: a multiple of that under the own weight
    with all contacts held closed, as in the plane (`settlement.py`). Rigid contacts give nothing. Of measured blocks the gaps that
    their noise may leave close as well."""
    gaps = 2.0 * model.assembly.deviation
    if rigid:
        return RIGID * model.size + gaps
    one, v = model.assembly, model.values
    joint, corner = one.corner_joint, one.corner
    area = np.concatenate([corner_areas(p) for p in one.polygon])
    blocks, rows, spring = model.count, [], []
    frames = (one.normal, *one.tangents)
    for axes, stiffness in zip(frames, (v.stiffness, v.shear_stiffness, v.shear_stiffness), strict=True):
        matrix = sparse.csr_array((len(joint), 6 * blocks))
        for block, sense in ((one.a[joint], 1.0), (one.b[joint], -1.0)):
            on = np.flatnonzero(block != GROUND)
            arm = corner[on] - one.centroid[block[on]]
            values = sense * np.concatenate([axes[joint[on]], np.cross(arm, axes[joint[on]])], axis=1)
            where = (np.repeat(on, 6), (6 * block[on][:, None] + np.arange(6)).ravel())
            matrix = matrix + sparse.csr_array((values.ravel(), where), shape=matrix.shape)
        rows.append(matrix)
        spring.append(area * stiffness[joint])
    apart, stiff = sparse.vstack(rows, format="csr"), np.concatenate(spring)
    weight = np.zeros((blocks, 6))
    weight[:, 2] = -GRAVITY * one.mass
    most = FARTHEST * model.size
    try:
        moved = splu((apart.T @ sparse.diags_array(stiff) @ apart).tocsc()).solve(weight.ravel()).reshape(blocks, 6)
    except RuntimeError:  # exactly singular
        return most
    far = float(np.linalg.norm(moved[:, :3], axis=1).max())
    return min(TIMES * far + gaps, most) if np.isfinite(far) else most
