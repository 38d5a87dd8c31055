"""What the strengths of piers by the formulas of codes come to, storey by storey: the equivalent frame beside a push."""

from typing import Any

import numpy as np

from extrados.analyses.codes.piers import Pier, ntc_piers
from extrados.analyses.codes.research import formulas_of_piers
from extrados.analyses.context import Refused
from extrados.analyses.shell.model import ShellModel
from extrados.analyses.shell.sections import sections_at
from extrados.analyses.shell.tables import FrameRules
from extrados.model.structures.plan import Plan
from extrados.model.structures.plan_parts import PlanWall

#: Walls that make a greater angle with the push than this cosine says are left out
ALONG = 0.1
#: Formulas of each code, of which the least counts for a pier
CODES = {
    "FEMA 356": ("FEMA 356 rocking", "FEMA 356 bed-joint sliding", "FEMA 356 toe crushing"),
    "NTC 2018": ("NTC flexure", "NTC diagonal cracking"),
}


def capacities(
    model: ShellModel, plan: Plan, rules: FrameRules, strength: float, under: dict[str, np.ndarray]
) -> tuple[list[dict[str, Any]], list[dict[str, Any]]]:
    """By code the base shear that the piers of the weakest storey bear, and all piers with their strengths.

    under: the report of the points under the constant loads, which give the piers' normal forces; strength: f_m [Pa].
    Piers stand between openings, as high as the openings beside them (without any, as their storey), each bears by its own
    least formula, and all of a storey together. The push that overturns changes no normal force.
    """
    rows: list[dict[str, Any]] = []
    for w, wall in enumerate(plan.walls):
        facing = abs(float(wall.direction @ model.along[:2]))
        if facing > ALONG:
            rows += [{**row, "facing": facing} for row in _piers(model, plan, w, wall, rules, strength, under)]
    if not rows:
        raise Refused("frame: no wall lies along the direction of the load", ("analysis", "frame"))
    share = _shares(model, plan)
    found = []
    for code in CODES:
        by_storey = {
            storey: sum(row["facing"] * row[code] for row in rows if row["storey"] == storey)
            for storey in sorted({row["storey"] for row in rows})
        }
        base = {storey: value / share[storey - 1] for storey, value in by_storey.items() if share[storey - 1] > 0.0}
        weakest = min(base, key=lambda storey: base[storey])
        found.append({"code": code, "base_shear_N": float(base[weakest]), "storey": weakest})
    return found, rows


def _shares(model: ShellModel, plan: Plan) -> np.ndarray:
    """Part of the push that acts above the middle of each storey."""
    force = np.abs(model.reference[:, :3] @ model.along)
    height, level = np.unique(np.round(model.mesh.xyz[:, 2], 9), return_inverse=True)
    at = np.bincount(level.ravel(), force)
    above = np.cumsum(at[::-1])[::-1] - 0.5 * at  # nodes stand for the masonry below them as well
    return np.interp(0.5 * (plan.levels[1:] + plan.levels[:-1]), height, above) / force.sum()


def _piers(
    model: ShellModel, plan: Plan, w: int, wall: PlanWall, rules: FrameRules, strength: float, under: dict[str, np.ndarray]
) -> list[dict[str, Any]]:
    rows = []
    first, last = plan.reach(wall)
    for storey in range(first, last + 1):
        openings = plan.openings_in(wall, storey)
        foot, tall = float(plan.levels[storey - 1]), plan.storeys[storey - 1]
        low, high = max((o.z[0] for o in openings), default=0.0), min((o.z[1] for o in openings), default=tall)
        if low >= high:  # no height cuts all of them: that of the tallest
            low, high = max(((o.z[0], o.z[1]) for o in openings), key=lambda ends: ends[1] - ends[0])
        thickness = plan.thickness_of(wall, storey)
        for pier in sections_at(model, under, w, storey, foot + 0.5 * (low + high)):
            beside = [o.z[1] - o.z[0] for o in openings if _touch(o.x, (pier.start, pier.end))]
            height, width, load = float(np.mean(beside)) if beside else tall, pier.end - pier.start, -pier.normal
            if not 0.0 < load < 0.7 * strength * width * thickness:
                raise Refused(
                    f"frame: a pier of wall '{wall.name}', storey {storey}, carries {load / 1000.0:.4g} kN under the "
                    f"constant loads. The formulas for piers require a pressure below 0.7 f_m, which corresponds to {0.0007 * strength * width * thickness:.4g} "
                    "kN",
                    ("analysis", "frame"),
                )
            double = rules.fixity == "double"
            lines = [
                *formulas_of_piers(width, height, thickness, load, strength, rules.cohesion, rules.friction, double),
                *ntc_piers(
                    Pier(width, height, thickness, load, 0.0, double, strength, rules.cohesion, rules.friction, rules.diagonal_strength),
                    1.0,
                    1.0,
                    None,
                    "SLV",
                ),
            ]
            value = {line.rule: line.capacity for line in lines if line.capacity is not None}
            row: dict[str, Any] = {"wall": wall.name, "storey": storey, "from": pier.start, "to": pier.end, "height": height, "load": load}
            for code, names in CODES.items():
                least = min(names, key=lambda name: value[name])
                row[code], row[f"{code} by"] = value[least], least
            rows.append(row)
    return rows


def _touch(opening: list[float], pier: tuple[float, float]) -> bool:
    return abs(opening[0] - pier[1]) < 1e-6 or abs(opening[1] - pier[0]) < 1e-6
