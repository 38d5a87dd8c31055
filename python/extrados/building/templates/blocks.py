"""Free polygons as a structure: from a deck, a JSON file or a drawing."""

from pathlib import Path
from typing import ClassVar, Literal

import numpy as np
from pydantic import model_validator

from extrados.building.errors import BadGeometry
from extrados.building.files import read
from extrados.building.geometry.assembly import Assembly
from extrados.building.geometry.chains import with_chains
from extrados.building.geometry.contacts import find_contacts
from extrados.building.geometry.drawing import LARGEST_FILE, MOST_POINTS, Polygon, read_dxf, read_json
from extrados.building.geometry.polygons import crossing_edges, following, properties, signed_area
from extrados.building.structure import Structure
from extrados.schema.quantities import Density, Length
from extrados.schema.table import Table, key

FARTHEST = 1e5


def make_blocks(
    polygons: list[Polygon],
    ground: np.ndarray | None,
    density: float = 2000.0,
    depth: float = 1.0,
    tolerance: float = 1e-4,
) -> Assembly:
    """Blocks whose shared edges are the joints, with the chains found among them. ground: segments (k, 4) [m], or None for the lowest level."""
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
    return with_chains(assembly)


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
    if crossing_edges(points) is not None:
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
        front = list({n for block in front for n in neighbours.get(block, [])} - reached)
        reached.update(front)
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


class BlockTable(Table):
    """One block of a free assembly."""

    name: str | None = key(None, "name of the block in results and complaints", max_length=80)
    points: list[list[Length]] = key(about="vertices [x, y], either way round", min_length=3, max_length=2000)
    density: Density | None = key(None, "density, where it differs from the others", gt=0, le=30000)


class Blocks(Structure):
    """Any plane assembly of polygons; edges that lie on each other are the joints."""

    starter: ClassVar = {"block": '[{ name = "pier", points = [[0, 0], [1, 0], [1, 3], [0, 3]] }]'}
    word: ClassVar = "assembly of blocks"
    kind: Literal["blocks"]
    file: str | None = key(None, "JSON or DXF file with the blocks, beside the deck", max_length=500)
    unit: Literal["m", "cm", "mm", "in", "ft"] | None = key(
        None, "unit of a drawing that does not say (DXF without $INSUNITS)"
    )
    layers: list[str] | None = key(None, "layers of the drawing to read; default all", max_length=200)
    block: list[BlockTable] | None = key(None, "the blocks, where no file is given", max_length=20000)
    ground: list[list[Length]] | None = key(
        None, "segments [x1, y1, x2, y2] the structure stands on; default its lowest level", max_length=2000
    )
    contact_tolerance: Length = key(1e-4, "edges nearer than this touch", gt=0, le=0.1)
    depth: Length = key(1.0, "depth out of plane", gt=0)

    @model_validator(mode="after")
    def _source(self) -> "Blocks":
        if (self.file is None) == (self.block is None):
            raise ValueError("expected either a file or [[structure.block]] tables")
        for name, rows, width in (("ground", self.ground or [], 4),):
            for row in rows:
                if len(row) != width:
                    raise ValueError(f"{name}: a row has {len(row)} numbers, expected {width}")
        for i, block in enumerate(self.block or []):
            if any(len(point) != 2 for point in block.points):
                raise ValueError(f"block {i + 1}: a vertex is not [x, y]")
        return self

    def assembly(self, density: float, folder: Path) -> Assembly:
        ground = None
        if self.file is not None:
            suffix = Path(self.file).suffix.lower()
            if suffix not in (".dxf", ".json"):
                raise BadGeometry(f"{self.file}: expected a .json or .dxf file")
            file = read(self.file, LARGEST_FILE, folder)
            polygons, ground = read_dxf(file, self.unit, self.layers) if suffix == ".dxf" else read_json(file)
        else:
            polygons = [
                Polygon(b.name or f"block {i + 1}", np.array(b.points), b.density)
                for i, b in enumerate(self.block or [])
            ]
        if self.ground is not None:
            ground = np.array(self.ground)
        return make_blocks(polygons, ground, density, self.depth, self.contact_tolerance)
