"""Two stacked blocks (the four modes of Psycharis 1990): limits of one block, kinematics, impacts, energy."""

from dataclasses import replace

import numpy as np
import pytest

import extrados
from extrados.analyses.rocking.conditions import of_pair
from extrados.core import mechanism as core_mechanism
from extrados.core.ground import Ground
from extrados.core.rocking import OUTCOMES, ensemble, history
from extrados.core.stack import Stack, stack_body, stack_history, stack_impact
from extrados.model.properties import Initial
from extrados.model.structures.block import Block
from extrados.model.structures.stack import Stack as Stacked
from extrados.schema.constants import GRAVITY
from extrados.views.building import Building


def stack(low: tuple[float, float], high: tuple[float, float], density: tuple[float, float] = (2000.0, 2000.0)) -> Stack:
    """Rectangles of width and height [m]."""
    mass = tuple(rho * b * h for rho, (b, h) in zip(density, (low, high), strict=True))
    inertia = tuple(m * (b * b + h * h) / 12.0 for m, (b, h) in zip(mass, (low, high), strict=True))
    return Stack(mass, inertia, (0.5 * low[1], 0.5 * high[1]), 0.5 * low[0], low[1], 0.5 * min(low[0], high[0]))


def shaking(seed: int, size: float) -> Ground:
    return Ground(samples=size * np.random.default_rng(seed).normal(size=(1, 60)), step=0.1)


def residual(r) -> float:
    energy = r.kinetic + r.potential
    return float(np.abs(energy - energy[0] - r.ledger).max() / np.abs(energy).max())


def test_a_slender_block_on_a_wide_one_rocks_alone() -> None:
    """Mode 3: impacts and rotations are those of one block."""
    found = stack_history(stack((4.0, 0.5), (0.6, 3.0)), shaking(1, 3.0), 8.0, 0.01, tolerance=1e-11)
    alone = history(Building(Block(kind="block", width=0.6, height=3.0)).rocker().body, shaking(1, 3.0), 8.0, 0.01, tolerance=1e-11)
    n = min(len(alone.time), len(found.time))
    assert found.impacts[1] == alone.impacts > 2
    assert (found.rotation[:, 0] == 0.0).all()
    assert found.rotation[:n, 1] == pytest.approx(alone.rotation[:n], abs=1e-8)


def test_a_tall_pair_of_wide_joint_rocks_as_one_block() -> None:
    """Mode 4: as one block of both heights, as long as the joint between stays shut."""
    found = stack_history(stack((1.0, 1.5), (1.0, 1.5)), shaking(2, 3.0), 8.0, 0.01, tolerance=1e-11)
    alone = history(Building(Block(kind="block", width=1.0, height=3.0)).rocker().body, shaking(2, 3.0), 8.0, 0.01, tolerance=1e-11)
    shut = np.flatnonzero(found.state[:, 1])
    n = min(len(found.time), len(alone.time), shut[0] if len(shut) else 10**6)
    assert np.abs(alone.rotation[:n]).max() > 0.02
    assert found.rotation[:n, 0] == pytest.approx(alone.rotation[:n], abs=1e-8)


def centres(s: Stack, pivots: np.ndarray, q: np.ndarray) -> np.ndarray:
    """Places of both centres (2, 2) from rotations, positive clockwise."""

    def turn(x: float, y: float, angle: float) -> np.ndarray:
        c, sn = np.cos(angle), np.sin(angle)
        return np.array([c * x + sn * y, -sn * x + c * y])

    foot, edge = pivots[0] * s.half_foot, pivots[1] * s.half_contact
    corner = np.array([foot, 0.0]) + turn(edge - foot, s.height, q[0])
    return np.array([np.array([foot, 0.0]) + turn(-foot, s.centre[0], q[0]), corner + turn(-edge, s.centre[1], q[1])])


@pytest.mark.parametrize("pivots", [(1, 1), (1, -1), (-1, 1), (-1, -1)])
def test_both_open_contacts_move_by_the_principle_of_hamilton(pivots: tuple[int, int]) -> None:
    """Accelerations of a run against those of a Lagrangian made from the places of the centres by differences."""
    s = stack((1.2, 1.0), (0.7, 1.6), (1800.0, 2500.0))
    start = np.array([0.08 * pivots[0], 0.08 * pivots[0] + 0.11 * pivots[1], 0.3 * pivots[0], 0.3 * pivots[0] + 0.2 * pivots[1]])
    ground = np.array([1.3, -0.7])
    motion = Ground(samples=np.repeat(ground[:, None], 3, axis=1), step=1.0)
    r = stack_history(s, motion, 1e-3, 1e-3, start=start, tolerance=1e-12)
    q, v, step = start[:2], start[2:], 1e-4
    m = np.array(s.mass)

    def jacobian(at: np.ndarray) -> np.ndarray:
        """(2 centres, 2 axes, 2 rotations)"""
        return np.stack(
            [(centres(s, pivots, at + step * e) - centres(s, pivots, at - step * e)) / (2.0 * step) for e in np.eye(2)], axis=-1
        )

    j = jacobian(q)
    spin = (jacobian(q + step * v) - jacobian(q - step * v)) / (2.0 * step) @ v
    matrix = np.einsum("k,kai,kaj->ij", m, j, j) + np.diag(s.inertia)
    pull = -ground - np.array([0.0, GRAVITY])
    load = np.einsum("k,kai,ka->i", m, j, pull - spin)
    expected = np.linalg.solve(matrix, load)
    assert (r.rate[-1] - v) / 1e-3 == pytest.approx(expected, rel=2e-2)
    assert r.state[0].tolist() == list(pivots)
    # the change of rate over a second, shorter time has half the error
    short = stack_history(s, motion, 1e-4, 1e-4, start=start, tolerance=1e-12)
    assert (short.rate[-1] - v) / 1e-4 == pytest.approx(expected, rel=2e-3)


def moreau(s: Stack, pivots: tuple[int, int], q: tuple[float, float], v: np.ndarray, closing: tuple[bool, bool]) -> np.ndarray:
    """Rates after the blow of mechanism_blow on the two blocks as bodies; a contact that stays open presses at its pivot."""
    step = 1e-6
    place = centres(s, pivots, np.array(q))
    speed = (centres(s, pivots, np.array(q) + step * v) - centres(s, pivots, np.array(q) - step * v)) / (2.0 * step)
    c, sn = np.cos(q[0]), np.sin(q[0])
    along, up = np.array([c, -sn]), np.array([sn, c])
    foot = np.array([[-s.half_foot, 0.0], [s.half_foot, 0.0]])
    middle = np.array([pivots[0] * s.half_foot, 0.0]) + (-pivots[0] * s.half_foot) * along + s.height * up
    bed = np.array([middle - s.half_contact * along, middle + s.half_contact * along])
    ends = [
        e if shut or not p else np.repeat(e[[0 if p < 0 else 1]], 2, axis=0)
        for e, p, shut in zip((foot, bed), pivots, closing, strict=True)
    ]
    after = core_mechanism.inelastic_blow(
        s.mass, s.inertia, place, [[0, -1], [1, 0]], ends, [[[0.0, 1.0], [1.0, 0.0]], [up, along]], np.column_stack([speed, -v])
    )
    return -after[:, 2]


def test_impacts_are_those_of_moreau_with_impulses_at_all_joints() -> None:
    """Random states at which the lower block lands, or the joint between shuts, the other contact open or shut."""
    generator = np.random.default_rng(5)
    tried = 0
    for _ in range(200):
        s = stack(tuple(generator.uniform([0.6, 0.5], [2.0, 2.0])), tuple(generator.uniform([0.4, 0.5], [2.0, 2.5])))
        way = generator.choice([-1, 1], 2)
        which = int(generator.integers(4))
        if which == 0:  # lands, the upper block open
            pivots, q, closing = (way[0], way[1]), (0.0, 0.1 * way[1]), (True, False)
        elif which == 1:  # lands as one body
            pivots, q, closing = (way[0], 0), (0.0, 0.0), (True, True)
        elif which == 2:  # the upper block lands on a lower one that rocks
            pivots, q, closing = (way[0], way[1]), (0.1 * way[0], 0.1 * way[0]), (False, True)
        else:  # the upper block lands on a lower one that rests
            pivots, q, closing = (0, way[1]), (0.0, 0.0), (True, True)
        v = np.array([-way[0] * generator.uniform(0.1, 1.0), 0.0])
        v[1] = v[0] if which == 1 else generator.normal()
        if which in (2, 3):
            v[0] = 0.0 if which == 3 else generator.normal()
            v[1] = v[0] - way[1] * generator.uniform(0.1, 1.0)
        after, rates = stack_impact(s, pivots, q, v, [c and p != 0 for c, p in zip(closing, pivots, strict=True)])
        expected = moreau(s, pivots, q, v, closing)
        # the bodies of Moreau's blow may also jump off their pivot, which is not rocking
        if np.allclose(rates, expected, atol=1e-5):
            tried += 1
        assert all(a in (-1, 0, 1) for a in after)
    assert tried > 150


def test_energy_never_grows_and_its_ledger_closes() -> None:
    lost = []
    for seed in range(30):
        generator = np.random.default_rng(seed)
        s = stack(tuple(generator.uniform([0.8, 0.6], [1.6, 2.0])), tuple(generator.uniform([0.3, 1.0], [0.9, 2.5])))
        r = stack_history(s, shaking(seed, 4.0), 10.0, 0.01, tolerance=1e-9)
        if r.outcome == "no-hinging":
            continue
        assert residual(r) < 1e-6
        assert r.loss >= 0.0
        lost.append(len({tuple(x) for x in r.state.tolist()}))
    assert max(lost) >= 7, "most modes of both contacts are met"


def test_free_rocking_of_both_comes_to_rest() -> None:
    r = stack_history(stack((1.0, 1.0), (0.5, 1.5)), Ground(samples=np.zeros((1, 2)), step=0.1), 30.0, 0.01, start=(0.05, 0.12, 0.0, 0.0))
    assert r.settled and r.outcome == "recovery"
    assert residual(r) < 1e-6
    assert (r.rotation[-1] == 0.0).all()
    assert min(r.impacts) > 3


def test_which_contact_opens_first_is_the_printed_criterion() -> None:
    """From rest: as one at g b/h of the whole, the upper alone at g b/h of its own, whichever is less (Psycharis 1990)."""
    for low, high in (((1.0, 1.0), (0.5, 1.5)), ((0.6, 2.0), (0.6, 0.5))):
        s = stack(low, high)
        m, c = np.array(s.mass), np.array(s.centre)
        whole = GRAVITY * s.half_foot * m.sum() / (m @ (c + np.array([0.0, s.height])))
        upper = GRAVITY * s.half_contact / s.centre[1]
        ramp = Ground(samples=np.array([[0.0, -10.0]]), step=1.0)
        first = stack_history(s, ramp, 1.0, 0.01).events[0]
        assert first[1] * 10.0 == pytest.approx(min(whole, upper), rel=1e-8)
        assert first[2] == (1 if whole < upper else 2)


def test_a_start_from_a_given_rotation_is_that_of_one_block() -> None:
    """The ratio of [initial] turns the whole pair."""
    r = Building(Block(kind="block", width=1.0, height=3.0), initial=Initial(rotation_ratio=0.5)).rocker()
    still = Ground(samples=np.zeros((1, 2)), step=0.1)
    one = history(r.body, still, 3.0, 0.01, tolerance=1e-11, start_rotation=r.start_rotation)
    two = stack_history(
        stack((1.0, 2.0), (1.0, 1.0)), still, 3.0, 0.01, tolerance=1e-11, start=(r.start_rotation, r.start_rotation, 0.0, 0.0)
    )
    n = int(np.searchsorted(one.time, one.events[0][1]))
    assert two.rotation[:n, 0] == pytest.approx(one.rotation[:n], abs=1e-9)


@pytest.mark.parametrize("upper_first", [False, True])
def test_two_blocks_drawn_one_by_one_rock_as_a_stack(upper_first: bool) -> None:
    """The same two rectangles as `stack` and, elsewhere and in either order, as `blocks`: every result is the same."""
    stack = {"kind": "stack", "lower_width": 0.6, "lower_height": 0.68, "upper_width": 0.3, "upper_height": 0.926}
    corners = [(0.6, 0.0, 0.68), (0.3, 0.68, 1.606)]
    drawn = [
        {"name": name, "points": [[3 - w / 2, 1 + y], [3 + w / 2, 1 + y], [3 + w / 2, 1 + z], [3 - w / 2, 1 + z]]}
        for name, (w, y, z) in zip(("lower block", "upper block"), corners, strict=True)
    ]
    ground = {"kind": "blocks", "ground": [[2.0, 1.0, 4.0, 1.0]], "block": drawn[::-1] if upper_first else drawn}
    motion = {"kind": "sine-pulse", "amplitude": "0.655 g", "period": 0.96}
    rest = {"joints": {"friction": 0.6}, "motion": motion, "analysis": {"kind": "rocking", "end_time": 3.0}}
    one, other = (extrados.run({"structure": s, **rest}).results[0] for s in (stack, ground))
    x, y = one.results, other.results
    assert y.stack is not None and x.outcome == y.outcome and x.impacts == y.impacts
    assert y.peak_rotation_rad == pytest.approx(x.peak_rotation_rad, rel=1e-6)
    assert y.stack.peak_rotation_upper_rad == pytest.approx(x.stack.peak_rotation_upper_rad, rel=1e-6)
    pose = other.arrays["snapshot_pose"].data - [3.0, 1.0, 0.0]
    assert (pose[:, ::-1] if upper_first else pose) == pytest.approx(one.arrays["snapshot_pose"].data, abs=1e-6)


def test_members_of_an_ensemble_are_histories() -> None:
    """Outcome, peaks and friction needed of forty runs as by their histories; half cycles begin with uplifts and impacts."""
    s = stack((1.0, 1.5), (0.8, 1.5))
    model = (
        Building(Stacked(kind="stack", lower_width=1.0, lower_height=1.5, upper_width=0.8, upper_height=1.5)).rocker(soft_base=True).model
    )
    assert model.core.numbers == pytest.approx(s.numbers)
    critical = model.whole[0], model.alone[0]
    grounds = [shaking(seed, 3.0) for seed in range(10)]
    scale = np.repeat([0.5, 1.0, 1.6, 2.5], 10)
    found = ensemble(
        [stack_body(s, critical, (0.5, 0.5))], grounds, np.zeros(40, dtype=int), np.tile(np.arange(10), 4), scale, 12.0, threads=2
    )
    for k in range(40):
        r = stack_history(s, grounds[k % 10], 12.0, 0.002, scale=float(scale[k]))
        assert OUTCOMES[found.outcome[k]] == r.outcome
        apart = r.rotation[:, 1] - r.rotation[:, 0]
        ratio = max(np.abs(r.rotation[:, 0]).max() / critical[0], np.abs(apart).max() / critical[1])
        assert found.peak_ratio[k] == pytest.approx(ratio, rel=1e-3 if r.outcome != "collapse" else 0.05, abs=1e-5)
        moving = (r.state != 0).any(axis=1) & (np.abs(r.rotation[:, 0]) < critical[0]) & (np.abs(apart) < critical[1])
        c, sn = np.cos(r.rotation[:, 0]), np.sin(r.rotation[:, 0])
        x, y = r.force[:, 1].T
        normal, shear = np.column_stack([r.force[:, 0, 1], sn * x + c * y]), np.column_stack([r.force[:, 0, 0], c * x - sn * y])
        if moving.any() and (normal[moving] > 0.0).all() and np.isfinite(found.joints.friction[k]):
            assert found.joints.friction[k] >= (np.abs(shear) / normal)[moving].max() * 0.98 - 1e-9
        assert (found.half_cycles[k] > 0) == (r.outcome != "no-hinging")
    assert set(found.outcome) == {0, 1, 2} or set(found.outcome) == {1, 2}


def test_half_cycles_are_those_of_an_ensemble() -> None:
    """One motion by `rocking` and as a suite of `fragility`; a start that is turned counts as the first half cycle."""
    shape = {"kind": "stack", "lower_width": 1.0, "lower_height": 1.5, "upper_width": 0.8, "upper_height": 1.5}
    motion = {"kind": "generated", "mmi": 9, "duration": 2.0, "seed": 3, "member": 1}
    for turned in (0.0, 0.3):
        deck = {"structure": shape, "initial": {"rotation_ratio": turned}}
        many = extrados.run(
            {
                **deck,
                "motion": {k: v for k, v in motion.items() if k != "member"},
                "analysis": {"kind": "fragility", "count": 1, "bootstrap": 0, "settle": 3.0},
            }
        )
        table = many.results[0].tables["ensemble"].columns
        end = {"end_time": float(table["stop_time"][0])}
        one = extrados.run({**deck, "motion": motion, "analysis": {"kind": "rocking", "hand_over": False, **end}}).results[0].results
        assert one.half_cycles == table["half_cycles"][0] > 3, turned
        assert one.half_cycles < 2 * one.impacts + 2


@pytest.mark.parametrize("friction", [[5.0, 0.2], [0.2, 5.0]])
def test_the_friction_of_a_warning_is_that_of_the_joint_that_slides(friction: list[float]) -> None:
    """Both joints have a friction below the one needed, at different times: the number belongs to the joint that is named."""
    rocker = Building(Stacked(kind="stack", lower_width=1.0, lower_height=1.5, upper_width=0.8, upper_height=1.5)).rocker(soft_base=True)
    body = stack_body(rocker.model.core, rocker.critical, tuple(friction))
    one = np.zeros(1, dtype=int)
    for slips in (0, 1):
        found = ensemble([body], [shaking(1, 3.0)], one, one, [1.0], 6.0)
        joints = replace(found.joints, slips=np.array([slips]), slips_at=np.array([1.0]))
        said = of_pair(replace(rocker, body=body), joints).violated
        assert any(f"Friction {friction[slips]:.2f} is too low, first at" in text for text in said)
