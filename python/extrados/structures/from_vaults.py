"""Vaults, churches, further arches and free blocks from their deck tables."""

from pathlib import Path

import numpy as np

from extrados.decks import vaults as models
from extrados.structures.assembly import Assembly
from extrados.structures.blocks import Polygon, make_blocks, read_json
from extrados.structures.builder import BadGeometry
from extrados.structures.vault import Aisle, Flyer, make_church, make_vault


def vault(model: models.Vault) -> Assembly:
    return make_vault(
        model.radius, model.thickness, model.embrace, model.voussoirs, model.face, model.buttress_width,
        model.height, model.width_from, model.height_to, model.density, model.depth,
    )  # fmt: skip


def church(model: models.AisledVault) -> Assembly:
    left = right = None
    if model.aisles:
        left = _aisle(model, None)
        if model.right is None or model.right.aisle is not False:
            right = _aisle(model, model.right)
    return make_church(
        model.radius, model.thickness, model.embrace, model.voussoirs, model.springing, model.pier_width,
        left, right, model.pier_top, model.fill_level, model.aisle_fill_level, model.fill_density, model.density, model.depth,
    )  # fmt: skip


def _aisle(model: models.AisledVault, side: models.RightSide | None) -> Aisle:
    def value(name: str):
        own = getattr(side, name, None) if side is not None else None
        return getattr(model, name) if own is None else own

    width, span = value("buttress_width"), value("aisle_span")
    if span is None:
        span = model.half_width - (model.radius - 0.5 * model.thickness) - model.pier_width - width
    flyer = value("flyer")
    return Aisle(
        span, value("aisle_thickness"), model.aisle_embrace, model.aisle_voussoirs, value("aisle_springing"), width,
        value("buttress_top"), None if flyer is None else Flyer(**flyer.model_dump()),
    )  # fmt: skip


def blocks(model: models.Blocks, folder: Path) -> Assembly:
    ground = None
    if model.file is not None:
        path = folder / model.file
        if path.suffix.lower() == ".dxf":
            from extrados.structures.drawing import read_dxf

            polygons, ground = read_dxf(path, model.unit, model.layers)
        elif path.suffix.lower() == ".json":
            polygons, ground = read_json(path)
        else:
            raise BadGeometry(f"{model.file}: expected a .json or .dxf file")
    else:
        polygons = [
            Polygon(b.name or f"block {i + 1}", np.array(b.points), b.density) for i, b in enumerate(model.block or [])
        ]
    if model.ground is not None:
        ground = np.array(model.ground)
    return make_blocks(polygons, ground, model.density, model.depth, model.contact_tolerance)
