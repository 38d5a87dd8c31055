"""Drawings of buildings that are not plane sections of blocks: blocks in space, walls on a plan, elements of a wall. The user
can rotate them; a sentence states why there is no thrust line."""

from typing import Any

import numpy as np

from extrados.analyses.limit.solids import scene_arrays
from extrados.model.errors import BadGeometry, NoView
from extrados.model.geometry.solids.assembly import SolidAssembly
from extrados.schema.constants import GRAVITY
from extrados.views.building import Building
from extrados.views.mesh.mesh import EDGES, Mesh
from extrados.views.mesh.options import MeshOptions
from extrados.views.shell.mesh import ShellMesh
from extrados.views.shell.options import ShellOptions

#: Elements of a wall beyond which its drawing would be all lines
MOST_ELEMENTS = 60_000
#: Of faces in space: what they are, by which they are coloured
TONES = {"wall": 0, "floor": 1}
Drawn = tuple[dict[str, Any], dict[str, np.ndarray]]


def seen(building: Building, mesh: Any = None) -> Drawn | None:
    """Words and arrays of the first available model: solids, shells or elements; None without any. mesh: [analysis.mesh] of the
    deck's analysis of finite elements."""
    try:
        return of_solids(building.solids())
    except NoView:
        pass
    try:
        return of_shells(building.shell(mesh if isinstance(mesh, ShellOptions) else None))
    except NoView:
        pass
    try:
        return of_elements(building.mesh(mesh if isinstance(mesh, MeshOptions) else None))
    except BadGeometry:
        return None


def of_solids(assembly: SolidAssembly) -> Drawn:
    """Blocks in space: `vertex` (nv, 3) [m], `face` numbers of vertices one face after the other, `face_start`,
    `face_body` whose they are, `body_centre` (nb, 3) [m], `body_mass` (nb) [kg], `contact_body` (nj, 2) the blocks of each contact, -1 for
    the ground, and its area `contact_area` (nj) [m^2]."""
    found = {name: array.numbers for name, array in scene_arrays(assembly).items()}
    vertex = found["solid_vertex"]
    words = {
        "sort": "space",
        "of": "solids",
        "blocks": len(assembly.mass),
        "joints": len(assembly.a),
        "names": assembly.block_names,
        "contacts": assembly.joint_names,
        "measures": assembly.measures,
        "weight_N": GRAVITY * float(assembly.mass.sum() + assembly.fill[:, 1].sum()),
        "size_m": np.ptp(vertex, axis=0).tolist(),
        "warnings": [*assembly.remarks, *assembly.notes],
    }
    return words, {
        "vertex": vertex,
        "face": found["solid_face"],
        "face_start": found["solid_face_start"],
        "face_body": found["solid_face_block"],
        "body_centre": found["solid_centroid"],
        "body_mass": assembly.mass,
        "contact_body": np.column_stack([assembly.a, assembly.b]),
        "contact_area": assembly.area,
    }


def of_shells(mesh: ShellMesh) -> Drawn:
    """Walls and floors by their elements: as `of_solids`, with `face_tone` of TONES and `bar` (n, 2, 3) [m]."""
    floors, walls = ({part.name for part in mesh.parts if part.bends is bends} for bends in (False, True))
    words = {
        "sort": "space",
        "of": "walls",
        "walls": len(walls),
        "floors": len(floors),
        "elements": mesh.elements(),
        "weight_N": GRAVITY * float(mesh.mass().sum()),
        "size_m": np.ptp(mesh.xyz, axis=0).tolist(),
        "warnings": mesh.warnings,
    }
    faces = [row for part in mesh.parts for row in part.connect]
    tone = [np.full(len(part.connect), TONES["wall" if part.bends else "floor"]) for part in mesh.parts]
    return words, {
        "vertex": mesh.xyz,
        "face": np.concatenate(faces),
        "face_start": np.cumsum([0, *map(len, faces)]),
        "face_tone": np.concatenate(tone).astype(np.uint8),
        "bar": np.array([mesh.xyz[list(bar.nodes)] for bar in mesh.bars]).reshape(-1, 2, 3),
    }


def of_elements(mesh: Mesh) -> Drawn:
    """A wall in its plane by its elements, in the same form as blocks: `outline`, `outline_start`; no joints. `held` (n, 2):
    nodes on supports; `ties`: ends of its bars [m]."""
    groups = [g.connect[:, : len(EDGES[g.kind])] for g in mesh.groups if g.law is None]
    count = sum(map(len, groups))
    words = {
        "sort": "elements",
        "of": "elements",
        "elements": count,
        "nodes": len(mesh.xy),
        "size_m": np.ptp(mesh.xy, axis=0).tolist(),
        "warnings": mesh.warnings,
    }
    if count > MOST_ELEMENTS:
        words["warnings"] = [*mesh.warnings, f"{count} elements are too many to draw on the page"]
        groups = []
    held = [mesh.nodes_at(place, "supports.held") for place in mesh.held]
    faces = [mesh.xy[row] for group in groups for row in group]
    none, corners = np.empty((0, 2)), np.concatenate([mesh.xy[:0], *faces])
    return words, {
        "outline": corners,
        "outline_start": np.cumsum([0, *map(len, faces)]),
        "centroid": none,
        "joint_p": none,
        "joint_q": none,
        "joint_block": np.empty((0, 2), dtype=int),
        "held": mesh.xy[np.unique(np.concatenate([*held, np.empty(0, dtype=int)]))],
    }
