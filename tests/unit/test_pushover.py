"""The push of a building of shells: forces in its sections, senses, flanges, the limit of one wall."""

import textwrap

import numpy as np
import pytest

import extrados
from extrados.analyses.shell.model import build, first_mode
from extrados.analyses.shell.sections import sections
from extrados.analyses.shell.tables import Pushover
from extrados.model.properties import Material
from extrados.model.structures.plan import Plan
from extrados.views.building import Building
from extrados.views.shell.options import ShellOptions

MASONRY = Material(density=1900.0, young=3e9, poisson=0.2, tensile_strength=0.1e6, fracture_energy=40.0)
DECK = """
    [structure]
    kind = "building"
    storeys = [3.0]
    corners = {corners}
    [[structure.walls]]
    name = "1"
    start = [0, 0]
    end = [3, 0]
    thickness = 0.25
    openings = [{{ storey = 1, x = [1.0, 2.0], z = [1.0, 2.0] }}]
    [[structure.walls]]
    name = "A"
    start = [0, 0]
    end = [0, 3]
    thickness = 0.25
    [[structure.walls]]
    name = "2"
    start = [0, 3]
    end = [3, 3]
    thickness = 0.25
    openings = [{{ storey = 1, x = [1.0, 2.0], z = [1.0, 2.0] }}]
    [[structure.walls]]
    name = "B"
    start = [3, 0]
    end = [3, 3]
    thickness = 0.25
    [[structure.floors]]
    storey = 1
    walls = ["1", "B", "2", "A"]
    young = 5e8
    thickness = 0.05
    load = 2000
    [material]
    density = 1900
    young = 3e9
    poisson = 0.2
    tensile_strength = 1e5
    fracture_energy = 40
    [[analysis]]
    kind = "pushover"
    mesh = {{ size = 0.5, layers = 3 }}
    ripple = 0.2
    events = {events}
    {more}
"""


def deck(tmp_path, corners="[]", events=1200, more=""):
    path = tmp_path / "house.toml"
    path.write_text(textwrap.dedent(DECK.format(corners=corners, events=events, more=more)))
    return path


def one_wall(size=0.5, **options):
    wall = {
        "name": "a",
        "start": [0.0, 0.0],
        "end": [3.0, 0.0],
        "thickness": 0.25,
        "openings": [{"storey": 1, "x": [1.0, 2.0], "z": [0.0, 2.0]}],
    }
    mesh = Building(Plan(kind="building", storeys=[3.0], walls=[wall]), MASONRY).shell(ShellOptions(size=size, layers=3))
    return build(mesh, Pushover(kind="pushover", mesh=ShellOptions(size=size, layers=3), **options))


@pytest.mark.parametrize("angle", [0.0, 180.0])
def test_sections_balance_the_forces_above_them(angle):
    """Weight and push over the lowest row of elements, to rounding: virtual work makes them exact."""
    model = one_wall(direction=angle)
    options = Pushover(kind="pushover")
    with model.open(options, 1) as core_model:
        core_model.loads(model.constant, model.reference)
        found = sections(model, core_model.report(0.4))
    over = model.mesh.xyz[:, 2] > 1e-9
    assert [(f.start, f.end) for f in found] == [(0.0, 1.0), (2.0, 3.0)]
    assert sum(f.normal for f in found) == pytest.approx(model.constant[over, 2].sum(), rel=1e-9)
    assert -sum(f.shear for f in found) * np.cos(np.radians(angle)) == pytest.approx(
        -0.4 * np.abs(model.reference[over, 0]).sum(), rel=1e-9
    )


def test_one_wall_is_the_wall_of_sla(tmp_path):
    """A building of one wall under its weight and a push along it bears what the plane model of the wall does."""
    (tmp_path / "wall.toml").write_text(
        textwrap.dedent("""
        [structure]
        kind = "panel"
        width = 3.0
        height = 3.0
        thickness = 0.25
        openings = [{ x = [1.0, 2.0], y = [0.0, 2.0] }]
        [material]
        density = 1900
        young = 3e9
        poisson = 0.2
        tensile_strength = 1e5
        fracture_energy = 40
        [[analysis]]
        kind = "sla"
        mesh.size = 0.5
        ripple = 0.2
        constant = [{ kind = "gravity" }]
        reference = [{ kind = "gravity", ax = "1 g", ay = "0 g" }]
        control = [{ edge = "top" }]
        events = 400
        cracking = "orthotropic"
        """)
    )
    plane = extrados.run(tmp_path / "wall.toml").results[0].results
    path = tmp_path / "building.toml"
    path.write_text(
        textwrap.dedent("""
        [structure]
        kind = "building"
        storeys = [3.0]
        [[structure.walls]]
        name = "a"
        start = [0, 0]
        end = [3, 0]
        thickness = 0.25
        openings = [{ storey = 1, x = [1.0, 2.0], z = [0.0, 2.0] }]
        [material]
        density = 1900
        young = 3e9
        poisson = 0.2
        tensile_strength = 1e5
        fracture_energy = 40
        [[analysis]]
        kind = "pushover"
        mesh = { size = 0.5, layers = 3 }
        ripple = 0.2
        events = 1600
        cracking = "orthotropic"
        """)
    )
    shell = extrados.run(path).results[0].results
    assert shell.initial_stiffness_N_m == pytest.approx(plane.initial_stiffness_N_m, rel=1e-9)
    assert shell.first_event_load_N == pytest.approx(plane.first_event_load_N, rel=1e-8)
    assert shell.greatest_load_N == pytest.approx(plane.greatest_load_N, rel=0.03)
    assert shell.greatest_load_N == pytest.approx(shell.greatest_acceleration_g * shell.weight_N, rel=1e-9)


def test_flanges_carry_with_the_walls(tmp_path):
    """Bonded corners bear more than open ones; open flanges take no force from the push; the two senses of a
    symmetric house are the same."""
    bonded = extrados.run(deck(tmp_path, more='directions = ["+", "-"]')).results[0].results
    pairs = ", ".join(f'{{ walls = ["{a}", "{b}"], bond = "open" }}' for a in "12" for b in "AB")
    opened = extrados.run(deck(tmp_path, corners=f"[{pairs}]")).results[0].results
    assert bonded.greatest_load_N > 1.2 * opened.greatest_load_N
    assert bonded.flanges.working and bonded.flanges.uplift_N > 3 * opened.flanges.uplift_N
    assert bonded.minus.greatest_load_N == pytest.approx(bonded.greatest_load_N, rel=0.03)
    assert bonded.minus.first_event_load_N == pytest.approx(bonded.first_event_load_N, rel=1e-3)
    shares = {row.wall: row.share for row in bonded.walls}
    assert shares["1"] == pytest.approx(shares["2"], abs=0.05) and abs(shares["A"]) < 1e-9
    assert bonded.energy_residual_ratio < 1e-8


def test_drives_move_in_the_given_ratios(tmp_path):
    """Half the displacement at the storey of one wall; the base shear is the force on the shared displacement."""
    more = 'drives = [{ wall = "1", storey = 1 }, { wall = "2", storey = 1, ratio = 0.5 }]'
    run = extrados.run(deck(tmp_path, events=60, more=more)).results[0]
    node, moved = run["node"], run["state_displacement"][-1]
    top = node[:, 2] > 3.0 - 1e-9
    one, two = (moved[top & (np.abs(node[:, 1] - y) < 1e-9), 0] for y in (0.0, 3.0))
    assert np.ptp(one) < 1e-12 and two == pytest.approx(0.5 * one[0])
    assert run.results.pattern == "drives"


def test_the_first_mode_of_a_slender_wall_is_that_of_a_cantilever():
    """Out of its plane a tall narrow wall vibrates as a beam of the plate's stiffness, width 0.5 m, 6 m tall."""
    wall = {"name": "a", "start": [0.0, 0.0], "end": [0.5, 0.0], "thickness": 0.25}
    options = Pushover(kind="pushover", direction=90.0, mesh=ShellOptions(size=0.5, layers=3))
    material = MASONRY.model_copy(update={"poisson": 0.0})
    mesh = Building(Plan(kind="building", storeys=[6.0], walls=[wall]), material).shell(options.mesh)
    model = build(mesh, options)
    shape, frequency, part = first_mode(model, options, mesh.mass())
    radius = 0.25 / np.sqrt(12.0)
    assert frequency == pytest.approx(1.8751**2 / (2 * np.pi * 6.0**2) * np.sqrt(3e9 / 1900.0) * radius, rel=0.02)
    assert part == pytest.approx(0.613, abs=0.02)
    assert shape[mesh.xyz[:, 2] > 5.9].min() > 0.0


def test_a_settlement_cracks_before_the_push(tmp_path):
    """The ground under half of a wall goes down: its base does, the damage stays, and the push finds less stiffness."""
    sound = extrados.run(deck(tmp_path, events=900)).results[0]
    more = 'settlements = [{ wall = "2", x = [1.5, 3.0], down = "4 mm" }]\n    without_equilibrium = "load-unload"'
    sunk = extrados.run(deck(tmp_path, events=2500, more=more)).results[0]
    node = sunk["node"]
    base = (node[:, 2] < 1e-9) & (np.abs(node[:, 1] - 3.0) < 1e-9) & (node[:, 0] > 1.49)
    assert np.allclose(sunk["state_displacement"][-1][base, 2], -4e-3)
    assert sunk.results.events_of_constant_loads > 50
    assert sunk.results.first_crack.wall in ("2", "B") and sunk.results.first_crack.base_shear_N == 0.0
    assert sunk.results.initial_stiffness_N_m < 0.95 * sound.results.initial_stiffness_N_m
    assert sunk.results.energy_residual_ratio < 1e-6


def test_variants_make_a_band(tmp_path):
    more = 'variants = [{ name = "weak", strength = 0.5 }, { name = "strong", strength = 2.0, energy = 2.0 }]'
    results = extrados.run(deck(tmp_path, events=500, more=more)).results[0].results
    weak, strong = (row.greatest_base_shear_N for row in results.variants)
    assert weak < results.greatest_load_N < strong
    assert results.band_N == [weak, strong]


@pytest.mark.parametrize(
    "more, words",
    [
        ('drives = [{ wall = "9", storey = 1 }]', "wall '9' does not exist"),
        ('drives = [{ wall = "1", storey = 2 }]', "storey 2 does not exist"),
        ('drives = [{ wall = "1", storey = 1 }]\ndirection = 30', "along x or y"),
        ('settlements = [{ wall = "1", x = [5.0, 6.0], down = 0.01 }]', "no support restrains wall '1'"),
        ('control = { wall = "1", storey = 4 }', "storey 4 does not exist"),
    ],
)
def test_what_cannot_be_pushed_is_refused(tmp_path, more, words):
    run = extrados.run(deck(tmp_path, more=more.replace("\n", "\n    "))).results[0]
    assert run.status == "refused" and words in run.reason


def test_a_frame_of_piers_beside_the_push(tmp_path):
    """Two piers beside a door, by hand from half of the wall above them; a storey bears what its piers do."""
    path = tmp_path / "wall.toml"
    path.write_text(
        textwrap.dedent("""
        [structure]
        kind = "building"
        storeys = [3.0]
        walls = [{ name = "a", start = [0, 0], end = [3, 0], thickness = 0.25, openings = [{ x = [1.0, 2.0], z = [0.0, 2.0] }] }]
        prestress = [{ wall = "a", force = 60e3 }]
        [material]
        density = 1900
        young = 3e9
        tensile_strength = 1e5
        fracture_energy = 40
        compressive_strength = 3e6
        [[analysis]]
        kind = "pushover"
        mesh = { size = 0.25, layers = 3 }
        ripple = 0.2
        events = 20
        frame = { cohesion = 0.1e6, diagonal_strength = 0.05e6 }
        """)
    )
    run = extrados.run(path).results[0]
    frame = {row.code: row for row in run.results.frame}
    gravity = 9.80665
    load = 0.5 * (60e3 + 1900 * gravity * 0.25 * (3.0 + 2 * 1.0))  # of half the wall above the middle of the door
    total = 1900 * gravity * 0.25 * (9.0 - 2.0)
    above = 1900 * gravity * 0.25 * (3.0 + 2 * 0.5) / total  # of the push, over the middle of the storey
    area, height = 0.25, 2.0
    stress = load / area
    fema = min(0.9 * load / height, area * 0.75 * (0.75 * 0.1e6 + stress) / 1.5, load / height * (1 - stress / (0.7 * 3e6)))
    tension = 1.5 * 0.05e6
    ntc = min(load / height * (1 - stress / (0.85 * 3e6)), area * tension / 1.5 * np.sqrt(1 + stress / tension))
    assert frame["FEMA 356"].base_shear_N == pytest.approx(2 * fema / above, rel=0.03)
    assert frame["NTC 2018"].base_shear_N == pytest.approx(2 * ntc / above, rel=0.03)
    table = run.tables["frame"].columns
    assert table["load"] == pytest.approx([load, load], rel=0.02)  # of a row of elements
    assert table["height"] == [2.0, 2.0]
    assert "by code formulas" in run.answer


@pytest.mark.parametrize("closure", [False, True])
def test_a_push_back_after_large_damage(tmp_path, closure):
    """Far beyond its peak the way back bears less than the way there; where cracks stay open, taking the load off already
    brings the walls down, which ends as a mechanism of the building as it was, not under loads of what is left in cracks."""
    path = tmp_path / "back.toml"
    path.write_text(
        textwrap.dedent(f"""
        [structure]
        kind = "building"
        storeys = [2.0]
        walls = [
          {{ name = "a", start = [0, 0], end = [2, 0], thickness = 0.25, openings = [{{ x = [0.5, 1.5], z = [0.0, 1.0] }}] }},
          {{ name = "b", start = [0, 0], end = [0, 1], thickness = 0.25 }},
          {{ name = "c", start = [2, 0], end = [2, 1], thickness = 0.25 }},
        ]
        [material]
        density = 1900
        young = 3e9
        tensile_strength = 1e5
        fracture_energy = 40
        [[analysis]]
        kind = "pushover"
        mesh = {{ size = 0.5, layers = 3 }}
        ripple = 0.2
        events = 6000
        crack_closure = {str(closure).lower()}
        [[analysis.stages]]
        name = "there"
        target_displacement = "3 mm"
        [[analysis.stages]]
        name = "off"
        sense = "-"
        base_shear = 0.0
        [[analysis.stages]]
        name = "back"
        sense = "-"
        target_displacement = "-3 mm"
        """)
    )
    run = extrados.run(path).results[0]
    there, *after = run.results.stages
    assert there.stop == "target displacement" and there.end_load_N < 0.8 * there.peak_load_N
    assert all(stage.greatest_load_N < 0.7 * there.peak_load_N for stage in after)
    assert all(stage.energy_residual_ratio < 1e-8 for stage in run.results.stages)
    if closure:
        assert [stage.name for stage in after] == ["off", "back"]
        assert after[-1].peak_load_N == pytest.approx(0.547 * there.peak_load_N, rel=0.1)
        assert 0.0 < after[-1].end_load_N < after[-1].peak_load_N
    else:
        assert [(stage.name, stage.stop) for stage in after] == [("off", "mechanism")]
        assert any("not run: back" in text for text in run.warnings)


def test_stages_of_a_building_continue_under_load_reversal():
    """A wall that rocks in its plane, pushed to 6 mm and back: the same load in both senses, above the rocking of a rigid wall
    without tension, W L / (2 z) with the centre of the masses at z, by what its tensile strength adds."""
    stages = [{"target_displacement": 6e-3}, {"sense": "-", "target_displacement": 6e-3}]
    found = (
        extrados.run(
            {
                "structure": {
                    "kind": "building",
                    "storeys": [3.0],
                    "walls": [{"name": "a", "start": [0, 0], "end": [3, 0], "thickness": 0.3}],
                },
                "material": {"density": 1800, "young": 1.7e9, "poisson": 0.0, "tensile_strength": 5e4, "fracture_energy": 20},
                "analysis": [{"kind": "pushover", "mesh": {"size": 0.5, "layers": 3}, "without_equilibrium": "continue", "stages": stages}],
            },
            threads=1,
        )
        .results[0]
        .results
    )
    forth, back = found.stages
    rocking = found.weight_N * 1.5 / 1.5
    assert forth.end_load_N == pytest.approx(back.end_load_N, rel=0.02)
    assert rocking < back.end_load_N < 1.15 * rocking
    assert back.equilibrium_steps > 5 and back.unbalanced_steps == 0


@pytest.mark.parametrize(("ratios", "warned"), [([1.0], False), ([1.0, 0.8], True)])
def test_the_load_of_unequal_drives_is_not_the_base_shear(ratios: list[float], warned: bool) -> None:
    """One drive: the wall carries the load. Floor and roof in an unnatural ratio: more, with a warning."""
    drives = [{"wall": "1", "storey": 2 - k, "ratio": ratio} for k, ratio in enumerate(ratios)]
    deck = {
        "structure": {
            "kind": "building",
            "storeys": ["3 m", "3 m"],
            "walls": [{"name": "1", "start": [0, 0], "end": [3, 0], "thickness": 0.3}],
        },
        "material": {"young": "2 GPa", "poisson": 0.2, "density": 1800, "tensile_strength": "0.1 MPa", "fracture_energy": "20 N/m"},
        "analysis": [{"kind": "pushover", "drives": drives, "mesh": {"size": "0.75 m"}, "events": 3, "states": [1]}],
    }
    (found,) = extrados.run(deck).results
    (wall,) = found.results.walls
    assert any("not the base shear" in text for text in found.warnings) == warned
    assert wall.elastic_share > 1.1 if warned else wall.elastic_share == pytest.approx(1.0, abs=1e-9)
    assert found["state_wall_shear"][0, 0] == pytest.approx(wall.elastic_share * found["state_load"][0], rel=1e-3)
