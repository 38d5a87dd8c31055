"""extrados: masonry structures under earthquakes.

>>> import extrados
>>> run = extrados.run("deck.toml")
>>> run["tilt"]["collapse_acceleration_g"]

A deck may be a file, a dictionary of the same shape, or made of objects, one for each kind of table:

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
    """A checked deck from objects: `extrados.deck(extrados.Arch(...), [extrados.Tilt()], motion=..., joints=...)`.

    structure, analysis and the other tables are objects (`extrados.Arch`, `extrados.Rocking`, `extrados.Joints` ...) or
    dictionaries of the same keys, numbers in SI, angles in degrees, or text with a unit: "20 cm"; `analysis` may be a list
    of them, as may `ties`, `dampers` and `hinges`. folder: where files that the deck names are
    looked for; default the current one. DeckError lists all that is wrong.
    """
    from extrados import objects

    return objects.deck(structure, analysis, folder=folder, **tables)


def run(
    deck: "str | Path | dict[str, Any] | Deck", out: str | Path | None = None, *, threads: int | None = None, figures: bool = False
) -> "Run":
    """Run a deck (a file, a dictionary of the same shape, or what `extrados.deck` made) in memory and return its results.

    With `out`, a folder, they are also written there, with figures and report where `figures` asks for them, and a long sweep keeps its finished
    batches beside that folder; `Run.write` does the same later. threads: of the core, default all that this process may
    use. DeckError lists what is wrong with the deck, StoreError says why `out` cannot be written.
    """
    from extrados.analyses.context import Context, default_threads
    from extrados.running.run import compute, run_to

    context = Context(_checked(deck), threads or default_threads())
    return compute(context) if out is None else run_to(context, out, figures)


def live(deck: "str | Path | dict[str, Any] | Deck", *, threads: int | None = None) -> "Live":
    """A model of the deck (as `run` takes it) that answers anew when a value changes.

    threads: of the core, default all that this process may use. DeckError lists what is wrong with the deck.
    """
    from extrados.running.live import Live

    return Live(_checked(deck), threads)


def sweep(deck: "str | Path | dict[str, Any] | Deck", over: Any, **how: Any) -> "Sweep":
    """Run a deck for many values of its keys, in memory: `extrados.sweep("deck.toml", over={"structure.thickness": [1.2, 1.5]})`.

    over: keys as `Live.update` takes them, each with its values (n) in SI or as text with a unit: every value with every
    other. Or rows that belong together: a list of dictionaries, or a pandas.DataFrame whose columns are keys.

    workers: 1; a number of processes of this machine; or the address of a dask scheduler, `"tcp://..."`.

    threads: of the core within each process, default all of one process, 1 where there are several.

    progress: a bar, by default on a terminal; or a function of (done, total, text).

    resume: a folder beside which finished batches are kept, so that the same call goes on where it was stopped.

    Returns a `Sweep`: `.frame()` for pandas, `.dataset()` for xarray, with units. DeckError lists what is wrong with the
    deck or with a value; what a member is refused for stands in its row. Refused where no scheduler answers at an address.
    """
    from extrados.running.sweep import sweep

    return sweep(_checked(deck), over, **how)


def export(deck: "str | Path | dict[str, Any] | Deck", form: str, path: str | Path | None = None) -> str:
    """The building of a deck for another program; also written to `path`, where one is given, or beside what is there and
    extrados did not write or was changed since, which is logged.

    form: "compas", "udec", "3dec" or "opensees". Lengths in m, forces in N. Returns the text; DeckError where the building has no such view.
    """
    from extrados.bridges import forms
    from extrados.results import written

    text = forms.exported(_checked(deck), form)
    if path is not None:
        written.put_one(Path(path), text.encode(errors="backslashreplace"))
    return text


def scene(deck: "str | Path | dict[str, Any] | Deck") -> Any:
    """The stones of a deck as a pyvista.MultiBlock, one mesh a stone by its name, in m (pip install pyvista)."""
    from extrados.bridges import forms

    return forms.scene(_checked(deck))


def load(folder: str | Path) -> "Run":
    """The results of an earlier run, from its `folder`; StoreError where it holds none."""
    from extrados.running.run import Run

    return Run.read(folder)


def widget(deck: "str | Path | dict[str, Any] | Deck | None" = None, *, height: int = 680) -> "Page":
    """The interactive page as a widget of a notebook (needs anywidget: pip install "extrados[notebook]"), `height` in pixels.

    deck: as `run` takes it, default a new arch. `widget(...).deck` is the text of the deck as it stands in the page. DeckError
    lists the errors of a dictionary; the page itself shows the errors of a file.
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
