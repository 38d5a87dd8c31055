"""extrados: masonry structures under earthquakes.

>>> import extrados
>>> run = extrados.run("deck.toml")
>>> run["tilt"]["collapse_acceleration_g"]
"""

from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from extrados.explore.widget import Page
    from extrados.running.live import Live
    from extrados.running.run import Run

__all__ = ["live", "load", "run", "widget"]


def run(
    deck: str | Path | dict[str, Any],
    out: str | Path | None = None,
    *,
    threads: int | None = None,
    figures: bool = False,
) -> "Run":
    """Run a deck (a file, or a dictionary of the same shape) in memory and return its results.

    With `out` they are also written there, on request with figures and report, and a long sweep keeps its finished
    batches beside that folder; `Run.write` does the same later. DeckError lists what is wrong with the deck,
    StoreError says why `out` cannot be written.
    """
    from extrados.analyses.context import Context, default_threads
    from extrados.running.run import compute, run_to

    context = Context(_checked(deck), threads or default_threads())
    return compute(context) if out is None else run_to(context, out, figures)


def live(deck: str | Path | dict[str, Any], *, threads: int | None = None) -> "Live":
    """A model of the deck (a file, or a dictionary of the same shape) that answers anew when a value changes.

    DeckError lists what is wrong with the deck.
    """
    from extrados.running.live import Live

    return Live(_checked(deck), threads)


def load(folder: str | Path) -> "Run":
    """The results of an earlier run, from its folder; StoreError where it holds none."""
    from extrados.running.run import Run

    return Run.read(folder)


def widget(deck: str | Path | None = None, *, height: int = 680) -> "Page":
    """The interactive page as a widget of a notebook (needs anywidget: pip install "extrados[notebook]"), `height` in pixels.

    `widget(...).deck` is the text of the deck as it stands in the page.
    """
    from extrados.explore.widget import Page

    return Page.of(None if deck is None else Path(deck), height)


def _checked(deck: str | Path | dict[str, Any]) -> Any:
    from extrados.decks.reader import make_deck, read_deck

    return make_deck(deck) if isinstance(deck, dict) else read_deck(deck)
