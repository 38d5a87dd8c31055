"""Memory that runs out while libraries are loaded: seen before where it can be, told as what it is where not, and faults that
happen to come while memory is short stay faults."""

import errno
import importlib
import importlib.util
import json
import os
import subprocess
import sys
import traceback
from pathlib import Path

import pytest

from extrados import interrupts, kinds, room
from extrados.analyses.context import Context
from extrados.cli import main
from extrados.decks.explain import starter
from extrados.decks.reader import read_text
from extrados.running.run import compute

linux = pytest.mark.skipif(sys.platform != "linux", reason="limits and /proc are those of Linux")


@pytest.mark.parametrize(
    ("cores", "said", "threads"),
    [
        (4, {}, 4),
        (128, {}, 64),
        (8, {"OPENBLAS_NUM_THREADS": "2", "OMP_NUM_THREADS": "4"}, 2),
        (8, {"OPENBLAS_NUM_THREADS": "0", "OMP_NUM_THREADS": "4"}, 4),
        (8, {"OPENBLAS_NUM_THREADS": "-1", "GOTO_NUM_THREADS": "3", "OMP_NUM_THREADS": "4"}, 3),
        (8, {"OMP_NUM_THREADS": "4,2"}, 4),
        (8, {"OMP_NUM_THREADS": " +4"}, 4),
        (8, {"OMP_NUM_THREADS": "many"}, 8),
        (8, {"OMP_NUM_THREADS": "16"}, 8),
    ],
)
def test_threads_are_counted_as_openblas_does(monkeypatch, cores: int, said: dict[str, str], threads: int) -> None:
    for name in ("OPENBLAS_NUM_THREADS", "OPENBLAS_DEFAULT_NUM_THREADS", "GOTO_NUM_THREADS", "OMP_NUM_THREADS"):
        monkeypatch.delenv(name, raising=False)
    for name, text in said.items():
        monkeypatch.setenv(name, text)
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: set(range(cores)), raising=False)
    monkeypatch.setattr(os, "cpu_count", lambda: 1024)
    assert room._threads() == threads


#: The program that counts: OpenBLAS itself, as it was loaded by SciPy
COUNTED = """
import ctypes, sys
from extrados import room
import scipy.linalg
path = next(line.split()[-1] for line in open("/proc/self/maps") if "scipy.libs/libscipy_openblas" in line)
library = ctypes.CDLL(path)
library.scipy_openblas_get_config.restype = ctypes.c_char_p
most = library.scipy_openblas_get_config().decode().rpartition("MAX_THREADS=")[2]
print(room._threads(), library.scipy_openblas_get_num_threads(), room._MOST, most)
"""


@linux
@pytest.mark.parametrize("said", [{}, {"OPENBLAS_NUM_THREADS": "0", "OMP_NUM_THREADS": "1,2"}])
def test_openblas_itself_agrees(said: dict[str, str]) -> None:
    wheel = Path(importlib.util.find_spec("scipy").origin).parents[1] / "scipy.libs"
    if not list(wheel.glob("libscipy_openblas-*")):
        pytest.skip("SciPy brings no OpenBLAS of its own here: only that of its wheels can be asked")
    kept = {name: text for name, text in os.environ.items() if not name.endswith("_NUM_THREADS")}
    run = subprocess.run(
        [sys.executable, "-c", COUNTED], capture_output=True, text=True, env={**kept, **said}, check=True
    )
    ours, theirs, most, compiled = run.stdout.split()
    assert (ours, most) == (theirs, compiled)


#: Says whether there is room for two pieces of 40 MB, as a limit of so many MB more than now allows
LIMITED = """
import resource, sys
from pathlib import Path
from extrados import room
kind, more = getattr(resource, sys.argv[1]), int(sys.argv[2])
pages = [int(field) for field in Path("/proc/self/statm").read_text().split()]
used = pages[5 if kind == resource.RLIMIT_DATA else 0] * resource.getpagesize()
resource.setrlimit(kind, (used + more * 2**20, resource.RLIM_INFINITY))
print(room._has(40 << 20, 40 << 20))
"""


@linux
@pytest.mark.parametrize("limit", ["RLIMIT_AS", "RLIMIT_DATA"])
@pytest.mark.parametrize(("more", "has"), [(60, False), (120, True)])
def test_every_limit_of_memory_is_seen(limit: str, more: int, has: bool) -> None:
    run = subprocess.run([sys.executable, "-c", LIMITED, limit, str(more)], capture_output=True, text=True, check=True)
    assert run.stdout.strip() == str(has)


@linux
def test_the_look_takes_nothing_and_asks_for_no_memory_that_is_free() -> None:
    """More than the whole machine has is no matter, as OpenBLAS' buffers are none until they are used; but where the system
    promises no more than it has."""
    strict = Path("/proc/sys/vm/overcommit_memory").read_text().strip() == "2"
    before = int(Path("/proc/self/statm").read_text().split()[1])
    whole = os.sysconf("SC_PHYS_PAGES") * os.sysconf("SC_PAGE_SIZE")
    assert room._has(*[1 << 30] * (2 * (whole >> 30) + 2)) is not strict
    assert (int(Path("/proc/self/statm").read_text().split()[1]) - before) * os.sysconf("SC_PAGE_SIZE") < 16 << 20


@linux
def test_threads_are_reckoned_with_the_stack_that_they_are_given(monkeypatch) -> None:
    import resource

    for soft, bytes_ in ((64 << 20, 64 << 20), (resource.RLIM_INFINITY, 8 << 20)):
        monkeypatch.setattr(resource, "getrlimit", lambda _, soft=soft: (soft, resource.RLIM_INFINITY))
        assert room._stack() == bytes_


def test_room_is_looked_for_until_a_library_that_needs_it_is_loaded(monkeypatch) -> None:
    (finder,) = [one for one in sys.meta_path if type(one).__module__ == "extrados.room"]
    for name in room._USERS:
        monkeypatch.delitem(sys.modules, name, raising=False)
    asked = []
    monkeypatch.setattr(room, "_has", lambda *pieces: not asked.append(sum(pieces)))
    finder.find_spec("scipy.spatial", None)
    assert not asked
    for count in (1, 2):  # a mere look for the module loads nothing
        finder.find_spec("scipy.linalg", None)
        assert len(asked) == count
    monkeypatch.setattr(room, "_has", lambda *_: False)
    with pytest.raises(
        MemoryError, match=r"not enough memory: SciPy's linear algebra takes about \d+ MB of address space"
    ):
        finder.find_spec("scipy.linalg", None)
    monkeypatch.setitem(sys.modules, "scipy.special", sys)
    finder.find_spec("scipy.linalg", None)


def test_a_reload_adds_no_second_look() -> None:
    before = list(sys.meta_path)
    importlib.reload(room)
    assert sys.meta_path == before


@pytest.mark.parametrize(
    ("error", "when_short", "else_"),
    [
        (SystemError("returned NULL without setting an exception"), True, False),
        (ImportError("x.so: cannot read file data"), True, False),
        (ImportError("x.so: failed to map segment from shared object"), True, True),
        (OSError("no words"), True, False),
        (OSError(errno.ENOMEM, os.strerror(errno.ENOMEM)), True, True),
        (OSError("x.so: failed to map segment from shared object"), True, True),
        (FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT)), False, False),
        (RuntimeError("can't start new thread"), True, False),
        (RuntimeError("no convergence"), False, False),
        (ValueError("negative"), False, False),
        (KeyError("name"), False, False),
    ],
    ids=str,
)
def test_what_is_told_as_memory_that_lacked(monkeypatch, error: Exception, when_short: bool, else_: bool) -> None:
    monkeypatch.setattr(room, "_has", lambda *_: False)
    assert room.lacked(error) is when_short
    monkeypatch.setattr(room, "_has", lambda *_: True)
    assert room.lacked(error) is else_


def failing(monkeypatch, error: Exception, where: str = "run"):
    """The result of a tilt whose driver, or the import of it, raises this while memory is short."""

    def fail(*_: object) -> None:
        raise error

    context = Context(read_text(starter("tilt").encode(), "deck.toml", Path("/nowhere")))
    if where == "run":
        monkeypatch.setattr("extrados.analyses.limit.tilt.run", fail)
    else:
        monkeypatch.setattr(kinds.importlib, "import_module", fail)
    monkeypatch.setattr(room, "_has", lambda *_: False)
    (result,) = compute(context).results
    return result


@pytest.mark.parametrize("where", ["run", "import"])
def test_lack_of_memory_is_told_and_where_it_was_met_is_kept(monkeypatch, where: str) -> None:
    result = failing(monkeypatch, SystemError("of a library"), where)
    assert result.status == "failed"
    assert result.reason == "not enough memory: SystemError: of a library (internal-error-tilt.txt says where)"
    assert b"in fail" in result.files["internal-error-tilt.txt"]


@pytest.mark.parametrize("error", [MemoryError(), SystemError("error return without exception set")], ids=repr)
def test_where_there_is_no_room_for_the_file_the_reason_is_told(monkeypatch, error: Exception) -> None:
    def fail(_: object) -> None:
        raise error

    monkeypatch.setattr(traceback, "format_exception", fail)
    result = failing(monkeypatch, SystemError("of a library"))
    assert result.reason == "not enough memory: SystemError: of a library" and not result.files


def test_a_fault_of_ours_stays_one_while_memory_is_short(monkeypatch) -> None:
    result = failing(monkeypatch, ZeroDivisionError("of ours"))
    assert result.reason == "internal error, please report it with internal-error-tilt.txt: ZeroDivisionError: of ours"
    assert b"in fail" in result.files["internal-error-tilt.txt"]


def test_memory_that_python_itself_says_is_lacking_needs_no_report(monkeypatch) -> None:
    result = failing(monkeypatch, MemoryError("Unable to allocate 3 MiB"))
    assert result.reason == "not enough memory: Unable to allocate 3 MiB" and not result.files
    assert failing(monkeypatch, MemoryError()).reason == "not enough memory"


def test_an_end_that_found_no_room_to_be_told_is_told_after(monkeypatch) -> None:
    def fail(*_: object) -> None:
        raise SystemError("error return without exception set")

    monkeypatch.setattr("extrados.analyses.sequence.run_one", fail)
    reason = "not enough memory: SystemError: error return without exception set (internal-error-tilt.txt says where)"
    assert failing(monkeypatch, MemoryError()).reason == reason


@pytest.mark.parametrize("error", [SystemError("of a library"), MemoryError()], ids=str)
def test_an_interrupt_comes_before_memory(monkeypatch, error: Exception) -> None:
    class Counted(list):
        """As many as it was asked for, as if a signal came each time."""

        def __len__(self) -> int:
            self.append(0)
            return super().__len__()

    monkeypatch.setattr(interrupts, "asked", Counted())
    assert failing(monkeypatch, error).status == "interrupted"


@pytest.mark.parametrize("error", [MemoryError(), SystemError("of Python itself")], ids=repr)
@pytest.mark.parametrize("more", [[], ["--json"]], ids=str)
def test_a_command_without_memory_ends_in_words(
    monkeypatch, capfd, tmp_path, more: list[str], error: Exception
) -> None:
    (tmp_path / "deck.toml").write_text(starter("tilt"))

    def fail(*_: object) -> None:
        raise error

    monkeypatch.setattr(room, "_has", lambda *_: False)

    monkeypatch.setattr("extrados.decks.reader.read_deck", fail)
    monkeypatch.setattr(sys, "argv", ["extrados", "run", str(tmp_path / "deck.toml"), *more])
    monkeypatch.setattr(interrupts, "answer", lambda _: None)
    with pytest.raises(SystemExit) as left:
        main()
    told = capfd.readouterr()
    assert left.value.code == 3 and "Traceback" not in told.out + told.err
    words = ": ".join(filter(None, ["not enough memory", str(error)]))
    if more:
        assert json.loads(told.out) == {"error": [words], "exit": 3}
    else:
        assert told.err.strip() == words


def test_a_fault_while_there_is_memory_stays_a_fault(monkeypatch, tmp_path) -> None:
    def fail(*_: object) -> None:
        raise SystemError("of Python itself")

    (tmp_path / "deck.toml").write_text(starter("tilt"))
    monkeypatch.setattr("extrados.decks.reader.read_deck", fail)
    monkeypatch.setattr(sys, "argv", ["extrados", "run", str(tmp_path / "deck.toml")])
    monkeypatch.setattr(interrupts, "answer", lambda _: None)
    with pytest.raises(SystemError, match="of Python itself"):
        main()


@pytest.mark.parametrize("error", [MemoryError(), SystemError()], ids=repr)
def test_a_command_without_memory_for_anything_ends_in_words(monkeypatch, capfd, error: Exception) -> None:
    def fail(*_: object) -> None:
        raise error

    monkeypatch.setattr(room, "_has", lambda *_: False)
    monkeypatch.setattr("extrados.cli.app", fail)
    monkeypatch.setattr(interrupts, "answer", lambda _: None)
    with pytest.raises(SystemExit) as left:
        main()
    assert left.value.code == 3 and capfd.readouterr().err.strip() == "not enough memory"
