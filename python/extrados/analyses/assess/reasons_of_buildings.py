"""Reasons by which codes, and pushes of a building on a plan, differ from others: their factors and checks, corners, axes, models."""

from dataclasses import replace

from extrados.analyses.assess.facts import DYNAMIC, STATIC, Facts, Pair, least_of_limit_analysis, reason
from extrados.analyses.assess.words import list_labels
from extrados.model.structures.plan import Plan
from extrados.results.assess import Reason
from extrados.results.codes import Check, Checked, LocalMechanism
from extrados.results.frame import FramePushover
from extrados.results.limit import Tilt
from extrados.results.shell import Pushover
from extrados.schema.quantities import engineering

#: Part by which the base shears of frame and shells may differ without a stated reason
SHELLS_APART = 0.15
#: The push of a building on a plan along its two axes
PUSHES = ("push-x", "push-y")
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
    least = least_of_limit_analysis(facts, tilt)
    fc, q = r.confidence_factor, r.behaviour_factor if name.startswith("NTC linear") else 1.0
    if check.demand is None or check.capacity is None or fc is None or q is None or abs(check.capacity / least - 1.0) < 0.05:
        return None
    part = r.participating_part if isinstance(r, LocalMechanism) else 1.0
    if abs(check.capacity * part * fc / (q * least) - 1.0) > 0.02:
        return None  # another mechanism, or a weight that these factors do not hold
    other = [p for p in mine if "tilt" in p or "sla" in p] or mine
    taking = "" if abs(part - 1.0) < 0.005 else f", divided by e* = {part:.3g}, the participating share of the moving weight"
    reserve = " The factor q represents the reserve between the start of rocking and collapse." if q != 1.0 else ""
    return reason(
        "code-factors",
        other,
        f"{name} of the code compares a demand of {check.demand:.3g} g with a capacity of {check.capacity:.3g} g. This "
        f"capacity is the collapse acceleration by statics, {least:.3g} g{taking}, multiplied by {q / fc:.3g}, which is "
        f"{'1' if q == 1.0 else f'the behaviour factor q = {q:g}'} divided by the confidence factor FC = {fc:g}.{reserve}",
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
    moves = ", a displacement, which static analysis does not give" if check.unit == "m" else ""
    return reason(
        "code-check",
        mine,
        f"The governing check of the codes is {name} of {check.code}, demand {check.demand:.3g}, capacity "
        f"{check.capacity:.3g} {check.unit}{moves}. The safety factor is {margin:.3g}. By {what} the safety factor would be {other:.3g}.",
        governing_margin=margin,
        demand=check.demand,
        capacity=check.capacity,
        other_margin=other,
    )


def code_spectrum(facts: Facts, pairs: list[Pair]) -> Reason | None:
    """The codes check the spectrum of the site, other strategies the motion or its peak: with the motion in place of the site, at the limit
    state of the governing check, the codes would agree with them."""
    found = _governing(facts, [p for p in pairs if any(_follows_motion(facts, n) for n in p)])
    probe = facts.probes.get("codes-motion")
    if found is None or probe is None or not isinstance(probe.results, Checked):
        return None
    r, ((margin, name, check), *_), mine = found
    others = {n: c for n, c in r.checks.items() if c.limit_state != check.limit_state}
    moved = {n: c for n, c in probe.results.checks.items() if c.limit_state == check.limit_state}
    if isinstance(r, LocalMechanism) and r.walls and any(c.limit_state for c in others.values()):
        return None  # the other limit states of the other walls are not known
    same = next((c for c in moved.values() if (c.source, c.unit) == (check.source, check.unit)), None)
    by_motion = r.model_copy(update={"checks": {**others, **moved}, "margin_associated": probe.results.margin_associated})
    if same is None or not (rows := by_motion.governing()):
        return None
    other, at, governs = rows[0]
    row = facts.rows["code-checks"].model_copy(update={"outcome": by_motion.overall().outcome, "margin": other})
    then = replace(facts, rows=facts.rows | {"code-checks": row})
    verdicts = {"disagree": ("agree", "apart"), "apart": ("agree",)}
    if not (mine := [p for p in mine if then.relation(*p) in verdicts.get(facts.relation(*p), ())]):
        return None
    capacity = same.demand == check.demand  # of ASCE 41, whose limit of slenderness depends on the spectrum
    site, motion = (check.capacity, same.capacity) if capacity else (check.demand, same.demand)
    if site is None or motion is None:
        return None
    labels = list_labels([facts.rows[n].label for p in mine for n in p if n != "code-checks"])
    by = "" if governs.source == check.source else f" by {at}{'' if governs.limit_state in at else f' at {governs.limit_state}'}"
    return reason(
        "code-spectrum",
        mine,
        f"The codes check the spectrum of the site, not the motion. In the governing check, {name}, the {'capacity' if capacity else 'demand'} "
        f"is {engineering(site, check.unit)} with the spectrum of the site, and {engineering(motion, check.unit)} with that of the motion. "
        f"With the motion the safety factor would be {other:.3g}{by} instead of {margin:.3g}, and the codes would agree with {labels}.",
        site=site,
        motion=motion,
        governing_margin=margin,
        other_margin=other,
    )


def torn_off(facts: Facts, pairs: list[Pair]) -> Reason | None:
    """Codes take a wall apart from its neighbours; in the push of the whole corners and floors hold it."""
    r = facts.of("code-checks")
    mine = [p for p in pairs if "code-checks" in p and set(p) & {*PUSHES, "frame"} and facts.split(p)[0] == "code-checks"]
    if not mine or not isinstance(r, LocalMechanism) or not r.walls:
        return None
    wall = r.walls[0]
    carried = {n: c for p in mine for n in p if n != "code-checks" and (c := _reached(facts, n)) is not None}
    if not carried or wall.multiplier >= min(carried.values()):
        return None
    weakest = min(carried, key=lambda n: carried[n])
    return reason(
        "torn-off",
        mine,
        f"The codes consider each wall separately from the transverse walls: wall {wall.wall} overturns out of its plane about the foot "
        f"of storey {wall.storey} at alpha_0 = {wall.multiplier:.3g}. By the {facts.rows[weakest].label}, corners and floors hold the "
        f"walls together. The whole building then carries {carried[weakest]:.3g} g, if the walls are bonded and anchored.",
        multiplier=wall.multiplier,
        whole_g=carried[weakest],
    )


def weaker_direction(facts: Facts, pairs: list[Pair]) -> Reason | None:
    """Two directions on the plan differ if the one with less masonry along it carries less."""
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
        f"The cross-sectional area of the walls is {area[weak]:.3g} m^2 along the {weak.removeprefix('push-')} "
        f"axis, and {area[strong]:.3g} m^2 along the {strong.removeprefix('push-')} axis.",
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
        text = f"Along {axis} the frame carries {one / 1e3:.3g} kN, and the shells carry {other / 1e3:.3g} kN"
        if any(c.peak_load_N is None for c in (shells, shells.minus) if c is not None):
            text += " (the run of the shells ended before the load decreased)"
        if shells.flanges is not None and shells.walls:
            text += f"; transverse walls carry {100 * shells.flanges.share:.2g} % of the shells' base shear"
            numbers[f"across_share_{axis}"] = shells.flanges.share
        told.append(f"{text}.")
        mine.append(next((p for p in pairs if set(p) == {"frame", name}), ("frame", name)))
        numbers |= {f"frame_{axis}_N": one, f"shells_{axis}_N": other}
    if not told:
        return None
    return reason(
        "frame-and-shells",
        mine,
        f"{' '.join(told)} In the frame, sections carry no tension, and piers slide or crack at the strengths of codes. The flanges of the frame "
        "act only by the vertical shear at corners. The shells have the tensile strength of the masonry and also bend out of plane. They "
        "slide only along joints that the deck gives.",
        **numbers,
    )


def _follows_motion(facts: Facts, name: str) -> bool:
    """Whether a strategy follows the motion, or applies its peak as a constant acceleration; not if it is verified by displacement."""
    row = facts.rows[name]
    peak = row.unit == "g" and row.demand is not None and abs(row.demand - facts.peak_g) <= 1e-6 * facts.peak_g
    return name in DYNAMIC or (name in (*STATIC, "frame") and peak)


def _reached(facts: Facts, name: str) -> float | None:
    """The acceleration [g] up to which a push has come."""
    row = facts.rows[name]
    margin = row.margin if row.margin is not None else row.margin_at_least
    return row.capacity if row.capacity is not None else None if margin is None else margin * facts.peak_g


def _governing(facts: Facts, pairs: list[Pair]) -> tuple[Checked, list[tuple[float, str, Check]], list[Pair]] | None:
    """The results of the codes, the checks that govern them, and the pairs that contain them; None without any."""
    r = facts.of("code-checks")
    mine = [p for p in pairs if "code-checks" in p]
    if not mine or not isinstance(r, Checked) or not (there := r.governing()):
        return None
    return r, there, mine
