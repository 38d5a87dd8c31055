"""Barrel vaults on buttresses (thesis 3.4)."""

from pathlib import Path
from typing import ClassVar, Literal

import numpy as np

from extrados.model.errors import BadGeometry
from extrados.model.geometry.assembly import GROUND, Assembly
from extrados.model.geometry.builder import Builder, springing_path
from extrados.model.structures.presets import PresetStructure
from extrados.schema.quantities import Angle, Length
from extrados.schema.table import key

# Sizes inferred by fitting published results, or guessed from public facts; never the authors' own.
VAULT_PRESETS = {
    "dejong-a": {
        "radius": 10.0,
        "thickness": 1.5,
        "embrace": 120.0,
        "voussoirs": 24,
        "face": 8.5,
        "buttress_width": 17.0 / 3.0,
        "width_from": "face",
        "height": 25.5,
        "height_to": "extrados",
    },
    "dejong-b": {
        "radius": 10.0,
        "thickness": 1.5,
        "embrace": 120.0,
        "voussoirs": 24,
        "face": 8.660254037844386,
        "buttress_width": 5.61,
        "width_from": "extrados",
        "height": 25.5,
        "height_to": "centre",
    },
}


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
        raise BadGeometry(f"vault: the thickness of {thickness:g} m must be above 0 and below twice the radius of {radius:g} m")
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
        raise BadGeometry(f"buttress: the outer face at x = {back:.4g} m must be behind the springing at {path[-1, 0]:.4g} m")
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


class Vault(PresetStructure):
    """Barrel vault between two monolithic buttresses that are mirror images (thesis 3.4)."""

    presets: ClassVar = VAULT_PRESETS
    starter: ClassVar = {"radius": "5.0", "thickness": "0.6", "embrace": "120.0", "face": "4.2", "buttress_width": "2.0", "height": "9.0"}
    word: ClassVar = "vault on its buttresses"
    kind: Literal["vault"]
    preset: Literal["dejong-a", "dejong-b"] | None = key(
        None,
        "dimensions of the vault in thesis 3.4, inferred from the results there. Each preset is one interpretation; "
        "keys in the deck replace individual dimensions",
    )
    radius: Length = key(about="radius of the centre line of the vault", gt=0)
    thickness: Length = key(about="thickness of the vault", gt=0)
    embrace: Angle = key(about="angle of embrace of the vault between its end joints", ge=20, le=180)
    voussoirs: int = key(24, "number of voussoirs of the vault", ge=4, le=5000)
    face: Length = key(about="distance of the inner faces of the buttresses from the axis of the vault", gt=0)
    buttress_width: Length = key(about="width of the buttresses, measured outward from the line given by `width_from`", gt=0)
    width_from: Literal["face", "extrados"] = key(
        "face", "line from which `buttress_width` is measured: the inner face, or the extrados at the springing"
    )
    height: Length = key(about="height of the buttresses from the ground to the level given by `height_to`", gt=0)
    height_to: Literal["extrados", "centre"] = key(
        "extrados", "level up to which `height` is measured: the extrados at the springing, or the centre of the vault"
    )
    depth: Length = key(1.0, "depth out of plane", gt=0)

    def assembly(self, density: float, folder: Path) -> Assembly:
        return make_vault(
            self.radius,
            self.thickness,
            self.embrace,
            self.voussoirs,
            self.face,
            self.buttress_width,
            self.height,
            self.width_from,
            self.height_to,
            density,
            self.depth,
        )
