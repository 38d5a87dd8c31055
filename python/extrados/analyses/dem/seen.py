"""What is read off a run of blocks, in the plane and in space, and how it ends."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from extrados.analyses.context import Context
from extrados.analyses.dem import measures
from extrados.analyses.dem import model as dem_model
from extrados.analyses.dem.forces import carried_elsewhere, force_keys
from extrados.analyses.dem.model import Model
from extrados.analyses.dem.solid_model import SolidModel
from extrados.analyses.dem.tables import Dem
from extrados.analyses.dem.ties import tie_rows
from extrados.analyses.dem.words import supports_answer
from extrados.core import dem, dem_run
from extrados.core.dem_run import SupportMove
from extrados.results.dem import CLOSED, SLIP_LIMIT
from extrados.results.model import Result
from extrados.schema.constants import GRAVITY

SHOWN = 3  # blocks that a warning names


@dataclass(frozen=True)
class BlocksSeen:
    """What is read off any run: what the joints do (results.dem), at which a block has slid off its footing (time, joint),
    displacements [m], rotations [rad] and losses of height [m] of the bodies (time, body), how far joints that touch slide."""

    model: Model | SolidModel
    run: dem_run.FoundRun
    state: np.ndarray
    off: np.ndarray
    moved: tuple[np.ndarray, np.ndarray, np.ndarray]
    sliding: measures.Slip

    @property
    def farthest(self) -> float:
        """Greatest displacement of any block at any time [m]."""
        return float(self.moved[0].max(initial=0.0))

    @property
    def slides(self) -> bool:
        """Whether some joint slid."""
        return self.sliding.ratio > measures.SLIDES

    @property
    def off_footing(self) -> list[int]:
        """Numbers of the blocks that slid off their footings."""
        return measures.blocks_off(self.model.assembly.a, self.model.assembly.b, self.off)

    @property
    def unsupported(self) -> set[int]:
        """Numbers of the bodies that slid off their footings."""
        return set(self.off_footing)

    def fate(self, collapse: measures.Collapse) -> measures.Fate:
        """How the run ends. A block that tips over the end of its footing has slid, and does not rock on its joint."""
        rocks = bool(((self.state != CLOSED) & ~self.off).any())
        return measures.fate(self.run, collapse, *self.moved, self.unsupported, rocks, self.slides)


@dataclass(frozen=True)
class Seen(BlocksSeen):
    """What is read off a run in the plane, too: openings and slip of the joints (time, joint) [m], rotations of the blocks (time,
    block) [rad]."""

    model: Model
    run: dem.Run
    gap_p: np.ndarray
    gap_q: np.ndarray
    slip: np.ndarray
    rotation: np.ndarray

    @classmethod
    def of(cls, model: Model, run: dem.Run, floor: bool) -> "Seen":
        """floor: blocks slide on a level floor, not off their footings."""
        gap_p, gap_q, slip = measures.openings(model, run)
        state = measures.hinges(model, gap_p, gap_q, slip)
        a, body = model.assembly, model.rigid.body_of_block
        return cls(
            model=model,
            run=run,
            state=state,
            off=np.zeros(state.shape, dtype=bool) if floor else measures.off_footing(a.a, a.b, state, slip, a.length),
            moved=measures.movements(model, run),
            sliding=measures.Slip.of(state, slip, a.length),
            gap_p=gap_p,
            gap_q=gap_q,
            slip=slip,
            rotation=-(run.place[:, body, 2] - run.settled[body, 2]),
        )

    @property
    def unsupported(self) -> set[int]:
        """Numbers of the bodies that slid off their footings: several blocks may be one body."""
        return {int(self.model.rigid.body_of_block[i]) for i in self.off_footing}


def moved_supports(seen: BlocksSeen, moves: Sequence[SupportMove], axes: int, shaken: bool) -> str:
    """What supports did, in words; axes: two or three; shaken: a motion acts, too."""
    found, model = seen.run, seen.model
    if not len(found.time):
        return ""
    lift = float(measures.carried(found, model.count, axes)[-1, -1])
    work = None if shaken else float(found.energy["work"][-1])
    return supports_answer(measures.farthest_move(moves, axes), lift, float(model.mass.sum()) * GRAVITY, work)


def begun_result(context: Context, found: dem_run.FoundRun) -> Result:
    """The result of a run before its values: whether it was interrupted, and when, and that rigid contacts use one thread."""
    one = context.threads_given and context.threads > 1 and found.effort.steps > 0
    text = f"a run on rigid contacts uses one thread, not the {context.threads} requested"
    warnings = [text] if one else []
    if not found.interrupted:
        return Result("dem", warnings=warnings)
    again = "; --resume continues from here" if context.checkpoint is not None and len(found.time) else ""
    return Result("dem", status="interrupted", reason=f"interrupted at {found.stop_time:.3f} s{again}", warnings=warnings)


def numbers_of(options: Dem, seen: BlocksSeen, collapse: measures.Collapse) -> dict[str, Any]:
    """The results of any run by their keys, but for chaos and what sections and solids have of their own."""
    model, found, names, fate = seen.model, seen.run, seen.model.assembly.block_names, seen.fate(collapse)
    mobile = slice(0, model.count)
    return {
        "outcome": fate.outcome,
        "collapse_criterion": fate.criterion,
        "collapse_time_s": fate.time,
        "governing_block": model.body_names[fate.block],
        "stopped": found.reason,
        "stopped_by": [model.body_names[k] for k in found.blamed],
        "stop_time_s": found.stop_time,
        "still_moving": found.reason == "end" and measures.moving(found, model),
        "collapse_displacement_m": collapse.displacement,
        "peak_displacement_m": measures.peak_displacement(found, seen.farthest, collapse.displacement),
        "peak_slip_m": seen.sliding.peak,
        "residual_slip_m": seen.sliding.residual,
        "slip_ratio": seen.sliding.ratio,
        "slip_limit_ratio": SLIP_LIMIT,
        "slipped_joint": model.assembly.joint_names[seen.sliding.joint] if seen.slides else None,
        "off_footing": [names[i] for i in seen.off_footing],
        "peak_kinetic_energy_J": float(found.energy["kinetic"].max(initial=0.0)),
        "friction_loss_J": float(found.energy["friction"][-1]) if len(found.time) else 0.0,
        "damping_loss_J": float(found.energy["damping"][-1]) if len(found.time) else 0.0,
        "energy_residual_ratio": found.residual,
        "bounces": int(found.bounces[mobile].sum()),
        "airborne_time_s": float(found.airborne[mobile].max(initial=0.0)),
        **force_keys(model, found),
        **tie_rows(model.ties, found),
        "solver": options.solver,
        "convergence": measures.convergence(found.effort) if options.rigid else None,
        **measures.springs(options, model.values, found),
        "steps": found.steps,
        "settling_steps": found.settling_steps,
        "time_step_s": found.step,
        "contact_searches": found.searches,
        "animation": options.animation,
    }


def doubts_of_run(model: Model | SolidModel, found: dem_run.FoundRun, violated: list[str], still_moving: bool) -> list[str]:
    """Warnings of any run: its energy balance, its convergence, conditions that do not hold, an end before rest."""
    doubts = []
    if found.residual > measures.LARGE_RESIDUAL:
        doubts.append(
            f"the error of the energy balance is {100 * found.residual:.2g} % of the total energy exchanged. Try a smaller time step"
        )
    doubts += [*dem_model.unconverged(found.effort), *violated]
    if elsewhere := carried_elsewhere(model, found):
        more = f" and {len(elsewhere) - SHOWN} more blocks" if len(elsewhere) > SHOWN else ""
        doubts.append(
            f"contacts that formed during the motion carry {', '.join(elsewhere[:SHOWN])}{more}; the "
            "reactions and the base shear do not include the forces of these contacts"
        )
    if still_moving:
        doubts.append("the structure still moves at the end of the run: a later `end_time` may change the outcome")
    return doubts
