"""dem-domain: the shortest pulses that bring a structure down, by discrete elements (thesis Figs 7-11, 7-13, 7-14)."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from extrados.analyses.context import Context, Refused
from extrados.analyses.dem import measures, solid_settlement
from extrados.analyses.dem import model as dem_model
from extrados.analyses.dem.from_deck import make_model
from extrados.analyses.dem.impact_rules import ContactValues
from extrados.analyses.dem.job import Runs, SolidRuns, SolidTask, Task, answered
from extrados.analyses.dem.model import JointValues, Model
from extrados.analyses.dem.settlement import farthest_settlement
from extrados.analyses.dem.solid_model import SolidModel, make_solid_model
from extrados.analyses.dem.standing import compared
from extrados.analyses.dem.tables import DemDomain
from extrados.analyses.dem.trial import start
from extrados.analyses.needs import stones_of
from extrados.analyses.rocking.failure_domain import settling_time, shortest_durations, unit_pulse
from extrados.core import dem, dem3, dem_run
from extrados.core.errors import CoreError
from extrados.model.errors import BadGeometry
from extrados.model.geometry.assembly import Assembly
from extrados.model.structures.arch import ArchAssembly
from extrados.results import dem as out
from extrados.results.model import Array, Result, TableData
from extrados.schema.constants import GRAVITY
from extrados.views.rockers.arch import ArchModel

FAILED = ("collapse", "left")
#: Times at which a swing is looked at [s], and rotations below which bodies vibrate [rad].
SWING, VIBRATES = 0.01, 2e-3
COMPLIANT, RIGID = "springs (compliant)", "rigid contacts (nonsmooth)"
#: Number of a curve, amplitude [m/s^2], duration [s]
Pulse = tuple[int, float, float]
#: Solvers that agree in fewer cells do not confirm each other.
AGREE = 0.95


@dataclass(frozen=True)
class Curve:
    """What is asked of one set of joints and one solver."""

    label: str
    values: ContactValues
    rigid: bool = False


class Search:
    """Asks round by round which pulses (curve, amplitude, duration) bring the structure down."""

    def __init__(self, context: Context, options: DemDomain, model: Model | SolidModel, curves: list[Curve], rounds: float):
        self.context, self.options, self.model, self.curves = context, options, model, curves
        self.settle = options.settle or dem_model.settle_time(model)
        self.collapse = measures.Collapse.of(options.collapse_displacement, model.size)
        self.job = _of_section(self, model) if isinstance(model, Model) else _of_solids(self, model)
        self.asked, self.total = 0, len(curves) * len(options.amplitudes) * rounds
        self.residual, self.steps, self.effort = 0.0, 0, dem_run.NO_EFFORT

    def fails(self, pulses: list[Pulse]) -> list[bool]:
        """Whether each pulse (curve, amplitude [m/s^2], duration [s]) brings the structure down; Unfinished where
        some have no answer, Refused where one is not to be trusted."""
        return [run.reason in FAILED for run in self._runs(pulses)]

    def falls_at_once(self, pulses: list[Pulse]) -> list[bool]:
        """Of a section: whether each pulse brings it down in its first swing: no body turns back beyond where it began."""
        assert isinstance(self.model, Model)
        count = self.model.rigid.count
        return [run.reason in FAILED and _swings_once(run, count) for run in self._runs(pulses, output_step=SWING)]

    def _runs(self, pulses: list[Pulse], output_step: float = 1e3) -> list[Any]:
        runs = answered(
            self.context,
            "dem-domain",
            self.job(pulses, output_step),
            "",
            tell=lambda done: self.context.progress(min(self.asked + done, self.total), self.total, "failure domain by discrete elements"),
        )
        self.asked += len(pulses)
        for run in runs:
            dem_model.checked(run, self.model)
            self.residual = max(self.residual, run.residual)
            self.steps += run.steps
            self.effort = self.effort.with_(run.effort)
        return runs

    def convergence(self) -> out.Convergence | None:
        """Of the rigid contacts in all runs, None where there were none."""
        return measures.convergence(self.effort) if self.effort.steps else None

    def core_options(self, curve: int, end: float, output_step: float) -> dict[str, Any]:
        """What of the core's options is the same of a section and of solids; `end` of the pulse [s]."""
        return {
            "end_time": end + self.settle,
            "output_step": output_step,
            **self.collapse.options,
            "settle_damping": self.curves[curve].values.settle_damping,
            "stop_at_rest": True,
            "rigid": self.curves[curve].rigid,
            "rebound": self.options.rebound,
            "step": self.options.time_step or 0.0,
        }


def _of_section(search: Search, model: Model) -> Callable[[list[Pulse], float], Runs]:
    """Runs of a section under pulses."""
    joints = [(curve.values, curve.rigid) for curve in search.curves if isinstance(curve.values, JointValues)]
    bodies = [model.bodies(values) for values, _ in joints]
    settlement = [farthest_settlement(model, values, rigid) for values, rigid in joints]
    shift = start(search.context, model)

    def task(curve: int, amplitude: float, duration: float, output_step: float) -> Task:
        motion = unit_pulse(search.options.pulse, duration)
        given = search.core_options(curve, motion.end, output_step)
        fraction = search.options.step_fraction(space=False)
        options = dem.Options(**given, fraction=fraction, settlement=settlement[curve], mass_damping=search.options.mass_damping)
        return Task(curve, options, motion.ground, amplitude, shift)

    return lambda pulses, output_step: Runs(bodies, [task(*one, output_step) for one in pulses])


def _of_solids(search: Search, model: SolidModel) -> Callable[[list[Pulse], float], SolidRuns]:
    """Runs of solids under pulses."""
    bodies = model.bodies()
    settlement = [solid_settlement.farthest_settlement(model, curve.rigid) for curve in search.curves]

    def task(curve: int, amplitude: float, duration: float, output_step: float) -> SolidTask:
        motion = unit_pulse(search.options.pulse, duration)
        given = search.core_options(curve, motion.end, output_step)
        fraction = search.options.step_fraction(space=True)
        options = dem3.Options(**given, fraction=fraction, settlement=settlement[curve], way=search.options.way)
        return SolidTask(options, motion.ground, scale=amplitude)

    return lambda pulses, output_step: SolidRuns(bodies, [task(*one, output_step) for one in pulses])


def run(context: Context, options: DemDomain) -> Result:
    """Curves of the shortest failing durations, with their sensitivity, beside those of the four-hinge model."""
    model: Model | SolidModel
    if isinstance(stones_of(context.building, options), Assembly):
        model = make_model(context.building, options)
        context.warnings += dem_model.warnings(model, options)
        varied = _varied(options, model.values)
    else:
        model, varied = make_solid_model(context.building, options), []
        springs = not options.rigid or options.cross_check
        context.warnings += dem_model.warnings_of_solids(model, springs=springs)
    return compared(context, options.rigid, model, lambda: _found(context, options, model, varied))


def _found(context: Context, options: DemDomain, model: Model | SolidModel, varied: list[Curve]) -> Result:
    base = model.values
    curves = [Curve("as given", base, options.rigid), *varied]
    if options.cross_check:
        curves.append(Curve(COMPLIANT if options.rigid else RIGID, base, not options.rigid))
    amplitudes, durations = np.array(options.amplitudes), np.array(options.durations)
    refining = max(0.0, np.ceil(np.log2(max(float(np.diff(durations).max()), durations[0]) / options.accuracy)))
    search = Search(context, options, model, curves, len(durations) + refining)
    shortest = _shortest(search.fails, len(curves), amplitudes, durations, options.accuracy)
    at_once = _shortest(search.falls_at_once, 1, amplitudes, durations, options.accuracy)[0] if options.mode_II else None
    checked = _cross_check(search, amplitudes, durations) if options.cross_check else None
    result = Result("dem-domain")
    numbers = {
        "pulse": options.pulse,
        "direction_deg": None if isinstance(model, Model) else options.direction or 0.0,
        "amplitudes_g": amplitudes / GRAVITY,
        "shortest_durations_s": shortest[0],
        "curves": [
            out.DemCurve(
                label=c.label,
                solver="nonsmooth" if c.rigid else "compliant",
                friction=c.values.friction.max(),
                shortest_durations_s=row,
                **_springs(c),
            )
            for c, row in zip(curves, shortest, strict=True)
        ],
        "convergence": search.convergence(),
        "energy_residual_ratio": search.residual,
        "steps": search.steps,
    }
    labels = [c.label for c in curves]
    table = {"amplitude": amplitudes / GRAVITY}
    table |= {f"shortest duration, {label}": row for label, row in zip(labels, shortest, strict=True)}
    units = {"amplitude": "g", **{f"shortest duration, {label}": "s" for label in labels}}
    result.arrays = {
        "amplitude": Array(amplitudes / GRAVITY, ("amplitude",), "g"),
        "curve": Array(np.array(labels), ("curve",), "", "varied quantity"),
        "shortest": Array(np.array(shortest), ("curve", "amplitude"), "s", "shortest failing duration"),
    }
    if at_once is not None:
        numbers["mode_II_durations_s"] = at_once
        result.arrays["elements_mode_II"] = Array(
            at_once, ("amplitude",), "s", "shortest duration that causes collapse of the discrete elements in their first swing"
        )
        table["shortest duration, mode II"], units["shortest duration, mode II"] = at_once, "s"
    if checked is not None:
        numbers["cross_check"] = _agreement(checked, amplitudes, durations)
        result.arrays |= {
            "duration": Array(durations, ("duration",), "s", "durations for which both solvers calculated the map"),
            "fails": Array(
                checked,
                ("solver", "amplitude", "duration"),
                "",
                "1 if the pulse causes collapse, for each cell of the map. Solver 0: solver of the deck; solver 1: the other solver",
            ),
        }
        if numbers["cross_check"].agreement_ratio < AGREE:
            result.warnings.append(_apart(numbers["cross_check"]))
    result.warnings += dem_model.unconverged(search.effort)
    numbers |= _beside(context, options, model, amplitudes, durations, result, table, units)
    result.results = out.DemDomain(**numbers)
    result.tables["dem_domain"] = TableData(table, units)
    result.answer = _answer(result.results, amplitudes, shortest[0])
    return result


def _varied(options: DemDomain, base: JointValues) -> list[Curve]:
    """Curves with other joints."""
    return [
        *(Curve(f"damping x {f:g}", base.scaled(damping=f)) for f in options.vary_damping),
        *(Curve(f"stiffness x {f:g}", base.scaled(stiffness=f)) for f in options.vary_stiffness),
        *(Curve(f"friction {f:g}", base.scaled(friction=f), options.rigid) for f in options.vary_friction),
    ]


def _springs(curve: Curve) -> dict[str, float | None]:
    """Stiffness and damping of a curve; None of rigid contacts."""
    told: dict[str, float | None] = {"beta_s": curve.values.beta, "stiffness_Pa_per_m": float(curve.values.stiffness.max())}
    told |= {f"damping_ratio_{name}": ratio for name, ratio in curve.values.ratios().items()}
    return dict.fromkeys(told) if curve.rigid else told


def _cross_check(search: Search, amplitudes: np.ndarray, durations: np.ndarray) -> np.ndarray:
    """Whether each cell (solver, amplitude, duration) fails: by the solver of the deck, then by the other."""
    curves = (0, len(search.curves) - 1)
    cells = [(curve, float(a), float(t)) for curve in curves for a in amplitudes for t in durations]
    return np.reshape(search.fails(cells), (2, len(amplitudes), len(durations))).astype(int)


def _agreement(fails: np.ndarray, amplitudes: np.ndarray, durations: np.ndarray) -> out.CrossCheck:
    """In how many cells two maps agree, and where they do not."""
    apart = fails[0] != fails[1]
    return out.CrossCheck(
        cells=apart.size,
        agreement_ratio=float(1.0 - apart.mean()),
        apart=[
            out.CellApart(
                amplitude_g=float(amplitudes[i] / GRAVITY),
                duration_s=float(durations[k]),
                fails_as_given=bool(fails[0, i, k]),
                fails_by_the_other=bool(fails[1, i, k]),
            )
            for i, k in np.argwhere(apart)
        ],
    )


def _apart(check: out.CrossCheck) -> str:
    """Where the two solvers do not agree, in words."""
    where = "; ".join(
        (
            f"under a pulse of {c.amplitude_g:.3g} g and {c.duration_s:.3g} s "
            f"the structure {('collapses' if c.fails_as_given else 'stands')} with the solver of the deck, "
            f"and {('collapses' if c.fails_by_the_other else 'stands')} with the other solver"
        )
        for c in check.apart[:8]
    )
    return f"the two solvers agree in only {100 * check.agreement_ratio:.0f} % of {check.cells} cells: {where}"


def _swings_once(run: dem.Run, count: int) -> bool:
    """Does each of the bodies 0 to count - 1 turn to one side only until it falls? Vibrations do not count."""
    turn = run.place[:, :count, 2] - run.settled[:count, 2]
    side = np.sign(turn[-1])
    return bool((turn * side).min() > -VIBRATES)


def _shortest(
    fails: Callable[[list[Pulse]], list[bool]], curves: int, amplitudes: np.ndarray, durations: np.ndarray, accuracy: float
) -> np.ndarray:
    """Shortest failing duration (curves, amplitudes): the first failing one of those tried, refined by bisection.

    Above the first failing duration there are safe pockets (as for single blocks), so the durations are scanned
    upward and only the cell below the first failure is bisected.
    """
    rows = [(k, float(a)) for k in range(curves) for a in amplitudes]
    low, high = np.zeros(len(rows)), np.full(len(rows), np.nan)
    open_rows = list(range(len(rows)))
    for duration in durations:
        found = fails([(*rows[r], float(duration)) for r in open_rows]) if open_rows else []
        for r, failed in zip(open_rows, found, strict=True):
            if failed:
                high[r] = duration
            else:
                low[r] = duration
        open_rows = [r for r, failed in zip(open_rows, found, strict=True) if not failed]
    while True:
        wide = [
            r
            for r in range(len(rows))
            # as fine as numbers are where the middle is one of the ends
            if np.isfinite(high[r]) and high[r] - low[r] > accuracy and low[r] < 0.5 * (low[r] + high[r]) < high[r]
        ]
        if not wide:
            return high.reshape(curves, len(amplitudes))
        found = fails([(*rows[r], float(0.5 * (low[r] + high[r]))) for r in wide])
        for r, failed in zip(wide, found, strict=True):
            middle = 0.5 * (low[r] + high[r])
            if failed:
                high[r] = middle
            else:
                low[r] = middle


def _beside(
    context: Context,
    options: DemDomain,
    model: Model | SolidModel,
    amplitudes: np.ndarray,
    durations: np.ndarray,
    result: Result,
    table: dict,
    units: dict,
) -> dict[str, np.ndarray]:
    """Shortest failing durations of the four-hinge model at the same amplitudes, where the structure is an arch: their
    keys; arrays and columns go to `result` and `table`."""
    if not isinstance(model.assembly, ArchAssembly):
        return {}
    arch = ArchModel(model.assembly, context.building.joints.restitution)
    try:
        tried = np.linspace(0.1 * durations[0], 1.5 * durations[-1], 120)
        found = shortest_durations(arch.body, options.pulse, amplitudes, tried, settling_time(arch), 1e-4, context.threads, context)
    except (BadGeometry, Refused, CoreError) as error:
        result.warnings.append(f"the curves of the four-hinge model, which serve for comparison, are not given: {error}")
        return {}
    for mode, shortest in zip(("mode_I", "mode_II"), found, strict=True):
        result.arrays[mode] = Array(shortest, ("amplitude",), "s", "shortest duration that causes collapse of the four-hinge model")
        table[f"four-hinge {mode}"] = shortest
        units[f"four-hinge {mode}"] = "s"
    return {"four_hinge_mode_I_durations_s": found[0], "four_hinge_mode_II_durations_s": found[1]}


def _answer(r: out.DemDomain, amplitudes: np.ndarray, shortest: np.ndarray) -> str:
    told = [
        f"{a / GRAVITY:.3g} g for {t:.3f} s" if np.isfinite(t) else f"{a / GRAVITY:.3g} g: none of the durations tried"
        for a, t in zip(amplitudes, shortest, strict=True)
    ]
    text = f"The shortest {r.pulse} pulses that cause collapse are: {'; '.join(told)}."
    spread = [
        (c.label, np.array([np.nan if t is None else t for t in c.shortest_durations_s]))
        for c in r.curves[1:]
        if c.solver == r.curves[0].solver
    ]
    if spread:
        with np.errstate(invalid="ignore"):
            worst = max(spread, key=lambda item: np.nanmax(np.abs(item[1] / shortest - 1.0), initial=0.0))
        change = np.nanmax(np.abs(worst[1] / shortest - 1.0), initial=0.0)
        text += f" The varied parameters change these durations by up to {100 * change:.0f} % ({worst[0]})."
    if r.cross_check is not None:
        other = [f"{t:.3f}" if t is not None else "none" for t in r.curves[-1].shortest_durations_s]
        text += (
            f" With {r.curves[-1].label}, the durations are {', '.join(other)} s; both solvers agree in {100 * r.cross_check.agreement_ratio:.0f} "
            f"% of {r.cross_check.cells} cells."
        )
    mode = r.four_hinge_mode_I_durations_s
    if mode and all(t is not None for t in mode) and np.isfinite(shortest).all():
        text += f" The four-hinge model gives {', '.join(f'{t:.3f}' for t in mode)} s (collapse after one impact)."
    return text
