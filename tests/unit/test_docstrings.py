"""What is public says what it takes and gives: parameters by their names, arrays with shape and unit, keys of tables."""

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


def shown() -> dict[str, typing.Any]:
    """Functions of `extrados` and what the Python reference shows of its classes, by their names."""
    page = (ROOT / "docs" / "python.md").read_text(encoding="utf-8")
    found = {f"extrados.{name}": getattr(extrados, name) for name in extrados.__all__}
    for place, options in re.findall(r"auto(?:class|exception):: ([\w.]+)(?:\(\))?\n((?: +:.*\n)*)", page):
        module, name = place.rsplit(".", 1)
        found[place] = made = getattr(importlib.import_module(module), name)
        if ":members:" in options:
            words = [word for word in dir(made) if not word.startswith("_") and f"members: {word}" not in options]
            found |= {f"{place}.{word}": getattr(made, word) for word in words if callable(getattr(made, word))}
    return found


SHOWN = shown()


@pytest.mark.parametrize("name", SHOWN)
def test_what_is_public_says_what_it_takes_and_gives(name: str) -> None:
    thing = SHOWN[name]
    told = inspect.getdoc(thing) or ""
    assert len(told) > 20
    if inspect.isclass(thing):
        return
    silent = {"self", "how", "tables"}  # collected: the text above them tells what may be given
    signature = inspect.signature(thing)
    assert not [one for one in signature.parameters if one not in silent and not re.search(rf"\b{one}s?\b", told)]
    if "ndarray" in str(signature.return_annotation):
        assert SHAPE.search(told) and UNIT.search(told), "of which shape, in which unit?"


def test_every_key_of_a_table_says_what_it_is_and_how_many() -> None:
    """A list of numbers tells its length and unit also where it may be left out."""
    known = {(table.section, table.kind): table for table in explain.facts()}
    for section, there in kinds.TABLES.items():
        for kind in there:
            for name, field in kinds.table(section, kind).model_fields.items():
                facts = known[section, kind].keys.get(name)
                if facts is None:
                    continue  # the kind itself, and tables of the building that are told once
                assert facts.about, f"[{section}] {kind}: {name} says nothing"
                if re.search(r"list\[(?:typing\.Annotated\[)?float", str(field.annotation)):
                    assert "list" in facts.facts, f"[{section}] {kind}: {name} is a list and does not say so"
    assert known["analysis", "failure-domain"].keys["durations"].facts.startswith("list of 1 to 2000, s")


@pytest.mark.parametrize("file", sorted((PACKAGE / "core").glob("*.py")), ids=lambda p: p.stem)
def test_calls_of_the_core_report_shapes(file: Path) -> None:
    """The one layer where every array is handed over: each parameter that is one is named, and shapes are told."""

    def look(nodes: list[ast.stmt], beside: str) -> typing.Iterator[str]:
        for one in nodes:
            if isinstance(one, ast.ClassDef) and not one.name.startswith("_"):
                yield from look(one.body, ast.get_docstring(one) or "")
            if not isinstance(one, ast.FunctionDef) or (one.name.startswith("_") and one.name != "__init__"):
                continue
            told = (ast.get_docstring(one) or "") + " " + beside
            arrays = {
                a.arg
                for a in [*one.args.args, *one.args.kwonlyargs]
                if re.search("ndarray|ArrayLike", ast.unparse(a.annotation or ast.Constant(None)))
            }
            given = "ndarray" in ast.unparse(one.returns or ast.Constant(None))
            if arrays - set(re.findall(r"\w+", told)) or ((arrays or given) and not SHAPE.search(told)):
                yield one.name

    assert not list(look(ast.parse(file.read_text(encoding="utf-8")).body, ""))
