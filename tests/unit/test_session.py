"""A whole run: what is written survives Ctrl-C in its last moment."""

import os
import signal

import pytest

from extrados.analyses.context import Context
from extrados.decks.reader import make_deck
from extrados.results import store
from extrados.session import run_deck

DECK = {
    "structure": {"kind": "arch", "radius": 1.0, "thickness": 0.2, "embrace": 150.0, "voussoirs": 9},
    "analysis": {"kind": "tilt"},
}


@pytest.mark.skipif(os.name != "posix", reason="signals are POSIX")
def test_ctrl_c_while_results_are_written(tmp_path, monkeypatch) -> None:
    write = store.write

    def slow(*args) -> None:
        os.kill(os.getpid(), signal.SIGINT)
        write(*args)

    monkeypatch.setattr(store, "write", slow)
    before = signal.getsignal(signal.SIGINT)
    with pytest.raises(KeyboardInterrupt):
        run_deck(Context(make_deck(DECK)), tmp_path / "run")
    assert signal.getsignal(signal.SIGINT) is before
    assert store.read(tmp_path / "run")["tilt"]["collapse_acceleration_g"] > 0.0
    assert not (tmp_path / "run" / "report.html").exists()
