"""Figures: laid out once, drawn once for each format, and the same whether processes share the work or not."""

import threading
from pathlib import Path

import pytest
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine

import extrados
from extrados.results.store import StoreError
from extrados.show import report, style

DECK = {
    "structure": {"kind": "arch", "radius": 1.0, "thickness": 0.2, "embrace": 150.0, "voussoirs": 9},
    "motion": {"kind": "step-pulse", "amplitude": "0.6 g", "duration": 0.1},
    "analysis": [{"kind": "tilt"}, {"kind": "rocking"}],
}


def test_one_layout_and_one_drawing_for_each_format(tmp_path, monkeypatch) -> None:
    counted = {"layout": 0, "drawing": 0}
    execute, draw = ConstrainedLayoutEngine.execute, Figure.draw

    def lay_out(self, fig):
        counted["layout"] += 1
        return execute(self, fig)

    def drawn(self, renderer):
        counted["drawing"] += 1
        return draw(self, renderer)

    monkeypatch.setattr(ConstrainedLayoutEngine, "execute", lay_out)
    monkeypatch.setattr(Figure, "draw", drawn)
    with style.figure() as (fig, (ax,)):
        ax.plot([0, 1], [2, 3], label="line")
        ax.set_xlabel("a label")
        style.save(fig, tmp_path, "one")
        left = ax.get_position().x0
    assert counted == {"layout": 1, "drawing": 2}
    assert left != pytest.approx(0.125), "room for the labels was made"
    assert (tmp_path / "figures" / "one.png").stat().st_size > 0
    assert "<svg" in (tmp_path / "figures" / "one.svg").read_text()


def test_side_by_side_or_one_after_the_other(tmp_path, monkeypatch) -> None:
    """The same bytes; a process with threads of its own draws alone."""
    run = extrados.run(DECK, tmp_path / "one", figures=True)
    monkeypatch.setattr(threading, "active_count", lambda: 2)
    monkeypatch.setattr(report, "side_by_side", lambda *_: pytest.fail("it forked"))
    run.write(tmp_path / "two")
    names = sorted(p.name for p in (tmp_path / "one" / "figures").iterdir())
    assert names and names == sorted(p.name for p in (tmp_path / "two" / "figures").iterdir())
    for name in names:
        assert (tmp_path / "one" / "figures" / name).read_bytes() == (tmp_path / "two" / "figures" / name).read_bytes()


def test_damaged_results_are_named_from_a_worker_too(tmp_path) -> None:
    run = extrados.run(DECK, tmp_path / "run")
    stored = extrados.load(tmp_path / "run")
    del stored.arrays["rocking"]["rotation"]
    (tmp_path / "drawn").mkdir()
    with pytest.raises(StoreError, match="rocking has no array 'rotation'"):
        report.draw(stored, Path(tmp_path / "drawn"))
    assert run.folder == tmp_path / "run"
