"""strengthen: the least intervention of each kind that meets a target, compared, and what governs then."""

from typing import Any

import numpy as np

from extrados.analyses.context import Context
from extrados.analyses.strengthen.alternatives import ChangeAlternative, TieAlternative, change_alternatives, is_spatial, tie_alternatives
from extrados.analyses.strengthen.change_sizes import size_change
from extrados.analyses.strengthen.comparison import assess_all, combine_ties, compare_fragility
from extrados.analyses.strengthen.measures import Measure, Runs, Statics, meets, over_demand, plain_data
from extrados.analyses.strengthen.outcome import arrays_of, table_of, words
from extrados.analyses.strengthen.sizing import Sized, Sizing
from extrados.analyses.strengthen.space import SpaceStatics
from extrados.analyses.strengthen.tables import Strengthen
from extrados.analyses.strengthen.tie_sizes import size_tie
from extrados.core.calls import stop_if_asked
from extrados.results import strengthen as out
from extrados.results.model import Result


def run(context: Context, options: Strengthen, closely: bool = True) -> Result:
    """Sizes of all alternatives, their costs and adverse effects, the mechanisms that govern before and after.

    closely: False takes the upper bound by dilatant friction where pressed joints slide, in a fraction of the time.
    """
    building, measure = context.building, measure_of(context, options, closely)
    result = Result("strengthen")
    before = measure.of(building, picture=True) if isinstance(measure, Statics) else measure.of_data(plain_data(context))
    met = meets(measure, before)
    work = Sizing(context, options, measure, before)
    sized: list[Sized] = []
    ties = tie_alternatives(building, options) if building.structure is not None else []
    changes = change_alternatives(context, options)
    if met:  # nothing to size
        ties, changes = [], []
    alternatives: list[TieAlternative | ChangeAlternative] = [*ties, *changes]
    for done, one in enumerate(alternatives):
        stop_if_asked()
        context.progress(done, len(ties) + len(changes), "alternatives")
        sized.append(size_tie(work, one) if isinstance(one, TieAlternative) else size_change(work, one))
    sized.sort(key=lambda s: (not s.row.meets_target, np.inf if s.row.cost is None else s.row.cost))
    more: dict[str, Any] = {}
    if options.combine and isinstance(measure, Statics) and len(ties) > 1 and options.ties:
        more |= combine_ties(work, ties)
    if options.assess:
        assess_all(work, sized)
    best = next((s for s in sized if s.row.meets_target), None)
    if options.fragility and best is not None and best.data is not None:
        more["fragility"] = compare_fragility(work, best)
    quantity, unit = _quantity(options)
    result.results = out.Strengthen(
        by=options.by,
        quantity=quantity,
        unit=unit,
        target=measure.target,
        demand=measure.demand,
        direction=_direction(measure, options),
        value_before=before.value,
        safety_factor_before=over_demand(before.value, measure.demand),
        met_before=met,
        mechanism_before=before.mechanism or before.reason,
        interventions=[s.row for s in sized],
        **more,
    )
    if before.value is None:
        result.warnings.append(f"The existing building has no value of the target quantity: {before.reason}")
    if before.unfound:
        result.warnings.append(f"Existing building: {before.unfound}.")
    if before.bound == "upper":
        result.warnings.append(
            "Joints in compression slide in the mechanism of the existing building. Its capacity is therefore an upper bound, or the "
            "lowest value found without dilatancy. The curves of capacity over size are upper bounds."
        )
    if isinstance(measure, Statics) and len(measure.senses) == 1 and building.supports.abutting_wall is None:
        result.warnings.append(measure.other_sense_told(building))
    result.arrays = arrays_of(context, before, sized)
    result.tables = {"strengthen": table_of(sized)}
    result.answer = words(result.results)
    return result


def measure_of(context: Context, options: Strengthen, closely: bool = True) -> Measure:
    """The measure of the target; closely: of limit analysis also the least state without dilatancy, where pressed joints slide."""
    if options.by != "tilt":
        return Runs(context, options)
    return SpaceStatics(context, options) if is_spatial(context.building) else Statics(context, options, closely)


def _quantity(options: Strengthen) -> tuple[str, str]:
    if options.by == "tilt":
        return "Collapse acceleration (horizontal, constant)", "g"
    if options.by == "fragility":
        return "Probability of collapse", ""
    return f"Safety factor by {options.by}", ""


def _direction(measure: Measure, options: Strengthen) -> Any:
    if isinstance(measure, SpaceStatics):
        return None
    if isinstance(measure, Statics) and len(measure.senses) == 1:
        return measure.word(measure.senses[0])
    return options.direction
