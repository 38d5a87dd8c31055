"""Water beside a structure: the pressure by hand, critical levels of a block, limit analysis, energy, refusals."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from dem_models import G, model, rectangle

import extrados
from extrados.analyses.context import Context, Refused
from extrados.analyses.dem import driver
from extrados.analyses.dem.solid_model import wet_section
from extrados.analyses.sequence import run_one
from extrados.core import dem, dem3
from extrados.decks.reader import make_deck
from extrados.limit.errors import CannotStand, NoAnswer
from extrados.limit.loads import tilt_loads
from extrados.limit.programme import LimitAnalysis
from extrados.model.geometry.water import water_pressure
from extrados.results.typed import typed
from extrados.show.limit.self_weight import draw_self_weight
from extrados.views.building import Building

WIDTH, HEIGHT, DENSITY = 1.0, 3.0, 2400.0
#: Of the water pressure at the wet end of a joint, times its length: force, and its moment about the dry end over the length
UPLIFT = {"none": (0.0, 0.0), "linear": (1 / 2, 1 / 3), "full": (1.0, 1 / 2)}
#: A dam of three courses with a vertical wet face at x = 0, which narrows from 3 m by 0.4 m per metre of height
COURSES = [[[0, y], [3 - 0.4 * y, y], [2.4 - 0.4 * y, y + 1.5], [0, y + 1.5]] for y in (0.0, 1.5, 3.0)]


def critical_level(uplift: str, friction: float) -> float:
    """Level [m] at which water overturns a block or makes it slide, by the equilibrium of forces and moments."""
    share, lever = UPLIFT[uplift]
    weight = DENSITY * WIDTH * HEIGHT
    overturns = np.roots([1000 / 6, 0.0, 1000 * lever * WIDTH**2, -weight * WIDTH / 2])
    slides = np.roots([500, 1000 * friction * share * WIDTH, -friction * weight])
    return float(min(x.real for x in (*overturns, *slides) if abs(x.imag) < 1e-9 and x.real > 0.0))


def ask(structure: dict[str, Any], water: dict[str, Any], friction: float = 0.9, **keys: Any) -> Any:
    analysis = {"kind": "dem", "end_time": 0.3, "perturbed": False, "water": water, **keys}
    deck = {"structure": structure, "material": {"density": DENSITY, "young": "20 GPa"}, "joints": {"friction": friction}}
    return extrados.run({**deck, "analysis": analysis}).results[0]


def building(deck: dict[str, Any]) -> Building:
    return make_deck({**deck, "analysis": {"kind": "tilt"}}).building


def dam(side: float = 1.0, shift: float = 0.0) -> dict[str, Any]:
    points = [[[side * x + shift, y] for x, y in course] for course in COURSES]
    return {"kind": "blocks", "block": [{"name": f"course {k}", "points": one[:: int(side)]} for k, one in enumerate(points)]}


@pytest.mark.parametrize("space", [{}, {"direction": 0.0}], ids=["plane", "space"])
@pytest.mark.parametrize("solver", ["compliant", "nonsmooth"])
@pytest.mark.parametrize("uplift", list(UPLIFT))
@pytest.mark.parametrize("friction", [0.9, 0.4])
def test_a_block_stands_up_to_the_critical_level(uplift: str, friction: float, solver: str, space: dict[str, float]) -> None:
    """Overturning with friction 0.9, sliding with 0.4; springs and rigid contacts; limit analysis certifies the collapse; a depth of 0.7 m."""
    level = critical_level(uplift, friction)
    for ratio in (0.99, 1.01):
        there = {"kind": "block", "width": WIDTH, "height": HEIGHT, "depth": 0.7}
        found = ask(there, {"level": ratio * level, "uplift": uplift}, friction, solver=solver, **space)
        outcome = found.results.outcome if ratio < 1.0 else found.verdict.outcome
        assert outcome == ("at-rest" if ratio < 1.0 else "cannot-stand"), found
        assert any("water pressure is constant" in text for text in found.warnings)
        if ratio < 1.0:
            assert found.answer.startswith("The structure stands under its own weight and the water pressure. No motion acts on it.")
            assert ("kN upward" in found.answer) == (uplift != "none")
        else:
            statement = found.verdict.statement
            assert "it collapses under its own weight and the water pressure." in statement
            # also what discrete elements find
            assert statement.count("under its own weight and the water pressure") == 2 == statement.count("own weight")
            assert found.results.other_loads == "the water pressure" and typed("dem", found.results.as_json()) == found.results


@pytest.mark.parametrize("uplift", list(UPLIFT))
def test_limit_analysis_with_this_water_is_the_equilibrium_of_a_dam(uplift: str) -> None:
    """The acceleration towards +x, over the joints: the least by which the part above slides or overturns."""
    there = building({"structure": dam(), "material": {"density": DENSITY}, "joints": {"friction": 0.9}})
    assembly = there.blocks()
    share, lever = UPLIFT[uplift]
    least = []
    for y in (0.0, 1.5, 3.0):
        width, height, deep = 3 - 0.4 * y, 4.5 - y, 4.0 - y
        area = height * (width + 1.2) / 2
        x = height * (width**2 + 1.2 * width + 1.2**2) / 6 / area
        z = height**2 * (width + 2.4) / 6 / area
        weight, lift = DENSITY * area, 1000 * deep * width
        least += [(0.9 * (weight - share * lift) - 500 * deep**2) / weight]
        least += [(weight * (width - x) - 1000 * deep**3 / 6 - lever * lift * width) / (weight * z)]
    water = water_pressure(assembly, 4.0, "left", uplift, 1000.0)
    loads = tilt_loads(assembly)
    limit = LimitAnalysis(assembly, there.friction(), loads=replace(loads, dead=loads.dead + water.about_origin(3)))
    assert limit.collapse(1)[0].gamma == pytest.approx(min(least), rel=1e-5)


def test_the_pressure_on_slopes_steps_and_shaded_faces() -> None:
    """Water over a step and a sloping face presses by its depth and weighs what lies above them; a face behind a block is dry."""
    points = [[0, 0], [6, 0], [6, 1], [5, 1], [5, 2], [4, 2], [4, 1], [3, 1], [2, 4], [1, 1], [0, 1]]
    there = building({"structure": {"kind": "blocks", "block": [{"name": "one", "points": points}]}})
    water = water_pressure(there.blocks(), 3.0, "left", "none", 1000.0)
    # step of 1 m under 2 m of water, slope 1 : 3 under water
    down = 1000 * G * (1.0 * 2.0 + 2.0 * 2.0 / 3.0 / 2.0)
    assert water.force.sum(axis=0) == pytest.approx([1000 * G * 4.5, -down], rel=1e-9)
    mirrored = building({"structure": {"kind": "blocks", "block": [{"name": "one", "points": [[-x, y] for x, y in points[::-1]]}]}})
    other = water_pressure(mirrored.blocks(), 3.0, "right", "none", 1000.0).about_origin(1)
    assert other[0] == pytest.approx(water.about_origin(1)[0] * [-1.0, 1.0, -1.0], rel=1e-9)


def test_a_dam_in_its_mirror_image_and_moved_away_is_the_same() -> None:
    one, other = (
        ask(dam(side, shift), {"level": 4.0, "uplift": "linear", "side": name})
        for side, shift, name in ((1.0, 0.0, "left"), (-1.0, 50.0, "right"))
    )
    assert one.results.outcome == other.results.outcome == "at-rest"
    assert one.results.water_force_N == pytest.approx([1000 * G * 8.0, 1000 * G * 6.0], rel=1e-5)
    assert other.results.water_force_N == pytest.approx([-1000 * G * 8.0, 1000 * G * 6.0], rel=1e-5)


@pytest.mark.parametrize("solver", ["compliant", "nonsmooth"])
def test_a_dam_in_space_is_the_section(solver: str) -> None:
    """A depth of 0.7 m: sliding on the base towards +x, overturning about its wet edge towards -x, as by equilibrium and in the plane."""
    water, there = {"level": 4.0, "uplift": "linear"}, {**dam(), "depth": 0.7}
    plane, space = (ask(there, water, test="tilt", solver=solver, **keys).results for keys in ({}, {"direction": 0.0}))
    for one in (plane, space):
        assert one.water_force_N == pytest.approx([700 * G * 8.0, 700 * G * 6.0], rel=1e-5)
    for want, name in ((0.3092, "collapse_acceleration_g"), (0.6845, "collapse_acceleration_opposite_g")):
        assert getattr(space, name) == pytest.approx(want, abs=0.003)
        assert getattr(space, name) == pytest.approx(getattr(plane, name), abs=0.003)


def test_a_free_body_in_space_swings_under_a_constant_couple_at_its_frequency() -> None:
    """About each axis: omega^2 = the sums of arm times force along both other axes / inertia, and the energy balance closes."""
    corners = np.array([[x, y, z] for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])
    faces = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))
    extent, above = np.array([1.0, 1.4, 0.6]), np.array([0.0, 0.0, 5.0])
    mass, period, amplitude = 1000.0, 0.5, 0.01
    inertia = mass * ((2 * extent) ** 2).sum() / 12.0 - mass * (2 * extent) ** 2 / 12.0
    vertices = [corners * extent + above, corners * [2.0, 2.0, 0.5]]
    for axis in range(3):
        load = np.zeros((2, 4, 3))
        load[0, 1 + (axis + 1) % 3, (axis + 1) % 3] = inertia[axis] * (2 * np.pi / period) ** 2
        solids = dem3.Solids(
            np.array([above, np.zeros(3)]),
            np.array([mass, 0.0]),
            np.array([np.diag(inertia), np.eye(3)]),
            vertices,
            [faces, faces],
            [0, 1],
            [dem.Law(1e9, 1e9, 0.5)],
            load=load,
        )
        rate = np.zeros((2, 6))
        rate[0, 3 + axis] = amplitude * 2 * np.pi / period
        run = dem3.run(solids, dem3.Options(1.0, 0.01, step=1e-3, gravity=(0.0, 0.0, 0.0), fraction=1.0), rate=rate)
        angle = run.turn[:, 0, (axis + 2) % 3, (axis + 1) % 3]
        assert angle == pytest.approx(amplitude * np.sin(2 * np.pi * run.time / period), abs=2e-4)
        assert run.residual < 1e-4


def test_a_free_body_swings_under_a_constant_couple_at_its_frequency() -> None:
    """Forces whose places rotate with the body: omega^2 = sum of arm times force / inertia, and the energy balance closes."""
    bodies = model([rectangle(-0.5, 0.5, 5.0, 6.0)], [rectangle(-2.0, 2.0, -1.0, 0.0)], dem.Law(1e9, 1e9, 0.5))
    inertia, period = bodies.inertia[0], 0.5
    load = np.zeros((2, 4))
    load[0, 3] = inertia * (2 * np.pi / period) ** 2
    shift = np.zeros((2, 3))
    shift[0, 2] = 0.01
    options = dem.Options(1.0, 0.01, step=1e-3, gravity=(0.0, 0.0), fraction=1.0)
    run = dem.run(replace(bodies, load=load), options, shift=shift)
    assert run.place[:, 0, 2] == pytest.approx(0.01 * np.cos(2 * np.pi * run.time / period), abs=2e-4)
    assert run.residual < 1e-4


@pytest.mark.parametrize(
    ("structure", "water", "keys", "why"),
    [
        ({"kind": "block", "width": 1, "height": 3}, {"level": 3.5}, {}, "give a level within"),
        ({"kind": "block", "width": 1, "height": 3}, {"level": 1e-6, "uplift": "none"}, {}, "wets no face"),
        ({"kind": "block", "width": 1, "height": 3}, {"level": 3.5}, {"direction": 0.0}, "give a level within"),
        (
            {"kind": "column", "width": 1.0, "height": 3.0, "drums": 3, "section": "round"},
            {"level": 1.0},
            {"direction": 0.0},
            "requires a plane section",
        ),
        (
            {"kind": "arch", "radius": 5.0, "thickness": 0.8, "embrace": 150.0, "voussoirs": 9},
            {"level": 3.0, "uplift": "linear"},
            {},
            "requires a section without openings",
        ),
    ],
)
def test_water_is_refused_by_name(structure: dict[str, Any], water: dict[str, Any], keys: dict[str, Any], why: str) -> None:
    found = ask(structure, water, **keys)
    assert found.status == "refused" and why in found.reason, found


def test_the_figure_of_collapse_at_rest_names_the_water(tmp_path: Path) -> None:
    analysis = {"kind": "dem", "end_time": 0.3, "perturbed": False, "water": {"level": 2.6}}
    material = {"density": DENSITY, "young": "20 GPa"}
    block = {"kind": "block", "width": WIDTH, "height": HEIGHT}
    run = extrados.run({"structure": block, "material": material, "joints": {"friction": 0.9}, "analysis": analysis})
    ((_, caption),) = draw_self_weight(run, "dem", tmp_path)
    assert caption.startswith("Collapse mechanism under self-weight and the water pressure.")


@pytest.mark.parametrize("error", [NoAnswer("no end"), Refused("no end"), CannotStand("no end")])
def test_an_end_without_a_result_keeps_the_warnings(error: Exception, monkeypatch: pytest.MonkeyPatch) -> None:
    def ends(*_: object) -> None:
        raise error

    monkeypatch.setattr(driver, "compared", ends)
    there = make_deck(
        {"structure": {"kind": "block", "width": WIDTH, "height": HEIGHT}, "analysis": {"kind": "dem", "water": {"level": 1.0}}}
    )
    found = run_one(Context(there), there.analyses[0], there.building)
    assert sum("water pressure is constant" in text for text in found.warnings) == 1


def test_blocks_beside_each_other_in_depth_are_no_section_drawn_out() -> None:
    """A block that is moved along its depth has the same section, but not the same joints under water."""
    made = make_deck(
        {"structure": {"kind": "column", "width": 1.0, "height": 3.0, "depth": 2.0, "drums": 2}, "analysis": [{"kind": "tilt"}]}
    ).building
    solids = made.solids()
    assert wet_section(made, solids).block_names == solids.block_names
    parts = [
        replace(p, vertices=p.vertices + np.array([0.0, 0.8, 0.0])) if o == 1 else p
        for p, o in zip(solids.parts, solids.owner, strict=True)
    ]
    with pytest.raises(Refused, match="drawn out to its depth"):
        wet_section(made, replace(solids, parts=parts))
