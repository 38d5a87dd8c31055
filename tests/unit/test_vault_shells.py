"""Vaults and domes as shells from decks: their meshes, what their feet bear, springings that spread, stages."""

import textwrap

import numpy as np
import pytest

import extrados
from extrados.analyses.context import Refused
from extrados.analyses.shell.model import build
from extrados.analyses.shell.tables import Pushover
from extrados.analyses.shell.words import pressing
from extrados.core.shell import shell_axes
from extrados.model.errors import BadGeometry, NoView
from extrados.model.properties import Material
from extrados.model.structures.arch import Arch
from extrados.model.structures.cross_vault import CrossVault
from extrados.model.structures.dome import Dome
from extrados.model.structures.vault import Vault
from extrados.views.building import Building
from extrados.views.shell.mesh import nodal_areas
from extrados.views.shell.options import ShellOptions

MASONRY = Material(density=2000.0, young=5e9, poisson=0.0)
BARREL = Arch(kind="arch", radius=5.0, thickness=0.5, embrace=160.0, voussoirs=20, depth=2.0)
DOME = Dome(kind="dome", radius=5.0, thickness=0.5, embrace=150.0, rings=6, lunes=12)
OPEN_DOME = Dome(kind="dome", radius=5.0, thickness=0.5, embrace=150.0, rings=6, lunes=12, oculus=30.0)
GROINS = CrossVault(kind="cross-vault", radius=3.0, thickness=0.4, embrace=140.0, voussoirs=16, edge=0.5)
ON_WALLS = Vault(
    kind="vault", radius=4.0, thickness=0.7, embrace=180.0, face=3.65, buttress_width=1.9, height=4.0, height_to="centre", depth=0.6
)
EVERY = {"barrel": BARREL, "dome": DOME, "open dome": OPEN_DOME, "groins": GROINS, "on walls": ON_WALLS}


def meshed(structure, size=0.5, layers=3):
    return Building(structure, MASONRY).shell(ShellOptions(size=size, layers=layers))


def free_edges(mesh):
    """Edges that one element alone has."""
    found = []
    for part in mesh.parts:
        n = part.connect.shape[1]
        found += [part.connect[:, [k, (k + 1) % n]] for k in range(n)]
    edges, count = np.unique(np.sort(np.concatenate(found), axis=1), axis=0, return_counts=True)
    assert count.max() == 2
    return edges[count == 1]


@pytest.mark.parametrize(
    "structure, area",
    [
        (BARREL, 5.0 * np.radians(160.0) * 2.0),
        (DOME, 2.0 * np.pi * 25.0 * (1.0 - np.cos(np.radians(75.0)))),
        (OPEN_DOME, 2.0 * np.pi * 25.0 * (np.cos(np.radians(15.0)) - np.cos(np.radians(75.0)))),
        # Eight half webs: R times the integral of reach - R sin a
        (GROINS, 8 * 3.0 * ((3.2 * np.sin(np.radians(70)) + 0.5) * np.radians(70) - 3.0 * (1 - np.cos(np.radians(70))))),
        (ON_WALLS, 0.6 * (4.0 * np.pi + 2 * 4.0 + 2 * 0.6)),
    ],
)
def test_areas_come_to_those_of_the_surfaces(structure, area):
    """By the second order in the size."""
    gap = [
        abs(1.0 - sum(nodal_areas(mesh.xyz, part.connect).sum() for part in mesh.parts) / area)
        for mesh in (meshed(structure, 0.6), meshed(structure, 0.3))
    ]
    assert 0.0 < gap[1] < 0.006 and 3.0 < gap[0] / gap[1] < 5.5


def test_vaults_end_where_they_should():
    """Free edges lie at the feet, at the gables, and at the eye of a dome; all nodes are of one surface."""
    ends = {
        "barrel": lambda p: np.isclose(p[:, 1], 0.0) | np.isclose(p[:, 1], 2.0) | np.isclose(p[:, 2], 5.0 * np.cos(np.radians(80.0))),
        "dome": lambda p: np.isclose(p[:, 2], 5.0 * np.cos(np.radians(75.0))),
        "open dome": lambda p: np.isclose(p[:, 2], 5.0 * np.cos(np.radians(75.0))) | np.isclose(p[:, 2], 5.0 * np.cos(np.radians(15.0))),
        "groins": lambda p: (
            np.isclose(np.abs(p[:, :2]).max(axis=1), 3.2 * np.sin(np.radians(70.0)) + 0.5)
            | np.isclose(p[:, 2], 3.0 * np.cos(np.radians(70.0)))
        ),
        "on walls": lambda p: np.isclose(p[:, 1], 0.0) | np.isclose(p[:, 1], 0.6) | np.isclose(p[:, 2], -4.0),
    }
    for name, structure in EVERY.items():
        mesh = meshed(structure)
        edges = free_edges(mesh)
        assert ends[name](mesh.xyz[edges].mean(axis=1)).all() or ends[name](mesh.xyz[edges[:, 0]]).all(), name
        assert len(np.unique(np.round(mesh.xyz, 9), axis=0)) == len(mesh.xyz)
        assert set(np.concatenate([foot.nodes for foot in mesh.feet])) == {n for n, _ in mesh.held}


def test_normals_look_outward():
    """The last layer is the extrados."""
    for name, structure in EVERY.items():
        mesh = meshed(structure)
        for part in mesh.parts:
            normal = shell_axes(mesh.xyz, part.connect)[:, 2]
            middle = mesh.xyz[part.connect].mean(axis=1)
            if part.name.endswith("wall"):
                assert (normal[:, 0] * middle[:, 0] > 0.0).all()
            else:
                assert (np.einsum("ex,ex->e", normal, middle) > 0.0).all(), (name, part.name)


@pytest.mark.parametrize("name", EVERY)
def test_feet_carry_the_weight_and_the_push(name):
    """What the feet press on the ground with is the weight, and against each other the push; alone they thrust alike."""
    mesh = meshed(EVERY[name], 0.8)
    options = Pushover(kind="pushover", mesh=ShellOptions(size=0.8, layers=3))
    model = build(mesh, options)
    with model.open(options, 1) as core_model:
        core_model.supports(model.settled, 0.0 * model.settled)
        core_model.loads(model.constant, model.reference)
        inner = core_model.reactions()
    nodes, axis = np.nonzero(model.freedoms.equation >= core_model.equations)
    of = model.freedoms.equation[nodes, axis] - core_model.equations
    own = np.stack(
        [
            np.bincount(of, model.freedoms.factor[nodes, axis] * load[nodes, axis], len(model.grounds))
            for load in (model.constant, model.reference)
        ],
        axis=1,
    )
    borne = own - inner
    by = {(mesh.feet[ground.foot].name, ground.way): borne[k] for ground, k in model.grounds.items()}
    assert sum(force[0] for (_, way), force in by.items() if way == "down") == pytest.approx(model.weight, rel=1e-9)
    assert sum(force[1] for (_, way), force in by.items() if way == "down") == pytest.approx(0.0, abs=1e-6 * model.weight)
    outs = [force for (_, way), force in by.items() if way == "out"]
    assert [force[0] for force in outs] == pytest.approx(len(outs) * [outs[0][0]], rel=1e-6) and outs[0][0] > 0.0
    if len(outs) == 2:
        assert outs[1][1] - outs[0][1] == pytest.approx(model.weight, rel=1e-9)


DECK = """
    [structure]
    kind = "arch"
    radius = 5.0
    thickness = 0.8
    embrace = 160.0
    voussoirs = 60
    depth = 0.6
    [material]
    density = 2000
    young = "5 GPa"
    poisson = 0.0
    tensile_strength = "5 kPa"
    fracture_energy = "2 N/m"
    [[analysis]]
    kind = "pushover"
    mesh = { size = "0.6 m", layers = 5 }
    ripple = 0.2
    events = 3000
"""


def deck(tmp_path, stages, change=("", "")):
    path = tmp_path / "vault.toml"
    path.write_text(textwrap.dedent(DECK).replace(*change) + stages)
    return path


BOTH = """
[[analysis.stages]]
name = "spread"
settlements = [{ foot = "all", out = "2 mm" }]
[[analysis.stages]]
name = "right"
base_shear = "15 kN"
[[analysis.stages]]
name = "off"
sense = "-"
base_shear = 0
[[analysis.stages]]
name = "left"
sense = "-"
target_displacement = "1 mm"
"""


def test_stages_inherit_the_damage(tmp_path):
    """Springings part, a push, off again, a push to the other side: loads, ways and damage go on from stage to stage, each
    ends where it is told, and the energies balance to the end."""
    found = extrados.run(deck(tmp_path, BOTH)).results[0]
    spread, right, off, left = found.results.stages
    weight = found.results.weight_N
    assert [stage.stop for stage in (spread, right, off, left)] == 3 * ["target load"] + ["target displacement"]
    assert spread.of == "settlement" and spread.last_displacement_m == pytest.approx(2e-3)
    assert spread.feet[0].thrust_N == pytest.approx(spread.feet[1].thrust_N, rel=1e-3)
    assert right.end_load_N == pytest.approx(15e3) and off.start_load_N == pytest.approx(-15e3)
    assert off.end_load_N == pytest.approx(0.0, abs=1.0) and left.start_load_N == pytest.approx(0.0, abs=1.0)
    assert left.last_displacement_m == pytest.approx(1e-3)
    for stage in (right, off, left):
        assert sum(foot.vertical_N for foot in stage.feet) == pytest.approx(weight, rel=1e-6)
    # The feet are told at the greatest load, which is that of the end where a push grows all the way
    growing = [s for s in (right, left) if s.greatest_load_N == pytest.approx(s.end_load_N)]
    assert right in growing
    for stage in growing:
        push = (1 if stage.sense == "+" else -1) * stage.end_load_N
        assert stage.feet[1].thrust_N - stage.feet[0].thrust_N == pytest.approx(push, rel=1e-4)
    dissipated = [stage.dissipated_energy_J for stage in (spread, right, off, left)]
    assert dissipated == sorted(dissipated) and dissipated[-1] > 1.2 * dissipated[0]
    assert max(stage.energy_residual_ratio for stage in (spread, right, off, left)) < 1e-8
    base = np.isclose(found["node"][:, 2], found["node"][:, 2].min())
    moved = found["stage_2_state_displacement"][-1][base]
    assert moved[:, 0] == pytest.approx(2e-3 * np.sign(found["node"][base, 0]), abs=1e-9)
    assert found.results.sense == "-" and left.prefix == "" and any("cracks stay open" in w for w in found.warnings)


def test_a_spreading_barrel_opens_in_three_hinge_lines(tmp_path):
    """At the crown from the intrados, at both haunches from the extrados; the thrust goes down."""
    stages = '\n[[analysis.stages]]\nsettlements = [{ foot = "left", out = "4 mm" }]\n'
    found = extrados.run(deck(tmp_path, stages)).results[0]
    x, width, side = found["place_xyz"][:, 0], found["state_width"][-1], found["state_side"][-1]
    wide = width > 0.1 * width.max()
    crown, haunch = wide & (np.abs(x) < 1.5), wide & (np.abs(x) > 3.5)
    assert crown.any() and (side[crown] == -1.0).all()
    assert (side[haunch] == 1.0).all() and (x[haunch] < 0.0).any() and (x[haunch] > 0.0).any()
    assert found.results.stages[0].feet[0].thrust_N < 30e3  # the elastic vault's 35 kN and more
    assert found.results.stages[0].of == "settlement" and "After stage 1" in found.answer


@pytest.mark.parametrize(
    "stages, change, words",
    [
        (
            '\n[[analysis.stages]]\nsettlements = [{ foot = "springing", out = 0.01 }]\n',
            ("", ""),
            "foot 'springing' does not exist; expected one of left, right",
        ),
        ("\n[[analysis.stages]]\nbase_shear = -5.0\n", ("", ""), "not below"),
        ('control = { wall = "a", storey = 1 }\n', ("", ""), "it has none"),
        ("", ("depth = 0.6", "depth = 0.6\nskew = 20"), "skew"),
    ],
)
def test_limits_of_a_vault_are_reported(tmp_path, stages, change, words):
    run = extrados.run(deck(tmp_path, stages, change)).results[0]
    assert run.status == "refused" and words in run.reason


@pytest.mark.parametrize(
    "keys, words",
    [
        ({"settlements": [{"out": 0.01}]}, "either the key `wall`"),
        ({"settlements": [{"foot": "left"}]}, "does not move"),
        ({"stages": [{"settlements": [{"foot": "left", "out": 0.01}], "sense": "-"}]}, "give two stages"),
        ({"stages": [{"name": "a"}, {"name": "a"}]}, "occurs twice"),
        ({"stages": [{}], "directions": ["+", "-"]}, "together with stages"),
        ({"stages": [{}], "without_equilibrium": "proportional"}, 'without_equilibrium = "proportional" cannot be used together with'),
        ({"main_stage": "a"}, "without stages"),
    ],
)
def test_wrong_stages_are_reported(keys, words):
    with pytest.raises(ValueError, match=words):
        Pushover(kind="pushover", **keys)


@pytest.mark.parametrize(
    "thrust, vertical, words",
    [
        (2e3, 5e3, "presses outward with 2 kN and down with 5 kN"),
        (-1.2e-11, 5e3, "presses down with 5 kN"),  # rounding
        (-3e3, -1e3, "presses inward with 3 kN and up with 1 kN"),
        (0.0, 1e-9, "carries nothing"),
    ],
)
def test_the_force_of_a_foot_on_the_ground_is_reported_in_words(thrust, vertical, words):
    assert pressing({"thrust_N": thrust, "vertical_N": vertical}, 1e5) == words


def test_thick_walls_are_no_shells():
    with pytest.raises(BadGeometry, match="Shells require"):
        meshed(ON_WALLS.model_copy(update={"buttress_width": 2.5}))
    with pytest.raises(NoView, match="skew"):
        meshed(BARREL.model_copy(update={"skew": 10.0}))
    with pytest.raises(Refused, match="density"):
        build(Building(BARREL, MASONRY.model_copy(update={"density": 0.0})).shell(ShellOptions(size=0.8)), Pushover(kind="pushover"))


def test_a_released_load_is_never_raised_on_the_way(tmp_path):
    """Force release keeps the load while a tooth's forces go onto the others, also where a crack that closes, or one that
    just touches its strength, has its lower limit above the load."""
    path = tmp_path / "dome.toml"
    path.write_text(
        textwrap.dedent("""
        [structure]
        kind = "dome"
        radius = 5.0
        thickness = 0.5
        embrace = 150.0
        rings = 12
        lunes = 24
        [material]
        density = 2000
        young = "5 GPa"
        poisson = 0.0
        tensile_strength = "1 kPa"
        fracture_energy = "0.05 N/m"
        [[analysis]]
        kind = "pushover"
        mesh = { size = "2 m", layers = 3 }
        ripple = 0.2
        events = 4500
        without_equilibrium = "force-release"
        crack_closure = true
        """)
    )
    run = extrados.run(path).results[0]
    load, held = run["event_load"], run["event_equilibrium"].astype(bool)
    on_the_way = ~held[1:]
    assert on_the_way.sum() > 1000 and held.sum() > 1000
    assert np.abs(np.diff(load))[on_the_way].max() <= 1e-9 * np.abs(load).max()


@pytest.mark.verify
def test_the_limit_of_a_dome_of_stones_depends_on_their_friction(tmp_path):
    """Pushed, its stones slide; where they cannot, no push brings it down. A shell, which does not slide, is no other view of the
    same limit."""

    def limit(friction):
        text = """
            [structure]
            kind = "dome"
            radius = 5.0
            thickness = 0.5
            embrace = 150.0
            rings = 4
            lunes = 8
            [joints]
            friction = FRICTION
            [analysis]
            kind = "tilt"
            direction = 0
        """
        (tmp_path / "dome.toml").write_text(textwrap.dedent(text).replace("FRICTION", friction))
        return extrados.run(tmp_path / "dome.toml").results[0]

    low, high, none = limit("0.7"), limit("2.0"), limit('"no-sliding"')
    assert high.results.collapse_acceleration_g > 1.5 * low.results.collapse_acceleration_g
    assert none.status == "refused" and "restrain the blocks on all sides" in none.reason
