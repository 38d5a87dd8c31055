"""Results that must add up: what tables, arrays, words and closed forms say of one answer, counted again."""

import itertools
import math
import re
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from asking import Deck, ask, must, near
from buildings import SOLIDS, changed, decks, number, pulses
from conservation import building
from fields import asymmetric, leaning
from hypothesis import reject
from hypothesis import strategies as st
from relations import EARTHQUAKES, GRAVITY, RIGID, ok, recorded, relation
from scipy.stats import binomtest

import extrados
from extrados.analyses.statistics import summaries
from extrados.decks.reader import read_text
from extrados.results.rocking import COLLAPSE, NO_HINGING, SLID

STARTED = {"rotation_ratio": 0.2}


@st.composite
def ensembles(draw: st.DrawFn) -> tuple[Deck, Deck]:
    """A building under a set of motions, scaled to levels or not."""
    deck = changed(draw(decks("block", "arch", "column")), motion={**draw(EARTHQUAKES), "mmi": 9})
    if draw(st.booleans()):
        deck["initial"] = {"rotation_ratio": draw(st.sampled_from([0.2, -0.3]))}
    keys: Deck = {
        "count": draw(st.integers(4, 7)),
        "bootstrap": 0,
        "bins": draw(st.integers(3, 8)),
        "confidence": draw(st.sampled_from([0.9, 0.95])),
    }
    if draw(st.booleans()):
        keys |= {
            "levels": draw(st.permutations([0.3, 0.9, 2.0])),
            "intensity": draw(st.sampled_from(["pga", "scale", "arias", "pga-ratio", "pgv-ratio"])),
        }
    return deck, keys


@relation("fragility", ensembles(), 1e-6)
def shares_counted_again(deck: Deck, keys: Deck, within: float) -> None:
    """Counts, shares, intervals, medians and bins of an ensemble are those of its rows; levels ascend and are reached."""
    answer = ask(deck, "fragility", **keys)
    ok(answer)
    r, rows = answer.results, {k: np.asarray(v) for k, v in answer.result.tables["ensemble"].columns.items()}
    levels = r.levels if "levels" in keys else [None]
    must(list(levels) == sorted(levels) if "levels" in keys else True, f"levels {levels}")
    must(len(rows["member"]) == keys["count"] * len(levels) and list(rows["member"]) == list(range(1, len(rows["member"]) + 1)), "members")
    start = deck.get("initial", {}).get("rotation_ratio", 0.0)
    near("start", r.initial_rotation_ratio, start, within, 1e-3)
    for k, level in enumerate(levels):
        at = np.ones(len(rows["member"]), bool) if level is None else rows["level"] == level
        here = {name: column[at] for name, column in rows.items()}
        got = {
            name: getattr(r, name) if level is None else getattr(r, name)[k]
            for name in (
                "count",
                "collapsed",
                "collapse_probability",
                "confidence_interval",
                "uplifted",
                "uplift_probability",
                "uplift_confidence_interval",
                "mean_peak_rotation_ratio",
                "deviation_peak_rotation_ratio",
                "median_peak_rotation_ratio",
                "median_pga_g",
            )
        }
        down = here["outcome"] == "collapse"
        ratio = np.where(down, 1.0, np.minimum(here["peak_ratio"], 1.0))
        rose = here["outcome"] != "no-hinging" if not start else here["peak_ratio"] > abs(start) * (1.0 + 1e-9)
        must((got["count"], got["collapsed"], got["uplifted"]) == (len(down), down.sum(), rose.sum()), f"{got} of {here['outcome']}")
        near("share", [got["collapse_probability"], got["uplift_probability"]], [down.mean(), rose.mean()], within)
        for name, hits in (("confidence_interval", down.sum()), ("uplift_confidence_interval", rose.sum())):
            ends = binomtest(int(hits), len(down)).proportion_ci(keys["confidence"], "wilson")
            near(name, got[name], [ends.low, ends.high], within, 1e-3)
        near("mean", got["mean_peak_rotation_ratio"], ratio.mean(), within, 1e-3)
        near("deviation", got["deviation_peak_rotation_ratio"], ratio.std(ddof=1), within, 1e-3)
        near("median", got["median_peak_rotation_ratio"], np.median(ratio), within, 1e-3)
        near("median peak acceleration", got["median_pga_g"], np.median(here["pga"]), within)
        if level is None:
            counts = np.histogram(np.minimum(here["peak_ratio"][~down], 1.0), np.linspace(0.0, 1.0, keys["bins"] + 1))[0]
            must(list(np.asarray(answer.result.arrays["bin_count"].data)) == list(counts), "bins")
            near("velocity", r.median_pgv_m_s, np.median(here["pgv"]), within)
            near("Arias", r.median_arias_m_s, np.median(here["arias"]), within)
            outcome = "stands" if not down.any() else "collapses" if down.all() else "open"
            must(
                answer.outcome == ("open" if r.conditions.violated and outcome != "open" else outcome),
                f"{answer.outcome}: {r.collapsed} of {r.count}",
            )
        else:
            unit = r.uplift_acceleration_g
            slow = 1.0 / _rate(deck)
            reached = {
                "pga": here["pga"],
                "scale": here["scale"],
                "arias": here["arias"],
                "pga-ratio": here["pga"] / unit,
                "pgv-ratio": here["pgv"] / (unit * GRAVITY * slow) if slow else None,
            }[keys["intensity"]]
            if reached is not None:
                near("level reached", reached, np.full(len(down), level), 1e-4 if keys["intensity"] != "pga-ratio" else 1e-3)
            for percent in (16, 50, 84):
                want = np.quantile(np.where(down, np.inf, here["peak_ratio"]), percent / 100.0, method="inverted_cdf")
                found = getattr(r, f"peak_rotation_ratio_{percent}")[k]
                must((found is None) == bool(np.isinf(want)), f"{percent} %: {found} of {want}")
                near(f"{percent} %", found or 0.0, want if np.isfinite(want) else 0.0, within, 1e-3)
    if "levels" in keys:
        fell = (rows["outcome"] == "collapse").reshape(keys["count"], -1)[:, np.argsort(rows["level"][: len(levels)])]
        must(r.motions_that_collapse == fell.any(axis=1).sum(), f"{r.motions_that_collapse} motions of {fell}")
        must(
            r.resurrections == sum(bool(row[row.argmax() :].size and not row[row.argmax() :].all()) for row in fell if row.any()),
            f"{r.resurrections} of {fell}",
        )


def _rate(deck: Deck) -> float:
    """p of a rectangular block [rad/s], infinite for others."""
    s = deck["structure"]
    return math.sqrt(0.75 * GRAVITY / (0.5 * math.hypot(s["width"], s["height"]))) if s["kind"] == "block" else math.inf


@relation(
    "",
    st.tuples(
        st.lists(st.lists(number(0.0, 1.0), max_size=12), min_size=1, max_size=4),
        st.integers(1, 6),
        st.integers(2, 5),
        st.integers(0, 30),
        st.integers(1, 30),
    ),
    1e-12,
)
def medians_of_pieces(pieces: list, few: int, bins: int, hits: int, more: int, within: float) -> None:
    """A median of many numbers in pieces is that of all, however few are sorted; score intervals are those of a textbook."""
    kept = summaries.FEW, summaries.BINS
    summaries.FEW, summaries.BINS = few, bins
    try:
        found = summaries.median(lambda: iter([np.array([*piece, np.nan]) for piece in pieces]))
    finally:
        summaries.FEW, summaries.BINS = kept
    whole = [x for piece in pieces for x in piece]
    must((found is None) == (not whole), f"{found} of {whole}")
    near("median", found or 0.0, np.median(whole) if whole else 0.0, within)
    ends = binomtest(hits, hits + more).proportion_ci(0.9, "wilson")
    near("interval", np.ravel(summaries.wilson(hits, hits + more, 0.9)), [ends.low, ends.high], 1e-9)
    outcome = np.array([COLLAPSE] * hits + [NO_HINGING] * more)
    half = len(outcome) // 2
    one = summaries.shares(outcome, np.linspace(0.0, 1.5, len(outcome)), 0.9, 0.0)
    two = summaries.shares_of(
        lambda: iter(
            [(outcome[:half], np.linspace(0.0, 1.5, len(outcome))[:half]), (outcome[half:], np.linspace(0.0, 1.5, len(outcome))[half:])]
        ),
        0.9,
        0.0,
    )
    for name, value in one.items():
        near(name, value, two[name], 1e-9)


@st.composite
def plans(draw: st.DrawFn) -> Deck:
    """Four walls of several storeys and thicknesses with a floor, an opening and a force."""
    a, b = draw(number(3.0, 6.0, 6)), draw(number(3.0, 6.0, 6))
    storeys = draw(st.lists(number(2.5, 3.5, 10), min_size=1, max_size=3))
    corners = [[0.0, 0.0], [a, 0.0], [a, b], [0.0, b]]
    walls: list[Deck] = []
    for k, name in enumerate(("south", "east", "north", "west")):
        walls.append({"name": name, "start": corners[k], "end": corners[(k + 1) % 4], "thickness": draw(number(0.25, 0.6, 7))})
    if draw(st.booleans()):
        walls[0]["openings"] = [{"storey": draw(st.integers(1, len(storeys))), "x": [0.8, 1.6], "z": [0.5, 2.0]}]
    deck: Deck = {"kind": "building", "storeys": storeys, "walls": walls}
    if draw(st.booleans()):
        kind = draw(st.sampled_from(["flexible", "rigid"]))
        deck["floors"] = [
            {
                "storey": draw(st.integers(1, len(storeys))),
                "kind": kind,
                "load": 3000.0,
                **({"young": 1e10, "thickness": 0.1} if kind == "flexible" else {}),
                **({"bears_on": ["south", "north"]} if draw(st.booleans()) else {}),
            }
        ]
    return {"structure": deck}


@relation("local-mechanism", plans(), 1e-6)
def walls_of_a_plan_by_hand(deck: Deck, within: float) -> None:
    """alpha_0 and d_0 of every wall above the foot of each storey are those of its weights about its edge, the least first."""
    s = deck["structure"]
    answer = ask(deck, "local-mechanism", mechanism="building", confidence_factor=1.0)
    ok(answer)
    levels = [0.0, *np.cumsum(s["storeys"])]
    want = {}
    for wall in s["walls"]:
        length, t = math.dist(wall["start"], wall["end"]), wall["thickness"]
        held = [f["storey"] for f in s.get("floors", []) if f["kind"] == "rigid"]
        for first in range(max([0, *held]), len(s["storeys"])):
            rows = []
            for k in range(first, len(s["storeys"])):
                low = levels[k] - levels[first]
                rows.append((1.0 * length * t * s["storeys"][k], low + 0.5 * s["storeys"][k]))
                for o in wall.get("openings", []):
                    if o["storey"] == k + 1:
                        rows.append((-t * (o["x"][1] - o["x"][0]) * (o["z"][1] - o["z"][0]), low + 0.5 * sum(o["z"])))
            loads = [(v * 2000.0 * GRAVITY, z) for v, z in rows]
            for floor in s.get("floors", []):
                bears = floor.get("bears_on") or [w["name"] for w in s["walls"]]
                if floor["storey"] > first and wall["name"] in bears:
                    around = sum(math.dist(w["start"], w["end"]) for w in s["walls"] if w["name"] in bears)
                    area = math.dist(s["walls"][0]["start"], s["walls"][0]["end"]) * math.dist(s["walls"][1]["start"], s["walls"][1]["end"])
                    loads.append((floor["load"] * area * length / around, levels[floor["storey"]] - levels[first]))
            want[wall["name"], first + 1] = (
                0.5 * t * sum(w for w, _ in loads) / sum(w * z for w, z in loads),
                levels[first],
                sum(w for w, _ in loads),
            )
    got = {(w.wall, w.storey): w for w in answer.results.walls}
    must(set(got) == set(want), f"walls {sorted(set(got) ^ set(want))}")
    for key, (alpha, foot, _) in want.items():
        near(f"alpha_0 of {key}", got[key].multiplier, alpha, within)
        near("foot", got[key].foot_m, foot, within, 1.0)
    order = [w.multiplier for w in answer.results.walls]
    if all(w.foot_m == 0.0 for w in answer.results.walls):
        must(order == sorted(order), f"walls in the order {order}")
    worst = answer.results.walls[0]
    near("the worst", answer.results.multiplier, worst.multiplier, within)
    near("its weight", answer.results.swaying_weight_N, want[worst.wall, worst.storey][2], within)
    near("its base", answer.results.base_height_m, worst.foot_m, within, 1.0)


@relation(
    "tilt local-mechanism rocking",
    st.tuples(
        decks("block", "column", "arch", "brickwork", friction=st.just("no-sliding")),
        st.sampled_from([0.05, -0.08]),
        st.sampled_from(["left", "right"]),
    ),
    1e-4,
)
def a_wall_beside_stops_one_side(deck: Deck, lean: float, side: str, within: float) -> None:
    """Beside a wall to the left a building collapses only to the right: codes and rocking use the multiplier of this side."""
    deck = leaning(deck, lean)
    limit = ask(deck, "tilt")
    ok(limit)
    right, left = limit.capacity
    beside = changed(deck, supports={"abutting_wall": side, "rebound": 0.5})
    free = {"left": right, "right": left}[side]
    codes = ask(beside, "local-mechanism", mechanism="building")
    if codes.answers:
        near("codes", codes.results.multiplier, free, within)
    rocks = ask(changed(beside, motion={"kind": "sine-pulse", "amplitude": f"{1.3 * free:.4g} g", "period": 0.4}), "rocking", end_time=1.0)
    if rocks.answers:
        near("rocking", rocks.results.uplift_acceleration_g, free, within)
        rotation = np.asarray(rocks.result.arrays["rotation"].data) * {"left": 1.0, "right": -1.0}[side]
        must(float(rotation.min()) >= -1e-12, f"a rotation of {rotation.min()} into the wall to the {side}")
        must(float(rotation.max()) > 0.0, "above its uplift acceleration it does not rock")
    bare = ask(deck, "local-mechanism", mechanism="building")
    if bare.answers:
        near("without a wall", bare.results.multiplier, min(right, left), within)


@relation("tilt thrust", st.tuples(asymmetric("tilt"), number(0.1, 0.5), number(0.6, 0.9), number(0.2, 0.8), st.booleans()), 1e-6)
def spread_loads_are_their_parts(question: tuple, low: float, high: float, share: float, sways: bool, within: float) -> None:
    """A load spread over a stretch is two over its parts, in proportion to their lengths; and one at a point its two halves there."""
    deck = changed(question[0], joints={"friction": "no-sliding"})
    deck.pop("ties", None)
    x = np.concatenate([np.array(b["points"])[:, 0] for b in deck["structure"]["block"]])
    ends = [round(float(x.min() + s * np.ptp(x)), 4) for s in (low, low + share * (high - low), high)]
    weight = float(building(deck).blocks().mass.sum()) * GRAVITY
    force = float(f"{0.2 * weight:.4g}")
    parts = [
        {
            "x": a,
            "x_end": b,
            "force": force * (b - a) / (ends[2] - ends[0]),
            "horizontal": 0.02 * force * (b - a) / (ends[2] - ends[0]),
            "sways": sways,
        }
        for a, b in itertools.pairwise(ends)
    ]
    whole = {"x": ends[0], "x_end": ends[2], "force": force, "horizontal": 0.02 * force, "sways": sways}
    one, two = ask(deck, "tilt", load=[whole]), ask(deck, "tilt", load=parts)
    ok(one, two)
    near("spread", one.capacity, two.capacity, 0.03, 0.1)  # its pieces act at their middles
    fine = ask(deck, "tilt", load=[{**p, "force": 0.5 * p["force"], "horizontal": 0.5 * p["horizontal"]} for p in parts for _ in range(2)])
    near("halves", two.capacity, fine.capacity, within, 1e-2)
    up = sum(row.vertical_N for row in one.results.reactions)
    near("reactions", up, weight + force, within)
    along = sum(row.horizontal_N for row in one.results.reactions)
    near("push", abs(along), abs(one.capacity[0] * (weight + (force if sways else 0.0)) + 0.02 * force), 1e-5, 1e-3 * weight)


TILT_KEYS = {"end_time": 1.0, "output_step": 0.02, "stop_at_collapse": False, "snapshot_times": [0.1], "find_friction": True, "slip": 1e-3}


@relation(
    "dem", st.tuples(decks("block", "column"), st.sets(st.sampled_from(sorted(TILT_KEYS)), max_size=2), st.booleans()), 0.0, share=0.5
)
def what_a_tilt_test_does_not_use_is_said(deck: Deck, keys: set, moving: bool, within: float) -> None:
    """Keys of a run under a motion are named by a tilt test, and those alone that the deck has."""
    if moving:
        deck = changed(deck, motion={"kind": "sine-pulse", "amplitude": "0.2 g", "period": 0.5})
    answer = ask(deck, "dem", test="tilt", tilt_accuracy=0.05, time_step=0.002, **RIGID, **{k: TILT_KEYS[k] for k in keys})
    ok(answer)
    for key in (*TILT_KEYS, "vtk", "vary_friction", "vary_damping", "[[initial.movements]]", "rotation_ratio"):
        said = bool(re.search(rf"(?<![\w.]){re.escape(key)}\b", answer.warnings)) if key[0] != "[" else key in answer.warnings
        must(said == (key in keys), f"{key}: {answer.warnings}")
    must(("[motion]" in answer.warnings) == moving, f"[motion]: {answer.warnings}")


@relation("rocking", st.tuples(decks("stack"), pulses(0.4, 1.2)), 1e-6)
def modes_of_a_stack(deck: Deck, motion: Deck, within: float) -> None:
    """Closed forms of two blocks on each other, and shares of modes, rotations and impacts as the history has them."""
    s = deck["structure"]
    answer = ask(changed(deck, motion=motion), "rocking", end_time=1.5, hand_over=False)  # histories of rigid contacts have other fields
    ok(answer)
    r, arrays = answer.results, {k: np.asarray(v.data) for k, v in answer.result.arrays.items()}
    b, h, u, v = s["lower_width"], s["lower_height"], s["upper_width"], s["upper_height"]
    level = (b * h * 0.5 * h + u * v * (h + 0.5 * v)) / (b * h + u * v)
    near("as one", r.stack.uplift_as_one_g, 0.5 * b / level, within)
    near("upper alone", r.stack.uplift_upper_g, u / v, within)
    near("uplift", r.uplift_acceleration_g, min(0.5 * b / level, u / v), within)
    near("critical", [r.critical_rotation_rad, r.stack.critical_rotation_upper_rad], [math.atan2(0.5 * b, level), math.atan2(u, v)], within)
    m = np.array([b * h, u * v])
    around = m @ [(b * b + h * h) / 12.0 + 0.25 * h * h, (u * u + v * v) / 12.0 + (h + 0.5 * v) ** 2] + 0.25 * b * b * m.sum()
    near("p", r.frequency_parameter_rad_s**2, m.sum() * GRAVITY * math.hypot(0.5 * b, level) / around, within)
    near("c_v", r.restitution, max(0.0, 1.0 - 2.0 * 0.25 * b * b * m.sum() / around), within)
    one, two = arrays["rotation"], arrays["rotation_upper"]
    near(
        "ratio",
        r.peak_rotation_ratio,
        max(np.abs(one).max() / r.critical_rotation_rad, np.abs(two - one).max() / r.stack.critical_rotation_upper_rad),
        1e-3,
        1e-3,
    )
    must(r.impacts == r.stack.impacts_on_ground + r.stack.impacts_between == len(r.impact_times_s), f"{r.impacts} impacts of {r.stack}")
    mode = arrays["mode"]
    names = answer.result.tables["rocking"].columns["mode"]
    if (mode != 0).any():
        for row in r.stack.modes:
            near(row.mode, row.share, float((np.asarray(names)[mode != 0] == row.mode).mean()), within)
        most = max(r.stack.modes, key=lambda row: row.share)
        must(f"{100.0 * most.share:.0f} % of the rocking time {most.mode}" in answer.result.answer, f"{most}: {answer.result.answer}")
        far = np.abs(one) > 1e-5
        same = np.abs(one - two) < 1e-9
        for k, name in enumerate(np.asarray(names)):
            if far[k]:
                must((name == "both as one") == bool(same[k]), f"{name} at {one[k]}, {two[k]}")
                if not same[k] and name != "upper alone":
                    must((name == "both in the same sense") == (one[k] * (two[k] - one[k]) > 0.0), f"{name} at {one[k]}, {two[k]}")
    near(
        "ledger",
        arrays["kinetic"] + arrays["potential"] - arrays["kinetic"][0] - arrays["potential"][0],
        arrays["ledger"],
        1e-4,
        float(np.abs(arrays["kinetic"]).max(initial=1.0)),
    )
    near(
        "supplied less lost",
        arrays["ledger"][-1] if len(arrays["ledger"]) else 0.0,
        r.energy_supplied_J - r.energy_lost_at_impacts_J,
        1e-3,
        1.0 + float(np.abs(arrays["kinetic"]).max(initial=1.0)),
    )


@relation("tilt", st.integers(1, 3), 0.0, share=0.5)
def names_of_joints_are_looked_for_where_they_stand(count: int, within: float) -> None:
    """The message on a wrong joint gives the table that names it."""
    lines = ["[structure]", "kind = 'column'", "width = 1.0", "height = 4.0", "drums = 3", "[[analysis]]", "kind = 'tilt'"]
    for name in ["base", "joint 1"][: count - 1]:
        lines += ["[[joints.types]]", "friction = 0.6", f"joints = ['{name}']"]
    lines += ["[[joints.types]]", "friction = 0.6", "joints = ['joint 99']"]
    (result,) = extrados.run(read_text("\n".join(lines).encode()), threads=1).results
    must(result.status == "refused" and f"deck.toml:{len(lines)}: " in result.reason and "'joint 99'" in result.reason, result.reason)


@relation("motion rocking", st.tuples(number(0.1, 0.5), number(0.5, 3.0), number(0.2, 2.0)), 1e-6, share=0.5)
def units_and_scales_of_records(amplitude: float, frequency: float, scale: float, within: float) -> None:
    """A record in other units, steps and scales, or with its time in the file, is the same motion."""
    time = np.arange(0.0, 2.0, 0.01)
    wave = amplitude * np.sin(2.0 * np.pi * frequency * time) * np.exp(-time)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        plain = recorded(folder, 0.01, wave)
        (folder / "bare.txt").write_text("\n".join(f"{v:.9g}" for v in wave * 981.0 * GRAVITY / 9.81) + "\n")
        ways: list[Any] = [
            {**plain, "scale": scale},
            {"kind": "record", "file": "bare.txt", "time_step": 0.01, "unit": "cm/s^2", "scale": scale},
        ]
        found = [
            ask({"structure": {"kind": "block", "width": 1.0, "height": 5.0}, "motion": m}, kind, folder)
            for m in ways
            for kind in ("motion", "rocking")
        ]
    ok(*found)
    near("PGA", found[0].results.pga_g, found[2].results.pga_g, within)
    near("PGA", found[0].results.pga_g, scale * np.abs(wave).max(), 1e-5)
    if found[1].results.decided_by_last_digits:
        reject()
    near("rotation", found[1].results.peak_rotation_ratio, found[3].results.peak_rotation_ratio, 1e-4, 1e-3)


@relation("tilt dem", decks("arch", "block", "dome", "wall"), 1e-9)
def tilts_are_those_of_their_accelerations(deck: Deck, within: float) -> None:
    """A ground tilted by atan(a/g) pushes as a horizontal acceleration a does, to both sides, in the plane, in space and by elements."""
    kind = deck["structure"]["kind"]
    found = [ask(deck, "tilt", **({"direction": 30.0, "rose": 4, "starts": 1} if kind in SOLIDS else {}))]
    if kind == "block":
        found.append(ask(deck, "dem", test="tilt", tilt_accuracy=0.05, time_step=0.004, **RIGID))
    ok(*found)
    for answer, sense in itertools.product(found, ("", "_opposite")):
        angle = getattr(answer.results, f"tilt_angle{sense}_deg")
        acceleration = getattr(answer.results, f"collapse_acceleration{sense}_g")
        near(f"tilt{sense}", angle, math.degrees(math.atan(acceleration)), within)


@relation("failure-domain", st.tuples(decks("block", "arch"), st.sampled_from(["step", "sine"]), number(0.3, 1.0)), 1e-9)
def curves_and_pockets_of_a_map(deck: Deck, pulse: str, period: float, within: float) -> None:
    """The curves of a failure domain lie at the first failing amplitude of its map, pockets are safe amplitudes above."""
    answer = ask(deck, "failure-domain", pulse=pulse, durations=[period, 2.0 * period], amplitudes=12, accuracy=1e-3)
    ok(answer)
    r, arrays = answer.results, {k: np.asarray(v.data) for k, v in answer.result.arrays.items()}
    pockets = 0
    for k, codes in enumerate(arrays["outcome"]):
        fails = (codes >= COLLAPSE) & (codes != SLID)
        least = r.mode_I.amplitudes_g[k]
        must((least is None) == (not fails.any()), f"{least}: {codes}")
        if least is not None:
            first = int(fails.argmax())
            step = arrays["amplitude"][1] - arrays["amplitude"][0]
            must(-step - 1e-9 <= least - arrays["amplitude"][first] <= 1e-9, f"{least} beside {arrays['amplitude'][first]}")
            safe = (~fails) & (arrays["amplitude"] > least)
            pockets += bool(safe.any())
            must((r.pocket_begins_g[k] is not None) == bool(safe.any()), f"pocket {r.pocket_begins_g[k]}: {codes}")
    must(r.safe_pockets == pockets, f"{r.safe_pockets} pockets of {pockets}")
