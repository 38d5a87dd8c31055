"""Frames for other programs: names that are no commands, strengths, and what is left out."""

import re

import pytest
from test_frame_analyses import deck

from extrados.bridges.forms import exported
from extrados.decks.reader import make_deck


def script(form="opensees-frame", name="front", **frame):
    data = deck({"kind": "frame-pushover", "frame": frame})
    data["structure"]["walls"][0]["name"] = name
    for corner in data["structure"]["corners"]:
        corner["walls"] = [name if wall == "front" else wall for wall in corner["walls"]]
    return exported(make_deck(data), form)


def test_names_of_walls_are_no_commands():
    name = "a\nexec touch [b]; $c \\"
    for form in ("opensees-frame", "frame-tables"):
        lines = script(form, name).splitlines()
        assert not any(line.startswith("exec") or line.endswith("\\") for line in lines)
        assert any("a_exec touch _b__ _c _" in line for line in lines)


@pytest.mark.parametrize("shear, least, most", [("none", 1e12, 1e12), ("mohr-coulomb", 1e5, 1e5)])
def test_strength_in_shear_of_a_pier(shear, least, most):
    found = re.findall(r"-pier (.*)", script(shear=shear, friction=0.3))
    values = [[float(x) for x in line.split()[:8]] for line in found]
    assert values and all(least <= v[7] <= most for v in values)
    assert all(v[6] == 0.3 for v in values)


@pytest.mark.parametrize("form", ["opensees-frame", "frame-tables"])
def test_tie_rods_are_neglected_in_so_many_words(form, caplog):
    floor = {"storey": 1, "young": 5e7, "thickness": 0.05, "load": 4e3}
    data = deck({"kind": "frame-pushover"}, floors=[floor])
    data["structure"]["rods"] = [{"start": [0, 0, 3], "end": [6, 4, 3], "area": 5e-4, "material": "steel"}]
    data["materials"] = {"steel": {"young": 2e11}}
    text = exported(make_deck(data), form)
    assert "tie rod, stiffness 1.38675e+07 N/m" in text and "not exported: 1 links of tie rods" in caplog.text
