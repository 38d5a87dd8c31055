"""Discrete elements in the core (fortran/dem): one run of rigid plane blocks, from rest to the end of a motion."""

import hashlib
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from extrados import _core
from extrados.core import lists
from extrados.core.calls import indices, integers, interruptible, long_call, real, room_for, thread_count
from extrados.core.errors import check, status_code
from extrados.core.ground import Ground, MotionSet, as_motion_set
from extrados.core.handles import Owner
from extrados.schema.constants import GRAVITY

#: Why a run ended, by the number the core gives.
REASONS = tuple(lists.words("dem_stop").values())
#: Rows of the energy ledger [J].
ENERGIES = tuple(lists.words("dem_energy").values())


@dataclass(frozen=True)
class Law:
    """A type of joint. Stiffnesses [Pa/m], cohesion and tension of mortar, lost at the first failure [Pa],
    damping: beta of stiffness-proportional damping [s]."""

    normal_stiffness: float
    shear_stiffness: float
    friction: float
    cohesion: float = 0.0
    tension: float = 0.0
    damping: float = 0.0

    def __post_init__(self) -> None:
        if not (self.normal_stiffness > 0.0 and self.shear_stiffness > 0.0):
            raise ValueError(
                f"joint stiffnesses are {self.normal_stiffness:g} and {self.shear_stiffness:g} Pa/m, expected above 0"
            )
        if min(self.friction, self.cohesion, self.tension, self.damping) < 0.0:
            raise ValueError("friction, cohesion, tension and damping of a joint must not be negative")


@dataclass(frozen=True)
class Bodies:
    """Rigid bodies made of convex parts, as they lie at the start.

    centroid (n, 2) [m]; mass (n) [kg], 0 for a support; inertia (n) [kg m^2]. Part k is the convex polygon
    `parts[k]` (vertices, 2) [m], counter-clockwise, of body owner[k]; outer[k] tells for each of its edges
    whether it lies on the outline of the body. joints: (body, body) -> index of its law; law 0 is that of
    contacts that form later. depth out of plane [m].
    """

    centroid: np.ndarray
    mass: np.ndarray
    inertia: np.ndarray
    parts: list[np.ndarray]
    owner: list[int]
    outer: list[np.ndarray]
    depth: float
    laws: list[Law]
    joints: dict[tuple[int, int], int] = field(default_factory=dict)


@dataclass(frozen=True)
class SupportMove:
    """A support that moves by dx, dy [m] and turns [rad] between start and start + duration [s]."""

    body: int
    dx: float
    dy: float
    turn: float
    start: float
    duration: float


@dataclass(frozen=True)
class Options:
    """How to run. step [s]: 0 takes `fraction` of the critical step. domain: left, right, bottom, top [m].
    collapse: displacement that counts as collapse [m], 0 none. residual_limit: of the energy that went round,
    above it the run is stopped. settle_steps 0 starts without settling under gravity; settlement: displacement by
    which a body falls instead of settling [m], 0 none. rigid: contacts without springs (the joints' stiffness and damping
    play no part, `step` 0 takes one that suits the smallest block), with Newton's coefficient `rebound` at each point;
    quasi_static: without inertia."""

    end_time: float
    output_step: float = 0.01
    step: float = 0.0
    fraction: float = 0.3
    settle_steps: int = 400_000
    settle_tolerance: float = 1e-6
    settlement: float = 0.0
    collapse: float = 0.0
    domain: tuple[float, float, float, float] = (-1e30, 1e30, -1e30, 1e30)
    residual_limit: float = 0.1
    stop_at_rest: bool = False
    moving_base: bool = False
    mass_damping: float = 0.0
    rigid: bool = False
    quasi_static: bool = False
    rebound: float = 0.0
    gravity: tuple[float, float] = (0.0, -GRAVITY)
    threads: int = 1


@dataclass(frozen=True)
class Contacts:
    """Contact points closed at the end: bodies (n, 2), point (n, 2) [m], force on the second body (n, 2) [N],
    normal and shear force [N]."""

    bodies: np.ndarray
    point: np.ndarray
    force: np.ndarray
    normal: np.ndarray
    shear: np.ndarray


@dataclass(frozen=True)
class Effort:
    """What rigid contacts took: steps, factorisations, most rounds of a step, steps that did not converge, and the greatest
    violation of the law over the velocity that gravity gives in a step."""

    steps: int
    factors: int
    most_rounds: int
    open_steps: int
    residual: float

    def with_(self, other: "Effort") -> "Effort":
        """Both runs together."""
        return Effort(
            self.steps + other.steps, self.factors + other.factors, max(self.most_rounds, other.most_rounds),
            self.open_steps + other.open_steps, max(self.residual, other.residual),
        )  # fmt: skip


@dataclass(frozen=True)
class Run:
    """A run. reason: see REASONS; blamed: the bodies that caused the stop.

    time (t) [s]; place (t, n, 3): x, y [m], rotation [rad] relative to the ground; rate (t, n, 3); energy: see
    ENERGIES, each (t) [J]; settled (n, 3): place after settling; residual: greatest energy from nowhere over
    the energy that went round; bounces and airborne time [s] of each body.
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
    contacts: Contacts
    effort: Effort
    interrupted: bool = False


#: Between two pauses of a run that is watched: about so long [s]; the first one comes after a few steps.
PAUSE_SECONDS, FIRST_PAUSE = 0.5, 256
_DIGEST = 4  # words of a state that hold its SHA-256

#: No motion of the ground
STILL = Ground(breaks=np.array([0.0, 1.0]), linear=np.zeros((1, 1, 2)), harmonic=np.zeros((1, 1, 0, 4)))


class Model(Owner):
    """Bodies, joints and options in the core; runs under any number of motions, each from the same start.

    shift, rate (n, 3): initial displacement and velocity about the centroids, without settling. Bodies and laws
    are counted from 0; ValueError or IndexError where one is named that is not there.
    """

    what = "model of discrete elements"

    def __init__(
        self,
        bodies: Bodies,
        options: Options,
        *,
        shift: np.ndarray | None = None,
        rate: np.ndarray | None = None,
        moves: Sequence[SupportMove] = (),
    ):
        if not (options.end_time > 0.0 and options.output_step > 0.0 and 0.0 < options.fraction <= 1.0):
            raise ValueError("end time, output step and the fraction of the critical step must be positive")
        if not bodies.laws or any(not 0 <= k < len(bodies.laws) for k in bodies.joints.values()):
            raise ValueError("a joint names a law that is not there")
        n, parts = len(bodies.mass), len(bodies.parts)
        corners = [len(part) for part in bodies.parts]
        handle, status = _core.api_dem.create(
            real("centroid", np.transpose(bodies.centroid), (2, n)),
            real("mass", bodies.mass, (n,)),
            real("inertia", bodies.inertia, (n,)),
            indices("owner", bodies.owner, n, (parts,)),
            integers("first", np.concatenate([[1], 1 + np.cumsum(corners)])),
            real("vertices", np.concatenate(bodies.parts).T, (2, sum(corners))),
            integers("outer", np.concatenate(bodies.outer).astype(np.int32), sum(corners)),
        )
        check(status, "bodies")
        super().__init__(handle)
        self.count = n
        self.options = options
        try:
            self._put_joints(bodies)
            if shift is not None or rate is not None:
                nothing = np.zeros((n, 3))
                status = _core.api_dem.start(
                    self.handle,
                    real("shift", np.transpose(nothing if shift is None else shift), (3, n)),
                    real("rate", np.transpose(nothing if rate is None else rate), (3, n)),
                )
                check(status, "initial displacements")
            self._put_moves(moves)
            self._put_options(settle=shift is None and rate is None)
        except BaseException:
            self.close()
            raise

    def _put_joints(self, bodies: Bodies) -> None:
        depth = bodies.depth
        rows = [
            [
                law.normal_stiffness * depth, law.shear_stiffness * depth, law.friction, law.cohesion * depth,
                law.tension * depth, law.damping,
            ]
            for law in bodies.laws
        ]  # fmt: skip
        check(_core.api_dem.laws(self.handle, real("laws", np.transpose(rows), (6, None))), "laws of the joints")
        if bodies.joints:
            pairs = indices("joints", np.transpose(list(bodies.joints)), self.count, (2, None))
            law = indices("joints", list(bodies.joints.values()), len(bodies.laws), (None,))
            check(_core.api_dem.joints(self.handle, pairs, law), "joints")

    def _put_moves(self, moves: Sequence[SupportMove]) -> None:
        if not moves:
            return
        values = [[m.dx, m.dy, m.turn, m.start, m.duration] for m in moves]
        status = _core.api_dem.moves(
            self.handle,
            indices("support moves", [m.body for m in moves], self.count, (None,)),
            real("support moves", np.transpose(values), (5, None)),
        )
        check(status, "support moves: a body that is no support, or no duration")

    def _put_options(self, settle: bool) -> None:
        o = self.options
        limits = [o.end_time, o.step, o.fraction, o.settle_tolerance, o.collapse, o.residual_limit, o.settlement]
        status = _core.api_dem.settings(
            self.handle, real("gravity", o.gravity, (2,)), float(o.mass_damping), int(o.moving_base),
            real("limits", limits, (7,)), real("domain", o.domain, (4,)), int(o.settle_steps) if settle else 0,
            int(o.stop_at_rest), thread_count(o.threads),
        )  # fmt: skip
        check(status, "options of the run")
        status = _core.api_dem.rigid(self.handle, int(o.rigid), int(o.quasi_static), float(o.rebound))
        check(status, "rebound of rigid contacts")

    def run(
        self,
        motions: MotionSet,
        motion: int = 0,
        *,
        scale: float = 1.0,
        times: npt.ArrayLike | None = None,
        state: np.ndarray | None = None,
        watch: Callable[[float], None] | None = None,
    ) -> Run:
        """Settle under gravity, then move the ground by `scale` times a motion of the set.

        times: ascending output times [s] instead of every output_step. state: goes on where a run of this model, these
        times and this motion had paused. watch: the run pauses now and then, and when it is interrupted, tells the time
        it has come to [s], and may be asked for its `state`. Neither changes a bit of the result.
        """
        o = self.options
        if times is None:
            room_for(3, self.count, int(min(o.end_time / o.output_step, 1e12)) + 1)
            times = np.arange(round(o.end_time / o.output_step * (1 - 1e-12)) + 1) * o.output_step
        wanted = real("times", times, (None,))
        if not len(wanted) or np.any(np.diff(wanted) < 0.0):
            raise ValueError("output times must ascend, and there must be one")
        if not 0 <= motion < len(motions):
            raise IndexError(f"motion {motion} is not in the set of {len(motions)}")
        if not np.isfinite(scale):
            raise ValueError(f"scale is {scale}, expected a number")
        where = (self.handle, motions.handle, int(motion) + 1, float(scale))
        steps = FIRST_PAUSE if watch else 0
        with interruptible():
            if state is None:
                paused, reached, status = long_call(_core.api_dem.run, *where, wanted, steps)
            else:
                self._resume(state, wanted)
                paused, reached, status = long_call(_core.api_dem.go_on, *where, steps)
            while paused and watch:
                watch(reached)
                if status != status_code("ok"):
                    break
                begin = time.perf_counter()
                paused, reached, status = long_call(_core.api_dem.go_on, *where, steps)
                ideal = steps * PAUSE_SECONDS / max(time.perf_counter() - begin, 1e-6)
                steps = int(min(max(1.0, ideal), 8.0 * steps, 1e9))
        interrupted = status == status_code("cancelled")
        if not interrupted:
            check(status, "discrete elements")
        return self._last_run(interrupted)

    def state(self) -> np.ndarray:
        """The whole state of a run that has paused, for `run` of this build alone; HandleError where none has."""
        words, status = _core.api_dem.state_size(self.handle)
        check(status, "state of a run that has paused")
        state, status = _core.api_dem.state(self.handle, int(words))
        check(status, "state of the run")
        return np.concatenate([state, state_digest(state)])

    def _resume(self, state: np.ndarray, wanted: np.ndarray) -> None:
        """ValueError where the state is damaged or none of this model, these times and this build."""
        status = _core.api_dem.resume(self.handle, wanted, state_words(state))
        if status == status_code("out_of_memory"):
            check(status, "state of the run")
        if status != status_code("ok"):
            raise ValueError("the state is of a run of another model, of other times or of another build")

    def _last_run(self, interrupted: bool) -> Run:
        counts, measures, status = _core.api_dem.summary(self.handle)
        check(status, "how the run ended")
        points, reason, first, second, settling, searches, pairs, steps, closed = (int(k) for k in counts)
        if points:
            time, place, rate, energy, status = _core.api_dem.history(self.handle, self.count, points)
            check(status, "history of the run")
        else:
            time, energy = np.zeros(0), np.zeros((len(ENERGIES), 0))
            place = rate = np.zeros((3, self.count, 0))
        settled, bounces, airborne, status = _core.api_dem.bodies(self.handle, self.count)
        check(status, "bodies after the run")
        touching, contact = np.zeros((2, 0), dtype=np.int32), np.zeros((6, 0))
        if closed:
            touching, contact, status = _core.api_dem.contacts(self.handle, closed)
            check(status, "contacts after the run")
        effort, violation, status = _core.api_dem.effort(self.handle)
        check(status, "effort of the run")
        return Run(
            reason=REASONS[reason],
            blamed=[k - 1 for k in (first, second) if k > 0],
            time=time,
            place=place.T,
            rate=rate.T,
            energy=dict(zip(ENERGIES, energy, strict=True)),
            settled=settled.T,
            stop_time=float(measures[2]),
            steps=steps,
            settling_steps=settling,
            searches=searches,
            most_pairs=pairs,
            step=float(measures[0]),
            critical_step=float(measures[1]),
            residual=float(measures[3]),
            bounces=bounces,
            airborne=airborne,
            contacts=Contacts(touching.T - 1, contact.T[:, :2], contact.T[:, 2:4], contact[4], contact[5]),
            effort=_effort(effort, violation),
            interrupted=interrupted,
        )


def _effort(counts: np.ndarray, violation: float) -> Effort:
    steps, factors, rounds, open_steps = (int(n) for n in counts)
    return Effort(steps, factors, rounds, open_steps, float(violation))


def state_words(state: np.ndarray) -> np.ndarray:
    """The words of a state that was kept with its digest; ValueError where they are damaged."""
    state = np.ascontiguousarray(state, dtype=np.int64)
    words = state[:-_DIGEST]
    if state.ndim != 1 or not np.array_equal(state[-_DIGEST:], state_digest(words)):
        raise ValueError("the state of the run is damaged")
    return words


def state_digest(words: np.ndarray) -> np.ndarray:
    """What tells a damaged state."""
    return np.frombuffer(hashlib.sha256(words.tobytes()).digest(), dtype=np.int64)


def run(
    bodies: Bodies,
    options: Options,
    ground: Ground | None = None,
    *,
    scale: float = 1.0,
    shift: np.ndarray | None = None,
    rate: np.ndarray | None = None,
    moves: tuple[SupportMove, ...] = (),
    times: np.ndarray | None = None,
) -> Run:
    """One run of a model that is made for it; see Model and Model.run. No ground: it stands still."""
    with (
        Model(bodies, options, shift=shift, rate=rate, moves=moves) as model,
        as_motion_set([ground or STILL]) as motions,
    ):
        return model.run(motions, scale=scale, times=times)
