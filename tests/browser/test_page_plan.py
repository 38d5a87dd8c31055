"""The plan of a building: walls and openings by hand and by keys, the deck that follows, and the pushover in colours."""

from typing import Any

import pytest
from hands import data_of, draw_line, settled, until
from served import SHOTS

import extrados


def at(page: Any, x: float, y: float) -> tuple[float, float]:
    """Where a place of the plan [m] is on the screen."""
    box = page.locator("svg.plan").bounding_box()
    k, cx, cy = page.evaluate("window.extrados.plan.place()")
    return box["x"] + cx + k * x, box["y"] + cy - k * y


def stroke(page: Any, a: tuple[float, float], b: tuple[float, float]) -> None:
    draw_line(page, at, a, b)


def walls(page: Any) -> list[dict[str, Any]]:
    return data_of(page.evaluate("window.extrados.draft?.text ?? window.extrados.text"))["structure"].get("walls", [])


def blank(page: Any) -> None:
    page.click("text=Open…")
    page.click("[data-blank-plan]")
    until(page, "window.extrados.plan.drawing() && window.extrados.draft !== null")


def room(page: Any) -> None:
    """Four walls of 6 by 4 m."""
    corners = [(1.0, 0.0), (7.0, 0.0), (7.0, 4.0), (1.0, 4.0)]
    for a, b in zip(corners, corners[1:] + corners[:1], strict=True):
        stroke(page, a, b)
    settled(page)


def test_a_house_is_drawn_and_its_pushover_is_that_of_a_run(page: Any) -> None:
    blank(page)
    stroke(page, (1.0, 0.0), (7.0, 0.0))
    settled(page)
    assert "do not form a simple ring" in page.locator("svg.plan .sheet-words").text_content()
    page.keyboard.press("Control+z")
    room(page)
    made = walls(page)
    assert [w["name"] for w in made] == ["wall 1", "wall 2", "wall 3", "wall 4"]
    assert (made[0]["start"], made[3]["end"]) == ([1.0, 0.0], [1.0, 0.0])
    page.click("[data-plan-tool=opening]")
    stroke(page, (3.0, 0.0), (4.0, 0.0))
    settled(page)
    opening = walls(page)[0]["openings"]
    assert opening == [{"storey": 1, "x": [2.0, 3.0], "z": [0.9, 2.2]}]
    assert page.evaluate("window.extrados.draft") is None
    page.click("[data-push='0']")
    until(page, "window.extrados.plan.push && window.extrados.plan.push.at > 20")
    early = page.evaluate("document.querySelector('.plan-line').getAttribute('d').length")
    until(page, "window.extrados.plan.push.at === window.extrados.plan.push.arrays.control.length - 1")
    assert page.evaluate("document.querySelector('.plan-line').getAttribute('d').length") > early
    assert page.locator(".plan-state").count() == 6
    assert page.locator(".plan-state[data-state='5']").count() >= 2, "piers beyond their drift limit in shear"
    page.screenshot(path=SHOTS / "plan-pushed.png")
    run = extrados.run(data_of(settled(page)))
    row = next(r for r in run["frame-pushover"].runs if r.name == "+x uniform")
    assert page.evaluate("window.extrados.plan.push.peak_base_shear_N") == pytest.approx(row.peak_base_shear_N, rel=1e-9)


def test_walls_and_openings_are_changed_by_hand_and_keys(page: Any) -> None:
    blank(page)
    room(page)
    page.click("[data-plan-tool=opening]")
    stroke(page, (3.0, 0.0), (4.0, 0.0))
    settled(page)
    page.click("[data-plan-tool=select]")
    stroke(page, (4.0, 0.0), (4.5, 0.0))  # the right edge of the selected opening
    settled(page)
    assert walls(page)[0]["openings"][0]["x"] == pytest.approx([2.0, 3.5])
    page.mouse.click(*at(page, 7.0, 2.0))
    stroke(page, (7.0, 2.0), (8.0, 2.0))
    settled(page)
    made = walls(page)
    assert made[1]["start"] == [8.0, 0.0] and made[0]["end"] == [8.0, 0.0] and made[2]["start"] == [8.0, 4.0], "corners stay together"
    page.keyboard.press("ArrowLeft")
    settled(page)
    assert walls(page)[1]["start"] == [7.75, 0.0]
    page.fill("[data-plan-size=thickness]", "0,45")
    page.keyboard.press("Tab")
    settled(page)
    assert walls(page)[1]["thickness"] == 0.45
    page.keyboard.press("Control+z")
    settled(page)
    assert walls(page)[1]["thickness"] == 0.3
    page.click("[data-plan-tool=done]")
    assert not page.evaluate("window.extrados.plan.drawing()")


def test_the_plan_of_a_deck_keeps_the_rest_of_it(page: Any) -> None:
    page.evaluate("window.extrados.open({ preset: 'frame/farmhouse' })")
    until(page, "window.extrados.scene?.seen?.of === 'walls'")
    page.click("[data-plan]")
    until(page, "window.extrados.plan.drawing()")
    before = data_of(settled(page))
    page.mouse.click(*at(page, 11.2, 7.5))
    stroke(page, (11.2, 7.5), (11.7, 7.5))
    after = data_of(settled(page))
    assert after["structure"]["walls"][1]["start"] == pytest.approx([11.7, 0.0])
    assert after["structure"]["walls"][0]["openings"] == before["structure"]["walls"][0]["openings"], "lintels stay"
    assert {**after, "structure": 0} == {**before, "structure": 0}
    page.click("[data-push='90']")
    until(page, "window.extrados.plan.push && window.extrados.plan.push.at === window.extrados.plan.push.arrays.control.length - 1")
    page.screenshot(path=SHOTS / "plan-farmhouse.png")
