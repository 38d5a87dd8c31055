"""dem of blocks in space as a tilt test: the constant acceleration along a direction that brings them down, and back."""

from dataclasses import replace

import numpy as np

from extrados.analyses.context import Context
from extrados.analyses.dem import measures, solid_measures
from extrados.analyses.dem import model as dem_model
from extrados.analyses.dem.job import SolidRuns, SolidTask
from extrados.analyses.dem.solid_history import contact_arrays, core_options, run_arrays
from extrados.analyses.dem.solid_model import SolidModel
from extrados.analyses.dem.tables import Dem
from extrados.analyses.dem.tilt import GOES, capacities, held, numbers_of_tilt, pushed, slides, unused
from extrados.analyses.dem.words import solid_tilt_answer
from extrados.core import dem3
from extrados.results import dem as out
from extrados.results.model import Result


def run(context: Context, options: Dem, model: SolidModel) -> Result:
    """Brought in slowly, held, bisected, in both senses."""
    if without := unused(context, options):
        context.warnings.append(f"these tables or keys have no effect in a tilt test: {', '.join(without)}")
    base = replace(core_options(context, options, model), **held(options, model))
    bodies = model.bodies()
    found = capacities(
        context,
        options,
        lambda asked: SolidRuns(bodies, [SolidTask(base, pushed(a, base.end_time)) for a in asked]),
        lambda run: dem_model.checked(run, model),
    )
    last, back_run = (run for _, run in found)
    r = out.SolidDemTilt(
        **numbers_of_tilt(options, model, found),
        load_direction_deg=options.direction or 0.0,
        blocks=model.count,
        contacts=len(model.assembly.a),
        **measures.water_force(model),
        opening_contacts=_openings(model, last),
        opening_contacts_opposite=_openings(model, back_run),
        interval=len(model.assembly.a) > model.count
        and any(slides(solid_measures.contacts(model, one)[1][_begun(model, one)], model.size) for one in (last, back_run)),
    )
    result = Result("dem")
    result.warnings += dem_model.unconverged(last.effort.with_(back_run.effort))
    result.results = r
    opening, slip, state = solid_measures.contacts(model, last)
    result.arrays = {**run_arrays(model, last, last.time[[_begun(model, last), -1]]), **contact_arrays(opening, slip, state)}
    result.answer = solid_tilt_answer(r)
    return result


def _begun(model: SolidModel, run: dem3.Run) -> int:
    """The output where it begins to go."""
    far = solid_measures.displacements(model, run).max(axis=1)
    return min(int(np.searchsorted(far, GOES * model.size)), len(run.time) - 1)


def _openings(model: SolidModel, run: dem3.Run) -> list[str]:
    """Names of the contacts that gape or slide as it begins to go, the widest first."""
    at = _begun(model, run)
    opening, slip, _ = solid_measures.contacts(model, run)
    width = solid_measures.widths(model)
    amiss = np.maximum(opening[at] / (measures.OPEN * width), slip[at] / (measures.SLIDES * width))
    order = np.argsort(-amiss, kind="stable")
    return [model.assembly.joint_names[j] for j in order[amiss[order] > 1.0][:20].tolist()]
