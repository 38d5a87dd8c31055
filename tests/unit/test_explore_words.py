"""The words of the page in other languages: every text has a translation in every catalogue, with the same values."""

import json
import re
from pathlib import Path

import pytest

STATIC = Path(__file__).resolve().parents[2] / "python" / "extrados" / "explore" / "static"
CATALOGUES = sorted((STATIC / "words").glob("*.json"))


def texts(source: str) -> list[str]:
    """Texts marked by tr in a module, values as {0}, {1}; expressions may hold templates themselves."""
    found = [match[1] for match in re.finditer(r'\btr\("([^"]*)"\)', source)]
    for match in re.finditer(r"\btr`", source):
        at, text, values = match.end(), "", 0
        while source[at] != "`":
            if source.startswith("${", at):
                at, text, values = _end(source, at + 2) + 1, f"{text}{{{values}}}", values + 1
            else:
                text, at = text + source[at], at + 1
        found.append(text)
    return found


def _end(source: str, at: int) -> int:
    """Place of the brace that closes an expression."""
    depth = 0
    while source[at] != "}" or depth:
        depth += {"{": 1, "}": -1}.get(source[at], 0)
        at += 1
    return at


def marked() -> set[str]:
    return {text for path in STATIC.glob("*.js") for text in texts(path.read_text("utf-8"))}


def test_texts_are_found_with_their_values() -> None:
    assert texts('a = tr`At ${f(x, { y: `${z}` })} m ${w}.`; tr("`b`"); attr`no`') == ["`b`", "At {0} m {1}."]
    assert {path.stem for path in CATALOGUES} == {"it", "es", "fr", "de"} and len(marked()) > 350


@pytest.mark.parametrize("path", CATALOGUES, ids=lambda path: path.stem)
def test_catalogues_are_whole(path: Path) -> None:
    """Missing texts are English on the page, and listed here."""
    words = json.loads(path.read_text("utf-8"))
    assert sorted(marked() - words.keys()) == [], "missing"
    assert sorted(words.keys() - marked()) == [], "not on the page"
    wrong = [text for text, said in words.items() if sorted(re.findall(r"{\d}", text)) != sorted(re.findall(r"{\d}", said))]
    assert wrong == [] and all(said.strip() for said in words.values())
    ends = [text for text, said in words.items() if (text[0] == " ", text[-1] == " ") != (said[0] == " ", said[-1] == " ")]
    assert ends == [], "spaces at the ends"
