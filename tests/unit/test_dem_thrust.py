"""Places of forces in joints of discrete elements and stresses at their edges, against statics, closed forms and limit analysis."""

import numpy as np
import pytest

import extrados
from extrados.analyses.dem.from_deck import make_model
from extrados.analyses.dem.tables import Dem
from extrados.analyses.dem.thrust import Thrust, corner_stress, edge_stress, redundancy
from extrados.decks.reader import make_deck
from extrados.schema.constants import GRAVITY

STILL = '[[analysis]]\nkind = "dem"\nthrust = true\nperturbed = false\nend_time = {end}\n'


def found(tmp_path, text: str):
    (tmp_path / "deck.toml").write_text(text)
    return extrados.run(tmp_path / "deck.toml")


@pytest.mark.parametrize("share", [0.5, 0.4, 1.0 / 3.0, 0.2, 0.75])
def test_linear_pressure_without_tension(share: float) -> None:
    """Force and centre of the pressure between the two stresses are those given; a rectangle in space has the same."""
    first, second = edge_stress(np.array([3.0]), np.array([share]))[0]
    reach = 1.0 if min(first, second) > 0.0 else 3.0 * min(share, 1.0 - share)
    x = np.linspace(0.0, 1.0, 200001)
    pressure = np.maximum(np.interp(x, [0.0, 1.0], [first, second]), 0.0)
    if reach < 1.0:
        pressure = np.maximum(first * (1.0 - x / reach), 0.0) + np.maximum(second * (1.0 - (1.0 - x) / reach), 0.0)
    force = np.trapezoid(pressure, x)
    assert force == pytest.approx(3.0, rel=1e-4)
    assert np.trapezoid(pressure * x, x) / force == pytest.approx(share, rel=1e-4)
    rectangle = np.array([[-1.0, -0.5], [1.0, -0.5], [1.0, 0.5], [-1.0, 0.5]])
    corners = corner_stress(rectangle, np.array([6.0]), np.array([[2.0 * share - 1.0, 0.0]]))[0]
    assert corners == pytest.approx([first, second, second, first], rel=1e-6, abs=1e-9)


def test_pressure_at_a_corner_alone_has_no_finite_stress() -> None:
    triangle = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
    assert np.isinf(corner_stress(triangle, np.array([1.0]), np.array([[0.0, 0.0]]))[0, 0])
    assert edge_stress(np.array([1.0]), np.array([1.0]))[0].tolist() == [0.0, np.inf]


def test_any_centre_within_a_contact_has_a_pressure() -> None:
    """Closed form of a force near a corner of a square: a pyramid of three equal legs 4 d; others in equilibrium with their force."""
    square = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    for d in (0.01, 0.1, 0.2):
        assert corner_stress(square, np.array([1.0]), np.array([[d, d]]))[0] == pytest.approx([6.0 / (4.0 * d) ** 2, 0, 0, 0], rel=1e-6)
    centres = np.random.default_rng(1).uniform(0.002, 0.998, (20, 2))
    for shape in (square, square[::-1], square * [3.0, 0.3]):
        stress = corner_stress(shape, np.ones(20), centres * np.ptp(shape, axis=0))
        assert np.isfinite(stress).all() and (stress >= 0.0).all()
        assert (stress.max(axis=1) * np.ptp(shape, axis=0).prod() >= 1.0 - 1e-9).all()
    edge = corner_stress(square, np.array([1.0]), np.array([[0.4, 0.0]]))[0]
    assert edge.tolist() == [np.inf, 0.0, 0.0, 0.0]


def test_worn_corners_refuse_the_place_of_a_force(tmp_path) -> None:
    text = '[structure]\nkind = "block"\nwidth = 1\nheight = 2\n[joints]\nworn_corners = 0.05\n' + STILL.format(end=0.1)
    assert "worn corners shorten" in found(tmp_path, text).analyses[0]["reason"]


@pytest.mark.parametrize("direction", ["", "direction = 0.0\n"])
def test_a_block_under_its_weight_and_a_moment(direction: str, tmp_path) -> None:
    """A constant acceleration below uplift: trapezoidal pressure W/A (1 + 6 e/B), e = a/g h/2."""
    width, height, share = 1.0, 2.0, 0.12
    text = f'[structure]\nkind = "block"\nwidth = {width}\nheight = {height}\n[material]\ndensity = 2000\n'
    text += f'[joints]\nfriction = 1.0\nnormal_stiffness = 1e8\nbeta = 0.02\n[motion]\nkind = "constant"\namplitude = "{share} g"\nduration = 9\n'
    run = found(tmp_path, text + STILL.format(end=3.0) + direction)
    mean, e = 2000.0 * GRAVITY * height, share * height / 2.0
    last = np.sort(run.array("dem", "edge_stress")[-1].ravel())
    assert last.max() == pytest.approx(mean * (1.0 + 6.0 * e / width), rel=0.01)
    assert last.min() == pytest.approx(mean * (1.0 - 6.0 * e / width), rel=0.02)
    assert run["dem"]["edge_stress_at_rest_Pa"] == pytest.approx(mean, rel=0.01)
    force = run.array("dem", "thrust_force")[-1, 0]
    assert force[-1] == pytest.approx(mean * width, rel=0.01)
    place = run.array("dem", "thrust_place")[-1, 0]
    assert abs(place[0] - run.array("dem", "thrust_place")[0, 0, 0]) == pytest.approx(e, rel=0.01)


@pytest.mark.parametrize("stiffness", [1e9, 1e11])
def test_an_arch_at_rest_has_an_admissible_line_in_equilibrium(stiffness: float, tmp_path) -> None:
    """The forces at their places are in equilibrium with the weight of each voussoir, and the horizontal thrust lies within the limits."""
    text = '[structure]\nkind = "arch"\nradius = 10.0\nthickness = 1.5\nembrace = 157.5\nvoussoirs = 9\n'
    text += f"[joints]\nnormal_stiffness = {stiffness}\n"
    run = found(tmp_path, text + STILL.format(end=0.2) + '[[analysis]]\nkind = "tilt"\n')
    force, place = (run.array("dem", name)[-1] for name in ("thrust_force", "thrust_place"))
    a, b = run.array("dem", "joint_block").T
    centre = run.array("dem", "place")[-1, :, :2]
    weight = float(np.abs(force[:, 1]).max())
    for k in range(len(centre)):
        moment = 0.0
        for j in range(len(force)):
            way = 1.0 if a[j] == k else -1.0 if b[j] == k else 0.0
            arm = place[j] - centre[k]
            moment += way * (arm[0] * force[j, 1] - arm[1] * force[j, 0])
        assert abs(moment) < 0.01 * weight * 1.5
    horizontal = np.abs(force[:, 0])
    least, most = (run["tilt"][name] for name in ("thrust_min_N", "thrust_max_N"))
    assert horizontal == pytest.approx(horizontal.mean(), rel=0.01)
    assert (least, horizontal.mean(), most) == pytest.approx((159e3, 185.0e3, 264e3), rel=5e-3)


RIGID = 'solver = "nonsmooth"\n'


@pytest.mark.parametrize("direction", ["", "direction = 0.0\n"])
def test_a_block_on_rigid_contacts_under_its_weight_and_a_moment(direction: str, tmp_path) -> None:
    """The forces of a single block are unique: W/A (1 +- 6 e/B), e = a/g h/2, and the place is e from the middle."""
    width, height, share = 1.0, 2.0, 0.12
    text = f'[structure]\nkind = "block"\nwidth = {width}\nheight = {height}\n[material]\ndensity = 2000\n'
    text += f'[joints]\nfriction = 1.0\n[motion]\nkind = "constant"\namplitude = "{share} g"\nduration = 9\n'
    run = found(tmp_path, text + STILL.format(end=0.3) + RIGID + direction)
    mean, e = 2000.0 * GRAVITY * height, share * height / 2.0
    last = run.array("dem", "edge_stress")[-1].ravel()
    assert last.max() == pytest.approx(mean * (1.0 + 6.0 * e / width), rel=2e-4)
    assert last.min() == pytest.approx(mean * (1.0 - 6.0 * e / width), rel=2e-4)
    assert run.array("dem", "thrust_force")[-1, 0][[0, -1]] == pytest.approx([share * mean * width, mean * width], rel=2e-4)
    assert run.array("dem", "thrust_place")[-1, 0, 0] == pytest.approx(-e, rel=2e-4)
    assert not any("not unique" in text for text in run.analyses[0]["warnings"])


def test_a_leaning_pier_on_rigid_contacts(tmp_path) -> None:
    """The eccentricity of the weight at the base, 0.15 m in a width of 1 m, and the forces in its joints are those of statics."""
    stones = [f"[[{x:g}, {y}], [{1 + x:g}, {y}], [{1.1 + x:g}, {y + 1}], [{0.1 + x:g}, {y + 1}]]" for y, x in ((0, 0), (1, 0.1), (2, 0.2))]
    text = (
        '[structure]\nkind = "blocks"\nblock = [' + ",".join(f"{{ points = {one} }}" for one in stones) + "]\n[material]\ndensity = 2000\n"
    )
    run = found(tmp_path, text + STILL.format(end=0.1) + RIGID)
    assert run["dem"]["edge_stress_at_rest_Pa"] == pytest.approx(2000.0 * GRAVITY * 3.0 * 1.9, rel=2e-4)
    force, place = (run.array("dem", name)[-1] for name in ("thrust_force", "thrust_place"))
    level = np.round(place[:, 1]).astype(int)
    assert np.abs(force[:, 1]) == pytest.approx(2000.0 * GRAVITY * (3 - level), rel=2e-4)
    assert place[:, 0] == pytest.approx(0.65 + 0.05 * level, rel=2e-4)


def unbalanced(run, k: int, weight: float, centre: np.ndarray) -> tuple[float, float]:
    """Force and moment about its centroid that a block of a weight [N] lacks for equilibrium at the end, in the plane of x and the height."""
    force, place = (run.array("dem", name)[-1] for name in ("thrust_force", "thrust_place"))
    sides = run.array("dem", "contact_block" if force.shape[1] == 3 else "joint_block")
    way = np.where(sides[:, 0] == k, 1.0, np.where(sides[:, 1] == k, -1.0, 0.0))[:, None] * force
    arm = np.nan_to_num(place - centre)
    moment = (arm[:, 0] * way[:, -1] - arm[:, -1] * way[:, 0]).sum()
    return float(np.hypot(way[:, 0].sum(), way[:, -1].sum() - weight)), float(abs(moment))


@pytest.mark.parametrize("direction", ["", "direction = 0.0\n"])
def test_an_arch_on_rigid_contacts_has_one_of_many_states(direction: str, tmp_path) -> None:
    """Equilibrium of each voussoir, a thrust between the limits and near that of stiff springs, and a warning."""
    text = '[structure]\nkind = "arch"\nradius = 10.0\nthickness = 1.5\nembrace = 157.5\nvoussoirs = 9\n'
    run = found(tmp_path, text + STILL.format(end=0.05) + RIGID + direction + '[[analysis]]\nkind = "tilt"\n')
    force = run.array("dem", "thrust_force")[-1]
    weight = float(np.abs(run.array("dem", "reaction")[-1, -1])) / 9.0
    for k in range(9):
        if direction:
            centre = run.array("dem", "solid_centroid")[k] + run.array("dem", "shift")[-1, k]
        else:
            centre = run.array("dem", "place")[-1, k, :2]
        assert max(unbalanced(run, k, weight, centre)) < 1e-3 * weight
    horizontal = np.abs(force[:, 0])
    assert horizontal == pytest.approx(horizontal.mean(), rel=1e-4)
    assert run["tilt"]["thrust_min_N"] < horizontal.mean() < run["tilt"]["thrust_max_N"]
    assert horizontal.mean() == pytest.approx(193.0e3 if direction else 188.5e3, rel=5e-3)  # springs: 185.0e3
    assert any(f"have {6 if direction else 3} more unknowns" in text for text in run.analyses[0]["warnings"])


@pytest.mark.parametrize("solver", ["compliant", "nonsmooth"])
@pytest.mark.parametrize("direction", ["", "direction = 0.0\n"])
def test_joints_of_one_pair_and_of_a_stone_of_several_parts(solver: str, direction: str, tmp_path) -> None:
    """A stone hooked over a step of another: its three joints balance its weight, and the one below both has its force in the middle."""
    lower = "[[0, 0], [3, 0], [3, 1], [1.5, 1], [1.5, 1.5], [0, 1.5]]"
    upper = "[[0, 1.5], [1.5, 1.5], [1.5, 1], [3, 1], [3, 2], [0, 2]]"
    text = f'[structure]\nkind = "blocks"\nblock = [{{ points = {lower} }}, {{ points = {upper} }}]\n[material]\ndensity = 2000\n'
    run = found(tmp_path, text + "[joints]\nnormal_stiffness = 1e9\n" + STILL.format(end=0.05) + f'solver = "{solver}"\n' + direction)
    weight = 2000.0 * GRAVITY * 2.25
    centre = np.array([(3.0 * 0.5 * 1.5 + 1.5 * 0.5 * 2.25) / 2.25, 0.0, (3.0 * 0.5 * 1.75 + 1.5 * 0.5 * 1.25) / 2.25])
    assert max(unbalanced(run, 1, weight, centre if direction else centre[[0, 2]])) < 2e-3 * weight
    sides = run.array("dem", "contact_block" if direction else "joint_block")
    below = int(np.flatnonzero((sides == -1).any(axis=1))[0])
    assert run.array("dem", "thrust_place")[-1, below, 0] == pytest.approx(1.5, abs=1e-3)
    assert (np.sort(sides, axis=1) == [0, 1]).all(axis=1).sum() == 3


def test_forces_at_the_boundary_of_contacts_are_no_fewer_unknowns() -> None:
    """Three unknowns a contact wherever the solver places its force: the arch has three more than equations, without its last contact none."""
    arch = {"kind": "arch", "radius": 10.0, "thickness": 1.5, "embrace": 157.5, "voussoirs": 9}
    model = make_model(make_deck({"structure": arch, "analysis": {"kind": "dem"}}).building, Dem(kind="dem"))
    place = np.zeros((1, 10, 2))
    for stress in (1e5, np.inf):
        state = Thrust(np.ones((1, 10, 2)), place, np.full((1, 10, 2), stress))
        assert redundancy(model, state) == 3
    tree = place.copy()
    tree[0, -1] = np.nan
    assert redundancy(model, Thrust(np.ones((1, 10, 2)), tree, np.ones((1, 10, 2)))) == 0


def test_threads_that_rigid_contacts_do_not_use_are_stated(tmp_path) -> None:
    deck = tmp_path / "deck.toml"
    deck.write_text('[structure]\nkind = "block"\nwidth = 1\nheight = 2\n' + STILL.format(end=0.05) + RIGID)
    said = [any("uses one thread" in text for text in extrados.run(deck, threads=n).analyses[0]["warnings"]) for n in (None, 0, 1, 2)]
    assert said == [False, False, False, True]
