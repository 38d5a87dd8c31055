"""Blocks of UDEC and 3DEC: geometry as text, by the commands of version 7. The output was not run in either program.

UDEC: `block create polygon x,y x,y ...`, as in its manual. 3DEC: `block create group 'name' poly face x,y,z ... face ...`, as
the package compas_3dec writes it, with faces clockwise as seen from outside.
"""

from extrados._build_info import VERSION
from extrados.decks.reader import Deck


def _head(deck: Deck, program: str) -> list[str]:
    title = " ".join(deck.title.split()) or deck.path
    return [f"; {title}", f"; geometry for {program} by extrados {VERSION}; lengths in m; add the properties and supports", "model new"]


def udec(deck: Deck) -> str:
    """The stones of a plane section: a block for each, under its name."""
    stones = deck.building.blocks()
    lines = _head(deck, "UDEC 7")
    for name, outline in zip(stones.block_names, stones.outlines, strict=True):
        lines += [f"; {name}", "block create polygon " + " ".join(f"{x:.9g},{y:.9g}" for x, y in outline)]
    return "\n".join(lines) + "\n"


def threedec(deck: Deck) -> str:
    """The stones in space; a stone of several convex parts is as many blocks of one group, joined afterwards."""
    solids = deck.building.solids()
    lines = _head(deck, "3DEC 7")
    for part, owner in zip(solids.parts, solids.owner.tolist(), strict=True):
        faces = (" ".join(f"{x:.9g},{y:.9g},{z:.9g}" for x, y, z in part.vertices[list(face)][::-1]) for face in part.faces)
        lines.append(f"block create group {_name(solids.block_names[owner])} poly face " + " face ".join(faces))
    owners = solids.owner.tolist()
    lines += [f"block join range group {_name(solids.block_names[k])}" for k in sorted({k for k in owners if owners.count(k) > 1})]
    return "\n".join(lines) + "\n"


def _name(text: str) -> str:
    return "'" + text.replace("'", "''") + "'"
