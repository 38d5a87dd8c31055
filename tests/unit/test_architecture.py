"""Who may import whom, and what the compiled core may not contain: the plan of CONTRIBUTING.md, kept true."""

import ast
import re
import subprocess
from functools import cache
from pathlib import Path

import pytest

from extrados import _core

ROOT = Path(__file__).resolve().parents[2]
PACKAGE = ROOT / "python" / "extrados"

#: Package -> packages it may import, in the order of the layers: each imports only what stands above it here, and itself.
#: Deck tables of analyses are a layer of their own, which decks read. "" is the face of the package.
LAYERS = {
    "schema": set(),
    "interrupts": set(),
    "room": set(),
    "kinds": {"room", "schema"},
    "core": {"interrupts", "schema"},
    "model": {"schema"},
    "motions": {"core", "schema"},
    "limit": {"core", "model", "schema"},
    "views": {"kinds", "core", "limit", "model", "schema"},
    "tables": {"kinds", "model", "views", "schema"},
    "decks": {"kinds", "tables", "model", "views", "schema"},
    "results": {"kinds", "schema"},
    "analyses": {"kinds", "tables", "decks", "model", "views", "motions", "limit", "core", "results", "schema", "interrupts", "room"},
    "show": {"interrupts", "kinds", "results", "schema"},
    "objects": {"kinds", "decks", "schema"},
    "bridges": {"decks", "model", "views", "schema"},
    "running": {"interrupts", "objects", "kinds", "analyses", "tables", "model", "views", "decks", "motions", "results", "show", "schema"},
    "explore": {
        "bridges",
        "interrupts",
        "kinds",
        "analyses",
        "tables",
        "model",
        "views",
        "limit",
        "decks",
        "motions",
        "core",
        "results",
        "show",
        "running",
        "schema",
    },
    "": {"analyses", "bridges", "decks", "objects", "results", "running", "explore"},
    "cli": {"bridges", "interrupts", "kinds", "analyses", "decks", "results", "show", "running", "explore", "schema", "room"},
    "__main__": {"cli", "interrupts"},
}
#: Made by the build, which knows no sources of ours
BUILT = ("extrados._core", "extrados._build_info")
#: Names of the standard library that begin with an underscore and are public
STANDARD = {"_replace", "_asdict", "_fields", "_exit"}
#: Fortran room -> rooms it may use
MAY_USE = {
    "common": set(),
    "mechanism": {"common", "nonsmooth"},
    "arch": {"common", "mechanism"},
    "rocking": {"common", "arch", "mechanism"},
    "sla": {"common"},
    "shell": {"common", "sla"},
    "frame": {"common"},
    "nonsmooth": {"common"},
    "dem": {"common", "nonsmooth"},
    "dem3": {"common", "dem", "nonsmooth"},
    "motion": {"common"},
    "limit": {"common"},
}


@cache  # by the first test that needs it, not by each process that collects tests
def modules() -> dict[str, ast.Module]:
    """Name -> syntax tree of every module of the package."""
    found = {}
    for path in sorted(PACKAGE.rglob("*.py")):
        name = ".".join(("extrados", *path.relative_to(PACKAGE).with_suffix("").parts)).removesuffix(".__init__")
        found[name] = ast.parse(path.read_text(encoding="utf-8"))
    return found


def imported_of(tree: ast.Module) -> set[str]:
    """The modules of the package that a module imports anywhere: at its top, late in a function, or for its types alone."""
    found = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and node.module and node.module.split(".")[0] == "extrados":
            names = {f"{node.module}.{alias.name}" for alias in node.names}
            found |= {name if name in modules() else node.module for name in names if name not in BUILT}
        elif isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names if alias.name.split(".")[0] == "extrados"}
    return found & set(modules())


@cache
def graph() -> dict[str, set[str]]:
    """Name -> the modules that it imports, of every module of the package."""
    return {name: imported_of(tree) - {name} for name, tree in modules().items()}


def layer_of(module: str) -> str:
    """The package of a module; deck tables of analyses stand below it."""
    inner = module.removeprefix("extrados").removeprefix(".")
    return "tables" if re.fullmatch(r"analyses\.(\w+\.)?tables?", inner) else inner.split(".")[0]


def circles_of(graph: dict[str, set[str]]) -> list[list[str]]:
    """Strongly connected components of more than one module (Tarjan 1972)."""
    number: dict[str, int] = {}
    low: dict[str, int] = {}
    stack: list[str] = []
    found: list[list[str]] = []

    def visit(one: str) -> None:
        number[one] = low[one] = len(number)
        stack.append(one)
        for other in graph[one]:
            if other not in number:
                visit(other)
                low[one] = min(low[one], low[other])
            elif other in stack:
                low[one] = min(low[one], number[other])
        if low[one] == number[one]:
            circle = [stack.pop()]
            while circle[-1] != one:
                circle.append(stack.pop())
            if len(circle) > 1:
                found.append(sorted(circle))

    for one in graph:
        if one not in number:
            visit(one)
    return found


def test_circles_are_found() -> None:
    found = {"a": {"b"}, "b": {"c"}, "c": {"b", "d"}, "d": set(), "e": {"a", "f"}, "f": {"e"}}
    assert circles_of(found) == [["b", "c"], ["e", "f"]]


def test_no_import_circle() -> None:
    assert circles_of(graph()) == []


def test_layers_stand_in_order() -> None:
    names = list(LAYERS)
    for place, (name, below) in enumerate(LAYERS.items()):
        assert below <= set(names[:place]), name


def test_a_module_imports_only_lower_layers() -> None:
    unplaced = {layer_of(module) for module in modules()} - set(LAYERS)
    assert not unplaced, "new packages: give them a place among the layers"
    higher = {}
    for module, imported in graph().items():
        here = layer_of(module)
        if found := {layer_of(other) for other in imported} - {here} - LAYERS[here]:
            higher[module] = found
    assert not higher


def test_no_private_name_of_another_module() -> None:
    assert not {module: found for module, tree in modules().items() if (found := private_names_of_others(tree))}


def private_names_of_others(tree: ast.Module) -> list[str]:
    """Private names of other modules that a module imports, or reads as attributes."""
    foreign = []
    own = {getattr(node, "name", "") for node in ast.walk(tree)}
    own |= {node.id for node in ast.walk(tree) if isinstance(node, ast.Name)}
    own |= {node.attr for node in ast.walk(tree) if isinstance(node, ast.Attribute) and of_itself(node)}
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and (node.module or "").split(".")[0] == "extrados":
            foreign += [alias.name for alias in node.names if is_private(alias.name)]
        elif isinstance(node, ast.Attribute) and is_private(node.attr) and not of_itself(node):
            foreign += [node.attr] if node.attr not in own | STANDARD else []
    return foreign


def is_private(name: str) -> bool:
    return name.startswith("_") and not name.startswith("__") and f"extrados.{name}" not in BUILT


def of_itself(node: ast.Attribute) -> bool:
    return isinstance(node.value, ast.Name) and node.value.id in ("self", "cls")


@pytest.mark.parametrize("path", sorted((ROOT / "fortran").rglob("*.f90")), ids=lambda p: str(p.relative_to(ROOT / "fortran")))
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
    for word in (r"\bstop\b", r"\bprint\b", r"\bwrite\s*\(", r"\bread\s*\(", r"\bopen\s*\(", r"\bsave\b", r"\bcommon\s*/"):
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


MOST_LINES, MOST_PARAMETERS = 80, 12


def _functions_beyond() -> set[str]:
    """Functions of the package with more lines or parameters than the limits."""
    found = set()
    for path in sorted(PACKAGE.rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
                args = node.args
                count = len(args.posonlyargs) + len(args.args) + len(args.kwonlyargs)
                if (node.end_lineno or 0) - node.lineno + 1 > MOST_LINES or count > MOST_PARAMETERS:
                    found.add(f"{path.relative_to(PACKAGE)} {node.name}")
    return found


def test_functions_are_short() -> None:
    """At most 80 lines and 12 parameters."""
    assert not _functions_beyond(), "divide these functions"
