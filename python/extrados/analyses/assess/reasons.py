"""Why strategies differ: rules, each of which compares numbers and speaks only where they show it."""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from extrados.analyses.assess.asking import ENDING
from extrados.analyses.assess.hazard import above, passages
from extrados.model.structures.plan import Plan
from extrados.motions.motion import Motion
from extrados.results.assess import Agreement, Reason, StrategyVerdict
from extrados.results.codes import Check, Checked, LocalMechanism
from extrados.results.dem import DemRun
from extrados.results.frame import FramePushover
from extrados.results.limit import Tilt
from extrados.results.model import Result
from extrados.results.rocking import Assessment, Rocking
from extrados.results.shell import Pushover
from extrados.results.verdict import KindResults, SelfWeight
from extrados.views.building import Building

#: Strategies that push for ever, and those that follow the motion or a part of it
STATIC, DYNAMIC = ("tilt", "sla", "push-x", "push-y"), ("rocking", "assessment", "probability", "dem")
#: Part by which the base shears of frame and shells may differ without a stated reason
SHELLS_APART = 0.15
#: The push of a building on a plan along its two axes
PUSHES = ("push-x", "push-y")
#: A joint that slips by this part of its length has slid; a thrust line outside by this share of the time is elsewhere
SLID, ELSEWHERE = 0.01, 0.1
#: Of a collapse displacement: what moved less than this was far from it
FAR = 0.5

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


#: Reasons in a few words
HEADLINES = {
    "violated": "assumptions that do not hold",
    "static-peak": "how long the peak lasts",
    "impact-rule": "the energy loss at impacts",
    "last-digits": "a chaotic response",
    "sine-for-record": "the rest of the motion beside its strongest sine",
    "sliding": "sliding of blocks",
    "drums": "blocks that move separately",
    "hinges-elsewhere": "hinges that form elsewhere",
    "membrane-without-sliding": "elements that cannot slide",
    "tension": "tensile strength of the elements",
    "mortar": "mortar",
    "code-factors": "the factors of codes",
    "code-check": "which check of the codes governs",
    "torn-off": "whether corners and floors hold the walls",
    "weaker-direction": "the walls along each axis",
    "frame-and-shells": "frame and shells",
    "crack": "a crack in the buttress",
    "left-out": "restraints that some strategies neglect",
    "chance": "uncertain sizes (5 %)",
}


def reason(rule: str, pairs: list[Pair], text: str, **numbers: float | None) -> Reason:
    """A reason by its rule, for the pairs of strategies whose difference it explains, with the numbers in its text."""
    return Reason(rule=rule, headline=HEADLINES[rule], explains=[list(p) for p in pairs], text=text, numbers=numbers)


def dynamic(pairs: list[Pair], *names: str) -> list[Pair]:
    """The pairs of two strategies that both follow the motion, one of them of these names."""
    return [p for p in pairs if set(p) <= set(DYNAMIC) and set(p) & set(names)]


def static_peak(facts: Facts, pairs: list[Pair]) -> list[Reason]:
    """Statics takes the peak for ever; the motion passes the capacity for too short a time to overturn it."""
    mine = [p for p in pairs if (s := facts.split(p))[0] in STATIC and s[1] in DYNAMIC]
    groups: list[list[str]] = []
    for name in sorted({facts.split(p)[0] for p in mine}, key=STATIC.index):
        group = next((g for g in groups if _alike(facts, g[0], name)), None)
        if group is None:
            groups.append([name])
        else:
            group.append(name)
    return [r for g in groups if (r := _static_peak(facts, g, [p for p in mine if facts.split(p)[0] in g])) is not None]


def _alike(facts: Facts, a: str, b: str) -> bool:
    """Whether two strategies of statics say the same to 3 %."""
    one, two = facts.rows[a].capacity, facts.rows[b].capacity
    return one is not None and two is not None and abs(one - two) < 0.03 * max(one, two)


def _static_peak(facts: Facts, names: list[str], mine: list[Pair]) -> Reason | None:
    weakest = min(names, key=lambda n: facts.rows[n].capacity or np.inf)
    capacity = facts.rows[weakest].capacity
    if capacity is None:
        return None
    # where both stand, the motion is looked at as strong as the dynamic answer still bears
    factor = 1.0
    if facts.outcome(weakest) == "stands":
        factor = min(facts.interval(facts.split(p)[1])[0] for p in mine)
    if factor <= 0.0:
        return None
    amplitude = factor * facts.peak_g
    count, longest = above(facts.motion, capacity / factor)
    needed = facts.needed_s(amplitude)
    told = f"{amplitude:.3g} g" if factor == 1.0 else f"{amplitude:.3g} g (the motion times {factor:.3g})"
    text = (
        f"Static analysis applies the peak of {told} as a sustained load; the motion exceeds the {capacity:.3g} g of "
        f"{facts.rows[weakest].label} {count} time{'s' if count != 1 else ''}, for {longest:.3g} s at most"
    )
    numbers = {"static_capacity": capacity, "peak": amplitude, "excursions": float(count), "longest_s": longest, "needed_s": needed}
    if needed is not None and longest < needed:
        return reason(
            "static-peak",
            mine,
            f"{text}, while a constant lateral acceleration of that peak needs {needed:.3g} s to cause collapse.",
            **numbers,
        )
    if needed is not None:
        return _by_passages(facts, mine, text, capacity / factor, factor, numbers)
    dem = facts.of("dem")
    if "rocking" in facts.results or not isinstance(dem, DemRun) or dem.outcome == "collapse":
        return None
    moved = dem.peak_displacement_m / dem.collapse_displacement_m
    if not 0.0 < moved < FAR or longest <= 0.0:
        return None
    return reason(
        "static-peak",
        [p for p in mine if "dem" in p],
        f"{text}: in that time the blocks move by {100 * moved:.2g} % of the displacement that counts as collapse.",
        displacement_ratio=moved,
        **numbers,
    )


def _by_passages(facts: Facts, mine: list[Pair], text: str, level: float, factor: float, numbers: dict[str, float | None]) -> Reason | None:
    """The passages over the capacity one by one, each as a constant lateral acceleration equal to its mean. A passage is not considered if
    another one is as strong and as long."""
    worst, longest = None, 0.0
    for length, mean in sorted(passages(facts.motion, level), key=lambda p: (-p[1], -p[0])):
        if length <= longest:
            continue
        longest = length
        needed = facts.needed_s(factor * mean)
        if needed is None or length >= needed:
            return None
        if worst is None or length / needed > worst[0] / worst[2]:
            worst = (length, factor * mean, needed)
    if worst is None:
        return None
    length, mean, needed = worst
    return reason(
        "static-peak",
        mine,
        f"{text}. None of these times lasts long enough: the most dangerous averages {mean:.3g} g for {length:.3g} s, and a constant "
        f"lateral acceleration of {mean:.3g} g needs {needed:.3g} s to cause collapse.",
        **{**numbers, "passage_g": mean, "passage_s": length, "passage_needed_s": needed},
    )


def _unstopped(facts: Facts, r: Tilt) -> float:
    """Collapse acceleration by limit analysis [g] in the weaker of the senses that no wall stops; the design value where joints
    slide, as in the row of `tilt`."""
    right, left = r.capacity(), r.capacity(opposite=True)
    return {"left": right, "right": left}.get(facts.building.supports.abutting_wall or "", min(right, left))


def crack(facts: Facts, pairs: list[Pair]) -> Reason | None:
    """A buttress that cracks bears less; nothing but limit analysis was asked to crack it."""
    tilt = facts.of("tilt")
    mine = [p for p in pairs if "tilt" in p and facts.split(p)[0] == "tilt"]
    if not mine or not isinstance(tilt, Tilt) or tilt.fracture is None:
        return None
    whole = min(tilt.collapse_acceleration_g, tilt.collapse_acceleration_opposite_g)
    cracked = 0.0 if tilt.fracture.stands is False else tilt.fracture.collapse_acceleration_g
    if cracked is None or cracked >= whole or whole <= facts.peak_g:
        return None
    return reason(
        "crack",
        mine,
        f"Limit analysis considers a crack in the leeward buttress: {cracked:.3g} g instead of {whole:.3g} g with monolithic buttresses, which "
        f"exceeds the peak of {facts.peak_g:.3g} g. The other strategies do not consider this crack.",
        cracked=cracked,
        whole=whole,
        peak=facts.peak_g,
    )


def left_out(facts: Facts, pairs: list[Pair]) -> Reason | None:
    """One of them leaves out restraints that some strategies neglect; without it the other says the same."""
    without = facts.probes.get("without-restraints")
    every = {w for there in facts.bare.values() for w in there}  # what the probe was asked without
    bare = [n for n, there in facts.bare.items() if set(there) == every]
    mine = [p for p in pairs if "rocking" in p and set(p) & set(bare)]
    r = facts.of("rocking")
    if not mine or without is None or not isinstance(without.results, Rocking) or not isinstance(r, Rocking):
        return None
    other = without.results
    if other.peak_rotation_ratio <= 1.2 * r.peak_rotation_ratio:
        return None
    return reason(
        "left-out",
        mine,
        f"The restraints of the mechanism are {' and '.join(sorted(every))}, neglected by "
        f"{' and '.join(facts.rows[n].label for n in bare if any(n in p for p in mine))}. Without them the greatest rotation is "
        f"{100 * other.peak_rotation_ratio:.3g} % of the critical rotation, with them {100 * r.peak_rotation_ratio:.3g} %.",
        rotation_ratio_without=other.peak_rotation_ratio,
        rotation_ratio=r.peak_rotation_ratio,
    )


def ties_of_statics(facts: Facts, pairs: list[Pair]) -> Reason | None:
    """One strategy of statics knows ties and the other does not; without them the first says as the second."""
    mine = [p for p in pairs if set(p) == {"tilt", "sla"} and "sla" in facts.bare]
    without, tilt, sla = facts.probes.get("tilt-without"), facts.rows.get("tilt"), facts.rows.get("sla")
    if not mine or without is None or not isinstance(without.results, Tilt) or tilt is None or sla is None:
        return None
    bare = _unstopped(facts, without.results)
    if sla.capacity is None or tilt.capacity is None or abs(bare - sla.capacity) > 0.1 * bare:
        return None
    return reason(
        "left-out",
        mine,
        f"Limit analysis uses the ties, the elements do not: {tilt.capacity:.3g} g with them, {bare:.3g} g "
        f"without, and the elements {sla.capacity:.3g} g.",
        with_ties=tilt.capacity,
        without_ties=bare,
        elements=sla.capacity,
    )


def impact_rule(facts: Facts, pairs: list[Pair]) -> Reason | None:
    """The rule of impact decides whether it rocks on or falls."""
    r = facts.of("rocking")
    mine = dynamic(pairs, "rocking")
    if not isinstance(r, Rocking) or not mine or not r.outcomes_by_rule:
        return None
    falls = [o for o in r.outcomes_by_rule if o.outcome == "collapse"]
    stands = [o for o in r.outcomes_by_rule if o.outcome != "collapse"]
    if not falls or not stands:
        return None

    def told(rows: list) -> str:
        return " and ".join(f'"{o.rule}" (c_v {o.restitution:.3f})' for o in rows)

    numbers = {f"restitution_{o.rule}".replace("-", "_"): o.restitution for o in r.outcomes_by_rule}
    return reason(
        "impact-rule",
        mine,
        f"The energy loss at impacts decides: rocking collapses by {told(falls)} and recovers by {told(stands)}. Discrete elements "
        "lose energy by the damping of their contacts, which is neither rule.",
        **numbers,
    )


def sine_for_record(facts: Facts, pairs: list[Pair]) -> Reason | None:
    """One sine stands for the whole motion: rocked through that sine alone the building does as the criterion says."""
    mine = dynamic(pairs, "assessment")
    a, alone, whole = facts.of("assessment"), facts.probes.get("sine"), facts.of("rocking")
    if not mine or not isinstance(a, Assessment) or alone is None or not isinstance(alone.results, Rocking):
        return None
    if not isinstance(whole, Rocking) or a.primary_impulse is None:
        return None
    sine = alone.results
    if (sine.outcome == "collapse") != (a.verdict == "fails"):
        return None
    more = whole.peak_rotation_ratio > 1.2 * sine.peak_rotation_ratio or whole.outcome != sine.outcome
    if not more:
        return None
    return reason(
        "sine-for-record",
        mine,
        f"The criterion replaces the motion by its strongest sine, {abs(a.primary_impulse.amplitude_g):.3g} g over "
        f"{a.primary_impulse.period_s:.3g} s ({100 * a.primary_impulse.goodness_of_fit:.0f} % of the squared acceleration there): "
        f"under that sine alone the greatest rotation is {100 * sine.peak_rotation_ratio:.0f} % of the critical rotation, under the whole "
        f"motion {100 * whole.peak_rotation_ratio:.0f} %.",
        sine_rotation_ratio=sine.peak_rotation_ratio,
        motion_rotation_ratio=whole.peak_rotation_ratio,
        goodness_of_fit=a.primary_impulse.goodness_of_fit,
    )


def last_digits(facts: Facts, pairs: list[Pair]) -> Reason | None:
    """The run is chaotic."""
    r = facts.of("rocking")
    mine = dynamic(pairs, "rocking")
    if not mine or not isinstance(r, Rocking) or not r.decided_by_last_digits:
        return None
    return reason(
        "last-digits",
        mine,
        "Rocking under this motion is chaotic: sensitive to perturbations of 1e-6 to 1e-4. One run is one sample. Its greatest "
        f"rotation is {100 * r.peak_rotation_ratio:.0f} % of the critical one.",
        rotation_ratio=r.peak_rotation_ratio,
    )


def elements_of_last_digits(facts: Facts, pairs: list[Pair]) -> Reason | None:
    """The discrete-element response is chaotic."""
    dem = facts.of("dem")
    mine = [p for p in pairs if "dem" in p]
    if not mine or not isinstance(dem, DemRun) or not dem.decided_by_last_digits:
        return None
    return reason(
        "last-digits",
        mine,
        f"The discrete-element response is chaotic here: with a change of 1e-6 in the motion the outcome is {dem.perturbed_outcome} instead of "
        f"{dem.outcome}. Treat one run as one sample."
        if dem.perturbed_outcome != dem.outcome
        else "The discrete-element response is chaotic here: a change of 1e-6 in the motion grows "
        f"{dem.perturbation_growth:.2g} times. Treat one run as one sample.",
        growth=dem.perturbation_growth,
    )


def chance(facts: Facts, pairs: list[Pair]) -> Reason | None:
    """Buildings that differ as nobody can know end differently: a single run is one draw."""
    row = facts.rows.get("probability")
    mine = [p for p in pairs if "probability" in p and not set(p) & set(STATIC)]
    if not mine or row is None or row.demand is None or not 0.05 < row.demand < 0.95:
        return None
    return reason(
        "chance",
        mine,
        f"Of {row.parameters.split(' (coef')[0]}, {100 * row.demand:.0f} % collapse under the hazard itself: a single run of one building "
        "under one motion is one draw of these.",
        share=row.demand,
    )


def _moves_alike(one: DemRun, other: DemRun) -> bool:
    """Whether two runs of elements end alike, their stones moved as far to a fifth."""
    far, near = one.peak_displacement_m, other.peak_displacement_m
    return (one.outcome == "collapse") == (other.outcome == "collapse") and abs(far - near) < 0.2 * max(far, near)


def violated(facts: Facts, pairs: list[Pair]) -> list[Reason]:
    """A strategy that leaves the outcome open since an assumption of it does not hold: the other does not rest on that."""
    found = []
    for name in facts.judged():
        row = facts.rows[name]
        mine = [p for p in pairs if name in p and facts.relation(*p) == "open"]
        if mine and row.outcome == "open" and row.violated:
            text = f"The outcome by {row.label} is open: an assumption does not hold. {' '.join(row.violated)}"
            found.append(reason("violated", mine, text))
    return found


def sliding(facts: Facts, pairs: list[Pair]) -> Reason | None:
    """Stones slide, which rocking and the criterion rule out."""
    dem, without = facts.of("dem"), facts.probes.get("no-sliding")
    others = {"rocking", "assessment", "probability", "tilt", *(("sla",) if facts.building.meshed_by_stones else ())}
    mine = [p for p in pairs if "dem" in p and others & set(p)]
    if not mine or not isinstance(dem, DemRun) or dem.decided_by_last_digits:
        return None  # of one draw of many nothing can be compared
    shortest = float(facts.building.blocks().length.min())
    if dem.peak_slip_m < SLID * shortest:
        return None
    numbers: dict[str, float | None] = {"slip_m": dem.peak_slip_m, "slip_ratio": dem.peak_slip_m / shortest}
    text = f"Stones slide by up to {1e3 * dem.peak_slip_m:.3g} mm, {100 * dem.peak_slip_m / shortest:.2g} % of the shortest joint"
    if without is None or not isinstance(without.results, DemRun):
        return None
    other = without.results
    if _moves_alike(other, dem):
        return None
    numbers["displacement_without_sliding_m"] = other.peak_displacement_m
    numbers["displacement_m"] = dem.peak_displacement_m
    return reason(
        "sliding",
        mine,
        f"{text}, which a rocking mechanism excludes. Without sliding the elements "
        f"{'collapse' if other.outcome == 'collapse' else 'stand'} and move by {other.peak_displacement_m:.3g} m, with it "
        f"{'they collapse' if dem.outcome == 'collapse' else f'by {dem.peak_displacement_m:.3g} m'}.",
        **numbers,
    )


def sliding_as_collapse(facts: Facts, pairs: list[Pair]) -> Reason | None:
    """Statics counts sliding as collapse; under the motion the blocks slide by a distance that is finite, and stop."""
    dem, tilt = facts.of("dem"), facts.of("tilt")
    static = ("tilt", "sla") if facts.building.meshed_by_stones else ("tilt",)
    mine = [p for p in pairs if "dem" in p and facts.split(p)[0] in static]
    if not mine or not isinstance(dem, DemRun) or not isinstance(tilt, Tilt) or dem.decided_by_last_digits:
        return None
    least = _unstopped(facts, tilt)
    forth, back = ((tilt.capacity(way), joints) for way, joints in ((False, tilt.dilating_joints), (True, tilt.dilating_joints_opposite)))
    slides = any(capacity == least and joints for capacity, joints in (forth, back))
    if not slides or dem.outcome == "collapse" or dem.peak_slip_m < FAR * dem.peak_displacement_m or dem.peak_slip_m <= 0.0:
        return None
    return reason(
        "sliding",
        mine,
        f"Limit analysis counts sliding as collapse, from {least:.3g} g on. Under the motion the blocks slide by {1e3 * dem.peak_slip_m:.3g} mm "
        "and do not collapse.",
        static_capacity=least,
        slip_m=dem.peak_slip_m,
    )


def hinges_elsewhere(facts: Facts, pairs: list[Pair]) -> Reason | None:
    """The dynamic thrust line leaves the stones: hinges form where the one mechanism has none."""
    mine = dynamic(pairs, "dem")
    found = facts.results.get("rocking")
    if not mine or found is None or "thrust_position" not in found.arrays:
        return None
    position = found.arrays["thrust_position"].data
    moving = np.isfinite(position).any(axis=1)
    if not moving.any():
        return None
    out = np.nanmax(np.maximum(-position[moving], position[moving] - 1.0), axis=1)
    share = float((out > 0.01).mean())
    if share < ELSEWHERE:
        return None
    return reason(
        "hinges-elsewhere",
        mine,
        f"The thrust line of the assumed mechanism leaves the blocks in {100 * share:.0f} % of the rocking time, by up to "
        f"{100 * float(out.max()):.0f} % of their thickness: hinges form elsewhere too, which only discrete elements follow.",
        share_of_time=share,
        farthest_ratio=float(out.max()),
    )


def drums(facts: Facts, pairs: list[Pair]) -> Reason | None:
    """Rocking takes a stack of stones as one body; as one body the elements do as it says."""
    mine = dynamic(pairs, "dem")
    one, dem, whole = facts.probes.get("monolith"), facts.of("dem"), facts.of("rocking")
    if not mine or one is None or not isinstance(one.results, DemRun) or not isinstance(dem, DemRun):
        return None
    if dem.decided_by_last_digits:
        return None
    if not isinstance(whole, Rocking) or (one.results.outcome == "collapse") != (whole.outcome == "collapse"):
        return None
    if _moves_alike(one.results, dem):
        return None
    stones = len(facts.building.blocks().mass)
    return reason(
        "drums",
        mine,
        f"Rocking takes the {stones} blocks as one body. As one body the elements "
        f"{'collapse' if one.results.outcome == 'collapse' else 'stand'} too, moving by "
        f"{one.results.peak_displacement_m:.3g} m; apart the blocks move by {dem.peak_displacement_m:.3g} m.",
        displacement_of_one_body_m=one.results.peak_displacement_m,
        displacement_m=dem.peak_displacement_m,
    )


def membrane(facts: Facts, pairs: list[Pair]) -> Reason | None:
    """A wall of finite elements does not slide along its joints, and bears tension; its stones do the one, not the other."""
    sla, tilt = facts.rows.get("sla"), facts.of("tilt")
    mine = [p for p in pairs if "sla" in p and ("tilt" in p or "dem" in p)]
    if not mine or sla is None or sla.capacity is None or not isinstance(tilt, Tilt) or facts.building.meshed_by_stones:
        return None
    held = facts.probes.get("tilt-no-sliding")
    strength = facts.building.material.tensile_strength
    least = _unstopped(facts, tilt)
    if held is not None and isinstance(held.results, Tilt):
        stuck = _unstopped(facts, held.results)
        if stuck > 1.05 * least and abs(sla.capacity - stuck) < abs(sla.capacity - least):
            return reason(
                "membrane-without-sliding",
                mine,
                f"The wall of finite elements cannot slide along its joints: limit analysis gives {least:.3g} g with friction "
                f"{facts.building.joints.friction} and {stuck:.3g} g without sliding, the elements {sla.capacity:.3g} g"
                f"{', which have a tensile strength besides' if strength and sla.capacity > 1.05 * stuck else ''}.",
                with_sliding=least,
                without_sliding=stuck,
                elements=sla.capacity,
            )
    if strength and sla.capacity > least:
        return reason(
            "tension",
            mine,
            f"The elements have a tensile strength of {strength / 1e6:.3g} MPa, dry joints none: {sla.capacity:.3g} g "
            f"against {least:.3g} g.",
            tensile_strength=strength,
            elements=sla.capacity,
            stones=least,
        )
    return None


def mortar(facts: Facts, pairs: list[Pair]) -> Reason | None:
    """Joints with tension or cohesion: elements know them, limit analysis and rocking do not."""
    joints = facts.building.joints
    with_mortar = ("dem", "sla") if facts.building.meshed_by_stones else ("dem",)
    mine = [p for p in pairs if (facts.split(p)[1] in with_mortar and facts.split(p)[0] not in with_mortar)]
    if not mine or not (joints.tension or joints.cohesion):
        return None
    return reason(
        "mortar",
        mine,
        f"The mortar has a tensile strength of {joints.tension / 1e6:.3g} MPa and a cohesion of {joints.cohesion / 1e6:.3g} MPa "
        "until it breaks, which limit analysis and rocking neglect.",
        tension=joints.tension,
        cohesion=joints.cohesion,
    )


#: Checks of NTC that compare the multiplier, by the start of their names
BY_MULTIPLIER = ("NTC linear", "NTC activation")


def code_factors(facts: Facts, pairs: list[Pair]) -> Reason | None:
    """The code divides the multiplier of statics by FC and by e* of what moves, and multiplies it by q: only where that product is the
    capacity of its check do these factors explain what differs."""
    found = _governing(facts, pairs)
    tilt = facts.of("tilt")
    if found is None or not isinstance(tilt, Tilt) or not found[1][0][1].startswith(BY_MULTIPLIER):
        return None
    r, ((_, name, check), *_), mine = found
    least = _unstopped(facts, tilt)
    fc, q = r.confidence_factor, r.behaviour_factor if name.startswith("NTC linear") else 1.0
    if check.demand is None or check.capacity is None or fc is None or q is None or abs(check.capacity / least - 1.0) < 0.05:
        return None
    part = r.participating_part if isinstance(r, LocalMechanism) else 1.0
    if abs(check.capacity * part * fc / (q * least) - 1.0) > 0.02:
        return None  # another mechanism, or a weight that these factors do not hold
    other = [p for p in mine if "tilt" in p or "sla" in p] or mine
    taking = "" if abs(part - 1.0) < 0.005 else f", divided by e* = {part:.3g}, the part of the moving weight that takes part"
    reserve = " The factor q is the reserve of rocking beyond uplift." if q != 1.0 else ""
    return reason(
        "code-factors",
        other,
        f"{name} of the code compares a demand of {check.demand:.3g} g with a capacity of {check.capacity:.3g} g. This capacity is the collapse "
        f"acceleration by statics, {least:.3g} g{taking}, multiplied by {q / fc:.3g}, which is {'one' if q == 1.0 else f'the behaviour factor q = {q:g}'} over the confidence factor FC = {fc:g}.{reserve}",
        code_capacity=check.capacity,
        static_capacity=least,
        demand=check.demand,
        factor=q / fc,
        participating_part=part,
    )


def code_check(facts: Facts, pairs: list[Pair]) -> Reason | None:
    """Another check than that of the multiplier governs, and by that one, or by the next code, the codes would say otherwise."""
    found = _governing(facts, pairs)
    if found is None:
        return None
    r, ((margin, name, check), *others), mine = found
    if name.startswith(BY_MULTIPLIER) or check.demand is None or check.capacity is None:
        return None
    starts = next(
        (
            (n, c.capacity, c.demand)
            for n, c in r.checks.items()
            if n.startswith(BY_MULTIPLIER)
            and c.code == check.code
            and c.verdict in ("holds", "fails")
            and c.capacity is not None
            and c.demand
        ),
        None,
    )
    if starts is not None:
        other, what = starts[1] / starts[2], f"{starts[0]}, {starts[2]:.3g} against {starts[1]:.3g} g,"
    elif others:
        other, what = others[0][0], f"{others[0][2].code}, the next code ({others[0][1]}),"
    else:
        return None
    if (other > 1.0) == (margin > 1.0):  # which check governs turns no verdict, and may yet set margins apart
        mine = [p for p in mine if facts.relation(*p) != "disagree"]
        if not mine or max(other, margin) < facts.apart * min(other, margin):
            return None
    moves = ", a displacement, which statics does not give" if check.unit == "m" else ""
    return reason(
        "code-check",
        mine,
        f"The governing check of the codes is {name} of {check.code}, {check.demand:.3g} against {check.capacity:.3g} {check.unit}{moves}: a margin of "
        f"{margin:.3g}. By {what} it would be {other:.3g}.",
        governing_margin=margin,
        demand=check.demand,
        capacity=check.capacity,
        other_margin=other,
    )


def torn_off(facts: Facts, pairs: list[Pair]) -> Reason | None:
    """Codes take a wall apart from its neighbours; in the push of the whole corners and floors hold it."""
    r = facts.of("code-checks")
    mine = [p for p in pairs if "code-checks" in p and set(p) & {*PUSHES, "frame"} and facts.split(p)[0] == "code-checks"]
    if not mine or not isinstance(r, LocalMechanism) or not r.walls:
        return None
    wall = r.walls[0]
    bears = {n: c for p in mine for n in p if n != "code-checks" and (c := _reached(facts, n)) is not None}
    if not bears or wall.multiplier >= min(bears.values()):
        return None
    weakest = min(bears, key=lambda n: bears[n])
    return reason(
        "torn-off",
        mine,
        f"The codes consider each wall apart from those across it: wall {wall.wall} overturns out of its plane about the foot of storey "
        f"{wall.storey} at alpha_0 = {wall.multiplier:.3g}. In the {facts.rows[weakest].label} corners and floors hold the walls together, and the "
        f"whole carries {bears[weakest]:.3g} g, as far as the walls are bonded and anchored.",
        multiplier=wall.multiplier,
        whole_g=bears[weakest],
    )


def weaker_direction(facts: Facts, pairs: list[Pair]) -> Reason | None:
    """Two directions on the plan differ where the one with less masonry along it bears less."""
    plan = facts.building.structure
    mine = [p for p in pairs if set(p) == set(PUSHES)]
    if not mine or not isinstance(plan, Plan):
        return None
    weak, strong = facts.split(mine[0])
    area = {"push-x": plan.foot_area(0), "push-y": plan.foot_area(1)}
    if area[weak] >= 0.95 * area[strong]:
        return None
    return reason(
        "weaker-direction",
        mine,
        f"Along the {facts.rows[weak].label.removeprefix('push along ')} axis the area of the walls is {area[weak]:.3g} m^2, along the "
        f"{facts.rows[strong].label.removeprefix('push along ')} axis {area[strong]:.3g} m^2.",
        weak_m2=area[weak],
        strong_m2=area[strong],
    )


def frame_and_shells(facts: Facts, pairs: list[Pair]) -> Reason | None:
    """The frame and the shells of one building carry base shears that differ by more than a stated part."""
    frame = facts.of("frame")
    if not isinstance(frame, FramePushover):
        return None
    told, numbers, mine = [], {}, []
    for name, direction in zip(PUSHES, (0.0, 90.0), strict=True):
        shells = facts.of(name)
        if not isinstance(shells, Pushover):
            continue
        alike = [r for r in frame.runs if r.direction_deg == direction and r.pattern == "uniform" and r.eccentricity == 0.0]
        loads = [c.greatest_load_N for c in (shells, shells.minus) if c is not None and c.greatest_load_N is not None]
        if not alike or not loads:
            continue
        one, other = min(r.peak_base_shear_N for r in alike), min(loads)
        if max(one, other) <= (1.0 + SHELLS_APART) * min(one, other):
            continue
        axis = name.removeprefix("push-")
        text = f"Along {axis} the frame carries {one / 1e3:.3g} kN and the shells {other / 1e3:.3g} kN"
        if any(c.peak_load_N is None for c in (shells, shells.minus) if c is not None):
            text += ", which have not passed their peak"
        if shells.flanges is not None and shells.walls:
            text += f"; walls across carry {100 * shells.flanges.share:.2g} % of the latter"
            numbers[f"across_share_{axis}"] = shells.flanges.share
        told.append(f"{text}.")
        mine.append(next((p for p in pairs if set(p) == {"frame", name}), ("frame", name)))
        numbers |= {f"frame_{axis}_N": one, f"shells_{axis}_N": other}
    if not told:
        return None
    return reason(
        "frame-and-shells",
        mine,
        f"{' '.join(told)} Sections of the frame carry no tension, its piers slide or crack by the strengths of codes, and flanges act only "
        "through the vertical shear at corners. Shells have the tensile strength of the masonry and bend out of their planes; they slide "
        "only along drawn joints.",
        **numbers,
    )


def _reached(facts: Facts, name: str) -> float | None:
    """The acceleration [g] up to which a push has come."""
    row = facts.rows[name]
    margin = row.margin if row.margin is not None else row.margin_at_least
    return row.capacity if row.capacity is not None else None if margin is None else margin * facts.peak_g


def _governing(facts: Facts, pairs: list[Pair]) -> tuple[Checked, list[tuple[float, str, Check]], list[Pair]] | None:
    """The results of the codes with the checks by which they say what they say, and the pairs with them; None without any."""
    r = facts.of("code-checks")
    mine = [p for p in pairs if "code-checks" in p]
    if not mine or not isinstance(r, Checked) or not (there := r.governing()):
        return None
    return r, there, mine


Rule = Callable[[Facts, list[Pair]], Reason | list[Reason] | None]
RULES: tuple[Rule, ...] = (
    static_peak,
    crack,
    left_out,
    ties_of_statics,
    impact_rule,
    last_digits,
    elements_of_last_digits,
    violated,
    sine_for_record,
    sliding,
    sliding_as_collapse,
    drums,
    hinges_elsewhere,
    membrane,
    mortar,
    code_factors,
    code_check,
    torn_off,
    weaker_direction,
    frame_and_shells,
    chance,
)


def explained(facts: Facts, failed: Callable[[str, Exception], None] | None = None) -> tuple[list[Reason], list[Pair]]:
    """The reasons that the rules find for the pairs that do not agree, and the pairs for which there is none.

    failed: takes the name of a rule that raised, and its error, and the other rules still count; None: the error is raised.
    """
    pairs = facts.pairs()
    said: list[Reason] = []
    for rule in RULES:
        try:
            given = rule(facts, pairs)
        except ENDING:
            raise
        except Exception as error:
            if failed is None:
                raise
            failed(rule.__name__.replace("_", "-"), error)
            continue
        said += given if isinstance(given, list) else [] if given is None else [given]
    found = [one for one in said if one.explains]
    told = {tuple(p) for one in found for p in one.explains}
    return found, [p for p in pairs if p not in told]
