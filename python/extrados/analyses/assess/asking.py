"""Ask a strategy: the deck of one part, run by the driver of its kind, and the row of the table that it gives."""

import copy
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import tomlkit

from extrados import interrupts, kinds
from extrados.analyses.assess.budget import Interrupted, OutOfTime
from extrados.analyses.assess.hazard import Demanded
from extrados.analyses.assess.strategies import Strategy
from extrados.analyses.changes import lacking
from extrados.analyses.conclude import MotionDemand, concluded
from extrados.analyses.context import Context, Refused
from extrados.analyses.limit.self_weight import neglecting
from extrados.analyses.sequence import run_one
from extrados.analyses.statistics.summaries import wilson
from extrados.core.calls import within
from extrados.decks.reader import DeckError, make_deck
from extrados.model.errors import WHOLE
from extrados.results.assess import RowStatus, StrategyVerdict
from extrados.results.frame import FramePushover
from extrados.results.limit import Tilt, judge_dilatant
from extrados.results.model import Result
from extrados.results.shell import Pushover
from extrados.results.sla import Sla
from extrados.results.statistics import Ensemble, OverLevels
from extrados.results.verdict import Outcome, SelfWeight, judge_acceleration


@dataclass
class Asker:
    """Runs parts of an assessment on the deck of `context`; left: seconds of the clock before it stops them.

    motion: the table of the motion that single runs take.
    """

    context: Context
    motion: dict[str, Any]
    deadline: float
    clock: Callable[[], float]

    def not_considered(self, kind: str) -> tuple[str, ...]:
        """Special keys of the deck that an analysis of this kind does not consider, as decks call them."""
        considered = kinds.load(kinds.ANALYSES[kind].table).considers
        return tuple(what for what in self.context.building.special_keys if what not in considered)

    def data(
        self, kind: str, keys: dict[str, Any], motion: dict[str, Any], changes: dict[str, Any], without: tuple[str, ...]
    ) -> dict[str, Any]:
        """The deck of one part; `changes` gives dotted keys other values, `without` names what it leaves out."""
        data = {k: copy.deepcopy(v) for k, v in self.context.deck.data.items() if k != "analysis"}
        data["motion"] = motion
        data = lacking(data, without)
        for dotted, value in changes.items():
            *way, last = dotted.split(".")
            place = data
            for part in way:
                place = place.setdefault(part, {})
            place[last] = value
        return {**data, "analysis": [{"kind": kind, **keys}]}

    def ask(
        self,
        kind: str,
        keys: dict[str, Any],
        motion: dict[str, Any] | None = None,
        changes: dict[str, Any] | None = None,
        without: tuple[str, ...] = (),
    ) -> tuple[Result, str]:
        """The result of an analysis of the building, and its deck as text; Refused where the deck is wrong, OutOfTime after the
        deadline."""
        if self.clock() >= self.deadline:
            raise OutOfTime
        data = self.data(kind, keys, self.motion if motion is None else motion, changes or {}, without)
        whole = self.context
        try:
            deck = make_deck(data, whole.deck.folder)
        except DeckError as error:
            raise Refused("; ".join(c.removeprefix("deck: analysis: ") for c in error.complaints), WHOLE) from None
        deck = replace(deck, sha256=whole.deck.identity, path=whole.deck.path)
        one = Context(
            deck, whole.threads, whole.progress, out=whole.out, resume=whole.resume, scheduler=whole.scheduler, motions=whole.motions
        )
        one.checkpoint = whole.checkpoint  # the batches of a run lie in one folder
        (options,), (building,) = deck.analyses, deck.buildings
        if not changes and not without and not any(name in keys for name in ("material", "joints", "supports", "initial")):
            building = whole.building  # with the views that it has
        signals = len(interrupts.asked)
        with within(self.deadline - self.clock(), self.clock) as limit:
            result = run_one(one, options, building)
        if result.status == "interrupted":
            if limit.passed and len(interrupts.asked) == signals:
                raise OutOfTime
            raise Interrupted
        found = concluded(neglecting(result, whole.building, without), options, one, building)
        return replace(found, asked=options.model_dump(exclude_none=True)), tomlkit.dumps(data)

    def demand(self, peak_g: float) -> Demanded:
        """What the hazard asks, for the verdict of a part."""
        asked = MotionDemand(self.context)
        return Demanded(peak_g, asked.pulse, asked.duration_s, asked.amplitude_g)


#: What of a deck restrains its structure, as decks call it
RESTRAINTS = ("[[ties]]", "[[dampers]]", "[[hinges]]", "[supports] abutting_wall")


def row_of(
    strategy: Strategy,
    result: Result,
    words: str,
    demand: Demanded,
    acceptable: float,
    wall: str | None = None,
    without: tuple[str, ...] = (),
) -> StrategyVerdict:
    """The row of a strategy that has been asked; wall: the side of a wall that stands against it, towards which statics does
    not push. without: what of the deck the strategy neglects, whose collapse without a restraint decides nothing."""
    if result.status != "ok":
        return no_row(strategy, "refused" if result.status == "refused" else "failed", result.reason, words)
    r = result.results
    outcome: Outcome | None = None
    margin, low, high = None, None, None
    verdict, said = r.require_verdict(demand), ""
    if isinstance(r, Tilt) and wall is not None:
        verdict, said = r.judged_towards(demand, (wall == "right",)), "Pushed away from the wall"
    elif isinstance(r, Tilt) and (cracked := _cracked(r)) is not None and cracked < (verdict.capacity or 0.0):
        judged = judge_dilatant if r.fracture is not None and r.fracture.dilating else judge_acceleration
        verdict, said = judged(cracked, demand), "With the leeward buttress cracked"
    wanted, borne, unit, statement = verdict.demand, verdict.capacity, verdict.unit, verdict.statement
    if said:
        statement = f"{said}: {statement[:1].lower()}{statement[1:]}"
    if isinstance(r, Ensemble | OverLevels):
        wanted, borne, unit, outcome, statement, low, high = _probability(r, acceptable)
    elif isinstance(r, Sla | Pushover) and any(c.peak_load_N is None for c in (r, r.minus) if c is not None):
        low = verdict.ratio  # it bears so much at least
        if verdict.outcome == "stands":
            statement = f"The run did not reach a peak, so the capacity is not known. {statement}"
    elif verdict.bound == "lower" and isinstance(r, Sla | Pushover | FramePushover):
        low = verdict.ratio
    elif strategy.axis in ("acceleration", "pulse", "check") or isinstance(r, SelfWeight):
        margin = None if isinstance(r, SelfWeight) and verdict.outcome == "open" else verdict.ratio  # of another building, or not proven
    outcome, violated = outcome or verdict.outcome, list(verdict.violated)
    if violated and outcome in ("stands", "collapses"):
        outcome, statement = "open", f"{statement} {' '.join(violated)}"
    if outcome == "collapses" and (held := [what for what in without if what in RESTRAINTS]):
        violated.append(f"This strategy neglects {' and '.join(held)}. Such restraints may prevent the collapse.")
        outcome, margin, statement = "open", None, f"{statement} {violated[-1]}"  # of another building
    return StrategyVerdict(
        strategy=strategy.name,
        label=strategy.label,
        part=None,
        status="ok",
        reason="",
        axis=strategy.axis,
        demand=wanted,
        capacity=borne,
        unit=unit,
        outcome=outcome,
        bound=verdict.bound,
        violated=violated,
        margin=margin,
        margin_at_least=low,
        margin_below=high,
        parameters=words,
        assumes=strategy.assumes,
        statement=statement,
    )


def _cracked(r: Tilt) -> float | None:
    """What it bears with its leeward buttress cracked [g], where the deck asks for that; 0 where it cannot stand so."""
    if r.fracture is None:
        return None
    return r.fracture.collapse_acceleration_g if r.fracture.stands is not False else 0.0


def no_row(strategy: Strategy, status: RowStatus, reason: str, words: str = "") -> StrategyVerdict:
    """The row of a strategy without a result."""
    return StrategyVerdict(
        strategy=strategy.name,
        label=strategy.label,
        part=None,
        status=status,
        reason=reason,
        axis=strategy.axis,
        demand=None,
        capacity=None,
        unit="",
        outcome="not-applicable",
        bound=None,
        violated=[],
        margin=None,
        margin_at_least=None,
        margin_below=None,
        parameters=words,
        assumes=strategy.assumes,
        statement="",
    )


def _probability(r: Ensemble | OverLevels, acceptable: float) -> tuple:
    """Demand, capacity, unit, outcome, statement and bracket of the margin of a share of collapses.

    It stands where the share is acceptable, falls where it is above a half; between them it is open.
    """
    low = high = None
    if isinstance(r, OverLevels):
        k = min(range(len(r.levels)), key=lambda i: abs(r.levels[i] - 1.0))
        count, collapsed = r.count[k], r.collapsed[k]
        shares = list(zip(r.levels, r.collapse_probability, strict=True))
        stands = [level for level, share in shares if share is not None and share <= acceptable]
        falls = [level for level, share in shares if share is not None and share > acceptable]
        high = min(falls, default=None)
        low = max((level for level in stands if high is None or level < high), default=None)
    else:
        count, collapsed = r.count, r.collapsed
    if not count:
        return None, acceptable, "of all runs", "open", "No motion could be run.", low, high
    share = collapsed / count
    least, most = wilson(collapsed, count)
    outcome = "stands" if share <= acceptable else "collapses" if share > 0.5 else "open"
    text = (
        f"{collapsed} of {count} runs collapse: {100 * share:.3g} %, with a 95 % confidence interval of {100 * float(least):.3g} "
        f"to {100 * float(most):.3g} %; {100 * acceptable:g} % are acceptable."
    )
    return share, acceptable, "of all runs", outcome, text, low, high


def scaled_margin(r: OverLevels) -> tuple[float | None, float | None]:
    """Greatest factor below the first at which a single motion brings it down, and that first factor. Where blocks slide or hinges
    form elsewhere before, rocking does not follow the motion: the margin is at least the factor below, and no factor is known to
    bring it down."""
    shares = zip(r.collapsed, r.sliding_share, r.hinges_elsewhere_share, strict=True)
    seen = [(bool(down), bool(slides) or bool(strays)) for down, slides, strays in shares]
    first = next((i for i, one in enumerate(seen) if any(one)), None)
    if first is None:
        return r.levels[-1], None
    down, leaves = seen[first]
    return (r.levels[first - 1] if first else None), (r.levels[first] if down and not leaves else None)
