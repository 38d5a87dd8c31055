"""No figure of any case has text that is cut by its edge or lies over another."""

from pathlib import Path

import pytest
from figure_faults import Watch

import extrados
from extrados.show import report, style

ROOT = Path(__file__).resolve().parents[2]
DECKS = sorted(p for p in (ROOT / "cases").rglob("*.toml") if not p.name.endswith(".expect.toml"))


@pytest.mark.verify
@pytest.mark.parametrize("deck", DECKS, ids=lambda p: str(p.relative_to(ROOT / "cases").with_suffix("")))
def test_figures_can_be_read(deck: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    run = extrados.run(deck)
    watch = Watch()
    monkeypatch.setattr(style, "write", watch)
    monkeypatch.setattr(report, "_drawn", lambda tasks: [report._draw_one(*task) for task in tasks])
    report.draw(run, tmp_path)
    assert not watch.wrong
