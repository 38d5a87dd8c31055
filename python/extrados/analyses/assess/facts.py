"""What the reasons rest on: rows and results of all strategies, how two of them agree, and how a reason is stated."""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from extrados.motions.motion import Motion
from extrados.results.assess import Agreement, Reason, StrategyVerdict
from extrados.results.limit import Tilt
from extrados.results.model import Result
from extrados.results.verdict import KindResults, SelfWeight
from extrados.views.building import Building

#: Strategies that apply a constant acceleration, and those that follow the motion or a part of it
STATIC, DYNAMIC = ("tilt", "sla", "push-x", "push-y"), ("rocking", "assessment", "probability", "dem")
#: A joint that slips by this part of its length has slid
SLID = 0.01
#: Reasons in a few words
HEADLINES = {
    "violated": "assumptions that do not hold",
    "static-peak": "the duration of the peak",
    "impact-rule": "the energy loss at impacts",
    "last-digits": "a chaotic response",
    "sine-for-record": "the parts of the motion that its strongest sine does not include",
    "sliding": "sliding of blocks",
    "drums": "separate motion of the blocks",
    "hinges-elsewhere": "hinges outside the assumed mechanism",
    "membrane-without-sliding": "elements that cannot slide",
    "tension": "tensile strength of the elements",
    "mortar": "mortar",
    "code-factors": "the factors of codes",
    "code-check": "the governing check of the code",
    "code-spectrum": "the spectrum of the code instead of the motion",
    "torn-off": "the restraint of walls by corners and floors",
    "weaker-direction": "the walls along each axis",
    "frame-and-shells": "frame and shells",
    "crack": "a crack in the buttress",
    "left-out": "restraints that some strategies neglect",
    "chance": "uncertain sizes (5 %)",
}

Pair = tuple[str, str]


@dataclass
class Facts:
    """All that the rules may look at.

    rows and results by strategy; probes: results of further runs by what was asked of them; needed_s: the shortest constant
    push of an amplitude [g] that brings it down [s], None where none is known. bare: what of the deck a strategy left out.
    """

    building: Building
    motion: Motion
    peak_g: float
    rows: dict[str, StrategyVerdict]
    results: dict[str, Result]
    apart: float
    probes: dict[str, Result] = field(default_factory=dict)
    needed_s: Callable[[float], float | None] = lambda amplitude: None
    bare: dict[str, tuple[str, ...]] = field(default_factory=dict)

    def of(self, name: str) -> KindResults | None:
        """The typed results of a strategy that has any of its kind."""
        found = self.results.get(name)
        if found is None or found.status != "ok" or isinstance(found.results, SelfWeight):
            return None
        return found.results

    def outcome(self, name: str) -> str:
        """The outcome of a strategy by its name."""
        return self.rows[name].outcome

    def judged(self) -> list[str]:
        """The strategies with a verdict."""
        return [n for n, r in self.rows.items() if r.status == "ok" and r.outcome != "not-applicable"]

    def relation(self, a: str, b: str) -> Agreement:
        """agree, apart, disagree or open (results.assess)."""
        one, two = self.rows[a], self.rows[b]
        if {one.outcome, two.outcome} == {"collapses", "cannot-stand"}:
            return "agree"
        if "open" in (one.outcome, two.outcome):
            return "agree" if one.outcome == two.outcome else "open"
        if one.outcome != two.outcome:
            return "disagree"
        low, high = sorted((self.interval(a), self.interval(b)))
        if low[1] is not None and high[0] is not None and high[0] > self.apart * low[1]:
            return "apart"
        return "agree"

    def interval(self, name: str) -> tuple[float, float]:
        """Between which factors on the hazard its verdict turns."""
        row = self.rows[name]
        if row.margin is not None:
            return row.margin, row.margin
        return row.margin_at_least or 0.0, np.inf if row.margin_below is None else row.margin_below

    def pairs(self) -> list[Pair]:
        """Pairs that do not agree."""
        names = self.judged()
        return [(a, b) for i, a in enumerate(names) for b in names[i + 1 :] if self.relation(a, b) != "agree"]

    def split(self, pair: Pair) -> tuple[str, str]:
        """The pair with that first which says less is borne."""
        a, b = pair
        order = {"cannot-stand": 0, "collapses": 1, "open": 2, "stands": 3}
        key_a, key_b = ((order[self.outcome(n)], self.interval(n)) for n in (a, b))
        return (a, b) if key_a <= key_b else (b, a)


def reason(rule: str, pairs: list[Pair], text: str, **numbers: float | None) -> Reason:
    """A reason by its rule, for the pairs of strategies whose difference it explains, with the numbers in its text."""
    return Reason(rule=rule, headline=HEADLINES[rule], explains=[list(p) for p in pairs], text=text, numbers=numbers)


def dynamic(pairs: list[Pair], *names: str) -> list[Pair]:
    """The pairs of two strategies that both follow the motion, one of them of these names."""
    return [p for p in pairs if set(p) <= set(DYNAMIC) and set(p) & set(names)]


def least_of_limit_analysis(facts: Facts, r: Tilt) -> float:
    """Collapse acceleration by limit analysis [g] in the weaker of the senses that no wall stops; the design value where joints
    slide, as in the row of `tilt`."""
    right, left = r.capacity(), r.capacity(opposite=True)
    return {"left": right, "right": left}.get(facts.building.supports.abutting_wall or "", min(right, left))
