"""What scripts do without files: tables as objects, sweeps as tables, figures as objects, errors that say what is wrong."""

import inspect
import json
import math
import os
import re
import subprocess
import sys
import tomllib
from pathlib import Path

import h5py
import numpy as np
import pytest

import extrados
from extrados import kinds, objects
from extrados.decks.reader import PROPERTIES, make_deck, read_deck

ROOT = Path(__file__).resolve().parents[2]
CASES = ROOT / "cases"
DECKS = sorted(p for p in CASES.rglob("*.toml") if not p.name.endswith(".expect.toml"))
ARCH = extrados.Arch(radius=10.0, thickness="1.5 m", embrace=157.5, voussoirs=7)
PULSE = extrados.StepPulse(amplitude="1.0 g", duration=0.2)
DECK = extrados.deck(ARCH, [extrados.Tilt(), extrados.Rocking(end_time=0.3)], motion=PULSE)


@pytest.mark.parametrize("path", DECKS, ids=lambda p: f"{p.parent.name}/{p.stem}")
def test_objects_are_the_tables_of_decks(path: Path) -> None:
    """Every deck that is shipped, taken apart into objects and made again of them, is the same deck."""
    read = read_deck(path)
    tables = {"materials": read.building.materials, "motion": read.motion, "title": read.title}
    tables |= {name: getattr(read.building, name) for name in ("material", "joints", "supports", "initial")}
    tables |= {name: list(getattr(read.building, name)) for name in ("ties", "dampers", "hinges")}
    made = extrados.deck(read.structure, read.analyses, folder=path.parent, **tables)
    assert made.analyses == read.analyses and made.motion == read.motion
    assert made.building == read.building and made.buildings == read.buildings


def test_every_kind_has_an_object_with_its_keys() -> None:
    for section, there in kinds.TABLES.items():
        for kind, place in there.items():
            maker = getattr(extrados, place.split(":")[1])
            assert (maker.section, maker.kind) == (section, kind)
            assert set(inspect.signature(maker).parameters) == set(kinds.table(section, kind).model_fields) - {"kind"}
            assert maker.__doc__.count("\n") > 4
    for name, model in PROPERTIES.items():
        assert getattr(extrados, model.__name__).table is model, f"[{name}] has no object: another is called so"
    assert len(objects.names()) == len(set(objects.names()))
    assert {"Arch", "Rocking", "Joints", "Supports", "Tie", "deck", "sweep"} <= set(dir(extrados))


def test_an_object_is_what_a_deck_says() -> None:
    table = tomllib.loads('[structure]\nkind = "arch"\nradius = 10\nthickness = "150 cm"\nembrace = 157.5\nvoussoirs = 7')
    assert make_deck({**table, "analysis": {"kind": "tilt"}}).structure == ARCH
    assert isinstance(ARCH, extrados.Arch) and not isinstance(PULSE, extrados.Arch)
    assert DECK.motion.amplitude == 9.80665
    assert extrados.run({"structure": ARCH, "analysis": extrados.Tilt()})["tilt"].collapse_acceleration_g == pytest.approx(
        extrados.run(DECK)["tilt"].collapse_acceleration_g
    )


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        (lambda: extrados.Arch(raduis=1.0), "structure.raduis: unknown key; did you mean 'radius'"),
        (lambda: extrados.Arch(radius=-1.0, thickness=1.0, embrace=90, voussoirs=7), "structure.radius: -1.0: input should be greater"),
        (lambda: extrados.Block(width="1,5 m", height=2), "'1,5 m' is not a quantity: .*decimal sign is a point"),
        (lambda: extrados.StepPulse(amplitude=0.5, duration=0.1), 'write "0.5 g"'),
        (lambda: extrados.Arch(radius=math.nan, thickness=1.0, embrace=90, voussoirs=7), "radius: nan: input should be a finite number$"),
        (lambda: extrados.Joints(frction=0.5), "joints.frction: unknown key; did you mean 'friction'"),
        (lambda: extrados.deck(ARCH, extrados.Rocking()), r"rocking requires a \[motion\]"),
        (lambda: extrados.sweep(DECK, over={"structure.thickness": [1.2, -1.0]}), "structure.thickness: -1.0: input should"),
        (lambda: extrados.sweep(DECK, over={"structure.thicknes": [1.2]}), "did you mean 'thickness'"),
        (lambda: extrados.sweep(DECK, over={"structure.thickness": 1.2}), "structure.thickness: expected a list"),
        (
            lambda: extrados.sweep(DECK, over={f"structure.k{k}": [1.0] * 1000 for k in range(5)}),
            "all combinations of the values give 1,000,000,000,000,000 runs, more than the 1,000,000 allowed",
        ),
        (lambda: extrados.sweep(DECK, over={"analysis.sla.events": [1]}), "no analysis 'sla'; its analyses are tilt, rocking"),
    ],
)
def test_errors_from_python_are_those_of_decks(wrong, words: str) -> None:
    with pytest.raises(extrados.DeckError, match=words):
        wrong()


@pytest.mark.parametrize("how", [{"workers": 0}, {"workers": -2}, {"threads": 0}])
def test_a_sweep_by_no_one_is_refused(how: dict[str, int]) -> None:
    with pytest.raises(ValueError, match="expected 1 or more"):
        extrados.sweep(DECK, over={"structure.thickness": [1.2]}, **how)


def test_a_table_that_is_not_there_names_the_nearest() -> None:
    with pytest.raises(AttributeError, match="did you mean Rocking"):
        _ = extrados.Roking
    with pytest.raises(AttributeError, match="no attribute 'rum'"):
        _ = extrados.rum
    assert not hasattr(objects, "nothing")


def test_a_sweep_is_a_frame_and_a_dataset_with_units() -> None:
    pytest.importorskip("pandas")
    pytest.importorskip("xarray")
    over = {"structure.thickness": ["1.2 m", 1.5, 1.8], "motion.duration": np.array([0.1, 0.2])}
    swept = extrados.sweep(DECK, over=over, progress=False)
    frame, data = swept.frame(), swept.dataset()
    assert len(frame) == 6 and frame.attrs["units"]["structure.thickness"] == "m"
    assert data["tilt.collapse_acceleration_g"].dims == ("structure.thickness", "motion.duration")
    assert data["structure.thickness"].attrs["units"] == "m" and data["motion.duration"].attrs["units"] == "s"
    assert data["tilt.collapse_acceleration_g"].attrs["units"] == "g"
    for thickness, duration in [(1.2, 0.1), (1.8, 0.2)]:
        deck = {**DECK.data, "structure": {**DECK.data["structure"], "thickness": thickness}}
        run = extrados.run({**deck, "motion": {**DECK.data["motion"], "duration": duration}})
        here = data.sel({"structure.thickness": thickness, "motion.duration": duration})
        assert here["tilt.collapse_acceleration_g"].item() == run["tilt"].collapse_acceleration_g
        assert here["rocking.peak_rotation_rad"].item() == run["rocking"].peak_rotation_rad
        assert here["rocking.outcome"].item() == run["rocking"].outcome
        assert here["rocking.verdict.outcome"].item() == run.analysis("rocking")["verdict"]["outcome"]


def test_columns_keep_their_names_whatever_else_is_varied() -> None:
    """Also beside another key of the same last word."""
    bridge = {
        "kind": "bridge",
        "spans": [{"span": 8.0, "rise": 2.5, "thickness": 0.5, "voussoirs": 12}] * 2,
        "piers": [{"width": 1.6, "height": 5.0}],
    }
    deck = {"structure": bridge, "analysis": {"kind": "thrust"}}
    first, second = "structure.spans.0.thickness", "structure.spans.1.thickness"
    alone, beside = (extrados.sweep(deck, over={key: [0.6] for key in keys}, progress=False) for keys in ([first], [first, second]))
    assert alone.columns[0] == first and beside.columns[:2] == [first, second]
    assert set(alone.columns) == set(beside.columns) - {second}


def test_a_sweep_shows_its_first_members_in_a_notebook() -> None:
    swept = extrados.sweep(DECK, over={"structure.thickness": np.linspace(1.2, 1.8, 14)}, progress=False)
    page = swept._repr_html_()
    assert page.count("<tr>") == 13 and "2 more runs" in page
    assert "structure.thickness [m]" in page and "tilt.verdict.outcome" in page and "rocking.peak_rotation_rad" not in page


def test_an_analysis_without_results_raises_its_reason() -> None:
    """What proves that a structure cannot stand is a result."""
    arch = extrados.Arch(radius=10.0, thickness=1.5, embrace=157.5, voussoirs=7)
    run = extrados.run(extrados.deck(arch, extrados.Tilt(), material=extrados.Material(density=0.0)))
    row = run.analysis("tilt")
    assert row["status"] == "refused"
    with pytest.raises(extrados.Refused, match=re.escape(f"tilt: refused: {row['reason']}")):
        print(run["tilt"])
    thin = extrados.Arch(radius=10.0, thickness=0.2, embrace=157.5, voussoirs=7)
    assert extrados.run(extrados.deck(thin, extrados.Tilt()))["tilt"].collapse_acceleration_g == 0.0


def test_type_checkers_know_the_keys_of_tables(tmp_path: Path) -> None:
    """The stub of the build, before mypy: a misspelt key, a missing one and a wrong type are errors, a right call is none."""
    package = ROOT / "python" / "extrados"
    (tmp_path / "extrados").mkdir()
    command = [sys.executable, ROOT / "python" / "make_stub.py", package, tmp_path / "extrados" / "__init__.pyi"]
    subprocess.run(command, check=True)
    lines = [
        'extrados.Arch(radius=10.0, thickness="150 cm", embrace=157.5, voussoirs=7)',
        "extrados.Arch(raduis=10.0, thickness=1.5, embrace=157.5, voussoirs=7)",
        "extrados.Arch(thickness=1.5, embrace=157.5, voussoirs=7)",
        "extrados.Arch(radius=10.0, thickness=1.5, embrace=157.5, voussoirs=7.5)",
        'extrados.Tilt(friction_rule="asociated")',
        "extrados.run(extrados.deck(extrados.Block(width=1.0, height=2.0), extrados.Tilt()), outt=1)",
    ]
    (tmp_path / "calls.py").write_text("import extrados\n" + "\n".join(lines) + "\n")
    checked = subprocess.run(
        [
            sys.executable,
            "-m",
            "mypy",
            "--config-file=",
            "--follow-imports=skip",
            "--ignore-missing-imports",
            "calls.py",
            "extrados/__init__.pyi",
        ],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        env={**os.environ, "MYPYPATH": str(tmp_path)},
    )
    wrong = {int(line.split(":")[1]) for line in checked.stdout.splitlines() if ": error: " in line}
    assert wrong == {3, 4, 5, 6, 7}, checked.stdout + checked.stderr
    assert 'Unexpected keyword argument "raduis"' in checked.stdout


def test_processes_give_the_bits_of_one() -> None:
    over = {"structure.thickness": [1.2, 1.3, 1.4, 1.6, 1.7]}
    one, two = (extrados.sweep(DECK, over=over, workers=count, progress=False) for count in (1, 2))
    assert one.rows == two.rows and len(one) == 5


def test_rows_that_belong_together_and_what_is_refused() -> None:
    pandas = pytest.importorskip("pandas")
    table = pandas.DataFrame({"structure.radius": [10.0, 1.0], "structure.thickness": [1.5, 3.0]})
    told: list[float] = []
    swept = extrados.sweep(DECK, over=table, progress=lambda done, total, text: told.append(done))
    assert swept.rows[0]["tilt.status"] == "ok" and swept.rows[1]["tilt.status"] != "ok" and swept.rows[1]["tilt.reason"]
    assert swept.shape is None and swept.dataset()["structure.radius"].dims == ("member",) and told[-1] == 2
    assert np.isnan(swept.column("tilt.collapse_acceleration_g")[1]) and "2 of 2 runs" in repr(swept)
    with pytest.raises(KeyError, match=r"its columns are structure\.radius, structure\.thickness"):
        swept.column("raduis")


def test_a_stopped_sweep_goes_on(tmp_path: Path) -> None:
    over = {"structure.thickness": [1.2, 1.3, 1.4, 1.6]}
    place = tmp_path / "study"

    def stop(done: float, total: float, text: str) -> None:
        if done == 1:
            raise RuntimeError("stopped")

    with pytest.raises(RuntimeError):
        extrados.sweep(DECK, over=over, progress=stop, resume=place)
    code = f"from extrados.results.checkpoint import _hold; from pathlib import Path; _hold(Path({str(place)!r}))"
    subprocess.run([sys.executable, "-c", code], check=True)  # another process may go on as well
    told: list[float] = []
    swept = extrados.sweep(DECK, over=over, progress=lambda done, total, text: told.append(done), resume=place)
    assert told[0] == 1 and swept.rows == extrados.sweep(DECK, over=over, progress=False).rows
    assert not list(tmp_path.iterdir())


def test_figures_are_objects(tmp_path: Path) -> None:
    run = extrados.run(DECK)
    drawn = run.plot("tilt")
    assert len(drawn) and drawn[next(iter(drawn))].axes and repr(drawn).startswith("<Drawn: ")
    assert drawn._repr_html_().count("<img") == len(drawn)
    assert all(path.stat().st_size > 1000 for path in drawn.save(tmp_path / "figures", "svg"))
    with pytest.raises(KeyError, match="the names are: tilt, rocking"):
        run.plot("sla")
    assert len(repr(run)) < 200


def test_results_say_where_when_and_by_whom(tmp_path: Path) -> None:
    """Coordinates of joints and blocks in the file and in xarray; time and host in summary.json."""
    xarray = pytest.importorskip("xarray")
    run = extrados.run(DECK, tmp_path / "r")
    summary = json.loads((tmp_path / "r" / "summary.json").read_text())
    assert summary["computed"]["at"][:2] == "20" and summary["computed"]["host"]
    assert run.summary["computed"] == summary["computed"] == extrados.load(tmp_path / "r").summary["computed"]
    for data in (run.dataset("tilt"), extrados.load(tmp_path / "r").dataset("tilt")):
        assert list(data["axis"].values) == ["x", "y"] and "joint_name" in data.coords
        assert data["joint_name"].values[0] == "joint 0"
        middle = 0.5 * (data["joint_p"] + data["joint_q"])
        assert np.allclose(data["joint_x"], middle.sel(axis="x")) and np.allclose(data["joint_y"], middle.sel(axis="y"))
    with xarray.open_dataset(tmp_path / "r" / "results.h5", group="tilt", engine="h5netcdf") as data:
        assert {"joint_x", "joint_y", "joint_name", "block_name"} <= set(data.coords)
        assert "joint_name" in data["collapse_normal"].coords and list(data["axis"].values) == ["x", "y"]
    with h5py.File(tmp_path / "r" / "results.h5") as file:
        assert file["tilt/joint_name"].asstr()[0] == run.dataset("tilt")["joint_name"].values[0]


@pytest.mark.verify
def test_a_cluster_gives_the_bits_of_one(cluster) -> None:
    address, _ = cluster
    over = {"structure.thickness": [1.2, 1.3, 1.4]}
    one, two = (extrados.sweep(DECK, over=over, workers=count, progress=False) for count in (1, address))
    assert one.rows == two.rows and len(two) == 3


def test_a_process_that_dies_is_reported(tmp_path: Path) -> None:
    """A member that ends its process, as one for which there is no memory would."""
    from extrados.analyses import workers

    with workers.processes(Deadly(), 1) as elsewhere:
        assert elsewhere.run(0, 2, 1)["value"].tolist() == [0.0, 1.0]
        with pytest.raises(RuntimeError, match="members 5 to 5 ended with code 9"):
            elsewhere.run(5, 1, 1)
    with workers.processes(Deadly(), 1) as elsewhere, pytest.raises(ValueError, match="member 7"):
        elsewhere.run(7, 1, 1)


class Deadly:
    """Member 5 ends its process, member 7 fails, the others give their numbers."""

    def run(self, first: int, count: int, threads: int) -> dict[str, np.ndarray]:
        if first == 5:
            os._exit(9)
        if first == 7:
            raise ValueError("member 7")
        return {"value": np.arange(first, first + count, dtype=float)}


def test_what_may_be_raised_can_be_caught() -> None:
    """By its name: also where no scheduler answers, or none can be asked."""
    arch = {"kind": "arch", "radius": 10.0, "thickness": 1.5, "embrace": 157.5, "voussoirs": 7}
    with pytest.raises(extrados.Refused, match="scheduler"):
        extrados.sweep({"structure": arch, "analysis": {"kind": "tilt"}}, over={"structure.thickness": [1.5]}, workers="nowhere")
    assert {"DeckError", "Refused", "StoreError"} <= set(dir(extrados))


def test_the_version_is_that_of_the_command() -> None:
    command = subprocess.run([sys.executable, "-m", "extrados", "version"], capture_output=True, text=True, timeout=120, check=True)
    assert command.stdout.split()[1] == extrados.__version__
