"""Runs in memory and in folders: read alike, written when wanted, safe in their last moment."""

import os
import signal

import numpy as np
import pytest

import extrados
from extrados.analyses.context import Context
from extrados.decks.reader import make_deck
from extrados.results import store, written
from extrados.results.store import StoreError
from extrados.running.run import Run, compute, run_to

DECK = {
    "title": "A small arch",
    "structure": {"kind": "arch", "radius": 1.0, "thickness": 0.2, "embrace": 150.0, "voussoirs": 9},
    "motion": {"kind": "step-pulse", "amplitude": "0.6 g", "duration": 0.1},
    "analysis": [{"kind": "tilt"}, {"kind": "rocking"}, {"kind": "tilt"}],
}
TOML = """
[structure]
kind = "arch"
radius = 1.0
thickness = 0.2
embrace = 150.0
voussoirs = 9
[analysis]
kind = "tilt"
"""


def test_in_memory_nothing_is_written(tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "deck.toml").write_text(TOML)
    run = extrados.run("deck.toml")
    assert run["tilt"]["collapse_acceleration_g"] > 0.0 and run.folder is None
    assert [p.name for p in tmp_path.iterdir()] == ["deck.toml"]


def test_a_run_reads_alike_in_memory_and_from_its_folder(tmp_path) -> None:
    run = extrados.run(DECK)
    run.write(tmp_path / "run", figures=False)
    again = extrados.load(tmp_path / "run")
    assert type(again) is type(run) is Run
    assert again.analyses == run.analyses
    assert [a["name"] for a in run.analyses] == ["tilt", "rocking", "tilt-2"]
    assert {k: v for k, v in again.summary.items() if k != "files"} == run.summary
    for name, arrays in run.arrays.items():
        stored = set(again.arrays[name])
        assert stored == set(arrays)
        for title, array in arrays.items():
            other = again.arrays[name][title]
            assert (other.dims, other.unit, other.about) == (array.dims, array.unit, array.about)
            np.testing.assert_array_equal(other.data, array.data)
    xarray = pytest.importorskip("xarray")
    xarray.testing.assert_equal(again.dataset("rocking"), run.dataset("rocking"))
    with xarray.open_dataset(tmp_path / "run" / "results.h5", group="rocking", engine="h5netcdf") as stored:
        assert set(run.dataset("rocking").coords) == set(stored.coords) >= set(stored.sizes)
    with pytest.raises(KeyError, match="no analysis has the name 'dem'; the names are: tilt, rocking, tilt-2"):
        run["dem"]


def test_write_later_is_the_same_as_out(tmp_path) -> None:
    extrados.run(DECK).write(tmp_path / "later", figures=False)
    extrados.run(DECK, tmp_path / "now")
    names = sorted(str(p.relative_to(tmp_path / "now")) for p in (tmp_path / "now").rglob("*"))
    assert names == sorted(str(p.relative_to(tmp_path / "later")) for p in (tmp_path / "later").rglob("*"))
    for name in names:
        if name not in (store.SUMMARY, written.LIST):  # they tell when it ran
            assert (tmp_path / "now" / name).read_bytes() == (tmp_path / "later" / name).read_bytes(), name


def test_a_run_read_back_can_be_written_elsewhere(tmp_path) -> None:
    extrados.run(DECK, tmp_path / "one")
    copy = extrados.load(tmp_path / "one")
    copy.write(tmp_path / "two", figures=True)
    assert copy.folder == tmp_path / "two" and (tmp_path / "two" / "report.html").exists()
    assert extrados.load(tmp_path / "two").analyses == extrados.load(tmp_path / "one").analyses
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "letter.txt").write_text("mine")
    assert copy.write(tmp_path / "other", figures=False) == copy.folder == tmp_path / "other-2"
    assert extrados.load(tmp_path / "other-2").analyses == copy.analyses


def test_a_folder_that_cannot_be_written_is_refused_before_the_run(tmp_path, monkeypatch) -> None:
    monkeypatch.setattr("extrados.running.run.compute", lambda context: pytest.fail("it ran"))
    (tmp_path / "taken").write_text("x")
    with pytest.raises(StoreError, match="is not a folder"):
        extrados.run(DECK, tmp_path / "taken")


def test_in_memory_there_are_no_batches() -> None:
    context = Context(make_deck(DECK))
    compute(context)
    assert context.out is None and context.checkpoint is None


def test_ctrl_c_while_results_are_written(tmp_path, monkeypatch) -> None:
    write = store.write

    def slow(*args) -> None:
        os.kill(os.getpid(), signal.SIGINT)
        write(*args)

    monkeypatch.setattr(store, "write", slow)
    before = signal.getsignal(signal.SIGINT)
    with pytest.raises(KeyboardInterrupt):
        run_to(Context(make_deck(DECK)), tmp_path / "run")
    assert signal.getsignal(signal.SIGINT) is before
    assert store.read(tmp_path / "run")["tilt"]["collapse_acceleration_g"] > 0.0
    assert not (tmp_path / "run" / "report.html").exists()
