"""What is read off a run of blocks in space: turns, openings and slip of contacts, the outcome, pictures."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from extrados.analyses.dem.measures import MOST_TRACKED, OPEN, Slip, displaced, off_footing
from extrados.analyses.dem.seen import BlocksSeen
from extrados.analyses.dem.solid_model import SolidModel
from extrados.core import dem3
from extrados.model.geometry.solids.contacts import GROUND
from extrados.results.dem import APART, CLOSED, ROCKS


@dataclass(frozen=True)
class SolidsSeen(BlocksSeen):
    """What is read off a run in space, too; its state is CLOSED, ROCKS where some corner of a contact is open, APART where all are.

    turn (time, block, 3): rotation vectors from the settled attitude [rad]; opening (time, contact): of the corner that
    gapes most [m]; slip (time, contact): along the contact at its most closed corner [m].
    """

    model: SolidModel
    run: dem3.Run
    turn: np.ndarray
    opening: np.ndarray
    slip: np.ndarray

    @property
    def angle(self) -> np.ndarray:
        """How far each block has turned (time, block) [rad]."""
        return self.moved[1]


def look(model: SolidModel, run: dem3.Run, floor: bool) -> SolidsSeen:
    """Everything that is read off a run; floor: blocks slide on a level floor, not off their footings."""
    turn = turns(model, run)
    opening, slip, state = contacts(model, run)
    drop = -displaced(run, model.count, 3)[..., 2]
    one, width = model.assembly, widths(model)
    return SolidsSeen(
        model=model,
        run=run,
        state=state,
        off=np.zeros(state.shape, dtype=bool) if floor else off_footing(one.a, one.b, state, slip, width),
        moved=(displacements(model, run), np.linalg.norm(turn, axis=2), drop),
        sliding=Slip.of(state, slip, width),
        turn=turn,
        opening=opening,
        slip=slip,
    )


def followed(seen: SolidsSeen, names: list[str]) -> list[int]:
    """Numbers of the blocks of these names; without names, of those that turn most."""
    index = {name: k for k, name in enumerate(seen.model.assembly.block_names)}
    most = np.argsort(-seen.angle.max(axis=0, initial=0.0), kind="stable")[:MOST_TRACKED]
    return [index[name] for name in names] if names else sorted(most.tolist())


def widths(model: SolidModel) -> np.ndarray:
    """Least width of each contact (contact) [m]: between one of its edges and the corner farthest from it."""
    one = model.assembly
    found = []
    for polygon, normal in zip(one.polygon, one.normal, strict=True):
        along = np.roll(polygon, -1, axis=0) - polygon
        across = np.cross(normal, along / np.linalg.norm(along, axis=1)[:, None])
        found.append(np.abs(np.einsum("ekx,ex->ek", polygon[None] - polygon[:, None], across)).max(axis=1).min())
    return np.array(found)


def turns(model: SolidModel, run: dem3.Run) -> np.ndarray:
    """Rotation vectors (time, block, 3) [rad] of the blocks from their settled attitudes."""
    there = run.turn[:, : model.count] @ np.swapaxes(run.settled_turn[: model.count], 1, 2)
    return Rotation.from_matrix(there.reshape(-1, 3, 3)).as_rotvec().reshape(len(run.time), model.count, 3)


def displacements(model: SolidModel, run: dem3.Run) -> np.ndarray:
    """How far the centroid of each block is from its settled place (time, block) [m]; see `measures.displaced`."""
    return np.linalg.norm(displaced(run, model.count, 3), axis=2)


def contacts(model: SolidModel, run: dem3.Run) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Opening, slip (time, contact) [m] and state of the contacts, from the settled state; a gap is open, and a slip leaves the contact,
    by its least width."""
    one, width = model.assembly, widths(model)
    shape = (len(run.time), len(one.a))
    opening, slip, state = np.zeros(shape), np.zeros(shape), np.full(shape, CLOSED)
    for j, (a, b) in enumerate(zip(one.a.tolist(), one.b.tolist(), strict=True)):
        corners = one.polygon[j]
        bodies = (model.count + int(model.supports.of_joint[j]) if k == GROUND else k for k in (a, b))
        (moved, normal), (other, back) = (carried(run, k, corners, one.normal[j]) for k in bodies)
        mean = normal + back
        mean /= np.linalg.norm(mean, axis=1)[:, None]
        apart = moved - other
        gap = np.einsum("tkx,tx->tk", apart, mean)
        along = np.linalg.norm(apart - gap[..., None] * mean[:, None], axis=2)
        nearest = gap.argmin(axis=1)
        opening[:, j] = np.maximum(gap.max(axis=1, initial=0.0), 0.0)
        slip[:, j] = along[np.arange(len(along)), nearest]
        small = OPEN * width[j]
        gone = (gap > small).all(axis=1) | ((GROUND not in (a, b)) & (slip[:, j] > width[j]))
        state[:, j] = np.where(gone, APART, np.where((gap > small).any(axis=1), ROCKS, CLOSED))
    return opening, slip, state


def carried(run: dem3.Run, body: int, points: np.ndarray, normal: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Points (time, k, 3) [m] and a normal (time, 3) carried along with a body, or a support, from its settled state."""
    turn = run.turn[:, body] @ run.settled_turn[body].T
    arm = points - run.settled[body]
    return run.place[:, None, body] + np.einsum("txy,ky->tkx", turn, arm), turn @ normal


def poses(model: SolidModel, run: dem3.Run) -> np.ndarray:
    """Shifts [m] and rotation vectors [rad] of the blocks (time, block, 6) from where they were drawn."""
    vectors = Rotation.from_matrix(run.turn[:, : model.count].reshape(-1, 3, 3)).as_rotvec()
    shift = run.place[:, : model.count] - model.assembly.centroid
    return np.concatenate([shift, vectors.reshape(*shift.shape)], axis=2)
