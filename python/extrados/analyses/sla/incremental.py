"""A nonlinear incremental analysis of the same wall with the same teeth, to compare: secant iteration under arc length.

Each step goes a given length of the displacements' norm on from the last state (Crisfield 1981, cylindrical arc length).
Within it all overloaded points lose teeth at once and the secant stiffness is solved anew, until no point is overloaded.
A step that does not converge is tried again at half the length; where that is a small share of the longest, the analysis
stalls: whether still shorter steps converge is a matter of the last bits, and they lead nowhere. Sequentially linear
analysis needs none of this: it has one point per event, and no iteration.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from extrados.analyses.sla.curve import FAR, FELL, TOO_FAR, has_fallen
from extrados.analyses.sla.model import EventModel
from extrados.analyses.sla.tables import Staged
from extrados.core import sla as core
from extrados.core.calls import cancel_requested

#: Iterations of a step, those after which its length may grow again
MOST_ITERATIONS, FEW = 50, 8
#: Of the longest step; at less the analysis stalls
SHORTEST = 1.0 / 256.0
#: Length of the first step over the norm of the displacements at the first crack
FIRST = 0.25
STALLED = "no convergence"


@dataclass(frozen=True)
class Step:
    """A converged state: displacements (nodes, 2) of A and of B [m], multiplier, damage, energy of cracks."""

    ua: np.ndarray
    ub: np.ndarray
    load: float
    damage: np.ndarray
    iterations: int
    cracked: float  # energy of the teeth passed [J]

    @property
    def u(self) -> np.ndarray:
        """Displacements (nodes, 2) of the state [m]."""
        return self.ua + self.load * self.ub


def multiplier(ua: np.ndarray, ub: np.ndarray, last: np.ndarray, way: np.ndarray, length: float) -> float | None:
    """The load at which ua + load ub lies `length` from the displacements `last`, onwards in the sense of `way`; None
    where none does."""
    gap = ua - last
    a, b, c = float((ub * ub).sum()), float((ub * gap).sum()), float((gap * gap).sum()) - length**2
    inside = b * b - a * c
    if not (inside >= 0.0 and a > 0.0):
        return None
    loads = [(-b + sign * np.sqrt(inside)) / a for sign in (1.0, -1.0)]
    return max(loads, key=lambda load: float(((gap + load * ub) * way).sum()))


def _has_fallen(rows: list[tuple[float, ...]], start: float, fraction: float) -> bool:
    """Whether the load of the steps so far has fallen below a fraction of its peak."""
    load, *_, displacement = np.array(rows).T
    return has_fallen(displacement, load, start, fraction)


def run_incremental(
    core_model: core.Model, model: EventModel, options: Staged, sign: int, progress: Callable[[float, float, str], None]
) -> core.Events:
    """Steps under A + lambda B from the state the model is in; one row for each, its code 0."""
    watch = model.control
    target = np.inf if options.target_displacement is None else options.target_displacement
    fa, fb = model.constant, sign * model.reference
    first = core_model.run_whole(1, watch)
    ua = core_model.displacement(0.0)
    ub = core_model.displacement(1.0) - ua
    step = Step(ua, ub, 0.0, core_model.damage(), 0, float(first.crack_total))
    way, length = ub * float(first.load[0]), FIRST * abs(float(first.load[0])) * float(np.linalg.norm(ub))
    longest, compliance = 4.0 * length, float((fb * ub).sum())
    rows: list[tuple[float, ...]] = []
    external = 0.5 * float((fa * ua).sum())
    reason, start = "", float(watch.share @ ua[watch.node, watch.direction])
    while len(rows) < options.events and not reason and not cancel_requested():
        found = _step(core_model, fa, fb, step, way, length)
        if found is None:
            length = 0.5 * length
            if length < SHORTEST * longest:
                reason = STALLED
            continue
        way = found.u - step.u
        external += 0.5 * float(((2.0 * fa + (step.load + found.load) * fb) * way).sum())
        stored = 0.5 * float(((fa + found.load * fb) * found.u).sum())
        if found.iterations <= FEW:
            length = min(1.3 * length, longest)
        step = found
        moved = float(watch.share @ step.u[watch.node, watch.direction])
        soft = float((fb * step.ub).sum())
        rows.append((step.load, stored, external, external - stored, step.cracked, soft, moved))
        progress(len(rows), options.events, f"step {len(rows)}, load {step.load * model.unit:.4g} N")
        if abs(moved - start) > FAR * model.extent:
            reason = TOO_FAR
        elif abs(moved) >= target:
            reason = "target displacement"
        elif soft > model.mechanism_ratio * compliance:
            reason = "mechanism"
        elif options.stop_fraction and _has_fallen(rows, start, options.stop_fraction):
            reason = FELL
    return _events(rows, reason, cancel_requested())


def _step(core_model: core.Model, fa: np.ndarray, fb: np.ndarray, last: Step, way: np.ndarray, length: float) -> Step | None:
    """The state `length` on from the last one; None where the iteration fails, which leaves the model in the last state."""
    ua, ub, cracked = last.ua, last.ub, last.cracked
    try:
        for iteration in range(MOST_ITERATIONS):
            load = multiplier(ua, ub, last.u, way, length)
            if load is None:
                break
            damaged, cracked = core_model.relax(load)
            if not damaged:
                return Step(ua, ub, load, core_model.damage(), iteration, cracked)
            ua = core_model.displacement(0.0)
            ub = core_model.displacement(1.0) - ua
    except core.FreeNode:
        pass
    core_model.set_damage(last.damage)
    core_model.loads(fa, fb, carried=True, ledger=(0.0, 0.0, last.cracked))
    return None


def _events(rows: list[tuple[float, ...]], reason: str, interrupted: bool) -> core.Events:
    """Steps as the rows of an event curve: no point, no limits, all in equilibrium."""
    load, stored, external, lost, crack, soft, moved = np.array(rows).reshape(-1, 7).T
    n = len(load)
    none = np.full(n, np.finfo(float).max)
    return core.Events(
        load,
        none,
        -none,
        stored,
        external,
        lost,
        crack,
        soft,
        np.zeros(n),
        np.ones(n),
        np.zeros(n),
        point=np.full(n, -1),
        code=np.zeros(n, dtype=int),
        number=np.arange(1, n + 1),
        equilibrium=np.ones(n, dtype=bool),
        monitors=moved[:, None],
        reason=reason,
        interrupted=interrupted,
        crack_total=float(crack[-1]) if n else 0.0,
    )
