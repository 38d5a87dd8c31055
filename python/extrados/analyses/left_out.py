"""What a deck says of its building and an analysis does not use: told by `check` and beside the first answer."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from extrados import kinds
from extrados.analyses.table import OVERRIDES, Analysis, BuildingAnalysis
from extrados.decks.reader import PROPERTIES, Deck
from extrados.model.errors import Key
from extrados.model.properties import JointType
from extrados.schema.table import Table
from extrados.views.building import Building

#: What bears on whether stones stand, however that is asked: worth a word where only some of a deck's analyses use it
SHARED = frozenset(f"joints.{name}" for name in ("friction", "cohesion", "tension", "compressive_strength", "worn_corners")) | {
    "material.compressive_strength",
    "supports.stiffness",
}

#: The analyses that apply the rules of [code]
BY_CODE = ("code-checks", "local-mechanism", "pushover", "frame-pushover", "sla", "assess")


@dataclass(frozen=True)
class Remark:
    """A remark with file and line, and the number of the first analysis of the deck that it is about."""

    text: str
    analysis: int


def left_out(deck: Deck) -> list[Remark]:
    """Keys of the building that the deck itself gives and that none of its analyses uses, or, of what bears on
    whether stones stand, not all; each key once. A value that is the default says nothing, and is not asked for."""
    asked = [_reckoned_with(*each) for each in zip(deck.analyses, deck.buildings, strict=True)]
    names = _names(deck.analyses)
    found: dict[tuple[str, str], Remark] = {}
    for name, at in _said(deck.building):
        # who overrides a key for itself does not hear what the deck says of it
        hears = [k for k in range(len(asked)) if not _overrides(deck.analyses[k], name)]
        without = [k for k in hears if name not in asked[k]]
        if not without or ("", name) in found:
            continue
        who, able = ", ".join(names[k] for k in without), [names[k] for k in hears if k not in without]
        if not able:
            text = f"{who} {'does' if len(without) == 1 else 'do'} not use this key{_known_to(name, deck.analyses)}"
        elif name in SHARED:
            text = f"{', '.join(able)} {'uses' if len(able) == 1 else 'use'} this key; {who} {'does' if len(without) == 1 else 'do'} not"
        else:
            continue
        found["", name] = Remark(deck.complaint(None, at, text), without[0])
    for k, options in enumerate(deck.analyses):
        for table in OVERRIDES:
            for name, at in _given(table, getattr(options, table, None)):
                if name not in asked[k] and (names[k], name) not in found:
                    words = f"{names[k]} does not use this key{_known_to(name, deck.analyses)}"
                    found[names[k], name] = Remark(deck.complaint(options, ("analysis", *at), words), k)
    found |= _dashpots(deck, names) | _water(deck, names)
    if deck.code is not None and not any(getattr(o, "by", o.kind) in BY_CODE for o in deck.analyses):
        found["", "code"] = Remark(
            deck.complaint(None, ("code",), f"no analysis of this deck uses this table; {', '.join(BY_CODE)} can use it"), 0
        )
    return list(found.values())


def _dashpots(deck: Deck, names: list[str]) -> dict[tuple[str, str], Remark]:
    """Viscous dampers of the deck, where statics are asked."""
    still = [k for k, options in enumerate(deck.analyses) if not options.has_rates]
    who = f"{', '.join(names[k] for k in still)} {'does' if len(still) == 1 else 'do'} not use this key: a viscous damper has no force in statics"
    return {
        ("dampers", str(n)): Remark(deck.complaint(None, ("dampers", n, "damping"), who), still[0])
        for n, damper in enumerate(deck.building.dampers)
        if still and damper.damping is not None
    }


def _water(deck: Deck, names: list[str]) -> dict[tuple[str, str], Remark]:
    """Water of an analysis, where others of the same building do not include it."""
    wet = [k for k, options in enumerate(deck.analyses) if getattr(options, "water", None) is not None]
    dry = [k for k, options in enumerate(deck.analyses) if k not in wet and isinstance(options, BuildingAnalysis)]
    if not wet or not dry:
        return {}
    text = (
        f"{', '.join(names[k] for k in wet)} {'includes' if len(wet) == 1 else 'include'} this water; "
        f"{', '.join(names[k] for k in dry)} {'does' if len(dry) == 1 else 'do'} not"
    )
    return {("analysis", "water"): Remark(deck.complaint(deck.analyses[wet[0]], ("analysis", "water"), text), dry[0])}


def _reckoned_with(options: Analysis, building: Building) -> set[str]:
    if options.kind == "assess":
        return kinds.load("analyses.assess.strategies:reckon_with")(options, building)
    return options.reckons_with(building)


def _said(building: Building) -> Iterator[tuple[str, Key]]:
    """Name and place of every property that the tables of the deck give."""
    for table in OVERRIDES:
        yield from _given(table, getattr(building, table))
    for name, material in building.materials.items():
        for key, (_, *at) in _given("material", material):
            yield key, ("materials", name, *at)


def _given(table: str, model: Table | None) -> Iterator[tuple[str, Key]]:
    """Of one table, or of what an analysis overrides of it, what differs from the defaults; what [[joints.types]] give
    counts as given to all joints."""
    for name, value in _differing(model, PROPERTIES[table]):
        if name != "types":
            yield f"{table}.{name}", (table, name)
            continue
        for k, kind in enumerate(value):
            for key, _ in _differing(kind, JointType):
                if key != "joints":
                    yield f"{table}.{key}", (table, name, k, key)


def _differing(model: Table | None, sort: type[Table]) -> Iterator[tuple[str, Any]]:
    for name, known in sort.model_fields.items():
        if model is not None and name in model.model_fields_set:
            value = getattr(model, name)
            if value is not None and value != known.default:
                yield name, value


def _overrides(options: Analysis, name: str) -> bool:
    table, key = name.split(".")
    own = getattr(options, table, None)
    return own is not None and key in own.model_fields_set


def _names(analyses: list[Analysis]) -> list[str]:
    """The analyses as words, numbered where there are several of a kind."""
    every = [options.kind for options in analyses]
    return [f"{kind}-{every[:k].count(kind) + 1}" if kind in every[:k] else kind for k, kind in enumerate(every)]


def _known_to(name: str, asked: list[Analysis]) -> str:
    """Analyses that use a key, as words; not those of the deck, whose options or building keep them from it."""
    here = {options.kind for options in asked}
    tables = {kind: kinds.load(parts.table) for kind, parts in kinds.ANALYSES.items() if kind not in here}
    able = [kind for kind, table in tables.items() if name in (*table.uses, *table.beside)]
    return f"; {', '.join(able[:3])}{' and others' if len(able) > 3 else ''} can use it" if able else ""
