"""Joints drawn as gaps: closed in the middle of the mortar, blocks have the capacity of those that touch as drawn."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from test_noisy_solids import CLEAN, FRICTION, corner, obj, pushed

from extrados.analyses.context import Context
from extrados.analyses.sequence import run_analyses
from extrados.decks.reader import make_deck
from extrados.limit.programme import LimitAnalysis
from extrados.model.errors import BadGeometry
from extrados.model.geometry import polygons
from extrados.model.geometry.assembly import Assembly
from extrados.model.geometry.drawing import Drawing, Polygon
from extrados.model.geometry.inspection import inspect
from extrados.model.geometry.polygons import signed_area
from extrados.model.geometry.solids.assembly import SolidAssembly, Stone, assemble, with_closed_joints
from extrados.model.geometry.solids.meshes import read_obj, stones_of
from extrados.model.geometry.solids.polyhedra import Polyhedron, cut
from extrados.model.structures.arch import make_arch
from extrados.model.structures.blocks import assemble as section
from extrados.model.structures.brickwork import Bond, make_brickwork


def parted(made: Assembly, gap: float, seed: int | None = None) -> list[Polygon]:
    """The blocks of a section, cut half a gap away from each joint between two of them; with a seed by .3 to .7 of it."""
    rng = np.random.default_rng(seed)
    outlines = list(made.outlines)
    for p, q, a, b in zip(made.p, made.q, made.a.tolist(), made.b.tolist(), strict=True):
        if min(a, b) < 0:
            continue
        along = (q - p) / np.hypot(*(q - p))
        into = np.array([-along[1], along[0]])
        into *= np.sign((made.centroid[a] - p) @ into)
        share = 0.5 if seed is None else float(rng.uniform(0.3, 0.7))
        for block, normal, part in ((a, into, share), (b, -into, 1.0 - share)):
            outlines[block] = polygons.cut(outlines[block], p + part * gap * normal, normal)
    return [Polygon(name, outline) for name, outline in zip(made.block_names, outlines, strict=True)]


def parted_solids(made: SolidAssembly, gap: float) -> list[Stone]:
    """The blocks of an assembly of convex blocks, cut half a gap away from each contact between two of them."""
    parts: list[Polyhedron] = list(made.parts)
    for polygon, normal, a, b in zip(made.polygon, made.normal, made.a.tolist(), made.b.tolist(), strict=True):
        for block, into in ((a, normal), (b, -normal)):
            if b >= 0:
                kept = cut(parts[block], polygon[0] + 0.5 * gap * into, into)
                assert kept is not None
                parts[block] = kept
    return [Stone(name, [part], 2000.0) for name, part in zip(made.block_names, parts, strict=True)]


def collapse(made: Assembly) -> float:
    return float(LimitAnalysis(made, FRICTION).collapse()[0].gamma)


def wall() -> Assembly:
    return make_brickwork(Bond(length=0.6, height=0.25), 2.4, 1.5, [], 2000.0, 1.0)


@pytest.mark.parametrize("make", [lambda: make_arch(5.0, 0.8, 120.0, 15), wall], ids=["arch", "wall"])
@pytest.mark.parametrize(("seed", "within"), [(None, 1e-4), (1, 2e-2)])
def test_sections_with_joints_of_mortar(make: Any, seed: int | None, within: float) -> None:
    """Equal joints give the section as built; joints that are thicker on one side of their middle move it by millimetres."""
    made = make()
    ground = np.array([[*p, *q] for p, q, b in zip(made.p, made.q, np.minimum(made.a, made.b).tolist(), strict=True) if b < 0])
    drawing = Drawing(parted(made, 0.012, seed))
    closed = inspect(drawing, ground, 1e-4, mortar=0.013 if seed is None else 0.018)
    assert collapse(section(closed, 2000.0, 1.0)) == pytest.approx(collapse(made), rel=within)
    assert sum(map(signed_area, closed.outlines)) == pytest.approx(sum(map(signed_area, made.outlines)), rel=max(within, 1e-4))
    (said,) = closed.notes()[:1]
    assert "joints that are drawn as gaps of 12 " in said and "were closed (`mortar_gap` 1" in said and "middle of the mortar" in said
    assert 'if the joints contain mortar, give mortar_gap = "1' in inspect(drawing, ground, 1e-4).complaints()[0]


@pytest.mark.parametrize(("gap", "noise", "within"), [(0.010, 0.0, 1e-9), (0.015, 0.0, 1e-9), (0.010, 3e-4, 2e-3), (0.010, 1e-3, 3.5e-3)])
def test_a_corner_with_joints_of_mortar(gap: float, noise: float, within: float) -> None:
    """Twenty-eight blocks; the noise of a survey comes on top of the gaps."""
    tolerance = max(4.0 * noise, 1e-4)
    text = obj(parted_solids(assemble(corner()), gap), noise, 1)
    stones = stones_of(read_obj(text, "w.obj"), 2000.0, None, "w.obj", tolerance)
    grown, notes = with_closed_joints(stones, gap + 2.0 * noise, tolerance)
    made = assemble(grown, tolerance)
    assert len(made.a) == 55 and pushed(made, 90.0, 270.0) == pytest.approx(CLEAN, rel=within)
    assert made.mass.sum() == pytest.approx(assemble(corner()).mass.sum(), rel=1e-3)
    assert notes[0].startswith("48 joints that are drawn as gaps of ") and "The volume of the blocks increased by" in notes[0]
    growth = float(notes[0].partition("increased by ")[2].partition(" %")[0])
    assert 100.0 * gap < growth < 1000.0 * gap  # blocks of less than 1 m
    with pytest.raises(BadGeometry, match="touches neither another block"):
        assemble(with_closed_joints(stones, 0.5 * gap, tolerance)[0], tolerance)


def test_a_drawing_without_gaps_stays() -> None:
    stones = corner()
    made, notes = with_closed_joints(stones, 0.01, 1e-4)
    assert notes == ("`mortar_gap` 10 mm: no joint is drawn as a gap, so the key has no effect",)
    assert all((one.parts[0].vertices == two.parts[0].vertices).all() for one, two in zip(made, stones, strict=True))


def test_a_deck_of_stones_in_mortar(tmp_path: Path) -> None:
    (tmp_path / "wall.obj").write_text(obj(parted_solids(assemble(corner()), 0.01)))
    tables = {
        "structure": {"kind": "blocks", "file": "wall.obj", "mortar_gap": "10 mm"},
        "joints": {"friction": 0.65},
        "analysis": {"kind": "tilt", "direction": 90.0, "starts": 1, "rose": 4, "face_law": False, "block_size": False},
    }
    found = run_analyses(Context(make_deck(tables, tmp_path), threads=1))[0]
    assert found["collapse_acceleration_g"] == pytest.approx(CLEAN[0], rel=1e-6)
    assert sum("48 joints that are drawn as gaps of 10 mm were closed" in w for w in found.warnings) == 1
