"""Attacks on the doors of a command: signals in each phase, odd places for results, full disks, no shared memory, a clock
that jumps, files that unpack to gigabytes, modules planted beside a deck, results that go to another process."""

import base64
import os
import pickle
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import zlib
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import h5py
import numpy as np
import pytest
from test_trial_runs import differs

import trials
from extrados import kinds
from extrados.analyses.context import Context
from extrados.decks.explain import starter
from extrados.decks.reader import read_text
from extrados.model.errors import BadGeometry
from extrados.model.geometry.mesh_files import read_mesh_file
from extrados.results import store
from extrados.results.checkpoint import folder_of
from extrados.running.run import compute
from extrados.schema.files import File

HERE = Path(__file__).parent
WAIT = 900  # ends a command that hangs [s]; no measure of how long it may take
root = pytest.mark.skipif(os.getuid() != 0, reason="mounting a file system needs root")
TILT = '[structure]\nkind = "arch"\nradius = 10.0\nthickness = 1.5\nembrace = 157.5\nvoussoirs = 7\n[analysis]\nkind = "tilt"\n'


def command(*words: str | Path, cwd: Path, before: tuple[str, ...] = (), **more: str) -> subprocess.CompletedProcess[str]:
    """A command of extrados that has ended."""
    return subprocess.run(
        [*before, sys.executable, "-m", "extrados", *map(str, words)],
        cwd=cwd,
        capture_output=True,
        text=True,
        errors="replace",
        timeout=WAIT,
        env={**os.environ, **more},
        stdin=subprocess.DEVNULL,
    )


def state(out: Path) -> str:
    """ "nothing", "whole", or what is wrong with a folder."""
    if not os.path.lexists(out):
        return "nothing"
    try:
        store.read(out)
    except store.StoreError as error:
        return str(error)
    return "whole"


#: A phase, and the function with whose call it begins
PHASES = {
    "reading the deck": "extrados.decks.reader:read_text",
    "reading a drawing": "extrados.schema.contained:_server.answer",
    "making the building": "extrados.views.building:Building.blocks",
    "settling": "extrados.core.dem:Model.run",
    "computing": "extrados.core.calls:long_call",
    "judging": "extrados.analyses.sequence:concluded",
    "writing": "extrados.results.store:write",
    "writing arrays": "extrados.results.store:_write_h5",
    "exchanging folders": "extrados.results.store:_exchange",
    "reading results": "extrados.results.store:read",
    "drawing": "extrados.show.report:draw",
    "drawing the building": "extrados.show.report:draw_building",
    "writing the report": "extrados.show.report:told",
}
SQUARES = "".join(
    f"0\nLWPOLYLINE\n100\nAcDbEntity\n8\n0\n100\nAcDbPolyline\n90\n4\n70\n1\n10\n0\n20\n{k}\n10\n1\n20\n{k}\n10\n1\n20\n{k + 1}\n10\n0\n20\n{k + 1}\n"
    for k in range(3)
)
DRAWING = (
    f"0\nSECTION\n2\nHEADER\n9\n$ACADVER\n1\nAC1015\n9\n$INSUNITS\n70\n6\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n{SQUARES}0\nENDSEC\n0\nEOF\n"
)
PHASED = """[structure]
kind = "blocks"
file = "a.dxf"
[motion]
kind = "generated"
mmi = 8
duration = 1.0
[[analysis]]
kind = "tilt"
[[analysis]]
kind = "dem"
"""


def test_signals_in_each_phase(tmp_path: Path) -> None:
    """The code of the signal, no traceback, whole results or none, no process left."""
    trial = trials.Trial("phases", "phases of a run that end otherwise than they should at a signal")
    (tmp_path / "deck.toml").write_text(PHASED)
    (tmp_path / "a.dxf").write_text(DRAWING)
    phases = list(PHASES) if trials.SHARE > 0.0 else ["reading a drawing", "drawing"]
    reached = 0
    for phase in phases:
        for sent in (signal.SIGINT, signal.SIGTERM):
            trial.tried += 1
            out = tmp_path / "out"
            shutil.rmtree(out, ignore_errors=True)
            words = [sys.executable, str(HERE / "phase_worker.py"), str(int(sent)), PHASES[phase], "run", "deck.toml", "--out", "out"]
            run = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True, timeout=WAIT)
            if run.returncode != 128 + sent or "Traceback" in run.stderr:
                trial.fail(f"{phase}: {sent.name}: ended with {run.returncode}: {run.stderr[-500:]}")
            reached += run.returncode == 128 + sent
            if (found := state(out)) not in ("whole", "nothing"):
                trial.fail(f"{phase}: {sent.name}: {found}")
            left = sorted(p.name for p in tmp_path.iterdir() if p.name not in ("deck.toml", "a.dxf", "out", "out.checkpoint"))
            if left:
                trial.fail(f"{phase}: {sent.name}: {left} is left")
    trial.notes.append(f"{len(phases)} phases, {reached} ended by their signal")
    trial.close(2 * len(phases))


ODD = (
    "/",
    ".",
    "..",
    "./",
    "/dev/null",
    "/dev/full",
    "/dev/stdin",
    "/proc/self/x",
    "/sys/x",
    "a/../b",
    "x" * 200,
    "x" * 248,
    "x" * 300,
    "é" * 120,
    "a\nb",
    "a\tb",
    "\x1b[31m",
    "-x",
    " ",
    "  a",
    "~",
    "$HOME",
    "*",
    "%s%n",
    "{}",
    "CON",
    "deck.toml",
    "deck.toml/x",
    "link",
    "pipe",
    "full/x",
    "/".join(["d" * 200] * 30),
    "a\udcffb",
    "=1+1",
    ".hidden",
    "..x",
)


def test_results_at_odd_places(tmp_path: Path) -> None:
    """Written where it was said, or refused in words; nothing beside it, nothing of another's is lost."""
    trial = trials.Trial("places", "odd places for results that are neither used nor refused in words")
    here = tmp_path / "here"
    for place in ODD if trials.SHARE > 0.0 else (".", "/dev/full", "a\udcffb", "link", "x" * 248):
        shutil.rmtree(here, ignore_errors=True)
        here.mkdir()
        (here / "deck.toml").write_text(TILT)
        (here / "link").symlink_to("nowhere")
        os.mkfifo(here / "pipe")
        before = {p.name for p in here.iterdir()}
        trial.tried += 1
        run = command("run", "deck.toml", "--no-figures", f"--out={place}", cwd=here)
        shown = f"{place[:40]!r}: ended with {run.returncode}: {run.stderr[-300:]}"
        if run.returncode not in (0, 2, 3) or "Traceback" in run.stderr or (run.returncode and not run.stderr.strip()):
            trial.fail(shown)
        if run.returncode == 0 and (found := state(Path(os.path.abspath(here / place)))) != "whole":
            trial.fail(f"{shown}: {found}")
        new = {p.name for p in here.iterdir()} - before
        if not before <= {p.name for p in here.iterdir()} or (run.returncode and new):
            trial.fail(f"{shown}: there are now {sorted(p.name for p in here.iterdir())}")
    trial.close(5)


@contextmanager
def mounted(place: Path, *words: str) -> Iterator[Path]:
    """A file system at a place, as long as the block lasts."""
    place.mkdir(exist_ok=True)
    if (done := subprocess.run(["mount", *words, str(place)], capture_output=True, text=True)).returncode:
        pytest.skip(f"no file system can be mounted here: {done.stderr.strip()}")
    try:
        yield place
    finally:
        subprocess.run(["umount", "-l", str(place)], check=True)


def full(trial: trials.Trial, place: Path, deck: Path, what: str) -> None:
    """A run into a disk that may be too small."""
    trial.tried += 1
    run = command("run", deck, "--out", place / "out", cwd=deck.parent)
    if run.returncode not in (0, 3) or "Traceback" in run.stderr:
        trial.fail(f"{what}: ended with {run.returncode}: {run.stderr[-300:]}")
    if run.returncode == 3 and str(place) not in run.stderr:
        trial.fail(f"{what}: the message does not name the place: {run.stderr[-300:]}")
    if (found := state(place / "out")) not in (("whole",) if run.returncode == 0 else ("whole", "nothing")):
        trial.fail(f"{what}: ended with {run.returncode}, and {found}")
    if left := [p.name for p in place.iterdir() if p.name not in ("out", "lost+found")]:
        trial.fail(f"{what}: {left} is left")


@root
def test_a_full_disk(tmp_path: Path) -> None:
    """Of every size from nothing to plenty: one message, whole results or none."""
    trial = trials.Trial("full-disk", "runs into a full disk that are not told, or leave a part")
    deck = tmp_path / "deck.toml"
    deck.write_text(TILT)
    sizes = (4, 16, 32, 64, 96, 128, 192, 256, 384, 512, 1024, 4096) if trials.SHARE > 0.0 else (4, 96)
    for size in sizes:
        with mounted(tmp_path / "disk", "-t", "tmpfs", "-o", f"size={size}k", "tmpfs") as place:
            full(trial, place, deck, f"tmpfs of {size} kB")
    trial.close(len(sizes))


@root
@pytest.mark.verify
def test_a_full_disk_of_ext4(tmp_path: Path) -> None:
    """Blocks are found late there: by the sync, or not before the file is closed."""
    trial = trials.Trial("full-ext4", "runs into a full ext4 that are not told, or leave a part")
    deck = tmp_path / "deck.toml"
    deck.write_text(TILT)
    for size in (256, 512, 1024, 4096):
        image = tmp_path / "image"
        image.write_bytes(bytes(size * 1024))
        if subprocess.run(["mkfs.ext4", "-q", "-O", "^has_journal", "-m", "0", str(image)], capture_output=True).returncode:
            pytest.skip("no ext4 can be made here")
        with mounted(tmp_path / "disk", "-o", "loop", str(image)) as place:
            full(trial, place, deck, f"ext4 of {size} kB")
    trial.close(4)


SWEEP = """import extrados
if __name__ == "__main__":
    print(len(extrados.sweep("deck.toml", {"structure.thickness": [1.4, 1.5]}, workers=2).rows))
"""


@root
def test_without_shared_memory(tmp_path: Path) -> None:
    """/dev/shm cannot be written to: runs, figures and processes of a sweep go on without it."""
    trial = trials.Trial("no-shared-memory", "commands that need /dev/shm")
    (tmp_path / "deck.toml").write_text(TILT)
    (tmp_path / "sweep.py").write_text(SWEEP)
    hidden = ("unshare", "-m", "sh", "-c", 'mount -t tmpfs -o ro,size=4k none /dev/shm || exit 77; exec "$@"', "sh")
    for name, words in (("run", ["-m", "extrados", "run", "deck.toml", "--out", "out"]), ("sweep", ["sweep.py"])):
        trial.tried += 1
        run = subprocess.run(
            [*hidden, sys.executable, *words], cwd=tmp_path, capture_output=True, text=True, timeout=WAIT, stdin=subprocess.DEVNULL
        )
        if run.returncode == 77:
            pytest.skip(f"/dev/shm cannot be hidden here: {run.stderr.strip()}")
        if run.returncode:
            trial.fail(f"{name}: ended with {run.returncode}: {run.stderr[-500:]}")
    trial.close(2)


def test_clocks_that_jump(tmp_path: Path) -> None:
    """The calendar jumps by days at every look: the same numbers, resumed or not."""
    trial = trials.Trial("clocks", "runs under a clock that jumps that fail or give other bytes")
    shim = tmp_path / "clock.so"
    subprocess.run(["cc", "-shared", "-fPIC", "-O1", "-o", str(shim), str(HERE / "clock.c"), "-ldl"], check=True)
    for kind in kinds.ANALYSES if trials.SHARE > 0.0 else ("failure-domain",):
        (tmp_path / "deck.toml").write_text(starter(kind))
        trial.tried += 1
        for out, more in (("still", {}), ("jumping", {"LD_PRELOAD": str(shim)})):
            run = command("run", "deck.toml", "--no-figures", "--out", out, cwd=tmp_path, **more)
            if run.returncode or "Traceback" in run.stderr:
                trial.fail(f"{kind}, {out}: ended with {run.returncode}: {run.stderr[-300:]}")
        if where := differs(tmp_path / "still", tmp_path / "jumping"):
            trial.fail(f"{kind}: {where} differ")
    trial.close(1)


def _vtu(bytes_of: int) -> bytes:
    block = zlib.compress(bytes(bytes_of), 9)
    head = np.array([1, bytes_of, 0, len(block)], dtype="<u8").tobytes()
    packed = base64.b64encode(head).decode() + base64.b64encode(block).decode()
    return (
        '<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" header_type="UInt64" compressor="vtkZLibDataCompressor">'
        '<UnstructuredGrid><Piece NumberOfPoints="3" NumberOfCells="1"><Points><DataArray type="Float64" Name="Points" '
        f'NumberOfComponents="3" format="binary">{packed}</DataArray></Points></Piece></UnstructuredGrid></VTKFile>'
    ).encode()


def _packed_hdf5(name: str) -> bytes:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "a.h5"
        with h5py.File(path, "w") as file:
            mesh = file.create_group("ENS_MAA").create_group("mesh")
            mesh.create_dataset(name, (10**9,), "f8", chunks=(10**6,), compression="gzip", fillvalue=0.0)
        return path.read_bytes()


#: Files that stand for more than a machine has, by the name that says their format
BOMBS: dict[str, Callable[[], bytes]] = {
    "points.vtu": lambda: _vtu(4 * 10**9),
    "entities.vtu": lambda: (
        b'<!DOCTYPE a [<!ENTITY a "'
        + b"x" * 1000
        + b'">'
        + b"".join(b'<!ENTITY %c "%s">' % (98 + k, b"&%c;" % (97 + k) * 100) for k in range(8))
        + b"]><VTKFile>&i;</VTKFile>"
    ),
    "deep.vtu": lambda: b"<a>" * 1_000_000,
    "packed.med": lambda: _packed_hdf5("COO"),
    "packed.h5m": lambda: _packed_hdf5("tstt"),
    "points.vtk": lambda: b"# vtk DataFile Version 3.0\na\nBINARY\nDATASET UNSTRUCTURED_GRID\nPOINTS 1000000000000 double\n",
    "cells.vtk": lambda: (
        b"# vtk DataFile Version 3.0\na\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 1 double\n0 0 0\nCELLS 99999999999 99999999999\n"
    ),
    "nodes.msh": lambda: b"$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 1000000000000 1 1000000000000\n2 1 0 1000000000000\n",
    "old.msh": lambda: b"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n1000000000000\n1 0 0 0\n$EndNodes\n",
    "points.ply": lambda: (
        b"ply\nformat binary_little_endian 1.0\nelement vertex 1000000000000\nproperty double x\nproperty double y\nproperty double z\nend_header\n"
    ),
    "faces.off": lambda: b"OFF\n1000000000000 1000000000000 0\n",
    "lines.inp": lambda: b"*NODE\n" + b"1, 0, 0\n" * 1_000_000,
    "sets.inp": lambda: (
        b"*NODE\n1, 0, 0\n2, 1, 0\n3, 1, 1\n*ELEMENT, TYPE=CPS3\n1, 1, 2, 3\n*ELSET, ELSET=a, GENERATE\n1, 1000000000000, 1\n"
    ),
    "cells.su2": lambda: b"NDIME= 2\nNELEM= 1000000000000\n",
    "grid.mesh": lambda: b"MeshVersionFormatted 2\nDimension 3\nVertices\n1000000000000\n",
    "card.bdf": lambda: b"BEGIN BULK\n" + b"GRID    1               0.0     0.0     0.0\n" * 300_000,
}


@pytest.mark.parametrize("kind", BOMBS if trials.SHARE > 0.0 else ["points.vtu", "nodes.msh", "sets.inp"])
def test_bombs_of_foreign_formats(kind: str) -> None:
    """Refused within the limits of the reader; this process grows by nothing like what the file stands for."""
    pytest.importorskip("meshio")
    trial = trials.Trial(f"bombs-{kind}", f"bombs such as {kind} that are not refused")
    trial.tried += 1
    before = resident()
    try:
        with trials.patience(WAIT):
            read_mesh_file(File(Path(kind), BOMBS[kind]()))
        if kind not in ("lines.inp", "card.bdf"):  # these are only long
            trial.fail(f"{kind}: was read")
    except BadGeometry as error:
        if kind not in str(error):
            trial.fail(f"{kind}: is not named: {error}")
    except (Exception, trials.TooLong) as error:
        trial.fail(f"{kind}: {type(error).__name__}: {error!s:.200}")
    if (grown := resident() - before) > 1e9:
        trial.fail(f"{kind}: this process grew by {grown / 1e6:.0f} MB")
    trial.close(1)


def resident() -> int:
    """Bytes of this process in memory."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * os.sysconf("SC_PAGESIZE")


def test_planted_modules(tmp_path: Path) -> None:
    """A file for every module that a run loads lies beside the deck, and none of them is run."""
    trial = trials.Trial("planted", "commands that run a module of the folder that they are started in")
    listed = subprocess.run(
        [
            sys.executable,
            "-c",
            "import sys; from extrados.cli import main; sys.argv[1:] = ['explain', 'tilt']\n"
            "try: main()\nexcept SystemExit: pass\nimport matplotlib.pyplot, scipy.stats, h5py, uvicorn, meshio\n"
            "print('MODULES', *sorted({n.partition('.')[0] for n in sys.modules}))",
        ],
        capture_output=True,
        text=True,
        cwd=tmp_path,
        check=True,
    )
    names = [n for n in listed.stdout.rpartition("MODULES")[2].split() if n.isidentifier() and n != "__main__"]
    (tmp_path / "deck.toml").write_text(TILT)
    for name in names:
        (tmp_path / f"{name}.py").write_text(f"open({str(tmp_path / 'ran')!r}, 'a').write(__name__ + ' ')\n")
    script = str(Path(sys.executable).with_name("extrados"))
    commands = ("run deck.toml --out r", "report r", "check deck.toml", "export deck.toml --to compas", "assess . --out all", "schema")
    for words in commands if trials.SHARE > 0.0 else commands[:1]:
        trial.tried += 1
        run = subprocess.run([script, *words.split()], cwd=tmp_path, capture_output=True, text=True, timeout=WAIT)
        ran = (tmp_path / "ran").read_text() if (tmp_path / "ran").exists() else ""
        if run.returncode or ran:
            trial.fail(f"{words}: ended with {run.returncode}, ran {ran}: {run.stderr[-300:]}")
    trial.notes.append(f"{len(names)} names")
    trial.close(1)


def test_runs_go_to_other_processes(tmp_path: Path) -> None:
    """A run of every kind is pickled; another process reads it and finds the same."""
    trial = trials.Trial("pickled", "runs that do not come out of their pickle as they were")
    read = "import pickle, sys, json; run = pickle.load(open(sys.argv[1], 'rb')); print(json.dumps(run.summary, sort_keys=True))"
    for kind in kinds.ANALYSES if trials.SHARE > 0.0 else ("tilt", "fragility"):
        run = compute(Context(read_text(starter(kind).encode(), "deck.toml", tmp_path)))
        (tmp_path / "run").write_bytes(pickle.dumps(run))
        again = pickle.loads((tmp_path / "run").read_bytes())
        other = subprocess.run([sys.executable, "-c", read, str(tmp_path / "run")], capture_output=True, text=True, timeout=WAIT)
        trial.tried += 1
        if again.summary != run.summary or other.returncode or not other.stdout.strip():
            trial.fail(f"{kind}: {other.returncode} {other.stderr[-300:]}")
        for name, arrays in run.arrays.items():
            for title, array in arrays.items():
                if (
                    np.asarray(array.data).tobytes() != np.asarray(again.arrays[name][title].data).tobytes()
                    and np.asarray(array.data).dtype != object
                ):
                    trial.fail(f"{kind}: {name}/{title} differs")
    trial.close(2)


#: Workers killed in one sweep: fewer than the scheduler allows a batch to lose (`cluster` in conftest.py)
KILLED = 8


@pytest.mark.verify
def test_workers_of_a_cluster_are_killed(cluster, tmp_path: Path) -> None:
    """Soon after a batch was kept, again and again, and replaced: the bytes are those of a run that was left alone."""
    trial = trials.Trial("dask-killed", "sweeps whose workers are killed that fail or give other bytes")
    address, processes = cluster
    rng, killed = random.Random(7), 0
    (tmp_path / "deck.toml").write_text(starter("fragility").replace("count = 1000", "count = 20000"))
    alone = command("run", "deck.toml", "--no-figures", "--out", "alone", cwd=tmp_path)
    assert alone.returncode == 0, alone.stderr
    for k in range(least := trials.count_of(10, 1)):
        trial.tried += 1
        out = tmp_path / f"out-{k}"
        words = [sys.executable, "-m", "extrados", "run", "deck.toml", "--no-figures", "--quiet", "--out", out.name, "--scheduler", address]
        run = subprocess.Popen(words, cwd=tmp_path, stderr=subprocess.PIPE, text=True)
        seen, left = 0, KILLED
        while run.poll() is None:
            kept = len(list(folder_of(out).glob("*/*.npz")))
            if kept > seen and left:  # by what was computed, not by the clock: a slow machine starts no worker in time
                time.sleep(rng.uniform(0.0, 0.5))
                place = rng.randrange(1, len(processes))
                arguments = processes[place].args
                processes[place].kill()
                processes[place].wait()
                processes[place] = subprocess.Popen(arguments, cwd=tmp_path, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
                seen, left, killed = kept, left - 1, killed + 1
            time.sleep(0.02)
        assert run.stderr is not None
        if run.returncode or (where := differs(tmp_path / "alone", out)):
            trial.fail(f"{k}: ended with {run.returncode}: {run.stderr.read()[-300:] or where}")
    assert killed, "no worker was killed"
    trial.notes.append(f"{killed} workers killed")
    trial.close(least)
