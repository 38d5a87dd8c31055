"""Figures and report of a stored run: one self-contained HTML page, and PDF on A4."""

import contextlib
import os
import sys
import tempfile
import threading
from collections.abc import Callable, Iterator
from datetime import UTC, datetime
from functools import partial
from pathlib import Path

from extrados import kinds
from extrados.results import written
from extrados.results.store import REPORT, SUMMARY, Stored, StoreError, read, reason
from extrados.show import html, typeset
from extrados.show.building import draw_building
from extrados.show.drawn import figures_of
from extrados.show.forked import Lost, side_by_side
from extrados.show.language import Language
from extrados.show.telling import annexed, told
from extrados.show.template import Template, read_template

#: Figures of an analysis with their captions
Figures = list[tuple[str, str]]
#: The report on paper, its annex, and the source of both, which `typst compile` sets anew
PRINTED, ANNEX, SOURCE, ANNEX_SOURCE = "report.pdf", "annex.pdf", "report.typ", "annex.typ"


def draw(run: Stored, folder: Path) -> dict[str, Figures]:
    """Draw all figures of a run into folder/figures; analysis name -> (figure name, caption).

    StoreError if the stored results lack an array of a figure, or if a figure cannot be written.
    """
    shown = [a for a in run.analyses if a["kind"] in kinds.ANALYSES and run.arrays.get(a["name"])]
    (folder / "figures").mkdir(exist_ok=True)
    tasks = [(run, a["name"], figures_of(run, a["name"]), folder) for a in shown]
    return {a["name"]: figures for a, figures in zip(shown, _drawn(tasks), strict=True)}


def _draw_one(run: Stored, name: str, figures: Callable[..., Figures], folder: Path) -> Figures:
    """The figures of one analysis."""
    try:
        with _stored(run.folder, f"the figures of '{name}'"):
            return figures(run, name, folder)
    except OSError as error:
        raise StoreError(f"{run.folder}: the figures could not be written: {reason(error)}") from None


@contextlib.contextmanager
def _stored(folder: Path | None, what: str) -> Iterator[None]:
    """StoreError where what is made of stored results fails: they may have been changed, which no checksum shows."""
    try:
        yield
    except (StoreError, Lost, OSError, ImportError, MemoryError, SystemError):  # the file system, or memory that lacks
        raise
    except Exception as error:
        said = error.args[0] if error.args else error
        raise StoreError(
            f"{folder}: {what} cannot be made, because the results are damaged ({type(error).__name__}: {said}). "
            "If no other program has changed the results, report this as a fault of extrados"
        ) from error


def _drawn(tasks: list[tuple]) -> list[Figures]:
    """The figures of each analysis, drawn side by side where this process can fork and it is worth it.

    A process with threads of its own is not forked: one of them might hold a lock that the child then waits for.
    """
    workers = min(len(os.sched_getaffinity(0)) if sys.platform == "linux" else 1, len(tasks))
    if workers < 2 or threading.active_count() > 1:
        return [_draw_one(*task) for task in tasks]
    try:
        return side_by_side([partial(_draw_one, *task) for task in tasks], workers)
    except Lost as error:
        raise StoreError(f"{tasks[0][0].folder}: the figures could not be drawn: {error}. The results are kept") from None


def write_report(
    folder: Path, printed: bool | None = None, template: Path | None = None, language: str | None = None
) -> tuple[Path, dict[str, Figures]]:
    """Draw a stored run and write report.html: the report, and the figures with captions by analysis.

    printed: also report.pdf, its annex and their sources; None: where the run holds an assessment and the typesetter is there.
    template: the report.toml of an office; language: its code, in place of that of template and deck. Drawn aside and put in
    place when all is done. A figure or report that is there and was not written by extrados, or was changed since, stays:
    the new one is put beside it under another name, which is logged. StoreError where that is not possible.
    """
    folder = Path(folder)
    run = read(folder)
    office = Template() if template is None else read_template(Path(template))
    try:
        words = Language(language or office.table.language or run.summary["deck"].get("language") or "en")
    except ValueError as error:
        raise StoreError(str(error)) from None
    within = Path(os.path.abspath(folder)).parent
    if printed is None:
        printed = any(a["kind"] == "assess" for a in run.analyses) and typeset.available()
    try:
        with tempfile.TemporaryDirectory(prefix=f".{folder.name}.drawing-", dir=within) as place:
            scratch = Path(place)
            drawn = draw(run, scratch)
            with _stored(folder, "the report"):
                building = draw_building(run, scratch, words)
                if office.logo:
                    (scratch / f"figures/logo{office.suffix}").write_bytes(office.logo)
                document = told(run, drawn, building, _written_on(folder), office, words)
                made = {REPORT: html.page(document, scratch).encode(errors="backslashreplace")}
                if printed:
                    for name, source, part in ((PRINTED, SOURCE, document), (ANNEX, ANNEX_SOURCE, annexed(document))):
                        made[source] = typeset.markup(part, scratch).encode(errors="replace")
                        made[name] = typeset.pdf(made[source], scratch)
            for name, content in made.items():
                (scratch / name).write_bytes(content)
            with written.alone(within):
                ours = tuple(made)
                names = written.put(scratch, folder, lambda name: name in ours or name.startswith("figures/"))
    except OSError as error:
        raise StoreError(f"{folder}: the report could not be written: {reason(error)}") from None
    return folder / names[REPORT], drawn


def _written_on(folder: Path) -> str:
    """The day on which the results were written."""
    return datetime.fromtimestamp((folder / SUMMARY).stat().st_mtime, UTC).date().isoformat()
