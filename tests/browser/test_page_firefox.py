"""The page in Debian's Firefox, by its own WebDriver BiDi: a key moves a handle, and a structure is drawn. Playwright drives
only a Firefox of its own."""

import contextlib
import json
import re
import shutil
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from served import Served


class Firefox:
    """A headless Firefox with one tab."""

    def __init__(self, profile: Path, program: str):
        client = pytest.importorskip("websockets.sync.client")
        self.process = subprocess.Popen(
            [program, "--headless", "--no-remote", "--profile", str(profile), "--remote-debugging-port=0"],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            text=True,
        )
        found = next(filter(None, (re.search(r"listening on (ws://\S+)", line) for line in self.process.stderr)), None)
        assert found, "Firefox ended without a WebDriver"
        self.connection = client.connect(f"{found[1]}/session", max_size=None, open_timeout=60)
        self.socket, self.number = self.connection.__enter__(), 0
        self.call("session.new", capabilities={})
        self.tab = self.call("browsingContext.getTree")["contexts"][0]["context"]

    def call(self, method: str, **params: Any) -> dict[str, Any]:
        self.number += 1
        self.socket.send(json.dumps({"id": self.number, "method": method, "params": params}))
        while (reply := json.loads(self.socket.recv(timeout=60))).get("id") != self.number:
            pass
        assert reply["type"] == "success", reply
        return reply["result"]

    def evaluate(self, text: str) -> Any:
        """The value of an expression, by JSON."""
        given = self.call("script.evaluate", expression=f"JSON.stringify({text})", target={"context": self.tab}, awaitPromise=False)
        assert given["type"] == "success", given
        return json.loads(given["result"].get("value", "null"))

    def until(self, condition: str) -> None:
        end = time.monotonic() + 60
        while not self.evaluate(f"Boolean({condition})"):
            assert time.monotonic() < end, f"waited in vain for {condition}"
            time.sleep(0.05)

    def keys(self, *values: str) -> None:
        actions = [{"type": kind, "value": value} for value in values for kind in ("keyDown", "keyUp")]
        self.call("input.performActions", context=self.tab, actions=[{"type": "key", "id": "keys", "actions": actions}])

    def close(self) -> None:
        with contextlib.suppress(Exception):
            self.connection.__exit__(None, None, None)
        self.process.terminate()
        self.process.wait(20)


@pytest.fixture
def firefox(tmp_path: Path) -> Iterator[Firefox]:
    program = shutil.which("firefox-esr") or shutil.which("firefox")
    if program is None:
        pytest.skip("no Firefox on this machine: apt-get install firefox-esr")
    profile = tmp_path / "profile"
    profile.mkdir()
    found = Firefox(profile, program)
    yield found
    found.close()


def test_the_page_moves_and_draws_in_firefox(firefox: Firefox, served: Served) -> None:
    firefox.call("browsingContext.navigate", context=firefox.tab, url=served.address, wait="complete")
    firefox.until("window.extrados?.scene?.capacity && window.extrados.still")
    assert "Firefox" in firefox.evaluate("navigator.userAgent")
    before = firefox.evaluate("window.extrados.scene.capacity.plus_g")
    firefox.evaluate("document.querySelector('[data-handle=thickness]').focus()")
    firefox.keys("\ue013", "\ue013")  # arrow up
    firefox.until(f"window.extrados.still && window.extrados.scene.capacity.plus_g > {before}")
    firefox.evaluate("window.extrados.sheet.begin(true)")
    firefox.until("window.extrados.draft !== null")
    firefox.keys("\ue006", "\ue014", "\ue014", "\ue013", "\ue013", "\ue006")  # Enter, twice right, twice up, Enter
    firefox.until("window.extrados.still && window.extrados.scene.blocks === 5")
    assert firefox.evaluate("window.extrados.text").count("[[structure.block]]") == 5
