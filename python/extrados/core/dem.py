"""Discrete elements in the core (fortran/dem): one run of rigid plane blocks, from rest to the end of a motion."""

from dataclasses import dataclass, field

import numpy as np

from extrados import _core
from extrados.core.calls import integers, long_call, real
from extrados.core.errors import check, status_code
from extrados.core.ground import Ground, motion_set
from extrados.schema.constants import GRAVITY

#: Why a run ended, by the number the core gives.
REASONS = ("end", "collapse", "rest", "left", "blow-up", "step", "unsettled", "overlap")
#: Rows of the energy ledger [J].
ENERGIES = (
    "kinetic", "potential", "elastic", "friction", "damping", "mass_damping", "work", "residual", "leapfrog",
)  # fmt: skip


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
    above it the run is stopped. settle_steps 0 starts without settling under gravity."""

    end_time: float
    output_step: float = 0.01
    step: float = 0.0
    fraction: float = 0.3
    settle_steps: int = 400_000
    settle_tolerance: float = 1e-6
    collapse: float = 0.0
    domain: tuple[float, float, float, float] = (-1e30, 1e30, -1e30, 1e30)
    residual_limit: float = 0.1
    stop_at_rest: bool = False
    moving_base: bool = False
    mass_damping: float = 0.0
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
class Run:
    """A run. reason: see REASONS; blamed: the bodies it is about.

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
    interrupted: bool = False


_STILL = Ground(breaks=np.array([0.0, 1.0]), linear=np.zeros((1, 1, 2)), harmonic=np.zeros((1, 1, 0, 4)))


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
    """Settle `bodies` under gravity, then move the ground by `scale` times `ground`.

    shift, rate (n, 3): initial displacement and velocity about the centroids, without settling. times: output
    times [s] instead of every output_step. Bodies and laws are counted from 0.
    """
    n = len(bodies.mass)
    if not (options.end_time > 0.0 and options.output_step > 0.0 and 0.0 < options.fraction <= 1.0):
        raise ValueError("end time, output step and the fraction of the critical step must be positive")
    if not bodies.laws or any(not 0 <= k < len(bodies.laws) for k in bodies.joints.values()):
        raise ValueError("a joint names a law that is not there")
    if times is None:
        times = np.arange(round(options.end_time / options.output_step * (1 - 1e-12)) + 1) * options.output_step
    motions = motion_set([ground or _STILL])
    depth = bodies.depth
    law = np.array(
        [
            [
                k.normal_stiffness * depth, k.shear_stiffness * depth, k.friction, k.cohesion * depth,
                k.tension * depth, k.damping,
            ]
            for k in bodies.laws
        ]
    )  # fmt: skip
    table: list[list[tuple[int, int]]] = [[] for _ in range(n)]
    for (a, b), k in bodies.joints.items():
        table[min(a, b)].append((max(a, b), k))
    # f2py refuses empty arrays: one entry that nothing points to stands at the end of both lists.
    rows = [entry for row in table for entry in row] + [(0, 0)]
    moving = [*moves, SupportMove(-1, 0.0, 0.0, 0.0, 0.0, 1.0)]
    initial = shift is not None or rate is not None
    counts = [len(p) for p in bodies.parts]
    out = long_call(
        _core.api_dem.run,
        real("centroid", bodies.centroid, (n, 2)).T,
        real("mass", bodies.mass, (n,)),
        real("inertia", bodies.inertia, (n,)),
        integers("owner", np.asarray(bodies.owner) + 1, len(bodies.parts)),
        integers("first", np.concatenate([[1], 1 + np.cumsum(counts)])),
        real("vertices", np.concatenate(bodies.parts), (sum(counts), 2)).T,
        integers("outer", np.concatenate(bodies.outer).astype(np.int32), sum(counts)),
        real("shift", np.zeros((n, 3)) if shift is None else shift, (n, 3)).T,
        real("rate", np.zeros((n, 3)) if rate is None else rate, (n, 3)).T,
        real("law", law, (None, 6)).T,
        integers("table_first", 1 + np.concatenate([[0], np.cumsum([len(row) for row in table])])),
        integers("table_body", np.array([b + 1 for b, _ in rows], dtype=np.int32)),
        integers("table_law", np.array([k + 1 for _, k in rows], dtype=np.int32)),
        integers("move_body", np.array([m.body + 1 for m in moving], dtype=np.int32)),
        real("moves", np.array([[m.dx, m.dy, m.turn, m.start, m.duration] for m in moving]), (None, 5)).T,
        int(motions.sampled[0]),
        float(motions.start[0]),
        float(motions.step[0]),
        motions.samples,
        motions.breaks,
        motions.linear,
        motions.harmonic,
        float(scale),
        int(options.moving_base),
        real("gravity", options.gravity, (2,)),
        float(options.mass_damping),
        real(
            "limits",
            [
                options.end_time, options.step, options.fraction, options.settle_tolerance, options.collapse,
                options.residual_limit,
            ],
            (6,),
        ),
        real("domain", options.domain, (4,)),
        0 if initial else int(options.settle_steps),
        int(options.stop_at_rest),
        int(options.threads),
        real("times", times, (None,)),
        8 * len(bodies.parts),
    )  # fmt: skip
    time, place, rates, energy, found, measures, bounces, airborne, settled, contact_body, contact, status = out
    interrupted = status == status_code("cancelled")
    if not interrupted:
        check(status, "discrete elements")
    points, reason, first, second, settling, searches, pairs, steps, closed = (int(k) for k in found)
    return Run(
        reason=REASONS[reason],
        blamed=[k - 1 for k in (first, second) if k > 0],
        time=time[:points],
        place=place.T[:points],
        rate=rates.T[:points],
        energy=dict(zip(ENERGIES, energy[:, :points], strict=True)),
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
        contacts=Contacts(
            contact_body.T[:closed] - 1, contact.T[:closed, :2], contact.T[:closed, 2:4], contact[4, :closed],
            contact[5, :closed],
        ),
        interrupted=interrupted,
    )  # fmt: skip
