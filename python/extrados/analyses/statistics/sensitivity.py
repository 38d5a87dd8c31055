"""Which uncertain value matters: Sobol indices of the rotation and of the collapse, over structure and motion together."""

from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.stats import qmc, sobol_indices

from extrados.analyses.batches import sweep
from extrados.analyses.context import Context, Refused
from extrados.analyses.motion_source import Source
from extrados.analyses.rocking.job import runs_job
from extrados.analyses.statistics.uncertain import Bodies
from extrados.core.rocking import FAILED
from extrados.results import statistics as out
from extrados.results.model import Array, Result, TableData
from extrados.results.rocking import COLLAPSE

MOTION = "motion"  # what the choice of the motion is called among the uncertain values
MOST_MOTIONS = 4096  # held in memory


def sensitivity(
    context: Context,
    names: list[str],
    models: Callable[[np.ndarray], Bodies],
    source: Source,
    motions: int,
    settle: float,
    samples: int,
    seed: int,
    repeats: int,
    confidence: float,
    tolerance: float,
    result: Result,
) -> dict[str, Any]:
    """First-order and total Sobol indices (Saltelli and others 2010) of the peak rotation ratio, collapse counted as 1,
    and of the collapse itself.

    models: structures at points (n, names) of the unit cube; the motion is one more value, each of `motions` as likely.
    settle: time after a motion [s].
    samples: a power of 2; samples times (values + 2) runs. The intervals come from drawing samples anew.
    """
    motions = min(motions, MOST_MOTIONS)
    grounds = source.grounds(0, motions, context.threads)
    usable = [g for g in grounds if not isinstance(g, str)]
    values = [*names, *([MOTION] if len(usable) > 1 else [])]
    d = len(values)
    both = qmc.Sobol(2 * d, scramble=True, seed=seed).random(samples)
    a, b = both[:, :d], both[:, d:]
    mixed = np.repeat(a[None], d, axis=0)
    for i in range(d):
        mixed[i, :, i] = b[:, i]
    points = np.concatenate([a, b, mixed.reshape(-1, d)])
    # The points at which only the motion differs share their structures
    structures, body = np.unique(points[:, : len(names)], axis=0, return_inverse=True)
    made = models(structures)
    without = [body for body in made.bodies if isinstance(body, str)] + ["cannot stand"] * int(made.fallen.sum())
    if without:
        raise Refused(
            f"{len(without)} of {len(made.bodies)} sampled buildings do not rock ({without[0]}), but "
            "sensitivity indices require that all rock. Try smaller coefficients of variation",
            ("analysis", "uncertain"),
        )
    bodies = [body for body in made.bodies if not isinstance(body, str)]
    chosen = np.minimum((points[:, -1] * len(usable)).astype(int), len(usable) - 1) if len(usable) > 1 else 0
    body = body.ravel()
    end = np.array([g.end for g in usable])[chosen] + settle
    start = made.starts[body]
    job = runs_job(bodies, usable, body, chosen, 1.0, end, start, tolerance=tolerance, strict=False)
    swept = sweep(context, "sensitivity", job, len(points), "sensitivity").whole()
    if (failed := int((swept["outcome"] == FAILED).sum())) > 0:
        raise Refused(
            f"{failed} of {len(points)} runs for the sensitivity indices fail, but the indices require all runs", ("analysis", "uncertain")
        )
    answers = np.stack([np.minimum(swept["peak_ratio"], 1.0), swept["outcome"] == COLLAPSE]).astype(float)
    whole = answers.reshape(2, d + 2, samples)
    found = [_indices(rows[None], d) for rows in whole]
    random = np.random.default_rng(seed)
    drawn: list[list[np.ndarray]] = [[], []]
    for _ in range(repeats):
        pick = random.integers(0, samples, samples)
        for k, rows in enumerate(whole):
            drawn[k].append(_indices(rows[None, :, pick], d))
    tails = [0.5 - 0.5 * confidence, 0.5 + 0.5 * confidence]
    bands = [np.nanquantile(rows, tails, axis=0) if repeats and np.isfinite(rows).any() else np.full((2, 2, d), np.nan) for rows in drawn]
    table: dict[str, Any] = {"value": values}
    of_value: dict[str, dict[str, Any]] = {value: {} for value in values}
    for k, what in enumerate(("rotation", "collapse")):
        for j, order in enumerate(("first", "total")):
            key = f"{what}_{order}"
            table |= {key: found[k][j], f"{key}_lower": bands[k][0, j], f"{key}_upper": bands[k][1, j]}
            for i, value in enumerate(values):
                of_value[value] |= {key: found[k][j, i], f"{key}_interval": bands[k][:, j, i]}
    result.tables["sensitivity"] = TableData(table)
    result.arrays |= {
        f"sensitivity_{name}": Array(np.asarray(v), ("value",), "", "Sobol index") for name, v in table.items() if name != "value"
    }
    return {"sensitivity": {v: out.Sensitivity(**row) for v, row in of_value.items()}, "sensitivity_runs": len(points)}


def _indices(rows: np.ndarray, d: int) -> np.ndarray:
    """First and total indices (2, d) of answers (1, d + 2, samples) at A, B and their mixtures; NaN without variance."""
    if np.ptp(rows[:, :2]) == 0.0:
        return np.full((2, d), np.nan)
    parts = {"f_A": rows[:, 0], "f_B": rows[:, 1], "f_AB": rows[0, 2:, None, :]}
    found = sobol_indices(func=parts, n=rows.shape[2])
    return np.stack([np.ravel(found.first_order), np.ravel(found.total_order)])


def spoken(sensitivity: dict[str, out.Sensitivity]) -> str:
    """Which value the rotation depends on most, in words."""
    known = {name: row.rotation_total for name, row in sensitivity.items() if row.rotation_total is not None}
    if not known:
        return "No uncertain value matters: the greatest rotation is the same in all runs."
    order = sorted(known, key=lambda name: -known[name])
    said = ", ".join(f"{name} {100 * known[name]:.0f} %" for name in order)
    return f"Share of each uncertain value in the variance of the greatest rotation (total Sobol indices): {said}."
