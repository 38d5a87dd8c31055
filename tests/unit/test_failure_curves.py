"""Failure curves of several structures and trains beside each other, and what motions do to them."""

from pathlib import Path

import pytest

import extrados
from extrados.analyses.rocking.failure_domain import unit_pulse

BLOCK = '[structure]\nkind = "block"\nwidth = 0.5\nheight = 2.0\n'
QUICK = 'kind = "failure-curves"\ndurations = [0.6, 0.9, 1.4]\namplitudes = 20\naccuracy = 1e-3\n'


def run(tmp_path: Path, options: str, motion: str = "", structure: str = BLOCK):
    deck = tmp_path / "deck.toml"
    deck.write_text(f"{structure}\n{motion}\n[[analysis]]\n{QUICK}{options}")
    return extrados.run(deck)


def refused(tmp_path: Path, options: str) -> str:
    found = run(tmp_path, options)
    assert found.analyses[0]["status"] == "refused"
    return found.analyses[0]["reason"]


def test_variants_are_the_structures_themselves(tmp_path: Path) -> None:
    """A curve of a variant is that of a deck with that structure."""
    both = run(tmp_path, "variants = [{ width = 0.5 }, { width = 0.7 }]")["failure-curves"].curves
    for curve, width in zip(both, ("0.5", "0.7"), strict=True):
        alone = run(tmp_path, "", structure=BLOCK.replace("width = 0.5", f"width = {width}"))["failure-curves"].curves[0]
        assert curve.label == f"width {width} m"
        assert curve.amplitudes_g == alone.amplitudes_g
    assert both[0].amplitudes_g[1] < both[1].amplitudes_g[1]


def test_a_train_of_sines(tmp_path: Path) -> None:
    """Three cycles: sines to the end, then nothing; they need less than one where pulses are long."""
    train = unit_pulse("sine", 0.5, 3).ground
    assert train.end == pytest.approx(1.5)
    curves = run(tmp_path, "cycles = [1, 3]")["failure-curves"].curves
    assert [c.label for c in curves] == ["1 cycle", "3 cycles"]
    assert curves[1].amplitudes_g[2] < curves[0].amplitudes_g[2]


def test_motions_have_three_verdicts(tmp_path: Path) -> None:
    """A single sine is its own primary impulse: curve and run agree about it."""
    for share, word in ((0.9, "stands"), (1.1, "fails")):
        edge = run(tmp_path, "")["failure-curves"].curves[0].amplitudes_g[1]
        motion = f'[motion]\nkind = "sine-pulse"\namplitude = "{share * edge:.6f} g"\nperiod = 0.9'
        r = run(tmp_path, "", motion)["failure-curves"]
        assert r.impulses[0].period_s == pytest.approx(0.9, rel=1e-3)
        assert abs(r.impulses[0].amplitude_g) == pytest.approx(share * edge, rel=1e-3)
        assert r.curves[0].curve_verdicts == [word]
        assert r.curves[0].run_outcomes == ["collapse" if word == "fails" else "recovery"]
        assert r.agreement == 1.0


def test_a_period_outside_the_curve_has_no_verdict(tmp_path: Path) -> None:
    motion = '[motion]\nkind = "sine-pulse"\namplitude = "0.3 g"\nperiod = 0.3'
    r = run(tmp_path, "", motion)["failure-curves"]
    assert r.curves[0].curve_verdicts == [None] and r.agreement is None
    assert r.curves[0].static_verdicts == ["fails"]


def test_similar_blocks_fall_on_one_curve(tmp_path: Path) -> None:
    """Four times the size: the same amplitudes at twice the durations."""
    small = run(tmp_path, "")["failure-curves"].curves[0]
    options = "variants = [{ width = 2.0, height = 8.0 }]\n"
    deck = tmp_path / "large.toml"
    deck.write_text(f"{BLOCK}[[analysis]]\n{QUICK.replace('[0.6, 0.9, 1.4]', '[1.2, 1.8, 2.8]')}{options}")
    large = extrados.run(deck)["failure-curves"].curves[0]
    assert large.natural_time_s == pytest.approx(2.0 * small.natural_time_s)
    assert None not in small.amplitudes_g and large.amplitudes_g == pytest.approx(small.amplitudes_g, abs=1e-9)


def test_refusals(tmp_path: Path) -> None:
    assert "deck.toml:12: analysis.variants: variant 1: height: " in refused(tmp_path, "variants = [{ height = -1.0 }]")
    assert "not the kind of the structure" in refused(tmp_path, 'variants = [{ kind = "arch" }]')
    assert "breadth: unknown key" in refused(tmp_path, "variants = [{ breadth = 1.0 }]")
    for options, text in (
        ('pulse = "step"\ncycles = [2]', "has one cycle"),
        ("cycles = [2, 2]", "twice"),
        ("variants = [{ width = 0.4 }, { width = 0.5 }, { width = 0.6 }]\ncycles = [1, 2, 3, 4, 5, 6, 7, 8, 9]", "24 curves"),
    ):
        with pytest.raises(Exception, match=text):
            run(tmp_path, options)
