"""Calls of rocking in two coordinates: stacked blocks, and a block on a compliant base."""

from dataclasses import astuple
from typing import Any

import numpy as np

from core_calls.given import Calls
from extrados.core import rocking, soft_base, stack
from extrados.core.ground import Ground


def stacks(
    mass,
    inertia,
    centre,
    foot,
    height,
    contact,
    samples,
    dt,
    end_time,
    output_step,
    scale,
    tolerance,
    start,
    room,
    pivots,
    rotation,
    rate,
    closing,
) -> Any:
    """Two blocks upon each other, shaken, and a blow between them."""
    two = stack.Stack(mass, inertia, centre, foot, height, contact)
    run = stack.stack_history(
        two, Ground(samples=samples, step=dt), end_time, output_step, scale=scale, tolerance=tolerance, start=start, room=room
    )
    return run.rotation, run.force, *stack.stack_impact(two, pivots, rotation, rate, closing)


def soft_bases(
    mass,
    inertia,
    height,
    left,
    right,
    stiffness,
    damping,
    edges,
    linear,
    samples,
    dt,
    end_time,
    output_step,
    scale,
    tolerance,
    start,
    room,
    rotation,
    critical,
) -> Any:
    """A block on a base that gives way, shaken, in an ensemble too, what the base does in a state, and its statics."""
    base = soft_base.SoftBase(mass, inertia, height, left, right, stiffness, damping, edges, linear)
    run = soft_base.soft_base_history(
        base, Ground(samples=samples, step=dt), end_time, output_step, scale=scale, tolerance=tolerance, start=start, room=room
    )
    many = rocking.ensemble(
        [soft_base.soft_base_body(base, critical)],
        [Ground(samples=samples, step=dt)],
        [0, 0],
        [0, 0],
        scale,
        end_time,
        start_rotation=start[0],
        tolerance=tolerance,
    )
    return (run.rotation, run.force, astuple(soft_base.base_contact(base, *start)), soft_base.base_held(base, rotation), many.peak)


def calls(rng: np.random.Generator) -> Calls:
    return [
        (
            stacks,
            dict(
                mass=(4000.0, 2000.0),
                inertia=(2000.0, 700.0),
                centre=(0.75, 1.0),
                foot=0.5,
                height=1.5,
                contact=0.3,
                samples=4.0 * rng.normal(size=(1, 9)),
                dt=0.05,
                end_time=1.0,
                output_step=0.1,
                scale=1.0,
                tolerance=1e-8,
                start=(0.01, 0.02, 0.0, 0.0),
                room=100,
                pivots=[1, 0],
                rotation=[0.0, 0.01],
                rate=[-0.1, -0.2],
                closing=[1, 0],
            ),
        ),
        (
            soft_bases,
            dict(
                mass=6000.0,
                inertia=5000.0,
                height=1.5,
                left=0.5,
                right=0.4,
                stiffness=1e8,
                damping=1e5,
                edges=False,
                linear=False,
                samples=4.0 * rng.normal(size=(1, 9)),
                dt=0.05,
                end_time=1.0,
                output_step=0.1,
                scale=1.0,
                tolerance=1e-8,
                start=(0.01, 0.002, 0.0, 0.0),
                room=100,
                rotation=[0.0, 0.01],
                critical=(0.3, 0.25),
            ),
        ),
    ]
