"""A long sweep on a cluster whose driver and workers are killed on the way: the bytes of one that was left alone."""

import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from test_trial_runs import differs

import trials
from extrados.results.checkpoint import folder_of

DECK = """
[structure]
kind = "block"
width = 0.1
height = 0.4
[motion]
kind = "generated"
mmi = 8
duration = 1.0
[[analysis]]
kind = "fragility"
count = {count}
"""
#: Bytes that the driver may take, however many members there are, and by which a worker may grow over the whole sweep
MOST_OF_THE_DRIVER, MOST_OF_A_WORKER = 400_000_000, 100_000_000


def resident(pid: int) -> int:
    """Bytes that a process has in memory; 0 once it is gone."""
    try:
        return int(Path(f"/proc/{pid}/statm").read_text().split()[1]) * os.sysconf("SC_PAGESIZE")
    except OSError:
        return 0


@pytest.mark.verify
@pytest.mark.skipif(sys.platform != "linux", reason="memory is read from /proc")
def test_a_million_members(cluster, tmp_path: Path) -> None:
    """The driver is killed twice, a worker once; memory of the workers and of the driver is flat."""
    trial = trials.Trial("sweep-of-a-million", "members of a sweep on a cluster, killed thrice, that are lost or have other bytes")
    address, processes = cluster
    count = trials.count_of(1_000_000, 5_000)
    deck, out = tmp_path / "deck.toml", tmp_path / "out"
    deck.write_text(DECK.format(count=count))
    words = [sys.executable, "-m", "extrados", "run", str(deck), "--no-figures", "--quiet", "--out"]
    rng = random.Random(12)
    driver, greatest, at_first = 0, 0, 0

    def kept() -> int:
        """How many members the batches that were kept hold."""
        return max((int(p.name.split("-")[0]) for p in folder_of(out).glob("*/*.npz")), default=0)

    for stop in (0.3, 0.6, 2.0):
        resume = ["--resume"] if folder_of(out).exists() else []
        run = subprocess.Popen([*words, str(out), "--scheduler", address, *resume], stderr=subprocess.PIPE, text=True)
        while run.poll() is None:
            done = kept()
            driver = max(driver, resident(run.pid))
            workers = max(resident(p.pid) for p in processes[1:])
            at_first = max(at_first, workers) if done < 0.2 * count else at_first
            greatest = max(greatest, workers)
            if done >= stop * count:
                run.send_signal(signal.SIGKILL)
                run.wait()
            if done >= 0.45 * count and all(p.poll() is None for p in processes):
                rng.choice(processes[1:]).kill()
            time.sleep(0.05)
        if run.returncode not in (0, -signal.SIGKILL):
            trial.fail(f"ended with {run.returncode}: {run.stderr.read()[-500:]}")
        if run.returncode == 0:
            break
    subprocess.run([*words, str(tmp_path / "alone")], check=True)
    trial.tried += count
    if where := differs(tmp_path / "alone", out):
        trial.fail(f"{where} differ from those of a run that was left alone")
    if sum(p.poll() is not None for p in processes) != 1:
        trial.fail("no worker, or more than one, was killed")
    if greatest - at_first > MOST_OF_A_WORKER:
        trial.fail(f"a worker grew from {at_first / 1e6:.0f} to {greatest / 1e6:.0f} MB")
    if driver > MOST_OF_THE_DRIVER:
        trial.fail(f"the driver took {driver / 1e6:.0f} MB")
    trial.notes.append(
        f"driver at most {driver / 1e6:.0f} MB, workers {at_first / 1e6:.0f} MB at first and {greatest / 1e6:.0f} MB at most"
    )
    trial.close(count)
