"""Blocks from a DXF drawing: closed polylines become blocks, lines on the ground layer the supports."""

import itertools
from pathlib import Path

import numpy as np

from extrados.structures.blocks import LARGEST_FILE, MOST_BLOCKS, UNITS, Polygon
from extrados.structures.builder import BadGeometry

GROUND_LAYER = "GROUND"
# DXF $INSUNITS -> our unit
INSUNITS = {1: "in", 2: "ft", 4: "mm", 5: "cm", 6: "m"}
SAGITTA = 2e-4  # m: how far the chords of an arc may lie from it
PASSED_OVER = {"TEXT", "MTEXT", "DIMENSION", "POINT", "HATCH", "LEADER", "MULTILEADER", "VIEWPORT", "ATTDEF"}


def read_dxf(
    path: Path, unit: str | None = None, layers: list[str] | None = None
) -> tuple[list[Polygon], np.ndarray | None]:
    """Blocks and ground of a drawing; `layers` (with the ground layer) are read, all where it is None.

    A drawing without units is refused until `unit` is given. Needs the extra `dxf` (ezdxf).
    """
    try:
        import ezdxf
        from ezdxf import path as curve
    except ImportError:
        raise BadGeometry("reading DXF needs ezdxf: pip install 'extrados[dxf]'") from None
    try:
        if path.stat().st_size > LARGEST_FILE:
            raise BadGeometry(f"{path.name}: larger than {LARGEST_FILE / 1e6:g} MB")
        drawing = ezdxf.readfile(path)
    except OSError as error:
        raise BadGeometry(f"{path.name}: cannot be read as DXF: {error}") from None
    except (ezdxf.DXFError, UnicodeDecodeError) as error:
        raise BadGeometry(f"{path.name}: is not a sound DXF file: {error}") from None
    scale = UNITS[unit or _unit(path, int(drawing.header.get("$INSUNITS", 0)))]
    polygons: list[Polygon] = []
    ground: list[list[float]] = []
    known = {entity.dxf.layer for entity in drawing.modelspace()}
    for missing in [name for name in layers or [] if name not in known]:
        raise BadGeometry(f"{path.name}: no layer '{missing}'; there are {', '.join(sorted(known))}")
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


def _ends_meet(entity, curve) -> bool:
    path = curve.make_path(entity)
    return path.start.isclose(path.end)


def _segments(entity, kind: str, where: str) -> list[list[float]]:
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
