"""How sure the outcome of a rocking run is: under the other impact rules, where the blow at all joints is known to lose too
much, and under perturbations of the motion from a millionth to a ten thousandth."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from extrados.analyses.context import Context
from extrados.analyses.rocking.tables import Rocking
from extrados.core.rocking import FAILED, OUTCOMES, Body, Response, arch_body, ensemble, history
from extrados.results.rocking import RuleOutcome
from extrados.views.rockers.arch import ArchModel
from extrados.views.rockers.rocker import Rocker

#: Impact rules whose c_v differ by more than this factor give both outcomes.
DIFFER = 1.3
#: A motion scaled by 1 plus and minus this is the same motion to every instrument.
NUDGE = 1e-6
#: Growth of a perturbation beyond which a run is chaotic: one of a millionth parts histories by a hundredth of the critical
#: rotation. In 192 runs of six blocks under five records and three sines 16 grow so much (tests/unit/test_conditions.py)
CHAOTIC = 1e4
#: No instrument tells motions apart that differ by so little: half a decade after the other, for windows of outcomes among
#: others are as narrow as that
NUDGES = (NUDGE, 3.2e-6, 1e-5, 3.2e-5, 1e-4)
#: A motion repeats itself where it is this much like itself a period later, over so many periods
ALIKE, OFTEN = 0.5, 4.0


@dataclass(frozen=True)
class Doubts:
    """Outcomes by impact rule, the one used first, none where the rules agree; growth of a perturbation of the motion, and
    whether that makes the run chaotic; conditions that do not hold, a sentence each."""

    rules: list[RuleOutcome]
    growth: float
    chaotic: bool
    warnings: list[str]
    violated: list[str]


def growth(runs: Sequence[np.ndarray], critical: tuple[float, float]) -> float:
    """Greatest separation of perturbed runs from the first one at equal times, over the perturbation.

    runs: rotations at equal times (times) [rad], first as the motion is, then under the motion times 1 plus or minus NUDGE. Rotation
    and perturbation are shares, of the critical rotation to that side and of the motion. Only the time until the first of them
    passes the critical rotation counts: beyond it every difference grows. A smooth response is about 1 to 1e3, a chaotic one grows
    exponentially with its impacts up to 1e6, where histories have nothing in common.
    """
    length = min(len(run) for run in runs)
    share = np.stack([run[:length] / np.where(run[:length] >= 0.0, *critical) for run in runs])
    beyond = (np.abs(share) > 1.0).any(axis=0)
    if beyond.any():
        share = share[:, : int(beyond.argmax())]
    return float(np.abs(share[1:] - share[0]).max(initial=0.0)) / NUDGE


def perturbed() -> list[float]:
    """Factors on the motion: 1 plus and minus each of NUDGES, those of NUDGE first."""
    return [1.0 + sign * nudge for nudge in NUDGES for sign in (-1.0, 1.0)]


def turning(outcome: str, others: Sequence[str]) -> float:
    """Least of NUDGES under which collapse turns into recovery or back, of the outcomes under `perturbed` motions; 0 where none does."""
    return next(
        (NUDGES[i // 2] for i, other in enumerate(others) if (other == "collapse") != (outcome == "collapse")), 0.0
    )


def chaos_told(found: float, turns: float) -> str:
    """The violated condition of a chaotic run, from the growth of a perturbation and the least one that turns its outcome."""
    if found <= CHAOTIC and turns > NUDGE:
        return (
            f"Sensitive to perturbations of {turns:.1g}: scaled by 1 plus or minus that, the motion ends in another outcome. One run is "
            "one sample: use fragility."
        )
    return (
        f"Chaotic: sensitive to perturbations of 1e-6. Scaled by 1 plus or minus {NUDGE:g}, the motion ends in another outcome, or the "
        f"rotation differs by up to {100.0 * min(1.0, found * NUDGE):.2g} % of the critical one. One run is one sample: use fragility."
    )


def beat(context: Context, response: Response) -> float:
    """Frequency at which the ground repeats itself while the structure rocks [Hz]; 0 where it does not."""
    times = [t for kind, t, _ in response.events if kind in ("uplift", "impact")]
    if not times or min(times[-1], context.motion.end) <= times[0]:
        return 0.0
    time = np.linspace(times[0], min(times[-1], context.motion.end), 16384)
    ground = context.motion.sample(time)
    power = np.abs(np.fft.rfft(ground * np.hanning(len(time)))) ** 2
    span = time[-1] - time[0]
    cycles = int(power[1:].argmax()) + 1
    lag = round(len(time) / cycles)
    if cycles < OFTEN or lag >= len(time) // 2:
        return 0.0
    early, late = ground[:-lag], ground[lag:]
    size = float(np.sqrt((early @ early) * (late @ late)))
    return cycles / span if size > 0.0 and float(early @ late) > ALIKE * size else 0.0


def too_fast(limit: float) -> str:
    """Why motion that repeats itself above a frequency [Hz] is worse than fixed hinges say."""
    return (
        f"above {limit:.2g} Hz impacts in a row, of hinges that do not move, lose too much in an arch of this size, and discrete "
        "elements fell at a third of the strength"
    )


def _keeping_more(context: Context, rocker: Rocker, response: Response) -> list[tuple[float, str]]:
    """c_v to try beside that of the blow at all joints, and why: where discrete elements are known to keep more."""
    model = rocker.model
    if not isinstance(model, ArchModel) or model.rule != "inelastic" or response.outcome != "recovery":
        return []
    found = []
    if (kept := model.kept_by_elements) is not None:
        found.append((kept, "discrete elements may keep more than the blow at all joints"))
    frequency, limit = beat(context, response), model.fastest_beat
    if limit is not None and frequency > limit:
        found.append((1.0, f"the motion repeats itself at {frequency:.2g} Hz: {too_fast(limit)}"))
    return found


def doubts(context: Context, options: Rocking, rocker: Rocker, response: Response, end_time: float) -> Doubts:
    """Runs the motion again under the rival rules and perturbed; free of cost beside the drawing."""
    nothing = Doubts([], 0.0, False, [], [])
    if response.interrupted:
        return nothing
    probes = [
        history(
            rocker.body, context.motion.ground, end_time, options.output_step, scale=1.0 + nudge, tolerance=options.tolerance,
            start_side=1 if rocker.start_rotation >= 0.0 else -1, start_rotation=abs(rocker.start_rotation),
        )
        for nudge in (-NUDGE, NUDGE)
    ]  # fmt: skip
    if any(probe.interrupted for probe in probes):
        return nothing
    grown = growth([response.rotation, *(probe.rotation for probe in probes)], rocker.critical)
    factors = perturbed()[len(probes) :]
    nudged = ensemble(
        [rocker.body], [context.motion.ground], np.zeros(len(factors), dtype=int), np.zeros(len(factors), dtype=int), factors,
        end_time, start_rotation=rocker.start_rotation, tolerance=options.tolerance, threads=context.threads,
    )  # fmt: skip
    if nudged.interrupted:
        return nothing
    others = [response.outcome if place == FAILED else OUTCOMES[place] for place in nudged.outcome]
    turns = turning(response.outcome, [*(probe.outcome for probe in probes), *others])
    chaotic = grown > CHAOTIC or turns > 0.0
    violated = [chaos_told(grown, turns)] if chaotic else []
    rivals: dict[str, tuple[float, Body]] = rocker.model.rivals(DIFFER)
    more = _keeping_more(context, rocker, response)
    bodies = [rocker.held(body) for _, body in rivals.values()]
    bodies += [arch_body(rocker.model.four_hinge, c_v) for c_v, _ in more]
    if not bodies:
        return Doubts([], grown, chaotic, [], violated)
    which = np.arange(len(bodies))
    found = ensemble(
        bodies, [context.motion.ground], which, 0 * which, 1.0, end_time,
        start_rotation=rocker.start_rotation, tolerance=options.tolerance, threads=context.threads,
    )  # fmt: skip
    if found.interrupted:
        return nothing
    outcome = ["" if place == FAILED else OUTCOMES[place] for place in found.outcome]
    warnings = []
    rules = [
        RuleOutcome(rule=rule, restitution=c_v, outcome=one)
        for (rule, (c_v, _)), one in zip(rivals.items(), outcome[: len(rivals)], strict=True)
        if one
    ]
    if rules:
        told = ", ".join(f'"{one.rule}" {one.restitution:.3f}: {one.outcome}' for one in rules)
        same = {one.outcome for one in rules} == {response.outcome}
        if same:
            warnings.append(f"The impact rules differ by more than {DIFFER:g}, and the outcome is the same: {told}.")
        else:
            violated.append(f"The impact rule decides the outcome: {told}.")
    for (c_v, why), one in zip(more, outcome[len(rivals) :], strict=True):
        if one:
            rules.append(RuleOutcome(rule=f"{c_v:.3f}", restitution=c_v, outcome=one))
            warnings.append(f"{why}: with {c_v:.3f} the outcome is {one}; ask `dem`")
            if one != response.outcome:
                violated.append(f"The restitution decides the outcome: with {c_v:.3f} {one}. Use dem.")
    return Doubts(rules, grown, chaotic, warnings, violated)
