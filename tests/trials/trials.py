"""How trials count: short ones in the quick suite, whole ones in `make verify`, whose numbers the verification book prints.

A trial is a test that tries something many times from a fixed seed and notes how often, and what did not hold.
"""

import contextlib
import json
import os
import signal
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
#: Where the numbers of whole trials are kept for the verification book
NOTES = ROOT / "build" / "trials"
#: Share of the whole count that is tried; `make verify` says 1
SHARE = float(os.environ.get("EXTRADOS_TRIALS", "0"))


def count_of(whole: int, short: int) -> int:
    """How many to try: `short` unless a share of the whole count is asked for."""
    return max(short, round(whole * SHARE))


class Trial:
    """What is tried, how often it was, and what did not hold."""

    def __init__(self, name: str, what: str):
        self.name, self.what = name, what
        self.tried = 0
        self.failures: list[str] = []
        self.notes: list[str] = []

    def fail(self, text: str) -> None:
        """Note what did not hold."""
        self.failures.append(text)

    def close(self, least: int, keep: bool | None = None) -> None:
        """Keep the numbers of a whole trial; AssertionError where something did not hold or too little was tried.

        keep: whether this one is whole, where that is not a question of the share."""
        if SHARE >= 1.0 if keep is None else keep:
            NOTES.mkdir(parents=True, exist_ok=True)
            row = {"what": self.what, "tried": self.tried, "failures": len(self.failures), "notes": self.notes}
            (NOTES / f"{self.name}.json").write_text(json.dumps(row, indent=1), encoding="utf-8")
        shown = "\n".join(self.failures[:20])
        assert not self.failures, f"{len(self.failures)} of {self.tried} {self.what}:\n{shown}"
        assert self.tried >= least, f"only {self.tried} of {least} were tried"


class TooLong(BaseException):
    """A single try took longer than anyone would wait."""


@contextlib.contextmanager
def patience(seconds: int) -> Iterator[None]:
    """Ends a try that hangs; no measure of how long it may take."""

    def stop(*_: object) -> None:
        raise TooLong

    before = signal.signal(signal.SIGALRM, stop)
    signal.alarm(seconds)
    try:
        yield
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)
