"""Arrays of a frame that its figures need: the plan with piers, flanges, floors, rods and ring beams; the elements on the walls."""

import numpy as np

from extrados.results.model import Array
from extrados.views.frame.frame import EquivalentFrame

#: Number of a kind of element
KINDS = {"spandrel": 0, "pier": 1, "ring beam": 2}
FLOORS = {"none": 0, "flexible": 1, "rigid": 2, "joists": 3}
ROOFS = {None: 0, "rafters": 1, "trusses": 2, "purlins": 3}


def drawn_arrays(frame: EquivalentFrame) -> dict[str, Array]:
    """Arrays by their names."""
    plan = frame.plan
    holes = [
        (w, *o.x, plan.levels[o.storey - 1] + o.z[0], plan.levels[o.storey - 1] + o.z[1])
        for w, wall in enumerate(plan.walls)
        for o in wall.openings
    ]
    thick = [[_thickness(frame, w, storey) for storey in range(1, len(plan.storeys) + 1)] for w in range(len(plan.walls))]
    flanges = [(f.web, f.wall, f.level, f.start, f.end, f.weight) for f in frame.flanges]
    rods = [(*rod.start, *rod.end) for rod in plan.rods]
    beams = [(w, beam.storey) for beam in plan.ring_beams for w, wall in enumerate(plan.walls) if wall in plan.of_ring_beam(beam)]
    return {
        "element_part": Array(
            np.array([s.part for s in frame.strips]),
            ("element", "box"),
            "m",
            "deformable part of each element: start and end along the wall, lower and upper height",
        ),
        "element_wall": Array(np.array([s.wall for s in frame.strips]), ("element",), "", "number of the wall, counted from 0"),
        "element_storey": Array(
            np.array([s.storey for s in frame.strips]),
            ("element",),
            "",
            "storey of a pier; for a spandrel or ring beam, the storey below it",
        ),
        "element_kind": Array(
            np.array([KINDS[s.kind] for s in frame.strips]), ("element",), "", ", ".join(f"{n}: {word}" for word, n in KINDS.items())
        ),
        "wall_length": Array(np.array([w.length for w in plan.walls]), ("wall",), "m", "lengths of the walls"),
        "wall_height": Array(np.array([plan.levels[plan.reach(w)[1]] for w in plan.walls]), ("wall",), "m", "heights of the walls"),
        "wall_line": Array(np.array([[*w.start, *w.end] for w in plan.walls]), ("wall", "line"), "m", "x, y of start and end on the plan"),
        "wall_thickness": Array(np.array(thick), ("wall", "storey"), "m", "thickness in each storey; 0: no wall in this storey"),
        "storey_height": Array(np.array(plan.storeys), ("storey",), "m", "heights of the storeys"),
        "opening": Array(
            np.array(holes).reshape(-1, 5),
            ("opening", "box"),
            "m",
            "number of the wall, start and end along the wall, lower and upper height",
        ),
        "gable": Array(
            np.array([(w, s, z) for w, wall in enumerate(plan.walls) for s, z in wall.gable_outline[1:2]]).reshape(-1, 3),
            ("gable", "part"),
            "m",
            "number of the wall, distance of the ridge from its start, height of the ridge above the top of the wall",
        ),
        "flange": Array(
            np.array(flanges).reshape(-1, 6),
            ("flange", "part"),
            "m",
            "wall of the web, wall of the flange, level, start and end along the flange [m], weight on the flange [N]",
        ),
        "rod": Array(np.array(rods).reshape(-1, 6), ("rod", "line"), "m", "x, y, z of both ends of tie rods"),
        "ring_beam": Array(np.array(beams).reshape(-1, 2), ("ring_beam", "part"), "", "wall, level"),
        "floor": Array(np.array([_floor(frame, k) for k in range(len(plan.floors))]).reshape(-1, 8), ("floor", "part"), "m", FLOOR),
    }


FLOOR = (
    "storey, kind ("
    + ", ".join(f"{n}: {word}" for word, n in FLOORS.items())
    + "), x and y of the middle of the floor, direction of the joists or of the span of a roof, kind of roof ("
    + ", ".join(f"{n}: {word or 'none'}" for word, n in ROOFS.items())
    + "), pitch [deg]"
)


def _thickness(frame: EquivalentFrame, w: int, storey: int) -> float:
    wall = frame.plan.walls[w]
    first, last = frame.plan.reach(wall)
    if not first <= storey <= last:
        return 0.0
    return frame.plan.thickness_of(wall, storey)


def _floor(frame: EquivalentFrame, k: int) -> tuple[float, ...]:
    plan, floor = frame.plan, frame.plan.floors[k]
    x, y = plan.outline(plan.around(floor)).mean(axis=0).tolist()
    along = plan.wall(floor.bears_on[0]).direction if floor.kind == "joists" or floor.roof else np.zeros(2)
    roof = float(ROOFS[floor.roof]), floor.pitch or 0.0
    return (float(floor.storey), float(FLOORS[floor.kind]), x, y, float(-along[1]), float(along[0]), *roof)
