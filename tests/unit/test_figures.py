"""Figures can be read: no text is cut by the edge or lies over another. Here a few; of all cases in tests/verification."""

from pathlib import Path

import numpy as np
import pytest
from figure_faults import Watch, faults

import extrados
from extrados.plots import report, style
from extrados.plots.sla import near_the_peak

CASES = Path(__file__).resolve().parents[2] / "cases"
#: Quick decks whose figures are unlike each other
SOME = (
    "vault/vezelay-like",
    "arch/readme",
    "rocking/facade",
    "dem/column",
    "limit/tied-frame",
    "codes/facade",
)


@pytest.mark.parametrize("case", SOME)
def test_figures_can_be_read(case: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    run = extrados.run(CASES / f"{case}.toml")
    watch = Watch()
    monkeypatch.setattr(style, "write", watch)
    monkeypatch.setattr(report, "_drawn", lambda tasks: [report._draw_one(*task) for task in tasks])
    report.draw(run, tmp_path)
    assert watch.found and not watch.wrong


def test_the_test_finds_what_cannot_be_read() -> None:
    with style.figure(3.0, 2.0) as (fig, (ax,)):
        ax.set_title("a title that is far too long for a figure as narrow as this one is")
        ax.text(0.5, 0.5, "under", transform=ax.transAxes)
        ax.text(0.5, 0.5, "over", transform=ax.transAxes)
        fig.get_layout_engine().execute(fig)
        told = faults(fig)
    assert any("is cut" in t for t in told) and any("'under' and 'over' cover" in t for t in told)
    with style.figure(4.0, 3.0) as (fig, (ax,)):
        ax.plot([0, 1], [0, 1], label="line")
        ax.set_title("short")
        ax.legend()
        fig.get_layout_engine().execute(fig)
        assert faults(fig) == []


def test_a_plateau_of_a_mechanism_does_not_shrink_its_curve() -> None:
    """An envelope that goes on for metres is drawn by the way to nearly its greatest load, from where it starts."""
    displacement, load = np.array([0.1, 0.2, 0.3, 50.0]), np.array([0.0, 5.0, 9.9, 10.0])
    assert near_the_peak(displacement, load) == pytest.approx(0.2)
    assert near_the_peak(-displacement, load) == pytest.approx(0.2)
    assert near_the_peak(np.zeros(1), np.zeros(1)) == 0.0
