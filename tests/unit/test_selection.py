"""Records selected by spectrum: the correlation, the conditional mean, factors and limits."""

from pathlib import Path

import numpy as np
import pytest
from motion_files import at2

from extrados.analyses.context import Context
from extrados.analyses.sequence import run_analyses
from extrados.decks.reader import DeckError, make_deck
from extrados.motions.code_spectra import conditional_mean, correlation
from extrados.motions.formats.record import RecordError
from extrados.motions.from_deck import suite_members, suite_motion
from extrados.motions.selection import PERIODS, choose, spectrum_of
from extrados.schema.constants import GRAVITY

TABLE = "period_s,sa_g,sigma_ln\n0.01,0.2,0.5\n0.1,0.4,0.6\n0.5,0.3,0.6\n1.0,0.15,0.7\n4.0,0.02,0.7\n"


def test_correlation_is_one_at_its_own_period_and_falls_with_distance() -> None:
    """Symmetric, 1 at equal periods, 1 - sin(0.366 ln(ratio)) at long ones."""
    t = np.geomspace(0.01, 10.0, 60)
    rows = np.array([correlation(t, float(at)) for at in t])
    assert np.diag(rows) == pytest.approx(1.0, abs=1e-12) and rows == pytest.approx(rows.T, abs=1e-12)
    assert rows.min() > 0.0 and rows.max() <= 1.0 + 1e-12
    assert correlation(np.array([2.0]), 1.0)[0] == pytest.approx(1.0 - np.sin(0.366 * np.log(2.0)))


def test_a_conditional_mean_meets_its_value_and_is_the_median_without_epsilon(tmp_path: Path) -> None:
    (tmp_path / "cms.csv").write_text(TABLE)
    period = np.array([0.01, 0.1, 0.5, 1.0, 4.0])
    median = np.array([0.2, 0.4, 0.3, 0.15, 0.02]) * GRAVITY
    sigma = np.array([0.5, 0.6, 0.6, 0.7, 0.7])
    assert conditional_mean("cms.csv", tmp_path, 0.5, 0.3 * GRAVITY)(period) == pytest.approx(median)
    high = conditional_mean("cms.csv", tmp_path, 0.5, 0.3 * GRAVITY * np.exp(0.6 * 1.5))(period)
    assert high[2] == pytest.approx(median[2] * np.exp(0.9))
    assert high == pytest.approx(median * np.exp(1.5 * sigma * correlation(period, 0.5)))
    with pytest.raises(ValueError, match="outside the table"):
        conditional_mean("cms.csv", tmp_path, 5.0, 1.0)


def test_the_records_closest_in_shape_are_taken_with_the_best_factor() -> None:
    periods = np.geomspace(0.1, 2.0, PERIODS)
    shape = 1.0 / (1.0 + periods)
    wave = np.exp(0.2 * np.sin(5.0 * np.log(periods)))
    spectra = [shape * 4.0, None, shape * wave, shape * wave**2 * 0.1, np.zeros(PERIODS)]
    found = choose(spectra, periods, lambda t: 2.0 / (1.0 + t), 2, (0.25, 4.0), False)
    assert (
        [one.number for one in found] == [0, 2]
        and found[0].factor == pytest.approx(0.5)
        and found[0].misfit == pytest.approx(0.0, abs=1e-12)
    )
    assert found[1].factor == pytest.approx(2.0 * np.exp(-np.log(wave).mean()))
    assert found[1].misfit == pytest.approx(np.log(wave).std())
    bounded = choose(spectra, periods, lambda t: 2.0 / (1.0 + t), 5, (0.8, 4.0), False)
    assert len(bounded) == 3 and min(one.factor for one in bounded) == 0.8


@pytest.fixture
def suite(tmp_path: Path) -> Path:
    """Six records of sines between .2 and 1.2 s, a table of their magnitudes, and a target."""
    folder = tmp_path / "records"
    folder.mkdir()
    t = 0.01 * np.arange(800)
    lines = ["file,magnitude"]
    for k in range(6):
        period = 0.2 * (k + 1)
        (folder / f"r{k}.AT2").write_text(at2(100.0 * np.sin(2 * np.pi * t / period) * np.exp(-0.5 * t), 0.01))
        lines.append(f"r{k}.AT2,{5.0 + 0.5 * k}")
    (tmp_path / "flat.csv").write_text("\n".join(lines) + "\n")
    (tmp_path / "cms.csv").write_text(TABLE)
    return tmp_path


def motion(**keys: object) -> dict:
    selection = {"code": "table", "table": "cms.csv", "conditional_period": 0.5, "conditional_sa": "0.4 g", "count": 3, **keys}
    return {"kind": "suite", "folder": "records", "selection": selection}


def test_a_deck_takes_the_records_that_are_closest(suite: Path) -> None:
    deck = make_deck({"motion": motion(), "analysis": {"kind": "motion"}}, suite)
    members = suite_members(deck.motion, suite)
    misfits = [m.misfit for m in members]
    assert len(members) == 3 and misfits == sorted(misfits)
    for member in members:  # the conditional mean is met at its period
        one = suite_motion(deck.motion, member, suite)
        if 0.25 < member.factor < 4.0:
            assert spectrum_of(one, np.array([0.5]), 0.05)[0] == pytest.approx(0.4 * GRAVITY, rel=1e-9)
        assert any("selected with the scale factor" in note for note in one.notes)
    result = run_analyses(Context(deck))[0]
    assert (result.results.shortest_s, result.results.longest_s) == (0.05, 2.0)  # the figure draws the band
    assert result.results.count == 3 and "target" in result.arrays and "selected by spectrum" in result.answer


def test_limits_of_a_table_leave_records_out(suite: Path) -> None:
    deck = make_deck({"motion": motion(flatfile="flat.csv", limits={"magnitude": [6.0, 7.0]}), "analysis": {"kind": "motion"}}, suite)
    assert {Path(m.file).name for m in suite_members(deck.motion, suite)} == {"r2.AT2", "r3.AT2", "r4.AT2"}
    for keys, words in (
        ({"flatfile": "flat.csv", "limits": {"distance": [0, 1]}}, "column 'distance' is missing"),
        ({"flatfile": "flat.csv", "limits": {"magnitude": [8.0, 9.0]}}, "no record of the suite lies within"),
        ({"flatfile": "../flat.csv", "limits": {"magnitude": [8.0, 9.0]}}, "out of the deck's folder"),
    ):
        wrong = make_deck({"motion": motion(**keys), "analysis": {"kind": "motion"}}, suite)
        with pytest.raises(RecordError, match=words):
            suite_members(wrong.motion, suite)


def members_of(folder: Path, **keys: object) -> list:
    deck = make_deck({"motion": motion(**keys), "analysis": {"kind": "motion"}}, folder)
    return suite_members(deck.motion, folder)


def test_a_selection_of_no_record_is_refused_with_the_first_reason(suite: Path) -> None:
    for k in range(6):
        (suite / "records" / f"r{k}.AT2").write_text("no numbers\n")
    with pytest.raises(RecordError, match=r"\[motion.selection\]: none of the 6 records can be read. First reason: .*r0.AT2"):
        members_of(suite)


def test_a_record_that_cannot_be_read_and_a_count_not_reached_are_stated(suite: Path) -> None:
    (suite / "records" / "r0.AT2").write_text("no numbers\n")
    members = members_of(suite, count=6)
    assert len(members) == 5
    deck = make_deck({"motion": motion(count=6), "analysis": {"kind": "motion"}}, suite)
    stated = " ".join(run_analyses(Context(deck))[0].warnings)
    assert "6 records were requested, but only 5 are selected; 1 record(s) cannot be read: " in stated and "r0.AT2" in stated
    assert not any("requested" in note for note in members_of(suite, count=5)[1].notes)


def test_a_flatfile_is_matched_by_path_and_by_base_name_if_unique(suite: Path) -> None:
    other = suite / "records" / "other"
    other.mkdir()
    (other / "r0.AT2").write_text((suite / "records" / "r5.AT2").read_text())
    keys = {"flatfile": "flat.csv", "limits": {"magnitude": [6.0, 7.0]}}
    named = {"kind": "suite", "files": ["records/r0.AT2", "records/other/r0.AT2"], "selection": motion(**keys)["selection"]}
    deck = make_deck({"motion": named, "analysis": {"kind": "motion"}}, suite)
    with pytest.raises(RecordError, match=r"records/other/r0\.AT2 and records/r0\.AT2"):  # the table says r0.AT2
        suite_members(deck.motion, suite)
    (suite / "flat.csv").write_text("file,magnitude\nrecords/r0.AT2,5\n./records/other/r0.AT2,6.5\n")
    assert [m.file for m in suite_members(deck.motion, suite)] == ["records/other/r0.AT2"]
    (suite / "flat.csv").write_text("file,magnitude\nx/r1.AT2,6.5\ny/r1.AT2,5\n")
    with pytest.raises(RecordError, match=r"flat.csv:3: x/r1.AT2 \(line 2\) and y/r1.AT2 both match the record records/r1.AT2"):
        members_of(suite, **keys)


def test_a_conditional_period_outside_the_band_is_refused(suite: Path) -> None:
    for keys in ({"shortest": 0.6}, {"longest": 0.4}):
        with pytest.raises(DeckError, match=r"motion\.selection\.conditional_period: 0\.5 s is outside"):
            make_deck({"motion": motion(**keys), "analysis": {"kind": "motion"}}, suite)


def test_a_factor_cut_to_its_bound_is_stated(suite: Path) -> None:
    first = members_of(suite, count=6, greatest_factor=0.3)[0]
    cut = [note for note in first.notes if "limited to greatest_factor = 0.3" in note]
    assert first.factor == 0.3 and first.unbounded > 0.3 and len(cut) == 1 and f"({first.unbounded:.3g})" in cut[0]
    assert not any("limited to" in note for note in members_of(suite, greatest_factor=100.0, least_factor=1e-4)[0].notes)


def test_the_factor_refers_to_the_ground_also_under_a_floor(suite: Path) -> None:
    floor = {"height": 9.0, "building_height": 9.0, "building_period": 0.5, "building_damping": 0.02}
    wide = {"greatest_factor": 100.0, "least_factor": 1e-4}
    deck = make_deck({"motion": motion(**wide) | {"floor": floor}, "analysis": {"kind": "motion"}}, suite)
    above, ground = suite_members(deck.motion, suite), members_of(suite, **wide)
    assert [(m.file, m.factor) for m in above] == [(m.file, m.factor) for m in ground]
    amplified = spectrum_of(suite_motion(deck.motion, above[0], suite), np.array([0.5]), 0.05)[0]
    assert amplified > 2.0 * 0.4 * GRAVITY


@pytest.mark.parametrize("kind", ["suite", "generated", "compatible"])
def test_the_motions_of_a_floor_are_compared_with_no_target_of_the_ground(suite: Path, kind: str) -> None:
    """The sets have targets (or an intensity) of the ground; above it they are many times as strong at its period."""
    sets = {
        "suite": motion(),
        "generated": {"kind": "generated", "mmi": 7.0, "duration": 10.0, "lines": 20},
        "compatible": {"kind": "compatible", "code": "EN1998-1", "acceleration": "0.2 g", "duration": 10.0},
    }
    floor = {"height": 9.0, "building_height": 9.0, "building_period": 0.5, "building_damping": 0.02}
    deck = make_deck({"motion": sets[kind] | {"floor": floor}, "analysis": {"kind": "motion", "count": 2}}, suite)
    result = run_analyses(Context(deck))[0]
    r = result.results
    assert "target" not in result.arrays and "line" not in result.arrays and r.shortest_s is None and r.expected_pga_g is None
    assert "motions of a floor" in result.answer and any("not compared" in text for text in result.warnings)


def test_a_changed_file_changes_the_selection(suite: Path) -> None:
    """The flatfile, the target, and the second and vertical components count, not the first component alone."""
    keys = {"flatfile": "flat.csv", "limits": {"magnitude": [6.0, 7.0]}}
    before = members_of(suite, **keys)
    flat = suite / "flat.csv"
    flat.write_text(flat.read_text().replace("r2.AT2,6.0", "r2.AT2,4.25"))
    assert len(before) == 3 and len(members_of(suite, **keys)) == 2
    (suite / "cms.csv").write_text(TABLE.replace("0.3,0.6", "0.31,0.65"))
    deck = {"kind": "suite", "selection": motion(count=1)["selection"]}
    deck["records"] = [{"file": "records/r0.AT2", "second": "records/r1.AT2", "angle": "45 deg"}]
    pair = make_deck({"motion": deck, "analysis": {"kind": "motion"}}, suite)
    first = suite_members(pair.motion, suite)[0].factor
    (suite / "records" / "r1.AT2").write_text((suite / "records" / "r4.AT2").read_text() + "\n")
    assert suite_members(pair.motion, suite)[0].factor != first
    (suite / "cms.csv").write_text(TABLE.replace("4.0,0.02", "4.0,0.05").replace("1.0,0.15", "1.0,0.25"))
    misfit = members_of(suite)[0].misfit
    (suite / "cms.csv").write_text(TABLE)
    assert members_of(suite)[0].misfit != misfit
