"""code-checks: the rules of the code of a deck for a rocking block, or for a wall as a pier, beside the computed rocking."""

from dataclasses import replace
from typing import Any

import numpy as np

from extrados.analyses.codes import ntc, research
from extrados.analyses.codes.actions import Action, actions, apart, code_of, dated, floor_below, sampled
from extrados.analyses.codes.code_rules import Line, table
from extrados.analyses.codes.parts import Part, asce41, en1998, nzsee
from extrados.analyses.codes.piers import Pier, asce41_piers, en1998_piers, ntc_piers, nzsee_piers
from extrados.analyses.codes.tables import CodeChecks
from extrados.analyses.context import Context, Refused
from extrados.analyses.rocking.conditions import ELSEWHERE, of_one, told
from extrados.core import motion as core_motion
from extrados.core import rocking as core_rocking
from extrados.model.structures.block import BlockAssembly
from extrados.model.structures.brickwork import Brickwork
from extrados.model.structures.walls import Panel
from extrados.results import codes as out
from extrados.results.model import Array, Result
from extrados.schema.constants import GRAVITY
from extrados.schema.table import FloorBelow
from extrados.views.rockers.block import BlockModel

#: q of the demand on a pier of masonry without reinforcement; of ASCE 41 m, which is 1 where Table 11-3 is not used
BEHAVIOUR = {"NTC": 2.0, "EN1998": 1.5}
#: gamma_M of masonry in a linear analysis with q (NTC 2018 7.8.1.1)
PARTIAL = 2.0
#: Periods [s] among which the plateau of a spectrum is looked for
PLATEAU = np.linspace(0.05, 1.0, 96)


def run(context: Context, options: CodeChecks) -> Result:
    """The rules of the code at its limit states, with the computed rocking of the deck's motion beside them."""
    structure, code = context.building.require_structure(), code_of(context)
    result = Result("code-checks")
    beside: dict[str, Any] = {}
    if structure.rocks_as == "piers":
        lines, beside = _wall(context, options)
    else:
        block = _block_of(context).block
        lines, beside = _block(context, options, block)
        if options.axial_load is not None:
            width, height = block.toe_right + block.toe_left, 2.0 * block.centre_height
            more, _ = _pier(context, options, width, height, options.thickness or block.depth, float(block.mass[0]) * GRAVITY)
            lines += more
    lines = apart(lines)
    r = out.CodeChecks(
        checks={line.rule: line.check() for line in lines},
        jurisdiction=code.jurisdiction,
        code=code.name,
        by_default=context.deck.code is None,
        clause="",
        **beside,
    )
    r = r.model_copy(update=r.concluded())
    result.results = r
    rows = result.tables["code_checks"] = table(lines)
    result.arrays = {
        "capacity": Array(
            np.array(rows.columns["capacity"]), ("rule",), "", "capacity and demand of each rule, in its own unit: see code_checks.csv"
        ),
        "demand": Array(np.array(rows.columns["demand"]), ("rule",)),
    }
    compared = [x for x in lines if x.verdict in ("holds", "fails") and x.demand is not None and x.capacity is not None]
    said = [f"{x.rule} {x.verdict} (demand {x.demand:.3g}, capacity {x.capacity:.3g} {x.unit})" for x in compared]
    words = [r.overall().statement, *([f"In detail: {'; '.join(said)}."] if said else [])]
    if r.dynamic_outcome:
        ratio = r.dynamic_peak_rotation_ratio
        spoken = {
            "collapse": "overturns",
            "recovery": f"rocks to {100 * ratio:.0f} % of its critical rotation and recovers",
            "no-hinging": "does not rock",
        }[r.dynamic_outcome]
        words.append(f"Calculated under the motion itself, the block {spoken}.")
    if (weakest := r.weakest()) is not None and said:
        words.append(f"The lowest strength of the block as a pier is {(weakest[1].capacity or 0.0) / 1e3:.4g} kN ({weakest[0]}).")
    result.answer = " ".join(words)
    return result


def _block_of(context: Context) -> BlockModel:
    """The building as a rocking block."""
    model = context.building.rocker().model
    assert isinstance(model, BlockModel)  # of the kinds that the table takes
    return model


def _block(context: Context, options: CodeChecks, block: BlockAssembly) -> tuple[list[Line], dict[str, Any]]:
    """The rules of rocking bodies, and the results that stand beside them."""
    rocker, model = context.building.rocker(), _block_of(context)
    context.warnings += model.warnings
    width, height = block.toe_right + block.toe_left, 2.0 * block.centre_height
    code, asked = code_of(context), actions(context, options)
    main = next((a for a in asked if a.state == code.concluding), Action(code.concluding, None, None))
    pga, pgv = None if main.peak is None else main.peak / GRAVITY, options.peak_velocity
    if main.of_motion and pgv is None:
        pgv = float(core_motion.measures(*sampled(context.motion)).pgv[0])
    factor = code.factor if options.confidence_factor is None else options.confidence_factor
    q = options.behaviour_factor or BEHAVIOUR.get(code.jurisdiction, 1.0)
    beside: dict[str, Any] = {
        "peak_ground_acceleration_g": pga,
        "peak_ground_velocity_m_s": pgv,
        "confidence_factor": factor,
        "behaviour_factor": q,
    }
    violated, friction = [], context.building.joints.coefficient
    if code.jurisdiction == "NTC" and factor < ntc.LC1 and context.building.material.compressive_strength is None:
        violated.append(ntc.below_lc1(factor))
    if friction is not None and friction < np.tan(model.alpha.min()):
        violated.append(
            f"Friction {friction:g} is below the {np.tan(model.alpha.min()):.3g} that rocking requires. The block slides "
            "first, and these rules do not consider sliding."
        )
    if context.deck.motion is not None:
        motion = context.motion
        start = rocker.start_rotation
        dynamic = core_rocking.history(
            rocker.body,
            motion.ground,
            motion.end + 30.0 / float(model.frequency.min()),
            0.01,
            start_side=1 if start >= 0.0 else -1,
            start_rotation=abs(start),
        )
        conditions = of_one(rocker, dynamic)
        context.warnings += told(conditions)
        violated += [text for text in conditions.violated if text.startswith(ELSEWHERE)]
        beside |= {"dynamic_outcome": dynamic.outcome, "dynamic_peak_rotation_ratio": dynamic.peak_ratio}
    if violated:
        beside["violated"] = violated
    alpha = float(model.alpha.min())
    # one body: all its mass takes part (e* = 1); d* is the displacement of the centre of mass
    alpha0 = float(np.tan(alpha))
    below = floor_below(context)
    place = (0.0, None) if below is None else (below.height, below.building_height)
    part = Part("block", alpha0, height, width, *place)
    lines: list[Line] = []
    for action in asked or [main]:
        felt = replace(part, shaken=action.of_motion and below is not None)
        match code.jurisdiction:
            case "NTC":
                found = ntc.Capacities(
                    alpha0 * GRAVITY / factor, block.centre_height * alpha0, alpha0 * GRAVITY / factor, f"alpha_0 {alpha0:.4g}, e* 1"
                )
                rows = ntc.checks(found, q, action.state, action.peak, action.spectrum, _placed(action, below))
            case "EN1998":
                rows = en1998(felt, action.peak, action.state, action.spectrum)
            case "ASCE41":
                one_second = None if action.spectrum is None or felt.shaken else action.spectrum(1.0, 0.05)
                rows = asce41(felt, one_second, "one-story", None, action.state)
            case "NZSEE":
                rows = nzsee(felt, action.spectrum, action.state)
            case _:
                rows = []
        lines += dated(rows, action)
    return lines + _formulas(context, options, main, (width, height), pgv), beside


def _placed(action: Action, below: FloorBelow | None) -> ntc.Place:
    """Where the block stands: on the ground, or on the floor of the deck's motion."""
    if below is None or action.of_motion:
        return ntc.Place(shaken=below is not None)
    floor = None
    if action.spectrum is not None:
        period, damping = below.building_period, below.building_damping
        floor = ntc.floor(action.spectrum, below.height, below.building_height, below.levels, period, damping)
    return ntc.Place(True, floor)


def _formulas(context: Context, options: CodeChecks, main: Action, size: tuple[float, float], pgv: float | None) -> list[Line]:
    """Formulas of other origin for a rocking block that the deck requests."""
    model, wanted = _block_of(context), code_of(context).research
    alpha = float(model.alpha.min())
    pga = None if main.peak is None else main.peak / GRAVITY

    def sa(period: float, damping: float) -> float:
        assert main.spectrum is not None
        return main.spectrum(period, damping) / GRAVITY

    found = []
    if "West" in wanted:
        found.append(research.west(float(np.tan(alpha)), pga))
    if "Ishiyama" in wanted:
        found += research.ishiyama(*size, pga, pgv)
    if "ASCE 43" in wanted:
        found.append(research.asce43(*size, None if main.spectrum is None else sa))
    if options.pulse_period is not None:
        found.append(research.housner(float(model.frequency[0]), alpha, pga, options.pulse_period))
    return found


def _wall(context: Context, options: CodeChecks) -> tuple[list[Line], dict[str, Any]]:
    """The pier rules for a wall without openings, with its material's compressive strength."""
    wall = context.building.require_structure()
    assert isinstance(wall, Panel | Brickwork)  # the kinds that rock as piers
    width, height = wall.size
    pier = context.building.pier_blocks()
    thickness = options.thickness or pier.depth
    weight = float(pier.mass[0]) * GRAVITY * thickness / pier.depth
    return _pier(context, options, width, height, thickness, weight)


def _pier(
    context: Context, options: CodeChecks, width: float, height: float, thickness: float, weight: float
) -> tuple[list[Line], dict[str, Any]]:
    """The pier rules of the code at its limit states, and the factors by which they are made."""
    strength, joints, code = context.building.material.compressive_strength, context.building.joints, code_of(context)
    assert strength is not None and options.axial_load is not None
    pier = Pier(
        width,
        height,
        thickness,
        options.axial_load,
        weight,
        options.fixity == "double",
        strength,
        joints.cohesion,
        options.sliding_friction,
        options.diagonal_strength,
        options.interlocking_ratio,
        options.unit_strength,
    )
    if pier.load >= 0.7 * strength * pier.area:
        raise Refused("the vertical load alone crushes the pier (P >= 0.7 f_m A)", ("analysis", "axial_load"))
    factor = code.factor if options.confidence_factor is None else options.confidence_factor
    q = options.behaviour_factor or BEHAVIOUR.get(code.jurisdiction, 1.0)
    lines: list[Line] = []
    for action in actions(context, options) or [Action(code.concluding, None, None)]:
        demand, how = _lateral(pier, action, 1.0 if code.jurisdiction == "ASCE41" else q)
        match code.jurisdiction:
            case "NTC":
                partial = options.partial_factor or (1.0 if demand is None else PARTIAL)
                rows = ntc_piers(pier, factor, partial, demand, action.state)
            case "EN1998":
                rows = en1998_piers(pier, factor, demand, action.state)
            case "ASCE41":
                rows = asce41_piers(pier, factor, demand, q, action.state)
            case "NZSEE":
                rows = nzsee_piers()
            case _:
                rows = []
        lines += dated([x if x.demand is None else replace(x, note=f"{x.note}, {how}") for x in rows], action)
    formulas = research.formulas_of_piers(
        width, height, thickness, pier.load, strength, joints.cohesion, options.sliding_friction, pier.double
    )
    lines += [x for x in formulas if x.rule.startswith(tuple(code.research))] if code.research else []
    return lines, {"confidence_factor": factor, "behaviour_factor": q}


def _lateral(pier: Pier, action: Action, q: float) -> tuple[float | None, str]:
    """Lateral force [N] on a pier whose load sways with it, and its acceleration in words: the plateau of the spectrum, since the
    period of the building is not known here, or a peak acceleration alone; over q."""
    if action.spectrum is not None:
        felt, words = max(action.spectrum(float(t), 0.05) for t in PLATEAU), "plateau of the spectrum"
    elif action.peak is not None:
        felt, words = action.peak, "peak acceleration, rigid pier"
    else:
        return None, ""
    return felt / GRAVITY * pier.load / q, f"{words} {felt / GRAVITY:.3g} g divided by q = {q:g}, with N = {pier.load / 1e3:.4g} kN"
