"""The text of `extrados explain` on deck keys and the deck reference, from the facts of the deck tables (`decks.explain`)."""

import difflib
import re
import textwrap
from collections.abc import Sequence
from dataclasses import dataclass

from extrados import kinds
from extrados.decks import glossary, synonyms


@dataclass(frozen=True)
class KeyFacts:
    """One key: its meaning, the source of the formula behind it, type, unit, bounds and default in words, whether it must
    be given."""

    about: str
    source: str
    facts: str
    required: str


@dataclass(frozen=True)
class TableFacts:
    """A table of a deck, header that of its section; kind is "" in a section without kinds. keys: dotted for those of
    tables within it."""

    section: str
    header: str
    kind: str
    summary: str
    keys: dict[str, KeyFacts]


def explain(word: str, tables: Sequence[TableFacts]) -> str:
    """What a key, a kind or a section means; KeyError with the nearest known word where there is none.

    A key may follow its table or its kind: "friction", "joints.friction", "analysis.tilt", "tilt.fracture". Another word
    for a thing ("backfill", "PGA") leads to where the thing is found, and so does one of another language ("catena").
    """
    if word == "materials":
        return "[materials.NAME]: Further materials, with the keys of [material], for the parts that name them."
    if word in kinds.TABLES:
        rows = [f"{table.kind:16} {table.summary}" for table in tables if table.section == word]
        return f"[{word}] takes kind =\n  " + "\n  ".join(rows)
    found = []
    known: set[str] = set(kinds.TABLES)
    for table in tables:
        known |= {table.kind or table.section, *(name.rsplit(".", 1)[-1] for name in table.keys)}
        if word in (table.kind or table.section, f"{table.section}.{table.kind}"):
            rows = [textwrap.indent(_entry(table, name), "  ") for name in table.keys]
            head = f'[{table.section}] kind = "{table.kind}"' if table.kind else table.header
            found.append(f"{head}: {table.summary}\n" + "\n".join(rows))
        asked = [name for name in table.keys if word in _called(table, name)]
        found += [_entry(table, name) for name in table.keys if any(name == one or name.startswith(f"{one}.") for one in asked)]
    found += [_pointed(line, tables) for line in synonyms.meanings(word)]
    foreign: dict[str, list[str]] = {}
    for language, term in glossary.translated(word):
        if term.english != word:
            foreign.setdefault(term.english, []).append(language)
    found += [f"{word} ({', '.join(of)}): {english}\n{explain(english, tables)}" for english, of in foreign.items()]
    if not found:
        known |= set(synonyms.words())
        close = difflib.get_close_matches(word, sorted(known), n=3, cutoff=0.4)
        raise KeyError(f"no key or kind '{word}'" + (f"; near are {', '.join(close)}" if close else ""))
    return "\n".join(found)


def _pointed(line: synonyms.Synonym, tables: Sequence[TableFacts]) -> str:
    """What a word of the trade means here, and where it is found."""
    rows = []
    for place in line.see:
        if place.startswith("results."):
            rows.append(f"{place}: see extrados explain {place}")
            continue
        for table in tables:
            if place in (table.kind or table.section, f"{table.section}.{table.kind}"):
                head = f'[{table.section}] kind = "{table.kind}"' if table.kind else table.header
                rows.append(f"{head}: {table.summary}")
            rows += [_entry(table, name) for name in table.keys if "." in place and place in _called(table, name)]
    page = f"\n  Read docs/{line.page}" if line.page else ""
    return f"{', '.join(line.words)}: {line.about}\n" + textwrap.indent("\n".join(rows), "  ") + page


def first_sentence(text: str) -> str:
    """The first sentence of a summary, without what stands in parentheses."""
    return re.split(r"[.;:] (?=[A-Z\[])|; ", re.sub(r" \([^)]*\)", "", text))[0].rstrip(".")


def _called(table: TableFacts, name: str) -> set[str]:
    """What a user may call a key."""
    section, kind = table.section, table.kind
    return {name, name.rsplit(".", 1)[-1], f"{section}.{name}", f"{kind}.{name}", f"{section}.{kind}.{name}"}


def _entry(table: TableFacts, name: str) -> str:
    key = table.keys[name]
    source = f" [{key.source}]" if key.source else ""
    of = f" ({table.kind})" if table.kind else ""
    return f"{table.section}.{name}{of}: {key.about}{source}" + (f"\n    {key.facts}" if key.facts else "")


def manual(tables: Sequence[TableFacts]) -> str:
    """The reference manual of all deck keys, in Markdown."""
    lines = ["# Deck reference", "", "Generated from the deck tables by `extrados explain --manual`.", ""]
    section = ""
    for table in tables:
        if table.section != section:
            section = table.section
            lines += [f"## {table.header}", ""]
        lines += [
            *([f'### kind = "{table.kind}"', ""] if table.kind else []),
            table.summary,
            "",
            "| key | meaning | type and default |",
            "|---|---|---|",
        ]
        for name, key in table.keys.items():
            text = (key.about + (f" ({key.source})" if key.source else "")).replace("|", "\\|")
            required = f", {key.required}" if key.required else ""
            lines.append(f"| `{name}` | {text} | {key.facts.replace('|', chr(92) + '|')}{required} |")
        lines.append("")
    return "\n".join(lines)
