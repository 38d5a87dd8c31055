"""Failure domains by rule, and ensembles drawn and counted in another way."""

import math

import numpy as np
from asking import Deck, ask, must, near
from buildings import changed, decks, number
from hypothesis import strategies as st
from relations import GRAVITY, ok, relation


@relation(
    "failure-domain rocking",
    st.tuples(
        decks("block", "arch", "column", friction=number(0.3, 2.0)), st.sampled_from(["sine", "step"]), number(0.8, 1.6), st.booleans()
    ),
    0.0,
    share=1.0,
)
def curves_by_rules_and_at_amplitudes(deck: Deck, pulse: str, period: float, numbered: bool, within: float) -> None:
    """Of fixed hinges: curves by an impact rule are those of a deck with it; shortest durations fail and shorter ones do not; single runs agree."""
    if numbered:
        deck = changed(deck, joints={"restitution": 0.8})
    keys = {
        "pulse": pulse,
        "durations": [period, 1.7 * period],
        "amplitudes": 6,
        "accuracy": 1e-3,
        "at_amplitudes": ["1.2 g"],
        "hand_over_cells": 0,
    }
    answer = ask(deck, "failure-domain", **keys)
    ok(answer)
    r, a = answer.results, {k: np.asarray(v.data) for k, v in answer.result.arrays.items()}
    rules = r.amplitudes_by_rule or []
    for one in rules:
        other = ask(changed(deck, joints={"restitution": one.rule}), "failure-domain", **keys)
        ok(other)
        near(f"restitution by {one.rule}", one.restitution, other.results.restitution, 1e-9)
        for x, y in zip(one.amplitudes_g, other.results.mode_I.amplitudes_g, strict=True):
            must((x is None) == (y is None), f"{one.rule}: {x} against {y}")
            near(one.rule, x or 0.0, y or 0.0, 1e-9)  # the same cells are refined to the same accuracy
    if rules:
        must(len(rules) > 1 and len({x.restitution for x in rules}) > 1, f"rules {rules}")
        rows = np.array([[np.nan if x is None else x for x in one.amplitudes_g] for one in rules])
        all_ = rows[:, (~np.isnan(rows)).sum(axis=0) > 1]
        want = max((np.nanmax(col) / np.nanmin(col) for col in all_.T), default=None)
        must((r.rule_ratio is None) == (want is None), f"ratio {r.rule_ratio}")
        near("ratio", r.rule_ratio or 0.0, want or 0.0, 1e-9)
    near("amplitudes", a["amplitude"], np.linspace(0.0, 1.5, 7)[1:], 1e-9)
    shape = {"sine": ("sine-pulse", "period"), "step": ("step-pulse", "duration")}[pulse]

    def falls(amplitude: float, duration: float) -> bool | None:
        motion = {"kind": shape[0], "amplitude": f"-{amplitude!r} g", shape[1]: duration}
        one = ask(changed(deck, motion=motion), "rocking", hand_over=False)
        return None if not one.answers or one.results.decided_by_last_digits else one.results.outcome == "collapse"

    half = {}
    for k, duration in enumerate(keys["durations"]):
        for j, amplitude in enumerate(a["amplitude"][::2]):
            found = falls(float(amplitude), duration)
            must(found is None or found == (a["outcome"][k, 2 * j] >= 2), f"{amplitude} g for {duration} s: {a['outcome'][k, 2 * j]}")
        for name, code in (("mode_I", 2), ("mode_II", 3)):
            row = a["outcome"][k] >= 2 if code == 2 else a["outcome"][k] == 3
            least = getattr(r, name).amplitudes_g[k]
            must((least is None) == (not row.any()), f"{name}: {least} of {a['outcome'][k]}")
            half[name, k] = least
            near(name, a[name][k] if least is not None else 0.0, least or 0.0, 1e-12)
            if least is not None:
                step = a["amplitude"][1] - a["amplitude"][0]
                first = a["amplitude"][int(row.argmax())]
                must(first - step - 1e-9 <= least <= first + 1e-9, f"{name}: {least} beside {first}")
        for name, key in (("sliding_from_g", "slides"), ("hinges_elsewhere_from_g", "elsewhere")):
            value = getattr(r, name)[k]
            must(value is None or np.abs(a["amplitude"] - value).min() < 1e-9, f"{key} from {value}")
        unit = r.uplift_acceleration_g
        if getattr(r.mode_I, "amplitude_ratios", None) is not None and half["mode_I", k] is not None:
            near("over uplift", r.mode_I.amplitude_ratios[k], half["mode_I", k] / unit, 1e-9)
    if (told := r.at_amplitudes) is not None:
        tried = np.linspace(period, 1.7 * period, 200)
        shortest = told.mode_I_durations_s[0]
        some = falls(1.2, 1.7 * period)
        must(some is not True or shortest is not None, "a pulse fails, and no duration is told")
        if shortest is not None:
            must(falls(1.2, shortest) in (True, None), f"1.2 g for {shortest} s does not fail")
            before = shortest - 2.0 * 1e-3 - (tried[1] - tried[0])
            must(
                before < period or falls(1.2, before) in (False, None) or falls(1.2, before + (tried[1] - tried[0])) in (False, None),
                f"1.2 g for {before} s fails already",
            )
            if (second := told.mode_II_durations_s[0]) is not None:
                must(second >= shortest - 1e-9, f"{second} before {shortest}")


@relation("fragility rocking", st.tuples(decks("block", "arch", "column"), st.integers(1, 10**6), number(0.1, 0.3)), 1e-6, share=1.0)
def ensembles_in_other_ways(deck: Deck, seed: int, start: float, within: float) -> None:
    """Durations one by one, levels as scales, histories and starts are those of the single runs and ensembles."""
    motion = {"kind": "generated", "mmi": 9, "duration": 2.0, "seed": seed, "lines": 8}
    deck = changed(deck, motion=motion, initial={"rotation_ratio": start})
    whole = ask(deck, "fragility", count=4, bootstrap=0, durations=[1.0, 2.5])
    ok(whole)
    w, rows = whole.results, whole.result.tables["ensemble"].columns
    for k, duration in enumerate((1.0, 2.5)):
        alone = ask(changed(deck, motion={"duration": duration}), "fragility", count=4, bootstrap=0)
        ok(alone)
        for name in (
            "mean_peak_rotation_ratio",
            "deviation_peak_rotation_ratio",
            "collapse_probability",
            "uplift_probability",
            "confidence_interval",
            "count",
            "collapsed",
            "uplifted",
            "median_pga_g",
        ):
            near(name, getattr(w, name)[k], getattr(alone.results, name), within, 1e-6)
        for name in ("restitution", "critical_rotation_rad", "initial_rotation_ratio", "confidence"):
            near(name, getattr(w, name), getattr(alone.results, name), within)
        at = rows["duration"] == duration
        must(list(rows["motion"][at]) == [1, 2, 3, 4], f"motions {rows['motion']}")
        near("peaks", rows["peak_ratio"][at], alone.result.tables["ensemble"].columns["peak_ratio"], within, 1e-6)
        table = whole.result.tables["durations"].columns
        near("ends", [table["lower"][k], table["upper"][k]], w.confidence_interval[k], within, 1e-6)
    near("durations", w.durations_s, [1.0, 2.5], 0.0)
    shares = w.collapse_probability
    must(
        whole.outcome in ({"stands", "open"} if max(shares) == 0.0 else {"collapses", "open"} if min(shares) == 1.0 else {"open"}),
        f"{whole.outcome} of {shares}",
    )
    drawn_ = ask(deck, "fragility", count=3, bootstrap=0, histories=2)
    ok(drawn_)
    arrays = {k: np.asarray(v.data) for k, v in drawn_.result.arrays.items()}
    peaks = drawn_.result.tables["ensemble"].columns
    for k in (1, 2):
        alone = ask(changed(deck, motion={"member": k}), "rocking")
        ok(alone)
        history = arrays[f"history_rotation_{k}"]
        near("start of the history", history[0], start, 1e-6)
        if alone.results.decided_by_last_digits:
            continue
        own = np.asarray(alone.result.arrays["rotation"].data) / drawn_.results.critical_rotation_rad
        time = np.asarray(alone.result.arrays["time"].data)
        there = arrays[f"history_time_{k}"]
        until = min(time[-1], there[-1])
        inner = there[there <= until]
        near(f"history {k}", history[: len(inner)], np.interp(inner, time, own), 0.03, float(np.abs(own).max()))
        near(f"motion {k}", np.abs(arrays[f"history_motion_{k}"]).max(), peaks["pga"][k - 1], 1e-3)
        must(
            abs(np.abs(history).max() - min(peaks["peak_ratio"][k - 1], np.abs(history).max())) < 1e-6 + 0.02 * np.abs(history).max(),
            f"peak of history {k}",
        )
    block = deck["structure"]["kind"] == "block"
    unit = drawn_.results.uplift_acceleration_g
    for measure, base in (("pga-ratio", "pga"), ("pgv-ratio", "pgv")):
        scaled_ = ask(deck, "fragility", count=3, bootstrap=0, levels=[0.7, 1.6], intensity=measure)
        ok(scaled_)
        columns = scaled_.result.tables["ensemble"].columns
        want = unit if base == "pga" else None
        if base == "pgv" and block:
            s = deck["structure"]
            want = unit * GRAVITY / math.sqrt(0.75 * GRAVITY / (0.5 * math.hypot(s["width"], s["height"])))
        if want is not None:
            near(measure, columns[base] / want, columns["level"], 1e-3)
        same_ = ask(deck, "fragility", count=3, bootstrap=0, levels=[float(x) for x in columns["scale"][:2]], intensity="scale")
        ok(same_)
        near("as scales", same_.result.tables["ensemble"].columns["peak_ratio"][:2], columns["peak_ratio"][:2], 1e-3, 1e-2)
