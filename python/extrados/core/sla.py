"""Sequentially linear analysis in the core (fortran/sla, c/sparse): models and batches of events.

The laws, groups and parts of a model are in sla_laws, sla_groups and sla_parts; their names are here too.
"""

import os
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from extrados import _core
from extrados.core import lists
from extrados.core.calls import indices, integers, long_call, real, real_each, room_for, stack_rows, thread_count
from extrados.core.errors import Cancelled, check, status_code
from extrados.core.handles import Owner
from extrados.core.sla_groups import BadElement, add_group, body_force
from extrados.core.sla_laws import MOST_TEETH, intervals, largest_band, teeth
from extrados.core.sla_parts import (
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
    "MOST_TEETH",
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
#: Rows of the damage of a point of joints: friction that slides over the shear stiffness [m], constant and per multiplier;
#: slip at which friction that sticks carries nothing [m]; how it is, 0 sticks, 1 and 2 slides up and down
START, HELD, HELD_RATE, MARK, MODE = 0, 1, 6, 8, 10
#: What happens after a tooth and where equilibrium is lost, see Model.run
VARIANTS = tuple(lists.numbers("sla_variant"))
#: How a run goes on without equilibrium, in the order of fortran/api/api_sla.f90 (follow)
CONTINUATIONS = ("newton", "implicit-explicit", "dissipation")
#: Rows of the histories of a point, see fortran/sla/group.f90
HISTORIES = 8


class FreeNode(ValueError):
    """The structure is free to move; node (0-based) and direction name where."""

    def __init__(self, node: int, direction: str, ratio: float):
        super().__init__(f"node {node + 1} is free to move in {direction}")
        self.node, self.direction, self.ratio = node, direction, ratio


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
                f"a degree of freedom has the equation number {equations}, but at most {self.freedoms * self.nodes} "
                "(the number of degrees of freedom) is possible"
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
            int(behaviour.extent),
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
                    f"the matrix factor of {self.equations} equations requires {self.factor_values * 8 / 2**30:.1f} GiB "
                    f"of memory, but only {limit / 2**30:.1f} GiB are allowed: use larger elements"
                )
            check(status, "analysis of the stiffness matrix")
            self.factorise()
        except BaseException:
            self.close()
            raise

    def _add(self, group: Plane | Joints | Bars | Springs) -> None:
        add_group(self.handle, self.xy, self.freedoms, group)
        if isinstance(group, Plane | Joints):
            first = sum(len(g.connect) * n for g, _, n in self.plane_points)
            self.plane_points.append((group, first, group.points_each))

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
            raise ValueError("a run requires memory for at least one event and one monitored value")
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
            stack_rows(node, direction),
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
            stiffness = np.repeat(real_each("shear stiffness", group.shear_stiffness, len(group.connect)), per)[at - first]
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
