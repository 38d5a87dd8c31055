"""Churches of three aisles: nave, side aisles, buttresses, flyers and fill (thesis 3.5)."""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, ClassVar, Literal

import numpy as np
from pydantic import model_validator

from extrados.model.errors import BadGeometry
from extrados.model.geometry.assembly import GROUND, Assembly
from extrados.model.geometry.builder import Builder, fill_loads, springing_path
from extrados.model.structures.presets import PresetStructure
from extrados.schema.quantities import Angle, Density, Length
from extrados.schema.table import Table, key

# Sizes inferred by fitting published results, or guessed from public facts; never the authors' own.
AISLED_PRESETS = {
    "vezelay-like": {
        "radius": 4.8,
        "thickness": 0.6,
        "embrace": 150.0,
        "voussoirs": 20,
        "springing": 12.5,
        "pier_width": 1.9,
        "aisle_thickness": 0.45,
        "aisle_embrace": 150.0,
        "aisle_voussoirs": 14,
        "aisle_springing": 6.0,
        "buttress_width": 1.8,
        "buttress_top": 8.5,
        "half_width": 12.5,
    },
    "colombier-like": {
        "radius": 2.9,
        "thickness": 0.4,
        "embrace": 150.0,
        "voussoirs": 20,
        "springing": 7.6,
        "pier_width": 1.1,
        "aisle_thickness": 0.35,
        "aisle_embrace": 150.0,
        "aisle_voussoirs": 14,
        "aisle_springing": 6.6,
        "buttress_width": 1.7,
        "half_width": 8.2,
    },
    "colombier-tall": {
        "radius": 2.3,
        "thickness": 0.45,
        "embrace": 135.0,
        "voussoirs": 20,
        "springing": 6.1,
        "pier_width": 1.05,
        "aisle_thickness": 0.36,
        "aisle_embrace": 135.0,
        "aisle_voussoirs": 14,
        "aisle_springing": 6.0,
        "buttress_width": 1.7,
        "half_width": 8.9,
    },
}


@dataclass(frozen=True)
class Flyer:
    """A flying buttress: a circular arc of voussoirs from the pier down to the outer buttress.

    head and foot: heights of its intrados at the two faces; radius of the intrados; vertical end joints.
    """

    head: float
    foot: float
    thickness: float
    radius: float
    voussoirs: int


@dataclass(frozen=True)
class Added:
    """A buttress that stands free beside the outer one, `gap` away, and props it by a flyer (thesis Fig. 3-8)."""

    gap: float
    width: float
    top: float
    flyer: Flyer


@dataclass(frozen=True)
class Aisle:
    """One side of a church: pier, aisle vault, outer buttress, flyer. Heights are above the ground.

    span: clear width between pier and buttress; springing: height of the aisle vault's centre;
    buttress_top None: at the extrados of the aisle's springing.
    """

    span: float
    thickness: float
    embrace: float
    voussoirs: int
    springing: float
    buttress_width: float
    buttress_top: float | None = None
    flyer: Flyer | None = None
    added: Added | None = None


@dataclass(frozen=True)
class Fill:
    """Fill over the nave vault up to level, over the aisle vaults up to aisle_level [m]; None: no fill. density [kg/m^3]."""

    level: float | None = None
    aisle_level: float | None = None
    density: float = 1600.0


def make_church(
    radius: float,
    thickness: float,
    embrace: float,
    voussoirs: int,
    springing: float,
    pier_width: float,
    left: Aisle | None,
    right: Aisle | None,
    pier_top: float | None = None,
    fill: Fill = Fill(),
    density: float = 2000.0,
    depth: float = 1.0,
) -> Assembly:
    """A nave on two piers, with side aisles where they are given; ground at y = 0, nave centre at x = 0.

    The inner face of a pier is tangent to the nave's intrados, as are the faces about an aisle to its own.
    Piers and buttresses are monolithic and stand on horizontal joints. fill: over the
    nave and aisle vaults.
    """
    half = 0.5 * np.radians(embrace)
    inner, outer = radius - 0.5 * thickness, radius + 0.5 * thickness
    if inner <= 0.0:
        raise BadGeometry(f"nave: the thickness {thickness:g} m must be less than twice the radius {radius:g} m")
    centre = np.array([0.0, springing])
    builder = Builder(density, depth)
    piers = [builder.reserve("left pier"), builder.reserve("right pier")]
    chains = {"nave": builder.ring("nave ", centre, inner, outer, 2.0 * half, voussoirs, *piers)}
    top = springing + outer * np.cos(half) if pier_top is None else pier_top
    buttresses: list[int] = []
    for side, aisle, pier, word in ((-1, left, piers[0], "left"), (1, right, piers[1], "right")):
        face, back = side * inner, side * (inner + pier_width)
        nave_path = springing_path(f"{word} pier", side, face, centre, inner, outer, half, top)
        outside = np.array([[back, top]])
        if aisle is not None:
            chain, outside, buttress = _aisle(builder, word, side, aisle, pier, back, top)
            chains.update(chain)
            buttresses.append(buttress)
        else:
            buttresses.append(pier)
        outline = np.concatenate([[[face, 0.0], [back, 0.0]], outside, nave_path[::-1]])
        builder.fill_in(pier, outline)
        builder.joint(f"{word} pier base", outline[0], outline[1], pier, GROUND, side)
    assembly = builder.assembly(chains=chains, buttresses=sorted(buttresses, key=builder.place_of))
    ends = np.concatenate([assembly.p, assembly.q])[:, 0]
    measures = {"overall_width_m": float(np.ptp(ends)), "nave_span_m": 2.0 * inner}
    for word, aisle in (("left", left), ("right", right)):
        if aisle is not None:
            measures[f"{word}_aisle_span_m"] = aisle.span
    levels = {name: fill.level if name == "nave" else fill.aisle_level for name in chains if "flyer" not in name}
    if any(level is not None for level in levels.values()):
        loads = fill_loads(assembly, [(chains[n], level) for n, level in levels.items() if level is not None], fill.density)
        return replace(assembly, fill=loads, measures=measures)
    return replace(assembly, measures=measures)


def _aisle(
    builder: Builder, word: str, side: int, aisle: Aisle, pier: int, back: float, pier_top: float
) -> tuple[dict[str, list[int]], np.ndarray, int]:
    """Aisle vault, buttress and flyer: their chains, the outer face of the pier, and the buttress."""
    if aisle.span <= 0.0:
        raise BadGeometry(f"{word} aisle: no width remains for the aisle (its span would be {aisle.span:.4g} m)")
    inner = 0.5 * aisle.span
    outer, half = inner + aisle.thickness, 0.5 * np.radians(aisle.embrace)
    centre = np.array([back + side * inner, aisle.springing])
    if aisle.springing <= 0.0:
        raise BadGeometry(f"{word} aisle: the springing must be above the ground")
    face = back + side * aisle.span
    rear = face + side * aisle.buttress_width
    top = aisle.springing + outer * np.cos(half) if aisle.buttress_top is None else aisle.buttress_top
    buttress = builder.reserve(f"{word} buttress")
    ends = (pier, buttress) if side > 0 else (buttress, pier)
    chain = builder.ring(f"{word} aisle ", centre, inner, outer, 2.0 * half, aisle.voussoirs, *ends)
    if pier_top <= aisle.springing + outer * np.cos(half):
        raise BadGeometry(f"{word} pier: the top at {pier_top:.4g} m is below the springing of the aisle")
    outside = springing_path(f"{word} pier", -side, back, centre, inner, outer, half, pier_top)
    path = springing_path(f"{word} buttress", side, face, centre, inner, outer, half, top)
    outline = np.concatenate([[[face, 0.0], [rear, 0.0], [rear, top]], path[::-1]])
    builder.fill_in(buttress, outline)
    builder.joint(f"{word} buttress base", outline[0], outline[1], buttress, GROUND, side)
    chains = {f"{word} aisle": chain}
    if aisle.flyer is not None:
        chains[f"{word} flyer"] = _flyer(builder, f"{word} flyer", side, aisle.span, aisle.flyer, pier, buttress, back, pier_top, top)
    if aisle.added is not None:
        chains[f"{word} prop"], buttress = _prop(builder, word, side, aisle.added, buttress, rear, top)
    return chains, outside, buttress


def _prop(builder: Builder, word: str, side: int, added: Added, buttress: int, rear: float, top: float) -> tuple[list[int], int]:
    """The flyer and the block of an added buttress, beyond the rear face of the outer one."""
    face = rear + side * added.gap
    outer = face + side * added.width
    outline = np.array([[face, 0.0], [outer, 0.0], [outer, added.top], [face, added.top]])
    block = builder.block(f"{word} added buttress", outline if side > 0 else outline[::-1])
    builder.joint(f"{word} added buttress base", outline[0], outline[1], block, GROUND, side)
    chain = _flyer(builder, f"{word} prop", side, added.gap, added.flyer, buttress, block, rear, top, added.top)
    return chain, block


def _flyer(
    builder: Builder, word: str, side: int, span: float, flyer: Flyer, pier: int, buttress: int, back: float, pier_top: float, top: float
) -> list[int]:
    """Voussoirs with radial joints between vertical end joints at the two faces; joints from left to right."""
    head, foot = np.array([0.0, flyer.head]), np.array([span, flyer.foot])  # u outward from the pier
    chord = foot - head
    length = float(np.hypot(*chord))
    if flyer.radius < 0.5 * length:
        raise BadGeometry(f"{word}: the radius of {flyer.radius:g} m is less than half of the chord ({length:.4g} m)")
    sag = np.sqrt(flyer.radius**2 - 0.25 * length**2)
    down = np.array([chord[1], -chord[0]]) / length  # to the lower side of the chord
    centre = 0.5 * (head + foot) + sag * down
    if centre[0] > 1e-9 * length or span - centre[0] > 0.97 * flyer.radius:
        raise BadGeometry(f"{word}: with a radius of {flyer.radius:g} m, the crown is beyond the pier")
    outer = flyer.radius + flyer.thickness

    def at(radius: float, u: float) -> float:
        return float(centre[1] + np.sqrt(radius**2 - (u - centre[0]) ** 2))

    for what, u, limit in (("pier", 0.0, pier_top), ("buttress", span, top)):
        if at(outer, u) > limit + 1e-9 * outer:
            raise BadGeometry(f"{word}: the extrados meets the {what} at {at(outer, u):.4g} m, above the top at {limit:.4g} m")
    start = np.arctan2(flyer.head - centre[1], -centre[0])
    end = np.arctan2(flyer.foot - centre[1], span - centre[0])
    angle = np.linspace(start, end, flyer.voussoirs + 1)[1:-1]
    p = [head, *(centre + flyer.radius * np.column_stack([np.cos(angle), np.sin(angle)])), foot]
    q = [
        np.array([0.0, at(outer, 0.0)]),
        *(centre + outer * np.column_stack([np.cos(angle), np.sin(angle)])),
        np.array([span, at(outer, span)]),
    ]
    if np.any(np.diff([point[0] for point in q]) <= 0.0):
        raise BadGeometry(
            f"{word}: {flyer.voussoirs} voussoirs do not fit between the vertical end joints: give a larger radius or fewer voussoirs"
        )

    def place(points: np.ndarray) -> np.ndarray:
        return np.column_stack([back + side * points[:, 0], points[:, 1]])

    def arc(radius: float, one: np.ndarray, two: np.ndarray) -> np.ndarray:
        u = np.linspace(one[0], two[0], 7)
        return np.column_stack([u, centre[1] + np.sqrt(radius**2 - (u - centre[0]) ** 2)])

    blocks = [
        builder.block(
            f"{word} voussoir {i + 1}", place(np.concatenate([arc(flyer.radius, p[i], p[i + 1]), arc(outer, q[i], q[i + 1])[::-1]]))
        )
        for i in range(flyer.voussoirs)
    ]
    ends = [pier, *blocks, buttress]
    pp, qq = place(np.array(p)), place(np.array(q))
    joints = [builder.joint(f"{word} joint {j}", pp[j], qq[j], ends[j + 1], ends[j], -side) for j in range(flyer.voussoirs + 1)]
    return joints if side > 0 else joints[::-1]


class FlyerTable(Table):
    """A flying buttress: an arc of voussoirs from the pier down to the outer buttress, end joints vertical."""

    head: Length = key(about="height of the intrados of the flyer at the pier", gt=0)
    foot: Length = key(about="height of the intrados of the flyer at the buttress", gt=0)
    thickness: Length = key(about="thickness of the flyer", gt=0)
    radius: Length = key(about="radius of the intrados of the flyer", gt=0)
    voussoirs: int = key(6, "number of voussoirs of the flyer (flying buttress)", ge=2, le=500)


class AddedTable(Table):
    """A buttress added outside later, that props the outer one by a flyer (thesis Fig. 3-8)."""

    gap: Length = key(about="clear distance between the outer buttress and the added buttress", gt=0)
    width: Length = key(about="width of the added buttress", gt=0)
    top: Length = key(about="height of the added buttress", gt=0)
    flyer: FlyerTable = key(about="flyer between the outer buttress (upper end) and the added buttress")


class RightSide(Table):
    """What differs on the right-hand side of a church."""

    aisle: bool | None = key(None, "whether there is an aisle on this side")
    aisle_span: Length | None = key(None, "clear span of the aisle", gt=0)
    aisle_thickness: Length | None = key(None, "thickness of the aisle vault", gt=0)
    aisle_springing: Length | None = key(None, "height above the ground of the centre of the aisle vault", gt=0)
    buttress_width: Length | None = key(None, "width of the outer buttress", gt=0)
    buttress_top: Length | None = key(None, "height of the outer buttress", gt=0)
    flyer: FlyerTable | None = key(None, "flying buttress over the aisle")
    added: AddedTable | None = key(None, "buttress added on this side", source="thesis Fig. 3-8")


class AisledVault(PresetStructure):
    """A nave on two piers with side aisles and outer buttresses; flyers and fill are optional (thesis 3.5)."""

    presets: ClassVar = AISLED_PRESETS
    starter: ClassVar = {
        "radius": "4.8",
        "thickness": "0.6",
        "springing": "12.5",
        "pier_width": "1.9",
        "aisle_thickness": "0.45",
        "aisle_springing": "6.0",
        "half_width": "12.5",
        "buttress_width": "1.8",
        "buttress_top": "8.5",
    }
    word: ClassVar = "church section"
    kind: Literal["aisled-vault"]
    preset: Literal["vezelay-like", "colombier-like", "colombier-tall"] | None = key(
        None, "estimated dimensions of a church similar to those in thesis 3.5; keys in the deck replace single dimensions"
    )
    radius: Length = key(about="radius of the centre line of the nave vault", gt=0)
    thickness: Length = key(about="thickness of the nave vault", gt=0)
    embrace: Angle = key(150.0, "angle of embrace of the nave vault", ge=20, le=180)
    voussoirs: int = key(20, "number of voussoirs of the nave vault", ge=4, le=5000)
    springing: Length = key(about="height of the centre of the nave vault above the ground", gt=0)
    pier_width: Length = key(about="width of the piers", gt=0)
    pier_top: Length | None = key(None, "height of the piers; default: the height of the extrados at the springing of the nave vault", gt=0)
    aisles: bool = key(True, "false: only the nave on its piers, without aisles")
    aisle_thickness: Length | None = key(None, "thickness of the aisle vaults", gt=0)
    aisle_embrace: Angle = key(150.0, "angle of embrace of the aisle vaults", ge=20, le=180)
    aisle_voussoirs: int = key(14, "number of voussoirs of each aisle vault", ge=4, le=5000)
    aisle_springing: Length | None = key(None, "height of the centres of the aisle vaults above the ground", gt=0)
    aisle_span: Length | None = key(None, "clear span of the aisles; alternatively give `half_width`", gt=0)
    half_width: Length | None = key(
        None, "distance from the axis of the nave to the outer face of the buttresses; the aisles take the remaining width", gt=0
    )
    buttress_width: Length | None = key(None, "width of the outer buttresses", gt=0)
    buttress_top: Length | None = key(
        None, "height of the outer buttresses; default: the height of the extrados at the springing of the aisle vault", gt=0
    )
    flyer: FlyerTable | None = key(None, "flying buttresses over the aisles")
    added: AddedTable | None = key(None, "buttresses added on both sides", source="thesis Fig. 3-8")
    right: RightSide | None = key(None, "values for the right-hand side that differ from the left-hand side")
    fill_level: Length | None = key(None, "height of the top of the fill over the nave vault, above the ground", gt=0)
    aisle_fill_level: Length | None = key(None, "height of the top of the fill over the aisle vaults, above the ground", gt=0)
    fill_density: Density = key(1600.0, "density of the fill", gt=0, le=30000)
    depth: Length = key(1.0, "depth out of plane", gt=0)

    @model_validator(mode="after")
    def _whole(self) -> "AisledVault":
        if not self.aisles:
            return self
        missing = [k for k in ("aisle_thickness", "aisle_springing", "buttress_width") if getattr(self, k) is None]
        if missing:
            raise ValueError(f"{missing[0]} is missing: give it, or give aisles = false")
        if (self.aisle_span is None) == (self.half_width is None):
            raise ValueError("expected either aisle_span or half_width")
        return self

    def assembly(self, density: float, folder: Path) -> Assembly:
        left = right = None
        if self.aisles:
            left = self._side(None)
            if self.right is None or self.right.aisle is not False:
                right = self._side(self.right)
        return make_church(
            self.radius,
            self.thickness,
            self.embrace,
            self.voussoirs,
            self.springing,
            self.pier_width,
            left,
            right,
            self.pier_top,
            Fill(self.fill_level, self.aisle_fill_level, self.fill_density),
            density,
            self.depth,
        )

    def _side(self, side: RightSide | None) -> Aisle:
        """The aisle of a side; `side` holds what differs from the table's own keys."""

        def value(name: str) -> Any:
            own = getattr(side, name, None) if side is not None else None
            return getattr(self, name) if own is None else own

        width, span = value("buttress_width"), value("aisle_span")
        if span is None:
            span = self.half_width - (self.radius - 0.5 * self.thickness) - self.pier_width - width
        flyer, added = value("flyer"), value("added")
        return Aisle(
            span,
            value("aisle_thickness"),
            self.aisle_embrace,
            self.aisle_voussoirs,
            value("aisle_springing"),
            width,
            value("buttress_top"),
            None if flyer is None else Flyer(**flyer.model_dump()),
            None if added is None else Added(added.gap, added.width, added.top, Flyer(**added.flyer.model_dump())),
        )
