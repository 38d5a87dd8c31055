"""motion: what a ground motion is, alone or as a set: peaks, measures, spectra, pulses, export."""

from pathlib import Path
from typing import Any

import numpy as np

from extrados.analyses.batches import sweep
from extrados.analyses.context import Context, Refused
from extrados.analyses.motion.members import Generated, Held, Matched, Measures, Members, PrimaryImpulses, Spectra, rotd_peaks, series
from extrados.analyses.motion.tables import MotionStudy
from extrados.analyses.motion_source import shortened
from extrados.core import motion as core
from extrados.core.calls import interruptible, stop_if_asked
from extrados.motions import directions, export
from extrados.motions import tables as models
from extrados.motions.formats.record import RecordError
from extrados.motions.from_deck import compatible_motion, compatible_set, generated_set, is_set, suite_motions, target_spectrum
from extrados.motions.impulse import Impulse, primary_impulses
from extrados.motions.measures import BANDWIDTH, HOUSNER_BAND, fourier_spectrum, konno_ohmachi, spectral_measures
from extrados.motions.motion import Motion
from extrados.motions.processing import drift
from extrados.motions.wavelet_pulse import classify, classify_directions
from extrados.results import motion as out
from extrados.results.model import Array, Result, TableData
from extrados.schema.constants import GRAVITY

MOST_SPECTRA = 1000  # of a set: what percentiles are taken over
MOST_IMPULSES = 60  # of a set: whose primary impulse is fitted
SMOOTHED = 300  # frequencies of a smoothed spectrum
SHOWN = 4  # motions of a set that are stored and drawn
PERCENTILES = (16, 50, 84)
#: Measures of a motion whose medians over a set are results
MEDIANS = ("pga_g", "pgv_m_s", "pgd_m", "arias_m_s", "cav_m_s", "duration_5_95_s")


def run(context: Context, options: MotionStudy) -> Result:
    """One motion in depth, or the statistics of a set."""
    if not is_set(context.deck.motion):
        return _run_one(context, options)
    with interruptible():  # over all sweeps: Ctrl-C between two of them counts
        return _run_set(context, options)


def _periods(options: MotionStudy, step: float) -> np.ndarray:
    """Of a spectrum [s]; Refused where the time step is too long for those that are asked for or of a measure."""
    shortest = core.POINTS_PER_CYCLE * step / 4096.0
    if shortest > (needed := min(options.longest, HOUSNER_BAND[0])):
        raise Refused(
            f"a time step of {step:.3g} s is too long for the spectrum, which must include the period of {needed:g} s: use shorter steps",
            ("motion",),
        )
    return np.geomspace(max(options.shortest, shortest), options.longest, options.periods)


def _impulse(i: Impulse) -> out.Impulse:
    return out.Impulse(
        amplitude_g=i.amplitude / GRAVITY, period_s=i.period, start_s=i.start, goodness_of_fit=i.goodness, explained=i.explained
    )


def _study(motion: Motion, options: MotionStudy) -> dict:
    """All numbers of one motion, keys ending in their unit."""
    a, step = series(motion)
    m, s = core.measures(a, step), spectral_measures(a, step)
    time = step * np.arange(len(a))
    impulses = primary_impulses(time, a, options.impulses, None, options.max_period)
    pulse = classify(a, step)
    return {
        "pga_g": float(m.pga[0]) / GRAVITY,
        "pga_time_s": float(m.pga_time[0]),
        "pgv_m_s": float(m.pgv[0]),
        "pgd_m": float(m.pgd[0]),
        "pgv_over_pga_s": float(m.pgv[0] / m.pga[0]) if m.pga[0] > 0.0 else None,
        "arias_m_s": float(m.arias[0]),
        "cav_m_s": float(m.cav[0]),
        "duration_5_95_s": float(m.duration[0]),
        "duration_5_75_s": float(m.duration_75[0]),
        "housner_intensity_m": s.housner_intensity,
        "predominant_period_s": s.predominant_period,
        "velocity_period_s": s.velocity_period,
        "mean_period_s": s.mean_period,
        "points": len(a),
        "time_step_s": step,
        "primary_impulse": _impulse(impulses[0]) if impulses else None,
        "impulses": [_impulse(i) for i in impulses],
        "wavelet_pulse": out.WaveletPulse(
            indicator=pulse.indicator,
            period_s=pulse.period,
            peak_velocity_m_s=pulse.peak_velocity,
            pgv_ratio=pulse.pgv_ratio,
            energy_ratio=pulse.energy_ratio,
            early=pulse.early,
            pulse_like=pulse.pulse_like,
            fails=list(pulse.fails),
        ),
        **{name: said for name in ("title", "station") if (said := getattr(motion, name))},
    }


def _run_one(context: Context, options: MotionStudy) -> Result:
    motion = context.motion
    a, step = series(motion)
    velocity, displacement = core.kinematics(a, step)
    periods = _periods(options, step)
    spectra = core.response_spectra(a, step, periods, options.dampings, threads=context.threads)
    frequency, amplitude = fourier_spectrum(a, step)
    result = Result("motion")
    r = _study(motion, options)
    if not isinstance(context.deck.motion, models.Record | models.Suite) and (found := drift(a, step)[0]):
        result.warnings.append(f"The motion is prescribed so that {found}.")  # of records their notes say it
    husid = np.concatenate([[0.0], np.cumsum(0.5 * step * (a[1:] ** 2 + a[:-1] ** 2))])
    time = step * np.arange(len(a))
    result.arrays = {
        "time": Array(time, ("time",), "s"),
        "acceleration": Array(a, ("time",), "m/s^2", "horizontal ground acceleration"),
        "velocity": Array(velocity, ("time",), "m/s", "from rest"),
        "displacement": Array(displacement, ("time",), "m", "from rest"),
        "pulse_velocity": Array(classify(a, step).velocity, ("time",), "m/s", "pulse of Baker's classification"),
        "husid": Array(husid / max(husid[-1], 1e-300), ("time",), "", "share of the Arias intensity"),
        "frequency": Array(frequency, ("frequency",), "Hz"),
        "fourier": Array(amplitude, ("frequency",), "m/s", "Fourier amplitude of the acceleration"),
        **_smoothed(frequency, amplitude),
        **_spectra_arrays(spectra),
    }
    if context.motion.ground.channels > 1:
        result.arrays["vertical"] = Array(motion.sample(motion.ground.start + time, 1), ("time",), "m/s^2", "vertical acceleration")
        r["vertical_pga_g"] = float(np.abs(result["vertical"]).max()) / GRAVITY
    rotd: dict[str, np.ndarray] = {}
    if motion.horizontal is not None:
        rotd = _all_directions(context, options, periods, result)
        r |= {**rotd_peaks(motion), "rotd_damping": _damping(options), "directed_pulses": _directed(motion)}
    result.tables = {
        "motion": TableData(
            {"time": time, "acceleration": a, "velocity": velocity, "displacement": displacement},
            {"time": "s", "acceleration": "m/s^2", "velocity": "m/s", "displacement": "m"},
        ),
        "response_spectra": TableData(
            {
                "period": periods,
                **{
                    f"{n}_{100 * d:g}": v[k]
                    for k, d in enumerate(options.dampings)
                    for n, v in (("psa", spectra.psa), ("psv", spectra.psv), ("sd", spectra.sd))
                },
                **rotd,
            },
            {
                "period": "s",
                **{f"{n}_{100 * d:g}": u for d in options.dampings for n, u in (("psa", "m/s^2"), ("psv", "m/s"), ("sd", "m"))},
                **dict.fromkeys(rotd, "m/s^2"),
            },
        ),
    }
    writers = {"AT2": ("motion.AT2", export.at2), "columns": ("motion_columns.csv", export.columns)}
    result.files = {name: write(motion.name, a, step) for name, write in (writers[e] for e in dict.fromkeys(options.export))}
    result.results = out.OneMotion(**r)
    result.answer = describe(motion.name, result.results)
    return result


def _smoothed(frequency: np.ndarray, amplitude: np.ndarray) -> dict[str, Array]:
    """The Fourier spectrum smoothed, from 0.05 Hz or what the motion resolves up to 50 Hz or what it holds."""
    low, high = max(0.05, 2.0 * float(frequency[1])), min(50.0, float(frequency[-1]))
    if low >= high:
        return {}
    centre = np.geomspace(low, high, SMOOTHED)
    about = f"Fourier amplitude smoothed by the window of Konno and Ohmachi, b = {BANDWIDTH:g}"
    return {
        "smooth_frequency": Array(centre, ("smooth_frequency",), "Hz"),
        "fourier_smooth": Array(konno_ohmachi(frequency, amplitude, centre), ("smooth_frequency",), "m/s", about),
    }


def _damping(options: MotionStudy) -> float:
    """Damping ratio where one spectrum must do."""
    return options.dampings[min(1, len(options.dampings) - 1)]


def _all_directions(context: Context, options: MotionStudy, periods: np.ndarray, result: Result) -> dict[str, np.ndarray]:
    """What both horizontal components give over all directions, into `result`; columns for the table of spectra."""
    horizontal, step, damping = context.motion.horizontal, context.motion.ground.step, _damping(options)
    assert horizontal is not None  # of a record with both components
    psa = directions.spectra(horizontal, step, periods, damping, context.threads)
    found = {}
    for name, values in zip(("rotd50", "rotd100"), psa, strict=True):
        result.arrays[f"psa_{name}"] = Array(values, ("period",), "m/s^2", f"{name.replace('rotd', 'RotD')}, {100 * damping:g} % damping")
        found[f"psa_{name}_{100 * damping:g}"] = values
    return found


def _directed(motion: Motion) -> list[out.DirectedPulse]:
    """Candidates of pulses over all directions of a record with both horizontal components."""
    assert motion.horizontal is not None
    return [
        out.DirectedPulse(
            indicator=one.indicator,
            period_s=one.period,
            angle_deg=float(np.degrees(one.angle)),
            pgv_m_s=one.pgv,
            pgv_ratio=one.pgv_ratio,
            energy_ratio=one.energy_ratio,
            energy_before=one.before,
            pulse_like=one.pulse_like,
        )
        for one in classify_directions(motion.horizontal, motion.ground.step)
    ]


def describe(name: str, r: out.OneMotion) -> str:
    """The numbers of one motion in words."""
    said = ", ".join(part for part in (r.title, r.station) if part)
    text = (
        f"{name}{f' ({said})' if said else ''}: peak acceleration {r.pga_g:.4g} g at {r.pga_time_s:.2f} s, peak velocity "
        f"{100 * r.pgv_m_s:.3g} cm/s, peak displacement {100 * r.pgd_m:.3g} cm; Arias intensity {r.arias_m_s:.3g} m/s "
        f"over {r.duration_5_95_s:.3g} s (5 to 95 %). "
    )
    if r.rotd100_pga_g is not None:
        text += (
            f"Over all directions, the median of the peaks is {r.rotd50_pga_g:.4g} g (RotD50), and the greatest "
            f"peak is {r.rotd100_pga_g:.4g} g (RotD100). "
        )
    if first := r.primary_impulse:
        text += (
            f"The primary impulse is a sine with an amplitude of {abs(first.amplitude_g):.3g} g and a period of {first.period_s:.3g} "
            f"s, starting at {first.start_s:.2f} s. This sine explains {100 * first.goodness_of_fit:.0f} % of the "
            "motion over its duration. "
        )
    if r.directed_pulses is not None:
        like = [one for one in r.directed_pulses if one.pulse_like]
        text += (
            f"Over all directions the motion is pulse-like: period {like[0].period_s:.2f} s at {like[0].angle_deg:.0f} degrees "
            "from the first component (Shahi and Baker 2014). "
            if like
            else "Over all directions the motion is not pulse-like (Shahi and Baker 2014). "
        )
    pulse = r.wavelet_pulse
    if pulse.pulse_like:
        return (
            f"{text}By the classification of Baker the motion is pulse-like (indicator {pulse.indicator:.2f}, period "
            f"{pulse.period_s:.2f} s)."
        )
    return f"{text}By the classification of Baker the motion is not pulse-like: {'; '.join(pulse.fails)} (period {pulse.period_s:.2f} s)."


def _spectra_arrays(spectra: core.Spectra) -> dict[str, Array]:
    dims = ("damping", "period")
    return {
        "period": Array(spectra.period, ("period",), "s"),
        "damping": Array(spectra.damping, ("damping",), "", "damping ratio"),
        "psa": Array(spectra.psa, dims, "m/s^2", "pseudo-acceleration"),
        "psv": Array(spectra.psv, dims, "m/s", "pseudo-velocity"),
        "sd": Array(spectra.sd, dims, "m", "relative displacement"),
        "sa": Array(spectra.sa, dims, "m/s^2", "absolute acceleration"),
    }


def _readable(context: Context, model: models.Suite, warnings: list[str]) -> list[Motion]:
    """The motions of a suite; a record that cannot be read becomes a warning, and a refusal if it is the only one."""
    found: list[Motion] = []
    wrong: list[str] = []
    notes: list[str] = []
    for motion in suite_motions(model, context.deck.folder):
        stop_if_asked()
        if isinstance(motion, RecordError):
            wrong.append(str(motion))
            warnings += wrong[-1:] if len(wrong) <= 10 else []
        else:
            found.append(motion)
            notes += motion.notes
    warnings += shortened(notes)
    if len(wrong) > 10:
        warnings.append(f"and {len(wrong) - 10} more records that cannot be read")
    if not found:
        raise Refused(f"none of the {len(wrong)} records can be read. First reason: {wrong[0]}", ("motion",))
    return found


def _members(context: Context, options: MotionStudy, warnings: list[str]) -> tuple[Members, int]:
    """The motions of the set and how many they are. A compatible one, whose motions take long to make, is made here."""
    model, folder = context.deck.motion, context.deck.folder
    if isinstance(model, models.Suite):
        read = _readable(context, model, warnings)
        return Held(read), len(read)
    if isinstance(model, models.Generated):
        return Generated(generated_set(model, folder)), options.count
    assert isinstance(model, models.Compatible)  # is_set
    job = Matched(model, folder)
    swept = sweep(context, "compatible", job, options.count, "compatible motions", slow=True).whole()
    made = [compatible_motion(model, folder, k, a) for k, a in enumerate(swept["acceleration"])]
    return Held(made), options.count


def _run_set(context: Context, options: MotionStudy) -> Result:
    model, folder = context.deck.motion, context.deck.folder
    assert model is not None  # is_set
    suite = isinstance(model, models.Suite)
    damping = model.damping if isinstance(model, models.Compatible) else _damping(options)
    warnings: list[str] = []
    try:
        members, count = _members(context, options, warnings)
    except RecordError as error:
        raise Refused(str(error), ("motion",)) from None
    shown = [(motion.name, *series(motion)) for motion in members.motions(0, min(count, SHOWN), context.threads)]
    periods = _periods(options, shown[0][2])
    measures = sweep(context, "measures", Measures(members, suite), count, "measures of motions").whole().arrays
    job = Spectra(members, periods, damping, not suite)
    spectra = sweep(context, "spectra", job, min(count, MOST_SPECTRA), "spectra of motions").whole()
    primary = PrimaryImpulses(members, options.max_period)
    impulses = sweep(context, "impulses", primary, min(count, MOST_IMPULSES), "impulses of motions", slow=True).whole()
    psa = spectra["psa"]
    result = Result("motion", warnings=warnings)
    r: dict[str, Any] = {
        "count": count,
        "damping": damping,
        **{f"median_{n}": float(np.median(measures[n])) for n in MEDIANS},
        **{f"largest_{n}": float(np.max(measures[n])) for n in ("pga_g", "pgv_m_s")},
        "median_impulse_amplitude_g": float(np.nanmedian(impulses["amplitude_g"])),
        "median_impulse_period_s": float(np.nanmedian(impulses["period_s"])),
        "time_step_s": shown[0][2],
    }
    result.tables["ensemble"] = TableData(
        {"name": [members.name(k) for k in range(count)]} | {n: v for n, v in measures.items() if n in MEDIANS or np.isfinite(v).any()}
    )
    result.arrays = {
        "period": Array(periods, ("period",), "s"),
        "psa_percentile": Array(np.percentile(psa, PERCENTILES, axis=0), ("percentile", "period"), "m/s^2", "16, 50 and 84 %"),
        "psa_mean": Array(psa.mean(axis=0), ("period",), "m/s^2", "mean pseudo-acceleration of the set"),
        "psa_shown": Array(psa[:SHOWN], ("shown", "period"), "m/s^2"),
        "impulse_amplitude": Array(impulses["amplitude_g"], ("studied",), "g", "primary impulses"),
        "impulse_period": Array(impulses["period_s"], ("studied",), "s"),
        **{f"shown_{k + 1}": Array(a, (f"point_{k + 1}",), "m/s^2", name, "shown") for k, (name, a, _) in enumerate(shown)},
        "shown_step": Array(np.array([s for _, _, s in shown]), ("shown",), "s"),
    }
    if not suite:
        _, a, step = shown[0]
        result.arrays["frequency"] = Array(fourier_spectrum(a, step)[0], ("frequency",), "Hz")
        result.arrays["fourier"] = Array(
            np.sqrt(np.mean(spectra["fourier"] ** 2, axis=0)), ("frequency",), "m/s", "root mean square Fourier amplitude"
        )
    if model.floor is not None:  # targets and intensities are those of the ground
        result.answer = (
            f"{count} motions of a floor: median peaks {r['median_pga_g']:.3g} g and {100 * r['median_pgv_m_s']:.3g} cm/s, "
            f"largest {r['largest_pga_g']:.3g} g; median Arias intensity {r['median_arias_m_s']:.3g} m/s."
        )
        if not isinstance(model, models.Suite) or model.selection is not None:
            result.warnings.append(
                "The target spectrum of the set is that of the ground, so the motions of the floor are not compared with it."
            )
    elif isinstance(model, models.Generated):
        r |= _compare_with_intensity(result, r, model, context)
    elif isinstance(model, models.Compatible):
        known = periods <= (model.longest if model.code == "table" else np.inf)
        target = np.full_like(periods, np.nan)
        target[known] = compatible_set(model, folder).target(periods[known])
        r |= _compare_with_target(result, r, model, periods, psa, target)
    else:
        result.answer = (
            f"{count} records: median peak acceleration {r['median_pga_g']:.3g} g (largest {r['largest_pga_g']:.3g} g), median peak "
            f"velocity {100 * r['median_pgv_m_s']:.3g} cm/s, median Arias intensity {r['median_arias_m_s']:.3g} m/s."
        )
        if isinstance(model, models.Suite) and model.selection is not None:
            r |= _beside_selection(result, model.selection, folder, periods, psa)
    result.results = out.MotionSet(**r)
    for k, (name, a, step) in enumerate(shown):
        if "AT2" in options.export:
            result.files[f"motion_{k + 1}.AT2"] = export.at2(name, a, step)
        if "columns" in options.export:
            result.files[f"motion_{k + 1}.csv"] = export.columns(name, a, step)
    return result


def _beside_selection(result: Result, chosen: models.Selection, folder: Path, periods: np.ndarray, psa: np.ndarray) -> dict[str, Any]:
    """The target of a selection as an array, and the mean of ln(spectra of the records / target) over its band in the answer; further
    results."""
    band = (periods >= chosen.shortest) & (periods <= chosen.longest)
    target = np.full_like(periods, np.nan)
    target[band] = target_spectrum(chosen, folder, chosen.damping)(periods[band])
    result.arrays["target"] = Array(target, ("period",), "m/s^2", "target spectrum of the selection")
    ratio = np.exp(np.log(psa[:, band] / target[band]).mean(axis=0))
    result.answer += (
        f" The records are selected by spectrum: from {chosen.shortest:g} to {chosen.longest:g} s their geometric mean is "
        f"{ratio.min():.2f} to {ratio.max():.2f} times the target."
    )
    return {"shortest_s": chosen.shortest, "longest_s": chosen.longest}


def _compare_with_intensity(result: Result, r: dict[str, Any], model: models.Generated, context: Context) -> dict[str, Any]:
    """PGA, PGV and Arias of the set (r, its results so far) beside the medians of its intensity; further results."""
    made = generated_set(model, context.deck.folder)
    expected = made.expected()
    further = {
        "mmi": model.mmi,
        "seed": model.seed,
        "expected_pga_g": expected["pga"] / GRAVITY,
        "expected_pgv_m_s": expected["pgv"],
        "expected_arias_m_s": expected["arias"],
        "pga_over_expected": r["median_pga_g"] * GRAVITY / expected["pga"],
        "pgv_over_expected": r["median_pgv_m_s"] / expected["pgv"],
        "arias_over_expected": r["median_arias_m_s"] / expected["arias"],
    }
    result.arrays |= {
        "line": Array(made.lines, ("line",), "Hz"),
        "line_width": Array(made.widths, ("line",), "Hz"),
        "line_spectrum": Array(made.spectrum, ("line",), "m/s", "target Fourier amplitude"),
        "line_amplitude": Array(made.amplitude, ("line",), "m/s^2", "amplitude of the sine"),
    }
    ratio = further["pga_over_expected"]
    result.answer = (
        f"{r['count']} generated motions of intensity {model.mmi:g}: median peak acceleration {r['median_pga_g']:.3g} "
        f"g, median peak velocity {100 * r['median_pgv_m_s']:.3g} cm/s, Arias intensity {r['median_arias_m_s']:.3g} "
        f"m/s. Records of this intensity have medians of {further['expected_pga_g']:.3g} g and {100 * further['expected_pgv_m_s']:.3g} "
        f"cm/s (Worden et al. 2012); the Arias intensity of the target spectrum is {further['expected_arias_m_s']:.3g} "
        f"m/s. The peak acceleration of the set is {ratio:.2f} times that of the records."
    )
    if not 0.5 <= ratio <= 2.0:
        result.warnings.append(
            f'the PGA of the set is {ratio:.2f} times the median of intensity {model.mmi:g}: scaling = "{model.scaling}" '
            f"with factor {model.factor:g} does not represent that intensity (see the documentation of Eq. "
            "6.6)"
        )
    return further


def _compare_with_target(
    result: Result, r: dict[str, Any], model: models.Compatible, periods: np.ndarray, psa: np.ndarray, target: np.ndarray
) -> dict[str, Any]:
    """The set's spectra (r, its results so far) against the target over its band; further results."""
    band = (periods >= model.shortest) & (periods <= model.longest)
    off = np.abs(psa[:, band] / target[band] - 1.0)
    mean_low = float(np.min(psa.mean(axis=0)[band] / target[band]))
    result.arrays["target"] = Array(target, ("period",), "m/s^2", "target spectrum")
    result.answer = (
        f"{len(psa)} motions match the spectrum of {model.code} within {100 * off.max():.1f} % from {model.shortest:g} to "
        f"{model.longest:g} s ({100 * model.damping:g} % damping); their mean is at least {100 * mean_low:.0f} % of the "
        f"spectrum at every period. The median peak acceleration is {r['median_pga_g']:.3g} g, and the median peak "
        f"velocity {100 * r['median_pgv_m_s']:.3g} cm/s."
    )
    return {
        "largest_deviation": float(off.max()),
        "mean_over_target_least": mean_low,
        "seed": model.seed,
        "shortest_s": model.shortest,
        "longest_s": model.longest,
    }
