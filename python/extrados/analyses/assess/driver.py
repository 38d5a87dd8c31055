"""assess: every strategy that applies to a building under one hazard, cheap first, compared, with reasons."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np

from extrados import kinds
from extrados.analyses.assess import advice, hazard, sensitivity, strategies
from extrados.analyses.assess.asking import ENDING, STOPPED_AFTER, Asker, Interrupted, OutOfTime, Stopwatch, no_row, row_of, scaled_margin
from extrados.analyses.assess.model_uncertainty import estimate_collapse
from extrados.analyses.assess.reasons import SLID, Facts, Pair, explained
from extrados.analyses.assess.strategies import Asked, Choice, LeftOut, Strategy
from extrados.analyses.assess.tables import Assess
from extrados.analyses.assess.words import answer, conclusion, table_of
from extrados.analyses.batches import Unfinished
from extrados.analyses.conclude import faulty
from extrados.analyses.context import Context, Refused
from extrados.analyses.dem.tables import OF_SPRINGS
from extrados.model.errors import BadGeometry, NoView
from extrados.model.structures.masonry import Column
from extrados.motions.from_deck import is_set
from extrados.results import assess as out
from extrados.results.dem import DemRun
from extrados.results.fields import given
from extrados.results.model import Array, Result, TableData
from extrados.results.rocking import Assessment, FailureDomain
from extrados.results.rocking import Rocking as RockingResults
from extrados.results.statistics import OverLevels
from extrados.results.store import group_names
from extrados.results.verdict import SelfWeight

#: Factors on the hazard at which discrete elements are tried, from 1 up while they stand, down while they fall
UP, DOWN = (1.25, 1.5, 2.0, 3.0, 4.0), (0.8, 0.65, 0.5, 0.35, 0.25)
#: Keys of further runs of discrete elements: the first alone is held against a perturbed one
ONE_RUN = {"perturbed": False}
#: Elements with joints so many times as stiff and as soft; a support that moves by this part of the size; halvings of the
#: interval in which elements turn
STIFFER, SPREAD = 4.0, 0.002
ELEMENT_HALVINGS = 3
#: Runs that follow, each twice as long, where a structure still moves at the end
PROLONGED = 2
#: Factors on the motion in a finer check
PERTURBED = (0.999, 1.001)
#: Factors between two of the first ones, where the margin of rocking is thin
FINE = 16


def run(context: Context, options: Assess) -> Result:
    """The table of verdicts, their agreement, the reasons, and one overall statement; its parts are analyses of the run."""
    work = _Work(context, options)
    result = Result("assess")
    try:
        work.cheap()
        context.tell(f"First results:\n{table_of(list(work.rows.values()))}")
        work.costly()
        work.further("longer runs", work.prolong)
        if options.advise:
            work.further("strengthening", work.advise)
        work.further("closer looks where strategies differ", work.refine)
        work.further("finer checks of contradictions", work.check_finer)
        if options.moves:
            work.asker.deadline = STOPPED_AFTER * options.budget
            work.further("sensitivity", work.move)
    except Interrupted:
        result.status, result.reason = "interrupted", "interrupted; the strategies that had run are reported"
    work.conclude(result)
    return result


class _Work:
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
        self.moved: list[sensitivity.Moved] = []
        self.shaken: list[out.TurningValue] = []
        self.faults: dict[str, bytes] = {}
        self.advice: out.Advice | None = None
        self.finer: dict[str, list[str]] = {}  # strategy, settings of its finer runs with their outcomes
        self.finer_told = ""
        self.asker = Asker(context, dict(context.deck.data["motion"]), STOPPED_AFTER * options.for_strategies, Stopwatch())
        self.peak, self.peak_told = hazard.peak_of(context)

    # ----- asking

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
        words = "; ".join([w for w in (choice.words,) if w] + ([f"of the deck: {_told(own)}"] if own else []))
        choice = replace(choice, keys=_merged(choice.keys, own), words=words)
        self.choices[name] = choice
        without = self.asker.cannot_bear(choice.kind or strategy.kind)
        if without and name != "scaled":
            self.bare[name] = without
            words = f"{words}; without {' and '.join(without)}, which it cannot take into account"
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
            self._failed(what, error)

    def _failed(self, what: str, error: Exception) -> None:
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

    # ----- the three rounds

    def cheap(self) -> None:
        """What takes seconds at most; of a set first its motions, which choose the one that single runs take."""
        if self.many:
            self._scaled_set()
        for name in ("tilt", "rocking", "assessment", "code-checks"):
            if self.wants(name):
                self.ask(strategies.of(name))
                if name == "rocking" and "rocking" in self.results and not self.many:
                    self._scaled()
        self.context.progress(1.0, 3.0, "assess")

    def costly(self) -> None:
        for name in ("probability", "frame", "sla", "push-x", "push-y", "dem"):
            if not self.wants(name) or name in self.rows:
                continue
            if name == "probability" and "rocking" in self.rows and self.rows["rocking"].status == "refused":
                text = "the strategy counts collapses by rocking, and this building does not rock as one mechanism"
                self.rows[name] = no_row(strategies.of(name), "left out", text)
            else:
                self.ask(strategies.of(name))
        self.context.progress(2.0, 3.0, "assess")

    def _scaled(self) -> None:
        """The factor on the one motion at which rocking brings it down: the margin of `rocking`."""
        found = self.ask(strategies.SCALED)
        row = self.rows.pop("scaled")
        if row.outcome == "cannot-stand":
            self.parts.pop()
            self.decks.pop()
            return
        if found is not None:  # a curve of one motion is none: its factors stand at the row of rocking
            self.parts.pop()
            self.decks.pop()
        if found is None:
            self.context.warnings.append(f"the margin of rocking is not known: {row.reason}")
            return
        curve = found.of(OverLevels)
        low, high = scaled_margin(curve)
        down = self.rows["rocking"].outcome == "collapses"  # the run under the hazard itself is a factor of 1
        self._bracket("rocking", low, 1.0 if high is None and down else high)
        words = f"{self.rows['rocking'].parameters}; its margin from {row.parameters}"
        if high is None and low != curve.levels[-1]:
            words += "; at the next factor blocks slide or hinges form elsewhere, so that rocking bounds the margin from below alone"
        self.rows["rocking"] = self.rows["rocking"].model_copy(update={"parameters": words})
        if curve.resurrections:
            self.context.warnings.append(
                "Rocking recovers at some factors above the least one that causes collapse. Do not rely on these safe regions."
            )

    def _scaled_set(self) -> None:
        """The share of a set that brings it down, and the motion that strategies of one motion take."""
        found = row = None
        if strategies.SCALED.applies(self.context.building):
            found = self.ask(strategies.SCALED)
            row = self.rows.pop("scaled")
        member, how = 1, "the first, for nothing rocks that could choose"
        if row is not None and row.status == "ok":
            strategy = strategies.of("probability")
            self.rows["probability"] = row.model_copy(
                update={"strategy": "probability", "label": strategy.label, "axis": strategy.axis, "assumes": strategy.assumes}
            )
            self.parts[-1] = ("probability", *self.parts[-1][1:])
        if found is not None:
            self.results["probability"] = self.results.pop("scaled")
            member = _governing(found)
            how = f"the motion of the set under which its rotation is larger than under {100 * hazard.GOVERNING:g} % of the others"
        self.chosen = {"member": member, "chosen_by": how}
        self.asker.motion = {**self.asker.motion, "member": member}
        if not isinstance(self.context.deck.motion, kinds.table("motion", "compatible")):
            self.peak, _ = hazard.peak_of(self.one_motion())
            self.peak_told = f"the greatest horizontal acceleration of motion {member}"

    def _bracket(self, name: str, low: float | None, high: float | None) -> None:
        """Between which factors on the hazard the verdict of a strategy turns."""
        self.rows[name] = self.rows[name].model_copy(update={"margin_at_least": low, "margin_below": high})

    # ----- longer runs

    def prolong(self) -> None:
        """Run anew, twice as long each time, strategies whose run ended while the structure still moved."""
        for name in ("rocking", "dem"):
            for _ in range(PROLONGED):
                end = _end_of_motion(self.results.get(name))
                if end is None or not self._run_until(name, 2.0 * end):
                    break

    def _run_until(self, name: str, end: float) -> bool:
        """Replace the run of a strategy by one until `end` [s]; False if the longer run has no result, and the former stays."""
        choice, place = self.choices[name], [s for s, _, _ in self.parts].index(name)
        former = self.rows[name]
        words = f"{former.parameters}; continued until {end:.3g} s, because the structure still moved at {0.5 * end:.3g} s"
        keys = choice.keys | {"end_time": round(end, 3)}
        without = self.bare.get(name, ())
        strategy = strategies.of(name)
        try:
            result, deck = self.asker.ask(choice.kind or strategy.kind, keys, None, None, without)
        except (OutOfTime, Refused) as error:
            told = str(error) or f"stopped at the time limit of {self.options.for_strategies:g} s"
            self.not_done.append(f"{strategy.label} until {end:.3g} s: {told}")
            return False
        if result.status != "ok":
            self.not_done.append(f"{strategy.label} until {end:.3g} s: {result.reason}")
            return False
        words = words.removeprefix("; ")
        row = row_of(
            strategy,
            result,
            words,
            self.asker.demand(self.peak),
            self.options.acceptable_probability,
            self.context.building.supports.abutting_wall,
            without,
        )
        kept = {"margin_at_least": former.margin_at_least, "margin_below": former.margin_below}
        self.rows[name] = row.model_copy(update=kept if name == "rocking" else {})
        self.choices[name] = replace(choice, keys=keys, words=words, seconds=2.0 * choice.seconds)
        self.results[name], self.decks[place] = result, deck
        self.parts[place] = (name, f"{strategy.label}: {words}", result)
        return True

    # ----- finer checks

    def check_finer(self) -> None:
        """Where two strategies contradict each other without a reason: rigid contacts, half the step, perturbed motions."""
        facts = self.facts()
        _, unexplained = explained(facts, lambda rule, error: None)  # `conclude` reports a rule that fails
        names = {n for p in unexplained if facts.relation(*p) == "disagree" for n in p}
        try:
            for name in (n for n in ("rocking", "dem") if n in names and n in self.results):
                self._check_run(name)
        finally:
            self._tell_finer(names)

    def _tell_finer(self, names: set[str]) -> None:
        """State which finer checks ran for strategies that contradict each other."""
        if names:
            ran = [f"{self.rows[n].label} with {', '.join(told)}" for n, told in self.finer.items()]
            self.finer_told = (
                f"Strategies that contradict each other were run again with finer settings: {' and '.join(ran)}."
                if ran
                else f"No finer check ran for strategies that contradict each other: {' and '.join(sorted(self.rows[n].label for n in names))}."
            )

    def _check_run(self, name: str) -> None:
        """Run a dynamic strategy anew with finer settings; another outcome leaves its own open."""
        row, keys = self.rows[name], self.choices[name].keys
        runs: list[tuple[str, dict[str, Any], float]] = []
        if name == "dem":
            options = self.results[name].asked
            half = (
                {"time_step": 0.5 * options["time_step"]}
                if options.get("time_step")
                else {"fraction": 0.5 * kinds.table("analysis", "dem").model_fields["fraction"].default}
            )
            runs.append(("rigid contacts", _rigid(keys) | ONE_RUN, 1.0))
            runs.append(("half the time step", keys | half | ONE_RUN, 1.0))
            keys = keys | ONE_RUN
        else:
            runs.append(("a tolerance of 1e-10", keys | {"tolerance": 1e-10}, 1.0))
        runs += [(f"the motion times {factor:g}", keys, factor) for factor in PERTURBED]
        other: list[str] = []
        for told, changed, factor in runs:
            model = self.one_motion().deck.require_motion()
            motion = None if factor == 1.0 else hazard.scaled(self.asker.motion, model, factor)
            if factor != 1.0 and motion is None:
                continue
            if self.asker.clock() >= self.asker.deadline:
                raise OutOfTime
            found = self._probe(name, told, self.choices[name].kind or strategies.of(name).kind, changed, motion)
            if found is None:
                continue
            self.finer.setdefault(name, []).append(f"{told} ({self.probes[-1].outcome})")
            if {self.probes[-1].outcome, row.outcome} == {"stands", "collapses"}:
                other.append(f"{told} ({self.probes[-1].outcome})")
        if other:
            text = f"A finer check gives another outcome: {', '.join(other)}."
            self.rows[name] = row.model_copy(
                update={"outcome": "open", "violated": [*row.violated, text], "statement": f"{row.statement} {text}"}
            )

    # ----- refining

    def facts(self) -> Facts:
        return Facts(
            self.context.building,
            self.one_motion().motion,
            self.peak,
            self.rows,
            self.results,
            self.options.apart,
            self.found,
            self._needed,
            self.bare,
        )

    def thin(self, name: str) -> bool:
        """Whether the margin of a strategy may be near 1."""
        low, high = self.facts().interval(name)
        return high > 1.0 / self.options.thin and low < self.options.thin

    def refine(self) -> None:
        """Where strategies differ, or a margin is thin: what shows why, and how far the costly ones are from turning."""
        facts = self.facts()
        pairs = facts.pairs()
        thin = [n for n in facts.judged() if facts.interval(n) != (0.0, np.inf) and self.thin(n)]
        if not pairs and not thin:
            return
        if "rocking" in thin and not self.many:
            self._finer()
        self._cheap_probes(pairs)
        self._elements(pairs)
        self.context.progress(3.0, 3.0, "assess")

    def _finer(self) -> None:
        """The margin of rocking closer, between the factors that enclose it."""
        row = self.rows["rocking"]
        low, high = row.margin_at_least, row.margin_below
        if low is None or high is None:
            return
        levels = [round(float(v), 5) for v in np.linspace(low, high, FINE + 2)]
        found = self._probe(
            "rocking",
            f"the motion at {FINE} factors between {low:g} and {high:g}",
            "fragility",
            {"intensity": "scale", "levels": levels, "bootstrap": 0},
            tell=False,
        )
        if found is not None and isinstance(found.results, OverLevels):
            lower, upper = scaled_margin(found.of(OverLevels))
            self._bracket("rocking", lower or low, upper or high)

    def _cheap_probes(self, pairs: list[Pair]) -> None:
        names = {n for p in pairs for n in p}
        results = self.results
        if "assessment" in names and (impulse := results["assessment"].of(Assessment).primary_impulse) is not None:
            sine = {"kind": "sine-pulse", "amplitude": f"{impulse.amplitude_g!r} g", "period": impulse.period_s}
            self._keep("sine", self._probe("rocking", "the primary impulse alone, one sine", "rocking", {}, sine))
        if "sla" in names and "tilt" in results and not self.context.building.meshed_by_stones:
            keys = {"joints": {"friction": "no-sliding"}}
            self._keep("tilt-no-sliding", self._probe("tilt", "no joint slides", "tilt", keys))

        if "[[ties]]" in self.bare.get("sla", ()) and {"sla", "tilt"} <= set(results):
            self._keep(
                "tilt-without",
                self._probe("tilt", "without the restraints that the elements neglect", "tilt", {}, without=self.bare["sla"]),
            )
        if self.bare and "rocking" in results and any(n in names for n in self.bare):
            every = tuple(sorted({w for there in self.bare.values() for w in there}))
            told = f"without {' and '.join(every)}"
            self._keep("without-restraints", self._probe("rocking", told, "rocking", {}, without=every))

    def _elements(self, pairs: list[Pair]) -> None:
        """Further runs of discrete elements, as many as the nominal budget still holds."""
        if "dem" not in self.results:
            return
        choice, building = self.choices["dem"], self.context.building
        each = max(choice.seconds, 1e-3)
        left = int(strategies.REFINING * self.options.for_strategies / each) - 1  # the perturbed run of the first
        names = {n for p in pairs for n in p}
        r = self.results["dem"].results
        if not isinstance(r, DemRun):
            return
        structure = building.structure
        if isinstance(structure, Column) and structure.height is not None and structure.drums > 1 and "dem" in names:
            changes = {"structure.drums": 1}
            self._keep("monolith", self._probe("dem", "one body instead of drums", "dem", choice.keys | ONE_RUN, None, changes))
        slid = r.peak_slip_m > SLID * float(building.blocks().length.min())
        if slid and "dem" in names and not any(t.friction is not None for t in building.joints.types):
            if left < 1:
                self.not_done.append("discrete elements without sliding")
            else:
                left -= 1
                keys = _merged(choice.keys, {"joints": {"friction": "no-sliding"}} | ONE_RUN)
                self._keep("no-sliding", self._probe("dem", "no joint slides", "dem", keys))
        if not r.decided_by_last_digits:
            self._turning(left, choice)

    def _turning(self, left: int, choice: Choice) -> None:
        """The factors on the hazard between which discrete elements turn to fall."""
        motion, model = self.asker.motion, self.one_motion().deck.require_motion()
        stands = self.rows["dem"].outcome == "stands"
        low, high = (1.0, None) if stands else (None, 1.0)
        if self.rows["dem"].outcome == "open":
            low = high = None
        for factor in UP if stands else DOWN:
            table = hazard.scaled(motion, model, factor)
            if table is None:
                self.not_done.append("discrete elements at other factors: the spectrum is not in proportion to them")
                break
            if left < 1:
                self.not_done.append(f"discrete elements at {factor:g} times the motion and beyond")
                break
            left -= 1
            found = self._probe("dem", f"the motion times {factor:g}", "dem", choice.keys | ONE_RUN, table)
            if found is None:
                break
            if found.results.require_verdict(self.asker.demand(self.peak)).outcome == "open":
                self.not_done.append(f"discrete elements at {factor:g} times the motion still move in the end")
                break
            falls = found.of(DemRun).outcome == "collapse"
            low, high = (low, factor) if falls else (factor, high)
            if falls == stands:
                break
        self._bracket("dem", low, high)

    def _probe(
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
        without = self.asker.cannot_bear(kind) if without is None else without
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

    def _keep(self, name: str, found: Result | None) -> None:
        if found is not None:
            self.found[name] = found

    @property
    def _needed(self) -> Callable[[float], float | None]:
        """Shortest constant push of an amplitude [g] that brings it down [s]; None where no mechanism rocks."""
        if not hasattr(self, "_pushes"):

            @cache
            def needed(amplitude: float) -> float | None:
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
                }
                found = self._probe(
                    "rocking", f"a constant lateral acceleration of {amplitude:.3g} g, how long", "failure-domain", keys, tell=False
                )
                if found is None or not isinstance(found.results, FailureDomain) or found.results.at_amplitudes is None:
                    return None
                return found.results.at_amplitudes.mode_I_durations_s[0]

            self._pushes = needed
        return self._pushes

    # ----- what to do

    def advise(self) -> None:
        """The least interventions, where the building does not stand under all strategies."""
        facts = self.facts()
        if all(facts.outcome(n) == "stands" for n in facts.judged()) or self.rows.get("tilt") is None:
            return
        found = advice.advise(self.asker, self.peak, "rocking" in self.results)
        if isinstance(found, str):
            self.not_done.append(f"strengthening: {found}")
        else:
            self.advice = found

    # ----- sensitivity

    def move(self) -> None:
        """Margins with values of the deck moved one by one, as many as the budget allows."""
        if not strategies.of("tilt").applies(self.context.building):
            self.not_done.append("sensitivity: limit analysis and rocking cannot analyse a building on a plan; `pushover` has variants")
            return
        rocked = self.results.get("rocking")
        restitution = rocked.of(RockingResults).restitution if rocked is not None else None
        keys = sensitivity.varied(self.context.building, self.options.vary, restitution)
        data = {k: v for k, v in self.context.deck.data.items() if k not in ("analysis", "title", "note")}
        count = self.motions if self.many else None
        margins = sensitivity.Margins(
            self.context,
            data,
            strategies.LEVELS_OF_A_SET if self.many else strategies.LEVELS,
            count,
            self.options.acceptable_probability,
            self.peak,
            self.asker,
        )
        try:
            self.moved = margins.moved(keys)
        except Unfinished as stop:
            if stop.interrupted:
                raise Interrupted from None
            self.not_done.append(f"sensitivity: {stop}")
        if margins.stopped:
            if "dem" in self.results:
                self.not_done.append("stiffness of the joints and moving supports by discrete elements: the time ran out")
            raise OutOfTime
        self._move_elements()

    def _move_elements(self) -> None:
        """What only discrete elements know: stiffness of the joints, and a support that moves while it shakes."""
        if "dem" not in self.results:
            return
        choice, stones = self.choices["dem"], self.context.building.blocks()
        r = self.results["dem"].results
        if not isinstance(r, DemRun):
            return
        stiffness = choice.keys.get("joints", {}).get("normal_stiffness", r.joint_stiffness_max_Pa_per_m)
        self._turn_elements(
            "joints.normal_stiffness",
            "Pa/m",
            stiffness,
            (stiffness / STIFFER, stiffness * STIFFER),
            lambda v: f"joints {v / stiffness:.3g} times as stiff",
            lambda v: {"joints": {"normal_stiffness": v}},
        )
        grounded = np.flatnonzero((stones.a < 0) | (stones.b < 0))
        if len(grounded) > 1:
            right = stones.joint_names[int(grounded[np.argmax(stones.middle[grounded, 0])])]
            spread = SPREAD * stones.size
            self._turn_elements(
                "initial.movements.dx",
                "m",
                0.0,
                (-spread, spread),
                lambda v: f"the right support moves {'out' if v > 0.0 else 'in'} by {1e3 * abs(v):.3g} mm in the first second",
                lambda v: {"initial": {"movements": [{"joint": right, "dx": v}]}},
            )

    def _turn_elements(
        self,
        key: str,
        unit: str,
        base: float,
        ends: tuple[float, float],
        told: Callable[[float], str],
        keys: Callable[[float], dict[str, Any]],
    ) -> None:
        """Move one value of discrete elements down and up; between it and an end that turns them seek where they turn."""
        choice, r = self.choices["dem"], self.results["dem"].results
        assert isinstance(r, DemRun)

        def ask(value: float) -> DemRun | None:
            found = self._probe("dem", told(value), "dem", _merged(choice.keys, keys(value)))
            return found.results if found is not None and isinstance(found.results, DemRun) else None

        def share(one: DemRun | None) -> float | None:
            return None if one is None else one.peak_displacement_m / one.collapse_displacement_m

        low, high = ask(ends[0]), ask(ends[1])
        turns = None
        fell = r.outcome == "collapse"
        turned = [e for e, one in zip(ends, (low, high), strict=True) if one is not None and (one.outcome == "collapse") != fell]
        if turned and self.rows["dem"].outcome != "open":
            near, far = base, min(turned, key=lambda e: abs(e - base))
            for _ in range(ELEMENT_HALVINGS):
                middle = float(np.sqrt(near * far)) if near > 0.0 else 0.5 * (near + far)
                one = ask(middle)
                if one is None:
                    break
                near, far = (near, middle) if (one.outcome == "collapse") != fell else (middle, far)
            turns = float(np.sqrt(near * far)) if near > 0.0 else 0.5 * (near + far)
        self.shaken.append(
            out.TurningValue(
                key=key,
                base=base,
                unit=unit,
                low=ends[0],
                high=ends[1],
                tilt_base=None,
                rocking_base=None,
                tilt_low=None,
                tilt_high=None,
                rocking_low=None,
                rocking_high=None,
                tilt_turns=None,
                rocking_turns=None,
                dem_base=share(r),
                dem_low=share(low),
                dem_high=share(high),
                dem_turns=turns,
            )
        )

    def _sensitivity(self) -> list[out.TurningValue]:
        """Rows of the tornado, the widest first, those of discrete elements after them."""

        def width(m: sensitivity.Moved) -> float:
            spans = [abs(np.log(b / a)) for a, b in zip(m.at_low, m.at_high, strict=True) if a and b]
            return max(spans, default=0.0)

        return [
            out.TurningValue(
                key=m.what.key,
                base=m.what.base,
                unit=m.what.unit,
                low=m.low,
                high=m.high,
                tilt_base=m.at_base[0],
                rocking_base=m.at_base[1],
                tilt_low=m.at_low[0],
                tilt_high=m.at_high[0],
                rocking_low=m.at_low[1],
                rocking_high=m.at_high[1],
                tilt_turns=m.turns[0],
                rocking_turns=m.turns[1],
                dem_base=None,
                dem_low=None,
                dem_high=None,
                dem_turns=None,
            )
            for m in sorted(self.moved, key=width, reverse=True)
        ] + self.shaken

    # ----- the answer

    def conclude(self, result: Result) -> None:
        """Rows, agreement, reasons, overall statement, arrays and files into `result`."""
        facts = self.facts()
        try:
            reasons, unexplained = explained(facts, lambda rule, error: self._failed(f"reason {rule}", error))
        except Interrupted:
            reasons, unexplained = [], facts.pairs()
        there = [a.kind for a in self.context.deck.analyses]
        names = group_names(there + [r.kind for _, _, r in self.parts])[len(there) :]
        rows = []
        for row in self.rows.values():
            part = next((n for n, (s, _, _) in zip(names, self.parts, strict=True) if s == row.strategy), None)
            rows.append(row.model_copy(update={"part": part}))
        judged = facts.judged()
        agreement = {a: {b: facts.relation(a, b) for b in judged if b != a} for a in judged}
        # a strategy by which the building stands, although its factor is not known from below 1 on, has no least factor
        margins = [
            (low if row.margin is None else row.margin, row.strategy)
            for row in rows
            if row.outcome != "not-applicable"
            if (
                (low := row.margin_at_least if row.outcome == "stands" else row.margin_below) is not None
                and (row.outcome != "stands" or low >= 1.0)
            )
            or row.margin is not None
        ]
        least = min(margins, default=(None, None), key=lambda m: m[0] if m[0] is not None else np.inf)
        overall, statement = conclusion(facts, reasons, unexplained, self.context.building.require_structure().word, least, rows)
        fragility = self.results.get("probability")
        chance = estimate_collapse(rows, None if fragility is None else fragility.results)
        if self.finer_told:
            statement += f" {self.finer_told}"
        if overall != "cannot stand":
            statement += f" {chance.statement}"
        impulse = hazard.primary(facts.motion)
        model = self.context.deck.require_motion()
        found = out.Assess(
            overall=overall,
            statement=statement,
            hazard=out.AssessHazard(
                kind=model.kind,
                told=self._hazard_told(facts.motion),
                motions=self.motions,
                **self.chosen,
                peak_ground_acceleration_g=self.peak,
                peak_told=self.peak_told,
                pulse_amplitude_g=impulse and impulse[0],
                pulse_period_s=impulse and impulse[1],
            ),
            verdicts=rows,
            agreement=agreement,
            collapse_probability=chance,
            reasons=reasons,
            unexplained=[list(p) for p in unexplained],
            parts=dict(zip(names, (words for _, words, _ in self.parts), strict=True)),
            probes=self.probes,
            **given(sensitivity=self._sensitivity() if self.moved or self.shaken else None, advice=self.advice),
            not_done=self.not_done,
            least_margin=least[0],
            least_margin_strategy=least[1],
            budget_s=self.options.budget,
        )
        result.results = found
        result.parts = [r for _, _, r in self.parts]
        for name, deck in zip(names, self.decks, strict=True):
            head = f"# {name}: one part of an assessment of {self.context.deck.path}; run it in the folder of that deck.\n"
            result.files[f"assess/{name}.toml"] = (head + deck).encode(errors="replace")  # names of files may be no text
        result.files |= self.faults
        self._arrays(facts, rows, result)
        result.answer = answer(statement, rows, reasons, found.sensitivity or [])
        if self.advice is not None:
            result.answer += f"\nStrengthening. {self.advice.statement}"
        result.warnings += [f"{row.label}: {row.status}: {row.reason}" for row in rows if row.status in ("failed", "left out")]

    def _hazard_told(self, motion: Any) -> str:
        name = self.context.deck.require_motion().kind
        if self.many:
            return f"{self.motions} motions of kind {name}; single runs take motion {self.chosen['member']}, {self.chosen['chosen_by']}"
        return f"{motion.name or name}, {motion.end:.3g} s"

    def _arrays(self, facts: Facts, rows: list[out.StrategyVerdict], result: Result) -> None:
        low, high = np.array([facts.interval(r.strategy) for r in rows]).reshape(-1, 2).T
        result.arrays = {
            "margin_low": Array(low, ("strategy",), "", "factors on the hazard between which each verdict changes"),
            "margin_high": Array(np.where(np.isinf(high), np.nan, high), ("strategy",), "", "NaN: not known"),
        }
        time_s, ground = facts.motion.series()
        thin = slice(None, None, max(1, len(time_s) // 4000))
        result.arrays |= {"time": Array(time_s[thin], ("time",), "s"), "ground": Array(ground[thin], ("time",), "m/s^2", "the motion")}
        if self.moved:
            flat = [(m.what.key, value, *margins) for m in self.moved for value, margins in m.tried]
            names = ("key", "value", "margin_tilt", "margin_rocking")
            result.tables["sensitivity"] = TableData(
                {n: [np.nan if row[k] is None else row[k] for row in flat] for k, n in enumerate(names)}
            )
        columns = (
            "strategy",
            "part",
            "status",
            "axis",
            "demand",
            "capacity",
            "unit",
            "outcome",
            "margin",
            "margin_at_least",
            "margin_below",
            "parameters",
            "statement",
            "reason",
        )
        result.tables["assess"] = TableData(
            {c: [("" if c in ("part",) else np.nan) if row[c] is None else row[c] for row in rows] for c in columns}
        )


def _merged(keys: dict[str, Any], given: dict[str, Any]) -> dict[str, Any]:
    """Keys with those of another table over them, table by table."""
    made = dict(keys)
    for name, value in given.items():
        below = made.get(name)
        made[name] = _merged(below, value) if isinstance(below, dict) and isinstance(value, dict) else value
    return made


def _end_of_motion(result: Result | None) -> float | None:
    """End [s] of a run in which the structure still moved; None for others."""
    if result is None:
        return None
    r = result.results
    if isinstance(r, DemRun):
        return r.stop_time_s if r.still_moving else None
    if not isinstance(r, RockingResults) or r.outcome == "collapse":
        return None
    if r.hand_over is not None:
        contacts = r.hand_over.contacts
        return contacts.stop_time_s if contacts.still_moving else None
    return None if r.settled else float(np.asarray(result.arrays["time"].data)[-1])


def _rigid(keys: dict[str, Any]) -> dict[str, Any]:
    """Keys of a run of discrete elements on rigid contacts, which have no springs."""
    joints = {k: v for k, v in keys.get("joints", {}).items() if f"joints.{k}" not in OF_SPRINGS}
    kept = {k: v for k, v in keys.items() if k not in ("joints", "fraction", "mass_damping", "time_step")}
    return kept | ({"joints": joints} if joints else {}) | {"solver": "nonsmooth"}


def _told(given: dict[str, Any]) -> str:
    return ", ".join(f"{k} = {v}" for k, v in given.items())


def _governing(found: Result) -> int:
    """Which motion of a set, from 1, leaves so many with a smaller rotation; those that bring it down count as farthest."""
    table = found.tables["ensemble"].columns
    at_one = np.isclose(np.asarray(table["level"], dtype=float), 1.0)
    motion = np.asarray(table["motion"])[at_one]
    outcome = np.asarray(table["outcome"])[at_one]
    ratio = np.asarray(table["peak_ratio"], dtype=float)[at_one]
    ratio = np.where(outcome == "collapse", np.inf, np.where(np.isnan(ratio), -np.inf, ratio))
    order = np.argsort(ratio, kind="stable")
    return int(motion[order[min(len(order) - 1, int(np.ceil(hazard.GOVERNING * len(order))) - 1)]])
