"""The page as a whole: presets, a server that dies, two pages at once, exercises, a tablet, a widget, names for all."""

import base64
import os
import re
import signal
from typing import Any

import pytest
from hands import ROCKING, capacity, drag, settled, until
from served import SHOTS, Served

import extrados


def test_all_presets_open_or_say_why_not(page: Any) -> None:
    names = page.evaluate("window.extrados.welcome.presets.map(p => p.name)")
    assert len(names) > 80
    told = page.evaluate(
        """async names => {
            const bad = {};
            for (const preset of names) await new Promise(done => window.extrados.ask({ do: "open", preset }, { reply: words => {
                if (words.bad || words.complaints) bad[preset] = (words.complaints ?? [words.bad]).join();
                done();
            } }));
            return bad;
        }""",
        names,
    )
    assert told == {}


def test_a_dead_server_is_reported_and_comes_back_with_the_state(page: Any, served: Served) -> None:
    drag(page, "[data-handle=thickness] .hit", 0, -15)
    text, shown = settled(page), capacity(page)
    (child,) = served.children()
    os.kill(child, signal.SIGKILL)
    page.wait_for_selector(".banner:not([hidden])")
    assert "does not answer" in page.locator(".banner").text_content()
    page.wait_for_selector(".banner", state="hidden")
    assert settled(page) == text
    assert capacity(page) == shown
    drag(page, "[data-handle=thickness] .hit", 0, -10)
    assert settled(page) != text
    assert capacity(page) != shown


def test_a_server_that_is_begun_anew_has_the_deck_of_the_last_page(page: Any, served: Served) -> None:
    """The whole program is killed and started again: its address is new. The open page says so and where its deck is."""
    drag(page, "[data-handle=thickness] .hit", 0, -15)
    text = settled(page)
    port = served.address.split("/")[2].split(":")[1]
    os.killpg(served.process.pid, signal.SIGKILL)
    served.process.wait()
    until(page, "document.querySelector('.banner').textContent.includes('does not answer')")
    again = Served(served.folder, "--port", port)
    try:
        until(page, "document.querySelector('.banner').textContent.includes('was started again')")
        assert page.evaluate("window.extrados.text") == text
        page.goto(again.address)
        page.wait_for_selector("[data-handle=thickness]")
        page.get_by_role("button", name="Open…", exact=True).click()
        page.get_by_role("button", name="the deck of your last page").click()
        until(page, "text => window.extrados.text === text", arg=text)
    finally:
        again.close()


def test_two_pages_do_not_disturb_each_other(page: Any, served: Served) -> None:
    other = page.context.new_page()
    other.goto(served.address)
    other.wait_for_selector("[data-handle=thickness]")
    before = settled(other)
    drag(page, "[data-handle=thickness] .hit", 0, -15)
    assert settled(page) != before
    assert settled(other) == before
    other.close()


def test_the_ten_lessons(page: Any) -> None:
    page.click("[data-side=teach]")
    assert page.locator(".exercises li").count() == 10
    changes: list[dict[str, Any] | None] = [
        {"structure.thickness": 0.54},
        None,
        None,
        {"motion.amplitude": "0.6 g", "motion.duration": 0.45},
        {"structure.width": 2.0, "structure.height": 8.0},
        None,
        {"structure.thickness": 0.536},
        {"structure.radius": 7.165, "structure.embrace": 74.36},
        None,
        {"structure.width": 1.4},
    ]
    for k, given in enumerate(changes):
        page.click("[data-side=teach]")
        page.click(f".exercises button >> nth={k}")
        until(page, f"window.extrados.name === 'lesson-{k + 1}.toml'")
        settled(page)
        assert page.locator(".exercise .first").is_disabled(), "a prediction comes first"
        page.locator(".exercise input[type=radio]").first.check()
        page.click(".exercise .first")
        page.wait_for_selector(".told.bad")
        if given:
            page.evaluate("c => window.extrados.change(c)", given)
        if k == 1:
            page.evaluate("window.extrados.show({ gamma: window.extrados.scene.capacity.plus_g * 0.99 })")
        elif k == 2:
            _bisect_buttress(page)
        elif k == 4:
            _least_sine(page)
        elif k == 5:
            page.evaluate("window.extrados.show({ through: [0, window.extrados.scene.plus_hinges ? 3.71 : 0] })")
        elif k == 8:
            page.evaluate("window.extrados.change({ 'analysis.tilt.load': [{ x: -2.4, force: 52000 }] })")
        settled(page)
        page.click(".exercise .first")
        page.wait_for_selector(".told.good", timeout=20_000)
        assert (
            "prediction was right" in page.locator(".history").inner_text() or "The right answer" in page.locator(".history").inner_text()
        )
        page.screenshot(path=SHOTS / f"lesson-{k + 1}.png")


def test_it_is_usable_on_a_tablet_and_in_the_dark(page: Any) -> None:
    settled(page)
    page.set_viewport_size({"width": 820, "height": 1100})
    until(page, "document.querySelector('.stage').getBoundingClientRect().right <= 820")
    until(page, "document.querySelector('[data-handle=thickness] .dot').getBoundingClientRect().right < 820")
    page.screenshot(path=SHOTS / "tablet.png")
    assert page.locator("[data-handle=thickness] .dot").bounding_box()["x"] > 0
    page.set_viewport_size({"width": 1280, "height": 720})
    page.click("[aria-label='Dark or light']")
    page.wait_for_timeout(200)
    page.screenshot(path=SHOTS / "dark.png")
    assert page.evaluate("getComputedStyle(document.querySelector('.extrados')).backgroundColor") == "rgb(21, 24, 29)"


def test_the_page_is_a_widget(browser: Any, tmp_path: Any) -> None:
    """The module that a notebook loads, with a model that hands its messages to the widget in Python."""
    pytest.importorskip("anywidget")
    from extrados.explore import widget

    (tmp_path / "mine.toml").write_text(ROCKING)
    made = widget.Page.of(tmp_path / "mine.toml", 640)
    sent: list[str] = []
    made.send = lambda content, buffers: sent.extend(base64.b64encode(b).decode() for b in buffers)

    def answer(message: Any) -> list[str]:
        sent.clear()
        made._answer(made, message, [])
        return list(sent)

    context = browser.new_context(viewport={"width": 1000, "height": 700})
    page = context.new_page()
    page.expose_function("answer", answer)
    traits = {"modules": made.modules, "look": made.look, "height": made.height}
    page.evaluate(
        """async ([source, traits]) => {
            const url = URL.createObjectURL(new Blob([source], { type: "text/javascript" }));
            const listeners = [];
            const model = {
                get: name => traits[name], on: (_, f) => listeners.push(f), off: () => {},
                send: async message => {
                    for (const text of await window.answer(message)) {
                        const bytes = Uint8Array.from(atob(text), c => c.charCodeAt(0));
                        for (const f of listeners) f({}, [new DataView(bytes.buffer)]);
                    }
                },
            };
            const el = document.createElement("div");
            document.body.append(el);
            await (await import(url)).default.render({ model, el });
            window.extrados = el.extrados;
        }""",
        [widget.LOADER, traits],
    )
    page.wait_for_selector("[data-handle=thickness]")
    drag(page, "[data-handle=thickness] .hit", 0, -12)
    settled(page)
    assert made.deck == page.evaluate("window.extrados.text") != ROCKING
    page.screenshot(path=SHOTS / "widget.png")
    context.close()


def test_every_control_has_a_name(page: Any) -> None:
    settled(page)
    nameless = page.evaluate(
        """() => [...document.querySelectorAll("button, input, select, textarea, [role=slider], [role=img]")]
            .filter(e => !e.closest("[hidden]") && !(e.getAttribute("aria-label") || e.labels?.length || e.textContent.trim() || e.title))
            .map(e => e.outerHTML.slice(0, 120))"""
    )
    assert nameless == []
    sliders = page.evaluate("[...document.querySelectorAll('[role=slider]')].map(e => e.getAttribute('aria-valuetext'))")
    assert all(re.search(r"\d", text) for text in sliders)


def _bisect_buttress(page: Any) -> None:
    low, high = 1.0, 4.0
    for _ in range(14):
        middle = round(0.5 * (low + high), 4)
        page.evaluate("c => window.extrados.change(c)", {"structure.buttress_width": middle})
        settled(page)
        scene = page.evaluate("window.extrados.scene")
        low, high = (low, middle) if scene.get("capacity") and scene["capacity"]["plus_g"] > 0.1 else (middle, high)


def _least_sine(page: Any) -> None:
    least = 0.05
    for amplitude in [round(0.4 * 1.03**k, 4) for k in range(60)]:
        deck = {
            "structure": {"kind": "block", "width": 2.0, "height": 8.0},
            "motion": {"kind": "sine-pulse", "amplitude": f"{amplitude} g", "period": 1.0},
            "analysis": [{"kind": "rocking"}],
        }
        if extrados.run(deck)["rocking"].outcome == "collapse":
            least = amplitude
            break
    page.evaluate("c => window.extrados.change(c)", {"motion.amplitude": f"{least} g"})
