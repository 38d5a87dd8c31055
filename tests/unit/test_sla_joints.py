"""Joints of no thickness in sequentially linear analysis: one joint against Coulomb's law, and buildings of stones against
limit analysis with friction."""

import numpy as np
import pytest
from test_sla_stages import move, sliding

from extrados.analyses.context import Context
from extrados.analyses.sequence import run_analyses
from extrados.analyses.sla.contact import SHUT, settle
from extrados.analyses.sla.model import build
from extrados.core.sla import EVENT, MODE, Behaviour, Freedoms, Joints, Model, Monitor, Softening, Stop
from extrados.decks.reader import make_deck

KN, KS, MU, C, GII = 82e9, 36e9, 0.75, 0.35e6, 125.0  # J4D: Pa/m, Pa/m, -, Pa, N/m


def one_joint(
    pressure: float,
    *,
    proportional: float = 0.0,
    law: str = "exponential",
    ripple: float = 0.1,
    friction: float = MU,
    cohesion: float = C,
    slip: float = 4e-3,
    events: int = 2000,
    tension: float = 0.0,
):
    """Shear of 1 m x 1 m of joint whose upper side moves as one: constant `pressure` [Pa], and `proportional` Pa of
    pressure for each Pa of shear; a `tension` that softens, or none that limits."""
    xy = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 0.0], [0.0, 0.0]])
    free = Freedoms.make(4, [(n, d) for n in (0, 1) for d in (0, 1)], [[(2, d, 1.0), (3, d, 1.0)] for d in (0, 1)])
    joint = Joints(
        np.array([[0, 1, 2, 3]]),
        np.array([[0.0, 1.0]]),
        np.array([[0.5, 0.5]]),
        KN,
        KS,
        friction,
        cohesion=Softening(cohesion, GII, law, ripple) if cohesion else None,
        dry=not cohesion,
        small=1.0,
        tension=Softening(tension, 18.0, law, ripple) if tension else None,
    )
    constant, reference = np.zeros((4, 2)), np.zeros((4, 2))
    constant[2, 1], reference[2] = -pressure, [1.0, -proportional]
    with Model(xy, free, [joint], Behaviour(floor=1e-9, closure=True)) as model:
        model.loads(constant, reference)
        return model.run(events, [Monitor.of(2, 0), Monitor.of(2, 1)], Stop(displacement=slip))


def coulomb(events, pressure: np.ndarray | float, law: str = "exponential", friction: float = MU) -> np.ndarray:
    """c(slip) + mu p at the inelastic slip of each event [Pa]."""
    slip = np.maximum(events.monitors[:, 0] - events.load / KS, 0.0)
    worn = C * slip / GII
    cohesion = C * np.exp(-worn) if law == "exponential" else C * np.maximum(1.0 - 0.5 * worn, 0.0)
    return cohesion + friction * pressure


@pytest.mark.parametrize("law", ["exponential", "linear"])
@pytest.mark.parametrize("pressure", [0.1e6, 0.5e6, 1.0e6])
def test_a_joint_follows_coulomb_under_constant_pressure(pressure: float, law: str) -> None:
    """Peaks of the teeth lie on the curve raised by the ripple of the cohesion; what is left is friction alone."""
    ripple = 0.05
    found = one_joint(pressure, law=law, ripple=ripple, slip=2e-2)
    assert found.equilibrium.all()
    raised = coulomb(found, pressure, law)
    assert (found.load <= raised + 1.05 * ripple * C).all()
    peaks = found.code == EVENT["wear"]
    assert (found.load[peaks] >= raised[peaks] - 1.05 * ripple * C).all()
    assert found.load[0] == pytest.approx(C * (1.0 + ripple) + MU * pressure, rel=0.01)
    assert found.load[-1] == pytest.approx(MU * pressure, abs=1.05 * ripple * C) and not found.load[-1] < MU * pressure
    assert found.reason == "mechanism"  # it slides on under its friction
    # Work: the energy of mode II, and friction over the slip
    slip = found.monitors[-1, 0] - found.load[-1] / KS
    assert found.lost[-1] == pytest.approx(GII + MU * pressure * slip, rel=0.03)
    assert found.ledger_error < 1e-9
    # The first slip hands over to friction what it carries, and creates no energy
    assert (np.diff(found.lost) > -1e-9 * found.external.max()).all()


def test_a_joint_that_is_pulled_has_no_friction() -> None:
    """Tension takes mu sigma from the cohesion, before the first slip and after it, and nothing acts against the bond."""
    pull, ripple = 0.05e6, 0.05
    found = one_joint(-pull, tension=0.25e6, ripple=ripple)
    assert found.load[0] == pytest.approx(C * (1.0 + ripple) - MU * pull, rel=0.01)
    held = found.equilibrium
    slip = np.maximum(found.monitors[:, 0] - C / KS, 0.0)
    assert (found.load[held] <= (C * np.exp(-C * slip / GII) - MU * pull + 2.0 * ripple * C)[held]).all()
    assert held.sum() > 10 and (np.diff(found.lost) > -1e-9 * found.external.max()).all()
    assert found.reason == "mechanism" and found.load[held][-1] < 0.5 * C  # torn, as the bond is one


def test_a_joint_follows_coulomb_under_proportional_pressure() -> None:
    """tau grows with its pressure r tau: it slides at c / (1 - mu r), and softens by the same factor."""
    ratio, ripple = 0.6, 0.05
    found = one_joint(0.0, proportional=ratio, ripple=ripple)
    exact = coulomb(found, ratio * found.load)
    peaks = (found.code == EVENT["wear"]) & (found.load > 0.1 * found.load.max())
    assert peaks.sum() > 10
    assert found.load[0] == pytest.approx(C * (1.0 + ripple) / (1.0 - MU * ratio), rel=0.01)
    assert np.abs(found.load - exact)[peaks].max() < 2.2 * ripple * C / (1.0 - MU * ratio)
    assert found.ledger_error < 1e-9


def test_pressure_that_holds_the_joint_never_lets_it_slide() -> None:
    found = one_joint(0.0, proportional=1.0 / MU + 0.01)
    assert found.reason == "no point limits the load" and not len(found)


def test_energy_of_mode_two_is_spent() -> None:
    for law in ("linear", "exponential"):
        found = one_joint(0.0, law=law, friction=0.0, slip=0.05)
        assert found.crack_total == pytest.approx(GII, rel=0.01)


def test_a_dry_joint_slides_at_its_friction() -> None:
    found = one_joint(0.3e6, cohesion=0.0, slip=1e-2)
    assert found.load.max() == pytest.approx(MU * 0.3e6, rel=1e-4)


STRUCTURES = {
    "arch": {"kind": "arch", "radius": 10.0, "thickness": 1.5, "embrace": 157.5, "voussoirs": 7},
    "block": {"kind": "block", "width": 1.0, "height": 4.0},
    "column": {"kind": "column", "width": 1.0, "height": 4.0, "drums": 4},
    "vault": {"kind": "vault", "preset": "dejong-a"},
    "brickwork": {"kind": "brickwork", "unit_length": 0.5, "unit_height": 0.25, "units": 3, "courses": 4},
}


def capacity(structure: dict, friction: float | str, kind: str, **options):
    data = {"structure": structure, "joints": {"friction": friction}, "analysis": {"kind": kind, **options}}
    return run_analyses(Context(make_deck(data)))[0]


@pytest.mark.parametrize(
    ("kind", "friction", "below", "above"),
    [
        ("arch", 0.7, 1e-4, 1e-4),  # Oppenheim: hinges, as without sliding
        ("vault", 0.7, 1e-4, 1e-4),
        ("vault", 0.35, 1e-4, 1e-4),  # a point that slides lets its neighbour stick: only both at once go on
        ("vault", 0.3, 1e-4, 1e-4),
        ("block", 0.7, 1e-4, 1e-4),  # rocks at width over height
        ("block", 0.2, 1e-6, 1e-6),  # slides
        ("column", 0.2, 1e-6, 1e-6),
        pytest.param("brickwork", 0.5, 1e-5, 1e-5, marks=pytest.mark.verify),
        ("brickwork", 0.2, 1e-5, 1e-5),
        ("arch", 0.4, 1e-5, 1e-5),  # hinges and joints that slide
        ("arch", 0.25, 5e-5, 5e-5),
    ],
)
def test_the_load_of_limit_analysis_with_friction(kind: str, friction: float, below: float, above: float) -> None:
    limit = capacity(STRUCTURES[kind], friction, "tilt").results["collapse_acceleration_g"]
    found = capacity(STRUCTURES[kind], friction, "sla")
    assert not found.reason
    assert (1.0 - below) * limit < found.results["peak_acceleration_g"] < (1.0 + above) * limit
    assert found.results["events_without_equilibrium"] <= 3  # of a mechanism that begins
    # Displacements of a mechanism, which begins just below the peak, have no digits left
    load = np.asarray(found["event_load"])
    upto = slice(0, int(np.argmax(load > 0.998 * load[: found.results["peak_event"]].max())))
    assert upto.stop >= 1
    external, stored, lost, dissipated = (np.asarray(found[f"event_{n}"])[upto] for n in ("external", "stored", "lost", "dissipated"))
    assert np.abs(external - stored - lost).max() < 1e-6 * external.max()
    assert (np.diff(lost) > -1e-5 * external.max()).all()
    assert dissipated[-1] == pytest.approx(lost[-1], abs=1e-5 * external.max())
    assert (np.diff(found["event_dissipated"]) >= 0.0).all()


@pytest.mark.parametrize("friction", [0.7, 1.0])
def test_head_joints_that_do_not_press_carry_nothing(friction: float) -> None:
    """A wall under its weight has no pressure across its head joints; limit analysis, which lets joints dilate, puts some
    there. Where it may not, it says the same."""
    wall = STRUCTURES["brickwork"]
    found = capacity(wall, friction, "sla").results["peak_acceleration_g"]
    heads = {"joints": ["heads"], "friction": 0}
    data = {"structure": wall, "joints": {"friction": friction, "types": [heads]}, "analysis": {"kind": "tilt"}}
    stones = Context(make_deck(data)).building.blocks()
    assert [stones.joint_names[j].startswith("head joint") for j in stones.groups["heads"]] == [True] * 10
    assert sorted(stones.groups["beds"] + stones.groups["heads"]) == list(range(len(stones.joint_names)))
    level = run_analyses(Context(make_deck(data)))[0].results["collapse_acceleration_g"]
    assert found == pytest.approx(level, rel=1e-5)
    assert found < 0.96 * capacity(wall, friction, "tilt").results["collapse_acceleration_g"]


def test_no_point_is_sheared_beyond_its_friction() -> None:
    """In every state of a wall that slides and rocks."""
    deck = make_deck({"structure": STRUCTURES["brickwork"], "joints": {"friction": 0.5}, "analysis": {"kind": "sla"}})
    options = deck.analyses[0]
    model = build(Context(deck).building.mesh(options.mesh), options)
    slid = 0
    with model.open(options, 1) as core:
        settle(core, model, options, [])
        core.loads(model.constant, model.reference)
        for _ in range(15):
            load = float(core.run(20, [model.control], Stop(compliance=1e5)).load[-1])
            report = core.report(load)
            at = np.flatnonzero((core.damage()[SHUT] > 0) & (report["volume"] > 0))
            press = -report["stress_n"][at]
            assert (np.abs(report["stress_ns"][at]) <= 0.5 * press + 1e-3 * press.max()).all()
            slid = max(slid, int((core.damage()[MODE, at] % 4 > 0).sum()))
    assert slid > 50


def test_a_load_that_falls_for_the_next_tooth_turns_nothing_back() -> None:
    """What the fall undid slides on as the load grows: no point sticks only to slide again at that load."""
    wall = {"kind": "panel", "width": 0.44, "height": 0.25, "thickness": 0.1, "unit_length": 0.22, "unit_height": 0.0625}
    joints = {
        "normal_stiffness": KN,
        "shear_stiffness": KS,
        "tension": 2.5e5,
        "fracture_energy": 18.0,
        "friction": MU,
        "cohesion": C,
        "shear_energy": GII,
    }
    push = {"hold": [{"edge": "top", "fix": "y"}], "target_displacement": 4e-4}
    push |= {"reference": [{"kind": "displacement", "direction": "x", "parts": [{"edge": "top"}]}]}
    press = {"reference": [{"kind": "pressure", "edge": "top", "value": "0.3 MPa"}], "target_multiplier": 1.0}
    data = {
        "structure": wall,
        "joints": joints,
        "supports": {"held": [{"edge": "bottom"}]},
        "material": {"density": 0.0, "young": 16.7e9, "poisson": 0.15},
        "analysis": {
            "kind": "sla",
            "events": 600,
            "mesh": {"joints": "interfaces", "size": 0.11},
            "stages": [{"name": "press", **press}, {"name": "push", **push}],
        },
    }
    found = run_analyses(Context(make_deck(data)))[0]
    load, point, code = (np.asarray(found[f"event_{name}"]) for name in ("load", "point", "code"))
    assert (np.diff(load) < 0.0).sum() > 20 and (code == EVENT["wear"]).sum() > 50
    again = (code[:-1] == EVENT["stick"]) & (code[1:] == EVENT["slide"]) & (point[:-1] == point[1:])
    assert not (again & (np.diff(load) <= 1e-12 * load.max())).any()


def test_sliding_friction_follows_a_changed_factor_as_a_new_one() -> None:
    """Forces that friction holds go with the change of the factor; all regions are looked at."""
    update, refactor = (
        capacity(STRUCTURES["brickwork"] | {"units": 2, "courses": 3}, 0.7, "sla", events=60, algorithm=name)
        for name in ("update", "refactor")
    )
    grown = update["event_load"] > 1e-6 * update["event_load"].max()  # at none, points that slide at once have no order
    assert grown.sum() > 40
    for name in ("event_point", "event_code"):
        assert (update[name] == refactor[name])[grown].all()
    for name in ("event_load", "event_displacement"):
        np.testing.assert_allclose(update[name][grown], refactor[name][grown], rtol=1e-6)


@pytest.mark.verify
def test_a_church_whose_joints_slide_under_its_weight() -> None:
    """Turns from the state that sticks find none; friction that falls to it does. The load is that of limit analysis."""
    church = {"kind": "aisled-vault", "preset": "vezelay-like"}
    limit = capacity(church, 0.35, "tilt").results["collapse_acceleration_g"]
    found = capacity(church, 0.35, "sla")
    assert not found.warnings and found.results["events_without_equilibrium"] <= 3
    assert found.results["peak_acceleration_g"] == pytest.approx(limit, rel=1e-4)


def test_friction_that_falls_to_what_is_asked(monkeypatch) -> None:
    """Where turns give up at once the state is found from more friction, with the same load at the end."""
    direct = capacity(STRUCTURES["arch"], 0.25, "sla")
    monkeypatch.setattr("extrados.analyses.sla.contact.MOST_SLIDING", 10)
    falling = capacity(STRUCTURES["arch"], 0.25, "sla")
    assert not direct.warnings and not falling.warnings
    assert falling.results["peak_acceleration_g"] == pytest.approx(direct.results["peak_acceleration_g"], rel=1e-4)
    monkeypatch.setattr("extrados.analyses.sla.contact.MORE_FRICTION", ())
    assert any("no consistent set of dry joints" in text for text in capacity(STRUCTURES["arch"], 0.25, "sla", events=5).warnings)


@pytest.mark.parametrize(("friction", "events"), [("no-sliding", 150), (0.7, 150)])
def test_regions_of_units_and_joints_wait_until_one_slips(friction, events) -> None:
    """What is left out holds no event: those of a new factor and of all points, also as the first joints slide."""
    joints = {"tension": 1e5, "fracture_energy": 20.0, "friction": friction, "normal_stiffness": 8e10, "shear_stiffness": 3.6e10}
    if friction != "no-sliding":
        joints |= {"cohesion": 1.5e5, "shear_energy": 100.0}
    found = []
    for algorithm in ("update", "refactor"):
        data = {
            "structure": {"kind": "panel", "width": 3.0, "height": 3.0, "thickness": 0.2, "unit_length": 0.5, "unit_height": 0.25},
            "material": {"young": 6.9e9, "poisson": 0.25, "density": 1950.0},
            "joints": joints,
            "analysis": {
                "kind": "sla",
                "ripple": 0.2,
                "mesh": {"size": 0.15, "joints": "interfaces"},
                "events": events,
                "constant": [{"kind": "gravity"}, {"kind": "pressure", "edge": "top", "value": "0.1 MPa"}],
                "reference": [{"kind": "spread", "edge": "top", "fx": "1 kN"}],
                "algorithm": algorithm,
            },
        }
        found.append(run_analyses(Context(make_deck(data)))[0])
    update, refactor = found
    assert len(update["event_load"]) == events and (update["event_code"] >= EVENT["wear"]).any() == (friction == 0.7)
    for name in ("event_point", "event_code"):
        assert (update[name] == refactor[name]).all()
    for name in ("event_load", "event_displacement", "event_stored"):
        np.testing.assert_allclose(update[name], refactor[name], rtol=1e-9)
    assert update.results["energy_residual_ratio"] < 1e-9


@pytest.mark.parametrize("options", [{"solution": "incremental"}, {"without_equilibrium": "proportional"}])
def test_variants_do_not_take_joints_that_slide(options) -> None:
    assert "joints that slide" in capacity(STRUCTURES["block"], 0.7, "sla", **options).reason


def test_no_sliding_keeps_what_hinges() -> None:
    found = capacity(STRUCTURES["brickwork"], "no-sliding", "sla")
    assert found.results["peak_acceleration_g"] == pytest.approx(1.5, rel=1e-4)
    assert "do not slide" in found.answer
    sliding = capacity(STRUCTURES["block"], 0.2, "sla")
    assert "do not slide" not in sliding.answer


def test_bad_joints_are_refused() -> None:
    arch = STRUCTURES["arch"]
    for joints, word in (
        ({"cohesion": 1e5}, "no `shear_energy`"),
        ({"tension": 1e5}, "no `fracture_energy`"),
        ({"compressive_strength": 1e6}, "require each other"),
        ({"cohesion": 1e6, "shear_energy": 1e-3, "normal_stiffness": 1e9}, "snap back"),
    ):
        data = {"structure": arch, "joints": joints, "analysis": {"kind": "sla"}}
        assert word in run_analyses(Context(make_deck(data)))[0].reason


@pytest.mark.parametrize("before", [1e-6, -2e-6])
def test_a_joint_that_first_slides_in_a_later_stage_keeps_the_energy(before: float) -> None:
    """A block pushed a little, without sliding, then on or back until it slides: the supports' work is in the balance,
    and at the end all energies are those of the push at once."""

    def push(*ends: float) -> dict:
        deck = make_deck(sliding(*(move(end, name=f"to {end}") for end in ends)))
        last = run_analyses(Context(deck))[0].results["stages"]
        assert all(stage["energy_residual_ratio"] < 1e-12 for stage in last)
        return last[-1]

    once, twice = push(2e-4), push(before, 2e-4)
    assert twice["end_load_N"] == pytest.approx(0.5 * 1e5, rel=1e-6)
    for name in ("end_load_N", "stored_energy_J", "external_work_J", "dissipated_energy_J"):
        assert twice[name] == pytest.approx(once[name], rel=1e-9), name
