"""Calls of the macro-elements of piers."""

from typing import Any

import numpy as np

from core_calls.given import Calls
from extrados.core import frame


def framed(
    freedoms,
    length,
    depth,
    young,
    shear,
    strength,
    law,
    cohesion,
    drift,
    sections,
    stiffness,
    linear,
    weight,
    mass,
    pattern,
    control,
    target,
    steps,
    most,
    unit,
    acceleration,
    step,
    damping,
    strain,
    past,
) -> Any:
    """A pier on its ground with an elastic link at its top: at rest, pushed, and moved."""
    section = frame.section_forces((depth, 0.3, young, strength, 1e-9), strain, past)
    pier = frame.MacroElement(
        tuple(freedoms),
        length,
        depth,
        0.3,
        young,
        shear,
        strength,
        shear=law,
        cohesion=cohesion,
        friction=0.4,
        drifts=(drift, drift),
        sections=sections,
    )
    with frame.Frame([pier], [frame.Link((0,), (1.0,), stiffness)], linear, weight, mass) as whole:
        rest = whole.at_rest()
        pushed = whole.push(pattern, control, target, steps, 0.5, most)
        moved = whole.move(unit, acceleration, step, tuple(damping))
    return *section, *rest, pushed.displacement, pushed.multiple, moved.displacement, moved.shear


def calls() -> Calls:
    return [
        (
            framed,
            dict(
                freedoms=np.array([-1, -1, -1, 0, 1, 2]),
                length=3.0,
                depth=1.5,
                young=1.5e9,
                shear=4e7,
                strength=3e6,
                law="mohr-coulomb",
                cohesion=1e5,
                drift=5e-3,
                sections=5,
                stiffness=1e6,
                linear=np.zeros((3, 3)),
                weight=np.array([0.0, -2e5, 0.0]),
                mass=np.diag([2e4, 2e4, 1e4]),
                pattern=np.array([1.0, 0.0, 0.0]),
                control=np.array([1.0, 0.0, 0.0]),
                target=0.02,
                steps=20,
                most=100,
                unit=np.array([1.0, 0.0, 0.0]),
                acceleration=np.sin(np.arange(20.0)),
                step=0.01,
                damping=np.array([0.5, 1e-3]),
                strain=np.array([1e-4, 1e-4]),
                past=np.array([1.0, 1.0, 0.0, 0.0]),
            ),
        )
    ]
