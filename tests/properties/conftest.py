"""What tools/fault_tests.py asks of the tests of this folder: their lines of the package, their answers, and runs with a fault planted."""

import gc
import hashlib
import importlib
import importlib.machinery
import importlib.util
import json
import os
import pkgutil
import re
import resource
import signal
import sys
import time
from collections.abc import Generator, Iterator
from functools import _lru_cache_wrapper
from pathlib import Path
from types import CodeType, FrameType, FunctionType
from typing import Any

import asking
import numpy as np
import pytest
from _pytest.runner import runtestprotocol
from hypothesis.internal.conjecture.providers import HypothesisProvider
from hypothesis.internal.constants_ast import Constants

import extrados
import trials
from extrados.results.model import Result

# hypothesis also draws numbers and words that it reads in the modules of the program which are loaded so far: the draws of one seed then
# depend on the analyses asked before in the process, and on every number of the program. There is no setting for it.
assert hasattr(HypothesisProvider, "_local_constants"), "hypothesis names its constants otherwise: see `_maybe_draw_constant`"
HypothesisProvider._local_constants = Constants()

ROOT = str(Path(extrados.__file__).parent)
#: Seconds of a processor after which a test ends the process by SIGPROF, by its name; others: none
PATIENCE: dict[str, float] = {}
#: Functions of the package in which faults are planted: all of them, and those with a cache
FUNCTIONS: list[FunctionType] = []
CACHES: list[Any] = []
#: Whether the test itself has passed
PASSED = pytest.StashKey[bool]()
#: Modules of the package that are entered from outside, and are not loaded
ENTRIES = ("__main__", "explore")


def load() -> None:
    """Load all modules of the package: forks of this process then load none, and share its memory."""
    for module in pkgutil.walk_packages(extrados.__path__, "extrados."):
        if not any(entry in module.name for entry in ENTRIES):
            importlib.import_module(module.name)
    FUNCTIONS[:] = [f for f in gc.get_objects() if isinstance(f, FunctionType) and f.__code__.co_filename.startswith(ROOT)]
    CACHES[:] = caches()
    gc.collect()
    gc.freeze()  # the garbage collector does not write to frozen objects, so forks share their memory


def caches() -> list[Any]:
    """Functions of the package that cache their results."""
    return [kept for kept in gc.get_objects() if isinstance(kept, _lru_cache_wrapper) and kept.__module__.startswith("extrados")]


def swap(path: str) -> None:
    """Put another build of the core into all modules that call it."""
    name = "extrados._core"
    spec = importlib.util.spec_from_file_location(name, path, loader=importlib.machinery.ExtensionFileLoader(name, path))
    assert spec is not None and spec.loader is not None
    old, new = sys.modules[name], importlib.util.module_from_spec(spec)
    spec.loader.exec_module(new)
    assert new is not old and new.__file__ == path
    sys.modules[name] = new
    assert new.api_support.init_libraries() == 0
    for caller in [module for key, module in sys.modules.items() if key.startswith("extrados")]:
        for key, value in list(vars(caller).items()):
            assert getattr(value, "__module__", None) != name, f"{caller.__name__}.{key} is of the old core"
            if value is old:
                setattr(caller, key, new)


def plant(file: str, line: int, new: str) -> None:
    """Put another line into the functions of a file of the package."""
    path = Path(ROOT) / file
    lines = path.read_text(encoding="utf-8").split("\n")
    lines[line - 1] = new
    made: dict[tuple[str, int], CodeType] = {}

    def note(code: CodeType) -> None:
        made[code.co_qualname, code.co_firstlineno] = code
        for inner in code.co_consts:
            if isinstance(inner, CodeType):
                note(inner)

    note(compile("\n".join(lines), str(path), "exec"))
    found = [f for f in FUNCTIONS if f.__code__.co_filename == str(path)]
    assert found, f"{file} has no function"
    for function in found:
        function.__code__ = made[function.__code__.co_qualname, function.__code__.co_firstlineno]


def tried(asked: dict[str, Any], items: dict[str, pytest.Item]) -> int:
    """Run tests with a fault, until one fails, whose name is written to a file: 1; 0 where none does."""
    if asked["core"]:
        swap(asked["core"])
    elif asked["new"]:
        plant(asked["file"], asked["line"], asked["new"])
    os.environ["EXTRADOS_TOUCHED"] = asked["kept"]
    resource.setrlimit(resource.RLIMIT_CPU, (asked["limit"], asked["limit"]))
    for name, (PATIENCE[name], trials.SHARE) in asked["tests"].items():
        if any(report.failed for report in runtestprotocol(items[name], log=False)):
            Path(asked["failed"]).write_text(name, encoding="utf-8")
            return 1
    return 0


def pytest_runtestloop(session: pytest.Session) -> bool | None:
    """With EXTRADOS_FAULTS: tests named by standard input are run in forks of this process, each with its fault; how each ended is printed."""
    if "EXTRADOS_FAULTS" not in os.environ:
        return None
    items = {item.nodeid: item for item in session.items}
    load()
    for text in sys.stdin:
        sys.stdout.flush()
        child = os.fork()
        if not child:
            try:
                os._exit(tried(json.loads(text), items))
            finally:
                os._exit(2)
        print(f"\nended: {os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])}", flush=True)
    return True


def answer_of(result: Result) -> bytes:
    """All that a result holds, but how long it took and where its files lie."""
    held = json.dumps(
        [result.status, result.reason, result.answer, result.warnings, result.results.as_json(), repr(result.verdict)], default=str
    )
    held = re.sub(r'"[^"]*seconds[^"]*": [^,}]*|/tmp/[^\s"]*', "", held)
    arrays = [np.asarray(a.data).tobytes() for _, a in sorted(result.arrays.items())]
    columns = [repr(np.asarray(c).tolist()) for _, t in sorted(result.tables.items()) for c in t.columns.values()]
    return b"".join([held.encode(), *arrays, "".join(columns).encode()])


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item: pytest.Item, call: pytest.CallInfo) -> Generator[None, pytest.TestReport, pytest.TestReport]:
    """Keeps whether a test itself has passed."""
    report = yield
    if call.when == "call":
        item.stash[PASSED] = report.passed
    return report


@pytest.fixture(autouse=True)
def _noted(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Where EXTRADOS_TOUCHED names a file, notes of a test that passes there: the text of its chapter, seconds of a processor, a digest of all
    answers, and with EXTRADOS_LINES the lines that it runs through."""
    place = os.environ.get("EXTRADOS_TOUCHED")
    if not place:
        yield
        return
    asking._KEPT.clear()  # what was answered in another test runs through no line
    for kept in CACHES or caches():
        kept.cache_clear()
    digest, lines, plain = hashlib.sha256(), set(), extrados.run

    def run(*args: Any, **keys: Any) -> Any:
        made = plain(*args, **keys)
        for result in made.results:
            digest.update(answer_of(result))
        return made

    def line(frame: FrameType, event: str, _: Any) -> Any:
        lines.add((frame.f_code, frame.f_lineno))
        return line

    def call(frame: FrameType, event: str, _: Any) -> Any:
        return line(frame, event, _) if frame.f_code.co_filename.startswith(ROOT) else None

    monkeypatch.setattr(extrados, "run", run)
    begin = time.process_time()
    signal.setitimer(signal.ITIMER_PROF, PATIENCE.get(request.node.nodeid, 0.0))
    if "EXTRADOS_LINES" in os.environ:
        sys.settrace(call)
    yield
    sys.settrace(None)
    signal.setitimer(signal.ITIMER_PROF, 0.0)
    if not request.node.stash.get(PASSED, False):
        return
    found = sorted({(os.path.relpath(c.co_filename, ROOT), n) for c, n in lines})
    callspec = getattr(request.node, "callspec", None)
    relation = callspec.params.get("relation") if callspec else None
    chapter = Path(relation.holds.__code__.co_filename if relation else request.node.path)
    row = {
        "test": request.node.nodeid,
        "chapter": chapter.name,
        "source": hashlib.sha256(chapter.read_bytes()).hexdigest(),
        "seconds": time.process_time() - begin,
        "results": digest.hexdigest(),
        "lines": found,
    }
    with open(place, "a", encoding="utf-8") as file:
        file.write(json.dumps(row) + "\n")
