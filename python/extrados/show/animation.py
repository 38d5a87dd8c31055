"""Films of what moves, 1280 x 720: rocking, tilt, supports that move, cracks, discrete elements; from stored results."""

import contextlib
import io
import subprocess
import tempfile
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import matplotlib
import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PolyCollection
from matplotlib.figure import Figure
from PIL import Image

from extrados.results.store import Stored
from extrados.schema.constants import GRAVITY
from extrados.schema.programs import ffmpeg
from extrados.show import style

#: Pictures a second and the most of a film
RATES, MOST = {"gif": 15, "mp4": 30}, 600
#: Seconds that a film lasts at speed 1 where nothing has a time of its own
LASTS = 8.0
LONGEST_END = 300.0  # s: ffmpeg ends so long after its last picture, or hangs
PIXELS, DPI = (1280, 720), 100
#: Greatest displacement in the drawing of a cracked wall, of its size
SHOWN = 0.06


def asked(run: Stored, name: str) -> tuple[str, float]:
    """The kind of film that the deck asks for, "none", "gif" or "mp4", and its speed over real time."""
    index = [row["name"] for row in run.analyses].index(name)
    options = run.summary["deck"]["resolved"]["analysis"][index]
    return options.get("animation", "none"), float(options.get("animation_speed", 1.0))


def pictures(times: np.ndarray, kind: str, speed: float) -> tuple[np.ndarray, int]:
    """Which of the times are drawn, and how many a second: all the film's time, in no more pictures than can be drawn."""
    span = max(float(times[-1] - times[0]), 1e-12)
    step = max(speed / RATES[kind], span / MOST)
    at = np.arange(times[0], times[-1] + 0.5 * step, step)
    return np.searchsorted(times, at - 1e-12).clip(max=len(times) - 1), max(1, round(speed / step))


def _clock(time: float, speed: float) -> str:
    """Time of a picture [s] in words, with the film's speed where that is not the real one."""
    return f"{time:.2f} s" + ("" if speed == 1.0 else f", at {speed:g} of real time")


def write(
    fig: Figure,
    path: Path,
    kind: str,
    rate: int,
    frames: np.ndarray,
    draw: Callable[[int], Any],
    moving: Sequence[Artist],
) -> None:
    """Draw pictures in turn and write them as a film: what moves anew in each, all else once."""
    fig.set_dpi(DPI)
    fig.get_layout_engine().execute(fig)
    fig.set_layout_engine("none")  # pictures must not wobble
    for artist in moving:
        artist.set_animated(True)
    canvas: Any = fig.canvas
    canvas.draw()
    background = canvas.copy_from_bbox(fig.bbox)

    def drawn() -> Iterator[np.ndarray]:
        for k in frames.tolist():
            canvas.restore_region(background)
            draw(k)
            for artist in moving:
                artist.draw(canvas.get_renderer())
            yield np.ascontiguousarray(np.asarray(canvas.buffer_rgba())[..., :3])

    path.parent.mkdir(exist_ok=True)
    if kind == "gif":
        path.write_bytes(gif([Image.fromarray(picture) for picture in drawn()], rate))
    else:
        _mp4(path, drawn(), rate)


def gif(images: list[Image.Image], rate: int) -> bytes:
    """Images as a film that begins again. One palette for all, or their colours would flicker: that of some side by side."""
    width, height = (side // 2 + 1 for side in images[0].size)
    some = images[:: max(1, len(images) // 6)]
    strip = Image.new("RGB", (width, height * len(some)))
    for k, image in enumerate(some):
        strip.paste(image.reduce(2), (0, k * height))
    # half for what covers most, exactly; half for all colours that there are, or thin lines would lose theirs
    counted = sorted(strip.getcolors(strip.width * strip.height), reverse=True)[:64]
    spread = strip.quantize(64, method=Image.Quantize.MAXCOVERAGE).getpalette()[: 3 * 64]
    palette = Image.new("P", (1, 1))
    palette.putpalette([value for _, colour in counted for value in colour] + spread)
    first, *rest = [image.quantize(palette=palette, dither=Image.Dither.NONE) for image in images]
    out = io.BytesIO()
    first.save(
        out, "GIF", save_all=True, append_images=rest, duration=max(20, round(1000 / rate)), loop=0, optimize=False
    )
    return out.getvalue()


def _mp4(path: Path, drawn: Iterator[np.ndarray], rate: int) -> None:
    """Pictures through ffmpeg; OSError with its words where it fails."""
    with tempfile.TemporaryFile() as told:
        process = subprocess.Popen(
            [
                ffmpeg() or "ffmpeg", "-y", "-loglevel", "error", "-f", "rawvideo", "-pix_fmt", "rgb24",
                "-s", f"{PIXELS[0]}x{PIXELS[1]}", "-framerate", str(rate), "-i", "-", "-c:v", "libx264", "-pix_fmt", "yuv420p",
                "-crf", "20", "-movflags", "+faststart", str(path),
            ],
            stdin=subprocess.PIPE, stdout=told, stderr=told,
        )  # fmt: skip
        assert process.stdin is not None
        try:
            with contextlib.suppress(BrokenPipeError):  # it says why
                for picture in drawn:
                    process.stdin.write(picture.tobytes())
                process.stdin.close()
            process.wait(LONGEST_END)
        except subprocess.TimeoutExpired:
            raise OSError(f"ffmpeg did not finish {path.name} within {LONGEST_END:g} s") from None
        finally:
            process.kill()
            process.wait()
        if process.returncode:
            told.seek(0)
            raise OSError(f"ffmpeg could not write {path.name}: {told.read().decode(errors='replace')[-300:]}")


class Stones:
    """Stones of an analysis in some axes, which take poses."""

    def __init__(self, run: Stored, name: str, ax: Axes):
        from extrados.show.arch import outlines

        self.outlines, self.centroid = outlines(run, name), run.array(name, "centroid")
        self.drawn = PolyCollection(
            self.outlines, facecolors=style.STONE, edgecolors=style.EDGE, linewidths=0.7, zorder=2
        )
        ax.add_collection(
            PolyCollection(self.outlines, facecolors="none", edgecolors="#cccccc", linewidths=0.5, zorder=1)
        )
        ax.add_collection(self.drawn)

    def place(self, pose: np.ndarray, turn: float = 0.0) -> None:
        """Put the stones into poses (blocks, 3), all of it turned by an angle [rad] about the origin."""
        from extrados.show.arch import moved

        shapes = [moved(o, c, p) for o, c, p in zip(self.outlines, self.centroid, pose, strict=True)]
        self.drawn.set_verts([turned(s, turn) for s in shapes] if turn else shapes)


def turned(points: np.ndarray, angle: float) -> np.ndarray:
    """Points turned counter-clockwise about the origin [rad]."""
    c, s = np.cos(angle), np.sin(angle)
    return points @ np.array([[c, s], [-s, c]])


def window(ax: Axes, points: np.ndarray, room: float = 0.06) -> None:
    """Limits that hold all points, the same in all pictures."""
    points = points[np.isfinite(points).all(axis=1)]
    low, high = points.min(axis=0), points.max(axis=0)
    more = room * float((high - low).max())
    ax.set_xlim(low[0] - more, high[0] + more)
    ax.set_ylim(low[1] - more, high[1] + more)
    style.section_axes(ax)


def _axes(fig: Figure, rows: int) -> tuple[Axes, list[Axes]]:
    """The drawing on the left, `rows` charts on the right."""
    grid = fig.add_gridspec(rows, 2, width_ratios=[1.7, 1.0])
    charts: list[Axes] = []
    for k in range(rows):
        charts.append(fig.add_subplot(grid[k, 1], sharex=charts[0] if charts else None))
    return fig.add_subplot(grid[:, 0]), charts


def _poses_window(ax: Axes, stones: Stones, poses: np.ndarray) -> None:
    """Limits for stones in all their poses, within reason: what falls leaves the picture."""
    still = np.concatenate(stones.outlines)
    size = float(np.ptp(still, axis=0).max())
    centre = poses[..., :2].reshape(-1, 2)
    near = centre[np.abs(centre - still.mean(axis=0)).max(axis=1) < 1.2 * size]
    half = max(float(np.ptp(o, axis=0).max()) for o in stones.outlines) / 2
    window(ax, np.concatenate([still, near - half, near + half]))


def draw_rocking(run: Stored, name: str, folder: Path) -> None:
    """The stones as they rock, with the line of thrust, beside ground motion and rotation."""
    kind, speed = asked(run, name)
    if kind == "none" or "film_time" not in run.arrays[name]:
        return
    time, pose = run.array(name, "film_time"), run.array(name, "film_pose")
    line = run.arrays[name].get("film_line")
    history = run.array(name, "time")
    with style.canvas(PIXELS[0] / DPI, PIXELS[1] / DPI) as fig:
        ax, (ground, rotation) = _axes(fig, 2)
        stones = Stones(run, name, ax)
        _poses_window(ax, stones, pose)
        (thrust,) = ax.plot([], [], color=style.THRUST, linewidth=1.6, zorder=4, label="line of thrust")
        if line is not None:
            ax.legend(loc="upper right")
        ground.plot(history, run.array(name, "ground") / GRAVITY, color=style.GROUND, linewidth=0.8)
        ground.set_ylabel("ground [g]")
        upper = "rotation_upper" in run.arrays[name]  # of two stacked blocks
        rotation.plot(
            history,
            1e3 * run.array(name, "rotation"),
            color=style.HINGE,
            linewidth=1.0,
            label="lower block" if upper else None,
        )
        if upper:
            rotation.plot(
                history,
                1e3 * run.array(name, "rotation_upper"),
                "--",
                color=style.GROUND,
                linewidth=1.0,
                label="upper block",
            )
            rotation.legend()
        rotation.set_ylabel("rotation [mrad], + to +x")
        rotation.set_xlabel("time [s]")
        rotation.set_xlim(0.0, float(time[-1]))
        cursors = [a.axvline(0.0, color=style.THRUST, linewidth=1.0) for a in (ground, rotation)]

        def show(k: int) -> None:
            stones.place(pose[k])
            if line is not None:
                thrust.set_data(*line.data[k].T)

        _history(ax, folder / "figures" / f"{name}.{kind}", time, speed, show, cursors, [stones.drawn, thrust])


def _history(
    ax: Axes, target: Path, time: np.ndarray, speed: float, show: Callable[[int], None], cursors: list, moving: list
) -> None:
    """The film of a history beside its charts: `show` puts what moves, `moving`, to a step of time [s]; the cursors of
    the charts and a clock over `ax` go with it."""
    kind = target.suffix[1:]
    frames, rate = pictures(time, kind, speed)
    title = ax.set_title("0.00 s")

    def draw(k: int) -> None:
        show(k)
        for cursor in cursors:
            cursor.set_xdata([time[k], time[k]])
        title.set_text(_clock(time[k], speed))

    write(ax.get_figure(), target, kind, rate, frames, draw, [*moving, *cursors, title])


def draw_tilt(run: Stored, name: str, folder: Path) -> None:
    """The ground is tilted until the lines of least and greatest thrust are one; then the mechanism moves."""
    kind, speed = asked(run, name)
    if kind == "none" or "mechanism_pose" not in run.arrays[name]:
        return
    arrays = run.arrays[name]
    centroid = run.array(name, "centroid")
    rest = np.column_stack([centroid, np.zeros(len(centroid))])
    falls = run.array(name, "mechanism_pose")
    last = np.radians(run[name].tilt_angle_deg)
    lines = "film_tilt" in arrays
    tilt = np.radians(run.array(name, "film_tilt")) if lines else np.linspace(0.0, last, 40)
    moves = len(tilt) // 2
    with style.canvas(PIXELS[0] / DPI, PIXELS[1] / DPI) as fig:
        ax, charts = _axes(fig, 1)
        stones = Stones(run, name, ax)
        corners = np.concatenate(stones.outlines)
        far = [turned(corners, -a) for a in (0.0, last)]
        window(ax, np.concatenate(far))
        drawn = {
            word: ax.plot([], [], style_of, color=colour, linewidth=1.6, zorder=4, label=f"{word} thrust")[0]
            for word, style_of, colour in (("least", "--", style.HINGE), ("greatest", ":", style.GROUND))
        }
        base = np.array([corners.min(axis=0), [corners[:, 0].max(), corners[:, 1].min()]])
        (ground,) = ax.plot(*base.T, color="#777777", linewidth=1.0)
        chart = charts[0]
        if lines:
            ax.legend(loc="upper right")
            for word, key_of, style_of, colour in (
                ("least", "film_thrust_min", "--", style.HINGE),
                ("greatest", "film_thrust_max", ":", style.GROUND),
            ):
                chart.plot(
                    np.degrees(tilt), run.array(name, key_of) / 1e3, style_of, color=colour, label=f"{word} thrust"
                )
            chart.set_ylabel("horizontal thrust [kN]")
            chart.legend()
        else:
            chart.plot(np.degrees(tilt), np.tan(tilt), color=style.HINGE)
            chart.set_ylabel("horizontal acceleration [g]")
        chart.set_xlabel("tilt [degrees]")
        cursor = chart.axvline(0.0, color=style.THRUST, linewidth=1.0)
        title = ax.set_title("")

        def draw(k: int) -> None:
            angle = tilt[min(k, len(tilt) - 1)]
            share = max(0.0, (k - len(tilt) + 1) / moves)
            stones.place(rest + share * (falls - rest), -angle)
            ground.set_data(*turned(base, -angle).T)
            for word, key_of in (("least", "film_least"), ("greatest", "film_most")) if lines else ():
                points = run.array(name, key_of)[min(k, len(tilt) - 1)]
                drawn[word].set_data(*(turned(points, -angle).T if share == 0.0 else np.empty((2, 0))))
            cursor.set_xdata([np.degrees(angle)] * 2)
            title.set_text(
                f"ground tilted by {np.degrees(angle):.2f} degrees, as {np.tan(angle):.4f} g to the side"
                + (": it comes down" if share else "")
            )

        count = len(tilt) + moves
        time = np.linspace(0.0, LASTS, count)
        frames, rate = pictures(time, kind, speed)
        write(
            fig,
            folder / "figures" / f"{name}.{kind}",
            kind,
            rate,
            frames,
            draw,
            [ground, stones.drawn, *drawn.values(), cursor, title],
        )


def draw_supports(run: Stored, name: str, folder: Path) -> None:
    """The arch follows the movement of its support, with its line of thrust, beside the thrust."""
    kind, speed = asked(run, name)
    arrays = run.arrays[name]
    if kind == "none":
        return
    follows = "film_movement" in arrays
    if follows:
        movement, pose = 1e3 * run.array(name, "film_movement"), run.array(name, "film_pose")
    else:
        centroid = run.array(name, "centroid")
        rest = np.column_stack([centroid, np.zeros(len(centroid))])
        share = np.linspace(0.0, 1.0, 60)
        movement, pose = 100.0 * share, rest + share[:, None, None] * (run.array(name, "settled_pose") - rest)
    with style.canvas(PIXELS[0] / DPI, PIXELS[1] / DPI) as fig:
        ax, charts = _axes(fig, 1)
        stones = Stones(run, name, ax)
        _poses_window(ax, stones, pose)
        (thrust,) = ax.plot([], [], color=style.THRUST, linewidth=1.6, zorder=4, label="line of thrust")
        if follows:
            ax.legend(loc="upper right")
        if follows:
            x, y = 1e3 * run.array(name, "movement"), run.array(name, "force")[:, 0] / 1e3
            charts[0].set_xlabel("movement of the support [mm]")
            charts[0].set_ylabel("thrust [kN]")
        else:
            opening = run.array(name, "settled_opening")[:, :2].max(axis=1)
            x, y = movement, movement / 100.0 * 1e3 * float(opening.max())
            charts[0].set_xlabel("share of the movement [%]")
            charts[0].set_ylabel("widest joint [mm]")
        charts[0].plot(x, y, color=style.HINGE)
        cursor = charts[0].axvline(0.0, color=style.THRUST, linewidth=1.0)
        title = ax.set_title("")

        def draw(k: int) -> None:
            stones.place(pose[k])
            if follows:
                thrust.set_data(*run.array(name, "film_line")[k].T)
            cursor.set_xdata([movement[k], movement[k]])
            title.set_text(
                f"support moved by {movement[k]:.1f} mm" if follows else f"{movement[k]:.0f} % of the movement"
            )

        frames, rate = pictures(np.linspace(0.0, LASTS, len(movement)), kind, speed)
        write(
            fig, folder / "figures" / f"{name}.{kind}", kind, rate, frames, draw, [stones.drawn, thrust, cursor, title]
        )


def _told_states(run: Stored, name: str) -> np.ndarray:
    """The states of a film: those in equilibrium, as far as the envelope goes; beyond it a mechanism is on its way, whose
    displacements would hide all before. All of them where that leaves fewer than two."""
    events, envelope = run.array(name, "state_event"), np.abs(run.array(name, "envelope_displacement"))
    held = run.array(name, "event_state")[events - 1] > 0
    near = np.abs(run.array(name, "event_displacement")[events - 1]) <= 1.05 * envelope.max(initial=0.0)
    kept = np.flatnonzero(held & near)
    return kept if len(kept) > 1 else np.arange(len(events))


def draw_sla(run: Stored, name: str, folder: Path) -> None:
    """The wall as it cracks from state to state, displacements enlarged, beside its load curve."""
    from extrados.show import sla

    kind, speed = asked(run, name)
    if kind == "none" or "state_event" not in run.arrays[name]:
        return
    get = run.array
    kept = _told_states(run, name)
    xy, at = get(name, "node"), get(name, "point_xy")
    events, load, moved, angle = (
        get(name, f"state_{what}")[kept] for what in ("event", "load", "displacement", "angle")
    )
    widths = [get(name, f"state_width_{d}")[kept] for d in "ns"]
    reach = get(name, "point_reach") if "point_reach" in run.arrays[name] else get(name, "point_band")
    span = np.ptp(xy, axis=0)
    factor = sla._scale(span, moved[-1], SHOWN)
    most = max(float(np.nanmax(w)) for w in widths) or 1e-9
    with style.canvas(PIXELS[0] / DPI, PIXELS[1] / DPI) as fig:
        ax, (curve,) = _axes(fig, 1)
        wall = PolyCollection(
            sla._polygons(run, name, xy), facecolors=style.STONE, edgecolors="#cfc6b4", linewidths=0.25
        )
        ax.add_collection(wall)
        cracks = [
            LineCollection([], cmap=sla.CRACKS, norm=matplotlib.colors.Normalize(0.0, 1e3 * most), zorder=4)
            for _ in widths
        ]
        for lines in cracks:
            ax.add_collection(lines)
        window(ax, np.concatenate([xy, *(xy + factor * u for u in moved)]))
        fig.colorbar(cracks[0], ax=ax, shrink=0.6, label="crack width [mm]")
        d, p = get(name, "event_displacement"), get(name, "event_load")
        fine = get(name, "event_state") > 0
        curve.plot(1e3 * d[fine], p[fine] / 1e3, color=style.THRUST, linewidth=0.25, alpha=0.5)
        curve.plot(1e3 * get(name, "envelope_displacement"), get(name, "envelope_load") / 1e3, color=style.THRUST)
        shown = 1e3 * np.concatenate([get(name, "envelope_displacement"), d[events - 1]])
        room = 0.05 * max(float(np.ptp(shown)), 1e-9)
        curve.set_xlim(shown.min() - room, shown.max() + room)
        (now,) = curve.plot([], [], "o", color=style.HINGE, markersize=8, markerfacecolor="white", markeredgewidth=2)
        curve.set_xlabel("control displacement [mm]")
        curve.set_ylabel("load [kN]")
        title = ax.set_title("")

        def draw(k: int) -> None:
            wall.set_verts(sla._polygons(run, name, xy + factor * moved[k]))
            place = at + factor * sla._at_points(run, name, moved[k])
            for lines, width, turn in zip(cracks, (w[k] for w in widths), (0.5 * np.pi, 0.0), strict=True):
                open_ = width > max(1e-3 * most, 1e-9)
                along = angle[k][open_] + turn
                half = 0.42 * reach[open_][:, None] * np.column_stack([np.cos(along), np.sin(along)])
                lines.set_segments(np.stack([place[open_] - half, place[open_] + half], axis=1))
                lines.set_array(1e3 * width[open_])
                lines.set_linewidths(0.5 + 2.5 * width[open_] / most)
            event = int(events[k])
            now.set_data([1e3 * d[event - 1]], [load[k] / 1e3])
            title.set_text(f"event {event}, {load[k] / 1e3:.4g} kN, displacements x {factor:g}")

        frames, rate = pictures(np.linspace(0.0, LASTS, len(events)), kind, speed)
        write(fig, folder / "figures" / f"{name}.{kind}", kind, rate, frames, draw, [wall, *cracks, now, title])


def draw_dem(run: Stored, name: str, folder: Path) -> None:
    """Blocks as they rock, hinge, slide and fall, beside ground motion and rotations."""
    kind, speed = asked(run, name)
    if kind == "none" or "rotation" not in run.arrays[name]:
        return
    from extrados.show.dem import SHOWN as FOLLOWED
    from extrados.show.dem import Scene

    time, rotation = run.array(name, "time"), run.array(name, "rotation")
    frames, _ = pictures(time, kind, speed)
    scene = Scene(run, name, frames.tolist())
    tracked = run.array(name, "tracked")
    most = tracked[np.argsort(-np.abs(rotation[:, tracked]).max(axis=0), kind="stable")[:FOLLOWED]]
    label = dict(zip(tracked.tolist(), run[name].peak_rotation_rad, strict=True))
    with style.canvas(PIXELS[0] / DPI, PIXELS[1] / DPI) as fig:
        ax, (ground, turn) = _axes(fig, 2)
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
        left, right, bottom, top = scene.window
        ax.set_xlim(left, right)
        ax.set_ylim(bottom, top)
        style.section_axes(ax)

        def show(k: int) -> None:
            stones.place(scene.place[k])
            hinges.set_data(*scene.hinges(k).T)

        _history(ax, folder / "figures" / f"{name}.{kind}", time, speed, show, cursors, [stones.drawn, hinges])
