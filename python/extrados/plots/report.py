"""Figures and one self-contained HTML report of a stored run."""

import base64
import multiprocessing
import os
import signal
import sys
import tempfile
import threading
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import jinja2

from extrados import kinds
from extrados.results import written
from extrados.results.explain import fact_of
from extrados.results.fields import ResultModel
from extrados.results.store import REPORT, Stored, StoreError, read, reason

#: Figures of an analysis with their captions
Figures = list[tuple[str, str]]

TEMPLATE = """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>{{ title }}</title>
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; img-src data:; style-src 'unsafe-inline'">
<style>
body{font:15px/1.5 Georgia,serif;max-width:60rem;margin:2rem auto;padding:0 1rem;color:#222}
h1{font-size:1.6rem}h2{font-size:1.25rem;border-bottom:1px solid #ccc;margin-top:2.2rem}
p.answer{background:#f6f2ea;border-left:4px solid #b3261e;padding:.7rem 1rem}
p.bad{background:#fbe9e7;border-left:4px solid #b3261e;padding:.7rem 1rem}
p.warn{background:#fff7e0;border-left:4px solid #d9a400;padding:.5rem 1rem}
figure{margin:1.2rem 0}figure img{max-width:100%}figcaption{font-size:.85rem;color:#555}
table{border-collapse:collapse;font:13px/1.4 sans-serif}td,th{border-bottom:1px solid #ddd;padding:.15rem .7rem .15rem 0;text-align:left;vertical-align:top}
pre{background:#f7f7f7;padding:.7rem;overflow:auto;font-size:12px}footer{margin-top:3rem;font-size:.8rem;color:#666}
</style></head><body>
<h1>{{ title }}</h1>{% if note %}<p>{{ note }}</p>{% endif %}
<h2>Verdicts</h2><table><tr><th></th><th>outcome</th><th>demand</th><th>capacity</th><th>unit</th><th>capacity / demand</th><th></th></tr>
{% for a in analyses %}<tr><th>{{ a.name }}</th>{% if a.verdict %}<td>{{ outcomes[a.verdict.outcome] }}</td><td>{{ a.verdict.demand | cell }}</td><td>{{ a.verdict.capacity | cell }}</td><td>{{ a.verdict.unit }}</td><td>{{ a.verdict.ratio | cell }}</td><td>{{ a.verdict.statement }}</td>{% else %}<td>{{ a.status }}</td><td></td><td></td><td></td><td></td><td>{{ a.reason }}</td>{% endif %}</tr>{% endfor %}</table>
{% for a in analyses %}<h2>{{ a.name }}</h2>
{% if a.status != "ok" %}<p class="bad"><b>{{ a.status }}</b>: {{ a.reason }}</p>{% endif %}
{% if a.answer %}<p class="answer">{{ a.answer }}</p>{% endif %}
{% for w in a.warnings %}<p class="warn">Warning: {{ w }}</p>{% endfor %}
{% for f in a.figures %}<figure><img alt="{{ f.caption }}" src="data:image/svg+xml;base64,{{ f.data }}"><figcaption>{{ f.caption }}</figcaption></figure>{% endfor %}
{% if a.assumptions %}<details><summary>Assumptions</summary><table>{% for k, s in a.assumptions.items() %}<tr><th>{{ k }}</th><td>{{ s.value | cell }}</td><td>{{ s.unit }}</td><td>{{ s["from"] }}{% if s.exceptions %}, some differ{% endif %}</td></tr>{% endfor %}</table></details>{% endif %}
<details><summary>Numbers</summary><table>{% for k, v, unit, about in a.rows %}<tr><th>{{ k }}</th><td>{{ v }}</td><td>{{ unit }}</td><td>{{ about }}</td></tr>{% endfor %}</table></details>
{% endfor %}
<h2>Deck</h2><p>{{ deck.path }} (sha256 {{ deck.sha256[:16] }}); all keys with their defaults, in SI:</p>
<table>{% for k, v in resolved %}<tr><th>{{ k }}</th><td>{{ v }}</td></tr>{% endfor %}</table>
<footer>extrados {{ made.version }} {{ made.commit }}, {{ made.compiler }}. Assumptions of each analysis are stated in the documentation; a result is no better than the geometry it was given.</footer>
</body></html>
"""


def draw(run: Stored, folder: Path) -> dict[str, Figures]:
    """All figures of a run into folder/figures; analysis name -> (figure name, caption).

    StoreError where the stored results lack what a figure needs, or a figure cannot be written.
    """
    shown = [a for a in run.analyses if a["kind"] in kinds.ANALYSES and run.arrays.get(a["name"])]
    (folder / "figures").mkdir(exist_ok=True)
    tasks = [(run, a["name"], kinds.load(kinds.ANALYSES[a["kind"]].figures), folder) for a in shown]
    return {a["name"]: figures for a, figures in zip(shown, _drawn(tasks), strict=True)}


def _draw_one(run: Stored, name: str, figures: Callable[..., Figures], folder: Path) -> Figures:
    """The figures of one analysis."""
    try:
        return figures(run, name, folder)
    except OSError as error:
        raise StoreError(f"{run.folder}: figures could not be written: {reason(error)}") from None
    except KeyError as error:
        raise StoreError(f"{run.folder}: the results are damaged: {name}: {error.args[0]}") from None


def _drawn(tasks: list[tuple]) -> list[Figures]:
    """The figures of each analysis, drawn side by side where this process can fork and it is worth it.

    A process with threads of its own is not forked: one of them might hold a lock that the child then waits for.
    """
    workers = min(len(os.sched_getaffinity(0)) if sys.platform == "linux" else 1, len(tasks))
    if workers < 2 or threading.active_count() > 1:
        return [_draw_one(*task) for task in tasks]
    with warnings.catch_warnings():
        # Python warns of the idle threads of the numerical libraries, which drawing does not use
        warnings.filterwarnings("ignore", ".*multi-threaded.*fork", DeprecationWarning)
        # signals wait until each process has said how it answers them
        held = signal.pthread_sigmask(signal.SIG_BLOCK, _SIGNALS)
        try:
            pool = multiprocessing.get_context("fork").Pool(workers, _begin, (tasks,))
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, held)
        with pool:
            return pool.map(_draw_numbered, range(len(tasks)), chunksize=1)


_SIGNALS = (signal.SIGINT, signal.SIGTERM)
#: What a forked process is to draw; a run is handed over by the fork, not copied through a pipe
_tasks: list[tuple] = []


def _begin(tasks: list[tuple]) -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is answered by the parent, which ends the pool
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, _SIGNALS)
    _tasks[:] = tasks


def _draw_numbered(i: int) -> Figures:
    return _draw_one(*_tasks[i])


#: Outcomes of verdicts in words
OUTCOMES = {"stands": "stands", "falls": "falls", "open": "open", "none": "no demand"}


def _numbers(results: ResultModel, prefix: str = "") -> list[tuple[str, str, str, str]]:
    """Key, value, unit and meaning of all results."""
    rows = []
    for name, field in type(results).model_fields.items():
        if name not in results.model_fields_set:
            continue
        told, value = fact_of(prefix + (field.alias or name), field), getattr(results, name)
        if isinstance(value, ResultModel):
            rows += _numbers(value, f"{told.key}.")
        elif isinstance(value, dict) and any(isinstance(v, ResultModel) for v in value.values()):
            for key, inner in value.items():
                rows += _numbers(inner, f"{told.key}.{key}.")
        else:
            rows.append((told.key, _cell(value), told.unit, told.about))
    return rows


def _rows(values: dict[str, Any], prefix: str = "") -> list[tuple[str, str]]:
    """Keys, dotted, and values of tables."""
    rows = []
    for key, value in values.items():
        if isinstance(value, dict):
            rows += _rows(value, f"{prefix}{key}.")
        else:
            rows.append((prefix + key, _cell(value)))
    return rows


def _cell(value: Any) -> str:
    if isinstance(value, float):
        return f"{value:.6g}"
    if isinstance(value, list):
        shown = ", ".join(_cell(v) for v in value[:12])
        return shown + (f", ... ({len(value)})" if len(value) > 12 else "")
    if isinstance(value, dict | ResultModel):
        return "; ".join(f"{k} {_cell(v)}" for k, v in value.items())
    return "none" if value is None else str(value)


def write_report(folder: Path) -> tuple[Path, dict[str, Figures]]:
    """Draw a stored run and write report.html: the report, and the figures with captions by analysis.

    Drawn aside and put in place when all is done. A figure or report that is there and was not written by extrados, or
    was changed since, stays: the new one is put beside it under another name, which is logged. StoreError where that
    is not possible.
    """
    folder = Path(folder)
    run = read(folder)
    within = Path(os.path.abspath(folder)).parent
    try:
        with tempfile.TemporaryDirectory(prefix=f".{folder.name}.drawing-", dir=within) as place:
            scratch = Path(place)
            drawn = draw(run, scratch)
            (scratch / REPORT).write_text(_page(run, scratch, drawn), encoding="utf-8", errors="backslashreplace")
            with written.alone(within):
                names = written.put(scratch, folder, lambda name: name == REPORT or name.startswith("figures/"))
    except OSError as error:
        raise StoreError(f"{folder}: the report could not be written: {reason(error)}") from None
    return folder / names[REPORT], drawn


def _page(run: Stored, folder: Path, drawn: dict[str, Figures]) -> str:
    """The report as one HTML page; the figures lie in folder/figures."""
    analyses = []
    for a in run.analyses:
        figures = [
            {"caption": caption, "data": base64.b64encode((folder / "figures" / f"{name}.svg").read_bytes()).decode()}
            for name, caption in drawn.get(a["name"], [])
        ]
        analyses.append({**a, "figures": figures, "rows": _numbers(run[a["name"]])})
    deck = run.summary["deck"]
    settings = {k: v for k, v in deck["resolved"].items() if isinstance(v, dict)}
    asked = deck["resolved"].get("analysis", [])
    settings |= {a["name"]: keys for a, keys in zip(run.analyses, asked, strict=False)}
    environment = jinja2.Environment(autoescape=True)
    environment.filters["cell"] = _cell
    return environment.from_string(TEMPLATE).render(
        outcomes=OUTCOMES,
        title=deck.get("title") or deck["path"] or "extrados run",
        note=deck.get("note", ""),
        analyses=analyses,
        deck=deck,
        resolved=_rows(settings),
        made=run.summary["extrados"],
    )
