"""Figures of discrete-element runs: snapshots, histories, energies, hinges, sensitivity, failure curves, animation."""

import itertools
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection

from extrados.results.dem import (
    HINGED_FIRST,
    HINGED_SECOND,
    BlocksRun,
    BlocksTilt,
    DemDomain,
    DemParameters,
    DemRun,
    DemTilt,
    SolidDemRun,
    SolidDemTilt,
)
from extrados.results.store import Stored
from extrados.schema.constants import GRAVITY
from extrados.show import film, solid_dem, style
from extrados.show.dem_forces import draw_forces
from extrados.show.stones import Stones, moved, outlines

SHOWN = 6
MOST_HINGES = 40


def _stored(run: Stored, name: str) -> DemRun | DemTilt:
    """Results of a run or a tilt test in a plane."""
    found = run[name]
    assert isinstance(found, DemRun | DemTilt)
    return found


def _balance(run: Stored, name: str) -> float:
    """Error of the energy balance over the energy exchanged, of a run in a plane or in space."""
    found = run[name]
    assert isinstance(found, BlocksRun | BlocksTilt)
    return found.energy_residual_ratio


def _at(run: Stored, name: str, time: float) -> int:
    return int(np.abs(run.array(name, "time") - time).argmin())


def _supports(run: Stored, name: str) -> list[np.ndarray]:
    vertices, start = run.array(name, "support_outline"), run.array(name, "support_start")
    return [vertices[a:b] for a, b in itertools.pairwise(start)]


def _window(run: Stored, name: str, picks: list[int]) -> tuple[float, float, float, float]:
    """Limits of the drawings: the structure and where its blocks are at the outputs drawn, within reason."""
    points = run.array(name, "outline")
    low, high = points.min(axis=0), points.max(axis=0)
    size = float((high - low).max())
    places = run.array(name, "place")[picks][..., :2].reshape(-1, 2)
    near = places[(places > low - 1.5 * size).all(axis=1) & (places < high + 1.5 * size).all(axis=1)]
    shape = float(np.median([np.ptp(o, axis=0).max() for o in outlines(run, name)]))
    if len(near):
        low, high = np.minimum(low, near.min(axis=0) - 0.5 * shape), np.maximum(high, near.max(axis=0) + 0.5 * shape)
    room = 0.12 * size
    return low[0] - room, high[0] + room, low[1] - room, high[1] + room


#: Of the window: length of the greatest force in a joint
THRUST_LENGTH = 0.15
#: Of the window: length of the greatest water pressure
PRESSURE_LENGTH = 0.1


class Scene:
    """What stays the same from one picture of a run to the next."""

    def __init__(self, run: Stored, name: str, picks: list[int]):
        get = run.arrays[name]
        self.blocks, self.supports = outlines(run, name), _supports(run, name)
        self.centroid, self.place, self.rate = (get[k].numbers for k in ("centroid", "place", "rate"))
        self.p, self.q, self.hinge = (get[k].numbers for k in ("joint_p", "joint_q", "hinge"))
        self.owner = _block_of_joint(run, name)
        self.tie_block: np.ndarray = get["tie_block"].numbers if "tie_block" in get else np.empty((0, 2), int)
        self.tie_point: np.ndarray = get["tie_point"].numbers if "tie_point" in get else np.empty((0, 2, 2))
        self.window = _window(run, name, picks)
        self.water = [get[f"water_{k}"].numbers for k in ("point", "pressure", "block")] if "water_point" in get else None
        self.thrust_force = get["thrust_force"].numbers if "thrust_force" in get else np.zeros((0, 0, 2))
        self.thrust_place = get["thrust_place"].numbers if "thrust_place" in get else np.zeros((0, 0, 2))
        self.longest = float(np.linalg.norm(self.thrust_force[picks], axis=2).max(initial=0.0)) if self.thrust_force.size else 0.0

    @property
    def aspect(self) -> float:
        """Height over width of the window."""
        left, right, bottom, top = self.window
        return (top - bottom) / (right - left)

    def hinges(self, k: int) -> np.ndarray:
        """Where joints are hinged at output k (points, 2); none where they are too many to be told apart."""
        points = []
        for j in np.flatnonzero(np.isin(self.hinge[k], (HINGED_FIRST, HINGED_SECOND))):
            if self.owner[j] >= 0:
                point = self.p[j] if self.hinge[k, j] == HINGED_FIRST else self.q[j]
                points.append(moved(point[None], self.centroid[self.owner[j]], self.place[k, self.owner[j]])[0])
        return np.array(points) if 0 < len(points) <= MOST_HINGES else np.empty((0, 2))

    def ties(self, k: int) -> np.ndarray:
        """Both ends of the ties at output k (ties, 2, 2); those in the ground stay."""
        ends = self.tie_point.copy()
        for i, end in np.argwhere(self.tie_block >= 0):
            block = self.tie_block[i, end]
            ends[i, end] = moved(ends[i, end][None], self.centroid[block], self.place[k, block])[0]
        return ends

    def thrust(self, k: int) -> np.ndarray:
        """Forces in the joints at output k as segments (n, 2, 2) through their places; their lengths are in proportion."""
        if self.longest <= 0.0:
            return np.empty((0, 2, 2))
        left, right, bottom, top = self.window
        half = 0.5 * THRUST_LENGTH * max(right - left, top - bottom) / self.longest * self.thrust_force[k]
        there = np.isfinite(self.thrust_place[k]).all(axis=1)
        place = self.thrust_place[k][there]
        return np.stack([place - half[there], place + half[there]], axis=1)

    def pressure(self, k: int) -> np.ndarray:
        """The water pressure at output k as segments (n, 2, 2) that end on the faces; their lengths are in proportion."""
        if self.water is None:
            return np.empty((0, 2, 2))
        point, pressure, block = self.water
        there = np.empty_like(point)
        for i in np.unique(block):
            there[block == i] = moved(point[block == i], self.centroid[i], self.place[k, i])
        left, right, bottom, top = self.window
        length = PRESSURE_LENGTH * max(right - left, top - bottom) / float(np.hypot(*pressure.T).max())
        return np.stack([there - length * pressure, there], axis=1)

    def draw(self, ax: Axes, k: int, arrows: float) -> None:
        """Blocks at output k, hinges, and velocities as arrows (`arrows`: metres per m/s)."""
        place, rate = self.place[k], self.rate[k]
        left, right, bottom, top = self.window
        for support in self.supports:
            ax.fill(*support.T, facecolor="#d7d3cb", edgecolor="none", zorder=0)
        shapes = [moved(o, c, p) for o, c, p in zip(self.blocks, self.centroid, place, strict=True)]
        ax.add_collection(PolyCollection(shapes, facecolor=style.STONE, edgecolor=style.EDGE, linewidth=0.7))
        ax.add_collection(LineCollection(list(self.ties(k)), color=style.THRUST, linewidth=1.6, zorder=5))
        ax.add_collection(LineCollection(list(self.thrust(k)), color=style.HINGE, linewidth=1.4, zorder=4))
        ax.add_collection(LineCollection(list(self.pressure(k)), color=style.WATER, linewidth=0.7, zorder=3))
        points = self.hinges(k)
        if len(points):
            style.draw_hinges(ax, points)
        if arrows > 0.0:
            ax.quiver(
                place[:, 0],
                place[:, 1],
                rate[:, 0] * arrows,
                rate[:, 1] * arrows,
                angles="xy",
                scale_units="xy",
                scale=1.0,
                color=style.THRUST,
                width=0.005,
                zorder=6,
            )
        ax.set_xlim(left, right)
        ax.set_ylim(bottom, top)
        ax.set_aspect("equal")
        ax.grid(False)
        ax.set_xticks([])
        ax.set_yticks([])


def _block_of_joint(run: Stored, name: str) -> np.ndarray:
    """A block whose outline holds both ends of each joint."""
    p, q = run.array(name, "joint_p"), run.array(name, "joint_q")
    found = np.full(len(p), -1)
    for i, outline in enumerate(outlines(run, name)):
        edge = np.roll(outline, -1, axis=0) - outline
        length = np.hypot(*edge.T)
        for j in np.flatnonzero(found < 0):
            away = [point - outline for point in (p[j], q[j])]
            across = [np.abs(edge[:, 0] * a[:, 1] - edge[:, 1] * a[:, 0]) / length for a in away]
            along = [(edge * a).sum(axis=1) / length for a in away]
            small = 1e-6 * length.max()
            on = [(c < small) & (s > -small) & (s < length + small) for c, s in zip(across, along, strict=True)]
            if (on[0] & on[1]).any():
                found[j] = i
    return found


def draw_dem(run: Stored, name: str, folder: Path) -> list[tuple[str, str]]:
    """Everything that a run or a tilt test has to show."""
    if isinstance(run[name], SolidDemRun | SolidDemTilt):
        figures = solid_dem.draw(run, name, folder)
        if "kinetic_energy" in run.arrays[name]:
            figures.append(_energies(run, name, folder))
        return [*figures, *_ties(run, name, folder)]
    figures = [_snapshots(run, name, folder)]
    if "rotation" in run.arrays[name]:
        figures += [_histories(run, name, folder), _energies(run, name, folder), draw_forces(run, name, folder)]
        if run.array(name, "hinge").shape[1] > 1:
            figures.append(_hinge_map(run, name, folder))
        figures += _ties(run, name, folder)
        if run[name].get("sensitivity"):
            figures.append(_sensitivity(run, name, folder))
    film_dem(run, name, folder)
    return figures


def _snapshots(run: Stored, name: str, folder: Path) -> tuple[str, str]:
    times = run.array(name, "snapshot_time")
    columns = min(3, len(times))
    rows = -(-len(times) // columns)
    rate = run.array(name, "rate")
    picks = [_at(run, name, t) for t in times]
    scene = Scene(run, name, picks)
    fastest = max((float(np.hypot(*rate[k, :, :2].T).max()) for k in picks), default=0.0)
    left, right, bottom, top = scene.window
    arrows = 0.15 * max(right - left, top - bottom) / fastest if fastest > 1e-6 else 0.0
    with style.figure(9.5, 3.1 * rows * min(1.6, max(0.4, scene.aspect)) + 0.4, rows=rows, columns=columns) as (fig, axes):
        for ax, k in zip(axes, picks, strict=False):
            scene.draw(ax, k, arrows)
            ax.set_title(f"{run.array(name, 'time')[k]:.3f} s")
        for ax in axes[len(times) :]:
            ax.axis("off")
        saved = style.save(fig, folder, f"{name}-snapshots")
    scale = f" (longest arrow {fastest:.3g} m/s)" if arrows else ""
    forces = (
        f" Lines: forces through the centres of compression of the joints; the longest is {scene.longest / 1e3:.3g} kN."
        if scene.longest
        else ""
    )
    if scene.water is not None:
        forces += f" Blue lines: water pressure on faces and in joints; the longest is {np.hypot(*scene.water[1].T).max() / 1e3:.3g} kPa."
    return saved, f"Displaced structure, hinges (circles) and velocities of the blocks{scale}.{forces}"


def _histories(run: Stored, name: str, folder: Path) -> tuple[str, str]:
    time, rotation = run.array(name, "time"), run.array(name, "rotation")
    tracked = run.array(name, "tracked")
    most = tracked[np.argsort(-np.abs(rotation[:, tracked]).max(axis=0), kind="stable")[:SHOWN]]
    names = list(_stored(run, name).peak_rotation_rad)
    label = dict(zip(tracked.tolist(), names, strict=True))
    rigid = next((a for a in run.analyses if a["kind"] == "rocking" and "rotation" in run.arrays[a["name"]]), None)
    slid = run[name].get("slipped_joint")
    rows = [3, 1] if slid is None else [3, 2, 1]
    with style.figure(8.0, 1.35 * sum(rows), rows=len(rows), sharex=True, height_ratios=rows) as (fig, axes):
        top, low = axes[0], axes[-1]
        if slid is not None:
            slip = np.nan_to_num(run.array(name, "slip"))
            axes[1].plot(time, 1e3 * slip[:, int(np.abs(slip).max(axis=0).argmax())], color=style.EDGE)
            axes[1].set_ylabel("greatest slip [mm]")
        if rigid is not None and len(tracked) == 1:
            other = run.arrays[rigid["name"]]
            top.plot(
                other["time"].numbers,
                1e3 * other["rotation"].numbers,
                color="#999999",
                linewidth=2.4,
                label="rocking of the single mechanism",
            )
        for i in most:
            top.plot(time, 1e3 * rotation[:, i], label=label[int(i)])
        top.set_ylabel("rotation [mrad], positive to +x")
        style.legend_above(top)
        low.plot(time, run.array(name, "ground") / GRAVITY, color=style.EDGE)
        low.set_ylabel("ground [g]")
        low.set_xlabel("time [s]")
        low.set_xlim(0.0, time[-1])
        saved = style.save(fig, folder, f"{name}-rotation")
    slips = "" if slid is None else ", and slip of the joint that slips most"
    loads = "self-weight and the water pressure" if "water_point" in run.arrays[name] else "self-weight"
    return saved, f"Rotation of the blocks, measured from equilibrium under {loads}{slips}, and the ground acceleration."


def _energies(run: Stored, name: str, folder: Path) -> tuple[str, str]:
    time = run.array(name, "time")
    words = {
        "work": "work of the ground",
        "kinetic": "kinetic",
        "potential": "potential (gravity)",
        "elastic": "elastic",
        "damping": "lost in damping",
        "friction": "lost in friction",
        "residual": "residual",
    }
    with style.figure(8.0, 5.4, rows=2, sharex=True) as (fig, (top, low)):
        style.energies(top, "kinetic energy", [(time, run.array(name, "kinetic_energy"), {"color": style.THRUST})])
        top.set_title("Drops are impacts")
        lines = [
            (time, run.array(name, f"{key}_energy"), {"label": word, "linestyle": "--" if key == "residual" else "-"})
            for key, word in words.items()
        ]
        style.energies(low, "energy", lines)
        low.set_xlabel("time [s]")
        low.set_xlim(0.0, time[-1] or 1.0)
        style.legend_above(low)
        saved = style.save(fig, folder, f"{name}-energy")
    return saved, (
        f"Kinetic energy, and all terms of the energy balance. The balance has an error of {100 * _balance(run, name):.2g} "
        "% of the total energy exchanged."
    )


def _ties(run: Stored, name: str, folder: Path) -> list[tuple[str, str]]:
    """Forces of ties and dampers over time, of those with the greatest; nothing without any."""
    if "tie_force" not in run.arrays[name]:
        return []
    time, force, rows = run.array(name, "time"), run.array(name, "tie_force"), run[name].get("ties") or []
    greatest = np.argsort([-abs(row.peak_force_N) for row in rows], kind="stable")[:SHOWN]
    with style.figure(8.0, 3.2) as (fig, (ax,)):
        for k in greatest:
            state = "" if rows[k].state == "elastic" else f" ({rows[k].state})"
            ax.plot(time, 1e-3 * force[:, k], linewidth=1.0, label=f"{rows[k].name}{state}")
        ax.set_ylabel("force [kN], tension positive")
        ax.set_xlabel("time [s]")
        ax.set_xlim(0.0, time[-1] or 1.0)
        style.legend_above(ax)
        saved = style.save(fig, folder, f"{name}-ties")
    return [(saved, "Forces of ties and dampers" + (f", the {SHOWN} with the greatest forces." if len(rows) > SHOWN else "."))]


def _hinge_map(run: Stored, name: str, folder: Path) -> tuple[str, str]:
    states = {
        "hinge at the first end\n(intrados of an arch)": style.HINGE,
        "closed": "#f4f1ea",
        "hinge at the second end\n(extrados of an arch)": style.THRUST,
        "open": "#d9a400",
    }
    time, hinge = run.array(name, "time"), run.array(name, "hinge")
    saved = solid_dem.draw_states(time, hinge, states, HINGED_FIRST, "joint", folder, f"{name}-hinges")
    return saved, "State of each joint over time: closed, open, or with a hinge at one of its two ends."


def _sensitivity(run: Stored, name: str, folder: Path) -> tuple[str, str]:
    rows = run.results_of(name, DemRun).sensitivity
    kinds = list(dict.fromkeys(row.varied for row in rows))
    times, turns = (run.series(name, what) for what in ("varied_time", "varied_rotation"))
    time, rotation = run.array(name, "time"), run.array(name, "rotation")
    follow = int(run.array(name, "tracked")[0])
    with style.figure(8.0, 2.6 * len(kinds) + 0.4, rows=len(kinds), sharex=True) as (fig, axes):
        for ax, kind in zip(axes, kinds, strict=True):
            ax.plot(time, 1e3 * rotation[:, follow], color="black", linewidth=1.8, label="as given")
            for k, row in enumerate(rows):
                if row.varied == kind:
                    ax.plot(
                        times[k].numbers,
                        1e3 * turns[k].numbers,
                        label=f"{'' if kind == 'friction' else 'x '}{row.value:g} ({row.outcome})",
                        linewidth=0.9,
                    )
            ax.set_title(kind, loc="left")
            ax.set_ylabel("rotation [mrad]")
            style.legend_above(ax)
        axes[-1].set_xlabel("time [s]")
        saved = style.save(fig, folder, f"{name}-sensitivity")
    return saved, "Sensitivity of the rotation of the first tracked block to damping, stiffness and friction."


def draw_domain(run: Stored, name: str, folder: Path) -> list[tuple[str, str]]:
    """Failure curves in the plane of duration and amplitude."""
    amplitude, shortest = run.array(name, "amplitude"), run.array(name, "shortest")
    labels = [str(v) for v in run.array(name, "curve")]
    with style.figure(6.5, 4.6) as (fig, (ax,)):
        for k, (label, row) in enumerate(zip(labels, shortest, strict=True)):
            shown = "discrete elements" if k == 0 else label
            if k == 0 and run.results_of(name, DemDomain).cross_check is not None:
                shown += f" ({run.results_of(name, DemDomain).curves[0].solver})"
            ax.plot(row, amplitude, "o-" if k == 0 else ".-", linewidth=1.8 if k == 0 else 0.9, label=shown)
        if run.results_of(name, DemDomain).mode_II_durations_s is not None:
            ax.plot(run.array(name, "elements_mode_II"), amplitude, "s-", label="discrete elements, mode II")
        for mode, mark in (("mode_I", "--"), ("mode_II", ":")):
            if mode in run.arrays[name]:
                ax.plot(run.array(name, mode), amplitude, mark, color="black", label=f"four hinges, {mode.replace('_', ' ')}")
        ax.set_xlabel("t_p [s]" if run.results_of(name, DemDomain).pulse == "step" else "T_p [s]")
        ax.set_ylabel("amplitude [g]")
        ax.set_xlim(left=0.0)
        ax.legend()
        saved = style.save(fig, folder, f"{name}-curves")
    drawn = [(saved, ("Shortest pulse that causes collapse, at each amplitude. Pulses to the right of a curve cause collapse."))]
    return [*drawn, _both_solvers(run, name, folder)] if run.results_of(name, DemDomain).cross_check is not None else drawn


def _both_solvers(run: Stored, name: str, folder: Path) -> tuple[str, str]:
    """Outcomes of all cells by both solvers."""
    check, fails = run.results_of(name, DemDomain).cross_check, run.array(name, "fails")
    amplitude, duration = np.meshgrid(run.array(name, "amplitude"), run.array(name, "duration"), indexing="ij")
    first, second = (
        ("nonsmooth", "compliant") if run.results_of(name, DemDomain).curves[0].solver == "nonsmooth" else ("compliant", "nonsmooth")
    )
    kinds = (
        (fails[0] & fails[1], "collapse with both", {"marker": "s", "color": style.HINGE}),
        (~fails[0] & ~fails[1] & 1, "no collapse with either", {"marker": "s", "color": "#d8d4c8"}),
        (fails[0] & ~fails[1] & 1, f"collapse with {first} only", {"marker": "X", "color": style.THRUST}),
        (~fails[0] & 1 & fails[1], f"collapse with {second} only", {"marker": "P", "color": "#d9a400"}),
    )
    with style.figure(6.5, 4.6) as (fig, (ax,)):
        for cells, label, look in kinds:
            at = cells.astype(bool)
            if at.any():
                ax.scatter(duration[at], amplitude[at], s=36, label=label, zorder=3, **look)
        ax.set_xlabel("t_p [s]" if run.results_of(name, DemDomain).pulse == "step" else "T_p [s]")
        ax.set_ylabel("amplitude [g]")
        ax.set_xlim(left=0.0)
        ax.set_ylim(bottom=0.0)
        if check is not None:
            ax.set_title(f"both solvers give the same outcome in {100 * check.agreement_ratio:.0f} % of {check.cells} cells")
        ax.legend(loc="center left", bbox_to_anchor=(1.0, 0.5))
        saved = style.save(fig, folder, f"{name}-solvers")
    return saved, ("Outcome of each cell of the map by two solvers: springs (compliant) and rigid contacts (nonsmooth).")


def draw_parameters(run: Stored, name: str, folder: Path) -> list[tuple[str, str]]:
    """Damping over frequency, with the impact frequencies of the joints (thesis Figs 7-2, 7-4, 7-12)."""
    beta, alpha = run.results_of(name, DemParameters).beta_s, run.results_of(name, DemParameters).mass_damping_per_s

    def percent(frequency: np.ndarray) -> np.ndarray:
        return 50.0 * (beta * frequency + alpha / frequency)

    with style.figure(6.5, 4.0) as (fig, (ax,)):
        lowest = min(run.array(name, f"{k}_frequency").min() for k in ("rotation", "corner", "edge"))
        highest = max(run.array(name, f"{k}_frequency").max() for k in ("rotation", "corner", "edge"))
        if alpha > 0.0 and beta > 0.0:
            lowest = min(lowest, np.sqrt(alpha / beta))  # where damping is least
        frequency = np.geomspace(0.1 * lowest, 3.0 * highest, 200)
        label = f"beta = {beta:.3g} s" + (f", alpha = {alpha:.3g} 1/s" if alpha > 0.0 else "")
        ax.loglog(frequency, percent(frequency), color=style.EDGE, label=label)
        for kind, colour in (("rotation", style.THRUST), ("corner", style.HINGE), ("edge", style.GROUND)):
            values = run.array(name, f"{kind}_frequency")
            ax.loglog(values, percent(values), "o", color=colour, label=f"{kind} impact")
        for level, word in ((10.0, "least at rotation"), (25.0, "least at edge"), (100.0, "critical")):
            ax.axhline(level, color="#bbbbbb", linewidth=0.8)
            ax.text(frequency[0], level * 1.05, f"{level:g} % {word}", fontsize=7)
        ax.set_xlabel("frequency [rad/s]")
        ax.set_ylabel("critical damping [%]")
        ax.legend()
        saved = style.save(fig, folder, f"{name}-damping")
    return [(saved, "Damping ratio (fraction of critical damping) at the impact frequencies of the joints.")]


def film_dem(run: Stored, name: str, folder: Path) -> None:
    """Blocks as they rock, hinge, slide and fall, beside ground motion and rotations."""
    kind, speed = film.asked(run, name)
    if kind == "none" or "rotation" not in run.arrays[name]:
        return
    time, rotation = run.array(name, "time"), run.array(name, "rotation")
    frames, _ = film.pictures(time, kind, speed)
    scene = Scene(run, name, frames.tolist())
    tracked = run.array(name, "tracked")
    most = tracked[np.argsort(-np.abs(rotation[:, tracked]).max(axis=0), kind="stable")[:SHOWN]]
    label = dict(zip(tracked.tolist(), _stored(run, name).peak_rotation_rad, strict=True))
    with style.canvas(film.PIXELS[0] / film.DPI, film.PIXELS[1] / film.DPI) as fig:
        ax, (ground, turn) = film.axes(fig, 2)
        ground.plot(time, run.array(name, "ground") / GRAVITY, color=style.GROUND, linewidth=0.8)
        ground.set_ylabel("ground [g]")
        for i in most:
            turn.plot(time, 1e3 * rotation[:, i], label=label[int(i)], linewidth=1.0)
        if len(most) > 1:
            turn.legend(loc="upper left", ncols=2)
        turn.set_ylabel("rotation [mrad]" + (f" of {label[int(most[0])]}" if len(most) == 1 else ""))
        turn.set_xlabel("time [s]")
        turn.set_xlim(float(time[0]), float(time[-1]))
        cursors = [a.axvline(0.0, color=style.THRUST, linewidth=1.0) for a in (ground, turn)]
        for support in scene.supports:
            ax.fill(*support.T, facecolor="#d7d3cb", edgecolor="none", zorder=0)
        stones = Stones(run, name, ax)
        (hinges,) = ax.plot([], [], "o", color=style.HINGE, markersize=6, markerfacecolor="white", markeredgewidth=1.6)
        thrust = LineCollection([], color=style.HINGE, linewidth=1.6, zorder=4)
        ax.add_collection(thrust, autolim=False)
        left, right, bottom, top = scene.window
        ax.set_xlim(left, right)
        ax.set_ylim(bottom, top)
        style.section_axes(ax)

        def show(k: int) -> None:
            stones.place(scene.place[k])
            hinges.set_data(*scene.hinges(k).T)
            thrust.set_segments(list(scene.thrust(k)))

        film.history(ax, folder / "figures" / f"{name}.{kind}", time, speed, show, cursors, [stones.drawn, hinges, thrust])
