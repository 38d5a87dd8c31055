"""dem: rigid blocks that rock, hinge, slide and fall under a motion, or in a tilt test (thesis chapter 7)."""

from extrados.analyses.context import Context, Refused
from extrados.analyses.dem import model as dem_model
from extrados.analyses.dem import motion, solid_motion, solid_tilt, tilt
from extrados.analyses.dem.solid_model import make_solid_model
from extrados.analyses.dem.standing import against_limit_analysis, solids_against_limit_analysis
from extrados.analyses.dem.tables import Dem
from extrados.analyses.needs import stones_of
from extrados.building.errors import WHOLE
from extrados.building.geometry.assembly import Assembly
from extrados.core.calls import interruptible
from extrados.results.model import Result


def run(context: Context, options: Dem) -> Result:
    """A run with its variations, or a tilt test; of a section, or of solids."""
    if not isinstance(stones_of(context.building, options), Assembly):
        return _of_solids(context, options)
    model = dem_model.make_model(context, options)
    context.warnings += dem_model.warnings(model, options)
    try:
        with interruptible():  # Ctrl-C between two runs stops the next one
            result = (tilt if options.test == "tilt" else motion).run(context, options, model)
    except dem_model.Falls as error:
        told = against_limit_analysis(context.building, stands=False)
        raise Refused(f"{error}; {told}" if told else str(error), WHOLE) from None
    if told := against_limit_analysis(context.building, stands=True):
        result.warnings.append(told)
    return result


def _of_solids(context: Context, options: Dem) -> Result:
    model = make_solid_model(context.building, options)
    if not options.rigid:
        context.warnings += dem_model.doubts_of_springs(model.values)
    try:
        with interruptible():
            result = (solid_tilt if options.test == "tilt" else solid_motion).run(context, options, model)
    except dem_model.Falls as error:
        told = solids_against_limit_analysis(context.building, stands=False)
        raise Refused(f"{error}; {told}" if told else str(error), WHOLE) from None
    if told := solids_against_limit_analysis(context.building, stands=True):
        result.warnings.append(told)
    return result
