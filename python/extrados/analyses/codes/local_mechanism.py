"""local-mechanism: facades, corners, gables, parapets, towers and any building's own mechanism by the rules of codes."""

from dataclasses import dataclass, replace

import numpy as np

from extrados.analyses.codes import ntc
from extrados.analyses.codes.actions import Action, Spectrum, actions, apart, code_of, dated, floor_below
from extrados.analyses.codes.bending import Bending
from extrados.analyses.codes.code_rules import Line, table
from extrados.analyses.codes.kinematics import Capacity, NoMechanism, Overturning, capacity, in_chain, spectral
from extrados.analyses.codes.mechanisms import FREE_TO_VIBRATE, body_of
from extrados.analyses.codes.parts import Part, asce41, en1998, nzsee
from extrados.analyses.codes.sections import body_outlines, plan_outlines
from extrados.analyses.codes.tables import LocalMechanism
from extrados.analyses.codes.walls import WallPart, wall_parts
from extrados.analyses.context import Context, Refused
from extrados.analyses.limit.common import collapse_beside, limit_of, packed
from extrados.analyses.limit.tables import Tilt
from extrados.core import mechanism as core_mechanism
from extrados.core.restraints import FREE
from extrados.limit.answer import cannot_stand
from extrados.limit.certificate import certify
from extrados.limit.errors import CannotStand, Immovable, NoAnswer, NoEquilibrium
from extrados.limit.linkage import laden
from extrados.limit.programme import LimitAnalysis, Mechanism
from extrados.model.geometry.assembly import GROUND, Assembly
from extrados.model.structures.plan import Plan
from extrados.model.ties import Tie
from extrados.results import codes as out
from extrados.results.fields import Keys, given
from extrados.results.limit import DILATANT, SAME
from extrados.results.model import Array, Result, TableData
from extrados.results.verdict import Bound
from extrados.schema.constants import GRAVITY
from extrados.schema.quantities import three_figures
from extrados.schema.table import FloorBelow, storeys_in
from extrados.views.building import Building
from extrados.views.rockers.mechanism import MechanismModel, NoMotion
from extrados.views.rockers.restraints import Restraints, members_of

STEPS = 61
#: Limit analysis with friction, strength and ties finds another mechanism where its multiplier is less than this share
WEAKER = 0.99
#: e* by stones and by rigid links that differ by less than this share are alike
ALIKE = 0.02


@dataclass(frozen=True)
class _Turning:
    """A mechanism: its capacity, its curve (displacement d* [m], multiplier), in words, its place z and H [m] (None: at the
    ground), and what of its multiplier is known to be above the exact one; links: its capacity with one weight for each rigid link of the
    chain [C8.7.1.1], where that differs from the one by stones; slides: whether pressed joints slide; associated: where they do and `found` is of the least state without
    dilatancy, the capacity by dilatant friction, an upper bound."""

    found: Capacity
    curve: tuple[np.ndarray, np.ndarray]
    words: str
    place: tuple[float, float | None]
    bound: Bound | None = None
    part: WallPart | None = None
    body: Overturning | Bending | None = None
    links: Capacity | None = None
    slides: bool = False
    associated: Capacity | None = None


def confidence(context: Context, options: LocalMechanism) -> float:
    """FC: of the analysis; else of the code, which is that of LC1 by NTC where crushing is neglected (C8.7.1.2.1.3)."""
    code = code_of(context)
    if options.confidence_factor is not None:
        return options.confidence_factor
    if code.jurisdiction == "NTC" and context.building.material.compressive_strength is None:
        return ntc.LC1
    return code.factor if code.jurisdiction == "NTC" else 1.0


@dataclass(frozen=True)
class _Judged:
    """A mechanism with its checks and results."""

    turning: _Turning
    lines: list[Line]
    results: out.LocalMechanism

    @property
    def margin(self) -> float | None:
        """Capacity over demand of the check that governs."""
        governing = self.results.governing()
        return governing[0][0] if governing else None


def run(context: Context, options: LocalMechanism) -> Result:
    """Multiplier, M*, a_0*, capacity curve, and the checks of the codes that apply, of the mechanism of least margin."""
    building, on_plan = context.building, False
    if (below := floor_below(context)) is not None:
        options = _on_floor(options, below)
    if options.mechanism == "building":
        on_plan = isinstance(building.structure, Plan)
        try:
            turnings = _of_plan(context) if on_plan else _of_stones(context, options)
        except (NoMechanism, Immovable) as error:
            none = out.NoLocalMechanism(reason=str(error))
            return Result("local-mechanism", results=none, answer=none.statement())
    else:
        if options.mechanism == "corner" and building.material.compressive_strength is not None:
            context.warnings.append("The corner is assumed to overturn about its outer edge without crushing.")
        body = body_of(options, building.material.density, building.material.compressive_strength)
        z = options.hinge_height if options.base_height is None else options.base_height
        z += 0.0 if below is None or options.base_height is not None else below.height
        turnings = [_body(body, f"the {options.mechanism}", (z, (options.building_height or options.height) if z else None))]
    for turning in turnings:
        _refuse_fallen(turning)
    judged = [_judged(context, options, turning) for turning in turnings]
    context.warnings = list(dict.fromkeys(context.warnings))  # what goes for one goes for the others
    judged.sort(key=lambda j: (np.inf if (least := j.results.least()) is None else least, j.results.activation_acceleration_g))
    result = _of_walls(context, judged) if on_plan else _result(judged[0])
    result.arrays |= _drawn(building, options, None if on_plan else judged[0].turning.body)
    return result


def _drawn(building: Building, options: LocalMechanism, body: Overturning | Bending | None) -> dict[str, Array]:
    """What the picture shows: the bodies that turn, or the walls of a plan; nothing of stones, which limit analysis draws."""
    if body is not None:
        rest, turned, hinge = body_outlines(options, body)
        return {
            **packed("section", rest, "m", "outlines of the bodies of the mechanism, at rest"),
            **packed("section_turned", turned, "m", "bodies of the mechanism, at the rotation that is drawn"),
            "section_hinge": Array(hinge, ("section_hinges", "axis"), "m", "hinges of the mechanism, at the rotation that is drawn"),
        }
    if isinstance(building.structure, Plan):
        return packed("plan_wall", plan_outlines(building.structure), "m", "walls on the plan")
    return {}


def _on_floor(options: LocalMechanism, below: FloorBelow) -> LocalMechanism:
    """The table of a mechanism whose structure stands on a floor: the building is that of the motion."""
    given = options.model_fields_set
    own = {"building_height": below.building_height, "building_period": below.building_period, "storeys": below.levels}
    unused = {"building_period", "storeys"} if options.modes else set()
    return options.model_copy(update={k: v for k, v in own.items() if k not in given | unused})


def _refuse_fallen(turning: _Turning) -> None:
    """CannotStand where the weights and thrusts of a mechanism drive it at rest, which is the proof."""
    if turning.found.alpha0 > 0.0:
        return
    work = "" if turning.body is None else f": these do a work of {-turning.body.work() / 1e3:.3g} kNm per radian, without resistance"
    raise CannotStand(
        f"{turning.words} has a multiplier of {turning.found.alpha0:.3g} at rest; certificate: weights and thrusts move "
        f"the mechanism{work}",
        neglects=(),
    )


def _body(body: Overturning | Bending, words: str, place: tuple[float, float | None], part: WallPart | None = None) -> _Turning:
    """A body that turns about a hinge."""
    weight, displacement = body.swaying
    end, alone = body.ultimate(), body.alone
    last = alone.ultimate()
    found = capacity(body.multiplier(), weight, displacement, float(body.travel(last)) if last else None, alone.multiplier())
    turned = np.linspace(0.0, end if end else 0.1, STEPS)
    moved = np.asarray(spectral(weight, displacement, body.travel(turned)))
    return _Turning(found, (moved, np.array([body.multiplier(q) for q in turned])), words, place, None, part, body)


def _of_plan(context: Context) -> list[_Turning]:
    """Every wall of a building on a plan, above the foot of each of its storeys."""
    plan = context.building.structure
    assert isinstance(plan, Plan)
    found = []
    for part in wall_parts(context.building):
        place = (part.foot, float(plan.levels[-1]) if part.foot > 0.0 else None)
        found.append(_body(part.body, part.words, place, part))
    return found


def _of_walls(context: Context, judged: list[_Judged]) -> Result:
    """The walls of a plan, the worst of which stands for all."""
    plan = context.building.structure
    assert isinstance(plan, Plan)
    walls = [
        out.WallMechanism(
            wall=t.part.wall,
            gable=t.part.gable,
            storey=t.part.storey,
            foot_m=t.part.foot,
            multiplier=r.multiplier,
            activation_acceleration_g=r.activation_acceleration_g,
            zero_displacement_m=r.zero_displacement_m,
            margin=j.margin,
        )
        for j in judged
        if (t := j.turning).part is not None and (r := j.results)
    ]
    worst = _Judged(judged[0].turning, judged[0].lines, judged[0].results.model_copy(update={"walls": walls}))
    result = _result(worst)
    result.tables["walls"] = TableData(
        {name: [np.nan if (v := getattr(row, name)) is None else v for row in walls] for name in out.WallMechanism.model_fields}
    )
    result.answer += (
        f" This part is the weakest of {len(judged)} parts of {len(plan.walls)} walls. Each part is considered separately from the "
        "transverse walls. Only rigid floors and props restrain the walls; flexible floors, joists, rods and floors with a seat do not."
    )
    context.warnings += plan.floor_remarks
    if plan.rods:
        context.warnings.append(
            "Rods are neglected, because the deck does not give the strength of their anchorage. To include "
            'a rod, give its strength as `ties` of a separate analysis with mechanism = "facade".'
        )
    if plan.ring_beams:
        context.warnings.append(
            "Ring beams are neglected, because the deck does not give the strength of their connection to the walls. A wall with a ring "
            "beam has a greater multiplier. If the top of a wall is restrained, give [[structure.props]]."
        )
    return result


def _judged(context: Context, options: LocalMechanism, turning: _Turning) -> _Judged:
    """The checks of a mechanism, and its results."""
    found, (z, building), code = turning.found, turning.place, code_of(context)
    d0, fc = found.d0, confidence(context, options)
    if d0 is None and found.alone <= 0.0:
        context.warnings.append(
            "The nonlinear check neglects ties, but this body has no equilibrium without ties. The nonlinear check is therefore not made."
        )
    structure = context.building.structure
    storeys = len(structure.storeys) if isinstance(structure, Plan) else options.storeys or storeys_in(building or 0.0)
    lines, more = _checks(context, options, turning, storeys, fc)
    violated = []
    if code.jurisdiction == "NTC" and fc < ntc.LC1 and context.building.material.compressive_strength is None:
        violated.append(ntc.below_lc1(fc))
    if options.mechanism in FREE_TO_VIBRATE and not z:
        violated.append(
            f"The demand is the ground acceleration, but a {options.mechanism} is part of a building, which "
            "amplifies the motion. Give `base_height` and `building_height`."
        )
    made = out.LocalMechanism(
        mechanism=options.mechanism,
        multiplier=found.alpha0,
        participating_mass_kg=found.mass,
        participating_part=found.part,
        activation_acceleration_g=found.acceleration / fc / GRAVITY,
        zero_displacement_m=d0,
        ultimate_displacement_m=None if d0 is None else ntc.SLV * d0,
        collapse_displacement_m=None if d0 is None else ntc.SLC * d0,
        equivalent_period_s=None if d0 is None else ntc.equivalent_period(found.alone / fc, d0),
        swaying_weight_N=found.weight,
        base_height_m=z,
        confidence_factor=fc,
        behaviour_factor=options.behaviour_factor,
        **given(building_height_m=building, bound=turning.bound, violated=violated or None),
        checks={x.rule: x.check() for x in lines},
        jurisdiction=code.jurisdiction,
        code=code.name,
        by_default=context.deck.code is None,
        clause="",
        **more,
    )
    made = made.model_copy(update=made.concluded())

    def by(other: Capacity) -> out.LocalMechanism:
        """The results by the checks of another capacity."""
        told = list(context.warnings)
        rows, _ = _checks(context, options, replace(turning, found=other), storeys, fc)
        context.warnings = told
        return made.model_copy(update={"checks": {x.rule: x.check() for x in rows}})

    if turning.associated is not None:
        governing = by(turning.associated).governing()
        made = made.model_copy(
            update={"multiplier_associated": turning.associated.alpha0, "margin_associated": governing[0][0] if governing else None}
        )
    if turning.links is not None and made.overall().outcome == "stands":
        if by(turning.links).overall().outcome != "stands":
            violated.append(
                f"If each rigid link counts as one weight [C8.7.1.1], e* is {turning.links.part:.3g} and the check fails: the "
                "verdict depends on how the links are divided into blocks."
            )
            made = made.model_copy(update={"violated": violated})
    return _Judged(turning, lines, made)


def _result(judged: _Judged) -> Result:
    """Results with arrays, table and answer."""
    r, found, curve, words = judged.results, judged.turning.found, judged.turning.curve, judged.turning.words
    fc = r.confidence_factor
    result = Result("local-mechanism", results=r)
    result.arrays = {
        "displacement": Array(curve[0], ("point",), "m", "d* of the equivalent oscillator"),
        "acceleration": Array(curve[1] / (found.part * fc), ("point",), "g", "a* of the capacity curve"),
    }
    result.tables["local_mechanism"] = table(judged.lines)
    d0 = found.d0
    limit = "" if d0 is None else f"; the capacity becomes zero at d_0* = {d0:.3g} m"
    result.answer = (
        f"{words[:1].upper()}{words[1:]} starts at alpha_0 = {found.alpha0:.3g}. The kinematic chain weighs {three_figures(found.weight / 1000.0)} "
        f"kN, of which {100 * found.part:.3g} % participate (M* = {three_figures(found.mass)} kg). The "
        f"acceleration a_0* is {r.activation_acceleration_g:.3g} g with FC {fc:g}{limit}. {r.overall().statement}"
    )
    return result


def _of_stones(context: Context, options: LocalMechanism) -> list[_Turning]:
    """The collapse mechanisms of the deck's stones to the sides that no wall stops, with their finite motion."""
    building = context.building
    stones: Assembly = building.blocks()
    building.refuse_weightless(stones)
    model = MechanismModel(stones)
    wall = building.supports.abutting_wall
    sides = [k for k, against in enumerate(("right", "left")) if wall != against]
    try:
        reach = tuple((float(t.numbers[2]), float(t.numbers[3])) for t in model.tables)
    except NoMotion as error:
        if not all(isinstance(r, Tie) for r in building.restraints):
            raise
        context.warnings.append(f"d_0* and the nonlinear checks are not given: {error}")
        return _at_rest_to(context, options, sides)
    held = Restraints(members_of(building, stones, model.linkages), model.linkages, (reach[0], reach[1]))
    return [_side(context, options, model, held, side) for side in sides]


def _at_rest_to(context: Context, options: LocalMechanism, sides: list[int]) -> list[_Turning]:
    """The mechanisms at rest to those sides to which one exists; Immovable where to none."""
    found, locked = [], []
    for side in sides:
        try:
            found.append(_at_rest(context, options, side))
        except Immovable as error:
            locked.append(error)
    if not found:
        raise locked[0]
    return found


def _side(context: Context, options: LocalMechanism, model: MechanismModel, held: Restraints, side: int) -> _Turning:
    """The mechanism to side 0 (+x) or 1 (-x): that which turns, or a weaker one that limit analysis finds."""
    building, stones = context.building, model.assembly
    mass, _, _ = laden(stones)
    weight = mass * GRAVITY
    one, sense = model.linkages[side], (1.0, -1.0)[side]
    turned = np.linspace(0.0, model.tables[side].critical, STEPS)
    c = model.coefficients((1, -1)[side], turned)
    alpha = (np.abs(c.gravity_moment) + _held(held, side, turned)) / (np.abs(c.drive) * GRAVITY)
    if (weaker := _weaker(context, options, side, float(alpha[0]))) is not None:
        return weaker
    field = sense * model.fields[side]
    chain = in_chain(field, stones.size)
    moving = weight[chain], field[chain, 0]
    parts = core_mechanism.follow(one, turned)[0][:, :, 0]
    travel = sense * ((parts - parts[0]) @ one.mass) * GRAVITY / float(moving[0] @ moving[1])
    found = capacity(float(alpha[0]), *moving, float(travel[-1]), model.uplift[side])
    of_links = one.mass * GRAVITY, sense * core_mechanism.follow(one, [0.0])[1][0, :, 0]
    carried = sense * float((parts[-1] - parts[0]) @ one.mass) * GRAVITY / float(of_links[0] @ of_links[1])
    links = capacity(found.alpha0, *of_links, carried, model.uplift[side])
    differ = abs(links.part / found.part - 1.0) > ALIKE
    if differ:
        context.warnings.append(
            f"In e*, each block counts as one weight: e* is {found.part:.3g}. If each of the {len(one.mass)} rigid links of "
            f"the chain counts as one weight, as [C8.7.1.1] defines P_k, e* is {links.part:.3g}, and a_0* changes by "
            f"{100.0 * (found.part / links.part - 1.0):+.0f} %."
        )
    # only limit analysis looks for the mechanism that ties leave; dampers and added hinges it does not know
    bound: Bound | None = None if all(isinstance(r, Tie) for r in building.restraints) else "upper"
    if bound:
        context.warnings.append(
            "The mechanism was found without dampers and added hinges, although these resist it. Its multiplier is then an upper bound."
        )
    return _Turning(
        found,
        (np.asarray(spectral(*moving, travel)), alpha),
        _words(building),
        _place(context, stones, chain, options),
        bound,
        links=links if differ else None,
    )


def _words(building: Building) -> str:
    assert building.structure is not None
    return f"the mechanism of the {building.structure.word}"


def _weaker(context: Context, options: LocalMechanism, side: int, turning: float) -> _Turning | None:
    """The mechanism that limit analysis finds, None where its multiplier is not less than `turning`, that of the one which turns."""
    told = list(context.warnings)
    try:
        found = _at_rest(context, options, side)
    except Immovable:
        return None
    if found.found.alpha0 > WEAKER * turning:
        context.warnings = told
        return None
    building = context.building
    why, without = "Limit analysis finds a mechanism with a lower multiplier", "that mechanism"
    if found.slides:
        why, without = f"Joints slide at a friction coefficient of {building.joints.friction}", "sliding"
    elif building.material.compressive_strength is not None:
        why, without = "Blocks crush at the hinges", "crushing"
        found = replace(found, words=f"{found.words}, which crushes,")
    context.warnings.append(
        f"{why} before the rigid-body mechanism starts. Without {without}, the multiplier of this mechanism would be "
        f"{turning:.3g}. The displacement capacity is therefore not known."
    )
    return found


def _at_rest(context: Context, options: LocalMechanism, side: int) -> _Turning:
    """The mechanism to side 0 (+x) or 1 (-x) by limit analysis with the deck's friction, compressive strength and ties, as it
    begins: its finite motion is not known. CannotStand where the building collapses under its own weight.

    Where joints slide: the least certified state without dilatancy, with the capacity by dilatant friction beside it; where no such
    state is known the latter alone, an upper bound."""
    building = context.building
    stones: Assembly = building.blocks()
    limit, sense = limit_of(building, Tilt(kind="tilt")), (1, -1)[side]
    try:
        state, mechanism = limit.collapse(sense)
    except Immovable:
        raise
    except NoEquilibrium:
        raise cannot_stand(limit) from None
    multiplier = sense * state.gamma
    if multiplier <= 0.0:
        raise cannot_stand(limit)
    found, chain = _capacity_at_rest(stones, multiplier, mechanism)
    bound: Bound | None = None
    associated, words = None, _words(building)
    slides = bool(limit.dilating(mechanism))
    if slides:
        words = f"{words}, which slides,"
        try:
            least, motion = _without_dilatancy(limit, sense)
        except (NoAnswer, NoEquilibrium) as error:
            bound = "upper"
            context.warnings.append(f"Joints slide, so the multiplier is an {DILATANT}. Collapse without dilatancy is not given: {error}.")
        else:
            associated = found
            found, chain = _capacity_at_rest(stones, least, motion)
            if least > (1.0 - SAME) * multiplier:
                associated = None
            else:
                context.warnings.append(
                    f"Joints slide: the multiplier lies between {least:.3g} (lowest value found without dilatancy) and "
                    f"{multiplier:.3g} ({DILATANT}). The checks use the lower value."
                )
    return _Turning(
        found,
        (np.zeros(1), np.array([found.alpha0])),
        words,
        _place(context, stones, chain, options),
        bound,
        slides=slides,
        associated=associated,
    )


def _capacity_at_rest(stones: Assembly, multiplier: float, mechanism: Mechanism) -> tuple[Capacity, np.ndarray]:
    """The capacity of a mechanism that begins at a multiplier, and which blocks move in it (blocks)."""
    mass, place, _ = laden(stones)
    field, arm = mechanism.velocity.copy(), place - stones.centroid
    field[:, :2] += field[:, 2, None] * np.column_stack([-arm[:, 1], arm[:, 0]])
    field *= np.sign(mass @ field[:, 0])
    chain = in_chain(field, stones.size)
    return capacity(multiplier, mass[chain] * GRAVITY, field[chain, 0], None), chain


def _without_dilatancy(limit: LimitAnalysis, sense: int) -> tuple[float, Mechanism]:
    """The least multiplier found to side `sense` by sliding that does not dilate, above 0 and certified, and its mechanism; NoAnswer
    where none is known."""
    state, mechanism = collapse_beside(limit.without_dilatancy(), sense)
    least = sense * state.gamma
    if least <= 0.0:
        raise NoAnswer("a block that is carried only by friction between its neighbours slides out at any load")
    assert limit.friction is not None  # blocks that cannot slide have no such state
    proof = certify(limit.assembly, limit.loads, limit.friction, state, mechanism, limit.strength)
    if not proof.holds(state.gamma):
        raise NoAnswer(
            f"the state found is not certified (the loads from its forces and from its mechanism differ by {proof.zero_gap:.1e} g)"
        )
    return least, mechanism


def _place(context: Context, stones: Assembly, chain: np.ndarray, options: LocalMechanism) -> tuple[float, float | None]:
    """z and H [m]: of the deck, else of the lowest joint between the chain and what stays at rest, and of the top of all, above the
    lowest support; a mechanism that reaches the ground stands on it."""
    moves = np.append(chain, False)  # GROUND = -1 is the last
    border = moves[stones.a] != moves[stones.b]
    grounded = (stones.a == GROUND) | (stones.b == GROUND)
    low = np.minimum(stones.p[:, 1], stones.q[:, 1])
    foundation = float(low[grounded].min())
    z, top = 0.0, max(float(outline[:, 1].max()) for outline in stones.outlines) - foundation
    if not (border & grounded).any():
        z = float(low[border].min()) - foundation
    if (below := floor_below(context)) is not None:
        z += below.height
    if options.base_height is not None:
        z = options.base_height
    return z, (options.building_height or top) if z > 0.0 else None


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
            raise Refused(f"{member.name} has no yield force: give the strength of its anchorage as `yield_force`", ("ties",))
        moment += bound * np.abs(slope[:, k])
    return moment


def _checks(context: Context, options: LocalMechanism, turning: _Turning, storeys: int, fc: float) -> tuple[list[Line], Keys]:
    """The rules of the code at each of its limit states, and results that stand beside them."""
    code, asked = code_of(context), actions(context, options)
    own = _part(context, options, turning)
    lines: list[Line] = []
    more: dict[str, float] = {}
    for action in asked or [Action(code.concluding, None, None)]:
        part = replace(own, shaken=action.of_motion and floor_below(context) is not None)
        match code.jurisdiction:
            case "NTC":
                found, beside = _ntc(context, options, turning, storeys, fc, action)
                more |= beside if action.state == code.concluding else {}
            case "EN1998":
                found = en1998(part, action.peak, action.state, action.spectrum)
            case "ASCE41":
                found = _asce(options, part, action)
            case "NZSEE":
                found = nzsee(part, action.spectrum, action.state)
            case _:
                found = []
        lines += dated(found, action)
    return apart(lines), more


def _asce(options: LocalMechanism, part: Part, action: Action) -> list[Line]:
    one_second, short = options.one_second_acceleration, None
    if one_second is None and action.spectrum is not None and not part.shaken:
        one_second, short = action.spectrum(1.0, 0.05), action.spectrum(0.2, 0.05)
    return asce41(part, one_second, options.storey, short, action.state)


def _ntc(context: Context, options: LocalMechanism, turning: _Turning, storeys: int, fc: float, action: Action) -> tuple[list[Line], Keys]:
    """The checks of NTC at a limit state, and a_Z."""
    found, (z, height) = turning.found, turning.place
    note = f"alpha_0 {found.alpha0:.4g}, e* {found.part:.3g}"
    at_height = None
    if height is not None:
        note += f", z {z:.3g} m, z/H {z / height:.3g}"
        if action.spectrum is not None:
            at_height = _floor(options, action.spectrum, z, height, storeys)
            note += "" if options.modes else f", storeys {storeys}"
        elif action.peak is not None:
            context.warnings.append(
                f"at {z:.3g} m above the foundation, the checks of NTC require the response of the building at its period. "
                "Without a spectrum these checks have no demand"
            )
    free, period = options.mechanism in FREE_TO_VIBRATE, _period(context, options)
    place = ntc.Place(height is not None, at_height, free, period)
    if action.of_motion and floor_below(context) is not None:
        place, at_height = ntc.Place(free=free, period=period, shaken=True), None
    compared = ntc.Capacities(found.acceleration / fc, found.d0, found.alone / fc, note)
    lines = ntc.checks(compared, options.behaviour_factor, action.state, action.peak, action.spectrum, place)
    return lines, {} if at_height is None else {"floor_acceleration_g": at_height.acceleration / GRAVITY}


def _floor(options: LocalMechanism, spectrum: Spectrum, z: float, height: float, storeys: int) -> ntc.Floor:
    """The floor spectrum by the modes of the deck, else by the first mode."""
    if options.modes:
        modes = [ntc.FloorMode(m.period, m.participation * m.shape, m.damping) for m in options.modes]
        return ntc.Floor(spectrum, tuple(sorted(modes, key=lambda m: -m.period)))
    return ntc.floor(spectrum, z, height, storeys, options.building_period)


def _period(context: Context, options: LocalMechanism) -> float | None:
    """T_0 of a free part [s]: of the deck, or from a modulus of elasticity that the deck gives; None where neither is known."""
    material = context.building.material
    if options.period is not None or options.mechanism not in FREE_TO_VIBRATE:
        return options.period
    if "young" not in material.model_fields_set or options.height is None or options.thickness is None:
        return None
    return ntc.own_period(options.height - options.hinge_height, options.thickness, material.density, material.young)


def _part(context: Context, options: LocalMechanism, turning: _Turning) -> Part:
    """What turns, as the other codes see it."""
    z, height = turning.place
    top = None if options.height is None else options.height - options.hinge_height
    element: str = "wall of a building" if turning.part is not None else options.mechanism
    if options.mechanism == "building" and turning.part is None:
        element = "chain of blocks"
    held = element == "vertical-bending" or (
        options.thickness is not None and any(tie.height + options.thickness >= float(options.height or 0.0) for tie in options.ties)
    )
    load = sum(floor.load for floor in options.floors)
    first = None if height is None else options.building_period or ntc.first_period(height)
    if options.modes:
        first = max(m.period for m in options.modes)
    return Part(
        element,
        turning.found.alpha0,
        top,
        options.thickness,
        z,
        height,
        load > 0.0,
        held,
        load,
        weight=turning.found.weight,
        period=_period(context, options),
        first=first,
    )
