"""Rocking of any mechanism: the arch and the block through the general path, energy, impact, forces, refusals."""

from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from extrados.core import arch as core_arch
from extrados.core import mechanism as core_mechanism
from extrados.core import rocking
from extrados.core.errors import CoreError
from extrados.decks.reader import make_deck, read_deck
from extrados.limit.errors import CannotStand
from extrados.limit.linkage import CannotRock, linkage
from extrados.limit.programme import LimitAnalysis
from extrados.model.errors import NoView
from extrados.model.geometry.assembly import GROUND, Assembly
from extrados.model.structures.arch import make_arch
from extrados.model.structures.block import make_block
from extrados.motions import pulses
from extrados.motions.records import locate, read_record, record_motion
from extrados.schema.constants import GRAVITY
from extrados.views.rockers.arch import ArchModel
from extrados.views.rockers.block import BlockModel
from extrados.views.rockers.impact import energy_kept
from extrados.views.rockers.mechanism import MechanismModel

CASES = Path(__file__).resolve().parents[2] / "cases"
ARCHES = [(10.0, 1.5, 157.5, 7), (10.0, 2.0, 180.0, 15), (10.0, 1.2, 170.0, 31)]


def of_case(name: str, **change) -> Assembly:
    """The structure of a case, keys replaced."""
    deck = read_deck(CASES / name)
    data = {**deck.structure.model_dump(exclude_unset=True), **change}
    structure = type(deck.structure).model_validate(data)
    return deck.building.having(structure=structure).blocks()


@cache
def model(name: str) -> MechanismModel:
    return MechanismModel(of_case(name))


def lopsided() -> Assembly:
    """An arch whose voussoirs weigh differently: its two mechanisms are no mirror images."""
    arch = make_arch(10.0, 1.8, 150.0, 11)
    weight = np.linspace(0.95, 1.05, 11)
    return replace(arch, mass=arch.mass * weight, inertia=arch.inertia * weight)


def stones(*shapes: tuple[str, list, list]) -> Assembly:
    """Free blocks of a deck without file."""
    deck = make_deck(
        {"structure": {"kind": "blocks", "block": [{"name": n, "points": p} for n, p, _ in shapes]}, "analysis": [{"kind": "tilt"}]}
    )
    return deck.building.blocks()


@pytest.mark.parametrize("sizes", ARCHES)
def test_the_arch_is_the_four_hinge_arch(sizes) -> None:
    """Tables, limits, impact and whole responses under a step pulse, to rounding."""
    arch = make_arch(*sizes)
    ours, theirs = MechanismModel(arch, "energy-safe"), ArchModel(arch, "energy-safe")
    limits = theirs.limits
    for table in ours.tables:
        assert table.critical == pytest.approx(limits.critical, rel=1e-12)
        assert (table.mass, table.gravity_moment, table.drive) == pytest.approx(
            (limits.mass, limits.gravity_moment, limits.drive), rel=1e-12
        )
    assert ours.projections == pytest.approx([theirs.impacts.energy_safe] * 2, abs=1e-12)
    gamma = theirs.collapse[0].gamma
    for amplitude, duration in ((1.4 * gamma, 0.3), (-2.5 * gamma, 0.2)):
        ground = pulses.step_pulse(amplitude * GRAVITY, duration).ground
        one, two = (rocking.history(body, ground, 5.0, 0.01) for body in (ours.body, theirs.body))
        assert (one.outcome, one.impacts) == (two.outcome, two.impacts) and one.half_cycles > 0
        assert np.abs(one.rotation - two.rotation).max() < 1e-10 * limits.critical
        assert one.peak_ratio == pytest.approx(two.peak_ratio, rel=1e-10)


def test_the_arch_under_a_record() -> None:
    """El Centro, through tens of impacts."""
    arch = make_arch(1.0, 0.144, 170.0, 34)
    ours, theirs = MechanismModel(arch, "energy-safe"), ArchModel(arch, "energy-safe")
    ground = record_motion(read_record(locate("extrados:el-centro-1940", None))).ground
    one, two = (rocking.history(body, ground, 30.0, 0.01) for body in (ours.body, theirs.body))
    assert one.impacts == two.impacts > 20
    assert np.abs(one.rotation - two.rotation).max() < 1e-6 * theirs.limits.critical


def test_poses_are_those_of_the_arch() -> None:
    arch = make_arch(*ARCHES[0])
    ours, theirs = MechanismModel(arch), ArchModel(arch)
    q = np.array([0.0, 0.3, 0.9, 0.05]) * theirs.limits.critical
    placed = core_arch.pose(theirs.four_hinge, arch.centroid, q)
    assert np.abs(ours.pose(q) - placed).max() < 1e-12
    mirrored = placed[:, ::-1] * np.array([-1.0, 1.0, -1.0])
    assert np.abs(ours.pose(-q) - mirrored).max() < 1e-12


def test_hinge_forces_are_those_of_the_dynamic_thrust_line() -> None:
    arch = make_arch(*ARCHES[0])
    ours, theirs = MechanismModel(arch, "energy-safe"), ArchModel(arch, "energy-safe")
    response = rocking.history(ours.body, pulses.step_pulse(-6.0, 0.25).ground, 3.0, 0.01)
    forward = response.rotation > 1e-4
    state = [getattr(response, k)[forward] for k in ("rotation", "rate", "acceleration", "ground", "vertical")]
    forces = ours.hinge_forces(*state)
    line = core_arch.thrust_line(theirs.four_hinge, arch, *state)
    joint = theirs.four_hinge.joint
    assert forward.sum() > 20 and forces.miss.max() < 1e-12
    weight = arch.mass.sum() * GRAVITY
    assert np.abs(forces.normal[:, joint] - line.normal[:, joint]).max() < 1e-9 * weight
    assert np.abs(forces.shear[:, joint] - line.shear[:, joint]).max() < 1e-9 * weight
    assert np.isnan(np.delete(forces.normal, joint, axis=1)).all()


@pytest.mark.parametrize("toes", [(0.5, 0.5), (0.3, 0.7)])
def test_a_block_is_the_block(toes) -> None:
    """Also with unequal toes: coefficients, Housner's impact of both sides, and a response."""
    block = make_block(depth=1.0, mass=2000.0, inertia=2800.0, centre_height=2.0, toe_right=toes[0], toe_left=toes[1])
    ours, theirs = MechanismModel(block), BlockModel(block)
    assert ours.critical == pytest.approx(theirs.alpha, rel=1e-12)
    assert ours.uplift == pytest.approx(theirs.uplift, rel=1e-12)
    assert ours.restitution == pytest.approx(theirs.restitution, rel=1e-12)
    for side, alpha, radius, inertia in zip((1, -1), block.alpha, block.radius, block.toe_inertia, strict=True):
        q = np.linspace(0.0, 2.0 * alpha, 50)
        c = ours.coefficients(side, q)
        assert c.mass == pytest.approx(inertia, rel=1e-12)
        assert c.gravity_moment == pytest.approx(2000.0 * GRAVITY * radius * np.sin(alpha - q), abs=1e-8)
        assert c.drive == pytest.approx(2000.0 * radius * np.cos(alpha - q), rel=1e-12)
    ground = record_motion(read_record(locate("extrados:el-centro-1940", None))).ground
    one, two = (rocking.history(b, ground, 20.0, 0.01, scale=1.2) for b in (ours.body, theirs.body))
    assert (one.outcome, one.impacts) == (two.outcome, two.impacts) and one.impacts > 5
    assert np.abs(one.rotation - two.rotation).max() < 1e-6 * theirs.alpha.min()


SECTIONS = [
    "vault/dejong-a.toml",
    "vault/vezelay-like.toml",
    "vault/flyers.toml",
    "limit/trapezoids.toml",
    "limit/lintel.toml",
    "dem/column.toml",
    "dem/wall.toml",
]


@pytest.mark.parametrize("name", SECTIONS)
def test_sections_rock(name: str) -> None:
    """Vaults, aisles, flyers, free blocks, a column and a wall: energy, capacity, and forces that fit the motion."""
    m = model(name)
    for side, table, (state, _) in zip((1, -1), m.tables, m.collapse, strict=True):
        assert side * table.gravity_moment / table.drive == pytest.approx(state.gamma * GRAVITY, rel=1e-9)
        assert table.misfit < 1e-9 and table.energy < 1e-9
        assert 0.0 < table.critical < table.lock
    ground = pulses.step_pulse(1.5 * min(m.uplift) * GRAVITY, 0.3 * m.time_unit).ground
    r = rocking.history(m.body, ground, 8.0, 0.01)
    assert r.outcome == "recovery" and r.peak_ratio > 0.005
    assert np.abs(r.kinetic + r.potential - r.ledger).max() < 1e-6 * r.potential.max()
    forces = m.hinge_forces(r.rotation, r.rate, r.acceleration, r.ground, r.vertical)
    assert forces.miss.max() < 1e-10
    assert m.length == pytest.approx(0.75 * GRAVITY * m.time_unit**2)


@pytest.mark.parametrize("voussoirs", [9, 10, 13])
def test_stout_ellipses_rock(voussoirs: int) -> None:
    """Their inner parts turn four times as fast as the first at rest and soon less: tables of 32 panels lost energy at 3e-8."""
    structure = {"kind": "elliptical-arch", "span": 5.3, "rise": 1.9, "thickness": 0.9, "voussoirs": voussoirs}
    model = MechanismModel(make_deck({"structure": structure, "analysis": {"kind": "tilt"}}).building.blocks())
    for one, table in zip(model.linkages, model.tables, strict=True):
        q = np.linspace(0.0, table.critical, 300)
        found = core_mechanism.coefficients(table, q)
        slope = np.gradient(found.mass, q, edge_order=2)
        assert found.half_mass_slope[3:-3] == pytest.approx(0.5 * slope[3:-3], rel=0.02)
        place, first, _ = core_mechanism.follow(one, q)
        weight = np.stack([one.mass, one.mass, one.inertia], axis=1)
        assert found.mass == pytest.approx((weight * first**2).sum(axis=(1, 2)), rel=1e-9)
        assert found.potential == pytest.approx(GRAVITY * ((place - place[0])[:, :, 1] @ one.mass), rel=1e-8, abs=1e-6)


def test_derivatives_of_the_parts() -> None:
    """First and second derivatives of the places of the parts against differences of the places."""
    m = model("vault/vezelay-like.toml")
    one, h = m.linkages[0], 1e-4
    q = 0.4 * m.critical[0] + h * np.arange(-2, 3)
    place, first, second = core_mechanism.follow(one, q)
    weights = np.array([1.0, -8.0, 0.0, 8.0, -1.0]) / (12.0 * h)
    assert first[2] == pytest.approx(np.tensordot(weights, place, 1), rel=1e-7, abs=1e-8)
    assert second[2] == pytest.approx(np.tensordot(weights, first, 1), rel=1e-7, abs=1e-7)


def test_hinges_stay_closed() -> None:
    """The two faces of every hinge meet at the hinge, up to the collapse."""
    m = model("vault/flyers.toml")
    for side, one, table in zip((1.0, -1.0), m.linkages, m.tables, strict=True):
        pose = m.pose(side * np.linspace(0.0, table.limit, 9))
        a = m.assembly
        for joint, point in zip(one.joint, one.point, strict=True):
            ends = []
            for block in (a.a[joint], a.b[joint]):
                if block == GROUND:
                    ends.append(np.broadcast_to(point, (9, 2)))
                    continue
                arm, (x, y, turn) = point - a.centroid[block], pose[:, block].T
                c, s = np.cos(turn), np.sin(turn)
                ends.append(np.column_stack([x + c * arm[0] - s * arm[1], y + s * arm[0] + c * arm[1]]))
            assert np.abs(ends[0] - ends[1]).max() < 1e-11 * a.size


def test_an_impact_never_creates_energy() -> None:
    """Asymmetric arches and portals of random stones: the share kept is at most what free hinges would keep."""
    random = np.random.default_rng(4)
    tried = 0
    while tried < 12:
        arch = make_arch(10.0, random.uniform(1.6, 2.2), random.uniform(120.0, 170.0), int(random.integers(5, 16)))
        weight = random.uniform(0.5, 2.0, arch.voussoirs)
        section = replace(arch, mass=arch.mass * weight, inertia=arch.inertia * weight)
        m = MechanismModel(section)
        try:
            first, second = m.tables
        except NoView:
            continue
        tried += 1
        kept = np.square(m.projections) * np.array([first.mass / second.mass, second.mass / first.mass])
        assert kept.max() <= 1.0
        right, left = m.fields
        assert kept[0] <= energy_kept(section, -left) + 1e-9 or m.projections[0] < 0.0
        assert kept[1] <= energy_kept(section, -right) + 1e-9 or m.projections[1] < 0.0
        # the same mass product ties the two impacts together
        assert m.projections[0] * first.mass == pytest.approx(m.projections[1] * second.mass, rel=1e-9, abs=1e-9)


def test_a_lopsided_section_has_two_sides() -> None:
    m = MechanismModel(lopsided(), 0.9)
    right, left = m.tables
    assert right.critical != pytest.approx(left.critical, rel=1e-2)
    assert m.restitution[0] ** 2 * right.mass / left.mass == pytest.approx(0.81)
    quiet = pulses.constant(0.0, 1.0).ground
    r = rocking.history(m.body, quiet, 20.0, 0.002, tolerance=1e-11, start_rotation=0.3 * right.critical)
    energy = r.kinetic + r.potential
    impacts = [t for kind, t, _ in r.events if kind == "impact"]
    assert len(impacts) > 4
    before = [energy[r.time < t][-1] for t in impacts[:4]]
    after = [energy[r.time > t][0] for t in impacts[:4]]
    assert np.divide(after, before) == pytest.approx(0.81, rel=1e-6)
    assert energy[0] == pytest.approx(before[0], rel=1e-8)


def test_an_impact_on_one_body_is_that_of_housner() -> None:
    """The impact of free hinges on a block is Housner's; on a vault it keeps far more than its two mechanisms take."""
    block = BlockModel(make_block(1.0, 4.0))
    assert np.sqrt(MechanismModel(block.block).energy_kept) == pytest.approx(block.housner, rel=1e-9)
    vault = replace(model("vault/dejong-a.toml"), rule="energy-safe")
    assert vault.restitution[0] < 0.1 and vault.energy_kept[0] > 0.7
    assert any("If hinges could open at all joints" in text for text in vault.warnings)
    free = MechanismModel(vault.assembly, "inelastic")
    assert free.restitution == pytest.approx(np.sqrt(vault.energy_kept), rel=1e-9)
    assert not free.warnings
    assert not MechanismModel(make_block(1.0, 4.0)).warnings


def test_mechanisms_that_do_not_reflect_come_to_rest() -> None:
    m = MechanismModel(make_arch(5.0, 1.0, 120.0, 12), "energy-safe")
    assert max(m.projections) < 0.0 and m.restitution == (0.0, 0.0)
    assert any("comes to rest at each impact" in text for text in m.warnings)
    r = rocking.history(m.body, pulses.step_pulse(1.2 * m.uplift[0] * GRAVITY, 0.2).ground, 3.0, 0.01)
    assert r.outcome == "recovery" and r.rotation[-1] == 0.0


def test_an_ensemble_does_not_depend_on_threads() -> None:
    m = model("vault/dejong-a.toml")
    motions = [pulses.step_pulse(0.2 * GRAVITY, t).ground for t in np.linspace(0.2, 2.0, 12)]
    runs = np.arange(12)
    answers = [rocking.ensemble([m.body], motions, np.zeros(12, dtype=int), runs, 1.0, 20.0, threads=k) for k in (1, 2, 5)]
    assert len(set(answers[0].outcome.tolist())) == 2
    for other in answers[1:]:
        for name in ("outcome", "peak", "peak_ratio", "stop_time", "steps"):
            assert np.array_equal(getattr(answers[0], name), getattr(other, name))
    alone = rocking.history(m.body, motions[3], 20.0, 0.1)
    assert alone.peak == pytest.approx(answers[0].peak[3], rel=1e-12)


def test_what_cannot_rock_says_why() -> None:
    with pytest.raises(CannotStand, match="no thrust line stays inside"):
        _ = MechanismModel(make_arch(10.0, 0.6, 180.0, 15)).body
    wall = of_case("dem/wall.toml")
    _, slides = LimitAnalysis(wall, 0.3).collapse(1)
    with pytest.raises(CannotRock, match="slides along"):
        linkage(wall, slides, 1)
    vault = of_case("vault/dejong-a.toml")
    _, crushes = LimitAnalysis(vault, strength=2e6).collapse(1)
    with pytest.raises(CannotRock, match="crush at"):
        linkage(vault, crushes, 1)
    with pytest.raises(NoView, match='"thesis" does not apply'):
        _ = MechanismModel(vault, "thesis").body


def test_more_than_one_degree_of_freedom_is_refused() -> None:
    """Hinges taken together from the mechanisms of both sides leave the parts loose."""
    arch = make_arch(*ARCHES[0])
    limit = LimitAnalysis(arch)
    (_, right), (_, left) = limit.collapse(1), limit.collapse(-1)
    both = replace(
        right,
        hinges=sorted({j: face for j, face in [*right.hinges, *left.hinges]}.items()),
        opening_p=right.opening_p + left.opening_p,
        opening_q=right.opening_q + left.opening_q,
    )
    with pytest.raises(CannotRock, match="degrees of freedom"):
        linkage(arch, both, 1)


def test_a_body_that_gains_energy_is_refused() -> None:
    m = model("dem/column.toml")
    with pytest.raises(ValueError, match="must not create energy"):
        core_mechanism.table_body(*m.tables, (1.01, 1.0))
    broken = m.body.parameters.copy()
    broken[2] = -1.0
    with pytest.raises(CoreError):
        rocking.history(rocking.Body(3, broken), pulses.constant(1.0, 1.0).ground, 1.0, 0.1)
