"""What the hazard asks of strategies that know one number, one pulse or one motion."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from extrados.analyses.context import Context, Refused
from extrados.motions import tables as models
from extrados.motions.from_deck import code_spectrum, is_set, suite_members
from extrados.motions.impulse import primary_impulses
from extrados.motions.motion import Motion
from extrados.schema.constants import GRAVITY
from extrados.schema.table import Motion as Model

#: Of a set: the share of motions that leave it with a smaller rotation than the one which single runs take
GOVERNING = 0.84
#: Motions of a set, by its kind, where the deck gives no number: a matched motion takes a second to make
MOTIONS = {"generated": 40, "compatible": 10}
#: The part of the Arias intensity after which discrete elements need not follow a motion
STRONG = 0.95
#: Pulses, by the key of their size
SIZES = {
    "constant": "amplitude",
    "step-pulse": "amplitude",
    "sine-pulse": "amplitude",
    "harmonic": "amplitude",
    "pulse": "amplitude",
    "velocity-pulse": "velocity",
    "generated": "factor",
    "record": "scale",
    "suite": "scale",
    "compatible": "acceleration",
}
_UNITS = {"amplitude": " m/s^2", "velocity": " m/s", "acceleration": " m/s^2"}


@dataclass(frozen=True)
class Demanded:
    """What one motion asks (results.verdict.Demand)."""

    peak_g: float | None
    pulse: str = ""
    duration_s: float = 0.0
    amplitude_g: float = 0.0


def motions_of(context: Context, asked: int | None) -> int:
    """How many motions the hazard has."""
    model = context.deck.motion
    if model is None or not is_set(model):
        return 1
    if isinstance(model, models.Suite):
        there = len(suite_members(model, context.deck.folder))
        return min(asked or there, there)
    return asked or MOTIONS[model.kind]


def scaled(motion: dict[str, Any], model: Model, factor: float) -> dict[str, Any] | None:
    """The table of a motion `factor` times as strong; None where its kind cannot be scaled so."""
    name = SIZES[model.kind]
    if isinstance(model, models.Compatible) and model.code not in ("EN1998-1", "EN1998-2"):
        return None
    value = float(getattr(model, name)) * factor
    unit = _UNITS.get(name)
    return {**motion, name: f"{value!r}{unit}" if unit else value}


def strong_end(motion: Motion) -> float:
    """When the greatest part of the Arias intensity of a motion is over [s]."""
    time, acceleration = motion.series()
    energy = np.cumsum(acceleration**2)
    if energy[-1] <= 0.0:
        return float(motion.end)
    return float(time[np.searchsorted(energy, STRONG * energy[-1])])


def peak_of(context: Context) -> tuple[float, str]:
    """The peak acceleration [g] that strategies of a constant acceleration are asked, and where it comes from."""
    model = context.deck.motion
    if isinstance(model, models.Compatible):
        try:
            at_zero = float(code_spectrum(model, context.deck.folder, 0.05)(np.array([0.0]))[0])
        except ValueError as error:
            raise Refused(str(error), ("motion",)) from None
        if model.floor is None:
            return at_zero / GRAVITY, "the code spectrum at period 0, a_g S"
    whose = "motion" if model is None or model.floor is None else "floor"
    return context.motion.peak / GRAVITY, f"the greatest horizontal acceleration of the {whose}"


def primary(motion: Motion) -> tuple[float, float] | None:
    """Amplitude [g] and period [s] of the primary impulse of a motion; None where it has none."""
    time, acceleration = motion.series()
    found = primary_impulses(time, acceleration, 1, None, 4.0)
    return (abs(found[0].amplitude) / GRAVITY, float(found[0].period)) if found else None


def passages(motion: Motion, level_g: float) -> list[tuple[float, float]]:
    """Length [s] and mean acceleration [g] of each time that the ground's acceleration is above a level [g] to one side, that of
    the greatest impulse first."""
    time, acceleration = motion.series()
    step = float(time[1] - time[0]) if len(time) > 1 else 0.0
    found = []
    for side in (1.0, -1.0):
        over = np.concatenate([[False], side * acceleration > level_g * GRAVITY, [False]])
        edges = np.flatnonzero(over[1:] != over[:-1])
        for first, end in zip(edges[::2], edges[1::2], strict=True):
            found.append(((end - first) * step, float(side * acceleration[first:end].mean()) / GRAVITY))
    return sorted(found, key=lambda p: p[0] * p[1], reverse=True)


def above(motion: Motion, level_g: float) -> tuple[int, float]:
    """How often the ground's acceleration passes a level [g] to one side, and for how long at most [s]."""
    found = passages(motion, level_g)
    return len(found), max((length for length, _ in found), default=0.0)
