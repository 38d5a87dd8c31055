"""What a building is worth by the analysis that measures the target: limit analysis, or the verdict of any other."""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, Literal

import numpy as np

from extrados.analyses.changes import changed, lacking
from extrados.analyses.conclude import MotionDemand
from extrados.analyses.context import Context, Refused
from extrados.analyses.limit.common import collapse_beside, hinge_rows, limit_of
from extrados.analyses.limit.outcome import Signature
from extrados.analyses.limit.variation import signature
from extrados.analyses.sequence import run_one
from extrados.analyses.strengthen.alternatives import TieAlternative
from extrados.analyses.strengthen.tables import Strengthen
from extrados.core.errors import Cancelled, status_code
from extrados.decks.reader import Deck, DeckError, make_deck
from extrados.limit.answer import cannot_stand
from extrados.limit.errors import Immovable, NoAnswer, NoEquilibrium
from extrados.limit.finite_motion import finite_motion
from extrados.limit.programme import LimitAnalysis, Mechanism, closed
from extrados.limit.strengthening import Point, least_force, least_forces, taken_per_force
from extrados.model.errors import BadGeometry
from extrados.model.geometry.assembly import Assembly
from extrados.model.geometry.solids.assembly import SolidAssembly
from extrados.results.model import Result
from extrados.results.statistics import Ensemble
from extrados.results.verdict import SelfWeight
from extrados.schema.constants import GRAVITY
from extrados.views.building import Building

#: Of the greatest capacity: where a tie that never yields is taken to have reached it
REACHED = 1e-6
#: Of the target: rounding of the bisection that raises a force until it is met without dilatancy
SLACK = 1e-3
#: Hinges and sliding joints that are named
MOST_NAMED = 6
#: Keys of an analysis that limit analysis takes from this table
OWN = ("friction_rule", "starts", "load", "material", "joints", "supports", "initial")
Bound = Literal["exact", "upper"]
#: Analyses of a motion, whose open outcome meets no target
DYNAMIC = ("rocking", "dem")


@dataclass(frozen=True)
class Worth:
    """The value of a building in the quantity of the target: None without one, infinite where no mechanism exists.

    mechanism: what governs, in words; shape: the same but for mirror images; bound: of the value; reason: why there is none; moved: the blocks and the poses into which
    the mechanism carries them; sense: of the load that governs, in space its direction [deg]; in_space: as moved, of solids; beside: the least found without
    dilatancy, where it is not the value; unfound: why no state without dilatancy was found where one was sought.
    """

    value: float | None
    mechanism: str = ""
    shape: Signature = ()
    bound: Bound | None = None
    reason: str = ""
    by_sense: tuple[float, ...] = ()
    moved: tuple[Assembly, np.ndarray] | None = None
    sense: float = 1
    in_space: tuple[SolidAssembly, np.ndarray] | None = None
    beside: float | None = None
    unfound: str = ""


class Statics:
    """Capacity by limit analysis [g]: the least over the senses of the load."""

    higher_is_safer = True

    def __init__(self, context: Context, options: Strengthen, closely: bool = True):
        self.context, self.options, self.closely = context, options, closely
        self.smooth, self.reached = context.building.material.compressive_strength is not None, REACHED
        wall = context.building.supports.abutting_wall
        given = {"both": (1, -1), "+x": (1,), "-x": (-1,)}[options.direction]
        self.senses: tuple[float, ...] = tuple(s for s in given if {"left": -1, "right": 1}.get(wall or "") != s)
        if not self.senses:
            raise Refused(
                f"direction: the abutting wall is on that side ({wall}), so the building cannot collapse towards this wall",
                ("analysis", "direction"),
            )

    def of(self, building: Building, picture: bool = False) -> Worth:
        """The capacity and what governs; picture: also the mechanism carried on."""
        try:
            limit = limit_of(building, self.options)
        except (BadGeometry, Refused) as error:
            return Worth(None, reason=str(error))
        values: list[float] = []
        told: list[str] = []
        bounds: list[Bound] = []
        mechanisms: list[Mechanism | None] = []
        unfound = ""
        for sense in map(int, self.senses):
            try:
                state, mechanism = limit.collapse(sense)
                value = sense * state.gamma
                value, bound, why = self._least(limit, mechanism, sense, value, self.closely and (picture or value >= self.target))
                unfound = unfound or why
            except Immovable as error:
                values.append(np.inf)
                told.append(f"none to {_word(sense)}: {error}")
                bounds.append("exact")
                mechanisms.append(None)
                continue
            except NoEquilibrium:
                return self._fallen(limit)
            except NoAnswer as error:
                return Worth(None, reason=str(error))
            if value < 0.0:
                return self._fallen(limit)
            values.append(value)
            told.append(mechanism_told(limit.assembly, mechanism, sense))
            bounds.append(bound)
            mechanisms.append(mechanism)
        if len(self.senses) == 1 and not limit.stands():
            return self._fallen(limit)
        k = int(np.argmin(values))
        chosen = mechanisms[k]
        moved = (limit.assembly, finite_motion(limit.assembly, chosen)) if picture and chosen is not None else None
        shape = () if chosen is None else unmirrored(signature(limit.assembly, chosen))
        by_sense = tuple(values)
        return Worth(float(values[k]), told[k], shape, bounds[k], by_sense=by_sense, moved=moved, sense=self.senses[k], unfound=unfound)

    def other_sense_told(self, building: Building) -> str:
        """What the existing building carries in the sense that the deck leaves out."""
        sense = -int(self.senses[0])
        try:
            carried = f"{sense * self.collapse(limit_of(building, self.options), sense)[0].gamma:.3g} g"
        except Immovable:
            carried = "any load"
        except (NoEquilibrium, NoAnswer) as error:
            carried = f"no load: {error}"
        return (
            f"The target refers only to a load towards {_word(int(self.senses[0]))}. Towards {_word(sense)}, "
            f"the existing building carries {carried}. An earthquake acts in both directions: give direction "
            f'= "both", unless the building is restrained towards {_word(sense)}.'
        )

    def _least(self, limit: LimitAnalysis, mechanism: Mechanism, sense: int, value: float, closely: bool) -> tuple[float, Bound, str]:
        """The capacity, as which bound, and why no state without dilatancy was found; where pressed joints slide the least such state,
        which takes seconds and is not sought where the upper bound already misses the target."""
        if not limit.associated:
            return value, "upper", ""
        if not limit.dilating(mechanism):
            return value, "exact", ""
        if not closely:
            return value, "upper", ""
        try:
            state, _ = collapse_beside(limit.without_dilatancy(), sense)
        except (NoAnswer, NoEquilibrium) as error:
            return value, "upper", f"friction governs, and no state without dilatancy was found towards {_word(sense)}: {error}"
        return min(value, sense * state.gamma), "upper", ""

    def _fallen(self, limit: LimitAnalysis) -> Worth:
        """0 with the proof."""
        try:
            return Worth(0.0, "collapse under self-weight", bound="exact", reason=str(cannot_stand(limit)))
        except NoAnswer as error:
            return Worth(None, reason=str(error))

    def of_data(self, data: dict[str, Any], picture: bool = False) -> Worth:
        """The same of a deck's data."""
        own = {k: v for k, v in self.options.model_dump(exclude_unset=True).items() if k in OWN and v is not None}
        plain = lacking(data, [w for w in self.context.building.special_keys if w == "[supports] abutting_wall"])
        try:
            deck = make_deck({**plain, "analysis": [{"kind": "tilt", **own}]}, self.context.deck.folder)
        except DeckError as error:
            return Worth(None, reason="; ".join(error.complaints))
        return self.of(deck.buildings[0], picture)

    def carrying(self, one: TieAlternative, place: int) -> "Statics":
        """Itself with the weight of a ring beam among the loads."""
        if not (loads := one.loads(place)):
            return self
        options = self.options.model_copy(update={"load": [*self.options.load, *loads]})
        return Statics(self.context, options, self.closely)

    def point(self, one: TieAlternative, place: int, force: float) -> Point:
        """A point of the capacity curve over the force of a tie, with dilatant friction; Immovable where nothing moves."""
        building = self.context.building
        limit = limit_of(one.having(building, place, force), self.options)
        found = []
        for sense in map(int, self.senses):
            try:
                state, mechanism = self.collapse(limit, sense)
            except Immovable:
                continue
            tied = building.having(ties=(one.places[place],)).anchored()
            slope = taken_per_force(limit.assembly, limit.loads, tied, mechanism, one.places[place].works_in)
            found.append(Point(force, sense * state.gamma, slope, sense, mechanism))
        if not found:
            raise Immovable("no load of this kind causes collapse")
        return min(found, key=lambda p: p.capacity)

    def unlimited(self, one: TieAlternative, place: int) -> float | None:
        """The capacity with a tie that never yields, with dilatant friction; None where it leaves no mechanism."""
        limit = limit_of(one.having(self.context.building, place, None), self.options)
        values = []
        for sense in map(int, self.senses):
            try:
                values.append(sense * self.collapse(limit, sense)[0].gamma)
            except Immovable:
                continue
        return min(values, default=None)

    def told_at(self, point: Point) -> str:
        """The mechanism of a point of a curve in words."""
        return mechanism_told(self.context.building.blocks(), point.mechanism, int(point.direction))

    def word(self, sense: float) -> str:
        """A sense of the load in words."""
        return _word(int(sense))

    @staticmethod
    def collapse(limit: LimitAnalysis, sense: int) -> tuple[Any, Mechanism]:
        """Collapse with dilatant friction, whose capacity is concave in the force of a tie."""
        return (
            limit.collapse(sense)
            if limit.associated
            else LimitAnalysis(limit.assembly, limit.friction, strength=limit.strength, loads=limit.loads).collapse(sense)
        )

    def force(self, one: TieAlternative, place: int, target: float) -> float:
        """The same of one tie, by the programme of the structure itself; infinite where no force suffices."""
        building, tie = self.context.building, one.places[place]
        limits = []
        for works_in, sign in (("tension", 1), ("compression", -1)):
            if tie.works_in in (works_in, "both"):
                added = tie.model_copy(update={"works_in": works_in, "yield_force": None})
                held = building.having(ties=(*building.ties, added))
                limits.append((limit_of(held, self.options, forces_only=True), sign))
        try:
            needed = max(min(least_force(limit, gamma, sign) for limit, sign in limits) for gamma in self.cases(target))
        except NoAnswer:  # where its solver gives up, the programme over all cases is solved by another method
            try:
                needed = float(self.forces([(one, place)], target)[0])
            except NoEquilibrium:
                return np.inf
        return needed if needed <= one.most else np.inf

    def cases(self, target: float) -> list[float]:
        """Accelerations to +x that are to be carried [g]: the target in its senses, and rest."""
        return [sense * target for sense in self.senses] + ([] if len(self.senses) == 2 else [0.0])

    def forces(self, ties: list[tuple[TieAlternative, int]], target: float) -> np.ndarray:
        """Yield forces [N] of least sum with which the building carries the target both ways and stands at rest."""
        building = self.context.building
        added = tuple(one.places[place].model_copy(update={"yield_force": None}) for one, place in ties)
        limit = limit_of(building.having(ties=(*building.ties, *added)), self.options, forces_only=True)
        gammas = self.cases(target)
        most = np.array([one.most for one, _ in ties])
        return least_forces([limit] * len(gammas), gammas, len(ties), np.ones(len(ties)), most)

    @cached_property
    def demand(self) -> float:
        """To what safety factors refer [g]."""
        if self.options.acceleration is not None:
            return float(self.options.acceleration) / GRAVITY
        return MotionDemand(self.context).peak_g or 0.0

    @property
    def aimed(self) -> float:
        """The capacity for which ties are sized [g]: the target, and the distance that rounding leaves between bounds."""
        return self.target + 2.0 * closed(len(self.context.building.blocks().a), self.target)

    @property
    def target(self) -> float:
        """The capacity that is required [g]."""
        return self.demand * (self.options.safety_factor or 1.0)


class Runs:
    """The verdict of another analysis: its safety factor, or the probability of collapse of a fragility."""

    def __init__(self, context: Context, options: Strengthen):
        self.context, self.options = context, options
        self.by_probability = options.by == "fragility"
        self.higher_is_safer = not self.by_probability
        self.demand = None if self.by_probability else 1.0
        self.target = (options.probability if self.by_probability else options.safety_factor) or 1.0

    def of_data(self, data: dict[str, Any], keys: dict[str, Any] | None = None) -> Worth:
        """The value of a deck's data; keys: of the analysis, in place of the options of the table."""
        own = {k: v for k, v in self.options.model_dump(exclude_unset=True).items() if k in OWN[3:] and v is not None}
        asked = {"kind": self.options.by, **own, **(self.options.options if keys is None else keys)}
        try:
            deck = make_deck({**data, "analysis": [asked]}, self.context.deck.folder)
        except DeckError as error:
            return Worth(None, reason="; ".join(error.complaints))
        context = nested(self.context, deck)
        result = run_part(context)
        if result.status != "ok":
            return Worth(None, reason=result.reason)
        if isinstance(result.results, SelfWeight) and not result.results.proven:
            return Worth(None, reason=result.results.statement())
        if isinstance(result.results, SelfWeight):
            return Worth(1.0 if self.by_probability else 0.0, "collapse under self-weight")
        if self.by_probability:
            if not isinstance(result.results, Ensemble):
                raise Refused(
                    "`levels` of the options is not used here: use the key `levels` of this table instead", ("analysis", "options")
                )
            share = result.results.collapse_probability
            return Worth(share, "rocking until it overturns", reason="" if share is not None else "no motion could be run")
        verdict = result.results.judged(MotionDemand(context))
        if verdict is None or verdict.ratio is None:
            told = "" if verdict is None else f": {verdict.statement}"
            return Worth(None, reason=f"{self.options.by} gives no safety factor{told}")
        if verdict.outcome == "open" and self.options.by in DYNAMIC:  # one run as a sample, or a run that still moves
            return Worth(
                None, reason=f"`{self.options.by}` does not decide whether the structure collapses: {verdict.statement.rstrip('.')}"
            )
        return Worth(verdict.ratio, verdict.statement.rstrip("."))


Measure = Statics | Runs


def reached(measure: Measure, worth: Worth) -> bool:
    """Whether a value meets the target."""
    if worth.value is None or np.isnan(worth.value):
        return False
    return worth.value >= measure.target if measure.higher_is_safer else worth.value <= measure.target


def meets(measure: Measure, worth: Worth) -> bool:
    """Whether a value meets the target, and the least state without dilatancy too, where one was sought beside an upper bound."""
    return not unmet_reason(measure, worth)


def unmet_reason(measure: Measure, worth: Worth) -> str:
    """Why a value does not meet the target, in words; empty where it does."""
    if worth.value is None:
        return worth.reason or "no value was found"
    if not reached(measure, worth):
        least = ", an upper bound or the lowest value found without dilatancy," if worth.bound == "upper" else ""
        return f"the value is {worth.value:.3g}{least} and the target is {measure.target:.3g}"
    if worth.unfound:
        return worth.unfound
    if worth.beside is not None and worth.beside <= (1.0 - SLACK) * measure.target:
        return (
            "only the upper bound of limit analysis (dilatant friction) meets the target. The lowest "
            f"collapse acceleration found without dilatancy is {worth.beside:.3g} g, and this value does not meet the target"
        )
    return ""


def over_demand(value: float | None, demand: float | None) -> float | None:
    """The safety factor of a value; None without a demand."""
    return None if value is None or not demand else value / demand


def safest(measure: Measure, values: list[float]) -> float | None:
    """The greatest value, of a probability the least; None without any."""
    known = [v for v in values if np.isfinite(v)]
    if not known:
        return None
    return max(known) if measure.higher_is_safer else min(known)


def nested(context: Context, deck: Deck) -> Context:
    """A context for a deck of a part."""
    whole = context.deck
    deck = replace(deck, sha256=whole.identity, path=whole.path)
    return Context(deck, context.threads, motions=context.motions)


def run_part(context: Context) -> Result:
    """The result of the one analysis of a part; Cancelled where it was interrupted, which says nothing about the building."""
    (options,), (building,) = context.deck.analyses, context.deck.buildings
    result = run_one(context, options, building)
    if result.status == "interrupted":
        raise Cancelled(status_code("cancelled"), result.reason)
    return result


def with_value(context: Context, options: Strengthen, key: str, value: float) -> tuple[dict[str, Any], dict[str, Any] | None]:
    """The deck's data with a key changed, and the options where the key is one of them."""
    data = plain_data(context)
    if key.startswith("options."):
        return data, changed({"options": options.options}, key, value)["options"]
    return changed(data, key, value), None


def plain_data(context: Context) -> dict[str, Any]:
    """The deck without its analyses and titles."""
    return {k: v for k, v in context.deck.data.items() if k not in ("analysis", "title", "note")}


def mechanism_told(assembly: Assembly, mechanism: Mechanism, sense: int) -> str:
    """A mechanism in words: the sense of the load, hinges and sliding joints."""
    hinges = [hinge.told() for hinge in hinge_rows(assembly, mechanism.hinges, mechanism.pivot)[:MOST_NAMED]]
    more = len(mechanism.hinges) - MOST_NAMED
    parts = []
    if hinges:
        parts.append(f"hinges at {', '.join(hinges)}{f' and {more} more' if more > 0 else ''}")
    if mechanism.sliding:
        names = [assembly.joint_names[j] for j in mechanism.sliding[:MOST_NAMED]]
        more = len(mechanism.sliding) - MOST_NAMED
        parts.append(f"sliding or opening of {', '.join(names)}{f' and {more} more' if more > 0 else ''}")
    return f"load to {_word(sense)}: {'; '.join(parts)}"


def unmirrored(found: Signature) -> Signature:
    """A mechanism that is the same for its mirror image: hinges of a chain in the lesser order, left and right alike."""
    sides = [(name.replace("left", "side").replace("right", "side"), min(marks, marks[::-1])) for name, marks in found]
    return tuple(sorted(sides))


def _word(sense: int) -> str:
    return "+x" if sense > 0 else "-x"
