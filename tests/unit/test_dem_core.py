"""Discrete elements against exact solutions."""

import itertools
from dataclasses import fields, replace

import numpy as np
import pytest
from dem_models import G, block_on_floor, constant, cosine, housner, model, pieces, rectangle
from interrupting import interrupted

from extrados import _core
from extrados.core import dem, dem_run
from extrados.core.ground import as_motion_set

STIFF = dem.Law(1e10, 1e10, 0.6, damping=2e-3)


def test_free_fall_is_exact() -> None:
    bodies = model([rectangle(0.0, 1.0, 5.0, 6.0)], [rectangle(-5.0, 5.0, -1.0, 0.0)], STIFF)
    rate = np.array([[0.3, 1.0, 0.7], [0.0, 0.0, 0.0]])
    run = dem.run(bodies, dem.Options(0.5, 0.05, step=1e-4), shift=np.zeros((2, 3)), rate=rate)
    t = run.time
    exact = np.stack([0.5 + 0.3 * t, 5.5 + t - 0.5 * G * t**2, 0.7 * t], axis=1)
    assert np.abs(run.place[:, 0] - exact).max() < 1e-12
    assert run.residual < 1e-12


def test_mass_damping_slows_a_fall_and_loses_what_the_ledger_says() -> None:
    """v' = g - alpha v; what is lost is the integral of alpha (m v^2 + I w^2)."""
    bodies = model([rectangle(0.0, 1.0, 5.0, 6.0)], [rectangle(-5.0, 5.0, -1.0, 0.0)], STIFF)
    alpha, start = 3.0, np.array([0.3, 1.0, 0.7])
    options = dem.Options(0.5, 0.05, step=1e-4, mass_damping=alpha)
    run = dem.run(bodies, options, shift=np.zeros((2, 3)), rate=np.stack([start, np.zeros(3)]))
    terminal = np.array([0.0, -G / alpha, 0.0])

    def rate(t: np.ndarray) -> np.ndarray:
        return terminal + (start - terminal) * np.exp(-alpha * t[:, None])

    moved = terminal * run.time[:, None] + (start - terminal) * (1.0 - np.exp(-alpha * run.time[:, None])) / alpha
    assert np.abs(run.place[:, 0] - [0.5, 5.5, 0.0] - moved).max() < 1e-7
    t = np.linspace(0.0, run.time[-1], 2001)
    power = alpha * (rate(t) ** 2 @ [bodies.mass[0], bodies.mass[0], bodies.inertia[0]])
    assert run.energy["mass_damping"][-1] == pytest.approx(np.trapezoid(power, t), rel=1e-6)
    assert run.residual < 1e-7


def test_newmark_sliding_block() -> None:
    """A flat block under a pulse a > mu g slides a t^2 / 2 (a / (mu g) - 1) (Newmark 1965)."""
    friction, a, t = 0.3, 0.5 * G, 0.2
    # So stiff that the shear springs take no part: they delay the onset by sqrt(2 m / k).
    bodies = block_on_floor(4.0, 0.2, dem.Law(1e15, 1e15, friction, damping=2e-6))
    # The ground stays at its velocity a t after the pulse; the slip ends a t / (mu g) after the start.
    run = dem.run(bodies, dem.Options(0.4, 0.01), pieces([0.0, t], [a]))
    slip = 0.5 * a * t**2 * (a / (friction * G) - 1.0)
    moved = run.settled[0, 0] - run.place[-1, 0, 0]
    assert abs(moved / slip - 1.0) < 1e-6
    heat = friction * bodies.mass[0] * G * slip
    assert abs(run.energy["friction"][-1] / heat - 1.0) < 1e-5


@pytest.mark.parametrize(("slope", "slides"), [(0.59, False), (0.61, True)])
def test_slope_slides_at_its_friction(slope: float, slides: bool) -> None:
    """A block slides where the slope's tangent exceeds the friction, with g (sin - mu cos)."""
    angle = np.arctan(slope)
    bodies = block_on_floor(2.0, 0.2, dem.Law(1e13, 1e13, 0.6, damping=2e-5))
    gravity = (G * np.sin(angle), -G * np.cos(angle))
    ramp = dem.Options(0.5, 0.1, gravity=(0.0, -G * np.cos(angle)))
    run = dem.run(bodies, ramp, constant(-gravity[0]))
    moved = run.place[-1, 0, 0] - run.settled[0, 0]
    if slides:
        exact = 0.5 * G * (np.sin(angle) - 0.6 * np.cos(angle)) * run.time[-1] ** 2
        assert moved == pytest.approx(exact, rel=1e-3)
    else:
        assert abs(moved) < 1e-5


@pytest.mark.parametrize(("ratio", "topples"), [(0.995, False), (1.005, True)])
def test_block_topples_at_its_slenderness(ratio: float, topples: bool) -> None:
    bodies = block_on_floor(1.0, 4.0, dem.Law(1e12, 1e12, 2.0, damping=1e-3))
    run = dem.run(bodies, dem.Options(6.0, 0.1, collapse=0.5), constant(ratio * 0.25 * G))
    assert (run.reason == "collapse") == topples
    if not topples:
        assert np.abs(run.place[:, 0, 2]).max() < 1e-4


def test_elastic_bounce_returns() -> None:
    """Without damping a flat fall comes back to its height: a linear spring gives all back."""
    bodies = model([rectangle(-1.0, 1.0, 0.1, 1.1)], [rectangle(-5.0, 5.0, -1.0, 0.0)], dem.Law(1e9, 1e9, 0.6))
    fall = np.sqrt(2 * 0.1 / G)
    run = dem.run(bodies, dem.Options(2.2 * fall, 0.001, step=1e-5), shift=np.zeros((2, 3)))
    height = run.place[:, 0, 1] - 0.5
    later = run.time > 1.5 * fall
    assert height[later].max() == pytest.approx(0.1, rel=2e-5)
    assert run.residual < 2e-5
    assert run.bounces[0] == 1


def test_leapfrog_is_second_order() -> None:
    """A block hangs on its bonded base springs: undamped vibration against the harmonic solution."""
    law = dem.Law(1e7, 1e7, 1.0, cohesion=1e9, tension=1e9)
    bodies = model([rectangle(-0.5, 0.5, 0.0, 1.0)], [rectangle(-5.0, 5.0, -1.0, 0.0)], law)
    omega = np.sqrt(1e7 / bodies.mass[0])
    error = []
    for step in (2e-3, 1e-3, 5e-4):
        rate = np.array([[0.0, 0.01, 0.0], [0.0, 0.0, 0.0]])
        options = dem.Options(0.2, 0.1, step=step, gravity=(0.0, 0.0))
        run = dem.run(bodies, options, shift=np.zeros((2, 3)), rate=rate)
        error.append(abs(run.place[-1, 0, 1] - 0.5 - 0.01 / omega * np.sin(omega * run.time[-1])))
    order = np.log2(np.array(error[:-1]) / error[1:])
    assert np.abs(order - 2.0).max() < 0.1, order


@pytest.mark.parametrize("ratio", [0.05, 0.5, 3.0])
def test_dashpots_damp_as_requested(ratio: float) -> None:
    """A bonded block, let go with a velocity, against the damped oscillator: both its points share the damping."""
    omega = np.sqrt(1e7 / 2000.0)
    law = dem.Law(1e7, 1e7, 1.0, cohesion=1e9, tension=1e9, damping=2.0 * ratio / omega)
    bodies = model([rectangle(-0.5, 0.5, 0.0, 1.0)], [rectangle(-5.0, 5.0, -1.0, 0.0)], law)
    rate = np.array([[0.0, 0.01, 0.0], [0.0, 0.0, 0.0]])
    options = dem.Options(0.3, 0.002, step=1e-5, gravity=(0.0, 0.0))
    run = dem.run(bodies, options, shift=np.zeros((2, 3)), rate=rate)
    root = np.sqrt(complex(ratio**2 - 1.0))
    one, two = omega * (-ratio + root), omega * (-ratio - root)
    exact = (0.01 * (np.exp(one * run.time) - np.exp(two * run.time)) / (one - two)).real
    assert np.abs(run.place[:, 0, 1] - 0.5 - exact).max() < 5e-3 * np.abs(exact).max()
    assert run.residual < 1e-3


def test_momentum_is_conserved() -> None:
    """Two blocks collide in free space: linear and angular momentum stay to rounding."""
    bodies = model(
        [rectangle(0.0, 1.0, 0.0, 1.0), rectangle(1.2, 2.2, 0.4, 1.4)],
        [rectangle(50.0, 51.0, 0.0, 1.0)],
        dem.Law(1e8, 1e8, 0.4, damping=1e-4),
    )
    rate = np.array([[1.0, 0.2, 0.5], [-0.5, 0.0, -1.0], [0.0, 0.0, 0.0]])
    run = dem.run(bodies, dem.Options(1.0, 0.01, gravity=(0.0, 0.0)), shift=np.zeros((3, 3)), rate=rate)
    m, inertia = bodies.mass[:2], bodies.inertia[:2]
    place, v = run.place[:, :2], run.rate[:, :2]
    linear = np.einsum("b,tbi->ti", m, v[..., :2])
    angular = np.einsum("b,tb->t", m, place[..., 0] * v[..., 1] - place[..., 1] * v[..., 0]) + v[..., 2] @ inertia
    assert run.energy["damping"][-1] > 1.0  # they did collide
    scale = float(np.abs(m @ np.abs(rate[:2, :2])).max())
    assert np.abs(linear - linear[0]).max() / scale < 1e-12
    assert np.abs(angular - angular[0]).max() / (scale * 2.0) < 1e-9


def test_rocking_block_follows_housner() -> None:
    """Thesis Fig. 7-1: 1 x 4 m under 0.5 g cos(10.88 t), damping by the rule (critical at edge impact)."""
    times = np.linspace(0.0, 5.0, 1001)
    exact = housner(1.0, 4.0, 0.5 * G, 10.88, times)
    assert np.abs(exact).max() == pytest.approx(0.0539, abs=1e-4)  # note of the oracle
    for stiffness in (1e10, 1e12):
        edge = np.sqrt(stiffness / 8000.0)
        bodies = block_on_floor(1.0, 4.0, dem.Law(stiffness, stiffness, 2.0, damping=2.0 / edge))
        run = dem.run(bodies, dem.Options(5.0), cosine(0.5 * G, 10.88), times=times)
        rotation = -run.place[:, 0, 2]
        rms = float(np.sqrt(np.mean((rotation - np.interp(run.time, times, exact)) ** 2)))
        assert rms < 0.005 * np.arctan(0.25)
        assert run.residual < 0.01


def test_moving_base_equals_body_force() -> None:
    bodies = block_on_floor(1.0, 4.0, STIFF)
    runs = [dem.run(bodies, dem.Options(1.5, 0.05, moving_base=base), cosine(0.5 * G, 10.88)) for base in (False, True)]
    assert np.abs(runs[0].place[:, 0] - runs[1].place[:, 0]).max() < 1e-7
    assert runs[1].residual < 0.01


def test_threads_give_the_same_bits() -> None:
    """A wall that falls apart, on one and on two threads."""
    bricks = [rectangle(x + 0.5 * (row % 2), x + 1.0 + 0.5 * (row % 2), 0.4 * row, 0.4 * row + 0.4) for row in range(6) for x in range(4)]
    bodies = model(bricks, [rectangle(-20.0, 20.0, -1.0, 0.0)], dem.Law(1e9, 1e9, 0.6, damping=2e-3))
    runs = [dem.run(bodies, dem.Options(0.8, 0.1, threads=k), cosine(1.2 * G, 8.0)) for k in (1, 2)]
    assert np.array_equal(runs[0].place, runs[1].place)
    assert all(np.array_equal(runs[0].energy[k], runs[1].energy[k]) for k in dem_run.ENERGIES)
    assert runs[0].searches > 3  # the order of contacts changed on the way
    assert runs[0].residual < 0.01


def test_a_block_falls_on_another_and_rests() -> None:
    bodies = model([rectangle(-0.5, 0.5, 0.0, 1.0), rectangle(0.2, 1.2, 1.5, 2.0)], [rectangle(-20.0, 20.0, -1.0, 0.0)], STIFF)
    run = dem.run(bodies, dem.Options(4.0, 0.1, stop_at_rest=True), shift=np.zeros((3, 3)))
    assert run.reason == "rest"
    assert run.residual < 0.02
    lowest = run.place[-1, :2, 1].min()
    assert lowest > 0.2  # nothing sank into the floor
    assert run.energy["kinetic"][-1] < 1e-3


def test_mortar_holds_until_its_strength() -> None:
    """A bonded block hangs from a ceiling: tension k gap; it falls where its weight exceeds the strength."""
    weight = 2000.0 * G  # of 1 x 1 x 1 m
    for strength, falls in ((1.3 * weight, False), (0.9 * weight, True)):
        law = dem.Law(1e9, 1e9, 0.6, cohesion=1e6, tension=strength, damping=2e-3)
        bodies = model([rectangle(-0.5, 0.5, -1.0, 0.0)], [rectangle(-2.0, 2.0, 0.0, 1.0)], law)
        # Gravity is brought in slowly through the ground, which accelerates downward at first.
        slow = dem.Options(1.0, 0.05, settle_steps=0, gravity=(0.0, -G), mass_damping=0.0)
        lift = pieces([0.0, 100.0], [0.0])
        lift = type(lift)(breaks=np.array([0.0, 0.5]), linear=np.array([[[0.0, 0.0], [-G, 2.0 * G]]]), harmonic=np.zeros((1, 2, 0, 4)))
        run = dem.run(bodies, slow, lift)
        assert (run.place[-1, 0, 1] < -0.6) == falls


@pytest.mark.parametrize("share", [0.95, 1.05])
def test_mortar_must_carry_the_weight_at_rest_after_settling(share: float) -> None:
    """Not the overshoot of a weight that comes at once, which without dashpots is twice as much."""
    weight, stiffness = 2000.0 * G, 1e9
    law = dem.Law(stiffness, stiffness, 0.6, cohesion=1e6, tension=share * weight)
    bodies = model([rectangle(-0.5, 0.5, -1.0, 0.0)], [rectangle(-2.0, 2.0, 0.0, 1.0)], law)
    run = dem.run(bodies, dem.Options(0.1, 0.01, settlement=1e-3))
    if share > 1.0:
        drawn = weight / stiffness
        assert run.reason == "end" and abs(run.place[:, 0, 1] + 0.5 + drawn).max() < 1e-3 * drawn
    else:
        assert run.reason == "unsettled" and run.blamed == [0]


def test_support_settles() -> None:
    bodies = block_on_floor(1.0, 1.0, STIFF)
    run = dem.run(bodies, dem.Options(1.5, 0.1), moves=(dem.SupportMove(1, (0.0, -0.05, 0.0), 0.1, 1.0),))
    assert run.place[-1, 0, 1] - run.settled[0, 1] == pytest.approx(-0.05, abs=1e-5)
    assert run.residual < 0.01
    phase = np.clip((run.time - 0.1) / 1.0, 0.0, 1.0)
    way = -0.05 * (phase - np.sin(2.0 * np.pi * phase) / (2.0 * np.pi))
    assert np.abs(run.place[:, 1, 1] - run.settled[1, 1] - way).max() < 1e-8


def test_step_above_the_critical_one_is_reported() -> None:
    bodies = block_on_floor(1.0, 4.0, STIFF)
    run = dem.run(bodies, dem.Options(1.0, 0.1, step=1.0))
    assert run.reason == "step" and 0.0 < run.critical_step < 1.0


def test_overlapping_blocks_are_named() -> None:
    bodies = model([rectangle(0.0, 1.0, 0.0, 1.0), rectangle(0.9, 1.9, 0.0, 1.0)], [rectangle(-5.0, 5.0, -1.0, 0.0)], STIFF)
    run = dem.run(bodies, dem.Options(1.0, 0.1))
    assert run.reason == "overlap" and sorted(run.blamed) == [0, 1]


def test_a_block_that_leaves_the_domain_is_named() -> None:
    bodies = model([rectangle(0.0, 1.0, 0.0, 1.0), rectangle(30.0, 31.0, 5.0, 6.0)], [rectangle(-5.0, 5.0, -1.0, 0.0)], STIFF)
    options = dem.Options(3.0, 0.1, domain=(-40.0, 40.0, -2.0, 40.0))
    run = dem.run(bodies, options, shift=np.zeros((3, 3)))
    assert run.reason == "left" and run.blamed == [1]


def test_an_open_ledger_stops_the_run() -> None:
    """A ledger that must close to the impossible stops at once, with step and block."""
    bodies = block_on_floor(1.0, 4.0, STIFF)
    run = dem.run(bodies, dem.Options(2.0, 0.1, residual_limit=1e-12), cosine(0.5 * G, 10.88))
    assert run.reason == "blow-up" and run.blamed == [0] and 0 < run.steps and run.stop_time < 2.0


def test_cancel_answers_with_what_it_has(monkeypatch: pytest.MonkeyPatch) -> None:
    bodies = block_on_floor(1.0, 4.0, dem.Law(1e12, 1e12, 2.0, damping=1e-4))
    monkeypatch.setattr(dem_run, "long_call", interrupted(dem_run.long_call, 1.0, lambda: _core.api_support.set_cancel(1)))
    run = dem.run(bodies, dem.Options(3600.0, 0.05), cosine(0.5 * G, 10.88, 3600.0))
    _core.api_support.set_cancel(0)
    assert run.interrupted and len(run.time) > 1
    assert np.isfinite(run.place).all()


@pytest.mark.parametrize(("threads", "moving"), [(1, False), (2, True)])
def test_a_run_pauses_and_goes_on_from_any_state_to_the_same_bits(threads: int, moving: bool) -> None:
    """Blocks that fly apart: contacts go, come, and grow in number; each state is taken to another model."""
    law = dem.Law(1e8, 1e8, 0.4, cohesion=1e4, tension=1e4, damping=1e-4)
    blocks = [rectangle(0.5 * k, 0.5 * k + 0.5, h, h + 0.4) for k in range(6) for h in (0.0, 0.4, 0.8)]
    bodies = model(blocks, [rectangle(-20.0, 20.0, -1.0, 0.0)], law)
    options = dem.Options(0.6, threads=threads, residual_limit=1.0, fraction=0.1, moving_base=moving)
    with as_motion_set([cosine(12.0, 9.0, 0.5)]) as motions:
        with dem.Model(bodies, options) as one:
            whole = one.run(motions)
        states = []
        with dem.Model(bodies, options) as two:
            watched = two.run(motions, watch=lambda t: states.append((t, two.state())))
        assert whole.searches > 3 and whole.place[-1].std() > 0.5 and len(states) > 2
        assert all(0.0 <= a < b <= 0.6 for (a, _), (b, _) in itertools.pairwise(states))
        same_run(watched, whole)
        for _, state in states[:: max(1, len(states) // 3)]:
            with dem.Model(bodies, replace(options, threads=3 - threads)) as other:
                same_run(other.run(motions, state=state), whole)
        broken = states[0][1].copy()
        broken[20] ^= 1
        with dem.Model(bodies, options) as other:
            with pytest.raises(ValueError, match="damaged"):
                other.run(motions, state=broken)
            with pytest.raises(ValueError, match="with other output times"):
                other.run(motions, state=states[0][1], times=[0.0, 0.1])


def same_run(one: dem.Run, two: dem.Run) -> None:
    for item in fields(dem.Run):
        a, b = getattr(one, item.name), getattr(two, item.name)
        if item.name == "energy":
            a, b = (np.stack(list(e.values())) for e in (a, b))
        if item.name == "contacts":
            for name in ("bodies", "point", "force", "normal", "shear"):
                np.testing.assert_array_equal(getattr(a, name), getattr(b, name))
        else:
            np.testing.assert_array_equal(a, b, item.name)
