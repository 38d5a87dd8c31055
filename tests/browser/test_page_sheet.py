"""Drawing from nothing: shapes by mouse, finger, keys and sizes on a blank sheet; the deck beside it runs."""

import base64
from typing import Any

import pytest
from hands import capacity, data_of, draw_line, open_text, settled, until
from served import SHOTS

import extrados

#: One white pixel
PNG = base64.b64decode("iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR42mP8/5+hHgAHggJ/PchI7wAAAABJRU5ErkJggg==")


def blank(page: Any) -> None:
    page.click("text=Open…")
    page.click("[data-blank]")
    until(page, "window.extrados.sheet.drawing() && window.extrados.draft !== null")


def at(page: Any, x: float, y: float) -> tuple[float, float]:
    """Where a place of the sheet [m] is on the screen."""
    box = page.locator("svg.sheet:not(.plan)").bounding_box()
    zero = page.evaluate(
        "(() => { const d = document.querySelector('.sheet .ground').getAttribute('d'); return Number(d.match(/M0 ([-0-9.]+)/)[1]); })()"
    )
    k, cx = page.evaluate("window.extrados.sheet.place()")
    return box["x"] + cx + k * x, box["y"] + zero - k * y


def stroke(page: Any, a: tuple[float, float], b: tuple[float, float]) -> None:
    draw_line(page, at, a, b)


def tap(page: Any, x: float, y: float) -> None:
    page.mouse.click(*at(page, x, y))


def blocks(page: Any) -> list[dict[str, Any]]:
    return data_of(page.evaluate("window.extrados.draft?.text ?? window.extrados.text"))["structure"].get("block", [])


def test_an_arch_on_two_piers_is_drawn_and_runs(page: Any) -> None:
    """Two piers and an arch by hand: an incomplete drawing says why; the whole gives the capacity of a run of its deck."""
    blank(page)
    stroke(page, (0.0, 0.0), (1.5, 2.0))
    settled(page)
    assert len(blocks(page)) == 5 and page.evaluate("window.extrados.draft") is None
    page.click("text=Mirror…")
    page.fill("dialog input", "3")
    page.click("text=Draw it")
    settled(page)
    assert len(blocks(page)) == 10
    page.click("[data-tool=arch]")
    stroke(page, (1.5, 2.0), (4.5, 2.0))
    tap(page, 3.0, 3.5)
    settled(page)
    made = blocks(page)
    assert len(made) == 25 and made[-1]["name"] == "arch 1.15"
    assert max(y for b in made for _, y in b["points"]) == pytest.approx(4.0, abs=1e-6)
    assert "[[structure.block]]" in page.evaluate("window.extrados.text")
    assert page.evaluate("window.extrados.draft") is None
    run = extrados.run(data_of(page.evaluate("window.extrados.text")))
    assert run["tilt"].collapse_acceleration_g == pytest.approx(capacity(page), rel=1e-9)
    assert "Stands" in page.locator("svg.sheet:not(.plan) .sheet-words").text_content()
    page.screenshot(path=SHOTS / "sheet-arch.png")
    page.keyboard.press("Control+z")
    settled(page)
    assert len(blocks(page)) == 10
    page.keyboard.press("Control+Shift+z")
    settled(page)
    assert len(blocks(page)) == 25
    page.click("[data-tool=done]")
    assert page.locator("svg.stage").is_visible() and page.locator("[data-handle=tilt]").count()


def test_a_floating_block_is_no_structure_and_says_why(page: Any) -> None:
    blank(page)
    stroke(page, (0.0, 0.0), (1.0, 1.0))
    settled(page)
    page.click("[data-tool=block]")
    for point in ((2.0, 2.0), (3.0, 2.0), (3.0, 3.0), (2.0, 2.0)):
        tap(page, *point)
    until(page, "window.extrados.draft !== null")
    assert "block 1" in page.evaluate("window.extrados.draft.trouble[0]")
    assert "not a structure yet" in page.locator(".page.answer").inner_text()
    page.click("[data-side=deck]")
    assert 'name = "block 1"' in page.locator(".editor textarea").input_value()
    page.click("[data-tool=support]")
    stroke(page, (2.0, 2.0), (3.0, 2.0))
    until(page, "window.extrados.draft === null")
    settled(page)
    assert data_of(page.evaluate("window.extrados.text"))["structure"]["ground"] == [[0, 0, 1, 0], [2, 2, 3, 2]]


def test_the_keyboard_draws_moves_and_removes(page: Any) -> None:
    blank(page)
    page.keyboard.press("Enter")
    for key in ["Shift+ArrowRight", *["ArrowUp"] * 4]:
        page.keyboard.press(key)
    page.keyboard.press("Enter")
    settled(page)
    points = [p for b in blocks(page) for p in b["points"]]
    assert max(p[0] for p in points) == 2.5 and max(p[1] for p in points) == 1.0
    page.click("[data-tool=select]")
    page.locator("svg.sheet:not(.plan)").focus()
    page.keyboard.press("ArrowRight")
    settled(page)
    assert min(p[0] for b in blocks(page) for p in b["points"]) == 0.25
    page.keyboard.press("Delete")
    until(page, "window.extrados.draft !== null")
    assert blocks(page) == []
    page.click("[data-tool=arch]")
    page.click("text=By sizes…")
    page.fill("dialog [aria-label='Clear span']", "6")
    page.fill("dialog [aria-label='Rise']", "3")
    page.keyboard.press("Enter")
    until(page, "window.extrados.draft === null")
    settled(page)
    assert len(blocks(page)) == 15 and page.evaluate("window.extrados.scene.capacity") is not None
    page.click("text=Copies…")
    page.fill("dialog [aria-label='Step in x, m']", "12")
    page.click("text=Draw it")
    settled(page)
    assert len(blocks(page)) == 30


def test_the_deck_of_the_sheet_keeps_what_its_author_wrote(page: Any) -> None:
    text = (
        '# mine\n[structure]\nkind = "blocks"\ndepth = "80 cm"\nblock = [{ name = "a", points = [["0 cm", 0], [1, 0], [1, 2], '
        '[0, 2]], density = 1800 }]\n\n[joints]\nfriction = 0.6\n\n[[analysis]]\nkind = "tilt"\n'
    )
    open_text(page, text)
    page.click("[data-draw]")
    until(page, "window.extrados.sheet.drawing() && window.extrados.sheet.blocks.length === 1")
    page.click("[data-tool=pier]")
    stroke(page, (0.0, 2.0), (1.0, 3.0))
    settled(page)
    now = page.evaluate("window.extrados.text")
    assert now.startswith("# mine") and "80 cm" in now and '"0 cm"' in now and "density = 1800" in now and "friction = 0.6" in now
    assert len(blocks(page)) == 6
    page.click("[data-side=deck]")
    page.locator(".editor textarea").fill(text)
    until(page, "window.extrados.sheet.blocks.length === 1")


def test_a_photograph_stays_in_the_page(page: Any, tmp_path: Any) -> None:
    sent: list[int] = []
    photo = tmp_path / "photo.png"
    photo.write_bytes(PNG)
    page.on("request", lambda request: sent.append(len(request.post_data or "")) if request.method != "GET" else None)
    blank(page)
    page.set_input_files("input[aria-label='Photograph as background']", photo)
    page.wait_for_selector("[data-tool=scale]")
    tap(page, 0.0, 0.5)
    tap(page, 4.0, 0.5)
    page.fill("dialog input", "2")
    page.click("text=Draw it")
    until(page, "Math.abs(window.extrados.sheet.photo.scale - 4) < 0.1")
    stroke(page, (1.0, 1.0), (2.0, 1.0))
    until(page, "Math.abs(window.extrados.sheet.photo.x - 1) < 0.2")
    page.click("[data-tool=pier]")
    stroke(page, (0.0, 0.0), (1.0, 2.0))
    settled(page)
    text = page.evaluate("window.extrados.text")
    assert len(blocks(page)) == 5 and "photo" not in text and "blob" not in text and sent == []
    page.screenshot(path=SHOTS / "sheet-photo.png")
