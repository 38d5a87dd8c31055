"""Calls of joints of sequentially linear analysis."""

from typing import Any

import numpy as np

from core_calls.given import Calls
from extrados.core import sla


def joints(
    connect,
    normal,
    area,
    stiffness,
    shear,
    friction,
    cohesion,
    energy,
    dry,
    small,
    ripple,
    push,
    pressure,
    room,
    slip,
    load,
    moved,
    travel,
    rate,
) -> Any:
    """A joint pressed and sheared; then its most overloaded points, all at once."""
    xy = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 0.0], [0.0, 0.0]])
    free = sla.Freedoms.make(4, [(n, d) for n in (0, 1) for d in (0, 1)], [[(2, d, 1.0), (3, d, 1.0)] for d in (0, 1)])
    law = sla.Softening(cohesion, energy, "exponential", 0.1)
    joint = sla.Joints(connect, normal, area, stiffness, shear, friction, cohesion=law, dry=dry, small=small, ripple=ripple)
    with sla.Model(xy, free, [joint], sla.Behaviour(floor=1e-9, closure=True)) as model:
        model.loads(pressure, push)
        events = model.run(room, [sla.Monitor.of(2, 0)], sla.Stop(displacement=slip))
        found = events.load, model.report(1.0), model.standing_at(1.0)
        model.loads(pressure, push)
        relaxed = model.relax(load)
    free.moved = moved
    with sla.Model(xy, free, [joint], sla.Behaviour(floor=1e-9, closure=True)) as model:
        model.supports(travel, rate)
        model.loads(pressure, push)
        model.run(room, [sla.Monitor.of(2, 0)], sla.Stop(displacement=slip))
        return *found, relaxed, model.reactions()


def calls() -> Calls:
    return [
        (
            joints,
            dict(
                connect=np.array([[0, 1, 2, 3]]),
                normal=np.array([[0.0, 1.0]]),
                area=np.array([[0.5, 0.5]]),
                stiffness=8e10,
                shear=4e10,
                friction=0.75,
                cohesion=3e5,
                energy=120.0,
                dry=False,
                small=1.0,
                ripple=0.1,
                push=np.array([[0.0, 0.0], [0.0, 0.0], [1.0, 0.0], [0.0, 0.0]]),
                pressure=np.array([[0.0, 0.0], [0.0, 0.0], [0.0, -1e5], [0.0, 0.0]]),
                room=30,
                slip=1e-3,
                load=5e5,
                moved=1,
                travel=np.array([-1e-6]),
                rate=np.array([0.0]),
            ),
        )
    ]
