"""Messages, descriptions and answers use the terms of the field: none of the words that the glossary of the project replaces."""

import ast
import re
from pathlib import Path

import pytest

import extrados

ROOT = Path(extrados.__file__).parent
PACKAGES = ("results", "limit", "running", "cli", "analyses/codes", "analyses/assess", "analyses/limit")
REPLACED = re.compile(
    r"\b(?:comes? down|came down|br(?:ing|ings|ought)(?: \w+){0,5} down|bears?|borne|gives? way|falls?|fell|nobody|for ever|the clock|"
    r"last digits|stays? up|asked for|hangs? on|hold (?:it|them) from|goes on|told|tells?|stands on|left out)\b"
)


def texts(path: Path) -> list[tuple[int, str]]:
    """Line and text of the strings of a module that are sentences or parts of them, without its docstrings."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    said = [n.value for n in ast.walk(tree) if isinstance(n, ast.Expr)]
    return [
        (n.lineno, n.value) for n in ast.walk(tree)
        if isinstance(n, ast.Constant) and isinstance(n.value, str) and " " in n.value.strip() and n not in said
    ]  # fmt: skip


@pytest.mark.parametrize("package", PACKAGES)
def test_texts_use_the_terms_of_the_field(package: str) -> None:
    modules = sorted((ROOT / package).glob("*.py"))
    found = [
        f"{path.relative_to(ROOT)}:{line}: '{match.group()}' in '{text}'"
        for path in modules for line, text in texts(path) if (match := REPLACED.search(text)) and text != "left out"
    ]  # fmt: skip
    assert modules and not found, "\n".join(found)
