"""The deck tables of sequentially linear analysis."""

from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from pydantic import Field, field_validator, model_validator

from extrados.analyses.codes.tables import Verification
from extrados.analyses.table import Animated, BuildingAnalysis
from extrados.model.places import Placed, Range
from extrados.model.properties import NO_SLIDING, Material
from extrados.schema.constants import GRAVITY
from extrados.schema.quantities import Acceleration, Force, Length, LineForce, Stress
from extrados.schema.table import Table, key
from extrados.views.mesh.options import MeshOptions

if TYPE_CHECKING:
    from extrados.views.building import Building


class Part(Placed):
    """Nodes of a prescribed displacement."""

    ratio: float = key(1.0, "displacement of these nodes, as a multiple of the imposed displacement", ge=-1e3, le=1e3)


class Load(Table):
    """One load; which keys it takes depends on its kind."""

    kind: Literal["gravity", "pressure", "line", "point", "spread", "displacement"] = key(
        about="kind of load. gravity: self-weight; pressure: pressure on boundary edges; line: force per length on "
        "boundary edges; point: force on the nearest node, or on all nodes of a place in equal parts; spread: "
        "force spread evenly along an edge; displacement: imposed displacement with ratios"
    )
    edge: Literal["left", "right", "bottom", "top"] | None = key(None, "outer edge of the wall")
    x: Range | None = key(None, "x of the place, or its range [from, to]")
    y: Range | None = key(None, "y of the place, or its range [from, to]")
    ax: Acceleration = key(0.0, 'for kind = "gravity": acceleration towards +x')
    ay: Acceleration = key(-GRAVITY, 'for kind = "gravity": acceleration towards +y')
    value: Stress = key(0.0, 'for kind = "pressure": value of the pressure; positive if it acts onto the wall')
    px: LineForce = key(0.0, 'for kind = "line": force per length towards +x')
    py: LineForce = key(0.0, 'for kind = "line": force per length towards +y')
    fx: Force = key(0.0, 'for kind = "point" or "spread": force towards +x')
    fy: Force = key(0.0, 'for kind = "point" or "spread": force towards +y')
    direction: Literal["x", "y"] = key("x", 'for kind = "displacement": direction of the displacement')
    parts: list[Part] = key(
        [], 'for kind = "displacement": places that move together, with the ratios of their displacements', max_length=50
    )

    @model_validator(mode="after")
    def _complete(self) -> "Load":
        own = {
            "gravity": {"ax", "ay"},
            "pressure": {"edge", "x", "y", "value"},
            "line": {"edge", "x", "y", "px", "py"},
            "point": {"edge", "x", "y", "fx", "fy"},
            "spread": {"edge", "x", "y", "fx", "fy"},
            "displacement": {"direction", "parts"},
        }[self.kind]
        strange = self.model_fields_set - own - {"kind"}
        if strange:
            raise ValueError(f"a load of kind {self.kind} takes {', '.join(sorted(own))}, not {', '.join(sorted(strange))}")
        if self.kind == "displacement":
            if not self.parts:
                raise ValueError("a load of kind displacement requires parts = [{edge = ..., ratio = ...}, ...]")
        elif self.kind != "gravity" and self.edge is None and self.x is None and self.y is None:
            raise ValueError(f"the place of the {self.kind} load is missing: give `edge`, `x` or `y`")
        return self


class Watch(Placed):
    """A displacement that is followed: the mean of the place's nodes times `weight`."""

    direction: Literal["x", "y"] = key("x", "direction of the displacement")
    weight: float = key(1.0, "weight of this term in the sum; a value other than 0")

    @field_validator("weight")
    @classmethod
    def _counts(cls, weight: float) -> float:
        if weight == 0.0:
            raise ValueError("a term with weight 0 has no effect: remove the term")
        return weight


class Hold(Placed):
    """Nodes of a stage that are held or let go."""

    fix: Literal["x", "y", "xy"] = key("xy", "directions in which the place is held")


class Stage(Table):
    """One stage of several: what changes of the supports, and the loads that grow. It starts in the state in which the one
    before it ended: its displacements, its loads and its damage."""

    name: str | None = key(None, "name of the stage, in figures and results; default: its number", min_length=1, max_length=40)
    hold: list[Hold] = key([], "places that are held from the start of this stage, at their positions at this start", max_length=100)
    free: list[Hold] = key(
        [],
        "supports (of the building, or of an earlier stage) that are removed in this stage. Their "
        "reactions decrease to zero as lambda increases to 1",
        max_length=100,
    )
    reference: list[Load] = key(
        [],
        "loads B of this stage, multiplied by lambda. Alternatively one imposed displacement: places "
        "(also supports) move from their present positions, and are held at the end",
        max_length=100,
    )
    control: list[Watch] = key(
        [],
        "control displacement of the curve, as a sum of terms; default: that of the analysis, or the mean displacement under loads B",
        max_length=50,
    )
    target_multiplier: Annotated[float, Field(gt=0)] | None = key(
        None, "value of lambda at which the stage ends; its loads then remain. With `free` supports, lambda = 1 removes them fully"
    )
    target_displacement: Length | None = key(None, "control displacement at which the stage ends exactly, measured from the unloaded wall")
    stop_fraction: float = key(0.0, "the stage ends when the load drops below this share of its peak in the stage", ge=0, lt=1)
    events: int | None = key(None, "greatest number of events of the stage; default: that of the analysis", ge=1, le=10_000_000)

    @model_validator(mode="after")
    def _one_cause(self) -> "Stage":
        if self.free and self.reference:
            raise ValueError(
                "the keys `free` and `reference` exclude each other, because the removed supports are the load "
                "of their stage: give two stages"
            )
        if not (self.free or self.reference):
            raise ValueError("a stage requires a load that increases: give the key `reference`, or the key `free`")
        if sum(load.kind == "displacement" for load in self.reference) and len(self.reference) > 1:
            raise ValueError(
                "if `reference` contains an imposed displacement, it can contain no other load. To impose the "
                "displacement at more places, list them under `parts` of this load"
            )
        return self

    @property
    def moves(self) -> bool:
        """Whether it moves places, rather than loading them."""
        return any(load.kind == "displacement" for load in self.reference)


#: What finite elements look at of every material, and of joints between stones
MATERIAL = tuple(f"material.{name}" for name in Material.model_fields)
ROWS = ("joints.tension", "joints.fracture_energy", "joints.normal_stiffness", "supports.stiffness")
INTERFACES = (
    *ROWS,
    "joints.friction",
    "joints.cohesion",
    "joints.shear_energy",
    "joints.compressive_strength",
    "joints.crushing_energy",
    "joints.softening",
    "joints.shear_stiffness",
    "joints.shear_ratio",
)


def without_effect(building: "Building") -> set[str]:
    """Keys of its materials that say how something cracks or crushes which none of them lets crack or crush."""
    given, found = [building.material, *building.materials.values()], set()
    crush = any(m.crushing_energy is not None for m in given)
    if not crush and not any(m.lateral_reduction for m in given):
        found.add("material.compressive_strength")
    if not crush:
        found.add("material.crushing")
    if not any(m.compressive_strength_parallel is not None for m in given):
        found |= {"material.compressive_coupling", "material.compressive_shear"}
    if not any(m.tensile_strength is not None for m in given):
        found |= {"material.softening", "material.lateral_reduction"}
    return found


class CrackOptions(Table):
    """How cracking masonry softens, and how cracks stand, in every analysis that is sequentially linear."""

    teeth: Literal["exact", "ripple"] = key(
        "exact",
        "rule for the teeth of the saw-tooth law: teeth with the exact fracture energy, or the ripple rule of the thesis",
        source="thesis 4.2",
    )
    ripple: float = key(
        0.05,
        "half-width p of the teeth, divided by the strength; the load is overestimated by up to about p/2. The thesis uses 0.1 and 0.2",
        source="thesis 4.2",
        ge=0.005,
        le=0.5,
    )
    overshoot: bool = key(True, "true: the first tooth rises above the strength; false: the first tooth ends at the strength")
    crack_band: Length | None = key(None, "width h of the crack band; default: by `crack_band_rule`", gt=0)
    crack_band_rule: Literal["projected", "extent", "area"] = key(
        "projected",
        "rule for the width of the crack band. projected: the width of a row of elements across the crack; extent: the extent of the "
        "element across the crack, for cracks oblique to the mesh that open every element on their path; area: the rule of the thesis, "
        "sqrt(2 A) for linear and sqrt(A) for quadratic elements of area A",
    )
    cracking: Literal["rotating", "orthotropic", "isotropic"] = key(
        "rotating",
        "kind of cracking. rotating: cracks rotate with the principal strain; orthotropic: cracks have a fixed direction from their "
        "first tooth, as in the thesis (overestimates the capacity, see docs/sla.md); isotropic: isotropic damage",
        source="Eq. 4.10",
    )
    shear_retention: Annotated[float, Field(ge=1e-6, le=1)] | None = key(
        None,
        "shear retention factor of cracked points, as a constant; default: from the smaller modulus of both directions",
        source="Eq. 4.11",
    )


class Staged:
    """What the event loop takes from the table of an analysis, and its stages one after the other: their names, and what cannot
    stand beside them."""

    if TYPE_CHECKING:
        stages: list[Any]
        main_stage: str | None
        directions: list[Literal["+", "-"]]
        constant_damage: bool
        events: int
        target_displacement: float | None
        stop_fraction: float
        budget: float | None
        without_equilibrium: Literal["continue", "load-unload", "proportional", "force-release"]
        continuation: Literal["newton", "steps", "implicit-explicit", "dissipation"]
        states: list[int]
        probes: list[float]

        @property
        def solution(self) -> str: ...
        @property
        def algorithm(self) -> str: ...

    @property
    def stage_names(self) -> list[str]:
        """The names of the stages, their numbers where they have none."""
        return [stage.name or str(k) for k, stage in enumerate(self.stages, 1)]

    def check_stages(self, alone: dict[str, bool]) -> None:
        """ValueError where a name stands twice, `main_stage` is none of them, or something is given that only stands `alone`."""
        names = self.stage_names
        if not self.stages:
            if self.main_stage is not None:
                raise ValueError("`main_stage` is given without stages: give `stages`, or remove `main_stage`")
            return
        if len(set(names)) < len(names):
            raise ValueError(f"stages: a name occurs twice among {', '.join(names)}")
        if self.main_stage is not None and self.main_stage not in names:
            raise ValueError(f"main_stage: stage '{self.main_stage}' does not exist; expected one of {', '.join(names)}")
        if clash := [name for name, given in alone.items() if given]:
            raise ValueError(f"{', '.join(clash)} cannot be used together with stages: give them in a stage, or run without stages")


class Sla(Staged, CrackOptions, BuildingAnalysis, Animated):
    """Sequentially linear analysis: cracks, event by event, under constant loads A and increasing loads lambda B."""

    kind: Literal["sla"]
    view: ClassVar = "mesh"
    considers: ClassVar = ("[[ties]]",)
    uses: ClassVar = (
        "material.density",
        "material.young",
        "material.poisson",
        "material.tensile_strength",
        "material.fracture_energy",
        "material.compressive_strength",
        "material.tensile_strength_parallel",
        "material.shear_strength",
        "joints.tension",
    )
    beside: ClassVar = (*MATERIAL, *INTERFACES, "supports.held")
    starter_structure: ClassVar = "panel"
    starter: ClassVar = {"target_displacement": '"2 mm"', "ripple": "0.2"}

    def rests_on(self, building: "Building") -> dict[str, str | None]:
        """Also, of stones, their friction and cohesion; or, of joints as rows of elements, that they do not slide."""
        found = super().rests_on(building)
        if self.mesh.joints == "rows":
            return {**found, "joints.friction": NO_SLIDING}
        if building.meshed_by_stones or self.mesh.joints == "interfaces":
            return {**found, "joints.friction": None, "joints.cohesion": None}
        return found

    def reckons_with(self, building: "Building") -> set[str]:
        """Joints are of stones; of thin rows of elements, what opens and does not slide."""
        joints: tuple[str, ...] = ()
        if building.meshed_by_stones or self.mesh.joints is not None:
            joints = (*ROWS, "joints.friction") if self.mesh.joints == "rows" else INTERFACES
        found = {*MATERIAL, "supports.held", *joints} - without_effect(building)
        if building.joints.shear_stiffness is not None:
            found.discard("joints.shear_ratio")
        return found

    constant: list[Load] | None = key(
        None, "loads A, which act from the start; default: the weight, for blocks and for walls without a given reference", max_length=100
    )
    reference: list[Load] | None = key(
        None,
        "loads B, multiplied by lambda; default: all masses times 1 g towards +x, so that lambda is an acceleration in g",
        min_length=1,
        max_length=100,
    )
    constant_damage: bool = key(
        True,
        "true: loads A increase from 0 to 1 and cause damage before loads B act; false: loads B act on the undamaged wall",
        source="thesis 4.3.1",
    )
    directions: list[Literal["+", "-"]] = key(
        ["+"], "senses of loads B (as given, or opposite); each run begins from the same initial state", min_length=1, max_length=2
    )
    stages: list[Stage] = key(
        [],
        "sequence of stages, [[analysis.stages]], instead of `reference`. Each stage has its own supports, loads and end, and keeps the "
        "damage of the stages before. `constant` is applied before the first stage",
        min_length=1,
        max_length=50,
    )
    main_stage: str | None = key(
        None, "name of the stage whose results and figures are reported as those of the analysis; default: the last stage"
    )
    control: list[Watch] = key(
        [], "control displacement of the curve, as a sum of terms; default: the mean displacement under loads B", max_length=50
    )
    mesh: MeshOptions = key(MeshOptions(), "options of the finite elements, [analysis.mesh]")
    events: int = key(5000, "greatest number of events", ge=1, le=10_000_000)
    budget: Annotated[float, Field(ge=0.01, le=1e7)] | None = key(
        None, "processor time in s after which each curve or stage ends with the results so far; default: no limit"
    )
    target_displacement: Length | None = key(None, "the run ends when the control displacement reaches this value", gt=0)
    stop_fraction: float = key(0.0, "the run ends when the load drops below this share of its peak", ge=0, lt=1)
    mechanism_ratio: Annotated[float, Field(ge=10, le=1e12)] | None = key(
        None, "the run ends when the compliance has increased by this factor; default 1e4, for blocks 1e5"
    )
    friction_ripple: float = key(
        0.02, "ripple p of friction: a joint that slides sticks again after a reverse slip of 4 p times its elastic slip", ge=0.001, le=0.1
    )
    crack_closure: bool | None = key(
        None,
        "whether cracks that close regain their stiffness. Default true, with two exceptions: walls with fixed or isotropic cracks, and "
        "walls under a single increasing load without constant loads or stages",
    )
    solution: Literal["events", "incremental"] = key(
        "events",
        "solution method. events: one integration point after the other; incremental, for comparison: steps of arc length with a secant "
        "iteration, in which all overloaded points lose teeth together (the key `events` then limits the number of these steps)",
    )
    without_equilibrium: Literal["continue", "load-unload", "proportional", "force-release"] = key(
        "continue",
        "method after an event for which no multiplier of loads B is admissible at all points. "
        '"continue": equilibrium iterations in displacement control (for rotating cracks without bed '
        'joints and bars, and for joints with mortar; otherwise load-unload). "load-unload": loads A remain, and the '
        'point with the greatest lower limit of lambda is damaged. "proportional": all loads of the last equilibrium state are '
        'reduced together (intermittent proportional loading). "force-release": the force that a tooth '
        "releases acts on the other points before the load increases again",
        source="thesis 4.3.1; Pari, Hendriks and Rots 2020; Elias, Frantik and Vorechovsky 2010",
    )
    continuation: Literal["newton", "steps", "implicit-explicit", "dissipation"] = key(
        "newton",
        "method of the equilibrium iterations. newton: Newton's method, with staggered steps if it does not converge; "
        "steps: as newton, from the first load on, without events; "
        "implicit-explicit: damage is extrapolated from the last step (one convex problem for each step: faster and less accurate); "
        "dissipation: as newton, from the first load on, with an arc length on dissipated energy where the displacement snaps back",
        source="Oliver, Huespe and Cante 2008; Gutierrez 2004",
    )
    algorithm: Literal["update", "refactor"] = key(
        "update", "factorised stiffness matrix at each event. update: the factor is updated; refactor: the matrix is factorised again"
    )
    states: list[Annotated[int, Field(ge=1)]] = key(
        [], "numbers of the events whose state is saved, besides the peak and the last event", max_length=200
    )
    probes: list[Length] = key([], "control displacements at which the load of the envelope is reported", max_length=100)
    measured: str | None = key(
        None,
        "CSV file of a test, with which the calculated curve is compared. Columns: 'displacement (mm)' and 'load (N)', or 'least (N)' "
        "and 'greatest (N)' of several tests; lines that begin with # give the source",
    )
    section_x: list[Length] = key(
        [],
        "x of vertical sections of the wall along which the admissible ranges of lambda (multiplier of loads B) are drawn",
        max_length=10,
    )
    seeds: list[int] = key(
        [], "seeds for repetitions of the analysis with other random meshes and strengths, for a scatter band", max_length=200
    )
    strength_variation: float = key(0.0, "coefficient of variation of the tensile strength (lognormal)", ge=0, le=1)
    strength_length: Length | None = key(None, "correlation length of the random strength; default: one element", gt=0)
    strength_seed: int = key(1, "seed of the random strength", ge=0, le=2**31 - 1)
    verification: Verification = key(
        Verification(),
        "displacement-based verification of a wall that is loaded by the horizontal forces of its own masses towards +x, "
        "[analysis.verification]",
    )
    resume_from: str | None = key(
        None, "results folder of an earlier run of the same wall, from which this run continues; inside the folder of the deck, or absolute"
    )
    resume_event: int | None = key(
        None, "number of an event of the earlier run: this run continues from the damage before that event; default: the last event", ge=1
    )

    @field_validator("directions")
    @classmethod
    def _each_once(cls, directions: list[str]) -> list[str]:
        if len(set(directions)) < len(directions):
            raise ValueError(f"each sense may occur only once, found {directions}")
        return sorted(directions)  # "+" first: the second curve, where there is one, is to -

    @model_validator(mode="after")
    def _consistent(self) -> "Sla":
        if any(load.kind == "displacement" for load in self.constant or []):
            raise ValueError(
                "an imposed displacement cannot be a constant load, because the displaced nodes could then not move "
                "under the loads that increase"
            )
        reference = self.reference or []
        self.check_stages(
            {
                "reference": self.reference is not None,
                "directions": self.directions != ["+"],
                "seeds": bool(self.seeds),
                "target_displacement": self.target_displacement is not None,
                "stop_fraction": self.stop_fraction > 0.0,
                "resume_from": self.resume_from is not None,
                'solution = "incremental"': self.solution == "incremental",
                'without_equilibrium = "proportional"': self.without_equilibrium == "proportional",
                "constant_damage = false": not self.constant_damage,
            }
        )
        if sum(load.kind == "displacement" for load in reference) and len(reference) > 1:
            raise ValueError(
                "if `reference` contains an imposed displacement, it can contain no other load. To impose the "
                "displacement at more places, list them under `parts` of this load"
            )
        if len(set(self.seeds)) < len(self.seeds):
            raise ValueError("seeds: a seed occurs twice, which would give the same wall again")
        if self.shear_retention is not None and self.cracking == "isotropic":
            raise ValueError("isotropic cracking has no shear retention: remove `shear_retention`")
        if self.solution == "incremental" and (self.without_equilibrium not in ("continue", "load-unload") or self.states or self.budget):
            raise ValueError("an incremental solution has no events: remove `without_equilibrium`, `states` and `budget`")
        if self.verification.model_fields_set and not self.by_inertia:
            raise ValueError("the key `verification` requires that the horizontal force of the masses is the only load, without stages")
        if self.verification.shape == "mode":
            raise ValueError('verification: shape = "mode" is only for buildings: remove `shape`')
        return self

    @property
    def by_inertia(self) -> bool:
        """Whether the wall is pushed once and horizontally by its masses."""
        loads = self.reference or []
        return not self.stages and all(load.kind == "gravity" and load.ay == 0.0 for load in loads)

    @property
    def main(self) -> int:
        """The stage that stands for the analysis, from 0."""
        return self.stage_names.index(self.main_stage) if self.main_stage is not None else len(self.stages) - 1
