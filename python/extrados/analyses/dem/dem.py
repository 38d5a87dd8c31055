"""dem: rigid blocks that rock, hinge, slide and fall under a motion, or in a tilt test (thesis chapter 7)."""

import shutil
from dataclasses import replace

import numpy as np

from extrados.analyses.context import Context, Refused
from extrados.analyses.dem import files as dem_files
from extrados.analyses.dem import model as dem_model
from extrados.analyses.dem.model import JointValues, Model
from extrados.analyses.dem.tables import Dem
from extrados.analyses.limit.common import geometry_arrays
from extrados.building.templates.block import BlockAssembly
from extrados.core import dem
from extrados.core.errors import Cancelled, status_code
from extrados.core.ground import Ground
from extrados.results.model import Array, Result, TableData
from extrados.schema.constants import GRAVITY

#: A joint is open where it gapes by more than this fraction of its length.
OPEN = 5e-4
#: A joint slides where it slips by more than this fraction of the shortest one.
SLIDES = 0.01
#: Blocks whose rotation is reported where none are named.
MOST_TRACKED = 24


def run(context: Context, options: Dem) -> Result:
    """A run with its variations, or a tilt test."""
    if options.animation == "mp4" and shutil.which("ffmpeg") is None:
        raise Refused('animation = "mp4" needs the program ffmpeg, which is not here; "gif" needs nothing')
    model = dem_model.make_model(context, options, options.floor)
    context.warnings += dem_model.warnings(model, options)
    if options.test == "tilt":
        return _tilt(context, options, model)
    return _motion(context, options, model)


def collapse_limit(options: Dem, model: Model) -> float:
    """Displacement that counts as collapse [m]."""
    return options.collapse_displacement or 0.2 * model.size


def core_options(context: Context, options: Dem, model: Model) -> dem.Options:
    """Options of the core for a run of this deck."""
    outline = np.concatenate(model.assembly.outlines)
    reach = options.domain * model.size
    low, high = outline.min(axis=0) - reach, outline.max(axis=0) + reach
    moved = [m.start + m.duration for m in context.building.initial.movements]
    quiet = max([context.motion.end if context.deck.motion else 0.0, *moved])
    return dem.Options(
        end_time=options.end_time or quiet + dem_model.settle_time(model),
        output_step=options.output_step,
        step=options.time_step or 0.0,
        fraction=options.fraction,
        collapse=collapse_limit(options, model) if options.stop_at_collapse else 0.0,
        domain=(low[0], high[0], low[1], high[1]),
        stop_at_rest=options.end_time is None,
        moving_base=options.base == "moving",
        mass_damping=options.mass_damping,
        threads=1 if len(model.assembly.mass) < 100 else context.threads,
    )


def _moves(context: Context, model: Model) -> tuple[dem.SupportMove, ...]:
    """Movements of supports, by the names of joints on them."""
    names = model.assembly.joint_names
    found = []
    for one in context.building.initial.movements:
        if one.joint not in names:
            raise Refused(f"initial.movements names no joint '{one.joint}'; there are {', '.join(names[:8])}")
        j = names.index(one.joint)
        pair = model.rigid.joints[j]
        if pair is None or max(pair) < model.rigid.count:
            raise Refused(f"initial.movements: joint '{one.joint}' is not on the ground")
        found.append(dem.SupportMove(max(pair), one.dx, one.dy, float(np.radians(one.turn)), one.start, one.duration))
    return tuple(found)


def _start(context: Context, model: Model) -> np.ndarray | None:
    """Initial displacements of a block that starts rotated about a toe; None: from rest."""
    ratio = context.building.initial.rotation_ratio
    block = model.assembly
    if not ratio or not isinstance(block, BlockAssembly):
        return None
    side = 0 if ratio > 0.0 else 1
    turn = -ratio * block.alpha[side]  # positive to +x is clockwise
    toe = np.array([block.toe_right, 0.0]) if side == 0 else np.array([-block.toe_left, 0.0])
    arm = block.centroid[0] - toe
    c, s = np.cos(turn), np.sin(turn)
    shift = np.zeros((len(model.rigid.mass), 3))
    shift[0, :2] = np.array([c * arm[0] - s * arm[1], s * arm[0] + c * arm[1]]) - arm
    shift[0, 2] = turn
    return shift


class Trial:
    """Runs of one deck with other joint values."""

    def __init__(self, context: Context, options: Dem, model: Model):
        self.model = model
        self.options = core_options(context, options, model)
        self.limit = collapse_limit(options, model)
        self.ground: Ground | None = context.motion.ground if context.deck.motion else None
        self.moves = _moves(context, model)
        self.shift = _start(context, model)

    @property
    def idle(self) -> bool:
        """Does nothing move it?"""
        return self.ground is None and not self.moves and self.shift is None

    def any_run(self, values: JointValues | None = None, **change: object) -> dem.Run:
        """One run however it ends; `change` replaces options of the core."""
        bodies = self.model.bodies(values)
        found = dem.run(bodies, replace(self.options, **change), self.ground, shift=self.shift, moves=self.moves)
        if self.shift is None:
            return found
        # A block that starts rotated does not settle: its place of rest is the one it was drawn in.
        return replace(found, settled=np.column_stack([bodies.centroid, np.zeros(len(bodies.mass))]))

    def run(self, values: JointValues | None = None, **change: object) -> dem.Run:
        """One run; Refused where it is not to be trusted."""
        return dem_model.checked(self.any_run(values, **change), self.model)


def openings(model: Model, run: dem.Run) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """How far each joint gapes at its ends p and q, and its slip at the closed end (time, joint) [m].

    Measured from the settled state, along the mean normal of the two faces; NaN where both sides are one body.
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
        mean = 0.5 * (turns[0] + turns[1])
        c, s = np.cos(mean), np.sin(mean)

        def turned(v: np.ndarray, c: np.ndarray = c, s: np.ndarray = s) -> np.ndarray:
            return np.stack([c * v[0] - s * v[1], s * v[0] + c * v[1]], axis=1)

        normal, tangent = turned(a.normal[j]), turned(a.tangent[j])
        apart = [ends[0][k] - ends[1][k] for k in (0, 1)]
        gap_p[:, j], gap_q[:, j] = ((d * normal).sum(axis=1) for d in apart)
        along = [(d * tangent).sum(axis=1) for d in apart]
        slip[:, j] = np.where(gap_p[:, j] < gap_q[:, j], *along)
    return gap_p, gap_q, slip


def hinges(model: Model, gap_p: np.ndarray, gap_q: np.ndarray, slip: np.ndarray) -> np.ndarray:
    """State of each joint (time, joint): 0 closed, -1 hinged at p (intrados), 1 at q (extrados), 2 apart."""
    small = OPEN * model.assembly.length
    open_p, open_q = np.nan_to_num(gap_p) > small, np.nan_to_num(gap_q) > small
    apart = (open_p & open_q) | (np.abs(np.nan_to_num(slip)) > 0.5 * model.assembly.length)
    return np.where(apart, 2, np.where(open_p, 1, np.where(open_q, -1, 0)))


def peak_slip(state: np.ndarray, slip: np.ndarray) -> float:
    """Greatest slip of joints that still touch [m]."""
    return float(np.nanmax(np.abs(np.where(state == 2, 0.0, slip)), initial=0.0))


def displacements(model: Model, run: dem.Run) -> np.ndarray:
    """How far each body is from its settled place (time, body) [m]."""
    mobile = slice(0, model.rigid.count)
    return np.hypot(*(run.place[:, mobile, :2] - run.settled[mobile, :2]).transpose(2, 0, 1))


def outcome(run: dem.Run, state: np.ndarray, farthest: float, limit: float) -> str:
    """no-hinging, recovery or collapse: a block moved farther than the limit [m] at some time."""
    if run.reason in ("collapse", "left") or farthest > limit:
        return "collapse"
    return "recovery" if (state != 0).any() else "no-hinging"


def _collapse_time(run: dem.Run, far: np.ndarray, limit: float) -> float | None:
    """When a block first moved farther than the limit [s]."""
    if (far > limit).any():
        return float(run.time[np.argmax(far > limit)])
    return run.stop_time if run.reason in ("collapse", "left") else None


def _moving(run: dem.Run, model: Model) -> bool:
    """Is there motion worth the name at the end: beside the most there was, and beside the weight times the size?"""
    kinetic = run.energy["kinetic"]
    noise = 1e-6 * float(model.rigid.mass.sum()) * GRAVITY * model.size
    return bool(len(kinetic) and kinetic[-1] > max(1e-3 * kinetic.max(), noise))


def restitution(run: dem.Run, state: np.ndarray, ground: np.ndarray) -> float | None:
    """Median ratio of the rates after and before the impacts of a single block that rocks freely.

    state: of the joints (time, joint); ground: its acceleration (time) [m/s^2]. An impact counts where the block
    stood on one end of a joint before and on the other after, so that noise about rest and a changing
    lean do not, and where the ground is still meanwhile: it would change the rates as well. None without one.
    """
    angle, rate = run.place[:, 0, 2], run.rate[:, 0, 2]
    cross = np.flatnonzero(angle[:-1] * angle[1:] < 0.0)
    limits = [0, *(cross + 1).tolist(), len(angle)]
    ratios = []
    for k, c in enumerate(cross):
        if not 3 < c < len(rate) - 6 or (ground[c - 2 : c + 5] != 0.0).any():
            continue
        before = limits[k] + np.abs(angle[limits[k] : limits[k + 1]]).argmax()
        after = limits[k + 1] + np.abs(angle[limits[k + 1] : limits[k + 2]]).argmax()
        if (state[before] * state[after] == -1).any() and rate[c - 2] * rate[c + 4] > 0.0:
            fast = np.abs(rate[c - 3 : c + 1]).max()  # gravity speeds it up until the impact
            ratios.append((fast, abs(rate[c + 4]) / fast))
    fastest = max((r for r, _ in ratios), default=0.0)
    strong = [ratio for r, ratio in ratios if r > 0.2 * fastest]
    return float(np.median(strong)) if strong else None


def _tracked(model: Model, options: Dem, run: dem.Run) -> list[int]:
    """Blocks whose rotation is reported: those named, or those that turn most."""
    names = model.assembly.block_names
    for name in options.track:
        if name not in names:
            raise Refused(f"track names no block '{name}'; there are {', '.join(names[:8])}")
    if options.track:
        return [names.index(name) for name in options.track]
    n = len(names)
    turn = np.abs(run.place[:, model.rigid.body_of_block, 2] - run.settled[model.rigid.body_of_block, 2]).max(axis=0)
    return sorted(np.argsort(-turn, kind="stable")[: min(n, MOST_TRACKED)].tolist())


def _motion(context: Context, options: Dem, model: Model) -> Result:
    trial = Trial(context, options, model)
    context.progress(0, 1, "discrete elements")
    single = model.rigid.count == 1
    found = trial.run(output_step=min(options.output_step, 0.002)) if single else trial.run()
    gap_p, gap_q, slip = openings(model, found)
    state = hinges(model, gap_p, gap_q, slip)
    ground = context.motion.sample(found.time) if context.deck.motion else np.zeros(len(found.time))
    body = model.rigid.body_of_block
    tracked = _tracked(model, options, found)
    rotation = -(found.place[:, body, 2] - found.settled[body, 2])
    peak = np.abs(rotation).argmax(axis=0)
    mobile = slice(0, model.rigid.count)
    far = displacements(model, found).max(axis=1, initial=0.0)
    farthest = float(far.max(initial=0.0))
    sliding = peak_slip(state, slip)
    result = Result("dem", status="interrupted" if found.interrupted else "ok")
    result.reason = f"interrupted at {found.stop_time:.3f} s" if found.interrupted else ""
    names = model.assembly.block_names
    result.results = {
        "outcome": outcome(found, state, farthest, trial.limit),
        "collapse_time_s": _collapse_time(found, far, trial.limit),
        "stopped": found.reason,
        "stopped_by": [model.rigid.names[k] for k in found.blamed],
        "stop_time_s": found.stop_time,
        "still_moving": found.reason == "end" and _moving(found, model),
        "peak_rotation_rad": {names[i]: float(rotation[peak[i], i]) for i in tracked},
        "peak_displacement_m": farthest,
        "peak_slip_m": sliding,
        "peak_kinetic_energy_J": float(found.energy["kinetic"].max(initial=0.0)),
        "friction_loss_J": float(found.energy["friction"][-1]) if len(found.time) else 0.0,
        "damping_loss_J": float(found.energy["damping"][-1]) if len(found.time) else 0.0,
        "energy_residual_ratio": found.residual,
        "restitution_measured": restitution(found, state, ground) if single else None,
        "restitution_housner": 1.0 - 1.5 * float(np.sin(model.assembly.alpha[0]) ** 2)
        if isinstance(model.assembly, BlockAssembly)
        else None,
        "bounces": int(found.bounces[mobile].sum()),
        "airborne_time_s": float(found.airborne[mobile].max(initial=0.0)),
        "joint_stiffness_min_Pa_per_m": float(model.values.stiffness.min()),
        "joint_stiffness_max_Pa_per_m": float(model.values.stiffness.max()),
        "beta_s": model.values.beta,
        **{f"damping_ratio_{name}": ratio for name, ratio in model.values.ratios().items()},
        "steps": found.steps,
        "settling_steps": found.settling_steps,
        "time_step_s": found.step,
        "critical_step_s": found.critical_step,
        "contact_searches": found.searches,
        "animation": options.animation,
    }
    result.tables["dem"] = TableData(
        {
            "time": found.time,
            **{f"rotation of {names[i]}": rotation[:, i] for i in tracked},
            **{f"{name}_energy": values for name, values in found.energy.items() if name != "leapfrog"},
        },
        {
            "time": "s",
            **{f"rotation of {names[i]}": "rad" for i in tracked},
            **{f"{name}_energy": "J" for name in found.energy},
        },
    )
    result.tables["dem_hinges"] = _hinge_table(model, found.time, state)
    result.arrays = {
        **geometry_arrays(model.assembly),
        "time": Array(found.time, ("time",), "s", "output times"),
        "place": Array(
            _block_places(model, found.place),
            ("time", "block", "component"),
            "m, m, rad",
            "centroid and rotation of the blocks",
        ),
        "rate": Array(_block_rates(model, found), ("time", "block", "component"), "m/s, m/s, rad/s"),
        "rotation": Array(rotation, ("time", "block"), "rad", "from the settled state, positive to +x"),
        "tracked": Array(np.array(tracked), ("tracked",), "", "blocks whose rotation is reported"),
        "hinge": Array(state, ("time", "joint"), "", "0 closed, -1 hinged at the first end, 1 at the second, 2 open"),
        "opening_p": Array(gap_p, ("time", "joint"), "m", "gap at the first ends of the joints"),
        "opening_q": Array(gap_q, ("time", "joint"), "m", "gap at the second ends"),
        "slip": Array(slip, ("time", "joint"), "m", "slip at the closed ends"),
        **{
            f"{name}_energy": Array(values, ("time",), "J")
            for name, values in found.energy.items()
            if name != "leapfrog"
        },
        "ground": Array(ground, ("time",), "m/s^2"),
        "snapshot_time": Array(_snapshot_times(options, found), ("snapshot",), "s"),
        **_support_arrays(model),
    }
    if sliding > SLIDES * float(model.assembly.length.min()):
        result.warnings.append(f"joints slide by up to {1e3 * sliding:.3g} mm")
    if found.residual > 0.01:
        result.warnings.append(
            f"the energy ledger is off by {100 * found.residual:.2g} % of the energy that went round"
        )
    if result.results["still_moving"]:
        result.warnings.append("it still moves at the end of the run: a longer end_time may show another outcome")
    if trial.idle:
        result.warnings.append(
            "nothing moves it: add [motion], [[initial.movements]] or, for a block, [initial] rotation_ratio"
        )
    if not found.interrupted:
        _further(context, options, trial, result)
    result.files |= dem_files.files(model, found, options)
    result.answer = _answer(result.results, model, trial.idle)
    return result


def _further(context: Context, options: Dem, trial: Trial, result: Result) -> None:
    """Variations and the search for the friction; what stops them leaves the run itself as it is."""
    try:
        _vary(context, options, trial, result)
        if options.find_friction:
            result.results["friction_threshold"] = friction_threshold(trial, trial.model, options.slip)
    except (Cancelled, KeyboardInterrupt):
        result.status = "interrupted"
        result.reason = "interrupted in the variations or the friction search; the run before them is complete"
    except Refused as error:
        result.results["friction_threshold"] = None
        result.warnings.append(f"the least friction was not found: {error}")


def _block_places(model: Model, place: np.ndarray) -> np.ndarray:
    """Places of the assembly's blocks: those of a group follow its body."""
    body = model.rigid.body_of_block
    out = place[:, body].copy()
    arm = model.assembly.centroid - model.rigid.centroid[body]
    c, s = np.cos(out[..., 2]), np.sin(out[..., 2])
    out[..., 0] += c * arm[:, 0] - s * arm[:, 1]
    out[..., 1] += s * arm[:, 0] + c * arm[:, 1]
    return out


def _block_rates(model: Model, run: dem.Run) -> np.ndarray:
    body = model.rigid.body_of_block
    out = run.rate[:, body].copy()
    arm = _block_places(model, run.place)[..., :2] - run.place[:, body, :2]
    out[..., 0] -= out[..., 2] * arm[..., 1]
    out[..., 1] += out[..., 2] * arm[..., 0]
    return out


def _support_arrays(model: Model) -> dict[str, Array]:
    """Outlines of the supports, for pictures."""
    r = model.rigid
    parts = [p for p, o in zip(r.parts, r.owner, strict=True) if o >= r.count]
    return {
        "support_outline": Array(np.concatenate(parts), ("support_vertex", "axis"), "m", "outlines of the supports"),
        "support_start": Array(np.cumsum([0, *map(len, parts)]), ("support_edge",), "", "first vertex of each"),
    }


def _snapshot_times(options: Dem, run: dem.Run) -> np.ndarray:
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


def _hinge_table(model: Model, time: np.ndarray, state: np.ndarray) -> TableData:
    """Changes of the hinges over time."""
    words = {0: "closed", -1: "hinge at the first end (intrados)", 1: "hinge at the second end (extrados)", 2: "open"}
    if not len(time):
        return TableData({"time": np.zeros(0), "joint": [], "state": []}, {"time": "s"})
    before = np.vstack([np.zeros_like(state[:1]), state[:-1]])
    when, joint = np.nonzero(state != before)
    return TableData(
        {
            "time": time[when],
            "joint": [model.assembly.joint_names[j] for j in joint],
            "state": [words[int(state[t, j])] for t, j in zip(when, joint, strict=True)],
        },
        {"time": "s"},
    )


def _vary(context: Context, options: Dem, trial: Trial, result: Result) -> None:
    """Sensitivity to damping, stiffness and friction (thesis Tables 7.1 to 7.7)."""
    values = trial.model.values
    cases = [
        *(("damping", f, values.scaled(damping=f)) for f in options.vary_damping),
        *(("stiffness", f, values.scaled(stiffness=f)) for f in options.vary_stiffness),
        *(("friction", f, values.scaled(friction=f)) for f in options.vary_friction),
    ]
    if not cases:
        return
    total = len(cases)

    def task(v: JointValues):
        # An unstable variation is a finding, not the end of the others.
        return lambda: trial.any_run(v)

    runs = dem_model.many(
        [task(v) for _, _, v in cases], context.threads, lambda k: context.progress(k, total, "sensitivity")
    )
    rows = []
    for (what, factor, v), run in zip(cases, runs, strict=True):
        gap_p, gap_q, slip = openings(trial.model, run)
        state = hinges(trial.model, gap_p, gap_q, slip)
        farthest = float(displacements(trial.model, run).max(initial=0.0))
        ratio = v.ratios()
        body = trial.model.rigid.body_of_block
        turn = run.place[:, body, 2] - run.settled[body, 2]
        rows.append(
            {
                "varied": what, "value": factor, "beta_s": v.beta, "stiffness_Pa_per_m": float(v.stiffness.max()),
                "friction": float(v.friction.max()), "damping_ratio_rotation": ratio["rotation"],
                "damping_ratio_edge": ratio["edge"],
                "outcome": outcome(run, state, farthest, trial.limit) if run.reason in ("end", "rest", "collapse", "left") else run.reason,
                "peak_rotation_rad": float(np.abs(turn).max(initial=0.0)),
                "bounces": int(run.bounces[: trial.model.rigid.count].sum()),
                "airborne_time_s": float(run.airborne[: trial.model.rigid.count].max(initial=0.0)),
                "peak_slip_m": peak_slip(state, slip),
                "energy_residual_ratio": run.residual,
            }
        )  # fmt: skip
    result.results["sensitivity"] = rows
    result.tables["dem_sensitivity"] = TableData({key: [row[key] for row in rows] for key in rows[0]})
    for k, run in enumerate(runs):
        turn = -(run.place[:, trial.model.rigid.body_of_block, 2] - run.settled[trial.model.rigid.body_of_block, 2])
        follow = int(result.arrays["tracked"].data[0])
        result.arrays[f"varied_time_{k}"] = Array(run.time, (f"varied_time_{k}",), "s")
        result.arrays[f"varied_rotation_{k}"] = Array(turn[:, follow], (f"varied_time_{k}",), "rad")


def friction_threshold(trial: Trial, model: Model, slip: float, accuracy: float = 0.005) -> float | None:
    """Least coefficient of friction at which no joint slides by more than `slip` [m] (thesis 7.2.2); None above 2.

    Raises Cancelled after Ctrl-C, and Refused where a run of the search is not to be trusted.
    """

    def slides(friction: float) -> bool:
        run = trial.any_run(model.values.scaled(friction=friction))
        if run.interrupted:
            raise Cancelled(status_code("cancelled"), "friction search interrupted")
        if run.reason == "unsettled":
            return True
        dem_model.checked(run, model)
        gap_p, gap_q, moved = openings(model, run)
        return peak_slip(hinges(model, gap_p, gap_q, moved), moved) > slip

    low, high = 0.0, 2.0
    if slides(high):
        return None
    while high - low > accuracy:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if slides(middle) else (low, middle)
    return high


#: Keys of the deck that a tilt test does not look at.
NOT_IN_TILT = (
    "end_time", "output_step", "stop_at_collapse", "snapshot_times", "animation", "vtk",
    "vary_damping", "vary_stiffness", "vary_friction", "find_friction", "slip",
)  # fmt: skip


def _tilt(context: Context, options: Dem, model: Model) -> Result:
    """The constant acceleration that brings the structure down: brought in slowly, held, bisected, in both senses."""
    unused = [key for key in NOT_IN_TILT if key in options.model_fields_set]
    if context.deck.motion:
        unused.append("the [motion]")
    if context.building.initial.movements:
        unused.append("[[initial.movements]]")
    if unused:
        context.warnings.append(f"plays no part in a tilt test: {', '.join(unused)}")
    ramp, hold = 2.0, dem_model.settle_time(model)
    base = replace(
        core_options(context, options, model), end_time=ramp + hold, stop_at_rest=False, output_step=0.05,
        collapse=options.collapse_displacement or 0.05 * model.size,
    )  # fmt: skip
    wanted = options.tilt_accuracy * GRAVITY
    total, done = 2.0 * float(np.log2(options.tilt_limit / wanted)), 0

    def falls(a: float) -> dem.Run | None:
        """The run where the acceleration of the ground to -x [m/s^2] brings it down, else None."""
        ground = Ground(
            breaks=np.array([0.0, ramp, ramp + hold + 1.0]),
            linear=np.array([[[0.0, -a / ramp]], [[-a, 0.0]]]), harmonic=np.zeros((2, 1, 0, 4)),
        )  # fmt: skip
        found = dem_model.checked(dem.run(model.bodies(), base, ground), model)
        if found.interrupted:
            raise Cancelled(status_code("cancelled"), "tilt test interrupted")
        return found if found.reason in ("collapse", "left") else None

    def capacity(sense: float) -> tuple[float, dem.Run]:
        """Acceleration [g] and the last run that fell, pushed to +x (sense 1) or -x (-1)."""
        nonlocal done
        low, high = 0.0, options.tilt_limit
        last = falls(sense * high)
        if last is None:
            raise Refused(f"stands at {high / GRAVITY:g} g to {'+x' if sense > 0 else '-x'}: raise tilt_limit")
        while high - low > wanted:
            middle = 0.5 * (low + high)
            if middle in (low, high):  # as fine as numbers are
                break
            found = falls(sense * middle)
            if found is None:
                low = middle
            else:
                high, last = middle, found
            done += 1
            context.progress(min(done, total), total, "tilt test")
        return 0.5 * (low + high) / GRAVITY, last

    def hinged(run: dem.Run) -> tuple[np.ndarray, np.ndarray, int, list[dict]]:
        """States and slips of the joints, the output where it begins to go, and the hinges there."""
        gap_p, gap_q, slip = openings(model, run)
        state = hinges(model, gap_p, gap_q, slip)
        begun = np.searchsorted(displacements(model, run).max(axis=1), 0.005 * model.size)
        at = min(int(begun), len(run.time) - 1)
        rows = [
            {"joint": int(j), "name": model.assembly.joint_names[j], "side": "intrados" if state[at, j] < 0 else "extrados"}
            for j in np.flatnonzero(np.abs(state[at]) == 1)
        ]  # fmt: skip
        return state, slip, at, rows

    collapse, last = capacity(1.0)
    back, back_run = capacity(-1.0)
    state, slip, at, found_hinges = hinged(last)
    body = model.rigid.body_of_block
    rotation = -(last.place[:, body, 2] - last.settled[body, 2])
    peak = np.abs(rotation).argmax(axis=0)
    result = Result("dem")
    result.results = {
        "test": "tilt",
        "outcome": "collapse",
        "collapse_acceleration_g": collapse,
        "collapse_acceleration_opposite_g": back,
        "tilt_angle_deg": float(np.degrees(np.arctan(collapse))),
        "tilt_angle_opposite_deg": float(np.degrees(np.arctan(back))),
        "load_direction": "+x",
        "hinges": found_hinges,
        "hinges_opposite": hinged(back_run)[3],
        "peak_rotation_rad": {
            model.assembly.block_names[i]: float(rotation[peak[i], i]) for i in _tracked(model, options, last)
        },
        "peak_slip_m": float(np.nanmax(np.abs(slip[at]), initial=0.0)),
        "energy_residual_ratio": max(last.residual, back_run.residual),
        "time_step_s": last.step,
        "steps": last.steps,
        "beta_s": model.values.beta,
    }
    result.arrays = {
        **geometry_arrays(model.assembly),
        "time": Array(last.time, ("time",), "s"),
        "place": Array(_block_places(model, last.place), ("time", "block", "component"), "m, m, rad"),
        "rate": Array(_block_rates(model, last), ("time", "block", "component"), "m/s, m/s, rad/s"),
        "hinge": Array(state, ("time", "joint"), "", "0 closed, -1 hinged at the first end, 1 at the second, 2 open"),
        "snapshot_time": Array(last.time[[at, -1]], ("snapshot",), "s"),
        **_support_arrays(model),
    }
    where = ", ".join(f"{h['name']} ({h['side']})" for h in found_hinges[:6]) or "none"
    least, sense = min((collapse, "+x"), (back, "-x"))
    result.answer = (
        f"A constant horizontal acceleration brings it down at {collapse:.4f} g pushed to +x (a tilt of "
        f"{result.results['tilt_angle_deg']:.2f} deg) and at {back:.4f} g pushed to -x; the least is {least:.4f} g, to {sense}. "
        f"Hinges as it goes to +x: {where}."
    )
    return result


def _answer(r: dict, model: Model, idle: bool) -> str:
    if idle and r["outcome"] == "no-hinging":
        return "It stands under its own weight; nothing moves it."
    turn = max(r["peak_rotation_rad"].items(), key=lambda item: abs(item[1]), default=("", 0.0))
    audit = f"energy ledger closed to {100 * r['energy_residual_ratio']:.2g} %"
    damping = (
        f"damping {100 * r['damping_ratio_rotation']:.3g} % of critical at rotational and {100 * r['damping_ratio_edge']:.3g} % at "
        f"edge impact"
    )
    if r["outcome"] == "collapse":
        who = f" ({r['stopped_by'][0]} is the first to go)" if r["stopped_by"] else ""
        first = f"It collapses{who} at {r['collapse_time_s']:.2f} s"
    elif r["outcome"] == "no-hinging" and r["peak_slip_m"] > SLIDES * float(model.assembly.length.min()):
        first = f"It slides by {r['peak_slip_m']:.3g} m; no joint opens"
    elif r["outcome"] == "no-hinging":
        first = "No joint opens"
    else:
        first = f"It rocks and stands: greatest displacement {r['peak_displacement_m']:.3g} m"
    return (
        f"{first}; {turn[0]} turns by {1e3 * abs(turn[1]):.3g} mrad at most, slip {1e3 * r['peak_slip_m']:.2g} mm, "
        f"{r['bounces']} bounces; {audit}, {damping}."
    )
