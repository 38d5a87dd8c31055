"""The verdict of an analysis: one line by which different strategies on one building are compared."""

from typing import ClassVar, Literal, Protocol

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


class Demand(Protocol):
    """What the deck's motion asks of a building, where it is one motion.

    peak_g: greatest horizontal acceleration [g], None without a single motion. pulse: the shape of a motion that is a
    single pulse, "" for any other; duration_s: its duration, or its period where the shape has one; amplitude_g.
    """

    @property
    def peak_g(self) -> float | None: ...
    @property
    def pulse(self) -> str: ...
    @property
    def duration_s(self) -> float: ...
    @property
    def amplitude_g(self) -> float: ...


class KindResults(ResultModel):
    """Base of the results of a kind; by itself, of an analysis that has none."""

    #: What there is of an interrupted analysis is judged as it is: it consists of whole ones
    whole_in_parts: ClassVar[bool] = False

    def judged(self, demand: Demand) -> Verdict | None:
        """What the results say of the building under the demand."""
        return None


def judge(
    statement: str,
    demand: float | None = None,
    capacity: float | None = None,
    unit: str = "",
    outcome: Outcome | None = None,
) -> Verdict:
    """The verdict on a demand against a capacity; without an `outcome` of its own the comparison decides."""
    ratio = None
    if demand is None or capacity is None:
        outcome = outcome or "none"
    else:
        outcome = outcome or ("stands" if demand < capacity else "falls")
        ratio = capacity / demand if demand > 0.0 else None
    return Verdict(
        demand=demand, capacity=capacity, unit=unit, ratio=ratio, outcome=outcome, statement=statement
    )  # fmt: skip


def acceleration(capacity: float, demand: Demand) -> Verdict:
    """A constant acceleration that is borne [g] against the peak of the motion, if there is one."""
    peak = demand.peak_g
    bears = f"It bears a constant horizontal acceleration of {capacity:.3g} g"
    if peak is None:
        return judge(f"{bears}; the deck holds no single motion to compare with.", None, capacity, "g")
    word = "below" if peak < capacity else "at or above"
    return judge(
        f"{bears}; the motion's peak of {peak:.3g} g, taken as constant, is {word} that.", peak, capacity, "g"
    )  # fmt: skip
