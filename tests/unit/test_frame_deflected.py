"""Walls out of their planes as chains of macro-elements: critical loads, rigid mechanisms, and walls of a plan."""

import itertools
from dataclasses import fields, replace

import numpy as np
import pytest
from scipy.optimize import minimize_scalar

import extrados
from extrados.analyses.frame.deflected import At, Chain, Piece
from extrados.core.frame import Frame, section_forces
from extrados.results.frame import FramePushover, WallDeflection
from extrados.schema.constants import GRAVITY

DENSITY, YOUNG = 1800.0, 1e9


def chain(count, tall, thick, actions=(), density=DENSITY, young=YOUNG, strength=1e30, **keys):
    """A wall of 1 m length in equal pieces."""
    cuts = np.linspace(0.0, tall, count + 1)
    pieces = [Piece(a, b, 1.0, thick, density, young, 0.2, strength) for a, b in itertools.pairwise(cuts.tolist())]
    return Chain(pieces, actions, **keys)


@pytest.mark.parametrize("eccentricity", [0.06, 0.1])
def test_critical_load_of_a_column_without_tension_by_closed_form(eccentricity):
    """A pinned column of height 2 h under an eccentric load, cracked at all heights, and its symmetric half.

    From u'' = 4 P/(9 E b u^2) of the distance u of the load from the compressed edge: P h^2/(E b) = 9/4 u1 (sqrt(u0 (u0 - u1)) + u1
    asinh sqrt(u0/u1 - 1))^2, u1 at mid-height; at most 9/4 * 0.700 u0^3 (Angervo 1954, Yokel 1971). Second order in the length of
    pieces.
    """
    thick, half = 0.3, 2.5
    u0 = 0.5 * thick - eccentricity

    def load(u1):
        return 9.0 / 4.0 * YOUNG / half**2 * u1 * (np.sqrt(u0 * (u0 - u1)) + u1 * np.arcsinh(np.sqrt(u0 / u1 - 1.0))) ** 2

    exact = -minimize_scalar(lambda u1: -load(u1), bounds=(0.05 * u0, 0.99 * u0), method="bounded").fun
    assert exact == pytest.approx(9.0 / 4.0 * 0.700 * YOUNG * u0**3 / half**2, rel=1e-3)
    errors = []
    for count in (4, 8):
        own = chain(count, half, thick, density=0.0)
        own.elements = [replace(e, shear_stiffness=1e15) for e in own.elements]  # bends alone
        u, w, turn = own.freedoms[-1]
        pattern, control = np.zeros(len(own.weight)), np.zeros(len(own.weight))
        pattern[[w, turn]], control[u] = [-1.0, eccentricity], -1.0
        with own.core() as core:
            errors.append(float(core.push(pattern, control, 0.5 * thick, 200, 0.8).multiple.max()) / exact - 1.0)
    assert errors[1] == pytest.approx(0.003, abs=1e-3) and errors[0] / errors[1] == pytest.approx(4.0, rel=0.1)


@pytest.mark.parametrize("load, held", [(0.0, False), (20e3, False), (20e3, True)])
def test_a_stiff_wall_is_a_rigid_mechanism(load, held):
    """A free wall: (W/2 + P) t/2 = alpha (W/2 + P) h of a mass on top. A wall held on top, its load in the middle plane and its top free to
    turn: hinges at the foot and, opposite, at x above it; alpha W x/2 = W t + P t (1 + x/(2 (h - x)))."""
    tall, thick = 3.0, 0.3
    own = DENSITY * GRAVITY * tall * thick
    alpha, moved, height, falls = chain(8, tall, thick, [At(tall, load, held=held)], young=1e11).limit()
    if held:
        x = tall * np.arange(1, 8) / 8
        exact = float(np.min(2.0 * thick / x * (1.0 + load / own * (1.0 + x / (2.0 * (tall - x))))))
        assert 0.5 * tall < height < tall
    else:
        exact = (own + load) * 0.5 * thick / (0.5 * own + load) / tall
        assert height == tall
    assert 0.96 * exact < alpha < exact and falls and moved < 0.1 * thick


def test_crushing_sets_the_hinge_back():
    """N acts at half the stress block from the edge: alpha = (t - N/(f b))/h of a stiff wall."""
    tall, thick, strength = 3.0, 0.3, 0.3e6
    block = DENSITY * GRAVITY * tall * thick / strength
    alpha = chain(8, tall, thick, young=1e11, strength=strength).limit()[0]
    assert alpha == pytest.approx((thick - block) / tall, rel=0.03)


def test_deflection_and_three_sections():
    """A soft wall carries less, by first order more; three sections instead of five change little."""
    soft = chain(8, 3.0, 0.3, young=1e8)
    alpha = soft.limit()[0]
    assert alpha < 0.7 * 0.1
    assert chain(8, 3.0, 0.3, young=1e8, sections=3).limit()[0] == pytest.approx(alpha, rel=0.01)
    assert chain(8, 3.0, 0.3, young=1e8, second_order=False).limit()[0] > 1.3 * alpha


def test_uniform_crushing_counts_once():
    """Both edges counted the deficit of a section at uniform strain: no force at twice the yield strain."""
    force, _, after = section_forces([2.0, 0.4, 1.5e9, 3e6, 1e-12], [4e-3, 0.0])
    assert force == pytest.approx([3e6 * 0.8, 0.0], abs=1e-3) and after[:2].tolist() == [1.0, 2.0]
    force, _, _ = section_forces([2.0, 0.4, 1.5e9, 3e6, 1e-12], [2e-3, 0.0], after)
    assert force == pytest.approx([0.5 * 3e6 * 0.8, 0.0], abs=1.0)


def deck(kind, **material):
    names = ["south", "east", "north", "west"]
    corners = [[0, 0], [6, 0], [6, 4], [0, 4]]
    walls = [{"name": n, "start": corners[k], "end": corners[(k + 1) % 4], "thickness": 0.4} for k, n in enumerate(names)]
    walls[0]["openings"] = [{"storey": 1, "x": [2, 3], "z": [0, 2.2]}]
    soft = {"young": 50e6, "thickness": 0.05} if kind == "flexible" else {}
    floors = [{"storey": k, "kind": kind, "load": 3e3, "bears_on": ["south", "north"], **soft} for k in (1, 2)]
    return {
        "structure": {"kind": "building", "storeys": [3.0, 2.8], "walls": walls, "floors": floors},
        "material": {"density": 1800.0, "young": 1.5e9, "poisson": 0.25, **material},
        "joints": {"cohesion": 1e5},
        "analysis": [{"kind": "frame-pushover", "eccentricities": [0.0], "directions": [0.0]}],
    }


def walls_of(data):
    (analysis,) = extrados.run(data, threads=1).analyses
    return analysis["results"]["walls_out_of_plane"], analysis


def test_walls_of_a_plan_out_of_their_planes():
    """Without rigid floors stiff walls approach their rigid mechanism from below; rigid floors hold them between storeys."""
    for young, least in ((1.5e9, 0.6), (200e9, 0.93)):
        rows, analysis = walls_of(deck("flexible", young=young))
        assert len(rows) == 4 and [r["acceleration_g"] for r in rows] == sorted(r["acceleration_g"] for r in rows)
        for row in rows:
            assert least * row["rigid_acceleration_g"] < row["acceleration_g"] < row["rigid_acceleration_g"] and not row["held_at_m"]
        assert "fails first" in analysis["answer"]
    held, _ = walls_of(deck("rigid", compressive_strength=3e6))
    assert all(row["rigid_acceleration_g"] is None and row["held_at_m"] == [3.0, 5.8] for row in held)
    rigid = 2.0 * 0.4 / 2.8  # a wall without load that is held on top: its hinge is there, W t = alpha W h/2
    assert 0.9 * rigid < held[0]["acceleration_g"] < 1.05 * rigid and 4.4 < held[0]["height_m"] < 5.8


@pytest.mark.parametrize("reached, then", [(True, "the wall fails first"), (False, "either may fail first")])
def test_a_lower_bound_of_a_wall_does_not_decide_what_fails_first(reached, then):
    """A wall whose acceleration still increases may carry more than the frame."""
    wall = WallDeflection.model_construct(wall="south", acceleration_g=0.1, reached=reached, deflection_m=0.01, height_m=2.0)
    result = FramePushover.model_construct(walls_out_of_plane=[wall], base_shear_N=2e5, weight_N=1e6)
    assert result.weakest_wall().endswith(f"(0.2), so {then}.")


def test_a_rigid_floor_on_a_seat_restrains_no_wall():
    """Friction alone holds such a floor: walls carry what they carry below a flexible floor, by both analyses."""
    found = []
    for kind, seat in (("rigid", True), ("flexible", False), ("rigid", False)):
        data = deck(kind)
        if seat:
            for floor in data["structure"]["floors"]:
                floor["seat"] = {"length": 0.12, "friction": 0.4}
        data["analysis"].append({"kind": "local-mechanism", "mechanism": "building"})
        frame, local = extrados.run(data, threads=1).analyses
        rows = frame["results"]["walls_out_of_plane"]
        found.append(({r["wall"]: (r["acceleration_g"], r["held_at_m"]) for r in rows}, local["results"].get("multiplier")))
        assert not seat or "The floor restrains no wall out of its plane" in "".join(frame["results"]["remarks"])
        assert not seat or "floors with a seat do not" in local["answer"]
    assert found[0] == found[1] and found[2][1] is None and all(held for _, held in found[2][0].values())


def test_a_wall_without_a_rigid_mechanism_leaves_the_pushovers_as_they_are():
    """The weight presses wall 'south' with more than 0.75 of its strength: the multiplier is null, with the reason."""
    data = deck("flexible", compressive_strength=0.2e6)
    rows, analysis = walls_of(data)
    assert [row["wall"] for row in rows if row["rigid_acceleration_g"] is None] == ["south"]
    assert any("wall 'south'" in text and "0.75 of the compressive strength" in text for text in analysis["warnings"])
    data["analysis"][0]["deflected_walls"] = False
    (alone,) = extrados.run(data, threads=1).analyses
    assert alone["results"]["runs"] == analysis["results"]["runs"]


def test_a_curve_without_displacement_has_no_stiffness(monkeypatch):
    """No step of the push is in equilibrium, as of piers that the weight crushes almost: 0/0 was NaN."""
    push = Frame.push

    def first(*args):
        path = push(*args)
        kept = {f.name: value[:1] for f in fields(path) if isinstance(value := getattr(path, f.name), np.ndarray)}
        return replace(path, stop="no equilibrium even with the smallest step", **kept)

    monkeypatch.setattr(Frame, "push", first)
    data = deck("flexible")
    data["analysis"][0]["deflected_walls"] = False
    (analysis,) = extrados.run(data, threads=1).analyses
    runs = analysis["results"]["runs"]
    assert analysis["status"] == "ok" and runs and all(row["stiffness_N_m"] is None for row in runs)
    assert sum("no stiffness" in text for text in analysis["warnings"]) == len(runs)


def test_a_soft_wall_carries_with_its_deflection_less_than_as_a_rigid_body():
    """Both have the same hinge: a block of 0.85 f carried 13 % more than the rigid wall at 0.3 MPa."""
    rows, _ = walls_of(deck("flexible", compressive_strength=0.3e6, young=200e9))
    for row in rows:
        assert 0.98 * row["rigid_acceleration_g"] < row["acceleration_g"] < row["rigid_acceleration_g"]
