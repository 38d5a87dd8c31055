"""Limit analysis of arches against independently computed values and laws."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import linprog

from extrados.limit.answer import CannotStand, assess
from extrados.limit.finite_motion import finite_motion, rigid_parts
from extrados.limit.graphic import thrust_of
from extrados.limit.loads import Loads, forces_at, tilt_loads
from extrados.limit.programme import LimitAnalysis, NoEquilibrium
from extrados.model.geometry.assembly import GROUND, Assembly
from extrados.model.geometry.builder import Builder
from extrados.model.structures.arch import make_arch
from extrados.model.structures.arches import make_elliptical_arch, make_pointed_arch

GRAVITY = 9.80665


def full_programme(a: Assembly, loads: Loads | None = None, friction: float | None = None) -> float:
    """Greatest gamma by SciPy on three equations per block: another formulation, another interface."""
    loads = loads or tilt_loads(a)
    m, unit = len(a.a), loads.scale * np.array([1.0, 1.0, a.size])
    matrix = np.zeros((3 * len(a.mass), 3 * m + 1))
    for j in range(m):
        n, t, middle = a.normal[j], a.tangent[j], 0.5 * (a.p[j] + a.q[j])
        for k, (direction, point) in enumerate(((n, a.p[j]), (n, a.q[j]), (t, middle))):
            wrench = np.array([*direction, (point[0] * direction[1] - point[1] * direction[0]) / a.size])
            for block, sign in ((a.a[j], 1.0), (a.b[j], -1.0)):
                if block != GROUND:
                    matrix[3 * block : 3 * block + 3, 3 * j + k] += sign * wrench
    matrix[:, -1] = (loads.live / unit).ravel()
    cost = np.zeros(3 * m + 1)
    cost[-1] = -1.0
    bounds = [(0, None), (0, None), (None, None)] * m + [(None, None)]
    cone = None
    if friction is not None:
        cone = np.zeros((2 * m, 3 * m + 1))
        for j in range(m):
            for row, sign in ((2 * j, 1.0), (2 * j + 1, -1.0)):
                cone[row, 3 * j : 3 * j + 3] = -friction, -friction, sign
    found = linprog(
        cost,
        A_ub=cone,
        b_ub=None if cone is None else np.zeros(2 * m),
        A_eq=matrix,
        b_eq=-(loads.dead / unit).ravel(),
        bounds=bounds,
        method="highs-ds",
    )
    return -found.fun


# (embrace, thickness, voussoirs) -> gamma, all with a radius of 10 m (computed with SciPy's full programme)
CAPACITY = {
    (157.5, 1.5, 7): 0.3700097380218763,
    (157.5, 1.5, 14): 0.3589,
    (157.5, 1.5, 21): 0.3557,
    (157.5, 1.5, 35): 0.3536,
    (157.5, 1.5, 70): 0.3535,
    (157.5, 1.5, 140): 0.3534,
    (157.5, 1.5, 700): 0.3534,
    (120.0, 1.5, 120): 0.9135,
    (120.0, 1.5, 12): 0.9159,
    (120.0, 1.5, 8): 0.9304,
    (120.0, 1.5, 7): 0.9519,
    (120.0, 1.5, 6): 0.9423,
    (162.0, 1.5, 16): 0.3120,
    (162.0, 1.2, 16): 0.2096,
    (152.0, 1.5, 15): 0.4107,
    (152.0, 1.2, 15): 0.3027,
}


@pytest.mark.parametrize(("arch", "gamma"), CAPACITY.items())
@pytest.mark.parametrize("form", ["reduced", "sparse"])
def test_capacity(arch: tuple, gamma: float, form: str) -> None:
    embrace, thickness, voussoirs = arch
    state, mechanism = LimitAnalysis(make_arch(10.0, thickness, embrace, voussoirs), form=form).collapse()
    assert state.gamma == pytest.approx(gamma, abs=1e-12 if voussoirs == 7 and embrace > 150 else 5.1e-5)
    assert abs(state.gamma - mechanism.upper_bound) < 1e-9
    assert mechanism.defect < 1e-9


@pytest.mark.parametrize(
    ("arch", "hinges"),
    [
        ((10.0, 1.5, 157.5, 7), [(0, "intrados"), (3, "extrados"), (5, "intrados"), (7, "extrados")]),
        ((10.0, 1.5, 120.0, 120), [(0, "intrados"), (28, "extrados"), (80, "intrados"), (120, "extrados")]),
    ],
)
def test_hinges(arch: tuple, hinges: list) -> None:
    limit = LimitAnalysis(make_arch(*arch))
    assert limit.collapse()[1].hinges == hinges
    count = arch[3]
    mirrored = sorted((count - j, side) for j, side in hinges)
    state, mechanism = limit.collapse(-1)
    assert mechanism.hinges == mirrored and state.gamma == pytest.approx(-limit.collapse()[0].gamma, abs=1e-12)


def test_state_at_collapse() -> None:
    """Position of the thrust line and friction needed at the joints of Oppenheim's arch."""
    state, _ = LimitAnalysis(make_arch(10.0, 1.5, 157.5, 7)).collapse()
    assert state.position == pytest.approx([0, 0.2796, 0.9106, 1, 0.3797, 0, 0.1682, 1], abs=5.1e-5)
    assert state.friction == pytest.approx([0.065, 0.237, 0.176, 0.130, 0.252, 0.110, 0.149, 0.495], abs=5.1e-4)


@pytest.mark.parametrize(
    ("embrace", "voussoirs", "least", "most"),
    [(157.5, 7, 0.1938, 0.3268), (157.5, 140, 0.2010, 0.3268), (120.0, 140, 0.2638, 0.5840), (180.0, 180, 0.1759, 0.2270)],
)
def test_least_and_greatest_thrust(embrace: float, voussoirs: int, least: float, most: float) -> None:
    arch = make_arch(10.0, 1.5, embrace, voussoirs)
    limit = LimitAnalysis(arch)
    weight = np.radians(embrace) * 10.0 * 1.5 * 2000.0 * GRAVITY
    chain = arch.chains["arch"]
    low, high = limit.thrust(chain)
    assert thrust_of(arch, low, chain) / weight == pytest.approx(least, abs=5.1e-5)
    assert thrust_of(arch, high, chain) / weight == pytest.approx(most, abs=5.1e-5)


FRICTION = {0.50: 0.3700, 0.48: 0.3525, 0.45: 0.3184, 0.42: 0.2853, 0.40: 0.2638, 0.38: 0.2426, 0.36: 0.2196, 0.34: 0.1955}


@pytest.mark.parametrize(("friction", "gamma"), FRICTION.items())
def test_friction(friction: float, gamma: float) -> None:
    """Sliding replaces the hinge at the leeward springing; without dilatancy a single chain bears the same."""
    arch = make_arch(10.0, 1.5, 157.5, 7)
    state, mechanism = LimitAnalysis(arch, friction).collapse()
    assert state.gamma == pytest.approx(gamma, abs=5.1e-5)
    assert abs(state.gamma - mechanism.upper_bound) < 1e-9
    assert (mechanism.sliding == [7]) == (friction < 0.495)
    dry, _ = LimitAnalysis(arch, friction, associated=False).collapse()
    assert dry.gamma == pytest.approx(state.gamma, abs=1e-6)
    assert (np.abs(dry.shear) <= friction * dry.normal * (1.0 + 1e-6)).all()


def test_dilatancy_strengthens_a_wall() -> None:
    """Two blocks side by side under a third: without dilatancy sliding holds less than the associated bound."""
    builder = Builder(2000.0, 1.0)
    corner = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    left = builder.block("left", corner)
    right = builder.block("right", corner + np.array([1.0, 0.0]))
    top = builder.block("top", corner * [2.0, 1.0] + [0.0, 1.0])
    for block, x in ((left, 0.0), (right, 1.0)):
        builder.joint("foot", np.array([x, 0.0]), np.array([x + 1.0, 0.0]), block, GROUND, 1)
        builder.joint("head", np.array([x, 1.0]), np.array([x + 1.0, 1.0]), top, block, 1)
    builder.joint("between", np.array([1.0, 0.0]), np.array([1.0, 1.0]), left, right, 1)
    wall = builder.assembly()
    bound = LimitAnalysis(wall, 0.3).collapse()[0]
    dry, _ = LimitAnalysis(wall, 0.3, associated=False).collapse()
    assert dry.gamma <= bound.gamma + 1e-9
    assert dry.gamma == pytest.approx(0.3, abs=1e-6)  # everything slides on the ground


@pytest.mark.parametrize(("voussoirs", "least"), [(27, 0.10678), (36, 0.10746), (180, 0.10746), (1000, 0.10748)])
def test_minimum_thickness_of_the_semicircle(voussoirs: int, least: float) -> None:
    assert thinnest(voussoirs, None) == pytest.approx(least, abs=6e-6)


@pytest.mark.parametrize(("friction", "least"), [(0.395, 0.1068), (0.38, 0.1206), (0.34, 0.1612), (0.31, 0.1953)])
def test_minimum_thickness_with_friction(friction: float, least: float) -> None:
    assert thinnest(27, friction) == pytest.approx(least, abs=6e-5)


def test_too_little_friction_for_any_thickness() -> None:
    assert thinnest(27, 0.30) == pytest.approx(0.6, abs=1e-6)  # the upper end of the search


def thinnest(voussoirs: int, friction: float | None) -> float:
    low, high = 0.05, 0.6
    while high - low > 1e-7:
        middle = 0.5 * (low + high)
        stands = LimitAnalysis(make_arch(1.0, middle, 180.0, voussoirs), friction).stands()
        low, high = (low, middle) if stands else (middle, high)
    return high


@settings(max_examples=25, deadline=None)
@given(
    ratio=st.floats(0.06, 0.4),
    embrace=st.floats(60.0, 190.0),
    voussoirs=st.integers(4, 24),
    friction=st.none() | st.floats(0.3, 1.0),
    radius=st.floats(0.1, 50.0),
)
def test_all_formulations_agree(ratio, embrace, voussoirs, friction, radius) -> None:
    arch = make_arch(radius, ratio * radius, embrace, voussoirs)
    try:
        state, mechanism = LimitAnalysis(arch, friction).collapse()
    except NoEquilibrium:
        with pytest.raises(NoEquilibrium):
            LimitAnalysis(arch, friction, form="sparse").collapse()
        return
    other, _ = LimitAnalysis(arch, friction, form="sparse").collapse()
    assert abs(state.gamma - mechanism.upper_bound) < 1e-9 * max(1.0, abs(state.gamma))
    assert other.gamma == pytest.approx(state.gamma, rel=1e-9, abs=1e-9)
    assert full_programme(arch, friction=friction) == pytest.approx(state.gamma, rel=1e-6, abs=1e-7)


@pytest.mark.parametrize("strength", [1e5, 1e6, 1e8])
def test_crushing_toe_of_a_block(strength: float) -> None:
    """A block on a stress block of depth W / (f d) turns about its middle: gamma = (b - W / (f d)) / h."""
    builder = Builder(2000.0, 2.0)
    block = builder.block("block", np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 3.0], [0.0, 3.0]]))
    builder.joint("base", np.array([0.0, 0.0]), np.array([1.0, 0.0]), block, GROUND, 1)
    wall = builder.assembly()
    weight = 2000.0 * 2.0 * 3.0 * GRAVITY
    state, mechanism = LimitAnalysis(wall, strength=strength).collapse()
    depth = weight / (strength * 2.0)
    assert state.gamma == pytest.approx((1.0 - depth) / 3.0, rel=1e-9)
    assert abs(state.gamma - mechanism.upper_bound) < 1e-9
    assert mechanism.pivot[0] == pytest.approx(1.0 - depth, abs=1e-5)  # the neutral axis


def test_crushing_law_holds_in_an_arch() -> None:
    arch = make_arch(10.0, 1.5, 157.5, 35)
    strength = 2e6
    state, mechanism = LimitAnalysis(arch, strength=strength).collapse()
    n, length = state.normal, arch.length
    moment = np.abs(state.position - 0.5) * length * n
    assert (moment <= n * length / 2 - n**2 / (2 * strength * arch.depth) + 1e-6 * n.max()).all()
    assert state.gamma < LimitAnalysis(arch).collapse()[0].gamma - 0.01
    assert abs(state.gamma - mechanism.upper_bound) < 1e-9
    assert LimitAnalysis(arch, strength=1e15).collapse()[0].gamma == pytest.approx(LimitAnalysis(arch).collapse()[0].gamma)


def test_point_load() -> None:
    arch = make_arch(10.0, 1.5, 150.0, 30)
    live = forces_at(30, 9, arch.q[9], (0.0, -1e6))
    loads = Loads(tilt_loads(arch).dead, live)
    state, mechanism = LimitAnalysis(arch, loads=loads).collapse()
    assert state.gamma == pytest.approx(full_programme(arch, loads), rel=1e-7)
    assert abs(state.gamma - mechanism.upper_bound) < 1e-9 and len(mechanism.hinges) == 4


def test_round_limits_of_pointed_and_elliptical_arches() -> None:
    """A pointed arch of radius half the span and an ellipse of rise half the span are the semicircle."""
    round_one = LimitAnalysis(make_arch(10.0, 1.5, 180.0, 36)).collapse()[0].gamma
    pointed = make_pointed_arch(18.5, 9.25, 1.5, 36)
    ellipse = make_elliptical_arch(18.5, 9.25, 1.5, 36)
    for arch in (pointed, ellipse):
        assert LimitAnalysis(arch).collapse()[0].gamma == pytest.approx(round_one, abs=2e-6)
        assert arch.mass.sum() == pytest.approx(np.pi * 10.0 * 1.5 * 2000.0, rel=1e-4)
    # The pointed arch needs no thrust at the crown that a flat one does: it stands thinner when equilateral.
    assert assess(make_pointed_arch(10.0, 10.0, 1.0, 40)).least["arch"].gamma == 0.0


def test_whole_answer() -> None:
    arch = make_arch(10.0, 1.5, 157.5, 36)
    answer = assess(arch)
    state = answer.collapse_state
    rays = answer.polygons(state)["arch"]
    # From tip to tip of the rays leads the load of each voussoir: weight, and gamma times it to +x.
    weight = arch.mass * GRAVITY
    assert np.diff(rays, axis=0) == pytest.approx(np.column_stack([state.gamma * weight, -weight]), abs=1e-6 * weight[0])
    corners = answer.funiculars(state)["arch"][1:-1]
    # Corners of the funicular polygon lie on the lines of action of the loads.
    arm = corners - arch.centroid
    assert arm[:, 0] + state.gamma * arm[:, 1] == pytest.approx(0.0, abs=1e-6)
    total = sum(answer.reactions(state).values())
    assert total == pytest.approx([-state.gamma * weight.sum(), weight.sum()], rel=1e-9)
    assert answer.gap < 1e-9 and answer.touching == []
    assert answer.safety == pytest.approx(1.0 / answer.part)
    # The most central line: enlarging nothing, some joints are at the bound on either side.
    off = 2.0 * np.abs(answer.central.position - 0.5)
    assert off.max() == pytest.approx(answer.part, abs=1e-9) and (off > answer.part - 1e-6).sum() >= 4


def test_safety_factor_is_that_of_a_thinner_arch() -> None:
    """With weights kept, joints shortened about their middles to the part stand, and no shorter ones."""
    arch = make_arch(10.0, 1.5, 150.0, 24)
    part = assess(arch).part
    for factor, stands in ((1.0 + 1e-6, True), (1.0 - 1e-6, False)):
        middle, half = arch.middle, 0.5 * (arch.q - arch.p) * part * factor
        shorter = {**{k: getattr(arch, k) for k in arch.__dataclass_fields__}, "p": middle - half, "q": middle + half}
        assert LimitAnalysis(type(arch)(**shorter)).stands() is stands


def test_cannot_stand_says_where_and_by_how_much() -> None:
    thin = make_arch(10.0, 0.9, 180.0, 36)
    with pytest.raises(CannotStand, match=r"\d+ % thicker.*joint"):
        assess(thin)
    with pytest.raises(CannotStand, match=r"coefficient of friction must be at least 0\.\d+"):
        assess(make_arch(10.0, 1.5, 180.0, 36), 0.2)
    builder = Builder(2000.0, 1.0)
    leaning = builder.block("leaning", np.array([[0.0, 0.0], [1.0, 0.0], [3.0, 4.0], [2.0, 4.0]]))
    builder.joint("base", np.array([0.0, 0.0]), np.array([1.0, 0.0]), leaning, GROUND, 1)
    with pytest.raises(CannotStand, match=r"only under a horizontal load between -0\.75"):
        assess(builder.assembly())


def test_mechanism_moves_without_stretching() -> None:
    arch = make_arch(10.0, 1.5, 157.5, 21)
    _, mechanism = LimitAnalysis(arch).collapse()
    pose = finite_motion(arch, mechanism)
    part = rigid_parts(arch, mechanism)
    assert part.tolist() == [1] * 8 + [2] * 8 + [3] * 5  # three bars between the springings

    def carried(block: int, point: np.ndarray) -> np.ndarray:
        if block == GROUND:
            return point
        c, s = np.cos(pose[block, 2]), np.sin(pose[block, 2])
        return pose[block, :2] + np.array([[c, -s], [s, c]]) @ (point - arch.centroid[block])

    for j, side in mechanism.hinges:
        point = (arch.p if side == "intrados" else arch.q)[j]
        assert carried(arch.a[j], point) == pytest.approx(carried(arch.b[j], point), abs=1e-9)
    for j in set(range(22)) - {j for j, _ in mechanism.hinges}:  # everywhere else the joints stay closed
        for point in (arch.p[j], arch.q[j]):
            assert carried(arch.a[j], point) == pytest.approx(carried(arch.b[j], point), abs=1e-9)
    assert np.abs(pose[:, 2]).max() > 0.05
    # To first order it is the velocity field of the programme.
    small = finite_motion(arch, mechanism, 1e-5)
    v = mechanism.velocity
    scale = 1e-5 / np.hypot(v[:, 0], v[:, 1]).max()
    assert small[:, :2] - arch.centroid == pytest.approx(v[:, :2] * scale, abs=1e-9)
