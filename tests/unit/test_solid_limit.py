"""Limit analysis of solids: the plane ones, closed forms, the cone of friction, certificates, refusals, domes."""

import os
import signal
import threading
from typing import Any

import clarabel
import numpy as np
import pytest

from extrados.analyses.context import Context
from extrados.analyses.sequence import run_analyses
from extrados.decks.reader import make_deck
from extrados.limit import solids
from extrados.limit.errors import Immovable
from extrados.limit.solids import Falls, Programme, SolidLimit
from extrados.model.geometry.solids.assembly import SolidAssembly
from extrados.model.structures.dome import make_dome
from extrados.results.model import Result
from extrados.results.verdict import SelfWeight
from extrados.schema.constants import GRAVITY

ARCH = {"kind": "arch", "radius": 10.0, "thickness": 1.5, "embrace": 157.5, "voussoirs": 7}
WALL = {"kind": "brickwork", "units": 5, "courses": 6, "unit_length": 0.4, "unit_height": 0.175, "begins": "half"}
PLANE = {
    "arch": ARCH,
    "vault": {"kind": "vault", "preset": "dejong-a", "voussoirs": 10},
    "wall": WALL,
    "wall with a door": {**WALL, "openings": [{"x": [0.8, 1.2], "y": [0, 0.7]}]},
    "frame": {"kind": "frame", "width": 0.8, "height": 4.0, "spacing": 3.0, "lintel_height": 0.8},
    "column": {"kind": "column", "width": 0.8, "top_width": 0.6, "height": 4.0, "drums": 4},
}


def run(structure: dict[str, Any], friction: Any = 0.7, **keys: Any) -> Result:
    tables = {"structure": structure, "joints": {"friction": friction}}
    (result,) = run_analyses(Context(make_deck({**tables, "analysis": {"kind": "tilt", **keys}}), threads=1))
    return result


def limit_of(structure: dict[str, Any], friction: Any = 0.7) -> SolidLimit:
    building = make_deck({"structure": structure, "joints": {"friction": friction}, "analysis": {"kind": "tilt"}}).building
    solids = building.solids()
    return SolidLimit(solids, building.friction(solids))


def pushed(limit: SolidLimit, direction: float = 0.0) -> Programme:
    found = limit.push(direction)
    assert isinstance(found, Programme)
    return found


@pytest.mark.parametrize(
    ("name", "friction"),
    [
        pytest.param(name, friction, marks=[pytest.mark.verify] if name == "wall with a door" and friction == 0.65 else [])
        for name in PLANE
        for friction in (0.3, 0.65, "no-sliding")
    ],
)
def test_plane_structures_in_space_are_the_plane_ones(name: str, friction: Any) -> None:
    plane = run(PLANE[name], friction)
    if isinstance(plane.results, SelfWeight):
        assert isinstance(run(PLANE[name], friction, direction=0.0).results, SelfWeight)
        return
    space = run(PLANE[name], friction, direction=0.0, rose=4)
    assert space.results["collapse_acceleration_g"] == pytest.approx(plane.results["collapse_acceleration_g"], abs=1e-7)
    assert space.results["collapse_acceleration_opposite_g"] == pytest.approx(plane.results["collapse_acceleration_opposite_g"], abs=1e-7)
    assert space.results["duality_gap"] < 1e-8
    assert space.results["weight_N"] == pytest.approx(plane.results["weight_N"], rel=1e-12)


def test_a_barrel_in_bond_carries_what_its_section_does() -> None:
    plane = run(ARCH).results["collapse_acceleration_g"]
    assert pushed(limit_of({**ARCH, "depth": 4.0, "stones_across": 3})).gamma == pytest.approx(plane, abs=1e-7)


@pytest.mark.parametrize("skew", [-35.0, 15.0, 30.0, 55.0])
def test_a_skew_arch_without_sliding_is_a_sheared_one(skew: float) -> None:
    """A shear in plan keeps equilibrium and the sides of joints, and turns the push: along its faces a skew arch bears what
    the square one does, divided by the cosine of the skew."""
    square = run(ARCH, "no-sliding").results["collapse_acceleration_g"]
    for across in (1, 3):
        limit = limit_of({**ARCH, "depth": 5.0, "skew": skew, "stones_across": across}, "no-sliding")
        assert pushed(limit, skew).gamma == pytest.approx(square / np.cos(np.radians(skew)), abs=1e-7)


def test_friction_takes_from_a_skew_arch() -> None:
    square = pushed(limit_of({**ARCH, "depth": 5.0})).gamma
    skew = [pushed(limit_of({**ARCH, "depth": 5.0, "skew": s}), s).gamma for s in (0.0, 40.0)]
    assert skew[0] == pytest.approx(square, abs=1e-8)
    free = run(ARCH, "no-sliding").results["collapse_acceleration_g"] / np.cos(np.radians(40.0))
    assert skew[1] < free - 0.005


@pytest.mark.parametrize("direction", [0.0, 7.3, 30.0, 45.0, 91.0, 200.0, 341.0])
def test_a_block_slides_at_its_friction_in_any_direction(direction: float) -> None:
    """Coulomb's cone exactly, where a pyramid would do as its facets lie."""
    limit = limit_of({"kind": "column", "width": 2.0, "height": 0.5, "drums": 1, "section": "round", "sides": 7}, 0.4)
    assert pushed(limit, direction).gamma == pytest.approx(0.4, abs=1e-7)
    low, high = limit.pyramids(direction, 6)
    assert 0.4 * np.cos(np.pi / 6) - 1e-9 <= low <= 0.4 + 1e-9 and 0.4 - 1e-9 <= high <= 0.4 / np.cos(np.pi / 6) + 1e-9


@pytest.mark.parametrize("sides", [4, 5, 20])
def test_a_polygonal_column_turns_over_the_edge_that_its_resultant_meets(sides: int) -> None:
    """Capacity over direction: how far the polygon of the base reaches that way, over the height of the centre."""
    column = {"kind": "column", "width": 1.0, "height": 4.0, "drums": 3, "section": "round", "sides": sides}
    limit = limit_of(column, 5.0)
    for direction in (0.0, 11.0, 36.0, 100.0, 250.0):
        inward = np.pi / sides
        turn = np.radians(direction) % (2 * inward) - inward
        assert pushed(limit, direction).gamma == pytest.approx(0.5 * np.cos(inward) / np.cos(turn) / 2.0, rel=1e-7)


def test_a_free_wall_falls_out_of_its_plane_at_thickness_over_height() -> None:
    wall = {"kind": "wall", "unit_length": 0.4, "unit_height": 0.2, "thickness": 0.2, "height": 2.4, "legs": [{"length": 2.4}]}
    assert pushed(limit_of(wall), 90.0).gamma == pytest.approx(0.2 / 2.4, abs=1e-7)
    corner = {**wall, "legs": [{"length": 2.4}, {"length": 2.0}]}
    held = pushed(limit_of(corner), 0.0)
    assert held.gamma > 1.2 * 0.2 / 2.4  # its quoins hold the second leg
    low, high = limit_of(corner).pyramids(0.0, 8)
    assert low <= held.gamma <= high and high - low < 0.03
    slippery = pushed(limit_of(corner, 0.2), 0.0).gamma
    assert 0.2 / 2.4 < slippery < held.gamma


def test_dowels_carry_their_shear() -> None:
    drums = {"kind": "column", "width": 1.0, "height": 1.0, "drums": 2, "section": "round", "sides": 20}
    tables = {"joints": {"friction": 0.2, "types": [{"joints": ["ground"], "friction": 5.0}]}, "analysis": {"kind": "tilt"}}
    found = {}
    for dowels in (None, 500.0, "unbroken"):
        structure = {**drums, "dowels": dowels} if dowels else drums
        building = make_deck({"structure": structure, **tables}).building
        solids = building.solids()
        found[dowels] = pushed(SolidLimit(solids, building.friction(solids))).gamma
        weight = solids.mass[1] * GRAVITY
        if dowels == 500.0:  # the pyramids of dowels that give way are bounded by their strength
            limit = SolidLimit(solids, building.friction(solids))
            low, high = limit.pyramids(0.0, 24)
            most = 0.2 + 500.0 / weight
            assert low == pytest.approx(most, abs=1e-7) and high == pytest.approx(most / np.cos(np.pi / 24), abs=1e-7)
    assert found[None] == pytest.approx(0.2, abs=1e-7)
    assert found[500.0] == pytest.approx(0.2 + 500.0 / weight, abs=1e-7)
    assert found["unbroken"] == pytest.approx(1.0, abs=1e-7)  # over the corner of its base
    low, high = SolidLimit(solids, 0.2).pyramids(0.0, 8)
    assert low == pytest.approx(0.2, abs=1e-7) and high == pytest.approx(0.2 / np.cos(np.pi / 8), abs=1e-7)


def resultants(solids: SolidAssembly, found: Programme) -> np.ndarray:
    """Forces and moments about the origin on each block (nb, 6), summed corner by corner."""
    t1, t2 = solids.tangents
    total = np.zeros((len(solids.mass), 6))
    for point, j, (n, u, v) in zip(solids.corner, solids.corner_joint, found.force, strict=True):
        force = n * solids.normal[j] + u * t1[j] + v * t2[j]
        wrench = np.concatenate([force, np.cross(point, force)])
        total[solids.a[j]] += wrench
        if solids.b[j] >= 0:
            total[solids.b[j]] -= wrench
    return total


@pytest.mark.parametrize(
    ("structure", "direction"),
    [
        ({"kind": "dome", "radius": 5, "thickness": 0.4, "rings": 5, "lunes": 10, "bond": "running"}, 20.0),
        ({"kind": "cross-vault", "radius": 3, "thickness": 0.4, "embrace": 140, "voussoirs": 8, "stone_length": 1.0}, 70.0),
    ],
)
def test_both_certificates_by_hand(structure: dict[str, Any], direction: float) -> None:
    """Forces balance weight and push and lie in their cones; the motion opens contacts mu times as fast as they slide, and
    its virtual work gives the same push."""
    limit = limit_of(structure)
    solids, found = limit.assembly, pushed(limit, direction)
    way = np.array([np.cos(np.radians(direction)), np.sin(np.radians(direction)), 0.0])
    weight = solids.mass * GRAVITY
    load = weight[:, None] * (found.gamma * way - [0.0, 0.0, 1.0])
    rest = resultants(solids, found) + np.hstack([load, np.cross(solids.centroid, load)])
    assert np.abs(rest).max() < 1e-7 * weight.sum() * solids.size
    assert (np.hypot(*found.force[:, 1:].T) <= 0.7 * found.force[:, 0] + 1e-8 * weight.sum()).all()
    rate = np.zeros_like(solids.corner)
    for sense, block in ((1.0, solids.a[solids.corner_joint]), (-1.0, solids.b[solids.corner_joint])):
        on = block >= 0
        v = found.motion[block[on]]
        rate[on] += sense * (v[:, :3] + np.cross(v[:, 3:], solids.corner[on] - solids.centroid[block[on]]))
    normal = solids.normal[solids.corner_joint]
    opening = (rate * normal).sum(axis=1)
    slip = np.linalg.norm(rate - opening[:, None] * normal, axis=1)
    assert (opening - 0.7 * slip).min() > -1e-6 * np.abs(rate).max()
    lifted = (weight * found.motion[:, 2]).sum()
    assert lifted / (weight * (found.motion[:, :3] @ way)).sum() == pytest.approx(found.gamma, abs=1e-7)


def test_what_cannot_stand_is_proven() -> None:
    """Dome below its least thickness: refused by a motion; the same by the solver's certificate, checked here again."""
    found = SolidLimit(make_dome(1.0, 0.036, 180.0, 10, 12), 0.7).push(0.0)
    assert isinstance(found, Falls) and found.power > 1e-6 and found.overlap < 1e-7
    thin = run({"kind": "dome", "radius": 1, "thickness": 0.036, "rings": 10, "lunes": 12})
    assert thin.results.safety_factor == 0.0 and "ertificate: a mechanism, fastest at" in thin.results.certificate
    leaning = run({"kind": "arch", "radius": 10, "thickness": 0.6, "embrace": 157.5, "voussoirs": 14, "skew": 5})
    assert isinstance(leaning.results, SelfWeight) and "ertificate: " in leaning.results.certificate


def test_a_block_out_over_its_base_falls() -> None:
    text = "\n".join(
        f"o {name}\n"
        + "\n".join(f"v {x} {y} {z}" for z in (z0, z1) for x, y in ((x0, 0), (x1, 0), (x1, 1), (x0, 1)))
        + "\n"
        + "\n".join(
            "f " + " ".join(str(8 * k + i) for i in face)
            for face in ((4, 3, 2, 1), (5, 6, 7, 8), (1, 2, 6, 5), (2, 3, 7, 6), (3, 4, 8, 7), (4, 1, 5, 8))
        )
        for k, (name, x0, x1, z0, z1) in enumerate((("base", 0, 1, 0, 1), ("slab", 0.52, 1.52, 1, 1.3)))
    )
    from extrados.model.geometry.solids.assembly import assemble
    from extrados.model.geometry.solids.meshes import read_obj, stones_of

    solids = assemble(stones_of(read_obj(text, "slab.obj"), 2000.0, None, "slab.obj"), 1e-4)
    forth, back = (SolidLimit(solids, 0.7).push(d) for d in (0.0, 180.0))
    # its centroid lies 20 mm out: it stands only when pushed back by that over half its thickness
    assert isinstance(forth, Programme) and forth.gamma == pytest.approx(-0.02 / 0.15, abs=1e-7)
    assert isinstance(back, Programme) and back.gamma > 0.0


def test_immovable_is_said() -> None:
    """A wedge held from all sides by sockets without sliding."""
    limit = limit_of({"kind": "arch", "radius": 10, "thickness": 3, "embrace": 40, "voussoirs": 4}, "no-sliding")
    with pytest.raises(Immovable):
        limit.push(90.0)


def test_tilt_reports_refuses_and_draws(tmp_path) -> None:
    import extrados

    deck = tmp_path / "dome.toml"
    deck.write_text(
        '[structure]\nkind = "dome"\nradius = 5\nthickness = 0.5\nrings = 5\nlunes = 8\n[[analysis]]\nkind = "tilt"\nrose = 8\npyramids = 8\n'
    )
    found = extrados.run(deck)
    r = found["tilt"]
    assert r.pyramids.lower_g - 1e-9 <= r.collapse_acceleration_g <= r.pyramids.upper_g + 1e-9
    rose = found.array("tilt", "rose_capacity")
    assert len(rose) == 8 and rose.min() == pytest.approx(r.least_acceleration_g, abs=1e-7)
    assert rose[::2] == pytest.approx(np.full(4, rose[0]), abs=1e-6)  # eight lunes: four directions are alike
    found.write(tmp_path / "out")
    for name in ("figures/tilt-mechanism.png", "figures/tilt-rose.png", "mechanism.glb", "mechanism.pvd", "mechanism/frame_0000.vtu"):
        assert (tmp_path / "out" / name).stat().st_size > 100
    dome = {"kind": "dome", "radius": 5, "thickness": 0.5, "rings": 5, "lunes": 8}
    assert "cannot include fracture" in run(dome, fracture=True).reason


@pytest.mark.parametrize(("rings", "lunes"), [(8, 8), (12, 12)])
def test_least_thickness_of_a_hemisphere(rings: int, lunes: int) -> None:
    """Heyman's dome: it stands at .0428 of its radius and not at .0415, whatever the friction of masonry."""
    for friction in (None, 0.7):
        assert isinstance(SolidLimit(make_dome(1.0, 0.0415, 180.0, rings, lunes), friction).push(0.0), Falls)
        assert pushed(SolidLimit(make_dome(1.0, 0.0432, 180.0, rings, lunes), friction)).gamma > 0.0


def test_ctrl_c_is_answered_while_the_solver_works(monkeypatch: pytest.MonkeyPatch) -> None:
    """The solver is held up until the interruption has been answered: it would wait for ever else."""
    answered, real = threading.Event(), clarabel.DefaultSolver

    class Slow:
        def __init__(self, *given: Any):
            self.solver = real(*given)

        def solve(self) -> Any:
            os.kill(os.getpid(), signal.SIGINT)
            answered.wait(60.0)
            return self.solver.solve()

    monkeypatch.setattr(solids.clarabel, "DefaultSolver", Slow)
    with pytest.raises(KeyboardInterrupt):
        limit_of(ARCH).push(0.0)
    assert not answered.is_set()
    answered.set()


def test_threads_change_no_bit() -> None:
    limit = limit_of({"kind": "dome", "radius": 5, "thickness": 0.5, "rings": 5, "lunes": 8})
    directions = [0.0, 10.0, 20.0, 30.0, 40.0]
    one, three = (limit.pushes(directions, threads) for threads in (1, 3))
    for a, b in zip(one, three, strict=True):
        assert isinstance(a, Programme) and isinstance(b, Programme)
        assert a.gamma == b.gamma and (a.force == b.force).all() and (a.motion == b.motion).all()


def test_a_structure_that_no_push_overturns_is_reported(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of a flat arch that cannot slide; and a rose may be open in some directions."""
    flat = {"kind": "arch", "radius": 10, "thickness": 3, "embrace": 40, "voussoirs": 4}
    found = run(flat, "no-sliding", direction=0.0)
    assert found.status == "refused" and "no horizontal load causes collapse" in found.reason
    real = SolidLimit.push

    def push(limit: SolidLimit, direction: float) -> Any:
        if direction in (90.0, 270.0):
            raise Immovable("held")
        return real(limit, direction)

    monkeypatch.setattr(SolidLimit, "push", push)
    found = run(ARCH, "no-sliding", direction=0.0, rose=4)
    assert found.arrays["rose_capacity"].data == pytest.approx([0.37000973802, np.inf, 0.37000973802, np.inf], abs=1e-7)
    assert found.results["least_direction_deg"] == 0.0
