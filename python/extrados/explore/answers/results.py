"""Results: runs that are stored in the folder, and runs of the deck at hand."""

from collections.abc import Iterator

from extrados.explore.answers.decks import saved
from extrados.explore.desk import Desk
from extrados.explore.frames import Reply
from extrados.explore.messages import BadMessage, Message, path
from extrados.show.charts import shown


def stored_run(desk: Desk, message: Message) -> Iterator[Reply]:
    """A stored run of the folder: its words; then, of one analysis, all that its view draws."""
    place = path(message)
    name = message.get("analysis") if isinstance(message.get("analysis"), str) else None
    words, arrays = shown(desk.folder.run(place), name)
    yield Reply({"run": {**words, "path": place, "side": message.get("side")}}, arrays, frozenset(("time",)))


def figures(desk: Desk, message: Message) -> Iterator[Reply]:
    """The figures of one analysis of a stored run, as its report has them."""
    name = message.get("analysis")
    if not isinstance(name, str):
        raise BadMessage("the request must name an analysis of the deck")
    found = desk.folder.figures(path(message), name)
    yield Reply({"figures": [{"name": name, "svg": svg} for name, svg in found]})


def compute(desk: Desk, message: Message) -> Iterator[Reply]:
    """Save the deck and run all its analyses by the command line, in a process of its own; progress as it comes."""
    place = saved(desk, message)
    for line, done in desk.folder.compute(place):
        yield Reply({"computing": line, "done": done, "runs": desk.folder.runs() if done else None, "saved": place})
