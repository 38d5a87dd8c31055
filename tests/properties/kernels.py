"""Compiled routines against conservation laws and their own kinematics, on random bodies and mechanisms."""

import math

import numpy as np
from asking import Deck, ask, at_most, must, near
from buildings import decks, number
from conservation import building, moments
from geometry import stars
from hypothesis import reject
from hypothesis import strategies as st
from relations import GRAVITY, RIGID, ok, relation
from scipy.optimize import linprog
from scipy.spatial.transform import Rotation

from extrados.core import dem, dem3
from extrados.core import mechanism as core_mechanism
from extrados.core.limit import BandFactor, least_vertex
from extrados.limit.errors import CannotStand
from extrados.model.errors import NoView
from extrados.model.geometry import convex
from extrados.model.geometry.solids.assembly import mass_properties
from extrados.model.geometry.solids.polyhedra import box, prism
from extrados.views.rockers.mechanism import MechanismModel

WAYS = st.fixed_dictionaries(
    {
        "rigid": st.booleans(),
        "friction": st.sampled_from([0.0, 0.3, 0.8]),
        "damping": st.sampled_from([0.0, 0.0, 1e-5]),
        "rebound": st.sampled_from([0.0, 0.5]),
    }
)
MOTION = st.tuples(number(0.3, 1.0), number(-2.0, 2.0), number(-2.0, 2.0), number(-0.3, 0.3))


@relation("dem", st.tuples(stars(), stars(), number(0.0, 360.0), MOTION, WAYS), 1e-6, share=5.0)
def blows_in_the_plane(one: np.ndarray, two: np.ndarray, angle: float, motion: tuple, how: dict, within: float) -> None:
    """In an impact of two free bodies momentum and angular momentum are conserved, the loss of energy is that of the energy balance, and the order of the bodies has no effect."""
    a, b = convex.hull(one), convex.hull(two)
    way = np.array([math.cos(math.radians(angle)), math.sin(math.radians(angle))])
    (_, first, _), (_, second, _) = moments(a), moments(b)
    a, b = a - first, b - second
    speed, spin_a, spin_b, aside = motion
    offset = aside * np.array([-way[1], way[0]])
    low = (b @ way).min()
    b = b + way * ((a @ way).max() - low + 0.01) + offset
    found = []
    for order in (1, -1):
        outlines = [a, b][::order]
        bodies = [moments(o) for o in outlines]
        mass = np.array([2000.0 * m[0] for m in bodies])
        inertia = np.array([inertia_of(o) for o in outlines])
        law = dem.Law(1e9, 5e8, how["friction"], damping=how["damping"])
        both = dem.Bodies(
            np.array([m[1] for m in bodies]), mass, inertia, outlines, [0, 1], [np.ones(len(o), bool) for o in outlines], 1.0, [law]
        )
        rate = np.array([[*(2.0 * speed * way), spin_a], [*(-speed * way), spin_b]])[::order]
        options = dem.Options(
            0.08,
            0.004,
            step=5e-6 if not how["rigid"] else 2e-4,
            gravity=(0.0, 0.0),
            rigid=how["rigid"],
            rebound=how["rebound"] if how["rigid"] else 0.0,
            residual_limit=10.0,
        )
        run = dem.run(both, options, shift=np.zeros((2, 3)), rate=rate)
        must(run.reason == "end", run.reason)
        momentum = (mass[:, None] * run.rate[:, :, :2]).sum(axis=1)
        size = float(np.abs(mass @ np.abs(rate[:, :2])).max()) + 1.0
        near("momentum", momentum, np.broadcast_to(mass @ rate[:, :2], momentum.shape), within, size)
        place, v = run.place, run.rate
        moment = (mass * (place[:, :, 0] * v[:, :, 1] - place[:, :, 1] * v[:, :, 0]) + inertia * v[:, :, 2]).sum(axis=1)
        near("moment of momentum", moment, np.full(len(moment), moment[0]), 5e-3, size * 3.0)
        kinetic = 0.5 * (mass * (v[:, :, :2] ** 2).sum(axis=2) + inertia * v[:, :, 2] ** 2).sum(axis=1)
        near("kinetic energy", run.energy["kinetic"], kinetic, 0.02, kinetic[0])
        left = run.energy["kinetic"] + run.energy["elastic"] + run.energy["friction"] + run.energy["damping"]
        if how["rigid"]:  # in the midst of a rebound half of its impulse is booked
            left = left[[0, -1]]
        near("ledger", left, np.full(len(left), left[0]), 0.02, kinetic[0])
        at_most("kinetic energy", kinetic[-1], kinetic[0], 5e-3)
        if how["friction"] == how["damping"] == 0.0 and not how["rigid"] and run.energy["elastic"][-1] < 1e-3 * kinetic[0]:
            near("without friction and damping", kinetic[-1], kinetic[0], 0.01)
        must(abs(run.energy["friction"][-1]) < 1e-3 * kinetic[0] or how["friction"] > 0.0, "friction loses without friction")
        found.append((run.place[-1][::order], run.rate[-1][::order], kinetic[-1]))
    near("places in another order", found[0][0], found[1][0], 5e-3, 1.0)
    near("energy in another order", found[0][2], found[1][2], 0.02)
    at = found[0][0]
    there = [_turned(o - moments(o)[1], p) for o, p in zip((a, b), at, strict=True)]
    must(convex.overlap_depth(*there) < 0.02, f"bodies pass through each other by {convex.overlap_depth(*there)} m")


def inertia_of(outline: np.ndarray) -> float:
    """Moment of inertia of 2000 kg/m^2 about the centre [kg m^2]."""
    _, centre, _ = moments(outline)
    p = outline - centre
    q = np.roll(p, -1, axis=0)
    cross = p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]
    return 2000.0 * float((cross * ((p * p).sum(axis=1) + (p * q).sum(axis=1) + (q * q).sum(axis=1))).sum()) / 12.0


def _turned(arm: np.ndarray, place: np.ndarray) -> np.ndarray:
    c, s = math.cos(place[2]), math.sin(place[2])
    return arm @ np.array([[c, s], [-s, c]]) + place[:2]


SIZES = st.tuples(number(0.5, 1.5), number(0.5, 1.5), number(0.5, 1.5))
TURNS = st.tuples(number(-180.0, 180.0), number(-180.0, 180.0), number(-180.0, 180.0))


@relation("dem", st.lists(st.tuples(SIZES, SIZES, TURNS, TURNS, MOTION, WAYS), min_size=6, max_size=6), 0.0, share=2.0)
def blows_in_space(cases: list, within: float) -> None:
    """In an impact of two free boxes by corners, edges or faces both momenta are conserved, the loss is that of the energy balance, and the order of the boxes has no effect."""
    for case in cases:
        _keeps_its_ledger(*case)


def _keeps_its_ledger(one: tuple, two: tuple, turn_a: tuple, turn_b: tuple, motion: tuple, how: dict) -> None:
    """Broken where a blow does not keep momentum, or does not lose what the ledger says."""
    speed, spin_a, spin_b, aside = motion
    way = np.array([1.0, 0.0, 0.0])
    first, second = (
        box(tuple(-0.5 * np.array(s)), tuple(0.5 * np.array(s))).moved(Rotation.from_euler("xyz", t, degrees=True).as_matrix())
        for s, t in ((one, turn_a), (two, turn_b))
    )
    gap = first.vertices[:, 0].max() - second.vertices[:, 0].min() + 0.005
    corner_a, corner_b = first.vertices[first.vertices[:, 0].argmax()], second.vertices[second.vertices[:, 0].argmin()]
    shift = np.array([gap, *(corner_a - corner_b)[1:]]) + aside * 0.3 * np.array([0.0, 1.0, 0.6])
    second = second.moved(np.eye(3), shift)
    found = []
    for order in (1, -1):
        parts = [first, second][::order]
        mass, centre, inertia = zip(*(mass_properties([p], 2000.0) for p in parts), strict=True)
        mass, centre = np.array(mass), np.array(centre)
        law = dem3.Law(1e9, 5e8, how["friction"])
        solids = dem3.Solids(centre, mass, np.array(inertia), [p.vertices for p in parts], [p.faces for p in parts], [0, 1], [law])
        rate = np.array([[*(2.0 * speed * way), spin_a, 0.3, spin_b], [*(-speed * way), -0.2, spin_b, spin_a]])[::order]
        options = dem3.Options(
            0.06,
            0.004,
            step=5e-6 if not how["rigid"] else 2e-4,
            gravity=(0.0, 0.0, 0.0),
            rigid=how["rigid"],
            rebound=how["rebound"] if how["rigid"] else 0.0,
            residual_limit=10.0,
        )
        run = dem3.run(solids, options, rate=rate)
        must(run.reason == "end", run.reason)
        v, place, turn = run.rate, run.place, run.turn
        about = turn @ np.array(inertia) @ np.swapaxes(turn, -1, -2)
        swing = (about @ v[:, :, 3:, None])[..., 0]
        momentum = (mass[:, None] * v[:, :, :3]).sum(axis=1)
        size = float(mass @ np.linalg.norm(rate[:, :3], axis=1)) + 1.0
        near("momentum", momentum, np.broadcast_to(momentum[0], momentum.shape), 1e-6, size)
        near("momentum at the start", momentum[0], mass @ rate[:, :3], 1e-6, size)
        moment = (mass[:, None] * np.cross(place[:, :, :3], v[:, :, :3]) + swing).sum(axis=1)
        near("moment of momentum", moment, np.broadcast_to(moment[0], moment.shape), 5e-3, size * 2.0)
        kinetic = 0.5 * (mass * (v[:, :, :3] ** 2).sum(axis=2) + (v[:, :, 3:] * swing).sum(axis=2)).sum(axis=1)
        near("kinetic energy", run.energy["kinetic"], kinetic, 0.02, kinetic[0])
        left = run.energy["kinetic"] + run.energy["elastic"] + run.energy["friction"] + run.energy["damping"]
        if how["rigid"]:  # in the midst of a rebound half of its impulse is booked
            left = left[[0, -1]]
        near("ledger", left, np.full(len(left), left[0]), 0.03, kinetic[0])
        at_most("kinetic energy", kinetic[-1], kinetic[0], 0.01)
        heat = abs(run.energy["friction"][-1]) / kinetic[0]
        must(heat < 1e-3 or how["friction"] > 0.0 or how["rigid"], f"friction loses {heat} without friction")
        found.append((place[-1][::order, :3], kinetic[-1], kinetic[0]))
    near("places in another order", found[0][0], found[1][0], 1e-2, 1.0)
    near("energy in another order", found[0][1], found[1][1], 0.05, found[0][2])


@relation(
    "rocking",
    st.tuples(decks("frame", "arch", "vault", "brickwork", "pointed-arch"), st.lists(number(0.05, 0.95), min_size=3, max_size=3)),
    1e-6,
    share=1.0,
)
def mechanisms_by_their_kinematics(deck: Deck, shares: list, within: float) -> None:
    """Hinges stay closed, rates are slopes of places, and mass, moment, drive and potential of the table are sums over the parts."""
    model = MechanismModel(building(deck).blocks())
    try:
        tables = model.tables
    except (NoView, CannotStand):
        reject()
    for one, table in zip(model.linkages, tables, strict=True):
        q = np.sort(np.array(shares)) * table.critical
        h = 1e-5 * table.critical
        place, first, second = core_mechanism.follow(one, np.concatenate([q, q - h, q + h, [0.0]]))
        rest, n = place[-1], len(q)
        near("at rest", rest[:, :2], one.centroid, 1e-9, 1.0)
        low, high = place[n : 2 * n], place[2 * n : 3 * n]
        size = float(np.abs(one.centroid).max())
        near("rates", first[:n], (high - low) / (2.0 * h), 1e-5, size)
        near("second rates", second[:n], (first[2 * n : 3 * n] - first[n : 2 * n]) / (2.0 * h), 1e-4, size)
        near("coordinate", np.abs(place[:n, one.driver - 1, 2]), q, 1e-9, 1e-3)
        for (i, k), point in zip(one.joined, one.point, strict=True):
            ends = [_carried(place[:n], rest, part, point) for part in (i, k)]
            near("hinge", ends[0], ends[1], 1e-7, size)
        c = core_mechanism.coefficients(table, q)
        v = first[:n]
        mass = (v[..., 0] ** 2 + v[..., 1] ** 2) @ one.mass + v[..., 2] ** 2 @ one.inertia
        near("M", c.mass, mass, 1e-5)
        slope = 2.0 * (
            (v[..., 0] * second[:n, :, 0] + v[..., 1] * second[:n, :, 1]) @ one.mass + (v[..., 2] * second[:n, :, 2]) @ one.inertia
        )
        near("M'/2", c.half_mass_slope, 0.5 * slope, 1e-3, float(mass.max()))
        lift = v[..., 1] @ one.mass * GRAVITY
        near("V'", c.gravity_moment, lift, 1e-5, abs(table.gravity_moment))
        near("H", c.drive, v[..., 0] @ one.mass * (1.0 if c.drive[0] * (v[0, :, 0] @ one.mass) > 0.0 else -1.0), 1e-5, abs(table.drive))
        near("V", c.potential, (place[:n, :, 1] - rest[:, 1]) @ one.mass * GRAVITY, 1e-5, abs(table.gravity_moment) * table.critical)
        edge, _, _ = core_mechanism.follow(one, [table.critical * (1.0 - 1e-6), table.critical * (1.0 + 1e-6)])
        rise = (edge[:, :, 1] - rest[:, 1]) @ one.mass
        limit = float(table.numbers[1])
        if limit < min(1.59, 2.0 * table.critical * (1.0 - 1e-9)):  # the hinges lock there, not at the greatest rotation looked at
            last, _, _ = core_mechanism.follow(one, limit / 0.999 * np.array([1.0 - 1e-6, 1.0 + 1e-4]))
            must(bool(np.isfinite(last[0]).all()) and not np.isfinite(last[1]).any(), "the hinges lock elsewhere")
        must(
            bool(rise.max() >= ((place[:n, :, 1] - rest[:, 1]) @ one.mass).max() * (1.0 - 1e-6)),
            "no unstable equilibrium at the critical rotation",
        )
    uplift = [abs(t.gravity_moment) / (abs(t.drive) * GRAVITY) for t in tables]
    near("uplift", uplift, model.uplift, 1e-5)
    kept = model.energy_kept
    if kept is not None:
        for k, (before, after) in enumerate(((model.fields[1], model.fields[0]), (model.fields[0], model.fields[1]))):
            mass, inertia = model.assembly.mass, model.assembly.inertia
            work = float(
                ((mass * before[:, 0] * after[:, 0]) + mass * before[:, 1] * after[:, 1] + inertia * before[:, 2] * after[:, 2]).sum()
            )
            own = float((mass * (after[:, :2] ** 2).sum(axis=1) + inertia * after[:, 2] ** 2).sum())
            last = float((mass * (before[:, :2] ** 2).sum(axis=1) + inertia * before[:, 2] ** 2).sum())
            projected = work / own
            if model.assembly.earth is None and model.assembly.fill is None:
                near("projection", abs(model.projections[k]), abs(projected), 1e-6, 1e-3)
                at_most("energy in the next mechanism", max(0.0, model.projections[k]) ** 2 * own / last, kept[k], 1e-6)
            must(0.0 <= kept[k] <= 1.0 + 1e-9, f"a blow keeps {kept[k]} of the energy")


def _carried(place: np.ndarray, rest: np.ndarray, part: int, point: np.ndarray) -> np.ndarray:
    """A point of a part (0: the ground) at the states."""
    if part == 0:
        return np.broadcast_to(point, (len(place), 2))
    arm, p = point - rest[part - 1, :2], place[:, part - 1]
    c, s = np.cos(p[:, 2] - rest[part - 1, 2]), np.sin(p[:, 2] - rest[part - 1, 2])
    return p[:, :2] + np.column_stack([c * arm[0] - s * arm[1], s * arm[0] + c * arm[1]])


@relation(
    "dem",
    st.tuples(
        decks("block", "column"), number(-0.05, 0.05, 10), number(-0.02, 0.02, 8), number(0.0, 0.2, 4), number(0.5, 1.0, 5), st.booleans()
    ),
    0.03,
    share=1.0,
)
def elements_on_a_moving_support(deck: Deck, dx: float, dy: float, start: float, duration: float, rigid: bool, within: float) -> None:
    """A pier follows the ground that moves along a raised cosine, and is at rest on it at the end."""
    if abs(dx) + abs(dy) < 0.01:
        reject()
    there = deck["structure"]
    there["height"] = float(f"{there['width'] * 2.5:.5g}")
    there |= {"drums": min(there["drums"], 2), "top_width": there["width"]} if there["kind"] == "column" else {}
    still = ask(deck, "tilt")
    ok(still)
    arrays = still.result.arrays
    joint = next(str(n) for n, b in zip(arrays["joint_name"].data, arrays["joint_block"].data, strict=True) if min(b) < 0)
    row = {"joint": joint, "dx": dx, "dy": dy, "start": start, "duration": duration}
    made = {**deck, "initial": {"movements": [row]}, "joints": {"friction": 0.9, **({} if rigid else {"normal_stiffness": 1e9})}}
    answer = ask(made, "dem", end_time=start + duration + 0.1, time_step=5e-4, output_step=0.02, **(RIGID if rigid else {}))
    ok(answer)
    a = {k: np.asarray(v.data) for k, v in answer.result.arrays.items()}
    phase = np.clip((a["time"] - start) / duration, 0.0, 1.0)
    way = phase - np.sin(2.0 * math.pi * phase) / (2.0 * math.pi)
    moved = a["place"][..., :2] - a["place"][0, :, :2]
    want = way[:, None, None] * np.array([dx, dy])
    near("places", moved, np.broadcast_to(want, moved.shape), within, float(np.hypot(dx, dy)))
    at_most("residual of the energy balance", answer.results.energy_residual_ratio, 0.01, 0.0)


@relation("dem", st.tuples(SIZES, SIZES, number(0.5, 2.0), st.sampled_from([0.0, 0.3, 0.6]), st.booleans()), 0.01, share=1.0)
def rebounds_by_newton(one: tuple, two: tuple, speed: float, rebound: float, space: bool, within: float) -> None:
    """Faces of two free boxes that hit each other on one line part at `rebound` times their speed, and lose 1 - rebound^2 of the energy
    that is not that of their centroid."""
    a, b = np.array(one), np.array(two)
    mass = 2000.0 * np.array([a.prod(), b.prod()])
    gap = 0.005
    inner = dict(step=2e-4, rigid=True, rebound=rebound, residual_limit=10.0)
    if space:
        parts = [box(tuple(-0.5 * a), tuple(0.5 * a)), box(tuple(-0.5 * b), tuple(0.5 * b))]
        parts[1] = parts[1].moved(np.eye(3), np.array([0.5 * (a[0] + b[0]) + gap, 0.0, 0.0]))
        _, centre, inertia = zip(*(mass_properties([p], 2000.0) for p in parts), strict=True)
        laws = [dem3.Law(1e9, 5e8, 0.5)]
        solids = dem3.Solids(np.array(centre), mass, np.array(inertia), [p.vertices for p in parts], [p.faces for p in parts], [0, 1], laws)
        rate = np.array([[speed, *[0.0] * 5], [0.0] * 6])
        run = dem3.run(solids, dem3.Options(0.05, 0.005, gravity=(0.0, 0.0, 0.0), **inner), rate=rate)
    else:
        outlines = [0.5 * np.array([[-s[0], -s[1]], [s[0], -s[1]], [s[0], s[1]], [-s[0], s[1]]]) for s in (a, b)]
        outlines[1] = outlines[1] + np.array([0.5 * (a[0] + b[0]) + gap, 0.0])
        centre = np.array([o.mean(axis=0) for o in outlines])
        inertia = mass * np.array([(s[0] ** 2 + s[1] ** 2) / 12.0 for s in (a, b)])
        bodies = dem.Bodies(centre, mass, inertia, outlines, [0, 1], [np.ones(4, bool)] * 2, 1.0, [dem.Law(1e9, 5e8, 0.5)])
        rate = np.array([[speed, 0.0, 0.0], [0.0] * 3])
        run = dem.run(bodies, dem.Options(0.05, 0.005, gravity=(0.0, 0.0), **inner), shift=np.zeros((2, 3)), rate=rate)
    must(run.reason == "end", run.reason)
    common = mass[0] * speed / mass.sum()
    want = common + rebound * speed * np.array([-mass[1], mass[0]]) / mass.sum()
    near("speeds after the blow", run.rate[-1][:, 0], want, within, speed)
    lost = 0.5 * mass.prod() / mass.sum() * speed**2 * (1.0 - rebound**2)
    near("loss", run.energy["damping"][-1] + run.energy["friction"][-1], lost, within, run.energy["kinetic"][0])


@relation("dem", st.tuples(SIZES, TURNS, number(0.02, 0.1), number(-1.0, 1.0), st.sampled_from([0.0, 0.3, 0.8])), 1e-4, share=2.0)
def corners_on_a_slab(size: tuple, turn: tuple, speed: float, aside: float, friction: float, within: float) -> None:
    """A box that meets a fixed slab with a corner, slowly and obliquely, loses energy only by friction; the impulse along the slab is at most friction times that across it."""
    slab = box((-5.0, -5.0, -1.0), (5.0, 5.0, 0.0))
    part = box(tuple(-0.5 * np.array(size)), tuple(0.5 * np.array(size))).moved(Rotation.from_euler("xyz", turn, degrees=True).as_matrix())
    low = np.sort(part.vertices[:, 2])
    if low[1] - low[0] < 0.05:
        reject()  # an edge or a face, whose polygon changes
    part = part.moved(np.eye(3), np.array([0.0, 0.0, 1e-3 - low[0]]))
    mass, centre, inertia = mass_properties([part], 2000.0)
    laws = [dem3.Law(1e9, 5e8, friction)]
    solids = dem3.Solids(
        np.array([centre, [0.0, 0.0, -0.5]]),
        np.array([mass, 0.0]),
        np.array([inertia, np.zeros((3, 3))]),
        [part.vertices, slab.vertices],
        [part.faces, slab.faces],
        [0, 1],
        laws,
    )
    rate = np.array([[aside * speed, 0.3 * speed, -speed, 0.0, 0.0, 0.0], [0.0] * 6])
    options = dem3.Options(0.2, 0.01, step=1e-5, gravity=(0.0, 0.0, 0.0), residual_limit=10.0)
    run = dem3.run(solids, options, rate=rate)
    must(run.reason == "end", run.reason)
    left = run.energy["kinetic"] + run.energy["elastic"] + run.energy["friction"] + run.energy["damping"]
    near("ledger", left, np.full(len(left), left[0]), within, left[0])
    near("without dashpots", run.energy["damping"], 0.0 * left, within, left[0])
    change = mass * (run.rate[-1, 0, :3] - rate[0, :3])
    at_most("impulse along the slab", float(np.hypot(*change[:2])), friction * change[2], 0.02, 1e-3 * mass * speed)


@relation("dem", st.tuples(st.integers(3, 7), number(0.3, 1.0), number(0.3, 1.5), number(8.0, 9.0)), 1e-3, share=1.0)
def settlements_of_prisms(sides: int, radius: float, height: float, exponent: float, within: float) -> None:
    """A prism settles on a slab by its weight over stiffness and area, upright; exponent: of the stiffness [Pa/m]."""
    stiffness = 10.0**exponent
    angle = 2.0 * np.pi * np.arange(sides) / sides
    outline = radius * np.column_stack([np.cos(angle), np.sin(angle)])
    part, slab = prism(outline, 0.0, height), box((-5.0, -5.0, -1.0), (5.0, 5.0, 0.0))
    mass, centre, inertia = mass_properties([part], 2000.0)
    laws = [dem3.Law(stiffness, 0.5 * stiffness, 0.6, damping=2.0 / math.sqrt(stiffness / (2000.0 * height)))]
    solids = dem3.Solids(
        np.array([centre, [0.0, 0.0, -0.5]]),
        np.array([mass, 0.0]),
        np.array([inertia, np.zeros((3, 3))]),
        [part.vertices, slab.vertices],
        [part.faces, slab.faces],
        [0, 1],
        laws,
    )
    run = dem3.run(solids, dem3.Options(1.0, 0.1, residual_limit=10.0), rate=np.zeros((2, 6)))
    must(run.reason == "end", run.reason)
    moved = run.place[-1, 0, :3] - centre
    settled = 2000.0 * height * GRAVITY / stiffness
    near("settlement", moved, [0.0, 0.0, -settled], within, settled)
    near("upright", run.turn[-1, 0][:, 2], [0.0, 0.0, 1.0], 1e-6, 1.0)


@relation("tilt", st.integers(0, 10**6), 1e-8, share=1.0)
def programmes_of_the_core(number_of: int, within: float) -> None:
    """The vertex method gives the optimum of HiGHS, with multipliers that prove it; a banded factor solves its system."""
    draw = np.random.default_rng(number_of)
    n, k = int(draw.integers(2, 20)), int(draw.integers(3, 120))
    rows, least, cost = draw.normal(size=(k, n)), draw.normal(size=k) - 1.0, draw.normal(size=n)
    low, high = np.full(n, -1e3), np.full(n, 1e3)
    found = least_vertex(rows, least, cost, low, high)
    peer = linprog(cost, A_ub=-rows, b_ub=-least, bounds=list(zip(low, high, strict=True)), method="highs")
    must((found is not None) is (peer.status == 0), f"the vertex method: {found}, HiGHS: {peer.message}")
    if found is not None:
        x, multipliers, sides = found
        near("least cost", cost @ x, peer.fun, within, 1.0)
        at_most("rows", float((least - rows @ x).max()), 0.0, within, 1.0)
        near("gradients", rows.T @ multipliers + sides, cost, within, 1.0)
    n, width = int(draw.integers(3, 40)), int(draw.integers(1, 3))
    band = draw.normal(size=(n, width + 1))
    band[:, 0] = 4.0 * (width + 1.0) + np.abs(band[:, 0])
    whole = np.zeros((n, n))
    for j in range(n):
        for i in range(j, min(n, j + width + 1)):
            whole[i, j] = whole[j, i] = band[j, i - j]
    right = draw.normal(size=n)
    near("a banded system", whole @ BandFactor(np.ascontiguousarray(band)).solve(right), right, within, 1.0)
