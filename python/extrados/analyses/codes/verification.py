"""Verification of capacity curves by displacement, by the code of the deck and its seismic action."""

from dataclasses import dataclass, replace
from functools import partial
from typing import Any, TypeVar

import numpy as np

from extrados.analyses.codes import capacity_curve as cc
from extrados.analyses.codes.actions import NATIVE, Action, Spectrum, actions, code_of
from extrados.analyses.codes.capacity_curve import CapacityCurve, Oscillator
from extrados.analyses.codes.suites import fragilities
from extrados.analyses.codes.tables import Verification
from extrados.analyses.context import Context
from extrados.core.sla import Model, Monitor
from extrados.model.properties import Joints, JointType, Material
from extrados.results import verification as out
from extrados.results.model import Array, Result
from extrados.schema.constants import GRAVITY
from extrados.views.building import Building

#: Strengths of the model, which the confidence factor divides
STRENGTHS = (
    "tensile_strength",
    "tensile_strength_parallel",
    "shear_strength",
    "compressive_strength",
    "compressive_strength_parallel",
    "cohesion",
    "tension",
)
Strong = TypeVar("Strong", Material, Joints, JointType)
#: Limit drifts of piers at collapse, in shear and in flexure: C8.7.1.3.1.1; EN 1998-3 C.4.2 and C.4.3, 4/3 of SD, at H_0 = D
#: (verify clause)
DRIFTS = {"NTC": (0.005, 0.010), "EN1998": (0.016 / 3.0, 0.032 / 3.0)}
#: Periods at which spectra are drawn [s]
DRAWN = np.linspace(0.0, 2.0, 201)
#: Default method of each code
METHODS: dict[str, out.Method] = {"ASCE41": "coefficient"}
DEMAND_CLAUSES = {
    "N2": {
        "NTC": "NTC 2018 7.8.1.6, [C7.3.8], [C7.3.9]",
        "EN1998": "EN 1998-1 Annex B, by prEN 1998-1:2003",
        "NZSEE": "N2 (verify clause)",
    },
    "capacity-spectrum": {"NTC": "[C7.3.10]"},
    "coefficient": {"ASCE41": "ASCE 41-13 Eq. 7-28 (verify clause)"},
}
CAPACITY_CLAUSES = {
    "NTC": "C8.7.1.3.1",
    "EN1998": "EN 1998-3 C.3 (verify clause)",
    "NZSEE": "C2 (verify clause)",
    "ASCE41": "Table 11-4 (not read)",
}


@dataclass(frozen=True)
class Push:
    """A capacity curve to be verified: its name (the sense), the curve, all masses [kg]."""

    name: str
    curve: CapacityCurve
    total_mass: float


def demands(context: Context, options: Verification) -> list[Action]:
    """The seismic actions of the limit states that have a spectrum."""
    return [a for a in actions(context, options) if a.spectrum is not None]


def confidence_factor(context: Context, options: Verification) -> float:
    """Factor by which strengths are divided (NTC 2018 C8.5.4, nonlinear analysis: mean values over FC); 1 where the deck has no
    action to verify against."""
    code = code_of(context)
    return code.factor if code.jurisdiction != "none" and demands(context, options) else 1.0


def with_design_strengths(context: Context, options: Verification) -> Context:
    """The context with strengths over the confidence factor, where that is not 1."""
    factor = confidence_factor(context, options)
    if factor == 1.0:
        return context
    context.warnings.append(
        f"The strengths are those of the deck, divided by the confidence factor {factor:.3g}, as the verification requires."
    )
    return replace(context, building=divided(context.building, factor))


def divided(building: Building, factor: float) -> Building:
    """The building with all strengths divided by a factor; stiffness and fracture energy stay."""

    def over(table: Strong) -> Strong:
        given = {name: getattr(table, name, None) for name in STRENGTHS}
        return table.model_copy(update={name: value / factor for name, value in given.items() if value is not None})

    joints = over(building.joints)
    joints = joints.model_copy(update={"types": [over(one) for one in joints.types]})
    return replace(
        building,
        material=over(building.material),
        materials={name: over(m) for name, m in building.materials.items()},
        joints=joints,
        views={},
    )


def displaced_shape(model: Model, load: np.ndarray, control: Monitor, along: np.ndarray, free: np.ndarray) -> tuple[np.ndarray, float]:
    """phi of a pushed model of finite elements (nodes): its elastic displacement along the push, 1 at the control displacement;
    and the part of the pushing forces that goes through the structure, since those on supports are no part of its base shear.

    model: undamaged, in the core; load: pushing forces (nodes, components) [N]; along: direction of the push (axes); free (nodes,
    components): freedoms that are not supported.
    """
    model.loads(np.zeros_like(load), load)
    moved, axes = model.displacement(1.0), len(along)
    shape = moved[:, :axes] @ along / float(moved[control.node, control.direction] @ control.share)
    pushed = load[:, :axes] * along
    return shape, float(pushed[free[:, :axes]].sum() / pushed.sum())


def verify(
    context: Context, result: Result, options: Verification, pushes: list[Push], violated: list[str], factor: float | None = None
) -> out.Verification | None:
    """The verification of all pushes; None where no code is applied. factor: by which strengths were divided, by default that of
    the code."""
    code = code_of(context)
    if code.jurisdiction == "none":
        return None
    method = options.method or METHODS.get(code.jurisdiction, "N2")
    given = demands(context, options)
    states: list[Action] = [
        next((a for a in given if a.state == state), Action(state, None, None))
        for state in dict.fromkeys([*code.states, *(a.state for a in given)])
    ]
    known = {a.years: a.peak for a in given if a.years is not None and a.peak is not None}
    corners = {a.state: cc.corner_period(a.spectrum) for a in given if a.spectrum is not None}
    violated, curves, checks, made = list(violated), [], [], []
    result.arrays |= curve_arrays(context, options, pushes)
    for push in pushes:
        oscillator = _idealised(push.curve, options, code.jurisdiction)
        if oscillator is None:
            violated.append(unverified(push.name))
            continue
        rows = [
            _check(push, oscillator, action, corners.get(action.state, 0.0), method, options, code.jurisdiction, known) for action in states
        ]
        checks += rows
        made.append((push.curve, oscillator))
        law, gamma = oscillator.law, oscillator.participation
        curves.append(
            out.IdealisedCurve(
                push=push.name,
                equivalent_mass_kg=oscillator.mass,
                participation_factor=gamma,
                mass_ratio=oscillator.mass * gamma / push.total_mass,
                period_s=oscillator.period,
                yield_load_N=gamma * law.yield_load,
                yield_displacement_m=gamma * law.yield_displacement,
                ultimate_displacement_m=push.curve.ultimate,
                ended_by=push.curve.ended_by,
            )
        )

    def least(state: str) -> float | None:
        return min((c.factor for c in checks if c.limit_state == state and c.factor is not None), default=None)

    more: dict[str, Any] = {}
    known_states = [a.state for a in states if a.state in cc.CAPACITY]
    if options.motions is not None and made and known_states:
        more["fragility"], carried = fragilities(context, options, made, known_states)
        result.arrays["carried_pga"] = Array(
            carried,
            ("motion", "limit_state"),
            "g",
            f"peak ground acceleration that the building can carry at {', '.join(known_states)}, for each motion",
        )
    if code.jurisdiction == "NZSEE" and (found := least("ULS")) is not None:
        more["nbs_percent"] = 100.0 * found
    return out.Verification(
        jurisdiction=code.jurisdiction,
        code=code.name,
        by_default=code is NATIVE,
        method=method,
        confidence_factor=(code.factor if factor is None else factor) if given else None,
        curves=curves,
        checks=checks,
        zeta_E=least("SLV") if code.jurisdiction == "NTC" else None,
        violated=violated,
        **more,
    )


def unverified(name: str) -> str:
    """The condition of a push that has no curve to be verified."""
    return f"The capacity curve of pushover {name} has no rising branch. The least factor is calculated without this pushover."


def _idealised(curve: CapacityCurve, options: Verification, jurisdiction: str) -> Oscillator | None:
    """The oscillator of a curve up to collapse; by EN 1998-1 that of its Annex B."""
    if jurisdiction == "EN1998":
        return cc.annex_b_oscillator(curve, curve.ultimate / curve.participation)
    return cc.oscillator_of(curve, options.secant)


def curve_arrays(context: Context, options: Verification, pushes: list[Push]) -> dict[str, Array]:
    """The verified curves, and the spectra of the limit states that have one."""
    found: dict[str, Array] = {}
    for k, push in enumerate(pushes):
        for name, values, unit, about in (
            ("displacement", push.curve.displacement, "m", "control displacement"),
            ("load", push.curve.force, "N", "base shear"),
        ):
            found[f"verified_{name}_{k}"] = Array(
                values, (f"verified_{k}",), unit, f"{about} of the verified capacity curve, {push.name}", f"verified_{name}"
            )
    given = demands(context, options)
    if given:
        found["spectrum_period"] = Array(DRAWN, ("periods",), "s", "periods of the spectra")
    for action in given:
        assert action.spectrum is not None
        values = np.array([action.spectrum(float(t), cc.DAMPING) for t in DRAWN])
        found[f"spectrum_{action.state}"] = Array(values, ("periods",), "m/s^2", f"elastic spectrum at {action.state}", "spectrum")
    return found


def _check(
    push: Push,
    oscillator: Oscillator,
    action: Action,
    corner: float,
    method: out.Method,
    options: Verification,
    jurisdiction: str,
    known: dict[float, float],
) -> out.DisplacementCheck:
    """A curve at a limit state. corner: T_C of the action [s]; known: accelerations of the return periods, of `return_period`."""
    state, gamma, curve = action.state, oscillator.participation, push.curve
    capacity = cc.capacity_of(curve, oscillator, state) if state in cc.CAPACITY else None
    limit = cc.GREATEST_Q.get(state)
    demand = ratio = factor = None
    if action.spectrum is not None:
        demanded = partial(_demand, push, oscillator, method, options.quality, jurisdiction, corner)
        demand, ratio = demanded(action.spectrum), cc.strength_ratio(oscillator, action.spectrum)
        if capacity is not None:
            if method == "N2" and jurisdiction != "EN1998":
                factor = cc.n2_factor(oscillator, action.spectrum, corner, capacity / gamma)
            else:
                factor = cc.greatest_factor(partial(_scaled, demanded, action.spectrum), capacity)
            if limit is not None:
                factor = min(factor, limit / ratio)
    peak = None if action.peak is None else action.peak / GRAVITY
    carried = None if factor is None or peak is None else factor * peak
    years = None
    if carried is not None and action.years is not None:
        years = cc.return_period(carried * GRAVITY, known)
    clause = DEMAND_CLAUSES[method].get(jurisdiction, method)
    return out.DisplacementCheck(
        push=push.name,
        limit_state=state,
        demand_m=demand,
        capacity_m=capacity,
        strength_ratio=ratio,
        greatest_strength_ratio=limit,
        factor=factor,
        demand_pga_g=peak,
        capacity_pga_g=carried,
        return_period_years=action.years,
        capacity_return_period_years=years,
        verdict="" if factor is None else "holds" if factor >= 1.0 else "fails",
        clause=f"{clause}; {CAPACITY_CLAUSES[jurisdiction]}",
    )


def _scaled(demanded: partial[float | None], spectrum: Spectrum, factor: float) -> float | None:
    """The demand of a spectrum times a factor."""
    return demanded(lambda period, damping: factor * spectrum(period, damping))


def _demand(
    push: Push, oscillator: Oscillator, method: out.Method, quality: float, jurisdiction: str, corner: float, spectrum: Spectrum
) -> float | None:
    """Displacement demand of the control point [m]; None beyond collapse."""
    gamma = oscillator.participation
    if method == "coefficient":
        return cc.coefficient_displacement(oscillator, spectrum, GRAVITY * push.total_mass)
    if method == "capacity-spectrum":
        found = cc.capacity_spectrum_displacement(push.curve, spectrum, quality)
        return None if found is None else gamma * found
    if jurisdiction == "EN1998":
        iterated = cc.annex_b(push.curve, spectrum, corner)
        return None if iterated is None else gamma * iterated[1]
    return gamma * cc.n2_displacement(oscillator, spectrum, corner)
