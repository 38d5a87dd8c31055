"""failure-domain: which pulses bring the arch down (thesis 5.2.3, Figs 5-3 and 5-7).

Above the Mode I curve lie safe pockets, so the curve is the lowest failing amplitude: the map is scanned
first and each first failing cell refined, never bisected blindly over the whole range.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from extrados.analyses.batches import Swept, computed, sweep
from extrados.analyses.context import Context
from extrados.analyses.rocking.common import rocker_of
from extrados.analyses.rocking.conditions import ROWS, Counted, astray_of, of_many, told
from extrados.analyses.rocking.doubts import DIFFER
from extrados.analyses.rocking.hand_over import STEPS, decide_cells
from extrados.analyses.rocking.job import RunsJob, runs_job
from extrados.analyses.rocking.tables import FailureDomain
from extrados.core.calls import interruptible
from extrados.core.rocking import Body
from extrados.motions import pulses
from extrados.motions.motion import Motion
from extrados.results import rocking as out
from extrados.results.fields import Keys, given
from extrados.results.model import Array, Result, TableData
from extrados.results.rocking import COLLAPSE, RECOVERY, SLID
from extrados.schema.constants import GRAVITY
from extrados.views.rockers.arch import ArchModel
from extrados.views.rockers.rocker import Rocker
from extrados.views.rockers.soft_base import SoftBaseModel

#: Codes of the map: those of the outcomes, with collapse told apart by its mode
MODE_I, MODE_II = COLLAPSE, COLLAPSE + 1
BATCH = 4096
#: Amplitudes that are tried at a time where only the lowest failing one is asked for
SCAN = 16


#: What the deck calls the duration of each pulse, and how many of it span the natural range of the curve
SPANS = {
    "step": ("t_p", 1.0),
    "sine": ("T_p", 2.4),
    "half-sine": ("T_p", 4.0),
    "rectangular": ("t_p", 2.0),
    "cosine": ("T_p", 2.4),
    "ricker": ("T_p", 2.4),
}


def unit_pulse(pulse: str, duration: float, cycles: int = 1) -> Motion:
    """The pulse of 1 m/s^2, first to -x, so that the structure first rocks to +x; of a sine so many cycles."""
    if cycles > 1:
        return pulses.harmonic(-1.0, 1.0 / duration, cycles * duration)
    if pulse == "step":
        return pulses.step_pulse(-1.0, duration)
    if pulse == "sine":
        return pulses.sine_pulse(-1.0, duration)
    return pulses.pulse(pulse, -1.0, duration)


@dataclass(frozen=True)
class Curves:
    """Lowest failing amplitudes [m/s^2] at each duration (NaN: none below the cap), and the map; pocket: where
    the first safe pocket above the curve begins (NaN: none).

    codes (durations, amplitudes): 0 no hinging, 1 recovery, 2 Mode I, 3 Mode II; rows (durations, amplitudes): see Mapper.rows.
    handed (durations, amplitudes): cells that rigid contacts decided; a curve next to one is known to a cell of the map only.
    slid (durations, amplitudes): those of them in which blocks only slide, which count as recovery in `codes`.
    """

    durations: np.ndarray
    amplitudes: np.ndarray
    codes: np.ndarray
    mode_i: np.ndarray
    mode_ii: np.ndarray
    pocket: np.ndarray
    rows: dict[str, np.ndarray]
    handed: np.ndarray
    slid: np.ndarray


def codes_of(outcome: np.ndarray, half_cycles: np.ndarray) -> np.ndarray:
    """Outcome codes of the map."""
    return np.where(outcome == COLLAPSE, np.where(half_cycles == 1, MODE_II, MODE_I), outcome).astype(int)


class Mapper:
    """Runs pulses of many durations and amplitudes on one structure; with a context through the batch layer."""

    def __init__(
        self,
        body: Body,
        pulse: str,
        durations: Sequence[float] | np.ndarray,
        settle: float,
        threads: int,
        start_rotation: float = 0.0,
        context: Context | None = None,
        cycles: int = 1,
        astray: float = 0.0,
    ):
        self.astray = astray
        self.body = body
        self.context = context
        self.motions = [unit_pulse(pulse, t, cycles) for t in durations]
        self.settle = settle
        self.threads = threads
        self.start_rotation = start_rotation

    def job(self, index: np.ndarray, amplitude: np.ndarray) -> RunsJob:
        """Pulses `index` of the given amplitudes [m/s^2]."""
        ends = np.array([m.end for m in self.motions]) + self.settle
        return runs_job(
            [self.body], [m.ground for m in self.motions], 0, index, amplitude, ends[index], self.start_rotation, astray=self.astray
        )

    def rows(self, index: np.ndarray, amplitude: np.ndarray) -> dict[str, np.ndarray]:
        """Outcome codes, `code`, and what was demanded of the joints (rocking.conditions) for pulses `index` of the given
        amplitudes [m/s^2]; Unfinished where some are missing."""
        job = self.job(index, amplitude)
        found: Sequence[Swept | dict[str, np.ndarray]]
        if self.context is not None:
            found = [sweep(self.context, "failure-domain", job, len(index), "failure domain").whole()]
        else:
            starts = range(0, len(index), BATCH)
            found = [job.run(first, min(BATCH, len(index) - first), self.threads) for first in starts]
        rows = {name: np.concatenate([part[name] for part in found]) for name in ("outcome", "half_cycles", *ROWS)}
        return {**rows, "code": codes_of(rows["outcome"], rows["half_cycles"])}

    def codes(self, index: np.ndarray, amplitude: np.ndarray) -> np.ndarray:
        """Outcome codes alone."""
        return self.rows(index, amplitude)["code"]


def failure_curves(
    mapper: Mapper,
    durations: np.ndarray,
    amplitudes: np.ndarray,
    accuracy: float,
    decided: Callable[[np.ndarray, np.ndarray], np.ndarray] | None = None,
) -> Curves:
    """Map and curves; `accuracy` [m/s^2] of the lowest failing amplitudes within their cell of the map. decided: outcomes by rigid
    contacts of pulses (numbers of durations, amplitudes [m/s^2]) whose mechanism a condition leaves."""
    nd, na = len(durations), len(amplitudes)
    rows = mapper.rows(np.repeat(np.arange(nd), na), np.tile(amplitudes, nd))
    rows = {name: values.reshape(nd, na) for name, values in rows.items()}
    codes = rows["code"]
    grid = np.broadcast_to(amplitudes, codes.shape)
    handed, slid = np.zeros((2, *codes.shape), dtype=bool)
    if decided is not None:
        handed = (rows["slips"] > 0) | (rows["strays"] > 0)
        place, _ = np.nonzero(handed)
        found = decided(place, grid[handed])
        known = found >= 0
        slid[handed], found = found == SLID, np.where(found == SLID, RECOVERY, found)
        # contacts have no half cycles: a collapse keeps the mode of fixed hinges, and is of Mode I where these stand
        codes[handed] = np.where(known, np.where(found == COLLAPSE, np.maximum(codes[handed], MODE_I), found), codes[handed])
        handed[handed] = known
    within = np.where(handed.any(axis=1), np.inf, accuracy)
    mode_i, mode_ii = (_refine(mapper.codes, codes, grid, wanted, within) for wanted in (MODE_I, MODE_II))
    # The pocket is the first safe amplitude above a failing one: the same search with the roles exchanged.
    risen = np.where((codes < MODE_I) & (np.cumsum(codes >= MODE_I, axis=1) > 0), MODE_I, RECOVERY)

    def safe(index: np.ndarray, amplitude: np.ndarray) -> np.ndarray:
        return np.where(mapper.codes(index, amplitude) < MODE_I, MODE_I, RECOVERY)

    return Curves(durations, amplitudes, codes, mode_i, mode_ii, _refine(safe, risen, grid, MODE_I, within), rows, handed, slid)


@dataclass(frozen=True)
class LowestAmplitudes:
    """Member k: the lowest amplitude [m/s^2] of a pulse of durations[k] [s] that brings a structure down; NaN: none.

    It lies in the first failing cell of `amplitudes` (ascending), and is known to `accuracy`.
    """

    body: Body
    pulse: str
    durations: np.ndarray
    amplitudes: np.ndarray
    settle: float
    accuracy: float
    start_rotation: float = 0.0
    cycles: int = 1
    astray: float = 0.0

    def run(self, first: int, count: int, threads: int) -> dict[str, np.ndarray]:
        lengths = self.durations[first : first + count].tolist()
        mapper = Mapper(self.body, self.pulse, lengths, self.settle, threads, self.start_rotation, cycles=self.cycles, astray=self.astray)
        scanned = np.zeros((count, len(self.amplitudes)), dtype=int)
        kept = {name: np.zeros(scanned.shape) for name in ROWS}
        rows = np.arange(count)
        for begin in range(0, len(self.amplitudes), SCAN):
            some = self.amplitudes[begin : begin + SCAN]
            found = mapper.rows(np.repeat(rows, len(some)), np.tile(some, len(rows)))
            codes = found["code"].reshape(len(rows), len(some))
            scanned[rows, begin : begin + SCAN] = codes
            for name in ROWS:
                kept[name][rows, begin : begin + SCAN] = found[name].reshape(codes.shape)
            rows = rows[(codes < MODE_I).all(axis=1)]
            if not len(rows):
                break
        grid = np.broadcast_to(self.amplitudes, scanned.shape)
        return {
            "amplitude": _refine(mapper.codes, scanned, grid, MODE_I, self.accuracy),
            "slides_from": first_of(kept["slips"], self.amplitudes),
            "strays_from": first_of(kept["strays"], self.amplitudes),
            "friction": kept["friction"].max(axis=1),
        }


def first_of(holds: np.ndarray, amplitudes: np.ndarray) -> np.ndarray:
    """The first amplitude in each row (rows, amplitudes) at which something holds; NaN: at none."""
    return np.where((holds > 0).any(axis=1), amplitudes[(holds > 0).argmax(axis=1)], np.nan)


@dataclass(frozen=True)
class ShortestDurations:
    """Member k: the shortest pulse [s] of amplitudes[k] [m/s^2] that fails in Mode I (or II), and in Mode II; NaN: none.

    It lies in the first failing cell of `durations` (ascending), and is known to `accuracy` [s].
    """

    body: Body
    pulse: str
    amplitudes: np.ndarray
    durations: np.ndarray
    settle: float
    accuracy: float
    start_rotation: float = 0.0

    def run(self, first: int, count: int, threads: int) -> dict[str, np.ndarray]:
        def codes(index: np.ndarray, length: np.ndarray) -> np.ndarray:
            mapper = Mapper(self.body, self.pulse, length.tolist(), self.settle, threads, self.start_rotation)
            return mapper.codes(np.arange(len(length)), self.amplitudes[first + index])

        tried = len(self.durations)
        grid = np.broadcast_to(self.durations, (count, tried))
        scanned = codes(np.repeat(np.arange(count), tried), grid.ravel()).reshape(count, tried)
        modes = {"mode_I": MODE_I, "mode_II": MODE_II}
        return {name: _refine(codes, scanned, grid, wanted, self.accuracy) for name, wanted in modes.items()}


def shortest_durations(
    body: Body,
    pulse: str,
    amplitudes: np.ndarray,
    durations: np.ndarray,
    settle: float,
    accuracy: float,
    threads: int,
    context: Context | None = None,
    start_rotation: float = 0.0,
) -> tuple[np.ndarray, np.ndarray]:
    """Shortest failing duration [s] at each amplitude [m/s^2] in Mode I (or II) and in Mode II; NaN: none.

    With a context through the batch layer: Unfinished where some are missing.
    """
    job = ShortestDurations(body, pulse, amplitudes, durations, settle, accuracy, start_rotation)
    found = computed(context, "shortest-durations", job, len(amplitudes), "shortest failing pulses", threads, slow=True)
    return found["mode_I"], found["mode_II"]


def _refine(
    codes_at: Callable[[np.ndarray, np.ndarray], np.ndarray],
    codes: np.ndarray,
    values: np.ndarray,
    wanted: int,
    accuracy: float | np.ndarray,
) -> np.ndarray:
    """Lowest failing value of each row of a scan (codes, values ascending): its first failing cell is scanned
    again in 8 parts until it is smaller than `accuracy` (of all, or of each row), whatever the other rows need. `codes_at(rows, values)` runs
    more pulses."""

    def fails(c: np.ndarray) -> np.ndarray:
        return c >= MODE_I if wanted == MODE_I else c == MODE_II

    failing = fails(codes)
    first = np.where(failing.any(axis=1), failing.argmax(axis=1), -1)
    index = np.flatnonzero(first >= 0)
    high = values[index, first[index]]
    low = np.where(first[index] > 0, values[index, np.maximum(first[index] - 1, 0)], 0.0)
    within = np.broadcast_to(accuracy, len(codes))[index]
    parts = 8
    while len(wide := np.flatnonzero(high - low > within)):
        steps = np.arange(1, parts) / parts
        trial = low[wide, None] + (high - low)[wide, None] * steps
        again = fails(codes_at(np.repeat(index[wide], parts - 1), trial.ravel()).reshape(trial.shape))
        hit = again.any(axis=1)
        k = again.argmax(axis=1)
        rows = np.arange(len(wide))
        before = np.where(k > 0, trial[rows, np.maximum(k - 1, 0)], low[wide])
        high[wide] = np.where(hit, trial[rows, k], high[wide])
        low[wide] = np.where(hit, before, trial[:, -1])
    out = np.full(len(codes), np.nan)
    out[index] = high
    return out


def natural_durations(time_unit: float, pulse: str, count: int = 40) -> np.ndarray:
    """Durations that cover the curve of a structure whose natural time is `time_unit` [s] (Eq. 5.7)."""
    high = SPANS[pulse][1]
    return np.round(np.linspace(0.1 * high, high, count) * time_unit, 4)


def natural_time(model: ArchModel) -> float:
    """sqrt(R/g), by which the curves of arches scale (Eq. 5.7) [s]."""
    return float(np.sqrt(model.arch.radius / GRAVITY))


def settling_time(model: ArchModel) -> float:
    """Long enough for the last half cycles after a pulse; runs stop earlier once they are safe."""
    return 40.0 * natural_time(model)


def run(context: Context, options: FailureDomain) -> Result:
    """Map, Mode I and Mode II curves of pulses on an arch or a block."""
    model = rocker_of(context, options)
    # The arch keeps sqrt(R/g); a block has 1/p, and its curves span omega/p from about 1 to 12.
    unit = float(np.sqrt(model.scale / GRAVITY))
    durations = np.array(options.durations) if options.durations else natural_durations(unit, options.pulse)
    amplitudes = np.linspace(0.0, options.max_amplitude, options.amplitudes + 1)[1:]
    mapper = Mapper(
        model.body, options.pulse, durations, 40.0 * unit, context.threads, model.start_rotation, context, astray=astray_of(model)
    )
    with interruptible():  # Ctrl-C between two rounds stops the next one
        decided = _by_contacts(context, options, model, mapper)
        curves = failure_curves(mapper, durations, amplitudes, options.accuracy * GRAVITY, decided)
    result = Result("failure-domain")
    names = {"mode_I": curves.mode_i, "mode_II": curves.mode_ii}
    conditions, handed = _conditions(model, curves)
    gamma, slender = model.unit_acceleration, model.what != "arch"
    r = out.FailureDomain(
        pulse=options.pulse,
        **given(
            **{
                name: out.ModeCurve(
                    durations_s=durations.tolist(),
                    amplitudes_g=(curve / GRAVITY).tolist(),
                    **given(amplitude_ratios=curve / GRAVITY / gamma if slender else None),
                )
                for name, curve in names.items()
            }
        ),
        pocket_begins_g=(curves.pocket / GRAVITY).tolist(),
        sliding_from_g=(first_of(curves.rows["slips"], amplitudes) / GRAVITY).tolist(),
        hinges_elsewhere_from_g=(first_of(curves.rows["strays"], amplitudes) / GRAVITY).tolist(),
        conditions=conditions,
        **given(handed_over=handed or None),
        **_by_rule(context, options, model, durations, amplitudes, 40.0 * unit, np.asarray(curves.handed.any(axis=1))),
        uplift_acceleration_g=model.uplift,
        restitution=model.restitution,
        natural_time_s=unit if model.what == "arch" else model.time_unit,
        safe_pockets=int((((curves.codes < MODE_I) & (curves.amplitudes > curves.mode_i[:, None])).any(axis=1)).sum()),
        **_at_amplitudes(context, options, model, durations, 40.0 * unit),
        **(_over_uplift(durations, curves.pocket / GRAVITY, model) if slender else {}),
    )
    result.results = r
    columns = {"duration": durations, **{f"{n}_amplitude": c / GRAVITY for n, c in names.items()}, "pocket_begins": curves.pocket / GRAVITY}
    if slender:
        columns |= {"frequency_ratio": np.array(r.frequency_ratio), **{f"{n}_ratio": c / GRAVITY / gamma for n, c in names.items()}}
    result.tables["failure_domain"] = TableData(
        columns, {"duration": "s", "mode_I_amplitude": "g", "mode_II_amplitude": "g", "pocket_begins": "g"}
    )
    result.arrays = {
        "duration": Array(durations, ("duration",), "s", "duration t_p of step and rectangular pulses, period T_p of other pulses"),
        "amplitude": Array(amplitudes / GRAVITY, ("amplitude",), "g"),
        "outcome": Array(
            np.where(curves.slid, SLID, curves.codes),
            ("duration", "amplitude"),
            "",
            f"outcome: 0 no rocking, 1 recovery, 2 Mode I, 3 Mode II, {SLID} sliding alone",
        ),
        "mode_I": Array(curves.mode_i / GRAVITY, ("duration",), "g", "lowest amplitude that causes collapse, with or without an impact"),
        "pocket": Array(curves.pocket / GRAVITY, ("duration",), "g", "lowest amplitude of the first safe region above the curve"),
        "mode_II": Array(curves.mode_ii / GRAVITY, ("duration",), "g", "lowest amplitude that causes collapse in the first half cycle"),
    }
    result.answer = _answer(model, options, durations, curves, r.safe_pockets)
    result.warnings += warned(r)
    if handed:
        friction = f" at friction {conditions.friction:.2f}" if conditions.friction is not None else ""
        result.warnings.append(
            f"{handed} of {curves.codes.size} pulses were continued with rigid contacts: joints slide{friction} "
            f"in {conditions.sliding} pulses, and hinges form outside the mechanism in {conditions.hinges_elsewhere}. "
            "At the durations of these pulses, the failure curves are accurate to one cell of the map."
        )
        if options.at_amplitudes:
            result.warnings.append(
                "The shortest durations that cause collapse (`at_amplitudes`) are calculated with fixed hinges and without sliding."
            )
    return result


def _conditions(model: Rocker, curves: Curves) -> tuple[out.Conditions, int]:
    """The conditions of the map, and how many cells rigid contacts decided; nothing is violated where these decided all that fail."""
    conditions = of_many(model, Counted.of([curves.rows]), "pulses of the map")["conditions"]
    handed, failing = int(curves.handed.sum()), int(((curves.rows["slips"] > 0) | (curves.rows["strays"] > 0)).sum())
    return (conditions.model_copy(update={"violated": []}) if handed and handed == failing else conditions), handed


def _by_contacts(
    context: Context, options: FailureDomain, model: Rocker, mapper: Mapper
) -> Callable[[np.ndarray, np.ndarray], np.ndarray] | None:
    """Outcomes on rigid contacts of pulses whose mechanism a condition leaves; None where contacts do not go on."""
    if not options.hand_over_cells:
        return None

    def decided(index: np.ndarray, amplitude: np.ndarray) -> np.ndarray:
        ends = np.array([m.end for m in mapper.motions]) + mapper.settle
        grounds = [m.ground for m in mapper.motions]
        linear = options.form == "linear"
        found = decide_cells(context, model, options.hand_over_cells, linear, grounds, index, amplitude, ends[index], STEPS)
        return found["outcome"]

    return decided


def warned(r: out.FailureDomain | out.FailureCurve) -> list[str]:
    """Conditions that do not hold or are not checked, and the band of the impact rules."""
    return [*told(r.conditions), *(text for text in [rule_band(r.amplitudes_by_rule, r.rule_ratio)] if text)]


def rule_band(curves: list[out.RuleCurve] | None, ratio: float | None) -> str:
    """What the impact rules leave open of a failure curve, in words; "" where they agree."""
    if not curves:
        return ""
    each = ", ".join(f'"{one.rule}" {one.restitution:.3f}' for one in curves)
    band = "" if ratio is None else f"; the failure amplitudes differ by a factor of up to {ratio:.2f} between the rules"
    return f"The impact rules differ by more than {DIFFER:g} for this structure ({each}){band}. Use dem if this decides the verdict."


def _by_rule(
    context: Context,
    options: FailureDomain,
    model: Rocker,
    durations: np.ndarray,
    amplitudes: np.ndarray,
    settle: float,
    handed: np.ndarray,
) -> dict[str, Any]:
    """The curve by each impact rule, where their c_v differ by more than DIFFER; nothing where they agree. handed (durations): where
    rigid contacts decided, which have one rule."""
    jobs = {
        rule: (
            c_v,
            LowestAmplitudes(
                model.held(body), options.pulse, durations, amplitudes, settle, options.accuracy * GRAVITY, model.start_rotation
            ),
        )
        for rule, (c_v, body) in model.rivals(DIFFER).items()
    }
    return curves_by_rule(context, jobs, len(durations), handed)


def curves_by_rule(
    context: Context, jobs: dict[str, tuple[float, LowestAmplitudes]], count: int, without: np.ndarray | None = None
) -> dict[str, Any]:
    """Lowest failing amplitudes by each impact rule, and the greatest ratio between two of them at a duration. without (durations):
    those that are left out."""
    if not jobs:
        return {}
    found = {
        rule: computed(context, "failure-curves", job, count, f"failure curve with the impact rule {rule}", context.threads)["amplitude"]
        for rule, (_, job) in jobs.items()
    }
    if without is not None:
        found = {rule: np.where(without, np.nan, curve) for rule, curve in found.items()}
    every = np.array(list(found.values()))
    fail = every[:, np.isfinite(every).sum(axis=0) > 1]
    return {
        "amplitudes_by_rule": [
            out.RuleCurve(rule=rule, restitution=jobs[rule][0], amplitudes_g=curve / GRAVITY) for rule, curve in found.items()
        ],
        "rule_ratio": float((np.nanmax(fail, axis=0) / np.nanmin(fail, axis=0)).max()) if fail.size else None,
    }


def _at_amplitudes(context: Context, options: FailureDomain, model: Rocker, durations: np.ndarray, settle: float) -> Keys:
    """The key of the shortest failing durations at the amplitudes that the deck asks for; none where it asks none."""
    if not options.at_amplitudes:
        return {}
    at = np.array(options.at_amplitudes)
    tried = np.linspace(durations.min(), durations.max(), 200)
    found = shortest_durations(
        model.body, options.pulse, at, tried, settle, options.accuracy, context.threads, context, model.start_rotation
    )
    rows = out.AtAmplitudes(
        amplitudes_g=(at / GRAVITY).tolist(), mode_I_durations_s=found[0].tolist(), mode_II_durations_s=found[1].tolist()
    )
    return {"at_amplitudes": rows}


def _over_uplift(durations: np.ndarray, pocket: np.ndarray, model: Rocker) -> dict[str, Any]:
    """omega/p and a/(g tan alpha), the axes of overturning spectra of blocks; `pocket` [g]."""
    return {
        "frequency_ratio": 2.0 * np.pi / durations * model.time_unit,
        "pocket_begins_ratio": pocket / model.unit_acceleration,
        "mode_names": "mode_I: lowest amplitude that causes collapse, with or without an impact. mode_II: lowest amplitude that causes "
        "collapse without an impact (mode 2 of Zhang and Makris). If mode_I is lower than mode_II, the block overturns "
        "after an impact (mode 1 of Zhang and Makris 2001)",
    }


def _answer(model: Rocker, options: FailureDomain, durations: np.ndarray, curves: Curves, pockets: int) -> str:
    shape = {"step": "step pulses (a_p for t_p, then -a_p/2 for 2 t_p)", "sine": "single sine pulses"}.get(
        options.pulse, f"{options.pulse} pulses"
    )
    if not np.isfinite(curves.mode_i).any():
        return f"None of the {shape} up to {options.max_amplitude / GRAVITY:g} g causes collapse of the {model.word}."
    governing = np.nanmin(curves.mode_i) / GRAVITY
    shortest = durations[np.isfinite(curves.mode_i)].min()
    start = "hinge" if model.what == "arch" else "rock"
    if isinstance(model.model, SoftBaseModel):
        start = "lift an edge (constant acceleration)"
    below = np.isfinite(curves.mode_i) & ~(curves.mode_i >= curves.mode_ii)
    modes = (
        "Mode I (collapse after an impact) governs at durations at which its curve is below that of Mode II (collapse without an impact)"
        if below.any()
        else "At no duration does an impact (Mode I) reduce the amplitude that causes collapse"
    )
    return (
        f"Under {shape} the {model.word} starts to {start} at {model.uplift:.3f} g. With amplitudes up to {options.max_amplitude / GRAVITY:g} "
        f"g, it collapses for durations of {shortest:.3f} s or more. The lowest amplitude that causes "
        f"collapse, over the calculated durations, is {governing:.3f} g. {modes}. At {pockets} of {len(durations)} "
        "durations there are safe regions above the curve: do not rely on them."
    )
