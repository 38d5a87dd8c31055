"""Sessions of the page without a browser: the numbers are a run's, the text its author's."""

import base64
import re
import struct
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import extrados
from extrados.explore.answers import standalone
from extrados.explore.document import Document, as_written
from extrados.explore.film import BadFilm, film
from extrados.explore.frames import Reply
from extrados.explore.session import Session
from extrados.limit.states import blended
from extrados.schema.places import CASES


def do(session: Session, **message: Any) -> list[Reply]:
    return list(session.answer(message))


@pytest.fixture
def session(tmp_path: Path) -> Iterator[Session]:
    found = Session(tmp_path)
    do(found, do="hello")
    yield found
    found.close()


@pytest.mark.parametrize(
    ("preset", "count"),
    [
        ("limit/arch-120", 5),
        ("vault/dejong-a", 6),
        ("vault/vezelay-like", 10),
        ("rocking/housner", 2),
        ("bridge/viaduct", 6),
        ("dem/column", 3),
        ("sla/yi-wall-1", 18),
        ("assess/panel", 10),
        ("dem/wall", 2),
        ("rocking/stack", 4),
        ("rocking/frame", 4),
    ],
)
def test_every_handle_leads_where_it_stands(session: Session, preset: str, count: int) -> None:
    """A handle led to where it stands changes nothing beyond its rounding; led on, the stones follow."""
    do(session, do="open", preset=preset)
    assert len(session.handles) == count
    for name, handle in list(session.handles.items()):
        value = handle.value_at(handle.x, handle.y)
        assert value == pytest.approx(handle.value, rel=1e-9, abs=1e-9), name
        further = handle.value * 1.02
        (reply,) = do(session, do="drag", handle=name, text=f"{further:.6g} {handle.unit}")
        assert "complaints" not in reply.words, (name, reply.words)
        assert session.handles[name].value == pytest.approx(further, rel=1e-5), name


@pytest.mark.parametrize(
    "preset",
    ["limit/arch-120", "vault/dejong-a", "vault/vezelay-like", "bridge/road", pytest.param("limit/church", marks=pytest.mark.verify)],
)
def test_the_numbers_of_the_page_are_those_of_a_run(session: Session, preset: str) -> None:
    (reply,) = do(session, do="open", preset=preset)
    run = extrados.run(session.live.deck.data | {"analysis": [{"kind": "tilt", **_loads(session)}]}) if preset != "limit/church" else None
    scene = reply.words["scene"]
    if run is None:
        run = extrados.run(Path(session.place) / session.name)
    found = run["tilt"]
    assert scene["capacity"]["plus_g"] == pytest.approx(found.collapse_acceleration_g, rel=1e-9)
    assert scene["capacity"]["minus_g"] == pytest.approx(found.collapse_acceleration_opposite_g, rel=1e-9)
    if "least_N" in scene:
        assert scene["least_N"] == pytest.approx(found.thrust_min_N, rel=1e-6)
        assert scene["most_N"] == pytest.approx(found.thrust_max_N, rel=1e-6)
    assert [h["where"] for h in scene["plus_hinges"]] == [h.place for h in found.hinges]


def _loads(session: Session) -> dict[str, Any]:
    given = session.live.deck.data["analysis"]
    first = given[0] if isinstance(given, list) else given
    return {"load": first["load"]} if "load" in first else {}


def test_a_line_passes_through_the_requested_point_or_near_it(session: Session) -> None:
    (reply,) = do(session, do="show", through={"joint": 18, "share": 0.5})
    there = reply.words["scene"]["through"]
    assert there["reached"] == pytest.approx(0.5, abs=1e-7)
    (reply,) = do(session, do="show", through={"joint": 0, "share": 0.0}, gamma=0.3)
    low = reply.words["scene"]["through"]["reached"]
    (reply,) = do(session, do="show", through={"joint": 0, "share": 1.0})
    high = reply.words["scene"]["through"]["reached"]
    assert 0.0 <= low < high <= 1.0
    limit, scene = session.picture.limit, session.picture
    least, most = limit.thrust(scene.assembly.chains["arch"], 0.3)
    for state in (least, most):
        assert low - 1e-6 <= state.position[0] <= high + 1e-6


@pytest.mark.parametrize("gamma", [0.0, 0.05])
def test_a_line_has_the_thrust_that_it_is_given(session: Session, gamma: float) -> None:
    """Between the least and the greatest, in equilibrium and within every joint; beyond them, theirs."""
    do(session, do="open", preset="vault/vezelay-like")
    (reply,) = do(session, do="show", gamma=gamma)
    low, high = (reply.words["scene"][k] for k in ("least_N", "most_N"))
    for wanted in (low - 1e3, low, 0.3 * low + 0.7 * high, high, high + 1e4):
        (reply,) = do(session, do="show", thrust=wanted)
        assert reply.words["scene"]["chosen"]["thrust_N"] == pytest.approx(min(max(wanted, low), high), rel=1e-9)
        assert "through" not in reply.words["scene"]
        up = sum(row["y_N"] for row in reply.words["scene"]["reactions"])
        assert up == pytest.approx(reply.words["scene"]["weight_N"], rel=1e-9)
    limit, assembly = session.picture.limit, session.picture.assembly
    state = blended(*limit.thrust(assembly.chains["nave"], gamma), 0.7)
    assert (state.position > -1e-9).all() and (state.position < 1.0 + 1e-9).all()
    force, at = state.force(assembly), state.points(assembly)
    moment = np.zeros(len(assembly.mass))
    for sign, side in ((1.0, assembly.a), (-1.0, assembly.b)):
        keep = side >= 0
        arm = at - assembly.centroid[side]
        turn = sign * (arm[:, 0] * force[:, 1] - arm[:, 1] * force[:, 0])
        moment += np.bincount(side[keep], turn[keep], len(assembly.mass))
    assert np.abs(moment).max() < 1e-9 * assembly.size * reply.words["scene"]["weight_N"]
    (reply,) = do(session, do="show", thrust="40 kN")
    assert reply.words["scene"]["chosen"]["wanted_N"] == 40e3
    (reply,) = do(session, do="show", thrust="40 kg")
    assert "Thrust of the line" in reply.words["complaints"][0]
    (reply,) = do(session, do="show", through={"joint": 9, "share": 0.5})
    assert "chosen" not in reply.words["scene"]


HELD = """[structure]
kind = "block"
width = 1.0
height = 4.0

[[ties]]
start = [0.4, 3.5]
ground = [2.0, 0.0]
works_in = "both"

[[analysis]]
kind = "tilt"
"""


def test_a_structure_that_nothing_overturns_is_not_reported_as_collapsing(session: Session) -> None:
    (reply,) = do(session, do="open", text=HELD)
    assert reply.words["scene"]["stands"] is True
    assert "no load of this kind causes collapse" in reply.words["scene"]["immovable"]
    list(session.answer({"do": "rest"}))


@pytest.mark.parametrize(
    ("more", "told"),
    [
        ('[supports]\nabutting_wall = "left"\n', "[supports] abutting_wall"),
        ("[[dampers]]\nstart = [0.4, 3.0]\nground = [3.0, 0.0]\ndamping = 1e5\n", "[[dampers]]"),
    ],
)
def test_the_page_has_no_answer_where_a_run_refuses_one(session: Session, more: str, told: str) -> None:
    text = HELD[: HELD.index("[[ties]]")] + more + HELD[HELD.index("[[analysis]]") :]
    (reply,) = do(session, do="open", text=text)
    scene = reply.words["scene"]
    assert (scene["stands"], "capacity" in scene) == (None, False)
    assert f"cannot consider {told}" in scene["unknown"]
    (refused,) = extrados.run(session.live.deck.data).results
    assert refused.status == "refused" and told in refused.reason
    do(session, do="rest")


PRESETS = sorted(p.relative_to(CASES).with_suffix("").as_posix() for p in CASES.rglob("*.toml") if not p.name.endswith(".expect.toml"))


@pytest.mark.parametrize("room", sorted({name.partition("/")[0] for name in PRESETS}))
def test_every_case_is_drawn_and_moved_or_says_why_not(tmp_path: Path, room: str) -> None:
    """No case ends in a fault of the program; whatever has a structure is drawn."""
    found = Session(tmp_path)
    names = [name for name in PRESETS if name.startswith(f"{room}/")]
    for name in names if len(names) < 12 else names[::3]:  # all of them in a browser
        (reply,) = do(found, do="open", preset=name)
        scene = reply.words["scene"]
        if found.live.deck.structure is None:
            assert "no [structure]" in scene["empty"]
        elif "empty" in scene:
            assert scene["seen"]["sort"] == ("elements" if "outline" in reply.arrays else "space"), name
            assert len(reply.arrays.get("vertex", reply.arrays.get("outline"))), name
        else:
            assert len(reply.arrays["outline"]), name
        if found.live.deck.motion is None:
            continue
        (reply,) = do(found, do="rocking")
        assert len(reply.arrays["motion"]), name
        told = reply.words["rocking"]
        assert told.get("refused") or (told["outcome"] and len(reply.arrays["time"])), name
    found.close()


def test_blocks_in_space_are_pushed_as_a_run_pushes_them(session: Session) -> None:
    (reply,) = do(session, do="open", preset="solid/column")
    assert reply.words["scene"]["seen"]["blocks"] == 5
    (reply,) = do(session, do="push")
    run = extrados.run(CASES / "solid" / "column.toml")
    assert reply.words["push"]["numbers"]["collapse_acceleration_g"] == run["tilt"].collapse_acceleration_g
    np.testing.assert_array_equal(reply.arrays["mechanism_pose"], run.array("tilt", "mechanism_pose"))


def test_a_stored_run_of_blocks_in_space_moves_over_time(session: Session, tmp_path: Path) -> None:
    deck = {
        "structure": {"kind": "column", "section": "round", "sides": 8, "width": 1.0, "height": 4.0, "drums": 2},
        "joints": {"friction": 0.7, "normal_stiffness": 1e8},
        "motion": {"kind": "step-pulse", "amplitude": "0.5 g", "duration": 0.1},
        "analysis": [{"kind": "dem", "direction": 0.0, "end_time": 0.2}],
    }
    run = extrados.run(deck, tmp_path / "space")
    (reply,) = do(session, do="run", path="space", analysis="dem", side="A")
    body = reply.words["run"]["body"]
    assert (body["sort"], body["unit"], body["over_time"]) == ("space", "s", True)
    assert reply.arrays["pose"].shape == (len(reply.arrays["body_time"]), 2, 6)
    np.testing.assert_array_equal(reply.arrays["pose"][-1], run.array("dem", "pose")[-1])


@pytest.mark.parametrize("preset", ["rocking/stack", "rocking/soft-base"])
def test_what_rocks_in_two_coordinates_does_so_as_in_a_run(session: Session, preset: str) -> None:
    do(session, do="open", preset=preset)
    (reply,) = do(session, do="rocking")
    run = extrados.run(CASES / f"{preset}.toml")["rocking"]
    told = reply.words["rocking"]
    assert (told["outcome"], told["peak_rotation_rad"]) == (run.outcome, run.peak_rotation_rad)
    assert len(reply.arrays["picture_time"]) == len(reply.arrays["pose"]) > 10


def test_a_history_says_which_assumptions_do_not_hold(session: Session) -> None:
    """A block that slides first: its rocking is no verdict, on the page as in a run."""
    deck = {
        "structure": {"kind": "block", "width": 0.5, "height": 0.3},
        "motion": {"kind": "sine-pulse", "amplitude": "0.5 g", "period": 1.0},
    }
    for friction, holds in ((0.2, False), ("no-sliding", True)):
        do(session, do="set", changes={**deck, "joints": {"friction": friction}})
        (reply,) = do(session, do="rocking")
        assert (reply.words["rocking"]["violated"] == []) is holds


def test_a_wall_rocks_where_it_stands(session: Session) -> None:
    """A pose about the foot of a block, or about the corner of a wall: its stones at rest lie on those that are drawn."""
    do(session, do="open", preset="codes/pier")
    do(session, do="set", changes={"motion": {"kind": "step-pulse", "amplitude": "1 g", "duration": 0.2}})
    (reply,) = do(session, do="rocking")
    at_rest, centroid = reply.arrays["pose"][0, 0, :2], reply.arrays["moving_centroid"][0]
    np.testing.assert_allclose(at_rest, centroid, atol=1e-9)
    assert reply.arrays["moving_outline"][:, 0].min() == pytest.approx(0.0, abs=1e-12)


def test_a_fault_of_the_program_is_reported_and_changes_nothing(session: Session, monkeypatch: pytest.MonkeyPatch) -> None:
    def fails(*_: Any) -> None:
        raise ValueError("a fault that was planted")

    before = session.document.text
    with monkeypatch.context() as planted:
        planted.setattr("extrados.explore.statics.picture", fails)
        (reply,) = do(session, do="drag", handle="thickness", text="0.8")
        assert "fault of extrados" in reply.words["complaints"][0]
        (reply,) = do(session, do="open", preset="vault/dejong-a")
        assert "a fault that was planted" in reply.words["complaints"][0]
    assert session.document.text == before
    (reply,) = do(session, do="show", gamma=0.0)
    assert reply.words["scene"]["capacity"]["plus_g"] > 0.3


def test_what_is_wrong_changes_nothing(session: Session) -> None:
    before = session.document.text
    for message in (
        {"do": "drag", "handle": "thickness", "text": "9 m"},
        {"do": "set", "changes": {"structure.radius": "-3 m"}},
        {"do": "set", "changes": {"structure.nonsense": 3}},
        {"do": "open", "text": "structure = ", "here": "same"},
        {"do": "open", "preset": "nothing/there"},
        {"do": "drag", "handle": "thickness", "text": "1 kg"},
    ):
        (reply,) = do(session, **message)
        assert reply.words.get("complaints"), message
        assert session.document.text == before
    (reply,) = do(session, do="show", gamma=0.0)
    assert reply.words["scene"]["capacity"]["plus_g"] > 0.3


def test_a_dropped_drawing_shows_what_it_shows_and_says_what_it_hides(session: Session, tmp_path: Path) -> None:
    ezdxf = pytest.importorskip("ezdxf")
    document = ezdxf.new("R2010", units=6)
    document.layers.add("OLD").freeze()
    for y, layer in ((0, "0"), (1, "0"), (2, "OLD")):
        document.modelspace().add_lwpolyline([(0, y), (1, y), (1, y + 1), (0, y + 1)], close=True, dxfattribs={"layer": layer})
    document.saveas(tmp_path / "pier.dxf")
    data = base64.b64encode((tmp_path / "pier.dxf").read_bytes()).decode()
    (reply,) = do(session, do="drop", name="pier.dxf", data=data)
    assert len(session.live.deck.building.blocks().mass) == 2
    assert [w for w in reply.words["scene"]["warnings"] if "1 of layer 'OLD' (frozen)" in w]


def test_the_text_keeps_what_its_author_wrote() -> None:
    text = '# mine\n[structure]\nkind = "arch" # round\nradius = "100 cm"  # of it\n\n[[analysis]]\nkind = "tilt"\n[[analysis]]\nkind = "rocking"\n'
    document = Document(text)
    document.put(["structure", "radius"], as_written(1.25, "100 cm", "m"))
    document.put(["analysis", "1", "end_time"], 3.0)
    assert document.text == text.replace('"100 cm"', '"125.0 cm"').replace('"rocking"\n', '"rocking"\nend_time = 3.0\n')
    assert as_written(3.0, None, "m/s^2", bare=False) == "3.0 m/s^2"


def test_saving_replaces_nothing_unasked(session: Session, tmp_path: Path) -> None:
    (tmp_path / "mine.toml").write_text("precious")
    (reply,) = do(session, do="save", path="mine.toml")
    assert "exists already" in reply.words["complaints"][0]
    assert (tmp_path / "mine.toml").read_text() == "precious"
    (reply,) = do(session, do="save", path="new/mine.toml")
    assert reply.words["saved"] == "new/mine.toml"
    assert (tmp_path / "new" / "mine.toml").read_text() == session.document.text


@pytest.mark.parametrize("patience", [1e9, 0.003], ids=["fast", "slow, and a hand is let in between"])
def test_the_map_gets_finer_and_is_kept(session: Session, monkeypatch: pytest.MonkeyPatch, patience: float) -> None:
    monkeypatch.setattr("extrados.explore.rocking.PATIENCE", patience)
    do(session, do="set", changes={"motion": {"kind": "step-pulse", "amplitude": "0.5 g", "duration": 0.2}})
    replies = do(session, do="domain")
    parts = [r for r in replies if r.words["domain"]["part"]]
    assert len(parts) > 5 if patience < 1.0 else not parts
    if parts:
        assert (parts[0].arrays["codes"] < 255).any(), "what is known of the first round is shown"
    replies = [r for r in replies if not r.words["domain"]["part"]]
    assert [r.words["domain"]["stride"] for r in replies] == [4, 2, 1]
    known = [(r.arrays["codes"] < 255).sum() for r in replies]
    assert known == [100, 500, 1600]
    last = replies[-1].arrays["codes"]
    for reply in replies:
        there = reply.arrays["codes"] < 255
        np.testing.assert_array_equal(reply.arrays["codes"][there], last[there])
    assert len(do(session, do="domain")) == 1, "the same building: nothing to compute"


def test_the_map_of_a_compliant_base_begins_with_few_cells(session: Session, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each of them takes long: the first reply is not to wait for a hundred."""
    monkeypatch.setattr("extrados.explore.rocking.PATIENCE", 0.0)
    do(session, do="open", preset="rocking/soft-base")
    first = next(session.answer({"do": "domain"}))
    assert first.words["domain"]["part"]
    assert 0 < (first.arrays["codes"] < 255).sum() <= 10


def test_films_are_films_or_refused() -> None:
    import io

    from PIL import Image

    def picture(grey: int) -> bytes:
        out = io.BytesIO()
        Image.new("RGB", (64, 48), (grey, 30, 90)).save(out, "JPEG")
        return out.getvalue()

    pictures = [picture(40 * k) for k in range(5)]
    body = b"".join(struct.pack(">I", len(p)) + p for p in pictures)
    made = film(b"gif\x0a" + body)
    with Image.open(io.BytesIO(made.content)) as image:
        assert image.n_frames == 5
        assert image.size == (64, 48)
    for bad in (b"", b"gif\x0a", b"gif\x00" + body, b"gif\x0a" + body[:-3], b"gif\x0a" + struct.pack(">I", 4) + b"text"):
        with pytest.raises(BadFilm):
            film(bad)


def test_free_stones_are_as_heavy_deep_and_rough_as_they_were(session: Session) -> None:
    text = (
        'title = "A \\"quoted\\" wall"\n[structure]\nkind = "column"\nwidth = 1.0\nheight = 3.0\ndrums = 3\ndepth = 2.0\n'
        '[material]\ndensity = 1800.0\n[joints]\nfriction = 0.2\n[[analysis]]\nkind = "tilt"\n'
    )
    do(session, do="open", text=text, name="pier.toml")
    before = session.there()["tilt"].collapse_acceleration_g
    assert before == pytest.approx(0.2), "it slides"
    do(session, do="blocks")
    free = session.there()
    assert free["tilt"].collapse_acceleration_g == pytest.approx(before)
    stones = free.deck.building.blocks()
    assert stones.mass.sum() == pytest.approx(1800.0 * 3.0 * 2.0) and "density" not in str(free.deck.data["structure"])


def test_a_block_tilted_beyond_its_capacity_falls_as_it_turns_about_its_toe(session: Session) -> None:
    """The fall on the page, by rigid contacts, against the equation of rotation about the toe from the same first velocity."""
    do(session, do="open", text='[structure]\nkind = "block"\nwidth = 1.0\nheight = 4.0\n[[analysis]]\nkind = "tilt"\n')
    (reply,) = do(session, do="show", gamma=-0.4)
    scene = reply.words["scene"]
    assert scene["falls"] == "minus"
    assert "0.4 g exceeds the capacity of 0.25 g towards −x" in scene["why"]
    pieces = do(session, do="fall")
    assert [reply.words["fall"]["done"] for reply in pieces] == [False] * (len(pieces) - 1) + [True]
    time = np.concatenate([reply.arrays["fall_time"] for reply in pieces])
    pose = np.concatenate([reply.arrays["fall_pose"] for reply in pieces])
    assert len(time) == 91 and time[-1] == pytest.approx(3.0, abs=0.02)
    gravity, theta, arm = 9.80665, np.arctan(-0.4), np.array([0.5, 2.0])  # of the centroid, from the left toe
    radius2 = float(arm @ arm)
    inertia = radius2 + (1.0 + 16.0) / 12.0
    turn = 0.0
    rate = 0.01 * np.sqrt(gravity * session.picture.assembly.size / radius2)
    step, found = 1e-4, [0.0]
    for _ in range(8000):
        x, y = np.cos(turn) * arm[0] - np.sin(turn) * arm[1], np.sin(turn) * arm[0] + np.cos(turn) * arm[1]
        rate += step * gravity * (-x * np.cos(theta) - y * np.sin(theta)) / inertia
        turn += step * rate
        found.append(turn)
    early = (time > 0.1) & (time < 0.8)
    expected = np.interp(time[early], step * np.arange(8001), found)
    np.testing.assert_allclose(pose[early, 0, 2], expected, rtol=0.02)
    assert abs(pose[-1, 0, 2] - np.pi / 2) < 0.02, "it lies on its side"


@pytest.mark.parametrize("preset", ["limit/arch-120", "vault/dejong-a"])
def test_what_is_needed_carries_the_acceleration_once_it_is_put_in(session: Session, preset: str) -> None:
    do(session, do="open", preset=preset)
    first = do(session, do="show")[-1].words["scene"]["capacity"]
    target = 1.3 * min(first["plus_g"], first["minus_g"])
    (reply,) = do(session, do="needed", acceleration=target)
    told = reply.words["needed"]
    assert not told["met"] and told["capacity_g"] == pytest.approx(min(first["plus_g"], first["minus_g"]), rel=1e-6)
    met = [one for one in told["interventions"] if one["met"]]
    assert met and any("ties" in one["changes"] for one in met) == (preset != "limit/arch-120"), "a flat arch needs thickness"
    for one in met:
        text = session.document.text
        after = do(session, do="set", changes=one["changes"])[-1].words["scene"]["capacity"]
        assert min(after["plus_g"], after["minus_g"]) >= target * (1 - 1e-9), one
        do(session, do="open", text=text, here="same")
    (reply,) = do(session, do="needed", acceleration=0.5 * target)
    assert reply.words["needed"]["met"] and not reply.words["needed"]["interventions"]


@pytest.mark.parametrize("given", [0.0, -1.0, "0.3 g", None, True, 1e9, float("nan")])
def test_a_wrong_acceleration_is_refused(session: Session, given: Any) -> None:
    (reply,) = do(session, do="needed", acceleration=given)
    assert "acceleration" in reply.words["bad"]


def test_drawn_blocks_are_a_deck_that_keeps_the_rest_of_it(session: Session) -> None:
    """A blank sheet has no model; blocks on it give their deck; in the deck at hand unchanged blocks stay as written."""
    (empty,) = do(session, do="draw", blocks=[], ground=[], fresh=True)
    assert "block" in empty.words["trouble"][0] and 'kind = "blocks"' in empty.words["draft"]
    assert 'kind = "arch"' in session.document.text, "the deck at hand stays"
    square = {"name": "pier", "points": [[0, 0], [1, 0], [1, 2], [0, 2]]}
    (first,) = do(session, do="draw", blocks=[square], ground=[], fresh=True)
    assert first.words["scene"]["capacity"]["plus_g"] == pytest.approx(0.5)
    text = session.document.text.replace('name = "pier"', 'name = "pier"  \ndensity = "1.8 t/m^3"  # weighed').replace("2.0", '"200 cm"')
    do(session, do="open", text=f"# mine\n{text}", here="same")
    (told,) = do(session, do="sheet")
    assert told.words["sheet"] == {"blocks": [square], "ground": []}
    top = {"name": "block 1", "points": [[0, 2], [1, 2], [1, 3], [0, 3]]}
    (second,) = do(session, do="draw", blocks=[square, top], ground=[[0, 0, 1, 0]])
    assert second.words["scene"]["capacity"]["plus_g"] == pytest.approx(1 / 3, rel=0.05)
    now = session.document.text
    assert now.startswith("# mine") and '"200 cm"' in now and '"1.8 t/m^3"  # weighed' in now and "ground = " in now
    (apart,) = do(session, do="draw", blocks=[square, {**top, "points": [[5, 2], [6, 2], [6, 3]]}], ground=[])
    assert "block 1" in apart.words["trouble"][0] and "ground" not in apart.words["draft"]
    assert session.document.text == now


TIED = """[structure]
kind = "arch"
radius = 5.0
thickness = 1.0
embrace = 180.0
voussoirs = 24

[joints]
friction = "no-sliding"
types = [{ joints = ["joint 0"], friction = 0.0 }]

[[ties]]
start = ["-500 cm", 0.0]   # at the springing
end = [5.0, 0.0]
start_stone = "voussoir 1"
end_stone = "voussoir 24"

[[analysis]]
kind = "tilt"
"""


def test_a_tie_is_dragged_and_the_capacity_follows(session: Session) -> None:
    """Handles of a tie: its height, its anchorages; a higher tie leaves less of the arch below it to open. The capacity is
    that of a run; an anchorage stays in the blocks."""
    (opened,) = do(session, do="open", text=TIED)
    assert {"tie-0-level", "tie-0-start", "tie-0-end"} <= session.handles.keys()
    capacities = [opened.words["scene"]["capacity"]["plus_g"]]
    for place in ([-4.9, 1.2], [-4.4, 2.4]):
        for which, x in (("start", place[0]), ("end", -place[0])):
            at = (np.array([x, place[1]]) - session.anchor).tolist()
            (reply,) = do(session, do="drag", handle=f"tie-0-{which}", to=at, ends=True)
            assert "complaints" not in reply.words and "limit" not in reply.words, reply.words.get("limit")
        capacities.append(reply.words["scene"]["capacity"]["plus_g"])
    text = session.document.text
    run = extrados.run(tomllib.loads(text))
    assert run["tilt"].collapse_acceleration_g == pytest.approx(capacities[-1], rel=1e-9)
    assert len({round(c, 6) for c in capacities}) == 3
    assert 'start_stone = "voussoir 1"' not in text and 'kind = "tilt"' in text
    (reply,) = do(session, do="drag", handle="tie-0-start", to=[0.0, 2.0], ends=True)
    assert "the anchorage of a tie must lie in a block" in reply.words["limit"]


def test_a_page_without_a_server_has_every_module_that_its_modules_import() -> None:
    for k, name in enumerate(standalone.MODULES):
        imported = re.findall(r'from "\./([\w]+\.js)"', (standalone.STATIC / name).read_text("utf-8"))
        assert set(imported) <= set(standalone.MODULES[:k]), name
