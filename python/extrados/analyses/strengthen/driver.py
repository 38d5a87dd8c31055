"""strengthen: the least intervention of each kind that meets a target, compared, and what governs then."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from extrados.analyses.batches import stop_if_asked
from extrados.analyses.context import Context
from extrados.analyses.limit.common import geometry_arrays, packed
from extrados.analyses.limit.solids import scene_arrays
from extrados.analyses.sequence import run_one
from extrados.analyses.statistics.summaries import wilson
from extrados.analyses.strengthen.alternatives import (
    ChangeAlternative,
    TieAlternative,
    change_alternatives,
    is_spatial,
    tie_alternatives,
    word_of,
)
from extrados.analyses.strengthen.anchorage import check_anchorage
from extrados.analyses.strengthen.measures import Measure, Runs, Statics, Worth, nested, plain_data, with_value
from extrados.analyses.strengthen.space import SpaceStatics
from extrados.analyses.strengthen.tables import Strengthen
from extrados.decks.reader import DeckError, make_deck
from extrados.limit.errors import Immovable, NoAnswer, NoEquilibrium
from extrados.limit.strengthening import Point, concave_curve, pieces_of
from extrados.model.errors import BadGeometry
from extrados.model.geometry.polygons import signed_area
from extrados.model.geometry.solids.polyhedra import moments
from extrados.model.ties import Tie
from extrados.results import strengthen as out
from extrados.results.assess import Assess, StrategyVerdict
from extrados.results.model import Array, Result, TableData
from extrados.results.statistics import OverLevels
from extrados.schema.constants import GRAVITY
from extrados.schema.quantities import engineering
from extrados.views.building import Building

#: How far beyond the force of the greatest capacity, or beyond the required one, a curve goes
BEYOND = 1.15
#: Relative precision of a curve that crushing bends
SMOOTH = 1e-4
#: Halvings of the interval in which a size meets the target, of cheap analyses and of others
HALVINGS, HALVINGS_OF_RUNS = 16, 5
#: Analyses that take milliseconds
CHEAP = ("tilt", "local-mechanism", "code-checks")
#: Forces at which runs are made before the interval is halved
FORCES_OF_RUNS = 5
#: Changes of a capacity, or of a mass, that are named
NAMED = 0.01
#: Of the target: rounding of the bisection that raises a force until it is met without dilatancy
SLACK = 1e-3


@dataclass
class _Sized:
    """An alternative with its size: results, curve (sizes, values), and the deck with it."""

    row: out.Intervention
    curve: tuple[list[float], list[float]] = ((), ())  # type: ignore[assignment]
    places: tuple[list[float], list[float], list[float]] | None = None  # x, y of the middle, force
    data: dict[str, Any] | None = None
    worth: Worth | None = None
    tie: Tie | None = None
    costs: list[float] = field(default_factory=list)


def run(context: Context, options: Strengthen, closely: bool = True) -> Result:
    """Sizes of all alternatives, their costs and adverse effects, the mechanisms that govern before and after.

    closely: False takes the upper bound by dilatant friction where pressed joints slide, in a fraction of the time.
    """
    building, measure = context.building, measure_of(context, options, closely)
    result = Result("strengthen")
    before = measure.of(building, picture=True) if isinstance(measure, Statics) else measure.of_data(plain_data(context))
    met = _reached(measure, before)
    work = _Work(context, options, measure, before)
    sized: list[_Sized] = []
    ties = tie_alternatives(building, options) if building.structure is not None else []
    changes = change_alternatives(context, options)
    if met:  # nothing to size
        ties, changes = [], []
    alternatives: list[TieAlternative | ChangeAlternative] = [*ties, *changes]
    for done, one in enumerate(alternatives):
        stop_if_asked()
        context.progress(done, len(ties) + len(changes), "alternatives")
        sized.append(work.tie(one) if isinstance(one, TieAlternative) else work.change(one))
    sized.sort(key=lambda s: (not s.row.meets_target, np.inf if s.row.cost is None else s.row.cost))
    more: dict[str, Any] = {}
    if options.combine and isinstance(measure, Statics) and len(ties) > 1 and options.ties:
        more |= work.combined(ties)
    if options.assess:
        work.assessed(sized)
    best = next((s for s in sized if s.row.meets_target), None)
    if options.fragility and best is not None and best.data is not None:
        more["fragility"] = work.fragility(best)
    quantity, unit = _quantity(options)
    result.results = out.Strengthen(
        by=options.by,
        quantity=quantity,
        unit=unit,
        target=measure.target,
        demand=measure.demand,
        direction=_direction(measure, options),
        value_before=before.value,
        safety_factor_before=_over(before.value, measure.demand),
        met_before=met,
        mechanism_before=before.mechanism or before.reason,
        interventions=[s.row for s in sized],
        **more,
    )
    if before.value is None:
        result.warnings.append(f"The existing building has no value: {before.reason}")
    if before.bound == "upper":
        result.warnings.append(
            "Pressed joints slide in the mechanism of the existing building: its capacity is an upper bound, or the least of the states found without dilatancy. Curves over sizes are upper bounds."
        )
    if isinstance(measure, Statics) and len(measure.senses) == 1 and building.supports.abutting_wall is None:
        result.warnings.append(measure.other_sense_told(building))
    result.arrays = _arrays(context, before, sized)
    result.tables = {"strengthen": _table(sized)}
    result.answer = _words(result.results)
    return result


def _with_debonding(row: out.Intervention, one: TieAlternative) -> out.Intervention:
    """The row of a bonded strip, with its share of the debonding force and the source of that."""
    if not one.debonds_by:
        return row
    share = "" if row.required_N is None else f"The required force is {100.0 * row.required_N / one.most:.0f} % of it. "
    told = (
        f"Debonding force of the strip: {engineering(one.most, 'N')} ({one.debonds_by}). {share}Debonding is brittle, and a strip that has "
        "debonded carries nothing: limit analysis relies on a tie that yields."
    )
    return row.model_copy(update={"adverse": [*row.adverse, told]})


def measure_of(context: Context, options: Strengthen, closely: bool = True) -> Measure:
    """The measure of the target; closely: of limit analysis also the least state without dilatancy, where pressed joints slide."""
    if options.by != "tilt":
        return Runs(context, options)
    return SpaceStatics(context, options) if is_spatial(context.building) else Statics(context, options, closely)


def _quantity(options: Strengthen) -> tuple[str, str]:
    if options.by == "tilt":
        return "Collapse acceleration (horizontal, constant)", "g"
    if options.by == "fragility":
        return "Probability of collapse", ""
    return f"Safety factor by {options.by}", ""


def _direction(measure: Measure, options: Strengthen) -> Any:
    if isinstance(measure, SpaceStatics):
        return None
    if isinstance(measure, Statics) and len(measure.senses) == 1:
        return measure.word(measure.senses[0])
    return options.direction


def _reached(measure: Measure, worth: Worth) -> bool:
    """Whether a value meets the target."""
    if worth.value is None or np.isnan(worth.value):
        return False
    return worth.value >= measure.target if measure.higher_is_safer else worth.value <= measure.target


def _over(value: float | None, demand: float | None) -> float | None:
    return None if value is None or not demand else value / demand


class _Work:
    """Sizes alternatives against the existing building."""

    def __init__(self, context: Context, options: Strengthen, measure: Measure, before: Worth):
        self.context, self.options, self.measure, self.before = context, options, measure, before

    @property
    def _halvings(self) -> int:
        """Halvings by the cost of one value."""
        return HALVINGS if self.options.by in CHEAP else HALVINGS_OF_RUNS

    # ----- ties

    def tie(self, one: TieAlternative) -> _Sized:
        """The least yield force of a tie, at the best of its places."""
        if isinstance(self.measure, Runs):
            return self._tie_by_runs(one, self.measure)
        return self._tie_by_programme(one, self.measure)

    def _tie_by_programme(self, one: TieAlternative, statics: Statics) -> _Sized:
        target = statics.aimed
        forces = [statics.carrying(one, place).force(one, place, target) for place in range(len(one.places))]
        costs = [self._cost(length, f, 0.0) for length, f in zip(one.lengths, forces, strict=True)]
        place = int(np.argmin(costs)) if np.isfinite(costs).any() else self._strongest(one, statics)
        statics = statics.carrying(one, place)
        required = forces[place] if np.isfinite(forces[place]) else None
        worth, bound_by_friction = None, False
        no_result = ""
        if required is not None:
            try:
                required, worth, bound_by_friction = self._checked(one, place, required, statics)
            except NoAnswer as error:  # of this alternative alone
                required, no_result = None, str(error)
        points, ranges = self._curve(one, place, required, statics)
        greatest = None if points is None else points[-1].capacity
        if worth is None and points is not None:
            worth = statics.of(one.having(self.context.building, place, points[-1].force), picture=True)
        tie, length = one.places[place], one.lengths[place]
        no_force = "no force of the tie suffices" if np.isinf(one.most) else "no force up to the greatest one considered suffices"
        reason = no_result or ("" if required is not None else no_force)
        if bound_by_friction and required is None:
            reason = "the upper bound (dilatant friction) meets the target; the state without dilatancy does not"
        curve = ([], []) if points is None else _polyline(points)
        row = self._row(
            name=one.name,
            kind="ring-beam" if one.beam_weight else word_of(tie),
            place=_placed(tie),
            unit="N",
            required=required,
            greatest=greatest,
            worth=worth,
            ranges=ranges,
            length=length,
            force=required or 0.0,
            volume=0.0,
            reason=reason,
            tie=tie,
            stiffness=one.stiffness(place, required or 0.0),
            anchorage=one.anchorage,
        )
        row = _with_debonding(row, one)
        if one.beam_weight:
            told = f"The ring beam weighs {engineering(one.beam_weight, 'N')}, with its force for limit analysis alone: other strategies are not run with it."
            row = row.model_copy(update={"adverse": [*row.adverse, told]})
        middles = [_middle(t) for t in one.places]
        # a deck holds loads in tables of analyses, so that no other strategy considers the beam
        data = None if required is None or one.beam_weight else one.data(plain_data(self.context), place, required)
        sized = _Sized(row, curve, None, data, worth, tie)
        if len(one.places) > 1:
            sized.places = ([m[0] for m in middles], [m[1] for m in middles], forces)
        sized.costs = [self._cost(length, force, 0.0) for force in curve[0]]
        return sized

    def _checked(self, one: TieAlternative, place: int, force: float, statics: Statics) -> tuple[float | None, Worth | None, bool]:
        """The force that also meets the target by the collapse load itself, which is another programme, and without dilatancy
        where pressed joints slide; None where no force up to the greatest does. Whether friction asked for more."""
        building = self.context.building

        def at(yields: float) -> Worth:
            return statics.of(one.having(building, place, yields), picture=True)

        worth = at(force)
        if _reached(statics, worth):
            return force, worth, False
        if worth.bound != "upper":
            raise NoAnswer(
                f"{one.name}: the least force {force:.6g} N and the collapse load at it, {worth.value} g, do not agree: {worth.reason}"
            )
        low, high = force, min(2.0 * force, one.most)
        while not _reached(statics, at(high)):
            if high >= min(one.most, 1e3 * force):
                return None, None, True
            low, high = high, min(2.0 * high, one.most)
        for _ in range(HALVINGS):
            middle = 0.5 * (low + high)
            low, high = (low, middle) if _reached(statics, at(middle)) else (middle, high)
        return high, at(high), True

    def _strongest(self, one: TieAlternative, statics: Statics) -> int:
        """The place at which a tie of the greatest force gives the greatest capacity."""
        found = []
        for place in range(len(one.places)):
            limit = None if np.isinf(one.most) else one.most
            value = statics.carrying(one, place).of(one.having(self.context.building, place, limit)).value
            found.append(-np.inf if value is None else value)
        return int(np.argmax(found))

    def _curve(
        self, one: TieAlternative, place: int, required: float | None, statics: Statics
    ) -> tuple[list[Point] | None, list[out.GoverningRange]]:
        """The capacity over the force, exact between its points; None where nothing moves at any force. It ends beyond the force
        of the greatest capacity, or beyond the required one where a tie that never yields leaves no mechanism."""
        weight = float(np.sum(masses_of(self.context.building))) * GRAVITY
        first = 0.0
        if not self.before.value and self.before.reason:  # it cannot stand without the tie
            first = statics.force(one, place, 0.0) * (1.0 + 1e-9)
            if not np.isfinite(first):
                return None, []
        last = one.most
        if not np.isfinite(last):
            unlimited = statics.unlimited(one, place)
            if unlimited is not None:
                last = BEYOND * statics.force(one, place, unlimited * (1.0 - statics.reached))
            if not np.isfinite(last):
                last = 2.0 * (required or weight)
        if last <= first:
            last = first + max(BEYOND * (required or 0.0), 0.01 * weight)
        try:
            same = [SMOOTH] if statics.smooth else []
            points = concave_curve(lambda f: statics.point(one, place, f), first, last, *same)
        except (Immovable, NoEquilibrium, NoAnswer):
            return None, []
        ranges = [
            out.GoverningRange(
                first=p.first,
                last=p.last,
                capacity_first=p.low,
                capacity_last=p.high,
                direction=statics.word(p.point.direction),
                mechanism=statics.told_at(p.point),
            )
            for p in pieces_of(points)
        ]
        return points, ranges

    def _tie_by_runs(self, one: TieAlternative, runs: Runs) -> _Sized:
        data = plain_data(self.context)

        def at(force: float) -> Worth:
            stop_if_asked()
            return runs.of_data(one.data(data, 0, force))

        required, worth, curve = self._bracket(at, 0.0, one.most, FORCES_OF_RUNS, self._halvings, False)
        tie = one.places[0]
        row = self._row(
            name=one.name,
            kind=word_of(tie),
            place=_placed(tie),
            unit="N",
            required=required,
            greatest=_safest(runs, curve[1]),
            worth=worth,
            ranges=[],
            length=one.lengths[0],
            force=required or 0.0,
            volume=0.0,
            reason="" if required is not None else worth.reason or "no force up to the greatest one considered suffices",
            tie=tie,
            stiffness=one.stiffness(0, required or 0.0),
            anchorage=one.anchorage,
        )
        row = _with_debonding(self._with_lapses(row, curve, True), one)
        sized = _Sized(row, curve, None, None if required is None else one.data(data, 0, required), worth, tie)
        sized.costs = [self._cost(one.lengths[0], force, 0.0) for force in curve[0]]
        return sized

    def _with_lapses(self, row: out.Intervention, curve: tuple[list[float], list[float]], grows: bool) -> out.Intervention:
        """The row, with the greater changes that do not meet the target: safety need not grow with a size."""
        if row.required_size is None:
            return row
        sizes, values = curve
        beyond = [
            size
            for size, value in zip(sizes, values, strict=True)
            if (size > row.required_size) is grows and size != row.required_size and not _reached(self.measure, Worth(value))
        ]
        if not beyond:
            return row
        text = f"The target is not met at {len(beyond)} greater sizes that were tried, for instance {beyond[0]:.4g} {row.unit}"
        return row.model_copy(update={"adverse": [*row.adverse, f"{text.rstrip()}: safety does not grow with the size."]})

    # ----- changes of keys

    def change(self, one: ChangeAlternative) -> _Sized:
        """The least change of a key that meets the target."""
        seen: dict[float, Worth] = {}

        def at(value: float) -> Worth:
            stop_if_asked()
            if value not in seen:
                data, keys = with_value(self.context, self.options, one.key, round(value) if one.whole else value)
                seen[value] = self.measure.of_data(data, keys) if isinstance(self.measure, Runs) else self.measure.of_data(data)
            return seen[value]

        required, worth, curve = self._bracket(at, one.start, one.stop, one.count, self._halvings, one.whole)
        ranges: list[out.GoverningRange] = []
        if isinstance(self.measure, Statics):
            for size, value in zip(*curve, strict=True):
                told = seen[size].mechanism
                way = self.measure.word(seen[size].sense)
                if ranges and ranges[-1].mechanism == told:
                    ranges[-1] = ranges[-1].model_copy(update={"last": size, "capacity_last": value})
                elif np.isfinite(value):
                    ranges.append(
                        out.GoverningRange(first=size, last=size, capacity_first=value, capacity_last=value, direction=way, mechanism=told)
                    )
        greatest = _safest(self.measure, curve[1])
        if required is None and greatest is not None and isinstance(self.measure, Statics):
            best = curve[0][curve[1].index(greatest)]
            data, _ = with_value(self.context, self.options, one.key, round(best) if one.whole else best)
            closely = self.measure.of_data(data, picture=True)  # without dilatancy where pressed joints slide
            worth, greatest = (worth, greatest) if closely.value is None else (closely, closely.value)
        spent = None if required is None else self._spent(one, required)
        force, volume = spent or (0.0, 0.0)
        row = self._row(
            name=one.name,
            kind="change",
            place=f"from {one.start:.4g} {one.unit}".rstrip(),
            unit=one.unit,
            required=required,
            greatest=greatest,
            worth=worth,
            ranges=ranges,
            length=0.0,
            force=force,
            volume=volume,
            priced=spent is not None,
            reason="" if required is not None else worth.reason or "no value up to the greatest one considered suffices",
            key=one.key,
        )
        row = self._with_lapses(row, curve, one.stop > one.start)
        sized = _Sized(row, curve, None, None, worth)
        if required is not None:
            data, keys = with_value(self.context, self.options, one.key, round(required) if one.whole else required)
            sized.data = data if keys is None else None  # an option of the code changes no building
            if isinstance(self.measure, Statics):
                sized.worth = self._picture(data)
        sized.costs = [np.nan if (s := self._spent(one, size)) is None else self._cost(0.0, *s) for size in curve[0]]
        return sized

    def _picture(self, data: dict[str, Any]) -> Worth:
        assert isinstance(self.measure, Statics)
        return self.measure.of_data(data, picture=True)

    def _bracket(
        self, at: Callable[[float], Worth], start: float, stop: float, count: int, halvings: int, whole: bool
    ) -> tuple[float | None, Worth, tuple[list[float], list[float]]]:
        """The size nearest to `start` that meets the target: values on a grid, then the first interval halved. The size, what it
        is worth (of the last one where none suffices), and all sizes tried with their values."""
        sizes = np.linspace(start, stop, count)
        if whole:
            sizes = np.unique(np.round(sizes))
            sizes = sizes if stop > start else sizes[::-1]
        tried = {float(size): at(float(size)) for size in sizes}
        grid = list(tried)

        def curve() -> tuple[list[float], list[float]]:
            found = sorted(tried)
            return found, [np.nan if (v := tried[size].value) is None else v for size in found]

        first = next((k for k, size in enumerate(grid) if _reached(self.measure, tried[size])), None)
        if first is None:
            return None, tried[grid[-1]], curve()
        near, far = grid[max(first - 1, 0)], grid[first]
        for _ in range(halvings):
            if first == 0 or (whole and abs(far - near) <= 1.0):
                break
            middle = 0.5 * (near + far)
            middle = float(round(middle)) if whole else middle
            tried[middle] = at(middle)
            near, far = (near, middle) if _reached(self.measure, tried[middle]) else (middle, far)
        return far, tried[far], curve()

    def _spent(self, one: ChangeAlternative, value: float) -> tuple[float, float] | None:
        """Force [N], and masonry added by a change of the structure or injected where a property of material or joints changes
        [m^3]; None where the weights say nothing of the key."""
        table = one.key.partition(".")[0]
        building = self.context.building
        if one.unit == "N":
            return abs(value - one.start), 0.0
        if (
            table not in ("structure", "material", "joints")
            or building.structure is None
            or ("blocks" in building.kind.lacks and "solids" in building.kind.lacks)
        ):
            return None
        before = volume_of(building)
        if table != "structure":
            return 0.0, before if value != one.start else 0.0
        data, _ = with_value(self.context, self.options, one.key, round(value) if one.whole else value)
        try:
            deck = make_deck({**data, "analysis": [{"kind": "tilt"}]}, self.context.deck.folder)
            return 0.0, volume_of(deck.building) - before
        except (DeckError, BadGeometry):
            return None  # no such building: its value says so

    # ----- rows

    def _cost(self, length: float, force: float, volume: float) -> float:
        w = self.options.weights
        return w.per_metre * length + w.per_kilonewton * force / 1e3 + w.per_cubic_metre * max(volume, 0.0)

    def _row(
        self,
        *,
        name: str,
        kind: Any,
        place: str,
        unit: str,
        required: float | None,
        greatest: float | None,
        worth: Worth | None,
        ranges: list[out.GoverningRange],
        length: float,
        force: float,
        volume: float,
        reason: str,
        tie: Tie | None = None,
        stiffness: float = 0.0,
        anchorage: Any = None,
        key: str = "",
        priced: bool = True,
    ) -> out.Intervention:
        worth = worth or Worth(None)
        met = required is not None
        # The target is met only where the least state without dilatancy reaches it too; the size is that of the upper bound.
        sure = met and (worth.beside is None or worth.beside > (1.0 - SLACK) * self.measure.target)
        if met and not sure:
            reason = "the size meets the target only by the upper bound of limit analysis (dilatant friction)"
        more: dict[str, Any] = {"key": key} if key else {}
        if tie is not None and required is not None:
            more["stiffness_N_m"] = stiffness
        if tie is not None:
            more |= {"start_m": list(tie.start), "required_N": required}
            more |= {} if tie.hoop else {"end_m": list(tie.far)}
            more |= {"via_m": [list(point) for point in tie.via]} if tie.via else {}
            if self.context.building.structure is not None and not isinstance(self.measure, SpaceStatics):
                more["depth_m"] = self.context.building.blocks().depth
        adverse = self._adverse(worth, volume if key.startswith("structure.") else 0.0, met)
        if met and anchorage is not None:
            more["anchorage"] = check_anchorage(force, anchorage)
            adverse += [
                f"The {c.part} carries {c.capacity_N / 1e3:.3g} kN, less than {force / 1e3:.3g} kN: {c.size.partition(' [')[0]} "
                f"{1e3 * c.needed:.0f} mm is needed."
                for c in more["anchorage"]
                if c.capacity_N is not None and c.capacity_N < force
            ]
        after = worth.value if met else None
        return out.Intervention(
            name=name,
            kind=kind,
            place=place,
            unit=unit,
            meets_target=sure,
            required_size=required,
            greatest_capacity=greatest,
            capacity_after=after,
            safety_factor_after=_over(after, self.measure.demand),
            next_mechanism=worth.mechanism,
            bound=worth.bound if met else None,
            ranges=ranges,
            length_m=length,
            force_N=force,
            volume_m3=volume,
            cost=self._cost(length, force, volume) if met and priced else None,
            adverse=adverse,
            reason=reason,
            **more,
        )

    def _adverse(self, worth: Worth, volume: float, met: bool) -> list[str]:
        """What the intervention makes worse."""
        found = []
        before, building = self.before, self.context.building
        if met and worth.shape and before.shape and worth.shape != before.shape:
            found.append("Another mechanism governs than before: the intervention moves the collapse elsewhere.")
        if met and worth.beside is not None and worth.beside < self.measure.target:
            found.append(
                f"Pressed joints slide: without dilatancy the least state found of the strengthened building carries {worth.beside:.3g} g, "
                "less than the target. Increase the force, or the friction."
            )
        statics = self.measure if isinstance(self.measure, Statics) else None
        for sense, was, now in zip(statics.senses if statics else (), before.by_sense, worth.by_sense, strict=False):
            if statics is not None and now < was * (1.0 - NAMED):
                found.append(f"The capacity to {statics.word(sense)} drops from {was:.3g} to {now:.3g} g.")
        if volume > 0.0:
            whole = volume_of(building)
            if volume > NAMED * whole:
                density = building.material.density
                found.append(
                    f"The weight grows by {volume * density * GRAVITY / 1e3:.3g} kN ({100.0 * volume / whole:.0f} %): check the foundation."
                )
            if building.supports.stiffness is not None and not is_spatial(building):
                stones = building.blocks()
                base = float(stones.length[(stones.a < 0) | (stones.b < 0)].sum()) * stones.depth
                sinks = volume * building.material.density * GRAVITY / (building.supports.stiffness * base)
                found.append(
                    f"The base is compliant: the added weight settles by about {1e3 * sinks:.2g} mm, spread over the present base."
                )
        return found

    # ----- all together

    def combined(self, ties: list[TieAlternative]) -> dict[str, Any]:
        """The combination of all ties at all places whose forces have the least sum, in one programme; nothing where one tie is enough."""
        statics = self.measure
        assert isinstance(statics, Statics)
        columns = [(one, place) for one in ties if not one.beam_weight for place in range(len(one.places))]
        if len({one.name for one, _ in columns}) < 2:
            return {}
        try:
            forces = statics.forces(columns, statics.aimed)
        except NoEquilibrium:
            return {}
        except NoAnswer as error:
            self.context.warnings.append(f"The combination of ties is not given: {error}")
            return {}
        carry = [k for k, f in enumerate(forces) if f > 1e-6 * float(forces.max())]
        if len(carry) < 2:
            return {}
        rows, cost = [], 0.0
        for k in carry:
            one, place = columns[k]
            tie = one.places[place]
            rows.append(out.CombinedTie(name=one.name, place=_placed(tie), force_N=float(forces[k])))
            cost += self._cost(one.lengths[place], float(forces[k]), 0.0)
        return {"combination": rows, "combination_cost": cost}

    def assessed(self, sized: list[_Sized]) -> None:
        """Verdicts of all strategies before, and after each intervention that meets the target."""
        before = self._assess("before", plain_data(self.context))
        for one in sized:
            if one.data is None:
                continue
            after = self._assess(one.row.name, one.data)
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
                        f"By {row.label} the margin drops from {_number(low)} to {_number(high)} (verdict {was.outcome}, then {row.outcome})."
                    )
                elif row.outcome in ("collapses", "cannot-stand"):
                    adverse.append(f"By {row.label} the strengthened building still collapses (margin {_number(high)}).")
            one.row = one.row.model_copy(update={"verdicts": verdicts, "adverse": [*one.row.adverse, *adverse]})

    def _assess(self, name: str, data: dict[str, Any]) -> list[StrategyVerdict] | None:
        """The rows of an assessment of a deck."""
        self.context.tell(f"Assess {name}")
        try:
            deck = make_deck(
                {**data, "analysis": [{"kind": "assess", "budget": self.options.budget, "advise": False}]}, self.context.deck.folder
            )
        except DeckError as error:
            self.context.warnings.append(f"The assessment of {name} was refused: {'; '.join(error.complaints)}")
            return None
        found = run_one(nested(self.context, deck), deck.analyses[0], deck.buildings[0])
        if not isinstance(found.results, Assess):
            self.context.warnings.append(f"The assessment of {name} has no result: {found.reason}")
            return None
        return found.results.verdicts

    def fragility(self, best: _Sized) -> out.FragilityPair:
        """Probability of collapse over factors on the motions, before and after."""
        keys = {k: v for k, v in self.options.options.items() if self.options.by == "fragility"}
        asked = {**keys, "kind": "fragility", "intensity": "scale", "levels": sorted(self.options.levels), "bootstrap": 0}
        found: list[OverLevels | None] = []
        for data in (plain_data(self.context), best.data or {}):
            deck = make_deck({**data, "analysis": [asked]}, self.context.deck.folder)
            result = run_one(nested(self.context, deck), deck.analyses[0], deck.buildings[0])
            if not isinstance(result.results, OverLevels):
                self.context.warnings.append(f"No fragility curve: {result.reason or result.answer}")
                found.append(None)
            else:
                found.append(result.results)
        sides: dict[str, Any] = {}
        count = len(self.options.levels)
        for word, r in zip(("before", "after"), found, strict=True):
            shares = [None] * count if r is None else r.collapse_probability
            low, high = (np.zeros(count), np.ones(count)) if r is None else wilson(np.array(r.collapsed), np.array(r.count))
            sides |= {word: shares, f"{word}_low": low.tolist(), f"{word}_high": high.tolist()}
        motions = next((r.motions for r in found if r is not None), 0)
        return out.FragilityPair(name=best.row.name, levels=sorted(self.options.levels), motions=motions, **sides)


def volume_of(building: Building) -> float:
    """Volume of the blocks [m^3]."""
    if is_spatial(building):
        return float(sum(moments(part.vertices, part.triangles)[0] for part in building.solids().parts))
    stones = building.blocks()
    return float(sum(abs(signed_area(outline)) for outline in stones.outlines)) * stones.depth


def masses_of(building: Building) -> np.ndarray:
    """Masses of the blocks [kg]."""
    return building.solids().mass if is_spatial(building) else building.blocks().mass


def _margin(row: StrategyVerdict) -> float | None:
    return row.margin if row.margin is not None else row.margin_at_least


def _number(value: float | None) -> str:
    return "unknown" if value is None else f"{value:.3g}"


def _middle(tie: Tie) -> tuple[float, float]:
    """x of the middle of a tie and its height [m]."""
    far = tie.start if tie.hoop else tie.far
    return 0.5 * (tie.start[0] + far[0]), 0.5 * (tie.start[-1] + far[-1])


def _placed(tie: Tie) -> str:
    """Where a tie is, in words."""
    if tie.hoop:
        return f"at z = {tie.start[2]:.2f} m"
    start, end = (", ".join(f"{axis} = {x:.2f}" for axis, x in zip("xyz", point, strict=False)) for point in (tie.start, tie.far))
    far = "the ground at " if tie.ground is not None else ""
    return f"from {start} m to {far}{end} m"


def _safest(measure: Measure, values: list[float]) -> float | None:
    known = [v for v in values if np.isfinite(v)]
    if not known:
        return None
    return max(known) if measure.higher_is_safer else min(known)


def _polyline(points: list[Point]) -> tuple[list[float], list[float]]:
    """The curve as a line through its ends and the places where mechanisms change."""
    pieces = pieces_of(points)
    if not pieces:
        return [p.force for p in points], [p.capacity for p in points]
    return [pieces[0].first, *(p.last for p in pieces)], [pieces[0].low, *(p.high for p in pieces)]


def _arrays(context: Context, before: Worth, sized: list[_Sized]) -> dict[str, Array]:
    """Curves of all alternatives, the forces over the places of ties, and the mechanisms before and after."""
    curves = {s.row.name: np.column_stack([*s.curve, s.costs]) for s in sized if s.curve[0]}
    places = {s.row.name: np.column_stack(s.places) for s in sized if s.places is not None}
    rest: dict[str, np.ndarray] = {}
    moved: dict[str, np.ndarray] = {}
    drawn = [("0", before), *((str(k), s.worth) for k, s in enumerate(sized, start=1))]
    for name, worth in drawn:
        if worth is None or worth.moved is None:
            continue
        stones, pose = worth.moved
        for i, (outline, c, p) in enumerate(zip(stones.outlines, stones.centroid, pose, strict=True)):
            cos, sin = np.cos(p[2]), np.sin(p[2])
            rest[f"{name}/{i}"] = outline
            moved[f"{name}/{i}"] = (outline - c) @ np.array([[cos, sin], [-sin, cos]]) + p[:2]
    found = {
        **_packed("curve", curves, 3, "size, value and cost along the curve of each alternative"),
        **_packed(
            "range",
            places,
            3,
            "each possible place of each tie: x, y of its middle [m] and required force [N]; infinite: no force is sufficient there",
        ),
        **packed("stones", rest, "m", "blocks of the existing building (0/block) and of the alternatives (number/block)"),
        **packed("stones_moved", moved, "m", "the same, moved by the mechanism that governs"),
    }
    for name, worth in drawn:
        if worth is not None and worth.in_space is not None:
            solids, poses = worth.in_space
            found |= {
                f"{key}_{name}": replace(array, dims=(f"{array.dims[0]}_{name}", *array.dims[1:]))
                for key, array in scene_arrays(solids).items()
                if key.startswith("solid_")
            }
            found[f"solid_pose_{name}"] = Array(poses, (f"block_{name}", "pose"), "m, m, m, rad, rad, rad", "the mechanism carried on")
            tie = sized[int(name) - 1].tie if name != "0" else None
            if tie is not None:
                strands = context.building.having(ties=(tie,)).strands()
                ends = np.array([s.point[[i, j]] for s in strands for i, j in s.segments])
                found[f"solid_strand_{name}"] = Array(
                    ends, (f"segment_{name}", "tie_end", "axis3"), "m", "both ends of the segments of the tie"
                )
    if context.building.structure is not None and rest:
        found |= geometry_arrays(context.building.blocks())
    return found


def _packed(name: str, paths: dict[str, np.ndarray], width: int, about: str) -> dict[str, Array]:
    """Rows of numbers of different lengths one after the other."""
    rows = np.concatenate(list(paths.values())) if paths else np.empty((0, width))
    start = np.cumsum([0, *map(len, paths.values())])
    return {
        name: Array(rows, (f"{name}_row", f"{name}_column"), "", about),
        f"{name}_start": Array(start, (f"{name}_edge",), "", f"first row of each path of {name}, and the end"),
        f"{name}_of": Array(np.array(list(paths), dtype=object), (f"{name}_path",), "", f"names of the paths of {name}"),
    }


def _table(sized: list[_Sized]) -> TableData:
    """Alternatives side by side."""
    names = (
        "name",
        "kind",
        "place",
        "unit",
        "meets_target",
        "required_size",
        "capacity_after",
        "safety_factor_after",
        "length_m",
        "force_N",
        "volume_m3",
        "cost",
        "next_mechanism",
        "reason",
    )
    rows = [s.row for s in sized]
    return TableData({n: [np.nan if (v := getattr(r, n)) is None else v for r in rows] for n in names})


def _words(r: out.Strengthen) -> str:
    """The conclusion, the alternatives, and what governs then."""
    said = [r.statement(), f"Governing mechanism: {r.mechanism_before}."]
    unit = f" {r.unit}" if r.unit else ""
    for one in r.interventions:
        if not one.meets_target:
            most = "" if one.greatest_capacity is None else f" (at best {one.greatest_capacity:.3g}{unit})"
            said.append(f"- {one.name}: {one.reason}{most}.")
            continue
        after = "no collapse mechanism is left" if one.capacity_after is None else f"{one.capacity_after:.3g}{unit}"
        cost = "" if one.cost is None else f"; relative cost {one.cost:.3g} by the weights of the deck"
        then = f" Governing mechanism afterwards: {one.next_mechanism}." if one.next_mechanism else ""
        said.append(f"- {one.name}: {out.size_told(one)}: afterwards {after}{cost}.{then}")
        said += [f"  {text}" for text in one.adverse]
    if r.combination:
        told = ", ".join(f"{row.force_N / 1e3:.3g} kN of {row.name}" for row in r.combination)
        said.append(f"- Combination of ties of least total force: {told}; relative cost {r.combination_cost:.3g}.")
    return "\n".join(said)
