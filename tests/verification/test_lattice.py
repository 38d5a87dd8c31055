"""Sequentially linear analysis of a continuum beside that of a lattice of bars (dissertation 8.3)."""

import tomllib
from pathlib import Path

import pytest
from lattice_oracle import Wall, push

import extrados

DECK = Path(__file__).parents[2] / "cases" / "sla" / "lattice-wall.toml"


@pytest.mark.verify
def test_a_lattice_of_bars_has_the_peak_and_the_plateau_of_the_continuum() -> None:
    """Peak and load at 6 mm within 8 %, from above and nearer with shorter bars; displacement at the peak within 3 %."""
    (sla,) = extrados.run(tomllib.loads(DECK.read_text(encoding="utf-8"))).results
    wall = Wall(1.0, 2.0, 0.25, 1.7e9, 0.2e6, 50.0, 0.3e6, 1800.0)
    coarse, fine = (push(wall, a, 6e-3) for a in (0.125, 0.0625))
    peak = sla.results.greatest_load_N
    assert peak < fine[1].max() < coarse[1].max()
    assert fine[1].max() == pytest.approx(peak, rel=0.08)
    assert fine[1][-1] == pytest.approx(sla["envelope_load"][-1], rel=0.08)
    assert fine[0][fine[1].argmax()] == pytest.approx(sla.results.greatest_load_displacement_m, rel=0.03)
