"""Elements of sequentially linear analysis: patch tests, orders of convergence, exact small problems."""

import numpy as np
import pytest

from extrados.core.errors import CoreError
from extrados.core.sla import BadElement, Bars, Behaviour, Freedoms, FreeNode, Model, Monitor, Plane, Softening, Springs, Stop, body_force
from extrados.views.mesh.mesh import add_middles

YOUNG, NU = 7.3e9, 0.23
LINES = {"T3": 1, "Q4": 1, "T6": 2, "Q8": 2}


def mesh(kind: str, nx: int, ny: int, width: float, height: float, jitter: float = 0.0):
    """A grid of one kind, its inner nodes moved at random; y from -height/2."""
    x, y = np.meshgrid(np.linspace(0, width, nx + 1), np.linspace(-0.5, 0.5, ny + 1) * height, indexing="ij")
    xy = np.column_stack([x.ravel(), y.ravel()])
    inner = (xy[:, 0] > 1e-9) & (xy[:, 0] < width - 1e-9) & (np.abs(xy[:, 1]) < 0.5 * height - 1e-9)
    move = np.random.default_rng(3).uniform(-jitter, jitter, xy.shape) * [width / nx, height / ny]
    xy += move * inner[:, None]
    at = (np.arange(nx)[:, None] * (ny + 1) + np.arange(ny)).ravel()
    quads = np.column_stack([at, at + ny + 1, at + ny + 2, at + 1])
    if kind in ("T3", "T6"):
        connect, base = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]), "T3"
    else:
        connect, base = quads, "Q4"
    return (*add_middles(xy, base, connect), base) if kind in ("T6", "Q8") else (xy, connect, base)


def edge_forces(xy, connect, base, traction) -> np.ndarray:
    """Consistent nodal forces of a traction(x, y, normal) -> (n, 2) on all boundary edges, by Gauss."""
    n = {"T3": 3, "Q4": 4}[base]
    quadratic = connect.shape[1] > n
    edges = np.concatenate(
        [np.column_stack([connect[:, i], connect[:, (i + 1) % n], connect[:, n + i] if quadratic else connect[:, i]]) for i in range(n)]
    )
    _, first, count = np.unique(np.sort(edges[:, :2], axis=1), axis=0, return_index=True, return_counts=True)
    edges = edges[first[count == 1]]
    a, b = xy[edges[:, 0]], xy[edges[:, 1]]
    normal = np.column_stack([(b - a)[:, 1], -(b - a)[:, 0]])
    force = np.zeros_like(xy)
    for r, w in zip(*np.polynomial.legendre.leggauss(4), strict=True):
        s = 0.5 * (1 + r)
        place = a + s * (b - a)
        t = traction(place, normal / np.linalg.norm(normal, axis=1)[:, None]) * np.linalg.norm(normal, axis=1)[:, None]
        shapes = [(1 - s) * (1 - 2 * s), s * (2 * s - 1), 4 * s * (1 - s)] if quadratic else [1 - s, s]
        for k, shape in enumerate(shapes):
            np.add.at(force, edges[:, k], 0.5 * w * shape * t)
    return force


def solve(kind, xy, connect, force, held, thickness, points=None, selective=False):
    """Displacements and the points' report under nodal forces."""
    points = points or ((3, 3) if kind == "Q8" else (2, 2))
    group = Plane(kind, connect, thickness, YOUNG, NU, points=points, selective=selective)
    with Model(xy, Freedoms.make(len(xy), held), [group]) as model:
        model.loads(np.zeros_like(force), force)
        return model.displacement(1.0), model.report(1.0)


@pytest.mark.parametrize(
    ("kind", "points", "selective"),
    [
        ("T3", None, False),
        ("T6", None, False),
        ("Q4", None, False),
        ("Q4", None, True),
        ("Q4", (3, 2), False),
        ("Q8", (2, 2), False),
        ("Q8", (3, 3), False),
    ],
)
def test_patch(kind, points, selective) -> None:
    """A constant stress under its own boundary forces is found exactly on a distorted mesh."""
    thickness, stress = 0.17, np.array([[1.3e6, 0.41e6], [0.41e6, -0.77e6]])
    # With the shear strain of the middle a distorted element passes only where shear and normal parts decouple
    jitter = 0.0 if selective else 0.21
    xy, connect, base = mesh(kind, 4, 3, 1.9, 1.1, jitter)
    force = thickness * edge_forces(xy, connect, base, lambda place, normal: normal @ stress)
    corner = [int(np.hypot(*(xy - at).T).argmin()) for at in ([0, -0.55], [0, 0.55])]
    _, report = solve(kind, xy, connect, force, [(corner[0], 0), (corner[0], 1), (corner[1], 0)], thickness, points, selective)
    found = np.stack([report["stress_n"], report["stress_s"], report["stress_ns"]], axis=1)
    assert np.abs(found - [1.3e6, -0.77e6, 0.41e6]).max() < 1e-12 * 1.3e6 * 100


def cantilever_exact(xy, length, depth, force, inertia):
    """Timoshenko's plane-stress cantilever under an end shear `force` per thickness: displacements (n, 2).

    sx = -P (L - x) y / I, txy = P/(2I) (c^2 - y^2); rigid body such that u = v = 0 at the origin, u = 0 at (0, c).
    """
    x, y, c = xy[:, 0], xy[:, 1], 0.5 * depth
    ei, ratio = YOUNG * inertia, NU
    u = -force * y / (6 * ei) * ((6 * length - 3 * x) * x + (2 + ratio) * (y**2 - c**2))
    v = force / (6 * ei) * (3 * ratio * y**2 * (length - x) + (4 + 5 * ratio) * c**2 * x + (3 * length - x) * x**2)
    return np.column_stack([u, v])


@pytest.mark.parametrize(("kind", "order_u", "order_energy"), [("T3", 1.9, 1.85), ("Q4", 1.95, 1.9), ("T6", 2.85, 3.7), ("Q8", 2.85, 3.7)])
def test_orders_of_convergence(kind, order_u, order_energy) -> None:
    """Timoshenko's cantilever: displacements in the mean square and the energy on two meshes."""
    length, depth, load = 1.4, 0.6, 9.1e4
    inertia = depth**3 / 12

    def traction(place, normal):
        x, y = place.T
        sx, t = load * (length - x) * y / inertia, load / (2 * inertia) * (0.25 * depth**2 - y**2)
        return np.column_stack([-sx * normal[:, 0] + t * normal[:, 1], t * normal[:, 0]])

    errors, energies = [], []
    exact_energy = None
    for n in (4, 8) if LINES[kind] == 2 else (8, 16):
        xy, connect, base = mesh(kind, 2 * n, n, length, depth)
        force = edge_forces(xy, connect, base, traction)
        top, middle = (int(np.hypot(*(xy - at).T).argmin()) for at in ([0, 0.5 * depth], [0, 0]))
        u, _ = solve(kind, xy, connect, force, [(middle, 0), (middle, 1), (top, 0)], 1.0)
        exact = cantilever_exact(xy, length, depth, load, inertia)
        # The two held nodes fix the rigid body by point values, which converge more slowly: take it out
        rigid = np.zeros((2 * len(xy), 3))
        rigid[0::2, 0] = rigid[1::2, 1] = 1.0
        rigid[0::2, 2], rigid[1::2, 2] = -xy[:, 1], xy[:, 0]
        gap = (u - exact).ravel()
        gap -= rigid @ np.linalg.lstsq(rigid, gap, rcond=None)[0]
        errors.append(np.sqrt(np.mean(gap**2)))
        energies.append(0.5 * float(np.sum(force * u)))
    # Strain energy of the exact stresses: bending plus shear
    exact_energy = load**2 * length**3 / (6 * YOUNG * inertia) + 0.6 * load**2 * length * 2 * (1 + NU) / (YOUNG * depth)
    gaps = [abs(e - exact_energy) for e in energies]
    assert np.log2(errors[0] / errors[1]) > order_u
    assert np.log2(gaps[0] / gaps[1]) > order_energy


def test_hanging_wall_is_exact_for_quadratic_elements() -> None:
    """Own weight: displacements are quadratic, so Q8 and T6 find them at the nodes."""
    width, height, weight, thickness = 0.8, 2.3, 21e3, 0.31
    for kind in ("T6", "Q8"):
        xy, connect, base = mesh(kind, 3, 5, width, height)
        force = body_force(kind, (2, 2), xy, connect, np.tile([0.0, -weight * thickness], (len(connect), 1)))
        assert force.sum(axis=0)[1] == pytest.approx(-weight * thickness * width * height, rel=1e-12)
        top = 0.5 * height
        force += thickness * edge_forces(xy, connect, base, lambda p, n: np.column_stack([0 * p[:, 0], weight * height * (n[:, 1] > 0.5)]))
        at = [int(np.hypot(*(xy - place).T).argmin()) for place in ([0, top], [0, -top])]
        u, _ = solve(kind, xy, connect, force, [(at[0], 0), (at[0], 1), (at[1], 0)], thickness)
        y = xy[:, 1] + top
        exact = np.column_stack([-NU * weight / YOUNG * xy[:, 0] * y, weight / (2 * YOUNG) * (y**2 - height**2 + NU * xy[:, 0] ** 2)])
        # the exact field has u_x = 0 along x = 0, as the two held nodes
        assert np.abs(u - exact).max() < 1e-9 * np.abs(exact).max()


STRENGTH, ENERGY = 2.1e6, 93.0


def chain(lengths, softening, band, area=0.013, floor=1e-13, tension=True):
    """Bars in series along x, the first one softening; unit force at the end."""
    x = np.concatenate([[0.0], np.cumsum(lengths)])
    xy = np.column_stack([x, np.zeros(len(x))])
    groups = [Bars(np.array([[0, 1]]), area, YOUNG, band, softening if tension else None, None if tension else softening)]
    if len(lengths) > 1:
        groups.append(Bars(np.array([[i, i + 1] for i in range(1, len(lengths))]), area, YOUNG))
    held = [(0, 0)] + [(i, 1) for i in range(len(x))]
    model = Model(xy, Freedoms.make(len(x), held), groups, Behaviour(floor=floor))
    force = np.zeros_like(xy)
    force[-1, 0] = 1.0 if tension else -1.0
    model.loads(np.zeros_like(xy), force)
    return model.run(5000, [Monitor.of(len(x) - 1, 0)], Stop(compliance=1e12))


@pytest.mark.parametrize("law", ["linear", "exponential"])
@pytest.mark.parametrize("tension", [True, False])
def test_one_bar_dissipates_its_fracture_energy(law, tension) -> None:
    """Area of the teeth passed = Gf per crack area (thesis 4.2), in tension and in crushing."""
    events = chain([0.083], Softening(STRENGTH, ENERGY, law), 0.083, tension=tension)
    assert events.reason == "mechanism"  # the last tooth leaves nothing: all that is stored then is lost
    assert events.crack[-1] + events.stored[-1] == pytest.approx(ENERGY * 0.013, rel=1e-9)
    assert events.ledger_error < 1e-12
    assert events.load.max() / 0.013 > STRENGTH


def test_two_bars_in_series_snap_back_at_the_critical_length() -> None:
    """The displacement turns back where the length exceeds 2 E Gf / ft^2."""
    critical = 2 * YOUNG * ENERGY / STRENGTH**2
    softening = Softening(STRENGTH, ENERGY, ripple=0.02, exact=False)
    for share, sign in ((0.97, 1), (1.03, -1)):
        events = chain([0.1, share * critical - 0.1], softening, 0.1)
        assert (np.sign(np.diff(events.monitors[:-1, 0])) == sign).all()


def test_spring_and_bar_share_a_load() -> None:
    xy = np.array([[0.0, 0.0], [1.7, 0.0]])
    area, stiffness = 0.0031, 4.9e6
    groups = [Bars(np.array([[0, 1]]), area, YOUNG), Springs(np.array([[1, -1]]), np.array([[0, 0]]), np.array([stiffness]))]
    with Model(xy, Freedoms.make(2, [(0, 0), (0, 1), (1, 1)]), groups) as model:
        model.loads(np.zeros((2, 2)), np.array([[0.0, 0.0], [830.0, 0.0]]))
        u = model.displacement(1.0)
    assert u[1, 0] == pytest.approx(830.0 / (YOUNG * area / 1.7 + stiffness), rel=1e-13)


def square(softening=None, behaviour=None, nu=0.0, **options):
    xy = np.array([[0.0, 0.0], [0.21, 0.0], [0.21, 0.21], [0.0, 0.21]])
    group = Plane("T3", np.array([[0, 1, 2], [0, 2, 3]]), 0.07, YOUNG, nu, 0.21, softening, **options)
    ties = [[(1, 0, 1.0), (2, 0, 1.0)]]
    model = Model(xy, Freedoms.make(4, [(0, 0), (3, 0), (0, 1)], ties), [group], behaviour)
    force = np.zeros((4, 2))
    force[1, 0] = 1.0
    return model, force


@pytest.mark.parametrize(
    "behaviour", [Behaviour(), Behaviour(cracking="isotropic"), Behaviour(cracking="rotating"), Behaviour(retention=0.2)]
)
def test_square_in_tension_dissipates_gf(behaviour) -> None:
    """Two triangles of one band: with nu = 0 both lose Gf times the crack area, whatever the cracking model."""
    from dataclasses import replace

    model, force = square(Softening(STRENGTH, ENERGY, ripple=0.3), replace(behaviour, floor=1e-12))
    with model:
        model.loads(np.zeros((4, 2)), force)
        events = model.run(500, [Monitor.of(1, 0)], Stop(compliance=1e15))
    assert events.ledger_error < 1e-9
    assert 0 < events.crack[-1] < 1.0001 * ENERGY * 0.07 * 0.21


def test_closing_a_crack_restores_the_stiffness() -> None:
    """A cracked wall pushed together: with closure the elastic stiffness is back, without it the secant stays."""
    shortening = {}
    for closure in (False, True):
        model, force = square(Softening(STRENGTH, ENERGY, ripple=0.1), Behaviour(closure=closure))
        with model:
            model.loads(np.zeros((4, 2)), force)
            elastic = model.displacement(1.0)[1, 0]
            cracked = model.run(7, [Monitor.of(1, 0)])
            assert (cracked.code <= 2).all()
            model.loads(np.zeros((4, 2)), -force)
            events = model.run(4, [Monitor.of(1, 0)])
            shortening[closure] = -model.displacement(1.0)[1, 0] / elastic
        if closure:
            assert set(events.code[:2].tolist()) == {5}
            assert np.abs(events.load[:2]).max() < 1e-6 * cracked.load[0]
    assert shortening[False] > 1.5
    assert shortening[True] == pytest.approx(1.0, rel=1e-9)


def test_a_free_node_is_named() -> None:
    xy = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    group = Plane("Q4", np.array([[0, 1, 2, 3]]), 0.1, YOUNG, NU)
    with pytest.raises(FreeNode, match=r"node \d is free to move in [xy]"):
        Model(xy, Freedoms.make(4, [(0, 0), (0, 1)]), [group])


def test_an_indefinite_matrix_is_seen() -> None:
    """A spring of negative stiffness: never solved."""
    xy = np.array([[0.0, 0.0], [1.7, 0.0]])
    groups = [Bars(np.array([[0, 1]]), 0.01, YOUNG), Springs(np.array([[1, -1]]), np.array([[0, 0]]), np.array([-0.02 * YOUNG]))]
    with pytest.raises(FreeNode):
        Model(xy, Freedoms.make(2, [(0, 0), (0, 1), (1, 1)]), groups)


def test_inverted_element_is_named() -> None:
    xy = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])
    with pytest.raises(BadElement, match="element 2"):
        Model(xy, Freedoms.make(4, [(0, 0), (0, 1), (1, 1)]), [Plane("T3", np.array([[0, 1, 2], [0, 3, 2]]), 0.1, YOUNG, NU)])


def test_memory_is_estimated_before_it_is_taken() -> None:
    xy, connect, _ = mesh("Q4", 20, 20, 1.0, 1.0)
    held = [(int(n), d) for n in np.flatnonzero(xy[:, 0] < 1e-9) for d in (0, 1)]
    with pytest.raises(MemoryError, match="use larger elements"):
        Model(xy, Freedoms.make(len(xy), held), [Plane("Q4", connect, 0.1, YOUNG, NU)], memory=20_000)


def test_nan_is_refused_with_its_place() -> None:
    xy = np.array([[0.0, 0.0], [1.0, np.nan], [1.0, 1.0], [0.0, 1.0]])
    with pytest.raises(ValueError, match="xy is not finite"):
        Model(xy, Freedoms.make(4), [])


@pytest.mark.parametrize("kind", ["Q4", "T3"])
@pytest.mark.parametrize("angle", [0.0, 20.0, 45.0, -45.0, 90.0])
def test_the_crack_band_is_the_width_across_the_crack(kind, angle) -> None:
    """An element pulled in some direction: for squares that of a row of them, for triangles their extent; the tables
    are 2 % apart."""
    xy = np.array([[0.0, 0.0], [0.2, 0.0], [0.2, 0.2], [0.0, 0.2]])
    corners = [0, 1, 2, 3] if kind == "Q4" else [0, 1, 3]
    reach = np.array([[0.2 / 2**0.5, 0.2 * 2**0.5]])
    group = Plane(kind, np.array([corners]), 0.07, YOUNG, 0.0, 0.2, Softening(STRENGTH, ENERGY, ripple=0.2), reach=reach)
    both = np.array([[i, d] for i in range(4) for d in range(2)])
    ground = np.column_stack([both[:, 0], np.full(8, -1)])
    springs = Springs(ground, np.column_stack([both[:, 1], both[:, 1]]), np.full(8, 1e3))
    pull = np.array([np.cos(np.radians(angle)), np.sin(np.radians(angle))])
    force = np.zeros((4, 2))
    force[corners] = ((xy[corners] - xy[corners].mean(axis=0)) @ pull)[:, None] * pull
    with Model(xy, Freedoms.make(4), [group, springs], Behaviour(cracking="rotating")) as model:
        model.loads(np.zeros((4, 2)), force)
        model.run(2, [Monitor.of(1, 0)])
        report = model.report(0.0)
    (cracked,) = np.flatnonzero(report["tooth_n"] > 1)
    n = np.array([report["cos"][cracked], report["sin"][cracked]])
    if kind == "Q4":  # both diagonals are 0.2 (+-1, 1): Oliver's width
        expected = 2 * 0.04 / (0.2 * (abs(n[1] - n[0]) + abs(n[1] + n[0])))
    else:
        expected = np.ptp(xy[corners] @ n)
    assert report["band"][cracked] == pytest.approx(expected, rel=0.0101)


def test_energy_of_cracks_that_turn() -> None:
    """A wall pulled askew: the ledger closes although the axes of its cracks turn."""
    xy, connect, _ = mesh("Q4", 6, 4, 1.2, 0.8, 0.2)
    group = Plane("Q4", connect, 0.1, YOUNG, NU, 0.2, Softening(STRENGTH, ENERGY, ripple=0.1))
    held = [(i, d) for i in np.flatnonzero(xy[:, 0] < 1e-9) for d in (0, 1)]
    force = np.zeros_like(xy)
    far = xy[:, 0] > 1.2 - 1e-9
    force[far] = [1.0, 0.6]
    with Model(xy, Freedoms.make(len(xy), held), [group], Behaviour(cracking="rotating")) as model:
        model.loads(np.zeros_like(force), force)
        angles = []
        for _ in range(3):
            events = model.run(25, [Monitor.of(len(xy) - 1, 0)])
            report = model.report(0.0)
            angles.append(np.where(report["tooth_n"] > 1, np.arctan2(report["sin"], report["cos"]), np.nan))
        assert events.ledger_error < 1e-9
        assert model.residual() < 1e-9
    turned = np.abs(np.sin(angles[-1] - angles[0]))
    assert np.nanmax(turned) > 0.05


def test_a_crack_keeps_the_asked_part_of_the_shear_modulus() -> None:
    """A square that only shears, cracked upright at all its points: what is left of its stiffness is the retention."""
    xy, side, thickness, kept = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]), 1.0, 0.07, 0.13
    group = Plane("Q4", np.array([[0, 1, 2, 3]]), thickness, YOUNG, NU, 0.21, Softening(STRENGTH, ENERGY, ripple=0.3))
    held = [(0, 0), (1, 0), *((n, 1) for n in range(4))]
    force = np.zeros((4, 2))
    force[2, 0] = 1.0
    with Model(xy, Freedoms.make(4, held, [[(2, 0, 1.0), (3, 0, 1.0)]]), [group], Behaviour(retention=kept)) as model:
        shear = thickness * side * 0.5 * YOUNG / (1.0 + NU)
        model.loads(np.zeros((4, 2)), force)
        assert model.displacement(1.0)[2, 0] * shear == pytest.approx(1.0, rel=1e-12)
        damage = model.damage()
        damage[0], damage[1], damage[2] = 1.0, 0.0, 1.0
        damage[3] += 2.0
        model.set_damage(damage)
        model.loads(np.zeros((4, 2)), force)
        assert model.displacement(1.0)[2, 0] * shear == pytest.approx(1.0 / kept, rel=1e-12)


@pytest.mark.parametrize(("bears", "sense"), [("tension", 1.0), ("compression", -1.0)])
def test_a_bar_of_one_sense_lets_go_where_its_force_turns(bears: str, sense: float) -> None:
    """Beside a spring, stressed by a constant load that the other takes back: from there on the spring is alone, and as
    the load turns again the bar bears anew."""
    xy, area, stiffness, first = np.array([[0.0, 0.0], [1.7, 0.0]]), 0.0031, 4.9e6, 620.0
    groups = [Bars(np.array([[0, 1]]), area, YOUNG, bears=bears), Springs(np.array([[1, -1]]), np.array([[0, 0]]), np.array([stiffness]))]
    constant, reference = np.zeros((2, 2)), np.zeros((2, 2))
    constant[1, 0], reference[1, 0] = sense * first, -sense
    with Model(xy, Freedoms.make(2, [(0, 0), (0, 1), (1, 1)]), groups, Behaviour(closure=True)) as model:
        model.loads(constant, reference)
        events = model.run(1, [Monitor.of(1, 0)])
        assert events.load == pytest.approx([first], rel=1e-9)
        model.run(1, [Monitor.of(1, 0)], Stop(load=2.0 * first))
        alone = model.displacement(2.0 * first)[1, 0]
        assert alone == pytest.approx(-sense * first / stiffness, rel=1e-3)
        model.loads(-constant, -reference)
        events = model.run(1, [Monitor.of(1, 0)])
        assert events.load == pytest.approx([first], rel=1e-6)
        model.run(1, [Monitor.of(1, 0)], Stop(load=2.0 * first))
        both = model.displacement(2.0 * first)[1, 0]
        assert both == pytest.approx(sense * first / (YOUNG * area / 1.7 + stiffness), rel=1e-9)


def test_stored_damage_that_cannot_be_is_refused_for_any_group() -> None:
    """Teeth count from one, in the first group as in the last; what is refused changes nothing."""
    xy = np.array([[0.0, 0.0], [0.2, 0.0], [0.2, 0.2], [0.0, 0.2]])
    law = Softening(STRENGTH, ENERGY, ripple=0.3)
    groups = [Plane("T3", np.array([at]), 0.07, YOUNG, NU, 0.2, law) for at in ([0, 1, 2], [0, 2, 3])]
    with Model(xy, Freedoms.make(4, [(0, 0), (3, 0), (0, 1)]), groups) as model:
        sound = model.damage()
        assert sound.shape[1] == 2 and (sound[3] == 1.0).all()
        for point in (0, 1):
            for row in (3, 4, 5, 6):
                damage = sound.copy()
                damage[row, point] = 0.0
                with pytest.raises(CoreError, match="stored damage"):
                    model.set_damage(damage)
                assert (model.damage() == sound).all()
