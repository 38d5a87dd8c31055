"""Capacity curves of several analyses in one picture: walls in plane stress, buildings of shells, incremental solutions."""

import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
from matplotlib.lines import Line2D

from extrados.results import written
from extrados.results.sla import PREFIXES
from extrados.results.store import Stored, StoreError
from extrados.show import style

COLOURS = ("#b3261e", "#1f4e79", "#d9822b", "#3a7d44", "#7b2d8b", "#17808a", "#8a6d3b", "#5d7288")
#: Marks of an incremental solution stand apart by this part of the picture
MARKED = 0.03
#: Part of the base shear from which a wall of a building is marked
LEAST_SHARE = 0.05
#: Of the first sense of the load, and of the second
SENSES: dict[str, Literal["-", "--"]] = dict(zip(PREFIXES, ("-", "--"), strict=True))


@dataclass(frozen=True)
class Push:
    """A curve of one sense: displacements [m] and loads [N] of its envelope. analysis: what the picture calls it;
    incremental: by steps, not by events; weight: of what is pushed [N], None where the run does not say; walls: of a building,
    what each carries in its plane at the greatest load [N], by name."""

    analysis: str
    prefix: str
    sense: str
    displacement: np.ndarray
    load: np.ndarray
    incremental: bool
    weight: float | None
    walls: dict[str, float]

    def greatest(self) -> tuple[float, float]:
        """Greatest load [N] and its displacement [m]."""
        at = int(self.load.argmax())
        return float(self.load[at]), float(self.displacement[at])


def pushes(runs: list[tuple[str, Stored]]) -> list[Push]:
    """All load-displacement curves of some runs, with their names; StoreError names a run without any."""
    found = []
    last = [Path(title).name for title, _ in runs]
    for (title, run), short in zip(runs, last, strict=True):
        names = [name for name in run.arrays if "envelope_load" in run.arrays[name]]
        if not names:
            raise StoreError(f"{title}: the run has no analysis with a capacity curve; expected sla or pushover")
        for name in names:
            r: Any = run[name]  # of a wall, of a building or of a frame
            incremental = bool((run.array(name, "event_point") < 0).all())
            called = short if last.count(short) == 1 else title
            called = called if len(names) == 1 else f"{called}, {name}"
            for prefix in PREFIXES:
                if f"{prefix}envelope_load" not in run.arrays[name]:
                    continue
                d, p = (run.array(name, f"{prefix}envelope_{of}") for of in ("displacement", "load"))
                numbers = r.minus if prefix else r
                walls = {row.wall: row.shear_N for row in numbers.get("walls", []) if row.share > LEAST_SHARE}
                found.append(Push(called, prefix, numbers.sense, d, p, incremental, r.get("weight_N"), walls))
    return found


def draw(curves: list[Push], path: Path) -> Path:
    """Write PATH.png and PATH.svg; returns the path of the PNG. An analysis has a colour, a sense of its load a dash."""
    path = path.with_suffix("") if path.suffix in (".png", ".svg") else path
    pictures = f"{path.name}.png", f"{path.name}.svg"
    analyses = list(dict.fromkeys(curve.analysis for curve in curves))
    with style.figure(7.4, 4.6) as (fig, (ax,)):
        for curve in curves:
            ax.plot(
                1e3 * curve.displacement,
                curve.load / 1e3,
                SENSES[curve.prefix],
                linewidth=1.3,
                color=COLOURS[analyses.index(curve.analysis) % len(COLOURS)],
                marker="o" if curve.incremental else None,
                markersize=3,
                markevery=MARKED,
            )
            colour = COLOURS[analyses.index(curve.analysis) % len(COLOURS)]
            _, at = curve.greatest()
            for shear in curve.walls.values():
                ax.plot(1e3 * at, shear / 1e3, "+" if curve.prefix == PREFIXES[0] else "x", color=colour, markersize=7)
            style.letters(ax, np.array([(1e3 * at, v / 1e3) for v in curve.walls.values()]), list(curve.walls), colour)
        marks = [Line2D([], [], color=COLOURS[k % len(COLOURS)]) for k in range(len(analyses))]
        labels = list(analyses)
        for prefix, sense in dict.fromkeys((curve.prefix, curve.sense) for curve in curves):
            marks.append(Line2D([], [], color="#555", linestyle=SENSES[prefix]))
            labels.append(f"load to {sense}")
        if any(curve.incremental for curve in curves):
            marks.append(Line2D([], [], color="#555", marker="o", markersize=3))
            labels.append("incremental solution")
        if any(curve.walls for curve in curves):
            marks.append(Line2D([], [], color="#555", marker="+", markersize=7, linestyle=""))
            labels.append("walls of the building at its greatest load")
        ax.set_xlabel("control displacement [mm]")
        ax.set_ylabel("base shear [kN]" if all(curve.weight is not None for curve in curves) else "load [kN]")
        ax.set_xlim(left=min(0.0, *(1e3 * float(curve.displacement.min()) for curve in curves), 0.0))
        ax.set_ylim(bottom=0.0)
        ax.set_title("Capacity curves")
        fig.legend(marks, labels, loc="outside lower center", ncols=min(len(labels), 3))
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            with tempfile.TemporaryDirectory(prefix=f".{path.name}.", dir=path.parent) as scratch:
                style.write(fig, Path(scratch), path.name)
                with written.alone(path.parent):
                    names = written.put(Path(scratch), path.parent, lambda name: name in pictures)
        except OSError as error:
            raise StoreError(f"{path}.png: cannot be written: {error.strerror or error}") from None
    return path.parent / names.get(pictures[0], pictures[0])  # figures may be kept in memory
