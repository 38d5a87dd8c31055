"""Calls of discrete elements, in the plane and in space."""

from typing import Any

import numpy as np

from core_calls.given import BOX, Calls
from extrados.core import dem, dem3, dem_run
from extrados.core.ground import Ground, MotionSet

dem_run.FIRST_PAUSE = 3  # steps
CUBE = np.array([[x, y, z] for z in (0.0, 1.0) for x, y in ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0))])
CUBE_FACES = ((3, 2, 1, 0), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))
LAW = dem.Law(1e8, 1e8, 0.6, damping=1e-3)


def blocks(
    centroid,
    mass,
    inertia,
    part,
    owner,
    outer,
    depth,
    joint,
    law,
    end_time,
    output_step,
    step,
    fraction,
    settle,
    domain,
    gravity,
    rigid,
    quasi,
    rebound,
    shift,
    rate,
    mover,
    travel,
    begin,
    lasts,
    times,
    scale,
    number,
    samples,
    dt,
    threads,
    stretched,
    bounds,
    first,
    closed,
    anchored,
    point,
    spot,
    pair,
    ends,
    normal,
    load,
) -> Any:
    """A block on a support that moves, shaken, with a tie and a constant load; forces of its contact with their places."""
    bodies = dem.Bodies(
        centroid,
        mass,
        inertia,
        [part, BOX - [0.0, 1.0]],
        owner,
        [outer, np.ones(4, bool)],
        depth,
        [LAW],
        {joint: law},
        dem_run.Ties(stretched, np.zeros_like(stretched), -bounds, bounds, first, closed, anchored, point, spot),
        drawn=dem_run.DrawnContacts(pair, [ends], normal),
        load=load,
    )
    options = dem.Options(
        end_time,
        output_step,
        step,
        fraction,
        settle,
        domain=domain,
        gravity=gravity,
        threads=threads,
        mass_damping=0.0 if rigid else 0.1,
        rigid=rigid,
        quasi_static=quasi,
        rebound=rebound,
    )
    moves = (dem.SupportMove(mover, (travel, 0.0, 0.0), begin, lasts),)
    with dem.Model(bodies, options, shift=shift, rate=rate, moves=moves) as model, MotionSet([Ground(samples=samples, step=dt)]) as motions:
        run = model.run(motions, number, scale=scale, times=times)
        states = []
        paused = model.run(motions, number, scale=scale, times=times, watch=lambda _: states.append(model.state()))
        again = model.run(motions, number, scale=scale, times=times, state=states[0]) if states else paused
        return run.reason, run.place, run.energy, run.contacts.force, again.rate, run.tension, run.extreme


def solids(
    centroid,
    mass,
    inertia,
    vertices,
    faces,
    owner,
    joint,
    law,
    end_time,
    output_step,
    step,
    fraction,
    settle,
    gravity,
    rigid,
    quasi,
    rebound,
    way,
    rate,
    times,
    scale,
    number,
    samples,
    dt,
    threads,
    doweled,
    place,
    axis,
    stiffness,
    strength,
    reach,
    stretched,
    bounds,
    first,
    closed,
    anchored,
    point,
    spot,
    pair,
    ends,
    normal,
    load,
) -> Any:
    """A cube on a support in space, shaken, with a tie and a constant load; on springs with a dowel."""
    dowels = None if rigid else dem3.Dowels(doweled, place, axis, stiffness, strength, reach, 1e-3)
    tied = dem_run.Ties(stretched, np.zeros_like(stretched), -bounds, bounds, first, closed, anchored, point, spot)
    bodies = dem3.Solids(
        centroid,
        mass,
        inertia,
        [vertices, vertices - [0.0, 0.0, 1.0]],
        [faces, faces],
        owner,
        [dem3.Law(1e8, 1e8, 0.6, damping=1e-3)],
        {joint: law},
        dowels,
        tied,
        drawn=dem_run.DrawnContacts(pair, [ends], normal),
        load=load,
    )
    options = dem3.Options(
        end_time,
        output_step,
        step,
        fraction,
        settle,
        gravity=gravity,
        way=way,
        threads=threads,
        rigid=rigid,
        quasi_static=quasi,
        rebound=rebound,
    )
    with dem3.Model(bodies, options, rate=rate) as model, MotionSet([Ground(samples=samples, step=dt)]) as motions:
        run = model.run(motions, number, scale=scale, times=times)
        states = []
        paused = model.run(motions, number, scale=scale, times=times, watch=lambda _: states.append(model.state()))
        again = model.run(motions, number, scale=scale, times=times, state=states[0]) if states else paused
        return run.reason, run.place, run.turn, run.energy, again.rate, run.tension, run.dowel_slip, run.dowel_out


def calls() -> Calls:
    return [
        *(
            (
                blocks,
                dict(
                    centroid=np.array([[0.5, 0.5], [0.5, -0.5]]),
                    mass=np.array([2000.0, 0.0]),
                    inertia=np.array([300.0, 0.0]),
                    part=BOX,
                    owner=[0, 1],
                    outer=np.ones(4, bool),
                    depth=1.0,
                    joint=(0, 1),
                    law=0,
                    end_time=0.02,
                    output_step=0.01,
                    step=0.0,
                    fraction=0.3,
                    settle=5000,
                    domain=(-9.0, 9.0, -9.0, 9.0),
                    gravity=(0.0, -9.8),
                    rigid=rigid,
                    quasi=False,
                    rebound=0.1,
                    shift=np.zeros((2, 3)),
                    rate=np.full((2, 3), 1e-3),
                    mover=1,
                    travel=0.001,
                    begin=0.0,
                    lasts=0.01,
                    times=np.array([0.0, 0.01]),
                    scale=1.0,
                    number=0,
                    samples=np.ones((1, 5)),
                    dt=0.01,
                    threads=2,
                    stretched=np.array([1e6]),
                    bounds=np.array([1e4]),
                    first=np.array([0]),
                    closed=np.array([False]),
                    anchored=np.array([0, -1]),
                    point=np.array([0, 1]),
                    spot=np.array([[0.5, 0.9], [-3.0, 0.9]]),
                    pair=np.array([[0, 1]]),
                    ends=np.array([[0.0, 0.0], [1.0, 0.0]]),
                    normal=np.array([[0.0, 1.0]]),
                    load=np.array([[100.0, 0.0, 10.0, 50.0], [0.0, 0.0, 0.0, 0.0]]),
                ),
            )
            for rigid in (False, True)
        ),
        *(
            (
                solids,
                dict(
                    centroid=np.array([[0.5, 0.5, 0.5], [0.5, 0.5, -0.5]]),
                    mass=np.array([2000.0, 0.0]),
                    inertia=np.tile(300.0 * np.eye(3), (2, 1, 1)),
                    vertices=CUBE,
                    faces=CUBE_FACES,
                    owner=[0, 1],
                    joint=(0, 1),
                    law=0,
                    end_time=0.02,
                    output_step=0.01,
                    step=0.0,
                    fraction=0.3,
                    settle=5000,
                    gravity=(0.0, 0.0, -9.8),
                    rigid=rigid,
                    quasi=False,
                    rebound=0.1,
                    way=(0.6, 0.8, 0.0),
                    rate=np.full((2, 6), 1e-3),
                    times=np.array([0.0, 0.01]),
                    scale=1.0,
                    number=0,
                    samples=np.ones((1, 5)),
                    dt=0.01,
                    threads=2,
                    doweled=np.array([[1, 0]]),
                    place=np.array([[0.5, 0.5, 0.0]]),
                    axis=np.array([[0.0, 0.0, 1.0]]),
                    stiffness=np.array([1e8]),
                    strength=np.array([1e3]),
                    reach=np.array([0.1]),
                    stretched=np.array([1e6]),
                    bounds=np.array([1e4]),
                    first=np.array([0]),
                    closed=np.array([False]),
                    anchored=np.array([0, -1]),
                    point=np.array([0, 1]),
                    spot=np.array([[0.5, 0.5, 0.9], [-3.0, 0.5, 0.9]]),
                    pair=np.array([[0, 1]]),
                    ends=CUBE[:4],
                    normal=np.array([[0.0, 0.0, 1.0]]),
                    load=np.stack([np.full((4, 3), 10.0), np.zeros((4, 3))]),
                ),
            )
            for rigid in (False, True)
        ),
    ]
