"""Films of what moves, 1280 x 720, from stored results: their pictures, their frame and the files."""

import contextlib
import io
import subprocess
import tempfile
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from PIL import Image

from extrados.results.store import Stored
from extrados.schema.programs import ffmpeg, film_command
from extrados.show import style
from extrados.show.stones import Stones, window

#: Pictures a second and the most of a film
RATES, MOST = {"gif": 15, "mp4": 30}, 600
#: Seconds that a film lasts at speed 1 where nothing has a time of its own
LASTS = 8.0
LONGEST_END = 300.0  # s: ffmpeg ends so long after its last picture, or hangs
PIXELS, DPI = (1280, 720), 100


def asked(run: Stored, name: str) -> tuple[str, float]:
    """The kind of film that the deck requests, "none", "gif" or "mp4", and its speed relative to real time."""
    index = [row["name"] for row in run.analyses].index(name)
    options = run.summary["deck"]["resolved"]["analysis"][index]
    return options.get("animation", "none"), float(options.get("animation_speed", 1.0))


def pictures(times: np.ndarray, kind: str, speed: float) -> tuple[np.ndarray, int]:
    """Which of the times are drawn, and how many a second: all the film's time, in no more pictures than can be drawn."""
    span = max(float(times[-1] - times[0]), 1e-12)
    step = max(speed / RATES[kind], span / MOST)
    at = np.arange(times[0], times[-1] + 0.5 * step, step)
    return np.searchsorted(times, at - 1e-12).clip(max=len(times) - 1), max(1, round(speed / step))


def clock(time: float, speed: float) -> str:
    """Time of a picture [s] in words, with the film's speed where that is not the real one."""
    return f"{time:.2f} s" + ("" if speed == 1.0 else f", played at {speed:g} times the real speed")


def write(fig: Figure, path: Path, kind: str, rate: int, frames: np.ndarray, draw: Callable[[int], Any], moving: Sequence[Artist]) -> None:
    """Draw pictures in turn and write them as a film: what moves anew in each, all else once."""
    fig.set_dpi(DPI)
    style.lay_out(fig)  # pictures must not wobble
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
    colours: Any = strip.getcolors(strip.width * strip.height)  # of three channels each
    counted = sorted(colours, reverse=True)[:64]
    spread = (strip.quantize(64, method=Image.Quantize.MAXCOVERAGE).getpalette() or [])[: 3 * 64]
    palette = Image.new("P", (1, 1))
    palette.putpalette([value for _, colour in counted for value in colour] + spread)
    first, *rest = [image.quantize(palette=palette, dither=Image.Dither.NONE) for image in images]
    out = io.BytesIO()
    first.save(out, "GIF", save_all=True, append_images=rest, duration=max(20, round(1000 / rate)), loop=0, optimize=False)
    return out.getvalue()


def _mp4(path: Path, drawn: Iterator[np.ndarray], rate: int) -> None:
    """Write pictures through ffmpeg; OSError with its message on failure."""
    with tempfile.TemporaryFile() as told:
        process = subprocess.Popen(
            film_command(ffmpeg() or "ffmpeg", ["-f", "rawvideo", "-pix_fmt", "rgb24", "-s", f"{PIXELS[0]}x{PIXELS[1]}"], rate, path),
            stdin=subprocess.PIPE,
            stdout=told,
            stderr=told,
        )
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


def axes(fig: Figure, rows: int) -> tuple[Axes, list[Axes]]:
    """The drawing on the left, `rows` charts on the right."""
    grid = fig.add_gridspec(rows, 2, width_ratios=[1.7, 1.0])
    charts: list[Axes] = []
    for k in range(rows):
        charts.append(fig.add_subplot(grid[k, 1], sharex=charts[0] if charts else None))
    return fig.add_subplot(grid[:, 0]), charts


def poses_window(ax: Axes, stones: Stones, poses: np.ndarray) -> None:
    """Limits for stones in all their poses, within reason: what falls leaves the picture."""
    still = np.concatenate(stones.outlines)
    size = float(np.ptp(still, axis=0).max())
    centre = poses[..., :2].reshape(-1, 2)
    near = centre[np.abs(centre - still.mean(axis=0)).max(axis=1) < 1.2 * size]
    half = max(float(np.ptp(o, axis=0).max()) for o in stones.outlines) / 2
    window(ax, np.concatenate([still, near - half, near + half]))


def history(ax: Axes, target: Path, time: np.ndarray, speed: float, show: Callable[[int], None], cursors: list, moving: list) -> None:
    """The film of a history beside its charts: `show` puts what moves, `moving`, to a step of time [s]; the cursors of
    the charts and a clock over `ax` go with it."""
    kind = target.suffix[1:]
    frames, rate = pictures(time, kind, speed)
    title = ax.set_title("0.00 s")

    def draw(k: int) -> None:
        show(k)
        for cursor in cursors:
            cursor.set_xdata([time[k], time[k]])
        title.set_text(clock(time[k], speed))

    write(style.whole_figure(ax), target, kind, rate, frames, draw, [*moving, *cursors, title])
