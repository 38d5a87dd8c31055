"""What is stored of a push: mesh, states and forces of piers as arrays and tables, fields as VTU."""

import numpy as np

from extrados.analyses.shell.measures import facing_of_walls, forces_of_walls
from extrados.analyses.shell.model import ShellModel
from extrados.analyses.shell.sections import cracks, place_axes, point_places, sections
from extrados.analyses.sla.events import Curve
from extrados.analyses.sla.kept import State
from extrados.results.model import Array, Result, TableData
from extrados.results.vtu import pvd, vtu

#: Of each integration point: values of `place_axes`, and of `point_places`
AXES = {"xyz": "position", "x_axis": "x axis of the element (unit vector)", "y_axis": "y axis of the element (unit vector)"}
PLACES = {
    "part": "number of its part, among the parts that resist bending, counted from 0",
    "wall": "number of the wall, counted from 0; -1: none",
    "s": "distance along the wall from its start; without a wall: x",
    "z": "height; without a wall: y",
    "storey": "number of the storey, counted from 1",
    "element": "number of its element in these parts, counted from 0",
}


def store_mesh(result: Result, model: ShellModel) -> None:
    """Nodes, elements of the walls and of the floors, and the places in the planes of the walls."""
    mesh = model.mesh
    result.arrays["node"] = Array(mesh.xyz, ("nodes", "axis"), "m", "nodes of the mesh")
    for k, part in enumerate(mesh.parts):
        corner = 3 if part.kind == "T3" else 4
        result.arrays[f"elements_{k}"] = Array(
            part.connect, (f"elements_of_{k}", f"corner_{corner}"), "", f"nodes of {part.name}, from 0", "elements"
        )
        result.arrays[f"wall_of_{k}"] = Array(
            np.array([part.wall]), ("one",), "", f"number of the wall to which {part.name} belongs, counted from 0; -1: none", "wall_of"
        )
        result.arrays[f"bends_{k}"] = Array(
            np.array([int(part.bends)]), ("one",), "", f"whether {part.name} resists bending; a floor does not", "bends"
        )
    walls = np.array([[*w.origin, *w.along, w.length] for w in mesh.walls]).reshape(-1, 5)
    result.arrays["wall"] = Array(
        walls, ("walls", "wall_row"), "m", "of each wall: x and y of its start, direction in plan (unit vector), and length"
    )
    result.arrays["level"] = Array(mesh.levels, ("levels",), "m", "heights of the ground and of the top of each storey")
    if not mesh.walls:
        for name, values in place_axes(model).items():
            unit = "m" if name == "xyz" else ""
            result.arrays[f"place_{name}"] = Array(
                values, ("places", "axis"), unit, f"for each integration point of the shells: {AXES[name]}"
            )
    for name, values in point_places(model).items():
        unit = "m" if name in "sz" else ""
        result.arrays[f"place_{name}"] = Array(values, ("places",), unit, f"for each integration point of the walls: {PLACES[name]}")


def store_seats(result: Result, model: ShellModel, curve: Curve, prefix: str) -> None:
    """How far floors have moved off their seats at each event."""
    if model.seats and len(curve.events):
        slips = np.column_stack([slip[:, 0] for slip in model.slips(curve.events.monitors)])
        result.arrays[f"{prefix}event_seat_slip"] = Array(
            slips, (f"{prefix}events", "seats"), "m", "for each seat: greatest displacement of the end of the floor away from it"
        )


def store_states(result: Result, model: ShellModel, curve: Curve, prefix: str) -> None:
    """Displacements, cracks and the forces of the piers of the kept states, and their fields as VTU."""
    if not curve.states:
        return
    states, dims = curve.states, (f"{prefix}states",)
    force = curve.force(model.unit)
    result.arrays[f"{prefix}state_event"] = Array(np.array([s.event + 1 for s in states]), dims, "", "event, from 1")
    result.arrays[f"{prefix}state_load"] = Array(force[[s.event for s in states]], dims, "N", "base shear")
    result.arrays[f"{prefix}state_displacement"] = Array(
        np.stack([s.displacement[:, :3] for s in states]), (*dims, "nodes", "axis"), "m", "displacements of the nodes"
    )
    if model.mesh.walls:
        result.arrays[f"{prefix}state_wall_shear"] = Array(
            np.stack([curve.sign * facing_of_walls(model) * forces_of_walls(model, sections(model, s.report))[0] for s in states]),
            (*dims, "walls"),
            "N",
            "in-plane shear force of each wall at its foot, along the load",
        )
    seen = [cracks(model, s.report) for s in states]
    for name, unit, about in (
        ("width", "m", "greatest crack width through the thickness"),
        ("angle", "rad", "direction of the crack normal in the wall"),
        ("part", "", "share of the thickness that has cracked"),
        ("side", "", ("position through the thickness of the greatest crack width: from -1 to 1, positive on the side of the normal")),
    ):
        result.arrays[f"{prefix}state_{name}"] = Array(np.stack([s[name] for s in seen]), (*dims, "places"), unit, about)
    _pier_table(result, model, curve, states, prefix)
    _fields(result, model, states, seen, prefix)


def _pier_table(result: Result, model: ShellModel, curve: Curve, states: list[State], prefix: str) -> None:
    state = next((s for s in states if s.event == curve.peak), states[-1])
    if not model.mesh.walls:
        return
    rows = sections(model, state.report)
    result.tables[f"piers_{prefix}".rstrip("_")] = TableData(
        {
            "wall": [model.mesh.walls[r.wall].name for r in rows],
            "storey": [r.storey for r in rows],
            "from": [r.start for r in rows],
            "to": [r.end for r in rows],
            "normal": [r.normal for r in rows],
            "shear": [r.shear for r in rows],
            "moment": [r.moment for r in rows],
        },
        {"from": "m", "to": "m", "normal": "N", "shear": "N", "moment": "N m"},
    )


def _fields(result: Result, model: ShellModel, states: list[State], seen: list[dict[str, np.ndarray]], prefix: str) -> None:
    """The states for ParaView; floors have no cracks."""
    name, series = f"fields_{prefix}".rstrip("_"), []
    walls = [part for part in model.mesh.parts if part.bends]
    cells = [(part.kind, part.connect) for part in [*walls, *(p for p in model.mesh.parts if not p.bends)]]
    element = point_places(model)["element"]
    count = sum(len(connect) for _, connect in cells)
    for state, crack in zip(states, seen, strict=True):
        width, part = np.zeros(count), np.zeros(count)
        np.maximum.at(width, element, crack["width"])
        np.maximum.at(part, element, crack["part"])
        file = f"{name}/event_{state.event + 1:06d}.vtu"
        result.files[file] = vtu(
            model.mesh.xyz, cells, {"displacement": state.displacement[:, :3]}, {"crack_width": width, "cracked_part": part}
        )
        series.append((state.event + 1, file))
    result.files[f"{name}.pvd"] = pvd(series)
