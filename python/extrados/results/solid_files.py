"""Files of solids for other programs: glTF for web pages and viewers, VTU series for ParaView."""

import json
import struct
from collections.abc import Sequence
from typing import Any, Protocol

import numpy as np

from extrados.results.vtu import pvd, vtu_faces

FRAMES = 11  # poses of a series, from rest to the last
SECONDS = 2.0  # that a mechanism takes in an animation
STONE = [0.91, 0.886, 0.831, 1.0]


class Solid(Protocol):
    """A convex body: vertices (n, 3) [m], faces as numbers of them counter-clockwise from outside."""

    @property
    def vertices(self) -> np.ndarray: ...

    @property
    def faces(self) -> tuple[tuple[int, ...], ...]: ...


def rotations(vectors: np.ndarray) -> np.ndarray:
    """Rotation matrices (n, 3, 3) of rotation vectors (n, 3) [rad] (Rodrigues)."""
    angle = np.linalg.norm(vectors, axis=1)
    axis = vectors / np.where(angle > 0.0, angle, 1.0)[:, None]
    cross = np.zeros((len(vectors), 3, 3))
    x, y, z = axis.T
    cross[:, 0, 1], cross[:, 0, 2], cross[:, 1, 2] = -z, y, -x
    cross -= cross.transpose(0, 2, 1)
    sin, cos = np.sin(angle)[:, None, None], np.cos(angle)[:, None, None]
    return np.eye(3) + sin * cross + (1.0 - cos) * (cross @ cross)


def quaternions(vectors: np.ndarray) -> np.ndarray:
    """Unit quaternions (n, 4) x, y, z, w of rotation vectors (n, 3) [rad]."""
    half = 0.5 * np.linalg.norm(vectors, axis=1)
    scale = 0.5 * np.sinc(half / np.pi)
    return np.column_stack([vectors * scale[:, None], np.cos(half)])


def scene_files(
    parts: Sequence[Solid], owner: np.ndarray, centroid: np.ndarray, names: Sequence[str], pose: np.ndarray
) -> dict[str, bytes]:
    """mechanism.glb, and mechanism.pvd with its VTU, from rest to a pose (nb, 6): shift [m] and rotation vector [rad]."""
    share = np.linspace(0.0, 1.0, FRAMES)
    poses = share[:, None, None] * pose
    return {"mechanism.glb": glb(parts, owner, centroid, names, SECONDS * share, poses)} | series(
        "mechanism", parts, owner, centroid, share, poses
    )


def glb(
    parts: Sequence[Solid], owner: np.ndarray, centroid: np.ndarray, names: Sequence[str], times: np.ndarray, poses: np.ndarray
) -> bytes:
    """A binary glTF 2.0: a node for each stone, named, its faces flat, moved from pose to pose (nt, nb, 6) at times (nt) [s].

    glTF has y up: x, y, z become x, z, -y by the scene's root.
    """
    chunks: list[bytes] = []
    views: list[dict[str, Any]] = []
    accessors: list[dict[str, Any]] = []

    def put(values: np.ndarray, kind: str, *, ends: bool = False) -> int:
        """The number of a new accessor of float32 rows."""
        raw = np.ascontiguousarray(values, dtype="<f4").tobytes()
        views.append({"buffer": 0, "byteOffset": sum(map(len, chunks)), "byteLength": len(raw)})
        chunks.append(raw)
        rows = np.asarray(values, dtype="<f4").reshape(len(values), -1)
        bounds = {"min": rows.min(axis=0).tolist(), "max": rows.max(axis=0).tolist()} if ends else {}
        accessors.append({"bufferView": len(views) - 1, "componentType": 5126, "count": len(rows), "type": kind, **bounds})
        return len(accessors) - 1

    nodes: list[dict[str, Any]] = []
    meshes, samplers, channels = [], [], []
    clock = put(times, "SCALAR", ends=True)
    moves = np.abs(poses).max(axis=(0, 2)) > 1e-9 * max(float(np.abs(poses).max()), 1e-300)
    for block, name in enumerate(names):
        points, normals = [], []
        for k in np.flatnonzero(owner == block).tolist():
            part = parts[k]
            for face in part.faces:
                corners = part.vertices[list(face)] - centroid[block]
                across = np.cross(corners[1] - corners[0], corners[2] - corners[0])
                fan = [corners[[0, i, i + 1]] for i in range(1, len(face) - 1)]
                points += fan
                normals += [np.tile(across / np.linalg.norm(across), (3, 1))] * len(fan)
        attributes = {"POSITION": put(np.concatenate(points), "VEC3", ends=True), "NORMAL": put(np.concatenate(normals), "VEC3")}
        meshes.append({"primitives": [{"attributes": attributes, "material": 0}]})
        nodes.append({"mesh": block, "name": name, "translation": centroid[block].tolist()})
        if moves[block]:
            for path, values, kind in (
                ("translation", centroid[block] + poses[:, block, :3], "VEC3"),
                ("rotation", quaternions(poses[:, block, 3:]), "VEC4"),
            ):
                samplers.append({"input": clock, "output": put(values, kind), "interpolation": "LINEAR"})
                channels.append({"sampler": len(samplers) - 1, "target": {"node": block, "path": path}})
    half = float(np.sqrt(0.5))
    nodes.append({"name": "z up", "rotation": [-half, 0.0, 0.0, half], "children": list(range(len(names)))})
    body = b"".join(chunks)
    scene = {
        "asset": {"version": "2.0", "generator": "extrados"},
        "scene": 0,
        "scenes": [{"nodes": [len(names)]}],
        "nodes": nodes,
        "meshes": meshes,
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{"byteLength": len(body)}],
        "materials": [{"pbrMetallicRoughness": {"baseColorFactor": STONE, "metallicFactor": 0.0, "roughnessFactor": 0.9}}],
        **({"animations": [{"name": "motion", "samplers": samplers, "channels": channels}]} if channels else {}),
    }
    head = json.dumps(scene, separators=(",", ":")).encode()
    head += b" " * (-len(head) % 4)
    body += b"\0" * (-len(body) % 4)
    total = 12 + 8 + len(head) + 8 + len(body)
    return b"".join(
        [
            struct.pack("<4sII", b"glTF", 2, total),
            struct.pack("<I4s", len(head), b"JSON"),
            head,
            struct.pack("<I4s", len(body), b"BIN\0"),
            body,
        ]
    )


def series(
    name: str, parts: Sequence[Solid], owner: np.ndarray, centroid: np.ndarray, times: np.ndarray, poses: np.ndarray
) -> dict[str, bytes]:
    """NAME.pvd and one VTU of all faces for each pose (nt, nb, 6), with stone and displacement."""
    points = np.concatenate([p.vertices for p in parts])
    whose = np.repeat(owner, [len(p.vertices) for p in parts])
    start = np.cumsum([0, *(len(p.vertices) for p in parts)])
    faces = [np.array(f) + k for p, k in zip(parts, start[:-1].tolist(), strict=True) for f in p.faces]
    block = np.repeat(owner, [len(p.faces) for p in parts])
    arm = points - centroid[whose]
    found: dict[str, bytes] = {}
    rows = []
    for k, (time, pose) in enumerate(zip(times.tolist(), poses, strict=True)):
        turned = np.einsum("nij,nj->ni", rotations(pose[:, 3:])[whose], arm)
        moved = centroid[whose] + pose[whose, :3] + turned
        file = f"{name}/frame_{k:04d}.vtu"
        found[file] = vtu_faces(moved, faces, {"displacement": moved - points}, {"stone": block})
        rows.append((time, file))
    found[f"{name}.pvd"] = pvd(rows)
    return found
