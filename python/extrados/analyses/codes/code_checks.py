"""code-checks: rules of codes for rocking bodies, and for walls as piers, beside the computed rocking."""

from collections.abc import Callable
from typing import Any

import numpy as np

from extrados.analyses.codes import ntc
from extrados.analyses.codes.code_rules import Line, asce43, housner, ishiyama, more_piers, piers, table, west
from extrados.analyses.codes.tables import CodeChecks
from extrados.analyses.context import Context, Refused
from extrados.analyses.rocking.conditions import of_one, told
from extrados.core import motion as core_motion
from extrados.core import rocking as core_rocking
from extrados.model.structures.block import BlockAssembly
from extrados.motions.code_spectra import damping_factor
from extrados.motions.from_deck import code_spectrum
from extrados.motions.motion import Motion
from extrados.motions.tables import Compatible
from extrados.results import codes as out
from extrados.results.model import Array, Result
from extrados.schema.constants import GRAVITY
from extrados.schema.spectrum import CodeSpectrum


def run(context: Context, options: CodeChecks) -> Result:
    """All rules that apply to the code's own demand, with the computed rocking of the deck's motion beside them."""
    structure = context.deck.structure
    result = Result("code-checks")
    demands: dict[str, Any] = {}
    if structure.rocks_as == "piers":
        lines = _wall(context, options)
    else:
        block = context.building.rocker().model.block
        lines, demands = _block(context, options, block)
        if options.axial_load is not None:
            lines += _pier(context, options, block.toe_right + block.toe_left, 2.0 * block.centre_height,
                           options.thickness or block.depth, float(block.mass[0]) * GRAVITY)  # fmt: skip
    r = out.CodeChecks(checks={line.rule: line.check() for line in lines}, **demands)
    result.results = r
    rows = result.tables["code_checks"] = table(lines)
    result.arrays = {
        "capacity": Array(np.array(rows.columns["capacity"]), ("rule",), "", "each in its unit, see code_checks.csv"),
        "demand": Array(np.array(rows.columns["demand"]), ("rule",)),
    }
    said = [
        f"{x.rule} {x.verdict} ({x.demand:.3g} against {x.capacity:.3g} {x.unit})"
        for x in lines
        if x.verdict in ("holds", "fails")
    ]
    words = [r.overall().statement, f"In detail: {'; '.join(said)}."] if said else []
    if r.dynamic_outcome:
        ratio = r.dynamic_peak_rotation_ratio
        spoken = {"collapse": "overturns", "recovery": f"rocks to {100 * ratio:.0f} % of its critical rotation and recovers",
                  "no-hinging": "does not rock"}[r.dynamic_outcome]  # fmt: skip
        words.append(f"Computed under the motion itself, the block {spoken}.")
    strengths = {x.rule: x.capacity for x in lines if x.unit == "N" and x.capacity is not None}
    if strengths:
        weakest = min(strengths, key=lambda rule: strengths[rule])
        words.append(
            f"As a pier its least strength is {strengths[weakest] / 1e3:.4g} kN ({weakest}), with all partial factors at 1."
        )
    if not said:
        words.insert(0, "Capacities without a demand: give spectrum or peak_acceleration, the values of the code.")
    result.answer = " ".join(words)
    return result


def _block(context: Context, options: CodeChecks, block: BlockAssembly) -> tuple[list[Line], dict[str, Any]]:
    """The rules of rocking bodies, and the results that stand beside them."""
    rocker = context.building.rocker()
    model = rocker.model
    context.warnings += model.warnings
    width, height = block.toe_right + block.toe_left, 2.0 * block.centre_height
    spectrum = demanded_spectrum(context, options.spectrum, options.motion_spectrum)
    pga, sa, pgv = None, None, options.peak_velocity
    if options.motion_spectrum and pgv is None and spectrum_of(context, options.spectrum) is None:
        pgv = float(core_motion.measures(*_sampled(context.motion)).pgv[0])
    if spectrum is not None:
        pga = spectrum(0.0, 0.05) / GRAVITY

        def sa(period: float, damping: float) -> float:
            return spectrum(period, damping) / GRAVITY

    if options.peak_acceleration is not None:
        pga = options.peak_acceleration / GRAVITY
    beside: dict[str, Any] = {
        "peak_ground_acceleration_g": pga, "peak_ground_velocity_m_s": pgv, "confidence_factor": options.confidence_factor,
        "behaviour_factor": options.behaviour_factor,
    }  # fmt: skip
    violated, friction = [], context.building.joints.coefficient
    if options.confidence_factor < ntc.LC1 and context.building.material.compressive_strength is None:
        violated.append(ntc.below_lc1(options.confidence_factor))
    if friction is not None and friction < np.tan(model.alpha.min()):
        violated.append(
            f"Friction {friction:g} is below the {np.tan(model.alpha.min()):.3g} that rocking needs: the block slides first, which these "
            "rules do not consider."
        )
    if context.deck.motion is not None:
        motion = context.motion
        start = rocker.start_rotation
        dynamic = core_rocking.history(
            rocker.body, motion.ground, motion.end + 30.0 / float(model.frequency.min()), 0.01,
            start_side=1 if start >= 0.0 else -1, start_rotation=abs(start),
        )  # fmt: skip
        conditions = of_one(rocker, dynamic)
        context.warnings += told(conditions)
        violated += [text for text in conditions.violated if text.startswith("Hinges form elsewhere")]
        beside |= {"dynamic_outcome": dynamic.outcome, "dynamic_peak_rotation_ratio": dynamic.peak_ratio}
    if violated:
        beside["violated"] = violated
    alpha = float(model.alpha.min())
    # one body: all its mass takes part (e* = 1); d* is the displacement of the centre of mass
    alpha0 = float(np.tan(alpha))
    a0 = alpha0 * GRAVITY / options.confidence_factor
    lines = [
        west(alpha0, pga), *ishiyama(width, height, pga, pgv),
        *ntc.checks(a0, block.centre_height * alpha0, options.behaviour_factor, None if pga is None else pga * GRAVITY, spectrum,
                    f"alpha_0 {alpha0:.4g}, e* 1"),
        asce43(width, height, sa),
    ]  # fmt: skip
    if options.pulse_period is not None:
        lines.append(housner(float(model.frequency[0]), alpha, pga, options.pulse_period))
    return lines, beside


def spectrum_of(
    context: Context, model: CodeSpectrum | None, key: str = "spectrum"
) -> Callable[[float, float], float] | None:
    """Pseudo-acceleration [m/s^2] of the code over period and damping ratio, whatever the seed of the motion; None
    without a spectrum. key: of the analysis that says it, for what is wrong with it.
    """
    if model is None and isinstance(context.deck.motion, Compatible):
        model = context.deck.motion
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


def demanded_spectrum(
    context: Context, model: CodeSpectrum | None, of_motion: bool
) -> Callable[[float, float], float] | None:
    """That of the code, see `spectrum_of`; where the deck has none and asks for it, that of its motion."""
    code = spectrum_of(context, model)
    if code is not None or not of_motion:
        return code
    if context.deck.motion is None:
        raise Refused("motion_spectrum needs a [motion]", ("analysis", "motion_spectrum"))
    motion = context.motion
    acceleration, step = _sampled(motion)

    def at(period: float, damping: float) -> float:
        if period < 10.0 * step:  # too stiff to answer otherwise than the ground
            return motion.peak
        return float(core_motion.response_spectra(acceleration, step, [period], [damping]).psa[0, 0])

    return at


def _sampled(motion: Motion) -> tuple[np.ndarray, float]:
    """Accelerations [m/s^2] and their step [s]."""
    time, acceleration = motion.series()
    return acceleration, float(time[1] - time[0])


def _wall(context: Context, options: CodeChecks) -> list[Line]:
    """The pier rules for a wall without openings, with its material's compressive strength."""
    wall = context.deck.structure
    pier = context.building.pier_blocks()
    thickness = options.thickness or pier.depth
    weight = float(pier.mass[0]) * GRAVITY * thickness / pier.depth
    return _pier(context, options, *wall.size, thickness, weight)


def _pier(
    context: Context, options: CodeChecks, width: float, height: float, thickness: float, weight: float
) -> list[Line]:
    strength, joints = context.building.material.compressive_strength, context.building.joints
    assert strength is not None and options.axial_load is not None
    load = options.axial_load + weight
    if load >= 0.7 * strength * width * thickness:
        raise Refused("the vertical load alone crushes the pier (P >= 0.7 f_m A)", ("analysis", "axial_load"))
    fixed = options.fixity == "double"
    return [
        *piers(width, height, thickness, load, strength, joints.cohesion, options.sliding_friction, fixed),
        *more_piers(
            width, height, thickness, options.axial_load, weight, strength, joints.cohesion, options.sliding_friction,
            options.diagonal_strength, fixed,
        ),
    ]  # fmt: skip
