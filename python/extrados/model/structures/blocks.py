"""Free polygons as a structure: from a deck, a JSON file, an assembly of COMPAS or a drawing."""

from collections import Counter
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field, model_validator

from extrados.model.errors import BadGeometry, NoView
from extrados.model.files import LARGEST_FILE, read
from extrados.model.geometry.assembly import Assembly
from extrados.model.geometry.chains import with_chains
from extrados.model.geometry.clouds import CLOUDS
from extrados.model.geometry.compas import is_compas, read_compas
from extrados.model.geometry.contacts import MOST_NEIGHBOURS, box_pairs, shortest_joint
from extrados.model.geometry.drawing import Drawing, Layer, Plane, Polygon, parsed, read_json
from extrados.model.geometry.dxf import SAGITTA, read_dxf
from extrados.model.geometry.inspection import Inspection, areas, inspect, refuse
from extrados.model.geometry.linework import MOST_PAIRS
from extrados.model.geometry.polygons import properties
from extrados.model.geometry.solids.flat import flat_plane, section_of_meshes
from extrados.model.geometry.solids.meshes import MODELS, read_meshes
from extrados.model.structure import Structure
from extrados.model.structures.earthwork import Fill, Spandrels, Surfacing, covered, refuse_without_fill
from extrados.model.structures.scan import Scan
from extrados.schema.constants import IN_SPACE
from extrados.schema.quantities import Density, Length
from extrados.schema.table import Table, key

SOLID = (".obj", ".stl", *MODELS)  # files of solids, which have no plane section
SMALL = 1e-4  # of the size of solids: the greatest tolerance that is a default
MARKS = 0.01  # m: how far a line that marks joints may lie from their middles


def make_blocks(
    polygons: list[Polygon], ground: np.ndarray | None, density: float = 2000.0, depth: float = 1.0, tolerance: float = 1e-4
) -> Assembly:
    """Blocks whose shared edges are the joints, with the chains found among them. ground: segments (k, 4) [m], or None for the lowest level."""
    return assemble(inspect(Drawing(polygons), ground, tolerance), density, depth)


def assemble(inspection: Inspection, density: float, depth: float) -> Assembly:
    """The blocks of a survey [kg/m^3, m]; BadGeometry with all that is amiss."""
    refuse(inspection)
    names, contacts, polygons = inspection.names, inspection.contacts, inspection.drawing.blocks
    area, centroid, polar = areas(inspection)
    rho = np.array([density if p.density is None else p.density for p in polygons]) * depth
    joint_names = [f"{names[a]} on {'the ground' if b < 0 else names[b]}" for a, b in zip(contacts.a, contacts.b, strict=True)]
    several = {name for name, count in Counter(joint_names).items() if count > 1}
    seen: Counter[str] = Counter()
    for j, name in enumerate(joint_names):
        if name in several:  # two blocks may meet along several faces
            seen[name] += 1
            joint_names[j] = f"{name} ({seen[name]})"
    assembly = Assembly(
        outlines=inspection.outlines,
        mass=area * rho,
        centroid=centroid,
        inertia=polar * rho,
        p=contacts.p,
        q=contacts.q,
        a=contacts.a,
        b=contacts.b,
        depth=depth,
        block_names=names,
        joint_names=joint_names,
        inward=np.ones(len(contacts.a), dtype=int),
        materials=[p.material if p.density is None else None for p in polygons],
        groups=_groups(inspection),
        tolerance=inspection.tolerance,
        remarks=tuple(inspection.remarks()),
        notes=tuple(inspection.notes()),
    )
    return with_chains(assembly)


def _groups(inspection: Inspection) -> dict[str, list[int]]:
    """Joints by layer: those between stones of one layer, and those that lines of a layer mark."""
    contacts, found = inspection.contacts, {}
    layers = [p.layer for p in inspection.drawing.blocks]
    for layer in sorted({name for name in layers if name}):
        own = np.array([name == layer for name in layers])
        found[layer] = np.flatnonzero((contacts.b >= 0) & own[contacts.a] & own[contacts.b]).tolist()
    middle = 0.5 * (contacts.p + contacts.q)
    reach = max(MARKS, shortest_joint(inspection.tolerance))
    for layer, lines in inspection.drawing.marks.items():
        marked = _marked(middle, lines, reach)
        if not marked:
            raise BadGeometry(
                f"the lines of layer '{layer}' name no joint, because none of them passes within 10 mm of the middle of a joint"
            )
        found[layer] = marked
    return found


def _marked(places: np.ndarray, lines: np.ndarray, reach: float) -> list[int]:
    """The places (n, 2) that lines (k, 4) pass within reach [m]."""
    low = np.concatenate([places - reach, np.minimum(lines[:, :2], lines[:, 2:])])
    high = np.concatenate([places + reach, np.maximum(lines[:, :2], lines[:, 2:])])
    first, second = box_pairs(low, high, max(MOST_PAIRS, MOST_NEIGHBOURS * len(low)))
    met = (first < len(places)) & (second >= len(places))
    j, line = first[met], lines[second[met] - len(places)]
    a, along = line[:, :2], line[:, 2:] - line[:, :2]
    share = ((places[j] - a) * along).sum(axis=1) / np.maximum((along**2).sum(axis=1), 1e-300)
    off = a + np.clip(share, 0.0, 1.0)[:, None] * along - places[j]
    return np.unique(j[np.hypot(*off.T) <= reach]).tolist()


class BlockTable(Table):
    """One block of a free assembly."""

    name: str | None = key(None, "name of the block in results and messages", max_length=80)
    points: list[list[Length]] = key(about="vertices [x, y], in either sense of rotation", min_length=3, max_length=2000)
    density: Density | None = key(None, "density of the block, if it differs from [material]", gt=0, le=30000)


class LayerTable(Table):
    """A layer of the drawing that is more than plain stones of [material]."""

    name: str = key(about="name of the layer, in upper or lower case", max_length=255)
    role: Literal["stones", "ground", "joints", "left-out"] = key(
        "stones",
        "meaning of the layer. stones: blocks; ground: lines of the ground, like the layer GROUND; joints: lines along joints, so that "
        "[[joints.types]] can name these joints by the layer; left-out: the layer is not read",
    )
    material: str | None = key(None, "material of the blocks on this layer: a name in [materials]")

    @model_validator(mode="after")
    def _stones(self) -> "LayerTable":
        if self.material is not None and self.role != "stones":
            raise ValueError(f"material: a layer with role '{self.role}' has no material; expected role = \"stones\"")
        return self


class Blocks(Structure):
    """Plane assembly of polygons, or solids from a file. Edges or faces that lie on each other are the joints."""

    starter: ClassVar = {"block": '[{ name = "pier", points = [[0, 0], [1, 0], [1, 3], [0, 3]] }]'}
    word: ClassVar = "assembly of blocks"
    kind: Literal["blocks"]
    file: str | None = key(
        None,
        "file with the blocks, in the folder of the deck. Sections: JSON, COMPAS JSON or DXF; solids: OBJ, STL, glTF (GLB), IFC or "
        "COMPAS JSON; with [structure.scan], a point cloud: PLY, XYZ, LAS or LAZ",
        max_length=500,
    )
    unit: Literal["m", "cm", "mm", "in", "ft"] | None = key(
        None, "unit of the file, if the file gives none (DXF without $INSUNITS, COMPAS, OBJ, STL, point clouds)"
    )
    up: Literal["y", "z"] | None = key(
        None,
        "axis of a file of solids that points upward; default z, for glTF y. With y, the x axis remains, "
        "and the z axis of the file becomes -y",
    )
    section: Plane | None = key(
        None,
        "for a file in space: plane that is read as the section; its second letter is the vertical axis. If this key is "
        "given, solids of OBJ and STL that are prisms perpendicular to the plane are read as a section. Default for "
        "DXF, and for OBJ and STL without volume: the plane that contains all lines and faces",
    )
    layers: list[str] | None = key(None, "layers of the drawing that are read as blocks; default: all layers", max_length=200)
    layer: list[LayerTable] = key([], "layers of the drawing with a material or another meaning, [[structure.layer]]", max_length=200)
    join_tolerance: Length = key(
        1e-3, "ends of loose lines and arcs of a drawing that are closer than this distance are joined", gt=0, le=0.1
    )
    origin: Annotated[list[Length], Field(min_length=2, max_length=2)] | Literal["lower-left"] | None = key(
        None, 'point [x, y] of the file that becomes the origin, or "lower-left" of all blocks; for georeferenced surveys'
    )
    block: list[BlockTable] | None = key(None, "blocks of the structure, if no file is given", max_length=20000)
    ground: list[list[Length]] | None = key(
        None,
        "segments [x1, y1, x2, y2] that support the structure, in the coordinates of the blocks; default: the ground of "
        "the file, otherwise the lowest level",
        max_length=2000,
    )
    foundation_levels: list[Length] | None = key(
        None,
        "heights, in the coordinates of the blocks, at which horizontal soles without a block below are supports "
        "(foundations at different levels)",
        min_length=1,
        max_length=100,
    )
    contact_tolerance: Length = key(
        1e-4,
        "tolerance of contacts: faces that are closer than this value touch each other; overlaps below this value are ignored; contacts "
        "of solids with a width below this value carry no force. `check` reports the tolerance that would close each gap. The default for "
        "solids is at most 1/10000 of their size",
        gt=0,
        le=0.1,
    )
    mortar_gap: Length | None = key(
        None,
        "greatest thickness of joints that are drawn as gaps. The faces on both sides of such a joint are moved to the middle of the "
        "gap, so that the blocks touch. Default: gaps wider than `contact_tolerance` stay open",
        gt=0,
        le=0.1,
    )
    depth: Length | None = key(None, "depth out of plane; default: depth that the file gives, otherwise 1 m", gt=0)
    scan: Scan | None = key(None, "courses into which a scanned wall or barrel (a point cloud) is divided, and their blocks")
    fill: Fill | None = key(None, "soil over the blocks of a bridge, up to a level above the highest block")
    surfacing: Surfacing | None = key(None, "road surface or ballast on the fill")
    spandrels: Spandrels | None = key(None, "spandrel walls at the edges of the arches; only their weight is considered")

    @model_validator(mode="after")
    def _source(self) -> "Blocks":
        if (self.file is None) == (self.block is None):
            raise ValueError("expected either a file, or [[structure.block]] tables")
        for row in self.ground or []:
            if len(row) != 4:
                raise ValueError(f"ground: a row has {len(row)} numbers, expected 4")
        for i, block in enumerate(self.block or []):
            if any(len(point) != 2 for point in block.points):
                raise ValueError(f"block {i + 1}: a vertex does not have the form [x, y]")
        if (self.scan is None) == (self.file is not None and self.file.lower().endswith(CLOUDS)):
            raise ValueError(
                f"scan: [structure.scan] is required if `file` is a point cloud ({', '.join(CLOUDS)}); for other "
                f"files, remove [structure.scan]"
            )
        if self.unit is not None and self.file is not None and self.file.lower().endswith(tuple(MODELS)):
            raise ValueError(
                f"unit: {self.file} gives its own unit (IFC), or is in metres by its standard (glTF). Remove "
                "`unit`. If the size is wrong, scale the file in the program that wrote it"
            )
        refuse_without_fill(self.fill, self.surfacing, self.spandrels, self.depth)
        names = [layer.name.upper() for layer in self.layer]
        if len(set(names)) < len(names):
            raise ValueError("layer: two tables [[structure.layer]] were given for one layer")
        return self

    def _drawing(self, folder: Path) -> tuple[Drawing, float | None]:
        """What the file or the deck says, and the depth where the file has one."""
        if self.up is not None:
            raise NoView("the key `up` is only for files of solids, which have no plane section", ("structure", "up"))
        if self.file is None:
            polygons = [Polygon(b.name or f"block {i + 1}", np.array(b.points), b.density) for i, b in enumerate(self.block or [])]
            return Drawing(polygons), None
        file = read(self.file, LARGEST_FILE, folder)
        sort = file.path.suffix.lower()
        if sort == ".dxf":
            meaning = {layer.name: Layer(layer.role, layer.material) for layer in self.layer}
            fine = min(SAGITTA, max(0.5 * self.contact_tolerance, 1e-6))
            drawing = read_dxf(file, self.unit, self.layers, meaning, self.join_tolerance, fine, self.section)
            return drawing, None
        if self.section is not None and sort not in SOLID:
            raise BadGeometry(f"{self.file}: the key `section` is for .dxf files and files of solids", ("structure", "section"))
        if sort in CLOUDS:
            raise NoView(f"{self.file} contains a point cloud, which has no plane section; {IN_SPACE}", ("structure", "file"))
        if sort in SOLID:
            meshes = read_meshes(file)
            if plane := self.section or flat_plane(meshes):
                return section_of_meshes(meshes, plane, self.unit, file.path.name)
            raise NoView(f"{self.file} contains solids, which have no plane section; {IN_SPACE}", ("structure", "file"))
        if sort != ".json":
            raise BadGeometry(f"{self.file}: expected a .json, .dxf or {', '.join(SOLID)} file, or a point cloud ({', '.join(CLOUDS)})")
        if self.layers is not None or self.layer:
            raise BadGeometry(f"{self.file}: this file has no layers; layers belong to drawings (.dxf)")
        if is_compas(value := parsed(file)):
            return read_compas(value, file.path.name, self.unit)
        return read_json(file), None

    def _inspected(self, folder: Path) -> tuple[Inspection, float]:
        drawing, depth = self._drawing(folder)
        corner = np.array(self.origin) if isinstance(self.origin, list) else None
        if self.origin == "lower-left":
            corner = np.min([np.min(p.points, axis=0) for p in drawing.blocks], axis=0)
        if corner is not None:
            drawing = replace(
                drawing,
                marks={layer: lines - np.tile(corner, 2) for layer, lines in drawing.marks.items()},
                loose=tuple(((x - corner[0], y - corner[1]), gap) for (x, y), gap in drawing.loose),
            )
        ground = None if self.ground is None else np.array(self.ground)
        found = inspect(drawing, ground, self.contact_tolerance, self.foundation_levels, corner, self.mortar_gap or 0.0)
        return found, self.depth or depth or 1.0

    def inspection(self, folder: Path) -> Inspection | None:
        try:
            return self._inspected(folder)[0]
        except NoView:  # solids
            return None

    def mended(self, folder: Path) -> "Blocks | None":
        found = self.inspection(folder)
        tolerance = None if found is None else found.closing()
        return None if tolerance is None else self.model_copy(update={"contact_tolerance": tolerance})

    def assembly(self, density: float, folder: Path) -> Assembly:
        inspection, depth = self._inspected(folder)
        try:
            refuse_without_fill(self.fill, self.surfacing, self.spandrels, depth)
        except ValueError as error:  # the depth of the file, or the default
            raise BadGeometry(str(error)) from None
        made = assemble(inspection, density, depth)
        top = max(float(outline[:, 1].max()) for outline in made.outlines)
        return covered(made, top, density, self.fill, self.surfacing, self.spandrels)

    def weighed(self, made: Assembly, density: float, densities: Mapping[str, float]) -> Assembly:
        mass, inertia = made.mass.copy(), made.inertia.copy()
        for i, name in enumerate(made.materials):
            if name is not None:
                area, _, polar = properties(made.outlines[i])
                mass[i], inertia[i] = area * densities[name] * made.depth, polar * densities[name] * made.depth
        return replace(made, mass=mass, inertia=inertia)
