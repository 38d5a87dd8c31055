"""What a building is besides its geometry: [material], [joints], [supports], [initial], said once for every strategy."""

from typing import Annotated, ClassVar, Literal

from pydantic import Field, model_validator

from extrados.model.places import Placed
from extrados.schema.quantities import Angle, Density, Energy, Length, Stiffness, Stress, Time, engineering
from extrados.schema.table import Table, key

#: Coefficient of friction that excludes sliding
NO_SLIDING = "no-sliding"
#: What stands for it where a coefficient must be a number: beside joints that slide, and in discrete elements
NO_SLIDING_COEFFICIENT = 1e3


class Material(Table):
    """The stone or the homogenised masonry: density, elastic constants, and the strengths of what may crack or crush."""

    starter: ClassVar = {"young": '"6.9 GPa"', "poisson": "0.25", "tensile_strength": '"0.2 MPa"', "fracture_energy": '"50 N/m"'}
    density: Density = key(2000.0, "density", ge=0, le=30000)
    young: Stress = key(10e9, "modulus of elasticity, E0", source="thesis 7.3", gt=0)
    poisson: float = key(0.2, "Poisson's ratio", ge=0, lt=0.5)
    tensile_strength: Stress | None = key(None, "tensile strength, ft; without it nothing cracks", gt=0)
    fracture_energy: Energy | None = key(None, "energy of a crack per area, Gf", gt=0)
    tensile_strength_parallel: Stress | None = key(
        None,
        "tensile strength along the bed joints; tensile_strength is then that across them",
        source="Lourenco, de Borst and Rots (1997)",
        gt=0,
    )
    fracture_energy_parallel: Energy | None = key(
        None, "energy of a crack that runs across the bed joints, per area; default fracture_energy", gt=0
    )
    shear_strength: Stress | None = key(
        None,
        "of bedded masonry: strength under shear alone in the axes of its joints; default, and at most, the root of the "
        "product of both tensile strengths",
        gt=0,
    )
    bed_angle: Angle = key(0.0, "angle of the bed joints to the x axis, counter-clockwise", ge=-180, le=180)
    softening: Literal["linear", "exponential", "hordijk"] = key(
        "linear", "softening law: decrease of stress after the strength", source="thesis Fig. 4-1"
    )
    compressive_strength: Stress | None = key(None, "compressive strength; without it nothing crushes", gt=0)
    compressive_strength_parallel: Stress | None = key(
        None,
        "compressive strength along the bed joints; compressive_strength is then that across them (Hill's criterion)",
        source="Lourenco, de Borst and Rots (1997)",
        gt=0,
    )
    compressive_coupling: float = key(
        -1.0,
        "coupling of the pressures along and across the bed joints: b of (sx/fx)^2 + b sx sy / (fx fy) + (sy/fy)^2 + c t^2 / (fx fy) = 1",
        source="-1.05 of Page's panels, Lourenco (1996), from memory",
        gt=-2,
        lt=2,
    )
    compressive_shear: float = key(
        1.2, "c of the same criterion", source="1.20 of Page's panels, Lourenco (1996), from memory", gt=0, le=20
    )
    crushing_energy: Energy | None = key(None, "energy of crushing per area, Gc; sequentially linear analysis crushes only with it", gt=0)
    crushing: Literal["linear", "exponential", "hordijk"] = key("linear", "softening in compression")
    lateral_reduction: bool = key(False, "reduce ft under lateral compression, s1/ft - s2/fc <= 1; needs compressive_strength")
    confinement: float = key(
        0.0, "increase of the compressive strength per lateral pressure; 4.1 for concrete", source="Richart and others (1928)", ge=0, le=10
    )

    @model_validator(mode="after")
    def _complete(self) -> "Material":
        if (self.tensile_strength is None) != (self.fracture_energy is None):
            raise ValueError("tensile_strength and fracture_energy go together: one of them is missing")
        if self.crushing_energy is not None and self.compressive_strength is None:
            raise ValueError("crushing_energy needs compressive_strength")
        if self.lateral_reduction and self.compressive_strength is None:
            raise ValueError("lateral_reduction needs compressive_strength")
        if self.confinement and self.crushing_energy is None:
            raise ValueError("confinement needs compressive_strength and crushing_energy")
        if self.compressive_strength_parallel is not None:
            if self.crushing_energy is None:
                raise ValueError("compressive_strength_parallel needs compressive_strength and crushing_energy")
            if self.confinement:
                raise ValueError("confinement is for one compressive strength: remove compressive_strength_parallel")
        self._check_bedding()
        return self

    def _check_bedding(self) -> None:
        """The strengths of masonry with bed joints fit together."""
        if self.tensile_strength_parallel is None:
            for name in ("fracture_energy_parallel", "shear_strength"):
                if getattr(self, name) is not None:
                    raise ValueError(f"{name} needs tensile_strength_parallel")
            if self.bed_angle and self.compressive_strength_parallel is None:
                raise ValueError("bed_angle needs tensile_strength_parallel or compressive_strength_parallel")
            return
        if self.tensile_strength is None:
            raise ValueError("tensile_strength_parallel needs tensile_strength, that across the bed joints")
        if self.lateral_reduction:
            raise ValueError("lateral_reduction is for one tensile strength: remove tensile_strength_parallel")
        most = (self.tensile_strength * self.tensile_strength_parallel) ** 0.5
        if self.shear_strength is not None and self.shear_strength > most * (1.0 + 1e-9):
            raise ValueError(
                f"shear_strength is {engineering(self.shear_strength, 'Pa')}, at most the root of the product of both tensile strengths, "
                f"{engineering(most, 'Pa')}"
            )


class JointType(Table):
    """Some joints that differ from the others."""

    joints: list[str] = key(
        about='names of joints; "ground" means all joints to the ground, "rings" and "backing" those of a bridge, "beds" (with '
        'those on the ground) and "heads" those of a wall in running bond; the name '
        "of a layer of a drawing, those between its stones or along its lines",
        min_length=1,
        max_length=10000,
    )
    friction: Annotated[float, Field(ge=0, le=10)] | Literal["no-sliding"] | None = key(None, "coefficient of friction")
    normal_stiffness: Stiffness | None = key(None, "normal stiffness per area", gt=0)
    cohesion: Stress | None = key(None, "cohesion of the mortar, lost at the first failure", ge=0)
    tension: Stress | None = key(None, "tensile strength of the mortar, lost at the first failure", ge=0)
    fracture_energy: Energy | None = key(None, "energy of a crack in the mortar per area", gt=0)
    shear_energy: Energy | None = key(None, "energy of the cohesion per area, mode II", gt=0)
    compressive_strength: Stress | None = key(None, "compressive strength of the masonry across the joint", gt=0)
    crushing_energy: Energy | None = key(None, "energy of crushing per area of the joint", gt=0)


class Joints(Table):
    """The joints between the stones, and those on the ground."""

    friction: Annotated[float, Field(ge=0, le=10)] | Literal["no-sliding"] = key(
        0.7, 'coefficient of friction; "no-sliding" excludes sliding (Heyman\'s assumption)', source="thesis 3.2, 7.3"
    )
    cohesion: Stress = key(0.0, "cohesion of mortar, lost at the first failure", ge=0)
    tension: Stress = key(0.0, "tensile strength of mortar, lost at the first failure", ge=0)
    fracture_energy: Energy | None = key(
        None, "energy of a crack in the mortar per area; sequentially linear analysis needs it with a tension", gt=0
    )
    shear_energy: Energy | None = key(
        None,
        "energy of the cohesion per area, mode II; sequentially linear analysis needs it with a cohesion, and loses the "
        "cohesion by it, not at the first failure",
        gt=0,
    )
    compressive_strength: Stress | None = key(
        None, "compressive strength of the masonry across the joints, of sequentially linear analysis", gt=0
    )
    crushing_energy: Energy | None = key(None, "energy of crushing per area of the joints; goes with it", gt=0)
    softening: Literal["linear", "exponential"] = key(
        "exponential", "softening law of the cohesion and tension of mortar, in sequentially linear analysis", source="Lourenco 1996"
    )
    normal_stiffness: Stiffness | None = key(
        None, "normal stiffness per area; default E over the length of stone that a joint represents", source="thesis Eq. 7.10", gt=0
    )
    shear_stiffness: Stiffness | None = key(None, "shear stiffness per area; default shear_ratio times the normal", gt=0)
    shear_ratio: float = key(1.0, "shear over normal stiffness", gt=0, le=10)
    stiffness_rule: Literal["consistent", "thesis"] = key(
        "consistent", "default stiffness: E/L, or E B/L as the thesis prints it", source="thesis Eqs 7.10-7.12"
    )
    damping: Literal["edge", "corner", "rotation", "restitution"] = key(
        "edge",
        "impact frequency that is damped critically; or of a single block the damping that gives its restitution, found by letting it rock",
        source="thesis Eqs 7.13, 7.17-7.20",
    )
    damping_ratio: float = key(1.0, "fraction of critical damping at that frequency", ge=0, le=100)
    beta: Annotated[float, Field(ge=0, le=10)] | None = key(
        None, "constant of stiffness-proportional damping in s; replaces damping and damping_ratio"
    )
    restitution: Literal["thesis", "energy-safe", "inelastic"] | Annotated[float, Field(ge=0, le=1)] = key(
        "inelastic",
        "impact of rocking, of blocks always Housner's: all energy that remains after a plastic impact, with impulses at all "
        "joints; the thesis' momentum balance of arches (of other sections the energy-safe projection); the energy-safe "
        "projection on the next mechanism alone; or the ratio c_v of the rates after and before an impact (0 to 1)",
        source="Moreau 1988; thesis Eqs 5.3, 6.2, 6.3, B.3",
    )
    energy_ratio: Annotated[float, Field(ge=0, le=1)] | None = key(
        None, "instead of restitution: c_E, the kinetic energy after over that before an impact of a block", source="thesis Eq. 6.2"
    )
    worn_corners: Length = key(0.0, "radius to which the corners of the stones are worn", ge=0)
    types: list[JointType] = key([], "joints that differ, [[joints.types]]; missing keys are as in [joints]", max_length=1000)

    @model_validator(mode="after")
    def _one_impact(self) -> "Joints":
        if self.energy_ratio is not None and "restitution" in self.model_fields_set:
            raise ValueError("give restitution or energy_ratio, not both")
        return self

    @property
    def coefficient(self) -> float | None:
        """Coefficient of friction; None excludes sliding."""
        return None if self.friction == NO_SLIDING else float(self.friction)


class Held(Placed):
    """Nodes of a finite-element mesh that are held."""

    fix: Literal["x", "y", "xy"] = key("xy", "directions that are held")
    stiffness: Annotated[float, Field(gt=0)] | None = key(None, "spring in N/m at each node instead of a rigid support")


class Supports(Table):
    """What the building stands on. Stones stand on the joints to the ground that the structure has."""

    stiffness: Stiffness | None = key(
        None, "stiffness of the ground per area, in series with the joints on it; `rocking` takes joints as rigid", gt=0
    )
    foundation: Literal["winkler", "two-spring"] = key(
        "winkler",
        "for `rocking`: springs of that stiffness all along the base, or half of them under each edge; neither pulls",
        source="Psycharis and Jennings 1983",
    )
    damping_ratio: Annotated[float, Field(ge=0, le=10)] | None = key(
        None,
        "for `rocking`: dashpots beside these springs, by their fraction of critical damping of the vertical motion of the "
        "whole structure on its base; default none",
    )
    abutting_wall: Literal["left", "right"] | None = key(
        None, "a wall that stands against it on this side: it rocks away from it only, and is thrown back by it"
    )
    rebound: Annotated[float, Field(ge=0, le=1)] | None = key(
        None,
        "rate after over rate before it is thrown back by the wall; default, of a block, three impacts: of the far toe, of "
        "the top on the wall, of the near toe, which is an upper bound",
        source="three balances of angular momentum, derived here",
    )
    held: list[Held] = key(
        [], "held nodes of finite-element meshes, [[supports.held]]; default the bottom edge, or the joints on the ground", max_length=1000
    )

    @model_validator(mode="after")
    def _thrown_back_by_a_wall(self) -> "Supports":
        if self.rebound is not None and self.abutting_wall is None:
            raise ValueError("rebound needs abutting_wall, the side on which the wall stands")
        return self

    @model_validator(mode="after")
    def _gives_way(self) -> "Supports":
        for name in ("foundation", "damping_ratio"):
            if name in self.model_fields_set and self.stiffness is None:
                raise ValueError(f"{name} needs stiffness, that of the ground")
        return self


class Movement(Table):
    """A support that gives way, slowly, starting and ending at rest."""

    joint: str = key(about="name of a joint on the support")
    dx: Length = key(0.0, "to the right")
    dy: Length = key(0.0, "upward; negative is a settlement")
    turn: Angle = key(0.0, "counter-clockwise, about the middle of the support")
    start: Time = key(0.0, "when it starts", ge=0)
    duration: Time = key(1.0, "how long it takes", gt=0)


class Initial(Table):
    """The state from which dynamics start."""

    rotation_ratio: float = key(0.0, "rotation over the critical one of that side; positive to +x", source="thesis 6.2.2", gt=-1, lt=1)
    movements: list[Movement] = key([], "supports that move, [[initial.movements]]", max_length=100)
