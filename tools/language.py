"""How the texts keep the rules of CONTRIBUTING.md, Language: long sentences and words of the glossary's left column, per page."""

import ast
import re
import tomllib
from pathlib import Path
from typing import NamedTuple

ROOT = Path(__file__).resolve().parents[1]
LONG, LONGEST = 25, 40  #: words of a sentence of a page: the rule, and the limit without exception
LONG_SHARE = 0.04  #: of the sentences of a page may be longer than the rule, such as those with formulas
#: Pages made by `make references`, `make verify` and `make docs`: their words come from the package
GENERATED = {"decks.md", "results.md", "verification.md", "gallery.md", "redrawn.md"}
#: Pages of records: quotations of former versions stand in them
RECORDS = {"differences.md", "changelog.md", "contributing.md"}


#: Words of summary.json that keep their former form
STORED = {"left out"}


class Word(NamedTuple):
    """A word of the glossary's left column: the pattern of its occurrences, the word to use, and uses that are right."""

    pattern: str
    use: str
    right: str = ""  #: pattern of occurrences that are no fault
    reason: str = ""  #: why they are none


GLOSSARY = [
    Word(r"\brockers?\b", "rigid-body mechanism"),
    Word(r"\b(?:give|gives|gave|given|giving) way\b|\bsoft bases?\b", "compliant base; settlement"),
    Word(r"\b(?:sink|sinks|sank|sunk|sinking)\b", "settlement"),
    Word(r"\bblows?\b", "impact"),
    Word(
        r"\b(?:falls?|fell|fallen|falling)\b",
        "collapses, overturns; for a quantity: drops",
        r"\bfree fall\b|\bfalling weight\b|\| Falls\b",
        "free fall is a motion of mechanics; Falls is a type",
    ),
    Word(r"\b(?:comes?|came|coming|takes?|br(?:ing|ings|ought)(?: \w+){0,5}) (?:it |them )?down\b", "collapses; causes collapse"),
    Word(r"\bstays? up\b", "stands, does not collapse"),
    Word(r"\bhold (?:it|them) from\b", "restrains"),
    Word(r"\bnobody\b", "name the unknown: it is indeterminate, uncertain"),
    Word(r"\b(?:goes|go|going) on\b", "continues"),
    Word(r"\b(?:bears?|bore|borne)\b", "carries, resists; capacity"),
    Word(r"\b(?:fly|flies|flew|flying)\b", "airborne, detached", r"\bflying buttress(?:es)?\b", "a member of a church"),
    Word(r"\b(?:what holds|holding|holds it|holds them)\b", "restraint (tie, damper, prop)"),
    Word(r"\b(?:turn|turns|turned|turning)\b", "rotation, rotated", r"\bin turn\b", "one after the other"),
    Word(r"\bpush(?:es)? of (?:a|an|the)\b|\bconstant push\b", "pushover; constant lateral load"),
    Word(r"\bload curves?\b", "capacity curve, load-displacement curve"),
    Word(r"\bsafe pockets?\b", "safe region inside the failure domain"),
    Word(r"\bfactor on the train\b", "live-load factor"),
    Word(r"\b(?:hang|hangs) on\b", "depends on; sensitivity"),
    Word(r"\blast digits?\b", "chaotic: sensitive to perturbations of 1e-6"),
    Word(r"\b(?:told|tells?|telling)\b", "reported, states"),
    Word(r"\b(?:asks?|asked|asking)\b", "requires, requested"),
    Word(r"\bknows?\b", "includes, has, recognises"),
    Word(r"\b(?:left|leaves?|leaving) out\b", "neglected, not considered"),
    Word(
        r"\b(?:answer|answers|answered|answering)\b",
        "result; conclusion",
        r"\bno-answer\b|\bp\.answer\b",
        "a word of summary.json; a class of style sheets",
    ),
    Word(
        r"\brooms?\b",
        "module, package",
        r"\b(?:rooms? of (?:a|the) (?:building|house)|two rooms|rooms and|one room|two-rooms?)\b",
        "rooms of buildings",
    ),
    Word(r"\blost at once\b|\bat once\b", "brittle; immediately, together"),
    Word(r"\bproofs?\b", "certificate", r"\bdamp-proof\b", "a layer of a wall"),
    Word(r"\b(?:for ever|the clock|goes? round|as it is|lets? be|takes? away|taken away|looks? at|looked at)\b", "no metaphor"),
    Word(
        r"\bstands? (?:on|in|by|beside|for|at|over)\b",
        "is supported by, is in, is listed with",
        r"\bcannot stand\b|\bmay stand by jamming\b",
        "words of an outcome and of a message",
    ),
    Word(r"\bwhat\b(?![^.?!]*\?)", "name the subject"),
    Word(r"\bwhere (?:there|none|no|it|they|one|nothing|neither|both|that)\b", "if, unless, in ... that"),
]

#: Rows of the glossary of CONTRIBUTING.md that no pattern holds, each with its reason
NOT_LINTED = {
    "stones (in general)": "whether a sentence means blocks in general or stones, units or voussoirs is seen by a reader alone",
    "demand, capacity": "kept",
    "tilt (as analysis)": "the key is kept; the analysis is named in backquotes",
    "deck": "the first use on a page is seen by a reader alone",
    "the joints would have to be 1.05 times as long": "one sentence of a message, not a word",
    "a motion by which loads do work that no joint takes": "one sentence of a message, not a word",
    "saw-tooth, thrust line, voussoir, springing, embrace, extrados, haunch": "kept",
}


def pages() -> list[Path]:
    """README, CONTRIBUTING and the written pages of docs."""
    pages = sorted((ROOT / "docs").rglob("*.md"))
    written = [page for page in pages if page.name not in GENERATED | RECORDS and page.parent.name not in ("verification", "_made")]
    return [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *written]


def comments(fence: re.Match[str]) -> str:
    """Comments of a block of code, as paragraphs."""
    return "\n\n".join(re.findall(r"(?:^|\s)#\s+(.*)$", fence[0], re.M))


def prose(text: str) -> str:
    """Text of a page of Markdown, and comments of its code, without code, links' targets and HTML; words in backquotes become one word."""
    text = re.sub(r"<!-- language: off -->.*?<!-- language: on -->|<!--.*?-->", "", text, flags=re.S)
    text = re.sub(r"^ *```.*?^ *```", comments, text, flags=re.S | re.M)
    text = re.sub(r"`[^`]*`", "CODE", text)
    text = re.sub(r"\$[^$]*\$", "FORMULA", text)
    text = re.sub(r"!?\[([^\]]*)\]\([^)]*\)", r"\1", text)
    return re.sub(r"<[^>]+>|[*_]{2}", "", text)


def sentences(text: str) -> list[str]:
    """Of prose: paragraphs, items of lists and cells of tables, split at full stops."""
    found: list[str] = []
    for block in re.split(r"\n\s*\n|^(?=\s*(?:[-*]|\d+\.) )|^#.*$", text, flags=re.M):
        rows = block.splitlines()
        cells = [cell for row in rows if row.lstrip().startswith("|") for cell in row.strip().strip("|").split("|")]
        plain = " ".join(row for row in rows if not row.lstrip().startswith("|"))
        for piece in [plain, *cells]:
            plainer = re.sub(r"\b(Figs?|Eqs?|al|Eng|Struct|Dyn|e\.g|i\.e)\.", r"\1", re.sub(r"\s+", " ", piece).strip(" -*"))
            parts = re.split(r"(?:(?<=[.!?])|(?<=[.!?][)\]\"]))\s+(?=[A-Z(\[\"*0-9]|\w+\.md|\w_)", plainer)
            found += [part for part in parts if len(part.split()) > 1]
    return found


def words(text: str) -> set[str]:
    """Words of the left column that a text has, in lower case."""
    return {hit.partition("'")[2].partition("'")[0].lower() for hit in hits(text)}


def hits(text: str) -> list[str]:
    """Occurrences of words of the left column, each as "found: use this"."""
    found = []
    for word in GLOSSARY:
        spared = re.sub(word.right, "", text, flags=re.I) if word.right else text
        found += [f"{m[0]!r}: {word.use}" for m in re.finditer(word.pattern, spared, re.I)]
    return found


def strings(source: str) -> list[str]:
    """Texts of a Python file that a user may read: string constants of two words or more; docstrings are none of them."""
    tree = ast.parse(source)
    docstrings = {
        id(node.body[0].value)
        for node in ast.walk(tree)
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef)
        and node.body
        and isinstance(node.body[0], ast.Expr)
    }
    found = [node for node in ast.walk(tree) if isinstance(node, ast.Constant) and id(node) not in docstrings]
    return [node.value for node in found if isinstance(node.value, str) and len(node.value.split()) >= 2]


def files() -> list[Path]:
    """Python files of the package."""
    return sorted(path for path in (ROOT / "python" / "extrados").rglob("*.py"))


def decks() -> list[Path]:
    """Decks of `cases/` and their files of expectations."""
    return sorted((ROOT / "cases").rglob("*.toml"))


def deck_prose(source: str) -> str:
    """Title, note and comments of a deck; sources of the rows of a file of expectations."""
    data = tomllib.loads(source)
    remarks = re.findall(r"(?:^|\s)#\s*(.*)$", source, re.M)
    sources = [row.get("source", "") for row in data.get("expect", [])]
    return "\n\n".join([data.get("title", ""), data.get("note", ""), *remarks, *sources])


def faulty() -> dict[str, set[str]]:
    """Files of the package with words of the left column, by path."""
    texts = {path: strings(path.read_text(encoding="utf-8")) for path in files()}
    found = {path: {word for text in there if text not in STORED for word in words(text)} for path, there in texts.items()}
    return {path.relative_to(ROOT).as_posix(): there for path, there in found.items() if there}


def main() -> None:
    """A row per page: sentences, those of over 25 and over 40 words, words of the left column."""
    rows = []
    for page in pages():
        text = prose(page.read_text(encoding="utf-8"))
        lengths = [len(sentence.split()) for sentence in sentences(text)]
        counts = (len(lengths), sum(n > LONG for n in lengths), sum(n > LONGEST for n in lengths), len(hits(text)))
        rows.append((page.relative_to(ROOT).as_posix(), *counts))
    rows.append(("all", *(sum(row[k] for row in rows) for k in range(1, 5))))
    print(f"{'page':36} sentences  >25  >40  glossary")
    for name, total, long, longest, found in rows:
        print(f"{name:36} {total:9} {long:4} {longest:4} {found:9}")


if __name__ == "__main__":
    main()
