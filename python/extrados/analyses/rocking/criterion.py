"""The assessment criterion of arches: A_p/g = C1 (T_p/sqrt(R) - T_min)^C2 + gamma (thesis Eqs 5.5 and 5.8).

Table 5.3 regenerated: for each t/R and embrace the Mode I curve of a single sine is computed at R = 1 m with
embrace/5 voussoirs and fitted. `python -m extrados.analyses.rocking.criterion` (or `make table-5-3`) writes it anew;
with the name of another impact rule (`make table-5-3 RULE=inelastic`) it prints the table by that rule.
"""

import csv
import sys
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from importlib.resources import files

import numpy as np

from extrados.analyses.batches import computed
from extrados.analyses.context import Context
from extrados.analyses.rocking.failure_domain import LowestAmplitudes
from extrados.core.rocking import Body
from extrados.model.structures.arch import make_arch
from extrados.schema.constants import GRAVITY
from extrados.views.rockers.arch import ArchModel

THICKNESSES = (0.12, 0.15, 0.18, 0.21)
EMBRACES = (140, 150, 160, 170, 180)
TABLE = "table_5_3.csv"
#: Impact rules, and the one by which the dissertation's table was made
RULES = ("thesis", "energy-safe", "inelastic")
SHIPPED_RULE = "thesis"
#: Curves are fitted between these multiples of gamma: nearer to gamma the period runs to infinity, and above
#: the curve turns into the steeper branch of single-swing collapse, which no power law of Eq. 5.8 follows.
FLOOR, CAP = 1.03, 2.3


@dataclass(frozen=True)
class Fit:
    """Coefficients of Eq. 5.8 (R in m, T_p in s, A_p in g); rms: relative misfit of the fitted points."""

    c1: float
    c2: float
    t_min: float
    gamma: float
    rms: float = 0.0

    def amplitude(self, period: np.ndarray | float, radius: float = 1.0) -> np.ndarray:
        """Failing amplitude [g]; infinite at periods that are too short to do harm."""
        x = np.asarray(period, dtype=float) / np.sqrt(radius) - self.t_min
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.where(x > 0.0, self.c1 * np.abs(x) ** self.c2 + self.gamma, np.inf)


def mode_i_curve(
    body: Body, gamma: float, scale: float, periods: np.ndarray, cap: float = CAP, threads: int = 1, context: Context | None = None
) -> np.ndarray:
    """Lowest amplitude [g] of a single sine of each period [s] that brings a structure down; NaN above cap gamma.

    gamma: acceleration at which it starts to rock [g]; scale [m]: see Rocker. With a context through the batch layer:
    Unfinished where some are missing.
    """
    amplitudes = gamma * GRAVITY * np.linspace(1.0, cap, 81)[1:]
    settle = 40.0 * float(np.sqrt(scale / GRAVITY))
    job = LowestAmplitudes(body, "sine", np.asarray(periods), amplitudes, settle, 1e-4 * GRAVITY)
    found = computed(context, "failure-curve", job, len(periods), "failure curve of single sines", threads)
    return found["amplitude"] / GRAVITY


def fit(periods: np.ndarray, amplitudes: np.ndarray, gamma: float) -> Fit:
    """Least relative misfit of A = C1 (T - T_min)^C2 + gamma over C1, C2 and T_min; periods scaled to R = 1 m."""
    good = np.isfinite(amplitudes) & (amplitudes > FLOOR * gamma) & (amplitudes < CAP * gamma)
    t, a = periods[good], amplitudes[good]
    if len(t) < 4:
        raise ValueError(f"only {len(t)} points of the failure curve lie below `max_amplitude`, which is too few for a fit")

    def misfit(x: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        left = t - x[2]
        with np.errstate(over="ignore", invalid="ignore"):  # a step too far, which is not taken
            power = np.exp(x[0]) * left ** x[1] / a
            return power + gamma / a - 1.0, np.stack([power, power * np.log(left), -power * x[1] / left], axis=1)

    low, high = np.array([-np.inf, -5.0, 0.0]), np.array([np.inf, -0.05, t[0] * (1 - 1e-6)])
    starts = [np.array([np.log(0.03), -0.8, share * t[0]]) for share in (0.5, 0.8, 0.95)]
    x, squares = min((_least_squares(misfit, start, low, high) for start in starts), key=lambda found: found[1])
    return Fit(float(np.exp(x[0])), float(x[1]), float(x[2]), gamma, float(np.sqrt(squares / len(t))))


def _least_squares(
    misfit: Callable[[np.ndarray], tuple[np.ndarray, np.ndarray]], x: np.ndarray, low: np.ndarray, high: np.ndarray
) -> tuple[np.ndarray, float]:
    """Least sum of squares of a misfit between bounds, from x: damped Gauss-Newton steps (Marquardt 1963).

    `misfit` gives residuals and their derivatives (residuals, unknowns). Returns x and the sum. Written out here
    because loading scipy.optimize takes longer than the fit.
    """
    r, slopes = misfit(x)
    squares, damping = float(r @ r), 1e-3
    for _ in range(500):
        down = -slopes.T @ r
        free = ~(((x <= low) & (down < 0.0)) | ((x >= high) & (down > 0.0)))
        if not free.any():
            break
        normal = slopes[:, free].T @ slopes[:, free]
        step = np.zeros(len(x))
        step[free] = np.linalg.solve(normal + damping * np.diag(np.diag(normal)), down[free])
        trial = np.clip(x + step, low, high)
        moved = np.abs(trial - x).max()
        r_there, slopes_there = misfit(trial)
        there = float(r_there @ r_there)
        if there < squares:
            x, r, slopes, squares = trial, r_there, slopes_there, there
            damping = max(0.1 * damping, 1e-12)
        else:
            damping *= 10.0
        if moved <= 1e-12 * (1.0 + np.abs(x).max()):
            break
    return x, squares


def fit_own(
    body: Body, gamma: float, scale: float, threads: int = 1, count: int = 80, context: Context | None = None
) -> tuple[Fit, np.ndarray, np.ndarray]:
    """Fit to the structure's own curve, and the periods (scaled to 1 m) and amplitudes [g] it was made from.

    ValueError where too little of the curve lies below the cap; `context`: see mode_i_curve.
    """
    periods = np.geomspace(0.1, 1.6, count)
    curve = mode_i_curve(body, gamma, scale, periods * np.sqrt(scale), threads=threads, context=context)
    return fit(periods, curve, gamma), periods, curve


def fit_arch(model: ArchModel, threads: int = 1) -> tuple[Fit, np.ndarray, np.ndarray]:
    """The same of an arch, scaled to R = 1 m."""
    return fit_own(model.body, model.collapse[0].gamma, model.arch.radius, threads)


def regenerate(rule: str = "thesis", threads: int = 1, say: Callable[[str], None] = print) -> list[dict[str, float]]:
    """All cells of Table 5.3, n = embrace/5, at R = 1 m."""
    rows = []
    for ratio in THICKNESSES:
        for embrace in EMBRACES:
            model = ArchModel(make_arch(1.0, ratio, embrace, embrace // 5), rule)
            f, _, _ = fit_arch(model, threads)
            rows.append(
                {
                    "thickness_ratio": ratio,
                    "embrace_deg": embrace,
                    "c1": f.c1,
                    "c2": f.c2,
                    "t_min_s": f.t_min,
                    "gamma": f.gamma,
                    "rms": f.rms,
                    "restitution": model.restitution,
                }
            )
            say(
                "t/R {thickness_ratio:.2f} {embrace_deg} deg: C1 {c1:.4f} C2 {c2:.3f} Tmin {t_min_s:.3f} gamma {gamma:.4f} "
                "(misfit {rms:.3f}, c_v {restitution:.3f})".format(**rows[-1])
            )
    return rows


@cache
def table() -> dict[tuple[float, float], Fit]:
    """The regenerated Table 5.3 by (t/R, embrace in degrees)."""
    text = files("extrados.analyses.rocking").joinpath(TABLE).read_text(encoding="utf-8")
    rows = csv.DictReader(text.splitlines())
    return {
        (float(r["thickness_ratio"]), float(r["embrace_deg"])): Fit(
            float(r["c1"]), float(r["c2"]), float(r["t_min_s"]), float(r["gamma"]), float(r["rms"])
        )
        for r in rows
    }


def interpolated(ratio: float, embrace: float, gamma: float) -> Fit | None:
    """Coefficients between the cells of the table, bilinear; None outside it. gamma is the arch's own."""
    if not (THICKNESSES[0] <= ratio <= THICKNESSES[-1] and EMBRACES[0] <= embrace <= EMBRACES[-1]):
        return None
    i = min(int(np.searchsorted(THICKNESSES, ratio, side="right")) - 1, len(THICKNESSES) - 2)
    j = min(int(np.searchsorted(EMBRACES, embrace, side="right")) - 1, len(EMBRACES) - 2)
    u = (ratio - THICKNESSES[i]) / (THICKNESSES[i + 1] - THICKNESSES[i])
    v = (embrace - EMBRACES[j]) / (EMBRACES[j + 1] - EMBRACES[j])
    cells = table()
    value = np.zeros(3)
    for di, wi in ((0, 1.0 - u), (1, u)):
        for dj, wj in ((0, 1.0 - v), (1, v)):
            f = cells[(THICKNESSES[i + di], float(EMBRACES[j + dj]))]
            # C1 ranges over an order of magnitude: its logarithm is interpolated
            value += wi * wj * np.array([np.log(f.c1), f.c2, f.t_min])
    return Fit(float(np.exp(value[0])), float(value[1]), float(value[2]), gamma)


def main() -> None:
    """Regenerate the shipped table in place; print that of another impact rule, the word after the command."""
    from extrados.analyses.context import default_threads

    rule = next(iter(sys.argv[1:]), SHIPPED_RULE)
    if rule not in RULES:
        sys.exit(f"no impact rule '{rule}' exists; expected one of {', '.join(RULES)}")
    rows = regenerate(rule, default_threads())
    if rule != SHIPPED_RULE:
        return
    with open(str(files("extrados.analyses.rocking").joinpath(TABLE)), "w", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, fieldnames=list(rows[0]), lineterminator="\n")
        writer.writeheader()
        for row in rows:
            writer.writerow({k: f"{v:.6g}" for k, v in row.items()})


if __name__ == "__main__":
    main()
