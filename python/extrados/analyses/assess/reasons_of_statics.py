"""Reasons by which strategies of statics differ from others: how long a peak lasts, cracks, ties, tensile strength, mortar."""

import numpy as np

from extrados.analyses.assess.facts import DYNAMIC, STATIC, Facts, Pair, least_of_limit_analysis, reason
from extrados.analyses.assess.hazard import above, passages
from extrados.results.assess import Reason
from extrados.results.dem import DemRun
from extrados.results.limit import Tilt

#: Of a collapse displacement: what moved less than this was far from it
FAR = 0.5


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
    # if both stand, the motion is scaled to the greatest factor that the dynamic answer still carries
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
        f"Static analysis applies the peak of {told} as a constant horizontal acceleration. The motion exceeds {capacity:.3g} g "
        f"(capacity by {facts.rows[weakest].label}) {count} time{'s' if count != 1 else ''}, each time for {longest:.3g} s at most"
    )
    numbers = {"static_capacity": capacity, "peak": amplitude, "excursions": float(count), "longest_s": longest, "needed_s": needed}
    if needed is not None and longest < needed:
        return reason(
            "static-peak",
            mine,
            f"{text}. A constant horizontal acceleration equal to that peak must act for {needed:.3g} s to cause collapse.",
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
        f"{text}. During that time the blocks move by only {100 * moved:.2g} % of the displacement that counts as collapse.",
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
        f"{text}. These times are too short for collapse: the most dangerous interval has a mean of {mean:.3g} g over "
        f"{length:.3g} s. A constant horizontal acceleration of {mean:.3g} g must act for {needed:.3g} s to cause collapse.",
        **{**numbers, "passage_g": mean, "passage_s": length, "passage_needed_s": needed},
    )


def crack(facts: Facts, pairs: list[Pair]) -> Reason | None:
    """A cracked buttress carries less; limit analysis alone considers the crack."""
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
        f"Limit analysis considers a crack in the leeward buttress. The collapse acceleration is {cracked:.3g} g with the "
        f"crack. With monolithic buttresses it is {whole:.3g} g, which exceeds the peak of {facts.peak_g:.3g} g. The other "
        "strategies do not consider this crack.",
        cracked=cracked,
        whole=whole,
        peak=facts.peak_g,
    )


def ties_of_statics(facts: Facts, pairs: list[Pair]) -> Reason | None:
    """One strategy of statics knows ties and the other does not; without them the first says as the second."""
    mine = [p for p in pairs if set(p) == {"tilt", "sla"} and "sla" in facts.bare]
    without, tilt, sla = facts.probes.get("tilt-without"), facts.rows.get("tilt"), facts.rows.get("sla")
    if not mine or without is None or not isinstance(without.results, Tilt) or tilt is None or sla is None:
        return None
    bare = least_of_limit_analysis(facts, without.results)
    if sla.capacity is None or tilt.capacity is None or abs(bare - sla.capacity) > 0.1 * bare:
        return None
    return reason(
        "left-out",
        mine,
        f"Limit analysis includes the ties, and the finite elements do not. The capacity is {tilt.capacity:.3g} g by "
        f"limit analysis with ties, {bare:.3g} g without ties, and {sla.capacity:.3g} g by the finite elements.",
        with_ties=tilt.capacity,
        without_ties=bare,
        elements=sla.capacity,
    )


def sliding_as_collapse(facts: Facts, pairs: list[Pair]) -> Reason | None:
    """Statics counts sliding as collapse; under the motion the blocks slide by a distance that is finite, and stop."""
    dem, tilt = facts.of("dem"), facts.of("tilt")
    static = ("tilt", "sla") if facts.building.meshed_by_stones else ("tilt",)
    mine = [p for p in pairs if "dem" in p and facts.split(p)[0] in static]
    if not mine or not isinstance(dem, DemRun) or not isinstance(tilt, Tilt) or dem.decided_by_last_digits:
        return None
    least = least_of_limit_analysis(facts, tilt)
    forth, back = ((tilt.capacity(way), joints) for way, joints in ((False, tilt.dilating_joints), (True, tilt.dilating_joints_opposite)))
    slides = any(capacity == least and joints for capacity, joints in (forth, back))
    if not slides or dem.outcome == "collapse" or dem.peak_slip_m < FAR * dem.peak_displacement_m or dem.peak_slip_m <= 0.0:
        return None
    return reason(
        "sliding",
        mine,
        f"Limit analysis counts sliding as collapse. Sliding begins at {least:.3g} g. Under the motion the "
        f"blocks slide by {1000.0 * dem.peak_slip_m:.3g} mm and do not collapse.",
        static_capacity=least,
        slip_m=dem.peak_slip_m,
    )


def membrane(facts: Facts, pairs: list[Pair]) -> Reason | None:
    """A wall of finite elements does not slide along its joints, and carries tension; its blocks slide and carry none."""
    sla, tilt = facts.rows.get("sla"), facts.of("tilt")
    mine = [p for p in pairs if "sla" in p and ("tilt" in p or "dem" in p)]
    if not mine or sla is None or sla.capacity is None or not isinstance(tilt, Tilt) or facts.building.meshed_by_stones:
        return None
    held = facts.probes.get("tilt-no-sliding")
    strength = facts.building.material.tensile_strength
    least = least_of_limit_analysis(facts, tilt)
    if held is not None and isinstance(held.results, Tilt):
        stuck = least_of_limit_analysis(facts, held.results)
        if stuck > 1.05 * least and abs(sla.capacity - stuck) < abs(sla.capacity - least):
            return reason(
                "membrane-without-sliding",
                mine,
                f"The wall of finite elements cannot slide along its joints. Limit analysis gives {least:.3g} g with friction "
                f"{facts.building.joints.friction} and {stuck:.3g} g without sliding; the finite elements give {sla.capacity:.3g} "
                f"g{', and they also have a tensile strength' if strength and sla.capacity > 1.05 * stuck else ''}.",
                with_sliding=least,
                without_sliding=stuck,
                elements=sla.capacity,
            )
    if strength and sla.capacity > least:
        return reason(
            "tension",
            mine,
            f"The finite elements have a tensile strength of {strength / 1000000.0:.3g} MPa; the dry joints of "
            f"limit analysis have none. The capacities are {sla.capacity:.3g} g and {least:.3g} g.",
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
        f"Until it breaks, the mortar has a tensile strength of {joints.tension / 1000000.0:.3g} MPa and a "
        f"cohesion of {joints.cohesion / 1000000.0:.3g} MPa. Limit analysis and rocking neglect both.",
        tension=joints.tension,
        cohesion=joints.cohesion,
    )
