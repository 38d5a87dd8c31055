"""Film of the cracking of a wall."""

from pathlib import Path

import matplotlib
import numpy as np
from matplotlib.collections import LineCollection, PolyCollection

from extrados.results.store import Stored
from extrados.show import film, style
from extrados.show.cracked import CRACKS, at_points, polygons, scale
from extrados.show.stones import window

#: Greatest displacement in the drawing of a cracked wall, of its size
SHOWN = 0.06


def _told_states(run: Stored, name: str) -> np.ndarray:
    """The states of a film: those in equilibrium, as far as the envelope goes; beyond it a mechanism is on its way, whose
    displacements would hide all before. All of them where that leaves fewer than two."""
    events, envelope = run.array(name, "state_event"), np.abs(run.array(name, "envelope_displacement"))
    held = run.array(name, "event_state")[events - 1] > 0
    near = np.abs(run.array(name, "event_displacement")[events - 1]) <= 1.05 * envelope.max(initial=0.0)
    kept = np.flatnonzero(held & near)
    return kept if len(kept) > 1 else np.arange(len(events))


def film_sla(run: Stored, name: str, folder: Path) -> None:
    """The wall as it cracks from state to state, displacements enlarged, beside its load curve."""
    kind, speed = film.asked(run, name)
    if kind == "none" or "state_event" not in run.arrays[name]:
        return
    get = run.array
    kept = _told_states(run, name)
    xy, at = get(name, "node"), get(name, "point_xy")
    events, load, moved, angle = (get(name, f"state_{what}")[kept] for what in ("event", "load", "displacement", "angle"))
    widths = [get(name, f"state_width_{d}")[kept] for d in "ns"]
    reach = get(name, "point_reach") if "point_reach" in run.arrays[name] else get(name, "point_band")
    span = np.ptp(xy, axis=0)
    factor = scale(span, moved[-1], SHOWN)
    most = max(float(np.nanmax(w)) for w in widths) or 1e-9
    with style.canvas(film.PIXELS[0] / film.DPI, film.PIXELS[1] / film.DPI) as fig:
        ax, (curve,) = film.axes(fig, 1)
        wall = PolyCollection(polygons(run, name, xy), facecolors=style.STONE, edgecolors="#cfc6b4", linewidths=0.25)
        ax.add_collection(wall)
        cracks = [LineCollection([], cmap=CRACKS, norm=matplotlib.colors.Normalize(0.0, 1e3 * most), zorder=4) for _ in widths]
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
            wall.set_verts(polygons(run, name, xy + factor * moved[k]))
            place = at + factor * at_points(run, name, moved[k])
            for lines, width, turn in zip(cracks, (w[k] for w in widths), (0.5 * np.pi, 0.0), strict=True):
                open_ = width > max(1e-3 * most, 1e-9)
                along = angle[k][open_] + turn
                half = 0.42 * reach[open_][:, None] * np.column_stack([np.cos(along), np.sin(along)])
                lines.set_segments(list(np.stack([place[open_] - half, place[open_] + half], axis=1)))
                lines.set_array(1e3 * width[open_])
                lines.set_linewidth(0.5 + 2.5 * width[open_] / most)
            event = int(events[k])
            now.set_data([1e3 * d[event - 1]], [load[k] / 1e3])
            title.set_text(f"event {event}, {load[k] / 1e3:.4g} kN, displacements x {factor:g}")

        frames, rate = film.pictures(np.linspace(0.0, film.LASTS, len(events)), kind, speed)
        film.write(fig, folder / "figures" / f"{name}.{kind}", kind, rate, frames, draw, [wall, *cracks, now, title])
