"""The same document on A4 paper, as PDF, by the typesetter typst."""

import re
from pathlib import Path
from typing import Any

from extrados.results.store import StoreError
from extrados.show.document import Block, Code, Document, Figure, Heading, Table, Words
from extrados.show.html import LOOKS

#: A drawing of more bytes is taken as a picture of dots: a page would take seconds
LARGEST = 1_500_000
#: Of a picture as wide as the page: height over width beyond which it is made narrower
TALLEST = 1.1
#: Marks after which a long key, path or list may break: between letters or names of files, not within a number
BREAKS = re.compile(r"(?<=[A-Za-z]{2})[_.](?=[A-Za-z]{3})|(?<=[A-Za-z])/(?=\w)")
COLOURS = {
    "stands": "#3b7a57", "holds": "#3b7a57", "satisfied": "#3b7a57", "not satisfied": "#b3261e", "collapses": "#b3261e", "cannot stand": "#b3261e", "fails": "#b3261e", "open": "#a86400",
}  # fmt: skip
BOXES = {"answer": ("#f6f2ea", "#b3261e"), "bad": ("#fbe9e7", "#b3261e"), "warn": ("#fff7e0", "#d9a400")}

HEAD = """#set document(title: {title}, date: none)
#set page(paper: "a4", margin: (x: 20mm, top: 20mm, bottom: 22mm), numbering: "1 / 1", footer: context [
  #set text(7.5pt, fill: rgb("#666666"))
  #grid(columns: (1fr, auto), gutter: 6mm, align: (left, right), {foot}, counter(page).display("1 / 1", both: true))
])
#set text(font: "Libertinus Serif", size: 10pt, lang: "en")
#set par(justify: false, leading: 0.6em)
#set heading(numbering: "1.1")
#show heading.where(level: 1): it => block(above: 1.6em, below: 0.8em, it)
#show heading.where(level: 2): set text(11pt)
#show raw: set text(font: "DejaVu Sans Mono", size: 7.5pt)
#set table(stroke: (x, y) => (bottom: 0.4pt + rgb("#cccccc")), inset: (x: 2.2pt, y: 3pt), align: left + top)
#show table: set text(8pt)
#show table: set par(leading: 0.45em)
#show figure.caption: set text(8.5pt)
#set figure(supplement: [Figure], placement: none)
#let box-of(fill, line, body) = block(width: 100%, fill: rgb(fill), stroke: (left: 3pt + rgb(line)), inset: 8pt, breakable: true, body)
#align(left, text(18pt, weight: "bold", {title}))
"""


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


def _words(value: str) -> str:
    """Text that may break after the marks of long keys and paths; numbers are left whole."""
    return f"text({text_of(BREAKS.sub(lambda found: found[0] + chr(0x200B), value))})"


def markup(document: Document, folder: Path) -> str:
    """The document in the language of typst; pictures lie below the folder."""
    lines = [HEAD.replace("{title}", text_of(document.title)).replace("{foot}", text_of(document.foot))]
    if document.facts:
        rows = ", ".join(f"strong({text_of(a)}), {_words(b)}" for a, b in document.facts)
        lines.append(f"#table(columns: (auto, 1fr), {rows})")
    lines += _set(document.opening, folder)
    lines.append("#outline(depth: 1, title: [Contents])")
    lines += _set(document.blocks, folder)
    if document.annex:
        lines.append(
            _paragraph(
                Words(
                    "The annex is in report.html beside this file: each strategy by itself, all numbers, settings and checksums."
                )
            )
        )
    return "\n".join(lines)


def _set(blocks: list[Block], folder: Path) -> list[str]:
    """Blocks in the language of typst."""
    lines = []
    for block in blocks:
        if isinstance(block, Heading):
            if block.fresh:
                lines.append("#pagebreak(weak: true)")
            lines.append(f"#heading(level: {block.level}, {text_of(block.text)})")
        elif isinstance(block, Words):
            lines.append(_paragraph(block))
        elif isinstance(block, Table):
            lines.append(_table(block))
        elif isinstance(block, Figure):
            lines.append(_figure(block, folder))
        elif isinstance(block, Code):
            lines.append(
                f'#block(fill: rgb("#f7f7f7"), inset: 6pt, width: 100%, raw({text_of(block.text)}, block: true))'
            )
    return lines


def _paragraph(block: Words) -> str:
    body = ", linebreak(), ".join(f"text({text_of(line)})" for line in block.text.split("\n"))
    body = f"(({body},).join())"
    if block.look in BOXES:
        fill, line = BOXES[block.look]
        return f"#box-of({text_of(fill)}, {text_of(line)}, {body})"
    return f"#par({body})"


def _table(block: Table) -> str:
    columns = max([len(block.head), *(len(row) for row in block.rows)], default=0)
    if not columns or not block.rows:
        return ""
    widths = ", ".join(f"{share:g}fr" for share in block.shares) if block.shares else ", ".join(["auto"] * columns)
    cells = []
    if block.head:
        cells.append(f"table.header({', '.join(f'strong({_words(cell)})' for cell in block.head)})")
    for row in block.rows:
        for k, cell in enumerate(row):
            body = _words(cell)
            if k == 0:
                body = f"strong({body})"
            elif cell in LOOKS:
                body = f'text(fill: rgb("{COLOURS[cell]}"), weight: "bold", {text_of(cell)})'
            cells.append(body)
    return f"#table(columns: ({widths},), {', '.join(cells)})"


def _figure(block: Figure, folder: Path) -> str:
    drawing = folder / f"{block.name}.svg"
    name = f"{block.name}.{'svg' if drawing.stat().st_size <= LARGEST else 'png'}"
    size = re.search(r'viewBox="0 0 ([\d.]+) ([\d.]+)"', drawing.read_text(encoding="utf-8")[:2000])
    tall = float(size[2]) / float(size[1]) if size else 1.0
    width = 100.0 * block.width * min(1.0, TALLEST / tall)
    return f"#figure(image({text_of('/' + name)}, width: {width:.3g}%), caption: {_words(block.caption)})"


def pdf(document: Document, folder: Path) -> bytes:
    """The printed report; StoreError where the typesetter is missing or cannot set it."""
    try:
        import typst
    except ImportError:
        raise StoreError("the report as PDF needs the package typst: pip install typst") from None
    source: Any = markup(document, folder).encode(errors="replace")  # names of files may hold bytes that are no text
    try:
        return bytes(typst.compile(source, root=str(folder), format="pdf", ignore_system_fonts=True))
    except Exception as error:  # typst raises errors of its own and RuntimeError
        raise StoreError(f"the report could not be set as PDF: {error}") from None
