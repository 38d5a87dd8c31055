"""The one door for files that decks name: what may be read, and what is refused before it is read."""

import os
import threading
import time
from pathlib import Path

import pytest

from extrados.analyses.context import Context
from extrados.decks.reader import make_deck
from extrados.running.run import compute
from extrados.schema import files
from extrados.schema.files import BadFile

LARGEST = 1_000_000
BLOCK = {"kind": "block", "width": 0.5, "height": 2.0}
ARCH = {"kind": "arch", "radius": 1.0, "thickness": 0.2, "embrace": 150.0, "voussoirs": 7}
PANEL = {"kind": "panel", "width": 1.0, "height": 1.0, "thickness": 0.1}
WALL = {"density": 2000.0, "young": 3e9, "poisson": 0.2, "tensile_strength": 1e5, "fracture_energy": 50.0}

#: Every key of decks that names a file, with the rest of the deck it stands in
DOORS = {
    "record": lambda name: {"motion": {"kind": "record", "file": name, "unit": "g"}, "analysis": {"kind": "motion"}},
    "second": lambda name: {
        "motion": {"kind": "record", "file": "extrados:el-centro-1940", "second": name, "angle": 30.0},
        "analysis": {"kind": "motion"},
    },
    "suite": lambda name: {"motion": {"kind": "suite", "files": [name]}, "analysis": {"kind": "motion"}},
    "spectrum": lambda name: {
        "motion": {"kind": "generated", "spectrum": name, "mmi": 7.0, "duration": 5.0},
        "analysis": {"kind": "motion"},
    },
    "table": lambda name: {
        "motion": {"kind": "compatible", "code": "table", "table": name, "duration": 10.0},
        "analysis": {"kind": "motion"},
    },
    "survey": lambda name: {"structure": ARCH, "analysis": {"kind": "survey", "file": name}},
    "json": lambda name: {"structure": {"kind": "blocks", "file": name}, "analysis": {"kind": "tilt"}},
    "dxf": lambda name: {"structure": {"kind": "blocks", "file": name}, "analysis": {"kind": "tilt"}},
    "mesh": lambda name: {"structure": {"kind": "mesh", "file": name, "thickness": 0.1}, "material": WALL, "analysis": {"kind": "sla"}},
    "outline": lambda name: {
        "structure": {"kind": "panel", "outline": name, "outline_unit": "m", "thickness": 0.1},
        "material": WALL,
        "analysis": {"kind": "sla", "mesh": {"element": "T3", "size": 0.25}},
    },
    "measured": lambda name: {"structure": PANEL, "material": WALL, "analysis": {"kind": "sla", "measured": name}},
    "hazard": lambda name: {
        "structure": BLOCK,
        "motion": {"kind": "suite", "files": ["extrados:el-centro-1940"]},
        "analysis": {"kind": "fragility", "levels": [0.1, 0.2], "hazard": {"file": name}},
    },
    "resume_from": lambda name: {"structure": PANEL, "material": WALL, "analysis": {"kind": "sla", "resume_from": name}},
}
SUFFIX = {"json": ".json", "dxf": ".dxf", "outline": ".dxf", "mesh": ".inp", "resume_from": ""}


def told(key: str, name: str, folder: Path) -> str:
    """Why the deck that names a file has no result."""
    (row,) = compute(Context(make_deck(DOORS[key](name), folder))).analyses
    assert row["status"] == "refused", row
    return row["reason"]


@pytest.fixture
def deck_folder(tmp_path: Path) -> Path:
    folder = tmp_path / "decks"
    folder.mkdir()
    return folder


@pytest.mark.parametrize("key", DOORS)
def test_every_door_stays_in_the_folder(key, deck_folder) -> None:
    suffix = SUFFIX.get(key, ".csv")
    outside = deck_folder.parent / f"outside{suffix}"
    if key == "resume_from":
        outside.mkdir()
    else:
        outside.write_text("1\n2\n3\n")
    (deck_folder / f"link{suffix}").symlink_to(outside)
    for name in (f"../outside{suffix}", f"link{suffix}", f"x/../../outside{suffix}"):
        assert "out of the deck's folder" in told(key, name, deck_folder), name


@pytest.mark.parametrize("key", [key for key in DOORS if key != "resume_from"])
def test_every_door_is_shut_to_pipes_and_devices(key, deck_folder) -> None:
    """A FIFO has no writer and /dev/zero no end: a reader that opened them as files would wait or fill the memory."""
    suffix = SUFFIX.get(key, ".csv")
    os.mkfifo(deck_folder / f"pipe{suffix}")
    assert "no plain file" in told(key, f"pipe{suffix}", deck_folder)
    (deck_folder.parent / f"zero{suffix}").symlink_to("/dev/zero")
    assert "no plain file" in told(key, str(deck_folder.parent / f"zero{suffix}"), deck_folder)
    (deck_folder / f"folder{suffix}").mkdir()
    assert "is a folder" in told(key, f"folder{suffix}", deck_folder)
    with (deck_folder / f"large{suffix}").open("wb") as file:
        os.truncate(file.fileno(), 1_000_000_000)
    assert "1000.0 MB" in told(key, f"large{suffix}", deck_folder)


def test_results_to_resume_from_are_plain_files_of_their_folder(deck_folder) -> None:
    (deck_folder / "old").mkdir()
    (deck_folder / "old" / "summary.json").symlink_to("/dev/zero")
    assert "out of" in told("resume_from", "old", deck_folder)
    assert "no such file" in told("resume_from", "none", deck_folder)


def test_a_mesh_reads_no_other_file(deck_folder) -> None:
    """meshio follows *INCLUDE to any path."""
    (deck_folder / "part.inp").write_text("*Node\n1, 0.0, 0.0\n")
    (deck_folder / "wall.inp").write_text("*NODE\n1, 0.0, 0.0\n *Include, INPUT=part.inp\n")
    assert "several files" in told("mesh", "wall.inp", deck_folder)


def test_links_within_the_folder_are_followed(tmp_path) -> None:
    (tmp_path / "sub").mkdir()
    (tmp_path / "sub" / "a.txt").write_text("within")
    (tmp_path / "link.txt").symlink_to("sub/a.txt")
    (tmp_path / "there").symlink_to("sub")
    for name in ("sub/a.txt", "link.txt", "there/a.txt", "sub/../link.txt"):
        assert files.read(name, LARGEST, tmp_path).text() == "within"
    assert files.read(str(tmp_path / "link.txt"), LARGEST, tmp_path).text() == "within"
    (tmp_path / "round").symlink_to("round")
    with pytest.raises(BadFile):
        files.read("round", LARGEST, tmp_path)


def test_a_link_that_is_put_there_while_we_look_is_not_followed(tmp_path) -> None:
    """What is changed between the look at a name and its opening changes nothing: links are looked through once."""
    inside, outside = tmp_path / "decks", tmp_path / "outside"
    for folder, text in ((inside / "sub", "within"), (outside, "secret")):
        folder.mkdir(parents=True)
        (folder / "a.txt").write_text(text)
    stop = threading.Event()

    def swap() -> None:
        while not stop.is_set():
            (inside / "sub").rename(inside / "aside")
            (inside / "sub").symlink_to(outside)
            (inside / "sub").unlink()
            (inside / "aside").rename(inside / "sub")
            time.sleep(1e-4)  # else, on a slow machine, no look finds the folder itself

    swapper = threading.Thread(target=swap)
    swapper.start()
    found = []
    try:
        tries = 0
        while tries < 3000 or "within" not in found:  # on a busy machine the other thread may long have the better of it
            tries += 1
            try:
                found.append(files.read("sub/a.txt", LARGEST, inside).text())
            except BadFile:
                found.append("")
    finally:
        stop.set()
        swapper.join()
    assert set(found) <= {"within", ""} and "within" in found


def test_a_file_as_large_as_allowed_is_read_and_one_byte_more_is_not(tmp_path) -> None:
    (tmp_path / "a").write_bytes(b"x" * 1000)
    assert len(files.read("a", 1000, tmp_path).content) == 1000
    with pytest.raises(BadFile, match="at most"):
        files.read("a", 999, tmp_path)
