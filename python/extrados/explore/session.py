"""A session: the live deck of one page; messages in, replies out, independent of the transport."""

import logging
import time
from collections.abc import Callable, Generator, Iterator

from extrados.decks.reader import DeckError
from extrados.explore.answers import changes, decks, motion, needed, plan, results, sheet, standalone, views
from extrados.explore.desk import Desk
from extrados.explore.frames import Reply
from extrados.explore.messages import TOLD, BadMessage, Message

log = logging.getLogger(__name__)
#: What a message asks for -> what answers it
ANSWERS: dict[str, Callable[[Desk, Message], Iterator[Reply]]] = {
    "hello": decks.hello,
    "list": decks.list_folder,
    "open": decks.open_deck,
    "drop": decks.drop,
    "blocks": decks.blocks,
    "analysis": decks.analysis,
    "save": decks.save,
    "drag": changes.drag,
    "set": changes.set_keys,
    "rest": changes.rest,
    "show": views.show,
    "push": views.push,
    "fall": views.fall,
    "standalone": standalone.standalone,
    "rocking": motion.response,
    "impulse": motion.impulse,
    "domain": motion.domain,
    "run": results.stored_run,
    "compute": results.compute,
    "figures": results.figures,
    "needed": needed.needed,
    "sheet": sheet.sheet,
    "draw": sheet.draw,
    "plan": plan.plan,
    "draw-plan": plan.draw_plan,
    "push-plan": plan.push_plan,
}


class Session(Desk):
    """The desk of one page; `answer` a message at a time, from one thread at a time.

    A reply holds `of`, the number of the message it answers, and `ms`, the processor time of this thread that it took. What
    is wrong with a deck or has no answer comes as `complaints`, and then nothing has changed.
    """

    def answer(self, message: Message) -> Generator[Reply, None, None]:
        """Replies to a message, one after the other: between two of them others may be answered."""
        number = message.get("of") if isinstance(message.get("of"), int | None) else None
        do = ANSWERS.get(message["do"]) if isinstance(message.get("do"), str) else None
        try:
            if do is None:
                raise BadMessage(f"the page sent an unknown request: '{str(message.get('do'))[:40]}'")
            begin = time.thread_time()
            for reply in do(self, message):
                spent = 1e3 * (time.thread_time() - begin)
                reply.words = {"of": number, "to": message["do"], "ms": spent, **reply.words}
                yield reply
                begin = time.thread_time()
        except TOLD as error:
            complaints = error.complaints if isinstance(error, DeckError) else [str(error)]
            yield Reply({"of": number, "to": message["do"], "complaints": [c[:2000] for c in complaints]})
        except BadMessage as error:
            yield Reply({"of": number, "to": str(message.get("do"))[:40], "bad": str(error)[:2000]})
        except RecursionError:
            yield Reply({"of": number, "to": message["do"], "complaints": ["the deck is nested too deeply"]})
        except Exception as error:  # the page lives on: it is told, and what it holds stays as it was
            log.exception("a page requested %s", message["do"])
            told = f"this is a fault of extrados, please report it: {type(error).__name__}: {error}"
            yield Reply({"of": number, "to": message["do"], "complaints": [told[:2000]]})
