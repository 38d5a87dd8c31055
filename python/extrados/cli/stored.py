"""Commands on stored results: redraw, list, compare."""

import json
from pathlib import Path
from typing import Annotated

import typer

from extrados.cli.terminal import errors, out_console
from extrados.schema.text import printable


def report(
    folder: Annotated[Path, typer.Argument(help="a results folder")],
    pdf: Annotated[bool | None, typer.Option(help="also write report.pdf; default: only for a run with an assessment")] = None,
    template: Annotated[
        Path | None,
        typer.Option(help="file report.toml with the layout of an office: logo, colour, title block, order and choice of sections"),
    ] = None,
    language: Annotated[
        str | None, typer.Option(help="language of the report: en, it, es, fr or de; default: that of the template, or that of the deck")
    ] = None,
) -> None:
    """Draw figures and report of stored results again: as HTML, and as PDF on A4 with its source report.typ."""
    from extrados.show.report import write_report

    with errors():
        out_console.say(f"Report:  {write_report(folder, pdf, template, language)[0]}")


def plot(
    folders: Annotated[list[Path], typer.Argument(help="results folders")],
    together: Annotated[
        Path | None, typer.Option(help="one picture with the capacity curves of all runs: a .png file, with a .svg file beside it")
    ] = None,
) -> None:
    """Draw figures and report again and list the figures. With --together: the capacity curves of several runs in one picture."""
    from extrados.show.report import write_report

    with errors():
        if together is not None:
            _together(folders, together)
            return
        for folder in folders:
            for figures in write_report(folder)[1].values():
                for name, caption in figures:
                    out_console.say(f"{folder / 'figures' / name}.png: {caption}")


def _together(folders: list[Path], picture: Path) -> None:
    """One picture of all load curves, and the greatest load of each beside that of the first."""
    from rich.table import Table
    from rich.text import Text

    from extrados.results.store import read
    from extrados.show.together import draw, pushes

    curves = pushes([(str(folder), read(folder)) for folder in folders])
    table = Table(box=None, pad_edge=False)
    for head in ("run", "load to", "greatest load [kN]", "at [mm]", "over its weight", "over the first"):
        table.add_column(Text(head), overflow="fold")
    first, _ = curves[0].greatest()
    for curve in curves:
        load, at = curve.greatest()
        share = "" if curve.weight is None else f"{load / curve.weight:.3g}"
        ratio = f"{load / first:.3g}" if first > 0.0 else ""
        row = (curve.analysis, curve.sense, f"{load / 1e3:.4g}", f"{1e3 * at:.3g}", share, ratio)
        table.add_row(*(Text(printable(text)) for text in row))
    out_console.print(table)
    out_console.say(f"Curves:  {draw(curves, picture)}")


def compare(
    old: Annotated[Path, typer.Argument(help="a results folder")],
    new: Annotated[Path, typer.Argument(help="results folder with which this run is compared")],
    tolerance: Annotated[float, typer.Option(min=0.0, help="relative difference up to which two numbers are equal")] = 1e-9,
    page: Annotated[Path | None, typer.Option(help="also write the comparison as an HTML page")] = None,
    as_json: Annotated[bool, typer.Option("--json", help="print the comparison as JSON")] = False,
) -> None:
    """List the changes between two results: deck, verdicts, numbers, warnings, program."""
    from dataclasses import asdict

    from rich.table import Table

    from extrados.results.compare import compare as compared
    from extrados.results.store import StoreError, read
    from extrados.show.comparing import MOST, document, row

    with errors(as_json):
        found = compared(read(old), read(new), tolerance)
        if as_json:
            print(json.dumps(asdict(found), indent=2))
        elif found.same:
            out_console.say("Only the computing time differs.")
        tables = {"verdicts": found.verdicts, "deck": found.deck, "program": found.program, **found.numbers}
        for title, there in tables.items() if not as_json else ():
            if not there:
                continue
            table = Table(box=None, pad_edge=False, title=printable(title), title_justify="left")
            for head in ("key", "before", "after", "after / before"):
                table.add_column(head, overflow="fold")
            for change in there[:MOST]:
                table.add_row(*(printable(text) for text in row(change)))
            out_console.print(table)
            if len(there) > MOST:
                out_console.say(f"and {len(there) - MOST} smaller differences")
        for words, lines in (("gone", found.warnings_gone), ("new", found.warnings_new)):
            for line in lines if not as_json else ():
                out_console.say(f"warning {words}: {line}")
        if page is not None:
            from extrados.results import written
            from extrados.show import html

            try:
                text = html.page(document((str(old), str(new)), found), page.parent)
                written.put_one(page, text.encode(errors="backslashreplace"))
            except OSError as error:
                raise StoreError(f"{page}: cannot be written: {error.strerror or error}") from None
