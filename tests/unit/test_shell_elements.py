"""Elastic shells against exact solutions and the usual obstacle course (MacNeal and Harder 1985; Belytschko 1985)."""

import numpy as np
import pytest

from extrados.core import sla as core
from extrados.core.shell import node_frames
from extrados.views.shell.mesh import nodal_areas, spread


def surface(n, place, m=None):
    """Nodes of an n x m grid of quadrilaterals on `place(u, v)`, the quadrilaterals, and u, v of the nodes."""
    m = n if m is None else m
    u, v = (a.ravel() for a in np.meshgrid(np.linspace(0, 1, n + 1), np.linspace(0, 1, m + 1), indexing="ij"))
    i, j = (a.ravel() for a in np.meshgrid(np.arange(n), np.arange(m), indexing="ij"))
    at = i * (m + 1) + j
    xyz = np.column_stack(np.broadcast_arrays(*place(u, v))).astype(float)
    return xyz, np.column_stack([at, at + m + 1, at + m + 2, at + 1]), u, v


def halves(quads):
    """Two triangles of each quadrilateral."""
    return np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])


def displacements(xyz, connect, thickness, young, nu, held, load):
    """Of an elastic shell with rotations about x, y, z."""
    nodes = len(xyz)
    frames, flat = np.tile(np.eye(3), (nodes, 1, 1)), np.zeros(nodes, dtype=bool)
    shells = core.Shells(
        f"{'T' if connect.shape[1] == 3 else 'Q'}{connect.shape[1]}",
        connect,
        thickness,
        young,
        nu,
        frames=frames,
        flat=flat,
        layers=2,
        through="gauss",
    )
    with core.Model(xyz, core.Freedoms.make(nodes, sorted(set(held)), of_node=6), [shells]) as model:
        model.loads(np.zeros((nodes, 6)), load)
        return model.displacement(1.0)


def at(nodes, *directions):
    return [(int(k), d) for k in np.flatnonzero(nodes) for d in directions]


def node_at(u, v, a, b):
    return int(np.flatnonzero((u == a) & (v == b))[0])


def scordelis_lo(n, shape):
    """Deflection of the roof's free edge over that of MacNeal and Harder."""
    angle = np.radians(40.0)
    xyz, quads, u, v = surface(n, lambda a, b: (25.0 * np.sin(angle * a), 25.0 * b, 25.0 * np.cos(angle * a)))
    connect = quads if shape == "Q4" else halves(quads)
    held = at(u == 0, 0, 4, 5) + at(v == 0, 0, 2) + at(v == 1, 1, 3, 5)
    load = spread(len(xyz), connect, nodal_areas(xyz, connect), np.tile([0.0, 0.0, -90.0], (len(connect), 1)))
    moved = displacements(xyz, connect, 0.25, 4.32e8, 0.0, held, load)
    return -moved[node_at(u, v, 1, 1), 2] / 0.3024


def pinched_cylinder(n, shape):
    """Deflection under the load of a cylinder with end diaphragms over that of Belytschko and others."""
    xyz, quads, u, v = surface(n, lambda a, b: (300 * np.sin(np.pi / 2 * a), 300 * b, 300 * np.cos(np.pi / 2 * a)))
    connect = quads if shape == "Q4" else halves(quads)
    held = at(u == 0, 0, 4, 5) + at(u == 1, 2, 3, 4) + at(v == 0, 0, 2) + at(v == 1, 1, 3, 5)
    load, node = np.zeros((len(xyz), 6)), node_at(u, v, 0, 1)
    load[node, 2] = -0.25
    return -displacements(xyz, connect, 3.0, 3e6, 0.3, held, load)[node, 2] / 1.8248e-5


def hemisphere(n, shape):
    """Displacement under the loads of a hemisphere with a hole of 18 degrees over that of MacNeal and Harder."""

    def place(a, b):
        around, up = np.pi / 2 * a, np.radians(72.0) * b
        return 10 * np.cos(up) * np.cos(around), 10 * np.cos(up) * np.sin(around), 10 * np.sin(up)

    xyz, quads, u, v = surface(n, place)
    connect = quads if shape == "Q4" else halves(quads)
    one, two = node_at(u, v, 0, 0), node_at(u, v, 1, 0)
    held = [*at(u == 0, 1, 3, 5), *at(u == 1, 0, 4, 5), (one, 2)]
    load = np.zeros((len(xyz), 6))
    load[one, 0], load[two, 1] = 1.0, -1.0
    return displacements(xyz, connect, 0.04, 6.825e7, 0.3, held, load)[one, 0] / 0.0940


@pytest.mark.parametrize("shape", ["Q4", "T3"])
@pytest.mark.parametrize(
    "problem, most",
    [(scordelis_lo, {"Q4": 0.03, "T3": 0.13}), (pinched_cylinder, {"Q4": 0.06, "T3": 0.14}), (hemisphere, {"Q4": 0.035, "T3": 0.05})],
)
def test_obstacle_course(problem, most, shape):
    """Eight elements along a side are as near as these elements are in print, sixteen come nearer."""
    coarse, fine = problem(8, shape), problem(16, shape)
    assert abs(coarse - 1.0) < most[shape]
    assert abs(fine - 1.0) < 0.5 * abs(coarse - 1.0) or abs(fine - 1.0) < 0.02


def plate(n, shape, thickness, skew=0.2):
    """Relative error of the middle of a simply supported square plate under q sin sin, against Mindlin's exact one."""
    side, young, nu = 1.0, 1e7, 0.3

    def place(a, b):  # lines of the grid that are not straight
        return a + skew * a * (1 - a) * (b - 0.5), b + skew * b * (1 - b) * (a - 0.5), 0.0 * a

    xyz, quads, u, v = surface(n, place)
    connect = quads if shape == "Q4" else halves(quads)
    edge = (u == 0) | (u == 1) | (v == 0) | (v == 1)
    held = at(np.ones(len(xyz), dtype=bool), 0, 1, 5) + at(edge, 2) + at((u == 0) | (u == 1), 3) + at((v == 0) | (v == 1), 4)
    share = nodal_areas(xyz, connect)
    centre = xyz[connect].mean(axis=1)
    q = np.sin(np.pi * centre[:, 0]) * np.sin(np.pi * centre[:, 1])
    load = spread(len(xyz), connect, share, np.column_stack([0 * q, 0 * q, q]))
    rigid = young * thickness**3 / 12 / (1 - nu**2)
    shear = 5 / 6 * young * thickness / 2 / (1 + nu)
    exact = side**4 / (4 * np.pi**4 * rigid) + side**2 / (2 * np.pi**2 * shear)
    moved = displacements(xyz, connect, thickness, young, nu, held, load)
    return abs(moved[node_at(u, v, 0.5, 0.5), 2] / exact - 1.0)


@pytest.mark.parametrize("shape", ["Q4", "T3"])
@pytest.mark.parametrize("thickness", [0.2, 0.01, 1e-4])
def test_plates_converge_by_the_second_order(shape, thickness):
    """Thick and thin alike: no shear locking."""
    errors = [plate(n, shape, thickness) for n in (8, 16, 32)]
    orders = np.log2(np.array(errors[:-1]) / errors[1:])
    assert orders[-1] == pytest.approx(2.0, abs=0.25)
    assert errors[-1] < 0.01


def test_frames_of_a_corner():
    """Where walls meet the axes are x, y, z and rotations about all of them count; elsewhere the third is the normal."""
    xyz = np.array([[0, 0, 0], [1, 0, 0], [1, 0, 1], [0, 0, 1], [1, 1, 0], [1, 1, 1]], dtype=float)
    frames, flat = node_frames(xyz, [np.array([[0, 1, 2, 3], [1, 4, 5, 2]])])
    assert flat.tolist() == [True, False, False, True, True, True]
    assert np.allclose(frames[1], np.eye(3)) and np.allclose(frames[0, :, 2], [0, -1, 0])
    assert np.allclose(frames[4, :, 2], [1, 0, 0]) and np.allclose(frames[4, :, 1], [0, 0, 1])
