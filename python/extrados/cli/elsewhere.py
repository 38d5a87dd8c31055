"""Commands that use the building of a deck outside a run: the interactive page, exports, import of a plan."""

from pathlib import Path
from typing import Annotated

import typer

from extrados.cli.terminal import errors, out_console


def explore(
    deck: Annotated[Path | None, typer.Argument(help="deck to open; default: a new arch")] = None,
    port: Annotated[int | None, typer.Option(min=1024, max=65535, help="port; default: 8737, or any free port")] = None,
    browser: Annotated[bool, typer.Option(help="whether the page is opened in a browser")] = True,
    classroom: Annotated[
        bool, typer.Option("--class", help="also start a classroom session, with a link and a QR code for the pupils")
    ] = False,
    address: Annotated[
        str, typer.Option(help="for --class: address of this machine on the local network; default: only this machine can open the pages")
    ] = "127.0.0.1",
    standalone: Annotated[
        Path | None,
        typer.Option(help="write a page that works without a server to this file, and exit; its sliders change one dimension and the tilt"),
    ] = None,
    pupils: Annotated[int, typer.Option(min=1, max=60, help="for --class: greatest number of pupils at the same time")] = 30,
) -> None:
    """Open the interactive page: drag the blocks, see the thrust. Only this machine can open it, unless --class is given."""
    from extrados.decks.reader import read_deck

    folder, first = Path.cwd().resolve(), None
    if deck is not None:
        with errors():
            read_deck(deck)
        place = deck.resolve()
        folder = folder if place.is_relative_to(folder) else place.parent
        first = place.relative_to(folder).as_posix()
    if standalone is not None:
        from extrados.explore.answers.standalone import write_page

        with errors():
            write_page(folder, first, standalone)
        out_console.say(f"Page:    {standalone}   ({standalone.stat().st_size / 1e6:.2f} MB)")
        return
    from extrados.explore.supervisor import BadAddress, ClassOptions
    from extrados.explore.supervisor import explore as serve_pages

    if not classroom and address != "127.0.0.1":
        raise typer.BadParameter("used only together with --class", param_hint="--address")
    try:
        options = ClassOptions(address, pupils) if classroom else None
    except BadAddress as error:
        raise typer.BadParameter(str(error), param_hint="--address") from None
    raise typer.Exit(serve_pages(folder, first, port, browser, lambda text: out_console.say(text), options))


def _forms(begun: str) -> list[str]:
    from extrados.bridges.forms import FORMS

    return [form for form in FORMS if form.startswith(begun)]


def export(
    deck: Annotated[Path, typer.Argument(help="the deck")],
    form: Annotated[
        str,
        typer.Option(
            "--to", help="compas, udec, 3dec, opensees, opensees-frame or frame-tables", autocompletion=_forms, show_default=False
        ),
    ],
    out: Annotated[
        Path | None, typer.Option(help="file to write; default: results/<deck name>-<format>, with the file extension of the format")
    ] = None,
) -> None:
    """Write the building of a deck for another program."""
    from extrados.bridges.forms import FORMS, exported
    from extrados.decks.reader import read_deck
    from extrados.results import written
    from extrados.results.store import StoreError, reason

    with errors():
        checked = read_deck(deck)
        text = exported(checked, form)
        place = out or checked.default_out.with_name(f"{checked.default_out.name}-{form}{FORMS[form][1]}")
        try:
            place.parent.mkdir(parents=True, exist_ok=True)
            place = written.put_one(place, text.encode(errors="backslashreplace"))
        except OSError as error:
            raise StoreError(f"{place}: cannot be written: {reason(error)}") from None
    out_console.say(f"{FORMS[form][2]}: {place}")


def import_plan(
    drawing: Annotated[Path, typer.Argument(help="plan of the building: a DXF drawing, or an IFC model")],
    walls: Annotated[
        list[str] | None, typer.Option("--walls", help="layer of the walls of a drawing; repeat the option for further layers")
    ] = None,
    openings: Annotated[
        list[str] | None, typer.Option("--openings", help="layer of the openings; without this option, gaps in the walls are openings")
    ] = None,
    thickness: Annotated[
        float | None,
        typer.Option(
            "--thickness", help="thickness [m] of walls that are drawn as single lines (axes); default: the lines are faces of walls"
        ),
    ] = None,
    storeys: Annotated[str, typer.Option("--storeys", help="heights [m] of the storeys from the ground up, such as 3.0,2.8")] = "3.0",
    unit: Annotated[str | None, typer.Option("--unit", help="length unit, if the drawing states none: m, cm, mm, in, ft")] = None,
) -> None:
    """Print a deck of a building from a plan in DXF (lines are the faces or axes of walls; openings are gaps, or have a layer), or from
    an IFC model (walls, openings and storeys)."""
    from extrados.bridges.plan_drawing import deck_of_file
    from extrados.bridges.plan_ifc import deck_of_ifc

    if drawing.suffix.lower() == ".ifc":
        with errors():
            print(deck_of_ifc(drawing), end="")
        return
    if not walls:
        raise typer.BadParameter("expected the layer of the walls", param_hint="--walls")
    try:
        heights = [float(part) for part in storeys.split(",")]
    except ValueError:
        raise typer.BadParameter(f"{storeys}: expected heights of the storeys in m, such as 3.0,2.8", param_hint="--storeys") from None
    if not all(0.5 < height < 20.0 for height in heights) or len(heights) > 50:
        raise typer.BadParameter(f"{storeys}: expected at most 50 heights of storeys, each between 0.5 and 20 m", param_hint="--storeys")
    if thickness is not None and not 0.0 < thickness < 5.0:
        raise typer.BadParameter(f"{thickness:g}: expected a thickness above 0 and below 5 m", param_hint="--thickness")
    with errors():
        print(deck_of_file(drawing, walls, openings or [], thickness, heights, unit), end="")
