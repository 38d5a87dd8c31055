"""Structure kinds of limit analysis: vaults, churches, further arches and free blocks."""

from typing import Any, ClassVar, Literal

from pydantic import model_validator

from extrados.decks.quantities import Angle, Density, Length
from extrados.decks.table import Structure, Table, key

DENSITY = dict(about="density of the masonry", gt=0, le=30000)

# Sizes inferred by fitting published results, or guessed from public facts; never the authors' own.
VAULT_PRESETS = {
    "dejong-a": {
        "radius": 10.0, "thickness": 1.5, "embrace": 120.0, "voussoirs": 24, "face": 8.5,
        "buttress_width": 17.0 / 3.0, "width_from": "face", "height": 25.5, "height_to": "extrados",
    },
    "dejong-b": {
        "radius": 10.0, "thickness": 1.5, "embrace": 120.0, "voussoirs": 24, "face": 8.660254037844386,
        "buttress_width": 5.61, "width_from": "extrados", "height": 25.5, "height_to": "centre",
    },
}  # fmt: skip
AISLED_PRESETS = {
    "vezelay-like": {
        "radius": 4.8, "thickness": 0.6, "embrace": 150.0, "voussoirs": 20, "springing": 12.5, "pier_width": 1.9,
        "aisle_thickness": 0.45, "aisle_embrace": 150.0, "aisle_voussoirs": 14, "aisle_springing": 6.0,
        "buttress_width": 1.8, "buttress_top": 8.5, "half_width": 12.5,
    },
    "colombier-like": {
        "radius": 2.9, "thickness": 0.4, "embrace": 150.0, "voussoirs": 20, "springing": 7.6, "pier_width": 1.1,
        "aisle_thickness": 0.35, "aisle_embrace": 150.0, "aisle_voussoirs": 14, "aisle_springing": 6.6,
        "buttress_width": 1.7, "half_width": 8.2,
    },
}  # fmt: skip


def _with_preset(data: Any, presets: dict[str, dict[str, Any]]) -> Any:
    """The keys of a preset, each of which the deck may overrule."""
    if isinstance(data, dict) and isinstance(data.get("preset"), str) and data["preset"] in presets:
        return {**presets[data["preset"]], **data}
    return data


class Vault(Structure):
    """Barrel vault between two monolithic buttresses that are mirror images (thesis 3.4)."""

    starter: ClassVar = {
        "radius": "5.0",
        "thickness": "0.6",
        "embrace": "120.0",
        "face": "4.2",
        "buttress_width": "2.0",
        "height": "9.0",
    }
    kind: Literal["vault"]
    preset: Literal["dejong-a", "dejong-b"] | None = key(
        None, "all sizes of a reading of the vault of thesis 3.4, inferred from its results; other keys overrule it"
    )
    radius: Length = key(about="radius of the vault's centre line", gt=0)
    thickness: Length = key(about="thickness of the vault", gt=0)
    embrace: Angle = key(about="angle of embrace of the vault between its end joints", ge=20, le=180)
    voussoirs: int = key(24, "number of voussoirs of the vault", ge=4, le=5000)
    face: Length = key(about="distance of the buttresses' inner faces from the axis", gt=0)
    buttress_width: Length = key(about="width of the buttresses, measured outward from `width_from`", gt=0)
    width_from: Literal["face", "extrados"] = key(
        "face", "where buttress_width starts: at the inner face, or at the extrados of the springing"
    )
    height: Length = key(about="height from the ground up to `height_to`", gt=0)
    height_to: Literal["extrados", "centre"] = key(
        "extrados", "where height ends: at the extrados of the springing, or at the level of the vault's centre"
    )
    density: Density = key(2000.0, **DENSITY)
    depth: Length = key(1.0, "depth out of plane", gt=0)

    @model_validator(mode="before")
    @classmethod
    def _preset(cls, data: Any) -> Any:
        return _with_preset(data, VAULT_PRESETS)


class FlyerTable(Table):
    """A flying buttress: an arc of voussoirs from the pier down to the outer buttress, end joints vertical."""

    head: Length = key(about="height of its intrados at the pier", gt=0)
    foot: Length = key(about="height of its intrados at the buttress", gt=0)
    thickness: Length = key(about="thickness of the flyer", gt=0)
    radius: Length = key(about="radius of its intrados", gt=0)
    voussoirs: int = key(6, "number of voussoirs of the flyer", ge=2, le=500)


class RightSide(Table):
    """What differs on the right-hand side of a church."""

    aisle: bool | None = key(None, "whether there is an aisle on this side")
    aisle_span: Length | None = key(None, "clear span of the aisle", gt=0)
    aisle_thickness: Length | None = key(None, "thickness of the aisle vault", gt=0)
    aisle_springing: Length | None = key(None, "height of the aisle vault's centre above the ground", gt=0)
    buttress_width: Length | None = key(None, "width of the outer buttress", gt=0)
    buttress_top: Length | None = key(None, "height of the outer buttress", gt=0)
    flyer: FlyerTable | None = key(None, "flying buttress over the aisle")


class AisledVault(Structure):
    """A nave on two piers with side aisles, outer buttresses and, if wished, flyers and fill (thesis 3.5)."""

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
    kind: Literal["aisled-vault"]
    preset: Literal["vezelay-like", "colombier-like"] | None = key(
        None, "guessed sizes of a church in the manner of thesis 3.5; other keys overrule it"
    )
    radius: Length = key(about="radius of the nave vault's centre line", gt=0)
    thickness: Length = key(about="thickness of the nave vault", gt=0)
    embrace: Angle = key(150.0, "angle of embrace of the nave vault", ge=20, le=180)
    voussoirs: int = key(20, "number of voussoirs of the nave vault", ge=4, le=5000)
    springing: Length = key(about="height of the nave vault's centre above the ground", gt=0)
    pier_width: Length = key(about="width of the piers", gt=0)
    pier_top: Length | None = key(None, "height of the piers; default the extrados of the nave's springing", gt=0)
    aisles: bool = key(True, "false leaves the nave alone on its piers")
    aisle_thickness: Length | None = key(None, "thickness of the aisle vaults", gt=0)
    aisle_embrace: Angle = key(150.0, "angle of embrace of the aisle vaults", ge=20, le=180)
    aisle_voussoirs: int = key(14, "number of voussoirs of each aisle vault", ge=4, le=5000)
    aisle_springing: Length | None = key(None, "height of the aisle vaults' centres above the ground", gt=0)
    aisle_span: Length | None = key(None, "clear span of the aisles; or give half_width", gt=0)
    half_width: Length | None = key(
        None, "from the axis to the outer face of the buttresses; the aisles take what is left", gt=0
    )
    buttress_width: Length | None = key(None, "width of the outer buttresses", gt=0)
    buttress_top: Length | None = key(
        None, "height of the outer buttresses; default the extrados of the aisle's springing", gt=0
    )
    flyer: FlyerTable | None = key(None, "flying buttresses over the aisles")
    right: RightSide | None = key(None, "what differs on the right-hand side")
    fill_level: Length | None = key(None, "top of the fill over the nave vault, above the ground", gt=0)
    aisle_fill_level: Length | None = key(None, "top of the fill over the aisle vaults, above the ground", gt=0)
    fill_density: Density = key(1600.0, "density of the fill", gt=0, le=30000)
    density: Density = key(2000.0, **DENSITY)
    depth: Length = key(1.0, "depth out of plane", gt=0)

    @model_validator(mode="before")
    @classmethod
    def _preset(cls, data: Any) -> Any:
        return _with_preset(data, AISLED_PRESETS)

    @model_validator(mode="after")
    def _whole(self) -> "AisledVault":
        if not self.aisles:
            return self
        missing = [k for k in ("aisle_thickness", "aisle_springing", "buttress_width") if getattr(self, k) is None]
        if missing:
            raise ValueError(f"{missing[0]} is missing: expected with aisles (or aisles = false)")
        if (self.aisle_span is None) == (self.half_width is None):
            raise ValueError("expected either aisle_span or half_width")
        return self


class PointedArch(Structure):
    """Pointed arch of two circular arcs on rigid level springings; the crown joint is vertical."""

    starter: ClassVar = {
        "span": "6.0",
        "radius": "6.0",
        "thickness": "0.5",
        "voussoirs": "24",
    }
    kind: Literal["pointed-arch"]
    span: Length = key(about="clear span", gt=0)
    radius: Length = key(about="radius of the intrados: half the span is round, the span equilateral", gt=0)
    thickness: Length = key(about="thickness of the ring", gt=0)
    voussoirs: int = key(about="number of voussoirs, even", ge=4, le=5000)
    density: Density = key(2000.0, **DENSITY)
    depth: Length = key(1.0, "depth out of plane", gt=0)


class EllipticalArch(Structure):
    """Arch on half an ellipse; ring of constant thickness, joints normal to the intrados, level springings."""

    starter: ClassVar = {
        "span": "8.0",
        "rise": "3.0",
        "thickness": "0.6",
        "voussoirs": "24",
    }
    kind: Literal["elliptical-arch"]
    span: Length = key(about="clear span", gt=0)
    rise: Length = key(about="rise of the intrados", gt=0)
    thickness: Length = key(about="thickness of the ring", gt=0)
    voussoirs: int = key(about="number of voussoirs", ge=4, le=5000)
    density: Density = key(2000.0, **DENSITY)
    depth: Length = key(1.0, "depth out of plane", gt=0)


class BlockTable(Table):
    """One block of a free assembly."""

    name: str | None = key(None, "name of the block in results and complaints", max_length=80)
    points: list[list[Length]] = key(about="vertices [x, y], either way round", min_length=3, max_length=2000)
    density: Density | None = key(None, "density, where it differs from the others", gt=0, le=30000)


class Blocks(Structure):
    """Any plane assembly of polygons; edges that lie on each other are the joints."""

    starter: ClassVar = {"block": '[{ name = "pier", points = [[0, 0], [1, 0], [1, 3], [0, 3]] }]'}
    kind: Literal["blocks"]
    file: str | None = key(None, "JSON or DXF file with the blocks, beside the deck", max_length=500)
    unit: Literal["m", "cm", "mm", "in", "ft"] | None = key(
        None, "unit of a drawing that does not say (DXF without $INSUNITS)"
    )
    layers: list[str] | None = key(None, "layers of the drawing to read; default all", max_length=200)
    block: list[BlockTable] | None = key(None, "the blocks, where no file is given", max_length=20000)
    ground: list[list[Length]] | None = key(
        None, "segments [x1, y1, x2, y2] the structure stands on; default its lowest level", max_length=2000
    )
    contact_tolerance: Length = key(1e-4, "edges nearer than this touch", gt=0, le=0.1)
    density: Density = key(2000.0, **DENSITY)
    depth: Length = key(1.0, "depth out of plane", gt=0)

    @model_validator(mode="after")
    def _source(self) -> "Blocks":
        if (self.file is None) == (self.block is None):
            raise ValueError("expected either a file or [[structure.block]] tables")
        for name, rows, width in (("ground", self.ground or [], 4),):
            for row in rows:
                if len(row) != width:
                    raise ValueError(f"{name}: a row has {len(row)} numbers, expected {width}")
        for i, block in enumerate(self.block or []):
            if any(len(point) != 2 for point in block.points):
                raise ValueError(f"block {i + 1}: a vertex is not [x, y]")
        return self
