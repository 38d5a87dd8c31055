"""Curved shells under their weight: a dome's membrane stresses and radial cracks, the hinge lines of a barrel vault."""

import numpy as np
import pytest

from extrados.core import sla as core
from extrados.core.shell import node_frames, shell_axes
from extrados.schema.constants import GRAVITY
from extrados.views.shell.mesh import nodal_areas, spread

WEIGHT, RADIUS, THICKNESS = 20e3, 5.0, 0.2
LAW = core.Softening(5e3, 5.0, "linear", 0.2)


def dome(around=12, up=24, oculus=4.0):
    """A quarter of a hemisphere on rollers, symmetric: model's parts, nodal weight, elevation of the elements [deg]."""
    a, b = (x.ravel() for x in np.meshgrid(np.linspace(0, 90, around + 1), np.linspace(0, 90 - oculus, up + 1), indexing="ij"))
    t, e = np.radians(a), np.radians(b)
    xyz = RADIUS * np.column_stack([np.cos(e) * np.cos(t), np.cos(e) * np.sin(t), np.sin(e)])
    i, j = (x.ravel() for x in np.meshgrid(np.arange(around), np.arange(up), indexing="ij"))
    at = i * (up + 1) + j
    quads = np.column_stack([at, at + up + 1, at + up + 2, at + 1])
    held = {(int(n), 2) for n in np.flatnonzero(b == 0)}
    held |= {(int(n), d) for n in np.flatnonzero(a == 0) for d in (1, 3, 5)}
    held |= {(int(n), d) for n in np.flatnonzero(a == 90) for d in (0, 4, 5)}
    load = spread(len(xyz), quads, nodal_areas(xyz, quads), np.tile([0, 0, -WEIGHT * THICKNESS], (len(quads), 1)))
    return xyz, quads, held, load, b[quads].mean(axis=1)


def model_of(xyz, quads, held, law, band):
    nodes = len(xyz)
    shells = core.Shells(
        "Q4",
        quads,
        THICKNESS,
        5e9,
        0.0,
        band,
        law,
        frames=np.tile(np.eye(3), (nodes, 1, 1)),
        flat=np.zeros(nodes, dtype=bool),
        layers=3,
        through="lobatto",
    )
    return core.Model(xyz, core.Freedoms.make(nodes, sorted(held), of_node=6), [shells], core.Behaviour("orthotropic"))


def test_a_dome_under_its_weight_has_the_stresses_of_the_membrane():
    """On rollers a hemisphere is a membrane: hoop and meridional stresses by Heyman's formulas."""
    xyz, quads, held, load, elevation = dome()
    with model_of(xyz, quads, held, None, 0.0) as model:
        model.loads(np.zeros_like(load), load)
        report = model.report(1.0)
    share = np.array([1, 4, 1]) / 6.0
    hoop, meridian = ((report[f"stress_{k}"].reshape(-1, 4, 3) @ share).mean(axis=1) for k in "ns")
    polar = np.radians(90.0 - elevation)
    away = (elevation > 6) & (elevation < 70)
    lift = (np.cos(np.radians(4.0)) - np.cos(polar)) / np.sin(polar) ** 2  # 1 / (1 + cos) but for the oculus
    assert hoop[away] == pytest.approx(-WEIGHT * RADIUS * (np.cos(polar) - lift)[away], abs=0.02 * WEIGHT * RADIUS)
    assert meridian[away] == pytest.approx((-WEIGHT * RADIUS * lift)[away], rel=0.03)


def test_a_dome_cracks_radially_from_its_base():
    """The hoops below 52 degrees from the crown are in tension: there meridional cracks open, from the base upward."""
    xyz, quads, held, load, elevation = dome()
    with model_of(xyz, quads, held, LAW, 0.5) as model:
        model.loads(np.zeros_like(load), load)
        events = model.run(600, [core.Monitor.of(int(xyz[:, 2].argmax()), 2)])
        report = model.report(float(events.load[-1]))
    height = elevation[events.point // 12]
    assert height[0] < 4.0  # of the lowest ring of elements
    cracked = report["tooth_n"] > 1
    # The element's x axis is the hoop: the normal of a meridional crack lies along it
    normal = np.degrees(np.arccos(np.abs(report["cos"][cracked])))
    assert np.quantile(normal, 0.95) < 10.0
    assert np.repeat(elevation, 12)[cracked].max() < 38.2


def barrel(n=36):
    """A strip of a semicircular barrel vault on clamped springings, one element wide."""
    angle = np.radians(np.linspace(0.0, 180.0, n + 1))
    line = RADIUS * np.column_stack([-np.cos(angle), np.sin(angle)])
    xyz = np.concatenate([np.column_stack([line[:, 0], np.full(n + 1, y), line[:, 1]]) for y in (0.0, 0.4)])
    k = np.arange(n)
    return xyz, np.column_stack([k, k + 1, k + n + 2, k + n + 1]), np.degrees(angle)


def test_a_barrel_vault_on_spreading_springings_opens_in_three_hinge_lines():
    """Weight, then one springing goes outward: cracks through the thickness from the intrados at the crown, and from the
    extrados at the haunches, as an arch opens; between them it stays whole."""
    xyz, quads, angle = barrel()
    thick = 1.0
    n = len(angle)
    held = [(k, d) for k in (0, n) for d in range(6)] + [(k, d) for k in (n - 1, 2 * n - 1) for d in range(1, 6)]
    held += [(k, d) for k in range(2 * n) if k % n not in (0, n - 1) for d in (1, 3, 5)]
    freedoms = core.Freedoms.make(2 * n, sorted(set(held)), [[(n - 1, 0, 1.0), (2 * n - 1, 0, 1.0)]], of_node=6)
    count, number = int(freedoms.equation.max()) + 1, freedoms.equation
    freedoms = core.Freedoms(np.where(number < 0, -1, (number - 1) % count), freedoms.factor, 1)
    load = spread(2 * n, quads, nodal_areas(xyz, quads), np.tile([0, 0, -WEIGHT * thick], (len(quads), 1)))
    _frames, _ = node_frames(xyz, [quads])
    shells = core.Shells(
        "Q4",
        quads,
        thick,
        5e9,
        0.0,
        0.4,
        core.Softening(20e3, 20.0, "linear", 0.2),
        frames=np.tile(np.eye(3), (2 * n, 1, 1)),
        flat=np.zeros(2 * n, dtype=bool),
        layers=7,
        through="lobatto",
    )
    with core.Model(xyz, freedoms, [shells], core.Behaviour("orthotropic")) as model:
        watch = [core.Monitor.of(n // 2, 2)]
        model.loads(np.zeros_like(load), load)
        weight = model.run(1500, watch, core.Stop(load=1.0))
        assert weight.reason == "target load"
        model.supports([0.0], [1.0])
        model.loads(load, np.zeros_like(load), carried=True)
        events = model.run(2500, watch, core.Stop(load=2e-3))
        assert events.load[-1] == pytest.approx(2e-3)
        report = model.report(float(events.load[-1]))
    assert events.monitors[-1, 0] < weight.monitors[-1, 0] < 0.0  # the crown comes down as the springings part
    cracked = (report["tooth_n"] > 3).reshape(n - 1, 4, 7).any(axis=1)
    middle = 0.5 * (angle[1:] + angle[:-1])
    outside = shell_axes(xyz, quads)[:, 2] @ np.array([0.0, 0.0, 1.0])
    top = 6 if outside[(n - 1) // 2] > 0 else 0  # the layer on the extrados
    free = (middle > 10.0) & (middle < 170.0)  # beside the clamps the shell bends otherwise
    intrados, extrados = middle[free & cracked[:, 6 - top]], middle[free & cracked[:, top]]
    assert len(intrados) and np.abs(intrados - 90.0).max() < 35.0
    assert (extrados < 60.0).any() and (extrados > 120.0).any() and (np.abs(extrados - 90.0) > 30.0).all()


def lune(n, out):
    """Thrust over weight of a slice of a dome between two meridians, with hardly any tensile strength, whose springing has gone
    outward by `out` [m]: n elements up, one across, planes of symmetry on both sides."""
    radius, thick, density, half, width = 5.0, 0.5, 2000.0, np.radians(75.0), np.radians(7.5)
    polar = np.linspace(np.radians(2.0), half, n + 1)
    m = n + 1
    xyz = np.concatenate(
        [radius * np.column_stack([np.sin(polar) * np.cos(a), np.sin(polar) * np.sin(a), np.cos(polar)]) for a in (0.0, width)]
    )
    k = np.arange(n)
    quads = np.column_stack([k + 1, k + 1 + m, k + m, k])
    held, ties = {(n, 1)}, [[(n, 0, 1.0), (n + m, 0, np.cos(width)), (n + m, 1, np.sin(width))]]
    for first, a in ((0, 0.0), (m, width)):
        held |= {(first + i, 5) for i in range(m)} | {(first + n, d) for d in (2, 3, 4)}
        for q in range(first, first + n):  # along the radius, and about the hoop
            ways = [[(q, 0, np.cos(a)), (q, 1, np.sin(a))], [(q, 3, -np.sin(a)), (q, 4, np.cos(a))]]
            ties += [[term for term in way if term[2] != 0.0] for way in ways]
        if a == 0.0:
            held |= {(first + i, d) for i in range(n) for d in (1, 3)}
    freedoms = core.Freedoms.make(2 * m, sorted(held), ties, of_node=6)
    count, number = int(freedoms.equation.max()) + 1, freedoms.equation
    freedoms = core.Freedoms(np.where(number < 0, -1, (number - 1) % count), freedoms.factor, 1)
    load = spread(2 * m, quads, nodal_areas(xyz, quads), np.tile([0, 0, -density * GRAVITY * thick], (n, 1)))
    shells = core.Shells(
        "Q4",
        quads,
        thick,
        5e9,
        0.0,
        radius * (half - polar[0]) / n,
        core.Softening(1e3, 0.02, "linear", 0.4),
        frames=np.tile(np.eye(3), (2 * m, 1, 1)),
        flat=np.zeros(2 * m, dtype=bool),
        layers=5,
    )
    with core.Model(xyz, freedoms, [shells], core.Behaviour("orthotropic")) as model:
        watch = [core.Monitor.of(0, 2)]
        model.loads(np.zeros_like(load), load)
        assert model.run(1000, watch, core.Stop(load=1.0)).reason == "target load"
        model.supports([0.0], [1.0])
        model.loads(load, np.zeros_like(load), carried=True)
        events = model.run(10_000, watch, core.Stop(load=out))
        assert events.reason == "target load" and events.equilibrium.all()
        thrust = model.reactions() @ [1.0, events.load[-1]]
    return -thrust[0] / -load[:, 2].sum()


def test_a_lune_that_spreads_reaches_its_least_thrust():
    """What holds a dome up when its springing gives way: the least thrust of a lune, by moments about the intrados at the joint
    where it is greatest and the extrados at the crown. Nothing slides in it, so that a shell must come to it; and it does on
    any mesh."""
    outer, inner, polar = 5.25, 4.75, np.radians(np.linspace(2.0, 75.0, 2000))
    weight = (outer**3 - inner**3) / 3.0 * (1.0 - np.cos(polar))  # per radian, over density and gravity
    about_crown = (outer**4 - inner**4) / 4.0 * (0.5 * polar - 0.25 * np.sin(2.0 * polar))
    least = ((weight * inner * np.sin(polar) - about_crown) / (outer - inner * np.cos(polar))).max() / weight[-1]
    assert least == pytest.approx(0.2539, abs=1e-4)
    coarse, fine = [lune(8, out) for out in (0.01, 0.03)], [lune(16, out) for out in (0.01, 0.03)]
    assert coarse == pytest.approx(fine, rel=0.01)
    assert fine[1] == pytest.approx(least, rel=0.01)
    assert fine[0] == pytest.approx(least, rel=0.04) and fine[0] > fine[1]
