"""A survey looked at before it is computed: outlines, joints, and one list of all gaps, overlaps and near misses."""

from collections import Counter
from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from extrados.model.errors import BadGeometry
from extrados.model.geometry.contacts import Contacts, Flaw, Overlap, find_contacts, nearest, shortest_joint
from extrados.model.geometry.drawing import MOST_POINTS, Drawing, Polygon
from extrados.model.geometry.mortar import closed_outlines
from extrados.model.geometry.polygons import crossing_edges, following, inside, properties, signed_area

FARTHEST = 1e5  # m from the origin
#: No tolerance mends what is deeper than this [m], or than this part of the smaller of two blocks.
MOST_TOLERANCE, MOST_PART = 0.1, 0.1
JOINT = 3e-3  # m: gaps wider than this may be joints of mortar
SHOWN = 3  # of a list in a sentence
MOST_LOOSE = 50  # loose blocks whose nearest neighbours are sought

Status = Literal["closed", "open", "overlap"]


@dataclass(frozen=True)
class Inspection:
    """Blocks as surveyed, with their contacts and what is amiss with them.

    outlines: counter-clockwise [m]; ground: segments (k, 4) [m]; loose: blocks that no joint leads to from the ground;
    levels: heights [m] of level soles that nothing bears. tolerance: `contact_tolerance` [m].
    """

    names: list[str]
    outlines: list[np.ndarray]
    drawing: Drawing
    ground: np.ndarray
    tolerance: float
    contacts: Contacts
    flaws: list[Flaw]
    loose: list[int]
    levels: list[tuple[int, float]]

    def status(self, flaw: Flaw) -> Status:
        """Whether the tolerance closes it, leaves a gap open, or refuses an overlap."""
        if flaw.depth <= self.tolerance:
            return "closed"
        return "open" if flaw.kind == "gap" else "overlap"

    def mends(self, flaw: Flaw) -> float | None:
        """The tolerance [m] that would close it, two figures, rounded up; None where it has to be drawn anew."""
        sizes = [np.sqrt(signed_area(self.outlines[b])) for b in (flaw.first, flaw.second) if b >= 0]
        unit = 10.0 ** np.floor(np.log10(flaw.depth) - 1.0)
        tolerance = float(np.ceil(flaw.depth / unit * (1.0 + 1e-6)) * unit)
        return tolerance if tolerance <= min(MOST_TOLERANCE, MOST_PART * min(sizes)) else None

    def between(self, flaw: Flaw) -> str:
        """The two blocks, in words."""
        second = "the ground" if flaw.second < 0 else f"'{self.names[flaw.second]}'"
        return f"'{self.names[flaw.first]}' and {second}"

    def of(self, status: Status) -> list[Flaw]:
        """All flaws of a status, the deepest first."""
        return [flaw for flaw in self.flaws if self.status(flaw) == status]

    def _told(self, flaws: list[Flaw]) -> str:
        shown = "; ".join(
            (
                f"blocks {self.between(flaw)} {'are' if flaw.kind == 'gap' else 'overlap by'} "
                f"{length(flaw.depth)}{' apart' if flaw.kind == 'gap' else ''} near x = {flaw.place[0]:.4g} m, y = {flaw.place[1]:.4g} m"
            )
            for flaw in flaws[:SHOWN]
        )
        return shown + (f"; and {len(flaws) - SHOWN} more" if len(flaws) > SHOWN else "")

    def _cure(self, flaws: list[Flaw]) -> str:
        mends = [self.mends(flaw) for flaw in flaws]
        known = [m for m in mends if m is not None]
        if len(known) < len(mends):
            worst = next(flaw for flaw, m in zip(flaws, mends, strict=True) if m is None)
            what = "overlap by" if worst.kind == "overlap" else "are apart by"
            return f"blocks {self.between(worst)} {what} more than a tolerance can close: draw them again"
        cure = f'contact_tolerance = "{1e3 * max(known):.3g} mm" would close {"this gap or overlap" if len(flaws) == 1 else "all of them"}'
        wide = max(known) > JOINT and all(flaw.kind == "gap" for flaw in flaws)
        return f'{cure}; if the joints contain mortar, give mortar_gap = "{1000.0 * max(known):.3g} mm"' if wide else cure

    def complaints(self) -> list[str]:
        """Why it cannot be computed: overlaps, no ground, blocks that nothing holds; empty where it can."""
        found = []
        if overlaps := self.of("overlap"):
            found.append(f"{_count(overlaps, 'overlap')}: {self._told(overlaps)}; {self._cure(overlaps)}")
        if not (self.contacts.b < 0).any():
            hint = next((f for f in self.flaws if f.second < 0), None)
            near = f"; the nearest blocks, {self.between(hint)}, are {length(hint.depth)} apart" if hint else ""
            found.append(f"no block touches the ground: give segments of `ground` at the supports{near}")
        elif self.loose:
            names = ", ".join(f"'{self.names[i]}'" for i in self.loose[:5])
            more = f" and {len(self.loose) - 5} more" if len(self.loose) > 5 else ""
            gaps = [f for f in self.of("open") if f.first in self.loose or f.second in self.loose]
            near = f"; {self._told(gaps)}; {self._cure(gaps)}" if gaps else ""
            found.append(f"no joints connect the ground with block{'s' if len(self.loose) > 1 else ''} {names}{more}{near}")
        return found

    def closing(self) -> float | None:
        """The tolerance [m] that would close all gaps that are open now; None where none is, or one has to be redrawn."""
        mends = [self.mends(flaw) for flaw in self.of("open")]
        return None if not mends or any(m is None for m in mends) else max(m for m in mends if m is not None)

    def remarks(self) -> list[str]:
        """What an answer must tell: gaps that stay open, soles that nothing bears."""
        found = []
        gaps = [f for f in self.of("open") if self.mends(f) is not None]
        if gaps:
            found.append(
                f"{_count(gaps, 'gap')} wider than `contact_tolerance` ({1000.0 * self.tolerance:g} mm) {('is' if len(gaps) == 1 else 'are')} "
                f"modelled as open, which changes the forces on the blocks: {self._told(gaps)}; {self._cure(gaps)}"
            )
        if self.drawing.loose:
            (x, y), gap = min(self.drawing.loose, key=lambda end: np.inf if end[1] is None else end[1])
            near = "" if gap is None else f", {length(gap)} from the next line (see `join_tolerance`)"
            many = len(self.drawing.loose)
            found.append(
                f"{many} end{'s' if many > 1 else ''} of loose lines {'meet' if many > 1 else 'meets'} no other line, so these "
                f"lines form no block. One end is at x = {x:.4g} m, y = {y:.4g} m{near}"
            )
        if self.levels:
            heights = sorted({round(y, 4) for _, y in self.levels})
            named = ", ".join(f"'{self.names[i]}'" for i, _ in self.levels[:SHOWN])
            found.append(
                f"the horizontal soles of {named}{(' and others' if len(self.levels) > SHOWN else '')} at y = "
                f"{', '.join(f'{y:.4g}' for y in heights)} m have no support. If the ground supports them, give `foundation_levels`"
            )
        return found

    def notes(self) -> list[str]:
        """What was made of the survey: left out, joined, closed within the tolerance."""
        found = list(self.drawing.notes)
        closed = self.of("closed")
        if closed:
            worst = closed[0]
            found.append(
                f"{_count(closed, 'gap or overlap', 'gaps and overlaps')} of up to {length(worst.depth)} were "
                f"closed within `contact_tolerance` ({1000.0 * self.tolerance:g} mm). The widest is between {self.between(worst)}."
            )
        return found


def length(value: float) -> str:
    """A length [m] in words: millimetres, or metres from one on."""
    return f"{1e3 * value:.3g} mm" if value < 1.0 else f"{value:.3g} m"


def _count(flaws: list[Flaw], one: str, many: str = "") -> str:
    return f"{len(flaws)} {one if len(flaws) == 1 else many or one + 's'}"


def inspect(
    drawing: Drawing,
    ground: np.ndarray | None,
    tolerance: float,
    foundation_levels: list[float] | None = None,
    origin: np.ndarray | None = None,
    mortar: float = 0.0,
) -> Inspection:
    """Outlines, joints and flaws of surveyed blocks, those of a drawing less its origin [m].

    ground: segments (k, 4) [m]; where it and foundation_levels are None the drawing's, or else the lowest level.
    mortar [m]: joints up to that wide are closed by moving both faces to their middle.
    BadGeometry where a single outline is no outline; what is amiss between outlines is in the answer.
    """
    polygons = drawing.blocks
    if not polygons:
        raise BadGeometry("there are no blocks")
    names = [p.name for p in polygons]
    if len(set(names)) < len(names):
        twice = next(n for n, count in Counter(names).items() if count > 1)
        raise BadGeometry(f"two blocks are called '{twice}'")
    shift = np.zeros(2) if origin is None else np.asarray(origin, dtype=float)
    outlines = [_outline(p, tolerance, shift) for p in polygons]
    if mortar > 0.0:
        outlines, note = closed_outlines(outlines, names, mortar, tolerance)
        drawing = replace(drawing, notes=(*drawing.notes, note))
    given = ground if ground is not None else drawing.ground if foundation_levels is None else None
    segments = np.empty((0, 4)) if given is None else np.asarray(given, dtype=float).reshape(-1, 4) - np.tile(shift, 2)
    if foundation_levels is not None:
        segments = np.concatenate([segments, _soles(outlines, np.array(foundation_levels) - shift[1], tolerance)])
    elif given is None:
        points = np.concatenate(outlines)
        (left, lowest), right = points.min(axis=0), points[:, 0].max()
        segments = np.array([[left - 1.0, lowest, right + 1.0, lowest]])
    contacts = find_contacts(outlines, segments, tolerance)
    loose = _loose(contacts, len(outlines))
    flaws = list(contacts.flaws)
    named = {b for flaw in flaws for b in (flaw.first, flaw.second) if flaw.depth > tolerance}
    for block in [b for b in loose if b not in named][:MOST_LOOSE]:
        found = nearest(outlines, segments, block)
        if found is not None and found.depth > tolerance:
            flaws.append(found)
    return Inspection(names, outlines, drawing, segments, tolerance, contacts, flaws, loose, _hanging(outlines, contacts, tolerance))


def _outline(polygon: Polygon, tolerance: float, shift: np.ndarray) -> np.ndarray:
    points = np.asarray(polygon.points, dtype=float) - shift
    if not (np.abs(points) <= FARTHEST).all():  # NaN too
        far = np.abs(points).max()
        near = np.floor((points + shift).min(axis=0)) if far <= 1e12 else None  # what is farther is no place on Earth
        hint = "" if near is None else f"; origin = [{near[0]:.0f}, {near[1]:.0f}] would move the drawing near the origin"
        raise BadGeometry(f"block '{polygon.name}': a vertex is farther than {FARTHEST:g} m from the origin{hint}")
    # Vertices this near are one; a survey's tolerance is no reason to lose the corners of its stones.
    least = min(tolerance, 1e-4)
    if len(points) > 1 and np.abs(points[0] - points[-1]).max() <= least:
        points = points[:-1]
    apart = np.hypot(*(following(points) - points).T) > least if len(points) else np.array([], bool)
    points = points[apart]
    if not 3 <= len(points) <= MOST_POINTS:
        raise BadGeometry(f"block '{polygon.name}' has {len(points)} distinct vertices, expected 3 to {MOST_POINTS}")
    if crossing_edges(points) is not None:
        raise BadGeometry(f"block '{polygon.name}': the outline crosses itself")
    area = signed_area(points)
    if abs(area) < tolerance * float(np.ptp(points, axis=0).max()):
        raise BadGeometry(f"block '{polygon.name}' has practically no area ({abs(area):.3g} m^2)")
    return points if area > 0.0 else points[::-1]


def _level_soles(outlines: list[np.ndarray], tolerance: float) -> list[tuple[int, np.ndarray, np.ndarray]]:
    """Edges that look down, are level within the tolerance and have no other block right below their middles."""
    found = []
    low = np.array([o.min(axis=0) for o in outlines])
    high = np.array([o.max(axis=0) for o in outlines])
    for i, outline in enumerate(outlines):
        for a, b in zip(outline, following(outline), strict=True):
            if b[0] - a[0] > shortest_joint(tolerance) and abs(b[1] - a[1]) <= max(tolerance, 1e-3 * (b[0] - a[0])):
                below = 0.5 * (a + b) - (0.0, 2.0 * shortest_joint(tolerance))
                near = np.flatnonzero((low <= below).all(axis=1) & (below <= high).all(axis=1))
                if not any(j != i and inside(outlines[j], below[None])[0] for j in near.tolist()):
                    found.append((i, a, b))
    return found


def _soles(outlines: list[np.ndarray], levels: np.ndarray, tolerance: float) -> np.ndarray:
    """Ground (k, 4) below the soles at some levels; BadGeometry where there is none at one."""
    soles = _level_soles(outlines, tolerance)
    rows: list[np.ndarray] = []
    for level in levels.tolist():
        here = [(a, b) for _, a, b in soles if max(abs(a[1] - level), abs(b[1] - level)) <= max(tolerance, 1e-3)]
        if not here:
            heights = sorted({round(float(0.5 * (a[1] + b[1])), 3) for _, a, b in soles})
            raise BadGeometry(
                f"foundation_levels: no block has a horizontal sole at {level:g} m; soles are at "
                f"{', '.join(f'{h:g}' for h in heights[:8])} m"
            )
        rows += [np.concatenate([a, b]) for a, b in here]
    return np.array(rows).reshape(-1, 4)


def _hanging(outlines: list[np.ndarray], contacts: Contacts, tolerance: float) -> list[tuple[int, float]]:
    """Blocks that no joint bears from below and that have a level sole, with its height."""
    along = contacts.q - contacts.p
    # Block a lies to the left of p -> q: above the joint where that runs to the right.
    up = along[:, 0] / np.maximum(np.hypot(*along.T), 1e-300)
    borne = set(contacts.a[up > 1e-6].tolist()) | set(contacts.b[up < -1e-6].tolist())
    if len(borne - {-1}) == len(outlines):
        return []
    return [
        (i, float(0.5 * (a[1] + b[1])))
        for i, a, b in _level_soles(outlines, tolerance)
        if i not in borne and min(a[1], b[1]) <= outlines[i][:, 1].min() + tolerance
    ]


def _loose(contacts: Contacts, count: int) -> list[int]:
    """Blocks that no joint leads to from the ground."""
    reached = set(contacts.a[contacts.b < 0].tolist())
    neighbours: dict[int, list[int]] = {}
    for a, b in zip(contacts.a.tolist(), contacts.b.tolist(), strict=True):
        if b >= 0:
            neighbours.setdefault(a, []).append(b)
            neighbours.setdefault(b, []).append(a)
    front = list(reached)
    while front:
        front = list({n for block in front for n in neighbours.get(block, [])} - reached)
        reached.update(front)
    return [i for i in range(count) if i not in reached]


def refuse(inspection: Inspection) -> None:
    """Overlap or BadGeometry with all complaints, where there are any."""
    if found := inspection.complaints():
        hint = " (`extrados check` lists and draws all of them)" if inspection.flaws else ""
        raise (Overlap if inspection.of("overlap") else BadGeometry)("; ".join(found) + hint)


def areas(inspection: Inspection) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Area [m^2], centroid [m] and polar moment [m^4] of every block."""
    area, centroid, polar = zip(*map(properties, inspection.outlines), strict=True)
    return np.array(area), np.array(centroid), np.array(polar)
