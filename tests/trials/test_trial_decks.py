"""Mutated decks: each is checked or complained of, never a traceback; run, each ends with an answer or a reason."""

import json
import os
import random
import subprocess
import sys
from pathlib import Path

import mutation

import trials
from extrados import kinds
from extrados.decks.explain import starter
from extrados.decks.reader import DeckError, read_text
from extrados.schema.text import printable

SEED = 20261122


def sources() -> list[str]:
    """Every deck of cases/ and every starter."""
    paths = sorted(p for p in (trials.ROOT / "cases").rglob("*.toml") if not p.name.endswith(".expect.toml"))
    texts = [path.read_text(encoding="utf-8") for path in paths]
    return [t for t in texts if len(t) < 4000] + [starter(kind) for there in kinds.TABLES.values() for kind in there]


def _bare(deck: str) -> str:
    """A deck without its comments."""
    return "\n".join(line.split("  #")[0] for line in deck.split("\n") if line and not line.startswith("#"))


def test_mutated_decks_are_read_or_complained_of() -> None:
    """Each gives a deck, or complaints that name the file and are fit for a terminal."""
    trial = trials.Trial("decks-checked", "mutated decks that end otherwise than read or complained of")
    decks, rng = sources(), random.Random(SEED)
    valid = 0
    for _ in range(least := trials.count_of(100_000, 300)):
        raw = mutation.hostile(rng.choice(decks), rng)
        trial.tried += 1
        try:
            with trials.patience(30):
                read_text(raw, "deck.toml", Path("/nowhere"))
            valid += 1
        except DeckError as error:
            if not error.complaints or not all(c.startswith("deck.toml:") and printable(c) == c for c in error.complaints):
                trial.fail(f"{error.complaints!r:.300}: {raw!r:.3000}")
        except (Exception, trials.TooLong) as error:
            trial.fail(f"{type(error).__name__}: {error!s:.300}: {raw!r:.3000}")
    trial.notes.append(f"{valid} were still valid")
    trial.close(least)


def test_mutated_decks_are_run() -> None:
    """Every starter with other values, run by workers: an answer, a refusal or a failure that is told, no death."""
    trial = trials.Trial("decks-run", "decks with changed values whose run ends in a signal, a traceback or silence")
    decks, rng = [_bare(starter(kind)) for there in kinds.TABLES.values() for kind in there], random.Random(SEED + 1)
    least = trials.count_of(2_000, 12)
    todo = [mutation.plausible(rng.choice(decks), rng) for _ in range(least)]
    statuses: dict[str, int] = {}
    while todo:
        worker = subprocess.run(
            [sys.executable, str(Path(__file__).with_name("deck_worker.py"))],
            input=json.dumps(todo),
            capture_output=True,
            text=True,
            env={**os.environ, "OMP_NUM_THREADS": "2"},
        )
        rows = [json.loads(line) for line in worker.stdout.splitlines() if line.startswith("[")]
        for deck, (status, reason) in zip(todo, rows, strict=False):
            trial.tried += 1
            statuses[status] = statuses.get(status, 0) + 1
            if status not in ("ok", "refused", "failed", "interrupted", "complained"):
                trial.fail(f"{status}: {reason}: {deck}")
        todo = todo[len(rows) :]
        if todo:  # the worker died over the next one
            trial.tried += 1
            trial.fail(f"the process ended with {worker.returncode}: {worker.stderr[-500:]}: {todo.pop(0)}")
    trial.notes.append(", ".join(f"{n} {status}" for status, n in sorted(statuses.items())))
    trial.close(least)
