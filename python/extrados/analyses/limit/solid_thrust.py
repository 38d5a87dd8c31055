"""thrust of solids: least, greatest and most central states of stress of blocks in space, and the thrust of named sections."""

import numpy as np

from extrados.analyses.context import Context, Refused
from extrados.analyses.limit.asked import Cut, cuts_of
from extrados.analyses.limit.common import spoken_ties
from extrados.analyses.limit.solid_loads import solid_limit, strand_arrays, strand_rows
from extrados.analyses.limit.solids import dilating_contacts, refuse_falling, scene_arrays, standing
from extrados.analyses.limit.tables import Thrust
from extrados.limit.answer import safety_factor
from extrados.limit.errors import NoAnswer, NoEquilibrium
from extrados.limit.solid_states import MIDDLE, SolidState, SolidStates
from extrados.limit.solids import Programme, SolidLimit
from extrados.results import solids as out
from extrados.results.fields import given
from extrados.results.limit import DILATANT
from extrados.results.model import Array, Result, TableData
from extrados.schema.constants import GRAVITY
from extrados.schema.quantities import three_figures

MOST_SAID = 4  # sections told in words
ROUNDING = 1e-9  # of the weight


def run(context: Context, options: Thrust) -> Result:
    """Thrust of each section, the most central state, and the range of accelerations in which a state exists."""
    building = context.building
    limit = solid_limit(building, options)
    assembly, first = limit.assembly, 0.0 if options.direction is None else options.direction
    result = Result("thrust")
    ends = [standing(found, assembly) for found in limit.pushes([first, first + 180.0], context.threads) if found is not None]
    if len(ends) == 2:
        refuse_falling(ends[0], ends[1], first)
    if len(ends) == 2 and not -ends[1].gamma <= options.gamma <= ends[0].gamma:
        raise Refused(
            f"at {options.gamma:g} g no admissible state of stress exists: along {first:g} degrees the blocks "
            f"carry accelerations from {-ends[1].gamma:.4f} to {ends[0].gamma:.4f} g",
            ("analysis", "gamma"),
        )
    dead, live = limit.ways(first)
    states = SolidStates(limit, dead + options.gamma * live)
    cuts = cuts_of(building, options)
    thrusts = []
    try:
        for done, cut in enumerate(cuts):
            context.progress(done, len(cuts), "sections")
            thrusts.append((_extreme(states, cut, 1.0), _extreme(states, cut, -1.0)))
        central, part = _central(states, result)
    except NoEquilibrium as error:
        raise Refused(f"at {options.gamma:g} g {error}", ("analysis", "gamma")) from None
    found = [state for pair in thrusts for state in pair if state is not None] + ([central] if central is not None else [])
    worst = None if central is None else int(central.friction.argmax())
    r = out.SolidThrust(
        gamma_g=options.gamma,
        load_direction_deg=first,
        admissible_interval_g=[-ends[1].gamma, ends[0].gamma] if len(ends) == 2 else [],
        sections=[_row(cut, pair, central) for cut, pair in zip(cuts, thrusts, strict=True)],
        geometric_safety_factor=None if part is None or part <= MIDDLE else safety_factor(part),
        least_part_of_joints=part,
        required_friction=None if central is None else float(central.friction.max()),
        required_friction_contact=None if worst is None else assembly.joint_names[worst],
        blocks=len(assembly.mass),
        contacts=len(assembly.a),
        weight_N=float(limit.weight.sum() + GRAVITY * assembly.fill[:, 1].sum()),
        dilating=any(isinstance(one, Programme) and dilating_contacts(limit, one) > 0 for one in ends),
        duality_gap=max((one.gap for one in found), default=0.0) / float(limit.weight.sum()),
        equilibrium_residual=max(one.equilibrium for one in found),
        friction_residual=max(one.excess for one in found),
        **given(ties=strand_rows(building, limit, central.tension) if limit.strands and central is not None else None),
    )
    result.results = r
    result.arrays = _arrays(limit, cuts, thrusts, central)
    if central is not None:
        result.tables = {"thrust_central": _table(limit, central)}
        result.arrays |= strand_arrays(limit, central.tension)
    result.answer = _words(r)
    return result


def _extreme(states: SolidStates, cut: Cut, sense: float) -> SolidState | None:
    """The state of least (sense 1) or greatest (-1) thrust of a section."""
    toward = np.zeros((len(states.limit.assembly.a), 3))
    toward[cut.contacts] = sense * cut.toward
    return states.extreme(toward)


def _central(states: SolidStates, result: Result) -> tuple[SolidState | None, float | None]:
    """The most central state and the part of the contacts that holds it; a warning where it is not found."""
    try:
        return states.central()
    except NoAnswer as error:
        result.warnings.append(f"the most central state is not given: {error}")
        return None, None


def thrust_of(cut: Cut, state: SolidState | None) -> float | None:
    """Thrust of a section in a state [N]."""
    return None if state is None else float((state.force[cut.contacts] * cut.toward).sum())


def _row(cut: Cut, pair: tuple[SolidState | None, SolidState | None], central: SolidState | None) -> out.SectionThrust:
    least, most = pair
    return out.SectionThrust(
        name=cut.name,
        direction=cut.along,
        contacts=len(cut.contacts),
        least_N=thrust_of(cut, least),
        central_N=thrust_of(cut, central),
        greatest_N=thrust_of(cut, most),
    )


def _arrays(
    limit: SolidLimit, cuts: list[Cut], thrusts: list[tuple[SolidState | None, SolidState | None]], central: SolidState | None
) -> dict[str, Array]:
    """The blocks, their contacts, and the forces of each state on the first blocks of the contacts."""
    assembly = limit.assembly
    nothing = np.full((len(assembly.a), 3), np.nan)
    inside = np.zeros((len(cuts), len(assembly.a)), dtype=bool)
    for row, cut in zip(inside, cuts, strict=True):
        row[cut.contacts] = True
    arrays = scene_arrays(assembly) | {
        "contact_point": Array(assembly.corner, ("contact_corner", "axis3"), "m", "corners of the contact polygons"),
        "contact_of": Array(assembly.corner_joint, ("contact_corner",), "", "contact of each corner"),
        "contact_block": Array(
            np.column_stack([assembly.a, assembly.b]),
            ("contact", "side"),
            "",
            "numbers of the two blocks of each contact; -1 is the ground",
        ),
        "section_contact": Array(inside, ("section", "contact"), "", "whether a contact belongs to the section"),
    }
    for k, name in enumerate(("least", "greatest")):
        states = [pair[k] for pair in thrusts]
        force = np.array([nothing if one is None else one.force for one in states]).reshape(-1, *nothing.shape)
        centre = np.array([nothing if one is None else one.centre for one in states]).reshape(-1, *nothing.shape)
        dims = ("section", "contact", "axis3")
        arrays[f"{name}_force"] = Array(force, dims, "N", f"force on the first block of each contact in the state of {name} thrust")
        arrays[f"{name}_centre"] = Array(centre, dims, "m", f"centre of the compression in the state of {name} thrust")
    if central is not None:
        arrays["central_force"] = Array(
            central.force, ("contact", "axis3"), "N", "force on the first block of each contact in the most central state"
        )
        arrays["central_centre"] = Array(central.centre, ("contact", "axis3"), "m", "centre of the compression in the most central state")
        arrays["central_friction"] = Array(central.friction, ("contact",), "", "shear divided by compression in the most central state")
    return arrays


def _table(limit: SolidLimit, state: SolidState) -> TableData:
    """Forces of the most central state, contact by contact."""
    columns = {f"force_{axis}": 1e-3 * state.force[:, k] for k, axis in enumerate("xyz")}
    places = {axis: state.centre[:, k] for k, axis in enumerate("xyz")}
    return TableData(
        {"contact": limit.assembly.joint_names, **columns, **places, "friction_needed": state.friction},
        {**dict.fromkeys(columns, "kN"), **dict.fromkeys(places, "m")},
    )


def _spoken(thrust: float, weight: float) -> str:
    """A thrust [N] in words; rounding beside the weight [N] is 0."""
    return f"{three_figures(thrust / 1e3 if abs(thrust) > ROUNDING * weight else 0.0)} kN"


def _words(r: out.SolidThrust) -> str:
    told = []
    for one in r.sections[:MOST_SAID]:
        least, most = ("unlimited" if n is None else _spoken(n, r.weight_N) for n in (one.least_N, one.greatest_N))
        central = "" if one.central_N is None else f", {_spoken(one.central_N, r.weight_N)} in the most central state"
        told.append(
            f"at section '{one.name}' ({one.direction}{f', sum over {one.contacts} contacts' if one.contacts > 1 else ''}) from {least} to {most}{central}"
        )
    text = (f"At {r.gamma_g:g} g along {r.load_direction_deg:g} degrees in plan, the thrust is {'; '.join(told)}. ") if told else ""
    if r.least_part_of_joints is not None:
        text += (
            f"The most central state stays within the middle {100.0 * r.least_part_of_joints:.1f} % of the "
            f"contacts and requires a coefficient of friction of {r.required_friction:.2f}. "
        )
    if r.admissible_interval_g:
        low, high = r.admissible_interval_g
        bound = f" (contacts slide there: {DILATANT})" if r.dilating else ""
        text += f"Admissible states exist from {low:.4f} to {high:.4f} g{bound}."
    return text + spoken_ties(r.ties)
