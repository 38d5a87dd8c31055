"""Results of code-checks."""

from typing import Any, Literal

from extrados.results.fields import ResultModel, fact, maybe
from extrados.results.limit import DILATANT
from extrados.results.rocking import RockingOutcome
from extrados.results.verdict import Bound, Demand, KindResults, Outcome, Verdict, judge
from extrados.schema.code import Jurisdiction
from extrados.schema.quantities import three_figures

Applied = Literal["holds", "fails", "not-applicable", ""]


class Check(ResultModel):
    """One rule of a code."""

    capacity: float | None = fact("capacity according to the rule, in `unit`; null if the rule gives no capacity for this element")
    demand: float | None = fact("demand, in `unit`; null if not known")
    unit: str = fact("unit of capacity and demand")
    quantity: str = fact("quantity compared: displacement, acceleration, lateral strength, drift or slenderness")
    verdict: Applied = fact("verdict of the rule; not-applicable if the element is outside the scope of the rule; empty without a demand")
    source: str = fact("clause of the rule, with edition and equation")
    note: str = fact("values from which capacity and demand are calculated")
    code: str = fact("code that requires the check; empty for a formula shown for comparison or for a strength")
    limit_state: str = fact(
        "limit state of the demand: SLD, SLV, SLC; DL, SD, NC; IO, LS, CP; or ULS; empty for a formula shown for comparison"
    )
    scope: str = fact("element, restraint and height to which the rule applies")
    alternative: str = fact(
        "name of a group of alternative checks: if one check of the group is satisfied (same code, same "
        "limit state), the others are not required. Empty if this check has no alternative"
    )
    reason: str = fact("reason why the rule does not apply; empty if it applies")

    @property
    def words(self) -> str:
        """Its code and limit state."""
        return f"{self.code} at {self.limit_state}" if self.limit_state else self.code


Row = tuple[float, str, Check]


class Checked(KindResults):
    """Rules of codes, by name, and one verdict for all."""

    checks: dict[str, Check] = fact("the rules by name")
    jurisdiction: Jurisdiction = maybe("code whose rules give the verdict; NTC if the deck has no table [code]")
    code: str = maybe("code and edition in words")
    by_default: bool = maybe("whether the deck has no table [code], so that the rules of NTC 2018 are applied")
    clause: str = maybe("clause of the governing check, with edition and equation; empty without a verdict")
    zeta_E: float | None = maybe(
        "zeta_E of NTC at SLV: seismic action that the part can carry, divided by the action that the code requires; null without a demand",
        source="NTC 2018 8.3",
    )
    nbs_percent: float | None = maybe(
        "%NBS of NZSEE: capacity divided by demand in the governing check, in percent; null without a demand", "%"
    )
    confidence_factor: float = maybe("confidence factor, by which capacities are divided")
    behaviour_factor: float = maybe("behaviour factor q, which reduces the demand in the linear check of NTC and on a pier")
    bound: Bound = maybe("type of the capacity that the checks give: exact, lower bound or upper bound")
    margin_associated: float | None = maybe(
        "if joints slide: capacity / demand of the governing check with associated (dilatant) friction. If this ratio is at least 1 but "
        "the check without dilatancy fails, the outcome is open. Null without a demand"
    )
    violated: list[str] = maybe(
        "violated assumptions on the unsafe side. If there are any, a satisfied code check gives no verdict: the outcome is open"
    )

    def judged(self, demand: Demand) -> Verdict:
        """The overall verdict; the deck's motion is no demand of a code."""
        return self.overall()

    def _groups(self) -> list[tuple[str, Row | None, bool]]:
        """Of the checks that apply, each group of alternatives: its code and limit state; margin, name and check of that which allows most, None without
        a demand; whether it is decided: one holds, or all fail."""
        groups: dict[tuple[str, str], list[tuple[str, Check]]] = {}
        for name, check in self.checks.items():
            if check.code and check.verdict != "not-applicable":
                groups.setdefault((check.words, check.alternative or name), []).append((name, check))
        found = []
        for (code, _), rows in groups.items():
            margins = [(c.capacity / c.demand, n, c) for n, c in rows if c.demand and c.capacity is not None]
            best = max(margins, key=lambda r: r[0], default=None)
            known = best is not None and (best[2].verdict == "holds" or all(c.demand is not None for _, c in rows))
            found.append((code, best, known))
        return found

    def least(self) -> float | None:
        """Least margin of what is known, also of codes that are not decided; None without a demand."""
        return min((best[0] for _, best, _ in self._groups() if best is not None), default=None)

    def governing(self) -> list[Row]:
        """Margin, name and check by which each code that is decided says what it says, the one that allows least first."""
        return sorted((best for _, best, known in self._groups() if known and best is not None), key=lambda row: row[0])

    def overall(self) -> Verdict:
        """One verdict for all: the most unfavourable check that applies, of alternatives the one that allows most. Formulas for
        comparison and the computed rocking do not count; without a demand the weakest strength of a pier [N]."""
        decided, undecided = self.governing(), sorted({code for code, _, known in self._groups() if not known})
        remarks = f" The check is open because the deck gives no demand: {', '.join(undecided)}." if undecided else ""
        if self.by_default:
            remarks += f" The deck has no table [code], so the rules of {self.code} are applied. Give [code] to apply another code."
        if self.confidence_factor == 1.0 and self.jurisdiction not in ("NZSEE", "none"):
            remarks += (
                " All partial factors and confidence factors are 1: the capacity includes no margin for uncertain properties of "
                "the masonry."
            )
        if decided:
            _, name, worst = decided[0]
            holds = worst.verdict == "holds"  # what is violated errs on the unsafe side: a check that fails, fails all the same
            unit = f" {worst.unit}" if worst.unit else ""
            outcome: Outcome | None = "stands" if holds and self.bound != "upper" else None
            if not holds and (self.margin_associated or 0.0) >= 1.0:
                outcome = "open"
                remarks = (
                    f" Joints slide: with the {DILATANT} the check is satisfied (factor {self.margin_associated:.3g}); without "
                    f"dilatancy the check is not satisfied. The outcome is open.{remarks}"
                )
            return judge(
                f"{worst.words} governs and is {'satisfied' if holds else 'not satisfied'}, by {name}: demand {worst.demand:.3g}, "
                f"capacity {worst.capacity:.3g}{unit}.{remarks}",
                worst.demand,
                worst.capacity,
                worst.unit,
                outcome,
                self.bound,
                (self.violated or ()) if holds else (),
            )
        if (weakest := self.weakest()) is not None:
            name, check = weakest
            return judge(
                f"{name} gives the lowest strength, {three_figures((check.capacity or 0.0) / 1e3)} kN ({check.note}).{remarks}",
                None,
                check.capacity,
                "N",
            )
        barred = {f"{c.code}, {n}": c.reason for n, c in self.checks.items() if c.code and c.verdict == "not-applicable"}
        if self.jurisdiction == "none":
            return judge("No code is applied (`jurisdiction` is none). The formulas shown for comparison give no verdict.")
        if undecided or not barred:
            return judge(
                f"The deck gives no seismic action, so the checks have no demand. Give the action in [code], or give a spectrum.{remarks}"
            )
        told = "; ".join(f"{rule}: {reason}" for rule, reason in barred.items())
        return judge(f"This program includes no rule of the code for this element. {told[:1].upper()}{told[1:]}.")

    def conclusion(self) -> str:
        """The verdict in one sentence, for the head of a report."""
        rows, verdict = self.governing(), self.overall()
        if not rows or verdict.outcome not in ("stands", "collapses"):
            return verdict.statement
        margin, name, check = rows[0]
        state = f" at {check.limit_state}" if check.limit_state else ""
        word = {"stands": "satisfies", "collapses": "does not satisfy"}[verdict.outcome]
        zeta = "" if self.zeta_E is None else f", zeta_E {self.zeta_E:.3g}"
        nbs = "" if self.nbs_percent is None else f", {self.nbs_percent:.0f} %NBS"
        return f"{self.subject()} {word} {self.code or check.code}{state}: safety factor {margin:.3g} by {name}{zeta}{nbs}."

    def subject(self) -> str:
        """What is checked, in words."""
        return "The structure"

    def weakest(self) -> tuple[str, Check] | None:
        """The rule of the code with the least lateral strength [N] of a pier; residual strengths are not among them."""
        strengths = [
            (n, c)
            for n, c in self.checks.items()
            if c.quantity == "lateral strength" and c.code and c.capacity is not None and c.verdict != "not-applicable"
        ]
        return min(strengths, key=lambda item: item[1].capacity or 0.0, default=None)

    def concluded(self) -> dict[str, Any]:
        """Clause of the governing check, zeta_E and %NBS, from the checks."""
        rows = self.governing()
        found: dict[str, Any] = {"clause": rows[0][2].source if rows else ""}
        if self.jurisdiction == "NTC":
            found["zeta_E"] = min((m for m, _, c in rows if c.limit_state == "SLV"), default=None)
        if self.jurisdiction == "NZSEE":
            found["nbs_percent"] = 100.0 * rows[0][0] if rows else None
        return found


class CodeChecks(Checked):
    """code-checks: rules for rocking bodies and wall piers, beside the computed rocking."""

    dynamic_outcome: RockingOutcome = maybe("for a block under a motion: outcome of the calculated rocking motion")
    dynamic_peak_rotation_ratio: float = maybe("ratio of the greatest rotation of the block to its critical rotation")
    peak_ground_acceleration_g: float | None = maybe(
        "for a block: peak ground acceleration a_g S, which is the demand in the code rules", "g"
    )
    peak_ground_velocity_m_s: float | None = maybe("for a block: peak ground velocity, which is the demand in the rule of Ishiyama", "m/s")


class WallMechanism(ResultModel):
    """A wall of a building on a plan above the foot of one of its storeys, or its gable."""

    wall: str = fact("name of the wall")
    gable: bool = fact("whether the part is the gable above the highest storey of the wall")
    storey: int = fact(
        "number (counted from 1) of the storey at whose foot the wall rotates; for a gable, the number of the top storey plus one"
    )
    foot_m: float = fact("height above the ground of the foot about which the wall or the gable rotates", "m")
    multiplier: float = fact("alpha_0")
    activation_acceleration_g: float = fact("a_0*", "g")
    zero_displacement_m: float | None = fact("d_0*: displacement at which the multiplier becomes zero; null if none", "m")
    margin: float | None = fact("capacity divided by demand in the governing check; null without a demand")


class LocalMechanism(Checked):
    """local-mechanism: a local mechanism by the kinematic analysis of codes."""

    mechanism: str = fact("which")
    multiplier: float = fact(
        "alpha_0: horizontal multiplier of the weights at which the mechanism starts", source="Circ. 7/2019 C8.7.1.2.1"
    )
    participating_mass_kg: float = fact(
        "M*: participating mass, which is the mass of the equivalent oscillator", "kg", source="Circ. 7/2019 C8.7.1.2.1"
    )
    participating_part: float = fact(
        "e*: participating mass ratio, the ratio of g M* to the weight of the kinematic chain", source="Circ. 7/2019 [C8.7.1.5]"
    )
    activation_acceleration_g: float = fact("a_0* = alpha_0 g/(e* FC)", "g", source="Circ. 7/2019 C8.7.1.2.1")
    zero_displacement_m: float | None = fact(
        "d_0*: horizontal displacement of the centre of the moving blocks at which the multiplier becomes zero; null if "
        "no such displacement exists",
        "m",
        source="Circ. 7/2019 [C8.7.1.4]",
    )
    ultimate_displacement_m: float | None = fact("d_SLV = 0.4 d_0*", "m", source="Circ. 7/2019 C8.7.1.2.1.6")
    collapse_displacement_m: float | None = fact("d_SLC = 0.6 d_0*", "m", source="Circ. 7/2019 C8.7.1.2.1.6")
    equivalent_period_s: float | None = fact(
        "T_SLV: period 1.68 pi sqrt(d_SLV/a(d_SLV)), for the straight capacity curve", "s", source="Circ. 7/2019 C8.7.1.2.1.8"
    )
    swaying_weight_N: float = fact(
        "weight of the kinematic chain: the moving blocks, the loads that move with them, and the masses that push them", "N"
    )
    base_height_m: float = fact("z: height of the mechanism above the foundation; at z = 0 the demand is the ground acceleration", "m")
    building_height_m: float = maybe("H, for a mechanism above the ground: height of the building", "m")
    floor_acceleration_g: float = maybe(
        "a_Z, for a mechanism above the ground: acceleration at its height, the demand of the linear check",
        "g",
        source="Circ. 7/2019 C7.2.3",
    )
    multiplier_associated: float = maybe(
        "if joints slide: alpha_0 with associated (dilatant) friction. The capacity lies between "
        "`multiplier` (the lowest certified collapse state) and this value",
        source="Drucker 1954",
    )

    def subject(self) -> str:
        """The mechanism that is checked."""
        bends = {"vertical-bending": "The wall between its floors", "horizontal-bending": "The wall between its side walls"}
        if self.mechanism == "building":
            return "The mechanism of the structure"
        return bends.get(self.mechanism, f"The {self.mechanism}")

    walls: list[WallMechanism] = maybe(
        "for a building in plan: all walls that rotate about the foot of a storey, the worst first; all "
        "other results refer to the worst wall"
    )


class NoLocalMechanism(KindResults):
    """local-mechanism: no local mechanism of the kind that is checked."""

    reason: str = fact("reason why the building has no such mechanism")

    def statement(self) -> str:
        """The result in words."""
        return f"No local mechanism applies. {self.reason[:1].upper()}{self.reason[1:]}."

    def judged(self, demand: Demand) -> Verdict:
        """not-applicable: nothing is compared with the demand."""
        return judge(self.statement())


LocalMechanisms = LocalMechanism | NoLocalMechanism
