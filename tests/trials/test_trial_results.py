"""Results that somebody changed: results.h5 is damaged and its checksum is right."""

import hashlib
import io
import json
import random
from pathlib import Path

import h5py
import numpy as np

import trials
from extrados.analyses.context import Context
from extrados.decks.explain import starter
from extrados.decks.reader import read_text
from extrados.results import store
from extrados.running.run import run_to
from extrados.show.report import write_report

SEED = 20261124
KINDS = ("tilt", "rocking", "failure-domain", "dem")
#: Of so many damaged results that can be read one is drawn, too
DRAWN = 4


def damaged(content: bytes, rng: random.Random) -> bytes:
    """One to four faults: bits, bytes, lengths, parts put elsewhere; half of them among the words of HDF5, not the numbers."""
    raw = bytearray(content)
    words = [i for i in range(0, len(raw) - 4, 8) if raw[i : i + 4] in (b"TREE", b"HEAP", b"SNOD", b"OHDR", b"GCOL", b"OCHK")]
    for _ in range(rng.randint(1, 4)):
        near = words and rng.random() < 0.5
        k = min(rng.choice(words) + rng.randrange(200), len(raw) - 1) if near else rng.randrange(len(raw))
        match rng.randrange(7):
            case 0:
                raw[k] ^= 1 << rng.randrange(8)
            case 1:
                raw[k] = rng.randrange(256)
            case 2:
                raw[k : k + 8] = rng.choice((b"\xff" * 8, b"\0" * 8, (2**40).to_bytes(8, "little"), k.to_bytes(8, "little")))
            case 3:
                del raw[k : k + rng.randint(1, 64)]
            case 4:
                del raw[max(k, 1) :]
            case 5:
                at = rng.randrange(len(raw))
                raw[k : k + 64] = raw[at : at + 64]
            case _:
                raw[k : k + 512] = bytes(512)
    return bytes(raw)


def changed(content: bytes, rng: random.Random) -> bytes:
    """Sound HDF5 whose arrays are not those of the analysis: one is gone, renamed, of another length, kind, unit or axis."""
    image = io.BytesIO(content)
    with h5py.File(image, "r+") as file:
        group = file[rng.choice(list(file))]
        names = [title for title, store in group.items() if "unit" in store.attrs]
        for title in rng.sample(names, min(len(names), rng.randint(1, 3))):
            data, attributes = group[title][()], dict(group[title].attrs)
            kept = {mark: attributes[mark] for mark in store.MARKS}
            del group[title]
            match rng.randrange(6):
                case 0:
                    continue
                case 1:
                    title = f"{title}_1"
                case 2:
                    data = data[: len(data) // 2] if np.ndim(data) else np.zeros(3)
                case 3:
                    data = np.full(np.shape(data), rng.choice((np.nan, np.inf, -1.0, 1e308)))
                case 4:
                    data = np.array(["text"] * max(np.size(data), 1), dtype=object)
                case _:
                    data = np.zeros((2, 0, 3))
            new = group.create_dataset(title, data=data)
            new.attrs.update(kept)
    return image.getvalue()


def put(folder: Path, content: bytes) -> None:
    """Give a folder other results, and their checksum."""
    (folder / store.STORE).write_bytes(content)
    summary = json.loads((folder / store.SUMMARY).read_text())
    summary["files"][store.STORE] = hashlib.sha256(content).hexdigest()
    (folder / store.SUMMARY).write_text(json.dumps(summary))


def test_damaged_results_with_a_right_checksum(tmp_path: Path) -> None:
    """Read, or refused with the name of the folder; what is read can be drawn, or it is said why not."""
    trial = trials.Trial("results-damaged", "damaged results with a right checksum that are neither read nor refused, or hang")
    rng = random.Random(SEED)
    kinds = KINDS if trials.SHARE > 0.0 else KINDS[:1]
    sound = {}
    for kind in kinds:
        run_to(Context(read_text(starter(kind).encode(), "deck.toml", tmp_path)), tmp_path / kind, figures=False)
        sound[kind] = (tmp_path / kind / store.STORE).read_bytes()
    readable = drawn = 0
    for k in range(least := trials.count_of(2_000, 60)):
        kind = kinds[k % len(kinds)]
        content = (changed if k % 5 == 0 else damaged)(sound[kind], rng)
        put(tmp_path / kind, content)
        trial.tried += 1
        doing = "read"
        try:
            with trials.patience(120):
                run = store.read(tmp_path / kind)
                for name, arrays in run.arrays.items():
                    for title, array in arrays.items():
                        if np.asarray(array.data).ndim != len(array.dims):
                            trial.fail(f"{kind} {k}: {name}/{title} has other axes than names of them")
                readable += 1
                if readable % DRAWN == 1:
                    doing, drawn = "drawn", drawn + 1
                    write_report(tmp_path / kind)
        except store.StoreError as error:
            if str(tmp_path / kind) not in str(error):
                trial.fail(f"{kind} {k}: the refusal does not name the folder: {error}")
        except (Exception, trials.TooLong) as error:
            trial.fail(f"{kind} {k}: {doing}: {type(error).__name__}: {error!s:.300}")
    trial.notes.append(f"{readable} could still be read, {drawn} of these were drawn")
    trial.close(least)
