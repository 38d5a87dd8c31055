"""Who may import whom, and what the compiled core may not contain: the plan of CONTRIBUTING.md, kept true."""

import ast
import re
import subprocess
from pathlib import Path

import pytest

from extrados import _core

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = ROOT / "python" / "extrados"

#: room -> rooms it may import; a room may always import itself. "" is the package's own top level.
MAY_IMPORT = {
    "schema": set(),
    "kinds": {"room"},
    "interrupts": set(),
    "room": set(),
    "_build_info": set(),  # made by the build; it lies among the sources where a tool builds apart
    "core": {"_core", "interrupts", "schema"},
    "geometry": {"errors", "schema"},
    "errors": set(),
    "limit": {"geometry", "errors", "core", "schema"},
    "rockers": {"model", "views", "geometry", "errors", "limit", "core", "schema"},
    "model": {"views", "geometry", "errors", "rockers", "schema"},
    "views": {"model", "geometry", "errors", "rockers", "schema"},
    "motions": {"core", "schema"},
    "tables": {"model", "views", "schema"},
    "decks": {"kinds", "tables", "model", "views", "schema"},
    "results": {"kinds", "schema", "_build_info"},
    "analyses": {
        "kinds", "tables", "decks", "model", "views", "geometry", "errors", "rockers", "motions", "limit", "core", "results",
        "schema", "interrupts", "room",
    },
    "show": {"interrupts", "kinds", "results", "schema"},
    "running": {"interrupts", "objects", "kinds", "analyses", "tables", "model", "views", "geometry", "errors", "decks", "motions", "results", "show", "schema", "_build_info"},
    "explore": {
        "interrupts", "kinds", "analyses", "tables", "model", "views", "geometry", "errors", "limit", "decks", "motions", "core", "results", "show",
        "running", "schema", "_build_info",
    },
    "objects": {"kinds", "decks", "schema"},
    "bridges": {"decks", "model", "views", "geometry", "errors", "rockers", "schema", "_build_info"},
    "cli": {"bridges", "interrupts", "kinds", "analyses", "decks", "results", "show", "running", "explore", "schema", "_build_info", "room"},
    "__main__": {"cli", "interrupts"},
    "": {"analyses", "bridges", "decks", "objects", "results", "running", "explore"},
}  # fmt: skip
#: Rooms within rooms: the deck tables of analyses are what decks read; views of a building that rock need limit
#: analysis, which knows blocks and joints alone
WITHIN = (
    (re.compile(r"model[./]geometry\b"), "geometry"),
    (re.compile(r"model[./]errors\b"), "errors"),
    (re.compile(r"views[./]rockers\b"), "rockers"),
    (re.compile(r"analyses[./](\w+[./])?tables?\b"), "tables"),
)
#: Fortran room -> rooms it may use
MAY_USE = {
    "common": set(),
    "mechanism": {"common", "nonsmooth"},
    "arch": {"common", "mechanism"},
    "rocking": {"common", "arch", "mechanism"},
    "sla": {"common"},
    "shell": {"common", "sla"},
    "nonsmooth": {"common"},
    "dem": {"common", "nonsmooth"},
    "dem3": {"common", "dem", "nonsmooth"},
    "motion": {"common"},
    "limit": {"common"},
}


def room(place: str) -> str:
    """The room of a module, by its dotted name or its path below the package."""
    inner = next((name for pattern, name in WITHIN if pattern.match(place)), None)
    return inner or re.split(r"[./]", place)[0]


def room_of(path: Path) -> str:
    place = path.relative_to(PACKAGE).with_suffix("").as_posix()
    return "" if place == "__init__" else room(place)


def imports(path: Path) -> set[str]:
    found = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and node.module and node.module.startswith("extrados"):
            rest = node.module.removeprefix("extrados").removeprefix(".")
            found |= {room(f"{rest}.{alias.name}" if rest else alias.name) for alias in node.names}
        elif isinstance(node, ast.Import):
            found |= {room(a.name.removeprefix("extrados.")) for a in node.names if a.name.startswith("extrados.")}
    return found


@pytest.mark.parametrize("path", sorted(PACKAGE.rglob("*.py")), ids=lambda p: str(p.relative_to(PACKAGE)))
def test_python_rooms(path: Path) -> None:
    here = room_of(path)
    assert here in MAY_IMPORT, f"{here} is a new room: add it to the plan"
    assert imports(path) - {here} <= MAY_IMPORT[here]


@pytest.mark.parametrize(
    "path", sorted((ROOT / "fortran").rglob("*.f90")), ids=lambda p: str(p.relative_to(ROOT / "fortran"))
)
def test_fortran_rooms(path: Path) -> None:
    room, text = path.parent.name, path.read_text(encoding="utf-8")
    module = re.search(r"^module (\w+)", text, re.M)[1]
    assert module == (path.stem if room == "api" else f"{room}_{path.stem}"), "module name is the path"
    used = {m.split("_")[0] for m in re.findall(r"^\s*use (?!, intrinsic)(\w+)", text, re.M)}
    if room == "api":
        assert len(used - {"common"}) <= 1, "a facade serves one room"
    else:
        assert used <= MAY_USE[room] | {room}
    code = re.sub(r"!.*", "", text).lower()
    for word in (
        r"\bstop\b",
        r"\bprint\b",
        r"\bwrite\s*\(",
        r"\bread\s*\(",
        r"\bopen\s*\(",
        r"\bsave\b",
        r"\bcommon\s*/",
    ):
        assert not re.search(word, code), f"{path.name} must not {word}"


def test_no_silent_float() -> None:
    """f2py maps an unknown real kind to a C float without a word."""
    for name in dir(_core):
        module = getattr(_core, name)
        for facade in dir(module):
            text = getattr(getattr(module, facade), "__doc__", "") or ""
            assert "array('f')" not in text, f"{name}.{facade}"


def test_core_never_stops_the_process() -> None:
    """No stop, no Fortran I/O and no unchecked allocation that would end the interpreter."""

    def nm(*options: str) -> str:
        return subprocess.run(["nm", *options, _core.__file__], capture_output=True, text=True, check=True).stdout

    found = re.findall(
        r"\b(_gfortran_(?:stop|error_stop|os_error|st_write|st_read|st_open|exit)\w*|exit|abort|printf|system)\b",
        nm("-D", "--undefined-only"),
    )
    # numpy's own fortranobject.c refers to none of these either; the code that counts lines for coverage does, in C
    counts = "__gcov_init" in nm()
    assert not [name for name in found if name.startswith("_gfortran_") or not counts]


def test_no_evaluation_of_code() -> None:
    """Decks and records are data."""
    for path in PACKAGE.rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
                assert node.func.id not in {"eval", "exec", "compile", "__import__"}, path
            if isinstance(node, ast.Import | ast.ImportFrom):
                names = {a.name for a in node.names} | {getattr(node, "module", "") or ""}
                assert not names & {"pickle", "marshal", "shelve", "dill", "joblib"}, path


@pytest.mark.parametrize("room", ["analyses", "model", "views"])
def test_a_refusal_says_which_key_is_to_blame(room: str) -> None:
    """Or, by WHOLE, that none is: so that it is told with file and line wherever that can be."""
    silent = []
    for path in sorted((PACKAGE / room).rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Call):
                name = node.func.id if isinstance(node.func, ast.Name) else getattr(node.func, "attr", "")
                if name in ("Refused", "NoView") and len(node.args) + len(node.keywords) < 2:
                    silent.append(f"{path.relative_to(PACKAGE)}:{node.lineno}")
    assert not silent
