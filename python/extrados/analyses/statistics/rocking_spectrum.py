"""rocking-spectrum: greatest rotation under a motion over 2 pi/p and alpha (Makris and Konstantinidis 2003).

Of rectangles, or, where the deck has an arch, of arches of its shape in other sizes.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from extrados.analyses.batches import sweep
from extrados.analyses.context import Context
from extrados.analyses.rocking.common import rocker_of
from extrados.analyses.rocking.conditions import ROWS, Counted, astray_of, of_many, told
from extrados.analyses.rocking.doubts import DIFFER
from extrados.analyses.rocking.job import RunsJob, runs_job
from extrados.analyses.statistics.tables import RockingSpectrum
from extrados.core.rocking import Body
from extrados.model.properties import Initial
from extrados.model.structures.arch import Arch
from extrados.model.structures.block import Block
from extrados.results import statistics as out
from extrados.results.model import Array, Result, TableData
from extrados.results.rocking import COLLAPSE, Conditions
from extrados.schema.constants import GRAVITY
from extrados.views.building import Building
from extrados.views.rockers.rocker import Rocker, make_rocker


def block_of(period: float, alpha: float, building: Building, linear: bool) -> Rocker:
    """The rectangle of frequency parameter p = 2 pi/period [rad/s] and slenderness alpha [rad], of 1 m depth, with the joints of a
    building."""
    p = 2.0 * np.pi / period
    radius = 0.75 * GRAVITY / p**2
    block = Block(kind="block", width=2.0 * radius * np.sin(alpha), height=2.0 * radius * np.cos(alpha))
    return make_rocker(building.having(structure=block).apart(), linear)


def run(context: Context, options: RockingSpectrum) -> Result:
    """Rotation spectra; what overturns has no rotation, its place is marked."""
    motion = context.motion
    periods = np.array(options.periods) if options.periods else np.linspace(0.2, 8.0, 60)
    structure = context.deck.structure
    if structure is not None and structure.kind == "arch":
        family, sizes, rockers = _arches(context, options, periods)
    else:
        alphas = np.radians(options.slenderness)
        rockers = [block_of(t, a, _at_rest(context.building), options.form == "linear") for a in alphas for t in periods]
        family = [f"alpha {a:g} deg" for a in options.slenderness]
        sizes = 0.75 * GRAVITY * (periods / (2.0 * np.pi)) ** 2
    n = len(rockers)
    settle = np.tile(periods, len(family)) * 6.0

    def job_of(bodies: list[Body]) -> RunsJob:
        return runs_job(bodies, [motion.ground], np.arange(n), 0, 1.0, motion.end + settle, astray=astray_of(rockers[0]))

    job = job_of([one.body for one in rockers])
    swept = sweep(context, "rocking-spectrum", job, n, "rocking spectrum")
    result = Result("rocking-spectrum", swept.status, swept.stopped)
    if not swept.complete:
        return result
    shape = (len(family), len(periods))
    overturned = swept["outcome"].reshape(shape) == COLLAPSE
    ratio = np.where(overturned, np.nan, swept["peak_ratio"].reshape(shape))
    rotation = np.where(overturned, np.nan, np.abs(swept["peak"].reshape(shape)))
    longest = [float(periods[row].max()) if row.any() else None for row in overturned]
    result.results = out.RockingSpectrum(
        family=family,
        overturned=overturned.sum(axis=1),
        longest_overturning_period_s=longest,
        size_m=sizes.tolist(),
        peak_ground_acceleration_g=motion.peak / GRAVITY,
        conditions=_conditions(rockers, swept.arrays, len(periods)),
        **_by_rule(context, rockers, job_of, result),
    )
    for name, one in zip(family, result.results.conditions, strict=True):
        result.warnings += [f"{name}: {text}" for text in told(one)]
    result.tables["rocking_spectrum"] = TableData(
        {
            "family": np.repeat(family, len(periods)),
            "period": np.tile(periods, len(family)),
            "size": np.tile(sizes, len(family)),
            "peak_rotation": rotation.ravel(),
            "peak_ratio": ratio.ravel(),
            "overturned": overturned.ravel().astype(int),
        },
        {"period": "s", "size": "m", "peak_rotation": "rad"},
    )
    result.arrays |= {
        "period": Array(periods, ("period",), "s", "2 pi/p for a block, 2 pi times the natural time for an arch"),
        "size": Array(sizes, ("period",), "m", "half-diagonal of the block, or radius of the arch"),
        "peak_ratio": Array(
            ratio, ("family", "period"), "", "greatest rotation divided by the critical rotation; NaN if the structure overturns"
        ),
        "overturned": Array(overturned.astype(np.int8), ("family", "period")),
    }
    words = []
    for name, row, last in zip(family, overturned, longest, strict=True):
        size = "" if last is None else f", up to {last:.3g} s ({sizes[periods == last][0]:.3g} m)"
        words.append(f"{name}: {int(row.sum())} of {len(periods)} overturn{size}")
    result.answer = f"Peak ground acceleration {motion.peak / GRAVITY:.3f} g. " + "; ".join(words) + "."
    return result


def _by_rule(context: Context, rockers: list[Rocker], job_of: Callable[[list[Body]], RunsJob], result: Result) -> dict[str, Any]:
    """Spectra by each impact rule, where their c_v differ by more than DIFFER; nothing where they agree. All sizes of one shape have the
    same c_v."""
    each = [one.rivals(DIFFER) for one in rockers]
    rules = [rule for rule in each[0] if all(rule in one for one in each)]
    if not rules:
        return {}
    rows, ratios = [], []
    for rule in rules:
        bodies = [one.held(rivals[rule][1]) for one, rivals in zip(rockers, each, strict=True)]
        found = sweep(context, f"rocking-spectrum-{rule}", job_of(bodies), len(rockers), f"spectrum by the rule {rule}").whole()
        fell = found["outcome"] == COLLAPSE
        ratios.append(np.where(fell, np.inf, found["peak_ratio"]))
        rows.append(out.RuleSpectrum(rule=rule, restitution=each[0][rule][0], overturned=int(fell.sum())))
    least, most = np.min(ratios, axis=0), np.max(ratios, axis=0)
    decided = int((np.isinf(least) != np.isinf(most)).sum())
    result.arrays |= {
        "rule_least": Array(
            least, ("period",), "", "peak rotation divided by the critical rotation, lowest of all impact rules; infinite: collapse"
        ),
        "rule_most": Array(
            most, ("period",), "", "peak rotation divided by the critical rotation, highest of all impact rules; infinite: collapse"
        ),
    }
    told_rules = ", ".join(f'"{one.rule}" {one.restitution:.3f}: {one.overturned}' for one in rows)
    result.warnings.append(
        f"The impact rules differ by more than {DIFFER:g} for this shape. Number of sizes that overturn, of "
        f"{len(rockers)}: {told_rules}. The rule decides the outcome of {decided} sizes."
    )
    return {"by_rule": rows, "decided_by_rule": decided}


def _conditions(rockers: list[Rocker], rows: dict[str, np.ndarray], sizes: int) -> list[Conditions]:
    """Of each family whether blocks slide or hinges form elsewhere."""
    found = []
    for first in range(0, len(rockers), sizes):
        part = {name: rows[name][first : first + sizes] for name in ("outcome", *ROWS)}
        found.append(of_many(rockers[first], Counted.of([part]), "sizes")["conditions"])
    return found


def _at_rest(building: Building) -> Building:
    """The building that starts from rest, with joints all alike."""
    return building.having(initial=Initial(), joints=building.joints.model_copy(update={"types": []}))


def _arches(context: Context, options: RockingSpectrum, periods: np.ndarray) -> tuple[list[str], np.ndarray, list[Rocker]]:
    """The deck's arch in the sizes whose natural time is period / 2 pi: it grows with the root of the size (Eq. 5.7)."""
    structure = context.building.require_structure()
    assert isinstance(structure, Arch)
    base = rocker_of(context, options)
    factors = (periods / (2.0 * np.pi * base.time_unit)) ** 2
    rockers = []
    for factor in factors.tolist():
        update = {"radius": structure.radius * factor, "thickness": structure.thickness * factor}
        rockers.append(make_rocker(context.building.having(structure=structure.model_copy(update=update))))
    return ["arches of this shape"], structure.radius * factors, rockers
