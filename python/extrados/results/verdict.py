"""The verdict of an analysis: one line by which different strategies on one building are compared."""

from typing import Literal

from extrados.results.fields import ResultModel, fact

Outcome = Literal["stands", "falls", "open", "none"]


class Verdict(ResultModel):
    """What an analysis concludes. `demand` and `capacity` are of one quantity in `unit`.

    outcome: "stands", the demand stays below the capacity; "falls", it reaches it; "open", the analysis could not
    tell, or only with a probability; "none", the deck holds no demand against the capacity, or the analysis asks
    no such question.
    """

    demand: float | None = fact("what is asked of the building; null where the deck asks nothing")
    capacity: float | None = fact("what it bears; null where the analysis knows no limit")
    unit: str = fact("unit of demand and capacity")
    ratio: float | None = fact("capacity over demand: above 1 it stands; null without a demand or a capacity")
    outcome: Outcome = fact("stands, falls, open or none")
    statement: str = fact("the verdict in one sentence")


def judge(
    statement: str,
    demand: float | None = None,
    capacity: float | None = None,
    unit: str = "",
    outcome: Outcome | None = None,
) -> Verdict:
    """The verdict on a demand against a capacity; without an `outcome` of its own the comparison decides."""
    known = demand is not None and capacity is not None
    if outcome is None:
        outcome = ("stands" if demand < capacity else "falls") if known else "none"
    ratio = capacity / demand if known and demand > 0.0 else None
    return Verdict(
        demand=demand, capacity=capacity, unit=unit, ratio=ratio, outcome=outcome, statement=statement
    )  # fmt: skip


def acceleration(what: str, capacity: float, peak: float | None) -> Verdict:
    """A constant acceleration that is borne [g] against the peak ground acceleration of the motion [g], if there is one.

    `what` begins the sentence, for instance "The arch".
    """
    bears = f"{what} bears a constant horizontal acceleration of {capacity:.3g} g"
    if peak is None:
        return judge(f"{bears}; the deck holds no single motion to compare with.", None, capacity, "g")
    word = "below" if peak < capacity else "at or above"
    return judge(
        f"{bears}; the motion's peak of {peak:.3g} g, taken as constant, is {word} that.", peak, capacity, "g"
    )  # fmt: skip
