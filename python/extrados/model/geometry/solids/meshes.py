"""Files of meshes as stones: OBJ, STL, models that a library reads, assemblies of COMPAS. Each stone is a union of closed convex meshes."""

import itertools
import re
import struct
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from extrados.model.errors import BadGeometry
from extrados.model.geometry.compas import FARTHEST, mesh_of, nodes_of
from extrados.model.geometry.drawing import UNITS
from extrados.model.geometry.solids.assembly import MOST_SOLIDS, MOST_TOLD, Stone
from extrados.model.geometry.solids.contacts import near_pairs
from extrados.model.geometry.solids.polyhedra import ManyFaces, Polyhedron, fitted, hull, moments, overlap_depth
from extrados.schema.contained import Unreadable, read_contained
from extrados.schema.files import BadFile, File

#: Formats of models in space that a library reads, and this library
MODELS = {".glb": ["trimesh"], ".gltf": ["trimesh"], ".ifc": ["ifcopenshell", "ifcopenshell.geom"]}
MOST_VERTICES = 2_000_000
MOST_CORNERS = 2_000  # of a convex body: bodies that overlap are compared edge by edge
MOST_POINTS = 10_000  # of its mesh: Qhull takes the square of those on a circle, and hears no signal meanwhile
CONVEX = 1e-4  # of its volume: what the hull of a convex body may have more
PLANE = 1e-5  # how far facets of one face of a mesh may turn
SAME_PLANE = 1e-12  # of facets that Qhull has in one plane
MERGED = 1e-6  # of the size of a file: corners of STL triangles nearer than this are one


@dataclass
class Mesh:
    """A closed surface: its name, points (n, 3), faces as numbers of them, the stone that it is a part of, and whether it
    is ground."""

    name: str
    points: np.ndarray
    faces: list[list[int]] = field(default_factory=list)
    stone: str = ""
    ground: bool = False


def read_meshes(file: File) -> list[Mesh]:
    """Meshes of an OBJ, STL, glTF or IFC file, read in a contained process; BadGeometry gives the reason if the file cannot be read."""
    name, sort = file.path.name, file.path.suffix.lower()
    reader = "extrados.model.geometry.solids." + ("models:parse_model" if sort in MODELS else "meshes:parse_meshes")
    try:
        found = read_contained(reader, file.content, MODELS.get(sort, ()), name=name, sort=sort)
    except Unreadable as error:
        raise BadGeometry(str(error) if error.at else f"{name}: {error}", error.at or ("structure",)) from None
    return [Mesh(**mesh) for mesh in found]


def parse_meshes(content: bytes, name: str, sort: str) -> list[dict[str, Any]]:
    """The fields of each Mesh of an OBJ or STL. The contained process calls this; Unreadable gives the reason."""
    try:
        if sort == ".stl":
            return [asdict(mesh) for mesh in read_stl(content, name)]
        return [asdict(mesh) for mesh in read_obj(File(Path(name), content).text(), name)]
    except BadGeometry as error:
        raise Unreadable(str(error), error.at) from None
    except BadFile as error:
        raise Unreadable(str(error)) from None


def read_obj(text: str, name: str) -> list[Mesh]:
    """Meshes of a Wavefront OBJ: an object `o` is a stone, its groups `g` are convex parts of it; without either, what
    hangs together is a stone."""
    points: list[list[float]] = []
    rows: dict[tuple[str, str], list[list[int]]] = {}
    here = ("", "")
    for number, line in enumerate(text.splitlines(), start=1):
        words = line.split()
        if not words or words[0].startswith("#"):
            continue
        where = f"{name}:{number}"
        if words[0] == "v":
            points.append(_numbers(words[1:4], where, "a vertex of three numbers"))
            if len(points) > MOST_VERTICES:
                raise BadGeometry(f"{where}: more than {MOST_VERTICES} vertices")
        elif words[0] == "o":
            here = (" ".join(words[1:]) or f"object {len(rows) + 1}", "")
        elif words[0] == "g":
            here = (here[0], " ".join(words[1:]))
        elif words[0] == "f":
            try:
                face = [int(word.split("/")[0]) for word in words[1:]]
            except ValueError:
                raise BadGeometry(f"{where}: a face must give its vertices by numbers, found '{line.strip()[:40]}'") from None
            face = [k - 1 if k > 0 else len(points) + k for k in face]
            if len(face) < 3 or min(face) < 0 or max(face) >= len(points):
                raise BadGeometry(f"{where}: a face has a vertex that does not exist, or fewer than three vertices")
            rows.setdefault(here, []).append(face)
    if not rows:
        raise BadGeometry(f"{name}: holds no faces")
    xyz = np.array(points).reshape(-1, 3)
    found: list[Mesh] = []
    for (stone, part), faces in rows.items():
        for piece in _shells(faces):
            title = stone or part or f"block {len(found) + 1}"
            found.append(Mesh(part or title, *_alone(xyz, piece), stone or part))
    if all(not m.stone for m in found):
        for k, mesh in enumerate(found, start=1):
            mesh.name = mesh.stone = f"block {k}"
    return found


def read_stl(content: bytes, name: str) -> list[Mesh]:
    """Meshes of an STL, as text or binary: each `solid` of the text that has a name of its own, and what hangs together."""
    solids = _stl_text(content, name) if _is_text(content) else {"": _stl_binary(content, name)}
    found: list[Mesh] = []
    for title, pieces in shells_of_triangles(solids, name).items():
        for points, faces in pieces:
            own = title if title and len(pieces) == 1 else f"block {len(found) + 1}"
            found.append(Mesh(own, points, faces, own))
    return found


def shells_of_triangles(solids: dict[str, np.ndarray], name: str) -> dict[str, list[tuple[np.ndarray, list[list[int]]]]]:
    """Closed surfaces, as points (n, 3) and faces, of each solid of triangles (n, 3, 3); corners that lie together are one."""
    size = max(float(np.ptp(t.reshape(-1, 3), axis=0).max()) for t in solids.values())
    if not size * MERGED > 0.0:
        raise BadGeometry(f"{name}: all corners of the body have the same position")
    found = {}
    for title, triangles in solids.items():
        corners = triangles.reshape(-1, 3)
        _, first, inverse = np.unique(np.round(corners / (MERGED * size)), axis=0, return_index=True, return_inverse=True)
        faces = [f for f in inverse.reshape(-1, 3).tolist() if len(set(f)) == 3]
        found[title] = [_alone(corners[first], piece) for piece in _shells(faces)]
    return found


def read_solids(value: Any, name: str) -> list[Mesh]:
    """Meshes of the JSON of a COMPAS assembly, a stone for each node, of whose mesh what hangs together is a convex part; supports
    are ground."""
    nodes = nodes_of(value, name)
    found = []
    for key, node in nodes.items():
        points, faces = mesh_of(node, f"{name}: block {key}")
        title, pieces = f"block {key}", _shells(faces)
        for k, piece in enumerate(pieces, start=1):
            own = title if len(pieces) == 1 else f"part {k} of {title}"
            found.append(Mesh(own, *_alone(points, piece), title, bool(node.get("is_support"))))
    return found


def _alone(points: np.ndarray, faces: Sequence[Sequence[int]]) -> tuple[np.ndarray, list[list[int]]]:
    """The points that faces name, and the faces by their numbers among these."""
    used = sorted({k for face in faces for k in face})
    number_of = {k: i for i, k in enumerate(used)}
    return points[used], [[number_of[k] for k in face] for face in faces]


def stones_of(meshes: Sequence[Mesh], density: float, unit: str | None, name: str, tolerance: float = 0.0) -> list[Stone]:
    """Stones of meshes in a unit (metres unless one is given), of a density [kg/m^3]; tolerance [m]: of contacts, half of
    which corners may lie off the plane of their face, and of a convex body.

    BadGeometry names the meshes that are open, flat or not convex.
    """
    if len(meshes) > MOST_SOLIDS:
        raise BadGeometry(f"{name}: the file has {len(meshes)} bodies; at most {MOST_SOLIDS} are allowed")
    scale = UNITS[unit or "m"]
    stones: dict[str, list[Polyhedron]] = {}
    grounds: dict[str, bool] = {}
    wrong: list[str] = []
    for mesh in meshes:
        try:
            stones.setdefault(mesh.stone, []).append(convex_body(scale * mesh.points, mesh.faces, 0.5 * tolerance))
            grounds[mesh.stone] = mesh.ground
        except ValueError as error:
            wrong.append(f"{mesh.name} {error}")
    wrong += [fault for title, parts in stones.items() if (fault := _within_itself(title, parts, tolerance))]
    if wrong:
        more = f"; and {len(wrong) - MOST_TOLD} more" if len(wrong) > MOST_TOLD else ""
        raise BadGeometry(f"{name}: " + "; ".join(wrong[:MOST_TOLD]) + more)
    return [Stone(title, parts, density, grounds[title]) for title, parts in stones.items()]


def without_doubles(stones: Sequence[Stone], tolerance: float) -> tuple[list[Stone], tuple[str, ...]]:
    """The stones, of those drawn twice the first, and a remark on them. Two are one where each corner of either lies within the
    tolerance [m], or rounding, of a corner of the other."""
    from scipy.spatial import KDTree  # takes a third of a second to load

    points = [np.concatenate([part.vertices for part in stone.parts]) for stone in stones]
    middle = np.array([0.5 * (p.min(axis=0) + p.max(axis=0)) for p in points])
    size = float(np.ptp(np.concatenate(points), axis=0).max())
    near = max(tolerance, MERGED * size)
    doubled: dict[int, int] = {}
    for i, j in sorted(KDTree(middle).query_pairs(2.0 * near)):
        if i in doubled or j in doubled:
            continue
        both = KDTree(points[i]).query(points[j])[0].max(), KDTree(points[j]).query(points[i])[0].max()
        if max(both) <= near:
            doubled[j] = i
    if not doubled:
        return list(stones), ()
    told = ", ".join(f"{stones[j].name} as {stones[i].name}" for j, i in list(doubled.items())[:MOST_TOLD])
    more = f" and {len(doubled) - MOST_TOLD} more" if len(doubled) > MOST_TOLD else ""
    kept = [stone for k, stone in enumerate(stones) if k not in doubled]
    return kept, (f"{len(doubled)} blocks are drawn twice and counted once: {told}{more}",)


def _within_itself(title: str, parts: Sequence[Polyhedron], tolerance: float) -> str:
    """The fault of a stone whose parts overlap by more than a tolerance [m] and so would weigh twice; else nothing."""
    if len(parts) < 2:
        return ""
    low, high = (np.array([getattr(part, end) for part in parts]) for end in ("low", "high"))
    pairs = near_pairs(low, high, np.arange(len(parts)), 0.0)
    depth = max((overlap_depth(parts[i], parts[j]) for i, j in pairs.tolist()), default=0.0)
    least = max(tolerance, MERGED * float(np.ptp([low.min(axis=0), high.max(axis=0)], axis=0).max()))
    return f"{title}: two parts of the block overlap by {1e3 * depth:.3g} mm" if depth > least else ""


def convex_body(points: np.ndarray, faces: Sequence[Sequence[int]], within: float = 0.0) -> Polyhedron:
    """The convex body around a closed mesh that lies within a distance [m] of it, faces with corners so far off a plane made
    one; ValueError says in words why there is none."""
    if len(points) > MOST_POINTS:
        raise ValueError(f"has {len(points)} points; at most {MOST_POINTS} are considered: draw it with fewer points")
    around_edge: dict[tuple[int, int], list[int]] = {}
    for k, face in enumerate(faces):
        for i, j in _edges(face):
            around_edge.setdefault((min(i, j), max(i, j)), []).append(k)
    open_edges = sum(len(there) != 2 for there in around_edge.values())
    if open_edges:
        raise ValueError(
            f"is not closed: {open_edges} edges do not have a face on both sides. Close the surface, or write "
            "blocks that share corners as separate objects (`o`) of an OBJ file"
        )
    turned = _turned(faces, around_edge)
    triangles = np.array([(f[0], b, c) for f in turned for b, c in itertools.pairwise(f[1:])])
    if not np.ptp(points, axis=0).all():
        raise ValueError("is flat: its volume is zero")
    volume = abs(moments(points, triangles)[0])
    fine = f"has more than {MOST_CORNERS} corners, the limit of this program: draw it with fewer corners"
    try:
        # more faces have more corners, by Euler; faces are made one by the fit of all of their corners where that is known
        whole = hull(points, SAME_PLANE if within > 0.0 else PLANE, 2 * MOST_CORNERS)
    except ManyFaces:
        raise ValueError(fine) from None
    except ValueError:
        raise ValueError("is flat: its volume is zero") from None
    if len(whole.vertices) > MOST_CORNERS:
        raise ValueError(fine)
    around = moments(whole.vertices, whole.triangles)[0]
    if volume < (1.0 - CONVEX) * around and _dent(whole, points, triangles) > within:
        raise ValueError(
            f"is not convex: its convex hull has {100.0 * (around / volume - 1.0):.3g} % more volume. Divide it into convex "
            "parts; in an OBJ file, as groups `g` of one object `o`"
        )
    return fitted(whole, within)


def _dent(whole: Polyhedron, points: np.ndarray, triangles: np.ndarray) -> float:
    """How deep a mesh lies below the hull around it [m], at its corners and in the middle of its edges: along an edge from hull
    to hull the depth is at most twice as much."""
    middles = 0.5 * (points[triangles] + points[np.roll(triangles, -1, axis=1)]).reshape(-1, 3)
    places = np.concatenate([points[np.unique(triangles)], middles])
    depth = np.full(len(places), np.inf)
    for normal, offset in zip(whole.normals, whole.offsets, strict=True):
        depth = np.minimum(depth, offset - places @ normal)
    return float(depth.max())


def _edges(face: Sequence[int]) -> list[tuple[int, int]]:
    return list(zip(face, [*face[1:], face[0]], strict=True))


def _turned(faces: Sequence[Sequence[int]], around: dict[tuple[int, int], list[int]]) -> list[list[int]]:
    """Faces that all turn as the first of their piece does: files do not always see to that."""
    found: dict[int, list[int]] = {}
    for first in range(len(faces)):
        if first in found:
            continue
        found[first] = list(faces[first])
        waiting = [first]
        while waiting:
            here = waiting.pop()
            for i, j in _edges(found[here]):
                other = next((k for k in around[min(i, j), max(i, j)] if k != here), here)
                if other not in found:
                    face = list(faces[other])
                    found[other] = face[::-1] if (i, j) in _edges(face) else face
                    waiting.append(other)
    return [found[k] for k in range(len(faces))]


def _shells(faces: list[list[int]]) -> list[list[list[int]]]:
    """Faces by closed surface, in their order. Stones that touch may share corners in a file that writes one after the other: a
    surface ends where all of its edges have met twice."""
    found: list[list[list[int]]] = []
    for piece in _pieces(faces):
        shells: list[list[list[int]]] = [[]]
        single: set[tuple[int, int]] = set()
        for face in piece:
            shells[-1].append(face)
            single ^= {(min(i, j), max(i, j)) for i, j in _edges(face)}
            if not single:
                shells.append([])
        found += [piece] if shells[-1] else shells[:-1]
    return found


def _pieces(faces: list[list[int]]) -> list[list[list[int]]]:
    """Faces by what hangs together through common vertices, in their order."""
    parent: dict[int, int] = {}

    def root(k: int) -> int:
        while parent.setdefault(k, k) != k:
            parent[k] = parent[parent[k]]
            k = parent[k]
        return k

    for face in faces:
        for k in face[1:]:
            parent[root(k)] = root(face[0])
    found: dict[int, list[list[int]]] = {}
    for face in faces:
        found.setdefault(root(face[0]), []).append(face)
    return list(found.values())


def _numbers(words: Sequence[str], where: str, what: str) -> list[float]:
    try:
        values = [float(w) for w in words]
    except ValueError:
        values = []
    if len(values) != 3 or not np.isfinite(values).all() or max(map(abs, values)) > FARTHEST:
        raise BadGeometry(f"{where}: expected {what}, found '{' '.join(words)[:40]}'")
    return values


def _is_text(content: bytes) -> bool:
    """Binary files may begin with `solid` too: what counts is whether their length fits."""
    if len(content) >= 84 and len(content) == 84 + 50 * struct.unpack("<I", content[80:84])[0]:
        return False
    return content[:512].lstrip().startswith(b"solid") and b"facet" in content


def _stl_binary(content: bytes, name: str) -> np.ndarray:
    """Triangles (n, 3, 3)."""
    count = struct.unpack("<I", content[80:84])[0] if len(content) >= 84 else -1
    if count < 1 or len(content) < 84 + 50 * count:
        raise BadGeometry(f"{name}: this file is neither a text STL file nor a binary STL file of the right length")
    if 3 * count > MOST_VERTICES:
        raise BadGeometry(f"{name}: the file has {count} triangles; at most {MOST_VERTICES // 3} are allowed")
    row = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("extra", "<u2")])
    found = np.frombuffer(content, row, count, 84)["corners"].astype(float)
    if not (np.abs(found) <= FARTHEST).all():  # NaN too
        raise BadGeometry(f"{name}: the file contains corners that are not numbers up to {FARTHEST:g}")
    return found


def _stl_text(content: bytes, name: str) -> dict[str, np.ndarray]:
    """Triangles (n, 3, 3) of each solid; those without a name of their own together."""
    text = content.decode("utf-8", errors="replace")
    rows: dict[str, list[list[float]]] = {}
    title = ""
    for number, line in enumerate(text.splitlines(), start=1):
        words = line.split()
        if words[:1] == ["solid"]:
            title = re.sub(r"\s+", " ", line.strip()[5:]).strip()
        elif words[:1] == ["vertex"]:
            rows.setdefault(title, []).append(_numbers(words[1:], f"{name}:{number}", "a vertex of three numbers"))
    for solid, corners in rows.items():
        if len(corners) % 3 or not corners:
            raise BadGeometry(f"{name}: solid '{solid}' has {len(corners)} corners, which do not form triangles")
    if not rows:
        raise BadGeometry(f"{name}: holds no triangles")
    if sum(map(len, rows.values())) > MOST_VERTICES:
        raise BadGeometry(f"{name}: this file has more than {MOST_VERTICES // 3} triangles")
    return {solid: np.array(corners).reshape(-1, 3, 3) for solid, corners in rows.items()}
