"""Results of code-checks."""

from typing import Literal

from extrados.results.fields import ResultModel, fact, maybe
from extrados.results.rocking import RockingOutcome
from extrados.results.verdict import Demand, KindResults, Verdict, judge


class Check(ResultModel):
    """One rule of a code."""

    capacity: float = fact("what the rule allows, in `unit`")
    demand: float | None = fact("what is asked, in `unit`; null where nothing is known")
    unit: str = fact("unit of capacity and demand")
    verdict: Literal["holds", "fails", ""] = fact("the rule's verdict; empty without a demand")
    source: str = fact("where the rule comes from")
    note: str = fact("what to know of it")


class CodeChecks(KindResults):
    """code-checks: rules for rocking bodies and wall piers, beside the computed rocking."""

    dynamic_outcome: RockingOutcome = maybe("of a block under a motion: what the computed rocking gives")
    dynamic_peak_rotation_ratio: float = maybe("its greatest rotation over the critical one")
    peak_ground_acceleration_g: float | None = maybe("of a block: demand of the rules", "g")
    peak_ground_velocity_m_s: float | None = maybe("of a block: demand of the rules", "m/s")
    checks: dict[str, Check] = fact("the rules by name")

    def judged(self, demand: Demand) -> Verdict:
        """The rule of the least capacity over demand; without a demand the weakest strength of a pier [N]."""
        asked = [
            (c.capacity / c.demand, name, c)
            for name, c in self.checks.items()
            if c.demand is not None and c.demand > 0.0
        ]
        if asked:
            _, name, worst = min(asked, key=lambda row: row[0])
            unit = f" {worst.unit}" if worst.unit else ""
            return judge(
                f"{name} governs and {worst.verdict}: {worst.demand:.3g} against {worst.capacity:.3g}{unit}.",
                worst.demand, worst.capacity, worst.unit, "falls" if worst.verdict == "fails" else "stands",
            )  # fmt: skip
        strengths = {name: c for name, c in self.checks.items() if c.unit == "N"}
        if not strengths:
            return judge("The deck holds no demand for the rules.")
        name, weakest = min(strengths.items(), key=lambda item: item[1].capacity)
        return judge(f"{name} gives the least strength, {weakest.capacity / 1e3:.4g} kN.", None, weakest.capacity, "N")
