"""A collapse mechanism as rigid parts on hinges with one degree of freedom, ready to be carried through its motion."""

from dataclasses import dataclass

import numpy as np

from extrados.limit.finite_motion import rigid_parts
from extrados.limit.states import Mechanism
from extrados.model.geometry.assembly import GROUND, Assembly

# Of the fastest speed of the mechanism: slip, or crushing, that is more than rounding.
SLIPS = 1e-5
# Of the fastest rotation: parts that turn slower do not serve as the coordinate.
TURNS = 1e-3
# Rows of the equations that depend on the others, relative; and how far the velocities may differ.
DEPENDENT, SAME = 1e-9, 1e-6


class CannotRock(ValueError):
    """The mechanism is not one of rigid parts on hinges with one degree of freedom; the text says why."""


@dataclass(frozen=True)
class Linkage:
    """Rigid parts on hinges; the coordinate q is the rotation of part `driver` (from 1; 0 is the ground), counted
    counter-clockwise where sense is +1.

    side: +1 where it rocks to +x. part (blocks): the part of each block. mass [kg], centroid (parts, 2) [m] and
    inertia (parts) [kg m^2], fill included. Hinge h lies at point[h] [m] on joint[h] and joins the parts
    joined[h]. row (3 parts - 1, 2): hinge and axis, from 1, of the equations that fix the motion; others
    follow from them.
    """

    side: int
    part: np.ndarray
    mass: np.ndarray
    centroid: np.ndarray
    inertia: np.ndarray
    joint: np.ndarray
    joined: np.ndarray
    point: np.ndarray
    row: np.ndarray
    driver: int
    sense: int

    @property
    def determinate(self) -> bool:
        """Do the equations of motion fix the forces at the hinges?"""
        return len(self.row) == 2 * len(self.joint)

    def blocks(self, assembly: Assembly, place: np.ndarray) -> np.ndarray:
        """Places (..., blocks, 3) x, y of the centroids [m] and rotation [rad] from those of the parts (..., parts, 3)."""
        out = np.zeros((*place.shape[:-2], len(self.part), 3))
        out[..., :2] = assembly.centroid
        moving = self.part > 0
        k = self.part[moving] - 1
        arm = assembly.centroid[moving] - self.centroid[k]
        c, s = np.cos(place[..., k, 2]), np.sin(place[..., k, 2])
        out[..., moving, 0] = place[..., k, 0] + c * arm[:, 0] - s * arm[:, 1]
        out[..., moving, 1] = place[..., k, 1] + s * arm[:, 0] + c * arm[:, 1]
        out[..., moving, 2] = place[..., k, 2]
        return out

    def block_rates(self, assembly: Assembly, place: np.ndarray, rate: np.ndarray) -> np.ndarray:
        """Velocities (..., blocks, 3) of the centroids [m/s] and spins [rad/s] of the blocks, from places and velocities of the
        parts (..., parts, 3)."""
        out = np.zeros((*place.shape[:-2], len(self.part), 3))
        moving = self.part > 0
        k = self.part[moving] - 1
        arm = self.blocks(assembly, place)[..., moving, :2] - place[..., k, :2]
        out[..., moving, :] = rate[..., k, :]
        out[..., moving, :2] += rate[..., k, 2, None] * np.stack([-arm[..., 1], arm[..., 0]], axis=-1)
        return out

    def velocities(self, points: np.ndarray, first: np.ndarray) -> np.ndarray:
        """Velocities (blocks, 3) at rest of points [m] of the blocks, and spins, from those of the parts (parts, 3)."""
        out = np.zeros((len(self.part), 3))
        moving = self.part > 0
        k = self.part[moving] - 1
        arm = points[moving] - self.centroid[k]
        out[moving] = first[k]
        out[moving, :2] += first[k, 2, None] * np.column_stack([-arm[:, 1], arm[:, 0]])
        return out


def linkage(assembly: Assembly, mechanism: Mechanism, side: int) -> Linkage:
    """The parts and hinges of a mechanism that rocks to +x (side 1) or -x (-1).

    The coordinate is the rotation of the buttress that turns on the ground where one does; else of the part that
    turns about the farthest hinge on what stays at rest, to the left for side 1 and to the right for side -1: of an
    arch that is link AB (thesis Fig. 5-1). CannotRock where parts slide, stone crushes, or the hinges leave more
    than one degree of freedom.
    """
    names = assembly.joint_names
    ends = np.stack([mechanism.opening_p, mechanism.opening_q, mechanism.slip])
    fastest = float(np.hypot(*mechanism.velocity[:, :2].T).max())
    slides = [j for j in _moving(mechanism) if abs(mechanism.slip[j]) > SLIPS * fastest]
    if slides:
        raise CannotRock(
            f"the mechanism slides along {_listed(names, slides)}: a rocking mechanism must rotate about hinges without sliding"
        )
    crushes = [j for j in _moving(mechanism) if ends[:2, j].min() < -SLIPS * fastest]
    if crushes:
        raise CannotRock(f"the blocks crush at {_listed(names, crushes)}: rocking requires hinges at sharp edges, without crushing")

    part = rigid_parts(assembly, mechanism)
    count = int(part.max())
    number = np.append(part, 0)  # GROUND = -1 is the last
    joint = np.array([j for j, _ in mechanism.hinges], dtype=int)
    joined = np.column_stack([number[assembly.a[joint]], number[assembly.b[joint]]])
    at_p = np.abs(mechanism.opening_p[joint]) < np.abs(mechanism.opening_q[joint])
    point = np.where(at_p[:, None], assembly.p[joint], assembly.q[joint])
    apart = joined[:, 0] != joined[:, 1]
    joint, joined, point = joint[apart], joined[apart], point[apart]
    mass, centroid, inertia = _mass(assembly, part, count)
    spin = np.array([mechanism.velocity[part == k + 1, 2].mean() for k in range(count)])
    driver = _driver(assembly, joint, joined, point, spin, side)
    parted = f", because the mechanism opens along the whole of {_listed(names, mechanism.sliding)}" if mechanism.sliding else ""
    row = _independent(centroid, joined, point, assembly.size, driver, parted)
    made = Linkage(side, part, mass, centroid, inertia, joint, joined, point, row, driver, 1 if spin[driver - 1] > 0.0 else -1)
    _same_motion(made, assembly, mechanism, fastest)
    return made


def _moving(mechanism: Mechanism) -> list[int]:
    return sorted({j for j, _ in mechanism.hinges} | set(mechanism.sliding))


def _listed(names: list[str], joints: list[int]) -> str:
    more = f" and {len(joints) - 4} more" if len(joints) > 4 else ""
    return ", ".join(names[j] for j in joints[:4]) + more


def laden(assembly: Assembly) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Mass [kg], centroid (blocks, 2) [m] and inertia [kg m^2] of the blocks with the fill that rides on them."""
    if assembly.fill is None:
        return assembly.mass, assembly.centroid, assembly.inertia
    fill, place = assembly.fill[:, 0], assembly.fill[:, 1:]
    mass = assembly.mass + fill
    centroid = (assembly.mass[:, None] * assembly.centroid + fill[:, None] * place) / mass[:, None]
    apart = ((place - assembly.centroid) ** 2).sum(axis=1)
    return mass, centroid, assembly.inertia + assembly.mass * fill / mass * apart


def _mass(assembly: Assembly, part: np.ndarray, count: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Mass, centroid and inertia of each part, fill included."""
    blocks = laden(assembly)
    mass, centroid, inertia = np.zeros(count), np.zeros((count, 2)), np.zeros(count)
    for k in range(count):
        m, at, spin = (values[part == k + 1] for values in blocks)
        mass[k] = m.sum()
        centroid[k] = m @ at / mass[k]
        inertia[k] = spin.sum() + m @ ((at - centroid[k]) ** 2).sum(axis=1)
    return mass, centroid, inertia


def _driver(assembly: Assembly, joint: np.ndarray, joined: np.ndarray, point: np.ndarray, spin: np.ndarray, side: int) -> int:
    """The part whose rotation is the coordinate, see `linkage`."""
    turning = np.append(0.0, np.abs(spin)) > TURNS * np.abs(spin).max(initial=0.0)
    order = np.argsort(side * point[:, 0], kind="stable")
    blocks = np.where(assembly.a[joint] == GROUND, assembly.b[joint], assembly.a[joint])
    grounded = (assembly.a[joint] == GROUND) | (assembly.b[joint] == GROUND)
    buttress = grounded & np.isin(blocks, assembly.buttresses)
    for candidates in (order[buttress[order]], order):
        for h in candidates:
            if 0 in joined[h] and turning[joined[h].max()]:
                return int(joined[h].max())
    raise CannotRock("no part of the mechanism rotates about a hinge on a part that is at rest")


def _jacobian(centroid: np.ndarray, joined: np.ndarray, point: np.ndarray, size: float) -> np.ndarray:
    """Hinge equations (2 hinges, 3 parts) at rest: displacements as shares of the size, and rotations."""
    rows = np.zeros((len(joined), 2, len(centroid), 3))
    for h, pair in enumerate(joined):
        for k, sign in zip(pair, (1.0, -1.0), strict=True):
            if k:
                x, y = (point[h] - centroid[k - 1]) / size
                rows[h, :, k - 1] += sign * np.array([[1.0, 0.0, -y], [0.0, 1.0, x]])
    return rows.reshape(2 * len(joined), -1)


def _independent(centroid: np.ndarray, joined: np.ndarray, point: np.ndarray, size: float, driver: int, parted: str) -> np.ndarray:
    """Hinge and axis, from 1, of the equations that with the prescribed rotation of the driver fix the motion.

    CannotRock where they do not; `parted` ends the sentence.
    """
    rows = _jacobian(centroid, joined, point, size)
    first = np.zeros(rows.shape[1])
    first[3 * driver - 1] = 1.0
    basis, kept = [first], []
    for r, row in enumerate(rows):
        rest = row.copy()
        for _ in range(2):  # the second pass clears what rounding left of the first
            for b in basis:
                rest -= (rest @ b) * b
        length = float(np.linalg.norm(rest))
        if length > DEPENDENT * np.linalg.norm(row):
            basis.append(rest / length)
            kept.append(r)
    if len(basis) < rows.shape[1]:
        free = rows.shape[1] - len(basis) + 1
        raise CannotRock(
            f"the mechanism has {len(centroid)} moving parts and {len(joined)} hinges, and thus {free} degrees of freedom "
            f"instead of one{parted}"
        )
    kept_rows = np.array(kept)
    return np.column_stack([kept_rows // 2 + 1, kept_rows % 2 + 1])


def _same_motion(made: Linkage, assembly: Assembly, mechanism: Mechanism, fastest: float) -> None:
    """CannotRock where the hinges move the parts otherwise than the mechanism found: it must part a joint to move."""
    rows = _jacobian(made.centroid, made.joined, made.point, assembly.size)
    moving = made.part > 0
    k = made.part[moving] - 1
    velocity = mechanism.velocity[moving]
    arm = made.centroid[k] - assembly.centroid[moving]
    of_block = np.column_stack([velocity[:, 0] - velocity[:, 2] * arm[:, 1], velocity[:, 1] + velocity[:, 2] * arm[:, 0], velocity[:, 2]])
    field = np.zeros((len(made.mass), 3))
    field[k] = of_block
    field[:, :2] /= assembly.size
    error = rows @ field.ravel() if len(rows) else np.zeros(1)
    if np.abs(error).max() * assembly.size > SAME * fastest:
        raise CannotRock("the hinges alone do not give the mechanism that was found: it also moves at other joints")
