"""Figure and table of the verification by displacement: capacity curve, bilinear curve, demand and capacity."""

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes

from extrados.results.model import Array
from extrados.results.store import Stored
from extrados.results.verification import IdealisedCurve, Verification
from extrados.schema.constants import GRAVITY
from extrados.show import style

#: Columns of the rows of a verification
COLUMNS = ("push", "limit state", "demand", "capacity", "q*", "factor", "PGA demand, capacity", "verdict")
WIDTHS = (1.7, 0.7, 0.9, 0.9, 0.9, 0.7, 1.5, 0.7)


def rows_of(found: Verification, most: int = 8) -> list[tuple[str, ...]]:
    """Demand and capacity of the checks, the least factor first."""
    ordered = sorted(found.checks, key=lambda c: np.inf if c.factor is None else c.factor)
    return [
        (
            c.push,
            c.limit_state,
            _millimetres(c.demand_m) if c.demand_pga_g is None or c.demand_m is not None else "beyond collapse",
            _millimetres(c.capacity_m),
            ""
            if c.strength_ratio is None
            else f"{c.strength_ratio:.3g}" + ("" if c.greatest_strength_ratio is None else f" ≤ {c.greatest_strength_ratio:g}"),
            "" if c.factor is None else f"{c.factor:.3g}",
            "" if c.capacity_pga_g is None else f"{c.demand_pga_g:.3g} g, {c.capacity_pga_g:.3g} g",
            c.verdict,
        )
        for c in ordered[:most]
    ]


def _millimetres(value: float | None) -> str:
    return "" if value is None else f"{1e3 * value:.3g} mm"


def draw_verification(run: Stored, name: str, folder: Path) -> list[tuple[str, str]]:
    """The governing curve with its idealisation, demands and capacities, and the same in the plane of spectral
    displacement and acceleration; nothing without a verification."""
    found: Verification | None = run[name].get("verification")
    if found is None or not found.curves:
        return []
    check = found.governing()
    k = next((i for i, c in enumerate(found.curves) if check is not None and c.push == check.push), 0)
    idea = found.curves[k]
    d, p = (run.series(name, f"verified_{what}")[k].numbers for what in ("displacement", "load"))
    spectra = run.series(name, "spectrum")
    law = (np.array([0.0, idea.yield_displacement_m, idea.ultimate_displacement_m]), np.array([0.0, 1.0, 1.0]) * idea.yield_load_N)
    with style.figure(9.6, 4.0, columns=2) as (fig, (left, right)):
        left.plot(1e3 * d, 1e-3 * p, color=style.THRUST, label=f"push {idea.push}")
        left.plot(1e3 * law[0], 1e-3 * law[1], color=style.EDGE, linestyle="--", label="bilinear curve of equal area")
        for row, shade in zip([c for c in found.checks if c.push == idea.push], STATES, strict=False):
            if row.demand_m is not None:
                left.axvline(1e3 * row.demand_m, color=shade, linewidth=1.0, label=f"demand at {row.limit_state}")
            if row.capacity_m is not None:
                left.axvline(1e3 * row.capacity_m, color=shade, linewidth=1.0, linestyle=":", label=f"capacity at {row.limit_state}")
        left.set_xlim(0.0, 1e3 * _furthest(found, idea))
        left.set_ylim(0.0, None)
        left.set_xlabel("control displacement [mm]")
        left.set_ylabel("base shear [kN]")
        _plane(right, run, name, found, idea, (d, p), law, spectra)
        rows = [c for c in found.checks if c.push == idea.push]
        if spectra:
            for row, shade in zip(rows, STATES, strict=False):
                if row.demand_m is not None:
                    at = row.demand_m
                    right.plot(1e3 * at / idea.participation_factor, np.interp(at, *law) / _weight(idea), "o", color=shade, markersize=5)
        style.legend_below(fig, left)
        saved = style.save(fig, folder, f"{name}-verification")
    return [
        (
            saved,
            f"Verification by displacement, {found.code}. Left: base shear over control displacement, bilinear curve, "
            f"demands and capacities. Right: the equivalent oscillator and the elastic spectra (dots: demands).",
        )
    ]


#: A colour for each limit state
STATES = ("#1f4e79", "#d98200", "#7b3fa0", "#3b7a57")


def _furthest(found: Verification, idea: IdealisedCurve) -> float:
    """Displacement up to which curve and demands are drawn [m]."""
    end = idea.ultimate_displacement_m
    demands = [c.demand_m for c in found.checks if c.push == idea.push and c.demand_m is not None]
    return 1.08 * max([end, *(min(d, 2.0 * end) for d in demands)])


def _weight(idea: IdealisedCurve) -> float:
    """Base shear over this is the acceleration of the oscillator [N/g]."""
    return idea.equivalent_mass_kg * idea.participation_factor * GRAVITY


def _plane(
    ax: Axes,
    run: Stored,
    name: str,
    found: Verification,
    idea: IdealisedCurve,
    curve: tuple[np.ndarray, np.ndarray],
    law: tuple[np.ndarray, np.ndarray],
    spectra: list[Array],
) -> None:
    """Curve, bilinear curve and spectra as acceleration over displacement of the oscillator."""
    gamma = idea.participation_factor
    ax.plot(1e3 * curve[0] / gamma, curve[1] / _weight(idea), color=style.THRUST)
    ax.plot(1e3 * law[0] / gamma, law[1] / _weight(idea), color=style.EDGE, linestyle="--")
    top = curve[1].max() / _weight(idea)
    if spectra:
        period = run.array(name, "spectrum_period")
        for one, shade in zip(spectra, STATES, strict=False):
            ax.plot(1e3 * one.numbers * (period / (2.0 * np.pi)) ** 2, one.numbers / GRAVITY, color=shade, linewidth=1.0)
            top = max(top, one.numbers.max() / GRAVITY)
    ax.set_xlim(0.0, 1e3 * _furthest(found, idea) / gamma)
    ax.set_ylim(0.0, 1.08 * top)
    ax.set_xlabel("spectral displacement d* [mm]")
    ax.set_ylabel("spectral acceleration [g]")
