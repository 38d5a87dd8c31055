"""Sections drawn in the planes xz and yz of a model in space: DXF, OBJ."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from test_noisy_solids import obj

from extrados.limit.programme import LimitAnalysis
from extrados.model.errors import BadGeometry, NoView
from extrados.model.geometry.polygons import following
from extrados.model.geometry.solids.assembly import Stone
from extrados.model.geometry.solids.polyhedra import prism
from extrados.model.structures.arch import make_arch
from extrados.model.structures.blocks import Blocks

ezdxf = pytest.importorskip("ezdxf")
ARCH = make_arch(5.0, 0.8, 120.0, 9)
GROUND = [[*ARCH.p[0].tolist(), *ARCH.q[0].tolist()], [*ARCH.p[-1].tolist(), *ARCH.q[-1].tolist()]]
TRUE = LimitAnalysis(ARCH, 0.65).collapse()[0].gamma
PLANES = {"xy": [0, 1], "xz": [0, 2], "yz": [1, 2]}


def placed(outline: np.ndarray, plane: str, across: float = 3.0) -> np.ndarray:
    places = np.full((len(outline), 3), across)
    places[:, PLANES[plane]] = outline
    return places


def draw_dxf(path: Path, plane: str, how: str) -> str:
    document = ezdxf.new("R2010", units=6)
    space = document.modelspace()
    for outline in ARCH.outlines:
        places = placed(outline, plane)
        if how == "lines":
            for a, b in zip(places, following(places), strict=True):
                space.add_line(a, b)
        elif how == "polyline":
            space.add_polyline3d(places.tolist(), close=True)
        else:  # in its own plane, as CAD writes a plane figure
            way = {"xy": (0, 0, 1), "xz": (0, -1, 0), "yz": (1, 0, 0)}[plane]
            flat = ezdxf.math.OCS(way).points_from_wcs(places.tolist())
            space.add_lwpolyline([(p.x, p.y) for p in flat], close=True, dxfattribs={"extrusion": way, "elevation": 3.0})
    document.saveas(path)
    return path.name


def capacity(folder: Path, **keys: Any) -> tuple[float, Blocks, list[str]]:
    blocks = Blocks(kind="blocks", ground=GROUND, **keys)
    inspection = blocks.inspection(folder)
    made = blocks.assembly(2000.0, folder)
    return LimitAnalysis(made, 0.65).collapse()[0].gamma, blocks, inspection.notes() if inspection else []


@pytest.mark.parametrize("how", ["lines", "polyline", "lwpolyline"])
@pytest.mark.parametrize("plane", list(PLANES))
def test_a_section_of_a_drawing_in_space(tmp_path: Path, plane: str, how: str) -> None:
    gamma, _, notes = capacity(tmp_path, file=draw_dxf(tmp_path / "arch.dxf", plane, how))
    assert gamma == pytest.approx(TRUE, rel=1e-4)
    assert any(f"the section lies in the plane {plane}: {plane[0]} is horizontal, z is vertical" in n for n in notes) == (plane != "xy")


def test_a_drawing_that_is_not_plane_says_what_it_projects(tmp_path: Path) -> None:
    document = ezdxf.new("R2010", units=6)
    for shift in (0.0, 2.0):  # the section and a second one behind it
        document.modelspace().add_polyline3d([(x, shift, z) for x, z in ((0, 0), (1, 0), (1, 3 + shift), (0, 3))][:4], close=True)
    document.saveas(tmp_path / "two.dxf")
    blocks = Blocks(kind="blocks", file="two.dxf", section="yz", block=None)
    with pytest.raises(BadGeometry):
        blocks.assembly(2000.0, tmp_path)  # edge on: lines
    notes = Blocks(kind="blocks", file="two.dxf", section="xz").inspection(tmp_path).notes()  # type: ignore[union-attr]
    assert any("lines are projected to the plane xz, although along y they extend over 2 units" in note for note in notes)


@pytest.mark.parametrize("plane", list(PLANES))
@pytest.mark.parametrize("named", [True, False])
def test_faces_of_an_obj_in_a_plane(tmp_path: Path, plane: str, named: bool) -> None:
    lines, first = [], 1
    for k, outline in enumerate(ARCH.outlines):
        lines += [f"o voussoir {k}"] * named + ["v " + " ".join(map(repr, p)) for p in placed(outline, plane).tolist()]
        lines.append("f " + " ".join(str(first + i) for i in range(len(outline))))
        first += len(outline)
    (tmp_path / "arch.obj").write_text("\n".join(lines))
    gamma, blocks, notes = capacity(tmp_path, file="arch.obj")
    assert gamma == pytest.approx(TRUE, rel=1e-4) and f"9 blocks, drawn in the plane {plane}" in notes[0]
    assert blocks.assembly(2000.0, tmp_path).block_names[3] == ("voussoir 3" if named else "block 4")


def test_prisms_of_an_obj_across_a_plane(tmp_path: Path) -> None:
    """Solids of one depth: a section with the key, and solids without it."""
    turn = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])  # y of the section is z of the file
    chords = [np.array([o[0], o[6], o[7], o[13]]) for o in ARCH.outlines]
    stones = [Stone(f"voussoir {k}", [prism(o, 0.0, 1.5).moved(turn)], 2000.0) for k, o in enumerate(chords)]
    (tmp_path / "arch.obj").write_text(obj(stones, triangles=True))
    gamma, blocks, notes = capacity(tmp_path, file="arch.obj", section="xz")
    assert gamma == pytest.approx(TRUE, rel=1e-2) and "9 prisms, section in the plane xz" in notes[0]
    assert blocks.assembly(2000.0, tmp_path).depth == pytest.approx(1.5)
    with pytest.raises(NoView):
        Blocks(kind="blocks", file="arch.obj").assembly(2000.0, tmp_path)
    with pytest.raises(BadGeometry, match="not prisms perpendicular to the plane yz: voussoir 0, "):
        Blocks(kind="blocks", file="arch.obj", section="yz").assembly(2000.0, tmp_path)
