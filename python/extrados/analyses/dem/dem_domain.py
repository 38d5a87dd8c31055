"""dem-domain: the shortest pulses that bring a structure down, by discrete elements (thesis Figs 7-11, 7-13, 7-14)."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from extrados.analyses.context import Context, Refused
from extrados.analyses.dem import model as dem_model
from extrados.analyses.dem.model import JointValues, Model
from extrados.analyses.dem.tables import DemDomain
from extrados.analyses.rocking.failure_domain import settling_time, shortest_durations, unit_pulse
from extrados.building.errors import BadGeometry
from extrados.building.rockers.arch import ArchModel
from extrados.building.templates.arch import ArchAssembly
from extrados.core import dem
from extrados.core.errors import CoreError
from extrados.results.checkpoint import fingerprint
from extrados.results.model import Array, Result, TableData
from extrados.schema.constants import GRAVITY

FAILED = ("collapse", "left")


@dataclass(frozen=True)
class Curve:
    """Shortest failing duration [s] at each amplitude (NaN: none of those tried fails) for one set of joints."""

    label: str
    values: JointValues
    shortest: np.ndarray


class Sweep:
    """Runs pulses (curve, amplitude, duration) once each, in parallel, and remembers their outcomes."""

    def __init__(self, context: Context, options: DemDomain, model: Model, curves: list[JointValues]):
        self.options, self.model, self.curves = options, model, curves
        self.context = context
        self.settle = options.settle or dem_model.settle_time(model)
        self.limit = options.collapse_displacement or 0.2 * model.size
        self.answers: dict[str, bool] = {}
        self.batches = 0
        self.residual = 0.0
        self.steps = 0
        # The deck guards the checkpoint; two sweeps of one deck are told apart by what they ask.
        self.name = "dem-domain-" + fingerprint([options.model_dump(), context.building.joints.model_dump()])[:16]
        if context.checkpoint is not None:
            for first, kept in context.checkpoint.load(self.name):
                self.answers |= dict(zip(kept["pulse"].tolist(), kept["fails"].tolist(), strict=True))
                self.residual = max(self.residual, float(kept["residual"]))
                self.steps += int(kept["steps"])
                self.batches = max(self.batches, first + 1)

    def fails(self, asked: list[tuple[int, float, float]], tick: Callable[[int], None]) -> list[bool]:
        """Whether each pulse (curve, amplitude [m/s^2], duration [s]) brings the structure down."""
        keys = [f"{k} {a!r} {t!r}" for k, a, t in asked]
        todo = [(key, one) for key, one in zip(keys, asked, strict=True) if key not in self.answers]
        batch = 8 * max(1, self.context.threads)
        for first in range(0, len(todo), batch):
            part = todo[first : first + batch]
            runs = dem_model.many([self._task(*one) for _, one in part], self.context.threads, lambda n: None)
            for (key, _), run in zip(part, runs, strict=True):
                dem_model.checked(run, self.model)
                self.answers[key] = run.reason in FAILED
                self.residual = max(self.residual, run.residual)
                self.steps += run.steps
            if self.context.checkpoint is not None:
                done = [key for key, _ in part]
                arrays = {
                    "pulse": np.array(done),
                    "fails": np.array([self.answers[key] for key in done]),
                    "residual": np.array(max(run.residual for run in runs)),
                    "steps": np.array(sum(run.steps for run in runs)),
                }
                self.context.checkpoint.keep(self.name, self.batches, arrays)
                self.batches += 1
            tick(len(part))
        return [bool(self.answers[key]) for key in keys]

    def _task(self, curve: int, amplitude: float, duration: float) -> Callable[[], dem.Run]:
        motion = unit_pulse(self.options.pulse, duration)
        options = dem.Options(
            end_time=motion.end + self.settle, output_step=1e3, fraction=self.options.fraction, collapse=self.limit,
            stop_at_rest=True, mass_damping=self.options.mass_damping,
        )  # fmt: skip
        bodies = self.model.bodies(self.curves[curve])
        return lambda: dem.run(bodies, options, motion.ground, scale=amplitude)


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
    sweep = Sweep(context, options, model, curves)
    amplitudes, durations = np.array(options.amplitudes), np.array(options.durations)
    refining = max(0.0, np.ceil(np.log2(max(float(np.diff(durations).max()), durations[0]) / options.accuracy)))
    total = len(curves) * len(amplitudes) * (len(durations) + refining)
    done = 0

    def tick(n: int) -> None:
        nonlocal done
        done += n
        context.progress(min(done, total), total, "failure domain by discrete elements")

    shortest = _shortest(sweep, len(curves), amplitudes, durations, options.accuracy, tick)
    found = [Curve(label, v, row) for label, v, row in zip(labels, curves, shortest, strict=True)]
    result = Result("dem-domain")
    result.results = {
        "pulse": options.pulse,
        "amplitudes_g": amplitudes / GRAVITY,
        "shortest_durations_s": [None if np.isnan(t) else float(t) for t in shortest[0]],
        "curves": [
            {
                "label": c.label,
                "beta_s": c.values.beta,
                "stiffness_Pa_per_m": float(c.values.stiffness.max()),
                "friction": float(c.values.friction.max()),
                **{f"damping_ratio_{name}": ratio for name, ratio in c.values.ratios().items()},
                "shortest_durations_s": [None if np.isnan(t) else float(t) for t in c.shortest],
            }
            for c in found
        ],
        "energy_residual_ratio": sweep.residual,
        "steps": sweep.steps,
    }
    table = {"amplitude": amplitudes / GRAVITY, **{f"shortest duration, {c.label}": c.shortest for c in found}}
    units = {"amplitude": "g", **{f"shortest duration, {c.label}": "s" for c in found}}
    result.arrays = {
        "amplitude": Array(amplitudes / GRAVITY, ("amplitude",), "g"),
        "curve": Array(np.array(labels), ("curve",), "", "what was varied"),
        "shortest": Array(np.array(shortest), ("curve", "amplitude"), "s", "shortest failing duration"),
    }
    _beside(context, options, model, amplitudes, durations, result, table, units)
    result.tables["dem_domain"] = TableData(table, units)
    result.answer = _answer(result.results, amplitudes, shortest[0])
    return result


def _shortest(
    sweep: Sweep,
    curves: int,
    amplitudes: np.ndarray,
    durations: np.ndarray,
    accuracy: float,
    tick: Callable[[int], None],
) -> np.ndarray:
    """Shortest failing duration (curves, amplitudes): the first failing one of those tried, refined by bisection.

    Above the first failing duration there are safe pockets (as for single blocks), so the durations are scanned
    upward and only the cell below the first failure is bisected.
    """
    rows = [(k, float(a)) for k in range(curves) for a in amplitudes]
    low, high = np.zeros(len(rows)), np.full(len(rows), np.nan)
    open_rows = list(range(len(rows)))
    for duration in durations:
        fails = sweep.fails([(*rows[r], float(duration)) for r in open_rows], tick)
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
        fails = sweep.fails([(*rows[r], float(0.5 * (low[r] + high[r]))) for r in wide], tick)
        for r, failed in zip(wide, fails, strict=True):
            middle = 0.5 * (low[r] + high[r])
            if failed:
                high[r] = middle
            else:
                low[r] = middle


def _beside(
    context: Context, options: DemDomain, model: Model, amplitudes: np.ndarray, durations: np.ndarray, result: Result,
    table: dict, units: dict,
) -> None:  # fmt: skip
    """Shortest failing durations of the four-hinge model at the same amplitudes, where the structure is an arch."""
    if not isinstance(model.assembly, ArchAssembly):
        return
    arch = ArchModel(model.assembly, context.building.joints.restitution)
    try:
        tried = np.linspace(0.1 * durations[0], 1.5 * durations[-1], 120)
        found = shortest_durations(
            arch.body, options.pulse, amplitudes, tried, settling_time(arch), 1e-4, context.threads
        )
    except (BadGeometry, Refused, CoreError) as error:
        result.warnings.append(f"no four-hinge curves beside these: {error}")
        return
    for mode, shortest in zip(("mode_I", "mode_II"), found, strict=True):
        result.arrays[mode] = Array(shortest, ("amplitude",), "s", "shortest failing duration of the four-hinge model")
        result.results[f"four_hinge_{mode}_durations_s"] = [None if np.isnan(t) else float(t) for t in shortest]
        table[f"four-hinge {mode}"] = shortest
        units[f"four-hinge {mode}"] = "s"


def _answer(results: dict, amplitudes: np.ndarray, shortest: np.ndarray) -> str:
    told = [
        f"{a / GRAVITY:.3g} g for {t:.3f} s" if np.isfinite(t) else f"{a / GRAVITY:.3g} g: none of those tried"
        for a, t in zip(amplitudes, shortest, strict=True)
    ]
    text = f"Shortest {results['pulse']} pulses that bring it down: {'; '.join(told)}."
    spread = [
        (c["label"], np.array([np.nan if t is None else t for t in c["shortest_durations_s"]]))
        for c in results["curves"][1:]
    ]
    if spread:
        with np.errstate(invalid="ignore"):
            worst = max(spread, key=lambda item: np.nanmax(np.abs(item[1] / shortest - 1.0), initial=0.0))
        change = np.nanmax(np.abs(worst[1] / shortest - 1.0), initial=0.0)
        text += f" The greatest change, {100 * change:.0f} %, comes with {worst[0]}."
    mode = results.get("four_hinge_mode_I_durations_s")
    if mode and all(t is not None for t in mode) and np.isfinite(shortest).all():
        text += f" The four-hinge model gives {', '.join(f'{t:.3f}' for t in mode)} s (after one impact)."
    return text
