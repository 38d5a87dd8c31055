"""Read a deck: all complaints at once, each with file, line, key, what is wrong and what is expected."""

import difflib
import hashlib
import os
import re
import stat
import tomllib
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any, get_args

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from extrados import kinds
from extrados.analyses.table import OVERRIDES, Analysis
from extrados.decks.moved import MOVED
from extrados.decks.plural import MOST, PLURAL
from extrados.decks.positions import Path as Key
from extrados.decks.positions import Positions, key_lines
from extrados.decks.toml import loads
from extrados.decks.words import LANGUAGES, WORDS
from extrados.model.errors import WHOLE, NoView
from extrados.model.properties import Initial, Joints, Material, Supports
from extrados.model.structure import Structure
from extrados.schema import files
from extrados.schema.code import Code
from extrados.schema.table import Motion, Table
from extrados.schema.text import printable
from extrados.views.building import Building

LARGEST = 1_000_000  # bytes
MOST_COMPLAINTS = 50
#: Keys of a table that a message names as an example.
MOST_SHOWN = 4
#: Names of pipes that this process was given, which are open already: none is waited for
PIPE = re.compile(r"-|/dev/stdin|/dev/fd/\d+")
#: Tables that say what the building is besides its geometry
PROPERTIES: dict[str, type[Table]] = {"material": Material, "joints": Joints, "supports": Supports, "initial": Initial}
#: What one kind of structure calls by one word and another kind by another
ALIKE = {"thickness": {"depth"}, "depth": {"thickness"}, "length": {"width", "span"}, "span": {"width", "radius"}}
TOP_LEVEL = {*WORDS, "structure", *PROPERTIES, "materials", *PLURAL, "motion", "code", "analysis"}


class DeckError(Exception):
    """The deck is wrong; `complaints` holds lines "deck.toml:LINE: key: what is wrong, what is expected"."""

    def __init__(self, complaints: list[str]):
        self.complaints = [printable(complaint) for complaint in complaints]
        super().__init__("\n".join(self.complaints))


@dataclass(frozen=True)
class Deck:
    """A checked deck. `data` is what stood in it; folder is where its files are looked for.

    building: what [structure], [material], [joints], [supports] and [initial] say; buildings: as each analysis sees it,
    with what it overrides. code: that of the report, None where the deck names none. positions: where its keys stand; tables:
    the place of each analysis among them.
    """

    title: str
    note: str
    building: Building
    motion: Motion | None
    analyses: list[Analysis]
    buildings: list[Building]
    path: str = ""
    folder: Path = field(default_factory=Path.cwd)
    sha256: str = ""
    data: dict[str, Any] = field(default_factory=dict)
    project: str = ""
    author: str = ""
    date: str = ""
    code: Code | None = None
    positions: Positions = field(default_factory=Positions)
    tables: list[Key] = field(default_factory=list)

    def __repr__(self) -> str:
        structure = self.structure.kind if self.structure else "no structure"
        return f"<Deck {self.path}: {structure}; {', '.join(a.kind for a in self.analyses)}>"

    @property
    def structure(self) -> Structure | None:
        """The geometry; None in a deck without [structure]."""
        return self.building.structure

    def require_motion(self) -> Motion:
        """The table of [motion]; NoView in a deck without it."""
        if self.motion is None:
            raise NoView("the deck has no [motion]", WHOLE)
        return self.motion

    @property
    def identity(self) -> str:
        """The hash by which results are told from those of another deck."""
        return self.sha256 or hashlib.sha256(repr(self.data).encode()).hexdigest()

    @property
    def default_out(self) -> Path:
        """results/<deck name> below the current folder."""
        return Path("results") / (Path(self.path).stem or "deck")

    def complaint(self, analysis: Analysis | None, at: Key, what: str) -> str:
        """Words about a key as a complaint with file and line; about a key of an analysis' table where `at` begins with
        "analysis"; as they are where `at` is empty."""
        if not at:
            return what
        own = next((table for a, table in zip(self.analyses, self.tables, strict=False) if a is analysis), ("analysis",))
        override = getattr(analysis, str(at[0]), None) if at[0] in OVERRIDES else None
        if at[0] == "analysis":
            at = (*own, *at[1:])
        elif override is not None and at[1:2] and at[1] in override.model_fields_set:
            at = (*own, *at)
        return self.positions.tell(at, what)

    def resolved(self) -> dict[str, Any]:
        """All keys with their defaults, in SI."""
        own = {name: getattr(self.building, name).model_dump() for name in PROPERTIES}
        return {
            "title": self.title,
            "structure": self.structure.model_dump() if self.structure else None,
            **own,
            "materials": {name: m.model_dump() for name, m in self.building.materials.items()},
            **{name: [one.model_dump(exclude_none=True) for one in getattr(self.building, name)] for name in PLURAL},
            "motion": self.motion.model_dump() if self.motion else None,
            **({"code": self.code.model_dump(exclude_none=True)} if self.code else {}),
            "analysis": [a.model_dump(exclude_none=True) for a in self.analyses],
        }


def read_deck(path: str | Path) -> Deck:
    """The deck in a file, or in a pipe ("-", and what a shell makes of <(command)), whose files are looked for in the current
    folder; DeckError lists every complaint."""
    path = Path(path)
    name = str(path)
    if PIPE.fullmatch(name) and (raw := _piped(name)) is not None:
        return read_text(raw, "stdin")
    try:
        raw = files.read(path, LARGEST).content
    except files.BadFile as error:
        raise DeckError([str(error)]) from None
    return read_text(raw, name, path.resolve().parent)


def _piped(name: str) -> bytes | None:
    """What a pipe that this process was given holds; None where it is a file."""
    try:
        with open(0 if name == "-" else name, "rb", closefd=name != "-") as stream:
            if stat.S_ISREG(os.fstat(stream.fileno()).st_mode) and name != "-":
                return None
            raw = stream.read(LARGEST + 1)
    except OSError as error:
        raise DeckError([f"{name}: this file cannot be read: {error.strerror or error}"]) from None
    if len(raw) > LARGEST:
        raise DeckError([f"{name}: this file has more than {LARGEST / 1e6:g} MB, the greatest size that is read"])
    return raw


def read_text(raw: bytes, name: str = "deck.toml", folder: Path | None = None) -> Deck:
    """The deck in a text; `folder` is where its files are looked for."""
    try:
        text = raw.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = raw[: error.start].count(b"\n") + 1
        raise DeckError([f"{name}:{line}: this file is not UTF-8 text (byte {error.start}); expected a TOML deck"]) from None
    try:
        data = loads(text)
    except tomllib.TOMLDecodeError as error:
        line, what = _syntax(str(error), text)
        raise DeckError([f"{name}:{line}: {what}"]) from None
    except ValueError as error:  # too deep, or integers of more digits than Python converts
        raise DeckError([f"{name}: {error}"]) from None
    return _Checker(Positions(name, key_lines(text), data)).deck(data, folder or Path.cwd(), hashlib.sha256(raw).hexdigest())


def make_deck(data: dict[str, Any], folder: Path | None = None) -> Deck:
    """A deck from Python dictionaries, checked like a file."""
    return _Checker(Positions(data=data)).deck(data, folder or Path.cwd(), "")


def check_table(model: type[Table], section: str, data: dict[str, Any], name: str) -> Any:
    """A table of a section from Python's values, checked like that of a file; `name` is what complaints call it."""
    checker = _Checker(Positions(name))
    made = checker.table(model, data, (section,))
    if checker.complaints:
        raise DeckError([text for _, text in checker.complaints])
    return made


def _syntax(message: str, text: str) -> tuple[int, str]:
    what, _, where = message.partition(" (at ")
    if where.startswith("line "):
        line = int(where.split()[1].strip(",)"))
    else:
        line = text.count("\n") + 1
    rows = text.split("\n")
    while line > 1 and (line > len(rows) or not rows[line - 1].strip()):
        line -= 1  # an end of file is shown at the last line that holds something
    shown = rows[line - 1].strip()[:60]
    hint = ""
    if "," in shown and "=" in shown and "[" not in shown:
        hint = "; the decimal sign is a point"
    return line, f"{what[0].lower()}{what[1:]} in '{shown}': expected TOML such as  key = value{hint}"


class _Checker:
    def __init__(self, positions: Positions):
        self.positions = positions
        self.complaints: list[tuple[int, str]] = []

    def complain(self, path: Key, what: str) -> None:
        self.complaints.append((self.positions.line(path), self.positions.tell(path, what)))

    def deck(self, data: dict[str, Any], folder: Path, sha256: str) -> Deck:
        for word in data:
            if word not in TOP_LEVEL:
                self.complain((word,), f"unknown key or section{_nearest(word, sorted(TOP_LEVEL))}")
        for word in WORDS:
            if not isinstance(data.get(word, ""), str):
                self.complain((word,), "expected text in quotes")
        if data.get("language", "en") not in LANGUAGES:
            self.complain(("language",), f"{_shown(data['language'])}: expected one of {_words(LANGUAGES)}")
        structure = self.section("structure", data.get("structure"), ("structure",))
        motion = self.section("motion", data.get("motion"), ("motion",))
        code = self.table(Code, data["code"], ("code",)) if "code" in data else None
        given = data.get("analysis")
        if given is None or (isinstance(given, list) and not given):
            self.complain((), f"the deck has no [analysis]; expected one of {_words(kinds.ANALYSES)}")
            given = []
        tables = given if isinstance(given, list) else [given]
        several = isinstance(given, list)
        building = self.building(structure, data, folder)
        analyses, buildings = [], []
        tables_of: list[Key] = []
        for i, table in enumerate(tables):
            path = ("analysis", i) if several else ("analysis",)
            analysis = self.section("analysis", table, path)
            if analysis is not None:
                self.fits(analysis, data, path)
                analyses.append(analysis)
                tables_of.append(path)
                buildings.append(self.overridden(building, data, table, path))
        if self.complaints:
            found = [text for _, text in sorted(self.complaints, key=lambda c: c[0])]
            if len(found) > MOST_COMPLAINTS:
                more = len(found) - MOST_COMPLAINTS
                found = [*found[:MOST_COMPLAINTS], f"{self.positions.name}: and {more} more"]
            raise DeckError(found)
        return Deck(
            data.get("title", ""),
            data.get("note", ""),
            building,
            motion,
            analyses,
            buildings,
            self.positions.name,
            folder,
            sha256,
            data,
            project=data.get("project", ""),
            author=data.get("author", ""),
            date=data.get("date", ""),
            code=code,
            positions=self.positions,
            tables=tables_of,
        )

    def building(self, structure: Structure | None, data: dict[str, Any], folder: Path) -> Building:
        """The building of the deck; where one of its tables is wrong it is complained of and left out."""
        own = {name: self.table(model, data.get(name, {}), (name,)) for name, model in PROPERTIES.items()}
        materials = data.get("materials", {})
        if not isinstance(materials, dict):
            self.complain(("materials",), "expected tables [materials.NAME]")
            materials = {}
        named = {name: self.table(Material, table, ("materials", name)) for name, table in materials.items()}
        for part in (part for name in ("regions", "bars", "layer") for part in getattr(structure, name, ())):
            if part.material is not None and part.material not in named:
                known = ", ".join(sorted(named)) or "none"
                self.complain(("structure",), f"material '{part.material}' does not exist; [materials] contains {known}")
        many: dict[str, Any] = {name: self.named(name, data.get(name, [])) for name in PLURAL}
        return Building(
            structure,
            materials={n: m for n, m in named.items() if m},
            folder=folder,
            **many,
            **{name: table for name, table in own.items() if table},
        )

    def named(self, section: str, tables: Any) -> tuple[Any, ...]:
        """The ties, dampers or hinges of the deck, each with a name; what is wrong in them is complained of."""
        if not isinstance(tables, list) or len(tables) > MOST:
            self.complain((section,), f"expected tables [[{section}]], at most {MOST}")
            return ()
        made, names = [], set()
        for k, table in enumerate(tables):
            one = self.table(PLURAL[section], table, (section, k))
            if one is None:
                continue
            name = one.name or f"{section[:-1]} {k + 1}"
            if name in names:
                self.complain((section, k, "name"), f"two {section} are called '{name}'")
            names.add(name)
            made.append(one.model_copy(update={"name": name}))
        return tuple(made)

    def overridden(self, building: Building, data: dict[str, Any], table: dict[str, Any], path: tuple) -> Building:
        """The building as one analysis sees it."""
        changes = {}
        for name in OVERRIDES:
            below, above = data.get(name, {}), table.get(name)
            if isinstance(above, dict) and isinstance(below, dict):
                made = self.table(PROPERTIES[name], {**below, **above}, (*path, name))
                if made is not None:
                    changes[name] = made
        return building.having(**changes) if changes else building

    def section(self, section: str, table: Any, path: tuple) -> Any:
        if table is None:
            return None
        if not isinstance(table, dict):
            self.complain(path, f"expected a table [{section}]")
            return None
        known = kinds.TABLES[section]
        kind = table.get("kind")
        if not isinstance(kind, str) or kind not in known:
            if kind is None:
                self.complain(path, f"kind is missing: expected one of {_words(known)}")
            else:
                self.complain((*path, "kind"), f"unknown kind {_shown(kind)}{_nearest(str(kind), known)}")
            return None
        return self.table(kinds.table(section, kind), table, path)

    def table(self, model: type[Table], table: Any, path: tuple) -> Any:
        """A checked table; None where it is wrong, which is complained of."""
        if not isinstance(table, dict):
            self.complain(path, f"expected a table [{'.'.join(str(p) for p in path if not isinstance(p, int))}]")
            return None
        try:
            return model.model_validate(table)
        except ValidationError as error:
            groups: dict[tuple, list[ErrorDetails]] = {}
            for problem in error.errors():
                groups.setdefault(_place(problem), []).append(problem)
            for problems in groups.values():
                self.problem(model, path, problems)
            return None

    def problem(self, model: type[Table], path: tuple, problems: list[ErrorDetails]) -> None:
        """One complaint; a key that may be of several types fails each of them, which makes several problems."""
        problem = problems[0]
        place = _place(problem)
        at = (*path, *place)
        sort = problem["type"]
        if sort == "extra_forbidden" and (path[0], place[-1]) in MOVED and len(place) == 1:
            self.complain(at, f"has moved to {MOVED[path[0], place[-1]]}")
        elif sort == "extra_forbidden":
            self.complain(at, f"unknown key{_home(model, str(path[0]), place)}")
        elif sort == "missing":
            known = _table_at(model, place[:-1]).model_fields
            about = known[place[-1]].description if place and place[-1] in known else ""
            self.complain(at[:-1], f"{place[-1]} is missing ({about})" if about else f"{place[-1]} is missing")
        elif sort == "value_error":
            text = str(problem.get("ctx", {}).get("error", problem["msg"]))
            if inner := _leads(text, problem["input"]):
                at, text = (*at, *inner), text.partition(": ")[2]
            else:  # a rule over several keys: shown at the first one that it names
                given = problem["input"]
                found = ((re.search(rf"\b{re.escape(key)}\b", text), key) for key in (given if isinstance(given, dict) else {}))
                named = min(((match.start(), key) for match, key in found if match), default=None)
                at = (*at, named[1]) if named else at
            self.complain(at, text)
        elif sort in ("too_short", "too_long") and len(problems) == 1:
            limits = problem["ctx"]
            wanted = f"at least {limits['min_length']}" if sort == "too_short" else f"at most {limits['max_length']}"
            self.complain(at, f"{_shown(problem.get('input'))}: expected {wanted}, found {limits['actual_length']}")
        else:
            told = ", or ".join(dict.fromkeys(_expected(model, p) for p in problems))
            unit = _unit(model, place) if told[-1].isdigit() else ""  # of a bound
            self.complain(at, f"{_shown(problem.get('input'))}: {told}{f' {unit}' if unit else ''}")

    def fits(self, analysis: Analysis, data: dict[str, Any], path: tuple) -> None:
        """Complain where the deck lacks what an analysis looks at."""
        kind, structure = analysis.kind, data.get("structure")
        wanted = analysis.structures
        if structure is None and (analysis.view or wanted):
            self.complain(path, f"{kind} requires a [structure]{'' if wanted is None else ' of kind ' + _words(wanted)}")
        elif isinstance(structure, dict) and isinstance(structure.get("kind"), str):
            shape = structure["kind"]
            known = shape in kinds.STRUCTURES
            lacks = kinds.STRUCTURES[shape].lacks if known else {}
            if known and wanted is not None and shape not in wanted:
                self.complain(path, f"{kind} cannot analyse a structure of kind '{shape}'; expected {_words(wanted)}")
            elif analysis.view in lacks and not (analysis.solid and "solids" not in lacks) and shape not in analysis.shells:
                self.complain(path, f"{kind} cannot analyse a structure of kind '{shape}': {lacks[analysis.view]}")
        if analysis.needs_motion and data.get("motion") is None:
            self.complain(path, f"{kind} requires a [motion]; expected one of {_words(kinds.MOTIONS)}")


def _leads(text: str, given: Any) -> Key:
    """The key of a table that words begin with, as "hazard.intensities: expected ..." and "walls[0].openings[1]: ..." do,
    numbers from 0; empty where it has none."""
    found: list[str | int] = []
    for part in text.partition(": ")[0].split("."):
        named = re.fullmatch(r"(\w+)((?:\[\d+\])*)", part)
        if named is None:
            return ()
        for step in (named[1], *map(int, re.findall(r"\d+", named[2]))):
            there = len(given) if isinstance(given, list) else 0
            if not (step in given if isinstance(given, dict) else isinstance(step, int) and step < there):
                return ()
            given = given[step]
            found.append(step)
    return tuple(found)


def _place(problem: ErrorDetails) -> tuple:
    """The keys that lead to a problem: the first part is one, whatever it is called; so is one unknown or missing."""
    first, rest = problem["loc"][:1], problem["loc"][1:]
    last = rest[-1:] if problem["type"] in ("extra_forbidden", "missing") else ()
    rest = rest[: len(rest) - len(last)]
    return (*first, *(p for p in rest if isinstance(p, int) or not _is_branch(p)), *last)


def _home(model: type[Table], section: str, place: tuple) -> str:
    """Where an unknown key belongs: in another section, in a table of this one, or as another word."""
    key, known = str(place[-1]), _table_at(model, place[:-1]).model_fields
    if home := next((name for name, there in PROPERTIES.items() if key in there.model_fields and name != section), ""):
        return f"; it belongs in [{home}]"
    within = (name for name, field in known.items() if (t := _table_in(field.annotation)) and key in t.model_fields)
    if home := next(within, ""):
        return f"; this key belongs in {'.'.join((section, *(str(p) for p in place[:-1] if not isinstance(p, int)), home))}"
    if section in PROPERTIES and key in _of_analyses():
        return "; this key belongs in the [[analysis]] table"
    if alike := ALIKE.get(key, set()) & known.keys():
        return f"; did you mean '{min(alike)}'?"
    return _nearest(key, known)


@cache
def _of_analyses() -> frozenset[str]:
    """The keys of all analyses."""
    return frozenset(key for kind in kinds.ANALYSES for key in kinds.table("analysis", kind).model_fields)


def _table_at(model: type[Table], place: tuple) -> type[Table]:
    """The table within a table that a place leads to."""
    for part in place:
        if part in model.model_fields:
            model = _table_in(model.model_fields[part].annotation) or model
    return model


def _table_in(annotation: Any) -> type[Table] | None:
    if isinstance(annotation, type) and issubclass(annotation, Table):
        return annotation
    return next((found for inner in get_args(annotation) if (found := _table_in(inner))), None)


def _is_branch(part: str) -> bool:
    """True for pydantic's names of union branches, which are no keys of the deck."""
    return "[" in part or "-" in part or part in {"float", "int", "str", "bool", "none"}


def _unit(model: type[Table], place: tuple) -> str:
    schema = model.model_json_schema()["properties"].get(str(place[0]), {}) if place else {}
    branches = [schema, *schema.get("anyOf", [])]
    branches += [b["items"] for b in branches if "items" in b]
    return next((b["unit"] for b in branches if "unit" in b), "")


def _expected(model: type[Table], problem: ErrorDetails) -> str:
    """What would have been right, in words of a deck; model: the table that holds the problem."""
    if problem["type"] in ("model_type", "model_attributes_type"):
        fields = _table_at(model, _place(problem)).model_fields
        keys = sorted(fields, key=lambda name: not fields[name].is_required())[:MOST_SHOWN]
        return f"expected a table such as {{ {', '.join(f'{name} = ...' for name in keys)} }}"
    if problem["type"] == "string_type":
        return "expected text in quotes"
    if problem["type"] == "list_type" and isinstance(problem.get("input"), dict):
        return "expected a list of tables, [{ ... }], also for a single table"
    if problem["type"] == "list_type":
        return "expected a list, [ ... ]"
    return problem["msg"][0].lower() + problem["msg"][1:]


def _shown(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= 60 else text[:57] + "..."


def _words(words: Any) -> str:
    return ", ".join(f"'{w}'" for w in words)


def _nearest(word: str, known: Any) -> str:
    close = difflib.get_close_matches(word, list(known), n=1, cutoff=0.5)
    return f"; did you mean '{close[0]}'?" if close else f"; known are {_words(known)}"
