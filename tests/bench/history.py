"""What benchmarks told, run after run: one line of JSON each in history.jsonl, and a picture of how it went.

Of every line of a benchmark that tells a time or a rate the label is kept, which is the line without its numbers, and the
first time or rate in it. Machines and loads differ, so each entry names both.
"""

import json
import os
import platform
import re
import subprocess
import sys
from collections.abc import Iterable
from datetime import datetime
from pathlib import Path
from typing import Any

HERE = Path(__file__).resolve().parent
HISTORY = HERE / "history.jsonl"
PICTURES = HERE.parents[1] / "build" / "bench"
NUMBER = r"[-+]?\d+(?:,\d{3})*(?:\.\d+)?(?:e[-+]?\d+)?"
#: A time or a rate: a number with its unit
TOLD = re.compile(rf"({NUMBER}) ?(ns|us|ms|s|MB|times|[a-z]+/s|/s)\b")


def parsed(text: str) -> dict[str, tuple[float, str]]:
    """Label -> first time or rate and its unit, of each line that has one."""
    found: dict[str, tuple[float, str]] = {}
    for line in text.splitlines():
        if match := TOLD.search(line):
            label = " ".join(re.sub(NUMBER, "#", line).split())[:120]
            found.setdefault(label, (float(match[1].replace(",", "")), match[2]))
    return found


def entry(room: str, text: str) -> dict[str, Any]:
    """A line of the history."""
    commit = subprocess.run(
        ["git", "-C", str(HERE), "describe", "--always", "--dirty", "--exclude=*"], capture_output=True, text=True
    ).stdout.strip()
    return {
        "at": datetime.now().astimezone().isoformat(timespec="seconds"),
        "commit": commit,
        "host": platform.node(),
        "cores": os.cpu_count(),
        "load": round(os.getloadavg()[0], 2),
        "bench": room,
        "told": parsed(text),
    }


def append(room: str, text: str, path: Path = HISTORY) -> None:
    """Add a run to the history."""
    with path.open("a", encoding="utf-8") as file:
        file.write(json.dumps(entry(room, text)) + "\n")


def read(path: Path = HISTORY) -> list[dict[str, Any]]:
    """All entries, the oldest first."""
    return [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()] if path.exists() else []


def curves(entries: Iterable[dict[str, Any]], room: str) -> dict[str, list[tuple[str, float, str]]]:
    """Label -> (commit, value, unit) over the runs of a benchmark, of what was told more than once."""
    found: dict[str, list[tuple[str, float, str]]] = {}
    for one in entries:
        if one["bench"] == room:
            for label, (value, unit) in one["told"].items():
                found.setdefault(label, []).append((f"{one['at'][:10]} {one['commit'][:7]}", value, unit))
    return {label: points for label, points in found.items() if len(points) > 1}


def draw(path: Path = HISTORY, folder: Path = PICTURES) -> list[Path]:
    """A picture for each benchmark that ran more than once: every number over its first one; the files."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    entries, made = read(path), []
    for room in dict.fromkeys(one["bench"] for one in entries):
        lines = curves(entries, room)
        if not lines:
            continue
        figure = FigureCanvasAgg(Figure(figsize=(11.0, 5.5), layout="constrained")).figure
        ax = figure.subplots()
        runs = list(dict.fromkeys(run for points in lines.values() for run, _, _ in points))
        for label, points in lines.items():
            first = points[0][1]
            if first > 0.0:
                shares = [value / first for _, value, _ in points]
                ax.plot([runs.index(run) for run, _, _ in points], shares, "o-", label=f"{label[:60]} [{points[0][2]}]")
        ax.set_xticks(range(len(runs)), runs, rotation=30, ha="right", fontsize=8)
        ax.set_yscale("log")
        ax.set_ylabel("value over that of the first run")
        ax.set_title(f"bench {room}: times fall, rates rise where it got better")
        ax.grid(True, color="#e4e4e4")
        figure.legend(loc="outside right upper", fontsize=7)
        folder.mkdir(parents=True, exist_ok=True)
        made.append(folder / f"{room}.png")
        figure.savefig(made[-1], dpi=110)
    return made


if __name__ == "__main__":
    for picture in draw():
        print(picture)
    sys.exit()
