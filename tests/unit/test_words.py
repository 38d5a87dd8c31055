"""Words of the trade lead to where a thing is found, and the shell completes what the program knows."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from extrados import kinds
from extrados.decks import explain, glossary, manual, synonyms
from extrados.results import explain as result_models
from extrados.results import manual as of_results

DOCS = Path(__file__).resolve().parents[2] / "docs"
TABLES = explain.facts()
RESULTS = result_models.everything()


@pytest.mark.parametrize("line", synonyms.SYNONYMS, ids=lambda line: line.words[0])
def test_every_pointer_leads_somewhere(line: synonyms.Synonym) -> None:
    assert not line.page or (DOCS / line.page).is_file()
    for place in line.see:
        if place.startswith("results."):
            of_results.explain(place, RESULTS)
        else:
            alone = synonyms.Synonym(line.words, "", (place,), "")
            assert manual._pointed(alone, TABLES).strip().count("\n") >= 1, place


def test_words_stand_in_one_line_each() -> None:
    plain = [synonyms.plainly(word) for word in synonyms.words()]
    assert sorted(plain) == sorted(set(plain))


@pytest.mark.parametrize(
    "word",
    ["backfill", "span", "hinge", "hinges", "PGA", "mortar", "voussoir count", "keystone", "springing", "infill", "PGV", "thrust-line"],
)
def test_a_word_of_the_trade_is_known(word: str) -> None:
    assert "Read docs/" in manual.explain(word, TABLES)


def test_terms_of_five_languages_lead_to_what_explain_knows() -> None:
    """Each English word is known; each term has a word in every language; no word of a language is in two terms."""
    assert len(glossary.TERMS) > 60
    for term in glossary.TERMS:
        assert len(term.words) == len(glossary.LANGUAGES) and all(all(words) for words in term.words), term
        assert manual.explain(term.english, TABLES)
    for k, language in enumerate(glossary.LANGUAGES):
        words = [glossary.bare(word) for term in glossary.TERMS for word in term.words[k]]
        assert sorted(words) == sorted(set(words)), language


@pytest.mark.parametrize(
    ("word", "place"),
    [
        ("catena", "[[ties]]"),
        ("tirants", "[[ties]]"),
        ("Bogen", 'kind = "arch"'),
        ("boveda", 'kind = "vault"'),
        ("flèche", "rise"),
        ("cupola", 'kind = "dome"'),
    ],
)
def test_a_word_of_another_language_is_explained(word: str, place: str) -> None:
    assert place in manual.explain(word, TABLES)


def test_a_misspelt_word_of_the_trade_names_the_nearest() -> None:
    with pytest.raises(KeyError, match="backfill"):
        manual.explain("bakfill", TABLES)


def test_every_kind_has_a_line_of_its_own() -> None:
    lines = [manual.first_sentence(table.summary) for table in TABLES if table.kind]
    assert len(set(lines)) == len(lines) == sum(map(len, kinds.TABLES.values()))
    assert all(10 < len(line) < 130 and line.count("(") == line.count(")") for line in lines)


@pytest.mark.parametrize(
    ("typed", "completed"),
    [
        ("extrados new roc", {"rocking", "rocking-spectrum"}),
        ("extrados explain rocking.end", {"rocking.end_time"}),
        ("extrados vers", {"version"}),
    ],
)
def test_the_shell_completes_commands_kinds_and_keys(typed: str, completed: set[str]) -> None:
    """As bash asks for it, by the words of its completion script."""
    asking = {"_EXTRADOS_COMPLETE": "complete_bash", "COMP_WORDS": typed, "COMP_CWORD": str(typed.count(" "))}
    command = "import sys; sys.argv[0] = 'extrados'; from extrados.__main__ import main; main()"
    answer = subprocess.run([sys.executable, "-c", command], env={**os.environ, **asking}, capture_output=True, text=True)
    assert set(answer.stdout.split()) == completed
