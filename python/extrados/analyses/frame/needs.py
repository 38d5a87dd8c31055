"""What frames of macro-elements need of a deck."""

from collections.abc import Iterator

from extrados.analyses.codes.actions import refuse_mixed
from extrados.analyses.context import Context, Refused
from extrados.analyses.frame.sampled import refuse_unknown
from extrados.analyses.frame.tables import FrameAnalysis, FrameFragility, FrameHistory, FramePushover, Modes
from extrados.analyses.motion_source import how_many
from extrados.analyses.needs import Need

#: Blocks whose modes are calculated, at most
MOST_BLOCKS = 1500


def needs(context: Context, options: FrameAnalysis | Modes) -> Iterator[Need]:
    """Steps that raise where the deck is wrong, see `analyses.needs`."""
    building = context.building
    if isinstance(options, Modes):
        yield lambda: _few(context)
        return
    yield lambda: building.frame(options.frame)
    if isinstance(options, FrameHistory | FrameFragility):
        yield context.refuse_motion
    if isinstance(options, FrameFragility):
        yield lambda: refuse_unknown(building, options.frame, sorted(options.uncertain))
        yield lambda: _enough(context, options)
    if isinstance(options, FramePushover):
        yield lambda: refuse_mixed(context, options.verification)
    if isinstance(options, FramePushover) and options.control_level is not None:
        yield lambda: _control(context, options)


def _control(context: Context, options: FramePushover) -> None:
    levels = {one.level for one in context.building.frame(options.frame).masses}
    if options.control_level not in levels:
        raise Refused(
            f"`control_level` is {options.control_level}: give a level that has masses: {', '.join(map(str, sorted(levels)))}",
            ("analysis", "control_level"),
        )


def _enough(context: Context, options: FrameFragility) -> None:
    """Refused where one motion is to give a fragility, or more are asked for than the deck has and no building differs."""
    there = how_many(context)
    if there == 1 and not options.uncertain:
        raise Refused("one motion of one building gives no fragility: give a set of motions, or uncertain values", ("motion",))
    if there is not None and options.count is not None and options.count > there and not options.uncertain:
        raise Refused(f"the key `count` is {options.count}, but the deck has {there} motions: give at most {there}", ("analysis", "count"))


def _few(context: Context) -> None:
    count = len(context.building.blocks().mass)
    if count > MOST_BLOCKS:
        raise Refused(f"the structure has {count} blocks; modes can be calculated for at most {MOST_BLOCKS}", ("structure",))
