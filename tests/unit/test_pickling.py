"""Runs can be pickled: what processes of a pool compute comes back to the one that asked."""

import copy
import pickle
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path

import numpy as np
import pytest

import extrados
from extrados.results.model import Streamed, StreamedTable

CASES = Path(__file__).resolve().parents[2] / "cases"
DECK = {
    "structure": {"kind": "arch", "radius": 10.0, "thickness": 1.5, "embrace": 157.5, "voussoirs": 7},
    "analysis": [{"kind": "tilt"}, {"kind": "tilt", "joints": {"friction": 0.3}}],
}


@pytest.mark.parametrize(
    "case", ["rocking/el-centro-block", "rocking/soft-base-elements", "limit/tied-frame", "fragility/cloud", "motion/appendix-c"]
)
def test_a_run_comes_back_from_its_pickle(case: str) -> None:
    run = extrados.run(CASES / f"{case}.toml")
    again = pickle.loads(pickle.dumps(run))
    assert again.summary == run.summary
    for row in run.analyses:
        if row["status"] == "ok":
            assert again[row["name"]] == run[row["name"]]
    for name, arrays in run.arrays.items():
        for title, array in arrays.items():
            np.testing.assert_array_equal(again.arrays[name][title].data, array.data)
    assert copy.deepcopy(run).summary == run.summary


def test_a_pool_of_processes_runs_decks() -> None:
    decks = [DECK | {"structure": DECK["structure"] | {"thickness": t}} for t in (1.2, 1.5)]
    with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as pool:
        runs = list(pool.map(extrados.run, decks, timeout=300))
    thin, thick = (run["tilt"].collapse_acceleration_g for run in runs)
    assert 0.0 < thin < thick
    assert thick == extrados.run(decks[1])["tilt"].collapse_acceleration_g


def test_a_run_that_was_written_comes_back_from_its_pickle(tmp_path: Path) -> None:
    run = extrados.run(DECK, tmp_path / "run")
    for one in (run, extrados.load(tmp_path / "run")):
        assert pickle.loads(pickle.dumps(one)).summary == one.summary


def test_numbers_that_lie_on_disk_are_in_the_pickle() -> None:
    streamed = Streamed(5, np.dtype(float), lambda: iter([np.arange(3.0), np.arange(3.0, 5.0)]))
    np.testing.assert_array_equal(pickle.loads(pickle.dumps(streamed)), np.arange(5.0))
    table = StreamedTable(lambda: iter([{"a": np.arange(2)}, {"a": np.arange(2, 4)}]), {"a": "m"})
    again = pickle.loads(pickle.dumps(table))
    (piece,) = again.pieces()
    np.testing.assert_array_equal(piece["a"], np.arange(4))
    assert again.units == {"a": "m"}
