"""fragility: probability of uplift and collapse over many motions (thesis 6.3, Figs 6-7, 6-8, 6-10)."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from extrados.analyses.batches import Swept, Unfinished, sweep
from extrados.analyses.context import Context
from extrados.analyses.motion_source import GeneratedSource, ListSource, Source, measures, source_of
from extrados.analyses.rocking.common import rocker_of
from extrados.analyses.rocking.conditions import ROWS, Counted, astray_of, of_many, rows_of, slides_at_rest, told
from extrados.analyses.rocking.doubts import DIFFER
from extrados.analyses.statistics import cloud
from extrados.analyses.statistics.annual import hazard_curve
from extrados.analyses.statistics.handed import Handed, handed_of
from extrados.analyses.statistics.levels import INTENSITIES, arranged, describe, shares_at
from extrados.analyses.statistics.sensitivity import sensitivity, spoken
from extrados.analyses.statistics.summaries import median, shares, shares_of
from extrados.analyses.statistics.tables import Fragility, Hazard
from extrados.analyses.statistics.uncertain import Bodies, bodies_at, sampled
from extrados.core import rocking as core_rocking
from extrados.core.errors import Cancelled, status_code
from extrados.core.rocking import FAILED, Body, Ground, Response
from extrados.core.soft_base import KIND as SOFT_BASE
from extrados.core.soft_base import SoftBase, SoftBaseResponse, soft_base_history, soft_base_start
from extrados.core.stack import KIND as STACK
from extrados.core.stack import Stack, stack_history
from extrados.motions.from_deck import is_set
from extrados.motions.hazard import HazardCurve
from extrados.motions.motion import Motion
from extrados.results import statistics as out
from extrados.results.fields import Keys
from extrados.results.model import Array, Result, StreamedTable, TableData
from extrados.results.rocking import COLLAPSE, Conditions
from extrados.schema.constants import GRAVITY
from extrados.views.rockers.block import BlockModel
from extrados.views.rockers.rocker import Rocker

#: Hazard curve of the site, and its table
SiteHazard = tuple[HazardCurve, Hazard] | None

#: Histories are drawn in so many points, and until so many time units of the building after the motion
POINTS, AFTER = 3000, 5.0
#: So many motions are also run by the other impact rules
MOST_BY_RULE = 2000


def empty_rows(count: int) -> dict[str, np.ndarray]:
    """Rows (count) of runs without a result yet."""
    numbers = ("peak", "peak_ratio", "stop_time", "scale", "pga", "pgv", "arias", "intensity", "friction")
    return {
        "outcome": np.full(count, FAILED, np.int8),
        "half_cycles": np.zeros(count, np.int32),
        **{name: np.full(count, np.nan) for name in numbers},
        **{name: np.zeros(count, np.int8) for name in ("slips", "strays", "handed")},
    }


@dataclass(frozen=True)
class EnsembleJob:
    """Member k is motion k // L at level k % L, L the number of levels; without levels motions stay as they are.

    measure: what is scaled to the level or, without levels, told as the intensity of a motion, in SI; an intensity of 1
    means `unit` of it. bodies, starts and fallen hold one entry, or one for each motion; a text is why a building is none, and
    one that is fallen cannot stand, so that every motion finds it collapsed. astray: see rocking.conditions.
    """

    source: Source
    bodies: list[Body | str]
    starts: np.ndarray
    fallen: np.ndarray
    measure: str
    unit: float
    levels: np.ndarray | None
    sa: tuple[float, float] | None
    settle: float
    tolerance: float
    astray: float = 0.0
    handed: Handed | None = None

    def _scale(self, own: dict[str, np.ndarray], level: np.ndarray, index: np.ndarray) -> np.ndarray:
        """Factors (runs) on motions of those measures and that index that bring them to that level; 1 without levels."""
        if self.levels is None:
            return np.ones(len(index))
        wanted = self.levels[level] * self.unit
        with np.errstate(divide="ignore", invalid="ignore"):
            scale = wanted if self.measure == "scale" else wanted / own[self.measure][index]
        return np.sqrt(scale) if self.measure == "arias" else scale

    def run(self, first: int, count: int, threads: int) -> dict[str, np.ndarray]:
        per_motion = 1 if self.levels is None else len(self.levels)
        member = np.arange(first, first + count)
        low, high = first // per_motion, (first + count - 1) // per_motion + 1
        found = self.source.grounds(low, high - low, threads)
        usable = [i for i, ground in enumerate(found) if not isinstance(ground, str)]
        place = np.full(len(found), -1)
        place[usable] = np.arange(len(usable))
        grounds = [ground for ground in found if not isinstance(ground, str)]
        motion = member // per_motion - low
        reason = np.array([ground if isinstance(ground, str) else "" for ground in found])[motion]
        rows = empty_rows(count)
        whose = member // per_motion if len(self.bodies) > 1 else np.zeros(count, int)
        without = np.array([self.bodies[b] if isinstance(self.bodies[b], str) else "" for b in whose])
        reason = np.where(reason == "", without, reason)
        usable_run = (place[motion] >= 0) & (without == "")
        if usable_run.any():
            own = measures(grounds, self.sa, threads)
            good = np.flatnonzero(usable_run)
            index = place[motion[good]]
            scale = self._scale(own, member[good] % per_motion, index)
            level_ok = np.isfinite(scale)
            reason = np.where(np.isin(np.arange(count), good[~level_ok]), "the motion is zero, so it cannot be scaled", reason)
            good, index, scale = good[level_ok], index[level_ok], scale[level_ok]
            if not len(good):
                return {**rows, "reason": reason}
            used, body = np.unique(whose[good], return_inverse=True)
            e = core_rocking.ensemble(
                [self.bodies[b] for b in used],
                grounds,
                body,
                index,
                scale,
                np.array([g.end for g in grounds])[index] + self.settle,
                start_rotation=self.starts[used][body],
                tolerance=self.tolerance,
                threads=threads,
            )
            if e.interrupted:
                raise Cancelled(status_code("cancelled"), "ensemble interrupted")
            rows["outcome"][good] = e.outcome
            rows["half_cycles"][good] = e.half_cycles
            for name in ("peak", "peak_ratio", "stop_time"):
                rows[name][good] = getattr(e, name)
            for name, values in rows_of(e.joints, e.half_cycles, self.astray).items():
                rows[name][good] = values
            if self.handed is not None:
                rows["scale"][good] = scale
                fails = ((rows["slips"][good] > 0) | (rows["strays"][good] > 0)) & ~self.fallen[whose[good]] & (e.outcome != FAILED)
                left = good[fails]
                self.handed.settle(rows, left, whose[left], [grounds[k] for k in index[fails]], self.settle, threads)
            down = good[self.fallen[whose[good]]]
            rows["outcome"][down], rows["half_cycles"][down] = COLLAPSE, 0
            rows["peak_ratio"][down], rows["stop_time"][down] = 1.0, 0.0
            for name in ("peak", "friction"):
                rows[name][down] = np.nan
            rows["slips"][down] = rows["strays"][down] = 0
            rows["scale"][good] = scale
            for name, power in (("pga", 1), ("pgv", 1), ("arias", 2)):
                rows[name][good] = own[name][index] * np.abs(scale) ** power
            if self.measure in own:
                rows["intensity"][good] = own[self.measure][index] / self.unit
                rows["intensity"][good] *= np.abs(scale) ** (2 if self.measure == "arias" else 1)
            if e.failed:
                texts = np.full(count, "", dtype=object)
                texts[good[list(e.failed)]] = list(e.failed.values())
                reason = np.where(texts == "", reason, texts.astype(str))
        return {**rows, "reason": reason}


def run(context: Context, options: Fragility) -> Result:
    """Histograms, probabilities, curves; see the deck reference."""
    base = rocker_of(context, options)
    result = Result("fragility")
    if options.durations is None:
        job, count, motions = job_of(context, options, base, None)
        swept = sweep(
            context, "fragility", job, count, "fragility", large=not options.cloud, slow=options.hand_over, parallel=options.hand_over
        )
        _describe(context, options, base, job, swept, motions, result)
    else:
        parts = []
        for duration in options.durations:
            job, count, motions = job_of(context, options, base, duration)
            swept = sweep(
                context, "fragility", job, count, f"fragility, {duration:g} s", slow=options.hand_over, parallel=options.hand_over
            )
            parts.append((duration, swept))
            if not swept.complete:
                break
        _describe_durations(options, base, parts, result)
    return result


def job_of(context: Context, options: Fragility, base: Rocker, duration: float | None) -> tuple[EnsembleJob, int, int]:
    """The ensemble of a fragility, the number of its runs, the number of its motions or buildings."""
    source, available = source_of(context, options.seed, duration)
    motions = options.count or available or 1000
    made = (
        sampled(context, options, base, motions)
        if options.uncertain
        else Bodies([base.body], np.array([base.start_rotation]), np.zeros(1, bool))
    )
    levels = np.array(options.levels) if options.levels else None
    measure: str = options.intensity
    unit = INTENSITIES[options.intensity][1]
    if measure == "pga-ratio":
        measure, unit = "pga", base.unit_acceleration * GRAVITY
    elif measure == "pgv-ratio":
        measure, unit = "pgv", base.unit_acceleration * GRAVITY * base.time_unit
    sa = (options.sa_period, options.sa_damping) if options.sa_period and (options.levels or options.cloud) else None
    settle = 40.0 * base.time_unit if options.settle is None else options.settle
    handed = handed_of(context, options, base, made.sample)
    job = EnsembleJob(
        source, made.bodies, made.starts, made.fallen, measure, unit, levels, sa, settle, options.tolerance, astray_of(base), handed
    )
    if made.fallen.any():
        context.warnings.append(
            f"{int(made.fallen.sum())} of {len(made.fallen)} sampled buildings cannot stand under their own weight: they count as collapsed"
        )
    return job, motions * (1 if levels is None else len(levels)), motions


def _describe(context: Context, options: Fragility, base: Rocker, job: EnsembleJob, swept: Swept, motions: int, result: Result) -> None:
    result.status, result.reason = swept.status, swept.stopped
    if not swept.finished:
        result.answer = "No member is finished."
        return
    if swept.interrupted and swept.on_disk and job.levels is not None:
        result.answer = f"{swept.finished} of {swept.count} runs are complete and saved. A result requires all runs."
        return
    initial = base.initial_ratio
    per_motion = 1 if job.levels is None else len(job.levels)
    failed = sum(int((rows["outcome"] == FAILED).sum()) for _, rows in swept.pieces("outcome"))
    r: dict[str, Any] = {
        "failed": failed,
        "confidence": options.confidence,
        "restitution": base.restitution,
        "uplift_acceleration_g": base.uplift,
        "critical_rotation_rad": base.critical[0],
        "initial_rotation_ratio": initial,
        "motions": motions,
        **_conditions(options, base, [rows for _, rows in swept.pieces("outcome", "pga", "handed", *ROWS)]),
    }
    result.warnings += told(r["conditions"])
    _tell_failures(job, swept, per_motion, result)
    _tables(job, swept, per_motion, options, result)
    hazard: SiteHazard = None if options.hazard is None else (hazard_curve(options.hazard, context.deck.folder), options.hazard)
    if job.levels is not None:
        result.results = out.OverLevels(**r, **_over_levels(context, options, base, job, swept, motions, hazard, result))
        return
    r |= shares_of(
        lambda: ((rows["outcome"], rows["peak_ratio"]) for _, rows in swept.pieces("outcome", "peak_ratio")), options.confidence, initial
    )
    r |= _medians(job, swept, result)
    result.arrays |= _histogram(options, swept)
    result.answer = _words(context, options, base, r)
    if swept.complete:
        r |= _by_rule(context, options, base, job, motions, result)
    if options.cloud:
        name, _, unit = INTENSITIES[options.intensity]
        r |= cloud.describe(
            swept["intensity"],
            swept["outcome"],
            swept["peak_ratio"],
            name,
            unit,
            options.rotation_limits,
            hazard,
            options.confidence,
            result,
        )
        measures = {"PGA": (swept["pga"] / GRAVITY, "g"), "PGV": (swept["pgv"], "m/s"), "Arias intensity": (swept["arias"], "m/s")}
        compared = cloud.compare(measures | ({name: (swept["intensity"], unit)} if options.intensity == "sa" else {}), swept["outcome"])
        if len(compared) > 1:
            r["measures"] = compared
            result.answer += (
                f" Among {', '.join(sorted(one.measure for one in compared))}, the measure {compared[0].measure} predicts collapse best."
            )
    if options.histories and swept.complete:
        _histories(job, base, min(options.histories, motions), result)
    if options.sensitivity is not None and swept.complete:
        r |= _sensitivity(context, options, base, job, motions, result)
    result.results = out.Ensemble(**r)


def _over_levels(
    context: Context, options: Fragility, base: Rocker, job: EnsembleJob, swept: Swept, motions: int, hazard: SiteHazard, result: Result
) -> Keys:
    """Results over levels of the intensity."""
    assert job.levels is not None
    found = shares_at(job.levels, swept, "slips", "strays")
    r: Keys = {"sliding_share": found["slips"], "hinges_elsewhere_share": found["strays"]}
    r |= describe(
        arranged(job.levels, swept),
        options.intensity,
        base.word,
        base.initial_ratio,
        hazard,
        options.confidence,
        0 if swept.interrupted else options.bootstrap,
        options.seed or 0,
        result,
    )
    return r | _by_rule(context, options, base, job, motions * len(job.levels), result) if swept.complete else r


def _medians(job: EnsembleJob, swept: Swept, result: Result) -> Keys:
    """Medians of the measures of the motions, of generated ones with those expected at their intensity."""
    middle = {name: median(partial(_column, swept, name)) for name in ("pga", "pgv", "arias")}
    r: Keys = {
        "median_pga_g": None if middle["pga"] is None else middle["pga"] / GRAVITY,
        "median_pgv_m_s": middle["pgv"],
        "median_arias_m_s": middle["arias"],
    }
    if isinstance(job.source, GeneratedSource) and job.source.made.floor is None:
        expected = job.source.made.expected()
        r |= {"expected_pga_g": expected["pga"] / GRAVITY, "expected_pgv_m_s": expected["pgv"]}
        ratio = r["median_pga_g"] / r["expected_pga_g"]
        if not 0.5 <= ratio <= 2.0:
            result.warnings.append(
                f"the median peak acceleration of the motions, {r['median_pga_g']:.2f} g, is {ratio:.1f} times the median observed "
                f"at this intensity ({r['expected_pga_g']:.2f} g, Worden et al. 2012)"
            )
    return r


def _histogram(options: Fragility, swept: Swept) -> dict[str, Array]:
    """Peak rotations of the members that do not collapse."""
    edges = np.linspace(0.0, 1.0, options.bins + 1)
    counts = np.zeros(options.bins, int)
    for _, rows in swept.pieces("outcome", "peak_ratio"):
        upright = (rows["outcome"] != FAILED) & (rows["outcome"] != COLLAPSE)
        counts += np.histogram(np.minimum(rows["peak_ratio"][upright], 1.0), edges)[0]
    return {
        "bin_edge": Array(edges, ("bin_edge",), "", "peak rotation divided by the critical rotation"),
        "bin_count": Array(counts, ("bin",), "", "members that do not collapse"),
    }


def _words(context: Context, options: Fragility, base: Rocker, r: Keys) -> str:
    """The probability in words."""
    p, (low, high) = r["collapse_probability"], r["confidence_interval"]
    if p is None:
        return "No motion could be run."
    many = context.deck.motion is None or is_set(context.deck.motion)
    counted = (
        f"{r['collapsed']} of {r['count']} motions cause collapse of the {base.word}"
        if many
        else f"{r['collapsed']} of {r['count']} samples of the building with uncertain values collapse"
    )
    return (
        f"{counted}: probability of collapse {100 * p:.1f} % ({100 * options.confidence:g} % confidence "
        f"interval {100 * low:.1f} to {100 * high:.1f} %). Rocking starts in {100 * r['uplift_probability']:.1f} % "
        f"of the runs. The greatest rotation, divided by the critical rotation, has a mean of {r['mean_peak_rotation_ratio']:.2f} "
        f"(collapse counts as 1). The {('motions have a median' if many else 'motion has a')} peak "
        f"acceleration of {r['median_pga_g']:.3f} g; rocking starts at {base.uplift:.3f} g."
    )


def _sensitivity(context: Context, options: Fragility, base: Rocker, job: EnsembleJob, motions: int, result: Result) -> Keys:
    """Influence of each uncertain value on collapse; empty if the runs end early."""
    assert options.sensitivity is not None
    try:
        r = sensitivity(
            context,
            sorted(options.uncertain),
            lambda draws: bodies_at(context, options, base, draws),
            job.source,
            motions if context.deck.motion is None or is_set(context.deck.motion) else 1,
            job.settle,
            options.sensitivity,
            options.seed or 0,
            options.bootstrap,
            options.confidence,
            options.tolerance,
            result,
        )
    except Unfinished as stop:
        result.status, result.reason = ("interrupted" if stop.interrupted else "failed"), str(stop)
        return {}
    result.answer += f" {spoken(r['sensitivity'])}"
    return r


def _conditions(options: Fragility, base: Rocker, rows: list[dict[str, np.ndarray]]) -> dict[str, Any]:
    """Whether blocks slide or hinges form elsewhere; of sampled buildings of several stones only whether the nominal one slides
    before it rocks."""
    if options.uncertain and base.watch is not None and not isinstance(base.model, BlockModel) and not options.watches_samples:
        why = (
            "Sliding and the thrust line are not checked, because the calculated forces at the joints are "
            "those of the nominal building, not of the sampled buildings."
        )
        return {"conditions": Conditions(not_checked=why, violated=slides_at_rest(base, rows, "motions"))}
    found = of_many(base, Counted.of(rows), "motions")
    if options.hand_over:
        handed = sum(int(piece["handed"].sum()) for piece in rows)
        failing = sum(int((((piece["slips"] > 0) | (piece["strays"] > 0)) & (piece["outcome"] != FAILED)).sum()) for piece in rows)
        if handed == failing:
            found["conditions"] = found["conditions"].model_copy(update={"violated": []})
        found["handed_over"] = handed
    return found


def _by_rule(context: Context, options: Fragility, base: Rocker, job: EnsembleJob, count: int, result: Result) -> dict[str, Any]:
    """Share of the runs that collapse by each impact rule, at each level where there are any, where their c_v differ by more than
    DIFFER and the runs are few enough."""
    rivals = base.rivals(DIFFER)
    if not rivals or options.uncertain:
        return {}
    each = ", ".join(f'"{rule}" {c_v:.3f}' for rule, (c_v, _) in rivals.items())
    if count > MOST_BY_RULE:
        result.warnings.append(
            f"The impact rules differ by more than {DIFFER:g} for this structure ({each}). At most {MOST_BY_RULE} motions are "
            f"run with every rule. This run has {count} motions, so the probability is given with one rule only."
        )
        return {}
    found = {}
    levels = 1 if job.levels is None else len(job.levels)
    for rule, (_, body) in rivals.items():
        held = base.held(body)
        rival = replace(job, bodies=[held], handed=job.handed and job.handed.by(held))
        swept = sweep(
            context, "fragility", rival, count, f"fragility by the rule {rule}", slow=options.hand_over, parallel=options.hand_over
        ).whole()
        good = swept["outcome"] != FAILED
        at = swept.members % levels
        hits, runs = (np.bincount(at, weight, levels) for weight in (swept["outcome"] == COLLAPSE, good))
        found[rule] = hits / np.maximum(runs, 1)
    if job.levels is None:
        shares = ", ".join(f'"{rule}" {100.0 * share[0]:.3g} %' for rule, share in found.items())
        result.warnings.append(
            f"The impact rules differ by more than {DIFFER:g} for this structure ({each}). Probability of collapse by each rule: {shares}."
        )
        return {"collapse_probability_by_rule": {rule: float(share[0]) for rule, share in found.items()}}
    order = np.argsort(job.levels, kind="stable")
    rows = [
        out.RuleShares(rule=rule, restitution=rivals[rule][0], collapse_probability=share[order].tolist()) for rule, share in found.items()
    ]
    every = np.array(list(found.values()))[:, order]
    apart = float(np.ptp(every, axis=0).max())
    result.warnings.append(
        f"The impact rules differ by more than {DIFFER:g} for this structure ({each}). At one level the probabilities of "
        f"collapse by two rules differ by up to {100.0 * apart:.3g} %."
    )
    result.arrays |= {
        "stripe_rule_least": Array(every.min(axis=0), ("stripe",), "", "lowest probability of collapse of all impact rules"),
        "stripe_rule_most": Array(every.max(axis=0), ("stripe",), "", "highest probability of collapse of all impact rules"),
    }
    return {"collapse_by_rule": rows, "rule_band": apart}


def _histories(job: EnsembleJob, base: Rocker, count: int, result: Result) -> None:
    """The first motions and what the building does under each, as series of arrays (Fig. 6-6)."""
    for k in range(count):
        (ground,) = job.source.grounds(k, 1, 1)
        body = job.bodies[k % len(job.bodies)]
        if isinstance(ground, str) or isinstance(body, str) or job.fallen[k % len(job.fallen)]:
            continue
        start, end = float(job.starts[k % len(job.starts)]), ground.end + AFTER * base.time_unit
        h = _response(body, ground, end, start, job.tolerance)
        at, ground_acceleration = Motion("", ground).series()  # whole, where the response ends with collapse
        thin = slice(None, None, max(1, len(at) // POINTS))
        critical = base.critical[0]
        for what, axis, data, unit, about in (
            ("motion_time", "motion_time", at[thin], "s", f"motion {k + 1}"),
            ("motion", "motion_time", ground_acceleration[thin] / GRAVITY, "g", "ground acceleration"),
            ("time", "history_time", h.time, "s", ""),
            ("rotation", "history_time", h.rotation / critical, "", f"rotation divided by the critical rotation: {h.outcome}"),
        ):
            result.arrays[f"history_{what}_{k + 1}"] = Array(data, (f"{axis}_{k + 1}",), unit, about, series=f"history_{what}")


class Shown(NamedTuple):
    """Of two stacked blocks: the rotation of the lower one [rad] over time [s]."""

    time: np.ndarray
    rotation: np.ndarray
    outcome: str


def _response(body: Body, ground: Ground, end: float, start: float, tolerance: float) -> "Response | SoftBaseResponse | Shown":
    """A body under a motion until a time [s], from a rotation [rad]."""
    if body.kind == STACK:
        r = stack_history(Stack.of(body), ground, end, end / POINTS, tolerance=tolerance, start=(start, start, 0.0, 0.0))
        return Shown(r.time, r.rotation[:, 0], r.outcome)
    if body.kind == SOFT_BASE:
        base = SoftBase.of(body)
        return soft_base_history(base, ground, end, end / POINTS, tolerance=tolerance, start=soft_base_start(base, start))
    return core_rocking.history(
        body, ground, end, end / POINTS, tolerance=tolerance, start_side=1 if start >= 0.0 else -1, start_rotation=abs(start)
    )


def _tell_failures(job: EnsembleJob, swept: Swept, per_motion: int, result: Result) -> None:
    """Why members have no result; a motion that fails at one level fails at all and is told once."""
    told: set[str] = set()
    count = 0
    for members, rows in swept.pieces("outcome", "reason"):
        failed = np.flatnonzero(rows["outcome"] == FAILED)
        count += len(failed)
        for k, why in zip(members[failed], rows["reason"][failed], strict=True):
            name = (
                job.source.names[k // per_motion % len(job.source.names)]
                if isinstance(job.source, ListSource)
                else f"motion {k // per_motion + 1}"
            )
            if name in told:
                continue
            told.add(name)
            if len(told) <= 5:
                result.warnings.append(f"{name} has no result: {why}")
    if len(told) > 5:
        result.warnings.append(f"in total, {count} runs have no result, see ensemble.csv")


def _tables(job: EnsembleJob, swept: Swept, per_motion: int, options: Fragility, result: Result) -> None:
    units = {"pga": "g", "pgv": "m/s", "arias": "m/s", "peak_rotation": "rad", "stop_time": "s"}
    if options.cloud:
        units["intensity"] = INTENSITIES[options.intensity][2]
    if job.levels is not None:
        units["level"] = INTENSITIES[options.intensity][2]
    words = np.array([*core_rocking.OUTCOMES, "failed"])
    reasons = any((rows["reason"] != "").any() for _, rows in swept.pieces("reason"))
    names = ("scale", "pga", "pgv", "arias", "outcome", "half_cycles", "peak", "peak_ratio", "stop_time", "reason", "intensity")

    def columns(members: np.ndarray, rows: dict[str, np.ndarray]) -> dict[str, Any]:
        found: dict[str, Any] = {"member": members + 1, "motion": members // per_motion + 1}
        if options.cloud:
            found["intensity"] = rows["intensity"]
        if job.levels is not None:
            found["level"] = job.levels[members % per_motion]
        found |= {
            "scale": rows["scale"],
            "pga": rows["pga"] / GRAVITY,
            "pgv": rows["pgv"],
            "arias": rows["arias"],
            "outcome": words[rows["outcome"]],
            "half_cycles": rows["half_cycles"],
            "peak_rotation": rows["peak"],
            "peak_ratio": rows["peak_ratio"],
            "stop_time": rows["stop_time"],
        }
        return found | ({"reason": rows["reason"]} if reasons else {})

    result.tables["ensemble"] = (
        StreamedTable(lambda: (columns(*piece) for piece in swept.pieces(*names)), units)
        if swept.on_disk
        else TableData(columns(swept.members, swept.arrays), units)
    )
    result.arrays |= {
        "outcome": Array(swept.column("outcome"), ("member",), "", "outcome: -1 failed, 0 at rest, 1 recovery, 2 collapse"),
        "peak_ratio": Array(swept.column("peak_ratio"), ("member",), "", "greatest rotation divided by the critical rotation"),
        "pga": Array(swept.column("pga", lambda rows: rows / GRAVITY), ("member",), "g"),
        "pgv": Array(swept.column("pgv"), ("member",), "m/s"),
    }


def _column(swept: Swept, name: str) -> Iterator[np.ndarray]:
    """One row of all members, piece by piece."""
    return (rows[name] for _, rows in swept.pieces(name))


def _describe_durations(options: Fragility, base: Rocker, parts: list[tuple[float, Swept]], result: Result) -> None:
    """Mean and deviation of the peak rotation against the duration (Fig. 6-8)."""
    result.status, result.reason = parts[-1][1].status, parts[-1][1].stopped
    initial = base.initial_ratio
    parts = [(d, s) for d, s in parts if len(s.members)]
    rows = [shares(s["outcome"], s["peak_ratio"], options.confidence, initial) for _, s in parts]
    durations = np.array([d for d, _ in parts])
    keys = ("mean_peak_rotation_ratio", "deviation_peak_rotation_ratio", "collapse_probability", "uplift_probability")
    shared: Keys = {k: [row[k] for row in rows] for k in ("confidence_interval", "count", "collapsed", "uplifted")}
    values: Keys = {k: np.array([np.nan if row[k] is None else row[k] for row in rows], dtype=float) for k in keys}
    conditions = _conditions(options, base, [s.arrays for _, s in parts])
    result.warnings += told(conditions["conditions"])
    result.results = out.OverDurations(
        durations_s=durations.tolist(),
        **conditions,
        **values,
        **shared,
        failed=sum(int((s["outcome"] == FAILED).sum()) for _, s in parts),
        confidence=options.confidence,
        restitution=base.restitution,
        critical_rotation_rad=base.critical[0],
        initial_rotation_ratio=initial,
        median_pga_g=[float(np.nanmedian(s["pga"])) / GRAVITY for _, s in parts],
    )
    intervals = np.array([row["confidence_interval"] for row in rows]).reshape(-1, 2)
    result.tables["durations"] = TableData(
        {
            "duration": durations,
            "count": np.array([row["count"] for row in rows]),
            **values,
            "lower": intervals[:, 0],
            "upper": intervals[:, 1],
        },
        {"duration": "s"},
    )
    result.tables["ensemble"] = TableData(
        {
            "duration": np.concatenate([np.full(len(s.members), d) for d, s in parts]),
            "motion": np.concatenate([s.members + 1 for _, s in parts]),
            **{n: np.concatenate([s[n] for _, s in parts]) for n in ("outcome", "peak_ratio", "pga")},
        },
        {"duration": "s", "pga": "m/s^2"},
    )
    result.arrays = {
        "duration": Array(durations, ("duration",), "s", "t_d"),
        **{k: Array(v, ("duration",)) for k, v in values.items()},
        "lower": Array(intervals[:, 0], ("duration",), "", "interval of the collapse probability"),
        "upper": Array(intervals[:, 1], ("duration",)),
    }
    text = "; ".join(
        f"{d:g} s: {100 * row['collapse_probability']:.1f} % collapse, mean rotation {row['mean_peak_rotation_ratio']:.2f}"
        for d, row in zip(durations, rows, strict=True)
        if row["count"]
    )
    result.answer = (
        f"Results for each duration of the motion ({(rows[0]['count'] if rows else 0)} motions each), rotations "
        f"divided by the critical rotation (collapse counts as 1): {text}."
    )
