"""The interactive page: time from the event of a hand to the picture that shows its answer, in headless chromium.

A page of 60 pictures a second waits 8 ms for its next frame in the mean: when the answer was drawn, before that frame, is told too.
Beside it the processor time of the session and of the page's own thread: on a machine that is busy with other things the one
grows, the others do not. The load of the machine is told at both ends.
"""

import os
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "browser"))
from served import Served, chromium

MOVES, APART = 150, 0.02  # movements of a drag, and seconds between them
ARCH = """[structure]
kind = "arch"
radius = 10.0
thickness = 1.5
embrace = 157.5
voussoirs = 36
[motion]
kind = "step-pulse"
amplitude = "0.6 g"
duration = 0.3
[[analysis]]
kind = "tilt"
[[analysis]]
kind = "rocking"
end_time = 10.0
"""


def wander(page, selector: str, dx: float, dy: float) -> None:
    """Drag a handle to and fro."""
    box = page.locator(selector).bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    page.mouse.move(x, y)
    page.mouse.down()
    for k in range(MOVES):
        share = np.sin(2.0 * np.pi * k / 50.0)
        page.mouse.move(x + dx * share, y + dy * share)
        time.sleep(APART)
    page.mouse.up()
    page.wait_for_timeout(800)


class Busy:
    """Processor time of the page's thread [s], as the browser counts it."""

    def __init__(self, page):
        self.link = page.context.new_cdp_session(page)
        self.link.send("Performance.enable", {"timeDomain": "threadTicks"})
        self.last = self.total()

    def total(self) -> float:
        return next(m["value"] for m in self.link.send("Performance.getMetrics")["metrics"] if m["name"] == "TaskDuration")

    def since(self) -> float:
        """What it was since the last look."""
        before, self.last = self.last, self.total()
        return self.last - before


def told(page, busy: Busy, what: str, kind: str, target: str) -> None:
    """Percentiles of one kind of answer since the last look."""
    spent = busy.since()
    rows = [row for row in page.evaluate("window.extrados.timings.splice(0)") if row["do"] == kind][1:]
    if not rows:
        print(f"{what}: nothing was measured")
        return
    ms, drawn, server = (np.array([row[key] for row in rows], dtype=float) for key in ("ms", "drawn", "server"))
    print(
        f"{what:44s} {len(rows):4d} pictures: median {np.median(ms):6.1f} ms, 95 % below {np.percentile(ms, 95):6.1f} ms ({target}); "
        f"drawn after {np.median(drawn):5.1f} ms, then the frame; "
        f"session {np.median(server):5.1f} and {np.percentile(server, 95):5.1f} ms of processor, page {1e3 * spent / (len(rows) + 1):5.1f} ms a picture"
    )


def main() -> int:
    found = chromium()
    if found is None:
        print("no chromium on this machine")
        return 0
    try:
        from playwright.sync_api import sync_playwright
    except ImportError:
        print("playwright is not installed: make browser")
        return 0
    with tempfile.TemporaryDirectory() as folder:
        served = Served(Path(folder), "--port", "8739")
        try:
            with sync_playwright() as driver:
                browser = driver.chromium.launch(executable_path=found, args=["--no-sandbox"])
                page = browser.new_page(viewport={"width": 1280, "height": 720})
                page.goto(served.address)
                busy = Busy(page)
                print(f"load {os.getloadavg()[0]:.1f} at the beginning, {os.cpu_count()} cores")
                page.wait_for_selector("[data-handle=thickness]")
                page.evaluate("text => window.extrados.open({ text, name: 'bench.toml' })", ARCH)
                page.wait_for_timeout(1500)
                page.evaluate("window.extrados.timings.splice(0)")
                busy.since()
                wander(page, "[data-handle=thickness] .hit", 0.0, 8.0)
                told(page, busy, "arch of 36 voussoirs, thickness", "drag", "asked 16, 33")
                wander(page, "[data-handle=tilt] .hit", 0.0, 30.0)
                told(page, busy, "the same, ground tilted", "show", "asked 16, 33")
                page.click("[data-tab=motion]")
                page.wait_for_timeout(3000)
                page.evaluate("window.extrados.timings.splice(0)")
                busy.since()
                wander(page, "[data-handle=pulse-amplitude] .hit", 0.0, 12.0)
                told(page, busy, "rocking of 10 s with its shapes", "rocking", "asked 40")
                for k in range(12):  # another building each time, or the map would be known
                    page.evaluate(f"window.extrados.change({{ 'structure.thickness': {1.4 + 0.01 * k:.2f} }})")
                    page.wait_for_timeout(700)
                told(page, busy, "first picture of a failure domain of 40 x 40", "domain", "asked 100")
                page.click("[data-tab=structure]")
                page.evaluate("window.extrados.open({ preset: 'vault/vezelay-like' })")
                page.wait_for_timeout(1500)
                page.evaluate("window.extrados.timings.splice(0)")
                busy.since()
                wander(page, "[data-handle=buttress_width] .hit", 6.0, 0.0)
                told(page, busy, "section of three aisles, width of buttresses", "drag", "asked 25")
                print(f"load {os.getloadavg()[0]:.1f} at the end")
                browser.close()
        finally:
            served.close()
    return 0


if __name__ == "__main__":
    sys.exit(main())
