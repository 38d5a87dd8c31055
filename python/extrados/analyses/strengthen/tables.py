"""Analysis kind of strengthening: strengthen."""

from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from pydantic import Field, ValidationError, model_validator

from extrados import kinds
from extrados.analyses.limit.tables import LimitAnalysisTable
from extrados.analyses.table import Analysis
from extrados.model.ties import Place, Tie
from extrados.schema.quantities import Acceleration, Angle, Force, Length, Stress
from extrados.schema.table import Table, key

if TYPE_CHECKING:
    from extrados.views.building import Building


class Anchorage(Table):
    """Design strengths and sizes of a tie and its anchorage, partial and confidence factors included."""

    steel_strength: Stress | None = key(None, "design yield strength of the bar; gives its section and diameter", gt=0)
    plate_width: Length | None = key(None, "width of the anchor plate", gt=0)
    plate_height: Length | None = key(None, "height of the anchor plate", gt=0)
    wall_thickness: Length | None = key(None, "thickness of the wall behind the plate", gt=0)
    compressive_strength: Stress | None = key(
        None, "design compressive strength of the masonry under the plate; gives the bearing capacity", gt=0
    )
    shear_strength: Stress | None = key(None, "design shear strength of the masonry around the plate; gives the punching capacity", gt=0)
    bond_length: Length | None = key(None, "length of an injected anchor", gt=0)
    bond_diameter: Length | None = key(None, "diameter of the borehole", gt=0)
    bond_strength: Stress | None = key(None, "design bond strength along the borehole; gives the pull-out capacity", gt=0)

    @model_validator(mode="after")
    def _together(self) -> "Anchorage":
        def whole(*names: str) -> bool:
            given = [name for name in names if getattr(self, name) is not None]
            if given and len(given) < len(names):
                missing = ", ".join(name for name in names if name not in given)
                raise ValueError(f"{' and '.join(given)} also require {missing}")
            return bool(given)

        plate = whole("plate_width", "plate_height")
        if not plate and (self.compressive_strength is not None or self.shear_strength is not None):
            raise ValueError("`compressive_strength` and `shear_strength` also require `plate_width` and `plate_height`")
        if plate and self.compressive_strength is None and self.shear_strength is None:
            raise ValueError("`plate_width` and `plate_height` require `compressive_strength`, `shear_strength` or both")
        if (self.shear_strength is None) != (self.wall_thickness is None):
            raise ValueError("`shear_strength` and `wall_thickness` require each other: give both")
        whole("bond_length", "bond_diameter", "bond_strength")
        return self


class TieOption(Tie):
    """A tie, strut, anchor or bonded strip whose yield force is sought, at one place or between two.

    Its keys are those of [[ties]]. `yield_force` is the greatest force considered; of a bonded strip it is its debonding force, whose
    source the deck states.
    """

    start_to: Place | None = key(None, "end of the range of places that begins at `start`")
    far_to: Place | None = key(None, "end of the range of places that begins at `end` or `ground`")
    places: int = key(9, "number of places considered in the range", ge=2, le=200)
    debonding_force: Force | None = key(
        None, "for a bonded FRP or FRCM strip: design force at which it debonds, which is the greatest force considered", gt=0
    )
    source: str | None = key(
        None,
        "source of the debonding force: document with the formula, or test; the report prints this source",
        min_length=3,
        max_length=300,
    )
    anchorage: Anchorage | None = key(None, "strengths of bar and anchorage, from which their checks are calculated")
    beam_weight: Force | None = key(
        None,
        "weight of a ring beam along the tie, which is accelerated with the tie: half of the weight acts on the block at "
        "each end; for a hoop, the weight is uniform along the hoop",
        gt=0,
    )

    @property
    def greatest(self) -> float:
        """The greatest force considered [N]; infinite where the deck gives none."""
        given = self.yield_force if self.debonding_force is None else self.debonding_force
        return float("inf") if given is None else given

    @model_validator(mode="after")
    def _range(self) -> "TieOption":
        if self.hoop and self.far_to is not None:
            raise ValueError("a hoop has only one height: give `start_to`, and remove `far_to`")
        if any(len(point) != len(self.start) for point in (self.start_to, self.far_to) if point is not None):
            raise ValueError("`start_to` and `far_to`: expected the same number of coordinates as in `start`")
        if "places" in self.model_fields_set and self.start_to is None and self.far_to is None:
            raise ValueError("the key `places` requires `start_to` or `far_to`, the end of the range")
        if self.debonding_force is not None and self.source is None:
            raise ValueError("`debonding_force` requires its source: the document with the formula, or the test")
        if self.source is not None and self.debonding_force is None:
            raise ValueError("the key `source` is used only with `debonding_force`: remove `source`")
        if self.debonding_force is not None and (self.yield_force is not None or self.works_in != "tension"):
            raise ValueError(
                "debonding_force: a bonded strip acts only in tension, up to `debonding_force`: remove `yield_force` and `works_in`"
            )
        if self.prestress:
            raise ValueError(
                "prestress: remove this key. The analysis calculates the tie force, and plastic collapse does not depend on `prestress`"
            )
        return self

    def at(self, share: float) -> Tie:
        """The tie at a share of its range, as [[ties]] would give it."""
        keys = {name: getattr(self, name) for name in Tie.model_fields if getattr(self, name) is not None}

        def between(one: list[float], two: list[float] | None) -> list[float]:
            return one if two is None else [(1.0 - share) * a + share * b for a, b in zip(one, two, strict=True)]

        keys |= {"start": between(self.start, self.start_to)}
        if not self.hoop:
            keys |= {"end" if self.ground is None else "ground": between(self.far, self.far_to)}
        return Tie.model_construct(**keys)


class Change(Table):
    """A number of the deck that is changed: a thickness, a buttress, a base width, a strength after injection, a damper."""

    name: str | None = key(None, "name of the intervention; default: the value of `vary`", max_length=80)
    vary: str = key(
        about="key of the deck with its table, for instance structure.buttress_width, material.compressive_strength, "
        "joints.friction or dampers.0.damping; for a key of the options below, begin with `options.`"
    )
    start: float | str | None = key(None, "value without the intervention; default: value of the deck")
    stop: float | str = key(about='last value considered, in the unit of the key or as text such as "40 cm"')
    count: int = key(9, "number of values from `start` to `stop`, including both, at which the capacity is calculated", ge=3, le=200)


class Weights(Table):
    """Cost of an intervention: length, force and volume, each with a weight in one common unit of cost."""

    per_metre: float = key(1.0, "cost per m of tie", ge=0, le=1e9)
    per_kilonewton: float = key(1.0, "cost for each kN of tie force, including the anchorage", ge=0, le=1e9)
    per_cubic_metre: float = key(10.0, "cost for each m3 of masonry that is added or injected", ge=0, le=1e9)


class Strengthen(LimitAnalysisTable):
    """Least intervention that meets a target: tie forces by linear programming, sizes and strengths by bracketing.

    Without `ties` and `changes`, the alternatives are horizontal ties at several heights and the main sizes of the kind of structure.
    """

    kind: Literal["strengthen"]
    view: ClassVar = ""
    considers: ClassVar = ("[[ties]]", "[[dampers]]", "[[hinges]]", "[supports] abutting_wall")
    beside: ClassVar = ("supports.abutting_wall", "supports.stiffness")
    starter_structure: ClassVar = "arch"
    starter: ClassVar = {"acceleration": '"0.5 g"'}
    acceleration: Acceleration | None = key(None, "target: constant horizontal acceleration that the building must carry", gt=0)
    safety_factor: float | None = key(
        None,
        "target: ratio of capacity to demand. By limit analysis, demand is the peak of [motion]; by a code, the ratio is "
        "its safety index (zeta_E, %NBS / 100)",
        gt=0,
        le=100,
    )
    probability: float | None = key(
        None, 'target: probability of collapse for the motions of [motion]; requires by = "fragility"', gt=0, lt=1
    )
    by: Literal["tilt", "local-mechanism", "code-checks", "rocking", "fragility", "dem"] = key(
        "tilt", "analysis that gives the value of the target; with tilt, the tie force follows from one linear programme"
    )
    options: dict[str, Any] = key({}, "keys of the analysis that `by` names, as in the table of that analysis")
    direction: Literal["both", "+x", "-x"] = key(
        "both", "direction of the load for limit analysis; default with an abutting wall: away from the wall"
    )
    directions: list[Annotated[Angle, Field(ge=-360, le=360)]] = key(
        [], "for blocks in space: directions of the load in plan, as angles from +x towards +y; default 0, 90, 180 and 270", max_length=72
    )
    ties: list[TieOption] = key([], "alternative ties, whose least sufficient force is calculated", max_length=50)
    changes: list[Change] = key([], "alternative changes of numbers in the deck, whose least sufficient value is calculated", max_length=50)
    combine: bool = key(True, "also calculate the combination of the given ties with the least total force, by one linear programme")
    weights: Weights = key(Weights(), "unit costs of length, force and volume, by which alternatives are compared")
    fragility: bool = key(False, "also calculate the fragility before and after the cheapest intervention; requires a [motion]")
    levels: list[Annotated[float, Field(gt=0, le=100)]] = key(
        [0.25, 0.5, 0.75, 1.0, 1.5, 2.0, 3.0], "scale factors of the motions for these fragility curves", min_length=2, max_length=50
    )
    assess: bool = key(
        False, "also assess the building, and each strengthened building, by every strategy that applies; requires a [motion]"
    )
    budget: float = key(20.0, "time limit of each of these assessments, in s", ge=5, le=1e6)

    @model_validator(mode="after")
    def _target(self) -> "Strengthen":
        given = [n for n in ("acceleration", "safety_factor", "probability") if getattr(self, n) is not None]
        if len(given) != 1:
            raise ValueError("give exactly one target: `acceleration`, `safety_factor` or `probability`")
        if (self.by == "fragility") != (self.probability is not None):
            raise ValueError('the key `probability` requires by = "fragility", and by = "fragility" requires the key `probability`')
        if self.acceleration is not None and self.by != "tilt":
            raise ValueError(f'the target `acceleration` requires by = "tilt"; with by = "{self.by}", give a `safety_factor`')
        if self.by == "tilt" and self.options:
            raise ValueError('options: with by = "tilt", give the keys of this table directly in the table of the analysis')
        if "levels" in self.model_fields_set and not self.fragility:
            raise ValueError("levels: needs fragility = true")
        if "budget" in self.model_fields_set and not self.assess:
            raise ValueError("budget: needs assess = true")
        return self

    @property
    def measuring(self) -> Analysis | None:
        """The table of the analysis that measures the target; None for limit analysis, or where the options are wrong."""
        if self.by == "tilt":
            return None
        try:
            found: Analysis = kinds.table("analysis", self.by).model_validate({"kind": self.by, **self.options})
        except ValidationError:
            return None
        return found

    def rests_on(self, building: "Building") -> dict[str, str | None]:
        """The properties on which the measure of the target rests."""
        other = self.measuring
        return super().rests_on(building) if other is None else other.rests_on(building)

    def reckons_with(self, building: "Building") -> set[str]:
        """Those that change the measure of the target, and what is asked of supports."""
        other = self.measuring
        found = super().reckons_with(building) if other is None else other.reckons_with(building)
        return {*found, *self.beside}
