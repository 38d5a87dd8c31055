"""Whole results computed again from their documented definitions: mechanisms of codes, runs of elements, moving supports and loads."""

import csv
import itertools
import json
import math
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import tomlkit
from asking import Answer, Deck, ask, must, near
from buildings import changed, decks, drawn, number, pulses
from conservation import building
from elements import in_space
from hypothesis import reject
from hypothesis import strategies as st
from relations import GRAVITY, RIGID, ok, relation

from extrados import kinds
from extrados.analyses.left_out import left_out
from extrados.decks.reader import DeckError, make_deck
from extrados.running import survey

UNIT = 2000.0 * GRAVITY


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
    )  # fmt: skip
    table["floors"] = draw(st.lists(floor, max_size=2))
    table["ties"] = draw(
        st.lists(st.fixed_dictionaries({"height": level, "force": number(100.0, 2000.0, 5)}), max_size=2)
    )
    sides = draw(st.sampled_from(["none", "wedges", "teeth"]))
    if sides == "wedges" and kind != "corner":
        table["side_walls"] = {
            "thickness": draw(number(0.2, 0.6, 4)),
            "crack_angle": draw(number(10.0, 30.0, 4)),
            "count": draw(st.integers(1, 3)),
        }
    if sides == "teeth" and kind == "facade":
        table["interlocking"] = {
            "unit_height": draw(number(0.1, 0.4, 6)), "overlap": draw(number(0.05, 0.2, 3)), "thickness": 0.3, "count": draw(st.integers(1, 3)),
        }  # fmt: skip
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
        return max(
            most * a_z / (1.0 + (most - 1.0) * (period / (1.1 * first) - 1.0) ** 1.2),
            code_spectrum(ground, period, damping),
        )
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
            rows += [
                (floor["load"], arm, z, int(floor.get("sways", True)), 1),
                (floor.get("pushing", 0.0), arm, z, 1, 0),
            ]
            pushes.append((floor.get("thrust", 0.0), z))
    if "interlocking" in table:
        teeth = table["interlocking"]
        n = math.floor(h / teeth["unit_height"] + 1e-9)
        each = [
            0.8 * k * teeth["unit_height"] * teeth["overlap"] * teeth["thickness"] * UNIT * 0.577
            for k in range(1, n + 1)
        ]
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
    near("curve", arrays["acceleration"], ((back - held) * np.cos(q) - high * np.sin(q)) / swayed / part / fc, 1e-5, alpha) if len(q) > 1 else None  # fmt: skip
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
        n = table.get("storeys", 1)
        a_z = code_spectrum(peak, first, 0.05) * raised / top * 3.0 * n / (2.0 * n + 1.0) * math.sqrt(1.0 + 4e-4 * 25.0)
        felt = max(a_z, ag)
        near("a_Z", r.floor_acceleration_g, a_z / GRAVITY, within)

    def displaced(accelerations: tuple[float, float], period: float, damping: float) -> float:
        times = [*(period * np.arange(1, 61) / 60.0), *([1.1 * first] if raised and 1.1 * first < period else [])]
        ground, above = accelerations
        return max((floor_spectrum(above, first, ground, t, damping) if raised else code_spectrum(ground, t, damping)) * (t / (2.0 * math.pi)) ** 2 for t in times)  # fmt: skip

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
    want[f"NTC linear ({where})"] = (
        table["behaviour_factor"] * a0 / GRAVITY,
        felt / GRAVITY if felt is not None else None,
    )
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
    must(
        answer.outcome in (("stands", "open") if min(margins) >= 1.0 else ("collapses", "open")),
        f"{answer.outcome} of margins {margins}",
    )
    if not answer.verdict.violated and answer.verdict.bound is None:
        must(answer.outcome != "open", f"open of margins {margins}: {answer.verdict}")
    near("margin", answer.verdict.capacity / answer.verdict.demand, min(margins), 1e-9)
    known_margins = [row[0] for row in answer.results.governing()]
    near("governing", known_margins, sorted(margins), 1e-9)


# ----- discrete elements, from their histories

RUNS = st.tuples(
    decks("block", "column", "brickwork", friction=number(0.15, 0.8, 13)),
    pulses(0.1, 1.2),
    st.booleans(),
    number(0.02, 0.6, 20),
)


@relation("dem", RUNS, 1e-6, share=1.0)
def runs_of_elements_by_hand(deck: Deck, motion: Deck, rigid: bool, limit: float, within: float) -> None:
    """Openings, slips, hinges, peaks, energies, losses, outcome and criterion of a run are those of its places and rates."""
    keys = {"end_time": 0.8, "output_step": 0.01, "collapse_displacement": limit, "floor": 0.0}
    how: Deck = {"time_step": 1e-3, **RIGID} if rigid else {}
    deck = changed(deck, joints={} if rigid else {"normal_stiffness": 2e8})
    answer = ask(changed(deck, motion=motion), "dem", **keys, **how)
    ok(answer)
    r, a = answer.results, {k: np.asarray(v.data) for k, v in answer.result.arrays.items()}
    place, names = a["place"], list(a["block_name"])
    step = 0.002 if len(names) == 1 else 0.01  # impacts of a single block need a fine history
    if len(a["time"]) > 10:
        near("output step", np.diff(a["time"][:-1]).mean(), step, 0.1)
    shift = place - place[0]
    rotation = -shift[..., 2]
    near("rotation", a["rotation"], rotation, within, 1e-3)
    away, turn, drop = np.hypot(shift[..., 0], shift[..., 1]), np.abs(shift[..., 2]), -shift[..., 1]
    peak = max(away.max(), limit) if r.stopped == "collapse" else away.max()
    near("peak displacement", r.peak_displacement_m, peak, within, 1e-3)
    near("limit", r.collapse_displacement_m, limit, within)
    must(bool(r.stopped_by) == (r.stopped in ("collapse", "left")), f"{r.stopped}, stopped by {r.stopped_by}")
    must(len(set(r.stopped_by)) == len(r.stopped_by), f"stopped by {r.stopped_by}")
    for name in r.stopped_by:
        must(
            away[-1, names.index(name)] > 0.5 * limit, f"stopped by {name}, which moved {away[-1, names.index(name)]} m"
        )
    for name, most in r.peak_rotation_rad.items():
        near(f"peak rotation of {name}", most, rotation[np.abs(rotation[:, names.index(name)]).argmax(), names.index(name)], within, 1e-3)  # fmt: skip
    most = np.abs(rotation).max(axis=0)
    must(
        set(r.peak_rotation_rad) >= {names[i] for i in np.argsort(-most)[:1] if most[i] > 1e-6},
        f"{sorted(r.peak_rotation_rad)} of {names}",
    )
    # joints
    p, q, blocks = a["joint_p"], a["joint_q"], a["joint_block"]
    length = np.hypot(*(q - p).T)
    tangent = (q - p) / length[:, None]
    normal = np.column_stack([-tangent[:, 1], tangent[:, 0]])
    into = [a["centroid"][i] - p[j] if i >= 0 else p[j] - a["centroid"][k] for j, (i, k) in enumerate(blocks)]
    normal *= np.sign((normal * into).sum(axis=1))[:, None]
    state = np.zeros((len(place), len(p)), int)
    slip = np.zeros(state.shape)
    for j, (i, k) in enumerate(blocks):
        ends, turned = [], []
        for body in (i, k):
            if body < 0:
                ground = np.array([p[j], q[j]])
                ends.append(np.broadcast_to(ground, (len(place), 2, 2)))
                turned.append(np.zeros(len(place)))
                continue
            angle = shift[:, body, 2]
            spin = np.stack([np.cos(angle) + 0 * angle, np.sin(angle)], axis=1)
            arm = np.array([p[j], q[j]]) - place[0, body, :2]
            moved = np.stack(
                [
                    spin[:, :1] * arm[:, 0] - spin[:, 1:] * arm[:, 1],
                    spin[:, 1:] * arm[:, 0] + spin[:, :1] * arm[:, 1],
                ],
                axis=2,
            )
            ends.append(place[:, body, None, :2] + moved)
            turned.append(angle)
        mean = 0.5 * (turned[0] + turned[1])
        c, s = np.cos(mean)[:, None], np.sin(mean)[:, None]
        n, t = (np.concatenate([c * v[0] - s * v[1], s * v[0] + c * v[1]], axis=1) for v in (normal[j], tangent[j]))
        apart = ends[0] - ends[1]
        gap, along = (apart * n[:, None]).sum(axis=2), (apart * t[:, None]).sum(axis=2)
        near(f"openings of joint {j}", [a["opening_p"][:, j], a["opening_q"][:, j]], gap.T, 1e-5, 0.1)
        slip[:, j] = np.where(gap[:, 0] < gap[:, 1], along[:, 0], along[:, 1])
        near(f"slip of joint {j}", np.abs(a["slip"][:, j]), np.abs(slip[:, j]), 1e-4, 1e-2)
        wide = np.array([a["opening_p"][:, j], a["opening_q"][:, j]]) > 5e-4 * length[j]
        off = (min(i, k) >= 0) & (np.abs(a["slip"][:, j]) > length[j])
        state[:, j] = np.where(wide.all(axis=0) | off, 2, np.where(wide[0], 1, np.where(wide[1], -1, 0)))
    must(
        bool((a["hinge"] == state).all()), f"hinges {np.argwhere(a['hinge'] != state)[:3].tolist()} are told otherwise"
    )
    touching = np.where(a["hinge"] == 2, 0.0, np.abs(a["slip"]))
    near("slip", r.peak_slip_m, touching.max(), within, 1e-6)
    near("slip left", r.residual_slip_m, touching[-1].max(), within, 1e-6)
    ratio = touching.max(axis=0) / length
    near("slip ratio", r.slip_ratio, ratio.max(), within, 1e-6)
    joints = list(a["joint_name"])
    must(
        r.slipped_joint == (joints[int(ratio.argmax())] if ratio.max() > 0.01 else None),
        f"{r.slipped_joint}: {ratio}",
    )
    # energies
    masses, inertia = _masses(a, building(deck).blocks().depth)
    rate = a["rate"]
    kinetic = 0.5 * (rate[..., :2] ** 2).sum(axis=2) @ masses + 0.5 * rate[..., 2] ** 2 @ inertia
    near("kinetic energy", a["kinetic_energy"], kinetic, 0.03, float(kinetic.max()) + 1e-3)
    rise = shift[..., 1] @ masses * GRAVITY
    near(
        "potential energy",
        a["potential_energy"] - a["potential_energy"][0],
        rise,
        1e-6,
        float(np.abs(rise).max()) + 1e-2,
    )
    near("greatest kinetic energy", r.peak_kinetic_energy_J, a["kinetic_energy"].max(), within)
    near(
        "losses",
        [r.friction_loss_J, r.damping_loss_J],
        [a["friction_energy"][-1], a["damping_energy"][-1]],
        within,
        1e-6,
    )
    columns = answer.result.tables["dem"].columns
    for name, values in columns.items():
        if name.endswith("_energy"):
            near(name, values, a[name], within, 1e-6)
    sums = (
        a["work_energy"]
        - (a["kinetic_energy"] + a["potential_energy"] + a["elastic_energy"])
        - a["friction_energy"]
        - a["damping_energy"]
        - a["mass_damping_energy"]
    )
    went = np.abs(a["work_energy"]).max() + a["kinetic_energy"].max() + 10.0
    near("ledger", np.abs(sums - sums[0]), np.abs(a["residual_energy"] - a["residual_energy"][0]), 0.01, went)
    # how it ends
    size = float(np.ptp(a["outline"], axis=0).max())
    gone = (away > limit) & ((turn > 0.5 * limit / size) | (drop > 0.25 * limit))
    if gone.any() or r.stopped in ("collapse", "left"):
        must(r.outcome == "collapse" and r.collapse_criterion is not None, f"{r.outcome}, but a block has collapsed")
        when = float(a["time"][gone.any(axis=1).argmax()]) if gone.any() else r.stop_time_s
        near("time of collapse", r.collapse_time_s, when, within)
        if gone.any():
            at = int(gone.any(axis=1).argmax())
            block = int(gone[at].argmax())
            must(r.governing_block == names[block], f"{r.governing_block} of {names[block]}")
            by = (
                "rotation"
                if turn[at, block] / (0.5 * limit / size) >= drop[at, block] / (0.25 * limit)
                else "loss of height"
            )
            must(r.collapse_criterion == by, f"{r.collapse_criterion} of {by}")
    else:
        want = "rocked" if (a["hinge"] != 0).any() else "slid" if r.slip_ratio > 0.01 else "at-rest"
        must(
            r.outcome == want and r.collapse_criterion is None and r.collapse_time_s is None,
            f"{r.outcome}, not {want}",
        )
        must(
            r.governing_block == names[int(away.max(axis=0).argmax())],
            f"{r.governing_block} of {away.max(axis=0)}",
        )
        if r.stopped == "end":
            noise = 1e-6 * masses.sum() * GRAVITY * size
            last, all_ = a["kinetic_energy"][-1], a["kinetic_energy"].max()
            must(r.still_moving == bool(last > max(1e-3 * all_, noise)), f"still moving: {r.still_moving}")
    changes = [(t, j) for j in range(len(p)) for t in range(1, len(place)) if a["hinge"][t, j] != a["hinge"][t - 1, j]]
    told = answer.result.tables["dem_hinges"].columns
    must(
        len(told["time"]) in (len(changes), len(changes) + len(p)),
        f"{len(told['time'])} changes of hinges, {len(changes)}",
    )
    if len(names) == 1 and r.restitution_housner is not None:
        s = deck["structure"]
        near(
            "Housner",
            r.restitution_housner,
            max(
                0.0,
                1.0 - 1.5 * s["width"] ** 2 / (s["width"] ** 2 + s["height"] ** 2),
            ),
            1e-6,
        )


def _masses(a: dict[str, np.ndarray], depth: float) -> tuple[np.ndarray, np.ndarray]:
    """Masses [kg] and inertias [kg m^2] of the outlines, of density 2000 kg/m^3 and a depth, by triangles about their middles."""
    found = []
    for start, stop in itertools.pairwise(a["outline_start"].astype(int)):
        points = a["outline"][start:stop]
        centre = points.mean(axis=0)
        mass, first, second = 0.0, np.zeros(2), 0.0
        for one, two in zip(points - centre, np.roll(points, -1, axis=0) - centre, strict=True):
            piece = 0.5 * (one[0] * two[1] - one[1] * two[0]) * 2000.0 * depth
            mass, first = mass + piece, first + piece * (one + two) / 3.0
            second += piece * (one @ one + two @ two + one @ two) / 6.0
        found.append((abs(mass), abs(second) - (first @ first) / abs(mass)))
    return np.array(found).T[0], np.array(found).T[1]


@relation("dem", RUNS, 1e-6, share=1.0)
def runs_of_solids_by_hand(deck: Deck, motion: Deck, rigid: bool, limit: float, within: float) -> None:
    """The same of blocks in space: peaks, slips, openings, energies and the outcome are those of its histories."""
    keys = {"end_time": 0.6, "output_step": 0.01, "collapse_displacement": limit, "floor": 0.0}
    how: Deck = {"time_step": 1e-3, **RIGID} if rigid else {}
    deck = changed(deck, joints={} if rigid else {"normal_stiffness": 2e8})
    if deck["structure"]["kind"] == "brickwork":
        reject()
    answer = in_space(changed(deck, motion=motion), "dem", **keys, **how)
    ok(answer)
    r, a = answer.results, {k: np.asarray(v.data) for k, v in answer.result.arrays.items()}
    names = list(a["block_name"])
    shift = a["pose"][..., :3] - a["pose"][0, :, :3]
    away = np.linalg.norm(shift, axis=2)
    near("shift", a["shift"], shift, within, 1e-3)
    peak = max(away.max(), limit) if r.stopped == "collapse" else away.max()
    near("peak displacement", r.peak_displacement_m, peak, within, 1e-3)
    must(bool(r.stopped_by) == (r.stopped in ("collapse", "left")), f"{r.stopped}, stopped by {r.stopped_by}")
    must(len(set(r.stopped_by)) == len(r.stopped_by), f"stopped by {r.stopped_by}")
    for name in r.stopped_by:
        must(
            away[-1, names.index(name)] > 0.5 * limit, f"stopped by {name}, which moved {away[-1, names.index(name)]} m"
        )
    near("last displacement", r.final_displacement_m, away[-1].max(), within, 1e-3)
    turned = np.linalg.norm(a["turn"], axis=2)
    for name, most in r.peak_rotation_rad.items():
        near(f"peak rotation of {name}", most, turned[:, names.index(name)].max(), 1e-5, 1e-3)
    touching = a["state"] != 2
    near("opening", r.peak_opening_m, np.where(touching, a["opening"], 0.0).max(), within, 1e-6)
    slips = np.where(touching, np.abs(a["slip"]), 0.0)
    near("slip", [r.peak_slip_m, r.residual_slip_m], [slips.max(), slips[-1].max()], within, 1e-6)
    masses = np.array(
        [m for m in _solid_masses(a)],
    )
    rate = a["rate"]
    kinetic = 0.5 * (rate[..., :3] ** 2).sum(axis=2) @ masses
    must(
        bool((a["kinetic_energy"] >= kinetic * 0.97 - 0.03 * kinetic.max() - 1e-3).all()),
        "less kinetic energy than that of the centroids",
    )
    rise = shift[..., 2] @ masses * GRAVITY
    near("potential energy", a["potential_energy"] - a["potential_energy"][0], rise, 1e-5, np.abs(rise).max() + 1e-2)
    near("greatest kinetic energy", r.peak_kinetic_energy_J, a["kinetic_energy"].max(), within)
    near("losses", [r.friction_loss_J, r.damping_loss_J], [a["friction_energy"][-1], a["damping_energy"][-1]], within, 1e-6)  # fmt: skip
    must((r.blocks, r.contacts) == (len(names), a["state"].shape[1]), f"{r.blocks} stones, {r.contacts} contacts")
    size = float(np.ptp(a["solid_vertex"], axis=0).max())
    gone = (away > limit) & ((turned > 0.5 * limit / size) | (-shift[..., 2] > 0.25 * limit))
    if gone.any() or r.stopped in ("collapse", "left"):
        must(r.outcome == "collapse", f"{r.outcome}, but a block has collapsed")
    else:
        want = "rocked" if (a["state"] != 0).any() else "slid" if r.slip_ratio > 0.01 else "at-rest"
        must(r.outcome == want, f"{r.outcome}, not {want}")
        must(r.governing_block == names[int(away.max(axis=0).argmax())], f"{r.governing_block}")


def _solid_masses(a: dict[str, np.ndarray]) -> list[float]:
    """Masses of the solids by their faces, density 2000 kg/m^3 [kg]."""
    found = np.zeros(len(a["block_name"]))
    for k, (start, stop) in enumerate(itertools.pairwise(a["solid_face_start"].astype(int))):
        face = a["solid_vertex"][a["solid_face"][start:stop].astype(int)]
        for one, two in itertools.pairwise(face[1:]):
            found[int(a["solid_face_block"][k])] += 2000.0 * np.linalg.det([face[0], one, two]) / 6.0
    return found.tolist()


# ----- statics


@relation("supports", st.tuples(decks("arch", "pointed-arch", "elliptical-arch"), number(-1.0, 1.0, 8), number(-1.0, 1.0, 8)), 1e-3, share=2.0)  # fmt: skip
def work_of_moving_supports(deck: Deck, spread: float, settle: float, within: float) -> None:
    """The potential energy of an arch changes by the work of its force on the right support; stages and numbers are those of the history."""
    if abs(spread) + abs(settle) < 0.2:
        reject()
    answer = ask(deck, "supports", spread=spread, settle=settle, steps=60)
    ok(answer)
    r, a = answer.results, {k: np.asarray(v.data) for k, v in answer.result.arrays.items()}
    way = np.array([spread, -settle]) / math.hypot(spread, settle)
    movement, force, energy = a["movement"], a["force"], a["energy"]
    work, fine = -0.5 * (force[1:] + force[:-1]) @ way * np.diff(movement), np.diff(movement) < 1.5 * movement[1]
    fine &= (a["hinge"][1:] == a["hinge"][:-1]).all(axis=1)  # hinges of another stage are closed at once
    fine[-1] = False
    near("work", np.diff(energy)[fine], work[fine], 0.03, float(np.abs(work).max()))
    p = np.array([a["joint_p"][0], a["joint_p"][-1]])
    span = float(np.hypot(*(p[1] - p[0])))
    near(
        "movement at the fall",
        [r.movement_at_fall_m, r.movement_at_fall_over_span, r.span_change_at_fall_ratio],
        [movement[-1], movement[-1] / span, movement[-1] * way[0] / span],
        1e-9,
        1e-6,
    )
    near("thrust", [r.thrust_at_rest_N, r.thrust_at_fall_N], force[[0, -1], 0], 1e-9)
    hinge = a["hinge"].astype(int)
    must([h.joint for h in r.hinges_at_rest] == hinge[0].tolist(), f"{r.hinges_at_rest}")
    must([h.joint for h in r.hinges_at_fall] == hinge[-1].tolist(), f"{r.hinges_at_fall}")
    told = answer.result.tables["supports"].columns["hinges"]
    changes = [k for k in range(1, len(told)) if told[k] != told[k - 1]]
    near("stages", [s.movement_m for s in r.stages], [0.0, *movement[changes]], 1e-9, 1e-6)
    must(f"after {len(changes)} change" in answer.result.answer, answer.result.answer)
    limits = ask(deck, "thrust")
    ok(limits)
    if settle == 0.0:
        extreme = limits.results.least if spread > 0.0 else limits.results.most
        near("thrust at rest", r.thrust_at_rest_N, extreme.horizontal_N, 1e-4)
    shown = a["shown_movement"]
    near("shown", shown, [movement[np.abs(movement - s * movement[-1]).argmin()] for s in (0.0, 0.25, 0.5, 0.75, 1.0)], 1e-9, 1e-6)  # fmt: skip
    ends = a["shown_point"][-1]
    joint = np.array([a["joint_p"], a["joint_q"]])
    at = [np.clip((ends[k] - base) @ _unit(joint[:, k]), 0.0, None) for k, base in ((0, joint[0, 0]),)]
    must(at[0] <= np.hypot(*(joint[1, 0] - joint[0, 0])) * (1.0 + 1e-6), "a thrust line that leaves the left support")
    last = joint[:, -1] + movement[-1] * way
    line = last[1] - last[0]
    off = (ends[-1] - last[0]) @ np.array([-line[1], line[0]]) / np.hypot(*line)
    near("thrust line on the moved support", off, 0.0, 0.0, 1.0) if abs(off) > 1e-3 * span else None


def _unit(ends: np.ndarray) -> np.ndarray:
    return (ends[1] - ends[0]) / np.hypot(*(ends[1] - ends[0]))


@relation("supports", st.tuples(decks("frame", "vault", "arch"), number(0.2, 1.0, 8), number(0.0, 0.6, 6), st.sampled_from([0.001, 0.003])), 1e-6)  # fmt: skip
def right_support_spelled_out(deck: Deck, spread: float, settle: float, movement: float, within: float) -> None:
    """The right support of a structure that moves is the movement of its rightmost joints on the ground, spelled out."""
    plain = drawn(deck)
    blocks = ask(plain, "tilt")
    ok(blocks)
    a = {k: np.asarray(v.data) for k, v in blocks.result.arrays.items()}
    ground = np.flatnonzero((a["joint_block"] < 0).any(axis=1))
    ends = np.sort(np.array([a["joint_p"][ground, 0], a["joint_q"][ground, 0]]), axis=0)
    last = ground[(ends[1] >= ends[1].max() - 1e-9) | (ends[0] >= ends[0][ends[1].argmax()] - 1e-3)]
    far = math.hypot(spread, settle)
    one = ask(plain, "supports", spread=spread, settle=settle, movement=movement)
    if one.answers and one.results.openings is None:
        reject()  # an arch is followed to its fall
    rows = [
        {"joint": str(a["joint_name"][j]), "dx": movement * spread / far, "dy": -movement * settle / far} for j in last
    ]
    other = ask(changed(plain, initial={"movements": rows}), "supports")
    must(one.outcome == other.outcome, f"{one.outcome} ({one.said}) against {other.outcome} ({other.said})")
    ok(one, other)
    near("work", one.results.work_J, other.results.work_J, within, 1e-3)
    p, q = ({o.name: o for o in x.results.openings} for x in (one, other))
    must(set(p) == set(q), f"{sorted(set(p) ^ set(q))}")
    b = {k: np.asarray(v.data) for k, v in one.result.arrays.items()}
    for name, row in p.items():
        near(
            name,
            [row.opening_mm, row.slip_mm],
            [q[name].opening_mm, q[name].slip_mm],
            within,
            1e3 * movement,
        )
        first, second, slip = b["settled_opening"][row.joint]
        near(name, [row.opening_mm, row.slip_mm], [1e3 * max(first, second), 1e3 * slip], within, 1e3 * movement)
        must(
            row.side in (("extrados", "second end") if second > first else ("intrados", "first end")),
            f"{name}: {row.side} of {first}, {second}",
        )
    down = sum(r.vertical_N for r in one.results.reactions)
    near("reactions", [down, sum(r.horizontal_N for r in one.results.reactions)], [blocks.results.weight_N, 0.0], 1e-6, blocks.results.weight_N)  # fmt: skip
    near("work of the weight", one.results.work_J, -_fallen(b, plain), 1e-5, 1e-3 * blocks.results.weight_N * movement)


def _fallen(a: dict[str, np.ndarray], deck: Deck) -> float:
    """Weights times rises of the blocks of a small motion [J]."""
    masses, _ = _masses(a, deck["structure"]["depth"])
    return float((a["settled_pose"][:, 1] - a["centroid"][:, 1]) @ masses * GRAVITY)


@st.composite
def trains(draw: st.DrawFn) -> tuple[Deck, Deck]:
    """An arch and a moving load of given axles with partial factors."""
    deck = draw(decks("arch", "pointed-arch", "elliptical-arch"))
    deck["structure"]["depth"] = draw(number(1.0, 3.0, 4))
    axles = [0.0, *draw(st.lists(number(0.1, 0.6, 5), max_size=1))]
    table: Deck = {"axles": axles, "both_ways": draw(st.booleans())}
    how = draw(st.sampled_from(["shares", "loads", "force"]))
    if how == "shares":
        table["shares"] = [1.0, 2.0][: len(axles)]
    if how == "force":
        table["force"] = draw(number(1e3, 5e4, 5))
    if how == "loads":
        table["axle_loads"] = [1e4, 2.5e4][: len(axles)]
        if draw(st.booleans()):
            table["width"] = round(deck["structure"]["depth"] * draw(number(0.4, 1.0, 6)), 4)
    table["factors"] = draw(st.sampled_from([{}, {"live": 1.3, "dynamic": 1.2, "masonry": 1.1}]))
    return deck, table


@relation("moving-load tilt", st.tuples(trains(), st.lists(number(0.15, 0.85, 14), min_size=2, max_size=3, unique=True)), 1e-4, share=2.0)  # fmt: skip
def a_moving_load_stands_still(question: tuple, shares: list, within: float) -> None:
    """At each place the structure stands under a little less than the collapse load laid there at rest, and not under a little more."""
    deck, table = question
    x = np.concatenate([np.array(b["points"]) for b in drawn(deck)["structure"]["block"]])[:, 0]
    places = [round(float(x.min() + s * np.ptp(x)), 4) for s in shares]
    answer = ask(deck, "moving-load", places=places, **table)
    ok(answer)
    r, a = answer.results, {k: np.asarray(v.data) for k, v in answer.result.arrays.items()}
    capacity, factors, depth = a["capacity"], table["factors"], deck["structure"]["depth"]
    ways = np.repeat([1.0, -1.0][: 2 if table["both_ways"] else 1], len(places))
    near("places", a["place"], np.tile(places, len(ways) // len(places)), 1e-9, 1.0)
    near("ways", a["way"], ways, 0.0)
    live = factors.get("live", 1.0) * factors.get("dynamic", 1.0)
    loads = np.array(table.get("axle_loads", table.get("shares", np.ones(len(table["axles"])))), dtype=float)
    strip = depth / table.get("width", depth)
    heavier = changed(deck, material={"density": 2000.0 * factors.get("masonry", 1.0)})
    k = int(np.nanargmin(a["adequacy"] if "adequacy" in a else capacity))
    axles = places[k % len(places)] - ways[k] * np.array(table["axles"])
    near("axles", a["axle"], axles, 1e-9, 1.0)
    near("worst place", r.worst_place_m, a["place"][k], 1e-9, 1.0)
    must(r.worst_way == ("+x" if ways[k] > 0 else "-x"), f"{r.worst_way} of {ways[k]}")
    ends = a["joint_q"][[0, -1], 0]
    near("over the span", r.worst_place_over_span, (a["place"][k] - ends.min()) / np.ptp(ends), 1e-6, 1.0)
    near("collapse load", r.collapse_load_N, capacity[k], 1e-9)
    near("per metre", r.collapse_load_kN_per_m, capacity[k] / depth / 1e3, 1e-9)
    on = (axles >= ends.min()) & (axles <= ends.max())
    if "axle_loads" in table:
        near("adequacy", r.adequacy_factor, a["adequacy"][k], 1e-9)
        near("live", r.live_load_factor, live, 1e-9)
        near(
            "on the structure",
            r.collapse_load_N,
            r.adequacy_factor * live * loads[on].sum(),
            1e-6,
        )
        laid = r.adequacy_factor * live * strip * loads
    else:
        laid = r.collapse_load_N * loads / (loads if "force" in table else loads[on]).sum()
        if "force" in table:
            near("safety", r.safety_factor, r.collapse_load_N / table["force"], 1e-9)
    must(
        getattr(r, "characteristic", None) == (not factors),
        f"characteristic: {getattr(r, 'characteristic', None)}, factors {factors}",
    )
    for share, stands in ((1.0 - 1e-4, True), (1.0 + 1e-4, False)):
        rows = [
            {"x": float(place), "force": float(share * f), "sways": False}
            for place, f, there in zip(axles, laid, on, strict=True)
            if there
        ]
        still = ask(heavier, "tilt", load=rows)
        must(
            (still.outcome != "cannot-stand") == stands,
            f"{share} of the collapse load {laid} at {axles}: {still.outcome} {still.said}",
        )


SPACES = decks("wall", "dome", "cross-vault", friction=number(0.2, 0.9, 7))


@relation("tilt", st.tuples(SPACES, number(0.0, 360.0, 24)), 1e-6)
def mechanisms_of_solids_by_hand(deck: Deck, angle: float, within: float) -> None:
    """Rates, openings, slips, forces and counts of the mechanism of solids are those of its velocities and corner forces."""
    both = [ask(deck, "tilt", direction=d) for d in (angle, (angle + 180.0) % 360.0)]
    ok(*both)
    both.append(ask(deck, "tilt", direction=both[0].results.least_direction_deg % 360.0))
    ok(*both)
    one, back = (x.results for x in both[:2])
    near("both ways", [one.collapse_acceleration_g, one.collapse_acceleration_opposite_g], [back.collapse_acceleration_opposite_g, back.collapse_acceleration_g], 1e-5)  # fmt: skip
    near("angles", [one.tilt_angle_deg, one.tilt_angle_opposite_deg], [math.degrees(math.atan(g)) for g in (one.collapse_acceleration_g, one.collapse_acceleration_opposite_g)], within)  # fmt: skip
    dilating = []
    for answer, direction in zip(both, (angle, (angle + 180.0) % 360.0, one.least_direction_deg % 360.0), strict=True):
        r, a = answer.results, {k: np.asarray(v.data) for k, v in answer.result.arrays.items()}
        names, of = list(a["block_name"]), a["contact_of"].astype(int)
        blocks = [(names.index(x) if x in names else -1, y) for x, y in ((n, 0) for n in names)]
        masses = np.array(_solid_masses(a))
        if deck["structure"]["kind"] == "wall":
            near("weight", r.weight_N, masses.sum() * GRAVITY, within)
        velocity, centre = a["velocity"], a["solid_centroid"]
        owner = np.zeros(len(a["solid_vertex"]), int)
        for k, (start, stop) in enumerate(itertools.pairwise(a["solid_face_start"].astype(int))):
            owner[a["solid_face"][start:stop].astype(int)] = int(a["solid_face_block"][k])
        rate = velocity[owner, :3] + np.cross(velocity[owner, 3:], a["solid_vertex"] - centre[owner])
        speed = np.linalg.norm(rate, axis=1)
        size = float(np.ptp(a["solid_vertex"], axis=0).max())
        near("pose", a["mechanism_pose"], velocity * 0.08 * size / speed.max(), 1e-6, size * 1e-3)
        share = np.array([speed[owner == i].max() for i in range(len(names))]) / speed.max()
        must(
            r.moving_blocks == int((share > 1e-3).sum()) and r.blocks == len(names),
            f"{r.moving_blocks} moving blocks: {share}",
        )
        own = np.linalg.norm(velocity[:, :3], axis=1)
        must(own[names.index(r.fastest_block)] >= own.max() * (1.0 - 1e-9), f"{r.fastest_block} is not the fastest")
        a_, b_ = _pairs(deck)
        must(r.contacts == len(a_) and len(blocks) == len(names), f"{r.contacts} contacts of {len(a_)}")
        at = a["contact_point"]

        def of_block(
            which: np.ndarray, at: np.ndarray = at, velocity: np.ndarray = velocity, centre: np.ndarray = centre
        ) -> np.ndarray:
            moved = velocity[which, :3] + np.cross(velocity[which, 3:], at - centre[which])
            return np.where((which >= 0)[:, None], moved, 0.0)

        apart = (of_block(a_[of]) - of_block(b_[of])) / speed.max()
        opening = (apart * a["contact_normal"][of]).sum(axis=1)
        sliding = np.linalg.norm(apart - opening[:, None] * a["contact_normal"][of], axis=1)
        most = np.zeros((2, len(a_)))
        for k in range(len(a_)):
            most[:, k] = max(opening[of == k].max(), 0.0), sliding[of == k].max()
        told = {c.joint: c for c in r.opening_contacts}
        moving = np.flatnonzero(most.max(axis=0) > 1e-6 * (1.0 + 1e-3))
        must(
            len(told) == min(20, len(moving)) or abs(len(told) - len(moving)) <= 1,
            f"{len(told)} of {len(moving)} contacts",
        )
        for j, c in told.items():
            near(f"contact {j}", [c.opening, c.sliding], most[:, j], 1e-5, 1e-3)
            near(f"contact {j}", [c.x_m, c.y_m, c.z_m], at[of == j].mean(axis=0), 1e-6, size)
        if told and len(told) < len(moving):
            least = min(most[:, j].max() for j in told)
            must(least >= max(most[:, j].max() for j in moving if j not in told) - 1e-9, "a faster contact is not told")
        mu = deck["joints"]["friction"]
        slides = (sliding > 1e-6) & (opening <= mu * sliding + 1e-6)
        dilating.append(len(set(of[slides].tolist())))
        # forces
        force = np.zeros((len(a_), 3))
        along = np.array([math.cos(math.radians(direction)), math.sin(math.radians(direction)), 0.0])
        for k in range(len(a_)):
            n = a["contact_normal"][k]
            here = a["collapse_force"][of == k]
            must(bool((here[:, 0] >= -1e-6 * r.weight_N).all()), "tension at a corner")
            near("normal force", a["contact_force"][k] @ n, here[:, 0].sum(), 1e-6, 1e-3 * r.weight_N)
            shear = np.linalg.norm(a["contact_force"][k] - (a["contact_force"][k] @ n) * n)
            near("shear", shear, np.hypot(*here[:, 1:].sum(axis=0)), 1e-5, 1e-3 * r.weight_N)
            total = here[:, 0].sum()
            if total > 1e-3 * r.weight_N:
                near("centre", a["contact_centre"][k], here[:, 0] @ at[of == k] / total, 1e-6, size)
            force[k] = a["contact_force"][k]
        left = np.zeros((len(names), 3))
        for k in range(len(a_)):
            if a_[k] >= 0:
                left[a_[k]] += force[k]
            if b_[k] >= 0:
                left[b_[k]] -= force[k]
        if deck["structure"]["kind"] == "wall":
            weight = masses[:, None] * GRAVITY * (np.array([0.0, 0.0, -1.0]) + r.collapse_acceleration_g * along)
            near("equilibrium of each stone", left, -weight, 1e-4, r.weight_N * 0.1)
        near("least of the rose", r.least_acceleration_g, a["rose_capacity"].min(), 1e-6)
        near(
            "its direction",
            a["rose_capacity"][np.abs(a["rose_direction"] - r.least_direction_deg).argmin()],
            r.least_acceleration_g,
            1e-5,
        )
        near(
            "rose",
            np.diff(a["rose_direction"]),
            np.full(len(a["rose_direction"]) - 1, 360.0 / len(a["rose_direction"])),
            1e-9,
        )
        near(
            "first of the rose",
            [a["rose_direction"][0], a["rose_capacity"][0]],
            [direction, r.collapse_acceleration_g],
            1e-5,
            1.0,
        )
    must(one.dilating_contacts == max(dilating), f"{one.dilating_contacts} contacts of {dilating} dilate")


def _pairs(deck: Deck) -> tuple[np.ndarray, np.ndarray]:
    """Blocks on both sides of the contacts of solids."""
    solids = building(deck).solids()
    return np.asarray(solids.a), np.asarray(solids.b)


@relation("failure-domain rocking", st.tuples(decks("block", "arch", "column", friction=number(0.3, 2.0)), st.sampled_from(["sine", "step"]), number(0.8, 1.6), st.booleans()), 0.0, share=1.0)  # fmt: skip
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
            near(one.rule, x or 0.0, y or 0.0, 0.0, 0.0) if x is None else near(one.rule, x, y, 5e-3)
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
            must(
                found is None or found == (a["outcome"][k, 2 * j] >= 2),
                f"{amplitude} g for {duration} s: {a['outcome'][k, 2 * j]}",
            )
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
            must(before < period or falls(1.2, before) in (False, None) or falls(1.2, before + (tried[1] - tried[0])) in (False, None), f"1.2 g for {before} s fails already")  # fmt: skip
            if (second := told.mode_II_durations_s[0]) is not None:
                must(second >= shortest - 1e-9, f"{second} before {shortest}")


@relation(
    "fragility rocking",
    st.tuples(decks("block", "arch", "column"), st.integers(1, 10**6), number(0.1, 0.3)),
    1e-6,
    share=1.0,
)
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
        for name in ("mean_peak_rotation_ratio", "deviation_peak_rotation_ratio", "collapse_probability", "uplift_probability", "confidence_interval",
                     "count", "collapsed", "uplifted", "median_pga_g"):  # fmt: skip
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
        whole.outcome
        in ({"stands", "open"} if max(shares) == 0.0 else {"collapses", "open"} if min(shares) == 1.0 else {"open"}),
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
            abs(np.abs(history).max() - min(peaks["peak_ratio"][k - 1], np.abs(history).max()))
            < 1e-6 + 0.02 * np.abs(history).max(),
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
        same_ = ask(
            deck, "fragility", count=3, bootstrap=0, levels=[float(x) for x in columns["scale"][:2]], intensity="scale"
        )
        ok(same_)
        near(
            "as scales",
            same_.result.tables["ensemble"].columns["peak_ratio"][:2],
            columns["peak_ratio"][:2],
            1e-3,
            1e-2,
        )


# ----- every key of a table

BLOCK: Deck = {"structure": {"kind": "block", "width": 0.6, "height": 3.0}, "joints": {"friction": 0.8}}
ARCH: Deck = {
    "structure": {"kind": "arch", "radius": 4.0, "thickness": 0.7, "embrace": 150.0, "voussoirs": 8},
    "joints": {"friction": 0.8},
}
DRUMS: Deck = {"structure": {"kind": "column", "width": 0.6, "height": 2.4, "drums": 3}, "joints": {"friction": 0.5}}
FRAMED: Deck = {"structure": {"kind": "frame", "columns": 2, "width": 0.5, "height": 2.0, "spacing": 2.0, "lintel_height": 0.5}, "joints": {"friction": 0.8}}  # fmt: skip
CORNER: Deck = {"structure": {"kind": "wall", "unit_length": 0.6, "unit_height": 0.3, "thickness": 0.3, "height": 0.6, "legs": [{"length": 1.2}]}, "joints": {"friction": 0.5}}  # fmt: skip
PULSE: Deck = {"kind": "sine-pulse", "amplitude": "0.45 g", "period": 0.7}
SET: Deck = {"kind": "generated", "mmi": 9, "duration": 2.0, "seed": 3, "lines": 8}
SHAKEN: Deck = {"end_time": 0.6, "time_step": 1e-3, "solver": "nonsmooth"}
RUN_KEYS: Deck = {"time_step": 2e-3, "floor": 0.0, "quasi_static": True, "test": "tilt", "end_time": 0.4, "output_step": 0.02, "collapse_displacement": 0.05,
                  "perturbed": False, "track": ["drum 1"], "snapshot_times": [0.1], "merge": "three-bars"}  # fmt: skip
#: Analyses with keys that each change something of their answers
EFFECTS: tuple[tuple[Deck, str, Deck, Deck], ...] = (
    ({**BLOCK, "motion": PULSE}, "rocking", {"end_time": 2.0}, {"form": "linear", "end_time": 1.0, "output_step": 0.02, "tolerance": 1e-5}),
    ({**ARCH, "motion": {**PULSE, "amplitude": "0.8 g"}}, "rocking", {"end_time": 1.0}, {"end_time": 0.6, "output_step": 0.02, "tolerance": 1e-5, "thrust_line_times": [0.2]}),
    (ARCH, "tilt", {}, {"friction_rule": "non-associated", "load": [{"x": 0.5, "force": 1e3}], "direction": 0.0}),
    (CORNER, "tilt", {"direction": 10.0}, {"direction": 50.0, "rose": 8, "pyramids": 8}),
    (ARCH, "thrust", {}, {"gamma": 0.05, "load": [{"x": 0.5, "force": 1e3}]}),
    (ARCH, "moving-load", {"count": 9, "axle_loads": [1e4, 2e4], "axles": [0.0, 0.5]}, {
        "alpha": 1.3, "width": 0.5, "both_ways": True, "count": 7, "places": [0.3, 0.9], "axle_loads": [2e4, 1e4], "axles": [0.0, 0.8], "load": [{"x": 0.5, "force": 1e3}],
        **{f"factors {k}": {k: 1.3} for k in ("masonry", "live", "dynamic", "friction")}, "uniform": [{"load": 5e3}]}),
    (ARCH, "moving-load", {"count": 9, "axles": [0.0, 0.5]}, {"force": 1e4, "shares": [1.0, 3.0]}),
    (ARCH, "supports", {"steps": 20, "settle": 0.3}, {"spread": 0.5, "settle": -0.3, "steps": 30}),
    (FRAMED, "supports", {"settle": 0.3}, {"spread": 0.5, "settle": -0.3, "movement": 0.01}),
    (ARCH, "failure-domain", {"durations": [0.5, 1.0], "amplitudes": 5, "accuracy": 1e-3}, {
        "pulse": "sine", "amplitudes": 7, "durations": [0.6, 1.1], "max_amplitude": "1.2 g", "at_amplitudes": ["1.3 g"], "accuracy": 0.02}),
    ({**BLOCK, "motion": SET}, "fragility", {"count": 5, "bootstrap": 0}, {
        "form": "linear", "count": 6, "seed": 9, "cloud": True, "histories": 2, "confidence": 0.8, "bins": 9, "tolerance": 1e-4, "durations": [1.0, 2.0],
        "levels": [0.3, 1.0], "uncertain": {"width": 0.1}}),
    ({**BLOCK, "motion": SET}, "fragility", {"count": 6, "bootstrap": 50, "levels": [0.2, 0.5, 1.2]}, {
        "intensity": "arias", "confidence": 0.8, "settle": 0.1, "levels": [0.2, 0.6, 1.2], "seed": 9, "tolerance": 1e-4}),
    (BLOCK, "local-mechanism", {"mechanism": "facade", "height": 5.0, "thickness": 0.5, "spectrum": {"code": "NTC", "acceleration": "0.1 g"}, "base_height": 3.0, "building_height": 9.0}, {
        "behaviour_factor": 3.0, "confidence_factor": 1.0, "base_height": 4.0, "building_height": 8.0, "building_period": 0.5, "storeys": 3, "peak_acceleration": "0.3 g",
        "collapse_spectrum": {"code": "NTC", "acceleration": "0.2 g"}, "one_second_acceleration": "0.2 g", "mechanism": "parapet"}),
    (ARCH, "local-mechanism", {"mechanism": "building", "spectrum": {"code": "NTC", "acceleration": "0.1 g"}}, {
        "behaviour_factor": 3.0, "confidence_factor": 1.0, "base_height": 4.0, "peak_acceleration": "0.3 g", "collapse_spectrum": {"code": "NTC", "acceleration": "0.2 g"}}),
    ({**DRUMS, "motion": PULSE}, "dem", SHAKEN, {**RUN_KEYS, "rebound": 0.5, "base": "moving", "direction": 0.0}),
    ({**DRUMS, "motion": PULSE}, "dem", {**SHAKEN, "direction": 20.0}, {k: v for k, v in RUN_KEYS.items() if k != "merge"} | {"direction": 70.0}),
    ({**changed(DRUMS, joints={"normal_stiffness": 1e8}), "motion": PULSE}, "dem", {"end_time": 0.4}, {
        "mass_damping": 1.0, "fraction": 0.1, "vary_damping": [0.5], "vary_stiffness": [2.0], "vary_friction": [0.8], "collapse_displacement": 0.05}),
)  # fmt: skip
#: Keys of the tables of the deck, and analyses that use them
PROPERTIES_USED: tuple[tuple[Deck, str, Deck, tuple[tuple[str, str, Any], ...]], ...] = (
    ({**BLOCK, "motion": PULSE}, "rocking", {"end_time": 2.0}, (
        ("joints", "friction", 0.1), ("joints", "restitution", 0.7), ("joints", "energy_ratio", 0.6), ("initial", "rotation_ratio", 0.2),
        ("supports", "abutting_wall", "left"), ("supports", "stiffness", 1e8), ("material", "density", 1500.0))),
    ({**DRUMS, "motion": PULSE}, "dem", SHAKEN, (("joints", "friction", 0.1), ("joints", "worn_corners", 0.02), ("initial", "rotation_ratio", 0.2), ("material", "density", 1500.0))),
    ({**DRUMS, "motion": PULSE}, "dem", {"end_time": 0.3}, (
        ("joints", "normal_stiffness", 1e8), ("joints", "beta", 1e-4), ("joints", "damping_ratio", 0.5), ("joints", "shear_ratio", 0.8), ("joints", "cohesion", 1e5),
        ("joints", "tension", 1e5), ("supports", "stiffness", 1e8), ("material", "young", 1e9))),
    (ARCH, "tilt", {}, (("joints", "friction", 0.3), ("material", "compressive_strength", 1e6), ("material", "density", 1500.0))),
    (ARCH, "moving-load", {"count": 7}, (("joints", "friction", 0.4), ("material", "compressive_strength", 1e6), ("material", "density", 1500.0))),
    (ARCH, "failure-domain", {"durations": [0.5], "amplitudes": 4, "accuracy": 1e-3}, (("joints", "friction", 0.3), ("joints", "restitution", 0.9), ("initial", "rotation_ratio", 0.3))),
    ({**BLOCK, "motion": SET}, "fragility", {"count": 5, "bootstrap": 0}, (
        ("joints", "friction", 0.1), ("joints", "restitution", 0.7), ("initial", "rotation_ratio", 0.3), ("supports", "stiffness", 1e8))),
    (ARCH, "local-mechanism", {"mechanism": "building"}, (("joints", "friction", 0.3), ("material", "compressive_strength", 1e6), ("material", "density", 1500.0))),
)  # fmt: skip


def _whole(answer: Answer) -> str:
    """All that an answer holds, as one text."""
    tables = {f"{n}.{c}": np.asarray(v).tolist() for n, t in answer.result.tables.items() for c, v in t.columns.items()}
    arrays = {n: np.asarray(v.data).tolist() for n, v in answer.result.arrays.items()}
    held = {k: repr(v) for k, v in vars(answer.results).items() if "seconds" not in k}
    return json.dumps(
        [answer.status, answer.said, answer.result.answer, answer.warnings, tables, arrays, held], default=str
    )


@relation(
    "rocking tilt thrust moving-load supports failure-domain fragility local-mechanism dem",
    st.just({}),
    0.0,
    share=0.28,
)
def every_key_has_an_effect(deck: Deck, within: float) -> None:
    """Each key of an analysis, and each property that an analysis uses, changes something of its answer; an override counts as the deck's own."""
    for deck, kind, keys, changes in EFFECTS:
        before = ask(deck, kind, **keys)
        ok(before)
        for key, value in changes.items():
            after = ask(deck, kind, **{**keys, key.split()[0]: value})
            must(_whole(after) != _whole(before), f"{key} of {kind} has no effect")
    for deck, kind, keys, properties in PROPERTIES_USED:
        before = ask(deck, kind, **keys)
        for table, key, value in properties:
            own = changed(deck, **{table: {key: value}})
            after = ask(own, kind, **keys)
            must(
                after.status == "ok" and _whole(after) != _whole(before),
                f"{table}.{key} has no effect on {kind}: {after.said}",
            )
            over = ask(deck, kind, **keys, **{table: {key: value}})
            must(over.status == "ok", f"{table}.{key} of {kind}: {over.said}")
            told = over.result.assumptions.get(f"{table}.{key}")
            must(told is None or told.origin == "analysis", f"{table}.{key} of {kind}: {told}")
            mine = after.result.assumptions.get(f"{table}.{key}")
            must(mine is None or mine.origin == "deck", f"{table}.{key} of the deck: {mine}")
            bare = before.result.assumptions.get(f"{table}.{key}")
            must(
                bare is None or bare.origin == ("deck" if key in deck.get(table, {}) else "default"),
                f"{table}.{key}: {bare}",
            )
            for name, number_ in after.numbers.items():
                if isinstance(number_, float) and name in over.numbers and isinstance(over.numbers[name], float):
                    near(f"{table}.{key} of {kind}: {name}", number_, over.numbers[name], 1e-9, 1e-9)


@relation("assess", st.just({}), 0.0, share=0.2)
def a_survey_ranks_what_each_deck_says(deck: Deck, within: float) -> None:
    """Buildings of a folder are assessed as each by itself, with what common.toml adds, in the order of their margins, and written."""
    del deck, within
    narrow = {"structure": {"kind": "block", "width": 0.3, "height": 3.0}}
    wide = {"structure": {"kind": "block", "width": 1.0, "height": 2.0}, "motion": {**PULSE, "amplitude": "0.1 g"}}
    thin = {"structure": {"kind": "arch", "radius": 5.0, "thickness": 0.2, "embrace": 180.0, "voussoirs": 20}}
    many = {
        "structure": {"kind": "block", "width": 0.8, "height": 2.0},
        "analysis": [{"kind": "tilt"}, {"kind": "assess", "strategies": ["tilt"]}],
    }
    common = {"motion": PULSE, "analysis": [{"kind": "assess", "strategies": ["tilt", "rocking"]}]}
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name) / "decks"
        folder.mkdir()
        decks_ = {"narrow": narrow, "wide": wide, "thin": thin, "many": many, "common": common}
        for stem, one in decks_.items():
            (folder / f"{stem}.toml").write_text(tomlkit.dumps(one))
        (folder / "narrow.expect.toml").write_text("no deck")
        rows = survey.assess_folder(folder, Path(name) / "out", figures=False)
        ranking = list(csv.DictReader((Path(name) / "out" / "ranking.csv").open()))
        for row in rows:
            must((row.folder / "summary.json").exists(), f"{row.building} is not written")
    must({r.building for r in rows} == {"narrow", "wide", "thin", "many"}, f"{[r.building for r in rows]}")
    must([r["building"] for r in ranking] == [r.building for r in rows], "ranking.csv in another order")
    for row in rows:
        own = decks_[row.building]
        table = next(t for t in own.get("analysis", common["analysis"]) if t["kind"] == "assess")
        alone = ask({**common, **own}, "assess", **{k: v for k, v in table.items() if k != "kind"})
        must(
            (row.status, row.overall) == (alone.status, getattr(alone.results, "overall", "")), f"{row} of {alone.said}"
        )
        margin = getattr(alone.results, "least_margin", None)
        must(np.isnan(row.least_margin) == (margin is None), f"{row.least_margin} of {margin}")
        near("margin", row.least_margin, np.nan if margin is None else margin, 1e-9)
        must(
            row.strategy == (alone.results.least_margin_strategy or "")
            and row.statement.startswith(alone.results.statement),
            f"{row}",
        )
    places_ = [
        0
        if r.overall == "cannot stand"
        else 2
        if np.isfinite(r.least_margin)
        else 3
        if r.overall == "stands under all"
        else 1
        for r in rows
    ]
    must(places_ == sorted(places_), f"in the order {places_}")
    margins = [r.least_margin for r in rows if np.isfinite(r.least_margin)]
    must(margins == sorted(margins), f"margins {margins}")
    with tempfile.TemporaryDirectory() as name:
        (Path(name) / "common.toml").write_text(tomlkit.dumps(common))
        try:
            survey.decks_of(Path(name))
        except DeckError as error:
            must("holds no decks" in str(error), str(error))
        else:
            must(False, "a folder without decks is surveyed")
        (Path(name) / "bad.toml").write_text("[structure]\nkind = 'block'\nwidth = -1.0\nheight = 2.0\n")
        try:
            survey.decks_of(Path(name))
        except DeckError as error:
            must("bad.toml" in str(error) and "width" in str(error), str(error))
        else:
            must(False, "a wrong deck is surveyed")


@relation("tilt dem rocking", st.permutations(["tilt", "dem", "rocking", "thrust", "local-mechanism"]).flatmap(
    lambda kinds_: st.tuples(st.just(kinds_), st.integers(1, 3), st.sampled_from([
        ("joints", "cohesion", 1e5), ("joints", "worn_corners", 0.02), ("joints", "restitution", 0.7),
                        ("joints", "normal_stiffness", 1e8), ("material", "compressive_strength", 1e6), ("supports", "stiffness", 1e8)]))
), 0.0, share=2.0)  # fmt: skip
def what_is_not_used_is_said_with_who_can(asked: list, count: int, given: tuple, within: float) -> None:
    """A key that no analysis of the deck uses is told with others that use it, none of which the deck has; one that some use, with those that do not."""
    table, key, value = given
    rows = [
        {"kind": k, **({"mechanism": "building"} if k == "local-mechanism" else {"end_time": 0.02, "solver": "nonsmooth"} if k == "dem" else {})} for k in asked[:count]
    ]  # fmt: skip
    deck = changed({**DRUMS, "motion": PULSE}, **{table: {key: value}}, analysis=rows)
    name = f"{table}.{key}"
    made = make_deck(deck)
    uses = [o.kind for o, b in zip(made.analyses, made.buildings, strict=True) if name in o.reckons_with(b)]
    remarks = [r.text for r in left_out(made) if key in r.text]
    without = [k for k in asked[:count] if k not in uses]
    if not without:
        must(not remarks, f"{name}, which all use: {remarks}")
        return
    if uses:
        for text in remarks:
            must(all(k in text for k in (*uses, *without)), f"{name}: {text}")
        return
    must(len(remarks) == 1 and all(k in remarks[0] for k in without), f"{name}, which none uses: {remarks}")
    if "can use it" in remarks[0]:
        able = remarks[0].split("; ")[-1].split(" can use it")[0].replace(" and others", "").split(", ")
        must(1 <= len(able) <= 3 and not set(able) & set(asked[:count]), f"{able} of {asked[:count]}")
        for kind in able:
            model = kinds.table("analysis", kind)
            must(name in (*model.uses, *model.beside), f"{kind} does not use {name}")
