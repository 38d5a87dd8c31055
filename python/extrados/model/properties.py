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
    """Material of the blocks, or homogenised masonry: density, elastic constants, and strengths for cracking and crushing."""

    starter: ClassVar = {"young": '"6.9 GPa"', "poisson": "0.25", "tensile_strength": '"0.2 MPa"', "fracture_energy": '"50 N/m"'}
    density: Density = key(2000.0, "density", ge=0, le=30000)
    young: Stress = key(10e9, "modulus of elasticity, E0", source="thesis 7.3", gt=0)
    poisson: float = key(0.2, "Poisson's ratio", ge=0, lt=0.5)
    tensile_strength: Stress | None = key(None, "tensile strength ft; without this value, the masonry does not crack", gt=0)
    fracture_energy: Energy | None = key(None, "fracture energy Gf: energy of a crack for each unit of its area", gt=0)
    tensile_strength_parallel: Stress | None = key(
        None,
        "tensile strength along the bed joints; `tensile_strength` is then the strength across the bed joints",
        source="Lourenco, de Borst and Rots (1997)",
        gt=0,
    )
    fracture_energy_parallel: Energy | None = key(
        None, "fracture energy per area of a crack that runs across the bed joints; default: `fracture_energy`", gt=0
    )
    shear_strength: Stress | None = key(
        None,
        "for masonry with bed joints: strength under pure shear along the bed joints. Default and "
        "greatest value: the square root of the product of both tensile strengths",
        gt=0,
    )
    bed_angle: Angle = key(0.0, "angle from the x axis to the bed joints, counter-clockwise", ge=-180, le=180)
    softening: Literal["linear", "exponential", "hordijk"] = key(
        "linear", "softening law: how the stress decreases after the strength is reached", source="thesis Fig. 4-1"
    )
    compressive_strength: Stress | None = key(None, "compressive strength; without this value, the masonry does not crush", gt=0)
    compressive_strength_parallel: Stress | None = key(
        None,
        "compressive strength along the bed joints; `compressive_strength` is then the strength across the bed joints (criterion of Hill)",
        source="Lourenco, de Borst and Rots (1997)",
        gt=0,
    )
    compressive_coupling: float = key(
        -1.0,
        "coupling of the compression along and across the bed joints: b in the criterion (sx/fx)^2 + b "
        "sx sy / (fx fy) + (sy/fy)^2 + c t^2 / (fx fy) = 1. sx, sy: stresses along and across the bed "
        "joints; t: shear stress; fx, fy: compressive strengths; c: `compressive_shear`",
        source="-1.05 of Page's panels, Lourenco (1996), from memory",
        gt=-2,
        lt=2,
    )
    compressive_shear: float = key(
        1.2,
        "weight of the shear stress: c in the criterion of `compressive_coupling`",
        source="1.20 of Page's panels, Lourenco (1996), from memory",
        gt=0,
        le=20,
    )
    crushing_energy: Energy | None = key(
        None, "crushing energy Gc per area; sequentially linear analysis includes crushing only if this value is given", gt=0
    )
    crushing: Literal["linear", "exponential", "hordijk"] = key("linear", "softening law in compression")
    lateral_reduction: bool = key(
        False,
        "whether lateral compression reduces the tensile strength ft: s1/ft - s2/fc <= 1 (s1, s2: principal stresses, tension positive; "
        "fc: compressive strength); requires `compressive_strength`",
    )
    confinement: float = key(
        0.0,
        "increase of the compressive strength, divided by the lateral pressure; 4.1 for concrete",
        source="Richart and others (1928)",
        ge=0,
        le=10,
    )

    @model_validator(mode="after")
    def _complete(self) -> "Material":
        if (self.tensile_strength is None) != (self.fracture_energy is None):
            raise ValueError("`tensile_strength` and `fracture_energy` require each other: give both")
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
                raise ValueError("the key `confinement` requires a single compressive strength: remove `compressive_strength_parallel`")
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
            raise ValueError("`tensile_strength_parallel` requires `tensile_strength`, the strength across the bed joints")
        if self.lateral_reduction:
            raise ValueError("the key `lateral_reduction` requires a single tensile strength: remove `tensile_strength_parallel`")
        most = (self.tensile_strength * self.tensile_strength_parallel) ** 0.5
        if self.shear_strength is not None and self.shear_strength > most * (1.0 + 1e-9):
            raise ValueError(
                f"`shear_strength` is {engineering(self.shear_strength, 'Pa')}, but must not exceed {engineering(most, 'Pa')}, "
                "the square root of the product of both tensile strengths"
            )


class JointType(Table):
    """Some joints that differ from the others."""

    joints: list[str] = key(
        about='names of joints. "ground": all joints at the ground; "rings" and "backing": joints of a bridge; '
        '"beds" (including those at the ground) and "heads": joints of a wall in running bond. The name '
        "of a layer of a drawing: the joints between its blocks, or along its lines",
        min_length=1,
        max_length=10000,
    )
    friction: Annotated[float, Field(ge=0, le=10)] | Literal["no-sliding"] | None = key(None, "coefficient of friction")
    normal_stiffness: Stiffness | None = key(None, "normal stiffness per area", gt=0)
    cohesion: Stress | None = key(None, "cohesion of the mortar, which is lost at the first failure", ge=0)
    tension: Stress | None = key(None, "tensile strength of the mortar, which is lost at the first failure", ge=0)
    fracture_energy: Energy | None = key(None, "fracture energy of the mortar per area", gt=0)
    shear_energy: Energy | None = key(None, "fracture energy of the cohesion per area (mode II)", gt=0)
    compressive_strength: Stress | None = key(None, "compressive strength of the masonry across the joint", gt=0)
    crushing_energy: Energy | None = key(None, "crushing energy of the joint per area", gt=0)


class Joints(Table):
    """The joints between the blocks, and the joints on the ground."""

    friction: Annotated[float, Field(ge=0, le=10)] | Literal["no-sliding"] = key(
        0.7, 'coefficient of friction; "no-sliding" excludes sliding (Heyman\'s assumption)', source="thesis 3.2, 7.3"
    )
    cohesion: Stress = key(0.0, "cohesion of the mortar, which is lost at the first failure", ge=0)
    tension: Stress = key(0.0, "tensile strength of the mortar, which is lost at the first failure", ge=0)
    fracture_energy: Energy | None = key(
        None, "fracture energy of the mortar per area; sequentially linear analysis requires this value if `tension` is given", gt=0
    )
    shear_energy: Energy | None = key(
        None,
        "fracture energy of the cohesion per area (mode II). Sequentially linear analysis requires this value if `cohesion` is given; "
        "the cohesion then decreases gradually and is not lost at the first failure",
        gt=0,
    )
    compressive_strength: Stress | None = key(
        None, "compressive strength of the masonry across the joints, for sequentially linear analysis", gt=0
    )
    crushing_energy: Energy | None = key(None, "crushing energy of the joints per area; requires `compressive_strength`", gt=0)
    softening: Literal["linear", "exponential"] = key(
        "exponential",
        "law by which cohesion and tension of the mortar decrease (softening), for sequentially linear analysis",
        source="Lourenco 1996",
    )
    normal_stiffness: Stiffness | None = key(
        None, "normal stiffness per area; default: E divided by the length of block that a joint represents", source="thesis Eq. 7.10", gt=0
    )
    shear_stiffness: Stiffness | None = key(None, "shear stiffness per area; default: `shear_ratio` times the normal stiffness", gt=0)
    shear_ratio: float = key(1.0, "shear over normal stiffness", gt=0, le=10)
    stiffness_rule: Literal["consistent", "thesis"] = key(
        "consistent",
        "rule for the default stiffness. consistent: E/L; thesis: E B/L, as printed in the thesis. E: elastic modulus; "
        "L: length of block that a joint represents; B: width of the joint",
        source="thesis Eqs 7.10-7.12",
    )
    damping: Literal["edge", "corner", "rotation", "restitution"] = key(
        "edge",
        "impact at whose frequency the joints have `damping_ratio`. edge: a block lands flat; corner: it lands on a corner; rotation: it "
        "rotates. restitution, for a single block: damping that gives the coefficient of restitution of the block (found by trial runs)",
        source="thesis Eqs 7.13, 7.17-7.20",
    )
    damping_ratio: float = key(
        1.0, "damping ratio (fraction of critical damping) at the impact frequency that `damping` names", ge=0, le=100
    )
    beta: Annotated[float, Field(ge=0, le=10)] | None = key(
        None, "constant of stiffness-proportional damping in s; replaces `damping` and `damping_ratio`"
    )
    restitution: Literal["thesis", "energy-safe", "inelastic"] | Annotated[float, Field(ge=0, le=1)] = key(
        "inelastic",
        "rule for impacts during rocking (blocks always use the rule of Housner). inelastic: plastic impact with impulses at all "
        "joints; rocking keeps all energy that remains. thesis: momentum balance of the thesis for arches (energy-safe for other "
        "sections). energy-safe: velocities projected on the mechanism after the impact. "
        "A number is c_v: angular velocity after / before an impact (0 to 1)",
        source="Moreau 1988; thesis Eqs 5.3, 6.2, 6.3, B.3",
    )
    energy_ratio: Annotated[float, Field(ge=0, le=1)] | None = key(
        None, "for a block, instead of `restitution`: c_E, the ratio of kinetic energy after / before an impact", source="thesis Eq. 6.2"
    )
    worn_corners: Length = key(0.0, "radius to which the corners of the blocks are worn", ge=0)
    types: list[JointType] = key(
        [], "joints with other values, [[joints.types]]; keys that are not given there keep the values of [joints]", max_length=1000
    )

    @model_validator(mode="after")
    def _one_impact(self) -> "Joints":
        if self.energy_ratio is not None and "restitution" in self.model_fields_set:
            raise ValueError("give either `restitution` or `energy_ratio`, not both")
        return self

    @property
    def coefficient(self) -> float | None:
        """Coefficient of friction; None excludes sliding."""
        return None if self.friction == NO_SLIDING else float(self.friction)


class Held(Placed):
    """Nodes of a finite-element mesh that are held."""

    fix: Literal["x", "y", "xy"] = key("xy", "directions in which the nodes are held")
    stiffness: Annotated[float, Field(gt=0)] | None = key(
        None, "stiffness of the springs that replace a rigid support, in N/m at each node"
    )


class Supports(Table):
    """The supports of the building. Blocks are supported by the joints that the structure has with the ground."""

    stiffness: Stiffness | None = key(
        None, "stiffness of the ground per area, in series with the joints on the ground; for `rocking`, these joints are rigid", gt=0
    )
    foundation: Literal["winkler", "two-spring"] = key(
        "winkler",
        "for `rocking`: place of the springs of the ground. winkler: springs along the whole base; two-spring: one spring under each "
        "edge, with half of the stiffness. The springs carry no tension",
        source="Psycharis and Jennings 1983",
    )
    damping_ratio: Annotated[float, Field(ge=0, le=10)] | None = key(
        None,
        "for `rocking`: damping ratio of dashpots in parallel with the springs of the ground, for the "
        "vertical motion of the whole structure; default: no dashpots",
    )
    abutting_wall: Literal["left", "right"] | None = key(
        None, "side on which a wall abuts: the structure rocks only away from this wall, and rebounds from it"
    )
    rebound: Annotated[float, Field(ge=0, le=1)] | None = key(
        None,
        "ratio of angular velocity after / before the rebound from the wall. Default for a block: "
        "calculated from three impacts (far toe, top at the wall, near toe), which gives an upper bound",
        source="three balances of angular momentum, derived here",
    )
    held: list[Held] = key(
        [],
        "nodes of finite-element meshes that are restrained, [[supports.held]]; default: the bottom edge, or the joints on the ground",
        max_length=1000,
    )

    @model_validator(mode="after")
    def _thrown_back_by_a_wall(self) -> "Supports":
        if self.rebound is not None and self.abutting_wall is None:
            raise ValueError("the key `rebound` requires `abutting_wall`, the side of the wall")
        return self

    @model_validator(mode="after")
    def _gives_way(self) -> "Supports":
        for name in ("foundation", "damping_ratio"):
            if name in self.model_fields_set and self.stiffness is None:
                raise ValueError(f"{name} requires the key `stiffness`, the stiffness of the ground")
        return self


class Movement(Table):
    """A support that gives way, slowly, starting and ending at rest."""

    joint: str = key(about="name of a joint on the support")
    dx: Length = key(0.0, "movement towards +x")
    dy: Length = key(
        0.0,
        "in a plane section: upward movement; negative is a settlement. In space: movement along y, the second direction in plan. An "
        "analysis of a plane section with `direction` is in space: it requires `dz` for a settlement",
    )
    dz: Length = key(0.0, "in space: upward movement; negative is a settlement")
    turn: Angle = key(0.0, "in a plane section: rotation about the middle of the support, counter-clockwise")
    start: Time = key(0.0, "time at which the movement starts", ge=0)
    duration: Time = key(1.0, "duration of the movement", gt=0)


class Initial(Table):
    """The state from which dynamics start."""

    rotation_ratio: float = key(
        0.0, "initial rotation, divided by the critical rotation on the same side; positive towards +x", source="thesis 6.2.2", gt=-1, lt=1
    )
    movements: list[Movement] = key([], "supports that move, [[initial.movements]]", max_length=100)
