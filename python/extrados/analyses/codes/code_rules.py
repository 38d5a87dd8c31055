"""One rule of a code with its scope, demand, capacity and clause: the row that every rule of this package gives.

Clauses marked "verify clause" are quoted from memory of the standards: compare with the text before use. The others were
read: the Circolare in its text, ASCE 41-13 in the worked example of *Advanced Design Examples of Seismic Retrofit of
Structures*, section 2.7.5, whose equations are quoted, NZS 1170.5 in public implementations, Annex B of EN 1998-1 in prEN 1998-1:2003.
"""

from dataclasses import dataclass, field

import numpy as np

from extrados.results.codes import Applied, Check
from extrados.results.model import TableData


@dataclass(frozen=True)
class Line:
    """One rule: its capacity and demand in `unit`, and where it comes from; verdict "" where there is no demand.

    scope: the element, its restraint and its height that the rule is for. code: whose check it is, "" for a formula for comparison.
    state: the limit state of the demand. alternative: checks of one code and limit state with the same word are alternatives by
    that code, of which one that holds suffices; any other must hold by itself. barred: why the rule does not apply, "" where it does.
    """

    rule: str
    quantity: str
    capacity: float | None
    demand: float | None
    unit: str
    source: str
    note: str = ""
    code: str = ""
    scope: str = field(kw_only=True)
    state: str = field(default="", kw_only=True)
    alternative: str = field(default="", kw_only=True)
    barred: str = field(default="", kw_only=True)

    @property
    def verdict(self) -> Applied:
        """ "not-applicable" out of its scope; else whether it "holds", the demand being no more than the capacity, or "fails"; ""
        without a demand."""
        if self.barred:
            return "not-applicable"
        if self.demand is None or self.capacity is None:
            return ""
        return "holds" if self.demand <= self.capacity else "fails"

    def check(self) -> Check:
        """The rule as a result."""
        return Check(
            capacity=self.capacity,
            demand=self.demand,
            unit=self.unit,
            quantity=self.quantity,
            verdict=self.verdict,
            source=self.source,
            note=self.note,
            code=self.code,
            limit_state=self.state,
            scope=self.scope,
            alternative=self.alternative,
            reason=self.barred,
        )


def table(lines: list[Line]) -> TableData:
    """The rules as rows."""
    return TableData(
        {
            "rule": [x.rule for x in lines],
            "quantity": [x.quantity for x in lines],
            "capacity": [np.nan if x.capacity is None else x.capacity for x in lines],
            "demand": [np.nan if x.demand is None else x.demand for x in lines],
            "unit": [x.unit for x in lines],
            "verdict": [x.verdict for x in lines],
            "source": [x.source for x in lines],
            "note": [x.note for x in lines],
            "code": [x.code for x in lines],
            "limit_state": [x.state for x in lines],
            "scope": [x.scope for x in lines],
            "reason": [x.barred for x in lines],
        }
    )
