"""Every row of cases/**/*.expect.toml."""

import numpy as np
import pytest
from expectations import Case, energy_regained, load_cases, pick, results_of

ALL = load_cases()


def _groups() -> list:
    found = []
    for case in ALL:
        for change in dict.fromkeys(row.change for row in case.rows):
            name = case.name + "".join(f" {k}={v}" for k, v in change)
            marks = [pytest.mark.verify] if case.slow else []
            found.append(pytest.param(case, change, id=name, marks=marks))
    return found


@pytest.mark.parametrize(("case", "change"), _groups())
def test_case(case: Case, change: tuple) -> None:
    results = results_of(case, change)
    wrong = []
    for row in case.rows:
        if row.change != change:
            continue
        found = pick(results, row.quantity)
        if not row.fits(found):
            wrong.append(
                f"{row.quantity} = {found}, expected {row.value} +- {row.allowed} ({row.kind}: {row.source})"
                if not isinstance(row.value, str)
                else f"{row.quantity} = {found!r}, expected {row.value!r}"
            )
    assert not wrong, "\n".join(wrong)


def test_an_energy_that_falls_between_states_is_seen() -> None:
    """Between two states alone: events without equilibrium, and rows that are no states, are no path of the structure."""
    columns = {"lost": [0.0, 2.0, 1.5, 1.0, 3.0], "external": [0.0, 5.0, 6.0, 7.0, 10.0], "equilibrium": [1, 1, 1, 0, 1], "state": [1] * 5}
    event = {name: np.array(values) for name, values in columns.items()}
    assert energy_regained(event) == pytest.approx(0.05)
    assert energy_regained({**event, "equilibrium": np.array([1, 1, 0, 0, 1])}) == 0.0
