"""A run as notebooks show it: one line per analysis, and the main figure of the first that has one."""

import base64
import html
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING

from extrados import kinds

if TYPE_CHECKING:
    from extrados.running.run import Run

#: Characters of an answer that are shown
LONGEST = 400
STYLE = "text-align:left;vertical-align:top;padding:2px 10px 2px 0"


def page_of(run: "Run") -> str:
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


def _figure(run: "Run") -> str:
    """The first figure of the first analysis that is drawn, as PNG within the page."""
    for row in run.analyses:
        if row["status"] != "ok" or row["kind"] not in kinds.ANALYSES or not run.arrays.get(row["name"]):
            continue
        with tempfile.TemporaryDirectory(prefix="extrados-") as scratch:
            (Path(scratch) / "figures").mkdir()
            drawn = kinds.load(kinds.ANALYSES[row["kind"]].figures)(run, row["name"], Path(scratch))
            if not drawn:
                continue
            name, caption = drawn[0]
            data = base64.b64encode((Path(scratch) / "figures" / f"{name}.png").read_bytes()).decode()
        return f'<figure style="margin:6px 0"><img style="max-width:720px;width:100%" alt="{html.escape(caption)}" src="data:image/png;base64,{data}"><figcaption>{html.escape(caption)}</figcaption></figure>'
    return ""
