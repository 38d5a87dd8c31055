"""The same document on A4 paper, as PDF, by the typesetter typst."""

import re
from pathlib import Path
from typing import Any

from extrados.results.store import StoreError
from extrados.show.document import Block, Code, Document, Figure, Heading, Table, Words
from extrados.show.html import LOOKS
from extrados.show.language import Language

#: A drawing of more bytes is taken as a picture of dots: a page would take seconds
LARGEST = 1_500_000
#: Of a picture as wide as the page: height over width beyond which it is made narrower
TALLEST = 1.1
#: Marks after which a long key, path or list may break: between letters or names of files, not within a number
BREAKS = re.compile(r"(?<=[A-Za-z]{2})[_.](?=[A-Za-z]{3})|(?<=[A-Za-z])/(?=\w)")
#: The slash within a unit, and the space before a unit
SLASH = re.compile(r"(?<![\w/])(k?N|k?g|t)/(?=m)")
UNIT = re.compile(r"(?<=\d) (?=(?:%|k?N|kN/m|[kM]Pa|m?m|k?g|s)(?![\w]))")
COLOURS = {
    "stands": "#3b7a57",
    "holds": "#3b7a57",
    "satisfied": "#3b7a57",
    "not satisfied": "#b3261e",
    "collapses": "#b3261e",
    "cannot stand": "#b3261e",
    "fails": "#b3261e",
    "open": "#a86400",
}
BOXES = {"answer": ("#f6f2ea", "#8c7f66"), "bad": ("#fbe9e7", "#b3261e"), "warn": ("#fff7e0", "#d9a400")}

HEAD = """#set document(title: {title}, date: none)
#set page(paper: "a4", margin: (x: 20mm, top: 20mm, bottom: 22mm), numbering: "1 / 1", footer: context [
  #set text(7.5pt, fill: rgb("#666666"))
  #grid(columns: (1fr, auto), gutter: 6mm, align: (left, right), {foot}, counter(page).display("1 / 1", both: true))
])
#set text(font: "Libertinus Serif", size: 10pt, lang: {lang}, hyphenate: false)
#set par(justify: false, leading: 0.6em)
#set heading(numbering: "1.1")
#show heading: set text(fill: rgb({colour}))
#show heading.where(level: 1): it => block(above: 1.6em, below: 0.8em, it)
#show heading.where(level: 2): set text(11pt)
#show raw: set text(font: "DejaVu Sans Mono", size: 7.5pt)
#set table(stroke: (x, y) => (bottom: 0.4pt + rgb("#cccccc")), inset: (x: 2.2pt, y: 3pt), align: left + top)
#show table: set text(8pt)
#show table: set par(leading: 0.45em)
#show figure.caption: set text(8.5pt)
#set figure(supplement: {figure}, placement: none)
#let box-of(fill, line, long, body) = block(width: 100%, fill: rgb(fill), stroke: (left: 3pt + rgb(line)), inset: 8pt, breakable: long, body)
"""
#: Width of the text [mm], of a letter in a table and of what stands beside the letters of a cell
PAGE, LETTER, BESIDE = 170.0, 1.55, 2.4
#: Rows of a table, and characters of a paragraph in a box, that are kept on one page
KEPT, SHORT = 8, 1500


def available() -> bool:
    """Whether the typesetter is installed."""
    try:
        import typst  # noqa: F401
    except ImportError:
        return False
    return True


def text_of(value: str) -> str:
    """A string of typst: nothing in it is obeyed."""
    escaped = value.replace("\\", "\\\\").replace('"', '\\"').replace("\n", "\\n").replace("\t", " ")
    return f'"{escaped}"'


def _kept(value: str) -> str:
    """Text whose lines do not part a number from its unit, a unit, or the sign of a direction from its axis."""
    return re.sub(r"(?<![\w-])-(?=[xyz]\b)", "−", UNIT.sub("\u00a0", SLASH.sub("\\1/\u2060", value)))


def _words(value: str) -> str:
    """Text that may break after the marks of long keys and paths; numbers are left whole."""
    return f"text({text_of(BREAKS.sub(lambda found: found[0] + chr(0x200B), _kept(value)))})"


def markup(document: Document, folder: Path) -> str:
    """The document in the language of typst; pictures lie below the folder."""
    words = document.words
    fields = {
        "{title}": text_of(document.title),
        "{foot}": text_of(document.foot),
        "{lang}": text_of(words.code),
        "{colour}": text_of(document.colour),
        "{figure}": f"text({text_of(words('Figure'))})",
    }
    lines = [re.sub(r"\{(?:title|foot|lang|colour|figure)\}", lambda found: fields[found[0]], HEAD)]
    title = f'text(18pt, weight: "bold", {text_of(document.title)})'
    if document.logo:
        logo = f"image({text_of(document.logo)}, height: 16mm, alt: {text_of(words('Logo'))})"
        lines.append(f"#grid(columns: (1fr, auto), gutter: 6mm, align: (left + horizon, right), {title}, {logo})")
    else:
        lines.append(f"#align(left, {title})")
    if document.facts:
        cells = ", ".join(f"strong({text_of(a)}), {_words(b)}" for a, b in document.facts)
        cells += ", [], []" if len(document.facts) % 2 else ""
        lines.append(f"#table(columns: (auto, 1fr, auto, 1fr), stroke: 0.5pt + rgb({text_of(document.colour)}), {cells})")
    lines += _set(document.opening, folder, words)
    if document.signatures:
        cells = ", ".join(f"[#{_words(label)} \\ #{_words(name)} #v(9mm)]" for label, name in document.signatures)
        lines.append(f"#table(columns: {len(document.signatures)} * (1fr,), stroke: 0.5pt + rgb({text_of(document.colour)}), {cells})")
    if document.opening:
        lines.append("#pagebreak(weak: true)")
    lines.append(f"#outline(depth: 1, title: {_words(words('Contents'))})")
    lines += _set(document.blocks, folder, words)
    if document.annex:
        lines.append(_paragraph(Words(words("The annex is a separate document with all numbers, settings and checksums."))))
    return "\n".join(lines)


def _set(blocks: list[Block], folder: Path, words: Language) -> list[str]:
    """Blocks in the language of typst."""
    lines = []
    for block, after in zip(blocks, [*blocks[1:], None], strict=False):
        if isinstance(block, Heading):
            if block.fresh:
                lines.append("#pagebreak(weak: true)")
            lines.append(f"#heading(level: {block.level}, {text_of(block.text)})")
        elif isinstance(block, Words):
            kept = isinstance(after, Table) and not block.look
            lines.append(f"#block(sticky: true)[{_paragraph(block)}]" if kept else _paragraph(block))
        elif isinstance(block, Table):
            lines.append(_table(block, words))
        elif isinstance(block, Figure):
            lines.append(_figure(block, folder))
        elif isinstance(block, Code):
            lines.append(f'#block(fill: rgb("#f7f7f7"), inset: 6pt, width: 100%, raw({text_of(block.text)}, block: true))')
    return lines


def _paragraph(block: Words) -> str:
    body = ", linebreak(), ".join(f"text({text_of(_kept(line))})" for line in block.text.split("\n"))
    body = f"(({body},).join())"
    if block.lang:
        body = f"text(lang: {text_of(block.lang)}, {body})"
    if block.look in BOXES:
        fill, line = BOXES[block.look]
        return f"#box-of({text_of(fill)}, {text_of(line)}, {'true' if len(block.text) > SHORT else 'false'}, {body})"
    return f"#par({body})"


def _table(block: Table, words: Language) -> str:
    looks = {words(look): COLOURS[look] for look in LOOKS}
    columns = max([len(block.head), *(len(row) for row in block.rows)], default=0)
    if not columns or not block.rows:
        return ""
    widths = ", ".join(f"{share:.4g}fr" for share in _shares(block)) if block.shares else ", ".join(["auto"] * columns)
    cells = []
    if block.head:
        cells.append(f"table.header({', '.join(f'strong({_words(cell)})' for cell in block.head)})")
    for row in block.rows:
        for k, cell in enumerate(row):
            body = _words(cell)
            if k == 0:
                body = f"strong({body})"
            elif cell in looks:
                body = f'text(fill: rgb("{looks[cell]}"), weight: "bold", {text_of(cell)})'
            cells.append(body)
    table = f"table(columns: ({widths},), {', '.join(cells)})"
    return f"#block(breakable: {'false' if len(block.rows) <= KEPT else 'true'}, {table})"


def _shares(block: Table) -> list[float]:
    """Widths of the columns [mm]: as requested, but at least as wide as the longest word."""
    every = [block.head, *block.rows] if block.head else block.rows
    least = [
        BESIDE + LETTER * max((len(word) for row in every for word in BREAKS.sub(lambda m: m[0] + " ", row[k]).split()), default=0)
        for k in range(len(block.shares))
    ]
    asked = [PAGE * share / sum(block.shares) for share in block.shares]
    lack = sum(max(0.0, need - have) for need, have in zip(least, asked, strict=True))
    spare = sum(max(0.0, have - need) for need, have in zip(least, asked, strict=True))
    part = min(1.0, lack / spare) if spare else 0.0
    return [need if have < need else have - part * (have - need) for need, have in zip(least, asked, strict=True)]


def _figure(block: Figure, folder: Path) -> str:
    drawing = folder / f"{block.name}.svg"
    name = f"{block.name}.{'svg' if drawing.stat().st_size <= LARGEST else 'png'}"
    size = re.search(r'viewBox="0 0 ([\d.]+) ([\d.]+)"', drawing.read_text(encoding="utf-8")[:2000])
    tall = float(size[2]) / float(size[1]) if size else 1.0
    width = 100.0 * block.width * min(1.0, TALLEST / tall)
    return f"#figure(image({text_of(name)}, width: {width:.3g}%, alt: {text_of(block.caption)}), caption: {_words(block.caption)})"


def pdf(source: bytes, folder: Path) -> bytes:
    """A markup as PDF/UA-1: tags, alternative texts, title, language, fonts embedded. StoreError where the typesetter is missing or
    cannot set it."""
    try:
        import typst
    except ImportError:
        raise StoreError("the report as PDF needs the package typst: pip install typst") from None
    text: Any = source
    try:
        return bytes(typst.compile(text, root=str(folder), format="pdf", ignore_system_fonts=True, pdf_standards=["ua-1"]))
    except Exception as error:  # typst raises errors of its own and RuntimeError
        raise StoreError(f"the PDF of the report could not be made: {error}") from None
