"""The time a user waits: commands, the README's deck with all figures, a run in memory, as shares of the whole."""

import contextlib
import importlib
import json
import os
import statistics
import subprocess
import sys
import time
import tomllib
from pathlib import Path

from timing import seconds

import extrados
from extrados.analyses.limit.common import answer_of
from extrados.decks.reader import make_deck
from extrados.limit.finite_motion import finite_motion
from extrados.schema.contained import read_contained

ROOT = Path(__file__).resolve().parents[2]
README = ROOT / "cases" / "arch" / "readme.toml"
RUNS = 3
#: What each command loads before it does anything
COMMANDS = {
    "version": (["version"], "extrados.cli, extrados.running.provenance"),
    "check": (["check", str(README)], "extrados.cli, extrados.decks.reader"),
    "explain": (["explain", "thickness"], "extrados.cli, extrados.decks.manual"),
}
#: A whole run in a fresh interpreter that tells when each part of it is over
STAGES = """
import json, sys, tempfile, time
from pathlib import Path
begin = time.perf_counter()
marks = {}
def mark(name):
    global begin
    marks[name] = time.perf_counter() - begin
    begin = time.perf_counter()
import extrados.cli
from extrados import kinds
from extrados.analyses.context import Context, default_threads
from extrados.decks.reader import read_deck
from extrados.running.run import compute
from extrados.results import store
import h5py
mark("imports")
deck = read_deck(sys.argv[1])
mark("reading")
for options in deck.analyses:
    kinds.load(kinds.ANALYSES[options.kind].driver)
mark("imports of the analyses")
run = compute(Context(deck, default_threads()))
mark("analyses")
with tempfile.TemporaryDirectory() as folder:
    run.write(Path(folder) / "run", figures=False)
    mark("writing")
    from extrados.show.report import write_report
    for options in deck.analyses:
        kinds.load(kinds.ANALYSES[options.kind].figures)
    mark("imports of the figures")
    write_report(Path(folder) / "run")
    mark("drawing")
print(json.dumps(marks))
"""


def wall(command: list[str]) -> tuple[float, str]:
    """Median wall time of a command [s], and what it printed."""
    whole, _, printed = times(command)
    return whole, printed


def times(command: list[str]) -> tuple[float, float, str]:
    """Median wall time of a command [s], its least processor time, and what it printed."""
    subprocess.run(command, check=True, capture_output=True)
    found, spent = [], []
    for _ in range(RUNS):
        begin, before = time.perf_counter(), os.times()
        done = subprocess.run(command, check=True, capture_output=True, text=True)
        found.append(time.perf_counter() - begin)
        after = os.times()
        spent.append(after.children_user + after.children_system - before.children_user - before.children_system)
    return statistics.median(found), min(spent), done.stdout


def main() -> None:
    print("waiting: seconds of wall time, and shares of the whole")
    start, _ = wall([sys.executable, "-c", "pass"])
    print(f"  the interpreter alone: {start:.3f} s")
    for name, (words, modules) in COMMANDS.items():
        whole, spent, _ = times([sys.executable, "-m", "extrados", *words])
        loaded, _ = wall([sys.executable, "-c", f"import {modules}"])
        rest = max(whole - loaded, 0.0)
        print(
            f"  extrados {name}: {whole:.3f} s, {spent:.3f} s of processor (goal 0.4); interpreter {start / whole:.0%}, imports {(loaded - start) / whole:.0%}, "
            f"the command itself {rest / whole:.0%}"
        )
    whole, printed = wall([sys.executable, "-c", STAGES, str(README)])
    stages = {"interpreter": start, **json.loads(printed)}
    shares = ", ".join(f"{stage} {t:.2f} s ({t / whole:.0%})" for stage, t in stages.items())
    print(f"  extrados run {README.relative_to(ROOT)}: {whole:.2f} s; {shares}")
    in_memory()
    in_a_process()


#: A file of each library, and the function that reads it in a process of its own
FOREIGN = {
    "limit/church.dxf": ("extrados.model.geometry.dxf:parse_dxf", ["ezdxf"]),
    "solid/bonded-corner.obj": ("extrados.model.geometry.solids.meshes:parse_meshes", []),
    "shell/room.msh": ("extrados.model.geometry.mesh_files:parse_mesh_file", ["meshio"]),
}


def in_a_process() -> None:
    """What it costs that a process of its own reads a file of a foreign format, beside the reading itself."""
    options = {
        ".dxf": {"name": "a.dxf", "unit": None, "layers": None, "meaning": {}, "join_tolerance": 1e-3, "sagitta": 0.01},
        ".obj": {"name": "a.obj", "sort": ".obj"},
        ".msh": {},
    }
    for name, (reader, libraries) in FOREIGN.items():
        path = README.parents[1] / name
        module, function = reader.split(":")
        read = getattr(importlib.import_module(module), function)
        more = options[path.suffix]
        source = path if path.suffix == ".msh" else path.read_bytes()
        taken: list[list[float]] = [[], []]
        begin = time.perf_counter()
        read_contained(reader, source, libraries, **more)
        first = time.perf_counter() - begin
        for _ in range(21):
            begin = time.perf_counter()
            read_contained(reader, source, libraries, **more)
            taken[0].append(time.perf_counter() - begin)
            begin = time.perf_counter()
            with contextlib.redirect_stdout(None):  # meshio prints an empty line for each file
                read(str(source) if source is path else source, **more)
            taken[1].append(time.perf_counter() - begin)
        whole, bare = (min(found) for found in taken)
        print(
            f"  {path.name} read in a process of its own: {1e3 * whole:.1f} ms, {1e3 * (whole - bare):.1f} over the reading (goal 60); "
            f"the first of a command {1e3 * first:.0f} ms"
        )


def in_memory() -> None:
    """extrados.run of an arch's tilt against the mechanics alone, and one changed value of a live model."""
    data = tomllib.loads(README.read_text(encoding="utf-8"))
    data = {"structure": data["structure"], "analysis": {"kind": "tilt"}}

    def mechanics() -> None:
        deck = make_deck(data)
        answer = answer_of(deck.buildings[0], deck.analyses[0])
        finite_motion(answer.assembly, answer.mechanism)

    calls = (lambda: extrados.run(data), lambda: make_deck(data), mechanics)
    taken: list[list[float]] = [[], [], []]
    for _ in range(21):  # in turn, so that a busy moment meets all three
        for call, found in zip(calls, taken, strict=True):
            begin = time.perf_counter()
            call()
            found.append(time.perf_counter() - begin)
    whole, checked, bare = (min(found) for found in taken)
    bare -= checked
    live = extrados.live(data)
    thicknesses = iter(range(1000))

    def change() -> None:
        live.set("structure.thickness", 0.18 + 1e-5 * next(thicknesses))
        live["tilt"]

    def slide() -> None:
        live.set("joints.friction", 0.7 + 1e-5 * next(thicknesses))
        live["tilt"]

    print(
        f"  extrados.run of an arch in memory: {1e3 * whole:.1f} ms; {1e3 * (whole - bare):.1f} ms over its mechanics; deck "
        f"{checked / whole:.0%}, mechanics {bare / whole:.0%}, force polygons and results {1 - (checked + bare) / whole:.0%}"
    )
    print(
        f"  live model: another thickness {seconds(change, 21) / whole:.2f}, another friction {seconds(slide, 21) / whole:.2f}, "
        f"nothing changed {seconds(lambda: live['tilt'], 21) / whole:.4f} of a run"
    )


if __name__ == "__main__":
    main()
