"""The decision diagram of docs/which-analysis.md: questions, situations, and the analyses for them, as SVG with links."""

from dataclasses import dataclass
from html import escape
from pathlib import Path


@dataclass(frozen=True)
class Case:
    """A situation, the kinds of analysis for it, and their page."""

    situation: str
    kinds: tuple[str, ...]
    page: str


#: Question -> situations, from simple to elaborate
TREE: dict[str, list[Case]] = {
    "Does it stand, and how near is collapse?": [
        Case("arch, vault, buttress, section of a church", ("tilt", "thrust"), "limit"),
        Case("dome or vault as a network of compression over its plan", ("thrust-network",), "solids"),
        Case("bridge under vehicles or trains", ("moving-load", "thrust"), "bridges"),
        Case("supports that settle or spread", ("supports",), "limit"),
        Case("dome, corner, groin vault, any direction", ("tilt",), "solids"),
        Case("uncertain survey, many sizes", ("imperfections", "survey", "sweep"), "surveys"),
    ],
    "Does it survive this ground motion?": [
        Case("free-standing block, column, statue", ("rocking", "failure-domain"), "rocking"),
        Case("blocks of all sizes, overturning spectra", ("rocking-spectrum",), "rocking"),
        Case("arch or vault with hinges", ("rocking", "failure-curves", "assessment"), "rocking"),
        Case("blocks that slide or collapse one by one", ("dem", "dem-domain", "dem-parameters"), "dem"),
        Case("repeated or harmonic shaking", ("harmonic-map", "resonance"), "rocking"),
    ],
    "How probable is collapse?": [
        Case("many motions, fragility, annual rate", ("fragility",), "rocking-statistics"),
        Case("drums, facade, corner, vault of many blocks", ("dem-fragility",), "dem"),
    ],
    "Where does it crack, and what load does it carry?": [
        Case("one wall in its plane", ("sla",), "sla"),
        Case("building of walls and floors, vault, dome", ("pushover",), "buildings"),
    ],
    "Does it comply with a code?": [Case("facade, gable, parapet, block, pier", ("local-mechanism", "code-checks"), "codes")],
    "What is the least strengthening?": [Case("tie, buttress, thickness, injection, damper", ("strengthen",), "strengthening")],
    "How strong is this motion?": [Case("record, spectrum, shake table", ("motion", "shake-table"), "motion")],
    "One conclusion from all of these?": [Case("one building, or a ranking of many", ("assess",), "assess")],
}
ROW, GAP, TOP, WIDTH = 34, 10, 42, 980
#: Left edge and width of the columns: question, situation, analyses
COLUMNS = ((4, 262), (310, 308), (662, 314))


def _box(x: float, y: float, width: float, height: float, kind: str) -> str:
    return f'<rect x="{x}" y="{y}" width="{width}" height="{height}" rx="6" class="{kind}"/>'


def _text(x: float, y: float, words: str, kind: str = "") -> str:
    return f'<text x="{x}" y="{y}" class="{kind}">{escape(words)}</text>'


def _lines(words: str, most: int) -> list[str]:
    """Words in lines of at most so many letters."""
    lines = [""]
    for word in words.split():
        if len(lines[-1]) + len(word) >= most and lines[-1]:
            lines.append("")
        lines[-1] = f"{lines[-1]} {word}".strip()
    return lines


def diagram() -> str:
    """The diagram as SVG, in the colours of the page; each analysis links to its page."""
    parts, y = [], float(TOP)
    heads = ("Question", "Structure or situation", "Analysis (opens its page)")
    parts += [_text(left + 8, 22, head, "head") for (left, _), head in zip(COLUMNS, heads, strict=True)]
    (x0, w0), (x1, w1), (x2, w2) = COLUMNS
    for question, cases in TREE.items():
        height = len(cases) * (ROW + 4) - 4
        middle = y + height / 2
        lines = _lines(question, 36)
        tall = ROW if len(lines) == 1 else 44
        parts.append(_box(x0, middle - tall / 2, w0, tall, "question"))
        parts += [_text(x0 + 10, middle + 5 + 17 * (k - (len(lines) - 1) / 2), line) for k, line in enumerate(lines)]
        for k, case in enumerate(cases):
            top = y + k * (ROW + 4)
            at = top + ROW / 2
            parts.append(f'<path d="M{x0 + w0} {middle} C{x1 - 20} {middle} {x0 + w0 + 20} {at} {x1} {at}" class="way"/>')
            parts.append(f'<path d="M{x1 + w1} {at} H{x2}" class="way"/>')
            parts += [_box(x1, top, w1, ROW, "situation"), _text(x1 + 10, at + 5, case.situation)]
            parts.append(
                f'<a href="{case.page}.html">{_box(x2, top, w2, ROW, "analysis")}'
                f"{_text(x2 + 10, at + 5, ', '.join(case.kinds), 'code')}</a>"
            )
        y += height + GAP
    style = (
        "text{font:13.5px sans-serif;fill:currentColor}.head{font-weight:bold}.code{font-family:monospace;font-size:13px}"
        "rect{fill:none;stroke:currentColor;stroke-opacity:.45}.question{fill:#c9a66b;fill-opacity:.28}"
        ".analysis{fill:#2a6f97;fill-opacity:.16}.way{fill:none;stroke:currentColor;stroke-opacity:.45}"
    )
    title = "Decision diagram: from the question and the structure to the analysis"
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {y:.0f}" role="img" aria-label="{title}" class="decision">'
        f"<style>{style}</style>{''.join(parts)}</svg>\n"
    )


def table() -> str:
    """The same as a table of Markdown, then every other kind of analysis with its meaning."""
    from extrados import kinds
    from extrados.decks.explain import summary
    from extrados.decks.manual import first_sentence

    lines = ["| question | situation | analysis |", "|---|---|---|"]
    named = set()
    for question, cases in TREE.items():
        for case in cases:
            named |= set(case.kinds)
            which = ", ".join(f"`{kind}`" for kind in case.kinds)
            lines.append(f"| {question} | {case.situation} | {which} ([page]({case.page}.md)) |")
    for kind in kinds.ANALYSES:
        if kind not in named:
            lines.append(f"| | {first_sentence(summary(kinds.table('analysis', kind)))} | `{kind}` |")
    return "\n".join(lines) + "\n"


def write(folder: Path) -> None:
    """Both, into a folder."""
    (folder / "decision.svg").write_text(diagram(), encoding="utf-8")
    (folder / "decision.md").write_text(table(), encoding="utf-8")
