"""Shared by all tests: the folder of further ground motions, which are not part of the project; a cluster."""

import fcntl
import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]

# an editable install builds at its first import what has changed, and tidies its notes of it: one process at a time, of
# all that test this tree, since two at once damage these notes
(ROOT / "build").mkdir(exist_ok=True)
with open(ROOT / "build" / "import.lock", "w") as lock:
    fcntl.flock(lock, fcntl.LOCK_EX)
    import extrados._core  # noqa: F401
from extrados import interrupts  # noqa: E402

if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:  # a shell's background job: tests of Ctrl-C would wait in vain
    signal.signal(signal.SIGINT, signal.default_int_handler)


#: A test of the long suite that has not ended after so long waits for something [s]; others end by `timeout`
LONGEST = 3600


#: Tests of more than half a second of a processor, measured: `make times` writes the list
LONG = ROOT / "tests" / "long.txt"


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Tests of the list of long ones are marked so. Long validation and whole trials come last, trials after validation."""
    whole = float(os.environ.get("EXTRADOS_TRIALS", "0")) > 0.0
    listed = set(LONG.read_text(encoding="utf-8").splitlines())
    for item in items:
        if item.nodeid in listed:
            item.add_marker(pytest.mark.long)

    def rank(item: pytest.Item) -> int:
        is_trial = "trials" in item.path.parts or "properties" in item.path.parts
        return 2 if whole and is_trial else 1 if item.get_closest_marker("verify") else 0

    items.sort(key=rank)
    for item in items:
        if rank(item):
            item.add_marker(pytest.mark.timeout(LONGEST))


def _processor_seconds() -> float:
    """Processor time of this process and of the children that it waited for [s]."""
    used = os.times()
    return used.user + used.system + used.children_user + used.children_system


@pytest.hookimpl(wrapper=True)
def pytest_runtest_protocol(item: pytest.Item) -> Iterator[None]:
    """Keep the processor time of each test where `make times` asks for it: the clock of a busy machine says little."""
    begun = _processor_seconds()
    done = yield
    if folder := os.environ.get("EXTRADOS_TIMES"):
        with open(Path(folder) / f"{os.getpid()}.tsv", "a", encoding="utf-8") as file:
            file.write(f"{_processor_seconds() - begun:.3f}\t{item.nodeid!r}\n")
    return done


@pytest.fixture(autouse=True)
def _no_signal_of_before() -> Iterator[None]:
    """A signal that a test made up is none of the next one's."""
    yield
    interrupts.asked.clear()


@pytest.fixture(scope="session")
def records() -> Path:
    """Real records that cannot be shipped; tests that need them skip where the folder is missing."""
    folder = Path(os.environ.get("EXTRADOS_RECORDS", ROOT.parent / "shared" / "records"))
    if not folder.is_dir():
        pytest.skip("the folder of further records is not here (EXTRADOS_RECORDS)")
    return folder


#: Ends the wait for processes that hang [s]; no measure of how long they may take.
PATIENCE = 600


@pytest.fixture
def cluster(tmp_path: Path) -> Iterator[tuple[str, list[subprocess.Popen]]]:
    """A scheduler and two workers on the loopback, as processes of their own."""
    pytest.importorskip("distributed")
    file = tmp_path / "scheduler.json"
    here = str(Path(__file__).parent / "unit")
    environment = {**os.environ, "PYTHONPATH": here + os.pathsep + os.environ.get("PYTHONPATH", "")}
    environment["DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES"] = "10"
    for what in ("CONNECT", "TCP"):  # on a busy machine a worker would give up after half a minute
        environment[f"DASK_DISTRIBUTED__COMM__TIMEOUTS__{what}"] = f"{PATIENCE}s"

    def start(*words: str) -> subprocess.Popen:
        return subprocess.Popen(
            [sys.executable, "-m", "distributed.cli." + words[0], *words[1:]],
            env=environment,
            cwd=tmp_path,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )

    processes = [start("dask_scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard", "--scheduler-file", str(file))]
    for _ in range(2):
        processes.append(start("dask_worker", "--scheduler-file", str(file), "--nthreads", "1", "--no-nanny", "--no-dashboard"))
    while not file.exists() or not file.read_text().strip():
        assert processes[0].poll() is None, "the scheduler did not start"
        time.sleep(0.1)
    address = json.loads(file.read_text())["address"]
    from distributed import Client

    with Client(address, timeout=PATIENCE) as client:
        client.wait_for_workers(2, timeout=PATIENCE)
    yield address, processes
    for process in processes:
        process.kill()
        process.wait()
