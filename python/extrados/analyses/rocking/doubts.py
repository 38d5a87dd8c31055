"""How sure the outcome of a rocking run is: under the other impact rules, where the blow at all joints is known to lose too
much, and under perturbations of the motion from a millionth to a ten thousandth."""

from dataclasses import dataclass, replace

import numpy as np

from extrados.analyses.chaos import growth, growth_step, over_critical, perturbed, turning, violated_by_chaos
from extrados.analyses.context import Context
from extrados.analyses.rocking.hand_over import Contacts, decide, word_of
from extrados.analyses.rocking.tables import Rocking
from extrados.core.rocking import FAILED, OUTCOMES, Body, Response, arch_body, ensemble, history
from extrados.results.rocking import HandOver, RuleOutcome
from extrados.views.rockers.arch import ArchModel
from extrados.views.rockers.rocker import Rocker

#: Impact rules whose c_v differ by more than this factor give both outcomes.
DIFFER = 1.3
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
        f"in an arch of this size, successive impacts at more than {limit:.2g} Hz lose too much energy if the "
        "hinges stay fixed: discrete elements collapsed at 1/3 of the amplitude"
    )


def _keeping_more(context: Context, rocker: Rocker, response: Response) -> list[tuple[float, str]]:
    """c_v to try beside that of the blow at all joints, and why: where discrete elements are known to keep more."""
    model = rocker.model
    if not isinstance(model, ArchModel) or model.rule != "inelastic" or response.outcome != "recovery":
        return []
    found = []
    if (kept := model.kept_by_elements) is not None:
        found.append((kept, "in discrete elements, an impact may keep more velocity than the assumed plastic impact at all joints"))
    frequency, limit = beat(context, response), model.fastest_beat
    if limit is not None and frequency > limit:
        found.append((1.0, f"the motion repeats itself at {frequency:.2g} Hz: {too_fast(limit)}"))
    return found


def doubts(context: Context, options: Rocking, rocker: Rocker, response: Response, end_time: float) -> Doubts:
    """Runs the motion again under the rival rules and perturbed; free of cost beside the drawing. None of it depends on the step of
    output."""
    nothing = Doubts([], 0.0, False, [], [])
    if response.interrupted:
        return nothing
    probes = [
        history(
            rocker.body,
            context.motion.ground,
            end_time,
            growth_step(rocker.time_unit, end_time),
            scale=factor,
            tolerance=options.tolerance,
            start_side=1 if rocker.start_rotation >= 0.0 else -1,
            start_rotation=abs(rocker.start_rotation),
        )
        for factor in (1.0, *perturbed()[:2])
    ]
    if any(probe.interrupted for probe in probes):
        return nothing
    grown = growth([over_critical(one.rotation, rocker.critical) for one in probes])
    factors = perturbed()[2:]
    nudged = ensemble(
        [rocker.body],
        [context.motion.ground],
        np.zeros(len(factors), dtype=int),
        np.zeros(len(factors), dtype=int),
        factors,
        end_time,
        start_rotation=rocker.start_rotation,
        tolerance=options.tolerance,
        threads=context.threads,
    )
    if nudged.interrupted:
        return nothing
    others = [response.outcome if place == FAILED else OUTCOMES[place] for place in nudged.outcome]
    turns = turning(response.outcome, [*(probe.outcome for probe in probes[1:]), *others])
    violated = violated_by_chaos(grown, turns)
    chaotic = bool(violated)
    rules, warnings, decided = _rules(context, options, rocker, response, end_time)
    return nothing if rules is None else Doubts(rules, grown, chaotic, warnings, [*violated, *decided])


def _rules(
    context: Context, options: Rocking, rocker: Rocker, response: Response, end_time: float
) -> tuple[list[RuleOutcome] | None, list[str], list[str]]:
    """Outcomes under rival impact rules, None after an interruption; warnings; violated conditions."""
    rivals: dict[str, tuple[float, Body]] = rocker.rivals(DIFFER)
    more = _keeping_more(context, rocker, response)
    bodies = [rocker.held(body) for _, body in rivals.values()]
    if isinstance(rocker.model, ArchModel):
        bodies += [arch_body(rocker.model.four_hinge, c_v) for c_v, _ in more]
    if not bodies:
        return [], [], []
    which = np.arange(len(bodies))
    found = ensemble(
        bodies,
        [context.motion.ground],
        which,
        0 * which,
        1.0,
        end_time,
        start_rotation=rocker.start_rotation,
        tolerance=options.tolerance,
        threads=context.threads,
    )
    if found.interrupted:
        return None, [], []
    outcome = [None if place == FAILED else OUTCOMES[place] for place in found.outcome]
    warnings, violated = [], []
    rules = [
        RuleOutcome(rule=rule, restitution=c_v, outcome=one)
        for (rule, (c_v, _)), one in zip(rivals.items(), outcome[: len(rivals)], strict=True)
        if one
    ]
    if rules:
        listed = ", ".join(f'"{one.rule}" {one.restitution:.3f}: {one.outcome}' for one in rules)
        if {one.outcome for one in rules} == {response.outcome}:
            warnings.append(f"The impact rules differ by more than {DIFFER:g}, but the outcome is the same: {listed}.")
        else:
            violated.append(f"The impact rule decides the outcome: {listed}.")
    for (c_v, why), one in zip(more, outcome[len(rivals) :], strict=True):
        if one:
            rules.append(RuleOutcome(rule=f"{c_v:.3f}", restitution=c_v, outcome=one))
            warnings.append(f"{why}. With a coefficient of restitution of {c_v:.3f} the outcome is {one}; use `dem`")
            if one != response.outcome:
                violated.append(f"The coefficient of restitution decides the outcome: with {c_v:.3f} the outcome is {one}. Use dem.")
    return rules, warnings, violated


def doubts_on_contacts(context: Context, rocker: Rocker, contacts: Contacts, response: Response, over: HandOver, end_time: float) -> Doubts:
    """How sure the outcome is where rigid contacts went on: they were run again under a perturbed motion; where impacts came before,
    under the rival rules of impact too. response: of the mechanism until then."""
    run = over.contacts
    growth_found = run.perturbation_growth or 0.0
    rivals = rocker.rivals(DIFFER) if response.impacts else {}
    rules = []
    for rule, (c_v, body) in rivals.items():
        rival = replace(contacts, leaving=replace(contacts.leaving, body=rocker.held(body)))
        one = np.zeros(1, dtype=int)
        place = int(decide(context, f"contacts-{rule}", rival, [context.motion.ground], one, one + 1.0, one + end_time)["outcome"][0])
        if place >= 0:
            rules.append(RuleOutcome(rule=rule, restitution=c_v, outcome=word_of(place)))
    violated = list(run.violated)
    if len({one.outcome == "collapse" for one in rules}) > 1:
        told = ", ".join(f'"{one.rule}" {one.restitution:.3f}: {one.outcome}' for one in rules)
        violated.append(f"The impact rule decides the outcome: {told}.")
    return Doubts(rules, growth_found, run.decided_by_last_digits, [], violated)
