"""dem-domain: the shortest pulses that bring a structure down, by discrete elements (thesis Figs 7-11, 7-13, 7-14)."""

from dataclasses import dataclass

import numpy as np

from extrados.analyses.context import Context, Refused
from extrados.analyses.dem import model as dem_model
from extrados.analyses.dem.model import JointValues, Model
from extrados.analyses.dem.runs import Runs, Task, answered
from extrados.analyses.dem.settlement import farthest_settlement
from extrados.analyses.dem.tables import DemDomain
from extrados.analyses.dem.trial import start
from extrados.analyses.rocking.failure_domain import settling_time, shortest_durations, unit_pulse
from extrados.building.errors import BadGeometry
from extrados.building.rockers.arch import ArchModel
from extrados.building.templates.arch import ArchAssembly
from extrados.core import dem
from extrados.core.calls import interruptible
from extrados.core.errors import CoreError
from extrados.results import dem as out
from extrados.results.model import Array, Result, TableData
from extrados.schema.constants import GRAVITY

FAILED = ("collapse", "left")


@dataclass(frozen=True)
class Curve:
    """Shortest failing duration [s] at each amplitude (NaN: none of those tried fails) for one set of joints."""

    label: str
    values: JointValues
    shortest: np.ndarray


class Search:
    """Asks round by round which pulses (curve, amplitude, duration) bring the structure down."""

    def __init__(self, context: Context, options: DemDomain, model: Model, curves: list[JointValues], rounds: float):
        self.context, self.options, self.model = context, options, model
        self.bodies = [model.bodies(values) for values in curves]
        self.settlement = [farthest_settlement(model, values) for values in curves]
        self.settle = options.settle or dem_model.settle_time(model)
        self.limit = options.collapse_displacement or 0.2 * model.size
        self.shift = start(context, model)
        self.asked, self.total = 0, len(curves) * len(options.amplitudes) * rounds
        self.residual, self.steps = 0.0, 0

    def fails(self, pulses: list[tuple[int, float, float]]) -> list[bool]:
        """Whether each pulse (curve, amplitude [m/s^2], duration [s]) brings the structure down; Unfinished where
        some have no answer, Refused where one is not to be trusted."""
        runs = answered(
            self.context, "dem-domain", Runs(self.bodies, [self._task(*one) for one in pulses]), "",
            tell=lambda done: self.context.progress(
                min(self.asked + done, self.total), self.total, "failure domain by discrete elements"
            ),
        )  # fmt: skip
        self.asked += len(pulses)
        for run in runs:
            dem_model.checked(run, self.model)
            self.residual = max(self.residual, run.residual)
            self.steps += run.steps
        return [run.reason in FAILED for run in runs]

    def _task(self, curve: int, amplitude: float, duration: float) -> Task:
        motion = unit_pulse(self.options.pulse, duration)
        options = dem.Options(
            end_time=motion.end + self.settle, output_step=1e3, fraction=self.options.fraction, collapse=self.limit,
            stop_at_rest=True, mass_damping=self.options.mass_damping, settlement=self.settlement[curve],
        )  # fmt: skip
        return Task(curve, options, motion.ground, amplitude, self.shift)


def run(context: Context, options: DemDomain) -> Result:
    """Curves of the shortest failing durations, with their sensitivity, beside those of the four-hinge model."""
    model = dem_model.make_model(context, options)
    labels = ["as given"]
    labels += [f"damping x {f:g}" for f in options.vary_damping]
    labels += [f"stiffness x {f:g}" for f in options.vary_stiffness]
    labels += [f"friction {f:g}" for f in options.vary_friction]
    base = model.values
    curves = [
        base,
        *(base.scaled(damping=f) for f in options.vary_damping),
        *(base.scaled(stiffness=f) for f in options.vary_stiffness),
        *(base.scaled(friction=f) for f in options.vary_friction),
    ]
    context.warnings += dem_model.warnings(model, options)
    amplitudes, durations = np.array(options.amplitudes), np.array(options.durations)
    refining = max(0.0, np.ceil(np.log2(max(float(np.diff(durations).max()), durations[0]) / options.accuracy)))
    search = Search(context, options, model, curves, len(durations) + refining)
    with interruptible():  # Ctrl-C between two rounds stops the next one
        shortest = _shortest(search, len(curves), amplitudes, durations, options.accuracy)
    found = [Curve(label, v, row) for label, v, row in zip(labels, curves, shortest, strict=True)]
    result = Result("dem-domain")
    numbers = {
        "pulse": options.pulse,
        "amplitudes_g": amplitudes / GRAVITY,
        "shortest_durations_s": shortest[0],
        "curves": [
            out.DemCurve(
                label=c.label,
                beta_s=c.values.beta,
                stiffness_Pa_per_m=c.values.stiffness.max(),
                friction=c.values.friction.max(),
                **{f"damping_ratio_{name}": ratio for name, ratio in c.values.ratios().items()},
                shortest_durations_s=c.shortest,
            )
            for c in found
        ],
        "energy_residual_ratio": search.residual,
        "steps": search.steps,
    }
    table = {"amplitude": amplitudes / GRAVITY, **{f"shortest duration, {c.label}": c.shortest for c in found}}
    units = {"amplitude": "g", **{f"shortest duration, {c.label}": "s" for c in found}}
    result.arrays = {
        "amplitude": Array(amplitudes / GRAVITY, ("amplitude",), "g"),
        "curve": Array(np.array(labels), ("curve",), "", "what was varied"),
        "shortest": Array(np.array(shortest), ("curve", "amplitude"), "s", "shortest failing duration"),
    }
    numbers |= _beside(context, options, model, amplitudes, durations, result, table, units)
    result.results = out.DemDomain(**numbers)
    result.tables["dem_domain"] = TableData(table, units)
    result.answer = _answer(result.results, amplitudes, shortest[0])
    return result


def _shortest(
    search: Search, curves: int, amplitudes: np.ndarray, durations: np.ndarray, accuracy: float
) -> np.ndarray:
    """Shortest failing duration (curves, amplitudes): the first failing one of those tried, refined by bisection.

    Above the first failing duration there are safe pockets (as for single blocks), so the durations are scanned
    upward and only the cell below the first failure is bisected.
    """
    rows = [(k, float(a)) for k in range(curves) for a in amplitudes]
    low, high = np.zeros(len(rows)), np.full(len(rows), np.nan)
    open_rows = list(range(len(rows)))
    for duration in durations:
        fails = search.fails([(*rows[r], float(duration)) for r in open_rows]) if open_rows else []
        for r, failed in zip(open_rows, fails, strict=True):
            if failed:
                high[r] = duration
            else:
                low[r] = duration
        open_rows = [r for r, failed in zip(open_rows, fails, strict=True) if not failed]
    while True:
        wide = [
            r for r in range(len(rows))
            # as fine as numbers are where the middle is one of the ends
            if np.isfinite(high[r]) and high[r] - low[r] > accuracy and low[r] < 0.5 * (low[r] + high[r]) < high[r]
        ]  # fmt: skip
        if not wide:
            return high.reshape(curves, len(amplitudes))
        fails = search.fails([(*rows[r], float(0.5 * (low[r] + high[r]))) for r in wide])
        for r, failed in zip(wide, fails, strict=True):
            middle = 0.5 * (low[r] + high[r])
            if failed:
                high[r] = middle
            else:
                low[r] = middle


def _beside(
    context: Context, options: DemDomain, model: Model, amplitudes: np.ndarray, durations: np.ndarray, result: Result,
    table: dict, units: dict,
) -> dict[str, np.ndarray]:  # fmt: skip
    """Shortest failing durations of the four-hinge model at the same amplitudes, where the structure is an arch: their
    keys; arrays and columns go to `result` and `table`."""
    if not isinstance(model.assembly, ArchAssembly):
        return {}
    arch = ArchModel(model.assembly, context.building.joints.restitution)
    try:
        tried = np.linspace(0.1 * durations[0], 1.5 * durations[-1], 120)
        found = shortest_durations(
            arch.body, options.pulse, amplitudes, tried, settling_time(arch), 1e-4, context.threads, context
        )
    except (BadGeometry, Refused, CoreError) as error:
        result.warnings.append(f"no four-hinge curves beside these: {error}")
        return {}
    for mode, shortest in zip(("mode_I", "mode_II"), found, strict=True):
        result.arrays[mode] = Array(shortest, ("amplitude",), "s", "shortest failing duration of the four-hinge model")
        table[f"four-hinge {mode}"] = shortest
        units[f"four-hinge {mode}"] = "s"
    return {"four_hinge_mode_I_durations_s": found[0], "four_hinge_mode_II_durations_s": found[1]}


def _answer(r: out.DemDomain, amplitudes: np.ndarray, shortest: np.ndarray) -> str:
    told = [
        f"{a / GRAVITY:.3g} g for {t:.3f} s" if np.isfinite(t) else f"{a / GRAVITY:.3g} g: none of those tried"
        for a, t in zip(amplitudes, shortest, strict=True)
    ]
    text = f"Shortest {r.pulse} pulses that bring it down: {'; '.join(told)}."
    spread = [(c.label, np.array([np.nan if t is None else t for t in c.shortest_durations_s])) for c in r.curves[1:]]
    if spread:
        with np.errstate(invalid="ignore"):
            worst = max(spread, key=lambda item: np.nanmax(np.abs(item[1] / shortest - 1.0), initial=0.0))
        change = np.nanmax(np.abs(worst[1] / shortest - 1.0), initial=0.0)
        text += f" The greatest change, {100 * change:.0f} %, comes with {worst[0]}."
    mode = r.four_hinge_mode_I_durations_s
    if mode and all(t is not None for t in mode) and np.isfinite(shortest).all():
        text += f" The four-hinge model gives {', '.join(f'{t:.3f}' for t in mode)} s (after one impact)."
    return text
