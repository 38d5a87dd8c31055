"""Rigid contacts (Moreau-Jean time stepping) against exact solutions, limit analysis, the impact law and springs."""

import tomllib
from dataclasses import replace

import numpy as np
import pytest
from dem_models import G, block_on_floor, constant, cosine, housner, model, pieces, rectangle
from interrupting import interrupted

import extrados
from extrados import _core
from extrados.analyses.dem.job import Runs, Task
from extrados.core import dem, dem_run
from extrados.core.ground import as_motion_set
from extrados.decks.reader import DeckError
from extrados.model.structures.arch import make_arch
from extrados.running.run import Run
from extrados.views.rigid import rigid_bodies
from extrados.views.rockers.impact import inelastic_impact
from extrados.views.rockers.mechanism import MechanismModel

ANY = 1e9  # stiffness: rigid contacts do not ask for it


def options(end: float, output: float = 0.01, **keys: object) -> dem.Options:
    return dem.Options(end, output, rigid=True, **keys)


def law(friction: float) -> dem.Law:
    return dem.Law(ANY, ANY, friction)


@pytest.mark.parametrize(("step", "most"), [(2e-3, 6e-3), (1e-3, 2.5e-3), (2.5e-4, 8e-4)])
def test_rocking_block_follows_housner(step: float, most: float) -> None:
    """RMS over 5 s over alpha; of peers at 1 ms: MuJoCo 1.3e-3, LMGC90 2.8e-3 (docs/dem.md)."""
    times = np.arange(0.0, 5.0, 0.01)
    run = dem.run(block_on_floor(1.0, 4.0, law(2.0)), options(5.0, step=step), cosine(0.5 * G, 10.88), times=times)
    exact = np.interp(run.time, times, housner(1.0, 4.0, 0.5 * G, 10.88, times))
    assert np.sqrt(np.mean((-run.place[:, 0, 2] - exact) ** 2)) / np.arctan(0.25) < most
    assert run.effort.open_steps == 0 and run.effort.residual <= 1e-5
    assert run.residual < 0.01


def test_newmark_sliding_block() -> None:
    friction, a, t = 0.3, 0.5 * G, 0.2
    bodies = block_on_floor(4.0, 0.2, law(friction))
    run = dem.run(bodies, options(0.4, step=1e-4), pieces([0.0, t], [a]))
    slip = 0.5 * a * t**2 * (a / (friction * G) - 1.0)
    assert run.settled[0, 0] - run.place[-1, 0, 0] == pytest.approx(slip, rel=1e-3)
    assert run.energy["friction"][-1] == pytest.approx(friction * bodies.mass[0] * G * slip, rel=1e-3)


@pytest.mark.parametrize(("ratio", "topples"), [(0.999, False), (1.001, True)])
def test_block_topples_at_its_slenderness(ratio: float, topples: bool) -> None:
    run = dem.run(block_on_floor(1.0, 4.0, law(2.0)), options(8.0, 0.1, collapse=0.5, step=2e-3), constant(ratio * 0.25 * G))
    assert (run.reason == "collapse") == topples
    if not topples:
        assert np.abs(run.place[:, 0, 2]).max() < 1e-9  # no spring gives


@pytest.mark.parametrize(("slope", "slides"), [(0.5999, False), (0.6001, True)])
def test_slope_slides_at_its_friction(slope: float, slides: bool) -> None:
    angle = np.arctan(slope)
    bodies = block_on_floor(2.0, 0.2, law(0.6))
    run = dem.run(bodies, options(1.0, gravity=(0.0, -G * np.cos(angle))), constant(-G * np.sin(angle)))
    moved = run.place[-1, 0, 0] - run.settled[0, 0]
    exact = 0.5 * G * (np.sin(angle) - 0.6 * np.cos(angle)) * run.time[-1] ** 2
    assert moved == pytest.approx(exact, rel=0.02) if slides else abs(moved) < 1e-9


@pytest.mark.parametrize("rebound", [0.0, 0.5, 0.8])
def test_a_flat_fall_rebounds_as_newton_says(rebound: float) -> None:
    bodies = model([rectangle(-1.0, 1.0, 0.1, 1.1)], [rectangle(-5.0, 5.0, -1.0, 0.0)], law(0.6))
    run = dem.run(bodies, options(0.5, 1e-3, step=1e-4, rebound=rebound), shift=np.zeros((2, 3)))
    fall = np.sqrt(2 * 0.1 / G)
    height = run.place[run.time > fall * (1.0 + 0.5 * rebound), 0, 1] - 0.5
    assert height.max() == pytest.approx(0.1 * rebound**2, abs=1e-4)


@pytest.mark.parametrize(("embrace", "voussoirs"), [(157.5, 7), (170.0, 17)])
def test_the_impact_is_that_of_the_rocking_arch(embrace: float, voussoirs: int) -> None:
    """Without gravity one step of closed joints that hardly slide is Moreau's blow, which the rocking arch uses."""
    arch = make_arch(10.0, 1.5, embrace, voussoirs)
    rigid = rigid_bodies(arch)
    before = np.zeros((len(rigid.mass), 3))
    before[:voussoirs] = -MechanismModel(arch).fields[0]
    bodies = dem.Bodies(rigid.centroid, rigid.mass, rigid.inertia, rigid.parts, rigid.owner, rigid.outer, rigid.depth, [law(10.0)])
    step = 1e-5
    one = dem.Options(3 * step, step, step=step, rigid=True, gravity=(0.0, -1e-9), residual_limit=1e9, domain=(-99.0, 99.0, -99.0, 99.0))
    run = dem.run(bodies, one, rate=before)
    found = (run.place[-1, :voussoirs] - run.place[-2, :voussoirs]) / step
    after = inelastic_impact(arch, before[:voussoirs])
    assert np.abs(after).max() > 0.05 * np.abs(before).max()
    assert np.abs(found - after).max() < 1e-3 * np.abs(before).max()


def test_forces_of_a_block_at_rest_carry_it() -> None:
    bodies = block_on_floor(1.0, 4.0, law(0.7))
    run = dem.run(bodies, options(0.1))
    assert run.contacts.normal.sum() == pytest.approx(bodies.mass[0] * G, rel=1e-6)
    assert run.place[-1, 0] == pytest.approx([0.0, 2.0, 0.0], abs=1e-9)


def wall() -> dem.Bodies:
    blocks = [
        rectangle(0.5 * k + 0.25 * (row % 2), 0.5 * k + 0.25 * (row % 2) + 0.5, 0.2 * row, 0.2 * row + 0.2)
        for row in range(5)
        for k in range(6)
    ]
    return model(blocks, [rectangle(-2.0, 6.0, -1.0, 0.0)], law(0.5))


def test_threads_and_pauses_change_no_bit() -> None:
    bodies, asked = wall(), options(0.4, 0.02)
    with as_motion_set([cosine(8.0, 12.0, 0.3)]) as motions:
        with dem.Model(bodies, asked) as one:
            whole = one.run(motions)
        states = []
        with dem.Model(bodies, replace(asked, threads=2)) as two:
            watched = two.run(motions, watch=lambda t: states.append(two.state()))
        with dem.Model(bodies, asked) as three:
            resumed = three.run(motions, state=states[0])
    assert whole.energy["friction"][-1] > 0.0
    for other in (watched, resumed):
        np.testing.assert_array_equal(other.place, whole.place)
        np.testing.assert_array_equal(other.rate, whole.rate)
        assert other.effort == whole.effort


def test_cancel_answers_with_what_it_has(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(dem_run, "long_call", interrupted(dem_run.long_call, 1.0, lambda: _core.api_support.set_cancel(1)))
    run = dem.run(block_on_floor(1.0, 4.0, law(2.0)), options(36000.0, 0.5), cosine(0.5 * G, 10.88, 36000.0))
    _core.api_support.set_cancel(0)
    assert run.interrupted and len(run.time) > 1 and np.isfinite(run.place).all()


def deck(text: str) -> Run:
    return extrados.run(tomllib.loads(text))


ARCH = '[structure]\nkind = "arch"\nradius = 10.0\nthickness = 1.5\nembrace = 157.5\nvoussoirs = 7\n'


@pytest.mark.parametrize(
    ("structure", "friction"),
    [
        (ARCH, 2.0),
        pytest.param(
            '[structure]\nkind = "brickwork"\nunit_length = 0.5\nunit_height = 0.25\nunits = 2\ncourses = 4\n',
            0.35,
            marks=pytest.mark.verify,
        ),
        ('[structure]\nkind = "column"\nwidth = 0.5\nheight = 2.0\ndrums = 4\n', 0.7),
    ],
)
def test_tilt_is_that_of_limit_analysis(structure: str, friction: float) -> None:
    run = deck(
        f'{structure}[joints]\nfriction = {friction}\n[[analysis]]\nkind = "tilt"\n[[analysis]]\nkind = "dem"\ntest = "tilt"\n'
        'solver = "nonsmooth"\n'
    )
    exact = run["tilt"]["collapse_acceleration_g"]
    assert run["dem"]["collapse_acceleration_g"] == pytest.approx(exact, rel=0.01, abs=2e-3)
    assert "Rigid contacts converged in" in run.results[1].answer


def test_an_arch_on_spreading_supports_falls_where_three_hinges_say() -> None:
    """Without inertia, through large displacements, against the kinematics of three hinges (`supports`)."""
    arch = '[structure]\nkind = "arch"\nradius = 1.0\nthickness = 0.2\nembrace = 150.0\nvoussoirs = 16\n[joints]\nfriction = 2.0\n'
    exact = deck(f'{arch}[[analysis]]\nkind = "supports"\n')["supports"]["movement_at_fall_m"]
    run = deck(
        f'{arch}[[initial.movements]]\njoint = "joint 16"\ndx = {2.0 * exact}\nduration = 60.0\n[[analysis]]\nkind = "dem"\n'
        'solver = "nonsmooth"\nquasi_static = true\nend_time = 60.0\noutput_step = 0.1\n'
    )
    time = run["dem"]["stop_time_s"] / 60.0
    assert run["dem"]["outcome"] == "collapse"
    assert 2.0 * exact * (time - np.sin(2.0 * np.pi * time) / (2.0 * np.pi)) == pytest.approx(exact, rel=0.01)


@pytest.mark.parametrize(
    ("keys", "why"),
    [
        ('solver = "nonsmooth"\nmass_damping = 0.1', "rigid contacts have no stiffness"),
        ("quasi_static = true", 'needs solver = "nonsmooth"'),
        ('solver = "nonsmooth"\nfraction = 0.1', "rigid contacts have no stiffness"),
    ],
)
def test_what_only_the_other_solver_knows_is_refused(keys: str, why: str) -> None:
    with pytest.raises(DeckError, match=why):
        deck(f'{ARCH}[[analysis]]\nkind = "dem"\n{keys}\n')


def test_mortar_of_a_deck_holds_an_arch_and_is_doubted() -> None:
    found = deck(f'{ARCH}[joints]\ncohesion = "0.1 MPa"\n[[analysis]]\nkind = "dem"\nsolver = "nonsmooth"\n').results[0]
    assert found.status == "ok" and any("brittle mortar may fail earlier" in text for text in found.warnings)


def test_effort_is_kept_in_rows() -> None:
    job = Runs([block_on_floor(1.0, 4.0, law(2.0))], [Task(0, options(0.2), cosine(0.5 * G, 10.88))])
    found = job.one(0)
    rows = job.rows(found)
    assert job.run_of({name: values[None] for name, values in rows.items()}).effort == found.effort
    assert found.effort.steps > 50


def test_a_run_that_does_not_converge_is_reported() -> None:
    from extrados.analyses.dem.model import unconverged

    assert unconverged(dem_run.Effort(100, 300, 20, 0, 1e-6, 0.7)) == []
    (told,) = unconverged(dem_run.Effort(100, 300, 200, 3, 0.02, 0.7))
    assert "did not converge in 3 of 100 steps. The greatest error, at 0.7 s" in told and "0.02" in told
    assert unconverged(dem_run.NO_EFFORT) == []
    (told,) = unconverged(dem_run.Effort(0, 0, 0, 2, 0.0, 0.0))  # on springs
    assert "pressure of crushing faces did not converge 2 times" in told


@pytest.mark.parametrize(("limit", "warned"), [(1.01, True), (0.5, False)])
def test_maps_of_both_solvers_side_by_side(monkeypatch: pytest.MonkeyPatch, limit: float, warned: bool) -> None:
    from extrados.analyses.dem import dem_domain

    monkeypatch.setattr(dem_domain, "AGREE", limit)
    run = deck(
        '[structure]\nkind = "block"\nwidth = 0.5\nheight = 2.0\n[joints]\nfriction = 2.0\n[[analysis]]\nkind = "dem-domain"\n'
        'cross_check = true\namplitudes = ["0.5 g", "0.8 g"]\ndurations = [0.1, 0.2, 0.3, 0.4, 0.5]\naccuracy = 0.02\n'
    )
    found = run["dem-domain"]["cross_check"]
    assert found.cells == 10 and found.agreement_ratio >= 0.9
    assert run.array("dem-domain", "fails").shape == (2, 2, 5)
    assert run.array("dem-domain", "fails").any() and not run.array("dem-domain", "fails").all()
    curves = run["dem-domain"]["curves"]
    assert [c.solver for c in curves] == ["compliant", "nonsmooth"] and curves[1].beta_s is None
    assert any("agree in" in text for text in run.results[0].warnings) == warned


@pytest.mark.parametrize(("step", "most"), [(1e-3, 0.03), (2.5e-4, 0.01)])
def test_a_stocky_block_loses_as_housner_says(step: float, most: float) -> None:
    found = deck(
        '[structure]\nkind = "block"\nwidth = 1.0\nheight = 1.6\n[joints]\nfriction = 5.0\n[initial]\nrotation_ratio = 0.3\n'
        f'[[analysis]]\nkind = "dem"\nsolver = "nonsmooth"\nend_time = 1.5\ntime_step = {step}\n'
    )["dem"]
    assert found["restitution_measured"] == pytest.approx(found["restitution_housner"], rel=most)


def test_contacts_that_friction_wedges_end_with_the_reason() -> None:
    """2 x 3 blocks in bond without sliding: no step finds impulses. It took minutes, without an answer."""
    wall = {"kind": "brickwork", "unit_length": 0.5, "unit_height": 0.25, "units": 2, "courses": 3}
    deck = {"structure": wall, "joints": {"friction": "no-sliding"}, "analysis": [{"kind": "dem", "solver": "nonsmooth", "test": "tilt"}]}
    (found,) = extrados.run(deck).results
    assert (
        found.status == "refused"
        and "In 100 of these steps the solver did not find" in found.reason
        and "a smaller coefficient of friction" in found.reason
    )
