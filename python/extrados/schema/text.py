"""Text that may be shown: on a terminal, in a file, on a page."""

import unicodedata


def printable(text: str, keep: str = "") -> str:
    """The text with everything escaped that a terminal would obey instead of show, or no file could hold.

    Control and format characters (escape sequences, line ends, marks that turn the direction of writing) and halves
    of surrogate pairs become \\x1b, \\u202e and the like; characters in `keep` stay.
    """
    if text.isprintable():
        return text
    return "".join(c if c in keep or _is_shown(c) else _escaped(c) for c in text)


def _is_shown(character: str) -> bool:
    category = unicodedata.category(character)
    return category[0] != "C" and category not in ("Zl", "Zp")


def _escaped(character: str) -> str:
    return character.encode("unicode_escape").decode("ascii")
