"""The page in Debian's chromium, driven by Playwright; skipped, with the reason, where one of the two is missing."""

import contextlib
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import pytest
from served import SHOTS, SIZE, Served, chromium


@pytest.fixture(scope="session")
def browser() -> Iterator[Any]:
    found = chromium()
    if found is None:
        pytest.skip("no chromium on this machine: apt-get install chromium")
    api = pytest.importorskip("playwright.sync_api", reason="playwright is not installed: pip install playwright")
    with api.sync_playwright() as driver:
        options = ["--no-sandbox"] if hasattr(os, "geteuid") and os.geteuid() == 0 else []
        opened = driver.chromium.launch(executable_path=found, args=options)
        yield opened
        opened.close()


@pytest.fixture
def served(tmp_path: Path) -> Iterator[Served]:
    found = Served(tmp_path)
    yield found
    found.close()


@pytest.fixture(scope="session")
def shared(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    """One server for all tests that do not name `served`: a server takes 2 s to start, and each page has a session of its own."""
    found = Served(tmp_path_factory.mktemp("shared"))
    yield found
    found.close()


def is_foreign(url: str, own: str) -> bool:
    """Whether a request goes to another host than that of the page. A new server on the same machine is none."""
    place = urlsplit(url)
    return place.scheme not in ("data", "blob", "file") and place.hostname != own.split(":")[0]


@pytest.fixture
def page(browser: Any, request: pytest.FixtureRequest) -> Iterator[Any]:
    """The page, open and ready; its picture is kept at the end, and nothing may have gone wrong in it."""
    served = request.getfixturevalue("served" if "served" in request.fixturenames else "shared")
    context = browser.new_context(viewport=SIZE, accept_downloads=True)
    opened = context.new_page()
    troubles: list[str] = []
    opened.on("pageerror", lambda error: troubles.append(str(error)))
    opened.on("console", lambda message: troubles.append(message.text) if message.type == "error" else None)
    own = served.address.split("/")[2]
    opened.on("request", lambda request: troubles.append(f"the page requested {request.url}") if is_foreign(request.url, own) else None)
    opened.set_default_timeout(60_000)
    opened.goto(served.address)
    opened.wait_for_selector("[data-handle=thickness]")
    yield opened
    SHOTS.mkdir(parents=True, exist_ok=True)
    with contextlib.suppress(Exception):
        opened.screenshot(path=SHOTS / f"{request.node.name}.png")
    context.close()
    assert not [t for t in troubles if "WebSocket connection" not in t and "Failed to load resource" not in t]
