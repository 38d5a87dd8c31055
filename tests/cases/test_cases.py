"""Every row of cases/**/*.expect.toml, and every figure of cases: a deck is computed once for its rows, the book and its figures."""

import os
from pathlib import Path

import kept
import numpy as np
import pytest
from expectations import CASES, Case, energy_regained, falling_energies, load_cases
from figure_faults import watch_figures

import extrados

ALL = load_cases()
#: In the long suite the figures of each deck are drawn from the same run
WHOLE = float(os.environ.get("EXTRADOS_TRIALS", "0")) > 0.0
DECKS = sorted(p for p in CASES.rglob("*.toml") if not p.name.endswith(".expect.toml"))
DRAWN = {case.deck for case in ALL if WHOLE and any(not row.change for row in case.rows)}


def _groups() -> list:
    found = []
    for case in ALL:
        for change in dict.fromkeys(row.change for row in case.rows):
            marks = [pytest.mark.verify] if case.slow else []
            found.append(pytest.param(case, change, id=kept.name_of(case, change), marks=marks))
    return found


@pytest.mark.parametrize(("case", "change"), _groups())
def test_case(case: Case, change: tuple, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    run, values = kept.compute(case, change)
    rows = [row for row in case.rows if row.change == change]
    wrong = [
        f"{row.quantity} = {found!r}, expected {row.value} +- {row.allowed:g} ({row.kind}: {row.source})"
        if not isinstance(row.value, str)
        else f"{row.quantity} = {found!r}, expected {row.value!r}"
        for row, found in zip(rows, values, strict=True)
        if not row.fits(found)
    ]
    wrong += falling_energies(run)
    assert not wrong, "\n".join(wrong)
    if case.deck in DRAWN and not change:
        assert not watch_figures(run, tmp_path, monkeypatch).wrong


@pytest.mark.verify
@pytest.mark.parametrize("deck", [d for d in DECKS if d not in DRAWN], ids=lambda p: str(p.relative_to(CASES).with_suffix("")))
def test_figures_can_be_read(deck: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """No figure has text that is cut by its edge or covers another."""
    assert not watch_figures(extrados.run(deck), tmp_path, monkeypatch).wrong


def test_an_energy_that_falls_between_states_is_seen() -> None:
    """Between two states alone: events without equilibrium, and rows that are no states, are no path of the structure."""
    columns = {"lost": [0.0, 2.0, 1.5, 1.0, 3.0], "external": [0.0, 5.0, 6.0, 7.0, 10.0], "equilibrium": [1, 1, 1, 0, 1], "state": [1] * 5}
    event = {name: np.array(values) for name, values in columns.items()}
    assert energy_regained(event) == pytest.approx(0.05)
    assert energy_regained({**event, "equilibrium": np.array([1, 1, 0, 0, 1])}) == 0.0
