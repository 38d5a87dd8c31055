"""failure-curves: several structures, or trains of sines, and the primary impulses of motions (thesis Figs 5-4, 5-5, 5-15)."""

import itertools
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any, Literal

import numpy as np

from extrados.analyses.batches import computed
from extrados.analyses.context import Context, Refused
from extrados.analyses.motion_source import source_of
from extrados.analyses.rocking import criterion
from extrados.analyses.rocking.conditions import Counted, astray_of, of_many
from extrados.analyses.rocking.doubts import DIFFER, OFTEN, too_fast
from extrados.analyses.rocking.failure_domain import LowestAmplitudes, curves_by_rule, natural_durations, warned
from extrados.analyses.rocking.needs import structures_of
from extrados.analyses.rocking.tables import FailureCurves
from extrados.core.rocking import FAILED, OUTCOMES, Body, Outcome, ensemble
from extrados.limit.errors import CannotStand
from extrados.model.errors import BadGeometry
from extrados.motions.impulse import Impulse, primary_impulses
from extrados.motions.motion import Motion
from extrados.results import rocking as out
from extrados.results.model import Array, Result, TableData
from extrados.schema.constants import GRAVITY
from extrados.schema.quantities import unit_of
from extrados.schema.table import Table
from extrados.views.rockers.arch import ArchModel
from extrados.views.rockers.rocker import Rocker

#: After a motion a structure rocks itself to rest within this many of its natural times.
SETTLE = 40.0


@dataclass(frozen=True)
class Variant:
    """A structure with its name in the picture, and how many cycles its pulses have."""

    label: str
    rocker: Rocker
    cycles: int

    @property
    def natural(self) -> float:
        """Time by which durations scale [s]: sqrt(R/g) of an arch, 2.5/p of a block."""
        return float(np.sqrt(self.rocker.scale / GRAVITY))

    @property
    def settle(self) -> float:
        """How long it may rock on after a pulse [s]."""
        return SETTLE * self.natural


@dataclass(frozen=True)
class Shaken:
    """A motion of the deck and its primary impulse."""

    name: str
    motion: Motion
    impulse: Impulse


def run(context: Context, options: FailureCurves) -> Result:
    """The curve of each variant, the verdicts it gives on the motions, and what the motions do."""
    variants = _variants(context, options)
    curves = [_curve(context, options, variant) for variant in variants]
    # The curves are those of single pulses: only single sines stand for the impulses of motions.
    shaken = _motions(context, options) if context.deck.motion is not None and options.pulse == "sine" else []
    fits = [_fits(context, v, d, a) for v, (d, a, _) in zip(variants, curves, strict=True)] if options.fits else []
    for (*_, holds), fit in zip(curves, fits, strict=False):
        holds |= {name: found for name, (found, _) in fit.items()}
    rows = [_row(variant, *curve, shaken) for variant, curve in zip(variants, curves, strict=True)]
    pairs = [
        (by_curve == "fails") == (by_run == "collapse")
        for row in rows
        for by_curve, by_run in zip(row.curve_verdicts, row.run_outcomes, strict=True)
        if by_curve is not None and by_run is not None
    ]
    result = Result("failure-curves")
    r = result.results = out.FailureCurves(
        pulse=options.pulse,
        curves=rows,
        impulses=[
            out.MotionImpulse(
                name=s.name,
                amplitude_g=s.impulse.amplitude / GRAVITY,
                period_s=s.impulse.period,
                start_s=s.impulse.start,
                goodness_of_fit=s.impulse.goodness,
                peak_ground_acceleration_g=s.motion.peak / GRAVITY,
            )
            for s in shaken
        ],
        agreement=float(np.mean(pairs)) if pairs else None,
        scaling_misfit=_misfit(variants, [(d, a) for d, a, _ in curves]),
    )
    if r.agreement is not None and r.agreement < 1.0:
        result.warnings.append(
            f"{pairs.count(False)} of {len(pairs)} verdicts by the curves differ from the runs under the whole motion. A curve covers a "
            "single impulse, not the motion before and after it. Use the outcomes of the runs"
        )
    longest = max(len(d) for d, _, _ in curves)
    padded = [np.array([np.append(np.asarray(c[k]), np.full(longest - len(c[k]), np.nan)) for c in curves]) for k in (0, 1)]
    result.arrays = {
        "duration": Array(padded[0], ("curve", "point"), "s", "duration t_p of step and rectangular pulses, period T_p of other pulses"),
        "amplitude": Array(padded[1], ("curve", "point"), "g", "lowest amplitude of collapse"),
        "natural_time": Array(np.array([v.rocker.time_unit if _slender(v) else v.natural for v in variants]), ("curve",), "s"),
        "slender": Array(np.array([_slender(v) for v in variants]), ("curve",), "", "true of a block"),
    }
    for name, about in (("fit", "Eq. 5.5 of the thesis, fitted to each failure curve"), ("criterion", "Eq. 5.8 with Table 5.3")):
        if any(name in fit for fit in fits):
            lines = [fit[name][1](padded[0][k]) if name in fit else np.full(longest, np.nan) for k, fit in enumerate(fits)]
            result.arrays[name] = Array(np.array(lines), ("curve", "point"), "g", about)
    result.tables["failure_curves"] = TableData(
        {
            "curve": np.repeat([v.label for v in variants], [len(d) for d, _, _ in curves]),
            "duration": np.concatenate([d for d, _, _ in curves]),
            "amplitude": np.concatenate([a for _, a, _ in curves]),
        },
        {"duration": "s", "amplitude": "g"},
    )
    if shaken:
        result.tables["impulses"] = TableData(
            {
                "motion": [s.name for s in shaken for _ in rows],
                "curve": [row.label for _ in shaken for row in rows],
                "amplitude": [abs(s.impulse.amplitude) / GRAVITY for s in shaken for _ in rows],
                "period": [s.impulse.period for s in shaken for _ in rows],
                **{
                    name: [getattr(row, name)[k] or "" for k in range(len(shaken)) for row in rows]
                    for name in ("static_verdicts", "curve_verdicts", "run_outcomes")
                },
            },
            {"amplitude": "g", "period": "s"},
        )
    result.answer = _answer(r)
    for row in rows:
        told = f"{row.label}: " if len(rows) > 1 else ""
        result.warnings += [told + text for text in warned(row)]
    return result


def _fits(
    context: Context, variant: Variant, durations: np.ndarray, amplitudes: np.ndarray
) -> dict[str, tuple[out.CurveFit, Callable[[np.ndarray], np.ndarray]]]:
    """Eq. 5.5 fitted to the curve of an arch ("fit") and Eq. 5.8 by Table 5.3 ("criterion"), each with its amplitudes [g] over
    periods [s]; a warning states the one that is not possible."""
    model = variant.rocker.model
    if not isinstance(model, ArchModel):
        raise Refused(
            f"the key `fits` is only for arches, and this structure is a {variant.rocker.word}: remove `fits`", ("analysis", "fits")
        )
    gamma, arch = model.collapse[0].gamma, model.arch
    ratio, embrace = arch.thickness / arch.radius, float(np.degrees(arch.embrace))
    found: dict[str, tuple[criterion.Fit, float]] = {}
    try:
        found["fit"] = criterion.fit(durations, amplitudes, gamma), 1.0
    except ValueError as error:
        context.warnings.append(f"{variant.label}: Eq. 5.5 of the thesis (amplitude over duration at collapse) cannot be fitted: {error}")
    table = criterion.interpolated(ratio, embrace, gamma)
    if table is None:
        context.warnings.append(
            f"{variant.label}: Table 5.3 of the thesis covers t/R from 0.12 to 0.21 and an embrace of 140 to "
            f"180 deg. This arch has t/R {ratio:.3f} and {embrace:g} deg"
        )
    else:
        found["criterion"] = table, arch.radius
    near = (amplitudes > criterion.FLOOR * gamma) & (amplitudes < criterion.CAP * gamma)
    made: dict[str, tuple[out.CurveFit, Callable[[np.ndarray], np.ndarray]]] = {}
    for name, (f, radius) in found.items():
        amplitude = partial(f.amplitude, radius=radius)
        misfit = np.abs(amplitude(durations[near]) / amplitudes[near] - 1.0)
        made[name] = (
            out.CurveFit(c1=f.c1, c2=f.c2, t_min_s=f.t_min, gamma_g=f.gamma, greatest_misfit=float(misfit.max()) if near.any() else None),
            amplitude,
        )
    return made


def _slender(variant: Variant) -> bool:
    return variant.rocker.what in ("block", "column")


def _variants(context: Context, options: FailureCurves) -> list[Variant]:
    """One for each change of the structure and number of cycles."""
    building, linear = context.building, options.form == "linear"
    found = []
    names = list(dict.fromkeys(name for change in options.variants for name in change))
    for number, structure in enumerate(structures_of(context, options)):
        try:
            rocker = building.apart().having(structure=structure).rocker(linear, options.soft_base)
        except BadGeometry as error:
            key = ("analysis", "variants", number) if options.variants else error.at
            raise Refused(f"variant {number + 1}: {error}" if options.variants else str(error), key) from None
        except CannotStand as error:
            if not options.variants:
                raise
            raise Refused(f"variant {number + 1} cannot stand: {error}", ("analysis", "variants", number)) from None
        parts = [_said(structure, name) for name in names]
        told = f"{', '.join(parts)}: " if parts else ""
        context.warnings += [told + warning for warning in rocker.warnings]
        limit = rocker.model.fastest_beat if isinstance(rocker.model, ArchModel) else None
        if limit is not None and max(options.cycles) >= OFTEN:
            context.warnings.append(f"{told}trains of sines repeat impacts regularly: {too_fast(limit)}")
        for cycles in options.cycles:
            of_train = [f"{cycles} cycle{'s' if cycles > 1 else ''}"] if len(options.cycles) > 1 else []
            found.append(Variant(", ".join(parts + of_train) or rocker.word, rocker, cycles))
    return found


def _said(structure: Table, path: str) -> str:
    """A key of a structure, dotted for one of a table within it, with its value and unit."""
    place: Any = structure
    *way, last = path.split(".")
    for part in way:
        place = place[int(part)] if isinstance(place, list) else getattr(place, part)
    within: Table = place
    value = getattr(within, last)
    number = f"{value:g}" if isinstance(value, float) else str(value)
    return f"{last.replace('_', ' ')} {number} {unit_of(type(within), last)}".rstrip()


def _curve(context: Context, options: FailureCurves, variant: Variant) -> tuple[np.ndarray, np.ndarray, dict[str, Any]]:
    """Durations [s], ascending, the lowest failing amplitudes [g], NaN where none below the cap, and what holds of them."""
    given = options.durations
    durations = np.sort(given) if given else natural_durations(variant.natural, options.pulse, options.count)
    amplitudes = np.linspace(0.0, options.max_amplitude, options.amplitudes + 1)[1:]
    rocker = variant.rocker

    def job(body: Body) -> LowestAmplitudes:
        return LowestAmplitudes(
            body,
            options.pulse,
            durations,
            amplitudes,
            variant.settle,
            options.accuracy * GRAVITY,
            rocker.start_rotation,
            variant.cycles,
            astray_of(rocker),
        )

    found = computed(context, "failure-curves", job(rocker.body), len(durations), f"failure curve of {variant.label}", context.threads)
    slides, strays = (found[name] / GRAVITY for name in ("slides_from", "strays_from"))
    counted = Counted(len(durations), int(np.isfinite(slides).sum()), int(np.isfinite(strays).sum()), float(found["friction"].max()))
    rivals = {rule: (c_v, job(rocker.held(body))) for rule, (c_v, body) in rocker.rivals(DIFFER).items()}
    holds = {
        "sliding_from_g": slides,
        "hinges_elsewhere_from_g": strays,
        **of_many(rocker, counted, "durations"),
        **curves_by_rule(context, rivals, len(durations)),
    }
    return durations, found["amplitude"] / GRAVITY, holds


def _motions(context: Context, options: FailureCurves) -> list[Shaken]:
    """The motions of the deck with their primary impulses; what cannot be read or holds no impulse is told."""
    source, known = source_of(context, None)
    grounds = source.grounds(0, min(options.motions, known or options.motions), context.threads)
    names = getattr(source, "names", None) or [f"motion {k + 1}" for k in range(len(grounds))]
    found = []
    for name, ground in zip(names, grounds, strict=False):
        if isinstance(ground, str):
            context.warnings.append(f"{name} is not considered: {ground}")
            continue
        motion = Motion(name, ground)
        impulses = primary_impulses(*motion.series(), 1, None, options.max_period)
        if impulses:
            found.append(Shaken(name, motion, impulses[0]))
        else:
            context.warnings.append(f"{name} is not considered, because it contains no impulse")
    return found


def _row(variant: Variant, durations: np.ndarray, amplitudes: np.ndarray, holds: dict[str, Any], shaken: list[Shaken]) -> out.FailureCurve:
    rocker = variant.rocker
    outcomes: list[Outcome | None] = []
    if shaken:
        each = np.arange(len(shaken))
        ends = np.array([s.motion.end for s in shaken]) + variant.settle
        e = ensemble([rocker.body], [s.motion.ground for s in shaken], 0 * each, each, 1.0, ends, start_rotation=rocker.start_rotation)
        outcomes = [None if place == FAILED else OUTCOMES[place] for place in e.outcome]
    return out.FailureCurve(
        label=variant.label,
        durations_s=durations.tolist(),
        amplitudes_g=amplitudes.tolist(),
        uplift_acceleration_g=rocker.uplift,
        restitution=rocker.restitution,
        natural_time_s=rocker.time_unit if _slender(variant) else variant.natural,
        cycles=variant.cycles,
        static_verdicts=["fails" if s.motion.peak > rocker.uplift * GRAVITY else "stands" for s in shaken],
        curve_verdicts=[_against(durations, amplitudes, s.impulse) for s in shaken],
        run_outcomes=outcomes,
        **holds,
    )


def _against(durations: np.ndarray, amplitudes: np.ndarray, impulse: Impulse) -> Literal["stands", "fails"] | None:
    """Verdict of a curve on an impulse; None where its period lies outside. Above the cap of the curve nothing fails."""
    if not durations[0] <= impulse.period <= durations[-1]:
        return None
    needed = float(np.interp(impulse.period, durations, np.where(np.isfinite(amplitudes), amplitudes, np.inf)))
    return "fails" if abs(impulse.amplitude) / GRAVITY >= needed else "stands"


def _misfit(variants: list[Variant], curves: list[tuple[np.ndarray, np.ndarray]]) -> float | None:
    """Greatest relative difference of two curves over natural times and uplift; None where trains differ.

    Curves are compared where both have an amplitude, on the durations of the first.
    """
    if len(variants) < 2 or len({v.cycles for v in variants}) > 1:
        return None
    scaled = [(d / v.natural, a / v.rocker.unit_acceleration) for v, (d, a) in zip(variants, curves, strict=True)]
    worst = 0.0
    for (d0, a0), (d1, a1) in itertools.combinations(scaled, 2):
        inside = (d0 >= d1[0] * (1 - 1e-9)) & (d0 <= d1[-1] * (1 + 1e-9))
        other = np.interp(d0[inside], d1, a1)
        both = np.isfinite(a0[inside]) & np.isfinite(other)
        worst = max(worst, float(np.abs(other / a0[inside] - 1.0)[both].max(initial=0.0)))
    return worst


def _answer(r: out.FailureCurves) -> str:
    parts = []
    for c in r.curves:
        failing = [a for a in c.amplitudes_g if a is not None]
        low = f"collapses from {min(failing):.3f} g on" if failing else "no amplitude up to `max_amplitude` causes collapse"
        parts.append(f"{c.label}: rocking starts at {c.uplift_acceleration_g:.3f} g, {low}")
    text = f"Failure curves of {r.pulse} pulses. {'; '.join(parts)}."
    if r.scaling_misfit is not None:
        text += (
            " If durations are divided by the natural time and amplitudes by the uplift acceleration, the curves differ by "
            f"at most {100.0 * r.scaling_misfit:.2f} %."
        )
    if r.impulses:
        told = []
        for c in r.curves:
            falls = sum(o == "collapse" for o in c.run_outcomes)
            above = sum(v == "fails" for v in c.curve_verdicts)
            static = sum(v == "fails" for v in c.static_verdicts)
            told.append(
                f"{c.label}: {static} if the peak acceleration acts constantly, {above} by the failure curve, "
                f"{falls} in a run of the whole motion"
            )
        text += f" Number of motions that cause collapse, of {len(r.impulses)}: {'; '.join(told)}."
    return text
