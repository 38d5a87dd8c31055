"""Numbers and verdicts as engineers read them: units, checks of codes, conditions of a deck."""

import pytest

import extrados
from extrados.results.verdict import outcome_words
from extrados.schema.quantities import engineering

FLOOR = {"height": 6.0, "building_height": 9.0, "storeys": 3}
PULSE = {"kind": "sine-pulse", "amplitude": "0.3 g", "period": 0.6}
WALL = {"kind": "block", "width": 0.4, "height": 2.0}
ACTION = {"jurisdiction": "NTC", "accelerations": ["0.3 g"]}


@pytest.mark.parametrize(
    ("value", "unit", "told"),
    [
        (3e6, "Pa", "3.00 MPa"),
        (2.0e5, "Pa", "0.200 MPa"),
        (6.9e9, "Pa", "6.90 GPa"),
        (1234.0, "Pa", "1.23 kPa"),
        (0.0, "Pa", "0 Pa"),
        (-41234.0, "N", "-41.2 kN"),
        (1.2345e6, "N", "1230 kN"),
        (55.61, "N", "55.6 N"),
        (4.2e10, "Pa/m", "42.0 GPa/m"),
        (60.0, "N/m", "60.0 N/m"),
        (0.9996, "m", "1.00 m"),
        (2000.0, "kg/m^3", "2000 kg/m^3"),
    ],
)
def test_three_figures_in_units_of_engineers(value: float, unit: str, told: str) -> None:
    assert engineering(value, unit) == told


def test_answers_have_no_powers_of_pascals() -> None:
    deck = {"structure": WALL, "material": {"compressive_strength": "3 MPa"}, "motion": PULSE, "analysis": [{"kind": "tilt"}]}
    answer = extrados.run(deck).summary["analyses"][0]["answer"]
    assert "compressive strength 3.00 MPa (deck)" in answer and "e+0" not in answer


def test_a_check_is_not_satisfied_and_a_building_collapses() -> None:
    asked = {"kind": "assess", "budget": 5, "strategies": ["tilt", "code-checks"], "advise": False}
    run = extrados.run({"structure": WALL, "code": ACTION, "motion": PULSE, "analysis": [asked]})
    statement = run["assess"].statement
    assert statement.startswith(
        "The block collapses under the one strategy that has a verdict, limit analysis and the check by codes is not satisfied."
    )
    assert "collapses by codes" not in statement
    rows = {v.strategy: v.verdict_words for v in run["assess"].verdicts}
    assert rows == {"tilt": "collapses", "code-checks": "not satisfied"}
    (code,) = (a for a in run.summary["analyses"] if a["kind"] == "code-checks")
    assert "governs and is not satisfied" in code["verdict"]["statement"]
    assert (outcome_words("stands", True), outcome_words("open", True)) == ("satisfied", "open")


def test_a_floor_is_one_condition_and_no_warning() -> None:
    deck = {"structure": WALL, "motion": {**PULSE, "floor": FLOOR}, "analysis": [{"kind": "tilt"}, {"kind": "rocking"}]}
    run = extrados.run(deck)
    (condition,) = run.summary["deck"]["conditions"]
    assert "6 m" in condition and "9 m" in condition and "T_1 = 0.26 s" in condition
    assert not any("floor" in w.lower() for a in run.summary["analyses"] for w in a["warnings"])
