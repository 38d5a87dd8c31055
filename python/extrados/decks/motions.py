"""Motion kinds: positive ground acceleration points to +x."""

from typing import Literal

from pydantic import model_validator

from extrados.decks.quantities import Acceleration, Frequency, Time
from extrados.decks.table import Motion, key


class Constant(Motion):
    """Constant ground acceleration from time zero."""

    kind: Literal["constant"]
    amplitude: Acceleration = key(about="ground acceleration")
    duration: Time = key(10.0, "how long it acts", gt=0)


class StepPulse(Motion):
    """Amplitude for the duration, then minus half of it for twice as long (no velocity is left)."""

    kind: Literal["step-pulse"]
    amplitude: Acceleration = key(about="a_p, of the first part")
    duration: Time = key(about="t_p, of the first part", gt=0)


class SinePulse(Motion):
    """One full cycle of a sine."""

    kind: Literal["sine-pulse"]
    amplitude: Acceleration = key(about="A_p")
    period: Time = key(about="T_p", gt=0)


class Harmonic(Motion):
    """Harmonic motion; amplitude constant, growing over `ramp`, or under a sinusoidal carrier (thesis 5.3.2)."""

    kind: Literal["harmonic"]
    amplitude: Acceleration = key(about="greatest amplitude")
    frequency: Frequency = key(about="in Hz, not rad/s", gt=0)
    duration: Time = key(10.0, "how long it acts", gt=0)
    phase: Literal["sine", "cosine"] = key("sine", "starts at zero (sine) or at the amplitude (cosine)")
    ramp: Time = key(0.0, "the amplitude grows linearly from zero over this time", ge=0)
    carrier: Frequency | None = key(None, "frequency of a sinusoidal carrier that modulates the amplitude")

    @model_validator(mode="after")
    def _one_envelope(self) -> "Harmonic":
        if self.ramp > 0.0 and self.carrier is not None:
            raise ValueError("give ramp or carrier, not both")
        return self


class Record(Motion):
    """A recorded ground motion: AT2 or plain columns; `extrados:el-centro-1940` is shipped."""

    kind: Literal["record"]
    file: str = key(
        about="path inside the deck's folder, or `extrados:NAME` for a shipped record",
        min_length=1,
        max_length=1024,
    )
    time_step: Time | None = key(None, "sampling step where the file has none", gt=0)
    unit: Literal["g", "m/s^2", "cm/s^2", "mm/s^2", "gal"] | None = key(None, "unit where the file has none")
    scale: float = key(1.0, "factor on the acceleration")
    time_scale: float = key(1.0, "factor on the time axis; accelerations keep their size", gt=0)
