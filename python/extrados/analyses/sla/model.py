"""A wall and the options of its deck made into a model of the core: freedoms, groups, nodal loads."""

import re
from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from extrados.analyses.context import Refused
from extrados.analyses.sla.bars import NamedBar, bar_group, tie_group
from extrados.analyses.sla.tables import CrackOptions, Load, Sla
from extrados.core import sla as core
from extrados.model.errors import BadGeometry, Key
from extrados.model.places import Placed
from extrados.model.properties import Material
from extrados.model.structures.walls import Bar
from extrados.views.mesh.mesh import ElementGroup, JointLaw, Mesh, corner_count, element_areas, words_of_place
from extrados.views.shell.mesh import ShellMesh

AXES = {"x": 0, "y": 1}
POINTS_PER_THREAD = 20_000
#: Growth of the compliance that counts as a mechanism: of walls, and of stones, which may be slender
MECHANISM, MECHANISM_OF_STONES = 1e4, 1e5
#: Growth of the compliance times the stiffness left in cracks, at most: beyond, that stiffness would carry a load
MOST_OF_FLOOR = 0.1
#: Openings and closings of a joint's point before it is left open: they change no stress, so that many do no harm
MOST_CHANGES_OF_JOINTS = 1000
#: Stiffness left in an open joint: its row is so thin that the millionth left in a cracked wall would hold the stones
FLOOR_OF_JOINTS = 1e-11


@dataclass(kw_only=True)
class EventModel(ABC):
    """What the event loop takes from a model: a wall in its plane, or a building of shells. constant, reference: nodal forces (nodes,
    2 or 6) [N]; unit: resultant of the reference load, by which lambda becomes a force [N]; control: the displacement that is followed."""

    mesh: Mesh | ShellMesh
    freedoms: core.Freedoms
    groups: list[core.Group]
    behaviour: core.Behaviour
    constant: np.ndarray
    reference: np.ndarray
    unit: float
    control: core.Monitor
    mechanism_ratio: float  # growth of the compliance that ends a run
    acceleration: float | None = None  # of the reference load, where it is one of masses alone [m/s^2]
    already: float = 0.0  # reference load that stages before have left on [N]
    settled: np.ndarray = field(default_factory=lambda: np.empty(0))  # how far each support has settled, with the constant loads [m]

    @property
    @abstractmethod
    def place(self) -> np.ndarray:
        """Places of the nodes (nodes, 2 or 3) [m]."""

    @property
    @abstractmethod
    def point_count(self) -> int:
        """Integration points that threads share."""

    @property
    @abstractmethod
    def reach(self) -> float:
        """Extent over which a drift is counted [m]."""

    @property
    @abstractmethod
    def driven(self) -> bool:
        """Whether the multiplier moves supports."""

    @property
    def watched(self) -> list[core.Monitor]:
        """What is recorded at each event."""
        return [self.control]

    def ends(self, part: core.Events) -> str:
        """Why a run ends after these steps by a limit of the structure itself; empty if it goes on."""
        del part
        return ""

    @property
    def slides(self) -> bool:
        """Whether a joint has a coefficient of friction."""
        return any(isinstance(g, core.Joints) and bool(np.isfinite(g.friction).any()) for g in self.groups)

    @property
    def continues(self) -> bool:
        """Whether equilibrium iterations may follow the structure."""
        return True

    @property
    def steps_alone(self) -> bool:
        """Whether they follow it from the first load on."""
        return False

    @abstractmethod
    def refuse_free(self, error: core.FreeNode) -> Refused:
        """The refusal of a node that nothing holds."""

    @property
    def extent(self) -> float:
        """Greatest extent of the structure [m]."""
        return float(np.ptp(self.place, axis=0).max())

    def open(self, options: Any, threads: int) -> core.Model:
        """The model in the core; Refused names a free node or a bad element."""
        # Below this many points a thread costs more than it saves; results are the same for any number
        threads = max(1, min(threads, self.point_count // POINTS_PER_THREAD))
        try:
            return core.Model(self.place, self.freedoms, self.groups, self.behaviour, algorithm=options.algorithm, threads=threads)
        except core.FreeNode as error:
            raise self.refuse_free(error) from None
        except core.BadElement as error:
            raise Refused(str(error), ("structure",)) from None


@dataclass(kw_only=True)
class SlaModel(EventModel):
    """A wall or stones ready for the core."""

    mesh: Mesh
    bands: list[np.ndarray]  # crack band of the elements of each plane group before they crack [m]
    point_xy: np.ndarray  # (points, 2) of the plane groups [m]
    moved: np.ndarray = field(default_factory=lambda: np.empty((0, 2)))  # supports, constant and per multiplier [m]
    bars: list[NamedBar] = field(default_factory=list)

    @property
    def place(self) -> np.ndarray:
        """Places of the nodes (nodes, 2) [m]."""
        return self.mesh.xy

    @property
    def point_count(self) -> int:
        """Integration points of the plane groups."""
        return len(self.point_xy)

    @property
    def reach(self) -> float:
        """Extent of the structure across the control displacement, over which a drift is counted [m]."""
        across = 1 - int(np.bincount(self.control.direction, minlength=2)[:2].argmax())
        return float(np.ptp(self.mesh.xy[:, across]))

    @property
    def driven(self) -> bool:
        """True where supports move with the multiplier, which then is a displacement [m]."""
        return bool(self.moved[:, 1].any())

    @property
    def watched(self) -> list[core.Monitor]:
        """What is recorded at each event: the control displacement, and the strains of the bars that are one piece."""
        return [self.control, *(bar.strain(self.mesh.xy) for bar in self.bars if bar.held_at_ends)]

    @property
    def planes(self) -> list[core.Plane | core.Joints]:
        """The groups of plane elements and joints, in the order of the mesh."""
        return [group for group in self.groups if isinstance(group, core.Plane | core.Joints)]

    @property
    def continues(self) -> bool:
        """Whether equilibrium iterations may follow the wall: dry joints end in the mechanism of limit analysis by events."""
        joints = [g for g in self.groups if isinstance(g, core.Joints)]
        return not joints or any(g.tension is not None or g.cohesion is not None for g in joints)

    def refuse_free(self, error: core.FreeNode) -> Refused:
        """The refusal of a node that nothing holds."""
        x, y = self.mesh.xy[error.node]
        return Refused(
            f"the wall is a mechanism: node {error.node + 1} at x {x:g} m, y {y:g} m can move freely in "
            f"{error.direction}; {_coincident(self.mesh) or 'add supports'}",
            ("supports", "held"),
        )


def _coincident(mesh: Mesh) -> str:
    """Names two nodes at one place, at which the mesh falls apart; empty where there are none."""
    from scipy.spatial import cKDTree

    pairs = cKDTree(mesh.xy).query_pairs(1e-6 * mesh.size, output_type="ndarray")
    if not len(pairs):
        return ""
    one, two = pairs[np.lexsort(pairs.T[::-1])[0]]
    x, y = mesh.xy[one]
    return (
        f"nodes {one + 1} and {two + 1} have the same position, x {x:g} m, y {y:g} m ({len(pairs)} such pairs), so the "
        "mesh is not connected there: merge these nodes"
    )


def build(mesh: Mesh, options: Sla, strength: np.ndarray | None = None) -> SlaModel:
    """Model of a wall; `strength` factors of the tensile strength by element, block after block."""
    try:
        return _build(mesh, options, strength)
    except BadGeometry as error:
        raise refusal(error) from None


def refusal(error: BadGeometry) -> Refused:
    """What a wall is refused for, with the key that its words begin with: "stages[0].free[1]: no node ..."."""
    named = re.match(r"((?:\w|\.|\[\d+\])+)(?: is|:) ", str(error))
    key: Key = tuple(int(part) if part.isdigit() else part for part in re.findall(r"\w+", named[1] if named else ""))
    if key[:2] == ("supports", "held"):
        return Refused(str(error), key)
    return Refused(str(error), ("structure", *key) if key[:1] == ("ties",) else ("analysis", *key))


def spring_groups(springs: list[tuple[int, int, float]]) -> list[core.Springs]:
    """The group of springs to the ground, by node, direction and stiffness [N/m]; none without any."""
    if not springs:
        return []
    nodes, ways, stiffness = (np.array(column) for column in zip(*springs, strict=True))
    ground = np.full(len(nodes), -1)
    return [core.Springs(np.column_stack([nodes, ground]), np.column_stack([ways, ways]), stiffness.astype(float))]


#: Node, direction and share of a displacement that is one with others
Term = tuple[int, int, float]


def _held(mesh: Mesh) -> tuple[set[tuple[int, int]], list[tuple[int, int, float]]]:
    """Nodes and directions that supports hold, and those on springs with their stiffness [N/m]."""
    held: set[tuple[int, int]] = set()
    springs: list[tuple[int, int, float]] = []
    for i, support in enumerate(mesh.held):
        for node in mesh.nodes_at(support, f"supports.held[{i}]").tolist():
            for letter in support.fix:
                if support.stiffness is None:
                    held.add((node, AXES[letter]))
                else:
                    springs.append((node, AXES[letter], support.stiffness))
    if mesh.ground is not None:
        held |= {(node, axis) for node in mesh.ground.tolist() for axis in (0, 1)}
    return held, springs


def _freedoms(mesh: Mesh, held: set[tuple[int, int]], moved: Load | None) -> tuple[core.Freedoms, list[Term]]:
    """The freedoms of the nodes, and the common displacement that the load `moved` prescribes."""
    ties = [[(int(n), AXES[tie.direction], 1.0) for n in mesh.nodes_at(tie, f"ties[{i}]")] for i, tie in enumerate(mesh.ties)]
    common: list[Term] = []
    if moved is not None:
        for part in moved.parts:
            common += [(int(n), AXES[moved.direction], part.ratio) for n in mesh.nodes_at(part, "displacement")]
        if all(share == 0.0 for _, _, share in common):
            raise BadGeometry("displacement: every `ratio` is 0, so nothing moves: give a `ratio` other than 0")
        if len({n for n, _, _ in common}) < len(common):
            raise BadGeometry("two parts of the displacement have a node in common: give places that do not overlap")
        ties.append(common)
    tied = {(n, d) for tie in ties for n, d, _ in tie}
    if clash := held & tied:
        node, direction = min(clash)
        raise BadGeometry(
            f"node {node + 1} at x {mesh.xy[node, 0]:g} m, y {mesh.xy[node, 1]:g} m is both restrained and tied "
            f"in {'xy'[direction]}: remove one of the two"
        )
    try:
        freedoms = core.Freedoms.make(len(mesh.xy), sorted(held), ties)
    except ValueError as error:
        raise BadGeometry(str(error)) from None
    if not (freedoms.equation >= 0).any():
        raise BadGeometry("every node is restrained, so nothing can move: remove supports")
    return freedoms, common


def _behaviour(mesh: Mesh, options: Sla, several: bool) -> tuple[core.Behaviour, float]:
    """How cracks and joints behave, and the growth of the compliance that ends a run; several: loads stay on while
    others grow."""
    closure = options.crack_closure
    if closure is None:  # a single growing load hardly closes a crack
        rotates = options.cracking == "rotating"
        closure = mesh.has_joints or (rotates and several)
    if mesh.has_joints and not closure:
        raise BadGeometry("joints between blocks always open and close: crack_closure = false is only for walls without blocks")
    floor = FLOOR_OF_JOINTS if mesh.has_joints else core.Behaviour.floor
    ratio = options.mechanism_ratio or (MECHANISM_OF_STONES if mesh.has_joints else MECHANISM)
    if ratio > MOST_OF_FLOOR / floor:
        raise BadGeometry(
            f"mechanism_ratio: {ratio:g} is too large: cracks keep {floor:g} of their stiffness, which would "
            f"carry the load. Give at most {MOST_OF_FLOOR / floor:g}"
        )
    most = MOST_CHANGES_OF_JOINTS if mesh.has_joints else core.Behaviour.most_changes
    return core.Behaviour(options.cracking, options.shear_retention, closure, most, floor, options.crack_band_rule == "extent"), ratio


def _build(mesh: Mesh, options: Sla, strength: np.ndarray | None) -> SlaModel:
    held, springs = _held(mesh)
    if mesh.has_joints and options.cracking == "isotropic":
        raise BadGeometry("joints open perpendicular to their own direction, so isotropic cracking is only for walls without blocks")
    constant_loads, reference_loads = loads_of(mesh, options)
    moved = next((load for load in reference_loads if load.kind == "displacement"), None)
    freedoms, common = _freedoms(mesh, held, moved)
    groups: list[core.Group] = []
    bands, points = [], []
    start = 0
    for group in mesh.groups:
        count = len(group.connect)
        factors = np.ones(count) if strength is None else strength[start : start + count]
        start += count
        band, reach = crack_bands(mesh, group, options)
        groups.append(
            _plane(mesh, group, band, reach, factors, options) if group.law is None else _joints(group, group.law, factors, options)
        )
        bands.append(band)
        points.append(point_positions(mesh.xy, group))
    named: list[NamedBar] = []
    made = [(f"bar {k}", *_bar(mesh, bar, options)) for k, bar in enumerate(mesh.bars, 1)]
    made += [(tie.name or "", tie_group(mesh, tie, rod, options), rod.place) for tie, rod in mesh.rods]
    for name, bars, place in made:
        groups.append(bars)
        named.append(NamedBar(name, bars, sum(len(bar.place) for bar in named), place))
    groups += spring_groups(springs)
    for i, x in enumerate(options.section_x):
        if not mesh.low[0] <= x <= mesh.high[0]:
            raise BadGeometry(f"section_x[{i}] is {x:g} m, but the wall extends from {mesh.low[0]:g} to {mesh.high[0]:g} m")
    constant = nodal_forces(mesh, constant_loads, "constant")
    reference = nodal_forces(mesh, reference_loads, "reference")
    if moved is not None:
        node, direction, share = max(common, key=lambda term: abs(term[2]))
        reference[node, direction] = 1.0 / share  # unit force on the common displacement
        unit = 1.0
    else:
        unit = resultant(reference) if not options.stages else 1.0  # each stage has its own
    if not options.stages and (freedoms.equation[np.abs(reference) > 0] < 0).all():
        raise BadGeometry("the reference load acts only on nodes that are restrained: load other nodes")
    behaviour, ratio = _behaviour(mesh, options, bool(constant_loads or options.stages))
    # Of stages, of which each has its own, that while the constant loads come on
    growing = reference if not options.stages else constant
    control = control_of(mesh, options, growing, 1.0 if options.stages else unit) if growing.any() else core.Monitor.of(0, 0)
    return SlaModel(
        mesh=mesh,
        freedoms=freedoms,
        groups=groups,
        behaviour=behaviour,
        constant=constant,
        reference=reference,
        unit=unit,
        control=control,
        bands=bands,
        point_xy=np.concatenate(points),
        mechanism_ratio=ratio,
        acceleration=acceleration_of(reference_loads),
        bars=named,
    )


def resultant(reference: np.ndarray) -> float:
    """The resultant of nodal forces [N]; of those without one, half of the sum of their sizes."""
    total = float(np.hypot(*reference.sum(axis=0)))
    unit = total if total > 1e-9 * np.abs(reference).sum() else 0.5 * float(np.abs(reference).sum())
    if not unit > 0.0:
        raise BadGeometry("the reference load is zero")
    return unit


def acceleration_of(loads: list[Load]) -> float | None:
    """The acceleration of loads that are masses alone [m/s^2]."""
    if not loads or any(load.kind != "gravity" for load in loads):
        return None
    return float(np.hypot(*np.sum([[load.ax, load.ay] for load in loads], axis=0)))


def loads_of(mesh: Mesh, options: Sla) -> tuple[list[Load], list[Load]]:
    """The constant and the reference loads, with the defaults of the tables for those not given."""
    constant, reference = options.constant, options.reference
    if options.stages:
        heavy = mesh.mass is not None or any(material.density > 0.0 for material in mesh.materials)
        return [Load(kind="gravity")] * heavy if constant is None else constant, []
    if constant is None:
        constant = [Load(kind="gravity")] if reference is None or mesh.has_joints else []
    return constant, [Load(kind="gravity", ax="1 g", ay="0 g")] if reference is None else reference


def crack_bands(mesh: Mesh, group: ElementGroup, options: Sla) -> tuple[np.ndarray, np.ndarray | None]:
    """h of each element [m], and (elements, 2) its least and greatest where it follows from the crack's direction.

    The thickness of a row along a joint; or given; or the width or the extent of a linear element across the crack
    (fortran/sla/plane_points.f90), that of a mean direction for what crushes; or by the area: sqrt(2 A) of linear elements,
    sqrt(A) of quadratic ones, in which cracks keep to a part of the element.
    """
    if group.band is not None:
        return np.full(len(group.connect), group.band), None
    return bands_of(mesh.xy, group.kind, group.connect, options)


def bands_of(xy: np.ndarray, kind: str, connect: np.ndarray, options: CrackOptions) -> tuple[np.ndarray, np.ndarray | None]:
    """As crack_bands, of elements of a kind in a plane: nodes xy (nodes, 2) [m], connect (elements, nodes)."""
    if options.crack_band is not None:
        return np.full(len(connect), options.crack_band), None
    area = element_areas(xy, kind, connect)
    if kind in ("T6", "Q8"):
        return np.sqrt(area), None
    if options.crack_band_rule == "area":
        return np.sqrt(2.0 * area), None
    c = xy[connect[:, : corner_count(kind)]]
    if kind == "T3":
        longest = np.hypot(*np.moveaxis(np.roll(c, -1, axis=1) - c, 2, 0)).max(axis=1)
        return np.sqrt(2.0 * area), np.column_stack([2.0 * area / longest, longest])
    if options.crack_band_rule == "extent":
        # least across a side, greatest between two corners
        side, apart = np.roll(c, -1, axis=1) - c, c[:, :, None] - c[:, None]
        far = np.abs(side[:, :, None, 0] * apart[..., 1] - side[:, :, None, 1] * apart[..., 0]).max(axis=2)
        least = (far / np.hypot(*np.moveaxis(side, 2, 0))).min(axis=1)
        return np.sqrt(area), np.column_stack([least, np.hypot(*np.moveaxis(apart, 3, 0)).max(axis=(1, 2))])
    one, two = c[:, 2] - c[:, 0], c[:, 3] - c[:, 1]
    across = np.maximum(np.hypot(*(one + two).T), np.hypot(*(one - two).T))
    return np.sqrt(area), np.column_stack([2.0 * area / across, np.maximum(np.hypot(*one.T), np.hypot(*two.T))])


def softening_of(material: Material, options: CrackOptions, factor: float = 1.0) -> core.Softening | None:
    """The tension softening of a material, its strength times `factor`; None where it does not crack."""
    if material.tensile_strength is None or material.fracture_energy is None:
        return None
    return core.Softening(
        material.tensile_strength * factor,
        material.fracture_energy,
        material.softening,
        options.ripple,
        options.teeth == "exact",
        options.overshoot,
    )


def hills_of(materials: Sequence[Material], linear: np.ndarray, options: CrackOptions) -> list[core.Hill | None] | None:
    """Compressive strength that depends on the direction, of each element; None where none has it."""
    found: list[core.Hill | None] = []
    for material, stays in zip(materials, linear.tolist(), strict=True):
        along, across = material.compressive_strength_parallel, material.compressive_strength
        if stays or along is None or across is None:
            found.append(None)
            continue
        angle = float(np.radians(material.bed_angle))
        found.append(core.Hill(angle, along / across, material.compressive_coupling, material.compressive_shear))
    if not any(criterion is not None for criterion in found):
        return None
    if options.cracking == "isotropic":
        raise BadGeometry(
            "`compressive_strength_parallel` requires cracks with a direction, and isotropic cracking has none: remove this key"
        )
    return found


def bedding_of(material: Material) -> core.Bedding | None:
    """Bed joints of masonry whose strength depends on the direction."""
    along, across = material.tensile_strength_parallel, material.tensile_strength
    if along is None or across is None or material.fracture_energy is None:
        return None
    energy = material.fracture_energy_parallel or material.fracture_energy
    shear = 1.0 if material.shear_strength is None else max(1.0, float(np.sqrt(along * across)) / material.shear_strength)
    return core.Bedding(np.radians(material.bed_angle), along / across, energy / material.fracture_energy, shear)


def crushing_of(material: Material, options: CrackOptions) -> core.Softening | None:
    """The softening of a material in compression; None where it does not crush."""
    if material.crushing_energy is None or material.compressive_strength is None:
        return None
    return core.Softening(
        material.compressive_strength,
        material.crushing_energy,
        material.crushing,
        options.ripple,
        options.teeth == "exact",
        options.overshoot,
    )


def values_of(
    materials: Sequence[Material],
    linear: np.ndarray,
    factors: np.ndarray,
    band: np.ndarray,
    reach: np.ndarray | None,
    options: CrackOptions,
) -> dict[str, Any]:
    """The fields of a core.Plane that follow from the material of each element; BadGeometry where a crack band snaps back."""
    crushing = [None if s else crushing_of(m, options) for m, s in zip(materials, linear, strict=True)]
    tension = [None if s else softening_of(m, options, float(f)) for m, s, f in zip(materials, linear, factors, strict=True)]
    beds = [None if t is None else bedding_of(m) for m, t in zip(materials, tension, strict=True)]
    if options.cracking == "isotropic" and any(bed is not None for bed in beds):
        raise BadGeometry("`tensile_strength_parallel` requires cracks with a direction, and isotropic cracking has none: remove this key")
    # Across its weakest direction bedded masonry has the teeth of another band, see core.Bedding
    widest = (band if reach is None else reach[:, 1]) * [1.0 if bed is None else bed.stretch()[1] for bed in beds]
    for rows, widths, energy in ((tension, widest, "fracture_energy"), (crushing, band, "crushing_energy")):
        for k in np.argsort(-widths):
            if rows[k] is not None:
                limit = core.largest_band(rows[k], materials[k].young)
                if widths[k] >= limit:
                    raise BadGeometry(
                        f"{energy} is too small for the size of the elements: with a crack band of {widths[k]:.4g} m the softening law "
                        f"snaps back. The greatest possible band is {limit:.4g} m: use smaller elements"
                    )
    return {
        "young": np.array([m.young for m in materials]),
        "nu": np.array([m.poisson for m in materials]),
        "band": band,
        "tension": tension if any(t is not None for t in tension) else None,
        "compression": crushing if any(c is not None for c in crushing) else None,
        "lateral": np.array([m.compressive_strength if m.lateral_reduction else 0.0 for m in materials]),
        "reach": reach,
        "confinement": np.array([m.confinement for m in materials]),
        "bedding": beds if any(bed is not None for bed in beds) else None,
        "hill": hills_of(materials, linear, options),
    }


def _plane(mesh: Mesh, group: ElementGroup, band: np.ndarray, reach: np.ndarray | None, factors: np.ndarray, options: Sla) -> core.Plane:
    return core.Plane(
        group.kind,
        group.connect,
        group.thickness,
        axis=group.axis,
        points=group.gauss,
        selective=mesh.selective and group.kind == "Q4",
        joint=group.joint is not None,
        **values_of([mesh.materials[m] for m in group.material], group.linear, factors, band, reach, options),
    )


def _joints(group: ElementGroup, law: JointLaw, factors: np.ndarray, options: Sla) -> core.Joints:
    """Joints of no thickness; `factors` of their tensile strength and cohesion."""
    tension, crushing, cohesion = teeth_of_joints(law, factors, options)
    return core.Joints(
        group.connect,
        law.normal,
        law.area,
        law.normal_stiffness,
        law.shear_stiffness,
        law.friction,
        tension,
        crushing,
        cohesion,
        False if group.dry is None else group.dry,
        law.small,
        options.friction_ripple,
    )


#: Softening by element; None where none softens
Softenings = list[core.Softening | None] | None


def teeth_of_joints(law: JointLaw, factors: np.ndarray, options: CrackOptions) -> tuple[Softenings, Softenings, Softenings]:
    """How tension, compression and cohesion of joints soften, by element."""

    def softenings(strength: np.ndarray, energy: np.ndarray) -> Softenings:
        made: dict[tuple[float, float], core.Softening] = {}
        rows = []
        for pair in zip(strength.tolist(), energy.tolist(), strict=True):
            if pair[0] > 0.0 and pair not in made:
                made[pair] = core.Softening(*pair, law.softening, options.ripple, options.teeth == "exact", options.overshoot)
            rows.append(made.get(pair))
        return rows if made else None

    tension = softenings(law.tension * factors, law.fracture_energy)
    crushing = softenings(law.compressive_strength, law.crushing_energy)
    cohesion = softenings(law.cohesion * factors, law.shear_energy)
    for name, rows, stiffness in (
        ("fracture_energy", tension, law.normal_stiffness),
        ("crushing_energy", crushing, law.normal_stiffness),
        ("shear_energy", cohesion, law.shear_stiffness),
    ):
        for row, k in zip(rows or [], stiffness.tolist(), strict=False):
            if row is not None and core.largest_band(row, k) <= 1.0:
                raise BadGeometry(
                    f"joints.{name} is too small for a joint stiffness of {k:.4g} Pa/m: the softening law would snap back. Give "
                    f"more than {row.energy / core.largest_band(row, k):.4g} N/m"
                )
    return tension, crushing, cohesion


def _bar(mesh: Mesh, bar: Bar, options: Sla) -> tuple[core.Bars, np.ndarray]:
    material = mesh.named[bar.material]
    return bar_group(mesh, bar, softening_of(material, options), crushing_of(material, options), options)


def point_positions(xy: np.ndarray, group: ElementGroup) -> np.ndarray:
    """Integration points (points, 2) [m], as the core orders them; sides are straight."""
    corners = xy[group.connect[:, : corner_count(group.kind)]]
    if group.law is not None:
        return xy[group.connect[:, :2]].reshape(-1, 2)
    if group.kind == "T3":
        share = np.full((1, 3), 1.0 / 3.0)
    elif group.kind == "T6":
        share = np.array([[4, 1, 1], [1, 4, 1], [1, 1, 4]]) / 6.0
    else:
        gx, gy = (np.polynomial.legendre.leggauss(n)[0] for n in group.gauss)
        r, s = (a.ravel() for a in np.meshgrid(gx, gy))
        share = 0.25 * np.column_stack([(1 - r) * (1 - s), (1 + r) * (1 - s), (1 + r) * (1 + s), (1 - r) * (1 + s)])
    return np.einsum("pc,ecx->epx", share, corners).reshape(-1, 2)


def nodal_forces(mesh: Mesh, loads: Sequence[Load], word: str) -> np.ndarray:
    """Consistent nodal forces (nodes, 2) [N]."""
    force = np.zeros_like(mesh.xy)
    for i, load in enumerate(loads):
        what = f"{word}[{i}]"
        if load.kind == "gravity":
            if mesh.mass is not None:
                force += mesh.mass[:, None] * [load.ax, load.ay]
            heavy = mesh.mass is not None
            for group in mesh.groups if mesh.mass is None else []:
                density = np.array([m.density for m in mesh.materials])[group.material]
                heavy |= bool((density > 0).any())
                per_area = (density * group.thickness)[:, None] * [load.ax, load.ay]
                force += core.body_force(group.kind, group.gauss, mesh.xy, group.connect, per_area)
            if not heavy:
                raise BadGeometry(f"{what}: gravity requires weight: give the material a density")
        elif load.kind == "point":
            nodes, share = mesh.shares_at(Placed(edge=load.edge, x=load.x, y=load.y), what)
            force[nodes] += share[:, None] * [load.fx, load.fy]
        elif load.kind != "displacement":
            force += _edge_load(mesh, load, what)
    return force


def _edge_load(mesh: Mesh, load: Load, what: str) -> np.ndarray:
    """Consistent nodal forces of a load along boundary edges; of an edge that reaches out of the place, its part
    inside is loaded."""
    edges, thickness = mesh.boundary()
    begin, end = _covered(mesh, load, edges)
    if load.edge is not None and load.kind != "spread":
        letter, axis = ("y", 1) if load.edge in ("left", "right") else ("x", 0)
        asked, slack = getattr(load, letter), 1e-6 * float(np.max(mesh.high - mesh.low))
        if asked is not None and (asked[0] < mesh.low[axis] - slack or asked[1] > mesh.high[axis] + slack):
            raise BadGeometry(
                f"{what}: {letter} from {asked[0]:g} to {asked[1]:g} m extends beyond the wall ({mesh.low[axis]:g} to "
                f"{mesh.high[axis]:g} m), so a part of the load would be lost: give a range within the wall"
            )
    mine = end > begin
    if not mine.any():
        raise BadGeometry(
            f"{what}: no side of a boundary element lies within {words_of_place(load.edge, load.x, load.y)}. Add a mesh line there"
        )
    edges, thickness, begin, end = edges[mine], thickness[mine], begin[mine], end[mine]
    along = mesh.xy[edges[:, 1]] - mesh.xy[edges[:, 0]]
    length = np.hypot(*along.T)
    if load.kind == "pressure":
        normal = np.column_stack([along[:, 1], -along[:, 0]])  # outward, times the length
        total = -load.value * thickness[:, None] * normal
    else:
        covered = float(((end - begin) * length).sum())
        per = np.array([load.px, load.py]) if load.kind == "line" else np.array([load.fx, load.fy]) / covered
        total = length[:, None] * per
    # Integrals of 1, t and t^2 over the part, t from 0 to 1 along the edge, give those of the shape functions
    one, t, tt = (end - begin), (end**2 - begin**2) / 2, (end**3 - begin**3) / 3
    quadratic, whole = edges[:, 2] >= 0, (begin == 0.0) & (end == 1.0)
    first = np.where(quadratic, one - 3 * t + 2 * tt, one - t)
    second = np.where(quadratic, 2 * tt - t, t)
    first, second = (np.where(whole, np.where(quadratic, 1 / 6, 0.5), share) for share in (first, second))
    middle = np.where(whole, 4 / 6, 4 * (t - tt))
    force = np.zeros_like(mesh.xy)
    for column, share in ((0, first), (1, second)):
        np.add.at(force, edges[:, column], share[:, None] * total)
    if quadratic.any():
        np.add.at(force, edges[quadratic, 2], middle[quadratic, None] * total[quadratic])
    return force


def _covered(mesh: Mesh, load: Load, edges: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The part of each straight edge within a place, as fractions from its first node; begin >= end where none is."""
    tolerance = 1e-6 * float(np.max(mesh.high - mesh.low))
    ranges: list[Sequence[float] | None] = [load.x, load.y]
    if load.edge is not None:
        axis = 0 if load.edge in ("left", "right") else 1
        at = float((mesh.low if load.edge in ("left", "bottom") else mesh.high)[axis])
        low, high = ranges[axis] or (at, at)
        if low > at + tolerance or high < at - tolerance:
            return np.ones(len(edges)), np.zeros(len(edges))
        ranges[axis] = (at, at)
    begin, end = np.zeros(len(edges)), np.ones(len(edges))
    for axis, ends in enumerate(ranges):
        if ends is None:
            continue
        a, b = mesh.xy[edges[:, 0], axis], mesh.xy[edges[:, 1], axis]
        level = np.abs(b - a) <= tolerance
        step = np.where(level, 1.0, b - a)
        cuts = np.sort(np.stack([(ends[0] - a) / step, (ends[1] - a) / step]), axis=0)
        outside = level & ((np.minimum(a, b) < ends[0] - tolerance) | (np.maximum(a, b) > ends[1] + tolerance))
        # A place that ends at a node, but for rounding, ends there
        slack = np.where(level, 0.0, tolerance / np.abs(step))
        cuts = np.where(np.abs(cuts) <= slack, 0.0, np.where(np.abs(cuts - 1.0) <= slack, 1.0, cuts))
        begin = np.where(level, begin, np.maximum(begin, cuts[0]))
        end = np.where(level, np.where(outside, -1.0, end), np.minimum(end, cuts[1]))
    return begin, end


def control_of(mesh: Mesh, options: Sla, reference: np.ndarray, unit: float) -> core.Monitor:
    """The control displacement; by default the one on which the reference load does its work."""
    if not options.control:
        node, direction = np.nonzero(reference)
        return core.Monitor(node, direction, reference[node, direction] / unit)
    parts = []
    for i, term in enumerate(options.control):
        nodes = mesh.nodes_at(term, f"control[{i}]")
        parts.append((nodes, np.full(len(nodes), AXES[term.direction]), np.full(len(nodes), term.weight / len(nodes))))
    return core.Monitor(*(np.concatenate(column) for column in zip(*parts, strict=True)))


def strength_factors(mesh: Mesh, options: Sla, seed: int) -> np.ndarray | None:
    """Lognormal factors of ft with mean 1 by element, correlated over strength_length; None without scatter."""
    if options.strength_variation == 0.0:
        return None
    centres = np.concatenate([mesh.xy[b.connect[:, : corner_count(b.kind)]].mean(axis=1) for b in mesh.groups])
    rng = np.random.default_rng(seed)
    sigma = np.sqrt(np.log1p(options.strength_variation**2))
    length = options.strength_length
    if length is None or length <= mesh.size:
        field = rng.standard_normal(len(centres))
    else:
        # Spectral representation of a Gaussian correlation exp(-r^2 / length^2)
        waves = 400
        number = rng.normal(0.0, np.sqrt(2.0) / length, (waves, 2))
        phase = rng.uniform(0.0, 2.0 * np.pi, waves)
        field = np.sqrt(2.0 / waves) * np.cos(centres @ number.T + phase).sum(axis=1)
    return np.exp(sigma * field - 0.5 * sigma**2)
