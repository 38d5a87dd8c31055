"""The page at four sizes of screen, by finger and by mouse: nothing overflows, all is reachable, handles are apart; axe-core."""

import itertools
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from hands import ROCKING, fits, open_text, settled, until
from served import SHOTS, Served

#: Width, height, and whether it is held by fingers
SCREENS = [(390, 844, True), (820, 1180, True), (1366, 768, False), (2560, 1440, False)]
BY_SIZE = pytest.mark.parametrize("screen", SCREENS, indirect=True, ids=lambda s: f"{s[0]}x{s[1]}")


@pytest.fixture
def screen(browser: Any, served: Served, request: pytest.FixtureRequest) -> Iterator[Any]:
    width, height, fingers = request.param
    context = browser.new_context(viewport={"width": width, "height": height}, has_touch=fingers, is_mobile=fingers, device_scale_factor=1)
    page = context.new_page()
    troubles: list[str] = []
    page.on("pageerror", lambda error: troubles.append(str(error)))
    page.set_default_timeout(60_000)
    page.goto(served.address)
    page.wait_for_selector("[data-handle=thickness]")
    settled(page)
    SHOTS.mkdir(parents=True, exist_ok=True)
    yield page
    context.close()
    assert not troubles


def serious(page: Any) -> None:
    """axe-core finds no serious or critical violation."""
    found = pytest.importorskip("axe_playwright_python", reason="axe-core is not installed: make browser")
    source = (Path(found.__file__).parent / "axe.min.js").read_text("utf-8")
    page.evaluate(f"() => {{ {source}; window.axe = window.axe ?? axe; }}")
    told = page.evaluate(
        """async () => (await window.axe.run(document, { resultTypes: ["violations"] })).violations
            .filter(v => ["serious", "critical"].includes(v.impact)).map(v => [v.id, v.nodes.slice(0, 4).map(n => n.html.slice(0, 160))])"""
    )
    assert told == []


@BY_SIZE
def test_nothing_overflows_and_all_is_reachable(screen: Any) -> None:
    page, size = screen, screen.viewport_size
    name = f"{size['width']}x{size['height']}"
    fits(page)
    page.screenshot(path=SHOTS / f"screen-{name}-structure.png")
    for side in ("sizes", "deck", "teach", "answer"):
        page.click(f"[data-side={side}]")
        if page.locator(f".page.{side}").is_hidden():
            page.click(f"[data-side={side}]")
        assert page.locator(f".page.{side}").is_visible()
        fits(page)
    page.screenshot(path=SHOTS / f"screen-{name}-answer.png")
    if size["width"] < 700:
        page.click("[data-side=answer]")
        assert page.locator(".page.answer").is_hidden(), "the sheet closes"
    open_text(page, ROCKING)
    page.click("[data-tab=motion]")
    until(page, "window.extrados.motion.map?.told")
    settled(page)
    fits(page)
    page.screenshot(path=SHOTS / f"screen-{name}-motion.png")
    legend = page.locator(".map-legend").bounding_box()
    chart = page.locator("[data-chart=map] svg").bounding_box()
    assert legend["x"] >= chart["x"] + chart["width"] - 1, "the legend stands beside the map"
    page.click("[data-tab=results]")
    fits(page)
    page.click("text=Export")
    fits(page)
    page.keyboard.press("Escape")
    page.click("[data-tab=structure]")
    page.click("[aria-label='Dark or light']")
    page.evaluate("window.extrados.show({ gamma: 0.6 })")
    settled(page)
    until(page, "window.extrados.fall.now > 0.6")
    fits(page)
    page.screenshot(path=SHOTS / f"screen-{name}-collapse-dark.png")


@BY_SIZE
@pytest.mark.parametrize("preset", ["limit/arch-120", "vault/vezelay-like", "rocking/housner"])
def test_handles_never_cover_each_other(screen: Any, preset: str) -> None:
    page = screen
    page.evaluate("preset => window.extrados.open({ preset })", preset)
    until(page, "preset => window.extrados.source.preset === preset", arg=preset)
    settled(page)
    fingers = page.evaluate("matchMedia('(pointer: coarse)').matches")
    boxes = page.evaluate(
        "[...document.querySelectorAll('.stage .knob .hit')].map(e => { const r = e.getBoundingClientRect(); return [r.left + r.width / 2, r.top + r.height / 2, r.width]; })"
    )
    assert len(boxes) >= 3
    least = 44 if fingers else 26
    assert all(box[2] >= least for box in boxes)
    for one, two in itertools.combinations(boxes, 2):
        assert ((one[0] - two[0]) ** 2 + (one[1] - two[1]) ** 2) ** 0.5 >= least - 1.5
    if fingers:
        small = page.evaluate(
            """[...document.querySelectorAll("button, select")].filter(e => e.getClientRects().length).map(e => [e.getBoundingClientRect(), e.textContent])
                .filter(([r]) => r.height < 43.5 || r.width < 43.5).map(([, text]) => text)"""
        )
        assert small == []


@pytest.mark.parametrize("screen", [(844, 390, True)], indirect=True, ids=["844x390"])
def test_a_phone_held_sideways(screen: Any) -> None:
    """The drawing keeps a third of the height, numbers are beside it, charts below; nothing overflows."""
    page = screen
    for side in ("sizes", "deck", "teach", "answer"):
        page.click(f"[data-side={side}]")
        assert page.locator(f".page.{side}").is_visible()
        fits(page)
    assert page.locator(".stones").bounding_box()["height"] > 60
    page.evaluate("window.extrados.show({ gamma: 0.6 })")
    until(page, "window.extrados.fall.now > 0.1")
    assert "exceeds the capacity" in page.locator(".fall .why").inner_text()
    open_text(page, ROCKING)
    page.click("[data-tab=motion]")
    until(page, "window.extrados.motion.map?.told")
    settled(page)
    fits(page)
    assert page.locator("[aria-label='What is drawn']").is_hidden() and page.locator(".stones").bounding_box()["height"] > 40
    page.screenshot(path=SHOTS / "screen-844x390-motion.png")


@pytest.mark.parametrize("screen", SCREENS[:1], indirect=True, ids=["390x844"])
def test_a_deck_without_a_structure_says_so_on_the_drawing(screen: Any) -> None:
    page = screen
    open_text(page, '[motion]\nkind = "sine-pulse"\namplitude = "0.3 g"\nperiod = 0.8\n[analysis]\nkind = "motion"\n')
    assert "no [structure]" in page.locator(".nothing").inner_text()
    fits(page)
    open_text(page, ROCKING)
    assert page.locator(".nothing").is_hidden()


@pytest.mark.parametrize("screen", SCREENS[:1], indirect=True, ids=["390x844"])
def test_a_finger_drags_under_a_loupe_and_two_enlarge(screen: Any) -> None:
    page = screen
    link = page.context.new_cdp_session(page)
    box = page.locator("[data-handle=thickness] .hit").bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2

    def touch(kind: str, *points: tuple[float, float]) -> None:
        link.send(
            "Input.dispatchTouchEvent", {"type": kind, "touchPoints": [{"x": px, "y": py, "id": k} for k, (px, py) in enumerate(points)]}
        )

    before = settled(page)
    touch("touchStart", (x, y))
    for k in range(1, 7):
        touch("touchMove", (x, y - 3 * k))
    assert page.locator(".loupe").get_attribute("visibility") == "visible"
    page.screenshot(path=SHOTS / "loupe.png")
    touch("touchEnd")
    assert settled(page) != before
    assert page.locator(".loupe").get_attribute("visibility") == "hidden"
    stage = page.locator(".stage").bounding_box()
    x, y = stage["x"] + stage["width"] / 2, stage["y"] + 0.75 * stage["height"]
    page.click("[aria-label='Fit the drawing']")
    wide = page.locator(".stones").bounding_box()["width"]
    touch("touchStart", (x - 30, y), (x + 30, y))
    for k in range(1, 9):
        touch("touchMove", (x - 30 - 5 * k, y), (x + 30 + 5 * k, y))
    touch("touchEnd")
    assert page.locator(".stones").bounding_box()["width"] > 1.6 * wide
    page.click("[aria-label='Fit the drawing']")
    assert page.locator(".stones").bounding_box()["width"] == pytest.approx(wide, rel=0.1)


@pytest.mark.parametrize("screen", [SCREENS[0], SCREENS[2]], indirect=True, ids=["390x844", "1366x768"])
@pytest.mark.parametrize("dark", [False, True], ids=["light", "dark"])
def test_axe_finds_nothing_serious(screen: Any, dark: bool) -> None:
    page = screen
    if dark:
        page.click("[aria-label='Dark or light']")
    open_text(page, ROCKING)
    for tab in ("structure", "motion", "results"):
        page.click(f"[data-tab={tab}]")
        page.wait_for_timeout(300)
        serious(page)


@BY_SIZE
def test_the_sheet_fits_and_is_drawn_on_by_finger(screen: Any) -> None:
    """All tools are reachable; two touches draw a pier; axe-core finds nothing serious in both themes."""
    page, size = screen, screen.viewport_size
    page.evaluate("window.extrados.sheet.begin(true)")
    until(page, "window.extrados.draft !== null")
    fits(page)
    x, y = page.evaluate(
        "(() => { const r = document.querySelector('svg.sheet').getBoundingClientRect(); return [r.left + r.width / 2, r.top + r.height / 2]; })()"
    )
    if page.evaluate("matchMedia('(pointer: coarse)').matches"):
        small = page.evaluate(
            """[...document.querySelectorAll(".sheet-bar button, .sheet-bar select, .sheet-bar .button")].map(e => [e.getBoundingClientRect(), e.textContent])
                .filter(([r]) => r.height < 43.5 || r.width < 43.5).map(([, text]) => text)"""
        )
        assert small == []
        link = page.context.new_cdp_session(page)
        for kind, points in (("Start", [(x, y)]), ("Move", [(x + 20, y - 40)]), ("Move", [(x + 60, y - 90)]), ("End", [])):
            link.send("Input.dispatchTouchEvent", {"type": f"touch{kind}", "touchPoints": [{"x": px, "y": py} for px, py in points]})
    else:
        page.mouse.click(x, y)
        page.mouse.click(x + 60, y - 90)
    until(page, "window.extrados.sheet.blocks.length === 5")
    settled(page)
    page.screenshot(path=SHOTS / f"screen-{size['width']}x{size['height']}-sheet.png")
    fits(page)
    serious(page)
    page.click("[aria-label='Dark or light']")
    serious(page)
    page.screenshot(path=SHOTS / f"screen-{size['width']}x{size['height']}-sheet-dark.png")
