"""A class in chromium: pupils come by the link, the teacher sees them small, sends a deck, freezes, shows one."""

import re
import subprocess
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from hands import drag, settled, until
from served import SHOTS, Served


@pytest.fixture
def room(tmp_path: Path) -> Iterator[Served]:
    found = Served(tmp_path, "--class")
    yield found
    found.close()


def test_a_class_from_both_sides(browser: Any, room: Served) -> None:
    printed = "".join(room.lines)
    link = re.search(r"Class:\s+(http://\S+)", printed)[1]
    until_printed(room)
    teacher_link = re.search(r"Teacher:\s+(http://\S+)", "".join(room.lines))[1]
    assert "Only this machine can open the page of the class" in "".join(room.lines)
    context = browser.new_context(viewport={"width": 1366, "height": 768})
    teacher = context.new_page()
    teacher.goto(teacher_link)
    teacher.wait_for_selector("[data-handle=thickness]")
    pupils = []
    for _ in range(3):
        pupil = browser.new_context(viewport={"width": 390, "height": 844}, has_touch=True, is_mobile=True).new_page()
        pupil.goto(link)
        pupil.wait_for_selector("[data-handle=thickness]")
        pupils.append(pupil)
    assert pupils[2].locator("[data-tab=results]").is_hidden(), "a pupil has no files"
    pupils[1].evaluate("window.extrados.change({ 'structure.thickness': 0.3 })")
    settled(pupils[1])
    pupils[2].evaluate("window.extrados.show({ gamma: 0.2 })")
    settled(pupils[2])
    teacher.click("[data-tab=class]")
    until(teacher, "document.querySelectorAll('.pupil').length === 3 && document.querySelectorAll('.pupil.bad').length === 1")
    SHOTS.mkdir(parents=True, exist_ok=True)
    teacher.screenshot(path=SHOTS / "class-teacher.png")
    teacher.click("text=Freeze")
    until(pupils[0], "document.querySelector('.extrados').classList.contains('frozen')")
    pupils[0].screenshot(path=SHOTS / "class-frozen.png")
    teacher.click("text=Let the pupils continue")
    until(pupils[0], "!document.querySelector('.extrados').classList.contains('frozen')")
    teacher.click(".pupil.bad")
    until(teacher, "window.extrados.name === 'pupil-2.toml'")
    settled(teacher)
    assert "thickness = 0.3" in teacher.evaluate("window.extrados.text")
    drag(teacher, "[data-handle=thickness] .hit", 0, -60)
    sent = settled(teacher)
    teacher.click("[data-tab=class]")
    teacher.click("text=Send my deck to all")
    for pupil in pupils:
        until(pupil, "text => window.extrados.text === text", sent)
    context.close()


def until_printed(room: Served) -> None:
    import time

    end = time.monotonic() + 30
    while not any("Teacher:" in line for line in room.lines):
        assert time.monotonic() < end
        time.sleep(0.05)


def test_an_address_of_the_internet_is_refused(tmp_path: Path) -> None:
    import sys

    done = subprocess.run(
        [sys.executable, "-m", "extrados", "explore", "--no-browser", "--class", "--address", "0.0.0.0"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        timeout=60,
    )
    assert done.returncode == 2
    assert "private network" in re.sub(r"[\s│]+", " ", done.stderr)
