"""Gestures of tests on the page, and readings of it once it has settled. `settled` waits for all answers that were asked for, `until`
for a condition that comes by itself (maps, runs, films)."""

import time
from collections.abc import Callable
from typing import Any


def drag(page: Any, selector: str, dx: float, dy: float, steps: int = 8) -> None:
    box = page.locator(selector).bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    for k in range(1, steps + 1):
        page.mouse.move(x + dx * k / steps, y + dy * k / steps)
    page.mouse.up()


def until(page: Any, condition: str, arg: Any = None, timeout: float = 60_000) -> None:
    """Wait for a condition; Playwright's own waiting evaluates text in the page, which its policy forbids."""
    end = time.monotonic() + timeout / 1000
    while not page.evaluate(condition, arg):
        assert time.monotonic() < end, f"waited in vain for {condition}"
        page.wait_for_timeout(40)


def settled(page: Any) -> str:
    """The deck's text once the hand rests and all that it asked for is seen."""
    until(page, "window.extrados.still")
    return page.evaluate("window.extrados.text")


def capacity(page: Any) -> float:
    return page.evaluate("window.extrados.scene.capacity.plus_g")


def open_text(page: Any, text: str) -> None:
    page.evaluate("text => window.extrados.open({ text, name: 'deck.toml' })", text)
    until(page, "text => window.extrados.text === text", arg=text)
    settled(page)


def data_of(text: str) -> dict[str, Any]:
    import tomllib

    return tomllib.loads(text)


ROCKING = """title = "Oppenheim's arch"

[structure]
kind = "arch"
radius = 10.0
thickness = 1.5
embrace = 157.5
voussoirs = 7

[motion]
kind = "step-pulse"
amplitude = "0.8 g"
duration = 0.2

[[analysis]]
kind = "tilt"
[[analysis]]
kind = "rocking"
hand_over = false
end_time = 3.0
"""


def draw_line(page: Any, at: Callable[[Any, float, float], tuple[float, float]], a: tuple[float, float], b: tuple[float, float]) -> None:
    """Draw with the mouse from a to b [m]; `at` gives the place of both on the screen."""
    page.mouse.move(*at(page, *a))
    page.mouse.down()
    page.mouse.move(*at(page, 0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])))
    page.mouse.move(*at(page, *b))
    page.mouse.up()


#: Buttons, fields and handles that lie outside of the window, of their scrolled box, or under something else
BEYOND = """() => {
    const seen = e => e.getClientRects().length && !e.closest("[hidden]") && getComputedStyle(e).visibility !== "hidden";
    const scrolls = e => { for (let p = e.parentElement; p; p = p.parentElement) { const s = getComputedStyle(p); if (/auto|scroll/.test(s.overflowX + s.overflowY)) return true; } return false; };
    const out = [];
    for (const e of document.querySelectorAll("button, select, input, textarea, .knob .hit, a")) {
        if (!seen(e) || e.type === "file") continue;
        const r = e.getBoundingClientRect();
        const within = r.left >= -1 && r.top >= -1 && r.right <= innerWidth + 1 && r.bottom <= innerHeight + 1;
        if (!within && !scrolls(e)) out.push((e.getAttribute("aria-label") || e.textContent || e.parentElement.dataset.handle || e.outerHTML).slice(0, 60) + ` ${[r.left, r.top, r.right, r.bottom].map(Math.round)}`);
    }
    return out;
}"""
OVERFLOW = "[document.documentElement.scrollWidth - innerWidth, document.documentElement.scrollHeight - innerHeight]"


def fits(page: Any) -> None:
    assert page.evaluate(OVERFLOW) == [0, 0]
    assert page.evaluate(BEYOND) == []
