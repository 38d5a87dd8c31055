"""A session: one page's deck, kept alive; messages of the page in, replies out. It knows nothing of how they travel."""

import base64
import binascii
import copy
import logging
import re
import shutil
import tempfile
import time
import tomllib
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from extrados import kinds
from extrados._build_info import VERSION
from extrados.analyses.context import Refused
from extrados.analyses.limit.applied import block_under
from extrados.analyses.limit.tables import LimitAnalysisTable, Tilt
from extrados.analyses.rocking.tables import FailureDomain, Rocking
from extrados.analyses.run import run_one
from extrados.building.errors import BadGeometry, NoView
from extrados.core.errors import CoreError
from extrados.decks.explain import starter
from extrados.decks.reader import LARGEST, DeckError, read_text
from extrados.explore import bodies, rocking, statics, stored
from extrados.explore import handles as hands
from extrados.explore.document import Document, as_written, tidy
from extrados.explore.folder import CASES, Folder, NotThere
from extrados.explore.frames import Reply
from extrados.limit.programme import NoAnswer, NoEquilibrium
from extrados.running.live import Live
from extrados.schema import quantities

log = logging.getLogger(__name__)
#: Bytes of a drawing or a record that is dropped on the page
LARGEST_DROP = 8_000_000
DROPS = {".dxf", ".json", ".csv", ".txt", ".at2", ".toml"}
NEW_DECK = """title = "A new arch"

[structure]
kind = "arch"
radius = 5.0
thickness = 0.75
embrace = 157.5
voussoirs = 36

[[analysis]]
kind = "tilt"
"""
#: What may go wrong with a building or a question that a hand asks for: told, not raised
TOLD = (DeckError, BadGeometry, Refused, NoView, NoAnswer, NoEquilibrium, CoreError, NotThere, stored.StoreError)
NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9 ._-]{0,120}")


class BadMessage(ValueError):
    """A message that no page of ours sends."""


class Session:
    """The deck of one page; `answer` a message at a time, from one thread at a time.

    A reply holds `of`, the number of the message it answers, and `ms`, the processor time of this thread that it took. What is wrong with a deck or has no answer comes as
    `complaints`, and then nothing has changed.
    """

    def __init__(self, folder: Path, first: str | None = None):
        self.folder, self.first = Folder(folder), first
        self._scratch: Path | None = None
        self.place: Path = folder
        self.document = Document(NEW_DECK)
        self.name = "deck.toml"
        self.live: Live | None = None
        self.view = statics.View()
        self.picture: statics.Picture | None = None
        self.anchor = np.zeros(2)
        self.handles: dict[str, hands.Handle] = {}
        self._held: np.ndarray | None = None
        self._maps: dict[str, list[tuple[dict[str, Any], dict[str, np.ndarray]]]] = {}

    def close(self) -> None:
        """Forget what was dropped."""
        if self._scratch is not None:
            shutil.rmtree(self._scratch, ignore_errors=True)
            self._scratch = None

    def answer(self, message: dict[str, Any]) -> Iterator[Reply]:
        """Replies to a message, one after the other: between two of them others may be answered."""
        number = message.get("of") if isinstance(message.get("of"), int | None) else None
        do = _DOES.get(message["do"]) if isinstance(message.get("do"), str) else None
        try:
            if do is None:
                raise BadMessage(f"nothing is known of '{str(message.get('do'))[:40]}'")
            begin = time.thread_time()
            for reply in do(self, message):
                reply.words = {
                    "of": number,
                    "to": message["do"],
                    "ms": 1e3 * (time.thread_time() - begin),
                    **reply.words,
                }
                yield reply
                begin = time.thread_time()
        except TOLD as error:
            complaints = error.complaints if isinstance(error, DeckError) else [str(error)]
            yield Reply({"of": number, "to": message["do"], "complaints": [c[:2000] for c in complaints]})
        except BadMessage as error:
            yield Reply({"of": number, "to": str(message.get("do"))[:40], "bad": str(error)[:2000]})
        except RecursionError:
            yield Reply({"of": number, "to": message["do"], "complaints": ["is nested too deeply for a deck"]})
        except Exception as error:  # the page lives on: it is told, and what it holds stays as it was
            log.exception("a page asked for %s", message["do"])
            told = f"this is a fault of the program, please report it: {type(error).__name__}: {error}"
            yield Reply({"of": number, "to": message["do"], "complaints": [told[:2000]]})

    # Decks

    def _hello(self, message: dict[str, Any]) -> Iterator[Reply]:
        """What there is to choose from; then the first deck, or the one that the page still has."""
        yield Reply(
            {
                "version": VERSION, "presets": self.folder.presets(), "decks": self.folder.decks(), "runs": self.folder.runs(),
                "folder": str(self.folder.root), "kinds": {section: list(there) for section, there in kinds.TABLES.items()},
            }
        )  # fmt: skip
        kept = message.get("kept")
        if isinstance(kept, dict) and isinstance(kept.get("text"), str):
            for drop in kept.get("drops", [])[:20]:
                self._keep_drop(drop)
            yield from self._open({**kept, "do": "open"})
        elif self.first is not None:
            yield from self._open({"path": self.first})
        else:
            yield from self._open({"text": NEW_DECK, "name": "new-arch.toml"})

    def _list(self, _: dict[str, Any]) -> Iterator[Reply]:
        yield Reply({"decks": self.folder.decks(), "runs": self.folder.runs()})

    def _open(self, message: dict[str, Any]) -> Iterator[Reply]:
        """A preset, a deck of the folder, a starter deck, or a text beside the files of one of these."""
        source = {key: message[key] for key in ("preset", "path", "dropped") if isinstance(message.get(key), str)}
        if "preset" in source:
            raw, place, name = self.folder.preset(source["preset"])
        elif "path" in source:
            raw, place, name = self.folder.deck(source["path"])
        else:
            raw, name = b"", message.get("name") if isinstance(message.get("name"), str) else self.name
            place = self._drops() if "dropped" in source or message.get("here") == "dropped" else self.folder.root
        if isinstance(message.get("starter"), str):
            try:
                raw = starter(message["starter"]).encode()
            except KeyError as error:
                raise NotThere(str(error.args[0])) from None
            name = f"{message['starter']}.toml"
        if isinstance(message.get("text"), str):
            raw = message["text"].encode("utf-8", "replace")
            if message.get("here") == "same":
                place, name = self.place, self.name
        if len(raw) > LARGEST:
            raise NotThere(f"{name}: is too large for a deck")
        live = Live(read_text(raw, Path(name).name, place))
        before = self.live, self.place, self.name, self.document, self.view
        self.live, self.place, self.name = live, place, Path(name).name
        self.document = Document(raw.decode("utf-8-sig"))
        same = message.get("here") == "same"
        if not same:
            self.view = statics.View(lines=self.view.lines)
        self._held = None
        try:
            reply = self._scene()
        except BaseException:
            self.live, self.place, self.name, self.document, self.view = before
            raise
        source_words = source or ({"here": "dropped"} if place == self._scratch else {})
        reply.words |= {"opened": not same, "source": source_words, "text": self.document.text, "name": self.name}
        reply.words |= {"forms": self._forms()}
        yield reply

    def _drops(self) -> Path:
        if self._scratch is None:
            self._scratch = Path(tempfile.mkdtemp(prefix="extrados-page-"))
        return self._scratch

    def _keep_drop(self, message: dict[str, Any]) -> Path:
        name, data = message.get("name"), message.get("data")
        if not isinstance(name, str) or not isinstance(data, str) or not NAME.fullmatch(name) or ".." in name:
            raise NotThere("the name of the file may hold letters, digits, blanks, dots, - and _ only")
        if Path(name).suffix.lower() not in DROPS:
            raise NotThere(f"{name}: expected one of {', '.join(sorted(DROPS))}")
        if len(data) > LARGEST_DROP * 4 // 3 + 4:
            raise NotThere(f"{name}: is larger than {LARGEST_DROP / 1e6:g} MB")
        try:
            content = base64.b64decode(data, validate=True)
        except (binascii.Error, ValueError):
            raise BadMessage("the file is not sent as base64") from None
        target = self._drops() / name
        target.write_bytes(content)
        return target

    def _drop(self, message: dict[str, Any]) -> Iterator[Reply]:
        """A file dropped on the page: a deck, a drawing that becomes a deck of blocks, or a record for the deck at hand."""
        target = self._keep_drop(message)
        sort = target.suffix.lower()
        if sort == ".toml":
            yield from self._open({"text": target.read_text("utf-8", "replace"), "name": target.name, "dropped": "1"})
        elif sort in (".dxf", ".json"):
            unit = message.get("unit")
            told = f"unit = {unit!r}\n".replace("'", '"') if unit in ("m", "cm", "mm", "in", "ft") else ""
            text = (
                f'title = "{target.stem}"\n\n[structure]\nkind = "blocks"\nfile = "{target.name}"\n{told}\n'
                '[[analysis]]\nkind = "tilt"\n'
            )
            yield from self._open({"text": text, "name": f"{target.stem}.toml", "dropped": target.name})
        else:
            yield from self._record(target)

    def _record(self, target: Path) -> Iterator[Reply]:
        """The deck at hand under a record that was dropped: both then lie where dropped files do."""
        live, drops = self._there(), self._drops()
        if self.place != drops:
            for name in _files_of(live.deck.data):
                try:
                    (drops / Path(name).name).write_bytes(self.folder.beside(self.place, name))
                except NotThere:
                    continue
        document = Document(self.document.text)
        document.put(["motion"], None)
        document.put(["motion"], {"kind": "record", "file": target.name})
        yield from self._open({"text": document.text, "name": self.name, "dropped": target.name})

    def _blocks(self, _: dict[str, Any]) -> Iterator[Reply]:
        """The stones of any building as free blocks, whose vertices hands can move."""
        live = self._there()
        assembly = live.deck.building.blocks()
        count = sum(map(len, assembly.outlines))
        if count > hands.MOST_VERTICES * 3:
            raise Refused(f"{len(assembly.mass)} stones of {count} vertices are too many to move by hand")
        rows = [
            f"[[structure.block]]\nname = {name!r}\npoints = {_thinned(outline)}\n".replace("'", '"')
            for name, outline in zip(assembly.block_names, assembly.outlines, strict=True)
        ]
        grounded = [j for j in range(len(assembly.a)) if -1 in (assembly.a[j], assembly.b[j])]
        ground = [[round(float(v), 6) for v in (*assembly.p[j], *assembly.q[j])] for j in grounded]
        title = live.deck.title or live.deck.building._structure().word
        text = (
            f'title = "{title.replace(chr(34), chr(39))}, its stones free"\n\n[structure]\nkind = "blocks"\n'
            f'ground = {ground}\ncontact_tolerance = "1 mm"\n\n{chr(10).join(rows)}\n[[analysis]]\nkind = "tilt"\n'
        )
        yield from self._open({"text": text, "name": "free-blocks.toml"})

    def _save(self, message: dict[str, Any]) -> Iterator[Reply]:
        """The deck into the working folder, with the dropped files it names."""
        saved = self._saved(message)
        yield Reply({"saved": saved, "decks": self.folder.decks()})

    def _saved(self, message: dict[str, Any]) -> str:
        """Where the deck was saved in the working folder, at the path of a message, with the dropped files it names."""
        path = message.get("path")
        if not isinstance(path, str):
            raise BadMessage("expected a path")
        beside = {}
        if self.place != self.folder.root:
            for name in _files_of(self._there().deck.data):
                beside[name] = self.folder.beside(self.place, name)
        return self.folder.save(path, self.document.text, beside, message.get("replace") is True)

    # Changes

    def _there(self) -> Live:
        if self.live is None:
            raise NotThere("no deck is open")
        return self.live

    def _change(self, changes: dict[str, Any]) -> Reply:
        """Values into live deck and text: as they stand in the text, so that both give the same numbers."""
        live = self._there()
        written = {key: self._written(key, value) for key, value in changes.items()}
        before = live.deck
        live.update(written)
        try:
            moved = all(key.split(".")[0] == "motion" for key in written) and self.picture is not None
            reply = Reply({"deck": self._deck_words()}) if moved else self._scene()  # statics know no motion
        except BaseException:
            live.back_to(before)
            raise
        for key, value in written.items():
            self.document.put(self._path(key), value)
        return reply

    def _path(self, key: str) -> list[str]:
        """Where a key of the live deck stands in its text."""
        way = key.split(".")
        if way[0] == "analysis" and len(way) > 1:
            given = self._there().deck.data["analysis"]
            index = self._there().names.index(way[1])
            way[:2] = ["analysis", str(index)] if isinstance(given, list) else ["analysis"]
        return way

    def _before(self, key: str) -> Any:
        """What stands in the deck at a key, None where nothing does."""
        place: Any = self._there().deck.data
        try:
            for part in self._path(key):
                place = place[int(part)] if isinstance(place, list) else place[part]
        except (KeyError, IndexError, TypeError, ValueError):
            return None
        return place

    def _written(self, key: str, value: Any) -> Any:
        if isinstance(value, list):
            return [float(tidy(v)) if isinstance(v, float) else v for v in value]
        if isinstance(value, bool) or not isinstance(value, int | float):
            return value
        si, bare = self._unit(key)
        return as_written(value, self._before(key), si, bare)

    def _unit(self, key: str) -> tuple[str, bool]:
        """The unit of a key and whether a number may stand without it."""
        deck = self._there().deck
        way = key.split(".")
        table = {"structure": deck.structure, "motion": deck.motion}.get(way[0], getattr(deck.building, way[0], None))
        if way[0] == "analysis" and len(way) > 2:
            table, way = deck.analyses[self._there().names.index(way[1])], way[1:]
        return stored.unit_of(type(table), way[1:]) if table is not None else ("", True)

    def _drag(self, message: dict[str, Any]) -> Iterator[Reply]:
        """A handle led to a place (`to`), moved by steps, or given a value as text; `ends` lets go of it."""
        handle = self.handles.get(str(message.get("handle")))
        if handle is None:
            raise BadMessage("there is no such handle")
        if handle.holds and self._held is None:
            self._held = self.anchor
        if "to" in message:
            x, y = (np.array(_numbers(message["to"], 2)) + self.anchor).tolist()
            value = handle.value_at(x, y)
            size = self.picture.assembly.size if self.picture else 1.0
            if handle.unit == "m":
                value = (
                    [hands.rounded(v, size) for v in value] if isinstance(value, list) else hands.rounded(value, size)
                )
            else:
                value = hands.rounded(value, max(abs(value), 1e-6))
        elif "by" in message:
            dx, dy = _numbers(message["by"], 2)
            value = self._stepped(handle, dx, dy)
        else:
            value = self._typed(handle, message.get("text"))
        try:
            yield self._change(handle.changes(value))
        finally:
            if message.get("ends") is True or "to" not in message:
                self._held = None

    def _stepped(self, handle: hands.Handle, dx: float, dy: float) -> Any:
        """A step of the keyboard: a hundredth of the size of the value, or of the building for places."""
        size = self.picture.assembly.size if self.picture else 1.0
        if isinstance(handle.value, list):
            step = 0.002 * size
            return [hands.rounded(handle.value[0] + dx * step, size), hands.rounded(handle.value[1] + dy * step, size)]
        step = handle.step or 0.01 * max(abs(handle.value), 0.02 * size if handle.unit == "m" else 1e-3)
        exponent = np.floor(np.log10(step))
        step = float(np.round(step / 10.0**exponent) * 10.0**exponent)
        return max(round((handle.value + (dx + dy) * step) / step) * step, min(step, handle.least or step))

    def _typed(self, handle: hands.Handle, text: Any) -> Any:
        """A value as a hand types it, with unit or without."""
        if not isinstance(text, str):
            raise BadMessage("expected text")
        if isinstance(handle.value, list):
            parts = [p for p in re.split(r"[;,]\s*|\s+(?=[-+.\d])", text.strip()) if p]
            if len(parts) != 2:
                raise DeckError([f"{handle.label}: expected two numbers, x; y"])
            return [_quantity(part, handle.unit, handle.label) for part in parts]
        return _quantity(text, handle.unit, handle.label)

    def _set(self, message: dict[str, Any]) -> Iterator[Reply]:
        """Keys of the deck given values: numbers, words, or text with units as it would stand in the deck. `rocking`: the
        response comes with the same reply, for a hand that draws a pulse."""
        changes = message.get("changes")
        if not isinstance(changes, dict) or not 0 < len(changes) <= 50:
            raise BadMessage("expected up to 50 changes")
        for key in changes:
            if not re.fullmatch(r"[A-Za-z_][\w-]*(\.[\w-]+){0,8}", key):
                raise BadMessage("that is no key")
        reply = self._change(changes)
        if message.get("rocking") is True and self._there().deck.motion is not None:
            for response in self._rocking({}):
                reply.words |= response.words
                reply.arrays |= response.arrays
        yield reply

    def _analysis(self, message: dict[str, Any]) -> Iterator[Reply]:
        """Add an analysis of a kind to the deck, or take one out."""
        given = self._there().deck.data["analysis"]
        rows = copy.deepcopy(given if isinstance(given, list) else [given])
        if isinstance(message.get("add"), str):
            rows.append({"kind": message["add"]})
        else:
            name = message.get("remove")
            if name not in self._there().names:
                raise BadMessage("there is no such analysis")
            del rows[self._there().names.index(name)]
        text = self.document.text
        document = Document(text)
        document.put(["analysis"], None)
        yield from self._open(
            {"text": document.text.rstrip() + "\n" + _tables("analysis", rows), "here": "same"}
        )  # fmt: skip

    def _show(self, message: dict[str, Any]) -> Iterator[Reply]:
        """Another view of the same building: the tilt, the chain, the place that the line shall pass."""
        view = self.view
        gamma = view.gamma
        if "gamma" in message:
            (gamma,) = _numbers([message["gamma"]], 1)
            gamma = float(np.clip(gamma, -5.0, 5.0))
        chain = message["chain"] if isinstance(message.get("chain"), str) else view.chain
        through, thrust = view.through, view.thrust
        if "thrust" in message:
            thrust = None if message["thrust"] is None else self._thrust(message["thrust"])
            through = None if thrust is not None else through
        if "through" in message:
            thrust = None if message["through"] is not None else thrust
            wanted = message["through"]
            if wanted is None:
                through = None
            elif isinstance(wanted, dict):
                joint = wanted.get("joint")
                (share,) = _numbers([wanted.get("share")], 1)
                count = len(self._there().deck.building.blocks().a)
                if not isinstance(joint, int) or isinstance(joint, bool) or not 0 <= joint < count:
                    raise BadMessage("there is no such joint")
                through = (joint, min(max(share, 0.0), 1.0))
            else:
                place = np.array(_numbers(wanted, 2)) + self.anchor
                assembly = self._there().deck.building.blocks()
                through = statics.nearest(assembly, place, chain or statics.first_chain(assembly))
        lines = view.lines
        if isinstance(message.get("lines"), list):
            lines = frozenset(str(name)[:20] for name in message["lines"][:20])
        self.view = statics.View(gamma, chain, through, thrust, lines)
        yield self._scene()

    def _thrust(self, wanted: Any) -> float:
        """A thrust [N] that a line shall have: a number, or text with a unit."""
        if isinstance(wanted, str):
            return _quantity(wanted, "N", "Thrust of the line")
        return _numbers([wanted], 1)[0]

    def _rest(self, _: dict[str, Any]) -> Iterator[Reply]:
        """What is told when the hand rests: the text of the deck, its forms, then mechanisms and safety."""
        self._held = None
        yield Reply({"text": self.document.text, "forms": self._forms(), "name": self.name})
        if self.picture is not None:
            words, arrays = statics.detail(self.picture, self.anchor)
            yield Reply({"detail": words}, arrays)

    # Pictures

    def _options(self, table: type, otherwise: Callable[[], Any]) -> tuple[Any, Any, str | None]:
        """The deck's own analysis of a sort with its building and name; else one with default values."""
        live = self._there()
        for options, building, name in zip(live.deck.analyses, live.deck.buildings, live.names, strict=True):
            if isinstance(options, table):
                return options, building, name
        return otherwise(), live.deck.building, None

    def _scene(self) -> Reply:
        live = self._there()
        structure = live.deck.structure
        if structure is None:
            return Reply(
                {
                    "scene": {"empty": "The deck has no [structure]: there is nothing to draw."},
                    "deck": self._deck_words(),
                }
            )
        options, building, name = self._options(LimitAnalysisTable, lambda: Tilt(kind="tilt"))
        try:
            assembly = building.blocks()
        except NoView as error:
            return self._body(str(error))
        self.anchor = hands.anchor_of(structure, assembly) if self._held is None else self._held
        if self.view.through is not None and self.view.through[0] >= len(assembly.a):
            self.view = replace(self.view, through=None)
        made = statics.picture(building, options, self.view, self.anchor)
        found = hands.handles_of(structure, assembly)
        if name is not None and options.load:
            surfaces = [(row.x, block_under(assembly, row.x)[1] if row.y is None else row.y) for row in options.load]
            largest = max(abs(row.force) for row in options.load) or 1.0
            scale = 0.15 * assembly.size / largest
            found += hands.load_handles(options.load, name, surfaces, scale)
            made.words["loads"] = [
                {"at": [x - self.anchor[0], y - self.anchor[1]], "force_N": row.force, "horizontal_N": row.horizontal,
                 "end": None if row.x_end is None else row.x_end - self.anchor[0], "scale": scale}
                for row, (x, y) in zip(options.load, surfaces, strict=True)
            ]  # fmt: skip
        made.words["limit_analysis"] = name
        self.picture, self.handles = made, {h.name: h for h in found}
        return Reply(
            {
                "scene": made.words,
                "handles": self._told(found),
                "anchor": self.anchor.tolist(),
                "deck": self._deck_words(),
            },
            made.arrays,
        )

    def _body(self, why: str) -> Reply:
        """A building without stones in a plane: what there is to look at, and why there is no more."""
        live = self._there()
        meshes = [
            (a.mesh, b) for a, b in zip(live.deck.analyses, live.deck.buildings, strict=True) if hasattr(a, "mesh")
        ]
        mesh, building = meshes[0] if meshes else (None, live.deck.building)
        found = bodies.seen(building, mesh)
        words, arrays = found or ({}, {})
        self.picture, self.anchor = None, np.zeros(2)
        made = hands.handles_of(live.deck.structure, None) if words.get("sort") == "elements" else []
        self.handles = {h.name: h for h in made}
        scene = {"empty": why, "seen": words or None, "gamma": 0.0}
        return Reply(
            {"scene": scene, "handles": self._told(made), "anchor": [0.0, 0.0], "deck": self._deck_words()}, arrays
        )

    def _told(self, found: list[hands.Handle]) -> list[dict[str, Any]]:
        """Handles as the page takes them, from the anchor [m]."""
        x, y = self.anchor.tolist()
        return [
            {"name": h.name, "label": h.label, "unit": h.unit, "at": [h.x - x, h.y - y], "value": h.value, "along": h.along}
            for h in found
        ]  # fmt: skip

    def _deck_words(self) -> dict[str, Any]:
        live = self._there()
        deck = live.deck
        motion = deck.motion
        told: dict[str, Any] = {
            "title": deck.title, "note": deck.note, "analyses": live.names,
            "structure": None if deck.structure is None else {"kind": deck.structure.kind, "word": deck.structure.word},
            "motion": None,
        }  # fmt: skip
        if motion is not None:
            told["motion"] = {
                key: value for key, value in motion.model_dump().items() if isinstance(value, str | int | float)
            } | {"pulse": rocking.pulse_of(motion)}
        return told

    def _forms(self) -> list[dict[str, Any]]:
        """The keys of building and motion with values, units, bounds and meaning, for the form beside the drawing."""
        return stored.forms(self._there().deck)

    def _push(self, _: dict[str, Any]) -> Iterator[Reply]:
        """Limit analysis of what no hand moves: blocks in space, along the deck's directions or all around."""
        if self.picture is not None:
            raise BadMessage("a section follows the hand as it is")
        options, building, _ = self._options(Tilt, lambda: Tilt(kind="tilt"))
        result = run_one(self._there().context(), options, building)
        if result.status != "ok":
            raise Refused(result.reason)
        wanted = ("mechanism_pose", "rose_direction", "rose_capacity")
        arrays = {name: result.arrays[name].data for name in wanted if name in result.arrays}
        numbers = {k: v for k, v in result.results.as_json().items() if isinstance(v, int | float | str)}
        yield Reply({"push": {"answer": result.answer, "numbers": numbers, "warnings": result.warnings}}, arrays)

    # Motion

    def _rocking(self, message: dict[str, Any]) -> Iterator[Reply]:
        """The response to the deck's motion, with shapes unless the page only looks for an amplitude."""
        if self._there().deck.motion is None:
            raise Refused("the deck has no [motion]")
        context = self._there().context()
        drawn = rocking.curve(context.motion)
        options, building, _ = self._options(Rocking, lambda: Rocking(kind="rocking"))
        context.building = building
        try:
            words, arrays = rocking.history(context, building, options, self.anchor, message.get("still") is True)
        except (Refused, BadGeometry, NoAnswer, NoEquilibrium, CoreError) as error:
            words, arrays = {"refused": str(error)}, {}  # the motion is shown all the same
        yield Reply({"rocking": words, "deck": self._deck_words()}, {**arrays, **drawn})

    def _impulse(self, _: dict[str, Any]) -> Iterator[Reply]:
        if self._there().deck.motion is None:
            raise Refused("the deck has no [motion]")
        context = self._there().context()
        yield Reply({"impulse": rocking.impulse(context, self._there().deck.building)})

    def _domain(self, message: dict[str, Any]) -> Iterator[Reply]:
        """The map of pulses, coarse first and finer with each reply; kept as long as the building is the same."""
        live = self._there()
        options, building, name = self._options(FailureDomain, lambda: None)
        motion = live.deck.motion
        uplift = building.rocker(soft_base=True).uplift
        kind = None if motion is None else motion.kind
        asked = rocking.domain_options(kind, options if name else None, uplift)
        if message.get("pulse") in ("step", "sine"):
            asked = asked.model_copy(update={"pulse": message["pulse"]})
        rocker = building.rocker(asked.form == "linear", soft_base=True)
        mark = f"{asked.model_dump_json()} {rocker.body.kind} {rocker.body.parameters.tobytes().hex()} {rocker.start_rotation}"
        known = self._maps.get(mark, [])
        if known and known[-1][0]["whole"]:
            words, arrays = known[-1]
            yield Reply({"domain": words}, arrays)
            return
        self._maps = {k: v for k, v in list(self._maps.items())[-7:]}
        for step in rocking.domain(self._there().context(), building, asked):
            self._maps[mark] = [step]
            yield Reply({"domain": step[0]}, step[1])

    # Results

    def _run(self, message: dict[str, Any]) -> Iterator[Reply]:
        """A stored run of the folder: its words; then, of one analysis, all that its view draws."""
        path = message.get("path")
        if not isinstance(path, str):
            raise BadMessage("expected a path")
        run = self.folder.run(path)
        name = message.get("analysis") if isinstance(message.get("analysis"), str) else None
        words, arrays = stored.shown(run, name)
        yield Reply({"run": {**words, "path": path, "side": message.get("side")}}, arrays, frozenset(("time",)))

    def _compute(self, message: dict[str, Any]) -> Iterator[Reply]:
        """Save the deck and run all its analyses by the command line, in a process of its own; progress as it comes."""
        saved = self._saved(message)
        for line, done in self.folder.compute(saved):
            yield Reply({"computing": line, "done": done, "runs": self.folder.runs() if done else None, "saved": saved})


def _numbers(given: Any, count: int) -> list[float]:
    """So many finite numbers of a message."""
    if not isinstance(given, list) or len(given) != count:
        raise BadMessage(f"expected {count} numbers")
    for value in given:
        if isinstance(value, bool) or not isinstance(value, int | float) or not abs(value) < 1e9:
            raise BadMessage("expected numbers")
    return [float(value) for value in given]


def _quantity(text: str, unit: str, label: str) -> float:
    """A number typed with a unit or without, in `unit`; DeckError says what is wrong with it."""
    text = text.strip().replace("−", "-").replace("°", " deg")
    try:
        return float(text)
    except ValueError:
        pass
    found = re.fullmatch(r"([-+]?[0-9.]+(?:[eE][-+]?\d+)?)\s*([A-Za-z%/^0-9*]+)", text[:60])
    if not found:
        raise DeckError(
            [f"{label}: '{text[:40]}' is no quantity; expected a number such as 1.5, or with its unit, 150 cm"]
        )
    try:
        return float(found[1]) * quantities.factor(found[2], unit)
    except ValueError as error:
        raise DeckError([f"{label}: {error}"]) from None


def _files_of(data: Any) -> list[str]:
    """The files that a deck names beside itself."""
    found: list[str] = []
    if isinstance(data, dict):
        for key, value in data.items():
            if (
                key in ("file", "outline", "vertical", "other")
                and isinstance(value, str)
                and not value.startswith("extrados:")
            ):
                found.append(value)
            elif key == "files" and isinstance(value, list):
                found += [v for v in value if isinstance(v, str)]
            else:
                found += _files_of(value)
    elif isinstance(data, list):
        for value in data:
            found += _files_of(value)
    return list(dict.fromkeys(found))


def _thinned(outline: np.ndarray) -> list[list[float]]:
    """Vertices to a hundredth of a millimetre."""
    return [[round(float(x), 5), round(float(y), 5)] for x, y in outline]


def _tables(name: str, rows: list[dict[str, Any]]) -> str:
    """Array of tables as TOML."""
    import tomlkit

    document = tomlkit.document()
    array = tomlkit.aot()
    for row in rows:
        table = tomlkit.table()
        for key, value in row.items():
            table[key] = value
        array.append(table)
    document[name] = array
    text = "\n" + tomlkit.dumps(document)
    tomllib.loads(text)
    return text


_DOES: dict[str, Callable[[Session, dict[str, Any]], Iterator[Reply]]] = {
    "hello": Session._hello, "list": Session._list, "open": Session._open, "drop": Session._drop, "blocks": Session._blocks,
    "save": Session._save, "drag": Session._drag, "set": Session._set, "analysis": Session._analysis, "show": Session._show,
    "rest": Session._rest, "push": Session._push, "rocking": Session._rocking, "impulse": Session._impulse, "domain": Session._domain,
    "run": Session._run, "compute": Session._compute,
}  # fmt: skip

__all__ = ["CASES", "BadMessage", "Session"]
