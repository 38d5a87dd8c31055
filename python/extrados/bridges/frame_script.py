"""The frame of macro-elements of a building for other programs: OpenSees with Macroelement3d (EPFL), and text tables.

The walls are drawn side by side in parallel planes, each along X. All nodes of a wall on a level have one displacement along
the wall, floors are springs between these displacements, and corners are vertical springs. This is the frame of
frame-pushover.
"""

import logging
import re
from collections.abc import Iterator

import numpy as np

from extrados._build_info import VERSION
from extrados.decks.reader import Deck
from extrados.model.errors import BadGeometry
from extrados.views.frame.frame import EquivalentFrame, Strip
from extrados.views.frame.options import FrameOptions

log = logging.getLogger(__name__)

#: Distance of the planes of the walls [m]
APART = 20.0
#: Slope of the softening in shear and residual friction of the element, which this program does not have
DROP_DRIFT, SHEAR_FACTOR = 0.05, 1.2
#: Strength in place of an unlimited one [Pa]
STRONG = 1e12


def frame_of(deck: Deck) -> EquivalentFrame:
    """The frame by the options of the first analysis of a frame, else the default ones."""
    tables = (getattr(analysis, "frame", None) for analysis in deck.analyses)
    found = deck.building.frame(next((one for one in tables if isinstance(one, FrameOptions)), FrameOptions()))
    if found.plan.foundation_stiffness is not None:
        raise BadGeometry(
            "the export of frames assumes rigid ground: remove `foundation_stiffness` from the deck", ("structure", "foundation_stiffness")
        )
    return found


def _material(frame: EquivalentFrame, k: int) -> dict[str, float]:
    """E, G, fc, mu, c of an element. fc is 1/0.85 of the stress block; c of a pier is its least strength without pressure, of a
    spandrel the shear at the moments of its hinges."""
    element = frame.elements[k]
    area = element.depth * element.thickness
    shear = SHEAR_FACTOR * element.shear_stiffness * element.length / area
    if not element.pier:
        shear_strength = min(2.0 * element.moment / (element.length * area), STRONG)
    elif element.shear == "none":
        shear_strength = STRONG
    else:
        shear_strength = min((x for x in (element.cohesion, element.tension / element.slenderness) if x > 0.0), default=0.0)
    return {"E": element.young, "G": shear, "fc": min(element.strength / 0.85, STRONG), "mu": element.friction, "c": shear_strength}


def plain_name(text: str) -> str:
    """A text of a deck on one line, without signs that another program takes for commands."""
    return re.sub(r"[^\w .-]", "_", text)


def _is_rod(frame: EquivalentFrame, k: int) -> bool:
    """Whether a link is not that of a corner, between vertical displacements and rotations of two nodes."""
    link = frame.links[k]
    nodes = {node.freedoms for node in frame.nodes if node.level}
    return len(link.freedoms) != 4 or link.freedoms[:2] not in nodes or link.freedoms[2:] not in nodes


def _rod(frame: EquivalentFrame, k: int) -> str:
    link = frame.links[k]
    return (
        f"# Not exported: tie rod, stiffness {link.stiffness:.6g} N/m, strength {link.strengths[1]:.6g} N, prestress {link.prestress:.6g} N"
    )


def _tell_rods(frame: EquivalentFrame, form: str) -> None:
    rods = sum(_is_rod(frame, k) for k in range(len(frame.links)))
    if rods:
        log.warning("%s: %d links of tie rods were not exported; comments in the file give their values", form, rods)


def _node_place(frame: EquivalentFrame, k: int) -> np.ndarray:
    node = frame.nodes[k]
    return np.array([node.s, APART * node.wall, float(frame.plan.levels[node.level])])


def _middle(strip: Strip) -> np.ndarray:
    a, b, low, high = strip.part
    return np.array([0.5 * (a + b), APART * strip.wall, 0.5 * (low + high)])


def macroelements(deck: Deck) -> str:
    """A Tcl script for OpenSees with Macroelement3d: the weight, then a push along x in proportion to the masses."""
    frame = frame_of(deck)
    _tell_rods(frame, "opensees-frame")
    title = plain_name(" ".join(deck.title.split()) or deck.path)
    lines = [
        f"# {title}: by extrados {VERSION}; N, m. Needs the OpenSees of EPFL (EESD) with Macroelement3d.",
        "# Walls stand side by side, each along X. Shear of an element: one Mohr-Coulomb law; c is the least strength at zero pressure.",
        "wipe",
        "model basic -ndm 3 -ndf 6",
        *_nodes(frame),
        *_elements(frame),
        *_links(frame),
        *_loads(frame),
    ]
    return "\n".join(lines) + "\n"


def _nodes(frame: EquivalentFrame) -> Iterator[str]:
    """Nodes from 1; in the middle of element k node 10001 + k; along a wall on a level all nodes follow the first."""
    first: dict[int, int] = {}
    for k, node in enumerate(frame.nodes):
        yield "node {} {:.6g} {:.6g} {:.6g}".format(k + 1, *_node_place(frame, k))
        yield f"fix {k + 1} {'1 1 1 1 1 1' if node.level == 0 else '0 1 0 1 0 1'}"
        if node.level:
            master = first.setdefault(frame.along[node.wall, node.level], k)
            if master != k:
                yield f"equalDOF {master + 1} {k + 1} 1"
    for k, strip in enumerate(frame.strips):
        yield "node {} {:.6g} {:.6g} {:.6g}".format(10001 + k, *_middle(strip))
        yield f"fix {10001 + k} 0 1 0 1 0 1"


def _elements(frame: EquivalentFrame) -> Iterator[str]:
    for k, (strip, e) in enumerate(zip(frame.strips, frame.elements, strict=True)):
        m = _material(frame, k)
        axis, sort = ("0 0 1", "-pier") if e.pier else ("1 0 0", "-spandrel")
        drifts = f"-driftF {e.drifts[0]:.6g} 0.0 -driftS {e.drifts[1]:.6g} 0.0" if e.pier else ""
        yield f"# {plain_name(strip.name)}"
        yield (
            f"element Macroelement3d {k + 1} {strip.nodes[0] + 1} {strip.nodes[1] + 1} {10001 + k} {axis} 0 1 0 {sort} "
            f"{e.length:.6g} {e.depth:.6g} {e.thickness:.6g} {m['E']:.6g} {m['G']:.6g} {m['fc']:.6g} {m['mu']:.6g} {m['c']:.6g} "
            f"5.0 {DROP_DRIFT:g} {m['mu']:.6g} {drifts} {'-pDelta' if e.second_order else ''}".rstrip()
        )


def _links(frame: EquivalentFrame) -> Iterator[str]:
    """Corners and floors; nodes of corners from 20001, material and element of link k 30001 + k."""
    at: dict[tuple[int, ...], int] = {node.freedoms: k for k, node in enumerate(frame.nodes) if node.level}
    number = 0
    for number_of_link, link in enumerate(frame.links):
        if _is_rod(frame, number_of_link):
            yield _rod(frame, number_of_link)
            continue
        tags = []
        for sign, freedoms, arm in ((1, link.freedoms[:2], link.parts[1]), (-1, link.freedoms[2:], -link.parts[3])):
            k = at[freedoms]
            tag = 20001 + 2 * number + (sign < 0)
            x, y, z = _node_place(frame, k)
            yield f"node {tag} {x + arm:.6g} {y:.6g} {z:.6g}"
            yield f"rigidLink beam {k + 1} {tag}"
            tags.append(tag)
        number += 1
        tag = 30000 + number
        pull, push = (max(min(limit / link.stiffness, 1e6), 1e-12) for limit in (link.strengths[1], link.strengths[0]))
        if link.returns:
            forces = [round(link.stiffness * x, 3) for x in (-push, -push, 0.0, pull, pull)]
            strains = " ".join(f"{x:.6g}" for x in (-push - 1.0, -push, 0.0, pull, pull + 1.0))
            yield f"uniaxialMaterial ElasticMultiLinear {tag} -strain {strains} -stress {' '.join(f'{x:.8g}' for x in forces)}"
        else:
            yield f"uniaxialMaterial ElasticPP {tag} {link.stiffness:.6g} {pull:.6g} {-push:.6g}"
        yield f"element zeroLength {tag} {tags[1]} {tags[0]} -mat {tag} -dir 3"
    # u K u / 2 = sum over pairs of -K_ij (u_i - u_j)^2 / 2 + sum of (row sums of K) u_i^2 / 2
    first: dict[int, int] = {}
    for (wall, level), freedom in frame.along.items():
        k = next(k for k, node in enumerate(frame.nodes) if (node.wall, node.level) == (wall, level))
        first.setdefault(freedom, k)
    linear, tag, ground = frame.linear, 40000, 50000
    least = 1e-9 * float(np.abs(linear).max(initial=1.0))
    for i, one in sorted(first.items()):
        pairs = [(first[j], -linear[i, j]) for j in sorted(first) if j > i]
        held = float(linear[i, list(first)].sum())
        for other, stiffness in [*pairs, (None, held)]:
            if abs(stiffness) <= least:
                continue
            tag += 1
            if other is None:
                ground += 1
                yield "node {} {:.6g} {:.6g} {:.6g}".format(ground, *_node_place(frame, one))
                yield f"fix {ground} 1 1 1 1 1 1"
            yield f"uniaxialMaterial Elastic {tag} {stiffness:.8g}"
            yield f"element zeroLength {tag} {ground if other is None else other + 1} {one + 1} -mat {tag} -dir 1"


def _loads(frame: EquivalentFrame) -> Iterator[str]:
    yield "pattern Plain 1 Linear {"
    for k, node in enumerate(frame.nodes):
        if node.level:
            down, turn = (float(frame.weight[f]) for f in node.freedoms)
            # a positive rotation about Y turns Z towards X, that of the frame X towards Z
            yield f"  load {k + 1} 0 0 {down:.8g} 0 {-turn:.8g} 0"
    yield "}"
    yield "constraints Penalty 1e15 1e15; numberer Plain; system UmfPack; test NormDispIncr 1e-6 100; algorithm Newton"
    yield "integrator LoadControl 0.1; analysis Static; analyze 10; loadConst -time 0.0; wipeAnalysis"
    unit = frame.unit(np.array([1.0, 0.0]))
    forces = frame.mass @ unit
    yield "# A push along x by the masses, 1 N in all"
    yield "pattern Plain 2 Linear {"
    done: set[int] = set()
    for k, node in enumerate(frame.nodes):
        freedom = frame.along.get((node.wall, node.level))
        if freedom is not None and freedom not in done:
            done.add(freedom)
            yield f"  load {k + 1} {forces[freedom] / float(forces @ unit):.8g} 0 0 0 0 0"
    yield "}"


def tables(deck: Deck) -> str:
    """The frame as tables of text, in the order of the input of TREMURI: materials, walls, nodes, elements, loads."""
    frame = frame_of(deck)
    _tell_rods(frame, "frame-tables")
    plan = frame.plan
    text = [
        f"! {plain_name(' '.join(deck.title.split()) or deck.path)}: by extrados {VERSION}; N, m. Tables of a frame of macro-elements",
        "/walls",
        "! number x0 y0 angle_rad name",
    ]
    for w, wall in enumerate(plan.walls, 1):
        angle = float(np.arctan2(wall.direction[1], wall.direction[0]))
        text.append(f"{w} {wall.start[0]:.4f} {wall.start[1]:.4f} {angle:.6f} {plain_name(wall.name)}")
    kinds = list(dict.fromkeys(tuple(_material(frame, k).values()) for k in range(len(frame.elements))))
    text += ["/materials", "! number E G fc mu c"]
    text += [f"{k} " + " ".join(f"{v:.6g}" for v in values) for k, values in enumerate(kinds, 1)]
    text += ["/nodes", "! number wall s z left right (extent of the rigid node from its middle)"]
    for k, node in enumerate(frame.nodes, 1):
        half = 0.5 * (node.end - node.start)
        text.append(f"{k} {node.wall + 1} {node.s:.4f} {float(plan.levels[node.level]):.4f} {-half:.4f} {half:.4f}")
    text += ["/elements", "! number kind wall i j s z depth length thickness material"]
    for k, (strip, e) in enumerate(zip(frame.strips, frame.elements, strict=True), 1):
        s, _, z = _middle(strip)
        text.append(
            f"{k} {strip.kind} {strip.wall + 1} {strip.nodes[0] + 1} {strip.nodes[1] + 1} {s:.4f} {z:.4f} {e.depth:.4f} "
            f"{e.length:.4f} {e.thickness:.4f} {kinds.index(tuple(_material(frame, k - 1).values())) + 1}"
        )
    text += ["/floors", "! level kind young thickness load walls"]
    for floor in plan.floors:
        names = ",".join(plain_name(plan.walls[w].name) for w, _, _ in plan.around(floor))
        text.append(f"{floor.storey} {floor.kind} {floor.young or 0:.6g} {floor.thickness or 0:.6g} {floor.load:.6g} {names}")
    text += [_rod(frame, k).replace("#", "!", 1) for k in range(len(frame.links)) if _is_rod(frame, k)]
    text += ["/loads", "! node vertical_force moment"]
    for k, node in enumerate(frame.nodes, 1):
        if node.level:
            text.append(f"{k} " + " ".join(f"{frame.weight[f]:.8g}" for f in node.freedoms))
    return "\n".join(text) + "\n"
