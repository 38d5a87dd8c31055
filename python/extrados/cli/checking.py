"""The command `check`: errors of decks, and the fit of blocks, solids and meshes, without a run."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from extrados.cli.terminal import WRONG_DECK, err_console, out_console

if TYPE_CHECKING:
    from extrados.running.check import Checked

MOST_PLACES = 40


def check(
    decks: Annotated[list[Path], typer.Argument(help="decks to check")],
    out: Annotated[
        Path | None,
        typer.Option(help="folder for the picture, and for the list of gaps and overlaps of a survey; default: results/<deck name>-check"),
    ] = None,
) -> None:
    """Check decks without a run: list all errors together, and the gaps and overlaps between the stones of a survey."""
    from extrados.decks.reader import DeckError, read_deck
    from extrados.running.check import check_building

    if out is not None and len(decks) > 1:
        err_console.say("--out needs a single deck: several decks would share one folder")
        raise typer.Exit(WRONG_DECK)
    complaints = []
    for path in decks:
        try:
            deck = read_deck(path)
        except DeckError as error:
            complaints += error.complaints
            continue
        checked = check_building(deck)
        complaints += checked.complaints
        for remark in checked.ignored:
            out_console.say(f"warning: {remark}")
        for line in checked.foretold:
            out_console.say(line)
        folder = out or deck.default_out.with_name(f"{deck.default_out.name}-check")
        _tell_survey(checked, folder, asked=out is not None)
        _tell_solids(checked, folder, asked=out is not None or getattr(deck.structure, "file", None) is not None)
        _tell_plan(checked, folder)
    for line in complaints:
        err_console.say(line)
    if complaints:
        raise typer.Exit(WRONG_DECK)
    print("ok" if len(decks) == 1 else f"{len(decks)} decks ok")


def _tell_survey(checked: "Checked", folder: Path, asked: bool) -> None:
    """Print the list of gaps and overlaps of a survey. Write the list and its picture into a folder if it has entries, or if the
    folder is requested."""
    from rich.table import Table

    from extrados.running.check import write_check

    inspection = checked.inspection
    if inspection is None:
        return
    for line in (*checked.notes, *(f"warning: {remark}" for remark in checked.remarks)):
        out_console.say(line)
    amiss = [row for row in checked.places if row.status != "closed"]
    if amiss:
        table = Table(box=None, pad_edge=False)
        for title in ("", "what", "between", "depth [mm]", "x [m]", "y [m]", "mended by"):
            table.add_column(title, justify="left" if title in ("what", "between", "mended by") else "right")
        for k, row in enumerate(amiss[:MOST_PLACES], start=1):
            depth = "" if row.depth is None else f"{1e3 * row.depth:.3g}"
            table.add_row(str(k), row.what, row.between, depth, *(f"{v:.3f}" for v in row.place), row.mended_by)
        out_console.print(table)
        if len(amiss) > MOST_PLACES:
            out_console.say(f"and {len(amiss) - MOST_PLACES} more")
    grounded = int((inspection.contacts.b < 0).sum())
    out_console.say(
        f"{len(inspection.outlines)} stones, {len(inspection.contacts.a)} joints, {grounded} of them on the ground; "
        f"{len(amiss)} faulty places, {len(checked.places) - len(amiss)} more closed within the tolerance"
    )
    if not checked.places and not asked:
        return
    with _said_if_unwritten(folder):
        picture, places = write_check(checked, folder)
        out_console.say(f"Picture: {picture}")
        out_console.say(f"List:    {places}")


@contextmanager
def _said_if_unwritten(folder: Path) -> Iterator[None]:
    """Pictures that cannot be written into the folder are reported, and nothing else stops."""
    try:
        yield
    except OSError as error:
        err_console.say(f"{folder}: the picture could not be written: {error.strerror or error}")


def _tell_plan(checked: "Checked", folder: Path) -> None:
    """The size of a building's mesh, and its plan and elevations in a folder."""
    from extrados.running.check import write_plan
    from extrados.schema.constants import GRAVITY

    mesh = checked.plan
    if mesh is None:
        return
    for remark in checked.remarks:
        out_console.say(f"warning: {remark}")
    walls = f"{len(mesh.walls)} wall{'s' if len(mesh.walls) > 1 else ''}, " if mesh.walls else ""
    out_console.say(
        f"{walls}{mesh.elements()} elements, {len(mesh.xyz)} nodes; {'walls and floors weigh' if mesh.walls else 'weight'} "
        f"{1e-3 * GRAVITY * mesh.mass().sum():.4g} kN"
    )
    with _said_if_unwritten(folder):
        out_console.say(f"Picture: {write_plan(mesh, folder)}")


def _tell_solids(checked: "Checked", folder: Path, asked: bool) -> None:
    """Print the numbers of solids and contacts. Write their picture if they are from a file, or if the folder is requested."""
    from extrados.running.check import write_solids

    solids = checked.solids
    if solids is None:
        return
    for line in (*checked.notes, *(f"warning: {remark}" for remark in checked.remarks)):
        out_console.say(line)
    out_console.say(f"{len(solids.mass)} solids, {len(solids.a)} contacts, {int((solids.b < 0).sum())} of them on the ground")
    if not asked:
        return
    with _said_if_unwritten(folder):
        out_console.say(f"Picture: {write_solids(solids, folder)}")
