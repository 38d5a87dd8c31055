"""Flanges, ties and ring beams of frames against mechanisms of rigid bodies worked by hand."""

import numpy as np
import pytest

from extrados.core.frame import Frame, Link, MacroElement
from extrados.decks.reader import DeckError, make_deck
from extrados.model.errors import BadGeometry
from extrados.model.structures.plan_parts import Reinforcement
from extrados.schema.constants import GRAVITY
from extrados.views.frame.flanges import side_width
from extrados.views.frame.options import FrameOptions
from extrados.views.frame.spandrels import flexural_strength, shear_strength, strut_of, strut_strength

STIFF = {"density": 1800, "young": 2e10, "poisson": 0.2}


def building(walls, material=STIFF, cohesion=1e6, materials=None, **more):
    """One storey of 3 m of masonry that does not crush."""
    structure = {"kind": "building", "storeys": [3.0], "walls": walls} | more
    steel = {"density": 7850, "young": 210e9, "poisson": 0.3, "tensile_strength": 250e6, "fracture_energy": 1e6}
    return make_deck(
        {
            "structure": structure,
            "material": material,
            "materials": {"steel": steel, "concrete": {"density": 1800, "young": 30e9, "poisson": 0.2}} | (materials or {}),
            "joints": {"cohesion": cohesion},
            "analysis": [{"kind": "frame-modes"}],
        }
    ).building


def strength(frame, wall, sense=1.0, target=0.05):
    """Greatest base shear of a push of the top of a wall along it [N]."""
    pattern = np.zeros(len(frame.weight))
    pattern[frame.along[wall, 1]] = sense
    with frame.core() as core:
        return float(core.push(pattern, pattern, target, 100, 0.0).multiple.max())


#: Weight of the upper half of a metre of wall of 0.3 m [N]
HALF = 0.3 * 1.5 * 1800 * GRAVITY
FREE = FrameOptions(shear="none", second_order=False, drift_flexure=0.1)


def tee(**options):
    """A wall of 3 m that ends on the middle of one of 8 m with 10 kN/m on it."""
    walls = [
        {"name": "web", "start": [0, 0], "end": [3, 0], "thickness": 0.3},
        {"name": "flange", "start": [0, -4], "end": [0, 4], "thickness": 0.3},
    ]
    plan = building(walls, prestress=[{"wall": "flange", "force": 80e3}])
    return plan.frame(FREE.model_copy(update=options))


@pytest.mark.parametrize(
    ("sides", "expected"),
    [
        ((0.3, 3.0, 9.0, 20.0, 9.0), 1.5),
        ((0.2, 3.0, 9.0, 20.0, 9.0), 1.2),
        ((0.3, 3.0, 3.0, 20.0, 9.0), 0.6),
        ((0.3, 3.0, 9.0, 1.0, 9.0), 0.5),
        ((0.3, 3.0, 9.0, 20.0, 0.4), 0.4),
    ],
)
def test_each_limit_of_the_effective_width(sides, expected):
    assert side_width(*sides) == pytest.approx(expected)


def test_a_web_lifts_its_flange_and_rocks_about_its_toe():
    """V h = N L/2 + F L, F the weight on 0.6 m (a fifth of 3 m) on both sides of the web; nothing at the other toe."""
    frame = tee()
    lifted = next(f for f in frame.flanges if f.wall == 1)
    assert (lifted.start, lifted.end) == pytest.approx((3.25, 4.75))
    assert lifted.weight == pytest.approx(1.5 * (HALF + 10e3))
    own = 3.0 * HALF * 1.5
    assert strength(frame, 0) == pytest.approx((own + lifted.weight * 3.0) / 3.0, rel=5e-3)
    assert strength(frame, 0, -1.0) == pytest.approx(own / 3.0, rel=5e-3)


def test_flanges_whole_and_none():
    """Whole: the shear strength of the corner, here more than the flange weighs; without flanges the web is alone."""
    assert strength(tee(flanges="none"), 0) == pytest.approx(HALF * 1.5, rel=5e-3)
    part, whole = strength(tee(), 0), strength(tee(flanges="whole"), 0)
    assert whole > 1.5 * part
    with pytest.raises(StopIteration):
        next(iter(tee(flanges="whole").flanges))


def test_openings_and_ends_limit_a_flange():
    walls = [
        {"name": "web", "start": [0, 0], "end": [3, 0], "thickness": 0.3},
        {
            "name": "flange",
            "start": [0, -0.4],
            "end": [0, 4],
            "thickness": 0.3,
            "openings": [{"storey": 1, "x": [0.9, 1.8], "z": [0.0, 2.2]}],
        },
    ]
    part = next(f for f in building(walls).frame(FREE).flanges if f.wall == 1)
    assert (part.start, part.end) == pytest.approx((0.0, 0.9))


@pytest.mark.parametrize("shear", ["none", "least"])
def test_corners_without_cohesion_are_not_bonded_and_it_is_said(shear):
    walls = [
        {"name": "web", "start": [0, 0], "end": [3, 0], "thickness": 0.3},
        {"name": "flange", "start": [0, -4], "end": [0, 4], "thickness": 0.3},
    ]
    for cohesion, bonded in ((0.0, False), (1e4, True)):
        frame = building(walls, cohesion=cohesion).frame(FrameOptions(shear=shear))
        assert bool(frame.links) == bool(frame.flanges) == bonded
        assert any("not bonded" in remark for remark in frame.weaknesses) != bonded


def test_strength_of_spandrels_by_hand():
    assert [strut_of(0.8, 0.4, tie, 1.5e6) for tie in (50e3, 400e3)] == pytest.approx([50e3, 192e3])
    assert strut_strength(0.8, 0.4, 50e3, 1.5e6) == pytest.approx(20e3 * (1 - 50 / 408))
    assert strut_strength(0.8, 0.4, 192e3, 1.5e6) == pytest.approx(76.8e3 * (1 - 192 / 408))
    assert shear_strength(0.8, 0.4, 1.0, 0.0, 0.1e6, 96e3) == pytest.approx(2.0 * 32e3 / 1.25)
    assert flexural_strength(0.8, 0.4, 0.1e6, 3e6) == pytest.approx(0.128e6 * 0.1 * 3 / 3.1)
    assert shear_strength(0.8, 0.4, 1.0, 0.1e6, 0.0) == pytest.approx(32e3)
    assert shear_strength(0.8, 0.4, 1.0, 0.1e6, 0.1e6) == pytest.approx(32e3 / 1.25)


DOOR = {"storey": 1, "x": [2.0, 3.0], "z": [0.0, 2.2]}


def portal(more=None, opening=DOOR, **options):
    """A wall of 5 m with a door between two piers of 2 m."""
    walls = [{"name": "wall", "start": [0, 0], "end": [5, 0], "thickness": 0.3, "openings": [opening]}]
    weak = STIFF | {"compressive_strength": 400e6}
    return building(walls, weak, cohesion=0.05e6, **(more or {})).frame(FREE.model_copy(update=options))


def test_two_piers_coupled_by_a_spandrel_with_a_tie():
    """Piers rotate about their toes, the spandrel between hinges: V H = sum N L/2 + 2 M (1 + L/l), L = 2 m, l = 1 m."""
    rod = {"start": [0, 0, 2.6], "end": [5, 0, 2.6], "area": 1e-4, "material": "steel"}
    tied = portal({"rods": [rod]}, cohesion=10e6, horizontal_strength=2e6)
    element = next(e for e in tied.elements if not e.pier)
    expected = 0.5 * 25e3 * 0.8 * (1.0 - 25e3 / (0.85 * 2e6 * 0.24))
    alone = portal(cohesion=0.02e6)
    mine = next(e for e in alone.elements if not e.pier)
    assert element.moment > expected  # a cohesion of 10 MPa across head joints exceeds the strut
    assert mine.moment == pytest.approx(0.5 * 0.24 * 0.02e6)  # its shear
    load = 4.0 * HALF + 1.0 * 0.8 * 0.3 * 1800 * GRAVITY
    assert strength(alone, 0, target=0.02) == pytest.approx((load * 1.0 + 2.0 * mine.moment * 3.0) / 3.0, rel=1e-2)
    assert element.drifts[0] == 0.02 and mine.drifts[0] == 0.015


def test_a_tie_gives_a_spandrel_its_strut():
    """A masonry whose head joints carry little: the strut of 25 kN decides, and a rod beyond half a metre is no tie."""
    rod = {"start": [0, 0, 2.6], "end": [5, 0, 2.6], "area": 1e-4, "material": "steel"}
    values = {"cohesion": 1e6, "diagonal_strength": 0.1e6 / 3.0, "horizontal_strength": 2e6}
    strut = 0.5 * 25e3 * 0.8 * (1.0 - 25e3 / (0.85 * 2e6 * 0.24))
    without = 0.5 * 0.24 * 0.8 * 0.05e6 / (1.0 + 0.05e6 / 340e6)
    for height, expected in ((2.6, strut), (1.5, without)):
        rod["start"], rod["end"] = [0, 0, height], [5, 0, height]
        frame = portal({"rods": [rod]}, {"storey": 1, "x": [1.5, 3.5], "z": [0.0, 2.2]}, **values)
        assert next(e for e in frame.elements if not e.pier).moment == pytest.approx(expected, rel=1e-6)
        assert any("no effect" in remark for remark in frame.remarks) == (height < 2.0)


def test_an_elastic_ring_beam_makes_piers_rock_at_both_ends():
    """The opening reaches the beam, so that no masonry couples the piers: V h = sum of N L."""
    high = {"storey": 1, "x": [2.0, 3.0], "z": [0.0, 2.7]}
    beam = {"storey": 1, "depth": 0.3, "material": "concrete"}
    frame = portal({"ring_beams": [beam]}, high)
    assert [s.kind for s in frame.strips] == ["pier", "pier", "ring beam"]
    element = frame.elements[2]
    assert element.young == 30e9
    assert element.offsets[1] == pytest.approx(-0.15)
    load = 4.0 * HALF + 0.3 * 0.3 * 1800 * GRAVITY
    height = frame.elements[0].length
    shear = strength(frame, 0, target=0.03)
    assert shear == pytest.approx(load * 2.0 / height, rel=2e-2)


BARS = {"area": 4e-4, "yield_strength": 400e6, "cover": 0.04}


def test_plastic_moment_of_a_ring_beam_by_hand():
    """80 kN of bars at 0.26 m; the block is 80 kN/(0.85 20 MPa 0.3 m) = 15.7 mm high."""
    bars = Reinforcement(**BARS)
    assert bars.tension == pytest.approx(160e3)
    assert bars.plastic_moment(0.3, 0.3, 20e6) == pytest.approx(80e3 * (0.26 - 0.5 * 80 / 5100), rel=1e-6)


def test_a_portal_of_piers_and_a_reinforced_ring_beam_is_a_mechanism_by_hand():
    """Piers rock about their toes and the hinges of the beam yield: V H = sum N L/2 + 2 M_p, at most V of the elastic beam."""
    high = [{"storey": 1, "x": [2.0, 3.0], "z": [0, 2.7]}]
    beam = {"storey": 1, "depth": 0.3, "material": "strong", "walls": ["wall"]}
    walls = [{"name": "wall", "start": [0, 0], "end": [5, 0], "thickness": 0.3, "openings": high}]
    shears = []
    for area in (None, 2e-5, 4e-5, 2e-3):
        bars = {} if area is None else {"reinforcement": BARS | {"area": area}}
        made = building(
            walls, ring_beams=[beam | bars], materials={"strong": {"young": 30e9, "poisson": 0.2, "compressive_strength": 20e6}}
        )
        frame = made.frame(FREE.model_copy(update={"drift_flexure": 0.1}))
        (moment,) = (e.moment for e in frame.elements if not e.pier)
        if area:
            assert moment == pytest.approx(Reinforcement(**BARS | {"area": area}).plastic_moment(0.3, 0.3, 20e6))
        assert any("remain elastic" in remark for remark in frame.remarks) == (area is None)
        shears.append((moment, strength(frame, 0, target=0.03)))
    elastic, (m1, v1), (m2, v2), strong = shears
    # piers turn about their toes by an angle, the beam by 2 m/1 m of it, its two hinges by 3 times the angle
    assert (v2 - v1) / (m2 - m1) == pytest.approx(2.0 * 3.0 / 3.0, rel=0.02)
    assert v1 < v2 < strong[1] == pytest.approx(elastic[1], rel=1e-3)


def test_a_strut_takes_moment_from_the_ring_beam():
    """A spandrel of 1 m above a door of 1.7 m, H_p = 0.4 f_h h t of it: M_p (1 - H_p/T)."""
    low = [{"storey": 1, "x": [2.0, 3.0], "z": [0, 1.7]}]
    walls = [{"name": "wall", "start": [0, 0], "end": [5, 0], "thickness": 0.3, "openings": low}]
    beam = {"storey": 1, "depth": 0.3, "material": "strong", "reinforcement": BARS}
    strong = {"strong": {"young": 30e9, "poisson": 0.2, "compressive_strength": 20e6}}
    made = building(walls, ring_beams=[beam], materials=strong)
    frame = made.frame(FREE.model_copy(update={"horizontal_strength": 0.5e6}))
    found = {s.kind: e.moment for s, e in zip(frame.strips, frame.elements, strict=True) if not e.pier}
    strut = 0.4 * 0.5e6 * 1.0 * 0.3
    assert found["ring beam"] == pytest.approx(Reinforcement(**BARS).plastic_moment(0.3, 0.3, 20e6) * (1 - strut / 160e3))


def test_reinforcement_needs_the_strength_of_concrete_and_room():
    walls = [{"name": "wall", "start": [0, 0], "end": [5, 0], "thickness": 0.3, "openings": [DOOR]}]
    beam = {"storey": 1, "depth": 0.3, "material": "concrete", "reinforcement": BARS}
    with pytest.raises(BadGeometry, match=r"requires `compressive_strength` in \[materials.concrete\]"):
        building(walls, ring_beams=[beam]).frame(FREE)
    with pytest.raises(DeckError, match="does not fit in a beam with a depth of"):
        building(walls, ring_beams=[beam | {"reinforcement": BARS | {"cover": 0.15}}])


def test_a_ring_beam_with_too_much_reinforcement_is_refused():
    """Neutral axis A f_y / 2 / (0.85 f_c b) / 0.8 at 0.45 of 0.26 m: A = 23.9 cm^2, also as text with a unit."""
    walls = [{"name": "wall", "start": [0, 0], "end": [5, 0], "thickness": 0.3, "openings": [DOOR]}]
    strong = {"strong": {"young": 30e9, "poisson": 0.2, "compressive_strength": 20e6}}
    limit = 0.45 * 0.26 * 0.8 * 0.85 * 20e6 * 0.3 * 2.0 / 400e6

    def made(area: object) -> None:
        beam = {"storey": 1, "depth": 0.3, "material": "strong", "reinforcement": BARS | {"area": area}}
        building(walls, ring_beams=[beam], materials=strong).frame(FREE)

    made(0.999 * limit)
    made(f"{0.999e4 * limit} cm^2")
    with pytest.raises(BadGeometry, match=r"wall 'wall': with a total of 23.9 cm\^2 of bars, the neutral axis is at 0.45 of the effective"):
        made(1.001 * limit)


def test_a_ring_beam_is_no_masonry_of_a_spandrel_below_a_door():
    """0.8 m between both doors less a beam of 0.3 m, as below a sill of a millimetre; tension without a limit is said."""
    beam = {"storey": 1, "depth": 0.3, "material": "concrete"}
    depths = []
    for sill in (0.0, 0.001):
        upper = {"storey": 2, "x": [2.0, 3.0], "z": [sill, 2.2]}
        walls = [{"name": "wall", "start": [0, 0], "end": [5, 0], "thickness": 0.3, "openings": [DOOR, upper]}]
        frame = building(walls, STIFF, cohesion=0.05e6, ring_beams=[beam], storeys=[3.0, 3.0]).frame(FREE)
        stiffness = [e.shear_stiffness for s, e in zip(frame.strips, frame.elements, strict=True) if s.kind == "spandrel" and s.storey == 1]
        depths += [k / frame.elements[0].young for k in stiffness]
        assert any("not limited" in remark for remark in frame.remarks)
    assert depths[0] == pytest.approx(depths[1], rel=3e-3)


def test_pressure_beside_a_spandrel_enters_through_interlocking():
    """f_ft = f_v0 + mu sigma/phi, sigma half the pressure of the loads above on the piers beside; a slender spandrel fails in flexure."""
    walls = [
        {"name": "wall", "start": [0, 0], "end": [5, 0], "thickness": 0.3, "openings": [{"storey": 1, "x": [1.0, 4.0], "z": [0, 2.6]}]}
    ]
    loads = {"prestress": [{"wall": "wall", "force": 60e3, "x": [0.0, 1.0]}, {"wall": "wall", "force": 60e3, "x": [4.0, 5.0]}]}
    pressure = 0.5 * (120e3 + 2.0 * HALF) / (2.0 * 0.3)
    for phi in (1.0, 2.0):
        frame = building(walls, cohesion=0.02e6, **loads).frame(FREE.model_copy(update={"shear": "none", "interlocking": phi}))
        spandrel = next(e for e in frame.elements if not e.pier)
        assert spandrel.moment == pytest.approx(0.5 * 0.4**2 * 0.3 * (0.02e6 + 0.4 * pressure / phi))
        assert not spandrel.by_shear and spandrel.moment < 0.5 * 3.0 * 0.4 * 0.3 * 0.02e6


@pytest.mark.parametrize("returns", [True, False])
def test_a_lifted_weight_returns_and_a_sheared_joint_does_not(returns):
    """A mass on a link of 10 N, led to and fro by a stiff spring: at the start again the link carries nothing, or 10 N back."""
    pier = MacroElement((-1, -1, -1, -1, 1, -1), 3.0, 1.0, 0.3, 1e9, 1e9, second_order=False)
    driver, mass, steps = 1e6, 1e-3, 400
    link = Link((0,), (1.0,), 1e4, (10.0, 10.0), returns=returns)
    frame = Frame([pier], [link], np.diag([driver, 0.0]), np.array([0.0, -1e3]), np.diag([mass, 0.0]))
    t = np.arange(steps + 1) / steps
    path = frame.move(np.array([1.0, 0.0]), -0.01 * np.sin(np.pi * t) * driver / mass, 1.0 / steps, (0.0, 0.0))
    force = path.shear - driver * path.displacement[:, 0]
    assert force[steps // 2] == pytest.approx(10.0, rel=1e-2)
    assert force[-1] == pytest.approx(0.0 if returns else -10.0, abs=0.3)
