"""The command line. Exit codes: 0 done; 2 the deck is wrong; 3 refused or failed; 130 or 143 interrupted (Ctrl-C, SIGTERM)."""

import functools
import json
import logging
import os
import signal
import sys
from collections import namedtuple
from collections.abc import Callable
from contextlib import contextmanager
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from extrados import interrupts
from extrados._build_info import VERSION
from extrados.running.progress import Progress
from extrados.schema.text import printable

if TYPE_CHECKING:
    from rich.console import Console

    from extrados.running.check import Checked


class _Commands(typer.Typer):
    """Commands that a signal ends without a traceback, whatever they are doing, be it an import."""

    def command(self, *words: Any, **options: Any) -> Callable[[Callable], Callable]:
        add = super().command(*words, **options)

        def guarded(function: Callable) -> Callable:
            @functools.wraps(function)
            def call(*args: Any, **keywords: Any) -> Any:
                try:
                    return function(*args, **keywords)
                except KeyboardInterrupt:
                    err_console.say("interrupted")
                    raise typer.Exit(interrupts.exit_code()) from None

            add(call)
            return function

        return guarded


app = _Commands(no_args_is_help=True, pretty_exceptions_enable=False, help=__doc__)


class _Console:
    """A console of rich that is made when it is first used."""

    def __init__(self, stderr: bool):
        self._stderr = stderr

    @cached_property
    def _rich(self) -> "Console":
        from rich.console import Console

        return Console(stderr=self._stderr, highlight=False, soft_wrap=True)

    def say(self, text: str, style: str | None = None) -> None:
        """Print words, some of which others wrote: nothing in them is obeyed by the terminal."""
        self._rich.print(printable(text, keep="\n"), style=style, markup=False)

    def __getattr__(self, name: str) -> Any:
        return getattr(self._rich, name)


out_console, err_console = _Console(stderr=False), _Console(stderr=True)

WRONG_DECK, NOT_DONE = 2, 3


def _progress(quiet: bool) -> Progress:
    """How far a command is."""
    return Progress(quiet, lambda: err_console._rich, err_console.say)


@contextmanager
def _errors(json_out: bool = False):
    """Every error a user can cause ends as a message and an exit code, never as a traceback."""
    from extrados.decks.reader import DeckError
    from extrados.results.store import StoreError

    def tell(lines: list[str], code: int) -> None:
        if json_out:
            print(json.dumps({"error": lines, "exit": code}, indent=2))
        else:
            for line in lines:
                err_console.say(line)
        raise typer.Exit(code)

    try:
        yield
    except DeckError as error:
        tell(error.complaints, WRONG_DECK)
    except StoreError as error:
        tell([str(error)], NOT_DONE)
    except KeyboardInterrupt:
        tell(["interrupted"], interrupts.exit_code())


def _print_version(asked: bool) -> None:
    if asked:
        version()
        raise typer.Exit()


@app.callback()
def _options(
    version: Annotated[
        bool, typer.Option("--version", callback=_print_version, is_eager=True, help="version, commit and compilers")
    ] = False,
) -> None:
    pass


def _kinds(begun: str) -> list[str]:
    """The kinds that begin so, for the shell that completes a word."""
    from extrados import kinds

    return [kind for there in kinds.TABLES.values() for kind in there if kind.startswith(begun)]


def _words(begun: str) -> list[str]:
    """What `explain` knows that begins so."""
    from extrados.decks import manual, synonyms

    tables = manual.stored()
    known = [table.kind or table.section for table in tables]
    known += [f"{table.kind or table.section}.{name}" for table in tables for name in table.keys]
    known += [name.rsplit(".", 1)[-1] for table in tables for name in table.keys] + synonyms.words()
    return sorted({word for word in known if word.startswith(begun) and " " not in word})


@app.command()
def run(
    decks: Annotated[list[Path], typer.Argument(help="decks to run")],
    out: Annotated[Path | None, typer.Option(help="results folder; default results/<deck name>")] = None,
    threads: Annotated[int | None, typer.Option(min=1, help="threads of the core; default all")] = None,
    resume: Annotated[bool, typer.Option(help="go on from the checkpoint of an interrupted run")] = False,
    scheduler: Annotated[str, typer.Option(help="address of a dask scheduler that runs the sweeps")] = "",
    figures: Annotated[bool, typer.Option(help="draw figures and the report")] = True,
    quiet: Annotated[bool, typer.Option("--quiet", help="no progress, no answer")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="print summary.json instead of words")] = False,
) -> None:
    """Run decks: print the answer, write results, figures and report."""
    from extrados.analyses.context import Context
    from extrados.decks.reader import DeckError, read_deck
    from extrados.running.run import run_to

    if out is not None and len(decks) > 1:
        err_console.say("--out takes one deck at a time")
        raise typer.Exit(WRONG_DECK)
    worst = 0
    with _errors(as_json):
        checked = [read_deck(path) for path in decks]
        folders = [deck.default_out for deck in checked]
        twice = next((f for f in folders if folders.count(f) > 1), None)
        if twice is not None:
            raise DeckError([f"two decks would write to {twice}: run them one by one with --out"])
        for deck in checked:
            progress = _progress(quiet or as_json)
            tell = (lambda text: None) if quiet or as_json else out_console.say
            context = Context(deck, _threads(threads), progress, tell, resume=resume, scheduler=scheduler)
            try:
                found = run_to(context, out or deck.default_out, figures=False)
            finally:
                progress.stop()
            if as_json:
                print(json.dumps(json.loads((found.folder / "summary.json").read_bytes()), indent=2))
            elif not quiet:
                _tell(found, deck.title, len(deck.analyses))
            codes = {"ok": 0, "refused": NOT_DONE, "failed": NOT_DONE, "interrupted": interrupts.exit_code()}
            for result in found.results:
                if quiet and result.status != "ok":
                    err_console.say(f"{result.kind}: {result.status}: {result.reason}")
                worst = max(worst, codes[result.status])
            stopped = any(result.status == "interrupted" for result in found.results)
            _draw(found.folder, figures and not stopped, quiet or as_json)
            if stopped:
                break
    raise typer.Exit(worst)


def _threads(asked: int | None) -> int:
    """As many threads as asked for, but no more than there are cores."""
    from extrados.analyses.context import default_threads

    cores = default_threads()
    if asked is not None and asked > cores:
        err_console.say(f"--threads {asked}: this process may use {cores} cores, and starts no more threads than that")
    return min(asked or cores, cores)


def _tell(run, title: str, count: int | None = None) -> None:
    """The answers of a run, of its first `count` analyses: those of the deck, without what these have asked for."""
    if title:
        out_console.say(title, "bold")
    for row in run.analyses[:count]:
        if row["status"] != "ok":
            out_console.say(f"{row['name']}: {row['status']}: {row['reason']}")
        if row["answer"]:
            out_console.say(f"{row['name']}: {row['answer']}")
        for warning in row["warnings"]:
            out_console.say(f"{row['name']}: warning: {warning}")


def _draw(folder: Path, figures: bool, quiet: bool) -> None:
    """Draw figures and report of a run whose answer has been told, and say where all lies."""
    sys.stdout.flush()
    report = None
    if figures:
        try:
            from extrados.plots.report import write_report

            report = write_report(folder)[0]
        except KeyboardInterrupt:
            err_console.say(f"interrupted while drawing; the results are in {folder}: extrados report draws them")
            raise typer.Exit(interrupts.exit_code()) from None
    if quiet:
        return
    if report is None:
        out_console.say(f"Results: {folder}")
        return
    out_console.say(f"Report:  {report}")
    if (folder / "figures").is_dir():
        out_console.say(f"Figures: {folder / 'figures'}")


@app.command()
def motion(
    file: Annotated[str, typer.Argument(help="a record, or extrados:el-centro-1940")],
    out: Annotated[Path | None, typer.Option(help="results folder; default results/<file name>")] = None,
    time_step: Annotated[float | None, typer.Option(help="sampling step [s] where the file has none")] = None,
    unit: Annotated[str | None, typer.Option(help="unit where the file has none: g, m/s^2, cm/s^2 ...")] = None,
    channel: Annotated[
        str | None, typer.Option(help="channel of a file with several: number or part of its name")
    ] = None,
    baseline: Annotated[str, typer.Option(help="none, mean, linear, quadratic or cubic")] = "none",
    figures: Annotated[bool, typer.Option(help="draw figures and the report")] = True,
    as_json: Annotated[bool, typer.Option("--json", help="print summary.json instead of words")] = False,
) -> None:
    """What a ground motion is, on one page, without a deck."""
    from extrados.analyses.context import Context, default_threads
    from extrados.decks.reader import make_deck
    from extrados.running.run import run_to

    record = {
        "kind": "record",
        "file": file if file.startswith("extrados:") else str(Path(file).absolute()),
        "baseline": baseline,
    }
    record |= {k: v for k, v in {"time_step": time_step, "unit": unit}.items() if v is not None}
    if channel is not None:
        record["channel"] = int(channel) if channel.isascii() and channel.isdigit() and len(channel) < 10 else channel
    with _errors(as_json):
        deck = make_deck({"title": printable(Path(file).name), "motion": record, "analysis": {"kind": "motion"}})
        folder = out or Path("results") / Path(file.removeprefix("extrados:")).stem
        found = run_to(Context(deck, default_threads()), folder, figures=False)
        if as_json:
            print(json.dumps(json.loads((found.folder / "summary.json").read_bytes()), indent=2))
        else:
            _motion_page(found.results[0])
            _tell(found, deck.title)
        status = found.results[0].status
        _draw(found.folder, figures and status != "interrupted", as_json)
    raise typer.Exit({"ok": 0, "interrupted": interrupts.exit_code()}.get(status, NOT_DONE))


def _motion_page(result) -> None:
    """The numbers of one motion as a table."""
    from rich.table import Table

    if result.status != "ok":
        return
    table = Table(show_header=False, box=None, pad_edge=False)
    for key, value in result.results.items():
        if isinstance(value, dict | list):
            continue
        table.add_row(key, f"{value:.5g}" if isinstance(value, float) else str(value))
    for k, impulse in enumerate(result.results["impulses"], start=1):
        table.add_row(
            f"impulse {k}",
            f"{impulse['amplitude_g']:+.4g} g over {impulse['period_s']:.4g} s from {impulse['start_s']:.3f} s, "
            f"goodness {impulse['goodness_of_fit']:.2f}",
        )
    out_console.print(table)


@app.command()
def check(
    decks: Annotated[list[Path], typer.Argument(help="decks to check")],
    out: Annotated[
        Path | None,
        typer.Option(help="folder for the picture and the list of a survey; default results/<deck name>-check"),
    ] = None,
) -> None:
    """Check decks without running them: every complaint at once, and how the stones of a survey fit."""
    from extrados.decks.reader import DeckError, read_deck
    from extrados.running.check import check_building

    if out is not None and len(decks) > 1:
        err_console.say("--out takes one deck at a time")
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
        folder = out or deck.default_out.with_name(f"{deck.default_out.name}-check")
        if checked.inspection is not None:
            _tell_survey(checked, folder, asked=out is not None)
        if checked.solids is not None:
            _tell_solids(checked, folder, asked=out is not None or getattr(deck.structure, "file", None) is not None)
        if checked.plan is not None:
            _tell_plan(checked, folder)
    for line in complaints:
        err_console.say(line)
    if complaints:
        raise typer.Exit(WRONG_DECK)
    print("ok" if len(decks) == 1 else f"{len(decks)} decks ok")


MOST_PLACES = 40


def _tell_survey(checked: "Checked", folder: Path, asked: bool) -> None:
    """How the stones of a survey fit: its list on the terminal, all of it and its picture in a folder where there is
    anything to list, or the folder is asked for."""
    from rich.table import Table

    from extrados.running.check import write_check

    inspection = checked.inspection
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
        f"{len(amiss)} places amiss, {len(checked.places) - len(amiss)} closed within the tolerance")  # fmt: skip
    if not checked.places and not asked:
        return
    try:
        picture, table = write_check(checked, folder)
    except OSError as error:
        err_console.say(f"{folder}: the picture could not be written: {error.strerror or error}")
        return
    out_console.say(f"Picture: {picture}")
    out_console.say(f"List:    {table}")


def _tell_plan(checked: "Checked", folder: Path) -> None:
    """The size of a building's mesh, and its plan and elevations in a folder."""
    from extrados.running.check import write_plan
    from extrados.schema.constants import GRAVITY

    mesh = checked.plan
    for remark in checked.remarks:
        out_console.say(f"warning: {remark}")
    walls = f"{len(mesh.walls)} walls, " if mesh.walls else ""
    out_console.say(
        f"{walls}{mesh.elements()} elements, {len(mesh.xyz)} nodes; {'walls and floors weigh' if walls else 'weight'} "
        f"{1e-3 * GRAVITY * mesh.mass().sum():.4g} kN"
    )
    try:
        out_console.say(f"Picture: {write_plan(mesh, folder)}")
    except OSError as error:
        err_console.say(f"{folder}: the picture could not be written: {error.strerror or error}")


def _tell_solids(checked: "Checked", folder: Path, asked: bool) -> None:
    """How many solids touch along how many contacts; their picture where they come from a file, or the folder is asked for."""
    from extrados.running.check import write_solids

    solids = checked.solids
    for line in (*checked.notes, *(f"warning: {remark}" for remark in checked.remarks)):
        out_console.say(line)
    out_console.say(
        f"{len(solids.mass)} solids, {len(solids.a)} contacts, {int((solids.b < 0).sum())} of them on the ground"
    )
    if not asked:
        return
    try:
        out_console.say(f"Picture: {write_solids(solids, folder)}")
    except OSError as error:
        err_console.say(f"{folder}: the picture could not be written: {error.strerror or error}")


@app.command()
def schema(
    results: Annotated[bool, typer.Option("--results", help="that of summary.json instead")] = False,
) -> None:
    """Print the JSON Schema of decks, for editors, or of results."""
    if results:
        from extrados.results.explain import json_schema
    else:
        from extrados.decks.explain import json_schema

    print(json.dumps(json_schema(), indent=1))


@app.command()
def explain(
    words: Annotated[
        list[str] | None,
        typer.Argument(
            metavar="[WORD]",
            help="a key, a kind or a section of decks, or a word of the trade; results, results.KIND or results.KIND.KEY",
            autocompletion=_words,
        ),
    ] = None,
    manual: Annotated[bool, typer.Option("--manual", help="the whole reference manual of decks in Markdown")] = False,
    results: Annotated[
        bool, typer.Option("--results", help="the whole reference manual of results in Markdown")
    ] = False,
) -> None:
    """Say what a deck key, a kind or a result means: unit, default, bounds, source; and where a thing is found."""
    told: Any
    key = " ".join(words or [])
    if results or key.split(".")[0] == "results":
        from extrados.results import manual as told
    else:
        from extrados.decks import manual as told

    if manual or results or not key:
        print(told.manual(told.stored()))
        return
    try:
        print(told.explain(key, told.stored()))
    except KeyError as error:
        err_console.say(error.args[0])
        raise typer.Exit(WRONG_DECK) from None


@app.command()
def new(
    kind: Annotated[
        str | None,
        typer.Argument(help="a kind of analysis, structure or motion; default lists them", autocompletion=_kinds),
    ] = None,
) -> None:
    """Print a commented starter deck that runs as it is."""
    if kind is None:
        from extrados import kinds
        from extrados.decks import manual

        tables = manual.stored()
        for section in kinds.TABLES:
            out_console.say(f"{section}:", "bold")
            for table in tables:
                if table.section == section:
                    out_console.say(f"  {table.kind:16} {manual.first_sentence(table.summary)}")
        return
    from extrados.decks.explain import starter

    try:
        print(starter(kind))
    except KeyError as error:
        err_console.say(error.args[0])
        raise typer.Exit(WRONG_DECK) from None


@app.command()
def cases(
    folder: Annotated[
        Path | None, typer.Argument(help="where to look; default ./cases, else the cases that are shipped")
    ] = None,
) -> None:
    """List the decks below a folder with their titles."""
    import tomllib

    from extrados.decks.reader import LARGEST
    from extrados.schema import files
    from extrados.schema.places import CASES

    if folder is None:
        folder = here if (here := Path("cases")).is_dir() else CASES
    found = False
    for path in sorted(folder.rglob("*.toml")):
        if path.name.endswith(".expect.toml"):
            continue
        try:
            title = tomllib.loads(files.read(path, LARGEST).text()).get("title", "")
        except (ValueError, RecursionError):
            title = "(cannot be read)"
        out_console.say(f"{path}: {title}")
        found = True
    if not found:
        err_console.say(f"no decks below {folder}")
        raise typer.Exit(NOT_DONE)


@app.command()
def report(
    folder: Annotated[Path, typer.Argument(help="a results folder")],
    pdf: Annotated[bool | None, typer.Option(help="also report.pdf; default where the run holds an assessment")] = None,
) -> None:
    """Draw the figures and the report of stored results anew, as HTML and on A4 paper as PDF."""
    from extrados.plots.report import write_report

    with _errors():
        out_console.say(f"Report:  {write_report(folder, pdf)[0]}")


@app.command()
def compare(
    old: Annotated[Path, typer.Argument(help="a results folder")],
    new: Annotated[Path, typer.Argument(help="another one")],
    tolerance: Annotated[
        float, typer.Option(min=0.0, help="relative difference up to which numbers are the same")
    ] = 1e-9,
    page: Annotated[Path | None, typer.Option(help="also write the comparison as an HTML page")] = None,
    as_json: Annotated[bool, typer.Option("--json", help="print it as JSON")] = False,
) -> None:
    """What changed between two results: deck, verdicts, numbers, warnings, program."""
    from dataclasses import asdict

    from rich.table import Table

    from extrados.plots.comparing import MOST, document, row
    from extrados.results.compare import compare as compared
    from extrados.results.store import StoreError, read

    with _errors(as_json):
        found = compared(read(old), read(new), tolerance)
        if as_json:
            print(json.dumps(asdict(found), indent=2))
        elif found.same:
            out_console.say("Nothing but the time it took differs.")
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
                out_console.say(f"and {len(there) - MOST} smaller ones")
        for words, lines in (("gone", found.warnings_gone), ("new", found.warnings_new)):
            for line in lines if not as_json else ():
                out_console.say(f"warning {words}: {line}")
        if page is not None:
            from extrados.plots import html

            try:
                page.write_text(
                    html.page(document((str(old), str(new)), found), page.parent),
                    encoding="utf-8",
                    errors="backslashreplace",
                )
            except OSError as error:
                raise StoreError(f"{page}: cannot be written: {error.strerror or error}") from None


@app.command()
def assess(
    folder: Annotated[Path, typer.Argument(help="a folder of decks; common.toml gives them what they lack")],
    out: Annotated[Path | None, typer.Option(help="results folder; default results/<folder name>")] = None,
    threads: Annotated[int | None, typer.Option(min=1, help="threads of the core; default all")] = None,
    resume: Annotated[bool, typer.Option(help="go on from the checkpoint of an interrupted run")] = False,
    scheduler: Annotated[str, typer.Option(help="address of a dask scheduler that runs the buildings")] = "",
    figures: Annotated[bool, typer.Option(help="draw figures and reports")] = True,
    quiet: Annotated[bool, typer.Option("--quiet", help="no progress, no ranking")] = False,
) -> None:
    """Assess every building of a folder: a ranking, worst first, and a page for each."""
    from rich.table import Table

    from extrados.running.survey import assess_folder, decks_of

    with _errors():
        total = len(decks_of(folder))
        place = out or Path("results") / (folder.resolve().name or "survey")
        progress = _progress(quiet)
        try:
            rows = assess_folder(folder, place, _threads(threads), progress, resume, scheduler, figures)
        finally:
            progress.stop()
        table = Table(box=None, pad_edge=False)
        for head in ("rank", "building", "overall", "least margin", "of"):
            table.add_column(head)
        for k, one in enumerate(rows, 1):
            known = f"{one.least_margin:.3g}" if one.least_margin == one.least_margin else ""
            table.add_row(str(k), printable(one.building), one.overall or one.status, known, one.strategy)
        if not quiet:
            out_console.print(table)
            out_console.say(f"Ranking: {place / 'ranking.html'}")
    if len(rows) < total:
        err_console.say(f"{total - len(rows)} of {total} buildings are missing; --resume goes on from here")
        raise typer.Exit(interrupts.exit_code())
    raise typer.Exit(0 if all(one.status == "ok" for one in rows) else NOT_DONE)


@app.command()
def plot(folder: Annotated[Path, typer.Argument(help="a results folder")]) -> None:
    """Draw the figures and the report anew, and list the figures."""
    from extrados.plots.report import write_report

    with _errors():
        for figures in write_report(folder)[1].values():
            for name, caption in figures:
                out_console.say(f"{folder / 'figures' / name}.png: {caption}")


@app.command()
def explore(
    deck: Annotated[Path | None, typer.Argument(help="the deck to open; default a new arch")] = None,
    port: Annotated[
        int | None, typer.Option(min=1024, max=65535, help="port; default 8737, or any that is free")
    ] = None,
    browser: Annotated[bool, typer.Option(help="open the page in a browser")] = True,
) -> None:
    """Open the interactive page: drag the stones, see the thrust. It is served to this machine alone."""
    from extrados.decks.reader import read_deck

    folder, first = Path.cwd().resolve(), None
    if deck is not None:
        with _errors():
            read_deck(deck)
        place = deck.resolve()
        folder = folder if place.is_relative_to(folder) else place.parent
        first = place.relative_to(folder).as_posix()
    from extrados.explore.supervisor import explore as serve_pages

    raise typer.Exit(serve_pages(folder, first, port, browser, lambda text: out_console.say(text)))


def _forms(begun: str) -> list[str]:
    from extrados.bridges.forms import FORMS

    return [form for form in FORMS if form.startswith(begun)]


@app.command()
def export(
    deck: Annotated[Path, typer.Argument(help="the deck")],
    form: Annotated[
        str, typer.Option("--to", help="compas, udec, 3dec or opensees", autocompletion=_forms, show_default=False)
    ],
    out: Annotated[Path | None, typer.Option(help="file; default results/<deck name>.<ending>")] = None,
) -> None:
    """Write the building of a deck for another program."""
    from extrados.bridges.forms import FORMS, exported
    from extrados.decks.reader import read_deck
    from extrados.results.store import StoreError, reason

    with _errors():
        checked = read_deck(deck)
        text = exported(checked, form)
        place = out or checked.default_out.with_name(f"{checked.default_out.name}-{form}{FORMS[form][1]}")
        try:
            place.parent.mkdir(parents=True, exist_ok=True)
            place.write_text(text, encoding="utf-8")
        except OSError as error:
            raise StoreError(f"{place}: cannot be written: {reason(error)}") from None
    out_console.say(f"{FORMS[form][2]}: {place}")


@app.command()
def version() -> None:
    """Version, commit and compilers."""
    from extrados.running.provenance import provenance

    made = provenance()
    print(f"extrados {VERSION} {made['commit']} ({made['compiler']}, {made['build_type']})")


def main() -> None:
    """Run a command; see `extrados.__main__` for what comes before."""
    logging.basicConfig(level=logging.WARNING, format="%(message)s")
    for stream in (sys.stdout, sys.stderr):
        stream.reconfigure(errors="backslashreplace")  # a terminal may know ASCII alone
    code: int | str | None = 0
    try:
        try:
            interrupts.answer(interrupts.stop)
            app()
        except SystemExit as left:
            code = left.code
        except KeyboardInterrupt:
            code = interrupts.exit_code()
        except Exception:
            if not interrupts.asked:  # a library that was interrupted may call it an error of its own
                raise
            code = interrupts.exit_code()
        interrupts.answer(signal.SIG_IGN)  # what is to be done is done
        if code and interrupts.asked:
            code = interrupts.exit_code()  # typer has one of its own
            # CPython kills itself at its end where a text that it evaluated was interrupted, unless another follows
            namedtuple("Text", "")
        sys.stdout.flush()
    except OSError as error:
        # the reader of our output went away, as in `extrados cases | head`, or what it goes to is full
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        if not isinstance(error, BrokenPipeError):
            os.write(2, f"the output could not be written: {error.strerror}\n".encode())
        code = code or NOT_DONE
    sys.exit(code)


if __name__ == "__main__":
    main()
