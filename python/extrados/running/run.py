"""A whole run: deck and analyses in memory; on request a results folder with figures and report."""

import contextlib
import shutil
import signal
import threading
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from extrados.analyses.context import Context, Refused
from extrados.analyses.sequence import run_analyses
from extrados.decks.reader import Deck
from extrados.results import checkpoint, store
from extrados.results.model import Result, Streamed
from extrados.results.store import Stored
from extrados.results.verdict import KindResults
from extrados.running.described import described
from extrados.running.notebook import page_of
from extrados.running.provenance import computed, provenance

if TYPE_CHECKING:
    from extrados.show.drawn import Drawn


class Run(Stored):
    """The results of a deck, calculated in memory or read from a folder; both are used in the same way.

    `results` are the results calculated by this process, in the order of the deck; empty for a run read from a folder.
    """

    results: tuple[Result, ...] = ()

    @classmethod
    def of(cls, deck: Deck, results: list[Result]) -> "Run":
        """The run of a deck from its results, the parts of its analyses after them; it has no folder yet."""
        parts = [part for result in results for part in result.parts]
        results = [*results, *parts]
        when = computed()
        run = cls(None, partial(_head, deck, parts, when), store.rows(results), store.arrays_of(results), store.typed_of(results))
        run.results = tuple(results)
        return run

    @classmethod
    def read(cls, folder: str | Path) -> "Run":
        """The run in a `folder`; StoreError if it is damaged."""
        found = store.read(folder)
        return cls(found.folder, found.head, found.analyses, found.arrays)

    def __getitem__(self, name: str) -> KindResults:
        """The results of an analysis by its name, for instance run["tilt"].collapse_acceleration_g, or as of a mapping.

        An analysis without results raises its reason: Refused if it was refused, RuntimeError if it failed or was
        interrupted. KeyError if there is no such analysis; StoreError if stored results are not what this version gives.
        """
        row = self.analysis(name)
        if row["status"] != "ok" and not row["results"]:
            raise (Refused if row["status"] == "refused" else RuntimeError)(f"{name}: {row['status']}: {row['reason']}")
        return super().__getitem__(name)

    def _repr_html_(self) -> str:
        """In a notebook: a short table and the main figure, never the arrays."""
        return page_of(self)

    def plot(self, analysis: str) -> "Drawn":
        """The figures of an analysis as objects of matplotlib. A notebook shows them, `.save(folder)` writes them,
        `["tilt-collapse"]` selects one. KeyError if the run has no analysis of this name."""
        from extrados.show.drawn import draw

        return draw(self, analysis)

    def write(self, folder: str | Path, figures: bool = True) -> Path:
        """Write the results into `folder`, replacing an earlier run, and draw figures and report unless `figures` is False.

        A killed write leaves the old folder or the new one; Ctrl-C waits until the results are written. Only unchanged files
        of extrados are replaced. If `folder` contains anything else, the results go to another folder, which is logged.
        Returns the folder; StoreError if it cannot be written.
        """
        making = store.NewFolder(Path(folder))
        with _after_writing(), making as scratch:
            if self.results:
                store.write(scratch, self.head(), list(self.results))
            else:
                for name in (store.SUMMARY, *self.summary["files"]):
                    (scratch / name).parent.mkdir(parents=True, exist_ok=True)
                    shutil.copyfile(self.folder / name, scratch / name)
        self.folder = Path(folder) if making.place == making.out else making.place
        if any(isinstance(a.data, Streamed) for arrays in self.arrays.values() for a in arrays.values()):
            self.arrays = store.read(self.folder).arrays  # what lay beside the folder until now lies in it
        if figures:  # the results are safe by now, whatever happens while drawing
            from extrados.show.report import write_report

            write_report(self.folder)
        return self.folder


def _head(deck: Deck, parts: list[Result], when: dict[str, str]) -> dict[str, Any]:
    """What summary.json says besides the analyses."""
    resolved = deck.resolved()
    resolved["analysis"] += [part.asked for part in parts]
    return {
        "extrados": provenance(),
        "deck": {
            "path": deck.path,
            "sha256": deck.identity,
            "title": deck.title,
            "note": deck.note,
            "project": deck.project,
            "author": deck.author,
            "date": deck.date,
            **{word: deck.data.get(word, "") for word in ("client", "office", "reviewer", "revision", "language")},
            **described(deck),
            "resolved": resolved,
        },
        "computed": when,
    }


def compute(context: Context) -> Run:
    """Run all analyses of a deck in memory; the result of a refused or failed analysis gives the reason."""
    return Run.of(context.deck, run_analyses(context))


def run_to(context: Context, out: str | Path, figures: bool = True) -> Run:
    """Run a deck into a folder: refused at the start if the folder cannot be written, resumable from the batches beside it."""
    deck, out = context.deck, Path(out)
    store.prepare(out)
    context.out = out
    if context.resume:
        checkpoint.refuse_other_deck(out, deck.identity)
    try:
        run = compute(context)
        run.write(out, figures)
        if all(r.status in ("ok", "refused") for r in run.results):
            checkpoint.discard(out)
    finally:
        checkpoint.let_go(out)
    return run


@contextlib.contextmanager
def _after_writing() -> Iterator[None]:
    """Ctrl-C while results are written waits until they are: a long run is not lost in its last moment."""
    asked: list[int] = []
    before = {}
    if threading.current_thread() is threading.main_thread():
        for number in (signal.SIGINT, signal.SIGTERM):
            before[number] = signal.signal(number, lambda number, _: asked.append(number))
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
    if asked:
        signal.raise_signal(asked[-1])
