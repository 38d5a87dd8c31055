"""What a deck says of its building is used, or told to be left out, with file and line: never silently without effect."""

import copy
import json

import numpy as np
import pytest
from typer.testing import CliRunner

from extrados import kinds
from extrados.analyses.context import Context
from extrados.analyses.left_out import left_out
from extrados.cli import app
from extrados.decks.reader import PROPERTIES, make_deck, read_text
from extrados.results.compare import CLOCK
from extrados.running.run import Run, compute

CRACKS = {"tensile_strength": 3e5, "fracture_energy": 50.0}
CRUSHES = {"compressive_strength": 3e6, "crushing_energy": 5000.0}
BEDDED = {**CRACKS, "tensile_strength_parallel": 4e5}
HILL = {**CRUSHES, "compressive_strength_parallel": 2e6}
#: Two values of every property that are not its default, and what the deck must say beside them
VALUES = {
    "material.density": (1500.0, 2500.0),
    "material.young": (3e9, 6e9),
    "material.poisson": (0.1, 0.3),
    "material.tensile_strength": (2e5, 4e5, {"fracture_energy": 50.0}),
    "material.fracture_energy": (40.0, 90.0, {"tensile_strength": 2e5}),
    "material.tensile_strength_parallel": (2e5, 4e5, CRACKS),
    "material.fracture_energy_parallel": (20.0, 90.0, BEDDED),
    "material.shear_strength": (5e4, 1e5, BEDDED),
    "material.bed_angle": (10.0, 40.0, BEDDED),
    "material.softening": ("exponential", "hordijk", CRACKS),
    "material.compressive_strength": (1e6, 2e6),
    "material.compressive_strength_parallel": (2e6, 4e6, CRUSHES),
    "material.compressive_coupling": (-0.5, 0.5, HILL),
    "material.compressive_shear": (0.8, 3.0, HILL),
    "material.crushing_energy": (2e3, 8e3, {"compressive_strength": 1e6}),
    "material.crushing": ("exponential", "hordijk", CRUSHES),
    "material.lateral_reduction": (False, True, {**CRACKS, "compressive_strength": 1e6}),
    "material.confinement": (1.0, 4.0, CRUSHES),
    "joints.friction": (0.1, 0.6),
    "joints.cohesion": (1e4, 1e5, {"shear_energy": 20.0}),
    # without cohesion the first shear takes the bond away
    "joints.tension": (1e4, 1e5, {"fracture_energy": 10.0, "cohesion": 2e5, "shear_energy": 20.0}),
    "joints.fracture_energy": (5.0, 20.0, {"tension": 1e5}),
    "joints.shear_energy": (5.0, 20.0, {"cohesion": 1e5}),
    "joints.compressive_strength": (1e6, 3e6, {"crushing_energy": 3e3}),
    "joints.crushing_energy": (1e3, 3e3, {"compressive_strength": 1e6}),
    "joints.softening": ("exponential", "linear", {"tension": 1e5, "fracture_energy": 10.0}),
    "joints.normal_stiffness": (1e10, 3e10),
    "joints.shear_stiffness": (1e10, 3e10),
    "joints.shear_ratio": (0.3, 0.6, {"normal_stiffness": 1e10}),
    "joints.stiffness_rule": ("consistent", "thesis"),
    "joints.damping": ("corner", "rotation"),
    "joints.damping_ratio": (0.3, 0.7),
    "joints.beta": (1e-4, 1e-3),
    "joints.restitution": (0.8, 0.9),
    "joints.energy_ratio": (0.6, 0.8),
    "joints.worn_corners": (0.01, 0.03),
    "supports.stiffness": (1e8, 3e8),
    "supports.foundation": ("winkler", "two-spring", {"stiffness": 1e8}),
    "supports.damping_ratio": (0.1, 0.4, {"stiffness": 1e8}),
    "supports.abutting_wall": ("left", "right"),
    "supports.rebound": (0.3, 0.7, {"abutting_wall": "left"}),
    "supports.held": ([{"edge": "bottom"}], [{"edge": "bottom", "fix": "y"}, {"edge": "left", "fix": "x"}]),
    "initial.rotation_ratio": (0.1, 0.95),
    "initial.movements": ([{"joint": "base", "dx": 0.005}], [{"joint": "base", "dx": 0.02}]),
}
ARCH = {"kind": "arch", "radius": 10.0, "thickness": 1.5, "embrace": 157.5, "voussoirs": 7}
BLOCK = {"kind": "block", "width": 1.2, "height": 4.8}
STACK = {"kind": "column", "width": 1.0, "height": 4.0, "drums": 2}
STACK_OF_TWO = {"kind": "stack", "lower_width": 1.0, "lower_height": 1.5, "upper_width": 0.6, "upper_height": 2.0}
WALL = {"kind": "panel", "width": 1.0, "height": 2.0, "thickness": 0.2}
SINE = {"kind": "sine-pulse", "amplitude": "0.5 g", "period": 0.6}
RECORD = {"kind": "record", "file": "extrados:el-centro-1940", "scale": 3.0}
HOUSE = {
    "kind": "building",
    "storeys": [2.8],
    "walls": [
        {"name": n, "start": s, "end": e, "thickness": 0.3}
        for n, s, e in (("a", [0, 0], [3, 0]), ("b", [3, 0], [3, 2]), ("c", [3, 2], [0, 2]), ("d", [0, 2], [0, 0]))
    ],
}
#: Kinds that take long, or need files; `assess` asks others, and dem-domain, dem-fragility and fragility run `dem` and `rocking` many times
LONG = {"survey", "fragility", "dem-domain", "dem-fragility", "assess"}
DECKS = {
    "tilt": (ARCH, None, {}),
    "thrust": (ARCH, None, {}),
    "thrust-network": ({**ARCH, "depth": 0.2}, None, {"lines": 4}),
    "sweep": (ARCH, None, {"vary": "thickness", "start": 1.4, "stop": 1.6, "count": 2}),
    "imperfections": (ARCH, None, {"count": 10, "deviation": 0.01}),
    "supports": (ARCH, None, {"steps": 10}),
    "moving-load": (ARCH, None, {"count": 3}),
    "rocking": (BLOCK, SINE, {}),
    "failure-domain": (BLOCK, None, {"durations": [0.5], "accuracy": 0.01}),
    "failure-curves": (BLOCK, None, {"count": 2, "amplitudes": 6, "accuracy": 0.01}),
    "assessment": (ARCH, RECORD, {}),
    "resonance": (BLOCK, None, {}),
    "rocking-spectrum": (None, RECORD, {"periods": [4.0, 8.0]}),
    "harmonic-map": (BLOCK, None, {"amplitudes": 4, "frequencies": [0.5, 1.0]}),
    "code-checks": (BLOCK, SINE, {"peak_acceleration": "0.2 g"}),
    "local-mechanism": (None, None, {"mechanism": "facade", "height": 5.0, "thickness": 0.6}),
    "motion": (None, RECORD, {}),
    "shake-table": (None, RECORD, {}),
    "dem": (BLOCK, SINE, {"end_time": 0.4}),
    "dem-parameters": (BLOCK, None, {}),
    "strengthen": (ARCH, None, {"acceleration": "0.4 g"}),
    "sla": (STACK, None, {"mesh": {"size": 0.5}, "events": 30}),
    "arch rocking": (ARCH, SINE, {"kind": "rocking"}),
    "arch spectrum": (ARCH, RECORD, {"kind": "rocking-spectrum", "periods": [12.0, 20.0]}),
    "pier": (WALL, None, {"kind": "code-checks", "axial_load": 1e5, "fixity": "double"}),
    "arch by codes": (ARCH, None, {"kind": "local-mechanism", "mechanism": "building"}),
    "rigid contacts": (BLOCK, SINE, {"kind": "dem", "end_time": 0.4, "solver": "nonsmooth"}),
    "rigid solids": (BLOCK, SINE, {"kind": "dem", "end_time": 0.2, "solver": "nonsmooth", "direction": 0.0}),
    "sla of a panel": (WALL, None, {"kind": "sla", "mesh": {"size": 0.5}, "events": 30}),
    "pushover": (HOUSE, None, {"mesh": {"size": 0.9, "layers": 3}, "events": 25}),
    "modes": (ARCH, None, {}),
    "frame-modes": (HOUSE, None, {}),
    "frame-pushover": (
        HOUSE,
        None,
        {
            "directions": [0.0],
            "senses": ["+"],
            "patterns": ["uniform"],
            "eccentricities": [0.0],
            "frame": {"flanges": "whole", "diagonal_strength": 1e5},
        },
    ),
    "frame-history": (HOUSE, SINE, {"end_time": 0.5}),
    "frame-fragility": (HOUSE, SINE, {"by": "pushover", "count": 2, "uncertain": {"young": 0.2}, "frame": {"diagonal_strength": 1e5}}),
    "walls of a plan": (HOUSE, None, {"kind": "local-mechanism", "mechanism": "building"}),
    "rocking of a stack": (STACK_OF_TWO, SINE, {"kind": "rocking"}),
    "sla of rows": (STACK, None, {"kind": "sla", "mesh": {"size": 0.5, "joints": "rows"}, "events": 30}),
}


#: Whether a single block falls does not depend on its weight
WEIGHTLESS = {"failure-domain", "failure-curves"}


def deck_of(name: str, key: str, value: object, beside: dict):
    structure, motion, keys = DECKS[name]
    table, own = key.split(".")
    if key == "initial.movements" and structure is ARCH:
        value = [{**one, "joint": "joint 7"} for one in value]
    data = {"analysis": {"kind": name, **copy.deepcopy(keys)}, table: {**beside, own: value}}
    if structure:
        data["structure"] = structure
    if motion:
        data["motion"] = motion
    if name == "pier":
        data.setdefault("material", {}).setdefault("compressive_strength", 5e6)
    return make_deck(data)


def content(run: Run) -> str:
    """All numbers of the first analysis but how fast they came."""
    result = run.results[0]
    numbers = {name: value for name, value in result.results.as_json().items() if name not in CLOCK}
    return json.dumps(numbers, sort_keys=True, default=str) + "".join(
        f"{name} {np.asarray(array.data).tolist()!r}" for name, array in sorted(result.arrays.items())
    )


def test_every_property_has_two_values_here_and_every_kind_a_deck() -> None:
    every = {f"{table}.{name}" for table, model in PROPERTIES.items() for name in model.model_fields}
    assert set(VALUES) == every - {"joints.types"}
    assert {*DECKS, *LONG} >= set(kinds.ANALYSES)


@pytest.mark.parametrize("name", [pytest.param(name, marks=[pytest.mark.verify] if name == "strengthen" else []) for name in DECKS])
def test_no_property_is_silently_without_effect(name: str) -> None:
    """Another value changes the answer, or it is told to be left out, or refused, or fixed by the method in so many words."""
    silent = []
    for key, (one, other, *more) in VALUES.items():
        beside = more[0] if more else {}
        deck = deck_of(name, key, other, beside)
        if any(f" {key}: " in remark.text for remark in left_out(deck)):
            continue
        run = compute(Context(deck))
        result = run.results[0]
        if result.status == "refused":
            table = key.split(".")[0]
            blamed = [key, *(f"{table}.{name}" for name in beside)]
            assert any(f"{name}: " in result.reason for name in blamed), f"{key}: {result.reason}"
            continue
        assert result.status == "ok", result.reason
        assumed = result.assumptions.get(key)
        if assumed is not None and assumed.origin == "method":
            continue
        if content(run) == content(compute(Context(deck_of(name, key, one, beside)))):
            silent.append(key)
    assert not set(silent) - ({"material.density"} if name in WEIGHTLESS else set()), silent


def test_a_property_reported_as_neglected_has_no_effect() -> None:
    """The other way round, where it takes no time: the remark is true."""
    for name in ("tilt", "supports", "dem-parameters", "arch by codes", "pier"):
        for key, (one, other, *more) in VALUES.items():
            beside = more[0] if more else {}
            deck = deck_of(name, key, other, beside)
            if any(f" {key}: " in remark.text for remark in left_out(deck)):
                found = [compute(Context(d)) for d in (deck, deck_of(name, key, one, beside))]
                assert content(found[0]) == content(found[1]), f"{name}: {key}"


TOLD = """[structure]
kind = "arch"
radius = 5.0
thickness = 0.8
embrace = 157.5
voussoirs = 20
[joints]
cohesion = "0.1 MPa"
friction = 0.7
tension = 0.0
types = [{ joints = ["joint 0"], tension = "0.2 MPa" }]
[materials.tuff]
young = "2 GPa"
[[analysis]]
kind = "tilt"
[[analysis]]
kind = "thrust"
[analysis.joints]
worn_corners = "1 cm"
"""


def test_it_is_reported_once_with_file_and_line() -> None:
    remarks = left_out(read_text(TOLD.encode()))
    assert [remark.text.partition(";")[0] for remark in remarks] == [
        "deck.toml:8: joints.cohesion: tilt, thrust do not use this key",
        "deck.toml:11: joints.types.tension: tilt, thrust do not use this key",
        "deck.toml:13: materials.tuff.young: tilt, thrust do not use this key",
        "deck.toml:19: analysis.joints.worn_corners: thrust does not use this key",
    ]
    assert "dem" in remarks[0].text.partition(";")[2]
    run = compute(Context(read_text(TOLD.encode())))
    assert [w for r in run.results for w in r.warnings if "not use this key" in w] == [remark.text for remark in remarks]
    assert [sum("not use this key" in w for w in r.warnings) for r in run.results] == [3, 1]


def test_check_reports_it_too_and_passes(tmp_path) -> None:
    (tmp_path / "deck.toml").write_text(TOLD)
    answer = CliRunner().invoke(app, ["check", str(tmp_path / "deck.toml")])
    assert answer.exit_code == 0 and answer.output.count("warning: ") == 4 and answer.output.endswith("ok\n")


def test_a_property_that_only_some_analyses_neglect_is_reported_if_it_affects_stability() -> None:
    """Cohesion that dem has and tilt has not; not the restitution that statics never asks for."""
    deck = {
        "structure": ARCH,
        "motion": SINE,
        "joints": {"cohesion": 1e5, "restitution": 0.9},
        "analysis": [{"kind": "tilt"}, {"kind": "rocking"}, {"kind": "dem"}],
    }
    remarks = left_out(make_deck(deck))
    assert [(remark.text, remark.analysis) for remark in remarks] == [("deck: joints.cohesion: dem uses this key; tilt, rocking do not", 0)]
    deck["analysis"][0]["joints"] = {"cohesion": 0.0}
    deck["analysis"][1]["joints"] = {"cohesion": 0.0}
    assert left_out(make_deck(deck)) == [], "who overrides it for itself knows"


def test_water_that_other_analyses_do_not_include_is_reported() -> None:
    """Once, beside the first of them; not for a study of the motion, nor where all include it."""
    wet = {"kind": "dem", "water": {"level": 1.0}}
    deck = {"structure": BLOCK, "motion": SINE, "analysis": [wet, {"kind": "motion"}, {"kind": "tilt"}, {"kind": "rocking"}]}
    remarks = left_out(make_deck(deck))
    assert [(remark.text, remark.analysis) for remark in remarks] == [
        ("deck: analysis.water: dem includes this water; tilt, rocking do not", 2)
    ]
    assert left_out(make_deck({**deck, "analysis": [wet, wet, {"kind": "motion"}]})) == []


def test_defaults_are_not_reported() -> None:
    same = {"cohesion": 0.0, "friction": 0.7, "restitution": "inelastic", "types": []}
    assert left_out(make_deck({"structure": ARCH, "joints": same, "analysis": {"kind": "tilt"}})) == []


def test_a_building_that_cannot_be_made_is_reported_by_its_analysis(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever goes wrong with it: the other analyses of the deck still count."""

    def fails(*_: object) -> None:
        raise MemoryError("no room")

    deck = make_deck({"structure": ARCH, "motion": {**RECORD, "scale": 1.0}, "analysis": [{"kind": "supports"}, {"kind": "motion"}]})
    monkeypatch.setattr(type(deck.structure), "assembly", fails)
    first, second = compute(Context(deck)).results
    assert first.status == "failed" and "no room" in first.reason and second.status == "ok"


def test_an_analysis_that_does_not_use_it_is_not_named_among_those_that_can() -> None:
    """Rigid contacts know no stiffness, springs do: both are `dem`."""
    deck = {"structure": ARCH, "motion": SINE, "material": {"young": 7e9}, "analysis": [{"kind": "dem", "solver": "nonsmooth"}]}
    (remark,) = left_out(make_deck(deck))
    words, _, others = remark.text.partition(";")
    assert words == "deck: material.young: dem does not use this key"
    assert others == " local-mechanism, sla, pushover and others can use it"
