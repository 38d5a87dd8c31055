"""Ten arches under twenty random pulses each, and how they end in discrete elements, which know no hinges.

R 1 m, stiff joints (1e12 Pa/m), friction that does not let them slide. Amplitudes lie between 1.1 and 4 times the capacity,
periods between 0.7 and 4 times the arch's own time (1/p of a block), both spread evenly over their logarithms.
"""

import fcntl
import os
import tempfile
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from functools import cache, cached_property
from pathlib import Path

import numpy as np

from extrados.analyses.context import Context
from extrados.analyses.dem import model as dem_model
from extrados.analyses.dem.from_deck import joint_values
from extrados.analyses.rocking.hand_over import Fates, Leaving, Left, contacts_of
from extrados.core import arch as core_arch
from extrados.core import dem, rocking
from extrados.core.ground import Ground
from extrados.decks.reader import Deck, make_deck
from extrados.model.structures.arch import ArchAssembly, make_arch
from extrados.motions import pulses
from extrados.motions.motion import Motion
from extrados.results.rocking import COLLAPSE
from extrados.schema.constants import GRAVITY
from extrados.views.rockers.arch import ArchModel
from extrados.views.rockers.mechanism import MechanismModel

#: t/R, embrace in degrees, voussoirs.
ARCHES = [
    (0.08, 120.0, 11),
    (0.10, 130.0, 12),
    (0.10, 145.0, 13),
    (0.12, 150.0, 13),
    (0.12, 160.0, 14),
    (0.14, 157.5, 14),
    (0.15, 170.0, 16),
    (0.18, 165.0, 15),
    (0.18, 175.0, 17),
    (0.22, 175.0, 17),
]
SHAPES: dict[str, tuple[int, Callable[[float, float], Motion]]] = {
    "sine": (10, pulses.sine_pulse),
    "step": (4, lambda amplitude, period: pulses.step_pulse(amplitude, period / 3.0)),
    "half-sine": (3, lambda amplitude, period: pulses.pulse("half-sine", amplitude, period)),
    "ricker": (3, lambda amplitude, period: pulses.pulse("ricker", amplitude, period)),
}
RULES = ("thesis", "energy-safe", "inelastic")
#: After the pulse, in times of the arch.
REST = 40.0
#: Of the arch's size: a displacement that is collapse.
FALLEN = 0.2


class AtRest(Leaving):
    """A mechanism that is left before it moves."""

    def leave(self, ground: Ground, end_time: float, scale: float) -> Left:
        return Left(0.0, False, 0, 0.0, 0.0)


@dataclass(frozen=True)
class Sample:
    """An arch and its pulses: (shape, motion)."""

    thickness: float
    embrace: float
    voussoirs: int
    seed: int

    @cached_property
    def arch(self) -> ArchAssembly:
        return make_arch(1.0, self.thickness, self.embrace, self.voussoirs)

    @cached_property
    def model(self) -> ArchModel:
        return ArchModel(self.arch)

    @cached_property
    def time_unit(self) -> float:
        return MechanismModel(self.arch).time_unit

    @cached_property
    def pulses(self) -> list[tuple[str, Motion]]:
        draw = np.random.default_rng(self.seed)
        capacity = self.model.collapse[0].gamma * GRAVITY
        return [
            (shape, make(capacity * 1.1 * (4.0 / 1.1) ** draw.random(), self.time_unit * 0.7 * (4.0 / 0.7) ** draw.random()))
            for shape, (count, make) in SHAPES.items()
            for _ in range(count)
        ]

    def rocks_down(self, rule: str, scale: float = 1.0) -> np.ndarray:
        """Which pulses times `scale` bring it down by fixed hinges (pulses,); c_v of the rule held between 0 and 1."""
        c_v = float(np.clip(self.model.impacts.by_rule[rule], 0.0, 1.0))
        grounds = [motion.ground for _, motion in self.pulses]
        ends = np.array([motion.end + REST * self.time_unit for _, motion in self.pulses])
        runs = np.arange(len(grounds))
        found = rocking.ensemble(
            [rocking.arch_body(self.model.four_hinge, c_v)], grounds, np.zeros_like(runs), runs, np.full(len(runs), scale), ends
        )
        return np.array([rocking.OUTCOMES[k] == "collapse" for k in found.outcome])

    def outside(self, motion: Motion) -> float:
        """Share of the rocking time in which the dynamic thrust line leaves a joint by more than 1 % of it."""
        run = rocking.history(self.model.body, motion.ground, motion.end + REST * self.time_unit, self.time_unit / 50.0)
        side = np.sign(run.rotation)
        moving = side != 0.0
        if not moving.any():
            return 0.0
        s = side[moving]
        line = core_arch.thrust_line(
            self.model.four_hinge,
            self.arch,
            s * run.rotation[moving],
            s * run.rate[moving],
            s * run.acceleration[moving],
            s * run.ground[moving],
            run.vertical[moving],
        )
        return float((np.abs(line.position - 0.5).max(axis=1) > 0.51).mean())

    @cached_property
    def deck(self) -> Deck:
        """The arch as a deck."""
        sizes = {"radius": 1.0, "thickness": self.thickness, "embrace": self.embrace, "voussoirs": self.voussoirs}
        joints = {"friction": 2.0, "normal_stiffness": 1e12}
        return make_deck({"structure": {"kind": "arch", **sizes}, "joints": joints, "analysis": {"kind": "failure-domain"}})

    def handed(self) -> tuple[np.ndarray, np.ndarray]:
        """Which pulses bring it down (pulses,): by its mechanism and rigid contacts from where a condition fails, and by rigid contacts
        from rest."""
        building = self.deck.building
        contacts = contacts_of(building.rocker(), building)
        assert contacts is not None
        fates = Fates.of(Context(self.deck), contacts)
        leaving = Fates.of(Context(self.deck), replace(contacts, leaving=AtRest(**vars(contacts.leaving))))
        found = [
            [one.follow(motion.ground, 1.0, motion.end + REST * self.time_unit).outcome == COLLAPSE for one in (fates, leaving)]
            for _, motion in self.pulses
        ]
        return tuple(np.array(found).T)

    @cached_property
    def elements(self) -> dem_model.Model:
        building = self.deck.building
        return dem_model.Model(building.blocks(), building.rigid(), joint_values(building))

    def falls(self, motion: Motion) -> bool:
        """Does it fall in discrete elements?"""
        end = motion.end + REST * self.time_unit
        options = dem.Options(end_time=end, output_step=0.02, collapse=FALLEN * self.elements.size, stop_at_rest=True)
        run = dem.run(self.elements.bodies(), options, motion.ground)
        assert run.reason in ("collapse", "left", "end", "rest"), run.reason
        return run.reason in ("collapse", "left")


@cache
def fell() -> np.ndarray:
    """Which of the arches fall under which of their pulses in discrete elements (arches, pulses); one of the processes of a test run
    calculates it, and the others wait for it."""
    run = os.environ.get("PYTEST_XDIST_TESTRUNUID")
    if run is None:
        return _fell()
    kept = Path(tempfile.gettempdir()) / f"extrados-hinges-{run}.npy"
    with kept.with_suffix(".lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not kept.exists():
            np.save(kept, _fell())
        return np.load(kept)


def _fell() -> np.ndarray:
    for one in SAMPLES:
        one.elements  # noqa: B018  the first look makes it, before threads share it
    runs = [(one, motion) for one in SAMPLES for _, motion in one.pulses]
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        found = list(pool.map(lambda run: run[0].falls(run[1]), runs))
    return np.array(found).reshape(len(SAMPLES), -1)


SAMPLES = [Sample(*one, seed) for seed, one in enumerate(ARCHES)]
