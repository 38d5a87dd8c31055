"""What the page plays, compares and gives out: motion and its map, stored runs, pictures and films."""

import subprocess
import sys
from typing import Any

import pytest
from hands import ROCKING, data_of, drag, open_text, settled, until
from served import SHOTS, Served

import extrados


def test_a_stack_rocks_beside_its_map_and_a_motion_is_drawn_alone(page: Any) -> None:
    page.click("[data-tab=motion]")
    page.evaluate("window.extrados.open({ preset: 'rocking/stack' })")
    until(page, "window.extrados.motion.arrays?.rotation_upper && window.extrados.motion.map?.told?.whole")
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
    run = extrados.run(data_of(ROCKING))
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
            [sys.executable, "-m", "extrados", "run", f"{name}.toml", "--quiet", "--no-figures"], cwd=served.folder, check=True, timeout=300
        )
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
    differ = page.locator(".apart tbody tr", has_text="peak rotation rad")
    peaks = [extrados.load(served.folder / "results" / name)["rocking"].peak_rotation_rad for name in ("one", "two")]
    assert float(differ.locator("td").nth(2).inner_text()) == pytest.approx(peaks[1] / peaks[0], rel=1e-3)
    page.screenshot(path=SHOTS / "results-side-by-side.png")
    page.click("text=Run the deck…")
    page.fill("dialog input[type=text]", "computed.toml")
    page.click("dialog button[type=submit]")
    until(page, "window.extrados.welcome.runs.some(r => r.path === 'results/computed')", timeout=120_000)
    assert extrados.load(served.folder / "results" / "computed")["tilt"].collapse_acceleration_g > 0.3
    page.select_option("select[aria-label='Run A']", "results/computed")
    until(page, "window.extrados.results.columns[0].words?.analysis === 'tilt'")
    page.locator("summary", has_text="Figures of the report").first.click()
    until(page, "[...document.querySelectorAll('.figures img')].filter(i => i.naturalWidth > 100).length >= 2")
    page.locator(".figures").first.scroll_into_view_if_needed()
    page.screenshot(path=SHOTS / "results-figures.png")


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


def test_a_run_that_is_chosen_leaves_nothing_of_the_one_before(page: Any, served: Served) -> None:
    (served.folder / "one.toml").write_text(ROCKING)
    subprocess.run(
        [sys.executable, "-m", "extrados", "run", "one.toml", "--quiet", "--no-figures"], cwd=served.folder, check=True, timeout=300
    )
    page.click("[data-tab=results]")
    until(page, "window.extrados.welcome.runs.length === 1")
    page.select_option("select[aria-label='Run A']", "results/one")
    page.wait_for_selector(".column >> nth=0 >> .body-view .stones")
    left = page.evaluate("""() => {
        const { columns } = window.extrados.results, words = columns[0].words;
        columns[0].take({ path: words.path, title: words.title, analyses: words.analyses }, {});
        return document.querySelectorAll(".column .chart, .column .player:not([hidden]), .column .body-box:not([hidden])").length;
    }""")
    assert left == 0
