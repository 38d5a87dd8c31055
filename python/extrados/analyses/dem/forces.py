"""Forces between blocks over time, reactions of the ground, and the energy that each pair of blocks lost; in the plane and in space."""

import numpy as np

from extrados.analyses.dem.model import Model
from extrados.analyses.dem.solid_model import SolidModel
from extrados.core import dem_run
from extrados.model.geometry.assembly import GROUND
from extrados.results.dem import PairWork
from extrados.results.fields import Keys
from extrados.results.model import Array
from extrados.schema.constants import GRAVITY

MOST_PAIRS = 20  # of results


def reactions(model: Model | SolidModel, run: dem_run.FoundRun) -> np.ndarray:
    """Force of the ground on the blocks at the contacts as drawn (time, 2 or 3) [N]; the last component is vertical."""
    grounded = run.joint_body[:, 1] >= model.count
    found: np.ndarray = run.joint_force[:, grounded].sum(axis=1)
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
        "pair_block": Array(blocks, ("pair", "side"), "", "blocks that touch as drawn, -1 the ground"),
        "pair_force": Array(run.joint_force, ("time", "pair", axis), "N", "contact force on the first of the two blocks of each pair"),
        "pair_friction_work": Array(run.joint_friction, ("time", "pair"), "J", "energy lost by friction so far"),
        "pair_damping_work": Array(
            run.joint_damping, ("time", "pair"), "J", "energy lost in dashpots, or by impacts of rigid contacts, so far"
        ),
        "reaction": Array(reactions(model, run), ("time", axis), "N", "force of the ground on the blocks at the contacts as drawn"),
    }
