"""Buildings and motions through files: decks, drawings, surveys with noise, exports read back, records."""

import json
import re
import tempfile
from pathlib import Path

import ezdxf
import numpy as np
import tomlkit
from asking import Answer, Deck, ask, must, near, run, same
from buildings import SOLIDS, decks, drawn, number, sections, shaken
from hypothesis import reject
from hypothesis import strategies as st
from relations import ANY, RIGID, SLIDES, SLOW, alike, asked_of, filled, ok, recorded, relation, statics

import extrados
from extrados import kinds
from extrados.decks.reader import read_text


@relation("tilt local-mechanism", ANY, 1e-12)
def a_deck_through_json(deck: Deck, within: float) -> None:
    """The deck stored in summary.json gives the same results as the deck."""
    resolved = json.loads(json.dumps(run({**deck, "analysis": [asked_of(deck)]}).summary["deck"]["resolved"]))
    back = {name: filled(resolved[name]) for name in ("structure", "material", "joints")}
    back["structure"] = {k: v for k, v in back["structure"].items() if k in deck["structure"]}
    alike("through JSON", statics(deck), statics(back), within)


@relation("tilt local-mechanism", ANY, 1e-12)
def a_deck_as_text_and_as_objects(deck: Deck, within: float) -> None:
    """A deck as a dictionary, as TOML and made of objects gives the same results."""
    analysis = asked_of(deck)
    whole = {**deck, "analysis": [analysis]}
    one = Answer(run(whole).results[0])
    alike("as text", one, Answer(extrados.run(read_text(tomlkit.dumps(whole).encode()), threads=1).results[0]), within)
    names = {kind: place.split(":")[1] for there in kinds.TABLES.values() for kind, place in there.items()}
    structure, table = dict(deck["structure"]), dict(analysis)
    made = extrados.deck(
        getattr(extrados, names[structure.pop("kind")])(**structure),
        getattr(extrados, names[table.pop("kind")])(**table),
        joints=extrados.Joints(**deck["joints"]),
    )
    alike("as objects", one, Answer(extrados.run(made, threads=1).results[0]), within)


@relation("tilt", sections(), 1e-4)
def a_section_through_files(deck: Deck, within: float) -> None:
    """A section written as JSON, drawing, assembly of COMPAS or blocks of UDEC and read back has the same capacity."""
    one, there = ask(deck, "tilt"), deck["structure"]
    densities = {b.get("density") for b in there["block"]}
    if len(densities) > 1 and max(densities) - min(densities) > 1.0:
        reject()  # these files hold no densities
    ok(one)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "stones.json").write_text(
            json.dumps({"blocks": [{"name": b["name"], "points": b["points"]} for b in there["block"]], "ground": there["ground"]})
        )
        drawing = ezdxf.new()
        drawing.header["$INSUNITS"] = 6
        drawing.layers.add("GROUND")
        for block in there["block"]:
            drawing.modelspace().add_lwpolyline(block["points"], close=True)
        for row in there["ground"]:
            drawing.modelspace().add_line(row[:2], row[2:], dxfattribs={"layer": "GROUND"})
        drawing.saveas(folder / "stones.dxf")
        whole = {**deck, "analysis": [{"kind": "tilt"}]}
        text = extrados.export(whole, "compas")
        (folder / "compas.json").write_text(text)
        (folder / "triangles.json").write_text(triangulated(text))
        lines = re.findall(r"^block create polygon (.*)$", extrados.export(whole, "udec"), re.M)
        polygons = [[[float(v) for v in pair.split(",")] for pair in line.split()] for line in lines]
        shape = {"kind": "blocks", "depth": there.get("depth", 1.0)}
        files = {
            "JSON": {**shape, "file": "stones.json"},
            "DXF": {**shape, "file": "stones.dxf"},
            "COMPAS": {**shape, "file": "compas.json", "unit": "m"},
            "COMPAS of triangles": {**shape, "file": "triangles.json", "unit": "m"},
            "UDEC": {**shape, "block": [{"name": f"b{k}", "points": p} for k, p in enumerate(polygons)], "ground": there["ground"]},
        }
        for form, structure in files.items():
            back = ask({**deck, "structure": structure}, "tilt", folder)
            same(form, one, back)
            near(form, one.capacity, back.capacity, within, 1.0)


@relation(
    "tilt",
    decks(*SOLIDS),
    1e-4,
    examples=(
        {
            "structure": {"kind": "cross-vault", "radius": 5.0, "thickness": 0.8, "embrace": 140.0, "voussoirs": 4},
            "joints": {"friction": 0.7},
        },
    ),
)
def solids_through_compas(deck: Deck, within: float) -> None:
    """Solids written as an assembly of COMPAS and read back have the same capacity."""
    one = ask(deck, "tilt", direction=0.0, rose=4, starts=1)
    with tempfile.TemporaryDirectory() as name:
        (Path(name) / "stones.json").write_text(extrados.export({**deck, "analysis": [{"kind": "tilt", "direction": 0.0}]}, "compas"))
        back = ask({**deck, "structure": {"kind": "blocks", "file": "stones.json", "unit": "m"}}, "tilt", Path(name), direction=0.0, rose=4)
    same("COMPAS", one, back)
    must(
        one.numbers.get("blocks") == back.numbers.get("blocks"),
        f"{one.numbers.get('blocks')} stones, read back {back.numbers.get('blocks')}",
    )
    near("COMPAS", one.capacity, back.capacity, within, 1e-2)


CONVEX = "files of solids take convex parts: stones between curves are refused in words"


@relation("tilt", decks("block", "column", "brickwork", "arch", "stack", "frame"), 1e-4, exception=CONVEX)
def a_section_drawn_out(deck: Deck, within: float) -> None:
    """A plane section as solids has the same capacity."""
    deck = drawn(deck)
    one = ask(deck, "tilt")
    with tempfile.TemporaryDirectory() as name:
        (Path(name) / "stones.json").write_text(extrados.export({**deck, "analysis": [{"kind": "tilt"}]}, "compas"))
        other = ask(
            {**deck, "structure": {"kind": "blocks", "file": "stones.json", "unit": "m"}}, "tilt", Path(name), direction=0.0, rose=4
        )
    if "not convex" in other.said:
        reject()
    same("drawn out", one, other)
    near("drawn out", one.capacity, other.capacity, within, 1e-2)


@relation("tilt", st.tuples(sections(), st.integers(0, 10**6), st.sampled_from([1e-6, 3e-5])), 0.01)
def noise_below_the_tolerance(deck: Deck, seed: int, deviation: float, within: float) -> None:
    """Deviations of vertices below the contact tolerance hardly change the capacity."""
    one, other = ask(deck, "tilt"), ask(shaken(deck, deviation, seed), "tilt")
    same("noise", one, other)
    near("noise", one.capacity, other.capacity, within, 1e-2)


def triangulated(text: str) -> str:
    """An assembly of COMPAS with its convex faces cut into triangles."""
    data = json.loads(text)
    for node in data["data"]["graph"]["data"]["node"].values():
        mesh = node["block"]["data"]
        faces = [f for f in mesh["face"].values()]
        fans = [[f[0], f[k], f[k + 1]] for f in faces for k in range(1, len(f) - 1)]
        mesh["face"] = {str(k): fan for k, fan in enumerate(fans)}
        mesh["facedata"], mesh["max_face"] = {str(k): {} for k in range(len(fans))}, len(fans) - 1
    return json.dumps(data)


def stray_solids(text: str, deviation: float, seed: int) -> str:
    """An assembly of COMPAS whose stones' vertices stray each by itself, up to the deviation [m]; supports stay."""
    data, rng = json.loads(text), np.random.default_rng(seed)
    for node in data["data"]["graph"]["data"]["node"].values():
        if not node["is_support"]:
            for vertex in node["block"]["data"]["vertex"].values():
                for axis in "xyz":
                    vertex[axis] += float(rng.uniform(-deviation, deviation))
    return json.dumps(data)


CORNER = {
    "structure": {
        "kind": "wall",
        "unit_length": 0.5,
        "unit_height": 0.25,
        "thickness": 0.25,
        "height": 1.0,
        "legs": [{"length": 1.5}, {"length": 1.5, "turn": "left"}],
    },
    "joints": {"friction": 0.65},
}


@relation("tilt", st.tuples(decks("wall"), st.integers(0, 10**6)), 0.01, examples=((CORNER, 1),))
def noise_of_solids(deck: Deck, seed: int, within: float) -> None:
    """Deviations of the corners of solids by 10 micrometres hardly change the capacity."""
    text = extrados.export({**deck, "analysis": [{"kind": "tilt", "direction": 90.0}]}, "compas")
    found = []
    for deviation in (0.0, 1e-5):
        with tempfile.TemporaryDirectory() as name:
            (Path(name) / "stones.json").write_text(stray_solids(text, deviation, seed))
            structure = {"kind": "blocks", "file": "stones.json", "unit": "m"}
            found.append(ask({**deck, "structure": structure}, "tilt", Path(name), direction=90.0, rose=4, starts=1))
    same("noise", *found)
    near("noise", found[0].capacity, found[1].capacity, within, 1e-2)


@relation(
    "dem",
    st.tuples(number(0.6, 1.2), number(2.0, 4.0), number(0.02, 0.06), number(0.02, 0.06)),
    0.01,
    share=0.3,
    examples=((1.0, 3.0, 0.04, 0.044),),
)
def bevelled_corners(width: float, slenderness: float, dx: float, dy: float, within: float) -> None:
    """Discrete elements use blocks as drawn: a block with both lower corners cut off rocks on its narrower foot."""
    height = width * slenderness / 1.5
    dx, dy = dx * width, dy * width
    points = [[dx, 0.0], [width - dx, 0.0], [width, dy], [width, height], [0.0, height], [0.0, dy]]
    deck = {"structure": {"kind": "blocks", "block": [{"name": "a", "points": points}]}, "joints": {"friction": 2.0}}
    area = width * height - dx * dy
    level = (0.5 * width * height**2 - dx * dy * dy / 3.0) / area
    want = (0.5 * width - dx) / level
    near("limit analysis", ask(deck, "tilt").capacity, [want, want], 1e-6)
    near("rigid contacts", ask(deck, "dem", **SLOW).capacity, [want, want], within, 0.3)


@relation(
    "rocking fragility motion", st.tuples(number(0.01, 0.05), st.sampled_from(["rocking", "dem"])), 0.0, examples=((0.02, "rocking"),)
)
def offsets_of_records_are_told(offset: float, kind: str, within: float) -> None:
    """All analyses with a record whose velocity drifts give a warning."""
    time = np.arange(0.0, 30.0, 0.01)
    wave = 0.15 * np.sin(2.0 * np.pi * 2.0 * time) * np.exp(-0.2 * time) + offset
    with tempfile.TemporaryDirectory() as name:
        deck = {"structure": {"kind": "block", "width": 0.6, "height": 1.2}, "motion": recorded(Path(name), 0.01, wave)}
        told = ask(deck, "motion", Path(name)).warnings
        must("baseline" in told, f"motion says nothing of it: {told}")
        said = ask(deck, kind, Path(name), **({} if kind == "rocking" else {"end_time": 1.0, **RIGID})).warnings
    must("baseline" in said, f"{kind} says nothing of it: {said}")


@relation("tilt", sections("block", "column", "brickwork", "blocks"), 1e-6, examples=(SLIDES,))
def layers_that_are_switched_off(deck: Deck, within: float) -> None:
    """A drawing's frozen layers, layers that are off, and invisible entities are not masonry."""
    deck = drawn(deck)
    there = deck["structure"]
    found = []
    for hidden in (False, True):
        drawing = ezdxf.new()
        drawing.header["$INSUNITS"] = 6
        space = drawing.modelspace()
        for block in there["block"]:
            space.add_lwpolyline(block["points"], close=True)
        if hidden:
            drawing.layers.add("OLD").freeze()
            drawing.layers.add("OFF").off()
            top = max(p[1] for b in there["block"] for p in b["points"])
            for k, layer in enumerate(("OLD", "OFF")):
                low = top + 0.2 * k
                space.add_lwpolyline([(0.0, low), (0.2, low), (0.2, low + 0.2), (0.0, low + 0.2)], close=True, dxfattribs={"layer": layer})
        with tempfile.TemporaryDirectory() as name:
            drawing.saveas(Path(name) / "stones.dxf")
            found.append(ask({**deck, "structure": {"kind": "blocks", "file": "stones.dxf"}}, "tilt", Path(name)))
    same("hidden", *found)
    near("weight", *(a.results.weight_N for a in found), within)


@relation("motion", st.tuples(st.integers(200, 400), number(0.1, 0.5)), 0.0, examples=((300, 0.2),))
def columns_without_a_time_are_refused(count: int, amplitude: float, within: float) -> None:
    """Three columns of numbers without a time are not one series."""
    waves = amplitude * np.sin(np.arange(count)[:, None] * [0.1, 0.13, 0.17])
    with tempfile.TemporaryDirectory() as name:
        (Path(name) / "m.txt").write_text("\n".join(" ".join(f"{v:.6f}" for v in row) for row in waves) + "\n")
        answer = ask({"motion": {"kind": "record", "file": "m.txt", "time_step": 0.01, "unit": "g"}}, "motion", Path(name))
    must(answer.status == "refused", f"{answer.status}: read as one series")
