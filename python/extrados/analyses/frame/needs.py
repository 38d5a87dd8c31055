"""What frames of macro-elements need of a deck."""

from collections.abc import Iterator

from extrados.analyses.codes.actions import refuse_mixed
from extrados.analyses.context import Context, Refused
from extrados.analyses.frame.tables import FrameAnalysis, FrameHistory, FramePushover
from extrados.analyses.needs import Need


def needs(context: Context, options: FrameAnalysis) -> Iterator[Need]:
    """Steps that raise where the deck is wrong, see `analyses.needs`."""
    building = context.building
    yield lambda: building.frame(options.frame)
    if isinstance(options, FrameHistory):
        yield context.refuse_motion
    if isinstance(options, FramePushover):
        yield lambda: refuse_mixed(context, options.verification)
    if isinstance(options, FramePushover) and options.control_level is not None:
        yield lambda: _control(context, options)


def _control(context: Context, options: FramePushover) -> None:
    levels = {one.level for one in context.building.frame(options.frame).masses}
    if options.control_level not in levels:
        raise Refused(
            f"control_level is {options.control_level}; masses are on {', '.join(map(str, sorted(levels)))}",
            ("analysis", "control_level"),
        )
