"""Reasons by which strategies that follow the motion differ: impacts, chaos, sliding, other hinges, restraints, violated assumptions."""

import numpy as np

from extrados.analyses.assess.facts import SLID, STATIC, Facts, Pair, dynamic, reason
from extrados.results.assess import Reason
from extrados.results.dem import DemRun
from extrados.results.rocking import Assessment, Rocking

#: A thrust line outside the blocks by this share of the time is elsewhere
ELSEWHERE = 0.1


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
        f"The restraints of the mechanism are {' and '.join(sorted(every))}. The following strategies neglect them: "
        f"{' and '.join(facts.rows[n].label for n in bare if any(n in p for p in mine))}. Without restraints the greatest rotation is "
        f"{100 * other.peak_rotation_ratio:.3g} % of the critical rotation, with restraints {100 * r.peak_rotation_ratio:.3g} %.",
        rotation_ratio_without=other.peak_rotation_ratio,
        rotation_ratio=r.peak_rotation_ratio,
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
        f"The energy loss at impacts decides the outcome: rocking collapses with the impact rule {told(falls)} "
        f"and recovers with {told(stands)}. Discrete elements lose energy by the damping of their contacts instead.",
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
        f"The criterion replaces the motion by its strongest sine, with {abs(a.primary_impulse.amplitude_g):.3g} g and a period of "
        f"{a.primary_impulse.period_s:.3g} s. This sine explains {100 * a.primary_impulse.goodness_of_fit:.0f} % of the squared "
        f"acceleration over its duration. Under this sine alone, the greatest rotation is {100 * sine.peak_rotation_ratio:.0f} % of the critical "
        f"rotation. Under the whole motion, the greatest rotation is {100 * whole.peak_rotation_ratio:.0f} %.",
        sine_amplitude_g=abs(a.primary_impulse.amplitude_g),
        sine_period_s=a.primary_impulse.period_s,
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
        "The rocking response to this motion is chaotic: perturbations of 1e-6 to 1e-4 change it strongly. One run is "
        f"only one sample. Its greatest rotation is {100 * r.peak_rotation_ratio:.0f} % of the critical rotation.",
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
        else (
            "The discrete-element response is chaotic here: a change of 1e-6 in the motion grows by a factor of "
            f"{dem.perturbation_growth:.2g}. Treat one run as one sample."
        ),
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
        f"Under the hazard itself, {100 * row.demand:.0f} % of the sampled runs collapse ({row.parameters.split(' (coef')[0]}). "
        "A single run of one building under one motion is one member of this sample.",
        share=row.demand,
    )


def violated(facts: Facts, pairs: list[Pair]) -> list[Reason]:
    """A strategy that leaves the outcome open since an assumption of it does not hold: the other does not rest on that."""
    found = []
    for name in facts.judged():
        row = facts.rows[name]
        mine = [p for p in pairs if name in p and facts.relation(*p) == "open"]
        if mine and row.outcome == "open" and row.violated:
            text = f"The outcome by {row.label} is open, because an assumption is violated. {' '.join(row.violated)}"
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
    text = (
        f"Blocks slide by up to {1e3 * dem.peak_slip_m:.3g} mm, {100 * dem.peak_slip_m / shortest:.2g} % of the length of "
        "the shortest joint"
    )
    if without is None or not isinstance(without.results, DemRun):
        return None
    other = without.results
    if moves_alike(other, dem):
        return None
    numbers["displacement_without_sliding_m"] = other.peak_displacement_m
    numbers["displacement_m"] = dem.peak_displacement_m
    return reason(
        "sliding",
        mine,
        f"{text}. A rocking mechanism excludes sliding. Without sliding the discrete elements "
        f"{'collapse' if other.outcome == 'collapse' else 'stand'}, with a displacement of {other.peak_displacement_m:.3g} m. With "
        f"sliding {'they collapse' if dem.outcome == 'collapse' else f'the displacement is {dem.peak_displacement_m:.3g} m'}.",
        **numbers,
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
        f"During {100 * share:.0f} % of the rocking time, the thrust line of the assumed mechanism passes "
        f"outside the blocks, by up to {100 * float(out.max()):.0f} % of their thickness. Hinges then form "
        "at other joints too, which only discrete elements represent.",
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
    if moves_alike(one.results, dem):
        return None
    stones = len(facts.building.blocks().mass)
    return reason(
        "drums",
        mine,
        f"Rocking treats the {stones} blocks as one body. If the discrete elements are joined into one body, they "
        f"{'collapse' if one.results.outcome == 'collapse' else 'stand'} too, with a displacement of "
        f"{one.results.peak_displacement_m:.3g} m. As separate blocks they move by {dem.peak_displacement_m:.3g} m.",
        displacement_of_one_body_m=one.results.peak_displacement_m,
        displacement_m=dem.peak_displacement_m,
    )


def moves_alike(one: DemRun, other: DemRun) -> bool:
    """Whether two runs of elements end alike, their stones moved as far to a fifth."""
    far, near = one.peak_displacement_m, other.peak_displacement_m
    return (one.outcome == "collapse") == (other.outcome == "collapse") and abs(far - near) < 0.2 * max(far, near)
