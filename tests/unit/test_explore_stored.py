"""What the page shows of a stored run: of every kind charts and bodies whose arrays are sent, of the lengths that they need."""

import functools
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import extrados
from extrados.explore.folder import Folder, NotThere
from extrados.results.store import StoreError
from extrados.running.run import Run
from extrados.show.charts import shown

CASES = Path(__file__).resolve().parents[2] / "cases"
ARCH = {"kind": "arch", "radius": 10.0, "thickness": 1.5, "embrace": 157.5, "voussoirs": 7}
BLOCK = {"kind": "block", "width": 0.3, "height": 1.5}
SINE = {"kind": "sine-pulse", "amplitude": "0.8 g", "period": 0.6}
QUAKES = {"kind": "generated", "mmi": 8, "duration": 4.0, "seed": 4}
BEAM = {"kind": "panel", "width": 0.5, "height": 0.1, "thickness": 0.05}
BRITTLE = {"young": "32 GPa", "poisson": 0.2, "tensile_strength": "3 MPa", "fracture_energy": "60 N/m"}
#: A deck of each sort of run, small: its tables, and how many charts each analysis has
DECKS: dict[str, dict[str, Any]] = {
    "statics": {
        "structure": ARCH,
        "analysis": [
            {"kind": "tilt"},
            {"kind": "thrust"},
            {"kind": "moving-load", "count": 5},
            {"kind": "supports", "movement": 0.01},
            {"kind": "sweep", "vary": "thickness", "values": [1.4, 1.5, 1.6]},
        ],
    },
    "rocking": {
        "structure": ARCH,
        "motion": SINE,
        "analysis": [
            {"kind": "rocking", "end_time": 2.0},
            {"kind": "assessment"},
            {"kind": "failure-domain", "durations": [0.2, 0.4, 0.8], "amplitudes": 6},
            {"kind": "failure-curves", "durations": [0.2, 0.4, 0.8], "variants": [{"radius": 5.0, "thickness": 0.75}, {}]},
        ],
    },
    "statistics": {
        "structure": BLOCK,
        "motion": QUAKES,
        "analysis": [
            {"kind": "fragility", "count": 12},
            {"kind": "fragility", "count": 12, "levels": [0.3, 0.6, 1.2], "intensity": "pga"},
            {"kind": "fragility", "count": 12, "durations": [3.0, 5.0]},
            {"kind": "motion"},
        ],
    },
    "elements": {"structure": BLOCK, "joints": {"normal_stiffness": 1e8}, "motion": SINE, "analysis": [{"kind": "dem", "end_time": 0.5}]},
    "mechanism": {"analysis": [{"kind": "local-mechanism", "mechanism": "wall", "height": 3.0, "thickness": 0.5}]},
    "walls": {
        "structure": BEAM,
        "material": BRITTLE,
        "supports": {"held": [{"x": 0.02, "y": 0, "fix": "xy"}, {"x": 0.48, "y": 0, "fix": "y"}]},
        "analysis": [
            {
                "kind": "sla",
                "events": 30,
                "mesh": {"size": 0.02},
                "states": [10],
                "reference": [{"kind": "point", "x": 0.25, "y": 0.1, "fy": "-500 N"}],
                "control": [{"x": 0.25, "y": 0.0, "direction": "y", "weight": -1}],
            }
        ],
    },
    "buildings": {
        "structure": {
            "kind": "building",
            "storeys": [1.5],
            "walls": [{"name": "strip", "start": [0, 0], "end": [0.5, 0], "thickness": 0.2}],
        },
        "material": {"density": 1800, **BRITTLE},
        "analysis": [{"kind": "pushover", "direction": 0, "events": 30, "mesh": {"size": 0.25}}],
    },
}
#: What is shown beside words and tables
CHARTS = {
    "tilt": 0,
    "thrust": 0,
    "moving-load": 1,
    "supports": 0,
    "sweep": 1,
    "rocking": 1,
    "assessment": 2,
    "failure-domain": 1,
    "failure-curves": 1,
    "fragility": 1,
    "fragility-2": 1,
    "fragility-3": 1,
    "motion": 1,
    "dem": 1,
    "local-mechanism": 1,
    "sla": 1,
    "pushover": 1,
}


@functools.lru_cache(maxsize=len(DECKS))
def run_of(name: str) -> Run:
    return extrados.run(DECKS[name])


def analyses() -> list[Any]:
    found = []
    for name, deck in DECKS.items():
        seen: list[str] = []
        for table in deck["analysis"]:
            seen.append(table["kind"])
            count = seen.count(table["kind"])
            found.append((name, table["kind"] if count == 1 else f"{table['kind']}-{count}"))
    return found


@pytest.mark.parametrize(("deck", "analysis"), analyses())
def test_what_is_shown_of_a_run_is_sent_with_it(deck: str, analysis: str) -> None:
    run = run_of(deck)
    row = run.analysis(analysis)
    assert row["status"] in ("ok", "interrupted"), row["reason"]
    words, arrays = shown(run, analysis)
    assert words["analysis"] == analysis and words["numbers"]
    assert len(words["charts"]) >= CHARTS[analysis] and (words["charts"] or len(arrays["outline"]))
    for chart in words["charts"]:
        assert chart["title"] and chart["series"] and chart["y"]["label"] is not None
        for series in chart["series"]:
            x = arrays[series.get("x", chart["x"]["array"])]
            for name in [series["array"], *([series["lower"]] if "lower" in series else [])]:
                assert len(arrays[name]) == len(x) > 0, f"{chart['title']}: {name}"
        if chart.get("heat"):
            heat = chart["heat"]
            assert arrays[heat["codes"]].shape == (len(arrays[heat["x"]]), len(arrays[heat["y"]]))
    if "body_pose" in arrays:
        assert len(arrays["body_pose"]) == len(arrays["body_time"]) > 1
        assert arrays["body_pose"].shape[1:] == (len(arrays["centroid"]), 3)


def test_sections_of_a_survey_stand_by_their_capacity() -> None:
    run = extrados.run(CASES / "limit" / "survey.toml")
    words, arrays = shown(run, "survey")
    stand = arrays["capacity"][np.isfinite(arrays["capacity"])]
    assert len(arrays["rank"]) == len(arrays["capacity"]) == 12 > len(stand) > 4
    assert (np.diff(stand) >= 0.0).all() and (arrays["capacity"][: len(stand)] == stand).all()
    [table] = [table for table in words["tables"] if table["title"] == "sections"]
    assert [row[1] for row in table["rows"]] == [*stand.tolist(), *[None] * (12 - len(stand))]


def test_of_a_run_without_a_name_the_words_are_reported_and_an_unknown_one_is_refused() -> None:
    words, arrays = shown(run_of("mechanism"), None)
    assert arrays == {} and [row["name"] for row in words["analyses"]] == ["local-mechanism"]
    with pytest.raises(StoreError, match="the run has no analysis 'tilt'"):
        shown(run_of("mechanism"), "tilt")


def test_figures_of_a_stored_run_are_those_of_its_report(tmp_path: Path) -> None:
    """Of one analysis, not of another whose name begins alike; none by a link, none of a run that has them not."""
    deck = {"structure": ARCH, "analysis": [{"kind": "thrust"}, {"kind": "thrust"}]}
    out = tmp_path / "results"
    extrados.run(deck).write(out)
    folder = Folder(tmp_path)
    names = {name: {stem for stem, _ in folder.figures("results", name)} for name in ("thrust", "thrust-2")}
    written = {path.stem for path in out.glob("figures/thrust-*.svg")}
    assert {f"{name}-{stem}" for name, stems in names.items() for stem in stems} == written and names["thrust"] == names["thrust-2"]
    assert all("<svg" in svg for _, svg in folder.figures("results", "thrust"))
    with pytest.raises(NotThere):
        folder.figures("results", "../thrust")
    (out / "figures" / "thrust-stolen.svg").symlink_to(tmp_path.parent / "x.svg")
    (tmp_path.parent / "x.svg").write_text("<svg>secret</svg>")
    with pytest.raises(NotThere):
        folder.figures("results", "thrust")
