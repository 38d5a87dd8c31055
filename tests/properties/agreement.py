"""What strategies must agree on: certificates of collapse, closed forms, ensembles and single runs, planes and space."""

import math
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from asking import Deck, ask, at_most, must, near, same
from buildings import arches, changed, decks, drawn, number, pulses, sections, tidy
from hypothesis import reject
from hypothesis import strategies as st
from relations import EARTHQUAKES, GRAVITY, RECTANGLES, RIGID, SLIDERS, SLIDES, SLOW, WEAK, WEAK_SET, ok, relation

import extrados
from extrados.decks.reader import make_deck

#: Strategies that say whether a building stands by its weight or under a motion, by what they are called
#: Outcomes of `rocking` in the words of `dem`
ELEMENTS_SAY = {"no-hinging": "at-rest", "recovery": "rocked", "collapse": "collapse"}
STANDING: dict[str, dict[str, Any]] = {
    "rigid contacts": {"kind": "dem", "end_time": 1.0, **RIGID},
    "springs": {"kind": "dem", "end_time": 1.0, "joints": {"normal_stiffness": 1e9}},
    "rocking": {"kind": "rocking"},
    "assessment": {"kind": "assessment", "impulses": 1},
    "fragility": {"kind": "fragility", "count": 4, "bootstrap": 0},
    "codes": {"kind": "local-mechanism", "mechanism": "building", "motion_spectrum": True},
    "failure domain": {"kind": "failure-domain", "durations": [0.5], "amplitudes": 2, "accuracy": 0.05},
    "stones with joints": {"kind": "sla", "events": 30},
}


@st.composite
def certificates(draw: st.DrawFn) -> Deck:
    """Buildings that cannot stand by the proof of limit analysis: thin arches, and arches whose stones slide apart."""
    if draw(st.booleans()):
        return {"structure": draw(arches(thin=True)), "joints": {"friction": 0.7}}
    structure = {"kind": "arch", "radius": draw(number(2.0, 10.0)), "embrace": 180.0, "voussoirs": draw(st.integers(7, 15))}
    structure["thickness"] = round(structure["radius"] * draw(number(0.12, 0.2)), 4)
    return {"structure": structure, "joints": {"friction": draw(number(0.05, 0.15, 10))}}


THIN = {"structure": {"kind": "arch", "radius": 10.0, "thickness": 0.5, "embrace": 180.0, "voussoirs": 20}, "joints": {"friction": 0.7}}


SLIPPERY = {"structure": {"kind": "arch", "radius": 10.0, "thickness": 1.5, "embrace": 157.5, "voussoirs": 7}, "joints": {"friction": 0.2}}


@relation("tilt dem rocking assessment fragility local-mechanism failure-domain sla", certificates(), 0.0, examples=(THIN, SLIPPERY))
def certificates_of_collapse(deck: Deck, within: float) -> None:
    """A structure that cannot stand by limit analysis gives no other outcome by any strategy, and all strategies with a certificate report this."""
    if ask(deck, "tilt").outcome != "cannot-stand":
        reject()
    for name, table in STANDING.items():
        motion = WEAK_SET if name == "fragility" else WEAK
        answer = ask(changed(deck, motion=motion), **table)
        must(answer.outcome not in ("stands", "open"), f"{name} says {answer.outcome}: {answer.verdict and answer.verdict.statement}")
        must(
            answer.outcome in ("cannot-stand", "collapses", "not-applicable") or answer.status == "refused", f"{name} says {answer.outcome}"
        )


@relation("tilt", certificates(), 0.0, examples=(THIN, SLIPPERY))
def a_certificate_is_a_verdict(deck: Deck, within: float) -> None:
    """A proven collapse under self-weight is a result with a verdict and safety factor 0, not a refusal."""
    answer = ask(deck, "tilt")
    if answer.outcome != "cannot-stand":
        reject()
    must(answer.status == "ok" and answer.verdict is not None and answer.verdict.ratio == 0.0, f"{answer.status}: {answer.said}")


@relation(
    "tilt dem", st.tuples(decks("block", "column", "stack", "blocks", friction=number(0.3, 0.9, 12))).map(lambda t: t[0]), 0.03, share=0.15
)
def a_slow_tilt(deck: Deck, within: float) -> None:
    """Rigid contacts in a slow tilt collapse between the least state without dilatancy and the associated limit."""
    most, least = ask(deck, "tilt"), ask(deck, "tilt", friction_rule="non-associated", starts=3)
    found = ask(deck, "dem", **{**SLOW, "tilt_accuracy": 0.01})
    ok(most, found)
    at_most("rigid contacts", found.capacity, most.capacity, within, 0.3)
    if least.answers:
        at_most("rigid contacts", least.capacity, found.capacity, within, 0.3)


@relation("tilt thrust dem rocking failure-domain local-mechanism fragility code-checks sla", RECTANGLES, 2e-3, share=0.5)
def one_block_by_every_strategy(width: float, height: float, within: float) -> None:
    """A block that cannot slide begins to rock at b/h g."""
    deck = {"structure": {"kind": "block", "width": width, "height": height}, "joints": {"friction": 1.0}}
    want = width / height
    near("limit analysis", ask(deck, "tilt").capacity, [want, want], 1e-6)
    with tempfile.TemporaryDirectory() as folder:  # drawn out, pushed along x
        (Path(folder) / "stones.json").write_text(extrados.export({**deck, "analysis": [{"kind": "tilt"}]}, "compas"))
        solid = ask(
            {**deck, "structure": {"kind": "blocks", "file": "stones.json", "unit": "m"}}, "tilt", Path(folder), direction=0.0, rose=4
        )
    near("in space", solid.capacity, [want, want], 1e-5)
    opened = solid.results.opening_contacts[0]
    near("opening of the base", opened.opening, width / math.hypot(width, height), within)
    must((solid.results.moving_blocks, opened.sliding < within) == (1, True), f"{solid.results.moving_blocks} blocks, {opened}")
    for name, keys in (
        ("rigid contacts", SLOW),
        ("springs", {"test": "tilt", "joints": {"normal_stiffness": 1e10}, "tilt_accuracy": 0.002}),
    ):
        near(name, ask(deck, "dem", **keys).capacity, [want, want], 0.01, 0.3)
    moving = changed(deck, motion={"kind": "sine-pulse", "amplitude": "0.4 g", "period": 0.5})
    near("rocking", ask(moving, "rocking").results.uplift_acceleration_g, want, within)
    near(
        "failure domain",
        ask(deck, "failure-domain", durations=[0.5], amplitudes=2, accuracy=0.05).results.uplift_acceleration_g,
        want,
        within,
    )
    near("fragility", ask(changed(deck, motion=WEAK_SET), "fragility", count=2, bootstrap=0).results.uplift_acceleration_g, want, within)
    codes = ask(deck, "local-mechanism", mechanism="building").results
    near("codes", codes.multiplier, want, within)
    near("M* of one block", codes.participating_part, 1.0, within)
    mass = 2000.0 * width * height
    near("M*", codes.participating_mass_kg, mass, within)
    near("weight", ask(deck, "tilt").results.weight_N, mass * GRAVITY, within)
    near("Housner", ask(moving, "rocking").results.restitution, 1.0 - 1.5 * width**2 / (width**2 + height**2), within)
    near(
        "p", ask(moving, "rocking").results.frequency_parameter_rad_s, math.sqrt(0.75 * GRAVITY / (0.5 * math.hypot(width, height))), within
    )


FLAT = {"structure": {"kind": "block", "width": 0.5, "height": 0.15}, "joints": {"friction": 0.306}}


@relation("tilt dem", SLIDERS, 2e-3, examples=(SLIDES, FLAT))
def a_block_that_slides(deck: Deck, within: float) -> None:
    """With friction below b/h a block slides at the coefficient of friction, which is no collapse."""
    mu = deck["joints"]["friction"]
    for rule in ("associated", "non-associated"):
        near(rule, ask(deck, "tilt", friction_rule=rule).capacity, [mu, mu], within)
    moving = changed(deck, motion={"kind": "sine-pulse", "amplitude": f"{2.5 * mu:g} g", "period": 1.0})
    run_ = ask(moving, "dem", end_time=3.0, **RIGID)
    ok(run_)
    must(run_.results.outcome == "slid", f"rigid contacts call it {run_.results.outcome}: {run_.outcome}")


def slid(mu: float, amplitude: float, period: float, step: float = 1e-4) -> float:
    """Greatest slip of a rigid block under one cycle of a sine (Newmark 1965), accelerations in g [m]."""
    place = speed = most = 0.0
    for k in range(round((period + 20.0 * amplitude) / step)):
        ground = GRAVITY * amplitude * math.sin(2.0 * math.pi * k * step / period) if k * step < period else 0.0
        if speed == 0.0 and abs(ground) <= mu * GRAVITY:
            if k * step >= period:
                break
            continue
        rate = -ground - math.copysign(mu * GRAVITY, speed if speed else -ground)
        new = speed + step * rate
        if speed * new < 0.0:
            new = 0.0
        speed, place = new, place + step * new
        most = max(most, abs(place))
    return most


@relation("dem", st.tuples(SLIDERS, number(1.2, 2.0), number(0.2, 0.5)), 0.02, share=0.5)
def newmark(deck: Deck, ratio: float, period: float, within: float) -> None:
    """Blocks on rigid contacts slide as far as Newmark's sliding block, if the slip is small compared with the block."""
    mu = deck["joints"]["friction"]
    amplitude = float(f"{ratio * mu:.4g}")
    want = slid(mu, amplitude, period)
    if want > 0.15 * deck["structure"]["height"]:
        reject()
    moving = changed(deck, motion={"kind": "sine-pulse", "amplitude": f"{amplitude:g} g", "period": period})
    found = ask(moving, "dem", end_time=period + 1.0, time_step=5e-4, **RIGID)
    ok(found)
    near("slip", found.results.peak_slip_m, want, within, 1e-3 / within)


@relation("rocking dem", st.tuples(RECTANGLES, number(0.3, 0.8), number(0.3, 0.8)), 0.03, share=0.5)
def rocking_by_two_strategies(size: tuple, ratio: float, period: float, within: float) -> None:
    """A block under one sine has the same response by its equation of motion and on rigid contacts."""
    width, height = size
    amplitude = (1.5 + ratio) * width / height
    deck = {
        "structure": {"kind": "block", "width": width, "height": height},
        "joints": {"friction": "no-sliding"},
        "motion": {"kind": "sine-pulse", "amplitude": f"{amplitude:.4g} g", "period": period},
    }
    one = ask(deck, "rocking")
    ok(one)
    if one.results.decided_by_last_digits or not 1e-3 < abs(one.results.peak_rotation_ratio) < 0.7:
        reject()
    other = ask(deck, "dem", end_time=2.0 * period, time_step=2e-4, **RIGID)
    ok(other)
    peak = max(abs(v) for v in other.results.peak_rotation_rad.values())
    near("peak rotation", abs(one.results.peak_rotation_rad), peak, within, 0.05 * one.results.critical_rotation_rad)
    must(
        ELEMENTS_SAY[one.results.outcome] == other.results.outcome, f"{one.results.outcome} by rocking, {other.results.outcome} by elements"
    )
    weak = changed(deck, motion={"amplitude": f"{0.9 * width / height:.4g} g"})
    quiet = [ask(weak, "rocking"), ask(weak, "dem", end_time=period, time_step=1e-3, **RIGID)]
    ok(*quiet)
    for answer in quiet:
        must(answer.results.outcome in ("no-hinging", "at-rest"), f"{answer.results.outcome} below b/h")


@relation("failure-domain rocking", st.tuples(decks("block", "arch"), number(0.3, 1.2)), 0.0)
def domains_and_single_runs(deck: Deck, period: float, within: float) -> None:
    """Just above the curve of a failure domain a pulse causes collapse; well below it no pulse does."""
    keys = {"pulse": "sine", "durations": [period], "amplitudes": 10, "accuracy": 1e-3}
    domain = ask(deck, "failure-domain", **keys)
    ok(domain)
    if (least := domain.results.mode_I.amplitudes_g[0]) is None:
        reject()
    for amplitude, falls in ((least + 1e-3, True), (0.9 * least - 1e-3, False)):
        run_ = ask(changed(deck, motion={"kind": "sine-pulse", "amplitude": f"{amplitude!r} g", "period": period}), "rocking")
        ok(run_)
        if not run_.results.decided_by_last_digits:
            must((run_.results.outcome == "collapse") == falls, f"{amplitude} g of {least} g: {run_.results.outcome}")


@relation(
    "fragility rocking",
    st.tuples(decks("block", "arch"), EARTHQUAKES),
    0.0,
    exception="a history that is handed over to rigid contacts counts as rocking, where its blocks slide alone",
    examples=(
        (
            {
                "structure": {"kind": "arch", "radius": 1.0, "thickness": 0.334, "embrace": 180.0, "voussoirs": 6},
                "joints": {"friction": 0.6},
            },
            {"kind": "generated", "mmi": 8, "duration": 2.0, "seed": 1, "lines": 8},
        ),
    ),
)
def ensembles_and_single_runs(deck: Deck, motion: Deck, within: float) -> None:
    """The counts of a fragility are those of single runs of its motions."""
    count = 5
    whole = ask(changed(deck, motion=motion), "fragility", count=count, bootstrap=0)
    ok(whole)
    runs = [ask(changed(deck, motion={**motion, "member": k}), "rocking", hand_over=False) for k in range(1, count + 1)]
    ok(*runs)
    if any(r.results.decided_by_last_digits for r in runs):
        reject()
    collapsed = sum(r.results.outcome == "collapse" for r in runs)
    uplifted = sum(r.results.outcome != "no-hinging" for r in runs)
    peaks = [r.results.peak_ground_acceleration_g for r in runs]
    near("median peak acceleration", whole.results.median_pga_g, np.median(peaks), 1e-6)
    must(
        (whole.results.collapsed, whole.results.uplifted) == (collapsed, uplifted),
        f"{whole.results.collapsed} collapse and {whole.results.uplifted} rock, run one by one {collapsed} and {uplifted}",
    )


@relation(
    "rocking dem",
    st.tuples(decks("vault"), number(2.0, 4.0), number(0.7, 1.5)),
    0.0,
    share=0.05,
    examples=(({"structure": {"kind": "vault", "preset": "dejong-a"}, "joints": {"friction": 0.7}}, 3.0, 1.1),),
)
def hinges_elsewhere(deck: Deck, ratio: float, period: float, within: float) -> None:
    """A vault on buttresses that recovers by its mechanism also recovers on rigid contacts."""
    base = ask(deck, "tilt")
    ok(base)
    amplitude = ratio * base.capacity[0]
    moving = changed(deck, motion={"kind": "sine-pulse", "amplitude": f"{amplitude:.4g} g", "period": period})
    one = ask(moving, "rocking")
    ok(one)
    if one.outcome != "stands":
        return
    other = ask(moving, "dem", end_time=period + 4.0, **RIGID)
    must(other.outcome != "collapses", f"rocking: {one.verdict.statement}; rigid contacts: {other.verdict.statement}")


@relation("local-mechanism tilt", decks("block", "column", "brickwork", "arch", "pointed-arch", "frame"), 1e-4)
def codes_take_the_least_multiplier(deck: Deck, within: float) -> None:
    """alpha_0 of the whole section is its collapse acceleration, to the weaker side; a_0* and M* follow from it and e*."""
    codes = ask(deck, "local-mechanism", mechanism="building", confidence_factor=1.0)
    limit = ask(deck, "tilt")
    ok(codes, limit)
    r = codes.results
    near("alpha_0", r.multiplier, limit.capacity.min(), within)
    near("a_0*", r.activation_acceleration_g * r.participating_part, r.multiplier, within)
    near("M*", r.participating_mass_kg * GRAVITY, r.participating_part * r.swaying_weight_N, within)
    if r.zero_displacement_m is not None:
        near("d_SLV", r.ultimate_displacement_m, 0.4 * r.zero_displacement_m, within)
        near("d_SLC", r.collapse_displacement_m, 0.6 * r.zero_displacement_m, within)


@relation(
    "failure-curves failure-domain",
    st.tuples(decks("block", "arch"), number(0.3, 1.0)),
    5e-3,
    examples=(
        (
            {
                "structure": {"kind": "arch", "radius": 6.06, "thickness": 0.9199, "embrace": 145.0, "voussoirs": 12},
                "joints": {"friction": 0.7},
            },
            0.86,
        ),
    ),
)
def curves_and_domains(deck: Deck, period: float, within: float) -> None:
    """A failure curve is the lower edge of the failure domain of fixed hinges. Both state where these do not hold; an edge decided by contacts
    lies on an amplitude of the map, and this is stated."""
    keys = {"pulse": "sine", "durations": [period, 1.5 * period], "amplitudes": 10, "accuracy": 1e-3}
    domain, curves = ask(deck, "failure-domain", hand_over_cells=0, **keys), ask(deck, "failure-curves", **keys)
    decided = ask(deck, "failure-domain", **keys)
    ok(domain, curves, decided)
    curve, r = curves.results.curves[0], decided.results
    for one, other in zip(domain.results.mode_I.amplitudes_g, curve.amplitudes_g, strict=True):
        must((one is None) == (other is None), f"{one} g of the domain, {other} g of the curve")
        if one is not None:
            near("amplitude", one, other, within, 0.3)
    near("uplift", domain.results.uplift_acceleration_g, curve.uplift_acceleration_g, 1e-9)
    for name in ("sliding_from_g", "hinges_elsewhere_from_g"):
        must(getattr(r, name) == getattr(curve, name) == getattr(domain.results, name), f"{name} of the curve and of the map differ")
    if r.handed_over is None:
        must(r.mode_I == domain.results.mode_I, "the edge differs without a hand-over")
        return
    must("accurate to one cell of the map" in decided.warnings, f"the accuracy is not stated: {decided.warnings}")
    must(bool(curve.conditions.violated), "the curve does not state that hinges or friction fail")
    places = decided.result.arrays["amplitude"].data
    left = zip(r.mode_I.amplitudes_g, r.sliding_from_g, r.hinges_elsewhere_from_g, strict=True)
    for edge, *starts in left:
        if edge is not None and any(start is not None for start in starts):
            must(bool(np.isclose(places, edge).any()), f"{edge} g is no amplitude of the map")


@relation("harmonic-map rocking", st.tuples(decks("block"), number(0.5, 2.0)), 0.0)
def maps_and_single_runs(deck: Deck, frequency: float, within: float) -> None:
    """The outcomes of a map at a frequency are those of single runs."""
    keys = {"frequencies": [frequency], "amplitudes": 6, "cycles": 2}
    found = ask(deck, "harmonic-map", **keys)
    ok(found)
    if (least := found.results.lowest_overturning_amplitude_g[0]) is None:
        reject()
    motion = {"kind": "harmonic", "amplitude": f"{least!r} g", "frequency": frequency, "duration": 2.0 / frequency}
    one = ask(changed(deck, motion=motion), "rocking")
    ok(one)
    must(one.results.outcome == "collapse" or one.results.decided_by_last_digits, f"at {least} g: {one.results.outcome}")


@relation("rocking", st.tuples(RECTANGLES, number(0.1, 0.9)), 1e-5)
def free_rocking(size: tuple, ratio: float, within: float) -> None:
    """A released slender block has its first impact after acosh(1/(1 - r))/p, and loses 1 - c^2 of its energy (Housner 1963)."""
    width, height = size
    deck = {
        "structure": {"kind": "block", "width": width, "height": height},
        "joints": {"friction": 2.0},
        "initial": {"rotation_ratio": ratio},
        "motion": {"kind": "constant", "amplitude": "0 g"},
    }
    answer = ask(deck, "rocking", form="linear")
    ok(answer)
    r = answer.results
    near("first impact", r.impact_times_s[0], math.acosh(1.0 / (1.0 - ratio)) / r.frequency_parameter_rad_s, within)
    near("peak", abs(r.peak_rotation_ratio), ratio, within)
    gaps = np.diff(r.impact_times_s[:2])
    after = math.sqrt(1.0 - r.restitution**2 * (1.0 - (1.0 - ratio) ** 2))
    near("half cycle", gaps[0], 2.0 * math.acosh(1.0 / after) / r.frequency_parameter_rad_s, within)


@relation("dem", st.tuples(decks("block"), pulses(0.4, 1.2)), 0.02, share=0.5)
def elements_in_space_and_in_the_plane(deck: Deck, motion: Deck, within: float) -> None:
    """A body that moves in a plane does so in space too."""
    keys = {"end_time": 0.5, "time_step": 0.001, **RIGID}
    moving = changed(deck, motion=motion, joints={"friction": 0.9})
    plane, space = ask(moving, "dem", **keys), ask(moving, "dem", direction=0.0, **keys)
    ok(plane, space)
    near("peak displacement", plane.results.peak_displacement_m, space.results.peak_displacement_m, within, 1e-2)


@relation(
    "dem", st.tuples(number(1.5, 3.0), number(0.4, 0.9), number(0.5, 2.0), st.sampled_from(["none", "linear", "full"])), 0.02, share=0.5
)
def water_in_space_and_in_the_plane(height: float, share: float, depth: float, uplift: str, within: float) -> None:
    """Solids drawn out of a section resist water as the section does; a lighter liquid presses in the ratio of the densities."""
    structure = {"kind": "block", "width": 1.2, "height": height, "depth": depth}
    deck = {"structure": structure, "material": {"density": 2400.0}, "joints": {"friction": 0.9}}
    water = {"level": share * height, "uplift": uplift}
    plane, space, half = (
        ask(deck, "dem", test="tilt", water={**water, "density": density}, **RIGID, **keys)
        for density, keys in ((1000.0, {}), (1000.0, {"direction": 0.0}), (500.0, {"direction": 0.0}))
    )
    if plane.outcome == "cannot-stand":
        must(space.outcome == "cannot-stand", f"in space: {space.outcome}")
        reject()
    ok(plane, space, half)
    near("capacity", space.capacity, plane.capacity, within, 0.3)
    near("force", space.results.water_force_N, plane.results.water_force_N, 1e-9)
    near("force of half the density", [2.0 * x for x in half.results.water_force_N], space.results.water_force_N, 1e-9)


@relation("dem", st.tuples(number(1.0, 2.0), number(0.8, 2.0), number(0.3, 2.0), st.sampled_from([1e7, 1e8])), 0.05)
def springs_under_a_slow_push(width: float, slenderness: float, depth: float, stiffness: float, within: float) -> None:
    """A block in full contact rotates on the springs at its two corners by M/(k d b^3/4)."""
    height = round(width * slenderness, 4)
    amplitude = 0.1 * width / height
    deck = {
        "structure": {"kind": "block", "width": width, "height": height, "depth": depth},
        "joints": {"friction": 2.0, "normal_stiffness": stiffness},
        "motion": {"kind": "harmonic", "amplitude": f"{amplitude:.5g} g", "frequency": 0.5, "duration": 2.0},
    }
    answer = ask(deck, "dem", end_time=2.0)
    ok(answer)
    moment = 2000.0 * width * height * depth * amplitude * GRAVITY * 0.5 * height
    turn = moment / (stiffness * depth * width**3 / 4.0)
    near("rotation", max(abs(v) for v in answer.results.peak_rotation_rad.values()), turn, within)


@relation("dem rocking", st.tuples(number(0.3, 1.0), number(2.0, 5.0), number(0.2, 0.6)), 0.05)
def impacts_of_a_free_block(width: float, slenderness: float, ratio: float, within: float) -> None:
    """Rigid contacts lose the same energy at each impact as Housner's block."""
    height = round(width * slenderness, 4)
    deck = {
        "structure": {"kind": "block", "width": width, "height": height},
        "joints": {"friction": "no-sliding"},
        "initial": {"rotation_ratio": ratio},
        "motion": {"kind": "constant", "amplitude": "0 g"},
    }
    answer, rocks = ask(deck, "dem", end_time=3.0, time_step=5e-4, **RIGID), ask(deck, "rocking", end_time=3.0)
    ok(answer, rocks)
    if answer.results.restitution_measured is None:
        reject()
    near("restitution", answer.results.restitution_measured, answer.results.restitution_housner, within)
    near("restitution of rocking", rocks.results.restitution, answer.results.restitution_housner, 1e-6)


@relation("tilt local-mechanism", st.tuples(decks("arch", "column"), number(0.01, 0.2)), 1e-3)
def ties_by_codes_and_limit_analysis(deck: Deck, force: float, within: float) -> None:
    """A yielding tie raises the multiplier of a local mechanism as that of the section; codes refuse a tie that never yields."""
    section = drawn(deck)
    blocks = section["structure"]["block"]
    bare = ask(section, "tilt")
    ok(bare)
    if len(blocks) < 2:
        reject()
    x, y = tidy(np.mean(blocks[len(blocks) // 2]["points"], axis=0))
    left = min(p[0] for b in blocks for p in b["points"])
    tie = {"start": [x, y], "ground": [left - 2.0, y], "works_in": "tension", "stiffness": 1e8}
    held = {**section, "ties": [{**tie, "yield_force": force * bare.results.weight_N}]}
    codes, limit = ask(held, "local-mechanism", mechanism="building"), ask(held, "tilt")
    ok(codes, limit)
    near("alpha_0", codes.results.multiplier, limit.capacity.min(), within)
    endless = ask({**section, "ties": [tie]}, "local-mechanism", mechanism="building")
    must(endless.status == "refused" or endless.results.multiplier >= codes.results.multiplier - within, f"{endless.said}")


def drawn_joints(deck: Deck) -> list[str]:
    """Names of the joints to the ground."""
    stones = make_deck({**deck, "analysis": [{"kind": "tilt"}]}).building.blocks()
    return [name for name, a, b in zip(stones.joint_names, stones.a, stones.b, strict=True) if min(a, b) < 0]


@relation("supports", st.tuples(decks("frame", "vault", "brickwork"), st.sampled_from([0.001, 0.004])), 1e-6)
def openings_of_moving_supports(deck: Deck, movement: float, within: float) -> None:
    """Joints open in proportion to a small movement, and no farther than a small multiple of it."""
    joint = drawn_joints(deck)[-1]
    one, other = (ask(changed(deck, initial={"movements": [{"joint": joint, "dx": m}]}), "supports") for m in (movement, 2.0 * movement))
    same("movement", one, other)
    ok(one, other)
    first, second = (a.results.openings for a in (one, other))
    must(bool(first) and len(first) == len(second), f"{len(first or [])} and {len(second or [])} joints")
    for a, b in zip(first, second, strict=True):
        near(f"{a.name}: opening", 2.0 * a.opening_mm, b.opening_mm, within, 1.0)
        near(f"{a.name}: slip", 2.0 * abs(a.slip_mm), abs(b.slip_mm), within, 1.0)
        at_most(f"{a.name}: opening", max(a.opening_mm, abs(a.slip_mm)), 30.0 * 1e3 * movement, 0.0)


@relation("rocking tilt", decks("frame"), 1e-6)
def frames_that_rock(deck: Deck, within: float) -> None:
    """Columns under a lintel rock as one larger block (Makris and Vassiliou 2013)."""
    s = deck["structure"]
    answer = ask(changed(deck, motion=WEAK), "rocking")
    ok(answer)
    r = answer.results
    half, slender = 0.5 * math.hypot(s["width"], s["height"]), math.atan2(s["width"], s["height"])
    lintel = ((s["columns"] - 1) * 2.5 if "spacing" not in s else (s["columns"] - 1) * s["spacing"]) + s["width"]
    ratio = lintel * s["lintel_height"] / (s["columns"] * s["width"] * s["height"])
    near("uplift", r.uplift_acceleration_g, math.tan(slender), within)
    near("capacity", ask(deck, "tilt").capacity, [math.tan(slender)] * 2, within)
    square = (1.0 + 2.0 * ratio) / (1.0 + 3.0 * ratio) * 0.75 * GRAVITY / half
    near("p", r.frequency_parameter_rad_s, math.sqrt(square), within)
    after = (1.0 - 1.5 * math.sin(slender) ** 2 + 3.0 * ratio * math.cos(2.0 * slender)) / (1.0 + 3.0 * ratio)
    near("restitution", r.restitution, after, within)


@relation("tilt dem", st.tuples(number(0.5, 2.0), number(2.0, 6.0), st.integers(1, 4), st.sampled_from([4, 6, 8, 12])), 1e-4)
def round_columns(width: float, slenderness: float, drums: int, sides: int, within: float) -> None:
    """Drums of flat facets overturn about a facet or corner of their base, for each direction of the load."""
    height = round(width * slenderness, 4)
    deck = {
        "structure": {"kind": "column", "width": width, "height": height, "drums": drums, "section": "round", "sides": sides},
        "joints": {"friction": 2.0},
    }
    answer = ask(deck, "tilt", direction=0.0, rose=2 * sides)
    ok(answer)
    r = answer.results
    facet, corner = width * math.cos(math.pi / sides) / height, width / height
    near("least of all directions", r.least_acceleration_g, facet, within)
    at_most("a corner", answer.capacity, [corner, corner], within)
    area = 0.5 * sides * (0.5 * width) ** 2 * math.sin(2.0 * math.pi / sides)
    near("weight", r.weight_N, area * height * 2000.0 * GRAVITY, within)
    must(r.blocks == drums, f"{r.blocks} stones of {drums}")


@relation("thrust tilt", decks("arch", "pointed-arch", "elliptical-arch"), 0.02)
def drawn_arches(deck: Deck, within: float) -> None:
    """An arch of free blocks has the thrusts and the capacity of the structure arch, but for chords in place of arcs."""
    one, other = ask(deck, "thrust"), ask(drawn(deck), "thrust")
    same("drawn", one, other)
    ok(one, other)
    for name in ("least", "most"):
        lines = [getattr(a.results, name, None) for a in (one, other)]
        must((lines[0] is None) == (lines[1] is None), f"{name}: {lines}")
        if None not in lines:
            near(f"{name} thrust", lines[0].horizontal_N, lines[1].horizontal_N, within)
            near(f"{name} crown", lines[0].crown_N or 0.0, lines[1].crown_N or 0.0, 2.0 * within)
    at_most("order", one.results.least.horizontal_N, one.results.most.horizontal_N, 1e-6)
    near("capacity", ask(deck, "tilt").capacity, ask(drawn(deck), "tilt").capacity, within, 0.1)


WEIGHTLESS = st.sampled_from(["tilt", "thrust", "dem", "rocking", "local-mechanism"])


DRUM = {
    "structure": {
        "kind": "blocks",
        "block": [{"name": "drum", "points": [[-0.15, 0.0], [0.15, 0.0], [0.15, 0.45], [-0.15, 0.45]]}],
        "ground": [[-0.15, 0.0, 0.15, 0.0]],
    }
}


@relation(
    "tilt thrust dem rocking local-mechanism",
    st.tuples(sections("column", "brickwork", "arch"), WEIGHTLESS),
    0.0,
    examples=((DRUM, "local-mechanism"),),
)
def stones_without_weight(deck: Deck, kind: str, within: float) -> None:
    """Analyses that use the weight refuse a block without weight, with the reason."""
    made = changed(deck, material={"density": 0.0}, motion=WEAK)
    for k, block in enumerate(made["structure"]["block"]):
        block.pop("density", None) if k == 0 else None
    keys: dict[str, Any] = {"mechanism": "building"} if kind == "local-mechanism" else {**RIGID, "end_time": 0.1} if kind == "dem" else {}
    answer = ask(made, kind, **keys)
    must(answer.status == "refused" and "density" in answer.said, f"{kind}: {answer.status} {answer.said}")


WALLS = st.tuples(
    st.integers(4, 8), st.integers(4, 8), number(0.3, 0.6), number(0.15, 0.3), number(0.1, 0.9), number(0.1, 0.9), number(0.2, 0.6)
)


@relation("tilt", WALLS, 1e-9)
def laid_walls_are_full(units: int, courses: int, length: float, height: float, x: float, y: float, size: float, within: float) -> None:
    """A wall of units has the weight of its outline less the openings."""
    wide, high = units * length, courses * height
    left, low = round(x * 0.5 * wide, 3), round(y * 0.5 * high, 3)
    hole = {"x": [left, round(left + size * 0.4 * wide, 3)], "y": [low, round(low + size * 0.4 * high, 3)]}
    hole["y"][0] = 0.0 if hole["y"][0] < 0.1 * high else hole["y"][0]
    area = (hole["x"][1] - hole["x"][0]) * (hole["y"][1] - hole["y"][0])
    for kind, keys in (
        ("brickwork", {"units": units, "courses": courses, "depth": 0.25}),
        ("panel", {"width": wide, "height": high, "thickness": 0.25}),
    ):
        structure = {"kind": kind, "unit_length": length, "unit_height": height, "openings": [hole], **keys}
        answer = ask({"structure": structure, "joints": {"friction": 0.7}}, "tilt")
        ok(answer)
        near(kind, answer.results.weight_N, (wide * high - area) * 0.25 * 2000.0 * GRAVITY, within)


@relation("failure-domain", st.tuples(decks("block", "arch"), number(0.4, 1.2), number(0.02, 0.98)), 1e-9)
def verdicts_between_points_of_a_curve(deck: Deck, period: float, share: float, within: float) -> None:
    """The capacity under a pulse between two durations of a curve is interpolated linearly."""
    durations = [round(period, 4), round(1.2 * period, 4)]
    asked = round(durations[0] + share * (durations[1] - durations[0]), 5)
    motion = {"kind": "sine-pulse", "amplitude": "0.2 g", "period": asked}
    answer = ask(changed(deck, motion=motion), "failure-domain", pulse="sine", durations=durations, amplitudes=10, accuracy=1e-3)
    ok(answer)
    ends = answer.results.mode_I.amplitudes_g
    if None in ends:
        reject()
    near("capacity", answer.verdict.capacity, np.interp(asked, durations, ends), within)
    near("demand", answer.verdict.demand, 0.2, 1e-6)
