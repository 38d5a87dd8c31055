"""A building of shells and the options of its deck made into a model of the core: freedoms, groups, nodal forces."""

from dataclasses import dataclass, field, replace

import numpy as np

from extrados.analyses.context import Refused
from extrados.analyses.shell.tables import Drive, Pushover, Settlement
from extrados.analyses.sla.curve import SLID_ALONG, SLID_OFF
from extrados.analyses.sla.events import Curve
from extrados.analyses.sla.kept import State
from extrados.analyses.sla.model import (
    MOST_CHANGES_OF_JOINTS,
    EventModel,
    bands_of,
    crushing_of,
    refusal,
    softening_of,
    spring_groups,
    teeth_of_joints,
    values_of,
)
from extrados.core import sla as core
from extrados.core.shell import layers_of, node_frames, shell_axes
from extrados.model.errors import BadGeometry
from extrados.schema.constants import GRAVITY
from extrados.views.mesh.mesh import JointLaw
from extrados.views.shell.mesh import ShellBar, ShellJoint, ShellMesh, ShellPart

#: Iterations of the lowest modes; the vectors that go with them
ROUNDS, VECTORS = 12, 4


@dataclass(kw_only=True)
class ShellModel(EventModel):
    """A building ready for the core."""

    mesh: ShellMesh
    along: np.ndarray  # (3) direction of the push
    weight: float  # [N]
    axes: list[np.ndarray]  # of the elements of each part, rows x, y, normal
    grounds: dict["Ground", int] = field(default_factory=dict)  # ground that may give way: which of what may move it is
    stands: np.ndarray = field(default_factory=lambda: np.empty(0))  # how far each has at the start of a stage [m]
    rate: np.ndarray = field(default_factory=lambda: np.empty(0))  # and goes on to with the multiplier, in a stage [m]
    warnings: list[str] = field(default_factory=list)

    @property
    def place(self) -> np.ndarray:
        """Places of the nodes (nodes, 3) [m]."""
        return self.mesh.xyz

    @property
    def point_count(self) -> int:
        """Integration points of the shells."""
        return sum(len(g.connect) * g.points_each for g in self.groups if isinstance(g, core.Shells))

    @property
    def reach(self) -> float:
        """Height of the building, over which a drift is counted [m]."""
        return float(np.ptp(self.mesh.xyz[:, 2]))

    @property
    def driven(self) -> bool:
        """Whether the multiplier moves supports."""
        return bool(self.rate.any())

    @property
    def steps_alone(self) -> bool:
        """Whether they follow it from the first load on: joints slide out of the plane of their wall in steps alone."""
        return self.slides

    @property
    def watched(self) -> list[core.Monitor]:
        """The control displacement, and how far the ends of floors have moved off their seats, seat by seat."""
        return [self.control, *(m for seat in self.seats for way in (seat.inward, seat.along[0]) for m in _slips(seat, way))]

    @property
    def seats(self) -> list[ShellJoint]:
        """Seats of floors."""
        return [joint for joint in self.mesh.joints if joint.floor]

    def slips(self, monitors: np.ndarray) -> list[np.ndarray]:
        """How far each floor has moved on each of its seats (events, 2) [m], the most of all its ends: off the seat, and along the wall in
        either sense. monitors: as recorded."""
        found, first = [], 1
        for seat in self.seats:
            count = len(seat.connect) + 1
            off, along = (monitors[:, first + k * count : first + (k + 1) * count] for k in range(2))
            found.append(np.column_stack([off.max(axis=1), np.abs(along).max(axis=1)]))
            first += 2 * count
        return found

    def ends(self, part: core.Events) -> str:
        """A floor that has moved on its seat by more than the length of the seat ends a run."""
        if not len(part):
            return ""
        beyond = [slip[-1] > seat.thickness[0] for seat, slip in zip(self.seats, self.slips(part.monitors), strict=True)]
        return SLID_OFF if any(off for off, _ in beyond) else SLID_ALONG if any(along for _, along in beyond) else ""

    def refuse_free(self, error: core.FreeNode) -> Refused:
        """The refusal of a node that nothing holds."""
        x, y, z = self.mesh.xyz[error.node]
        return Refused(
            f"the building is a mechanism: node {error.node + 1} at x {x:g}, y {y:g}, z {z:g} m can move freely in "
            f"{error.direction}, because the structure is not supported there",
            ("structure",),
        )

    def borne(self, options: Pushover, curve: Curve, state: State, threads: int) -> np.ndarray:
        """What each ground bears in a state [N], in the direction in which it may give way."""
        moved = self.stands + state.load * self.rate if len(self.rate) else self.stands
        constant, reference = self.constant, self.reference * (1 if curve.name else curve.sign)
        with self.open(options, threads) as core_model:
            core_model.set_damage(state.damage)
            core_model.supports(moved, np.zeros(len(moved)))
            load = constant + state.load * reference
            core_model.loads(load, np.zeros_like(load), carried=True)
            inner = core_model.reactions()[:, 0]
        # What acts on the support itself the ground bears too
        equation = self.freedoms.equation - (int(self.freedoms.equation.max()) + 1 - len(moved))
        own = np.zeros(len(moved))
        np.add.at(own, equation[equation >= 0], (self.freedoms.factor * load)[equation >= 0])
        return own - inner

    def joints(self) -> list[tuple[ShellJoint, slice]]:
        """The joints and the points of each."""
        found, first, joints = [], 0, iter(self.mesh.joints)
        for group in self.groups[: len(self.mesh.parts) + len(self.mesh.joints)]:
            if not isinstance(group, core.Shells | core.ShellJoints):
                continue
            count = len(group.connect) * group.points_each
            if isinstance(group, core.ShellJoints):
                found.append((next(joints), slice(first, first + count)))
            first += count
        return found

    def places(self) -> list[tuple[ShellPart, slice, int]]:
        """Parts that bend, the points of each, and the layers: its points are (elements, places, layers)."""
        found, first = [], 0
        for part, group in zip(self.mesh.parts, self.groups, strict=False):
            assert isinstance(group, core.Shells)  # the parts come first
            count = len(group.connect) * group.points_each
            if part.bends:
                found.append((part, slice(first, first + count), group.layers))
            first += count
        return found


def build(mesh: ShellMesh, options: Pushover) -> ShellModel:
    """Model of a building; Refused says what does not fit."""
    try:
        return _build(mesh, options)
    except BadGeometry as error:
        raise refusal(error) from None


def _build(mesh: ShellMesh, options: Pushover) -> ShellModel:
    frames, flat = node_frames(mesh.xyz, [part.connect for part in mesh.parts if part.bends])
    flat &= ~_twisted(mesh, frames)
    held = set(mesh.held) | {(int(n), 5) for n in np.flatnonzero(flat)}
    along = _way(options.direction)
    groups: list[core.Group] = []
    ties: list[list[tuple[int, int, float]]] = []
    axes: list[np.ndarray] = []
    if options.drives:
        ties.append(_tie(mesh, options, along, held))
    moved, grounds = _grounds(mesh, options, held)
    freedoms = core.Freedoms.make(len(mesh.xyz), sorted(held), [*moved, *ties], of_node=6)
    if moved:  # those of the supports that move come last
        count, number = int(freedoms.equation.max()) + 1, freedoms.equation
        freedoms = core.Freedoms(np.where(number < 0, -1, (number - len(moved)) % count), freedoms.factor, len(moved))
    for part in mesh.parts:
        own = shell_axes(mesh.xyz, part.connect)
        axes.append(own)
        groups.append(_shells(mesh, part, own, frames, flat, options))
    groups += [_joint(joint, frames, options) for joint in mesh.joints]
    for bar in mesh.bars:
        groups.append(_bar(mesh, bar, options))
    groups += spring_groups(mesh.springs)
    if options.without_equilibrium not in ("load-unload", "continue") and any(np.isfinite(j.strength["friction"]) for j in mesh.joints):
        raise Refused(
            'only the methods "continue" and "load-unload" can follow joints that slide. Give the joints '
            'friction = "no-sliding", or remove `without_equilibrium`',
            ("analysis", "without_equilibrium"),
        )
    if options.without_equilibrium != "continue" and any(joint.floor for joint in mesh.joints):
        raise Refused(
            'only without_equilibrium = "continue" can follow floors that slide on their seats. Remove `without_equilibrium`, or the seats',
            ("analysis", "without_equilibrium"),
        )
    mass = mesh.mass()
    constant = np.zeros((len(mesh.xyz), 6))
    constant[:, 2] = -GRAVITY * mass
    constant[:, :3] += mesh.push
    for bar in mesh.bars:
        if bar.prestress:
            way = mesh.xyz[bar.nodes[1]] - mesh.xyz[bar.nodes[0]]
            pull = bar.prestress * way / np.linalg.norm(way)
            constant[bar.nodes[0], :3] += pull
            constant[bar.nodes[1], :3] -= pull
    reference = np.zeros_like(constant)
    weight, acceleration = float(GRAVITY * mass.sum()), None
    if not weight > 0.0:
        raise BadGeometry("the building has no weight: give the material a density")
    changes = MOST_CHANGES_OF_JOINTS if mesh.joints else core.Behaviour.most_changes
    extent = options.crack_band_rule == "extent"
    behaviour = core.Behaviour(options.cracking, options.shear_retention, options.closes, changes, extent=extent)
    control = _control(mesh, options, along, held)
    model = ShellModel(
        mesh=mesh,
        freedoms=freedoms,
        groups=groups,
        behaviour=behaviour,
        constant=constant,
        reference=reference,
        unit=1.0,
        control=control,
        along=along,
        weight=weight,
        axes=axes,
        mechanism_ratio=options.mechanism_ratio,
        grounds=grounds,
        settled=how_far(mesh, grounds, options.settlements),
    )
    model.stands = model.settled
    if options.drives:
        node, direction, share = max(ties[0], key=lambda term: abs(term[2]))
        reference[node, direction] = 1.0 / share  # a unit of force on the displacement they share
    else:
        reference[:] = mass_push(model, options, options.direction)[0]
        if options.pattern == "mass":
            acceleration = GRAVITY
        model.unit = float(np.abs(reference[:, :3] @ along).sum())
    model.acceleration = acceleration
    model.warnings += mesh.warnings
    return model


def _slips(seat: ShellJoint, way: np.ndarray) -> list[core.Monitor]:
    """Displacement of each end of a floor relative to its wall in a horizontal direction (3)."""
    pairs = np.vstack([seat.connect[:, [0, 3]], seat.connect[-1:, [1, 2]]])
    return [core.Monitor(np.repeat(pair[::-1], 2), np.tile([0, 1], 2), np.concatenate([way[:2], -way[:2]])) for pair in pairs]


def _way(direction: float) -> np.ndarray:
    """Unit vector (3) of a direction on the plan [deg]."""
    angle = np.radians(direction)
    along = np.array([np.cos(angle), np.sin(angle), 0.0])
    along[np.abs(along) < 1e-12] = 0.0
    return along


def mass_push(model: ShellModel, options: Pushover, direction: float) -> tuple[np.ndarray, np.ndarray]:
    """Nodal forces (nodes, 6) [N] of a push by the pattern in a direction on the plan [deg], and its unit vector."""
    along = _way(direction)
    mass, force = model.mesh.mass(), np.zeros((len(model.mesh.xyz), 6))
    model = replace(model, along=along)
    force[:, :3] = GRAVITY * (mass * _pattern(model, options, mass))[:, None] * along
    return force, along


def _level_of(mesh: ShellMesh, storey: int, what: str) -> float:
    if storey >= len(mesh.levels):
        raise BadGeometry(f"{what}: storey {storey} does not exist; the number of storeys is {len(mesh.levels) - 1}")
    return float(mesh.levels[storey])


def nodes_on(mesh: ShellMesh, wall: int, level: float) -> np.ndarray:
    """The nodes of a wall at a height."""
    nodes = mesh.wall_nodes(wall)
    return nodes[np.abs(mesh.xyz[nodes, 2] - level) < 1e-6]


def _place(mesh: ShellMesh, drive: Drive, what: str) -> np.ndarray:
    names = [wall.name for wall in mesh.walls]
    if drive.wall not in names:
        there = f"there are {', '.join(names)}" if names else "it has none"
        raise BadGeometry(f"{what}: wall '{drive.wall}' does not exist; {there}")
    nodes = nodes_on(mesh, names.index(drive.wall), _level_of(mesh, drive.storey, what))
    if not len(nodes):
        raise BadGeometry(f"{what}: wall '{drive.wall}' does not reach the top of storey {drive.storey}")
    return nodes


def _tie(mesh: ShellMesh, options: Pushover, along: np.ndarray, held: set) -> list[tuple[int, int, float]]:
    """Freedoms that move by given parts of one displacement."""
    if np.abs(along).max() < 1.0:
        raise BadGeometry("drives: an imposed displacement acts along x or y: give direction = 0, 90, 180 or 270")
    axis = int(np.abs(along).argmax())
    tie: dict[int, float] = {}
    for k, drive in enumerate(options.drives):
        for node in _place(mesh, drive, f"drives[{k}]").tolist():
            share = drive.ratio * float(along[axis])
            if tie.setdefault(node, share) != share:
                raise BadGeometry(f"drives[{k}]: a node of wall '{drive.wall}' already has a different ratio")
    if clash := [n for n in tie if (n, axis) in held]:
        raise BadGeometry(f"drives: node {clash[0] + 1} is restrained and cannot move: impose the displacement at another place")
    return [(n, axis, share) for n, share in sorted(tie.items())]


@dataclass(frozen=True)
class Ground:
    """Ground under a foot, or a part of it, that gives way in one direction."""

    foot: int  # of the mesh
    way: str  # "down" or "out"
    x: tuple[float, float] | None = None  # along the foot [m]


def _feet_of(mesh: ShellMesh, settlement: Settlement, what: str) -> list[int]:
    names = [foot.name for foot in mesh.feet]
    if settlement.foot == "all":
        return list(range(len(names)))
    if settlement.place not in names:
        word = "wall" if settlement.foot is None else "foot"
        raise BadGeometry(f"{what}: {word} '{settlement.place}' does not exist; expected one of {', '.join(names)}")
    return [names.index(settlement.place)]


def _grounds(mesh: ShellMesh, options: Pushover, held: set) -> tuple[list[list[tuple[int, int, float]]], dict[Ground, int]]:
    """Freedoms of the supports that may move, by ground; they are held no longer. Of a vault all may: what they bear is asked
    for."""
    asked: dict[Ground, str] = {} if mesh.walls else {Ground(f, way): "" for f in range(len(mesh.feet)) for way in ("out", "down")}
    every = [(f"settlements[{k}]", part) for k, part in enumerate(options.settlements)]
    for number, stage in enumerate(options.stages):
        every += [(f"stages[{number}].settlements[{k}]", part) for k, part in enumerate(stage.settlements)]
    for what, part in every:
        x = None if part.x is None else (part.x[0], part.x[1])
        for foot in _feet_of(mesh, part, what):
            for way in ("down", "out"):
                if getattr(part, way):
                    asked.setdefault(Ground(foot, way, x), what)
    ties: list[list[tuple[int, int, float]]] = []
    grounds: dict[Ground, int] = {}
    for ground, what in asked.items():
        support = mesh.feet[ground.foot]
        low, high = ground.x or (-np.inf, np.inf)
        inside = np.flatnonzero((support.along >= low - 1e-6) & (support.along <= high + 1e-6))
        free = [
            (int(support.nodes[i]), d, share)
            for i in inside
            for d, share in (((2, -1.0),) if ground.way == "down" else enumerate(support.out[i, :2].tolist()))
            if abs(share) > 1e-9 and (int(support.nodes[i]), d) in held
        ]
        if not free and not what:
            continue  # it is not held that way
        if not free:
            word = "wall" if mesh.walls else "foot"
            raise BadGeometry(
                f"{what}: at this place no support restrains {word} '{support.name}' in the direction `{ground.way}`, so "
                "none can move: give another place or direction"
            )
        held -= {(n, d) for n, d, _ in free}
        grounds[ground] = len(ties)
        ties.append(free)
    return ties, grounds


def how_far(mesh: ShellMesh, grounds: dict[Ground, int], settlements: list[Settlement]) -> np.ndarray:
    """How far each ground goes by some settlements [m]."""
    far = np.zeros(len(grounds))
    for part in settlements:
        x = None if part.x is None else (part.x[0], part.x[1])
        for foot in _feet_of(mesh, part, "settlements"):
            for way in ("down", "out"):
                if getattr(part, way):
                    far[grounds[Ground(foot, way, x)]] += getattr(part, way)
    return far


def _control(mesh: ShellMesh, options: Pushover, along: np.ndarray, held: set) -> core.Monitor:
    """The mean displacement in the direction of the push."""
    if options.control is not None:
        nodes = _place(mesh, options.control, "control")
    elif options.drives:
        nodes = np.unique(np.concatenate([_place(mesh, d, "drives") for d in options.drives if d.ratio == 1.0]))
    else:
        tops = [nodes_on(mesh, w, mesh.levels[-1]) for w in range(len(mesh.walls))]
        nodes = np.unique(np.concatenate(tops)) if tops else np.empty(0, dtype=int)
    if not len(nodes) and mesh.walls:
        raise BadGeometry("control: no wall reaches the highest level; name a wall and a storey")
    axis = np.flatnonzero(along)
    if options.control is None and all((int(n), int(d)) in held for n in nodes for d in axis):
        mass = mesh.mass()  # a propped top: what the forces of the push go
        nodes = np.flatnonzero(mass)
        share = mass[nodes] / mass.sum()
        return core.Monitor(np.repeat(nodes, len(axis)), np.tile(axis, len(nodes)), np.outer(share, along[axis]).ravel())
    return core.Monitor(np.repeat(nodes, len(axis)), np.tile(axis, len(nodes)), np.tile(along[axis] / len(nodes), len(nodes)))


def _pattern(model: ShellModel, options: Pushover, mass: np.ndarray) -> np.ndarray:
    """Factor on the mass of each node."""
    z = model.mesh.xyz[:, 2]
    if options.pattern == "triangular":
        return z * mass.sum() / (mass @ z)
    if options.pattern == "modal":
        shape, *_ = first_mode(model, options, mass)
        return shape * mass.sum() / (mass @ shape)
    return np.ones(len(z))


def first_mode(model: ShellModel, options: Pushover, mass: np.ndarray) -> tuple[np.ndarray, float, float]:
    """Displacement in the push's direction of the mode with the most mass in it, among the lowest few of the uncracked
    building; its frequency [Hz]; the part of the mass that takes part. By subspace iteration."""
    nodes = len(mass)
    rng = np.random.default_rng(1)
    start = [np.tile(model.along, (nodes, 1)), model.mesh.xyz[:, 2:] * model.along]
    start += [rng.standard_normal((nodes, 3)) for _ in range(VECTORS - len(start))]
    vectors = np.stack(start)
    zero = np.zeros((nodes, 6))
    with model.open(options, 1) as core_model:
        for _ in range(ROUNDS):
            found = []
            for vector in vectors:
                load = zero.copy()
                load[:, :3] = mass[:, None] * vector
                core_model.loads(zero, load)
                found.append(core_model.displacement(1.0)[:, :3])
            moved = np.stack(found)
            stiff = np.einsum("inx,n,jnx->ij", moved, mass, vectors)
            heavy = np.einsum("inx,n,jnx->ij", moved, mass, moved)
            inverse = np.linalg.inv(np.linalg.cholesky(heavy))
            values, turned = np.linalg.eigh(inverse @ (0.5 * (stiff + stiff.T)) @ inverse.T)
            vectors = np.einsum("ik,inx->knx", inverse.T @ turned, moved)
    part = np.array([(mass @ (v @ model.along)) ** 2 for v in vectors]) / mass.sum()  # of vectors with a unit of mass
    best = int(part.argmax())
    shape = vectors[best] @ model.along
    return shape * np.sign(mass @ shape), float(np.sqrt(values[best]) / (2.0 * np.pi)), float(part[best])


def _shells(mesh: ShellMesh, part: ShellPart, axes: np.ndarray, frames: np.ndarray, flat: np.ndarray, options: Pushover) -> core.Shells:
    corners = mesh.xyz[part.connect]
    local = np.einsum("eax,ecx->eca", axes[:, :2], corners - corners.mean(axis=1, keepdims=True)).reshape(-1, 2)
    alone = np.arange(len(local)).reshape(part.connect.shape)
    # Equal elements have equal bands: their tooth tables are made once
    band, reach = bands_of(local, part.kind, alone, options)
    band, reach = np.round(band, 9), None if reach is None else np.round(reach, 9)
    return core.Shells(
        part.kind,
        part.connect,
        part.thickness,
        selective=options.mesh.selective and part.kind == "Q4",
        frames=frames,
        flat=flat,
        layers=options.mesh.layers if part.bends else 1,
        through=options.mesh.through if part.bends else "gauss",
        bends=part.bends,
        **values_of([mesh.materials[m] for m in part.material], part.linear, part.strength, band, reach, options),
    )


def _twisted(mesh: ShellMesh, frames: np.ndarray) -> np.ndarray:
    """Nodes (nodes) whose rotation about the normal of their wall a joint there feels: it is not held then."""
    found = np.zeros(len(mesh.xyz), dtype=bool)
    for joint in (joint for joint in mesh.joints if not joint.floor):
        for way in (joint.normal, joint.along):
            turn = np.cross(joint.out, way)
            for corner in joint.connect.T:
                found[corner[np.abs(np.einsum("ex,ex->e", turn, frames[corner, :, 2])) > 1e-9]] = True
    return found


def _joint(joint: ShellJoint, frames: np.ndarray, options: Pushover) -> core.ShellJoints:
    """A joint layer by layer; an element is a layer of a stretch, layers of one stretch one after the other."""
    # A seat has a hinge above it: a floor does not clamp its walls
    layers, through = (1, "gauss") if joint.floor else (options.mesh.layers, options.mesh.through)
    height, share = layers_of(layers, through)
    connect = joint.connect
    # A pair of nodes between two stretches of a row stands in the first of them
    follows = np.append(False, (connect[1:, 0] == connect[:-1, 1]) & (connect[1:, 3] == connect[:-1, 2]))
    half = 0.5 * joint.length * joint.thickness
    after = np.where(np.append(follows[1:], False), np.append(half[1:], 0.0), 0.0)
    area = np.column_stack([np.where(follows, 0.0, half), half + after])

    def each(values: np.ndarray) -> np.ndarray:
        return np.repeat(values, layers, axis=0)

    count = len(connect) * layers
    normal, along, out = (each(axis) for axis in (joint.normal, joint.along, joint.out))
    upright = np.abs(joint.normal[:, 2]) > 0.5
    law = JointLaw(
        normal=each(np.column_stack([~upright, upright]).astype(float)),
        area=each(area) * np.tile(share, len(connect))[:, None],
        **{name: np.full(count, value) for name, value in joint.strength.items()},
        small=1.0,
        softening=joint.softening,
    )
    row = core.ShellJoints.rows(normal, along, out, np.tile(height, len(connect)) * each(joint.thickness), frames[each(connect)])
    tension, crushing, cohesion = teeth_of_joints(law, np.ones(count), options)
    return core.ShellJoints(
        each(connect),
        law.normal,
        law.area,
        law.normal_stiffness,
        law.shear_stiffness,
        law.friction,
        tension,
        crushing,
        cohesion,
        small=law.small,
        row=row,
    )


def _bar(mesh: ShellMesh, bar: ShellBar, options: Pushover) -> core.Bars:
    length = float(np.linalg.norm(mesh.xyz[bar.nodes[1]] - mesh.xyz[bar.nodes[0]]))
    return core.Bars(
        np.array([bar.nodes]),
        bar.area,
        bar.material.young,
        options.crack_band or length,
        softening_of(bar.material, options),
        crushing_of(bar.material, options),
    )
