"""Strict reading of the messages of a page, and their errors."""

import re
from typing import Any

from extrados.analyses.context import Refused
from extrados.core.errors import CoreError
from extrados.decks.reader import DeckError
from extrados.explore.folder import NotThere
from extrados.limit.errors import CannotStand
from extrados.limit.programme import NoAnswer, NoEquilibrium
from extrados.model.errors import BadGeometry, NoView
from extrados.results.store import StoreError
from extrados.schema import quantities

#: What may go wrong with a building or a question that a hand asks for: told, not raised
TOLD = (DeckError, BadGeometry, CannotStand, Refused, NoView, NoAnswer, NoEquilibrium, CoreError, NotThere, StoreError)
Message = dict[str, Any]


class BadMessage(ValueError):
    """A message that no page of ours sends."""


def numbers(given: Any, count: int) -> list[float]:
    """So many finite numbers of a message."""
    if not isinstance(given, list) or len(given) != count:
        raise BadMessage(f"expected {count} numbers")
    for value in given:
        if isinstance(value, bool) or not isinstance(value, int | float) or not abs(value) < 1e9:
            raise BadMessage("expected numbers")
    return [float(value) for value in given]


def path(message: Message) -> str:
    """The path that a message names."""
    given = message.get("path")
    if not isinstance(given, str):
        raise BadMessage("expected a path")
    return given


def quantity(text: str, unit: str, label: str) -> float:
    """A number with or without a unit, converted to `unit`; DeckError gives the error."""
    text = text.strip().replace("−", "-").replace("°", " deg")
    try:
        return float(text)
    except ValueError:
        pass
    found = re.fullmatch(r"([-+]?[0-9.]+(?:[eE][-+]?\d+)?)\s*([A-Za-z%/^0-9*]+)", text[:60])
    if not found:
        raise DeckError(
            [f"{label}: '{text[:40]}' is not a quantity; expected a number such as 1.5, or a number with its unit such as 150 cm"]
        )
    try:
        return float(found[1]) * quantities.factor(found[2], unit)
    except ValueError as error:
        raise DeckError([f"{label}: {error}"]) from None
