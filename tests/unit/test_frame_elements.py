"""Macro-elements against closed forms; every number here was computed apart from the program. Units: kN, m, t."""

import numpy as np
import pytest

from extrados.core.frame import Frame, Link, MacroElement, section_forces

L, T, E, G, F, N = 2.0, 0.4, 1.5e6, 6e5, 3000.0, 480.0
FREE, E_RIGID = 1e12, 1e9


def moment(curvature: float) -> float:
    """Moment of the section under N at a curvature, the strain of its middle by bisection."""
    low, high = -1.0, 1.0
    for _ in range(200):
        middle = 0.5 * (low + high)
        force, _, _ = section_forces((L, T, E, F, 1e-15), (middle, curvature))
        low, high = (middle, high) if force[0] < N else (low, middle)
    return float(force[1])


@pytest.mark.parametrize(("curvature", "expected"), [(4e-4, 160.0), (2.5e-3, 352.0), (5e-3, 376.0)])
def test_a_section_without_tension_that_crushes(curvature, expected):
    assert moment(curvature) == pytest.approx(expected, rel=1e-9)
    assert moment(-curvature) == pytest.approx(-expected, rel=1e-9)


def fibres(e0, chi, count=400_000):
    y = (np.arange(count) + 0.5) / count * L - L / 2
    stress = np.clip(E * (e0 + chi * y), 0.0, F)
    return np.array([stress.sum(), (stress * y).sum()]) * T * L / count


@pytest.mark.parametrize("seed", range(20))
def test_a_section_against_fibres_and_its_tangent_against_differences(seed):
    random = np.random.default_rng(seed)
    strain = np.array([random.uniform(-1e-3, 3e-3), random.uniform(-4e-3, 4e-3)])
    force, tangent, _ = section_forces((L, T, E, F, 1e-15), strain)
    assert force == pytest.approx(fibres(*strain), rel=1e-8, abs=1e-6)
    step = 1e-8
    for k in range(2):
        more, less = strain.copy(), strain.copy()
        more[k] += step
        less[k] -= step
        plus, minus = (section_forces((L, T, E, F, 1e-15), e)[0] for e in (more, less))
        assert tangent[:, k] == pytest.approx((plus - minus) / (2 * step), rel=1e-5, abs=1.0)


def test_a_crushed_section_unloads_softer_and_dissipates():
    section = (L, T, E, F, 1e-15)
    path = [*np.linspace(0, 6e-3, 60), *np.linspace(6e-3, -6e-3, 120), *np.linspace(-6e-3, 6e-3, 120)]
    past, work, last = np.array([1.0, 1.0, 0.0, 0.0]), 0.0, None
    for chi in path:
        strain = (1e-3, chi)
        force, _, past = section_forces(section, strain, past)
        if last is not None:
            work += 0.5 * (force[1] + last[0]) * (chi - last[1])
        last = (force[1], chi)
    again, _, _ = section_forces(section, (1e-3, 3e-3), past)
    first, _, _ = section_forces(section, (1e-3, 3e-3))
    assert again[1] < 0.9 * first[1]
    assert work > 0.0


def bench(height=3.0, top="free", **changes) -> Frame:
    """One pier on a held foot under N; freedoms of its top: u, w and, where it may turn, its rotation."""
    turns = top == "free"
    own = {
        "freedoms": (-1, -1, -1, 0, 1, 2 if turns else -1),
        "length": height,
        "depth": L,
        "thickness": T,
        "young": E,
        "shear_stiffness": FREE,
        "second_order": False,
    } | changes
    n = 3 if turns else 2
    weight = np.zeros(n)
    weight[1] = -N
    return Frame([MacroElement(**own)], [], np.zeros((n, n)), weight, np.zeros((n, n)))


def push(frame: Frame, target: float, steps=60, control=0):
    pattern = np.zeros(frame.n)
    pattern[0] = 1.0
    way = np.zeros(frame.n)
    way[control] = 1.0
    return frame.push(pattern, way, target, steps, 0.0)


def test_elastic_stiffness_of_a_pier_that_does_not_turn():
    frame = bench(top="fixed", shear_stiffness=G * L * T / (1.2 * 3.0))
    assert frame.at_rest().tangent[0, 0] == pytest.approx(76190.476, rel=1e-6)


def tip(force: float, height=3.0) -> float:
    """Displacement of the top of a cracked cantilever, flexure alone [m]."""
    u = L / 2 - force * height / N
    return N**3 / (E * T * force**2) * (1 / 54 + 2 / 9 * (L / (2 * u) - 1.5 + np.log(3 * u / L)))


def test_cracked_cantilever():
    assert 1e3 * tip(80.0) == pytest.approx(1.8922, rel=1e-4)  # the closed form against its printed number
    frame = bench(strength=1e12)
    path = push(frame, 0.75e-3, 20)
    assert path.multiple[-1] * 3 == pytest.approx(100.0, rel=1e-6)
    for sections, expected in ((3, 1.9667), (5, 1.8922)):
        path = push(bench(strength=1e12, sections=sections), 2.5e-3, 500)
        assert 1e3 * np.interp(80.0, path.multiple, path.control) == pytest.approx(expected, rel=2e-3)


def test_push_of_a_pier_of_three_sections():
    """It does not turn at the top, so that both ends crush."""
    frame = bench(top="fixed", strength=F, sections=3, shear_stiffness=G * L * T / (1.2 * 3.0))
    path = push(frame, 0.015, 100)
    for drift, expected in ((0.001, 188.73), (0.005, 254.25)):
        assert np.interp(3 * drift, path.control, path.multiple) == pytest.approx(expected, rel=2e-3)
    assert path.multiple.max() < 256.0
    assert path.stop == "target displacement"


def test_push_with_its_height_locked():
    """The top is held at the height that the weight gives it: pressure grows as the pier rocks."""
    own = MacroElement((-1, -1, -1, 0, 1, -1), 3.0, L, T, E, G * L * T / 3.6, F, sections=3, second_order=False)
    stiff, shortening = 1e10, N * 3.0 / (E * L * T)
    lock = Link((1,), (1.0,), stiff, prestress=N + stiff * shortening)
    frame = Frame([own], [lock], np.zeros((2, 2)), np.zeros(2), np.zeros((2, 2)))
    assert frame.at_rest().force[0, 0] == pytest.approx(N, rel=1e-6)
    path = push(frame, 0.006, 100)
    assert path.force[-1, 0, 0] == pytest.approx(713.6, rel=1e-3)
    assert path.multiple[-1] == pytest.approx(311.9, rel=1e-3)


def test_rigid_cantilever_of_second_order():
    """N (L/2 - d)/h less the moment of N about its foot: 128 - 160 d at full flexural strength."""
    frame = bench(young=1e8, strength=F, second_order=True)
    path = push(frame, 0.05, 200)
    assert np.interp(0.03, path.control, path.multiple) == pytest.approx(123.2, rel=3e-3)
    slope = np.diff(np.interp([0.03, 0.05], path.control, path.multiple))[0] / 0.02
    assert slope == pytest.approx(-160.0, rel=2e-2)


def test_shear_of_the_damage_law():
    g, c, mu, ct, beta = 5e5, 100.0, 0.4, 3.0, 0.5
    stiff = g * L * T / 3.0
    frame = bench(top="fixed", young=E_RIGID, shear_stiffness=stiff, shear="damage", cohesion=c, friction=mu, damage=(ct / g, beta))
    path = push(frame, 0.019, 2000)
    slip = path.control - path.multiple * (1.0 / stiff + 3.0**3 / (E_RIGID * T * L**3))
    for s, expected in ((0.225e-3, 232.0), (1.8e-3, 272.0), (3.6e-3, 255.50), (14.4e-3, 232.0)):
        assert np.interp(s, slip, path.multiple) == pytest.approx(expected, rel=1e-3)
    assert path.control[path.multiple.argmax()] == pytest.approx(3.84e-3, rel=1e-2)


@pytest.mark.parametrize(
    ("law", "height", "expected"),
    [
        ({"shear": "mohr-coulomb", "cohesion": 100.0, "friction": 0.4}, 3.0, 226.91),
        ({"shear": "turnsek-cacovic", "tension": 150.0, "slenderness": 1.5}, 3.0, 178.89),
        ({"shear": "least", "cohesion": 100.0, "friction": 0.4, "tension": 150.0, "slenderness": 1.5}, 3.0, 178.89),
    ],
)
def test_shear_strength_of_a_pier(law, height, expected):
    frame = bench(height, top="fixed", shear_stiffness=G * L * T / 3.6, **law)
    path = push(frame, 0.02, 100)
    assert path.multiple.max() == pytest.approx(expected, rel=1e-4)
    assert path.multiple[-1] == pytest.approx(expected, rel=1e-4)
    assert path.state[-1, 0] == 3


def test_strength_is_lost_beyond_a_drift_limit():
    """Shear limits at 0.4 %: the force falls to nothing at that drift, and the weight is still carried."""
    frame = bench(
        top="fixed", shear_stiffness=G * L * T / 3.6, shear="turnsek-cacovic", tension=150.0, slenderness=1.5, drifts=(0.01, 0.004)
    )
    path = push(frame, 0.03, 200)
    lost = np.flatnonzero(path.state[:, 0] == 5)[0]
    assert path.control[lost] / 3.0 == pytest.approx(0.004, abs=1e-4)
    assert path.multiple[lost] == pytest.approx(178.89, rel=1e-3)
    assert abs(path.multiple[-1]) < 1e-4 * N
    assert path.force[-1, 0, 0] == pytest.approx(N, rel=1e-6)
    coarse = push(frame, 0.03, 11)  # steps of 2.7 mm: the limit is located within a fiftieth of one
    first = coarse.control[np.flatnonzero(coarse.state[:, 0] == 5)[0]] / 3.0
    assert 0.004 <= first <= 0.004 + 0.03 / 11 / 50 / 3.0


def test_beam_between_hinges_and_what_it_keeps():
    """A spandrel whose right node goes up: V = 2 M/l at its hinges, 12 E I/l^3 with shear before, 40 % beyond the limit."""
    depth, length, strength = 0.8, 1.2, 20.0
    shear = G * depth * T / (1.2 * length)
    own = MacroElement(
        (-1, -1, -1, -1, 0, -1),
        length,
        depth,
        T,
        E,
        shear,
        pier=False,
        upright=False,
        moment=strength,
        drifts=(0.015, 0.005),
        kept=0.4,
        second_order=False,
    )
    frame = Frame([own], [], np.zeros((1, 1)), np.array([1e-9]), np.zeros((1, 1)))
    bending = 12 * E * T * depth**3 / 12 / length**3
    stiff = 1.0 / (1.0 / bending + 1.0 / shear)
    assert frame.at_rest().tangent[0, 0] == pytest.approx(stiff, rel=1e-5)
    path = push(frame, 0.03, 200)
    assert path.multiple.max() == pytest.approx(2 * strength / length, rel=1e-3)
    assert path.multiple[-1] == pytest.approx(0.4 * 2 * strength / length, rel=1e-3)
    failed = np.flatnonzero(path.state[:, 0] == 4)[0]
    assert path.control[failed] / length == pytest.approx(0.015, abs=3e-4)


def test_motion_of_an_elastic_pier():
    """Constant acceleration at T/20 lengthens the period to 1.00817 times: a pier that nothing cracks, let go by a pulse."""
    mass = 20.0
    own = MacroElement((-1, -1, -1, 0, 1, -1), 3.0, L, T, E, G * L * T / 3.6, second_order=False)
    frame = Frame([own], [], np.zeros((2, 2)), np.array([0.0, -N]), np.diag([mass, 0.0]))
    stiff = frame.at_rest().tangent[0, 0]
    period = 2 * np.pi * np.sqrt(mass / stiff)
    step = period / 20
    acceleration = np.zeros(20 * 40)
    acceleration[1] = 0.01
    path = frame.move(np.array([1.0, 0.0]), acceleration, step, (0.0, 0.0))
    u = path.displacement[2:, 0]
    t = step * np.arange(len(u))
    up = np.flatnonzero((u[:-1] < 0) & (u[1:] >= 0))
    zero = t[up] + step * -u[up] / (u[up + 1] - u[up])
    assert np.diff(zero).mean() / period == pytest.approx(1.00817, abs=2e-4)


def test_cyclic_pushes_dissipate():
    """A slow motion to and fro: the work on crushing, sliding sections is never negative over a cycle."""
    g = 5e5
    own = MacroElement(
        (-1, -1, -1, 0, 1, -1),
        3.0,
        L,
        T,
        E,
        g * L * T / 3.0,
        F,
        shear="damage",
        cohesion=100.0,
        friction=0.4,
        damage=(3.0 / g, 0.5),
        second_order=False,
    )
    mass, period = 1e-3, 1.0
    driver = 1e7  # a stiff spring moved by the ground: u follows the signal
    frame = Frame([own], [], np.diag([driver, 0.0]), np.array([0.0, -N]), np.diag([mass, 0.0]))
    t = np.arange(0, 4 * period, period / 400)
    wanted = 0.01 * np.minimum(t / 3.0, 1.0) * np.sin(2 * np.pi * t / period)
    path = frame.move(np.array([1.0, 0.0]), -wanted * driver / mass, period / 400, (0.0, 0.0))
    assert path.stop == "target displacement"
    shear = (path.force[:, 0, 1] + path.force[:, 0, 2]) / 3.0
    u = path.displacement[:, 0]
    work = 0.5 * (shear[1:] + shear[:-1]) * np.diff(u)
    for cycle in range(4):
        assert work[400 * cycle : 400 * (cycle + 1)].sum() > -1e-9
    assert work.sum() > 0.5
