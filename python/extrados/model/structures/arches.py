"""Pointed and elliptical arches on rigid springings."""

import itertools
from collections.abc import Callable
from pathlib import Path
from typing import ClassVar, Literal

import numpy as np

from extrados.model.errors import BadGeometry
from extrados.model.geometry.assembly import GROUND, Assembly
from extrados.model.geometry.builder import Builder
from extrados.model.structure import Structure
from extrados.schema.quantities import Length
from extrados.schema.table import key

FINE = 33  # points that draw each face of a voussoir: its area is right to about 1e-5

Curve = Callable[[np.ndarray], np.ndarray]


def _arch(inner: list[np.ndarray], outer: list[np.ndarray], density: float, depth: float) -> Assembly:
    """Voussoirs between faces given as points from left to right."""
    builder = Builder(density, depth)
    n = len(inner)
    for i in range(n):
        builder.block(f"voussoir {i + 1}", np.concatenate([inner[i], outer[i][::-1]]))
    p = np.array([inner[0][0], *(face[-1] for face in inner)])
    q = np.array([outer[0][0], *(face[-1] for face in outer)])
    ends = [GROUND, *range(n), GROUND]
    joints = [builder.joint(f"joint {j}", p[j], q[j], ends[j + 1], ends[j], -1) for j in range(n + 1)]
    rise = float(max(face[:, 1].max() for face in inner))
    return builder.assembly(chains={"arch": joints}, measures={"clear_span_m": float(p[-1, 0] - p[0, 0]), "rise_m": rise})


def make_pointed_arch(
    span: float, radius: float, thickness: float, voussoirs: int, density: float = 2000.0, depth: float = 1.0
) -> Assembly:
    """Two arcs of intrados `radius` (half the span: round; the span: equilateral) that meet at the crown.

    Joints are radial to the arc of their side, the crown joint is vertical; springings are level at y = 0.
    `voussoirs` is even.
    """
    if voussoirs % 2 or voussoirs < 4:
        raise BadGeometry(f"pointed arch: {voussoirs} voussoirs were given; expected an even number of at least 4")
    if radius < 0.5 * span:
        raise BadGeometry(f"pointed arch: the radius of {radius:g} m is below half of the span of {span:g} m")
    away = radius - 0.5 * span  # the centre of an arc lies this far beyond the axis
    crown_in, crown_out = np.arccos(away / radius), np.arccos(away / (radius + thickness))
    half = voussoirs // 2
    inner: list[np.ndarray] = []
    outer: list[np.ndarray] = []
    for i in range(half):
        # From the springing (angle 0 at the far side of the centre) up to the crown
        start, end = crown_in * i / half, crown_in * (i + 1) / half
        for faces, r, last in ((inner, radius, crown_in), (outer, radius + thickness, crown_out)):
            angle = np.linspace(start, last if i == half - 1 else end, FINE)
            faces.append(np.column_stack([away - r * np.cos(angle), r * np.sin(angle)]))
    mirror = np.array([-1.0, 1.0])
    return _arch(inner + [(f * mirror)[::-1] for f in inner[::-1]], outer + [(f * mirror)[::-1] for f in outer[::-1]], density, depth)


def make_elliptical_arch(
    span: float, rise: float, thickness: float, voussoirs: int, density: float = 2000.0, depth: float = 1.0
) -> Assembly:
    """Half an ellipse as the intrados, the ring of constant thickness along its normals, joints normal to it.

    The joints divide the intrados into equal lengths; the springings are level at y = 0.
    """
    if min(rise, 0.5 * span) ** 2 / max(rise, 0.5 * span) <= 0.0:
        raise BadGeometry("elliptical arch: span and rise must be above 0")
    a, b = 0.5 * span, rise
    fine = np.linspace(np.pi, 0.0, 20001)
    curve = np.column_stack([a * np.cos(fine), b * np.sin(fine)])
    run = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(curve, axis=0).T))])
    joint = np.interp(run[-1] * np.arange(voussoirs + 1) / voussoirs, run, fine)
    joint[0], joint[-1] = np.pi, 0.0
    inner, outer = [], []
    for start, end in itertools.pairwise(joint):
        angle = np.linspace(start, end, FINE)
        point = np.column_stack([a * np.cos(angle), b * np.sin(angle)])
        normal = np.column_stack([b * np.cos(angle), a * np.sin(angle)])
        inner.append(point)
        outer.append(point + thickness * normal / np.hypot(*normal.T)[:, None])
    return _arch(inner, outer, density, depth)


class PointedArch(Structure):
    """Pointed arch of two circular arcs on rigid level springings; the crown joint is vertical."""

    starter: ClassVar = {"span": "6.0", "radius": "6.0", "thickness": "0.5", "voussoirs": "24"}
    word: ClassVar = "pointed arch"
    kind: Literal["pointed-arch"]
    span: Length = key(about="clear span", gt=0)
    radius: Length = key(about="radius of the intrados: half of the span gives a round arch, the whole span an equilateral arch", gt=0)
    thickness: Length = key(about="thickness of the ring", gt=0)
    voussoirs: int = key(about="number of voussoirs, even", ge=4, le=5000)
    depth: Length = key(1.0, "depth out of plane", gt=0)

    def assembly(self, density: float, folder: Path) -> Assembly:
        return make_pointed_arch(self.span, self.radius, self.thickness, self.voussoirs, density, self.depth)


class EllipticalArch(Structure):
    """Arch on half an ellipse; ring of constant thickness, joints normal to the intrados, level springings."""

    starter: ClassVar = {"span": "8.0", "rise": "3.0", "thickness": "0.6", "voussoirs": "24"}
    word: ClassVar = "elliptical arch"
    kind: Literal["elliptical-arch"]
    span: Length = key(about="clear span", gt=0)
    rise: Length = key(about="rise of the intrados", gt=0)
    thickness: Length = key(about="thickness of the ring", gt=0)
    voussoirs: int = key(about="number of voussoirs", ge=4, le=5000)
    depth: Length = key(1.0, "depth out of plane", gt=0)

    def assembly(self, density: float, folder: Path) -> Assembly:
        return make_elliptical_arch(self.span, self.rise, self.thickness, self.voussoirs, density, self.depth)
