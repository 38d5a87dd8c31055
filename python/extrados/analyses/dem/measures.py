"""What is read off a run: openings and slip of joints, hinges, the outcome, restitution, blocks, snapshots."""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from extrados.analyses.dem.impact_rules import ContactValues
from extrados.analyses.dem.model import Model
from extrados.analyses.dem.solid_model import SolidModel
from extrados.analyses.dem.tables import Dem
from extrados.core import dem, dem3, dem_run
from extrados.core.dem_run import SupportMove
from extrados.model.geometry.assembly import GROUND
from extrados.results.dem import APART, CLOSED, HINGED_FIRST, HINGED_SECOND, CollapseCriterion, Convergence, DemOutcome
from extrados.results.fields import Keys
from extrados.results.model import Array, TableData
from extrados.schema.constants import GRAVITY
from extrados.views.rigid import FOOTING

#: A joint is open where it gapes by more than this fraction of its length.
OPEN = 5e-4
#: Error of the energy balance over the energy exchanged, above which a run is doubtful
LARGE_RESIDUAL = 0.01
#: A joint slides where it slips by more than this fraction of the shortest one.
SLIDES = 0.01
#: Of the highest swing before an impact: lower ones say little of the restitution.
STRONG = 0.04
#: The last part of a run, in which blocks still move or do not, is one of so many.
LAST_PART = 20
#: Blocks whose rotation is reported where none are named.
MOST_TRACKED = 24


def openings(model: Model, run: dem.Run) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """How far each joint gapes at its ends p and q, and its slip at the closed end (time, joint) [m].

    Measured from the settled state, slip along the mean of the two faces, gaps along the normal of either face, whichever is less: the
    corner of a block that slid and turned lies on the face of the other, at an angle. NaN where both sides are one body.
    """
    a = model.assembly
    nt, nj = len(run.time), len(a.a)
    gap_p, gap_q, slip = (np.full((nt, nj), np.nan) for _ in range(3))
    for j, pair in enumerate(model.rigid.joints):
        if pair is None:
            continue
        ends, turns = [], []
        for body in pair:
            place, rest = run.place[:, body], run.settled[body]
            turn = place[:, 2] - rest[2]
            c, s = np.cos(turn), np.sin(turn)
            moved = []
            for point in (a.p[j], a.q[j]):
                arm = point - rest[:2]
                moved.append(place[:, :2] + np.stack([c * arm[0] - s * arm[1], s * arm[0] + c * arm[1]], axis=1))
            ends.append(moved)
            turns.append(turn)
        tangent = _turned(a.tangent[j], 0.5 * (turns[0] + turns[1]))
        normals = [_turned(a.normal[j], turn) for turn in turns]
        apart = [ends[0][k] - ends[1][k] for k in (0, 1)]
        for gap, d in zip((gap_p, gap_q), apart, strict=True):
            one, other = ((d * normal).sum(axis=1) for normal in normals)
            gap[:, j] = np.where(np.abs(one) < np.abs(other), one, other)
        along = [(d * tangent).sum(axis=1) for d in apart]
        slip[:, j] = np.where(gap_p[:, j] < gap_q[:, j], *along)
    return gap_p, gap_q, slip


def _turned(v: np.ndarray, turn: np.ndarray) -> np.ndarray:
    """A vector (2) turned by angles (n) [rad]."""
    c, s = np.cos(turn), np.sin(turn)
    return np.stack([c * v[0] - s * v[1], s * v[0] + c * v[1]], axis=1)


def hinges(model: Model, gap_p: np.ndarray, gap_q: np.ndarray, slip: np.ndarray) -> np.ndarray:
    """State of each joint (time, joint): closed, hinged at p (intrados) or at q (extrados), or apart."""
    small = OPEN * model.assembly.length
    open_p, open_q = np.nan_to_num(gap_p) > small, np.nan_to_num(gap_q) > small
    between = (model.assembly.a != GROUND) & (model.assembly.b != GROUND)
    # What slid by more than its length lies on another block; on level ground it slides on.
    apart = (open_p & open_q) | (between & (np.abs(np.nan_to_num(slip)) > model.assembly.length))
    return np.where(apart, APART, np.where(open_p, HINGED_SECOND, np.where(open_q, HINGED_FIRST, CLOSED)))


@dataclass(frozen=True)
class Slip:
    """Greatest slip of joints that still touch, at any time and at the end [m]; the greatest over the length of its joint, and
    that joint."""

    peak: float
    residual: float
    ratio: float
    joint: int

    @classmethod
    def of(cls, state: np.ndarray, slip: np.ndarray, length: np.ndarray) -> "Slip":
        """By the states and slips of the joints (time, joint) [m], and their lengths [m]."""
        touching = np.where(state == APART, 0.0, np.abs(np.nan_to_num(slip)))
        most = touching.max(axis=0, initial=0.0)
        share = most / length
        last = float(touching[-1].max(initial=0.0)) if len(touching) else 0.0
        return cls(float(most.max(initial=0.0)), last, float(share.max(initial=0.0)), int(share.argmax()))


def convergence(effort: dem_run.Effort) -> Convergence:
    """What rigid contacts took."""
    return Convergence(
        steps=effort.steps,
        open_steps=effort.open_steps,
        most_rounds=effort.most_rounds,
        factorisations_per_step=effort.factors / max(effort.steps, 1),
        worst_violation_ratio=effort.residual,
        worst_violation_s=effort.worst,
    )


def springs(options: Dem, values: ContactValues, found: dem_run.FoundRun) -> dict[str, float | None]:
    """Stiffness, damping and the stable step of joints with springs; None of rigid contacts."""
    told: dict[str, float | None] = {
        "joint_stiffness_min_Pa_per_m": float(values.stiffness.min()),
        "joint_stiffness_max_Pa_per_m": float(values.stiffness.max()),
        "beta_s": values.beta,
        **{f"damping_ratio_{name}": ratio for name, ratio in values.ratios().items()},
        "critical_step_s": found.critical_step,
    }
    return dict.fromkeys(told) if options.rigid else told


def off_footing(a: np.ndarray, b: np.ndarray, state: np.ndarray, slip: np.ndarray, length: np.ndarray) -> np.ndarray:
    """At which joints a block has slid farther on the ground than its footing reaches, from then on (time, joint).

    a, b (joint): blocks on both sides; states and slips (time, joint) [m]; lengths of the joints [m].
    """
    far = (state != APART) & (np.abs(np.nan_to_num(slip)) > FOOTING * length) & ((a == GROUND) | (b == GROUND))
    return np.logical_or.accumulate(far, axis=0)


def blocks_off(a: np.ndarray, b: np.ndarray, off: np.ndarray) -> list[int]:
    """Numbers of the blocks that slid off their footings, see `off_footing`."""
    return sorted({int(max(a[j], b[j])) for j in np.flatnonzero(off.any(axis=0))})


def shares(run: dem.Run | dem3.Run, count: int, limit: float) -> np.ndarray:
    """Displacements (time, body, axis) of the first `count` bodies as shares of the one that counts as collapse [m]."""
    axes = slice(0, 2 if isinstance(run, dem.Run) else 3)
    return (run.place[:, :count, axes] - run.settled[:count, axes]) / limit


def ground_level(model: Model) -> float:
    """Height of the lowest joint on the ground [m]."""
    a = model.assembly
    ground = (a.a == GROUND) | (a.b == GROUND)
    return float(np.minimum(a.p[ground, 1], a.q[ground, 1]).min())


def carried(run: dem_run.FoundRun, count: int, axes: int) -> np.ndarray:
    """Displacement that all supports share (time, axis) [m], along two or three axes; supports: the bodies after the first `count`."""
    shift = run.place[:, count:, :axes] - run.settled[count:, :axes]
    if not shift.shape[1]:
        return np.zeros((len(shift), axes))
    return shift.min(axis=1).clip(min=0.0) + shift.max(axis=1).clip(max=0.0)


def displaced(run: dem.Run | dem3.Run, count: int, axes: int) -> np.ndarray:
    """Displacements (time, body, axis) [m] of the first `count` bodies, along two or three axes, from their settled places, less those
    that all supports share: a structure does not fall with the ground that carries it."""
    return run.place[:, :count, :axes] - run.settled[:count, :axes] - carried(run, count, axes)[:, None]


def farthest_move(moves: Sequence[SupportMove], axes: int) -> float:
    """How far supports move at most, along two or three axes [m]: the sum of their movements."""
    return float(sum(np.linalg.norm(move.shift[:axes]) for move in moves))


def movements(model: Model, run: dem.Run) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """How far each body is from its settled place [m], how far it has turned [rad] and how much lower it is [m] (time, body); see
    `displaced`."""
    mobile = slice(0, model.rigid.count)
    shift = run.place[:, mobile] - run.settled[mobile]
    shift[..., :2] = displaced(run, model.rigid.count, 2)
    return np.hypot(shift[..., 0], shift[..., 1]), np.abs(shift[..., 2]), -shift[..., 1]


def displacements(model: Model, run: dem.Run) -> np.ndarray:
    """How far each body is from its settled place (time, body) [m]."""
    return movements(model, run)[0]


@dataclass(frozen=True)
class Collapse:
    """When a block has collapsed: it moved farther than `displacement` [m], and it turned by more than `turn` [rad] or is lower
    by more than `drop` [m]. A block that slides does neither, however far. A block that is turned by more than `lies` [rad] at
    the end has overturned, however near."""

    displacement: float
    turn: float
    drop: float
    lies: float = np.inf

    @classmethod
    def of(cls, displacement: float | None, size: float) -> "Collapse":
        """Of a structure of a size [m], by default a fifth of it: half the rotation that moves a block so far at the end of a lever
        as long as the structure, and a quarter of that displacement."""
        displacement = displacement or 0.2 * size
        return cls(displacement, 0.5 * displacement / size, 0.25 * displacement)

    def beyond(self, far: float) -> "Collapse":
        """The same of displacements from the place at rest, where supports move by up to `far` [m]: the core measures these."""
        return replace(self, displacement=self.displacement + far, drop=self.drop + far)

    @property
    def options(self) -> dict[str, Any]:
        """As the core's options call it."""
        return {"collapse": self.displacement, "collapse_turn": self.turn, "collapse_drop": self.drop}

    def reached(self, away: np.ndarray, turn: np.ndarray, drop: np.ndarray) -> np.ndarray:
        """Which bodies have collapsed (time, body)."""
        gone = (away > self.displacement) & ((turn > self.turn) | (drop > self.drop))
        gone[-1:] |= turn[-1:] > self.lies
        return gone


@dataclass(frozen=True)
class Fate:
    """How a run ends: `outcome`; of a collapse the criterion, and its time [s]; `block`: number of the body that collapsed
    first, else of the one that moved farthest."""

    outcome: DemOutcome
    criterion: CollapseCriterion | None
    time: float | None
    block: int


def fate(
    run: dem_run.FoundRun,
    collapse: Collapse,
    away: np.ndarray,
    turn: np.ndarray,
    drop: np.ndarray,
    unsupported: set[int],
    rocks: bool,
    slides: bool,
) -> Fate:
    """How a run ends, by the displacements [m], rotations [rad] and losses of height [m] of its bodies (time, body).

    unsupported: bodies that slid off their footings; rocks: some joint opened; slides: some joint slid.
    """
    gone = collapse.reached(away, turn, drop)
    far = int(away.max(axis=0, initial=0.0).argmax())
    if not gone.any() and run.reason not in ("collapse", "left"):
        return Fate("rocked" if rocks else "slid" if slides else "at-rest", None, None, far)
    if gone.any():
        at = int(gone.any(axis=1).argmax())
        block, when = int(gone[at].argmax()), float(run.time[at])
    else:
        at, block, when = -1, (run.blamed or [far])[0], run.stop_time
    if block in unsupported:
        criterion: CollapseCriterion = "loss of support"
    elif run.reason == "left" and not gone.any():
        criterion = "separation"
    else:  # a run is stopped between two outputs: by which of both it has come nearer
        how_far = (
            [float(values[at, block]) / limit for values, limit in ((turn, collapse.turn), (drop, collapse.drop))]
            if len(turn)
            else [1.0, 0.0]
        )
        criterion = "rotation" if how_far[0] >= how_far[1] else "loss of height"
    return Fate("collapse", criterion, when, block)


def peak_displacement(run: dem_run.FoundRun, farthest: float, limit: float) -> float:
    """Greatest displacement of any block [m]: `farthest` of the output times; a run that was stopped since a block had passed
    the limit [m] was stopped between two of them."""
    return max(farthest, limit) if run.reason == "collapse" else farthest


def moving(run: dem_run.FoundRun, model: Model | SolidModel) -> bool:
    """Whether the kinetic energy in the last part of the run, at whose end a swing may reverse, exceeds a share of the greatest and of the
    weight times the size."""
    kinetic = run.energy["kinetic"]
    noise = 1e-6 * float(model.mass.sum()) * GRAVITY * model.size
    return bool(len(kinetic) and kinetic[-max(1, len(kinetic) // LAST_PART) :].max() > max(1e-3 * kinetic.max(), noise))


def restitution(run: dem.Run, state: np.ndarray, ground: np.ndarray) -> float | None:
    """Median ratio of the rates after and before the impacts of a single block that rocks freely.

    By its energies: at the peaks of two swings it is at rest, so that the heights of its centroid over the one at rest are
    as the squares of the rates. state: of the joints (time, joint); ground: its acceleration (time) [m/s^2]. An impact
    counts where the block stood on one end of a joint before and on the other after, so that noise about rest and a
    changing lean do not, and where the ground is still from peak to peak. None without one.
    """
    angle, height = run.place[:, 0, 2], run.place[:, 0, 1] - run.settled[0, 1]
    cross = np.flatnonzero(angle[:-1] * angle[1:] < 0.0)
    limits = [0, *(cross + 1).tolist(), len(angle)]
    peaks = [low + int(np.abs(angle[low:high]).argmax()) for low, high in itertools.pairwise(limits)]
    ratios = []
    for before, after in itertools.pairwise(peaks):
        turned = after < len(angle) - 1 and abs(angle[after]) > abs(angle[-1])  # the run goes on beyond the second peak
        hinged = (state[before] * state[after] == HINGED_FIRST * HINGED_SECOND).any()
        if turned and hinged and not ground[before : after + 1].any() and height[before] > 0.0:
            ratios.append((height[before], np.sqrt(max(height[after], 0.0) / height[before])))
    highest = max((h for h, _ in ratios), default=0.0)
    strong = [ratio for h, ratio in ratios if h > STRONG * highest]
    return float(np.median(strong)) if strong else None


def tracked(model: Model, options: Dem, run: dem.Run) -> list[int]:
    """Blocks whose rotation is reported: those named, or those that turn most."""
    names = model.assembly.block_names
    if options.track:
        return [names.index(name) for name in options.track]
    n = len(names)
    turn = np.abs(run.place[:, model.rigid.body_of_block, 2] - run.settled[model.rigid.body_of_block, 2]).max(axis=0)
    return sorted(np.argsort(-turn, kind="stable")[: min(n, MOST_TRACKED)].tolist())


def block_places(model: Model, place: np.ndarray) -> np.ndarray:
    """Places of the assembly's blocks: those of a group follow its body."""
    body = model.rigid.body_of_block
    out = place[:, body].copy()
    arm = model.assembly.centroid - model.rigid.centroid[body]
    c, s = np.cos(out[..., 2]), np.sin(out[..., 2])
    out[..., 0] += c * arm[:, 0] - s * arm[:, 1]
    out[..., 1] += s * arm[:, 0] + c * arm[:, 1]
    return out


def block_rates(model: Model, run: dem.Run) -> np.ndarray:
    """Velocities [m/s] and spin [rad/s] (frames, blocks, 3) of the centroids of the blocks, from those of the bodies
    that they belong to."""
    body = model.rigid.body_of_block
    out = run.rate[:, body].copy()
    arm = block_places(model, run.place)[..., :2] - run.place[:, body, :2]
    out[..., 0] -= out[..., 2] * arm[..., 1]
    out[..., 1] += out[..., 2] * arm[..., 0]
    return out


def support_arrays(model: Model) -> dict[str, Array]:
    """Outlines of the supports, for pictures."""
    r = model.rigid
    parts = [p for p, o in zip(r.parts, r.owner, strict=True) if o >= r.count]
    return {
        "support_outline": Array(np.concatenate(parts), ("support_vertex", "axis"), "m", "outlines of the supports"),
        "support_start": Array(np.cumsum([0, *map(len, parts)]), ("support_edge",), "", "first vertex of each"),
    }


def water_force(model: Model | SolidModel) -> Keys:
    """The force of the water on all blocks [N], as a key of results; nothing without water."""
    return {} if model.water is None else {"water_force_N": model.water.force.sum(axis=0).tolist()}


def water_arrays(model: Model | SolidModel) -> dict[str, Array]:
    """The water pressure, for pictures; nothing without water."""
    water = model.water
    if water is None:
        return {}
    return {
        "water_point": Array(water.point, ("wet_point", "axis"), "m", "points of the faces and joints on which water presses"),
        "water_pressure": Array(
            water.force / water.area[:, None], ("wet_point", "axis"), "Pa", "water pressure at these points, to +x and upward"
        ),
        "water_block": Array(water.block, ("wet_point",), "", "numbers of the blocks on which the water presses"),
    }


def snapshot_times(options: Dem, run: dem_run.FoundRun) -> np.ndarray:
    """Times of the drawings: those asked for, or six between the first motion and the end of what matters."""
    if not len(run.time):
        return np.zeros(0)
    if options.snapshot_times:
        return np.clip(np.array(options.snapshot_times), run.time[0], run.time[-1])
    kinetic = run.energy["kinetic"]
    lively = np.flatnonzero(kinetic > 0.01 * kinetic.max(initial=0.0))
    if not len(lively) or kinetic.max() <= 0.0:
        return run.time[[-1]]
    return np.linspace(run.time[lively[0]], run.time[lively[-1]], 6)


def hinge_table(model: Model, time: np.ndarray, state: np.ndarray) -> TableData:
    """Changes of the hinges over time."""
    words = {
        CLOSED: "closed",
        HINGED_FIRST: "hinge at the first end (intrados)",
        HINGED_SECOND: "hinge at the second end (extrados)",
        APART: "open",
    }
    if not len(time):
        return TableData({"time": np.zeros(0), "joint": [], "state": []}, {"time": "s"})
    before = np.vstack([np.full_like(state[:1], CLOSED), state[:-1]])
    when, joint = np.nonzero(state != before)
    return TableData(
        {
            "time": time[when],
            "joint": [model.assembly.joint_names[j] for j in joint],
            "state": [words[int(state[t, j])] for t, j in zip(when, joint, strict=True)],
        },
        {"time": "s"},
    )
