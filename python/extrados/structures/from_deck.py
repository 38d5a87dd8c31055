"""The structure that a deck asks for."""

from pathlib import Path
from typing import Any

from extrados.decks import block as block_models
from extrados.decks import masonry, vaults, walls
from extrados.decks import structures as models
from extrados.decks.table import Structure
from extrados.structures import from_vaults
from extrados.structures.arch import make_arch
from extrados.structures.arches import make_elliptical_arch, make_pointed_arch
from extrados.structures.block import make_block
from extrados.structures.masonry import make_column, make_wall
from extrados.structures.panel import make_panel

BLOCK_KEYS = {"width", "height", "depth", "density", "mass", "inertia", "centre_height", "toe_right", "toe_left"}


def make_structure(model: Structure | None, folder: Path) -> Any:
    """Blocks and joints, or a mesh, of a deck's [structure]; None where the deck has none."""
    match model:
        case None:
            return None
        case models.Arch():
            return make_arch(
                model.radius,
                model.thickness * model.thickness_factor,
                model.embrace,
                model.voussoirs,
                model.density,
                model.depth,
            )
        case vaults.Vault():
            return from_vaults.vault(model)
        case vaults.AisledVault():
            return from_vaults.church(model)
        case vaults.Blocks():
            return from_vaults.blocks(model, folder)
        case vaults.PointedArch():
            return make_pointed_arch(
                model.span, model.radius, model.thickness, model.voussoirs, model.density, model.depth
            )
        case vaults.EllipticalArch():
            return make_elliptical_arch(
                model.span, model.rise, model.thickness, model.voussoirs, model.density, model.depth
            )
        case walls.Panel():
            return make_panel(model, folder)
        case walls.Mesh():
            from extrados.structures.mesh_file import read_mesh

            return read_mesh(model, folder)
        case block_models.Block():
            return make_block(**model.model_dump(include=BLOCK_KEYS))
        case masonry.Column():
            heights = model.heights or [model.height / model.drums] * model.drums
            return make_column(model.width, heights, model.top_width, model.density, model.depth)
        case masonry.BrickWall():
            return make_wall(
                model.unit_length, model.unit_height, model.units, model.courses, model.density, model.depth
            )
    raise TypeError(f"no structure for {type(model).__name__}")
