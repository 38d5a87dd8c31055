"""Ties, chains, hoops and dampers of a building as the discrete elements take them."""

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np

from extrados.analyses.context import Refused
from extrados.core.dem_run import FoundRun, Ties
from extrados.model.devices import Damper
from extrados.model.errors import BadGeometry
from extrados.model.geometry.anchors import stone_at
from extrados.model.geometry.assembly import GROUND
from extrados.model.geometry.solids.strands import Strand
from extrados.model.ties import Tie
from extrados.results.dem import TieRun
from extrados.results.model import Array
from extrados.views.building import Building
from extrados.views.solids.strands import strand_names


@dataclass(frozen=True)
class ElementTies:
    """The ties and dampers of a model, by their names: of a bonded chain each segment; core None without any."""

    names: tuple[str, ...] = ()
    core: Ties | None = None
    strands: tuple[Strand, ...] = ()
    viscous: tuple[bool, ...] = ()

    def yielded(self, plastic: np.ndarray) -> "ElementTies":
        """The same with permanent elongations (ties) [m] from before the run."""
        return self if self.core is None or not plastic.any() else replace(self, core=replace(self.core, plastic=plastic))


#: Of a model without any
NO_TIES = ElementTies()


def refuse_rigid_ties(building: Building) -> None:
    """Refused where a tie has no stiffness: discrete elements follow its elongation."""
    for k, tie in enumerate(building.ties):
        if tie.stiffness is None:
            raise Refused(
                f"{tie.name}: discrete elements require the axial stiffness EA/L of a tie (force / elongation)", ("ties", k, "stiffness")
            )


def section_strands(building: Building) -> tuple[Strand, ...]:
    """The ties and dampers of a plane section as lines of two points [x, y, 0]."""
    anchored, found = building.anchored(), []
    for k, (tie, block, point) in enumerate(zip(building.ties, anchored.block, anchored.point, strict=True)):
        flat = np.column_stack([point, np.zeros(2)])
        found.append(Strand(k, flat, ((int(block[0]),), (int(block[1]),)), False, tie.least, tie.most))
    assembly = building.blocks()
    for k, damper in enumerate(building.dampers):
        what, key, points = damper.name or "", ("dampers", k), np.array(damper.flat())
        first = stone_at(assembly, points[0], damper.start_stone, f"{what}, start", key, "start")
        last = GROUND if damper.end is None else stone_at(assembly, points[1], damper.end_stone, f"{what}, end", key, "end")
        if first == last:
            raise BadGeometry(
                f"{what}: both ends are in the block '{assembly.block_names[first]}'. Move one end into another block, or to the ground",
                key,
            )
        flat = np.column_stack([points, np.zeros(2)])
        found.append(Strand(len(building.ties) + k, flat, ((first,), (last,)), False, -damper.most, damper.most))
    return tuple(found)


def _dashpot(one: Tie | Damper) -> Damper | None:
    return one if isinstance(one, Damper) and one.damping is not None else None


def element_ties(building: Building, strands: tuple[Strand, ...], body_of_block: np.ndarray, has_rates: bool) -> ElementTies:
    """The strands on the bodies of their blocks; Refused where a tie has no stiffness.

    The stiffness of a deck is that of the whole line: a segment of a bonded chain is as much stiffer as it is shorter.
    has_rates: False leaves viscous dampers out, which would carry a load that creeps.
    """
    given: tuple[Tie | Damper, ...] = (*building.ties, *building.dampers)
    if not has_rates:
        strands = tuple(s for s in strands if _dashpot(given[s.tie]) is None)
    if not strands:
        return NO_TIES
    refuse_rigid_ties(building)
    whole = np.bincount([s.tie for s in strands], [s.length for s in strands])
    tables = [given[s.tie] for s in strands]
    dashpots = [_dashpot(t) for t in tables]
    anchors = [
        (point, -1 if block < 0 else int(body_of_block[block]), place)
        for point, (place, blocks) in enumerate((p, b) for s in strands for p, b in zip(s.point, s.blocks, strict=True))
        for block in blocks
    ]
    point, body, place = zip(*anchors, strict=True)
    core = Ties(
        stiffness=np.array([(t.stiffness or 0.0) * whole[s.tie] / s.length for t, s in zip(tables, strands, strict=True)]),
        prestress=np.array([0.0 if isinstance(t, Damper) else t.prestress for t in tables]),
        least=np.array([s.low for s in strands]),
        most=np.array([s.high for s in strands]),
        first=np.cumsum([0, *(len(s.point) for s in strands)])[:-1],
        closed=np.array([s.closed for s in strands]),
        body=np.array(body),
        point=np.array(point),
        place=np.array(place),
        damping=np.array([0.0 if d is None else d.damping for d in dashpots]),
        power=np.array([1.0 if d is None else d.power for d in dashpots]),
    )
    return ElementTies(strand_names(building, strands), core, strands, tuple(d is not None for d in dashpots))


def tie_rows(ties: ElementTies, run: FoundRun) -> dict[str, list[TieRun]]:
    """Forces and states of the ties in a run, as results have them; nothing without any."""
    if ties.core is None or not len(run.tension):
        return {}
    found = []
    for k, name in enumerate(ties.names):
        lowest, highest, plastic = run.extreme[k].tolist()
        plastic += float(np.broadcast_to(ties.core.plastic, len(ties.names))[k])
        peak = highest if highest >= -lowest else lowest
        state: Literal["slack", "elastic", "yielded", "viscous"] = "yielded" if plastic else "elastic" if peak else "slack"
        if ties.viscous[k]:
            state = "viscous"
        found.append(TieRun(name=name, peak_force_N=peak, end_force_N=float(run.tension[-1, k]), plastic_elongation_m=plastic, state=state))
    return {"ties": found}


def tie_columns(ties: ElementTies, tension: np.ndarray) -> dict[str, np.ndarray]:
    """Histories of the tensions by the headings of a table."""
    return {f"force of {name}": tension[:, k] for k, name in enumerate(ties.names)}


def tie_arrays(ties: ElementTies, tension: np.ndarray) -> dict[str, Array]:
    """Histories of the tensions as results store them; nothing without ties."""
    if ties.core is None:
        return {}
    return {"tie_force": Array(tension, ("time", "tie"), "N", "forces of ties and dampers, tension positive")}


def segment_arrays(ties: ElementTies, axes: int) -> dict[str, Array]:
    """Where ties and dampers are in the plane (axes = 2) or in space (3), segment by segment, as figures draw them; nothing without any."""
    if not ties.strands:
        return {}
    ends = [(strand, k) for strand in ties.strands for k in strand.segments]
    one, axis = ("tie", "axis") if axes == 2 else ("segment", "axis3")
    return {
        "tie_block": Array(
            np.array([[strand.blocks[i][0] for i in k] for strand, k in ends]),
            (one, "tie_end"),
            "",
            "numbers of the blocks at the two ends of each tie or damper; -1 is the ground",
        ),
        "tie_point": Array(
            np.array([strand.point[list(k), :axes] for strand, k in ends]), (one, "tie_end", axis), "m", "both ends as drawn"
        ),
    }
