"""Floors, joists, props and rods of buildings, solved before anything cracks, against rigid bodies and beams."""

import numpy as np
import pytest

from extrados.analyses.shell.model import build
from extrados.analyses.shell.tables import Pushover
from extrados.model.properties import Material
from extrados.model.structures.plan import Plan
from extrados.schema.constants import GRAVITY
from extrados.views.building import Building
from extrados.views.shell.options import ShellOptions

MASONRY = Material(density=2000.0, young=2e9, poisson=0.0)
STEEL = Material(density=0.0, young=200e9)


def solved(plan, direction=0.0, size=0.5):
    """Mesh, model and displacements (nodes, 6) of the constant loads, and of a push of 1 g alone."""
    options = Pushover(kind="pushover", direction=direction, mesh=ShellOptions(size=size, layers=3))
    mesh = Building(Plan(kind="building", **plan), MASONRY, materials={"steel": STEEL}).shell(options.mesh)
    model = build(mesh, options)
    with model.open(options, 1) as core_model:
        core_model.loads(model.constant, model.reference)
        rest = core_model.displacement(0.0)
        return mesh, model, rest, core_model.displacement(1.0) - rest


def pull_of(mesh, moved, name):
    """Sum of the tensions of the bars of a name [N]."""
    total = 0.0
    for bar in mesh.bars:
        if bar.name == name:
            a, b = bar.nodes
            way = mesh.xyz[b] - mesh.xyz[a]
            length = np.linalg.norm(way)
            total += bar.material.young * bar.area / length**2 * float((moved[b, :3] - moved[a, :3]) @ way)
    return total


def facing(thickness=0.25, length=2.0, gap=4.0, height=3.0, **more):
    """Two walls along x that face each other and touch no other."""
    walls = [{"name": name, "start": [0.0, y], "end": [length, y], "thickness": thickness} for name, y in (("a", 0.0), ("b", gap))]
    return {"storeys": [height], "walls": walls, **more}


def box(**floor):
    """Four walls around a floor, one of them twice as thick as the others."""
    sides = (("1", (0, 0), (5, 0), 0.4), ("B", (5, 0), (5, 4), 0.2), ("2", (5, 4), (0, 4), 0.2), ("A", (0, 4), (0, 0), 0.2))
    walls = [{"name": name, "start": list(map(float, a)), "end": list(map(float, b)), "thickness": t} for name, a, b, t in sides]
    return {"storeys": [3.0], "walls": walls, "floors": [{"storey": 1, "load": 3e3, **floor}]}


def out_of_rigid(mesh, moved, level):
    """The greatest distance of nodes at a level from the rigid motion on the plan nearest to theirs, over the mean."""
    on = np.isclose(mesh.xyz[:, 2], level)
    x, u = mesh.xyz[on, :2], moved[on, :2]
    n = len(x)
    motion = np.zeros((2 * n, 3))
    motion[:n, 0] = motion[n:, 1] = 1.0
    motion[:n, 2], motion[n:, 2] = -x[:, 1], x[:, 0]
    found, *_ = np.linalg.lstsq(motion, u.T.ravel(), rcond=None)
    away = np.abs(motion @ found - u.T.ravel()).max()
    return away / np.abs(u).mean(), found[2]


def test_a_rigid_floor_moves_as_one():
    """All around it, within a twentieth of the mean, and it turns away from the thicker wall; one of 0.02 MPa lets the walls
    go alone."""
    mesh, _, _, moved = solved(box(kind="rigid"), size=1.0)
    away, turn = out_of_rigid(mesh, moved, 3.0)
    assert away < 0.05 and turn < 0.0
    mesh, _, _, moved = solved(box(kind="flexible", young=2e4, thickness=0.05), size=1.0)
    assert out_of_rigid(mesh, moved, 3.0)[0] > 0.5


def test_the_load_of_a_floor_goes_to_the_walls_that_carry_it():
    """Weights on the walls that bear, by the length along which they do, and on no other."""
    mesh, *_ = solved(box(kind="none", bears_on=["1", "2"]), size=1.0)
    top = np.isclose(mesh.xyz[:, 2], 3.0)
    on = top & (np.isclose(mesh.xyz[:, 1], 0.0) | np.isclose(mesh.xyz[:, 1], 4.0))
    load = GRAVITY * mesh.floor_mass
    assert load[on].sum() == pytest.approx(3e3 * 20.0) == pytest.approx(load.sum())
    assert load[np.isclose(mesh.xyz[:, 1], 0.0)].sum() == pytest.approx(3e3 * 10.0)


def test_joists_hold_a_wall_at_one_that_is_propped():
    """One wall's top is propped. Through stiff joists the other is a propped cantilever too: they pull or push by three
    eighths of its load, but for what the joists give; their stiffness is that of their wood."""
    floor = {"storey": 1, "kind": "joists", "young": 10e9, "joist_area": 0.02, "joist_spacing": 0.5, "bears_on": ["a", "b"], "walls": None}
    plan = facing(props=[{"wall": "a", "storey": 1}])
    # Joists lie between walls of a ring: thin ends that nothing holds close it
    plan["walls"] += [
        {"name": "c", "start": [0.0, 0.0], "end": [0.0, 4.0], "thickness": 1e-4},
        {"name": "d", "start": [2.0, 0.0], "end": [2.0, 4.0], "thickness": 1e-4},
    ]
    plan["floors"] = [floor]
    mesh, _, _, moved = solved(plan, direction=90.0, size=0.25)
    joists = [bar for bar in mesh.bars if bar.name.endswith("joists")]
    stiffness = sum(bar.material.young * bar.area / 4.0 for bar in joists)
    assert stiffness == pytest.approx(10e9 * 0.02 / 0.5 * 2.0 / 4.0)
    weight = 0.25 * 3.0 * 2.0 * 2000.0 * GRAVITY
    bending = 2e9 * 2.0 * 0.25**3 / 12.0
    top = 3.0 * bending / 3.0**3  # stiffness of a cantilever at its end
    gives = 1.0 / (1.0 + top / stiffness)
    assert pull_of(mesh, moved, "floor 1, joists") == pytest.approx(0.375 * weight * gives, rel=0.02)
    held = np.isclose(mesh.xyz[:, 2], 3.0) & np.isclose(mesh.xyz[:, 1], 0.0)
    assert np.abs(moved[held, 1]).max() == 0.0


def test_a_rod_keeps_what_the_walls_leave_of_its_prestress():
    """Two cantilevers 0.25 m wide pulled together by a rod at their tops: N = P / (1 + 2 k / K), k of the rod and K of a
    wall at its top, with its shear."""
    rod = {"start": [0.0, 0.0, 3.0], "end": [0.0, 4.0, 3.0], "area": 2e-6, "material": "steel", "prestress": 1e3}
    other = {**rod, "start": [0.25, 0.0, 3.0], "end": [0.25, 4.0, 3.0]}
    mesh, _, rest, _ = solved(facing(length=0.25, rods=[rod, other]), size=0.25)
    k = 2 * 200e9 * 2e-6 / 4.0
    area, inertia = 0.25 * 0.25, 0.25 * 0.25**3 / 12.0
    wall = 1.0 / (3.0**3 / (3.0 * 2e9 * inertia) + 3.0 / (5.0 / 6.0 * 1e9 * area))
    left = 2e3 + pull_of(mesh, rest, "rod 1") + pull_of(mesh, rest, "rod 2")
    assert 2 * k / wall > 0.2
    assert left == pytest.approx(2e3 / (1.0 + 2.0 * k / wall), rel=0.005)
    tops = np.isclose(mesh.xyz[:, 2], 3.0)
    assert rest[tops & np.isclose(mesh.xyz[:, 1], 0.0), 1] == pytest.approx(left / wall, rel=0.01)


def layered(**more):
    """A wall without lateral strain of two storeys of other masonry, under a force on its top."""
    wall = {"name": "a", "start": [0.0, 0.0], "end": [2.0, 0.0], "thickness": 0.3, "materials": ["soft", "hard"]}
    return {"storeys": [3.0, 2.0], "walls": [wall], "prestress": [{"wall": "a", "force": 6e5}], **more}


@pytest.mark.parametrize("beam", [0.0, 0.4])
def test_materials_by_storey_and_a_ring_beam_shorten_in_series(beam: float) -> None:
    """Top displacement: stress times the sum of heights over moduli, plus the weights above each height. The beam stays elastic."""
    kinds = {"soft": (1e9, 2200.0), "hard": (2e9, 1600.0), "concrete": (30e9, 2500.0)}
    materials = {name: Material(density=density, young=young, poisson=0.0) for name, (young, density) in kinds.items()}
    beams = [{"storey": 2, "depth": beam, "material": "concrete"}] if beam else []
    options = Pushover(kind="pushover", mesh=ShellOptions(size=0.25, layers=3))
    mesh = Building(Plan(kind="building", **layered(ring_beams=beams)), MASONRY, materials=materials).shell(options.mesh)
    model = build(mesh, options)
    with model.open(options, 1) as core_model:
        core_model.loads(model.constant, model.reference)
        moved = core_model.displacement(0.0)
    height, above = {"soft": 3.0, "hard": 2.0 - beam, "concrete": beam}, 6e5 / 0.6
    sinks = 0.0
    for name in ("concrete", "hard", "soft"):
        young, density = kinds[name]
        own = density * GRAVITY * height[name]
        sinks += (above + 0.5 * own) * height[name] / young
        above += own
    top = np.isclose(mesh.xyz[:, 2], 5.0)
    assert moved[top, 2] == pytest.approx(-sinks, rel=2e-3)
    low, high = (mesh.xyz[mesh.parts[0].connect[mesh.parts[0].linear], 2].ravel() for _ in range(2))
    assert mesh.parts[0].linear.any() == (beam > 0.0)
    assert not beam or (low.min() == pytest.approx(5.0 - beam) and high.max() == pytest.approx(5.0))


def test_a_beam_that_rests_on_a_part_of_a_wall_turns_its_foot() -> None:
    """Force and moment of a force on x 1.5 to 2 m, in shells and in the frame; grid lines end at its bearing."""
    wall = {"name": "a", "start": [0.0, 0.0], "end": [2.0, 0.0], "thickness": 0.3}
    plan = {"storeys": [3.0], "walls": [wall], "prestress": [{"wall": "a", "force": 5e4, "x": [1.45, 2.0]}]}
    mesh, *_ = solved(plan)
    assert mesh.push[:, 2].sum() == pytest.approx(-5e4)
    assert mesh.push[:, 2] @ mesh.xyz[:, 0] == pytest.approx(-5e4 * 1.725)
    assert mesh.xyz[mesh.push[:, 2] < 0.0, 0].min() == pytest.approx(1.45)
    loaded, bare = (Building(Plan(kind="building", **{**plan, **less}), MASONRY).frame() for less in ({}, {"prestress": []}))
    change = loaded.weight - bare.weight
    node = next(node for node in loaded.nodes if node.level == 1)
    assert change[node.freedoms[0]] == pytest.approx(-5e4)
    assert change[node.freedoms[1]] == pytest.approx(-5e4 * (1.725 - node.s))


def test_a_propped_wall_is_a_propped_cantilever():
    """Under its mass pushed across it: the greatest deflection of the clamped and propped beam, q h^4 / (185 E I)."""
    wall = {"name": "a", "start": [0.0, 0.0], "end": [0.5, 0.0], "thickness": 0.1}
    plan = {"storeys": [3.0], "walls": [wall], "props": [{"wall": "a", "storey": 1}]}
    mesh, _, _, moved = solved(plan, direction=90.0, size=0.25)
    load = 0.1 * 0.5 * 2000.0 * GRAVITY
    assert moved[:, 1].max() == pytest.approx(load * 3.0**4 / (184.6 * 2e9 * 0.5 * 0.1**3 / 12.0), rel=0.02)
    assert np.abs(moved[np.isclose(mesh.xyz[:, 2], 3.0), 1]).max() == 0.0


def test_a_wall_on_a_compliant_base_settles_and_rotates():
    """Under its weight by the pressure over the stiffness of the ground, evenly."""
    wall = {"name": "a", "start": [0.0, 0.0], "end": [2.0, 0.0], "thickness": 0.3}
    mesh, _, rest, moved = solved({"storeys": [3.0], "walls": [wall], "foundation_stiffness": 1e7})
    base = np.isclose(mesh.xyz[:, 2], 0.0)
    assert rest[base, 2] == pytest.approx(-3.0 * 2000.0 * GRAVITY / 1e7, rel=0.01)
    # Pushed along it: the moment over that of the sole, about which it turns
    turn = np.polyfit(mesh.xyz[base, 0], moved[base, 2], 1)[0]
    moment = 0.3 * 2.0 * 3.0 * 2000.0 * GRAVITY * 1.5
    x = mesh.xyz[base, 0]
    share = np.full(len(x), 0.3 * 0.5)
    share[[x.argmin(), x.argmax()]] *= 0.5
    assert turn == pytest.approx(-moment / (1e7 * float(share @ (x - 1.0) ** 2)), rel=0.05)
