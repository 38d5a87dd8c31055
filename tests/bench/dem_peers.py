"""The same blocks in MuJoCo and LMGC90 (extra `bench`): prisms of depth 1 m, plane motion."""

import ctypes
import sys
import time
from dataclasses import dataclass

import numpy as np

from extrados.core import dem
from extrados.core.ground import Ground
from extrados.schema.constants import GRAVITY

FRICTION, DENSITY = 2.0, 2000.0


@dataclass(frozen=True)
class Answer:
    """Wall time [s] of `simulated` [s], and displacement (time, 2) [m] of the followed block relative to the ground."""

    seconds: float
    time: np.ndarray
    moved: np.ndarray


def acceleration(ground: Ground, t: np.ndarray) -> np.ndarray:
    """Horizontal ground acceleration at times [m/s^2]."""
    k = np.clip(np.searchsorted(ground.breaks, t, side="right") - 1, 0, len(ground.breaks) - 2)
    tau = t - ground.breaks[k]
    a = ground.linear[k, 0, 0] + tau * ground.linear[k, 0, 1]
    for term in range(ground.terms):
        h = ground.harmonic[k, 0, term]
        a = a + (h[:, 0] + tau * h[:, 1]) * np.sin(h[:, 2] * tau + h[:, 3])
    return np.where((t >= ground.breaks[0]) & (t < ground.breaks[-1]), a, 0.0)


def _prism(part: np.ndarray) -> tuple[np.ndarray, list[list[int]]]:
    """Vertices and outward faces of a part between y = -0.5 and 0.5; its y is their z."""
    n = len(part)
    front = np.column_stack([part[:, 0], np.full(n, -0.5), part[:, 1]])
    back = np.column_stack([part[:, 0], np.full(n, 0.5), part[:, 1]])
    sides = [[i, (i + 1) % n, n + (i + 1) % n, n + i] for i in range(n)]
    return np.concatenate([front, back]), [list(range(n)), list(range(2 * n - 1, n - 1, -1)), *sides]


def mujoco(bodies: dem.Bodies, ground: Ground, end: float, dt: float, follow: int) -> Answer:
    """MuJoCo, plane joints, gravity carries the ground's acceleration; settled for 0.2 s first."""
    import mujoco as mj

    assets, world = [], []
    for k, (part, owner) in enumerate(zip(bodies.parts, bodies.owner, strict=True)):
        vertices = _prism(part - bodies.centroid[owner])[0]
        assets.append(f'<mesh name="m{k}" vertex="{" ".join(f"{v:.12g}" for v in vertices.ravel())}"/>')
        x, z = bodies.centroid[owner]
        joints = ""
        if bodies.mass[owner] > 0.0:
            joints = (
                f'<joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 0 1"/><joint type="hinge" axis="0 -1 0"/>'
                f'<inertial pos="0 0 0" mass="{bodies.mass[owner]:.12g}" diaginertia="{bodies.inertia[owner]:.12g} '
                f'{bodies.inertia[owner]:.12g} {bodies.inertia[owner]:.12g}"/>'
            )
        world.append(
            f'<body name="b{owner}" pos="{x:.12g} 0 {z:.12g}">{joints}<geom type="mesh" mesh="m{k}" friction="{FRICTION}"/></body>'
        )
    model = mj.MjModel.from_xml_string(
        f'<mujoco><compiler inertiafromgeom="false"/><option timestep="{dt}" integrator="implicitfast" cone="elliptic" '
        f'solver="Newton" iterations="50" impratio="10"/><size memory="500M"/><default><geom condim="3" solref="{2 * dt} 1" '
        f'solimp="0.99 0.999 0.0001"/></default><asset>{"".join(assets)}</asset><worldbody>{"".join(world)}</worldbody></mujoco>'
    )
    data = mj.MjData(model)
    model.opt.gravity[:] = (0.0, 0.0, -GRAVITY)
    for _ in range(round(0.2 / dt)):
        mj.mj_step(model, data)
    data.qvel[:] = 0.0
    steps = round(end / dt)
    pull = acceleration(ground, dt * (np.arange(steps) + 0.5))
    place = np.empty((steps, 2))
    start = data.qpos[3 * follow : 3 * follow + 2].copy()
    gravity, qpos, step = model.opt.gravity, data.qpos, mj.mj_step
    begin = time.perf_counter()
    for n in range(steps):
        gravity[0] = -pull[n]
        step(model, data)
        place[n] = qpos[3 * follow : 3 * follow + 2]
    seconds = time.perf_counter() - begin
    return Answer(seconds, dt * np.arange(1, steps + 1), place - start)


def lmgc90(bodies: dem.Bodies, ground: Ground, end: float, dt: float, follow: int) -> Answer:
    """LMGC90 (Moreau-Jean, NLGS); one run in a process."""
    shapes = [_prism(part) for part in bodies.parts]
    fixed = [mass == 0.0 for mass in bodies.mass]
    seconds, time_axis, moved = lmgc90_of(shapes, fixed, DENSITY, FRICTION, (ground, None), end, dt)
    return Answer(seconds, time_axis, moved[:, follow, ::2])


def lmgc90_of(
    shapes: list[tuple[np.ndarray, list[list[int]]]],
    fixed: list[bool],
    density: float,
    friction: float,
    grounds: tuple[Ground, Ground | None],
    end: float,
    dt: float,
    settle: float = 0.1,
    patience: float = np.inf,
) -> tuple[float, np.ndarray, np.ndarray]:
    """Seconds that its steps take, times (t) [s], displacements (t, bodies, 3) [m] against the supports, which the velocities of the
    ground along x and y drive; as far as `patience` [s] lets it. Convex shapes: vertices, faces."""
    from compas_lmgc90 import _lmgc90
    from compas_lmgc90.solver import Solver

    solver = Solver(dt=dt, theta=0.5, density=density)
    # Room for faces of many corners, as its own words ask for; the wrapper does not hand it through.
    ctypes.CDLL(_lmgc90.__file__).__prprx_MOD_set_size_factor_polyr_prprx(ctypes.byref(ctypes.c_int(64)))
    solver.geometry_from_v_f([{"vertices": np.asarray(v).tolist(), "faces": [list(f) for f in g]} for v, g in shapes])
    t = np.arange(0.0, end + settle + 10 * dt, dt)
    fine = np.arange(0.0, end + 10 * dt, 0.1 * dt)
    drives = {}
    for component, ground in zip(("Vx", "Vy"), grounds, strict=True):
        drives[component] = 0.0
        if ground is not None:
            velocity = np.concatenate([[0.0], np.cumsum(acceleration(ground, fine + 0.05 * dt)) * 0.1 * dt])[: len(fine)]
            drives[component] = np.array([t, np.where(t < settle, 0.0, np.interp(t - settle, fine, velocity))])
    for k in np.flatnonzero(fixed):
        for component in ("Vx", "Vy", "Vz", "Rx", "Ry", "Rz"):
            solver.apply_velocity(int(k), component, drives.get(component, 0.0))
    solver.contact_law("IQS_CLB", friction)
    solver.preprocess()
    step = solver.lmgc90.compute_one_step
    support = int(np.flatnonzero(fixed)[0])

    def place() -> np.ndarray:
        now = np.array(state.bodies)
        return now - now[support]

    for _ in range(round(settle / dt)):
        state = step()
    start = place()
    seconds, moved = 0.0, []
    for _ in range(round(end / dt)):
        begin = time.perf_counter()
        state = step()
        seconds += time.perf_counter() - begin
        moved.append(place() - start)
        if seconds > patience:
            break
    return seconds, dt * np.arange(1, len(moved) + 1), np.array(moved)


if __name__ == "__main__":  # LMGC90 keeps one simulation in a process, and may end it
    from bench_dem import CASES

    name, end, dt = sys.argv[1], float(sys.argv[2]), float(sys.argv[3])
    case = CASES[name]
    answer = lmgc90(case.bodies(1e11, 1e-3), case.ground, end, dt, case.follow)
    np.savez(sys.argv[4], seconds=answer.seconds, time=answer.time, moved=answer.moved)
