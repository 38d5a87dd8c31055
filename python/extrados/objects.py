"""Tables of decks as Python objects: `extrados.Arch(radius=10.0, ...)` is the table `[structure] kind = "arch"`.

Every name is that of a table class registered in `kinds`, which is loaded at its first use.
"""

import inspect
from collections.abc import Mapping
from functools import cached_property
from pathlib import Path
from typing import Any

from extrados import kinds

#: Class of a table -> its section and kind
_NAMED = {place.split(":")[1]: (section, kind) for section, there in kinds.TABLES.items() for kind, place in there.items()}


class Maker:
    """Makes the tables of one kind: call it with the keys of the table, as in a deck.

    Numbers are in SI (angles in degrees), or text with a unit: "20 cm". A wrong key or value raises DeckError with the
    expected form. `isinstance(x, extrados.Arch)` recognises a table of this kind.
    """

    def __init__(self, name: str, section: str, kind: str):
        self.__name__ = self.__qualname__ = name
        self.section, self.kind = section, kind

    @cached_property
    def table(self) -> Any:
        """The class of its tables, a pydantic model."""
        return kinds.table(self.section, self.kind) if self.kind else _plain()[self.__name__][1]

    def __call__(self, **keys: Any) -> Any:
        from extrados.decks.reader import check_table

        return check_table(self.table, self.section, as_deck({**self._fixed, **keys}), f"extrados.{self.__name__}")

    @property
    def _fixed(self) -> dict[str, str]:
        return {"kind": self.kind} if self.kind else {}

    def __instancecheck__(self, thing: object) -> bool:
        return isinstance(thing, self.table)

    def __repr__(self) -> str:
        kind = f' kind = "{self.kind}"' if self.kind else ""
        return f"<extrados.{self.__name__}: [{self.section}]{kind}>"

    @cached_property
    def __doc__(self) -> str:  # type: ignore[override]
        from extrados.decks.explain import table_facts

        told = table_facts(self.section, self.kind, self.table)
        rows = [f"{name} : {key.facts or 'see its own keys'}\n    {key.about}" for name, key in told.keys.items() if "." not in name]
        return f"{told.summary}\n\nKeys\n----\n" + "\n".join(rows)

    @property
    def __signature__(self) -> inspect.Signature:
        fields = self.table.model_fields.items()
        return inspect.Signature(
            [
                inspect.Parameter(
                    name, inspect.Parameter.KEYWORD_ONLY, default=inspect.Parameter.empty if f.is_required() else f.get_default()
                )
                for name, f in sorted(fields, key=lambda pair: not pair[1].is_required())
                if name != "kind"
            ]
        )


def _plain() -> dict[str, tuple[str, Any]]:
    """Tables without kinds, by the names of their classes."""
    from extrados.decks.plural import PLURAL
    from extrados.decks.reader import PROPERTIES
    from extrados.schema.code import Code

    tables: dict[str, Any] = {**PROPERTIES, **PLURAL, "code": Code}
    return {model.__name__: (section, model) for section, model in tables.items()}


def maker(name: str) -> Maker:
    """The maker of the tables of a class; KeyError where no table is called so."""
    if name in _NAMED:
        return Maker(name, *_NAMED[name])
    return Maker(name, _plain()[name][0], "")


def names() -> list[str]:
    """The names that `maker` accepts."""
    return [*_NAMED, *_plain()]


def as_deck(value: Any) -> Any:
    """The content of a deck: tables as dictionaries of the given keys, also within lists and dictionaries."""
    from extrados.schema.quantities import mark_of
    from extrados.schema.table import Table

    if isinstance(value, Table):
        found = {}
        for name in type(value).model_fields:
            if name in value.model_fields_set:
                mark, given = mark_of(type(value), name), getattr(value, name)
                found[name] = as_deck(given if mark is None or mark.bare else _with_unit(given, mark.si))
        return found
    if isinstance(value, Mapping):
        return {key: as_deck(one) for key, one in value.items()}
    if isinstance(value, list | tuple):
        return [as_deck(one) for one in value]
    return value.item() if type(value).__module__ == "numpy" and value.ndim == 0 else value


def _with_unit(value: Any, unit: str) -> Any:
    """Numbers that a deck does not take without a unit, as the text that gives the same bits."""
    if isinstance(value, list):
        return [_with_unit(one, unit) for one in value]
    return f"{value!r} {unit}" if isinstance(value, float) else value


def deck(structure: Any = None, analysis: Any = None, *, folder: str | Path | None = None, **tables: Any) -> Any:
    """A checked deck from tables: `extrados.deck(extrados.Arch(...), [extrados.Tilt()], motion=..., joints=...)`.

    Each is an object of this module or a dictionary of the same keys; `analysis` may be a list of them, as may `ties`,
    `dampers` and `hinges`. folder: where files that the deck names are looked for. DeckError lists all that is wrong.
    """
    from extrados.decks.reader import make_deck

    given = {"structure": structure, **tables, "analysis": analysis}
    data = {name: as_deck(table) for name, table in given.items() if table is not None}
    return make_deck(data, None if folder is None else Path(folder))
