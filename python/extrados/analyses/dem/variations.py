"""A run again with other damping, stiffness and friction of its joints."""

from typing import Literal

import numpy as np

from extrados.analyses.context import Context
from extrados.analyses.dem.job import answered
from extrados.analyses.dem.model import JointValues
from extrados.analyses.dem.seen import Seen
from extrados.analyses.dem.tables import Dem
from extrados.analyses.dem.trial import Trial
from extrados.results import dem as out
from extrados.results.model import Array, Result, TableData


def vary(context: Context, options: Dem, trial: Trial, result: Result) -> dict[str, list[out.Variation]]:
    """Sensitivity to damping, stiffness and friction (thesis Tables 7.1 to 7.7): its key, and arrays into `result`."""
    values = trial.model.values
    cases: list[tuple[Literal["damping", "stiffness", "friction"], float, JointValues]] = [
        *(("damping", f, values.scaled(damping=f)) for f in options.vary_damping),
        *(("stiffness", f, values.scaled(stiffness=f)) for f in options.vary_stiffness),
        *(("friction", f, values.scaled(friction=f)) for f in options.vary_friction),
    ]
    if not cases:
        return {}
    # An unstable variation is a finding, not the end of the others.
    runs = answered(context, "dem-variations", trial.job([v for _, _, v in cases]), "sensitivity")
    rows = []
    for (what, factor, v), run in zip(cases, runs, strict=True):
        seen = Seen.of(trial.model, run, options.floor is not None)
        fate = seen.fate(trial.collapse)
        ratio = v.ratios()
        rows.append(
            out.Variation(
                varied=what,
                value=factor,
                beta_s=v.beta,
                stiffness_Pa_per_m=float(v.stiffness.max()),
                friction=float(v.friction.max()),
                damping_ratio_rotation=ratio["rotation"],
                damping_ratio_edge=ratio["edge"],
                outcome=fate.outcome if run.reason in ("end", "rest", "collapse", "left") else run.reason,
                peak_rotation_rad=float(np.abs(seen.rotation).max(initial=0.0)),
                bounces=int(run.bounces[: trial.model.rigid.count].sum()),
                airborne_time_s=float(run.airborne[: trial.model.rigid.count].max(initial=0.0)),
                peak_slip_m=seen.sliding.peak,
                energy_residual_ratio=run.residual,
            )
        )
    result.tables["dem_sensitivity"] = TableData({key: [row[key] for row in rows] for key in rows[0].keys()})
    for k, run in enumerate(runs):
        turn = -(run.place[:, trial.model.rigid.body_of_block, 2] - run.settled[trial.model.rigid.body_of_block, 2])
        follow = int(result.arrays["tracked"].data[0])
        result.arrays[f"varied_time_{k}"] = Array(run.time, (f"varied_time_{k}",), "s", series="varied_time")
        result.arrays[f"varied_rotation_{k}"] = Array(turn[:, follow], (f"varied_time_{k}",), "rad", series="varied_rotation")
    return {"sensitivity": rows}
