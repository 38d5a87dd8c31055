"""Run the analyses of a deck in order, on one building and one motion."""

import time

from extrados import interrupts, kinds, room
from extrados.analyses.batches import Unfinished
from extrados.analyses.conclude import concluded, faulty
from extrados.analyses.context import Context, Refused
from extrados.analyses.left_out import Remark, left_out
from extrados.analyses.needs import complaints
from extrados.analyses.table import Analysis
from extrados.core.errors import Cancelled, CoreError
from extrados.decks.reader import Deck
from extrados.limit.errors import CannotStand, Immovable, NoAnswer
from extrados.model.errors import WHOLE, BadGeometry
from extrados.results.model import Result
from extrados.results.store import StoreError
from extrados.results.typed import shapes
from extrados.results.verdict import KindResults
from extrados.views.building import Building


def _check(result: Result) -> None:
    """TypeError where a driver gives other results than its kind has."""
    bare = type(result.results) is KindResults
    if not isinstance(result.results, shapes(result.kind)) and (result.status == "ok" or not bare):
        expected = " or ".join(model.__name__ for model in shapes(result.kind))
        raise TypeError(f"the driver of {result.kind} gives {type(result.results).__name__}, expected {expected}")


def run_analyses(context: Context) -> list[Result]:
    """All analyses of the deck in order; after Ctrl-C the rest is marked interrupted."""
    results: list[Result] = []
    told: tuple[str, ...] = ()
    ignored = _ignored(context.deck)
    for options, building in zip(context.deck.analyses, context.deck.buildings, strict=True):
        if results and results[-1].status == "interrupted":
            results.append(Result(options.kind, "interrupted", "not run: interrupted before"))
            continue
        try:
            result = concluded(run_one(context, options, building), options, context, building)
        except (MemoryError, SystemError) as error:  # there was no room to tell the end before the analysis had let go
            result = faulty(options.kind, error, context.resume)
        _, notes = building.told()
        if notes != told:  # what was made of a survey is told once
            result.warnings, told = [*notes, *result.warnings], notes
        result.warnings += [remark.text for remark in ignored if remark.analysis == len(results)]
        results.append(result)
    return results


def _ignored(deck: Deck) -> list[Remark]:
    """What none of the analyses uses; nothing where the building cannot be made, which the analysis that looks at it says."""
    try:
        return left_out(deck)
    except (BadGeometry, CoreError, MemoryError):
        return []


def run_one(context: Context, options: Analysis, building: Building) -> Result:
    """One analysis of a building, without its verdict; what it refuses and what fails is told in its result."""
    begin, signals = time.perf_counter(), len(interrupts.asked)
    try:
        context.warnings = []
        if wrong := complaints(context, options, building):
            raise Refused("; ".join(wrong), WHOLE)
        if not room.has(room.NEEDED):
            raise MemoryError(f"not enough memory: an analysis needs {room.NEEDED >> 20} MB of address space")
        result = kinds.load(kinds.ANALYSES[options.kind].driver)(context, options)
        _check(result)
    except CannotStand as error:
        from extrados.analyses.limit.self_weight import collapses_at_rest  # loaded with the solver that proved it

        result = collapses_at_rest(options.kind, error, building)
    except (Refused, BadGeometry) as error:
        result = Result(options.kind, "refused", context.complaint(options, error))
    except Immovable as error:
        result = Result(options.kind, "refused", str(error))
    except Unfinished as error:
        result = Result(options.kind, "interrupted" if error.interrupted else "failed", str(error))
    except (Cancelled, KeyboardInterrupt):
        result = Result(options.kind, "interrupted", "the analysis was interrupted before it had a result")
    except (CoreError, NoAnswer, StoreError) as error:
        result = Result(options.kind, "failed", str(error))
    except Exception as error:
        if len(interrupts.asked) > signals:  # a library that was interrupted while it is loaded says what it likes
            result = Result(options.kind, "interrupted", "the analysis was interrupted before it had a result")
        else:  # the other analyses of the deck still count
            result = faulty(options.kind, error, context.resume)
    remarks, _ = building.told()
    result.warnings = [*remarks, *context.warnings, *result.warnings]
    result.seconds = time.perf_counter() - begin
    return result
