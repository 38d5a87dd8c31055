"""The verdict of an analysis: one row by which strategies on one building are compared."""

from collections.abc import Sequence
from typing import ClassVar, Literal, Protocol, TypeVar

from extrados.results.fields import ResultModel, fact, maybe

Outcome = Literal["stands", "collapses", "cannot-stand", "open", "not-applicable"]
Bound = Literal["exact", "upper", "lower"]
#: Outcomes in words, the gravest first
OUTCOMES: dict[Outcome, str] = {
    "cannot-stand": "cannot stand",
    "collapses": "collapses",
    "open": "open",
    "stands": "stands",
    "not-applicable": "no verdict",
}
#: Outcomes of a check of a code that differ from those of a building
CHECKED: dict[Outcome, str] = {"collapses": "not satisfied", "stands": "satisfied"}


def outcome_words(outcome: Outcome, check: bool) -> str:
    """An outcome in words; check: of a check of a code, which is satisfied or not."""
    return CHECKED.get(outcome, OUTCOMES[outcome]) if check else OUTCOMES[outcome]


class Verdict(ResultModel):
    """Conclusion of an analysis. `demand` and `capacity` are of one quantity in `unit`.

    outcome: "stands", the demand stays below the capacity; "collapses", the demand reaches the capacity;
    "cannot-stand", a certificate proves collapse under self-weight (and other constant loads, if any); "open", the analysis cannot decide;
    "not-applicable", the deck holds no demand against the capacity, or the analysis asks no such question.
    """

    demand: float | None = fact("demand on the building, from the deck; null if the deck gives none")
    capacity: float | None = fact("capacity of the building; null if the analysis gives none")
    unit: str = fact("unit of demand and capacity")
    ratio: float | None = fact("safety factor: capacity / demand; null without a demand or a capacity")
    outcome: Outcome = fact("outcome: stands, collapses, cannot-stand, open (not decided) or not-applicable")
    bound: Bound | None = fact(
        "type of the capacity: exact; upper bound (true capacity is at most this value); lower bound (at least this "
        "value); null for an estimate"
    )
    violated: list[str] = fact("violated assumptions of the analysis; if there are any, the outcome is open (not decided)")
    statement: str = fact("the verdict in one or two sentences")


#: Units in words: of demands and capacities that are shares or multiples
SHARES = ("of the joint", "of the critical rotation", "of the limit", "of all runs", "times the train")


class Demand(Protocol):
    """Demand of the deck's motion, where it is one motion.

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

    #: Partial results of an interrupted analysis are complete in themselves and keep their verdict
    whole_in_parts: ClassVar[bool] = False

    def judged(self, demand: Demand) -> Verdict | None:
        """Verdict of the results under the demand."""
        return None

    def require_verdict(self, demand: Demand) -> Verdict:
        """Verdict of the results under the demand; TypeError of a kind that concludes nothing."""
        found = self.judged(demand)
        if found is None:
            raise TypeError(f"the results of {type(self).__name__} contain no verdict")
        return found


Model = TypeVar("Model", bound=KindResults)


def as_model(results: KindResults, model: type[Model]) -> Model:
    """Results as a model of their kind; TypeError where they are of another."""
    if not isinstance(results, model):
        raise TypeError(f"these are results of the type {type(results).__name__}, not of the type {model.__name__}")
    return results


def loads_at_rest(other: str | None) -> str:
    """The constant loads of a structure in words; other: those besides the own weight."""
    return f"its own weight and {other}" if other else "its own weight"


class SelfWeight(KindResults):
    """Results of any analysis of a building that collapses under its own weight and `other_loads`, which a certificate proves; or of one that
    did not carry its constant loads in a run that proves nothing."""

    collapse_acceleration_g: float = fact("always 0: the building carries no horizontal acceleration", "g")
    safety_factor: float = fact("always 0: the building collapses before the demand acts")
    certificate: str = fact(
        "certificate of collapse, with the joints or blocks at which equilibrium fails; if collapse is "
        "not proven, the reason why the run ended"
    )
    proven: bool = fact("whether a certificate proves the collapse; if not, the outcome is open")
    neglected: list[str] = fact(
        "strengths, restraints and pressures of the deck that the certificate neglects; if there are any, the outcome is open"
    )
    other_loads: str | None = maybe("constant loads besides the own weight under which the building collapses")

    def statement(self) -> str:
        """The result in words."""
        if not self.proven:
            return (
                "The analysis does not decide whether the structure carries its constant loads: no certificate "
                f"proves that it collapses. {self.certificate}."
            )
        loads = loads_at_rest(self.other_loads)
        if not self.neglected:
            return f"The structure cannot stand: it collapses under {loads}. {self.certificate}."
        strengths = " and ".join(self.neglected)
        return (
            f"The structure can stand only with the contribution of {strengths}; without it, the structure "
            f"collapses under {loads}. {self.certificate}."
        )

    def judged(self, demand: Demand) -> Verdict:
        """cannot-stand; open without a proof, or where the deck gives strengths that the proof neglects."""
        undecided = bool(self.neglected) or not self.proven
        return Verdict(
            demand=demand.peak_g,
            capacity=0.0,
            unit="g",
            ratio=0.0,
            outcome="open" if undecided else "cannot-stand",
            bound="lower" if undecided else "exact",
            violated=[f"The analysis neglects {one}." for one in self.neglected] + ([] if self.proven else [f"{self.certificate}."]),
            statement=self.statement(),
        )


def judge(
    statement: str,
    demand: float | None = None,
    capacity: float | None = None,
    unit: str = "",
    outcome: Outcome | None = None,
    bound: Bound | None = None,
    violated: Sequence[str] = (),
) -> Verdict:
    """The verdict on a demand against a capacity; without an `outcome` of its own the comparison decides.

    A demand below an upper bound, or above a lower bound, decides nothing, and no outcome is decided under a violated
    assumption: both are open, and the statement says so.
    """
    ratio = None
    if demand is None or capacity is None:
        outcome = outcome or "not-applicable"
    else:
        ratio = capacity / demand if demand > 0.0 else None
        if outcome is None:
            outcome = "stands" if demand < capacity else "collapses"
            if (bound, outcome) in (("upper", "stands"), ("lower", "collapses")):
                outcome = "open"
    if violated and outcome in ("stands", "collapses"):
        outcome = "open"
    if violated:
        statement = f"{statement} {' '.join(violated)}"
    return Verdict(
        demand=demand, capacity=capacity, unit=unit, ratio=ratio, outcome=outcome, bound=bound, violated=list(violated), statement=statement
    )


def capacity_alone(carried: str, capacity: float, unit: str, bound: Bound | None = None, violated: Sequence[str] = ()) -> Verdict:
    """A base shear that a structure carries which vibrates and yields: no verdict follows from the peak ground acceleration."""
    text = (
        f"{carried} This capacity gives no verdict: the structure amplifies the motion and yields, so the peak ground acceleration "
        "cannot be compared with the capacity. For a verdict by displacement demand (response spectrum), give the seismic action in [code]."
    )
    return judge(text, None, capacity, unit, "not-applicable", bound, violated)


def judge_acceleration(capacity: float, demand: Demand, bound: Bound | None = None, violated: Sequence[str] = ()) -> Verdict:
    """A constant horizontal acceleration [g] that is carried, against the peak of the motion, if there is one."""
    peak = demand.peak_g
    name = {"upper": "Upper bound of the collapse acceleration", "lower": "Lower bound of the collapse acceleration"}
    carried = f"{name.get(bound or '', 'Collapse acceleration')} {capacity:.3g} g (horizontal, constant)"
    if peak is None:
        return judge(
            f"{carried}. There is no comparison with a demand, because the deck does not give exactly one motion.",
            None,
            capacity,
            "g",
            None,
            bound,
            violated,
        )
    word = "below" if peak < capacity else "at or above"
    text = f"{carried}; the peak of the motion, {peak:.3g} g, applied as a constant horizontal acceleration, is {word} this value."
    return judge(text, peak, capacity, "g", None, bound, violated)
