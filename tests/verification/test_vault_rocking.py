"""A buttressed vault that rocks by its collapse mechanism beside discrete elements, which know no mechanism.

Stiff joints, friction that does not let them slide. Until the first impact both move by the same mechanism; after it
the blow opens hinges of its own (the returning buttress swings inward), which one coordinate cannot follow.
"""

from functools import cache
from pathlib import Path

import numpy as np
import pytest

from extrados.analyses.dem import model as dem_model
from extrados.analyses.dem.from_deck import joint_values
from extrados.analyses.rocking.failure_domain import shortest_durations
from extrados.core import dem
from extrados.decks.reader import read_deck
from extrados.model.properties import Joints, Material
from extrados.motions import pulses
from extrados.schema.constants import GRAVITY
from extrados.views.rockers.mechanism import MechanismModel

ROOT = Path(__file__).resolve().parents[2]
#: Rotation of a buttress that counts as rocking [rad]
ROCKS = 2e-3


@cache
def vault():
    return read_deck(ROOT / "cases" / "vault" / "dejong-a.toml").building.blocks()


@cache
def elements(modulus: float) -> dem_model.Model:
    building = read_deck(ROOT / "cases" / "vault" / "dejong-a.toml").building
    building = building.having(material=Material(young=modulus), joints=Joints(friction=2.0))
    return dem_model.Model(building.blocks(), building.rigid(), joint_values(building))


def falls(modulus: float, amplitude: float, duration: float) -> int:
    """0 where it stands, 2 where it falls in the first swing of the leading buttress, 1 where it falls later."""
    model = elements(modulus)
    pulse = pulses.step_pulse(amplitude * GRAVITY, duration)
    options = dem.Options(end_time=pulse.end + 8.0, output_step=0.02, collapse=0.2 * model.size, stop_at_rest=True)
    run = dem.run(model.bodies(), options, pulse.ground)
    if run.reason not in ("collapse", "left"):
        return 0
    leading = vault().buttresses[0]  # the ground goes to +x, the structure rocks to -x
    turn = run.place[:, leading, 2] - run.settled[leading, 2]
    risen = np.flatnonzero(turn > ROCKS)
    return 1 if len(risen) and (turn[risen[0] :] < 0.0).any() else 2


def rocker(amplitudes, rule="energy-safe") -> tuple[np.ndarray, np.ndarray]:
    model = MechanismModel(vault(), rule)
    return shortest_durations(
        model.body, "step", np.array(amplitudes) * GRAVITY, np.linspace(0.02, 4.0, 400), 40.0 * model.time_unit, 1e-4, 1
    )


@pytest.mark.verify
@pytest.mark.parametrize(("amplitude", "modulus", "differ"), [(0.25, 1e11, 0.10), (0.25, 1e12, 0.07)])
def test_first_swing_against_discrete_elements(amplitude: float, modulus: float, differ: float) -> None:
    """The shortest pulse that overturns it at once: elements are softer, and come nearer the stiffer they are."""
    ours = rocker([amplitude])[1][0]
    low, high = 0.7 * ours, 1.1 * ours
    assert falls(modulus, amplitude, high) == 2 and falls(modulus, amplitude, low) != 2
    while high - low > 0.005:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if falls(modulus, amplitude, middle) == 2 else (middle, high)
    assert 0.0 < ours / high - 1.0 < differ


@pytest.mark.verify
@pytest.mark.parametrize("amplitude", [0.2, 0.25])
def test_failure_after_an_impact_lies_between_the_impact_rules(amplitude: float) -> None:
    """Keeping what the other mechanism takes (1 % of the energy) is too little, keeping what the blow leaves too much."""
    safe, inelastic = rocker([amplitude])[0][0], rocker([amplitude], "inelastic")[0][0]
    theirs = next(t for t in np.arange(0.8 * inelastic, 1.1 * safe, 0.04) if falls(1e11, amplitude, float(t)))
    assert inelastic < theirs < safe
    assert falls(1e11, amplitude, float(theirs)) == 1
