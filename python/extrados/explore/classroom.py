"""A class: a bounded session without files for each pupil, and the overview of the teacher.

Decks of pupils are texts, starters, or cases with known results, and can use only shipped ground motions. Size of deck,
number of blocks, duration of motions, and computing time are bounded. Nothing is written to disk.
"""

import asyncio
import time
from collections.abc import Callable, Generator
from pathlib import Path
from typing import Any

import numpy as np

from extrados.decks.reader import DeckError
from extrados.explore.desk import Desk
from extrados.explore.frames import Reply
from extrados.explore.messages import BadMessage, Message
from extrados.explore.session import Session
from extrados.model.errors import BadGeometry, NoView

#: Pupils at a time unless the teacher chooses another number; threads that compute for all of them
PUPILS, THREADS = 30, 2
#: What pupils may ask for: nothing that reads or writes a file or starts a process
ASKED = {
    "hello",
    "open",
    "blocks",
    "sheet",
    "draw",
    "plan",
    "draw-plan",
    "push-plan",
    "analysis",
    "drag",
    "set",
    "rest",
    "show",
    "push",
    "fall",
    "rocking",
    "impulse",
    "domain",
}
#: Characters of a deck, blocks of a structure, seconds of a motion or a response
LARGEST_DECK, MOST_BLOCKS, LONGEST = 64_000, 300, 60.0
#: Computing time that a pupil may use at once [s], and in each second from then on [-]
BURST_TIME, TIME_RATE = 20.0, 0.5
#: Blocks whose outlines the teacher sees
MOST_SEEN = 150
#: The folder of pupils, which is not there
NOWHERE = Path("/nonexistent/extrados-class")


class Classroom:
    """The pupils of a class by their numbers. frozen: pupils can view but not change anything. changes: number of their changes.

    The serving loop owns `pupils`; any thread may read all other attributes.
    """

    def __init__(self, most: int = PUPILS):
        self.most, self.frozen, self.changes = most, False, 0
        self.pupils: dict[int, Pupil] = {}
        self.loop: asyncio.AbstractEventLoop | None = None

    def join(self, put: Callable[[Message], None]) -> "Pupil | None":
        """A session for one more pupil, whose messages are `put`; None if the class is full."""
        number = next((n for n in range(1, self.most + 1) if n not in self.pupils), None)
        if number is None:
            return None
        self.loop = asyncio.get_running_loop()
        self.pupils[number] = Pupil(self, number, put)
        return self.pupils[number]

    def leave(self, pupil: "Pupil") -> None:
        """Forget a pupil."""
        self.pupils.pop(pupil.number, None)
        self.changes += 1

    def tell_all(self, message: Message) -> None:
        """Put a message of the teacher before all pupils; from any thread."""
        for pupil in list(self.pupils.values()):
            if self.loop is not None:
                self.loop.call_soon_threadsafe(pupil.put, {**message, "teacher": self})


class Pupil(Session):
    """The session of a pupil. seen, text: the view of the teacher; left: remaining computing time [s]."""

    shipped_alone = True

    def __init__(self, room: Classroom, number: int, put: Callable[[Message], None]):
        super().__init__(NOWHERE)
        self.room, self.number, self.put = room, number, put
        self.seen: dict[str, Any] = {}
        self.text = ""
        self.left, self.last = BURST_TIME, time.monotonic()

    def spend(self, seconds: float) -> float:
        """Note computing time; how long the pupil waits for more [s]."""
        now = time.monotonic()
        self.left = min(BURST_TIME, self.left + (now - self.last) * TIME_RATE) - seconds
        self.last = now
        return max(0.0, -self.left / TIME_RATE)

    def answer(self, message: Message) -> Generator[Reply, None, None]:
        """Replies to a message, or why there is none in a class."""
        do, by_teacher = message.get("do"), message.get("teacher") is self.room
        told = {"of": message.get("of") if isinstance(message.get("of"), int) else None, "to": str(do)[:40]}
        kept = message.get("kept")
        if isinstance(kept, dict):  # no files that were dropped
            message = {**message, "kept": {key: kept[key] for key in ("text", "name", "preset") if key in kept}}
        text = kept.get("text") if isinstance(kept, dict) else message.get("text")
        if do == "pause" and by_teacher:
            yield Reply({**told, "frozen": self.room.frozen})
        elif do not in ASKED or any(key in message for key in ("path", "dropped")) or message.get("here") == "dropped":
            yield Reply({**told, "bad": "pupils of a class cannot open files or start runs"})
        elif self.room.frozen and not by_teacher and do not in ("hello", "rest"):
            yield Reply({**told, "bad": "the teacher has paused the class"})
        elif isinstance(text, str) and len(text) > LARGEST_DECK:
            yield Reply({**told, "bad": f"in a class a deck may have at most {LARGEST_DECK} characters"})
        else:
            for reply in super().answer(message):
                self._note(reply)
                yield reply

    def _note(self, reply: Reply) -> None:
        """Keep what the teacher sees of a reply."""
        words = reply.words
        if "presets" in words:
            words |= {"pupil": self.number, "frozen": self.room.frozen, "folder": ""}
        if isinstance(words.get("text"), str):
            self.text = words["text"]
        if "scene" in words:
            self.room.changes += 1
            self.seen = {**thumbnail(reply), "change": self.room.changes}

    def check(self) -> None:
        """DeckError if the deck at hand is too large for a class."""
        deck, wrong = self.there().deck, []
        counts = [] if deck.structure is None else [v for v in deck.structure.model_dump().values() if isinstance(v, int)]
        if max(counts, default=0) > MOST_BLOCKS or _blocks(self) > MOST_BLOCKS:
            wrong.append(f"in a class a structure may have at most {MOST_BLOCKS} blocks")
        lasting = [getattr(deck.motion, name, None) for name in ("duration", "period")]
        lasting += [getattr(options, "end_time", None) for options in deck.analyses]
        if max((v for v in lasting if isinstance(v, int | float)), default=0.0) > LONGEST:
            wrong.append(f"in a class motions and responses may last at most {LONGEST:g} s")
        if wrong:
            raise DeckError(wrong)


def _blocks(desk: Desk) -> int:
    """Number of blocks of the structure at hand; 0 if it is no plane section."""
    try:
        return len(desk.there().deck.building.blocks().mass)
    except (NoView, BadGeometry):
        return 0


def thumbnail(reply: Reply) -> dict[str, Any]:
    """The drawing of a scene as an SVG path with its box, the tilt [g], and whether the structure is stable."""
    scene, title = reply.words["scene"], reply.words.get("deck", {}).get("title") or ""
    outline, start = reply.arrays.get("outline"), reply.arrays.get("outline_start")
    seen = {"title": title[:80], "gamma": scene.get("gamma"), "falls": scene.get("falls"), "capacity": scene.get("capacity")}
    if outline is None or start is None or not len(outline):
        return seen
    low, high = outline.min(axis=0), outline.max(axis=0)
    places = np.round(1000.0 * (outline - low) / float((high - low).max())).astype(int)
    height = int(places[:, 1].max())
    pieces = [
        "M" + "L".join(f"{x} {height - y}" for x, y in places[a:b].tolist()) + "Z"
        for a, b in zip(start[:-1][:MOST_SEEN], start[1:], strict=False)
    ]
    return {**seen, "box": [int(places[:, 0].max()), height], "path": "".join(pieces)}


class Teacher(Session):
    """The session of the teacher: the page as ever, and the class."""

    def __init__(self, folder: Path, first: str | None, room: Classroom):
        super().__init__(folder, first)
        self.room = room

    def answer(self, message: Message) -> Generator[Reply, None, None]:
        """Replies to a message; those of the class are {class}, {send}, {pause} and {peek}."""
        act = {"class": self._class, "send": self._send, "pause": self._pause, "peek": self._peek}.get(str(message.get("do")))
        if act is None:
            for reply in super().answer(message):
                if "presets" in reply.words:
                    reply.words["class"] = {"most": self.room.most}
                yield reply
            return
        told = {"of": message.get("of") if isinstance(message.get("of"), int) else None, "to": message["do"]}
        try:
            yield Reply({**told, **act(message)})
        except BadMessage as error:
            yield Reply({**told, "bad": str(error)})

    def _class(self, message: Message) -> dict[str, Any]:
        """The pupils, with the drawings that changed since the change `since`."""
        since = message.get("since") if isinstance(message.get("since"), int) else -1
        room, rows = self.room, []
        now = room.changes
        for number, pupil in sorted(room.pupils.items()):
            seen = pupil.seen
            rows.append({"number": number, **(seen if seen.get("change", 0) > since else {})})
        return {"class": {"pupils": rows, "change": now, "frozen": room.frozen, "most": room.most}}

    def _send(self, _: Message) -> dict[str, Any]:
        """Open the teacher's deck on all pages."""
        self.there()
        self.room.tell_all({"do": "open", "text": self.document.text, "name": self.name})
        return {"sent": len(self.room.pupils)}

    def _pause(self, message: Message) -> dict[str, Any]:
        """Freeze the class, or let it go on."""
        self.room.frozen = message.get("frozen") is True
        self.room.tell_all({"do": "pause"})
        return {"frozen": self.room.frozen}

    def _peek(self, message: Message) -> dict[str, Any]:
        """The deck of a pupil."""
        pupil = self.room.pupils.get(message.get("number", 0))
        if pupil is None:
            raise BadMessage("the class has no pupil of this number")
        return {"peeked": pupil.text, "number": pupil.number}
