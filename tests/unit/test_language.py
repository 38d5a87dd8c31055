"""The texts keep the glossary of CONTRIBUTING.md, Language: pages of docs, decks of cases, messages of the package."""

import ast
import importlib.util
import sys
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).resolve().parents[2]


def _tool() -> ModuleType:
    spec = importlib.util.spec_from_file_location("language", ROOT / "tools" / "language.py")
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module
    spec.loader.exec_module(module)
    return module


language = _tool()


@pytest.mark.parametrize("page", language.pages(), ids=lambda p: p.relative_to(ROOT).as_posix())
def test_pages_keep_the_glossary_and_end_their_sentences(page: Path) -> None:
    text = language.prose(page.read_text(encoding="utf-8"))
    assert language.hits(text) == []
    sentences = language.sentences(text)
    assert [s for s in sentences if len(s.split()) > language.LONGEST] == []
    long = [s for s in sentences if len(s.split()) > language.LONG]
    assert len(long) <= max(1, language.LONG_SHARE * len(sentences)), long


@pytest.mark.parametrize("deck", language.decks(), ids=lambda p: f"{p.parent.name}/{p.stem}")
def test_titles_notes_and_sources_of_decks_keep_the_glossary(deck: Path) -> None:
    assert language.hits(language.prose(language.deck_prose(deck.read_text(encoding="utf-8")))) == []


def test_every_row_of_the_glossary_is_linted_or_has_a_reason() -> None:
    page = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    table = page.partition("### Glossary")[2].partition("### ")[0]
    left = [line.strip("|").split("|")[0].strip() for line in table.splitlines() if line.startswith("| ")][1:]
    assert len(left) > 30
    assert {cell for cell in left if not language.hits(cell)} == set(language.NOT_LINTED)
    assert all(language.NOT_LINTED.values())
    assert all(bool(word.right) == bool(word.reason) for word in language.GLOSSARY)


def test_messages_of_the_package_keep_the_glossary() -> None:
    assert language.faulty() == {}, "words of the glossary's left column"


def test_makefile_says_its_targets_in_the_words_of_the_glossary() -> None:
    text = (ROOT / "Makefile").read_text(encoding="utf-8")
    comments = [line.partition("#")[2].strip("# ") for line in text.splitlines() if "#" in line]
    assert comments and [hit for comment in comments for hit in language.hits(comment)] == []


def test_tools_keep_the_glossary() -> None:
    """Docstrings and messages; names of quantities that docs/verification.md groups by are data."""
    wrong = {}
    for path in sorted((ROOT / "tools").glob("*.py")):
        if path.name not in ("language.py", "verification_quantities.py"):  # the first holds the glossary
            source = path.read_text(encoding="utf-8")
            kinds = ast.Module | ast.ClassDef | ast.FunctionDef
            nodes = [node for node in ast.walk(ast.parse(source)) if isinstance(node, kinds)]
            texts = [*(ast.get_docstring(node) or "" for node in nodes), *language.strings(source)]
            found = [hit for text in texts for hit in language.hits(text)]
            if found:
                wrong[path.name] = found
    assert wrong == {}


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("The arch bears 3 kN.", 1),
        ("What it does is told.", 2),
        ("A flying buttress, in turn, carries it.", 0),
        ("The base gives way, where there is none.", 2),
        ("What is the load?", 0),
        ("The block is in free fall.", 0),
    ],
)
def test_the_lint_finds_words_of_the_left_column(text: str, found: int) -> None:
    assert len(language.hits(text)) == found


def test_the_lint_reads_sentences_and_messages() -> None:
    page = "# Title\nOne two three (Fig. 5-1). Four five\nsix.\n\n```\nwhat bears\n```\n| seven eight | `what` nine |\n"
    assert [len(s.split()) for s in language.sentences(language.prose(page))] == [5, 3, 2, 2]
    assert language.strings('"""Module, what it bears."""\nraise E(f"{n} the arch bears it")\nz = "key"\n') == [" the arch bears it"]
