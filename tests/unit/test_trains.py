"""Trains of the library: total weights and lengths that the rules state, and a span that one axle alone decides."""

import numpy as np
import pytest

import extrados
from extrados.analyses.limit.tables import MovingLoad
from extrados.analyses.limit.trains import train_of
from extrados.decks.reader import DeckError, make_deck


@pytest.mark.parametrize(
    ("train", "gap", "weight", "length"),
    [
        ("LM71", None, 1000.0, 4.8), ("SV80", None, 780.0, 6.0), ("SV80", 9.0, 780.0, 13.8), ("SV100", 5.0, 990.0, 9.8),
        ("SV196", None, 1945.0, 19.6), ("SV196", 5.0, 1945.0, 23.4),
    ],
)  # fmt: skip
def test_axles_have_the_weight_and_length_of_the_rule(
    train: str, gap: float | None, weight: float, length: float
) -> None:
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


BRIDGE = {
    "kind": "bridge",
    "depth": 4.0,
    "spans": [{"span": 6.0, "rise": 1.5, "thickness": 0.5, "voussoirs": 20}],
    "fill": {"cover": 0.4},
}


def test_a_special_vehicle_is_its_axles_and_says_that_nobody_read_the_clause() -> None:
    """The same axles written into the deck give the same factor."""
    own = {"axles": [0.0, 1.2, 2.4, 7.4, 8.6, 9.8], "axle_loads": [165e3] * 6}
    named, given = (
        extrados.run({"structure": BRIDGE, "joints": {"friction": 0.6}, "analysis": {"kind": "moving-load", "count": 7, **one}})
        for one in ({"train": "SV100", "gap": 5.0}, own)
    )  # fmt: skip
    assert named["moving-load"].adequacy_factor == pytest.approx(given["moving-load"].adequacy_factor, rel=1e-9)
    assert "not read in the standard" in named.analyses[0]["warnings"][0] and not given.analyses[0]["warnings"]


def test_a_gap_belongs_to_special_vehicles() -> None:
    with pytest.raises(DeckError, match="gap belongs to"):
        make_deck({"structure": BRIDGE, "analysis": {"kind": "moving-load", "train": "LM71", "gap": 5.0}})
