"""assess: every strategy by its own driver, one table, and reasons that speak only where their numbers show it."""

import json
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from test_every_strategy import quick_save

import extrados
from extrados.analyses.assess import budget, closer, driver, hazard, reasons, sensitivity, strategies, work
from extrados.analyses.assess.budget import OutOfTime
from extrados.analyses.assess.facts import Facts
from extrados.analyses.assess.tables import Assess
from extrados.analyses.assess.words import conclusion, table_of
from extrados.analyses.changes import read_table
from extrados.analyses.context import Context
from extrados.analyses.dem import perturbed
from extrados.analyses.dem.perturbed import chaos_of
from extrados.core.calls import within
from extrados.decks.reader import make_deck
from extrados.motions import pulses
from extrados.motions.tables import Compatible, Record, SinePulse
from extrados.results.assess import StrategyVerdict
from extrados.results.model import Result
from extrados.running.run import Run, compute
from extrados.schema.constants import GRAVITY
from extrados.show import report, style
from extrados.show.building import draw_building
from extrados.views.building import Building

COLUMN = {"kind": "column", "width": 1.2, "height": 6.0, "drums": 3}
PULSE = {"kind": "sine-pulse", "amplitude": "0.3 g", "period": 0.6}
TIE = {"start": [-0.6, 5.0], "ground": [-4.6, 5.0], "stiffness": "8 MN/m", "yield_force": "6 kN"}
HINGE = {"joints": ["ground"], "damping": "20 kN*m*s"}


def deck(**more) -> dict:
    keys = {"kind": "assess", "budget": 5, **more.pop("assess", {})}
    return {"structure": COLUMN, "motion": PULSE, **more, "analysis": [keys]}


@pytest.fixture(scope="module", autouse=True)
def patient() -> Iterator[None]:
    """On a busy machine the clock would stop what is looked for here."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(budget, "STOPPED_AFTER", 1e6)
        yield


@pytest.fixture(scope="module")
def whole() -> Run:
    return extrados.run(deck())


def test_parts_are_what_the_analyses_give_by_themselves(whole: Run) -> None:
    r = whole["assess"]
    stones = [s.name for s in strategies.ALL if s.kind not in ("pushover", "frame-pushover")]
    assert [v.strategy for v in r.verdicts] == stones, "pushes are of walls on a plan"
    alone = extrados.run(
        {"structure": COLUMN, "motion": PULSE, "analysis": [{"kind": "tilt"}, {"kind": "rocking"}, {"kind": "assessment"}]}
    )
    for kind in ("tilt", "rocking", "assessment"):
        assert whole[kind].as_json() == alone[kind].as_json()
    rows = {v.strategy: v for v in r.verdicts}
    assert rows["tilt"].margin == pytest.approx(alone["tilt"].collapse_acceleration_g / 0.3)
    assert rows["tilt"].part == "tilt" and rows["probability"].part == "fragility"
    assert set(r.parts) == {a["name"] for a in whole.analyses[1:]}
    assert {p["kind"] for p in whole.summary["deck"]["resolved"]["analysis"]} >= {"assess", "tilt", "dem"}


def test_the_margin_of_rocking_encloses_the_factor_that_brings_it_down() -> None:
    block, friction = {"kind": "block", "width": 1.2, "height": 6.0}, {"friction": 0.9}
    asked = {"kind": "assess", "budget": 5, "strategies": ["rocking"]}
    (row,) = extrados.run({"structure": block, "joints": friction, "motion": PULSE, "analysis": [asked]})["assess"].verdicts
    for factor, outcome in ((row.margin_at_least, "recovery"), (row.margin_below, "collapse")):
        motion = {**PULSE, "amplitude": f"{0.3 * factor!r} g"}
        found = extrados.run({"structure": block, "joints": friction, "motion": motion, "analysis": {"kind": "rocking"}})
        assert found["rocking"].outcome == outcome
    assert row.margin_below / row.margin_at_least < 1.1


def test_the_margin_of_rocking_ends_where_hinges_form_elsewhere(whole: Run) -> None:
    """Under the scaled motion the thrust line leaves the joints between the drums: from there on no factor is known."""
    row = next(v for v in whole["assess"].verdicts if v.strategy == "rocking")
    assert row.margin_at_least is not None and row.margin_below is None


def test_a_collapse_under_the_hazard_itself_bounds_the_margin_of_rocking(monkeypatch: pytest.MonkeyPatch) -> None:
    """Where scaled motions leave the assumptions first, the run under the hazard is a factor of 1 that causes collapse."""
    for module in (driver, closer):
        monkeypatch.setattr(module, "scaled_margin", lambda found: (0.5, None))
    block, friction = {"kind": "block", "width": 0.6, "height": 6.0}, {"friction": 0.9}
    asked = {"kind": "assess", "budget": 5, "strategies": ["rocking"], "advise": False}
    motion = {**PULSE, "amplitude": "0.6 g", "period": 2.0}
    (row,) = extrados.run({"structure": block, "joints": friction, "motion": motion, "analysis": [asked]})["assess"].verdicts
    assert row.outcome == "collapses" and (row.margin_at_least, row.margin_below) == (0.5, 1.0)


def test_decks_of_the_parts_run_by_themselves(whole: Run, tmp_path: Path) -> None:
    result = whole.results[0]
    for name in ("tilt", "fragility"):
        path = tmp_path / f"{name}.toml"
        path.write_bytes(result.files[f"assess/{name}.toml"])
        again = extrados.run(path)
        assert again[again.analyses[0]["name"]].as_json() == whole[name].as_json()


def test_written_and_drawn(whole: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(style, "save", quick_save)
    whole.write(tmp_path / "out", figures=False)
    assert (tmp_path / "out" / "assess" / "dem.toml").exists()
    drawn = report.draw(Run.read(tmp_path / "out"), tmp_path)
    assert [name for name, _ in drawn["assess"]] == ["assess-margins", "assess-agreement", "assess-hazard"]
    told = json.loads((tmp_path / "out" / "summary.json").read_text())["analyses"][0]
    assert told["verdict"]["outcome"] in ("stands", "collapses", "open") and "limit analysis" in told["answer"]


def test_first_table_comes_before_the_costly_strategies(monkeypatch: pytest.MonkeyPatch) -> None:
    order: list[str] = []
    asked = work.Work.ask
    monkeypatch.setattr(work.Work, "ask", lambda going, s: (order.append(s.name), asked(going, s))[1])
    compute(Context(make_deck(deck(assess={"strategies": ["tilt", "dem"]})), tell=lambda text: order.append("table")))
    assert order == ["tilt", "table", "dem"]


def test_a_strategy_reports_what_it_neglects() -> None:
    r = extrados.run(deck(hinges=[HINGE], assess={"strategies": ["rocking", "dem"]}))["assess"]
    rows = {v.strategy: v for v in r.verdicts}
    assert "without [[hinges]]" in rows["dem"].parameters and "without" not in rows["rocking"].parameters
    assert rows["dem"].status == "ok"


def test_a_collapse_without_the_added_hinge_of_the_deck_decides_nothing() -> None:
    """Elements take no added hinge: their result for the column alone is no verdict on the column with its hinge."""
    shaken = {**PULSE, "amplitude": "1 g", "period": 1.5}
    asked = {"motion": shaken, "assess": {"strategies": ["rocking", "dem"]}}
    bare, held = (
        {v.strategy: v for v in extrados.run(deck(**asked, **more))["assess"].verdicts}["dem"] for more in ({}, {"hinges": [HINGE]})
    )
    assert bare.outcome == "collapses"
    assert held.outcome == "open" and "neglects [[hinges]]" in held.statement


def test_elements_carry_the_tie_of_the_deck() -> None:
    """With the tie the column stands under a motion that overturns it without; a rigid tie is for limit analysis alone."""
    shaken = {**PULSE, "amplitude": "0.5 g", "period": 1.0}
    asked = {"motion": shaken, "assess": {"strategies": ["tilt", "dem"]}}
    rows = [
        {v.strategy: v for v in extrados.run(deck(**asked, ties=ties))["assess"].verdicts}["dem"]
        for ties in (
            [],
            [{**TIE, "works_in": "both", "yield_force": "60 kN"}],
            [{key: value for key, value in TIE.items() if key != "stiffness"}],
        )
    ]
    assert [row.status for row in rows] == ["ok", "ok", "refused"] and "EA/L" in rows[2].reason
    assert rows[0].outcome == "collapses" and rows[1].outcome != "collapses"
    assert "without" not in rows[1].parameters


def test_a_wrong_key_of_options_refuses_the_strategy_alone() -> None:
    given = {"strategies": ["tilt", "rocking"], "options": {"tilt": {"fractured": True}}}
    r = extrados.run(deck(assess=given))["assess"]
    rows = {v.strategy: v for v in r.verdicts}
    assert rows["tilt"].status == "refused" and "fracture" in rows["tilt"].reason and rows["rocking"].status == "ok"


def test_the_clock_stops_what_takes_too_long(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(budget, "STOPPED_AFTER", 0.0)
    r = extrados.run(deck(assess={"strategies": ["tilt", "dem"], "options": {"dem": {"time_step": 1e-6}}}))["assess"]
    rows = {v.strategy: v for v in r.verdicts}
    assert rows["dem"].status == "left out" and "stopped" in rows["dem"].reason
    assert any("stopped at the time limit" in text for text in r.not_done)


def test_a_run_that_ends_while_blocks_move_is_prolonged() -> None:
    """A run cut at 1.2 s has no verdict; the assessment follows the blocks until they rest, as a long run by itself does."""
    block = {"kind": "block", "width": 0.6, "height": 2.4}
    asked = {"strategies": ["rocking", "dem"], "options": {n: {"end_time": 1.2} for n in ("rocking", "dem")}}
    shaken = {"structure": block, "joints": {"friction": 0.9}, "motion": {**PULSE, "amplitude": "0.5 g"}}
    whole = extrados.run(shaken | {"analysis": {"kind": "assess", "budget": 20, **asked}})
    short = extrados.run(shaken | {"analysis": [{"kind": n, "end_time": 1.2} for n in ("rocking", "dem")]})
    assert not short["rocking"].settled
    rows = {v.strategy: v for v in whole["assess"].verdicts}
    for name in ("rocking", "dem"):
        assert rows[name].outcome != "open" and "extended to" in rows[name].parameters, rows[name]
    assert whole["rocking"].settled and not whole["dem"].still_moving


def test_an_unexplained_contradiction_is_checked_finer(monkeypatch: pytest.MonkeyPatch) -> None:
    """Without any rule a contradiction has no reason: finer runs follow, and the statement names them."""
    monkeypatch.setattr(reasons, "RULES", ())
    r = extrados.run(deck(motion={**PULSE, "amplitude": "0.6 g"}, assess={"strategies": ["tilt", "dem"]}))["assess"]
    assert r.overall == "depends" and r.unexplained == [["tilt", "dem"]]
    changed = {p.changed for p in r.probes}
    assert {"rigid contacts", "half the time step", "the motion times 0.999", "the motion times 1.001"} <= changed
    assert (
        "Strategies that contradict each other were run again with finer settings: discrete elements with rigid contacts (" in r.statement
    )


def test_a_finer_check_with_another_outcome_opens_the_verdict(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(reasons, "RULES", ())
    probe = work.Work.probe

    def other(going, strategy, changed, kind, keys, *rest, **more):
        found = probe(going, strategy, changed, kind, keys, *rest, **more)
        if changed == "half the time step":
            assert keys["time_step"] == pytest.approx(0.5 * going.results["dem"]["time_step_s"])
            going.probes[-1] = going.probes[-1].model_copy(update={"outcome": "collapses"})
        return found

    monkeypatch.setattr(work.Work, "probe", other)
    r = extrados.run(deck(motion={**PULSE, "amplitude": "0.6 g"}, assess={"strategies": ["tilt", "dem"]}))["assess"]
    row = next(v for v in r.verdicts if v.strategy == "dem")
    assert row.outcome == "open" and row.violated == ["A finer check gives another outcome: half the time step (collapses)."]


def test_a_deadline_stops_the_core_and_leaves_no_flag() -> None:
    from extrados.core.calls import cancel_requested

    with within(0.0) as time:
        assert time.over.wait(2.0)
    assert time.passed and not cancel_requested()
    with within(60.0) as time:
        pass
    assert not time.passed


def test_the_stopwatch_leaves_out_the_time_of_others(monkeypatch: pytest.MonkeyPatch) -> None:
    """Idle, 60 s of one thread; 60 s of four threads; of a machine that gives a fifth; of a child process that is waited for."""
    now = {"clock": 5.0, "processor": 3.0}
    monkeypatch.setattr(budget.time, "monotonic", lambda: now["clock"])
    monkeypatch.setattr(budget.time, "process_time", lambda: now["processor"])
    for clock, processor, counted in ((60.0, 60.0, 60.0), (60.0, 240.0, 60.0), (60.0, 12.0, 12.0), (60.0, 0.0, 6.0)):
        now.update(clock=5.0, processor=3.0)
        watch = budget.Stopwatch()
        now.update(clock=5.0 + clock, processor=3.0 + processor)
        assert watch() == pytest.approx(counted)


def test_a_deadline_follows_its_clock() -> None:
    """A clock that stands still is never over; one that has passed is over at once."""
    with within(0.01, lambda: 0.0) as limit:
        assert not limit.over.wait(0.2)
    ticks = iter(range(100))
    with within(2.0, lambda: float(next(ticks))) as limit:
        assert limit.over.wait(5.0)


def test_elements_of_a_wall_have_a_capacity_without_a_verdict() -> None:
    """A wall that vibrates and yields is not judged by the PGA. Before its peak what it carries is a lower bound."""
    panel = {"kind": "panel", "width": 2.0, "height": 2.0, "thickness": 0.3, "unit_length": 0.5, "unit_height": 0.5}
    soft = {"density": 1900.0, "young": "2 GPa", "tensile_strength": "0.05 MPa", "fracture_energy": "10 N/m"}
    weak = {**PULSE, "amplitude": "0.02 g"}
    rows = []
    for events in (40, 20000):
        given = {"strategies": ["sla"], "options": {"sla": {"events": events, "mesh": {"size": 0.5}}}}
        (row,) = extrados.run(deck(structure=panel, material=soft, motion=weak, assess=given))["assess"].verdicts
        rows.append(row)
    begun, ended = rows
    assert begun.outcome == ended.outcome == "not-applicable"
    assert begun.bound == "lower" and "carries at least" in begun.statement and ended.bound is None
    assert ended.capacity > begun.capacity > 0.02
    for row in rows:
        assert row.margin is None and row.margin_at_least is None and "response spectrum" in row.statement


# ----- a building on a plan

HOUSE = {
    "kind": "building",
    "storeys": [2.8],
    "walls": [
        {"name": n, "start": s, "end": e, "thickness": t}
        for n, s, e, t in (
            ("front", [0, 0], [4, 0], 0.4),
            ("right", [4, 0], [4, 3], 0.2),
            ("back", [4, 3], [0, 3], 0.4),
            ("left", [0, 3], [0, 0], 0.2),
        )
    ],
}
MASONRY = {"density": 1900.0, "young": "3 GPa", "tensile_strength": "0.02 MPa", "fracture_energy": "5 N/m"}


def on_plan(**more) -> dict:
    return deck(structure=HOUSE, material=MASONRY, **more)


def test_a_building_on_a_plan_is_pushed_along_both_axes_and_its_walls_are_checked(tmp_path: Path) -> None:
    keys = {f"push-{axis}": {"events": 300, "mesh": {"size": 0.7}} for axis in "xy"}
    run = extrados.run(on_plan(assess={"options": keys, "sensitivity": True}))
    r = run["assess"]
    assert [v.strategy for v in r.verdicts] == ["code-checks", "frame", "push-x", "push-y"]
    assert [v.status for v in r.verdicts] == ["ok"] * 4 and r.verdicts[3].part == "pushover-2"
    assert run["pushover"].direction_deg == 0.0 and run["pushover-2"].direction_deg == 90.0
    assert run["local-mechanism"].walls[0].wall in ("left", "right"), "the thin ones"
    assert any("building in plan" in text for text in r.not_done)
    assert run["pushover"].peak_load_N is None, "300 events are few"
    told = next(one for one in r.reasons if one.rule == "frame-and-shells")
    assert ["frame", "push-x"] in told.explains and "kN" in told.text
    assert told.numbers["frame_x_N"] == pytest.approx(
        min(
            row.peak_base_shear_N
            for row in run["frame-pushover"].runs
            if row.direction_deg == 0.0 and row.pattern == "uniform" and not row.eccentricity
        )
    )
    assert told.numbers["shells_x_N"] == min(c.greatest_load_N for c in (run["pushover"], run["pushover"].minus))
    for push in r.verdicts[1:]:
        assert push.outcome == "not-applicable" and push.demand is None and push.capacity > 0.0
        assert push.margin is None and push.margin_at_least is None
    assert (
        "Capacity without a verdict: equivalent frame " in r.statement
        and "push along x at " in r.statement
        and r.overall != "stands under all"
    )
    run.write(tmp_path / "out", figures=False)
    (saved, caption), (elevations, _) = draw_building(Run.read(tmp_path / "out"), _figures(tmp_path))
    assert (saved, elevations) == ("building", "building-elevation") and "Storey: 2.80 m" in caption


def test_where_only_pushes_have_a_result_the_outcome_is_open() -> None:
    keys = {f"push-{axis}": {"events": 100, "mesh": {"size": 0.7}} for axis in "xy"}
    r = extrados.run(on_plan(assess={"strategies": ["push-x", "push-y"], "options": keys}))["assess"]
    assert r.overall == "open" and r.least_margin is None and not r.agreement
    assert "No strategy has a verdict" in r.statement and "push along y at least" in r.statement


def _figures(folder: Path) -> Path:
    (folder / "figures").mkdir()
    return folder


def test_a_set_of_motions_on_a_plan_takes_the_first() -> None:
    motion = {"kind": "generated", "mmi": 7, "duration": 2.0}
    r = extrados.run(on_plan(motion=motion, assess={"strategies": ["code-checks"], "motions": 3}))["assess"]
    assert r.hazard.member == 1 and "does not rock" in r.hazard.chosen_by


def test_a_strategy_that_a_deck_names_and_that_cannot_look_is_reported() -> None:
    r = extrados.run(on_plan(assess={"strategies": ["code-checks", "dem"]}))["assess"]
    assert [(v.strategy, v.status) for v in r.verdicts] == [("code-checks", "ok"), ("dem", "left out")]
    assert "cannot analyse a structure of kind 'building'" in r.verdicts[1].reason
    assert "dem" in [v.strategy for v in extrados.run(deck(assess={"strategies": ["tilt", "push-x", "dem"]}))["assess"].verdicts]


def test_walls_that_cannot_crack_are_not_pushed() -> None:
    given = deck(structure=HOUSE, assess={"strategies": ["push-x"]})
    (row,) = extrados.run(given)["assess"].verdicts
    assert row.status == "left out" and "tensile_strength" in row.reason


# ----- the hazard


def test_of_a_set_the_84_percent_motion_is_taken() -> None:
    motion = {"kind": "generated", "mmi": 9, "duration": 4.0}
    given = {"strategies": ["rocking", "probability"], "motions": 12}
    run = extrados.run(deck(motion=motion, assess=given))
    r = run["assess"]
    table = run.results[0].parts[0].tables["ensemble"].columns
    ratio = np.asarray(table["peak_ratio"], dtype=float)[np.isclose(table["level"], 1.0)]
    assert len(ratio) == 12
    mine = ratio[r.hazard.member - 1]
    assert (ratio <= mine).sum() >= 0.84 * 12 and (ratio < mine).sum() <= 0.84 * 12
    assert r.verdicts[0].strategy == "probability" and "12 motions" in r.verdicts[0].parameters


def test_a_suite_of_records_is_a_hazard(tmp_path: Path) -> None:
    """All records are rocked first; strategies of one motion take the one that turns it farther than 84 % of the others."""
    time = np.arange(0.0, 4.0, 0.01)
    for k, (peak, period) in enumerate(((1.5, 0.5), (3.5, 0.7), (5.0, 0.9), (2.5, 0.6))):
        np.savetxt(tmp_path / f"r{k}.csv", peak * np.sin(2.0 * np.pi * time / period) * (time < period), header="acceleration")
    motion = {"kind": "suite", "pattern": "r*.csv", "unit": "m/s^2", "time_step": 0.01}
    given = {"strategies": ["tilt", "rocking", "code-checks", "probability"], "budget": 5}
    run = extrados.run(make_deck({"structure": COLUMN, "motion": motion, "analysis": {"kind": "assess", **given}}, tmp_path))
    r = run["assess"]
    assert (r.hazard.motions, r.hazard.member) == (4, 3)
    assert r.hazard.peak_ground_acceleration_g == pytest.approx(5.0 / GRAVITY, rel=0.01), "of the record that single runs take"
    rows = {v.strategy: v for v in r.verdicts}
    assert rows["probability"].demand == 0.25, "one of four"
    assert rows["tilt"].demand == pytest.approx(5.0 / GRAVITY, rel=0.01) and rows["rocking"].outcome == "collapses"
    assert run["rocking"].outcome == "collapse" and run["rocking"].hand_over is not None, "drums part"
    alone = extrados.run(make_deck({"structure": COLUMN, "motion": {**motion, "member": 3}, "analysis": {"kind": "rocking"}}, tmp_path))
    assert run["rocking"].as_json() == alone["rocking"].as_json()


def test_the_code_spectrum_gives_the_peak() -> None:
    motion = Compatible(kind="compatible", code="EN1998-1", ground="B", acceleration="0.25 g")
    context = Context(replace(make_deck(deck()), motion=motion))
    peak, told = hazard.peak_of(context)
    assert peak == pytest.approx(0.3, rel=1e-12) and "a_g S" in told


def test_motions_scaled() -> None:
    record = {"kind": "record", "file": "extrados:el-centro-1940", "scale": 1.5}
    assert hazard.scaled(record, Record(**record), 2.0)["scale"] == 3.0
    sine = {"kind": "sine-pulse", "amplitude": "0.3 g", "period": 0.6}
    again = SinePulse(**hazard.scaled(sine, SinePulse(**sine), 2.0))
    assert again.amplitude == pytest.approx(0.6 * GRAVITY)
    ntc = {"kind": "compatible", "code": "NTC", "ground": "B", "acceleration": "0.2 g"}
    assert hazard.scaled(ntc, Compatible(**ntc), 2.0) is None


def test_excursions_above_a_level() -> None:
    count, longest = hazard.above(pulses.sine_pulse(0.4 * GRAVITY, 1.2), 0.2)
    assert count == 2 and longest == pytest.approx(1.2 / 3.0, abs=0.01)  # above a half from T/12 to 5 T/12
    assert hazard.above(pulses.sine_pulse(0.4 * GRAVITY, 1.2), 0.5) == (0, 0.0)


def test_codes_use_the_spectrum_of_the_motion_and_the_restraints() -> None:
    """Without a code's spectrum that of the motion; a block that ties hold goes by its local mechanism, which knows them."""
    run = extrados.run(deck(ties=[TIE], assess={"strategies": ["code-checks"]}))
    checks = run["local-mechanism"].checks
    assert checks["NTC linear (at the ground)"].demand == pytest.approx(0.3, rel=1e-3) and checks["NTC nonlinear"].demand is not None
    (row,) = run["assess"].verdicts
    assert row.outcome in ("stands", "collapses") and "without" not in row.parameters and "motion itself" in row.parameters
    free = extrados.run(deck(assess={"strategies": ["code-checks"]}))
    assert free["code-checks"].checks["NTC nonlinear"].demand is not None
    assert free["assess"].verdicts[0].outcome in ("stands", "collapses")


# ----- the table and the statement (the rules: test_reasons.py)


def verdict(strategy: str, outcome: str, capacity: float | None = None, demand: float | None = None, **more) -> StrategyVerdict:
    keys = {
        "label": strategy,
        "part": None,
        "status": "ok",
        "reason": "",
        "axis": "acceleration",
        "unit": "g",
        "margin": None,
        "margin_at_least": None,
        "margin_below": None,
        "parameters": "",
        "assumes": "",
        "statement": "",
        "bound": None,
        "violated": [],
    }
    return StrategyVerdict(strategy=strategy, outcome=outcome, capacity=capacity, demand=demand, **(keys | more))


def facts(rows: list[StrategyVerdict]) -> Facts:
    return Facts(Building(None), pulses.sine_pulse(0.4 * GRAVITY, 1.2), 0.4, {r.strategy: r for r in rows}, {}, 1.5)


def test_relations_and_overall_statement() -> None:
    far = [verdict("tilt", "stands", 0.5, 0.4, margin=1.25), verdict("dem", "stands", margin_at_least=2.0)]
    f = facts(far)
    assert f.relation("tilt", "dem") == "apart"
    near = facts([far[0], verdict("dem", "stands", margin_at_least=1.5)])
    assert near.relation("tilt", "dem") == "agree"
    overall, words = conclusion(f, [], [("tilt", "dem")], "block", (1.25, "tilt"), far)
    assert overall == "stands under all" and "1.25" in words
    split = facts([verdict("tilt", "collapses"), verdict("dem", "stands")])
    overall, words = conclusion(split, [], [("tilt", "dem")], "block", (None, None), list(split.rows.values()))
    assert overall == "depends" and "Unexplained differences" in words
    assert far[1].margin_told() == "above 2" and "tilt" in table_of(far)
    close = verdict("rocking", "stands", margin_at_least=1.1071, margin_below=1.1124)
    assert close.margin_told() == "1.107 to 1.112", "two factors that differ are not told as one"
    assert verdict("dem", "stands").margin_told("") == ""


def test_a_proof_of_collapse_overrules_all_else() -> None:
    rows = [verdict("tilt", "cannot-stand", 0.0, 0.4, margin=0.0, statement="Proof."), verdict("sla", "stands", 0.5, 0.4, margin=1.25)]
    found = facts(rows)
    overall, words = conclusion(found, [], found.pairs(), "arch", (0.0, "tilt"), rows)
    assert overall == "cannot stand" and "opposite result of sla is not considered" in words and "Proof." in words
    assert found.relation("tilt", "sla") == "disagree"
    assert facts([rows[0], verdict("dem", "collapses")]).relation("tilt", "dem") == "agree"
    shared = [rows[0], verdict("dem", "cannot-stand", 0.0, 0.4, margin=0.0)]
    _, words = conclusion(facts(shared), [], [], "arch", (0.0, "tilt"), shared)
    assert "tilt proves that it collapses" in words and "dem gives the same conclusion" in words and "counts only once" in words


@pytest.mark.parametrize(
    "structure",
    [
        {"kind": "arch", "radius": 10.0, "thickness": 0.5, "embrace": 180, "voussoirs": 11},
        {"kind": "blocks", "block": [{"points": [[0, 0], [1, 0], [4, 4], [3, 4]]}]},
    ],
)
def test_what_cannot_stand_is_the_answer_of_an_assessment(structure: dict) -> None:
    """A certificate of limit analysis is an answer, never "no strategy has a verdict"."""
    run = extrados.run({"structure": structure, "motion": PULSE, "analysis": {"kind": "assess", "budget": 5}})
    r = run["assess"]
    assert r.overall == "cannot stand" and r.least_margin == 0.0
    row = next(v for v in r.verdicts if v.strategy == "tilt")
    assert (row.status, row.outcome, row.margin, row.capacity) == ("ok", "cannot-stand", 0.0, 0.0)
    verdict = run.analyses[0]["verdict"]
    assert (verdict["outcome"], verdict["ratio"]) == ("cannot-stand", 0.0)
    assert not [v for v in r.verdicts if v.outcome == "stands"], [v.statement for v in r.verdicts]
    assert not [v for v in r.verdicts if v.status == "failed"], [v.reason for v in r.verdicts]


@pytest.mark.parametrize(
    "held",
    [
        {"ties": [{"start": [0.9, 2.5], "ground": [-5.0, 2.5], "yield_force": 50e3, "stiffness": 1e7}]},
        {"supports": {"abutting_wall": "right"}},
    ],
)
def test_no_proof_of_collapse_leaves_out_what_holds_the_building(held: dict) -> None:
    """A leaning block stands by its tie, 11.8 kN at rest, or by its wall: strategies asked without them prove nothing."""
    lean = {"kind": "blocks", "block": [{"name": "lean", "points": [[0, 0], [0.5, 0], [1.4, 3], [0.9, 3]]}]}
    run = extrados.run({"structure": lean, "motion": PULSE, "analysis": {"kind": "assess", "budget": 5}, **held})
    r = run["assess"]
    assert r.overall != "cannot stand" and "cannot stand" not in run.analyses[0]["answer"]
    open_rows = [v for v in r.verdicts if v.outcome == "open"]
    assert not [v.strategy for v in r.verdicts if v.outcome == "cannot-stand"] and open_rows
    told = "the restraints of the deck" if "ties" in held else "the abutting wall"
    assert all(told in v.statement and v.margin is None for v in open_rows if v.capacity == 0.0)


def test_a_strategy_that_fails_leaves_the_others(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever a strategy, a rule or a closer look raises, the table stays."""

    def breaks(*_: object) -> None:
        raise ZeroDivisionError("planted")

    monkeypatch.setattr(strategies, "ALL", tuple(replace(s, choose=breaks) if s.name == "sla" else s for s in strategies.ALL))
    monkeypatch.setattr(driver, "refine", breaks)
    monkeypatch.setattr(reasons, "RULES", (breaks, *reasons.RULES))
    run = extrados.run(deck(assess={"strategies": ["tilt", "rocking", "sla"]}))
    r = run["assess"]
    rows = {v.strategy: v for v in r.verdicts}
    assert rows["sla"].status == "failed" and "planted" in rows["sla"].reason
    assert rows["tilt"].status == rows["rocking"].status == "ok" and r.overall != "open"
    assert sum("planted" in text for text in r.not_done) == 2


# ----- sensitivity


def test_a_value_turns_the_verdict_where_the_closed_form_says() -> None:
    """A block bears width over height; statics turns where that is the peak of the motion."""
    block = {"kind": "block", "width": 1.0, "height": 5.0}
    data = {"structure": block, "motion": PULSE}
    given = {"strategies": ["tilt", "rocking"], "vary": {"structure.width": 0.1, "structure.height": 0.1}}
    r = extrados.run({**data, "analysis": {"kind": "assess", "budget": 5, **given}})["assess"]
    rows = {m.key: m for m in r.sensitivity}
    width, height = rows["structure.width"], rows["structure.height"]
    assert (width.low, width.high) == (0.9, 1.1) and width.unit == "m"
    assert width.tilt_low == pytest.approx(0.9 / 5.0 / 0.3) and width.tilt_high == pytest.approx(1.1 / 5.0 / 0.3)
    assert width.tilt_turns == pytest.approx(1.5, rel=0.01) and height.tilt_turns == pytest.approx(1.0 / 0.3, rel=0.01)
    for factor, falls in ((0.97, True), (1.03, False)):
        if width.rocking_turns is None:
            break
        found = extrados.run({**data, "structure": {**block, "width": factor * width.rocking_turns}, "analysis": {"kind": "rocking"}})
        assert (found["rocking"].outcome == "collapse") == falls


def test_the_budget_holds_the_sensitivity_and_keeps_what_was_moved(monkeypatch: pytest.MonkeyPatch) -> None:
    """The deadline of the whole is the budget, that of the strategies three quarters; a stopped search leaves the ends of the tornado."""
    deadlines, asked = [], sensitivity.Margins.ask

    def ask(margins: sensitivity.Margins, wanted: list[tuple[str, float]]) -> None:
        deadlines.append(margins.asker.deadline)
        if len(deadlines) > 1:
            raise OutOfTime
        asked(margins, wanted)

    monkeypatch.setattr(sensitivity.Margins, "ask", ask)
    monkeypatch.setattr(budget, "STOPPED_AFTER", 1.0)
    block = {"kind": "block", "width": 1.0, "height": 5.0}
    given = {"strategies": ["tilt"], "vary": {"structure.width": 0.1}, "advise": False}
    run = extrados.run({"structure": block, "motion": PULSE, "analysis": {"kind": "assess", "budget": 60, **given}})["assess"]
    assert set(deadlines) == {60.0}
    assert any("sensitivity: stopped at the time limit of 60 s" in text for text in run.not_done)
    (width,) = run.sensitivity
    assert width.tilt_low == pytest.approx(0.9 / 5.0 / 0.3) and width.tilt_high == pytest.approx(1.1 / 5.0 / 0.3)
    table = read_table(Assess, {"kind": "assess", "budget": 60.0, **given})
    assert table.for_strategies == 45.0 and read_table(Assess, {"kind": "assess", "budget": 60.0}).for_strategies == 60.0


def test_what_is_moved_by_default() -> None:
    arch = make_deck(deck(structure={"kind": "arch", "radius": 1.0, "thickness": 0.2, "embrace": 150.0, "voussoirs": 9})).building
    keys = {v.key: v for v in sensitivity.varied(arch, None, 0.8)}
    assert set(keys) == {"structure.thickness", "structure.thickness_factor", "joints.friction", "joints.restitution", "material.density"}
    assert keys["joints.restitution"].base == 0.8 and keys["structure.thickness_factor"].bounded(1.1) == 1.0
    block = make_deck(deck(structure={"kind": "block", "width": 1.0, "height": 4.0})).building
    assert "structure.width" in {v.key for v in sensitivity.varied(block, None, None)}


def test_what_only_elements_know_is_tried_on_them() -> None:
    arch = {"kind": "arch", "radius": 1.0, "thickness": 0.25, "embrace": 150.0, "voussoirs": 6}
    data = deck(structure=arch, assess={"strategies": ["dem"], "vary": {"material.density": 0.1}})
    r = extrados.run(data)["assess"]
    probes = {p.changed: p for p in r.probes}
    assert {"joints 4 times as stiff", "joints 0.25 times as stiff"} <= set(probes)
    rows = {m.key: m for m in r.sensitivity}
    stiffness, support = rows["joints.normal_stiffness"], rows["initial.movements.dx"]
    assert stiffness.high == pytest.approx(4.0 * stiffness.base) and stiffness.low == pytest.approx(0.25 * stiffness.base)
    assert stiffness.dem_high == pytest.approx(probes["joints 4 times as stiff"].value)
    assert stiffness.dem_low > stiffness.dem_high and stiffness.dem_turns is None, "softer joints give more; none falls"
    assert (support.low, support.base) == (-support.high, 0.0) and support.high > 0.0
    assert support.dem_high > 2.0 * stiffness.dem_high, "it opens as its support moves"
    assert rows["material.density"].dem_base is None


def test_where_elements_turn_is_sought_between_what_stands_and_what_falls(monkeypatch: pytest.MonkeyPatch) -> None:
    """Elements that fall by decree where joints are softer than half: found by halvings of the logarithm."""
    probed = work.Work.probe

    def decreed(going: work.Work, strategy: str, changed: str, kind: str, keys: dict, *rest, **more) -> Result | None:
        found = probed(going, strategy, changed, kind, keys, *rest, **more)
        if "as stiff" in changed and float(changed.split()[1]) < 0.5:
            found = replace(found, results=found.results.model_copy(update={"outcome": "collapse"}))
        return found

    monkeypatch.setattr(work.Work, "probe", decreed)
    arch = {"kind": "arch", "radius": 1.0, "thickness": 0.25, "embrace": 150.0, "voussoirs": 6}
    r = extrados.run(deck(structure=arch, assess={"strategies": ["dem"], "vary": {"material.density": 0.1}}))["assess"]
    row = next(m for m in r.sensitivity if m.key == "joints.normal_stiffness")
    assert row.dem_turns == pytest.approx(0.5 * row.base, rel=0.1)
    assert next(m for m in r.sensitivity if m.key == "initial.movements.dx").dem_turns is None


def test_ctrl_c_keeps_what_was_asked_before(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = work.Work.ask

    def stopped(going: work.Work, strategy: strategies.Strategy) -> Result | None:
        if strategy.name == "dem":
            raise budget.Interrupted
        return asked(going, strategy)

    monkeypatch.setattr(work.Work, "ask", stopped)
    (first, *parts) = extrados.run(deck(assess={"strategies": ["tilt", "dem"]})).analyses
    assert first["status"] == "interrupted" and [p["name"] for p in parts] == ["tilt"]
    assert [v["strategy"] for v in first["results"]["verdicts"]] == ["tilt"] and first["verdict"]["outcome"] == "collapses"


def test_elements_that_a_millionth_turns_are_open(monkeypatch: pytest.MonkeyPatch) -> None:
    """A run whose perturbed run ends otherwise leaves the verdict of elements open, without runs at other factors."""
    monkeypatch.setattr(perturbed, "chaos_of", lambda other, grown, turns: chaos_of("collapse", 1e5, turns))
    r = extrados.run(deck(assess={"strategies": ["tilt", "rocking", "dem"], "budget": 20}))["assess"]
    rows = {v.strategy: v for v in r.verdicts}
    assert rows["dem"].outcome == "open" and "chaotic" in rows["dem"].statement
    (one,) = [x for x in r.reasons if x.rule == "last-digits"]
    assert one.numbers["growth"] == 1e5 and not any("times" in probe.changed for probe in r.probes)


@pytest.mark.parametrize(
    "structure",
    [
        {"kind": "stack", "lower_width": 1.0, "lower_height": 1.5, "upper_width": 0.6, "upper_height": 2.0},
        {
            "kind": "wall",
            "unit_length": 0.4,
            "unit_height": 0.2,
            "thickness": 0.2,
            "height": 0.4,
            "legs": [{"length": 0.8}, {"length": 0.8}],
        },
    ],
)
def test_what_strategies_cannot_look_at_ends_no_assessment(structure: dict) -> None:
    run = extrados.run({"structure": structure, "motion": PULSE, "analysis": [{"kind": "assess", "budget": 5}]})
    r = run["assess"]
    rows = {v.strategy: v for v in r.verdicts}
    # joints that slide leave no upper bound alone: load paths give a design value, in space too
    assert rows["tilt"].status == "ok" and rows["tilt"].outcome in ("stands", "collapses")
    assert not [v.reason for v in r.verdicts if "internal" in v.reason] + [n for n in r.not_done if "internal" in n]
