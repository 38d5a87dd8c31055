"""What a file tells of a section: outlines of blocks, ground, marks upon joints; and the JSON of our own that says so."""

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np

from extrados.model.errors import BadGeometry
from extrados.schema.files import File

MOST_BLOCKS = 20_000
MOST_POINTS = 2_000
UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001, "in": 0.0254, "ft": 0.3048}
GROUND_LAYER = "GROUND"

Role = Literal["stones", "ground", "joints", "left-out"]
#: Plane of a file in space that is the section; its second axis is vertical
Plane = Literal["xy", "xz", "yz"]


@dataclass(frozen=True)
class Polygon:
    """A block before its joints are known: vertices (n, 2) [m] either way round; density None: the structure's.

    layer: of the drawing it comes from; material: a name of [materials], where it differs.
    """

    name: str
    points: np.ndarray
    density: float | None = None
    layer: str = ""
    material: str | None = None


@dataclass(frozen=True)
class Layer:
    """What a layer of a drawing is: stones, ground, lines that mark joints, or nothing to read."""

    role: Role = "stones"
    material: str | None = None


@dataclass(frozen=True)
class Drawing:
    """Blocks; ground (k, 4) x, y, x, y [m], None where the file has none; marks: lines (k, 4) by the layer that
    names the joints below them; notes: what was left out or is worth telling of the file, in words; loose: places of
    lines that end nowhere, with the gap [m] to the next one where that is near."""

    blocks: list[Polygon]
    ground: np.ndarray | None = None
    marks: Mapping[str, np.ndarray] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    loose: tuple[tuple[tuple[float, float], float | None], ...] = ()


def parsed(file: File) -> Any:
    """The JSON value in a file; BadGeometry where it is none."""
    try:
        return json.loads(file.text())
    except (ValueError, RecursionError) as error:
        raise BadGeometry(f"{file.path.name}: is not JSON: {error}") from None


def read_json(file: File) -> Drawing:
    """Blocks and ground of {"unit": "m", "blocks": [{"name", "points", "density"}], "ground": [[x, y, x, y]]}."""
    value, name = parsed(file), file.path.name
    if not isinstance(value, dict) or not isinstance(value.get("blocks"), list):
        raise BadGeometry(f'{name}: expected an object with a list "blocks", or an assembly of COMPAS')
    if unknown := set(value) - {"unit", "blocks", "ground", "title"}:
        raise BadGeometry(f"{name}: unknown key {_shown(min(unknown))}; the keys are unit, title, blocks and ground")
    unit = value.get("unit", "m")
    if not isinstance(unit, str) or unit not in UNITS:
        raise BadGeometry(f"{name}: unit {_shown(unit)} is unknown; expected one of {', '.join(UNITS)}")
    scale = UNITS[unit]
    if len(value["blocks"]) > MOST_BLOCKS:
        raise BadGeometry(f"{name}: this file has {len(value['blocks'])} blocks; at most {MOST_BLOCKS} are allowed")
    polygons = []
    for i, entry in enumerate(value["blocks"]):
        title = entry.get("name", f"block {i + 1}") if isinstance(entry, dict) else None
        if not isinstance(entry, dict) or not isinstance(title, str) or set(entry) - {"name", "points", "density"}:
            raise BadGeometry(f"{name}: blocks[{i}]: expected an object with points, and optionally name and density")
        density = entry.get("density")
        if density is not None and (isinstance(density, bool) or not isinstance(density, int | float) or not 0.0 < density < 3e4):
            raise BadGeometry(f"{name}: block '{title}': the density is {_shown(density)}, expected kg/m^3 above 0")
        points = numbers(entry.get("points"), 2, f"{name}: block '{title}': points")
        polygons.append(Polygon(title, scale * points, density))
    ground = value.get("ground")
    return Drawing(polygons, None if ground is None else scale * numbers(ground, 4, f"{name}: ground"))


def _shown(value: object) -> str:
    """A value of a file as complaints quote it: its beginning."""
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:40]}..."


def numbers(value: object, width: int, where: str) -> np.ndarray:
    """A list of lists of `width` finite numbers as an array; BadGeometry names `where` otherwise."""
    try:
        array = np.array(value, dtype=float)
    except (TypeError, ValueError, OverflowError):  # a whole number may have hundreds of digits
        array = np.empty(0)
    if array.ndim != 2 or array.shape[1] != width or not np.isfinite(array).all():
        raise BadGeometry(f"{where}: expected a list of rows of {width} numbers each")
    return array
