"""The answer of a run in words, of a wall and of stones."""

from typing import Any


def answer_of_stones(r: dict[str, Any], both: bool, slide: bool) -> str:
    """Of stones that became a mechanism; of others as of a wall. slide: their joints can."""
    if r["peak_load_N"] is None or r["stop"] not in ("mechanism", "no point limits the load") or not r["events"]:
        return answer_of_wall(r, both)
    by_masses = "peak_acceleration_g" in r

    def capacity(of: dict[str, Any]) -> str:
        kilonewtons = f"{of['peak_load_N'] / 1e3:.4g} kN"
        return f"an acceleration of {of['peak_acceleration_g']:.4g} g ({kilonewtons})" if by_masses else kilonewtons

    text = f"The blocks become a mechanism at {capacity(r)}; joints open {'and slide' if slide else 'but do not slide'}."
    if names := r["hinges"]:
        shown = ", ".join(names[:6]) + (f" and {len(names) - 6} more" if len(names) > 6 else "")
        text += f" Hinges: {shown}."
    if both and r.get("minus", {}).get("peak_load_N") is not None:
        text += f" In the opposite sense: {capacity(r['minus'])}."
    return text


def answer_of_wall(r: dict[str, Any], both: bool, row: str = "event") -> str:
    """The peak, and how the run ended; `row`: what the curve consists of."""
    if r["events"] == 0 and r["stop"] == "no point limits the load":
        return "The load has no limit: no part of the wall cracks or crushes under any value of the load."
    if r["events"] == 0 and r["stop"] == "interrupted":
        return "The run was stopped before the first event of the increasing load."
    if r["greatest_load_N"] is None:
        return f"No equilibrium state was found in {r['events']} events. The run ended for this reason: {r['stop']}."
    peaks = r["peak_load_N"] is not None
    text = (
        f"The load {'has its peak at' if peaks else 'has reached'} {r['greatest_load_N'] / 1e3:.4g} kN with a displacement of "
        f"{r['greatest_load_displacement_m'] * 1e3:.4g} mm{'' if peaks else ', without having passed a peak'} ({row} "
        f"{r['greatest_load_event']} of the {r['events']} calculated). The run ended for this reason: {r['stop']}."
    )
    text += steps_in_words(r)
    if both and (minus := r.get("minus", {})).get("greatest_load_N") is not None:
        verb = "peaks at" if minus["peak_load_N"] is not None else "has reached"
        text += f" In the opposite sense the load {verb} {minus['greatest_load_N'] / 1e3:.4g} kN."
    lost = r["events_without_equilibrium"]
    if lost:
        text += f" {lost} events had no equilibrium; the first of them was event {r['first_event_without_equilibrium']}."
    return text


def steps_in_words(r: dict[str, Any]) -> str:
    """What equilibrium iterations have found, where events lost equilibrium."""
    if "equilibrium_steps" not in r:
        return ""
    steps, begin = r["equilibrium_steps"], r["equilibrium_from_m"] * 1e3
    if steps == r["events"]:  # a stage that continues another one
        text = f" All {steps} steps use displacement control, from a displacement of {begin:.3g} mm."
    else:
        text = (
            f" Beyond a displacement of {begin:.3g} mm, single events find no equilibrium, so the run continues "
            f"with {steps} steps in displacement control."
        )
    if r["drop_displacement_m"] is not None:
        text += (
            f" The load drops to 80 % of the peak at a displacement of {r['drop_displacement_m'] * 1000.0:.3g} mm "
            f"(drift {r['drop_drift']:.2%})."
        )
    if r["axial_loss_displacement_m"] is not None:
        text += (
            f" The axial capacity is lost at a displacement of {r['axial_loss_displacement_m'] * 1000.0:.3g} mm "
            f"(drift {r['axial_loss_drift']:.2%}): beyond it, no state carries the constant loads."
        )
    return text
