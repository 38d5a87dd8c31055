"""The building under the hand: drags, keys, typing, undo, loads, lines of thrust, drawings, and what stands in space."""

import re
import subprocess
import sys
from typing import Any

import pytest
from hands import capacity, data_of, drag, open_text, settled, until
from served import SHOTS, Served

import extrados
from extrados.schema.places import CASES

DXF_UNIT = 6  # metres


def test_a_drag_changes_the_structure_and_its_answer(page: Any) -> None:
    before = capacity(page)
    drag(page, "[data-handle=thickness] .hit", 0, -20)
    text = settled(page)
    assert capacity(page) > 1.2 * before
    thickness = float(re.search(r"thickness = ([\d.]+)", text)[1])
    assert thickness > 0.8
    run = extrados.run(data_of(text))
    assert run["tilt"].collapse_acceleration_g == pytest.approx(capacity(page), rel=1e-12)
    assert f"{capacity(page):.4g} g" in page.locator("[data-number=plus]").inner_text()


def test_span_rise_and_angle_follow_the_hand(page: Any) -> None:
    for name, dx, dy in (("span", -30, 0), ("rise", 0, 30), ("embrace", 0, -40), ("radius", -10, -10)):
        before = settled(page)
        at = page.locator(f"[data-handle={name}] .dot").bounding_box()
        drag(page, f"[data-handle={name}] .hit", dx, dy)
        assert settled(page) != before
        now = page.locator(f"[data-handle={name}] .dot").bounding_box()
        moved = (now["x"] - at["x"]) * dx + (now["y"] - at["y"]) * dy
        assert moved > 0.25 * (dx * dx + dy * dy), f"{name} does not follow: {at} {now}"


def test_keys_move_a_handle_and_typing_sets_it(page: Any) -> None:
    page.locator("[data-handle=thickness]").focus()
    page.keyboard.press("ArrowUp")
    page.keyboard.press("ArrowUp")
    assert float(re.search(r"thickness = ([\d.]+)", settled(page))[1]) > 0.75
    page.locator("[data-handle=thickness]").focus()
    page.keyboard.press("Enter")
    page.fill("dialog input", "60 cm")
    page.keyboard.press("Enter")
    assert "thickness = 0.6\n" in settled(page)
    page.click("[data-side=sizes]")
    page.fill("#field-structure-radius", "400 cm")
    page.keyboard.press("Tab")
    assert 'radius = "400 cm"' in settled(page)
    page.fill("#field-structure-radius", "400 kg")
    page.keyboard.press("Tab")
    page.wait_for_selector(".status.bad")
    assert "kg" in page.locator(".status").inner_text()
    assert 'radius = "400 cm"' in settled(page), "what is wrong changes nothing"


def test_undo_and_redo(page: Any) -> None:
    first = settled(page)
    drag(page, "[data-handle=thickness] .hit", 0, -15)
    second = settled(page)
    assert second != first
    page.keyboard.press("Control+z")
    assert settled(page) == first
    page.keyboard.press("Control+Shift+z")
    assert settled(page) == second


def test_one_step_back_undoes_all_of_a_slow_drag(page: Any) -> None:
    first = settled(page)
    box = page.locator("[data-handle=thickness] .hit").bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x, y - 10)
    middle = settled(page)
    page.mouse.move(x, y - 20)
    page.mouse.up()
    last = settled(page)
    assert len({first, middle, last}) == 3
    page.keyboard.press("Control+z")
    assert settled(page) == first


def test_a_line_through_a_point_and_the_tilt(page: Any) -> None:
    box = page.locator(".stones").bounding_box()
    page.mouse.click(box["x"] + box["width"] / 2, box["y"] + 24)
    settled(page)
    reached = page.evaluate("window.extrados.scene.through")
    assert reached["reached"] == pytest.approx(reached["wanted"], abs=1e-6)
    scene = page.evaluate("window.extrados.scene")
    assert scene["least_N"] < reached["thrust_N"] < scene["most_N"]
    page.locator("[data-handle=tilt]").focus()
    for _ in range(4):
        page.keyboard.press("Shift+ArrowDown")
    settled(page)
    assert page.evaluate("window.extrados.scene.gamma") == pytest.approx(0.2)
    for _ in range(5):
        page.keyboard.press("Shift+ArrowDown")
    settled(page)
    assert page.evaluate("window.extrados.scene.within") is False
    assert "Collapses towards +x" in page.locator(".answer").inner_text()


def test_the_deck_is_edited_as_text_and_complained_of_by_line(page: Any) -> None:
    page.click("[data-side=deck]")
    area = page.locator("textarea")
    text = area.input_value()
    area.fill(text.replace("thickness = 0.75", "thickness = 0.5"))
    until(page, "window.extrados.scene.capacity.plus_g < 0.2")
    settled(page)
    area.fill(text.replace("thickness = 0.75", "thicknes = 0.5"))
    page.wait_for_selector(".complaints li")
    assert "thickness" in page.locator(".complaints").inner_text()
    assert ".toml:6: structure.thicknes: unknown key" in page.locator(".complaints").inner_text()


def test_the_deck_goes_out_and_in_again_with_the_numbers_of_a_run(page: Any, served: Served) -> None:
    page.evaluate("window.extrados.open({ preset: 'vault/dejong-a' })")
    page.wait_for_selector("[data-handle=buttress_width]")
    drag(page, "[data-handle=buttress_width] .hit", 18, 0)
    text = settled(page)
    shown = capacity(page)
    assert "buttress_width" in text
    page.keyboard.press("Control+s")
    page.fill("dialog input[type=text]", "mine/vault.toml")
    page.click("dialog button[type=submit]")
    until(page, "window.extrados.source.path === 'mine/vault.toml'")
    subprocess.run(
        [sys.executable, "-m", "extrados", "run", "mine/vault.toml", "--quiet", "--no-figures"], cwd=served.folder, check=True, timeout=300
    )
    run = extrados.load(served.folder / "results" / "vault")
    assert run["tilt"].collapse_acceleration_g == pytest.approx(shown, rel=1e-12)
    page.evaluate("window.extrados.open({ preset: 'limit/arch-120' })")
    page.evaluate("window.extrados.open({ path: 'mine/vault.toml' })")
    until(page, "window.extrados.name === 'vault.toml'")
    settled(page)
    assert capacity(page) == shown


def test_a_drawing_is_dropped_and_its_vertices_are_moved(page: Any) -> None:
    ezdxf = pytest.importorskip("ezdxf")
    drawing = ezdxf.new()
    drawing.header["$INSUNITS"] = DXF_UNIT
    space = drawing.modelspace()
    space.add_lwpolyline([(0, 0), (1, 0), (1, 3), (0, 3)], close=True)
    space.add_lwpolyline([(0, 3), (1, 3), (1, 5), (0, 5)], close=True)
    import io

    stream = io.StringIO()
    drawing.write(stream)
    page.evaluate(
        """text => {
            const transfer = new DataTransfer();
            transfer.items.add(new File([text], "pier.dxf"));
            document.querySelector(".extrados").dispatchEvent(new DragEvent("drop", { dataTransfer: transfer, bubbles: true, cancelable: true }));
        }""",
        stream.getvalue(),
    )
    until(page, "window.extrados.scene?.blocks === 2")
    settled(page)
    assert capacity(page) == pytest.approx(1.0 / 5.0, rel=1e-9)
    assert page.locator("text=Free the stones").count() == 0, "they are free"
    page.evaluate("window.extrados.ask({ do: 'blocks' })")
    page.wait_for_selector("[data-handle^=vertex-]")
    assert page.locator("[data-handle^=vertex-]").count() == 6
    before = settled(page)
    page.locator("[data-handle^=vertex-]").last.focus()
    page.keyboard.press("Shift+ArrowLeft")
    assert settled(page) != before


def test_a_load_is_added_and_dragged(page: Any) -> None:
    before = capacity(page)
    page.click("text=Add a load")
    page.wait_for_selector("[data-handle=load-0-x]")
    settled(page)
    first = capacity(page)
    assert first != before
    drag(page, "[data-handle=load-0-x] .hit", 90, 0)
    text = settled(page)
    assert capacity(page) != first
    run = extrados.run(data_of(text))
    assert run["tilt"].collapse_acceleration_g == pytest.approx(capacity(page), rel=1e-12)


def test_a_button_that_is_pressed_hears_its_click_whatever_is_answered_meanwhile(page: Any) -> None:
    shown = "document.querySelector('[data-number=plus]').textContent"
    settled(page)
    before = page.evaluate(shown)
    page.locator("text=Add a load").hover()
    page.mouse.down()
    page.evaluate("window.extrados.change({ 'structure.thickness': 1.1 })")
    settled(page)
    page.mouse.up()
    page.wait_for_selector("[data-handle=load-0-x]")
    until(page, f"before => {shown} !== before", before)


def test_the_line_follows_a_drag_from_the_stones_and_its_thrust_is_a_handle(page: Any) -> None:
    place = """k => {
        const { joint_p: p, joint_q: q } = window.extrados.arrays, edge = document.querySelector(".stage").getBoundingClientRect();
        const [x, y] = window.extrados.drawing.screenOf((p[2 * k] + q[2 * k]) / 2, (p[2 * k + 1] + q[2 * k + 1]) / 2);
        return [edge.x + x, edge.y + y];
    }"""
    x, y = page.evaluate(place, 24)
    page.mouse.move(x, y)
    page.mouse.down()
    settled(page)
    assert page.evaluate("window.extrados.scene.through.joint") == 24
    page.mouse.move(*page.evaluate(place, 28), steps=4)
    page.mouse.up()
    settled(page)
    assert page.evaluate("window.extrados.scene.through.joint") == 28
    least, most = (page.evaluate(f"window.extrados.scene.{k}_N") for k in ("least", "most"))
    page.locator("[data-handle=thrust]").focus()
    page.keyboard.press("End")
    settled(page)
    assert page.evaluate("window.extrados.scene.chosen.thrust_N") == pytest.approx(most, rel=1e-9)
    assert not page.evaluate("Boolean(window.extrados.scene.through)")
    page.keyboard.press("Home")
    settled(page)
    assert page.evaluate("window.extrados.scene.chosen.thrust_N") == pytest.approx(least, rel=1e-9)
    drag(page, "[data-handle=thrust] .hit", 30, 0)
    settled(page)
    assert page.evaluate("window.extrados.scene.chosen.thrust_N") > 1.001 * least
    middle = 0.5 * (least + most)
    page.keyboard.press("Enter")
    page.fill("dialog input", f"{middle / 1e3:.6f} kN")
    page.keyboard.press("Enter")
    settled(page)
    assert page.evaluate("window.extrados.scene.chosen.thrust_N") == pytest.approx(middle, rel=1e-6)
    assert page.locator("[data-handle=thrust]").get_attribute("aria-valuetext").startswith(f"{middle / 1e3:.4g}"[:4])


def test_what_was_requested_last_is_seen_last(page: Any) -> None:
    most = page.evaluate("window.extrados.scene.most_N")
    page.evaluate(
        """most => {
        const at = { joint: 24, share: 0.5 }; // the second waits for the answer to the first
        window.extrados.show({ through: at }); window.extrados.show({ through: at }); window.extrados.choose(most);
    }""",
        most,
    )
    settled(page)
    assert page.evaluate("window.extrados.scene.chosen?.thrust_N") == pytest.approx(most, rel=1e-9)
    page.evaluate(
        "window.extrados.show({ gamma: 0.05 }); window.extrados.show({ gamma: 0.1 }); window.extrados.show({ through: { joint: 24, share: 0.5 } })"
    )
    settled(page)
    assert page.evaluate("window.extrados.scene.through.joint") == 24
    assert page.evaluate("window.extrados.scene.gamma") == 0.1


def test_what_stands_in_space_is_turned_and_pushed(page: Any) -> None:
    page.evaluate("window.extrados.open({ preset: 'solid/column' })")
    until(page, "window.extrados.scene?.seen?.of === 'solids'")
    page.wait_for_selector(".stage-box .space")
    settled(page)
    shades = "() => { const c = document.querySelector('.stage-box .space-canvas'); return new Set(new Uint32Array(c.getContext('2d').getImageData(0, 0, c.width, c.height).data.buffer)).size; }"
    until(page, f"({shades})() > 12")  # faces are lit by how they lie
    look = page.evaluate("document.querySelector('.stage-box .space-canvas').toDataURL()")
    seen = page.locator(".stage-box .space").get_attribute("aria-label")
    page.locator(".stage-box .space").focus()
    page.keyboard.press("ArrowLeft")
    drag(page, ".stage-box .space", 60, -20)
    until(page, "seen => document.querySelector('.stage-box .space').getAttribute('aria-label') !== seen", arg=seen)
    until(page, "look => document.querySelector('.stage-box .space-canvas').toDataURL() !== look", arg=look)
    page.click("text=Calculate capacity")
    page.wait_for_selector("[data-number=push]")
    run = extrados.run(CASES / "solid" / "column.toml")["tilt"]
    assert f"{run.collapse_acceleration_g:.4f} g" in page.locator("[data-number=push]").inner_text()
    page.wait_for_timeout(300)
    page.screenshot(path=SHOTS / "solids.png")
    page.click("text=Export")
    with page.expect_download() as waited:
        page.click("text=Drawing, SVG")
    assert b"data:image/png" in waited.value.path().read_bytes()
    page.evaluate("window.extrados.open({ preset: 'building/two-rooms' })")
    until(page, "window.extrados.scene?.seen?.of === 'walls'")
    page.screenshot(path=SHOTS / "building.png")
    page.evaluate("window.extrados.open({ preset: 'sla/yi-wall-1' })")
    page.wait_for_selector("[data-handle='openings.0.x.1']")
    before = settled(page)
    drag(page, "[data-handle='openings.0.x.1'] .hit", 15, 0)
    assert settled(page) != before
    page.screenshot(path=SHOTS / "wall.png")


def test_a_block_is_clicked_and_the_tolerance_tried(page: Any) -> None:
    """Names, mass and contacts of a drawn block; another tolerance reads the file again."""
    page.evaluate("window.extrados.open({ preset: 'solid/gaps' })")
    until(page, "window.extrados.scene?.seen?.of === 'solids'")
    settled(page)
    assert page.evaluate("window.extrados.scene.seen.joints") == 55
    box = page.locator(".stage-box .space").bounding_box()
    page.mouse.click(box["x"] + 0.5 * box["width"], box["y"] + 0.5 * box["height"])
    page.wait_for_selector("[data-block]")
    told = page.locator("[data-block]").inner_text()
    assert told.startswith("stone ") and " kg" in told and told.count("m²") >= 3, told
    page.screenshot(path=SHOTS / "block.png")
    page.click("text=Sizes")
    page.fill("#field-structure-contact_tolerance", "4 mm")
    page.press("#field-structure-contact_tolerance", "Enter")
    until(page, "window.extrados.scene.seen?.warnings.some(w => w.includes('contact_tolerance` 4 mm'))")
    page.evaluate("window.extrados.change({ 'structure.mortar_gap': 0.001 })")
    until(page, "document.querySelector('.bad')?.textContent.includes('touches neither')")
    page.evaluate("window.extrados.change({ 'structure.mortar_gap': 0.012 })")
    until(page, "window.extrados.scene.seen?.joints === 55")


def test_what_holds_a_building_is_drawn(page: Any) -> None:
    open_text(page, HELD)
    drawn = (
        """name => { const box = document.querySelector(name).getBBox(); return [box.x, box.y, box.x + box.width, box.y + box.height]; }"""
    )
    x = page.evaluate("window.extrados.anchor[0]")
    assert page.evaluate(drawn, ".tie:not(.damper)")[2] + x == pytest.approx(2.0)
    assert page.evaluate(drawn, ".damper")[2] + x == pytest.approx(3.0)
    assert page.evaluate(drawn, ".supports")[0] + x < -0.01, "the wall on its left"
    assert page.evaluate(drawn, ".mass")[3] > 4.0
    page.wait_for_timeout(200)
    page.screenshot(path=SHOTS / "held.png")


HELD = """title = "Held"

[structure]
kind = "block"
width = 1.0
height = 4.0
head_mass = 500.0

[supports]
abutting_wall = "left"

[[ties]]
start = [0.4, 3.5]
ground = [2.0, 0.0]
stiffness = 1e7

[[dampers]]
start = [0.4, 3.0]
ground = [3.0, 0.0]
damping = 1e5

[[analysis]]
kind = "tilt"
"""


def test_what_is_needed_is_sized_and_put_in(page: Any) -> None:
    """The page sizes interventions for 1.3 times the capacity; each number is that of the analysis, and put in it is enough."""
    target = round(1.3 * capacity(page), 3)
    page.fill("#needed-g", str(target))
    page.click("text=Find the interventions")
    page.wait_for_selector("[data-intervention]")
    told = page.locator("section.needed").inner_text()
    asked = {"kind": "strengthen", "acceleration": f"{target} g"}
    bare = {**data_of(settled(page)), "joints": {"friction": "no-sliding"}}
    own = extrados.run({**bare, "analysis": [asked]})["strengthen"]
    rows = {one.name: one for one in own.interventions}
    thickness = next(one for one in rows.values() if one.key == "structure.thickness")
    assert thickness.meets_target and f"thickness {thickness.required_size:.3g}" in told
    page.locator("[data-intervention] button").last.scroll_into_view_if_needed()
    SHOTS.mkdir(parents=True, exist_ok=True)
    page.screenshot(path=SHOTS / "what-is-needed.png")
    page.locator(f"[data-intervention='{thickness.name}'] button").click()
    text = settled(page)
    assert data_of(text)["structure"]["thickness"] == pytest.approx(thickness.required_size, rel=1e-3)
    assert capacity(page) >= target
    assert page.locator("[data-intervention]").count() == 0, "the sizes are those of the structure before"
    page.fill("#needed-g", "much")
    page.click("text=Find the interventions")
    until(page, "document.querySelector('section.needed').innerText.includes('above 0')")
