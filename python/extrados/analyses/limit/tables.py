"""Analysis kinds of limit analysis: tilt, thrust, sweep, survey, imperfections, supports, moving load."""

from typing import TYPE_CHECKING, ClassVar, Literal

from pydantic import model_validator

from extrados.analyses.table import Animated, BuildingAnalysis
from extrados.schema.quantities import Angle, Force, Gravities, Length, LineForce
from extrados.schema.table import Table, key

if TYPE_CHECKING:
    from extrados.views.building import Building


class AppliedLoad(Table):
    """A load on the structure: at a place, or spread from x to x_end; upright, oblique or horizontal; it may sway."""

    x: Length = key(
        about="x of the load. The load acts on the highest block at this x, or on the block at `y`. On the fill of a bridge, a load without "
        "`y` is spread by the fill"
    )
    force: Force = key(0.0, "vertical force, downward; for a distributed load, its total")
    horizontal: Force = key(0.0, "horizontal force, towards +x; for a distributed load, its total")
    x_end: Length | None = key(None, "x of the end of a distributed load, which starts at `x` and is uniform per length of plan")
    y: Length | None = key(
        None, "height at which the load acts; default: the surface of the highest block. In space: the second coordinate in plan"
    )
    z: Length | None = key(None, "in space: height at which the load acts; default: the surface of the highest block")
    sways: bool = key(False, "whether the weight of the load is accelerated with the ground, like the weight of a floor or a roof")

    @model_validator(mode="after")
    def _acts(self) -> "AppliedLoad":
        if self.force == 0.0 and self.horizontal == 0.0:
            raise ValueError("give force, horizontal, or both")
        if self.x_end is not None and self.x_end <= self.x:
            raise ValueError("`x_end` must be greater than `x`")
        if self.sways and self.force <= 0.0:
            raise ValueError("sways = true requires a weight: give `force` above 0")
        return self


class LimitAnalysisTable(BuildingAnalysis):
    """What all questions of limit analysis ask."""

    uses: ClassVar[tuple[str, ...]] = ("material.density", "material.compressive_strength", "joints.friction")
    considers: ClassVar[tuple[str, ...]] = ("[[ties]]",)
    friction_rule: Literal["associated", "non-associated"] = key(
        "associated",
        'rule for sliding joints. "associated": sliding dilates, and the result is an upper bound; '
        '"non-associated": sliding does not dilate, and the lowest of many possible collapse states is '
        "searched",
        source="Ferris and Tin-Loi 2001; Gilbert, Casapulla and Ahmed 2006",
    )
    starts: int = key(
        6,
        'for "non-associated": number of starting points of the search; the result is the lowest collapse acceleration found',
        ge=1,
        le=1000,
    )
    load: list[AppliedLoad] = key(
        [], "constant loads in addition to self-weight and fill; with `sways`, the ground also accelerates their weight", max_length=1000
    )


class SpatialLimit(LimitAnalysisTable):
    """Questions of limit analysis that are also asked of blocks in space."""

    solid: ClassVar = True
    fracture: bool = key(
        False,
        "repeat the calculation with a crack in the leeward buttress; figures show the uncracked and the cracked structure side by side",
    )
    direction: Angle | None = key(
        None,
        "direction of the horizontal load in plan: angle from +x towards +y (+y is across a plane section). If this key is given, or if "
        "the structure has no plane section, the blocks are analysed as solids",
        ge=-360,
        le=360,
    )


class Tilt(SpatialLimit, Animated):
    """Limit analysis: the horizontal acceleration and tilt at which the structure becomes a mechanism."""

    kind: Literal["tilt"]
    fracture: bool = key(
        False,
        "repeat the calculation with a crack in the leeward buttress; figures show the uncracked and the cracked structure side by side",
    )
    rose: int | None = key(
        None,
        "for solids: number of directions, at equal angles all around, in which the capacity is "
        "searched; default 16 for up to 300 blocks; above that, only the given direction",
        ge=4,
        le=720,
    )
    mortar: Literal["neglected", "ductile"] = key(
        "neglected",
        'cohesion and tension of the joints. "neglected": dry joints; "ductile", for solids: the joints keep cohesion and tension '
        'until collapse. Real mortar is brittle: "ductile" gives an upper bound, and the result for dry joints is also given',
    )
    face_law: bool | None = key(
        None,
        "for solids: also calculate the capacity with uniform pressure on contact faces, which reduces the resistance to torsion; "
        "default: true if contacts slide and the structure has at most 80 contacts",
        source="after Orduna and Lourenco 2005",
    )
    block_size: bool | None = key(
        None,
        "for solids: also calculate the capacity with blocks of half the length (in each direction separately), and with each of the "
        "other bonds",
    )
    pyramids: int | None = key(
        None,
        "for solids: also calculate bounds with inscribed and circumscribed friction pyramids of this number of sides, instead of "
        "friction cones",
        ge=3,
        le=64,
    )

    def rests_on(self, building: "Building") -> dict[str, str | None]:
        """Mortar counts where it lasts."""
        mortar = ("joints.cohesion", "joints.tension") if self.mortar == "ductile" else ()
        return super().rests_on(building) | dict.fromkeys(mortar)


class Section(Table):
    """A section of blocks in space whose thrust is sought: a plane cut, or named contacts."""

    name: str = key(about="name of the section", max_length=80)
    x: Length | None = key(
        None, "x of a vertical cut. Its section is all contacts between blocks with centroids on different sides of the cut"
    )
    y: Length | None = key(None, "y of a vertical cut, as an alternative to `x`")
    z: Length | None = key(None, "height of a horizontal cut, as an alternative to `x`")
    joints: list[str] | None = key(
        None, 'names of contacts, or of groups of contacts, instead of a cut; "ground" means all supports', min_length=1, max_length=10000
    )
    toward: Angle | None = key(
        None,
        "direction of the thrust in plan: angle from +x towards +y. The thrust of a vertical cut acts on the blocks at greater x or y; any "
        "other thrust acts on the blocks or the ground below. Default: perpendicular to a vertical cut, otherwise outward from the "
        "middle of the structure",
        ge=-360,
        le=360,
    )

    @model_validator(mode="after")
    def _one_cut(self) -> "Section":
        if sum(one is not None for one in (self.x, self.y, self.z, self.joints)) != 1:
            raise ValueError("expected one of the keys `x`, `y`, `z` and `joints`")
        return self


class Thrust(SpatialLimit):
    """Thrust lines at a given horizontal acceleration: minimum, maximum and most central thrust, geometric safety factor, reactions."""

    kind: Literal["thrust"]
    gamma: Gravities = key(
        0.0, "horizontal acceleration (towards +x, or along `direction`) for which the thrust lines are drawn", ge=-5, le=5
    )
    chain: str | None = key(
        None, "name of the arch or column of blocks whose minimum and maximum thrust are calculated; default: the first arch, vault or nave"
    )
    section: list[Section] = key(
        [],
        "for solids: sections whose minimum and maximum thrust are calculated, [[analysis.section]]; "
        "default: cuts across x and y through the middle, and the ground",
        max_length=50,
    )


class ThrustNetwork(BuildingAnalysis):
    """Thrust networks in a vault or dome on a form diagram in plan: minimum and maximum thrust, safety, horizontal load."""

    kind: Literal["thrust-network"]
    structures: ClassVar = ("arch", "pointed-arch", "elliptical-arch", "blocks", "dome", "cross-vault")
    solid: ClassVar = True
    uses: ClassVar[tuple[str, ...]] = ("material.density", "joints.friction")
    starter_structure: ClassVar[str] = "dome"
    starter: ClassVar = {"lines": "5", "meridians": "8"}
    form: Literal["radial", "grid", "crossed"] | None = key(
        None,
        "form diagram in plan. radial: meridians and hoops; grid: lines along x and y; crossed: a grid "
        "with both diagonals. Default: radial for a dome, crossed for a cross vault, otherwise grid",
        source="O'Dwyer 1999; Block and Ochsendorf 2007",
    )
    lines: int = key(10, "number of branches along the longer side of the plan, or along a meridian", ge=2, le=60)
    meridians: int = key(16, "number of meridians of a radial diagram", ge=4, le=90)
    direction: Angle = key(0.0, "direction of the horizontal load in plan: angle from +x towards +y", ge=-360, le=360)


class Sweep(SpatialLimit):
    """Variation of one key of the deck: capacity, mechanism and its changes, optimum (thesis Figs 3-4, 3-6a, 3-7b)."""

    kind: Literal["sweep"]
    starter: ClassVar = {"vary": '"thickness"', "start": "0.4", "stop": "1.2"}
    vary: str = key(
        about="key to vary. A key of [structure] is written without its table: `buttress_width`, "
        "`right.buttress_width` or `spans.0.rise`. Any other key is written with its table: "
        "`joints.friction`, `material.compressive_strength` or `ties.0.yield_force`. For solids also "
        "`direction`, the direction of the load"
    )
    start: float | str | None = key(None, 'first value of the key in `vary`, in its unit, or as text such as "40 cm"')
    stop: float | str | None = key(None, "last value of the key in `vary`")
    count: int = key(41, "number of values from start to stop", ge=2, le=2000)
    values: list[float | str] | None = key(None, "values of the key in `vary`; replaces `start` and `stop`", min_length=2, max_length=2000)
    fracture: bool = key(False, "repeat the calculation with a crack in the leeward buttress")
    buttress_alone: bool = key(False, "also calculate the leeward buttress alone, as a separate structure", source="thesis Fig. 3-4b")
    locate: bool | None = key(
        None,
        "also locate precisely the values at which the mechanism changes, the optimum, and the ends of "
        "the range in which the structure stands; default: true in a plane section",
    )

    @model_validator(mode="after")
    def _range(self) -> "Sweep":
        if (self.values is None) == (self.start is None or self.stop is None):
            raise ValueError("give either the key `values`, or the keys `start` and `stop`")
        return self


class Survey(SpatialLimit):
    """Limit analysis of many sections from a CSV table, with one row of results for each section."""

    kind: Literal["survey"]
    starter: ClassVar = {"file": '"extrados:example-sections"'}
    file: str = key(
        about="CSV file in the folder of the deck. Its header contains keys of [structure] (lengths in m); "
        "each row gives one section, or one file of solids"
    )
    fracture: bool = key(False, "repeat the calculation with a crack in the leeward buttress")


class Imperfections(SpatialLimit):
    """Capacity for random geometries of the same blocks. Each point lies within the deviation of the survey."""

    kind: Literal["imperfections"]
    starter: ClassVar = {"deviation": '"5 mm"'}
    deviation: Length | None = key(
        None, "greatest distance of a measured point from its true position; default: `contact_tolerance` of the `blocks`", gt=0, le=1
    )
    count: int = key(200, "number of random geometries", ge=10, le=100000)
    seed: int = key(1, "seed of the random numbers", ge=0)


class MovingSupports(BuildingAnalysis, Animated):
    """Movement of supports: joints that open in any structure. An arch is followed through its three-hinge states to collapse.

    [[initial.movements]] gives the movements; without this table, the right support moves.
    """

    kind: Literal["supports"]
    beside: ClassVar = ("material.density", "joints.friction", "initial.movements")
    considers: ClassVar[tuple[str, ...]] = ("[[ties]]",)
    spread: float = key(
        1.0, "outward component of the movement of the right support; only the ratio of `spread` to `settle` matters", ge=-10, le=10
    )
    settle: float = key(
        0.0, "downward component of the movement of the right support; only the ratio of `spread` to `settle` matters", ge=-10, le=10
    )
    movement: Length | None = key(
        None,
        "size of the movement of the right support. Not used for an arch without ties: its support moves until the arch collapses. "
        "Default: 1/1000 of the width",
        gt=0,
    )
    steps: int = key(200, "for an arch: number of steps from the start of the movement to collapse", ge=10, le=5000)

    def reckons_with(self, building: "Building") -> set[str]:
        """Through its three-hinge states an arch opens alone, and does not slide."""
        found = super().reckons_with(building)
        if not building.initial.movements and not building.ties and building.one_arch:
            found.discard("joints.friction")
        return found


#: Trains of trains.toml, and LM1, whose loads depend on the width
TrainName = Literal[
    "LM1",
    "LM71",
    "SW/0",
    "SW/2",
    "SV80",
    "SV100",
    "SV196",
    "CS454 single",
    "CS454 double 1.0",
    "CS454 double 1.3",
    "CS454 double 1.8",
    "CS454 triple 1.0",
    "CS454 triple 1.3",
    "CS454 double 1.0 lift",
    "CS454 double 1.3 lift",
    "CS454 double 1.8 lift",
    "CS454 triple 1.3 lift",
    "MLC30 tracked",
    "MLC40 tracked",
    "MLC50 tracked",
    "MLC60 tracked",
    "MLC70 tracked",
    "MLC80 tracked",
    "MLC100 tracked",
]


class UniformLoad(Table):
    """A load spread evenly along a train, over all of the width that carries it."""

    start: Length | None = key(
        None,
        "start of the uniform load: distance behind the first axle (without axles: behind the position of the train); default: unlimited",
    )
    stop: Length | None = key(
        None,
        "end of the uniform load: distance behind the first axle (without axles: behind the position of the train); default: unlimited",
    )
    load: LineForce = key(about="load per length of bridge", gt=0)


class PartialFactors(Table):
    """Partial factors: actions are multiplied by theirs, strength and friction divided by theirs."""

    masonry: float = key(1.0, "partial factor on the weight of the blocks", gt=0, le=10)
    fill: float = key(1.0, "partial factor on the weight of the fill", gt=0, le=10)
    surfacing: float = key(1.0, "partial factor on the weight of the surfacing", gt=0, le=10)
    live: float = key(1.0, "partial factor on the moving load", gt=0, le=10)
    dynamic: float = key(1.0, "dynamic factor of the moving load, by which the load is multiplied in addition to `live`", gt=0, le=10)
    strength: float = key(1.0, "partial factor by which the compressive strength is divided", gt=0, le=10)
    friction: float = key(1.0, "partial factor by which the coefficients of friction are divided", gt=0, le=10)


class Serviceability(Table):
    """A permissible limit state beside the collapse load: repeated traffic does not damage the structure progressively."""

    strength_share: float = key(
        0.5, "permissible compressive stress, divided by the compressive strength; the default is a choice of this program", gt=0, le=1
    )
    passive_share: float = key(
        0.0,
        "share of the passive pressure (`passive` of the fill) that acts under service loads, which cause only small movements",
        ge=0,
        le=1,
    )
    live: float = key(1.0, "factor on the moving load under service conditions, in addition to `dynamic` of the factors", gt=0, le=10)


class MovingLoad(LimitAnalysisTable):
    """Moving load (a load, axles or a train): the load that causes collapse, at every position."""

    kind: Literal["moving-load"]
    chain: str | None = key(
        None, "arch that the load crosses; default: the first arch, vault or nave. On a bridge, the load crosses the whole top"
    )
    train: TrainName | None = key(
        None,
        "load model that replaces axles and loads: EN 1991-2, a special vehicle of its UK annex, an axle or bogie of CS "
        "454, or a tracked vehicle of a military class",
        source="EN 1991-2 4.3.2, 6.3.2, 6.3.3; SV: UK National Annex to EN 1991-2 (verify clause); CS 454 7.3.1; STANAG 2021 (verify)",
    )
    gap: Length | None = key(None, "gap between the bogies of an SV vehicle: 1.2 (the default), 5 or 9 m", ge=1.2, le=9.0)
    axles: list[Length] = key([0.0], "distance of each axle behind the first axle", max_length=200)
    shares: list[float] | None = key(None, "share of the load on each axle; default: equal shares", max_length=200)
    force: Force | None = key(None, "total load of the axles; the results then include the safety factor", gt=0)
    axle_loads: list[Force] | None = key(None, "load of each axle; replaces `shares` and `force`", max_length=200)
    uniform: list[UniformLoad] = key([], "uniform loads along the train; these require `axle_loads`, or axles = []", max_length=50)
    adverse: bool = key(
        True,
        "true: distributed loads act only over the lengths on which they drive the mechanism (adverse "
        "lengths); false: they act over their whole length",
    )
    alpha: float = key(1.0, "adjustment or classification factor of the train", gt=0, le=10)
    lanes: int | None = key(None, "number of notional lanes that LM1 loads; default: all that fit into the width", ge=1, le=20)
    width: Length | None = key(None, "transverse width over which the load is carried; at most the depth of the structure", gt=0)
    contact_length: Length = key(0.3, "for a bridge with fill: contact length of an axle on the road, along the bridge", gt=0)
    factors: PartialFactors = key(PartialFactors(), "partial factors")
    serviceability: Serviceability | None = key(
        None,
        "permissible limit state: greatest multiple of the train for which a thrust line exists with "
        "stresses below a share of the compressive strength; requires `compressive_strength`",
    )
    both_ways: bool = key(False, "whether the train also crosses in the opposite direction (towards -x, first axle in front)")
    count: int = key(
        81, "number of positions of a load that crosses the span; increased in proportion for a train longer than the span", ge=3, le=2000
    )
    places: list[Length] | None = key(None, "positions of the first axle; these replace `count`", min_length=1, max_length=2000)

    @model_validator(mode="after")
    def _axles(self) -> "MovingLoad":
        given = self.model_fields_set
        if self.shares is not None and (len(self.shares) != len(self.axles) or min(self.shares) <= 0.0):
            raise ValueError("shares: expected one number above 0 for each of the axles")
        if self.axle_loads is not None and (len(self.axle_loads) != len(self.axles) or min(self.axle_loads) <= 0.0):
            raise ValueError("axle_loads: expected one load above 0 for each of the axles")
        if self.train is not None and given & {"axles", "shares", "force", "axle_loads", "uniform"}:
            raise ValueError(
                "the key `train` replaces `axles`, `shares`, `force`, `axle_loads` and `uniform`: remove either `train` or these keys"
            )
        if self.axle_loads is not None and (self.shares is not None or self.force is not None):
            raise ValueError("axle_loads replaces shares and force")
        if self.uniform and self.axle_loads is None and self.axles:
            raise ValueError("the key `uniform` requires `axle_loads`, or axles = [] if there are no axles")
        if self.serviceability is not None and self.train is None and self.axle_loads is None and not self.uniform:
            raise ValueError("the key `serviceability` requires one of the keys `train`, `axle_loads` and `uniform`")
        if not self.axles and not self.uniform:
            raise ValueError("axles: expected at least one axle, or uniform loads")
        if self.lanes is not None and self.train != "LM1":
            raise ValueError('`lanes` is used only with train = "LM1": remove `lanes`')
        if self.gap is not None and not (self.train or "").startswith("SV"):
            raise ValueError("`gap` is used only with the trains SV80, SV100 and SV196: remove `gap`")
        if self.gap not in (None, 1.2, 5.0, 9.0):
            raise ValueError(f"gap: expected 1.2, 5 or 9 m, found {self.gap:g}")
        for one in self.uniform:
            if one.start is not None and one.stop is not None and one.stop <= one.start:
                raise ValueError("uniform: expected stop behind start")
        return self
