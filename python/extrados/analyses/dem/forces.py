"""Forces between blocks over time, reactions of the ground, and the energy that each pair of blocks lost; in the plane and in space."""

import numpy as np

from extrados.analyses.dem.model import Model
from extrados.analyses.dem.solid_model import SolidModel
from extrados.core import dem3, dem_run
from extrados.model.geometry.assembly import GROUND
from extrados.results.dem import PairWork
from extrados.results.fields import Keys
from extrados.results.model import Array
from extrados.schema.constants import GRAVITY

MOST_PAIRS = 20  # of results
#: A block is carried by contacts formed later if its pairs are without force for so much longer than all of its flights together [s]:
#: contact between output times is not seen
LEAST_SPAN = 0.1


def reactions(model: Model | SolidModel, run: dem_run.FoundRun) -> np.ndarray:
    """Force of the ground on the blocks (time, 2 or 3) [N] at the contacts as drawn and at the anchors of ties and dampers; the last
    component is vertical."""
    grounded = run.joint_body[:, 1] >= model.count
    found: np.ndarray = run.joint_force[:, grounded].sum(axis=1) + _anchor_forces(model, run)
    return found


def _anchor_forces(model: Model | SolidModel, run: dem_run.FoundRun) -> np.ndarray:
    """Force of the ground on the ties and dampers that are anchored in it (time, 2 or 3) [N].

    At a point a tension T exerts T times the sum of the unit vectors to the next points, in equal parts on the anchors of the point.
    """
    axes, ties = run.joint_force.shape[2], model.ties.core
    found = np.zeros((len(run.time), axes))
    if ties is None:
        return found
    anchors = np.bincount(ties.point)
    point = np.zeros((len(run.time), len(anchors), axes))
    np.add.at(point.swapaxes(0, 1), ties.point, _anchor_places(model, run, ties).swapaxes(0, 1))
    point /= anchors[:, None]
    share = np.bincount(ties.point, ties.body < 0) / anchors  # of the ground
    ends = [*ties.first[1:].tolist(), len(anchors)]
    for k, (first, end) in enumerate(zip(ties.first.tolist(), ends, strict=True)):
        line = [*range(first, end), *([first] if ties.closed[k] else [])]
        along = np.diff(point[:, line], axis=1)
        along /= np.linalg.norm(along, axis=2)[:, :, None]
        held = share[line[1:]] - share[line[:-1]]
        found += run.tension[:, k, None] * np.einsum("tsi,s->ti", along, held)
    return found


def _anchor_places(model: Model | SolidModel, run: dem_run.FoundRun, ties: dem_run.Ties) -> np.ndarray:
    """Where the bodies have carried the anchors of ties (time, anchors, 2 or 3) [m]."""
    axes, on = run.joint_force.shape[2], np.flatnonzero(ties.body >= 0)
    body, found = ties.body[on], np.tile(ties.place[:, :axes], (len(run.time), 1, 1))
    centroid = model.rigid.centroid if isinstance(model, Model) else model.assembly.centroid
    arm = ties.place[on, :axes] - centroid[body, :axes]
    if isinstance(run, dem3.Run):
        turned = np.einsum("tnij,nj->tni", run.turn[:, body], arm)
    else:
        c, s = np.cos(run.place[:, body, 2]), np.sin(run.place[:, body, 2])
        turned = np.stack([c * arm[:, 0] - s * arm[:, 1], s * arm[:, 0] + c * arm[:, 1]], axis=2)
    found[:, on] = run.place[:, body, :axes] + turned
    return found


def carried_elsewhere(model: Model | SolidModel, run: dem_run.FoundRun) -> list[str]:
    """Names of the blocks that rest on contacts formed later, such as those with a floor: all of its pairs as drawn are without force
    for longer than all of its time without contact."""
    loaded = (run.joint_force != 0.0).any(axis=2)
    found = []
    for k in range(model.count):
        when = run.time[loaded[:, (run.joint_body == k).any(axis=1)].any(axis=1)]
        bounds = np.concatenate([run.time[:1], when, run.time[-1:]])
        steps = 2.0 * float(np.diff(run.time).max(initial=0.0))
        if np.diff(bounds).max(initial=0.0) > float(run.airborne[k]) + steps + LEAST_SPAN:
            found.append(model.body_names[k])
    return found


def force_keys(model: Model | SolidModel, run: dem_run.FoundRun) -> Keys:
    """Keys of the results on forces and on the energy lost pair by pair."""
    shear = float(np.linalg.norm(reactions(model, run)[:, :-1], axis=1).max(initial=0.0))
    friction, damping = (values[-1] if len(values) else np.zeros(len(run.joint_body)) for values in (run.joint_friction, run.joint_damping))
    most = np.linalg.norm(run.joint_force, axis=2).max(axis=0, initial=0.0)
    names = pair_names(model, run)
    rows = [
        PairWork(name=names[k], friction_J=float(friction[k]), damping_J=float(damping[k]), peak_force_N=float(most[k]))
        for k in np.argsort(-friction, kind="stable")[:MOST_PAIRS].tolist()
    ]
    return {
        "peak_base_shear_N": shear,
        "peak_base_shear_over_weight": shear / (float(model.mass[: model.count].sum()) * GRAVITY),
        "joint_work": rows,
    }


def force_columns(model: Model | SolidModel, run: dem_run.FoundRun) -> dict[str, np.ndarray]:
    """Columns of the reactions in the table of the run [N]."""
    found = reactions(model, run).T
    return {f"reaction {axis}": values for axis, values in zip("xyz", found, strict=False)}


def pair_names(model: Model | SolidModel, run: dem_run.FoundRun) -> list[str]:
    """What each pair of blocks that touch as drawn is called."""
    names = model.body_names
    return [f"{names[a]} / {names[b] if b < model.count else 'ground'}" for a, b in run.joint_body.tolist()]


def force_arrays(model: Model | SolidModel, run: dem_run.FoundRun) -> dict[str, Array]:
    """Forces, reactions and energies as results store them."""
    blocks = np.where(run.joint_body < model.count, run.joint_body, GROUND)
    axis = f"axis{run.joint_force.shape[2]}"
    return {
        "pair_name": Array(np.array(pair_names(model, run), dtype=object), ("pair",), "", "names of the pairs"),
        "pair_block": Array(
            blocks, ("pair", "side"), "", "numbers of the two blocks of each pair in contact at the start; -1 is the ground"
        ),
        "pair_force": Array(run.joint_force, ("time", "pair", axis), "N", "contact force on the first block of each pair"),
        "pair_friction_work": Array(run.joint_friction, ("time", "pair"), "J", "energy lost by friction since the start"),
        "pair_damping_work": Array(
            run.joint_damping, ("time", "pair"), "J", "energy lost in dashpots, or by impacts of rigid contacts, since the start"
        ),
        "reaction": Array(
            reactions(model, run),
            ("time", axis),
            "N",
            "force of the ground on the blocks, at the initial contacts and at the anchors of ties and dampers",
        ),
    }
