"""Assessment of many buildings: every deck of a folder, and a ranking with the worst first."""

import csv
import hashlib
import io
import os
import tempfile
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import tomlkit

from extrados import kinds
from extrados.analyses.assess.budget import ENDING
from extrados.analyses.batches import stacked, stop_if_asked, sweep
from extrados.analyses.conclude import faulty
from extrados.analyses.context import Context
from extrados.decks.reader import LARGEST, Deck, DeckError, make_deck
from extrados.decks.toml import loads
from extrados.results import checkpoint, written
from extrados.results.assess import Assess
from extrados.results.store import Stored, StoreError, cell, prepare, reason
from extrados.running.run import Run, compute
from extrados.schema import files
from extrados.views.building import Building

#: A deck of this name gives all others of the folder the tables that they lack: the hazard, the budget
COMMON = "common.toml"
RANKING = "ranking.csv"
COLUMNS = ("building", "overall", "least_margin", "strategy", "status", "statement")


@dataclass(frozen=True)
class Assessed:
    """One building of the folder; least_margin: critical scale factor of the hazard, NaN if unknown; folder: its results."""

    building: str
    overall: str
    least_margin: float
    strategy: str
    status: str
    statement: str
    folder: Path

    @property
    def order(self) -> tuple[int, float]:
        """Sort key, the worst first: buildings that cannot stand, those without a result or a verdict, the others by the least
        margin, and last those that stand by an unknown margin."""
        if self.overall == "cannot stand":
            return 0, 0.0
        if np.isfinite(self.least_margin):
            return 2, self.least_margin
        return (3, 0.0) if self.status == "ok" and self.overall == "stands under all" else (1, 0.0)


@dataclass(frozen=True)
class SurveyJob:
    """Member k: the deck texts[k], named names[k], assessed and written below `out`."""

    names: list[str]
    texts: list[str]
    folder: str
    out: str
    figures: bool

    def run(self, first: int, count: int, threads: int) -> dict[str, np.ndarray]:
        return stacked(lambda k: self._one(k, threads), first, count)

    def _one(self, k: int, threads: int) -> dict[str, np.ndarray]:
        name = self.names[k]
        row = {"overall": "", "strategy": "", "status": "failed", "statement": "", "folder": str(Path(self.out) / name)}
        margin = np.nan
        try:
            deck = replace(make_deck(loads(self.texts[k]), Path(self.folder)), path=f"{name}.toml")
            run = compute(Context(deck, threads))
            row["folder"] = str(run.write(Path(self.out) / name, figures=False))  # beside it, where others wrote there
            result = next(r for r in run.results if r.kind == "assess")
            row |= {"status": result.status, "statement": result.reason}
            if result.results.keys():
                r = run["assess"]
                assert isinstance(r, Assess)
                row |= {"overall": r.overall, "strategy": r.least_margin_strategy or "", "statement": r.statement}
                margin = np.nan if r.least_margin is None else r.least_margin
        except (DeckError, StoreError) as error:
            row["statement"] = str(error)
        except ENDING:
            raise
        except Exception as error:  # the other buildings still count
            row |= {"overall": "", "status": "failed", "statement": faulty("assess", error).reason}
        else:
            row["statement"] += self._drawn(row["folder"])
        return {"margin": np.array(margin), **{key: np.array(value, dtype="U2000") for key, value in row.items()}}

    def _drawn(self, folder: str) -> str:
        """Draw the figures of a building whose results are written; what went wrong, as words after its statement."""
        if not self.figures:
            return ""
        from extrados.show.report import write_report

        try:
            write_report(Path(folder))
        except StoreError as error:  # the verdict does not depend on it
            return f" {error}"
        except KeyboardInterrupt:
            stop_if_asked()
            raise
        except ENDING:
            raise
        except Exception as error:
            return f" The figures were not drawn: {faulty('assess', error).reason}."
        return ""


def decks_of(folder: Path) -> dict[str, str | DeckError]:
    """Name -> text of the decks of a folder, with an assess where they have none, and what `common.toml` adds; of a wrong deck its
    complaints. DeckError lists all of them where no deck is right.
    """
    paths = sorted(p for p in folder.glob("*.toml") if not p.name.endswith(".expect.toml"))
    common = _read(folder / COMMON) if (folder / COMMON).exists() else {}
    found: dict[str, str | DeckError] = {}
    for path in (p for p in paths if p.name != COMMON):
        try:
            own = _read(path)
            data = {**common, **own}
            data["analysis"] = _assessment(own) or _assessment(common) or [{"kind": "assess"}]
            make_deck(data, folder)
            found[path.stem] = tomlkit.dumps(data)
        except DeckError as error:
            found[path.stem] = DeckError([text.replace("deck:", f"{path}:", 1) for text in error.complaints])
    if not found:
        raise DeckError([f"the folder {folder} contains no decks"])
    wrong = [one for one in found.values() if isinstance(one, DeckError)]
    if len(wrong) == len(found):
        raise DeckError([text for one in wrong for text in one.complaints])
    return found


def _assessment(data: dict[str, Any]) -> list[Any]:
    """The first `assess` among the analyses of a deck; those of no known kind before it, for the complaint about them."""
    given = data.get("analysis", [])
    tables = given if isinstance(given, list) else [given]
    named = [(t, t.get("kind") if isinstance(t, dict) else None) for t in tables]
    wrong = [t for t, kind in named if kind not in kinds.ANALYSES]
    return wrong or [t for t, kind in named if kind == "assess"][:1]


def _read(path: Path) -> dict[str, Any]:
    try:
        return loads(files.read(path, LARGEST).text())
    except ValueError as error:  # BadFile is one
        raise DeckError([f"{path}: {error}"]) from None


def assess_folder(
    folder: Path,
    out: Path,
    threads: int = 1,
    progress: Callable[[float, float, str], None] = lambda done, total, text: None,
    resume: bool = False,
    scheduler: str = "",
    figures: bool = True,
) -> list[Assessed]:
    """Assess every deck of a folder into folders below `out`; write ranking.csv and ranking.html, the worst first. A wrong deck
    is a row with its errors.

    `resume` continues an interrupted run. On a cluster the workers must have access to the same folders.
    """
    decks = decks_of(folder)
    texts = {name: text for name, text in decks.items() if isinstance(text, str)}
    names = list(texts)
    out = Path(os.path.abspath(out))
    prepare(out)
    out.mkdir(exist_ok=True)
    sha = hashlib.sha256("\0".join(f"{n}\0{t}" for n, t in texts.items()).encode(errors="surrogateescape")).hexdigest()
    deck = Deck("", "", Building(None), None, [], [], path=str(folder), folder=folder.resolve(), sha256=sha)
    context = Context(deck, threads, progress, out=out, resume=resume, scheduler=scheduler)
    if resume:
        checkpoint.refuse_other_deck(out, sha)
    job = SurveyJob(names, list(texts.values()), str(folder.resolve()), str(out), figures)
    found = sweep(context, "survey-folder", job, len(names), "buildings", slow=True)
    rows = [
        Assessed(
            names[k],
            str(found["overall"][i]),
            float(found["margin"][i]),
            str(found["strategy"][i]),
            str(found["status"][i]),
            str(found["statement"][i]),
            Path(str(found["folder"][i])),
        )
        for i, k in enumerate(found.members)
    ]
    rows += [
        Assessed(name, "", np.nan, "", "wrong deck", str(error), out / name)
        for name, error in decks.items()
        if isinstance(error, DeckError)
    ]
    rows.sort(key=lambda row: (*row.order, row.building))
    _write(rows, out, figures)
    if found.complete:
        checkpoint.discard(out)
    return rows


def _write(rows: list[Assessed], out: Path, figures: bool) -> None:
    """ranking.csv, and the ranking with a page for each building; what is there and was not written by us stays."""
    from extrados.show import html, typeset
    from extrados.show.ranking import document

    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(COLUMNS)
    for row in rows:
        told = (row.building, row.overall, f"{row.least_margin:.6g}", row.strategy, row.status, row.statement)
        writer.writerow([told[2] if k == 2 else cell(text) for k, text in enumerate(told)])
    runs: list[tuple[str, Stored | None]] = [
        (row.building, Run.read(row.folder) if row.status != "wrong deck" and (row.folder / "summary.json").exists() else None)
        for row in rows
    ]
    made = document(
        out.name, [(r.building, r.overall or r.status, r.least_margin, r.strategy, r.statement) for r in rows], runs, out, figures
    )
    try:
        new = {
            RANKING: text.getvalue().encode(errors="backslashreplace"),  # names of files may hold bytes that are no text
            "ranking.html": html.page(made, out).encode(errors="backslashreplace"),
        }
        if typeset.available():
            new["ranking.pdf"] = typeset.pdf(typeset.markup(made, out).encode(errors="replace"), out)
        with tempfile.TemporaryDirectory(prefix=f".{out.name}.ranking-", dir=out.parent) as scratch:
            for name, content in new.items():
                (Path(scratch) / name).write_bytes(content)
            with written.alone(out.parent):
                written.put(Path(scratch), out, lambda name: name in new)
    except OSError as error:
        raise StoreError(f"{out}: the ranking could not be written: {reason(error)}") from None
