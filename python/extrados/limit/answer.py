"""The whole answer of limit analysis about an assembly from one call."""

from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import partial
from typing import TypeVar

import numpy as np

from extrados.core.calls import interruptible
from extrados.limit.equilibrium import hanging_stones
from extrados.limit.errors import CannotStand
from extrados.limit.graphic import force_polygon, funicular
from extrados.limit.lines import ThrustPath, thrust_paths
from extrados.limit.loads import Loads
from extrados.limit.programme import Immovable, LimitAnalysis, Mechanism, NoAnswer, NoEquilibrium, State
from extrados.limit.systems import Sparse
from extrados.model.geometry.assembly import GROUND, Assembly
from extrados.model.geometry.chains import inner_stones
from extrados.schema.quantities import engineering

Found = TypeVar("Found")
TOUCH = 1e-6  # of a joint's length: the thrust line touches its end
CENTRAL = 0.01  # of the joints' length: a line this near to all middles runs through them, within what is built


def safety_factor(part: float) -> float:
    """One over the least part of the joints that holds a thrust line; infinite where their middles do, within `CENTRAL`: the loads
    make no horizontal demand, and a factor beyond 100 says nothing of the safety."""
    return np.inf if part < CENTRAL else 1.0 / part


@dataclass(frozen=True)
class Answer:
    """Collapse to +x and to -x, and the states upright.

    collapse_state is the state at collapse with the free part of the line at its most central; least and
    most are the states of least and greatest thrust of each chain; central the most central upright line,
    held by `part` of the joints' length (None and NaN for a wall of many loops, where this takes many large
    programmes). touching: joints whose end the line touches without a hinge. warnings: what could not be found
    beside the collapse load; least and most then lack a chain, or central is None.
    """

    assembly: Assembly
    loads: Loads
    collapse_state: State
    mechanism: Mechanism
    back_state: State
    back_mechanism: Mechanism
    least: dict[str, State]
    most: dict[str, State]
    central: State | None
    part: float
    warnings: tuple[str, ...] = ()

    @property
    def gamma(self) -> float:
        """Multiplier at collapse."""
        return self.collapse_state.gamma

    @property
    def gap(self) -> float:
        """Greatest difference between the bounds from equilibrium and from the mechanism, both ways."""
        return max(
            abs(self.collapse_state.gamma - self.mechanism.upper_bound), abs(self.back_state.gamma - self.back_mechanism.upper_bound)
        )

    @property
    def safety(self) -> float:
        """Geometric safety factor upright: one over the least part of the joints that holds a thrust line.

        Infinite where the line can run through the middles of all joints, within `CENTRAL` of their length.
        """
        return safety_factor(self.part)

    @property
    def touching(self) -> list[int]:
        """Joints that the line of the collapse state reaches without a hinge there."""
        moving = {j for j, _ in self.mechanism.hinges} | set(self.mechanism.sliding)
        edge = np.minimum(self.collapse_state.position, 1.0 - self.collapse_state.position) < TOUCH
        return [j for j in np.flatnonzero(edge).tolist() if j not in moving]

    def polygons(self, state: State) -> dict[str, np.ndarray]:
        """Force polygon of each chain [N]."""
        return {name: force_polygon(self.assembly, state, joints) for name, joints in self.assembly.chains.items()}

    def funiculars(self, state: State) -> dict[str, np.ndarray]:
        """Funicular polygon [m] of each arch whose stones bear nothing but their loads and each other."""
        return {
            name: funicular(self.assembly, self.loads, state, joints)
            for name, joints in self.assembly.chains.items()
            if self._plain(joints)
        }

    def _plain(self, joints: list[int]) -> bool:
        """Does a chain span, do its stones touch no stone beside it, and does nothing push back on them?"""
        if np.ptp(self.assembly.middle[joints, 0]) < 0.5 * np.ptp(self.assembly.middle[joints, 1]):
            return False  # upright: the loads meet the line far below
        inner = inner_stones(self.assembly, joints)
        resistance = self.loads.resistance
        pushed = set() if resistance is None else set(resistance.block.tolist())
        return not inner & pushed and all(len(self.assembly.joints_of(i)) == 2 for i in inner)

    def lines(self, state: State) -> list[ThrustPath]:
        """The thrust line of a state, through every stone."""
        return thrust_paths(self.assembly, self.loads, state)

    def reactions(self, state: State) -> dict[int, np.ndarray]:
        """Force (2) [N] of the ground on the block of each joint on the ground."""
        force = state.force(self.assembly)
        on_b = self.assembly.a == GROUND
        grounded = np.flatnonzero(on_b | (self.assembly.b == GROUND))
        return {int(j): -force[j] if on_b[j] else force[j] for j in grounded}


def assess(
    assembly: Assembly,
    friction: float | np.ndarray | None = None,
    *,
    strength: float | None = None,
    associated: bool = True,
    loads: Loads | None = None,
    limit: LimitAnalysis | None = None,
    threads: int = 1,
) -> Answer:
    """Everything limit analysis has to say; CannotStand where no line is admissible upright. threads: of both directions without dilatancy.

    The collapse loads are the answer: thrusts and central lines that the solver gives up on become warnings.
    """
    limit = limit or LimitAnalysis(assembly, friction, strength=strength, associated=associated, loads=loads)
    warnings: list[str] = []

    def beside(what: str, find: Callable[[], Found], gives_up: tuple[type[Exception], ...]) -> Found | None:
        try:
            return find()
        except gives_up as error:
            warnings.append(f"{what} is not given: {error}")
            return None

    try:
        thrusts = {
            name: beside(f"the minimum and maximum thrust of the {name}", partial(limit.thrust, joints), (NoAnswer,))
            for name, joints in assembly.chains.items()
        }
        if limit.associated or threads < 2:
            both = [limit.collapse(direction) for direction in (1, -1)]
        else:
            with interruptible(), ThreadPoolExecutor(2) as pool:
                both = list(pool.map(limit.collapse, (1, -1)))
        (state, mechanism), (back, back_mechanism) = both
        if not back.gamma <= 0.0 <= state.gamma:
            raise NoEquilibrium
    except Immovable:
        raise
    except NoEquilibrium:
        raise cannot_stand(limit) from None
    ends = {name: pair for name, pair in thrusts.items() if pair is not None}
    moving = sorted({j for j, _ in mechanism.hinges} | set(mechanism.sliding))
    drawn, central = state, None
    if not isinstance(limit.system, Sparse):
        # The structure stands: that no line is found now is a matter of rounding too.
        rounding = (NoAnswer, NoEquilibrium)
        drawn = beside("the most central thrust line at collapse", lambda: limit.recentred(state, moving), rounding) or state
        start = [state for pair in ends.values() for state in pair]
        central = beside("the most central line upright", lambda: limit.central(start=start), rounding)
    upright, part = central or (None, np.nan)
    return Answer(
        assembly,
        limit.loads,
        drawn,
        mechanism,
        back,
        back_mechanism,
        {name: pair[0] for name, pair in ends.items()},
        {name: pair[1] for name, pair in ends.items()},
        upright,
        part,
        tuple(warnings),
    )


def cannot_stand(limit: LimitAnalysis) -> CannotStand:
    """The proof that no state is admissible upright: a motion by which the loads do work that no joint takes.

    NoAnswer where there is no such motion: that the solver found no state is then no statement about the structure.
    """
    motion = limit.certificate()
    if motion is None and limit.strength is not None:
        try:
            upright = [limit.collapse(direction)[1].upper_bound for direction in (1, -1)]
        except NoEquilibrium:
            return CannotStand(
                f"{why_not(limit)}; certificate: no equilibrium forces exist, even if planes outside the strength "
                "curves replace these curves"
            )
        if upright[0] < 0.0 or upright[1] > 0.0:
            return CannotStand(
                f"{why_not(limit)}; certificate: a mechanism, in which the loads do more work than crushing of the joints resists"
            )
    if motion is None:
        raise NoAnswer(
            "whether the structure stands under self-weight is not decided: neither an equilibrium state nor a collapse mechanism was found"
        )
    assembly = limit.assembly
    x, y = (assembly.centroid / assembly.size).T
    velocity = np.column_stack([motion[:, 0] - motion[:, 2] * y, motion[:, 1] + motion[:, 2] * x, motion[:, 2]])
    velocity[:, :2] *= assembly.size
    fastest = assembly.block_names[int(np.hypot(velocity[:, 0], velocity[:, 1]).argmax())]
    return CannotStand(
        f"{why_not(limit)}; certificate: a mechanism, fastest at {fastest}, in which the loads do positive work and no joint resists",
        velocity,
    )


def why_not(limit: LimitAnalysis) -> str:
    """Why no thrust line is admissible upright: stones with nothing below, or the joints it leaves and by how much."""
    assembly = limit.assembly
    if hanging := hanging_stones(assembly):
        names = [assembly.block_names[i] for i in hanging]
        told = ", ".join(names[:4]) + (f" and {len(names) - 4} more" if len(names) > 4 else "")
        if not LimitAnalysis(assembly, loads=limit.loads).stands():
            return f"nothing carries {told} from below"
        return f"only friction carries {told}; {_slides(limit)}"
    try:
        interval = sorted(limit.collapse(d)[0].gamma for d in (1, -1))
    except NoEquilibrium:
        interval = []
    if interval and (interval[0] > 0.0 or interval[1] < 0.0):
        return (
            f"the structure can stand only under a horizontal load between {interval[0]:.4f} and {interval[1]:.4f} g (tilt "
            f"between {np.degrees(np.arctan(interval[0])):.2f} and {np.degrees(np.arctan(interval[1])):.2f} degrees)"
        )
    try:
        state, part = limit.central()
    except NoEquilibrium:
        if limit.friction is not None:
            return _slides(limit)
        return "a block is not supported: its joint would need tension"
    except NoAnswer:
        return "no thrust line stays inside the structure"
    if part < 1.0 and limit.strength is not None:
        return (
            f"a thrust line passes within the central {100.0 * part:.3g} % of the joints, but the strength of {engineering(limit.strength, 'Pa')} "
            "is not sufficient for this thrust line"
        )
    if limit.friction is not None and LimitAnalysis(assembly, loads=limit.loads).stands():
        return _slides(limit)
    off = 2.0 * np.abs(state.position - 0.5)
    worst = [assembly.joint_names[j] for j in np.flatnonzero(off > part * (1.0 - 1e-6))]
    return (
        f"no thrust line stays inside the structure: the section would have to be {100.0 * (part - 1.0):.4g} % thicker "
        f"(the thrust line first leaves the structure at {', '.join(worst[:6])})"
    )


def _slides(limit: LimitAnalysis) -> str:
    """The friction that would hold it, by bisection on one coefficient for all joints."""

    def stands(friction: float) -> bool:
        return LimitAnalysis(limit.assembly, friction, loads=limit.loads).stands()

    low, high = 0.0, 10.0
    if not stands(high):
        return "a block is not supported: its joint would need tension"
    while high - low > 1e-4:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if stands(middle) else (middle, high)
    return f"the structure fails by sliding: the coefficient of friction must be at least {high:.3f}"
