"""Results of limit analysis of many sections: sweep, survey, imperfections."""

from typing import Literal

from extrados.results.fields import ResultModel, fact, maybe
from extrados.results.limit import DILATANT, judge_dilatant
from extrados.results.verdict import Demand, KindResults, Verdict, judge, judge_acceleration


class GoverningMechanism(ResultModel):
    """A mechanism that governs somewhere in a sweep."""

    number: int = fact("number of the mechanism in the figures")
    hinges: str = fact("sequence of the hinges from left to right, in words")


#: Number of the mechanism beside a change; 0 where a certificate proves collapse under self-weight
Beside = int | Literal["locked", "unknown"]


class Change(ResultModel):
    """A value at which another mechanism begins to govern."""

    value: float = fact("value of the varied key, in the unit of the key")
    before: Beside = fact(
        "number of the mechanism that governs below this value of the key; 0: the structure cannot "
        'stand; "locked": no collapse mechanism exists; "unknown": no geometry or no result',
        name="from",
    )
    after: Beside = fact(
        "number of the mechanism that governs above this value of the key; 0: the structure cannot "
        'stand; "locked": no collapse mechanism exists; "unknown": no geometry or no result',
        name="to",
    )
    collapse_acceleration_g: float | None = fact("collapse acceleration at this value of the key", "g")


#: Of one section among many: it has a capacity; a certificate proves that it cannot stand (capacity 0); no load of the kind
#: brings it down; or there is no answer
SectionStatus = Literal["ok", "cannot-stand", "locked", "no-answer"]


class Gap(ResultModel):
    """A value of a sweep at which the structure has no mechanism under the load."""

    value: float = fact("value of the varied key, in the unit of the key")
    status: SectionStatus = fact("cannot-stand (capacity 0, by a certificate), locked (no collapse mechanism), or no-answer (no result)")
    reason: str = fact("reason for this outcome; for a structure that cannot stand, the certificate")


class Sweep(KindResults):
    """sweep: capacity and mechanism as one key of the deck varies."""

    vary: str = fact("the key that varies")
    unit: str = fact("unit of the key")
    mechanisms: list[GoverningMechanism] = fact("mechanisms that govern in a part of the range of the key")
    changes: list[Change] = fact("values of the key at which another mechanism begins to govern")
    stable_limits: list[float] = fact(
        "values of the key (in its unit) at which collapse under self-weight begins or ends; empty if no such value is found"
    )
    locked_limits: list[float] = fact("values of the key at which locking (no collapse mechanism exists) begins or ends")
    optimum_value: float = fact("value of the key with the greatest capacity, in the unit of the key")
    optimum_collapse_acceleration_g: float = fact("greatest collapse acceleration of all calculated values", "g")
    optimum_tilt_angle_deg: float = fact("tilt of the ground with the same effect as the greatest collapse acceleration", "deg")
    optimum_inside: bool = fact("whether the optimum lies inside the calculated range, and not at one of its ends")
    values: list[float] = fact("values of the varied key, in the unit of the key")
    collapse_accelerations_g: list[float | None] = fact(
        "collapse acceleration at each value of the key; 0 for a structure that cannot stand, null without a result", "g"
    )
    upper_bound_values: list[float] = fact(
        "values of the key at which joints in compression slide in the mechanism; the capacity is then an upper bound (dilatant friction)"
    )
    gaps: list[Gap] = fact("values of the key without a mechanism: the structure cannot stand, is locked, or has no result")
    duality_gap: float = fact("greatest difference between the bounds", "g")
    fractured_collapse_accelerations_g: list[float | None] = maybe(
        "collapse acceleration at each value of the key, with the leeward buttress cracked", "g"
    )
    buttress_alone_accelerations_g: list[float | None] = maybe(
        "collapse acceleration of the leeward buttress alone, at each value of the key", "g", source="thesis Fig. 3-4b"
    )

    def judged(self, demand: Demand) -> Verdict:
        """The greatest capacity [g]; a sweep compares, it asks for no demand."""
        best = self.optimum_collapse_acceleration_g
        unit = f" {self.unit}" if self.unit else ""
        text = f"Among the calculated values, {self.vary} = {self.optimum_value:.4g}{unit} gives the greatest capacity, {best:.3g} g."
        if not self.upper_bound_values:
            return judge(text, None, best, "g")
        text += f" For {len(self.upper_bound_values)} of the {len(self.values)} values, joints slide; the capacity is then an {DILATANT}."
        return judge(text, None, best, "g", bound="upper")


class NoAnswerRow(ResultModel):
    """A section of a survey that cannot stand, or has no answer."""

    row: int = fact("line of the section in the file")
    name: str = fact("name of the section")
    reason: str = fact("reason why the section cannot stand or has no result")


class Survey(KindResults):
    """survey: many sections from a table."""

    sections: int = fact("sections in the table")
    standing: int = fact("sections that stand")
    cannot_stand: list[NoAnswerRow] = fact(
        "sections that cannot carry their own weight (proven by a certificate): capacity 0; only the first hundred are listed"
    )
    without_answer: list[NoAnswerRow] = fact("sections without a result; only the first hundred are listed")
    upper_bounds: int = fact(
        "number of sections in whose mechanism joints in compression slide; their capacity is an upper bound (dilatant friction)"
    )
    weakest: str | None = fact("name of the weakest section; a section that cannot stand has capacity 0")
    weakest_collapse_acceleration_g: float | None = fact("collapse acceleration of the weakest section", "g")
    median_collapse_acceleration_g: float | None = fact("median capacity of the sections that stand under their self-weight", "g")
    sections_per_second: float = fact("number of sections calculated per second", "1/s")
    duality_gap: float = fact("greatest difference between the bounds", "g")

    def judged(self, demand: Demand) -> Verdict:
        """The capacity of the weakest section that stands [g]; a survey asks for no demand."""
        text = f"{self.standing} of {self.sections} sections stand under their own weight, {len(self.cannot_stand)} cannot stand"
        if self.weakest is None:
            return judge(f"{text}.", None, None, "g")
        least = self.weakest_collapse_acceleration_g
        text += f"; the weakest, {self.weakest}, has a capacity of {least:.3g} g."
        if not self.upper_bounds:
            return judge(text, None, least, "g")
        return judge(
            f"{text} In {self.upper_bounds} sections joints slide; the capacity of these is an {DILATANT}.", None, least, "g", bound="upper"
        )


class Imperfections(KindResults):
    """imperfections: capacities of random geometries of the same stones, the lesser of the two senses of each."""

    count: int = fact("number of random geometries")
    deviation_m: float = fact("greatest distance of a point of a random geometry from its position in the deck", "m")
    given_collapse_acceleration_g: float = fact("collapse acceleration of the geometry in the deck, without random deviations", "g")
    median_collapse_acceleration_g: float = fact("median capacity", "g")
    low_collapse_acceleration_g: float = fact("5th percentile of the capacity of the random geometries: lower end of the 90 % band", "g")
    high_collapse_acceleration_g: float = fact("95th percentile of the capacity of the random geometries: upper end of the 90 % band", "g")
    least_collapse_acceleration_g: float = fact("least capacity of the random geometries; 0 if one of them cannot stand", "g")
    greatest_collapse_acceleration_g: float = fact("greatest capacity", "g")
    cannot_stand: int = fact(
        "number of random geometries that cannot carry their own weight (proven by a certificate); they count with a capacity of 0 g"
    )
    without_answer: int = fact("number of random geometries without a result (no solution of the linear programmes); they are not counted")
    upper_bounds: int = fact(
        "number of random geometries in whose mechanism joints in compression slide; their capacity is an upper bound (dilatant friction)"
    )

    def judged(self, demand: Demand) -> Verdict:
        """The 5th percentile of the capacities, or the given capacity if that is less, against the peak ground acceleration of the
        motion [g]."""
        least = min(self.low_collapse_acceleration_g, self.given_collapse_acceleration_g)
        return (judge_dilatant if self.upper_bounds else judge_acceleration)(least, demand)
