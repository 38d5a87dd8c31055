"""The least yield force of a tie: by the programme of limit analysis itself, or by runs of another analysis; capacity over the force."""

import numpy as np

from extrados.analyses.strengthen.alternatives import TieAlternative, word_of
from extrados.analyses.strengthen.measures import Runs, Statics, Worth, plain_data, reached, safest
from extrados.analyses.strengthen.rows import Found, Means, masses_of, middle_of, placed, row_of, with_debonding, with_lapses
from extrados.analyses.strengthen.sizing import HALVINGS, Sized, Sizing
from extrados.core.calls import stop_if_asked
from extrados.limit.errors import Immovable, NoAnswer, NoEquilibrium
from extrados.limit.strengthening import Point, concave_curve, pieces_of
from extrados.results import strengthen as out
from extrados.schema.constants import GRAVITY
from extrados.schema.quantities import engineering

#: How far beyond the force of the greatest capacity, or beyond the required one, a curve goes
BEYOND = 1.15
#: Relative precision of a curve that crushing bends
SMOOTH = 1e-4
#: Forces at which runs are made before the interval is halved
FORCES_OF_RUNS = 5


def size_tie(work: Sizing, one: TieAlternative) -> Sized:
    """The least yield force of a tie, at the best of its places."""
    if isinstance(work.measure, Runs):
        return _size_by_runs(work, one, work.measure)
    return _size_by_programme(work, one, work.measure)


def _size_by_programme(work: Sizing, one: TieAlternative, statics: Statics) -> Sized:
    """By the programme of limit analysis, at the place of least cost."""
    target = statics.aimed
    forces = [statics.carrying(one, place).force(one, place, target) for place in range(len(one.places))]
    costs = [work.cost(length, f, 0.0) for length, f in zip(one.lengths, forces, strict=True)]
    place = int(np.argmin(costs)) if np.isfinite(costs).any() else _strongest_place(work, one, statics)
    statics = statics.carrying(one, place)
    required = forces[place] if np.isfinite(forces[place]) else None
    worth, bound_by_friction = None, False
    no_result = ""
    if required is not None:
        try:
            required, worth, bound_by_friction = _check_force(work, one, place, required, statics)
        except NoAnswer as error:  # of this alternative alone
            required, no_result = None, str(error)
    points, ranges = _curve_of(work, one, place, required, statics)
    greatest = None if points is None else points[-1].capacity
    if worth is None and points is not None:
        worth = statics.of(one.having(work.context.building, place, points[-1].force), picture=True)
    tie, length = one.places[place], one.lengths[place]
    no_force = "no force of the tie is sufficient" if np.isinf(one.most) else "no force up to the greatest one considered is sufficient"
    reason = no_result or ("" if required is not None else no_force)
    if bound_by_friction and required is None:
        reason = "the upper bound (dilatant friction) meets the target, but the state without dilatancy does not"
    curve = ([], []) if points is None else _polyline(points)
    row = row_of(
        work,
        _means(one, place, required, "ring-beam" if one.beam_weight else word_of(tie)),
        Found(required, greatest, worth, ranges, reason),
    )
    row = with_debonding(row, one)
    if one.beam_weight:
        told = (
            f"The ring beam weighs {engineering(one.beam_weight, 'N')}. Its force is valid for limit analysis only: the other "
            "strategies are not run with the ring beam."
        )
        row = row.model_copy(update={"adverse": [*row.adverse, told]})
    middles = [middle_of(t) for t in one.places]
    # a deck holds loads in tables of analyses, so that no other strategy considers the beam
    data = None if required is None or one.beam_weight else one.data(plain_data(work.context), place, required)
    sized = Sized(row, curve, None, data, worth, tie)
    if len(one.places) > 1:
        sized.places = ([m[0] for m in middles], [m[1] for m in middles], forces)
    sized.costs = [work.cost(length, force, 0.0) for force in curve[0]]
    return sized


def _size_by_runs(work: Sizing, one: TieAlternative, runs: Runs) -> Sized:
    """By bracketing with runs of the analysis that measures the target, at the first place."""
    data = plain_data(work.context)

    def at(force: float) -> Worth:
        stop_if_asked()
        return runs.of_data(one.data(data, 0, force))

    required, worth, curve = work.bracket(at, 0.0, one.most, FORCES_OF_RUNS, False)
    tie = one.places[0]
    reason = "" if required is not None else worth.reason or "no force up to the greatest one considered is sufficient"
    row = row_of(work, _means(one, 0, required, word_of(tie)), Found(required, safest(runs, curve[1]), worth, [], reason))
    row = with_debonding(with_lapses(work, row, curve, True), one)
    sized = Sized(row, curve, None, None if required is None else one.data(data, 0, required), worth, tie)
    sized.costs = [work.cost(one.lengths[0], force, 0.0) for force in curve[0]]
    return sized


def _means(one: TieAlternative, place: int, required: float | None, kind: str) -> Means:
    """A tie at a place with its yield force [N]."""
    tie, force = one.places[place], required or 0.0
    return Means(
        one.name,
        kind,
        placed(tie),
        "N",
        length=one.lengths[place],
        force=force,
        tie=tie,
        stiffness=one.stiffness(place, force),
        anchorage=one.anchorage,
    )


def _check_force(work: Sizing, one: TieAlternative, place: int, force: float, statics: Statics) -> tuple[float | None, Worth | None, bool]:
    """The force that also meets the target by the collapse load itself, which is another programme, and without dilatancy
    where pressed joints slide; None where no force up to the greatest does. Whether friction asked for more."""
    building = work.context.building

    def at(yields: float) -> Worth:
        return statics.of(one.having(building, place, yields), picture=True)

    worth = at(force)
    if reached(statics, worth):
        return force, worth, False
    if worth.bound != "upper":
        raise NoAnswer(
            f"{one.name}: the least force, {force:.6g} N, is not consistent with the collapse load at this force, {worth.value} g: {worth.reason}"
        )
    low, high = force, min(2.0 * force, one.most)
    while not reached(statics, at(high)):
        if high >= min(one.most, 1e3 * force):
            return None, None, True
        low, high = high, min(2.0 * high, one.most)
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if reached(statics, at(middle)) else (middle, high)
    return high, at(high), True


def _strongest_place(work: Sizing, one: TieAlternative, statics: Statics) -> int:
    """The place at which a tie of the greatest force gives the greatest capacity."""
    found = []
    for place in range(len(one.places)):
        limit = None if np.isinf(one.most) else one.most
        value = statics.carrying(one, place).of(one.having(work.context.building, place, limit)).value
        found.append(-np.inf if value is None else value)
    return int(np.argmax(found))


def _curve_of(
    work: Sizing, one: TieAlternative, place: int, required: float | None, statics: Statics
) -> tuple[list[Point] | None, list[out.GoverningRange]]:
    """The capacity over the force, exact between its points; None where nothing moves at any force. It ends beyond the force
    of the greatest capacity, or beyond the required one where a tie that never yields leaves no mechanism."""
    weight = float(np.sum(masses_of(work.context.building))) * GRAVITY
    first = 0.0
    if not work.before.value and work.before.reason:  # it cannot stand without the tie
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


def _polyline(points: list[Point]) -> tuple[list[float], list[float]]:
    """The curve as a line through its ends and the places where mechanisms change."""
    pieces = pieces_of(points)
    if not pieces:
        return [p.force for p in points], [p.capacity for p in points]
    return [pieces[0].first, *(p.last for p in pieces)], [pieces[0].low, *(p.high for p in pieces)]
