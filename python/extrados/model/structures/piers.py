"""A wall with openings as macro-blocks: rigid piers between the openings, rigid spandrels over them, a base under them."""

import itertools
from collections.abc import Sequence

from extrados.model.errors import BadGeometry
from extrados.model.geometry.assembly import GROUND, Assembly
from extrados.model.geometry.boxes import Box, contacts, openings_within, outline
from extrados.model.structures.masonry import stones_and_joints


def make_piers(length: float, height: float, openings: Sequence[Box], density: float, depth: float) -> Assembly:
    """The macro-blocks of a wall of length x height [m], its lower left corner at the origin; joints are level.

    Sills and heads of all openings cut the wall; what stands between the same two jambs through several of these bands
    is one body. Bodies as long as the wall are the base, where they stand on the ground, or spandrels; all others are
    piers, numbered from below and from left to right. Lintels are part of the body they lie in. BadGeometry where the
    openings leave nothing that stands.
    """
    holes = openings_within(length, height, openings, length)
    bodies: list[Box] = []
    growing: dict[tuple[float, float], float] = {}
    for low, high in itertools.pairwise(sorted({0.0, height, *(y for hole in holes for y in hole[2:])})):
        solid, start = [], 0.0
        for left, right, _, _ in sorted(h for h in holes if h[2] <= low and h[3] >= high):
            if left > start:
                solid.append((start, left))
            start = max(start, right)
        if start < length:
            solid.append((start, length))
        bodies += [(*ends, foot, low) for ends, foot in growing.items() if ends not in solid]
        growing = {ends: growing.get(ends, low) for ends in solid}
    bodies += [(*ends, foot, height) for ends, foot in growing.items()]
    bodies.sort(key=lambda body: (body[2], body[0]))
    names, count = [], dict.fromkeys(("pier", "spandrel", "base"), 0)
    for left, right, low, high in bodies:
        whole = right - left == length and high - low < height
        what = "pier" if not whole else "base" if low == 0.0 else "spandrel"
        count[what] += 1
        names.append("base" if what == "base" else f"{what} {count[what]}")
    joints = [
        (f"base of {names[i]}" if k == GROUND else f"{names[i]} on {names[k]}", p, q, i, k) for i, k, p, q in contacts(bodies, length)
    ]
    if all(b != GROUND for *_, b in joints):
        raise BadGeometry(
            "at ground level the openings occupy the full width, so no masonry remains there. Make the openings narrower, or raise them"
        )
    return stones_and_joints([outline(body) for body in bodies], names, joints, density, depth)
