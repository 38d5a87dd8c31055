"""Mechanisms and checks of codes computed again by hand."""

import math
from typing import Any

import numpy as np
from asking import Answer, Deck, ask, must, near
from buildings import number
from hypothesis import strategies as st
from relations import GRAVITY, ok, relation

UNIT = 2000.0 * GRAVITY


#: Height of a storey where their number is not given [m]
STOREY = 3.0


@st.composite
def bodies_of_codes(draw: st.DrawFn) -> tuple[Deck, Deck]:
    """A deck and a table of a local mechanism of one body, with anything that loads or holds it."""
    kind = draw(st.sampled_from(["facade", "facade", "corner", "gable", "parapet", "wall", "tower"]))
    height, hinge = draw(number(2.5, 8.0, 11)), draw(st.sampled_from([0.0, 0.5]))
    table: Deck = {"mechanism": kind, "height": height, "thickness": draw(number(0.4, 1.0, 6)), "hinge_height": hinge}
    if kind == "corner":
        table["crack_angle"] = draw(number(20.0, 40.0, 4))
    if kind == "gable" or draw(st.booleans()):
        table["width"] = draw(number(0.8, 3.0, 11))
    level = number(0.3, height, 10)
    floor = st.fixed_dictionaries(
        {"height": level, "load": number(0.0, 2e4, 4)},
        optional={"pushing": number(1e3, 1e4, 3), "arm": number(0.1, 0.6, 5), "sways": st.just(False), "thrust": number(50.0, 500.0, 3)},
    )
    table["floors"] = draw(st.lists(floor, max_size=2))
    table["ties"] = draw(st.lists(st.fixed_dictionaries({"height": level, "force": number(100.0, 2000.0, 5)}), max_size=2))
    sides = draw(st.sampled_from(["none", "wedges", "teeth"]))
    if sides == "wedges" and kind != "corner":
        table["side_walls"] = {
            "thickness": draw(number(0.2, 0.6, 4)),
            "crack_angle": draw(number(10.0, 30.0, 4)),
            "count": draw(st.integers(1, 3)),
        }
    if sides == "teeth" and kind == "facade":
        table["interlocking"] = {
            "unit_height": draw(number(0.1, 0.4, 6)),
            "overlap": draw(number(0.05, 0.2, 3)),
            "thickness": 0.3,
            "count": draw(st.integers(1, 3)),
        }
    table["confidence_factor"], table["behaviour_factor"] = (
        draw(st.sampled_from([1.0, 1.2, 1.35])),
        draw(st.sampled_from([1.0, 2.0, 3.0])),
    )
    if draw(st.booleans()):
        table["spectrum"] = {"code": "NTC", "acceleration": f"{draw(number(0.05, 0.4, 7)):g} g"}
        if draw(st.booleans()):
            table["collapse_spectrum"] = {"code": "NTC", "acceleration": f"{draw(number(0.1, 0.5, 4)):g} g"}
    if draw(st.booleans()):
        table["peak_acceleration"] = f"{draw(number(0.05, 0.3, 5)):g} g"
    if draw(st.booleans()):
        table |= {
            "base_height": draw(number(2.0, 6.0, 4)),
            "building_height": draw(number(8.0, 12.0, 4)),
            "storeys": draw(st.integers(1, 4)),
        }
        if draw(st.booleans()):
            table["building_period"] = draw(number(0.1, 0.6, 5))
    deck: Deck = {"structure": {"kind": "block", "width": 1.0, "height": 4.0}}
    if draw(st.booleans()):
        deck["material"] = {"compressive_strength": draw(number(5e5, 3e6, 5))}
    return deck, table


def code_spectrum(peak: float, period: float, damping: float) -> float:
    """Elastic spectrum of NTC 2018 on ground A [m/s^2], F_0 2.5, T_C* 0.35 s, of a peak acceleration [m/s^2]."""
    eta, tc, td = max(math.sqrt(10.0 / (5.0 + 100.0 * damping)), 0.55), 0.35, 4.0 * peak / GRAVITY + 1.6
    if period < tc / 3.0:
        return peak * eta * 2.5 * (3.0 * period / tc + (1.0 - 3.0 * period / tc) / (2.5 * eta))
    return peak * eta * 2.5 * min(1.0, tc / period, tc * td / period**2)


def floor_spectrum(a_z: float, first: float, ground: float, period: float, damping: float) -> float:
    """S_eZ of Circolare 7/2019 [C7.2.6] [m/s^2] of a building of 5 % and period T_1, above T_1 no less than that of the ground."""
    eta = max(math.sqrt(10.0 / (5.0 + 100.0 * damping)), 0.55)
    most = eta * 1.1 / math.sqrt(0.05)
    if period < 0.8 * first:
        return most * a_z / (1.0 + (most - 1.0) * (1.0 - period / (0.8 * first)) ** 1.6)
    if period >= 1.1 * first:
        return max(most * a_z / (1.0 + (most - 1.0) * (period / (1.1 * first) - 1.0) ** 1.2), code_spectrum(ground, period, damping))
    return most * a_z if period <= first else max(most * a_z, code_spectrum(ground, period, damping))


def weights_of_body(table: Deck, strength: float | None) -> tuple[np.ndarray, np.ndarray] | None:
    """Rows weight [N], arm, height [m], sways, rests; and rows force [N], height [m] of what pushes (above 0) or holds; None: crushed."""
    t, h0 = table["thickness"], table["hinge_height"]
    h, kind = table["height"] - h0, table["mechanism"]
    width = table.get("width", t if kind == "tower" else 1.0)
    middle = 0.5 * t
    if kind == "corner":
        reach = h * math.tan(math.radians(table["crack_angle"]))
        middle = (reach / 3.0 + 0.5 * t) / math.sqrt(2.0)
        rows = [(UNIT * t * h * reach, middle, 2.0 * h / 3.0, 1, 1)]
    elif kind == "gable":
        rows = [(UNIT * t * width * h / 2.0, middle, h / 3.0, 1, 1)]
    else:
        rows = [(UNIT * t * width * h, middle, h / 2.0, 1, 1)]
    pushes = [(-tie["force"], tie["height"] - h0) for tie in table["ties"] if tie["height"] > h0]
    for floor in table["floors"]:
        z, arm = floor["height"] - h0, floor.get("arm", middle)
        if z >= 0.0:
            rows += [(floor["load"], arm, z, int(floor.get("sways", True)), 1), (floor.get("pushing", 0.0), arm, z, 1, 0)]
            pushes.append((floor.get("thrust", 0.0), z))
    if "interlocking" in table:
        teeth = table["interlocking"]
        n = math.floor(h / teeth["unit_height"] + 1e-9)
        each = [0.8 * k * teeth["unit_height"] * teeth["overlap"] * teeth["thickness"] * UNIT * 0.577 for k in range(1, n + 1)]
        pushes += [
            (-teeth["count"] * f, h - k * teeth["unit_height"]) for k, f in enumerate(each, start=1)
        ]  # course by course, at its foot
    if "side_walls" in table:
        side = table["side_walls"]
        reach = h * math.tan(math.radians(side["crack_angle"]))
        rows.append((side["count"] * UNIT * side["thickness"] * 0.5 * h * reach, t + reach / 3.0, 2.0 * h / 3.0, 1, 1))
    found = np.array([row for row in rows if row[0] > 0.0])
    if strength is not None and kind != "corner":
        pressing = float(found[:, 0] @ found[:, 4])
        if pressing > 0.75 * strength * width * t * (1.0 - 1e-9):
            return None
        found[:, 1] -= 2.0 * pressing / (3.0 * strength * width)
    return found, np.array([p for p in pushes if p[0]]).reshape(-1, 2)


@relation("local-mechanism", bodies_of_codes(), 1e-6, share=4.0)
def bodies_of_codes_by_hand(deck: Deck, table: Deck, within: float) -> None:
    """A facade, corner, gable, parapet, wall or tower has the multiplier, M*, e*, curve and checks of its weights and forces by hand."""
    strength = deck.get("material", {}).get("compressive_strength")
    answer = ask(deck, "local-mechanism", **table)
    by_hand = weights_of_body(table, strength)
    if by_hand is None:
        must(answer.status == "refused" or answer.outcome == "cannot-stand", f"crushed, but {answer.outcome}")
        return
    (w, arm, z, sways, rests), (force, level) = by_hand[0].T, by_hand[1].T
    back, high, sway = float(w @ (rests * arm)), float(w @ (rests * z)), float(w @ (sways * z))
    held, driving = float(force @ level), float(np.maximum(force, 0.0) @ level)
    alpha, alone = (back - held) / sway, (back - driving) / sway
    if alpha <= 0.0:
        must(answer.outcome == "cannot-stand", f"alpha {alpha}, but {answer.outcome}")
        return
    ok(answer)
    r, fc = answer.results, table["confidence_factor"]
    weight, second = float(w @ sways), float(w @ (sways * z * z))
    part = sway**2 / (weight * second)
    a0 = alpha * GRAVITY / (part * fc)
    near("alpha_0", r.multiplier, alpha, within)
    near("e*", r.participating_part, part, within)
    near("M*", r.participating_mass_kg, part * weight / GRAVITY, within)
    near("weight", r.swaying_weight_N, weight, within)
    near("a_0*", r.activation_acceleration_g, a0 / GRAVITY, within)

    def spectral(q: np.ndarray | float) -> Any:
        return (np.sin(q) + back / high * (1.0 - np.cos(q))) * second / sway

    arrays = {k: np.asarray(v.data) for k, v in answer.result.arrays.items()}
    q = np.linspace(0.0, math.atan2(back - held, high), len(arrays["displacement"]))
    swayed = np.array([w @ (sways * (z * np.cos(a) + arm * np.sin(a))) for a in q])
    near("curve", arrays["acceleration"], ((back - held) * np.cos(q) - high * np.sin(q)) / swayed / part / fc, 1e-5, alpha) if len(
        q
    ) > 1 else None
    near("d* of the curve", arrays["displacement"], spectral(q), 1e-5, 1e-3)
    d0 = float(spectral(math.atan2(back - driving, high))) if alone > 0.0 else None
    must((r.zero_displacement_m is None) == (d0 is None), f"d_0 {r.zero_displacement_m} of {d0}")
    peak = float(table["spectrum"]["acceleration"].split()[0]) * GRAVITY if "spectrum" in table else None
    ag = float(table["peak_acceleration"].split()[0]) * GRAVITY if "peak_acceleration" in table else peak
    raised = table.get("base_height", table["hinge_height"])
    near("z", r.base_height_m, raised, within, 1.0)
    top = (table.get("building_height") or table["height"]) if raised else None
    felt, first, a_z = (None if raised else ag), 0.0, 0.0
    if raised and peak is not None:
        first = table.get("building_period") or 0.05 * top**0.75
        n = table.get("storeys", max(1, math.ceil(top / STOREY - 1e-9)))
        a_z = code_spectrum(peak, first, 0.05) * raised / top * 3.0 * n / (2.0 * n + 1.0) * math.sqrt(1.0 + 4e-4 * 25.0)
        felt = max(a_z, ag)
        near("a_Z", r.floor_acceleration_g, a_z / GRAVITY, within)

    def displaced(accelerations: tuple[float, float], period: float, damping: float) -> float:
        times = [*(period * np.arange(1, 61) / 60.0), *([1.1 * first] if raised and 1.1 * first < period else [])]
        ground, above = accelerations
        return max(
            (floor_spectrum(above, first, ground, t, damping) if raised else code_spectrum(ground, t, damping)) * (t / (2.0 * math.pi)) ** 2
            for t in times
        )

    want: dict[str, tuple[float | None, float | None]] = {}
    where = "at height z" if raised else "at the ground"
    if table["mechanism"] in ("parapet", "gable"):
        felt = None  # free to vibrate: its demand is that at its own period, which these decks do not give
    if d0 is not None:
        near("d_0*", r.zero_displacement_m, d0, 1e-6)
        near("d_SLV, d_SLC", [r.ultimate_displacement_m, r.collapse_displacement_m], [0.4 * d0, 0.6 * d0], within)
        falling = alone * GRAVITY / (part * fc)
        period = 1.68 * math.pi * math.sqrt(0.4 * d0 / (0.6 * falling))
        near("T_SLV", r.equivalent_period_s, period, within)
        asked = displaced((peak, a_z), period, 0.08) if peak is not None else None
        want["NTC nonlinear"] = 0.4 * d0, asked
        if asked is not None:
            want[f"NTC activation ({where})"] = a0 / GRAVITY, felt / GRAVITY if felt is not None else None
        if "collapse_spectrum" in table and not raised:
            strong = float(table["collapse_spectrum"]["acceleration"].split()[0]) * GRAVITY
            slow = 1.56 * math.pi * math.sqrt(0.6 * d0 / (0.4 * falling))
            want["NTC nonlinear at SLC"] = 0.6 * d0, displaced((strong, 0.0), slow, 0.10)
    want[f"NTC linear ({where})"] = (table["behaviour_factor"] * a0 / GRAVITY, felt / GRAVITY if felt is not None else None)
    for name, (capacity, demand) in want.items():
        check = r.checks[name]
        near(f"{name}: capacity", check.capacity, capacity, 1e-5)
        must((check.demand is None) == (demand is None), f"{name}: demand {check.demand} of {demand}")
        if demand is not None:
            near(f"{name}: demand", check.demand, demand, 1e-5)
            must(
                check.verdict in ("not-applicable", "holds" if capacity >= demand else "fails"),
                f"{name}: {check.verdict}: {capacity}, {demand}",
            )
    decided_by_alternatives(answer)


def decided_by_alternatives(answer: Answer) -> None:
    """The verdict of checks: each code asks one of its alternatives to hold, the least margin of the codes decides."""
    groups: dict[tuple, list] = {}
    for name, check in answer.results.checks.items():
        if check.code and check.verdict != "not-applicable":
            groups.setdefault((check.code, check.alternative or name), []).append(check)
    margins = []
    for checks in groups.values():
        known = [c.capacity / c.demand for c in checks if c.demand and c.capacity is not None]
        if known and (max(known) >= 1.0 or len(known) == len(checks)):
            margins.append(max(known))
    if not margins:
        must(answer.outcome == "open" or answer.outcome == "not-applicable", f"without a demand {answer.outcome}")
        return
    must(answer.outcome in (("stands", "open") if min(margins) >= 1.0 else ("collapses", "open")), f"{answer.outcome} of margins {margins}")
    if not answer.verdict.violated and answer.verdict.bound is None:
        must(answer.outcome != "open", f"open of margins {margins}: {answer.verdict}")
    near("margin", answer.verdict.capacity / answer.verdict.demand, min(margins), 1e-9)
    known_margins = [row[0] for row in answer.results.governing()]
    near("governing", known_margins, sorted(margins), 1e-9)
