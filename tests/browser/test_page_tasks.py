"""Five tasks by the words of the page alone: labels, buttons and texts that a new user sees; no identifier of the page's source.

Each test counts clicks, keys and seconds, and prints them (`pytest -s`). A number above the bound of clicks means that the way has
become longer. The seconds are those of the machine and its load, without a person's reading; they are not bounded.
"""

import re
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pytest
from hands import until


@dataclass
class Newcomer:
    """A user who finds buttons and fields by their labels, and reads the texts of the page."""

    page: Any
    clicks: int = 0
    keys: int = 0
    begin: float = field(default_factory=time.monotonic)

    def press(self, sort: str, name: str) -> None:
        """Click the one visible control of a sort with a name."""
        self.page.get_by_role(sort, name=name, exact=True).click()
        self.clicks += 1

    def reads(self, words: str, timeout: float = 60_000) -> str:
        """Wait until a text is written on the page; the whole text of its element."""
        found = self.page.get_by_text(re.compile(words)).first
        found.wait_for(state="visible", timeout=timeout)
        return found.inner_text()

    def types(self, sort: str, name: str, text: str) -> None:
        """Write into the field that has a label, and leave it with Enter."""
        self.page.get_by_role(sort, name=name, exact=True).fill(text)
        self.page.keyboard.press("Enter")
        self.clicks += 1
        self.keys += len(text) + 1

    def drags(self, handle: str, dx: float, dy: float) -> None:
        """Pull a handle of the drawing by pixels; one press of the button."""
        box = self.page.get_by_role("slider", name=handle, exact=True).locator(".hit").bounding_box()
        x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
        self.page.mouse.move(x, y)
        self.page.mouse.down()
        for k in range(1, 9):
            self.page.mouse.move(x + dx * k / 8, y + dy * k / 8)
        self.page.mouse.up()
        self.clicks += 1

    def done(self, task: str, most: int) -> None:
        """Report the task; more clicks than `most` are a longer way than before."""
        print(f"\n{task}: {time.monotonic() - self.begin:.1f} s, {self.clicks} clicks, {self.keys} keys")
        assert self.clicks <= most


@pytest.fixture
def newcomer(page: Any) -> Iterator[Newcomer]:
    yield Newcomer(page)


def test_make_an_arch_stand(newcomer: Newcomer) -> None:
    newcomer.press("tab", "Sizes")
    newcomer.types("textbox", "thickness", "0.3 m")
    newcomer.press("tab", "Answer")
    newcomer.reads("Cannot stand")
    newcomer.reads(r"the section would have to be [\d.]+ % thicker")
    newcomer.reads("Drag a circle or a diamond of the drawing to change a size")
    newcomer.begin, newcomer.clicks, newcomer.keys = time.monotonic(), 0, 0
    newcomer.drags("Thickness", 0.0, -40.0)
    newcomer.reads("^Stands")
    newcomer.done("make an arch stand", 1)


def test_find_the_least_thickness(newcomer: Newcomer) -> None:
    newcomer.press("tab", "Lessons")
    newcomer.press("button", "The least thickness")
    newcomer.reads("as thin as possible")
    newcomer.press("radio", "about a tenth of the radius")
    handle = newcomer.page.get_by_role("slider", name="Thickness", exact=True)
    handle.focus()
    for _ in range(12):  # coarse steps, then the page says how far it still is
        newcomer.press("button", "Check")
        verdict = newcomer.reads("^(Right|The arch stands at|At 0)")
        if verdict.startswith("Right"):
            break
        ratio = float(re.search(r"0\.\d+", verdict)[0])
        handle.focus()
        steps = max(1, round(abs(ratio - 0.109) * 5.0 / 0.01))
        key = "ArrowDown" if verdict.startswith("The arch stands") else "ArrowUp"
        for _ in range(steps):
            newcomer.page.keyboard.press(key)
        newcomer.keys += steps
        until(newcomer.page, "window.extrados.still")
    assert re.search(r"0\.1[01]", newcomer.reads("^Right: about"))
    newcomer.done("find the least thickness", 12)


def test_play_el_centro(newcomer: Newcomer) -> None:
    page = newcomer.page
    newcomer.press("tab", "Motion")
    newcomer.reads("There is no motion yet: choose one below")
    page.get_by_role("combobox", name="Kind of motion").select_option("El Centro 1940")
    newcomer.clicks += 2
    newcomer.reads("peak ground acceleration 0.319 g")
    clock = page.get_by_role("slider", name="Time", exact=True)
    first = clock.input_value()
    newcomer.press("button", "Play")
    page.get_by_role("button", name="Pause", exact=True).wait_for()
    page.wait_for_timeout(1000)
    assert clock.input_value() != first
    newcomer.done("play El Centro", 4)


def test_send_it_to_a_friend(newcomer: Newcomer, browser: Any, shared: Any, tmp_path: Path) -> None:
    newcomer.press("button", "Export")
    newcomer.press("menuitem", "Link that holds the deck")
    newcomer.reads("Paste the link under Open")
    newcomer.press("button", "Copy")
    newcomer.reads("The link is copied")
    link = newcomer.page.get_by_role("textbox", name="Link that holds the deck").input_value()
    context = browser.new_context()
    friend = Newcomer(context.new_page(), begin=newcomer.begin, clicks=newcomer.clicks)
    friend.page.goto(shared.address)
    friend.press("button", "Open…")
    friend.page.get_by_role("searchbox", name="Find a deck, or paste a link").fill(link)
    friend.clicks += 1
    friend.page.get_by_role("heading", name="A new arch").wait_for()
    until(friend.page, "window.extrados.name === 'shared.toml'")
    friend.done("send it to a friend, who opens it", 5)
    context.close()
    # a friend without the program gets one file
    alone = Newcomer(newcomer.page)
    newcomer.press("button", "Close")
    alone.press("button", "Export")
    with newcomer.page.expect_download(timeout=120_000) as made:
        alone.press("menuitem", "Page without a server, HTML")
    made.value.save_as(tmp_path / "arch.html")
    assert (tmp_path / "arch.html").stat().st_size < 3e6
    alone.done("make one file of it", 2)


def test_print_it(newcomer: Newcomer, tmp_path: Path) -> None:
    page = newcomer.page
    page.evaluate("window.print = () => { window.printed = true; }")
    newcomer.press("button", "Export")
    newcomer.press("menuitem", "Print…")
    until(page, "window.printed === true")
    newcomer.done("print it", 2)
    page.pdf(path=tmp_path / "arch.pdf", format="A4")
    assert (tmp_path / "arch.pdf").stat().st_size > 10_000
