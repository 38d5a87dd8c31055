"""Sections of a deck that are many tables, [[ties]] and their like."""

from extrados.model.devices import AddedHinge, Damper
from extrados.model.ties import Tie
from extrados.schema.table import Table

#: Tables of a section
MOST = 1000
#: Section -> its table; one of them without a name is called by the section and its number: "tie 1"
PLURAL: dict[str, type[Table]] = {"ties": Tie, "dampers": Damper, "hinges": AddedHinge}
