"""Decks in and out: what there is to open, decks opened, files dropped, analyses added, the deck saved."""

import base64
import binascii
import copy
import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import tomlkit

from extrados import kinds
from extrados._build_info import VERSION
from extrados.analyses.context import Refused
from extrados.decks.explain import starter
from extrados.decks.reader import LARGEST, read_text
from extrados.explore import forms, statics
from extrados.explore.answers.views import scene
from extrados.explore.desk import NEW_DECK, Desk
from extrados.explore.document import Document
from extrados.explore.folder import NotThere
from extrados.explore.frames import Reply
from extrados.explore.handles import MOST_VERTICES
from extrados.explore.messages import BadMessage, Message, path
from extrados.model.geometry.polygons import signed_area
from extrados.running.live import Live

#: Bytes of a drawing or a record that is dropped on the page
LARGEST_DROP = 8_000_000
DROPS = {".dxf", ".json", ".csv", ".txt", ".at2", ".toml"}
UNITS = ("m", "cm", "mm", "in", "ft")
NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9 ._-]{0,120}")


def hello(desk: Desk, message: Message) -> Iterator[Reply]:
    """What there is to choose from; then the first deck, or the one that the page still has."""
    folder = desk.folder
    yield Reply(
        {
            "version": VERSION,
            "presets": folder.presets(),
            "decks": folder.decks(),
            "runs": folder.runs(),
            "folder": str(folder.root),
            "kinds": {section: list(there) for section, there in kinds.TABLES.items()},
        }
    )
    kept = message.get("kept")
    if isinstance(kept, dict) and isinstance(kept.get("text"), str):
        drops = kept.get("drops", [])
        if not isinstance(drops, list) or not all(isinstance(drop, dict) for drop in drops):
            raise BadMessage("expected a list of the dropped files")
        for drop in drops[:20]:
            _keep(desk, drop)
        yield from open_deck(desk, {**kept, "do": "open"})
    elif desk.first is not None:
        yield from open_deck(desk, {"path": desk.first})
    else:
        yield from open_deck(desk, {"text": desk.first_text, "name": "new-arch.toml" if desk.first_text == NEW_DECK else "deck.toml"})


def list_folder(desk: Desk, _: Message) -> Iterator[Reply]:
    """Decks and runs of the folder as they are now."""
    yield Reply({"decks": desk.folder.decks(), "runs": desk.folder.runs()})


def open_deck(desk: Desk, message: Message) -> Iterator[Reply]:
    """A preset, a deck of the folder, a starter deck, or a text beside the files of one of these."""
    source = {key: message[key] for key in ("preset", "path", "dropped") if isinstance(message.get(key), str)}
    if "preset" in source:
        raw, place, name = desk.folder.preset(source["preset"])
    elif "path" in source:
        raw, place, name = desk.folder.deck(source["path"])
    else:
        own = message.get("name")
        raw, name = b"", own if isinstance(own, str) else desk.name
        place = desk.drops() if "dropped" in source or message.get("here") == "dropped" else desk.folder.root
    if isinstance(message.get("starter"), str):
        try:
            raw = starter(message["starter"]).encode()
        except KeyError as error:
            raise NotThere(str(error.args[0])) from None
        name = f"{message['starter']}.toml"
    same = message.get("here") == "same"
    if isinstance(message.get("text"), str):
        raw = message["text"].encode("utf-8", "replace")
        if same:
            place, name = desk.place, desk.name
    if len(raw) > LARGEST:
        raise NotThere(f"{name} is too large for a deck")
    live = Live(read_text(raw, Path(name).name, place))
    before = desk.live, desk.place, desk.name, desk.document, desk.view
    desk.live, desk.place, desk.name = live, place, Path(name).name
    desk.document = Document(raw.decode("utf-8-sig"))
    if not same:
        desk.view = statics.View(lines=desk.view.lines)
    desk.held = None
    try:
        reply = scene(desk)
    except BaseException:
        desk.live, desk.place, desk.name, desk.document, desk.view = before
        raise
    origin = source or ({"here": "dropped"} if place == desk.scratch else {})
    reply.words |= {"opened": not same, "source": origin, "text": desk.document.text, "name": desk.name}
    reply.words |= {"forms": forms.forms_of(live.deck)}
    yield reply


def drop(desk: Desk, message: Message) -> Iterator[Reply]:
    """A file dropped on the page: a deck, a drawing that becomes a deck of blocks, or a record for the deck at hand."""
    target = _keep(desk, message)
    sort = target.suffix.lower()
    if sort == ".toml":
        text = target.read_text("utf-8", "replace")
        yield from open_deck(desk, {"text": text, "name": target.name, "dropped": "1"})
    elif sort in (".dxf", ".json"):
        unit = f'unit = "{message["unit"]}"\n' if message.get("unit") in UNITS else ""
        text = f'title = "{target.stem}"\n\n[structure]\nkind = "blocks"\nfile = "{target.name}"\n{unit}\n[[analysis]]\nkind = "tilt"\n'
        yield from open_deck(desk, {"text": text, "name": f"{target.stem}.toml", "dropped": target.name})
    else:
        yield from _under(desk, target)


def _keep(desk: Desk, message: Message) -> Path:
    """Where a dropped file now lies."""
    name, data = message.get("name"), message.get("data")
    if not isinstance(name, str) or not isinstance(data, str) or not NAME.fullmatch(name) or ".." in name:
        raise NotThere("the name of a file may contain only letters, digits, blanks, dots, - and _")
    if Path(name).suffix.lower() not in DROPS:
        raise NotThere(f"{name}: the page does not open files of this ending; expected {', '.join(sorted(DROPS))}")
    if len(data) > LARGEST_DROP * 4 // 3 + 4:
        raise NotThere(f"{name} is larger than the allowed {LARGEST_DROP / 1e6:g} MB")
    try:
        content = base64.b64decode(data, validate=True)
    except (binascii.Error, ValueError):
        raise BadMessage("the content of the file was not sent as base64") from None
    target = desk.drops() / name
    target.write_bytes(content)
    return target


def _under(desk: Desk, record: Path) -> Iterator[Reply]:
    """The deck at hand under a record that was dropped: both then lie where dropped files do."""
    live, drops = desk.there(), desk.drops()
    if desk.place != drops:
        for name in files_of(live.deck.data):
            try:
                (drops / Path(name).name).write_bytes(desk.folder.beside(desk.place, name))
            except NotThere:
                continue
    document = Document(desk.document.text)
    document.put(["motion"], None)
    document.put(["motion"], {"kind": "record", "file": record.name})
    yield from open_deck(desk, {"text": document.text, "name": desk.name, "dropped": record.name})


def blocks(desk: Desk, _: Message) -> Iterator[Reply]:
    """Turn the blocks of any building into free blocks with vertices that can be dragged. Mass, depth and friction are kept.
    Loads, restraints and special joints are not carried over; the note of the new deck lists them."""
    deck = desk.there().deck
    assembly = deck.building.blocks()
    count = sum(map(len, assembly.outlines))
    if count > MOST_VERTICES * 3:
        raise Refused(f"{len(assembly.mass)} stones with {count} vertices together are too many to be moved by hand")
    areas = [abs(signed_area(outline)) for outline in assembly.outlines]
    density = assembly.mass / (np.array(areas) * assembly.depth)
    # an outline is a little smaller than the arcs that it stands for
    other = np.abs(density - deck.building.material.density) > 1e-3 * deck.building.material.density
    rows = [
        f"[[structure.block]]\nname = {json.dumps(name)}\npoints = {_thinned(outline)}\n" + f"density = {rho!r}\n" * differs
        for name, outline, rho, differs in zip(assembly.block_names, assembly.outlines, density.tolist(), other.tolist(), strict=True)
    ]
    grounded = [j for j in range(len(assembly.a)) if -1 in (assembly.a[j], assembly.b[j])]
    ground = [[round(float(v), 6) for v in (*assembly.p[j], *assembly.q[j])] for j in grounded]
    left = [name for name in ("ties", "dampers", "hinges", "supports", "initial", "motion") if deck.data.get(name)]
    left += ["joints.types"] * bool(deck.data.get("joints", {}).get("types"))
    note = f"note = {json.dumps('These parts of the deck were not carried over to the free stones: ' + ', '.join(left))}\n" if left else ""
    title = deck.title or deck.building.require_structure().word
    text = (
        f'title = {json.dumps(f"{title}, with free stones")}\n{note}\n[structure]\nkind = "blocks"\n'
        + f"depth = {assembly.depth!r}\n" * (assembly.depth != 1.0)
        + f'ground = {ground}\ncontact_tolerance = "1 mm"\n\n{chr(10).join(rows)}\n[[analysis]]\nkind = "tilt"\n'
    )
    document = Document(text)
    for section in ("material", "joints"):
        if kept := {key: value for key, value in deck.data.get(section, {}).items() if key != "types"}:
            document.put([section], kept)
    yield from open_deck(desk, {"text": document.text, "name": "free-blocks.toml"})


def analysis(desk: Desk, message: Message) -> Iterator[Reply]:
    """Add an analysis of a kind to the deck, or take one out."""
    live = desk.there()
    given = live.deck.data["analysis"]
    rows = copy.deepcopy(given if isinstance(given, list) else [given])
    if isinstance(message.get("add"), str):
        rows.append({"kind": message["add"]})
    else:
        name = message.get("remove")
        if name not in live.names:
            raise BadMessage("the deck has no analysis of this name")
        del rows[live.names.index(name)]
    document = Document(desk.document.text)
    document.put(["analysis"], None)
    yield from open_deck(desk, {"text": f"{document.text.rstrip()}\n\n{_analyses(rows)}", "here": "same"})


def save(desk: Desk, message: Message) -> Iterator[Reply]:
    """The deck into the working folder, with the dropped files it names."""
    yield Reply({"saved": saved(desk, message), "decks": desk.folder.decks()})


def saved(desk: Desk, message: Message) -> str:
    """Where the deck was saved in the working folder, at the path of a message, with the dropped files it names."""
    place, beside = path(message), {}
    if desk.place != desk.folder.root:
        for name in files_of(desk.there().deck.data):
            beside[name] = desk.folder.beside(desk.place, name)
    return desk.folder.save(place, desk.document.text, beside, message.get("replace") is True)


def files_of(data: Any) -> list[str]:
    """The files that a deck names beside itself."""
    found: list[str] = []
    if isinstance(data, dict):
        for key, value in data.items():
            if key in ("file", "outline", "vertical", "other") and isinstance(value, str):
                found += [] if value.startswith("extrados:") else [value]
            elif key == "files" and isinstance(value, list):
                found += [v for v in value if isinstance(v, str)]
            else:
                found += files_of(value)
    elif isinstance(data, list):
        for value in data:
            found += files_of(value)
    return list(dict.fromkeys(found))


def _thinned(outline: Any) -> list[list[float]]:
    """Vertices to a hundredth of a millimetre."""
    return [[round(float(x), 5), round(float(y), 5)] for x, y in outline]


def _analyses(rows: list[dict[str, Any]]) -> str:
    """Analyses as TOML."""
    document, array = tomlkit.document(), tomlkit.aot()
    for row in rows:
        table = tomlkit.table()
        table.update(row)
        array.append(table)
    document["analysis"] = array
    return tomlkit.dumps(document)
