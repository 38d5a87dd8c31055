"""Impact rules of the arch beside discrete elements, over thickness and embrace: the map of docs/theory.md (`make impact-map`).

An arch of stiff joints (1e12 Pa/m) starts at a tenth of its critical rotation and swings back. `swing` is the root of the
potential energy at the next standstill over that at the start, `blow` the root of the energy after over that before the
greatest loss: what happens on the way back, where hinges move, is in the first and not in the second.
"""

from dataclasses import dataclass

import numpy as np
import pytest

import extrados
from extrados.model.structures.arch import make_arch
from extrados.views.rockers.arch import ArchModel, Impacts
from extrados.views.rockers.mechanism import MechanismModel

pytestmark = pytest.mark.verify

RATIO = 0.1
EMBRACES = (120.0, 130.0, 140.0, 150.0, 157.5, 165.0, 170.0, 175.0, 180.0, 185.0)
#: t/R -> the least and the greatest embrace of arches that stand, and do not lock as they rock
ROCK = {0.07: (120.0, 157.5), 0.10: (120.0, 175.0), 0.12: (120.0, 185.0), 0.15: (120.0, 185.0), 0.20: (120.0, 185.0), 0.25: (150.0, 185.0)}
ARCHES = [(t, e) for t, (least, greatest) in ROCK.items() for e in EMBRACES if least <= e <= greatest]


@dataclass(frozen=True)
class Measured:
    """c_v by each rule and as measured in discrete elements."""

    rules: Impacts
    swing: float
    blow: float


def measured(thickness: float, embrace: float) -> Measured:
    """An arch of R 1 m released from a tenth of its critical rotation."""
    voussoirs = 13 if embrace < 160.0 else 17
    arch = make_arch(1.0, thickness, embrace, voussoirs)
    mechanism = MechanismModel(arch)
    quarter = np.arccosh(1.0 / (1.0 - RATIO)) * mechanism.time_unit
    run = extrados.run(
        {
            "structure": {"kind": "arch", "radius": 1.0, "thickness": thickness, "embrace": embrace, "voussoirs": voussoirs},
            "joints": {"friction": 2.0, "normal_stiffness": 1e12},
            "initial": {"rotation_ratio": RATIO},
            "analysis": [{"kind": "dem", "end_time": 3.5 * quarter, "output_step": max(quarter / 400.0, 1e-5)}],
        },
        threads=1,
    )
    time, potential, kinetic = (np.array(run.array("dem", name)) for name in ("time", "potential_energy", "kinetic_energy"))
    rest, start = mechanism.coefficients(1, [0.0, RATIO * mechanism.critical[0]]).potential
    potential = potential - potential[0] + start - rest
    hit = int(np.argmax(np.where(time < 1.5 * quarter, kinetic, 0.0)))
    later = (time > time[hit] + 0.02 * quarter) & (time < time[hit] + 2.2 * quarter)
    still = int(np.argmax(np.where(later, potential, -np.inf)))
    return Measured(
        ArchModel(arch).impacts,
        float(np.sqrt(max(potential[still], 0.0) / potential[0])),
        float(np.sqrt((potential[still] + kinetic[still]) / (potential[hit] + kinetic[hit]))),
    )


def test_the_impact_at_all_joints_is_nearest_to_discrete_elements() -> None:
    found = [measured(*one) for one in ARCHES]
    print("t/R   deg    thesis  energy-safe  inelastic  swing  blow")
    for (thickness, embrace), m in zip(ARCHES, found, strict=True):
        r = m.rules
        print(f"{thickness:.2f}  {embrace:5.1f}  {r.thesis:6.3f}  {r.energy_safe:11.3f}  {r.inelastic:9.3f}  {m.swing:.3f}  {m.blow:.3f}")
    blow = np.array([m.blow for m in found])
    rms = {}
    for rule in ("thesis", "energy-safe", "inelastic"):
        error = np.clip([m.rules.by_rule[rule] for m in found], 0.0, 1.0) - blow
        rms[rule] = float(np.sqrt((error**2).mean()))
        print(f"{rule}: bias {error.mean():+.3f}, root mean square {rms[rule]:.3f}, greatest {np.abs(error).max():.3f}")
    assert rms["inelastic"] < 0.13
    assert rms["inelastic"] < 0.7 * min(rms["thesis"], rms["energy-safe"])
