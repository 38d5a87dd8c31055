"""Run the analyses of a deck in order, on one building and one motion."""

import time
import traceback

from extrados import kinds
from extrados.analyses.batches import Unfinished
from extrados.analyses.context import Context, Refused
from extrados.building.errors import BadGeometry
from extrados.core.errors import Cancelled, CoreError
from extrados.limit.solver import NoAnswer
from extrados.results.model import Result


def run_analyses(context: Context) -> list[Result]:
    """All analyses of the deck in order; after Ctrl-C the rest is marked interrupted."""
    results: list[Result] = []
    stopped = False
    for options, building in zip(context.deck.analyses, context.deck.buildings, strict=True):
        if stopped:
            results.append(Result(options.kind, "interrupted", "not run: interrupted before"))
            continue
        begin = time.perf_counter()
        try:
            context.warnings, context.building = [], building
            result = kinds.load(kinds.ANALYSES[options.kind].driver)(context, options)
            result.warnings = [*context.warnings, *result.warnings]
        except (Refused, BadGeometry) as error:
            result = Result(options.kind, "refused", str(error))
        except Unfinished as error:
            result = Result(options.kind, "interrupted" if error.interrupted else "failed", str(error))
        except (Cancelled, KeyboardInterrupt):
            result = Result(options.kind, "interrupted", "interrupted before it had a result")
        except MemoryError as error:
            result = Result(options.kind, "failed", str(error) or "not enough memory")
        except (CoreError, NoAnswer) as error:
            result = Result(options.kind, "failed", str(error))
        except Exception as error:  # a fault of ours: the other analyses of the deck still count
            name = f"internal-error-{options.kind}.txt"
            result = Result(
                options.kind, "failed", f"internal error, please report it with {name}: {type(error).__name__}: {error}"
            )
            result.files[name] = traceback.format_exc().encode()
        result.seconds = time.perf_counter() - begin
        stopped = result.status == "interrupted"
        results.append(result)
    return results
