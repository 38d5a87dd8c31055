"""Scripts of OpenSeesPy: a rigid block on two toes, or finite elements with dry joints that open and slide.

Contacts are node to node (zeroLengthContact2D: no tension, Coulomb friction); rigid bodies are stiff beams under the
corotational transformation. Cracking, crushing, cohesion and impact rules of the deck are not exported: a rocking block loses
energy only by the damping of the OpenSees analysis, not at impacts.
"""

from collections.abc import Iterator

import numpy as np

from extrados._build_info import VERSION
from extrados.decks.reader import Deck
from extrados.model.errors import BadGeometry
from extrados.schema.constants import GRAVITY
from extrados.views.mesh.mesh import ElementGroup, Mesh
from extrados.views.mesh.options import MeshOptions
from extrados.views.rockers.block import BlockModel

#: Coefficient that stands for "no-sliding", and stiffness of the toes of a block over its weight per metre
NO_SLIDING, HARD = 1e3, 1e6


def written(deck: Deck) -> str:
    """The script of a single block if the building is one, otherwise of the first mesh of the deck, or of a mesh with the
    default size."""
    title = " ".join(deck.title.split()) or deck.path
    lines = [
        f'"""{_words(title)}: by extrados {VERSION}; units N, m, kg, s. At its end the script has applied the self-weight."""',
        "",
        "import openseespy.opensees as ops",
        "",
        "ops.wipe()",
    ]
    assert deck.structure is not None
    for what, key in deck.building.special_keys.items():
        raise BadGeometry(f"the export to OpenSees cannot include {what}: remove this part from the deck", key)
    if deck.structure.rocks_as == "block" and len(deck.building.blocks().mass) == 1:
        lines += _block(deck)
    else:
        tables = (getattr(analysis, "mesh", None) for analysis in deck.analyses)
        options = next((table for table in tables if isinstance(table, MeshOptions)), None)
        lines += _mesh(deck.building.mesh(options))
    return "\n".join([*lines, *_WEIGHT]) + "\n"


def _words(text: str) -> str:
    return text.replace("\\", "/").replace('"', "'")


_WEIGHT = [
    "",
    "# Self-weight, applied in ten steps",
    'ops.constraints("Transformation")',
    'ops.numberer("RCM")',
    'ops.system("UmfPack")',
    'ops.test("NormDispIncr", 1e-10, 100)',
    'ops.algorithm("Newton")',
    'ops.integrator("LoadControl", 0.1)',
    'ops.analysis("Static")',
    "failed = ops.analyze(10)",
    'ops.loadConst("-time", 0.0)',
]


def _block(deck: Deck) -> Iterator[str]:
    """Nodes: 1, 2 the ground under the right and the left toe, 3, 4 the toes, 5 the centre of mass, 6, 7 the toes as the block has them."""
    model = deck.building.rocker().model
    if not isinstance(model, BlockModel):
        raise BadGeometry("the export to OpenSees covers a single rigid block only", ("structure",))
    block, friction = model.block, deck.building.friction()
    if block.slope:
        raise BadGeometry("the export to OpenSees covers a block on level ground only", ("structure", "base_slope"))
    mass, inertia, height = float(block.mass[0]), float(block.inertia[0]), float(block.centre_height)
    toes = {"right": float(block.toe_right), "left": -float(block.toe_left)}
    stiffness = HARD * mass * GRAVITY / height
    mu = NO_SLIDING if friction is None else float(np.max(friction))
    yield "\n# A rigid block on its toes; the ground and the contacts have two degrees of freedom, the block three"
    yield 'ops.model("basic", "-ndm", 2, "-ndf", 2)'
    for k, x in enumerate(toes.values(), 1):
        yield f"ops.node({k}, {x!r}, 0.0)\nops.fix({k}, 1, 1)\nops.node({k + 2}, {x!r}, 0.0)"
    yield 'ops.model("basic", "-ndm", 2, "-ndf", 3)'
    for k, x in enumerate(toes.values(), 6):
        yield f"ops.node({k}, {x!r}, 0.0)"
    yield f"ops.node(5, 0.0, {height!r})\nops.mass(5, {mass!r}, {mass!r}, {inertia!r})"
    yield "ops.equalDOF(6, 3, 1, 2)\nops.equalDOF(7, 4, 1, 2)"
    yield 'ops.geomTransf("Corotational", 1)'
    area, bending = 100.0 * stiffness * height, 100.0 * stiffness * height**3
    for k, (i, j) in enumerate(((6, 5), (7, 5), (6, 7)), 1):
        yield f'ops.element("elasticBeamColumn", {k}, {i}, {j}, 1.0, {area!r}, {bending / area!r}, 1)'
    for k in (1, 2):
        yield f'ops.element("zeroLengthContact2D", {k + 10}, {k + 2}, {k}, {stiffness!r}, {stiffness!r}, {mu!r}, "-normal", 0.0, 1.0)'
    yield '\nops.timeSeries("Linear", 1)\nops.pattern("Plain", 1, 1)'
    yield f"ops.load(5, 0.0, {-mass * GRAVITY!r}, 0.0)"


def _mesh(mesh: Mesh) -> Iterator[str]:
    """Elements in plane stress, elastic; joints of no thickness as contacts of their pairs of nodes."""
    for word in ("ties", "bars"):
        if getattr(mesh, word):
            raise BadGeometry(f"the export to OpenSees cannot include the {word} of a wall: remove them from the deck", ("structure", word))
    yield '\nops.model("basic", "-ndm", 2, "-ndf", 2)'
    for k, (x, y) in enumerate(mesh.xy.tolist(), 1):
        yield f"ops.node({k}, {x!r}, {y!r})"
    for k, fixed in sorted(_held(mesh).items()):
        yield f"ops.fix({k + 1}, {int('x' in fixed)}, {int('y' in fixed)})"
    for k, material in enumerate(mesh.materials, 1):
        yield f'ops.nDMaterial("ElasticIsotropic", {k}, {material.young!r}, {material.poisson!r}, {material.density!r})'
    number, weight = 0, np.zeros(len(mesh.xy))
    for group in mesh.groups:
        if group.law is not None:
            for line in _contacts(group, number):
                yield line
                number += 1
            continue
        name = {"Q4": "quad", "T3": "tri31"}.get(group.kind)
        if name is None:
            raise BadGeometry(
                f'the export to OpenSees has no element for {group.kind}: give mesh.element = "Q4" or "T3"', ("analysis", "mesh")
            )
        for nodes, thickness, material in zip(group.connect, group.thickness.tolist(), group.material.tolist(), strict=True):
            number += 1
            tags = ", ".join(str(n + 1) for n in nodes.tolist())
            yield f'ops.element("{name}", {number}, {tags}, {thickness!r}, "PlaneStress", {material + 1})'
        weight += _weights(mesh, group)
    weight = weight if mesh.mass is None else mesh.mass * GRAVITY
    yield '\nops.timeSeries("Linear", 1)\nops.pattern("Plain", 1, 1)'
    for k, force in enumerate(weight.tolist(), 1):
        if force:
            yield f"ops.load({k}, 0.0, {-force!r})"


def _held(mesh: Mesh) -> dict[int, set[str]]:
    """The supported nodes with their directions: those of blocks on the ground, and those of [[supports.held]]."""
    held = {} if mesh.ground is None else {int(node): set("xy") for node in np.ravel(mesh.ground)}
    for k, support in enumerate(mesh.held):
        key = ("supports", "held", k)
        if support.stiffness is not None:
            raise BadGeometry("the export to OpenSees has rigid supports only: remove `stiffness` of [supports]", (*key, "stiffness"))
        for node in mesh.nodes_at(support, f"supports.held[{k}]").tolist():
            held.setdefault(node, set()).update(support.fix)
    return held


def _weights(mesh: Mesh, group: ElementGroup) -> np.ndarray:
    """Weight at the nodes [N]: of each element evenly at its corners."""
    from extrados.views.mesh.mesh import element_areas

    density = np.array([material.density for material in mesh.materials])[group.material]
    each = element_areas(mesh.xy, group.kind, group.connect) * group.thickness * density * GRAVITY / group.connect.shape[1]
    return np.bincount(group.connect.ravel(), np.repeat(each, group.connect.shape[1]), len(mesh.xy))


def _contacts(group: ElementGroup, number: int) -> Iterator[str]:
    """A contact for each pair of nodes of a stretch: the lower side is kept, the upper one lifts or slides."""
    law = group.law
    assert law is not None
    for k, nodes in enumerate(group.connect.tolist()):
        mu = law.friction[k] if np.isfinite(law.friction[k]) else NO_SLIDING
        nx, ny = law.normal[k].tolist()
        for end in (0, 1):
            area = float(law.area[k, end])
            if area > 0.0:
                number += 1
                kn, kt = float(law.normal_stiffness[k]) * area, float(law.shear_stiffness[k]) * area
                below, above = nodes[end] + 1, nodes[3 - end] + 1
                yield f'ops.element("zeroLengthContact2D", {number}, {above}, {below}, {kn!r}, {kt!r}, {float(mu)!r}, "-normal", {nx!r}, {ny!r})'
