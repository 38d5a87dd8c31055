"""frame-fragility: probability that a building exceeds its limit states, over motions and uncertain values.

Limit states: `strength`, all piers of a storey of a wall at their strength; `first-limit`, the first pier beyond its drift
limit; `collapse`, all piers of a storey of a wall beyond their drift limits, or no equilibrium (of pushovers also a loss of
20 % of the base shear).
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.stats import norm

from extrados.analyses.batches import Swept, stacked, sweep
from extrados.analyses.codes import capacity_curve as cc
from extrados.analyses.codes.actions import code_of, spectrum_of_motion
from extrados.analyses.context import Context, Refused
from extrados.analyses.frame.history import AFTER, control_of, damped
from extrados.analyses.frame.modes import NoEquilibrium, modes_of, rest_of, way_of
from extrados.analyses.frame.pushover import MODES, pushes_of, row_of, storeys_of
from extrados.analyses.frame.sampled import Sample, sample_of
from extrados.analyses.frame.tables import FrameFragility, FramePushover
from extrados.analyses.frame.verified import capacity_curve_of
from extrados.analyses.motion_source import Source, measures, source_of
from extrados.analyses.sla.curve import Bilinear
from extrados.analyses.statistics import likelihood
from extrados.analyses.statistics.likelihood import NoFit
from extrados.analyses.statistics.summaries import wilson
from extrados.core import motion as core_motion
from extrados.core.errors import CoreError
from extrados.core.frame import STATE, Path
from extrados.core.rocking import Ground
from extrados.model.errors import BadGeometry
from extrados.motions.motion import Motion
from extrados.results import frame as out
from extrados.results.model import Array, Result, TableData
from extrados.schema.constants import GRAVITY
from extrados.views.frame.frame import EquivalentFrame

STATES: tuple[out.FrameLimitState, ...] = ("strength", "first-limit", "collapse")
#: Of the greatest drift over all motions: the median, and what a normal variable has at one deviation
PERCENTILES = (16, 50, 84)
#: Motions without a count of their own; points of a curve
MOTIONS, GRID = 100, 200
UNSTABLE = "the frame has no equilibrium under its own weight"


@dataclass(frozen=True)
class Histories:
    """Member k is motion k // L at level k % L, L the number of levels, on the building of that motion; without levels the motions
    stay as they are."""

    sample: Sample
    options: FrameFragility
    source: Source

    def run(self, first: int, count: int, threads: int) -> dict[str, np.ndarray]:
        """Whether each limit state is exceeded (3), intensity and PGA [g], greatest drift, displacement [m] and base shear [N]; a
        building that does not carry its weight (unstable) exceeds all states."""
        kept: dict[int, EquivalentFrame] = {}  # of the motion whose levels follow one another

        def one(k: int) -> dict[str, np.ndarray]:
            return self._member(k, kept)

        return stacked(one, first, count)

    def _member(self, k: int, kept: dict[int, EquivalentFrame]) -> dict[str, np.ndarray]:
        levels = self.options.levels
        motion, level = divmod(k, 1 if levels is None else len(levels))
        row: dict[str, Any] = {name: np.nan for name in ("intensity", "pga", "drift", "displacement", "shear")}
        row |= {"exceeded": np.zeros(3, np.int8), "unstable": False, "reason": ""}
        (ground,) = self.source.grounds(motion, 1, 1)
        if isinstance(ground, str):
            return _arrays(row | {"reason": ground})
        intensity, peak = intensity_of(ground, self.options)
        if not intensity > 0.0:
            return _arrays(row | {"reason": "the motion is zero"})
        scale = 1.0 if levels is None else levels[level] / intensity
        row |= {"intensity": scale * intensity, "pga": scale * peak}
        try:
            if motion not in kept:
                kept.clear()
                kept[motion] = self.sample.frame(motion)
            row |= _moved(kept[motion], self.options, Motion("", ground), scale)
        except NoEquilibrium:
            row |= {"exceeded": np.ones(3, np.int8), "unstable": True}
        except (Refused, BadGeometry, CoreError) as error:
            row["reason"] = str(error)
        return _arrays(row)


def _arrays(row: dict[str, Any]) -> dict[str, np.ndarray]:
    return {name: np.array(value) for name, value in row.items()}


def _moved(frame: EquivalentFrame, options: FrameFragility, motion: Motion, scale: float) -> dict[str, Any]:
    """Limit states exceeded, greatest drift, displacement and base shear of a frame under a motion times a scale."""
    way = way_of(options.direction)
    time = np.arange(0.0, motion.end + AFTER + 0.5 * options.time_step, options.time_step)
    with frame.core() as core:
        _, damping = damped(frame, core, options)
        path = core.move(frame.unit(way), scale * motion.sample(time), options.time_step, damping)
    if path.stop == "no equilibrium under the weight":
        raise NoEquilibrium(UNSTABLE, ("structure", "walls"))
    return {
        "exceeded": np.array(exceeded(frame, path, way), np.int8),
        "drift": float(path.drift[:, frame.piers_at].max()),
        "displacement": float(np.abs(control_of(frame, path, way)).max()),
        "shear": float(np.abs(path.shear).max()),
    }


def exceeded(frame: EquivalentFrame, path: Path, way: np.ndarray) -> list[bool]:
    """Whether a motion exceeds each of STATES."""
    last = path.state.max(axis=0)
    groups = [own for _, _, own in storeys_of(frame, way)]
    lost = path.stop != "target displacement"
    limit = STATE["failed_flexure"]
    return [
        lost or any((last[own] >= STATE["flexure"]).all() for own in groups),
        lost or bool((last[frame.piers_at] >= limit).any()),
        lost or any((last[own] >= limit).all() for own in groups),
    ]


def intensity_of(ground: Ground, options: FrameFragility) -> tuple[float, float]:
    """The measure of a motion, and its peak acceleration [g]."""
    sa = None if options.sa_period is None else (options.sa_period, cc.DAMPING)
    found = measures([ground], sa, 1)
    return float(found[options.intensity][0]) / GRAVITY, float(found["pga"][0]) / GRAVITY


@dataclass(frozen=True)
class Curves:
    """Member k gives the capacity curves of building k of the sample: of each push the values of an equivalent oscillator."""

    sample: Sample
    options: FrameFragility

    def run(self, first: int, count: int, threads: int) -> dict[str, np.ndarray]:
        """oscillator (pushes, 4): T* [s], F_y*/m* [m/s^2], d_y* [m], Gamma; capacity (pushes, 3): d [m] of STATES, NaN where a push
        has no rising branch, 0 of a building that does not carry its weight; greatest base shear [N]."""
        return stacked(self._member, first, count)

    def _member(self, k: int) -> dict[str, np.ndarray]:
        count = 2 * len(self.options.patterns)
        row = {"oscillator": np.full((count, 4), np.nan), "capacity": np.full((count, 3), np.nan)}
        more = {"shear": np.full(count, np.nan), "reason": np.array("")}
        try:
            frame = self.sample.frame(k)
            for i, (curve, oscillator) in enumerate(pushed(frame, self.options)):
                more["shear"][i] = curve.force.max(initial=0.0)
                if oscillator is None:
                    more["reason"] = np.array(f"pushover {i + 1} of {count} has no rising branch")
                    continue
                law = oscillator.law
                row["oscillator"][i] = (
                    oscillator.period,
                    law.yield_load / oscillator.mass,
                    law.yield_displacement,
                    oscillator.participation,
                )
                row["capacity"][i] = [min(curve.limits.get(k, np.inf), curve.ultimate) for k in ("strength", "first", "drift")]
        except NoEquilibrium:
            row["capacity"][:] = 0.0
        except (Refused, BadGeometry, CoreError) as error:
            more["reason"] = np.array(str(error))
        return row | more


def pushed(frame: EquivalentFrame, options: FrameFragility) -> list[tuple[cc.CapacityCurve, cc.Oscillator | None]]:
    """Capacity curves of both senses and all patterns, without eccentricity, and their oscillators."""
    given = FramePushover(
        kind="frame-pushover",
        directions=[options.direction],
        patterns=options.patterns,
        eccentricities=[0.0],
        target_drift=options.target_drift,
    )
    level = max(one.level for one in frame.masses)
    target = given.target_drift * float(frame.plan.levels[level])
    found = []
    with frame.core() as core:
        pushes = pushes_of(frame, given, modes_of(frame, rest_of(frame, core).tangent, MODES), level)
        for push in pushes:
            path = core.push(push.forces, push.control, target, given.steps, given.drop)
            if path.stop == "no equilibrium under the weight":
                raise NoEquilibrium(UNSTABLE, ("structure", "walls"))
            row = out.FramePush(**row_of(frame, push, path))
            curve = capacity_curve_of(frame, push, path, row, push.mode.shape)
            found.append((curve, cc.oscillator_of(curve) if path.multiple.max() > 0.0 else None))
    return found


def run(context: Context, options: FrameFragility) -> Result:
    """Curves of all limit states; see the deck reference."""
    if options.uncertain and options.frame.confidence_factor != 1.0:
        raise Refused(
            "uncertain strengths scatter about their mean values, which a confidence factor must not reduce: "
            "remove `confidence_factor` of [analysis.frame]",
            ("analysis", "frame", "confidence_factor"),
        )
    frame = context.building.frame(options.frame)
    context.warnings += frame.remarks + frame.weaknesses
    source, there = source_of(context, options.seed)
    motions = options.count or there or MOTIONS
    sample = sample_of(context.building, options.frame, options.uncertain, motions, options.seed or 0)
    result = Result("frame-fragility")
    if options.by == "pushover":
        _by_pushovers(context, options, sample, source, motions, result)
    else:
        _by_histories(context, options, Histories(sample, options, source), motions, result)
    return result


def _stopped(swept: Swept, result: Result) -> bool:
    """Whether nothing can be made of the finished members; why some are missing."""
    result.status, result.reason = swept.status, swept.stopped
    if not swept.finished:
        result.answer = "No member is finished."
    return not swept.finished


def _tell_lost(reasons: np.ndarray, what: str, result: Result) -> None:
    """Why members have no result."""
    lost = reasons[reasons != ""]
    if len(lost):
        result.warnings.append(f"{len(lost)} of {len(reasons)} {what} have no result. First reason: {lost[0]}")


def _tell_unstable(unstable: np.ndarray, what: str, result: Result) -> None:
    """How many members count as collapsed before any motion; Refused where all do."""
    if unstable.all():
        raise Refused(UNSTABLE, ("structure", "walls"))
    if unstable.any():
        result.warnings.append(
            f"{int(unstable.sum())} of {len(unstable)} {what} have no equilibrium under their own weight: they count as collapsed."
        )


def _by_histories(context: Context, options: FrameFragility, job: Histories, motions: int, result: Result) -> None:
    levels = None if options.levels is None else np.array(sorted(options.levels))
    runs = motions * (1 if levels is None else len(levels))
    if levels is not None:
        job = Histories(job.sample, options.model_copy(update={"levels": levels.tolist()}), job.source)
    swept = sweep(context, "frame-fragility", job, runs, "histories of the frame", slow=True, parallel=True)
    if _stopped(swept, result):
        return
    rows = swept.arrays
    _tell_lost(rows["reason"], "histories", result)
    _tell_unstable(rows["unstable"].astype(bool), "histories", result)
    good = rows["reason"] == ""
    if not good.any():
        raise Refused(f"no time history has a result. First reason: {rows['reason'][0]}", ("motion",))
    x, hit, drift = rows["intensity"][good], rows["exceeded"][good].astype(bool), rows["drift"][good]
    states = []
    for k, state in enumerate(STATES):
        fit, interval = _fitted(x, hit[:, k], levels, swept.members[good], options)
        states.append(_state(state, int(hit[:, k].sum()), int(good.sum()), fit, interval, options))
    more: dict[str, Any] = {}
    if levels is not None:
        at = swept.members[good] % len(levels)
        more["levels_g"] = levels.tolist()
        for p in PERCENTILES:
            more[f"drift_{p}"] = [_percentile(drift[at == j], hit[at == j, -1], p) for j in range(len(levels))]
        for k, one in enumerate(states):
            share = [float(hit[at == j, k].mean()) if (at == j).any() else None for j in range(len(levels))]
            states[k] = one.model_copy(update={"probability": share})
    _describe(options, states, motions, x, result, histories=int(good.sum()), **more)
    result.tables["histories"] = TableData(
        {
            "motion": swept.members[good] // (1 if levels is None else len(levels)) + 1,
            "intensity": x,
            "pga": rows["pga"][good],
            "drift": drift,
            "displacement": rows["displacement"][good],
            "base_shear": rows["shear"][good],
            "limit_state": last_exceeded(hit),
        },
        {"intensity": "g", "pga": "g", "displacement": "m", "base_shear": "N"},
    )
    result.arrays |= {
        "intensity": Array(x, ("run",), "g", "intensity of each history"),
        "drift": Array(drift, ("run",), "", "greatest drift (chord rotation) of a pier"),
        "exceeded": Array(hit.astype(np.int8), ("run", "limit_state"), "", "1: the limit state is exceeded"),
    }


def last_exceeded(hit: np.ndarray) -> np.ndarray:
    """Of exceeded states (runs, 3) the last of STATES, "" without one. They are not nested: a pier may reach its drift limit
    before a storey its strength."""
    return np.array(["", *STATES])[(hit * np.arange(1, 4)).max(axis=1)]


def _percentile(drift: np.ndarray, fell: np.ndarray, percent: float) -> float | None:
    """Drift that so many percent of the motions stay within; None where that is a collapsed frame, or there is no motion."""
    if not len(drift):
        return None
    found = float(np.quantile(np.where(fell, np.inf, drift), percent / 100.0, method="inverted_cdf"))
    return found if np.isfinite(found) else None


def _fitted(
    x: np.ndarray, hit: np.ndarray, levels: np.ndarray | None, members: np.ndarray, options: FrameFragility
) -> tuple[tuple[float, float] | None, tuple[float, float] | None]:
    """Median and dispersion of the curve of greatest likelihood, and an interval of the median; None where the runs determine
    none. Of levels a bootstrap of motions, each with all its levels; else the profile likelihood."""
    try:
        if levels is None:
            seen = likelihood.stripes(x, hit.astype(float), np.ones(len(x)))
            found = likelihood.fit(seen)
            low, high = likelihood.region(seen, found, options.confidence).median
            return (found.median, found.dispersion), (float(low), float(high))
        motion, at = np.divmod(members, len(levels))
        hits, count = np.bincount(at, hit, len(levels)), np.bincount(at, minlength=len(levels))
        found = likelihood.fit_stripes(levels, hits, count)
        if not options.bootstrap:
            return (found.median, found.dispersion), None
        _, row = np.unique(motion, return_inverse=True)
        over, valid = np.zeros((row.max() + 1, len(levels)), bool), np.zeros((row.max() + 1, len(levels)), bool)
        over[row, at], valid[row, at] = hit, True
        draws = likelihood.bootstrap(levels, over, valid, options.bootstrap, options.confidence, options.seed or 0)
        low, high = draws.interval(draws.median)
        return (found.median, found.dispersion), (float(low), float(high))
    except NoFit:
        return None, None


def _state(
    name: out.FrameLimitState,
    count: int,
    runs: int,
    fit: tuple[float, float] | None,
    interval: tuple[float, float] | None,
    options: FrameFragility,
) -> out.FrameLimitCurve:
    low, high = wilson(count, runs, options.confidence)
    known = interval is not None and bool(np.isfinite(interval).all())
    return out.FrameLimitCurve(
        limit_state=name,
        exceeded=count,
        share=count / runs,
        share_interval=[float(low), float(high)],
        median_g=None if fit is None else fit[0],
        dispersion=None if fit is None else fit[1],
        median_interval_g=list(interval) if known and interval is not None else None,
    )


def _by_pushovers(context: Context, options: FrameFragility, sample: Sample, source: Source, motions: int, result: Result) -> None:
    buildings = len(sample.draws)
    swept = sweep(context, "frame-curves", Curves(sample, options), buildings, "capacity curves", slow=True, parallel=True)
    if _stopped(swept, result):
        return
    if not swept.complete:
        result.answer = (
            f"{swept.finished} of {buildings} sampled buildings have a capacity curve. Fragility curves require those of all buildings."
        )
        return
    rows = swept.arrays
    _tell_lost(rows["reason"], "buildings", result)
    _tell_unstable((rows["capacity"] == 0.0).all(axis=(1, 2)), "buildings", result)
    grounds = source.grounds(0, motions, context.threads)
    _tell_lost(np.array([g if isinstance(g, str) else "" for g in grounds]), "motions", result)
    found = [(k, g) for k, g in enumerate(grounds) if not isinstance(g, str)]
    carried = np.array([_carried(g, options, rows, k % buildings) for k, g in found]).reshape(-1, 3)
    good = np.isfinite(carried).all(axis=1)
    if good.sum() < 2:
        raise Refused("a fragility curve requires at least two motions for which the building has a capacity curve", ("motion",))
    if not good.all():
        result.warnings.append(
            f"{int((~good).sum())} of {len(good)} pairs of motion and building are not considered, because "
            "the pushover gave no capacity curve."
        )
    carried = carried[good]
    half = norm.ppf(0.5 + 0.5 * options.confidence) / np.sqrt(len(carried))
    peak = np.array([intensity_of(g, options)[0] for _, g in found])[good]
    states = []
    for k, state in enumerate(STATES):
        fit, interval = None, None
        # no lognormal variable is 0
        if (carried[:, k] > 0.0).all():
            log = np.log(carried[:, k])
            middle, spread = float(log.mean()), float(log.std(ddof=1))
            fit = float(np.exp(middle)), spread
            interval = float(np.exp(middle - half * spread)), float(np.exp(middle + half * spread))
        hits = int((peak > carried[:, k]).sum())
        states.append(_state(state, hits, len(carried), fit, interval, options))
    more = _knowledge(context, options, sample, rows, [g for _, g in found], result) if options.uncertain else {}
    _describe(options, states, motions, carried.ravel(), result, buildings=buildings, **more)
    result.arrays["carried"] = Array(
        carried, ("run", "limit_state"), "g", "intensity of each motion at which the building reaches a limit state, by the N2 method"
    )
    result.tables["carried"] = TableData(
        {"motion": np.array([k + 1 for k, _ in found])[good], **{s.replace("-", "_"): carried[:, k] for k, s in enumerate(STATES)}},
        {s.replace("-", "_"): "g" for s in STATES},
    )


def _carried(ground: Ground, options: FrameFragility, rows: dict[str, np.ndarray], building: int) -> np.ndarray:
    """Intensity (3) [g] of a motion at which N2 reaches each limit state of a building: the least of its pushes; 0 where it
    does not carry its weight, NaN where a push has no capacity curve."""
    if (rows["capacity"][building] == 0.0).all():
        return np.zeros(3)
    if not np.isfinite(rows["oscillator"][building]).all():
        return np.full(3, np.nan)
    time, values = Motion("", ground).series()
    step, peak = float(time[1] - time[0]), float(np.abs(values).max())
    corner = cc.corner_of(core_motion.response_spectra(values, step, cc.PERIODS, [cc.DAMPING]).psa.reshape(-1))
    spectrum = spectrum_of_motion(values, step, peak)
    factors = []
    for (_, strength, start, gamma), capacity in zip(rows["oscillator"][building], rows["capacity"][building], strict=True):
        oscillator = cc.Oscillator(1.0, gamma, Bilinear(strength / start, strength, start, capacity[2] / gamma))
        factors.append([cc.n2_factor(oscillator, spectrum, corner, d / gamma) for d in capacity])
    return np.asarray(intensity_of(ground, options)[0] * np.min(factors, axis=0))


def _knowledge(
    context: Context, options: FrameFragility, sample: Sample, rows: dict[str, np.ndarray], grounds: list[Ground], result: Result
) -> dict[str, Any]:
    """Where the building whose mean strengths are divided by the confidence factor of the code lies among the sampled ones: the
    share of these that carry less at collapse, under the motion in the middle of the set."""
    factor = code_of(context).factor
    if context.deck.code is None or factor == 1.0:
        return {}
    frame_options = options.frame.model_copy(update={"confidence_factor": factor})
    alone = Sample(sample.building, frame_options, {}, np.zeros((1, 0)))
    design = Curves(alone, options).run(0, 1, context.threads)
    each = [_carried(g, options, design, 0)[2] for g in grounds]
    if not np.isfinite(each).all():
        result.warnings.append(
            f"There is no comparison with the building whose strengths are divided by the confidence factor {factor:.3g}: "
            f"this building has no capacity curve ({design['reason'][0]})."
        )
        return {}
    middle = grounds[int(np.argsort(each)[len(each) // 2])]
    reached = float(_carried(middle, options, design, 0)[2])
    drawn = np.array([_carried(middle, options, rows, k)[2] for k in range(len(sample.draws))])
    share = float((drawn[np.isfinite(drawn)] < reached).mean())
    result.warnings.append(
        f"If all strengths are divided by the confidence factor {factor:.3g}, the building collapses at {reached:.3g} "
        f"g under the median motion. {100 * share:.3g} % of the sampled buildings collapse at a lower intensity."
    )
    return {"confidence_factor": factor, "design_intensity_g": reached, "weaker_share": share}


def _describe(options: FrameFragility, states: list[out.FrameLimitCurve], motions: int, x: np.ndarray, result: Result, **more: Any) -> None:
    """Results, curves and answer."""
    name = "PGA" if options.intensity == "pga" else f"SA({options.sa_period:g} s)"
    result.results = out.FrameFragility(
        method=options.by,
        intensity=name,
        motions=motions,
        limit_states=states,
        confidence=options.confidence,
        uncertain=sorted(options.uncertain),
        **more,
    )
    fits = [(s.limit_state, s.median_g, s.dispersion) for s in states if s.median_g and s.dispersion]
    ends = [float(x.min()), float(x.max()), *(m for _, m, _ in fits)]
    grid = np.linspace(0.0, 1.5 * max(ends), GRID)[1:]
    result.arrays["grid"] = Array(grid, ("grid",), "g", name)
    for state, median, spread in fits:
        values = norm.cdf(np.log(grid / median) / spread)
        result.arrays[f"curve_{state.replace('-', '_')}"] = Array(values, ("grid",), "", f"fitted probability of {state}", "frame_curve")
    for one in states:
        if one.median_g is None:
            result.warnings.append(f"No fragility curve of {one.limit_state} is given, because the runs do not determine it.")
    said = [
        f"{one.limit_state}: median {one.median_g:.3g} g, dispersion {one.dispersion:.2f}"
        if one.median_g is not None
        else f"{one.limit_state}: {one.exceeded} runs exceed it"
        for one in states
    ]
    how = "histories" if options.by == "history" else "pushovers with N2"
    result.answer = f"{motions} motions by {how}, {name}. {'; '.join(said)}."
