"""Collapse under self-weight: the blocks, and the collapse mechanism of the certificate."""

from pathlib import Path

import numpy as np

from extrados.results.store import Stored
from extrados.show import style
from extrados.show.limit import section
from extrados.show.stones import outlines

#: Greatest displacement that is drawn, over the size of the structure
SHOWN = 0.08


def draw_self_weight(run: Stored, name: str, folder: Path) -> list[tuple[str, str]]:
    """The blocks as drawn in the deck, and displaced along the collapse motion of the certificate."""
    blocks, centroid = outlines(run, name), run.array(name, "centroid")
    velocity = run.array(name, "collapse_velocity")
    corners = np.concatenate(blocks)
    size = float(np.ptp(corners, axis=0).max())
    speed = [
        np.hypot(v[0] - v[2] * (o - c)[:, 1], v[1] + v[2] * (o - c)[:, 0]).max() for o, c, v in zip(blocks, centroid, velocity, strict=True)
    ]
    step = SHOWN * size / max(speed)
    pose = np.column_stack([centroid + step * velocity[:, :2], step * velocity[:, 2]])
    fastest = int(np.argmax(speed))
    other = run[name].get("other_loads")
    title = f"Collapse mechanism under self-weight{f' and {other}' if other else ''}"
    with style.figure(7.2, 7.2 * min(1.2, max(0.35, np.ptp(corners[:, 1]) / np.ptp(corners[:, 0])))) as (fig, (ax,)):
        section.stone(ax, section.carried(blocks, centroid, pose))
        section.stone(ax, blocks, ghost=True)
        head = pose[fastest, :2]
        ax.annotate("", head, centroid[fastest], zorder=6, arrowprops={"arrowstyle": "-|>", "color": style.THRUST, "linewidth": 1.6})
        ax.set_title(title)
        style.section_axes(ax)
        style.save(fig, folder, f"{name}-self-weight")
    names = run.array(name, "block_name")
    return [
        (
            f"{name}-self-weight",
            f"{title}. The scale is arbitrary. In this mechanism the work of the loads is positive, and the joints dissipate nothing. "
            f"Dotted: geometry without displacements. The arrow marks the block with the greatest velocity, {names[fastest]}.",
        )
    ]
