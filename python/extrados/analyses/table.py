"""The base of the analysis tables."""

from typing import TYPE_CHECKING, ClassVar, Literal, TypeAlias

from pydantic import model_validator

from extrados.model.properties import Initial, Joints, Material, Supports
from extrados.schema.table import Table, key, override_of

if TYPE_CHECKING:
    from extrados.views.building import Building

if TYPE_CHECKING:  # made of the tables of the building, key by key
    MaterialOverride: TypeAlias = Table
    JointsOverride: TypeAlias = Table
    SupportsOverride: TypeAlias = Table
    InitialOverride: TypeAlias = Table
else:
    MaterialOverride = override_of(Material, __name__)
    JointsOverride = override_of(Joints, __name__)
    SupportsOverride = override_of(Supports, __name__)
    InitialOverride = override_of(Initial, __name__)
#: The tables of a building that an analysis may override for itself
OVERRIDES = ("material", "joints", "supports", "initial")


class Animated(Table):
    """Keys of the analyses whose answer moves."""

    animation: Literal["none", "gif", "mp4"] = key(
        "none", "also write a film of the motion, 1280 x 720, with the figures; mp4 requires ffmpeg or the package imageio-ffmpeg"
    )
    animation_speed: float = key(
        1.0, "speed of the film: 1 is real time, 0.2 is five times slower; for results without a time, 1 gives a film of 8 s", gt=0, le=10
    )

    @model_validator(mode="after")
    def _moves(self) -> "Animated":
        if "animation_speed" in self.model_fields_set and self.animation == "none":
            raise ValueError('`animation_speed` requires animation = "gif" or "mp4"')
        return self


class Analysis(Table):
    """Base of the analysis kinds.

    view: what it looks at, "blocks", "rocker" or "mesh", "" where it needs no building; structures: the only kinds
    it takes, None any that has the view. solid: whether it takes solids, where there is no plane section; shells: kinds without
    stones that it takes as shells. uses: properties of the building that its answer rests on, which every
    answer tells; starter_structure, starter_motion: their kinds in the deck that `new` writes, "" no motion unless one is needed. considers: what of
    Building.special_keys it takes into account; one that looks at a building with more is refused. beside: what
    it looks at, or refuses, beside `uses`, without telling it.
    """

    kind: str
    view: ClassVar[str] = ""
    structures: ClassVar[tuple[str, ...] | None] = None
    solid: ClassVar[bool] = False
    shells: ClassVar[tuple[str, ...]] = ()
    uses: ClassVar[tuple[str, ...]] = ()
    needs_motion: ClassVar[bool] = False
    considers: ClassVar[tuple[str, ...]] = ()
    beside: ClassVar[tuple[str, ...]] = ()
    starter_structure: ClassVar[str] = "arch"
    starter_motion: ClassVar[str] = ""

    def rests_on(self, building: "Building") -> dict[str, str | None]:
        """The properties of this building that its answer rests on, with what the method fixes of them, else None."""
        return dict.fromkeys(self.uses)

    def reckons_with(self, building: "Building") -> set[str]:
        """The keys of [material], [joints], [supports] and [initial] of which another value may change the answer for this
        building, or which the answer or a refusal names; what a deck says in others is told to be left out."""
        return {*self.rests_on(building), *self.beside}

    @property
    def has_rates(self) -> bool:
        """Whether rates count in it: a viscous damper has no force in statics."""
        return True


class BuildingAnalysis(Analysis):
    """Base of the analyses of a building: they may override its properties for themselves."""

    view: ClassVar[str] = "blocks"
    material: MaterialOverride | None = key(None, "values of [material] for this analysis only")
    joints: JointsOverride | None = key(None, "values of [joints] for this analysis only")
    supports: SupportsOverride | None = key(None, "values of [supports] for this analysis only")
    initial: InitialOverride | None = key(None, "values of [initial] for this analysis only")
