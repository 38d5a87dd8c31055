"""Pictures of solids: parallel projection, hidden parts by a depth buffer, edges at the borders of faces.

A depth buffer draws any bodies correctly, also if they intersect, and requires no graphics card or window system.
"""

from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import to_rgb

from extrados.show import style

FINE = 2  # pixels of the buffer along a pixel of the picture
PIXELS = 900  # of the longer side of a picture
LIGHT = np.array([-0.35, -0.75, 1.0]) / np.linalg.norm([-0.35, -0.75, 1.0])
DARKEST = 0.55  # of a colour, on a face that the light does not reach
ROOM = 0.04  # of the picture, around the solids
NARROW = 6.0  # lengths of an axis of the compass that a picture is wide at least


@dataclass(frozen=True)
class View:
    """Direction of view [deg]: azimuth of the eye in plan from +x to +y, and its elevation."""

    azimuth: float = -60.0
    elevation: float = 25.0

    @property
    def axes(self) -> np.ndarray:
        """Unit vectors (3, 3) to the right, up, and towards the eye."""
        a, e = np.radians([self.azimuth, self.elevation])
        eye = np.array([np.cos(e) * np.cos(a), np.cos(e) * np.sin(a), np.sin(e)])
        right = np.array([-np.sin(a), np.cos(a), 0.0])
        return np.array([right, np.cross(eye, right), eye])


@dataclass(frozen=True)
class Faces:
    """Faces of solids as pictures take them: vertices (nv, 3) [m], faces as numbers of them, the stone of each face."""

    vertices: np.ndarray
    faces: list[np.ndarray]
    block: np.ndarray


def frame_of(points: np.ndarray, view: View) -> tuple[float, float, float, float]:
    """Left, right, low and high ends in the picture [m] that hold points (n, 3), with some room."""
    flat = points @ view.axes[:2].T
    low, high = flat.min(axis=0), flat.max(axis=0)
    room = ROOM * float((high - low).max())
    return low[0] - room, high[0] + room, low[1] - room, high[1] + room


def picture(solids: Faces, view: View, frame: tuple[float, float, float, float], colours: np.ndarray, pixels: int = PIXELS) -> np.ndarray:
    """An image (height, width, 4) of solids within a frame [m]; colours (stones, 3) between 0 and 1, transparent around."""
    left, right, low, high = frame
    scale = FINE * pixels / max(right - left, high - low)
    width, height = (max(2, round(scale * side / FINE) * FINE) for side in (right - left, high - low))
    projected = solids.vertices @ view.axes.T
    x, y = (projected[:, 0] - left) * scale - 0.5, (projected[:, 1] - low) * scale - 0.5
    depth, number = np.full((height, width), -np.inf), np.full((height, width), -1)
    shade = np.zeros((len(solids.faces), 3))
    for k, face in enumerate(solids.faces):
        _fill(k, x[face], y[face], projected[face, 2], depth, number)
        shade[k] = colours[solids.block[k]] * _lit(solids.vertices[face])
    image = np.zeros((height, width, 4))
    seen = number >= 0
    image[seen, :3], image[seen, 3] = shade[number[seen]], 1.0
    edge = np.zeros((height, width), dtype=bool)
    for one, two in (((slice(1, None),), (slice(None, -1),)), ((slice(None), slice(1, None)), (slice(None), slice(None, -1)))):
        edge[one] |= number[one] != number[two]
    image[edge] = (*to_rgb(style.EDGE), 1.0)
    small = image.reshape(height // FINE, FINE, width // FINE, FINE, 4)
    alpha = small[..., 3].mean(axis=(1, 3))
    rgb = (small[..., :3] * small[..., 3:]).mean(axis=(1, 3)) / np.maximum(alpha, 1e-9)[..., None]
    return np.concatenate([rgb, alpha[..., None]], axis=2)[::-1]


def _lit(points: np.ndarray) -> float:
    """How bright a face is."""
    arm = points - points[0]
    normal = np.cross(arm[:-1], arm[1:]).sum(axis=0)
    length = float(np.linalg.norm(normal))
    return 1.0 if length == 0.0 else DARKEST + (1.0 - DARKEST) * max(0.0, float(normal @ LIGHT) / length)


def _fill(k: int, x: np.ndarray, y: np.ndarray, z: np.ndarray, depth: np.ndarray, number: np.ndarray) -> None:
    """Draw a convex face, counter-clockwise where it is seen, where it is nearest to the eye."""
    turned = float(x[:-1] @ y[1:] - x[1:] @ y[:-1] + x[-1] * y[0] - x[0] * y[-1])
    if turned <= 0.0:
        return  # it looks away
    height, width = depth.shape
    first, last = max(0, int(np.ceil(x.min()))), min(width - 1, int(x.max()))
    below, above = max(0, int(np.ceil(y.min()))), min(height - 1, int(y.max()))
    if first > last or below > above:
        return
    px, py = np.arange(first, last + 1)[None, :], np.arange(below, above + 1)[:, None]
    inside = np.ones((above - below + 1, last - first + 1), dtype=bool)
    for (ax, ay), (bx, by) in zip(zip(x, y, strict=True), zip(np.roll(x, -1), np.roll(y, -1), strict=True), strict=True):
        inside &= (bx - ax) * (py - ay) - (by - ay) * (px - ax) >= 0.0
    plane, *_ = np.linalg.lstsq(np.column_stack([x, y, np.ones(len(x))]), z, rcond=None)
    here = plane[0] * px + plane[1] * py + plane[2]
    rows, columns = slice(below, above + 1), slice(first, last + 1)
    nearer = inside & (here > depth[rows, columns])
    depth[rows, columns][nearer] = here[nearer]
    number[rows, columns][nearer] = k


def show(ax: Axes, image: np.ndarray, frame: tuple[float, float, float, float]) -> None:
    """Put an image into axes whose data are metres in the picture."""
    ax.imshow(image, extent=frame, interpolation="antialiased", zorder=2)
    ax.set_xlim(frame[:2])
    ax.set_ylim(frame[2:])
    ax.set_aspect("equal")
    ax.axis("off")


def ground(ax: Axes, points: np.ndarray, view: View) -> None:
    """The level ground under points (n, 3), as a sheet somewhat larger than their plan."""
    low, high = points.min(axis=0), points.max(axis=0)
    room = 0.06 * float((high - low).max())
    (x0, y0), (x1, y1) = low[:2] - room, high[:2] + room
    corners = np.array([[x0, y0, low[2]], [x1, y0, low[2]], [x1, y1, low[2]], [x0, y1, low[2]]]) @ view.axes[:2].T
    ax.fill(*corners.T, facecolor="#f2efe8", edgecolor="#d8d2c4", linewidth=0.6, zorder=1)


def compass(ax: Axes, view: View, push: float | None = None) -> None:
    """The axes x, y, z, the scale, and the direction of the load [deg in plan], below the solids."""
    left, right, low, high = (*ax.get_xlim(), *ax.get_ylim())
    size = 0.09 * max(right - left, high - low)
    if right - left < NARROW * size:  # of a tall picture: axes and scale stand side by side
        middle = 0.5 * (left + right)
        left, right = middle - 0.5 * NARROW * size, middle + 0.5 * NARROW * size
        ax.set_xlim(left, right)
    below = low - 1.5 * size
    ax.set_ylim(below - 1.2 * size, high)
    origin = np.array([left + 1.5 * size, below])
    for name, arrow in zip("xyz", np.eye(3) @ view.axes[:2].T, strict=True):
        tip = origin + size * arrow
        ax.annotate(
            "",
            style.pair(tip),
            style.pair(origin),
            arrowprops={"arrowstyle": "-|>", "color": style.EDGE, "shrinkA": 0, "shrinkB": 0, "linewidth": 0.9},
        )
        ax.text(*style.pair(origin + 1.3 * size * arrow), name, ha="center", va="center", fontsize=8, color=style.EDGE)
    if push is not None:
        turn = np.radians(push)
        arrow = view.axes[:2] @ np.array([np.cos(turn), np.sin(turn), 0.0])
        start = np.array([0.5 * (left + right), below])
        ax.annotate(
            "",
            style.pair(start + 2.2 * size * arrow),
            style.pair(start),
            zorder=4,
            arrowprops={"arrowstyle": "-|>", "color": style.THRUST, "shrinkA": 0, "shrinkB": 0, "linewidth": 2.0, "mutation_scale": 14},
        )
        ax.text(*style.pair(start - np.array([0.3 * size, 0.0])), "push", ha="right", va="center", fontsize=8, color=style.THRUST)
    length = _round(0.22 * (right - left))
    end = np.array([right - 0.5 * size, below - 0.2 * size])
    ax.plot([end[0] - length, end[0]], [end[1]] * 2, color="black", linewidth=1.6, solid_capstyle="butt")
    ax.text(end[0] - 0.5 * length, end[1] + 0.15 * size, f"{length:g} m", ha="center", va="bottom", fontsize=8)


def _round(length: float) -> float:
    """The next round number below: 1, 2 or 5 times a power of ten."""
    power = 10.0 ** np.floor(np.log10(length))
    return float(power * max(n for n in (1, 2, 5) if n * power <= length * (1 + 1e-12)))
