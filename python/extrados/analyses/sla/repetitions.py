"""The curve again with other seeds of mesh and strength, and the scatter of its peaks."""

from dataclasses import dataclass

import numpy as np

from extrados.analyses.batches import stacked, sweep
from extrados.analyses.context import Context, Refused
from extrados.analyses.sla.curve import MOST_ENVELOPE
from extrados.analyses.sla.events import run_curves
from extrados.analyses.sla.model import build, strength_factors
from extrados.analyses.sla.tables import Sla
from extrados.core.errors import Cancelled, status_code
from extrados.results import sla as out
from extrados.results.model import Array, Result, TableData
from extrados.views.building import Building


@dataclass(frozen=True)
class Repetitions:
    """Member k is the first curve again with the k-th seed of mesh or strength."""

    building: Building
    options: Sla
    random_mesh: bool

    def run(self, first: int, count: int, threads: int) -> dict[str, np.ndarray]:
        return stacked(lambda k: self._member(self.options.seeds[k], threads), first, count)

    def _member(self, seed: int, threads: int) -> dict[str, np.ndarray]:
        options = self.options.model_copy(update={"directions": self.options.directions[:1], "states": []})
        mesh = self.building.mesh(options.mesh, seed if self.random_mesh else None)
        model = build(mesh, options, strength_factors(mesh, options, seed))
        curve = run_curves(model, options, threads, lambda done, total, text: None)[0]
        if curve.events.interrupted:
            raise Cancelled(status_code("cancelled"), "repetition interrupted")
        d, p = curve.envelope(model.unit)
        rows = {name: np.pad(values, (0, MOST_ENVELOPE - len(d)), constant_values=np.nan) for name, values in (("d", d), ("p", p))}
        return {
            **rows,
            "points": np.array(len(d)),
            "passed": np.array(curve.passed(model.unit)),
            "peak_load": np.array(curve.events.load[curve.peak] * model.unit),
            "peak_displacement": np.array(curve.events.monitors[curve.peak, 0]),
        }


def refuse_alike(building: Building, options: Sla) -> bool:
    """Whether seeds change the mesh; Refused where they change neither mesh nor strength."""
    random_mesh = options.mesh.pattern == "random" or bool(getattr(building.structure, "outline", None))
    if not random_mesh and options.strength_variation == 0.0:
        raise Refused('`seeds` require a random mesh (mesh.pattern = "random"), or a `strength_variation` above 0', ("analysis", "seeds"))
    return random_mesh


def repeat(context: Context, options: Sla, result: Result) -> dict[str, out.Scatter]:
    """The curve again with other seeds of mesh and strength: its key, the band into `result`."""
    random_mesh = refuse_alike(context.building, options)
    swept = sweep(
        context,
        "sla-seeds",
        Repetitions(context.building, options, random_mesh),
        len(options.seeds),
        "repetitions",
        slow=True,
        parallel=True,
    )
    if not swept.complete:
        result.status = "interrupted" if swept.interrupted else "failed"
        result.reason = f"among the repetitions: {swept.stopped}"
    if not len(swept.members):
        return {}
    curves = [(d[:n], p[:n]) for d, p, n in zip(swept["d"], swept["p"], swept["points"], strict=True)]
    grid = np.linspace(0.0, min(d[-1] for d, _ in curves), 200)
    rows = np.stack([np.interp(grid, d, p) for d, p in curves])
    result.arrays["scatter_displacement"] = Array(grid, ("scatter_grid",), "m", "displacements of the band")
    result.arrays["scatter_load"] = Array(rows, ("seed", "scatter_grid"), "N", "envelopes of the repetitions")
    passed = np.flatnonzero(swept["passed"])
    done = [options.seeds[k] for k in swept.members[passed]]
    if len(passed) < len(swept.members):
        left = ", ".join(str(options.seeds[k]) for k in np.delete(swept.members, passed))
        result.warnings.append(f"the repetitions with the seeds {left} did not pass a peak; the scatter of the peaks does not include them")
    if not done:
        return {}
    loads = swept["peak_load"][passed]
    scatter = out.Scatter(
        seeds=done,
        peak_loads_N=loads.tolist(),
        mean_N=loads.mean(),
        lowest_N=loads.min(),
        highest_N=loads.max(),
        coefficient_of_variation=loads.std(ddof=1) / loads.mean() if len(loads) > 1 else None,
    )
    result.tables["scatter"] = TableData(
        {"seed": done, "peak_load": loads, "peak_displacement": swept["peak_displacement"][passed]},
        {"peak_load": "N", "peak_displacement": "m"},
    )
    result.answer += f" Over {len(loads)} repetitions the peak lies between {loads.min() / 1e3:.4g} and {loads.max() / 1e3:.4g} kN."
    return {"scatter": scatter}
