"""Trains of the library: total weights and lengths that the rules state, and a span that one axle alone decides."""

import tomllib
from pathlib import Path
from typing import get_args

import numpy as np
import pytest

import extrados
from extrados.analyses.context import Context
from extrados.analyses.limit import moving_load, trains
from extrados.analyses.limit.tables import MovingLoad, TrainName
from extrados.analyses.limit.trains import train_of
from extrados.decks.reader import DeckError, make_deck
from extrados.model.errors import BadGeometry


@pytest.mark.parametrize(
    ("train", "gap", "weight", "length"),
    [
        ("LM71", None, 1000.0, 4.8),
        ("SV80", None, 780.0, 6.0),
        ("SV80", 9.0, 780.0, 13.8),
        ("SV100", 5.0, 990.0, 9.8),
        ("SV196", None, 1945.0, 19.6),
        ("SV196", 5.0, 1945.0, 23.4),
    ],
)
def test_axles_have_the_weight_and_length_of_the_rule(train: str, gap: float | None, weight: float, length: float) -> None:
    """SV80 stands for 80 t, SV100 for 100 t, SV196 for 196 t: their axles weigh as much within 3 %."""
    found = train_of(MovingLoad(kind="moving-load", train=train, gap=gap), 4.0)
    assert found.forces.sum() == pytest.approx(1e3 * weight)
    assert found.axles[-1] - found.axles[0] == pytest.approx(length)
    if train.startswith("SV"):
        assert found.forces.sum() / 9806.65 == pytest.approx(float(train[2:]), rel=0.03)


@pytest.mark.parametrize("train", ["SW/0", "SW/2"])
def test_even_loads_are_those_of_the_rail_models(train: str) -> None:
    load, length, gap = {"SW/0": (133e3, 15.0, 5.3), "SW/2": (150e3, 25.0, 7.0)}[train]
    even = train_of(MovingLoad(kind="moving-load", train=train), 4.0).even
    np.testing.assert_allclose(even, [[0.0, length, load], [length + gap, 2.0 * length + gap, load]])


CASES = Path(__file__).parents[2] / "cases"
BRIDGE = {"kind": "bridge", "depth": 4.0, "spans": [{"span": 6.0, "rise": 1.5, "thickness": 0.5, "voussoirs": 20}], "fill": {"cover": 0.4}}


def test_a_special_vehicle_is_its_axles_and_says_that_nobody_read_the_clause() -> None:
    """The same axles written into the deck give the same factor."""
    own = {"axles": [0.0, 1.2, 2.4, 7.4, 8.6, 9.8], "axle_loads": [165e3] * 6}
    named, given = (
        extrados.run({"structure": BRIDGE, "joints": {"friction": 0.6}, "analysis": {"kind": "moving-load", "count": 7, **one}})
        for one in ({"train": "SV100", "gap": 5.0}, own)
    )
    assert named["moving-load"].adequacy_factor == pytest.approx(given["moving-load"].adequacy_factor, rel=1e-9)
    assert "not verified against the standard" in named.analyses[0]["warnings"][0] and not given.analyses[0]["warnings"]


def test_an_interrupted_moving_load_resumes_its_further_positions(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """All positions are kept, those between the first ones too, show their progress, and are not calculated a second time."""
    train = {"axles": [0.0, 1.2], "axle_loads": [1e5, 1e5]}
    deck = make_deck({"structure": BRIDGE, "joints": {"friction": 0.6}, "analysis": {"kind": "moving-load", "count": 5, **train}}, tmp_path)
    options, shown = deck.analyses[0], []
    whole = moving_load.run(Context(deck, out=tmp_path / "run", progress=lambda done, _, text: shown.append((done, text))), options)
    assert {text for _, text in shown} == {"moving load", "further positions near the one with the least factor"}
    monkeypatch.setattr(moving_load.Places, "run", lambda *_: pytest.fail("a kept position was calculated again"))
    again = moving_load.run(Context(deck, out=tmp_path / "run", resume=True), options)
    for name, array in whole.arrays.items():
        np.testing.assert_array_equal(again.arrays[name].data, array.data)


def test_a_gap_belongs_to_special_vehicles() -> None:
    with pytest.raises(DeckError, match="`gap` is used only with"):
        make_deck({"structure": BRIDGE, "analysis": {"kind": "moving-load", "train": "LM71", "gap": 5.0}})


def test_every_train_of_the_library_has_a_name_of_the_deck() -> None:
    library = tomllib.loads((Path(trains.__file__).parent / "trains.toml").read_text())
    assert {"LM1", *library} == set(get_args(TrainName))


@pytest.mark.parametrize("name", [name for name in get_args(TrainName) if name.startswith("CS454")])
def test_bogies_weigh_what_the_table_of_cs_454_gives(name: str) -> None:
    """Tonnes of Table 7.3.1a; the conversion factors of an axle lift-off keep the sum."""
    tonnes = {"single": 11.5, "double 1.0": 16.0, "double 1.3": 19.0, "double 1.8": 20.0, "triple 1.0": 21.0, "triple 1.3": 24.0}
    found = train_of(MovingLoad(kind="moving-load", train=name), 4.0)
    assert found.forces.sum() == pytest.approx(9810.0 * tonnes[name.removeprefix("CS454 ").removesuffix(" lift")])
    if name.endswith("lift"):
        assert found.forces[0] / found.forces.mean() == pytest.approx(1.5)


@pytest.mark.parametrize("name", [name for name in get_args(TrainName) if name.startswith("MLC")])
def test_a_tracked_vehicle_weighs_the_short_tons_of_its_class(name: str) -> None:
    even = train_of(MovingLoad(kind="moving-load", train=name), 4.0).even
    weight = ((even[:, 1] - even[:, 0]) * even[:, 2]).sum()
    assert weight == pytest.approx(2000.0 * 4.4482216 * float(name[3:].split()[0]), rel=1e-3)
    assert trains.unverified(name)


def of_service(**keys: object) -> dict[str, object]:
    """A moving load on the bridge, its stone as strong as 4 MPa."""
    return {
        "structure": {**BRIDGE, "fill": {"cover": 0.4, "passive": 0.5}},
        "joints": {"friction": 0.6},
        "material": {"compressive_strength": "4 MPa"},
        "analysis": {"kind": "moving-load", "train": "CS454 single", "count": 7, **keys},
    }


def test_the_permissible_limit_state_is_collapse_at_the_permissible_stress() -> None:
    """The same as a deck of half the strength without passive pressure, whatever the partial factors are."""
    both = extrados.run(of_service(serviceability={}, factors={"live": 2.0, "strength": 3.0}))["moving-load"]
    alone = of_service()
    alone["structure"] |= {"fill": {"cover": 0.4}}
    alone["material"] = {"compressive_strength": "2 MPa"}
    collapse = extrados.run(alone)["moving-load"]
    assert both.permissible_factor == pytest.approx(collapse.adequacy_factor, rel=1e-9)
    assert (both.permissible_place_m, both.permissible_stress_Pa) == (collapse.worst_place_m, 2e6)


def test_a_train_beyond_the_permissible_limit_state_leaves_the_verdict_open() -> None:
    run = extrados.run(of_service(serviceability={"live": 10.0, "strength_share": 0.2}))
    assert run["moving-load"].permissible_factor < 1.0
    verdict = run.analyses[0]["verdict"]
    assert verdict["outcome"] == "open" and "permissible limit state" in verdict["violated"][0]


def test_impact_multiplies_the_train_of_the_permissible_limit_state_too() -> None:
    """The dynamic factor is an effect of the motion: as heavy a train without it has the same multiple."""
    still, moving = (
        extrados.run(of_service(count=3, **keys))["moving-load"].permissible_factor
        for keys in ({"serviceability": {"live": 1.5}}, {"serviceability": {}, "factors": {"dynamic": 1.5, "live": 2.0}})
    )
    assert moving == pytest.approx(still, rel=1e-9)


def test_spandrel_walls_thicker_than_the_default_depth_are_refused() -> None:
    """Blocks without a depth are 1 m deep: two walls of 0.6 m would leave soil of negative weight."""
    stone = {"name": "stone", "points": [[0, 0], [1, 0], [1, 1], [0, 1]]}
    keys = {"kind": "blocks", "block": [stone], "fill": {"cover": 0.4}}
    for wall in (0.6, 0.4):
        deck = make_deck({"structure": {**keys, "spandrels": {"thickness": wall}}, "analysis": {"kind": "tilt"}})
        if wall < 0.5:
            assert deck.building.blocks().fill is not None
            continue
        with pytest.raises(BadGeometry, match="leave no space for fill; the depth of 1 m"):
            deck.building.blocks()


def test_the_permissible_limit_state_needs_a_strength_and_a_train() -> None:
    deck = of_service(serviceability={})
    del deck["material"]
    assert "requires compressive_strength" in extrados.run(deck).analyses[0]["reason"]
    with pytest.raises(DeckError, match="serviceability` requires"):
        make_deck({"structure": BRIDGE, "analysis": {"kind": "moving-load", "serviceability": {}}})


def test_spandrel_walls_weigh_in_place_of_fill() -> None:
    """Walls as heavy as the soil change its passive pressure alone, which acts between them."""

    def factor(**keys: object) -> float:
        deck = of_service()
        deck["structure"] |= keys
        return float(extrados.run(deck)["moving-load"].adequacy_factor)

    soil = {"cover": 0.4, "density": 2000.0, "passive": 0.5}
    walls = {"thickness": 0.5, "density": 2000.0}
    assert factor(fill=soil, spandrels=walls) == pytest.approx(factor(fill={**soil, "passive": 0.375}), rel=1e-9)
    with pytest.raises(DeckError, match="leave no space for fill"):
        make_deck({"structure": {**BRIDGE, "spandrels": {"thickness": 2.0}}, "analysis": {"kind": "tilt"}})
    with pytest.raises(DeckError, match="spandrels requires fill"):
        make_deck({"structure": {**BRIDGE, "fill": None, "spandrels": {"thickness": 0.3}}, "analysis": {"kind": "tilt"}})


def test_a_drawn_arch_under_fill_carries_what_the_bridge_of_its_sizes_carries() -> None:
    """The voussoirs of a bridge as polygons, on their skewbacks, under the same earth: weight on them and factor agree."""
    deck = of_service()
    deck["structure"] = {**BRIDGE, "fill": {"cover": 0.4, "passive": 0.5}, "surfacing": {"thickness": 0.1}}
    made = make_deck(deck).structure.assembly(2000.0, Path())
    on_ground = [j for j, pair in enumerate(zip(made.a, made.b, strict=True)) if min(pair) < 0]
    drawn = {
        "kind": "blocks",
        "depth": 4.0,
        "fill": deck["structure"]["fill"],
        "surfacing": deck["structure"]["surfacing"],
        "block": [{"name": n, "points": o.tolist()} for n, o in zip(made.block_names, made.outlines, strict=True)],
        "ground": [[*made.p[j].tolist(), *made.q[j].tolist()] for j in on_ground],
    }
    whole, polygons = (extrados.run({**deck, "structure": one})["moving-load"] for one in (deck["structure"], drawn))
    assert polygons.adequacy_factor == pytest.approx(whole.adequacy_factor, rel=1e-6)
    assert polygons.chain is None and not polygons.violated


@pytest.mark.verify
def test_the_report_names_factors_of_the_permissible_limit_state_and_no_keys(tmp_path: Path) -> None:
    run = extrados.run(CASES / "bridge" / "surveyed.toml", out=tmp_path / "run", figures=True)
    assert run["moving-load"].permissible_factor > 1.0
    page = (tmp_path / "run" / "report.html").read_text()
    assert "permissible stress / compressive strength" in page and "Outcome: stands." in page
    assert "contact_tolerance (6 mm)" not in page and "contact tolerance (6 mm)" in page
