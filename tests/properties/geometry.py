"""Geometry by two ways: polygons, contacts, bodies and barrels against sums, counts and closed forms of their own."""

import itertools
import math
from typing import Any

import numpy as np
from asking import Deck, must, near
from buildings import arches, changed, decks, number
from conservation import building, moments
from fields import leaning, reordered
from hypothesis import reject
from hypothesis import strategies as st
from relations import relation

from extrados.model.geometry import convex, polygons
from extrados.model.geometry.chains import in_order
from extrados.model.geometry.contacts import find_contacts, nearest
from extrados.model.geometry.solids import contacts as solid_contacts
from extrados.model.geometry.solids.polyhedra import prism
from extrados.model.geometry.solids.sections import barrel, drawn_out
from extrados.views.rigid import rigid_bodies


@st.composite
def stars(draw: st.DrawFn) -> np.ndarray:
    """Simple polygons, counter-clockwise, mostly concave, about a place off the origin."""
    radii = draw(st.lists(number(0.4, 2.0), min_size=4, max_size=9))
    angle = 2.0 * math.pi * (np.arange(len(radii)) + 0.3) / len(radii)
    return np.column_stack([np.cos(angle), np.sin(angle)]) * np.array(radii)[:, None] + [draw(number(-5, 5)), draw(number(-5, 5))]


def area_of(outline: np.ndarray) -> float:
    """Area of a polygon, 0 where it has no corners."""
    return moments(outline)[0] if len(outline) > 2 else 0.0


def winding(outline: np.ndarray, place: np.ndarray) -> float:
    """How often an outline turns about a place."""
    away = outline - place
    turn = np.angle((np.roll(away, -1, axis=0) @ [1, 1j]) / (away @ [1, 1j]))
    return float(turn.sum() / (2.0 * math.pi))


def beside(outline: np.ndarray, place: np.ndarray) -> float:
    """Distance of a place from an outline."""
    edge = np.roll(outline, -1, axis=0) - outline
    share = ((place - outline) * edge).sum(axis=1) / (edge**2).sum(axis=1)
    nearest = outline + np.clip(share, 0.0, 1.0)[:, None] * edge
    return float(np.hypot(*(nearest - place).T).min())


@relation("", st.tuples(stars(), number(0.05, 0.95), number(0.0, 360.0), number(-2.5, 2.5), number(-2.5, 2.5)), 1e-9, share=5.0)
def polygons_by_two_ways(star: np.ndarray, share: float, angle: float, dx: float, dy: float, within: float) -> None:
    """Areas, centroids, cuts, levels, distances and inner points of random polygons agree by two methods."""
    area, centre, second = moments(star)
    found = polygons.properties(star)
    near("area", found[0], area, within)
    near("centre", found[1], centre, within, 1.0)
    near("inertia", found[2], second, 1e-7)
    near("turned around", polygons.signed_area(star[::-1]), -area, within)
    normal = np.array([math.cos(math.radians(angle)), math.sin(math.radians(angle))])
    s = star @ normal
    on = normal * (s.min() + share * np.ptp(s))
    sides = [polygons.cut(star, on, sense * normal) for sense in (1.0, -1.0)]
    near("both sides of a cut", sum(map(area_of, sides)), area, within)
    for side, sense in zip(sides, (1.0, -1.0), strict=True):
        must(bool(((side - on) @ (sense * normal) > -1e-9).all()), "a part beyond the cut")
    y = star[:, 1].min() + share * np.ptp(star[:, 1])
    x = polygons.crossings(star, y)
    must(len(x) % 2 == 0 and bool(np.all(np.diff(x) >= 0.0)), f"crossings {x}")
    near("chords", sum(x[1::2] - x[::2]), _chord(star, y), 1e-6, 1.0)
    near("reach", polygons.reach(star, np.array([y]))[0], [x[0], x[-1]], within, 1.0)
    must(bool(np.isinf(polygons.reach(star, np.array([star[:, 1].max() + 1.0]))).all()), "a reach above all")
    under = polygons.cut(star, np.array([0.0, y]), np.array([0.0, -1.0]))
    a, c, _ = moments(under)
    near("below a level", polygons.below(star, np.array([y]))[0], [a, a * c[0], a * c[1]], 1e-7, 1.0)
    place = star.mean(axis=0) + np.array([dx, dy])
    must(bool(polygons.inside(star, place[None])[0]) == (abs(winding(star, place)) > 0.5), f"{place} within or not")
    near("distance", polygons.distance(star, place[None])[0], beside(star, place), 5e-3, 0.2)
    must(polygons.crossing_edges(star) is None, "a star crosses itself")
    parts = convex.convex_parts(star)
    near("convex parts", sum(area_of(p) for p, _ in parts), area, within)
    must(all(convex.is_convex(p) for p, _ in parts) and convex.is_convex(star) == (len(parts) == 1), f"{len(parts)} parts")
    length = sum(np.hypot(*(np.roll(p, -1, axis=0) - p)[mask].T).sum() for p, mask in parts)
    near("outer edges", length, np.hypot(*(np.roll(star, -1, axis=0) - star).T).sum(), within)
    wrap = convex.hull(star)
    must(
        convex.is_convex(wrap) and all(abs(winding(wrap, p)) > 0.5 or beside(wrap, p) < 1e-6 for p in star), "a hull that does not hold it"
    )
    must({tuple(p) for p in wrap} <= {tuple(p) for p in star}, "corners of a hull")
    swapped = wrap[[1, 0, *range(2, len(wrap))]]
    if len(wrap) > 3:
        pair = polygons.crossing_edges(swapped)
        must(pair is not None and _meet(swapped, *pair), f"edges {pair} of {swapped} do not cross")
    worn = convex.rounded(wrap, 0.01)
    must(0.0 < area_of(wrap) - area_of(worn) < 0.05 and bool(np.all([beside(wrap, p) < 0.1 for p in worn])), "worn corners")


def _chord(star: np.ndarray, y: float) -> float:
    """Length of a level within a polygon: the rate of the area below it."""
    h = 1e-7
    low, high = (area_of(polygons.cut(star, np.array([0.0, y + s * h]), np.array([0.0, -1.0]))) for s in (-1.0, 1.0))
    return (high - low) / (2.0 * h)


def _meet(outline: np.ndarray, i: int, j: int) -> bool:
    """Whether two edges of an outline cross, by solving for the place."""
    a, b = outline[i], outline[j]
    u, v = (np.roll(outline, -1, axis=0)[k] - outline[k] for k in (i, j))
    s, t = np.linalg.solve(np.column_stack([u, -v]), b - a)
    return 0.0 < s < 1.0 and 0.0 < t < 1.0


@relation("", st.tuples(stars(), stars(), number(0.0, 360.0), number(0.01, 0.3)), 1e-6, share=5.0)
def overlaps_by_moving_apart(one: np.ndarray, two: np.ndarray, angle: float, depth: float, within: float) -> None:
    """Two convex polygons laid against each other and pushed into each other by a depth overlap by it, and no more where moved back."""
    a, b = convex.hull(one), convex.hull(two)
    k = int(angle) % len(a)
    edge = np.roll(a, -1, axis=0)[k] - a[k]
    out = np.array([edge[1], -edge[0]]) / np.hypot(*edge)
    touching = b + (a[k] + 0.5 * edge) - b[int((b @ out).argmin())]  # its lowest corner on the middle of an edge
    depth = min(depth, 0.2 * float(np.hypot(*edge)), 0.2 * float(np.ptp(a @ out)))
    for shift, want in ((-depth, -depth), (0.3 * depth, None)):
        there = touching - shift * out
        found, way, middle = convex.overlap(a, there)
        other, back, _ = convex.overlap(there, a)
        near("either way", found, other, within, 0.1)
        near("directions", way, -back, within, 1.0)
        near("depth", convex.overlap_depth(a, there), found, within, 0.1)
        if want is not None:
            must(found <= within and found >= want - within, f"{found} of {want} apart")
            continue
        must(0.0 < found <= shift * (1.0 + within), f"{found} deep of {shift}")
        near("moved apart", convex.overlap_depth(a, there + found * way), 0.0, within, 1.0)
        near(
            "midway",
            (middle - a[k]) @ out if abs(way @ out) > 1.0 - 1e-9 else 0.0,
            -0.5 * shift if abs(way @ out) > 1.0 - 1e-9 else 0.0,
            1e-4,
            1.0,
        )
        places = convex.crossings(a, there, 1e-9)
        must(len(places) in (2, 4) and all(beside(p, q) < 5e-3 for p in (a, there) for q in places), f"crossings {places}")


@st.composite
def courses(draw: st.DrawFn) -> tuple[list[np.ndarray], dict[tuple[int, int], tuple]]:
    """Outlines of a wall of courses whose head joints stand anywhere, and by hand their contacts: pair -> ends."""
    width, level = 3.0, 0.0
    rows: list[list[tuple[float, float, float, float, int]]] = []
    for height in draw(st.lists(number(0.2, 0.6), min_size=2, max_size=4)):
        cuts = draw(st.lists(st.integers(2, 28), max_size=3, unique=True))
        xs = [0.0, *(width * k / 30.0 for k in sorted(cuts)), width]
        first = sum(map(len, rows))
        rows.append([(a, b, level, level + height, first + k) for k, (a, b) in enumerate(itertools.pairwise(xs))])
        level += height
    blocks = [one for row in rows for one in row]
    outlines = [np.array([[a, low], [b, low], [b, high], [a, high]]) for a, b, low, high, _ in blocks]
    joints: dict[tuple[int, int], tuple] = {}
    for row in rows:
        joints |= {(one[4], two[4]): ((two[0], two[2]), (two[0], two[3])) for one, two in itertools.pairwise(row)}
    for lower, upper in itertools.pairwise(rows):
        for one, two in itertools.product(lower, upper):
            left, right = max(one[0], two[0]), min(one[1], two[1])
            if right - left > 0.02:
                joints[one[4], two[4]] = ((left, two[2]), (right, two[2]))
            elif right - left > 1e-6:
                reject()  # a point or a joint, as the tolerance has it
    joints |= {(one[4], -1): ((one[0], 0.0), (one[1], 0.0)) for one in rows[0]}
    return outlines, joints


@relation(
    "",
    st.tuples(courses(), number(0.0, 360.0), number(-40.0, 40.0), st.sampled_from([0.0, 4e-4, -4e-4, 3e-3, -3e-3, 0.02])),
    1e-9,
    share=5.0,
)
def contacts_by_hand(wall: tuple, angle: float, shift: float, gap: float, within: float) -> None:
    """The joints of a wall are those of its courses, in any position and rotation; a course with a gap or an overlap is reported with its size."""
    outlines, joints = wall
    c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
    turn = np.array([[c, s], [-s, c]])
    level = outlines[-1][0, 1]
    there = [o + np.array([0.0, gap if o[0, 1] >= level - 1e-9 else 0.0]) for o in outlines]
    ground = np.array([[-1.0, 0.0, 4.0, 0.0]])

    def place(points: np.ndarray) -> np.ndarray:
        return points @ turn + [shift, 0.5 * shift]

    tolerance = 1e-3
    found = find_contacts([place(o) for o in there], np.column_stack([place(ground[:, :2]), place(ground[:, 2:])]), tolerance)
    across = {pair for pair, ends in joints.items() if abs(ends[0][1] - level) < 1e-9 and abs(ends[1][1] - level) < 1e-9 and gap}
    want = {pair: ends for pair, ends in joints.items() if pair not in across or abs(gap) < tolerance}
    got = {(int(a), int(b)): (p, q) for a, b, p, q in zip(found.a, found.b, found.p, found.q, strict=True)}
    must(set(got) == set(want), f"joints {sorted(set(got) ^ set(want))} of a gap of {gap}")
    for pair, ends in want.items():
        raised = np.array([0.0, 0.5 * gap if pair in across else gap if ends[0][1] >= level - 1e-9 else 0.0])
        corners = place(np.array(ends) + raised)
        p, q = got[pair]
        ends_ = sorted((tuple(p), tuple(q)))
        near(f"joint {pair}", ends_, sorted(map(tuple, corners)), 1e-6, 1.0)
        inner = place(there[pair[0]].mean(axis=0)[None])[0] - p
        must((q - p)[0] * inner[1] - (q - p)[1] * inner[0] > 0.0, f"block a of joint {pair} lies to the right")
    flaws = {(f.kind, min(f.first, f.second), max(f.first, f.second)): f for f in found.flaws}
    if gap > 0.015:
        must(not flaws, f"told: {list(flaws)}")
    for pair in across if abs(gap) < 0.01 else ():
        kind = "gap" if gap > 0.0 else "overlap"
        flaw = flaws.pop((kind, min(pair), max(pair)), None)
        must(flaw is not None, f"{kind} of {gap} between {pair} is not told: {[f for f in found.flaws]}")
        near("depth", flaw.depth, abs(gap), 1e-5)
        if kind == "gap":
            near("length", flaw.length, math.dist(*joints[pair]), 1e-6)
    must(not [k for k in flaws if k[0] == "gap" or gap >= 0.0], f"more flaws: {list(flaws)}")
    depths = [f.depth for f in found.flaws]
    must(depths == sorted(depths, reverse=True), "the deepest flaw is not the first")
    alone = [place(o) for o in (*outlines[:1], outlines[0] + [8.0, 0.0])]
    next_ = nearest(alone, np.zeros((0, 4)), 1)
    must(next_ is not None and (next_.first, next_.second) == (0, 1), f"nearest {next_}")
    near("nearest", next_.depth, 8.0 - float(np.ptp(outlines[0][:, 0])), 1e-9)


@relation(
    "",
    st.tuples(
        st.one_of(arches().map(lambda s: {"structure": s}), decks("pointed-arch", "elliptical-arch")),
        st.randoms(use_true_random=False),
        st.sampled_from([0.05, -0.08]),
    ),
    1e-7,
    share=2.0,
)
def chains_run_from_left_to_right(deck: Deck, rng: Any, lean: float, within: float) -> None:
    """An arch of blocks in any order is one chain from left to right, intrados first; in order its stones follow each other."""
    a = building(reordered(leaning(deck, lean), rng)).blocks()
    must(len(a.chains) == 1, f"chains {list(a.chains)}")
    joints = next(iter(a.chains.values()))
    must(a.middle[joints[0], 0] < a.middle[joints[-1], 0], "a chain from right to left")
    row = [({int(a.a[i]), int(a.b[i])} & {int(a.a[j]), int(a.b[j])}) - {-1} for i, j in itertools.pairwise(joints)]
    must(all(len(shared) == 1 for shared in row) and len(set.union(*row)) == len(a.mass), f"stones in the order {row}")
    row = [shared.pop() for shared in row]
    middle = np.array([a.middle[[joints[0], joints[-1]], 0].mean(), a.middle[joints, 1].min() - 0.1])
    must(bool(np.all(np.hypot(*(a.p[joints] - middle).T) < np.hypot(*(a.q[joints] - middle).T))), "an extrados within the intrados")
    inner = np.where(a.a >= 0, a.a, a.b)
    side = ((a.centroid[inner] - a.middle) * a.normal).sum(axis=1)
    must(bool(np.all(np.where(a.a >= 0, side, -side) > 0.0)), "normals that leave block a")
    b = in_order(a)
    must(list(b.a) == [*range(len(b.mass)), -1] and list(b.b) == [-1, *range(len(b.mass))], f"{b.a} {b.b}")
    near("centres", b.centroid, a.centroid[row], within)
    near("masses", b.mass, a.mass[row], within)
    side = ((b.centroid[: len(b.mass)] - b.middle[:-1]) * b.normal[:-1]).sum(axis=1)
    must(bool(np.all(side > 0.0)), "normals that do not point to the right")


@relation(
    "dem",
    st.tuples(
        decks("arch", "column", "brickwork", "frame", "blocks", "stack"),
        st.sampled_from([0.0, 0.05]),
        st.integers(0, 3),
        st.sampled_from([None, -0.5, 0.0]),
        st.sampled_from([0.0, 0.01]),
    ),
    1e-7,
    share=2.0,
)
def bodies_hold_what_their_blocks_do(deck: Deck, lean: float, glue: int, floor: float | None, worn: float, within: float) -> None:
    """Rigid bodies have the areas, masses, centres and inertias of their blocks, supports under their joints, and a whole floor."""
    a = building(leaning(deck, lean)).blocks()
    pairs = [(int(i), int(j)) for i, j in zip(a.a, a.b, strict=True) if min(i, j) >= 0]
    groups = [list(pairs[0])] if glue and pairs else []
    bodies = rigid_bodies(a, groups, worn, floor)
    must(bodies.moved <= 1e-9 and bodies.cut <= 1e-6 * a.size, f"moved {bodies.moved}, cut {bodies.cut}")
    must(bodies.count == len(a.mass) - len(groups), f"{bodies.count} bodies")
    for k in range(bodies.count):
        blocks = np.flatnonzero(bodies.body_of_block == k)
        mass = a.mass[blocks].sum()
        centre = a.mass[blocks] @ a.centroid[blocks] / mass
        near("mass", bodies.mass[k], mass, within)
        near("centre", bodies.centroid[k], centre, within, a.size)
        arms = ((a.centroid[blocks] - centre) ** 2).sum(axis=1)
        near("inertia", bodies.inertia[k], a.inertia[blocks].sum() + a.mass[blocks] @ arms, within)
        own = [p for p, o in zip(bodies.parts, bodies.owner, strict=True) if o == k]
        area = sum(area_of(p) for p in own)
        near(
            "area",
            area,
            sum(area_of(a.outlines[i]) for i in blocks),
            0.16 if "arch" in deck["structure"]["kind"] else 0.03 if worn else 1e-6,
        )
        must(all(convex.is_convex(p) for p in own), "a part that is not convex")
    for j, pair in enumerate(bodies.joints):
        one, two = (int(bodies.body_of_block[i]) if i >= 0 else -1 for i in (a.a[j], a.b[j]))
        must((pair is None) == (one == two), f"joint {j} between bodies {one} and {two}: {pair}")
        if pair is None:
            continue
        must(
            all(got == want or (want < 0 and got >= bodies.count) for got, want in zip(pair, (one, two), strict=True)),
            f"{pair} of {one}, {two}",
        )
        for got, want in zip(pair, (one, two), strict=True):
            if want < 0:  # the footing has the joint on its edge, reaches beyond it, and lies below
                (foot,) = (p for p, o in zip(bodies.parts, bodies.owner, strict=True) if o == got)
                must(all(beside(foot, end) < 2e-3 * a.size for end in (a.p[j], a.q[j])), f"joint {j} off its footing")
                inner = a.centroid[a.a[j] if a.a[j] >= 0 else a.b[j]]
                below, above = ((one - a.middle[j]) @ a.normal[j] for one in (foot.mean(axis=0), inner))
                must(below * above < 0.0, "a footing above its joint")
                low, high = np.sort(foot @ a.tangent[j])[[0, -1]]
                ends = np.sort([a.p[j] @ a.tangent[j], a.q[j] @ a.tangent[j]])
                must(low <= ends[0] + 1e-6 * a.size and high >= ends[1] - 1e-6 * a.size, "a footing narrower than its joint")
                near("masses of supports", bodies.mass[got], 0.0, 0.0)
    if floor is not None:
        supports = [p for p, o in zip(bodies.parts, bodies.owner, strict=True) if o >= bodies.count]
        pieces = sorted((p for p in supports if abs(p[:, 1].max() - floor) < 1e-9), key=lambda p: p[:, 0].min())
        must(bool(pieces), f"no floor at {floor}")
        gaps = [q[:, 0].min() - p[:, 0].max() for p, q in itertools.pairwise(pieces)]
        must(all(abs(gap) < 1e-9 for gap in gaps), f"gaps of the floor {gaps}")
        must(pieces[0][:, 0].min() < a.p[:, 0].min() - a.size and pieces[-1][:, 0].max() > a.p[:, 0].max() + a.size, "a narrow floor")
        for k in range(len(a.a)):  # no seam under a block that stands on it
            if min(a.a[k], a.b[k]) < 0 and abs(a.p[k, 1] - floor) + abs(a.q[k, 1] - floor) < 1e-9:
                low, high = sorted((a.p[k, 0], a.q[k, 0]))
                must(any(p[:, 0].min() <= low + 1e-9 and p[:, 0].max() >= high - 1e-9 for p in pieces), f"a seam under joint {k}")
    glued = [(p, m) for p, m, o in zip(bodies.parts, bodies.outer, bodies.owner, strict=True) if o < bodies.count]
    if groups and not worn:
        j = next(j for j, pair in enumerate(zip(a.a, a.b, strict=True)) if set(map(int, pair)) == set(groups[0]))
        inner = [np.hypot(*(np.roll(p, -1, axis=0) - p)[~m].T).sum() for p, m in glued]
        must(sum(inner) > 1.9 * a.length[j], f"glued faces of {sum(inner)} m, joint {a.length[j]} m")
    elif not worn:
        single = {o for o in bodies.owner if bodies.owner.count(o) == 1}
        must(
            all(m.all() for (_, m), o in zip(glued, bodies.owner, strict=False) if o in single), "an outer edge that counts as an inner one"
        )


@relation(
    "tilt",
    st.tuples(decks("arch", "block", "column", "brickwork"), number(0.5, 3.0), st.integers(1, 4), number(-30.0, 30.0, 6)),
    1e-6,
    share=2.0,
)
def solids_of_a_section(deck: Deck, depth: float, count: int, skew: float, within: float) -> None:
    """A section drawn out, and divided across and sheared, keeps volume, mass, centres, and areas of joints."""
    a = building(changed(deck, structure={"depth": depth})).blocks()
    plain = deck["structure"]["kind"] == "arch"
    for whole, sheared, stones in ((drawn_out(a), 0.0, 1), *(((barrel(a, count, math.radians(skew)), skew, count),) if plain else ())):
        tan = math.tan(math.radians(sheared))
        near("mass", whole.mass.sum(), a.mass.sum(), within)
        near(
            "volume",
            sum(float(np.linalg.det(p.vertices[p.triangles] - p.vertices[0]).sum()) / 6.0 for p in whole.parts),
            sum(area_of(o) for o in a.outlines) * depth,
            within,
        )
        near("centre", whole.mass @ whole.centroid / whole.mass.sum(), _drawn(a.mass @ a.centroid / a.mass.sum(), tan), within, 1.0)
        area: dict[tuple, float] = {}
        for k in range(len(whole.a)):
            points, n = whole.polygon[k], whole.normal[k]
            newell = 0.5 * sum(np.cross(u, v) for u, v in itertools.pairwise([*(points - points[0]), points[0] * 0.0]))
            must(newell @ n > 0.99 * np.linalg.norm(newell), "corners the other way round about the normal")
            one = whole.centroid[whole.a[k]] if whole.a[k] >= 0 else None
            two = whole.centroid[whole.b[k]] if whole.b[k] >= 0 else None
            middle = points.mean(axis=0)
            must(
                (one is None or (one - middle) @ n > -1e-9) and (two is None or (middle - two) @ n > -1e-9), "a normal that leaves block a"
            )
            area[k] = float(np.linalg.norm(newell))
        if not sheared and stones == 1:
            near("joints", sum(area.values()), a.length.sum() * depth, within)
        y = np.concatenate([p.vertices[:, 1] - tan * p.vertices[:, 0] for p in whole.parts])
        near("across", [y.min(), y.max()], [-0.5 * depth, 0.5 * depth], within, 1.0)
        if plain:
            across = [sum(v for k, v in area.items() if abs(whole.normal[k] @ [0.0, 1.0, 0.0]) < 0.9 - abs(tan))]
            if not sheared:
                near("bed joints", across[0], a.length.sum() * depth, within)
                heads = sum(v for k, v in area.items() if abs(whole.normal[k, 1]) > 0.9)
                faces = sum(area_of(o) for o in a.outlines)
                must(heads == 0.0 if stones == 1 else heads > 0.5 * faces, f"head joints of {heads} m^2 in {stones} stones")
        trace = np.trace(whole.inertia, axis1=1, axis2=2)
        must(bool((trace > 0.0).all()), "inertia below zero")


def _drawn(xz: np.ndarray, tan: float) -> np.ndarray:
    return np.array([xz[0], tan * xz[0], xz[1]])


BOX = st.tuples(number(0.3, 2.0), number(0.3, 2.0), number(0.3, 2.0))


@relation(
    "tilt",
    st.tuples(
        BOX,
        BOX,
        number(-0.9, 0.9),
        number(-0.9, 0.9),
        st.sampled_from([0.0, 4e-4, -4e-4, 5e-3, -5e-3, 0.3]),
        number(0.0, 360.0),
        number(0.0, 180.0),
    ),
    1e-6,
    share=5.0,
)
def boxes_that_touch(one: tuple, two: tuple, x: float, y: float, gap: float, angle: float, tip: float, within: float) -> None:
    """Two boxes, one on the other, in any rotation share the rectangle that their faces have in common; gaps and overlaps have their size."""
    shift = np.array([0.5 * x * (one[0] + two[0]), 0.5 * y * (one[1] + two[1]), one[2] + gap])
    first = prism(_rectangle(*one[:2]), 0.0, one[2])
    second = prism(_rectangle(*two[:2]) + shift[:2], shift[2], shift[2] + two[2])
    c, s = math.cos(math.radians(angle)), math.sin(math.radians(angle))
    u, v = math.cos(math.radians(tip)), math.sin(math.radians(tip))
    turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]) @ np.array([[1.0, 0.0, 0.0], [0.0, u, -v], [0.0, v, u]])
    tolerance, near_ = 1e-3, 1e-2
    sides = [min(o / 2, m + t / 2) - max(-o / 2, m - t / 2) for o, t, m in zip(one, two, shift[:2], strict=False)]
    found = solid_contacts.touching([first.moved(turn), second.moved(turn)], np.array([0, 1]), tolerance, near_)
    if min(sides) < 0.05 and min(sides) > -0.05:
        reject()
    meet = min(sides) > 0.0
    must(len(found.polygon) == (meet and abs(gap) < tolerance), f"{len(found.polygon)} contacts of a gap of {gap}, {sides}")
    for points, normal, a in zip(found.polygon, found.normal, found.a, strict=True):
        newell = 0.5 * sum(np.cross(p, q) for p, q in itertools.pairwise([*(points - points[0]), points[0] * 0.0]))
        near("area", newell @ normal, sides[0] * sides[1], 1e-6)
        near("normal", (1.0 if a == 0 else -1.0) * normal, turn @ [0.0, 0.0, -1.0], within, 1.0)
        middle = [0.5 * (max(-o / 2, m - t / 2) + min(o / 2, m + t / 2)) for o, t, m in zip(one, two, shift[:2], strict=False)]
        near("middle", points.mean(axis=0), turn @ [*middle, one[2] + 0.5 * gap], 1e-6, 1.0)
    must(bool(found.overlaps) == (meet and gap < -tolerance), f"overlaps {found.overlaps}")
    must(bool(found.gaps) == (meet and tolerance < gap < near_), f"gaps {found.gaps}")
    for _, _, told in (*found.gaps, *found.overlaps):
        near("told", told, abs(gap), 1e-4)


def _rectangle(width: float, depth: float) -> np.ndarray:
    return np.array([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5]]) * [width, depth]
