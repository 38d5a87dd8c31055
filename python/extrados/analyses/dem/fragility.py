"""dem-fragility: probability that blocks collapse, by discrete elements under many motions."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from extrados.analyses.batches import Swept, stacked, sweep
from extrados.analyses.context import Context, Refused
from extrados.analyses.dem import measures, solid_measures, solid_settlement
from extrados.analyses.dem import model as dem_model
from extrados.analyses.dem.job import Runs, SolidRuns, SolidTask, Task
from extrados.analyses.dem.measures import Collapse
from extrados.analyses.dem.model import Falls, Model, Restless
from extrados.analyses.dem.sampled import Sample, make_blocks
from extrados.analyses.dem.seen import BlocksSeen, Seen
from extrados.analyses.dem.settlement import farthest_settlement
from extrados.analyses.dem.solid_model import SolidModel
from extrados.analyses.dem.standing import BRIEF, compared, proof_of_section, proof_of_solids
from extrados.analyses.dem.tables import DemFragility
from extrados.analyses.dem.trial import domain_of
from extrados.analyses.motion_source import ListSource, Source, source_of
from extrados.analyses.motion_source import measures as measures_of
from extrados.analyses.needs import stones_of
from extrados.analyses.statistics.annual import hazard_curve
from extrados.analyses.statistics.levels import INTENSITIES, arranged, describe, shares_at
from extrados.analyses.statistics.uncertain import sobol_draws
from extrados.core import dem, dem3, dem_run
from extrados.core.dem_run import Effort
from extrados.core.errors import Cancelled, CoreError, status_code
from extrados.core.rocking import FAILED, Ground
from extrados.limit.errors import CannotStand, NoAnswer
from extrados.model.errors import BadGeometry
from extrados.model.geometry.assembly import Assembly
from extrados.results import statistics as out
from extrados.results.model import Array, Result, TableData
from extrados.results.rocking import COLLAPSE, NO_HINGING, RECOVERY
from extrados.schema.constants import GRAVITY

#: Motions without a count of their own
MOTIONS = 100
OUTCOMES = {"at-rest": NO_HINGING, "slid": NO_HINGING, "rocked": RECOVERY, "collapse": COLLAPSE}
WORDS = np.array(["at rest or slid", "rocked", "collapse", "failed"])
CENSORED = "blocks still move at the end of the run: give a longer `settle`"
RATIO = "ratio of the peak displacement of a block to the displacement that counts as collapse"


@dataclass(frozen=True)
class Ensemble:
    """Member k is motion k // L at level k % L, L the number of levels, on the building of that motion."""

    sample: Sample
    source: Source

    @property
    def options(self) -> DemFragility:
        """The table of the analysis."""
        return self.sample.options

    def run(self, first: int, count: int, threads: int) -> dict[str, np.ndarray]:
        """Outcome by its number, peak displacement [m] and its ratio, end of the run [s], scale, PGA [m/s^2]; whether joints slide, blocks
        still move at the end (censored), the building collapses under its weight (unstable); the reason of a missing result."""
        kept: dict[tuple[int, float], Model | SolidModel] = {}  # of the motion whose levels follow one another

        def one(k: int) -> dict[str, np.ndarray]:
            return {name: np.array(value) for name, value in self._member(k, kept, threads).items()}

        return stacked(one, first, count)

    def _member(self, k: int, kept: dict[tuple[int, float], Model | SolidModel], threads: int) -> dict[str, Any]:
        o = self.options
        motion, level = divmod(k, len(o.levels))
        row: dict[str, Any] = {name: np.nan for name in ("peak", "peak_ratio", "stop_time", "scale", "pga")}
        row |= {"outcome": np.int8(FAILED), "slips": np.int8(0), "censored": np.int8(0), "unstable": np.int8(0), "reason": ""}
        row |= {"off_footing": np.int8(0), "energy_residual": 0.0, **_effort_rows(dem_run.NO_EFFORT)}
        (ground,) = self.source.grounds(motion, 1, 1)
        if isinstance(ground, str):
            return row | {"reason": ground}
        scale, pga = self._scale(ground, o.levels[level])
        if not np.isfinite(scale):
            return row | {"reason": "the motion is zero, so it cannot be scaled"}
        row |= {"scale": scale, "pga": scale * pga}
        fallen = {"outcome": np.int8(COLLAPSE), "unstable": np.int8(1), "peak_ratio": 1.0, "stop_time": 0.0}
        size = o.levels[level] if o.intensity == "size" else 1.0
        try:
            if (motion, size) not in kept:
                kept.clear()
                kept[motion, size] = self.sample.model(motion, size)
            return row | self._moved(kept[motion, size], ground, scale, size, threads)
        except (Falls, Restless) as error:
            if isinstance(error, Restless) and not self._cannot_stand(kept[motion, size], motion, size):
                return row | {"reason": str(error)}
            return row | fallen
        except CannotStand:
            return row | fallen
        except (Refused, BadGeometry, CoreError, NoAnswer) as error:
            if isinstance(error, Cancelled):
                raise
            return row | {"reason": str(error)}

    def _cannot_stand(self, model: Model | SolidModel, motion: int, size: float) -> bool:
        """Whether limit analysis proves collapse under the own weight of a building that does not come to rest."""
        building = self.sample.building_of(motion, size)
        try:
            if isinstance(model, Model):
                return proof_of_section(building, model.strength or None) is not None
            return proof_of_solids(building, model.strength or None) is not None
        except NoAnswer:
            return False

    def _scale(self, ground: Ground, level: float) -> tuple[float, float]:
        """Factor that brings a motion to a level, NaN of a motion without acceleration, and its PGA [m/s^2]."""
        o = self.options
        own = measures_of([ground], (o.sa_period, o.sa_damping) if o.sa_period else None, 1)
        pga = float(own["pga"][0])
        if o.intensity in ("scale", "size"):
            return (level if o.intensity == "scale" else 1.0), pga
        value = float(own[o.intensity][0])
        if not value > 0.0:
            return np.nan, pga
        share = level * INTENSITIES[o.intensity][1] / value
        return float(np.sqrt(share) if o.intensity == "arias" else share), pga

    def _moved(self, model: Model | SolidModel, ground: Ground, scale: float, size: float, threads: int) -> dict[str, Any]:
        """How the blocks end under a motion times a scale."""
        o = self.options
        collapse = Collapse.of(None if o.collapse_displacement is None else size * o.collapse_displacement, model.size)
        end = ground.end + (dem_model.settle_time(model) if o.settle is None else o.settle)
        found = dem_model.checked(follow(model, o, ground, scale, end, collapse, threads), model)
        if found.interrupted:
            raise Cancelled(status_code("cancelled"), "discrete elements interrupted")
        seen = look(model, found, o.floor is not None)
        outcome = seen.fate(collapse).outcome
        peak = measures.peak_displacement(found, seen.farthest, collapse.displacement)
        censored = outcome != "collapse" and found.reason == "end" and measures.moving(found, model)
        return {
            "outcome": np.int8(FAILED if censored else OUTCOMES[outcome]),
            "peak": peak,
            "peak_ratio": peak / collapse.displacement,
            "stop_time": found.stop_time,
            "slips": np.int8(seen.slides),
            "censored": np.int8(censored),
            "reason": CENSORED if censored else "",
            "off_footing": np.int8(outcome != "collapse" and bool(seen.unsupported)),
            "energy_residual": found.residual,
            **_effort_rows(found.effort),
        }


def _effort_rows(effort: Effort) -> dict[str, float]:
    """The work of rigid contacts as rows of a member."""
    return {f"effort_{name}": float(value) for name, value in vars(effort).items()}


def _effort_of(swept: Swept) -> Effort:
    """The work of rigid contacts in all members."""
    rows = {name: swept[f"effort_{name}"] for name in vars(dem_run.NO_EFFORT)}
    total = [int(rows[name].sum()) for name in ("steps", "factors", "open_steps")]
    worst = int(rows["residual"].argmax())
    return Effort(total[0], total[1], int(rows["most_rounds"].max()), total[2], float(rows["residual"][worst]), float(rows["worst"][worst]))


def look(model: Model | SolidModel, found: Any, floor: bool) -> BlocksSeen:
    """What is read off a run; floor: blocks slide on a level floor, not off their footings."""
    return Seen.of(model, found, floor) if isinstance(model, Model) else solid_measures.look(model, found, floor)


def follow(
    model: Model | SolidModel, options: DemFragility, ground: Ground | None, scale: float, end: float, collapse: Collapse, threads: int
) -> dem.Run | dem3.Run:
    """One run under a ground motion times a scale until `end` [s], or until rest or collapse."""
    given: dict[str, Any] = {
        "end_time": end,
        "output_step": min(options.output_step, end),
        "step": options.time_step or 0.0,
        "fraction": options.step_fraction(space=not isinstance(model, Model)),
        "settle_damping": model.values.settle_damping,
        "stop_at_rest": True,
        "rigid": options.rigid,
        "rebound": options.rebound,
        **collapse.options,
    }
    if isinstance(model, Model):
        domain, far = domain_of(model), farthest_settlement(model, rigid=options.rigid)
        of_section = dem.Options(**given, domain=domain, settlement=far, mass_damping=options.mass_damping)
        return Runs([model.bodies()], [Task(0, of_section, ground, scale)]).one(0, threads)
    far = solid_settlement.farthest_settlement(model, options.rigid)
    of_solids = dem3.Options(**given, settlement=far, way=options.way)
    return SolidRuns(model.bodies(), [SolidTask(of_solids, ground, scale=scale)]).one(0, threads)


def run(context: Context, options: DemFragility) -> Result:
    """Shares of collapse at all levels, with their curve; see the deck reference."""
    model = make_blocks(context.building, options)
    if isinstance(model, Model):
        context.warnings += dem_model.warnings(model, options)
    else:
        context.warnings += dem_model.warnings_of_solids(model, springs=not options.rigid)
    return compared(context, options.rigid, model, lambda: _found(context, options, model))


def _found(context: Context, options: DemFragility, model: Model | SolidModel) -> Result:
    dem_model.checked(follow(model, options, None, 1.0, BRIEF, Collapse.of(None, model.size), context.threads), model)
    source, there = source_of(context, options.seed)
    motions = options.count or there or MOTIONS
    draws = sobol_draws(len(options.uncertain), motions, options.seed or 0) if options.uncertain else np.zeros((motions, 0))
    job = Ensemble(Sample(context.building, options, draws), source)
    count = motions * len(options.levels)
    swept = sweep(context, "dem-fragility", job, count, "motions on discrete elements", slow=True, parallel=True)
    result = Result("dem-fragility")
    if swept.interrupted:
        result.status, result.reason = "interrupted", swept.stopped
    elif swept.stopped:
        result.status, result.reason = "failed", swept.stopped
    if not swept.finished:
        result.answer = "No member is finished."
        return result
    _describe(context, options, job, swept, motions, result)
    return result


def _describe(context: Context, options: DemFragility, job: Ensemble, swept: Swept, motions: int, result: Result) -> None:
    levels = np.array(options.levels)
    hazard = None if options.hazard is None else (hazard_curve(options.hazard, context.deck.folder), options.hazard)
    repeats = 0 if swept.interrupted else options.bootstrap
    word = context.building.require_structure().word
    seen = arranged(levels, swept)
    numbers = describe(seen, options.intensity, word, 0.0, hazard, options.confidence, repeats, options.seed or 0, result, RATIO)
    # The ratios of blocks are displacements, those of a mechanism are rotations
    numbers = {key.replace("peak_rotation", "peak_displacement"): value for key, value in numbers.items()}
    numbers["sliding_share"] = shares_at(levels, swept, "slips")["slips"]
    order = np.argsort(levels, kind="stable")
    at = swept.members % len(levels)
    censored = np.bincount(at, swept["censored"], len(levels))[order].astype(int)
    fell, valid = np.array(numbers["collapsed"]), np.array(numbers["count"])
    runs = np.maximum(valid + censored, 1)
    known = (valid + censored > 0)[:, None]
    bounds = np.where(known, np.column_stack([fell / runs, (fell + censored) / runs]), np.nan)
    numbers["collapse_probability_bounds"] = bounds
    section, effort = isinstance(stones_of(context.building, options), Assembly), _effort_of(swept)
    unstable = len(np.unique(swept.members[swept["unstable"] > 0] // len(levels)))
    result.results = out.DemFragility(
        **numbers,
        motions=motions,
        failed=int((swept["outcome"] == FAILED).sum()),
        confidence=options.confidence,
        solver=options.solver,
        direction_deg=None if section else options.direction or 0.0,
        uncertain=sorted(options.uncertain),
        censored=censored.tolist(),
        unstable=unstable,
        convergence=measures.convergence(effort) if options.rigid else None,
    )
    if options.intensity == "size":
        result.answer = _spoken_sizes(result.results, word)
    result.arrays |= {
        "stripe_bound_low": Array(bounds[:, 0], ("stripe",), "", "share of collapse if runs whose blocks still move count as standing"),
        "stripe_bound_high": Array(bounds[:, 1], ("stripe",), "", "share of collapse if runs whose blocks still move count as collapsed"),
        "outcome": Array(
            swept["outcome"], ("member",), "", "outcome: -1 no result or still moving, 0 at rest or slid, 1 rocked, 2 collapse"
        ),
        "displacement_ratio": Array(swept["peak_ratio"], ("member",), "", RATIO),
        "pga": Array(swept["pga"] / GRAVITY, ("member",), "g"),
    }
    _tell(job.source, swept, len(levels), unstable, result)
    result.warnings += dem_model.unconverged(effort)
    _table(options, levels, swept, result)


def _spoken_sizes(r: out.DemFragility, word: str) -> str:
    shares = "; ".join(
        f"{100 * share:.3g} % for all lengths times {level:g}"
        for level, share in zip(r.levels, r.collapse_probability, strict=True)
        if share is not None
    )
    return f"Share of {r.motions} motion{'s' if r.motions > 1 else ''} that cause collapse of the {word}: {shares}."


def _tell(source: Source, swept: Swept, levels: int, unstable: int, result: Result) -> None:
    """Why members have no result, and which collapse before they move."""
    censored, lost = swept["censored"] > 0, (swept["outcome"] == FAILED) & (swept["censored"] == 0)
    if censored.any():
        result.warnings.append(
            f"Blocks still move at the end of {int(censored.sum())} of {len(censored)} runs. These runs have no outcome; "
            "`collapse_probability_bounds` counts them once as standing and once as collapsed. Give a longer `settle`."
        )
    if lost.any():
        first = int(np.flatnonzero(lost)[0])
        motion = int(swept.members[first]) // levels
        name = source.names[motion % len(source.names)] if isinstance(source, ListSource) else f"motion {motion + 1}"
        result.warnings.append(f"{int(lost.sum())} of {len(lost)} runs have no result. First reason: {name}: {swept['reason'][first]}")
    if off := int(swept["off_footing"].sum()):
        result.warnings.append(
            f"In {off} of {len(lost)} runs without collapse, blocks slide off their footings. If detached blocks can slide on a floor, "
            "give its height as `floor`."
        )
    if (residual := float(swept["energy_residual"].max())) > measures.LARGE_RESIDUAL:
        result.warnings.append(f"The error of the energy balance is up to {100 * residual:.2g} % of the total energy exchanged in a run.")
    if unstable:
        result.warnings.append(
            f"{unstable} of the sampled buildings collapse under their own weight: they count as collapsed under every motion."
        )


def _table(options: DemFragility, levels: np.ndarray, swept: Swept, result: Result) -> None:
    words = np.where(swept["censored"] > 0, "censored", WORDS[swept["outcome"]])
    result.tables["ensemble"] = TableData(
        {
            "member": swept.members + 1,
            "motion": swept.members // len(levels) + 1,
            "level": levels[swept.members % len(levels)],
            "scale": swept["scale"],
            "pga": swept["pga"] / GRAVITY,
            "outcome": words,
            "peak_displacement": swept["peak"],
            "peak_ratio": swept["peak_ratio"],
            "slides": swept["slips"],
            "stop_time": swept["stop_time"],
            "reason": swept["reason"],
        },
        {"level": INTENSITIES[options.intensity][2], "pga": "g", "peak_displacement": "m", "stop_time": "s"},
    )
