"""What all analyses of rocking share."""

from dataclasses import replace
from typing import Protocol

import numpy as np

from extrados.analyses.context import Context, Refused
from extrados.analyses.rocking.tables import RockingTable
from extrados.model.geometry.assembly import GROUND
from extrados.motions.supports import Shift, with_shifts
from extrados.views.building import Building
from extrados.views.rockers.rocker import Rocker


class Moving(Protocol):
    """States of a rocking structure (n each): rotation [rad], rate, acceleration, ground and vertical [m/s^2]."""

    @property
    def rotation(self) -> np.ndarray: ...
    @property
    def rate(self) -> np.ndarray: ...
    @property
    def acceleration(self) -> np.ndarray: ...
    @property
    def ground(self) -> np.ndarray: ...
    @property
    def vertical(self) -> np.ndarray: ...


def rocker_of(context: Context, options: RockingTable) -> Rocker:
    """The building as one rocking mechanism; its warnings go to the context."""
    refuse_movements(context)
    rocker = context.building.rocker(options.form == "linear", options.soft_base)
    context.warnings += rocker.warnings
    return rocker


def refuse_movements(context: Context) -> None:
    """Refused where supports move."""
    if context.building.initial.movements:
        raise Refused(
            "only `rocking` and `dem` can follow supports that move during rocking: remove [[initial.movements]]", ("initial", "movements")
        )


def shifts_of(building: Building) -> list[Shift]:
    """The movements of [[initial.movements]] in their order in time: all supports move alike, and none turns.

    Then the structure feels one more acceleration of its ground. Refused or BadGeometry else.
    """
    movements = building.initial.movements
    if not movements:
        return []
    assembly = building.blocks()
    building.moved()
    names = assembly.joint_names
    grounded = {n for n, a, b in zip(names, assembly.a, assembly.b, strict=True) if GROUND in (a, b)}
    for k, one in enumerate(movements):
        if one.turn:
            raise Refused(
                f"the support at '{one.joint}' rotates. Only `dem` can follow such a movement during rocking",
                ("initial", "movements", k, "turn"),
            )
    shifts = {Shift(one.dx, one.dy, one.start, one.duration) for one in movements}
    for shift in shifts:
        moved = {m.joint for m in movements if Shift(m.dx, m.dy, m.start, m.duration) == shift}
        if moved != grounded:
            raise Refused(
                f"the supports at {', '.join(sorted(grounded - moved)[:4])} do not move with the other supports. "
                "Only `dem` can follow supports that move apart during rocking",
                ("initial", "movements"),
            )
    return sorted(shifts, key=lambda s: (s.start, s.duration, s.dx, s.dy))


def with_moving_supports(context: Context) -> Context:
    """The context with a motion that holds the movements of [[initial.movements]], where there are any."""
    order = shifts_of(context.building)
    if not order:
        return context
    made = replace(context)
    vars(made)["given_motion"] = with_shifts(context.motion, order)
    return made
