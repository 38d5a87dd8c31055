"""Rocking that hands over to rigid contacts: the criterion, the state, and the outcome of the whole motion."""

import re
import time
from dataclasses import fields, replace

import numpy as np
import pytest

import extrados
from extrados.analyses.context import Context
from extrados.analyses.rocking.failure_domain import unit_pulse
from extrados.analyses.rocking.hand_over import STEPS, Contacts, Fate, Fates, Leaving, Left, contacts_of, leaving_time, level_of
from extrados.analyses.statistics.fragility import empty_rows
from extrados.analyses.statistics.handed import Handed
from extrados.core import dem
from extrados.core.rocking import history
from extrados.decks.reader import make_deck
from extrados.motions import pulses
from extrados.schema.constants import GRAVITY

VAULT = {"kind": "vault", "preset": "dejong-a"}
ARCH = {"kind": "arch", "radius": 10.0, "thickness": 1.5, "embrace": 157.5, "voussoirs": 7}
#: Outcomes of `dem` in the words of `rocking`
WORDS = {"at-rest": "no-hinging", "slid": "slid", "rocked": "recovery", "collapse": "collapse"}
#: Of codes of maps; two modes of collapse, of which harmonic maps have one
WORDS_OF_MAP = {0: "no-hinging", 1: "recovery", 2: "collapse", 3: "collapse", 4: "slid"}


def sine(amplitude: float, period: float) -> dict:
    return {"kind": "sine-pulse", "amplitude": f"{amplitude} g", "period": period}


def both(structure: dict, friction: float, motion: dict, floor: float | None = None, **keys):
    """`rocking` and `dem` on rigid contacts, of the same blocks; floor [m]: the level on which they slide. Both call the same
    displacement collapse."""
    building = building_of(structure, friction)
    fallen = contacts_of(building.rocker(soft_base=True), building).fallen
    contacts = {"kind": "dem", "solver": "nonsmooth", "perturbed": False, "collapse_displacement": fallen}
    contacts |= {} if floor is None else {"floor": floor}
    deck = {"structure": structure, "joints": {"friction": friction}, "motion": motion}
    run = extrados.run(deck | {"analysis": [{"kind": "rocking", **keys}, contacts]})
    return run.results[0], run["dem"]


def building_of(structure: dict, friction: float = 0.7):
    deck = {"structure": structure, "joints": {"friction": friction}, "analysis": {"kind": "failure-domain"}}
    return make_deck(deck).buildings[0]


def slide_rock(half: float, high: float, friction: float, push: float) -> tuple[float, float]:
    """Accelerations of a block pushed from rest [m/s^2], about its toe [rad/s^2] and of the toe along the base (Shenton 1996).

    half, high: half width and height of the centre [m]. Newton and Euler with friction fully used at the toe.
    """
    lever = friction * high - half
    spin = GRAVITY * lever / ((half**2 + high**2) / 3.0 - half * lever)
    return spin, push - friction * (GRAVITY + half * spin) - high * spin


def shenton(half: float, high: float, friction: float, push: float) -> str:
    """Mode in which a rectangular block starts from rest under a constant push [m/s^2] (Shenton 1996, Fig. 2)."""
    if friction <= half / high:
        return "slide" if push > friction * GRAVITY else "rest"
    if push <= half / high * GRAVITY:
        return "rest"
    spin = 0.75 * (push * high - GRAVITY * half) / (half**2 + high**2)
    return "rock" if push - high * spin <= friction * (GRAVITY + half * spin) else "slide-rock"


@pytest.mark.parametrize("half", [0.15, 0.25, 0.5])
def test_a_block_leaves_its_mechanism_in_the_regions_of_shenton(half: float) -> None:
    """Rest, slide, rock or slide-rock under a constant push: the watch against Shenton's closed form, 400 blocks and pushes."""
    seen = set()
    for friction in np.linspace(0.07, 1.15, 20):
        rocker = building_of({"kind": "block", "width": 2.0 * half, "height": 1.0}, float(friction)).rocker()
        for push in np.linspace(0.05, 2.4, 20) * GRAVITY:
            wanted = shenton(half, 0.5, float(friction), float(push))
            r = history(rocker.body, pulses.step_pulse(-float(push), 0.02).ground, 0.01, 0.01)
            slips = r.joints.slips_at >= 0.0
            seen.add(wanted)
            assert slips == (wanted in ("slide", "slide-rock")), (friction, push / GRAVITY)
            assert not slips or leaving_time(r, 0.0, rocker.time_unit) == 0.0
            if not slips:
                assert (r.outcome == "no-hinging") == (wanted == "rest")
            elif push < half / 0.5 * GRAVITY:  # it rests and slides
                assert r.joints.slips < 0
    assert seen == {"rest", "slide", "rock", "slide-rock"}


@pytest.mark.parametrize(("friction", "push"), [(0.6, 1.4), (0.7, 1.8), (0.8, 2.9)])
def test_contacts_slide_and_rock_as_newton_and_euler(friction: float, push: float) -> None:
    """Block .5 x 1 m handed over at once: spin and slip of the first hundredth of a second."""
    building = building_of({"kind": "block", "width": 0.5, "height": 1.0}, friction)
    rocker = building.rocker()
    ground = pulses.step_pulse(-push * GRAVITY, 0.2).ground
    contacts = contacts_of(rocker, building)
    shift, rate = contacts.begin(ground, 0.0).state(1.0)
    run = dem.run(contacts.bodies, dem.Options(0.01, 0.01, step=1e-5, rigid=True), ground.seen_from(0.0), shift=shift, rate=rate)
    spin, along = slide_rock(0.25, 0.5, friction, push * GRAVITY)
    assert along > 0.0 and spin > 0.0
    turned = -run.place[-1, 0, 2]
    toe = run.place[-1, 0, 0] + 0.25 * np.cos(turned) - 0.5 * np.sin(turned) - 0.25
    assert turned == pytest.approx(0.5 * spin * 1e-4, rel=0.01)
    assert toe == pytest.approx(0.5 * along * 1e-4, rel=0.01)


@pytest.mark.parametrize("structure", [{"kind": "block", "width": 0.5, "height": 1.5}, ARCH])
def test_the_state_that_is_handed_over_is_that_of_the_mechanism(structure: dict) -> None:
    """Handed over in the midst of rocking: energy of the bodies, and the way they go on, beside the mechanism."""
    building = building_of(structure, 5.0)
    rocker = building.rocker()
    motion = pulses.sine_pulse(-1.1 * rocker.uplift * GRAVITY, 10.0 * rocker.time_unit)
    contacts = contacts_of(rocker, building)
    unit = rocker.time_unit
    r = history(rocker.body, motion.ground, 3.5 * unit, 0.01 * unit)
    moving = np.flatnonzero(r.rotation)
    k = int(moving[0]) + 30
    begin = contacts.begin(motion.ground, float(r.time[k]))
    shift, rate = begin.state(1.0)
    rigid = contacts.model.rigid
    mass = np.stack([rigid.mass, rigid.mass, rigid.inertia], axis=1)
    assert r.rotation[k] > 0.0 and 0.5 * float((mass * rate**2).sum()) == pytest.approx(r.kinetic[k], rel=1e-6)
    assert GRAVITY * float(rigid.mass @ shift[:, 1]) == pytest.approx(r.potential[k], rel=1e-6)
    later = 60
    assert not r.impacts and r.joints.leaves_at < 0.0 and abs(r.rotation[k + later]) > 1.3 * abs(r.rotation[k])
    span = float(r.time[k + later] - r.time[k])
    run = dem.run(
        contacts.bodies, dem.Options(span, span, step=span / 4000, rigid=True), motion.ground.seen_from(begin.time), shift=shift, rate=rate
    )
    after, _ = contacts.begin(motion.ground, float(r.time[k + later])).state(1.0)
    moved = np.abs(after[:, 2]).max()
    n = rigid.count
    assert run.place[-1, :n, 2] == pytest.approx(after[:n, 2], abs=0.01 * moved)


def test_nothing_is_handed_over_where_all_conditions_hold() -> None:
    """A block at friction .8 rocks by its mechanism alone, to the bit."""
    block = {"kind": "block", "width": 0.5, "height": 1.5}
    alone, _ = both(block, 0.8, sine(0.5, 0.8), hand_over=False)
    found, _ = both(block, 0.8, sine(0.5, 0.8))
    assert found.results.hand_over is None and found.results == alone.results


#: Friction, period [s], amplitude [g] of sines on blocks of width and height [m]
SLIDING = [(mu, period, a) for mu in np.arange(1, 9) / 10 for period in (0.3, 0.6, 1.2) for a in (0.25, 0.5, 0.8, 1.2)]


@pytest.mark.parametrize(("width", "height"), [pytest.param(0.45, 1.0, marks=pytest.mark.verify), (0.3, 0.9)])
def test_blocks_that_slide_or_rock_end_as_on_rigid_contacts(width: float, height: float) -> None:
    """96 sines over friction .1 to .8: the outcome of the whole motion, and where it slides, how far."""
    block = {"kind": "block", "width": width, "height": height}
    over = 0
    for friction, period, amplitude in SLIDING:
        found, contacts = both(block, float(friction), sine(amplitude, period), 0.0)
        r = found.results
        assert r.outcome == WORDS[contacts.outcome], (friction, period, amplitude)
        if r.hand_over is not None:
            over += 1
            if r.outcome != "collapse":
                assert r.hand_over.contacts.peak_slip_m == pytest.approx(contacts.peak_slip_m, rel=0.02, abs=1e-3)
            assert r.hand_over.reason and r.hand_over.time_s < period
    assert over > 30


#: Sines on the vault: every other cell of the 25 of 2 to 4 times its capacity
CELLS = [(period, factor) for period in (0.7, 0.9, 1.1, 1.3, 1.5) for factor in (2.0, 2.5, 3.0, 3.5, 4.0)]


@pytest.mark.parametrize("cell", [pytest.param(c, marks=() if c in {(0.7, 4.0), (1.3, 2.5)} else pytest.mark.verify) for c in CELLS])
def test_the_vault_ends_as_on_rigid_contacts(cell: tuple[float, float]) -> None:
    """All 25 cells of its map; fixed hinges err in 9 of them."""
    found, contacts = both(VAULT, 0.7, sine(0.134 * cell[1], cell[0]))
    assert found.results.outcome == WORDS[contacts.outcome]
    over = found.results.hand_over
    assert over.reason.startswith("Hinges form at other joints: the thrust line passes outside joint")
    assert over.contacts.energy_residual_ratio < 0.01
    wanted = {"collapse": "collapses", "recovery": "stands"}[found.results.outcome]
    assert found.verdict.outcome == ("open" if over.contacts.decided_by_last_digits else wanted)


def test_cells_of_a_map_are_decided_by_contacts() -> None:
    """A block at friction .35, which slides at rest or not: the map against single runs, and the verdict of a pulse of it."""
    block = {"kind": "block", "width": 0.3, "height": 0.9}
    domain = {"kind": "failure-domain", "pulse": "sine", "durations": [0.6, 1.2], "amplitudes": 5, "max_amplitude": "1.2 g"}
    deck = {"structure": block, "joints": {"friction": 0.35}, "motion": sine(0.96, 1.2), "analysis": domain}
    found = extrados.run(deck).results[0]
    codes = found.arrays["outcome"].data
    assert found.results.handed_over and not found.results.conditions.violated
    for i, period in enumerate((0.6, 1.2)):
        for k in range(5):
            one, _ = both(block, 0.35, sine(-0.24 * (k + 1), period), 0.0)
            assert WORDS_OF_MAP[codes[i, k]] == one.results.outcome
    assert found.verdict.outcome in ("stands", "collapses")
    few = extrados.run(deck | {"analysis": domain | {"hand_over_cells": 1}}).results[0]
    assert few.results.handed_over is None and few.verdict.outcome == "open"
    assert any("`hand_over_cells` = 1" in text for text in few.warnings)


def test_the_equations_of_slender_blocks_are_not_handed_over() -> None:
    """form = "linear" is another model than that of the blocks: the outcome is open."""
    motion = sine(0.7, 0.6)
    found, _ = both({"kind": "block", "width": 0.5, "height": 1.0}, 0.3, motion, form="linear")
    assert found.results.hand_over is None and found.verdict.outcome == "open"


def test_a_block_that_slides_far_stays_on_the_ground() -> None:
    """Block .5 x .3 m, friction .2, sine .5 g, 1 s: slides .233 m at most and rests at -.020 m (an integration of Coulomb's law)."""
    found, _ = both({"kind": "block", "width": 0.5, "height": 0.3}, 0.2, sine(0.5, 1.0))
    run = found.results.hand_over.contacts
    assert found.results.outcome == "slid" and not run.off_footing
    place = found.arrays["contacts_place"].data[:, 0, 0]
    assert np.abs(place).max() == pytest.approx(0.233, abs=0.001) and abs(place[-1]) == pytest.approx(0.020, abs=0.001)
    assert run.peak_slip_m == pytest.approx(0.233, abs=0.001)


def test_the_history_of_slip_reaches_the_greatest_slip() -> None:
    """An arch whose joints open over their whole length at the end: the figure draws no slip of these."""
    arch = {"kind": "arch", "radius": 3.2, "thickness": 0.5, "embrace": 160.0, "voussoirs": 11}
    run = extrados.run({"structure": arch, "motion": sine(0.5, 0.8), "analysis": {"kind": "rocking"}}).results[0]
    drawn = np.nanmax(np.abs(run.arrays["contacts_slip"].data))
    assert drawn == pytest.approx(run.results.hand_over.contacts.peak_slip_m, rel=1e-9)


def test_a_mirrored_motion_slides_to_the_other_side() -> None:
    """Slip, rotation and outcome of a block that slides as it rocks, under a motion and its mirror."""
    block = {"kind": "block", "width": 0.45, "height": 1.0}
    one, other = (both(block, 0.47, sine(side * 0.9, 0.4), 0.0)[0] for side in (1.0, -1.0))
    assert one.results.outcome == other.results.outcome == "recovery"
    for name in ("contacts_rotation", "contacts_slip"):
        x, y = (np.nan_to_num(run.arrays[name].data) for run in (one, other))
        shared = min(len(x), len(y))  # they come to rest within a step of each other
        assert np.abs(x).max() > 1e-3 and x[:shared] == pytest.approx(-y[:shared], abs=5e-3 * np.abs(x).max())


STACK = {"kind": "stack", "lower_width": 1.0, "lower_height": 1.5, "upper_width": 0.8, "upper_height": 1.5}
#: Friction, period [s], amplitude [g] of sines on the stack
PAIRS = [(mu, period, a) for mu in (0.3, 0.45, 0.6, 0.75) for period in (0.5, 0.9, 1.4) for a in (0.4, 0.6, 0.9)]


@pytest.mark.parametrize("chosen", [pytest.param(PAIRS, marks=pytest.mark.verify), [(0.3, 0.9, 0.6), (0.6, 0.9, 0.6)]])
def test_stacks_that_slide_end_as_on_rigid_contacts(chosen: list) -> None:
    """Outcome of the whole motion, and how far the blocks slide, against contacts from rest."""
    over, wrong = 0, []
    for friction, period, amplitude in chosen:
        found, contacts = both(STACK, friction, sine(amplitude, period), 0.0)
        r = found.results
        if r.hand_over is None:
            continue
        over += 1
        assert r.hand_over.reason and not found.arrays["time"].data[-1] > r.hand_over.time_s
        if r.outcome != WORDS[contacts.outcome] and not (contacts.decided_by_last_digits or r.decided_by_last_digits):
            wrong.append((friction, period, amplitude, r.outcome, contacts.outcome))
        elif r.outcome != "collapse":
            assert r.hand_over.contacts.peak_slip_m == pytest.approx(contacts.peak_slip_m, rel=2e-3, abs=2e-4)
    assert over >= min(2, len(chosen)) and not wrong, wrong


def reach_of(contacts: Contacts) -> float:
    """Greatest displacement of a centre at the critical rotations [m]."""
    return float(np.linalg.norm(contacts.leaving.unstable, axis=-1).max())


@pytest.mark.parametrize("structure", [{"kind": "block", "width": 0.8, "height": 1.2}, STACK | {"lower_width": 1.4}, ARCH, VAULT])
def test_blocks_that_may_recover_have_not_collapsed(structure: dict) -> None:
    """At the critical rotation, from which the motion may bring them back, no block is as far away as collapse; on its side it is."""
    building = building_of(structure)
    contacts = contacts_of(building.rocker(soft_base=True), building)
    assert contacts.fallen >= max(1.5 * reach_of(contacts), 0.2 * contacts.model.size) > 0.0
    if structure["kind"] == "block":
        corner = np.array([0.4, 0.6])  # from the toe to the centre, upright; then on its side
        angle = np.arctan2(0.4, 0.6)
        at_rest, critical, lying = np.array([-0.4, 0.6]), np.array([0.0, np.hypot(0.4, 0.6)]), corner[::-1]
        assert angle == pytest.approx(building.rocker().critical[0])
        assert reach_of(contacts) == pytest.approx(np.hypot(*(critical - at_rest)), rel=1e-6)
        assert contacts.fallen < np.hypot(*(lying - at_rest))


@pytest.mark.parametrize("width", [1.5, 2.0, 3.0])
def test_a_stout_block_on_its_side_has_overturned(width: float) -> None:
    """At rest after a quarter turn about its toe it is nearer than the limit of displacement, and does not count as recovered."""
    building = building_of({"kind": "block", "width": width, "height": 1.0}, 5.0)
    contacts = contacts_of(building.rocker(soft_base=True), building)
    half = np.array([0.5 * width, 0.5])
    away = np.hypot(*(half[::-1] - [-half[0], half[1]]))
    assert away < contacts.fallen
    lying = np.array([[0.0], [away]]), np.array([[0.0], [0.5 * np.pi]]), np.array([[0.0], [0.5 - half[0]]])
    assert contacts.collapse.reached(*lying).tolist() == [[False], [True]]
    swung = [np.concatenate([part, part[:1]]) for part in lying]  # it has come back
    assert not contacts.collapse.reached(*swung).any()


def test_a_stack_that_leans_far_and_returns_has_not_collapsed() -> None:
    """Stout blocks turn by .24 rad, .78 of the critical rotation, and come back: a fifth of the size is no collapse there."""
    stack = {"kind": "stack", "lower_width": 1.37, "upper_width": 0.954, "lower_height": 2.53, "upper_height": 1.15}
    found, contacts = both(stack, 0.79, sine(-1.6048, 0.7551), 0.0)
    assert found.results.outcome == "recovery" and WORDS[contacts.outcome] == "recovery"
    assert found.results.peak_rotation_ratio == pytest.approx(0.78, abs=0.02)


def test_the_state_of_a_stack_is_handed_over_with_its_rates() -> None:
    """Velocities of both centres against differences of their places, in each mode."""
    model = building_of(STACK).rocker(soft_base=True).model
    rotation, rate, step = np.array([0.05, -0.02]), np.array([0.4, -0.3]), 1e-6
    for state in ((1, -1), (-1, 1), (1, 0), (0, -1)):
        contacts = np.array(state, dtype=float)
        q = np.array([0.0 if state[0] == 0 else rotation[0], rotation[0] if state[1] == 0 else rotation[1]])
        v = np.array([0.0 if state[0] == 0 else rate[0], rate[0] if state[1] == 0 else rate[1]])
        places = model.pose(np.array([q - step * v, q + step * v]), np.array([contacts, contacts]))
        assert model.velocity(q, v, contacts) == pytest.approx((places[1] - places[0]) / (2.0 * step), abs=1e-8)


def test_cells_of_a_harmonic_map_are_decided_by_contacts() -> None:
    """A block at friction .35: the map with hand-over against single runs, and the warning where cells are too many."""
    block = {"kind": "block", "width": 0.3, "height": 0.9}
    harmonic = {"kind": "harmonic-map", "cycles": 2, "frequencies": [0.8, 2.0], "amplitudes": 4, "max_amplitude": "1.2 g"}
    deck = {"structure": block, "joints": {"friction": 0.35}, "analysis": harmonic}
    found = extrados.run(deck).results[0]
    codes = found.arrays["outcome"].data
    assert found.results.handed_over and not found.results.conditions.violated
    for i, frequency in enumerate((0.8, 2.0)):
        for k in range(4):
            motion = {"kind": "harmonic", "amplitude": f"{0.3 * (k + 1)} g", "frequency": frequency, "duration": 2 / frequency}
            one, _ = both(block, 0.35, motion, 0.0)
            assert WORDS_OF_MAP[codes[i, k]] == one.results.outcome, (frequency, k)
    few = extrados.run(deck | {"analysis": harmonic | {"hand_over_cells": 1}}).results[0]
    assert few.results.handed_over is None and few.results.conditions.violated


@pytest.mark.parametrize("height", [0.0, 3.0, 1e-3])
def test_ground_that_rounding_moves_is_at_zero(height: float) -> None:
    """The springings of an ellipse end at cos 90 degrees, 4e-16 m above the ground, which is no height of a deck."""
    structure = {"kind": "elliptical-arch", "span": 8.0, "rise": 3.0, "thickness": 0.9, "voussoirs": 12}
    blocks = building_of(structure).blocks()
    ends = np.concatenate([blocks.p, blocks.q])
    assert np.abs(ends[np.abs(ends[:, 1]) < 1e-9, 1]).max() > 0.0  # rounding is there
    raised = replace(blocks, p=blocks.p + np.array([0.0, height]), q=blocks.q + np.array([0.0, height]))
    assert level_of(raised) == (0.0 if height == 0.0 else pytest.approx(height, rel=1e-12))


def test_a_stack_that_starts_turned_rocks_before_it_is_handed_over() -> None:
    """Without uplift before the joint slides: the start itself is rocking."""
    deck = {"structure": STACK, "joints": {"friction": 0.2}, "initial": {"rotation_ratio": 0.3}, "analysis": {"kind": "failure-domain"}}
    building = make_deck(deck).buildings[0]
    rocker = building.rocker(soft_base=True)
    left = contacts_of(rocker, building).leaving.leave(pulses.sine_pulse(0.5 * GRAVITY, 0.9).ground, 5.0, 1.0)
    assert rocker.start_rotation > 0.0 and left.time == 0.0 and left.rocks


def test_the_share_of_a_handed_stack_is_that_of_its_own_limits() -> None:
    """Rotations of both as one over their limit, and of the upper against the lower over its own."""
    building = building_of(STACK)
    leaving = contacts_of(building.rocker(soft_base=True), building).leaving
    whole, alone = leaving.pair.whole[0], leaving.pair.alone[0]
    assert leaving.greatest(np.array([[0.0, 0.0], [-0.06, -0.06]])) == pytest.approx((-0.06, 0.06 / whole))
    assert leaving.greatest(np.array([[0.06, -0.05]])) == pytest.approx(
        (0.06, 0.06 / whole) if 0.06 / whole > 0.11 / alone else (-0.11, 0.11 / alone)
    )
    assert leaving.greatest(np.array([[0.0, 0.1]])) == pytest.approx((0.1, 0.1 / alone))


def test_members_decided_by_contacts_have_no_half_cycles_of_the_mechanism() -> None:
    """Stop time and half cycles of the mechanism are left blank, the share of rotation is that of the contacts."""

    class Decided:
        def follow(self, ground, scale, end, threads):
            return Fate(2, 0.3, 0.8)

    rows = empty_rows(2) | {"half_cycles": np.array([7, 7]), "stop_time": np.array([4.0, 4.0])}
    Handed(Decided()).settle(rows, np.array([1]), np.array([0]), [pulses.sine_pulse(1.0, 0.2).ground], 1.0, 1)
    assert rows["half_cycles"].tolist() == [7, 0] and rows["stop_time"][0] == 4.0 and np.isnan(rows["stop_time"][1])
    assert rows["peak"][1] == 0.3 and rows["peak_ratio"][1] == 1.0 and rows["handed"].tolist() == [0, 1]


def test_contacts_follow_a_condition_that_fails_long_after_the_motion() -> None:
    """Left later than the end of the motion and the time to settle: contacts still follow the whole of that time."""
    building = building_of({"kind": "block", "width": 0.5, "height": 1.5})
    context = Context(make_deck({"structure": {"kind": "block", "width": 0.5, "height": 1.5}, "analysis": {"kind": "failure-domain"}}))
    fates = Fates.of(context, contacts_of(building.rocker(), building))
    motion = pulses.sine_pulse(0.1 * GRAVITY, 0.2).ground
    late = motion.end + 2.0 * fates.options.end_time

    class Late(Leaving):
        def leave(self, ground, end_time, scale):
            return Left(late, False, 0, 0.0, 0.0)

    leaving = Late(**{f.name: getattr(fates.contacts.leaving, f.name) for f in fields(Leaving)})
    fate = replace(fates, contacts=replace(fates.contacts, leaving=leaving)).follow(motion, 1.0, late + 1.0)
    assert fate.outcome == 0 and fate.ratio < 1e-3


def test_the_answer_states_one_limit_of_friction() -> None:
    """Rocking requires .53 up to its end, and .50 until contacts go on: the answer states the first alone."""
    found, _ = both({"kind": "block", "width": 0.45, "height": 1.0}, 0.5, sine(0.8, 0.6), 0.0)
    assert found.results.hand_over is not None
    assert found.results.required_friction != pytest.approx(found.results.conditions.required_friction, abs=0.01)
    assert set(re.findall(r"below (?:the )?([0-9.]+[0-9])", found.answer)) == {f"{found.results.conditions.required_friction:.2f}"}


def test_cells_of_several_cycles_that_coarse_steps_bring_down() -> None:
    """Step 1/25 of the time unit alone gives a collapse at 0.7 g and 1.6 Hz; maps give the recovery of single runs, as its next step does."""
    block = {"kind": "block", "width": 0.5, "height": 2.0}
    harmonic = {"kind": "harmonic-map", "cycles": 8, "frequencies": [1.6], "amplitudes": 2, "max_amplitude": "0.7 g"}
    deck = make_deck({"structure": block, "joints": {"friction": 0.3}, "analysis": harmonic})
    contacts = contacts_of(deck.buildings[0].rocker(), deck.buildings[0])
    assert contacts is not None
    ground = pulses.harmonic(1.0, 1.6, 5.0).ground
    single = Fates.of(Context(deck), contacts)
    ends = [
        replace(single, steps=steps).follow(ground, 0.7 * GRAVITY, ground.end) for steps in (STEPS[-1:], STEPS, ((STEPS[0][0], np.inf),))
    ]
    assert [WORDS_OF_MAP[one.outcome] for one in ends] == ["recovery", "recovery", "collapse"]
    found = extrados.run({"structure": block, "joints": {"friction": 0.3}, "analysis": harmonic}).results[0]
    assert found.results.handed_over and WORDS_OF_MAP[int(found.arrays["outcome"].data[0, 1])] == "recovery"
    assert found.arrays["peak_ratio"].data[0, 1] == pytest.approx(ends[0].ratio, rel=1e-9)


@pytest.mark.verify
@pytest.mark.parametrize("structure", [ARCH, VAULT, STACK])
def test_coarse_steps_decide_cells_as_those_of_single_runs(structure: dict) -> None:
    """Of a map every cell whose mechanism a condition leaves."""
    deck = make_deck({"structure": structure, "joints": {"friction": 0.5}, "analysis": {"kind": "failure-domain"}})
    building = deck.buildings[0]
    rocker = building.rocker(soft_base=True)
    contacts = contacts_of(rocker, building)
    assert contacts is not None
    fine = Fates.of(Context(deck), contacts)
    spent = np.zeros(2)
    for period in (1.0, 2.0, 4.0):
        ground = unit_pulse("sine", period * rocker.time_unit).ground
        for ratio in (1.4, 2.1, 2.8, 3.5):
            scale, end = ratio * rocker.uplift * GRAVITY, ground.end + 12.0 * rocker.time_unit
            if contacts.leaving.leave(ground, end, scale).time is None:
                continue
            found = []
            for k, fates in enumerate((fine, replace(fine, steps=STEPS))):
                begin = time.process_time()
                found.append(fates.follow(ground, scale, end).outcome)
                spent[k] += time.process_time() - begin
            assert found[0] == found[1], (period, ratio)
    print(f"{structure['kind']}: {spent[0] / spent[1]:.1f} times faster")
