"""Point clouds of walls and barrel vaults: planes and circles fitted to their faces, with the misfit.

PLY is read by trimesh, LAS and LAZ by laspy (the extra `scan`), and XYZ by numpy, in a process of its own.
"""

import io
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from extrados.model.errors import BadGeometry
from extrados.schema.contained import Unreadable, read_contained
from extrados.schema.files import File

CLOUDS = (".ply", ".xyz", ".las", ".laz")
HEADER = 50  # lines of an XYZ file in which its first point is looked for
MOST_POINTS, FEWEST_POINTS = 20_000_000, 100
CONSIDERED = 200_000  # points of a fit: of more, so many at even spacing in the file
TRIES = 3_000  # points by which the direction of a barrel is sought
#: Points farther from a face than so many standard deviations (by the median), and than this [m], do not shape it
OUTLIER, LEAST_NOISE = 3.0, 1e-4
#: Such a point is stray if at most so many of its nearest neighbours along the face are such points: a bulge is no stray point
NEIGHBOURS, ALIKE = 16, 8
ENDS = 0.1  # percent of the points of a face beyond either of its ends
#: Misfits (95 %) above these shares of the thickness: the capacity is uncertain; the points have another shape
ROUGH, OTHER = 0.1, 0.25
UPRIGHT = 0.3  # vertical part of the normal of a wall, at most


@dataclass(frozen=True)
class Fit:
    """How points lie on a face: points of the face and stray points, root mean square and 95th percentile of the distances [m] of
    the points of the face, bulges included."""

    name: str
    used: int
    dropped: int
    rms: float
    most: float

    def told(self) -> str:
        """The misfit in words."""
        return (
            f"{self.name}: 95 % of {self.used} points are within {1e3 * self.most:.3g} mm of the fitted surface "
            f"(root mean square distance {1e3 * self.rms:.3g} mm). {self.dropped} stray points were not used"
        )


@dataclass(frozen=True)
class WallFit:
    """Faces of a wall: n = back[0] + back[1] s + back[2] z, and front alike [m], with s along `along`, n along `across` (3), from
    `origin` (3); s, z: both ends."""

    origin: np.ndarray
    along: np.ndarray
    across: np.ndarray
    back: np.ndarray
    front: np.ndarray
    s: tuple[float, float]
    z: tuple[float, float]
    fits: tuple[Fit, ...]


@dataclass(frozen=True)
class BarrelFit:
    """Circles (s, z, radius) of intrados and extrados [m], with s along `along` (3) and t along the axis `axis` (3), from `origin` (3);
    angle: of both springings about the centre of the intrados, from s to z [rad]; t: both ends."""

    origin: np.ndarray
    along: np.ndarray
    axis: np.ndarray
    inner: np.ndarray
    outer: np.ndarray
    angle: tuple[float, float]
    t: tuple[float, float]
    fits: tuple[Fit, ...]


def read_cloud(file: File, scale: float) -> np.ndarray:
    """Points (n, 3) [m] of a file in units of `scale` [m]; BadGeometry says why there are none."""
    name, sort = file.path.name, file.path.suffix.lower()
    library = "laspy" if sort in (".las", ".laz") else "trimesh"
    try:
        found = read_contained("extrados.model.geometry.clouds:parse_cloud", file.content, [library], sort=sort)
    except Unreadable as error:
        raise BadGeometry(f"{name}: {error}", ("structure", "file")) from None
    points = scale * np.asarray(found["points"])
    if len(points) < FEWEST_POINTS:
        raise BadGeometry(f"{name}: the file has {len(points)} points, but at least {FEWEST_POINTS} are required", ("structure", "file"))
    return points[:: -(-len(points) // CONSIDERED)]


def parse_cloud(content: bytes, sort: str) -> dict[str, np.ndarray]:
    """Points (n, 3) of a file. The contained process calls this; Unreadable gives the reason."""
    try:
        if sort in (".las", ".laz"):
            import laspy

            cloud = laspy.read(io.BytesIO(content))
            points = np.column_stack([cloud.x, cloud.y, cloud.z])
        elif sort == ".xyz":
            points = _parse_lines(content)
        else:
            import trimesh

            loaded: Any = trimesh.load(io.BytesIO(content), file_type=sort[1:])
            points = np.asarray(loaded.vertices, dtype=float)
    except ImportError:
        raise Unreadable("reading point clouds requires trimesh and laspy. Install them by pip install 'extrados[scan]'") from None
    if points.ndim != 2 or points.shape[1] != 3 or not np.isfinite(points).all():
        raise Unreadable("the file has no points with three finite coordinates")
    if len(points) > MOST_POINTS:
        raise Unreadable(f"the file has more than {MOST_POINTS} points: reduce their number")
    return {"points": points}


def _parse_lines(content: bytes) -> np.ndarray:
    """Points (n, 3) of lines x y z ..., parted by blanks, semicolons, tabs or commas, below lines that begin with other words."""
    lines = content.decode("utf-8", "replace").replace(";", " ").splitlines()
    first = next((k for k, line in enumerate(lines[:HEADER]) if _starts_with_numbers(line)), None)
    if first is None:  # commas part numbers if the decimal sign of the first point is a point
        lines = [line.replace(",", " ") for line in lines]
        first = next((k for k, line in enumerate(lines[:HEADER]) if "." in line and _starts_with_numbers(line)), None)
    if first is None:
        raise Unreadable(f"the first {HEADER} lines contain no three numbers x, y and z with a decimal point")
    try:
        return np.loadtxt(lines[first:], usecols=(0, 1, 2), comments=None, ndmin=2)
    except (ValueError, IndexError) as error:
        raise Unreadable(f"expected three numbers x, y and z in each line below line {first + 1}: {error}") from None


def _starts_with_numbers(line: str) -> bool:
    try:
        return len([float(word) for word in line.split()[:3]]) == 3
    except ValueError:
        return False


def fit_wall(points: np.ndarray, thickness: float | None = None) -> WallFit:
    """The wall of points (n, 3) [m] on both of its faces, or on one of them if its thickness [m] is given.

    Each face is the plane of least squares of its points, without those farther from it than three standard deviations. The misfit
    and the ends of the wall count these points too, except stray ones. BadGeometry where the points have another shape.
    """
    origin = np.median(points, axis=0)
    normal = np.linalg.svd((points - origin)[:: -(-len(points) // 20_000)], full_matrices=False)[2][2]
    if abs(normal[2]) > UPRIGHT:
        raise BadGeometry("the points do not form a vertical wall: give a separate file for each wall", ("structure", "scan"))
    across = np.array([normal[0], normal[1], 0.0]) / np.hypot(normal[0], normal[1])
    along = np.array([across[1], -across[0], 0.0])
    s, n, z = _local(points - origin, along, across)
    ones = np.column_stack([np.ones_like(s), s, z])

    def plane(chosen: np.ndarray) -> np.ndarray:
        found: np.ndarray = np.linalg.lstsq(ones[chosen], n[chosen], rcond=None)[0]
        return found

    def off(face: np.ndarray, chosen: np.ndarray) -> np.ndarray:
        rest: np.ndarray = n[chosen] - ones[chosen] @ face
        return rest

    sides = _sides((points - origin) @ normal) if thickness is None else [np.arange(len(points))]
    if normal @ across < 0.0:
        sides = sides[::-1]
    faces, fits, used = [], [], []
    for name, side in zip(("back face", "front face"), sides, strict=False):
        face, own, fit = _robust(name, side, ones[:, 1:], plane, off)
        faces.append(face)
        fits.append(fit)
        used.append(own)
    back = faces[0]
    front = faces[1] if thickness is None else back + np.array([thickness, 0.0, 0.0])
    own = np.concatenate(used)
    between = float((front - back) @ np.array([1.0, float(np.median(s[own])), float(np.median(z[own]))]))
    _refuse_other_shapes(fits, between, thickness, "a wall between two planes")
    kept = np.concatenate([own[np.abs(off(face, own)) <= OTHER * between] for face, own in zip(faces, used, strict=True)])
    return WallFit(origin, along, across, back, front, _ends(s[kept]), _ends(z[kept]), tuple(fits))


def fit_barrel(points: np.ndarray, thickness: float | None = None, axis: float | None = None) -> BarrelFit:
    """The barrel of points (n, 3) [m] on intrados and extrados, or on the intrados if its thickness [m] is given.

    axis [rad]: direction of its horizontal axis in plan from x; the direction of least misfit where None. Circles are of least squares
    of the distances, without points farther than three standard deviations; the misfit and the ends count these points too, except stray
    ones. BadGeometry where the points have another shape.
    """
    origin = np.median(points, axis=0)
    local = points - origin
    few = local[:: -(-len(points) // TRIES)]
    if axis is None:
        axis = _least(lambda a: _misfit(few, a, thickness is None))
    way = np.array([np.cos(axis), np.sin(axis), 0.0])
    along = np.array([way[1], -way[0], 0.0])
    s, t, z = _local(local, along, way)
    flat = np.column_stack([s, z])

    def circle(chosen: np.ndarray) -> np.ndarray:
        return _circle(flat[chosen])

    def off(found: np.ndarray, chosen: np.ndarray) -> np.ndarray:
        return np.hypot(*(flat[chosen] - found[:2]).T) - found[2]

    whole = circle(np.arange(len(flat)))
    sides = _sides(off(whole, np.arange(len(flat)))) if thickness is None else [np.arange(len(flat))]
    places = np.column_stack([whole[2] * np.arctan2(*(flat - whole[:2]).T), t])
    found = [_robust(name, side, places, circle, off) for name, side in zip(("intrados", "extrados"), sides, strict=False)]
    inner = found[0][0]
    outer = found[1][0] if thickness is None else inner + np.array([0.0, 0.0, thickness])
    fits = tuple(fit for _, _, fit in found)
    between = float(outer[2] - inner[2])
    _refuse_other_shapes(fits, between, thickness, "a circular barrel with a horizontal axis")
    kept = [own[np.abs(off(face, own)) <= OTHER * between] for face, own, _ in found]
    x, up = (flat[kept[0]] - inner[:2]).T
    low, high = _ends(np.arctan2(x, up))  # from the crown
    angle = (0.5 * np.pi - high, 0.5 * np.pi - low)
    return BarrelFit(origin, along, way, inner, outer, angle, _ends(t[np.concatenate(kept)]), fits)


def uncertain(fits: Sequence[Fit], thickness: float) -> tuple[str, ...]:
    """A remark where the greatest misfit is above a tenth of the thickness [m] of the body between the faces."""
    worst = max(fits, key=lambda fit: fit.most)
    if worst.most <= ROUGH * thickness:
        return ()
    return (
        (
            f"The points lie up to {1000.0 * worst.most:.3g} mm (95th percentile) from the fitted {worst.name}. This is more than a "
            f"tenth of the thickness of {1000.0 * thickness:.3g} mm, so the capacity of the fitted body is uncertain. Divide the points "
            "into parts of the fitted shape, or give the blocks as solids"
        ),
    )


def _refuse_other_shapes(fits: Sequence[Fit], thickness: float, given: float | None, shape: str) -> None:
    """BadGeometry where the greatest misfit is above a quarter of the thickness [m] between the faces; given [m]: in the deck."""
    worst = max(fits, key=lambda fit: fit.most)
    if worst.most <= OTHER * thickness:
        return
    cure = "If the points show one face only, give `thickness`" if given is None else "If the points show both faces, remove `thickness`"
    raise BadGeometry(
        f"the points lie up to {1000.0 * worst.most:.3g} mm (95th percentile) from the fitted {worst.name}, "
        f"which is more than a quarter of the thickness of {1000.0 * thickness:.3g} mm. {cure}. Otherwise "
        f"the points do not form {shape}: divide the points, or give the blocks as solids",
        ("structure", "scan", "thickness"),
    )


def _local(arm: np.ndarray, first: np.ndarray, second: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Coordinates of points (n, 3) along two horizontal unit vectors and upwards."""
    return arm @ first, arm @ second, arm[:, 2]


def _sides(distance: np.ndarray) -> list[np.ndarray]:
    """Numbers of the points of the nearer and the farther face, by their distances (n) [m]: parted halfway between both medians."""
    edge = float(np.mean(distance))
    for _ in range(50):
        low, high = distance[distance <= edge], distance[distance > edge]
        if not len(low) or not len(high):
            break
        edge = 0.5 * float(np.median(low) + np.median(high))
    return [np.flatnonzero(distance <= edge), np.flatnonzero(distance > edge)]


def _robust(
    name: str,
    side: np.ndarray,
    places: np.ndarray,
    fit: Callable[[np.ndarray], np.ndarray],
    off: Callable[[np.ndarray, np.ndarray], np.ndarray],
) -> tuple[np.ndarray, np.ndarray, Fit]:
    """A face of some points (numbers of side), its points without stray ones (numbers), and their misfit; BadGeometry below 50 points.

    places (n, 2) [m]: of all points along the face. fit: a face of numbered points; off: their distances [m] from a face.
    """
    if len(side) < FEWEST_POINTS // 2:
        raise BadGeometry(f"{name}: {len(side)} points are too few to fit a surface", ("structure", "scan"))
    kept = side
    for _ in range(20):
        face = fit(kept)
        rest = np.abs(off(face, side))
        near = rest <= max(OUTLIER * 1.4826 * float(np.median(rest)), LEAST_NOISE)
        again = side[near]
        if len(again) == len(kept) and (again == kept).all():
            break
        kept = again
    belongs = near | ~_strays(places[side], ~near)
    own = rest[belongs]
    fitted = Fit(name, len(own), len(side) - len(own), float(np.sqrt(np.mean(own**2))), float(np.percentile(own, 95)))
    return face, side[belongs], fitted


def _strays(places: np.ndarray, far: np.ndarray) -> np.ndarray:
    """Whether each point (n) at places (n, 2) along a face is far from it (n) alone: at most half of its neighbours are far from it."""
    from scipy.spatial import KDTree  # takes a third of a second to load

    found = far.copy()
    if far.any():
        around = KDTree(places).query(places[far], NEIGHBOURS + 1)[1]  # the point itself included
        found[far] = far[around].sum(axis=1) <= ALIKE + 1
    return found


def _circle(points: np.ndarray) -> np.ndarray:
    """Centre and radius (3) of the circle of least squares of the distances of points (n, 2) (Kasa's circle, then Gauss-Newton)."""
    middle = points.mean(axis=0)
    arm = points - middle
    a, b, c = np.linalg.lstsq(np.column_stack([2.0 * arm, np.ones(len(arm))]), (arm**2).sum(axis=1), rcond=None)[0]
    found = np.array([a, b, np.sqrt(max(c + a * a + b * b, 1e-12))])
    for _ in range(20):
        way = arm - found[:2]
        far = np.maximum(np.hypot(*way.T), 1e-12)
        step = np.linalg.lstsq(np.column_stack([way / far[:, None], np.ones(len(arm))]), far - found[2], rcond=None)[0]
        found = found + step
        if np.abs(step).max() < 1e-9 * abs(found[2]):
            break
    return found + np.array([*middle, 0.0])


def _misfit(points: np.ndarray, axis: float, two: bool) -> float:
    """Mean distance [m] of points (n, 3) from one circle, or of either face from its median distance, across an axis [rad]."""
    flat = np.column_stack([points @ np.array([np.sin(axis), -np.cos(axis), 0.0]), points[:, 2]])
    whole = _circle(flat)
    rest = np.hypot(*(flat - whole[:2]).T) - whole[2]
    if two:
        low, high = _sides(rest)
        rest[low] -= np.median(rest[low])
        rest[high] -= np.median(rest[high])
    return float(np.mean(np.abs(rest)))


def _least(misfit: Callable[[float], float]) -> float:
    """The direction [rad] of least misfit within half a turn."""
    from scipy.optimize import minimize_scalar  # takes a third of a second to load

    tries = np.radians(np.arange(0.0, 180.0, 5.0))
    best = float(tries[int(np.argmin([misfit(float(a)) for a in tries]))])
    return float(minimize_scalar(misfit, bounds=(best - 0.1, best + 0.1), method="bounded", options={"xatol": 1e-5}).x)


def _ends(values: np.ndarray) -> tuple[float, float]:
    """Both ends of evenly scattered values: percentiles, which few stray points do not move, and the shares beyond them."""
    low, high = np.percentile(values, [ENDS, 100.0 - ENDS]).tolist()
    beyond = (high - low) * ENDS / (100.0 - 2.0 * ENDS)
    return low - beyond, high + beyond
