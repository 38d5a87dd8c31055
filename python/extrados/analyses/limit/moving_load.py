"""moving-load: the point or axle load that brings a vault down, at every place along its span."""

import numpy as np

from extrados.analyses.context import Context, Refused
from extrados.analyses.limit.common import answer_of, block_under, chain_of, geometry_arrays, loads_of
from extrados.analyses.limit.tables import MovingLoad
from extrados.analyses.limit.variation import signature, spoken
from extrados.building.geometry.assembly import Assembly
from extrados.building.geometry.chains import is_stack
from extrados.limit.loads import Loads, forces_at
from extrados.limit.motion import finite_motion
from extrados.limit.programme import LimitAnalysis, NoEquilibrium
from extrados.results.model import Array, Result, TableData


def _way(assembly: Assembly, chain: str | None) -> tuple[float, float]:
    """From where to where a load crosses [m]: the extrados of a chain, or the whole top where there is no arch."""
    if chain is not None and not is_stack(assembly, assembly.chains[chain]):
        ends = assembly.q[[assembly.chains[chain][k] for k in (0, -1)], 0]
        return float(ends.min()), float(ends.max())
    points = np.concatenate(assembly.outlines)[:, 0]
    return float(points.min()), float(points.max())


def run(context: Context, options: MovingLoad) -> Result:
    """Collapse load over place; the most dangerous place with its thrust line and mechanism."""
    assembly = context.building.blocks()
    chain = chain_of(assembly, options.chain)
    answer_of(context.building, options)  # refuses what cannot stand
    low, high = _way(assembly, chain)
    axles = np.array(options.axles)
    shares = np.array(options.shares or np.ones(len(axles)))
    shares = shares / shares.sum()
    dead = loads_of(assembly, options).dead
    weight = float(np.abs(dead[:, 1]).sum())
    # A hair inside, so that the ends still lie on a stone.
    places = np.linspace(low, high + np.ptp(axles), options.count)
    places[0], places[-1] = places[0] + 1e-9 * (high - low), places[-1] - 1e-9 * (high - low)
    capacity = np.full(len(places), np.inf)
    mechanisms, gap = [""] * len(places), 0.0
    worst = None
    for i, x in enumerate(places):
        context.progress(i, len(places), "moving load")
        live = np.zeros_like(dead)
        for axle, share in zip(x - axles, shares, strict=True):
            if low <= axle <= high:
                block, y = block_under(assembly, float(axle))
                live += forces_at(len(live), block, np.array([axle, y]), (0.0, -share * weight))
        if not live.any():
            continue
        limit = LimitAnalysis(
            assembly, context.building.friction(), strength=context.building.material.compressive_strength,
            associated=options.friction_rule == "associated", loads=Loads(dead, live),
        )  # fmt: skip
        try:
            state, mechanism = limit.collapse(1)
        except NoEquilibrium:
            continue
        capacity[i] = state.gamma * weight
        mechanisms[i] = spoken(signature(assembly, mechanism))
        gap = max(gap, abs(state.gamma - mechanism.upper_bound))
        if worst is None or capacity[i] < capacity[worst[0]]:
            worst = i, state, mechanism
    if worst is None:
        raise Refused("no load of this kind brings the structure down: it only presses the joints together")
    k, state, mechanism = worst
    result = Result("moving-load")
    result.results = {
        "chain": chain,
        "collapse_load_N": float(capacity[k]),
        "collapse_load_kN_per_m": float(capacity[k] / assembly.depth / 1e3),
        "worst_place_m": float(places[k]),
        "worst_place_over_span": float((places[k] - low) / (high - low)),
        "hinges": [{"joint": j, "side": side, "name": assembly.joint_names[j]} for j, side in mechanism.hinges],
        "places_without_limit": int(np.isinf(capacity).sum()),
        "duality_gap": gap,
    }
    if options.force is not None:
        result.results["load_N"] = options.force
        result.results["safety_factor"] = float(capacity[k] / options.force)
    result.arrays = {
        **geometry_arrays(assembly),
        "place": Array(places, ("place",), "m", "x of the first axle"),
        "capacity": Array(np.where(np.isinf(capacity), np.nan, capacity), ("place",), "N", "load that brings it down; NaN where none does"),
        "axle": Array(places[k] - axles, ("axle",), "m", "axles at the worst place"),
        "collapse_point": Array(state.points(assembly), ("joint", "axis"), "m", "thrust line at collapse, worst place"),
        "mechanism_pose": Array(finite_motion(assembly, mechanism), ("block", "component"), "m, m, rad", "the mechanism carried on"),
    }  # fmt: skip
    result.tables = {
        "moving_load": TableData(
            {"place": places, "collapse_load": np.where(np.isinf(capacity), np.nan, capacity), "mechanism": mechanisms},
            {"place": "m", "collapse_load": "N"},
        )
    }
    result.answer = (
        f"The load that brings the {chain or 'structure'} down is least, {capacity[k] / assembly.depth / 1e3:.4g} kN per metre of depth, when its "
        f"first axle stands at x = {places[k]:.3g} m ({100 * (places[k] - low) / (high - low):.0f} % of the span)."
    )
    if options.force is not None:
        result.answer += (
            f" The given load of {options.force / 1e3:.4g} kN has a safety factor of {capacity[k] / options.force:.2f}."
        )
    return result
