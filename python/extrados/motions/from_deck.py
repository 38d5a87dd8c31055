"""The motion that a deck asks for."""

from pathlib import Path

from extrados.decks import motions as models
from extrados.decks.table import Motion as Model
from extrados.motions import pulses, records
from extrados.motions.motion import Motion


def make_motion(model: Model, folder: Path) -> Motion:
    """The motion of a deck's [motion]; records.RecordError where a file is wrong."""
    match model:
        case models.Constant():
            return pulses.constant(model.amplitude, model.duration)
        case models.StepPulse():
            return pulses.step_pulse(model.amplitude, model.duration)
        case models.SinePulse():
            return pulses.sine_pulse(model.amplitude, model.period)
        case models.Harmonic():
            return pulses.harmonic(
                model.amplitude, model.frequency, model.duration, model.phase, model.ramp, model.carrier
            )
        case models.Record():
            path = records.locate(model.file, folder)
            return records.record_motion(
                records.read_record(path),
                time_step=model.time_step,
                unit=model.unit,
                scale=model.scale,
                time_scale=model.time_scale,
                source=model.file,
            )
    raise TypeError(f"no motion for {type(model).__name__}")
