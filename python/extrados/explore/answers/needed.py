"""Sizing of interventions: the least interventions with which the structure carries an acceleration, by limit analysis."""

from collections.abc import Iterator
from typing import Any

from extrados.analyses.context import Context, Refused
from extrados.analyses.limit.tables import LimitAnalysisTable
from extrados.analyses.needs import complaints
from extrados.analyses.strengthen import driver, tables
from extrados.decks.reader import make_deck
from extrados.explore.desk import Desk
from extrados.explore.frames import Reply
from extrados.explore.messages import BadMessage, Message
from extrados.results.strengthen import Intervention, Strengthen, size_told, works_in

#: Greatest acceleration that a page may request [g]
MOST = 10.0
#: Digits of a size that is written into the deck, rounded so that the target is still met
UP = 1.0 + 1e-4


def needed(desk: Desk, message: Message) -> Iterator[Reply]:
    """Interventions for a constant horizontal acceleration [g], with the changes of the deck that each of them is."""
    target = message.get("acceleration")
    if isinstance(target, bool) or not isinstance(target, int | float) or not 0.0 < target <= MOST:
        raise BadMessage(f"the required acceleration must be above 0 and at most {MOST:g} g")
    deck = desk.there().deck
    options, _, _ = desk.analysis(LimitAnalysisTable, lambda: None)
    own = {} if options is None else options.model_dump(exclude_unset=True, include=set(LimitAnalysisTable.model_fields))
    asked = {**own, "kind": "strengthen", "acceleration": f"{float(target)!r} g"}
    data = {k: v for k, v in deck.data.items() if k != "analysis"}
    made = make_deck({**data, "analysis": [asked]}, deck.folder)
    context, table = Context(made, 1), made.analyses[0]
    assert isinstance(table, tables.Strengthen)
    if wrong := complaints(context, table, made.buildings[0]):
        raise Refused("; ".join(wrong))
    r = driver.run(context, table, closely=False).results  # as all capacities of the page
    assert isinstance(r, Strengthen)
    bound = any(one.bound == "upper" for one in r.interventions)
    ties = data.get("ties", [])
    yield Reply(
        {
            "needed": {
                "target_g": target,
                "met": r.met_before,
                "statement": r.statement(),
                "mechanism": r.mechanism_before,
                "capacity_g": r.value_before,
                "bound": bound,
                "interventions": [_told(one, ties) for one in r.interventions],
            }
        }
    )


def _told(one: Intervention, ties: list[Any]) -> dict[str, Any]:
    """An intervention in words, and the keys that put it into the deck."""
    words = {"name": one.name, "met": one.meets_target, "size": size_told(one), "next": one.next_mechanism, "reason": one.reason}
    if not one.meets_target or one.required_size is None:
        return words
    if one.key is not None:
        return words | {"changes": {one.key: one.required_size * UP}}
    far = "ground" if "ground" in one.place else "end"
    works = works_in(one)
    tie = {
        "name": f"strengthening {len(ties) + 1}",
        "start": one.start_m,
        "works_in": works,
        **({"hoop": True} if one.kind == "hoop" else {far: one.end_m}),
        **({"via": one.via_m} if one.kind == "chain" else {}),
        "yield_force": one.required_size * UP,
        "stiffness": one.stiffness_N_m,
    }
    return words | {"changes": {"ties": [*ties, tie]}}
