"""dem: rigid blocks that rock, hinge, slide and fall under a motion, or in a tilt test (thesis chapter 7)."""

from collections.abc import Callable
from functools import partial

from extrados.analyses.context import Context, Refused
from extrados.analyses.dem import model as dem_model
from extrados.analyses.dem import motion, solid_motion, solid_tilt, tilt
from extrados.analyses.dem.model import Model
from extrados.analyses.dem.solid_model import SolidModel, make_solid_model
from extrados.analyses.dem.standing import against_limit_analysis, jammed, left_out, solids_against_limit_analysis
from extrados.analyses.dem.tables import Dem
from extrados.analyses.needs import stones_of
from extrados.building.building import Building
from extrados.building.errors import WHOLE
from extrados.building.geometry.assembly import Assembly
from extrados.core.calls import interruptible
from extrados.results.model import Result


def run(context: Context, options: Dem) -> Result:
    """A run with its variations, or a tilt test; of a section, or of solids."""
    tilted = options.test == "tilt"
    if isinstance(stones_of(context.building, options), Assembly):
        model = dem_model.make_model(context, options)
        context.warnings += dem_model.warnings(model, options)
        found = partial((tilt if tilted else motion).run, context, options, model)
        return _compared(context, options, model, found, against_limit_analysis)
    solids = make_solid_model(context.building, options)
    if not options.rigid:
        context.warnings += dem_model.doubts_of_springs(solids.values)
    found = partial((solid_tilt if tilted else solid_motion).run, context, options, solids)
    return _compared(context, options, solids, found, solids_against_limit_analysis)


def _compared(
    context: Context, options: Dem, model: Model | SolidModel, find: Callable[[], Result],
    against_limit: Callable[[Building, bool], str],
) -> Result:  # fmt: skip
    """What is found, with what other methods say of its standing under the own weight."""
    alone = left_out(model)
    doubt, warning = "", ""
    try:
        with interruptible():  # Ctrl-C between two runs stops the next one
            if options.rigid and not alone:  # first: Ctrl-C here loses nothing
                doubt, warning = jammed(model, context.threads)
            result = find()
    except dem_model.Falls as error:
        told = alone or against_limit(context.building, False)
        raise Refused(f"{error}; {told}" if told else str(error), WHOLE) from None
    if doubt and result.status == "ok":
        result.answer += f" {doubt}"
    told = alone or against_limit(context.building, True)
    result.warnings += [text for text in (warning, told) if text]
    return result
