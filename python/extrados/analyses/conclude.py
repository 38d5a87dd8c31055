"""What every result tells beside its numbers: the verdict on the deck's demand, and what was assumed of the building.

Apart from the drivers, so that a changed motion or default recomputes no analysis that does not look at it.
"""

import traceback
from dataclasses import replace
from functools import cached_property

from extrados import room
from extrados.analyses.context import Context, Refused
from extrados.analyses.table import Analysis
from extrados.motions.from_deck import is_set
from extrados.motions.tables import Pulse, SinePulse, StepPulse
from extrados.results.assumptions import Assumption, Origin, spoken
from extrados.results.model import Result
from extrados.results.verdict import judge
from extrados.schema.constants import GRAVITY
from extrados.schema.quantities import unit_of
from extrados.schema.table import Table
from extrados.views.building import Building


class MotionDemand:
    """What the motion of a deck asks (results.verdict.Demand); the motion is made when its peak is asked for."""

    def __init__(self, context: Context):
        self.context = context
        self.pulse, self.duration_s, self.amplitude_g = "", 0.0, 0.0
        motion = context.deck.motion
        match None if motion is None or motion.floor is not None else motion:  # a floor turns a pulse into another motion
            case StepPulse() as m:
                self.pulse, self.duration_s, self.amplitude_g = "step", m.duration, abs(m.amplitude) / GRAVITY
            case SinePulse() as m:
                self.pulse, self.duration_s, self.amplitude_g = "sine", m.period, abs(m.amplitude) / GRAVITY
            case Pulse() as m:
                self.pulse, self.duration_s, self.amplitude_g = m.shape, m.period, abs(m.amplitude) / GRAVITY

    @cached_property
    def peak_g(self) -> float | None:
        """None without a motion, with many, and with one that cannot be read: who needs it has refused by then."""
        if self.context.deck.motion is None or is_set(self.context.deck.motion):
            return None
        try:
            return self.context.motion.peak / GRAVITY
        except Refused:
            return None


def concluded(result: Result, options: Analysis, context: Context, building: Building) -> Result:
    """The result with its verdict, its assumptions, and an answer that tells them; one that was refused with the
    assumptions alone, any other without results as it is.

    building: the building as the analysis saw it.
    """
    try:
        verdict = result.results.judged(MotionDemand(context))
        if verdict is None and result.status != "refused":
            return result
        assumptions = assumptions_of(options, context.deck.building, building)
    except Exception as error:  # the other analyses of the deck still count
        return replace(faulty(result.kind, error, context.resume), seconds=result.seconds)
    # also of a motion that the verdict alone has taken
    result = replace(result, warnings=[*result.warnings, *(w for w in context.warnings if w not in result.warnings)])
    if verdict is None:
        return replace(result, assumptions=assumptions)
    answer = f"{result.answer} {spoken(assumptions)}".strip()
    if verdict.outcome == "open" and verdict.violated:
        answer = f"Outcome open: {verdict.violated[0]} As modelled: {answer}"
    # Half a motion, half a curve: neither stands for the whole
    if result.status == "interrupted" and not result.results.whole_in_parts:
        verdict = judge("The analysis was interrupted before its end, so there is no verdict.")
        answer = f"The analysis was interrupted before its end. Result up to the interruption: {answer}"
    return replace(result, verdict=verdict, assumptions=assumptions, answer=answer)


def faulty(kind: str, error: Exception, resumed: bool = False) -> Result:
    """What an analysis gives where memory lacked or the program is at fault: the reason, and a file to report.

    A MemoryError that stands for no other error was foreseen and needs no file. resumed: batches of an earlier run may have been used,
    of which a checksum shows damage, but not that a stranger made them.
    """
    if isinstance(error, MemoryError) and error.__cause__ is None:
        return Result(kind, "failed", room.words(error))
    name, said = f"internal-error-{kind}.txt", f"{type(error).__name__}: {error}"
    try:
        files = {name: "".join(traceback.format_exception(error)).encode()}
    except (MemoryError, SystemError):  # so little is left that there is no room for the file either
        files = {}
    if isinstance(error, MemoryError) or room.lacked(error):
        reason = str(error) if isinstance(error, MemoryError) else f"not enough memory: {said}"
        return Result(kind, "failed", f"{reason} ({name} says where)" if files else reason, files=files)
    beside = f" with {name}" if files else ""
    if resumed:
        reason = (
            f"the saved batches of this run do not contain results of this analysis: {said}. Run again "
            f"without --resume; if that fails too, please report it{beside}"
        )
        return Result(kind, "failed", reason, files=files)
    return Result(kind, "failed", f"internal error of extrados, please report it{beside}: {said}", files=files)


def assumptions_of(options: Analysis, deck: Building, building: Building) -> dict[str, Assumption]:
    """Key -> assumption for all that the analysis rests on, but for a key that it varies itself.

    deck: the building as the deck's own tables say it; building: as the analysis sees it.
    """
    found = {}
    origin: Origin
    for key, fixed in options.rests_on(building).items():
        if key == getattr(options, "vary", None):
            continue
        table, name = key.split(".")
        if fixed is not None:
            found[key] = Assumption(value=fixed, unit="", origin="method", exceptions=False)
            continue
        own: Table = getattr(building, table)
        override = getattr(options, table, None)
        if override is not None and name in override.model_fields_set:
            origin = "analysis"
        else:
            origin = "deck" if name in getattr(deck, table).model_fields_set else "default"
        differ = building.materials.values() if table == "material" else getattr(own, "types", [])
        found[key] = Assumption(
            value=getattr(own, name),
            unit=unit_of(type(own), name),
            origin=origin,
            exceptions=any(getattr(one, name, None) is not None for one in differ),
        )
    return found
