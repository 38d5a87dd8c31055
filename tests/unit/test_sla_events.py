"""The event loop on small walls: the beam of the thesis, two algorithms, threads, going on, loads both ways."""

import tomllib
from pathlib import Path

import numpy as np
import pytest

from extrados.analyses.assess.hazard import Demanded
from extrados.analyses.context import Context, Refused
from extrados.analyses.sequence import run_analyses
from extrados.analyses.sla.curve import bilinear, envelope
from extrados.analyses.sla.events import damage_before, run_curves
from extrados.analyses.sla.model import build
from extrados.core.errors import CoreError
from extrados.core.sla import Behaviour, Model, Monitor, Stop
from extrados.decks.reader import DeckError, make_deck

CASES = Path(__file__).resolve().parents[2] / "cases" / "sla"


def wall(size: float = 0.15, **analysis) -> dict:
    """A wall with an opening under its weight, a pressure and a push at the top."""
    return {
        "structure": {
            "kind": "panel",
            "width": 3.0,
            "height": 3.0,
            "thickness": 0.2,
            "openings": [{"x": [1.05, 1.95], "y": [0.9, 2.1]}],
            "regions": [{"y": [2.85, 3.0], "linear": True}],
        },
        "material": {"young": 6.9e9, "poisson": 0.25, "density": 1950.0, "tensile_strength": 0.2e6, "fracture_energy": 50.0},
        "supports": {"held": [{"edge": "bottom"}]},
        "analysis": [
            {
                "kind": "sla",
                "mesh": {"size": size},
                "ripple": 0.2,
                "events": 300,
                "constant": [{"kind": "gravity"}, {"kind": "pressure", "edge": "top", "value": "0.1 MPa"}],
                "reference": [{"kind": "spread", "edge": "top", "fx": "1 kN"}],
                **analysis,
            }
        ],
    }


#: Cracks that stay open, and no equilibrium iterations where equilibrium is lost
EVENTS_ALONE = {"crack_closure": False, "without_equilibrium": "load-unload"}


def curves(data: dict, threads: int = 1):
    deck = make_deck(data)
    context = Context(deck)
    model = build(context.building.mesh(deck.analyses[0].mesh), deck.analyses[0])
    return model, run_curves(model, deck.analyses[0], threads, lambda *_: None)


def run_deck(data: dict):
    return run_analyses(Context(make_deck(data)))[0]


def beam(prestress: float, cracking: str) -> dict:
    """The beam of the case, 100 mm deep in place of 110."""
    data = tomllib.loads((CASES / "beam.toml").read_text(encoding="utf-8"))
    data["structure"]["height"] = 0.1
    data["analysis"][0]["mesh"]["lines_y"] = [0.025, 0.05, 0.075]
    for load in data["analysis"][0]["reference"]:
        load["y"] = 0.1
    for load in data["analysis"][0]["constant"]:
        load["value"] = -1e6 * prestress
    data["analysis"][0] |= {"cracking": cracking, "states": [], "section_x": []}
    return data


@pytest.mark.parametrize(
    ("prestress", "cracking", "peak", "cycle", "lost"),
    [
        (0, "isotropic", 4.821, 32, None),
        (0, "orthotropic", 4.809, 33, None),
        (-1, "isotropic", 6.366, 44, None),
        (-1, "orthotropic", 6.415, 44, None),
        (1, "isotropic", 3.244, 21, 162),
        (1, "orthotropic", 3.271, 31, 161),
    ],
)
def test_beam_of_the_thesis(prestress, cracking, peak, cycle, lost) -> None:
    """Thesis 4.3.1; peaks and cycles by an independent script on the same assumed outline."""
    r = run_deck(beam(prestress, cracking)).results
    assert r["peak_load_N"] / 1e3 == pytest.approx(peak, abs=6e-4)
    assert (r["peak_event"], r["first_event_without_equilibrium"]) == (cycle, lost)
    assert r["energy_residual_ratio"] < 1e-9


def test_lost_equilibrium_under_tensile_prestress() -> None:
    """Equilibrium is lost at cycle 162, back in between, and for good from 205."""
    lost = np.flatnonzero(run_deck(beam(1, "isotropic"))["event_equilibrium"] == 0) + 1
    assert lost[:9].tolist() == [162, 165, 170, 190, 192, 195, 197, 201, 205]
    assert (np.diff(lost[8:]) == 1).all()
    assert 218 in lost


def test_all_loads_go_down_together_where_equilibrium_is_lost() -> None:
    """Intermittent proportional loading: the same events until equilibrium is lost; from then on no state exceeds a
    strength, because the prestress too is taken back, and the energies still balance."""
    found = []
    for variant in ("load-unload", "proportional"):
        data = beam(1, "isotropic")
        data["analysis"][0] |= {"without_equilibrium": variant, "states": [163]}
        found.append(run_deck(data))
    kept, scaled = found
    np.testing.assert_allclose(scaled["event_load"][:161], kept["event_load"][:161], rtol=1e-9)
    assert (kept["event_scale"] == 1.0).all()
    lost = scaled["event_equilibrium"] == 0
    assert np.flatnonzero(lost)[0] == 161  # as in the thesis' variant
    assert ((scaled["event_scale"] < 1.0) == lost).all() and scaled["event_scale"].min() > 0.0
    assert scaled["event_load"][161] == scaled["event_load"][160]  # lambda waits
    assert scaled.results["energy_residual_ratio"] < 1e-9
    # Event 163, without equilibrium: virgin points of the cracking column stay below their first tooth, 1.0953 ft
    k = int(np.flatnonzero(scaled["state_event"] == 163)[0])
    virgin = (scaled["state_ratio_n"][k] == 1.0) & (np.abs(scaled["point_xy"][:, 0] - 0.25) < 0.01)
    assert scaled["state_stress_1"][k][virgin].max() == pytest.approx(1.095313 * 3e6, rel=1e-5)


def test_an_incremental_solution_agrees_where_it_converges_and_stalls_where_it_does_not() -> None:
    """The beam of the thesis. Without prestress the secant iteration follows the events to the end; under tensile
    prestress it stalls where the load has to come back, with most of the beam's teeth still there."""
    found = {}
    for prestress in (0, 1):
        for solution in ("events", "incremental"):
            data = beam(prestress, "isotropic")
            data["analysis"][0] |= {"solution": solution}
            found[prestress, solution] = run_deck(data)
    events, steps = found[0, "events"], found[0, "incremental"]
    assert steps.results["peak_load_N"] == pytest.approx(events.results["peak_load_N"], rel=0.03)
    way, load = steps["event_displacement"], steps["event_load"]
    for at in (0.04e-3, 0.12e-3, 0.2e-3):  # on the way up and down the tail
        there = np.interp(at, events["envelope_displacement"], events["envelope_load"])
        assert np.interp(at, way, load) == pytest.approx(there, rel=0.12)
    events, steps = found[1, "events"], found[1, "incremental"]
    assert steps.results["stop"] == "no convergence" and events.results["stop"] == "mechanism"
    assert steps.results["crack_energy_J"] < 0.5 * events.results["crack_energy_J"]
    assert steps.results["greatest_load_N"] == pytest.approx(events.results["greatest_load_N"], rel=0.01)


def test_variants_agree_with_a_new_factor_at_each_event() -> None:
    data = beam(1, "orthotropic")
    found = []
    for algorithm in ("update", "refactor"):
        data["analysis"][0] |= {"without_equilibrium": "proportional", "algorithm": algorithm}
        found.append(run_deck(data))
    assert (found[0]["event_point"] == found[1]["event_point"]).all()
    np.testing.assert_allclose(found[0]["event_load"], found[1]["event_load"], rtol=1e-7)
    np.testing.assert_allclose(found[0]["event_scale"], found[1]["event_scale"], rtol=1e-7)


def test_residual_of_the_prestressed_beam_is_the_couple_of_the_prestress() -> None:
    """All but the top points gone under -1 N/mm2: 5 kN x 48.3 mm = F/2 x 160 mm, F = 3.02 kN."""
    r = run_deck(beam(-1, "isotropic"))
    assert r["event_load"][-1] == pytest.approx(3.02e3, rel=0.012)


CRUSHING = {"compressive_strength": 1e6, "crushing_energy": 2e3}


@pytest.mark.parametrize(
    ("material", "analysis"),
    [
        ({}, {"mesh": {"size": 0.1}}),
        ({}, {"mesh": {"size": 0.12, "element": "T3", "pattern": "random"}}),
        ({}, {"mesh": {"size": 0.2, "element": "T6"}}),
        ({}, {"mesh": {"size": 0.2, "element": "Q8"}}),
        ({}, {"mesh": {"size": 0.1, "selective": True}}),
        ({}, {"mesh": {"size": 0.1}, "cracking": "orthotropic"}),
        ({}, {"mesh": {"size": 0.1}, "cracking": "isotropic"}),
        ({}, {"mesh": {"size": 0.1}, "crack_closure": True, "target_displacement": 0.1}),
        (CRUSHING, {"mesh": {"size": 0.1}}),
        (CRUSHING | {"lateral_reduction": True}, {"mesh": {"size": 0.1}}),
        (CRUSHING | {"confinement": 4.0}, {"mesh": {"size": 0.1}}),
        (CRUSHING | {"compressive_strength_parallel": 0.9 * CRUSHING["compressive_strength"]}, {"mesh": {"size": 0.15}}),
        ({"tensile_strength_parallel": 0.4e6, "shear_strength": 0.15e6, "bed_angle": 10.0}, {"mesh": {"size": 0.1}}),
        (
            {},
            {
                "mesh": {"size": 0.1},
                "reference": [{"kind": "displacement", "direction": "x", "parts": [{"edge": "top"}, {"y": 1.5, "ratio": 0.6}]}],
            },
        ),
        ({}, {"mesh": {"size": 0.1}, "control": [{"x": 3.0, "y": 3.0}, {"x": 3.0, "y": 1.5, "direction": "y"}]}),
    ],
)
@pytest.mark.parametrize("events", [60, pytest.param(400, marks=pytest.mark.verify)])
def test_a_skipped_region_holds_no_event(material, analysis, events) -> None:
    """A changed factor and the regions that an event concerns give the events of a new factor and of all points, also without equilibrium."""
    found = []
    for algorithm in ("update", "refactor"):
        data = wall(**{"without_equilibrium": "load-unload", **analysis, "events": events, "algorithm": algorithm})
        data["material"] |= material
        found.append(curves(data)[1][0].events)
    update, refactor = found
    assert len(update) == len(refactor) >= min(events, 300)
    for name in ("point", "code", "equilibrium"):
        assert (getattr(update, name) == getattr(refactor, name)).all()
    for name in ("load", "limit_t", "monitors", "stored", "lost", "crack"):
        np.testing.assert_allclose(getattr(update, name), getattr(refactor, name), rtol=1e-9, err_msg=name)
    assert update.ledger_error < 1e-11


def test_threads_do_not_change_a_bit() -> None:
    deck = make_deck(wall(0.05))
    model = build(Context(deck).building.mesh(deck.analyses[0].mesh), deck.analyses[0])
    found = []
    for threads in (1, 2, 3):
        with Model(model.mesh.xy, model.freedoms, model.groups, threads=threads) as core:
            core.loads(model.constant, model.reference)
            found.append(core.run(120, [model.control]))
    for other in found[1:]:
        for name in ("load", "limit_c", "stored", "lost", "crack", "point"):
            assert getattr(found[0], name).tobytes() == getattr(other, name).tobytes()


def test_a_turned_wall_cracks_alike() -> None:
    """The whole problem turned by 31 degrees: the same events at the same loads."""
    deck = make_deck(wall())
    model = build(Context(deck).building.mesh(deck.analyses[0].mesh), deck.analyses[0])
    found = []
    for angle in (0.0, np.radians(31.0)):
        turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
        with Model(model.mesh.xy @ turn, model.freedoms, model.groups) as core:
            core.loads(model.constant @ turn, model.reference @ turn)
            found.append(core.run(200, [model.control]))
    np.testing.assert_allclose(found[1].load, found[0].load, rtol=1e-9)
    assert (found[1].point == found[0].point).all()


def test_ties_go_to_the_first_point() -> None:
    """Two equal bars in series reach their strength together: the first one cracks and softens to its end; what
    it leaves (a millionth) then carries the second to its own."""
    from extrados.core.sla import Bars, Freedoms, Softening

    xy = np.array([[0.0, 0.0], [0.5, 0.0], [1.0, 0.0]])
    bars = Bars(np.array([[0, 1], [1, 2]]), 0.02, 5.3e9, 0.25, Softening(1.7e6, 130.0))
    force = np.array([[0.0, 0.0], [0.0, 0.0], [1.0, 0.0]])
    with Model(xy, Freedoms.make(3, [(0, 0), (0, 1), (1, 1), (2, 1)]), [bars]) as core:
        core.loads(np.zeros((3, 2)), force)
        events = core.run(100, [Monitor.of(2, 0)])
    half = len(events) // 2
    assert half > 5
    assert events.point.tolist() == [0] * half + [1] * half


@pytest.mark.parametrize("order", ["as they stand", "backwards", "shuffled"])
def test_ties_between_regions_and_groups_go_to_the_first_point(order: str) -> None:
    """A long chain of equal bars, every second one in another group, which all reach their strength together: the first
    bar of the first group goes, wherever it is, then softens alone."""
    from extrados.core.sla import Bars, Freedoms, Softening, teeth

    n, law = 900, Softening(1.7e6, 130.0)
    xy = np.column_stack([np.arange(n + 1.0), np.zeros(n + 1)])
    number = {"as they stand": np.arange(n), "backwards": np.arange(n)[::-1], "shuffled": np.random.default_rng(5).permutation(n)}[order]
    bars = [Bars(np.column_stack([at, at + 1]), 0.02, 5.3e9, 0.25, law) for at in (number[::2], number[1::2])]
    force = np.zeros((n + 1, 2))
    force[-1, 0] = 1.0
    freedoms = Freedoms.make(n + 1, [(0, 0), *((i, 1) for i in range(n + 1))])
    with Model(xy, freedoms, bars, ordering="metis") as core:
        core.loads(np.zeros((n + 1, 2)), force)
        events = core.run(4, [Monitor.of(n, 0)])
    assert events.point.tolist() == [0] * 4
    assert events.load == pytest.approx(0.02 * teeth(law, 5.3e9, 0.25)[1][:4], rel=1e-9)


def test_a_point_that_no_multiplier_relieves_goes_first() -> None:
    """Not in the thesis: A overloads a bar that B does not touch; it is damaged, without equilibrium, before B acts."""
    from extrados.core.sla import Bars, Freedoms, Softening

    xy = np.array([[0.0, 0.0], [0.5, 0.0], [0.5, 0.7]])
    law, area, young = Softening(1.7e6, 130.0), 0.02, 5.3e9
    bars = Bars(np.array([[0, 1], [1, 2]]), area, young, 0.25, law)
    freedoms = Freedoms.make(3, [(0, 0), (0, 1), (2, 0), (2, 1)])
    along, across = np.zeros((3, 2)), np.zeros((3, 2))
    along[1, 0], across[1, 1] = 1.4 * 1.7e6 * area, -1.0
    with Model(xy, freedoms, [bars]) as core:
        core.loads(along, across)
        events = core.run(100, [Monitor.of(1, 1)])
        core.set_damage(np.zeros((11, 2)) + np.array([[0, 0, 0, 1, 0, 1, 0, 0, 0, 0, 0]]).T)
        core.loads(along, across)
        with pytest.raises(CoreError, match="constant loads alone exceed"):
            core.run(100, [Monitor.of(1, 1)], Stop(refuse_overload=True))
    teeth_of_one = int((events.point == 0).sum())
    assert teeth_of_one > 5
    assert (events.point[:teeth_of_one] == 0).all()
    assert not events.equilibrium[:teeth_of_one].any()
    assert events.equilibrium[teeth_of_one:].all()
    assert events.load[teeth_of_one] == pytest.approx(events.load[teeth_of_one:].max())
    assert events.load[teeth_of_one] / area > 1.7e6


def test_batches_do_not_matter() -> None:
    deck = make_deck(wall())
    model = build(Context(deck).building.mesh(deck.analyses[0].mesh), deck.analyses[0])
    loads = []
    for room in (7, 210):
        with Model(model.mesh.xy, model.freedoms, model.groups) as core:
            core.loads(model.constant, model.reference)
            loads.append(np.concatenate([core.run(room, [model.control]).load for _ in range(210 // room)]))
    assert loads[0].tobytes() == loads[1].tobytes()


def test_many_events_keep_the_residual_small() -> None:
    """Downdates alone for 3000 events: the guard never asks for more."""
    _, (curve,) = curves(wall(0.1, events=3000, **EVENTS_ALONE))
    assert curve.events.guard[0] == 5
    assert curve.events.guard[1:] == (0, 0)
    assert 0.0 < curve.events.residual[-1] < 1e-9


def test_the_residual_is_measured_in_short_runs_too() -> None:
    """60 events are fewer than the guard waits for."""
    r = run_deck(wall(events=60)).results
    assert r["guard_checks"] == 0
    assert 0.0 < r["residual_ratio"] < 1e-9


def test_going_on_from_a_stored_event() -> None:
    _, (whole,) = curves(wall(events=260, cracking="orthotropic"))
    event = 140
    damage = damage_before(whole.damage_start, whole.damage_end, whole.events.point[: event - 1], whole.events.code[: event - 1])
    deck = make_deck(wall(events=120, cracking="orthotropic"))
    model = build(Context(deck).building.mesh(deck.analyses[0].mesh), deck.analyses[0])
    (rest,) = run_curves(model, deck.analyses[0], 1, lambda *_: None, damage)
    np.testing.assert_allclose(rest.events.load, whole.events.load[event - 1 : event + 119], rtol=1e-9)


def test_both_senses_of_a_symmetric_wall_agree() -> None:
    """From the same start: the '+' run leaves nothing behind."""
    _, (plus, minus) = curves(wall(directions=["+", "-"], events=60))
    assert minus.events.load[0] == pytest.approx(plus.events.load[0], rel=1e-9)
    assert minus.events.monitors[0, 0] == pytest.approx(plus.events.monitors[0, 0], rel=1e-9)
    assert minus.events.load.max() == pytest.approx(plus.events.load.max(), rel=0.01)


def test_the_order_of_the_senses_does_not_matter() -> None:
    found = [run_deck(wall(directions=order, events=25)).results for order in (["+", "-"], ["-", "+"])]
    assert found[1]["sense"] == "+"
    assert found[1]["minus"]["sense"] == "-"
    assert found[0]["first_event_load_N"] == found[1]["first_event_load_N"]


def test_constant_loads_with_damage() -> None:
    """A lintel too heavy for the strength: A cracks it on the way from 0 to 1, B starts from there."""
    data = wall(events=900, **EVENTS_ALONE)
    data["material"]["density"] = 26000.0
    _, (curve,) = curves(data)
    stage = curve.stage_a
    assert stage.reason == "target load"
    assert len(stage) > 3
    assert (stage.load[:-1] < 1.0).any()
    assert stage.load[-1] == 1.0
    # the ledger goes through both stages
    assert curve.events.external[0] > stage.external[-1]
    assert curve.events.ledger_error < 1e-11


def test_constant_loads_beyond_strength_leave_the_outcome_open() -> None:
    data = wall(constant_damage=False)
    data["analysis"][0]["constant"] = [{"kind": "line", "edge": "left", "py": "5 MN/m"}, {"kind": "line", "edge": "right", "py": "-5 MN/m"}]
    result = run_deck(data)
    assert (result.status, "constant loads alone exceed the strength" in result.reason) == ("refused", True)
    data = wall()
    data["analysis"][0]["constant"] = [{"kind": "spread", "edge": "top", "fx": "900 kN"}]
    result = run_deck(data)
    verdict = result.results.judged(Demanded(0.2, "", 0.0, 0.0))
    assert (result.status, verdict.outcome, verdict.bound, verdict.capacity) == ("ok", "open", "lower", 0.0)
    assert not result.results.proven and "cannot carry the constant loads: with damage, it carries at most" in verdict.statement


def test_prescribed_displacement_with_ratios() -> None:
    """Roof and floor moved together, the floor by 0.8: the load that comes out is their common reaction."""
    data = wall(events=5, constant=[])
    data["analysis"][0]["reference"] = [
        {"kind": "displacement", "direction": "x", "parts": [{"edge": "top"}, {"edge": "left", "y": [1.5, 1.5], "ratio": 0.8}]}
    ]
    result = run_deck(data)
    u = result["state_displacement"][-1]
    xy = result["node"]
    top, floor = np.abs(xy[:, 1] - 3.0) < 1e-9, (np.abs(xy[:, 1] - 1.5) < 1e-9) & (xy[:, 0] < 1e-9)
    assert np.ptp(u[top, 0]) == 0.0
    assert u[floor, 0] == pytest.approx(0.8 * u[top, 0][0], rel=1e-12)
    # work: the unit force acts on the common displacement
    # the load does its work on the common displacement
    assert result["event_external"][0] == pytest.approx(0.5 * result["event_load"][0] * u_first(result), rel=1e-9)


def test_displacement_with_a_part_held_back() -> None:
    """A part with ratio 0 stays where it is, wherever it stands in the list."""
    held = {"edge": "left", "y": [1.5, 1.5], "ratio": 0}
    found = []
    for parts in ([held, {"edge": "top"}], [{"edge": "top"}, held]):
        reference = [{"kind": "displacement", "direction": "x", "parts": parts}]
        result = run_deck(wall(events=5, constant=[], reference=reference))
        found.append(result.results["greatest_load_N"])
        xy, u = result["node"], result["state_displacement"][-1]
        assert (u[(np.abs(xy[:, 1] - 1.5) < 1e-9) & (xy[:, 0] < 1e-9), 0] == 0.0).all()
    assert found[0] == pytest.approx(found[1], rel=1e-9)
    reference[0]["parts"] = [held]
    assert "every `ratio` is 0" in run_deck(wall(constant=[], reference=reference)).reason


@pytest.mark.parametrize("element", ["T3", "Q4", "T6", "Q8"])
def test_loads_between_mesh_lines(element) -> None:
    """A pressure and a line load over a part of the top that no mesh line bounds: their force and its moment."""
    from extrados.analyses.sla.model import nodal_forces

    place = {"edge": "top", "x": [0.37, 1.21]}
    data = wall(0.3, constant=[{"kind": "pressure", "value": 5e4, **place}, {"kind": "line", "px": 700.0, **place}])
    data["analysis"][0]["mesh"]["element"] = element
    deck = make_deck(data)
    mesh = Context(deck).building.mesh(deck.analyses[0].mesh)
    force = nodal_forces(mesh, deck.analyses[0].constant, "constant")
    down, along = -5e4 * 0.2 * 0.84, 700.0 * 0.84
    np.testing.assert_allclose(force.sum(axis=0), [along, down], rtol=1e-12)
    moment = (mesh.xy[:, 0] * force[:, 1]).sum()
    assert moment == pytest.approx(down * 0.79, rel=1e-12)
    deck = make_deck(wall(0.3, constant=[{"kind": "spread", "fx": 1e3, **place}]))
    spread = nodal_forces(Context(deck).building.mesh(deck.analyses[0].mesh), deck.analyses[0].constant, "constant")
    assert spread[:, 0].sum() == pytest.approx(1e3, rel=1e-12)


def u_first(result) -> float:
    """Control displacement at the first event."""
    return float(result["event_displacement"][0])


@pytest.mark.parametrize(
    ("stop", "reason"),
    [
        ({"target_displacement": "0.2 mm"}, "target displacement"),
        ({"events": 40}, "number of events"),
        ({"stop_fraction": 0.97, "events": 4000}, "load fell below the fraction of its peak"),
        ({"mechanism_ratio": 10, "events": 9000, **EVENTS_ALONE}, "mechanism"),
    ],
)
def test_stops_are_named(stop, reason) -> None:
    assert run_deck(wall(**stop)).results["stop"] == reason


def bad(path: str, value) -> dict:
    data = wall()
    place = data
    *way, last = path.split(".")
    for part in way:
        place = place[int(part)] if part.isdigit() else place[part]
    place[last] = value
    return data


@pytest.mark.parametrize(
    ("path", "value", "says"),
    [
        ("supports.held", [{"x": 0.0, "y": 0.0}], "is a mechanism: node"),
        ("material.fracture_energy", 0.004, "the softening law snaps back"),
        ("analysis.0.reference", [{"kind": "line", "x": [0.07, 0.08], "y": [0.01, 0.02], "px": 1.0}], "Add a mesh line there"),
        ("structure.openings", [{"x": [-1, 4], "y": [-1, 4]}], "leaves|no elements|nothing"),
        ("structure.ties", [{"edge": "bottom", "direction": "x"}], "is both restrained and tied in x"),
        ("analysis.0.reference", [{"kind": "point", "edge": "bottom", "fx": "1 kN"}], "acts only on nodes that are restrained"),
        ("analysis.0.reference", [{"kind": "point", "edge": "top", "fx": 0.0}], "reference load is zero"),
        ("analysis.0.mesh.size", "0.5 mm", "use larger elements"),
        ("material.density", 0.0, "give the material a density"),
        ("analysis.0.constant", [{"kind": "pressure", "edge": "top", "x": [2, 4], "value": 1e5}], "extends beyond the wall"),
        ("analysis.0.section_x", [3.2], r"section_x\[0\] is 3.2 m, but the wall extends from 0 to 3 m"),
    ],
)
def test_refusals(path, value, says) -> None:
    import re

    result = run_deck(bad(path, value))
    assert result.status == "refused", result
    assert re.search(says, result.reason)


@pytest.mark.parametrize(
    ("path", "value", "says"),
    [
        ("structure.regions", [{"x": [0, 1], "material": "steel"}], "material 'steel' does not exist"),
        ("analysis.0.mesh.pattern", "random", 'give "T3" or "T6"'),
        ("structure.openings", [{"x": [5, 6], "y": [0, 1]}], "is outside the wall"),
        ("structure.openings", [{"x": [1, 1], "y": [0, 1]}], "requires a width and a height"),
        ("analysis.0.reference", [{"kind": "spread", "fx": 1.0}], "the place of the spread load is missing"),
        ("analysis.0.reference", [{"kind": "gravity", "fx": 1.0}], "gravity takes ax, ay, not fx"),
        ("analysis.0.reference", [], "at least 1, found 0"),
        ("material", {"young": 1e9, "tensile_strength": 1e5}, "require each other"),
        ("material", {"young": 1e9, "tensile_strenght": 1e5}, "did you mean 'tensile_strength'?"),
        ("supports.held", [{"fix": "x"}], "the place is missing"),
        ("supports.held", [{"x": "1,5 m", "y": 0}], "the decimal sign is a point"),
        ("supports.held", [{"x": [2, 1], "y": 0}], "the range goes from"),
        ("analysis.0.directions", ["+", "+"], "each sense may occur only once"),
        ("analysis.0.control", [{"edge": "top", "weight": 0}], "a term with weight 0 has no effect"),
        ("analysis.0.seeds", [3, 3], "a seed occurs twice"),
        ("analysis.0.states", [0], "greater than or equal to 1"),
    ],
)
def test_deck_complaints(path, value, says) -> None:
    with pytest.raises(DeckError) as error:
        make_deck(bad(path, value))
    assert says in str(error.value)


def test_a_load_that_still_rises_has_no_peak() -> None:
    """The same wall: stopped on its way up, and once its load has fallen."""
    rising, whole = run_deck(wall(events=60)), run_deck(wall(events=6000, stop_fraction=0.8))
    assert rising.results["peak_load_N"] is None and "bilinear" not in rising.results
    assert rising.results["greatest_load_N"] > 0.0
    assert "without having passed a peak" in rising.answer
    assert any("ended before the load decreased" in text for text in rising.warnings)
    assert rising.verdict.capacity is None and "not known" in rising.verdict.statement
    assert whole.results["peak_load_N"] == whole.results["greatest_load_N"] > 1.2 * rising.results["greatest_load_N"]
    assert "has its peak at" in whole.answer and whole.results["bilinear"]["ductility"] > 1.0
    assert not any("peak" in text for text in whole.warnings)
    assert whole.verdict.capacity == whole.results["peak_load_N"]


def test_the_floor_of_the_stiffness_is_no_peak() -> None:
    """What a millionth of the stiffness carries far out is no capacity, however late the run is told to end."""
    early, late = (run_deck(wall(0.3, events=4000, mechanism_ratio=ratio, **EVENTS_ALONE)) for ratio in (1e4, 1e5))
    assert late.results["events"] > early.results["events"]
    reached = early["event_displacement"].max()
    assert late["envelope_displacement"].max() <= reached < late["event_displacement"].max()
    assert late.results["greatest_load_N"] == early.results["greatest_load_N"]
    assert late["envelope_load"].max() == late.results["peak_load_N"]


def test_envelope_and_bilinear() -> None:
    """A saw-toothed elastic-plastic curve with a snap-back: the envelope keeps its upper side."""
    d = np.array([1.0, 1.7, 1.4, 2.9, 4.1])
    p = np.array([10.0, 9.0, 11.0, 10.5, 7.7])
    x, y = envelope(d, p)
    assert y.max() == 11.0
    assert np.interp(1.4, x, y) == pytest.approx(11.0)
    assert np.interp(0.5, x, y) == pytest.approx(5.0, rel=0.02)
    idea = bilinear(np.array([0.0, 1.3, 5.2]), np.array([0.0, 13.0, 13.0]))
    assert idea.stiffness == pytest.approx(10.0)
    assert idea.yield_load == pytest.approx(13.0)
    assert idea.ductility == pytest.approx(4.0)


def test_the_envelope_begins_at_the_constant_loads() -> None:
    """A constant push of 12 kN moves the top; the curve of the further push, straight up to its first event, starts there."""
    push = [{"kind": "spread", "edge": "top", "fx": "12 kN"}]
    found = [run_deck(wall(events=1, constant=constant)) for constant in ([], push)]
    plain, pushed = (f.results for f in found)
    assert plain["displacement_of_constant_loads_m"] == 0.0
    start = pushed["displacement_of_constant_loads_m"]
    assert start == pytest.approx(12e3 / plain["initial_stiffness_N_m"], rel=1e-9)
    assert found[1]["envelope_displacement"][0] == pytest.approx(start, rel=1e-12)
    assert found[1]["envelope_load"][0] == 0.0
    way, load = found[1]["envelope_displacement"], found[1]["envelope_load"]
    assert load[-1] / (way[-1] - way[0]) == pytest.approx(plain["initial_stiffness_N_m"], rel=1e-6)
    name = "greatest_load_displacement_m"
    assert pushed[name] == pytest.approx(plain[name], rel=1e-6)


def test_monitor_and_behaviour_defaults() -> None:
    assert Behaviour().floor == 1e-6
    assert Stop().fraction < 0
    assert Monitor.of(3, 1).share[0] == 1.0
    assert issubclass(Refused, Exception)


@pytest.mark.parametrize("constant", [True, False])
def test_forces_set_free_keep_the_energy_under_loads_that_are_forces(constant) -> None:
    """Under a push that is a force, with and without constant loads, its work on the ways of release is in the balance."""
    released = run_deck(wall(0.3, without_equilibrium="force-release", **({} if constant else {"constant": []})))
    assert (released["event_equilibrium"] == 0).sum() > 100
    assert released.results["energy_residual_ratio"] < 1e-12
    assert released["event_dissipated"][-1] > released["event_crack"][-1] > 0.0
    assert (np.diff(released["event_dissipated"]) >= 0.0).all()
