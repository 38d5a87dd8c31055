"""glTF and IFC as blocks: the corner of the other formats."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from test_noisy_solids import CLEAN, corner, pushed

from extrados.decks.reader import DeckError, make_deck
from extrados.model.errors import BadGeometry
from extrados.model.geometry.solids.assembly import SolidAssembly
from extrados.model.geometry.solids.models import parse_model
from extrados.views.building import Building


def solids(folder: Path, file: str, **keys: Any) -> SolidAssembly:
    tables = {"structure": {"kind": "blocks", "file": file, **keys}, "analysis": {"kind": "tilt", "direction": 90.0}}
    (building,) = make_deck(tables, folder).buildings
    assert isinstance(building, Building)
    return building.solids()


def glb(path: Path, sort: str) -> str:
    """Each block in a node of its own, moved by the matrix of the node; y is up, as glTF has it."""
    trimesh = pytest.importorskip("trimesh")
    scene = trimesh.Scene()
    for stone in corner():
        (part,) = stone.parts
        middle = part.vertices.mean(axis=0)
        local = (part.vertices - middle) @ np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])
        place = np.eye(4)
        place[:3, 3] = middle[0], middle[2], -middle[1]
        mesh = trimesh.Trimesh(local, part.triangles, process=False)
        scene.add_geometry(mesh, node_name=stone.name, geom_name=f"mesh of {stone.name}", transform=place)
    if sort == "glb":
        path.write_bytes(scene.export(file_type="glb"))
    else:
        path.write_bytes(trimesh.exchange.gltf.export_gltf(scene, embed_buffers=True)["model.gltf"])
    return path.name


@pytest.mark.parametrize("sort", ["glb", "gltf"])
def test_a_gltf_of_blocks(tmp_path: Path, sort: str) -> None:
    made = solids(tmp_path, glb(tmp_path / f"wall.{sort}", sort))
    assert set(made.block_names) == {stone.name for stone in corner()}
    assert len(made.a) == 55 and pushed(made, 90.0, 270.0) == pytest.approx(CLEAN, rel=1e-5)


def ifc(path: Path) -> str:
    """Each block as a proxy with an extruded rectangle, in millimetres."""
    ifcopenshell = pytest.importorskip("ifcopenshell")
    api = pytest.importorskip("ifcopenshell.api")
    model = api.run("project.create_file")
    api.run("root.create_entity", model, ifc_class="IfcProject")
    api.run("unit.assign_unit", model)
    context = api.run("context.add_context", model, context_type="Model")
    body = api.run("context.add_context", model, context_type="Model", context_identifier="Body", target_view="MODEL_VIEW", parent=context)
    for stone in corner():
        low, high = (1e3 * end(stone.parts[0].vertices, axis=0) for end in (np.min, np.max))
        size = (high - low).tolist()
        point = model.createIfcCartesianPoint
        profile = model.createIfcRectangleProfileDef(
            "AREA", None, model.createIfcAxis2Placement2D(point([0.5 * size[0], 0.5 * size[1]])), size[0], size[1]
        )
        place = model.createIfcAxis2Placement3D(point(low.tolist()))
        solid = model.createIfcExtrudedAreaSolid(profile, place, model.createIfcDirection([0.0, 0.0, 1.0]), size[2])
        element = api.run("root.create_entity", model, ifc_class="IfcBuildingElementProxy", name=stone.name)
        shape = model.createIfcShapeRepresentation(body, "Body", "SweptSolid", [solid])
        element.Representation = model.createIfcProductDefinitionShape(None, None, [shape])
    assert ifcopenshell and len(model.by_type("IfcBuildingElementProxy")) == 28
    model.write(str(path))
    return path.name


def test_an_ifc_of_blocks(tmp_path: Path) -> None:
    made = solids(tmp_path, ifc(tmp_path / "wall.ifc"))
    assert set(made.block_names) == {stone.name for stone in corner()}
    assert len(made.a) == 55 and pushed(made, 90.0, 270.0) == pytest.approx(CLEAN, rel=1e-5)


def test_elements_of_one_name_remain_blocks_of_their_own(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whichever names come first: none is lost or overwritten."""
    stones = [stone.parts[0].vertices[np.array(stone.parts[0].triangles)] for stone in corner()[:4]]
    for names in (["Stone", "Stone", "Stone (2)", "Stone"], ["Stone (2)", "Stone", "Stone", "Stone (2)"]):
        rows = list(zip(names, stones, strict=True))
        monkeypatch.setattr("extrados.model.geometry.solids.models._elements", lambda _, rows=rows: iter(rows))
        found = parse_model(b"", "wall.ifc", ".ifc")
        assert len({mesh["stone"] for mesh in found}) == 4
        for mesh, stone in zip(found, stones, strict=True):
            assert np.ptp(mesh["points"], axis=0) == pytest.approx(np.ptp(stone.reshape(-1, 3), axis=0))
            assert mesh["points"].min(axis=0) == pytest.approx(stone.reshape(-1, 3).min(axis=0), abs=1e-9)


@pytest.mark.parametrize("name", ["wall.glb", "WALL.GLTF", "wall.ifc"])
def test_a_unit_is_refused_of_models_in_metres(tmp_path: Path, name: str) -> None:
    for section in ({}, {"section": "xz"}):
        with pytest.raises(DeckError, match=r"unit: .*Remove `unit`"):
            solids(tmp_path, name, unit="mm", **section)


@pytest.mark.parametrize(("name", "content"), [("a.glb", b"glTF\x02\x00\x00\x00"), ("a.gltf", b"{}"), ("a.ifc", b"ISO-10303-21;")])
def test_what_is_no_model_is_refused_with_its_name(tmp_path: Path, name: str, content: bytes) -> None:
    pytest.importorskip("ifcopenshell" if name.endswith("ifc") else "trimesh")
    (tmp_path / name).write_bytes(content)
    with pytest.raises(BadGeometry, match=name):
        solids(tmp_path, name)
