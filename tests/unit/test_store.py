"""The results folder: whole or not at all."""

import errno
import json
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import h5py
import numpy as np
import pytest

import extrados
from extrados.results import store
from extrados.results.model import Array, Result, TableData
from extrados.results.statistics import RockingSpectrum
from extrados.schema import files
from extrados.show.report import write_report


def sample() -> Result:
    result = Result("rocking-spectrum", answer="words")
    result.results = RockingSpectrum(
        family=["alpha 10 deg"],
        conditions=[],
        overturned=np.array([3]),
        longest_overturning_period_s=[float("nan")],
        size_m=np.arange(3.0),
        peak_ground_acceleration_g=np.float64(0.37),
    )
    result.arrays = {
        "time": Array(np.linspace(0, 1, 5), ("time",), "s"),
        "x": Array(np.random.default_rng(7).normal(size=(5, 3)), ("time", "joint"), "m", "about x"),
        "name": Array(np.array(["a", "b", "c"]), ("joint",)),
    }
    result.files = {"fields/a.vtu": b"x", "tilt.pvd": b"y"}
    result.tables = {"tilt": TableData({"t": np.array([1e-308, 0.1 + 0.2]), "w": ["=1+1", "b"]}, {"t": "s"})}
    return result


HEAD = {"extrados": {"version": "0"}, "deck": {"path": "d", "sha256": "", "title": "", "resolved": {}}}


def test_nothing_is_left_beside_where_the_disk_fails_after_the_exchange(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    out, sync = tmp_path / "run", store._sync
    with store.NewFolder(out) as folder:
        store.write(folder, HEAD, [sample()])
    monkeypatch.setattr(store, "_sync", lambda path: _fail() if path == tmp_path else sync(path))
    with pytest.raises(store.StoreError), store.NewFolder(out) as folder:
        store.write(folder, HEAD, [sample()])
    assert sorted(path.name for path in tmp_path.iterdir()) == ["run"]
    assert store.read(out)["rocking-spectrum"].overturned


@pytest.mark.skipif(sys.platform != "linux", reason="other systems exchange folders in two steps")
def test_results_are_there_at_every_moment_of_their_replacement(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Old or new, whenever the run is killed: no rename takes the folder away before the next one is in its place."""
    out, rename = tmp_path / "run", Path.rename

    def watched(path: Path, to: Path) -> Path:
        made = rename(path, to)
        assert out.is_dir()
        return made

    monkeypatch.setattr(Path, "rename", watched)
    for _ in range(2):
        with store.NewFolder(out) as folder:
            store.write(folder, HEAD, [sample()])


def _fail() -> None:
    raise OSError(errno.EIO, "the disk")


def test_round_trip(tmp_path) -> None:
    out = tmp_path / "run"
    with store.NewFolder(out) as folder:
        store.write(folder, HEAD, [sample(), sample()])
    run = store.read(out)
    assert run["rocking-spectrum"]["peak_ground_acceleration_g"] == run["rocking-spectrum"].peak_ground_acceleration_g == 0.37
    assert run["rocking-spectrum-2"].longest_overturning_period_s == [None]
    assert run["rocking-spectrum-2"].size_m == [0.0, 1.0, 2.0]
    assert np.array_equal(run.array("rocking-spectrum", "x"), sample().arrays["x"].data)
    assert run.arrays["rocking-spectrum"]["x"].dims == ("time", "joint") and run.arrays["rocking-spectrum"]["x"].unit == "m"
    rows = (out / "tilt.csv").read_text().splitlines()
    assert rows[0] == "t [s],w" and rows[1] == "1e-308,'=1+1" and float(rows[2].split(",")[0]) == 0.1 + 0.2
    assert (out / "tilt-2.csv").exists()
    assert (out / "fields" / "a.vtu").exists() and (out / "rocking-spectrum-2" / "fields" / "a.vtu").exists()


def test_opens_in_xarray(tmp_path) -> None:
    xarray = pytest.importorskip("xarray")
    out = tmp_path / "run"
    with store.NewFolder(out) as folder:
        store.write(folder, HEAD, [sample()])
    data = xarray.open_dataset(out / "results.h5", group="rocking-spectrum", engine="h5netcdf", phony_dims="sort")
    assert data["x"].dims == ("time", "joint") and data["x"].attrs["units"] == "m"
    assert store.read(out).dataset("rocking-spectrum")["x"].shape == (5, 3)


def test_old_folder_survives_a_failure(tmp_path) -> None:
    out = tmp_path / "run"
    with store.NewFolder(out) as folder:
        store.write(folder, HEAD, [sample()])
    before = (out / "summary.json").read_bytes()
    with pytest.raises(RuntimeError), store.NewFolder(out):
        raise RuntimeError
    assert (out / "summary.json").read_bytes() == before
    assert [p.name for p in tmp_path.iterdir()] == ["run"]
    with store.NewFolder(out) as folder:
        store.write(folder, HEAD, [sample(), sample()])
    assert len(json.loads((out / "summary.json").read_text())["analyses"]) == 2
    assert [p.name for p in tmp_path.iterdir()] == ["run"]


def put(out: Path) -> Path:
    """Results in a folder; where they came to lie."""
    making = store.NewFolder(out)
    with making as folder:
        store.write(folder, HEAD, [sample()])
    return making.place


def everything(folder: Path) -> dict[str, bytes]:
    return {str(p.relative_to(folder)): p.read_bytes() for p in folder.rglob("*") if p.is_file()}


def test_what_is_no_folder_is_refused(tmp_path) -> None:
    (tmp_path / "file").write_text("x")
    (tmp_path / "link").symlink_to(tmp_path)
    for bad in (tmp_path / "file", tmp_path / "link"):
        with pytest.raises(store.StoreError, match="is not a folder"):
            store.prepare(bad)
        with pytest.raises(store.StoreError, match="is not a folder"):
            put(bad)


#: What a user may do with a results folder between two runs
CHANGES = {
    "a file": lambda run: (run / "notes.txt").write_text("mine"),
    "a file among the figures": lambda run: (run / "figures" / "mine.png").write_text("mine"),
    "a folder": lambda run: (run / "mine").mkdir(),
    "an edited report": lambda run: (run / "report.html").write_text("mine"),
    "an edited table": lambda run: (run / "tilt.csv").write_text("mine"),
    "an edited figure": lambda run: next((run / "figures").iterdir()).write_text("mine"),
    "a link": lambda run: (run / "mine").symlink_to("/etc/hostname"),
    "a link to a folder": lambda run: (run / "mine").symlink_to("/etc"),
    "a file in the place of its list": lambda run: (run / ".written.json").write_text("mine"),
    "a damaged list": lambda run: (run / ".written.json").write_bytes((run / ".written.json").read_bytes()[:100]),
}


@pytest.fixture(scope="module")
def with_figures(tmp_path_factory) -> Path:
    """The folder of a whole run, to be copied."""
    out = tmp_path_factory.mktemp("whole") / "run"
    deck = {"structure": {"kind": "arch", "radius": 1.0, "thickness": 0.2, "embrace": 150.0, "voussoirs": 7}, "analysis": {"kind": "tilt"}}
    extrados.run(deck, out, figures=True)
    return out


@pytest.mark.parametrize("what", CHANGES)
def test_what_a_user_put_or_changed_is_never_lost(what, tmp_path, with_figures, caplog) -> None:
    """The new results are put beside it, which is said."""
    run = tmp_path / "run"
    shutil.copytree(with_figures, run)
    (run / "tilt.csv").exists() or (run / "tilt.csv").write_text("")
    CHANGES[what](run)
    before = everything(run)
    assert put(run) == tmp_path / "run-2" and "The results are in" in caplog.text
    assert everything(run) == before
    assert put(run) == tmp_path / "run-3"


def test_unchanged_results_are_replaced(tmp_path, with_figures) -> None:
    run = tmp_path / "run"
    shutil.copytree(with_figures, run)
    assert put(run) == run and not (run / "report.html").exists()
    assert [p.name for p in tmp_path.iterdir()] == ["run"]


def test_what_is_saved_while_results_are_written_is_kept(tmp_path, with_figures, monkeypatch, caplog) -> None:
    run = tmp_path / "run"
    shutil.copytree(with_figures, run)
    real = store._exchange

    def exchange(scratch: Path, place: Path) -> Path | None:
        (place / "notes.txt").write_text("mine")
        (place / "tilt.png").mkdir()
        return real(scratch, place)

    monkeypatch.setattr(store, "_exchange", exchange)
    assert put(run) == run and "run-2" in caplog.text
    assert (tmp_path / "run-2" / "notes.txt").read_text() == "mine" and store.read(run)


def test_a_report_is_put_beside_one_that_was_edited(tmp_path, with_figures, caplog) -> None:
    run = tmp_path / "run"
    shutil.copytree(with_figures, run)
    edited = min((run / "figures").iterdir())
    for path in (run / "report.html", edited, run / "figures" / "mine.txt"):
        path.write_text("mine")
    before = everything(run)
    assert write_report(run)[0].name == "report-2.html"
    after = everything(run)
    new = {"report-2.html", f"figures/{edited.stem}-2{edited.suffix}"}
    assert new <= set(after) and set(after) - set(before) == new
    for name in ("report.html", f"figures/{edited.name}", "figures/mine.txt"):
        assert after[name] == b"mine"
    (run / "report.html").unlink()
    assert write_report(run)[0].name == "report.html" and (run / "figures" / "mine.txt").exists()


@pytest.mark.parametrize("sort", ["link", "file"])
def test_figures_are_put_beside_what_is_no_folder_of_the_run(sort, tmp_path, with_figures, caplog) -> None:
    run, mine = tmp_path / "run", tmp_path / "mine"
    shutil.copytree(with_figures, run)
    names = sorted(path.name for path in (run / "figures").iterdir())
    if sort == "link":  # to figures that are unchanged: what is behind a link is the user's all the same
        (run / "figures").rename(mine)
        (run / "figures").symlink_to(mine)
    else:
        shutil.rmtree(run / "figures")
        (run / "figures").write_text("mine")
        mine.mkdir()
    before = {path: path.stat().st_mtime_ns for path in mine.iterdir()}
    for _ in range(2):  # and again in the same place
        assert write_report(run)[0].name == "report.html" and "The new file is figures-2/" in caplog.text
        assert sorted(path.name for path in (run / "figures-2").iterdir()) == names
        assert {path: path.stat().st_mtime_ns for path in mine.iterdir()} == before
        assert not (run / "figures-3").exists() and (run / "figures").is_symlink() == (sort == "link")


def test_a_report_killed_while_it_is_put_in_place_leaves_nothing_strange(tmp_path, with_figures, monkeypatch) -> None:
    """The list says beforehand what is coming."""
    run = tmp_path / "run"
    shutil.copytree(with_figures, run)
    for path in (run / "figures").iterdir():
        path.unlink()
    moved, real = [], Path.replace

    def replace(self: Path, target: Path) -> Path:
        if ".drawing-" in str(self):
            moved.append(target)
            if len(moved) == 2:
                raise KeyboardInterrupt
        return real(self, target)

    monkeypatch.setattr(Path, "replace", replace)
    with pytest.raises(KeyboardInterrupt):
        write_report(run)
    monkeypatch.undo()
    assert len(moved) == 2 and put(run) == run


def test_damage_is_seen(tmp_path) -> None:
    out = tmp_path / "run"
    with store.NewFolder(out) as folder:
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


@pytest.mark.parametrize(
    "limit",
    [
        pytest.param(0, marks=pytest.mark.verify),
        1000,
        pytest.param(20_000, marks=pytest.mark.verify),
        pytest.param(100_000, marks=pytest.mark.verify),
    ],
)
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


@pytest.mark.parametrize("sort", ["fill", "compressed", "external", "virtual", "linked"])
def test_arrays_lie_in_the_file_of_results(sort, tmp_path, with_figures) -> None:
    """Small files that stand for gigabytes, and numbers of files elsewhere, whose checksum is as summary.json says."""
    run, strange = tmp_path / "run", tmp_path / "strange.h5"
    shutil.copytree(with_figures, run)
    with h5py.File(strange, "w") as other:
        other["a"] = np.arange(3.0)
        other["a"].attrs["unit"] = "m"
    with h5py.File(run / store.STORE, "a") as file:
        group = next(iter(file.values()))
        if sort == "fill":
            group.create_dataset("a", shape=(10**9,), dtype="f8")
        elif sort == "compressed":
            group.create_dataset("a", data=np.zeros(10**6), compression="gzip")
        elif sort == "external":
            group.create_dataset("a", shape=(3,), dtype="f8", external=[(str(strange), 0, 24)])
        elif sort == "virtual":
            layout = h5py.VirtualLayout(shape=(3,), dtype="f8")
            layout[:] = h5py.VirtualSource(strange, "a", shape=(3,))
            group.create_virtual_dataset("a", layout)
        else:
            group["a"] = h5py.ExternalLink(strange, "a")
        if sort != "linked":
            group["a"].attrs["unit"] = "m"
    summary = json.loads((run / store.SUMMARY).read_text())
    summary["files"][store.STORE] = files.sum_of(store.STORE, run)
    (run / store.SUMMARY).write_text(json.dumps(summary))
    with pytest.raises(store.StoreError, match="the data of 'a' are not complete"):
        store.read(run)


def test_a_summary_of_any_size_is_not_read(tmp_path, with_figures, monkeypatch) -> None:
    monkeypatch.setattr(store, "LARGEST_SUMMARY", 1000)
    with pytest.raises(store.StoreError, match=r"at most 0\.001 MB are read"):
        store.read(with_figures)


@pytest.mark.parametrize(
    ("key", "value", "words"),
    [
        ("kind", ["tilt"], "analyses.0.kind: input should be a valid string"),
        ("name", {"a": 1}, "analyses.0.name: input should be a valid string"),
        ("name", "other", "results.h5: this file contains the array 'tilt', which is not listed in summary.json"),
        ("assumptions", 5, "analyses.0.assumptions: input should be a valid dict"),
        ("assumptions", {"a": {"b": 1}}, "analyses.0.assumptions.a.value: field required"),
        ("answer", None, "analyses.0.answer"),
        ("verdict", {"x": 1}, "analyses.0.verdict.demand: field required"),
        ("warnings", 5, "analyses.0.warnings"),
    ],
)
def test_results_of_another_version_are_reported(key, value, words, tmp_path, with_figures) -> None:
    """What is not as this version writes it is told by its place in the file, before a reader stumbles over it."""
    run = tmp_path / "run"
    shutil.copytree(with_figures, run)
    summary = json.loads((run / store.SUMMARY).read_text())
    summary["analyses"][0][key] = value
    (run / store.SUMMARY).write_text(json.dumps(summary))
    with pytest.raises(store.StoreError, match=re.escape(words)):
        write_report(run)


@pytest.mark.parametrize(
    ("out", "words"),
    [
        (".", "contains the current folder"),
        ("..", "contains the current folder"),
        ("/", "contains the current folder"),
        ("/proc", "mounted file system"),
        ("x" * 248, "more than 200 bytes"),
        ("é" * 101, "more than 200 bytes"),
    ],
)
def test_a_place_for_no_results_is_refused_before_a_long_run(out: str, words: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(store.StoreError, match=words):
        store.prepare(Path(out))
    assert not list(tmp_path.iterdir())


def test_a_name_of_the_longest_kind_can_be_written_twice(tmp_path: Path) -> None:
    out = tmp_path / ("x" * store.LONGEST_NAME)
    for _ in range(2):
        store.prepare(out)
        with store.NewFolder(out) as folder:
            store.write(folder, HEAD, [sample()])
    (out / "mine").touch()
    with store.NewFolder(out) as folder:
        store.write(folder, HEAD, [sample()])
    assert len(list(tmp_path.iterdir())) == 2


@pytest.mark.parametrize("mask", [0o077, 0o022, 0o002])
def test_a_folder_has_the_permissions_that_the_umask_leaves(mask: int, tmp_path: Path) -> None:
    before = os.umask(mask)
    try:
        with store.NewFolder(tmp_path / "run") as folder:
            store.write(folder, HEAD, [sample()])
    finally:
        os.umask(before)
    assert (tmp_path / "run").stat().st_mode & 0o777 == 0o777 & ~mask
    assert (tmp_path / "run" / store.SUMMARY).stat().st_mode & 0o777 == 0o666 & ~mask
