"""Limits of validity: every kind of analysis has them, in sentences that are read at once, and the report prints them."""

import re

import pytest

import extrados
from extrados import kinds
from extrados.results.validity import validity_of
from extrados.show.report import write_report


@pytest.mark.parametrize("kind", kinds.ANALYSES)
def test_they_are_sentences(kind) -> None:
    """Each of at most 25 words, and none of the words that LANGUAGE does away with."""
    for text in validity_of(kind):
        assert text.endswith(".")
        for sentence in re.split(r"(?<=[.;:])\s+", text):
            assert 1 < len(sentence.split()) <= 25, sentence
        assert not re.search(r"\b(?:stones?|bears?|falls?|gives? way|come down|brings? down|nobody|for ever)\b", text), text


#: A deck of each kind whose limits were silently empty, as quick as it gets
DECKS = {
    "motion": '[motion]\nkind = "sine-pulse"\namplitude = "0.3 g"\nperiod = 1.0\n[analysis]\nkind = "motion"\nperiods = 10\n',
    "moving-load": (
        '[structure]\nkind = "arch"\nradius = 10.0\nthickness = 1.5\nembrace = 157.5\nvoussoirs = 7\n[joints]\nfriction = 0.7\n'
        '[analysis]\nkind = "moving-load"\ncount = 3\n'
    ),
    "dem-parameters": (
        '[structure]\nkind = "block"\nwidth = 1.0\nheight = 4.0\n[joints]\nnormal_stiffness = 1e9\n[analysis]\nkind = "dem-parameters"\n'
    ),
}


@pytest.mark.parametrize("kind", DECKS)
def test_the_report_prints_them(tmp_path, kind) -> None:
    (tmp_path / "deck.toml").write_text(DECKS[kind])
    run = extrados.run(tmp_path / "deck.toml", tmp_path / "out")
    assert run.analyses[0]["status"] == "ok", run.analyses[0]["reason"]
    page = re.sub(r"\s+", " ", write_report(tmp_path / "out")[0].read_text())
    assert "Limits of validity" in page
    for text in validity_of(kind):
        assert text[:60] in page
