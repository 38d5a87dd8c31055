"""Which functions of the package each test of this folder runs through: tools/seeded_faults.py asks it once."""

import json
import os
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

import extrados


@pytest.fixture(autouse=True)
def _touched(request: pytest.FixtureRequest) -> Iterator[None]:
    """Notes the seconds of a test and the functions of the package that it runs through, where EXTRADOS_TOUCHED names a file."""
    place = os.environ.get("EXTRADOS_TOUCHED")
    if not place:
        yield
        return
    root, seen, begin = str(Path(extrados.__file__).parent), set(), time.perf_counter()

    def note(frame: Any, event: str, _: Any) -> None:  # of each call, and of no line
        seen.add(frame.f_code)

    sys.settrace(note)
    yield
    sys.settrace(None)
    found = {(os.path.relpath(c.co_filename, root), c.co_firstlineno) for c in seen if c.co_filename.startswith(root)}
    row = {"test": request.node.nodeid, "seconds": time.perf_counter() - begin, "touched": sorted(found)}
    with open(place, "a", encoding="utf-8") as file:
        file.write(json.dumps(row) + "\n")
