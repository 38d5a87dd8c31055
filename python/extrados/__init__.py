"""extrados: masonry structures under earthquakes.

>>> import extrados
>>> run = extrados.run("deck.toml")
>>> run["tilt"]["collapse_acceleration_g"]
"""

from pathlib import Path
from typing import Any

__all__ = ["load", "run"]


def run(
    deck: str | Path | dict[str, Any],
    out: str | Path | None = None,
    *,
    threads: int | None = None,
    figures: bool = False,
):
    """Run a deck (a file, or a dictionary of the same shape) and return its stored results.

    DeckError lists what is wrong with the deck. Without `out`, a deck file writes to results/<deck name> and a
    dictionary to a temporary folder that is gone afterwards.
    """
    import tempfile

    from extrados.analyses.context import Context, default_threads
    from extrados.decks.reader import make_deck, read_deck
    from extrados.results.store import read
    from extrados.session import run_deck

    checked = make_deck(deck) if isinstance(deck, dict) else read_deck(deck)
    context = Context(checked, threads or default_threads())
    if out is None and isinstance(deck, dict):
        with tempfile.TemporaryDirectory() as folder:
            return read(run_deck(context, Path(folder) / "run", figures)[0])
    return read(run_deck(context, Path(out) if out is not None else None, figures)[0])


def load(folder: str | Path):
    """The stored results of an earlier run."""
    from extrados.results.store import read

    return read(folder)
