"""The interactive page as hands use it: drags, keys, typing, undo, motion, results, files, a server that dies.

Nothing is read while the page is on its way: `settled` waits until all that was asked for is seen, `until` for what comes
by itself (maps, runs, films) and is asserted.
"""

import base64
import os
import re
import signal
import subprocess
import sys
import time
from typing import Any

import pytest
from served import SHOTS, Served

import extrados
from extrados.schema.places import CASES

DXF_UNIT = 6  # metres


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


def test_a_drag_changes_the_structure_and_its_answer(page: Any) -> None:
    before = capacity(page)
    drag(page, "[data-handle=thickness] .hit", 0, -20)
    text = settled(page)
    assert capacity(page) > 1.2 * before
    thickness = float(re.search(r"thickness = ([\d.]+)", text)[1])
    assert thickness > 0.8
    run = extrados.run(_data(text))
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
    assert "comes down" in page.locator(".answer").inner_text()


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
        [sys.executable, "-m", "extrados", "run", "mine/vault.toml", "--quiet", "--no-figures"], cwd=served.folder,
        check=True, timeout=300,
    )  # fmt: skip
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
    run = extrados.run(_data(text))
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


def test_what_was_asked_for_last_is_seen_last(page: Any) -> None:
    most = page.evaluate("window.extrados.scene.most_N")
    page.evaluate("""most => {
        const at = { joint: 24, share: 0.5 }; // the second waits for the answer to the first
        window.extrados.show({ through: at }); window.extrados.show({ through: at }); window.extrados.choose(most);
    }""", most)  # fmt: skip
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
    page.click("text=Push it")
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


def test_what_has_no_map_still_rocks_and_a_motion_is_drawn_alone(page: Any) -> None:
    page.click("[data-tab=motion]")
    page.evaluate("window.extrados.open({ preset: 'rocking/stack' })")
    until(page, "window.extrados.motion.arrays?.rotation_upper && window.extrados.motion.map?.why")
    assert "two stacked blocks" in page.locator(".map-why").inner_text()
    settled(page)
    page.evaluate("window.extrados.motion.seek(0.5 * window.extrados.motion.end)")
    until(page, "document.querySelector('.ghost').getAttribute('d')")
    page.screenshot(path=SHOTS / "stack.png")
    page.evaluate("window.extrados.open({ preset: 'motion/el-centro' })")
    until(page, "window.extrados.motion.ground?.motion && !window.extrados.motion.arrays")
    settled(page)
    until(page, "document.querySelectorAll('[data-chart=pulse] .chart .line').length === 1")
    assert "no [structure]" in page.locator(".outcome").inner_text()


def test_motion_plays_and_the_map_knows_the_pulse(page: Any) -> None:
    open_text(page, ROCKING)
    page.click("[data-tab=motion]")
    until(page, "window.extrados.motion.words && window.extrados.motion.map?.told.whole")
    settled(page)
    run = extrados.run(_data(ROCKING))
    told = page.evaluate("window.extrados.motion.words")
    assert told["outcome"] == run["rocking"].outcome
    assert told["peak_rotation_rad"] == pytest.approx(run["rocking"].peak_rotation_rad, rel=1e-9)
    assert told["impact_times_s"] == pytest.approx(run["rocking"].impact_times_s, abs=1e-9)
    page.evaluate("window.extrados.motion.speed = 1")
    page.click("[aria-label='stop at impacts'], label:has-text('stop at impacts') input")
    page.click(".play")
    until(page, "window.extrados.motion.playing === null")
    first = told["impact_times_s"][0]
    assert page.evaluate("window.extrados.motion.time") == pytest.approx(first, abs=1e-9)
    assert page.locator(".ghost").get_attribute("d"), "the stones have moved from where they were"
    page.screenshot(path=SHOTS / "motion-at-an-impact.png")
    page.click("text=Keep")
    drag(page, "[data-handle=pulse-amplitude] .hit", 0, 30)
    assert 'amplitude = "0.8 g"' not in settled(page)
    assert page.evaluate("window.extrados.motion.words.peak_rotation_rad") != told["peak_rotation_rad"]
    page.click("[data-third=energy]")
    page.click("[data-third=friction]")
    page.wait_for_timeout(200)
    page.screenshot(path=SHOTS / "motion-friction.png")


def test_results_are_looked_at_side_by_side(page: Any, served: Served) -> None:
    for name, text in (("one", ROCKING), ("two", ROCKING.replace("0.8 g", "0.6 g"))):
        (served.folder / f"{name}.toml").write_text(text)
        subprocess.run(
            [sys.executable, "-m", "extrados", "run", f"{name}.toml", "--quiet", "--no-figures"], cwd=served.folder,
            check=True, timeout=300,
        )  # fmt: skip
    page.click("[data-tab=results]")
    until(page, "window.extrados.welcome.runs.length === 2")
    page.select_option("select[aria-label='Run A']", "results/one")
    page.wait_for_selector(".column >> nth=0 >> .chart .dots")
    page.select_option("select[aria-label='Analysis of run A']", "rocking")
    page.wait_for_selector(".column >> nth=0 >> .chart .line")
    page.click("text=Compare two runs")
    page.select_option("select[aria-label='Run B']", "results/two")
    page.wait_for_selector(".column >> nth=1 >> .chart .dots")
    page.select_option("select[aria-label='Analysis of run B']", "rocking")
    page.wait_for_selector(".column >> nth=1 >> .chart .line")
    page.screenshot(path=SHOTS / "results-side-by-side.png")
    page.click("text=Run the deck…")
    page.fill("dialog input[type=text]", "computed.toml")
    page.click("dialog button[type=submit]")
    until(page, "window.extrados.welcome.runs.some(r => r.path === 'results/computed')", timeout=120_000)
    assert extrados.load(served.folder / "results" / "computed")["tilt"].collapse_acceleration_g > 0.3


def test_a_dead_server_is_told_and_comes_back_with_the_state(page: Any, served: Served) -> None:
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


def test_two_pages_do_not_disturb_each_other(page: Any, served: Served) -> None:
    other = page.context.new_page()
    other.goto(served.address)
    other.wait_for_selector("[data-handle=thickness]")
    before = settled(other)
    drag(page, "[data-handle=thickness] .hit", 0, -15)
    assert settled(page) != before
    assert settled(other) == before
    other.close()


def test_pictures_and_films_come_out(page: Any, served: Served) -> None:
    for entry, magic in (("Drawing, SVG", b"<svg"), ("Picture, PNG", b"\x89PNG")):
        page.click("text=Export")
        with page.expect_download() as waited:
            page.click(f"text={entry}")
        content = waited.value.path().read_bytes()
        assert content.startswith(magic)
        SHOTS.mkdir(parents=True, exist_ok=True)
        (SHOTS / f"exported.{'svg' if magic == b'<svg' else 'png'}").write_bytes(content)
    open_text(page, ROCKING.replace("end_time = 3.0", "end_time = 1.0"))
    page.click("[data-tab=motion]")
    until(page, "window.extrados.motion.arrays?.pose")
    page.click("text=Export")
    with page.expect_download(timeout=240_000) as waited:
        page.click("text=Film, GIF, real time")
    content = waited.value.path().read_bytes()
    assert content.startswith(b"GIF89a")
    from PIL import Image

    with Image.open(waited.value.path()) as image:
        assert image.size == (1280, 720)
        assert image.n_frames > 5


def test_a_slowed_film_lasts_five_times_as_long(page: Any) -> None:
    from PIL import Image

    open_text(page, ROCKING.replace("end_time = 3.0", "end_time = 0.4"))
    page.click("[data-tab=motion]")
    until(page, "window.extrados.motion.arrays?.pose")
    end, seconds = page.evaluate("window.extrados.motion.end"), {}
    for name in ("real time", "a fifth of the speed"):
        page.click("text=Export")
        with page.expect_download(timeout=240_000) as waited:
            page.click(f"text=Film, GIF, {name}")
        with Image.open(waited.value.path()) as image:
            looks = []
            for k in range(image.n_frames):
                image.seek(k)
                looks.append((image.info["duration"], image.convert("RGB").tobytes()))
            image.save(SHOTS / f"film-{name.replace(' ', '-')}.png")  # the last picture
        seconds[name] = sum(duration for duration, _ in looks) / 1000
        assert len({look for _, look in looks}) > 0.5 * len(looks), "it moves"
    assert seconds["real time"] == pytest.approx(end, abs=0.2)
    assert seconds["a fifth of the speed"] == pytest.approx(5 * end, abs=0.2)


def test_what_holds_a_building_is_drawn(page: Any) -> None:
    open_text(page, HELD)
    drawn = """name => { const box = document.querySelector(name).getBBox(); return [box.x, box.y, box.x + box.width, box.y + box.height]; }"""
    x = page.evaluate("window.extrados.anchor[0]")
    assert page.evaluate(drawn, ".tie:not(.damper)")[2] + x == pytest.approx(2.0)
    assert page.evaluate(drawn, ".damper")[2] + x == pytest.approx(3.0)
    assert page.evaluate(drawn, ".supports")[0] + x < -0.01, "the wall on its left"
    assert page.evaluate(drawn, ".mass")[3] > 4.0
    page.wait_for_timeout(200)
    page.screenshot(path=SHOTS / "held.png")


def test_a_run_that_is_chosen_leaves_nothing_of_the_one_before(page: Any, served: Served) -> None:
    (served.folder / "one.toml").write_text(ROCKING)
    subprocess.run(
        [sys.executable, "-m", "extrados", "run", "one.toml", "--quiet", "--no-figures"], cwd=served.folder,
        check=True, timeout=300,
    )  # fmt: skip
    page.click("[data-tab=results]")
    until(page, "window.extrados.welcome.runs.length === 1")
    page.select_option("select[aria-label='Run A']", "results/one")
    page.wait_for_selector(".column >> nth=0 >> .body-view .stones")
    left = page.evaluate("""() => {
        const { columns } = window.extrados.results, words = columns[0].words;
        columns[0].take({ path: words.path, title: words.title, analyses: words.analyses }, {});
        return document.querySelectorAll(".column .chart, .column .player:not([hidden]), .column .body-box:not([hidden])").length;
    }""")  # fmt: skip
    assert left == 0


def test_the_five_exercises(page: Any) -> None:
    page.click("[data-side=teach]")
    assert page.locator(".exercises li").count() == 5
    solutions = [
        {"structure.thickness": 0.55}, None, {"structure.buttress_width": 2.0},
        {"motion.amplitude": "0.6 g", "motion.duration": 0.45}, None,
    ]  # fmt: skip
    for k, changes in enumerate(solutions):
        page.click("[data-side=teach]")
        page.click(f".exercises button >> nth={k}")
        until(page, f"window.extrados.name === 'exercise-{k + 1}.toml'")
        settled(page)
        if k == 0:
            page.click(".exercise .first")
            page.wait_for_selector(".told.bad")
            page.evaluate("c => window.extrados.change(c)", {"structure.thickness": 0.54})
        elif k == 1:
            page.evaluate("window.extrados.show({ gamma: window.extrados.scene.capacity.plus_g * 0.99 })")
        elif k == 2:
            _bisect_buttress(page)
        elif k == 3:
            page.evaluate("c => window.extrados.change(c)", changes)
        else:
            page.evaluate("c => window.extrados.change(c)", {"structure.width": 2.0, "structure.height": 8.0})
            _least_sine(page)
        settled(page)
        page.click(".exercise .first")
        page.wait_for_selector(".told.good", timeout=20_000)
        page.screenshot(path=SHOTS / f"exercise-{k + 1}.png")


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
    sliders = page.evaluate(
        "[...document.querySelectorAll('[role=slider]')].map(e => e.getAttribute('aria-valuetext'))"
    )
    assert all(re.search(r"\d", text) for text in sliders)


def _data(text: str) -> dict[str, Any]:
    import tomllib

    return tomllib.loads(text)


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
end_time = 3.0
"""
