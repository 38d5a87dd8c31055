"""The same blocks in space in MuJoCo and LMGC90 (extra `bench`).

In MuJoCo with free joints, boxes as its boxes, other parts as meshes. LMGC90 knows a body as one convex polyhedron: of a voussoir of many
parts the hull, which has the same joints and fills what its soffit is hollow by."""

import sys
import time
from dataclasses import dataclass

import numpy as np
from dem_peers import acceleration, lmgc90_of
from scipy.spatial import ConvexHull

from extrados.core.dem3 import Solids
from extrados.core.ground import Ground
from extrados.schema.constants import GRAVITY

SETTLE = 0.2  # seconds under gravity alone, before the motion
PATIENCE = 15.0  # seconds of processor time for a motion, and for settling before


@dataclass(frozen=True)
class Answer:
    """Wall and processor time [s] of the motion, times (t) [s], displacements (t, bodies, 3) [m] of the mobile bodies."""

    seconds: float
    processor: float
    time: np.ndarray
    moved: np.ndarray


def box_of(vertices: np.ndarray, faces: tuple[tuple[int, ...], ...]) -> tuple[np.ndarray, np.ndarray, np.ndarray] | None:
    """Centre, axes in the columns and half sizes of a part that is a box; None of another."""
    if len(vertices) != 8 or any(len(face) != 4 for face in faces):
        return None
    beside = {int(k) for face in faces if 0 in face for k in (face[face.index(0) - 1], face[(face.index(0) + 1) % 4])}
    edges = vertices[sorted(beside)] - vertices[0]
    size = np.linalg.norm(edges, axis=1)
    axes = (edges / size[:, None]).T
    if len(beside) != 3 or np.abs(axes.T @ axes - np.eye(3)).max() > 1e-9:
        return None
    if np.linalg.det(axes) < 0.0:
        axes, size = axes[:, [1, 0, 2]], size[[1, 0, 2]]
    return vertices.mean(axis=0), axes, 0.5 * size


def numbers(values: np.ndarray) -> str:
    return " ".join(f"{v:.12g}" for v in np.ravel(values))


def model_text(solids: Solids, dt: float) -> str:
    """The blocks as MuJoCo reads them; friction of the first law."""
    assets: list[str] = []
    geoms: dict[int, list[str]] = {}
    for k, owner in enumerate(solids.owner):
        vertices = np.asarray(solids.vertices[k]) - solids.centroid[owner]
        found = box_of(vertices, solids.faces[k])
        if found is None:
            assets.append(f'<mesh name="m{k}" vertex="{numbers(vertices)}"/>')
            geom = f'<geom type="mesh" mesh="m{k}"/>'
        else:
            centre, axes, half = found
            geom = f'<geom type="box" size="{numbers(half)}" pos="{numbers(centre)}" xyaxes="{numbers(axes[:, :2].T)}"/>'
        geoms.setdefault(owner, []).append(geom)
    world = []
    for b, parts in geoms.items():
        free = ""
        if solids.mass[b] > 0.0:
            i = solids.inertia[b]
            full = numbers(np.array([i[0, 0], i[1, 1], i[2, 2], i[0, 1], i[0, 2], i[1, 2]]))
            free = f'<freejoint/><inertial pos="0 0 0" mass="{solids.mass[b]:.12g}" fullinertia="{full}"/>'
        world.append(f'<body name="b{b}" pos="{numbers(solids.centroid[b])}">{free}{"".join(parts)}</body>')
    return (
        f'<mujoco><compiler inertiafromgeom="false"/><option timestep="{dt}" integrator="implicitfast" cone="elliptic" solver="Newton" '
        f'iterations="50" impratio="10"><flag multiccd="enable"/></option><size memory="900M"/><default><geom condim="3" '
        f'friction="{solids.laws[0].friction}" solref="{2 * dt} 1" solimp="0.99 0.999 0.0001"/></default>'
        f"<asset>{''.join(assets)}</asset><worldbody>{''.join(world)}</worldbody></mujoco>"
    )


def mujoco(solids: Solids, along: Ground, across: Ground | None, end: float, dt: float, every: int = 1) -> Answer:
    """A run from rest under the own weight, as far as PATIENCE lets it; gravity carries the ground's acceleration along x and y."""
    import mujoco as mj

    model = mj.MjModel.from_xml_string(model_text(solids, dt))
    data = mj.MjData(model)
    model.opt.gravity[:] = (0.0, 0.0, -GRAVITY)
    spent = time.process_time()
    for _ in range(round(SETTLE / dt)):
        mj.mj_step(model, data)
        if time.process_time() - spent > PATIENCE:
            break
    data.qvel[:] = 0.0
    steps = round(end / dt)
    middle = dt * (np.arange(steps) + 0.5)
    pull = np.array([acceleration(along, middle), np.zeros(steps) if across is None else acceleration(across, middle)])
    mobile = int(np.count_nonzero(solids.mass > 0.0))
    place = np.empty((steps // every, mobile, 3))
    start = data.qpos.reshape(-1, 7)[:, :3].copy()
    gravity, step = model.opt.gravity, mj.mj_step
    begin, spent = time.perf_counter(), time.process_time()
    for n in range(steps):
        gravity[:2] = -pull[:, n]
        step(model, data)
        if (n + 1) % every == 0:
            place[(n + 1) // every - 1] = data.qpos.reshape(-1, 7)[:, :3]
        if time.process_time() - spent > PATIENCE:
            place = place[: (n + 1) // every]
            break
    seconds, processor = time.perf_counter() - begin, time.process_time() - spent
    return Answer(seconds, processor, dt * every * np.arange(1, len(place) + 1), place - start)


def hull_of(points: np.ndarray) -> tuple[np.ndarray, list[list[int]]]:
    """Vertices and outward triangles of the convex hull of points."""
    hull = ConvexHull(points)
    kept, faces = np.unique(hull.simplices, return_inverse=True)
    vertices = points[kept]
    faces = faces.reshape(-1, 3)
    corners = vertices[faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    inward = (normal * (corners.mean(axis=1) - vertices.mean(axis=0))).sum(axis=1) < 0.0
    faces[inward] = faces[inward][:, ::-1]
    return vertices, faces.tolist()


def lmgc90(solids: Solids, along: Ground, across: Ground, end: float, dt: float) -> Answer:
    """A run from rest as far as PATIENCE lets it; one in a process."""
    owner = np.asarray(solids.owner)
    shapes, volume = [], 0.0
    for b, mass in enumerate(solids.mass):
        parts = np.flatnonzero(owner == b)
        points = np.concatenate([np.asarray(solids.vertices[k]) for k in parts])
        volume += ConvexHull(points).volume if mass > 0.0 else 0.0
        whole = (points, [list(face) for face in solids.faces[parts[0]]])
        shapes.append(whole if len(parts) == 1 else hull_of(points))
    density = float(np.sum(solids.mass)) / volume
    seconds, times, moved = lmgc90_of(
        shapes, (solids.mass == 0.0).tolist(), density, solids.laws[0].friction, (along, across), end, dt, SETTLE / 2, PATIENCE
    )
    return Answer(seconds, seconds, times, moved[:, solids.mass > 0.0])


if __name__ == "__main__":  # LMGC90 keeps one simulation in a process, and may end it
    from bench_dem3 import CASES, FRICTION, solids_of

    from extrados.core import dem3
    from extrados.core.dem_run import STILL

    case = CASES[sys.argv[1]]
    blocks = solids_of(case.assembly(), dem3.Law(case.stiffness, case.stiffness, FRICTION, damping=0.0))
    shaken = (STILL, case.ground) if case.way else (case.ground, STILL)
    answer = lmgc90(blocks, *shaken, case.seconds, float(sys.argv[2]))
    np.savez(sys.argv[3], seconds=answer.seconds, time=answer.time, moved=answer.moved)
