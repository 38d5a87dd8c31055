"""What analyses need to know of any rocking structure, block, arch or mechanism."""

from dataclasses import dataclass, replace

import numpy as np

from extrados.core.rocking import Body, limits
from extrados.core.soft_base import soft_base_body
from extrados.core.stack import stack_body
from extrados.limit.linkage import Linkage
from extrados.limit.loads import tilt_loads
from extrados.model.errors import WHOLE, NoView
from extrados.model.geometry.assembly import Assembly
from extrados.model.properties import NO_SLIDING_COEFFICIENT
from extrados.model.structures.arch import ArchAssembly
from extrados.model.structures.frame import FrameAssembly
from extrados.schema.constants import GRAVITY
from extrados.views.blocks import Masonry
from extrados.views.rockers.arch import ArchModel
from extrados.views.rockers.block import BlockModel, block_model
from extrados.views.rockers.frame import FrameModel
from extrados.views.rockers.mechanism import MechanismModel
from extrados.views.rockers.restraints import Restraints, block_linkages, block_reach, members_of, three_impacts
from extrados.views.rockers.soft_base import UNDAMPED, SoftBaseModel, soft_base_model
from extrados.views.rockers.stack import StackModel, rocks_as_stack
from extrados.views.rockers.watch import Watch, opening_capacity, sliding_capacity
from extrados.views.rockers.words import refuse_stack, refuse_words, rocks_as_block

OTHER_RULE = 'the impact rule "thesis" is only for circular arches without restraints; "energy-safe" is used instead'


@dataclass(frozen=True)
class Rocker:
    """A building ready for the rocking core.

    what: its kind; word: what answers call it; model: what it was made from. uplift: horizontal acceleration at which it starts to rock [g]; critical: rotation
    of unstable equilibrium to +x and -x [rad]; time_unit [s]: 1/p of a slender block; length: R of the toe or of the
    arch [m]; start_rotation [rad], > 0 to +x. restraints: what holds it besides its weight, None where nothing does.
    restitution: None on a compliant base, from which what impacts lose follows; rest: rotation at which it stands [rad].
    watch: tables of the forces at its joints; None on a compliant base, and for two stacked blocks.
    """

    what: str
    word: str
    model: BlockModel | ArchModel | MechanismModel | SoftBaseModel | StackModel
    body: Body
    uplift: float
    critical: tuple[float, float]
    restitution: float | None
    time_unit: float
    length: float
    start_rotation: float = 0.0
    warnings: tuple[str, ...] = ()
    restraints: Restraints | None = None
    rest: float = 0.0
    watch: Watch | None = None

    def __repr__(self) -> str:
        return f"<Rocker: {self.what}, rocks from {self.uplift:.4g} g>"

    def held(self, body: Body) -> Body:
        """Another body of the same structure, of other impacts, with what holds this one and its joints watched."""
        if self.watch is not None:
            return self.watch.watched(body)
        return body if self.restraints is None else self.restraints.hold(body)

    def unwatched(self) -> "Rocker":
        """The same without the tables of its joints."""
        if self.watch is None or isinstance(self.model, SoftBaseModel | StackModel):
            return self
        bare = self.model.body
        return replace(self, body=bare if self.restraints is None else self.restraints.hold(bare), watch=None)

    def rivals(self, factor: float) -> dict[str, tuple[float, Body]]:
        """Rule -> (c_v, structure) of all impact rules where they differ by more than the factor; none where there is one."""
        return {} if isinstance(self.model, SoftBaseModel | StackModel) else self.model.rivals(factor)

    def rebounding(self, factor: float) -> "Rocker":
        """The same with c_v times a factor, as long as an impact creates no energy."""
        assert not isinstance(self.model, SoftBaseModel | StackModel) and self.restitution is not None
        return replace(self, body=self.held(self.model.rebounding(factor)), restitution=min(1.0, factor * self.restitution))

    @property
    def initial_ratio(self) -> float:
        """Rotation at the start over the critical one to +x; 0 where it starts as it stands."""
        return 0.0 if self.start_rotation == self.rest else self.start_rotation / self.critical[0]

    @property
    def unit_acceleration(self) -> float:
        """What accelerations are told over [g]: uplift, of a block on a compliant base that on rigid ground."""
        return float(self.model.rigid.uplift.min()) if isinstance(self.model, SoftBaseModel) else self.uplift

    @property
    def scale(self) -> float:
        """Length [m] whose root scales durations, as R does for an arch (thesis Eq. 5.7): sqrt(scale/g) is 2.5 / p of
        a slender block."""
        return self.length if isinstance(self.model, ArchModel) else GRAVITY * (2.5 * self.time_unit) ** 2


def make_rocker(building: Masonry, linear: bool = False, stones: Assembly | None = None, soft_base: bool = False) -> Rocker:
    """The building as one rocking mechanism; NoView says why there is none.

    soft_base: also what moves in two coordinates, a block on a compliant base and two stacked blocks.

    stones: instead of the building's own, as they might be too; an arch of these need not be symmetric and rocks by
    two mechanisms.
    """
    structure, ratio = building.structure, building.initial.rotation_ratio
    if structure is None:
        raise NoView("the deck has no [structure]", WHOLE)
    if soft_base and rocks_as_stack(building):
        return _as_stack(building, linear, stones)
    if soft_base and building.supports.stiffness is not None:
        return _on_soft_base(building, linear, stones)
    refuse_words(building, linear)
    piers = building.pier_blocks() if structure.rocks_as == "piers" else None
    building.refuse_weightless(piers if stones is None else stones)
    if rocks_as_block(building):
        block = block_model(building, linear, stones)
        alpha = block.alpha
        made = Rocker(
            structure.kind,
            structure.word,
            block,
            block.body,
            float(block.uplift.min()),
            (float(alpha[0]), float(alpha[1])),
            float(block.restitution[0]),
            float(1.0 / block.frequency[0]),
            float(block.block.radius[0]),
            ratio * float(alpha[0 if ratio >= 0.0 else 1]),
            tuple(block.warnings),
        )
        resting = stones or _resting(building, piers)
        stones = stones or (resting if piers is None else piers)
        return _watched(_restrained(made, building), building, stones, block_linkages(block, stones), resting)
    given, stones = stones is not None, stones or (building.blocks() if piers is None else piers)
    if not given and isinstance(stones, ArchAssembly) and not _is_restrained(building):
        arch = ArchModel(stones, building.joints.restitution)
        limits = arch.limits
        # V' falls from its value at rest to zero at the critical rotation, as m g R (alpha - q) does for a block
        unit = float(np.sqrt(limits.mass * limits.critical / limits.gravity_moment))
        made = Rocker(
            "arch",
            structure.word,
            arch,
            arch.body,
            arch.collapse[0].gamma,
            (limits.critical, limits.critical),
            arch.restitution,
            unit,
            stones.radius,
            ratio * limits.critical,
            tuple(arch.warnings),
        )
        return _watched(made, building, stones, arch.linkages)
    rule = building.joints.restitution
    known = FrameModel if isinstance(stones, FrameAssembly) else MechanismModel
    model = known(stones, "energy-safe" if rule == "thesis" else rule)  # type: ignore[arg-type]
    critical = model.critical
    told = [OTHER_RULE] if rule == "thesis" else []
    made = Rocker(
        structure.kind,
        structure.word,
        model,
        model.body,
        min(model.uplift),
        critical,
        model.restitution[0],
        model.time_unit,
        model.length,
        ratio * critical[0 if ratio >= 0.0 else 1],
        (*model.warnings, *told),
    )
    return _watched(_restrained(made, building), building, stones, model.linkages)


def _resting(building: Masonry, piers: Assembly | None) -> Assembly:
    """The stones of the building at rest; its piers where it has no stones of their own."""
    try:
        return building.blocks()
    except NoView:
        if piers is None:
            raise
        return piers


def _watched(
    free: Rocker, building: Masonry, stones: Assembly, linkages: tuple[Linkage, Linkage], resting: Assembly | None = None
) -> Rocker:
    """The rocker with its joints watched; CannotStand where the friction of the joints does not carry its weight.

    resting: the stones of which `stones` are piers; at rest these slide one by one."""
    resting = stones if resting is None else resting
    given = building.friction()

    def of(assembly: Assembly) -> np.ndarray:
        """Friction of its joints, infinite where they do not slide."""
        if given is None or np.size(given) not in (1, len(assembly.a)):
            return np.full(len(assembly.a), np.inf)
        found = np.broadcast_to(np.asarray(given, dtype=float), len(assembly.a))
        return np.where(found < NO_SLIDING_COEFFICIENT, found, np.inf)

    friction, model, held = of(stones), free.model, free.restraints
    assert isinstance(model, BlockModel | ArchModel | MechanismModel)
    needed: tuple[np.ndarray, ...] | None = None
    if isinstance(model, ArchModel):
        needed = (model.collapse[0].friction,)
    elif isinstance(model, MechanismModel) and not isinstance(model, FrameModel) and held is None:
        needed = tuple(state.friction for state, _ in model.collapse)
    rocking = _starts(model, held)
    opening, loads = (np.inf, np.inf), replace(tilt_loads(resting), resistance=None)
    if held is not None and any(m.law.prestress for m in held.members):
        resting, loads = stones, replace(tilt_loads(stones), resistance=None)
        loads = replace(loads, dead=loads.dead + held.prestress(len(stones.mass)))
        opening = opening_capacity(stones, rocking, loads)
    first = min(rocking[0], opening[0]), min(rocking[1], opening[1])
    capacity = (np.inf, np.inf) if min(first) <= 0.0 else sliding_capacity(resting, of(resting), first, needed, loads)
    watch = Watch(stones, linkages, free.critical, friction, capacity, opening, not isinstance(model, BlockModel), held)
    return replace(free, body=watch.watched(model.body), watch=watch)


def _starts(model: BlockModel | ArchModel | MechanismModel, held: Restraints | None = None) -> tuple[float, float]:
    """Horizontal acceleration of the ground [g] at which a structure starts to rock to +x and to -x, with the prestress of what holds it."""
    if isinstance(model, BlockModel):
        drive = model.block.mass[0] * model.block.radius * (1.0 if model.linear else np.cos(model.alpha))
        right, left = model.uplift
    elif isinstance(model, ArchModel):
        right = left = model.collapse[0].gamma
    else:
        drive = np.array([t.drive for t in model.tables])
        right, left = model.uplift
    if held is not None:
        right, left = np.array([right, left]) + np.array(held.moment_at_rest) / (GRAVITY * drive)
    return float(right), float(left)


def _as_stack(building: Masonry, linear: bool, stones: Assembly | None) -> Rocker:
    """Two blocks upon each other, in two coordinates."""
    structure = building.structure
    assert structure is not None
    refuse_stack(building, linear)
    model = StackModel(building.blocks() if stones is None else stones)
    building.refuse_weightless(model.assembly)
    alpha, unit = model.whole
    return Rocker(
        structure.kind,
        structure.word,
        model,
        stack_body(model.core, (alpha, model.alone[0]), model.friction(building.friction())),
        min(model.uplift),
        (alpha, alpha),
        None,
        max(unit, model.alone[1]),
        model.radius,
        building.initial.rotation_ratio * alpha,
    )


def _on_soft_base(building: Masonry, linear: bool, stones: Assembly | None) -> Rocker:
    """A block, a column or a wall taken as one body, on a compliant base."""
    structure, ratio = building.structure, building.initial.rotation_ratio
    assert structure is not None
    model = soft_base_model(building, linear, stones)
    rigid = model.rigid
    critical = model.critical(1), -model.critical(-1)
    start = model.turned(ratio)
    warnings = [*rigid.warnings] if model.core.damping else [*rigid.warnings, UNDAMPED]
    return Rocker(
        structure.kind,
        structure.word,
        model,
        soft_base_body(model.core, critical, model.friction(building.friction())),
        min(model.uplift(1), model.uplift(-1)),
        critical,
        None,
        float(1.0 / rigid.frequency[0]),
        float(rigid.block.radius[0]),
        start,
        tuple(warnings),
        rest=model.rest,
    )


def _is_restrained(building: Masonry) -> bool:
    return bool(building.restraints) or building.supports.abutting_wall is not None


def _restrained(free: Rocker, building: Masonry) -> Rocker:
    """The rocker with the ties, dampers, added hinges and the wall of its building."""
    if not _is_restrained(building):
        return free
    model = free.model
    assert not isinstance(model, ArchModel | SoftBaseModel | StackModel) and building.structure is not None
    wall = building.supports.abutting_wall
    sides = (wall != "right", wall != "left")
    rebound = (0.0, 0.0)
    if isinstance(model, BlockModel):
        stones = building.pier_blocks() if building.structure.rocks_as == "piers" else building.blocks()
        linkages, reach = block_linkages(model, stones), block_reach(model)
        if wall is not None:
            rebound = (three_impacts(model, 0), three_impacts(model, 1))
    else:
        linkages, stones = model.linkages, model.assembly
        right, left = (table.numbers[2:4] for table in model.tables)
        reach = (float(right[0]), float(right[1])), (float(left[0]), float(left[1]))
    if building.supports.rebound is not None:
        rebound = (building.supports.rebound, building.supports.rebound)
    held = Restraints(members_of(building, stones, linkages), linkages, reach, sides, rebound)
    starts = _starts(model, held)
    body = held.hold(free.body)
    critical, _ = limits(body)
    ratio = building.initial.rotation_ratio
    told = free.warnings
    if wall is not None and building.supports.rebound is None:
        told += (
            (
                f"the structure rebounds from the wall with {rebound[0 if sides[0] else 1]:.3f} times its angular velocity, calculated "
                "from three plastic impacts. For a facade of 0.6 x 3 m, discrete elements gave 0.7 to 1.2 times this value at 5 % of "
                "critical damping, and less at critical damping (docs/rocking.md). If the value matters, give `rebound` of [supports]"
            ),
        )
    return replace(
        free,
        body=body,
        restraints=held,
        warnings=told,
        critical=critical,
        start_rotation=ratio * critical[0 if ratio >= 0.0 else 1],
        uplift=min(start for start, is_open in zip(starts, sides, strict=True) if is_open),
    )
