"""The building of Yi and others (dissertation 4.4.2): what flanges give to walls 1 and 2, and how its cracks run."""

import tomllib
from copy import deepcopy
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import extrados

DECK = Path(__file__).parents[2] / "cases" / "building" / "yi-band.toml"


def pushed(walls: list[str]) -> Any:
    """The push to +x of the building, or of some of its walls alone, elements of 600 mm."""
    deck = deepcopy(tomllib.loads(DECK.read_text()))
    (analysis,) = deck["analysis"]
    del analysis["variants"]
    structure = deck["structure"]
    structure["walls"] = [wall for wall in structure["walls"] if wall["name"] in walls]
    if len(walls) < 4:
        del structure["floors"]
        analysis["drives"] = [drive for drive in analysis["drives"] if drive["wall"] in walls]
    return extrados.run(deck).results[0]


@pytest.mark.verify
def test_flanges_make_the_walls_stronger_and_cracks_wrap_round() -> None:
    """Both walls bear more with the building around them, wall 2 gains more, and the main crack of wall 1 goes on in wall A.

    Dissertation: "the greater shear capacity of the full 3D structure when compared to the 2D walls alone ... wall 2
    benefits more from the rest of the structure than wall 1"; "a principle crack wrapping around the corner between
    wall 1 and wall A".
    """
    whole = pushed(["1", "B", "2", "A"])
    shear = {row.wall: row.shear_N for row in whole.results.walls}
    gain = {name: shear[name] / pushed([name]).results.walls[0].shear_N for name in "12"}
    print(f"with flanges over alone: wall 1 {gain['1']:.2f}, wall 2 {gain['2']:.2f}")
    assert gain["1"] > 1.1 and gain["2"] > 1.3 * gain["1"]
    assert any("not the base shear" in text for text in whole.warnings)
    number = {row.wall: k for k, row in enumerate(whole.results.walls)}
    # The curves of single walls, Fig. 4-14: wall 1 reaches its peak before wall 2. The floor moves by 0.8 of the roof: the load is
    # the work of both drives over the displacement of the roof, up to 14 % less than the shear of the walls
    held = whole["event_equilibrium"][whole["state_event"] - 1] > 0
    carried = whole["state_wall_shear"][held]
    assert held.sum() > 10
    over = carried.sum(axis=1) / whole["state_load"][held]
    assert 1.0 < over.min() and over.max() < 1.16
    assert carried[:, number["1"]].argmax() < carried[:, number["2"]].argmax()
    of, s, z = (whole[f"place_{name}"] for name in ("wall", "s", "z"))
    last = int(np.flatnonzero(whole["event_equilibrium"][whole["state_event"] - 1] > 0)[-1])
    width = whole["state_width"][last]
    wide = width > 0.2 * width.max()
    corner = {name: z[wide & (of == number[name]) & (s < 0.6)] for name in ("1", "A")}  # both start at the corner
    assert len(corner["1"]) and len(corner["A"])
    assert np.abs(corner["1"][:, None] - corner["A"]).min() < 0.6
