"""Chains of stones found in any assembly: arches from springing to springing, and stacks on the ground."""

import itertools
from dataclasses import replace

import numpy as np

from extrados.model.errors import BadGeometry
from extrados.model.geometry.assembly import GROUND, Assembly

#: Degrees between neighbouring joints below which a survey tells no voussoirs from courses
LEAST_STEP = 0.5
#: Shares of the median turn between neighbouring joints, and the ratio of lengths, with which a joint carries an arch on
TURN, LIKE = (0.3, 2.5), 1.5


def with_chains(assembly: Assembly) -> Assembly:
    """The assembly with its chains named, and their joints turned so that p lies on the intrados, q on the extrados.

    A chain is a row of at least two stones of two joints each, between the ground and stones that have more; a stack
    is a row that leads from the ground to a free end. Arches are called "chain", stacks "stack", with numbers from
    left to right where there are several; those between two grounds come first.
    """
    spans, stacks = [], []
    for joints in _rows(assembly):
        grounded = int(_on_ground(assembly, joints[0])) + int(_on_ground(assembly, joints[-1]))
        if is_stack(assembly, joints):
            if grounded:
                stacks.append(joints if _on_ground(assembly, joints[0]) else joints[::-1])
        elif len(joints) > 2:
            ends = assembly.middle[[joints[0], joints[-1]], 0]
            spans.append((2 - grounded, min(ends), joints if ends[0] <= ends[1] else joints[::-1]))
    spans.sort(key=lambda span: span[:2])
    stacks.sort(key=lambda joints: assembly.middle[joints[0], 0])
    chains: dict[str, list[int]] = {}
    for word, rows in (("chain", [joints for _, _, joints in spans]), ("stack", stacks)):
        chains |= {word if len(rows) == 1 else f"{word} {k}": joints for k, joints in enumerate(rows, start=1)}
    return _turned(replace(assembly, chains=chains), [joints for _, _, joints in spans])


def in_order(assembly: Assembly) -> Assembly:
    """A single arch between two grounds with its stones and joints numbered from left to right: joint k has stone k on its
    right, `a`, and stone k - 1 on its left, `b`. BadGeometry where the assembly is something else."""
    joints = next(iter(assembly.chains.values()), [])
    count = len(assembly.mass)
    ends = [{int(assembly.a[j]), int(assembly.b[j])} for j in joints]
    whole = len(assembly.chains) == 1 and len(joints) == len(assembly.a) == count + 1
    if not whole or not (GROUND in ends[0] and GROUND in ends[-1]):
        raise BadGeometry(
            f"expected a single arch between two supports; the structure has {count} blocks, {len(assembly.a)} joints and "
            f"{len(assembly.chains)} rows of blocks"
        )
    order = [next(iter((one & two) - {GROUND})) for one, two in itertools.pairwise(ends)]
    a, b = np.array([*order, GROUND]), np.array([GROUND, *order])
    inward = np.sign((assembly.normal[joints] * _left(assembly.p[joints], assembly.q[joints])).sum(axis=1))
    inward = np.where(assembly.a[joints] == a, inward, -inward).astype(int)
    rank = np.empty(count + 1, dtype=int)
    rank[order], rank[GROUND] = np.arange(count), GROUND
    return replace(
        assembly,
        outlines=[assembly.outlines[i] for i in order],
        mass=assembly.mass[order],
        centroid=assembly.centroid[order],
        inertia=assembly.inertia[order],
        p=assembly.p[joints],
        q=assembly.q[joints],
        a=rank[a],
        b=rank[b],
        inward=inward,
        block_names=[assembly.block_names[i] for i in order],
        joint_names=[assembly.joint_names[j] for j in joints],
        chains={next(iter(assembly.chains)): list(range(count + 1))},
        materials=[assembly.materials[i] for i in order] if assembly.materials else [],
        groups={},
        fill=None if assembly.fill is None else assembly.fill[order],
    )


def _left(p: np.ndarray, q: np.ndarray) -> np.ndarray:
    """To the left of p -> q, as long as it."""
    return np.column_stack([p[:, 1] - q[:, 1], q[:, 0] - p[:, 0]])


def _on_ground(assembly: Assembly, joint: int) -> bool:
    return GROUND in (assembly.a[joint], assembly.b[joint])


def inner_stones(assembly: Assembly, joints: list[int]) -> set[int]:
    """Voussoirs of a chain: blocks between two of its joints."""
    ends = [set(assembly.ends[j]) for j in joints]
    return {b for one, two in itertools.pairwise(ends) for b in one & two} - {GROUND}


def is_stack(assembly: Assembly, joints: list[int]) -> bool:
    """True where the joints of a chain end at a stone that no other joint holds: no arch, but a stack."""
    return any(_end(assembly, joints, k) not in (GROUND, None) for k in (0, -1))


def springings(assembly: Assembly, joints: list[int]) -> tuple[int, int]:
    """Places in a chain of the joints at which its arch begins and ends: the beds of piers below are no part of the arch.

    An arch begins at its skewback; one that springs level, at the last bed. A bed is a joint that is inclined by less than
    half of what two neighbouring joints of the arch differ by.
    """
    along = assembly.q[joints] - assembly.p[joints]
    inclined = np.degrees(np.arctan2(np.abs(along[:, 1]), np.abs(along[:, 0])))
    steps = np.abs(np.diff(inclined))
    step = float(np.median(steps[steps > LEAST_STEP])) if (steps > LEAST_STEP).any() else 0.0
    turned = np.flatnonzero(inclined > 0.5 * step)
    if not len(turned) or step == 0.0:
        return 0, len(joints) - 1
    first, last = int(turned[0]), int(turned[-1])
    first -= first > 0 and _leans(assembly, joints[first - 1], joints[first], 0.25 * step)
    last += last < len(joints) - 1 and _leans(assembly, joints[last + 1], joints[last], 0.25 * step)
    return first, last


def carried_on(assembly: Assembly, joints: list[int]) -> tuple[Assembly, list[int]]:
    """A chain beyond its ends, through voussoirs that backing or spandrels touch, and the assembly with their joints turned so
    that p lies on the intrados.

    From joint to joint the direction of an arch turns one way by much the same angle. The next joint of a voussoir is of
    like length, turns on by TURN times the median of the chain, and its middle lies within LIKE times the greatest distance
    of the chain; of several the one whose turn is nearest to the median. A stone that is LIKE times as heavy as the heaviest
    voussoir ends the arch.
    """
    p, q = assembly.p.copy(), assembly.q.copy()
    whole, seen = list(joints), inner_stones(assembly, joints)

    def turn(one: int, two: int) -> float:
        """Angle [rad] from the direction of one joint to that of another, between -pi/2 and pi/2: of undirected lines."""
        (ax, ay), (bx, by) = q[one] - p[one], q[two] - p[two]
        return float(np.arctan((ax * by - ay * bx) / (ax * bx + ay * by or 1e-300)))

    step = float(np.median([turn(one, two) for one, two in itertools.pairwise(joints)]))
    middle = assembly.middle
    heavy = LIKE * float(assembly.mass[sorted(seen)].max(initial=0.0))
    far = LIKE * float(np.hypot(*np.diff(middle[joints], axis=0).T).max())
    for at, way in ((0, -step), (-1, step)):
        while way != 0.0:
            last = whole[at]
            block = next((b for b in assembly.ends[last] if b != GROUND and b not in seen and assembly.mass[b] < heavy), None)
            like = [
                (abs(turn(last, j) / way - 1.0), j)
                for j in (() if block is None else assembly.bounds[block])
                if j not in whole
                and 1.0 / LIKE < assembly.length[j] / assembly.length[last] < LIKE
                and np.hypot(*(middle[j] - middle[last])) < far
                and TURN[0] < turn(last, j) / way < TURN[1]
            ]
            if block is None or not like:
                break
            _, j = min(like)
            if (q[j] - p[j]) @ (q[last] - p[last]) < 0.0:
                p[j], q[j] = q[j].copy(), p[j].copy()
            seen.add(block)
            whole = [j, *whole] if at == 0 else [*whole, j]
    return replace(assembly, p=p, q=q), whole


def _leans(assembly: Assembly, low: int, high: int, least: float) -> bool:
    """Whether the intrados between two joints leans by more than some degrees: upright, it is the face of a skewback."""
    along = np.abs(assembly.p[high] - assembly.p[low])
    long = np.hypot(*along) > 0.1 * min(assembly.length[[low, high]])
    return bool(long and np.degrees(np.arctan2(along[0], along[1])) > least)


def arch_of(assembly: Assembly, joints: list[int]) -> list[int]:
    """The joints of a chain from springing to springing; empty where the chain stands upright or is a stack."""
    if is_stack(assembly, joints):
        return []
    first, last = springings(assembly, joints)
    arch = joints[first : last + 1]
    (x0, y0), (x1, y1) = assembly.middle[[arch[0], arch[-1]]].tolist()
    clear = abs(assembly.p[arch[-1], 0] - assembly.p[arch[0], 0])
    upright = abs(x1 - x0) < 0.5 * abs(y1 - y0) or clear < 1e-3 * float(assembly.length[arch].max())
    return [] if len(arch) < 3 or upright else arch


def _end(assembly: Assembly, joints: list[int], k: int) -> int | None:
    """The stone with no other joint beyond the first or last joint of a row; None where it has others."""
    for block in assembly.ends[joints[k]]:
        if block != GROUND and len(assembly.bounds[block]) == 1:
            return block
    return None


def _rows(assembly: Assembly) -> list[list[int]]:
    """Joints of every longest row of stones with at most two joints each."""
    pairs, touching = assembly.ends, assembly.bounds
    plain = [1 <= len(joints) <= 2 for joints in touching]
    left, rows = set(np.flatnonzero(plain).tolist()), []

    def walk(block: int, joint: int) -> list[int]:
        """Joints from `joint` of a stone on, away from that stone."""
        way = [joint]
        while True:
            a, b = pairs[joint]
            block = b if a == block else a
            if block == GROUND or not plain[block] or block not in left:
                return way
            left.discard(block)
            onward = [j for j in touching[block] if j != joint]
            if not onward:
                return way
            joint = onward[0]
            way.append(joint)

    while left:
        block = min(left)
        left.discard(block)
        ways = [walk(block, joint) for joint in touching[block]]
        rows.append([*reversed(ways[0]), *(ways[1] if len(ways) > 1 else [])])
    return rows


def _turned(assembly: Assembly, spans: list[list[int]]) -> Assembly:
    """The joints of arches with their ends in order: to the right on the way from left to right lies the intrados."""
    p, q = assembly.p.copy(), assembly.q.copy()
    inward = np.ones(len(p)) if assembly.inward is None else np.array(assembly.inward, dtype=float)
    normal = assembly.normal
    for joints in spans:
        for i, j in enumerate(joints):
            # The stone after the joint, on the way: shared with the next joint, or not with the one before.
            other = joints[i + 1] if i + 1 < len(joints) else joints[i - 1]
            beside = {int(assembly.a[other]), int(assembly.b[other])} - {GROUND}
            a_is_next = (int(assembly.a[j]) in beside) == (i + 1 < len(joints))
            onward = normal[j] if a_is_next else -normal[j]
            along = q[j] - p[j]
            if onward[0] * along[1] - onward[1] * along[0] < 0.0:  # q lies to the right of the way
                p[j], q[j] = assembly.q[j], assembly.p[j]
                inward[j] = -inward[j]
    return replace(assembly, p=p, q=q, inward=None if assembly.inward is None else inward.astype(int))
