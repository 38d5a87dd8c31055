"""What can be wrong with a building."""

from collections.abc import Iterator
from contextlib import contextmanager

#: The key of a deck that is to blame: its names and, within lists, numbers from 0
Key = tuple[str | int, ...]
#: No one key is to blame: how the building stands as a whole, how a computation went, the machine
WHOLE: Key = ()


class BadGeometry(ValueError):
    """The building cannot be made as described; the text names the part, what is wrong and the bound.

    at: the key of the deck that says so, of the running analysis' own table ("analysis", ...).
    """

    def __init__(self, text: str = "", at: Key = ("structure",)):
        super().__init__(text)
        self.at = at


class NoView(BadGeometry):
    """A strategy cannot look at this building; the text says why and what would help."""

    def __init__(self, text: str = "", at: Key = WHOLE):
        super().__init__(text, at)


@contextmanager
def blaming(*key: str | int) -> Iterator[None]:
    """A BadGeometry that blames [structure] as a whole is made to blame this key of it."""
    try:
        yield
    except BadGeometry as error:
        if error.at == ("structure",):
            error.at = ("structure", *key)
        raise
