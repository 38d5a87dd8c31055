"""What a notebook shows of a run, and the page as its widget."""

import re
import struct
import tomllib
from pathlib import Path

import pytest

import extrados
from extrados.explore.desk import NEW_DECK


def test_a_run_is_a_short_table_and_its_main_figure() -> None:
    deck = tomllib.loads(NEW_DECK.replace("voussoirs = 36", "voussoirs = 8")) | {"title": "<b>An arch</b> & more"}
    deck["analysis"].append({"kind": "rocking"})
    deck["motion"] = {"kind": "step-pulse", "amplitude": "0.01 g", "duration": 0.1}
    page = extrados.run(deck)._repr_html_()
    assert page.count("<tr>") == 2
    assert "&lt;b&gt;An arch&lt;/b&gt; &amp; more" in page
    assert "becomes a mechanism" in page
    assert page.count("<img") == 1
    words = re.sub(r'src="[^"]*"', "", page)
    assert len(words) < 3000, "words, not arrays"
    assert "array" not in words


def test_what_was_refused_says_so() -> None:
    deck = tomllib.loads(NEW_DECK)
    assert "refused: " in extrados.run(deck | {"material": {"density": 0.0}})._repr_html_()
    thin = tomllib.loads(NEW_DECK.replace("thickness = 0.75", "thickness = 0.2"))
    page = extrados.run(thin)._repr_html_()
    assert "refused: " not in page and "The structure cannot stand: it collapses under its own weight." in page


def test_the_widget_answers_like_the_page(tmp_path: Path) -> None:
    pytest.importorskip("anywidget")
    (tmp_path / "mine.toml").write_text(NEW_DECK.replace("0.75", "0.8"))
    page = extrados.widget(tmp_path / "mine.toml")
    names = [name for name, _ in page.modules]
    for name, source in page.modules:
        for other in re.findall(r'from "\./(\w+\.js)"', source):
            assert names.index(other) < names.index(name)
    sent: list[bytes] = []
    page.send = lambda content, buffers: sent.extend(buffers)
    page._answer(page, {"do": "hello", "of": 1}, [])
    page._answer(page, {"do": "drag", "of": 2, "handle": "thickness", "text": "90 cm"}, [])
    page._answer(page, {"nothing": 1}, [])
    assert len(sent) == 3
    (length,) = struct.unpack_from("<I", sent[-1])
    assert b'"capacity"' in sent[-1][4 : 4 + length]
    assert "thickness = 0.9" in page.deck


def test_the_widget_takes_what_a_run_takes(tmp_path: Path) -> None:
    """A file, a dictionary, a deck of objects, or none: the deck of the page gives the same results."""
    pytest.importorskip("anywidget")
    arch = extrados.Arch(radius=5.0, thickness="80 cm", embrace=150.0, voussoirs=9)
    deck = extrados.deck(arch, extrados.Tilt(), joints=extrados.Joints(friction=0.5), folder=tmp_path)
    wanted = extrados.run(deck)["tilt"].collapse_acceleration_g
    (tmp_path / "mine.toml").write_text(extrados.widget(deck).session.first_text)
    for given in (deck, deck.data, tmp_path / "mine.toml", str(tmp_path / "mine.toml")):
        page = extrados.widget(given)
        page.send = lambda content, buffers: None
        page._answer(page, {"do": "hello", "of": 1}, [])
        assert extrados.run(tomllib.loads(page.deck))["tilt"].collapse_acceleration_g == wanted
    assert extrados.widget().session.first_text == NEW_DECK
    with pytest.raises(extrados.DeckError, match="raduis"):
        extrados.widget({"structure": {"kind": "arch", "raduis": 5.0}})
