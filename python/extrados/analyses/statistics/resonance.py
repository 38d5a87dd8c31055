"""resonance: the motion under a cap that feeds most energy to a rocking structure (thesis 6.2, Figs 6-2 to 6-4)."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from extrados.analyses.context import Context
from extrados.analyses.rocking.common import rocker_of
from extrados.analyses.rocking.conditions import of_one, told
from extrados.analyses.statistics.tables import Resonance
from extrados.core import rocking as core_rocking
from extrados.core.rocking import Ground
from extrados.model.structures.block import make_block
from extrados.results import statistics as out
from extrados.results.model import Array, Result, TableData
from extrados.schema.constants import GRAVITY
from extrados.views.rockers.block import BlockModel
from extrados.views.rockers.rocker import Rocker

#: Axes of Fig. 6-3
ASPECTS = np.linspace(0.05, 0.6, 12)
INITIAL = np.array([0.02, 0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9])
#: Axes of Fig. 6-4: impulse periods and start times over T_n, initial rotations over theta_cr
IMPULSE_PERIODS = (0.125, 0.25, 0.5, 1.0, 2.0)
INITIAL_ROTATIONS = (1.0 / 16.0, 1.0 / 8.0, 1.0 / 4.0, 1.0 / 2.0)
START = 0.1  # of the critical rotation, where the deck names none
STARTS = np.linspace(0.0, 1.0, 49)


@dataclass(frozen=True)
class Optimum:
    """The optimal motion: it changes sign at `switches` [s], where the rotation turns; peaks [rad] at those times."""

    ground: Ground
    switches: np.ndarray
    peaks: np.ndarray
    response: core_rocking.Response


def steps(cap: float, switches: list[float], end: float, first_sign: float) -> Ground:
    """Acceleration +-cap [m/s^2] that changes sign at the switches [s]."""
    breaks = np.array([0.0, *switches, end])
    sign = first_sign * (-1.0) ** np.arange(len(breaks) - 1)
    linear = np.zeros((len(sign), 1, 2))
    linear[:, 0, 0] = cap * sign
    return Ground(breaks=breaks, linear=linear, harmonic=np.zeros((len(sign), 1, 0, 4)))


def optimal_motion(model: Rocker, cap: float, ratio: float, half_cycles: int) -> Optimum:
    """Greatest energy input under |a| <= cap: full cap against the rate at every instant (Eq. 6.5).

    The sign then changes only where the rate does, at the turning points: each is found by running on under
    the last sign, so the integrator of all other analyses finds them. Starts at rest at +ratio of the critical rotation.
    """
    start = ratio * model.critical[0]
    horizon = 60.0 * model.time_unit
    switches: list[float] = []
    peaks = [start]
    sign = 1.0  # falling back from a positive rotation: the rate is negative, the ground pushes to +x
    while True:
        end = (switches[-1] if switches else 0.0) + horizon
        ground = steps(cap, switches, end, sign)
        r = core_rocking.history(model.body, ground, end, horizon / 2000.0, start_rotation=start, room=4 * half_cycles + 64)
        turns = [(t, x) for kind, t, x in r.events if kind == "peak" and t > (switches[-1] if switches else 0.0) + 1e-9]
        if (r.outcome == "collapse" and not turns) or not turns or len(switches) >= half_cycles:
            return Optimum(ground, np.array(switches), np.array(peaks), r)
        switches.append(turns[0][0])
        peaks.append(turns[0][1])


def least_cap(model: BlockModel, ratio: np.ndarray | float) -> np.ndarray:
    """Least |a| [g] whose optimal motion lets the rotation grow from `ratio` of the critical one.

    Over a half cycle from the turning point theta the ground adds a G(theta) going down and a G(theta') going up,
    G = int H dq; of the kinetic energy the impact leaves c_E. Growth (theta' > theta) needs
    a > (1 - c_E)/(1 + c_E) V(theta)/G(theta). A rectangle with equal toes.
    """
    b = model.block
    alpha, moment = float(b.alpha[0]), float(b.mass[0] * b.radius[0])
    c_e = float(model.restitution[0]) ** 2
    q = np.asarray(ratio) * alpha
    if model.linear:
        v, g = GRAVITY * moment * q * (alpha - 0.5 * q), moment * q
    else:
        v = GRAVITY * moment * (np.cos(alpha - q) - np.cos(alpha))
        g = moment * (np.sin(alpha) - np.sin(alpha - q))
    return (1.0 - c_e) / (1.0 + c_e) * v / g / GRAVITY


def half_cycles_to_collapse(model: BlockModel, ratio: float, cap: float, most: int = 1000) -> int:
    """Half cycles (each with an impact) of the optimal motion until the block overturns, by energies alone; 0: never.

    cap [g]; nonlinear form, equal toes.
    """
    b = model.block
    alpha, c_e = float(b.alpha[0]), float(model.restitution[0]) ** 2
    push = np.arctan(cap)
    # V +- a G over m R sqrt(g^2 + a^2): cosines about the tilted vertical
    barrier = 1.0 - np.cos(alpha - push)
    q = ratio * alpha
    for n in range(1, most + 1):
        energy = c_e * (np.cos(alpha - q + push) - np.cos(alpha + push))
        if energy >= barrier:
            return n
        new = alpha - push - np.arccos(energy + np.cos(alpha - push))
        if new <= q:
            return 0
        q = new
    return 0


def cap_for_collapse_within(model: BlockModel, ratio: float, half_cycles: int) -> float:
    """Least cap [g] that overturns the block within so many half cycles."""
    low, high = 0.0, float(model.uplift[0]) * 1.5
    while high - low > 1e-9:
        middle = 0.5 * (low + high)
        n = half_cycles_to_collapse(model, ratio, middle, half_cycles)
        low, high = (low, middle) if n else (middle, high)
    return high


def run(context: Context, options: Resonance) -> Result:
    """Fig. 6-2 for a block or an arch; Figs 6-3 and 6-4 for a block."""
    model = rocker_of(context, options)
    cap = options.cap or _default_cap(context, model)
    optimum = optimal_motion(model, cap, _start(context), options.half_cycles)
    r = optimum.response
    result = Result("resonance")
    spacing = np.diff(optimum.switches)
    collapse = r.outcome == "collapse"
    numbers: dict[str, Any] = {
        "outcome": r.outcome,
        "cap_g": cap / GRAVITY,
        "cap_ratio": cap / GRAVITY / model.uplift,
        "uplift_acceleration_g": model.uplift,
        "initial_rotation_ratio": _start(context),
        "half_cycles": len(optimum.switches),
        "collapse_time_s": r.stop_time if collapse else None,
        "switch_times_s": optimum.switches,
        "switch_spacing_s": spacing,
        "peak_rotation_rad": optimum.peaks,
        "energy_supplied_J": r.work,
        "energy_lost_at_impacts_J": r.loss,
        "restitution": model.restitution,
        "conditions": of_one(model, r),
    }
    keep = slice(None, None, max(1, len(r.time) // 20000))
    result.arrays = {
        "time": Array(r.time[keep], ("time",), "s"),
        "rotation": Array(r.rotation[keep], ("time",), "rad"),
        "ground": Array(r.ground[keep], ("time",), "m/s^2"),
        "ledger": Array(r.ledger[keep], ("time",), "J", "work done by the ground motion, minus the energy lost at impacts"),
    }
    result.tables["resonance"] = TableData(
        {"switch": optimum.switches, "peak_rotation": np.abs(optimum.peaks[1:])}, {"switch": "s", "peak_rotation": "rad"}
    )
    fate = (
        f"overturned after {len(optimum.switches)} half cycles, at {r.stop_time:.2f} s"
        if collapse
        else (
            f"not overturned within {len(optimum.switches)} half cycles (greatest rotation "
            f"{abs(optimum.peaks).max() / model.critical[0]:.2f} times the critical rotation)"
        )
    )
    result.answer = (
        f"The ground acceleration is +-{cap / GRAVITY:.3f} g ({cap / GRAVITY / model.uplift:.2f} times the uplift "
        f"acceleration), always against the motion of the {model.word}. Starting from {_start(context):g} "
        f"times the critical rotation, the {model.word} is {fate}"
    ) + (
        f"; the time between the changes of sign is {spacing[0]:.2f} s at first and {spacing[-1]:.2f} s at last."
        if len(spacing) > 1
        else "."
    )
    if isinstance(model.model, BlockModel):
        numbers |= _block_figures(context, options, model, result)
    found = out.Resonance(**numbers)
    result.results = found
    result.warnings += told(found.conditions)
    return result


def _start(context: Context) -> float:
    """Rotation over the critical one from which the motion starts; a block at rest gains nothing."""
    return abs(context.building.initial.rotation_ratio) or START


def _default_cap(context: Context, model: Rocker) -> float:
    """A little above the least cap, so that the growth is seen; half of uplift where that is not known."""
    if not isinstance(model.model, BlockModel):
        return 0.5 * model.uplift * GRAVITY
    return 1.1 * float(least_cap(model.model, _start(context))) * GRAVITY


def _block_figures(context: Context, options: Resonance, model: Rocker, result: Result) -> dict[str, Any]:
    """Arrays and tables of Figs 6-3 and 6-4 into `result`, a sentence to its answer; the results of a block alone."""
    own = model.model
    assert isinstance(own, BlockModel)
    linear = own.linear
    table = np.array(
        [
            least_cap(BlockModel(make_block(aspect, 1.0), own.rule, own.energy_ratio, linear), INITIAL)
            / (np.arctan(aspect) if linear else aspect)
            for aspect in ASPECTS
        ]
    )
    least = float(least_cap(own, _start(context))) if own.block.toe_right == own.block.toe_left else None
    numbers: dict[str, Any] = {}
    if least is not None and not linear:
        numbers["cap_ratio_for_collapse_within"] = {
            str(n): cap_for_collapse_within(own, _start(context), n) / model.uplift for n in (1, 2, 3, 5, 10)
        }
    numbers |= {
        "least_cap_g": least,
        "least_cap_ratio": None if least is None else least / model.uplift,
        "least_cap_ratios": table,
        "aspects": ASPECTS,
        "initial_ratios": INITIAL,
    }
    result.tables["least_cap"] = TableData(
        {"aspect": np.repeat(ASPECTS, len(INITIAL)), "initial_ratio": np.tile(INITIAL, len(ASPECTS)), "cap_ratio": table.ravel()}
    )
    amplitude = options.impulse_amplitude or 0.5 * model.uplift * GRAVITY
    by_period = np.array([[_energy_change(own, model, 0.25, amplitude, tp, s) for s in STARTS] for tp in IMPULSE_PERIODS])
    by_rotation = np.array([[_energy_change(own, model, x, amplitude, 0.5, s) for s in STARTS] for x in INITIAL_ROTATIONS])
    result.arrays |= {
        "aspect": Array(ASPECTS, ("aspect",), "", "B/H"),
        "initial_ratio": Array(INITIAL, ("initial_ratio",), "", "initial rotation divided by the critical rotation"),
        "least_cap_ratio": Array(
            table,
            ("aspect", "initial_ratio"),
            "",
            "least cap of the ground acceleration with which the rotation grows, divided by the uplift acceleration",
        ),
        "impulse_period_ratio": Array(np.array(IMPULSE_PERIODS), ("impulse_period_ratio",), "", "T_p/T_n"),
        "impulse_rotation": Array(
            np.array(INITIAL_ROTATIONS), ("impulse_rotation",), "", "initial rotation divided by the critical rotation"
        ),
        "impulse_start": Array(STARTS, ("impulse_start",), "", "t_start/T_n"),
        "energy_by_period": Array(
            by_period,
            ("impulse_period_ratio", "impulse_start"),
            "",
            "energy supplied by the impulse, divided by the initial energy; initial rotation: a quarter of the critical rotation",
        ),
        "energy_by_rotation": Array(
            by_rotation,
            ("impulse_rotation", "impulse_start"),
            "",
            "energy supplied by an impulse of half the natural period (T_p = T_n/2), divided by the initial energy",
        ),
    }
    numbers |= {
        "impulse_amplitude_g": amplitude / GRAVITY,
        "share_of_starts_that_add": {f"{tp:g}": float((row > 0.0).mean()) for tp, row in zip(IMPULSE_PERIODS, by_period, strict=True)},
    }
    if least is not None:
        result.answer += (
            f" From this start, any cap of the ground acceleration above {least:.3f} g ({least / model.uplift:.2f} times "
            f"the uplift acceleration) makes the rotation grow until the {model.word} overturns."
        )
    return numbers


def natural_period(model: BlockModel, ratio: float) -> float:
    """T_n of free rocking at the rotation `ratio` alpha, without loss: 4/p acosh(1/(1 - ratio)) (Housner 1963) [s]."""
    return 4.0 / float(model.frequency[0]) * float(np.arccosh(1.0 / (1.0 - ratio)))


def _energy_change(own: BlockModel, model: Rocker, ratio: float, amplitude: float, period_ratio: float, start_ratio: float) -> float:
    """Energy that one sine impulse supplies to free rocking from `ratio` alpha, over the initial energy (Fig. 6-4).

    Period and start of the impulse over T_n. Losses at impacts are not counted: they happen without it too.
    """
    t_n = natural_period(own, ratio)
    period, start = period_ratio * t_n, start_ratio * t_n
    begin = max(start, 1e-9)
    ground = Ground(
        breaks=np.array([0.0, begin, begin + period]),
        linear=np.zeros((2, 1, 2)),
        harmonic=np.array([[[[0.0, 0.0, 0.0, 0.0]]], [[[amplitude, 0.0, 2.0 * np.pi / period, 0.0]]]]),
    )
    r = core_rocking.history(model.body, ground, begin + period, begin + period, start_rotation=ratio * model.critical[0])
    alpha = own.alpha[0]
    q = ratio * alpha
    moment = GRAVITY * own.block.mass[0] * own.block.radius[0]
    energy = moment * (q * (alpha - 0.5 * q) if own.linear else np.cos(alpha - q) - np.cos(alpha))
    return float(r.work / energy)
