"""Memory that runs out: an error in words, no signal, no hanging."""

import json
import os
import re
import signal
import subprocess
import sys

import pytest

import trials
from extrados import kinds

#: Where no more than this is left, Python may find no room to tell the end of an analysis either [MB]
TOLD_ABOVE = 4
#: How reasons begin; those of the core say first what was being computed
LACKING = re.compile(r"not enough memory|[^:]*: not enough memory$")
#: Lets the process grow by so many MB after the core was loaded, then runs starters
LIMITED = """
import json, resource, sys
from pathlib import Path
import extrados.core.sla
from extrados.analyses.context import Context
from extrados.decks.explain import starter
from extrados.decks.reader import read_text
from extrados.running.run import compute
kind, room = sys.argv[1], int(sys.argv[2])
deck = read_text(starter(kind).encode(), "deck.toml", Path("/nowhere"))
used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
resource.setrlimit(resource.RLIMIT_AS, (used + room * 2**20, resource.getrlimit(resource.RLIMIT_AS)[1]))
try:
    told = [(row["status"], row["reason"]) for row in compute(Context(deck, threads=2)).analyses]
except MemoryError:
    told = [("escaped", "")]
resource.setrlimit(resource.RLIMIT_AS, (resource.getrlimit(resource.RLIMIT_AS)[1],) * 2)
print(json.dumps(told))
"""


@pytest.mark.skipif(sys.platform != "linux", reason="the size of a process is read from /proc")
def test_memory_that_is_lowered_after_the_start() -> None:
    """Every size from none to plenty: OpenBLAS would wait for ever, or crash, where its buffer finds no room, and OpenMP
    would end the process where a thread finds none. One thread of OpenBLAS, as the command has it."""
    trial = trials.Trial(
        "memory-lowered", "runs with lowered memory that end in a signal, hang, or neither answer nor say that memory lacked"
    )
    tried = tuple(kinds.ANALYSES) if trials.SHARE > 0.0 else ("sla", "dem")
    rooms = (0, 4, 16, 64, 128, 200, 260, 280, 320, 400) if trials.SHARE > 0.0 else (64, 280)
    environment = {**os.environ, "OPENBLAS_NUM_THREADS": "1"}
    ends: dict[str, int] = {}
    aborted = 0
    for kind in tried:
        for room in rooms:
            trial.tried += 1
            try:
                run = subprocess.run(
                    [sys.executable, "-c", LIMITED, kind, str(room)], capture_output=True, text=True, timeout=600, env=environment
                )
            except subprocess.TimeoutExpired:
                trial.fail(f"{kind}, {room} MB: hangs")
                continue
            if run.returncode == -signal.SIGABRT and run.stderr.startswith("memory allocation of "):
                aborted += 1  # pydantic's core is Rust, which ends the process where it finds no memory
                continue
            rows = json.loads(run.stdout) if run.returncode == 0 else []
            if rows == [["escaped", ""]] and room <= TOLD_ABOVE:
                continue
            if not rows or not all(status == "ok" or LACKING.match(reason) for status, reason in rows):
                trial.fail(f"{kind}, {room} MB: {run.returncode} {rows} {run.stderr[-300:]}")
            for status, _ in rows:
                ends[status] = ends.get(status, 0) + 1
    trial.notes.append("analyses: " + ", ".join(f"{n} {status}" for status, n in sorted(ends.items())))
    if aborted:
        trial.notes.append(f"{aborted} ended by Rust below pydantic, which no program can catch")
        if trials.SHARE == 0.0:
            trial.fail(f"{aborted} ended by Rust below pydantic, at a size where none did")
    trial.close(len(tried) * len(rooms))
