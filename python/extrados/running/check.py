"""The checks of `extrados check` beyond the text of a deck: whether the building can be made, and how its blocks fit."""

import csv
import io
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from extrados.analyses.context import Context, default_threads
from extrados.analyses.left_out import left_out
from extrados.analyses.needs import as_shell, complaints, stones_of
from extrados.decks.reader import Deck
from extrados.model.errors import BadGeometry
from extrados.model.geometry.assembly import Assembly

if TYPE_CHECKING:
    from extrados.model.geometry.inspection import Inspection
    from extrados.model.geometry.solids.assembly import SolidAssembly
    from extrados.views.shell.mesh import ShellMesh


@dataclass(frozen=True)
class Place:
    """One row of the list: kind and place of a gap or overlap, its depth [m], and the key with the value that would repair it."""

    what: str
    status: str
    between: str
    depth: float | None
    place: tuple[float, float]
    mended_by: str = ""


@dataclass(frozen=True)
class Checked:
    """complaints: why the deck would be refused; ignored: what it says that no analysis uses, or not all; remarks and
    notes on its geometry; the list of places, the refused
    first, then the open, then those that the tolerance closes; inspection: None where it is no survey; solids: what has
    no plane section, or is asked for in a direction; plan: the mesh of a building on a plan;
    foretold: runs, memory and time of long analyses."""

    complaints: list[str] = field(default_factory=list)
    remarks: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)
    places: list[Place] = field(default_factory=list)
    inspection: "Inspection | None" = None
    solids: "SolidAssembly | None" = None
    plan: "ShellMesh | None" = None
    ignored: list[str] = field(default_factory=list)
    foretold: list[str] = field(default_factory=list)


def check_building(deck: Deck) -> Checked:
    """Make the building as the analyses will, and whatever else they need, without computing anything."""
    inspection, found = None, []
    foretold: list[str] = []
    context = Context(deck, default_threads(), tell=foretold.append, out=deck.default_out)
    try:
        if deck.structure is not None:
            inspection = deck.structure.inspection(deck.folder)
            if inspection is not None:
                found = [deck.complaint(None, ("structure",), text) for text in inspection.complaints()]
    except BadGeometry as error:
        found = [deck.complaint(None, error.at, str(error))]
    if not found:
        for options, building in zip(deck.analyses, deck.buildings, strict=True):
            found += complaints(context, options, building)
    found = list(dict.fromkeys(found))
    solids, plan = (None, None) if found else _in_space(deck)
    checked = Checked(found, plan.warnings if plan else [], plan=plan)
    if solids is not None:
        checked = Checked(remarks=list(solids.remarks), notes=list(solids.notes), solids=solids)
    elif inspection is not None:
        checked = Checked(found, inspection.remarks(), inspection.notes(), _places(inspection), inspection)
    return replace(checked, ignored=[remark.text for remark in left_out(deck)], foretold=foretold)


def _in_space(deck: Deck) -> "tuple[SolidAssembly | None, ShellMesh | None]":
    """The solids and the shell mesh of a valid deck, as its analyses use them."""
    solids, plan = None, None
    for options, building in zip(deck.analyses, deck.buildings, strict=True):
        if options.view == "shell" or as_shell(building, options):
            plan = building.shell(getattr(options, "mesh", None))
        elif options.view == "blocks":
            stones = stones_of(building, options)
            solids = solids if isinstance(stones, Assembly) else stones
    return solids, plan


def _places(inspection: "Inspection") -> list[Place]:
    rows = []
    for status in ("overlap", "open", "closed"):
        for flaw in inspection.of(status):
            mends = inspection.mends(flaw)
            cure = "draw this part again" if mends is None else f'contact_tolerance = "{1e3 * mends:.3g} mm"'
            rows.append(Place(flaw.kind, status, inspection.between(flaw), flaw.depth, flaw.place, cure))
        if status == "open":
            for place, gap in inspection.drawing.loose:
                cure = "" if gap is None else f'join_tolerance = "{1e3 * 1.01 * gap:.3g} mm"'
                rows.append(Place("loose end", "loose end", "line and the next line", gap, place, cure))
            for block, level in inspection.levels:
                x = float(inspection.outlines[block][:, 0].mean())
                name = f"'{inspection.names[block]}' and no block below"
                rows.append(Place("sole", "sole", name, None, (x, level), "foundation_levels"))
    return rows


def write_check(checked: Checked, folder: Path) -> tuple[Path, Path]:
    """The picture and the list of a survey into a folder: geometry.png (and .svg), geometry.csv.

    A file there that extrados did not write, or that was changed since, stays, and the new one is put beside it.
    """
    from extrados.show.geometry import Mark, draw_survey  # matplotlib takes a third of a second to load

    assert checked.inspection is not None
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["what", "status", "between", "depth_mm", "x_m", "y_m", "mended_by"])
    for row in checked.places:
        depth = "" if row.depth is None else f"{1e3 * row.depth:.4g}"
        writer.writerow([row.what, row.status, row.between, depth, *(f"{v:.4f}" for v in row.place), row.mended_by])
    inspection = checked.inspection
    joints = np.column_stack([inspection.contacts.p, inspection.contacts.q])
    marks = [Mark(row.place, row.depth, row.status, row.between) for row in checked.places]
    with _putting(folder, "geometry") as (scratch, names):
        (scratch / "geometry.csv").write_text(text.getvalue(), encoding="utf-8")
        draw_survey(scratch, "geometry", inspection.outlines, joints, inspection.ground, marks)
    return names["geometry.png"], names["geometry.csv"]


@contextmanager
def _putting(folder: Path, stem: str) -> Iterator[tuple[Path, dict[str, Path]]]:
    """A folder for new files whose names begin with `stem`, and where each has come to lie in `folder` after the block: a file there
    that extrados did not write, or that was changed since, stays, and the new one is put beside it."""
    from extrados.results import written

    folder = Path(os.path.abspath(folder))
    folder.mkdir(parents=True, exist_ok=True)
    found: dict[str, Path] = {}
    with tempfile.TemporaryDirectory(prefix=f".{folder.name}.checking-", dir=folder.parent) as place:
        yield Path(place), found
        with written.alone(folder.parent):
            found |= {name: folder / put for name, put in written.put(Path(place), folder, lambda name: name.startswith(stem)).items()}


def write_plan(mesh: "ShellMesh", folder: Path) -> Path:
    """Plan and elevations of a building with its mesh, or the mesh of a vault in space, into a folder: plan.png (and .svg),
    under the rule of write_check."""
    from extrados.show.plan import Elevation, draw_plan, draw_shells

    walls = []
    for number, wall in enumerate(mesh.walls):
        own = [p for p in mesh.parts if p.wall == number]
        corner = np.concatenate([_as_quads(wall.unfolded(mesh.xyz[p.connect.ravel()]).reshape(*p.connect.shape, 2)) for p in own])
        thick, linear = (np.concatenate([getattr(p, name) for p in own]) for name in ("thickness", "linear"))
        end = wall.origin + wall.length * wall.along
        joints = [
            (joint.name, wall.unfolded(mesh.xyz[joint.connect[:, :2].ravel()]).reshape(-1, 2, 2))
            for joint in mesh.joints
            if joint.wall == wall.name
        ]
        walls.append(Elevation(wall.name, wall.origin, end, np.unique(thick).tolist(), corner, linear, joints))
    with _putting(folder, "plan") as (scratch, names):
        if walls:
            draw_plan(scratch, "plan", walls, mesh.levels)
        else:
            parts = [(part.name, mesh.xyz[part.connect], part.thickness) for part in mesh.parts]
            feet = np.concatenate([mesh.xyz[foot.nodes] for foot in mesh.feet])
            draw_shells(scratch, "plan", parts, feet)
    return names["plan.png"]


def _as_quads(corner: np.ndarray) -> np.ndarray:
    """Corners (elements, 4, 2) of quadrilaterals, or of triangles with the last one twice."""
    return corner if corner.shape[1] == 4 else np.concatenate([corner, corner[:, -1:]], axis=1)


def write_solids(solids: "SolidAssembly", folder: Path) -> Path:
    """The picture of solids into a folder: geometry.png (and .svg). What extrados did not write there stays."""
    from extrados.show.geometry import draw_stones

    with _putting(folder, "geometry") as (scratch, names):
        draw_stones(scratch, "geometry", solids.parts, solids.owner, solids.polygon, solids.b < 0)
    return names["geometry.png"]
