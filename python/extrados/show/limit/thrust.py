"""Figures of thrust lines at a given acceleration: lines, force polygons, required friction."""

from pathlib import Path
from typing import Any

import numpy as np

from extrados.results.limit import Thrust
from extrados.results.solids import SolidThrust
from extrados.results.store import Stored
from extrados.show import style
from extrados.show.limit import section
from extrados.show.solids import draw_thrust
from extrados.show.stones import outlines


def draw(run: Stored, name: str, folder: Path) -> list[tuple[str, str]]:
    """The three lines and their force polygons; friction needed along the joints. Of solids the forces between blocks."""
    if isinstance(run[name], SolidThrust):
        return draw_thrust(run, name, folder)
    r = run.results_of(name, Thrust)
    blocks = outlines(run, name)
    colours = {"least": style.THRUST, "central": "#444444", "most": style.HINGE}
    lines_of = {which: line for which in colours if (line := getattr(r, which)) is not None}
    if not lines_of:  # a wall whose most central state did not settle
        return []
    colours = {which: colours[which] for which in lines_of}
    arched = r.chain is not None
    sizes: dict[str, Any] = {"columns": 2, "width_ratios": [1.4, 1]} if arched else {}
    with style.figure(12.0 if arched else 6.0, 4.6, **sizes) as (fig, (ax, *others)):
        section.earth(ax, run, name)
        section.stone(ax, blocks)
        section.ground(ax, run, name, [reaction.joint for reaction in (r.central or r.least).reactions])
        for which, colour in colours.items():
            label = f"{which}: {lines_of[which].told_kN_per_m(r.depth_m):.4g} kN/m" if arched else f"{which} state"
            section.thrust_lines(ax, run, name, which, colour, label)
        section.resting(ax, run, name, blocks)
        section.ties(ax, run, name, "central" if r.central is not None else "least")
        section.overall_dimensions(ax, blocks, section.beside(run, name, ax))
        style.legend_below(fig, ax)
        safety = r.geometric_safety_factor
        told = f", safety factor {safety:.2f}" if safety is not None and np.isfinite(safety) else ""
        ax.set_title(f"{'Thrust lines' if arched else 'Thrust line'} at {r['gamma_g']:g} g{told}")
        style.section_axes(ax)
        for forces in others:
            polygons = {which: section.paths(run, name, f"{which}_polygon")[r["chain"]] for which in colours}
            section.polygon(forces, polygons, tuple(colours.values()))
            forces.set_title(f"Force polygons of the {r['chain']}")
        caption = "Thrust lines of minimum, maximum and most central thrust, and their force polygons."
        if not arched:
            caption = "The most central thrust line through every stone. The width of the band shows the compressed zone."
        found = [(style.save(fig, folder, f"{name}-lines"), caption)]
    with style.figure(7.5, 3.4) as (fig, (ax,)):
        for which, colour in colours.items():
            ax.plot(run.array(name, f"{which}_friction"), color=colour, marker=".", markersize=3, label=which)
        ax.set_ylim(bottom=0.0)
        style.numbers(ax.xaxis)
        ax.set_xlabel("joint")
        ax.set_ylabel("required friction")
        ax.legend()
        found.append((style.save(fig, folder, f"{name}-friction"), "Coefficient of friction that each joint requires."))
    return found
