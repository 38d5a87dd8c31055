"""Runs the decks given as JSON on stdin one after the other in one process and tells how each ended."""

import json
import signal
import sys
import tempfile
import traceback
import warnings
from pathlib import Path

from extrados.analyses.context import Context
from extrados.core import calls
from extrados.decks.reader import DeckError, read_text
from extrados.running.run import compute

SECONDS = 10  # then it is asked to stop, as by Ctrl-C; one that does not listen within as many again is a failure
GIVEN_UP = 6


def one(text: str, folder: Path) -> tuple[str, str]:
    asked = []

    def ask(*_: object) -> None:
        asked.append(1)
        calls._ask()
        if len(asked) > GIVEN_UP:
            raise TimeoutError("did not stop when asked to")

    signal.signal(signal.SIGALRM, ask)
    signal.setitimer(signal.ITIMER_REAL, SECONDS, SECONDS)
    try:
        run = compute(Context(read_text(text.encode(), "deck.toml", folder), threads=2))
        json.dumps(run.summary, allow_nan=False)
    except DeckError:
        return "complained", ""
    except BaseException as error:
        place = traceback.extract_tb(error.__traceback__)[-1]
        return "traceback", f"{type(error).__name__}: {error} at {place.filename}:{place.lineno}"
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)
    for row in run.analyses:
        if "internal error" in row["reason"] or (row["status"] != "ok" and not row["reason"]):
            return "internal", row["reason"]  # the traceback is in its file
        if row["status"] == "ok" and not row["answer"]:
            return "silent", ""
    return run.analyses[-1]["status"], run.analyses[-1]["reason"]


def main() -> None:
    warnings.simplefilter("ignore")
    with tempfile.TemporaryDirectory() as folder:
        for text in json.load(sys.stdin):
            print(json.dumps(one(text, Path(folder))), flush=True)


if __name__ == "__main__":
    main()
