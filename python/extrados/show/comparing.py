"""Two runs beside each other, as a page."""

from extrados.results.compare import Change, Comparison
from extrados.show.document import Block, Document, Heading, Table, Words
from extrados.show.telling import cell

#: Changes of an analysis that are told
MOST = 40


def document(names: tuple[str, str], found: Comparison) -> Document:
    """What changed from the first run to the second."""
    blocks: list[Block] = [Words("Only the computing time differs.", "answer")] if found.same else []
    for title, rows, head in (
        ("Verdicts", found.verdicts, ("analysis", "before", "after", "after / before")),
        ("Deck", found.deck, ("key", "before", "after", "after / before")),
        ("Program", found.program, ("", "before", "after", "")),
    ):
        if rows:
            blocks += [Heading(title), Table(head, [row(c) for c in rows], (2.6, 2.0, 2.0, 1.0))]
    only = [(n, "before") for n in found.only_old] + [(n, "after") for n in found.only_new]
    if only:
        blocks += [Heading("Analyses that only one run has"), Table(("analysis", "only"), only, (3.0, 1.0))]
    if found.numbers:
        blocks.append(Heading("Numbers"))
    for name, there in found.numbers.items():
        blocks += [
            Heading(name, 2),
            Table(("key", "before", "after", "after / before"), [row(c) for c in there[:MOST]], (2.6, 2.0, 2.0, 1.0)),
        ]
        if len(there) > MOST:
            blocks.append(Words(f"and {len(there) - MOST} smaller differences"))
    for title, lines in (("Warnings that no longer occur", found.warnings_gone), ("New warnings", found.warnings_new)):
        if lines:
            blocks += [Heading(title), *(Words(line, "warn") for line in lines)]
    return Document(f"{names[0]} and {names[1]}", [("Before", names[0]), ("After", names[1])], blocks, "")


def row(c: Change) -> tuple[str, str, str, str]:
    """A change as cells."""
    return c.key, cell(c.old), cell(c.new), "" if c.ratio is None else f"{c.ratio:.4g}"
