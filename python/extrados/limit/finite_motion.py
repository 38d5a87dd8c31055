"""A collapse mechanism carried through finite rotations, so that drawn blocks keep their shape."""

import numpy as np

from extrados.limit.states import Mechanism
from extrados.model.geometry.assembly import GROUND, Assembly

STEPS = 12
MOST_PARTS = 60  # more moving parts, as in a wall, are carried along their velocities without correction
SHOWN = 0.06  # of the size of the assembly: the greatest displacement of the drawn mechanism
TURN = 0.2  # rad: and the greatest rotation


def rigid_parts(assembly: Assembly, mechanism: Mechanism) -> np.ndarray:
    """Number of the rigid part each block moves with; 0 is what stays with the ground."""
    moving = {j for j, _ in mechanism.hinges} | set(mechanism.sliding)
    count = len(assembly.mass)
    leader = list(range(count + 1))  # the last is the ground

    def find(i: int) -> int:
        while leader[i] != i:
            leader[i] = leader[leader[i]]
            i = leader[i]
        return i

    for j, (a, b) in enumerate(zip(assembly.a.tolist(), assembly.b.tolist(), strict=True)):
        if j not in moving:
            leader[find(a if a != GROUND else count)] = find(b if b != GROUND else count)
    roots = [find(i) for i in range(count + 1)]
    number = {roots[count]: 0}
    for root in roots:
        number.setdefault(root, len(number))
    return np.array([number[root] for root in roots[:count]])


def finite_motion(assembly: Assembly, mechanism: Mechanism, amount: float | None = None) -> np.ndarray:
    """Poses (nb, 3) of the blocks, x, y of the centroids [m] and rotation [rad], as the mechanism moves on.

    amount: greatest displacement of a centroid on the straight path [m]. The hinges stay closed: Newton's
    method on their coincidence, the rotation of the fastest part being prescribed. A mechanism that locks
    before is carried as far as it goes; one of very many parts follows its velocities.
    """
    part = rigid_parts(assembly, mechanism)
    parts = int(part.max()) + 1
    velocity = np.zeros((parts, 3))  # of each part's point at the origin
    x, y = assembly.centroid.T
    v = mechanism.velocity
    at_origin = np.column_stack([v[:, 0] + v[:, 2] * y, v[:, 1] - v[:, 2] * x, v[:, 2]])
    for k in range(1, parts):
        velocity[k] = at_origin[part == k].mean(axis=0)
    fastest = np.hypot(v[:, 0], v[:, 1]).max()
    total = amount / fastest if amount is not None else SHOWN * assembly.size / fastest
    if amount is None:
        total = min(total, TURN / max(float(np.abs(v[:, 2]).max()), 1e-300))
    number = np.append(part, 0)  # GROUND = -1
    a, b = number[assembly.a], number[assembly.b]
    pivot = mechanism.pivot
    hinged = np.array([j for j, _ in mechanism.hinges], dtype=int)
    sliding = np.array(mechanism.sliding, dtype=int)
    at_hinges = assembly.p[hinged] + pivot[hinged, None] * (assembly.q[hinged] - assembly.p[hinged])
    joined = np.concatenate([hinged, sliding])
    contacts = (a[joined], b[joined], np.concatenate([at_hinges, assembly.middle[sliding]]), len(hinged))
    driver = int(np.abs(velocity[:, 2]).argmax())
    turns = abs(velocity[driver, 2]) * assembly.size > 1e-9 * fastest
    if parts > MOST_PARTS:
        return np.column_stack([assembly.centroid + total * v[:, :2], total * v[:, 2]])
    pose = np.zeros((parts, 3))
    for step in range(1, STEPS + 1):
        start = pose
        pose = pose + velocity * total / STEPS
        target = velocity * total * step / STEPS
        for _ in range(20):
            change = _correct(pose, target, contacts, driver if turns else None, assembly.size)
            pose = pose + change
            if np.abs(change).max() < 1e-12 * assembly.size:
                break
        else:
            pose = start
            break
    c, s = np.cos(pose[part, 2]), np.sin(pose[part, 2])
    return np.column_stack([pose[part, 0] + c * x - s * y, pose[part, 1] + s * x + c * y, pose[part, 2]])


def _correct(
    pose: np.ndarray, target: np.ndarray, contacts: tuple[np.ndarray, np.ndarray, np.ndarray, int], driver: int | None, size: float
) -> np.ndarray:
    """One Newton step, of least size, towards closed hinges and the prescribed rotation.

    contacts: the two parts (contacts) and the point (contacts, 2) of each, hinges first, and how many are hinges; the
    others slide by what `target` says. Part 0 is the ground, which stays.
    """
    one, two, point, hinges = contacts
    n, parts = len(one), len(pose)
    if n == 0 and driver is None:
        return np.zeros(pose.shape)
    c, s = np.cos(pose[:, 2]), np.sin(pose[:, 2])

    def place(k: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Where the points lie on parts k, and how fast they move as these turn."""
        x = c[k] * point[:, 0] - s[k] * point[:, 1]
        y = s[k] * point[:, 0] + c[k] * point[:, 1]
        return pose[k, :2] + np.column_stack([x, y]), np.column_stack([-y, x])

    (at_one, spin_one), (at_two, spin_two) = place(one), place(two)
    gap = at_two - at_one
    wanted = target[one[hinges:]] - target[two[hinges:]]
    gap[hinges:] += wanted[:, :2] + wanted[:, 2:] * np.column_stack([-point[hinges:, 1], point[hinges:, 0]])
    matrix = np.zeros((2 * n + (driver is not None), parts, 3))
    right = np.zeros(len(matrix))
    for axis in (0, 1):
        row = 2 * np.arange(n) + axis
        matrix[row, one, axis] += 1.0
        matrix[row, one, 2] += spin_one[:, axis]
        matrix[row, two, axis] -= 1.0
        matrix[row, two, 2] -= spin_two[:, axis]
        right[row] = gap[:, axis]
    if driver is not None:
        matrix[-1, driver, 2] = size
        right[-1] = size * (target[driver, 2] - pose[driver, 2])
    matrix[:, 0] = 0.0
    scale = np.array([1.0, 1.0, 1.0 / size])  # rotations count as displacements at the size of the assembly
    change = np.linalg.lstsq((matrix * scale).reshape(len(matrix), -1), right, rcond=1e-10)[0]
    return change.reshape(pose.shape) * scale
