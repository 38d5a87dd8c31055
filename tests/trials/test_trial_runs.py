"""Runs that are killed, interrupted, cut into threads or share a folder: the results are those of one that was not."""

import os
import random
import signal
import subprocess
import sys
import tempfile
import time
import tomllib
from pathlib import Path

import pytest
from test_resume import BLOCK, DECKS, SURVEY, arrays_of, results_of

import trials
from extrados import kinds
from extrados.analyses.context import Context
from extrados.decks.explain import starter
from extrados.decks.reader import make_deck, read_deck
from extrados.results import store
from extrados.results.checkpoint import folder_of
from extrados.running.run import run_to

#: Longer than the starters, so that there is something to be killed
MORE = {
    "fragility": BLOCK + '[motion]\nkind = "generated"\nmmi = 8\nduration = 5.0\n[[analysis]]\nkind = "fragility"\ncount = 2000\n',
    "failure-domain": BLOCK
    + '[[analysis]]\nkind = "failure-domain"\nmax_amplitude = "1.2 g"\namplitudes = 40\ndurations = [0.2, 0.4, 0.8]\n',
}


def kind_of(deck: str) -> str:
    """The analysis of a deck that has one."""
    (analysis,) = tomllib.loads(deck)["analysis"] if "[[" in deck else [tomllib.loads(deck)["analysis"]]
    return analysis["kind"]


#: The sweeps of the quick tests of resuming, longer ones, and the starter of every kind of analysis that has none of these
ALL = {**DECKS, **MORE}
ALL |= {kind: starter(kind) for kind in kinds.ANALYSES if kind not in {kind_of(deck) for deck in ALL.values()}}


def written(name: str, folder: Path) -> Path:
    folder.mkdir(parents=True)
    (folder / "survey.csv").write_text(SURVEY)
    path = folder / "deck.toml"
    path.write_text(ALL[name])
    return path


def command(deck: Path, out: Path, *more: str) -> list[str]:
    return [sys.executable, "-m", "extrados", "run", str(deck), "--no-figures", "--quiet", "--out", str(out), *more]


def whole(deck: Path, out: Path) -> float:
    """A run from start to end, and the seconds it took."""
    begin = time.monotonic()
    run = subprocess.run(command(deck, out), capture_output=True, text=True)
    assert run.returncode == 0, run.stderr
    return time.monotonic() - begin


def processor(pid: int) -> float:
    """Seconds of the processors that a process has used; what it takes to end is told in them too, for a busy machine."""
    try:
        fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
    except OSError:
        return 0.0
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def differs(one: Path, two: Path) -> str:
    """Where the results of two folders are not the same, bit for bit; "" where they are."""
    if results_of(one) != results_of(two):
        return "results"
    if arrays_of(one) != arrays_of(two):
        return "arrays"
    return next((p.name for p in one.glob("*.csv") if p.read_bytes() != (two / p.name).read_bytes()), "")


@pytest.mark.parametrize("number", [signal.SIGKILL, signal.SIGINT], ids=["killed", "interrupted"])
def test_stopped_at_any_time_and_resumed(tmp_path, number) -> None:
    """Stopped again and again at random times; when it has ended, its bytes are those of a run that was left alone."""
    word = {signal.SIGKILL: "killed", signal.SIGINT: "signalled"}[number]
    trial = trials.Trial(f"runs-{word}", f"runs {word} at a random time that end otherwise than they should, or give other bytes")
    rng = random.Random(int(number))
    least = trials.count_of(200, 1)
    names, seconds, finished, early, waits = list(ALL), {}, 0, 0, []
    for name in names if trials.SHARE >= 0.5 else rng.sample(names, 1):
        deck = written(name, tmp_path / name)
        seconds[name] = whole(deck, tmp_path / name / "whole")
    tries = 0
    while trial.tried < least and tries < 8 * least:
        tries += 1
        name = list(seconds)[tries % len(seconds)]
        deck, out = tmp_path / name / "deck.toml", tmp_path / name / "out"
        resume = ["--resume"] if folder_of(out).exists() else []
        sent = number if number == signal.SIGKILL else rng.choice((signal.SIGINT, signal.SIGTERM))
        with tempfile.TemporaryFile("w+") as told:
            process = subprocess.Popen(command(deck, out, *resume), stderr=told, stdout=subprocess.DEVNULL)
            try:
                process.wait(rng.uniform(0.05, 1.0) * seconds[name])
            except subprocess.TimeoutExpired:
                used = processor(process.pid)
                process.send_signal(sent)
                begin = time.monotonic()
                _, status, usage = os.wait4(process.pid, 0)
                process.returncode = os.waitstatus_to_exitcode(status)
                wait = (time.monotonic() - begin, usage.ru_utime + usage.ru_stime - used)
            else:
                wait = None
            told.seek(0)
            said = told.read()
        if wait:
            # an interpreter that is still starting ends as Python would have it, and no code of ours has run yet
            if sent != signal.SIGKILL and process.returncode in (1, -sent) and "/extrados/" not in said.replace(str(tmp_path), ""):
                early += 1
                continue
            waits.append(wait)
            trial.tried += 1
        right = (0, -sent) if sent == signal.SIGKILL else (0, 128 + sent)
        if "Traceback" in said or process.returncode not in right:
            trial.fail(f"{name}: {signal.Signals(sent).name}: ended with {process.returncode}: {said[-300:]}")
        if process.returncode == 0:
            finished += 1
            if where := differs(tmp_path / name / "whole", out):
                trial.fail(f"{name}: {where} differ from those of a run that was left alone")
    for name in seconds:  # each ends once
        deck, out = tmp_path / name / "deck.toml", tmp_path / name / "out"
        resume = ["--resume"] if folder_of(out).exists() else []
        last = subprocess.run(command(deck, out, *resume), capture_output=True, text=True)
        finished += 1
        if last.returncode or (where := differs(tmp_path / name / "whole", out)):
            trial.fail(f"{name}: resumed: {last.returncode} {last.stderr[-300:] or where}")
        if folder_of(out).exists():
            trial.fail(f"{name}: {folder_of(out).name} is left")
    trial.notes.append(f"{len(seconds)} decks of {len({kind_of(ALL[n]) for n in seconds})} kinds, {finished} runs came to their end")
    if number == signal.SIGINT:
        trial.notes.append(f"{early} more came while Python itself was starting, before the first instruction of ours")
        for what, times in zip(("of the clock", "of the processors"), map(sorted, zip(*waits, strict=True)), strict=True):
            trial.notes.append(f"from the signal to the end {times[len(times) // 2]:.2f} s {what} in the median, {times[-1]:.2f} s at most")
    trial.close(least)


def test_threads_change_no_bit(tmp_path) -> None:
    """Every analysis by 1, 2, 3 and 8 threads."""
    trial = trials.Trial("threads", "analyses whose results depend on the number of threads")
    starters = {place: starter(place) for there in kinds.TABLES.values() for place in there}
    decks = {**ALL, **starters}
    (tmp_path / "survey.csv").write_text(SURVEY)
    for name in decks if trials.SHARE > 0.0 else ("dem", "fragility"):
        outs = []
        for threads in (1, 2, 3, 8) if trials.SHARE > 0.0 else (1, 3):
            outs.append(tmp_path / name / str(threads))
            deck = make_deck(tomllib.loads(decks[name]), tmp_path)
            run_to(Context(deck, threads=threads), outs[-1], figures=False)
            trial.tried += 1
            if where := differs(outs[0], outs[-1]):
                trial.fail(f"{name}: {where} differ between 1 and {threads} threads")
    trial.close(4)


@pytest.mark.verify
def test_two_runs_into_one_folder(tmp_path) -> None:
    """At once, again and again: each ends well, and what lies there is whole and of one of the two."""
    trial = trials.Trial("runs-of-two", "pairs of runs into one folder that fail or leave a folder that is not whole")
    decks = []
    for k, thickness in enumerate((1.5, 1.6)):
        decks.append(tmp_path / f"deck-{k}.toml")
        decks[k].write_text(
            f'[structure]\nkind = "arch"\nradius = 10.0\nthickness = {thickness}\nembrace = 157.5\nvoussoirs = 7\n'
            '[analysis]\nkind = "tilt"\n'
        )
    for _ in range(least := trials.count_of(20, 2)):
        trial.tried += 1
        words = [[w for w in command(deck, tmp_path / "out") if w != "--no-figures"] for deck in decks]
        both = [subprocess.Popen(w, stderr=subprocess.PIPE, text=True) for w in words]
        said = [process.communicate()[1] for process in both]
        if any(process.returncode for process in both):
            trial.fail(f"{[p.returncode for p in both]}: {said}")
        store.read(tmp_path / "out")
        if not (tmp_path / "out" / "report.html").exists():
            trial.fail("no report")
        if left := sorted(p.name for p in tmp_path.iterdir() if p not in decks and p.name != "out"):
            trial.fail(f"left behind: {left}")
            for name in left:
                subprocess.run(["rm", "-rf", str(tmp_path / name)], check=True)
    trial.close(least)


def test_the_decks_of_the_trials_are_sound(tmp_path) -> None:
    for name in ALL:
        read_deck(written(name, tmp_path / name))
