"""What an analysis assumed of the building: the values of the properties that it uses, and who set them."""

from extrados.analyses.table import Analysis
from extrados.building.building import Building
from extrados.results.assumptions import Assumption
from extrados.schema.quantities import unit_of


def assumptions_of(options: Analysis, deck: Building, building: Building) -> dict[str, Assumption]:
    """Key -> assumption for all `uses` of the analysis, but for a key that it varies itself.

    deck: the building as the deck's own tables say it; building: as the analysis sees it.
    """
    found = {}
    for key in options.uses:
        if key == getattr(options, "vary", None):
            continue
        table, name = key.split(".")
        own, override = getattr(building, table), getattr(options, table, None)
        if override is not None and name in override.model_fields_set:
            origin = "analysis"
        else:
            origin = "deck" if name in getattr(deck, table).model_fields_set else "default"
        differ = building.materials.values() if table == "material" else getattr(own, "types", [])
        found[key] = Assumption(
            value=getattr(own, name), unit=unit_of(type(own), name), origin=origin,
            exceptions=any(getattr(one, name, None) is not None for one in differ),
        )  # fmt: skip
    return found
