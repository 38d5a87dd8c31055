"""The representation of a run in a notebook: one line per analysis and the first figure. For a sweep: a table of members."""

import html
from collections.abc import Mapping, Sequence
from typing import Any

from extrados.results.store import Stored

#: Characters of an answer that are shown
LONGEST = 400
#: Members of a sweep that are shown
MOST_ROWS = 12
STYLE = "text-align:left;vertical-align:top;padding:2px 10px 2px 0"


def page_of(run: Stored) -> str:
    """HTML of a run."""
    head = html.escape(run.summary["deck"].get("title") or str(run.summary["deck"]["path"]))
    rows = "".join(
        f'<tr><th style="{STYLE}">{html.escape(row["name"])}</th><td style="{STYLE}">{html.escape(_told(row))}</td></tr>'
        for row in run.analyses
    )
    return f"<div><b>{head}</b><table>{rows}</table>{_figure(run)}</div>"


def _told(row: dict) -> str:
    text = row["answer"] if row["status"] == "ok" else f"{row['status']}: {row['reason']} {row['answer']}"
    text = text if len(text) <= LONGEST else text[: LONGEST - 1].rsplit(" ", 1)[0] + " …"
    warned = len(row["warnings"])
    return text + (f" ({warned} warning{'s' if warned > 1 else ''})" if warned else "")


def _figure(run: Stored) -> str:
    """The first figure of the first analysis that is drawn, as PNG within the page."""
    from extrados.show.drawn import draw

    pages = (draw(run, row["name"]).html(1) for row in run.analyses if row["status"] == "ok")
    return next((page for page in pages if page), "")


def table_of(title: str, keys: Sequence[str], rows: Sequence[Mapping[str, Any]], units: Mapping[str, str]) -> str:
    """HTML of the first rows of a sweep: the varied keys, then status and verdict of each analysis."""
    shown = rows[:MOST_ROWS]
    ends = (".status", ".verdict.outcome", ".verdict.ratio")
    names = [*keys, *dict.fromkeys(name for row in shown for name in row if name.endswith(ends) and name not in keys)]
    heads = [html.escape(name + (f" [{units[name]}]" if units.get(name) else "")) for name in names]
    head = "".join(f'<th style="{STYLE}">{one}</th>' for one in heads)
    body = "".join(
        "<tr>" + "".join(f'<td style="{STYLE}">{html.escape(_cell(row.get(name)))}</td>' for name in names) + "</tr>" for row in shown
    )
    left = f"<p>{len(rows) - len(shown)} more runs: use frame().</p>" if len(rows) > len(shown) else ""
    return f"<div><b>{html.escape(title)}</b><table><tr>{head}</tr>{body}</table>{left}</div>"


def _cell(value: Any) -> str:
    return "" if value is None else f"{value:.4g}" if isinstance(value, float) else str(value)
