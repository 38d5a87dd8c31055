"""What is public says what it does: parameters by their names, arrays with shape and unit."""

import ast
import importlib
import inspect
import re
import typing
from pathlib import Path

import pytest

import extrados
from extrados import kinds
from extrados.decks import explain

PACKAGE = Path(extrados.__file__).parent
ROOT = Path(__file__).resolve().parents[2]
#: "(n)", "(nodes, 3)", "(n + 1, 2)", "(4,)", "(None, 2)": the lengths of the axes of an array
SHAPE = re.compile(r"\((?:\d+|[a-zN.][\w .+*/-]*)(?:, ?[\w .+*/-]+)*,?\)")
UNIT = re.compile(r"\[[^\]]+\]|\bSI\b|\bunit\b|\bN\b")


def shown() -> list[tuple[str, typing.Any]]:
    """Functions of `extrados` and what the Python reference shows of its classes, by their names."""
    page = (ROOT / "docs" / "python.md").read_text(encoding="utf-8")
    found = [(f"extrados.{name}", getattr(extrados, name)) for name in extrados.__all__]
    for place, options in re.findall(r"auto(?:class|exception):: ([\w.]+)(?:\(\))?\n((?: +:.*\n)*)", page):
        module, name = place.rsplit(".", 1)
        made = getattr(importlib.import_module(module), name)
        found.append((place, made))
        left_out = re.search(r":exclude-members: (.*)", options)
        if ":members:" in options:
            found += [
                (f"{place}.{word}", getattr(made, word))
                for word in dir(made)
                if not word.startswith("_") and callable(getattr(made, word)) and word not in (left_out[1] if left_out else "")
            ]  # fmt: skip
    return found


SHOWN = shown()


def test_the_reference_shows_functions_and_classes() -> None:
    names = {name.rsplit(".", 1)[-1] for name, _ in SHOWN}
    assert {*extrados.__all__, "Run", "Live", "Sweep", "Drawn", "array", "column", "update"} <= names


@pytest.mark.parametrize(("name", "thing"), SHOWN, ids=[name for name, _ in SHOWN])
def test_what_is_public_says_what_it_takes_and_gives(name: str, thing: typing.Any) -> None:
    told = inspect.getdoc(thing) or ""
    assert len(told) > 20, name
    if inspect.isclass(thing):
        return
    silent = {"self", "how", "tables"}  # collected: the text above them tells what may be given
    unsaid = [
        one for one in inspect.signature(thing).parameters if one not in silent and not re.search(rf"\b{one}s?\b", told)
    ]
    assert not unsaid, f"{name} says nothing of {', '.join(unsaid)}"
    if "ndarray" in str(inspect.signature(thing).return_annotation):
        assert SHAPE.search(told) and UNIT.search(told), f"{name} gives an array: of which shape, in which unit?"


def test_every_key_of_a_table_says_what_it_is_and_how_many() -> None:
    """A list of numbers tells its length and unit also where it may be left out."""
    known = {(table.section, table.kind): table for table in explain.facts()}
    lists = 0
    for section, there in kinds.TABLES.items():
        for kind in there:
            for name, field in kinds.table(section, kind).model_fields.items():
                facts = known[section, kind].keys.get(name)
                if facts is None:
                    continue  # the kind itself, and tables of the building that are told once
                assert facts.about, f"[{section}] {kind}: {name} says nothing"
                if re.search(r"list\[(?:typing\.Annotated\[)?float", str(field.annotation)):
                    assert "list" in facts.facts, f"[{section}] {kind}: {name} is a list and does not say so"
                    lists += 1
    assert lists > 20
    assert known["analysis", "failure-domain"].keys["durations"].facts.startswith("list of 1 to 2000, s")


def arrays_of(function: ast.FunctionDef) -> tuple[list[str], bool]:
    """The parameters of a function that are arrays, and whether it returns one."""
    given = [*function.args.args, *function.args.kwonlyargs]
    asked = [one.arg for one in given if one.annotation and re.search("ndarray|ArrayLike", ast.unparse(one.annotation))]
    return asked, function.returns is not None and "ndarray" in ast.unparse(function.returns)


@pytest.mark.parametrize("file", sorted((PACKAGE / "core").glob("*.py")), ids=lambda p: p.stem)
def test_calls_of_the_core_say_names_shapes_and_what_they_do(file: Path) -> None:
    """The one layer where every array is handed over: each parameter that is one is named, and shapes are told."""
    wrong = []

    def look(functions: list[ast.stmt], before: str, beside: str) -> None:
        for one in functions:
            if isinstance(one, ast.ClassDef) and not one.name.startswith("_"):
                look(one.body, f"{one.name}.", ast.get_docstring(one) or "")
            if not isinstance(one, ast.FunctionDef) or (one.name.startswith("_") and one.name != "__init__"):
                continue
            told = (ast.get_docstring(one) or "") + " " + beside
            asked, given = arrays_of(one)
            wrong.extend(
                f"{before}{one.name}: {arg} is not told" for arg in asked if not re.search(rf"\b{arg}\b", told)
            )
            if (asked or given) and not SHAPE.search(told):
                wrong.append(f"{before}{one.name}: no shape is told")

    look(ast.parse(file.read_text(encoding="utf-8")).body, "", "")
    assert not wrong


#: Bases outside the package, whose methods need no words of ours
_FOREIGN = {"command", "tick_values", "connection_made", "connection_lost", "pause_writing", "resume_writing"}


def promised(one: ast.stmt) -> bool:
    """A property of a protocol, told with its class, or one of several signatures of a function."""
    return isinstance(one, ast.FunctionDef) and (
        ast.unparse(one.body[-1]) == "..." or "overload" in map(ast.unparse, one.decorator_list)
    )


def test_every_public_name_of_the_package_has_a_docstring() -> None:
    """Its own, or that of the method it stands for in a base class or in a protocol."""
    bases: dict[str, set[str]] = {}
    told: dict[str, set[str]] = {}
    bare = []
    for file in sorted(PACKAGE.rglob("*.py")):
        tree = ast.parse(file.read_text(encoding="utf-8"))
        if not ast.get_docstring(tree) and tree.body:
            bare.append((f"{file.name}: the module", "", ""))
        classes = [node for node in tree.body if isinstance(node, ast.ClassDef)]
        for node in classes:
            bases.setdefault(node.name, set()).update(re.findall(r"\w+", " ".join(map(ast.unparse, node.bases))))
        for node in [tree, *classes]:
            owner = getattr(node, "name", "")
            for one in node.body:
                if not isinstance(one, ast.FunctionDef | ast.ClassDef) or one.name.startswith("_"):
                    continue
                if ast.get_docstring(one):
                    told.setdefault(owner, set()).add(one.name)
                elif not owner.startswith("_") and one.name not in _FOREIGN and not promised(one):
                    bare.append((f"{file.relative_to(PACKAGE)}: {owner}.{one.name}", owner, one.name))

    def inherited(owner: str, name: str, seen: frozenset[str] = frozenset()) -> bool:
        return any(
            name in told.get(base, ()) or inherited(base, name, seen | {base})
            for base in bases.get(owner, set()) - seen
        )

    protocols = {name for owner, names in told.items() if "Protocol" in bases.get(owner, ()) for name in names}
    missing = [place for place, owner, name in bare if not (inherited(owner, name) or (owner and name in protocols))]
    assert not missing, "\n".join(missing)
