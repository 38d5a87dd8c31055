"""The text of `extrados explain results.KIND` and the results reference, from the facts of the models (`results.explain`)."""

import difflib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

#: How `explain` knows the results from the deck
SECTION = "results"


@dataclass(frozen=True)
class Fact:
    """One key of the results: dotted, [] for the rows of a list, NAME for those of a table of names."""

    key: str
    about: str
    unit: str
    source: str
    always: bool


@dataclass(frozen=True)
class ShapeFacts:
    """A model: what it is, and its keys."""

    summary: str
    facts: Sequence[Fact]


@dataclass(frozen=True)
class ResultFacts:
    """beside: what every analysis gives beside its results; kinds: the models of each kind."""

    beside: Mapping[str, ShapeFacts]
    kinds: Mapping[str, Sequence[ShapeFacts]]


def explain(word: str, results: ResultFacts) -> str:
    """What "results", "results.KIND" or "results.KIND.KEY" mean, or "results.verdict"; KeyError with the nearest known word where there is none."""
    path = word.split(".", 2)[1:]
    if not path:
        rows = [f"{kind:16} {shape.summary.removeprefix(f'{kind}: ')}" for kind, shapes in results.kinds.items() for shape in shapes]
        return "Results of an analysis, in summary.json and as run[NAME]:\n  " + "\n  ".join(rows)
    kind, *rest = path
    if path[-1] in results.beside:
        return f"{path[-1]}: {_told(results.beside[path[-1]])}"
    if kind not in results.kinds:
        raise KeyError(f"no analysis is of kind '{kind}'" + _near(kind, list(results.kinds)))
    shapes = results.kinds[kind]
    if not rest:
        return "\n".join(_told(shape) for shape in shapes)
    known = {f.key: f for shape in shapes for f in shape.facts}
    within = (f"{rest[0]}.", f"{rest[0]}[].")
    found = [f for key, f in known.items() if key == rest[0] or key.startswith(within)]
    found = found or [f for key, f in known.items() if key.rsplit(".", 1)[-1] == rest[0]]
    if not found:
        raise KeyError(f"the results of {kind} contain no key '{rest[0]}'" + _near(rest[0], list(known)))
    return "\n".join(f"{SECTION}.{kind}.{_line(f)}" for f in found)


def _near(word: str, known: list[str]) -> str:
    close = difflib.get_close_matches(word, known, n=3, cutoff=0.4)
    return f"; near are {', '.join(close)}" if close else ""


def _told(shape: ShapeFacts) -> str:
    return f"{shape.summary}\n" + "\n".join(f"  {_line(f)}" for f in shape.facts)


def _line(f: Fact) -> str:
    unit, source = f" [{f.unit}]" if f.unit else "", f" ({f.source})" if f.source else ""
    return f"{f.key}{unit}: {f.about}{source}" + ("" if f.always else "; if applicable")


def manual(results: ResultFacts) -> str:
    """The reference manual of all results, in Markdown."""
    lines = [
        "# Results reference",
        "",
        "Generated from the result models by `extrados explain --results`. Keys are those of `summary.json`;",
        ("`[]` denotes the rows of a list, and `.NAME` an entry of a table of names. From Python they read as"),
        '`run["tilt"].collapse_acceleration_g` or `run["tilt"]["collapse_acceleration_g"]`.',
        "",
        "## Every analysis",
        "",
        "In addition to its results, each analysis gives the following.",
        "",
    ]
    heads = {"verdict": "verdict", "assumptions": "assumptions.KEY", "self-weight": "results of a building that cannot stand"}
    for name, shape in results.beside.items():
        lines += [f"### {heads[name]}", "", shape.summary, "", *_table(shape)]
    for kind, shapes in results.kinds.items():
        lines += [f"## {kind}", ""]
        for shape in shapes:
            lines += [shape.summary, "", *_table(shape)]
    return "\n".join(lines).rstrip() + "\n"


def _table(shape: ShapeFacts) -> list[str]:
    rows = ["| key | meaning | unit | given |", "|---|---|---|---|"]
    for f in shape.facts:
        about = (f.about + (f" ({f.source})" if f.source else "")).replace("|", "\\|")
        rows.append(f"| `{f.key}` | {about} | {f.unit} | {'always' if f.always else 'if applicable'} |")
    return [*rows, ""]
