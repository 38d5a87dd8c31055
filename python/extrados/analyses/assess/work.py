"""An assessment while it is made: strategies asked one by one, their rows, further runs, and what was not done."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache, cached_property
from typing import Any

from extrados import kinds
from extrados.analyses.assess import budget, hazard, strategies
from extrados.analyses.assess.asking import Asker, no_row, row_of
from extrados.analyses.assess.budget import ENDING, OutOfTime, Stopwatch
from extrados.analyses.assess.facts import Facts
from extrados.analyses.assess.sensitivity import Moved
from extrados.analyses.assess.strategies import Asked, Choice, LeftOut, Strategy
from extrados.analyses.assess.tables import Assess
from extrados.analyses.conclude import faulty
from extrados.analyses.context import Context, Refused
from extrados.model.errors import BadGeometry, NoView
from extrados.motions.from_deck import is_set
from extrados.results import assess as out
from extrados.results.model import Result
from extrados.results.rocking import FailureDomain
from extrados.results.rocking import Rocking as RockingResults
from extrados.results.verdict import SelfWeight

#: Keys of further runs of discrete elements: the first alone is held against a perturbed one
ONE_RUN = {"perturbed": False}


class Work:
    """An assessment while it is made: rows and results by strategy."""

    def __init__(self, context: Context, options: Assess):
        self.context, self.options = context, options
        self.motions = hazard.motions_of(context, options.motions)
        self.many = is_set(context.deck.motion)
        self.rows: dict[str, out.StrategyVerdict] = {}
        self.results: dict[str, Result] = {}
        self.choices: dict[str, Choice] = {}
        self.parts: list[tuple[str, str, Result]] = []  # strategy, in words, result
        self.decks: list[str] = []
        self.probes: list[out.Probe] = []
        self.found: dict[str, Result] = {}
        self.not_done: list[str] = []
        self.chosen: dict[str, Any] = {}
        self.bare: dict[str, tuple[str, ...]] = {}
        self.moved: list[Moved] = []
        self.shaken: list[out.TurningValue] = []
        self.faults: dict[str, bytes] = {}
        self.advice: out.Advice | None = None
        self.advised = False
        self.finer: dict[str, list[str]] = {}  # strategy, settings of its finer runs with their outcomes
        self.finer_told = ""
        self.asker = Asker(context, dict(context.deck.data["motion"]), budget.STOPPED_AFTER * options.for_strategies, Stopwatch())
        self.peak, self.peak_told = hazard.peak_of(context)

    def one_motion(self) -> Context:
        """The context as strategies of one motion see it."""
        model = kinds.table("motion", self.asker.motion["kind"]).model_validate(self.asker.motion)
        whole = self.context
        return Context(replace(whole.deck, motion=model), whole.threads, building=whole.building, motions=whole.motions)

    def asked(self) -> Asked:
        return Asked(self.one_motion(), self.options, self.motions if self.many else 1, self.peak)

    def ask(self, strategy: Strategy) -> Result | None:
        """Ask a strategy and put its row into the table; None where it has no result of its kind.

        A strategy that fails in whatever way gives a row that says so: the others still count.
        """
        try:
            return self._asked(strategy)
        except ENDING:
            raise
        except Exception as error:
            found = faulty(strategy.kind, error)
            self.faults |= found.files
            self.rows[strategy.name] = no_row(strategy, "failed", found.reason)
            return None

    def _asked(self, strategy: Strategy) -> Result | None:
        name = strategy.name
        own = {} if name == "scaled" else self.options.options.get(name, {})
        try:
            choice = strategy.choose(self.asked())
        except (LeftOut, BadGeometry) as error:
            if not own:
                self.rows[name] = no_row(strategy, "left out" if isinstance(error, LeftOut) else "refused", str(error))
                return None
            choice = Choice({}, "")
        words = "; ".join([w for w in (choice.words,) if w] + ([f"of the deck: {keys_told(own)}"] if own else []))
        choice = replace(choice, keys=merge_keys(choice.keys, own), words=words)
        self.choices[name] = choice
        without = self.asker.not_considered(choice.kind or strategy.kind)
        if without and name != "scaled":
            self.bare[name] = without
            words = f"{words}; without {' and '.join(without)}, which this strategy cannot include"
        whole = name == "scaled" or (name == "probability" and self.many)
        motion = dict(self.context.deck.data["motion"]) if whole else None
        try:
            result, deck = self.asker.ask(choice.kind or strategy.kind, choice.keys, motion, None, without)
        except OutOfTime:
            self.rows[name] = no_row(strategy, "left out", f"stopped at the time limit of {self.options.for_strategies:g} s", words)
            self.not_done.append(f"{strategy.label}: stopped at the time limit")
            return None
        except Refused as error:
            self.rows[name] = no_row(strategy, "refused", str(error), words)
            return None
        if self.many and result.status == "ok" and not whole:
            verdict = result.results.require_verdict(self.asker.demand(self.peak))
            result = replace(result, verdict=verdict)
        self.rows[name] = row_of(
            strategy,
            result,
            words,
            self.asker.demand(self.peak),
            self.options.acceptable_probability,
            self.context.building.supports.abutting_wall,
            without,
        )
        if result.status != "ok":
            return None
        self.parts.append((name, f"{strategy.label}: {words}", result))
        self.decks.append(deck)
        if isinstance(result.results, SelfWeight):  # nothing more to learn from it, and no results of its kind
            return None
        self.results[name] = result
        return result

    def further(self, what: str, step: Callable[[], None]) -> None:
        """A step beyond the rows of the table: where it fails, the table still counts."""
        try:
            step()
        except ENDING:
            raise
        except OutOfTime:
            self.not_done.append(f"{what}: stopped at the time limit of {self.asker.deadline:g} s")
        except Exception as error:
            self.note_failure(what, error)

    def note_failure(self, what: str, error: Exception) -> None:
        found = faulty("assess", error)
        self.faults |= found.files
        self.not_done.append(f"{what}: {found.reason}")

    def wants(self, name: str) -> bool:
        """Whether a strategy is to be asked; one that the deck names and that cannot look at the building is told."""
        if name not in self.options.strategies:
            return False
        strategy = strategies.of(name)
        if strategy.applies(self.context.building):
            return True
        if "strategies" in self.options.model_fields_set:
            kind = self.context.building.require_structure().kind
            self.rows[name] = no_row(strategy, "left out", f"this strategy cannot analyse a structure of kind '{kind}'")
        return False

    def facts(self) -> Facts:
        return Facts(
            self.context.building,
            self.one_motion().motion,
            self.peak,
            self.rows,
            self.results,
            self.options.apart,
            self.found,
            self.needed,
            self.bare,
        )

    def probe(
        self,
        strategy: str,
        changed: str,
        kind: str,
        keys: dict[str, Any],
        motion: dict[str, Any] | None = None,
        changes: dict[str, Any] | None = None,
        tell: bool = True,
        without: tuple[str, ...] | None = None,
    ) -> Result | None:
        """A further run; None where it has no result, which is told."""
        without = self.asker.not_considered(kind) if without is None else without
        try:
            result, _ = self.asker.ask(kind, keys, motion, changes, without)
        except OutOfTime:
            self.not_done.append(f"{changed}: stopped at the time limit")
            return None
        except Refused as error:
            self.not_done.append(f"{changed}: {error}")
            return None
        if result.status != "ok":
            self.not_done.append(f"{changed}: {result.reason}")
            return None
        if tell:
            verdict = result.results.require_verdict(self.asker.demand(self.peak))
            value = verdict.demand / verdict.capacity if verdict.demand is not None and verdict.capacity else None
            if isinstance(result.results, RockingResults):
                value = result.results.peak_rotation_ratio
            self.probes.append(out.Probe(strategy=strategy, changed=changed, outcome=verdict.outcome, value=value))
        return result

    def keep(self, name: str, found: Result | None) -> None:
        if found is not None:
            self.found[name] = found

    def bracket(self, name: str, low: float | None, high: float | None) -> None:
        """Between which factors on the hazard the verdict of a strategy turns."""
        self.rows[name] = self.rows[name].model_copy(update={"margin_at_least": low, "margin_below": high})

    @cached_property
    def needed(self) -> Callable[[float], float | None]:
        """Shortest constant push of an amplitude [g] that brings it down [s]; None where no mechanism rocks."""
        return cache(self._shortest_push)

    def _shortest_push(self, amplitude: float) -> float | None:
        if "rocking" not in self.results:
            return None
        try:
            unit = self.context.building.rocker().time_unit
        except NoView:  # it rocks in several coordinates
            return None
        keys = {
            "pulse": "rectangular",
            "durations": [0.02 * unit, 20.0 * unit],
            "amplitudes": 2,
            "at_amplitudes": [f"{amplitude!r} g"],
            "max_amplitude": f"{2.0 * amplitude!r} g",
            "hand_over_cells": 0,  # of the mechanism of fixed hinges: a duration to compare with, no verdict
        }
        told = f"a constant horizontal acceleration of {amplitude:.3g} g: shortest duration that causes collapse"
        found = self.probe("rocking", told, "failure-domain", keys, tell=False)
        if found is None or not isinstance(found.results, FailureDomain) or found.results.at_amplitudes is None:
            return None
        return found.results.at_amplitudes.mode_I_durations_s[0]


def merge_keys(keys: dict[str, Any], given: dict[str, Any]) -> dict[str, Any]:
    """Keys with those of another table over them, table by table."""
    made = dict(keys)
    for name, value in given.items():
        below = made.get(name)
        made[name] = merge_keys(below, value) if isinstance(below, dict) and isinstance(value, dict) else value
    return made


def keys_told(given: dict[str, Any]) -> str:
    """Keys with their values in words."""
    return ", ".join(f"{k} = {v}" for k, v in given.items())
