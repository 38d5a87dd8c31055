"""Surveys as they are used: a church, `check`, and thrust lines through every block with their places in words."""

import csv
import itertools
import json
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from surveys import CHURCH, ROOT, SQUARE, box, rows, run
from typer.testing import CliRunner

from extrados.analyses.context import Context
from extrados.analyses.sequence import run_analyses
from extrados.cli import app
from extrados.decks.reader import make_deck
from extrados.limit.answer import assess
from extrados.limit.places import place_of
from extrados.limit.programme import LimitAnalysis
from extrados.limit.supports import support_movement
from extrados.model.errors import BadGeometry
from extrados.model.geometry.assembly import GROUND
from extrados.model.geometry.drawing import Drawing, Polygon
from extrados.model.geometry.inspection import inspect
from extrados.model.geometry.linework import net_of
from extrados.model.geometry.polygons import inside
from extrados.model.properties import Joints, Material
from extrados.model.structures.arch import make_arch
from extrados.model.structures.blocks import Blocks, assemble, make_blocks
from extrados.results.model import Result
from extrados.show import style
from extrados.views.building import Building

# --- the church, and `check`


@pytest.fixture(scope="module")
def church() -> Result:
    from extrados.decks.reader import read_deck

    deck = read_deck(CHURCH)
    data = {**deck.data, "analysis": {"kind": "tilt"}}
    return run_analyses(Context(make_deck(data, deck.folder), threads=1))[0]


def test_a_church_as_surveyed(church: Result) -> None:
    """125 stones in one try; what is measured of them bears what the true stones bear, within a tenth."""
    sys.path.insert(0, str(ROOT / "tools"))
    try:
        import draw_church
    finally:
        sys.path.remove(str(ROOT / "tools"))
    true = [
        Polygon(f"{layer} {k}", outline, 1900.0 if "BUTTRESS" in layer else 2300.0)
        for layer, outlines in draw_church.church().items()
        for k, outline in enumerate(outlines)
    ]
    exact = assemble(inspect(Drawing(true), None, 1e-6, [0.0, 0.4, -0.6]), 2300.0, 1.0)
    assert church.status == "ok" and len(church["centroid"]) == len(true) == 125
    assert len(church["joint_p"]) == len(exact.a)
    limit = LimitAnalysis(exact, 0.7)
    for direction, key in ((1, "collapse_acceleration_g"), (-1, "collapse_acceleration_opposite_g")):
        assert church[key] == pytest.approx(direction * limit.collapse(direction)[0].gamma, rel=0.1)
    assert church["weight_N"] == pytest.approx(float(exact.mass.sum()) * 9.80665, rel=2e-3)


def test_the_drawing_of_the_church_is_what_its_script_draws(tmp_path: Path) -> None:
    sys.path.insert(0, str(ROOT / "tools"))
    try:
        import draw_church
    finally:
        sys.path.remove(str(ROOT / "tools"))
    assert draw_church.draw(tmp_path / "church.dxf") == 125
    shipped, drawn = (
        Blocks(kind="blocks", file="church.dxf", origin=[431250.0, 5062480.0], join_tolerance=8e-3, contact_tolerance=6e-3).assembly(
            2300.0, folder
        )
        for folder in (CHURCH.parent, tmp_path)
    )
    assert shipped.p == pytest.approx(drawn.p, abs=1e-9) and shipped.mass == pytest.approx(drawn.mass, rel=1e-9)


def test_check_lists_and_draws_what_run_refuses(tmp_path: Path) -> None:
    deck = tmp_path / "church.toml"
    deck.write_text(CHURCH.read_text().replace('"6 mm"', '"3 mm"'))
    (tmp_path / "church.dxf").write_bytes((CHURCH.parent / "church.dxf").read_bytes())
    found = CliRunner().invoke(app, ["check", str(deck), "--out", str(tmp_path / "seen")])
    assert found.exit_code == 2 and "overlaps" in found.output and "would close all" in found.output
    assert (tmp_path / "seen" / "geometry.png").stat().st_size > 10_000
    with (tmp_path / "seen" / "geometry.csv").open() as stream:
        listed = list(csv.DictReader(stream))
    assert [r["status"] for r in listed] == sorted((r["status"] for r in listed), key=["overlap", "open", "closed"].index)
    deepest = max(float(r["depth_mm"]) for r in listed)
    assert 4.0 < deepest < 6.0
    good = CliRunner().invoke(app, ["check", str(CHURCH), "--out", str(tmp_path / "good")])
    assert good.exit_code == 0 and "0 faulty places" in good.output and good.output.rstrip().endswith("ok")


def test_a_crowd_of_blocks_in_one_place_is_refused_with_the_bound(tmp_path: Path) -> None:
    """Not looked at pair by pair: half a million of them would take a minute."""
    box = [[0, 0], [1, 0], [1, 1], [0, 1]]
    blocks = [{"name": f"b{k}", "points": box} for k in range(1000)]
    (tmp_path / "b.json").write_text(json.dumps({"blocks": blocks}))
    with pytest.raises(BadGeometry, match=r"1000 outlines.*more than 100,000 pairs"):
        Blocks(kind="blocks", file="b.json").assembly(2300.0, tmp_path)
    (tmp_path / "b.json").write_text(json.dumps({"blocks": blocks[:3]}))
    with pytest.raises(BadGeometry, match="3 overlaps: blocks 'b0' and 'b1' overlap by 500 mm"):
        Blocks(kind="blocks", file="b.json").assembly(2300.0, tmp_path)


def test_lines_drawn_many_times_are_one() -> None:
    corners = np.array([[0.0, 0.0], [1.0, 0.0], [1.3, 1.0], [0.1, 1.1]])
    once = np.column_stack([corners, np.roll(corners, -1, axis=0)])
    many = np.concatenate([once, once[[1, 1, 2]], *(once[:, [2, 3, 0, 1]] for _ in range(2000))])
    net = net_of(many, 1e-3, 1e-2)
    assert len(net.faces) == 1 and not net.loose
    np.testing.assert_array_equal(net.faces[0], net_of(once, 1e-3, 1e-2).faces[0])
    assert set(net.source[0].tolist()) == {0, 1, 2, 3}
    # drawn twice, a line weighs no more where its end meets another's; it is firm where one of the two is
    bent = once.copy()
    bent[0, 3] += 4e-4
    twice = np.concatenate([bent, bent[:1]])
    np.testing.assert_array_equal(net_of(twice, 1e-3, 1e-2).faces[0], net_of(bent, 1e-3, 1e-2).faces[0])
    firm = np.array([False, False, False, False, True])
    assert net_of(twice, 1e-3, 1e-2, firm).faces[0][1] == pytest.approx([1.0, 4e-4], abs=1e-6)


def test_check_leaves_the_files_of_others(tmp_path: Path) -> None:
    """What extrados did not write, or what was changed since, stays; what it wrote is replaced."""
    out = tmp_path / "mine"
    out.mkdir()
    (out / "geometry.png").write_text("my own picture")
    words = ["check", str(CHURCH), "--out", str(out)]
    assert CliRunner().invoke(app, words).exit_code == 0
    assert (out / "geometry.png").read_text() == "my own picture" and (out / "geometry-2.png").exists()
    with (out / "geometry.csv").open("a") as stream:
        stream.write("a remark of mine\n")
    (out / "geometry.png").unlink()
    found = CliRunner().invoke(app, words)
    assert found.exit_code == 0 and "geometry-2.csv" in found.output
    assert (out / "geometry.csv").read_text().endswith("a remark of mine\n")
    assert sorted(p.name for p in out.glob("geometry*")) == ["geometry-2.csv", "geometry.csv", "geometry.png", "geometry.svg"]
    assert sorted(p.name for p in tmp_path.iterdir()) == ["mine"]


def test_check_makes_buildings_that_are_no_surveys_too(tmp_path: Path) -> None:
    deck = tmp_path / "vault.toml"
    text = '[structure]\nkind = "vault"\npreset = "dejong-a"\n{}[[analysis]]\nkind = "tilt"\n'
    deck.write_text(text.format("buttress_width = 0.1\nface = 30.0\n"))
    found = CliRunner().invoke(app, ["check", str(deck)])
    assert found.exit_code == 2 and "vault.toml:1: structure: buttress: " in found.output
    deck.write_text(text.format("") + '[[joints.types]]\njoints = ["none"]\nfriction = 0.3\n')
    found = CliRunner().invoke(app, ["check", str(deck)])
    assert found.exit_code == 2 and "joint 'none', which does not exist" in found.output


def test_joint_types_of_layers_reach_every_strategy() -> None:
    blocks = [Polygon("a", SQUARE, layer="L"), Polygon("b", SQUARE + np.array([0, 1]), layer="L"), Polygon("c", SQUARE + np.array([0, 2]))]
    made = assemble(inspect(Drawing(blocks), None, 1e-4), 2000.0, 1.0)
    assert {name: [made.joint_names[j] for j in joints] for name, joints in made.groups.items()} == {"L": ["a on b"]}
    assert make_blocks(blocks, None).groups == made.groups
    assert isinstance(Building(None, Material(), joints=Joints()), Building)


# --- the thrust line through every stone, places in words, letters


def test_the_line_runs_through_every_stone(church: Result) -> None:
    """Every stone of the church has a piece of it, or is a voussoir of a chain that has; all of it lies in the stones."""
    start, of, points = (church[f"collapse_line{end}"] for end in ("_start", "_of", ""))
    outline, edge = church["outline"], church["outline_start"]
    stones = [outline[a:b] for a, b in itertools.pairwise(edge)]
    grown = [o + 0.02 * (o - o.mean(axis=0)) / np.hypot(*(o - o.mean(axis=0)).T)[:, None] for o in stones]
    assert all(any(inside(o, p[None])[0] for o in grown) for p in points)
    through = set()
    for a, b, _ in zip(start[:-1], start[1:], of, strict=True):
        middles = 0.5 * (points[a : b - 1] + points[a + 1 : b])
        through |= {k for k, o in enumerate(grown) for m in middles if inside(o, m[None])[0]}
    assert len(through) == 125
    assert len(church["collapse_line_force"]) == len(of) and church["collapse_line_force"].min() > 0.0


def test_lines_of_two_arches_meet_on_their_pier() -> None:
    answer = assess(make_aisled("vezelay-like"))
    state = answer.collapse_state
    pieces = [p for p in answer.lines(state) if p.name == "right pier"]
    trunk = max(pieces, key=lambda p: p.force)
    branch = next(p for p in pieces if p is not trunk)
    assert len(trunk.points) > 10 and (np.hypot(*(trunk.points - branch.points[-1]).T) < 1e-9).any()
    # Below the meeting the trunk carries both arches and the pier: at its foot it meets the base where the state says.
    block = answer.assembly.block_names.index("right pier")
    base = next(j for j in answer.assembly.joints_of(block) if GROUND in (answer.assembly.a[j], answer.assembly.b[j]))
    assert trunk.points[-1] == pytest.approx(state.points(answer.assembly)[base])


def make_aisled(preset: str):
    return make_deck({"structure": {"kind": "aisled-vault", "preset": preset}, "analysis": {"kind": "tilt"}}).building.blocks()


def test_a_stone_with_several_joints_shares_its_line() -> None:
    """A lintel stone on two others: the branches meet at the mean of their forces, and these balance the stone."""
    made = make_blocks([box("a", 0, 0), box("b", 2, 0), box("c", 0, 1, 3, 0.5), box("d", 1, 1.5, 1, 1)], None)
    answer = assess(made, 0.7)
    lines = {}
    for piece in answer.lines(answer.central):
        lines.setdefault(piece.name, []).append(piece)
    ends = {tuple(p.points[-1].round(9)) for p in lines["c"]}
    assert len(lines["c"]) == 3 and len(ends) == 1
    assert lines["d"][0].points[0] == pytest.approx([1.5, 2.0])  # the load of the topmost comes from its centroid
    assert lines["d"][0].force == pytest.approx(2000.0 * 9.80665)


def test_hinges_are_named_by_their_place(church: Result) -> None:
    places = [h.place for h in church["hinges"]]
    assert places[1] == "crown of chain 3, extrados"
    assert places[0].startswith("left haunch of chain 3 at ") and places[0].endswith("intrados")
    assert any(p.startswith("bed joint under ASHLAR #") and p.endswith("right edge") for p in places)
    assert "crown of chain 3, extrados" in church.answer and "right edge (x = 4." in church.answer
    one = run({"block": rows(box("pier", 0, 0, 1, 4))})
    assert [h.place for h in one["hinges"]] == ["foot of pier, right edge"]
    assert [h.place for h in one["hinges_opposite"]] == ["foot of pier, left edge"]
    arch = make_arch(10.0, 1.5, 157.5, 7)
    assert place_of(arch, 0, arch.p[0]) == "left springing of the arch, intrados"
    assert place_of(arch, 7, arch.q[7]) == "right springing of the arch, extrados"
    assert place_of(arch, 2, arch.p[2]).startswith("left haunch of the arch at ")


def test_letters_do_not_collide(tmp_path: Path) -> None:
    """Twelve hinges within a few millimetres of paper: no letter hides another, or the place of another."""
    random = np.random.default_rng(3)
    points = random.uniform(0.0, 0.3, (12, 2))
    with style.figure(5.0, 4.0) as (fig, (ax,)):
        ax.plot([-5, 5], [-5, 5])
        style.draw_hinges(ax, points, [chr(65 + k) for k in range(12)])
        style.save(fig, tmp_path, "letters")
        boxes = [t.get_window_extent(FigureCanvasAgg(fig).get_renderer()) for t in ax.texts]
        places = ax.transData.transform(points)
    for k, one in enumerate(boxes):
        assert not any(one.overlaps(other) for other in boxes[k + 1 :])
        assert not any(one.contains(*place) for place in places)


def test_supports_of_free_blocks_move() -> None:
    """Voussoirs as polygons in any order and sense follow their support as the arch of the same stones does."""
    arch = make_arch(10.0, 1.5, 157.5, 7)
    stones = [Polygon(f"s{i}", np.array([arch.p[i], arch.q[i], arch.q[i + 1], arch.p[i + 1]])) for i in range(7)]
    ground = [[*arch.p[0], *arch.q[0]], [*arch.q[7], *arch.p[7]]]
    found = run({"block": rows(*stones), "ground": ground}, kind="supports")
    shuffled = [stones[i] for i in (3, 6, 0, 5, 1, 4, 2)]
    again = run({"block": rows(*(Polygon(s.name, s.points[::-1]) for s in shuffled)), "ground": ground}, kind="supports")
    assert again["movement_at_fall_m"] == pytest.approx(found["movement_at_fall_m"], rel=1e-6)
    assert [h.joint for h in again["hinges_at_rest"]] == [h.joint for h in found["hinges_at_rest"]]
    made = make_blocks(stones, np.array(ground))
    exact = support_movement(replace(arch, mass=made.mass, centroid=made.centroid, inertia=made.inertia), (1.0, 0.0), 200)
    assert found["movement_at_fall_m"] == pytest.approx(exact[-1].movement, rel=1e-6)
    assert "left haunch of the chain at 8 % of the span, intrados; crown of the chain, extrados" in found.answer
    pier = run({"block": rows(box("a", 0, 0), box("b", 0, 1))}, kind="supports")
    assert pier.status == "refused" and "the structure has only one support" in pier.reason
