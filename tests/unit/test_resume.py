"""Runs that are killed or interrupted go on to the same bytes: in every kind of analysis that takes long."""

import json
import signal
import subprocess
import sys
import tomllib
from pathlib import Path

import h5py
import numpy as np
import pytest

from extrados.analyses.context import Context
from extrados.analyses.dem import dem_domain
from extrados.analyses.sequence import run_analyses
from extrados.analyses.sla.model import build
from extrados.core import calls
from extrados.core import sla as core
from extrados.core.errors import Cancelled
from extrados.decks.explain import starter
from extrados.decks.reader import make_deck, read_deck
from extrados.results.checkpoint import Checkpoint, folder_of, let_go
from extrados.running.run import run_to

BLOCK = """
[structure]
kind = "block"
width = 1.0
height = 4.0
[joints]
friction = 2.0
normal_stiffness = 1e8
"""
PULSE = """
[motion]
kind = "sine-pulse"
amplitude = "0.5 g"
period = 0.5
"""
WALL = """
[structure]
kind = "panel"
width = 1.0
height = 1.0
thickness = 0.1
[material]
density = 2000
young = "3 GPa"
poisson = 0.2
tensile_strength = "0.2 MPa"
fracture_energy = "10 N/m"
[[analysis]]
kind = "sla"
constant = [{ kind = "gravity" }, { kind = "pressure", edge = "top", value = "0.2 MPa" }]
reference = [{ kind = "spread", edge = "top", fx = "1 kN" }]
"""
ARCH = """
[structure]
kind = "arch"
radius = 10.0
thickness = 1.5
embrace = 157.5
voussoirs = 7
"""
DECKS = {
    "dem-domain": BLOCK
    + """
[[analysis]]
kind = "dem-domain"
amplitudes = ["0.5 g", "0.7 g"]
durations = [0.2, 0.4, 0.8]
accuracy = 0.1
vary_damping = [0.5]
""",
    "dem-fragility": BLOCK
    + PULSE
    + """
[[analysis]]
kind = "dem-fragility"
solver = "nonsmooth"
intensity = "scale"
levels = [0.5, 1.0, 1.5]
count = 4
settle = 0.5
uncertain = { width = 0.1, friction = 0.1 }
""",
    "dem variations and friction": BLOCK
    + PULSE
    + """
[[analysis]]
kind = "dem"
end_time = 0.6
vary_damping = [0.5, 2.0]
vary_friction = [0.5]
find_friction = true
""",
    "dem, one run": BLOCK
    + PULSE
    + """
[[analysis]]
kind = "dem"
end_time = 0.6
time_step = 1e-5
""",
    "dem of solids": BLOCK
    + PULSE
    + """
[[analysis]]
kind = "dem"
direction = 30.0
end_time = 0.6
time_step = 2e-5
""",
    "dem tilt": BLOCK
    + """
[[analysis]]
kind = "dem"
test = "tilt"
tilt_limit = "0.5 g"
tilt_accuracy = 0.05
""",
    "sla, one curve of each sense": WALL
    + """
directions = ["+", "-"]
events = 2150
mechanism_ratio = 1e5
without_equilibrium = "load-unload"
mesh.size = "0.1 m"
""",
    "sla in stages": WALL.replace("reference =", "# reference =")
    + """
events = 1150
mechanism_ratio = 1e5
without_equilibrium = "load-unload"
mesh.size = "0.1 m"
[[analysis.stages]]
hold = [{ edge = "top", fix = "y" }]
reference = [{ kind = "displacement", direction = "x", parts = [{ edge = "top" }] }]
target_displacement = "0.505 mm"
[[analysis.stages]]
reference = [{ kind = "displacement", direction = "x", parts = [{ edge = "top", ratio = -1.0 }] }]
""",
    "sla seeds": WALL
    + """
events = 150
strength_variation = 0.2
seeds = [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12]
mesh.size = "0.25 m"
""",
    "sweep": ARCH
    + """
[[analysis]]
kind = "sweep"
vary = "thickness"
start = 1.2
stop = 2.0
count = 30
""",
    "sweep, its changes and optimum": ARCH
    + """
[[analysis]]
kind = "sweep"
vary = "embrace"
start = 100
stop = 180
count = 4
""",
    "assessment": ARCH
    + """
[motion]
kind = "sine-pulse"
amplitude = "0.5 g"
period = 0.8
[[analysis]]
kind = "assessment"
impulses = 1
""",
    "failure-domain at amplitudes": ARCH
    + """
[[analysis]]
kind = "failure-domain"
durations = [0.6, 1.2]
amplitudes = 4
at_amplitudes = ["0.6 g", "0.8 g", "1.0 g"]
accuracy = 0.01
""",
    "compatible motions": """
[motion]
kind = "compatible"
code = "EN1998-1"
ground = "A"
acceleration = "0.2 g"
duration = 10.0
shortest = 0.1
longest = 0.5
tolerance = 0.2
[[analysis]]
kind = "motion"
count = 3
""",
    "generated motions": """
[motion]
kind = "generated"
mmi = 6
duration = 3.0
[[analysis]]
kind = "motion"
count = 200
""",
    "survey": ARCH
    + """
[[analysis]]
kind = "survey"
file = "survey.csv"
""",
    "moving-load": ARCH
    + """
[[analysis]]
kind = "moving-load"
count = 30
""",
}
SURVEY = "name,thickness\n" + "".join(f"arch {k},{1.2 + 0.02 * k:.2f}\n" for k in range(30))
#: Ends itself without a word when it has kept so many batches
KILLED = """
import os, signal, sys
from extrados.analyses.dem import job as runs
from extrados.results.checkpoint import Checkpoint
runs.KEEP_SECONDS = 0.0
real, left = Checkpoint.keep, [int(sys.argv[1])]
def keep(self, *args):
    path = real(self, *args)
    left[0] -= 1
    if left[0] == 0:
        os.kill(os.getpid(), signal.SIGKILL)
    return path
Checkpoint.keep = keep
from extrados.cli import main
sys.argv = ["extrados", *sys.argv[2:]]
main()
"""
#: Batches after which a run is killed, where two are too few to come to what is tried: the second curve, the last
#: searches of a sweep, the shortest durations after the rounds of the map
KEEPS = {
    "sla, one curve of each sense": 4,
    "sla in stages": 3,
    "sweep, its changes and optimum": 3,
    "failure-domain at amplitudes": 5,
    "generated motions": 4,
}
MEASURED = ("seconds_per_event", "sections_per_second")


def results_of(out: Path) -> list:
    """Results of all analyses but for what a clock measured."""

    def without_clock(value):
        if isinstance(value, dict):
            return {k: without_clock(v) for k, v in value.items() if k not in MEASURED}
        if isinstance(value, list):
            return [without_clock(v) for v in value]
        return value

    analyses = json.loads((out / "summary.json").read_text())["analyses"]
    return [(a["kind"], a["status"], a.get("reason"), a.get("answer"), without_clock(a["results"])) for a in analyses]


def arrays_of(out: Path) -> dict[str, bytes]:
    found = {}
    with h5py.File(out / "results.h5") as file:
        file.visititems(
            lambda name, item: (
                found.update({name: np.asarray(item).tobytes()}) if isinstance(item, h5py.Dataset) and item.dtype.kind != "O" else None
            )
        )
    return found


def assert_same(one: Path, two: Path) -> None:
    assert results_of(one) == results_of(two)
    arrays = arrays_of(one)
    assert arrays and arrays == arrays_of(two)
    for path in one.glob("*.csv"):
        assert path.read_bytes() == (two / path.name).read_bytes(), path.name


def written(kind: str, folder: Path) -> Path:
    deck = folder / "deck.toml"
    deck.write_text(DECKS[kind])
    (folder / "survey.csv").write_text(SURVEY)
    return deck


def run(deck: Path, out: Path, **context) -> None:
    run_to(Context(read_deck(deck), **context), out, figures=False)


#: One of each way to keep members, in the quick suite; all of them in `make verify`
QUICK = (
    "dem-domain",
    "dem, one run",
    "sla in stages",
    "sweep, its changes and optimum",
    "failure-domain at amplitudes",
    "generated motions",
    "survey",
)


@pytest.mark.parametrize("kind", [k if k in QUICK else pytest.param(k, marks=pytest.mark.verify) for k in DECKS])
def test_killed_and_resumed(kind: str, tmp_path: Path) -> None:
    deck, one, two = written(kind, tmp_path), tmp_path / "a", tmp_path / "b"
    keeps = KEEPS.get(kind, 2)
    words = ["run", str(deck), "--no-figures", "--quiet", "--threads", "1", "--out", str(one)]
    killed = subprocess.run([sys.executable, "-c", KILLED, str(keeps), *words])
    assert killed.returncode == -signal.SIGKILL and not (one / "summary.json").exists()
    assert len(list(folder_of(one).glob("*/*.npz"))) == keeps
    run(deck, one, resume=True, threads=2)
    run(deck, two, threads=2)
    assert_same(one, two)
    assert not folder_of(one).exists()


@pytest.mark.parametrize("kind", ["dem-domain", "dem tilt", "sla seeds", "generated motions"])
def test_interrupted_and_resumed(kind: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """After Ctrl-C the finished members are there, and are not computed again."""
    deck = make_deck(tomllib.loads(DECKS[kind]))
    out, count = tmp_path / "run", []
    real = Checkpoint.keep

    def keep(self, *args):
        count.append(args)
        if len(count) == 2:
            calls._ask()
        return real(self, *args)

    with monkeypatch.context() as patch:
        patch.setattr(Checkpoint, "keep", keep)
        (found,) = run_analyses(Context(deck, out=out))
    assert found.status == "interrupted" and "--resume" in found.reason
    kept = set(folder_of(out).glob("*/*.npz"))
    assert len(kept) == 2
    again = []
    with monkeypatch.context() as patch:
        patch.setattr(Checkpoint, "keep", lambda self, *args: again.append(args) or real(self, *args))
        (resumed,) = run_analyses(Context(deck, out=out, resume=True))
    (whole,) = run_analyses(Context(deck))
    assert resumed.status == whole.status == "ok" and resumed.answer == whole.answer
    assert kept <= set(folder_of(out).glob("*/*.npz")) and again


#: Its weight cracks the wall many times before the push begins
HEAVY = (
    WALL.replace("density = 2000", "density = 2500").replace(
        'value = "0.2 MPa" }]', 'value = "0.1 MPa" }, { kind = "point", x = 0.5, y = 0.5, fx = "9 kN" }]'
    )
    + """
events = 2000
ripple = 0.012
mesh.size = "0.05 m"
"""
)


@pytest.mark.parametrize("kept", [1, 2])
def test_constant_loads_are_not_brought_on_again(kept: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Stopped on their way (after 1000 events) or after it: what was done stays done, and the end has the same bits."""
    deck = make_deck(tomllib.loads(HEAVY))
    runs: list[int] = []
    real, run = Checkpoint.keep, core.Model.run

    def keep(self, *args):
        runs.append(0)
        if len(runs) == kept:
            calls._ask()
        return real(self, *args)

    with monkeypatch.context() as patch:
        patch.setattr(Checkpoint, "keep", keep)
        (stopped,) = run_analyses(Context(deck, out=tmp_path / "run"))
    assert stopped.status == "interrupted" and stopped.results["events"] == 0
    done = []

    def counted(self, *args, **keywords):
        found = run(self, *args, **keywords)
        done.append(len(found))
        return found

    (whole,) = run_analyses(Context(deck))
    with monkeypatch.context() as patch:
        patch.setattr(core.Model, "run", counted)
        (resumed,) = run_analyses(Context(deck, out=tmp_path / "run", resume=True))
    before = whole.results["events_of_constant_loads"] + 1
    assert sum(done) <= whole.results["events"] + 100 + (before - 1000 if kept == 1 else 0)
    for name, array in whole.arrays.items():
        assert np.asarray(array.data).tobytes() == np.asarray(resumed.arrays[name].data).tobytes(), name


@pytest.mark.parametrize(
    "structure, friction",
    [
        ("kind = 'brickwork'\nunit_length = 0.5\nunit_height = 0.25\nunits = 2\ncourses = 3", 0.4),
        ("kind = 'vault'\npreset = 'dejong-a'", 0.35),
    ],
)
def test_joints_that_slide_go_on_with_the_same_bits(structure: str, friction: float, tmp_path: Path, monkeypatch) -> None:
    """Interrupted each time their state is kept: what sticks, what slides and the forces of friction are kept with it."""
    monkeypatch.setattr("extrados.analyses.sla.events.KEPT", 40)
    monkeypatch.setattr("extrados.analyses.sla.events.GRID", 40)
    deck = make_deck(tomllib.loads(f"[structure]\n{structure}\n[joints]\nfriction = {friction}\n[analysis]\nkind = 'sla'\n"))
    real = Checkpoint.keep

    def keep(self, *args):
        calls._ask()
        return real(self, *args)

    (whole,) = run_analyses(Context(deck))
    assert (whole["event_code"] >= core.EVENT["slide"]).sum() > 50 and len(whole["event_code"]) > 150
    stops = 0
    with monkeypatch.context() as patch:
        patch.setattr(Checkpoint, "keep", keep)
        for _ in range(20):
            (found,) = run_analyses(Context(deck, out=tmp_path / "run", resume=stops > 0))
            if found.status != "interrupted":
                break
            stops += 1
    assert stops >= 2 and found.answer == whole.answer
    for name, array in whole.arrays.items():
        assert np.asarray(array.data).tobytes() == np.asarray(found.arrays[name].data).tobytes(), name


@pytest.mark.parametrize("kind", ["dem, one run", "dem of solids"])
def test_an_interrupted_run_of_discrete_elements_goes_on_where_it_was(kind: str, tmp_path: Path, monkeypatch) -> None:
    """Its state is kept when it is stopped; the resumed one takes only the steps that were missing."""
    deck, out = make_deck(tomllib.loads(DECKS[kind])), tmp_path / "run"
    told: list[float] = []

    def stop(done: float, total: float, text: str) -> None:
        told.append(done / total)
        if len(told) == 2:
            calls._ask()

    (found,) = run_analyses(Context(deck, out=out, progress=stop))
    assert found.status == "interrupted" and "--resume continues from here" in found.reason
    assert 0.0 < told[0] < told[1] < 1.0
    again: list[float] = []
    context = Context(deck, out=out, resume=True, progress=lambda done, total, text: again.append(done / total))
    (resumed,) = run_analyses(context)
    (whole,) = run_analyses(Context(deck))
    assert again[0] > told[1] and resumed.status == whole.status == "ok"  # a run under a nudged motion follows
    assert resumed.results == whole.results
    for name, array in whole.arrays.items():
        np.testing.assert_array_equal(resumed.arrays[name].data, array.data)


def test_ctrl_c_between_two_rounds_counts(monkeypatch: pytest.MonkeyPatch) -> None:
    rounds = []
    real = dem_domain.Search.fails

    def fails(self, pulses):
        rounds.append(real(self, pulses))
        calls._ask()
        return rounds[-1]

    monkeypatch.setattr(dem_domain.Search, "fails", fails)
    (found,) = run_analyses(Context(make_deck(tomllib.loads(DECKS["dem-domain"]))))
    assert found.status == "interrupted" and len(rounds) == 1


def test_cluster_gives_the_same_bytes(cluster, tmp_path: Path) -> None:
    address, _ = cluster
    for kind in ("dem-domain", "sla seeds", "sweep"):
        folder = tmp_path / kind
        folder.mkdir()
        deck = written(kind, folder)
        run(deck, folder / "a", scheduler=address)
        run(deck, folder / "b")
        assert_same(folder / "a", folder / "b")


def test_a_new_factor_forgets_the_history(tmp_path: Path) -> None:
    """What the event loop goes on from, damage and where it stood, gives the same bits after any history."""
    deck = make_deck(tomllib.loads(DECKS["sla seeds"]))
    model = build(deck.building.mesh(deck.analyses[0].mesh), deck.analyses[0])
    ends = []
    with model.open(deck.analyses[0], 1) as one, model.open(deck.analyses[0], 1) as other:
        one.loads(model.constant, model.reference)
        one.run(60, [model.control], core.Stop())
        damage, standing = one.damage(), one.standing()
        other.loads(model.constant, model.reference)
        for it in (one, other):
            it.renew(damage, standing)
            ends.append(it.run(60, [model.control], core.Stop()))
    for name in ("load", "compliance", "stored", "external", "lost", "crack", "point", "number", "monitors"):
        assert getattr(ends[0], name).tobytes() == getattr(ends[1], name).tobytes(), name


def test_two_runs_do_not_share_their_batches(tmp_path) -> None:
    """The second into a folder is refused in words, whether it resumes or not, and the batches of the first are left."""
    path, out = tmp_path / "deck.toml", tmp_path / "out"
    path.write_text(DECKS["failure-domain at amplitudes"])
    begun = Checkpoint(out, read_deck(path).identity, resume=False)
    kept = begun.keep("sweep", 0, {"x": np.arange(3.0)})
    words = [sys.executable, "-m", "extrados", "run", str(path), "--no-figures", "--out", str(out)]
    for more in ([], ["--resume"]):
        run = subprocess.run([*words, *more], capture_output=True, text=True)
        assert run.returncode == 3 and "another run is writing its unfinished batches" in run.stdout + run.stderr
        assert "internal error" not in run.stdout + run.stderr
        assert kept.exists()
    let_go(out)
    assert subprocess.run(words, capture_output=True).returncode == 0 and not folder_of(out).exists()


def test_ctrl_c_as_the_peak_is_looked_at_again_is_an_interruption(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """The state at the peak is computed a second time at the end: a run that is stopped there is not a whole one without it."""

    def stopped(*_: object, **__: object) -> None:
        raise Cancelled(130, "events interrupted")

    data = tomllib.loads(starter("sla"))
    data["analysis"][0]["without_equilibrium"] = "load-unload"  # a step's state is kept as it is found
    deck = make_deck(data)
    with monkeypatch.context() as patch:
        patch.setattr("extrados.core.sla.Model.run_whole", stopped)
        (found,) = run_analyses(Context(deck, out=tmp_path / "run"))
    assert found.status == "interrupted" and "--resume" in found.reason
    (resumed,) = run_analyses(Context(deck, out=tmp_path / "run", resume=True))
    (whole,) = run_analyses(Context(deck))
    assert resumed.status == "ok" and resumed.answer == whole.answer
    assert {name for name in whole.arrays if "peak" in name} <= set(resumed.arrays)
