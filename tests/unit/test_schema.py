"""The JSON Schema of decks, held against decks by a validator that is not ours."""

import copy
import re
import tomllib
from pathlib import Path
from typing import Any

import pytest

from extrados import kinds
from extrados.decks.explain import json_schema, starter
from extrados.decks.reader import DeckError, make_deck
from extrados.schema.quantities import COMMON, _by_pint, parse

jsonschema = pytest.importorskip("jsonschema")
ROOT = Path(__file__).resolve().parents[2]
DECKS = sorted(p for p in (ROOT / "cases").rglob("*.toml") if not p.name.endswith(".expect.toml"))
ARCH = {"kind": "arch", "radius": 1.0, "thickness": "20 cm", "embrace": 150, "voussoirs": 9}
GOOD: dict[str, Any] = {
    "structure": ARCH,
    "joints": {"friction": 0.5},
    "motion": {"kind": "step-pulse", "amplitude": "0.6 g", "duration": "0.1 s"},
    "analysis": [{"kind": "tilt", "joints": {"friction": "no-sliding"}}, {"kind": "rocking"}],
}


@pytest.fixture(scope="module")
def validator() -> Any:
    schema = json_schema()
    jsonschema.Draft202012Validator.check_schema(schema)
    return jsonschema.Draft202012Validator(schema)


def wrong(validator: Any, data: dict[str, Any]) -> list[str]:
    return [f"{list(e.absolute_path)}: {e.message[:300]}" for e in validator.iter_errors(data)]


@pytest.mark.parametrize("path", DECKS, ids=lambda p: str(p.relative_to(ROOT / "cases")))
def test_every_case_is_valid(validator, path: Path) -> None:
    assert not wrong(validator, tomllib.loads(path.read_text(encoding="utf-8")))


def test_the_deck_of_the_readme_is_valid(validator) -> None:
    decks = re.findall(r"```toml\n(.*?)```", (ROOT / "README.md").read_text(encoding="utf-8"), re.S)
    assert decks
    for text in decks:
        assert not wrong(validator, tomllib.loads(text))


@pytest.mark.parametrize("kind", [kind for there in kinds.TABLES.values() for kind in there])
def test_every_starter_is_valid(validator, kind: str) -> None:
    assert not wrong(validator, tomllib.loads(starter(kind)))


@pytest.mark.parametrize(
    ("place", "value"),
    [
        ("structure.thikness", 0.2),
        ("structure.kind", "arche"),
        ("structure.radius", None),
        ("structure.thickness", [0.2]),
        ("structure.thickness", "20"),
        ("structure.thickness", "twenty cm"),
        ("structure.thickness", "20 s"),
        ("motion.amplitude", "3 kN"),
        ("structure.thickness", True),
        ("structure.voussoirs", 9.5),
        ("structure.voussoirs", "9 m"),
        ("structure.thickness", -1.0),
        ("joints.friction", "none"),
        ("joints.friction", -0.1),
        ("joints.types", [{"friction": 0.5}]),
        ("motion.amplitude", 0.6),
        ("motion.duration", "0,1 s"),
        ("analysis.0.kind", "tlit"),
        ("analysis.0.joints", {"frictoin": 0.5}),
        ("analysis", None),
        ("structur", {}),
        ("structure", {"kind": "vault", "preset": "dejong-c"}),
        ("structure", {"kind": "vault"}),
        ("structure", {"kind": "panel", "width": 1, "height": 1, "thickness": 1, "openings": [{"x": [0, 1, 2], "y": 0}]}),
    ],
)
def test_what_the_reader_refuses_the_schema_rejects(validator, place: str, value: Any) -> None:
    assert not wrong(validator, GOOD)
    make_deck(GOOD)
    data = copy.deepcopy(GOOD)
    *way, last = place.split(".")
    there: Any = data
    for part in way:
        there = there[int(part)] if isinstance(there, list) else there[part]
    if value is None:
        del there[last]
    else:
        there[last] = value
    assert wrong(validator, data)
    with pytest.raises(DeckError):
        make_deck(data)


def test_a_range_is_one_length_or_two(validator) -> None:
    def held(x: Any) -> dict[str, Any]:
        return {**GOOD, "supports": {"held": [{"x": x, "y": 0.0}]}}

    for x in (0.5, "50 cm", [0.0, "1 m"]):
        assert not wrong(validator, held(x))
        make_deck(held(x))
    for x in ("50 kg/", [0.0], "half"):
        assert wrong(validator, held(x))


def test_a_unit_that_only_the_library_knows_is_valid(validator) -> None:
    data = {**GOOD, "structure": {**ARCH, "thickness": "0.6 feet", "embrace": "2.6 radian"}}
    assert not wrong(validator, data)
    make_deck(data)


def test_common_units_are_those_of_the_library() -> None:
    """Bit for bit; and no unit that the schema rejects as one of another kind would be read."""
    for si, units in COMMON.items():
        for unit, value in units.items():
            assert _by_pint(unit, si) == value, (unit, si)
        for other, there in COMMON.items():
            for unit in set(there) - set(units) if other != si else ():
                with pytest.raises(ValueError, match="unit"):
                    parse(f"1 {unit}", si)


def test_definitions_of_different_tables_do_not_collide() -> None:
    """Two tables of one name would silently share one definition."""
    seen: dict[str, dict[str, Any]] = {}
    for section, there in kinds.TABLES.items():
        for kind in there:
            for name, definition in kinds.table(section, kind).model_json_schema().get("$defs", {}).items():
                assert seen.setdefault(name, definition) == definition, name


def test_coordinates_within_the_rounding_of_zero_are_zero() -> None:
    """Scripts that rotate points write 2.2e-16 for 0; a size of 2.2e-16 stays an error."""
    points = [[0.0, 2.2e-16], [1.0, -1.1e-16], [1.0, 3.0], [0.0, 3.0]]
    deck = make_deck({"structure": {"kind": "blocks", "block": [{"points": points}]}, "analysis": {"kind": "tilt"}})
    assert deck.structure.block[0].points[0] == [0.0, 0.0] and deck.structure.block[0].points[1] == [1.0, 0.0]
    with pytest.raises(DeckError, match="not a plausible size"):
        make_deck({"structure": {"kind": "block", "width": 2.2e-16, "height": 1.0}, "analysis": {"kind": "tilt"}})
