"""Calls of the four hinges of an arch."""

from types import SimpleNamespace
from typing import Any

import numpy as np

from core_calls.given import Calls
from extrados.core import arch, rocking
from extrados.core.ground import Ground
from extrados.model.structures.arch import ArchAssembly
from extrados.views.rockers.arch import ArchModel


def hinges(
    hinge,
    joint,
    mass,
    centroid,
    inertia,
    masses,
    places,
    inertias,
    intrados,
    extrados,
    q,
    v,
    a,
    horizontal,
    vertical,
    restitution,
    samples,
    dt,
) -> Any:
    """The four hinges of an arch: how far they turn, the deformed shape, the thrust line, and the arch that rocks."""
    four = arch.FourHinge(hinge, joint, mass, centroid, inertia)
    stones = SimpleNamespace(mass=masses, centroid=places, inertia=inertias, intrados=intrados, extrados=extrados)
    line = arch.thrust_line(four, stones, q, v, a, horizontal, vertical)
    run = rocking.history(rocking.arch_body(four, restitution), Ground(samples=samples, step=dt), 1.0, 0.1)
    limit = arch.limits(four)
    return limit.critical, limit.drive, arch.pose(four, places, q), line.normal, line.point, run.rotation


def calls(stones: ArchAssembly, shaken: np.ndarray) -> Calls:
    four = ArchModel(stones).four_hinge
    return [
        (
            hinges,
            dict(
                hinge=four.hinge,
                joint=four.joint,
                mass=four.mass,
                centroid=four.centroid,
                inertia=four.inertia,
                masses=stones.mass,
                places=stones.centroid,
                inertias=stones.inertia,
                intrados=stones.p,
                extrados=stones.q,
                q=[0.0, 0.02],
                v=[0.0, 0.1],
                a=[0.0, 1.0],
                horizontal=[1.0, -2.0],
                vertical=[0.0, 0.5],
                restitution=0.8,
                samples=shaken,
                dt=0.05,
            ),
        )
    ]
