"""Form diagrams in plan for thrust networks: radial, grid and crossed, with the surfaces and weights of the blocks above them."""

from typing import Literal

import numpy as np
from scipy.spatial import cKDTree

from extrados.analyses.context import Refused
from extrados.analyses.limit.tables import ThrustNetwork
from extrados.limit.network import Diagram, Network
from extrados.model.geometry.solids.assembly import SolidAssembly
from extrados.model.geometry.solids.contacts import GROUND
from extrados.model.geometry.solids.verticals import columns_of
from extrados.schema.constants import GRAVITY
from extrados.views.building import Building

Form = Literal["radial", "grid", "crossed"]
#: Forms of the kinds; grid for all others
FORMS: dict[str, Form] = {"dome": "radial", "cross-vault": "crossed"}
FORM = ("analysis", "form")
SAMPLES = 240  # lines across the plan by which weights are shared
PROFILE = 400  # places of the section of a dome
HAIR = 1e-7  # of the size: how far inside the outline surfaces are measured
VOID = 0.02  # of the depth, and of the plan
CARRIES = 1e-3  # of the greatest density
BAND = 0.05  # of the extent: supports nearer to the middle do not leave it free


def form_of(building: Building, options: ThrustNetwork) -> Form:
    """The form of the diagram: that of the deck, else that of the kind of structure."""
    return options.form or FORMS.get(building.structure.kind if building.structure else "", "grid")


def diagram_of(assembly: SolidAssembly, form: Form, lines: int, meridians: int) -> Diagram:
    """The form diagram of blocks; Refused where the blocks have no span or vertical lines cross voids."""
    beds = _beds(assembly)
    if not beds:
        raise Refused("a thrust network requires supports: no block touches the ground", ("structure",))
    points, branch, edge, held = (
        _radial(assembly, beds, lines, meridians) if form == "radial" else _grid(assembly, beds, lines, form == "crossed")
    )
    middle = points.mean(axis=0)
    inside = middle + (1.0 - HAIR) * (points - middle)
    support, outward, seat = _supports(points, branch, beds, inside, edge)
    counts = ~np.asarray(np.isin(branch, support).all(axis=1))  # branches from support to support carry nothing
    held = (np.cumsum(counts) - 1)[held[counts[held]]]
    branch = branch[counts]
    between = inside[branch[held]].mean(axis=1)
    columns = columns_of(assembly, np.concatenate([inside, between]))
    if np.isnan(columns.low).any():
        x, y = np.concatenate([points, between])[int(np.flatnonzero(np.isnan(columns.low))[0])]
        raise Refused(
            f"no block is above or below the branches of the diagram at x = {x:.3g} m, y = {y:.3g} m. For an opening in the middle of a dome "
            'give form = "radial". With other openings use `thrust`, which analyses the blocks: lines of compression that end at an opening '
            "or at a straight free edge carry nothing",
            FORM,
        )
    weight = _weights(assembly, points)
    if form == "radial":  # the nodes of a hoop carry alike
        rings = len(points) // meridians * meridians
        weight[:rings] = weight[:rings].reshape(-1, meridians).mean(axis=1).repeat(meridians)
    above = np.array([_above(beds, place) for place in np.concatenate([inside, between])])
    return Diagram(points, branch, held, columns.low, columns.high, above, weight, support, outward, seat)


def outside_of(diagram: Diagram, assembly: SolidAssembly, network: Network) -> tuple[float, float]:
    """How far branches that carry force leave the blocks at their quarter points and middles at most, and the median thickness of
    the blocks there; both across the branch [m]."""
    counts = network.density > CARRIES * network.density.max()
    beds, height = _beds(assembly), network.height
    first, second = diagram.branch[counts].T
    run = np.linalg.norm(diagram.point[second] - diagram.point[first], axis=1)
    level = run / np.hypot(run, height[second] - height[first])
    worst, thickness = 0.0, []
    for part in (0.25, 0.5, 0.75):
        places = (1.0 - part) * diagram.point[first] + part * diagram.point[second]
        columns = columns_of(assembly, places)
        # Over a bed the line is that of the reaction
        there = ~np.isnan(columns.low) & ~np.array([_above(beds, place) for place in places])
        z = (1.0 - part) * height[first] + part * height[second]
        out = level * np.maximum(columns.low - z, z - columns.high)
        worst = max(worst, float(out[there].max(initial=0.0)))
        thickness.append((level * (columns.high - columns.low))[there])
    return worst, float(np.median(np.concatenate(thickness)))


def _beds(assembly: SolidAssembly) -> list[np.ndarray]:
    """Outlines (k, 3) [m] of the contacts with the ground."""
    grounded = (assembly.a == GROUND) | (assembly.b == GROUND)
    return [assembly.polygon[j] for j in np.flatnonzero(grounded).tolist()]


def _middles(beds: list[np.ndarray]) -> np.ndarray:
    """Mean of the corners of each bed in plan (nb, 2) [m]."""
    return np.array([bed[:, :2].mean(axis=0) for bed in beds])


def _radial(
    assembly: SolidAssembly, beds: list[np.ndarray], rings: int, meridians: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Meridians through the middle and hoops at equal lengths along them, with a crown node unless the middle is open: points
    (n, 2) [m], branches (m, 2), nodes of the outermost hoop, and branches
    that are no chords of hoops."""
    corners = np.concatenate(beds)[:, :2]
    centre = 0.5 * (corners.min(axis=0) + corners.max(axis=0))
    turn = 2.0 * np.pi * np.arange(meridians) / meridians
    around = np.column_stack([np.cos(turn), np.sin(turn)])
    crossed = [[end[0] for bed in beds for end in _ends(bed, centre, way)[0] if end[0] > 0.0] for way in around]
    if not all(crossed):
        raise Refused("a radial diagram requires supports all around, but one meridian ends beside the supports: give another `form`", FORM)
    feet = np.array([0.5 * (min(ends) + max(ends)) for ends in crossed])
    radius = float(feet.mean())
    reach = np.linspace(0.0, radius, PROFILE)
    section = columns_of(assembly, centre + reach[:, None] * np.array([np.cos(1e-3), np.sin(1e-3)]))
    there = np.flatnonzero(~np.isnan(section.low))
    if not len(there):
        raise Refused("a radial diagram requires a dome, but no block is found along a radius: give another `form`", FORM)
    reach, middle = reach[there], 0.5 * (section.low + section.high)[there]
    length = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(reach), np.diff(middle)))])
    r = np.interp(np.linspace(0.0, length[-1], rings + 1), length, reach)
    closed = r[0] <= reach[-1] / PROFILE
    r[-1] = radius
    if not closed:
        r[0] += 0.01 * (r[1] - r[0])  # within the stones about the opening
    circles = r[1:] if closed else r
    points = np.concatenate([centre + one / radius * feet[:, None] * around for one in circles])
    number = np.arange(len(points)).reshape(len(circles), meridians)
    branch = [np.column_stack([number[:-1].ravel(), number[1:].ravel()])]
    branch.append(np.column_stack([number[:-1].ravel(), np.roll(number[:-1], -1, axis=1).ravel()]))
    if closed:
        points = np.concatenate([points, centre[None]])
        branch.append(np.column_stack([np.full(meridians, len(points) - 1), number[0]]))
    branches = np.concatenate(branch)
    steps = np.linalg.norm(points[branches] - centre, axis=2)
    return points, branches, number[-1], np.flatnonzero(np.abs(steps[:, 1] - steps[:, 0]) > 0.1 * np.diff(circles, prepend=0.0).min())


def _grid(
    assembly: SolidAssembly, beds: list[np.ndarray], lines: int, crossed: bool
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Lines along x and y over the rectangle between the middles of the supports, or over the blocks where supports run along it;
    crossed: both diagonals as well. Points (n, 2) [m], branches (m, 2), nodes of the outline, and all branches.
    Supports are sought at the ends of the spans between beds: at two sides, at four corners, or all around."""
    middles, corners = _middles(beds), np.concatenate(beds)[:, :2]
    body = np.concatenate([part.vertices for part in assembly.parts])[:, :2]
    ends, trimmed = np.empty((2, 2)), [False, False]
    for k in range(2):
        low, high = body[:, k].min(), body[:, k].max()
        half = 0.5 * (low + high)
        free = all(bed[:, k].min() > half + BAND * (high - low) or bed[:, k].max() < half - BAND * (high - low) for bed in beds)
        if free and (corners[:, k] < half).any() and (corners[:, k] > half).any():
            trimmed[k] = True
            low, high = middles[middles[:, k] < half, k].mean(), middles[middles[:, k] > half, k].mean()
        ends[k] = low, high
    size = np.ptp(ends, axis=1)
    count = (
        [lines, lines] if crossed else [lines if size[k] >= size[1 - k] else max(1, round(lines * size[k] / size[1 - k])) for k in range(2)]
    )
    x, y = (np.linspace(ends[k, 0], ends[k, 1], count[k] + 1) for k in range(2))
    points = np.array([[a, b] for a in x for b in y])
    number = np.arange(len(points)).reshape(len(x), len(y))
    branch = [np.column_stack([number[:-1].ravel(), number[1:].ravel()]), np.column_stack([number[:, :-1].ravel(), number[:, 1:].ravel()])]
    if crossed:
        for way in (np.diagonal(number), np.diagonal(number[::-1])):
            branch.append(np.column_stack([way[:-1], way[1:]]))
    sides = [np.concatenate([number[0], number[-1]]), np.concatenate([number[:, 0], number[:, -1]])]
    spans = [k for k in range(2) if trimmed[k]] or None
    if spans is None:
        edge = np.unique(np.concatenate(sides))
    else:
        edge = sides[spans[0]] if len(spans) == 1 else np.intersect1d(sides[0], sides[1])
    branches = np.concatenate(branch)
    return points, branches, edge, np.arange(len(branches))


def _supports(
    points: np.ndarray, branch: np.ndarray, beds: list[np.ndarray], inside: np.ndarray, edge: np.ndarray
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Nodes on the ground, the outward unit vectors of their thrust, and the ends of their beds, see `limit.network.Diagram`.

    points (n, 2), branch (m, 2), beds: see `diagram_of`; inside (n, 2): points a hair within the outline; edge: nodes that may be
    supports. The thrust acts along the mean way from the neighbours that are no supports.
    """
    middle = points.mean(axis=0)
    support = np.array([node for node in edge.tolist() if _cut(beds, inside[node], _unit(points[node] - middle)) is not None], dtype=int)
    if len(support) < 2:
        raise Refused("the diagram has fewer than two nodes on the supports: give another `form`", FORM)
    outward, seat = np.empty((len(support), 2)), np.empty((len(support), 2, 2))
    for k, node in enumerate(support.tolist()):
        others = np.concatenate([branch[branch[:, 0] == node, 1], branch[branch[:, 1] == node, 0]])
        free = others[~np.isin(others, support)]
        outward[k] = _unit(points[node] - (points[free].mean(axis=0) if len(free) else middle))
        cut = _cut(beds, inside[node], outward[k])
        if cut is None:
            raise Refused("a node of the diagram lies on the edge of a support: give another `form`, or another number of `lines`", FORM)
        seat[k] = cut
    return support, outward, seat


def _above(beds: list[np.ndarray], place: np.ndarray) -> bool:
    """Whether a place (2) lies over a bed in plan."""
    return any(_cut([bed], place, np.array([1.0, 0.0])) is not None for bed in beds)


def _unit(way: np.ndarray) -> np.ndarray:
    return way / np.linalg.norm(way)


def _cut(beds: list[np.ndarray], place: np.ndarray, way: np.ndarray) -> np.ndarray | None:
    """Inner and outer end (2, 2) of the beds under a place (2), on the vertical plane through it along `way` (2): from the place along
    it, and upward [m]; None where it lies beside all beds."""
    found = []
    for bed in beds:
        ends, slack = _ends(bed, place, way)
        if ends and min(end[0] for end in ends) <= slack and max(end[0] for end in ends) >= -slack:
            found += ends
    if not found:
        return None
    ordered = sorted(found, key=lambda end: (round(end[0], 9), end[1]))
    return np.array([ordered[0], ordered[-1]])


def _ends(bed: np.ndarray, place: np.ndarray, way: np.ndarray) -> tuple[list[np.ndarray], float]:
    """Where the outline of a bed (k, 3) crosses the vertical plane through a place (2) along `way` (2): from the place along it and
    upward [m]; and the slack of its edges [m]."""
    r, s = (bed[:, :2] - place) @ way, (bed[:, :2] - place) @ np.array([-way[1], way[0]])
    slack = 10.0 * HAIR * float(np.ptp(bed, axis=0).max())
    ends = [np.array([r[i], bed[i, 2]]) for i in np.flatnonzero(np.abs(s) <= slack)]
    for i, j in zip(range(len(bed)), np.roll(np.arange(len(bed)), -1).tolist(), strict=True):
        if s[i] * s[j] < 0.0 and min(abs(s[i]), abs(s[j])) > slack:
            part = s[i] / (s[i] - s[j])
            ends.append((1.0 - part) * np.array([r[i], bed[i, 2]]) + part * np.array([r[j], bed[j, 2]]))
    return ends, slack


def _weights(assembly: SolidAssembly, points: np.ndarray) -> np.ndarray:
    """Weight of each node [N]: of the blocks nearer to it in plan than to any other, and of the fill; Refused at voids."""
    body = np.concatenate([part.vertices for part in assembly.parts])[:, :2]
    low, high = body.min(axis=0), body.max(axis=0)
    step = (np.arange(SAMPLES) + 0.5) / SAMPLES
    samples = low + np.stack(np.meshgrid(*step[None].repeat(2, axis=0), indexing="ij"), axis=-1).reshape(-1, 2) * (high - low)
    columns = columns_of(assembly, samples)
    there = columns.depth > 0.0
    void = (columns.high - columns.low - columns.depth)[there] > VOID * (columns.high - columns.low)[there]
    if void.mean() > VOID:
        raise Refused(
            "vertical lines cross voids between the blocks, but a thrust network requires a single layer of masonry: "
            "use `thrust`, which analyses the blocks",
            ("structure",),
        )
    nearest = cKDTree(points)
    share = np.bincount(nearest.query(samples[there])[1], columns.mass[there], len(points))
    weight = GRAVITY * float(assembly.mass.sum()) * share / share.sum()
    if len(assembly.fill):
        weight += GRAVITY * np.bincount(nearest.query(assembly.fill[:, 2:4])[1], assembly.fill[:, 1], len(points))
    return weight
