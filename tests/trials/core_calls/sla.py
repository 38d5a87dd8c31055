"""Calls of sequentially linear analysis: a wall, by events and by equilibrium iterations."""

from typing import Any

import numpy as np

from core_calls.given import BOX, PUSH, Calls
from extrados.core import sla


def wall(
    xy,
    held,
    connect,
    thickness,
    young,
    nu,
    band,
    strength,
    energy,
    lateral,
    axis,
    points,
    bar,
    area,
    node,
    direction,
    stiffness,
    constant,
    reference,
    room,
    watch,
    way,
    share,
    load,
    damage,
    threads,
) -> Any:
    """A wall of one element, a bar and a spring: all that can be asked of a model."""
    soft = sla.Softening(strength, energy)
    groups = [
        sla.Plane("Q4", connect, thickness, young, nu, band, soft, lateral=lateral, axis=axis, points=points),
        sla.Bars(bar, area, young, band),
        sla.Springs(node, direction, stiffness),
    ]
    model = sla.Model(xy, sla.Freedoms.make(4, held), groups, sla.Behaviour(), threads=threads)
    with model:
        model.factorise()
        model.loads(constant, reference)
        events = model.run(room, [sla.Monitor(watch, way, share)], sla.Stop(load=load))
        found = events.load, model.displacement(load), model.report(load), model.residual()
        before, standing = model.damage(), model.standing()
        model.renew(before, standing)
        model.set_damage(before * damage)
        return *found, before


def followed(
    xy,
    held,
    connect,
    thickness,
    young,
    nu,
    band,
    strength,
    energy,
    reference,
    longest,
    least,
    unit,
    before,
    histories,
    room,
    watch,
    way,
    share,
    load,
) -> Any:
    """A wall followed by equilibrium iterations from a state of another stage."""
    groups = [sla.Plane("Q4", connect, thickness, young, nu, band, sla.Softening(strength, energy), points=(2, 2))]
    with sla.Model(xy, sla.Freedoms.make(4, held), groups, sla.Behaviour(cracking="rotating", closure=True), threads=1) as model:
        model.factorise()
        model.loads(np.zeros((4, 2)), reference)
        model.follow("newton", longest, least, unit)
        if not model.continues:
            return None
        model.go_on(before, histories)
        events = model.run(room, [sla.Monitor(watch, way, share)], sla.Stop(load=load))
        return events.load, model.histories()


def calls() -> Calls:
    square = dict(
        xy=BOX,
        held=[(0, 0), (0, 1), (1, 0), (1, 1)],
        connect=np.array([[0, 1, 2, 3]]),
        thickness=0.2,
        young=1e9,
        nu=0.2,
        band=0.5,
        strength=1e5,
        energy=50.0,
        reference=PUSH,
        room=4,
        watch=np.array([2]),
        way=np.array([0]),
        share=np.array([1.0]),
        load=1e9,
    )
    return [
        (
            wall,
            dict(
                **square,
                lateral=0.0,
                axis=np.nan,
                points=(2, 2),
                bar=np.array([[0, 2]]),
                area=1e-4,
                node=np.array([[2, -1]]),
                direction=np.array([[0, 0]]),
                stiffness=np.array([1e6]),
                constant=np.zeros((4, 2)),
                damage=1.0,
                threads=2,
            ),
        ),
        (followed, dict(**square, longest=1e-4, least=1e-2, unit=1.0, before=np.zeros((4, 2)), histories=np.zeros((sla.HISTORIES, 4)))),
    ]
