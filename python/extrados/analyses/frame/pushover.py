"""frame-pushover: all pushover analyses that a code requires of a building as a frame of macro-elements."""

import itertools
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any

import numpy as np

from extrados.analyses.codes.verification import confidence_factor
from extrados.analyses.context import Context, Refused
from extrados.analyses.frame.deflected import deflected_walls
from extrados.analyses.frame.drawn import drawn_arrays
from extrados.analyses.frame.modes import Mode, modes_of, rest_of, way_of
from extrados.analyses.frame.tables import FramePushover
from extrados.analyses.frame.verified import verify_frame
from extrados.core.calls import interruptible
from extrados.core.frame import STATE, STATES, UNLIMITED, Path
from extrados.results import frame as out
from extrados.results.model import Array, Result, TableData
from extrados.views.frame.frame import EquivalentFrame

#: End of a push of which no smaller step is in equilibrium
WITHOUT = "no equilibrium even with the smallest step"
#: Fall of the base shear at which codes take a building as failed
DROP = 0.8
#: Modes among which the main one of a direction is sought
MODES = 12
#: Walls whose direction has less than this part of that of the push are not pushed in their planes
FACING = 0.1


@dataclass(frozen=True)
class Push:
    """One of the pushes: direction [deg], sense, pattern, eccentricity over the length across; forces (n) whose sum along the
    sense is 1 N, and the row (n) of the control displacement."""

    direction: float
    sense: str
    pattern: str
    eccentricity: float
    forces: np.ndarray
    control: np.ndarray
    mode: Mode
    way: np.ndarray

    @property
    def name(self) -> str:
        """As results call it."""
        axis = {0.0: "x", 90.0: "y"}.get(self.direction % 360.0)
        towards = f"{self.sense}{axis}" if axis else f"{self.direction:g} deg, sense {self.sense},"
        shift = "" if self.eccentricity == 0.0 else f", eccentricity {100 * self.eccentricity:+.3g} %"
        return f"{towards} {self.pattern}{shift}"


def pushes_of(frame: EquivalentFrame, options: FramePushover, modes: Sequence[Mode], level: int) -> list[Push]:
    """All combinations of direction, pattern, sense and eccentricity."""
    found = []
    places = np.array([one.place for one in frame.masses])
    mass = np.array([one.mass for one in frame.masses])
    rows = np.array([one.rows for one in frame.masses])
    corners = np.array([end for wall in frame.plan.walls for end in (wall.start, wall.end)])
    for direction, pattern, sense, shift in itertools.product(options.directions, options.patterns, options.senses, options.eccentricities):
        way = way_of(direction)
        across = np.array([-way[1], way[0]])
        mode = max(modes, key=lambda m: m.participating(way))
        shape = {"uniform": np.ones(len(mass)), "static": places[:, 2], "modal": rows @ mode.shape @ way}[pattern]
        if pattern == "modal" and shape.sum() < 0.0:
            shape = -shape
        own = mass * shape
        arm = places[:, :2] @ across
        arm = arm - own @ arm / own.sum()
        # Forces linear across the direction, so that their resultant lies off the centre by the eccentricity
        lever = shift * np.ptp(corners @ across) * own.sum() / (own @ arm**2) if shift else 0.0
        own = own * (1.0 + lever * arm) / own.sum()
        sign = 1.0 if sense == "+" else -1.0
        forces = sign * np.einsum("m,d,mdn->n", own, way, rows)
        found.append(Push(direction, sense, pattern, shift, forces, sign * frame.control(way, level), mode, sign * way))
    return found


def run(context: Context, options: FramePushover) -> Result:
    """All curves, their limit events, and the least of them."""
    result = Result("frame-pushover")
    if "confidence_factor" not in options.frame.model_fields_set:
        divided = {"confidence_factor": confidence_factor(context, options.verification)}
        options = options.model_copy(update={"frame": options.frame.model_copy(update=divided)})
    frame = context.building.frame(options.frame)
    context.warnings += frame.remarks + frame.weaknesses
    level = options.control_level or max(one.level for one in frame.masses)
    height = float(frame.plan.levels[level])
    with interruptible(), frame.core() as core:
        rest = rest_of(frame, core)
        pushes = pushes_of(frame, options, modes_of(frame, rest.tangent, MODES), level)
        _warn_tension(context, frame, rest.force)
        done = itertools.count(1)

        def one(push: Push) -> Path:
            path = core.push(push.forces, push.control, options.target_drift * height, options.steps, options.drop)
            context.progress(next(done), len(pushes), push.name)
            return path

        with ThreadPoolExecutor(max(1, context.threads)) as pool:
            paths = list(pool.map(one, pushes))
    _refuse_unstable(paths)
    runs = [row_of(frame, push, path) for push, path in zip(pushes, paths, strict=True)]
    peaks = [max(row["base_shear_N"]) for row in runs]
    least = int(np.argmin(peaks))
    context.warnings += [
        (f"Run {row['name']}: no stiffness is given, because the curve has no displacement up to its greatest base shear ({row['stop']}).")
        for row in runs
        if row["stiffness_N_m"] is None
    ]
    result.results = out.FramePushover(
        runs=[out.FramePush(**row) for row in runs],
        weight_N=frame.total_weight,
        moving_mass_kg=sum(m.mass for m in frame.masses),
        control_level=level,
        control_height_m=height,
        base_shear_N=peaks[least],
        ultimate_displacement_m=runs[least]["ultimate_displacement_m"],
        governing=runs[least]["name"],
        failed=runs[least]["failed"],
        piers=frame.piers,
        spandrels=frame.spandrels,
        **_ring_beams(frame, paths),
        **_deflected(context, options),
        walls=[wall.name for wall in frame.plan.walls],
        remarks=frame.remarks + frame.weaknesses,
    )
    verified = verify_frame(context, result, frame, rest.tangent, options, pushes, paths)
    if verified is not None:
        result.results = result.results.model_copy(update={"verification": verified})
    _arrays(result, frame, paths)
    interrupted = any(path.stop == "interrupted" for path in paths)
    if interrupted:
        result.status, result.reason = "interrupted", "interrupted; the curves up to then are saved"
    result.answer = _answer(result.results)
    if verified is not None and verified.decides:
        walls = result.results.out_of_plane
        lost = walls is not None and walls.outcome in ("collapses", "cannot-stand")
        result.answer = f"{verified.judged('').statement.strip()} {f'Out of plane: {walls.statement} ' if lost else ''}{result.answer}"
    return result


def push_once(frame: EquivalentFrame, options: FramePushover, direction: float) -> tuple[dict[str, Any], Path]:
    """One pushover by the masses along a direction on the plan [deg], without eccentricity: its row of results and its path."""
    level = options.control_level or max(one.level for one in frame.masses)
    update = {"directions": [direction], "senses": ["+"], "patterns": ["uniform"], "eccentricities": [0.0]}
    with frame.core() as core:
        rest = rest_of(frame, core)
        (push,) = pushes_of(frame, options.model_copy(update=update), modes_of(frame, rest.tangent, MODES), level)
        height = float(frame.plan.levels[level])
        path = core.push(push.forces, push.control, options.target_drift * height, options.steps, options.drop)
    _refuse_unstable([path])
    return row_of(frame, push, path), path


def _refuse_unstable(paths: Sequence[Path]) -> None:
    """Refused if the frame has no equilibrium before any push."""
    if any(path.stop == "no equilibrium under the weight" for path in paths):
        raise Refused("the frame has no equilibrium under its own weight", ("structure", "walls"))


def _warn_tension(context: Context, frame: EquivalentFrame, force: np.ndarray) -> None:
    loose = [s.name for s, f in zip(frame.strips, force, strict=True) if s.kind == "pier" and f[0] <= 0.0]
    if loose:
        context.warnings.append(
            f"{len(loose)} piers carry no vertical load at rest and therefore resist no horizontal force; the first of them is {loose[0]}."
        )
    for strip, element, f in zip(frame.strips, frame.elements, force, strict=True):
        limit = element.strength * element.depth * element.thickness
        if strip.kind == "pier" and f[0] > 0.6 * limit:
            context.warnings.append(f"The stress in pier '{strip.name}' at rest is {f[0] / limit:.0%} of its compressive strength.")


def row_of(frame: EquivalentFrame, push: Push, path: Path) -> dict[str, Any]:
    """A run as results have it."""
    shear, moved = path.multiple, path.control
    peak = int(shear.argmax())
    fallen = np.flatnonzero(shear[peak:] < DROP * shear[peak])
    drop = None
    if len(fallen):
        k = peak + int(fallen[0])
        part = (shear[k - 1] - DROP * shear[peak]) / (shear[k - 1] - shear[k])
        drop = float(moved[k - 1] + part * (moved[k] - moved[k - 1]))
    storeys = _limits(frame, push, path)
    limits = [s["all_at_limit_m"] for s in storeys if s["all_at_limit_m"] is not None]
    ends = [d for d in (drop, *limits) if d is not None]
    stop, failed = path.stop, _failed(frame, path)
    if stop == WITHOUT and failed:  # the curve cannot go on: its end is on the safe side
        stop = f"no equilibrium beyond the drift limit of {failed[-1]['element']}"
        ends.append(float(moved[-1]))
    mass = frame.mass
    shape = push.mode.shape / float(push.control @ push.mode.shape)
    unit = frame.unit(push.way)
    own, square = float(shape @ mass @ unit), float(shape @ mass @ shape)
    levels = sorted({one.level for one in frame.masses})
    elastic = 0.1 * shear[peak]
    there = float(np.interp(elastic, shear[: peak + 1], moved[: peak + 1]))
    ultimate = min(ends) if ends else None
    return {
        "name": push.name,
        "direction_deg": float(push.direction),
        "sense": push.sense,
        "pattern": push.pattern,
        "eccentricity": float(push.eccentricity),
        "stop": stop,
        **({} if path.loose is None else {"lost_at": place_of(frame, path.loose)}),
        "control_displacement_m": moved,
        "base_shear_N": shear,
        "peak_base_shear_N": float(shear[peak]),
        "displacement_at_peak_m": float(moved[peak]),
        "drop_displacement_m": drop,
        "ultimate_displacement_m": ultimate,
        "stiffness_N_m": float(elastic) / there if there > 0.0 else None,
        "period_s": 1.0 / push.mode.frequency,
        "equivalent_mass_kg": own,
        "participation_factor": own / square,
        "level_mass_kg": [sum(one.mass for one in frame.masses if one.level == k) for k in levels],
        "level_shape": [float(frame.control(push.way, k) @ shape) for k in levels],
        "storeys": storeys,
        "failed": failed,
    }


def place_of(frame: EquivalentFrame, freedom: int) -> str:
    """Where the frame has a freedom: a rigid node, or a wall that moves along itself on a level."""
    for node in frame.nodes:
        if freedom in node.freedoms:
            moves = "moves vertically" if freedom == node.freedoms[0] else "rotates"
            return f"the rigid node of wall '{frame.plan.walls[node.wall].name}' at {node.s:.3g} m on level {node.level} {moves}"
    w, level = next(place for place, own in frame.along.items() if own == freedom)
    return f"on level {level}, wall '{frame.plan.walls[w].name}' moves along its own plane"


def _limits(frame: EquivalentFrame, push: Push, path: Path) -> list[dict[str, Any]]:
    """Of each storey of each wall along the push: control displacements at which piers reach their strength and drift limit."""
    rows = []
    for wall, storey, own in storeys_of(frame, push.way):
        row: dict[str, Any] = {"wall": wall, "storey": storey}
        for name, least in (("strength", STATE["flexure"]), ("limit", STATE["failed_flexure"])):
            reached = path.state[:, own] >= least
            for word, there in (("first", reached.any(axis=1)), ("all", reached.all(axis=1))):
                k = np.flatnonzero(there)
                row[f"{word}_at_{name}_m"] = float(path.control[k[0]]) if len(k) else None
        rows.append(row)
    return rows


def storeys_of(frame: EquivalentFrame, way: np.ndarray) -> list[tuple[str, int, list[int]]]:
    """Wall, storey and numbers of the piers, of every storey of every wall that a push along `way` meets in its plane."""
    return [
        (wall.name, storey, [k for k, s in enumerate(frame.strips) if (s.kind, s.wall, s.storey) == ("pier", w, storey)])
        for w, wall in enumerate(frame.plan.walls)
        if abs(float(wall.direction @ way)) >= FACING
        for storey in range(1, frame.plan.reach(wall)[1] + 1)
    ]


def _failed(frame: EquivalentFrame, path: Path) -> list[dict[str, Any]]:
    """Elements beyond their drift limits in the order in which they reach these."""
    rows = []
    for k, strip in enumerate(frame.strips):
        there = np.flatnonzero(path.state[:, k] >= STATE["failed_flexure"])
        if len(there):
            at = int(there[0])
            mode = "shear" if path.state[at, k] == STATE["failed_shear"] else "flexure"
            rows.append({"element": strip.name, "mode": mode, "control_displacement_m": float(path.control[at])})
    return sorted(rows, key=lambda row: row["control_displacement_m"])


def _ring_beams(frame: EquivalentFrame, paths: Sequence[Path]) -> dict[str, Any]:
    """Greatest moment of the elastic ring beams up to the peaks of all runs; nothing without any."""
    own = [k for k, s in enumerate(frame.strips) if s.kind == "ring beam" and frame.elements[k].moment >= UNLIMITED]
    if not own:
        return {}
    return {"ring_beam_moment_Nm": max(float(np.abs(p.force[: int(p.multiple.argmax()) + 1, own, 1:]).max()) for p in paths)}


def _deflected(context: Context, options: FramePushover) -> dict[str, Any]:
    """Every wall out of its plane, with its deflection, if the deck does not exclude it."""
    if not options.deflected_walls:
        return {}
    rows, missing = deflected_walls(context.building, options.frame)
    context.warnings += missing
    return {"walls_out_of_plane": rows}


def _arrays(result: Result, frame: EquivalentFrame, paths: Sequence[Path]) -> None:
    """What figures need: walls and elements once; of each run the states of its elements."""
    result.arrays.update(drawn_arrays(frame))
    for k, path in enumerate(paths):
        result.arrays[f"state_{k + 1}"] = Array(
            path.state.astype(np.int8),
            (f"step_{k + 1}", "element"),
            "",
            f"states of run {k + 1}: " + ", ".join(f"{n} {word}" for n, word in STATES.items()),
            "states of elements",
        )
        result.tables[f"curve_{k + 1}"] = TableData(
            {"control_displacement": path.control, "base_shear": path.multiple}, {"control_displacement": "m", "base_shear": "N"}
        )
    result.tables["elements"] = TableData(
        {
            "name": [s.name for s in frame.strips],
            "kind": [s.kind for s in frame.strips],
            "length": [e.length for e in frame.elements],
            "depth": [e.depth for e in frame.elements],
            "thickness": [e.thickness for e in frame.elements],
        },
        {"length": "m", "depth": "m", "thickness": "m"},
    )


def _answer(r: out.FramePushover) -> str:
    worst = next(row for row in r.runs if row.name == r.governing)
    text = (
        f"The least base shear of {len(r.runs)} pushovers is {r.base_shear_N / 1000.0:.3g} kN ({r.base_shear_N / r.weight_N:.3g} of the "
        f"weight), in the pushover {worst.name}, at a displacement of {1000.0 * worst.displacement_at_peak_m:.3g} mm."
    )
    if worst.ultimate_displacement_m is not None:
        text += f" In this pushover, the ultimate displacement is {1000.0 * worst.ultimate_displacement_m:.3g} mm."
    if worst.failed:
        first = worst.failed[0]
        text += (
            f" The first element that exceeds its drift limit is {first.element} (in {first.mode}), at {1000.0 * first.control_displacement_m:.3g} "
            "mm."
        )
    if r.walls_out_of_plane:
        text += f" {r.weakest_wall()}"
    lost = [f"{row.name} ({row.lost_at})" if row.lost_at else row.name for row in r.runs if row.stop.startswith("no equilibrium")]
    if lost:
        text += f" These runs ended without equilibrium: {', '.join(lost)}."
    return text
