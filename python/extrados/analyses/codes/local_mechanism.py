"""local-mechanism: facades, corners, gables, parapets, towers and any building's own mechanism by the rules of codes."""

from collections.abc import Callable

import numpy as np

from extrados.analyses.codes import ntc
from extrados.analyses.codes.code_checks import demanded_spectrum
from extrados.analyses.codes.code_rules import Line
from extrados.analyses.codes.kinematics import Capacity, capacity
from extrados.analyses.codes.mechanisms import overturning
from extrados.analyses.codes.tables import LocalMechanism
from extrados.analyses.context import Context, Refused
from extrados.building.geometry.assembly import Assembly
from extrados.building.rockers.mechanism import MechanismModel
from extrados.core.errors import CoreError
from extrados.limit.linkage import laden
from extrados.results import codes as out
from extrados.results.model import Array, Result, TableData
from extrados.schema.constants import GRAVITY

#: ASCE 41 height over thickness up to which no out-of-plane check is asked, for S_X1 up to 0.24 g, up to 0.37 g, above
SLENDER = {"one-story": (20, 16, 13), "first": (20, 18, 15), "top": (14, 14, 9), "other": (20, 16, 13)}
STEPS = 61


def run(context: Context, options: LocalMechanism) -> Result:
    """Multiplier, M*, a_0*, capacity curve, and the checks of the codes that apply."""
    material = context.building.material
    if options.mechanism == "building":
        found, curve, words = _of_building(context)
    else:
        body = overturning(options, material.density, material.compressive_strength)
        alpha0 = body.multiplier()
        weight, displacement = body.swaying
        end = body.ultimate()
        found = capacity(alpha0, weight, displacement, end)
        turned = np.linspace(0.0, end if end else 0.1, STEPS)
        scale = float(weight @ displacement**2) / float(weight @ displacement)
        curve = (turned * scale, np.array([body.multiplier(q) for q in turned]))
        words = f"the {options.mechanism}"
    if found.alpha0 <= 0.0:
        raise Refused(f"{words} does not stand at rest: its multiplier is {found.alpha0:.3g}")
    lines, more = _checks(context, options, found)
    a0 = found.acceleration / options.confidence_factor
    d0 = found.d0
    r = out.LocalMechanism(
        mechanism=options.mechanism, multiplier=found.alpha0, participating_mass_kg=found.mass, participating_part=found.part,
        activation_acceleration_g=a0 / GRAVITY, zero_displacement_m=d0,
        ultimate_displacement_m=None if d0 is None else ntc.SLV * d0, collapse_displacement_m=None if d0 is None else ntc.SLC * d0,
        equivalent_period_s=None if d0 is None else ntc.equivalent_period(a0, d0),
        swaying_weight_N=found.mass * GRAVITY / found.part,
        checks={x.rule: out.Check(capacity=x.capacity, demand=x.demand, unit=x.unit, verdict=x.verdict, source=x.source, note=x.note, code=x.code)
                for x in lines}, **more,
    )  # fmt: skip
    result = Result("local-mechanism", results=r)
    result.arrays = {
        "displacement": Array(curve[0], ("point",), "m", "d* of the equivalent oscillator"),
        "acceleration": Array(curve[1] * GRAVITY / (found.part * options.confidence_factor) / GRAVITY, ("point",), "g", "a* of the capacity curve"),
    }  # fmt: skip
    result.tables["local_mechanism"] = TableData({
        "rule": [x.rule for x in lines], "capacity": [x.capacity for x in lines],
        "demand": [np.nan if x.demand is None else x.demand for x in lines], "unit": [x.unit for x in lines],
        "verdict": [x.verdict for x in lines], "source": [x.source for x in lines],
    })  # fmt: skip
    limit = "" if d0 is None else f", and vanishes at d_0* = {d0:.3g} m"
    result.answer = (
        f"{words[:1].upper()}{words[1:]} starts at alpha_0 = {found.alpha0:.4g}; {100 * found.part:.3g} % of its swaying weight take part "
        f"(M* = {found.mass:.4g} kg), a_0* = {a0 / GRAVITY:.4g} g with FC {options.confidence_factor:g}{limit}. {r.overall().statement}"
    )
    return result


def _of_building(context: Context) -> tuple[Capacity, tuple[np.ndarray, np.ndarray], str]:
    """The weaker of both collapse mechanisms of the deck's stones, with its finite motion."""
    structure = context.building.structure
    if structure is None:
        raise Refused('mechanism = "building" needs a [structure]')
    stones: Assembly = context.building.blocks()
    model = MechanismModel(stones)
    side = int(np.argmin(model.uplift))
    mass, _, _ = laden(stones)
    try:
        table = model.tables[side]
    except CoreError as error:
        raise Refused(f"the mechanism cannot be carried through its motion: {error}") from None
    field = model.fields[side][:, 0] * (1.0, -1.0)[side]
    found = capacity(model.uplift[side], mass * GRAVITY, field, table.critical)
    turned = np.linspace(0.0, table.critical, STEPS)
    c = model.coefficients((1, -1)[side], turned)
    alpha = c.gravity_moment / (c.drive * GRAVITY)
    weight = mass * GRAVITY
    scale = abs(float(weight @ field**2) / float(weight @ field))
    return found, (turned * scale, np.abs(alpha)), f"the mechanism of the {structure.word}"


def _checks(context: Context, options: LocalMechanism, found: Capacity) -> tuple[list[Line], dict[str, float]]:
    spectrum = demanded_spectrum(context, options.spectrum, options.motion_spectrum)
    a_g = spectrum(0.0, 0.05) if spectrum is not None else None
    if options.peak_acceleration is not None:
        a_g = options.peak_acceleration
    q, height = options.behaviour_factor, options.building_height
    at_height = None
    if spectrum is not None and options.base_height > 0.0 and height is not None:
        at_height = ntc.floor(spectrum, options.base_height, height, options.storeys, options.building_period)
    note = f"alpha_0 {found.alpha0:.4g}, e* {found.part:.3g}, q {q:g}"
    if height is not None:
        note += f", z/H {options.base_height / height:.3g}"
    lines = ntc.checks(found.acceleration / options.confidence_factor, found.d0, q, a_g, spectrum, note, at_height)
    more = {} if at_height is None else {"floor_acceleration_g": at_height.acceleration / GRAVITY}
    if height is not None and options.base_height > 0.0 and a_g is not None:
        part = a_g / GRAVITY * (3.0 * (1.0 + options.base_height / height) / 2.0 - 0.5)
        lines.append(
            Line("EN 1998-1 part of a building", "S_a", found.alpha0 * q, part, "g",
                 "EN 1998-1:2004 4.3.5.2: S_a = a_g S (3 (1 + z/H)/(1 + (1 - T_a/T_1)^2) - 0.5), T_a = 0; q_a = q (verify clause)",
                 "rigid until it rocks", "EN 1998-1")
        )  # fmt: skip
    if options.one_second_acceleration is not None and options.thickness and options.height:
        s_x1 = options.one_second_acceleration / GRAVITY
        limit = SLENDER[options.storey][0 if s_x1 <= 0.24 else 1 if s_x1 <= 0.37 else 2]
        lines.append(
            Line("ASCE 41 slenderness", "h/t", float(limit), (options.height - options.hinge_height) / options.thickness, "",
                 "ASCE 41-13 Table 11-5 (verify clause)", f"{options.storey}, S_X1 {s_x1:.3g} g", "ASCE 41")
        )  # fmt: skip
    if options.mechanism in ("parapet", "wall", "gable") and options.thickness and options.height:
        lines.append(_nzsee(options, spectrum))
    return lines, more


def _nzsee(options: LocalMechanism, spectrum: Callable[[float, float], float] | None) -> Line:
    """A vertical cantilever: displacement of the top at 0.3 of instability, gamma = 1.5/(1 + (t/h)^2)."""
    h, t = float(options.height or 0.0) - options.hinge_height, float(options.thickness or 0.0)
    slope = 1.0 + (t / h) ** 2
    period = float(np.sqrt(0.65 * h * slope))
    demand = None if spectrum is None else 1.5 / slope * spectrum(period, 0.05) * (period / (2.0 * np.pi)) ** 2
    return Line("NZSEE C8 cantilever", "displacement", 0.3 * t, demand, "m",
                "NZSEE/MBIE 2017 C8.8.5: D_m = 0.3 D_i, D_i = t, T_p = sqrt(0.65 h (1 + (t/h)^2)), gamma = 1.5/(1 + (t/h)^2), as a part on "
                "the ground (verify clause)", f"T_p {period:.3f} s", "NZSEE")  # fmt: skip
