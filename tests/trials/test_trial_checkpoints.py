"""Batches of unfinished runs that were damaged, or made by a stranger with a right checksum: a run resumes to the results of a
whole one, or is refused in words."""

import hashlib
import io
import json
import random
import shutil
import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from test_resume import BLOCK, PULSE
from test_trial_results import damaged

import trials
from extrados.analyses import batches
from extrados.analyses.context import Context
from extrados.decks.reader import read_text
from extrados.results import checkpoint
from extrados.results.store import StoreError
from extrados.running.run import run_to

SEED = 20261128
#: A sweep of a map, one of an ensemble, and a computation whose steps follow from one another
DECKS = {
    "failure-domain": BLOCK
    + '[[analysis]]\nkind = "failure-domain"\nmax_amplitude = "1.2 g"\namplitudes = 8\ndurations = [0.2, 0.4, 0.8]\n',
    "fragility": BLOCK + '[motion]\nkind = "generated"\nmmi = 8\nduration = 2.0\n[[analysis]]\nkind = "fragility"\ncount = 40\n',
    "dem": BLOCK + PULSE + '[[analysis]]\nkind = "dem"\nend_time = 0.1\nvary_damping = [0.5]\n',
}


def forged(content: bytes, rng: random.Random) -> bytes:
    """A batch of a stranger: arrays that are gone, renamed, of another length, axes or kind, objects, a bomb, no archive."""
    with np.load(io.BytesIO(content), allow_pickle=False) as store:
        arrays = {key: store[key] for key in store.files}
    title = rng.choice(list(arrays))
    data = arrays[title]
    out = io.BytesIO()
    match rng.randrange(9):
        case 0:
            del arrays[title]
        case 1:
            arrays[f"{title}_1"] = arrays.pop(title)
        case 2:
            arrays[title] = data[: len(data) // 2] if data.ndim else np.zeros(3)
        case 3:
            arrays[title] = np.full(data.shape, rng.choice((np.nan, np.inf, -1.0, 1e308)))
        case 4:
            arrays[title] = np.array(["text"] * max(data.size, 1))
        case 5:
            arrays = {key: np.zeros((0, 2)) for key in arrays}
        case 6:
            arrays = {}
        case 7:  # numpy's head of an array promises a terabyte
            with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as archive:
                stream = io.BytesIO()
                np.save(stream, np.zeros(4))
                archive.writestr(f"{title}.npy", stream.getvalue().replace(b"(4,)", b"(125000000000,)", 1))
            return out.getvalue()
        case _:
            return rng.choice((b"", b"PK\5\6" + bytes(18), b"\x93NUMPY" + bytes(9), b"mine"))
    np.savez(out, **arrays)
    return out.getvalue()


def attacked(folder: Path, rng: random.Random) -> bool:
    """Damage one to three files of the folder; whether a batch with a right checksum was forged."""
    forgery = False
    files = sorted(folder.rglob("*.npz"))
    for path in rng.sample(files, min(len(files), rng.randint(1, 3))):
        match rng.randrange(10):
            case 0:
                head = folder / checkpoint.HEAD
                head.write_bytes(damaged(head.read_bytes(), rng))
            case 1:
                words = {"sha256": rng.choice((None, 1, [], {}, "x" * 10_000)), "program": rng.choice((checkpoint.program(), None, {}))}
                (folder / checkpoint.HEAD).write_text(json.dumps(rng.choice((words, [], None, "x" * 100_000))))
            case 2:
                _remove(path)
                path.symlink_to(rng.choice(("/dev/zero", "/etc/hostname", str(path), "gone")))
            case 3:
                _remove(path)
                path.mkdir()
            case 4:
                if path.is_file() and not path.is_symlink():
                    path.rename(path.with_name(f"{rng.choice((7, 10**12 - 1, 10**40)):012d}-{path.name.partition('-')[2]}"))
            case 5 | 6:
                if path.is_file() and not path.is_symlink():
                    content = forged(path.read_bytes(), rng)
                    first = int(path.name.partition("-")[0])
                    path.unlink()
                    digest = hashlib.sha256(f"{path.parent.name}\0{first}\0".encode() + content).hexdigest()[:32]
                    path.with_name(f"{first:012d}-{digest}.npz").write_bytes(content)
                    forgery = True
            case _:
                if path.is_file() and not path.is_symlink():
                    path.write_bytes(damaged(path.read_bytes(), rng))
    return forgery


def _remove(path: Path) -> None:
    if path.is_dir() and not path.is_symlink():
        path.rmdir()
    else:
        path.unlink()


@pytest.mark.verify
def test_damaged_batches_of_unfinished_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Damaged ones are computed again, to the same bits. A forged batch with a right checksum is a stranger's claim: the run may believe
    it or refuse it, in words."""
    trial = trials.Trial("checkpoints-damaged", "damaged checkpoints after which a run ends in a traceback, hangs or gives other results")
    rng = random.Random(SEED)
    monkeypatch.setattr(batches, "BATCH_SECONDS", 1e-9)  # a batch after the first has one member
    sound, expected = {}, {}
    with monkeypatch.context() as keeping:
        keeping.setattr(checkpoint, "discard", checkpoint.let_go)
        for kind, text in DECKS.items():
            run = run_to(Context(read_text(text.encode(), "deck.toml", tmp_path)), tmp_path / kind, figures=False)
            assert [result.status for result in run.results] == ["ok"]
            sound[kind] = checkpoint.folder_of(tmp_path / kind)
            sound[kind].rename(tmp_path / f"{kind}.sound")
            expected[kind] = _numbers(run)
            assert len(list((tmp_path / f"{kind}.sound").rglob("*.npz"))) >= 2
    again = refused = believed = 0
    for k in range(least := trials.count_of(500, 12)):
        kind = list(DECKS)[k % len(DECKS)]
        shutil.rmtree(sound[kind], ignore_errors=True)
        shutil.copytree(tmp_path / f"{kind}.sound", sound[kind])
        forgery = attacked(sound[kind], rng)
        shutil.rmtree(tmp_path / kind, ignore_errors=True)
        trial.tried += 1
        try:
            with trials.patience(300):
                run = run_to(Context(read_text(DECKS[kind].encode(), "deck.toml", tmp_path), resume=True), tmp_path / kind, figures=False)
        except StoreError as error:
            refused += 1
            if str(tmp_path) not in str(error):
                trial.fail(f"{kind} {k}: the refusal does not name the place: {error}")
        except (Exception, trials.TooLong) as error:
            trial.fail(f"{kind} {k}: {type(error).__name__}: {error!s:.300}")
        else:
            if any("internal error" in (result.reason or "") for result in run.results):
                trial.fail(f"{kind} {k}: {[result.reason for result in run.results]}")
            elif _numbers(run) == expected[kind]:
                again += 1
            elif forgery:
                believed += 1
            else:
                trial.fail(f"{kind} {k}: other results than those of a whole run")
    trial.notes.append(
        f"{again} gave the results of a whole run, {refused} were refused, {believed} forged batches were believed or failed"
    )
    trial.close(least)


def _numbers(run: Any) -> dict[str, bytes]:
    """The bytes of all arrays of numbers of a run."""
    return {
        f"{name}/{title}": np.asarray(array.data).tobytes()
        for name, arrays in run.arrays.items()
        for title, array in arrays.items()
        if np.asarray(array.data).dtype.kind in "fiub"
    }
