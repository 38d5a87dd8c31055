"""Draw cases/limit/church.dxf: the section of a church as a survey delivers it, 125 irregular stones.

A nave and two aisles on coursed piers and buttresses. All of it is warped by up to 10 mm, as walls that have moved are,
and every stone is measured for itself with 1 mm of noise, so that no two neighbours fit. The coordinates are
georeferenced, the foundations lie at unlike levels, the aisle vaults are loose lines and arcs, one buttress is a block
reference, and there are a hatch and texts. Needs ezdxf.
"""

import itertools
import sys
from pathlib import Path

import ezdxf
import numpy as np

WARP, NOISE = 0.010, 0.001  # m
ORIGIN = np.array([431250.0, 5062480.0])
SPACING = 0.3  # m between measured points along a face
SEED = 17

NAVE = {"half_angle": 75.0, "face": 3.6, "thickness": 0.5, "voussoirs": 23, "centre": 6.6}
AISLE = {"half_angle": 60.0, "half_span": 1.7, "thickness": 0.4, "voussoirs": 13, "spring": 4.3}
PIER, BUTTRESS = 1.4, 1.5  # widths
#: Level of the foundations of left and right pier, and of left and right buttress
LEVELS = {("pier", -1): 0.0, ("pier", 1): 0.0, ("buttress", -1): 0.4, ("buttress", 1): -0.6}

Outline = np.ndarray


def joints(rng: np.random.Generator, start: float, stop: float, count: int, spread: float = 0.15) -> np.ndarray:
    """count + 1 places from start to stop, at irregular distances."""
    steps = 1.0 + spread * rng.uniform(-1.0, 1.0, count)
    return start + (stop - start) * np.concatenate([[0.0], np.cumsum(steps) / steps.sum()])


def ring(rng: np.random.Generator, centre: np.ndarray, inner: float, outer: float, half: float, count: int) -> list[Outline]:
    """Voussoirs of an arch from left to right."""
    angle = joints(rng, np.pi / 2 + np.radians(half), np.pi / 2 - np.radians(half), count)
    toward = np.column_stack([np.cos(angle), np.sin(angle)])
    low, high = centre + inner * toward, centre + outer * toward
    return [np.array([low[k], low[k + 1], high[k + 1], high[k]]) for k in range(count)]


def courses(rng: np.random.Generator, x: tuple[float, float], y: tuple[float, float], count: int, halved: tuple[int, ...]) -> list[Outline]:
    """Courses between two upright faces; those named in `halved` have a head joint."""
    level = joints(rng, *y, count)
    stones = []
    for k, (low, high) in enumerate(itertools.pairwise(level)):
        cut = [x[0], x[0] + (x[1] - x[0]) * rng.uniform(0.4, 0.6), x[1]] if k in halved else list(x)
        stones += [np.array([[a, low], [b, low], [b, high], [a, high]]) for a, b in itertools.pairwise(cut)]
    return stones


def supports(rng: np.random.Generator, side: int) -> tuple[list[Outline], list[Outline], dict[str, np.ndarray]]:
    """Pier and buttress on one side, drawn to the right and mirrored for the left; the rest belongs to the arches."""
    half = np.radians(AISLE["half_angle"])
    face = NAVE["face"] + PIER
    seat = AISLE["thickness"] * np.array([np.sin(half), np.cos(half)])  # from the intrados to the extrados
    spring = AISLE["spring"]
    reach = AISLE["half_span"] / np.sin(half)
    centre = np.array([face + AISLE["half_span"], spring - reach * np.cos(half)])
    back = face - seat[0]
    nave_in = NAVE["face"] / np.sin(np.radians(NAVE["half_angle"]))
    toward = np.array([np.sin(np.radians(NAVE["half_angle"])), np.cos(np.radians(NAVE["half_angle"]))])
    low, high = (np.array([0.0, NAVE["centre"]]) + r * toward for r in (nave_in, nave_in + NAVE["thickness"]))
    base = LEVELS["pier", side]
    under, crown = spring - 0.35, spring + seat[1]
    pier = courses(rng, (NAVE["face"], face), (base, under), 8, (2, 5))
    pier.append(np.array([[NAVE["face"], under], [face, under], [face, spring], [back, crown], [NAVE["face"], crown]]))
    top = low[1] - 0.3
    pier += courses(rng, (NAVE["face"], back), (crown, top), 6, (3,))
    pier.append(np.array([[NAVE["face"], top], [back, top], [back, high[1]], high, low]))
    pier += courses(rng, (high[0] + 0.05, back), (high[1], high[1] + 1.2), 3, ())
    inner = face + 2.0 * AISLE["half_span"]
    outer, ledge = inner + BUTTRESS, inner + seat[0]
    base = LEVELS["buttress", side]
    buttress = courses(rng, (inner, outer), (base, under), 9, (2, 6))
    buttress.append(np.array([[inner, under], [outer, under], [outer, crown], [ledge, crown], [inner, spring]]))
    buttress += courses(rng, (ledge, outer), (crown, crown + 1.5), 3, ())
    buttress += courses(rng, (ledge + 0.15, outer - 0.15), (crown + 1.5, crown + 2.0), 1, ())
    return pier, buttress, {"centre": centre, "inner": reach}


def mirrored(stones: list[Outline]) -> list[Outline]:
    return [stone[::-1] * (-1.0, 1.0) for stone in stones]


def finely(outline: Outline) -> Outline:
    """The outline with measured points along its faces."""
    points = []
    for a, b in zip(outline, np.roll(outline, -1, axis=0), strict=True):
        count = max(1, round(float(np.hypot(*(b - a))) / SPACING))
        points += [a + (b - a) * k / count for k in range(count)]
    return np.array(points)


def warped(points: np.ndarray) -> np.ndarray:
    """Points of a building that has moved: a smooth displacement of up to 10 mm each way."""
    x, y = points.T
    return points + WARP * np.column_stack(
        [
            0.6 * np.sin(0.9 * x + 0.7 * y + 0.4) + 0.4 * np.sin(1.7 * y - 0.5 * x),
            0.6 * np.sin(1.1 * x - 0.6 * y + 1.3) + 0.4 * np.cos(0.8 * y + 1.3 * x),
        ]
    )


def church() -> dict[str, list[Outline]]:
    """The stones by their layers, from which the survey is taken: true shapes, not yet warped."""
    rng = np.random.default_rng(SEED)
    nave_in = NAVE["face"] / np.sin(np.radians(NAVE["half_angle"]))
    stones = {
        "NAVE": ring(rng, np.array([0.0, NAVE["centre"]]), nave_in, nave_in + NAVE["thickness"], NAVE["half_angle"], NAVE["voussoirs"])
    }
    for side, word in ((-1, "LEFT"), (1, "RIGHT")):
        pier, buttress, aisle = supports(rng, side)
        vault = ring(rng, aisle["centre"], aisle["inner"], aisle["inner"] + AISLE["thickness"], AISLE["half_angle"], AISLE["voussoirs"])
        turn = mirrored if side < 0 else list
        stones |= {f"{word} PIER": turn(pier), f"{word} BUTTRESS": turn(buttress), f"{word} AISLE": turn(vault)}
    return stones


def measured(rng: np.random.Generator, points: np.ndarray) -> np.ndarray:
    """Warped points as measured, in the coordinates of the country."""
    noise = np.clip(rng.normal(0.0, NOISE, points.shape), -2.5 * NOISE, 2.5 * NOISE)
    return warped(points) + noise + ORIGIN


def draw(path: Path) -> int:
    """Write the drawing; the number of its stones."""
    rng = np.random.default_rng(SEED + 1)
    document = ezdxf.new("R2000", units=6)
    space = document.modelspace()
    stones = church()
    half = np.radians(AISLE["half_angle"])
    for layer, outlines in stones.items():
        if layer.endswith("AISLE"):
            turned = -1.0 if layer.startswith("LEFT") else 1.0
            centre = np.array([turned * (NAVE["face"] + PIER + AISLE["half_span"]), AISLE["spring"] - AISLE["half_span"] / np.tan(half)])
            for k, (a, b, c, d) in enumerate(outlines):
                right_to_left = turned < 0.0
                sides = [(a, b), (b, c), (d, a)] if not right_to_left else [(b, c), (c, d), (d, a)]
                if k:  # the joint to the voussoir before is drawn already
                    sides.pop()
                for one, two in sides:
                    space.add_line(*(tuple(p) for p in measured(rng, np.array([one, two]))), dxfattribs={"layer": "AISLES"})
                one, two = (c, d) if not right_to_left else (a, b)
                ends = measured(rng, np.array([one, two])) - ORIGIN - centre
                angle = np.degrees(np.arctan2(ends[:, 1], ends[:, 0]))
                space.add_arc(
                    tuple(centre + ORIGIN), float(np.hypot(*ends.T).mean()), angle.min(), angle.max(), dxfattribs={"layer": "AISLES"}
                )
            continue
        target, shift, attributes = space, np.zeros(2), {"layer": "RUBBLE" if "BUTTRESS" in layer else "ASHLAR"}
        if layer == "LEFT BUTTRESS":  # drawn once as a block, at its own origin, and referred to
            shift = ORIGIN - np.array([10.0, 0.0])
            target = document.blocks.new("BUTTRESS")
            space.add_blockref("BUTTRESS", tuple(shift), dxfattribs=attributes)
            attributes = {"layer": "0"}
        for outline in outlines:
            points = measured(rng, finely(outline)) - shift
            target.add_lwpolyline(points.round(4).tolist(), close=True, dxfattribs=attributes)
        if layer.endswith(("PIER", "BUTTRESS")):
            sole = np.concatenate(outlines)
            level = sole[:, 1].min()
            x = sole[np.abs(sole[:, 1] - level) < 1e-9, 0]
            ends = warped(np.array([[x.min(), level], [x.max(), level]])) + ORIGIN
            along = (ends[1] - ends[0]) / np.hypot(*(ends[1] - ends[0]))
            space.add_line(tuple(ends[0] - 0.2 * along), tuple(ends[1] + 0.2 * along), dxfattribs={"layer": "GROUND"})
            bed = outlines[0 if layer.endswith("PIER") else 1]
            if layer.endswith("PIER"):  # a course bedded on lead: its bed is marked
                line = warped(bed[2:4] if layer.startswith("RIGHT") else bed[:2]) + ORIGIN
                space.add_line(*(tuple(p) for p in line), dxfattribs={"layer": "LEAD"})
    hatch = space.add_hatch(color=8, dxfattribs={"layer": "SHADING"})
    hatch.paths.add_polyline_path((np.array([[-3.6, 0.0], [3.6, 0.0], [3.6, -0.2], [-3.6, -0.2]]) + ORIGIN).tolist())
    for text, place in (("NAVE", (0.0, 3.0)), ("SURVEYED 1:50", (-9.0, -2.0))):
        space.add_text(text, height=0.3, dxfattribs={"layer": "TEXT"}).set_placement(tuple(np.array(place) + ORIGIN))
    document.saveas(path)
    return sum(map(len, stones.values()))


if __name__ == "__main__":
    target = Path(sys.argv[1] if len(sys.argv) > 1 else "cases/limit/church.dxf")
    print(f"{draw(target)} stones in {target}")
