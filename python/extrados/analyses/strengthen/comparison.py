"""Interventions beside each other: a combination of ties, the verdicts of all strategies before and after, both fragility curves."""

from typing import Any

import numpy as np

from extrados.analyses.statistics.summaries import wilson
from extrados.analyses.strengthen.alternatives import TieAlternative
from extrados.analyses.strengthen.measures import Statics, nested, plain_data, run_part, unmet_reason
from extrados.analyses.strengthen.rows import NAMED, placed
from extrados.analyses.strengthen.sizing import Sized, Sizing
from extrados.decks.reader import DeckError, make_deck
from extrados.limit.errors import NoAnswer, NoEquilibrium
from extrados.results import strengthen as out
from extrados.results.assess import Assess, StrategyVerdict
from extrados.results.statistics import OverLevels


def combine_ties(work: Sizing, ties: list[TieAlternative]) -> dict[str, Any]:
    """The combination of all ties at all places whose forces have the least sum, in one programme; nothing where one tie is enough."""
    statics = work.measure
    assert isinstance(statics, Statics)
    columns = [(one, place) for one in ties if not one.beam_weight for place in range(len(one.places))]
    if len({one.name for one, _ in columns}) < 2:
        return {}
    try:
        forces = statics.forces(columns, statics.aimed)
    except NoEquilibrium:
        return {}
    except NoAnswer as error:
        work.context.warnings.append(f"The combination of ties is not given: {error}")
        return {}
    carry = [k for k, f in enumerate(forces) if f > 1e-6 * float(forces.max())]
    if len(carry) < 2:
        return {}
    rows, cost, added = [], 0.0, []
    for k in carry:
        one, place = columns[k]
        tie = one.places[place]
        added.append(tie.model_copy(update={"yield_force": float(forces[k])}))
        rows.append(out.CombinedTie(name=one.name, place=placed(tie), force_N=float(forces[k])))
        cost += work.cost(one.lengths[place], float(forces[k]), 0.0)
    building = work.context.building
    worth = statics.of(building.having(ties=(*building.ties, *added)), picture=True)
    if unmet := unmet_reason(statics, worth):
        work.context.warnings.append(f"The combination of ties may not meet the target: {unmet.rstrip('.')}.")
    return {"combination": rows, "combination_cost": cost, "combination_meets_target": not unmet}


def assess_all(work: Sizing, sized: list[Sized]) -> None:
    """Verdicts of all strategies before, and after each intervention that meets the target."""
    before = _assess(work, "before", plain_data(work.context))
    for one in sized:
        if one.data is None:
            continue
        after = _assess(work, one.row.name, one.data)
        if before is None or after is None:
            continue
        rows = {row.strategy: row for row in before}
        verdicts, adverse = [], []
        for row in after:
            was = rows.get(row.strategy)
            if was is None or "ok" not in (was.status, row.status):
                continue
            verdict = out.OtherVerdict(
                strategy=row.label, before=was.outcome, after=row.outcome, margin_before=_margin(was), margin_after=_margin(row)
            )
            verdicts.append(verdict)
            low, high = verdict.margin_before, verdict.margin_after
            worse = was.outcome == "stands" and row.outcome in ("collapses", "cannot-stand")
            if worse or (low is not None and high is not None and high < low * (1.0 - NAMED)):
                adverse.append(
                    f"By {row.label}, the critical scale factor of the hazard decreases from {_number(low)} to {_number(high)} "
                    f"(verdict {was.outcome}, then {row.outcome})."
                )
            elif row.outcome in ("collapses", "cannot-stand"):
                adverse.append(f"By {row.label} the strengthened building still collapses (critical scale factor {_number(high)}).")
        one.row = one.row.model_copy(update={"verdicts": verdicts, "adverse": [*one.row.adverse, *adverse]})


def _assess(work: Sizing, name: str, data: dict[str, Any]) -> list[StrategyVerdict] | None:
    """The rows of an assessment of a deck."""
    work.context.tell(f"Assess {name}")
    try:
        deck = make_deck(
            {**data, "analysis": [{"kind": "assess", "budget": work.options.budget, "advise": False}]}, work.context.deck.folder
        )
    except DeckError as error:
        work.context.warnings.append(f"The assessment of {name} was refused: {'; '.join(error.complaints)}")
        return None
    found = run_part(nested(work.context, deck))
    if not isinstance(found.results, Assess):
        work.context.warnings.append(f"The assessment of {name} has no result: {found.reason}")
        return None
    return found.results.verdicts


def compare_fragility(work: Sizing, best: Sized) -> out.FragilityPair:
    """Probability of collapse over factors on the motions, before and after."""
    keys = {k: v for k, v in work.options.options.items() if work.options.by == "fragility"}
    asked = {**keys, "kind": "fragility", "intensity": "scale", "levels": sorted(work.options.levels), "bootstrap": 0}
    found: list[OverLevels | None] = []
    for data in (plain_data(work.context), best.data or {}):
        deck = make_deck({**data, "analysis": [asked]}, work.context.deck.folder)
        result = run_part(nested(work.context, deck))
        if not isinstance(result.results, OverLevels):
            work.context.warnings.append(f"No fragility curve: {result.reason or result.answer}")
            found.append(None)
        else:
            found.append(result.results)
    sides: dict[str, Any] = {}
    count = len(work.options.levels)
    for word, r in zip(("before", "after"), found, strict=True):
        shares = [None] * count if r is None else r.collapse_probability
        low, high = (np.zeros(count), np.ones(count)) if r is None else wilson(np.array(r.collapsed), np.array(r.count))
        sides |= {word: shares, f"{word}_low": low.tolist(), f"{word}_high": high.tolist()}
    motions = next((r.motions for r in found if r is not None), 0)
    return out.FragilityPair(name=best.row.name, levels=sorted(work.options.levels), motions=motions, **sides)


def _margin(row: StrategyVerdict) -> float | None:
    return row.margin if row.margin is not None else row.margin_at_least


def _number(value: float | None) -> str:
    return "unknown" if value is None else f"{value:.3g}"
