"""The motion, or the motions, that a deck asks for."""

from collections.abc import Iterator
from dataclasses import dataclass, field, fields, replace
from functools import lru_cache
from pathlib import Path

import numpy as np

from extrados.core.ground import Ground
from extrados.motions import code_spectra, pulses, records
from extrados.motions import tables as models
from extrados.motions.compatible import CompatibleSet, NotMatched
from extrados.motions.floors import on_floor, sway_of
from extrados.motions.formats.record import Record, RecordError
from extrados.motions.generated import GeneratedSet, Window, generated
from extrados.motions.motion import Motion
from extrados.motions.selection import PERIODS, Chosen, choose, spectrum_of, within
from extrados.schema.spectrum import CodeSpectrum, TargetSpectrum
from extrados.schema.table import Motion as Model
from extrados.schema.text import printable

Sets = models.Suite | models.Generated | models.Compatible


def make_motion(model: Model, folder: Path) -> Motion:
    """The motion of a deck's [motion], of a set its `member`, on its floor; records.RecordError where a file is wrong."""
    made = _make_motion(model, folder)
    # those of sets are on their floor already
    return made if isinstance(model, Sets) else on_floor(made, model.floor)


def _make_motion(model: Model, folder: Path) -> Motion:
    match model:
        case models.Constant():
            return pulses.constant(model.amplitude, model.duration)
        case models.StepPulse():
            return pulses.step_pulse(model.amplitude, model.duration)
        case models.SinePulse():
            return pulses.sine_pulse(model.amplitude, model.period)
        case models.Harmonic():
            return pulses.harmonic(model.amplitude, model.frequency, model.duration, model.phase, model.ramp, model.carrier)
        case models.Pulse():
            return pulses.pulse(model.shape, model.amplitude, model.period)
        case models.VelocityPulse():
            return pulses.velocity_pulse(model.velocity, model.period, model.cycles, model.phase)
        case models.Record():
            return _record(model, _treatment(model), folder)
        case models.Suite():
            members = suite_members(model, folder)
            if model.member > len(members):
                raise RecordError(f"`member` is {model.member}, but the suite has only {len(members)} records")
            return suite_motion(model, members[model.member - 1], folder)
        case models.Generated():
            made = generated_set(model, folder)
            return generated_motion(made, model.member - 1, made.motion(model.member - 1))
        case models.Compatible():
            return compatible_motion(model, folder, model.member - 1)
    raise TypeError(f"no motion for {type(model).__name__}")


def is_set(model: Model | None) -> bool:
    """True where the deck's motion stands for many."""
    return isinstance(model, Sets)


def suite_motions(model: models.Suite, folder: Path) -> Iterator[Motion | RecordError]:
    """All records of a suite; one that cannot be read comes as its error, and the others go on."""
    for member in suite_members(model, folder):
        try:
            yield suite_motion(model, member, folder)
        except RecordError as error:
            yield error


def refuse_set(model: Sets, folder: Path) -> None:
    """RecordError where a set has no motion: no record of a suite can be read, or a spectrum is wrong."""
    if isinstance(model, models.Suite):
        wrong = []
        for found in suite_motions(model, folder):
            if isinstance(found, Motion):
                return
            wrong.append(found)
        raise RecordError(f"none of the {len(wrong)} records of the suite can be read. First reason: {wrong[0]}")
    if isinstance(model, models.Generated):
        generated_set(model, folder)
    else:
        compatible_set(model, folder)


class Selected(models.Components):
    """A record of a suite that a selection takes, with its factor, that before its bounds, and the root mean square of
    ln(its spectrum / target); the first carries the notes on the whole selection."""

    factor: float = 1.0
    unbounded: float = 1.0
    misfit: float = 0.0
    notes: tuple[str, ...] = ()


def suite_members(model: models.Suite, folder: Path) -> list[models.Components]:
    """The records of a suite, not yet read; of a selection the best first."""
    members = _all_members(model, folder)
    chosen = model.selection
    if chosen is None:
        return members
    try:
        named = {name for m in members for name in (m.file, m.second, m.vertical)} | {chosen.flatfile, chosen.table}
        stamps = tuple(_stamp(name, folder) for name in sorted(name for name in named if name is not None))
        return list(_selected(_Wanted(model.model_dump_json(), folder, stamps, model)))
    except (ValueError, OSError) as error:
        raise RecordError(f"[motion.selection]: {error}") from None


def _stamp(name: str, folder: Path) -> tuple[str, int, int]:
    """A file by name, time of writing [ns] and size: a file that changes has another stamp, a file that cannot be found has -1."""
    try:
        found = records.locate(name, folder).stat()
    except (RecordError, OSError):
        return name, -1, -1
    return name, found.st_mtime_ns, found.st_size


@dataclass(frozen=True)
class _Wanted:
    """A suite with a selection, by its words, its folder and the stamps of its files."""

    words: str
    folder: Path
    stamps: tuple[tuple[str, int, int], ...]
    model: models.Suite = field(compare=False)


@lru_cache(maxsize=8)
def _selected(wanted: _Wanted) -> tuple[models.Components, ...]:
    """The records that the selection of a suite takes; ValueError if its target or its table is wrong, or no record can be taken."""
    model, place = wanted.model, wanted.folder
    chosen = model.selection
    assert chosen is not None
    members = _all_members(model, place)
    notes: list[str] = []
    if chosen.flatfile is not None:
        good, missing = within(chosen.flatfile, chosen.limits, place, [m.file for m in members])
        members = [m for m in members if m.file in good]
        if not members:
            raise ValueError(f"{chosen.flatfile}: no record of the suite lies within the limits")
        if missing:
            notes.append(
                f"The flatfile {chosen.flatfile} does not list these records, which are therefore not selected: "
                f"{_first_few(sorted(missing))}."
            )
    at = chosen.conditional_period
    # the spectrum at the conditional period itself, so that the factor is exact
    periods = np.append(np.geomspace(chosen.shortest, chosen.longest, PERIODS), [] if at is None else [at])
    # the target is a spectrum of the ground, also under a floor
    plain = model.model_copy(update={"selection": None, "floor": None})
    found: list[np.ndarray | None] = []
    wrong: list[str] = []
    for member in members:
        psa: np.ndarray | None = None
        try:
            psa = spectrum_of(suite_motion(plain, member, place), periods, chosen.damping)
            if not (psa > 0.0).all():
                wrong.append(f"{member_name(member)}: the response spectrum is zero")
        except RecordError as error:
            wrong.append(str(error))
        found.append(psa)
    target = target_spectrum(chosen, place, chosen.damping)
    best = choose(found, periods, target, chosen.count, (chosen.least_factor, chosen.greatest_factor), at is not None)
    if not best:
        raise ValueError(f"none of the {len(members)} records can be read. First reason: {wrong[0]}")
    if len(best) < chosen.count or wrong:
        reasons = f"; {len(wrong)} record(s) cannot be read: {_first_few(wrong)}" if wrong else ""
        notes.append(f"[motion.selection]: {chosen.count} records were requested, but only {len(best)} are selected{reasons}.")
    notes += _cut_factors([(member_name(members[one.number]), one) for one in best], chosen)
    # model_construct: its paths were found
    return tuple(
        Selected.model_construct(
            **dict(members[one.number]), factor=one.factor, unbounded=one.unbounded, misfit=one.misfit, notes=tuple(notes) if k == 0 else ()
        )
        for k, one in enumerate(best)
    )


def _first_few(names: list[str]) -> str:
    """The first three of a list in words, and how many more there are."""
    return "; ".join(names[:3]) + (f"; and {len(names) - 3} more" if len(names) > 3 else "")


def _cut_factors(best: list[tuple[str, Chosen]], chosen: models.Selection) -> list[str]:
    """A note for each bound that cuts factors of a selection, with their values before it."""
    notes = []
    for name, bound, cut in (
        ("greatest_factor", chosen.greatest_factor, [(n, one) for n, one in best if one.unbounded > chosen.greatest_factor]),
        ("least_factor", chosen.least_factor, [(n, one) for n, one in best if one.unbounded < chosen.least_factor]),
    ):
        if cut:
            wanted = _first_few([f"{n} ({one.unbounded:.3g})" for n, one in cut])
            notes.append(
                f"[motion.selection]: {len(cut)} of {len(best)} scale factors are limited to {name} = {bound:g} (required: "
                f"{wanted}). These records do not reach the target. Change {name}, or extend the suite."
            )
    return notes


def _all_members(model: models.Suite, folder: Path) -> list[models.Components]:
    """The records of a suite without its selection."""
    if model.records is not None:
        return model.records
    found = records.list_suite(model.files, model.pattern, model.folder, folder)
    # model_construct: the length of a path that was found is no matter
    return [models.Components.model_construct(file=str(path)) for path in found]


def member_name(member: models.Components) -> str:
    """What a record of a suite is called in tables and messages."""
    stem = printable(Path(member.file).stem)
    return stem if member.channel is None else f"{stem} {member.channel}"


def suite_motion(model: models.Suite, member: models.Components, folder: Path) -> Motion:
    """One record of a suite as a motion; RecordError where it, or a component of it, cannot be read."""
    treatment = _treatment(model)
    if isinstance(member, Selected):
        treatment = replace(treatment, scale=treatment.scale * member.factor)
    made = replace(_record(member, treatment, folder), name=member_name(member))
    if isinstance(member, Selected):
        cut = "" if member.factor == member.unbounded else f" (cut from {member.unbounded:.3g})"
        note = (
            f"{made.name}: selected with the scale factor {member.factor:.3g}{cut}. Its ground spectrum differs "
            f"from the target by {member.misfit:.2f} (root mean square of the logarithms)."
        )
        made = replace(made, notes=[*member.notes, *made.notes, note])
    return on_floor(made, model.floor)


def generated_set(model: models.Generated, folder: Path, seed: int | None = None) -> GeneratedSet:
    """The set of a deck's `generated` motion, its seed replaced where given."""
    keys = model.model_dump(exclude={"kind", "member", "time_step", "floor"})
    if seed is not None:
        keys["seed"] = seed
    try:
        window = Window(**{field.name: keys.pop(field.name) for field in fields(Window)})
        made = generated(**keys, window=window, step=model.time_step, folder=folder)
        return made if model.floor is None else replace(made, floor=sway_of(model.floor))
    except ValueError as error:
        raise RecordError(f"[motion] generated: {error}") from None


def compatible_set(model: models.Compatible, folder: Path) -> CompatibleSet:
    """The set of a deck's `compatible` motion."""
    try:
        return CompatibleSet(
            target_of(model, folder),
            model.damping,
            model.shortest,
            model.longest,
            model.tolerance,
            model.duration,
            model.time_step,
            model.seed,
            model.envelope,
            model.rise,
            model.decay,
            model.longest if model.code == "table" else np.inf,
        )
    except ValueError as error:
        raise RecordError(f"[motion] compatible: {error}") from None


def code_spectrum(model: CodeSpectrum, folder: Path, damping: float = 0.05) -> code_spectra.Spectrum:
    """The spectrum of a deck's table; those of ASCE 7 and of a table are of 5 % whatever the damping."""
    # which keys a code needs the table has checked
    match model.code:
        case "EN1998-1" | "EN1998-2":
            return code_spectra.en1998(int(model.code[-1]), model.ground, model.acceleration, damping)  # type: ignore[arg-type]
        case "NTC":
            return code_spectra.ntc(
                model.ground,
                model.acceleration,  # type: ignore[arg-type]
                model.amplification,
                model.corner_period,
                model.topography,
                damping,
            )
        case "ASCE7":
            return code_spectra.asce7(model.sds, model.sd1, model.long_period)  # type: ignore[arg-type]
        case "NZS1170":
            return code_spectra.nzs1170(model.ground, model.hazard_factor, model.return_factor, damping)  # type: ignore[arg-type]
    return code_spectra.read_table(model.table, folder)  # type: ignore[arg-type]


def target_spectrum(model: TargetSpectrum, folder: Path, damping: float) -> code_spectra.Spectrum:
    """The target of motions that a table describes; ValueError where its file is wrong."""
    if model.conditional_period is not None and model.conditional_sa is not None and model.table is not None:
        return code_spectra.conditional_mean(model.table, folder, model.conditional_period, model.conditional_sa)
    return code_spectrum(model, folder, damping)


def target_of(model: models.Compatible, folder: Path) -> code_spectra.Spectrum:
    """The target spectrum of a deck's `compatible` motion."""
    spectrum = target_spectrum(model, folder, model.damping)
    spectrum(model.longest)  # refuses a table that ends before the band
    return spectrum


def generated_motion(made: GeneratedSet, k: int, acceleration: np.ndarray) -> Motion:
    """Motion k of a generated set, whose samples (points) [m/s^2] are at hand."""
    return Motion(numbered("generated", k), Ground(samples=acceleration[None, :], step=made.step))


def numbered(kind: str, k: int) -> str:
    """What motion k of a generated or compatible set is called; users count from 1."""
    return f"{kind} motion {k + 1}"


def compatible_motion(model: models.Compatible, folder: Path, k: int, acceleration: np.ndarray | None = None) -> Motion:
    """Motion k of a compatible set; `acceleration` [m/s^2] where it was matched before. RecordError where it cannot be."""
    try:
        if acceleration is not None:
            return Motion(numbered("compatible", k), Ground(samples=acceleration[None, :], step=model.time_step))
        return on_floor(Motion(numbered("compatible", k), compatible_set(model, folder).ground(k)), model.floor)
    except (NotMatched, ValueError) as error:
        raise RecordError(f"[motion] compatible: {error}") from None


def _treatment(model: models.Treated) -> records.Treatment:
    return records.Treatment(**{k: getattr(model, k) for k in records.Treatment.__dataclass_fields__})


def _record(model: models.Components, treatment: records.Treatment, folder: Path) -> Motion:
    seen = {(records.locate(model.file, folder), model.channel)}

    def component(file: str | None, channel: int | str | None) -> Record | None:
        if file is None and channel is None:
            return None
        file = model.file if file is None else file
        place = (records.locate(file, folder), channel)
        if place in seen:
            raise RecordError(f"{place[0]}: this file is given for two components of one record")
        seen.add(place)
        return records.read_record(records.read_file(file, folder), channel, treatment.columns)

    return records.record_motion(
        records.read_record(records.read_file(model.file, folder), model.channel, treatment.columns),
        treatment,
        second=component(model.second, model.second_channel),
        angle=model.angle or 0.0,
        vertical=component(model.vertical, model.vertical_channel),
        source=model.file,
    )
