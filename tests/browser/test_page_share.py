"""Sharing: a link that holds the deck, and a page without a server."""

import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from hands import ROCKING, capacity, data_of, open_text, settled, until
from served import SHOTS, Served

import extrados
from extrados.schema.places import CASES


def test_a_link_holds_the_deck_and_opens_it_in_another_page(page: Any, served: Served) -> None:
    open_text(page, ROCKING + "\n# ä 中\n")
    page.click("text=Export")
    page.click("text=Link that holds the deck")
    until(page, "document.querySelector('dialog textarea')?.value.length > 0")
    link = page.locator("dialog textarea").input_value()
    assert link.startswith("extrados:#deck=") and len(link) < 400
    assert served.address.split("/")[3] not in link, "the token is nobody's business"
    other = page.context.new_page()
    other.goto(served.address + link.removeprefix("extrados:"))
    until(other, "text => window.extrados?.text === text", ROCKING + "\n# ä 中\n")
    assert "#" not in other.url
    page.keyboard.press("Escape")
    other.evaluate("window.extrados.open({ preset: 'limit/arch-120' })")
    settled(other)
    other.click("text=Open…")
    other.fill("dialog input[type=search]", link)
    until(other, "text => window.extrados.text === text", ROCKING + "\n# ä 中\n")
    bomb = """(async () => {
        const stream = new Blob([new Uint8Array(5e7)]).stream().pipeThrough(new CompressionStream("deflate-raw"));
        let letters = "";
        for (const b of new Uint8Array(await new Response(stream).arrayBuffer())) letters += String.fromCharCode(b);
        return window.extrados.openLink("#deck=" + btoa(letters));
    })()"""
    wrong = ["%%%", "AAAA", "____", "x" * 5000]
    for opened in [*(other.evaluate("link => window.extrados.openLink('#deck=' + link)", w) for w in wrong), other.evaluate(bomb)]:
        assert opened is False
    assert "cannot be read" in other.locator(".status").inner_text()
    settled(other)
    assert other.evaluate("window.extrados.text").startswith(ROCKING)
    other.close()


@pytest.mark.parametrize("preset", ["limit/arch-120", "vault/dejong-a"])
def test_a_page_without_a_server_shows_what_a_run_gives(browser: Any, tmp_path: Path, preset: str) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "extrados", "explore", str(CASES / f"{preset}.toml"), "--standalone", "page.html"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert done.returncode == 0, done.stderr
    file = tmp_path / "page.html"
    assert file.stat().st_size < 3_000_000
    context = browser.new_context(viewport={"width": 1000, "height": 640}, offline=True)
    page = context.new_page()
    troubles: list[str] = []
    page.on("pageerror", lambda error: troubles.append(str(error)))
    page.goto(file.as_uri())
    until(page, "window.extrados?.it?.scene")
    plus = page.evaluate("window.extrados.it.scene.capacity.plus_g")
    deck = data_of((CASES / f"{preset}.toml").read_text())
    deck["analysis"] = [{"kind": "tilt"}]
    deck["structure"]["thickness"] = page.evaluate("parseFloat(window.extrados.data.sizes[window.extrados.it.size])")
    assert plus == pytest.approx(extrados.run(deck)["tilt"].collapse_acceleration_g, rel=1e-9)
    name = preset.replace("/", "-")
    SHOTS.mkdir(parents=True, exist_ok=True)
    page.screenshot(path=SHOTS / f"standalone-{name}.png")
    tilts, sizes = page.locator("input[type=range]").nth(1), page.locator("input[type=range]").nth(0)
    tilts.focus()
    page.keyboard.press("End")
    assert "Collapses towards +x" in page.locator(".verdict").inner_text()
    page.keyboard.press("Home")
    assert "Collapses towards −x" in page.locator(".verdict").inner_text()
    page.screenshot(path=SHOTS / f"standalone-{name}-tilted.png")
    for _ in range(10):
        page.keyboard.press("ArrowRight")
    sizes.focus()
    page.keyboard.press("End")
    assert page.evaluate("window.extrados.it.scene.capacity.plus_g") != plus
    page.set_viewport_size({"width": 390, "height": 844})
    page.wait_for_timeout(200)
    page.screenshot(path=SHOTS / f"standalone-{name}-phone.png")
    assert page.evaluate("document.documentElement.scrollWidth") <= 390
    assert troubles == []
    context.close()


def test_the_page_makes_such_a_file_too(page: Any, tmp_path: Path) -> None:
    settled(page)
    before = capacity(page)
    with page.expect_download(timeout=120_000) as waiting:
        page.click("text=Export")
        page.click("text=Page without a server")
    waiting.value.save_as(tmp_path / "made.html")
    assert 50_000 < (tmp_path / "made.html").stat().st_size < 3_000_000
    settled(page)
    assert capacity(page) == before, "the deck at hand stays as it was"


def test_the_page_is_printed_without_its_buttons(page: Any, tmp_path: Path) -> None:
    """On paper: title, drawing and numbers, light also from the dark page and from another panel."""
    page.evaluate("window.print = () => { window.printed = true; }")
    page.click("[aria-label='Dark or light']")
    page.click("[data-side=teach]")
    page.click("text=Export")
    page.click("text=Print…")
    assert page.evaluate("window.printed") is True
    page.evaluate("dispatchEvent(new Event('beforeprint'))")
    page.emulate_media(media="print")
    assert page.locator(".extrados").get_attribute("data-theme") == "light"
    assert page.locator(".page.answer").is_visible() and "Capacity to +x" in page.locator(".page.answer").inner_text()
    assert page.locator(".stage").is_visible() and page.locator(".page.teach").is_hidden()
    assert page.evaluate("[...document.querySelectorAll('button, select')].every(e => !e.getClientRects().length)")
    page.pdf(path=SHOTS / "print.pdf", format="A4", print_background=True)
    assert (SHOTS / "print.pdf").read_bytes().startswith(b"%PDF")
