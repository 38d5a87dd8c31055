"""Calls of rocking blocks: ensembles and histories."""

from typing import Any

import numpy as np

from core_calls.given import Calls
from extrados.core import rocking
from extrados.core.ground import Ground


def rockers(
    mass,
    inertia,
    height,
    toe,
    restitution,
    linear,
    kind,
    parameters,
    samples,
    dt,
    start,
    breaks,
    wave,
    body,
    shake,
    scale,
    end_time,
    output_step,
    start_rotation,
    tolerance,
    room,
    threads,
) -> Any:
    """Blocks under sampled and analytic motions: an ensemble, and one with its history."""
    made = rocking.block_body(mass, inertia, height, toe, toe, restitution, linear)
    other = rocking.Body(kind, parameters)
    grounds = [Ground(samples=samples, step=dt, start=start), Ground(breaks=breaks, linear=np.zeros((1, 1, 2)), harmonic=wave)]
    found = rocking.ensemble(
        [made, other], grounds, body, shake, scale, end_time, start_rotation=start_rotation, tolerance=tolerance, threads=threads
    )
    one = rocking.history(made, grounds[1], 1.0, output_step, scale=1.0, start_rotation=0.01, room=room)
    return found.outcome, found.peak, found.stop_time, one.rotation, one.events


def calls(rng: np.random.Generator) -> Calls:
    return [
        (
            rockers,
            dict(
                mass=1000.0,
                inertia=1500.0,
                height=2.0,
                toe=0.5,
                restitution=(0.9, 0.9),
                linear=False,
                kind=rocking.block_body(1000.0, 1500.0, 2.0, 0.5, 0.5, (0.9, 0.9)).kind,
                parameters=np.array([0.0, 1000.0, 1500.0, 2.0, 0.5, 0.5, 0.9, 0.9]),
                samples=4.0 * rng.normal(size=(2, 9)),
                dt=0.05,
                start=0.0,
                breaks=np.array([0.0, 1.0]),
                wave=np.array([[[[5.0, 0.0, 9.0, 0.0]]]]),
                body=[0, 1],
                shake=[0, 1],
                scale=1.0,
                end_time=[1.0, 1.2],
                output_step=0.1,
                start_rotation=0.001,
                tolerance=1e-8,
                room=100,
                threads=2,
            ),
        )
    ]
