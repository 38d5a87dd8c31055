"""The seismic action that the code of a deck asks of a part: one for each limit state."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from extrados.analyses.codes.code_rules import Line
from extrados.analyses.codes.tables import CodeChecks, LocalMechanism, Verification
from extrados.analyses.context import Context, Refused
from extrados.core import motion as core_motion
from extrados.motions.code_spectra import damping_factor
from extrados.motions.from_deck import code_spectrum
from extrados.motions.motion import Motion
from extrados.motions.tables import Compatible
from extrados.schema.code import Code
from extrados.schema.spectrum import CodeSpectrum
from extrados.schema.table import FloorBelow

#: Pseudo-acceleration [m/s^2] over period [s] and damping ratio
Spectrum = Callable[[float, float], float]
#: The spectra that belong to a code, beside a table of the deck's own
OWN = {"NTC": ("NTC",), "EN1998": ("EN1998-1", "EN1998-2"), "ASCE41": ("ASCE7",), "NZSEE": ("NZS1170",)}
#: What the limit state of operation is for
ONLY_DISPLACEMENT = (
    "At SLO only displacements of buildings by pushover are checked: C8.7.1 has no check of piers or local mechanisms at SLO."
)
#: The rules of a deck without [code]
NATIVE = Code(jurisdiction="NTC")


@dataclass(frozen=True)
class Action:
    """Of a limit state: its elastic spectrum and a_g S [m/s^2], None where the deck gives none; its return period [years], None: not
    known; of_motion: whether the spectrum is that of the deck's motion, not of a code."""

    state: str
    spectrum: Spectrum | None
    peak: float | None
    years: float | None = None
    of_motion: bool = False


def floor_below(context: Context) -> FloorBelow | None:
    """The floor on which the deck's motion stands; None for the ground."""
    return None if context.deck.motion is None else context.deck.motion.floor


def code_of(context: Context) -> Code:
    """The code of the deck; without [code] NTC 2018, whose kinematic analysis local mechanisms are."""
    return context.deck.code or NATIVE


def actions(context: Context, options: CodeChecks | LocalMechanism | Verification) -> list[Action]:
    """The action of each limit state; what the analysis gives by itself is that of the concluding one (SLV, SD, LS, ULS). The motion is
    that of the only limit state, if [code] lists one."""
    code, found = code_of(context), {}

    def years(state: str) -> float | None:
        return None if context.deck.code is None else code.return_period(state)

    for state in code.states:
        if state == "SLO" and not isinstance(options, Verification):
            if ONLY_DISPLACEMENT not in context.warnings:
                context.warnings.append(ONLY_DISPLACEMENT)
            continue
        spectrum = spectrum_of(context, code.spectrum(state), "code")
        found[state] = Action(state, spectrum, None if spectrum is None else spectrum(0.0, 0.05), years(state))
    spectrum = demanded_spectrum(context, options.spectrum, options.motion_spectrum and all(a.spectrum is None for a in found.values()))
    peak = options.peak_acceleration
    if spectrum is not None or peak is not None:
        of_motion = spectrum is not None and spectrum_of(context, options.spectrum) is None
        state = next(iter(found)) if of_motion and len(found) == 1 else code.concluding
        old = found.get(state)
        if spectrum is None and old is not None:
            spectrum = old.spectrum
        if peak is None and spectrum is not None:
            peak = spectrum(0.0, 0.05)
        found[state] = Action(state, spectrum, peak, None if of_motion or old is None else old.years, of_motion)
    if isinstance(options, LocalMechanism) and options.collapse_spectrum is not None:
        rare = spectrum_of(context, options.collapse_spectrum, "collapse_spectrum")
        assert rare is not None
        found["SLC"] = Action("SLC", rare, rare(0.0, 0.05), years("SLC"))
    return list(found.values())


def dated(lines: list[Line], action: Action) -> list[Line]:
    """Rules whose note also has the return period of their demand."""
    if action.years is None:
        return lines
    years = f"return period {action.years:.0f} years"
    return [replace(x, note=f"{x.note}, {years}" if x.note else years) for x in lines]


def apart(lines: list[Line]) -> list[Line]:
    """Rules by different names: a rule that is checked at several limit states has each in its name."""
    names = [x.rule for x in lines]
    return [replace(x, rule=f"{x.rule} at {x.state}") if names.count(x.rule) > 1 else x for x in lines]


def spectrum_of(context: Context, model: CodeSpectrum | None, key: str = "spectrum") -> Spectrum | None:
    """Pseudo-acceleration [m/s^2] of the code over period and damping ratio, whatever the seed of the motion; None
    without a spectrum. key: of the analysis that says it, for what is wrong with it; "code": of that table.
    """
    motion = context.deck.motion
    if model is None and key == "spectrum" and isinstance(motion, Compatible) and fits(context.deck.code, motion):
        model = motion
    if model is None:
        return None

    def at(period: float, damping: float) -> float:
        try:
            value = float(code_spectrum(model, context.deck.folder, damping)(np.array([period]))[0])
        except ValueError as error:
            raise Refused(str(error), ("analysis", key)) from None
        # ASCE 7 and a table are of 5 %; at period zero the ground itself has no damping
        five = model.code in ("ASCE7", "table") and period > 0.0
        return value * (damping_factor(damping) if five else 1.0)

    return at


def fits(code: Code | None, model: CodeSpectrum) -> bool:
    """Whether a spectrum may be the demand in a report by a code."""
    return code is None or code.jurisdiction == "none" or model.code in (*OWN[code.jurisdiction], "table")


def refuse_mixed(context: Context, options: CodeChecks | LocalMechanism | Verification) -> None:
    """Refused where the spectrum of the analysis is of another code than [code]."""
    code = context.deck.code
    for name in ("spectrum", "collapse_spectrum"):
        model = getattr(options, name, None)
        if model is not None and not fits(code, model):
            assert code is not None
            raise Refused(
                f"the spectrum is that of {model.code}, but the checks are by {code.jurisdiction}: give the "
                "action in [code], or another `jurisdiction`",
                ("analysis", name),
            )
    if getattr(options, "collapse_spectrum", None) is not None and code_of(context).jurisdiction != "NTC":
        raise Refused(
            "`collapse_spectrum` is the spectrum of SLC, and only NTC has this limit state: remove `collapse_spectrum`",
            ("analysis", "collapse_spectrum"),
        )


def demanded_spectrum(context: Context, model: CodeSpectrum | None, of_motion: bool) -> Spectrum | None:
    """That of the code, see `spectrum_of`; where the deck has none and requests it, that of its motion."""
    code = spectrum_of(context, model)
    if code is not None or not of_motion:
        return code
    if context.deck.motion is None:
        raise Refused("motion_spectrum needs a [motion]", ("analysis", "motion_spectrum"))
    return spectrum_of_motion(*sampled(context.motion), context.motion.peak)


def spectrum_of_motion(acceleration: np.ndarray, step: float, peak: float) -> Spectrum:
    """The response spectrum of samples [m/s^2] every step [s], joined by straight lines; peak: theirs [m/s^2]."""

    def at(period: float, damping: float) -> float:
        if period < step:  # too stiff to answer otherwise than the ground
            return peak
        return float(core_motion.response_spectra(acceleration, step, [period], [damping]).psa[0, 0])

    return at


def sampled(motion: Motion) -> tuple[np.ndarray, float]:
    """Accelerations [m/s^2] and their step [s]."""
    time, acceleration = motion.series()
    return acceleration, float(time[1] - time[0])
