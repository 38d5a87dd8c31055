"""Faults of one line in Fortran, C and Python: where each can be planted, which are drawn, and the change itself."""

import ast
import io
import random
import re
import tokenize
import tomllib
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import apart

#: kind -> (pattern of the changed part, its replacements)
FAULTS = {
    "sign": [(r"(?<=[\w)]) \+ (?=[\w(])", " - "), (r"(?<=[\w)]) - (?=[\w(])", " + ")],
    "operator": [(r"(?<=[\w)]) \* (?=[\w(])", " / ")],
    "constant": [(r"(?<![\w.])(?:0\.5|2\.0|3\.0|4\.0|6\.0|0\.25|1\.5|12\.0)(?=_wp|\b(?!e))", None)],
    "comparison": [(r" <= ", " > "), (r" >= ", " < "), (r" < ", " >= "), (r" > ", " <= "), (r" == ", " /= ")],
    "bound": [(r"(?<=\bdo \w = )1(?=, )", "2"), (r"(?<=\bdo [ijk] = )(\w+), (\w+)$", r"\1, \2 - 1")],
}
IN_C = {" == ": " != "}
#: A fault of a join changes a number, a set of blocks, a sense or an outcome that one part of the program hands to another.
#: Faults that change only words, schedules, files, speed or rounding are not drawn. These keywords hand over no part of a
#: building, a motion or a result:
NOT_HANDED_ON = (
    *("strict", "axis", "axis1", "axis2", "dtype", "default", "initial", "keepdims", "minlength", "return_inverse", "rcond", "dir"),
    *("threads", "scheduler", "out", "resume", "files", "figures", "path", "sha256", "seconds", "slow", "parallel", "tell", "exceptions"),
)
#: Signs that change rounding or words alone: those before tolerances and before the most names of a text
ROUNDING = re.compile(r"[-+] (?:\d+(?:\.\d*)?e-(?:[5-9]|\d\d)|(?:SAME|NIL|OPEN|MOST_\w+|small)\b)")
#: Kinds of faults in kernels at the joins: most constants there are tolerances, limits of iterations and digits of a fit
OF_KERNELS = ("sign", "operator", "comparison", "bound")
#: Faults of Python, whose texts and comments are left as they are
IN_PYTHON = {
    "sign": [(r"(?<=[\w)\]]) \+ (?=[\w(\[])", " - "), (r"(?<=[\w)\]]) - (?=[\w(\[])", " + "), (r"(?<=[=(,] )-(?=[a-z(])", "")],
    "key": [(rf", (?!(?:{'|'.join(NOT_HANDED_ON)})\b)\w+=[\w.]+(?=[,)])", "")],
    "filter": [(r"(?<=.) if (?:(?!\belse\b)[^\[\]{}:])+(?=[\]})])", ""), (r"(?<=[)\]]) & (?=\()", " | ")],
    "set": [
        (r"\bmin\(", "max("),
        (r"\bmax\(", "min("),
        (r"\[0\]", "[-1]"),
        (r"\[-1\]", "[0]"),
        (r"\ball\(", "any("),
        (r"\bany\(", "all("),
        (r"\.a\b(?! ?=)", ".b"),
        (r"\.b\b(?! ?=)", ".a"),
    ],
    "unit": [
        (r" / GRAVITY", ""),
        (r" \* GRAVITY", ""),
        (r"\b1e3\b", "1e6"),
        (r"\.depth\b(?! ?=)", ".depth * 2.0"),
        (r"radians\(", "degrees("),
        (r"degrees\(", "radians("),
    ],
}
#: Outcomes and their replacements; these are texts
OUTCOMES = {
    '"stands"': '"collapses"',
    '"collapses"': '"stands"',
    '"cannot-stand"': '"open"',
    '"open"': '"stands"',
    '"collapse"': '"recovery"',
    '"recovery"': '"no-hinging"',
    '"upper"': '"lower"',
    '"holds"': '"fails"',
    '"fails"': '"holds"',
    '"no-sliding"': '"sliding"',
    '"left"': '"right"',
}
#: Joins of strategies: makers of models of a building, calls of the core, makers of verdicts from its results
JOINS = (
    "analyses/conclude.py",
    "analyses/sequence.py",
    "analyses/left_out.py",
    "analyses/motion_source.py",
    "analyses/assess/asking.py",
    "analyses/assess/reasons_of_buildings.py",
    "analyses/assess/reasons_of_motion.py",
    "analyses/assess/reasons_of_statics.py",
    "analyses/codes/kinematics.py",
    "analyses/codes/local_mechanism.py",
    "analyses/codes/mechanisms.py",
    "analyses/codes/ntc.py",
    "analyses/codes/walls.py",
    "analyses/dem/measures.py",
    "analyses/dem/model.py",
    "analyses/dem/history.py",
    "analyses/dem/job.py",
    "analyses/dem/solid_model.py",
    "analyses/dem/standing.py",
    "analyses/dem/tilt.py",
    "analyses/limit/applied.py",
    "analyses/limit/asked.py",
    "analyses/limit/common.py",
    "analyses/limit/moving_load.py",
    "analyses/limit/solids.py",
    "analyses/limit/supports.py",
    "analyses/limit/thrust.py",
    "analyses/limit/tilt.py",
    "analyses/rocking/block.py",
    "analyses/rocking/driver.py",
    "analyses/rocking/failure_domain.py",
    "analyses/rocking/mechanism.py",
    "analyses/rocking/stack.py",
    "analyses/statistics/fragility.py",
    "analyses/statistics/levels.py",
    "analyses/statistics/summaries.py",
    "views/building.py",
    "model/properties.py",
    "model/ties.py",
    "model/geometry/assembly.py",
    "model/geometry/chains.py",
    "model/geometry/compas.py",
    "model/geometry/contacts.py",
    "model/geometry/polygons.py",
    "views/rigid.py",
    "model/geometry/solids/assembly.py",
    "model/geometry/solids/contacts.py",
    "model/geometry/solids/sections.py",
    "views/rockers/arch.py",
    "views/rockers/block.py",
    "views/rockers/frame.py",
    "views/rockers/mechanism.py",
    "views/rockers/rocker.py",
    "views/rockers/stack.py",
    "model/structures/arch.py",
    "model/structures/block.py",
    "model/structures/brickwork.py",
    "model/structures/masonry.py",
    "model/structures/stack.py",
    "results/verdict.py",
    "results/codes.py",
    "results/dem.py",
    "results/rocking.py",
    "results/statistics.py",
    "running/survey.py",
)
#: Kernels at the joins, and the modules of the core that hand them their numbers
KERNELS = {
    "fortran/api/api_arch.f90": "arch",
    "fortran/api/api_dem.f90": "dem",
    "fortran/api/api_dem3.f90": "dem3",
    "fortran/api/api_dem_run.f90": "dem",
    "fortran/api/api_limit.f90": "limit",
    "fortran/api/api_mechanism.f90": "mechanism",
    "fortran/api/api_rocking.f90": "rocking",
    "fortran/api/api_stack.f90": "stack",
    "fortran/api/api_soft_base.f90": "soft_base",
    "fortran/mechanism/blow.f90": "mechanism",
    "fortran/mechanism/impact.f90": "mechanism",
    "fortran/mechanism/linkage.f90": "mechanism",
    "fortran/mechanism/table.f90": "mechanism",
    "fortran/dem/contacts.f90": "dem",
    "fortran/dem/joint.f90": "dem",
    "fortran/dem/law.f90": "dem",
    "fortran/dem/moreau.f90": "dem",
    "fortran/dem/rigid.f90": "dem",
    "fortran/dem/loading.f90": "dem",
    "fortran/dem3/patch.f90": "dem3",
    "fortran/dem3/law.f90": "dem3",
    "fortran/dem3/moreau.f90": "dem3",
    "fortran/nonsmooth/impulses.f90": "dem",
    "fortran/limit/vertex.f90": "limit",
}
PACKAGE = "python/extrados"
#: Faults that change no result, by `Fault.change`, and why
EQUIVALENT: dict[str, str] = {
    f"{row['file']}: {row['old']}  ->  {row['new']}": row["reason"]
    for row in tomllib.loads((Path(__file__).parent / "equivalent_faults.toml").read_text(encoding="utf-8"))["fault"]
}


@dataclass(frozen=True)
class Fault:
    """One change of one line."""

    kind: str
    file: str
    line: int
    old: str
    new: str

    @property
    def room(self) -> str:
        """The package of the file."""
        return "/".join(self.file.split("/")[:2])

    @property
    def in_python(self) -> bool:
        """Whether it needs no build."""
        return self.file.endswith(".py")

    @property
    def change(self) -> str:
        """The change itself, without its place in the file."""
        return f"{self.file}: {self.old.strip()}  ->  {self.new.strip()}"

    def __str__(self) -> str:
        return f"{self.file}:{self.line}: {self.kind}: {self.old.strip()}  ->  {self.new.strip()}"


def is_code(line: str, in_c: bool) -> bool:
    """A statement, no comment, declaration or directive."""
    text = line.strip()
    if in_c:
        return bool(text) and not text.startswith(("/*", "*", "//", "#")) and text.endswith((";", "{"))
    return bool(text) and not text.startswith("!") and "::" not in text and not text.startswith(("allocate", "call "))


def faults_of(path: Path) -> list[Fault]:
    """Every fault that could be planted in a file."""
    in_c = path.suffix == ".c"
    name = path.relative_to(apart.ROOT).as_posix()
    found = []
    for number, line in enumerate(path.read_text(encoding="utf-8").split("\n"), start=1):
        if not is_code(line, in_c):
            continue
        code = line.split("/*" if in_c else "!")[0].rstrip()
        for kind, changes in FAULTS.items():
            for pattern, new in changes:
                for place in re.finditer(pattern, code):
                    if new is None:
                        put = f"{1.1 * float(place[0]):.6g}"
                    else:
                        put = place.expand(new)
                        put = IN_C.get(place[0], put) if in_c else put
                    changed = code[: place.start()] + put + code[place.end() :] + line[len(code) :]
                    found.append(Fault(kind, name, number, line, changed))
    return found


def python_faults_of(path: Path) -> list[Fault]:
    """Every fault that could be planted in a file of Python: in functions, outside of texts, comments and warnings."""
    text, name = path.read_text(encoding="utf-8"), path.relative_to(apart.ROOT).as_posix()
    lines = text.split("\n")
    bare, outcomes = list(lines), []
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        (first, start), (last, end) = token.start, token.end
        if token.type == tokenize.STRING and token.string in OUTCOMES and first == last:
            outcomes.append((first, start, end, OUTCOMES[token.string]))
        if token.type in (tokenize.STRING, tokenize.COMMENT):
            for number in range(first, last + 1):
                line = bare[number - 1]
                left, right = start if number == first else 0, end if number == last else len(line)
                bare[number - 1] = line[:left] + "\0" * (right - left) + line[right:]
    inside = {
        number
        for node in ast.walk(ast.parse(text))
        if isinstance(node, ast.FunctionDef)
        for number in range(node.body[0].lineno, (node.end_lineno or 0) + 1)
    }
    found = []
    for number in sorted(inside):
        line, code = lines[number - 1], bare[number - 1]
        if re.match(r"\s*(raise|assert|def|@|import|from)\b", code) or "warn" in code or "Array(" in code:
            continue
        for kind, changes in IN_PYTHON.items():
            for pattern, new in changes:
                for place in re.finditer(pattern, code):
                    changed = line[: place.start()] + new + line[place.end() :]
                    if kind != "filter" or " for " in code[: place.start()] or "&" in place[0]:
                        found.append(Fault(kind, name, number, line, changed))
    for number, start, end, put in outcomes:
        line = lines[number - 1]
        if number in inside and "fact(" not in line:
            found.append(Fault("outcome", name, number, line, line[:start] + put + line[end:]))
    return [fault for fault in found if _is_python([*lines[: fault.line - 1], fault.new, *lines[fault.line :]])]


def _is_python(lines: list[str]) -> bool:
    try:
        ast.parse("\n".join(lines))
    except SyntaxError:
        return False
    return True


def hands_on(fault: Fault) -> bool:
    """Whether a fault changes more than rounding, a measure of progress or a constant of a kernel."""
    at = next(k for k, (old, new) in enumerate(zip(fault.old + "\0", fault.new + "\0", strict=False)) if old != new)
    rounds = fault.kind == "sign" and ROUNDING.match(fault.old, at)
    return not rounds and "progress(" not in fault.old and (fault.in_python or fault.kind in OF_KERNELS)


def draw(count: int, seed: int, rooms: Iterable[str], python: bool = False, joins: bool = False) -> list[Fault]:
    """Faults of packages, of all kinds: each package in proportion to the root of its size, its kinds in turn; joins: at the joins alone."""
    by_room: dict[str, list[Fault]] = {}
    if python:
        for join in JOINS:
            room = "/".join(join.split("/")[:-1])
            by_room.setdefault(room, []).extend(filter(hands_on, python_faults_of(apart.ROOT / PACKAGE / join)))
    else:
        for room in rooms:
            files = sorted([*(apart.ROOT / room).glob("*.f90"), *(apart.ROOT / room).glob("*.c")])
            by_room[room] = [fault for path in files for fault in faults_of(path)]
    if joins and not python:
        by_room = {}
        for file in KERNELS:
            by_room.setdefault("/".join(file.split("/")[:2]), []).extend(filter(hands_on, faults_of(apart.ROOT / file)))
    weight = {room: len(there) ** 0.5 for room, there in by_room.items()}
    chosen = []
    for room, there in by_room.items():
        rng = random.Random(f"{seed} {room}")  # of its own: a change in one package draws nothing else in the others
        share = max(1 if joins else 2, round(count * weight[room] / sum(weight.values())))
        kinds = {kind: [f for f in there if f.kind == kind] for kind in sorted({f.kind for f in there})}
        for options in kinds.values():
            rng.shuffle(options)
        if joins:  # few of a package: its kinds in no order
            kinds = dict(rng.sample(sorted(kinds.items(), key=lambda item: item[0]), len(kinds)))
        while share and any(kinds.values()):
            for options in kinds.values():
                if share and options:
                    chosen.append(options.pop())
                    share -= 1
    return chosen


def plant(place: Path, fault: Fault, back: bool = False) -> None:
    """Change the line of the copy, or take the change back."""
    path = place / fault.file
    lines = path.read_text(encoding="utf-8").split("\n")
    lines[fault.line - 1] = fault.old if back else fault.new
    path.write_text("\n".join(lines), encoding="utf-8")
