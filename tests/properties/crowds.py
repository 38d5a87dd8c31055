"""Contacts of many bodies in the core, which depend on no unit, direction, handedness or number; blows at joints; what the floor holds."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from asking import Broken, Deck, ask, at_most, must, near
from buildings import changed, decks, drawn, moved, number
from conservation import building, moments
from geometry import stars
from hypothesis import reject
from hypothesis import strategies as st
from kernels import inertia_of
from relations import RIGID, ok, relation
from scipy.optimize import nnls
from scipy.spatial.transform import Rotation

from extrados.core import dem, dem3
from extrados.core import mechanism as core_mechanism
from extrados.core.errors import CoreError
from extrados.model.geometry import convex
from extrados.model.geometry.compas import section_of
from extrados.model.geometry.solids.assembly import mass_properties
from extrados.model.geometry.solids.polyhedra import box
from extrados.views.rigid import rigid_bodies

DRAWS = st.integers(0, 10**6)
#: Powers of two by which lengths, times and masses are multiplied: the numbers of a run change only by these factors
POWERS = [0.25, 0.5, 2.0, 4.0]


def crowd(draw: np.random.Generator, flush: bool, rigid: bool) -> dict[str, Any]:
    """Two to four convex bodies above each other over a support that moves: boxes face on face, or turned hulls that fall."""
    outlines = [np.array([[-6.0, -1.0], [6.0, -1.0], [6.0, 0.0], [-6.0, 0.0]])]
    high = 0.0
    for _ in range(int(draw.integers(2, 5))):
        if flush:
            half = draw.uniform(0.4, 0.8)
            hull = np.array([[-half, 0.0], [half, 0.0], [half, 0.6], [-half, 0.6]])
        else:
            angle = np.sort(draw.uniform(0.0, 2.0 * math.pi, 7))
            hull = convex.hull(draw.uniform(0.5, 1.0) * np.column_stack([np.cos(angle), 0.6 * np.sin(angle)]))
            hull = hull - np.array([0.0, hull[:, 1].min() - 0.01])
        hull = hull + np.array([draw.uniform(-0.2, 0.2), high])
        high = float(hull[:, 1].max())
        outlines.append(hull)
    count = len(outlines)
    middle = np.array([moments(o)[1] for o in outlines])
    return {
        "outlines": outlines,
        "middle": middle,
        "mass": np.array([0.0, *(2000.0 * moments(o)[0] for o in outlines[1:])]),
        "inertia": np.array([0.0, *(inertia_of(o) for o in outlines[1:])]),
        "rate": np.vstack([np.zeros(3), draw.uniform(-0.4, 0.4, (count - 1, 3)) * (0.2 if flush else 1.0)]),
        "stiffness": 10.0 ** draw.uniform(7.0, 8.5),
        "shear": draw.uniform(0.3, 0.8),
        "friction": float(draw.choice([0.0, 0.3, 0.7])),
        "cohesion": float(draw.choice([0.0, 2e4])) if flush and not rigid else 0.0,
        "damping": float(draw.choice([0.0, 1e-4])),
        "gravity": np.array([draw.uniform(-3.0, 3.0), -9.81]),
        "move": np.array([*draw.uniform(-0.05, 0.05, 2), 0.0 if flush else draw.uniform(-0.03, 0.03)]),
        "step": 2e-3 if rigid else 2e-4,
        "end": 0.2,
        "rigid": rigid,
        "rebound": float(draw.choice([0.0, 0.4])) if rigid else 0.0,
        "order": np.arange(count),
    }


def scaled(made: dict[str, Any], length: float, time: float, mass: float) -> dict[str, Any]:
    """The same in other units."""
    speed = np.array([length / time, length / time, 1.0 / time])
    force = mass * length / time**2
    return {
        **made,
        "outlines": [length * o for o in made["outlines"]],
        "middle": length * made["middle"],
        "mass": mass * made["mass"],
        "inertia": mass * length**2 * made["inertia"],
        "rate": made["rate"] * speed,
        "stiffness": made["stiffness"] * force / length**2,  # the depth stays 1
        "cohesion": made["cohesion"] * force / length,
        "damping": made["damping"] * time,
        "gravity": made["gravity"] * length / time**2,
        "move": made["move"] * [length, length, 1.0],
        "step": made["step"] * time,
        "end": made["end"] * time,
    }


def turned(made: dict[str, Any], turn: np.ndarray, shift: np.ndarray) -> dict[str, Any]:
    """The same turned, or in a mirror where the determinant of `turn` is -1, and elsewhere."""
    sense = round(float(np.linalg.det(turn)))

    def carried(x: np.ndarray) -> np.ndarray:
        return np.column_stack([x[:, :2] @ turn.T, sense * x[:, 2:]])

    return {
        **made,
        "outlines": [(o @ turn.T)[::sense] + shift for o in made["outlines"]],
        "middle": made["middle"] @ turn.T + shift,
        "rate": carried(made["rate"]),
        "gravity": turn @ made["gravity"],
        "move": carried(made["move"][None])[0],
    }


def renumbered(made: dict[str, Any], order: np.ndarray) -> dict[str, Any]:
    """The same with its bodies in another order."""
    there = {key: made[key][order] for key in ("middle", "mass", "inertia", "rate", "order")}
    return {**made, **there, "outlines": [made["outlines"][k] for k in order]}


def run_of(made: dict[str, Any]) -> dem.Run:
    """A run of it."""
    count, time = len(made["mass"]), made["end"] / 0.2
    law = dem.Law(
        made["stiffness"],
        made["shear"] * made["stiffness"],
        made["friction"],
        cohesion=made["cohesion"],
        tension=made["cohesion"],
        damping=made["damping"],
    )
    outer = [np.ones(len(o), bool) for o in made["outlines"]]
    above = [int(np.flatnonzero(made["order"] == k)[0]) for k in range(count)]
    joints = {(above[k], above[k + 1]): 0 for k in range(count - 1)} if made["cohesion"] else {}
    bodies = dem.Bodies(made["middle"], made["mass"], made["inertia"], made["outlines"], list(range(count)), outer, 1.0, [law], joints)
    x, y, turn = (float(v) for v in made["move"])
    move = dem.SupportMove(above[0], (x, y, turn), 0.02 * time, 0.15 * time)
    options = dem.Options(
        made["end"],
        0.05 * time,
        step=made["step"],
        gravity=tuple(float(g) for g in made["gravity"]),
        rigid=made["rigid"],
        rebound=made["rebound"],
        residual_limit=10.0,
    )
    return dem.run(bodies, options, shift=np.zeros((count, 3)), rate=made["rate"], moves=(move,))


def compare_runs(
    told: str, one: dem.Run, other: dem.Run, units: tuple, turn: np.ndarray, shift: np.ndarray, order: Any, within: float
) -> None:
    """Places, velocities and energies of two runs of the same crowd."""
    length, time, mass = units
    sense = round(float(np.linalg.det(turn)))
    must(one.reason == other.reason, f"{told}: {one.reason} and {other.reason}")
    back = np.argsort(order)
    place, rate = other.place[:, back], other.rate[:, back]
    near(f"{told}: places", place[..., :2] / length, one.place[..., :2] @ turn.T + shift, within, 1.0)
    near(f"{told}: rotations", sense * place[..., 2], one.place[..., 2], within, 1.0)
    near(f"{told}: velocities", rate[..., :2] * time / length, one.rate[..., :2] @ turn.T, 10.0 * within, 1.0)
    near(f"{told}: spins", sense * rate[..., 2] * time, one.rate[..., 2], 10.0 * within, 1.0)
    for name in ("kinetic", "elastic", "friction", "damping", "work"):
        scale = float(np.abs(one.energy["kinetic"]).max() + np.abs(one.energy["work"]).max()) + 100.0
        near(f"{told}: {name}", other.energy[name] * time**2 / (mass * length**2), one.energy[name], 20.0 * within, scale)


def mostly(numbers: list[int], holds: Callable[..., None], *how: Any) -> None:
    """Broken where it does not hold for three of five crowds: which edges touch is chosen anew when contacts are searched, whose time
    depends on boxes along the axes."""
    broken = []
    for number_of in numbers:
        try:
            holds(number_of, *how)
        except Broken as error:
            broken.append(error)
    if len(broken) > 2:
        raise broken[0]


FIVE = st.lists(DRAWS, min_size=5, max_size=5, unique=True)


@relation("dem", st.tuples(FIVE, st.booleans(), st.booleans()), 1e-6, share=1.0)
def crowds_in_the_plane(numbers: list, flush: bool, rigid: bool, within: float) -> None:
    """Bodies that fall, hit and rub do the same in other units, turned, in a mirror, elsewhere and in another order; their energies
    balance."""
    mostly(numbers, _same_crowd, flush, rigid, within)


def _same_crowd(number_of: int, flush: bool, rigid: bool, within: float) -> None:
    draw = np.random.default_rng(number_of)
    made = crowd(draw, flush, rigid)
    one = run_of(made)
    none, still, plain = np.eye(2), np.zeros(2), np.arange(len(made["mass"]))
    units = tuple(float(v) for v in draw.choice(POWERS, 3))
    compare_runs("units", one, run_of(scaled(made, *units)), units, none, still, plain, within)
    loose = 1e3 * within  # rigid contacts are solved within a tolerance, and edges chosen anew
    angle, far = draw.uniform(0.2, 6.0), draw.uniform(-5.0, 5.0, 2)
    turn = np.array([[math.cos(angle), -math.sin(angle)], [math.sin(angle), math.cos(angle)]])
    compare_runs("turned", one, run_of(turned(made, turn, far)), (1.0, 1.0, 1.0), turn, far, plain, loose)
    mirror = np.diag([-1.0, 1.0])
    compare_runs("mirrored", one, run_of(turned(made, mirror, still)), (1.0, 1.0, 1.0), mirror, still, plain, loose)
    order = draw.permutation(plain)
    compare_runs("renumbered", one, run_of(renumbered(made, order)), (1.0, 1.0, 1.0), none, still, order, loose)
    scale = float(np.abs(one.energy["kinetic"]).max() + np.abs(one.energy["work"]).max()) + 100.0
    at_most("residual", float(np.abs(one.energy["residual"]).max()), 0.0, 0.05, scale)


def solids(draw: np.random.Generator, flush: bool, rigid: bool) -> dict[str, Any]:
    """Two or three bodies in space above each other over a support that moves: boxes face on face, or turned ones that fall."""
    parts, high = [box((-6.0, -6.0, -1.0), (6.0, 6.0, 0.0))], 0.0
    for _ in range(int(draw.integers(2, 4))):
        half = draw.uniform(0.3, 0.7, 3)
        part = box(tuple(-half), tuple(half))
        if not flush:
            part = part.moved(Rotation.from_euler("xyz", draw.uniform(-180.0, 180.0, 3), degrees=True).as_matrix())
        low = float(part.vertices[:, 2].min())
        part = part.moved(np.eye(3), np.array([*draw.uniform(-0.15, 0.15, 2), high - low + (0.0 if flush else 0.01)]))
        high = float(part.vertices[:, 2].max())
        parts.append(part)
    count = len(parts)
    mass, middle, inertia = zip(*(mass_properties([part], 2000.0) for part in parts), strict=True)
    fixed = np.array([0.0, *[1.0] * (count - 1)])
    return {
        "vertices": [part.vertices for part in parts],
        "faces": [part.faces for part in parts],
        "middle": np.array(middle),
        "mass": np.array(mass) * fixed,
        "inertia": np.array(inertia) * fixed[:, None, None],
        "rate": fixed[:, None] * draw.uniform(-0.4, 0.4, (count, 6)) * (0.2 if flush else 1.0),
        "stiffness": 10.0 ** draw.uniform(7.0, 8.5),
        "shear": draw.uniform(0.3, 0.8),
        "friction": float(draw.choice([0.0, 0.3, 0.7])),
        "damping": float(draw.choice([0.0, 1e-4])),
        "gravity": np.array([*draw.uniform(-2.0, 2.0, 2), -9.81]),
        "move": draw.uniform(-0.03, 0.03, 3),
        "step": 2e-3 if rigid else 2e-4,
        "end": 0.1,
        "rigid": rigid,
        "rebound": float(draw.choice([0.0, 0.4])) if rigid else 0.0,
        "order": np.arange(count),
    }


def scaled_in_space(made: dict[str, Any], length: float, time: float, mass: float) -> dict[str, Any]:
    """The same in other units."""
    return {
        **made,
        "vertices": [length * v for v in made["vertices"]],
        "middle": length * made["middle"],
        "mass": mass * made["mass"],
        "inertia": mass * length**2 * made["inertia"],
        "rate": made["rate"] * np.repeat([length / time, 1.0 / time], 3),
        "stiffness": made["stiffness"] * mass / (time * length) ** 2,
        "damping": made["damping"] * time,
        "gravity": made["gravity"] * length / time**2,
        "move": made["move"] * length,
        "step": made["step"] * time,
        "end": made["end"] * time,
    }


def turned_in_space(made: dict[str, Any], turn: np.ndarray, shift: np.ndarray) -> dict[str, Any]:
    """The same turned, or in a mirror where the determinant of `turn` is -1, and elsewhere."""
    sense = round(float(np.linalg.det(turn)))
    return {
        **made,
        "vertices": [v @ turn.T + shift for v in made["vertices"]],
        "faces": [tuple(face[::sense] for face in faces) for faces in made["faces"]],
        "middle": made["middle"] @ turn.T + shift,
        "inertia": turn @ made["inertia"] @ turn.T,
        "rate": np.hstack([made["rate"][:, :3] @ turn.T, sense * made["rate"][:, 3:] @ turn.T]),
        "gravity": turn @ made["gravity"],
        "move": turn @ made["move"],
    }


def renumbered_in_space(made: dict[str, Any], order: np.ndarray) -> dict[str, Any]:
    """The same with its bodies in another order."""
    there = {key: made[key][order] for key in ("middle", "mass", "inertia", "rate", "order")}
    return {**made, **there, **{key: [made[key][k] for k in order] for key in ("vertices", "faces")}}


def run_in_space(made: dict[str, Any]) -> dem3.Run:
    """A run of it."""
    count, time = len(made["mass"]), made["end"] / 0.1
    law = dem3.Law(made["stiffness"], made["shear"] * made["stiffness"], made["friction"], damping=made["damping"])
    bodies = dem3.Solids(made["middle"], made["mass"], made["inertia"], made["vertices"], made["faces"], list(range(count)), [law])
    x, y, z = (float(v) for v in made["move"])
    move = dem3.SupportMove(int(np.flatnonzero(made["order"] == 0)[0]), (x, y, z), 0.02 * time, 0.07 * time)
    gx, gy, gz = (float(g) for g in made["gravity"])
    options = dem3.Options(
        made["end"], 0.02 * time, step=made["step"], gravity=(gx, gy, gz), rigid=made["rigid"], rebound=made["rebound"], residual_limit=10.0
    )
    return dem3.run(bodies, options, rate=made["rate"], moves=(move,))


def compare_in_space(
    told: str, one: dem3.Run, other: dem3.Run, units: tuple, turn: np.ndarray, shift: np.ndarray, order: Any, within: float
) -> None:
    """Places, velocities and energies of two runs of the same bodies in space."""
    length, time, mass = units
    sense = round(float(np.linalg.det(turn)))
    must(one.reason == other.reason, f"{told}: {one.reason} and {other.reason}")
    back = np.argsort(order)
    place, rate, attitude = other.place[:, back, :3], other.rate[:, back], other.turn[:, back]
    near(f"{told}: places", place / length, one.place[..., :3] @ turn.T + shift, within, 1.0)
    near(f"{told}: attitudes", attitude, turn @ one.turn @ turn.T, within, 1.0)
    near(f"{told}: velocities", rate[..., :3] * time / length, one.rate[..., :3] @ turn.T, 10.0 * within, 1.0)
    near(f"{told}: spins", sense * rate[..., 3:] * time, one.rate[..., 3:] @ turn.T, 10.0 * within, 1.0)
    for name in ("kinetic", "elastic", "friction", "damping", "work"):
        scale = float(np.abs(one.energy["kinetic"]).max() + np.abs(one.energy["work"]).max()) + 100.0
        near(f"{told}: {name}", other.energy[name] * time**2 / (mass * length**2), one.energy[name], 20.0 * within, scale)


@relation("dem", st.tuples(FIVE, st.booleans(), st.booleans()), 1e-6, share=1.0)
def crowds_in_space(numbers: list, flush: bool, rigid: bool, within: float) -> None:
    """Bodies in space that fall, hit and rub do the same in other units, turned, in a mirror, elsewhere and in another order; their
    energies balance."""
    mostly(numbers, _same_solids, flush, rigid, within)


def _same_solids(number_of: int, flush: bool, rigid: bool, within: float) -> None:
    draw = np.random.default_rng(number_of)
    made = solids(draw, flush, rigid)
    one = run_in_space(made)
    none, still, plain = np.eye(3), np.zeros(3), np.arange(len(made["mass"]))
    units = tuple(float(v) for v in draw.choice(POWERS, 3))
    compare_in_space("units", one, run_in_space(scaled_in_space(made, *units)), units, none, still, plain, within)
    loose, same = 1e3 * within, (1.0, 1.0, 1.0)
    turn, far = Rotation.random(random_state=number_of).as_matrix(), draw.uniform(-5.0, 5.0, 3)
    compare_in_space("turned", one, run_in_space(turned_in_space(made, turn, far)), same, turn, far, plain, loose)
    mirror = np.diag([-1.0, 1.0, 1.0])
    compare_in_space("mirrored", one, run_in_space(turned_in_space(made, mirror, still)), same, mirror, still, plain, loose)
    order = draw.permutation(plain)
    compare_in_space("renumbered", one, run_in_space(renumbered_in_space(made, order)), same, none, still, order, loose)
    scale = float(np.abs(one.energy["kinetic"]).max() + np.abs(one.energy["work"]).max()) + 100.0
    at_most("residual", float(np.abs(one.energy["residual"]).max()), 0.0, 0.05, scale)


@relation("rocking", st.tuples(DRAWS, st.integers(1, 4)), 1e-7, share=2.0)
def blows_at_joints(number_of: int, count: int, within: float) -> None:
    """After a blow at the joints of a column no joint overlaps or slides, and of all such velocities they are the nearest to those before."""
    draw = np.random.default_rng(number_of)
    half, high = draw.uniform(0.3, 0.8, count), draw.uniform(0.3, 1.5, count)
    mass = 2000.0 * 2.0 * half * high
    inertia = mass * ((2.0 * half) ** 2 + high**2) / 12.0
    level = np.concatenate([[0.0], np.cumsum(high)])
    centroid = np.column_stack([draw.uniform(-0.1, 0.1, count), level[:-1] + 0.5 * high])
    lean = draw.uniform(-0.2, 0.2, count)
    frame = np.array([[[math.sin(a), math.cos(a)], [math.cos(a), -math.sin(a)]] for a in lean])
    wide = np.minimum(half, np.concatenate([[np.inf], half[:-1]])) * draw.uniform(0.5, 1.0, count)
    ends = np.array([[[0.0, level[k]] - w * frame[k, 1], [0.0, level[k]] + w * frame[k, 1]] for k, w in enumerate(wide)])
    sides = np.array([[k, k - 1] for k in range(count)])
    before = draw.uniform(-1.0, 1.0, (count, 3))
    try:
        after = core_mechanism.inelastic_blow(mass, inertia, centroid, sides, ends, frame, before)
    except CoreError:
        reject()
    rows: list[list[np.ndarray]] = [[], []]
    for k in range(count):
        for end in ends[k]:
            for way in (0, 1):
                row = np.zeros((count, 3))
                for body, sense in ((k, 1.0), (k - 1, -1.0)):
                    if body >= 0:
                        x, y = end - centroid[body]
                        n = frame[k, way]
                        row[body] += sense * np.array([*n, x * n[1] - y * n[0]])
                rows[way].append(row.ravel())
    normal, along = np.array(rows[0]), np.array(rows[1])
    at_most("overlap", float((-normal @ after.ravel()).max()), 0.0, within, 1.0)
    near("sliding", along @ after.ravel(), np.zeros(len(along)), within, 1.0)
    weight = np.column_stack([mass, mass, inertia]).ravel()
    push = np.sqrt(weight) * (after - before).ravel()
    _, left = nnls(np.column_stack([normal.T, along.T, -along.T]) / np.sqrt(weight)[:, None], push)
    near("impulses", left, 0.0, 10.0 * within, float(np.linalg.norm(push)) + 1.0)
    own = np.column_stack([mass, mass, inertia])
    kept = [float((own * v**2).sum()) for v in (before, after)]
    near("energy", kept[0] - kept[1], float((own * (before - after) ** 2).sum()), 10.0 * within, kept[0])
    one, two = draw.uniform(-1.0, 1.0, (2, count, 3))
    near("projection", -core_mechanism.restitution(mass, inertia, one, two), (own * one * two).sum() / (own * two**2).sum(), 1e-9, 1.0)


@relation("dem", st.tuples(decks("block", "column", "arch", "frame"), number(-100.0, 100.0), number(0.0, 2.0)), 1e-9, share=1.0)
def floors_lie_under_all_that_falls(deck: Deck, dx: float, deep: float, within: float) -> None:
    """A floor reaches as far to the left as to the right of the building, wherever that lies, and lies at its height."""
    stones = building(moved(drawn(deck), lambda p: p + np.array([dx, 0.0]))).blocks()
    points = np.concatenate(stones.outlines)
    level = float(points[:, 1].min()) - deep
    made = rigid_bodies(stones, floor=level)
    extent = float(np.ptp(points, axis=0).max())
    held = np.concatenate([part for part in made.parts if abs(part[:, 1].max() - level) < 1e-6 * extent])
    left, right = points[:, 0].min() - held[:, 0].min(), held[:, 0].max() - points[:, 0].max()
    near("left and right", left, right, within, extent)
    must(left > 10.0 * extent, f"a floor {left} m beside a building of {extent} m")


@relation("", st.tuples(stars(), number(0.2, 2.0), st.sampled_from([0, 1, 2]), DRAWS), 1e-9, share=2.0)
def prisms_of_triangles(star: np.ndarray, depth: float, axis: int, number_of: int, within: float) -> None:
    """The section of a prism is the same whether its faces are polygons or cut into triangles."""
    outline = convex.hull(star)
    n = len(outline)
    plane = [k for k in (0, 1, 2) if k != axis]
    xyz = np.zeros((2 * n, 3))
    xyz[:n, plane], xyz[n:, plane] = outline, outline
    xyz[n:, axis] = depth
    sides = [[i, (i + 1) % n, n + (i + 1) % n, n + i] for i in range(n)]
    whole = [list(range(n)), list(range(2 * n - 1, n - 1, -1)), *sides]
    first = int(np.random.default_rng(number_of).integers(n))
    cut = [[f[0], f[i], f[i + 1]] for f in (whole[0][first:] + whole[0][:first], *whole[1:]) for i in range(1, len(f) - 1)]
    for faces in (whole, cut):
        found = section_of(xyz, faces, axis)
        must(found is not None, "no prism")
        if found is not None:
            near("depth", found[1], depth, within)
            near("area", moments(found[0])[0], moments(outline)[0], within)
            near("middle", moments(found[0])[1], moments(outline)[1], within, 1.0)
            must(len(found[0]) == n, f"{len(found[0])} corners of {n}")


@relation("dem", st.tuples(decks("block", "column"), number(0.1, 0.6), number(0.2, 0.9), st.booleans()), 0.0, share=0.5)
def runs_that_end_while_blocks_move(deck: Deck, amplitude: float, share: float, rigid: bool, within: float) -> None:
    """A run that ends while blocks move decides nothing, unless they have collapsed by then."""
    motion = {"kind": "sine-pulse", "amplitude": f"{amplitude} g", "period": 0.8}
    answer = ask(changed(deck, motion=motion), "dem", end_time=0.8 * share, perturbed=False, **(RIGID if rigid else {}))
    ok(answer)
    moving = bool(answer.results.still_moving)
    must(not moving or answer.outcome in ("open", "collapses"), f"the blocks still move: {answer.outcome}")
    if moving and answer.results.outcome != "collapse":
        must(answer.outcome == "open", f"no collapse, and the blocks still move: {answer.outcome}")


@relation("dem", st.tuples(FIVE, st.booleans()), 0.01, share=1.0)
def crowds_without_losses(numbers: list, stiff: bool, within: float) -> None:
    """Bodies in the plane that neither rub nor are damped balance their energy on soft and stiff joints while they fall, hit and roll
    over their corners; what springs give up as other edges meet is a loss."""
    for number_of in numbers:
        made = crowd(np.random.default_rng(number_of), False, False)
        plain = {"friction": 0.0, "damping": 0.0, "move": 0.0 * made["move"], "step": 2e-5, "end": 0.3}
        one = run_of({**made, **plain, **({"stiffness": 2e9} if stiff else {})})
        scale = float(np.abs(one.energy["kinetic"]).max()) + 100.0
        at_most("residual", float(np.abs(one.energy["residual"]).max()), 0.0, within, scale)
        at_most("gain by springs", -float(np.diff(one.energy["damping"], prepend=0.0).min()), 0.0, 1e-9, scale)


@relation("dem", FIVE, 1e-9, share=1.0)
def bodies_that_roll_over_corners(numbers: list, within: float) -> None:
    """A body that rolls over its corners on a floor without friction and dashpots loses nothing: a corner stays the same point of
    contact as the edges beside it take turns."""
    for number_of in numbers:
        draw = np.random.default_rng(number_of)
        made = crowd(draw, False, False)
        count = int(draw.integers(3, 8))
        angle = 2.0 * math.pi * (np.arange(count) + draw.uniform(-0.2, 0.2, count)) / count
        hull = draw.uniform(0.5, 1.0) * np.column_stack([np.cos(angle), draw.uniform(0.6, 1.0) * np.sin(angle)])
        outlines = [made["outlines"][0], hull - np.array([0.0, hull[:, 1].min() - 0.01])]
        alone = {
            "outlines": outlines,
            "middle": np.array([moments(o)[1] for o in outlines]),
            "mass": np.array([0.0, 2000.0 * moments(hull)[0]]),
            "inertia": np.array([0.0, inertia_of(hull)]),
            "rate": np.array([[0.0, 0.0, 0.0], [draw.uniform(-1.0, 1.0), 0.0, draw.uniform(-4.0, 4.0)]]),
            "stiffness": 10.0 ** draw.uniform(8.0, 9.5),
            "order": np.arange(2),
        }
        one = run_of({**made, **alone, "friction": 0.0, "damping": 0.0, "move": 0.0 * made["move"], "step": 5e-5, "end": 1.0})
        at_most("loss", float(one.energy["damping"][-1]), 0.0, within, float(np.abs(one.energy["kinetic"]).max()))
