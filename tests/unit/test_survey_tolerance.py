"""Gaps, overlaps and imperfect corners of surveys: the tolerances that mend them, and what they change."""

from typing import Any

import numpy as np
import pytest
from surveys import box, rows, run

from extrados.analyses.context import Context
from extrados.analyses.sequence import run_analyses
from extrados.decks.reader import make_deck
from extrados.model.geometry.contacts import find_contacts
from extrados.model.geometry.drawing import Drawing
from extrados.model.geometry.inspection import inspect

# --- gaps and overlaps


def leaning(gap: float) -> list[dict[str, Any]]:
    """A tall pier beside a buttress, with a gap between."""
    return rows(box("pier", 0.0, 0.0, 1.0, 4.0), box("buttress", 1.0 + gap, 0.0, 0.8, 2.0))


def test_a_gap_changes_no_capacity_in_silence() -> None:
    closed, apart = run({"block": leaning(0.0)}), run({"block": leaning(3e-4)})
    assert closed.warnings == [] and closed["collapse_acceleration_g"] > 1.1 * apart["collapse_acceleration_g"]
    told, both = apart.warnings
    for words in ("'pier' and 'buttress' are 0.3 mm apart", "x = 1 m", 'contact_tolerance = "0.31 mm" would close this gap'):
        assert words in told
    mended = run({"block": leaning(3e-4), "contact_tolerance": "0.31 mm"})
    assert mended["collapse_acceleration_g"] == pytest.approx(closed["collapse_acceleration_g"], rel=1e-3)
    assert "closed within `contact_tolerance`" in mended.warnings[0]
    assert f"the collapse acceleration to +x is {mended['collapse_acceleration_g']:.4f} g" in both
    # A mended joint lies midway between the two faces.
    assert mended["joint_p"][:, 0].tolist().count(1.00015) == 1


def test_every_gap_and_overlap_with_the_tolerance_that_mends_it() -> None:
    blocks = [box("a", 0, 0), box("b", 1.0004, 0), box("c", 0, 0.9985, 2.0004, 0.5), box("far", 0, 1.51, 1.0, 0.5)]
    found = inspect(Drawing(blocks), None, 1e-4)
    told = {(found.between(f), f.kind): (f.depth, found.mends(f)) for f in found.flaws}
    assert told["'a' and 'b'", "gap"] == (pytest.approx(4e-4), pytest.approx(4.1e-4))
    assert told["'a' and 'c'", "overlap"] == (pytest.approx(1.5e-3), pytest.approx(1.6e-3))
    assert told["'c' and 'far'", "gap"][0] == pytest.approx(0.0115)  # beyond near misses, but nothing else holds it
    text = " ".join(found.complaints())
    assert "2 overlaps" in text and '"1.6 mm" would close all' in text and "'far'" in text
    # With the tolerance that is named, it is closed.
    assert inspect(Drawing(blocks[:3]), None, 1.6e-3).complaints() == []
    assert inspect(Drawing(blocks), None, 0.012).complaints() == []
    # What no tolerance mends is said so.
    over = inspect(Drawing([box("one", 0, 0), box("two", 0.5, 0.5)]), None, 1e-4)
    assert over.mends(over.of("overlap")[0]) is None and "draw them again" in over.complaints()[0]


def test_joints_of_faces_that_bend() -> None:
    """A face measured at several points is one joint, however its stretches are ordered; a step in it is not lost."""
    lower = np.array([[0, 0], [3, 0], [3, 1.0], [2, 1.004], [1, 0.997], [0, 1.0]])
    upper = np.array([[0, 1.001], [1.4, 0.999], [3, 1.002], [3, 2], [0, 2]])
    found = find_contacts([lower, upper], np.empty((0, 4)), 6e-3)
    assert len(found.a) == 1 and np.hypot(*(found.q - found.p)[0]) == pytest.approx(3.0, abs=1e-3)
    step = np.array([[0, 0], [2, 0], [2, 1.2], [1, 1.2], [1, 1.0], [0, 1.0]])
    above = np.array([[0, 1.0], [1, 1.0], [1, 1.2], [2, 1.2], [2, 2.0], [0, 2.0]])
    assert len(find_contacts([step, above], np.empty((0, 4)), 1e-4).a) == 3


# --- imperfect geometry


def test_random_surveys_give_a_band() -> None:
    """A block bears width over height; surveys within d of it differ by at most what the corners can do."""
    block = rows(box("block", 0, 0, 1.0, 4.0))
    found = run({"block": block}, kind="imperfections", deviation="10 mm", count=300)
    assert found["given_collapse_acceleration_g"] == pytest.approx(0.25)
    low, median, high = (found[f"{word}_collapse_acceleration_g"] for word in ("low", "median", "high"))
    assert 0.25 - 0.0075 < found["least_collapse_acceleration_g"] < low < median < high < 0.25 + 0.0025
    assert high - low > 0.001 and found["cannot_stand"] == 0 and found["gamma"].shape == (300, 2)
    again = run({"block": block}, kind="imperfections", deviation="10 mm", count=300)
    other = run({"block": block}, kind="imperfections", deviation="10 mm", count=300, seed=2)
    assert (found["gamma"] == again["gamma"]).all() and (found["gamma"] != other["gamma"]).all()
    small = run({"block": block}, kind="imperfections", deviation="0.1 mm", count=50)
    assert small["high_collapse_acceleration_g"] - small["low_collapse_acceleration_g"] < 0.02 * (high - low)
    # Without one given it is the contact tolerance; other structures must be told.
    assert run({"block": block}, kind="imperfections", count=10)["deviation_m"] == 1e-4
    arch = make_deck(
        {
            "structure": {"kind": "arch", "radius": 10.0, "thickness": 1.5, "embrace": 150.0, "voussoirs": 9},
            "analysis": {"kind": "imperfections"},
        }
    )
    assert "give the key `deviation`" in run_analyses(Context(arch, threads=1))[0].reason
    assert "1/4 of the shortest joint" in run({"block": block}, kind="imperfections", deviation=0.3, count=10).reason


def test_surveys_that_cannot_stand_belong_to_the_band() -> None:
    """An arch near its least thickness: some surveys fall, and count as nothing borne."""
    arch = make_deck(
        {
            "structure": {"kind": "arch", "radius": 10.0, "thickness": 1.09, "embrace": 180.0, "voussoirs": 36},
            "joints": {"friction": "no-sliding"},
            "analysis": {"kind": "imperfections", "deviation": "60 mm", "count": 60},
        }
    )
    found = run_analyses(Context(arch, threads=1))[0]
    assert 0 < found["cannot_stand"] < 60 and found["least_collapse_acceleration_g"] == 0.0
    assert found["cannot_stand"] == int(np.isnan(found["gamma"]).any(axis=1).sum())
