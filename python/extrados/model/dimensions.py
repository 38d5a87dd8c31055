"""The dimensions by which an engineer knows a building: spans and rises of its arches, widths of what stands, its height."""

import itertools
from dataclasses import dataclass

import numpy as np

from extrados.model.geometry.assembly import GROUND, Assembly
from extrados.model.geometry.chains import arch_of, carried_on


@dataclass(frozen=True)
class Dimension:
    """A length [m] by its name, between two places [m]; aside: "below", "left" or "right" of them a drawing shows it,
    "along" on the line itself."""

    name: str
    start: tuple[float, float]
    end: tuple[float, float]
    aside: str

    @property
    def length(self) -> float:
        """Length [m]."""
        return float(np.hypot(self.end[0] - self.start[0], self.end[1] - self.start[1]))


def dimensions(assembly: Assembly) -> list[Dimension]:
    """Clear span, rise and thickness of every arch, widths of piers and buttresses, height; of a bridge also its height to the road."""
    vertices = np.concatenate(assembly.outlines)
    low, high = vertices.min(axis=0), vertices.max(axis=0)
    found: list[Dimension] = []
    spans: dict[str, tuple[Assembly, list[int]]] = {}
    for name, joints in assembly.chains.items():
        if arch_of(assembly, joints):
            turned, whole = carried_on(assembly, joints)
            spans[name] = turned, arch_of(turned, whole)
    for name, (turned, arch) in spans.items():
        found += _arch(turned, "" if len(spans) == 1 else f" of {with_article(name)}", arch)
    arches = bool(found)
    for block in assembly.buttresses:
        found += [
            _foot(assembly, j, f"width of the {assembly.block_names[block]}")
            for j in assembly.joints_of(block)
            if GROUND in (assembly.a[j], assembly.b[j])
        ]
    if not arches:
        base = vertices[np.isclose(vertices[:, 1], low[1], atol=1e-6 * (high[1] - low[1]))]
        left, right = float(base[:, 0].min()), float(base[:, 0].max())
        name = "width at the base" if right - left < 0.98 * (high[0] - low[0]) else "width"
        found.append(Dimension(name, (left, float(low[1])), (right, float(low[1])), "below"))
    springing = min((d.start[1] for d in found if d.aside == "along"), default=float(high[1]))
    (x, foot), top, earth = low.tolist(), float(high[1]), assembly.earth
    if foot < springing - 0.02 * (top - foot):
        found.append(Dimension("height" if earth is None else "height of the masonry", (x, foot), (x, top), "left"))
    if earth is not None:
        found.append(Dimension("total height", (x, foot), (x, max(top, earth.road)), "left"))
    return found


def with_article(name: str) -> str:
    """A name in a sentence: chain 3, the arch."""
    return name if name[-1].isdigit() else f"the {name}"


def _arch(assembly: Assembly, of: str, joints: list[int]) -> list[Dimension]:
    """Of the joints from springing to springing; the intrados is their end p."""
    intrados = assembly.p[joints]
    left, right = sorted((intrados[0], intrados[-1]), key=lambda point: float(point[0]))
    crown = int(np.argmax(intrados[:, 1]))
    x, top = _highest(assembly, joints)
    level = max(float(left[1]), float(right[1]))
    inner, outer = (tuple(float(v) for v in end[joints[crown]]) for end in (assembly.p, assembly.q))
    found = [Dimension(f"clear span{of}", (float(left[0]), level), (float(right[0]), level), "along")]
    if top - level > 1e-3 * abs(right[0] - left[0]):  # a straight prop has none
        found.append(Dimension(f"rise{of}", (x, level), (x, top), "along"))
    return [*found, Dimension(f"thickness at the crown{of}", inner, outer, "right")]  # type: ignore[arg-type]


def _highest(assembly: Assembly, joints: list[int]) -> tuple[float, float]:
    """The highest place of the intrados [m]: a joint, or a point of a voussoir between its joints."""
    ends = [set(assembly.ends[j]) for j in joints]
    points = [assembly.p[joints]]
    for k, (one, two) in enumerate(itertools.pairwise(ends)):
        p, along = assembly.p[joints[k]], assembly.p[joints[k + 1]] - assembly.p[joints[k]]
        for block in one & two - {GROUND}:
            off = assembly.outlines[block] - p
            share = off @ along / max(float(along @ along), 1e-300)
            aside = np.hypot(*(off - share[:, None] * along).T)
            near = (share > 0.0) & (share < 1.0) & (aside < 0.5 * min(assembly.length[joints[k : k + 2]]))
            points.append(assembly.outlines[block][near])
    every = np.concatenate(points)
    x, y = every[np.argmax(every[:, 1])]
    return float(x), float(y)


def _foot(assembly: Assembly, joint: int, name: str) -> Dimension:
    left, right = sorted((assembly.p[joint], assembly.q[joint]), key=lambda point: float(point[0]))
    return Dimension(name, (float(left[0]), float(left[1])), (float(right[0]), float(right[1])), "below")
