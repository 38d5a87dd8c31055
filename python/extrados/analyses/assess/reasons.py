"""Why strategies differ: rules, each of which compares numbers and speaks only where they show it."""

from collections.abc import Callable

from extrados.analyses.assess import reasons_of_buildings as buildings
from extrados.analyses.assess import reasons_of_motion as motion
from extrados.analyses.assess import reasons_of_statics as statics
from extrados.analyses.assess.budget import ENDING
from extrados.analyses.assess.facts import Facts, Pair
from extrados.results.assess import Reason

Rule = Callable[[Facts, list[Pair]], Reason | list[Reason] | None]
RULES: tuple[Rule, ...] = (
    statics.static_peak,
    statics.crack,
    motion.left_out,
    statics.ties_of_statics,
    motion.impact_rule,
    motion.last_digits,
    motion.elements_of_last_digits,
    motion.violated,
    motion.sine_for_record,
    motion.sliding,
    statics.sliding_as_collapse,
    motion.drums,
    motion.hinges_elsewhere,
    statics.membrane,
    statics.mortar,
    buildings.code_factors,
    buildings.code_check,
    buildings.code_spectrum,
    buildings.torn_off,
    buildings.weaker_direction,
    buildings.frame_and_shells,
    motion.chance,
)


def explained(facts: Facts, failed: Callable[[str, Exception], None] | None = None) -> tuple[list[Reason], list[Pair]]:
    """The reasons that the rules find for the pairs that do not agree, and the pairs for which there is none.

    failed: takes the name of a rule that raised, and its error, and the other rules still count; None: the error is raised.
    """
    pairs = facts.pairs()
    said: list[Reason] = []
    for rule in RULES:
        try:
            given = rule(facts, pairs)
        except ENDING:
            raise
        except Exception as error:
            if failed is None:
                raise
            failed(rule.__name__.replace("_", "-"), error)
            continue
        said += given if isinstance(given, list) else [] if given is None else [given]
    found = [one for one in said if one.explains]
    told = {tuple(p) for one in found for p in one.explains}
    return found, [p for p in pairs if p not in told]
