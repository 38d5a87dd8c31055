"""Twenty bad plans of buildings: every complaint names the wall, or the storey, and the place."""

import copy
import re

import pytest

import extrados
from extrados.decks.reader import DeckError, make_deck

GOOD = {
    "structure": {
        "kind": "building",
        "storeys": [3.0, 2.8],
        "walls": [
            {"name": "front", "start": [0, 0], "end": [6, 0], "thickness": 0.4, "openings": [{"storey": 1, "x": [2, 3], "z": [0, 2.2]}]},
            {"name": "right", "start": [6, 0], "end": [6, 5], "thickness": 0.4},
            {"name": "back", "start": [6, 5], "end": [0, 5], "thickness": 0.4},
            {"name": "left", "start": [0, 5], "end": [0, 0], "thickness": 0.4},
        ],
        "floors": [{"storey": k, "kind": "rigid", "load": 4e3, "bears_on": ["front", "back"]} for k in (1, 2)],
    },
    "material": {"density": 1800, "young": 1.5e9, "poisson": 0.25, "compressive_strength": 3e6},
    "joints": {"cohesion": 0.1e6},
    "analysis": [{"kind": "frame-modes"}],
}


def wall(k, **changes):
    return lambda deck: deck["structure"]["walls"][k].update(changes)


def opening(**changes):
    return lambda deck: deck["structure"]["walls"][0]["openings"][0].update(changes)


def also(key, entry):
    return lambda deck: deck["structure"].setdefault(key, []).append(entry)


def rods(**place):
    def change(deck):
        deck["materials"] = {"steel": {"density": 7850, "young": 2e11, "poisson": 0.3}}
        deck["structure"]["rods"] = [{"start": [0, 0, 3], "end": [0, 5, 3], "area": 5e-4, "material": "steel"} | place]

    return change


BAD = {
    "a wall of one point": (wall(1, end=[6, 0]), "same point.*walls 'right'"),
    "a wall without a thickness": (wall(2, thickness=None), "thickness.*walls 'back'"),
    "a negative thickness": (wall(3, thickness=-0.4), "walls.thickness.*walls 'left'"),
    "two names alike": (wall(1, name="front"), "walls.name.*'front' occurs twice"),
    "an opening beyond the wall": (opening(x=[5, 7]), "front"),
    "an opening above the storey": (opening(z=[0, 3.5]), "front"),
    "an opening in a storey that is not there": (opening(storey=3), "front"),
    "an opening over the whole wall": (opening(x=[0, 6]), "wall 'front', storey 1: the openings leave no pier"),
    "an opening upside down": (opening(z=[2.2, 0.5]), "openings.*walls 'front', openings 1"),
    "an opening of no width": (opening(x=[2, 2]), "openings.*walls 'front', openings 1"),
    "a wall that begins above the ground": (wall(1, storeys=[2, 2]), "'right'"),
    "a wall that does not close the ring": (wall(1, end=[6, 4.5]), "storey 1.*ring"),
    "a floor of an unknown wall": (also("floors", {"storey": 1, "kind": "none", "walls": ["front", "right", "attic"]}), "'attic'"),
    "a floor on a storey that is not there": (also("floors", {"storey": 3, "kind": "rigid"}), "storey 3"),
    "a floor that bears on no wall of its": (lambda d: d["structure"]["floors"][0].update(bears_on=["attic"]), "floors.bears_on.*'attic'"),
    "two floors between the same walls": (also("floors", {"storey": 1, "kind": "rigid"}), "storey 1|same walls"),
    "a corner of walls that do not meet": (also("corners", {"walls": ["front", "back"], "bond": "open"}), "'front' and 'back'"),
    "a wall of an unknown material": (wall(0, material="granite"), "granite"),
    "a rod that ends on no wall": (rods(end=[3, 2.5, 3]), r"rod 1: its end at 3, 2.5, 3 m"),
    "a rod of an unknown material": (rods(material="iron"), "iron"),
    "walls in one line against each other": (
        lambda d: d["structure"].update(
            walls=[*d["structure"]["walls"], {"name": "wing", "start": [9, 0], "end": [6, 0], "thickness": 0.4}]
        ),
        "'wing' and 'front'|'front' and 'wing'",
    ),
}


def complaint(change):
    deck = copy.deepcopy(GOOD)
    change(deck)
    try:
        made = make_deck(deck)
        (analysis,) = extrados.run(made, threads=1).analyses
    except DeckError as error:
        return str(error)
    return "" if analysis["status"] == "ok" else analysis["reason"]


def test_the_good_plan_is_answered():
    assert complaint(lambda deck: None) == ""


@pytest.mark.parametrize("name", BAD)
def test_a_bad_plan_is_named_with_wall_and_place(name):
    change, words = BAD[name]
    assert re.search(words, complaint(change), re.DOTALL), complaint(change)
