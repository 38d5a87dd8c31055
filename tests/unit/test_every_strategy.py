"""Every kind of building under every strategy, from decks as a user writes them, with figures.

What a strategy refuses stands in REFUSED with the words that say why; everything else must be answered.
"""

import json
import re
from pathlib import Path

import ezdxf
import pytest

import extrados
from extrados.running.run import Run
from extrados.show import report, style

CASES = Path(__file__).resolve().parents[2] / "cases"

BUILDINGS = {
    "arch": 'kind = "arch"\nradius = 1.0\nthickness = 0.18\nembrace = 150\nvoussoirs = 12',
    "pointed arch": 'kind = "pointed-arch"\nspan = 6.0\nradius = 4.5\nthickness = 0.9\nvoussoirs = 12',
    "elliptical arch": 'kind = "elliptical-arch"\nspan = 8.0\nrise = 3.0\nthickness = 0.9\nvoussoirs = 12',
    "bridge": 'kind = "bridge"\ndepth = 3.0\nspans = [{ span = 6.0, rise = 1.5, thickness = 0.6, rings = 2, voussoirs = 12 }]\n'
    "fill = { cover = 0.3 }",
    "viaduct": 'kind = "bridge"\ndepth = 3.0\nspans = [{ span = 6.0, rise = 2.0, thickness = 0.5, voussoirs = 10 }, '
    '{ shape = "three-centred", span = 5.0, rise = 2.0, thickness = 0.5, voussoirs = 10 }]\n'
    "piers = [{ width = 1.6, height = 3.0 }]\nabutments = { width = 2.0, height = 2.0 }\nbacking = { height = 1.0 }\n"
    "fill = { cover = 0.3, passive = 0.5 }\nsurfacing = { thickness = 0.1 }",
    "vault": 'kind = "vault"\npreset = "dejong-a"\nvoussoirs = 10',
    "aisled vault": 'kind = "aisled-vault"\npreset = "vezelay-like"\nvoussoirs = 10\naisle_voussoirs = 8',
    "blocks": 'kind = "blocks"\nground = {ground}\nblock = {blocks}',
    "blocks of a JSON file": 'kind = "blocks"\nfile = "stones.json"',
    "blocks of a drawing": 'kind = "blocks"\nfile = "stones.dxf"\nunit = "m"\nground = {ground}',
    "block": 'kind = "block"\nwidth = 1.0\nheight = 4.0',
    "column": 'kind = "column"\nwidth = 0.8\ntop_width = 0.6\nheight = 4.0\ndrums = 4',
    "stack": 'kind = "stack"\nlower_width = 1.0\nlower_height = 1.5\nupper_width = 0.6\nupper_height = 2.0',
    "frame": 'kind = "frame"\nwidth = 0.8\nheight = 4.0\nspacing = 3.0\nlintel_height = 0.8',
    "brickwork": 'kind = "brickwork"\nunits = 3\ncourses = 6\nunit_length = 0.5\nunit_height = 0.4\ndepth = 0.3',
    "brickwork with a door": 'kind = "brickwork"\nunits = 5\ncourses = 6\nunit_length = 0.6\nunit_height = 0.4\n'
    "depth = 0.3\nopenings = [{ x = [1.0, 2.0], y = [0.0, 1.6] }]",
    "panel": 'kind = "panel"\nwidth = 1.5\nheight = 2.4\nthickness = 0.3\nunit_length = 0.5\nunit_height = 0.4',
    "panel with a window": 'kind = "panel"\nwidth = 3.0\nheight = 2.4\nthickness = 0.3\nunit_length = 0.6\n'
    "unit_height = 0.4\nopenings = [{ x = [1.2, 1.8], y = [0.8, 1.6] }]",
    "panel of unknown units": 'kind = "panel"\nwidth = 3.0\nheight = 2.4\nthickness = 0.3\nopenings = [{ x = [1.2, 1.8], y = [0.8, 1.6] }]',
}
#: Walls of 18 to 27 units, whose motion on rigid contacts takes two minutes of a processor each: they rock by their mechanism alone
ALONE = ("brickwork", "panel", "panel with a window")
STRATEGIES = {
    "tilt": "",
    "thrust": "gamma = 0.02",
    "moving-load": "count = 9",
    "rocking": "end_time = 0.6",
    "failure-domain": "durations = [0.4, 0.8]\namplitudes = 6\naccuracy = 1e-2\nhand_over_cells = 2",
    "failure-curves": "durations = [0.4, 0.8]\namplitudes = 6\naccuracy = 1e-2\nmotions = 2",
    "assessment": "impulses = 1",
    "dem": "end_time = 0.3\njoints.normal_stiffness = 1e8",
    "sla": "events = 30\nmesh.size = 0.6",
    "fragility": "count = 6\nbootstrap = 20",
}
PULSE = '[motion]\nkind = "sine-pulse"\namplitude = "1 g"\nperiod = 0.5'
EARTHQUAKES = '[motion]\nkind = "generated"\nmmi = 9\nduration = 2.0'

PRESSED = "no load of this kind causes collapse of the {}, because such loads only compress the joints"
TWO = (
    "two stacked blocks rock in two coordinates. Only `rocking`, `fragility`, `failure-domain`, `failure-curves`, `harmonic-map` and `dem` "
    "can follow them"
)
UNKNOWN = "the units of the panel are not known: give `unit_length` and `unit_height`"
REFUSED = {
    # Stone does not crush here, and a load on a body that stands on all its width, or on a lintel, finds its way down.
    ("block", "moving-load"): PRESSED.format("block"),
    ("column", "moving-load"): PRESSED.format("column"),
    ("frame", "moving-load"): PRESSED.format("frame"),
    ("stack", "moving-load"): PRESSED.format("stack"),
    ("stack", "assessment"): TWO,
    ("brickwork", "moving-load"): PRESSED.format("wall"),
    ("brickwork with a door", "moving-load"): PRESSED.format("wall"),
    ("panel", "moving-load"): PRESSED.format("panel"),
    ("panel with a window", "moving-load"): PRESSED.format("panel"),
    # Finite elements and piers need no units; whatever looks at stones does.
    **{("panel of unknown units", strategy): UNKNOWN for strategy in ("tilt", "thrust", "moving-load", "dem")},
}


@pytest.fixture(scope="module")
def stones(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the stones of an arch as JSON and as a drawing."""
    folder = tmp_path_factory.mktemp("stones")
    text = (CASES / "limit" / "trapezoids.json").read_text()
    (folder / "stones.json").write_text(text)
    drawing = ezdxf.new()
    for stone in json.loads(text)["blocks"]:
        drawing.modelspace().add_lwpolyline(stone["points"], close=True)
    drawing.saveas(folder / "stones.dxf")
    return folder


def look(folder: Path, building: str, motion: str, strategies: list[str]) -> Run:
    """The run of a deck in which the strategies look at a building."""
    stones = json.loads((folder / "stones.json").read_text())
    blocks = ", ".join(f"{{ points = {stone['points']} }}" for stone in stones["blocks"])
    structure = BUILDINGS[building].replace("{blocks}", f"[{blocks}]").replace("{ground}", str(stones["ground"]))
    keys = {**STRATEGIES, **({"rocking": f"{STRATEGIES['rocking']}\nhand_over = false"} if building in ALONE else {})}
    analyses = [f'[[analysis]]\nkind = "{strategy}"\n{keys[strategy]}' for strategy in strategies]
    deck = folder / "deck.toml"
    material = '[material]\ntensile_strength = "0.3 MPa"\nfracture_energy = 50'
    deck.write_text("\n".join([f"[structure]\n{structure}", material, motion, *analyses]))
    return extrados.run(deck)


def quick_save(fig, folder: Path, name: str) -> str:
    """As plots.style.save, coarse, without layout and SVG, which take most of the time."""
    fig.set_layout_engine("none")
    fig.set_dpi(40)
    style.FigureCanvasAgg(fig).print_png(folder / "figures" / f"{name}.png")
    return name


#: Each sort of building once, in the quick suite; all of them in `make verify`
QUICK = ("arch", "viaduct", "aisled vault", "blocks of a drawing", "column", "stack", "frame", "panel of unknown units")


@pytest.mark.parametrize("building", [b if b in QUICK else pytest.param(b, marks=pytest.mark.verify) for b in BUILDINGS])
def test_a_building_under_every_strategy(building: str, stones: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(style, "save", quick_save)
    pulse = [strategy for strategy in STRATEGIES if strategy != "fragility"]
    for motion, strategies in ((PULSE, pulse), (EARTHQUAKES, ["fragility"])):
        run = look(stones, building, motion, strategies)
        placed = re.compile(r"^\S+:\d+: [\w.]+: ")  # file, line and key, where one is to blame
        told = {a["kind"]: (a["status"], placed.sub("", a["reason"])) for a in run.analyses}
        expected = {s: REFUSED.get((building, s)) for s in strategies}
        assert told == {s: ("refused", reason) if reason else ("ok", "") for s, reason in expected.items()}
        run.write(tmp_path / strategies[0], figures=False)
        drawn = report.draw(Run.read(tmp_path / strategies[0]), tmp_path)
        assert set(drawn) == {s for s, reason in expected.items() if not reason}
        for a in run.analyses:
            if a["status"] == "ok":
                assert a["answer"] and a["verdict"]["statement"] and drawn[a["name"]]
                assert all((tmp_path / "figures" / f"{name}.png").stat().st_size for name, _ in drawn[a["name"]])
                assert "structure" not in a["answer"], "an answer calls the building by its name"


def test_stones_are_the_same_however_they_are_given(stones: Path) -> None:
    given = ("blocks", "blocks of a JSON file", "blocks of a drawing")
    found = [look(stones, building, PULSE, ["tilt"])["tilt"].collapse_acceleration_g for building in given]
    assert found == [pytest.approx(found[0], rel=1e-12)] * 3


def test_a_wall_whose_spandrel_lifts_off_a_pier_says_why_it_does_not_rock(stones: Path) -> None:
    """Pushed towards its wide pier the wall turns about that pier's toe, and the other pier parts from the spandrel."""
    structure = BUILDINGS["brickwork with a door"].replace("x = [1.0, 2.0]", "x = [0.9, 1.5]")
    deck = stones / "lifts.toml"
    deck.write_text(f'[structure]\n{structure}\n{PULSE}\n[[analysis]]\nkind = "rocking"')
    (told,) = extrados.run(deck).analyses
    assert told["status"] == "refused"
    assert told["reason"].endswith("degrees of freedom instead of one, because the mechanism opens along the whole of spandrel 1 on pier 1")
