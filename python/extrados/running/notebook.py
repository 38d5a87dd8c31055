"""A run as notebooks show it: one line per analysis, and the main figure of the first that has one."""

import html

from extrados.results.store import Stored

#: Characters of an answer that are shown
LONGEST = 400
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
