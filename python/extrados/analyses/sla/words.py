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

    text = (
        f"The stones become a mechanism at {capacity(r)}; joints open {'and slide' if slide else 'but do not slide'}."
    )
    if names := r["hinges"]:
        shown = ", ".join(names[:6]) + (f" and {len(names) - 6} more" if len(names) > 6 else "")
        text += f" Hinges: {shown}."
    if both and r.get("minus", {}).get("peak_load_N") is not None:
        text += f" In the opposite sense: {capacity(r['minus'])}."
    return text


def answer_of_wall(r: dict[str, Any], both: bool) -> str:
    """The peak, and how the run ended."""
    if r["events"] == 0 and r["stop"] == "no point limits the load":
        return "The load is not limited: nothing in the wall cracks or crushes under it, however large it grows."
    if r["peak_load_N"] is None:
        return f"No state of equilibrium was found in {r['events']} events; the run ended by: {r['stop']}."
    rises = r["stop"] == "number of events" and r["peak_event"] == r["events"]
    text = (
        f"The load {'still rises: it has reached' if rises else 'peaks at'} {r['peak_load_N'] / 1e3:.4g} kN with a displacement of {r['peak_displacement_m'] * 1e3:.4g} mm "
        f"(event {r['peak_event']} of {r['events']}; the run ended by: {r['stop']})."
    )
    if both and r.get("minus", {}).get("peak_load_N") is not None:
        text += f" In the opposite sense it peaks at {r['minus']['peak_load_N'] / 1e3:.4g} kN."
    lost = r["events_without_equilibrium"]
    if lost:
        text += f" {lost} events had no equilibrium, the first was event {r['first_event_without_equilibrium']}."
    return text
