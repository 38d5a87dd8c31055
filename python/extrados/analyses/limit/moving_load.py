"""moving-load: the point or axle load that brings a vault down, at every place along its span."""

from dataclasses import dataclass

import numpy as np

from extrados.analyses.batches import stacked, sweep
from extrados.analyses.context import Context, Refused
from extrados.analyses.limit.common import answer_of, block_under, chain_of, geometry_arrays, loads_of
from extrados.analyses.limit.tables import MovingLoad
from extrados.analyses.limit.variation import signature, spoken
from extrados.building.geometry.assembly import Assembly
from extrados.building.geometry.chains import is_stack
from extrados.limit.loads import Loads, forces_at
from extrados.limit.motion import finite_motion
from extrados.limit.programme import LimitAnalysis, Mechanism, NoEquilibrium, State
from extrados.results import limit as out
from extrados.results.model import Array, Result, TableData


@dataclass(frozen=True)
class Places:
    """Member k is the load with its first axle at places[k] [m]; `shares` of the weight of `dead` [N] at `axles`
    behind it [m], as far as they stand on the `span` [m]."""

    assembly: Assembly
    friction: float | np.ndarray | None
    strength: float | None
    associated: bool
    dead: np.ndarray
    places: np.ndarray
    axles: np.ndarray
    shares: np.ndarray
    span: tuple[float, float]

    def run(self, first: int, count: int, threads: int) -> dict[str, np.ndarray]:
        return stacked(self._member, first, count)

    def collapse(self, k: int) -> tuple[State, Mechanism] | None:
        """State and mechanism of collapse; None where the load brings nothing down."""
        low, high = self.span
        live = np.zeros_like(self.dead)
        for axle, share in zip(self.places[k] - self.axles, self.shares, strict=True):
            if low <= axle <= high:
                block, y = block_under(self.assembly, float(axle))
                live += forces_at(len(live), block, np.array([axle, y]), (0.0, -share * self.weight))
        if not live.any():
            return None
        limit = LimitAnalysis(
            self.assembly,
            self.friction,
            strength=self.strength,
            associated=self.associated,
            loads=Loads(self.dead, live),
        )
        try:
            return limit.collapse(1)
        except NoEquilibrium:
            return None

    @property
    def weight(self) -> float:
        return float(np.abs(self.dead[:, 1]).sum())

    def _member(self, k: int) -> dict[str, np.ndarray]:
        found = self.collapse(k)
        if found is None:
            return {"capacity": np.array(np.inf), "mechanism": np.array(""), "gap": np.array(0.0)}
        state, mechanism = found
        return {
            "capacity": np.array(state.gamma * self.weight),
            "mechanism": np.array(spoken(signature(self.assembly, mechanism))),
            "gap": np.array(abs(state.gamma - mechanism.upper_bound)),
        }


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
    # A hair inside, so that the ends still lie on a stone.
    places = np.linspace(low, high + np.ptp(axles), options.count)
    places[0], places[-1] = places[0] + 1e-9 * (high - low), places[-1] - 1e-9 * (high - low)
    job = Places(
        assembly, context.building.friction(), context.building.material.compressive_strength,
        options.friction_rule == "associated", dead, places, axles, shares, (low, high),
    )  # fmt: skip
    swept = sweep(context, "moving-load", job, len(places), "moving load", slow=True).whole()
    capacity, mechanisms, gap = swept["capacity"], swept["mechanism"].tolist(), float(swept["gap"].max())
    k = int(capacity.argmin())
    if not np.isfinite(capacity[k]):
        raise Refused(
            f"no load of this kind brings the {context.building.structure.word} down: it only presses the joints together"
        )
    state, mechanism = job.collapse(k)
    result = Result("moving-load")
    asked = {} if options.force is None else {"load_N": options.force, "safety_factor": capacity[k] / options.force}
    r = out.MovingLoad(
        chain=chain,
        collapse_load_N=float(capacity[k]),
        collapse_load_kN_per_m=float(capacity[k] / assembly.depth / 1e3),
        worst_place_m=float(places[k]),
        worst_place_over_span=float((places[k] - low) / (high - low)),
        hinges=[out.NamedHinge(joint=j, side=side, name=assembly.joint_names[j]) for j, side in mechanism.hinges],
        places_without_limit=int(np.isinf(capacity).sum()),
        duality_gap=gap,
        **asked,
    )
    result.results = r
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
        f"The load that brings the {chain or context.building.structure.word} down is least, "
        f"{capacity[k] / assembly.depth / 1e3:.4g} kN per metre of depth, when its first axle stands at "
        f"x = {places[k]:.2f} m ({100 * (places[k] - low) / (high - low):.0f} % of the span)."
    )
    if options.force is not None:
        result.answer += (
            f" The given load of {options.force / 1e3:.4g} kN has a safety factor of {capacity[k] / options.force:.2f}."
        )
    return result
