"""A document without a form: headings, words, tables, figures. From one such source come the HTML and the printed report."""

from collections.abc import Sequence
from dataclasses import dataclass, field

from extrados.show.language import Language


@dataclass(frozen=True)
class Heading:
    """fresh: it begins a page of its own."""

    text: str
    level: int = 1
    fresh: bool = False


@dataclass(frozen=True)
class Words:
    """A paragraph; look: "" plain, "answer", "bad" or "warn"; its lines are kept where it has several. lang: code of its language
    where it is another than the document's."""

    text: str
    look: str = ""
    lang: str = ""


@dataclass(frozen=True)
class Table:
    """Rows of text under a head; shares: relative widths of the columns, of a printed page; look: a word for each row."""

    head: tuple[str, ...]
    rows: Sequence[tuple[str, ...]]
    shares: tuple[float, ...] = ()
    look: list[str] = field(default_factory=list)


@dataclass(frozen=True)
class Figure:
    """A picture by its place below the report's folder, without its ending; numbered in its order. width: of the page's."""

    name: str
    caption: str
    width: float = 1.0


@dataclass(frozen=True)
class Code:
    """Text as it was typed, line by line."""

    text: str


Block = Heading | Words | Table | Figure | Code


@dataclass(frozen=True)
class Document:
    """title; facts: the title block, label and text; opening: the first page, before the contents; blocks in order; annex: a
    document of its own on paper, the end of the page on the screen; foot: on every printed page. signatures: labels of fields to sign
    in; logo: the name of its picture below the report's folder; colour: of headings; words: the language."""

    title: str
    facts: list[tuple[str, str]]
    blocks: list[Block]
    foot: str
    opening: list[Block] = field(default_factory=list)
    annex: list[Block] = field(default_factory=list)
    signatures: tuple[tuple[str, str], ...] = ()
    logo: str = ""
    colour: str = "#222222"
    words: Language = field(default_factory=Language)
