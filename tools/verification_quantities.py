"""Quantity of each expected number: the groups by which the verification book groups its rows."""

import re

#: Quantity -> patterns of `analysis.key` (without indices) that belong to it; the first that fits wins
QUANTITIES: dict[str, tuple[str, ...]] = {
    "size of a strengthening": (r"^strengthen\S*\.",),
    "thrust and horizontal load of networks": (r"^thrust-network\S*\.",),
    "start of sliding": (r"hand_over\.time_s$", r"\.handed_over$"),
    "code check": (r"(?:local-mechanism|code-checks)\S*\.", r"checks(?:\[\d+\])?\.", r"verification\."),
    "ground motion and spectrum": (r"^motion", r"^shake-table"),
    "displacement": (r"dowel", r"slip_m$", r"displacement_m$", r"permanent_elongation"),
    "tail of a load curve": (r"measured\.tail_ratios", r"\.last_load_N$"),
    "event of sequentially linear analysis": (
        r"first_event",
        r"peak_event",
        r"events_without",
        r"(?:sla|pushover)\S*\.stop$",
        r"\.teeth$",
        r"initial_stiffness",
    ),
    "peak load": (r"(?:sla|pushover)\S*\.(?:minus\.)?peak_", r"measured\.peak_ratio", r"scatter\.", r"\.greatest_load_N$"),
    "displacement at a loss of capacity": (r"axial_loss_", r"drop_d"),
    "load at a displacement": (r"probe_loads_N", r"stages\.end_load_N", r"band_N"),
    "energy": (
        r"energy_residual",
        r"step_balance",
        r"work_J$",
        r"work_gap_J",
        r"crack_energy_J",
        r"dissipated_energy_J",
        r"released_energy_J",
        r"work_residual",
        r"\.energy_ratio$",
    ),
    "equilibrium and duality": (
        r"duality_gap",
        r"equilibrium_residual",
        r"step_residual",
        r"line_residual",
        r"complementarity",
        r"violation_ratio",
    ),
    "hinge place": (r"hinges(?:\.joint|\.side|$)", r"worst_place", r"mechanisms\.", r"weakest", r"crack_height_ratio"),
    "friction": (r"required_friction", r"friction_threshold"),
    "thrust and reaction": (
        r"\.(?:least|most)\.",
        r"admissible_interval",
        r"feet\.",
        r"thrust_at_rest",
        r"least_part_of_joints",
        r"sections\.(?:least|central|greatest)_N",
    ),
    "force in a tie, a wall or a restraint": (r"ties(?:_opposite)?\.", r"bars\.", r"pushover\S*\.walls\.", r"seats\.", r"restraints\."),
    "movement of supports": (r"movement_at_fall", r"openings\."),
    "angle of tilt": (r"tilt_angle",),
    "capacity under live load": (r"moving-load\S*\.(?:safety_factor|adequacy_factor|collapse_load_N|permissible_factor|status)",),
    "assessment": (r"^assess", r"cross_check", r"agreement$"),
    "failing amplitude or duration of a pulse": (
        r"durations_s",
        r"mode_I{1,2}\.",
        r"amplitudes_g",
        r"curves\.(?:cycles|static|run_outcomes)",
        r"cap_ratio",
        r"pocket_begins",
        r"scaling_misfit",
        r"greatest_misfit",
    ),
    "probability": (r"fragility\S*\.(?!mean_peak|histories)", r"(?:median|probability)$", r"share_of_starts"),
    "weight and other data": (
        r"weight_N",
        r"frame-\S*\.(?:piers|spandrels|moving_mass_kg|steps|histories)$",
        r"flanges",
        r"survey\.sections",
    ),
    "capacity in acceleration": (
        r"collapse_acceleration",
        r"uplift",
        r"(?:least|greatest)_acceleration_g",
        r"base_shear_coefficient",
        r"sliding_capacity_N",
        r"frame-pushover\.(?:base_shear_N|ring_beam_moment_Nm)",
        r"associated_g",
        r"pyramids\.",
        r"stable_limits",
        r"optimum",
        r"fracture\.ratio",
        r"buttress_alone",
        r"sweep\.changes",
        r"soft_base\.capacity_g",
        r"tilt\S*\.status",
        r"survey\.standing",
        r"margin",
    ),
    "restitution": (r"restitution", r"rebound$"),
    "frequency and period": (r"frequency_parameter", r"period_s$", r"frequency_Hz$"),
    "stress": (r"stress_at_rest_Pa$",),
    "damping and stiffness of contacts": (r"damping_ratio", r"critical_beta", r"joint_stiffness"),
    "time and number of impacts": (r"bounces$", r"airborne_time", r"impact_times", r"impacts$", r"half_cycle", r"collapse_time"),
    "rotation": (r"rotation_rad", r"peak_rotation_upper", r"critical_rotation", r"rotation_ratio"),
    "slip": (r"_slip_m$",),
    "outcome in words": (r"outcome$", r"\.verdict$"),
}


def quantity_of(name: str) -> str:
    """The quantity that a row's `analysis.key[0].sub` is a number of.

    Raises ValueError for an unnamed one.
    """
    bare = re.sub(r"\[\d+\]", "", name)
    for quantity, patterns in QUANTITIES.items():
        if any(re.search(pattern, bare) for pattern in patterns):
            return quantity
    raise ValueError(f"{name}: tools/verification_quantities.py names no quantity that it belongs to")
