"""Local mechanisms take the weights of the kinematic chain alone: numbers of the Circolare, motion by hand, immobile parts of any size."""

import tomllib
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import extrados
from extrados.analyses.codes import ntc
from extrados.analyses.codes.kinematics import Overturning, Weight, capacity, in_chain
from extrados.decks.reader import make_deck
from extrados.limit.linkage import laden
from extrados.schema.constants import GRAVITY
from extrados.schema.table import storeys_in

#: Results of a local mechanism that an immobile part must not change
CAPACITY = (
    "multiplier",
    "participating_mass_kg",
    "participating_part",
    "activation_acceleration_g",
    "zero_displacement_m",
    "ultimate_displacement_m",
    "equivalent_period_s",
    "swaying_weight_N",
)
CASES = Path(__file__).parents[2] / "cases"
SITE = {"code": "EN1998-1", "ground": "B", "acceleration": "0.15 g"}


def local(structure: dict, **keys: object) -> object:
    deck = {"structure": structure, "analysis": {"kind": "local-mechanism", "mechanism": "building", **keys}}
    return extrados.run(deck | {"joints": {"friction": "no-sliding"}})["local-mechanism"]


def rectangle(name: str, x: float, y: float, width: float, height: float) -> dict:
    return {"name": name, "points": [[x, y], [x + width, y], [x + width, y + height], [x, y + height]]}


def same(one: object, other: object) -> None:
    for key in CAPACITY:
        expected = other[key]
        assert one[key] == (None if expected is None else pytest.approx(expected, rel=1e-7)), key


def test_a_wall_with_a_floor_that_rests_and_a_mass_that_pushes() -> None:
    """Circ. 7/2019 [C8.7.1.1] to [C8.7.1.5], [C8.7.1.10], [C8.7.1.11] by hand, g = 9.81: P 21.6 kN at 1.5 m and 0.2 m, P 10 kN and
    Q 5 kN at 3 m, the first 0.25 m behind the hinge."""
    deck = {
        "material": {"density": 18e3 / GRAVITY},
        "analysis": {
            "kind": "local-mechanism",
            "mechanism": "facade",
            "height": 3.0,
            "thickness": 0.4,
            "confidence_factor": 1.35,
            "floors": [{"height": 3.0, "load": 10e3, "arm": 0.25}, {"height": 3.0, "pushing": 5e3}],
            "spectrum": SITE,
            "collapse_spectrum": SITE,
        },
    }
    r = extrados.run(deck)["local-mechanism"]
    four = 6e-4  # g is 9.81 there
    assert r.multiplier == pytest.approx(6.82 / 77.4, rel=1e-9) == pytest.approx(0.08811, rel=four)
    assert r.participating_part == pytest.approx(0.8915, rel=four)
    assert r.participating_mass_kg == pytest.approx(3326.0, rel=four)
    assert r.activation_acceleration_g * GRAVITY == pytest.approx(0.7182, rel=four)
    assert r.zero_displacement_m == pytest.approx(0.2593, rel=four)
    assert r.ultimate_displacement_m == pytest.approx(0.1037, rel=four)
    assert r.equivalent_period_s == pytest.approx(2.589, rel=four)
    assert r.collapse_displacement_m == pytest.approx(0.1556, rel=four)
    period = float(r.checks["NTC nonlinear at SLC"].note.removeprefix("T_SLC = ").removesuffix(" s"))
    assert period == pytest.approx(3.606, rel=four)
    assert r.swaying_weight_N == pytest.approx(36.6e3)
    assert r.checks["NTC linear (at the ground)"].capacity / 1.2 == pytest.approx(0.1220, rel=four)
    deck["analysis"]["floors"] = deck["analysis"]["floors"][:1]
    assert extrados.run(deck)["local-mechanism"].multiplier == pytest.approx(0.1093, rel=four), "Q forgotten"


def test_the_mass_that_pushes_does_not_hold_down_at_a_finite_rotation() -> None:
    """d_0 is where the weights that rest stand above the hinge, whatever pushes."""
    rests = (Weight(21.6, 0.2, 1.5), Weight(10.0, 0.25, 3.0))
    pushed = Overturning((*rests, Weight(5.0, 0.2, 3.0, rests=False)))
    assert pushed.ultimate() == pytest.approx(np.arctan(6.82 / 62.4)) == pytest.approx(Overturning(rests).ultimate())
    assert 3.0 * np.sin(pushed.ultimate()) == pytest.approx(0.3259, rel=2e-4), "exact displacement of the top"
    assert pushed.travel(pushed.ultimate()) == pytest.approx(6.82 / 62.4), "of the centre of what rests, as on the straight curve"


def test_the_teeth_of_side_walls_hold_by_friction() -> None:
    """[C8.7.1.2]: 10 courses of 0.2 m, overlap 0.15 m, wall 0.4 m, 18 kN/m^3: 5.484 kN, by the work of each course."""
    force, below = ntc.toothed_edge(10, 0.2, 0.15, 0.4, 18.0)
    assert force == pytest.approx(5.484, rel=1e-4)
    courses = np.arange(1, 11)
    each = 0.8 * 0.577 * 18.0 * (0.2 * courses) * 0.15 * 0.4  # friction under the weight of the courses above
    assert force == pytest.approx(each.sum()) and below == pytest.approx(each @ (0.2 * courses) / each.sum())
    wall = {"kind": "local-mechanism", "mechanism": "facade", "height": 6.0, "thickness": 0.5}
    teeth = {"unit_height": 0.2, "overlap": 0.15, "thickness": 0.4, "count": 2}
    plain, held = (extrados.run({"analysis": {**wall, **more}})["local-mechanism"] for more in ({}, {"interlocking": teeth}))
    force, below = ntc.toothed_edge(30, 0.2, 0.15, 0.4, 2000.0 * GRAVITY)
    moment = 2.0 * force * (6.0 - below)
    assert held.multiplier - plain.multiplier == pytest.approx(moment / (2000.0 * GRAVITY * 0.5 * 6.0 * 3.0))
    assert held.zero_displacement_m == pytest.approx(plain.zero_displacement_m), "teeth slip out before collapse"


def test_the_floor_spectrum_of_a_building_of_three_storeys() -> None:
    """[C7.2.6], [C7.2.7]: psi 2/3, T_1 0.3 s, S_e(T_1) 0.6 g, 5 % of the building, 8 % of the part."""
    place = ntc.floor(lambda t, xi: 0.6 if t == 0.3 else 0.0, 2.0, 3.0, 3, 0.3)
    assert place.modes[0].part == pytest.approx(9.0 / 7.0 * 2.0 / 3.0) and place.acceleration == pytest.approx(0.5169, rel=1e-4)
    for period, value in ((0.0, 0.5169), (0.1, 0.9295), (0.3, 2.230), (0.6, 0.6185), (1.0, 0.2548)):
        assert place(period, 0.08) == pytest.approx(value, rel=2e-4), period


@settings(max_examples=25, deadline=None)
@given(width=st.floats(0.5, 20.0), height=st.floats(0.2, 8.0), offset=st.floats(-0.5, 0.5))
def test_a_pinnacle_on_a_base_of_any_size_is_the_pinnacle(width: float, height: float, offset: float) -> None:
    alone = local({"kind": "blocks", "block": [rectangle("pinnacle", -0.2, 0.0, 0.4, 2.0)]})
    middle = offset * (width - 0.4)
    # the base does not turn before the pinnacle
    stable = 0.2 * 1.6 * (0.4 * 2.0 * (height + 1.0) + width * height * height / 2.0)
    if (width / 2.0 - abs(middle)) * 0.4 * 2.0 + width / 2.0 * width * height <= stable:
        return
    blocks = [rectangle("base", -width / 2.0, 0.0, width, height), rectangle("pinnacle", middle - 0.2, height, 0.4, 2.0)]
    whole = local({"kind": "blocks", "block": blocks})
    same(whole, alone)
    assert whole.activation_acceleration_g == pytest.approx(0.2 / 1.35)
    assert whole.base_height_m == pytest.approx(height) and whole.building_height_m == pytest.approx(height + 2.0)
    assert alone.base_height_m == 0.0


@settings(max_examples=20, deadline=None)
@given(
    radius=st.floats(1.0, 8.0),
    ratio=st.floats(0.14, 0.3),
    voussoirs=st.integers(7, 30),
    width=st.floats(2.5, 10.0),
    height=st.floats(1.0, 2.5),
)
def test_the_arch_between_abutments_of_any_size_is_the_arch(
    radius: float, ratio: float, voussoirs: int, width: float, height: float
) -> None:
    """Stones that move sideways, down and up: four hinges in the ring, nothing of the abutments."""
    ring = {"radius": radius, "thickness": ratio * radius, "embrace": 180.0, "voussoirs": voussoirs}
    alone = local({"kind": "arch", **ring})
    side = {"buttress_width": width * radius, "face": radius * (1.0 - 0.5 * ratio), "height": height * radius, "height_to": "centre"}
    whole = local({"kind": "vault", **ring, **side})
    same(whole, alone)
    assert whole.base_height_m >= height * radius - 1e-9


def test_a_parapet_on_a_heavy_wall_is_the_parapet_of_the_table() -> None:
    table = {"kind": "local-mechanism", "mechanism": "parapet", "height": 1.0, "thickness": 0.25, "spectrum": SITE}
    place = {"base_height": 6.0, "building_height": 7.0}
    alone = extrados.run({"material": {"density": 2000.0}, "analysis": table | place})["local-mechanism"]
    blocks = [rectangle("wall", 0.0, 0.0, 2.0, 6.0), rectangle("parapet", 0.6, 6.0, 0.25, 1.0)]
    whole = local({"kind": "blocks", "block": blocks}, spectrum=SITE)
    same(whole, alone)
    assert (whole.base_height_m, whole.building_height_m) == pytest.approx((6.0, 7.0))
    assert whole.floor_acceleration_g == pytest.approx(alone.floor_acceleration_g)
    check = whole.checks["NTC nonlinear"]
    assert check.demand == pytest.approx(alone.checks["NTC nonlinear"].demand) and check.verdict == "fails"


def test_what_moves_backwards_counts_with_its_sign() -> None:
    """[C8.7.1.5] of masses 3 and 1 that move by 2 and -1: (6 - 1)^2/(4 (12 + 1)); d* is scaled by (12 + 1)/(6 - 1)."""
    found = capacity(0.1, np.array([3.0, 1.0]), np.array([2.0, -1.0]), 0.2)
    assert found.part == pytest.approx(25.0 / 52.0) and found.mass == pytest.approx(25.0 / 13.0 / GRAVITY)
    assert found.acceleration == pytest.approx(0.1 * GRAVITY * 52.0 / 25.0) and found.d0 == pytest.approx(0.2 * 13.0 / 5.0)


def test_the_chain_is_what_moves_beyond_rounding() -> None:
    """A stone that turns about its own centre, or moves upwards alone, belongs to it; one that moves by rounding does not."""
    velocity = np.array([[1.0, 0.0, 0.0], [0.0, 0.5, 0.0], [0.0, 0.0, 0.1], [1e-9, -1e-9, 1e-9], [0.0, 0.0, 0.0]])
    assert in_chain(velocity, 10.0).tolist() == [True, True, True, False, False]
    assert in_chain(1e-6 * velocity, 10.0).tolist() == in_chain(velocity, 10.0).tolist(), "whatever the scale of the motion"


def test_a_nave_takes_its_moving_stones() -> None:
    """Nave on its piers: a quarter of the weight moves; what the piers and buttresses at rest weigh is nothing to it."""
    nave = tomllib.loads((CASES / "vault" / "colombier-sweep.toml").read_text())["structure"]
    found = local(nave)
    stones = make_deck({"structure": nave, "analysis": {"kind": "tilt"}}).building.blocks()
    share = found.swaying_weight_N / (laden(stones)[0].sum() * GRAVITY)
    assert share < 0.3 and found.participating_part == pytest.approx(0.914, abs=0.001)
    assert found.activation_acceleration_g == pytest.approx(found.multiplier / found.participating_part / 1.35)


def test_a_chain_that_slides_leaves_what_it_slides_on() -> None:
    """Limit analysis finds the block that slides at its friction; the block below stays, and its size is nothing to it."""
    for width, height in ((2.0, 0.5), (12.0, 3.0)):
        blocks = [rectangle("base", -width / 2.0, 0.0, width, height), rectangle("block", -0.5, height, 1.0, 1.0)]
        deck = {
            "structure": {"kind": "blocks", "block": blocks},
            "joints": {"friction": 0.3, "types": [{"joints": ["ground"], "friction": 0.6}]},
            "analysis": {"kind": "local-mechanism", "mechanism": "building", "spectrum": SITE},
        }
        run = extrados.run(deck)
        r = run["local-mechanism"]
        assert r.participating_part == pytest.approx(1.0) and r.swaying_weight_N == pytest.approx(2000.0 * GRAVITY), width


@pytest.mark.parametrize(
    "structure",
    [
        {
            "kind": "vault",
            "radius": 3.0,
            "thickness": 0.6,
            "embrace": 180.0,
            "voussoirs": 20,
            "face": 2.7,
            "buttress_width": 1.8,
            "height": 6.0,
            "height_to": "centre",
        },
        {"kind": "arch", "radius": 10.0, "thickness": 1.5, "embrace": 157.5, "voussoirs": 7},
    ],
)
def test_the_chain_by_the_centres_of_its_links(structure: dict) -> None:
    """Three links between four hinges: the outer turn about their hinges on what stays, the middle one about the point where the
    lines through the hinges of both meet; M*, e* and alpha_0 by virtual work of the stones of the three."""
    deck = {"structure": structure, "joints": {"friction": "no-sliding"}, "analysis": {"kind": "tilt"}}
    hinges = sorted(extrados.run(deck)["tilt"].hinges, key=lambda h: h.x_m)
    stones = make_deck(deck).building.blocks()
    a, b, c, d = (np.array([h.x_m, h.y_m]) for h in hinges)
    along = np.linalg.solve(np.column_stack([b - a, c - d]), c - a)[0]
    middle = a + along * (b - a)
    spin = [(b - middle) @ (b - a) / ((b - a) @ (b - a)), 1.0, (c - middle) @ (c - d) / ((c - d) @ (c - d))]
    first, second, third, last = (h.joint for h in hinges)
    mass, place, _ = laden(stones)
    across, up, taken = [], [], []
    for i, name in enumerate(stones.block_names):
        # voussoir i lies between joints i and i + 1; the right buttress is of the last link where its foot is the hinge
        order = i if "voussoir" in name else last - 1 if name == "right buttress" and last > third + 1 else -1
        if first <= order < last:
            link = 0 if order < second else 1 if order < third else 2
            arm = place[i] - (a, middle, d)[link]
            across.append(-spin[link] * arm[1])
            up.append(spin[link] * arm[0])
            taken.append(mass[i])
    m, dx, dy = np.array(taken), np.array(across), np.array(up)
    found = local(structure, peak_acceleration="0.1 g")
    assert found.multiplier == pytest.approx(abs(m @ dy / (m @ dx)), rel=1e-6)
    assert found.participating_part == pytest.approx((m @ dx) ** 2 / (m.sum() * (m @ dx**2)), rel=1e-6)
    assert found.participating_mass_kg == pytest.approx((m @ dx) ** 2 / (m @ dx**2), rel=1e-6)
    assert found.swaying_weight_N == pytest.approx(m.sum() * GRAVITY, rel=1e-6)
    assert min(dy) < 0.0 < max(dy), "stones go up and down"


def test_of_both_senses_the_one_of_least_margin_is_the_result() -> None:
    """A wall with one inclined face, towards +x, towards -x, and free: no wall beside it stops a sense."""
    face = {"kind": "blocks", "block": [{"name": "wall", "points": [[0.0, 0.0], [2.0, 0.0], [0.8, 5.0], [0.0, 5.0]]}]}
    analysis = {"kind": "local-mechanism", "mechanism": "building", "spectrum": SITE}

    def found(**supports: object) -> object:
        return extrados.run({"structure": face, "analysis": analysis, **supports})["local-mechanism"]

    held = [found(supports={"abutting_wall": side, "rebound": 0.4}) for side in ("left", "right")]
    margins = [r.governing()[0][0] for r in held]
    assert margins[0] != pytest.approx(margins[1], rel=0.1)
    same(found(), held[int(np.argmin(margins))])


def test_the_place_of_a_mechanism_comes_from_the_geometry() -> None:
    """Of a table the hinge; said otherwise by the deck; at the ground where the chain reaches it."""
    wall = {"kind": "local-mechanism", "mechanism": "facade", "height": 6.0, "thickness": 0.5, "spectrum": SITE}

    def found(**keys: object) -> object:
        return extrados.run({"analysis": {**wall, **keys}})["local-mechanism"]

    assert found().base_height_m == 0.0 and "NTC activation (at the ground)" in found().checks
    high = found(hinge_height=3.0)
    assert (high.base_height_m, high.building_height_m) == (3.0, 6.0)
    # gamma_1 = 3 n / (2 n + 1) of n = 2 storeys of 3 m
    assert high.floor_acceleration_g == pytest.approx(1.2 * 0.18 * 2.5 * 0.5 * np.sqrt(1.01))
    assert high.checks["NTC activation (at height z)"].demand == pytest.approx(high.floor_acceleration_g)
    assert found(hinge_height=3.0, base_height=0.0).base_height_m == 0.0
    other = found(hinge_height=3.0, base_height=7.0, building_height=14.0)
    assert (other.base_height_m, other.building_height_m) == (7.0, 14.0)


@pytest.mark.parametrize(("height", "storeys"), [(2.0, 1), (6.0, 2), (7.0, 3), (9.0, 3), (10.0, 4)])
def test_a_begun_storey_counts(height: float, storeys: int) -> None:
    """More storeys amplify more, gamma_1 = 3 n/(2 n + 1): rounding down would be unsafe."""
    assert storeys_in(height) == storeys


def test_e_star_by_links_is_said_where_it_differs_from_that_by_stones() -> None:
    """Three drums that turn as one: (1 + 3 + 5)^2/(3 (1 + 9 + 25)) by stones, 1 by the one link; a single block says nothing."""
    analysis = {"kind": "local-mechanism", "mechanism": "building", "peak_acceleration": "0.1 g"}

    def told(drums: int) -> tuple[float, list[str]]:
        column = {"kind": "column", "width": 1.0, "height": 6.0, "drums": drums}
        run = extrados.run({"structure": column, "joints": {"friction": "no-sliding"}, "analysis": analysis})
        return run["local-mechanism"].participating_part, run.analyses[0]["warnings"]

    part, warnings = told(3)
    assert part == pytest.approx(81.0 / 105.0) and any("e* is 1, and a_0* changes by -23 %" in text for text in warnings)
    part, warnings = told(1)
    assert part == pytest.approx(1.0) and not warnings


def test_a_verdict_that_depends_on_how_a_link_is_drawn_is_open(tmp_path: Path) -> None:
    """A block cut in two glued pieces has e* 0.8 by stones and 1 by rigid links: between their a_0* the verdict is open."""
    whole = {"kind": "blocks", "block": [rectangle("shaft", 0.0, 0.0, 0.4, 2.0)]}
    cut = {"kind": "blocks", "block": [rectangle("foot", 0.0, 0.0, 0.4, 1.0), rectangle("head", 0.0, 1.0, 0.4, 1.0)]}
    outcomes = {}
    for name, structure in (("whole", whole), ("cut", cut)):
        for acceleration in (0.10, 0.16, 0.30):
            file = tmp_path / f"{acceleration}.csv"
            file.write_text(f"period_s,sa_g\n0,{acceleration}\n0.1,{acceleration}\n8,{acceleration}\n")
            table = {"code": "table", "table": str(file)}
            deck = {
                "structure": structure,
                "joints": {"friction": "no-sliding"},
                "analysis": {"kind": "local-mechanism", "mechanism": "building", "spectrum": table, "confidence_factor": 1.35},
            }
            outcomes[name, acceleration] = extrados.run(deck).analyses[0]["verdict"]
    assert outcomes["whole", 0.16]["outcome"] == "collapses"
    assert outcomes["cut", 0.16]["outcome"] == "open" and "rigid link" in outcomes["cut", 0.16]["statement"]
    for name in ("whole", "cut"):
        assert outcomes[name, 0.10]["outcome"] == "stands", outcomes[name, 0.10]
        assert outcomes[name, 0.30]["outcome"] == "collapses"
