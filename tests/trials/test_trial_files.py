"""Files that are cut, damaged or hostile: read, or refused with a reason; nothing hangs, nothing escapes."""

import random
from pathlib import Path

import numpy as np
import pytest
from test_files import DOORS, SUFFIX
from test_motion_formats import FILES

import trials
from extrados.analyses.context import Context
from extrados.decks.reader import make_deck
from extrados.motions.formats.recognise import read_records
from extrados.motions.formats.record import RecordError
from extrados.running.run import compute
from extrados.schema.files import File

SEED = 5
RECORDS = {name: text.encode() if isinstance(text, str) else text for name, (text, *_) in FILES.items()}


def tried(trial: trials.Trial, name: str, content: bytes) -> None:
    """Read a record: samples that are numbers, or a complaint that names the file."""
    trial.tried += 1
    try:
        with trials.patience(30):
            records = read_records(File(Path(name), content))
        if not records or not all(np.isfinite(r.values).all() for r in records):
            trial.fail(f"{name}: no samples, or some that are no numbers")
    except RecordError as error:
        if name not in str(error):
            trial.fail(f"{name}: the complaint does not name the file: {error}")
    except (Exception, trials.TooLong) as error:
        trial.fail(f"{name}: {type(error).__name__}: {error!s:.200}: {content!r:.500}")


def test_records_cut_at_every_byte() -> None:
    trial = trials.Trial("records-cut", "records cut off at a byte that are neither read nor refused")
    stride = 1 if trials.SHARE >= 1.0 else 97
    for name, content in RECORDS.items():
        for end in range(0, len(content) + 1, stride):
            tried(trial, name, content[:end])
    trial.close(sum(len(c) // stride for c in RECORDS.values()))


def test_damaged_records() -> None:
    """Bits flipped, bytes changed, taken out and put in, lines exchanged, parts of other formats put in."""
    trial = trials.Trial("records-damaged", "damaged records that are neither read nor refused")
    rng = random.Random(SEED)
    names = list(RECORDS)
    for _ in range(least := trials.count_of(5000, 60)):
        name = rng.choice(names)
        raw = bytearray(RECORDS[name])
        for _ in range(rng.randint(1, 6)):
            k = rng.randrange(len(raw))
            match rng.randrange(7):
                case 0:
                    raw[k] ^= 1 << rng.randrange(8)
                case 1:
                    raw[k] = rng.randrange(256)
                case 2:
                    del raw[k : k + rng.randint(1, 50)]
                case 3:
                    raw[k:k] = rng.choice((b"nan", b"1e999", b"-", b"9" * 300, b"\r", b"\0", b"\xff\xfe", b" " * 5000, b"#"))
                case 4:
                    lines = raw.split(b"\n")
                    i, j = rng.randrange(len(lines)), rng.randrange(len(lines))
                    lines[i], lines[j] = lines[j], lines[i]
                    raw = bytearray(b"\n".join(lines))
                case 5:
                    other = RECORDS[rng.choice(names)]
                    at = rng.randrange(len(other))
                    raw[k:k] = other[at : at + 300]
                case _:
                    raw[k:] = raw[k:].replace(rng.choice((b"0", b"1", b" ", b".")), rng.choice((b"", b"9", b"e", b"-")), 3)
            raw = raw or bytearray(b" ")
        tried(trial, name, bytes(raw))
    trial.close(least)


@pytest.mark.parametrize("fill", [" ", "\t", "1", "1 ", "dt ", "units=", "(", "chan 1: ", "NPTS=1"])
def test_a_megabyte_in_a_line_of_any_header(fill) -> None:
    """What is looked for in headers takes time in proportion to them."""
    trial = trials.Trial(f"records-long-{ord(fill[0])}-{len(fill)}", f"headers of a megabyte of {fill!r} that hang")
    size = 1_000_000
    for name, content in RECORDS.items():
        lines = content.split(b"\n")
        for at in (0, 1, 7) if trials.SHARE > 0.0 else (1,):
            if at < len(lines):
                pad = (fill * size)[:size].encode()
                tried(trial, name, b"\n".join([*lines[:at], lines[at] + pad, *lines[at + 1 :]]))
    trial.close(len(RECORDS))


#: What a file may hold that a deck names
HOSTILE = {
    "nothing": b"",
    "zeros": b"\0" * 1000,
    "binary": bytes(range(256)) * 40,
    "UTF-16": "0 1 2\n".encode("utf-16"),
    "no text": b"\xff\xfe\xfd" * 100,
    "one long line": b"1 " * 400_000,
    "deep": b"[" * 100_000,
    "deep objects": b'{"blocks":' * 20_000,
    "a number of a million digits": b'{"blocks": [{"points": [[' + b"9" * 1_000_000 + b", 0], [1, 0], [1, 1]]}]}",
    "beyond numbers": b'{"blocks": [{"points": [[1e999, 0], [1, 0], [1, 1]]}]}',
    "no numbers": b'{"blocks": [{"points": [[NaN, 0], [1, 0], [1, 1]]}]}',
    "escapes": b'{"\\u001b[31m": 1}\n\x1b[31mred\n',
    "formulas": b"=1+1,@x\n-1,+2\n",
    "no elements": b"*NODE\n1, 0, 0\n2, 1, 0\n3, 1, 1\n",
    "elements of nowhere": b"*NODE\n1, 0, 0\n2, 1, 0\n*ELEMENT, TYPE=CPS3, ELSET=a\n1, 1, 2, 99\n",
    "a drawing without an end": b"0\nSECTION\n2\nENTITIES\n0\nLWPOLYLINE\n90\n3\n10\n0\n20\n0\n",
    "a drawing beyond numbers": b"0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n6\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n0\nLWPOLYLINE\n5\n1F\n100\n"
    b"AcDbEntity\n8\n0\n100\nAcDbPolyline\n90\n3\n70\n1\n10\n0\n20\n0\n42\nnan\n10\n1\n20\n0\n42\n1e308\n10\n1\n20\n1\n0\nENDSEC\n0\nEOF\n",
    "a table of nothing": b"name,thickness\n",
    "a table of other keys": b"name,kind,kind\na,b,c\n",
    "a quote without an end": b'name,thickness\n"a,1\n' + b"x" * 200_000,
}


def test_hostile_files(tmp_path) -> None:
    """Each through every door: an answer or a reason, no internal error."""
    trial = trials.Trial("files-hostile", "hostile files that a deck names and that are neither read nor refused in words")
    for key, deck in DOORS.items():
        if key == "resume_from":
            continue
        for what, content in HOSTILE.items():
            name = f"hostile{SUFFIX.get(key, '.csv')}"
            (tmp_path / name).write_bytes(content)
            trial.tried += 1
            try:
                with trials.patience(120):
                    (row,) = compute(Context(make_deck(deck(name), tmp_path))).analyses
                if "internal error" in row["reason"] or (row["status"] != "ok" and not row["reason"]):
                    trial.fail(f"{key}, {what}: {row['reason']}")
            except (Exception, trials.TooLong) as error:
                trial.fail(f"{key}, {what}: {type(error).__name__}: {error!s:.300}")
    trial.close(60)
