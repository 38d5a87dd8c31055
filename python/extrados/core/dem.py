"""Discrete elements of the plane in the core (fortran/dem): rigid blocks, their joints, and what a run leaves of them."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from extrados import _core
from extrados.core.calls import indices, integers, real
from extrados.core.dem_run import STILL, BodyModel, DrawnContacts, FoundRun, Law, RunOptions, SupportMove, Ties
from extrados.core.errors import check
from extrados.core.ground import Ground, as_motion_set
from extrados.schema.constants import GRAVITY


@dataclass(frozen=True)
class Bodies:
    """Rigid bodies made of convex parts, as they lie at the start.

    centroid (n, 2) [m]; mass (n) [kg], 0 for a support; inertia (n) [kg m^2]. Part k is the convex polygon
    `parts[k]` (vertices, 2) [m], counter-clockwise, of body owner[k]; outer[k] tells for each of its edges
    whether it lies on the outline of the body. joints: (body, body) -> index of its law; law 0 is that of
    contacts that form later. depth out of plane [m]. load (n, 4): constant force x, y [N], its moment about the centroid and the
    sum of arm times force [N m]; the places of these forces rotate with the body, their directions do not.
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
    ties: Ties | None = None
    drawn: DrawnContacts | None = None
    load: np.ndarray | None = None


@dataclass(frozen=True)
class Options(RunOptions):
    """How to run; see also RunOptions. domain: left, right, bottom, top [m]."""

    domain: tuple[float, float, float, float] = (-1e30, 1e30, -1e30, 1e30)
    moving_base: bool = False
    mass_damping: float = 0.0
    gravity: tuple[float, float] = (0.0, -GRAVITY)


@dataclass(frozen=True)
class Contacts:
    """Contact points closed at the end: bodies (n, 2), point (n, 2) [m], force on the second body (n, 2) [N],
    normal and shear force [N]."""

    bodies: np.ndarray
    point: np.ndarray
    force: np.ndarray
    normal: np.ndarray
    shear: np.ndarray


@dataclass(frozen=True, kw_only=True)
class Run(FoundRun):
    """A run, and what holds the blocks at its end."""

    contacts: Contacts


class Model(BodyModel[Run]):
    """Bodies, joints and options in the core; runs under any number of motions, each from the same start.

    shift, rate (n, 3): initial displacement and velocity about the centroids, without settling. Bodies and laws
    are counted from 0; ValueError or IndexError where one is named that is not there.
    """

    what = "model of discrete elements"
    rates, values = 3, 3
    options: Options

    def __init__(
        self,
        bodies: Bodies,
        options: Options,
        *,
        shift: np.ndarray | None = None,
        rate: np.ndarray | None = None,
        moves: Sequence[SupportMove] = (),
    ):
        if not bodies.laws or any(not 0 <= k < len(bodies.laws) for k in bodies.joints.values()):
            raise ValueError("a joint refers to the number of a joint law that does not exist")
        if options.rigid and any(law.strength > 0.0 for law in bodies.laws):
            raise ValueError("crushing of corners requires springs at the joints")
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
            if bodies.load is not None:
                check(_core.api_dem.loads(self.handle, real("load", np.transpose(bodies.load), (4, n))), "constant loads")
            self._put_ties(bodies.ties, lambda place, body: place[:, :2] - bodies.centroid[body])
            self._put_drawn(bodies.drawn, lambda place, body: place[:, :2] - bodies.centroid[body])
            self._put_moves(moves, _core.api_dem.moves)
            self._put_surroundings()
            self._put_options(settle=shift is None and rate is None)
        except BaseException:
            self.close()
            raise

    def _put_joints(self, bodies: Bodies) -> None:
        depth = bodies.depth
        self._put_laws(
            [
                replace(
                    law,
                    normal_stiffness=law.normal_stiffness * depth,
                    shear_stiffness=law.shear_stiffness * depth,
                    cohesion=law.cohesion * depth,
                    tension=law.tension * depth,
                    strength=law.strength * depth,
                )
                for law in bodies.laws
            ]
        )
        if bodies.joints:
            listed = sorted((min(pair), max(pair), law) for pair, law in bodies.joints.items())
            joints = indices("joints", np.transpose([pair for *pair, _ in listed]), self.count, (2, None))
            law = indices("joints", [law for *_, law in listed], len(bodies.laws), (None,))
            check(_core.api_dem.joints(self.handle, joints, law), "joints")
            self._joints = np.array([pair for *pair, _ in listed])

    def _drawn_arm(self, arm: np.ndarray) -> np.ndarray:
        return arm[..., :2]

    def _put_surroundings(self) -> None:
        o = self.options
        status = _core.api_dem.surroundings(
            self.handle, real("gravity", o.gravity, (2,)), float(o.mass_damping), int(o.moving_base), real("domain", o.domain, (4,))
        )
        check(status, "surroundings of the blocks")

    def _last_run(self, interrupted: bool) -> Run:
        recorded = self._recorded(interrupted)
        settled, bounces, airborne, status = _core.api_dem.bodies(self.handle, self.count)
        check(status, "bodies after the run")
        *_, closed, status = _core.api_dem.contacts(self.handle, 0)
        check(status, "contacts after the run")
        touching, contact, _, status = _core.api_dem.contacts(self.handle, int(closed))
        check(status, "contacts after the run")
        return Run(
            **recorded,
            settled=settled.T,
            bounces=bounces,
            airborne=airborne,
            contacts=Contacts(touching.T - 1, contact.T[:, :2], contact.T[:, 2:4], contact[4], contact[5]),
        )


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
    """One run of a model that is made for it; see Model and Model.run. No ground: it stands still.

    shift (n, 3): displacements of the bodies at the start [m], [m], [rad]; rate (n, 3): their velocities; times (frames):
    of output [s].
    """
    with Model(bodies, options, shift=shift, rate=rate, moves=moves) as model, as_motion_set([ground or STILL]) as motions:
        return model.run(motions, scale=scale, times=times)
