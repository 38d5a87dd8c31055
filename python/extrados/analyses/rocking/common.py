"""What all analyses of rocking share."""

from extrados.analyses.context import Context
from extrados.analyses.rocking.tables import RockingTable
from extrados.building.rockers.rocker import Rocker


def rocker_of(context: Context, options: RockingTable) -> Rocker:
    """The building as one rocking mechanism; its warnings go to the context."""
    rocker = context.building.rocker(options.form == "linear")
    context.warnings += rocker.warnings
    return rocker
