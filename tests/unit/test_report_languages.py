"""Catalogues of the report: complete, with the fields of their English sentences; numbers with the decimal sign."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

import extrados
from extrados import kinds
from extrados.decks.words import LANGUAGES
from extrados.model.properties import Joints, Material, Supports
from extrados.model.structures.bridge import Abutment, Backing, Fill, Pier, Span, Spandrels, Surfacing
from extrados.results.validity import validity_of
from extrados.results.verdict import CHECKED, SHARES
from extrados.schema.code import Code
from extrados.show import language
from extrados.show.building import DIMENSIONS, PARTS, joint_of
from extrados.show.language import NAMES, Language, catalogue
from extrados.show.opening import OUTCOMES, TITLES
from extrados.show.report import write_report
from extrados.show.telling import FACTORS, GROUPS, SERVICE
from extrados.show.template import ENTRIES
from extrados.show.verification import COLUMNS

OTHERS = [code for code in LANGUAGES if code != "en"]
SHOW = Path(language.__file__).parent


def fixed() -> Iterator[str]:
    """Every text that the sources of the report hand to `words`, and those that they choose from tables."""
    for path in SHOW.glob("*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            name = getattr(getattr(node, "func", None), "id", "")
            if not isinstance(node, ast.Call) or name not in ("words", "_heads"):
                continue
            for argument in node.args:
                choices = [argument.body, argument.orelse] if isinstance(argument, ast.IfExp) else [argument]
                yield from (one.value for one in choices if isinstance(one, ast.Constant) and one.value not in (None, ""))
    for kind in kinds.ANALYSES:
        yield from (TITLES[kind], *validity_of(kind))
    yield from (
        *OUTCOMES.values(),
        *DIMENSIONS,
        *PARTS.values(),
        *FACTORS.values(),
        *SERVICE.values(),
        *ENTRIES.values(),
        *(label for label, _ in GROUPS),
    )
    yield from (*CHECKED.values(), *(text for text in COLUMNS if "*" not in text))
    yield from SHARES
    yield from (f"The capacity is {one} bound." for one in ("an upper", "a lower"))
    for table in (Material, Joints, Supports, Code, Span, Pier, Abutment, Backing, Fill, Surfacing, Spandrels):
        yield from (key.replace("_", " ") for key in table.model_fields)


@pytest.mark.parametrize("code", OTHERS)
def test_the_catalogue_is_complete(code: str) -> None:
    missing = sorted({text for text in fixed() if not Language(code).has(text)})
    assert not missing, "\n".join(missing)


@pytest.mark.parametrize("code", OTHERS)
def test_a_translation_has_the_fields_of_its_sentence(code: str) -> None:
    for text, told in catalogue(code).items():
        assert sorted(re.findall(r"\{\w+\}", text)) == sorted(re.findall(r"\{\w+\}", told)), text
        assert told.endswith(".") == text.endswith("."), text


@pytest.mark.parametrize("code", OTHERS)
def test_nothing_in_a_catalogue_is_left_over_or_double(code: str) -> None:
    lines = (SHOW / "languages" / f"{code}.po").read_text().splitlines()
    keys = [line for line in lines if line.startswith("msgid ")]
    assert len(set(keys)) == len(keys)
    assert set(catalogue(code)) == set(catalogue("it")), "the same sentences in all"


def test_languages_of_decks_are_those_of_reports() -> None:
    assert tuple(NAMES) == LANGUAGES


@pytest.mark.parametrize("code", LANGUAGES)
def test_a_report_speaks_one_language_and_marks_what_is_english(tmp_path: Path, code: str) -> None:
    arch = {"kind": "arch", "radius": 2.0, "thickness": 0.4, "embrace": 180.0, "voussoirs": 12}
    extrados.run({"title": "X", "language": code, "structure": arch, "analysis": {"kind": "tilt"}}).write(tmp_path / "out")
    page = (tmp_path / "out" / "report.html").read_text()
    words = Language(code)
    assert f'<html lang="{code}">' in page and words(validity_of("tilt").limits)[:60].replace("'", "&#39;") in page
    assert ("3,60 m" in page) == (code != "en") and ("3.60 m" in page) == (code == "en")
    if code != "en":
        assert 'class="answer" lang="en"' in page and "Limits of validity" not in page and "safety factor<" not in page
        write_report(tmp_path / "out", language="en")
        assert "Limits of validity" in (tmp_path / "out" / "report.html").read_text()


def test_french_separates_colons_and_joints_are_named_in_the_language() -> None:
    french, german = Language("fr"), Language("de")
    assert (french.pair("flèche", "2,87 m"), german.pair("Stich", "2,87 m")) == ("flèche\u00a0: 2,87 m", "Stich: 2,87 m")
    named = [joint_of(german, name) for name in ("A 1 on the ground", "A 1 on A 2", "joint 3")]
    assert named == ["A 1 auf dem Boden", "A 1 auf A 2", "joint 3"]
