"""Every row of cases/**/*.expect.toml."""

import pytest
from expectations import Case, load_cases, pick, results_of

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
