"""Thrust networks: closed forms, thrust lines of the plane, limit analysis of solids, equilibrium by a peer."""

import numpy as np
import pytest

import extrados
from extrados.analyses.assess.hazard import Demanded
from extrados.analyses.limit.thrust_network import words_of
from extrados.limit.network import Diagram, ThrustNetworks
from extrados.results.networks import ThrustNetwork

BARREL = {"kind": "arch", "radius": 5.0, "thickness": 0.8, "embrace": 120.0, "voussoirs": 31, "depth": 0.2}
STILL = Demanded(None, "", 0.0, 0.0)
DOME = {"kind": "dome", "radius": 5.0, "thickness": 0.5, "rings": 5, "lunes": 8}


def _flat(branches: int, reach: float) -> Diagram:
    """A flat arch: 10 m, .5 m deep, 2 kN/m, on beds that end `reach` inside and outside of its ends at the soffit."""
    x = np.linspace(0.0, 10.0, branches + 1)
    weight = np.full(branches + 1, 2e4 / branches)
    weight[[0, -1]] *= 0.5
    along = np.arange(branches)
    high = np.full(2 * branches + 1, 0.5)
    bed = np.array([[-reach, 0.0], [reach, 0.0]])
    return Diagram(
        np.column_stack([x, 0.0 * x]),
        np.column_stack([along, along + 1]),
        along,
        0.0 * high,
        high,
        np.zeros(2 * branches + 1, dtype=bool),
        weight,
        np.array([0, branches]),
        np.array([[-1.0, 0.0], [1.0, 0.0]]),
        np.array([bed, bed]),
    )


@pytest.mark.parametrize("branches", [4, 10])
def test_flat_arch_rises_through_its_depth(branches) -> None:
    """Least thrust w L^2 / 8 d at either end."""
    found = ThrustNetworks(_flat(branches, 5.0)).extreme("least")
    exact = 2.0 * 2e3 * 100.0 / 8.0 / 0.5
    assert found.value == pytest.approx(exact, rel=1e-6)
    assert found.bound == pytest.approx(exact, rel=1e-6)
    assert found.network is not None
    assert found.network.residual < 1e-9


def test_barrel_is_its_thrust_line() -> None:
    """Slices with upright sides in place of voussoirs: 2 %; the network lies within the thickness."""
    run = extrados.run({"structure": BARREL, "analysis": [{"kind": "thrust-network", "lines": 20}, {"kind": "thrust"}]})
    network, line = (run.analyses[k]["results"] for k in range(2))
    assert network["least_thrust_N"] == pytest.approx(2.0 * line["least"]["horizontal_N"], rel=0.02)
    assert network["greatest_thrust_N"] == pytest.approx(2.0 * line["most"]["horizontal_N"], rel=0.01)
    for end in ("least", "greatest"):
        assert network[f"{end}_thrust_N"] == pytest.approx(network[f"{end}_thrust_bound_N"], rel=1e-6)
    assert network["equilibrium_residual"] < 1e-9
    assert max(network[f"{which}_outside_m"] for which in ("central", "least", "greatest", "horizontal")) < 0.008
    assert not run.analyses[0]["warnings"]


def test_dome_lies_between_its_bounds_and_turns_with_its_load() -> None:
    """The bounds enclose what is found; networks lie between the surfaces; a dome of equal meridians has no direction."""
    analysis = {"kind": "thrust-network", "lines": 4, "meridians": 8}
    run = extrados.run({"structure": DOME, "analysis": [analysis, {**analysis, "direction": 90.0}]})
    r = run.analyses[0]["results"]
    assert r["least_thrust_bound_N"] <= r["least_thrust_N"] * (1.0 + 1e-6)
    assert r["least_thrust_N"] < r["central_thrust_N"] < r["greatest_thrust_N"] <= r["greatest_thrust_bound_N"] * (1.0 + 1e-6)
    assert r["least_part_bound"] <= r["least_part_of_depth"] < 1.0
    assert 0.0 < r["horizontal_load_g"] <= r["horizontal_load_bound_g"] * (1.0 + 1e-6)
    assert run.analyses[1]["results"]["horizontal_load_bound_g"] == pytest.approx(r["horizontal_load_bound_g"], rel=1e-6)
    arrays = run.arrays["thrust-network"]
    first, second = arrays["network_branch"].numbers.T
    weight = arrays["network_weight"].numbers
    free = np.setdiff1d(np.arange(len(weight)), arrays["network_support"].numbers)
    for which in ("least", "central", "greatest"):
        z, q = arrays[f"{which}_height"].numbers, arrays[f"{which}_density"].numbers
        low, high = arrays["network_low"].numbers, arrays["network_high"].numbers
        inner = free[np.linalg.norm(arrays["network_point"].numbers[free], axis=1) < 4.7]  # the others lie over the bed
        assert (z[inner] >= low[inner] - 1e-5).all()
        assert (z[inner] <= high[inner] + 1e-5).all()
        assert (q >= -1e-9 * q.max()).all()
        place = np.column_stack([arrays["network_point"].numbers, z])
        force = q[:, None] * (place[first] - place[second])
        sums = np.zeros_like(place)  # sum of the compression of all branches at each node [N]
        np.add.at(sums, first, force)
        np.add.at(sums, second, -force)
        assert sums[free] == pytest.approx(np.column_stack([np.zeros((len(free), 2)), weight[free]]), abs=1e-6 * weight.sum())


def test_thinner_dome_is_less_safe_until_no_network_fits() -> None:
    """A hemisphere of 3 % of its radius holds no network: about 4 % are required (Heyman 1967)."""
    runs = [
        extrados.run({"structure": {**DOME, "thickness": t}, "analysis": {"kind": "thrust-network", "lines": 5, "meridians": 8}})
        for t in (0.5, 0.3, 0.15)
    ]
    parts = [run.analyses[0]["results"].get("least_part_of_depth", np.inf) for run in runs]
    assert parts[0] < parts[1] < 1.0 < parts[2]
    assert runs[2].analyses[0]["results"].get("least_thrust_N") is None


def test_barrel_refuses_a_radial_diagram() -> None:
    """Its supports are not all around."""
    run = extrados.run({"structure": BARREL, "analysis": {"kind": "thrust-network", "form": "radial"}})
    assert run.analyses[0]["status"] == "refused"
    assert "form" in run.analyses[0]["reason"]


def test_joints_that_may_slide_leave_the_verdict_open() -> None:
    """With friction .04 this arch cannot stand, by `tilt`: .094 is required."""
    run = extrados.run(
        {
            "structure": BARREL,
            "joints": {"friction": 0.04},
            "analysis": [
                {"kind": "thrust-network", "lines": 6},
                {"kind": "tilt"},
                {"kind": "thrust-network", "lines": 6, "joints": {"friction": "no-sliding"}},
            ],
        }
    )
    slides, tilt, held = (one["verdict"] for one in run.analyses)
    assert [slides["outcome"], tilt["outcome"], held["outcome"]] == ["open", "cannot-stand", "stands"]
    assert slides["violated"] == ["Sliding of the joints is not checked (coefficient of friction 0.04)."]
    assert held["violated"] == []


def _results(**keys) -> ThrustNetwork:
    found = {
        "form": "grid",
        "nodes": 9,
        "branches": 9,
        "supports": 4,
        "least_thrust_N": 1e3,
        "least_thrust_bound_N": 1e3,
        "greatest_thrust_N": 2e3,
        "greatest_thrust_bound_N": 2e3,
        "central_thrust_N": 1.5e3,
        "least_part_of_depth": 0.5,
        "least_part_bound": 0.5,
        "vertical_safety_factor": 2.0,
        "load_direction_deg": 0.0,
        "horizontal_load_g": 0.2,
        "horizontal_load_bound_g": 0.3,
        "weight_N": 1e4,
        "equilibrium_residual": 0.0,
        "thickness_m": 0.5,
        "central_outside_m": 0.0,
        "least_outside_m": 0.0,
        "greatest_outside_m": 0.0,
        "horizontal_outside_m": 0.0,
        "least_friction": None,
    }
    return ThrustNetwork(**{**found, **keys})


@pytest.mark.parametrize(
    ("load", "bound", "words"),
    [
        (
            None,
            0.3,
            "no network was found that carries a horizontal load. This does not prove a limit: the upper bound for this form diagram is 0.3",
        ),
        (
            0.0,
            0.3,
            "no network was found that carries a horizontal load. This does not prove a limit: the upper bound for this form diagram is 0.3",
        ),
        (None, None, "No upper limit of the horizontal load was found"),
        (0.0, 1e-9, "networks on this form diagram carry no horizontal load"),
        (None, 0.0, "networks on this form diagram carry no horizontal load"),
        (0.2, 0.3, "0.2 (bound for this form diagram: 0.3) times the weight, if the load acts at the nodes"),
    ],
)
def test_words_of_the_horizontal_load(load, bound, words) -> None:
    """A bound of 0 proves that none is carried, a failed search does not; a value has the condition of its loads."""
    assert words in words_of(_results(horizontal_load_g=load, horizontal_load_bound_g=bound))


def test_horizontal_load_of_a_network_is_above_that_of_tilt() -> None:
    """Its loads act at the nodes: the answer gives the condition and by how much such values were too high."""
    run = extrados.run(
        {"structure": BARREL, "joints": {"friction": "no-sliding"}, "analysis": [{"kind": "thrust-network", "lines": 20}, {"kind": "tilt"}]}
    )
    network, tilt = (run.analyses[k]["results"] for k in range(2))
    assert 1.0 < network["horizontal_load_g"] / tilt["collapse_acceleration_g"] < 1.08
    assert "1 to 7 % above the collapse acceleration by `tilt`" in run.analyses[0]["answer"]


def test_networks_that_leave_the_blocks_are_named() -> None:
    """Each network has its own distance; chords of eight meridians leave the blocks, those of the most central network do not."""
    analysis = {"kind": "thrust-network", "lines": 4, "meridians": 8}
    one = extrados.run({"structure": DOME, "joints": {"friction": "no-sliding"}, "analysis": analysis}).analyses[0]
    r = one["results"]
    about = {"central": "most central network", "greatest": "network of greatest thrust"}
    for which, words in about.items():
        assert any(words in text for text in one["warnings"]) == (r[f"{which}_outside_m"] > 0.01 * r["thickness_m"])
    assert r["central_outside_m"] < 0.005 < 0.03 < r["greatest_outside_m"]
    assert r["thickness_m"] == pytest.approx(0.5, rel=0.05)
    assert one["verdict"]["outcome"] == "stands"


def test_a_central_network_outside_the_blocks_leaves_the_verdict_open() -> None:
    """One part in a hundred of the thickness counts."""
    for outside, outcome in ((0.004, "stands"), (0.006, "open")):
        verdict = _results(central_outside_m=outside).judged(STILL)
        assert verdict.outcome == outcome
        assert ("pass outside the blocks by up to 6 mm" in verdict.statement) == (outcome == "open")


@pytest.mark.parametrize(("lines", "leaves"), [(6, True), (20, False)])
def test_branches_to_the_supports_are_compared_too(lines, leaves) -> None:
    """Six branches of a barrel under its greatest horizontal load pass beside its haunch."""
    run = extrados.run({"structure": BARREL, "analysis": {"kind": "thrust-network", "lines": lines}})
    assert (run.analyses[0]["results"]["horizontal_outside_m"] > 0.05) == leaves


def test_oculus_is_free_and_other_openings_name_the_cure() -> None:
    """The networks around an oculus lie within the thrusts of the blocks; a grid across it is refused."""
    deck = {"structure": {**DOME, "thickness": 0.6, "oculus": 30.0}}
    asked = [{"kind": "thrust-network", "lines": 4, "meridians": 8}, {"kind": "thrust-network", "form": "grid", "lines": 4}]
    run = extrados.run({**deck, "analysis": [*asked, {"kind": "thrust", "section": [{"name": "foot", "joints": ["ground"]}]}]})
    r, blocks = run["thrust-network"], run["thrust"]["sections"][0]
    assert blocks["least_N"] < r["least_thrust_N"] < r["greatest_thrust_N"] < blocks["greatest_N"]
    refused = run.analyses[1]
    assert refused["status"] == "refused"
    assert "use `thrust`" in refused["reason"]
