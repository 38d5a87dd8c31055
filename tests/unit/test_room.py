"""Memory that lacks is told as what it is, before an analysis waits for it; faults that come while memory is short stay faults."""

import errno
import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from extrados import interrupts, room
from extrados.analyses.context import Context
from extrados.cli import main
from extrados.decks.explain import starter
from extrados.decks.reader import read_text
from extrados.running.run import compute

linux = pytest.mark.skipif(sys.platform != "linux", reason="limits and /proc are those of Linux")
#: Says whether there is room for 80 MB, as a limit of so many MB more than now allows
LIMITED = """
import resource, sys
from pathlib import Path
from extrados import room
kind, more = getattr(resource, sys.argv[1]), int(sys.argv[2])
pages = [int(field) for field in Path("/proc/self/statm").read_text().split()]
used = pages[5 if kind == resource.RLIMIT_DATA else 0] * resource.getpagesize()
resource.setrlimit(kind, (used + more * 2**20, resource.RLIM_INFINITY))
print(room.has(80 << 20))
"""


@linux
@pytest.mark.parametrize("limit", ["RLIMIT_AS", "RLIMIT_DATA"])
@pytest.mark.parametrize(("more", "has"), [(60, False), (120, True)])
def test_every_limit_of_memory_is_seen(limit: str, more: int, has: bool) -> None:
    run = subprocess.run([sys.executable, "-c", LIMITED, limit, str(more)], capture_output=True, text=True, check=True)
    assert run.stdout.strip() == str(has)


def test_a_library_leaves_the_import_and_the_environment_of_its_host_alone() -> None:
    code = "import os, sys; before = os.environ.copy(), len(sys.meta_path); import extrados.core.sla, extrados.running.run; print((os.environ.copy(), len(sys.meta_path)) == before)"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True).stdout.strip() == "True"


@pytest.mark.parametrize(
    ("error", "when_short", "else_"),
    [
        (SystemError("returned NULL without setting an exception"), True, False),
        (ImportError("x.so: failed to map segment from shared object"), True, True),
        (OSError(errno.ENOMEM, os.strerror(errno.ENOMEM)), True, True),
        (FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT)), False, False),
        (RuntimeError("can't start new thread"), True, False),
        (ValueError("negative"), False, False),
    ],
    ids=str,
)
def test_what_is_reported_as_memory_that_lacked(monkeypatch, error: Exception, when_short: bool, else_: bool) -> None:
    for has, wanted in ((False, when_short), (True, else_)):
        monkeypatch.setattr(room, "has", lambda _, has=has: has)
        assert room.lacked(error) is wanted


def ended(monkeypatch, error: Exception, started: bool = True):
    """The result of a tilt whose driver raises this while memory is short; or which has no room to start."""

    def fail(*_: object) -> None:
        raise error

    monkeypatch.setattr("extrados.analyses.limit.tilt.run", fail)
    monkeypatch.setattr(room, "has", lambda size: started and size == room.NEEDED)
    (result,) = compute(Context(read_text(starter("tilt").encode(), "deck.toml", Path("/nowhere")))).results
    return result


def test_lack_of_memory_is_reported_and_where_it_was_met_is_kept(monkeypatch) -> None:
    result = ended(monkeypatch, SystemError("of a library"))
    assert result.status == "failed"
    assert result.reason == "not enough memory: SystemError: of a library (internal-error-tilt.txt says where)"
    assert b"in fail" in result.files["internal-error-tilt.txt"]
    result = ended(monkeypatch, MemoryError("Unable to allocate 3 MiB"))
    assert result.reason == "not enough memory: Unable to allocate 3 MiB" and not result.files
    assert "needs 256 MB" in ended(monkeypatch, ZeroDivisionError(), started=False).reason
    fault = ended(monkeypatch, ZeroDivisionError("of ours"))
    assert fault.reason.startswith("internal error") and fault.reason.endswith("ZeroDivisionError: of ours")


@pytest.mark.parametrize("more", [[], ["--json"]], ids=str)
def test_a_command_without_memory_ends_in_words(monkeypatch, capfd, tmp_path, more: list[str]) -> None:
    (tmp_path / "deck.toml").write_text(starter("tilt"))

    def fail(*_: object) -> None:
        raise SystemError("of Python itself")

    monkeypatch.setattr("extrados.decks.reader.read_deck", fail)
    monkeypatch.setattr(sys, "argv", ["extrados", "run", str(tmp_path / "deck.toml"), *more])
    monkeypatch.setattr(interrupts, "answer", lambda _: None)
    with pytest.raises(SystemError, match="of Python itself"):  # a fault while there is memory stays a fault
        main()
    monkeypatch.setattr(room, "has", lambda _: False)
    with pytest.raises(SystemExit) as left:
        main()
    told, words = capfd.readouterr(), "not enough memory: of Python itself"
    assert left.value.code == 3
    assert json.loads(told.out) == {"error": [words], "exit": 3} if more else told.err.strip() == words
