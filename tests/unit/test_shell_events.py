"""Shells that crack: the plane limit event by event, and one-way bending against the layered section."""

import numpy as np
import pytest

from extrados.core import sla as core
from extrados.core.shell import node_frames

LAW = core.Softening(0.2e6, 50.0, "linear", 0.2)
YOUNG, WIDTH = 6.9e9, 0.2


def wall(n=12, side=3.0):
    """A square wall with an opening: nodes (x, y), quadrilaterals, and the nodal forces A (weight, load on top) and B."""
    x, y = (a.ravel() for a in np.meshgrid(*2 * [np.linspace(0, side, n + 1)], indexing="ij"))
    i, j = (a.ravel() for a in np.meshgrid(*2 * [np.arange(n)], indexing="ij"))
    xy, first = np.column_stack([x, y]), i * (n + 1) + j
    quads = np.column_stack([first, first + n + 1, first + n + 2, first + 1])
    centre = xy[quads].mean(axis=1)
    quads = quads[(np.abs(centre - side / 2) > side / 6).any(axis=1)]
    used, number = np.unique(quads, return_inverse=True)
    xy, quads = xy[used], number.reshape(quads.shape)
    top = xy[:, 1] > side - 1e-9
    constant = core.body_force("Q4", (2, 2), xy, quads, np.tile([0.0, -WIDTH * 1920 * 9.81], (len(quads), 1)))
    constant[top, 1] -= 0.1e6 * WIDTH * side / top.sum()
    reference = np.zeros_like(constant)
    reference[top, 0] = 1e3 / top.sum()
    return xy, quads, constant, reference


def in_space(xy, vectors):
    """Plane forces in the x, z plane."""
    out = np.zeros((len(xy), 6))
    out[:, [0, 2]] = vectors
    return out


@pytest.mark.parametrize("cracking", ["orthotropic", "rotating", "isotropic"])
def test_a_shell_loaded_in_its_plane_is_the_plane_model(cracking):
    """Event by event the same point, tooth and load."""
    xy, quads, constant, reference = wall()
    bottom = np.flatnonzero(xy[:, 1] < 1e-9).tolist()
    band, events = np.sqrt(2.0) * 0.25, 500
    watch = [core.Monitor.of(len(xy) - 1, 0)]
    behaviour = core.Behaviour(cracking)
    plane = core.Plane("Q4", quads, WIDTH, YOUNG, 0.25, band, LAW)
    held = [(n, d) for n in bottom for d in (0, 1)]
    with core.Model(xy, core.Freedoms.make(len(xy), held), [plane], behaviour) as model:
        model.loads(constant, reference)
        expected, displaced = model.run(events, watch), model.displacement(1.0)
    xyz = np.column_stack([xy[:, 0], 0.0 * xy[:, 0], xy[:, 1]])
    frames, flat = node_frames(xyz, [quads])
    assert flat.all()
    held = [(n, d) for n in bottom for d in (0, 2)] + [(n, d) for n in range(len(xyz)) for d in (1, 3, 4, 5)]
    shells = core.Shells("Q4", quads, WIDTH, YOUNG, 0.25, band, LAW, frames=frames, flat=flat, layers=1, through="gauss")
    with core.Model(xyz, core.Freedoms.make(len(xyz), held, of_node=6), [shells], behaviour) as model:
        model.loads(in_space(xy, constant), in_space(xy, reference))
        found, moved = model.run(events, watch), model.displacement(1.0)
        assert model.residual() < 1e-8
    assert len(found) == len(expected) == events
    assert (found.point == expected.point).all() and (found.code == expected.code).all()
    assert (found.equilibrium == expected.equilibrium).all()
    assert found.load == pytest.approx(expected.load, rel=1e-8)
    assert found.monitors == pytest.approx(expected.monitors, rel=1e-7)
    assert moved[:, [0, 2]] == pytest.approx(displaced, rel=1e-7, abs=1e-8 * np.abs(displaced).max())
    assert found.ledger_error < 1e-9


def couplet(n=4, side=0.4):
    """Two squares upon each other, each of n x n quadrilaterals, and the pairs of nodes of the joint between them."""
    x, y = (a.ravel() for a in np.meshgrid(*2 * [np.linspace(0, side, n + 1)], indexing="ij"))
    i, j = (a.ravel() for a in np.meshgrid(*2 * [np.arange(n)], indexing="ij"))
    lower, first = np.column_stack([x, y]), i * (n + 1) + j
    quads = np.column_stack([first, first + n + 1, first + n + 2, first + 1])
    count = len(lower)
    xy, quads = np.concatenate([lower, lower + np.array([0.0, side])]), np.concatenate([quads, quads + count])
    below = np.arange(n + 1) * (n + 1) + n
    above = count + np.arange(n + 1) * (n + 1)
    return xy, quads, np.column_stack([below[:-1], below[1:], above[1:], above[:-1]])


MORTAR = {
    "normal_stiffness": 8e10,
    "shear_stiffness": 3.6e10,
    "friction": 0.7,
    "tension": core.Softening(0.1e6, 10.0, "exponential", 0.2),
    "cohesion": core.Softening(0.15e6, 60.0, "exponential", 0.2),
    "compression": core.Softening(2e6, 3000.0, "linear", 0.2),
}


def test_a_joint_of_shells_loaded_in_its_plane_is_that_of_the_plane_model():
    """A joint that slides and opens between stones that crack: event by event the same."""
    xy, quads, stretches = couplet()
    n, side, events = len(stretches), 0.4, 400
    area = np.column_stack([np.full(n, 0.5), np.full(n, 0.5)]) * WIDTH * side / n
    top, bottom = np.flatnonzero(xy[:, 1] > 2 * side - 1e-9), np.flatnonzero(xy[:, 1] < 1e-9)
    constant, reference = np.zeros_like(xy), np.zeros_like(xy)
    pushed = np.unique(stretches[:, 2:])  # near the joint, which slides before it turns over
    constant[top, 1], reference[pushed, 0] = -0.3e6 * WIDTH * side / len(top), 1e3 / len(pushed)
    watch, behaviour = [core.Monitor.of(len(xy) - 1, 0)], core.Behaviour("rotating")
    held = [(k, d) for k in bottom.tolist() for d in (0, 1)]
    firm = core.Softening(0.4e6, 60.0, "linear", 0.2)
    stone = core.Plane("Q4", quads, WIDTH, YOUNG, 0.2, 0.1, firm)
    joint = core.Joints(stretches, np.tile([0.0, 1.0], (n, 1)), area, **MORTAR)
    with core.Model(xy, core.Freedoms.make(len(xy), held), [stone, joint], behaviour) as model:
        model.loads(constant, reference)
        expected, displaced = model.run(events, watch), model.displacement(1.0)
    assert {"cohesion", "tension n", "opening n"} <= {core.EVENTS[code] for code in expected.code}
    xyz = np.column_stack([xy[:, 0], 0.0 * xy[:, 0], xy[:, 1]])
    frames, flat = node_frames(xyz, [quads])
    held = [(k, d) for k in bottom.tolist() for d in (0, 2)] + [(k, d) for k in range(len(xyz)) for d in (1, 3, 4, 5)]
    shells = core.Shells("Q4", quads, WIDTH, YOUNG, 0.2, 0.1, firm, frames=frames, flat=flat, layers=1, through="gauss")
    axes = [np.tile(axis, (n, 1)).astype(float) for axis in ([0, 0, 1], [1, 0, 0], [0, -1, 0])]
    row = core.ShellJoints.rows(*axes, np.zeros(n), frames[stretches])
    between = core.ShellJoints(stretches, np.tile([0.0, 1.0], (n, 1)), area, **MORTAR, row=row)
    with core.Model(xyz, core.Freedoms.make(len(xyz), held, of_node=6), [shells, between], behaviour) as model:
        model.loads(in_space(xy, constant), in_space(xy, reference))
        found, moved = model.run(events, watch), model.displacement(1.0)
        assert model.residual() < 1e-8
    assert len(found) == len(expected) > 100
    assert (found.point == expected.point).all() and (found.code == expected.code).all()
    fine = expected.equilibrium.astype(bool)
    assert fine.sum() > 100
    assert found.load[fine] == pytest.approx(expected.load[fine], rel=1e-8)
    assert moved[:, [0, 2]] == pytest.approx(displaced, rel=1e-7, abs=1e-8 * np.abs(displaced).max())


def strip(layers, through, push, nu=0.0):
    """A clamped piece of wall, one element, whose other end moves so that its curvature is the same everywhere: two
    unknowns, the strain of the middle and the curvature. Model and loads: `push` [N] along, a unit moment."""
    length, width, thickness = 0.25, 0.4, 0.3
    xyz = np.array([[0, 0, 0], [width, 0, 0], [width, 0, length], [0, 0, length]], dtype=float)
    frames, flat = node_frames(xyz, [np.array([[0, 1, 2, 3]])])
    shells = core.Shells(
        "Q4", np.array([[0, 1, 2, 3]]), thickness, YOUNG, nu, length, LAW, frames=frames, flat=flat, layers=layers, through=through
    )
    held = [(n, d) for n in (0, 1) for d in range(6)] + [(n, d) for n in (2, 3) for d in (0, 4, 5)]
    # The normal is -y: w = length / 2 times the rotation
    ties = [[(2, 2, 1.0), (3, 2, 1.0)], [(n, d, f) for n in (2, 3) for d, f in ((1, -length / 2), (3, 1.0))]]
    model = core.Model(xyz, core.Freedoms.make(4, held, ties, of_node=6), [shells])
    constant, reference = np.zeros((4, 6)), np.zeros((4, 6))
    constant[2:, 2] = -push / 2
    reference[2:, 3] = 0.5
    model.loads(constant, reference)
    return model, core.Monitor(np.array([2]), np.array([3]), np.array([1.0])), (length, width, thickness)


def layered_section(layers, through, push, size, events):
    """The same by hand: fibres at four places in the plane, plane sections, the events of sequentially linear analysis."""
    length, width, thickness = size
    height, share = points_through(layers, through)
    z = np.tile(thickness * height, 4)
    area = np.tile(share * thickness * width * length / 4, 4)  # volumes
    modulus, strength = core.teeth(LAW, YOUNG, length)
    modulus, strength = np.append(modulus, 1e-6 * YOUNG), np.append(strength, np.inf)
    tooth = np.zeros(len(z), dtype=int)
    loads, points, curvature = [], [], []
    for _ in range(events):
        stiff = area * modulus[tooth]
        k = np.array([[stiff.sum(), (stiff * z).sum()], [(stiff * z).sum(), (stiff * z**2).sum()]]) / length**2
        a = np.linalg.solve(k, [-push, 0.0]) / length  # strain of the middle and curvature under the push
        b = np.linalg.solve(k, [0.0, -1.0]) / length  # and under the moment, which turns the normal the other way
        sa, sb = modulus[tooth] * (a[0] + z * a[1]), modulus[tooth] * (b[0] + z * b[1])
        limit = (strength[tooth] - sa) / sb
        upper, lower = np.where(sb > 0, limit, np.inf), np.where(sb < 0, limit, -np.inf)
        least, most = upper.min(), lower.max()
        if not np.isfinite(least):
            break  # the tensile side has cracked through
        k = int(np.flatnonzero(upper <= least * (1 + 1e-9))[0])
        if least < most:
            k = int(np.flatnonzero(lower >= most - 1e-9 * abs(most))[0])
        loads.append(limit[k])
        points.append(k)
        curvature.append(a[1] + limit[k] * b[1])
        tooth[k] += 1
    return np.array(loads), np.array(points), np.array(curvature)


def points_through(layers, through):
    """Heights and shares of the layers in thicknesses, from numpy's Legendre polynomials."""
    legendre = np.polynomial.legendre
    if through == "gauss":
        x, w = legendre.leggauss(layers)
        return x / 2, w / 2
    p = legendre.Legendre.basis(layers - 1)
    x = np.concatenate([[-1.0], np.sort(p.deriv().roots().real), [1.0]])
    return x / 2, 1.0 / (layers * (layers - 1) * p(x) ** 2)


@pytest.mark.parametrize("layers, through", [(2, "gauss"), (5, "gauss"), (5, "lobatto"), (9, "lobatto")])
@pytest.mark.parametrize("push", [0.0, 20e3])
def test_one_way_bending_with_cracks_is_the_layered_section(layers, through, push):
    """Plane sections of fibres that lose teeth: the same fibre and the same moment at every event."""
    model, watch, size = strip(layers, through, push)
    with model:
        found = model.run(40 * layers, [watch])
    loads, points, curvature = layered_section(layers, through, push, size, len(found))
    n = len(loads)
    assert len(found) >= n >= 16 * layers
    assert (found.point[:n] == points).all()
    assert found.load[:n] == pytest.approx(loads, rel=1e-8, abs=1e-8 * loads.max())
    assert found.monitors[:n, 0] == pytest.approx(-size[0] * curvature, rel=1e-7)
    assert found.ledger_error < 1e-9


def test_many_layers_are_the_continuous_section():
    """The greatest moment goes to that of plane sections with linear softening, without teeth or layers."""
    push, law = 20e3, core.Softening(0.2e6, 50.0, "linear", 0.02)
    global LAW  # finer teeth: half of their height is the error
    kept, LAW = LAW, law
    try:
        model, watch, (length, width, thickness) = strip(15, "lobatto", push)
        with model:
            found = model.run(15 * 400, [watch])
    finally:
        LAW = kept
    z = (np.arange(4000) + 0.5) / 4000 * thickness - thickness / 2
    first, last = law.strength / YOUNG, 2 * law.energy / (law.strength * length)

    def stress(strain):
        soft = law.strength * np.clip((last - strain) / (last - first), 0.0, 1.0)
        return np.where(strain < first, YOUNG * strain, soft)

    def moment(curvature):
        low, high = -5e-3, 5e-3
        for _ in range(80):
            middle = 0.5 * (low + high)
            if stress(middle + z * curvature).mean() * width * thickness > -push:
                high = middle
            else:
                low = middle
        return (stress(low + z * curvature) * z).mean() * width * thickness

    exact = max(moment(k) for k in np.geomspace(1e-5, 2e-2, 300))
    assert found.load[found.equilibrium].max() == pytest.approx(exact, rel=0.03)


def test_transverse_shear_softens_with_its_crack():
    """The factor that is only updated and the one made anew at each event agree: the vectors are those of the matrix."""
    xyz = np.array([[0, 0, 0], [1, 0, 0], [1, 0, 1], [0, 0, 1], [2, 0.3, 0], [2, 0.3, 1]], dtype=float)
    quads = np.array([[0, 1, 2, 3], [1, 4, 5, 2]])
    frames, flat = node_frames(xyz, [quads])
    held = [(n, d) for n in (0, 3) for d in range(6)] + [(n, 5) for n in np.flatnonzero(flat).tolist() if n not in (0, 3)]
    load = np.zeros((6, 6))
    load[[4, 5], 0], load[[4, 5], 1], load[5, 2] = 400.0, 150.0, 90.0
    runs = []
    for algorithm in ("update", "refactor"):
        for cracking in ("orthotropic", "rotating", "isotropic"):
            shells = core.Shells("Q4", quads, WIDTH, YOUNG, 0.25, 0.5, LAW, frames=frames, flat=flat, layers=3, through="lobatto")
            freedoms = core.Freedoms.make(6, held, of_node=6)
            with core.Model(xyz, freedoms, [shells], core.Behaviour(cracking), algorithm=algorithm) as model:
                model.loads(np.zeros((6, 6)), load)
                runs.append(model.run(60, [core.Monitor.of(5, 1)]))
                assert model.residual() < 1e-8
    for updated, anew in zip(runs[:3], runs[3:], strict=True):
        assert (updated.point == anew.point).all()
        assert updated.load == pytest.approx(anew.load, rel=1e-8)
        assert updated.compliance[-1] > 1.5 * updated.compliance[0]


@pytest.mark.parametrize("cracking, retention", [("orthotropic", None), ("orthotropic", 0.07), ("isotropic", None)])
def test_transverse_shear_moduli_are_those_of_the_rule(cracking, retention):
    """A thick plate that only shears, cracked aslant: across the crack fixed cracks soften the shear by Eq. 4.15, or to a
    constant part of the modulus, and not along it; isotropic damage softens both alike."""
    size, thickness, nu = 1.0, 40.0, 0.2
    xyz = size * np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], dtype=float)
    quads = np.array([[0, 1, 2, 3]])
    frames, flat = node_frames(xyz, [quads])
    shells = core.Shells("Q4", quads, thickness, YOUNG, nu, 0.5, LAW, frames=frames, flat=flat, layers=3, through="lobatto")
    whole, c, s = 0.5 * YOUNG / (1.0 + nu), np.cos(0.5), np.sin(0.5)
    for way, moved in (("x", (1, 2)), ("y", (2, 3))):
        held = [(n, d) for n in range(4) for d in range(6) if not (d == 2 and n in moved)]
        load = np.zeros((4, 6))
        load[list(moved), 2] = 0.5
        freedoms = core.Freedoms.make(4, held, [[(n, 2, 1.0) for n in moved]], of_node=6)
        with core.Model(xyz, freedoms, [shells], core.Behaviour(cracking, retention)) as model:
            model.loads(np.zeros((4, 6)), load)
            sound = 1.0 / model.displacement(1.0)[moved[0], 2]
            damage = model.damage()
            damage[0], damage[1], damage[2] = c, s, 1.0
            damage[3] += 3.0
            model.set_damage(damage)
            model.loads(np.zeros((4, 6)), load)
            cracked = 1.0 / model.displacement(1.0)[moved[0], 2]
            left = float(model.report(0.0)["ratio_n"][0])
        assert sound == pytest.approx(5.0 / 6.0 * whole * thickness, rel=5e-3)
        assert 0.05 < left < 0.95
        modulus = left * YOUNG
        across = retention or 0.5 * modulus / (1.0 + nu * modulus / YOUNG) / whole
        expected = left if cracking == "isotropic" else c**2 * across + s**2 if way == "x" else s**2 * across + c**2
        assert cracked / sound == pytest.approx(expected, rel=5e-3)
