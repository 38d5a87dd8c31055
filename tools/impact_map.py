"""Draw results/impact-map: c_v of arches by each impact rule over thickness and embrace, beside discrete elements.

`make impact-map`; some minutes. The arches are released from a tenth of their critical rotation as in
tests/verification/test_impact_map.py, whose docstring defines both measurements.
"""

import csv
import sys
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[1]
sys.path.insert(0, str(ROOT / "tests" / "verification"))

from test_impact_map import ARCHES, measured  # noqa: E402

from extrados.model.errors import NoView  # noqa: E402
from extrados.model.structures.arch import make_arch  # noqa: E402
from extrados.show import style  # noqa: E402
from extrados.views.rockers.arch import ArchModel  # noqa: E402

FOLDER = ROOT / "results" / "impact-map"
#: Axes of the maps
FINE_THICKNESSES, FINE_EMBRACES, VOUSSOIRS = np.linspace(0.07, 0.25, 37), np.linspace(120.0, 185.0, 53), 17
TITLES = {"thesis": "thesis (Eqs B.3)", "energy-safe": "energy-safe", "inelastic": "inelastic"}


def impacts(thickness: float, embrace: float) -> dict[str, float]:
    """c_v by each rule; NaN where the arch does not rock."""
    try:
        return ArchModel(make_arch(1.0, thickness, embrace, VOUSSOIRS)).impacts.by_rule
    except NoView:
        return dict.fromkeys(TITLES, np.nan)


def elements() -> list[dict[str, float]]:
    """c_v by each rule and as measured, of all arches."""
    rows = []
    for thickness, embrace in ARCHES:
        found = measured(thickness, embrace)
        place = {"thickness_ratio": thickness, "embrace_deg": embrace}
        rows.append({**place, **found.rules.by_rule, "swing": found.swing, "blow": found.blow})
        print("  ".join(f"{name} {value:.3f}" for name, value in rows[-1].items()), flush=True)
    return rows


def main() -> None:
    """The table as CSV, bias and scatter on the screen, the maps as PNG and SVG."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    rows = elements()
    with (FOLDER / "impact-map.csv").open("w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, fieldnames=list(rows[0]), lineterminator="\n")
        writer.writeheader()
        writer.writerows({k: f"{v:.4f}" for k, v in row.items()} for row in rows)
    x, y, blow = (np.array([row[k] for row in rows]) for k in ("embrace_deg", "thickness_ratio", "blow"))
    maps = [[impacts(t, e) for e in FINE_EMBRACES] for t in FINE_THICKNESSES]
    levels = np.linspace(0.0, 1.0, 11)
    with style.figure(11.0, 4.2, columns=3, sharey=True) as (fig, axes):
        for ax, (rule, title) in zip(axes, TITLES.items(), strict=True):
            error = np.clip([row[rule] for row in rows], 0.0, 1.0) - blow
            bias, rms = float(error.mean()), float(np.sqrt((error**2).mean()))
            print(f"{rule}: bias {bias:+.3f}, root mean square {rms:.3f}, greatest {np.abs(error).max():.3f}, {len(rows)} arches")
            c_v = np.array([[cell[rule] for cell in line] for line in maps])
            drawn = ax.contourf(FINE_EMBRACES, FINE_THICKNESSES, c_v, levels=levels, cmap="viridis", extend="both")
            ax.contour(FINE_EMBRACES, FINE_THICKNESSES, c_v, levels=[0.0, 1.0], colors="white", linewidths=1.2)
            ax.scatter(x, y, c=blow, cmap="viridis", vmin=0.0, vmax=1.0, edgecolors="white", s=55, linewidths=1.0, zorder=3)
            ax.set_title(f"{title}: bias {bias:+.2f}, rms {rms:.2f}")
            ax.set_xlabel("embrace [deg]")
            ax.set_facecolor(style.STONE)
            ax.grid(False)
        axes[0].set_ylabel("thickness over radius")
        fig.colorbar(drawn, ax=list(axes), label="c_v; circles: discrete elements")
        style.write(fig, FOLDER, "impact-map")
    print(f"Figure: {FOLDER / 'impact-map.png'}")


if __name__ == "__main__":
    main()
