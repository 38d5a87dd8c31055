"""Threads of discrete elements: as many as gain time, waiting without taking a core, the same bits; the time left."""

import os
import subprocess
import sys
import time

import numpy as np
import pytest

from extrados.analyses.context import default_threads
from extrados.core import dem3
from extrados.core.dem_run import STILL
from extrados.core.ground import as_motion_set
from extrados.model.structures.brickwork import Bond
from extrados.model.structures.wall import make_wall
from extrados.running.progress import in_words
from extrados.views.solids.supports import supports_of

BUSY = "while True: pass"


def wall_run(threads: int) -> dem3.Run:
    """A wall of 65 blocks for some thousand steps."""
    one = make_wall(Bond(0.4, 0.2), 0.2, 1.6, [(3.0, False, [])])
    below = supports_of(one).bodies
    n = len(below)
    middle = np.array([part.vertices.mean(axis=0) for part in below])
    parts = [*one.parts, *below]
    solids = dem3.Solids(
        np.concatenate([one.centroid, middle]),
        np.append(one.mass, np.zeros(n)),
        np.concatenate([one.inertia, np.tile(np.eye(3), (n, 1, 1))]),
        [p.vertices for p in parts],
        [p.faces for p in parts],
        [*one.owner.tolist(), *range(len(one.mass), len(one.mass) + n)],
        [dem3.Law(5e9, 5e9, 0.7, damping=1e-3)],
    )
    options = dem3.Options(0.3, fraction=0.6, residual_limit=1e9, settle_steps=0, threads=threads)
    with dem3.Model(solids, options) as model, as_motion_set([STILL]) as motions:
        return model.run(motions)


@pytest.mark.verify
def test_threads_give_the_same_bits_on_a_busy_machine():
    """While other processes take all cores; the bench of solids measures the time."""
    others = [subprocess.Popen([sys.executable, "-c", BUSY]) for _ in range(2 * (os.cpu_count() or 1))]
    try:
        runs = [wall_run(threads) for threads in (1, 2) * 2]
    finally:
        for other in others:
            other.kill()
            other.wait()
    assert runs[0].steps > 1000
    for name in ("place", "rate", "turn"):
        assert len({getattr(run, name).tobytes() for run in runs}) == 1


@pytest.mark.parametrize(("text", "count"), [("1", 1), (" 1,4", 1), ("100000", None), ("", None), ("all", None), ("0", None)])
def test_default_follows_the_environment(monkeypatch: pytest.MonkeyPatch, text: str, count: int | None):
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    monkeypatch.setenv("OMP_NUM_THREADS", text)
    assert default_threads() == (count or cores)


def test_time_left(monkeypatch: pytest.MonkeyPatch):
    """The first line comes after a second, with the time left at the pace of this part; another part begins anew."""
    from extrados.running.progress import Progress

    class Plain:
        is_terminal = False

    now, said = [0.0], []
    monkeypatch.setattr(time, "monotonic", lambda: now[0])
    progress = Progress(False, Plain, said.append)
    for seconds, done, text in ((0.5, 0.0, "run"), (1.5, 0.01, "run"), (3.0, 0.02, "run"), (7.5, 0.1, "run"), (13.5, 0.5, "other")):
        now[0] = seconds
        progress(done, 1.0, text)
    assert said == ["run: 1 %, about 2 min left", "run: 10 %, about 63 s left", "other: 50 %"]
    assert [in_words(t) for t in (0.2, 89.5, 91.0, 3600.0 * 2.25)] == ["1 s", "90 s", "2 min", "2.2 h"]
