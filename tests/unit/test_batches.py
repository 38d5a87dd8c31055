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
from extrados.analyses.batches import Chain, sweep
from extrados.analyses.context import Context
from extrados.core import calls
from extrados.decks.reader import make_deck
from extrados.results import checkpoint
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
    begins = [int(path.stem.split("-")[0]) for path in kept]
    ran = []
    real = Squares.run
    monkeypatch.setattr(Squares, "run", lambda self, first, count, threads: ran.append(first) or real(self, first, count, threads))
    s = sweep(context(out, resume=True), "t", Squares(), 3000, "squares")
    assert s.complete and np.array_equal(s["value"], np.arange(3000) ** 2)
    assert ran and min(ran) == begins[1] and max(ran) < begins[2]


@pytest.mark.parametrize("at", [0, 10, 40, 200, -200, -30, -1])
def test_a_damaged_batch_is_reported_and_computed_again(tmp_path: Path, at: int) -> None:
    """Wherever a bit flipped: neither taken nor in the way."""
    out = tmp_path / "run"
    sweep(context(out), "t", Squares(), 3000, "squares")
    path = sorted(folder_of(out).glob("t-*/*.npz"))[1]
    content = bytearray(path.read_bytes())
    content[at] ^= 4
    path.write_bytes(bytes(content))
    again = context(out, resume=True)
    s = sweep(again, "t", Squares(), 3000, "squares")
    assert s.complete and np.array_equal(s["value"], np.arange(3000) ** 2)
    assert len(again.warnings) == 1 and "damaged" in again.warnings[0] and path.stem in again.warnings[0]


@pytest.mark.parametrize("threads", [1, 3])
def test_slow_members_run_side_by_side(tmp_path: Path, threads: int) -> None:
    out = tmp_path / "run"
    c = context(out)
    c.threads = threads
    n = 20_000
    s = sweep(c, "t", Squares(stop_at=20), n, "squares", slow=True, parallel=True)
    assert s.interrupted and 20 < len(s.members) < n and np.array_equal(s["value"], s.members**2)
    again = context(out, resume=True)
    again.threads = threads
    rest = sweep(again, "t", Squares(stop_at=20), n, "squares", slow=True, parallel=True)
    assert rest.complete and np.array_equal(rest["value"], np.arange(n) ** 2)


def test_a_failing_member_stops_the_sweep() -> None:
    @dataclass(frozen=True)
    class Fails(Squares):
        def run(self, first, count, threads):
            raise RuntimeError(f"member {first}")

    with pytest.raises(RuntimeError, match="member"):
        sweep(context(), "t", Fails(), 10, "squares", slow=True, parallel=True)


def test_a_chain_goes_on_from_its_newest_state(tmp_path: Path) -> None:
    out = tmp_path / "run"
    chain = Chain(context(out), "c", Squares())
    for step in (1, 2, 3):
        chain.keep(step, {"x": np.array([step])})
    kept = sorted(folder_of(out).glob("c-*/*.npz"))
    assert len(kept) == 2
    assert Chain(context(out, resume=True), "c", Squares()).state[0] == 3
    kept[-1].write_bytes(kept[-1].read_bytes()[:-3])
    again = context(out, resume=True)
    step, state = Chain(again, "c", Squares()).state
    assert step == 2 and state["x"] == 2 and "damaged" in again.warnings[0]
    assert Chain(context(out, resume=True), "c", Squares(3)).state is None
    assert Chain(context(), "c", Squares()).state is None


def test_a_copied_batch_counts_for_no_other_place(tmp_path: Path) -> None:
    """Neither for other members of its sweep nor for those of another one."""
    out = tmp_path / "run"
    n = 200
    sweep(context(out), "t", Squares(), n, "squares")
    first, *_, last = sorted(folder_of(out).glob("t-*/*.npz"))
    digest = first.stem.partition("-")[2]
    last.unlink()
    shutil.copy(first, last.with_name(f"{last.stem.partition('-')[0]}-{digest}.npz"))
    again = context(out, resume=True)
    s = sweep(again, "t", Squares(), n, "squares")
    assert np.array_equal(s["value"], np.arange(n) ** 2) and "calculated again" in again.warnings[0]
    sweep(context(out, resume=True), "t", Squares(3), n, "cubes")
    (cubes,) = (f for f in folder_of(out).glob("t-*") if f != first.parent)
    for path in cubes.iterdir():
        path.unlink()
    shutil.copy(first, cubes)
    again = context(out, resume=True)
    assert np.array_equal(sweep(again, "t", Squares(3), n, "cubes")["value"], np.arange(n) ** 3)
    assert len(again.warnings) == 1


def test_batches_of_two_runs_at_a_time_do_not_count_twice(tmp_path: Path) -> None:
    """Two runs that go on from one checkpoint cut their members into other batches."""
    out = tmp_path / "run"
    n = 100
    sweep(context(out), "t", Squares(), n, "squares")
    (folder,) = folder_of(out).glob("t-*")
    keeper = context(out, resume=True).checkpoint
    for first, end in ((1, 4), (16, 90), (90, 120)):
        keeper.keep(folder.name, first, {"value": np.arange(first, end) ** 2})
    again = context(out, resume=True)
    s = sweep(again, "t", Squares(), n, "squares")
    assert np.array_equal(s.members, np.arange(n)) and np.array_equal(s["value"], np.arange(n) ** 2)
    assert again.warnings and all("overlaps" in w for w in again.warnings)


def test_another_version_resumes_nothing(tmp_path: Path, monkeypatch) -> None:
    out = tmp_path / "run"
    sweep(context(out), "t", Squares(), 10, "squares")
    monkeypatch.setattr(checkpoint, "program", lambda: "9.9.9 another")
    with pytest.raises(StoreError, match=r"begun by extrados .*, and the present version is 9\.9\.9 another"):
        sweep(context(out, resume=True), "t", Squares(), 10, "squares")


def test_files_of_a_user_among_the_batches_stay(tmp_path: Path, caplog) -> None:
    """When the run has finished, and when it begins anew; so does a batch that was changed."""
    out = tmp_path / "run"
    sweep(context(out), "t", Squares(), 200, "squares")
    changed, *_ = sorted(folder_of(out).glob("t-*/*.npz"))
    changed.write_bytes(b"mine")
    mine = [folder_of(out) / "notes.txt", changed.parent / "mine.npz", changed]
    for path in mine[:2]:
        path.write_bytes(b"mine")
    context(out, resume=False).checkpoint  # noqa: B018
    checkpoint.discard(out)
    assert all(path.read_bytes() == b"mine" for path in mine) and "did not write" in caplog.text
    assert {p for p in folder_of(out).rglob("*") if p.is_file()} == set(mine)


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


def test_resume_after_kill_gives_the_same_bytes(tmp_path: Path) -> None:
    deck = tmp_path / "deck.toml"
    deck.write_text(FRAGILITY.format(count=12000))
    command = [sys.executable, "-m", "extrados.cli", "run", str(deck), "--no-figures", "--quiet", "--threads", "1", "--out"]
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


def test_cluster_gives_the_same_bytes_and_survives(cluster, tmp_path: Path) -> None:
    """On one cluster: a deck, a worker that is killed, and at last a scheduler that dies."""
    address, processes = cluster
    deck = tmp_path / "deck.toml"
    deck.write_text(FRAGILITY.format(count=600))
    command = [sys.executable, "-m", "extrados.cli", "run", str(deck), "--no-figures", "--quiet"]
    subprocess.run([*command, "--out", str(tmp_path / "a"), "--scheduler", address], check=True)
    subprocess.run([*command, "--out", str(tmp_path / "b")], check=True)
    assert (tmp_path / "a" / "ensemble.csv").read_bytes() == (tmp_path / "b" / "ensemble.csv").read_bytes()
    assert (tmp_path / "a" / "results.h5").read_bytes() == (tmp_path / "b" / "results.h5").read_bytes()

    c = context(tmp_path / "run")
    c.scheduler = address
    s = sweep(c, "t", Roots(300, str(tmp_path / "died")), 800, "roots")
    assert s.complete and not s.stopped
    assert np.array_equal(s["value"], np.sqrt(np.arange(800)))
    assert (tmp_path / "died").exists()
    assert sorted(process.poll() or 0 for process in processes) == [-signal.SIGKILL, 0, 0]

    out = tmp_path / "last"
    c = context(out)
    c.scheduler = address
    killed = []

    def progress(done: float, total: float, text: str) -> None:
        if done > 60 and not killed:
            killed.append(done)
            processes[0].kill()

    c.progress = progress
    s = sweep(c, "t", Roots(), 30_000, "roots")
    assert not s.complete and not s.interrupted and "does not respond any more" in s.stopped and "--resume" in s.stopped
    assert len(s.members) >= 60 and np.array_equal(s["value"], np.sqrt(s.members))
    kept = sorted(folder_of(out).glob("t-*/*.npz"))
    assert kept
    shutil.rmtree(folder_of(out))


def test_a_scheduler_that_says_no_goodbye_costs_no_rows(monkeypatch: pytest.MonkeyPatch) -> None:
    """On a busy machine the client is not closed in time; all rows are here by then."""
    distributed = pytest.importorskip("distributed")

    class Done:
        status = "finished"

        def __init__(self, value):
            self.value = value

        def done(self) -> bool:
            return True

        def result(self):
            return self.value

    class Slow:
        status = "running"

        def __init__(self, *words, **keys):
            pass

        def nthreads(self) -> dict[str, int]:
            return {"one": 1}

        def submit(self, function, *words, **keys) -> Done:
            return Done(function(*words))

        def close(self, timeout: float) -> None:
            raise TimeoutError(f"no answer within {timeout} s")

    monkeypatch.setattr(distributed, "Client", Slow)
    c = context()
    c.scheduler = "tcp://127.0.0.1:9"
    s = sweep(c, "t", Squares(), 100, "squares")
    assert s.complete and np.array_equal(s["value"], np.arange(100) ** 2)


def test_no_scheduler_answers() -> None:
    pytest.importorskip("distributed")
    from extrados.analyses.context import Refused

    c = context()
    c.scheduler = "tcp://127.0.0.1:9"
    batches_seconds, batches.CONNECT_SECONDS = batches.CONNECT_SECONDS, 1.0
    try:
        with pytest.raises(Refused, match=r"no dask scheduler responds at tcp://127\.0\.0\.1:9"):
            sweep(c, "t", Squares(), 10, "squares")
    finally:
        batches.CONNECT_SECONDS = batches_seconds


def test_a_file_of_ones_own_among_kept_batches_keeps_its_name(tmp_path) -> None:
    from extrados.results.checkpoint import Checkpoint

    kept = Checkpoint(tmp_path / "o", "deck", resume=False)
    kept.keep("sweep", 0, {"x": np.zeros(3)})
    (kept.folder / "sweep" / "mine.npz").write_text("mine")
    warnings: list[str] = []
    assert [first for first, _ in kept.load("sweep", warnings)] == [0] and not warnings
    assert (kept.folder / "sweep" / "mine.npz").read_text() == "mine"
