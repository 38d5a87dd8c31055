"""How sure the outcome of a rocking run is: under the other impact rules, and under a motion scaled by a millionth."""

from dataclasses import dataclass

import numpy as np

from extrados.analyses.context import Context
from extrados.analyses.rocking.tables import Rocking
from extrados.building.rockers.rocker import Rocker
from extrados.core.rocking import FAILED, OUTCOMES, Body, Response, ensemble
from extrados.results.rocking import RuleOutcome

#: Impact rules whose c_v differ by more than this factor give both outcomes.
DIFFER = 1.3
#: A motion scaled by 1 plus and minus this is the same motion to every instrument.
NUDGE = 1e-6


@dataclass(frozen=True)
class Doubts:
    """Outcomes by impact rule, the one used first, none where the rules agree; does a nudge change the outcome?"""

    rules: list[RuleOutcome]
    on_the_edge: bool
    warnings: list[str]


def doubts(context: Context, options: Rocking, rocker: Rocker, response: Response, end_time: float) -> Doubts:
    """Runs the motion again under the rival rules and nudged; free of cost beside the drawing."""
    if response.interrupted:
        return Doubts([], False, [])
    rivals: dict[str, tuple[float, Body]] = rocker.model.rivals(DIFFER)
    bodies = [rocker.body, *(rocker.held(body) for _, body in rivals.values())]
    count = len(rivals)
    which = np.array([0, 0, *range(1, count + 1)], dtype=int)
    scale = np.array([1.0 - NUDGE, 1.0 + NUDGE, *[1.0] * count])
    found = ensemble(
        bodies, [context.motion.ground], which, np.zeros(len(which), dtype=int), scale, end_time,
        start_rotation=rocker.start_rotation, tolerance=options.tolerance, threads=context.threads,
    )  # fmt: skip
    if found.interrupted:
        return Doubts([], False, [])
    outcome = ["" if place == FAILED else OUTCOMES[place] for place in found.outcome]
    warnings = []
    edge = any(one not in ("", response.outcome) for one in outcome[:2])
    if edge:
        warnings.append(
            f"a motion {NUDGE:g} stronger or weaker ends in another outcome: this run is decided by its last digits, "
            "ask for the share of motions that bring it down instead (`fragility`)"
        )
    rules = [
        RuleOutcome(rule=rule, restitution=c_v, outcome=one)
        for (rule, (c_v, _)), one in zip(rivals.items(), outcome[2:], strict=True)
        if one
    ]
    if rules:
        told = ", ".join(f'"{one.rule}" {one.restitution:.3f}: {one.outcome}' for one in rules)
        same = "the outcome is the same" if {one.outcome for one in rules} == {response.outcome} else "outcomes differ"
        warnings.append(f"the impact rules differ by more than {DIFFER:g} for this structure and {same} ({told})")
    return Doubts(rules, edge, warnings)
