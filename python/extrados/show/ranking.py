"""Ranking of many assessed buildings, the worst first, with a page for each."""

from pathlib import Path

from extrados.results.assess import Assess
from extrados.results.store import Stored
from extrados.show.building import heading
from extrados.show.document import Block, Document, Figure, Heading, Table, Words
from extrados.show.telling import cell, kind_of


def document(
    title: str, rows: list[tuple[str, str, float, str, str]], runs: list[tuple[str, Stored | None]], out: Path, figures: bool
) -> Document:
    """rows: building, overall, least margin, its strategy, statement; runs: the stored run of each, below `out`."""
    ranked = [(str(k), name, overall, cell(least, ""), strategy) for k, (name, overall, least, strategy, _) in enumerate(rows, 1)]
    blocks: list[Block] = [
        Heading("Ranking"),
        Table(("rank", "building", "overall", "least margin", "of"), ranked, (0.6, 2.4, 1.8, 1.2, 2.0)),
        Words(
            "The margin is the critical scale factor of the hazard; below 1, the strategy predicts collapse "
            "under the hazard itself. Buildings that cannot stand come first."
        ),
    ]
    for (name, _, _, _, statement), (_, run) in zip(rows, runs, strict=True):
        blocks += [Heading(name, fresh=True)]
        if run is not None:
            deck = run.summary["deck"]
            blocks.append(Words(", ".join(w for w in dict.fromkeys((heading(deck), kind_of(deck))) if w not in ("", name))))
        blocks.append(Words(statement, "answer"))
        if run is not None:
            blocks += _page(name, run, out, figures)
    return Document(f"Assessment of {title}", [("Buildings", str(len(rows)))], blocks, f"Assessment of {title}")


def _page(name: str, run: Stored, out: Path, figures: bool) -> list[Block]:
    """The drawing, the verdicts and the margins of one building."""
    found: list[Block] = []
    there = [a for a in run.analyses if a["kind"] == "assess" and a["results"]]
    if figures and (out / name / "figures" / "building.svg").exists():
        told = "; ".join(f"{d['name']} {d['length_m']:.4g} m" for d in run.summary["deck"].get("dimensions", []))
        found.append(Figure(f"{name}/figures/building", f"{told[:1].upper()}{told[1:]}.", 0.35))
    for a in there:
        r = run.results_of(a["name"], Assess)
        rows = [(v.label, v.verdict_words, cell(v.demand, ""), cell(v.capacity, ""), v.unit, v.margin_told("")) for v in r.verdicts]
        found.append(Table(("strategy", "verdict", "demand", "capacity", "unit", "margin"), rows, (2.4, 1.0, 1.0, 1.0, 1.0, 1.2)))
        found += [Words(one.text) for one in r.reasons]
        if figures and (out / name / "figures" / f"{a['name']}-margins.svg").exists():
            found.append(Figure(f"{name}/figures/{a['name']}-margins", f"Hazard: {r.hazard.told}.", 0.6))
    return found
