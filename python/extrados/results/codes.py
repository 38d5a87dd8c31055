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
    code: str = fact(
        "whose check it is: of several checks of one code any that holds suffices; empty for a formula or a strength"
    )


class Checked(KindResults):
    """Rules of codes, by name, and one verdict for all."""

    checks: dict[str, Check] = fact("the rules by name")

    def judged(self, demand: Demand) -> Verdict:
        """The overall verdict; the deck's motion is no demand of a code."""
        return self.overall()

    def _best(self) -> tuple[list[tuple[float, str, Check]], list[str]]:
        """Of each code that is decided the check that allows most, as margin, name and check, the worst first; the codes that
        are not: one of their checks fails while another has no demand."""
        margins: dict[str, tuple[float, str, Check]] = {}
        open_codes = set()
        for name, check in self.checks.items():
            if not check.code:
                continue
            if check.demand is None:
                open_codes.add(check.code)
            elif check.demand > 0.0:
                row = (check.capacity / check.demand, name, check)
                margins[check.code] = max(margins.get(check.code, row), row, key=lambda r: r[0])
        undecided = {c for c in open_codes if c not in margins or margins[c][2].verdict == "fails"}
        decided = [row for code, row in margins.items() if code not in undecided]
        return sorted(decided, key=lambda row: row[0]), sorted(undecided)

    def governing(self) -> list[tuple[float, str, Check]]:
        """Margin, name and check by which each code that is decided says what it says, the code that allows least first."""
        return self._best()[0]

    def overall(self) -> Verdict:
        """One verdict for all: of each code the check that allows most, of the codes the one that allows least. Formulas for
        comparison and the computed rocking do not count; without a demand the weakest strength of a pier [N]."""
        decided, undecided = self._best()
        left = f" Left open for want of a demand: {', '.join(undecided)}." if undecided else ""
        if decided:
            _, name, worst = decided[0]
            unit = f" {worst.unit}" if worst.unit else ""
            return judge(
                f"{worst.code} governs and {worst.verdict}, by {name}: {worst.demand:.3g} against "
                f"{worst.capacity:.3g}{unit}.{left}",
                worst.demand, worst.capacity, worst.unit, "collapses" if worst.verdict == "fails" else "stands",
            )  # fmt: skip
        strengths = {name: c for name, c in self.checks.items() if c.unit == "N"}
        if not strengths:
            return judge("The deck holds no demand of a code: give its spectrum.")
        name, weakest = min(strengths.items(), key=lambda item: item[1].capacity)
        return judge(f"{name} gives the least strength, {weakest.capacity / 1e3:.4g} kN.", None, weakest.capacity, "N")


class CodeChecks(Checked):
    """code-checks: rules for rocking bodies and wall piers, beside the computed rocking."""

    dynamic_outcome: RockingOutcome = maybe("of a block under a motion: what the computed rocking gives")
    dynamic_peak_rotation_ratio: float = maybe("its greatest rotation over the critical one")
    peak_ground_acceleration_g: float | None = maybe("of a block: a_g S, the demand of the rules", "g")
    peak_ground_velocity_m_s: float | None = maybe("of a block: demand of Ishiyama's rule", "m/s")


class WallMechanism(ResultModel):
    """A wall of a building on a plan above the foot of one of its storeys."""

    wall: str = fact("its name")
    storey: int = fact("the storey at whose foot it turns, from 1")
    foot_m: float = fact("height of that foot above the ground", "m")
    multiplier: float = fact("alpha_0")
    activation_acceleration_g: float = fact("a_0*", "g")
    zero_displacement_m: float | None = fact("d_0*; null: none", "m")
    margin: float | None = fact("capacity over demand of the check that governs; null without a demand")


class LocalMechanism(Checked):
    """local-mechanism: a local mechanism by the kinematic analysis of codes."""

    mechanism: str = fact("which")
    multiplier: float = fact(
        "alpha_0, the horizontal multiplier of the weights that starts it", source="Circ. 7/2019 C8.7.1.2.1"
    )
    participating_mass_kg: float = fact("M*, of the equivalent oscillator", "kg", source="Circ. 7/2019 C8.7.1.2.1")
    participating_part: float = fact("e* = g M* over the weights that sway")
    activation_acceleration_g: float = fact("a_0* = alpha_0 g/(e* FC)", "g", source="Circ. 7/2019 C8.7.1.2.1")
    zero_displacement_m: float | None = fact("d_0*, at which the multiplier vanishes; null: at none", "m")
    ultimate_displacement_m: float | None = fact("d_SLV = 0.4 d_0*", "m", source="Circ. 7/2019 C8.7.1.2.1.6")
    collapse_displacement_m: float | None = fact("d_SLC = 0.6 d_0*", "m", source="Circ. 7/2019 C8.7.1.2.1.6")
    equivalent_period_s: float | None = fact(
        "T_SLV = 1.68 pi sqrt(d_SLV/a(d_SLV)) on the straight capacity curve", "s", source="Circ. 7/2019 C8.7.1.2.1.8"
    )
    swaying_weight_N: float = fact("weights that sway", "N")
    floor_acceleration_g: float = maybe(
        "of a place above the ground: a_Z, the acceleration there, the demand of the linear check",
        "g",
        source="Circ. 7/2019 C7.2.3",
    )
    walls: list[WallMechanism] = maybe(
        "of a building on a plan: every wall above the foot of each storey, the worst first; the other "
        "numbers are those of the worst"
    )
