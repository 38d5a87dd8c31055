"""A live model: a deck whose values change, and whose results are calculated again only if a change affects them."""

import copy
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from extrados.analyses.conclude import concluded
from extrados.analyses.context import Context, default_threads
from extrados.analyses.sequence import run_one
from extrados.analyses.table import Analysis
from extrados.decks.reader import Deck, DeckError, make_deck
from extrados.decks.words import WORDS
from extrados.motions.motion import Motion
from extrados.results import store
from extrados.results.model import Result
from extrados.results.verdict import KindResults
from extrados.running.run import Run
from extrados.schema.table import Table
from extrados.views.building import Building

#: Views, motions and, for each analysis, results that are kept: the newest ones
MOST_VIEWS, MOST_MOTIONS, MOST_RESULTS = 64, 16, 32


class Live:
    """A deck with its building in memory: `set` a value, then read a result.

    The model records which parts of the deck an analysis reads (its table, tables of the building, the motion). While these
    parts have values that were already calculated, the kept result is returned. Blocks, meshes and other models of the
    building are kept in the same way. Files of the deck are read once; later changes of a file are not noticed.

    A Live has no locks: calls may come from any thread, but only one at a time.
    """

    def __init__(self, deck: Deck, threads: int | None = None):
        self.threads = threads or default_threads()
        self._views: dict[Any, Any] = {}
        self._motions: dict[str, Motion] = {}
        self._results: dict[str, list[_Kept]] = {}
        self._take(deck)

    def _take(self, deck: Deck) -> None:
        building = replace(deck.building, views=self._views)
        buildings = [replace(b, views=self._views) for b in deck.buildings]
        self.deck = replace(deck, building=building, buildings=buildings)
        self.names = store.group_names([options.kind for options in deck.analyses])

    def back_to(self, deck: Deck) -> None:
        """Restore a deck that this model has had; its kept results are still valid."""
        self._take(deck)

    def context(self, deck: Deck | None = None) -> Context:
        """The context of the drivers, with the kept motions; of another deck if one is given."""
        return Context(deck or self.deck, self.threads, motions=self._motions)

    def __repr__(self) -> str:
        return f"<Live: {', '.join(self.names)}>"

    def set(self, key: str, value: Any) -> None:
        """Set a key of the deck to another value, written as in the deck: set("structure.thickness", "20 cm"). A number without
        a unit is in SI, an angle in degrees.

        See `update`.
        """
        self.update({key: value})

    def update(self, changes: dict[str, Any]) -> None:
        """Set several keys together; None removes a key, so that its default applies.

        changes: keys with their values as in a deck. Keys are dotted; those of an analysis follow its name:
        "analysis.rocking.end_time", "analysis.tilt-2.load.0.x". A whole table is accepted, also "analysis", the list of
        analyses. DeckError lists the errors by key, and then nothing is changed.
        """
        data = copy.deepcopy(self.deck.data)
        for key, value in changes.items():
            self._put(data, key, value)
        self._take(make_deck(data, self.deck.folder))

    def _put(self, data: dict[str, Any], key: str, value: Any) -> None:
        *way, last = key.split(".")
        place: Any = data
        if way[:1] == ["analysis"]:
            place = data["analysis"] if isinstance(data["analysis"], list) else [data["analysis"]]
            _, name, *way = [*way, last]
            if name not in self.names:
                raise DeckError([f"{key}: the deck has no analysis '{name}'; its analyses are {', '.join(self.names)}"])
            *way, last = [str(self.names.index(name)), *way]
        for part in way:
            place = _step(place, part, key) if isinstance(place, list) else place.setdefault(part, {})
            if not isinstance(place, dict | list):
                raise DeckError([f"{key}: '{part}' is not a table"])
        if isinstance(place, list):
            _step(place, last, key)
            place[int(last)] = value
        elif value is None:
            place.pop(last, None)
        else:
            place[last] = value

    def result(self, name: str) -> Result:
        """The result of an analysis by its name, calculated if necessary; KeyError if the deck has no analysis of this name."""
        found, i = self._computed(name), self.names.index(name)
        context = self.context()
        return concluded(found, self.deck.analyses[i], context, self.deck.buildings[i])

    def _computed(self, name: str) -> Result:
        """The result without its verdict, which may look at parts of the deck that the analysis does not."""
        if name not in self.names:
            raise KeyError(f"the deck has no analysis '{name}'; its analyses are {', '.join(self.names)}")
        i = self.names.index(name)
        options, building = self.deck.analyses[i], self.deck.buildings[i]
        own = f"{_fingerprint(options)} {self.deck.folder}"
        seen = _Seen(self.deck, building)
        kept = self._results.setdefault(own, [])
        for there in kept:
            if all(seen.value(part) == value for part, value in there.values.items()):
                return there.result
        deck = seen.deck(options, _own_data(self.deck.data, i))
        context = self.context(deck)
        result = run_one(context, options, deck.buildings[0])
        if result.status in ("ok", "refused"):
            kept.append(_Kept({part: seen.value(part) for part in seen.parts}, result))
            del kept[:-MOST_RESULTS]
        _forget(self._results, MOST_RESULTS)
        _forget(self._views, MOST_VIEWS)
        _forget(self._motions, MOST_MOTIONS)
        return result

    def run(self) -> Run:
        """Calculate all analyses, as far as necessary, and return them as a run, to read or to write."""
        return Run.of(self.deck, [self.result(name) for name in self.names])

    def __getitem__(self, name: str) -> KindResults:
        """The results of an analysis by its name, for instance live["tilt"].collapse_acceleration_g."""
        return self._computed(name).results

    def array(self, analysis: str, name: str) -> np.ndarray:
        """The numbers of an array of an analysis in SI. `result(analysis).arrays[name]` gives its shape (`dims`, for instance
        (time,)) and its `unit`. KeyError names the available arrays."""
        there = self._computed(analysis).arrays
        if name not in there:
            raise KeyError(f"{analysis} has no array '{name}'; its arrays are {', '.join(there) or 'none'}")
        return np.asarray(there[name].data)


@dataclass(frozen=True)
class _Kept:
    """A result, with the fingerprints of those parts of the deck that it was computed from."""

    values: dict[str, str]
    result: Result


#: What a building is said to be, table by table
_TABLES = frozenset({"structure", "material", "materials", "joints", "supports", "initial", "ties", "dampers", "hinges"})


class _Seen:
    """Hands a deck to an analysis and notes which parts of it are read."""

    def __init__(self, deck: Deck, building: Building):
        self.whole, self.building = deck, building
        self.parts: set[str] = set()
        self._known: dict[str, str] = {}

    def value(self, part: str) -> str:
        """Fingerprint of a part as it is now."""
        if part not in self._known:
            self._known[part] = _fingerprint(self._part(part))
        return self._known[part]

    def _part(self, part: str) -> Any:
        if part == "data":  # an analysis knows the values of its own building; words change no result
            return {k: v for k, v in self.whole.data.items() if k not in (*WORDS, "analysis")}
        if part == "motion":
            return self.whole.motion
        owner, _, table = part.partition(".")
        return getattr(self.building if owner == "own" else self.whole.building, table)

    def deck(self, options: Analysis, data: dict[str, Any]) -> Deck:
        """A deck of one analysis, of data `data`, that notes what is read of it."""
        own, given = _WatchedBuilding(**vars(self.building)), _WatchedBuilding(**vars(self.whole.building))
        _watch(own, lambda name: self.parts.add(f"own.{name}"))
        _watch(given, lambda name: self.parts.add(f"deck.{name}"))
        tables = [t for a, t in zip(self.whole.analyses, self.whole.tables, strict=False) if a is options]
        parts = {**vars(self.whole), "building": given, "analyses": [options], "buildings": [own], "data": data, "tables": tables}
        deck = _WatchedDeck(**parts)
        _watch(deck, self.parts.add)
        return deck


def _watch(thing: Any, note: Callable[[str], None]) -> None:
    vars(thing)["note"] = note


class _WatchedBuilding(Building):
    """A building that notes which of its tables are read, also to make a view or another building of it."""

    def __getattribute__(self, name: str) -> Any:
        if name in _TABLES and (note := object.__getattribute__(self, "__dict__").get("note")) is not None:
            note(name)
        return object.__getattribute__(self, name)


class _WatchedDeck(Deck):
    """A deck that notes whether its motion or its raw data are read; its building does so for itself."""

    def __getattribute__(self, name: str) -> Any:
        if name in ("motion", "data") and (note := object.__getattribute__(self, "__dict__").get("note")) is not None:
            note(name)
        return object.__getattribute__(self, name)


def _own_data(data: dict[str, Any], i: int) -> dict[str, Any]:
    """The data of the deck with the i-th analysis alone."""
    given = data["analysis"]
    return {**data, "analysis": given[i] if isinstance(given, list) else given}


def _fingerprint(part: Any) -> str:
    """A text that is equal for two parts of a deck only if their content is equal."""
    if isinstance(part, Table):
        return f"{part.model_dump_json()} {sorted(part.model_fields_set)}"
    if isinstance(part, dict):
        return repr({name: _fingerprint(value) for name, value in part.items()})
    return repr(part)


def _forget(kept: dict[Any, Any], most: int) -> None:
    """Drop the oldest."""
    while len(kept) > most:
        kept.pop(next(iter(kept)))


def _step(place: list[Any], part: str, key: str) -> Any:
    """The element of an array of tables that a part of a key names by its number, from 0."""
    if not part.isdecimal() or int(part) >= len(place):
        raise DeckError([f"{key}: expected a number from 0 to {len(place) - 1}, found '{part}'"])
    return place[int(part)]
