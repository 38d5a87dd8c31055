"""The reason `code-spectrum` of assess on decks: codes with the motion in place of the site, beside demands by other routes."""

from typing import Any

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import extrados
from extrados.decks.reader import make_deck
from extrados.results.assess import Reason
from extrados.running.run import Run
from extrados.schema.constants import GRAVITY

GARDEN = {"kind": "block", "width": 0.6, "height": 3.0}
PARAPET = {"kind": "blocks", "block": [{"name": "parapet", "points": [[0, 0], [0.3, 0], [0.3, 1.2], [0, 1.2]]}]}
ON_ROOF = {"mechanism": "parapet", "height": 1.2, "thickness": 0.3, "base_height": 9.0, "building_height": 10.2}
PANEL = {"kind": "panel", "width": 2.0, "height": 2.5, "thickness": 0.4, "unit_length": 0.5, "unit_height": 0.25}
PIER = {"axial_load": "80 kN", "diagonal_strength": 0.05e6}


def assessed(structure: dict, code: dict, peak: float, period: float = 0.5, codes: dict | None = None, **more: Any) -> Run:
    """The assessment by limit analysis, rocking and codes under a sine pulse of a peak [g] and a period [s]."""
    asked = {"strategies": ["tilt", "rocking", "code-checks"], "budget": 10, "advise": False, **more}
    tables = {
        "structure": structure,
        "material": {"density": 1800.0, "compressive_strength": "3 MPa"} if structure is PANEL else {"density": 1800.0},
        "joints": {"friction": 0.9},
        "code": code,
        "motion": {"kind": "sine-pulse", "amplitude": f"{peak!r} g", "period": period},
        "analysis": [{"kind": "assess", **asked, "options": {"code-checks": codes or {}}}],
    }
    return extrados.run(make_deck(tables))


def reason_of(run: Run) -> Reason | None:
    return next((r for r in run["assess"].reasons if r.rule == "code-spectrum"), None)


def answer_of_oscillator(peak: float, pulse: float, period: float, damping: float) -> float:
    """Greatest displacement [m] of an oscillator under the sine pulse, by integration in time."""
    omega = 2.0 * np.pi / period

    def rate(t: float, state: np.ndarray) -> list[float]:
        ground = peak * GRAVITY * np.sin(2.0 * np.pi * t / pulse) if t <= pulse else 0.0
        return [state[1], -ground - 2.0 * damping * omega * state[1] - omega**2 * state[0]]

    path = solve_ivp(rate, (0.0, pulse + period), [0.0, 0.0], max_step=min(pulse, period) / 40.0)
    return float(np.abs(path.y[0]).max())


@pytest.mark.parametrize(("state", "share", "factor", "damping"), [("SLV", 0.4, 1.68, 0.08), ("SLC", 0.6, 1.56, 0.10)])
def test_a_garden_wall_that_the_site_overturns_and_the_motion_does_not(state: str, share: float, factor: float, damping: float) -> None:
    """d_SLV and d_SLC against the greatest displacement of oscillators up to T_SLV and T_SLC."""
    code = {"jurisdiction": "NTC", "limit_states": [state], "accelerations": ["0.5 g"]}
    run = assessed(GARDEN, code, 0.15)
    found = reason_of(run)
    assert found.explains == [["tilt", "code-checks"], ["rocking", "code-checks"]] and run["assess"].unexplained == []
    period = factor * np.pi * np.sqrt(share * 0.3 / (0.2 * GRAVITY / 1.35 * (1.0 - share)))
    by_hand = max(answer_of_oscillator(0.15, 0.5, period * k / 12, damping) for k in range(3, 13))
    assert found.numbers["motion"] == pytest.approx(by_hand, rel=0.01)
    assert found.numbers["other_margin"] == pytest.approx(share * 0.3 / by_hand, rel=0.01) and found.numbers["governing_margin"] < 1.0
    (probe,) = (p for p in run["assess"].probes if p.strategy == "code-checks")
    assert probe.outcome == "stands" and f"at {state}" in probe.changed


def test_a_garden_wall_that_the_motion_overturns_and_the_site_does_not() -> None:
    run = assessed(GARDEN, {"jurisdiction": "NTC", "accelerations": ["0.05 g"]}, 0.6, 1.0)
    found = reason_of(run)
    assert found.explains == [["tilt", "code-checks"], ["rocking", "code-checks"]]
    assert found.numbers["other_margin"] == pytest.approx(0.2 / 1.35 / 0.6, rel=1e-3) and "NTC activation" in found.text


def test_damage_that_the_motion_causes_too_is_not_explained() -> None:
    """At SLD the mechanism may not start: .148 g is below the site's .16 g, and below the .15 g of the motion."""
    run = assessed(GARDEN, {"jurisdiction": "NTC", "limit_states": ["SLD", "SLV"], "accelerations": ["0.16 g", "0.3 g"]}, 0.15)
    assert reason_of(run) is None and run["assess"].unexplained == [["rocking", "code-checks"]]
    weaker = assessed(GARDEN, {"jurisdiction": "NTC", "limit_states": ["SLD", "SLV"], "accelerations": ["0.16 g", "0.3 g"]}, 0.14)
    assert ["rocking", "code-checks"] in reason_of(weaker).explains and reason_of(weaker).numbers["motion"] == pytest.approx(0.14, rel=1e-3)


def test_a_motion_of_the_same_peak_explains_nothing_to_statics() -> None:
    """Where the code checks a force, statics and code compare the same peak."""
    arch = {"kind": "arch", "radius": 1.0, "thickness": 0.18, "embrace": 170.0, "voussoirs": 34}
    alike, weaker = (
        assessed(arch, {"jurisdiction": "NTC", "limit_states": ["SLD"], "accelerations": ["0.31 g"]}, a, 0.2) for a in (0.31, 0.2)
    )
    assert reason_of(alike) is None
    found = reason_of(weaker)
    assert ["tilt", "code-checks"] in found.explains and found.numbers["motion"] == pytest.approx(0.2, rel=1e-3)


@pytest.mark.parametrize(("peak", "explained"), [(0.1, True), (0.3, False)])
def test_a_pier_by_the_plateau_of_the_motion(peak: float, explained: bool) -> None:
    """The demand on a pier is N times the plateau of the spectrum over q."""
    run = assessed(PANEL, {"jurisdiction": "NTC", "accelerations": ["0.4 g"]}, peak, codes=PIER, strategies=["rocking", "code-checks"])
    found = reason_of(run)
    assert (found is not None) == explained
    assert (["rocking", "code-checks"] in run["assess"].unexplained) != explained
    if found is not None:
        periods = np.arange(0.1, 0.71, 0.05)
        plateau = max(answer_of_oscillator(peak, 0.5, t, 0.05) * (2.0 * np.pi / t) ** 2 for t in periods)
        q, load = run["code-checks"].behaviour_factor, 1800.0 * 2.0 * 2.5 * 0.4 * GRAVITY + 80e3
        assert found.numbers["motion"] == pytest.approx(plateau / GRAVITY * load / q, rel=0.03) and "kN" in found.text


@pytest.mark.parametrize(
    ("code", "passing", "failing", "by_hand"),
    [
        # C_p of C(0) = peak, C_Hi 2.5, C_i by T_p; EN 1998-1: resonance, 3 (1 + z/H) - 0.5
        ({"jurisdiction": "NZSEE", "hazard_factor": 0.5}, 0.05, 0.1, 0.0610),
        ({"jurisdiction": "EN1998", "accelerations": ["0.3 g"]}, 0.04, 0.1, 0.04 * (3.0 * (1.0 + 9.0 / 10.2) - 0.5)),
    ],
)
def test_a_parapet_by_other_codes(code: dict, passing: float, failing: float, by_hand: float) -> None:
    explained, not_explained = (assessed(PARAPET, code, a, codes=ON_ROOF) for a in (passing, failing))
    found = reason_of(explained)
    assert found.explains == [["tilt", "code-checks"], ["rocking", "code-checks"]] and explained["assess"].unexplained == []
    assert found.numbers["motion"] == pytest.approx(by_hand, rel=0.01)
    assert reason_of(not_explained) is None
    assert not_explained["assess"].unexplained == found.explains


def test_codes_that_check_the_motion_need_no_probe() -> None:
    run = assessed(GARDEN, {"jurisdiction": "NTC"}, 0.15)
    assert reason_of(run) is None and not any(p.strategy == "code-checks" for p in run["assess"].probes)
