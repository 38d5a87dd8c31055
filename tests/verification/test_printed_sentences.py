"""Sentences of the dissertation that no single number of a case can hold: sequences of events, hinges over time, histories beside each other."""

import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from beam_oracle import follow_beam

import extrados

CASES = Path(__file__).resolve().parents[2] / "cases"


def deck_of(case: str) -> dict[str, Any]:
    return tomllib.loads((CASES / f"{case}.toml").read_text(encoding="utf-8"))


def array(run: Any, analysis: str, name: str) -> np.ndarray:
    return np.asarray(run.arrays[analysis][name].data)


@pytest.mark.verify
@pytest.mark.parametrize("prestress", [-1e6, 0.0, 1e6])
def test_every_event_of_the_prestressed_beam(prestress: float) -> None:
    """4.3.1: multiplier, equilibrium and deflection of all events agree with a script apart from the program, for all three beams."""
    data = deck_of("sla/beam")
    for load in data["analysis"][0]["constant"]:
        load["value"] = -prestress
    run, course = extrados.run(data), follow_beam(0.11, prestress)
    equilibrium = array(run, "sla", "event_equilibrium").astype(bool)
    count = min(len(equilibrium), len(course.equilibrium)) - 1  # the last event is that of a mechanism
    assert count > 230 and abs(len(equilibrium) - len(course.equilibrium)) <= 1
    np.testing.assert_array_equal(equilibrium[:count], course.equilibrium[:count])
    last = np.flatnonzero(course.equilibrium[:count])[-1] + 1  # beyond it the column is nearly torn
    load = array(run, "sla", "event_load")[:last]
    np.testing.assert_allclose(load, 1000.0 * course.multiplier[:last], rtol=2e-3, atol=5.0)


@pytest.mark.verify
def test_cycles_162_163_and_218_of_figures_4_5_and_4_6() -> None:
    """4.3.1: equilibrium at cycle 162, none at 163 and 218, for every depth from 106 to 120 mm.

    The text adds that the model never reaches equilibrium again. By its own rule (Fig. 4-3) it does at 34 later events, the last of
    them 204, under loads upward of 0.9 to 2.2 kN that move the line of the prestress to the ligament that is left.
    """
    for depth in (0.106, 0.11, 0.115, 0.12):
        course = follow_beam(depth, 1e6)
        assert [bool(course.equilibrium[k - 1]) for k in (162, 163, 218)] == [True, False, False]
        assert course.equilibrium[:162].all()
        again = np.flatnonzero(course.equilibrium[163:]) + 164
        assert (len(again), again[-1]) == (34, 204) and (course.multiplier[again - 1] < -0.75).all()


def test_hinges_of_the_arch_by_elements() -> None:
    """7.2.2, Fig. 7-8: beside the four hinges of the mechanism the second lies elsewhere at 0.20 s, one at 0.80 s and one at 1.30 s;
    at 1.10 s all are the same. (At 0.50 s the text has all the same; here the first lies one joint inside the springing.)"""
    data = deck_of("dem/oppenheim")
    data["joints"] |= {"normal_stiffness": 1e12, "beta": 1.59e-4}
    data["analysis"] = [data["analysis"][0] | {"mass_damping": 6.28e-5, "perturbed": False}]
    run = extrados.run(data)
    time, width = array(run, "dem", "time"), [array(run, "dem", f"opening_{end}") for end in "pq"]
    found = {}
    for t in (0.2, 0.5, 0.8, 1.1, 1.3):
        opening = np.maximum(*(w[int(np.argmin(np.abs(time - t)))] for w in width))
        found[t] = sorted(np.argsort(opening)[-4:].tolist())
    first, second = [0, 3, 5, 7], [0, 2, 4, 7]  # the mechanism and its mirror image
    assert found[0.2] == [0, 2, 5, 7] and found[0.5] == [1, 3, 5, 7]
    assert found[0.8] == [0, 2, 5, 7] and found[1.1] == second and found[1.3] == [0, 2, 4, 6]
    assert all(len(set(found[t]) & set(first if t < 0.6 else second)) >= 3 for t in found)


def test_damping_of_the_block_on_the_table() -> None:
    """7.4.1, Fig. 7-21: X, Y and Z give nearly the same history, Z1 a similar one, Z2 is farthest, bounces most.

    Under smooth harmonic motion its deviation is 8 % of the motion; the recorded motion of the table is not published.
    """
    data = deck_of("dem/thesis-block")
    analysis = {k: v for k, v in data["analysis"][2].items() if not k.startswith("vary")} | {"perturbed": False}
    histories, bounces = {}, []
    for name, factor in (("X", 3.368), ("Y", 1.414), ("Z", 1.0), ("Z1", 0.5), ("Z2", 0.25)):
        run = extrados.run({**data, "analysis": [analysis], "joints": data["joints"] | {"beta": 4e-4 * factor}})
        histories[name] = array(run, "dem", "rotation").ravel()
        bounces.append(run["dem"].bounces)
    motion = np.sqrt(np.mean(histories["Z"] ** 2))
    away = {name: np.sqrt(np.mean((h - histories["Z"]) ** 2)) / motion for name, h in histories.items()}
    assert away["Y"] < 0.01 and away["X"] < 0.02 and away["Z1"] < 0.03 < 0.06 < away["Z2"] < 0.1
    assert bounces == sorted(bounces) and bounces[0] == 0


@pytest.mark.verify
@pytest.mark.parametrize("radius", [0.0, 0.02, 0.1])
def test_worn_corners_do_not_overturn_the_under_damped_block(radius: float) -> None:
    """7.2.1, Figs 7-5 and 7-6: the text has the least damped block and the softest joints overturn; neither does here in 20 s, with
    sharp corners or with worn ones (a quarter circle as two chords)."""
    data = deck_of("dem/block-sweeps")
    analysis = {k: v for k, v in data["analysis"][0].items() if not k.startswith("vary")}
    data["analysis"] = [analysis | {"perturbed": False, "end_time": 20.0}]
    if radius:
        c, s = radius, radius * (1.0 - np.sqrt(0.5))
        foot = [[c, 0.0], [1.0 - c, 0.0], [1.0 - s, s], [1.0, c], [1.0, 4.0], [0.0, 4.0], [0.0, c], [s, s]]
        data["structure"] = {"kind": "blocks", "block": [{"name": "block", "points": foot}]}
    for stiffness, beta in ((1e12, 6.37e-6), (5e10, 1.59e-4)):
        found = extrados.run({**data, "joints": data["joints"] | {"normal_stiffness": stiffness, "beta": beta}})["dem"]
        assert found.outcome == "rocked" and found.bounces > 200 and found.peak_slip_m < 0.03


@pytest.mark.verify
def test_the_buttressed_vault_collapses_in_the_printed_order() -> None:
    """7.2.3: both buttresses tilt slightly to the left, both to the right, the left one to the left, the arch collapses while both lean
    outward, both recover."""
    data = deck_of("vault/pulses")
    data["analysis"] = [data["analysis"][0]]
    run = extrados.run(data)
    time, rotation = array(run, "dem", "time"), np.degrees(array(run, "dem", "rotation"))
    at = lambda t: rotation[int(np.argmin(np.abs(time - t)))]  # noqa: E731
    names = array(run, "dem", "block_name").astype(str).tolist()
    left, right = names.index("left buttress"), names.index("right buttress")
    assert at(0.31)[left] < -0.5 > at(0.31)[right]
    assert at(1.5)[left] > 0.2 < at(1.5)[right]
    assert run["dem"].collapse_time_s == pytest.approx(2.54, abs=0.1)
    assert at(2.5)[left] < -0.5 and at(2.5)[right] > 3.0
    assert at(4.9)[right] < 0.0  # back through the vertical: the critical rotation of 12.5 degrees is never near
    assert rotation[:, right].max() < 7.0
