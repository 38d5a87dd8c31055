"""Barrel vaults on buttresses and churches of three aisles (thesis 3.4 and 3.5)."""

from dataclasses import dataclass, replace

import numpy as np

from extrados.structures.assembly import GROUND, Assembly
from extrados.structures.builder import BadGeometry, Builder, fill_loads, springing_path


def make_vault(
    radius: float,
    thickness: float,
    embrace: float,
    voussoirs: int,
    face: float,
    buttress_width: float,
    height: float,
    width_from: str = "face",
    height_to: str = "extrados",
    density: float = 2000.0,
    depth: float = 1.0,
) -> Assembly:
    """Barrel vault between two monolithic buttresses that are mirror images; the vault's centre is the origin.

    face: x of the inner face; buttress_width is measured outward from the "face" or from the "extrados" of
    the springing, height from the ground up to the "extrados" of the springing or to the "centre" of the
    vault. The flat tops lie at the extrados of the springings. Lengths in m, embrace in degrees.
    """
    if not 0.0 < thickness < 2.0 * radius:
        raise BadGeometry(f"vault: the thickness {thickness:g} m must lie between 0 and twice the radius {radius:g} m")
    half = 0.5 * np.radians(embrace)
    inner, outer = radius - 0.5 * thickness, radius + 0.5 * thickness
    centre = np.zeros(2)
    top = outer * np.cos(half)
    base = (top if height_to == "extrados" else 0.0) - height
    back = (face if width_from == "face" else outer * np.sin(half)) + buttress_width
    path = springing_path("buttress", 1, face, centre, inner, outer, half, top)
    if base >= path[0, 1]:
        raise BadGeometry(f"buttress: the ground at {base:.4g} m is not below the springing at {path[0, 1]:.4g} m")
    if back <= path[-1, 0]:
        raise BadGeometry(
            f"buttress: its outer face at x = {back:.4g} m does not reach behind the springing at {path[-1, 0]:.4g} m"
        )
    right = np.concatenate([[[face, base], [back, base], [back, top]], path[::-1]])
    mirror = np.array([-1.0, 1.0])
    builder = Builder(density, depth)
    joints = builder.ring("", centre, inner, outer, 2.0 * half, voussoirs, voussoirs, voussoirs + 1)
    left_block = builder.block("left buttress", (right * mirror)[::-1])
    right_block = builder.block("right buttress", right)
    builder.joint("left base", right[0] * mirror, right[1] * mirror, left_block, GROUND, -1)
    builder.joint("right base", right[0], right[1], right_block, GROUND, 1)
    return builder.assembly(
        chains={"vault": joints},
        buttresses=[left_block, right_block],
        measures={"clear_span_m": 2.0 * face, "base_width_m": back - face, "height_above_ground_m": top - base},
    )


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
    fill_level: float | None = None,
    aisle_fill_level: float | None = None,
    fill_density: float = 1600.0,
    density: float = 2000.0,
    depth: float = 1.0,
) -> Assembly:
    """A nave on two piers, with side aisles where they are given; ground at y = 0, nave centre at x = 0.

    The inner face of a pier is tangent to the nave's intrados, as are the faces about an aisle to its own.
    Piers and buttresses are monolithic and stand on horizontal joints. Fill lies over the nave vault up to
    fill_level and over the aisle vaults up to aisle_fill_level [m].
    """
    half = 0.5 * np.radians(embrace)
    inner, outer = radius - 0.5 * thickness, radius + 0.5 * thickness
    if inner <= 0.0:
        raise BadGeometry(f"nave: the thickness {thickness:g} m must lie below twice the radius {radius:g} m")
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
    levels = {name: fill_level if name == "nave" else aisle_fill_level for name in chains if "flyer" not in name}
    if any(level is not None for level in levels.values()):
        fill = fill_loads(
            assembly, [(chains[n], level) for n, level in levels.items() if level is not None], fill_density
        )
        return replace(assembly, fill=fill, measures=measures)
    return replace(assembly, measures=measures)


def _aisle(
    builder: Builder, word: str, side: int, aisle: Aisle, pier: int, back: float, pier_top: float
) -> tuple[dict[str, list[int]], np.ndarray, int]:
    """Aisle vault, buttress and flyer: their chains, the outer face of the pier, and the buttress."""
    if aisle.span <= 0.0:
        raise BadGeometry(f"{word} aisle: no room is left for its span ({aisle.span:.4g} m)")
    inner = 0.5 * aisle.span
    outer, half = inner + aisle.thickness, 0.5 * np.radians(aisle.embrace)
    centre = np.array([back + side * inner, aisle.springing])
    if aisle.springing <= 0.0:
        raise BadGeometry(f"{word} aisle: its springing must lie above the ground")
    face = back + side * aisle.span
    rear = face + side * aisle.buttress_width
    top = aisle.springing + outer * np.cos(half) if aisle.buttress_top is None else aisle.buttress_top
    buttress = builder.reserve(f"{word} buttress")
    ends = (pier, buttress) if side > 0 else (buttress, pier)
    chain = builder.ring(f"{word} aisle ", centre, inner, outer, 2.0 * half, aisle.voussoirs, *ends)
    if pier_top <= aisle.springing + outer * np.cos(half):
        raise BadGeometry(f"{word} pier: its top at {pier_top:.4g} m lies below the springing of the aisle")
    outside = springing_path(f"{word} pier", -side, back, centre, inner, outer, half, pier_top)
    path = springing_path(f"{word} buttress", side, face, centre, inner, outer, half, top)
    outline = np.concatenate([[[face, 0.0], [rear, 0.0], [rear, top]], path[::-1]])
    builder.fill_in(buttress, outline)
    builder.joint(f"{word} buttress base", outline[0], outline[1], buttress, GROUND, side)
    chains = {f"{word} aisle": chain}
    if aisle.flyer is not None:
        chains[f"{word} flyer"] = _flyer(
            builder, word, side, aisle, aisle.flyer, pier, buttress, back, face, pier_top, top
        )
    return chains, outside, buttress


def _flyer(
    builder: Builder, word: str, side: int, aisle: Aisle, flyer: Flyer, pier: int, buttress: int,
    back: float, face: float, pier_top: float, top: float,
) -> list[int]:  # fmt: skip
    """Voussoirs with radial joints between vertical end joints at the two faces; joints from left to right."""
    head, foot = np.array([0.0, flyer.head]), np.array([aisle.span, flyer.foot])  # u outward from the pier
    chord = foot - head
    length = float(np.hypot(*chord))
    if flyer.radius < 0.5 * length:
        raise BadGeometry(f"{word} flyer: the radius {flyer.radius:g} m is less than half its chord ({length:.4g} m)")
    sag = np.sqrt(flyer.radius**2 - 0.25 * length**2)
    down = np.array([chord[1], -chord[0]]) / length  # to the lower side of the chord
    centre = 0.5 * (head + foot) + sag * down
    if centre[0] > 1e-9 * length or aisle.span - centre[0] > 0.97 * flyer.radius:
        raise BadGeometry(
            f"{word} flyer: with a radius of {flyer.radius:g} m its crown does not lie at or before the pier"
        )
    outer = flyer.radius + flyer.thickness

    def at(radius: float, u: float) -> float:
        return float(centre[1] + np.sqrt(radius**2 - (u - centre[0]) ** 2))

    for what, u, limit in (("pier", 0.0, pier_top), ("buttress", aisle.span, top)):
        if at(outer, u) > limit + 1e-9 * outer:
            raise BadGeometry(
                f"{word} flyer: its extrados meets the {what} at {at(outer, u):.4g} m, above the top at {limit:.4g} m"
            )
    start = np.arctan2(flyer.head - centre[1], -centre[0])
    end = np.arctan2(flyer.foot - centre[1], aisle.span - centre[0])
    angle = np.linspace(start, end, flyer.voussoirs + 1)[1:-1]
    p = [head, *(centre + flyer.radius * np.column_stack([np.cos(angle), np.sin(angle)])), foot]
    q = [
        np.array([0.0, at(outer, 0.0)]),
        *(centre + outer * np.column_stack([np.cos(angle), np.sin(angle)])),
        np.array([aisle.span, at(outer, aisle.span)]),
    ]
    if np.any(np.diff([point[0] for point in q]) <= 0.0):
        raise BadGeometry(
            f"{word} flyer: {flyer.voussoirs} voussoirs do not fit between its vertical end joints; take a larger radius or fewer"
        )

    def place(points: np.ndarray) -> np.ndarray:
        return np.column_stack([back + side * points[:, 0], points[:, 1]])

    def arc(radius: float, one: np.ndarray, two: np.ndarray) -> np.ndarray:
        u = np.linspace(one[0], two[0], 7)
        return np.column_stack([u, centre[1] + np.sqrt(radius**2 - (u - centre[0]) ** 2)])

    blocks = [
        builder.block(
            f"{word} flyer voussoir {i + 1}",
            place(np.concatenate([arc(flyer.radius, p[i], p[i + 1]), arc(outer, q[i], q[i + 1])[::-1]])),
        )
        for i in range(flyer.voussoirs)
    ]
    ends = [pier, *blocks, buttress]
    pp, qq = place(np.array(p)), place(np.array(q))
    joints = [
        builder.joint(f"{word} flyer joint {j}", pp[j], qq[j], ends[j + 1], ends[j], -side)
        for j in range(flyer.voussoirs + 1)
    ]
    return joints if side > 0 else joints[::-1]
