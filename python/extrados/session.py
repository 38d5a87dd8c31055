"""A whole run: deck, analyses, results folder, figures and report."""

import contextlib
import signal
import subprocess
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from extrados._build_info import BUILD_TYPE, C_COMPILER, COMPILER, VERSION
from extrados.analyses.context import Context
from extrados.analyses.run import run_analyses
from extrados.decks.reader import Deck
from extrados.results import checkpoint, store
from extrados.results.model import Result


def provenance() -> dict[str, Any]:
    """Version, commit and compilers of this copy."""
    commit = ""
    folder = Path(__file__).resolve().parent
    root = folder.parents[1]
    # Only a checkout of this project is asked: git would also answer for a repository that happens to lie around.
    if (root / ".git").exists() and (root / "python" / "extrados") == folder:
        with contextlib.suppress(OSError, subprocess.TimeoutExpired):
            answer = subprocess.run(
                ["git", "-C", str(root), "describe", "--always", "--dirty", "--exclude=*"],
                capture_output=True, text=True, timeout=5,
            )  # fmt: skip
            commit = answer.stdout.strip() if answer.returncode == 0 else ""
    return {
        "version": VERSION,
        "commit": commit,
        "compiler": f"{COMPILER}, {C_COMPILER}",
        "build_type": BUILD_TYPE,
    }


def default_out(deck: Deck) -> Path:
    """results/<deck name> below the current folder."""
    return Path("results") / (Path(deck.path).stem or "deck")


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
        raise KeyboardInterrupt


def run_deck(context: Context, out: Path | None = None, figures: bool = True) -> tuple[Path, list[Result]]:
    """Run a deck and write its folder (default results/<deck name>); the folder and the results."""
    deck = context.deck
    out = Path(out) if out is not None else default_out(deck)
    store.prepare(out)
    context.out = out
    if context.resume:
        checkpoint.refuse_other_deck(out, deck.identity)
    results = run_analyses(context)
    with _after_writing(), store.new_folder(out) as folder:
        head = {
            "extrados": provenance(),
            "deck": {
                "path": deck.path,
                "sha256": deck.identity,
                "title": deck.title,
                "note": deck.note,
                "resolved": deck.resolved(),
            },
        }
        store.write(folder, head, results)
    if figures:  # the results are safe by now, whatever happens while drawing
        from extrados.plots.report import write_report

        write_report(out)
    if all(r.status in ("ok", "refused") for r in results):
        checkpoint.discard(out)
    return out, results
