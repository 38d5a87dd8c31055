"""The results folder: whole or not at all."""

import json
import os
import subprocess
import sys

import numpy as np
import pytest

from extrados.results import store
from extrados.results.model import Array, Result, TableData


def sample() -> Result:
    result = Result("tilt", answer="words")
    result.results = {"a_g": np.float64(0.37), "list": np.arange(3), "none": float("nan")}
    result.arrays = {
        "time": Array(np.linspace(0, 1, 5), ("time",), "s"),
        "x": Array(np.random.default_rng(7).normal(size=(5, 3)), ("time", "joint"), "m", "about x"),
        "name": Array(np.array(["a", "b", "c"]), ("joint",)),
    }
    result.files = {"fields/a.vtu": b"x", "tilt.pvd": b"y"}
    result.tables = {"tilt": TableData({"t": np.array([1e-308, 0.1 + 0.2]), "w": ["=1+1", "b"]}, {"t": "s"})}
    return result


HEAD = {"extrados": {"version": "0"}, "deck": {"path": "d", "sha256": "", "title": "", "resolved": {}}}


def test_round_trip(tmp_path) -> None:
    out = tmp_path / "run"
    with store.new_folder(out) as folder:
        store.write(folder, HEAD, [sample(), sample()])
    run = store.read(out)
    assert run["tilt"]["a_g"] == 0.37 and run["tilt"]["none"] is None and run["tilt-2"]["list"] == [0, 1, 2]
    assert np.array_equal(run.array("tilt", "x"), sample().arrays["x"].data)
    assert run.arrays["tilt"]["x"].dims == ("time", "joint") and run.arrays["tilt"]["x"].unit == "m"
    rows = (out / "tilt.csv").read_text().splitlines()
    assert rows[0] == "t [s],w" and rows[1] == "1e-308,'=1+1" and float(rows[2].split(",")[0]) == 0.1 + 0.2
    assert (out / "tilt-2.csv").exists()
    assert (out / "fields" / "a.vtu").exists() and (out / "tilt-2" / "fields" / "a.vtu").exists()


def test_opens_in_xarray(tmp_path) -> None:
    xarray = pytest.importorskip("xarray")
    out = tmp_path / "run"
    with store.new_folder(out) as folder:
        store.write(folder, HEAD, [sample()])
    data = xarray.open_dataset(out / "results.h5", group="tilt", engine="h5netcdf", phony_dims="sort")
    assert data["x"].dims == ("time", "joint") and data["x"].attrs["units"] == "m"
    assert store.read(out).dataset("tilt")["x"].shape == (5, 3)


def test_old_folder_survives_a_failure(tmp_path) -> None:
    out = tmp_path / "run"
    with store.new_folder(out) as folder:
        store.write(folder, HEAD, [sample()])
    before = (out / "summary.json").read_bytes()
    with pytest.raises(RuntimeError), store.new_folder(out):
        raise RuntimeError
    assert (out / "summary.json").read_bytes() == before
    assert [p.name for p in tmp_path.iterdir()] == ["run"]
    with store.new_folder(out) as folder:
        store.write(folder, HEAD, [sample(), sample()])
    assert len(json.loads((out / "summary.json").read_text())["analyses"]) == 2
    assert [p.name for p in tmp_path.iterdir()] == ["run"]


def test_never_replaces_what_is_not_ours(tmp_path) -> None:
    (tmp_path / "home").mkdir()
    (tmp_path / "home" / "thesis.tex").write_text("x")
    (tmp_path / "file").write_text("x")
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "summary.json").write_text('{"mine": 1}')
    with store.new_folder(tmp_path / "run") as folder:
        store.write(folder, HEAD, [sample()])
    (tmp_path / "run" / "figures").mkdir()
    (tmp_path / "run" / "figures" / "tilt.png").write_text("x")
    store.prepare(tmp_path / "run")
    (tmp_path / "run" / "my-notes.txt").write_text("x")
    for bad in (tmp_path / "home", tmp_path / "file", tmp_path / "other", tmp_path / "run"):
        with pytest.raises(store.StoreError):
            store.prepare(bad)
    assert (tmp_path / "home" / "thesis.tex").exists()


def test_damage_is_seen(tmp_path) -> None:
    out = tmp_path / "run"
    with store.new_folder(out) as folder:
        store.write(folder, HEAD, [sample()])
    raw = bytearray((out / "results.h5").read_bytes())
    raw[len(raw) // 2] ^= 1
    (out / "results.h5").write_bytes(raw)
    with pytest.raises(store.StoreError, match="checksum"):
        store.read(out)
    (out / "summary.json").write_text("{")
    with pytest.raises(store.StoreError):
        store.read(out)
    with pytest.raises(store.StoreError, match="no results"):
        store.read(tmp_path)


@pytest.mark.skipif(os.name != "posix", reason="file size limits are POSIX")
@pytest.mark.parametrize("limit", [0, 1000, 20_000, 100_000])
def test_full_disk(tmp_path, limit) -> None:
    """Writes that fail end as one message and exit code 3; nothing half-written stays under the final name."""
    deck = tmp_path / "d.toml"
    deck.write_text(
        '[structure]\nkind = "arch"\nradius = 1.0\nthickness = 0.2\nembrace = 150.0\nvoussoirs = 9\n[analysis]\nkind = "tilt"\n'
    )
    code = (
        "import resource, signal, sys; import extrados._core, matplotlib.pyplot, scipy.stats; signal.signal(signal.SIGXFSZ, signal.SIG_IGN);"
        f"resource.setrlimit(resource.RLIMIT_FSIZE, ({limit}, {limit})); sys.argv = ['extrados', 'run', '{deck}', '--out',"
        f" '{tmp_path / 'out'}']; from extrados.cli import main; main()"
    )
    run = subprocess.run([sys.executable, "-B", "-c", code], capture_output=True, text=True, cwd=tmp_path)
    assert run.returncode == 3, run.stderr
    assert "Traceback" not in run.stderr and str(tmp_path / "out") in run.stderr
    if (tmp_path / "out").exists():  # the results fitted and are whole; only the report did not
        assert store.read(tmp_path / "out")["tilt"] and not (tmp_path / "out" / "report.html").exists()
