"""Discrete elements in space in the core (fortran/dem3): rigid polyhedra, their joints, and what a run leaves of them."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from extrados import _core
from extrados.core.calls import indices, integers, real
from extrados.core.dem_run import STILL, BodyModel, DrawnContacts, FoundRun, Law, RunOptions, SupportMove, Ties
from extrados.core.errors import check
from extrados.core.ground import Ground, as_motion_set
from extrados.schema.constants import GRAVITY

#: Corners of a face, at most (fortran/dem3/bodies.f90)
MOST_CORNERS = 96


@dataclass(frozen=True)
class Dowels:
    """Dowels across joints, which bear shear and no pull.

    body (nk, 2): that each stands in, and that it reaches into; place (nk, 3) [m]; axis (nk, 3): unit vectors from the first
    to the second; stiffness (nk) [N/m]; strength (nk) [N] beyond which it gives way, infinite where it does not; reach (nk)
    [m]: once the bodies part farther it is out for good, infinite where it never is; damping: beta [s].
    """

    body: np.ndarray
    place: np.ndarray
    axis: np.ndarray
    stiffness: np.ndarray
    strength: np.ndarray
    reach: np.ndarray
    damping: float = 0.0


@dataclass(frozen=True)
class Solids:
    """Rigid bodies made of convex polyhedra, as they lie at the start.

    centroid (n, 3) [m]; mass (n) [kg], 0 for a support; inertia (n, 3, 3) about the centroids [kg m^2]. Part k is the
    polyhedron of vertices[k] (nv, 3) [m] and faces[k], the numbers of the vertices of each face, counter-clockwise from
    outside; it belongs to body owner[k]. joints: (body, body) -> index of its law; law 0 is that of contacts that form later.
    Mortar binds what touches at the start. load (n, 4, 3): constant force [N], then the sums of arm from the centroid times force, a row for
    each component of the arm [N m]; it moves with the body, and keeps its direction.
    """

    centroid: np.ndarray
    mass: np.ndarray
    inertia: np.ndarray
    vertices: list[np.ndarray]
    faces: list[tuple[tuple[int, ...], ...]]
    owner: list[int]
    laws: list[Law]
    joints: dict[tuple[int, int], int] = field(default_factory=dict)
    dowels: Dowels | None = None
    ties: Ties | None = None
    drawn: DrawnContacts | None = None
    load: np.ndarray | None = None


@dataclass(frozen=True)
class Options(RunOptions):
    """How to run; see also RunOptions. domain: displacement by which a body has left the scene [m], 0 none. way: direction of
    the horizontal ground motion."""

    domain: float = 0.0
    gravity: tuple[float, float, float] = (0.0, 0.0, -GRAVITY)
    way: tuple[float, float, float] = (1.0, 0.0, 0.0)


@dataclass(frozen=True, kw_only=True)
class Run(FoundRun):
    """A run. turn (t, n, 3, 3): rotation matrices from the attitude at the start, settled_turn (n, 3, 3) after settling.
    dowel_slip (nk) [m]: how far each dowel gave way at most; dowel_out (nk): whether the bodies have parted from it."""

    turn: np.ndarray
    settled_turn: np.ndarray
    dowel_slip: np.ndarray
    dowel_out: np.ndarray


class Model(BodyModel[Run]):
    """Solids, joints and options in the core; runs under any number of motions, each from the same start.

    rate (n, 6): velocities and spins at the start, which is then not settled. ValueError or IndexError where a body or a law
    is named that is not there.
    """

    what = "model of discrete elements in space"
    rates, values, in_space = 6, 18, True
    options: Options

    def __init__(self, solids: Solids, options: Options, *, rate: np.ndarray | None = None, moves: Sequence[SupportMove] = ()):
        if not solids.laws or any(not 0 <= k < len(solids.laws) for k in solids.joints.values()):
            raise ValueError("a joint refers to the number of a joint law that does not exist")
        if options.rigid and any(law.strength > 0.0 for law in solids.laws):
            raise ValueError("corners can crush only with springs")
        if (most := max((len(face) for faces in solids.faces for face in faces), default=0)) > MOST_CORNERS:
            raise ValueError(f"a face has {most} corners, expected at most {MOST_CORNERS}")
        n, parts = len(solids.mass), len(solids.vertices)
        mobile = np.asarray(solids.mass, dtype=float) > 0.0
        principal, axes = np.linalg.eigh(np.where(mobile[:, None, None], solids.inertia, np.eye(3)))
        axes[np.linalg.det(axes) < 0.0, :, 2] *= -1.0
        owner = indices("owner", solids.owner, n, (parts,))
        own = [(np.asarray(v, dtype=float) - solids.centroid[k]) @ axes[k] for v, k in zip(solids.vertices, solids.owner, strict=True)]
        first = np.cumsum([0, *map(len, own)])
        loops = [np.asarray(face) + start + 1 for faces, start in zip(solids.faces, first[:-1].tolist(), strict=True) for face in faces]
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
            self._put_laws(solids.laws)
            pairs = sorted((*sorted(pair), law) for pair, law in solids.joints.items())
            joints = np.array(pairs, dtype=int).reshape(-1, 3).T
            if pairs:
                indices("joints", joints[:2], n, (2, None))
            status = _core.api_dem3.joints(self.handle, np.asfortranarray(joints + 1, dtype=np.int32))
            check(status, "joints")
            self._joints = joints[:2].T
            self._put_moves(moves, _core.api_dem3.moves)
            self._put_dowels(solids.dowels)
            if solids.load is not None:
                own_arms = np.einsum("nik,nij->nkj", axes, solids.load[:, 1:])
                load = np.concatenate([np.swapaxes(solids.load[:, :1], 1, 2), own_arms], axis=2)
                check(_core.api_dem3.loads(self.handle, real("load", np.moveaxis(load, 0, -1), (3, 4, n))), "constant loads")

            def in_body(place: np.ndarray, body: np.ndarray) -> np.ndarray:
                return np.asarray(np.einsum("ni,nij->nj", place - solids.centroid[body], axes[body]))

            self._put_ties(solids.ties, in_body)
            self._put_drawn(solids.drawn, in_body)
            status = _core.api_dem3.surroundings(
                self.handle,
                real("gravity", options.gravity, (3,)),
                real("way", options.way, (3,)),
                float(options.domain),
                real("rate", np.transpose(np.zeros((n, 6)) if rate is None else rate), (6, n)),
            )
            check(status, "surroundings of the solids")
            self._put_options(settle=rate is None)
        except BaseException:
            self.close()
            raise

    def _put_dowels(self, dowels: Dowels | None) -> None:
        self._dowels = 0 if dowels is None else len(dowels.body)
        if dowels is None:
            return
        n = self._dowels
        body = indices("body", np.transpose(dowels.body), self.count, (2, n))
        bounded = [
            np.minimum(values, np.finfo(float).max)
            for values in (dowels.stiffness, dowels.strength, dowels.reach, np.full(n, dowels.damping))
        ]
        status = _core.api_dem3.dowels(
            self.handle,
            body,
            real("place", np.transpose(dowels.place), (3, n)),
            real("axis", np.transpose(dowels.axis), (3, n)),
            real("values", np.array(bounded), (4, n)),
        )
        check(status, "dowels")

    def _drawn_arm(self, arm: np.ndarray) -> np.ndarray:
        order = np.argsort(self._drawn)
        return np.asarray(np.einsum("nij,tnj->tni", self._axes[self._below[order]], arm))

    def _last_run(self, interrupted: bool) -> Run:
        recorded = self._recorded(interrupted)
        settled, settled_turn, bounces, airborne, status = _core.api_dem3.bodies(self.handle, self.count)
        check(status, "bodies after the run")
        turn, status = _core.api_dem3.attitudes(self.handle, self.count, len(recorded["time"]))
        check(status, "history of the run")
        slip, is_out, status = _core.api_dem3.slips(self.handle, self._dowels)
        check(status, "dowels after the run")
        axes = np.moveaxis(turn, (2, 3), (1, 0))  # (t, n, 3, 3): columns are the own axes
        start = np.swapaxes(self._axes, 1, 2)
        return Run(
            **recorded,
            settled=settled.T,
            bounces=bounces,
            airborne=airborne,
            turn=axes @ start,
            settled_turn=np.moveaxis(settled_turn, 2, 0) @ start,
            dowel_slip=slip,
            dowel_out=is_out.astype(bool),
        )


def run(
    solids: Solids,
    options: Options,
    ground: Ground | None = None,
    *,
    across: Ground | None = None,
    scale: float = 1.0,
    rate: np.ndarray | None = None,
    moves: Sequence[SupportMove] = (),
    times: np.ndarray | None = None,
) -> Run:
    """One run of a model that is made for it; see Model and Model.run. No ground: it stands still.

    across: its other horizontal component, along z x way. rate (n, 6): velocities [m/s] and spins [rad/s] of the bodies at
    the start; moves: supports that move; times (frames): of output [s].
    """
    grounds = [ground or STILL, *([] if across is None else [across])]
    with Model(solids, options, rate=rate, moves=moves) as model, as_motion_set(grounds) as motions:
        return model.run(motions, across=None if across is None else 1, scale=scale, times=times)
