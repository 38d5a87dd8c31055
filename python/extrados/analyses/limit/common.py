"""What the drivers of limit analysis share: loads, refusals, arrays of geometry, lines and polygons."""

from typing import Any

import numpy as np

from extrados.analyses.context import Refused
from extrados.analyses.limit.tables import LimitAnalysisTable
from extrados.building.building import Building
from extrados.building.errors import BadGeometry
from extrados.building.geometry.assembly import Assembly
from extrados.building.rockers.arch import ArchModel
from extrados.building.templates.arch import ArchAssembly
from extrados.limit.answer import Answer, CannotStand, assess
from extrados.limit.equilibrium import Disconnected
from extrados.limit.fill import under_load
from extrados.limit.fracture import Fracture, NoCrack, fractured_collapse
from extrados.limit.lines import ThrustPath
from extrados.limit.loads import Loads, forces_at, tilt_loads
from extrados.limit.places import place_of
from extrados.limit.programme import Immovable, LimitAnalysis, NoAnswer, NoEquilibrium, State
from extrados.results.limit import Hinge, Reaction
from extrados.results.model import Array

#: Bounds and mechanism must agree this closely, relative to gamma, or the answer is not given.
GAP = 1e-8
#: Length over which a point load on earth presses [m]
CONTACT = 0.3


def chain_of(assembly: Assembly, name: str | None) -> str | None:
    """The chain of a name, the first where none is given, None where the assembly has no chain."""
    if name is not None and name not in assembly.chains:
        known = f"there are {', '.join(assembly.chains)}" if assembly.chains else "no stones form one here"
        raise Refused(f"chain: there is no '{name}'; {known}")
    return name or next(iter(assembly.chains), None)


def block_under(assembly: Assembly, x: float) -> tuple[int, float]:
    """The block with the highest surface at x, and that height [m]."""
    best, height = -1, -np.inf
    for i, outline in enumerate(assembly.outlines):
        x0, y0 = outline.T
        x1, y1 = np.roll(x0, -1), np.roll(y0, -1)
        met = (np.minimum(x0, x1) <= x) & (x <= np.maximum(x0, x1)) & (x0 != x1)
        if met.any():
            top = float((y0[met] + (x - x0[met]) / (x1[met] - x0[met]) * (y1[met] - y0[met])).max())
            if top > height:
                best, height = i, top
    if best < 0:
        low = min(float(o[:, 0].min()) for o in assembly.outlines)
        high = max(float(o[:, 0].max()) for o in assembly.outlines)
        raise Refused(
            f"a load at x = {x:.4g} m stands beside the structure, which reaches from {low:.4g} to {high:.4g} m"
        )
    return best, height


def loads_of(assembly: Assembly, options: Any) -> Loads:
    """Weight, fill and the point loads of an analysis; what sways is the weight and the fill."""
    loads = tilt_loads(assembly)
    extra = np.zeros_like(loads.dead)
    for load in getattr(options, "load", []):
        if assembly.earth is not None:
            extra += under_load(assembly.earth, len(extra), load.x, load.force, CONTACT)
            continue
        block, y = block_under(assembly, load.x)
        extra += forces_at(len(extra), block, np.array([load.x, y]), (0.0, -load.force))
    return loads.with_dead(extra)


def limit_of(building: Building, options: LimitAnalysisTable) -> LimitAnalysis:
    """The programmes of a building's stones under its joint laws."""
    assembly = building.blocks()
    try:
        return LimitAnalysis(
            assembly,
            building.friction(),
            strength=building.material.compressive_strength,
            associated=options.friction_rule == "associated",
            loads=loads_of(assembly, options),
        )
    except Disconnected as error:
        raise Refused(str(error)) from None


def answer_of(building: Building, options: LimitAnalysisTable) -> Answer:
    """The whole answer; Refused with the reason where the structure cannot stand."""
    assembly, limit = building.blocks(), limit_of(building, options)
    try:
        answer = assess(assembly, limit=limit)
    except CannotStand as error:
        if isinstance(assembly, ArchAssembly) and limit.strength is None and not options.load:
            _ = ArchModel(assembly).collapse  # refuses with the minimum thickness, if that is the reason
        raise Refused(f"the structure cannot stand under its own weight: {error}") from None
    except NoEquilibrium as error:
        raise Refused(str(error)) from None
    if answer.gap > GAP * max(1.0, abs(answer.gamma)):
        raise NoAnswer(f"the bounds from equilibrium and from the mechanism differ by {answer.gap:.2e} g")
    return answer


def fracture_of(building: Building, options: LimitAnalysisTable) -> Fracture | None:
    """Collapse to +x with the leeward buttress cracked; None where it does not crack."""
    assembly = building.blocks()
    if not assembly.buttresses:
        raise Refused("fracture needs a buttress that stands on the ground: a vault or an aisled vault")
    if building.material.compressive_strength is not None or options.friction_rule != "associated":
        raise Refused("fracture is computed without crushing and with associated friction")
    try:
        return fractured_collapse(
            assembly, assembly.buttresses[-1], 1, building.friction(), lambda cracked: loads_of(cracked, options)
        )
    except NoCrack as error:
        raise Refused(f"fracture: {error}") from None


def mended_capacity(building: Building, options: LimitAnalysisTable, gamma: float) -> str | None:
    """What a survey with open gaps would bear to +x if they were closed, in words beside its capacity gamma [g]; None
    where none is open."""
    if not building.told()[0] or building.structure is None:
        return None
    mended = building.structure.mended(building.folder)
    if mended is None:
        return None
    told = f'with all gaps closed (contact_tolerance = "{1e3 * mended.contact_tolerance:.3g} mm")'
    try:
        closed = limit_of(building.apart().having(structure=mended), options).collapse(1)[0].gamma
    except (BadGeometry, Refused, NoEquilibrium, NoAnswer, Immovable) as error:
        return f"{told} there is no capacity: {error}"
    return f"{told} it bears {closed:.4f} g to +x, {closed / gamma:.2f} times the {gamma:.4f} g told here"


def geometry_arrays(assembly: Assembly) -> dict[str, Array]:
    """What every picture of the structure needs."""
    outlines = [np.asarray(o) for o in assembly.outlines]
    return earth_arrays(assembly) | {
        "joint_p": Array(assembly.p, ("joint", "axis"), "m", "first ends of the joints (intrados)"),
        "joint_q": Array(assembly.q, ("joint", "axis"), "m", "second ends of the joints (extrados)"),
        "outline": Array(
            np.concatenate(outlines), ("vertex", "axis"), "m", "outlines of the blocks, one after the other"
        ),
        "outline_start": Array(
            np.cumsum([0, *map(len, outlines)]), ("block_edge",), "", "first vertex of each block, and the end"
        ),
        "centroid": Array(assembly.centroid, ("block", "axis"), "m", "centroids of the blocks"),
        "joint_block": Array(
            np.column_stack([assembly.a, assembly.b]),
            ("joint", "joint_side"),
            "",
            "blocks on both sides, -1 the ground",
        ),
    }


def earth_arrays(assembly: Assembly) -> dict[str, Array]:
    """Fill and surfacing as pictures show them; nothing without them."""
    earth = assembly.earth
    if earth is None:
        return {}
    line = np.column_stack([earth.line.start, earth.line.end]).reshape(-1, 2)
    left, right, low, high = line[0, 0], line[-1, 0], earth.formation, earth.road
    outline = np.concatenate([line, [[right, low], [left, low]]])
    made = {"fill_outline": Array(outline, ("fill_vertex", "axis"), "m", "outline of the fill")}
    if earth.surfacing > 0.0:
        made["surfacing_outline"] = Array(
            np.array([[left, low], [right, low], [right, high], [left, high]]), ("surfacing_vertex", "axis"), "m",
            "outline of the surfacing",
        )  # fmt: skip
    return made


def push_arrays(assembly: Assembly, loads: Loads, state: State) -> dict[str, Array]:
    """The passive pressures that a state mobilises: where they act and how much; nothing where none counts."""
    if loads.resistance is None or state.mobilised is None:
        return {}
    block, wrench = loads.resistance.block, loads.resistance.wrench
    at = np.column_stack([assembly.centroid[block, 0], -wrench[:, 2] / wrench[:, 0]])
    return {
        "push_point": Array(at, ("push", "axis"), "m", "where the fill pushes back"),
        "push_force": Array(state.mobilised * wrench[:, 0], ("push",), "N", "its horizontal push, to +x"),
        "push_most": Array(wrench[:, 0], ("push",), "N", "the most it can push, to +x"),
    }


def zone_arrays(assembly: Assembly, state: State, strength: float | None) -> dict[str, Array]:
    """The zone of thrust: the part of each joint, about the thrust line, that the strength [Pa] needs to carry it."""
    if strength is None:
        return {}
    half = 0.5 * state.normal / (strength * assembly.depth * assembly.length)
    along = assembly.q - assembly.p
    return {
        f"zone_{name}": Array(
            assembly.p + (state.position + sign * half)[:, None] * along, ("joint", "axis"), "m", f"{about} end of the zone of thrust"
        )
        for name, sign, about in (("inner", -1.0, "intrados"), ("outer", 1.0, "extrados"))
    }  # fmt: skip


def state_arrays(assembly: Assembly, name: str, state: State, about: str) -> dict[str, Array]:
    """A thrust line and its forces under names that begin with `name`."""
    return {
        f"{name}_point": Array(state.points(assembly), ("joint", "axis"), "m", f"thrust line {about}"),
        f"{name}_normal": Array(state.normal, ("joint",), "N", f"compression across the joints {about}"),
        f"{name}_shear": Array(state.shear, ("joint",), "N", f"shear along the joints {about}"),
        f"{name}_friction": Array(state.friction, ("joint",), "", f"coefficient of friction needed {about}"),
    }


def packed(name: str, paths: dict[str, np.ndarray], unit: str, about: str) -> dict[str, Array]:
    """Paths of different lengths one after the other: NAME, NAME_start and NAME_of (their names)."""
    points = np.concatenate(list(paths.values())) if paths else np.empty((0, 2))
    start = np.cumsum([0, *map(len, paths.values())])
    return {
        name: Array(points, (f"{name}_vertex", "axis"), unit, about),
        f"{name}_start": Array(start, (f"{name}_edge",), "", f"first vertex of each path of {name}, and the end"),
        f"{name}_of": Array(
            np.array(list(paths), dtype=object), (f"{name}_path",), "", f"names of the paths of {name}"
        ),
    }


def line_arrays(name: str, found: list[ThrustPath], about: str) -> dict[str, Array]:
    """Thrust lines through all stones, and the greatest force along each of their pieces."""
    points = [path.points for path in found] or [np.empty((0, 2))]
    title = f"{name}_line"
    return {
        title: Array(np.concatenate(points), (f"{title}_vertex", "axis"), "m", f"thrust lines {about}"),
        f"{title}_start": Array(
            np.cumsum([0, *(len(path.points) for path in found)]), (f"{title}_edge",), "", f"first vertex of each path of {title}, and the end"
        ),
        f"{title}_of": Array(
            np.array([path.name for path in found], dtype=object), (f"{title}_path",), "", f"the chain or stone of each path of {title}"
        ),
        f"{title}_force": Array(
            np.array([path.force for path in found]), (f"{title}_path",), "N", f"greatest force along each path of {title}"
        ),
    }  # fmt: skip


def graphic_arrays(answer: Answer, name: str, state: State, about: str) -> dict[str, Array]:
    """Thrust lines, funicular and force polygons of a state."""
    per_metre = {k: v / answer.assembly.depth for k, v in answer.polygons(state).items()}
    return {
        **line_arrays(name, answer.lines(state), about),
        **packed(f"{name}_funicular", answer.funiculars(state), "m", f"funicular polygons {about}"),
        **packed(f"{name}_polygon", per_metre, "N/m", f"rays of the force polygons {about}, per metre of depth"),
    }


def hinge_rows(assembly: Assembly, hinges: list[tuple[int, str]], pivot: np.ndarray) -> list[Hinge]:
    """Hinges as results tell them."""
    rows = []
    for j, side in hinges:
        x, y = assembly.p[j] + pivot[j] * (assembly.q[j] - assembly.p[j])
        place = place_of(assembly, j, np.array([x, y]))
        rows.append(Hinge(joint=j, side=side, name=assembly.joint_names[j], place=place, x_m=x, y_m=y))
    return rows


def reaction_rows(answer: Answer, state: State) -> list[Reaction]:
    """Forces of the ground on the structure."""
    return [
        Reaction(joint=j, name=answer.assembly.joint_names[j], horizontal_N=f[0], vertical_N=f[1])
        for j, f in answer.reactions(state).items()
    ]
