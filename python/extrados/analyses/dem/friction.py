"""The least coefficient of friction at which no joint of a structure slides under a motion (thesis 7.2.2)."""

import numpy as np

from extrados.analyses.context import Context
from extrados.analyses.dem import measures
from extrados.analyses.dem import model as dem_model
from extrados.analyses.dem.job import answered
from extrados.analyses.dem.trial import Trial

#: Coefficients that are tried, and how closely the least is found
HIGHEST, ACCURACY = 2.0, 0.005


def friction_threshold(context: Context, trial: Trial, slip: float) -> float | None:
    """Least coefficient of friction, the same at all joints, at which none slides by more than `slip` [m]; None
    above 2.

    Raises Unfinished after Ctrl-C, and Refused where a run of the search is not to be trusted.
    """
    model, done = trial.model, 0
    total = 1.0 + np.ceil(np.log2(HIGHEST / ACCURACY))

    def slides(friction: float) -> bool:
        nonlocal done
        context.progress(done, total, "least friction")
        done += 1
        job = trial.job([model.values.scaled(friction=friction)])
        (run,) = answered(context, "dem-friction", job, "", tell=lambda n: None)
        if run.reason in ("unsettled", "restless"):
            return True
        dem_model.checked(run, model)
        gap_p, gap_q, moved = measures.openings(model, run)
        state = measures.hinges(model, gap_p, gap_q, moved)
        return measures.Slip.of(state, moved, model.assembly.length).peak > slip

    low, high = 0.0, HIGHEST
    if slides(high):
        return None
    while high - low > ACCURACY:
        middle = 0.5 * (low + high)
        low, high = (middle, high) if slides(middle) else (low, middle)
    return high
