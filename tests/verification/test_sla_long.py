"""Long runs of sequentially linear analysis: what updates alone leave of the equations, and known curves."""

import numpy as np
import pytest
from bench_sla import Wall

#: event -> load [kN], displacement of the top corner [mm], damaged points (independent program, same tie-breaking)
EXPECTED = {
    500: (35.111, 0.3239, 176),
    1000: (42.846, 0.4310, 301),
    2000: (48.897, 0.5779, 536),
    4000: (52.829, 0.8272, 1087),
    5000: (54.176, 0.9557, 1307),
    10_000: (48.872, 1.8623, 2060),
    15_000: (48.869, 4.5064, 2696),
    20_000: (45.669, 6.8613, 3209),
}


@pytest.mark.verify
def test_twenty_thousand_events_without_a_new_factor() -> None:
    """6598 equations: residual below 1e-8, loads and damage as an independent program found them."""
    from extrados.core.sla import Model, Monitor

    wall = Wall(60)
    with Model(wall.xy, wall.freedoms, [wall.group]) as model:
        model.loads(wall.constant, wall.reference)
        events = model.run(20_000, [Monitor.of(wall.corner, 0)])
    assert len(events) == 20_000
    assert events.guard[0] == 39
    assert events.guard[1:] == (0, 0)
    assert 0.0 < events.residual.max() < 1e-8
    assert events.ledger_error < 1e-9
    for event, (load, displacement, damaged) in EXPECTED.items():
        # after some thousand events rounding may change the order of events: bands, not equality
        band = 1e-4 if event <= 4000 else 0.03
        assert events.load[event - 1] == pytest.approx(load, rel=band)
        assert events.monitors[event - 1, 0] * 1e3 == pytest.approx(displacement, rel=max(band, 2e-4))
        assert len(np.unique(events.point[:event])) == pytest.approx(damaged, rel=max(band, 1e-9))
    peak = int(events.load.argmax())
    assert events.load[peak] == pytest.approx(54.74, rel=0.02)
