"""Conditions under which rocking by fixed hinges holds: no sliding, no hinge elsewhere, no chaos, no rule of impact that decides."""

import numpy as np
import pytest

import extrados
from extrados.analyses.chaos import CHAOTIC, NUDGES, growth, over_critical, perturbed, turning
from extrados.analyses.context import Context
from extrados.analyses.motion_source import source_of
from extrados.analyses.rocking.block import toe_forces
from extrados.core import arch as core_arch
from extrados.core.rocking import Ground, ensemble, history
from extrados.decks.reader import make_deck
from extrados.limit.errors import CannotStand
from extrados.model.structures.arch import make_arch
from extrados.model.structures.block import make_block
from extrados.model.structures.vault import VAULT_PRESETS, make_vault
from extrados.motions import pulses
from extrados.schema.constants import GRAVITY
from extrados.views.rockers.arch import ArchModel
from extrados.views.rockers.block import BlockModel
from extrados.views.rockers.joint_forces import JointForces
from extrados.views.rockers.mechanism import MechanismModel

OPPENHEIM = {"kind": "arch", "radius": 10.0, "thickness": 1.5, "embrace": 157.5, "voussoirs": 7}
BLOCK = {"kind": "block", "width": 1.0, "height": 2.0}
VAULT = {"kind": "vault", "preset": "dejong-a"}
GENERATED = {"kind": "generated", "mmi": 8, "duration": 8.0}
SINE = {"kind": "sine-pulse", "amplitude": "0.7 g", "period": 0.6}
#: All kinds that rock a building by one mechanism, with a motion where they need one
KINDS = {
    "rocking": SINE,
    "fragility": GENERATED,
    "failure-domain": None,
    "failure-curves": None,
    "rocking-spectrum": SINE,
    "harmonic-map": None,
    "resonance": None,
    "assessment": SINE,
}
#: Small, and without rigid contacts, which would decide where a condition fails (test_hand_over.py)
SMALL = {
    "rocking": {"hand_over": False},
    "fragility": {"count": 40, "seed": 1},
    "failure-domain": {"durations": [0.2, 0.6], "amplitudes": 8, "hand_over_cells": 0},
    "failure-curves": {"durations": [0.3, 0.6], "amplitudes": 8},
    "harmonic-map": {"frequencies": [1.0, 2.0], "amplitudes": 6, "hand_over_cells": 0},
    "rocking-spectrum": {"periods": [2.0, 4.0]},
}


def result_of(kind: str, structure: dict, friction: float | str, motion: dict | None = None, **keys):
    deck = {"structure": structure, "joints": {"friction": friction}, "analysis": {"kind": kind, **SMALL.get(kind, {}), **keys}}
    made = motion or KINDS[kind]
    return extrados.run(deck | ({"motion": made} if made else {})).results[0]


def conditions_of(result) -> list:
    r = result.results
    if result.kind == "failure-curves":
        return [curve.conditions for curve in r.curves]
    return r.conditions if isinstance(r.conditions, list) else [r.conditions]


def test_forces_across_joints_are_those_of_the_dynamic_thrust_line() -> None:
    """Of every joint of an arch, in states on both sides, against the core's thrust line, which sums from one springing."""
    arch = make_arch(10.0, 1.5, 157.5, 20)
    model, whole = ArchModel(arch), MechanismModel(arch)
    q = np.linspace(0.0, 0.99 * model.limits.critical, 7)
    rate, across, up = 0.05, 2.0, -1.5
    for side, one in zip((1, -1), whole.linkages, strict=True):
        forces = JointForces(arch, one)
        assert sorted(forces.joints.tolist()) == list(range(21))
        found = np.einsum("i,njik->njk", [1.0 + up / GRAVITY, side * across, rate**2], forces.table(q))
        c = whole.coefficients(side, q)
        acceleration = -(c.half_mass_slope * rate**2 + c.gravity_moment * (1.0 + up / GRAVITY) + side * across * c.drive) / c.mass
        every = np.ones_like(q)
        line = core_arch.thrust_line(model.four_hinge, arch, q, rate * every, acceleration, side * across * every, up * every)
        order = forces.joints if side > 0 else 20 - forces.joints
        weight = arch.mass.sum() * GRAVITY
        assert found[..., 0] == pytest.approx(line.normal[:, order], abs=1e-9 * weight)
        assert np.abs(found[..., 1]) == pytest.approx(np.abs(line.shear[:, order]), abs=1e-9 * weight)
        assert found[..., 2] / found[..., 0] == pytest.approx(line.position[:, order], abs=1e-9)


def test_the_core_sees_what_the_history_shows() -> None:
    """Friction needed and excursion of the thrust line, by the tables of the core and from the history, on a block and an arch."""
    for structure, motion in ((BLOCK, pulses.sine_pulse(0.9 * GRAVITY, 0.5)), (OPPENHEIM, pulses.step_pulse(-GRAVITY, 0.2))):
        rocker = make_deck({"structure": structure, "analysis": {"kind": "failure-domain"}}).buildings[0].rocker()
        r = history(rocker.body, motion.ground, motion.end + 4.0, 0.0005)
        if isinstance(rocker.model, BlockModel):
            tangential, normal = toe_forces(rocker.model, r)
            seen = np.abs(tangential / normal)[r.rotation != 0.0].max()
        else:
            side = np.sign(r.rotation)
            side, left = side[side != 0.0], side[side != 0.0] < 0.0
            states = [x[r.rotation != 0.0] for x in (r.rotation, r.rate, r.acceleration, r.ground, r.vertical)]
            line = core_arch.thrust_line(
                rocker.model.four_hinge, rocker.model.arch, np.abs(states[0]), *(side * x for x in states[1:4]), states[4]
            )
            seen = line.friction.max()
            out = np.maximum(-line.position, line.position - 1.0)
            assert r.joints.outside == pytest.approx(out.max(), rel=0.01) and left.any()
            first = r.time[r.rotation != 0.0][(out > 0.01).any(axis=1).argmax()]
            assert r.joints.leaves_at == pytest.approx(first, abs=0.002)
        assert r.joints.friction == pytest.approx(seen, rel=0.005) and r.joints.friction >= seen * (1.0 - 1e-6)
        e = [ensemble([rocker.body], [motion.ground], [0, 0], [0, 0], 1.0, motion.end + 4.0, threads=k) for k in (1, 2)]
        assert np.array_equal(e[0].joints.friction, e[1].joints.friction)
        assert e[0].joints.friction[0] == pytest.approx(float(r.joints.friction), rel=0.02)


TIED = BLOCK | {"height": 4.0}
TIE = {"name": "rod", "start": [-0.5, 3.5], "start_stone": "block", "ground": [-4.0, 3.5], "stiffness": "2 MN/m", "yield_force": "20 kN"}
COLUMN = {"kind": "column", "width": 0.8, "height": 4.0, "drums": 4}
ARCH34 = {"kind": "arch", "radius": 1.0, "thickness": 0.144, "embrace": 170.0, "voussoirs": 34}


@pytest.mark.parametrize("friction", [0.35, 0.7])
@pytest.mark.parametrize(
    "tables",
    [{"structure": s} for s in (BLOCK, BLOCK | {"height": 5.0}, OPPENHEIM, ARCH34, VAULT, COLUMN)] + [{"structure": TIED, "ties": [TIE]}],
    ids=["block", "slender", "arch", "voussoirs", "vault", "column", "tied"],
)
def test_bounds_of_the_joints_change_no_number(tables: dict, friction: float) -> None:
    # an ensemble of many runs bounds what the joints demand before it looks at their forces; one run does not
    arch = tables["structure"]["kind"] in ("arch", "vault")
    tables = tables | {"joints": {"restitution": "energy-safe" if arch else 0.9, "friction": friction}, "motion": SINE}
    try:
        rocker = make_deck(tables | {"analysis": {"kind": "rocking"}}).buildings[0].rocker()
    except CannotStand:
        assert friction < 0.5
        return
    rng = np.random.default_rng(35)
    grounds = []
    for k in range(18):
        samples = rng.normal(size=(1 + k % 2, 200))
        samples = np.apply_along_axis(np.convolve, 1, samples, np.hanning(9), "same") * rocker.uplift * GRAVITY * (0.4 + 0.1 * k)
        samples[1:] *= 0.4
        grounds.append(Ground(samples=samples, step=(0.005, 0.01, 0.02)[k % 3]))
    for tolerance in (1e-3, 1e-8):
        one = [ensemble([rocker.body], [g], [0], [0], 1.0, 10.0, tolerance=tolerance) for g in grounds]
        many = ensemble([rocker.body], grounds, [0] * len(grounds), range(len(grounds)), 1.0, 10.0, tolerance=tolerance)
        assert (many.half_cycles > 1).sum() > 5
        for name in ("outcome", "half_cycles", "impacts", "peak", "stop_time", "steps"):
            assert np.array_equal(getattr(many, name), [getattr(r, name)[0] for r in one]), name
        for name in ("friction", "outside", "slips_at", "leaves_at", "slips", "leaves"):
            assert np.array_equal(getattr(many.joints, name), [getattr(r.joints, name)[0] for r in one]), name


def test_a_block_on_little_friction_slides_at_rest() -> None:
    """1 x 2 m at friction .3 needs .5 to rock: it slides where the ground reaches .3 g, whatever moves it, in all that rock."""
    for kind in KINDS:
        result = result_of(kind, BLOCK, 0.3)
        found = conditions_of(result)
        assert all(c.violated and "lide" in c.violated[0] and c.friction == 0.3 for c in found[1:] or found)
        assert result.verdict.outcome in ("open", "not-applicable") and result.verdict.violated
        assert result.assumptions["joints.friction"].value == 0.3
    one = result_of("rocking", BLOCK, 0.3, {"kind": "sine-pulse", "amplitude": "0.8 g", "period": 0.5}).results
    assert one.conditions.slides_first.time_s == pytest.approx(0.5 / (2.0 * np.pi) * np.arcsin(0.3 / 0.8), abs=1e-9)
    still = result_of("rocking", BLOCK, 0.3, {"kind": "sine-pulse", "amplitude": "0.4 g", "period": 0.5})
    assert still.results.outcome == "no-hinging" and still.verdict.outcome == "open"
    calm = result_of("rocking", BLOCK, 0.3, {"kind": "sine-pulse", "amplitude": "0.29 g", "period": 0.5})
    assert calm.verdict.outcome == "stands" and not calm.verdict.violated
    assert result_of("rocking", BLOCK, "no-sliding").results.conditions.violated == []


def test_the_share_of_motions_that_slide_is_that_of_their_histories() -> None:
    """Friction .22, above the .2 of uplift: a motion counts where a toe of its own history needs more."""
    slender = {"kind": "block", "width": 1.0, "height": 5.0}
    deck = make_deck(
        {"structure": slender, "joints": {"friction": 0.22}, "motion": GENERATED, "analysis": {"kind": "fragility", "count": 40, "seed": 1}}
    )
    found = result_of("fragility", slender, 0.22).results
    source, _ = source_of(Context(deck), 1)
    model = deck.buildings[0].rocker().model
    slides = 0
    for ground in source.grounds(0, 40, 1):
        r = history(model.body, ground, ground.end + 20.0, 0.001)
        tangential, normal = toe_forces(model, r)
        below = (r.rotation != 0.0) & (np.abs(r.rotation) <= model.alpha[0])
        slides += bool((np.abs(tangential) > 0.22 * normal)[below].any())
    assert 0 < slides < 40 and abs(found.conditions.sliding - slides) <= 1
    assert found.conditions.sliding_share == found.conditions.sliding / 40
    assert found.conditions.violated[0].startswith("Friction 0.22 is too low in")


@pytest.mark.parametrize("kind", KINDS)
def test_what_friction_does_not_carry_cannot_stand(kind: str) -> None:
    """Oppenheim's arch at friction .2: least .2057 by the bisection of limit analysis."""
    result = result_of(kind, OPPENHEIM, 0.2)
    assert result.verdict.outcome == "cannot-stand" and "must be at least 0.206" in result.verdict.statement


def test_an_arch_slides_where_limit_analysis_with_friction_says_so() -> None:
    """Friction .3: capacity of `tilt` without and with sliding against the watch of the rocker."""
    deck = {"structure": OPPENHEIM, "joints": {"friction": 0.3}, "analysis": [{"kind": "tilt", "friction_rule": "associated"}]}
    tilt = extrados.run(deck)["tilt"]
    rocker = make_deck(deck).buildings[0].rocker()
    assert rocker.uplift == pytest.approx(0.37, abs=0.001)
    assert rocker.watch.capacity[0] == pytest.approx(tilt.collapse_acceleration_g, rel=1e-6) and rocker.watch.capacity[0] < 0.2


#: Single sines on preset dejong-a: period [s] and amplitude over .134 g by which discrete elements (`dem`, nonsmooth) end otherwise
#: than fixed hinges, 8 of them in collapse
WRONG = [(0.7, 4.0), (0.9, 3.0), (0.9, 3.5), (0.9, 4.0), (1.1, 3.0), (1.1, 3.5), (1.1, 4.0), (1.3, 2.5), (1.5, 2.0)]


def test_a_vault_on_buttresses_says_that_hinges_form_elsewhere() -> None:
    """None of the nine sines whose outcome is wrong is decided; an impact leaves 98 % of its energy outside the mechanism."""
    for period, factor in WRONG:
        motion = {"kind": "sine-pulse", "amplitude": f"{0.134 * factor} g", "period": period}
        run = result_of("rocking", VAULT, 0.7, motion)
        assert run.verdict.outcome == "open" and any("thrust line passes outside" in text for text in run.verdict.violated)
        assert run.results.conditions.energy_astray == pytest.approx(0.975, abs=0.002)
    calm = {"kind": "sine-pulse", "amplitude": "0.13 g", "period": 1.0}
    assert extrados.run({"structure": VAULT, "motion": calm, "analysis": {"kind": "rocking"}}).results[0].verdict.outcome == "stands"


def test_a_wrong_outcome_of_the_vault_is_that_of_elements() -> None:
    """One of the nine, beside rigid contacts: they come down."""
    motion = {"kind": "sine-pulse", "amplitude": f"{0.134 * 3.0} g", "period": 0.9}
    run = extrados.run(
        {
            "structure": VAULT,
            "motion": motion,
            "analysis": [{"kind": "rocking", "hand_over": False}, {"kind": "dem", "solver": "nonsmooth"}],
        }
    )
    assert run["rocking"].outcome == "recovery" and run["dem"].outcome == "collapse"


def test_every_mechanism_of_the_vault_is_watched_at_all_joints() -> None:
    """Force and moment of every block balance: what its joints give is what its motion needs (Newton and Euler)."""
    vault = make_vault(**VAULT_PRESETS["dejong-a"])
    for one in MechanismModel(vault).linkages:
        forces = JointForces(vault, one)
        assert sorted(forces.joints.tolist()) == list(range(len(vault.a)))
        at_rest = np.einsum("i,jik->jk", [1.0, 0.0, 0.0], forces.table(np.zeros(1))[0])
        # pushed at its capacity the mechanism just does not move: the thrust line of limit analysis, inside all joints
        gamma = abs(MechanismModel(vault).collapse[0][0].gamma)
        pushed = np.einsum("i,jik->jk", [1.0, -gamma * GRAVITY, 0.0], forces.table(np.zeros(1))[0])
        share = pushed[:, 2] / pushed[:, 0]
        assert share.min() > -1e-6 and share.max() < 1.0 + 1e-6 and (at_rest[:, 0] > 0.0).any()
        ground = [k for k, j in enumerate(forces.joints) if -1 in (vault.a[j], vault.b[j])]
        base = sum(pushed[k, 0] * vault.normal[forces.joints[k]] + pushed[k, 1] * vault.tangent[forces.joints[k]] for k in ground)
        weight = vault.mass.sum() * GRAVITY
        assert base == pytest.approx([-one.side * gamma * weight, weight], rel=1e-6)


def grown(model: BlockModel, motion, scale: float, end: float) -> tuple[float, float]:
    """Growth of a perturbation of 1e-6, and the least perturbation that turns the outcome."""
    run, *others = (history(model.body, motion.ground, end, 0.01, scale=scale * k) for k in (1.0, *perturbed()))
    found = growth([over_critical(one.rotation, tuple(model.alpha)) for one in (run, *others[:2])])
    return found, turning(run.outcome, [one.outcome for one in others])


def test_chaos_is_reported_by_growth() -> None:
    """1 x 5 m, 2 Hz, 1 g + k 1e-5 g: outcomes are scattered, and 39 of 40 runs say so by growth, many that two nudges leave as they are."""
    model, motion = BlockModel(make_block(1.0, 5.0)), pulses.harmonic(1.0, 2.0, 20.0)
    scales = [(1.0 + k * 1e-5) * GRAVITY for k in range(40)]
    outcomes = [history(model.body, motion.ground, 60.0, 0.01, scale=scale).outcome for scale in scales]
    assert 5 < outcomes.count("collapse") < 35
    found = [grown(model, motion, scale, 60.0) for scale in scales]
    assert sum(value > CHAOTIC for value, _ in found) >= 39
    assert all(value > CHAOTIC or turns > 0.0 for value, turns in found)
    shake = {"kind": "harmonic", "amplitude": "1.00003 g", "frequency": 2.0, "duration": 20.0}
    run = extrados.run(
        {"structure": {"kind": "block", "width": 1.0, "height": 5.0}, "motion": shake, "analysis": {"kind": "rocking", "output_step": 0.02}}
    ).results[0]
    assert run.results.decided_by_last_digits and run.verdict.outcome == "open" and run.results.perturbation_growth > CHAOTIC


def test_ordinary_runs_are_not_chaotic() -> None:
    """100 runs: no single sine grows; of those under a record few, and each of them parts histories by more than a hundredth."""
    file = {"kind": "record", "file": "extrados:el-centro-1940"}
    record = Context(make_deck({"structure": BLOCK, "motion": file, "analysis": {"kind": "rocking"}})).motion
    sines = [pulses.sine_pulse(-1.0, period) for period in (0.4, 0.6, 0.8, 1.0, 1.2)]
    flagged = {"sine": 0, "record": 0}
    for width, height in ((1.0, 2.5), (1.0, 4.0), (0.5, 2.0), (2.0, 10.0)):
        model = BlockModel(make_block(width, height))
        uplift = float(model.uplift[0]) * GRAVITY
        for motion in sines:
            for factor in (1.3, 2.0, 3.0, 4.5):
                value, turns = grown(model, motion, factor * uplift, motion.end + 10.0)
                flagged["sine"] += value > CHAOTIC or turns > 0.0
        for factor in (1.3, 1.6, 2.0, 3.0, 4.5):
            value, turns = grown(model, record, factor * uplift / record.peak, record.end + 10.0)
            flagged["record"] += value > CHAOTIC or turns > 0.0
    assert flagged["sine"] == 0 and flagged["record"] <= 4


def test_a_window_of_collapse_among_recoveries_is_reported() -> None:
    """1.0525 g + k 1e-5 g: k = 2, 3, 4 collapse, k = 0, 1, 5, 6, 7 recover. A perturbation of 1e-6 leaves the three where they are."""
    model, motion = BlockModel(make_block(1.005, 1.005 * 5.01)), pulses.harmonic(1.0, 1.625, 10.0)
    ends = []
    for k in range(8):
        scale = (1.0525 + k * 1e-5) * GRAVITY
        value, turns = grown(model, motion, scale, 20.0)
        ends.append(history(model.body, motion.ground, 20.0, 0.01, scale=scale).outcome)
        assert value > CHAOTIC or turns > 0.0, f"k = {k}"
    assert [k for k, outcome in enumerate(ends) if outcome == "collapse"] == [2, 3, 4]


def test_the_least_perturbation_that_turns_an_outcome() -> None:
    others = ["recovery", "no-hinging", "recovery", "collapse"] + 6 * ["recovery"]
    assert turning("recovery", others) == turning("no-hinging", others) == NUDGES[1] and turning("collapse", others) == NUDGES[0]
    assert turning("collapse", 10 * ["collapse"]) == turning("recovery", 10 * ["no-hinging"]) == 0.0


def test_growth_counts_until_the_balance() -> None:
    """A perturbation of 1e-6 that parts two runs by a hundredth of the critical rotation has grown by 1e4; beyond it nothing counts."""
    one = np.array([0.0, 0.1, 0.5, 1.2, 5.0])
    other = np.array([0.0, 0.1, 0.51, 1.4, 9.0])
    assert growth([one, other]) == pytest.approx(1e4)
    uneven = [over_critical(-run, (1.0, 2.0)) for run in (one, other)]
    assert growth(uneven) == pytest.approx(1e5) and growth([one, one]) == 0.0
    far = [np.array([0.5, 2.0, 2.0]), np.array([0.5, 2.0, 2.1])]  # slid past the limit without collapse, by the measure of the outcome
    assert growth(far) == 0.0 and growth(far, 3) == pytest.approx(1e5)
    assert growth([np.stack([one, 0.0 * one], axis=1), np.stack([other, 0.0 * one], axis=1)]) == pytest.approx(1e4)


@pytest.mark.parametrize(("thickness", "embrace", "least"), [(1.2, 180.0, 1.5), (1.1, 175.0, 1.5)])
def test_curves_of_thin_arches_state_the_band_of_the_impact_rules(thickness: float, embrace: float, least: float) -> None:
    """t/R .11 and .12: amplitudes differ between rules; each is that of the rule alone."""
    structure = {"kind": "arch", "radius": 10.0, "thickness": thickness, "embrace": embrace, "voussoirs": 36}
    keys = {"durations": [1.2, 1.6, 2.0], "pulse": "sine", "max_amplitude": "1.0 g", "amplitudes": 40}
    found = result_of("failure-domain", structure, "no-sliding", **keys)
    r = found.results
    assert r.rule_ratio > least and any("impact rules differ" in text for text in found.warnings)
    curves = {one.rule: one.amplitudes_g for one in r.amplitudes_by_rule}
    assert curves["inelastic"] == pytest.approx(r.mode_I.amplitudes_g, abs=1e-4)
    deck = {"structure": structure, "joints": {"restitution": "energy-safe"}, "analysis": {"kind": "failure-domain", **keys}}
    assert extrados.run(deck)["failure-domain"].mode_I.amplitudes_g == pytest.approx(curves["energy-safe"], abs=1e-4)
    (curve,) = result_of("failure-curves", structure, "no-sliding", **keys).results.curves
    assert curve.rule_ratio == pytest.approx(r.rule_ratio, rel=0.01)
    record = {"kind": "record", "file": "extrados:el-centro-1940"}
    fragile = result_of("fragility", structure, "no-sliding").results
    assert set(fragile.collapse_probability_by_rule) == set(curves)
    assessed = result_of("assessment", structure, "no-sliding", record).results
    assert set(assessed.margins_by_rule) <= set(curves) and len(assessed.margins_by_rule) > 1


def test_no_friction_is_too_low_where_a_joint_comes_under_tension() -> None:
    """Where no finite friction is enough the sentence does not advise to check the friction."""
    arch = {"kind": "arch", "radius": 5.0, "thickness": 0.6, "embrace": 170.0, "voussoirs": 20}
    keys = {"durations": [0.2, 0.5], "pulse": "step", "max_amplitude": "1.5 g", "amplitudes": 10}
    conditions = result_of("failure-domain", arch, 0.7, **keys).results.conditions
    assert conditions.sliding and not np.isfinite(conditions.required_friction or np.inf)
    assert conditions.violated[0].startswith("A joint is in tension or slides in ")


def test_sampled_arches_that_slide_at_rest_are_no_safe_ones() -> None:
    """The joints of sampled arches are not watched; that the nominal one slides before it rocks leaves the share of collapses open."""
    arch = {"kind": "arch", "radius": 6.0, "thickness": 1.0, "embrace": 150.0, "voussoirs": 17}
    fragile = {"kind": "fragility", "count": 12, "uncertain": {"thickness": 0.05}, "seed": 1}
    for friction, peak, open_ in ((0.2, 0.2, True), (0.2, 0.03, False), (0.7, 0.2, False)):
        motion = {"kind": "sine-pulse", "amplitude": f"{peak} g", "period": 0.5}
        deck = {"structure": arch, "joints": {"friction": friction}, "motion": motion, "analysis": fragile}
        found = extrados.run(deck).results[0]
        assert bool(found.results.conditions.violated) == open_
        assert found.verdict.outcome == ("open" if open_ else "stands")
        assert any("slides from 0.045" in text for text in found.warnings) == open_


def test_where_joints_are_not_watched_the_answer_says_so() -> None:
    """Three columns share their forces; a wall and a compliant base do not hide those of one block."""
    frame = {"kind": "frame", "columns": 3, "width": 0.5, "height": 2.5, "spacing": 2.0, "lintel_height": 0.4}
    ensemble = {"motion": GENERATED, "analysis": {"kind": "fragility", "count": 10, "seed": 1}}
    run = extrados.run({"structure": frame, **ensemble})
    assert "not checked" in run["fragility"].conditions.not_checked
    assert any("not checked" in text for text in run.results[0].warnings)
    for supports in ({"abutting_wall": "left"}, {"stiffness": 1e8}):
        conditions = extrados.run({"structure": BLOCK, "supports": supports, **ensemble})["fragility"].conditions
        assert not conditions.not_checked and conditions.sliding is not None


def test_a_column_taken_as_one_body_says_where_its_drums_part() -> None:
    """Six drums under a slow pulse: the resultant at the joint above the foot, from the history by hand, leaves it where told."""
    column = {"kind": "column", "width": 1.2, "top_width": 1.0, "height": 7.2, "drums": 6}
    motion = {"kind": "sine-pulse", "amplitude": "0.3 g", "period": 1.8}
    deck = {"structure": column, "motion": motion, "analysis": {"kind": "rocking", "output_step": 0.001, "hand_over": False}}
    result = extrados.run(deck).results[0]
    first = result.results.conditions.leaves_first
    stones = make_deck(deck).buildings[0].blocks()
    j = stones.joint_names.index(first.joint)
    # the drums above the joint: their weight and inertia about its ends, turned with the column about its toe
    a = {name: result.arrays[name].data for name in ("time", "rotation", "rate", "acceleration", "ground")}
    above = stones.centroid[:, 1] > stones.middle[j, 1]
    side = np.where(a["rotation"] < 0.0, -1.0, 1.0)
    toe = np.where(side > 0.0, *(np.max(stones.p[stones.a < 0, 0].tolist() + stones.q[stones.b < 0, 0].tolist()) * k for k in (1, -1)))
    outside = np.full(len(side), -1.0)
    for i in np.flatnonzero(a["rotation"] != 0.0):
        turn, spin, change = -a["rotation"][i], -a["rate"][i], -a["acceleration"][i]
        rotate = np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
        arm = (stones.centroid[above] - [toe[i], 0.0]) @ rotate.T
        acceleration = change * np.column_stack([-arm[:, 1], arm[:, 0]]) - spin**2 * arm + [a["ground"][i], GRAVITY]
        force = stones.mass[above] @ acceleration
        ends = [(end - [toe[i], 0.0]) @ rotate.T for end in (stones.p[j], stones.q[j])]
        pull = stones.mass[above, None] * acceleration
        moments = [
            ((arm - end)[:, 0] * pull[:, 1] - (arm - end)[:, 1] * pull[:, 0]).sum() + stones.inertia[above].sum() * change for end in ends
        ]
        share = moments[0] / (moments[0] - moments[1])
        outside[i] = max(-share, share - 1.0) if force @ rotate @ [0.0, 1.0] > 0.0 else np.inf
    below = np.abs(a["rotation"]) < result.results.critical_rotation_rad
    assert a["time"][((outside > 0.01) & below).argmax()] == pytest.approx(first.time_s, abs=0.015)


def test_a_block_at_rest_needs_the_friction_of_its_motion() -> None:
    """A squat block that does not rock is pushed along by the whole peak: 0.4 g needs a friction of 0.4."""
    deck = {
        "structure": {"kind": "block", "width": 2.0, "height": 1.2},
        "joints": {"friction": 0.9},
        "motion": {"kind": "sine-pulse", "amplitude": "0.4 g", "period": 0.8},
        "analysis": {"kind": "rocking"},
    }
    found = extrados.run(deck).results[0]
    assert found.results.required_friction == pytest.approx(0.4, abs=1e-3)
    assert "If friction is below 0.40, the block slides instead." in found.answer


def test_rules_of_one_body_are_open_where_its_drums_part() -> None:
    """A slender column of twelve drums under a record: the velocity holds, but the drums part, which the rules do not consider."""
    column = {"kind": "column", "width": 1.6, "top_width": 1.1, "height": 18.0, "drums": 12}
    motion = {"kind": "record", "file": "extrados:el-centro-1940", "scale": 0.6}
    rules = {"kind": "code-checks", "motion_spectrum": True}
    for drums, outcome in ((12, "open"), (1, "stands")):
        deck = {"structure": {**column, "drums": drums}, "motion": motion, "analysis": [rules]}
        found = extrados.run(deck).results[0]
        assert found.verdict.outcome == outcome
        assert any("Hinges form at other joints" in text for text in found.verdict.violated) == (drums == 12)


def test_a_margin_holds_as_far_as_friction_suffices() -> None:
    """Friction .32 suffices for the motion, not for 1.28 times it: rocking then needs .33, and the margin is a lower bound."""
    deck = {
        "structure": {"kind": "block", "width": 0.6, "height": 2.0},
        "joints": {"friction": 0.32},
        "motion": {"kind": "sine-pulse", "amplitude": "0.33 g", "period": 0.8},
    }
    (alone,) = extrados.run(deck | {"analysis": [{"kind": "assessment"}]}).results
    r = alone.results
    assert r.margin == pytest.approx(1.28, abs=0.01) and not r.conditions.violated
    (told,) = r.margin_conditions
    assert "1.28 times the motion" in told and "requires up to 0.33" in told
    assert told in alone.verdict.statement and told in alone.warnings
    scaled = deck | {"motion": {**deck["motion"], "amplitude": f"{0.33 * r.margin} g"}, "analysis": [{"kind": "rocking"}]}
    assert extrados.run(scaled)["rocking"].conditions.violated  # by the run itself
    whole = extrados.run(deck | {"analysis": [{"kind": "assess", "strategies": ["rocking", "assessment"]}]})["assess"]
    rocking = next(v for v in whole.verdicts if v.strategy == "rocking")
    assert 1.0 < rocking.margin_at_least < r.margin and rocking.margin_below is None
    assert "slide" in rocking.parameters
    free = deck | {"joints": {"friction": 0.7}, "analysis": [{"kind": "assessment"}]}
    assert extrados.run(free)["assessment"].margin_conditions == []
