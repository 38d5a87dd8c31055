"""Calls of mechanisms on hinges, free and restrained."""

from types import SimpleNamespace
from typing import Any

import numpy as np

from core_calls.given import Calls
from extrados.core import mechanism, restraints, rocking
from extrados.core.ground import Ground
from extrados.model.structures.arch import ArchAssembly
from extrados.views.rockers.mechanism import MechanismModel


def chains(
    mass,
    centroid,
    inertia,
    joined,
    point,
    row,
    driver,
    sense,
    side,
    q,
    restitution,
    samples,
    dt,
    bodies,
    inertias,
    places,
    sides,
    ends,
    frame,
    before,
) -> Any:
    """A mechanism on hinges, the structure that rocks by it, and a blow at the joints of its blocks."""
    linkage = SimpleNamespace(
        mass=mass, centroid=centroid, inertia=inertia, joined=joined, point=point, row=row, driver=driver, sense=sense, side=side
    )
    table = mechanism.table(linkage)
    run = rocking.history(mechanism.table_body(table, table, restitution), Ground(samples=samples, step=dt), 1.0, 0.1)
    return (
        run.rotation,
        mechanism.coefficients(table, q).mass,
        *mechanism.follow(linkage, q),
        mechanism.inelastic_blow(bodies, inertias, places, sides, ends, frame, before),
    )


def held(
    mass,
    centroid,
    inertia,
    joined,
    point,
    row,
    driver,
    sense,
    side,
    sort,
    ends,
    points,
    reach,
    stiffness,
    most,
    viscous,
    power,
    sides,
    rebound,
    restitution,
    samples,
    dt,
) -> Any:
    """A mechanism on hinges that a tie holds and a wall stands beside."""
    linkage = SimpleNamespace(
        mass=mass, centroid=centroid, inertia=inertia, joined=joined, point=point, row=row, driver=driver, sense=sense, side=side
    )
    table = mechanism.table(linkage)
    way = restraints.paths(linkage, sort, ends, points, reach)
    law = restraints.Law(stiffness=stiffness, most=most, viscous=viscous, power=power)
    body = restraints.restrained_body(mechanism.table_body(table, table, restitution), [law], (way, way), open_sides=sides, rebound=rebound)
    run = rocking.history(body, Ground(samples=samples, step=dt), 1.0, 0.1)
    return run.rotation, way, rocking.limits(body)


def calls(stones: ArchAssembly, shaken: np.ndarray) -> Calls:
    table = MechanismModel(stones)
    link = table.linkages[0]
    names = ("mass", "centroid", "inertia", "joined", "point", "row", "driver", "sense", "side")
    of_link = {name: getattr(link, name) for name in names}
    return [
        (
            chains,
            dict(
                **of_link,
                q=np.array([0.0, 0.02]),
                restitution=(0.8, 0.8),
                samples=shaken,
                dt=0.05,
                bodies=stones.mass,
                inertias=stones.inertia,
                places=stones.centroid,
                sides=np.column_stack([stones.a, stones.b]),
                ends=np.stack([stones.p, stones.q], axis=1),
                frame=np.stack([stones.normal, stones.tangent], axis=1),
                before=table.fields[0],
            ),
        ),
        (
            held,
            dict(
                **of_link,
                sort=np.array([restraints.LENGTH]),
                ends=np.array([[0, 1]]),
                points=np.array([[[-12.0, 0.0], link.centroid[0]]]),
                reach=mechanism.table(link).numbers[1:3],
                stiffness=1e6,
                most=1e5,
                viscous=1e3,
                power=1.0,
                sides=(True, True),
                rebound=(0.0, 0.0),
                restitution=(0.8, 0.8),
                samples=shaken,
                dt=0.05,
            ),
        ),
    ]
