"""Figures of discrete elements in space: selected times, histories, energies, contacts, the film."""

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.cm import ScalarMappable
from matplotlib.collections import LineCollection
from matplotlib.colors import BoundaryNorm, LinearSegmentedColormap, ListedColormap, Normalize, to_rgb
from matplotlib.figure import Figure

from extrados.results.dem import SolidDemRun, SolidDemTilt
from extrados.results.solid_files import rotations
from extrados.results.store import Stored
from extrados.schema.constants import GRAVITY
from extrados.show import film, scene, style
from extrados.show.dem_forces import draw_forces
from extrados.show.limit.section import TIE
from extrados.show.solids import FILM_PIXELS, VIEW, faces_of

SHOWN = 6
MOVED = LinearSegmentedColormap.from_list("moved", [style.STONE, "#f2c28b", "#c8553d"])


def _stored(run: Stored, name: str) -> SolidDemRun | SolidDemTilt:
    """Results of a run or a tilt test in space."""
    found = run[name]
    assert isinstance(found, SolidDemRun | SolidDemTilt)
    return found


def draw(run: Stored, name: str, folder: Path) -> list[tuple[str, str]]:
    """Everything that a run or a tilt test of solids has to show."""
    found = [_snapshots(run, name, folder)]
    if "shift" in run.arrays[name]:
        found += [_histories(run, name, folder), _contacts(run, name, folder), draw_forces(run, name, folder)]
        _film(run, name, folder)
    return found


#: Of the picture: length of the greatest force in a contact
THRUST_LENGTH = 0.15


class _Stage:
    """What stays the same from one picture of a run to the next; colours tell how far a stone has gone."""

    def __init__(self, run: Stored, name: str, picks: list[int], pixels: int = scene.PIXELS):
        self.run, self.name, self.pixels = run, name, pixels
        self.pose, self.time = run.array(name, "pose"), run.array(name, "time")
        self.still = faces_of(run, name)
        get = run.arrays[name]
        self.tie_block: np.ndarray = get["tie_block"].numbers if "tie_block" in get else np.empty((0, 2), int)
        self.tie_point: np.ndarray = get["tie_point"].numbers if "tie_point" in get else np.empty((0, 2, 3))
        size = float(np.ptp(self.still.vertices, axis=0).max())
        low, high = self.still.vertices.min(axis=0) - 0.5 * size, self.still.vertices.max(axis=0) + 0.5 * size
        ends = np.concatenate(
            [self.still.vertices, self.tie_point.reshape(-1, 3), *(faces_of(run, name, self.pose[k]).vertices for k in picks)]
        )
        self.frame = scene.frame_of(np.clip(ends, low, high), VIEW)  # what flies farther leaves the picture
        far = np.linalg.norm(self.pose[:, :, :3] - self.pose[0, :, :3], axis=2)
        self.share = far / max(float(far[picks].max()), 1e-12) if far.max() > 1e-4 * size else 0.0 * far
        self.farthest = float(far[picks].max())
        self.force: np.ndarray = get["thrust_force"].numbers if "thrust_force" in get else np.zeros((len(self.time), 0, 3))
        self.place: np.ndarray = get["thrust_place"].numbers if "thrust_place" in get else np.zeros((len(self.time), 0, 3))
        self.longest = float(np.linalg.norm(self.force[picks], axis=2).max(initial=0.0))

    @property
    def aspect(self) -> float:
        """Height over width."""
        left, right, low, high = self.frame
        return (high - low) / (right - left)

    def image(self, k: int) -> np.ndarray:
        colours = np.array(to_rgb(style.STONE)) if not self.share.any() else MOVED(np.clip(self.share[k], 0.0, 1.0))[:, :3]
        colours = np.broadcast_to(colours, (self.pose.shape[1], 3))
        return scene.picture(faces_of(self.run, self.name, self.pose[k]), VIEW, self.frame, colours, self.pixels)

    def segments(self, k: int) -> np.ndarray:
        """Segments (n, 2, 2) of ties and dampers in the picture at output k; their ends in the ground stay."""
        on = np.maximum(self.tie_block, 0)
        arm = self.tie_point - self.run.array(self.name, "solid_centroid")[on]
        turned = np.einsum("neij,nej->nei", rotations(self.pose[k, on.ravel(), 3:]).reshape(*on.shape, 3, 3), arm)
        moved = self.tie_point - arm + self.pose[k, on, :3] + turned
        ends: np.ndarray = np.where(self.tie_block[..., None] < 0, self.tie_point, moved) @ VIEW.axes[:2].T
        return ends

    def thrust(self, k: int) -> np.ndarray:
        """Forces in the contacts at output k as segments (n, 2, 2) of the picture through their places; lengths are in proportion."""
        left, right, low, high = self.frame
        there = np.isfinite(self.place[k]).all(axis=1)
        half = 0.5 * THRUST_LENGTH * max(right - left, high - low) / max(self.longest, 1e-300) * self.force[k][there]
        ends: np.ndarray = np.stack([self.place[k][there] - half, self.place[k][there] + half], axis=1) @ VIEW.axes[:2].T
        return ends

    def lines(self, k: int) -> list[np.ndarray]:
        """Ties, dampers and forces at output k."""
        return [*self.segments(k), *self.thrust(k)]

    def colours(self, k: int) -> list[str]:
        """Their colours."""
        return [TIE] * len(self.segments(k)) + [style.HINGE] * len(self.thrust(k))

    def show(self, ax: Axes, k: int, push: float | None) -> None:
        scene.show(ax, self.image(k), self.frame)
        ax.add_collection(LineCollection(self.lines(k), colors=self.colours(k), linewidths=1.6, zorder=3), autolim=False)
        scene.ground(ax, self.still.vertices, VIEW)
        scene.compass(ax, VIEW, push)


def _snapshots(run: Stored, name: str, folder: Path) -> tuple[str, str]:
    r, times = _stored(run, name), run.array(name, "time")
    picks = [int(np.abs(times - t).argmin()) for t in run.array(name, "snapshot_time")]
    stage = _Stage(run, name, picks)
    columns = min(3, len(picks))
    rows = -(-len(picks) // columns)
    tilt = r if isinstance(r, SolidDemTilt) else None
    with style.figure(10.0, float(np.clip(3.3 * stage.aspect + 0.9, 2.6, 5.5)) * rows, rows=rows, columns=columns) as (fig, axes):
        for n, (ax, k) in enumerate(zip(axes, picks, strict=False)):
            stage.show(ax, k, tilt.load_direction_deg if tilt is not None and n == 0 else None)
            ax.set_title(f"{times[k]:.3f} s")
        for ax in axes[len(picks) :]:
            ax.axis("off")
        if stage.share.any():
            legend(fig, list(axes[: rows * columns]), stage.farthest)
        saved = style.save(fig, folder, f"{name}-snapshots")
    what = f"Collapse at {tilt.collapse_acceleration_g:.4f} g" if tilt is not None else "Displaced stones"
    forces = (
        f" Lines: forces through the centres of compression of the contacts; the longest is {stage.longest / 1e3:.3g} kN."
        if stage.longest
        else ""
    )
    return saved, f"{what}; colours show the displacement of each block (greatest: {stage.farthest:.3g} m).{forces}"


def legend(fig: Figure, axes: list[Axes], farthest: float) -> None:
    """Legend of the colours of the blocks [m]."""
    bar = fig.colorbar(ScalarMappable(Normalize(0.0, farthest), MOVED), ax=axes, shrink=0.6, pad=0.02, aspect=30, panchor=False)
    bar.set_label("displacement of the stone [m]")


def _histories(run: Stored, name: str, folder: Path) -> tuple[str, str]:
    r, time = _stored(run, name), run.array(name, "time")
    assert isinstance(r, SolidDemRun)
    shift, turn, tracked = (run.array(name, key) for key in ("shift", "turn", "tracked"))
    far = np.linalg.norm(shift[:, tracked], axis=2).max(axis=0)
    order = np.argsort(-far, kind="stable")[:SHOWN]
    loads = "self-weight and the water pressure" if r.water_force_N else "self-weight"
    names, both = list(r.peak_rotation_rad), r.horizontal_components == 2
    with style.figure(8.0, 9.0, rows=5, sharex=True, height_ratios=[2, 2, 2, 2, 1]) as (fig, axes):
        for n in order:
            i = tracked[n]
            for k, ax in enumerate(axes[:3]):
                ax.plot(time, 1e3 * shift[:, i, k], label=names[n])
            axes[3].plot(time, 1e3 * np.linalg.norm(turn[:, i], axis=1))
        for axis, ax in zip("xyz", axes[:3], strict=True):
            ax.set_ylabel(f"{axis} [mm]")
        style.legend_above(axes[0])
        axes[3].set_ylabel("rotation [mrad]")
        axes[4].plot(time, run.array(name, "ground") / GRAVITY, color=style.EDGE, label="along")
        if both:
            axes[4].plot(time, run.array(name, "ground_across") / GRAVITY, color=style.THRUST, linewidth=0.8, label="across")
            axes[4].legend(loc="upper right", ncols=2, fontsize=8)
        axes[4].set_ylabel("ground [g]")
        axes[4].set_xlabel("time [s]")
        axes[4].set_xlim(0.0, float(time.max(initial=0.0)) or 1.0)
        saved = style.save(fig, folder, f"{name}-displacements")
    return saved, (
        f"Greatest displacements and rotations of blocks, measured from equilibrium under {loads}. "
        f"The ground moves along {r.direction_deg:g} degrees in plan{(' and at right angles to it' if both else '')}."
    )


def _contacts(run: Stored, name: str, folder: Path) -> tuple[str, str]:
    states = {"closed": "#f4f1ea", "open at\nsome corners": style.THRUST, "apart": style.HINGE}
    time, state = run.array(name, "time"), run.array(name, "state")
    return draw_states(time, state, states, 0, "contact", folder, f"{name}-contacts"), "State of the contacts over time."


def between(at: np.ndarray) -> np.ndarray:
    """Borders of cells about ascending places: halfway between them, the outermost as far beyond; half a unit about a single place."""
    half = 0.5 * np.diff(at) if len(at) > 1 else np.array([0.5])
    return np.concatenate([at[:1] - half[:1], at[:-1] + half, at[-1:] + half[-1:]])


def draw_states(time: np.ndarray, state: np.ndarray, states: dict[str, str], first: int, what: str, folder: Path, target: str) -> str:
    """States (times, joints) over time as a map into a file; `states` are their words and colours, from the number `first` on."""
    numbers = np.arange(first, first + len(states))
    with style.figure(8.0, min(7.0, 1.6 + 0.18 * state.shape[1])) as (fig, (ax,)):
        norm = BoundaryNorm([first - 0.5, *(numbers + 0.5)], len(states))
        colours, joints = ListedColormap(list(states.values())), np.arange(state.shape[1])
        mesh = ax.pcolormesh(between(time), between(joints), state.T, cmap=colours, norm=norm, rasterized=True)
        bar = fig.colorbar(mesh, ax=ax, ticks=numbers)
        bar.ax.set_yticklabels(list(states))
        style.numbers(ax.yaxis)
        if len(joints) == 1:
            ax.set_yticks(joints)
        ax.set_xlabel("time [s]")
        ax.set_ylabel(what)
        ax.grid(False)
        return style.save(fig, folder, target)


def _film(run: Stored, name: str, folder: Path) -> None:
    """The motion as a film, if the deck requests one."""
    kind, speed = film.asked(run, name)
    if kind == "none":
        return
    time = run.array(name, "time")
    frames, rate = film.pictures(time, kind, speed)
    stage = _Stage(run, name, frames.tolist(), FILM_PIXELS)
    width, height = (side / film.DPI for side in film.PIXELS)
    with style.figure(width, height) as (fig, (ax,)):
        stage.show(ax, int(frames[0]), None)
        if stage.share.any():
            legend(fig, [ax], stage.farthest)
        (drawn,), (lines,) = ax.images, (one for one in ax.collections if isinstance(one, LineCollection))
        title = ax.set_title(f"{time[frames[0]]:.2f} s")

        def show(k: int) -> None:
            drawn.set_data(stage.image(int(frames[k])))
            lines.set_segments(stage.lines(int(frames[k])))
            lines.set_color(stage.colours(int(frames[k])))
            title.set_text(f"{time[frames[k]]:.2f} s")

        path = folder / "figures" / f"{name}.{kind}"
        film.write(fig, path, kind, rate, np.arange(len(frames)), show, [drawn, lines, title])
