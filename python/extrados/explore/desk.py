"""The state of one page: a deck with its text and its live model, and the picture of it."""

import shutil
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from extrados.explore import rocking, statics
from extrados.explore.document import Document
from extrados.explore.folder import Folder, NotThere
from extrados.explore.handles import Handle
from extrados.running.live import Live

NEW_DECK = """title = "A new arch"

[structure]
kind = "arch"
radius = 5.0
thickness = 0.75
embrace = 157.5
voussoirs = 36

[[analysis]]
kind = "tilt"
"""


class Desk:
    """A deck and how it is looked at.

    folder, first: the working folder, and the deck of it that is opened first; first_text: the deck that is opened if `first` names
    none. place, name: where the files lie that the deck names, and how the deck is called. document, live: its text, written when it is
    asked for, and its model; both always say the same. view, picture, handles: what is drawn, and what hands can take hold of. anchor:
    the place of the building that is the origin of the drawing [m]; held: the same, as long as a hand holds it. maps: maps of pulses by
    what they were made of.
    """

    def __init__(self, folder: Path, first: str | None = None):
        self.folder, self.first, self.first_text = Folder(folder), first, NEW_DECK
        self.place: Path = folder
        self.name = "deck.toml"
        self.document = Document(NEW_DECK)
        self.live: Live | None = None
        self.view = statics.View()
        self.picture: statics.Picture | None = None
        self.handles: dict[str, Handle] = {}
        self.anchor = np.zeros(2)
        self.held: np.ndarray | None = None
        self.maps: dict[str, tuple[dict[str, Any], dict[str, np.ndarray]]] = {}
        self.scratch: Path | None = None

    #: Whether decks name no file but shipped ones
    shipped_alone = False

    def check(self) -> None:
        """DeckError if the deck at hand is not for this desk."""

    def spend(self, seconds: float) -> float:
        """Note computing time; how long the page waits for more [s]."""
        return 0.0

    def there(self) -> Live:
        """The live deck; NotThere where none is open."""
        if self.live is None:
            raise NotThere("no deck is open")
        return self.live

    def analysis(self, table: type, otherwise: Callable[[], Any]) -> tuple[Any, Any, str | None]:
        """The deck's own analysis of a sort with its building and name; else one with default values."""
        live = self.there()
        for options, building, name in zip(live.deck.analyses, live.deck.buildings, live.names, strict=True):
            if isinstance(options, table):
                return options, building, name
        return otherwise(), live.deck.building, None

    def words(self) -> dict[str, Any]:
        """The facts on the deck that every reply contains: title, analyses, kinds, motion."""
        live = self.there()
        deck = live.deck
        told: dict[str, Any] = {
            "title": deck.title,
            "note": deck.note,
            "analyses": live.names,
            "structure": None if deck.structure is None else {"kind": deck.structure.kind, "word": deck.structure.word},
            "motion": None,
        }
        if deck.motion is not None:
            plain = {k: v for k, v in deck.motion.model_dump().items() if isinstance(v, str | int | float)}
            told["motion"] = plain | {"pulse": rocking.pulse_of(deck.motion)}
        return told

    @property
    def size(self) -> float:
        """The size of the drawing [m]."""
        return self.picture.assembly.size if self.picture else 1.0

    def drops(self) -> Path:
        """Where dropped files lie."""
        if self.scratch is None:
            self.scratch = Path(tempfile.mkdtemp(prefix="extrados-page-"))
        return self.scratch

    def close(self) -> None:
        """Delete dropped files."""
        if self.scratch is not None:
            shutil.rmtree(self.scratch, ignore_errors=True)
            self.scratch = None
