"""Presets of structures: sizes by name, each of which the deck may overrule."""

from collections.abc import Mapping
from typing import Any, ClassVar

from pydantic import GetJsonSchemaHandler, model_validator

from extrados.model.structure import Structure


class PresetStructure(Structure):
    """Base of the structure kinds with a key `preset`, whose sizes stand in for those that the deck leaves out."""

    presets: ClassVar[Mapping[str, Mapping[str, Any]]] = {}

    @model_validator(mode="before")
    @classmethod
    def _fill_in(cls, data: Any) -> Any:
        if isinstance(data, dict) and isinstance(data.get("preset"), str) and data["preset"] in cls.presets:
            return {**cls.presets[data["preset"]], **data}
        return data

    @classmethod
    def __get_pydantic_json_schema__(cls, core_schema: Any, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        """Either a preset is named, or all keys stand that have no default."""
        schema = handler.resolve_ref_schema(handler(core_schema))
        needed = [name for name in schema.get("required", []) if name != "kind"]
        given = [name for name in needed if all(name in sizes for sizes in cls.presets.values())]
        schema["required"] = [name for name in schema["required"] if name not in given]
        schema["anyOf"] = [{"required": ["preset"], "properties": {"preset": {"type": "string"}}}, {"required": given}]
        return schema
