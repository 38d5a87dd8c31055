"""What the drivers of limit analysis share: loads, refusals, arrays of geometry, lines and polygons."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, Literal

import numpy as np

from extrados.analyses.context import Refused
from extrados.analyses.limit.applied import pieces
from extrados.analyses.limit.needs import refuse_fracture
from extrados.analyses.limit.tables import AppliedLoad, LimitAnalysisTable
from extrados.limit.answer import Answer, assess
from extrados.limit.equilibrium import Disconnected
from extrados.limit.errors import CannotStand
from extrados.limit.fill import passive_pressure, under_load
from extrados.limit.fracture import Fracture, NoCrack, fractured_collapse
from extrados.limit.lines import ThrustPath
from extrados.limit.loads import Loads, forces_at, tilt_loads
from extrados.limit.places import place_of
from extrados.limit.programme import Immovable, LimitAnalysis, Mechanism, NoAnswer, NoEquilibrium, State, closed
from extrados.limit.resistance import Resistance, together
from extrados.limit.ties import pulls, tensions
from extrados.model.errors import WHOLE, BadGeometry
from extrados.model.geometry.assembly import GROUND, Assembly
from extrados.model.structures.blocks import Blocks
from extrados.results.fields import Keys
from extrados.results.limit import Hinge, Reaction, Side, TieForce
from extrados.results.model import Array
from extrados.schema.quantities import three_figures
from extrados.views.building import Building

#: Length over which a point load on earth presses [m]
CONTACT = 0.3
#: Of its yield force, or of the weight: less in a tie is none
SLACK = 1e-6
MOST_TIES = 6  # told in words
MOST_BESIDE = 400  # joints up to which a state without dilatancy is sought beside an upper bound: a few seconds


def ties_of(building: Building, scale: float) -> Resistance | None:
    """The pulls of the ties of a building; those that never yield have `scale` [N] for a whole. None without ties."""
    ties = building.ties
    return pulls(building.anchored(), [t.least for t in ties], [t.most for t in ties], scale) if ties else None


def loads_of(assembly: Assembly, options: Any, building: Building) -> Loads:
    """Weight, fill, the loads of an analysis and the ties of a building, on its stones, which `assembly` may vary; what
    sways is the weight, the fill and the loads that say so."""
    loads = tilt_loads(assembly)
    dead, live = np.zeros_like(loads.dead), np.zeros_like(loads.live)
    for k, load in enumerate(getattr(options, "load", [])):
        earth = assembly.earth if load.y is None and load.force != 0.0 else None
        if earth is not None:
            middle, length = (load.x, CONTACT) if load.x_end is None else (0.5 * (load.x + load.x_end), load.x_end - load.x)
            dead += under_load(earth, len(dead), middle, load.force, length)
        for block, point, share in pieces(assembly, load, k):
            down = 0.0 if earth is not None else -share * load.force
            dead += forces_at(len(dead), block, point, (share * load.horizontal, down))
            if load.sways:
                live += forces_at(len(live), block, point, (share * load.force, 0.0))
    loads = replace(loads, dead=loads.dead + dead, live=loads.live + live)
    if building.ties:  # their shares are of the whole load
        held = frozenset(building.anchored().block.ravel().tolist()) - {GROUND}
        loads = replace(loads, resistance=together(loads.resistance, ties_of(building, loads.scale)), tied=held)
    return loads


def limit_of(building: Building, options: LimitAnalysisTable, *, forces_only: bool = False) -> LimitAnalysis:
    """The programmes of a building's stones under its joint laws; forces_only: where no motion is asked for, so that how
    sliding dilates does not matter."""
    assembly = building.blocks()
    building.refuse_weightless()
    try:
        return LimitAnalysis(
            assembly,
            building.friction(),
            strength=building.material.compressive_strength,
            associated=forces_only or options.friction_rule == "associated",
            loads=loads_of(assembly, options, building),
            starts=options.starts,
        )
    except Disconnected as error:
        raise Refused(str(error), WHOLE) from None


def answer_of(building: Building, options: LimitAnalysisTable, limit: LimitAnalysis | None = None, threads: int = 1) -> Answer:
    """The whole answer; CannotStand where a certificate proves that the structure collapses under its own weight."""
    assembly, limit = building.blocks(), limit or limit_of(building, options)
    try:
        answer = assess(assembly, limit=limit, threads=threads)
    except CannotStand as proof:
        if mended := mended_capacity(building, options, 0.0):
            raise CannotStand(f"{proof}; {mended}", proof.motion, proof.neglects) from None
        raise
    except NoEquilibrium as error:
        raise Refused(str(error), WHOLE) from None
    if limit.associated and answer.gap > closed(len(assembly.a), answer.gamma):
        raise NoAnswer(f"the lower bound (from equilibrium) and the upper bound (from a mechanism) differ by {answer.gap:.2e} g")
    return answer


def collapse_beside(without_dilatancy: LimitAnalysis, direction: int) -> tuple[State, Mechanism]:
    """The least state without dilatancy, to be given beside an upper bound by associated friction; NoAnswer of large structures."""
    if len(without_dilatancy.assembly.a) > MOST_BESIDE:
        raise NoAnswer(
            f"the structure has more than {MOST_BESIDE} joints, so collapse without dilatancy is calculated only with "
            'friction_rule = "non-associated"'
        )
    return without_dilatancy.collapse(direction)


def fracture_of(building: Building, options: LimitAnalysisTable) -> Fracture | None:
    """Collapse to +x with the leeward buttress cracked; None where it does not crack."""
    refuse_fracture(building, options)
    assembly = building.blocks()
    leeward = assembly.buttresses[-1]
    try:
        return fractured_collapse(assembly, leeward, 1, building.friction(), lambda cracked: loads_of(cracked, options, building))
    except NoCrack as error:
        raise Refused(f"fracture: {error}", ("analysis", "fracture")) from None


def mended_capacity(building: Building, options: LimitAnalysisTable, gamma: float) -> str | None:
    """What a survey with open gaps would carry to +x if they were closed, in words beside its capacity gamma [g]; None
    where none is open."""
    if not building.told()[0] or building.structure is None:
        return None
    mended = building.structure.mended(building.folder)
    if not isinstance(mended, Blocks):
        return None
    told = f'with all gaps closed (contact_tolerance = "{1e3 * mended.contact_tolerance:.3g} mm")'
    try:
        closed_g = limit_of(building.apart().having(structure=mended), options).collapse(1)[0].gamma
    except (BadGeometry, Refused, NoEquilibrium, NoAnswer, Immovable) as error:
        return f"{told} the structure has no capacity: {error}"
    text = f"{told} the collapse acceleration to +x is {closed_g:.4f} g"
    return f"{text}, which is {closed_g / gamma:.2f} times the {gamma:.4f} g of the given geometry" if gamma > 0.0 else text


def geometry_arrays(assembly: Assembly) -> dict[str, Array]:
    """What every picture of the structure needs."""
    outlines = [np.asarray(o) for o in assembly.outlines]
    return earth_arrays(assembly) | {
        "joint_p": Array(assembly.p, ("joint", "axis"), "m", "first end of each joint (at the intrados of an arch)"),
        "joint_q": Array(assembly.q, ("joint", "axis"), "m", "second end of each joint (at the extrados of an arch)"),
        "outline": Array(np.concatenate(outlines), ("vertex", "axis"), "m", "outlines of the blocks, one after the other"),
        "outline_start": Array(
            np.cumsum([0, *map(len, outlines)]),
            ("block_edge",),
            "",
            "index of the first vertex of each block; the last value is the number of all vertices",
        ),
        "centroid": Array(assembly.centroid, ("block", "axis"), "m", "centroids of the blocks"),
        "joint_block": Array(
            np.column_stack([assembly.a, assembly.b]),
            ("joint", "joint_side"),
            "",
            "numbers of the two blocks at each joint; -1 is the ground",
        ),
        **named_places("joint", assembly.joint_names, 0.5 * (assembly.p + assembly.q), "middles of the joints"),
        **named_places("block", assembly.block_names, assembly.centroid, "centroids of the blocks"),
    }


def named_places(dim: str, names: Sequence[str], places: np.ndarray, about: str) -> dict[str, Array]:
    """What the places (n, 2 or 3) [m] along an axis are called and where they lie: its coordinates, by results.store.beside."""
    found = {f"{dim}_name": Array(np.array(names, dtype=object), (dim,), "", f"names of the {dim}s")}
    return found | {
        f"{dim}_{axis}": Array(values, (dim,), "m", f"{axis} of the {about}") for axis, values in zip("xyz", places.T, strict=False)
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
            np.array([[left, low], [right, low], [right, high], [left, high]]),
            ("surfacing_vertex", "axis"),
            "m",
            "outline of the surfacing",
        )
    return made


def load_arrays(assembly: Assembly, loads: Sequence[AppliedLoad]) -> dict[str, Array]:
    """The loads of an analysis at rest as figures show them, spread ones in pieces; nothing without them."""
    point, force, whole = [], [], []
    for k, load in enumerate(loads):
        for _, at, share in pieces(assembly, load, k):
            point.append(at)
            force.append((share * load.horizontal, -share * load.force))
            whole.append(k)
    if not point:
        return {}
    return {
        "load_point": Array(
            np.array(point),
            ("load_piece", "axis"),
            "m",
            "points at which the constant loads act; a distributed load is divided into pieces",
        ),
        "load_force": Array(np.array(force), ("load_piece", "axis"), "N", "constant load at each point, horizontal (to +x) and upward"),
        "load_number": Array(np.array(whole), ("load_piece",), "", "number of the load in the deck, counted from 0"),
    }


def push_arrays(assembly: Assembly, state: State) -> dict[str, Array]:
    """The passive pressures that a state mobilises: where they act and how much; nothing where none counts."""
    earth = assembly.earth
    push = None if earth is None else passive_pressure(earth, assembly.depth, assembly.centroid)
    if push is None:
        return {}
    most = push.wrench[:, 0]
    return {
        "push_point": Array(push.point, ("push", "axis"), "m", "points at which the passive pressure of the fill acts"),
        "push_force": Array(
            state.mobilised[: push.count] * most, ("push",), "N", "horizontal force of the passive pressure at each point, to +x"
        ),
        "push_most": Array(most, ("push",), "N", "greatest horizontal force of the passive pressure at each point, to +x"),
    }


def tie_rows(building: Building, loads: Loads, state: State, key: str = "ties") -> Keys:
    """What a state asks of the ties, under a key of results; nothing without ties."""
    if not building.ties:
        return {}
    rows = []
    for tie, force in zip(building.ties, _tensions(building, loads, state), strict=True):
        least = SLACK * (tie.yield_force or loads.scale)
        yields = tie.yield_force is not None and abs(force) > tie.yield_force - least
        sort: Literal["slack", "carries", "yields"] = "yields" if yields else "slack" if abs(force) < least else "carries"
        rows.append(TieForce(name=tie.name or "", force_N=force, state=sort))
    return {key: rows}


def tie_arrays(building: Building, loads: Loads, states: dict[str, State]) -> dict[str, Array]:
    """The ties as figures show them, with their forces in each of the states; nothing without ties."""
    if not building.ties:
        return {}
    forces = {
        f"{name}_tie_force": Array(_tensions(building, loads, state), ("tie",), "N", f"tension of the ties, state '{name}'")
        for name, state in states.items()
    }
    anchored = building.anchored()
    return {
        "tie_point": Array(anchored.point, ("tie", "tie_end", "axis"), "m", "both ends of the ties"),
        "tie_block": Array(anchored.block, ("tie", "tie_end"), "", "numbers of the blocks at the two ends of each tie; -1 is the ground"),
        **forces,
    }


def _tensions(building: Building, loads: Loads, state: State) -> np.ndarray:
    assert loads.resistance is not None
    return tensions(loads.resistance, state.mobilised, len(building.ties))


def spoken_ties(rows: list[TieForce] | None) -> str:
    """The forces of the ties in a sentence, with a blank before; "" without ties."""
    if not rows:
        return ""
    words = {"yields": "{name} yields at {force}", "slack": "{name} is slack", "carries": "{name} carries {force}"}
    told = [
        words[r.state].format(
            name=r.name, force=f"{three_figures(abs(r.force_N) / 1e3)} kN in {'tension' if r.force_N > 0.0 else 'compression'}"
        )
        for r in rows[:MOST_TIES]
    ]
    text = ", ".join(told) + (f" and {len(rows) - MOST_TIES} more" if len(rows) > MOST_TIES else "")
    return f" {text[:1].upper()}{text[1:]}."


def zone_arrays(assembly: Assembly, state: State, strength: float | None) -> dict[str, Array]:
    """The zone of thrust: the part of each joint, about the thrust line, that the strength [Pa] needs to carry it."""
    if strength is None:
        return {}
    half = 0.5 * state.normal / (strength * assembly.depth * assembly.length)
    along = assembly.q - assembly.p
    return {
        f"zone_{name}": Array(
            assembly.p + (state.position + sign * half)[:, None] * along,
            ("joint", "axis"),
            "m",
            f"{about} end of the thrust zone (compressed part) in each joint",
        )
        for name, sign, about in (("inner", -1.0, "intrados"), ("outer", 1.0, "extrados"))
    }


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
        f"{name}_start": Array(
            start, (f"{name}_edge",), "", f"index of the first vertex of each path of {name}; the last value is the number of all vertices"
        ),
        f"{name}_of": Array(np.array(list(paths), dtype=object), (f"{name}_path",), "", f"names of the paths of {name}"),
    }


def line_arrays(name: str, found: list[ThrustPath], about: str) -> dict[str, Array]:
    """Thrust lines through all stones, and the greatest force along each of their pieces."""
    points = [path.points for path in found] or [np.empty((0, 2))]
    title = f"{name}_line"
    return {
        title: Array(np.concatenate(points), (f"{title}_vertex", "axis"), "m", f"thrust lines {about}"),
        f"{title}_start": Array(
            np.cumsum([0, *(len(path.points) for path in found)]),
            (f"{title}_edge",),
            "",
            f"index of the first vertex of each path of {title}; the last value is the number of all vertices",
        ),
        f"{title}_of": Array(
            np.array([path.name for path in found], dtype=object),
            (f"{title}_path",),
            "",
            f"arch, stack or block to which each path of {title} belongs",
        ),
        f"{title}_force": Array(
            np.array([path.force for path in found]), (f"{title}_path",), "N", f"greatest force along each path of {title}"
        ),
    }


def graphic_arrays(answer: Answer, name: str, state: State, about: str) -> dict[str, Array]:
    """Thrust lines, funicular and force polygons of a state."""
    per_metre = {k: v / answer.assembly.depth for k, v in answer.polygons(state).items()}
    return {
        **line_arrays(name, answer.lines(state), about),
        **packed(f"{name}_funicular", answer.funiculars(state), "m", f"funicular polygons {about}"),
        **packed(f"{name}_polygon", per_metre, "N/m", f"rays of the force polygons {about}, per metre of depth"),
    }


def hinge_rows(assembly: Assembly, hinges: list[tuple[int, Side]], pivot: np.ndarray) -> list[Hinge]:
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
