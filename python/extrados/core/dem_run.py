"""Runs of discrete elements in the core (fortran/dem/run.f90), of the plane (core.dem) or of space (core.dem3): from rest to
the end of a motion."""

import hashlib
import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar, Generic, TypeVar

import numpy as np
import numpy.typing as npt

from extrados import _core
from extrados.core import lists
from extrados.core.calls import indices, integers, interruptible, long_call, real, room_for, thread_count
from extrados.core.errors import check, status_code
from extrados.core.ground import Ground, MotionSet
from extrados.core.handles import Owner

#: Why a run ended, by the number the core gives.
REASONS = tuple(lists.words("dem_stop").values())
#: Rows of the energy balance [J].
ENERGIES = tuple(lists.words("dem_energy").values())
#: Between two pauses of a run that is watched: about so long [s]; the first one comes after a few steps.
PAUSE_SECONDS, FIRST_PAUSE = 0.5, 256
_DIGEST = 4  # words of a state that hold its SHA-256

#: No motion of the ground
STILL = Ground(breaks=np.array([0.0, 1.0]), linear=np.zeros((1, 1, 2)), harmonic=np.zeros((1, 1, 0, 4)))


@dataclass(frozen=True)
class Law:
    """A type of joint. Stiffnesses [Pa/m]; cohesion and tension of mortar, lost at the first failure [Pa]; damping: beta of
    stiffness-proportional damping [s]; strength: compressive strength by which corners crush, in the plane, 0 none [Pa]."""

    normal_stiffness: float
    shear_stiffness: float
    friction: float
    cohesion: float = field(default=0.0, kw_only=True)
    tension: float = field(default=0.0, kw_only=True)
    damping: float = field(default=0.0, kw_only=True)
    strength: float = field(default=0.0, kw_only=True)

    def __post_init__(self) -> None:
        if not (self.normal_stiffness > 0.0 and self.shear_stiffness > 0.0):
            raise ValueError(f"joint stiffnesses are {self.normal_stiffness:g} and {self.shear_stiffness:g} Pa/m, expected above 0")
        if min(self.friction, self.cohesion, self.tension, self.damping, self.strength) < 0.0:
            raise ValueError("friction, cohesion, tension, damping and strength of a joint must be 0 or above")
        if self.strength > 0.0 and max(self.cohesion, self.tension) > 0.0:
            raise ValueError("a joint whose corners crush cannot have cohesion or tension")


@dataclass(frozen=True)
class SupportMove:
    """A support that moves by `shift` between start and start + duration [s]: in the plane dx, dy [m] and rotation [rad], in space
    dx, dy, dz [m]."""

    body: int
    shift: tuple[float, float, float]
    start: float
    duration: float

    def times(self, factor: float) -> "SupportMove":
        """The same movement, larger by a factor."""
        x, y, z = self.shift
        return replace(self, shift=(factor * x, factor * y, factor * z))

    @property
    def values(self) -> list[float]:
        """As the core takes it."""
        return [*self.shift, self.start, self.duration]


@dataclass(frozen=True)
class RunOptions:
    """How to run. step [s]: 0 takes `fraction` of the critical step. settle_steps 0 starts without settling under gravity;
    settlement: displacement by which a body falls instead of settling [m], 0 none; settle_damping: beta of the joints until
    then, where their own is less [s]. collapse: displacement that counts as collapse [m], 0 none, of a body that also turned
    by more than `collapse_turn` [rad] or is lower by more than `collapse_drop` [m]; both 0: the displacement alone counts. residual_limit: of the total energy exchanged, above it the run is stopped. stop_at_rest: end once
    all rests and the ground is still. rigid: contacts without springs (the joints' stiffness and damping play no part, `step` 0
    takes one that suits the smallest block), with Newton's coefficient `rebound` at each point; quasi_static: without inertia. safe: kinetic energy, and energy of the places over those at rest, below which
    blocks recover, so that a run that stops at rest ends as soon as the ground is still; above: the latter energy at the start [J]."""

    end_time: float
    output_step: float = 0.01
    step: float = 0.0
    fraction: float = 0.3
    settle_steps: int = 400_000
    settle_tolerance: float = 1e-6
    settlement: float = 0.0
    collapse: float = 0.0
    residual_limit: float = 0.1
    settle_damping: float = 0.0
    collapse_turn: float = 0.0
    collapse_drop: float = 0.0
    stop_at_rest: bool = False
    threads: int = 1
    rigid: bool = False
    quasi_static: bool = False
    rebound: float = 0.0
    safe: float = 0.0
    above: float = 0.0


@dataclass(frozen=True)
class Effort:
    """What rigid contacts took: steps, factorisations, most rounds of a step, steps that did not converge, the greatest
    violation of the law over the velocity that gravity gives in a step, and when that was [s]. On springs all are 0, but for the
    open steps: those of each face in space whose pressure did not converge where faces crush."""

    steps: int
    factors: int
    most_rounds: int
    open_steps: int
    residual: float
    worst: float

    def with_(self, other: "Effort") -> "Effort":
        """Both runs together."""
        return Effort(
            self.steps + other.steps,
            self.factors + other.factors,
            max(self.most_rounds, other.most_rounds),
            self.open_steps + other.open_steps,
            *max((self.residual, self.worst), (other.residual, other.worst)),
        )


@dataclass(frozen=True)
class Ties:
    """Ties, chains and hoops (ties): one tension each along a line of points that the bodies carry (fortran/dem/ties.f90).

    stiffness: force per change of length [N/m], 0 of a dashpot alone; prestress, least and greatest tension [N]: least below 0 for compression,
    a bound of 0 is slackness, at another one it yields, infinite never. first: its first point; closed: the last
    point is joined to the first. Anchors (anchors): point, body, -1 for the ground, place (anchors, 2 or 3) as drawn [m];
    anchors of one point share its force in equal parts. damping: c of a dashpot beside each, of a power of the rate of its
    length [N (s/m)^power]. plastic: permanent elongation at the start (ties) [m].
    """

    stiffness: np.ndarray
    prestress: np.ndarray
    least: np.ndarray
    most: np.ndarray
    first: np.ndarray
    closed: np.ndarray
    body: np.ndarray
    point: np.ndarray
    place: np.ndarray
    damping: np.ndarray | None = None
    power: np.ndarray | None = None
    plastic: np.ndarray | float = 0.0

    def lengths(self) -> np.ndarray:
        """Length of each as drawn (ties) [m]."""
        points = np.zeros((int(self.point.max()) + 1, self.place.shape[1]))
        np.add.at(points, self.point, self.place)
        points /= np.bincount(self.point)[:, None]
        found = []
        for first, end, closed in zip(self.first, [*self.first[1:], len(points)], self.closed, strict=True):
            line = points[first:end]
            found.append(np.linalg.norm(np.diff(np.concatenate([line, line[:1]]) if closed else line, axis=0), axis=1).sum())
        return np.array(found)


@dataclass(frozen=True)
class DrawnContacts:
    """Contacts as drawn whose forces are recorded with their places (fortran/dem/places.f90).

    body (n, 2): two bodies that have a joint; corners: of each (k, 2 or 3) [m], in the plane both ends; normal (n, 2 or 3): unit vectors of
    either sense.
    """

    body: np.ndarray
    corners: list[np.ndarray]
    normal: np.ndarray


#: Before any run, and of springs
NO_EFFORT = Effort(0, 0, 0, 0, 0.0, 0.0)


@dataclass(frozen=True, kw_only=True)
class FoundRun:
    """A run. reason: see REASONS; blamed: the bodies that caused the stop.

    time (t) [s]; place (t, n, 3): x, y [m] and rotation [rad] relative to the ground, or in space the centroids [m]; rate
    (t, n, 3 or 6); energy: see ENERGIES, each (t) [J]; settled (n, 3): place after settling; residual: greatest energy from
    nowhere over the total energy exchanged; bounces and airborne time [s] of each body; tension (t, ties) [N]; extreme (ties, 3):
    least and greatest tension of any step after settling [N], plastic elongation at the end [m]; effort: of rigid contacts. joint_body
    (joints, 2): bodies that touched as drawn, ascending; joint_force (t, joints, 2 or 3): force on the first of them [N];
    joint_friction, joint_damping (t, joints): their losses so far by friction and in dashpots or impacts [J]. Of DrawnContacts:
    contact_force (t, n, 2 or 3): force on the body of the lower number [N]; contact_normal (t, n): sum of the compressive normal forces [N];
    contact_arm (t, n, 2 or 3): from the centroid of that body as drawn to their centre [m], NaN without a force.
    """

    reason: str
    blamed: list[int]
    time: np.ndarray
    place: np.ndarray
    rate: np.ndarray
    energy: dict[str, np.ndarray]
    settled: np.ndarray
    stop_time: float
    steps: int
    settling_steps: int
    searches: int
    most_pairs: int
    step: float
    critical_step: float
    residual: float
    bounces: np.ndarray
    airborne: np.ndarray
    tension: np.ndarray
    extreme: np.ndarray
    effort: Effort
    joint_body: np.ndarray
    joint_force: np.ndarray
    joint_friction: np.ndarray
    joint_damping: np.ndarray
    contact_force: np.ndarray
    contact_normal: np.ndarray
    contact_arm: np.ndarray
    interrupted: bool = False


Found = TypeVar("Found", bound=FoundRun)


class BodyModel(Owner, ABC, Generic[Found]):
    """Bodies and options in the core; runs under any number of motions, each from the same start."""

    #: Velocities of a body, and values that tell where it is and how it moves, by which answers are kept within bounds
    rates: ClassVar[int]
    values: ClassVar[int]
    #: Whether the ground may have two horizontal components
    in_space: ClassVar[bool] = False
    count: int
    options: RunOptions
    _ties: int = 0
    _joints: np.ndarray = np.empty((0, 2), dtype=int)
    #: Of the contacts whose forces are recorded: numbers in ascending order of their pairs, and the first body of each
    _drawn: np.ndarray = np.empty(0, dtype=int)
    _below: np.ndarray = np.empty(0, dtype=int)

    def _put_ties(self, ties: Ties | None, place: Callable[[np.ndarray, np.ndarray], np.ndarray]) -> None:
        """Ties; place: the places (anchors, 2 or 3) of anchors in the frames of their bodies (anchors), of none in the ground."""
        if ties is None:
            return
        n, anchors = len(ties.stiffness), len(ties.body)
        real("places of ties", ties.place, (anchors, None))
        bodies = integers("bodies of ties", np.asarray(ties.body) + 1, anchors)
        if np.any(bodies < 0) or np.any(bodies > self.count):
            raise IndexError(f"a tie refers to the number of a body that does not exist; the model has {self.count} bodies")
        if not np.bincount(integers("points of ties", ties.point, anchors)).all():
            raise ValueError("a point of a tie has no anchor body")
        on = np.flatnonzero(ties.body >= 0)
        own = np.zeros((anchors, 3))
        own[:, : ties.place.shape[1]] = ties.place
        local = place(ties.place[on], ties.body[on])
        own[on, : local.shape[1]] = local
        most = np.finfo(float).max
        values = [ties.stiffness, ties.lengths() + ties.plastic, ties.prestress, np.maximum(ties.least, -most), np.minimum(ties.most, most)]
        values += [np.zeros(n) if ties.damping is None else ties.damping, np.ones(n) if ties.power is None else ties.power]
        status = _core.api_dem_run.ties(
            self.handle,
            self.count,
            real("ties", np.array(values), (7, n)),
            integers("points", np.append(ties.first, ties.point.max() + 1) + 1),
            integers("closed", np.asarray(ties.closed, dtype=np.int32), n),
            bodies,
            integers("points", ties.point + 1, anchors),
            real("places of ties", own.T, (3, anchors)),
        )
        check(
            status, "ties: the stiffness or damping must be above 0, and the prestress must lie between the least and the greatest tension"
        )
        self._ties = n

    def _put_drawn(self, drawn: DrawnContacts | None, place: Callable[[np.ndarray, np.ndarray], np.ndarray]) -> None:
        """Contacts whose forces are recorded with their places; place: vectors (k, 2 or 3) as drawn in the frames of bodies (k)."""
        if drawn is None or not len(drawn.body):
            return
        rows = {(a, b): k for k, (a, b) in enumerate(self._joints.tolist())}
        pairs = [(min(a, b), max(a, b)) for a, b in drawn.body.tolist()]
        if any(pair not in rows for pair in pairs):
            raise IndexError("a contact whose force is recorded lies between bodies without a joint")
        row = np.array([rows[pair] for pair in pairs])
        order = np.argsort(row, kind="stable")
        first = np.array([pairs[k][0] for k in order])
        corners = [drawn.corners[k] for k in order]
        count = [len(x) for x in corners]
        own, normal = np.zeros((sum(count), 3)), np.zeros((len(order), 3))
        local = place(np.concatenate(corners), np.repeat(first, count))
        own[:, : local.shape[1]] = local
        way = place(drawn.normal[order], first) - place(np.zeros_like(drawn.normal), first)
        normal[:, : way.shape[1]] = way
        status = _core.api_dem_run.places(
            self.handle,
            integers("pairs of contacts", row[order] + 1),
            integers("corners of contacts", 1 + np.cumsum([0, *count])),
            real("corners of contacts", own.T, (3, None)),
            real("normals of contacts", normal.T, (3, None)),
        )
        check(status, "contacts whose forces are recorded")
        self._drawn, self._below = order, first

    def _drawn_forces(self, points: int) -> dict[str, np.ndarray]:
        """Forces of those contacts in the last run, by the names of FoundRun; arms in the frames of the bodies (t, n, 3) [m]."""
        n = len(self._drawn)
        press, status = _core.api_dem_run.place_forces(self.handle, n, points)
        check(status, "forces of the contacts")
        found = np.empty((points, n, 7))
        found[:, self._drawn] = press.T
        with np.errstate(divide="ignore", invalid="ignore"):
            arm = found[..., 4:] / found[..., 3, None]
        return {
            "contact_force": found[..., : 3 if self.in_space else 2],
            "contact_normal": found[..., 3],
            "contact_arm": self._drawn_arm(arm),
        }

    @abstractmethod
    def _drawn_arm(self, arm: np.ndarray) -> np.ndarray:
        """Vectors (t, n, 3) in the frames of the first bodies of contacts, as drawn (t, n, 2 or 3)."""

    def _put_moves(self, moves: Sequence[SupportMove], put: Callable[..., int]) -> None:
        """Movements of supports, by the routine `put` of the core."""
        if not moves:
            return
        body = indices("support moves", [m.body for m in moves], self.count, (None,))
        status = put(self.handle, body, real("support moves", np.transpose([move.values for move in moves]), (5, None)))
        check(status, "moving support: the body is not a support, or the duration is not positive")

    def _put_laws(self, laws: Sequence[Law]) -> None:
        status = _core.api_dem_run.laws(
            self.handle,
            *(
                real(name, [getattr(law, name) for law in laws], (len(laws),))
                for name in ("normal_stiffness", "shear_stiffness", "friction", "cohesion", "tension", "damping", "strength")
            ),
        )
        check(status, "laws of the joints")

    def _put_options(self, settle: bool) -> None:
        o = self.options
        if not (o.end_time > 0.0 and o.output_step > 0.0 and 0.0 < o.fraction <= 1.0):
            raise ValueError("end time, output step and the fraction of the critical step must be positive")
        status = _core.api_dem_run.options(
            self.handle,
            o.end_time,
            o.step,
            o.fraction,
            o.settle_tolerance,
            o.settlement,
            o.collapse,
            o.residual_limit,
            o.settle_damping,
            o.collapse_turn,
            o.collapse_drop,
            real("calm", [o.safe, o.above], (2,)),
            int(o.settle_steps) if settle else 0,
            int(o.stop_at_rest),
            thread_count(o.threads),
        )
        check(status, "options of the run")
        status = _core.api_dem_run.rigid(self.handle, int(o.rigid), int(o.quasi_static), float(o.rebound))
        check(status, "rebound of rigid contacts")

    def run(
        self,
        motions: MotionSet,
        motion: int = 0,
        *,
        scale: float = 1.0,
        across: int | None = None,
        times: npt.ArrayLike | None = None,
        state: np.ndarray | None = None,
        watch: Callable[[float], None] | None = None,
    ) -> Found:
        """Settle under gravity, then move the ground by `scale` times a motion of the set.

        across: motion of the set whose horizontal part is the other component, in space a quarter turn from `way` seen from
        above; of the plane none. times (frames): ascending output times [s] instead of every output_step. state: goes on where a run of this model, these
        times and this motion had paused. watch: the run pauses now and then, and when it is interrupted, tells the time
        it has come to [s], and may be asked for its `state`. Neither changes a bit of the result.
        """
        o = self.options
        if times is None:
            room_for(self.values, self.count, int(min(o.end_time / o.output_step, 1e12)) + 1)
            times = np.arange(round(o.end_time / o.output_step * (1 - 1e-12)) + 1) * o.output_step
        wanted = real("times", times, (None,))
        if not len(wanted) or np.any(np.diff(wanted) < 0.0):
            raise ValueError("output times must increase, and at least one output time is required")
        for number in (motion, across or 0):
            if not 0 <= number < len(motions):
                raise IndexError(f"motion number {number} does not exist: the set has {len(motions)} motions")
        if across is not None and not self.in_space:
            raise ValueError("a plane model takes one horizontal component only")
        if not np.isfinite(scale):
            raise ValueError(f"the scale factor of the motion is {scale}, expected a number")
        other = 0 if across is None else int(across) + 1
        where = (self.handle, motions.handle, int(motion) + 1, other, float(scale))
        steps = FIRST_PAUSE if watch else 0
        with interruptible():
            if state is None:
                check(_core.api_dem_run.start(self.handle, wanted), self.what)
            else:
                self._resume(state, wanted)
            paused, reached, status = long_call(_core.api_dem_run.run, *where, steps)
            while paused and watch:
                watch(reached)
                if status != status_code("ok"):
                    break
                begin = time.perf_counter()
                paused, reached, status = long_call(_core.api_dem_run.run, *where, steps)
                ideal = steps * PAUSE_SECONDS / max(time.perf_counter() - begin, 1e-6)
                steps = int(min(max(1.0, ideal), 8.0 * steps, 1e9))
        interrupted = status == status_code("cancelled")
        if not interrupted:
            check(status, self.what)
        return self._last_run(interrupted)

    def run_pieces(self, motions: MotionSet, times: npt.ArrayLike, steps: int) -> Iterator[tuple[Found, bool]]:
        """The run under the first motion as it grows by `steps` time steps at a time, and whether that is all of it; times
        (frames): ascending output times [s]."""
        wanted = real("times", times, (None,))
        check(_core.api_dem_run.start(self.handle, wanted), self.what)
        paused = True
        while paused:
            paused, _, status = long_call(_core.api_dem_run.run, self.handle, motions.handle, 1, 0, 1.0, steps)
            check(status, self.what)
            yield self._last_run(False), not paused

    def state(self) -> np.ndarray:
        """The whole state (words) of a run that has paused, for `run` of this build alone; HandleError where none has."""
        words, status = _core.api_dem_run.state_size(self.handle)
        check(status, "state of a run that was paused")
        state, status = _core.api_dem_run.state(self.handle, int(words))
        check(status, "state of the run")
        return np.concatenate([state, state_digest(state)])

    def _resume(self, state: np.ndarray, wanted: np.ndarray) -> None:
        """ValueError where the state is damaged or none of this model, these times and this build."""
        status = _core.api_dem_run.resume(self.handle, wanted, state_words(state))
        if status == status_code("out_of_memory"):
            check(status, "state of the run")
        if status != status_code("ok"):
            raise ValueError("this saved state belongs to a run of another model, with other output times, or of another build of extrados")

    @abstractmethod
    def _last_run(self, interrupted: bool) -> Found:
        """What the core has of the last run."""

    def _recorded(self, interrupted: bool) -> dict[str, Any]:
        """What the core tells of the last run of any bodies, by the names of FoundRun."""
        counts, measures, status = _core.api_dem_run.summary(self.handle)
        check(status, "how the run ended")
        points, reason, first, second, settling, searches, pairs, steps = (int(k) for k in counts)
        when, place, rate, energy, status = _core.api_dem_run.history(self.handle, self.count, self.rates, points)
        check(status, "history of the run")
        least_step, critical_step, stop_time, residual = (float(value) for value in measures)
        tension, extreme, status = _core.api_dem_run.tensions(self.handle, self._ties, points)
        check(status, "tensions of the ties")
        took, measures, status = _core.api_dem_run.effort(self.handle)
        check(status, "effort of the run")
        joint, status = _core.api_dem_run.joint_forces(self.handle, len(self._joints), points)
        check(status, "forces of the joints")
        return {
            "reason": REASONS[reason],
            "blamed": [k - 1 for k in (first, second) if k > 0],
            "time": when,
            "place": place.T,
            "rate": rate.T,
            "energy": dict(zip(ENERGIES, energy, strict=True)),
            "stop_time": stop_time,
            "steps": steps,
            "settling_steps": settling,
            "searches": searches,
            "most_pairs": pairs,
            "step": least_step,
            "critical_step": critical_step,
            "residual": residual,
            "interrupted": interrupted,
            "tension": tension.T,
            "extreme": extreme.T,
            "joint_body": self._joints,
            "joint_force": joint[: 3 if self.in_space else 2].T,
            "joint_friction": joint[3].T,
            "joint_damping": joint[4].T,
            **self._drawn_forces(points),
            "effort": Effort(*(int(n) for n in took), *(float(value) for value in measures)),
        }


def state_words(state: np.ndarray) -> np.ndarray:
    """The words (words) of a state that was kept with its digest; ValueError where they are damaged."""
    state = np.ascontiguousarray(state, dtype=np.int64)
    words = state[:-_DIGEST]
    if state.ndim != 1 or not np.array_equal(state[-_DIGEST:], state_digest(words)):
        raise ValueError("the state of the run is damaged")
    return words


def state_digest(words: np.ndarray) -> np.ndarray:
    """What tells damaged words: four more (4)."""
    return np.frombuffer(hashlib.sha256(words.tobytes()).digest(), dtype=np.int64)
