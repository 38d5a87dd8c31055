"""What to do: the governing mechanism, the least interventions that cure it by limit analysis, and what governs then."""

from extrados.analyses.assess.asking import Asker
from extrados.analyses.context import Refused
from extrados.results.assess import Advice
from extrados.results.rocking import Rocking
from extrados.results.strengthen import Intervention, Strengthen, size_told, works_in
from extrados.schema.quantities import engineering

#: Outcomes of rocking in words
OUTCOMES = {"no-hinging": "does not rock", "recovery": "rocks and recovers", "collapse": "collapses"}


def size_interventions(asker: Asker, peak_g: float, rocks: bool) -> Advice | str:
    """Interventions that carry the peak of the hazard, with the outcome of rocking; why there are none, in words."""
    dropped = tuple(what for what in asker.not_considered("tilt") if what != "[supports] abutting_wall")
    if dropped:
        return f"limit analysis, which gives the sizes of interventions, neglects {' and '.join(dropped)}"
    try:
        result, _ = asker.ask("strengthen", {"acceleration": f"{peak_g!r} g"})
    except Refused as error:
        return str(error)
    r = result.results
    if not isinstance(r, Strengthen):
        return result.reason or "the analysis has no result"
    rocking = {one.name: _rocks(asker, one) for one in r.interventions if one.meets_target} if rocks else {}
    tie = next((one for one in r.interventions if one.meets_target and one.required_N is not None), None)
    least = _least_by_rocking(asker, tie) if tie is not None and rocks else None
    statement = _statement(r, rocking)
    if least is not None and tie is not None:
        statement += f" {_told_by_rocking(least, tie)}"
    more = {"by_rocking": least} if least is not None else {}
    return Advice(
        target_g=r.target,
        capacity_g=r.value_before,
        mechanism=r.mechanism_before,
        interventions=r.interventions,
        rocking=rocking,
        statement=statement,
        **more,
    )


def _least_by_rocking(asker: Asker, tie: Intervention) -> Intervention | None:
    """The tie at the same place, with the least yield force with which rocking under the hazard has the verdict "stands"; None where the
    existing building has it, or where no force up to that of statics gives it."""
    table = {
        "name": "the same tie",
        "start": tie.start_m,
        "ground" if "ground" in tie.place else "end": tie.end_m,
        "works_in": works_in(tie),
        "yield_force": tie.required_N,
        "stiffness": tie.stiffness_N_m,
    }
    try:
        result, _ = asker.ask("strengthen", {"by": "rocking", "safety_factor": 1.0, "ties": [table]})
    except Refused:
        return None
    r = result.results
    if not isinstance(r, Strengthen) or r.met_before:
        return None
    return r.interventions[0]


def _told_by_rocking(least: Intervention, tie: Intervention) -> str:
    """The least tie by rocking against that of limit analysis, in words."""
    if not least.meets_target or least.required_N is None or tie.required_N is None:
        return (
            f"According to the rocking analysis under the hazard, no tie force up to that of limit analysis is sufficient: {least.reason}."
        )
    return (
        f"According to the rocking analysis under the hazard, the same tie requires {engineering(least.required_N, 'N')}. "
        f"This is {100.0 * least.required_N / tie.required_N:.0f} % of the force that the peak "
        "acceleration requires as a sustained load. The lower force is valid only for this motion."
    )


def _rocks(asker: Asker, one: Intervention) -> str:
    """The outcome of rocking with an intervention, in words."""
    if one.key is not None:
        changes = {one.key: one.required_size}
    else:
        far = "ground" if "ground" in one.place else "end"
        tie = {"name": "strengthening", "start": one.start_m, far: one.end_m, "yield_force": one.required_N, "stiffness": one.stiffness_N_m}
        changes = {"ties": [*asker.context.deck.data.get("ties", []), {**tie, "works_in": works_in(one)}]}
    try:
        result, _ = asker.ask("rocking", {}, None, changes)
    except Refused as error:
        return f"gives no result: {error}"
    if not isinstance(result.results, Rocking):
        return f"gives no result: {result.reason or result.answer}"
    return OUTCOMES.get(result.results.outcome, result.results.outcome)


def _statement(r: Strengthen, rocking: dict[str, str]) -> str:
    """The mechanism, the least interventions, and what governs then."""
    now = "none" if r.value_before is None else f"{r.value_before:.3g} g (horizontal, constant)"
    said = [
        (
            f"Collapse acceleration of the existing building: {now}. Governing mechanism: {r.mechanism_before}. The peak of "
            f"the hazard is {r.target:.3g} g. With each of these interventions the building carries this peak as a constant "
            "horizontal acceleration:"
        )
    ]
    met = [one for one in r.interventions if one.meets_target]
    for number, one in enumerate(met, start=1):
        then = f", afterwards {one.next_mechanism}" if one.next_mechanism else ""
        moves = f" (under the hazard, the strengthened building {rocking[one.name]})" if one.name in rocking else ""
        said.append(f"({number}) {one.name}, {size_told(one)}{then}{moves}{';' if number < len(met) else '.'}")
    if not met:
        said.append("none. No tie and no thickness that was considered is sufficient.")
    return " ".join(said)
