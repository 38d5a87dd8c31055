"""Drawings and meshes by the grammar of their formats: most of a file is as its format has it, some words are not.

`try_many` is run by the process that reads foreign files, so that what a library does to its process ends there.
"""

import random
import signal
import struct
import time
from collections.abc import Callable
from itertools import product
from typing import Any

from extrados.model.geometry.dxf import parse_dxf
from extrados.model.geometry.solids.meshes import parse_meshes
from extrados.schema.contained import Unreadable

SECONDS = 20  # of the processor: longer than any of these small files takes
NUMBERS = ("0", "1", "-1", "0.5", "2.0", "1e-9", "1e9")
HOSTILE = (
    "nan",
    "inf",
    "-inf",
    "1e308",
    "-1e308",
    "5e-324",
    "1e400",
    "9" * 400,
    "",
    "x",
    "1,5",
    "0x10",
    "1_0",
    "--1",
    "2147483648",
    "-9223372036854775809",
    "\0",
    "\x1b[31m",
    "é",
    "１",
    "1 2",
)


class Words:
    """Values of a random file: numbers of a small drawing, one in `rare` is hostile."""

    def __init__(self, rng: random.Random, rare: int):
        self.rng, self.rare = rng, rare

    def odd(self) -> bool:
        """Whether something unusual is wanted here."""
        return self.rng.randrange(self.rare) == 0

    def number(self) -> str:
        if self.odd():
            return self.rng.choice(HOSTILE)
        return self.rng.choice(NUMBERS) if self.rng.random() < 0.3 else f"{self.rng.uniform(-3.0, 3.0):.{self.rng.randint(0, 6)}f}"

    def whole(self, low: int, high: int) -> str:
        if self.odd():
            return self.rng.choice((*HOSTILE, "-1", "0", "65536", "1000000"))
        return str(self.rng.randint(low, high))

    def name(self) -> str:
        if self.odd():
            return self.rng.choice(("", " ", "*", "A" * 3000, "\u202e", "../x", "*Model_Space", "*U1", "a|b", "%%c", "\\U+0041"))
        return self.rng.choice(("0", "A", "B", "GROUND", "C"))


Groups = list[tuple[int, str]]


def dxf(rng: random.Random) -> bytes:
    """A DXF of text: header, layers, blocks that refer to blocks, entities of all sorts that are read or left out."""
    w = Words(rng, rng.choice((10, 40, 200, 10**9)))
    header = [
        (9, "$ACADVER"),
        (1, rng.choice(("AC1009", "AC1015", "AC1024", "AC1032", "AC9999", "x") if w.odd() else ("AC1009", "AC1015", "AC1032"))),
        (9, "$INSUNITS"),
        (70, w.whole(4, 6)),
        (9, "$DWGCODEPAGE"),
        (3, rng.choice(("ANSI_1252", "ANSI_936", "utf-8", "nothing", "")) if w.odd() else "ANSI_1252"),
    ]
    tables = [(0, "TABLE"), (2, "LAYER"), (70, w.whole(0, 3))]
    for _ in range(rng.randint(0, 3)):
        tables += [(0, "LAYER"), (2, w.name()), (70, w.whole(0, 5)), (62, w.whole(-7, 7)), (6, "CONTINUOUS")]
    tables += [(0, "ENDTAB")]
    blocks: Groups = []
    for _ in range(rng.randint(0, 3)):
        blocks += [(0, "BLOCK"), (8, w.name()), (2, w.name()), (70, w.whole(0, 4)), (10, w.number()), (20, w.number()), (30, "0")]
        blocks += [group for _ in range(rng.randint(0, 3)) for group in _entity(w)] + [(0, "ENDBLK"), (8, "0")]
    entities = [group for _ in range(rng.randint(1, 8)) for group in _entity(w)]
    sections = [("HEADER", header), ("TABLES", tables), ("BLOCKS", blocks), ("ENTITIES", entities)]
    if w.odd():
        rng.shuffle(sections)
    if w.odd():
        sections.pop(rng.randrange(4))
    if w.odd():
        sections.append(rng.choice((("OBJECTS", []), ("CLASSES", [(0, "CLASS")]), ("x", []), sections[0])))
    groups = [g for title, body in sections for g in ((0, "SECTION"), (2, title), *body, (0, "ENDSEC"))] + [(0, "EOF")]
    while w.odd() and groups:
        k = rng.randrange(len(groups))
        match rng.randrange(5):
            case 0:
                del groups[k]
            case 1:
                groups.insert(k, groups[rng.randrange(len(groups))])
            case 2:
                groups[k] = (rng.choice((0, 1, 5, 10, 62, 70, 100, 102, 330, 420, 999, 1000, 1071, -1, 5000)), groups[k][1])
            case 3:
                groups[k] = (groups[k][0], rng.choice(HOSTILE))
            case _:
                del groups[k:]
    end = rng.choice(("\n", "\r\n", "\r")) if w.odd() else "\n"
    return "".join(f"{code:>3}{end}{value}{end}" for code, value in groups).encode("utf-8", "surrogateescape")


def _entity(w: Words) -> Groups:
    """One entity of the modelspace or of a block."""
    rng = w.rng
    head = [(8, w.name())] + ([(60, w.whole(0, 1))] if w.odd() else []) + ([(5, w.whole(1, 9))] if w.odd() else [])

    def place(*codes: int) -> Groups:
        return [(code, w.number()) for code in codes]

    match rng.choice(("LINE", "LINE", "ARC", "CIRCLE", "LW", "LW", "LW", "POLY", "SPLINE", "ELLIPSE", "INSERT", "OTHER")):
        case "LINE":
            return [(0, "LINE"), *head, *place(10, 20, 30, 11, 21, 31)]
        case "ARC":
            return [(0, "ARC"), *head, *place(10, 20, 30, 40, 50, 51), *(place(210, 220, 230) if w.odd() else [])]
        case "CIRCLE":
            return [(0, "CIRCLE"), *head, *place(10, 20, 30, 40)]
        case "LW":
            n = rng.randint(2, 7)
            corners = [g for _ in range(n) for g in (*place(10, 20), *([(42, w.number())] if rng.random() < 0.3 else []))]
            return [(0, "LWPOLYLINE"), *head, (90, w.whole(n, n)), (70, w.whole(0, 1)), *corners]
        case "POLY":
            corners = [
                g for _ in range(rng.randint(0, 5)) for g in ((0, "VERTEX"), (8, w.name()), *place(10, 20, 30), (70, w.whole(0, 128)))
            ]
            return [(0, "POLYLINE"), *head, (66, "1"), (70, w.whole(0, 64)), *corners, *([] if w.odd() else [(0, "SEQEND"), (8, "0")])]
        case "SPLINE":
            degree, n = rng.randint(1, 4), rng.randint(2, 7)
            knots = [(40, w.number() if w.odd() else str(k)) for k in range(n + degree + 1)]
            return [
                (0, "SPLINE"),
                *head,
                (70, w.whole(0, 15)),
                (71, w.whole(degree, degree)),
                (72, w.whole(len(knots), len(knots))),
                (73, w.whole(n, n)),
                *knots,
                *([(41, w.number()) for _ in range(n)] if rng.random() < 0.3 else []),
                *(g for _ in range(n) for g in place(10, 20, 30)),
            ]
        case "ELLIPSE":
            return [(0, "ELLIPSE"), *head, *place(10, 20, 30, 11, 21, 31, 40, 41, 42)]
        case "INSERT":
            grid = [(70, w.whole(1, 3)), (71, w.whole(1, 3)), *place(44, 45)] if rng.random() < 0.3 else []
            return [(0, "INSERT"), *head, (2, w.name()), *place(10, 20, 30), *(place(41, 42, 43, 50) if rng.random() < 0.5 else []), *grid]
    kind = rng.choice(("TEXT", "POINT", "HATCH", "DIMENSION", "3DFACE", "MESH", "REGION", "ACAD_PROXY_ENTITY", "", "x"))
    return [(0, kind), *head, *place(10, 20, 30), (1, w.name()), *([(91, w.whole(0, 3)), (72, w.whole(0, 3))] if w.odd() else [])]


#: Corners of a box and its faces, from the inside seen one way round
BOX = [(x, y, z) for x, y, z in product((0.0, 1.0), repeat=3)]
SIDES = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]


def obj(rng: random.Random) -> bytes:
    """A Wavefront OBJ: boxes in objects and groups, with normals, comments, numbers from the end."""
    w = Words(rng, rng.choice((10, 40, 200, 10**9)))
    lines, count = [], 0
    for _ in range(rng.randint(0, 4)):
        lines += [f"{rng.choice('og')} {w.name()}"] * rng.randint(0, 2)
        shift = [rng.uniform(-3.0, 3.0) for _ in range(3)]
        for corner in BOX:
            words = [w.number() if w.odd() else f"{a + b:.6g}" for a, b in zip(corner, shift, strict=True)]
            lines.append(" ".join(["v", *words, *(["1.0"] if w.odd() else [])]))
        count += 8
        for side in SIDES:
            ends = [str(count - 7 + k) if rng.random() < 0.8 else str(k - 8) for k in side]
            ends = [w.whole(1, count) if w.odd() else end + rng.choice(("", "", "/1", "//1", "/1/1")) for end in ends]
            lines.append(" ".join(["f", *ends[: rng.randint(0, 4) if w.odd() else 4]]))
        lines += [
            rng.choice(("# x", "", "vn 0 0 1", "vt 0 0", "usemtl a", "s off", "l 1 2", "curv 0 1 1 2", "call x.obj", "\\"))
        ] * rng.randint(0, 2)
    while w.odd() and lines:
        k = rng.randrange(len(lines))
        lines[k] = rng.choice(
            ("", lines[k][:3], lines[k] + " " + w.number(), lines[rng.randrange(len(lines))], "f " + "1 " * 3000, w.name())
        )
    return rng.choice(("\n", "\r\n")).join(lines).encode("utf-8", "surrogateescape") + (b"\xff\xfe" if w.odd() else b"")


def stl(rng: random.Random) -> bytes:
    """An STL of text with solids, or a binary one, whose number of triangles may be another."""
    w = Words(rng, rng.choice((10, 40, 200, 10**9)))
    triangles = []
    for _ in range(rng.randint(0, 3)):
        shift = [rng.uniform(-3.0, 3.0) for _ in range(3)]
        for a, b, c, d in SIDES:
            for corners in ((a, b, c), (a, c, d)):
                triangles.append([[x + y for x, y in zip(BOX[k], shift, strict=True)] for k in corners])
    if rng.random() < 0.5:
        number = rng.choice((0, len(triangles) + 1, 2**32 - 1, 10**7)) if w.odd() else len(triangles)
        body = b"".join(struct.pack("<12fH", 0.0, 0.0, 1.0, *(x for corner in t for x in corner), 0) for t in triangles)
        raw = bytearray(rng.choice((b"binary", b"solid x", b"\xff")).ljust(80, b" ") + struct.pack("<I", number) + body)
        while w.odd():
            k = rng.randrange(len(raw))
            raw[k : k + 4] = rng.choice((b"\0\0\xc0\x7f", b"\0\0\x80\x7f", b"\xff\xff\x7f\x7f", b"\1\0\0\0", b"\n\n\n\n"))
        return bytes(raw[: rng.randrange(len(raw))] if w.odd() else raw)
    lines = []
    for k, t in enumerate(triangles):
        if k % 12 == 0:
            lines += ["endsolid"] * (k > 0) + [f"solid {w.name()}"]
        lines += ["facet normal 0 0 1", "outer loop"]
        lines += ["vertex " + " ".join(w.number() if w.odd() else f"{x:.6g}" for x in corner) for corner in t]
        lines += ["endloop", "endfacet"]
    lines += ["endsolid"]
    while w.odd() and lines:
        k = rng.randrange(len(lines))
        lines[k] = rng.choice(("", "vertex", lines[k] + " 1", lines[k].upper(), "solid", "endsolid", "vertex 1 2", "facet", w.name()))
    return rng.choice(("\n", "\r\n", " ")).join(lines).encode("utf-8", "surrogateescape")


def _parse_dxf(content: bytes) -> Any:
    return parse_dxf(content, "a.dxf", {}, unit="m", layers=None, join_tolerance=1e-3, sagitta=2e-4)


SORTS: dict[str, tuple[Callable[[random.Random], bytes], Callable[[bytes], Any]]] = {
    ".dxf": (dxf, _parse_dxf),
    ".obj": (obj, lambda content: parse_meshes(content, "a.obj", ".obj")),
    ".stl": (stl, lambda content: parse_meshes(content, "a.stl", ".stl")),
}


def content_of(sort: str, seed: int, k: int) -> bytes:
    """File k of a sort."""
    return SORTS[sort][0](random.Random(f"{sort} {seed} {k}"))


class TooLong(BaseException):
    """A file takes longer than SECONDS."""


def try_many(_: bytes, sort: str, seed: int, first: int, end: int) -> dict[str, Any]:
    """How files first .. end - 1 of a sort ended: how many were read and refused, and what else happened to which."""

    def stop(*_: object) -> None:
        raise TooLong

    signal.signal(signal.SIGVTALRM, stop)
    read, refused, wrong = 0, 0, []
    for k in range(first, end):
        content = content_of(sort, seed, k)
        signal.setitimer(signal.ITIMER_VIRTUAL, SECONDS)
        begin = time.process_time()
        try:
            SORTS[sort][1](content)
            read += 1
        except Unreadable:
            refused += 1
        except (Exception, TooLong) as error:
            wrong.append(f"{sort} {k}: {type(error).__name__}: {error!s:.200} after {time.process_time() - begin:.1f} s")
        signal.setitimer(signal.ITIMER_VIRTUAL, 0)
    return {"read": read, "refused": refused, "wrong": wrong}
