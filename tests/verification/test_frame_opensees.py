"""Frames of macro-elements beside OpenSees: an elastic facade, and piers of no-tension fibres. Skipped without openseespy."""

import numpy as np
import pytest

from extrados.bridges.forms import exported
from extrados.core.frame import Frame, MacroElement
from extrados.decks.reader import make_deck
from extrados.views.frame.options import FrameOptions

ops = pytest.importorskip("openseespy.opensees")

FACADE = {
    "structure": {
        "kind": "building",
        "storeys": [3.2, 2.9],
        "walls": [
            {
                "name": "front",
                "start": [0, 0],
                "end": [7, 0],
                "thickness": 0.4,
                "openings": [
                    {"storey": 1, "x": [1.2, 2.2], "z": [0.0, 2.2]},
                    {"storey": 1, "x": [4.0, 5.2], "z": [0.9, 2.3]},
                    {"storey": 2, "x": [1.2, 2.2], "z": [0.8, 2.1]},
                    {"storey": 2, "x": [4.3, 5.5], "z": [0.8, 2.1]},
                ],
            }
        ],
    },
    "material": {
        "density": 1800,
        "young": 2e9,
        "poisson": 0.25,
        "compressive_strength": 4e6,
        "tensile_strength": 1e5,
        "fracture_energy": 20,
    },
    "joints": {"cohesion": 1e5},
    "analysis": [{"kind": "frame-modes"}],
}


def elastic(model, forces: dict[int, float]) -> dict[int, float]:
    """Displacements of the levels of a plane facade in OpenSees: elastic Timoshenko beams between rigid links."""
    ops.wipe()
    ops.model("basic", "-ndm", 2, "-ndf", 3)
    levels = model.plan.levels
    for k, node in enumerate(model.nodes):
        ops.node(k + 1, node.s, float(levels[node.level]))
        if node.level == 0:
            ops.fix(k + 1, 1, 1, 1)
    leaders = {}
    for k, node in enumerate(model.nodes):
        if node.level:
            leader = leaders.setdefault(node.level, k + 1)
            if leader != k + 1:
                ops.equalDOF(leader, k + 1, 1)
    for k, (strip, e) in enumerate(zip(model.strips, model.elements, strict=True)):
        ends = (1000 + 2 * k, 1001 + 2 * k)
        for tag, number, (x, z) in zip(ends, strip.nodes, (e.offsets[:2], e.offsets[2:]), strict=True):
            node = model.nodes[number]
            ops.node(tag, node.s + x, float(levels[node.level]) + z)
            ops.rigidLink("beam", number + 1, tag)
        ops.geomTransf("Linear", k + 1)
        area, inertia = e.depth * e.thickness, e.thickness * e.depth**3 / 12
        shear = e.shear_stiffness * e.length  # G times the shear area
        ops.element("ElasticTimoshenkoBeam", k + 1, *ends, e.young, shear / area, area if e.pier else 1e-9, inertia, area, k + 1)
    ops.timeSeries("Linear", 1)
    ops.pattern("Plain", 1, 1)
    for level, force in forces.items():
        ops.load(leaders[level], force, 0.0, 0.0)
    ops.constraints("Penalty", 1e15, 1e15)
    ops.numberer("Plain")
    ops.system("FullGeneral")
    ops.algorithm("Linear")
    ops.integrator("LoadControl", 1.0)
    ops.analysis("Static")
    assert ops.analyze(1) == 0
    return {level: ops.nodeDisp(leader, 1) for level, leader in leaders.items()}


@pytest.mark.parametrize("heights", ["dolce", "lagomarsino"])
def test_an_elastic_facade(heights):
    model = make_deck(FACADE).building.frame(FrameOptions(heights=heights))
    n = len(model.weight)
    frame = Frame(model.elements, model.links, model.linear, np.zeros(n), model.mass)
    stiff = frame.at_rest().tangent
    load = np.zeros(n)
    forces = {1: 40e3, 2: 60e3}
    for level, force in forces.items():
        load[model.along[0, level]] = force
    moved = np.linalg.solve(stiff, load)
    expected = elastic(model, forces)
    for level, value in expected.items():
        assert moved[model.along[0, level]] == pytest.approx(value, rel=1e-5)


@pytest.mark.parametrize("double", [False, True])
def test_a_pier_of_fibres_without_tension(double):
    """Force-based beam-columns of five Lobatto sections of 400 fibres without tension, elastic in pressure; units kN, m."""
    length, t, height, young, axial = 2.0, 0.4, 3.0, 1.5e6, 480.0
    ops.wipe()
    ops.model("basic", "-ndm", 2, "-ndf", 3)
    ops.node(1, 0.0, 0.0)
    ops.node(2, 0.0, height)
    ops.fix(1, 1, 1, 1)
    if double:
        ops.fix(2, 0, 0, 1)
    ops.uniaxialMaterial("ENT", 1, young)
    ops.section("Fiber", 1)
    ops.patch("rect", 1, 400, 1, -length / 2, -t / 2, length / 2, t / 2)
    ops.geomTransf("PDelta", 1)
    ops.beamIntegration("Lobatto", 1, 1, 5)
    ops.element("forceBeamColumn", 1, 1, 2, 1, 1, "-iter", 100, 1e-10)
    ops.timeSeries("Linear", 1)
    ops.pattern("Plain", 1, 1)
    ops.load(2, 0.0, -axial, 0.0)
    ops.constraints("Plain")
    ops.numberer("Plain")
    ops.system("FullGeneral")
    ops.test("NormUnbalance", 1e-6, 100)
    ops.algorithm("Newton")
    ops.integrator("LoadControl", 0.1)
    ops.analysis("Static")
    assert ops.analyze(10) == 0
    ops.loadConst("-time", 0.0)
    ops.timeSeries("Linear", 2)
    ops.pattern("Plain", 2, 2)
    ops.load(2, 1.0, 0.0, 0.0)
    step = 2e-5
    ops.integrator("DisplacementControl", 2, 1, step)
    theirs = [(0.0, 0.0)]
    while theirs[-1][0] < 0.009 and ops.analyze(1) == 0:
        theirs.append((ops.nodeDisp(2, 1), ops.getLoadFactor(2)))
    u, v = np.array(theirs).T
    assert u[-1] > 0.002
    pier = MacroElement((-1, -1, -1, 0, 1, -1 if double else 2), height, length, t, young, 1e12)
    n = 2 if double else 3
    weight, along = np.zeros(n), np.zeros(n)
    weight[1], along[0] = -axial, 1.0
    path = Frame([pier], [], np.zeros((n, n)), weight, np.zeros((n, n))).push(along, along, float(u[-1]), 300, 0.0)
    ours = np.interp(u, path.control, path.multiple)
    assert ours[1:] == pytest.approx(v[1:], rel=3e-3)


def interpreted(script: str) -> None:
    """Run an exported script by Tcl, its commands given to OpenSeesPy; Macroelement3d as an elastic beam between rigid links."""
    tcl = pytest.importorskip("tkinter").Tcl()
    where: dict[str, tuple[float, ...]] = {}

    def value(text: str):
        try:
            return int(text)
        except ValueError:
            try:
                return float(text)
            except ValueError:
                return text

    def call(name: str):
        def run(*words: str) -> str:
            if name == "node":
                where[words[0]] = tuple(float(x) for x in words[1:])
            if name == "element" and words[0] == "Macroelement3d":
                return beam(words[1:])
            getattr(ops, name)(*(value(w) for w in words))
            return ""

        return run

    def beam(words: tuple[str, ...]) -> str:
        tag, i, j, e = words[:4]
        axis, sort = np.array([float(x) for x in words[4:7]]), words[10]
        length, depth, thickness, young, shear = (float(x) for x in words[11:16])
        middle = np.array(where[e])
        ends = (100_000 + 2 * int(tag), 100_001 + 2 * int(tag))
        for end, node, sign in zip(ends, (i, j), (-0.5, 0.5), strict=True):
            ops.node(end, *(middle + sign * length * axis).tolist())
            ops.rigidLink("beam", int(node), end)
        ops.fix(int(e), 1, 0, 1, 0, 1, 0)  # the middle node belongs to the element that stands for it here
        area, inertia = depth * thickness, thickness * depth**3 / 12
        ops.geomTransf("Linear", int(tag), 0.0, 1.0, 0.0)
        ops.element(
            "ElasticTimoshenkoBeam",
            int(tag),
            *ends,
            young,
            shear,
            area if sort == "-pier" else 1e-9,
            2 * inertia,
            1.0,
            inertia,
            area / 1.2,
            area / 1.2,
            int(tag),
        )
        return ""

    def pattern(sort: str, tag: str, series: str, body: str) -> str:
        ops.timeSeries(series, int(tag))
        ops.pattern(sort, int(tag), int(tag))
        tcl.eval(body)
        return ""

    ops.wipe()
    for name in (
        "wipe",
        "model",
        "node",
        "fix",
        "equalDOF",
        "element",
        "rigidLink",
        "uniaxialMaterial",
        "load",
        "constraints",
        "numberer",
        "system",
        "test",
        "algorithm",
        "integrator",
        "analysis",
        "analyze",
        "loadConst",
        "wipeAnalysis",
    ):
        tcl.createcommand(name, call(name))
    tcl.createcommand("pattern", pattern)
    tcl.eval(script)


def test_the_exported_frame_of_a_house_moves_as_this_one():
    """Walls side by side, floors as springs between their displacements, corners as vertical springs: the same displacements."""
    facade = FACADE["structure"]["walls"][0]
    house = {
        "kind": "building",
        "storeys": [3.2, 2.9],
        "walls": [
            facade,
            {"name": "right", "start": [7, 0], "end": [7, 5], "thickness": 0.4},
            {"name": "back", "start": [7, 5], "end": [0, 5], "thickness": 0.4, "openings": [{"storey": 1, "x": [2, 3], "z": [0.8, 2.1]}]},
            {"name": "left", "start": [0, 5], "end": [0, 0], "thickness": 0.4},
        ],
        "floors": [{"storey": k, "young": 5e7, "thickness": 0.05, "load": 3e3} for k in (1, 2)],
    }
    deck = make_deck({**FACADE, "structure": house, "analysis": [{"kind": "frame-modes"}]})
    frame = deck.building.frame(FrameOptions())
    interpreted(exported(deck, "opensees-frame"))
    nodes = {
        freedom: k + 1
        for k, node in reversed(list(enumerate(frame.nodes)))
        if node.level
        for freedom in [frame.along[node.wall, node.level]]
    }
    before = np.array([ops.nodeDisp(nodes[f], 1) for f in sorted(nodes)])
    ops.constraints("Penalty", 1e15, 1e15)
    ops.numberer("Plain")
    ops.system("UmfPack")
    ops.test("NormDispIncr", 1e-6, 50)
    ops.algorithm("Newton")
    ops.integrator("LoadControl", 1.0)
    ops.analysis("Static")
    assert ops.analyze(1) == 0
    theirs = np.array([ops.nodeDisp(nodes[f], 1) for f in sorted(nodes)]) - before
    unit = frame.unit(np.array([1.0, 0.0]))
    forces = frame.mass @ unit
    with frame.core() as core:
        rest = core.at_rest()
    ours = np.linalg.solve(rest.tangent, forces / (forces @ unit))[sorted(nodes)]
    assert theirs == pytest.approx(ours, rel=0.01, abs=0.01 * float(np.abs(ours).max()))
