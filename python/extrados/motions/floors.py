"""The motion of a floor: that of the ground as a building passes it on in its first mode."""

from dataclasses import dataclass, replace

import numpy as np

from extrados.core.ground import Ground
from extrados.motions.motion import Motion
from extrados.schema.table import FloorBelow

#: A building swings on after the ground has come to rest, until this part of its motion is left
LEFT = 0.01


@dataclass(frozen=True)
class Sway:
    """First mode of a building at the height of the part: period T_1 [s], damping ratio, gamma_1 psi_1(z)."""

    period: float
    damping: float
    part: float

    def accelerations(self, ground: np.ndarray, step: float) -> np.ndarray:
        """Acceleration of the floor (..., points) [m/s^2] under one of the ground, which is straight between its samples.

        (1 - gamma psi) a_g + gamma psi a, with a the absolute acceleration of an oscillator of T_1 and xi: a'' = -w^2 u - 2 xi w u'.
        """
        from scipy.signal import cont2discrete, lfilter  # takes half a second to load

        w = 2.0 * np.pi / self.period
        top, below = [2.0 * self.damping * w, w**2], [1.0, 2.0 * self.damping * w, w**2]
        b, a, _ = cont2discrete((top, below), step, method="foh")
        return (1.0 - self.part) * ground + self.part * lfilter(np.ravel(b), a, ground, axis=-1)

    @property
    def tail(self) -> float:
        """Time after the end of the ground's motion at which LEFT of the sway is left [s]."""
        return -float(np.log(LEFT)) * self.period / (2.0 * np.pi * self.damping)


def sway_of(floor: FloorBelow) -> Sway:
    """The first mode of the building below a part, linear over its height: gamma_1 psi_1 = 3 n/(2 n + 1) z/H."""
    part = floor.height / floor.building_height * 3.0 * floor.levels / (2.0 * floor.levels + 1.0)
    return Sway(floor.building_period or 0.05 * floor.building_height**0.75, floor.building_damping, part)


def on_floor(motion: Motion, floor: FloorBelow | None) -> Motion:
    """The motion of the floor that a ground motion gives, sampled, with the sway after its end; vertical motion is that of the ground."""
    if floor is None:
        return motion
    sway = sway_of(floor)
    step = motion.ground.step if motion.ground.samples is not None else motion.ground.fine_step
    start = motion.ground.start if motion.ground.samples is not None else 0.0
    time = start + step * np.arange(int(np.ceil((motion.end - start + sway.tail) / step)) + 1)
    rows = np.stack([motion.sample(time, k) for k in range(motion.ground.channels)])
    rows[0] = sway.accelerations(rows[0], step)
    return replace(motion, ground=Ground(samples=rows, step=step, start=start), horizontal=None, name=f"{motion.name} on a floor")


def floor_condition(floor: FloorBelow) -> str:
    """The condition under which all analyses of a deck with a floor run, in words."""
    return (
        f"The structure is on a floor at a height of {floor.height:g} m, in a building of {floor.building_height:g} "
        f"m with T_1 = {sway_of(floor).period:.3g} s. All analyses apply the motion of this floor."
    )
