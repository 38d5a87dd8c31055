"""Ties, chains and hoops of a building on its blocks in space."""

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from extrados.model.devices import Damper
from extrados.model.errors import BadGeometry, Key
from extrados.model.geometry.solids.assembly import SolidAssembly
from extrados.model.geometry.solids.contacts import GROUND
from extrados.model.geometry.solids.strands import Strand, hoop_at, solid_at
from extrados.model.ties import Tie

if TYPE_CHECKING:
    from extrados.views.building import Building


def strands_of(building: "Building") -> tuple[Strand, ...]:
    """The strands of all ties, in their order: one each, of bonded chains one a segment."""
    assembly, found = building.solids(), []
    for k, tie in enumerate(building.ties):
        what, key = tie.name or "", ("ties", k)
        if len(tie.start) != 3:
            raise BadGeometry(f"{what}: for blocks in space, each point of a tie requires [x, y, z]", (*key, "start"))
        points, blocks = hoop_at(assembly, tie.start[2], what, (*key, "start")) if tie.hoop else _run(assembly, tie, what, key)
        whole = Strand(k, points, blocks, tie.hoop, tie.least, tie.most)
        found += (
            [replace(whole, point=points[[i, j]], blocks=(blocks[i], blocks[j]), closed=False) for i, j in whole.segments]
            if tie.bonded
            else [whole]
        )
    return tuple(found)


def damper_strands(building: "Building") -> tuple[Strand, ...]:
    """The dampers as lines of two points; their numbers follow those of the ties."""
    assembly, found = building.solids(), []
    for k, damper in enumerate(building.dampers):
        what, key = damper.name or "", ("dampers", k)
        if len(damper.start) != 3:
            raise BadGeometry(f"{what}: blocks in space need [x, y, z] of both ends of a damper", (*key, "start"))
        points = np.array([damper.start, damper.far], dtype=float)
        first = solid_at(assembly, points[0], damper.start_stone, f"{what}, start", key, "start")
        last = GROUND if damper.ground is not None else solid_at(assembly, points[1], damper.end_stone, f"{what}, end", key, "end")
        if first == last:
            raise BadGeometry(
                f"{what}: both ends are in the block '{assembly.block_names[first]}'. Move one end into another block, or to the ground",
                key,
            )
        found.append(Strand(len(building.ties) + k, points, ((first,), (last,)), False, -damper.most, damper.most))
    return tuple(found)


def strand_names(building: "Building", strands: tuple[Strand, ...]) -> tuple[str, ...]:
    """Names of strands: those of their ties and dampers, the segments of a bonded chain numbered."""
    names = []
    tables: tuple[Tie | Damper, ...] = (*building.ties, *building.dampers)
    for strand in strands:
        fellows = [other for other in strands if other.tie == strand.tie]
        name = tables[strand.tie].name or ""
        number = next(k for k, other in enumerate(fellows, start=1) if other is strand)
        names.append(f"{name}, segment {number}" if len(fellows) > 1 else name)
    return tuple(names)


def _run(assembly: SolidAssembly, tie: Tie, what: str, key: Key) -> tuple[np.ndarray, tuple[tuple[int, ...], ...]]:
    """Points (k, 3) [m] of a tie or an open chain, and the block at each."""
    points = np.array([tie.start, *tie.via, tie.far], dtype=float)
    blocks = [solid_at(assembly, points[0], tie.start_stone, f"{what}, start", key, "start")]
    blocks += [solid_at(assembly, point, None, f"{what}, via", key, "via") for point in points[1:-1]]
    blocks.append(GROUND if tie.ground is not None else solid_at(assembly, points[-1], tie.end_stone, f"{what}, end", key, "end"))
    if len(set(blocks)) == 1:
        raise BadGeometry(f"{what}: both ends are in block '{assembly.block_names[blocks[0]]}'", key)
    return points, tuple((block,) for block in blocks)
