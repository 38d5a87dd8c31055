"""Supports that move while what stands on them rocks."""

import tomllib

import numpy as np
import pytest

import extrados
from extrados.core.ground import Ground
from extrados.motions.motion import Motion
from extrados.motions.supports import Shift, with_shifts

DECK = """
[structure]
{structure}
[[initial.movements]]
joint = "{joint}"
dx = 0.2
{turn}
[motion]
kind = "sine-pulse"
amplitude = "0.4 g"
period = 0.8
[[analysis]]
kind = "{kind}"
"""
BLOCK = 'kind = "block"\nwidth = 1.0\nheight = 4.0'
SAMPLES = Motion("samples", Ground(samples=np.random.default_rng(1).normal(size=(2, 30)), step=0.1))
PIECES = Motion(
    "pieces",
    Ground(
        breaks=np.array([0.0, 0.7, 2.0]),
        linear=np.random.default_rng(2).normal(size=(2, 1, 2)),
        harmonic=np.random.default_rng(3).uniform(0.5, 3.0, size=(2, 1, 2, 4)),
    ),
)


@pytest.mark.parametrize("motion", [SAMPLES, PIECES, None], ids=["samples", "pieces", "rest"])
def test_accelerations_add_up(motion: Motion | None) -> None:
    shifts = [Shift(0.3, -0.1, 0.45, 0.9), Shift(-0.2, 0.0, 1.0, 2.5)]
    made = with_shifts(motion, shifts)
    time = np.linspace(0.0, 3.4, 1001)[:-1]
    for channel in (0, 1):
        expected = np.zeros(len(time))
        if motion is not None and channel < motion.ground.channels:
            # samples end on their last value, which holds at that instant alone
            expected += motion.sample(time, channel) * (time < motion.end)
        for s in shifts:
            phase = (time - s.start) / s.duration
            way = (s.dx, s.dy)[channel]
            expected += np.where((phase >= 0) & (phase < 1), way / s.duration**2 * 2 * np.pi * np.sin(2 * np.pi * phase), 0.0)
        assert made.sample(time, channel) == pytest.approx(expected, abs=1e-10)


def test_the_support_comes_where_it_should() -> None:
    """Twice integrated, the acceleration is the way."""
    made = with_shifts(None, [Shift(0.3, -0.1, 0.5, 0.8)])
    time = np.linspace(0.0, 1.3, 20001)
    step = time[1]
    for channel, way in ((0, 0.3), (1, -0.1)):
        rate = np.cumsum(made.sample(time, channel)) * step
        assert rate[-1] == pytest.approx(0.0, abs=1e-3)
        assert rate.sum() * step == pytest.approx(way, abs=1e-3)


def told(**words: str) -> tuple[str, str]:
    words = {"structure": BLOCK, "joint": "base", "turn": "", "kind": "rocking", **words}
    (a,) = extrados.run(tomllib.loads(DECK.format(**words))).analyses
    return a["status"], a["reason"]


def test_what_is_not_followed_is_refused_by_name() -> None:
    assert told()[0] == "ok"
    arch = 'kind = "arch"\nradius = 10.0\nthickness = 1.5\nembrace = 157.5\nvoussoirs = 7'
    status, reason = told(structure=arch, joint="joint 0")
    assert status == "refused" and "joint 7 do not move with the other supports" in reason
    assert "rotates" in told(turn="turn = 2.0")[1]
    assert "joint 'head' does not exist" in told(joint="head")[1]
    for kind in ("failure-domain", "assessment"):
        assert "only `rocking` and `dem` can follow" in told(kind=kind)[1]
