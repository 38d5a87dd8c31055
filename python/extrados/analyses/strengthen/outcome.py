"""What strengthen returns beside its typed results: arrays of curves and mechanisms, the table and the text."""

from dataclasses import replace

import numpy as np

from extrados.analyses.context import Context
from extrados.analyses.limit.common import geometry_arrays, packed
from extrados.analyses.limit.solids import scene_arrays
from extrados.analyses.strengthen.measures import Worth
from extrados.analyses.strengthen.sizing import Sized
from extrados.results import strengthen as out
from extrados.results.model import Array, TableData


def arrays_of(context: Context, before: Worth, sized: list[Sized]) -> dict[str, Array]:
    """Curves of all alternatives, the forces over the places of ties, and the mechanisms before and after."""
    curves = {s.row.name: np.column_stack([*s.curve, s.costs]) for s in sized if s.curve[0]}
    places = {s.row.name: np.column_stack(s.places) for s in sized if s.places is not None}
    rest: dict[str, np.ndarray] = {}
    moved: dict[str, np.ndarray] = {}
    drawn = [("0", before), *((str(k), s.worth) for k, s in enumerate(sized, start=1))]
    for name, worth in drawn:
        if worth is None or worth.moved is None:
            continue
        stones, pose = worth.moved
        for i, (outline, c, p) in enumerate(zip(stones.outlines, stones.centroid, pose, strict=True)):
            cos, sin = np.cos(p[2]), np.sin(p[2])
            rest[f"{name}/{i}"] = outline
            moved[f"{name}/{i}"] = (outline - c) @ np.array([[cos, sin], [-sin, cos]]) + p[:2]
    found = {
        **_pack("curve", curves, 3, "along the curve of each alternative intervention: size, value of the target quantity, and cost"),
        **_pack(
            "range",
            places,
            3,
            "x, y of the middle of each tie at each possible place [m], and required force [N]; infinite: no force is "
            "sufficient at this place",
        ),
        **packed(
            "stones", rest, "m", "blocks of the existing building (named 0/block) and of the building with each alternative (number/block)"
        ),
        **packed("stones_moved", moved, "m", "the same blocks, displaced by the governing mechanism"),
    }
    for name, worth in drawn:
        if worth is not None and worth.in_space is not None:
            solids, poses = worth.in_space
            found |= {
                f"{key}_{name}": replace(array, dims=(f"{array.dims[0]}_{name}", *array.dims[1:]))
                for key, array in scene_arrays(solids).items()
                if key.startswith("solid_")
            }
            found[f"solid_pose_{name}"] = Array(poses, (f"block_{name}", "pose"), "m, m, m, rad, rad, rad", "the mechanism carried on")
            tie = sized[int(name) - 1].tie if name != "0" else None
            if tie is not None:
                strands = context.building.having(ties=(tie,)).strands()
                ends = np.array([s.point[[i, j]] for s in strands for i, j in s.segments])
                found[f"solid_strand_{name}"] = Array(
                    ends, (f"segment_{name}", "tie_end", "axis3"), "m", "both ends of each segment of the tie"
                )
    if context.building.structure is not None and rest:
        found |= geometry_arrays(context.building.blocks())
    return found


def _pack(name: str, paths: dict[str, np.ndarray], width: int, about: str) -> dict[str, Array]:
    """Rows of numbers of different lengths one after the other."""
    rows = np.concatenate(list(paths.values())) if paths else np.empty((0, width))
    start = np.cumsum([0, *map(len, paths.values())])
    return {
        name: Array(rows, (f"{name}_row", f"{name}_column"), "", about),
        f"{name}_start": Array(start, (f"{name}_edge",), "", f"index of the first row of each path of {name}; the last value is the end"),
        f"{name}_of": Array(np.array(list(paths), dtype=object), (f"{name}_path",), "", f"names of the paths of {name}"),
    }


def table_of(sized: list[Sized]) -> TableData:
    """Alternatives side by side."""
    names = (
        "name",
        "kind",
        "place",
        "unit",
        "meets_target",
        "required_size",
        "capacity_after",
        "safety_factor_after",
        "length_m",
        "force_N",
        "volume_m3",
        "cost",
        "next_mechanism",
        "reason",
    )
    rows = [s.row for s in sized]
    return TableData({n: [np.nan if (v := getattr(r, n)) is None else v for r in rows] for n in names})


def words(r: out.Strengthen) -> str:
    """The conclusion, the alternatives, and what governs then."""
    said = [r.statement(), f"Governing mechanism: {r.mechanism_before}."]
    unit = f" {r.unit}" if r.unit else ""
    for one in r.interventions:
        if not one.meets_target:
            most = "" if one.greatest_capacity is None else f" (at best {one.greatest_capacity:.3g}{unit})"
            said.append(f"- {one.name}: {one.reason}{most}.")
            continue
        after = "no collapse mechanism is left" if one.capacity_after is None else f"{one.capacity_after:.3g}{unit}"
        cost = "" if one.cost is None else f"; relative cost {one.cost:.3g} by the weights of the deck"
        then = f" Governing mechanism afterwards: {one.next_mechanism}." if one.next_mechanism else ""
        said.append(f"- {one.name}: {out.size_told(one)}: afterwards {after}{cost}.{then}")
        said += [f"  {text}" for text in one.adverse]
    if r.combination:
        told = ", ".join(f"{row.force_N / 1e3:.3g} kN of {row.name}" for row in r.combination)
        shown = "" if r.combination_meets_target else ", which may not meet the target (see the warnings)"
        said.append(f"- Combination of ties with the least total force{shown}: {told}; relative cost {r.combination_cost:.3g}.")
    return "\n".join(said)
