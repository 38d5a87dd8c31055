"""The words of the page in other languages: every text has a translation in every catalogue, with the same values."""

import json
import re
from pathlib import Path
from typing import Any

import pytest

from extrados import kinds
from extrados.decks.explain import starter
from extrados.explore.session import Session

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


def of_the_program() -> list[str]:
    """Texts of the program that the page translates, in the order in which they are tried."""
    listed = (STATIC / "said.js").read_text("utf-8").partition("const TEXTS = [")[2].partition("\n];")[0]
    return [json.loads(line.strip().rstrip(",")) for line in listed.strip().splitlines()]


def marked() -> set[str]:
    return {text for path in STATIC.glob("*.js") for text in texts(path.read_text("utf-8"))} | set(of_the_program())


def test_texts_are_found_with_their_values() -> None:
    assert texts('a = tr`At ${f(x, { y: `${z}` })} m ${w}.`; tr("`b`"); attr`no`') == ["`b`", "At {0} m {1}."]
    assert {path.stem for path in CATALOGUES} == {"it", "es", "fr", "de"} and len(marked()) > 350
    assert len(of_the_program()) == len(set(of_the_program())) > 100


def test_labels_of_handles_and_words_of_results_are_on_the_list(tmp_path: Path) -> None:
    """Of every starter and of a section of three aisles: labels, measures, places of hinges, outcomes of the map."""
    session, seen = Session(tmp_path), set()
    list(session.answer({"do": "hello"}))
    decks: list[dict[str, Any]] = [{"text": starter(kind), "name": "deck.toml"} for kind in kinds.STRUCTURES]
    for source in (*decks, {"preset": "vault/vezelay-like"}, {"preset": "bridge/viaduct"}):
        for reply in session.answer({"do": "open", **source}):
            seen |= {handle["label"] for handle in reply.words.get("handles", [])}
            scene = reply.words.get("scene", {})
            seen |= {row["where"] for way in ("plus", "minus") for row in scene.get(f"{way}_hinges", [])}
            seen |= {name.removesuffix("_m").replace("_", " ") for name in scene.get("measures", {})}
    session.close()
    patterns = [re.compile("(.+?)".join(map(re.escape, re.split(r"{\d}", text)))) for text in of_the_program()]
    assert len(seen) > 60 and sorted(text for text in seen if not any(p.fullmatch(text) for p in patterns)) == []


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
