"""Discrete elements in space in the core (fortran/dem3): one run of rigid polyhedra, from rest to the end of a motion."""

import time
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
import numpy.typing as npt

from extrados import _core
from extrados.core import lists
from extrados.core.calls import indices, integers, interruptible, long_call, real, room_for, thread_count
from extrados.core.dem import FIRST_PAUSE, PAUSE_SECONDS, STILL, state_digest, state_words
from extrados.core.errors import check, status_code
from extrados.core.ground import Ground, MotionSet, as_motion_set
from extrados.core.handles import Owner
from extrados.schema.constants import GRAVITY

REASONS = tuple(lists.words("dem_stop").values())
ENERGIES = tuple(lists.words("dem_energy").values())


@dataclass(frozen=True)
class Law:
    """A type of dry joint. Stiffnesses [Pa/m]; damping: beta of stiffness-proportional damping [s]."""

    normal_stiffness: float
    shear_stiffness: float
    friction: float
    damping: float = 0.0

    def __post_init__(self) -> None:
        if not (self.normal_stiffness > 0.0 and self.shear_stiffness > 0.0):
            raise ValueError(
                f"joint stiffnesses are {self.normal_stiffness:g} and {self.shear_stiffness:g} Pa/m, expected above 0"
            )
        if min(self.friction, self.damping) < 0.0:
            raise ValueError("friction and damping of a joint must not be negative")


@dataclass(frozen=True)
class Solids:
    """Rigid bodies made of convex polyhedra, as they lie at the start.

    centroid (n, 3) [m]; mass (n) [kg], 0 for a support; inertia (n, 3, 3) about the centroids [kg m^2]. Part k is the
    polyhedron of vertices[k] (nv, 3) [m] and faces[k], the numbers of the vertices of each face, counter-clockwise from
    outside; it belongs to body owner[k]. joints: (body, body) -> index of its law; law 0 is that of contacts that form later.
    """

    centroid: np.ndarray
    mass: np.ndarray
    inertia: np.ndarray
    vertices: list[np.ndarray]
    faces: list[tuple[tuple[int, ...], ...]]
    owner: list[int]
    laws: list[Law]
    joints: dict[tuple[int, int], int] = field(default_factory=dict)


@dataclass(frozen=True)
class Options:
    """How to run. step [s]: 0 takes `fraction` of the critical step. collapse: displacement that counts as collapse [m], 0
    none; domain: by which a body has left the scene [m], 0 none. stop_at_rest: end once all rests and the ground is still. residual_limit: of the energy that went round, above it the run is stopped. settle_steps 0 starts without settling
    under gravity; settlement: displacement by which a body falls instead of settling [m], 0 none. way: direction of the
    horizontal ground motion."""

    end_time: float
    output_step: float = 0.01
    step: float = 0.0
    fraction: float = 0.3
    settle_steps: int = 400_000
    settle_tolerance: float = 1e-6
    settlement: float = 0.0
    collapse: float = 0.0
    domain: float = 0.0
    stop_at_rest: bool = False
    residual_limit: float = 0.1
    gravity: tuple[float, float, float] = (0.0, 0.0, -GRAVITY)
    way: tuple[float, float, float] = (1.0, 0.0, 0.0)
    threads: int = 1


@dataclass(frozen=True)
class Run:
    """A run. reason: see REASONS; blamed: the body that caused the stop, if one did.

    time (t) [s]; place (t, n, 3) of the centroids [m]; turn (t, n, 3, 3): rotation matrices from the attitude at the start;
    rate (t, n, 6): velocity and spin; energy: see ENERGIES, each (t) [J]; settled (n, 3) and settled_turn (n, 3, 3) after
    settling; bounces (n): times that a body left all that it touched, airborne (n): time without contact [s]; residual:
    greatest energy from nowhere over the energy that went round.
    """

    reason: str
    blamed: list[int]
    time: np.ndarray
    place: np.ndarray
    turn: np.ndarray
    rate: np.ndarray
    energy: dict[str, np.ndarray]
    settled: np.ndarray
    settled_turn: np.ndarray
    bounces: np.ndarray
    airborne: np.ndarray
    stop_time: float
    steps: int
    settling_steps: int
    searches: int
    most_pairs: int
    step: float
    critical_step: float
    residual: float
    interrupted: bool = False


class Model(Owner):
    """Solids, joints and options in the core; runs under any number of motions, each from the same start.

    rate (n, 6): velocities and spins at the start, which is then not settled. ValueError or IndexError where a body or a law
    is named that is not there.
    """

    what = "model of discrete elements in space"

    def __init__(self, solids: Solids, options: Options, *, rate: np.ndarray | None = None):
        if not (options.end_time > 0.0 and options.output_step > 0.0 and 0.0 < options.fraction <= 1.0):
            raise ValueError("end time, output step and the fraction of the critical step must be positive")
        if not solids.laws or any(not 0 <= k < len(solids.laws) for k in solids.joints.values()):
            raise ValueError("a joint names a law that is not there")
        n, parts = len(solids.mass), len(solids.vertices)
        mobile = np.asarray(solids.mass, dtype=float) > 0.0
        principal, axes = np.linalg.eigh(np.where(mobile[:, None, None], solids.inertia, np.eye(3)))
        axes[np.linalg.det(axes) < 0.0, :, 2] *= -1.0
        owner = indices("owner", solids.owner, n, (parts,))
        own = [
            (np.asarray(v, dtype=float) - solids.centroid[k]) @ axes[k]
            for v, k in zip(solids.vertices, solids.owner, strict=True)
        ]
        first = np.cumsum([0, *map(len, own)])
        loops = [
            np.asarray(face) + start + 1
            for faces, start in zip(solids.faces, first[:-1].tolist(), strict=True)
            for face in faces
        ]
        ends = np.cumsum([0, *(len(faces) for faces in solids.faces)])
        table = np.array([[*owner, 0], 1 + first, 1 + ends], dtype=np.int32, order="F")
        handle, status = _core.api_dem3.create(
            real("centroid", np.transpose(solids.centroid), (3, n)),
            real("axes", np.moveaxis(axes, 0, -1), (3, 3, n)),
            real("mass", np.vstack([np.where(mobile, solids.mass, 0.0), principal.T]), (4, n)),
            table,
            real("vertices", np.concatenate(own).T, (3, int(first[-1]))),
            integers("faces", 1 + np.cumsum([0, *map(len, loops)])),
            integers("loops", np.concatenate(loops)),
        )
        check(status, "solids")
        super().__init__(handle)
        self.count, self.options, self._axes = n, options, axes
        try:
            rows = [[law.normal_stiffness, law.shear_stiffness, law.friction, law.damping] for law in solids.laws]
            pairs = sorted((*sorted(pair), law) for pair, law in solids.joints.items())
            joints = np.array(pairs, dtype=int).reshape(-1, 3).T
            if pairs:
                indices("joints", joints[:2], n, (2, None))
            status = _core.api_dem3.laws(
                self.handle, real("laws", np.transpose(rows), (4, None)), np.asfortranarray(joints + 1, dtype=np.int32)
            )
            check(status, "laws of the joints")
            o = options
            numbers = [
                o.end_time, o.step, o.fraction, o.settle_tolerance, o.settlement, o.collapse, o.domain, o.residual_limit,
            ]  # fmt: skip
            status = _core.api_dem3.settings(
                self.handle, real("limits", numbers, (8,)), int(o.settle_steps) if rate is None else 0, int(o.stop_at_rest),
                thread_count(o.threads),
                real("gravity", o.gravity, (3,)), real("way", o.way, (3,)),
                real("rate", np.transpose(np.zeros((n, 6)) if rate is None else rate), (6, n)),
            )  # fmt: skip
            check(status, "options of the run")
        except BaseException:
            self.close()
            raise

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
        """Settle under gravity, then move the ground by `scale` times a motion of the set: horizontally along the way of the
        options, and upward.

        times: ascending output times [s] instead of every output_step. state: goes on where a run of this model, these
        times and this motion had paused. watch: the run pauses now and then, and when it is interrupted, tells the time
        it has come to [s], and may be asked for its `state`. Neither changes a bit of the result.
        """
        o = self.options
        if times is None:
            room_for(18, self.count, int(min(o.end_time / o.output_step, 1e12)) + 1)
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
                paused, reached, status = long_call(_core.api_dem3.run, *where, wanted, steps)
            else:
                self._resume(state, wanted)
                paused, reached, status = long_call(_core.api_dem3.go_on, *where, steps)
            while paused and watch:
                watch(reached)
                if status != status_code("ok"):
                    break
                begin = time.perf_counter()
                paused, reached, status = long_call(_core.api_dem3.go_on, *where, steps)
                ideal = steps * PAUSE_SECONDS / max(time.perf_counter() - begin, 1e-6)
                steps = int(min(max(1.0, ideal), 8.0 * steps, 1e9))
        interrupted = status == status_code("cancelled")
        if not interrupted:
            check(status, "discrete elements in space")
        return self._last_run(interrupted)

    def state(self) -> np.ndarray:
        """The whole state of a run that has paused, for `run` of this build alone; HandleError where none has."""
        words, status = _core.api_dem3.state_size(self.handle)
        check(status, "state of a run that has paused")
        state, status = _core.api_dem3.state(self.handle, int(words))
        check(status, "state of the run")
        return np.concatenate([state, state_digest(state)])

    def _resume(self, state: np.ndarray, wanted: np.ndarray) -> None:
        """ValueError where the state is damaged or none of this model, these times and this build."""
        status = _core.api_dem3.resume(self.handle, wanted, state_words(state))
        if status == status_code("out_of_memory"):
            check(status, "state of the run")
        if status != status_code("ok"):
            raise ValueError("the state is of a run of another model, of other times or of another build")

    def _last_run(self, interrupted: bool) -> Run:
        counts, measures, status = _core.api_dem3.summary(self.handle)
        check(status, "how the run ended")
        points, reason, blamed, settling, searches, pairs, steps = (int(k) for k in counts)
        when, place, turn, rate, energy, status = _core.api_dem3.history(self.handle, self.count, points)
        check(status, "history of the run")
        settled, settled_turn, bounces, airborne, status = _core.api_dem3.bodies(self.handle, self.count)
        check(status, "bodies after the run")
        axes = np.moveaxis(turn, (2, 3), (1, 0))  # (t, n, 3, 3): columns are the own axes
        return Run(
            reason=REASONS[reason], blamed=[blamed - 1] if blamed else [], time=when, place=place.T,
            turn=axes @ np.swapaxes(self._axes, 1, 2), rate=rate.T,
            energy=dict(zip(ENERGIES, energy, strict=True)), settled=settled.T,
            settled_turn=np.moveaxis(settled_turn, 2, 0) @ np.swapaxes(self._axes, 1, 2), bounces=bounces, airborne=airborne,
            stop_time=float(measures[2]), steps=steps,
            settling_steps=settling, searches=searches, most_pairs=pairs, step=float(measures[0]),
            critical_step=float(measures[1]), residual=float(measures[3]), interrupted=interrupted,
        )  # fmt: skip


def run(
    solids: Solids,
    options: Options,
    ground: Ground | None = None,
    *,
    scale: float = 1.0,
    rate: np.ndarray | None = None,
    times: np.ndarray | None = None,
) -> Run:
    """One run of a model that is made for it; see Model and Model.run. No ground: it stands still."""
    with Model(solids, options, rate=rate) as model, as_motion_set([ground or STILL]) as motions:
        return model.run(motions, scale=scale, times=times)
