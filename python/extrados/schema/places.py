"""Where what extrados ships lies."""

from pathlib import Path

_PACKAGE = Path(__file__).resolve().parents[1]
#: The decks with known answers: within an installed package, or beside the sources
CASES = next((p for p in (_PACKAGE / "cases", _PACKAGE.parents[1] / "cases") if p.is_dir()), _PACKAGE / "cases")
