"""Mortar and dowels on rigid contacts: closed forms, springs of growing stiffness, limit analysis with mortar."""

from dataclasses import replace

import numpy as np
import pytest
from dem_models import G, block_on_floor, constant, model, pieces, rectangle
from test_dem3_core import DENSITY, doweled_cube, hanging, solids
from test_dem3_nonsmooth import STILL, slope

import extrados
from extrados.analyses.dem.impact_rules import ContactValues, Impact
from extrados.analyses.dem.model import doubts_of_rigid_mortar
from extrados.core import dem, dem3, dem_run
from extrados.core.ground import Ground, as_motion_set
from extrados.model.geometry.solids.polyhedra import box

WEIGHT = DENSITY * G  # of a cube of a metre, and of a block 1 x 1 m in the plane
ANY = 1e9  # stiffness: rigid contacts do not require it


def mortar(friction: float, cohesion: float, tension: float, stiffness: float = ANY) -> dem.Law:
    return dem.Law(stiffness, stiffness, friction, cohesion=cohesion, tension=tension, damping=2e-3 * ANY / stiffness)


BLOCK = {
    "structure": {"kind": "block", "width": 1.0, "height": 3.0},
    "motion": {"kind": "step-pulse", "amplitude": "0.1 m/s^2", "duration": 0.01},
}
SHORT = {"kind": "dem", "end_time": 0.01, "perturbed": False}


def rigid(end: float, output: float = 0.01, **keys: object) -> dem.Options:
    return dem.Options(end, output, rigid=True, **keys)


def rigid_in_space(end: float, output: float = 0.01, **keys: object) -> dem3.Options:
    return dem3.Options(end, output, rigid=True, **keys)


def bonded(one: dem3.Solids) -> dem3.Solids:
    """A cube on a floor whose one law has mortar: contacts that form later have none."""
    return replace(one, laws=[replace(one.laws[0], cohesion=0.0, tension=0.0), one.laws[0]], joints={(0, 1): 1})


@pytest.mark.parametrize("share", [0.99, 1.01])
def test_a_block_hangs_up_to_its_tension(share: float) -> None:
    """The weight comes without overshoot; a block too heavy for its mortar falls as it settles."""
    bodies = model([rectangle(-0.5, 0.5, -1.0, 0.0)], [rectangle(-2.0, 2.0, 0.0, 1.0)], mortar(0.6, 1e6, share * WEIGHT))
    run = dem.run(bodies, rigid(0.3, settlement=1e-3))
    if share > 1.0:
        assert run.reason == "end" and np.abs(run.place[:, 0] - run.settled[0]).max() < 1e-9
        assert run.residual < 1e-6
    else:
        assert run.reason == "unsettled" and run.blamed == [0]
    in_space = dem3.run(hanging(mortar(0.6, 1e6, share * WEIGHT)), rigid_in_space(0.3, settlement=1e-3))
    assert in_space.reason == run.reason
    falls = dem3.run(hanging(mortar(0.6, 1e6, share * WEIGHT)), rigid_in_space(0.3), rate=STILL)
    fall = falls.place[0, 0, 2] - falls.place[-1, 0, 2]
    assert fall == pytest.approx(0.0 if share > 1.0 else 0.5 * G * 0.3**2, rel=0.02, abs=1e-9)


@pytest.mark.parametrize("ratio", [0.995, 1.005])
@pytest.mark.parametrize("tension", [0.0, 0.4, 1.5])
def test_a_bonded_block_tips_at_its_closed_form(tension: float, ratio: float) -> None:
    """a / g = b / h (1 + f_t b / W), from moments about the edge, of a block b x h; in the plane and in space."""
    width, height = 1.0, 4.0
    weight = WEIGHT * width * height
    least = width / height * (1.0 + tension) * G
    law = mortar(2.0, 10.0 * weight, tension * weight / width)
    run = dem.run(block_on_floor(width, height, law), rigid(6.0, 0.1, collapse=0.5, step=2e-3), constant(ratio * least))
    assert (run.reason == "collapse") == (ratio > 1.0)
    one = bonded(solids([box((-0.5, -0.5, 0), (0.5, 0.5, height))], law))
    turned = rigid_in_space(6.0, 0.1, collapse=0.5, step=2e-3, way=(0.0, 1.0, 0.0))
    run = dem3.run(one, turned, constant(ratio * least))
    assert (run.reason == "collapse") == (ratio > 1.0)


@pytest.mark.parametrize("ratio", [0.995, 1.005])
def test_a_bonded_block_slides_beyond_cohesion_and_friction(ratio: float) -> None:
    """a / g = mu + c b / W, and then g (a / g - mu): cohesion is lost for good."""
    mu, cohesion = 0.3, 0.2
    law = mortar(mu, cohesion * WEIGHT, 0.0)
    flat = model([rectangle(-2.0, 2.0, 0.0, 0.25)], [rectangle(-20.0, 20.0, -1.0, 0.0)], replace(law, cohesion=0.25 * law.cohesion))
    acceleration = ratio * (mu + cohesion) * G
    run = dem.run(flat, rigid(0.5, step=1e-3), constant(acceleration))
    way = run.settled[0, 0] - run.place[-1, 0, 0]
    assert way == pytest.approx(0.5 * (acceleration - mu * G) * 0.5**2 if ratio > 1.0 else 0.0, rel=0.01, abs=1e-9)


@pytest.mark.parametrize("direction", [0.0, 33.0, 120.0])
@pytest.mark.parametrize("share", [0.95, 1.05])
def test_mortar_on_a_slope_in_any_direction(share: float, direction: float) -> None:
    """A cube sticks by cohesion; once that is lost, friction alone brakes it, straight down the slope."""
    mu, tangent = 0.2, np.tan(np.radians(35.0))
    gravity = slope(tangent, direction)
    needed = WEIGHT * (np.sin(np.radians(35.0)) - mu * np.cos(np.radians(35.0)))
    cube = bonded(solids([box((-1, -1, 0), (1, 1, 0.25))], mortar(mu, 0.25 * share * needed, WEIGHT)))
    run = dem3.run(cube, rigid_in_space(0.5, gravity=gravity, step=1e-3), rate=STILL)
    gone = np.linalg.norm(run.place[-1, 0] - run.place[0, 0])
    assert gone == pytest.approx(0.0 if share > 1.0 else 0.5 * needed / DENSITY * 0.5**2, rel=0.01, abs=1e-9)
    assert run.effort.open_steps == 0


def test_what_was_sheared_off_is_gone() -> None:
    """A jolt shears a cube off; later friction alone brakes it, where mortar would hold."""
    mu = 0.2
    cube = bonded(solids([box((-1, -1, 0), (1, 1, 0.25))], mortar(mu, 0.125 * WEIGHT, WEIGHT)))
    t = np.arange(0.0, 1.0, 1e-3)
    for jolt, way in ((0.3, 0.0), (0.9, 0.5 * (0.4 - mu) * G * 0.4**2)):
        samples = np.where(t < 0.05, -jolt, np.where(t < 0.6, 0.0, -0.4)) * G
        run = dem3.run(cube, rigid_in_space(0.999, 0.001), Ground(samples=samples[None], step=1e-3))
        at = int(np.searchsorted(run.time, 0.59))
        assert run.place[-1, 0, 0] - run.place[at, 0, 0] == pytest.approx(way, rel=0.03, abs=1e-6)


def test_springs_of_growing_stiffness_come_to_rigid_contacts() -> None:
    """A bonded column of two blocks under a pulse that tears its lower joint: rotations of the springs approach."""
    law = mortar(0.7, 1e6, 0.3 * WEIGHT)
    column = [rectangle(-0.5, 0.5, 0.0, 2.0), rectangle(-0.5, 0.5, 2.0, 4.0)]
    bodies = model(column, [rectangle(-20.0, 20.0, -1.0, 0.0)], law)
    pulse = pieces([0.0, 0.3], [0.45 * G])
    times = np.arange(0.0, 0.6, 0.01)
    wanted = dem.run(bodies, rigid(0.6, step=2e-4), pulse, times=times).place[:, :2, 2]
    assert np.abs(wanted).max() > 0.02
    assert np.abs(wanted[:, 0] - wanted[:, 1]).max() < 1e-6  # the upper joint holds
    apart = []
    for stiffness in (1e9, 1e10, 1e11):
        springs = replace(bodies, laws=[mortar(0.7, 1e6, 0.3 * WEIGHT, stiffness)])
        found = dem.run(springs, dem.Options(0.6), pulse, times=times).place[:, :2, 2]
        apart.append(np.abs(found - found[0] - wanted).max() / np.abs(wanted).max())
    assert apart[2] < 0.015 and apart[0] > apart[1] > apart[2]


@pytest.mark.parametrize("way", [0.0, 50.0, 200.0])
def test_a_dowel_carries_shear_in_any_direction(way: float) -> None:
    """On a slope an unbroken dowel holds what friction does not; one that yields brakes with its strength, as with springs."""
    mu = 0.2
    gravity = slope(np.tan(np.radians(35.0)), way)
    down = np.array([np.cos(np.radians(way)), np.sin(np.radians(way)), 0.0])
    needed = WEIGHT * (np.sin(np.radians(35.0)) - mu * np.cos(np.radians(35.0)))
    held = dem3.run(doweled_cube(np.inf), rigid_in_space(0.5, gravity=gravity))
    assert np.linalg.norm(held.place[-1, 0] - held.place[0, 0]) < 1e-9 and held.dowel_slip[0] == 0.0
    strength = 0.4 * needed
    run = dem3.run(doweled_cube(strength), rigid_in_space(0.5, gravity=gravity, step=1e-3), rate=STILL)
    moved = run.place[-1, 0] - run.place[0, 0]
    assert moved @ down == pytest.approx(0.5 * (needed - strength) / DENSITY * 0.5**2, rel=2e-3)
    assert np.linalg.norm(moved - (moved @ down) * down) < 1e-4
    assert run.dowel_slip[0] == pytest.approx(moved @ down, rel=0.01)
    assert run.residual < 1e-3 and run.effort.open_steps == 0


@pytest.mark.parametrize(("reach", "out"), [(0.049, True), (0.051, False)])
def test_a_dowel_comes_out_beyond_its_reach(reach: float, out: bool) -> None:
    """A cube that leaves the floor by 5 cm, without weight."""
    options = rigid_in_space(0.5, 0.1, gravity=(0, 0, 0), step=1e-3)
    run = dem3.run(doweled_cube(np.inf, reach), options, rate=np.array([[0, 0, 0.1, 0, 0, 0], np.zeros(6)]))
    assert bool(run.dowel_out[0]) == out


def test_a_dowel_keeps_momentum() -> None:
    """Two floating cubes that turn, held in the joint by a dowel alone: momenta, and its places one above the other."""
    cubes = [box((-0.5, -0.5, k), (0.5, 0.5, k + 0.9)) for k in range(2)]
    place = np.array([[0.2, 0.1, 0.95]])
    one = dem3.Dowels(np.array([[0, 1]]), place, np.array([[0.0, 0.0, 1.0]]), np.array([1e6]), np.array([np.inf]), np.array([np.inf]))
    whole = replace(solids(cubes, dem.Law(ANY, ANY, 0.0), floor=False), dowels=one)
    rate = np.array([[0.05, 0.02, -0.2, 0.1, 0.0, 0.3], [-0.05, 0.0, 0.2, 0.0, -0.1, -0.2]])
    run = dem3.run(whole, rigid_in_space(0.5, 0.05, gravity=(0, 0, 0), step=1e-3), rate=rate)
    inertia = run.turn @ whole.inertia @ np.swapaxes(run.turn, 2, 3)
    linear = whole.mass[:, None] * run.rate[:, :, :3]
    moment = (np.einsum("tnij,tnj->tni", inertia, run.rate[:, :, 3:]) + np.cross(run.place, linear)).sum(axis=1)
    assert np.abs(np.diff(linear.sum(axis=1), axis=0)[1:]).max() < 1e-9 * np.abs(linear).max()
    assert np.abs(moment[2:] - moment[1]).max() < 1e-3 * np.abs(moment).max()
    ends = [run.place[:, k] + np.einsum("tij,j->ti", run.turn[:, k], place[0] - whole.centroid[k]) for k in range(2)]
    away = np.einsum("ti,tij->tj", ends[1] - ends[0], run.turn[:, 0])
    assert np.abs(away[1:, :2]).max() < 1e-4


def test_a_run_with_mortar_and_dowels_pauses_to_the_same_bits(monkeypatch: pytest.MonkeyPatch) -> None:
    drums = [box((-0.5, -0.5, k), (0.5, 0.5, k + 1)) for k in range(3)]
    one = solids(drums, mortar(0.6, 1e4, 1e4))
    pairs, n = np.array([[3, 0], [0, 1], [1, 2]]), np.ones(3)
    places = np.array([[0, 0, 0.0], [0, 0, 1.0], [0, 0, 2.0]])
    whole = replace(one, dowels=dem3.Dowels(pairs, places, np.tile([0.0, 0.0, 1.0], (3, 1)), n, 200.0 * n, [1e-4, 1.0, 1.0] * n))
    options, shake = rigid_in_space(0.6), pieces([0.0, 0.2, 0.4], [0.8 * G, -0.8 * G])
    found = [dem3.run(whole, replace(options, threads=k), shake) for k in (1, 2)]
    assert found[0].dowel_slip.max() > 0.0 and found[0].dowel_out.any()
    kept: list[np.ndarray] = []
    monkeypatch.setattr(dem_run, "FIRST_PAUSE", 50)
    with dem3.Model(whole, options) as other, as_motion_set([shake]) as motions:
        found.append(other.run(motions, watch=lambda reached: kept.append(other.state())))
    with dem3.Model(whole, options) as other, as_motion_set([shake]) as motions:
        found.append(other.run(motions, state=kept[-1]))
    for run in found[1:]:
        for name in ("place", "dowel_slip", "dowel_out"):
            assert (getattr(run, name) == getattr(found[0], name)).all()


@pytest.mark.parametrize("solver", ["compliant", "nonsmooth"])
@pytest.mark.parametrize(("tension", "less"), [(1.6e5, False), (1.7e5, True)])
def test_tension_above_cohesion_over_friction_is_stated(solver: str, tension: float, less: bool) -> None:
    """Coulomb's law lets no point bear more than c / mu: with either law of contact it breaks there."""
    deck = BLOCK | {"joints": {"friction": 0.6, "cohesion": 1e5, "tension": tension}, "analysis": SHORT | {"solver": solver}}
    found = extrados.run(deck).results[0]
    assert found.status == "ok"
    assert any("167 kPa instead of 170 kPa" in text for text in found.warnings) is less


@pytest.mark.parametrize("way", [{}, {"direction": 30.0}])
def test_mortar_that_cannot_slide_is_refused_on_rigid_contacts(way: dict[str, float]) -> None:
    deck = BLOCK | {"joints": {"friction": "no-sliding", "cohesion": 1e5}, "analysis": SHORT | way | {"solver": "nonsmooth"}}
    assert "cannot have mortar: give the coefficient" in extrados.run(deck).results[0].reason
    del deck["joints"]["cohesion"]
    assert extrados.run(deck).results[0].status == "ok"


@pytest.mark.parametrize(("count", "name", "words"), [(1, "joint", "one joint carries"), (2, "contact", "2 contacts carry")])
def test_the_limit_of_tension_is_stated_of_one_joint_and_of_several(count: int, name: str, words: str) -> None:
    stiffness, friction, cohesion, tension, frequency = (np.full(count, value) for value in (ANY, 0.5, 1e5, 1e6, 1.0))
    values = ContactValues(stiffness, stiffness, friction, cohesion, tension, 0.0, Impact(frequency, frequency, frequency))
    assert any(
        text.startswith(f"{words} less tension") and "200 kPa instead of 1e+03" in text for text in doubts_of_rigid_mortar(values, name)
    )
