"""Sequentially linear analysis in the core (fortran/sla, c/sparse): teeth, models, batches of events."""

import os
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from extrados import _core
from extrados.core import lists
from extrados.core.calls import indices, integers, long_call, real, room_for, thread_count
from extrados.core.errors import Cancelled, check, status_code
from extrados.core.handles import Owner
from extrados.core.sla_parts import (
    BEARS,
    CRACKING,
    DIRECTIONS,
    ELEMENTS,
    EVENT,
    EVENTS,
    LAWS,
    STOPS,
    THROUGH,
    Bars,
    Bedding,
    Behaviour,
    Events,
    Freedoms,
    Hill,
    Joints,
    Monitor,
    Plane,
    ShellJoints,
    Shells,
    Softening,
    Springs,
    Stop,
)
from extrados.core.sla_parts import Group as Group

__all__ = [
    "CONTINUATIONS",
    "CRACKING",
    "DIRECTIONS",
    "ELEMENTS",
    "EVENT",
    "EVENTS",
    "LAWS",
    "REPORT",
    "STOPS",
    "THROUGH",
    "VARIANTS",
    "BadElement",
    "Bars",
    "Bedding",
    "Behaviour",
    "Events",
    "FreeNode",
    "Freedoms",
    "Hill",
    "Joints",
    "Model",
    "Monitor",
    "Plane",
    "ShellJoints",
    "Shells",
    "Softening",
    "Springs",
    "Stop",
    "body_force",
    "intervals",
    "largest_band",
    "memory_limit",
    "shell_axes",
    "teeth",
]

REPORT = (
    "strain_n",
    "strain_s",
    "strain_ns",
    "stress_n",
    "stress_s",
    "stress_ns",
    "cos",
    "sin",
    "ratio_n",
    "ratio_s",
    "tooth_n",
    "tooth_s",
    "lambda_lo",
    "lambda_hi",
    "volume",
    "crush_n",
    "crush_s",
    "shut",
    "band",
)
MOST_TEETH = 4096
#: Rows of the damage of a point of joints: friction that slides over the shear stiffness [m], constant and per multiplier;
#: slip at which friction that sticks carries nothing [m]; how it is, 0 sticks, 1 and 2 slides up and down
START, HELD, HELD_RATE, MARK, MODE = 0, 1, 6, 8, 10
#: What happens after a tooth and where equilibrium is lost, see Model.run
VARIANTS = tuple(lists.numbers("sla_variant"))
#: How a run goes on without equilibrium, in the order of fortran/api/api_sla.f90 (follow)
CONTINUATIONS = ("newton", "implicit-explicit")
#: Rows of the histories of a point, see fortran/sla/group.f90
HISTORIES = 8
#: Ratio of neighbouring bands where the band follows from the crack: the energy is right to a percent
BAND_STEP = 1.02


class FreeNode(ValueError):
    """The structure is free to move; node (0-based) and direction name where."""

    def __init__(self, node: int, direction: str, ratio: float):
        super().__init__(f"node {node + 1} is free to move in {direction}")
        self.node, self.direction, self.ratio = node, direction, ratio


class BadElement(ValueError):
    """An element is inverted or has no area; its 0-based number."""

    def __init__(self, element: int, what: str):
        super().__init__(f"{what} {element + 1} is inverted or has no size")
        self.element = element


def teeth(softening: Softening, young: float, band: float) -> tuple[np.ndarray, np.ndarray]:
    """Secant moduli (teeth) [Pa] and peak stresses (teeth) [Pa] of a crack band `band` [m] wide; young [Pa]."""
    s = softening
    n, modulus, strength, status = _core.api_sla_laws.teeth(
        LAWS[s.law], young, s.strength, s.energy, band, s.ripple, int(s.exact), int(s.overshoot), MOST_TEETH
    )
    check(status, f"teeth of a {s.law} law: the crack band is {band:g} m (largest possible: {largest_band(s, young):g} m)")
    return np.array(modulus[:n]), np.array(strength[:n])


def largest_band(softening: Softening, young: float) -> float:
    """The crack band width beyond which the law snaps back [m]."""
    return float(_core.api_sla_laws.band(LAWS[softening.law], young, softening.strength, softening.energy))


def intervals(alpha: float, beta: float, a: npt.ArrayLike, b: npt.ArrayLike) -> tuple[np.ndarray, np.ndarray]:
    """Multipliers lo, hi (n) that keep r <= alpha - beta m under stresses a + lambda b, both (n, 3)."""
    a = real("a", np.transpose(a), (3, None))
    lo, hi = _core.api_sla_laws.intervals(alpha, beta, a, real("b", np.transpose(b), (3, a.shape[1])))
    return lo, hi


def body_force(kind: str, points: tuple[int, int], xy: npt.ArrayLike, connect: npt.ArrayLike, density: npt.ArrayLike) -> np.ndarray:
    """Consistent nodal forces (nodes, 2) [N] of a density (elements, 2): force per wall area [N/m^2].

    xy (nodes, 2) [m]; connect (elements, nodes of one), from 0.
    """
    place = real("xy", np.transpose(xy), (2, None))
    nodes = indices("connect", np.transpose(connect), place.shape[1], (ELEMENTS[kind], None))
    force, bad, status = _core.api_sla_model.body_force(
        ELEMENTS[kind], *points, place, nodes, real("density", np.transpose(density), (2, nodes.shape[1]))
    )
    if bad:
        raise BadElement(bad - 1, "element")
    check(status, "body force")
    return np.array(force.T)


def shell_axes(xyz: npt.ArrayLike, connect: npt.ArrayLike) -> np.ndarray:
    """Axes (elements, 3, 3) of flat shells, rows x, y, normal: x is horizontal, y goes up; of horizontal ones x is x.

    xyz (nodes, 3) [m]; connect (elements, 3 or 4), from 0.
    """
    place = real("xyz", np.transpose(xyz), (3, None))
    nodes = indices("connect", np.transpose(connect), place.shape[1], (None, None))
    axes, bad, status = _core.api_shell.axes_of(place, nodes)
    if bad:
        raise BadElement(bad - 1, "shell")
    check(status, "axes of shells")
    return np.array(np.transpose(axes, (2, 0, 1)))


def memory_limit() -> int:
    """Bytes a factor may take: 60 % of the machine's memory."""
    try:
        return int(0.6 * os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES"))
    except (ValueError, OSError):  # not every system says
        return 4 << 30


class Model(Owner):
    """A model in the core; close it, or use it in a `with`.

    xy (nodes, 2) [m], of shells (nodes, 3). `algorithm` "update" changes the factor at each event, "refactor" makes it anew. IndexError
    where an element, a spring or a monitor names a node that is not there.
    """

    what = "model of sequentially linear analysis"

    def __init__(
        self,
        xy: npt.ArrayLike,
        freedoms: Freedoms,
        groups: Sequence[Plane | Joints | Bars | Springs],
        behaviour: Behaviour | None = None,
        *,
        algorithm: str = "update",
        ordering: str | None = None,
        threads: int = 1,
        memory: int | None = None,
    ):
        if algorithm not in ("update", "refactor"):
            raise ValueError(f"algorithm is {algorithm!r}, expected 'update' or 'refactor'")
        self.behaviour = behaviour = behaviour or Behaviour()
        self.iterates = False
        self.plane_points: list[tuple[Plane | Joints, int, int]] = []  # group, first point, points per element
        retention = -1.0 if behaviour.retention is None else float(behaviour.retention)
        axes, self.freedoms = np.shape(xy)[-1], freedoms.of_node
        place = real("xy", np.transpose(xy), (axes, None))
        self.nodes = place.shape[1]
        self.xy = place.T
        equation = np.asarray(freedoms.equation)
        if (axes, self.freedoms) not in ((2, 2), (3, 6)) or len(equation) != self.nodes:
            raise ValueError(
                f"coordinates have shape {np.shape(xy)} and equations {equation.shape}, expected ({self.nodes}, 2) of both in the "
                f"plane, ({self.nodes}, 3) and ({self.nodes}, 6) in space"
            )
        equations = int(equation.max(initial=-1)) + 1
        if equations > self.freedoms * self.nodes:
            raise IndexError(
                f"a degree of freedom has the equation number {equations}; expected at most {self.freedoms * self.nodes}, the number of degrees of freedom"
            )
        self.moved = int(freedoms.moved)
        handle, status = _core.api_sla_model.create(
            place,
            indices("equation", equation.T + 1, equations + 1, (self.freedoms, self.nodes)) - np.int32(1),
            self.moved,
            real("factor", np.transpose(freedoms.factor), (self.freedoms, self.nodes)),
            CRACKING[behaviour.cracking],
            retention,
            int(behaviour.closure),
            int(behaviour.most_changes),
            float(behaviour.floor),
        )
        check(status, "model")
        super().__init__(handle)
        try:
            for group in groups:
                self._add(group)
            metis = equations > 3000 if ordering is None else ordering == "metis"
            limit = memory_limit() if memory is None else memory
            sizes, status = long_call(
                _core.api_sla_model.prepare, self.handle, int(metis), limit // 8, int(algorithm == "refactor"), thread_count(threads)
            )
            self.equations, self.points, self.factor_values = (int(x) for x in sizes)
            if status == status_code("too_large"):
                raise MemoryError(
                    f"{self.equations} equations need {self.factor_values * 8 / 2**30:.1f} GiB for the matrix factor, and "
                    f"{limit / 2**30:.1f} GiB are allowed: use larger elements"
                )
            check(status, "analysis of the stiffness matrix")
            self.factorise()
        except BaseException:
            self.close()
            raise

    def _tables(self, count: int, group: Plane | Joints | Bars) -> tuple[list[np.ndarray], np.ndarray]:
        """Hand over the tooth tables of a group; for tension, compression and of joints cohesion, the table of each
        element (1-based, 0 none), and (2, elements) those of its narrowest and widest tension band."""
        young, band = _each("young", group.young, count), _each("band", group.band, count)
        reach = group.reach if isinstance(group, Plane) else None
        rows: list[tuple[float, ...]] = []
        tension = _softenings(group.tension, count)
        bedded = [law is not None and bed is not None for law, bed in zip(tension, _beddings(group, count), strict=True)]
        plain = [None if b else law for b, law in zip(bedded, tension, strict=True)]
        if reach is None:
            number, ladder = _one_band(plain, young, band, rows), np.zeros((2, count), dtype=np.int32)
        else:
            number, ladder = _many_bands(plain, young, band, real("reach", reach, (count, 2)), rows)
        if any(bedded):
            ends = np.column_stack([band, band]) if reach is None else np.asarray(reach)
            stretch = np.array([(1.0, 1.0) if bed is None else bed.stretch() for bed in _beddings(group, count)])
            other = [law if b else None for b, law in zip(bedded, tension, strict=True)]
            more, rungs = _many_bands(other, young, band, ends * stretch, rows)
            number, ladder = np.where(bedded, more, number), np.where(bedded, rungs, ladder)
        numbers = [number]
        numbers.append(_one_band(_softenings(group.compression, count), young, band, rows))
        if isinstance(group, Joints):
            slip = _each("shear stiffness", group.shear_stiffness, count)
            numbers.append(_one_band(_softenings(group.cohesion, count), slip, band, rows))
        if rows:
            table = real("softening", np.transpose(rows), (8, None))
            bad, status = _core.api_sla_model.tables(self.handle, table)
            if bad:
                kind, modulus, strength, energy, width = table[:5, bad - 1]
                name = next(word for word, number in LAWS.items() if number == int(kind))
                largest = largest_band(Softening(strength, energy, name), modulus)
                check(
                    status,
                    (
                        f"teeth of a {name} law with E {modulus:g} Pa, strength {strength:g} Pa, energy {energy:g} N/m: the crack band is "
                        f"{width:g} m, and the largest possible is {largest:g} m"
                    ),
                )
            check(status, "softening laws")
        return numbers, ladder

    def _add(self, group: Plane | Joints | Bars | Springs) -> None:
        if isinstance(group, Springs):
            self._add_springs(group)
            return
        per = np.shape(group.connect)[1] if isinstance(group, Bars) else 4 if isinstance(group, Joints) else ELEMENTS[group.kind]
        connect = indices("connect", np.transpose(group.connect), self.nodes, (per, None))
        count = connect.shape[1]
        young = _each("young", group.young, count)
        tables, ladder = self._tables(count, group)
        if isinstance(group, Bars):
            gradient, length = group.strains(self.xy)
            bad, status = _core.api_sla_model.bars(
                self.handle,
                connect,
                real("gradient", np.transpose(gradient, (2, 1, 0)), (self.xy.shape[1], per, count)),
                _rows(_each("area", group.area, count) * length, young),
                _rows(*tables, np.full(count, BEARS[group.bears], dtype=np.int32)),
            )
            what = "bar"
        elif isinstance(group, Joints):
            bad, status = self._add_joints(group, connect, tables)
            what = "joint element"
        else:
            axis = np.broadcast_to(np.asarray(group.axis, dtype=float), (count,))
            given = np.isfinite(axis)
            properties = _rows(
                _each("thickness", group.thickness, count),
                young,
                _each("nu", group.nu, count),
                _each("lateral", group.lateral, count),
                np.where(given, axis, 0.0),
                _each("confinement", group.confinement, count),
                *_bed_rows(group, count),
            )
            choices = _rows(tables[0], *ladder, tables[1], (1 + int(group.joint)) * given.astype(np.int32))
            if isinstance(group, Shells):
                bad, status = _core.api_shell.shells(
                    self.handle,
                    ELEMENTS[group.kind],
                    integers("section", [THROUGH[group.through], group.layers, int(group.bends), int(group.selective)], 4),
                    real("frames", np.transpose(group.frames, (1, 2, 0)), (3, 3, self.nodes)),
                    integers("flat", np.asarray(group.flat).astype(int), self.nodes),
                    connect,
                    properties,
                    choices,
                )
            else:
                bad, status = _core.api_sla_model.plane(
                    self.handle,
                    ELEMENTS[group.kind],
                    integers("points", [*group.points, int(group.selective)], 3),
                    connect,
                    properties,
                    choices,
                )
            what = "element"
        if not isinstance(group, Bars):
            first = sum(len(g.connect) * n for g, _, n in self.plane_points)
            self.plane_points.append((group, first, group.points_each))
        if bad:
            raise BadElement(int(bad) - 1, what)
        check(status, f"{what}s")

    def _add_joints(self, group: Joints, connect: np.ndarray, tables: list[np.ndarray]) -> tuple[int, int]:
        count = connect.shape[1]
        friction = np.broadcast_to(np.asarray(group.friction, dtype=float), (count,))
        properties = _rows(
            *real("area", np.transpose(group.area), (2, count)),
            _each("normal stiffness", group.normal_stiffness, count),
            _each("shear stiffness", group.shear_stiffness, count),
            np.where(np.isnan(friction), -1.0, friction),
            _each("small", group.small, count),
            *real("normal", np.transpose(group.normal), (2, count)),
        )
        dry = np.broadcast_to(np.asarray(group.dry, dtype=np.int32), (count,))
        choices, ripple = _rows(*tables, dry), float(group.ripple)
        if isinstance(group, ShellJoints):
            row = real("row", group.row.reshape(2 * count, 3, 24).transpose(2, 1, 0), (24, 3, 2 * count))
            return _core.api_sla_joints.joints_between_shells(self.handle, connect, properties, choices, ripple, row)
        return _core.api_sla_joints.joints(self.handle, connect, properties, choices, ripple)

    def _add_springs(self, group: Springs) -> None:
        count = len(group.stiffness)
        ground = np.asarray(group.node) == -1  # the ground is the core's node 0
        node = indices("node of a spring", np.asarray(group.node).T + 1, self.nodes + 1, (2, count)) - np.int32(1)
        direction = np.where(ground, 0, np.asarray(group.direction))
        status = _core.api_sla_model.springs(
            self.handle,
            node,
            indices("direction of a spring", direction.T, self.freedoms, (2, count)),
            real("stiffness", group.stiffness, (count,)),
        )
        check(status, "springs")

    def factorise(self) -> float:
        """Factor of the present damage; returns the smallest over the largest pivot."""
        node, direction, ratio, status = long_call(_core.api_sla_model.factorise, self.handle)
        if status == status_code("not_positive_definite"):
            raise FreeNode(int(node) - 1, DIRECTIONS[max(int(direction) - 1, 0)], float(ratio))
        check(status, "factor of the stiffness matrix")
        return float(ratio)

    def loads(
        self,
        constant: npt.ArrayLike,
        reference: npt.ArrayLike,
        *,
        carried: bool = False,
        events: int = 0,
        ledger: npt.ArrayLike = (0.0, 0.0, 0.0),
    ) -> None:
        """Start a stage under nodal forces (nodes, 2) [N], of shells (nodes, 6) [N], [N m]: constant + lambda reference.

        ledger (3,): external work, energy lost and energy of cracks so far [J].
        """
        status = long_call(
            _core.api_sla.loads,
            self.handle,
            real("constant", np.transpose(constant), (self.freedoms, self.nodes)),
            real("reference", np.transpose(reference), (self.freedoms, self.nodes)),
            int(carried),
            int(events),
            *(float(energy) for energy in real("ledger", ledger, (3,))),
        )
        check(status, "loads")
        self.iterates = False

    def supports(self, constant: npt.ArrayLike, rate: npt.ArrayLike) -> None:
        """Displacements (moved) [m] of the supports that move, constant and their rate per multiplier; before the loads."""
        moved = np.asfortranarray(np.column_stack([real("constant", constant, (self.moved,)), real("rate", rate, (self.moved,))]))
        check(_core.api_sla.supports(self.handle, moved), "supports that move")

    def reactions(self) -> np.ndarray:
        """Forces (moved, 2) [N] of the supports that move, under the constant loads and per multiplier."""
        force, status = _core.api_sla.reactions(self.handle, self.moved)
        check(status, "forces of supports")
        return np.array(force)

    def run(self, room: int, monitors: Sequence[Monitor], stop: Stop | None = None, *, variant: str = VARIANTS[0]) -> Events:
        """Up to `room` events; the last one recorded is chosen but not applied until the next call.

        variant: "load-unload", where no multiplier suits all points the constant loads stay and the greatest lower limit
        decides; "proportional", all loads of the last state in equilibrium go down together; "force-release", the forces
        that a tooth sets free go onto the others at the load reached, before it grows again.
        """
        stop = stop or Stop()
        if room < 1 or not monitors:
            raise ValueError("a run requires memory for at least one event, and at least one monitored value")
        room_for(15 + len(monitors), room)
        first = integers("monitors", np.cumsum([1] + [len(m.node) for m in monitors]))
        huge = float(np.finfo(float).max)
        node = indices("node of a monitor", np.concatenate([m.node for m in monitors]), self.nodes, (None,))
        direction = indices("direction of a monitor", np.concatenate([m.direction for m in monitors]), self.freedoms, node.shape)
        status = _core.api_sla.stop_at(
            self.handle,
            lists.numbers("sla_variant")[variant],
            min(stop.load, huge),
            min(stop.displacement, huge),
            stop.fraction,
            stop.compliance,
            int(stop.refuse_overload),
            stop.target,
            stop.side,
            stop.already,
            min(stop.far, huge),
        )
        check(status, "where the events end")
        counts, reals, ints, watched, cracked, released, status = long_call(
            _core.api_sla.run,
            self.handle,
            int(room),
            first,
            _rows(node, direction),
            real("share", np.concatenate([m.share for m in monitors]), node.shape),
        )
        interrupted = status == status_code("cancelled")
        if not interrupted:
            check(status, "events")
        count, checks, solutions, factors, reason, iterates, solved = (int(k) for k in counts)
        self.iterates = bool(iterates)
        reals, ints = reals[:, :count].copy(), ints[:, :count].copy()
        load, limit_t, limit_c, stored, external, lost, crack, compliance, residual, scale, pull = reals
        return Events(
            load,
            limit_t,
            limit_c,
            stored,
            external,
            lost,
            crack,
            compliance,
            residual,
            scale,
            pull,
            point=ints[0] - 1,
            code=ints[1],
            number=ints[2],
            equilibrium=ints[3].astype(bool),
            monitors=watched[:, :count].T.copy(),
            reason=STOPS[reason],
            guard=(checks, solutions, factors),
            interrupted=interrupted,
            crack_total=float(cracked),
            solutions=solved,
            released=float(released),
        )

    def follow(self, how: str | None, longest: float, least: float, unit: float) -> None:
        """How the next batches go on where events find no equilibrium under the constant loads: by equilibrium iterations in
        displacement control, `how` one of CONTINUATIONS, or None not at all. `iterates` then becomes true.

        longest: step of the control [m]; least: displacement below which nothing counts as running away [m]; unit: resultant of
        the reference load [N], 1 where supports move.
        """
        number = 0 if how is None else 1 + CONTINUATIONS.index(how)
        check(_core.api_sla.follow(self.handle, number, float(longest), float(least), float(unit)), "continuation")

    @property
    def continues(self) -> bool:
        """Whether every group has a law that equilibrium iterations can follow."""
        yes, status = _core.api_sla.continues(self.handle)
        check(status, "continuation")
        return bool(yes)

    def histories(self) -> np.ndarray:
        """The histories of all points (HISTORIES, points) in the last state of equilibrium iterations: of masonry the greatest
        strains in tension and in compression, of joints those of fortran/sla/joint_law.f90."""
        values, status = _core.api_sla.histories(self.handle, self.points)
        check(status, "histories of the points")
        return np.array(values, order="F")

    def go_on(self, displacement: npt.ArrayLike, histories: npt.ArrayLike | None = None) -> None:
        """Begin a stage with equilibrium iterations, at a displacement (nodes, freedoms) [m] and histories (HISTORIES, points) of
        another; by default those that the events so far have left."""
        points = 0 if histories is None else self.points
        histories = np.zeros((HISTORIES, 0)) if histories is None else histories
        status = _core.api_sla.go_on(
            self.handle,
            real("displacement", np.transpose(displacement), (self.freedoms, self.nodes)),
            real("histories", histories, (HISTORIES, points)),
        )
        check(status, "continuation")
        self.iterates = True

    def run_whole(self, room: int, monitor: Monitor, stop: Stop | None = None, *, variant: str = VARIANTS[0]) -> Events:
        """As `run`, of events that are of no use in part: Cancelled where the user asked to stop."""
        events = self.run(room, [monitor], stop, variant=variant)
        if events.interrupted:
            raise Cancelled(status_code("cancelled"), "events interrupted")
        return events

    def relax(self, load: float) -> tuple[int, float]:
        """One iteration of an incremental analysis: in each element the most overloaded point loses a tooth, all at
        once, and all is solved anew; how many did, and the crack energy so far [J]. FreeNode of a mechanism.
        """
        damaged, cracked, status = long_call(_core.api_sla.relax, self.handle, float(load))
        if status == status_code("not_positive_definite"):
            raise FreeNode(-1, "x", 0.0)
        check(status, "overloaded points")
        return int(damaged), float(cracked)

    def displacement(self, load: float) -> np.ndarray:
        """Displacements (nodes, 2) [m], of shells (nodes, 6) [m], [rad], under constant + load * reference."""
        ua, ub, status = _core.api_sla.displacement(self.handle, self.freedoms, self.nodes)
        check(status, "displacements")
        return np.array((ua + load * ub).T)

    def residual(self) -> float:
        """Greater norm of the residual forces of the two displacements over that of their load, measured now."""
        ratio, status = long_call(_core.api_sla.measure, self.handle)
        check(status, "residual forces")
        return float(ratio)

    def report(self, load: float) -> dict[str, np.ndarray]:
        """State of all points at a multiplier, columns as in REPORT."""
        values, status = _core.api_sla.report(self.handle, float(load), self.points)
        check(status, "state of the points")
        return dict(zip(REPORT, values.copy(), strict=True))

    def damage(self) -> np.ndarray:
        """The damage of all points (11, points), to be kept or set again."""
        values, status = _core.api_sla.damage(self.handle, self.points)
        check(status, "damage of the points")
        return np.array(values, order="F")

    def set_damage(self, damage: npt.ArrayLike) -> None:
        """Go on from a stored damage (11, points): the factor is made anew."""
        status = _core.api_sla.set_damage(self.handle, real("damage", damage, (11, self.points)))
        check(status, "stored damage")
        self.factorise()

    def end_stage(self, load: float) -> None:
        """Before other loads: friction that slides sticks where it is at the multiplier reached, with the force it has."""
        damage, report = self.damage(), self.report(load)
        for group, first, per in self.plane_points:
            if not isinstance(group, Joints):
                continue
            at = first + np.flatnonzero(damage[MODE, first : first + per * len(group.connect)] % 4)
            bond = report["ratio_s"][at]
            stiffness = np.repeat(_each("shear stiffness", group.shear_stiffness, len(group.connect)), per)[at - first]
            slip = report["stress_ns"][at] / stiffness - bond * (report["strain_ns"][at] - damage[START, at])
            damage[MARK, at] = report["strain_ns"][at] - slip / (1.0 - bond)
            damage[HELD, at] = damage[HELD_RATE, at] = damage[MODE, at] = 0.0
        self.set_damage(damage)

    def standing(self) -> np.ndarray:
        """Where the loop stands between two calls of `run`, beside loads and damage."""
        values, status = _core.api_sla.standing(self.handle)
        check(status, "where the events stand")
        return np.array(values)

    def standing_at(self, load: float) -> np.ndarray:
        """Where the loop stands at the start of a stage, but at a multiplier."""
        standing = self.standing()
        standing[3] = load
        return standing

    def renew(self, damage: npt.ArrayLike, standing: npt.ArrayLike) -> None:
        """Go on from a damage (11, points) and where the loop stood, under the loads of the stage, with a new factor.

        standing (34,): as the method of that name gave it.
        Whoever goes on from the same two gets the same bits, after whatever history. Raises FreeNode.
        """
        self.set_damage(damage)
        check(long_call(_core.api_sla.resume, self.handle, real("standing", standing, (34,))), "stored events")


def _softenings(law: Softening | Sequence[Softening | None] | None, count: int) -> list[Softening | None]:
    """The law of each element."""
    each = [law] * count if law is None or isinstance(law, Softening) else list(law)
    if len(each) != count:
        raise ValueError(f"there are {len(each)} softening laws for {count} elements; expected one for each element")
    return each


def _beddings(group: Plane | Bars | Joints, count: int) -> list[Bedding | None]:
    """The bed joints of each element."""
    bedding = group.bedding if isinstance(group, Plane) else None
    each = [bedding] * count if bedding is None or isinstance(bedding, Bedding) else list(bedding)
    if len(each) != count:
        raise ValueError(f"there are {len(each)} laws of bed joints for {count} elements; expected one for each element")
    return each


def _bed_rows(group: Plane, count: int) -> np.ndarray:
    """(8, elements) the components of the core's `bedding`: none where nothing cracks or crushes."""
    rows = np.zeros((8, count))
    rows[3] = 1.0
    for k, criterion in enumerate(group.hill or ()):
        if criterion is not None:
            rows[[0, 5, 6, 7], k] = criterion.angle, criterion.ratio, criterion.coupling, criterion.shear
    if group.bedding is None:
        return rows
    width = _each("band", group.band, count) if group.reach is None else np.zeros(count)
    for k, (bed, law) in enumerate(zip(_beddings(group, count), _softenings(group.tension, count), strict=True)):
        if bed is not None and law is not None:
            rows[:5, k] = bed.angle, bed.strength, bed.energy, bed.shear, width[k]
    return rows


def _one_band(laws: list[Softening | None], young: np.ndarray, band: np.ndarray, rows: list) -> np.ndarray:
    """The table of each element (1-based, 0 none), one for each law and band; the tables go to `rows`."""
    found = {row: k + 1 for k, row in enumerate(rows)}
    number = np.zeros(len(laws), dtype=np.int32)
    for k, law in enumerate(laws):
        if law is not None:
            row = tuple(law.row(float(young[k]), float(band[k])))
            if row not in found:
                rows.append(row)
                found[row] = len(rows)
            number[k] = found[row]
    return number


def _many_bands(
    laws: list[Softening | None], young: np.ndarray, band: np.ndarray, reach: np.ndarray, rows: list
) -> tuple[np.ndarray, np.ndarray]:
    """As `_one_band`, for bands between the two of `reach` (elements, 2): every law has tables for bands that grow by
    BAND_STEP. The table of each element at its `band`, and (2, elements) those at both ends of its reach."""
    members: dict[tuple[Softening, float], list[int]] = {}
    for k, law in enumerate(laws):
        if law is not None:
            members.setdefault((law, float(young[k])), []).append(k)
    number = np.zeros(len(laws), dtype=np.int32)
    ladder = np.zeros((2, len(laws)), dtype=np.int32)
    for (law, modulus), mine in members.items():
        low, high = float(reach[mine, 0].min()), float(reach[mine, 1].max())
        steps = max(1, int(np.ceil(np.log(high / low) / np.log(BAND_STEP))))
        step = np.log(high / low) / steps
        first = len(rows) + 1
        rows += [tuple(law.row(modulus, low * float(np.exp(i * step)))) for i in range(steps + 1)]
        for target, wanted in ((number, band), (ladder[0], reach[:, 0]), (ladder[1], reach[:, 1])):
            at = np.rint(np.log(wanted[mine] / low) / step) if step > 0.0 else np.zeros(len(mine))
            target[mine] = first + np.clip(at, 0, steps).astype(np.int32)
    return number, ladder


def _each(name: str, value: npt.ArrayLike, count: int) -> np.ndarray:
    """One value for all elements, or one for each."""
    return real(name, np.broadcast_to(np.asarray(value, dtype=float), (count,)).copy(), (count,))


def _rows(*rows: np.ndarray) -> np.ndarray:
    """Arrays by element as the rows of one, in Fortran order."""
    return np.asfortranarray(np.stack(rows))
