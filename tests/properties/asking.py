"""Ask one strategy about one deck, in process, without files and figures; what was answered is kept."""

import json
from collections import OrderedDict
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

import extrados
from extrados.results.codes import NoLocalMechanism
from extrados.results.model import Result
from extrados.results.verdict import KindResults, SelfWeight, Verdict

Deck = dict[str, Any]

#: How many answers are kept: relations ask several things of one building
MOST = 400
_KEPT: "OrderedDict[str, Answer]" = OrderedDict()


class Broken(AssertionError):
    """A relation does not hold: what was found, in words."""


@dataclass(frozen=True)
class Answer:
    """What one strategy says of one deck."""

    result: Result

    @property
    def status(self) -> str:
        """ok, refused or failed."""
        return self.result.status

    @property
    def answers(self) -> bool:
        """Whether it has results of its kind, not a proof of collapse under self-weight, or that none applies, in their place."""
        return self.status == "ok" and not isinstance(self.results, SelfWeight | NoLocalMechanism)

    @property
    def said(self) -> str:
        """Why there is no result."""
        return self.result.reason

    @property
    def results(self) -> KindResults:
        """The typed results."""
        return self.result.results

    @property
    def verdict(self) -> Verdict | None:
        """None where there is no result."""
        return self.result.verdict

    @property
    def warnings(self) -> str:
        """All warnings as one text."""
        return "\n".join(self.result.warnings)

    @property
    def outcome(self) -> str:
        """Outcome of the verdict: stands, collapses, cannot-stand, open, not-applicable; else refused or failed."""
        return self.status if self.verdict is None else self.verdict.outcome

    @property
    def numbers(self) -> dict[str, Any]:
        """All results but how long they took."""
        return {k: v for k, v in self.results.as_json().items() if "seconds" not in k}

    @property
    def capacity(self) -> np.ndarray:
        """Collapse accelerations (2) [g], pushed to +x and to -x; 0 where it cannot stand, NaN where nothing is known."""
        if self.outcome == "cannot-stand":
            return np.zeros(2)
        found = [getattr(self.results, f"collapse_acceleration{sense}_g", None) for sense in ("", "_opposite")]
        return np.array([np.nan if v is None else v for v in found])


def run(deck: Deck, folder: Path | None = None, threads: int = 1) -> "extrados.running.run.Run":
    """All analyses of a deck; DeckError where it is wrong."""
    made = extrados.decks.reader.make_deck(deck, folder) if folder is not None else deck
    return extrados.run(made, threads=threads)


def ask(deck: Deck, kind: str, folder: Path | None = None, threads: int = 1, **keys: Any) -> Answer:
    """What a strategy says of a deck; keys: of its own table. Broken where the program is at fault."""
    whole = {**{k: v for k, v in deck.items() if k != "analysis"}, "analysis": [{"kind": kind, **keys}]}
    name = json.dumps([whole, str(folder), threads], sort_keys=True, default=str)
    if folder is None and name in _KEPT:
        _KEPT.move_to_end(name)
        return _KEPT[name]
    answer = Answer(run(whole, folder, threads).results[0])
    if answer.status == "failed" and "internal error" in answer.said:
        raise Broken(f"{kind}: {answer.said}")
    _KEPT[name] = answer
    while len(_KEPT) > MOST:
        _KEPT.popitem(last=False)
    return answer


def near(told: str, one: Any, other: Any, tolerance: float, scale: float = 0.0) -> None:
    """Broken where two numbers, or arrays of one shape, differ by more than the tolerance times the greater, or times scale."""
    a, b = np.asarray(one, dtype=float), np.asarray(other, dtype=float)
    if a.shape != b.shape or not np.array_equal(np.isnan(a), np.isnan(b)):
        raise Broken(f"{told}: {one} against {other}")
    allowed = tolerance * np.maximum(np.maximum(np.abs(a), np.abs(b)), scale)
    if not np.all((np.abs(a - b) <= allowed) | np.isnan(a) | (a == b)):
        raise Broken(f"{told}: {one} against {other}")


def at_most(told: str, less: Any, more: Any, tolerance: float, scale: float = 0.0) -> None:
    """Broken where one number exceeds the other by more than the tolerance times the greater, or times scale."""
    a, b = np.asarray(less, dtype=float), np.asarray(more, dtype=float)
    if np.any(a - b > tolerance * np.maximum(np.maximum(np.abs(a), np.abs(b)), scale)):
        raise Broken(f"{told}: {less} exceeds {more}")


def must(holds: bool, told: str) -> None:
    """Broken, with what is told, unless it holds."""
    if not holds:
        raise Broken(told)


def same(told: str, one: Answer, other: Answer) -> None:
    """Broken where one answers and the other does not, or their outcomes differ."""
    if one.outcome != other.outcome:
        raise Broken(f"{told}: {one.outcome} ({one.said}) against {other.outcome} ({other.said})")
