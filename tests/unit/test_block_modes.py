"""Natural frequencies of plane blocks: a cantilever in closed form, refinement, scale, participating masses."""

import numpy as np
import pytest

import extrados
from extrados.show.frame import draw_modes

YOUNG, DENSITY = 2e9, 2000.0


def modes(structure, count=6, **joints):
    deck = {
        "structure": structure,
        "material": {"density": DENSITY, "young": YOUNG, "poisson": 0.2},
        "analysis": {"kind": "modes", "modes": count},
    } | ({"joints": joints} if joints else {})
    (analysis,) = extrados.run(deck, threads=1).analyses
    assert analysis["status"] == "ok", analysis["reason"]
    return analysis["results"]["modes"]


def pile(count, width=0.2, height=4.0):
    h = height / count
    blocks = [{"name": f"{k}", "points": [[0, k * h], [width, k * h], [width, (k + 1) * h], [0, (k + 1) * h]]} for k in range(count)]
    return {"kind": "blocks", "depth": 0.3, "ground": [[0, 0, width, 0]], "block": blocks}


def arch(voussoirs, size=1.0):
    return {"kind": "arch", "radius": 2.0 * size, "thickness": 0.2 * size, "embrace": 160.0, "voussoirs": voussoirs}


def test_a_slender_pile_is_a_cantilever():
    """Bending: (1.8751/H)^2 sqrt(E I/m)/(2 pi); along the axis sqrt(E/rho)/(4 H)."""
    found = modes(pile(40), 10)
    bending = 1.8751041**2 / (2 * np.pi * 4.0**2) * np.sqrt(YOUNG / DENSITY) * 0.2 / np.sqrt(12.0)
    assert found[0]["frequency_Hz"] == pytest.approx(bending, rel=0.01)
    along = max(found, key=lambda m: m["mass_ratio_y"])
    assert along["frequency_Hz"] == pytest.approx(np.sqrt(YOUNG / DENSITY) / 16.0, rel=0.01)
    assert along["mass_ratio_y"] == pytest.approx(8.0 / np.pi**2, rel=0.01)


def test_short_voussoirs_converge_and_all_modes_move_all_mass():
    coarse, fine, finer = (modes(arch(n), 2)[0]["frequency_Hz"] for n in (16, 48, 96))
    assert coarse == pytest.approx(finer, rel=0.05) and fine == pytest.approx(finer, rel=0.005)
    every = modes(arch(10), 30)
    for key in ("mass_ratio_x", "mass_ratio_y"):
        assert sum(mode[key] for mode in every) == pytest.approx(1.0, abs=1e-9)


def test_frequencies_fall_with_size_and_with_soft_joints():
    assert modes(arch(16, 3.0))[0]["frequency_Hz"] == pytest.approx(modes(arch(16))[0]["frequency_Hz"] / 3.0)
    # joints as soft as a metre of block: a column of n blocks of height h has the modulus E h/(h + 1)
    stiff = YOUNG / 1.0
    soft, firm = (modes(pile(40), 1, **joints)[0]["frequency_Hz"] for joints in ({"normal_stiffness": stiff, "shear_stiffness": stiff}, {}))
    assert soft == pytest.approx(firm * np.sqrt(0.1 / 1.1), rel=0.03)  # the whole joint at the foot counts: 1/n


def test_stiffness_of_a_type_of_joints_is_that_of_these_joints():
    every = [f"joint {k}" for k in range(17)]
    typed = modes(arch(16), types=[{"joints": every, "normal_stiffness": 1e9}])
    assert typed == modes(arch(16), normal_stiffness=1e9) != modes(arch(16))
    one = modes(arch(16), types=[{"joints": every[:1], "normal_stiffness": 1e9}])
    assert typed[0]["frequency_Hz"] < one[0]["frequency_Hz"] < modes(arch(16))[0]["frequency_Hz"]


def test_shear_stiffness_is_by_default_a_part_of_the_normal_one():
    default = modes(arch(16), normal_stiffness=1e9)
    assert default == modes(arch(16), normal_stiffness=1e9, shear_stiffness=1e9)  # shear_ratio is 1
    assert modes(arch(16), normal_stiffness=1e9, shear_ratio=0.1)[0]["frequency_Hz"] < default[0]["frequency_Hz"]


def test_figure_of_the_case(tmp_path):
    run = extrados.run("cases/arch/modes.toml")
    ((file, caption),) = draw_modes(run, "modes", tmp_path)
    assert "of the blocks" in caption and any(tmp_path.iterdir()) and file
