"""The page in the language of its reader: that of the browser, or the one chosen under Help."""

import json
import re
from pathlib import Path
from typing import Any

import pytest
from hands import ROCKING, fits, open_text, settled, until
from served import SHOTS, SIZE, Served

from extrados.explore import server

WORDS = {path.stem: json.loads(path.read_text("utf-8")) for path in (server.STATIC / "words").glob("*.json")}


def test_a_browser_in_italian_has_the_page_in_italian(browser: Any, served: Served) -> None:
    """Tabs, numbers beside the drawing, a lesson and its check; a deck keeps its keys."""
    context = browser.new_context(viewport=SIZE, locale="it-IT")
    page = context.new_page()
    page.set_default_timeout(60_000)
    page.goto(served.address)
    page.wait_for_selector("[data-handle=thickness]")
    assert page.locator("html").get_attribute("lang") == "it"
    assert page.locator("[data-tab=motion]").inner_text() == "Moto"
    assert "Capacità verso +x" in page.locator(".page.answer").inner_text()
    page.click("[data-side=teach]")
    page.click("text=La lapide")
    settled(page)
    page.click("text=Un blocco grande il doppio ha la stessa capacità.")
    page.click(".exercise button.first")
    until(page, "document.querySelector('.told').textContent.startsWith('Con una larghezza di ')")
    page.screenshot(path=SHOTS / "language-it.png")
    assert 'kind = "block"' in page.evaluate("window.extrados.text")
    assert not page.evaluate("document.documentElement.scrollWidth > innerWidth")
    context.close()


#: Words of a language that are English words too
LOANS: dict[str, tuple[str, ...]] = {"it": (), "es": (), "fr": ("joint", "rotation"), "de": ()}
ENGLISH = re.compile(r"\b(the|of|and|at|thickness|height|joint|hinges|springing|rocks|recovers|time|rotation|rocking)\b", re.I)


@pytest.mark.parametrize(("language", "size"), [("it", (1366, 768)), ("es", (1366, 768)), ("fr", (390, 844)), ("de", (390, 844))])
def test_handles_hinges_and_responses_are_in_the_language(browser: Any, served: Served, language: str, size: tuple[int, int]) -> None:
    """Of the texts of the program too: labels, places of hinges, the response and its conditions; nothing overflows."""
    context = browser.new_context(viewport={"width": size[0], "height": size[1]}, locale=language, has_touch=size[0] < 700)
    page = context.new_page()
    page.set_default_timeout(60_000)
    page.goto(served.address)
    page.wait_for_selector("[data-handle=thickness]")
    open_text(page, ROCKING.replace("Oppenheim's arch", "Oppenheim"))
    words = {"labels": page.evaluate("[...document.querySelectorAll('[role=slider]')].map(e => e.getAttribute('aria-label')).join('; ')")}
    words["hinges"] = page.evaluate(
        "[...document.querySelectorAll('.page.answer h3, .page.answer li, .page.answer th')].map(e => e.textContent).join('; ')"
    )
    fits(page)
    page.evaluate("window.extrados.show({ gamma: 0.6 })")
    settled(page)
    words["why"] = page.evaluate("document.querySelector('.page.answer .verdict').textContent")
    page.evaluate("window.extrados.show({ gamma: 0 })")
    page.click("[data-tab=motion]")
    until(page, "window.extrados.motion.map?.told")
    settled(page)
    words["response"] = page.evaluate("document.querySelector('.outcome').textContent + document.querySelector('.player').textContent")
    words["map"] = page.evaluate("[...document.querySelectorAll('.map-legend, .remark, .lower text')].map(e => e.textContent).join('; ')")
    fits(page)
    page.screenshot(path=SHOTS / f"language-{language}-motion.png")
    context.close()
    english = {
        part: found for part, text in words.items() if (found := [w for w in ENGLISH.findall(text) if w.lower() not in LOANS[language]])
    }
    assert english == {} and all(len(text) > 20 for text in words.values())


def test_a_language_is_chosen_and_the_deck_is_kept(page: Any) -> None:
    open_text(page, ROCKING + "\n# kept\n")
    for language, tab in (("de", "Bauwerk"), ("fr", "Structure"), ("es", "Estructura"), ("en", "Structure")):
        page.click(".top button.icon:has-text('?')")
        with page.expect_event("load"):
            page.select_option("dialog select", language)
        until(
            page,
            "([lang, text]) => document.documentElement.lang === lang && window.extrados?.text === text",
            [language, ROCKING + "\n# kept\n"],
        )
        assert page.locator("#tab-structure").inner_text() == tab and "#" not in page.url
        settled(page)


def test_a_page_without_a_server_keeps_the_language(browser: Any, served: Served, tmp_path: Path) -> None:
    context = browser.new_context(viewport=SIZE, locale="fr-FR", accept_downloads=True)
    page = context.new_page()
    page.set_default_timeout(120_000)
    page.goto(served.address)
    page.wait_for_selector("[data-handle=thickness]")
    page.click(f"text={WORDS['fr']['Export']}")
    with page.expect_download(timeout=180_000) as given:
        page.click(f"text={WORDS['fr']['Page without a server, HTML']}")
    file = tmp_path / "page.html"
    given.value.save_as(file)
    page.goto(file.as_uri())
    page.wait_for_selector(".stage path.stones")
    assert "Poussée maximale" in page.locator(".numbers").inner_text()
    context.close()
