"""The deck table of the push of a building."""

from typing import TYPE_CHECKING, Annotated, ClassVar, Literal

from pydantic import Field, model_validator

from extrados import kinds
from extrados.analyses.codes.tables import Verification
from extrados.analyses.sla.tables import INTERFACES, MATERIAL, CrackOptions, Staged, without_effect
from extrados.analyses.table import BuildingAnalysis
from extrados.model.places import Range
from extrados.schema.quantities import Angle, Force, Length, Stress
from extrados.schema.table import Table, key
from extrados.views.shell.options import ShellOptions

if TYPE_CHECKING:
    from extrados.views.building import Building


class Drive(Table):
    """Nodes that are pushed by a given part of one displacement."""

    wall: str = key(about="name of the wall", min_length=1, max_length=40)
    storey: int = key(about="storey on whose top the displacement acts", ge=1)
    ratio: float = key(1.0, "displacement of this place, as a multiple of the control displacement", gt=0, le=1e3)


class Settlement(Table):
    """Ground that gives way under a wall or a springing: it goes down, or outward; the damage stays."""

    wall: str | None = key(None, "name of the wall above the support that moves", min_length=1, max_length=40)
    foot: str | None = key(
        None,
        "for a vault: name of the support that moves (left or right, springing of a dome, north-east and "
        "so on of a groin vault, a support of a mesh file, or all)",
        min_length=1,
        max_length=200,
    )
    x: Range | None = key(None, "[from, to] along the wall; default: the whole wall")
    down: Length = key(0.0, "downward displacement; a negative value is a heave")
    out: Length = key(
        0.0, "outward displacement; for a wall: perpendicular to the wall, away from the middle of the plan; for a dome: radial"
    )

    @model_validator(mode="after")
    def _somewhere(self) -> "Settlement":
        if (self.wall is None) == (self.foot is None):
            raise ValueError("expected either the key `wall` (for a building) or the key `foot` (for a vault)")
        if self.down == 0.0 and self.out == 0.0:
            raise ValueError("the support does not move: give the key `down` or the key `out`")
        return self

    @property
    def place(self) -> str:
        """The foot it is under."""
        return self.wall or str(self.foot)


class PushStage(Table):
    """One stage of several: ground that gives way, or a push. It starts where the one before it ended, with its loads, its
    displacements and its damage."""

    name: str | None = key(None, "name of the stage; default: its number", min_length=1, max_length=40)
    settlements: list[Settlement] = key(
        [], "settlements of the ground in this stage; if none are given, the stage applies a horizontal load", max_length=100
    )
    direction: Angle | None = key(None, "direction of the load in plan; default: the direction of the analysis", ge=-360, le=360)
    sense: Literal["+", "-"] = key("+", "sense of the load")
    base_shear: Force | None = key(
        None,
        "base shear at which the stage ends, in the direction of its load, including loads that remain "
        "from earlier stages; 0 removes an earlier load in the opposite direction",
    )
    target_displacement: Length | None = key(None, "control displacement at which the stage ends, measured from the building without loads")
    stop_fraction: float = key(0.0, "the stage ends when the load drops below this share of its peak in the stage", ge=0, lt=1)
    events: int | None = key(None, "greatest number of events of the stage; default: that of the analysis", ge=1, le=100_000_000)

    @model_validator(mode="after")
    def _one_cause(self) -> "PushStage":
        own = {"direction", "sense", "base_shear", "target_displacement", "stop_fraction"} & self.model_fields_set
        if self.settlements and own:
            raise ValueError(
                f"{', '.join(sorted(own))} are keys of a stage with a horizontal load. A stage of settlements "
                "ends when the settlements reach their values: give two stages"
            )
        return self


class Variant(Table):
    """The same push of a building of which something else is assumed: factors on what the deck says."""

    name: str = key(about="name in figures and results", min_length=1, max_length=40)
    strength: float = key(1.0, "factor on the tensile strength of all materials", gt=0, le=100)
    energy: float = key(1.0, "factor on the fracture energy of all materials", gt=0, le=1000)
    young: float = key(1.0, "factor on the modulus of elasticity of all materials", gt=0, le=100)
    density: float = key(1.0, "factor on the density of all materials", gt=0, le=100)
    thickness: float = key(1.0, "factor on the thickness of all walls and vaults (not of floors)", gt=0, le=10)
    floors: float = key(1.0, "factor on the stiffness of flexible floors and joists", gt=0, le=1e6)
    prestress: float = key(1.0, "factor on the forces on top of the walls", ge=0, le=100)


class FrameRules(Table):
    """Strengths of piers by formulas of codes, beside the push: the equivalent frame's storeys."""

    cohesion: Stress = key(0.0, "shear strength of bed joints at zero compression", ge=0)
    friction: float = key(0.4, "coefficient of friction of bed joints", ge=0, le=1.5)
    diagonal_strength: Stress = key(
        about="tau_0 of diagonal cracking: shear strength at zero compression", gt=0, source="NTC 2018, Circ. 7/2019 C8.5.I"
    )
    compressive_strength: Stress | None = key(None, "compressive strength f_m; default: value of [material]", gt=0)
    fixity: Literal["double", "single"] = key(
        "double",
        "ends of the piers that are fixed against rotation. double: both ends (between stiff spandrels); single: only the lower end",
    )


class Pushover(Staged, CrackOptions, BuildingAnalysis):
    """Pushover of a building of walls and floors, or of a vault or dome, as a shell. The cracks are calculated event by event."""

    kind: Literal["pushover"]
    view: ClassVar = "shell"
    structures: ClassVar = tuple(kind for kind, parts in kinds.STRUCTURES.items() if isinstance(parts.shell, str))
    uses: ClassVar = (
        "material.density",
        "material.young",
        "material.poisson",
        "material.tensile_strength",
        "material.fracture_energy",
        "material.compressive_strength",
        "material.tensile_strength_parallel",
        "material.shear_strength",
    )
    beside: ClassVar = MATERIAL
    starter_structure: ClassVar = "building"
    starter: ClassVar = {"mesh": '{ size = "0.6 m", layers = 3 }', "ripple": "0.2", "events": "1500"}

    direction: Angle = key(0.0, "direction of the load in plan, counter-clockwise from x", ge=-360, le=360)
    directions: list[Literal["+", "-"]] = key(
        ["+"],
        "senses of the load (along and against the direction); each run begins from the same initial state",
        min_length=1,
        max_length=2,
    )
    pattern: Literal["mass", "triangular", "modal"] = key(
        "mass",
        "distribution of the horizontal forces. mass: in proportion to the masses; triangular: in proportion to the masses times their "
        "height; modal: in proportion to the masses times the first mode in this direction",
    )
    drives: list[Drive] = key(
        [],
        "imposed displacements instead of the horizontal forces: the top of each storey of a wall moves "
        "by a given multiple of the control displacement",
        max_length=100,
    )
    control: Drive | None = key(
        None,
        "place whose mean displacement along the load is the control displacement; default: all walls on "
        "the highest level, or all masses if this level is propped",
    )
    settlements: list[Settlement] = key(
        [], "settlements that are imposed in proportion to the weight, [[analysis.settlements]]", max_length=100
    )
    stages: list[PushStage] = key(
        [],
        "sequence of stages, [[analysis.stages]], instead of a single load: horizontal loads in either direction, or settlements. Each "
        "stage keeps the damage of the stages before. The weight is applied first, together with `settlements`",
        min_length=1,
        max_length=50,
    )
    main_stage: str | None = key(
        None,
        "name of the stage whose results are reported as the results of the analysis; default: the last stage with a "
        "horizontal load, otherwise the last stage",
    )
    mesh: ShellOptions = key(ShellOptions(), "options of the finite elements, [analysis.mesh]")
    constant_damage: bool = key(
        True,
        "true: the weight increases from 0 to 1 and causes damage before the horizontal load; false: the horizontal load "
        "acts on undamaged walls",
        source="thesis 4.3.1",
    )
    events: int = key(20_000, "greatest number of events", ge=1, le=100_000_000)
    budget: Annotated[float, Field(ge=0.01, le=1e7)] | None = key(
        None, "processor time in s after which each curve or stage ends with the results so far; default: no limit"
    )
    target_displacement: Length | None = key(None, "the run ends when the control displacement reaches this value", gt=0)
    stop_fraction: float = key(0.0, "the run ends when the load drops below this share of its peak", ge=0, lt=1)
    mechanism_ratio: Annotated[float, Field(ge=10, le=1e12)] = key(1e4, "the run ends when the compliance has increased by this factor")
    crack_closure: bool | None = key(
        None,
        "whether cracks that close regain their stiffness; default: true for rotating cracks followed by "
        "equilibrium iterations, otherwise false",
    )
    without_equilibrium: Literal["continue", "load-unload", "proportional", "force-release"] = key(
        "continue",
        'method after an event for which no load is admissible at all points (see the analysis `sla`). "continue": equilibrium '
        'iterations in displacement control (for rotating cracks, and for joints that slide from the first load on). "load-unload" '
        "(default with stages): the constant loads remain, and the point with the greatest lower limit of the load determines the next "
        "event",
        source="thesis 4.3.1",
    )
    continuation: Literal["newton", "steps", "implicit-explicit", "dissipation"] = key(
        "newton", "method of the equilibrium iterations, as in the analysis `sla`"
    )
    states: list[Annotated[int, Field(ge=1)]] = key(
        [], "numbers of the events whose state is saved, besides the peak and the last event", max_length=200
    )
    probes: list[Length] = key([], "control displacements at which the load of the envelope is reported", max_length=100)
    frame: FrameRules | None = key(None, "strengths of the piers by code formulas, [analysis.frame]")
    verification: Verification = key(
        Verification(), "displacement-based verification of a building given by its plan, [analysis.verification]"
    )
    variants: list[Variant] = key(
        [],
        "sets of changed assumptions, [[analysis.variants]]. The run in the first sense is repeated with each set, which gives a band "
        "of capacity curves",
        max_length=50,
    )
    #: What the events of sla ask for and a push does not offer
    solution: ClassVar = "events"
    algorithm: ClassVar = "update"

    def rests_on(self, building: "Building") -> dict[str, str | None]:
        """Also, where it has joints, their friction, cohesion and tension; of walls in storeys friction and cohesion, which
        limit their sliding."""
        found = super().rests_on(building)
        if getattr(building.structure, "storeys", None):
            found |= {"joints.friction": None, "joints.cohesion": None}
        if getattr(building.structure, "joint_names", []):
            found |= {"joints.friction": None, "joints.cohesion": None, "joints.tension": None}
        return found

    def reckons_with(self, building: "Building") -> set[str]:
        """Walls, floors and shells have materials, and joints where the building says so; walls in storeys slide by friction
        and cohesion; formulas of piers ask for a strength."""
        found = {*MATERIAL} - without_effect(building)
        if getattr(building.structure, "storeys", None):
            found |= {"joints.friction", "joints.cohesion"}
        if getattr(building.structure, "joint_names", []):
            found |= {name for name in INTERFACES if name != "supports.stiffness"}
            if building.joints.shear_stiffness is not None:
                found.discard("joints.shear_ratio")
        if self.frame is not None and self.frame.compressive_strength is None:
            found.add("material.compressive_strength")
        return found

    @model_validator(mode="after")
    def _consistent(self) -> "Pushover":
        if len(set(self.directions)) < len(self.directions):
            raise ValueError(f"directions: each sense may occur only once, found {self.directions}")
        self.check_stages(
            {
                "directions": self.directions != ["+"],
                "drives": bool(self.drives),
                "variants": bool(self.variants),
                "target_displacement": self.target_displacement is not None,
                "stop_fraction": self.stop_fraction > 0.0,
                'without_equilibrium = "proportional"': self.without_equilibrium == "proportional",
                "constant_damage = false": not self.constant_damage,
            }
        )
        if self.settlements and not self.constant_damage:
            raise ValueError("settlements are applied together with the weight: give constant_damage = true")
        if self.drives and self.pattern != "mass":
            raise ValueError("the key `drives` replaces the key `pattern`: remove `pattern`")
        if len({variant.name for variant in self.variants}) < len(self.variants):
            raise ValueError("variants: a name occurs twice")
        if self.shear_retention is not None and self.cracking == "isotropic":
            raise ValueError("isotropic cracking has no shear retention: remove `shear_retention`")
        if self.verification.model_fields_set and (self.stages or self.drives):
            raise ValueError("the key `verification` requires a single load by inertia forces: remove `stages` and `drives`")
        return self

    @property
    def rule(self) -> str:
        """What follows where no load suits all points."""
        staged = self.stages and "without_equilibrium" not in self.model_fields_set
        return "load-unload" if staged else self.without_equilibrium

    @property
    def closes(self) -> bool:
        """Whether cracks that close regain their stiffness."""
        follows = self.rule == "continue" and self.cracking == "rotating"
        return follows if self.crack_closure is None else self.crack_closure

    @property
    def main(self) -> int:
        """The stage that stands for the analysis, from 0."""
        if self.main_stage is not None:
            return self.stage_names.index(self.main_stage)
        pushes = [k for k, stage in enumerate(self.stages) if not stage.settlements]
        return pushes[-1] if pushes else len(self.stages) - 1
