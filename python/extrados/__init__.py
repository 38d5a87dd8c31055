"""extrados: assessment of masonry structures under earthquakes.

>>> import extrados
>>> run = extrados.run("deck.toml")
>>> run["tilt"]["collapse_acceleration_g"]

A deck is a file, a dictionary of the same shape, or is made of objects, one for each table:

>>> arch = extrados.Arch(radius=10.0, thickness="1.5 m", embrace=157.5, voussoirs=7)
>>> run = extrados.run(extrados.deck(arch, [extrados.Tilt()]))
"""

from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from extrados.decks.reader import Deck
    from extrados.explore.widget import Page
    from extrados.running.live import Live
    from extrados.running.run import Run
    from extrados.running.sweep import Sweep

__all__ = ["DeckError", "deck", "export", "live", "load", "run", "scene", "sweep", "widget"]
#: What users may catch
ERRORS = ("DeckError", "Refused", "StoreError")


def deck(structure: Any = None, analysis: Any = None, *, folder: str | Path | None = None, **tables: Any) -> "Deck":
    """Make a checked deck from objects: `extrados.deck(extrados.Arch(...), [extrados.Tilt()], motion=..., joints=...)`.

    structure, analysis and the other tables: objects (`extrados.Arch`, `extrados.Rocking`, `extrados.Joints` ...) or
    dictionaries of the same keys. Numbers are in SI, angles in degrees; text with a unit is accepted ("20 cm"). `analysis`,
    `ties`, `dampers` and `hinges` may be lists. folder: where the program looks for files of the deck; default: the current
    folder. DeckError lists all errors of the deck.
    """
    from extrados import objects

    return objects.deck(structure, analysis, folder=folder, **tables)


def run(
    deck: "str | Path | dict[str, Any] | Deck", out: str | Path | None = None, *, threads: int | None = None, figures: bool = False
) -> "Run":
    """Run a deck (a file, a dictionary of the same shape, or the result of `extrados.deck`) in memory and return its results.

    out: a folder to which the results are also written; a long run keeps its finished batches beside this folder. `Run.write`
    writes the results later. figures: also draw figures and report. threads: number of threads; default: all cores of this
    process. DeckError lists the errors of the deck; StoreError gives the reason if `out` cannot be written.
    """
    from extrados.analyses.context import Context, default_threads
    from extrados.running.run import compute, run_to

    context = Context(_checked(deck), threads or default_threads(), threads_given=bool(threads))
    return compute(context) if out is None else run_to(context, out, figures)


def live(deck: "str | Path | dict[str, Any] | Deck", *, threads: int | None = None) -> "Live":
    """Make a live model of the deck (as in `run`), which calculates results again when a value changes.

    threads: number of threads; default: all cores of this process. DeckError lists the errors of the deck.
    """
    from extrados.running.live import Live

    return Live(_checked(deck), threads)


def sweep(deck: "str | Path | dict[str, Any] | Deck", over: Any, **how: Any) -> "Sweep":
    """Run a deck for many values of its keys, in memory: `extrados.sweep("deck.toml", over={"structure.thickness": [1.2,
    1.5]})`.

    over: keys as in `Live.update`, each with a list of values in SI or as text with a unit; all combinations are run. To run
    given combinations only: a list of dictionaries, or a pandas.DataFrame whose columns are keys.

    workers: 1; a number of processes on this machine; or the address of a dask scheduler, `"tcp://..."`.

    threads: number of threads in each process; default: all cores for one process, 1 for several.

    progress: True or False for a progress bar (default: on a terminal), or a function of (done, total, text).

    resume: a folder beside which finished batches are kept; the same call continues an interrupted sweep.

    Returns a `Sweep`: `.frame()` for pandas, `.dataset()` for xarray, with units. DeckError lists the errors of the deck or
    of a value. The row of a refused member gives the reason. Refused if no scheduler responds at the address.
    """
    from extrados.running.sweep import sweep

    return sweep(_checked(deck), over, **how)


def export(deck: "str | Path | dict[str, Any] | Deck", form: str, path: str | Path | None = None) -> str:
    """Return the building of a deck as text for another program, and write it to `path` if given.

    form: "compas", "udec", "3dec", "opensees", "opensees-frame" or "frame-tables". Lengths in m, forces in N. A file at
    `path` that extrados did not write, or that was changed since, is kept: the text goes to another name, which is logged.
    DeckError if the building has no such model.
    """
    from extrados.bridges import forms
    from extrados.results import written

    text = forms.exported(_checked(deck), form)
    if path is not None:
        written.put_one(Path(path), text.encode(errors="backslashreplace"))
    return text


def scene(deck: "str | Path | dict[str, Any] | Deck") -> Any:
    """Return the blocks of a deck as a pyvista.MultiBlock, one mesh per block under its name, in m (pip install pyvista)."""
    from extrados.bridges import forms

    return forms.scene(_checked(deck))


def load(folder: str | Path) -> "Run":
    """Read the results of an earlier run from its `folder`; StoreError if the folder contains no results."""
    from extrados.running.run import Run

    return Run.read(folder)


def widget(deck: "str | Path | dict[str, Any] | Deck | None" = None, *, height: int = 680) -> "Page":
    """Return the interactive page as a widget of a notebook (pip install "extrados[notebook]"); `height` in pixels.

    deck: as in `run`; default: a new arch. `widget(...).deck` is the present text of the deck on the page. DeckError lists
    the errors of a dictionary; the page itself shows the errors of a file.
    """
    from extrados.explore.widget import Page

    return Page.of(Path(deck) if isinstance(deck, str | Path) else None if deck is None else _checked(deck), height)


def _checked(deck: Any) -> Any:
    from extrados import objects
    from extrados.decks.reader import Deck, make_deck, read_deck

    if isinstance(deck, Deck):
        return deck
    return make_deck(objects.as_deck(deck)) if isinstance(deck, dict) else read_deck(deck)


def __getattr__(name: str) -> Any:
    """The objects of all tables, the errors that users catch, and the version."""
    if name == "__version__":
        from extrados._build_info import VERSION

        return VERSION
    if name in ERRORS:
        from extrados.analyses.context import Refused
        from extrados.decks.reader import DeckError
        from extrados.results.store import StoreError

        return {"DeckError": DeckError, "Refused": Refused, "StoreError": StoreError}[name]
    if not name[:1].isupper():
        raise AttributeError(f"module 'extrados' has no attribute '{name}'")
    from extrados import objects

    try:
        made = globals()[name] = objects.maker(name)
        return made
    except KeyError:
        import difflib

        near = difflib.get_close_matches(name, objects.names(), n=3, cutoff=0.5)
        hint = f"; did you mean {' or '.join(near)}?" if near else ""
        raise AttributeError(f"module 'extrados' has no table '{name}'{hint}") from None


def __dir__() -> list[str]:
    from extrados import objects

    return [*globals(), "__version__", *objects.names(), *ERRORS]
