"""Results of the verification of capacity curves by displacement."""

from typing import Literal

from extrados.results.fields import ResultModel, fact, maybe
from extrados.results.verdict import Verdict, judge
from extrados.schema.code import Jurisdiction

Method = Literal["N2", "capacity-spectrum", "coefficient"]


class IdealisedCurve(ResultModel):
    """A capacity curve as an elastic-plastic oscillator; displacements are those of the control point."""

    push: str = fact("direction of the push, or name of the pushover")
    equivalent_mass_kg: float = fact("m* = sum m phi", "kg", source="NTC 2018 C7.3.4.2")
    participation_factor: float = fact("participation factor Gamma = m*/sum(m phi^2), with phi = 1 at the control point")
    mass_ratio: float = fact("mass ratio: participating mass m* Gamma divided by the total mass")
    period_s: float = fact("T* = 2 pi sqrt(m*/k*)", "s")
    yield_load_N: float = fact("base shear of the plateau", "N")
    yield_displacement_m: float = fact("displacement at the start of the plateau", "m")
    ultimate_displacement_m: float = fact(
        "ultimate displacement: displacement at collapse; up to it, the capacity curve and the bilinear curve enclose equal areas", "m"
    )
    ended_by: Literal["drop", "drift", "end"] = fact(
        "end of the curve. drop: base shear decreased by 20 %; drift: all piers of one storey of a wall at their limit "
        "drift; end: end of the calculation"
    )


class DisplacementCheck(ResultModel):
    """Displacement demand and capacity of one curve at one limit state."""

    push: str = fact("direction of the push, or name of the pushover")
    limit_state: str = fact("limit state: SLO, SLD, SLV, SLC; DL, SD, NC; IO, LS, CP; ULS")
    demand_m: float | None = fact("displacement demand at the control point; null without a demand, or beyond collapse", "m")
    capacity_m: float | None = fact("displacement capacity at the control point; null if the code gives none", "m")
    strength_ratio: float | None = fact("strength ratio q*: elastic force divided by yield force; null without a demand")
    greatest_strength_ratio: float | None = fact("greatest q* that the code allows; null without a limit")
    factor: float | None = fact(
        "factor on the seismic action at which the check (displacement and q*) is just satisfied; null if not found"
    )
    demand_pga_g: float | None = fact("demand: peak ground acceleration a_g S of the seismic action", "g")
    capacity_pga_g: float | None = fact("capacity: peak ground acceleration a_g S times `factor`; capacity / demand is alpha_PGA", "g")
    return_period_years: float | None = fact("return period of the seismic action; null if not known", "year")
    capacity_return_period_years: float | None = fact(
        "return period of the action that the building can carry, interpolated between the limit states "
        "of [code]; null outside their range",
        "year",
    )
    verdict: Literal["holds", "fails", ""] = fact("verdict of the check; empty without a demand or a capacity")
    clause: str = fact("clauses of demand and capacity")


class BuildingFragility(ResultModel):
    """Lognormal fragility by N2 over a set of motions, each scaled; its scatter is that of the motions alone."""

    limit_state: str = fact("limit state, reached as soon as one of the capacity curves reaches its displacement capacity")
    motions: int = fact("motions that were used")
    median_pga_g: float = fact("median of the peak ground accelerations that the building can carry", "g")
    dispersion: float = fact("standard deviation of the logarithms of these accelerations")


class Verification(ResultModel):
    """Verification of capacity curves by displacement: the least factor of all curves and limit states governs."""

    jurisdiction: Jurisdiction = fact("code whose rules decide")
    code: str = fact("code and edition in words")
    by_default: bool = fact("whether the deck has no table [code], so that the rules of NTC 2018 are applied")
    method: Method = fact("method of the displacement demand")
    confidence_factor: float | None = fact("confidence factor by which strengths were divided; null without a demand")
    curves: list[IdealisedCurve] = fact("each curve as an oscillator")
    checks: list[DisplacementCheck] = fact("checks of each capacity curve at each limit state")
    zeta_E: float | None = fact(
        "zeta_E of NTC at SLV: least value of `factor` (seismic action carried / required) of all checks at SLV; null without a demand",
        source="NTC 2018 8.3",
    )
    nbs_percent: float | None = maybe("%NBS of NZSEE: least value of `factor` of all checks at ULS, in percent", "%")
    fragility: list[BuildingFragility] = maybe("fragility of the building for the motions of the deck")
    violated: list[str] = fact(
        "violated assumptions on the unsafe side. If there are any, a satisfied code check gives no verdict: the outcome is open"
    )

    def governing(self) -> DisplacementCheck | None:
        """The check of least factor; None without any."""
        known = [check for check in self.checks if check.factor is not None]
        return min(known, key=lambda check: check.factor or 0.0, default=None)

    @property
    def decides(self) -> bool:
        """Whether the action is known, so that the verification has a verdict or a reason for none."""
        return any(check.demand_pga_g is not None for check in self.checks)

    def ended_early(self, check: DisplacementCheck) -> bool:
        """Whether the curve of a check ends before its collapse, so that the capacity is a lower bound."""
        return any(c.push == check.push and c.ended_by == "end" for c in self.curves)

    def judged(self, carried: str) -> Verdict:
        """The verdict in peak ground acceleration [g]; carried: the base shear in words."""
        named = f" The deck names no code: the rules of {self.code} are applied." if self.by_default else ""
        check = self.governing()
        if check is None:
            return judge(f"{carried} {self._without()}{named}")
        assert check.factor is not None and check.demand_pga_g is not None and check.capacity_pga_g is not None
        early = self.ended_early(check)
        if early:
            named = f" The curve ends before the base shear has decreased by 20 %, so the capacity is a lower bound.{named}"
        return judge(
            f"{self.told(check)} {carried}{named}",
            check.demand_pga_g,
            check.capacity_pga_g,
            "g",
            None,
            "lower" if early else None,
            self.violated if check.verdict == "holds" else (),
        )

    def told(self, check: DisplacementCheck) -> str:
        """A check in one sentence."""
        assert check.factor is not None and check.capacity_m is not None
        own = {("NTC", "SLV"): "zeta_E", ("NZSEE", "ULS"): "%NBS"}
        index = own.get((self.jurisdiction, check.limit_state), "safety factor")
        value = f"{100.0 * check.factor:.0f}" if index == "%NBS" else f"{check.factor:.3g}"
        demand = "beyond collapse" if check.demand_m is None else f"{1e3 * check.demand_m:.3g} mm"
        ratio = ""
        limit = check.greatest_strength_ratio
        if limit is not None and check.strength_ratio is not None and check.factor * check.strength_ratio > 0.999 * limit:
            ratio = f", governed by q* ({check.strength_ratio:.3g}; at most {limit:g})"
        return (
            f"{self.code} at {check.limit_state}: the displacement check {check.verdict} (push {check.push}, {self.method}). "
            f"Demand {demand}, capacity {1e3 * check.capacity_m:.3g} mm; {index} {value}{ratio}; peak ground acceleration "
            f"{check.demand_pga_g:.3g} g, capacity {check.capacity_pga_g:.3g} g."
        )

    def _without(self) -> str:
        """Why no check decides."""
        if self.jurisdiction == "ASCE41":
            known = [c for c in self.checks if c.demand_m is not None]
            told = ", ".join(f"{1e3 * (c.demand_m or 0.0):.3g} mm at {c.limit_state}, push {c.push}" for c in known)
            return (
                "ASCE 41 checks the drift of each pier (Table 11-4). This program does not include that table, "
                f"so there is no verdict.{(f' Target displacement {told}.' if told else '')}"
            )
        return "The code gives no displacement capacity for the limit states of the deck, so there is no verdict."
