"""The answers of a run and of a tilt test in words."""

from extrados.results.dem import ONE_PATH, Convergence, DemRun, DemTilt, SolidDemRun, SolidDemTilt, TieRun
from extrados.results.verdict import loads_at_rest
from extrados.schema.quantities import three_figures

#: Rotations [rad] and slips [m] below this are rounding errors and the elasticity of joints.
STILL = 1e-6


def solved(c: Convergence) -> str:
    """How far rigid contacts converged."""
    where = "all" if not c.open_steps else f"{c.steps - c.open_steps} of"
    return (
        f"rigid contacts converged in {where} {c.steps} steps (at most {c.most_rounds} iterations; greatest error "
        f"{c.worst_violation_ratio:.1g} of the velocity that gravity adds in a step)"
    )


def _audit(r: DemRun | SolidDemRun) -> str:
    """Ledger, and how impacts are damped or contacts solved."""
    audit = f"error of the energy balance {100 * r.energy_residual_ratio:.2g} %"
    if r.convergence is not None:
        return f"{audit}, {solved(r.convergence)}"
    assert r.damping_ratio_rotation is not None and r.damping_ratio_edge is not None  # joints with springs
    return (
        f"{audit}, damping {100 * r.damping_ratio_rotation:.3g} % of critical at rotational and "
        f"{100 * r.damping_ratio_edge:.3g} % at edge impact"
    )


def _fate(r: DemRun | SolidDemRun, joint: str) -> str:
    """How a run ends."""
    if r.outcome == "collapse":
        return f"{r.governing_block} collapses first ({r.collapse_criterion}), at {r.collapse_time_s:.2f} s"
    if r.outcome == "slid":
        return (
            f"Blocks slide by up to {three_figures(1e3 * r.peak_slip_m)} mm ({100 * r.slip_ratio:.3g} % of the {joint} "
            f"{r.slipped_joint}). The slip at the end of the run is {three_figures(1e3 * r.residual_slip_m)} mm; no {joint} opens"
        )
    if r.outcome == "at-rest":
        return f"No {joint} opens or slides"
    fate = f"rock and still move at {r.stop_time_s:.2f} s" if r.still_moving else "rock and come to rest"
    if r.slipped_joint is not None and r.peak_slip_m > 0.5 * r.peak_displacement_m:  # most of the displacement is slip
        fate = f"slide by up to {three_figures(1e3 * r.peak_slip_m)} mm ({joint} {r.slipped_joint}), {fate}"
    return f"Blocks {fate}: greatest displacement {three_figures(1e3 * r.peak_displacement_m)} mm ({r.governing_block})"


def _moved(name: str, turn: float, slip: float) -> str:
    """The greatest rotation [rad], of the block of that name, and the greatest slip [m]; below `STILL` they are rounding errors."""
    rotates = f"{name} rotates by {three_figures(1e3 * turn)} mrad at most" if turn > STILL else "no block rotates"
    slips = f"the greatest slip is {three_figures(1e3 * slip)} mm" if slip > STILL else "no slip"
    return f"{rotates}, {slips}"


def _tied(ties: list[TieRun] | None) -> str:
    """The greatest forces of up to four ties and dampers."""
    if not ties:
        return ""
    ranked = sorted(ties, key=lambda tie: -abs(tie.peak_force_N))[:4]
    told = [
        f"{tie.name} is slack"
        if tie.state == "slack"
        else f"{tie.name} reaches {1e-3 * tie.peak_force_N:.4g} kN" + (" and yields" if tie.state == "yielded" else "")
        for tie in ranked
    ]
    return f" Forces of ties and dampers (tension positive): {', '.join(told)}{', ...' if len(ties) > 4 else ''}."


def supports_answer(far: float, lift: float, weight: float, work: float | None) -> str:
    """The movement of supports and their work: how far they move [m], how far all of them rise [m], the weight of the blocks [N], and the
    work [J]; None under a motion, whose work the ledger does not separate."""
    if not far:
        return ""
    told = f" Supports move by {three_figures(1e3 * far)} mm"
    if work is not None:
        told += f" and do {three_figures(1e-3 * work)} kJ of work"
        told += f" (weight times lift: {three_figures(1e-3 * weight * lift)} kJ)" if abs(lift) > STILL else ""
    return f"{told}."


def _wet(r: DemRun | DemTilt | SolidDemRun | SolidDemTilt) -> str:
    """The force of the water, if any."""
    if not r.water_force_N:
        return ""
    across, up = r.water_force_N
    parts = [
        f"{three_figures(1e-3 * abs(force))} kN {way}"
        for force, way in ((across, "towards +x" if across >= 0.0 else "towards -x"), (up, "upward" if up >= 0.0 else "downward"))
        if abs(force) > STILL * max(abs(across), abs(up))
    ]
    return f" Water presses on the blocks with {' and '.join(parts)}."


def _idle(r: DemRun | SolidDemRun) -> str:
    """The answer of a run without a motion that stays at rest."""
    loads = loads_at_rest("the water pressure" if r.water_force_N else None)
    return f"The structure stands under {loads}. No motion acts on it.{_wet(r)}"


def motion_answer(r: DemRun, idle: bool) -> str:
    """The answer of a run under a motion; idle: nothing moves the ground."""
    if idle and r.outcome == "at-rest":
        return _idle(r)
    turn = max(r.peak_rotation_rad.items(), key=lambda item: abs(item[1]), default=("", 0.0))
    first, audit = _fate(r, "joint"), _audit(r)
    return f"{first}; {_moved(turn[0], abs(turn[1]), r.peak_slip_m)}, {r.bounces} bounces; {audit}.{_tied(r.ties)}{_wet(r)}"


def tilt_answer(r: DemTilt) -> str:
    """The answer of a tilt test in the plane."""
    collapse, back = r.collapse_acceleration_g, r.collapse_acceleration_opposite_g
    where = ", ".join(f"{h.name} ({h.side})" for h in r.hinges[:6]) or "none"
    least, sense = min((collapse, "+x"), (back, "-x"))
    return (
        (
            f"Collapse under a constant horizontal acceleration of {collapse:.4f} g towards +x (a tilt of {r.tilt_angle_deg:.2f} "
            f"deg), and of {back:.4f} g towards -x. The lower value is {least:.4f} g, towards {sense}. Hinges at "
            f"collapse towards +x: {where}.{_tied(r.ties)}{_wet(r)}"
        )
        + (f" {ONE_PATH}" if r.interval else "")
        + (f" {solved(r.convergence).capitalize()}." if r.convergence else "")
    )


def solid_answer(r: SolidDemRun, idle: bool) -> str:
    """The answer of a run in space; idle: nothing moves the ground."""
    if idle and r.outcome == "at-rest":
        return _idle(r)
    turn = max(r.peak_rotation_rad.items(), key=lambda item: item[1], default=("", 0.0))
    first, audit = _fate(r, "contact"), _audit(r)
    if r.outcome == "rocked":
        first += f", of which {three_figures(1e3 * r.final_displacement_m)} mm remain at the end of the run"
    if r.dowels:
        gave = f"slipped by up to {1e3 * r.dowel_slip_m:.2g} mm" if r.dowel_slip_m > 0.0 else "held"
        first += f"; dowels {gave}" + (f", {r.dowels_out} of {r.dowels} came out" if r.dowels_out else "")
    return f"{first}; {_moved(turn[0], turn[1], r.peak_slip_m)}, {r.bounces} bounces; {r.blocks} blocks, {r.contacts} contacts; {audit}.{_tied(r.ties)}{_wet(r)}"


def solid_tilt_answer(r: SolidDemTilt) -> str:
    """The answer of a tilt test in space."""
    where = ", ".join(r.opening_contacts[:6]) or "none"
    least = min(r.collapse_acceleration_g, r.collapse_acceleration_opposite_g)
    return (
        (
            f"Collapse under a constant horizontal acceleration of {r.collapse_acceleration_g:.4f} g along {r.load_direction_deg:g} "
            f"degrees in plan (a tilt of {r.tilt_angle_deg:.2f} deg), and of {r.collapse_acceleration_opposite_g:.4f} g in the opposite "
            f"direction. The lower value is {least:.4f} g. Contacts that open or slide at collapse: {where}.{_tied(r.ties)}{_wet(r)}"
        )
        + (f" {ONE_PATH}" if r.interval else "")
        + (f" {solved(r.convergence).capitalize()}." if r.convergence else "")
    )
