"""Supports that give way by a little, under any structure: the joints that open, and the forces meanwhile.

Rigid blocks follow a small movement of their supports so that the potential energy of their weight is least, while
joints only open or slide by their law. The dual programme is solved: of all forces that stand, those by which the
structure does least work on its supports (Como 2013; Iannuzzo and others 2018). Its multipliers are the openings. Motions
are of first order: small beside the sizes of the blocks.
"""

from dataclasses import dataclass

import numpy as np

from extrados.building.geometry.assembly import GROUND
from extrados.limit.programme import LimitAnalysis, NoEquilibrium, State
from extrados.limit.solver import BOUND
from extrados.limit.states import read_state


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
    solution, rows, corners = limit.optimise(limit.system.cost(given / most), (0.0, 0.0))
    if np.abs(solution.x).max() > 0.99 * BOUND:
        raise NoEquilibrium("the movement meets no resistance: the structure would have to be torn")
    opened = rows.openings(np.maximum(solution.rows, 0.0), len(assembly.a)) * most
    scaled = (opened - given) / assembly.size
    twist, defect = limit.system.velocities(
        scaled, *([solution.equations * most / assembly.size] if limit.system.equations else [])
    )
    if defect > 1e-6:
        raise NoEquilibrium(f"the motions of blocks and joints differ by {defect:.1e} of the greatest")
    size = assembly.size
    shift = twist[:, :2] * size
    x, y = assembly.centroid.T
    pose = np.column_stack([x + shift[:, 0] - twist[:, 2] * y, y + shift[:, 1] + twist[:, 2] * x, twist[:, 2]])
    dead = limit.loads.dead
    work = float((dead[:, :2] * shift).sum() + (dead[:, 2] * twist[:, 2]).sum())
    reactions = limit.loads.scale * float((corners * given).sum())
    taken = limit.loads.scale * float((corners * opened).sum())
    return Settlement(
        pose, opened, read_state(0.0, corners, limit.loads.scale), work, abs(work + taken - reactions)
    )  # fmt: skip
