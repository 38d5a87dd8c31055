"""Decks of surveyed blocks, and drawings of them, for the tests of surveys."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from extrados.analyses.context import Context
from extrados.analyses.sequence import run_analyses
from extrados.decks.reader import make_deck
from extrados.model.geometry.drawing import Polygon
from extrados.results.model import Result

ezdxf = pytest.importorskip("ezdxf")

ROOT = Path(__file__).resolve().parents[2]
CHURCH = ROOT / "cases" / "limit" / "church.toml"
SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])


def box(name: str, x: float, y: float, w: float = 1.0, h: float = 1.0) -> Polygon:
    return Polygon(name, SQUARE * [w, h] + [x, y])


def run(structure: dict[str, Any], folder: Path | None = None, **analysis: Any) -> Result:
    deck = make_deck({"structure": {"kind": "blocks", **structure}, "analysis": {"kind": "tilt", **analysis}}, folder)
    return run_analyses(Context(deck, threads=1))[0]


def rows(*blocks: Polygon) -> list[dict[str, Any]]:
    return [{"name": b.name, "points": b.points.tolist()} for b in blocks]


def sketch(path: Path, draw: Any, unit: int = 6) -> Path:
    document = ezdxf.new("R2010", units=unit)
    draw(document, document.modelspace())
    document.saveas(path)
    return path
