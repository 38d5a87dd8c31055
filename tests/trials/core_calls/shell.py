"""Calls of shells, and of the joints between them."""

from typing import Any

import numpy as np

from core_calls.given import BOX, PUSH, Calls
from extrados.core import shell, sla


def plates(
    xyz,
    held,
    connect,
    thickness,
    young,
    nu,
    band,
    strength,
    energy,
    layers,
    through,
    bends,
    reference,
    room,
    watch,
    way,
    share,
    load,
    threads,
) -> Any:
    """A shell bent until it cracks."""
    frames, flat = shell.node_frames(np.asarray(xyz), [np.asarray(connect)])
    soft = sla.Softening(strength, energy)
    shells = sla.Shells(
        "Q4", connect, thickness, young, nu, band, soft, frames=frames, flat=flat, layers=layers, through=through, bends=bends
    )
    freedoms = sla.Freedoms.make(4, held, of_node=6)
    with sla.Model(xyz, freedoms, [shells], sla.Behaviour(), threads=threads) as model:
        model.loads(np.zeros((4, 6)), reference)
        events = model.run(room, [sla.Monitor(watch, way, share)], sla.Stop(load=load))
        return events.load, model.displacement(load), model.report(load), model.residual(), model.damage()


def jointed_plates(
    connect, normal, along, out, area, stiffness, shear, friction, cohesion, energy, layers, through, band, reference, room, load, threads
) -> Any:
    """Two shells side by side, and the joint between them, which tears or slides."""
    corner = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [1.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0]])
    xyz = np.column_stack([corner[:, 0], np.zeros(8), corner[:, 1]])
    plates = np.array([[0, 1, 2, 3], [4, 5, 6, 7]])
    frames, flat = shell.node_frames(xyz, [plates])
    soft = sla.Softening(3e5, 50.0)
    shells = sla.Shells("Q4", plates, 0.2, 1e9, 0.2, band, soft, frames=frames, flat=flat, layers=3, bends=True)
    height, share = shell.layers_of(layers, through)
    each = np.repeat(np.asarray(connect), len(height), axis=0)
    axes = [np.repeat(np.asarray(axis, dtype=float), len(height), axis=0) for axis in (normal, along, out)]
    joint = sla.ShellJoints(
        each,
        np.tile([1.0, 0.0], (len(each), 1)),
        area * np.tile(share, len(connect))[:, None] * np.ones(2),
        stiffness,
        shear,
        friction,
        tension=soft,
        cohesion=sla.Softening(cohesion, energy, "exponential", 0.1),
        row=sla.ShellJoints.rows(*axes, np.tile(height, len(connect)) * 0.2, frames[each]),
    )
    held = [(node, d) for node in (0, 3) for d in range(6)] + [(node, 5) for node in (1, 2, 4, 5, 6, 7)]
    with sla.Model(xyz, sla.Freedoms.make(8, held, of_node=6), [shells, joint], sla.Behaviour(), threads=threads) as model:
        model.loads(np.zeros((8, 6)), reference)
        events = model.run(room, [sla.Monitor.of(6, 2)], sla.Stop(load=load))
        return events.load, model.displacement(load), model.residual()


def calls() -> Calls:
    return [
        (
            plates,
            dict(
                xyz=np.column_stack([BOX[:, 0], np.zeros(4), BOX[:, 1]]),
                held=[(n, d) for n in (0, 1) for d in range(6)] + [(2, 5), (3, 5)],
                connect=np.array([[0, 1, 2, 3]]),
                thickness=0.2,
                young=1e9,
                nu=0.2,
                band=0.5,
                strength=1e5,
                energy=50.0,
                layers=5,
                through="lobatto",
                bends=True,
                reference=np.column_stack([np.zeros((4, 1)), PUSH[:, [0]], np.zeros((4, 4))]),
                room=4,
                watch=np.array([2]),
                way=np.array([1]),
                share=np.array([1.0]),
                load=1e9,
                threads=2,
            ),
        ),
        (
            jointed_plates,
            dict(
                connect=np.array([[1, 2, 7, 4]]),
                normal=np.array([[1.0, 0.0, 0.0]]),
                along=np.array([[0.0, 0.0, 1.0]]),
                out=np.array([[0.0, -1.0, 0.0]]),
                area=0.1,
                stiffness=8e10,
                shear=4e10,
                friction=0.75,
                cohesion=3e5,
                energy=120.0,
                layers=3,
                through="lobatto",
                band=0.5,
                reference=np.column_stack([np.zeros((8, 2)), np.repeat([0.0, -1e3], [6, 2]), np.zeros((8, 3))]),
                room=6,
                load=1e9,
                threads=2,
            ),
        ),
    ]
