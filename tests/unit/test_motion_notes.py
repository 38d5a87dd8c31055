"""What is to be known of a motion stands beside every result that takes it, once."""

from pathlib import Path

import numpy as np
import pytest

import extrados
from extrados import kinds
from extrados.motions.records import locate, read_record

BLOCK = '[structure]\nkind = "block"\nwidth = 1.0\nheight = 4.0\n[joints]\nfriction = 0.7\n'
ARCH = '[structure]\nkind = "arch"\nradius = 10.0\nthickness = 1.5\nembrace = 157.5\nvoussoirs = 7\n[joints]\nfriction = 0.7\n'
RECORD = '[motion]\nkind = "record"\nfile = "offset.csv"\n'
SUITE = '[motion]\nkind = "suite"\nfiles = ["offset.csv", "extrados:el-centro-1940"]\n'

#: kind -> building, and further keys; all that take the motion of a deck, by a driver or by their verdict
HOUSE = """[structure]
kind = "building"
storeys = [3.0]
walls = [
  { name = "front", start = [0, 0], end = [5, 0], thickness = 0.4 }, { name = "back", start = [0, 4], end = [5, 4], thickness = 0.4 },
  { name = "left", start = [0, 0], end = [0, 4], thickness = 0.4 }, { name = "right", start = [5, 0], end = [5, 4], thickness = 0.4 },
]
[material]
density = 1900
young = 2e9
compressive_strength = 3e6
[joints]
cohesion = 1e5
friction = 0.4
"""
USERS = {
    "motion": ("", "periods = 10"),
    "rocking": (BLOCK, ""),
    "tilt": (BLOCK, ""),
    "assessment": (ARCH, ""),
    "fragility": (BLOCK, "count = 1"),
    "rocking-spectrum": (BLOCK, "periods = [1.0, 2.0]"),
    "code-checks": (BLOCK, ""),
    "dem": (BLOCK, "end_time = 0.5"),
    "dem-fragility": (BLOCK, 'levels = ["0.01 g"]\ncount = 1\nsettle = 0.0\nsolver = "nonsmooth"'),
    "shake-table": ("", ""),
    "failure-curves": (BLOCK, ""),
    "assess": (BLOCK, "budget = 5.0"),
    "frame-history": (HOUSE, "end_time = 0.5"),
    "frame-fragility": (HOUSE, 'by = "pushover"\ncount = 2\nuncertain = { young = 0.2 }'),
}


def offset(folder: Path, size: float = 0.02) -> None:
    """El Centro with an offset [g], 31 s long, so that its ground ends at 31 x .02 x 9.81 = 6.1 m/s."""
    record = read_record(locate("extrados:el-centro-1940", folder))
    rows = (f"{k * record.step:.2f},{a + size:.6f}\n" for k, a in enumerate(record.values))
    (folder / "offset.csv").write_text("time,acc (g)\n" + "".join(rows))


def warnings_of(folder: Path, text: str) -> list[list[str]]:
    (folder / "deck.toml").write_text(text)
    run = extrados.run(folder / "deck.toml")
    return [a["warnings"] for a in run.analyses if a["status"] != "failed"] or [[a["reason"]] for a in run.analyses]


@pytest.mark.parametrize("kind", USERS)
def test_an_offset_is_reported_by_every_kind(tmp_path, kind) -> None:
    offset(tmp_path)
    building, keys = USERS[kind]
    for motion in (RECORD, SUITE):
        if motion == SUITE and kind in ("tilt", "failure-curves"):
            continue
        (told, *_) = warnings_of(tmp_path, f'{building}{motion}[analysis]\nkind = "{kind}"\n{keys}\n')
        assert len([w for w in told if "offset: at the end of the motion, the ground has a velocity of 6" in w and "0.02 g" in w]) == 1, (
            told
        )


def test_every_kind_is_here_or_takes_no_motion() -> None:
    """The table above misses none whose table says that it needs a motion."""
    for kind, parts in kinds.ANALYSES.items():
        assert kind in USERS or not kinds.load(parts.table).needs_motion, kind


@pytest.mark.parametrize("baseline", ["mean", "quadratic"])
def test_a_baseline_takes_it_off(tmp_path, baseline) -> None:
    offset(tmp_path)
    deck = f'{BLOCK}{RECORD}baseline = "{baseline}"\n[analysis]\nkind = "rocking"\n'
    assert not any("at the end of the motion, the ground" in w for told in warnings_of(tmp_path, deck) for w in told)


def test_a_record_that_ends_at_rest_has_no_note(tmp_path) -> None:
    deck = f'{BLOCK}[motion]\nkind = "record"\nfile = "extrados:el-centro-1940"\n[analysis]\nkind = "rocking"\n'
    assert not any("at the end of the motion, the ground" in w for told in warnings_of(tmp_path, deck) for w in told)


def test_the_vertical_and_the_second_component_are_looked_at_too(tmp_path) -> None:
    offset(tmp_path)
    level = 'file = "extrados:el-centro-1940"\n'
    for key, word in (("vertical", "vertical component"), ("second", "second component")):
        more = "angle = 0\n" if key == "second" else ""
        deck = f'[motion]\nkind = "record"\n{level}{key} = "offset.csv"\n{more}[analysis]\nkind = "motion"\nperiods = 10\n'
        (told,) = warnings_of(tmp_path, deck)
        assert len([w for w in told if f"{word}: at the end of the motion, the ground" in w]) == 1, told


def test_the_numbers_of_a_note(tmp_path) -> None:
    """Velocity and mean against the record's own sum, by the trapezoidal rule."""
    offset(tmp_path)
    values = read_record(tmp_path / "offset.csv").values * 9.80665
    end = 0.02 * float(np.sum(0.5 * (values[1:] + values[:-1])))
    (told,) = warnings_of(tmp_path, f'{RECORD}[analysis]\nkind = "motion"\nperiods = 10\n')
    assert any(f"{end:.3g} m/s" in w for w in told)
