"""dem of blocks in space from a deck: runs, tilt against limit analysis, what falls, files of solids, refusals."""

import json
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from matplotlib.collections import LineCollection

import extrados
from extrados.analyses.dem.impact_rules import ContactValues
from extrados.analyses.dem.solid_model import SolidModel
from extrados.decks.reader import DeckError
from extrados.model.geometry.solids.assembly import Stone, assemble
from extrados.model.geometry.solids.columns import doweled, drums
from extrados.model.geometry.solids.polyhedra import box
from extrados.schema.constants import GRAVITY
from extrados.views.solids.supports import supports_of

COLUMN = """
[structure]
kind = "column"
section = "round"
sides = 8
width = 1.0
height = 2.0
drums = 2
[joints]
normal_stiffness = 1e9
"""
PULSE = """
[motion]
kind = "sine-pulse"
amplitude = "0.6 g"
period = 0.6
"""
OBJ = "\n".join(f"v {x} {y} {z}" for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1)))
CUBE = "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n"


def answered(tmp_path, text: str, **options: Any) -> Any:
    deck = tmp_path / "deck.toml"
    deck.write_text(text)
    return extrados.run(deck, **options).results[0]


def test_a_column_rocks_in_the_direction_of_the_motion(tmp_path) -> None:
    """Along and against: mirrored; and the wholes of it are told and stored."""
    there, back = (
        answered(tmp_path, f'{COLUMN}{PULSE}[[analysis]]\nkind = "dem"\nend_time = 0.8\ndirection = {d}\n') for d in (90.0, -90.0)
    )
    assert there.status == "ok" and there.results.outcome == "rocked" and there.results.energy_residual_ratio < 1e-2
    assert there.results.time_step_s == pytest.approx(0.5 * there.results.critical_step_s)
    shift, other = (r.arrays["shift"].data for r in (there, back))
    assert np.abs(shift[..., 1]).max() > 0.02
    assert shift[..., 1] == pytest.approx(-other[..., 1], abs=5e-3 * np.abs(shift).max())
    assert np.abs(shift[..., 0]).max() < 0.01 * np.abs(shift[..., 1]).max()
    assert there.results.peak_displacement_m == pytest.approx(np.linalg.norm(shift, axis=2).max())
    assert there.arrays["state"].data.max() == 1 and list(there.results.peak_rotation_rad) == ["drum 1", "drum 2"]
    assert "dem.glb" in there.files and there.answer.startswith("Blocks rock")


def test_energies_of_a_run_in_space_are_drawn(tmp_path) -> None:
    deck = tmp_path / "deck.toml"
    deck.write_text(f'{COLUMN}{PULSE}[[analysis]]\nkind = "dem"\nend_time = 0.02\n')
    drawn = extrados.run(deck).plot("dem")
    assert "The balance has an error of" in drawn.captions["dem-energy"]


def test_one_contact_and_its_damper_are_drawn(tmp_path) -> None:
    """The map of the contacts has a row; the damper is a line from the block, which carries its end, to its place on the ground."""
    deck = tmp_path / "deck.toml"
    block = '[structure]\nkind = "block"\nwidth = 1.0\nheight = 4.0\ndepth = 0.8\n'
    damper = '[[dampers]]\nname = "d"\nstart = [0.5, 0.4, 3.5]\nground = [2.0, 0.4, 3.5]\ndamping = "1 kN*s/m"\n'
    deck.write_text(f'{block}{PULSE}{damper}[[analysis]]\nkind = "dem"\nsolver = "nonsmooth"\ndirection = 0.0\nend_time = 0.3\n')
    run = extrados.run(deck)
    assert "Forces of ties and dampers (tension positive): d reaches" in run.results[0].answer
    drawn, pose = run.plot("dem"), run.results[0].arrays["pose"].data
    assert drawn["dem-contacts"].axes[0].get_ylim() == (-0.5, 0.5)
    assert len(drawn["dem-forces"].axes) == 1  # nothing slides
    lines = [one for ax in drawn["dem-snapshots"].axes for one in ax.collections if isinstance(one, LineCollection)]
    first, last = (np.array(lines[k].get_segments()) for k in (0, 5))
    assert first.shape == (1, 2, 2) and last[0, 1] == pytest.approx(first[0, 1])
    moved = pose[-1, 0, 0] - pose[0, 0, 0] + 1.5 * (pose[-1, 0, 4] - pose[0, 0, 4])  # of the end, 1.5 m above the middle, along x
    assert abs(moved) > 1e-3 and np.linalg.norm(last[0, 0] - first[0, 0]) == pytest.approx(abs(moved) * 0.877, rel=0.15)


def test_both_horizontal_components_of_a_record_act_at_once(tmp_path) -> None:
    """As they were recorded, however the structure is turned against the record: first along x, second along y."""
    t = np.arange(0.0, 0.6, 0.01)
    for name, wave in (("one", 0.5 * np.sin(10.0 * t)), ("other", 0.4 * np.cos(7.0 * t))):
        np.savetxt(tmp_path / f"{name}.csv", np.column_stack([t, wave]), delimiter=",")
    found = []
    for turn in (0.0, 90.0):
        motion = f'[motion]\nkind = "record"\nfile = "one.csv"\nsecond = "other.csv"\nangle = {turn}\nunit = "g"\n'
        found.append(answered(tmp_path, f'{COLUMN}{motion}[[analysis]]\nkind = "dem"\nend_time = 0.5\ndirection = {turn}\n'))
    there, turned = found
    assert there.results.horizontal_components == turned.results.horizontal_components == 2
    shift, other = (r.arrays["shift"].data for r in (there, turned))
    assert np.abs(shift).max(axis=(0, 1))[:2].min() > 5e-3
    assert other == pytest.approx(shift, abs=1e-3 * np.abs(shift).max())
    assert there.arrays["ground_across"].data == pytest.approx(turned.arrays["ground"].data)
    assert turned.arrays["ground_across"].data == pytest.approx(-there.arrays["ground"].data)


@pytest.mark.verify
@pytest.mark.parametrize("solver", ["compliant", "nonsmooth"])
@pytest.mark.parametrize(
    ("structure", "direction"),
    [
        ('kind = "column"\nsection = "round"\nsides = 12\nwidth = 1.0\nheight = 4.0\ndrums = 2', 40.0),
        ('kind = "wall"\nunit_length = 1.0\nunit_height = 0.5\nthickness = 0.3\nheight = 1.0\nlegs = [{ length = 2.0 }]', 90.0),
        ('kind = "arch"\nradius = 5.0\nthickness = 1.0\nembrace = 150.0\nvoussoirs = 7', 0.0),
    ],
)
def test_tilt_is_that_of_limit_analysis(tmp_path, structure: str, direction: float, solver: str) -> None:
    """Within 1 % on stiff joints and on rigid contacts: a column, a wall out of its plane, an arch with depth."""
    assert tilted_as_limit_analysis(tmp_path, structure, direction, solver, 0.7).opening_contacts


@pytest.mark.verify
@pytest.mark.parametrize("solver", ["compliant", "nonsmooth"])
def test_dowels_carry_the_force_of_limit_analysis(tmp_path, solver: str) -> None:
    """A drum that slides on a dowel: friction plus the dowel's strength over the weight, within 1 % by both."""
    structure = 'kind = "column"\nsection = "round"\nsides = 16\nwidth = 1.0\nheight = 1.2\ndrums = 2\ndowels = "2 kN"'
    structure += '\n[[joints.types]]\njoints = ["ground"]\nfriction = 1.0'  # the lower drum does not slide first
    found = tilted_as_limit_analysis(tmp_path, structure, 20.0, solver, 0.25)
    weight = 2000.0 * GRAVITY * 0.6 * 0.5 * 16 * 0.25 * np.sin(np.pi / 8)
    assert found.collapse_acceleration_g == pytest.approx(0.25 + 2000.0 / weight, rel=0.01)


def tilted_as_limit_analysis(tmp_path, structure: str, direction: float, solver: str, friction: float) -> Any:
    """Results of elements, held against limit analysis."""
    text = (
        f"[structure]\n{structure}\n[material]\ndensity = 2000\n[joints]\nnormal_stiffness = 1e11\nfriction = {friction}\n"
        f'[[analysis]]\nkind = "tilt"\ndirection = {direction}\nrose = 4\n'
        f'[[analysis]]\nkind = "dem"\ntest = "tilt"\ndirection = {direction}\ntilt_limit = "0.8 g"\ntilt_accuracy = 5e-4\n'
        f'solver = "{solver}"\n'
    )
    deck = tmp_path / "deck.toml"
    deck.write_text(text)
    limit, elements = (r.results for r in extrados.run(deck).results)
    for key in ("collapse_acceleration_g", "collapse_acceleration_opposite_g"):
        assert getattr(elements, key) == pytest.approx(getattr(limit, key), rel=0.01)
    return elements


def test_solids_of_a_file_stand_or_fall(tmp_path) -> None:
    """A cube from an OBJ stands; one whose middle lies outside its base falls, and limit analysis says why."""
    (tmp_path / "stones.obj").write_text(f"o cube\n{OBJ}\n{CUBE}")
    text = '[structure]\nkind = "blocks"\nfile = "stones.obj"\nunit = "m"\n[joints]\nnormal_stiffness = 1e8\n[[analysis]]\nkind = "dem"\n'
    stands = answered(tmp_path, text)
    assert stands.status == "ok" and stands.results.outcome == "at-rest"
    assert stands.answer.startswith("The structure stands under its own weight. No motion acts on it.")
    leaning = "\n".join(f"v {x + 1.1 * z} {y} {z}" for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1)))
    (tmp_path / "stones.obj").write_text(f"o slab\n{leaning}\n{CUBE}")
    falls = answered(tmp_path, text)
    assert falls.status == "ok" and falls.verdict.outcome == "cannot-stand"
    assert "does not stand under its own weight: slab falls" in falls.answer and "certificate: " in falls.answer


@pytest.mark.parametrize(
    ("more", "of_dem", "told"),
    [
        ("", "mass_damping = 1.0", "mass_damping"),
        ("", "vary_damping = [0.5]", "vary_damping"),
        ("[initial]\nrotation_ratio = 0.5\n", "", "rotation_ratio"),
        ("worn_corners = 0.01\n", "", "worn corners"),
        ("", 'track = ["drum 9"]', "no block has the name 'drum 9'"),
    ],
)
def test_what_solids_do_not_know_is_refused_by_name(tmp_path, more: str, of_dem: str, told: str) -> None:
    found = answered(tmp_path, f'{COLUMN}{more}[[analysis]]\nkind = "dem"\n{of_dem}\n')
    assert found.status == "refused" and told in found.reason


def test_dowels_stand_in_the_lower_drum(tmp_path) -> None:
    """And reach into the one above it, whatever the order in which stones and their contact are named."""
    made = doweled(drums(1.0, [0.5, 0.5, 0.5], None, 8, 0.0, 2000.0), 1e3, 0.1)
    turned = replace(made, a=made.b, b=made.a, normal=-made.normal, polygon=[p[::-1] for p in made.polygon])
    values = ContactValues(*(np.ones(len(made.a)) for _ in range(5)), 1e-3, None)
    for one in (made, turned):
        dowels = SolidModel(one, supports_of(made), values).bodies().dowels
        assert dowels.body.tolist() == [[0, 1], [1, 2]]
        assert dowels.axis == pytest.approx(np.tile([0.0, 0.0, 1.0], (2, 1)))
        assert dowels.stiffness == pytest.approx(made.area[made.b >= 0])


def test_dowels_of_a_deck(tmp_path) -> None:
    """Dowels hold drums that friction alone does not, and disengage at their reach; springs and rigid contacts report both."""
    slippery = (
        COLUMN
        + 'friction = 0.1\n[[joints.types]]\njoints = ["ground"]\nfriction = 1.0\n'
        + PULSE
        + '[[analysis]]\nkind = "dem"\nend_time = 0.6\n'
    )
    doweled = slippery.replace("drums = 2", 'drums = 2\ndowels = "unbroken"\ndowel_reach = "5 cm"')
    free, held = (answered(tmp_path, text).results for text in (slippery, doweled))
    assert (free.dowels, held.dowels, held.dowels_out, held.dowel_slip_m) == (0, 1, 0, 0.0)
    assert free.peak_slip_m > 20.0 * held.peak_slip_m
    rocks = answered(tmp_path, doweled.replace("height = 2.0", "height = 5.0").replace("5 cm", "1 mm").replace("friction = 0.1", ""))
    assert rocks.results.dowels_out == 1 and ", 1 of 1 came out" in rocks.answer
    weak = answered(tmp_path, doweled.replace("unbroken", "1 kN"))
    assert weak.results.dowel_slip_m > 1e-3
    assert "; dowels slipped by up to " in weak.answer
    rigid = [answered(tmp_path, text + 'solver = "nonsmooth"\n').results for text in (doweled, doweled.replace("unbroken", "1 kN"))]
    assert rigid[0].peak_slip_m < 1e-6 and rigid[0].dowel_slip_m == 0.0
    assert rigid[1].dowel_slip_m == pytest.approx(weak.results.dowel_slip_m, rel=0.05)


RIGID = 'solver = "nonsmooth"\n'


def test_a_column_rocks_on_rigid_contacts(tmp_path) -> None:
    """Along and against: mirrored; the answer says how far the contacts converged and has no stiffness."""
    there, back = (
        answered(tmp_path, f'{COLUMN}{PULSE}[[analysis]]\nkind = "dem"\nend_time = 0.8\ndirection = {d}\n{RIGID}') for d in (90.0, -90.0)
    )
    r = there.results
    assert there.status == "ok" and r.outcome == "rocked" and r.energy_residual_ratio < 1e-2
    assert r.solver == "nonsmooth" and r.beta_s is None and r.critical_step_s is None
    assert r.convergence.open_steps == 0 and r.convergence.steps == pytest.approx(r.steps, abs=2)
    assert "rigid contacts converged in all" in there.answer and not any("damped" in text for text in there.warnings)
    shift, other = (found.arrays["shift"].data for found in (there, back))
    assert np.abs(shift[..., 1]).max() > 0.02
    assert shift[..., 1] == pytest.approx(-other[..., 1], abs=5e-3 * np.abs(shift).max())


def test_rebound_and_rest_without_inertia_are_heard_of_solids(tmp_path) -> None:
    """With a rebound drums leave what they hit; without inertia a push falls at once that is more than statics bear."""
    text = f'{COLUMN}{PULSE}[[analysis]]\nkind = "dem"\nend_time = 0.6\n{RIGID}'
    dead, lively = (answered(tmp_path, f"{text}rebound = {e}\n").results for e in (0.0, 0.8))
    assert dead.bounces == 0 and lively.bounces > 5
    push = '[motion]\nkind = "constant"\namplitude = "{}"\n[[analysis]]\nkind = "dem"\nend_time = 2.0\nquasi_static = true\n'
    for amplitude, outcome in (("0.45 g", "at-rest"), ("0.55 g", "collapse")):
        found = answered(tmp_path, f"{COLUMN}{push.format(amplitude)}{RIGID}")
        assert found.results.outcome == outcome and (found.results.collapse_time_s == 0.0) == (outcome == "collapse")


DOMAIN = (
    '[structure]\nkind = "block"\nwidth = 0.5\nheight = 2.0\n[joints]\nfriction = 2.0\n[[analysis]]\nkind = "dem-domain"\n'
    f'{RIGID}amplitudes = ["0.5 g", "0.8 g"]\ndurations = [0.1, 0.2, 0.3, 0.4, 0.5]\naccuracy = 0.02\n'
)


def test_the_map_of_a_section_drawn_out_is_that_of_the_plane(tmp_path) -> None:
    """By both solvers, which agree in most cells."""
    plane = answered(tmp_path, DOMAIN).results
    space = answered(tmp_path, f"{DOMAIN}direction = 0.0\ncross_check = true\n").results
    assert plane.direction_deg is None and space.direction_deg == 0.0
    assert space.shortest_durations_s == pytest.approx(plane.shortest_durations_s, abs=0.02)
    assert [c.solver for c in space.curves] == ["nonsmooth", "compliant"] and space.curves[0].beta_s is None
    assert space.cross_check.cells == 10 and space.cross_check.agreement_ratio >= 0.9
    assert space.convergence.open_steps == 0


@pytest.mark.parametrize("key", ["mode_II = true", "vary_friction = [0.5]"])
def test_what_maps_of_solids_do_not_know_is_refused(tmp_path, key: str) -> None:
    found = answered(tmp_path, f"{DOMAIN}direction = 0.0\n{key}\n")
    assert found.status == "refused" and key.split(" ")[0] in found.reason


def test_rigid_contacts_find_what_falls(tmp_path) -> None:
    """Under its own weight; and a push without inertia ends as limit analysis says."""
    (tmp_path / "stones.obj").write_text(f"o cube\n{OBJ}\n{CUBE}")
    text = f'[structure]\nkind = "blocks"\nfile = "stones.obj"\nunit = "m"\n[[analysis]]\nkind = "dem"\n{RIGID}'
    assert answered(tmp_path, text).answer.startswith("The structure stands under its own weight. No motion acts on it.")
    leaning = "\n".join(f"v {x + 1.1 * z} {y} {z}" for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1)))
    (tmp_path / "stones.obj").write_text(f"o slab\n{leaning}\n{CUBE}")
    falls = answered(tmp_path, text)
    assert falls.verdict.outcome == "cannot-stand" and "slab falls" in falls.answer


@pytest.mark.parametrize(
    ("of_dem", "told"),
    [("fraction = 0.1", "rigid contacts have no stiffness"), ("vary_stiffness = [2.0]", "rigid contacts have no stiffness")],
)
def test_what_only_springs_know_is_refused_of_rigid_contacts(tmp_path, of_dem: str, told: str) -> None:
    with pytest.raises(DeckError, match=told):
        answered(tmp_path, f'{COLUMN}[[analysis]]\nkind = "dem"\n{RIGID}{of_dem}\n')


def test_footings_are_no_floor() -> None:
    """A quarter wider on all sides, no wider where a stone stands there; a floor that is named replaces those on it."""
    stones = [Stone("a", [box((0, 0, 0), (1, 1, 1))], 2000.0), Stone("b", [box((3, 0, 0), (4, 1, 1))], 2000.0)]
    assembly = assemble(stones)
    found = supports_of(assembly)
    assert found.of_joint.tolist() == [0, 1]
    assert found.bodies[0].low == pytest.approx([-0.25, -0.25, -1.0]) and found.bodies[0].high[:2] == pytest.approx([1.25, 1.25])
    named = supports_of(assembly, floor=0.0)
    assert named.of_joint.tolist() == [0, 0] and len(named.bodies) == 1


def test_a_section_drawn_out_stands_on_its_springings(tmp_path) -> None:
    """An arch asked for with a direction: its contacts with the ground may have the ground on either side."""
    arch = 'kind = "arch"\nradius = 5.0\nthickness = 1.0\nembrace = 150.0\nvoussoirs = 5'
    found = answered(
        tmp_path, f'[structure]\n{arch}\n[joints]\nnormal_stiffness = 1e9\n[[analysis]]\nkind = "dem"\ndirection = 0.0\nend_time = 0.05\n'
    )
    assert found.status == "ok" and found.results.outcome == "at-rest" and found.results.contacts == 6


def test_stored_results_are_typed(tmp_path) -> None:
    found = answered(tmp_path, f'{COLUMN}{PULSE}[[analysis]]\nkind = "dem"\nend_time = 0.1\nvtk = true\n', out=tmp_path / "out")
    summary = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert summary["analyses"][0]["results"]["contacts"] == found.results.contacts == 2
    assert (tmp_path / "out" / "dem.pvd").exists() and (tmp_path / "out" / "dem.glb").exists()


@pytest.mark.parametrize(
    "structure",
    [
        'kind = "wall"\nunit_length = 0.6\nunit_height = 0.3\nthickness = 0.3\nheight = 1.2\nlegs = [{ length = 2.4, openings = '
        '[{ x = [0.9, 1.5], y = [0.3, 0.9] }] }, { length = 1.2, turn = "right" }]\n',
        'kind = "cross-vault"\nradius = 3.0\nthickness = 0.5\nembrace = 140.0\nvoussoirs = 6\nstone_length = 1.5\n',
        'kind = "dome"\nradius = 3.0\nthickness = 0.5\nembrace = 120.0\nrings = 4\nlunes = 6\n',
    ],
    ids=["a corner and an opening", "a cross-vault", "a dome"],
)
def test_what_is_more_than_a_column_is_followed(tmp_path, structure: str) -> None:
    """It settles and is shaken, and the ledger closes."""
    text = (
        f'[structure]\n{structure}[joints]\nfriction = 0.7\nnormal_stiffness = 2e9\n[motion]\nkind = "sine-pulse"\n'
        'amplitude = "0.5 g"\nperiod = 0.3\n[[analysis]]\nkind = "dem"\ndirection = 60.0\nend_time = 0.3\n'
    )
    found = answered(tmp_path, text)
    assert found["stopped"] == "end" and found["energy_residual_ratio"] < 0.01


SLAB = """
[structure]
kind = "column"
section = "round"
sides = 6
width = 2.0
height = 0.4
drums = 1
[joints]
friction = 0.3
normal_stiffness = 1e10
[motion]
kind = "constant"
amplitude = "0.5 g"
duration = 1.0
"""


@pytest.mark.parametrize("solver", ["compliant", "nonsmooth"])
def test_forces_and_work_of_friction_of_a_sliding_slab(tmp_path, solver: str) -> None:
    """The reaction is weight and mu times it, against the slip; friction loses their product with the way."""
    text = f'{SLAB}[[analysis]]\nkind = "dem"\nend_time = 0.5\nperturbed = false\nfloor = 0.0\ndirection = 30.0\nsolver = "{solver}"\n'
    found = answered(tmp_path, text)
    weight = float(2000.0 * GRAVITY * 0.4 * 6 * np.sin(np.pi / 3) / 2)
    reaction = found.arrays["reaction"].numbers
    assert reaction[0, 2] == pytest.approx(weight, rel=0.02)
    way = np.array([np.cos(np.pi / 6), np.sin(np.pi / 6)])
    late = reaction[len(reaction) // 2 :]
    assert late[:, 2] == pytest.approx(weight, rel=0.01)
    assert late[:, :2] == pytest.approx(np.tile(0.3 * weight * way, (len(late), 1)), abs=0.01 * weight)
    assert found.results.peak_base_shear_over_weight == pytest.approx(0.3, rel=0.05)
    slid = float(np.linalg.norm(found.arrays["shift"].numbers[-1, 0]))
    assert slid == pytest.approx(0.5 * 0.2 * GRAVITY * 0.25, rel=0.02)
    (row,) = found.results.joint_work
    assert row.name == "drum 1 / ground" and row.friction_J == pytest.approx(0.3 * weight * slid, rel=0.01)
    assert found.arrays["pair_friction_work"].numbers[-1].sum() == pytest.approx(found.results.friction_loss_J, rel=1e-9)


def test_forces_of_a_rocking_column_are_its_momentum(tmp_path) -> None:
    """The mean reaction is the rate of momentum less weights and inertia; forces of pairs balance the drum above."""
    quick = f'{COLUMN}{PULSE}[[analysis]]\nkind = "dem"\nend_time = 0.6\noutput_step = 0.001\nperturbed = false\nsolver = "nonsmooth"\n'
    found = answered(tmp_path, quick)
    a = {name: array.numbers for name, array in found.arrays.items()}
    blocks = found.results.blocks
    mass = 2000.0 * 8 * 0.25 * np.sin(np.pi / 4) / 2  # of a drum 1 m high
    momentum = mass * a["rate"][:, :, :3].sum(axis=1)
    inertia = mass * np.column_stack([a["ground"], np.zeros(len(a["ground"])), np.full(len(a["ground"]), GRAVITY)])
    step = np.diff(a["time"])[:, None]
    smooth = a["time"][1:] < 0.3  # an impact between two outputs shows in none
    assert a["pair_block"].tolist() == [[0, 1], [0, -1]] and blocks == 2
    above = -a["pair_force"][:, 0]  # on the upper drum
    for force, count, gain in ((a["reaction"], 2, momentum), (above, 1, mass * a["rate"][:, 1, :3])):
        moves = force - count * inertia
        gained = np.cumsum(0.5 * (moves[1:] + moves[:-1]) * step, axis=0)
        assert gained[smooth] == pytest.approx((gain[1:] - gain[0])[smooth], abs=0.02 * np.abs(gain[1:][smooth]).max())
    assert a["pair_friction_work"][-1].sum() == pytest.approx(found.results.friction_loss_J, rel=1e-9)


@pytest.mark.parametrize("solver", ["compliant", "nonsmooth"])
def test_what_a_contact_lost_is_kept_while_it_is_open(tmp_path, solver: str) -> None:
    """A slab slides, is dropped by the ground for 0.1 s, flies 14 cm high and lands: its losses never fall, and are those of the whole."""
    time = np.arange(0.0, 1.0, 0.01)
    for name, wave in (("along", np.full(100, 0.5)), ("up", np.where((time > 0.15) & (time < 0.25), -2.5, 0.0))):
        np.savetxt(tmp_path / f"{name}.csv", np.column_stack([time, wave]), delimiter=",")
    motion = '[motion]\nkind = "record"\nfile = "along.csv"\nvertical = "up.csv"\nunit = "g"\n'
    asked = f'[[analysis]]\nkind = "dem"\nend_time = 0.7\nperturbed = false\nfloor = 0.0\nsolver = "{solver}"\n'
    found = answered(tmp_path, SLAB.split("[motion]")[0] + motion + asked)
    r = found.results
    assert found.arrays["shift"].numbers[:, 0, 2].max() > 0.13 and r.energy_residual_ratio < 0.01
    for name, whole in (("pair_friction_work", r.friction_loss_J), ("pair_damping_work", r.damping_loss_J)):
        lost = found.arrays[name].numbers
        assert np.diff(lost, axis=0).min() >= -1e-9 * whole
        assert lost[-1].sum() == pytest.approx(whole, rel=1e-9)
