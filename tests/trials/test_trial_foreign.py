"""Drawings and meshes by their grammars, with hostile words: read, or refused in words; nothing else happens to the reader."""

import os
from pathlib import Path

import foreign
import pytest

import trials
from extrados.decks.reader import make_deck
from extrados.running.check import check_building
from extrados.schema import contained
from extrados.schema.contained import Unreadable, read_contained

SEED = 20261124
BATCH = 500
#: Of so many files one goes through a whole deck, which makes its stones
WHOLE = 50


@pytest.fixture(autouse=True)
def _found_by_the_reader(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv("PYTHONPATH", os.pathsep.join([str(Path(__file__).parent), os.environ.get("PYTHONPATH", "")]))
    contained.end_server()
    yield
    contained.end_server()


@pytest.mark.parametrize("sort", foreign.SORTS)
def test_files_by_the_grammar_of_their_format(sort: str, tmp_path: Path) -> None:
    trial = trials.Trial(f"foreign{sort}", f"files of the format {sort[1:].upper()} that are neither read nor refused in words")
    least = trials.count_of(20_000, 200)
    read = refused = 0
    for first in range(0, least, BATCH):
        end = min(first + BATCH, least)
        try:
            found = read_contained("foreign:try_many", b"", ["ezdxf"], 20 * foreign.SECONDS, sort=sort, seed=SEED, first=first, end=end)
        except Unreadable as error:
            trial.fail(f"{sort} {first} to {end}: {error}")
            continue
        trial.tried += end - first
        read, refused = read + found["read"], refused + found["refused"]
        for text in found["wrong"]:
            trial.fail(text)
    assert read and refused
    deck = make_deck({"structure": {"kind": "blocks", "file": f"a{sort}"}, "analysis": {"kind": "tilt"}}, tmp_path)
    for k in range(0, least, WHOLE):
        (tmp_path / f"a{sort}").write_bytes(foreign.content_of(sort, SEED, k))
        try:
            with trials.patience(300):
                said = check_building(deck).complaints
        except (Exception, trials.TooLong) as error:
            trial.fail(f"{sort} {k}: whole: {type(error).__name__}: {error!s:.200}")
        else:
            if any("its reader ended" in line or "Error: " in line for line in said):
                trial.fail(f"{sort} {k}: whole: {said}")
    trial.notes.append(f"{read} read, {refused} refused")
    trial.close(least)
