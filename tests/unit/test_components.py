"""Components of a record kept together: the plane's direction, one factor, verticals of suites, all directions."""

from pathlib import Path

import motion_files as files
import numpy as np
import pytest

from extrados.analyses.context import Context
from extrados.analyses.sequence import run_analyses
from extrados.core import motion as core_motion
from extrados.core import rocking
from extrados.decks.reader import DeckError, make_deck
from extrados.motions import directions
from extrados.motions.formats.recognise import read_record
from extrados.motions.from_deck import make_motion, suite_members
from extrados.motions.records import RecordError, Treatment, record_motion

STEP = 0.02
T = STEP * np.arange(301)
FIRST = 0.3 * np.sin(9.0 * T) * np.exp(-0.2 * T)
SECOND = 0.2 * np.cos(5.0 * T) * np.exp(-0.1 * T)
UP = 0.4 * np.sin(23.0 * T)
BLOCK = {"kind": "block", "width": 0.5, "height": 2.0}


def put(path: Path, values: np.ndarray, step: float = STEP) -> Path:
    path.write_text(files.at2(980.665 * values, step))
    return path


@pytest.fixture
def three(tmp_path: Path) -> list[Path]:
    return [put(tmp_path / f"{n}.at2", v) for n, v in (("first", FIRST), ("second", SECOND), ("up", UP))]


def deck_motion(folder: Path, **keys):
    return make_motion(make_deck({"motion": keys, "analysis": {"kind": "motion"}}, folder).motion, folder)


def test_rotation_is_exact() -> None:
    for turns, wanted in enumerate((FIRST, SECOND, -FIRST, -SECOND)):
        for whole in (-360.0, 0.0, 720.0):
            assert np.array_equal(directions.rotated(FIRST, SECOND, 90.0 * turns + whole), wanted)
    assert directions.rotated(FIRST, SECOND, 45.0) == pytest.approx((FIRST + SECOND) / np.sqrt(2.0), rel=1e-14)
    assert directions.rotated(FIRST, SECOND, -45.0) == pytest.approx((FIRST - SECOND) / np.sqrt(2.0), rel=1e-13, abs=1e-16)
    assert directions.rotated(np.ones(1), np.zeros(1), 120.0) == pytest.approx(-0.5, rel=1e-14)


@pytest.mark.parametrize("angle", [0.0, 30.0, 90.0])
def test_the_plane_sees_the_rotated_horizontal(tmp_path: Path, three: list[Path], angle: float) -> None:
    plain = [read_record(p).values * 9.80665 for p in three]
    motion = deck_motion(tmp_path, kind="record", file="first.at2", second="second.at2", angle=angle, vertical="up.at2")
    c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    np.testing.assert_allclose(motion.ground.samples, [c * plain[0] + s * plain[1], plain[2]], rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(motion.horizontal, plain[:2], rtol=1e-12)


def test_treatment_and_factor_are_one_for_all(three: list[Path]) -> None:
    """The filter and the rest are linear: each component alone, treated and then put together, is the same."""
    first, second, up = map(read_record, three)
    do = {"time_scale": 1.5, "low_cut": 0.2, "high_cut": 9.0, "baseline": "quadratic", "resample": 0.01}
    whole = record_motion(first, Treatment(**do, pga=2.0, scale=0.5), second=second, angle=60.0, vertical=up)
    alone = [record_motion(r, Treatment(**do)).ground.samples[0] for r in (first, second, up)]
    plane = 0.5 * alone[0] + np.sqrt(0.75) * alone[1]
    factor = 1.0 / np.abs(plane).max()
    assert np.abs(whole.ground.samples[0]).max() == pytest.approx(1.0, rel=1e-12) and whole.ground.step == 0.01
    np.testing.assert_allclose(whole.ground.samples, factor * np.stack([plane, alone[2]]), rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(whole.horizontal, factor * np.stack(alone[:2]), rtol=1e-9, atol=1e-9)


def test_components_must_fit(tmp_path: Path, three: list[Path]) -> None:
    first, second, up = map(read_record, three)
    coarse = read_record(put(tmp_path / "coarse.at2", SECOND, 0.01))
    with pytest.raises(RecordError, match=r"time steps, 0\.02 and 0\.01 s \(coarse\); expected the same step"):
        record_motion(first, second=coarse, angle=10.0, vertical=up)
    short = read_record(put(tmp_path / "short.at2", UP[:-7]))
    motion = record_motion(first, second=second, angle=10.0, vertical=short)
    assert motion.ground.samples.shape == (2, 294) and motion.horizontal.shape == (2, 294)
    assert "301, 301, 294 samples; the longer ones are cut" in motion.notes[0]
    with pytest.raises(RecordError, match="two components"):
        deck_motion(tmp_path, kind="record", file="first.at2", vertical="first.at2")
    for keys in ({"second": "second.at2"}, {"angle": 30.0}):
        with pytest.raises(DeckError, match="angle` requires `second`"):
            deck_motion(tmp_path, kind="record", file="first.at2", **keys)


def test_one_file_of_three_channels(tmp_path: Path) -> None:
    rows = "\n".join(f"{t:.2f},{a:.6f},{b:.6f},{c:.6f}" for t, a, b, c in zip(T, FIRST, SECOND, UP, strict=True))
    (tmp_path / "all.csv").write_text("time (s),NS (g),EW (g),UD (g)\n" + rows)
    table = {"file": "all.csv", "channel": "NS", "second_channel": "EW", "angle": 90, "vertical_channel": "UD"}
    motion = deck_motion(tmp_path, kind="suite", records=[table])
    np.testing.assert_allclose(motion.ground.samples, 9.80665 * np.stack([SECOND, UP]), atol=1e-5)
    assert motion.name == "all NS"


def test_all_directions() -> None:
    """One component alone: RotD100 is its peak, RotD50 that times cos 45; two alike: the peak times sqrt 2, and the peak."""
    peak = np.abs(FIRST).max()
    periods = np.array([0.2, 0.7, 2.0])
    psa = core_motion.response_spectra(FIRST, STEP, periods, [0.05]).psa[0]
    root = np.sqrt(2.0)
    for second, half, full in ((0.0 * FIRST, 1.0 / root, 1.0), (FIRST, 1.0, root)):
        both = np.stack([FIRST, second])
        assert directions.peaks(both) == pytest.approx([half * peak, full * peak], rel=1e-12)
        np.testing.assert_allclose(directions.spectra(both, STEP, periods, 0.05), [half * psa, full * psa], rtol=1e-10)
    # A motion in a circle is as strong in every direction
    circle = directions.peaks(np.stack([np.cos(T), np.sin(T)]))
    assert circle == pytest.approx([1.0, 1.0], rel=1e-4)


def test_motion_reports_all_directions(tmp_path: Path, three: list[Path]) -> None:
    motion = {"kind": "record", "file": "first.at2", "second": "second.at2", "angle": 20.0}
    deck = make_deck({"motion": motion, "analysis": {"kind": "motion", "periods": 12}}, tmp_path)
    (result,) = run_analyses(Context(deck))
    r = result.results
    assert r["rotd100_pga_g"] == pytest.approx(directions.peaks(np.stack([FIRST, SECOND]))[1], rel=1e-5)
    assert r["rotd50_pga_g"] < r["rotd100_pga_g"] and r["pga_g"] <= r["rotd100_pga_g"] and "RotD50" in result.answer
    columns = result.tables["response_spectra"].columns
    assert (columns["psa_rotd100_5"] >= columns["psa_rotd50_5"]).all()
    assert (columns["psa_rotd100_5"] >= 0.999 * columns["psa_5"]).all()


def suite(folder: Path) -> dict:
    records = [{"file": f"h{k}.at2", "vertical": f"v{k}.at2"} for k in range(3)]
    for k, peak in enumerate((0.4, 0.5, 0.6)):
        put(folder / f"h{k}.at2", peak * FIRST / 0.3)
        if k != 1:
            put(folder / f"v{k}.at2", UP)
    return {"kind": "suite", "records": [*records, {"file": "h0.at2"}]}


def test_fragility_feels_the_vertical_of_each_record(tmp_path: Path) -> None:
    motion = suite(tmp_path)
    deck = make_deck({"structure": BLOCK, "motion": motion, "analysis": {"kind": "fragility"}}, tmp_path)
    (result,) = run_analyses(Context(deck))
    ratio, outcome = result.arrays["peak_ratio"].data, result.tables["ensemble"].columns["outcome"]
    assert list(outcome).count("failed") == 1 and outcome[1] == "failed"
    assert any("h1 has no result" in w and "v1.at2: no such file" in w for w in result.warnings)
    for k in (0, 2, 3):
        one = {**motion, "member": k + 1}
        deck = make_deck({"structure": BLOCK, "motion": one, "analysis": {"kind": "rocking"}}, tmp_path)
        (alone,) = run_analyses(Context(deck))
        assert rocking.OUTCOMES[result.arrays["outcome"].data[k]] == alone.results["outcome"]
        assert alone.results["peak_rotation_ratio"] == pytest.approx(ratio[k], rel=1e-6)
        assert np.any(alone.arrays["vertical"].data) == (k != 3)
    # The same horizontal with and without its vertical
    assert 0.0 < ratio[0] < 1.0 and abs(ratio[0] / ratio[3] - 1.0) > 1e-2


def test_a_missing_partner_stays_its_own(tmp_path: Path) -> None:
    deck = make_deck({"motion": suite(tmp_path), "analysis": {"kind": "motion", "periods": 12}}, tmp_path)
    assert len(suite_members(deck.motion, tmp_path)) == 4
    (result,) = run_analyses(Context(deck))
    assert result.results["count"] == 3 and "v1.at2: no such file" in result.warnings[0]
    up = result.tables["ensemble"].columns["vertical_pga_g"]
    assert up[:2] == pytest.approx([0.4, 0.4], rel=1e-2) and np.isnan(up[2])
    assert "rotd50_pga_g" not in result.tables["ensemble"].columns
    with pytest.raises(DeckError, match="give only one of the keys `files`"):
        make_deck({"motion": {**suite(tmp_path), "pattern": "*"}, "analysis": {"kind": "motion"}}, tmp_path)
