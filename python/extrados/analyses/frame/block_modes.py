"""modes: vibration of arches, vaults, columns and other plane assemblies of blocks, all joints closed.

Each block is rigid; its elasticity, and that of the joints, lies in springs along the joints. Per area a joint has the normal
stiffness 1/(h_a/E_a + h_b/E_b + 1/k_n) and the shear stiffness 1/(1.2 h_a/G_a + 1.2 h_b/G_b + 1/k_s), h the distance of the centroid
from the joint (Kawai 1978). Rows of blocks are Timoshenko beams as the blocks become short.
"""

import numpy as np
from scipy.linalg import eigh

from extrados.analyses.context import Context, Refused
from extrados.analyses.frame.tables import Modes
from extrados.model.geometry.assembly import GROUND, Assembly
from extrados.results import frame as out
from extrados.results.model import Array, Result
from extrados.views.building import Building

#: Shear factor of rectangles
SHEAR_FACTOR = 1.2


def matrices(building: Building, blocks: Assembly) -> tuple[np.ndarray, np.ndarray]:
    """Stiffness and mass (3 n, 3 n) for the displacements x, y and the rotation of n blocks [N/m, kg and products with m]."""
    n, joints = len(blocks.mass), building.joints
    # 1/k_n and 1/k_s of every joint, 0 where the deck gives no stiffness
    normal = building.joint_property("normal_stiffness")
    tangential = np.full_like(normal, joints.shear_stiffness) if joints.shear_stiffness else joints.shear_ratio * normal
    springs = np.nan_to_num(1.0 / np.array([normal, tangential]).T)
    tables = [building.materials[name] if name else building.material for name in blocks.materials or [None] * n]
    young = np.array([one.young for one in tables])
    shear = young / (2.0 * (1.0 + np.array([one.poisson for one in tables])))
    stiffness, mass = np.zeros((3 * n, 3 * n)), np.zeros((3 * n, 3 * n))
    for j, pair in enumerate(blocks.ends):
        axes, length, compliance = (blocks.normal[j], blocks.tangent[j]), blocks.length[j], springs[j].copy()
        rows = np.zeros((3, 3 * n))
        for block, sign in zip(pair, (1.0, -1.0), strict=True):
            if block == GROUND:
                continue
            arm = blocks.middle[j] - blocks.centroid[block]
            height = abs(float(arm @ axes[0]))
            compliance += height / young[block], SHEAR_FACTOR * height / shear[block]
            turned = np.array([-arm[1], arm[0]])
            for row, axis in enumerate(axes):
                rows[row, 3 * block : 3 * block + 3] = sign * np.array([*axis, axis @ turned])
            rows[2, 3 * block + 2] = sign
        along, across = blocks.depth * length / compliance
        stiffness += rows.T @ (np.array([along, across, along * length**2 / 12.0])[:, None] * rows)
    for k in range(n):
        own = np.diag([blocks.mass[k], blocks.mass[k], blocks.inertia[k]])
        if blocks.fill is not None and blocks.fill[k, 0] > 0.0:
            weight, arm = blocks.fill[k, 0], blocks.fill[k, 1:] - blocks.centroid[k]
            moved = np.array([[1.0, 0.0, -arm[1]], [0.0, 1.0, arm[0]]])
            own = own + weight * moved.T @ moved
        mass[3 * k : 3 * k + 3, 3 * k : 3 * k + 3] = own
    return stiffness, mass


def run(context: Context, options: Modes) -> Result:
    """The modes of lowest frequency."""
    result = Result("modes")
    building = context.building
    blocks = building.blocks()
    given = building.joints.model_fields_set
    if "shear_ratio" in given and np.isnan(building.joint_property("normal_stiffness")).all():
        context.warnings.append("`shear_ratio` of [joints] has no effect, because no joint has a `normal_stiffness`.")
    stiffness, mass = matrices(building, blocks)
    count = min(options.modes, len(mass))
    values, shapes = eigh(stiffness, mass, subset_by_index=[0, count - 1])
    if not values[0] > 1e-9 * np.trace(stiffness) / np.trace(mass):
        raise Refused("the blocks are not restrained: at least one mode has no frequency. Give supports", ("structure",))
    unit = np.tile(np.eye(3)[:, :2], (len(blocks.mass), 1))
    moving = unit.T @ mass @ unit
    shares = (unit.T @ mass @ shapes) ** 2 / np.diag(moving)[:, None]
    rows = [
        out.FrameMode(frequency_Hz=float(f), period_s=1.0 / float(f), mass_ratio_x=float(x), mass_ratio_y=float(y))
        for f, x, y in zip(np.sqrt(values) / (2.0 * np.pi), *shares, strict=True)
    ]
    result.results = out.Modes(modes=rows, moving_mass_kg=float(moving[0, 0]), blocks=len(blocks.mass))
    moved = np.array([s.reshape(-1, 3) / np.abs(s.reshape(-1, 3)[:, :2]).max() for s in shapes.T])
    result.arrays["place"] = Array(blocks.centroid, ("block", "xy"), "m", "centroids of the blocks")
    result.arrays["shape"] = Array(moved[:, :, :2], ("mode", "block", "direction"), "", "displacements of the blocks along x and y")
    first = rows[0]
    result.answer = (
        f"First natural frequency {first['frequency_Hz']:.3g} Hz (period {first['period_s']:.3g} s), with all joints "
        f"closed. The participating mass of this mode is {100 * first['mass_ratio_x']:.3g} % along x and "
        f"{100 * first['mass_ratio_y']:.3g} % vertically."
    )
    return result
