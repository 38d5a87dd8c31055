"""local-mechanism: facades, corners, gables, parapets, towers and any building's own mechanism by the rules of codes."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from extrados.analyses.codes import ntc
from extrados.analyses.codes.code_checks import demanded_spectrum, spectrum_of
from extrados.analyses.codes.code_rules import Line
from extrados.analyses.codes.kinematics import Capacity, Overturning, capacity
from extrados.analyses.codes.mechanisms import overturning
from extrados.analyses.codes.tables import LocalMechanism
from extrados.analyses.codes.walls import WallPart, wall_parts
from extrados.analyses.context import Context, Refused
from extrados.analyses.limit.common import limit_of
from extrados.analyses.limit.tables import Tilt
from extrados.building.errors import WHOLE
from extrados.building.geometry.assembly import Assembly
from extrados.building.rockers.mechanism import MechanismModel
from extrados.building.rockers.restraints import Restraints, members_of
from extrados.building.templates.plan import Plan
from extrados.core.errors import CoreError
from extrados.core.restraints import FREE
from extrados.limit.linkage import laden
from extrados.results import codes as out
from extrados.results.limit import DILATANT
from extrados.results.model import Array, Result, TableData
from extrados.schema.constants import GRAVITY

#: ASCE 41 height over thickness up to which no out-of-plane check is asked, for S_X1 up to 0.24 g, up to 0.37 g, above
SLENDER = {"one-story": (20, 16, 13), "first": (20, 18, 15), "top": (14, 14, 9), "other": (20, 16, 13)}
STEPS = 61


@dataclass(frozen=True)
class _Turning:
    """A mechanism: its capacity, its curve (displacement [m], multiplier), in words, and the keys that its checks take."""

    found: Capacity
    curve: tuple[np.ndarray, np.ndarray]
    words: str
    options: LocalMechanism
    part: WallPart | None = None


def run(context: Context, options: LocalMechanism) -> Result:
    """Multiplier, M*, a_0*, capacity curve, and the checks of the codes that apply."""
    material = context.building.material
    if options.mechanism == "building" and isinstance(context.building.structure, Plan):
        return _walls(context, options)
    if options.mechanism == "building":
        turning = _Turning(*_of_building(context), options)
    else:
        if options.mechanism == "corner" and material.compressive_strength is not None:
            context.warnings.append("a corner turns about its outer edge, as if the stone did not crush there")
        body = overturning(options, material.density, material.compressive_strength)
        turning = _body(body, f"the {options.mechanism}", options)
    found = turning.found
    if found.alpha0 <= 0.0:
        raise Refused(
            f"{turning.words} does not stand at rest: its multiplier is {found.alpha0:.3g}", ("analysis", "mechanism")
        )
    if found.d0 is None and found.alone <= 0.0:
        context.warnings.append(
            "without its ties it would not stand at rest: the nonlinear check, which does not count on them, is left out"
        )
    lines, more = _checks(context, turning.options, found)
    return _result(turning, _results(turning, lines, more), lines)


def _body(body: Overturning, words: str, options: LocalMechanism, part: WallPart | None = None) -> _Turning:
    """A body that turns about a hinge."""
    weight, displacement = body.swaying
    end, alone = body.ultimate(), body.alone
    found = capacity(body.multiplier(), weight, displacement, alone.ultimate(), alone.multiplier())
    turned = np.linspace(0.0, end if end else 0.1, STEPS)
    scale = float(weight @ displacement**2) / float(weight @ displacement)
    return _Turning(found, (turned * scale, np.array([body.multiplier(q) for q in turned])), words, options, part)


def _walls(context: Context, options: LocalMechanism) -> Result:
    """Every wall of a building on a plan, above the foot of each of its storeys; that with the least margin stands for all,
    where nothing is asked that with the least a_0*."""
    plan = context.building.structure
    assert isinstance(plan, Plan)
    rows = []
    for part in wall_parts(context.building):
        own = options.model_copy(
            update={
                "base_height": part.foot,
                "building_height": float(plan.levels[-1]),
                "storeys": len(plan.storeys),
            }
        )
        above = "" if part.storey == 1 else f" above the foot of storey {part.storey}"
        turning = _body(part.body, f"wall {part.wall}{above}", own, part)
        lines, more = _checks(context, own, turning.found)
        r = _results(turning, lines, more)
        governing = r.governing()
        rows.append((governing[0][0] if governing else None, r, turning, lines))
    context.warnings = list(dict.fromkeys(context.warnings))  # what goes for one wall goes for the others
    rows.sort(key=lambda row: (row[0] is None, row[0] or 0.0, row[1].activation_acceleration_g))
    _, worst, turning, lines = rows[0]
    walls = [
        out.WallMechanism(
            wall=t.part.wall, storey=t.part.storey, foot_m=t.part.foot, multiplier=r.multiplier,
            activation_acceleration_g=r.activation_acceleration_g, zero_displacement_m=r.zero_displacement_m, margin=margin,
        ) for margin, r, t, _ in rows if t.part is not None
    ]  # fmt: skip
    worst = worst.model_copy(update={"walls": walls})
    result = _result(turning, worst, lines)
    result.tables["walls"] = TableData(
        {
            name: [np.nan if (v := getattr(row, name)) is None else v for row in walls]
            for name in out.WallMechanism.model_fields
        }
    )
    result.answer += (
        f" It is the weakest of {len(rows)} parts of {len(plan.walls)} walls, each taken apart from the walls across it; flexible floors, "
        "joists and rods hold none, rigid floors and props do."
    )
    if plan.rods:
        context.warnings.append(
            "rods are left out: the deck does not say what their anchorage bears; give it to a `facade` of its own as `ties`"
        )
    return result


def _results(turning: _Turning, lines: list[Line], more: dict[str, float]) -> out.LocalMechanism:
    found, options = turning.found, turning.options
    d0, fc = found.d0, options.confidence_factor
    return out.LocalMechanism(
        mechanism=options.mechanism, multiplier=found.alpha0, participating_mass_kg=found.mass, participating_part=found.part,
        activation_acceleration_g=found.acceleration / fc / GRAVITY, zero_displacement_m=d0,
        ultimate_displacement_m=None if d0 is None else ntc.SLV * d0, collapse_displacement_m=None if d0 is None else ntc.SLC * d0,
        equivalent_period_s=None if d0 is None else ntc.equivalent_period(found.alone / fc, d0),
        swaying_weight_N=found.mass * GRAVITY / found.part,
        checks={x.rule: out.Check(capacity=x.capacity, demand=x.demand, unit=x.unit, verdict=x.verdict, source=x.source, note=x.note, code=x.code)
                for x in lines}, **more,
    )  # fmt: skip


def _result(turning: _Turning, r: out.LocalMechanism, lines: list[Line]) -> Result:
    """Results with arrays, table and answer."""
    found, curve, words, fc = turning.found, turning.curve, turning.words, turning.options.confidence_factor
    result = Result("local-mechanism", results=r)
    result.arrays = {
        "displacement": Array(curve[0], ("point",), "m", "d* of the equivalent oscillator"),
        "acceleration": Array(curve[1] * GRAVITY / (found.part * fc) / GRAVITY, ("point",), "g", "a* of the capacity curve"),
    }  # fmt: skip
    result.tables["local_mechanism"] = TableData({
        "rule": [x.rule for x in lines], "capacity": [x.capacity for x in lines],
        "demand": [np.nan if x.demand is None else x.demand for x in lines], "unit": [x.unit for x in lines],
        "verdict": [x.verdict for x in lines], "source": [x.source for x in lines],
    })  # fmt: skip
    d0 = found.d0
    limit = "" if d0 is None else f", and vanishes at d_0* = {d0:.3g} m"
    result.answer = (
        f"{words[:1].upper()}{words[1:]} starts at alpha_0 = {found.alpha0:.4g}; {100 * found.part:.3g} % of its swaying weight take part "
        f"(M* = {found.mass:.4g} kg), a_0* = {r.activation_acceleration_g:.4g} g with FC {fc:g}{limit}. {r.overall().statement}"
    )
    return result


def _of_building(context: Context) -> tuple[Capacity, tuple[np.ndarray, np.ndarray], str]:
    """The weaker of the collapse mechanisms of the deck's stones that no wall stops, with its finite motion."""
    building = context.building
    assert building.structure is not None
    stones: Assembly = building.blocks()
    model = MechanismModel(stones)
    mass, _, _ = laden(stones)
    weight = mass * GRAVITY
    reach = tuple((float(t.numbers[2]), float(t.numbers[3])) for t in model.tables)
    held = Restraints(members_of(building, stones, model.linkages), model.linkages, (reach[0], reach[1]))
    wall = building.supports.abutting_wall
    curves = {}
    for side in (k for k, against in enumerate(("right", "left")) if wall != against):
        try:
            table = model.tables[side]
        except CoreError as error:
            raise Refused(f"the mechanism cannot be carried through its motion: {error}", WHOLE) from None
        turned = np.linspace(0.0, table.critical, STEPS)
        c = model.coefficients((1, -1)[side], turned)
        drive = np.abs(c.drive) * GRAVITY
        curves[side] = (turned, (np.abs(c.gravity_moment) + _held(held, side, turned)) / drive, table.critical)
    side = min(curves, key=lambda k: float(curves[k][1][0]))
    turned, alpha, critical = curves[side]
    if held.members and len(stones.mass) > 1:
        context.warnings.append(
            "the mechanism is the one without ties, dampers and added hinges, which then hold it: an upper bound"
        )
    words = f"the mechanism of the {building.structure.word}"
    weaker = _weaker(context, tuple(curves), float(alpha[0]))
    if weaker is not None:
        multiplier, field, slides = weaker
        why, without = "limit analysis finds a weaker mechanism", "it"
        if slides:
            why, without = (
                f"its joints slide, at a friction of {building.joints.friction} ({DILATANT}),",
                "sliding",
            )
        elif building.material.compressive_strength is not None:
            why, without = "its stones crush at the hinges", "crushing"
        context.warnings.append(
            f"{why} before it turns (multiplier {float(alpha[0]):.4g} without {without}): the displacement that it bears is not known"
        )
        return (
            capacity(multiplier, weight, field, None),
            (np.zeros(1), np.array([multiplier])),
            f"{words}, which {'slides' if slides else 'crushes'}," if without != "it" else words,
        )
    field = model.fields[side][:, 0] * (1.0, -1.0)[side]
    found = capacity(float(alpha[0]), weight, field, critical, model.uplift[side])
    scale = abs(float(weight @ field**2) / float(weight @ field))
    return found, (turned * scale, alpha), words


def _weaker(context: Context, sides: tuple[int, ...], turning: float) -> tuple[float, np.ndarray, bool] | None:
    """Multiplier of limit analysis with the deck's friction and compressive strength, the sideways velocities of its mechanism,
    and whether joints slide in it; None where neither makes it less than `turning`, that of the mechanism which turns."""
    building = context.building
    stones = building.blocks()
    mass, place, _ = laden(stones)
    limit = limit_of(building, Tilt(kind="tilt"))
    found = []
    for side in sides:
        state, mechanism = limit.collapse((1, -1)[side])
        move = mechanism.velocity
        sideways = move[:, 0] - move[:, 2] * (place - stones.centroid)[:, 1]
        found.append((abs(state.gamma), sideways, bool(len(mechanism.sliding))))
    multiplier, sideways, slides = min(found, key=lambda one: one[0])
    if multiplier > 0.99 * turning:
        return None
    return multiplier, sideways * np.sign(mass @ sideways), slides


def _held(held: Restraints, side: int, rotation: np.ndarray) -> np.ndarray:
    """Moment [N m] at each rotation by which ties, slipping dampers and hinges hold it back, all at what they bear."""
    if not held.members:
        return np.zeros(len(rotation))
    _, slope = held.paths(side, rotation)
    moment = np.zeros(len(rotation))
    for k, member in enumerate(held.members):
        law = member.law
        bound = np.where(slope[:, k] > 0.0, law.most, -law.least) if law.stiffness > 0.0 else np.zeros(len(rotation))
        if (bound >= FREE).any():
            raise Refused(f"{member.name} never yields: give the force that its anchorage bears", ("ties",))
        moment += bound * np.abs(slope[:, k])
    return moment


def _checks(context: Context, options: LocalMechanism, found: Capacity) -> tuple[list[Line], dict[str, float]]:
    spectrum = demanded_spectrum(context, options.spectrum, options.motion_spectrum)
    a_g = spectrum(0.0, 0.05) if spectrum is not None else None
    if options.peak_acceleration is not None:
        a_g = options.peak_acceleration
    q = options.behaviour_factor
    height = (
        options.building_height if options.base_height > 0.0 else None
    )  # of the building, where the part stands in it
    at_height = None
    if height is not None and spectrum is not None:
        at_height = ntc.floor(spectrum, options.base_height, height, options.storeys, options.building_period)
    elif height is not None and a_g is not None:
        context.warnings.append(
            f"at {options.base_height:g} m above the foundation the checks of NTC ask how the building answers at its period: without "
            "a spectrum they have no demand"
        )
    note = f"alpha_0 {found.alpha0:.4g}, e* {found.part:.3g}, q {q:g}"
    if height is not None:
        note += f", z/H {options.base_height / height:.3g}"
    fc = options.confidence_factor
    lines = ntc.checks(
        found.acceleration / fc, found.d0, q, a_g, spectrum, note, at_height, found.alone / fc, height is not None
    )
    if options.collapse_spectrum is not None and found.d0 is not None:
        rare, above = spectrum_of(context, options.collapse_spectrum, "collapse_spectrum"), None
        if height is not None:
            above = ntc.floor(rare, options.base_height, height, options.storeys, options.building_period)
        lines.append(ntc.collapse_check(found.alone / fc, found.d0, rare, above))
    more = {} if at_height is None else {"floor_acceleration_g": at_height.acceleration / GRAVITY}
    if height is not None and a_g is not None:
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
