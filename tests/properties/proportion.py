"""What goes in proportion: similitude of dynamics, statics without a scale, loads, densities, finer steps."""

import math
import tempfile
from pathlib import Path

import numpy as np
from asking import Answer, Deck, ask, must, near, same
from buildings import MESH, ROCKING, changed, decks, number, pulses, scaled
from hypothesis import reject
from hypothesis import strategies as st
from relations import EARTHQUAKES, GRAVITY, INTERVAL, MASONRY, RIGID, SCALES, SLOW, STONES, ok, recorded, relation, statics


@relation("rocking", st.tuples(decks(*ROCKING), pulses(0.1, 1.2), SCALES), 1e-4)
def similitude_of_rocking(deck: Deck, motion: Deck, factor: float, within: float) -> None:
    """With lengths multiplied by s and times by the root of s the rotations are equal."""
    end, root = 4.0 * motion["period"] + 2.0, math.sqrt(factor)
    there = changed(scaled(deck, factor), motion=changed(motion, period=motion["period"] * root))
    one = ask(changed(deck, motion=motion), "rocking", end_time=end)
    other = ask(there, "rocking", end_time=end * root)
    ok(one, other)
    if one.results.decided_by_last_digits or other.results.decided_by_last_digits:
        reject()
    same("scaled", one, other)
    near("peak rotation", one.results.peak_rotation_ratio, other.results.peak_rotation_ratio, within, 1e-4)
    near("uplift", one.results.uplift_acceleration_g, other.results.uplift_acceleration_g, within)


@relation("dem", st.tuples(decks("block", "column"), pulses(0.1, 0.6), st.sampled_from([0.25, 4.0])), 1e-3, share=0.4)
def similitude_of_elements(deck: Deck, motion: Deck, factor: float, within: float) -> None:
    """With lengths multiplied by s and times by the root of s the response of rigid contacts is similar."""
    root = math.sqrt(factor)
    keys = {**RIGID, "end_time": 1.0, "time_step": 0.002, "output_step": 0.01}
    one = ask(changed(deck, motion=motion), "dem", **keys)
    there = changed(scaled(deck, factor), motion=changed(motion, period=motion["period"] * root))
    other = ask(there, "dem", **{**keys, **{k: keys[k] * root for k in ("end_time", "time_step", "output_step")}})
    ok(one, other)
    same("scaled", one, other)
    near("peak displacement", one.results.peak_displacement_m * factor, other.results.peak_displacement_m, within, 1e-3 * factor)


@relation("tilt local-mechanism", st.tuples(STONES, SCALES), 1e-5)
def statics_of_another_size(deck: Deck, factor: float, within: float) -> None:
    """Collapse accelerations do not depend on the size."""
    if deck["structure"].get("preset"):
        reject()  # sizes of a preset are not in the deck
    one, other = statics(deck), statics(scaled(deck, factor))
    same("scaled", one, other)
    near("scaled", one.capacity, other.capacity, within, 1e-3)


@relation("local-mechanism", st.tuples(decks("block", "column", "arch", "brickwork"), SCALES), 1e-4)
def codes_of_another_size(deck: Deck, factor: float, within: float) -> None:
    """a_0* does not depend on the size; d_0* is proportional to it, T_SLV to its root, M* to its square."""
    answers = [ask(d, "local-mechanism", mechanism="building") for d in (deck, scaled(deck, factor))]
    same("scaled", *answers)
    ok(*answers)
    one, other = (a.results for a in answers)
    for name, power in (
        ("multiplier", 0.0),
        ("participating_part", 0.0),
        ("activation_acceleration_g", 0.0),
        ("zero_displacement_m", 1.0),
        ("ultimate_displacement_m", 1.0),
        ("collapse_displacement_m", 1.0),
        ("equivalent_period_s", 0.5),
        ("swaying_weight_N", None),
        ("participating_mass_kg", None),
    ):
        a, b = getattr(one, name), getattr(other, name)
        if a is None or b is None:
            must(a is b, f"{name}: {a} against {b}")
            continue
        lengths = 3.0 if "depth" in deck["structure"] else 2.0
        near(name, a * factor ** (lengths if power is None else power), b, within)


@relation("tilt local-mechanism", st.tuples(STONES, number(0.3, 3.0)), 1e-5)
def statics_of_another_density(deck: Deck, factor: float, within: float) -> None:
    """Collapse accelerations do not depend on the density; weights are proportional to it."""
    if deck["structure"]["kind"] in ("bridge", "aisled-vault"):
        reject()  # their fill has a density of its own
    one, other = (statics(changed(deck, material={"density": 2000.0 * f})) for f in (1.0, factor))
    same("density", one, other)
    near("density", one.capacity, other.capacity, within, 1e-3)
    if one.answers:
        near("weight", one.results.weight_N * factor, other.results.weight_N, within)


@relation("moving-load thrust", st.tuples(decks("arch", "pointed-arch", "elliptical-arch"), number(0.3, 3.0)), 1e-5)
def loads_in_proportion(deck: Deck, factor: float, within: float) -> None:
    """Collapse loads and thrusts are proportional to the density, a factor on the weight equals a density, and the safety factor is inversely proportional to the load."""
    there = [changed(deck, material={"density": 2000.0 * f}) for f in (1.0, factor)]
    for name in ("least", "most"):
        thrusts = [ask(d, "thrust") for d in there]
        ok(*thrusts)
        lines = [getattr(a.results, name, None) for a in thrusts]
        if None not in lines:
            near(f"{name} thrust", lines[0].horizontal_N * factor, lines[1].horizontal_N, within)
    one, other = (ask(d, "moving-load", count=7) for d in there)
    ok(one, other)
    near("collapse load", one.results.collapse_load_N * factor, other.results.collapse_load_N, within)
    by_factor = ask(there[0], "moving-load", count=7, factors={"masonry": factor})
    near("factor on the weight", by_factor.results.collapse_load_N, other.results.collapse_load_N, within)
    safe = [ask(there[0], "moving-load", count=7, force=f).results.safety_factor for f in (1e3, 1e3 * factor)]
    near("safety factor", safe[0], safe[1] * factor, within)
    near("safety factor", safe[0] * 1e3, one.results.collapse_load_N, within)


@relation("fragility", st.tuples(decks("block"), EARTHQUAKES, number(0.5, 2.0)), 1e-6)
def a_factor_on_the_motion(deck: Deck, motion: Deck, factor: float, within: float) -> None:
    """A set at a level equals the set scaled by the level: the same share collapses."""
    whole = changed(deck, motion=motion)
    levels = ask(whole, "fragility", count=8, intensity="scale", levels=[1.0, round(factor, 6) + 0.01], bootstrap=0)
    plain = ask(changed(deck, motion={**motion, "factor": 1.0}), "fragility", count=8, bootstrap=0)
    ok(levels, plain)
    at_one = levels.results.collapsed[levels.results.levels.index(1.0)]
    must(at_one == plain.results.collapsed, f"{at_one} of a set at level 1 against {plain.results.collapsed} of the set")


@relation(
    "rocking",
    st.tuples(decks(*ROCKING), pulses(0.1, 1.2)),
    1e-4,
    exception="blocks are handed over to rigid contacts at a step of the integrator: peaks after it are known within 5 %",
    examples=(
        (
            {"structure": {"kind": "column", "width": 1.966, "height": 7.653, "drums": 2, "top_width": 1.573}, "joints": {"friction": 0.7}},
            {"kind": "sine-pulse", "amplitude": "1.178 g", "period": 1.06},
        ),
    ),
)
def a_finer_integrator(deck: Deck, motion: Deck, within: float) -> None:
    """A hundredth of the tolerance of the integrator changes no result."""
    for hand_over, error in ((False, within), (True, 0.05)):
        one, other = (ask(changed(deck, motion=motion), "rocking", tolerance=t, hand_over=hand_over) for t in (1e-8, 1e-10))
        ok(one, other)
        if one.results.decided_by_last_digits or other.results.decided_by_last_digits:
            reject()
        same("finer", one, other)
        near("peak rotation", one.results.peak_rotation_ratio, other.results.peak_rotation_ratio, error, 1e-4)


@relation("dem", st.tuples(decks("block", "column"), st.sampled_from([0.001, 0.002])), 0.01, share=0.15, exception=INTERVAL)
def half_the_time_step(deck: Deck, step: float, within: float) -> None:
    """Rigid contacts in a slow tilt give the same capacity with half the time step."""
    one, other = (ask(deck, "dem", **{**SLOW, "time_step": s}) for s in (step, 0.5 * step))
    same("half the step", one, other)
    near("half the step", one.capacity, other.capacity, within, 1.0)


@relation("sla", decks("mesh", material=MASONRY), 1e-6)
def a_mesh_of_another_scale(deck: Deck, within: float) -> None:
    """The stiffness of a plane wall does not depend on its size."""
    found = []
    for factor in (1.0, 2.0):
        with tempfile.TemporaryDirectory() as name:
            (Path(name) / "wall.inp").write_text(MESH)
            made = changed(deck, structure={"scale": deck["structure"]["scale"] * factor})
            found.append(ask(made, "sla", Path(name), events=5))
    same("scaled", *found)
    ok(*found)
    near("stiffness", found[0].results.initial_stiffness_N_m, found[1].results.initial_stiffness_N_m, within)


@relation("motion", st.tuples(pulses(), number(0.2, 3.0)), 1e-6)
def measures_in_proportion(motion: Deck, factor: float, within: float) -> None:
    """A doubled motion has doubled peaks and four times the Arias intensity; a reversed motion has the same values."""
    with tempfile.TemporaryDirectory() as name:
        time = np.arange(0.0, 4.0, 0.01)
        wave = float(motion["amplitude"].split()[0]) * np.sin(2.0 * np.pi * time / motion["period"]) * np.exp(-time)
        record = recorded(Path(name), 0.01, wave)
        one, other, back = (ask({"motion": {**record, "scale": f}}, "motion", Path(name)) for f in (1.0, factor, -1.0))
    ok(one, other, back)
    for key, power in (("pga_g", 1), ("pgv_m_s", 1), ("arias_m_s", 2)):
        near(key, getattr(one.results, key) * factor**power, getattr(other.results, key), within)
        near(key, getattr(one.results, key), getattr(back.results, key), within)
    near("PGA", one.results.pga_g, np.abs(wave).max(), within)
    near("Arias", one.results.arias_m_s, np.pi / 2.0 * GRAVITY * np.trapezoid(wave**2, dx=0.01), 2e-3)


PIERS = st.tuples(number(0.8, 3.0), number(2.0, 4.0), number(0.2, 0.6), number(1e4, 3e5), number(0.5, 3.0))


@relation("code-checks", PIERS, 1e-6)
def strengths_of_piers_in_proportion(width: float, height: float, thickness: float, load: float, factor: float, within: float) -> None:
    """Forces and strengths multiplied by f give capacities multiplied by f, and so do thickness and force."""
    strengths = {"compressive_strength": 4e6, "tensile_strength": 1e5, "fracture_energy": 50.0, "density": 0.0}

    def pier(thick: float, f: float, force: float) -> Answer:
        material = {k: v * f for k, v in strengths.items()}
        return ask(
            {
                "structure": {"kind": "panel", "width": width, "height": height, "thickness": thick},
                "material": material,
                "joints": {"cohesion": 1e5 * f, "friction": 0.4},
            },
            "code-checks",
            axial_load=force,
        )

    one, other, thick = (pier(thickness, 1.0, load), pier(thickness, factor, load * factor), pier(thickness * factor, 1.0, load * factor))
    ok(one, other, thick)
    for name, check in one.results.checks.items():
        must((check.capacity is None) == (thick.results.checks[name].capacity is None), f"{name}: applies to one pier alone")
        if check.unit == "N" and check.capacity is not None:
            near(name, check.capacity * factor, thick.results.checks[name].capacity, within, 1.0)
            if "ASCE" not in check.code and "psi" not in check.source:
                near(name, check.capacity * factor, other.results.checks[name].capacity, 0.05, 1.0)


@relation("supports", st.tuples(decks("arch", "pointed-arch", "elliptical-arch"), SCALES), 1e-3)
def spreading_supports_of_another_size(deck: Deck, factor: float, within: float) -> None:
    """The movement of supports at collapse is proportional to the size of the arch."""
    one, other = ask(deck, "supports", steps=50), ask(scaled(deck, factor), "supports", steps=50)
    same("scaled", one, other)
    ok(one, other)
    a, b = one.results.movement_at_fall_m, other.results.movement_at_fall_m
    must((a is None) == (b is None), f"{a} against {b}")
    if a is not None:
        near("movement", a * factor, b, within)
        near("over the span", one.results.movement_at_fall_over_span, other.results.movement_at_fall_over_span, within)
