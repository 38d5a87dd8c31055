"""Supports that give way by a little, under any structure: the joints that open, and the forces meanwhile.

Rigid blocks follow a small movement of their supports so that the potential energy of their weight is least, while
joints only open or slide by their law. The dual programme is solved: of all forces that stand, those by which the
structure does least work on its supports (Como 2013; Iannuzzo and others 2018). Its multipliers are the openings. Motions
are of first order: small beside the sizes of the blocks.
"""

from dataclasses import dataclass

import numpy as np

from extrados.limit.programme import LimitAnalysis, NoAnswer, NoEquilibrium, State
from extrados.limit.solver import BOUND, MADE_UP
from extrados.limit.states import read_state
from extrados.model.geometry.assembly import GROUND

SLIGHT = 1e-6  # cost of pressing beside that of the work on the supports
SAME = 1e-8  # of the total load: states that do this little more work are as good
CANNOT_FOLLOW = "the blocks are wedged: they cannot follow the movement without crushing"


@dataclass(frozen=True)
class Settlement:
    """pose (blocks, 3): x, y of the centroids [m] and rotation [rad]; motion (joints, 3): opening at p, at q and slip [m]
    of block a against b; the state of forces; work [J] that the weight does; gap [J] between that and the work of the
    reactions on the supports."""

    pose: np.ndarray
    motion: np.ndarray
    state: State
    work: float
    gap: float


def settle(limit: LimitAnalysis, movement: np.ndarray) -> Settlement:
    """What small movements (joints, 3) of the supports under joints on the ground do: dx, dy [m], turn [rad] about the
    middle of the joint, zero for all others. NoEquilibrium where the structure cannot stand or nothing resists."""
    assembly = limit.assembly
    half = 0.5 * (assembly.q - assembly.p)
    turned = movement[:, 2, None] * np.column_stack([-half[:, 1], half[:, 0]])
    at_p, at_q = movement[:, :2] - turned, movement[:, :2] + turned
    # Corner forces act on block a; on the ground they act as they are where it is block a, reversed where it is b.
    sign = np.where(assembly.a == GROUND, 1.0, -1.0)
    normal, tangent = assembly.normal, assembly.tangent
    given = sign[:, None] * np.column_stack(
        [(at_p * normal).sum(axis=1), (at_q * normal).sum(axis=1), (movement[:, :2] * tangent).sum(axis=1)]
    )
    most = float(np.abs(given).max())
    cost = limit.system.cost(given / most)
    try:
        solution, rows, corners = limit.optimise(cost, (0.0, 0.0))
    except (NoEquilibrium, NoAnswer):
        if limit.stands():  # the forces that resist grow without an end
            raise NoEquilibrium(CANNOT_FOLLOW) from None
        raise
    if solution.made_up > MADE_UP * max(1.0, abs(solution.value)):
        raise NoEquilibrium(CANNOT_FOLLOW)
    share = solution.x[limit.system.shares]
    if np.abs(solution.x).max() > 0.99 * BOUND:  # wedged stones press each other as they like: the state that presses least
        pressing = np.zeros_like(corners)
        pressing[:, :2] = SLIGHT
        easiest, _, pressed = limit.optimise(cost + limit.system.cost(pressing), (0.0, 0.0))
        if abs(float((pressed - corners).ravel() @ given.ravel())) < SAME * most * max(1.0, abs(solution.value)):
            corners, share = pressed, easiest.x[limit.system.shares]
    opened = rows.openings(np.maximum(solution.rows, 0.0), len(assembly.a)) * most
    scaled = (opened - given) / assembly.size
    twist, defect = limit.system.velocities(scaled, *([solution.equations * most / assembly.size] if limit.system.equations else []))
    defect *= float(np.abs(twist).max()) * assembly.size / most  # of the movement: where no block moves, of nothing
    if defect > 1e-6:
        raise NoAnswer(f"the movements of blocks and joints do not agree: they differ by {defect:.1e} times the movement of the support")
    size = assembly.size
    shift = twist[:, :2] * size
    x, y = assembly.centroid.T
    pose = np.column_stack([x + shift[:, 0] - twist[:, 2] * y, y + shift[:, 1] + twist[:, 2] * x, twist[:, 2]])
    dead = limit.loads.dead
    work = float((dead[:, :2] * shift).sum() + (dead[:, 2] * twist[:, 2]).sum())
    taken = limit.loads.scale * float((corners * opened).sum())
    if (answers := limit.loads.resistance) is not None:
        held = answers.on_blocks(share, len(shift))
        taken += float((held[:, :2] * shift).sum() + (held[:, 2] * twist[:, 2]).sum())
    reactions = limit.loads.scale * float((corners * given).sum())
    return Settlement(pose, opened, read_state(0.0, corners, limit.loads.scale, share), work, abs(work + taken - reactions))
