"""Calls the core's Python API with arguments that are wrong at random; prints the number of each call before it is made.

    api_worker.py SEED FIRST COUNT
    api_worker.py unreached             which functions of the core it does not come to

Every call must end with a result or an exception; after it the core must still give the right bits. What would end the
process ends this one, and the last number tells where.
"""

import faulthandler
import random
import signal
import sys
from collections.abc import Callable
from dataclasses import astuple
from types import SimpleNamespace
from typing import Any

import numpy as np

from extrados import _core
from extrados.core import arch, dem, dem3, dem_run, frame, limit, mechanism, motion, restraints, rocking, shell, sla, soft_base, stack
from extrados.core.ground import Ground, MotionSet
from extrados.model.structures.arch import make_arch
from extrados.views.rockers.arch import ArchModel
from extrados.views.rockers.mechanism import MechanismModel

BOX = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
dem_run.FIRST_PAUSE = 3  # steps
CUBE = np.array([[x, y, z] for z in (0.0, 1.0) for x, y in ((0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0))])
CUBE_FACES = ((3, 2, 1, 0), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))
LAW = dem.Law(1e8, 1e8, 0.6, damping=1e-3)


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
) -> Any:
    """A block on a support that moves, shaken, with a tie."""
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
    moves = (dem.SupportMove(mover, travel, 0.0, 0.0, begin, lasts),)
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
) -> Any:
    """A cube on a support in space, shaken, with a tie; on springs with a dowel."""
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


def motions(
    kind,
    parameters,
    points,
    step,
    intensity,
    frequency,
    amplitude,
    wanted,
    lines,
    spacing,
    scaling,
    factor,
    duration,
    seed,
    first,
    count,
    window,
    periods,
    dampings,
    series,
    length,
    period,
    threads,
) -> Any:
    """Everything that is computed of motions."""
    strength = motion.line_spectrum(intensity, frequency, amplitude, wanted, lines)
    width = motion.line_widths(lines, spacing)
    size = motion.line_amplitudes(strength, width, scaling, factor, duration)
    made = motion.generate(lines, size, window, step, seed, first, count, threads)
    spectra = motion.response_spectra(series, step, periods, dampings, threads=threads)
    back = motion.fourier_inverse(motion.fourier(series, length), length)
    return (
        motion.envelope(kind, parameters, points, step),
        motion.phases(seed, first, points),
        made,
        spectra.sd,
        back,
        motion.oscillator(series, step, period, 0.05),
        motion.measures(series, step, threads).arias,
        motion.kinematics(series, step),
    )


def small(
    mass,
    centroid,
    inertia,
    joint,
    hinge,
    opposite,
    before,
    after,
    alpha,
    beta,
    a,
    b,
    kind,
    points,
    connect,
    force,
    band,
    right,
    rows,
    least,
    cost,
    low,
    high,
) -> Any:
    """The functions that keep nothing."""
    return (
        arch.restitution(mass, centroid, inertia, joint, hinge, opposite),
        mechanism.restitution(mass, inertia, before, after),
        sla.intervals(alpha, beta, a, b),
        sla.body_force(kind, points, BOX, connect, force),
        sla.teeth(sla.Softening(1e5, 50.0), alpha, beta),
        sla.largest_band(sla.Softening(1e5, 50.0), alpha),
        limit.BandFactor(np.array(band)).solve(right),
        limit.least_vertex(rows, least, cost, low, high),
    )


def _valid() -> list[tuple[Callable[..., Any], dict[str, Any]]]:
    rng = np.random.default_rng(3)
    push = np.zeros((4, 2))
    push[2, 0] = 1e3
    stones = make_arch(10.0, 1.5, 157.5, 7)
    rocker, table = ArchModel(stones), MechanismModel(stones)
    four, link = rocker.four_hinge, table.linkages[0]
    shaken = 3.0 * rng.normal(size=(2, 9))
    return [
        (
            wall,
            dict(
                xy=BOX,
                held=[(0, 0), (0, 1), (1, 0), (1, 1)],
                connect=np.array([[0, 1, 2, 3]]),
                thickness=0.2,
                young=1e9,
                nu=0.2,
                band=0.5,
                strength=1e5,
                energy=50.0,
                lateral=0.0,
                axis=np.nan,
                points=(2, 2),
                bar=np.array([[0, 2]]),
                area=1e-4,
                node=np.array([[2, -1]]),
                direction=np.array([[0, 0]]),
                stiffness=np.array([1e6]),
                constant=np.zeros((4, 2)),
                reference=push,
                room=4,
                watch=np.array([2]),
                way=np.array([0]),
                share=np.array([1.0]),
                load=1e9,
                damage=1.0,
                threads=2,
            ),
        ),
        (
            followed,
            dict(
                xy=BOX,
                held=[(0, 0), (0, 1), (1, 0), (1, 1)],
                connect=np.array([[0, 1, 2, 3]]),
                thickness=0.2,
                young=1e9,
                nu=0.2,
                band=0.5,
                strength=1e5,
                energy=50.0,
                reference=push,
                longest=1e-4,
                least=1e-2,
                unit=1.0,
                before=np.zeros((4, 2)),
                histories=np.zeros((sla.HISTORIES, 4)),
                room=4,
                watch=np.array([2]),
                way=np.array([0]),
                share=np.array([1.0]),
                load=1e9,
            ),
        ),
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
        ),
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
                reference=np.column_stack([np.zeros((4, 1)), push[:, [0]], np.zeros((4, 4))]),
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
        ),
        (
            chains,
            dict(
                mass=link.mass,
                centroid=link.centroid,
                inertia=link.inertia,
                joined=link.joined,
                point=link.point,
                row=link.row,
                driver=link.driver,
                sense=link.sense,
                side=link.side,
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
                mass=link.mass,
                centroid=link.centroid,
                inertia=link.inertia,
                joined=link.joined,
                point=link.point,
                row=link.row,
                driver=link.driver,
                sense=link.sense,
                side=link.side,
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
        ),
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
                ),
            )
            for rigid in (False, True)
        ),
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
        ),
        (
            motions,
            dict(
                kind="arctangent",
                parameters=np.array([0.5, 1.0, 0.1, 0.0]),
                points=20,
                step=0.05,
                intensity=[5.0, 6.0],
                frequency=[0.5, 1.0, 5.0],
                amplitude=np.ones((2, 3)),
                wanted=5.5,
                lines=[0.6, 1.2, 3.0],
                spacing="log",
                scaling="energy",
                factor=1.0,
                duration=1.0,
                seed=7,
                first=0,
                count=3,
                window=np.ones(30),
                periods=[0.3, 1.0],
                dampings=[0.05],
                series=rng.normal(size=40),
                length=64,
                period=0.7,
                threads=2,
            ),
        ),
        (
            small,
            dict(
                mass=np.ones(3),
                centroid=rng.normal(size=(3, 2)),
                inertia=np.ones(3),
                joint=np.array([0, 1, 2, 3]),
                hinge=rng.normal(size=(4, 2)),
                opposite=rng.normal(size=(4, 2)),
                before=rng.normal(size=(3, 3)),
                after=rng.normal(size=(3, 3)),
                alpha=1e9,
                beta=0.5,
                a=np.ones((2, 3)),
                b=np.ones((2, 3)),
                kind="Q4",
                points=(2, 2),
                connect=[[0, 1, 2, 3]],
                force=[[0.0, 1.0]],
                band=np.tile([4.0, 1.0, 0.5], (12, 1)),
                right=np.ones(12),
                rows=np.array([[1.0, 2.0], [3.0, 1.0]]),
                least=np.array([2.0, 3.0]),
                cost=np.array([1.0, 1.0]),
                low=np.zeros(2),
                high=np.full(2, 9.0),
            ),
        ),
    ]


def spoiled(value: Any, rng: random.Random) -> Any:
    """An argument that is wrong, or odd."""
    array = np.array(value) if not isinstance(value, str) and value is not None else np.zeros(3)
    flat = array.astype(float, copy=True) if array.dtype.kind in "iufb" else np.zeros(3)
    if flat.ndim and flat.size and rng.random() < 0.5:  # one entry
        k = rng.randrange(flat.size)
        put = rng.choice((-1, -2, 0, 1, 3, 4, 9, 77, 2**31 - 1, -(2**31), 2**40, 1e300, 5e-324, 1e-9, 0.5, np.nan, np.inf, -np.inf))
        if array.dtype.kind in "iu" and np.isfinite(put) and abs(put) < 2**62 and put == int(put):
            whole = array.astype(np.int64, copy=True)
            whole.flat[k] = int(put)
            return whole
        flat.flat[k] = put
        return flat
    return rng.choice(
        (
            None,
            "",
            "x",
            b"x",
            True,
            -1,
            0,
            1,
            2,
            3,
            64,
            10**6,
            2**31 - 1,
            -(2**31),
            2**63,
            10**30,
            0.5,
            -0.5,
            1e300,
            -1e300,
            5e-324,
            np.nan,
            np.inf,
            1j,
            [],
            [[]],
            {},
            (),
            [None],
            ["a"],
            object(),
            np.zeros(0),
            np.zeros((0, 2)),
            np.zeros((2, 0)),
            np.zeros((1, 1, 1)),
            np.ones(1),
            np.ones(2),
            np.ones((3, 3)),
            np.ones((4, 2)),
            np.array(2),
            np.array("x"),
            flat.T,
            np.flip(flat),
            flat.ravel(),
            flat.astype(np.float32),
            flat.astype(complex),
            flat.astype(object),
            np.asfortranarray(flat),
            np.concatenate([flat.ravel()] * 2),
            flat.ravel()[:-1],
            np.broadcast_to(np.float64(1.0), (4, 2)),
            np.ma.masked_array(flat, flat > 0),
            flat * 1e18,
            -flat,
            flat.tolist(),
        )
    )


def bits(value: Any) -> bytes:
    """The bytes of a result."""
    if isinstance(value, dict):
        return b"".join(bits(v) for _, v in sorted(value.items()))
    if isinstance(value, tuple | list):
        return b"".join(map(bits, value))
    return repr(value).encode() if isinstance(value, str) else np.asarray(value).tobytes()


PATIENCE = 3.0  # seconds of the processor; then a call is asked to stop, as by Ctrl-C: it may have an age to compute
HANG = 120.0  # seconds; a call that does not stop then ends the process, with the place where it was


class Watched:
    """A module of the compiled core that notes which of its functions are asked for."""

    def __init__(self, module: Any, name: str, seen: set[str]):
        self._module, self._name, self._seen = module, name, seen

    def __getattr__(self, function: str) -> Any:
        self._seen.add(f"{self._name}.{function}")
        return getattr(self._module, function)


def unreached() -> list[str]:
    """Functions of the compiled core that no valid call comes to."""
    seen: set[str] = set()
    there = {name: getattr(_core, name) for name in dir(_core) if name.startswith("api_")}
    for name, module in there.items():
        setattr(_core, name, Watched(module, name, seen))
    for function, keys in _valid():
        function(**keys)
    every = {f"{name}.{f}" for name, module in there.items() for f in dir(module) if not f.startswith("_")}
    return sorted(every - seen)


def main() -> None:
    signal.signal(signal.SIGPROF, lambda *_: _core.api_support.set_cancel(1))
    seed, first, count = map(int, sys.argv[1:])
    np.seterr(all="ignore")
    calls = _valid()
    right = [bits(function(**keys)) for function, keys in calls]
    for number in range(first, first + count):
        rng = random.Random(seed * 1_000_003 + number)
        k = rng.randrange(len(calls))
        function, keys = calls[k]
        changed = dict(keys)
        names = rng.sample(sorted(keys), rng.choice((1, 1, 1, 2, 3)))
        for name in names:
            changed[name] = spoiled(keys[name], rng)
        told = ", ".join(f"{name}={changed[name]!r:.60}".replace("\n", " ") for name in names)
        print(f"{number}\t{function.__name__}({told})", end="\t", flush=True)
        signal.setitimer(signal.ITIMER_PROF, PATIENCE, PATIENCE)
        faulthandler.dump_traceback_later(HANG, exit=True)
        try:
            function(**changed)
            end = "result"
        except MemoryError:
            end = "MemoryError"
        except Exception as error:
            end = type(error).__name__
        signal.setitimer(signal.ITIMER_PROF, 0.0)
        faulthandler.cancel_dump_traceback_later()
        if number % 20 == 0 and bits(calls[k][0](**calls[k][1])) != right[k]:
            end = "WRONG: the core no longer gives the right bits"
        print(end, flush=True)
    print("end", flush=True)


if __name__ == "__main__":
    print(*unreached(), sep="\n") if sys.argv[1:] == ["unreached"] else main()
