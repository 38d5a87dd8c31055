"""Presets of structures: sizes by name, each of which the deck may overrule."""

from typing import Any


def with_preset(data: Any, presets: dict[str, dict[str, Any]]) -> Any:
    """The keys of a preset, each of which the deck may overrule."""
    if isinstance(data, dict) and isinstance(data.get("preset"), str) and data["preset"] in presets:
        return {**presets[data["preset"]], **data}
    return data
