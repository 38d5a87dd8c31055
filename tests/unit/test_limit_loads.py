"""Loads of limit analysis beside weight and fill: oblique, spread, swaying; against moments about the toe."""

import pytest

from extrados.analyses.context import Context
from extrados.analyses.sequence import run_analyses
from extrados.decks.reader import make_deck
from extrados.results.model import Result
from extrados.schema.constants import GRAVITY

WIDTH, HEIGHT = 1.0, 4.0
WEIGHT = 2000.0 * WIDTH * HEIGHT * GRAVITY
BLOCK = {"kind": "column", "width": WIDTH, "height": HEIGHT}


def tilt(load: list[dict], structure: dict = BLOCK, **more) -> Result:
    deck = {"structure": structure, "joints": {"friction": "no-sliding"}, "analysis": {"kind": "tilt", "load": load, **more}}
    return run_analyses(Context(make_deck(deck), threads=1))[0]


def capacity(load: list[dict], **more) -> tuple[float, float]:
    result = tilt(load, **more)
    return result["collapse_acceleration_g"], result["collapse_acceleration_opposite_g"]


def test_what_sways_pushes() -> None:
    """A floor on top of a wall steadies it by its weight and, where it sways, pushes it at its own height."""
    floor = {"x": 0.2, "force": 20e3}
    rests = WEIGHT * 0.5 * WIDTH + 20e3 * 0.3  # about the right toe at x = 0.5
    assert capacity([floor])[0] == pytest.approx(rests / (WEIGHT * 0.5 * HEIGHT))
    swaying = capacity([floor | {"sways": True}])
    assert swaying[0] == pytest.approx(rests / (WEIGHT * 0.5 * HEIGHT + 20e3 * HEIGHT))
    other = WEIGHT * 0.5 * WIDTH + 20e3 * 0.7
    assert swaying[1] == pytest.approx(other / (WEIGHT * 0.5 * HEIGHT + 20e3 * HEIGHT))
    low = capacity([floor | {"sways": True, "y": 1.0}])
    assert low[0] == pytest.approx(rests / (WEIGHT * 0.5 * HEIGHT + 20e3 * 1.0))


def test_oblique_and_horizontal() -> None:
    """A thrust at a height overturns one way and holds the other."""
    thrust = {"x": -0.5, "y": 3.0, "horizontal": 2e3, "force": 1e3}
    forth, back = capacity([thrust])
    turns = WEIGHT * 0.5 * HEIGHT
    assert forth == pytest.approx((WEIGHT * 0.5 + 1e3 * 1.0 - 2e3 * 3.0) / turns)
    assert back == pytest.approx((WEIGHT * 0.5 + 2e3 * 3.0) / turns)


def test_spread_over_many_stones() -> None:
    """Even load on an arch: the sum of many small ones; on one block it acts at its middle."""
    one, spread = capacity([{"x": 0.1, "force": 9e3}]), capacity([{"x": -0.1, "x_end": 0.3, "force": 9e3}])
    assert spread == pytest.approx(one, rel=1e-9)
    arch = {"kind": "arch", "radius": 5.0, "thickness": 0.7, "embrace": 160.0, "voussoirs": 15}
    left, right, count = -4.0, 1.0, 1000
    step = (right - left) / count
    many = [{"x": left + (k + 0.5) * step, "force": 30e3 / count} for k in range(count)]
    whole = capacity([{"x": left, "x_end": right, "force": 30e3}], structure=arch)
    assert whole == pytest.approx(capacity(many, structure=arch), rel=1e-3)
    assert whole != pytest.approx(capacity([], structure=arch), rel=1e-2)


def test_wrong_loads_are_reported() -> None:
    result = tilt([{"x": 7.0, "force": 1e3}])
    assert result.status == "refused" and "lies outside the structure" in result.reason
    result = tilt([{"x": 0.0, "y": 9.0, "force": 1e3}])
    assert result.status == "refused" and "acts on no block" in result.reason


def test_figures_know_the_loads_and_the_line_through_every_stone() -> None:
    """Loads at rest in pieces that add up to them; under a moving load every stone that carries something has its line."""
    load = [{"x": -0.5, "x_end": 0.5, "force": 12e3}, {"x": -0.5, "y": 3.5, "force": 1e3, "horizontal": 2e3}]
    arrays = tilt(load).arrays
    force, number = arrays["load_force"].data, arrays["load_number"].data
    assert [force[number == k].sum(axis=0).tolist() for k in (0, 1)] == [[0.0, -12e3], [2e3, -1e3]]
    points = [
        [[0, 0], [0.8, 0], [0.8, 2], [0, 2]],
        [[2, 0], [2.8, 0], [2.8, 2], [2, 2]],
        [[0.4, 2], [1.4, 2], [1.5, 2.4], [0.4, 2.4]],
        [[1.4, 2], [2.4, 2], [2.4, 2.4], [1.5, 2.4]],
        [[0, 2], [0.4, 2], [0.4, 3.4], [0, 3.4]],
        [[2.4, 2], [2.8, 2], [2.8, 3.4], [2.4, 3.4]],
    ]
    stones = [{"name": f"stone {k}", "points": outline} for k, outline in enumerate(points)]
    found = run_analyses(
        Context(
            make_deck(
                {
                    "structure": {"kind": "blocks", "block": stones},
                    "joints": {"friction": 0.6},
                    "analysis": {"kind": "moving-load", "count": 5},
                }
            ),
            threads=1,
        )
    )[0]
    assert set(found.arrays["collapse_line_of"].data) == {f"stone {k}" for k in range(6)}
