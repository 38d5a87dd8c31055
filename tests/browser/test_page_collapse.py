"""The collapse is shown: a structure that cannot stand or passes its capacity falls, is replayed, and says why; limits hold."""

from typing import Any

import numpy as np
import pytest
from hands import drag, settled, until
from served import SHOTS

POSES = "() => ({ time: window.extrados.fall.time, pose: [...window.extrados.fall.pose], shape: window.extrados.fall.pose.shape })"


def fall(page: Any) -> tuple[np.ndarray, np.ndarray]:
    """Times and poses of the whole fall."""
    until(page, "window.extrados.fall.done")
    found = page.evaluate(POSES)
    return np.array(found["time"]), np.array(found["pose"]).reshape(found["shape"])


def test_an_arch_that_cannot_stand_falls_and_is_replayed(page: Any) -> None:
    page.evaluate("window.extrados.change({ 'structure.thickness': 0.3 })")
    settled(page)
    time, pose = fall(page)
    assert time[-1] == pytest.approx(3.0, abs=0.01) and time[0] == 0.0
    assert np.all(np.diff(time) > 0.0)
    down = pose[0, :, 1] - pose[-1, :, 1]
    assert down.max() > 2.0, "the crown lies on the ground"
    assert pose[-1, :, 1].min() > -0.5, "the ground holds what falls"
    until(page, "window.extrados.fall.now > 0.5")
    assert page.locator(".marks .hinge").count() >= 3, "hinges are open"
    page.screenshot(path=SHOTS / "collapse-weight.png")
    words = page.locator(".fall .why").inner_text()
    assert words.startswith("Cannot stand. No thrust line") and "thicker" in words
    until(page, "window.extrados.fall.now > 2.9")
    until(page, "window.extrados.fall.now < 2.5 && window.extrados.fall.playing")  # 5 s long, also seen by a slow machine
    page.click("text=Show the structure")
    assert page.evaluate("window.extrados.drawing.moving()") is False
    page.click("text=Replay")
    until(page, "window.extrados.drawing.moving()")
    drag(page, "[data-handle=thickness] .hit", 0, -25)
    settled(page)
    until(page, "window.extrados.scene.stands === true")
    assert page.locator(".fall").is_hidden()


def test_tilted_past_the_capacity_to_the_left_it_falls_to_the_left(page: Any) -> None:
    page.evaluate("window.extrados.show({ gamma: -0.4 })")
    settled(page)
    assert "Collapses towards −x" in page.locator(".answer").inner_text()
    assert "Hinges, load to −x" in page.locator(".answer").inner_text()
    _time, pose = fall(page)
    middle = pose[:, :, 0].mean(axis=1)
    assert middle[-1] < middle[0] - 0.5, "−x is to the left"
    assert "towards −x" in page.locator(".fall .why").inner_text()
    until(page, "window.extrados.fall.now > 0.8")
    page.screenshot(path=SHOTS / "collapse-tilt.png")
    page.evaluate("window.extrados.show({ gamma: 0.4 })")
    settled(page)
    assert "Collapses towards +x" in page.locator(".answer").inner_text()
    _time, pose = fall(page)
    middle = pose[:, :, 0].mean(axis=1)
    assert middle[-1] > middle[0] + 0.5


def test_a_drag_past_a_limit_holds_the_handle_there_and_says_which(page: Any) -> None:
    drag(page, "[data-handle=thickness] .hit", 0, 300)
    settled(page)
    assert "Limit of Thickness" in page.locator(".status").inner_text()
    assert 0.0 < page.evaluate("window.extrados.handles.find(h => h.name === 'thickness').value") < 0.05
    page.evaluate("window.extrados.ask({ do: 'drag', handle: 'embrace', to: [0, 90], ends: true })")
    settled(page)
    assert "20 to 270 deg" in page.locator(".status").inner_text()
    page.evaluate("window.extrados.show({ gamma: 9 })")
    settled(page)
    assert "Tilt of the ground" in page.locator(".status").inner_text()
    assert page.evaluate("window.extrados.view.gamma") == pytest.approx(2.5)


def test_a_late_refusal_of_a_fall_leaves_the_words_of_a_limit(page: Any) -> None:
    """Asked before the answer to a drag, refused after it: the refusal is of a scene that is gone."""
    settled(page)
    drag = "ask({ do: 'drag', handle: 'embrace', to: [0, 90], ends: true })"
    told = page.evaluate(f"new Promise(done => {{ window.extrados.{drag}; window.extrados.ask({{ do: 'fall' }}, {{ reply: done }}); }})")
    assert "does not collapse" in told["bad"]
    settled(page)
    assert "20 to 270 deg" in page.locator(".status").inner_text()


def test_no_collapse_of_what_stands(page: Any) -> None:
    settled(page)
    assert page.locator(".fall").is_hidden()
    told = page.evaluate("new Promise(done => window.extrados.ask({ do: 'fall' }, { reply: words => done(words.bad) }))")
    assert "does not collapse" in told
