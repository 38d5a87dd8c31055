"""Pictures of the documentation, drawn by the decks of `cases/` as the site is built, and the Sphinx directive that shows one.

A page has
```{drawn} CASE ANALYSIS [FIGURE]
Caption, which is also the text for readers who cannot see the picture.
```
FIGURE is the first of the analysis by default. A picture is drawn anew when the program, its deck or a file beside the deck
changed; others are taken from build/drawings.
"""

import hashlib
import json
import os
from dataclasses import asdict, dataclass
from functools import cache, lru_cache
from pathlib import Path
from typing import Any

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

ROOT = Path(__file__).resolve().parents[1]
KEPT = ROOT / "build" / "drawings"
#: Set by a quick build: directives show their caption alone
QUICK = "EXTRADOS_QUICK_DOCS"


@dataclass(frozen=True)
class Picture:
    """A figure of an analysis of a deck."""

    file: str  #: PNG
    caption: str  #: of the figure
    title: str  #: of the deck
    conclusion: str  #: of the analysis
    seconds: float  #: that the analysis took when it was drawn


@cache
def program() -> str:
    """A hash of all that calculates and draws."""
    import extrados

    there = [*Path(extrados.__file__).parent.rglob("*.py"), *(ROOT / "fortran").rglob("*.f90"), *(ROOT / "c").rglob("*.[ch]")]
    return hashlib.sha256(b"".join(file.read_bytes() for file in sorted(there))).hexdigest()


@lru_cache(maxsize=1)
def run_case(case: str) -> Any:
    """The run of a deck of `cases/`, in memory."""
    import extrados

    return extrados.run(ROOT / "cases" / f"{case}.toml")


def draw(case: str, analysis: str, figure: str = "") -> Picture:
    """A figure of a deck: the first of the analysis, or the one named, of any analysis if `analysis` is empty.

    LookupError if the deck does not draw it, with the status of its analyses.
    """
    deck = ROOT / "cases" / f"{case}.toml"
    beside = sorted(file for file in deck.parent.iterdir() if file.is_file() and file.suffix != ".toml")
    given = b"".join(file.read_bytes() for file in [deck, *beside])
    key = hashlib.sha256(f"{program()} {hashlib.sha256(given).hexdigest()} {analysis} {figure}".encode()).hexdigest()[:12]
    name = f"{case.replace('/', '-')}-{figure or analysis}"
    file, facts = KEPT / f"{name}.png", KEPT / f"{name}-{key}.json"
    if file.exists() and facts.exists():
        return Picture(**json.loads(facts.read_text(encoding="utf-8")))
    run = run_case(case)
    for row in run.analyses:
        if analysis in ("", row["name"]):
            drawn = run.plot(row["name"])
            chosen = figure or next(iter(drawn), "")
            if chosen in drawn:
                break
    else:
        told = "; ".join(f"{row['name']}: {row['status']} {row['reason']}" for row in run.analyses)
        raise LookupError(f"cases/{case}.toml: {analysis} draws no figure {figure}; {told}")
    KEPT.mkdir(parents=True, exist_ok=True)
    for old in KEPT.glob(f"{name}-????????????.json"):
        old.unlink()
    drawn[chosen].savefig(file, format="png", dpi=120)
    title = run.summary["deck"]["title"] or case
    made = Picture(file.name, drawn.captions[chosen], title, row["answer"], row["seconds"])
    facts.write_text(json.dumps(asdict(made)), encoding="utf-8")
    return made


class Drawn(SphinxDirective):
    """A figure of a deck of `cases/`, with the text of the directive as its caption."""

    required_arguments, optional_arguments = 2, 1
    has_content = True

    def run(self) -> list[nodes.Node]:
        text = " ".join(self.content)
        case, analysis, *figure = self.arguments
        caption = nodes.caption(text, f"{text.rstrip('.')} (", nodes.literal(text=f"cases/{case}"), nodes.Text(")"))
        if os.environ.get(QUICK):
            return [nodes.paragraph("", "", *caption.children)]
        try:
            made = draw(case, analysis, *figure)
        except LookupError as error:
            return [self.state.document.reporter.error(str(error), line=self.lineno)]
        self.env.note_dependency(str(ROOT / "cases" / f"{case}.toml"))
        shown = os.path.relpath(KEPT / made.file, Path(self.env.doc2path(self.env.docname)).parent)
        return [nodes.figure("", nodes.image(uri=shown, alt=text), caption)]


def setup(app: Sphinx) -> dict[str, bool]:
    """The directive, for Sphinx."""
    app.add_directive("drawn", Drawn)
    return {"parallel_read_safe": False}
