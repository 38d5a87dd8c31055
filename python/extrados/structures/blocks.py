"""Free polygons as a structure: from a deck, a JSON file or a drawing."""

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from extrados.structures.assembly import Assembly
from extrados.structures.builder import BadGeometry
from extrados.structures.contacts import find_contacts
from extrados.structures.polygons import crosses_itself, following, properties, signed_area

LARGEST_FILE = 20_000_000  # bytes
MOST_BLOCKS = 20_000
MOST_POINTS = 2_000
UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001, "in": 0.0254, "ft": 0.3048}


@dataclass(frozen=True)
class Polygon:
    """A block before its joints are known: vertices (n, 2) [m] either way round; density None: the structure's."""

    name: str
    points: np.ndarray
    density: float | None = None


#: No structure reaches farther [m]
FARTHEST = 1e5


def make_blocks(
    polygons: list[Polygon],
    ground: np.ndarray | None,
    density: float = 2000.0,
    depth: float = 1.0,
    tolerance: float = 1e-4,
) -> Assembly:
    """Blocks whose shared edges are the joints. ground: segments (k, 4) [m], or None for the lowest level."""
    if not polygons:
        raise BadGeometry("there are no blocks")
    names = [p.name for p in polygons]
    if len(set(names)) < len(names):
        twice = next(n for n in names if names.count(n) > 1)
        raise BadGeometry(f"two blocks are called '{twice}'")
    outlines = [_outline(p, tolerance) for p in polygons]
    if ground is None:
        lowest = min(float(o[:, 1].min()) for o in outlines)
        left = min(float(o[:, 0].min()) for o in outlines)
        right = max(float(o[:, 0].max()) for o in outlines)
        ground = np.array([[left - 1.0, lowest, right + 1.0, lowest]])
    contacts = find_contacts(outlines, np.asarray(ground, dtype=float).reshape(-1, 4), tolerance, names)
    if not (contacts.b < 0).any():
        raise BadGeometry("no block touches the ground: give `ground` segments where the supports are")
    area, centroid, polar = zip(*map(properties, outlines), strict=True)
    rho = np.array([density if p.density is None else p.density for p in polygons]) * depth
    assembly = Assembly(
        outlines=outlines,
        mass=np.array(area) * rho,
        centroid=np.array(centroid),
        inertia=np.array(polar) * rho,
        p=contacts.p,
        q=contacts.q,
        a=contacts.a,
        b=contacts.b,
        depth=depth,
        block_names=names,
        joint_names=[
            f"{names[a]} on {'the ground' if b < 0 else names[b]}" for a, b in zip(contacts.a, contacts.b, strict=True)
        ],
        inward=np.ones(len(contacts.a), dtype=int),
    )
    _refuse_loose(assembly, contacts.near)
    return assembly


def _outline(polygon: Polygon, tolerance: float) -> np.ndarray:
    points = np.asarray(polygon.points, dtype=float)
    if not (np.abs(points) <= FARTHEST).all():  # NaN too
        raise BadGeometry(f"block '{polygon.name}': a vertex lies farther than {FARTHEST:g} m from the origin")
    if len(points) > 1 and np.allclose(points[0], points[-1], atol=tolerance, rtol=0.0):
        points = points[:-1]
    apart = np.hypot(*(following(points) - points).T) > tolerance if len(points) else np.array([], bool)
    points = points[apart]
    if not 3 <= len(points) <= MOST_POINTS:
        raise BadGeometry(f"block '{polygon.name}': {len(points)} distinct vertices, expected 3 to {MOST_POINTS}")
    if crosses_itself(points):
        raise BadGeometry(f"block '{polygon.name}': its outline crosses itself")
    area = signed_area(points)
    if abs(area) < tolerance * float(np.ptp(points, axis=0).max()):
        raise BadGeometry(f"block '{polygon.name}': it has no area to speak of ({abs(area):.3g} m^2)")
    return points if area > 0.0 else points[::-1]


def _refuse_loose(assembly: Assembly, near: list[tuple[int, int, float]]) -> None:
    """Name blocks that no joint leads to the ground from, and the gaps that may be to blame."""
    reached = set(assembly.a[assembly.b < 0].tolist())
    pairs = [(a, b) for a, b in zip(assembly.a.tolist(), assembly.b.tolist(), strict=True) if b >= 0]
    neighbours: dict[int, list[int]] = {}
    for a, b in pairs:
        neighbours.setdefault(a, []).append(b)
        neighbours.setdefault(b, []).append(a)
    front = list(reached)
    while front:
        front = [n for block in front for n in neighbours.get(block, []) if n not in reached and not reached.add(n)]
    loose = [i for i in range(len(assembly.mass)) if i not in reached]
    if not loose:
        return
    names = assembly.block_names
    shown = ", ".join(f"'{names[i]}'" for i in loose[:5]) + (f" and {len(loose) - 5} more" if len(loose) > 5 else "")
    gaps = [
        f"'{names[i]}' and '{names[j]}' are {1000.0 * gap:.3g} mm apart"
        for i, j, gap in near
        if i in loose or j in loose
    ]
    hint = f"; near misses: {'; '.join(gaps[:3])} (see contact_tolerance)" if gaps else ""
    raise BadGeometry(f"no joint leads from the ground to block{'s' if len(loose) > 1 else ''} {shown}{hint}")


def read_json(path: Path) -> tuple[list[Polygon], np.ndarray | None]:
    """Blocks and ground of {"unit": "m", "blocks": [{"name", "points", "density"}], "ground": [[x, y, x, y]]}."""
    try:
        if path.stat().st_size > LARGEST_FILE:
            raise BadGeometry(f"{path.name}: larger than {LARGEST_FILE / 1e6:g} MB")
        data = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise BadGeometry(f"{path.name}: cannot be read: {error.strerror or error}") from None
    except (ValueError, RecursionError) as error:
        raise BadGeometry(f"{path.name}: is not JSON: {error}") from None
    if not isinstance(data, dict) or not isinstance(data.get("blocks"), list):
        raise BadGeometry(f'{path.name}: expected an object with a list "blocks"')
    if unknown := set(data) - {"unit", "blocks", "ground", "title"}:
        raise BadGeometry(f"{path.name}: unknown key '{sorted(unknown)[0]}'; known are unit, title, blocks, ground")
    unit = data.get("unit", "m")
    if not isinstance(unit, str) or unit not in UNITS:
        raise BadGeometry(f"{path.name}: unit {unit!r}; expected one of {', '.join(UNITS)}")
    scale = UNITS[unit]
    if len(data["blocks"]) > MOST_BLOCKS:
        raise BadGeometry(f"{path.name}: {len(data['blocks'])} blocks, at most {MOST_BLOCKS}")
    polygons = []
    for i, entry in enumerate(data["blocks"]):
        name = entry.get("name", f"block {i + 1}") if isinstance(entry, dict) else None
        if not isinstance(entry, dict) or not isinstance(name, str) or set(entry) - {"name", "points", "density"}:
            raise BadGeometry(
                f"{path.name}: blocks[{i}]: expected an object with points and, if wished, name and density"
            )
        density = entry.get("density")
        if density is not None and (
            isinstance(density, bool) or not isinstance(density, int | float) or not 0.0 < density < 3e4
        ):
            raise BadGeometry(f"{path.name}: block '{name}': density {density!r}, expected kg/m^3 above 0")
        polygons.append(
            Polygon(name, scale * _numbers(entry.get("points"), 2, f"{path.name}: block '{name}': points"), density)
        )
    ground = data.get("ground")
    return polygons, None if ground is None else scale * _numbers(ground, 4, f"{path.name}: ground")


def _numbers(value: object, width: int, where: str) -> np.ndarray:
    try:
        array = np.array(value, dtype=float)
    except (TypeError, ValueError):
        array = np.empty(0)
    if array.ndim != 2 or array.shape[1] != width or not np.isfinite(array).all():
        raise BadGeometry(f"{where}: expected a list of lists of {width} numbers")
    return array
