"""Random buildings asked by all strategies: the relations of the registry hold.

Short in the quick suite; `make verify` asks thousands of buildings. A relation that breaks is shown with the smallest deck that
still breaks it. Environment: EXTRADOS_TRIALS, the share of the whole count; EXTRADOS_SEED, another draw.
"""

import importlib
import json
import os
import sys
import zlib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import tomlkit
from asking import ask
from buildings import KINDS
from hypothesis import HealthCheck, Phase, given, seed, settings
from hypothesis import strategies as st
from hypothesis.errors import UnsatisfiedAssumption
from relations import RELATIONS, Relation

from extrados import kinds
from trials import NOTES, SHARE, count_of

#: The chapters of the registry
CHAPTERS = (
    "invariance",
    "files",
    "proportion",
    "bounds",
    "agreement",
    "promises",
    "conservation",
    "elements",
    "fields",
    "geometry",
    "sums",
    "definitions_codes",
    "definitions_elements",
    "definitions_statics",
    "definitions_statistics",
    "definitions_keys",
    "kernels",
    "crowds",
    "meanings",
    "outputs",
    "joins",
    "frames",
    "ways",
    "seldom",
    "divisions",
    "seams",
)
for chapter in CHAPTERS:
    importlib.import_module(chapter)
#: Buildings that a whole run asks at least, and each relation of share 1; in the quick suite, those of a costly relation none
WHOLE, EACH, QUICK = 2000, 36, 2
COSTLY = 0.3
#: Buildings that one relation asks at most, per share: a whole run ends within the hour of `make verify`
MOST, MOST_OF_SLOW = 18, 5
#: Relations whose buildings take more than a second each: the quick suite asks none
SLOW = {
    "a-deck-as-text-and-as-objects",
    "a-deck-through-json",
    "a-dome-turned-by-a-lune",
    "a-load-on-solids-acts-on-their-top",
    "a-plinth-by-codes",
    "a-section-through-files",
    "a-stronger-tie",
    "arrays-tables-and-results-of-one-name",
    "bounds-of-solids",
    "dilatancy-helps",
    "dowels-of-a-column-at-rest",
    "forces-of-blocks-are-their-momentum",
    "heights-of-mechanisms",
    "layers-that-are-switched-off",
    "noise-of-solids",
    "rougher",
    "solids-through-compas",
    "statics-of-another-density",
    "strength-of-barrels",
    "supports-that-move-in-space",
    "stouter",
    "translation-of-a-section",
}
#: Those whose examples take as long
SLOW_EXAMPLES = {"noise-of-solids", "solids-through-compas"}
#: With a fault planted the smallest case is not looked for
PHASES = (Phase.generate,) if "EXTRADOS_FAULTS" in os.environ else (Phase.generate, Phase.shrink)
SEED = int(os.environ.get("EXTRADOS_SEED", "1"))
#: What each relation was asked: name -> cases; and those that broke
ASKED: dict[str, int] = {}
BROKEN: list[str] = []


def text_of(case: Any) -> str:
    """A case as decks in TOML, as far as it holds decks."""
    parts = case if isinstance(case, tuple) else (case,)
    shown = []
    for part in parts:
        part = json.loads(json.dumps(part, default=lambda v: v.tolist() if isinstance(v, np.ndarray) else repr(v)))
        shown.append(tomlkit.dumps(part) if isinstance(part, dict) and "structure" in part else repr(part))
    return "\n".join(shown)


def checked(relation: Relation, case: Any) -> None:
    """One case, counted; a rejection outside of hypothesis is none."""
    ASKED[relation.name] = ASKED.get(relation.name, 0) + 1
    try:
        relation.check(case)
    except UnsatisfiedAssumption:
        ASKED[relation.name] -= 1
        raise


def examples(relation: Relation) -> None:
    """The cases that broke it once."""
    for case in relation.examples:
        try:
            checked(relation, case)
        except UnsatisfiedAssumption:
            raise RuntimeError(f"{relation.name}: an example gives nothing to compare\n{text_of(case)}") from None
        except AssertionError as error:
            raise AssertionError(f"{relation.name}: {error}\n{text_of(case)}") from error


def random_cases(relation: Relation, count: int) -> None:
    """As many random cases; the smallest that breaks it is shown."""
    last: list[Any] = []
    before = ASKED.get(relation.name, 0)
    simplest = iter([SHARE > 0.0])  # what hypothesis begins with, of which many faults change nothing: beside the count

    @seed(zlib.crc32(relation.name.encode()) + SEED)
    @settings(
        max_examples=count + (SHARE > 0.0),
        database=None,
        deadline=None,
        suppress_health_check=list(HealthCheck),
        report_multiple_bugs=False,
        phases=PHASES,
        print_blob=False,
    )
    @given(relation.case)
    def one(case: Any) -> None:
        last[:] = [case]
        if not next(simplest, False):
            checked(relation, case)

    try:
        one()
    except Exception as error:
        BROKEN.append(relation.name)
        shown = text_of(last[0]) if last else ""
        raise AssertionError(f"{relation.name}: {error}\n\nThe smallest case:\n{shown}") from error
    if ASKED.get(relation.name, 0) == before:  # the simplest, which is left out, counts for hypothesis, and may be the only one
        try:
            checked(relation, last[0])
        except UnsatisfiedAssumption as error:
            BROKEN.append(relation.name)
            raise AssertionError(f"{relation.name}: no case gives anything to compare, as {text_of(last[0])}") from error


def most_of(relation: Relation) -> int:
    """How many buildings a whole run asks a relation."""
    return MOST_OF_SLOW if relation.name in SLOW else max(1, round(MOST * relation.share))


def expected(relation: Relation) -> Any:
    """A relation that a known fault breaks is expected to be broken by its examples."""
    marks = [pytest.mark.verify] if relation.name in SLOW_EXAMPLES else []
    if relation.awaits:
        marks.append(pytest.mark.xfail(reason=f"awaits {relation.awaits}", strict=True, raises=AssertionError))
    return pytest.param(relation, id=relation.name, marks=marks)


def test_every_kind_of_structure_is_drawn() -> None:
    assert set(KINDS) == set(kinds.STRUCTURES)


def test_every_known_fault_has_a_deck() -> None:
    assert len(RELATIONS) >= 40 and SLOW | SLOW_EXAMPLES <= set(RELATIONS)
    for relation in RELATIONS.values():
        assert relation.holds.__doc__ and (relation.examples or not relation.awaits), relation.name
        assert set(relation.asks) <= set(kinds.ANALYSES), relation.name


@pytest.mark.parametrize("relation", [expected(r) for r in RELATIONS.values() if r.examples])
def test_what_broke_once(relation: Relation) -> None:
    examples(relation)


@pytest.mark.parametrize("relation", [pytest.param(r, id=r.name) for r in RELATIONS.values() if not r.awaits])
def test_relation(relation: Relation) -> None:
    few = 0 if relation.share < COSTLY or relation.name in SLOW else round(QUICK * max(1.0, relation.share))
    least = max(few, 1) if SHARE > 0.0 else few  # a share of few cases is one at least
    if count := min(count_of(round(EACH * relation.share), least), most_of(relation)):
        try:
            random_cases(relation, count)
        finally:
            if SHARE >= 1.0:  # each for itself: the relations are shared out among processes
                row = {"asked": ASKED.get(relation.name, 0), "broken": relation.name in BROKEN}
                (place := NOTES / "relations").mkdir(parents=True, exist_ok=True)
                (place / f"{relation.name}.json").write_text(json.dumps(row), encoding="utf-8")


def test_draws_do_not_depend_on_what_is_loaded(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The same seed, before and after a module with numbers that are admissible is loaded."""

    def drawn() -> list[int]:
        found: list[int] = []

        @seed(SEED)
        @settings(max_examples=200, database=None, phases=(Phase.generate,))
        @given(st.integers(0, 10**6))
        def one(value: int) -> None:
            found.append(value)

        one()
        return found

    before = drawn()
    (tmp_path / "numbers_of_a_program.py").write_text(f"NUMBERS = {list(range(1000, 2000))}\n", encoding="utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    module = importlib.import_module("numbers_of_a_program")
    monkeypatch.setitem(sys.modules, module.__name__, module)  # and taken out again
    assert drawn() == before


def test_a_whole_run_runs_enough_buildings() -> None:
    assert sum(most_of(r) for r in RELATIONS.values() if not r.awaits) >= WHOLE


@pytest.mark.skipif("EXTRADOS_FAULTS" in os.environ, reason="with a fault planted the smallest case is not looked for")
def test_a_broken_relation_shows_the_smallest_deck() -> None:
    """The machine itself: a relation that no building keeps."""

    def never(deck: dict, within: float) -> None:
        assert ask(deck, "tilt").capacity[0] < 0.3, "bears too much"

    decks = st.integers(2, 30).map(lambda k: {"structure": {"kind": "block", "width": k / 20, "height": 1.0}})
    with pytest.raises(AssertionError, match=r"bears too much(.|\n)*The smallest case:\n\[structure\]\nkind = \"block\"\nwidth = 0\.3\n"):
        random_cases(Relation("never", ("tilt",), decks, never, 0.0), 50)
