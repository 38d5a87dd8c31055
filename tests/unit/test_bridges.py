"""Bridges: geometry, fill, passive pressure, trains and partial factors."""

from typing import Any

import numpy as np
import pytest
from scipy import sparse
from scipy.optimize import linprog

import extrados
from extrados.analyses.context import Context
from extrados.analyses.limit.moving_load import Places, _top
from extrados.analyses.limit.tables import MovingLoad
from extrados.analyses.limit.trains import FOR_EVER, Train, train_of
from extrados.analyses.sequence import run_analyses
from extrados.decks.reader import DeckError, make_deck
from extrados.limit.fill import passive_pressure, pressed, under_load
from extrados.limit.loads import Loads, tilt_loads
from extrados.limit.programme import LimitAnalysis
from extrados.model.errors import BadGeometry
from extrados.model.geometry.assembly import GROUND, Assembly
from extrados.model.geometry.earth import Earth, Skyline, skyline
from extrados.model.geometry.polygons import properties, signed_area
from extrados.model.structures.arch import make_arch
from extrados.model.structures.bridge import Bridge, Span, intrados, make_bridge
from extrados.results.model import Result
from extrados.schema.constants import GRAVITY
from extrados.views.rigid import rigid_bodies

SPAN = {"span": 8.0, "rise": 2.0, "thickness": 0.6, "voussoirs": 20}
FILL = {"cover": 0.3, "friction_angle": 35.0, "passive": 0.5}
ROAD = {"thickness": 0.1}


def bridge(**keys: Any) -> Assembly:
    return make_bridge(Bridge.model_validate({"kind": "bridge", "spans": [SPAN], **keys}))


def run(analysis: dict[str, Any], **keys: Any) -> Result:
    tables = {k: keys.pop(k) for k in ("material", "joints", "motion") if k in keys}
    deck = make_deck({"structure": {"kind": "bridge", "spans": [SPAN], **keys}, "analysis": analysis, **tables})
    return run_analyses(Context(deck, threads=1))[0]


def moving(places: list[float] | None = None, **keys: Any) -> dict[str, Any]:
    return {"kind": "moving-load", **({"count": 11} if places is None else {"places": places}), **keys}


# Geometry


@pytest.mark.parametrize(
    ("shape", "rise"),
    [("segmental", 1.5), ("segmental", 4.0), ("three-centred", 2.5), ("pointed", 5.0), ("elliptical", 2.5), ("parabolic", 2.0)],
)
def test_intrados_keeps_span_rise_equal_lengths_and_normals(shape: str, rise: float) -> None:
    fine = Span(shape=shape, span=8.0, rise=rise, thickness=0.5, voussoirs=400)
    point, normal = intrados(fine)
    assert point[0] == pytest.approx([-4.0, 0.0], abs=1e-9) and point[-1] == pytest.approx([4.0, 0.0], abs=1e-9)
    assert point[200] == pytest.approx([0.0, rise], abs=1e-6)
    step = np.diff(point, axis=0)
    length = np.hypot(*step.T)
    assert length == pytest.approx(np.full(400, length.mean()), rel=1e-4)
    along = point[2:] - point[:-2]
    square = np.abs((along * normal[1:-1]).sum(axis=1)) / np.hypot(*along.T)
    if shape == "pointed":  # its crown joint is vertical
        assert normal[200] == pytest.approx([0.0, 41.0 / 8.0 / 5.0])
        square = np.delete(square, 199)
    assert square.max() < 0.01
    mirror = point[::-1] * (-1.0, 1.0)
    assert point == pytest.approx(mirror, abs=1e-6)


def test_three_centred_arcs_meet_with_one_tangent() -> None:
    span = Span(shape="three-centred", span=8.0, rise=2.5, thickness=0.5, haunch_radius=1.5, voussoirs=2000)
    point, normal = intrados(span)
    radius = (2.5**2 + 2.5**2 - 1.5**2) / 2.0  # (a - r)^2 + (R - b)^2 = (R - r)^2
    left = point[:, 0] < -2.5 - 1.5 * np.cos(np.arctan2(radius - 2.5, 2.5))
    assert np.hypot(*(point[left] - (-2.5, 0.0)).T) == pytest.approx(np.full(left.sum(), 1.5))
    middle = np.abs(point[:, 0]) < 2.0
    assert np.hypot(*(point[middle] - (0.0, 2.5 - radius)).T) == pytest.approx(np.full(middle.sum(), radius))
    turn = np.arctan2(normal[:, 0], normal[:, 1])
    assert np.abs(np.diff(turn)).max() < 1.01 * (point[1, 1] / 1.5)  # no kink: it turns no faster than the side arcs


def test_a_segmental_span_is_the_arch_of_its_radius() -> None:
    """With straight-sided voussoirs, whose area is that of the sector but for (delta^2 / 6)."""
    radius, half = 5.0, np.arctan2(4.0, 3.0)
    arch = make_arch(radius + 0.3, 0.6, np.degrees(2.0 * half), 20)
    made = bridge()
    centre = np.array([4.0, -3.0])
    assert made.p == pytest.approx(arch.p + centre) and made.q == pytest.approx(arch.q + centre)
    delta = 2.0 * half / 20
    assert made.mass == pytest.approx(arch.mass * np.sin(delta) / delta)


def test_thickness_varies_and_rings_share_it() -> None:
    spans = [{**SPAN, "springing_thickness": 0.9, "rings": 3}]
    made = bridge(spans=spans)
    assert len(made.mass) == 60 and len(made.a) == 3 * 21 + 2 * 20
    assert made.length[:21].max() == pytest.approx(0.3) and made.length[:21].min() == pytest.approx(0.2)
    whole = bridge(spans=[{**spans[0], "rings": 1}])
    assert made.mass.sum() == pytest.approx(whole.mass.sum())
    assert sorted(made.chains) == ["ring 1", "ring 2", "ring 3"] and len(made.groups["rings"]) == 40


def test_the_parts_of_a_viaduct_fill_each_others_places() -> None:
    made = bridge(
        spans=[SPAN, {**SPAN, "shape": "elliptical", "rise": 2.5}],
        piers=[{"width": 2.0, "height": 4.0, "base_width": 2.6, "courses": 3}],
        abutments={"width": 2.5, "height": 3.0},
        backing={"height": 1.0, "density": 2400.0},
    )
    assert all(signed_area(o) > 0.0 for o in made.outlines)
    names = made.block_names
    assert [n for n in names if n.startswith("pier")] == ["pier course 1", "pier course 2", "pier course 3"]
    backing = [i for i, n in enumerate(names) if n.startswith("backing")]
    assert len(backing) == 3
    for i in backing:
        assert made.mass[i] == pytest.approx(2400.0 * signed_area(made.outlines[i]))
    # Every joint lies on the outlines of both of its stones.
    for j, (a, b) in enumerate(zip(made.a, made.b, strict=True)):
        for block in {int(a), int(b)} - {GROUND}:
            o = made.outlines[block]
            edge = np.roll(o, -1, axis=0) - o
            for end in (made.p[j], made.q[j]):
                share = np.clip(((end - o) * edge).sum(axis=1) / (edge**2).sum(axis=1), 0.0, 1.0)
                assert np.hypot(*(o + share[:, None] * edge - end).T).min() < 1e-9, made.joint_names[j]


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        (
            {"spans": [SPAN, SPAN], "piers": [{"width": 0.4, "height": 3.0}]},
            "pier: the arches on both sides overlap in this pier: give a width of at least 0.96 m",
        ),
        ({"abutments": {"width": 0.2, "height": 3.0}}, "left abutment: with a width of 0.2 m, the abutment ends before"),
        ({"backing": {"height": 2.7}}, "backing: the top at 2.7 m must lie between"),
        ({"backing": {"height": 0.1}}, "backing: the top at 0.1 m must lie between"),
        ({"spans": [{**SPAN, "shape": "three-centred", "rise": 0.5}]}, "three-centred arch: side arcs with a radius of"),
    ],
)
def test_parts_that_do_not_fit_are_named(keys: dict[str, Any], words: str) -> None:
    with pytest.raises(BadGeometry, match=words):
        bridge(**keys)


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ({"spans": [SPAN, SPAN]}, "2 spans require 1 pier"),
        ({"spans": [{**SPAN, "rise": 4.5}]}, "is at most half of the span"),
        ({"spans": [{**SPAN, "shape": "pointed"}]}, "is at least half of the span"),
        ({"surfacing": ROAD}, "surfacing requires fill"),
    ],
)
def test_wrong_tables_are_complaints(keys: dict[str, Any], words: str) -> None:
    with pytest.raises(DeckError, match=words):
        run({"kind": "tilt"}, **keys)


# Fill


def test_skyline_is_the_highest_stone() -> None:
    low = np.array([[0.0, 0.0], [4.0, 0.0], [4.0, 1.0], [0.0, 1.0]])
    roof = np.array([[1.0, 1.0], [3.0, 1.0], [2.0, 3.0]])
    line = skyline([low, roof])
    assert line.block.tolist() == [0, 1, 1, 0]
    assert line.start.tolist() == [[0.0, 1.0], [1.0, 1.0], [2.0, 3.0], [3.0, 1.0]]
    assert line.end.tolist() == [[1.0, 1.0], [2.0, 3.0], [3.0, 1.0], [4.0, 1.0]]


def test_fill_weighs_what_lies_between_the_stones_and_the_road() -> None:
    made = bridge(fill={**FILL, "density": 1900.0}, surfacing=ROAD, depth=3.0)
    q = made.q
    under = float((0.5 * (q[1:, 1] + q[:-1, 1]) * np.diff(q[:, 0])).sum())
    width = float(np.ptp(q[:, 0]))
    area = width * 2.9 - under  # up to rise + thickness + cover
    assert made.fill[:, 0].sum() == pytest.approx(3.0 * (1900.0 * area + 2300.0 * 0.1 * width))
    soil, paved = made.earth.masses(20, 3.0)
    for i in (0, 3):
        column = np.array([q[i], q[i + 1], [q[i + 1, 0], 2.9], [q[i, 0], 2.9]])
        area, centroid, _ = properties(column)
        assert soil[i] == pytest.approx([3.0 * 1900.0 * area, *centroid])
        assert paved[i] == pytest.approx([3.0 * 230.0 * np.ptp(column[:, 0]), 0.5 * (q[i, 0] + q[i + 1, 0]), 2.95])
        both = (soil[i, 0] * soil[i, 1:] + paved[i, 0] * paved[i, 1:]) / made.fill[i, 0]
        assert made.fill[i, 1:] == pytest.approx(both)


def test_passive_pressure_adds_up_to_rankines() -> None:
    """From the depth over the extrados at the crown to that at the springing, on either side."""
    made = bridge(fill={**FILL, "cohesion": 2000.0}, surfacing=ROAD, depth=3.0)
    push = passive_pressure(made.earth, made.depth, made.centroid)
    kp = np.tan(np.radians(45.0 + 17.5)) ** 2
    top, bottom = 0.3, 2.9 - made.q[0, 1]
    soil = kp * GRAVITY * (0.5 * 2000.0 * (bottom**2 - top**2) + 2300.0 * 0.1 * (bottom - top))
    clay = 2.0 * 2000.0 * np.sqrt(kp) * (bottom - top)
    right = push.wrench[:, 0] > 0.0
    assert push.wrench[right, 0].sum() == pytest.approx(0.5 * 3.0 * (soil + clay))
    assert push.wrench[:, 0].sum() == pytest.approx(0.0, abs=1e-3)
    assert made.centroid[push.block[right], 0].max() < 4.0 and not push.wrench[:, 1].any()
    level = -push.wrench[:, 2] / push.wrench[:, 0]  # it acts between the ends of each voussoir's extrados
    ends = np.sort(np.column_stack([made.q[push.block, 1], made.q[push.block + 1, 1]]), axis=1)
    assert (level > ends[:, 0]).all() and (level < ends[:, 1]).all()
    assert passive_pressure(bridge(fill={"cover": 0.3}).earth, 1.0, np.zeros((1, 2))) is None


def flat(cover: float, dispersal: str, angle: float) -> Earth:
    """Blocks of 0.1 m under level earth."""
    x = np.linspace(-10.0, 10.0, 201)
    zero = np.zeros(200)
    line = Skyline(np.column_stack([x[:-1], zero]), np.column_stack([x[1:], zero]), np.arange(200))
    return Earth(line, cover, 2000.0, 0.0, 2300.0, 30.0, 0.0, 0.0, dispersal, angle)  # type: ignore[arg-type]


def test_dispersal_by_boussinesq() -> None:
    """Of a line load the share within u z of its line is (2 / pi) (atan u + u / (1 + u^2))."""
    load = under_load(flat(1.0, "boussinesq", 60.0), 200, 0.0, 1e5, 1e-3)

    def share(u: float) -> float:
        return float(2.0 / np.pi * (np.arctan(u) + u / (1.0 + u * u)))

    assert -load[:, 1].sum() == pytest.approx(1e5)
    for half in (0.3, 0.5, 1.0):
        inside = np.abs(np.linspace(-9.95, 9.95, 200)) < half
        assert -load[inside, 1].sum() == pytest.approx(1e5 * share(half) / share(np.sqrt(3.0)), rel=2e-3)


def test_dispersal_within_an_angle() -> None:
    load = under_load(flat(2.0, "even", 45.0), 200, 0.0, 1e5, 1.0)
    inside = np.abs(np.linspace(-9.95, 9.95, 200)) < 2.5
    assert -load[inside, 1] == pytest.approx(np.full(50, 2000.0), rel=1e-6) and not load[~inside].any()
    beside = under_load(flat(2.0, "even", 45.0), 200, 10.0, 1e5, 1.0)  # half of it falls beside the stones
    assert -beside[:, 1].sum() == pytest.approx(5e4, rel=1e-6)


# Limit analysis with pushes


def outside(a: Assembly, loads: Loads, friction: float, direction: int) -> float:
    """The collapse load by SciPy: three equations per block, written anew."""
    m, nb, k = len(a.a), len(a.mass), loads.pushes
    rows = sparse.lil_matrix((3 * nb, 3 * m + k + 1))
    for j in range(m):
        t = (a.q[j] - a.p[j]) / np.hypot(*(a.q[j] - a.p[j]))
        forces = ((a.normal[j], a.p[j]), (a.normal[j], a.q[j]), (t, a.p[j]))
        for c, (f, at) in enumerate(forces):
            for block, sign in ((a.a[j], 1.0), (a.b[j], -1.0)):
                if block != GROUND:
                    rows[3 * block : 3 * block + 3, 3 * j + c] += sign * np.array([[f[0]], [f[1]], [at[0] * f[1] - at[1] * f[0]]])
    if k:
        for i, (block, wrench) in enumerate(zip(loads.resistance.block, loads.resistance.wrench, strict=True)):
            rows[3 * block : 3 * block + 3, 3 * m + i] = wrench[:, None]
    rows[:, -1] = loads.live.reshape(-1, 1)
    slide = sparse.lil_matrix((2 * m, 3 * m + k + 1))
    for j in range(m):
        for r, sign in enumerate((1.0, -1.0)):
            slide[2 * j + r, 3 * j : 3 * j + 3] = [-friction, -friction, sign]
    unit = loads.scale
    rows[:, 3 * m :] = rows[:, 3 * m :] / unit
    cost = np.zeros(3 * m + k + 1)
    cost[-1] = -direction
    bounds = [(0, None), (0, None), (None, None)] * m + [(0, 1)] * k + [(None, None)]
    found = linprog(cost, slide.tocsr(), np.zeros(2 * m), rows.tocsr(), -loads.dead.ravel() / unit, bounds, method="highs-ds")
    return float(found.x[-1])


@pytest.mark.parametrize("backing", [None, {"height": 1.2}])
def test_pushes_agree_with_an_outside_programme(backing: dict[str, float] | None) -> None:
    a = bridge(fill=FILL, surfacing=ROAD, **({"backing": backing} if backing else {}))
    for loads in (tilt_loads(a), Loads(tilt_loads(a).dead, under_load(a.earth, len(a.mass), 2.0, 1e5, 0.3), tilt_loads(a).resistance)):
        for direction in (1, -1) if loads.live[:, 0].any() else (1,):
            expected = outside(a, loads, 0.6, direction)
            for form in ("reduced", "sparse"):
                state, mechanism = LimitAnalysis(a, 0.6, loads=loads, form=form).collapse(direction)
                assert state.gamma == pytest.approx(expected, rel=1e-7)
                assert mechanism.upper_bound == pytest.approx(state.gamma, rel=1e-8)


@pytest.mark.parametrize("form", ["reduced", "sparse"])
def test_fill_pushes_only_where_the_ring_moves_into_it(form: str) -> None:
    a = bridge(fill=FILL)
    loads = tilt_loads(a)
    loads = Loads(loads.dead, under_load(a.earth, len(a.mass), 2.0, 1e5, 0.3), loads.resistance)
    state, mechanism = LimitAnalysis(a, loads=loads, form=form).collapse(1)
    push = loads.resistance
    x, y = a.centroid[push.block].T
    v = mechanism.velocity[push.block]
    at_origin = np.column_stack([v[:, 0] + v[:, 2] * y, v[:, 1] - v[:, 2] * x, v[:, 2]])
    work = (push.wrench * at_origin).sum(axis=1)
    moves = np.abs(work) > 1e-6 * np.abs(work).max()
    assert state.mobilised[moves & (work < 0.0)] == pytest.approx(1.0)
    assert state.mobilised[moves & (work > 0.0)] == pytest.approx(0.0, abs=1e-9)
    assert (moves & (work < 0.0)).any() and (moves & (work > 0.0)).any()


def test_weight_spread_and_pushes_of_fill_each_help() -> None:
    place = moving([2.0])
    values = [
        run(place, **keys)["collapse_load_N"]
        for keys in (
            {},
            {"fill": {"cover": 0.3}},
            {"fill": {"cover": 0.3, "passive": 0.5}},
            {"fill": {"cover": 0.3, "passive": 1.0}},
            {"fill": {"cover": 0.3, "passive": 1.0}, "backing": {"height": 1.2}},
        )
    ]
    assert np.all(np.diff(values) > 0.01 * values[0])
    narrow, wide = (
        run(place, fill={"cover": 0.3, "dispersal": "even", "dispersal_angle": angle})["collapse_load_N"] for angle in (5.0, 50.0)
    )
    assert wide > narrow


@pytest.mark.verify
def test_rings_that_part_are_weaker_and_slide_at_their_own_friction() -> None:
    place = moving([2.0])
    whole = run(place, fill=FILL)["collapse_load_N"]
    spans = [{**SPAN, "rings": 3}]
    rough, smooth = (
        run(place, spans=spans, fill=FILL, joints={"types": [{"joints": ["rings"], "friction": mu}]})["collapse_load_N"]
        for mu in (0.7, 0.1)
    )
    assert smooth < 0.8 * rough and rough < whole


def test_rings_that_crush_are_no_linear_programme(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whether a bridge of many loops stands is asked of the curve of strength: its tangent planes led on without end."""
    rings = bridge(spans=[SPAN | {"rings": 2, "voussoirs": 50}], backing={"height": 1.0})
    mu = np.full(len(rings.a), 0.6)
    limit = LimitAnalysis(rings, mu, strength=4e6)
    gamma = limit.collapse()[0].gamma

    def asked(*_: Any) -> None:
        raise AssertionError("a linear programme was asked")

    monkeypatch.setattr(limit, "optimise", asked)
    assert limit.stands(0.0) and limit.stands(gamma - 1e-5) and not limit.stands(gamma + 1e-5)


def test_rings_that_crush_are_answered_at_every_place(monkeypatch: pytest.MonkeyPatch) -> None:
    """By cones: an interior-point method of our own did not settle from its first start, tangent planes not at all."""

    def asked(*_: Any) -> None:
        raise AssertionError("a linear programme was asked")

    monkeypatch.setattr(LimitAnalysis, "_by_programme", asked)
    data = {
        "structure": {
            "kind": "bridge",
            "depth": 6.0,
            "piers": [{"width": 2.0, "height": 4.0}],
            "abutments": {"width": 3.0, "height": 4.0},
            "spans": [
                {"shape": "segmental", "span": 10.0, "rise": 2.5, "thickness": 0.55, "rings": 2},
                {"shape": "three-centred", "span": 8.0, "rise": 2.4, "thickness": 0.5},
            ],
            "backing": {"height": 1.0},
            "surfacing": {"thickness": 0.12},
            "fill": {"cover": 0.4, "density": 1900.0, "friction_angle": "32 deg", "passive": 0.5},
        },
        "material": {"density": 2300.0, "compressive_strength": 8e6},
        "joints": {"friction": 0.6, "types": [{"joints": ["rings"], "friction": 0.4}]},
        "analysis": {
            "kind": "moving-load",
            "axles": [0.0, 1.2, 5.0],
            "axle_loads": [60e3, 60e3, 40e3],
            "count": 9,
            "factors": {"live": 1.35, "dynamic": 1.4, "strength": 2.0},
        },
    }
    (answer,) = extrados.run(data).analyses
    assert answer["status"] == "ok"


def test_a_load_at_rest_spreads_through_the_fill() -> None:
    """Half the collapse load at rest and half crossing is the collapse load."""
    whole = run(moving([2.0]), fill=FILL)["collapse_load_N"]
    half = run(moving([2.0], load=[{"x": 2.0, "force": 0.5 * whole}]), fill=FILL)["collapse_load_N"]
    assert half == pytest.approx(0.5 * whole, rel=1e-7)


# Trains


def options(**keys: Any) -> MovingLoad:
    return MovingLoad.model_validate({"kind": "moving-load", **keys})


def test_lm1_fills_the_lanes_of_a_carriageway() -> None:
    for width, lanes, axle, even in (
        (3.0, None, 300e3, 27e3),
        (4.5, None, 300e3, 27e3 + 2.5e3 * 1.5),
        (5.6, None, 500e3, 9e3 * 2.8 + 2.5e3 * 2.8),
        (7.0, None, 500e3, 27e3 + 2.5e3 * 4.0),
        (7.0, 1, 300e3, 27e3),
        (12.0, None, 600e3, 27e3 + 2.5e3 * 9.0),
    ):
        train = train_of(options(train="LM1", **({"lanes": lanes} if lanes else {})), width)
        assert train.axles.tolist() == [0.0, 1.2] and train.forces.tolist() == [axle] * 2
        assert train.even[:, 2] == pytest.approx([even])


def test_trains_of_railways() -> None:
    train = train_of(options(train="LM71", alpha=1.21), 5.0)
    assert np.diff(train.axles) == pytest.approx([1.6] * 3) and train.forces == pytest.approx([1.21 * 250e3] * 4)
    assert train.even.tolist() == [[-FOR_EVER, -0.8, 1.21 * 80e3], [5.6, FOR_EVER, 1.21 * 80e3]]
    assert train.marks == pytest.approx([0.0, 1.6, 3.2, 4.8, 5.6])
    train = train_of(options(train="SW/2"), 5.0)
    assert not len(train.axles) and train.even.tolist() == [[0.0, 25.0, 150e3], [32.0, 57.0, 150e3]]
    assert train.marks.tolist() == [0.0, 25.0, 32.0, 57.0]
    assert [train.within(0.0, 6.0, place) for place in (0.0, 3.0, 28.5, 32.5)] == [0.0, 150e3 * 3.0, 150e3 * 2.5, 150e3 * 0.5]


def test_a_train_of_the_deck_is_the_one_of_the_code() -> None:
    keys = {"fill": FILL, "surfacing": ROAD, "depth": 3.0}
    code = run(moving(train="LM71"), **keys)
    own = run(
        moving(axles=[0.0, 1.6, 3.2, 4.8], axle_loads=[250e3] * 4, uniform=[{"stop": -0.8, "load": 80e3}, {"start": 5.6, "load": 80e3}]),
        **keys,
    )
    assert own["adequacy_factor"] == pytest.approx(code["adequacy_factor"], rel=1e-9) and own["train"] == "train"


@pytest.mark.parametrize(
    ("keys", "words"),
    [
        ({"train": "LM1", "force": 1e5}, "`train` replaces"),
        ({"axles": [0.0, 1.0], "axle_loads": [1e5]}, "one load above 0 for each"),
        ({"uniform": [{"load": 1e4}]}, "requires `axle_loads`"),
        ({"axles": []}, "expected at least one axle"),
        ({"train": "LM71", "lanes": 2}, "is used only with train"),
        ({"axles": [], "uniform": [{"start": 2.0, "stop": 1.0, "load": 1e4}]}, "stop behind start"),
    ],
)
def test_wrong_trains_are_complaints(keys: dict[str, Any], words: str) -> None:
    with pytest.raises(DeckError, match=words):
        run(moving(**keys))


def test_refusals_of_trains() -> None:
    assert "space for 1, not 3" in run(moving(train="LM1", lanes=3), depth=4.0).reason
    assert "exceeds the depth" in run(moving(width=5.0), depth=4.0).reason


def test_even_loads_stand_where_they_are_adverse() -> None:
    """No pattern of a random twenty brings the bridge down sooner than the one found."""
    a = bridge(spans=[{**SPAN, "rise": 4.0}], fill=FILL)
    loads = tilt_loads(a)
    low, high = float(a.q[0, 0]), float(a.q[-1, 0])
    even = np.array([[-FOR_EVER, FOR_EVER, 1e4]])
    train = Train("train", np.array([0.0]), np.array([5e4]), even, True)
    one = np.ones(1)

    def job(adverse: bool) -> Places:
        return Places(a, 0.6, None, True, loads, 2.0 * one, one, train, (low, high), 0.3, adverse, _top(a, low, high))

    found, everywhere = job(True).collapse(0), job(False).collapse(0)
    assert found.factor < 0.9 * everywhere.factor
    axles = job(True)._axles(0)
    force, x, block = job(True)._even(0)
    rng = np.random.default_rng(1)
    for _ in range(20):
        ends = np.sort(rng.uniform(low, high, 2))
        pattern = (x > ends[0]) & (x < ends[1])
        tried = job(True).under(axles + pressed(np.where(pattern, force, 0.0), x, block, len(a.mass)), pattern)
        assert tried.factor >= found.factor * (1.0 - 1e-9)


def test_even_loads_alone_stand_where_they_are_adverse() -> None:
    """Over the whole span they only press a thin arch together; where they may stand in parts they are no safer than on a half."""
    arch = {"kind": "arch", "radius": 5.0, "thickness": 0.8, "embrace": 150.0, "voussoirs": 9}

    def factor(**keys: object) -> float:
        deck = {"structure": arch, "joints": {"friction": 0.7}, "analysis": {"kind": "moving-load", "axles": [], "places": [0.0], **keys}}
        return extrados.run(deck)["moving-load"].adequacy_factor

    half = factor(adverse=False, uniform=[{"load": 2e4, "start": 0.0, "stop": 10.0}])
    assert factor(uniform=[{"load": 2e4}]) <= half * (1.0 + 1e-9)


def test_even_loads_alone_cross_a_bridge() -> None:
    """Without axles the places depend on the span, not on the train, and each has a load on it: 12.9, as beside an axle of 1 N."""
    fill = {"cover": 0.5, "density": 1900, "friction_angle": 32, "passive": 0.5}
    keys = {"depth": 4.0, "spans": [{"span": 6.0, "rise": 1.2, "thickness": 0.45}], "fill": fill, "material": {"density": 2300}}
    keys["joints"] = {"friction": 0.6}
    short, far = ({"load": "100 kN/m", "start": start, "stop": start + 3.0} for start in (0.0, 40.0))
    alone = run(moving(axles=[], uniform=[{"load": "100 kN/m"}]), **keys)
    beside = run(moving([1.0], axle_loads=["1 N"], uniform=[{"load": "100 kN/m"}]), **keys)
    assert alone["adequacy_factor"] == pytest.approx(12.91, abs=0.01) == beside["adequacy_factor"]
    assert len(alone.arrays["place"].data) == 1 and "with uniform loads on x =" in alone.answer and "axle" not in alone.answer
    one, two = (run(moving(axles=[], uniform=even, adverse=False), **keys) for even in ([short], [short, far]))
    assert two["adequacy_factor"] == pytest.approx(one["adequacy_factor"], rel=1e-9) and one["adequacy_factor"] < 100.0
    count = len(two.arrays["place"].data)
    assert count == 2 * len(one.arrays["place"].data) > 18 and f"At {two['places_without_limit']} of {count} positions" in two.answer
    refused = run(moving([-10.0], axles=[], uniform=[short]), **keys)
    assert refused.status == "refused" and "no load acts on the bridge at any of these positions" in refused.reason


def test_partial_factors() -> None:
    keys = {"fill": FILL, "surfacing": ROAD}
    plain = run(moving(train="LM1"), depth=3.0, **keys)["adequacy_factor"]
    doubled = run(moving(train="LM1", factors={"live": 1.6, "dynamic": 1.25}), depth=3.0, **keys)
    assert doubled["adequacy_factor"] == pytest.approx(0.5 * plain) and doubled["live_load_factor"] == 2.0
    heavy = run(moving([2.0], factors={"masonry": 1.2, "fill": 1.3, "surfacing": 1.4}), fill={"cover": 0.3}, surfacing=ROAD)
    same = run(
        moving([2.0]),
        fill={"cover": 0.3, "density": 2600.0},
        surfacing={"thickness": 0.1, "density": 1.4 * 2300.0},
        material={"density": 2400.0},
    )
    assert heavy["collapse_load_N"] == pytest.approx(same["collapse_load_N"], rel=1e-9)
    soft = run(
        moving([2.0], factors={"strength": 2.0, "friction": 1.4}), material={"compressive_strength": 6e6}, joints={"friction": 0.7}, **keys
    )
    same = run(moving([2.0]), material={"compressive_strength": 3e6}, joints={"friction": 0.5}, **keys)
    assert soft["collapse_load_N"] == pytest.approx(same["collapse_load_N"], rel=1e-9)


def test_a_strip_carries_the_load() -> None:
    whole = run(moving(train="LM71"), fill=FILL, depth=6.0)
    strip = run(moving(train="LM71", width=3.0), fill=FILL, depth=6.0)
    alone = run(moving(train="LM71"), fill=FILL, depth=3.0)
    assert strip["adequacy_factor"] == pytest.approx(0.5 * whole["adequacy_factor"])
    assert strip["adequacy_factor"] == pytest.approx(alone["adequacy_factor"])
    assert strip["collapse_load_N"] == pytest.approx(alone["collapse_load_N"])


def test_both_ways_mirror_each_other_on_a_symmetric_bridge() -> None:
    result = run(moving(axles=[0.0, 1.0, 3.0], axle_loads=[5e4, 1e5, 1.5e5], both_ways=True), fill=FILL)
    ahead, back = np.split(result["adequacy"], 2)
    assert np.isfinite(ahead).sum() > 5 and ahead == pytest.approx(back, rel=1e-7, nan_ok=True)
    half = len(ahead)
    assert result["place"][:half] + result["place"][half:] == pytest.approx(np.full(half, 8.0))


@pytest.mark.parametrize("axles", [[0.0], [0.0, 9.5], [0.0, 19.0]])
def test_the_least_factor_does_not_depend_on_the_first_positions(axles: list[float]) -> None:
    """Axles a span apart had half of the positions: 12.77 with 21, 12.23 with 400."""
    arch = {"kind": "arch", "radius": 5.0, "thickness": 0.8, "embrace": 150.0, "voussoirs": 9}
    asked = {"kind": "moving-load", "axles": axles, "axle_loads": [1e4] * len(axles)}
    coarse, fine = (
        extrados.run({"structure": arch, "joints": {"friction": 0.7}, "analysis": {**asked, "count": count}}).results[0]["adequacy_factor"]
        for count in (21, 400)
    )
    assert coarse == pytest.approx(fine, rel=1e-9) and fine == pytest.approx(12.1786, abs=1e-3)


def test_zones_of_thrust_hold_the_strength() -> None:
    weak, strong = (
        run(moving([2.0]), fill=FILL, material={"compressive_strength": f}, joints={"friction": "no-sliding"}) for f in (2e6, 1e12)
    )
    plain = run(moving([2.0]), fill=FILL, joints={"friction": "no-sliding"})
    assert weak["collapse_load_N"] < 0.95 * plain["collapse_load_N"]
    assert strong["collapse_load_N"] == pytest.approx(plain["collapse_load_N"], rel=1e-4)
    a = bridge(fill=FILL)
    for name in ("inner", "outer"):
        share = ((weak[f"zone_{name}"] - a.p) * a.tangent).sum(axis=1) / a.length
        assert share.min() > -1e-6 and share.max() < 1.0 + 1e-6
    width = np.hypot(*(weak["zone_outer"] - weak["zone_inner"]).T)
    k = int(weak["envelope_normal"][0].argmax())
    assert width[k] * 2e6 == pytest.approx(weak["envelope_normal"][0, k]) == weak["greatest_compression_N"]
    envelope = weak.tables["moving_load_envelope"].columns
    assert envelope["greatest_compression"].max() == pytest.approx(weak["greatest_compression_N"] / 1e3)
    assert (envelope["least_position"] >= 0.0).all() and (envelope["greatest_position"] <= 1.0).all()


# Other strategies


def test_rocking_and_bodies_leave_passive_pressure_out_and_say_so() -> None:
    pulse = {"kind": "sine-pulse", "amplitude": "1 g", "period": 0.5}
    with_, without = (run({"kind": "rocking"}, fill={"cover": 0.3, "passive": m}, motion=pulse) for m in (0.5, 0.0))
    assert any("passive pressure" in w for w in with_.warnings) and not any("passive" in w for w in without.warnings)
    assert with_["peak_rotation_rad"] == without["peak_rotation_rad"]
    assert (
        run({"kind": "tilt"}, fill={"cover": 0.3, "passive": 0.5})["collapse_acceleration_g"]
        > 1.1 * (run({"kind": "tilt"}, fill={"cover": 0.3})["collapse_acceleration_g"])
    )


def test_abutments_on_one_level_with_a_deeper_pier_between_have_supports_of_their_own() -> None:
    made = bridge(spans=[SPAN, SPAN], piers=[{"width": 2.0, "height": 4.0}], abutments={"width": 2.5, "height": 3.0})
    bodies = rigid_bodies(made)
    supports = bodies.names[bodies.count :]
    assert len(supports) == 3 and all("," not in name for name in supports)


def test_a_sweep_reaches_into_fill_and_spans() -> None:
    swept = run({"kind": "sweep", "vary": "spans.0.rise", "values": [1.5, 2.0, 2.5], "locate": False}, fill=FILL)
    plain = run({"kind": "tilt"}, fill=FILL)
    assert swept["collapse_accelerations_g"][1] == pytest.approx(plain["collapse_acceleration_g"], rel=1e-9)
    soil = run({"kind": "sweep", "vary": "fill.passive", "values": [0.0, 0.5, 1.0], "locate": False}, fill=FILL)
    assert soil["collapse_accelerations_g"][1] == pytest.approx(plain["collapse_acceleration_g"], rel=1e-9)
    assert np.all(np.diff(soil["collapse_accelerations_g"]) > 0.0)
    assert "a number from 0 to 0 in place of '1'" in run({"kind": "sweep", "vary": "spans.1.rise", "values": [1.0, 2.0]}).reason


def test_pushes_go_with_sliding_that_does_not_dilate() -> None:
    a = bridge(fill=FILL, backing={"height": 1.0})
    loads = tilt_loads(a)
    loads = Loads(loads.dead, under_load(a.earth, len(a.mass), 2.0, 1e5, 0.3), loads.resistance)
    dilating, _ = LimitAnalysis(a, 0.5, loads=loads).collapse(1)
    state, mechanism = LimitAnalysis(a, 0.5, loads=loads, associated=False).collapse(1)
    assert 0.5 * dilating.gamma < state.gamma <= dilating.gamma * (1.0 + 1e-6)
    push = loads.resistance
    x, y = a.centroid[push.block].T
    u, v, spin = mechanism.velocity[push.block].T
    work = (push.wrench * np.column_stack([u + spin * y, v - spin * x, spin])).sum(axis=1)
    moves = np.abs(work) > 1e-3 * np.abs(work).max()
    assert state.mobilised[moves] == pytest.approx(np.where(work[moves] < 0.0, 1.0, 0.0), abs=1e-6)
    force = loads.dead + state.gamma * loads.live + (push.spread(len(a.mass)) * state.mobilised).sum(axis=2)
    joint = state.force(a)
    at = state.points(a)
    wrench = np.column_stack([joint, at[:, 0] * joint[:, 1] - at[:, 1] * joint[:, 0]])
    for ends, sign in ((a.a, 1.0), (a.b, -1.0)):
        held = ends != GROUND
        np.add.at(force, ends[held], sign * wrench[held])
    assert np.abs(force).max() < 1e-6 * loads.scale


# What a verdict on a train supposes

RING: dict[str, Any] = {"kind": "arch", "radius": 10.0, "thickness": 1.5, "embrace": 157.5, "voussoirs": 21, "depth": 3.0}


def ring(**analysis: Any) -> Result:
    """A moving load on a bare arch."""
    deck = make_deck({"structure": RING, "joints": {"friction": 0.7}, "analysis": moving(**analysis)})
    return run_analyses(Context(deck, threads=1))[0]


@pytest.mark.parametrize("train", ["LM1", "LM71", "SW/0"])
def test_a_bare_ring_is_no_model_of_a_bridge(train: str) -> None:
    """Its ratio is above 1, and the verdict is open all the same, with what is missing and what to do."""
    found = ring(train=train)
    assert found.verdict.ratio > 1.0 and found.verdict.outcome == "open"
    (violated,) = found.verdict.violated
    assert f"{train} acts directly on the blocks" in violated and violated in found.verdict.statement
    assert any(violated in w and "Add fill to the structure" in w for w in found.warnings)


def test_a_bridge_without_fill_is_a_bare_ring_and_with_it_is_not() -> None:
    bare, filled = run(moving(train="LM1"), depth=4.0), run(moving(train="LM1"), depth=4.0, fill={"cover": 0.4})
    assert bare.verdict.violated and bare.verdict.outcome != "stands"
    assert not filled.verdict.violated and not any("does not represent a bridge" in w for w in filled.warnings)


@pytest.mark.parametrize(
    "load", [{"force": "10 kN"}, {"axle_loads": ["10 kN", "10 kN"], "axles": [0.0, 1.2]}, {"axles": [], "uniform": [{"load": "5 kN/m"}]}]
)
def test_any_load_on_a_bare_ring_leaves_the_verdict_open(load: dict[str, Any]) -> None:
    found = ring(**load)
    assert found.verdict.ratio > 1.0 and found.verdict.outcome == "open"
    (violated,) = found.verdict.violated
    assert "directly on the blocks: fill does not spread the load" in violated
    assert sum(violated in w for w in found.warnings) == 1


@pytest.mark.parametrize("factors", [{}, {"live": 1.35}, {"masonry": 0.95}, {"strength": 2.0}, {"friction": 1.1}])
def test_a_verdict_without_partial_factors_says_so(factors: dict[str, float]) -> None:
    words = "All partial factors are 1.0: loads and strengths are characteristic values, without the safety margin of a code."
    for found in (run(moving(train="LM1", factors=factors), depth=4.0, fill={"cover": 0.4}), ring(force="10 kN", factors=factors)):
        assert (words in found.verdict.statement) == (words in found.answer) == (not factors)


def test_no_remark_where_there_is_no_verdict() -> None:
    found = ring()
    assert found.verdict.outcome == "not-applicable" and found.verdict.violated
    assert "partial factors" not in found.verdict.statement + found.answer
