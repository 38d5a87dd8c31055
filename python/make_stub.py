"""Write the stub of the package, `__init__.pyi`: type checkers and editors then know the keys of every table.

    make_stub.py PACKAGE OUT

PACKAGE is the folder of the sources. The constructors come from the deck tables, the functions from `__init__.py`.
"""

import ast
import re
import sys
import types
from pathlib import Path
from typing import Annotated, Any, Literal, Union, get_args, get_origin

HEAD = '''"""Made by the build from the deck tables."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any, Literal

from extrados.analyses.context import Refused as Refused
from extrados.decks.reader import Deck as _Deck, DeckError as DeckError
from extrados.explore.widget import Page as _Page
from extrados.results.store import StoreError as StoreError
from extrados.running.live import Live as _Live
from extrados.running.run import Run as _Run
from extrados.running.sweep import Sweep as _Sweep

__version__: str
'''
PLAIN = {float: "float", int: "int", str: "str", bool: "bool", type(None): "None"}


def written(kind: Any, quantity: bool) -> str:
    """The type of a key as a caller may give it; a number of a quantity may be text with its unit."""
    origin, parts = get_origin(kind), get_args(kind)
    if origin is Annotated:
        return written(parts[0], quantity)
    if origin in (Union, types.UnionType):
        return " | ".join(dict.fromkeys(written(part, quantity) for part in parts))
    if origin is Literal:
        return f"Literal[{', '.join(map(repr, parts))}]"
    if origin in (list, tuple):
        inner = dict.fromkeys(written(part, quantity) for part in parts if part is not Ellipsis)
        return f"Sequence[{' | '.join(inner)}]"
    if kind is float and quantity:
        return "float | str"
    return PLAIN.get(kind, "Any")


def constructor(name: str, table: Any) -> str:
    """The class of a table with its keys."""
    from extrados.schema.quantities import mark_of

    keys = {key: field for key, field in table.model_fields.items() if key != "kind"}
    kinds = {key: written(field.annotation, mark_of(table, key) is not None) for key, field in keys.items()}
    given = [f"{key}: {kinds[key]}{'' if field.is_required() else ' = ...'}" for key, field in keys.items()]
    lines = [f"class {name}:", f"    def __init__(self{', *' if given else ''}{''.join(f', {one}' for one in given)}) -> None: ..."]
    return "\n".join([*lines, *(f"    {key}: Any" for key in keys)])


def functions(package: Path) -> list[str]:
    """The functions of the package that users call, without their bodies; a class that they name is no table of that name."""
    found = []
    for node in ast.parse((package / "__init__.py").read_text(encoding="utf-8")).body:
        if isinstance(node, ast.FunctionDef) and not node.name.startswith("_"):
            node.body = [ast.Expr(ast.Constant(...))]
            found.append(re.sub(r"\b(Deck|Live|Page|Run|Sweep)\b", r"_\1", ast.unparse(node)))
    return found


def make_stub(package: Path) -> str:
    """The text of the stub."""
    from extrados import objects

    tables = [constructor(name, objects.maker(name).table) for name in objects.names()]
    return "\n\n".join([HEAD, *functions(package), *tables]) + "\n"


if __name__ == "__main__":
    source, out = map(Path, sys.argv[1:])
    # the finder of an earlier editable installation would build again, which is what runs here
    sys.meta_path = [finder for finder in sys.meta_path if type(finder).__module__ != "_extrados_editable_loader"]
    sys.path.insert(0, str(source.parent))
    out.write_text(make_stub(source), encoding="utf-8")
