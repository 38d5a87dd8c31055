"""Discrete elements as a user asks for them: answers beside the other strategies, and refusals that name the block."""

import json
import tomllib
from pathlib import Path

import numpy as np
import pytest

import extrados
from extrados.analyses.context import Context
from extrados.analyses.dem.from_deck import make_model
from extrados.analyses.sequence import run_analyses
from extrados.decks.reader import DeckError, make_deck
from extrados.model.structures.arch import make_arch
from extrados.views.rockers.mechanism import MechanismModel

ARCH = {"kind": "arch", "radius": 10.0, "thickness": 1.5, "embrace": 157.5, "voussoirs": 7}
PULSE = {"kind": "step-pulse", "amplitude": "-1.0 g", "duration": 0.27}


def answers(deck: dict, folder: Path | None = None, **context) -> list:
    return run_analyses(Context(make_deck(deck, folder), **context))


def test_three_bars_follow_the_four_hinge_model() -> None:
    """Before the impact at 0.861 s the bars are the same mechanism: within 1 %."""
    dem = {"kind": "dem", "merge": "three-bars", "end_time": 0.84, "joints": {"friction": 2.0, "normal_stiffness": 1e12}}
    rocking, found = answers(
        {"structure": ARCH, "motion": PULSE, "analysis": [{"kind": "rocking", "end_time": 2.0, "hand_over": False}, dem]}
    )
    assert rocking["impact_times_s"][0] == pytest.approx(0.861, abs=0.002)
    exact = np.interp(found["time"], rocking["time"], rocking["rotation"].ravel())
    assert np.abs(found["rotation"][:, 0] - exact).max() < 0.01 * np.abs(exact).max()
    assert found["energy_residual_ratio"] < 0.01


def test_worn_corners_weaken() -> None:
    """The tilt capacity follows the effective width of the base: B - 2 r."""
    capacity = []
    for worn in (0.0, 0.05):
        dem = {
            "kind": "dem",
            "test": "tilt",
            "joints": {"friction": 2.0, "normal_stiffness": 1e11, "worn_corners": worn},
            "tilt_limit": "0.5 g",
            "tilt_accuracy": 0.002,
        }
        (found,) = answers({"structure": {"kind": "block", "width": 1.0, "height": 4.0}, "analysis": [dem]})
        capacity.append(found["collapse_acceleration_g"])
    assert capacity[0] == pytest.approx(0.25, rel=0.01)
    assert capacity[1] == pytest.approx(0.9 * 0.25, rel=0.02)


def test_a_support_that_settles() -> None:
    """An arch whose springing moves out hinges and stands; its support is named by a joint."""
    move = {"joint": "joint 7", "dx": 0.1, "duration": 1.0}
    dem = {"kind": "dem", "end_time": 1.5, "joints": {"normal_stiffness": 1e10}, "initial": {"movements": [move]}}
    (found,) = answers({"structure": ARCH, "analysis": [dem]})
    assert found.status == "ok" and found["outcome"] == "rocked"
    hinged = np.flatnonzero(np.abs(found["hinge"][-1]) == 1)
    assert len(hinged) >= 3  # spreading makes a three-hinge arch
    move["joint"] = "joint 3"
    (refused,) = answers({"structure": ARCH, "analysis": [dem]})
    assert refused.status == "refused" and "joint 3" in refused.reason


def test_refusals_name_what_is_wrong() -> None:
    base = {"kind": "dem", "end_time": 1.0}

    def reason(structure: dict = ARCH, **keys) -> str:
        (found,) = answers({"structure": structure, "motion": PULSE, "analysis": [base | keys]})
        assert found.status == "refused", found.status
        return found.reason

    assert "joint 99" in reason(joints={"types": [{"joints": ["joint 99"], "friction": 0.3}]})
    twice = [{"joints": ["joint 1"], "friction": 0.3}, {"joints": ["joint 1"], "friction": 0.4}]
    assert "named twice" in reason(joints={"types": twice})
    assert "critical" in reason(time_step=0.1)
    assert "voussoir 77" in reason(track=["voussoir 77"])
    assert "is only for arches" in reason({"kind": "column", "width": 1.0, "height": 2.0, "drums": 2}, merge="three-bars")


@pytest.mark.parametrize(
    "wrong",
    [
        {"joints": {"friction": -0.1}},
        {"joints": {"normal_stiffness": -1.0}},
        {"fraction": 1.5},
        {"joints": {"beta": -1e-3}},
        {"tilt_accuracy": 1e-20},
        {"output_step": 1e-12},
    ],
)
def test_deck_complains(wrong: dict) -> None:
    with pytest.raises(DeckError) as error:
        make_deck({"structure": ARCH, "motion": PULSE, "analysis": [{"kind": "dem"} | wrong]})
    assert next(iter(wrong)) in str(error.value)


def test_an_arch_too_thin_cannot_stand() -> None:
    """By the certificate of limit analysis: a result, not a refusal."""
    dem = {"kind": "dem", "end_time": 1.0}
    (found,) = answers({"structure": ARCH | {"thickness": 0.3}, "motion": PULSE, "analysis": [dem]})
    assert found.status == "ok" and found["safety_factor"] == 0.0 and "discrete elements: " in found["certificate"]


def test_overlapping_blocks_are_refused_by_name(monkeypatch: pytest.MonkeyPatch) -> None:
    from extrados.analyses.dem import model as dem_model
    from extrados.analyses.dem.tables import Dem
    from extrados.core import dem
    from extrados.model.structures.masonry import Column, make_column

    column = make_column(1.0, [1.0, 1.0])
    column.outlines[1][:2, 1] -= 0.2  # the upper drum reaches into the lower one
    context = Context(
        make_deck(
            {"structure": {"kind": "column", "width": 1.0, "height": 2.0, "drums": 2}, "analysis": [{"kind": "dem", "end_time": 1.0}]}
        )
    )
    monkeypatch.setattr(Column, "assembly", lambda *_: column)
    model = make_model(context, Dem(kind="dem"))
    with pytest.raises(Exception, match="drum 1 and drum 2 overlap"):
        dem_model.checked(dem.run(model.bodies(), dem.Options(1.0)), model)


def test_failure_curve_resumes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """An interrupted sweep goes on from what it has: the answers kept are not computed again."""
    from extrados.analyses.dem import dem_domain
    from extrados.core import dem

    deck = make_deck(
        {
            "structure": {"kind": "block", "width": 1.0, "height": 4.0},
            "analysis": [
                {
                    "kind": "dem-domain",
                    "amplitudes": ["0.6 g"],
                    "durations": [0.2, 0.4, 0.8],
                    "accuracy": 0.1,
                    "joints": {"friction": 2.0, "normal_stiffness": 1e9},
                }
            ],
        }
    )
    options = deck.analyses[0]
    first = Context(deck, out=tmp_path / "run")
    model = make_model(first, options)
    asked = [(0, 0.6 * 9.80665, 0.2), (0, 0.6 * 9.80665, 0.8)]
    curves = [dem_domain.Curve("as given", model.values)]
    search = dem_domain.Search(first, options, model, curves, 4)
    answers = search.fails(asked)
    with monkeypatch.context() as patch:
        patch.setattr(dem.Model, "run", lambda *args, **keys: pytest.fail("was computed again"))
        again = dem_domain.Search(Context(deck, out=tmp_path / "run", resume=True), options, model, curves, 4)
        assert again.fails(asked) == answers
        assert (again.steps, again.residual) == (search.steps, search.residual) and search.steps > 0 < search.residual
    (found,) = run_analyses(Context(deck, threads=2, out=tmp_path / "run"))
    assert found.status == "ok" and 0.2 < found["shortest_durations_s"][0] <= 0.8


def interrupt_from(monkeypatch: pytest.MonkeyPatch, first: int, **change) -> list[int]:
    """From run `first` on the core answers as after Ctrl-C (or with `change`); the list grows with each run."""
    from dataclasses import replace

    from extrados.core import dem

    real, count = dem.Model.run, []

    def run(*args, **keys):
        count.append(len(count) + 1)
        found = real(*args, **keys)
        return found if len(count) < first else replace(found, **(change or {"interrupted": True}))

    monkeypatch.setattr(dem.Model, "run", run)
    return count


SLIDING = {
    "structure": {"kind": "block", "width": 1.0, "height": 1.0},
    "motion": {"kind": "sine-pulse", "amplitude": "0.5 g", "period": 0.5},
    "analysis": [{"kind": "dem", "end_time": 0.6, "joints": {"normal_stiffness": 1e9}, "find_friction": True}],
}


def test_friction_search_does_not_survive_ctrl_c(monkeypatch: pytest.MonkeyPatch) -> None:
    """An interrupted run is no answer: the base run is kept, no threshold is claimed."""
    (whole,) = answers(SLIDING)
    assert whole["friction_threshold"] == pytest.approx(0.5, abs=0.06)
    with monkeypatch.context() as patch:
        interrupt_from(patch, 4)
        (found,) = answers(SLIDING)
    assert found.status == "interrupted" and "friction_threshold" not in found.results
    assert found["stop_time_s"] == whole["stop_time_s"]
    with monkeypatch.context() as patch:
        count = interrupt_from(patch, 1)
        (found,) = answers(SLIDING)
    assert found.status == "interrupted" and len(count) == 1
    with monkeypatch.context() as patch:
        interrupt_from(patch, 4, reason="blow-up")
        (found,) = answers(SLIDING)
    assert found["friction_threshold"] is None
    assert any("error of the energy balance is too large" in w for w in found.warnings)


def test_restitution_is_that_of_free_rocking() -> None:
    """Housner's 1 - 1.5 sin^2 alpha = 0.9118 where a block rocks freely; nothing where it does not rock."""
    block = {"kind": "block", "width": 1.0, "height": 4.0}
    dem = {"kind": "dem", "end_time": 4.0, "joints": {"friction": 2.0, "normal_stiffness": 1e12}, "initial": {"rotation_ratio": 0.4}}
    (free,) = answers({"structure": block, "analysis": [dem]})
    assert free["restitution_measured"] == pytest.approx(0.9118, abs=0.012)
    # The rotation is that of the block, not the one since it was let go.
    assert free["rotation"][0, 0] == pytest.approx(0.4 * np.arctan(0.25), rel=1e-6)
    motion = {"kind": "sine-pulse", "amplitude": "0.1 g", "period": 0.5}
    (still,) = answers({"structure": block, "motion": motion, "analysis": [dem | {"initial": {"rotation_ratio": 0.0}}]})
    assert still["outcome"] == "at-rest" and still["restitution_measured"] is None


@pytest.mark.parametrize(
    ("height", "wanted", "kept"), [(1.6, "", 0.5787), (3.0, "", 0.85), (1.0, "", 0.25), (1.6, "restitution = 0.65", 0.65)]
)
def test_damping_that_gives_the_wanted_restitution(height: float, wanted: str, kept: float) -> None:
    """Of stocky blocks too, where critical damping at edge impact keeps 3 % too much of the rate (1 x 1.6 m)."""
    found = extrados.run(tomllib.loads(STOCKY.format(height=height, rule='damping = "restitution"', wanted=wanted)))["dem"]
    assert found["restitution_measured"] == pytest.approx(kept, abs=0.006)


def test_no_damping_takes_more_than_housner() -> None:
    found = extrados.run(tomllib.loads(STOCKY.format(height=1.6, rule='damping = "restitution"', wanted="restitution = 0.4"))).results[0]
    assert found.status == "refused"
    assert "no damping of this block gives a coefficient of restitution of 0.4: give a value from 0.579 to 0.7" in found.reason


STOCKY = (
    '[structure]\nkind = "block"\nwidth = 1.0\nheight = {height}\n[joints]\nfriction = 5.0\n{rule}\n{wanted}\n[initial]\n'
    'rotation_ratio = 0.3\n[[analysis]]\nkind = "dem"\nend_time = 1.5\n'
)


def test_answers_of_sliding_and_of_standing() -> None:
    block = {"kind": "block", "width": 1.0, "height": 0.5}
    dem = {"kind": "dem", "end_time": 0.8, "joints": {"friction": 0.2, "normal_stiffness": 1e9}}
    motion = {"kind": "step-pulse", "amplitude": "0.5 g", "duration": 0.2}
    (slid,) = answers({"structure": block, "motion": motion, "analysis": [dem]})
    # (a - mu g) t^2 / 2 under the step, then v^2 / 2 / (mu g + a / 2) as the ground brakes with a / 2.
    fast, mu_g, a = 0.3 * 9.80665 * 0.2, 0.2 * 9.80665, 0.5 * 9.80665
    exact = 0.5 * fast * 0.2 + 0.5 * fast**2 / (mu_g + 0.5 * a)
    assert slid["peak_slip_m"] == pytest.approx(exact, rel=0.01)
    assert slid["outcome"] == "slid" and slid.answer.startswith("Blocks slide by up to 98.1 mm (9.81 % of the joint base)")
    assert slid["slip_ratio"] == pytest.approx(exact, rel=0.01) and slid["slipped_joint"] == "base"
    assert slid["governing_block"] == "block" and slid["collapse_criterion"] is None
    (still,) = answers({"structure": block, "analysis": [dem]})
    assert any("no motion acts on the structure" in w for w in still.warnings)
    assert "mrad" not in still.answer and not still["still_moving"]


@pytest.mark.parametrize("keys", [{"time_step": 1e-8, "end_time": 1e-4}, {"collapse_displacement": 1e-12}])
def test_settling_is_not_the_run(keys: dict) -> None:
    """What stands comes to rest under its weight, whatever step and limit the run is given."""
    dem = {"kind": "dem", "end_time": 0.2, "joints": {"normal_stiffness": 1e9}}
    motion = {"kind": "sine-pulse", "amplitude": "0.1 g", "period": 0.5}
    column = {"kind": "column", "width": 1.0, "height": 2.0, "drums": 2}
    (found,) = answers({"structure": column, "motion": motion, "analysis": [dem | keys]})
    assert found.status == "ok", found.reason


TILT = {"kind": "dem", "test": "tilt", "joints": {"friction": 2.0, "normal_stiffness": 1e10}, "tilt_limit": "1 g", "tilt_accuracy": 4e-3}


def test_tilt_in_both_senses() -> None:
    """A block whose weight lies nearer to its right toe falls sooner to +x than to -x, as limit analysis says."""
    outline = [[0.0, 0.0], [1.0, 0.0], [1.0, 2.0], [0.6, 2.0]]
    leaning = {"kind": "blocks", "block": [{"name": "block", "points": outline}]}
    motion = {"kind": "sine-pulse", "amplitude": "0.5 g", "period": 0.5}
    deck = {
        "structure": leaning,
        "motion": motion,
        "analysis": [{"kind": "tilt", "joints": {"friction": 2.0}}, TILT | {"vary_friction": [0.5]}],
    }
    exact, found = answers(deck)
    for key in ("collapse_acceleration_g", "collapse_acceleration_opposite_g"):
        assert found[key] == pytest.approx(exact[key], abs=6e-3), key
    assert found["collapse_acceleration_g"] < 0.8 * found["collapse_acceleration_opposite_g"]
    assert found["outcome"] == "collapse" and found["peak_rotation_rad"]["block"] > 0.0
    assert "+x" in found.answer and "-x" in found.answer
    assert any("vary_friction" in w and "[motion]" in w for w in found.warnings)


def test_tilt_stops_at_ctrl_c(monkeypatch: pytest.MonkeyPatch) -> None:
    """An interrupted run does not count as one that stands."""
    count = interrupt_from(monkeypatch, 3)
    (found,) = answers({"structure": {"kind": "block", "width": 1.0, "height": 4.0}, "analysis": [TILT]})
    assert found.status == "interrupted" and len(count) == 3


def test_vtk_collection(tmp_path: Path) -> None:
    deck = {
        "structure": {"kind": "brickwork", "unit_length": 0.5, "unit_height": 0.25, "units": 2, "courses": 2},
        "motion": {"kind": "sine-pulse", "amplitude": "0.8 g", "period": 0.5},
        "analysis": [{"kind": "dem", "end_time": 0.3, "output_step": 0.1, "vtk": True, "joints": {"normal_stiffness": 1e9}}],
    }
    (found,) = answers(deck)
    assert found.files["dem.pvd"].count(b"<DataSet") == len(found["time"]) == 4
    frame = found.files["dem/frame_0000.vtu"]
    assert b'NumberOfCells="6"' in frame  # five units and their support


def test_limit_analysis_takes_columns_and_walls() -> None:
    (found,) = answers({"structure": {"kind": "column", "width": 1.0, "height": 4.0, "drums": 8}, "analysis": [{"kind": "tilt"}]})
    assert found["collapse_acceleration_g"] == pytest.approx(0.25, rel=1e-6)


PIER = [[0.0, 0.0], [1.0, 0.0], [1.0, 2.0], [0.0, 2.0]]
STRUCTURES = {
    "arch": ARCH,
    "pointed-arch": {"kind": "pointed-arch", "span": 6.0, "radius": 6.0, "thickness": 0.8, "voussoirs": 8},
    "elliptical-arch": {"kind": "elliptical-arch", "span": 8.0, "rise": 3.0, "thickness": 1.0, "voussoirs": 9},
    "vault": {
        "kind": "vault",
        "radius": 5.0,
        "thickness": 0.6,
        "embrace": 120.0,
        "voussoirs": 8,
        "face": 4.2,
        "buttress_width": 2.0,
        "height": 9.0,
    },
    "aisled-vault": {
        "kind": "aisled-vault",
        "radius": 4.8,
        "thickness": 0.6,
        "voussoirs": 8,
        "springing": 12.5,
        "pier_width": 1.9,
        "aisle_thickness": 0.45,
        "aisle_voussoirs": 6,
        "aisle_springing": 6.0,
        "half_width": 12.5,
        "buttress_width": 1.8,
        "buttress_top": 8.5,
    },
    "blocks": {"kind": "blocks", "block": [{"name": "pier", "points": PIER}]},
    "JSON": {"kind": "blocks", "file": "pier.json"},
    "DXF": {"kind": "blocks", "file": "pier.dxf"},
    "block": {"kind": "block", "width": 1.0, "height": 4.0},
    "column": {"kind": "column", "width": 1.0, "height": 4.0, "drums": 3},
    "brickwork": {"kind": "brickwork", "unit_length": 0.5, "unit_height": 0.25, "units": 2, "courses": 3},
}


@pytest.mark.parametrize("name", STRUCTURES)
def test_every_structure_of_stones(name: str, tmp_path: Path) -> None:
    """Its properties are the building's: softer ground, joints that differ; it moves, and is drawn."""
    from extrados.results.store import read
    from extrados.running.run import run_to
    from extrados.show.dem import draw_dem

    (tmp_path / "pier.json").write_text(json.dumps({"blocks": [{"name": "pier", "points": PIER}]}))
    if name == "DXF":
        drawing = pytest.importorskip("ezdxf").new(units=6)
        drawing.modelspace().add_lwpolyline(PIER, close=True)
        drawing.saveas(tmp_path / "pier.dxf")

    def answer(**tables) -> object:
        deck = {
            "structure": STRUCTURES[name],
            "motion": {"kind": "step-pulse", "amplitude": "0.3 g", "duration": 0.1},
            "analysis": [{"kind": "dem", "end_time": 0.1, "output_step": 0.02}],
            **tables,
        }
        return run_to(Context(make_deck(deck, tmp_path)), tmp_path / "run", figures=False).results[0]

    soft = answer(supports={"stiffness": 1e8})
    slippery = answer(joints={"types": [{"joints": ["ground"], "friction": 0.05}]})
    plain = answer()
    assert soft.status == plain.status == "ok" and plain["peak_displacement_m"] > 0.0
    assert soft["joint_stiffness_min_Pa_per_m"] < 1e8 < plain["joint_stiffness_min_Pa_per_m"]
    if "safety_factor" in type(slippery.results).model_fields:
        assert slippery["safety_factor"] == 0.0 and ("arch" in name or name == "vault")  # it slides apart
    else:
        assert slippery["peak_slip_m"] > 10.0 * plain["peak_slip_m"]
    assert draw_dem(read(tmp_path / "run"), "dem", tmp_path) and list((tmp_path / "figures").glob("*.png"))


def test_a_start_that_it_cannot_take_is_refused() -> None:
    """Glued voussoirs are not the blocks of the mechanism; the deck may start rotated for the other strategies alone."""
    deck = {"structure": ARCH, "motion": PULSE, "initial": {"rotation_ratio": 0.2}}
    glued = {"kind": "dem", "end_time": 0.1, "merge": "three-bars"}
    refused, ran = answers({**deck, "analysis": [glued, {**glued, "initial": {"rotation_ratio": 0.0}}]})
    assert refused.status == "refused" and "merged voussoirs cannot start with a rotation" in refused.reason
    assert ran.status == "ok"


@pytest.mark.parametrize("ratio", [0.2, -0.2])
def test_an_arch_starts_in_the_pose_of_its_mechanism(ratio: float) -> None:
    """And what it swings back with is the potential of the mechanism at that rotation."""
    run = extrados.run(
        {
            "structure": ARCH,
            "initial": {"rotation_ratio": ratio},
            "analysis": [{"kind": "dem", "end_time": 2.0, "output_step": 0.002, "joints": {"normal_stiffness": 1e12}}],
        }
    )
    model = MechanismModel(make_arch(**{k: v for k, v in ARCH.items() if k != "kind"}))
    q = ratio * model.critical[0]
    place = np.array(run.array("dem", "place"))
    assert np.abs(place[0, : len(model.assembly.mass)] - model.pose([q])[0]).max() < 1e-4  # settled into its joints
    rest, start = model.coefficients(1, [0.0, abs(q)]).potential
    kinetic = np.array(run.array("dem", "kinetic_energy"))
    assert 0.6 < kinetic.max() / (start - rest) < 1.02  # not all joints close at once


def test_the_domain_starts_as_the_deck_says() -> None:
    """A block that leans already falls to a shorter pulse."""
    domain = {"kind": "dem-domain", "amplitudes": ["0.6 g"], "durations": [0.05, 0.8], "accuracy": 0.02}
    block = {"kind": "block", "width": 1.0, "height": 4.0}
    joints = {"friction": 2.0, "normal_stiffness": 1e8}
    shortest = [
        answers({"structure": block, "joints": joints, "initial": {"rotation_ratio": ratio}, "analysis": [domain]})[0][
            "shortest_durations_s"
        ][0]
        for ratio in (0.0, 0.5)
    ]
    assert shortest[1] != shortest[0] and min(shortest) > 0.0
