"""Polygons from files: DXF (closed polylines become blocks, lines on the ground layer the supports) and JSON."""

import itertools
import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from extrados.building.errors import BadGeometry
from extrados.schema.files import File

LARGEST_FILE = 20_000_000  # bytes of a drawing or a JSON file
MOST_BLOCKS = 20_000
MOST_POINTS = 2_000
UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001, "in": 0.0254, "ft": 0.3048}
GROUND_LAYER = "GROUND"
# DXF $INSUNITS -> our unit
INSUNITS = {1: "in", 2: "ft", 4: "mm", 5: "cm", 6: "m"}
SAGITTA = 2e-4  # m: how far the chords of an arc may lie from it
PASSED_OVER = {"TEXT", "MTEXT", "DIMENSION", "POINT", "HATCH", "LEADER", "MULTILEADER", "VIEWPORT", "ATTDEF"}


@dataclass(frozen=True)
class Polygon:
    """A block before its joints are known: vertices (n, 2) [m] either way round; density None: the structure's."""

    name: str
    points: np.ndarray
    density: float | None = None


#: No structure reaches farther [m]


def read_dxf(
    file: File, unit: str | None = None, layers: list[str] | None = None
) -> tuple[list[Polygon], np.ndarray | None]:
    """Blocks and ground of a drawing; `layers` (with the ground layer) are read, all where it is None.

    A drawing without units is refused until `unit` is given. Needs the extra `dxf` (ezdxf).
    """
    try:
        from ezdxf import path as curve
        from ezdxf.filemanagement import readfile
        from ezdxf.lldxf.const import DXFError
    except ImportError:
        raise BadGeometry("reading DXF needs ezdxf: pip install 'extrados[dxf]'") from None
    path = file.path
    try:
        with file.copied() as copy:
            drawing = readfile(copy)
    except OSError as error:
        raise BadGeometry(f"{path.name}: cannot be read as DXF: {error}") from None
    except (DXFError, UnicodeDecodeError) as error:
        raise BadGeometry(f"{path.name}: is not a sound DXF file: {error}") from None
    scale = UNITS[unit or _unit(path, int(drawing.header.get("$INSUNITS", 0)))]
    polygons: list[Polygon] = []
    ground: list[list[float]] = []
    known = {entity.dxf.layer for entity in drawing.modelspace()}
    for missing in [name for name in layers or [] if name not in known]:
        raise BadGeometry(f"{path.name}: no layer '{missing}'; there are {', '.join(sorted(known))}")
    entity: Any  # ezdxf makes the attributes of an entity as it reads it
    for entity in drawing.modelspace():
        layer, kind = entity.dxf.layer, entity.dxftype()
        where = f"{path.name}: layer '{layer}', {kind} #{entity.dxf.handle}"
        on_ground = layer.upper() == GROUND_LAYER
        if kind in PASSED_OVER or not (layers is None or on_ground or layer in layers):
            continue
        if on_ground:
            ground += [[scale * v for v in segment] for segment in _segments(entity, kind, where)]
        elif kind in ("LWPOLYLINE", "POLYLINE"):
            if not entity.is_closed and not _ends_meet(entity, curve):
                raise BadGeometry(f"{where}: is open; only closed polylines become blocks")
            points = [(v.x, v.y) for v in curve.make_path(entity).flattening(SAGITTA / scale)]
            polygons.append(Polygon(f"{layer} #{entity.dxf.handle}", scale * np.array(points)))
        else:
            raise BadGeometry(
                f"{where}: only closed polylines become blocks; redraw it as one, "
                f"or name the layers to read (layers = [...])"
            )
        if len(polygons) > MOST_BLOCKS:
            raise BadGeometry(f"{path.name}: more than {MOST_BLOCKS} blocks")
    if not polygons:
        raise BadGeometry(f"{path.name}: no closed polyline on {'any layer' if layers is None else 'the layers named'}")
    return polygons, np.array(ground) if ground else None


def _unit(path: Path, code: int) -> str:
    if code not in INSUNITS:
        what = "has no unit ($INSUNITS = 0)" if code == 0 else f"has a unit not known here ($INSUNITS = {code})"
        raise BadGeometry(f'{path.name}: {what}; say which with  unit = "mm"  (one of {", ".join(UNITS)})')
    return INSUNITS[code]


def _ends_meet(entity: Any, curve: Any) -> bool:
    path = curve.make_path(entity)
    return path.start.isclose(path.end)


def _segments(entity: Any, kind: str, where: str) -> list[list[float]]:
    if kind == "LINE":
        points = [entity.dxf.start, entity.dxf.end]
    elif kind == "LWPOLYLINE":
        points = list(entity.vertices_in_wcs())
    elif kind == "POLYLINE":
        points = list(entity.points())
    else:
        raise BadGeometry(f"{where}: the ground is drawn with lines or polylines")
    if kind != "LINE" and entity.is_closed:
        points.append(points[0])
    return [[a.x, a.y, b.x, b.y] for a, b in itertools.pairwise(points)]


def read_json(file: File) -> tuple[list[Polygon], np.ndarray | None]:
    """Blocks and ground of {"unit": "m", "blocks": [{"name", "points", "density"}], "ground": [[x, y, x, y]]}."""
    path = file.path
    try:
        data = json.loads(file.text())
    except (ValueError, RecursionError) as error:
        raise BadGeometry(f"{path.name}: is not JSON: {error}") from None
    if not isinstance(data, dict) or not isinstance(data.get("blocks"), list):
        raise BadGeometry(f'{path.name}: expected an object with a list "blocks"')
    if unknown := set(data) - {"unit", "blocks", "ground", "title"}:
        raise BadGeometry(f"{path.name}: unknown key '{sorted(unknown)[0]}'; known are unit, title, blocks, ground")
    unit = data.get("unit", "m")
    if not isinstance(unit, str) or unit not in UNITS:
        raise BadGeometry(f"{path.name}: unit {unit!r}; expected one of {', '.join(UNITS)}")
    scale = UNITS[unit]
    if len(data["blocks"]) > MOST_BLOCKS:
        raise BadGeometry(f"{path.name}: {len(data['blocks'])} blocks, at most {MOST_BLOCKS}")
    polygons = []
    for i, entry in enumerate(data["blocks"]):
        name = entry.get("name", f"block {i + 1}") if isinstance(entry, dict) else None
        if not isinstance(entry, dict) or not isinstance(name, str) or set(entry) - {"name", "points", "density"}:
            raise BadGeometry(
                f"{path.name}: blocks[{i}]: expected an object with points and, if wished, name and density"
            )
        density = entry.get("density")
        if density is not None and (
            isinstance(density, bool) or not isinstance(density, int | float) or not 0.0 < density < 3e4
        ):
            raise BadGeometry(f"{path.name}: block '{name}': density {density!r}, expected kg/m^3 above 0")
        polygons.append(
            Polygon(name, scale * _numbers(entry.get("points"), 2, f"{path.name}: block '{name}': points"), density)
        )
    ground = data.get("ground")
    return polygons, None if ground is None else scale * _numbers(ground, 4, f"{path.name}: ground")


def _numbers(value: object, width: int, where: str) -> np.ndarray:
    try:
        array = np.array(value, dtype=float)
    except (TypeError, ValueError):
        array = np.empty(0)
    if array.ndim != 2 or array.shape[1] != width or not np.isfinite(array).all():
        raise BadGeometry(f"{where}: expected a list of lists of {width} numbers")
    return array
