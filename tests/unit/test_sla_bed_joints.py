"""Masonry whose tensile strength depends on the direction to its bed joints (Lourenco, de Borst and Rots 1997)."""

import numpy as np
import pytest

from extrados.core.sla import Bars, Bedding, Behaviour, Events, Freedoms, Hill, Model, Monitor, Plane, Softening, Stop, teeth
from extrados.model.properties import Material

YOUNG, STRENGTH, ENERGY, THICKNESS = 5e9, 0.2e6, 40.0, 0.1
SIDE = 0.25
PLACE, CORNERS = SIDE * np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]]), np.array([[0, 1, 2]])


def turned(angle: float) -> np.ndarray:
    """Columns: the axes of a frame at an angle to x."""
    return np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])


def single(bedding: Bedding | None, a: np.ndarray, b: np.ndarray, axis: float = np.nan) -> Model:
    """A triangle with one point under uniform stresses a + lambda b, both (2, 2) [Pa]."""
    law = Softening(STRENGTH, ENERGY, "exponential", 0.05, True, False)
    group = Plane("T3", CORNERS, THICKNESS, YOUNG, 0.2, SIDE, law, axis=axis, bedding=bedding)
    model = Model(PLACE, Freedoms.make(3, [(0, 0), (0, 1), (1, 1)]), [group], Behaviour("rotating"))
    model.loads(uniform(a), uniform(b))
    return model


def uniform(stress: np.ndarray) -> np.ndarray:
    """Nodal forces (3, 2) [N] of a uniform stress on the boundary of the triangle: half of each edge's on both its ends."""
    edge = np.roll(PLACE, -1, axis=0) - PLACE
    half = 0.5 * THICKNESS * np.column_stack([edge[:, 1], -edge[:, 0]]) @ stress
    return half + np.roll(half, 1, axis=0)


def excess(bedding: Bedding, stress: np.ndarray) -> float:
    """Below 0 where the criterion is met: the greatest root f1 of Lourenco's, in the axes of the joints [Pa]."""
    r = turned(bedding.angle)
    s = r.T @ stress @ r
    x, y = s[0, 0] - bedding.strength * STRENGTH, s[1, 1] - STRENGTH
    return 0.5 * (x + y) + np.hypot(0.5 * (x - y), bedding.shear * s[0, 1])


def test_admitted_range_against_the_criterion() -> None:
    """Random stresses, angles and strengths: the ends of the range lie on the criterion, beyond it is exceeded."""
    rng = np.random.default_rng(18)
    ends = 0
    for _ in range(60):
        bedding = Bedding(rng.uniform(-np.pi, np.pi), np.exp(rng.uniform(-1.5, 1.5)), 1.3, max(1.0, rng.uniform(0.5, 2.5)))
        a, b = (s + s.T for s in rng.normal(0.0, 0.1e6, (2, 2, 2)))
        with single(bedding, a, b) as model:
            report = model.report(0.0)
        lo, hi = float(report["lambda_lo"][0]), float(report["lambda_hi"][0])
        if lo > hi:
            assert all(excess(bedding, a + x * b) > 0.0 for x in np.linspace(-20.0, 20.0, 401))
            continue
        for end, out in ((lo, -1.0), (hi, 1.0)):
            if abs(end) < 1e6:
                ends += 1
                assert abs(excess(bedding, a + end * b)) < 1e-9 * (STRENGTH + abs(end) * np.abs(b).max())
                assert excess(bedding, a + (end + out * 1e-3 * max(1.0, abs(end))) * b) > 0.0
        low, high = max(lo, -1e3), min(hi, 1e3)
        assert excess(bedding, a + (0.5 * low + 0.5 * high) * b) < 0.0
    assert ends > 40


@pytest.mark.parametrize("degrees", [0.0, 30.0, 45.0, 60.0, 90.0])
def test_crack_turns_to_the_weak_joints_and_takes_interpolated_teeth(degrees: float) -> None:
    """Uniaxial tension with a = 1: the normal solves the eigenproblem of the shifted stress, the stress across the crack
    is the interpolated strength, and the second tooth is that of a law with interpolated strength and energy."""
    bedding = Bedding(np.radians(degrees), 2.5, 4.0)
    pull = STRENGTH * np.diag([1.0, 0.0])
    with single(bedding, 0.0 * pull, pull) as model:
        watched = [Monitor.of(1, 0)]
        first = model.run(1, watched)
        model.run(1, watched)  # applies the first event
        report = {name: float(values[0]) for name, values in model.report(1.0).items()}
    c2, s2 = np.cos(np.radians(degrees)) ** 2, np.sin(np.radians(degrees)) ** 2
    assert first.load[0] == pytest.approx(2.5 / (c2 + 2.5 * s2), rel=1e-10)
    r = turned(bedding.angle)
    shifted = first.load[0] * pull - STRENGTH * r @ np.diag([2.5, 1.0]) @ r.T
    normal = np.linalg.eigh(shifted)[1][:, 1]
    found = np.array([report["cos"], report["sin"]])
    assert abs(normal @ found) == pytest.approx(1.0, abs=1e-9)
    along = (found @ r[:, 0]) ** 2
    strength, energy = STRENGTH * (1 + 1.5 * along), ENERGY * (1 + 3.0 * along)
    assert found @ (first.load[0] * pull) @ found == pytest.approx(strength, rel=1e-9)
    moduli, peaks = teeth(Softening(strength, energy, "exponential", 0.05, True, False), YOUNG, SIDE)
    assert report["ratio_n"] == pytest.approx(moduli[1] / YOUNG, rel=2e-3)  # from tables of bands 2 % apart
    across = report["stress_n"] * report["lambda_hi"]  # at unit load, times the load of the next event
    assert across == pytest.approx(peaks[1], rel=2e-3)
    assert report["band"] == pytest.approx(SIDE, rel=1e-12)


def test_crack_under_weak_shear_goes_on_from_the_stress_it_opened_at() -> None:
    """With a shear strength below the root of both tensile ones, strength after the first tooth keeps below it."""
    bedding = Bedding(np.radians(45.0), 2.5, 2.5, 1.6)
    pull = STRENGTH * np.diag([1.0, 0.0])
    with single(bedding, 0.0 * pull, pull) as model:
        events = model.run(2, [Monitor.of(1, 0)])
        model.run(1, [Monitor.of(1, 0)])
        turn = np.array([float(model.report(1.0)[name][0]) for name in ("cos", "sin")])
    opened = turn @ (events.load[0] * pull) @ turn
    along = (turn @ turned(bedding.angle)[:, 0]) ** 2
    assert opened < 0.9 * STRENGTH * (1 + 1.5 * along)
    # The teeth overshoot by their half width of 5 % but for the first
    assert 0.9 < events.load[1] / events.load[0] < 1.05


def wall(bedding: Bedding | None, turn: float = 0.0, rounds: int = 120, kind: str = "T3") -> tuple[Events, np.ndarray]:
    """A wall on a held base, weighed down and pushed at its top, with its joints and all loads turned by an angle."""
    x, y = np.meshgrid(np.linspace(0.0, 1.0, 6), np.linspace(0.0, 0.8, 5), indexing="ij")
    xy = np.column_stack([x.ravel() + 0.04 * np.sin(9.0 * y.ravel()), y.ravel()])
    at = (np.arange(5)[:, None] * 5 + np.arange(4)).ravel()
    connect = np.column_stack([at, at + 5, at + 6, at + 1])
    if kind == "T3":
        connect = np.concatenate([connect[:, [0, 1, 2]], connect[:, [0, 2, 3]]])
    r = turned(turn)
    foot, top = np.flatnonzero(xy[:, 1] < 0.001), np.flatnonzero(xy[:, 1] > 0.799)
    force = np.zeros((2, *xy.shape))
    force[0, top, 1], force[1, top, 0] = -2e3, 1e3
    xy, force = xy @ r.T, force @ r.T
    if bedding is not None:
        bedding = Bedding(bedding.angle + turn, bedding.strength, bedding.energy, bedding.shear)
    law = Softening(STRENGTH, ENERGY, "linear", 0.1)
    reach = np.tile([0.1, 0.4], (len(connect), 1))
    group = Plane(kind, connect, THICKNESS, YOUNG, 0.2, 0.2, law, points=(2, 2), reach=reach, bedding=bedding)
    held = [(int(n), k) for n in foot for k in (0, 1)]
    with Model(xy, Freedoms.make(len(xy), held), [group], Behaviour("rotating")) as model:
        model.loads(*force)
        events = model.run(rounds, [Monitor.of(int(top[0]), 0)], Stop(compliance=1e9))
        return events, model.damage()


@pytest.mark.parametrize("kind", ["T3", "Q4"])
def test_events_do_not_depend_on_the_axes(kind: str) -> None:
    """A wall turned with its joints cracks at the same loads, and its energies balance."""
    bedding = Bedding(0.3, 2.2, 1.7, 1.3)
    one, two = wall(bedding, kind=kind)[0], wall(bedding, 0.7, kind=kind)[0]
    np.testing.assert_allclose(two.load, one.load, rtol=1e-7)
    np.testing.assert_array_equal(two.point, one.point)
    assert one.ledger_error < 1e-10
    assert abs(wall(Bedding(1.1, 2.2, 1.7, 1.3), kind=kind)[0].load.max() / one.load.max() - 1.0) > 0.05


def test_equal_strengths_are_the_isotropic_material() -> None:
    one, two = wall(None)[0], wall(Bedding(0.9))[0]
    np.testing.assert_allclose(two.load, one.load, rtol=1e-9)
    np.testing.assert_array_equal(two.point, one.point)


def test_given_crack_direction_has_the_interpolated_strength() -> None:
    """Where the crack's normal is given, as in a region of a deck, the stress across it meets nx^2 fx + ny^2 fy."""
    bedding, normal = Bedding(0.4, 2.5, 1.5), np.array([np.cos(1.0), np.sin(1.0)])
    pull = STRENGTH * np.diag([0.3, 1.0])
    with single(bedding, 0.0 * pull, pull, axis=1.0) as model:
        load = model.run(1, [Monitor.of(1, 0)]).load[0]
    expected = STRENGTH * (1 + 1.5 * np.cos(1.0 - 0.4) ** 2)
    assert load == pytest.approx(expected / (normal @ pull @ normal), rel=1e-10)


def test_stored_damage_holds_the_strength_of_each_crack() -> None:
    """A new model with the stored damage admits the same range at every point."""
    pull, bedding = STRENGTH * np.diag([1.0, 0.2]), Bedding(0.6, 2.5, 1.5, 1.6)
    with single(bedding, 0.0 * pull, pull) as model, single(bedding, 0.0 * pull, pull) as other:
        model.run(4, [Monitor.of(1, 0)])
        kept = model.damage()
        assert kept[2, 0] > 1.0  # shear took a share
        other.set_damage(kept)
        np.testing.assert_array_equal(other.damage(), kept)
        for one in (model, other):
            one.loads(0.0 * uniform(pull), uniform(pull))
        for name, values in model.report(1.0).items():
            np.testing.assert_allclose(other.report(1.0)[name], values, rtol=1e-9, atol=1e-30, err_msg=name)


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"tensile_strength_parallel": 1e6}, "requires `tensile_strength`"),
        ({"shear_strength": 1e5}, "shear_strength needs"),
        ({"bed_angle": 10.0}, "bed_angle needs"),
        ({"tensile_strength": 1e5, "fracture_energy": 10.0, "tensile_strength_parallel": 4e5, "shear_strength": 2.1e5}, "the square root"),
        (
            {
                "tensile_strength": 1e5,
                "fracture_energy": 10.0,
                "tensile_strength_parallel": 4e5,
                "compressive_strength": 1e6,
                "lateral_reduction": True,
            },
            "lateral_reduction",
        ),
    ],
)
def test_strengths_that_do_not_fit_are_refused(values: dict, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        Material(**values)


def test_bedding_bounds() -> None:
    """The range of f^2 / G between the joints, with an inner extreme, and bars have none."""
    low, high = Bedding(strength=2.0, energy=8.0).stretch()
    share = np.linspace(0.0, 1.0, 100_001)
    ratio = (1 + share) ** 2 / (1 + 7 * share)
    assert (low, high) == (pytest.approx(ratio.min(), rel=1e-6), pytest.approx(1.0))
    assert ratio.min() < 0.49  # neither of both ends, 0.5 and 1
    with pytest.raises(ValueError, match="shear factor"):
        Bedding(shear=0.9)
    assert not hasattr(Bars(np.array([[0, 1]]), 1.0, 1.0), "bedding")


def crushing(hill: Hill, a: np.ndarray, b: np.ndarray) -> Model:
    """The triangle, of masonry that crushes alone."""
    law = Softening(8e6, 20e3, "linear", 0.05, True, False)
    group = Plane("T3", CORNERS, THICKNESS, YOUNG, 0.2, SIDE, compression=law, hill=[hill])
    model = Model(PLACE, Freedoms.make(3, [(0, 0), (0, 1), (1, 1)]), [group], Behaviour("rotating"))
    model.loads(uniform(a), uniform(b))
    return model


def beyond(hill: Hill, stress: np.ndarray) -> float:
    """Hill's form less one, in the axes of the joints."""
    r = turned(hill.angle)
    x, y, t = (r.T @ stress @ r)[[0, 1, 0], [0, 1, 1]] / 8e6
    return (x / hill.ratio) ** 2 + hill.coupling * x * y / hill.ratio + y**2 + hill.shear * t**2 / hill.ratio - 1.0


def test_admitted_range_against_hills_criterion() -> None:
    """Random stresses, angles and parameters: both ends lie on the ellipse; beyond them it is exceeded."""
    rng = np.random.default_rng(19)
    ends = 0
    for _ in range(60):
        hill = Hill(rng.uniform(-np.pi, np.pi), np.exp(rng.uniform(-1, 1)), rng.uniform(-1.5, 1.5), rng.uniform(0.5, 4.0))
        a, b = (s + s.T for s in rng.normal(0.0, 2.5e6, (2, 2, 2)))
        with crushing(hill, a, b) as model:
            report = model.report(0.0)
        lo, hi = float(report["lambda_lo"][0]), float(report["lambda_hi"][0])
        if lo > hi:
            assert all(beyond(hill, a + x * b) > 0.0 for x in np.linspace(-20.0, 20.0, 401))
            continue
        for end, out in ((lo, -1.0), (hi, 1.0)):
            ends += 1
            assert beyond(hill, a + end * b) == pytest.approx(0.0, abs=1e-9)
            assert beyond(hill, a + (end + 1e-6 * out) * b) > 0.0
    assert ends > 60


@pytest.mark.parametrize("angle", [0.0, 0.4, np.pi / 2])
def test_crushed_masonry_keeps_the_strength_of_its_direction(angle: float) -> None:
    """Pressed in one direction all of its teeth are those of the law, times Hill's strength in that direction."""
    hill = Hill(angle, 1.4, -0.9, 1.5)
    c, s = np.cos(angle) ** 2, np.sin(angle) ** 2
    share = (c**2 / 1.4**2 + (1.5 - 0.9) * c * s / 1.4 + s**2) ** -0.5
    with crushing(hill, np.zeros((2, 2)), np.array([[-1e6, 0.0], [0.0, 0.0]])) as model:
        events = model.run(8, [Monitor.of(1, 0)], Stop())
    _, strength = teeth(Softening(8e6, 20e3, "linear", 0.05, True, False), YOUNG, SIDE)
    np.testing.assert_allclose(events.load, share * strength[:8] / 1e6, rtol=1e-9)
