"""Tables and arrays of answers, row by row, against what they are of: states of statics, moving loads, rocking, levels."""

import math

import numpy as np
from asking import Answer, Deck, ask, must, near
from buildings import changed, decks, number, pulses
from conservation import building
from definitions_keys import ARCH, PULSE
from fields import LOADS, asymmetric
from hypothesis import strategies as st
from relations import EARTHQUAKES, GRAVITY, ok, relation
from scipy.optimize import minimize
from scipy.stats import norm

from extrados.analyses.assess import budget
from extrados.analyses.statistics import summaries


def _arrays(answer: Answer) -> dict[str, np.ndarray]:
    return {k: np.asarray(v.data) for k, v in answer.result.arrays.items()}


def _in_balance(told: str, a: dict[str, np.ndarray], name: str, masses: np.ndarray, gamma: float, weight: float) -> None:
    """The forces of a state across the joints hold every block under its weight and gamma times that to +x."""
    p, q, blocks = a["joint_p"], a["joint_q"], a["joint_block"].astype(int)
    tangent = (q - p) / np.hypot(*(q - p).T)[:, None]
    across = np.column_stack([-tangent[:, 1], tangent[:, 0]])
    into = [a["centroid"][i] - p[j] if i >= 0 else p[j] - a["centroid"][k] for j, (i, k) in enumerate(blocks)]
    across *= np.sign((across * into).sum(axis=1))[:, None]
    off = []
    for sense in (1.0, -1.0):
        force = a[f"{name}_normal"][:, None] * across + sense * a[f"{name}_shear"][:, None] * tangent
        left = np.column_stack([gamma * masses, -masses, np.zeros(len(masses))]) * GRAVITY
        for j, (i, k) in enumerate(blocks):
            for block, sign in ((i, 1.0), (k, -1.0)):
                if block >= 0:
                    arm = a[f"{name}_point"][j] - a["centroid"][block]
                    left[block, :2] += sign * force[j]
                    left[block, 2] += sign * (arm[0] * force[j, 1] - arm[1] * force[j, 0])
        off.append(float(np.abs(left[:, :2]).max() + np.abs(left[:, 2]).max() / a["joint_p"].std()))
    must(min(off) < 1e-5 * weight, f"{told}: blocks are out of balance by {min(off)} N of {weight} N")
    share = ((a[f"{name}_point"] - p) * tangent).sum(axis=1) / np.hypot(*(q - p).T)
    pressed = a[f"{name}_normal"] > 1e-6 * weight
    must(bool(((share > -1e-6) & (share < 1.0 + 1e-6))[pressed].all()), f"{told}: a thrust line outside of its joints")
    with np.errstate(divide="ignore", invalid="ignore"):
        friction = np.abs(a[f"{name}_shear"]) / a[f"{name}_normal"]
    near(f"{told}: friction", a[f"{name}_friction"][pressed], friction[pressed], 1e-6, 1e-3)


SECTIONS = decks("arch", "pointed-arch", "elliptical-arch", "block", "column", "brickwork", "blocks", friction=number(0.4, 0.9, 10))


@relation("tilt thrust", st.tuples(SECTIONS, number(-0.05, 0.05, 10)), 1e-6, share=2.0)
def states_of_statics_by_hand(deck: Deck, gamma: float, within: float) -> None:
    """States at collapse and of the least and greatest thrust balance every block; hinges, reactions and rows are those of their arrays."""
    tilt = ask(deck, "tilt")
    ok(tilt)
    r, a = tilt.results, _arrays(tilt)
    stones = building(deck).blocks()
    masses, weight = stones.mass, float(stones.mass.sum()) * GRAVITY
    near("weight", r.weight_N, weight, within)
    _in_balance("at collapse", a, "collapse", masses, r.collapse_acceleration_g, weight)
    v = a["velocity"]
    work = float(masses @ (r.collapse_acceleration_g * v[:, 0] - v[:, 1]))
    if not r.dilating_joints:
        near("work of the mechanism", work, 0.0, 0.0, 1.0) if abs(work) > 1e-6 * float(masses @ np.abs(v[:, :2]).sum(axis=1)) else None
    for h in r.hinges:
        end = a["joint_p" if h.side in ("intrados", "first end") else "joint_q"][h.joint]
        must(h.name == str(a["joint_name"][h.joint]), f"hinge {h}")
        if deck["structure"]["kind"] in ("arch", "pointed-arch", "elliptical-arch"):
            near("hinge", [h.x_m, h.y_m], end, 1e-6, stones.size)
            near("thrust at the hinge", a["collapse_point"][h.joint], end, 1e-4, stones.size)
    near(
        "reactions",
        [sum(x.horizontal_N for x in r.reactions), sum(x.vertical_N for x in r.reactions)],
        [-r.collapse_acceleration_g * weight, weight],
        1e-6,
        weight,
    )
    for row in r.reactions:
        size = math.hypot(a["collapse_normal"][row.joint], a["collapse_shear"][row.joint])
        near(f"reaction {row.name}", math.hypot(row.horizontal_N, row.vertical_N), size, 1e-6, weight)
        must(row.name == str(a["joint_name"][row.joint]) and min(a["joint_block"][row.joint]) < 0, f"{row}")
    pose, speed = a["mechanism_pose"], v
    turned = np.abs(speed[:, 2]) > 0.3 * np.abs(speed[:, 2]).max()
    if np.abs(speed[:, 2]).max() > 1e-6:
        ratio = pose[turned, 2] / speed[turned, 2]
        must(bool((ratio * ratio[0] > 0.0).all()), f"blocks turn otherwise in the pose: {ratio}")
    if deck["structure"]["kind"] not in ("arch", "pointed-arch", "elliptical-arch"):
        return
    thrust = ask(deck, "thrust", gamma=gamma)
    ok(thrust)
    t, b = thrust.results, _arrays(thrust)
    near("gamma", t.gamma_g, gamma, within, 1.0)
    for name in ("least", "most", "central"):
        _in_balance(name, b, name, masses, gamma, weight)
        table = dict(thrust.result.tables[f"thrust_{name}"].columns)
        for column in ("normal", "shear", "horizontal", "vertical"):  # kN/m
            table[column] = 1e3 * stones.depth * np.asarray(table[column])
        near("rows", table["normal"], b[f"{name}_normal"], within, weight)
        near("rows", np.abs(table["shear"]), np.abs(b[f"{name}_shear"]), within, weight)
        near("rows", np.hypot(table["horizontal"], table["vertical"]), np.hypot(b[f"{name}_normal"], b[f"{name}_shear"]), 1e-6, weight)
        near("rows", np.column_stack([table["x"], table["y"]]), b[f"{name}_point"], within, stones.size)
        length = np.hypot(*(b["joint_q"] - b["joint_p"]).T)
        near("rows", table["joint_length"], length, within)
        middle = 0.5 * (b["joint_p"] + b["joint_q"])
        near("eccentricity", np.abs(table["eccentricity"]), np.hypot(*(b[f"{name}_point"] - middle).T), 1e-5, stones.size)
        near("friction", table["friction_needed"], b[f"{name}_friction"], within, 1.0)
        size = np.hypot(b[f"{name}_normal"], b[f"{name}_shear"])
        near("greatest force along the line", b[f"{name}_line_force"].max(), size.max(), 0.02)
        polygon = b[f"{name}_polygon"]
        near("polygon", np.ptp(polygon[:, 1]), weight / stones.depth, 0.02) if name == "least" and abs(gamma) < 1e-9 else None
    at = [
        np.abs(x).min()
        for x in (thrust.result.tables["thrust_least"].columns["horizontal"], thrust.result.tables["thrust_most"].columns["horizontal"])
    ]
    must(at[0] <= at[1] * (1.0 + 1e-6), f"thrusts {at}")
    if gamma == 0.0:
        near("thrusts", [t.least.horizontal_N, t.most.horizontal_N], at, 1e-6)
        near("interval", [r.thrust_min_N, r.thrust_max_N], at, 1e-6)
    near("interval", t.admissible_interval_g, r.admissible_interval_g, 1e-6)
    near(
        "capacity of the interval",
        [-t.admissible_interval_g[0], t.admissible_interval_g[1]],
        [r.collapse_acceleration_opposite_g, r.collapse_acceleration_g],
        1e-6,
    )


@relation("moving-load", st.tuples(asymmetric("moving-load"), st.booleans(), LOADS), 1e-9)
def tables_of_a_moving_load(question: tuple, tied: bool, loads: list, within: float) -> None:
    """The envelope is that of the states at all places; rows, ties and loads are those of their arrays."""
    deck, kind, table = question
    del loads
    if tied:
        x, y = np.mean(deck["structure"]["block"][0]["points"], axis=0)
        deck["ties"] = [
            {
                "start": [round(float(x), 6), round(float(y), 6)],
                "ground": [round(float(x) - 9.0, 6), round(float(y), 6)],
                "works_in": "tension",
                "yield_force": 1e3,
            }
        ]
    answer = ask(deck, kind, **table)
    ok(answer)
    r, a = answer.results, _arrays(answer)
    normal, point = a["envelope_normal"], a["envelope_point"]
    depth = building(deck).blocks().depth
    rows = answer.result.tables["moving_load_envelope"].columns
    must(list(rows["joint"]) == list(a["joint_name"]), "joints of the envelope")
    length = np.hypot(*(a["joint_q"] - a["joint_p"]).T)
    for j in range(len(length)):
        pressed = normal[:, j] > 0.0
        share = ((point[:, j] - a["joint_p"][j]) @ (a["joint_q"][j] - a["joint_p"][j])) / length[j] ** 2
        near(
            "greatest compression", rows["greatest_compression"][j], np.where(pressed, normal[:, j], 0.0).max() / depth / 1e3, within, 1e-9
        )
        pressed &= np.isfinite(share)
        ends = [rows["least_position"][j], rows["greatest_position"][j]]
        near("positions", ends, [share[pressed].min(), share[pressed].max()] if pressed.any() else [np.nan, np.nan], 1e-6, 1.0)
    columns = answer.result.tables["moving_load"].columns
    near("rows", columns["place"], a["place"], within, 1.0)
    near("rows", columns["collapse_load"], a["capacity"], within)
    near(
        "greatest compression",
        r.greatest_compression_N,
        a["envelope_normal"][int(np.abs(a["place"] - r.worst_place_m).argmin())].max(),
        1e-6,
    ) if not table.get("both_ways") else None
    must(r.places_without_limit == int(np.isnan(a["capacity"]).sum()), f"{r.places_without_limit} places without a limit")
    if tied:
        must({"tie_point", "tie_block", "collapse_tie_force"} <= set(a), f"arrays of ties: {sorted(k for k in a if 'tie' in k)}")
        near("tie", a["collapse_tie_force"], [t.force_N for t in r.ties], within, 1e-3)
        tie = r.ties[0]
        sort = "yields" if abs(tie.force_N) > 999.9 else "slack" if abs(tie.force_N) < 1e-3 else "carries"
        must(tie.state == sort and tie.state in ("yields", "slack", "carries"), f"{tie}")
        must(tie.force_N >= -1e-6 and tie.force_N <= 1e3 * (1.0 + 1e-6), f"{tie}")
    must(len(a["chain_joint"]) == a["chain_start"][-1], "joints of chains")


@relation("rocking", st.tuples(decks("block", "stack", "stack", "arch", "column", "frame"), pulses(0.2, 1.6)), 1e-6, share=4.0)
def histories_of_rocking_by_hand(deck: Deck, motion: Deck, within: float) -> None:
    """Outcome, half cycles, impacts, losses and energies of a run by fixed hinges are those of its history, events and words."""
    answer = ask(changed(deck, motion=motion), "rocking", end_time=2.0, output_step=0.005, hand_over=False)
    ok(answer)
    r, a = answer.results, _arrays(answer)
    stack = deck["structure"]["kind"] == "stack"
    must(
        (r.outcome == "collapse") == (r.collapse_time_s is not None) == (r.collapse_half_cycle is not None),
        f"{r.outcome}: {r.collapse_time_s}, {r.collapse_half_cycle}",
    )
    if r.outcome == "collapse":
        must(r.collapse_half_cycle == r.half_cycles, f"collapse in half cycle {r.collapse_half_cycle} of {r.half_cycles}")
        must(r.collapse_time_s <= 2.0 + 1e-9 and r.collapse_time_s >= a["time"][-1] - 1e-9, f"collapse at {r.collapse_time_s}")
        must(answer.outcome in ("collapses", "open"), answer.outcome)
    else:
        must(r.settled or answer.outcome == "open", f"{answer.outcome} of a run that has not settled")
    must(
        r.impacts == len(r.impact_times_s) if not stack else r.impacts == r.stack.impacts_on_ground + r.stack.impacts_between,
        f"{r.impacts} impacts",
    )
    near("impacts", a["impact_time"], r.impact_times_s, within, 1.0)
    must(list(r.impact_times_s) == sorted(r.impact_times_s), "impacts in another order")
    must(
        (r.outcome == "no-hinging")
        == (np.abs(a["rotation"]).max(initial=0.0) == 0.0 and (not stack or np.abs(a["rotation_upper"]).max(initial=0.0) == 0.0)),
        f"{r.outcome}",
    )
    if r.outcome == "no-hinging":
        must(r.half_cycles == 0 and r.impacts == 0 and r.energy_supplied_J == 0.0, f"{r.half_cycles} half cycles at rest")
    energy = a["kinetic"] + a["potential"]
    scale = max(float(np.abs(energy).max(initial=0.0)), abs(r.energy_supplied_J), 1e-6)
    near("ledger", energy - energy[0], a["ledger"], 2e-4, scale)
    near("residual", r.energy_residual_ratio, np.abs(energy - energy[0] - a["ledger"]).max() / scale, 0.05, 1e-6)
    near("supplied less lost", a["ledger"][-1], r.energy_supplied_J - r.energy_lost_at_impacts_J, 0.05, scale)
    must(r.energy_lost_at_impacts_J >= -1e-9 * scale, f"impacts give {-r.energy_lost_at_impacts_J} J")
    columns = answer.result.tables["rocking"].columns
    pairs = {
        "time": "time",
        "rotation": "rotation",
        "ground_acceleration": "ground",
        "vertical_acceleration": "vertical",
        "kinetic_energy": "kinetic",
        "potential_energy": "potential",
        "energy_supplied_less_lost": "ledger",
        **({"rotation_upper": "rotation_upper"} if stack else {"rotation_rate": "rate"}),
    }
    for column, array in pairs.items():
        near(column, columns[column], a[array], within, 1e-6)
    near("friction", columns["required_friction"], a["required_friction"].max(axis=1), within, 1e-6)
    if deck["structure"]["kind"] == "block":
        s = deck["structure"]
        height, half = s["height"], 0.5 * s["width"]
        radius, slender = math.hypot(half, 0.5 * height), math.atan2(s["width"], height)
        mass = 2000.0 * s["width"] * height * s["depth"]
        inertia = mass * 4.0 * radius**2 / 3.0
        side = np.where(a["rotation"] < 0.0, -1.0, 1.0)
        q = np.abs(a["rotation"])
        near("potential energy", a["potential"], mass * GRAVITY * radius * (np.cos(slender - q) - math.cos(slender)), 1e-5, scale)
        near("kinetic energy", a["kinetic"], 0.5 * inertia * a["rate"] ** 2, 1e-5, scale)
        moving = q > 1e-4
        turning = -mass * GRAVITY * radius * np.sin(slender - q) - side * mass * radius * np.cos(slender - q) * a["ground"]
        near("equation of motion", (side * a["acceleration"])[moving], (turning / inertia)[moving], 1e-4, 1.0)
        x = side * radius * (np.cos(slender - q) * side * a["acceleration"] + np.sin(slender - q) * a["rate"] ** 2)
        y = radius * (np.sin(slender - q) * side * a["acceleration"] - np.cos(slender - q) * a["rate"] ** 2)
        needed = np.abs(a["ground"] + x) / np.maximum(GRAVITY + y, 1e-9)
        firm = moving & (GRAVITY + y > 0.1)
        near("friction", a["required_friction"][firm, 0], needed[firm], 1e-4, 1e-2)
    events = answer.result.tables.get("rocking_events")
    if events is not None:
        kinds_ = list(events.columns["event"])
        must(kinds_.count("impact") == r.impacts, f"{kinds_.count('impact')} impacts of {r.impacts} in the events")
        must(("collapse" in kinds_) == (r.outcome == "collapse"), f"{r.outcome}: {kinds_[-1:]}")
    near(
        "greatest acceleration", r.peak_ground_acceleration_g, np.abs(a["ground"]).max() / GRAVITY, 0.05
    ) if r.outcome != "collapse" else None


STACK = (
    {
        "structure": {"kind": "stack", "lower_width": 0.6, "lower_height": 0.68, "upper_width": 0.3, "upper_height": 0.926},
        "joints": {"friction": 0.6},
    },
    {"kind": "sine-pulse", "amplitude": "0.655 g", "period": 0.96},
)


@relation("rocking", st.tuples(decks("stack"), pulses(0.2, 1.6)), 1e-9, share=0.5, examples=(STACK,))
def impacts_of_stacks_lose_energy(deck: Deck, motion: Deck, within: float) -> None:
    """No impact of two stacked blocks creates energy."""
    answer = ask(changed(deck, motion=motion), "rocking", end_time=2.0, output_step=0.005)
    ok(answer)
    r = answer.results
    must(r.energy_lost_at_impacts_J >= -within * abs(r.energy_supplied_J), f"{-r.energy_lost_at_impacts_J} J")


@relation("fragility", st.tuples(decks("block", "arch", "column"), EARTHQUAKES, st.booleans()), 1e-6, share=1.0)
def tables_of_levels(deck: Deck, motion: Deck, turned: bool, within: float) -> None:
    """Tables and arrays of levels agree with the results; curves are the most likely by another optimiser; first collapses agree with the rows."""
    levels = [1.4, 0.3, 0.7] if turned else [0.3, 0.7, 1.4]
    answer = ask(changed(deck, motion={**motion, "mmi": 9}), "fragility", count=8, bootstrap=0, levels=levels, intensity="pga")
    ok(answer)
    r, a = answer.results, _arrays(answer)
    rows, table = answer.result.tables["ensemble"].columns, answer.result.tables["fragility"].columns
    names = {
        "level": r.levels,
        "count": r.count,
        "uplifted": r.uplifted,
        "collapsed": r.collapsed,
        "collapse_probability": r.collapse_probability,
        "uplift_probability": r.uplift_probability,
        "lower": [x[0] for x in r.confidence_interval],
        "upper": [x[1] for x in r.confidence_interval],
        "uplift_lower": [x[0] for x in r.uplift_confidence_interval],
        "uplift_upper": [x[1] for x in r.uplift_confidence_interval],
    }
    for name, values in names.items():
        near(name, table[name], values, within, 1e-6)
        near(name, a[f"stripe_{name}"], values, within, 1e-6)
    must(list(rows["motion"]) == [k // 3 + 1 for k in range(24)], f"motions {rows['motion']}")
    fell = np.array([[rows["outcome"][3 * k + levels.index(x)] == "collapse" for x in sorted(levels)] for k in range(8)])
    own = answer.result.tables["incremental"].columns
    must(list(own["motion"]) == list(range(1, 9)), f"motions {own['motion']}")
    first = [sorted(levels)[int(row.argmax())] if row.any() else np.nan for row in fell]
    near("first collapse", own["first_collapse"], first, within)
    again = [int((~row[row.argmax() :]).sum()) if row.any() else 0 for row in fell]
    must(list(own["resurrected_levels"]) == again, f"up again at {own['resurrected_levels']} of {again}")
    must(bool((a["incremental_risen"].sum(axis=1) == again).all()), "levels that leave it up again")
    ratio = np.array([[rows["peak_ratio"][3 * k + levels.index(x)] for x in sorted(levels)] for k in range(8)])
    near("peaks", a["incremental_ratio"], ratio, within, 1e-3)
    lifted = np.array(r.uplifted)
    for stage, hits, count in (
        ("", r.collapsed, r.count),
        ("uplift_", lifted, r.count),
        ("overturning_given_uplift_", r.collapsed, lifted),
    ):
        median, dispersion = getattr(r, f"{stage}median"), getattr(r, f"{stage}dispersion")
        hits, count = np.array(hits), np.array(count)
        if median is None:
            continue
        x = np.log(np.array(r.levels))

        def unlikely(v: np.ndarray, hits: np.ndarray = hits, count: np.ndarray = count, x: np.ndarray = x) -> float:
            z = (x - v[0]) / math.exp(v[1])
            return -float(hits @ norm.logcdf(z) + (count - hits) @ norm.logcdf(-z))

        here = unlikely(np.array([math.log(median), math.log(dispersion)]))
        best = minimize(unlikely, [math.log(median) + 0.1, math.log(dispersion) + 0.1], method="Nelder-Mead").fun
        must(here <= best + 1e-3, f"{stage}curve of {median}, {dispersion}: {here} less likely than {best}")
        curve = a[f"{stage}curve"]
        near(f"{stage}curve", curve, norm.cdf(np.log(a["grid"] / median) / dispersion), 1e-6, 1.0)
    if r.median is not None:
        near("capacity", answer.verdict.capacity, r.median, within)
    near("grid", a["grid"][[0, -1]], [0.2, 2.1], within)
    near("median acceleration", r.median_pga_g, r.levels, 1e-4)


@relation(
    "",
    st.tuples(st.integers(1, 5), st.integers(1, 5), number(0.0, 0.4, 9), number(0.6, 1.0, 9), st.integers(2, 4), st.integers(1, 3)),
    1e-12,
    share=2.0,
)
def medians_of_two_halves(pieces: int, each: int, low: float, high: float, bins: int, few: int, within: float) -> None:
    """A median whose two middle values lie far apart is their mean, wherever the pieces are cut."""
    count = pieces * each
    values = np.concatenate([np.linspace(low - 0.1, low, count), np.linspace(high, high + 0.1, count)])
    values = values[np.random.default_rng(count).permutation(2 * count)]
    kept = summaries.FEW, summaries.BINS
    summaries.FEW, summaries.BINS = min(few, 2 * count - 1), bins
    try:
        found = summaries.median(lambda: iter([np.array(x) for x in np.array_split(values, pieces)]))
    finally:
        summaries.FEW, summaries.BINS = kept
    near("median", found, np.median(values), within)


@relation("assess", st.just({}), 0.0, share=0.2)
def an_assessment_ends_at_its_time_limit(deck: Deck, within: float) -> None:
    """With a very short budget strategies are not run, and the result lists them; with a sufficient budget they are run."""
    del deck, within
    asked = changed(ARCH, motion=PULSE)
    whole = ask(asked, "assess", strategies=["tilt", "dem"])
    kept = budget.STOPPED_AFTER
    budget.STOPPED_AFTER = 1e-9
    try:
        brief = ask(asked, "assess", strategies=["dem", "tilt"], budget=61.0)
    finally:
        budget.STOPPED_AFTER = kept
    ok(whole, brief)
    must(all(row.status == "ok" for row in whole.results.verdicts if row.strategy in ("tilt", "dem")), f"{whole.results.verdicts}")
    left = {row.strategy: row for row in brief.results.verdicts}
    must(left["dem"].status == "left out" and "time limit" in left["dem"].reason, f"{left['dem']}")


SOFT = {"stiffness": "50 MN/m^3", "damping_ratio": 0.1}


@st.composite
def rocking_decks(draw: st.DrawFn) -> Deck:
    """Blocks, stacks, columns and arches that rock: free, tied, on a compliant base."""
    kind = draw(st.sampled_from(("block", "soft", "stack", "tied", "arch", "tied arch")))
    friction = draw(number(0.25, 0.7, 9))
    if kind == "stack":
        sizes = {
            "lower_width": 1.0,
            "upper_width": 0.8,
            "lower_height": draw(number(1.2, 2.5, 20)),
            "upper_height": draw(number(0.8, 2.0, 20)),
        }
        deck: Deck = {"structure": {"kind": "stack", **sizes}}
    elif "arch" in kind:
        sizes = {"radius": draw(number(2.0, 10.0, 20)), "embrace": draw(number(130.0, 165.0, 5)), "voussoirs": draw(st.integers(7, 11))}
        deck = {"structure": {"kind": "arch", "thickness": float(f"{0.16 * sizes['radius']:.4g}"), **sizes}}
    else:
        deck = {"structure": {"kind": "block", "width": 0.6, "height": draw(number(1.5, 3.0, 20))}}
    if "tied" in kind:
        blocks = building(deck).blocks()
        k = int(np.argmax(blocks.centroid[:, 1]))
        start = np.round(blocks.centroid[k], 9).tolist()
        stiffness = float(f"{draw(number(2.0, 20.0, 9)) * GRAVITY * blocks.mass.sum() / blocks.size:.3g}")
        tie = {"start": start, "start_stone": blocks.block_names[k], "ground": [start[0] + 5.0, start[1]], "stiffness": stiffness}
        deck["ties"] = [tie | draw(st.sampled_from(({}, {"prestress": float(f"{0.02 * GRAVITY * blocks.mass.sum():.3g}")})))]
    supports = {"supports": SOFT} if kind == "soft" else {}
    return {**deck, **supports, "joints": {"friction": friction}}


@relation("rocking", st.tuples(rocking_decks(), pulses(0.3, 1.0), number(0.03, 0.4, 20)), 1e-6, share=2.0)
def the_step_of_output_decides_nothing(deck: Deck, motion: Deck, step: float, within: float) -> None:
    """Another `output_step` changes no outcome, verdict, required friction or time at which a condition fails."""
    one, other = (ask(changed(deck, motion=motion), "rocking", end_time=4.0, output_step=k, hand_over=False) for k in (0.01, step))
    ok(one, other)
    a, b = one.results, other.results
    must(a.outcome == b.outcome and one.verdict.outcome == other.verdict.outcome, f"{a.outcome} and {b.outcome}")
    must(len(a.violated) == len(b.violated), f"{a.violated} and {b.violated}")
    must((a.required_friction is None) == (b.required_friction is None), f"{a.required_friction} and {b.required_friction}")
    near("friction", a.required_friction or 0.0, b.required_friction or 0.0, 1e-3)
    for name in ("slides_first", "leaves_first"):
        there = [c.model_dump(exclude_unset=True).get(name) for c in (a.conditions, b.conditions)]
        must((there[0] is None) == (there[1] is None), f"{name}: {there}")
        if there[0]:
            near(name, there[0]["time_s"], there[1]["time_s"], within, 1.0)
