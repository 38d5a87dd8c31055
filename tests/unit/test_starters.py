"""Every starter deck that `extrados new` prints runs as it is, in an empty folder."""

from pathlib import Path

import pytest

from extrados import kinds
from extrados.analyses.context import Context
from extrados.decks.explain import starter
from extrados.decks.reader import read_text
from extrados.running.run import compute

#: Kinds whose files need an extra
NEEDS = {"mesh": "meshio"}


@pytest.mark.parametrize(("section", "kind"), [(section, kind) for section, there in kinds.TABLES.items() for kind in there])
def test_a_starter_runs_as_it_is(section: str, kind: str, tmp_path: Path) -> None:
    if kind in NEEDS:
        pytest.importorskip(NEEDS[kind])
    deck = read_text(starter(kind).encode(), "new.toml", tmp_path)
    asked = {"structure": deck.structure, "motion": deck.motion, "analysis": deck.analyses[0]}[section]
    assert asked is not None and asked.kind == kind
    run = compute(Context(deck, threads=2))
    assert {(a["status"], a["reason"]) for a in run.analyses} == {("ok", "")}
    assert run.analyses[0]["answer"] and not list(tmp_path.iterdir())
