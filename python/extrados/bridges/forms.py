"""The list of export formats."""

import logging
from collections.abc import Callable
from typing import Any

from extrados.bridges import compas, frame_script, itasca, opensees
from extrados.decks.reader import Deck, DeckError
from extrados.model.errors import BadGeometry, NoView
from extrados.model.geometry.assembly import Assembly
from extrados.model.geometry.solids.assembly import SolidAssembly

log = logging.getLogger(__name__)

#: Format -> what writes it, the ending of its files, and what it is
FORMS: dict[str, tuple[Callable[[Deck], str], str, str]] = {
    "compas": (compas.written, ".json", "the stones as an Assembly of compas_assembly"),
    "udec": (itasca.udec, ".dat", "the stones of a plane section, as blocks of UDEC 7"),
    "3dec": (itasca.threedec, ".dat", "the stones in space, as blocks of 3DEC 7"),
    "opensees-frame": (frame_script.macroelements, ".tcl", "the frame of macro-elements of a building, for OpenSees with Macroelement3d"),
    "frame-tables": (frame_script.tables, ".txt", "the frame of macro-elements of a building, as text tables in the order of TREMURI"),
    "opensees": (opensees.written, ".py", "a single rocking block, or the mesh of a wall with dry joints, as a script for OpenSeesPy"),
}
#: Those that hold nothing but the geometry of blocks
BLOCKS = ("compas", "udec", "3dec")


def exported(deck: Deck, form: str) -> str:
    """The text of the building in a format; DeckError if the format is unknown, or the building has no such model."""
    if form not in FORMS:
        raise DeckError([f"no format '{form}'; the formats are {', '.join(FORMS)}"])
    if deck.structure is None:
        raise DeckError([f"the export to {form} needs a [structure]"])
    try:
        text = FORMS[form][0](deck)
        if form in BLOCKS and (left := _beyond_geometry(deck)):
            log.warning("%s: the file contains the geometry of the blocks. Not exported: %s", form, ", ".join(left))
        return text
    except BadGeometry as error:
        raise DeckError([deck.complaint(None, error.at, str(error))]) from None


def _beyond_geometry(deck: Deck) -> list[str]:
    """Parts of a building that affect its capacity but are not geometry of blocks: ties, dowels, fill and others."""
    found = list(deck.building.special_keys)
    try:
        stones: Assembly | SolidAssembly = deck.building.blocks()
    except NoView:
        stones = deck.building.solids()
    if isinstance(stones, SolidAssembly):
        found += ["dowels"] if stones.keys is not None else []
        found += ["fill"] if len(stones.fill) else []
    else:
        found += ["fill"] if stones.fill is not None and (stones.fill[:, 0] > 0.0).any() else []
        found += ["the soil of the fill"] if stones.earth is not None else []
    return found


def scene(deck: Deck) -> Any:
    """The blocks as a pyvista.MultiBlock, one mesh per block by name; ImportError names the package to install."""
    try:
        import pyvista
    except ImportError:
        raise ImportError("a scene of the stones needs pyvista: pip install pyvista") from None
    made = pyvista.MultiBlock()
    for name, vertices, faces in compas.bodies(deck):
        made.append(pyvista.PolyData(vertices, [number for face in faces for number in (len(face), *face)]), name)
    return made
