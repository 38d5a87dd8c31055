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

    text = f"The stones become a mechanism at {capacity(r)}; joints open {'and slide' if slide else 'but do not slide'}."
    if names := r["hinges"]:
        shown = ", ".join(names[:6]) + (f" and {len(names) - 6} more" if len(names) > 6 else "")
        text += f" Hinges: {shown}."
    if both and r.get("minus", {}).get("peak_load_N") is not None:
        text += f" In the opposite sense: {capacity(r['minus'])}."
    return text


def answer_of_wall(r: dict[str, Any], both: bool, row: str = "event") -> str:
    """The peak, and how the run ended; `row`: what the curve consists of."""
    if r["events"] == 0 and r["stop"] == "no point limits the load":
        return "The load is not limited: nothing in the wall cracks or crushes under it, however large it grows."
    if r["events"] == 0 and r["stop"] == "interrupted":
        return "The run was stopped before the first event of the growing load."
    if r["greatest_load_N"] is None:
        return f"No state of equilibrium was found in {r['events']} events; the run ended by: {r['stop']}."
    peaks = r["peak_load_N"] is not None
    text = (
        f"The load {'peaks at' if peaks else 'has reached'} {r['greatest_load_N'] / 1e3:.4g} kN with a displacement of "
        f"{r['greatest_load_displacement_m'] * 1e3:.4g} mm{'' if peaks else ' without having passed a peak'} "
        f"({row} {r['greatest_load_event']} of {r['events']}; the run ended by: {r['stop']})."
    )
    text += steps_in_words(r)
    if both and (minus := r.get("minus", {})).get("greatest_load_N") is not None:
        verb = "peaks at" if minus["peak_load_N"] is not None else "has reached"
        text += f" In the opposite sense it {verb} {minus['greatest_load_N'] / 1e3:.4g} kN."
    lost = r["events_without_equilibrium"]
    if lost:
        text += f" {lost} events had no equilibrium, the first was event {r['first_event_without_equilibrium']}."
    return text


def steps_in_words(r: dict[str, Any]) -> str:
    """What equilibrium iterations have found, where events lost equilibrium."""
    if "equilibrium_steps" not in r:
        return ""
    steps, begin = r["equilibrium_steps"], r["equilibrium_from_m"] * 1e3
    if steps == r["events"]:  # a stage that continues another one
        text = f" All {steps} steps are in displacement control, from {begin:.3g} mm."
    else:
        text = f" Single events find no equilibrium beyond {begin:.3g} mm; {steps} steps in displacement control continue from there."
    if r["drop_displacement_m"] is not None:
        text += f" The load drops to 80 % of the peak at {r['drop_displacement_m'] * 1e3:.3g} mm (drift {r['drop_drift']:.2%})."
    if r["axial_loss_displacement_m"] is not None:
        text += (
            f" Axial capacity is lost at {r['axial_loss_displacement_m'] * 1e3:.3g} mm (drift {r['axial_loss_drift']:.2%}): beyond, no "
            "state carries the constant loads."
        )
    return text
