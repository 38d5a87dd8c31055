"""Every key has an effect, surveys rank by what each deck gives, and unused keys are reported."""

import csv
import json
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import tomlkit
from asking import Answer, Deck, ask, must, near
from buildings import changed
from hypothesis import strategies as st
from relations import ok, relation

from extrados import kinds
from extrados.analyses.left_out import left_out
from extrados.decks.reader import DeckError, make_deck
from extrados.running import survey

BLOCK: Deck = {"structure": {"kind": "block", "width": 0.6, "height": 3.0}, "joints": {"friction": 0.8}}
ARCH: Deck = {"structure": {"kind": "arch", "radius": 4.0, "thickness": 0.7, "embrace": 150.0, "voussoirs": 8}, "joints": {"friction": 0.8}}
DRUMS: Deck = {"structure": {"kind": "column", "width": 0.6, "height": 2.4, "drums": 3}, "joints": {"friction": 0.5}}
FRAMED: Deck = {
    "structure": {"kind": "frame", "columns": 2, "width": 0.5, "height": 2.0, "spacing": 2.0, "lintel_height": 0.5},
    "joints": {"friction": 0.8},
}
CORNER: Deck = {
    "structure": {"kind": "wall", "unit_length": 0.6, "unit_height": 0.3, "thickness": 0.3, "height": 0.6, "legs": [{"length": 1.2}]},
    "joints": {"friction": 0.5},
}
PULSE: Deck = {"kind": "sine-pulse", "amplitude": "0.45 g", "period": 0.7}
SET: Deck = {"kind": "generated", "mmi": 9, "duration": 2.0, "seed": 3, "lines": 8}
SHAKEN: Deck = {"end_time": 0.6, "time_step": 1e-3, "solver": "nonsmooth"}
RUN_KEYS: Deck = {
    "time_step": 2e-3,
    "floor": 0.0,
    "quasi_static": True,
    "test": "tilt",
    "end_time": 0.4,
    "output_step": 0.02,
    "collapse_displacement": 0.05,
    "perturbed": False,
    "track": ["drum 1"],
    "snapshot_times": [0.1],
    "merge": "three-bars",
}
#: Analyses with keys that each change something of their answers
EFFECTS: tuple[tuple[Deck, str, Deck, Deck], ...] = (
    ({**BLOCK, "motion": PULSE}, "rocking", {"end_time": 2.0}, {"form": "linear", "end_time": 1.0, "output_step": 0.02, "tolerance": 1e-5}),
    (
        {**ARCH, "motion": {**PULSE, "amplitude": "0.8 g"}},
        "rocking",
        {"end_time": 1.0},
        {"end_time": 0.6, "output_step": 0.02, "tolerance": 1e-5, "thrust_line_times": [0.2]},
    ),
    (ARCH, "tilt", {}, {"friction_rule": "non-associated", "load": [{"x": 0.5, "force": 1e3}], "direction": 0.0}),
    (CORNER, "tilt", {"direction": 10.0}, {"direction": 50.0, "rose": 8, "pyramids": 8}),
    (ARCH, "thrust", {}, {"gamma": 0.05, "load": [{"x": 0.5, "force": 1e3}]}),
    (
        ARCH,
        "moving-load",
        {"count": 9, "axle_loads": [1e4, 2e4], "axles": [0.0, 0.5]},
        {
            "alpha": 1.3,
            "width": 0.5,
            "both_ways": True,
            "count": 7,
            "places": [0.3, 0.9],
            "axle_loads": [2e4, 1e4],
            "axles": [0.0, 0.8],
            "load": [{"x": 0.5, "force": 1e3}],
            **{f"factors {k}": {k: 1.3} for k in ("masonry", "live", "dynamic", "friction")},
            "uniform": [{"load": 5e3}],
        },
    ),
    (ARCH, "moving-load", {"count": 9, "axles": [0.0, 0.5]}, {"force": 1e4, "shares": [1.0, 3.0]}),
    (ARCH, "supports", {"steps": 20, "settle": 0.3}, {"spread": 0.5, "settle": -0.3, "steps": 30}),
    (FRAMED, "supports", {"settle": 0.3}, {"spread": 0.5, "settle": -0.3, "movement": 0.01}),
    (
        ARCH,
        "failure-domain",
        {"durations": [0.5, 1.0], "amplitudes": 5, "accuracy": 1e-3, "hand_over_cells": 0},
        {"pulse": "sine", "amplitudes": 7, "durations": [0.6, 1.1], "max_amplitude": "1.2 g", "at_amplitudes": ["1.3 g"], "accuracy": 0.02},
    ),
    (
        {**BLOCK, "motion": SET},
        "fragility",
        {"count": 5, "bootstrap": 0},
        {
            "form": "linear",
            "count": 6,
            "seed": 9,
            "cloud": True,
            "histories": 2,
            "confidence": 0.8,
            "bins": 9,
            "tolerance": 1e-4,
            "durations": [1.0, 2.0],
            "levels": [0.3, 1.0],
            "uncertain": {"width": 0.1},
        },
    ),
    (
        {**BLOCK, "motion": SET},
        "fragility",
        {"count": 6, "bootstrap": 50, "levels": [0.2, 0.5, 1.2]},
        {"intensity": "arias", "confidence": 0.8, "settle": 0.1, "levels": [0.2, 0.6, 1.2], "seed": 9, "tolerance": 1e-4},
    ),
    (
        BLOCK,
        "local-mechanism",
        {
            "mechanism": "facade",
            "height": 5.0,
            "thickness": 0.5,
            "spectrum": {"code": "NTC", "acceleration": "0.1 g"},
            "base_height": 3.0,
            "building_height": 9.0,
        },
        {
            "behaviour_factor": 3.0,
            "confidence_factor": 1.0,
            "base_height": 4.0,
            "building_height": 8.0,
            "building_period": 0.5,
            "storeys": 5,
            "peak_acceleration": "0.3 g",
            "collapse_spectrum": {"code": "NTC", "acceleration": "0.2 g"},
            "one_second_acceleration": "0.2 g",
            "mechanism": "parapet",
        },
    ),
    (
        ARCH,
        "local-mechanism",
        {"mechanism": "building", "spectrum": {"code": "NTC", "acceleration": "0.1 g"}},
        {
            "behaviour_factor": 3.0,
            "confidence_factor": 1.0,
            "base_height": 4.0,
            "peak_acceleration": "0.3 g",
            "collapse_spectrum": {"code": "NTC", "acceleration": "0.2 g"},
        },
    ),
    ({**DRUMS, "motion": PULSE}, "dem", SHAKEN, {**RUN_KEYS, "rebound": 0.5, "base": "moving", "direction": 0.0}),
    (
        {**DRUMS, "motion": PULSE},
        "dem",
        {**SHAKEN, "direction": 20.0},
        {k: v for k, v in RUN_KEYS.items() if k != "merge"} | {"direction": 70.0},
    ),
    (
        {**changed(DRUMS, joints={"normal_stiffness": 1e8}), "motion": PULSE},
        "dem",
        {"end_time": 0.4},
        {
            "mass_damping": 1.0,
            "fraction": 0.1,
            "vary_damping": [0.5],
            "vary_stiffness": [2.0],
            "vary_friction": [0.8],
            "collapse_displacement": 0.05,
        },
    ),
)
#: Keys of the tables of the deck, and analyses that use them
PROPERTIES_USED: tuple[tuple[Deck, str, Deck, tuple[tuple[str, str, Any], ...]], ...] = (
    (
        {**BLOCK, "motion": PULSE},
        "rocking",
        {"end_time": 2.0},
        (
            ("joints", "friction", 0.1),
            ("joints", "restitution", 0.7),
            ("joints", "energy_ratio", 0.6),
            ("initial", "rotation_ratio", 0.2),
            ("supports", "abutting_wall", "left"),
            ("supports", "stiffness", 1e8),
            ("material", "density", 1500.0),
        ),
    ),
    (
        {**DRUMS, "motion": PULSE},
        "dem",
        SHAKEN,
        (
            ("joints", "friction", 0.1),
            ("joints", "worn_corners", 0.02),
            ("initial", "rotation_ratio", 0.2),
            ("material", "density", 1500.0),
        ),
    ),
    (
        {**DRUMS, "motion": PULSE},
        "dem",
        {"end_time": 0.3},
        (
            ("joints", "normal_stiffness", 1e8),
            ("joints", "beta", 1e-4),
            ("joints", "damping_ratio", 0.5),
            ("joints", "shear_ratio", 0.8),
            ("joints", "cohesion", 1e5),
            ("joints", "tension", 1e5),
            ("supports", "stiffness", 1e8),
            ("material", "young", 1e9),
        ),
    ),
    (ARCH, "tilt", {}, (("joints", "friction", 0.3), ("material", "compressive_strength", 1e6), ("material", "density", 1500.0))),
    (
        ARCH,
        "moving-load",
        {"count": 7},
        (("joints", "friction", 0.4), ("material", "compressive_strength", 1e6), ("material", "density", 1500.0)),
    ),
    (
        ARCH,
        "failure-domain",
        {"durations": [0.5], "amplitudes": 4, "accuracy": 1e-3},
        (("joints", "friction", 0.3), ("joints", "restitution", 0.9), ("initial", "rotation_ratio", 0.3)),
    ),
    (
        {**BLOCK, "motion": SET},
        "fragility",
        {"count": 5, "bootstrap": 0},
        (("joints", "friction", 0.1), ("joints", "restitution", 0.7), ("initial", "rotation_ratio", 0.3), ("supports", "stiffness", 1e8)),
    ),
    (
        ARCH,
        "local-mechanism",
        {"mechanism": "building"},
        (("joints", "friction", 0.3), ("material", "compressive_strength", 1e6), ("material", "density", 1500.0)),
    ),
)


def _whole(answer: Answer) -> str:
    """All that an answer holds, as one text."""
    tables = {f"{n}.{c}": np.asarray(v).tolist() for n, t in answer.result.tables.items() for c, v in t.columns.items()}
    arrays = {n: np.asarray(v.data).tolist() for n, v in answer.result.arrays.items()}
    held = {k: repr(v) for k, v in vars(answer.results).items() if "seconds" not in k}
    return json.dumps([answer.status, answer.said, answer.result.answer, answer.warnings, tables, arrays, held], default=str)


@relation("rocking tilt thrust moving-load supports failure-domain fragility local-mechanism dem", st.just({}), 0.0, share=0.28)
def every_key_has_an_effect(deck: Deck, within: float) -> None:
    """Each key of an analysis, and each property that an analysis uses, changes its result; an override has the effect of the deck's own value."""
    for deck, kind, keys, changes in EFFECTS:
        before = ask(deck, kind, **keys)
        ok(before)
        for key, value in changes.items():
            after = ask(deck, kind, **{**keys, key.split()[0]: value})
            must(_whole(after) != _whole(before), f"{key} of {kind} has no effect")
    for deck, kind, keys, properties in PROPERTIES_USED:
        before = ask(deck, kind, **keys)
        for table, key, value in properties:
            own = changed(deck, **{table: {key: value}})
            after = ask(own, kind, **keys)
            must(after.status == "ok" and _whole(after) != _whole(before), f"{table}.{key} has no effect on {kind}: {after.said}")
            over = ask(deck, kind, **keys, **{table: {key: value}})
            must(over.status == "ok", f"{table}.{key} of {kind}: {over.said}")
            told = over.result.assumptions.get(f"{table}.{key}")
            must(told is None or told.origin == "analysis", f"{table}.{key} of {kind}: {told}")
            mine = after.result.assumptions.get(f"{table}.{key}")
            must(mine is None or mine.origin == "deck", f"{table}.{key} of the deck: {mine}")
            bare = before.result.assumptions.get(f"{table}.{key}")
            must(bare is None or bare.origin == ("deck" if key in deck.get(table, {}) else "default"), f"{table}.{key}: {bare}")
            for name, number_ in after.numbers.items():
                if isinstance(number_, float) and name in over.numbers and isinstance(over.numbers[name], float):
                    near(f"{table}.{key} of {kind}: {name}", number_, over.numbers[name], 1e-9, 1e-9)


@relation("assess", st.just({}), 0.0, share=0.25)
def a_survey_ranks_what_each_deck_says(deck: Deck, within: float) -> None:
    """Buildings of a folder have the results of separate assessments, with the keys of common.toml, in the order of their margins."""
    del deck, within
    narrow = {"structure": {"kind": "block", "width": 0.3, "height": 3.0}}
    wide = {"structure": {"kind": "block", "width": 1.0, "height": 2.0}, "motion": {**PULSE, "amplitude": "0.1 g"}}
    thin = {"structure": {"kind": "arch", "radius": 5.0, "thickness": 0.2, "embrace": 180.0, "voussoirs": 20}}
    many = {
        "structure": {"kind": "block", "width": 0.8, "height": 2.0},
        "analysis": [{"kind": "tilt"}, {"kind": "assess", "strategies": ["tilt"]}],
    }
    common = {"motion": PULSE, "analysis": [{"kind": "assess", "strategies": ["tilt", "rocking"]}]}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name) / "decks"
        folder.mkdir()
        decks_ = {"narrow": narrow, "wide": wide, "thin": thin, "many": many, "common": common}
        for stem, one in decks_.items():
            (folder / f"{stem}.toml").write_text(tomlkit.dumps(one))
        (folder / "narrow.expect.toml").write_text("no deck")
        rows = survey.assess_folder(folder, Path(name) / "out", figures=False)
        ranking = list(csv.DictReader((Path(name) / "out" / "ranking.csv").open()))
        for row in rows:
            must((row.folder / "summary.json").exists(), f"{row.building} is not written")
    must({r.building for r in rows} == {"narrow", "wide", "thin", "many"}, f"{[r.building for r in rows]}")
    must([r["building"] for r in ranking] == [r.building for r in rows], "ranking.csv in another order")
    for row in rows:
        own = decks_[row.building]
        table = next(t for t in own.get("analysis", common["analysis"]) if t["kind"] == "assess")
        alone = ask({**common, **own}, "assess", **{k: v for k, v in table.items() if k != "kind"})
        must((row.status, row.overall) == (alone.status, getattr(alone.results, "overall", "")), f"{row} of {alone.said}")
        margin = getattr(alone.results, "least_margin", None)
        must(np.isnan(row.least_margin) == (margin is None), f"{row.least_margin} of {margin}")
        near("margin", row.least_margin, np.nan if margin is None else margin, 1e-9)
        must(row.strategy == (alone.results.least_margin_strategy or "") and row.statement.startswith(alone.results.statement), f"{row}")
    places_ = [
        0 if r.overall == "cannot stand" else 2 if np.isfinite(r.least_margin) else 3 if r.overall == "stands under all" else 1
        for r in rows
    ]
    must(places_ == sorted(places_), f"in the order {places_}")
    margins = [r.least_margin for r in rows if np.isfinite(r.least_margin)]
    must(margins == sorted(margins), f"margins {margins}")
    with tempfile.TemporaryDirectory() as name:
        (Path(name) / "common.toml").write_text(tomlkit.dumps(common))
        try:
            survey.decks_of(Path(name))
        except DeckError as error:
            must("contains no decks" in str(error), str(error))
        else:
            must(False, "a folder without decks is surveyed")
        (Path(name) / "bad.toml").write_text("[structure]\nkind = 'block'\nwidth = -1.0\nheight = 2.0\n")
        try:
            survey.decks_of(Path(name))
        except DeckError as error:
            must("bad.toml" in str(error) and "width" in str(error), str(error))
        else:
            must(False, "a wrong deck is surveyed")


@relation(
    "tilt dem rocking",
    st.permutations(["tilt", "dem", "rocking", "thrust", "local-mechanism"]).flatmap(
        lambda kinds_: st.tuples(
            st.just(kinds_),
            st.integers(1, 3),
            st.sampled_from(
                [
                    ("joints", "cohesion", 1e5),
                    ("joints", "worn_corners", 0.02),
                    ("joints", "restitution", 0.7),
                    ("joints", "normal_stiffness", 1e8),
                    ("material", "compressive_strength", 1e6),
                    ("supports", "stiffness", 1e8),
                ]
            ),
        )
    ),
    0.0,
    share=2.0,
)
def what_is_not_used_is_said_with_who_can(asked: list, count: int, given: tuple, within: float) -> None:
    """A key that no analysis of the deck uses is reported with kinds that use it; a key that some use is reported with those that do not."""
    table, key, value = given
    rows = [
        {
            "kind": k,
            **({"mechanism": "building"} if k == "local-mechanism" else {"end_time": 0.02, "solver": "nonsmooth"} if k == "dem" else {}),
        }
        for k in asked[:count]
    ]
    deck = changed({**DRUMS, "motion": PULSE}, **{table: {key: value}}, analysis=rows)
    name = f"{table}.{key}"
    made = make_deck(deck)
    uses = [o.kind for o, b in zip(made.analyses, made.buildings, strict=True) if name in o.reckons_with(b)]
    remarks = [r.text for r in left_out(made) if key in r.text]
    without = [k for k in asked[:count] if k not in uses]
    if not without:
        must(not remarks, f"{name}, which all use: {remarks}")
        return
    if uses:
        for text in remarks:
            must(all(k in text for k in (*uses, *without)), f"{name}: {text}")
        return
    must(len(remarks) == 1 and all(k in remarks[0] for k in without), f"{name}, which none uses: {remarks}")
    if "can use it" in remarks[0]:
        able = remarks[0].split("; ")[-1].split(" can use it")[0].replace(" and others", "").split(", ")
        must(1 <= len(able) <= 3 and not set(able) & set(asked[:count]), f"{able} of {asked[:count]}")
        for kind in able:
            model = kinds.table("analysis", kind)
            must(name in (*model.uses, *model.beside), f"{kind} does not use {name}")
