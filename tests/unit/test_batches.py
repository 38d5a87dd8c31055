"""The sweep layer: batches, checkpoints, resuming, interruption."""

import contextlib
import json
import os
import shutil
import signal
import subprocess
import sys
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

from extrados.analyses import batches
from extrados.analyses.batches import sweep
from extrados.analyses.context import Context
from extrados.core import calls
from extrados.decks.reader import make_deck
from extrados.results.checkpoint import Checkpoint, fingerprint, folder_of
from extrados.results.store import StoreError

DECK = {
    "structure": {"kind": "block", "width": 0.1, "height": 0.4},
    "motion": {"kind": "sine-pulse", "amplitude": "1 g", "period": 0.4},
    "analysis": {"kind": "rocking"},
}


@dataclass(frozen=True)
class Squares:
    """Member k gives k squared; stops the process of a user at one member."""

    power: int = 2
    stop_at: int = -1

    def run(self, first: int, count: int, threads: int) -> dict[str, np.ndarray]:
        k = np.arange(first, first + count)
        if first <= self.stop_at < first + count:
            calls._ask()
        return {"value": k**self.power, "text": np.where(k % 2, "odd", "an even one")}


def context(out: Path | None = None, resume: bool = False, **deck) -> Context:
    return Context(make_deck({**DECK, **deck}), out=out, resume=resume)


@pytest.mark.parametrize("count", [1, 31, 32, 33, 1000])
def test_all_members_in_order(count: int) -> None:
    done = []
    c = context()
    c.progress = lambda n, total, text: done.append(n)
    s = sweep(c, "t", Squares(), count, "squares")
    assert s.complete and np.array_equal(s["value"], np.arange(count) ** 2)
    assert list(s["text"][:2]) == ["an even one", "odd"][:count]
    assert done == sorted(done) and done[-1] == count


def test_interrupted_keeps_a_prefix_and_resumes(tmp_path: Path) -> None:
    out = tmp_path / "run"
    s = sweep(context(out), "t", Squares(stop_at=500), 5000, "squares")
    n = len(s.members)
    assert s.interrupted and 500 < n < 5000 and "--resume" in s.stopped
    assert np.array_equal(s["value"], np.arange(n) ** 2)
    calls_made = []

    class Counting(Squares):
        def run(self, first, count, threads):
            calls_made.append(first)
            return super().run(first, count, threads)

    # The name of the class is part of what is computed, so the real resume uses the same one.
    again = sweep(context(out, resume=True), "t", Squares(stop_at=500), 5000, "squares")
    assert again.complete and np.array_equal(again["value"], np.arange(5000) ** 2)
    assert calls_made == []


def test_only_missing_batches_run_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    out = tmp_path / "run"
    sweep(context(out), "t", Squares(), 3000, "squares")
    kept = sorted(folder_of(out).glob("t-*/*.npz"))
    assert len(kept) > 2
    kept[1].write_bytes(b"cut off")
    ran = []
    real = Squares.run
    monkeypatch.setattr(
        Squares, "run", lambda self, first, count, threads: ran.append(first) or real(self, first, count, threads)
    )
    s = sweep(context(out, resume=True), "t", Squares(), 3000, "squares")
    assert s.complete and np.array_equal(s["value"], np.arange(3000) ** 2)
    assert ran and min(ran) == int(kept[1].stem) and max(ran) < int(kept[2].stem)


def test_another_job_takes_nothing(tmp_path: Path) -> None:
    out = tmp_path / "run"
    sweep(context(out), "t", Squares(2), 100, "squares")
    s = sweep(context(out, resume=True), "t", Squares(3), 100, "cubes")
    assert np.array_equal(s["value"], np.arange(100) ** 3)


def test_another_deck_is_refused(tmp_path: Path) -> None:
    out = tmp_path / "run"
    sweep(context(out), "t", Squares(), 100, "squares")
    other = {"structure": {"kind": "block", "width": 0.2, "height": 0.4}}
    with pytest.raises(StoreError, match="another deck"):
        sweep(context(out, resume=True, **other), "t", Squares(), 100, "squares")
    sweep(context(out, resume=False, **other), "t", Squares(), 100, "squares")  # starts anew


def test_a_folder_of_someone_else_is_left_alone(tmp_path: Path) -> None:
    mine = tmp_path / "run.checkpoint"
    mine.mkdir()
    (mine / "thesis.txt").write_text("three years of work")
    with pytest.raises(StoreError, match="was not written by extrados"):
        Checkpoint(tmp_path / "run", "abc", False)
    assert (mine / "thesis.txt").exists()


def test_fingerprint() -> None:
    a = Squares(2)
    assert fingerprint(a) == fingerprint(Squares(2)) != fingerprint(Squares(3))
    assert fingerprint([1.0, np.arange(3)]) != fingerprint([1.0, np.arange(3.0)])
    assert fingerprint({"a": 1, "b": 2}) == fingerprint({"b": 2, "a": 1})


def test_pace_aims_at_a_second() -> None:
    pace = batches._Pace()
    pace.learn(32, 0.01)
    assert pace.size == 8 * 32  # never grows faster, one fast batch may be luck
    pace.learn(256, 2.0)
    assert pace.size == 128


FRAGILITY = """
[structure]
kind = "block"
width = 0.1
height = 0.4
[initial]
rotation_ratio = 0.03125
[motion]
kind = "generated"
mmi = 6
duration = 6.0
seed = 7
[[analysis]]
kind = "fragility"
count = {count}
"""


@pytest.mark.skipif(os.name != "posix", reason="SIGKILL is POSIX")
def test_resume_after_kill_gives_the_same_bytes(tmp_path: Path) -> None:
    deck = tmp_path / "deck.toml"
    deck.write_text(FRAGILITY.format(count=12000))
    command = [
        sys.executable,
        "-m",
        "extrados.cli",
        "run",
        str(deck),
        "--no-figures",
        "--quiet",
        "--threads",
        "1",
        "--out",
    ]
    # The same run, killed by itself as it has kept its third batch
    code = (
        "import os, signal, sys; from extrados.results.checkpoint import Checkpoint; keep, kept = Checkpoint.keep, [];"
        "Checkpoint.keep = lambda *a: (keep(*a), kept.append(a), len(kept) == 3 and os.kill(os.getpid(), signal.SIGKILL));"
        "from extrados.cli import main; main()"
    )
    killed = subprocess.run([sys.executable, "-c", code, *command[3:], str(tmp_path / "a")])
    assert killed.returncode == -signal.SIGKILL
    assert len(list(tmp_path.glob("a.checkpoint/*/*.npz"))) == 3
    assert not (tmp_path / "a" / "summary.json").exists()
    subprocess.run([*command, str(tmp_path / "a"), "--resume"], check=True)
    subprocess.run([*command, str(tmp_path / "b"), "--threads", "2"], check=True)
    for name in ("ensemble.csv", "results.h5"):
        assert (tmp_path / "a" / name).read_bytes() == (tmp_path / "b" / name).read_bytes()
    one, two = (json.loads((tmp_path / f / "summary.json").read_text())["analyses"][0]["results"] for f in "ab")
    assert one == two and not folder_of(tmp_path / "a").exists()
    # Results of this deck are not gone on with under another one.
    deck.write_text(FRAGILITY.format(count=10))
    refused = subprocess.run([*command, str(tmp_path / "a"), "--resume"], capture_output=True, text=True)
    assert refused.returncode == 3 and "another deck" in refused.stderr


@dataclass(frozen=True)
class Roots:
    """Member k gives its square root. The first process that comes to member `deadly` kills itself there."""

    deadly: int = -1
    marker: str = ""

    def run(self, first: int, count: int, threads: int) -> dict[str, np.ndarray]:
        if first <= self.deadly < first + count:
            with contextlib.suppress(FileExistsError):
                Path(self.marker).touch(exist_ok=False)
                os.kill(os.getpid(), signal.SIGKILL)
        time.sleep(0.001 * count)  # the batches stay small, so that many are left when something dies
        return {"value": np.sqrt(np.arange(first, first + count))}


#: Ends the wait for processes that hang [s]; no measure of how long they may take.
PATIENCE = 600


@pytest.fixture
def cluster(tmp_path: Path):
    """A scheduler and two workers on the loopback, as processes of their own."""
    pytest.importorskip("distributed")
    file = tmp_path / "scheduler.json"
    here = str(Path(__file__).parent)
    environment = {**os.environ, "PYTHONPATH": here + os.pathsep + os.environ.get("PYTHONPATH", "")}
    environment["DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES"] = "10"

    def start(*words: str) -> subprocess.Popen:
        return subprocess.Popen(
            [sys.executable, "-m", "distributed.cli." + words[0], *words[1:]], env=environment, cwd=tmp_path,
            stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
        )  # fmt: skip

    processes = [
        start("dask_scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard", "--scheduler-file", str(file))
    ]
    for _ in range(2):
        processes.append(
            start("dask_worker", "--scheduler-file", str(file), "--nthreads", "1", "--no-nanny", "--no-dashboard")
        )
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


def test_cluster_gives_the_same_bytes(cluster, tmp_path: Path) -> None:
    address, _ = cluster
    deck = tmp_path / "deck.toml"
    deck.write_text(FRAGILITY.format(count=600))
    command = [sys.executable, "-m", "extrados.cli", "run", str(deck), "--no-figures", "--quiet"]
    subprocess.run([*command, "--out", str(tmp_path / "a"), "--scheduler", address], check=True)
    subprocess.run([*command, "--out", str(tmp_path / "b")], check=True)
    assert (tmp_path / "a" / "ensemble.csv").read_bytes() == (tmp_path / "b" / "ensemble.csv").read_bytes()
    assert (tmp_path / "a" / "results.h5").read_bytes() == (tmp_path / "b" / "results.h5").read_bytes()


def test_cluster_survives_a_killed_worker(cluster, tmp_path: Path) -> None:
    address, processes = cluster
    c = context(tmp_path / "run")
    c.scheduler = address
    s = sweep(c, "t", Roots(300, str(tmp_path / "died")), 800, "roots")
    assert s.complete and not s.stopped
    assert np.array_equal(s["value"], np.sqrt(np.arange(800)))
    assert (tmp_path / "died").exists()
    assert sorted(process.poll() or 0 for process in processes) == [-signal.SIGKILL, 0, 0]


def test_cluster_scheduler_dies(cluster, tmp_path: Path) -> None:
    address, processes = cluster
    out = tmp_path / "run"
    c = context(out)
    c.scheduler = address
    killed = []

    def progress(done: float, total: float, text: str) -> None:
        if done > 60 and not killed:
            killed.append(done)
            processes[0].kill()

    c.progress = progress
    s = sweep(c, "t", Roots(), 30_000, "roots")
    assert not s.complete and not s.interrupted and "is gone" in s.stopped and "--resume" in s.stopped
    assert len(s.members) >= 60 and np.array_equal(s["value"], np.sqrt(s.members))
    kept = sorted(folder_of(out).glob("t-*/*.npz"))
    assert kept
    shutil.rmtree(folder_of(out))


def test_no_scheduler_answers() -> None:
    pytest.importorskip("distributed")
    from extrados.analyses.context import Refused

    c = context()
    c.scheduler = "tcp://127.0.0.1:9"
    batches_seconds, batches.CONNECT_SECONDS = batches.CONNECT_SECONDS, 1.0
    try:
        with pytest.raises(Refused, match=r"no dask scheduler answers at tcp://127\.0\.0\.1:9"):
            sweep(c, "t", Squares(), 10, "squares")
    finally:
        batches.CONNECT_SECONDS = batches_seconds
