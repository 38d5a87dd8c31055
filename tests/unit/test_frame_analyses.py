"""Pushovers, modes and motions of buildings as frames of macro-elements, against hand calculations."""

import numpy as np
import pytest

import extrados
from extrados.analyses.frame.modes import Mode
from extrados.analyses.frame.pushover import Push
from extrados.schema.constants import GRAVITY

YOUNG, STRENGTH, DENSITY = 2e9, 4e6, 1800.0


def deck(*analyses, corners="bonded", **changes):
    """A room of 6 by 4 m of one storey, symmetric about both axes, under a rigid floor without load."""
    names = ["front", "right", "back", "left"]
    corners = [{"walls": [a, b], "bond": corners} for a, b in zip(names, names[1:] + names[:1], strict=True)]
    walls = [
        {"name": "front", "start": [0, 0], "end": [6, 0], "thickness": 0.4},
        {"name": "right", "start": [6, 0], "end": [6, 4], "thickness": 0.3},
        {"name": "back", "start": [6, 4], "end": [0, 4], "thickness": 0.4},
        {"name": "left", "start": [0, 4], "end": [0, 0], "thickness": 0.3},
    ]
    structure = {
        "kind": "building",
        "storeys": [3.0],
        "walls": walls,
        "corners": corners,
        "floors": [{"storey": 1, "kind": "rigid"}],
    } | changes
    return {
        "title": "room",
        "structure": structure,
        "material": {"density": DENSITY, "young": YOUNG, "poisson": 0.25, "compressive_strength": STRENGTH},
        "joints": {"cohesion": 0.1e6},
        "analysis": list(analyses),
    }


PUSH = {"kind": "frame-pushover", "patterns": ["uniform"], "eccentricities": [0.0], "frame": {"second_order": False}}


def results(given):
    analysis = extrados.run(given).analyses[0]
    assert analysis["status"] == "ok", analysis["reason"]
    return analysis["results"]


@pytest.mark.parametrize("shear", ["none", "mohr-coulomb"])
def test_walls_that_nothing_joins_resist_by_themselves(shear):
    """Along y both side walls rock under half of their own weight, V = N (L - N/(0.85 f t))/(2 h); or slide on the part that
    rocking leaves pressed, V = (1.5 c L t + mu N)/(1 + 3 c t h/N)."""
    r = results(deck(PUSH | {"frame": {"second_order": False, "drift_flexure": 0.1, "shear": shear}}, corners="open"))
    n, length, t, h, c = 0.5 * DENSITY * GRAVITY * 0.3 * 4.0 * 3.0, 4.0, 0.3, 3.0, 0.1e6
    alone = n * (length - n / (0.85 * STRENGTH * t)) / (2.0 * h)
    if shear == "mohr-coulomb":
        alone = min(alone, (1.5 * c * length * t + 0.4 * n) / (1.0 + 3.0 * c * t * h / n))
    run = next(row for row in r["runs"] if row["name"] == "+y uniform")
    assert run["peak_base_shear_N"] == pytest.approx(2.0 * alone, rel=1e-2)
    assert run["equivalent_mass_kg"] == pytest.approx(r["moving_mass_kg"], rel=1e-6)
    assert run["participation_factor"] == pytest.approx(1.0, rel=1e-6)
    assert run["level_shape"] == pytest.approx([1.0])


def test_flanges_that_hang_on_a_wall_make_it_stronger():
    """The front and back walls hang on the ends of the side walls: at most their weights join in, by the effective width those on
    a fifth of 3 m from the faces of the side walls."""
    given = {"open": {}, "whole": {"frame": {"flanges": "whole"}}, "effective": {}}
    found = {w: results(deck(PUSH | g, corners="open" if w == "open" else "bonded")) for w, g in given.items()}
    low, high, part = (next(row for row in r["runs"] if row["name"] == "+y uniform")["peak_base_shear_N"] for r in found.values())
    # Overturning of all four walls as one body is the most: the weight above the middle of the storey times half the depth
    most = 0.5 * found["whole"]["weight_N"] * 2.0 / 3.0
    assert 1.5 * low < high < 1.02 * most
    lifted = 2.0 * 0.75 * 0.4 * 1.5 * DENSITY * GRAVITY
    assert 0.95 < part / (low + lifted * 4.0 / 3.0) < 1.0


def test_senses_of_a_symmetric_building_are_equal():
    r = results(deck(PUSH | {"eccentricities": [0.0, 0.05, -0.05], "patterns": ["uniform", "static", "modal"]}))
    by_name = {row["name"]: row for row in r["runs"]}
    assert len(by_name) == 36
    for name, row in by_name.items():
        if name.startswith("+"):
            other = by_name["-" + name[1:]]
            assert other["peak_base_shear_N"] == pytest.approx(row["peak_base_shear_N"], rel=1e-4)
    for name in ("+x", "+y"):
        # One storey: all patterns are the same; and an eccentricity to either side
        same = [by_name[f"{name} {pattern}"]["peak_base_shear_N"] for pattern in ("uniform", "static", "modal")]
        assert same == pytest.approx([same[0]] * 3, rel=1e-4)
        sides = [by_name[f"{name} uniform, eccentricity {e} %"]["peak_base_shear_N"] for e in ("+5", "-5")]
        assert sides[0] == pytest.approx(sides[1], rel=1e-4)
        assert max(sides) <= same[0] * (1 + 1e-4)


def test_a_storey_loses_its_strength_at_the_drift_limit_of_its_piers():
    """Side walls in shear: both fail at 0.5 % of the height, and the base shear falls there."""
    shear = {"second_order": False, "diagonal_strength": 5e3}
    r = results(deck(PUSH | {"frame": shear, "directions": [90.0], "senses": ["+"]}))
    (run,) = r["runs"]
    assert [row["mode"] for row in run["failed"]] == ["shear", "shear"]
    side = next(row for row in run["storeys"] if row["wall"] == "right")
    assert side["all_at_limit_m"] == pytest.approx(0.005 * 3.0, rel=0.05)
    assert side["first_at_strength_m"] < 0.2 * side["all_at_limit_m"]
    assert run["ultimate_displacement_m"] == pytest.approx(side["all_at_limit_m"], rel=1e-6)
    assert run["stop"] == "loss of strength"


def test_modes_of_a_room():
    """Frequency along y by the Timoshenko stiffness of both cantilever walls, half of the elastic one, over the moving mass."""
    r = results(deck({"kind": "frame-modes", "modes": 3}, corners="open"))
    e, g, t, length, h = 0.5 * YOUNG, 0.5 * YOUNG / 2.5, 0.3, 4.0, 3.0
    stiff = 2.0 / (h**3 / (3 * e * t * length**3 / 12) + 1.2 * h / (g * length * t))
    mass = 0.5 * DENSITY * 3.0 * 2 * (6 * 0.4 + 4 * 0.3)
    assert r["moving_mass_kg"] == pytest.approx(mass, rel=1e-9)
    along_y = max(r["modes"], key=lambda m: m["mass_ratio_y"])
    assert along_y["mass_ratio_y"] == pytest.approx(1.0, abs=1e-6)
    assert along_y["frequency_Hz"] == pytest.approx(np.sqrt(stiff / mass) / (2 * np.pi), rel=2e-3)


def test_a_history_does_not_hang_on_its_step():
    motion = {"kind": "sine-pulse", "amplitude": "0.2 g", "period": 0.25}
    peaks = []
    for step in (0.004, 0.001):
        given = deck({"kind": "frame-history", "direction": 90.0, "time_step": step})
        r = results(given | {"motion": motion})
        assert r["stop"] == "target displacement"
        peaks.append(r["peak_displacement_m"])
    assert peaks[0] == pytest.approx(peaks[1], rel=0.05)


def test_a_wall_that_nothing_joins_and_bad_plans_are_reported():
    walls = [{"name": "a", "start": [0, 0], "end": [4, 0], "thickness": 0.3}]
    given = deck(PUSH | {"directions": [0.0]})
    given["structure"] |= {"walls": walls, "corners": [], "floors": []}
    assert results(given)["piers"] == 1
    given["analysis"][0]["control_level"] = 2
    analysis = extrados.run(given).analyses[0]
    assert analysis["status"] == "refused" and "`control_level` is 2" in analysis["reason"]


@pytest.mark.parametrize(
    ("direction", "sense", "name"), [(0.0, "+", "+x uniform"), (90.0, "-", "-y uniform"), (113.0, "-", "113 deg, sense -, uniform")]
)
def test_a_push_in_a_skew_direction_names_its_sense(direction, sense, name):
    """A sign before the angle reads as a negative angle."""
    push = Push(direction, sense, "uniform", 0.0, np.zeros(3), np.zeros(3), Mode(np.zeros(3), 1.0, np.zeros(2), 1.0), np.zeros(3))
    assert push.name == name
