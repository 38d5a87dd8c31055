"""assessment: the primary impulse of the motion against the failure curve of the arch (thesis 5.4.2, Fig. 5-15)."""

from typing import Any

import numpy as np

from extrados.analyses.context import Context, Refused
from extrados.analyses.rocking.common import rocker_of
from extrados.analyses.rocking.conditions import Counted, astray_of, of_many, rows_of, told
from extrados.analyses.rocking.criterion import CAP, Fit, fit_own, interpolated
from extrados.analyses.rocking.doubts import DIFFER
from extrados.analyses.rocking.tables import Assessment
from extrados.core.rocking import FAILED, OUTCOMES, Outcome, ensemble
from extrados.model.errors import WHOLE
from extrados.motions.impulse import Impulse, primary_impulses
from extrados.motions.tables import SinePulse
from extrados.results import rocking as out
from extrados.results.fields import given
from extrados.results.model import Array, Result, TableData
from extrados.schema.constants import GRAVITY
from extrados.views.rockers.arch import ArchModel
from extrados.views.rockers.rocker import Rocker

#: After the motion it rocks itself to rest within this many of its own time units.
SETTLE = 40.0
#: Columns of assessment.csv
COLUMNS = (
    "rank",
    "amplitude_g",
    "period_s",
    "start_s",
    "explained",
    "goodness_of_fit",
    "failing_amplitude_g",
    "failing_amplitude_own_g",
    "margin",
    "verdict",
)


def run(context: Context, options: Assessment) -> Result:
    """Verdict and margin by Eq. 5.8, from the regenerated Table 5.3 and from the arch's own failure curve."""
    rocker = rocker_of(context, options)
    arch = rocker.model.arch if isinstance(rocker.model, ArchModel) else None
    if context.motion.ground.channels > 1:
        context.warnings.append("The criterion covers the horizontal motion only; the vertical component is neglected.")
    gamma, scale = rocker.uplift, rocker.scale
    time, acceleration = context.motion.series()
    impulses = primary_impulses(time, acceleration, options.impulses, options.min_period, options.max_period)
    try:
        own, own_periods, own_curve = fit_own(rocker.body, gamma, scale, context.threads, context=context)
    except ValueError as error:
        raise Refused(f"no failure curve for single sines could be fitted: {error}", WHOLE) from None
    result = Result("assessment")
    # The table was made of arches with the thesis' impact rule: anything else is judged by its own curve.
    table = None
    by_table = isinstance(rocker.model, ArchModel) and rocker.model.rule == "thesis"
    ratio = embrace = 0.0
    if arch is not None and by_table:
        ratio, embrace = arch.thickness / arch.radius, float(np.degrees(arch.embrace))
        table = interpolated(ratio, embrace, gamma)
    if by_table and table is None:
        result.warnings.append(
            "Table 5.3 of the thesis covers t/R from 0.12 to 0.21 and an embrace of 140 to 180 deg. This "
            f"arch has t/R {ratio:.3f} and {embrace:g} deg, so only the failure curve fitted to this arch is used"
        )
    fit = table or own
    rows = [_row(k + 1, impulse, fit, own, scale) for k, impulse in enumerate(impulses)]
    run_outcome, conditions = _run_through(context, rocker)
    by_rule = _by_rule(context, rocker, impulses)
    worst = min(rows, key=lambda r: np.inf if r.margin is None else r.margin, default=None)
    at_margin = [] if conditions["conditions"].violated else _at_margin(context, rocker, worst.margin if worst else None)
    r = out.Assessment(
        uplift_acceleration_g=gamma,
        peak_ground_acceleration_g=context.motion.peak / GRAVITY,
        static_verdict="fails" if context.motion.peak > gamma * GRAVITY else "stands",
        coefficients=_coefficients(fit),
        coefficients_source="Table 5.3, regenerated and interpolated" if table else f"fitted to this {rocker.word}",
        coefficients_of_this_arch=_coefficients(own),
        restitution=rocker.restitution,
        impulses=rows,
        verdict="fails" if any(row.verdict == "fails" for row in rows) else "stands",
        run_outcome=run_outcome,
        margin=worst.margin if worst else None,
        **conditions,
        **given(margins_by_rule=by_rule or None),
        violated=_undecided(by_rule),
        margin_conditions=at_margin,
        primary_impulse=out.PrimaryImpulse(**{k: rows[0][k] for k in out.PrimaryImpulse.model_fields}) if rows else None,
    )
    result.results = r
    result.warnings += [*told(r.conditions), *at_margin, *_undecided(by_rule)]
    result.warnings += _limits_of_criterion(context, r)
    result.tables["assessment"] = TableData(
        {name: [np.nan if row[name] is None else row[name] for row in rows] for name in (COLUMNS if rows else ())}
    )
    periods = np.geomspace(0.12, 1.6, 200) * np.sqrt(scale)
    result.arrays = {
        "time": Array(time, ("time",), "s"),
        "ground": Array(acceleration, ("time",), "m/s^2", "ground acceleration"),
        "impulse_amplitude": Array(np.array([i.amplitude for i in impulses]), ("impulse",), "m/s^2"),
        "impulse_period": Array(np.array([i.period for i in impulses]), ("impulse",), "s"),
        "impulse_start": Array(np.array([i.start for i in impulses]), ("impulse",), "s"),
        "period": Array(periods, ("period",), "s"),
        "failing_amplitude": Array(fit.amplitude(periods, scale), ("period",), "g", "Eq. 5.8"),
        "failing_amplitude_own": Array(
            own.amplitude(periods, scale), ("period",), "g", f"Eq. 5.8 of the thesis, fitted to this {rocker.word}"
        ),
        "computed_period": Array(own_periods * np.sqrt(scale), ("computed",), "s"),
        "computed_amplitude": Array(own_curve, ("computed",), "g", "Mode I failure curve calculated for this structure"),
    }
    result.answer = _answer(r, worst, rocker.word)
    return result


def _limits_of_criterion(context: Context, r: out.Assessment) -> list[str]:
    """Warnings: impulses beyond the criterion, a run that contradicts it, a motion that is no single sine."""
    warnings, rows = [], r.impulses
    gamma = r.uplift_acceleration_g
    beyond = [row for row in rows if row.verdict == "stands" and abs(row.amplitude_g) > CAP * gamma]
    if beyond:
        warnings.append(
            f"the criterion follows the failure curve up to {CAP:g} times the acceleration that starts rocking "
            f"({CAP * gamma:.3g} g). An impulse of this motion exceeds this range ({abs(beyond[0].amplitude_g):.3g} "
            f"g over {beyond[0].period_s:.3g} s) and may cause collapse in one swing: use `failure-domain`"
        )
    if r.run_outcome is not None and (r.verdict == "fails") != (r.run_outcome == "collapse"):
        why = (
            "the criterion does not cover impulses of this amplitude"
            if beyond
            else "the criterion covers a single impulse, not the motion before and after this impulse"
        )
        warnings.append(
            f"the criterion predicts that the structure {r.verdict}, but under the whole motion the structure "
            f"{'collapses' if r.run_outcome == 'collapse' else 'recovers'}: {why}. The run of the whole motion (analysis "
            "`rocking`) is more reliable"
        )
    if rows and (not isinstance(context.deck.motion, SinePulse) or context.deck.motion.floor is not None):
        first = rows[0]
        warnings.append(
            "the criterion was derived for single sines. The strongest impulse of this motion is therefore "
            f"replaced by a sine of {abs(first.amplitude_g):.3g} g and a period of {first.period_s:.3g} s. This sine "
            f"explains {100 * first.goodness_of_fit:.0f} % of the squared acceleration over its duration"
        )
    return warnings


def _run_through(context: Context, rocker: Rocker, factor: float = 1.0) -> tuple[Outcome | None, dict[str, Any]]:
    """Outcome of the whole motion times a factor by the equation of motion, None where the run gave none; the conditions under it."""
    end = context.motion.end + SETTLE * rocker.time_unit
    found = ensemble([rocker.body], [context.motion.ground], [0], [0], factor, end, start_rotation=rocker.start_rotation)
    place = int(found.outcome[0])
    rows = {"outcome": found.outcome, **rows_of(found.joints, found.half_cycles, astray_of(rocker))}
    conditions = of_many(rocker, Counted.of([rows]), "motions")
    return None if found.interrupted or place == FAILED else OUTCOMES[place], conditions


def _at_margin(context: Context, rocker: Rocker, margin: float | None) -> list[str]:
    """Conditions that do not hold under the motion times the margin, where that is beyond the motion itself: what holds at the
    motion need not hold at the margin."""
    if margin is None or margin <= 1.0:
        return []
    _, found = _run_through(context, rocker, margin)
    return [
        (
            f"The safety factor is conditional: under {margin:.3g} times the motion, an assumption of the rocking "
            f"analysis is violated. {text}"
        )
        for text in found["conditions"].violated
    ]


def _by_rule(context: Context, rocker: Rocker, impulses: list[Impulse]) -> dict[str, float | None]:
    """Least margin by each impact rule, where their c_v differ by more than DIFFER; a rule whose curve cannot be fitted is left out."""
    found: dict[str, float | None] = {}
    for rule, (_, body) in rocker.rivals(DIFFER).items():
        try:
            own, _, _ = fit_own(rocker.held(body), rocker.uplift, rocker.scale, context.threads, context=context)
        except ValueError:
            continue
        margins = [float(own.amplitude(i.period, rocker.scale)) * GRAVITY / abs(i.amplitude) for i in impulses]
        least = min(margins, default=np.inf)
        found[rule] = least if np.isfinite(least) else None
    return found


def _undecided(margins: dict[str, float | None]) -> list[str]:
    """The sentence where impact rules lead to different verdicts."""
    falls = {margin is not None and margin <= 1.0 for margin in margins.values()}
    if len(falls) < 2:
        return []
    each = ", ".join(f'"{rule}" {"none" if margin is None else f"{margin:.3g}"}' for rule, margin in margins.items())
    return [f"The impact rule decides the verdict. Safety factor with each impact rule: {each}."]


def _row(rank: int, impulse: Impulse, fit: Fit, own: Fit, radius: float) -> out.AssessedImpulse:
    """An impulse against the failure curves; an infinite failing amplitude becomes None."""
    needed = float(fit.amplitude(impulse.period, radius))
    amplitude = abs(impulse.amplitude) / GRAVITY
    return out.AssessedImpulse(
        rank=rank,
        amplitude_g=impulse.amplitude / GRAVITY,
        period_s=impulse.period,
        start_s=impulse.start,
        explained=impulse.explained,
        goodness_of_fit=impulse.goodness,
        failing_amplitude_g=needed,
        failing_amplitude_own_g=float(own.amplitude(impulse.period, radius)),
        margin=needed / amplitude,
        verdict="fails" if amplitude >= needed else "stands",
    )


def _coefficients(fit: Fit) -> out.Coefficients:
    return out.Coefficients(C1=fit.c1, C2=fit.c2, T_min_s=fit.t_min, gamma=fit.gamma)


def _answer(r: out.Assessment, worst: out.AssessedImpulse | None, what: str) -> str:
    first = r.primary_impulse
    if worst is None or first is None:
        return "In the given range of periods, the motion contains no impulse: the motion is too short, or zero."
    text = (
        f"The primary impulse of the motion is a sine with an amplitude of {abs(first.amplitude_g):.3f} g and "
        f"a period of {first.period_s:.3f} s, starting at {first.start_s:.2f} s. "
    )
    which = "the primary impulse" if worst.rank == 1 else f"impulse {worst.rank} ({abs(worst.amplitude_g):.3f} g, {worst.period_s:.3f} s)"
    if worst.margin is None:
        text += f"Predicted for the {what}: no collapse. All impulses of the motion are too short to cause collapse. "
    elif r.verdict == "fails":
        text += (
            f"Predicted for the {what}: collapse. The amplitude of {which} is {1 / worst.margin:.2f} times the amplitude that "
            "causes collapse. "
        )
    else:
        text += (
            f"Predicted for the {what}: no collapse. The amplitude of {which} would have to be {worst.margin:.2f} times larger to "
            "cause collapse. "
        )
    also = "also " if r.static_verdict == r.verdict else ""
    static = "collapse" if r.static_verdict == "fails" else "no collapse"
    return (
        f"{text}Limit analysis with the peak acceleration of {r.peak_ground_acceleration_g:.3f} g as a constant horizontal acceleration "
        f"(collapse acceleration {r.uplift_acceleration_g:.3f} g) {also}predicts {static}."
    )
