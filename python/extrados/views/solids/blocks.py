"""The blocks of a file in space."""

from dataclasses import replace

import numpy as np

from extrados.model.errors import BadGeometry, NoView
from extrados.model.files import LARGEST_FILE, read
from extrados.model.geometry.clouds import read_cloud
from extrados.model.geometry.compas import is_compas, read_compas
from extrados.model.geometry.drawing import UNITS, parsed
from extrados.model.geometry.solids.assembly import SolidAssembly, assemble, with_closed_joints
from extrados.model.geometry.solids.flat import flat_plane
from extrados.model.geometry.solids.meshes import read_meshes, read_solids, stones_of, without_doubles
from extrados.model.structures.blocks import SMALL, SOLID, Blocks
from extrados.views.blocks import Masonry
from extrados.views.solids.sections import solids_of_section

Y_FORMATS = (".glb", ".gltf")  # by their standard
#: Axes of a file whose y points up
Y_UP = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])


def solids_of_blocks(building: Masonry) -> SolidAssembly:
    """The solids of a file, or the section that it draws, drawn out to its depth."""
    drawing = building.structure
    assert isinstance(drawing, Blocks)
    value = None
    file = None if drawing.file is None else read(drawing.file, LARGEST_FILE, building.folder)
    sort = "" if file is None else file.path.suffix.lower()
    if file is not None and sort == ".json":
        value = parsed(file)
    if file is not None and drawing.scan is not None:
        points = read_cloud(file, UNITS[drawing.unit or "m"])
        points = points @ Y_UP.T if drawing.up == "y" else points
        return drawing.scan.solids(points, building.material.density, file.path.name)
    if file is None or not (sort in SOLID or is_compas(value)):
        if drawing.up is not None:
            raise BadGeometry("the key `up` is only for files of solids (OBJ, STL, COMPAS JSON)", ("structure", "up"))
        return solids_of_section(building)
    name = file.path.name
    meshes = read_meshes(file) if sort in SOLID else read_solids(value, name)
    if sort in SOLID and (drawing.section is not None or flat_plane(meshes)):
        return solids_of_section(building)
    if drawing.layers is not None or drawing.layer or drawing.ground is not None or drawing.origin is not None:
        raise BadGeometry(
            f"{name}: the keys `layers`, `ground` and `origin` are only for plane drawings; the supports of "
            "solids are given by `foundation_levels`"
        )
    if drawing.fill is not None:
        raise BadGeometry(f"{name}: the key `fill` is only for plane drawings", ("structure", "fill"))
    if (drawing.up or ("y" if sort in Y_FORMATS else "z")) == "y":
        meshes = [replace(mesh, points=mesh.points @ Y_UP.T) for mesh in meshes]
    tolerance = drawing.contact_tolerance
    if "contact_tolerance" not in drawing.model_fields_set:
        points = np.concatenate([mesh.points for mesh in meshes])
        tolerance = min(tolerance, SMALL * UNITS[drawing.unit or "m"] * float(np.ptp(points, axis=0).max()))
    try:
        stones = stones_of(meshes, building.material.density, drawing.unit, name, tolerance)
    except BadGeometry as error:
        try:  # prisms of one depth may be concave: their section is parted in convex pieces
            whole = value is not None and read_compas(value, name, drawing.unit)[1] is not None
        except NoView:
            whole = False
        if not whole:
            raise error from None
        return solids_of_section(building)
    single, remarks = without_doubles(stones, tolerance)
    notes: tuple[str, ...] = ()
    if drawing.mortar_gap is not None:
        single, notes = with_closed_joints(single, drawing.mortar_gap, tolerance)
    made = assemble(single, tolerance, drawing.foundation_levels, name)
    return replace(made, remarks=(*remarks, *made.remarks), notes=(*notes, *made.notes))
