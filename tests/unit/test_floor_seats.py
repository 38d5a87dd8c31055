"""Floors on seats: Coulomb's friction under their weight alone, and the displacement at which they slide off."""

from pathlib import Path

import pytest

import extrados

CASE = Path(__file__).parents[2] / "cases" / "building" / "joists-slide.toml"
ROCKS = """
[structure]
kind = "building"
storeys = [2.0]
walls = [
  { name = "south", start = [0, 0], end = [3, 0], thickness = 0.4 },
  { name = "east", start = [3, 0], end = [3, 3], thickness = 0.4 },
  { name = "north", start = [3, 3], end = [0, 3], thickness = 0.4 },
  { name = "west", start = [0, 3], end = [0, 0], thickness = 0.4 },
]
corners = [
  { walls = ["east", "south"], bond = "open" },
  { walls = ["west", "south"], bond = "open" },
]
beds = [{ name = "sole", walls = ["south"] }]

[[structure.floors]]
storey = 1
kind = "joists"
young = 10e9
joist_area = 0.03
joist_spacing = 0.5
load = 4e3
bears_on = ["south", "north"]
seat = { length = 0.006, friction = FRICTION }

[material]
density = 1800
young = 3e9
poisson = 0.0

[joints]
friction = "no-sliding"
tension = "50 Pa"
fracture_energy = "0.001 N/m"

[[analysis]]
kind = "pushover"
direction = 270
mesh = { size = 1.0, layers = 5 }
drives = [{ wall = "south", storey = 1 }]
"""


def pushed(tmp_path, text: str):
    deck = tmp_path / "deck.toml"
    deck.write_text(text)
    return extrados.run(deck).analyses[0]


@pytest.mark.parametrize(("friction", "direction"), [(0.4, 90), (0.2, 90), (0.2, 0)])
def test_a_floor_slides_at_its_friction_along_and_across_its_walls(tmp_path, friction: float, direction: int) -> None:
    """Forces in proportion to the masses: the floor slides at an acceleration of friction g, whatever the building."""
    text = CASE.read_text().replace("friction = 0.4 }", f"friction = {friction} }}").replace("direction = 90", f"direction = {direction}")
    r = pushed(tmp_path, text)["results"]
    assert r["base_shear_coefficient"] == pytest.approx(friction, rel=2e-3)
    assert sum(seat["normal_N"] for seat in r["seats"]) == pytest.approx(4e3 * 12.0)
    off = [seat["wall"] for seat in r["seats"] if seat["slid_off"]]
    assert off == (["south"] if direction == 90 else [])
    assert r["stop"] == (
        "a floor has slid off its seat" if direction == 90 else "a floor has slid along its walls by the length of its seat"
    )


def test_a_wall_that_rocks_outward_draws_it_from_under_the_joists(tmp_path) -> None:
    """The load is that of rigid bodies: the weights on the wall turn about its edge, and the friction of the seat acts at its top."""
    found = [pushed(tmp_path, ROCKS.replace("FRICTION", str(friction))) for friction in (0.1, 0.3)]
    low, high = (analysis["results"] for analysis in found)
    wall, floor = 1800.0 * 9.80665 * 3.0 * 2.0 * 0.4, 0.5 * 4e3 * 9.0
    assert all(r["stop"] == "a floor has slid off its seat" for r in (low, high))
    assert high["greatest_load_N"] - low["greatest_load_N"] == pytest.approx(0.2 * floor, rel=0.02)
    assert low["greatest_load_N"] == pytest.approx((wall + floor) * 0.4 / (2.0 * 2.0) + 0.1 * floor, rel=0.01)
    assert [seat["normal_N"] for seat in low["seats"]] == pytest.approx([floor, floor])  # to the corners, which are open
    assert "Then floor 1 of storey 1 slides off wall" in found[1]["verdict"]["statement"]


def test_seats_are_refused_where_nothing_rests_on_them(tmp_path) -> None:
    for old, new, words in (
        ('load = "4 kPa"', "", "`load` above 0"),
        ("[[analysis]]\n", '[[analysis]]\nwithout_equilibrium = "load-unload"\n', "seats"),
    ):
        with pytest.raises(Exception, match=words):
            analysis = pushed(tmp_path, CASE.read_text().replace(old, new))
            raise ValueError(analysis["reason"])
