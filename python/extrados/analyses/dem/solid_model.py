"""A deck's blocks in space as a model of discrete elements: bodies, supports, joint types, damping, settlement."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from extrados.analyses.context import Refused
from extrados.analyses.dem import impact_rules
from extrados.analyses.dem.impact_rules import ContactValues
from extrados.analyses.dem.tables import Dem, DemDomain, SpatialDem
from extrados.analyses.dem.ties import NO_TIES, ElementTies, element_ties
from extrados.core import dem3, dem_run
from extrados.core.dem_run import Law, SupportMove
from extrados.model.errors import Key, NoView
from extrados.model.geometry.anchors import moved_joints
from extrados.model.geometry.assembly import Assembly
from extrados.model.geometry.solids.assembly import SolidAssembly
from extrados.model.geometry.solids.contacts import GROUND
from extrados.model.geometry.water import Pressure, water_pressure
from extrados.views.building import Building
from extrados.views.solids.strands import damper_strands
from extrados.views.solids.supports import LEVEL, Supports, supports_of

#: Of masses and of the size: by how much blocks that are drawn out differ from their section
DRAWN_OUT = 1e-6
FACING = -0.3  # cosine between faces of a stone that look away from each other


@dataclass(frozen=True)
class SolidModel:
    """Blocks in space with what they stand on. Bodies 0..count-1 are the blocks, the rest supports. strength: at which contacts crush, 0
    never [Pa]; water: its pressure on the section that is drawn out."""

    assembly: SolidAssembly
    supports: Supports
    values: ContactValues
    ties: ElementTies = NO_TIES
    strength: float = 0.0
    water: Pressure | None = None

    @property
    def count(self) -> int:
        """Mobile bodies."""
        return len(self.assembly.mass)

    @property
    def mass(self) -> np.ndarray:
        """Masses of the mobile bodies [kg]."""
        return self.assembly.mass

    @property
    def load(self) -> np.ndarray | None:
        """Constant loads of the mobile bodies (count, 4, 3) [N, N m], as core.dem3.Solids has them."""
        return None if self.water is None else self.water.on_solids(self.assembly.centroid)

    @property
    def other_loads(self) -> str:
        """Constant loads besides the own weight, in words."""
        return "" if self.water is None else "the water pressure"

    @property
    def size(self) -> float:
        """Greatest extent of the structure [m]."""
        return self.assembly.size

    @property
    def body_names(self) -> list[str]:
        """Names of the mobile bodies, then of the supports."""
        return [*self.assembly.block_names, *(f"support {k + 1}" for k in range(len(self.supports.bodies)))]

    @cached_property
    def pairs(self) -> dict[tuple[int, int], list[int]]:
        """Numbers of the contacts of each pair of bodies, ascending."""
        found: dict[tuple[int, int], list[int]] = {}
        for j, (a, b) in enumerate(zip(self.assembly.a.tolist(), self.assembly.b.tolist(), strict=True)):
            one, other = (self.count + int(self.supports.of_joint[j]) if k == GROUND else k for k in (a, b))
            found.setdefault((min(one, other), max(one, other)), []).append(j)
        return found

    def shared(self, values: np.ndarray) -> np.ndarray:
        """Values of the contacts (contacts), averaged by area over those of a pair of bodies, which have one law."""
        found = np.empty(len(values))
        for contacts in self.pairs.values():
            found[contacts] = np.average(values[contacts], weights=self.assembly.area[contacts])
        return found

    def bodies(self) -> dem3.Solids:
        """Bodies and laws for the core; contacts that form later take the median of the joints, without mortar and crushing."""
        one, v = self.assembly, self.values
        below = self.supports.bodies
        parts = [*one.parts, *below]
        dry = [float(np.median(x)) for x in (v.stiffness, v.shear_stiffness, v.friction)]
        laws = [_law(v, *dry)]
        numbers: dict[Law, int] = {}
        joints: dict[tuple[int, int], int] = {}
        of_pair = [self.shared(x) for x in (v.stiffness, v.shear_stiffness, v.friction, v.cohesion, v.tension)]
        for pair, shared in self.pairs.items():
            law = replace(_law(v, *(float(x[shared[0]]) for x in of_pair)), strength=self.strength)
            if law not in numbers:
                numbers[law] = len(laws)
                laws.append(law)
            joints[pair] = numbers[law]
        middle = [p.vertices.mean(axis=0) for p in below]
        count = len(below)
        return dem3.Solids(
            np.concatenate([one.centroid, np.reshape(middle, (-1, 3))]),
            np.concatenate([one.mass, np.zeros(count)]),
            np.concatenate([one.inertia, np.tile(np.eye(3), (count, 1, 1))]),
            [p.vertices for p in parts],
            [p.faces for p in parts],
            [*one.owner.tolist(), *range(self.count, self.count + count)],
            laws,
            joints,
            self._dowels(),
            self.ties.core,
            load=None if self.load is None else np.concatenate([self.load, np.zeros((count, 4, 3))]),
        )

    def drawn(self) -> dem_run.DrawnContacts:
        """All contacts, for their forces and places."""
        return dem_run.DrawnContacts(self.sides, self.assembly.polygon, self.assembly.normal)

    @property
    def sides(self) -> np.ndarray:
        """Bodies on both sides of each contact (contact, 2), supports for the ground."""
        bodies = np.column_stack([self.assembly.a, self.assembly.b])
        return np.where(bodies == GROUND, self.count + self.supports.of_joint[:, None], bodies)

    def _dowels(self) -> dem3.Dowels | None:
        """The keys, each as stiff as the shear springs of all contacts of the two stones that it holds together."""
        one, v = self.assembly, self.values
        if one.keys is None:
            return None
        j = one.keys.joint
        pair = np.column_stack([one.a[j], one.b[j]])
        together = [(one.a == a) & (one.b == b) for a, b in pair]
        # They stand in the lower stone; the normal of a contact points into a.
        upward = one.centroid[pair[:, 0], 2] <= one.centroid[pair[:, 1], 2]
        axis = np.where(upward, -1.0, 1.0)[:, None] * one.normal[j]
        stands = np.where(upward[:, None], pair, pair[:, ::-1])
        stiffness = [float((v.shear_stiffness * one.area)[shared].sum()) for shared in together]
        return dem3.Dowels(stands, one.keys.point, axis, np.array(stiffness), one.keys.strength, one.keys.reach, v.beta)


def _law(values: ContactValues, stiffness: float, shear: float, friction: float, cohesion: float = 0.0, tension: float = 0.0) -> Law:
    stiffness, shear, friction, cohesion, tension = (float(f"{x:.12g}") for x in (stiffness, shear, friction, cohesion, tension))
    return Law(stiffness, shear, friction, cohesion=cohesion, tension=tension, damping=values.beta)


def make_solid_model(building: Building, options: SpatialDem) -> SolidModel:
    """The model of a building's blocks in space."""
    assembly = building.solids()
    ties = element_ties(building, (*building.strands(), *damper_strands(building)), np.arange(len(assembly.mass)), options.has_rates)
    strength = building.material.compressive_strength if options.crushing else None
    asked = options.water if isinstance(options, Dem) else None
    water = None if asked is None else water_pressure(wet_section(building, assembly), asked.level, asked.side, asked.uplift, asked.density)
    return SolidModel(assembly, supports_of(assembly, options.floor), solid_values(building, assembly), ties, strength or 0.0, water)


def moves_of(building: Building, model: SolidModel) -> tuple[SupportMove, ...]:
    """Movements of the footings below contacts that [[initial.movements]] name."""
    movements = building.initial.movements
    joints = moved_joints(model.assembly, [one.joint for one in movements])
    return tuple(
        SupportMove(model.count + int(model.supports.of_joint[j]), (one.dx, one.dy, one.dz), one.start, one.duration)
        for j, one in zip(joints, movements, strict=True)
    )


def refusals(building: Building, options: SpatialDem) -> list[tuple[str, Key]]:
    """What discrete elements in space cannot take into account, and the key that asks for it."""
    given, joints = options.model_fields_set, building.joints
    moves = isinstance(options, Dem) and options.test == "motion"
    asked: list[tuple[str, bool, Key]] = [
        ("mass_damping", options.mass_damping > 0.0, ("analysis", "mass_damping")),
        ('merge = "three-bars"', options.merge != "none", ("analysis", "merge")),
        *((key, key in given, ("analysis", key)) for key in ("vary_damping", "vary_stiffness", "vary_friction")),
        (
            '[[initial.movements]], except with kind = "dem" and test = "motion"',
            bool(building.initial.movements) and not moves,
            ("initial", "movements"),
        ),
        ("[[initial.movements]] with a floor", bool(building.initial.movements) and options.floor is not None, ("initial", "movements")),
        *(
            ("rotation of a support", bool(one.turn), ("initial", "movements", k, "turn"))
            for k, one in enumerate(building.initial.movements)
        ),
        ("[initial] rotation_ratio", bool(building.initial.rotation_ratio), ("initial", "rotation_ratio")),
        ("stiffness of supports", building.supports.stiffness is not None, ("supports", "stiffness")),
        ("worn corners", joints.worn_corners > 0.0, ("joints", "worn_corners")),
    ]
    if isinstance(options, Dem):
        asked += [
            ('base = "moving"', options.base == "moving", ("analysis", "base")),
            ("find_friction", options.find_friction, ("analysis", "find_friction")),
        ]
    if isinstance(options, DemDomain):
        asked.append(("mode_II", options.mode_II, ("analysis", "mode_II")))
    if not options.rigid or (isinstance(options, DemDomain) and options.cross_check):  # something asks how springs are
        asked += [
            ('stiffness_rule = "thesis" (only for plane sections)', joints.stiffness_rule == "thesis", ("joints", "stiffness_rule")),
            ('damping = "restitution"', joints.damping == "restitution" and joints.beta is None, ("joints", "damping")),
        ]
    return [(f"dem of solids cannot include {what}: remove it", key) for what, there, key in asked if there]


def wet_section(building: Building, assembly: SolidAssembly) -> Assembly:
    """The plane section of which the blocks in space are drawn out; Refused where they are not."""
    try:
        section = building.blocks()
    except NoView:
        section = None
    if (
        section is None
        or section.block_names != assembly.block_names
        or not np.allclose(section.mass, assembly.mass, rtol=DRAWN_OUT)
        or not np.allclose(section.centroid, assembly.centroid[:, [0, 2]], rtol=0.0, atol=DRAWN_OUT * assembly.size)
        or not _fills_depth(section, assembly)
    ):
        raise Refused(
            "for solids, `water` requires a plane section that is drawn out to its depth: remove `water`, or draw the section",
            ("analysis", "water"),
        )
    return section


def _fills_depth(section: Assembly, assembly: SolidAssembly) -> bool:
    """Whether all blocks in space reach from one end of one depth to the other, and have the extents of their outlines."""
    error = DRAWN_OUT * assembly.size
    low, high = (
        np.array(
            [
                edge([edge(p.vertices, axis=0) for p, o in zip(assembly.parts, assembly.owner, strict=True) if o == k], axis=0)
                for k in range(len(assembly.mass))
            ]
        )
        for edge in (np.min, np.max)
    )
    flat = np.array([[outline.min(axis=0), outline.max(axis=0)] for outline in section.outlines])
    return bool(
        np.ptp(low[:, 1]) < error
        and np.ptp(high[:, 1]) < error
        and np.abs(low[:, [0, 2]] - flat[:, 0]).max() < error
        and np.abs(high[:, [0, 2]] - flat[:, 1]).max() < error
    )


def refuse_shoves(building: Building, assembly: SolidAssembly) -> None:
    """Refused where a support of a section that is drawn out moves by dy: upward in the plane, in space across the section."""
    y = np.concatenate([part.vertices for part in assembly.parts])[:, 1]
    if np.minimum(y - y.min(), y.max() - y).max() > LEVEL * assembly.size:
        return
    try:
        building.blocks()
    except NoView:
        return
    for k, one in enumerate(building.initial.movements):
        if one.dy:
            raise Refused(
                "for solids, `dy` moves a support perpendicular to the plane of this section: give `dz` for a settlement (z is upward)",
                ("initial", "movements", k, "dy"),
            )


def refuse_stones(assembly: SolidAssembly) -> None:
    """Refused where the blocks have fill or too many corners."""
    for part, owner in zip(assembly.parts, assembly.owner.tolist(), strict=True):
        if (most := max(map(len, part.faces))) > dem3.MOST_CORNERS:
            raise Refused(
                f"{assembly.block_names[owner]} has a face with {most} corners, and dem of solids allows up to "
                f"{dem3.MOST_CORNERS}: divide the face, or draw it with fewer corners",
                ("structure",),
            )
    if len(assembly.fill):
        raise Refused("fill: `dem` of solids does not include weights that rest on the blocks: remove the fill", ("structure", "fill"))


def solid_values(building: Building, assembly: SolidAssembly) -> ContactValues:
    """Properties of all contacts by the rules and exceptions of [joints]."""
    joints = building.joints
    given = building.joint_property("normal_stiffness", assembly)
    elastic = building.material.young / _lengths(assembly)
    stiffness = np.where(np.isnan(given), elastic, given)
    impact = _impact(assembly, stiffness)
    beta = joints.beta
    if beta is None:
        beta = impact_rules.damping_constant(float(impact.of(joints.damping).max()), joints.damping_ratio)
    shear = np.full_like(stiffness, joints.shear_stiffness) if joints.shear_stiffness else stiffness * joints.shear_ratio
    friction, cohesion, tension = (building.joint_property(name, assembly) for name in ("friction", "cohesion", "tension"))
    return ContactValues(stiffness, shear, friction, np.nan_to_num(cohesion), np.nan_to_num(tension), beta, impact)


def _sides(assembly: SolidAssembly) -> list[tuple[np.ndarray, np.ndarray]]:
    """Blocks on both sides of the contacts, with the normals into them."""
    return [(assembly.a, assembly.normal), (assembly.b, -assembly.normal)]


def _lengths(assembly: SolidAssembly) -> np.ndarray:
    """Length of stone that each contact stands for (nj) [m]: of each block half, or all of it where no contact faces it."""
    total = np.zeros(len(assembly.a))
    points: dict[int, np.ndarray] = {}
    for k in range(len(assembly.mass)):
        points[k] = np.concatenate([assembly.parts[p].vertices for p in np.flatnonzero(assembly.owner == k)])
    of_block: dict[int, list[tuple[int, np.ndarray]]] = {}
    for block, inward in _sides(assembly):
        for j in np.flatnonzero(block != GROUND).tolist():
            of_block.setdefault(int(block[j]), []).append((j, inward[j]))
    for number, faces in of_block.items():
        normals = np.array([n for _, n in faces])
        for j, inward in faces:
            total[j] += float(np.ptp(points[number] @ inward)) * (0.5 if (normals @ inward < FACING).any() else 1.0)
    return total


def _impact(assembly: SolidAssembly, stiffness: np.ndarray) -> impact_rules.Impact:
    """Frequencies of impact at all contacts, as if each were a rectangle of its area and of its extents along its principal
    axes: of a section drawn out those of the plane. The rotation is that about the side for which it is fastest."""
    first, second = _principal(assembly)
    mobility = np.zeros(len(stiffness))
    turning = np.zeros((2, len(stiffness)))
    extent = np.zeros((2, len(stiffness)))
    for j, polygon in enumerate(assembly.polygon):
        for k, (along, across) in enumerate(((first[j], second[j]), (second[j], first[j]))):
            reach = polygon @ along
            extent[k, j] = np.ptp(reach)
            ends = [polygon[reach.argmin()], polygon[reach.argmax()]]
            for block in (assembly.a[j], assembly.b[j]):
                if block == GROUND:
                    continue
                arms = [np.linalg.norm(np.cross(assembly.centroid[block] - end, across)) ** 2 for end in ends]
                about = across @ assembly.inertia[block] @ across
                turning[k, j] += 1.0 / (about + assembly.mass[block] * min(arms))
                if k == 0:
                    mobility[j] += 1.0 / assembly.mass[block]
    spring = 0.5 * stiffness * assembly.area
    rotation = np.sqrt((spring * extent**2 * turning).max(axis=0))
    return impact_rules.Impact(np.sqrt(spring * mobility), np.sqrt(2.0 * spring * mobility), rotation)


def _principal(assembly: SolidAssembly) -> tuple[np.ndarray, np.ndarray]:
    """Unit vectors (nj, 3) along the greatest and the least extent of each contact's corners."""
    first = np.empty_like(assembly.normal)
    for j, polygon in enumerate(assembly.polygon):
        arm = polygon - polygon.mean(axis=0)
        first[j] = np.linalg.eigh(arm.T @ arm)[1][:, -1]
    return first, np.cross(assembly.normal, first)
