"""The one model of solid blocks and the polygons along which they touch, for limit analysis and dynamics in space."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from extrados.model.errors import BadGeometry
from extrados.model.geometry.mortar import closed, told
from extrados.model.geometry.snapping import snapped
from extrados.model.geometry.solids.contacts import GROUND, Touching, slant, touching
from extrados.model.geometry.solids.polyhedra import Polyhedron, inertia_of, moments

MOST_SOLIDS = 20000
ROUNDING = 1e-9  # of the size: corners that would move by less stay
EXACT = 1e-6  # of the size of a structure made by rule: faces nearer than this touch
#: Gaps wider than so many tolerances, and than 10 mm and two tolerances, are no slips of drawing
NEARLY, WIDE = 20.0, 0.01
LEVEL = 0.5  # cosine of the slope up to which one stone is said to lie on another
MOST_TOLD = 6  # faults of a kind that are told by name
#: Of the least thickness of a block: corners that deviate by that change a capacity by up to 1 % (measured on corners, barrels and
#: domes: at most 1.7 times the deviation over the thickness)
ONE_PERCENT = 1.0 / 170.0


@dataclass(frozen=True)
class Keys:
    """Dowels and other keys across contacts: where they stand (nk, 3) [m], the contact that each crosses, the shear that
    each bears [N], infinite where it is not to give way, and how far each reaches into the stone above [m], infinite where
    it never comes out."""

    point: np.ndarray
    joint: np.ndarray
    strength: np.ndarray
    reach: np.ndarray


@dataclass(frozen=True)
class SolidAssembly:
    """Rigid blocks, each a union of convex parts, that touch along convex polygons; x and y are level, z is up.

    parts: convex bodies, part i of block owner[i]; mass (nb) [kg]; centroid (nb, 3) [m]; inertia (nb, 3, 3) about the
    centroids [kg m^2]. Contact j has the corners polygon[j] (k, 3) [m], counter-clockwise about normal[j], the unit
    vector into block a[j]; b[j] is the block behind, GROUND for the ground. A pair of blocks may share several.
    keys: dowels across contacts. fill (nf, 5): block, mass [kg] and place x, y, z [m] of what rests on blocks and sways
    with them. deviation: how far corners of measured blocks were moved at most [m]; gaps of that size may be left. groups: name -> contacts that [[joints.types]] may call by one name. measures: derived lengths worth
    telling. remarks must be told beside every answer, notes once.
    """

    parts: list[Polyhedron]
    owner: np.ndarray
    mass: np.ndarray
    centroid: np.ndarray
    inertia: np.ndarray
    polygon: list[np.ndarray]
    normal: np.ndarray
    a: np.ndarray
    b: np.ndarray
    block_names: list[str]
    joint_names: list[str]
    keys: Keys | None = field(default=None, kw_only=True)
    fill: np.ndarray = field(default_factory=lambda: np.empty((0, 5)), kw_only=True)
    deviation: float = field(default=0.0, kw_only=True)
    groups: dict[str, list[int]] = field(default_factory=dict, kw_only=True)
    measures: dict[str, float] = field(default_factory=dict, kw_only=True)
    remarks: tuple[str, ...] = field(default=(), kw_only=True)
    notes: tuple[str, ...] = field(default=(), kw_only=True)

    def __repr__(self) -> str:
        return f"<SolidAssembly: {len(self.mass)} blocks, {len(self.a)} contacts>"

    @cached_property
    def size(self) -> float:
        """Greatest extent [m], the scale of lengths."""
        points = np.concatenate([part.vertices for part in self.parts])
        return float(np.ptp(points, axis=0).max())

    @cached_property
    def corner(self) -> np.ndarray:
        """The corners of all contacts (nv, 3) [m], contact by contact."""
        return np.concatenate([*self.polygon, np.empty((0, 3))])

    @cached_property
    def corner_joint(self) -> np.ndarray:
        """The contact of each corner (nv)."""
        return np.repeat(np.arange(len(self.polygon)), [len(p) for p in self.polygon])

    @cached_property
    def area(self) -> np.ndarray:
        """Area of each contact (nj) [m^2]."""
        found = np.empty(len(self.polygon))
        for j, (points, normal) in enumerate(zip(self.polygon, self.normal, strict=True)):
            arm = points - points[0]
            found[j] = 0.5 * float(np.cross(arm[:-1], arm[1:]).sum(axis=0) @ normal)
        return found

    @cached_property
    def share(self) -> np.ndarray:
        """Positive weights (nv) of the corners of each contact that have its centre of area as their mean."""
        return np.concatenate([np.empty(0), *map(_shares, self.polygon)])

    @cached_property
    def middle(self) -> np.ndarray:
        """Centre of area of each contact (nj, 3) [m]."""
        weighted = self.share[:, None] * self.corner
        return np.stack([np.bincount(self.corner_joint, weighted[:, k], len(self.a)) for k in range(3)], axis=1)

    @cached_property
    def tangents(self) -> tuple[np.ndarray, np.ndarray]:
        """Two unit vectors of the plane of each contact (nj, 3), which with the normal make a right-handed frame."""
        n = self.normal
        helper = np.eye(3)[np.abs(n).argmin(axis=1)]
        first = np.cross(helper, n)
        first /= np.linalg.norm(first, axis=1)[:, None]
        return first, np.cross(n, first)


def _shares(polygon: np.ndarray) -> np.ndarray:
    """Positive weights (k) of the corners of a convex polygon that have its centre of area as their mean."""
    count = len(polygon)
    mean = polygon.mean(axis=0)
    arm = polygon - mean
    area = np.linalg.norm(np.cross(arm, np.roll(arm, -1, axis=0)), axis=1)
    area /= area.sum()
    # each triangle of the mean and a side shares its area equally among its corners; that of the mean goes to all
    shares: np.ndarray = (area + np.roll(area, 1)) / 3.0 + 1.0 / (3.0 * count)
    return shares


@dataclass(frozen=True)
class Stone:
    """A block to be: its name, its convex parts, which may overlap nowhere, and its density [kg/m^3]; `ground`: a solid
    that is part of the ground."""

    name: str
    parts: Sequence[Polyhedron]
    density: float
    ground: bool = False


def mass_properties(parts: Sequence[Polyhedron], density: float) -> tuple[float, np.ndarray, np.ndarray]:
    """Mass [kg], centroid (3) [m] and inertia about it (3, 3) [kg m^2] of a union of convex parts."""
    volume, centre, second = zip(*(moments(p.vertices, p.triangles) for p in parts), strict=True)
    v, c = np.array(volume), np.array(centre)
    total, middle = float(v.sum()), (v[:, None] * c).sum(axis=0) / v.sum()
    about = np.sum(second, axis=0) + np.einsum("p,pi,pj->ij", v, c - middle, c - middle)
    return density * total, middle, density * inertia_of(about)


def assemble(
    stones: Sequence[Stone],
    tolerance: float | None = None,
    ground: Sequence[float] | None = None,
    what: str = "structure",
    seats: Sequence[tuple[int, np.ndarray]] = (),
) -> SolidAssembly:
    """Blocks on the ground with the contacts found among them.

    tolerance [m]: faces nearer than it touch, overlaps less deep are let pass, and what two faces share is a line or a point
    where it is narrower; None for a structure made by rule.
    ground: heights [m] at which every level sole that no stone bears stands on the ground; None for the lowest of all,
    unless some stones are the ground themselves, or there are seats. seats: faces that stand on the ground whichever way
    they look, as springings do: a block and corners (k, 3), counter-clockwise from within it. BadGeometry tells overlaps, and stones that touch nothing, in words.
    """
    if len(stones) > MOST_SOLIDS:
        raise BadGeometry(f"{what}: {len(stones)} solids exceed the limit of {MOST_SOLIDS}")
    blocks = [s for s in stones if not s.ground]
    if not blocks:
        raise BadGeometry(f"{what}: no block remains besides the ground")
    ordered = [*blocks, *(s for s in stones if s.ground)]
    parts = [part for stone in ordered for part in stone.parts]
    owner = np.repeat(np.arange(len(ordered)), [len(s.parts) for s in ordered])
    owner[owner >= len(blocks)] = len(blocks)  # solids of the ground do not meet each other
    ends = np.concatenate([p.vertices for p in parts])
    size = float(np.ptp(ends, axis=0).max())
    close = EXACT * size if tolerance is None else tolerance
    near = min(NEARLY * close, max(WIDE, 2.0 * close))
    drawn = found = touching(parts, owner, close, near)
    free = len(blocks) == len(stones) and not seats
    levels = ground if ground is not None else ([_lowest(parts, owner < len(blocks), close)] if free else [])
    notes: tuple[str, ...] = ()
    moved = 0.0
    if tolerance is not None and not found.overlaps:
        order = np.argsort(found.apart, kind="stable").tolist()
        on_ground = _soles(parts, owner, len(blocks), levels, close, found)
        places, moved = snapped(parts, [found.faces[j] for j in order], on_ground, close)
        if moved > ROUNDING * size:
            parts = [Polyhedron(vertices, part.faces) for vertices, part in zip(places, parts, strict=True)]
            found = touching(parts, owner, close, near)
            notes = (
                f"Corners were moved by up to {1e3 * moved:.3g} mm (`contact_tolerance` {1e3 * close:.3g} mm) onto the planes of their faces",
            )
    last = np.cumsum([len(s.parts) for s in blocks])
    mass, centroid, inertia = zip(
        *(mass_properties(parts[e - len(s.parts) : e], s.density) for s, e in zip(blocks, last, strict=True)), strict=True
    )
    polygon, normal = list(found.polygon), list(found.normal)
    a, b = np.array(found.a, dtype=int), np.array(found.b, dtype=int)
    b[b == len(blocks)] = GROUND  # the ground is the last owner: never block a
    for block, points in seats:
        polygon.append(points)
        across = np.cross(points[1] - points[0], points[2] - points[1])
        normal.append(across / np.linalg.norm(across))
        a = np.append(a, block)
    for (i, k), level in _soles(parts, owner, len(blocks), levels, close, found).items():
        points, up = _on_ground(parts[i], k, level)
        polygon.append(points)
        normal.append(up)
        a = np.append(a, owner[i])
    b = np.append(b, [GROUND] * (len(a) - len(b))).astype(int)
    names = [s.name for s in blocks]
    _refuse(names, found, a, b, close, what, exact=tolerance is None)
    made = SolidAssembly(
        parts=parts[: int((owner < len(blocks)).sum())],
        owner=owner[owner < len(blocks)],
        mass=np.array(mass),
        centroid=np.array(centroid),
        inertia=np.array(inertia),
        polygon=polygon,
        normal=np.array(normal).reshape(-1, 3),
        a=a,
        b=b,
        block_names=names,
        joint_names=joint_names(names, a, b, np.array(normal)),
        remarks=(*_nearly(names, found.gaps), *_narrow(names, found.slivers, close), *_rough(blocks, drawn)),
        notes=notes,
        deviation=moved,
    )
    return made


def with_closed_joints(stones: Sequence[Stone], mortar: float, tolerance: float) -> tuple[list[Stone], tuple[str, ...]]:
    """Stones whose faces across joints of mortar, up to that wide [m], meet in the middle of these, and a note on the joints. Gaps within
    the tolerance [m] stay."""
    parts = [part for stone in stones for part in stone.parts]
    owner = np.repeat(np.arange(len(stones)), [len(s.parts) for s in stones])
    met = touching(parts, owner, tolerance, mortar + tolerance, mortar + tolerance)
    gaps = np.array(met.apart)
    places = closed(parts, met.faces, gaps, mortar, tolerance)
    grown = [Polyhedron(vertices, part.faces) for vertices, part in zip(places, parts, strict=True)]
    volumes = [sum(moments(part.vertices, part.triangles)[0] for part in those) for those in (parts, grown)]
    made = [replace(stone, parts=[grown[k] for k in np.flatnonzero(owner == i)]) for i, stone in enumerate(stones)]
    return made, told(gaps[gaps > tolerance], mortar, volumes[1] / volumes[0])


def joint_names(names: Sequence[str], a: np.ndarray, b: np.ndarray, normal: np.ndarray) -> list[str]:
    """A name for each contact: which stone is on, or stands against, which; those that a pair has several of are numbered."""
    told = []
    for one, two, up in zip(a.tolist(), b.tolist(), normal[:, 2].tolist(), strict=True):
        if two == GROUND:
            told.append(f"{names[one]} on the ground")
        else:
            over, under = (one, two) if up > -EXACT else (two, one)  # rounding gives no name
            told.append(f"{names[over]} {'on' if abs(up) > LEVEL else 'against'} {names[under]}")
    several = {name for name, count in Counter(told).items() if count > 1}
    seen: Counter[str] = Counter()
    for k, name in enumerate(told):
        if name in several:
            seen[name] += 1
            told[k] = f"{name} ({seen[name]})"
    return told


def _level_faces(part: Polyhedron, close: float) -> list[int]:
    """Faces that look down and are as level as a tolerance leaves them."""
    turned = slant(np.hypot(part.normals[:, 0], part.normals[:, 1]), part.widths)
    return np.flatnonzero((part.normals[:, 2] < -LEVEL) & (turned <= close)).tolist()


def _lowest(parts: Sequence[Polyhedron], mobile: np.ndarray, close: float) -> float:
    """Height of the lowest soles [m], the mean of them by area; of the lowest corner where no sole is level."""
    low = min(float(part.vertices[:, 2].min()) for part in parts)
    soles = [
        (part.middles[k, 2] - low, part.areas[k])
        for part, on in zip(parts, mobile.tolist(), strict=True)
        if on
        for k in _level_faces(part, close)
        if part.middles[k, 2] - low <= close
    ]
    return low + float(np.average([h for h, _ in soles], weights=[area for _, area in soles])) if soles else low


def _soles(
    parts: Sequence[Polyhedron], owner: np.ndarray, count: int, levels: Sequence[float], close: float, met: Touching
) -> dict[tuple[int, int], float]:
    """Level faces that stand on the ground, as part and face, with its height [m]; not those that a stone bears."""
    found = {}
    borne: dict[int, list[np.ndarray]] = {}
    for points, *blocks in zip(met.polygon, met.a, met.b, strict=True):
        for block in blocks:
            borne.setdefault(block, []).append(points[:, 2])
    for i, (part, block) in enumerate(zip(parts, owner.tolist(), strict=True)):
        if block >= count or not len(levels):
            continue
        for k in _level_faces(part, close):
            level = min(levels, key=lambda z: abs(part.middles[k, 2] - z))
            if abs(part.middles[k, 2] - level) > close:
                continue
            if not any(np.abs(heights - level).max() <= close for heights in borne.get(block, [])):
                found[i, k] = float(level)
    return found


def _on_ground(part: Polyhedron, face: int, level: float) -> tuple[np.ndarray, np.ndarray]:
    """Corners of a sole (k, 3) in the plane midway between it and the ground, and the normal of that, which points up."""
    up = np.array([0.0, 0.0, 1.0]) - part.normals[face]
    up /= np.linalg.norm(up)
    points = part.vertices[list(part.faces[face])][::-1]
    middle = np.array([*part.middles[face, :2], 0.5 * (part.middles[face, 2] + level)])
    return points - ((points - middle) @ up)[:, None] * up, up


def _refuse(names: Sequence[str], met: Touching, a: np.ndarray, b: np.ndarray, close: float, what: str, *, exact: bool) -> None:
    """BadGeometry with all that is amiss."""
    wrong = []
    cure = "" if exact else " (contact_tolerance)"
    for one, two, depth in met.overlaps[:MOST_TOLD]:
        pair = names[one] if two >= len(names) else f"{names[one]} and {names[two]}"
        whom = f"{pair} and the ground" if two >= len(names) else pair
        wrong.append(f"{whom} overlap by {1e3 * depth:.3g} mm, which exceeds {1e3 * close:.3g} mm{cure}")
    if len(met.overlaps) > MOST_TOLD:
        wrong.append(f"and {len(met.overlaps) - MOST_TOLD} more pairs overlap")
    touched = set(a.tolist()) | set(b.tolist())
    lonely = [k for k in range(len(names)) if k not in touched]
    near = {k: gap for one, two, gap in met.gaps for k in (one, two)}
    narrow = _widest(met.slivers)
    for k in lonely[:MOST_TOLD]:
        told = (
            (f"; the nearest face is {1000.0 * near[k]:.3g} mm away (give a larger `contact_tolerance`, or `mortar_gap` for mortar)")
            if k in near
            else ""
        )
        if k in narrow:
            told = (
                f": the width of its widest contact is {1e3 * narrow[k]:.3g} mm, less than {1e3 * close:.3g} mm{cure}, so this "
                "contact counts as a line"
            )
        wrong.append(f"{names[k]} touches neither another block nor the ground{told}")
    if len(lonely) > MOST_TOLD:
        wrong.append(f"and {len(lonely) - MOST_TOLD} more blocks touch nothing")
    if not lonely and not (b == GROUND).any():
        wrong.append("no block is supported by the ground")
    if wrong:
        raise BadGeometry(f"{what}: " + "; ".join(wrong))


def _nearly(names: Sequence[str], gaps: Sequence[tuple[int, int, float]]) -> tuple[str, ...]:
    """A remark on faces that nearly touch."""
    if not gaps:
        return ()
    one, two, gap = max(gaps, key=lambda g: g[2])
    other = names[two] if two < len(names) else "the ground"
    return (
        (
            f"{len(gaps)} pairs of blocks have faces that nearly touch but form no contact. They are at most {1000.0 * gap:.3g} mm "
            f"apart ({names[one]} and {other}). To close these gaps, give a larger `contact_tolerance`, or `mortar_gap` for mortar joints"
        ),
    )


def _widest(slivers: Sequence[tuple[int, int, float]]) -> dict[int, float]:
    """The widest sliver of each block [m]."""
    found: dict[int, float] = {}
    for one, two, width in slivers:
        for k in (one, two):
            found[k] = max(found.get(k, 0.0), width)
    return found


def _narrow(names: Sequence[str], slivers: Sequence[tuple[int, int, float]], close: float) -> tuple[str, ...]:
    """A remark on contacts narrower than the tolerance."""
    if not slivers:
        return ()
    one, two, width = max(slivers, key=lambda s: s[2])
    other = names[two] if two < len(names) else "the ground"
    return (
        (
            f"{len(slivers)} contacts are narrower than {1000.0 * close:.3g} mm (`contact_tolerance`). They count as lines or points "
            f"and carry no force. The widest of these contacts has a width of {1000.0 * width:.3g} mm ({names[one]} and {other})"
        ),
    )


def _rough(blocks: Sequence[Stone], met: Touching) -> tuple[str, ...]:
    """A remark where faces in contact deviate so much from their common planes that capacities change by more than 1 %."""
    if not met.apart:
        return ()
    j = int(np.argmax(met.apart))
    thin = min(blocks, key=_thickness)
    share = 0.5 * met.apart[j] / _thickness(thin)  # half of it for each face
    if share <= ONE_PERCENT:
        return ()
    other = blocks[met.b[j]].name if met.b[j] < len(blocks) else "the ground"
    return (
        (
            f"Faces in contact deviate by up to {0.5e3 * met.apart[j]:.3g} mm from their common plane "
            f"({blocks[met.a[j]].name} and {other}). The thinnest block has a thickness of {1e3 * _thickness(thin):.3g} mm "
            f"({thin.name}), so capacities are uncertain by about {share / ONE_PERCENT:.2g} %. Measure the blocks more closely"
        ),
    )


def _thickness(stone: Stone) -> float:
    """Least extent of a stone across any of its faces [m]."""
    points = np.concatenate([part.vertices for part in stone.parts])
    normals = np.concatenate([part.normals for part in stone.parts])
    return float(np.ptp(points @ normals.T, axis=0).min())
