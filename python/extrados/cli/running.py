"""Commands that calculate: decks, a single motion, a folder of buildings."""

import json
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from extrados import interrupts
from extrados.cli.terminal import NOT_DONE, WRONG_DECK, err_console, errors, out_console, progress_shown, usable_threads
from extrados.schema.text import printable

if TYPE_CHECKING:
    from extrados.results.model import Result
    from extrados.running.run import Run


def run(
    decks: Annotated[list[Path], typer.Argument(help="decks to run")],
    out: Annotated[Path | None, typer.Option(help="results folder; default: results/<deck name>")] = None,
    threads: Annotated[int | None, typer.Option(min=1, help="number of threads; default: one per core")] = None,
    resume: Annotated[bool, typer.Option(help="continue from the checkpoint of an interrupted run")] = False,
    scheduler: Annotated[str, typer.Option(help="address of a dask scheduler that runs the sweeps")] = "",
    figures: Annotated[bool, typer.Option(help="draw figures and the report")] = True,
    quiet: Annotated[bool, typer.Option("--quiet", help="print neither progress nor results")] = False,
    as_json: Annotated[bool, typer.Option("--json", help="print summary.json instead of text")] = False,
) -> None:
    """Run decks: print the conclusions, write results, figures and report."""
    from extrados.analyses.context import Context
    from extrados.decks.reader import DeckError, read_deck
    from extrados.running.run import run_to

    if out is not None and len(decks) > 1:
        err_console.say("--out needs a single deck: several decks would share one folder")
        raise typer.Exit(WRONG_DECK)
    worst = 0
    with errors(as_json):
        checked = [read_deck(path) for path in decks]
        folders = [deck.default_out for deck in checked]
        twice = next((f for f in folders if folders.count(f) > 1), None)
        if twice is not None:
            raise DeckError([f"two decks would write to the folder {twice}: run them separately, each with its own --out"])
        for deck in checked:
            progress = progress_shown(quiet or as_json)
            tell = (lambda text: None) if quiet or as_json else out_console.say
            given = threads is not None
            context = Context(deck, usable_threads(threads), progress, tell, resume=resume, scheduler=scheduler, threads_given=given)
            place = out or deck.default_out
            try:
                found = run_to(context, place, figures=False)
            finally:
                progress.stop()
            place = found.folder or place  # beside it where it holds what is not ours
            if as_json:
                print(json.dumps(json.loads((place / "summary.json").read_bytes()), indent=2))
            elif not quiet:
                _tell(found, deck.title, len(deck.analyses))
            codes = {"ok": 0, "refused": NOT_DONE, "failed": NOT_DONE, "interrupted": interrupts.exit_code()}
            for result in found.results:
                if quiet and result.status != "ok":
                    err_console.say(f"{result.kind}: {result.status}: {result.reason}")
                worst = max(worst, codes[result.status])
            stopped = any(result.status == "interrupted" for result in found.results)
            _draw(place, figures and not stopped, quiet or as_json)
            if stopped:
                break
    raise typer.Exit(worst)


def motion(
    file: Annotated[str, typer.Argument(help="file of a record, or a shipped record: extrados:el-centro-1940")],
    out: Annotated[Path | None, typer.Option(help="results folder; default: results/<file name>")] = None,
    time_step: Annotated[float | None, typer.Option(help="time step [s], if the file states none")] = None,
    unit: Annotated[str | None, typer.Option(help="unit of acceleration, if the file states none: g, m/s^2, cm/s^2 ...")] = None,
    channel: Annotated[str | None, typer.Option(help="channel to read, if the file has several: its number or a part of its name")] = None,
    columns: Annotated[
        str | None,
        typer.Option(
            help="meaning of several columns in a file without times. series: the rows are one series, row after "
            "row; components: each column is one component (choose with --channel)"
        ),
    ] = None,
    baseline: Annotated[str, typer.Option(help="baseline correction: none, mean, linear, quadratic or cubic")] = "none",
    figures: Annotated[bool, typer.Option(help="draw figures and the report")] = True,
    as_json: Annotated[bool, typer.Option("--json", help="print summary.json instead of text")] = False,
) -> None:
    """Describe a ground motion without a deck: intensities, spectra and primary impulses, in one report."""
    from extrados.analyses.context import Context, default_threads
    from extrados.decks.reader import make_deck
    from extrados.running.run import run_to

    record: dict[str, float | str] = {
        "kind": "record",
        "file": file if file.startswith("extrados:") else str(Path(file).absolute()),
        "baseline": baseline,
    }
    record |= {k: v for k, v in {"time_step": time_step, "unit": unit, "columns": columns}.items() if v is not None}
    if channel is not None:
        record["channel"] = int(channel) if channel.isascii() and channel.isdigit() and len(channel) < 10 else channel
    with errors(as_json):
        deck = make_deck({"title": printable(Path(file).name), "motion": record, "analysis": {"kind": "motion"}})
        name = Path(file.removeprefix("extrados:")).stem
        folder = out or Path("results") / (name if name.strip(".") else "motion")
        found = run_to(Context(deck, default_threads()), folder, figures=False)
        folder = found.folder or folder  # beside it where it holds what is not ours
        if as_json:
            print(json.dumps(json.loads((folder / "summary.json").read_bytes()), indent=2))
        else:
            _motion_page(found.results[0])
            _tell(found, deck.title)
        status = found.results[0].status
        _draw(folder, figures and status != "interrupted", as_json)
    raise typer.Exit({"ok": 0, "interrupted": interrupts.exit_code()}.get(status, NOT_DONE))


def assess(
    folder: Annotated[Path, typer.Argument(help="a folder of decks; common.toml holds their defaults")],
    out: Annotated[Path | None, typer.Option(help="results folder; default: results/<folder name>")] = None,
    threads: Annotated[int | None, typer.Option(min=1, help="number of threads; default: one per core")] = None,
    resume: Annotated[bool, typer.Option(help="continue from the checkpoint of an interrupted run")] = False,
    scheduler: Annotated[str, typer.Option(help="address of a dask scheduler that runs the buildings")] = "",
    figures: Annotated[bool, typer.Option(help="draw figures and reports")] = True,
    quiet: Annotated[bool, typer.Option("--quiet", help="print neither progress nor the ranking")] = False,
) -> None:
    """Assess every building of a folder: a report for each, and a ranking with the worst first."""
    from rich.table import Table

    from extrados.running.survey import assess_folder, decks_of

    with errors():
        total = len(decks_of(folder))
        place = out or Path("results") / (folder.resolve().name or "survey")
        progress = progress_shown(quiet)
        try:
            rows = assess_folder(folder, place, usable_threads(threads), progress, resume, scheduler, figures)
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
        err_console.say(f"{total - len(rows)} of {total} buildings were not assessed; --resume continues with them")
        raise typer.Exit(interrupts.exit_code())
    raise typer.Exit(0 if all(one.status == "ok" for one in rows) else NOT_DONE)


def _tell(run: "Run", title: str, count: int | None = None) -> None:
    """Print the results of the first `count` analyses of a run: those of the deck, without the parts that they have run."""
    if title:
        out_console.say(title, "bold")
    for condition in run.summary["deck"]["conditions"]:
        out_console.say(f"condition: {condition}")
    for row in run.analyses[:count]:
        if row["status"] != "ok":
            out_console.say(f"{row['name']}: {row['status']}: {row['reason']}")
        if row["answer"]:
            out_console.say(f"{row['name']}: {row['answer']}")
        for warning in row["warnings"]:
            out_console.say(f"{row['name']}: warning: {warning}")


def _draw(folder: Path, figures: bool, quiet: bool) -> None:
    """Draw figures and report of a run whose results are printed, and print the places of the files."""
    sys.stdout.flush()
    report = None
    if figures:
        try:
            from extrados.show.report import write_report

            report = write_report(folder)[0]
        except KeyboardInterrupt:
            err_console.say(f"interrupted while drawing; the results are in {folder}. To draw them: extrados report {folder}")
            raise typer.Exit(interrupts.exit_code()) from None
    if quiet:
        return
    if report is None:
        out_console.say(f"Results: {folder}")
        return
    out_console.say(f"Report:  {report}")
    if (folder / "figures").is_dir():
        out_console.say(f"Figures: {folder / 'figures'}")


def _motion_page(result: "Result") -> None:
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
            f"{impulse['amplitude_g']:+.4g} g, period {impulse['period_s']:.4g} s, from {impulse['start_s']:.3f} s on, "
            f"goodness of fit {impulse['goodness_of_fit']:.2f}",
        )
    out_console.print(table)
