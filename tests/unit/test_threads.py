"""Calls in threads of their own, and signals that come while they end."""

import signal
import threading

import pytest

from extrados import interrupts
from extrados.core import calls
from extrados.core.errors import Cancelled
from extrados.core.threads import Worker


def test_what_a_call_gives_or_raises_comes_back() -> None:
    assert Worker(lambda: 7).result() == 7
    with pytest.raises(ZeroDivisionError):
        Worker(lambda: 1 // 0).result()


def test_a_call_goes_on_beside_who_began_it() -> None:
    let = threading.Event()
    worker = Worker(lambda: let.wait(60))
    assert not worker.over(0.01)
    let.set()
    assert worker.result() and worker.over(0.0)


def test_a_thread_that_the_system_refuses(monkeypatch: pytest.MonkeyPatch) -> None:
    def start(_: threading.Thread) -> None:
        raise RuntimeError("can't start new thread")

    monkeypatch.setattr(threading.Thread, "start", start)
    with pytest.raises(MemoryError, match="not enough memory: can't start new thread"):
        calls.long_call(lambda: 7)


def test_a_signal_that_nothing_looked_at_comes_again() -> None:
    """After the core's last look the answer is whole, and what follows would not know that it should stop."""
    before = len(interrupts.asked)
    with pytest.raises(KeyboardInterrupt):
        calls.long_call(signal.raise_signal, signal.SIGINT)
    assert len(interrupts.asked) == before


def test_a_signal_that_was_looked_at_is_left_to_who_looked() -> None:
    before = len(interrupts.asked)
    with calls.interruptible():
        with calls.interruptible():
            signal.raise_signal(signal.SIGINT)
        assert calls.cancel_requested()
        signal.raise_signal(signal.SIGINT)  # again, of somebody who waits for the end
    del interrupts.asked[before:]


def test_what_begins_after_an_interruption_is_not_interrupted() -> None:
    before = len(interrupts.asked)
    with calls.interruptible():
        signal.raise_signal(signal.SIGINT)
        with pytest.raises(Cancelled):
            calls.stop_if_asked()
    del interrupts.asked[before:]
    assert not calls.cancel_requested()
    calls.stop_if_asked()
