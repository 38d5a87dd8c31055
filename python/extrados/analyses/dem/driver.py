"""dem: rigid blocks that rock, hinge, slide and fall under a motion, or in a tilt test (thesis chapter 7)."""

from extrados.analyses.context import Context
from extrados.analyses.dem import history, solid_history, solid_tilt, tilt
from extrados.analyses.dem import model as dem_model
from extrados.analyses.dem.from_deck import make_model
from extrados.analyses.dem.solid_model import make_solid_model
from extrados.analyses.dem.standing import compared
from extrados.analyses.dem.tables import Dem
from extrados.analyses.needs import stones_of
from extrados.model.geometry.assembly import Assembly
from extrados.results.model import Result


def run(context: Context, options: Dem) -> Result:
    """A run with its variations, or a tilt test; of a section, or of solids."""
    tilted = options.test == "tilt"
    if isinstance(stones_of(context.building, options), Assembly):
        model = make_model(context.building, options)
        context.warnings += dem_model.warnings(model, options)
        of_section = tilt if tilted else history
        return compared(context, options.rigid, model, lambda: of_section.run(context, options, model))
    solids = make_solid_model(context.building, options)
    context.warnings += dem_model.warnings_of_solids(solids, springs=not options.rigid)
    of_solids = solid_tilt if tilted else solid_history
    return compared(context, options.rigid, solids, lambda: of_solids.run(context, options, solids))
