"""failure-domain: which pulses bring the arch down (thesis 5.2.3, Figs 5-3 and 5-7).

Above the Mode I curve lie safe pockets, so the curve is the lowest failing amplitude: the map is scanned
first and each first failing cell refined, never bisected blindly over the whole range.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from extrados.analyses.arch_model import ArchModel
from extrados.analyses.run import Context
from extrados.core import rocking as core_rocking
from extrados.core.errors import Cancelled, CoreError, status_code
from extrados.core.rocking import Body
from extrados.decks.analyses import FailureDomain
from extrados.motions import pulses
from extrados.motions.motion import GRAVITY, Motion
from extrados.results.model import Array, Result, TableData

NO_HINGING, RECOVERY, MODE_I, MODE_II = 0, 1, 2, 3
BATCH = 4096


def unit_pulse(pulse: str, duration: float) -> Motion:
    """The pulse of 1 m/s^2, first to -x, so that the structure first rocks to +x."""
    make = pulses.step_pulse if pulse == "step" else pulses.sine_pulse
    return make(-1.0, duration)


@dataclass(frozen=True)
class Curves:
    """Lowest failing amplitudes [m/s^2] at each duration (NaN: none below the cap), and the map.

    codes (durations, amplitudes): 0 no hinging, 1 recovery, 2 Mode I, 3 Mode II.
    """

    durations: np.ndarray
    amplitudes: np.ndarray
    codes: np.ndarray
    mode_i: np.ndarray
    mode_ii: np.ndarray


class Mapper:
    """Runs pulses of many durations and amplitudes on one structure."""

    def __init__(self, body: Body, pulse: str, durations: Sequence[float], settle: float, threads: int):
        self.body = body
        self.motions = [unit_pulse(pulse, t) for t in durations]
        self.settle = settle
        self.threads = threads

    def codes(self, index: np.ndarray, amplitude: np.ndarray, tick: Callable[[int], None]) -> np.ndarray:
        """Outcome codes for pulses `index` of the given amplitudes [m/s^2]."""
        out = np.empty(len(index), dtype=int)
        grounds = [m.ground for m in self.motions]
        ends = np.array([m.end for m in self.motions]) + self.settle
        for first in range(0, len(index), BATCH):
            part = slice(first, first + BATCH)
            e = core_rocking.ensemble(
                [self.body], grounds, np.zeros(len(index[part]), dtype=int), index[part], amplitude[part],
                ends[index[part]], threads=self.threads,
            )  # fmt: skip
            if e.interrupted:
                raise Cancelled(status_code("cancelled"), "failure domain interrupted")
            if e.failed:
                raise CoreError(0, f"failure domain: {next(iter(e.failed.values()))}")
            collapse = e.outcome == 2
            out[part] = np.where(collapse, np.where(e.half_cycles == 1, MODE_II, MODE_I), np.minimum(e.outcome, 1))
            tick(len(index[part]))
        return out


def failure_curves(
    mapper: Mapper,
    durations: np.ndarray,
    amplitudes: np.ndarray,
    accuracy: float,
    tick: Callable[[int], None] = lambda n: None,
) -> Curves:
    """Map and curves; `accuracy` [m/s^2] of the lowest failing amplitudes within their cell of the map."""
    nd, na = len(durations), len(amplitudes)
    grid = np.repeat(np.arange(nd), na)
    codes = mapper.codes(grid, np.tile(amplitudes, nd), tick).reshape(nd, na)
    curves = [
        _refine(
            lambda i, a: mapper.codes(i, a, tick),
            codes,
            np.broadcast_to(amplitudes, codes.shape),
            wanted,
            accuracy,
        )
        for wanted in (MODE_I, MODE_II)
    ]
    return Curves(durations, amplitudes, codes, *curves)


def shortest_durations(
    body: Body,
    pulse: str,
    amplitudes: np.ndarray,
    durations: np.ndarray,
    settle: float,
    accuracy: float,
    threads: int,
) -> tuple[np.ndarray, np.ndarray]:
    """Shortest failing duration [s] at each amplitude [m/s^2] in Mode I (or II) and in Mode II; NaN: none."""

    def codes(index: np.ndarray, length: np.ndarray) -> np.ndarray:
        mapper = Mapper(body, pulse, length.tolist(), settle, threads)
        return mapper.codes(np.arange(len(length)), amplitudes[index], lambda n: None)

    na, nd = len(amplitudes), len(durations)
    grid = np.broadcast_to(durations, (na, nd))
    scanned = codes(np.repeat(np.arange(na), nd), grid.ravel()).reshape(na, nd)
    return tuple(_refine(codes, scanned, grid, wanted, accuracy) for wanted in (MODE_I, MODE_II))


def _refine(
    codes_at: Callable[[np.ndarray, np.ndarray], np.ndarray],
    codes: np.ndarray,
    values: np.ndarray,
    wanted: int,
    accuracy: float,
) -> np.ndarray:
    """Lowest failing value of each row of a scan (codes, values ascending): its first failing cell is scanned
    again in 8 parts until it is smaller than `accuracy`. `codes_at(rows, values)` runs more pulses."""

    def fails(c: np.ndarray) -> np.ndarray:
        return c >= MODE_I if wanted == MODE_I else c == MODE_II

    failing = fails(codes)
    first = np.where(failing.any(axis=1), failing.argmax(axis=1), -1)
    index = np.flatnonzero(first >= 0)
    high = values[index, first[index]]
    low = np.where(first[index] > 0, values[index, np.maximum(first[index] - 1, 0)], 0.0)
    parts = 8
    while len(index) and float((high - low).max()) > accuracy:
        steps = np.arange(1, parts) / parts
        trial = low[:, None] + (high - low)[:, None] * steps
        again = fails(codes_at(np.repeat(index, parts - 1), trial.ravel()).reshape(trial.shape))
        hit = again.any(axis=1)
        k = again.argmax(axis=1)
        rows = np.arange(len(index))
        high = np.where(hit, trial[rows, k], high)
        before = np.where(k > 0, trial[rows, np.maximum(k - 1, 0)], low)
        low = np.where(hit, before, trial[:, -1])
    out = np.full(len(codes), np.nan)
    out[index] = high
    return out


def natural_durations(model: ArchModel, pulse: str, count: int = 40) -> np.ndarray:
    """Durations that cover the curve: from a twentieth to three times sqrt(R/g) (Eq. 5.7)."""
    unit = np.sqrt(model.arch.radius / GRAVITY)
    span = (0.1, 1.0) if pulse == "step" else (0.2, 2.4)
    return np.round(np.linspace(*span, count) * unit, 4)


def settling_time(model: ArchModel) -> float:
    """Long enough for the last half cycles after a pulse; runs stop earlier once they are safe."""
    return 40.0 * float(np.sqrt(model.arch.radius / GRAVITY))


def run(context: Context, options: FailureDomain) -> Result:
    """Map, Mode I and Mode II curves of step or sine pulses."""
    model = ArchModel(context.structure, context.deck.structure.restitution)
    context.warnings += model.warnings
    gamma = model.collapse[0].gamma
    durations = np.array(options.durations) if options.durations else natural_durations(model, options.pulse)
    amplitudes = np.linspace(0.0, options.max_amplitude, options.amplitudes + 1)[1:]
    mapper = Mapper(model.body, options.pulse, durations, settling_time(model), context.threads)
    total = len(durations) * len(amplitudes) * 1.5
    done = 0

    def tick(n: int) -> None:
        nonlocal done
        done += n
        context.progress(min(done, total), total, "failure domain")

    curves = failure_curves(mapper, durations, amplitudes, options.accuracy * GRAVITY, tick)
    result = Result("failure-domain")
    names = {"mode_I": curves.mode_i, "mode_II": curves.mode_ii}
    result.results = {
        "pulse": options.pulse,
        **{
            name: {
                "durations_s": durations,
                "amplitudes_g": [None if np.isnan(a) else a / GRAVITY for a in curve],
            }
            for name, curve in names.items()
        },
        "uplift_acceleration_g": gamma,
        "restitution": model.restitution,
        "safe_pockets": int(
            (((curves.codes < MODE_I) & (curves.amplitudes > curves.mode_i[:, None])).any(axis=1)).sum()
        ),
    }
    if options.at_amplitudes:
        at = np.array(options.at_amplitudes)
        found = shortest_durations(
            model.body, options.pulse, at, np.linspace(durations.min(), durations.max(), 200), settling_time(model),
            options.accuracy, context.threads,
        )  # fmt: skip
        result.results["at_amplitudes"] = {
            "amplitudes_g": at / GRAVITY,
            "mode_I_durations_s": [None if np.isnan(t) else t for t in found[0]],
            "mode_II_durations_s": [None if np.isnan(t) else t for t in found[1]],
        }
    result.tables["failure_domain"] = TableData(
        {
            "duration": durations,
            # Eq. 5.7: arches of other sizes and the same proportions fail at the same values of this
            "duration_over_sqrt_radius": durations / np.sqrt(model.arch.radius),
            **{f"{n}_amplitude": c / GRAVITY for n, c in names.items()},
        },
        {
            "duration": "s",
            "duration_over_sqrt_radius": "s/m^0.5",
            "mode_I_amplitude": "g",
            "mode_II_amplitude": "g",
        },
    )
    result.arrays = {
        "duration": Array(durations, ("duration",), "s", "t_p of the step pulse or T_p of the sine"),
        "amplitude": Array(amplitudes / GRAVITY, ("amplitude",), "g"),
        "outcome": Array(curves.codes, ("duration", "amplitude"), "", "0 no hinging, 1 recovery, 2 Mode I, 3 Mode II"),
        "mode_I": Array(curves.mode_i / GRAVITY, ("duration",), "g", "lowest amplitude of collapse in any half cycle"),
        "mode_II": Array(
            curves.mode_ii / GRAVITY,
            ("duration",),
            "g",
            "lowest amplitude of collapse in the first half cycle",
        ),
    }
    governing = np.nanmin(curves.mode_i) / GRAVITY if np.isfinite(curves.mode_i).any() else None
    shape = "step pulses (a_p for t_p, then -a_p/2 for 2 t_p)" if options.pulse == "step" else "single sine pulses"
    if governing is None:
        result.answer = f"None of the {shape} up to {options.max_amplitude / GRAVITY:g} g brings the arch down."
    else:
        longest = durations[np.flatnonzero(np.isfinite(curves.mode_i))[0]]
        result.answer = (
            f"Under {shape} the arch starts to hinge at {gamma:.3f} g. It comes down from {longest:.3f} s on "
            f"(at up to {options.max_amplitude / GRAVITY:g} g); over the durations tried the lowest failing amplitude is {governing:.3f} g. "
            f"Collapse after one impact (Mode I) governs where its curve lies below that of Mode II; "
            f"{result.results['safe_pockets']} of {len(durations)} durations have safe pockets above the curve, not to be relied on."
        )
    return result
