"""Arch bridges: spans of one or more rings on piers and abutments, with backing, fill and surfacing."""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, ClassVar, Literal

import numpy as np
from pydantic import model_validator

from extrados.model.errors import BadGeometry
from extrados.model.geometry.assembly import GROUND, Assembly
from extrados.model.geometry.builder import Builder
from extrados.model.structure import Crossed, Structure
from extrados.model.structures.earthwork import Fill, Spandrels, Surfacing, covered, refuse_without_fill
from extrados.schema.quantities import Density, Length
from extrados.schema.table import Table, key

FINE = 20001  # points by which curves that are no arcs are measured
#: Height to which the springings of a surveyed intrados must agree [m]
LEVEL = 0.005
#: Angle of the side arcs of a three-centred arch, Huygens' basket handle [rad]
SIDE_ARC = np.pi / 3.0


class Span(Table):
    """One arch of a bridge, by its intrados."""

    shape: Literal["segmental", "three-centred", "pointed", "elliptical", "parabolic", "surveyed"] = key(
        "segmental",
        "shape of the intrados; a segmental arch with a rise of half the span is a semicircle; for a surveyed shape, give `intrados`",
    )
    intrados: list[list[Length]] | None = key(
        None,
        'for shape = "surveyed": measured points [x, y] of the intrados from springing to springing '
        "(both at y = 0); the points give span and rise",
        min_length=4,
        max_length=2000,
    )
    span: Length = key(about="clear span", gt=0)
    rise: Length = key(about="rise of the intrados", gt=0)
    thickness: Length = key(about="thickness of the arch at the crown, including all rings", gt=0)
    springing_thickness: Length | None = key(
        None, "thickness of the arch at the springings, with linear variation along the intrados; default: as at the crown", gt=0
    )
    haunch_radius: Length | None = key(
        None, "radius of the side arcs of a three-centred arch; default: the radius for which each side arc subtends 60 degrees", gt=0
    )
    rings: int = key(1, "number of rings of equal thickness; rings can slide on each other and separate", ge=1, le=10)
    voussoirs: int = key(40, "number of voussoirs of each ring; even for a pointed arch", ge=4, le=2000)

    @model_validator(mode="before")
    @classmethod
    def _measured(cls, given: Any) -> Any:
        """Span and rise of a surveyed intrados, which its points give."""
        if not isinstance(given, dict) or given.get("shape") != "surveyed" or not isinstance(given.get("intrados"), list):
            return given
        if twice := [name for name in ("span", "rise") if name in given]:
            raise ValueError(f"{twice[0]}: the points of `intrados` determine this value: remove this key")
        points = [point for point in given["intrados"] if isinstance(point, list) and len(point) == 2]
        if len(points) < len(given["intrados"]) or not all(isinstance(v, int | float) for point in points for v in point):
            raise ValueError("intrados: expected points [x, y] in metres")
        if not points:
            return given
        x, y = [float(point[0]) for point in points], [float(point[1]) for point in points]
        return {**given, "span": x[-1] - x[0], "rise": max(y)}

    @model_validator(mode="after")
    def _surveyed(self) -> "Span":
        if (self.shape == "surveyed") != (self.intrados is not None):
            raise ValueError('the key `intrados` is only for shape = "surveyed", which requires this key')
        for before, after in itertools.pairwise(self.intrados or []):
            if after[0] <= before[0]:
                raise ValueError(f"intrados: x must increase from point to point, found {before[0]:g} before {after[0]:g}")
        if self.intrados and (abs(self.intrados[0][1]) > LEVEL or abs(self.intrados[-1][1]) > LEVEL):
            raise ValueError("intrados: both springings must be at y = 0, because all springings of a bridge are at one level")
        return self

    @model_validator(mode="after")
    def _shaped(self) -> "Span":
        half = 0.5 * self.span
        if self.shape in ("segmental", "three-centred") and self.rise > half * (1.0 + 1e-12):
            raise ValueError(f"rise: the rise of a {self.shape} arch is at most half of the span, {half:g} m")
        if self.shape == "pointed" and self.rise < half:
            raise ValueError(f"rise: the rise of a pointed arch is at least half of the span, {half:g} m")
        if self.shape == "pointed" and self.voussoirs % 2:
            raise ValueError("voussoirs: a pointed arch requires an even number")
        if self.haunch_radius is not None and self.shape != "three-centred":
            raise ValueError("`haunch_radius` is only for a three-centred arch: remove `haunch_radius`")
        return self


class Pier(Table):
    """A pier between two spans, from the springings down to the ground."""

    width: Length = key(about="width at the springings", gt=0)
    height: Length = key(about="height of the springings of the pier above its base", gt=0)
    base_width: Length | None = key(None, "width at the base; default: as at the springings", gt=0)
    courses: int = key(1, "number of blocks of the pier; they are divided by level joints", ge=1, le=200)


class Abutment(Table):
    """An abutment that is a body of its own on the ground."""

    width: Length = key(about="width of the abutment, from the springing of the intrados to its back face", gt=0)
    height: Length = key(about="height of the springing of the abutment above its base", gt=0)


class Backing(Table):
    """Masonry over the haunches, one body over each pier and at each end."""

    height: Length = key(about="height of the horizontal top of the backing above the springings", gt=0)
    density: Density | None = key(None, "density; default: density of [material]", gt=0, le=30000)


def intrados(span: Span) -> tuple[np.ndarray, np.ndarray]:
    """Places of the joints on the intrados and its outward normals there (voussoirs + 1, 2) [m], from left to right.

    The joints divide it into equal lengths and are normal to it, the crown joint of a pointed arch is vertical.
    Middle of the span at x = 0, springings at y = 0.
    """
    a, b, n = 0.5 * span.span, span.rise, span.voussoirs
    share = np.linspace(0.0, 1.0, n + 1)
    if span.intrados is not None:
        return _surveyed(np.array(span.intrados, dtype=float), share)
    if span.shape == "segmental":
        radius = (a * a + b * b) / (2.0 * b)
        turn = np.arctan2(a, radius - b) * (2.0 * share - 1.0)
        normal = np.column_stack([np.sin(turn), np.cos(turn)])
        return radius * normal + (0.0, b - radius), normal
    if span.shape == "three-centred":
        return _three_centred(a, b, span.haunch_radius, share)
    if span.shape == "pointed":
        radius = (a * a + b * b) / (2.0 * a)
        low, high = -0.5 * np.pi, -np.arcsin((radius - a) / radius)
        turn = low + (high - low) * 2.0 * share[: n // 2 + 1]
        normal = np.column_stack([np.sin(turn), np.cos(turn)])
        left = radius * normal + (radius - a, 0.0)
        normal[-1] = 0.0, radius / b  # as long as the vertical joint is
        mirror = np.array([-1.0, 1.0])
        return np.concatenate([left, (left * mirror)[-2::-1]]), np.concatenate([normal, (normal * mirror)[-2::-1]])
    fine = np.linspace(np.pi, 0.0, FINE)
    if span.shape == "elliptical":
        curve = np.column_stack([a * np.cos(fine), b * np.sin(fine)])
    else:
        x = a * np.linspace(-1.0, 1.0, FINE)
        curve = np.column_stack([x, b * (1.0 - (x / a) ** 2)])
    run = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(curve, axis=0).T))])
    if span.shape == "elliptical":
        angle = np.interp(run[-1] * share, run, fine)
        angle[0], angle[-1] = np.pi, 0.0
        point = np.column_stack([a * np.cos(angle), b * np.sin(angle)])
        normal = np.column_stack([b * np.cos(angle), a * np.sin(angle)])
    else:
        x = np.interp(run[-1] * share, run, curve[:, 0])
        point = np.column_stack([x, b * (1.0 - (x / a) ** 2)])
        normal = np.column_stack([2.0 * b * x / a**2, np.ones(n + 1)])
    return point, normal / np.hypot(*normal.T)[:, None]


def _surveyed(points: np.ndarray, share: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A cubic spline through measured points, by the length along them; the joints are normal to it."""
    from scipy.interpolate import CubicSpline

    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
    curve = CubicSpline(along, points - (0.5 * (points[0, 0] + points[-1, 0]), 0.0))
    fine = np.linspace(0.0, along[-1], FINE)
    run = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(curve(fine), axis=0).T))])
    at = np.interp(run[-1] * share, run, fine)
    tangent = curve(at, 1)
    normal = np.column_stack([-tangent[:, 1], tangent[:, 0]])
    return curve(at), normal / np.hypot(*normal.T)[:, None]


def _three_centred(a: float, b: float, side: float | None, share: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Three arcs that meet with common tangents: side arcs of radius `side` whose centres lie on the springing line."""
    if side is None:
        c, s = np.cos(SIDE_ARC), np.sin(SIDE_ARC)
        # R - r = (a - r) / c and R - b = (a - r) s / c
        side = (b - a * (1.0 - s) / c) / (1.0 - (1.0 - s) / c)
    if not 0.0 < side <= b:
        raise BadGeometry(
            f"three-centred arch: side arcs with a radius of {side:.4g} m are not possible for a rise of {b:g} m and a half span of {a:g} m"
        )
    if abs(side - a) < 1e-12 * a:  # the semicircle
        turn = 0.5 * np.pi * (2.0 * share - 1.0)
        normal = np.column_stack([np.sin(turn), np.cos(turn)])
        return a * normal, normal
    if b - side < 1e-9 * b:
        raise BadGeometry("three-centred arch: `haunch_radius` must be less than the rise")
    radius = ((a - side) ** 2 + b * b - side * side) / (2.0 * (b - side))
    angle = float(np.arctan2(radius - b, a - side))  # that the side arcs subtend
    length = side * angle
    total = 2.0 * length + radius * (np.pi - 2.0 * angle)
    s = total * share
    left, right = s <= length, s >= total - length
    turn = np.where(left, -0.5 * np.pi + s / side, np.where(right, 0.5 * np.pi - (total - s) / side, (s - 0.5 * total) / radius))
    normal = np.column_stack([np.sin(turn), np.cos(turn)])
    centre = np.where(left[:, None], (side - a, 0.0), np.where(right[:, None], (a - side, 0.0), (0.0, b - radius)))
    return centre + np.where(left | right, side, radius)[:, None] * normal, normal


@dataclass(frozen=True)
class _Arch:
    """Joint lines (voussoirs + 1, rings + 1, 2) [m] of a span from the intrados outward, and its voussoirs by ring."""

    line: np.ndarray
    block: np.ndarray

    @property
    def extrados(self) -> np.ndarray:
        return self.line[:, -1]


def _joint_lines(span: Span, at: float) -> np.ndarray:
    point, normal = intrados(span)
    ends = span.thickness if span.springing_thickness is None else span.springing_thickness
    thickness = span.thickness + (ends - span.thickness) * np.abs(np.linspace(-1.0, 1.0, span.voussoirs + 1))
    depth = thickness[:, None] * np.linspace(0.0, 1.0, span.rings + 1)
    return point[:, None] + (at, 0.0) + depth[..., None] * normal[:, None]


class _Bridge:
    """Puts the stones together; the left springing of the first span is the origin."""

    def __init__(self, bridge: "Bridge", density: float):
        self.bridge = bridge
        self.builder = Builder(density, bridge.depth)
        self.chains: dict[str, list[int]] = {}
        self.groups: dict[str, list[int]] = {"rings": [], "backing": []}
        piers = bridge.between
        left = np.cumsum([0.0, *(s.span + p.width for s, p in zip(bridge.spans, piers, strict=False))])
        lines = [_joint_lines(s, x + 0.5 * s.span) for s, x in zip(bridge.spans, left, strict=True)]
        ends = [GROUND] * (len(bridge.spans) + 1)
        if bridge.abutments is not None:
            ends[0] = self._abutment("left abutment", lines[0][0], -1, bridge.abutments)
            ends[-1] = self._abutment("right abutment", lines[-1][-1], 1, bridge.abutments)
        for k, pier in enumerate(piers):
            ends[k + 1] = self._pier(f"pier {k + 1}" if len(piers) > 1 else "pier", pier, lines[k][-1], lines[k + 1][0])
        self.arches = [self._arch(f"span {k + 1} " if len(lines) > 1 else "", line, ends[k], ends[k + 1]) for k, line in enumerate(lines)]
        self.backing: list[int] = []
        if bridge.backing is not None:
            for k, support in enumerate(ends):
                left_arch = self.arches[k - 1] if k else None
                right_arch = self.arches[k] if k < len(self.arches) else None
                self._backing(f"backing {k + 1}", bridge.backing.height, support, left_arch, right_arch)

    def _arch(self, prefix: str, line: np.ndarray, left: int, right: int) -> _Arch:
        n, rings = len(line) - 1, line.shape[1] - 1
        block = np.empty((rings, n), dtype=int)
        for r in range(rings):
            name = prefix + (f"ring {r + 1} " if rings > 1 else "")
            for i in range(n):
                corners = line[[i, i + 1, i + 1, i], [r, r, r + 1, r + 1]]
                block[r, i] = self.builder.block(f"{name}voussoir {i + 1}", corners)
            ends = [left, *block[r].tolist(), right]
            joints = [self.builder.joint(f"{name}joint {j}", line[j, r], line[j, r + 1], ends[j + 1], ends[j], -1) for j in range(n + 1)]
            self.chains[name.strip() or "arch"] = joints
            if r:
                self.groups["rings"] += [
                    self.builder.joint(
                        f"{prefix}rings {r}-{r + 1} at voussoir {i + 1}",
                        line[i, r],
                        line[i + 1, r],
                        int(block[r, i]),
                        int(block[r - 1, i]),
                        1,
                    )
                    for i in range(n)
                ]
        return _Arch(line, block)

    def _abutment(self, name: str, skewback: np.ndarray, side: int, table: Abutment) -> int:
        """The body behind a springing; side -1 at the left end of the bridge, +1 at its right end."""
        foot, head = skewback[0], skewback[-1]
        back = foot[0] + side * table.width
        if side * (back - head[0]) <= 0.0:
            raise BadGeometry(
                f"{name}: with a width of {table.width:g} m, the abutment ends before the extrados of the springing, which is "
                f"{side * (head[0] - foot[0]):.4g} m behind the intrados"
            )
        outline = np.array([[back, -table.height], [foot[0], -table.height], foot, head, [back, head[1]]])
        block = self.builder.block(name, outline)
        self.builder.joint(f"{name} base", outline[0], outline[1], block, GROUND, -side)
        return block

    def _pier(self, name: str, pier: Pier, left: np.ndarray, right: np.ndarray) -> int:
        """Shaft and skewbacks between the last joint line of one span and the first of the next."""
        if left[-1, 0] > right[-1, 0] + 1e-9:
            need = pier.width + left[-1, 0] - right[-1, 0]
            raise BadGeometry(
                f"{name}: the arches on both sides overlap in this pier: give a width of at least {need:.4g} m at the springings"
            )
        base = pier.width if pier.base_width is None else pier.base_width
        middle = 0.5 * (left[0, 0] + right[0, 0])
        levels = np.linspace(-pier.height, 0.0, pier.courses + 1)
        half = 0.5 * np.linspace(base, pier.width, pier.courses + 1)
        below, joints = GROUND, []
        for c in range(pier.courses):
            (y0, y1), (h0, h1) = levels[c : c + 2], half[c : c + 2]
            foot = np.array([[middle - h0, y0], [middle + h0, y0]])
            top = [[middle + h1, y1], [middle - h1, y1]]
            if c == pier.courses - 1:
                heads = [right[-1], left[-1]] if right[-1, 0] - left[-1, 0] > 1e-9 else [right[-1]]
                top = [right[0], *heads, left[0]]
            block = self.builder.block(name if pier.courses == 1 else f"{name} course {c + 1}", np.array([*foot, *top]))
            label = f"{name} base" if c == 0 else f"{name} bed {c}"
            joints.append(self.builder.joint(label, foot[0], foot[1], block, below, 1))
            below = block
        if pier.courses > 1:
            self.chains[name] = joints[::-1]
        return below

    def _backing(self, name: str, level: float, support: int, left: _Arch | None, right: _Arch | None) -> None:
        """The body over one springing up to a level: over a pier, or at an end of the bridge where an arch is None."""
        outline: list[np.ndarray] = []
        joints: list[tuple[str, np.ndarray, np.ndarray, int, int]] = []
        for arch, from_crown in ((left, True), (right, False)):
            if arch is None:
                continue
            line = arch.extrados
            top = float(line[:, 1].max())
            heel = line[-1 if from_crown else 0]
            if not heel[1] + 1e-6 < level <= top:
                raise BadGeometry(
                    f"backing: the top at {level:g} m must lie between the extrados at the springing ({heel[1]:.4g} m) and at the "
                    f"crown ({top:.4g} m)"
                )
            points, voussoirs = _haunch(line, level, from_crown)
            outline += list(points)
            joints += [
                (f"{name} on {self._name(arch, v)}", points[i], points[i + 1], int(arch.block[-1, v]), 1) for i, v in enumerate(voussoirs)
            ]
        foot = None
        if left is not None and right is not None:
            if right.extrados[0, 0] - left.extrados[-1, 0] > 1e-9:
                foot = (left.extrados[-1], right.extrados[0])
            else:
                outline.pop(len(_haunch(left.extrados, level, True)[0]))
        else:
            side = 1 if right is None else -1
            heel = left.extrados[-1] if left is not None else right.extrados[0]  # type: ignore[union-attr]
            if support == GROUND:
                back = np.array([heel[0], level])
                outline = [*outline, back] if side > 0 else [back, *outline]
                low, high = heel, back
                joints.append((f"{name} behind", low, high, GROUND, side))
            else:
                x = self._back_of(support, side)
                corners = [np.array([x, heel[1]]), np.array([x, level])]
                outline = [*outline, *corners] if side > 0 else [*corners[::-1], *outline]
                foot = (heel, corners[0]) if side > 0 else (corners[0], heel)
        block = self.builder.block(name, np.array(outline))
        self.backing.append(block)
        if foot is not None:
            joints.append((f"{name} base", foot[0], foot[1], support, 1))
        for label, p, q, other, inward in joints:
            self.groups["backing"].append(self.builder.joint(label, p, q, block, other, inward))

    def _name(self, arch: _Arch, voussoir: int) -> str:
        return self.builder.name_of(int(arch.block[-1, voussoir]))

    def _back_of(self, block: int, side: int) -> float:
        return float(side * (side * self.builder.outline_of(block)[:, 0]).max())


def _haunch(line: np.ndarray, level: float, from_crown: bool) -> tuple[np.ndarray, list[int]]:
    """The extrados below a level on one side, from left to right, and the voussoirs along it."""
    n = len(line) - 1
    ordered = line[::-1] if from_crown else line
    over = int(np.argmax(ordered[:, 1] > level)) if (ordered[:, 1] > level).any() else n // 2
    low, high = ordered[over - 1], ordered[over]
    share = (level - low[1]) / (high[1] - low[1]) if high[1] > low[1] else 0.0
    points = [*ordered[:over]]
    count = over - 1
    if share > 1e-6:
        points.append(low + share * (high - low))
        count = over
    voussoirs = list(range(count))
    if from_crown:
        return np.array(points[::-1]), [n - 1 - v for v in reversed(voussoirs)]
    return np.array(points), voussoirs


def make_bridge(bridge: "Bridge", density: float = 2000.0) -> Assembly:
    """The stones of a bridge and the earth over them; BadGeometry names the part that does not fit."""
    made = _Bridge(bridge, density)
    first = bridge.spans[0]
    assembly = made.builder.assembly(
        chains=made.chains,
        groups={name: joints for name, joints in made.groups.items() if joints},
        measures={"clear_span_m": first.span, "rise_m": first.rise},
    )
    if bridge.backing is not None and bridge.backing.density is not None:
        ratio = np.ones(len(assembly.mass))
        ratio[made.backing] = bridge.backing.density / density
        assembly = replace(assembly, mass=assembly.mass * ratio, inertia=assembly.inertia * ratio)
    crown = max(float(arch.extrados[:, 1].max()) for arch in made.arches)
    return covered(assembly, crown, density, bridge.fill, bridge.surfacing, bridge.spandrels)


class Bridge(Structure):
    """Masonry arch bridge, along its length: spans, piers, abutments, backing, fill and surfacing; without skew.

    All springings are at one level, y = 0; the intrados of the first span starts at x = 0.
    """

    word: ClassVar = "bridge"
    starter: ClassVar = {
        "depth": "5.0",
        "spans": '[{ shape = "segmental", span = 8.0, rise = 2.0, thickness = 0.5 }]',
        "fill": "{ cover = 0.3, density = 2000, friction_angle = 30, passive = 0.0 }",
    }
    kind: Literal["bridge"]
    crossed: ClassVar[Crossed] = "top"
    starter_analysis: ClassVar = "moving-load"
    spans: list[Span] = key(about="arches from left to right", min_length=1, max_length=50)
    piers: list[Pier] = key([], "piers between the spans, from left to right; a single pier is used for all", max_length=49)
    abutments: Abutment | None = key(None, "abutments, modelled as bodies on the ground; default: fixed springings")
    backing: Backing | None = key(None, "masonry over the haunches")
    fill: Fill | None = key(None, "soil over the arches")
    surfacing: Surfacing | None = key(None, "road surface or ballast on the fill")
    spandrels: Spandrels | None = key(None, "spandrel walls at the edges of the arches; only their weight is considered")
    depth: Length = key(1.0, "width of the bridge that acts as one body, for instance the width between the spandrel walls", gt=0)

    @model_validator(mode="after")
    def _piers(self) -> "Bridge":
        need = len(self.spans) - 1
        if len(self.piers) != need and not (need > 1 and len(self.piers) == 1):
            wanted = "1 pier" if need == 1 else f"{need} piers, or one pier for all"
            spans = "1 span needs no piers" if need == 0 else f"{need + 1} spans require {wanted}"
            raise ValueError(f"piers: {spans}; found {'1' if len(self.piers) == 1 else f'{len(self.piers)}'}")
        refuse_without_fill(self.fill, self.surfacing, self.spandrels, self.depth)
        return self

    @property
    def between(self) -> Sequence[Pier]:
        """The pier after each span but the last."""
        need = len(self.spans) - 1
        return self.piers if len(self.piers) == need else self.piers * need

    def assembly(self, density: float, folder: Path) -> Assembly:
        return make_bridge(self, density)
