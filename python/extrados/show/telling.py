"""The content of a report in its order: conclusion, building, hazard, analyses, factors, limits, sources. The annex has all
numbers and the commands to repeat the run. From stored results only."""

import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from extrados.results.assess import Assess
from extrados.results.assumptions import LABELS
from extrados.results.codes import Checked
from extrados.results.explain import fact_of
from extrados.results.fields import ResultModel
from extrados.results.store import STORE, SUMMARY, Stored
from extrados.results.strengthen import size_told
from extrados.results.validity import validity_of
from extrados.results.verdict import outcome_words
from extrados.show.building import ELEVATION, heading, joint_of, name_of
from extrados.show.document import Block, Code, Document, Figure, Heading, Table, Words
from extrados.show.language import Language
from extrados.show.opening import governing_figure, opening, title_of
from extrados.show.sources import clause_of, references
from extrados.show.template import ENTRIES, Template

Figures = list[tuple[str, str]]
#: Values of a list that are shown, and rows of a list of tables
MOST_SHOWN, MOST_ROWS = 12, 4
#: Joints whose forces and stresses are printed; of a joint whose force stands nearer to its edge than this [m], a hinge, no stress
MOST_JOINTS, EDGE = 6, 1e-3
#: Tables of the deck and what they are called
GROUPS = (
    ("Geometry", ("structure",)),
    ("Materials and joints", ("material", "materials", "joints")),
    ("Supports, ties and the state at the start", ("supports", "ties", "dampers", "hinges", "initial")),
    ("Code and site", ("code",)),
)
#: Of moving-load: keys of its partial factors
FACTORS = {
    "masonry": "weight of masonry",
    "fill": "weight of fill",
    "surfacing": "weight of surfacing",
    "live": "live load",
    "dynamic": "dynamic factor",
    "strength": "compressive strength",
    "friction": "friction",
}
#: Of moving-load: keys of its permissible limit state
SERVICE = {
    "live": "live load, permissible limit state",
    "strength_share": "permissible stress / compressive strength",
    "passive_share": "passive pressure in the permissible limit state / at collapse",
}


def told(
    run: Stored, drawn: dict[str, Figures], building: Figures, day: str, office: Template | None = None, words: Language | None = None
) -> Document:
    """The whole report; drawn: figures with captions by analysis; building: its drawings; day: of the results; office: its template."""
    office, words = office or Template(), words or Language()
    deck, made = run.summary["deck"], run.summary["extrados"]
    title = heading(deck)
    entries = {key: deck.get(key) or getattr(office.table, key) for key in ENTRIES}
    entries["date"] = entries["date"] or day
    facts = [(words(label), entries[key]) for key, label in ENTRIES.items() if entries[key]]
    facts += list(office.table.fields.items())
    if kind := kind_of(deck):
        facts.append((words("Building"), words(kind)))
    if code := _code_of(run):
        facts.append((words("Code"), code))
    facts += [
        (words("Deck"), f"{Path(deck['path']).name or 'Python'} (sha256 {deck['sha256'][:16]})"),
        (words("Made by"), f"extrados {made['version']} {made['commit']}".strip()),
    ]
    first = governing_figure(run, drawn, building)
    shown = [f for f in building if first is None or first.name != f"figures/{f[0]}"]
    whole = any(a["kind"] == "assess" and a["results"] for a in run.analyses)
    parts: list[Block] = []  # the strategies of an assessment one by one, and the figures that the report has no room for
    analyses: list[Block] = []
    for a in run.analyses:
        figures = [f for f in drawn.get(a["name"], []) if first is None or first.name != f"figures/{f[0]}"]
        if whole and a["kind"] != "assess":
            parts += _analysis(run, a, figures, words)
            continue
        most = len(figures) if a["kind"] == "assess" else office.table.figures
        analyses += _analysis(run, a, figures[:most], words)
        if figures[most:]:
            parts.append(Heading(title_of(words, a["name"], a["kind"])))
            parts += [Figure(f"figures/{name}", caption) for name, caption in figures[most:]]
    note: list[Block] = [Words(_flowing(deck["note"]), lang=_foreign(words))] if deck.get("note") else []
    if words.code != "en":
        note.append(Words(words("Sentences from the analyses and captions of figures are in English, as in the results."), "warn"))
    sections: dict[str, list[Block]] = {
        "answer": _verdicts(run, words),
        "building": _building(run, deck, shown, words),
        "hazard": _hazard(run, deck, words),
        "analyses": analyses,
        "factors": _factors(run, deck, words),
        "limits": _limits(run, words),
        "bibliography": _bibliography(run, deck, words),
    }
    blocks = [*note, *(block for name in office.table.sections for block in sections[name])]
    hidden = {name for _, name, _ in _own_tables(run, words)}
    annex = [*parts, *_assumed(run, words), *_defaults(deck, words), *_numbers(run, hidden, words), *_repeat(run, deck, made, words)]
    foot = f"{title}. extrados {made['version']} {made['commit']}, deck {deck['sha256'][:16]}"
    labels = office.table.signatures or [words("Author"), words("Reviewer")]
    names = {words("Author"): entries["author"], words("Reviewer"): entries["reviewer"]}
    return Document(
        title,
        facts,
        blocks,
        foot,
        opening(run, drawn, building, words),
        annex,
        tuple((label, names.get(label, "")) for label in labels),
        f"figures/logo{office.suffix}" if office.logo else "",
        office.table.colour,
        words,
    )


def annexed(document: Document) -> Document:
    """The annex of a report as a document of its own."""
    title = f"{document.title}: {document.words('annex')}"
    return replace(document, title=title, facts=[], opening=[], blocks=document.annex, annex=[], signatures=())


def _foreign(words: Language) -> str:
    """The mark of a text that stays English."""
    return "" if words.code == "en" else "en"


def _code_of(run: Stored) -> str:
    """The code of the report, where an analysis applies one."""
    applied = (getattr(r, "verification", r) for r in (run[a["name"]] for a in run.analyses))
    return next((code for r in applied if (code := getattr(r, "code", ""))), "")


def kind_of(deck: dict[str, Any]) -> str:
    """The kind of structure in words, "" of a deck without one."""
    structure = deck["resolved"].get("structure") or {}
    kind = str(structure.get("kind", "")).replace("-", " ")
    if kind == "blocks":
        return "bridge" if structure.get("fill") else "assembly of blocks"
    return kind


def _flowing(text: str) -> str:
    """A note of a deck without the ends of its lines, which are those of the file; an empty line parts paragraphs."""
    return "\n".join(" ".join(part.split()) for part in re.split(r"\n\s*\n", text))


def _heads(words: Language, *heads: str) -> tuple[str, ...]:
    return tuple(words(head) for head in heads)


def _verdicts(run: Stored, words: Language) -> list[Block]:
    found: list[Block] = [Heading(words("Conclusion"))]
    for a in run.analyses:
        if a["kind"] == "assess" and a["results"]:
            found += _assessed(run, a["name"], words)
            return found
    rows = []
    for a in run.analyses:
        v, name = a["verdict"], title_of(words, a["name"], a["kind"])
        if v:
            demand, capacity = ("" if v[key] is None else words.quantity(v[key], v["unit"]) for key in ("demand", "capacity"))
            ratio = "" if v["ratio"] is None else words.number(v["ratio"])
            said = outcome_words(v["outcome"], isinstance(run[a["name"]], Checked))
            rows.append((name, words(said), demand, capacity, ratio))
        else:
            rows.append((name, words(a["status"]), "", "", ""))
    head = _heads(words, "analysis", "verdict", "demand", "capacity", "capacity / demand")
    return [*found, Table(head, rows, (2.6, 1.3, 1.2, 1.2, 1.0))]


def _assessed(run: Stored, name: str, words: Language) -> list[Block]:
    """The overall answer of an assessment: its table, its reasons."""
    r = run.results_of(name, Assess)
    rows = []
    for v in r.verdicts:
        factor = v.margin_told("")
        if v.status == "ok":
            rows.append(
                (v.label, words(v.verdict_words), _value(words, v.demand, v.unit), _value(words, v.capacity, v.unit), factor, v.statement)
            )
        else:
            rows.append((v.label, words(v.status), "", "", "", v.reason))
    heads = _heads(words, "strategy", "verdict", "demand", "capacity", "margin", "in words")
    found: list[Block] = [Words(r.statement, "answer", _foreign(words)), Table(heads, rows, (1.6, 0.9, 1.1, 1.1, 0.9, 3.6))]
    found.append(
        Words(
            words("The margin is the critical scale factor of the hazard; below 1, the strategy predicts collapse under the hazard itself.")
        )
    )
    found.append(Words(f"{r.collapse_probability.statement} {r.collapse_probability.method}", "", _foreign(words)))
    found += _advice(r, words)
    if r.reasons:
        found.append(Heading(words("Why they differ"), 2))
        labels = {v.strategy: v.label for v in r.verdicts}
        pairs = [
            (one.rule.replace("-", " "), one.text, "; ".join(f"{labels[a]} and {labels[b]}" for a, b in one.explains)) for one in r.reasons
        ]
        found.append(Table(_heads(words, "rule", "reason for the difference, with numbers", "explains"), pairs, (1.2, 4.6, 2.4)))
    if r.unexplained:
        labels = {v.strategy: v.label for v in r.verdicts}
        text = "; ".join(f"{labels[a]} and {labels[b]}" for a, b in r.unexplained)
        found.append(Words(f"No reason was found for the difference between these strategies: {text}.", "bad"))
    found += _sensitive(r, words)
    if r.probes:
        found.append(Heading(words("Further runs"), 2))
        labels = {v.strategy: v.label for v in r.verdicts}
        probed = [
            (
                labels.get(p.strategy, p.strategy),
                p.changed,
                words(outcome_words(p.outcome, check=False)),
                "" if p.value is None else words.number(p.value),
            )
            for p in r.probes
        ]
        found.append(Table(("analysis", "difference from the deck", "verdict", "demand over capacity"), probed, (1.2, 4.0, 1.0, 1.2)))
    if r.not_done:
        found.append(Words("Not done, or without a verdict: " + "; ".join(r.not_done) + ".", "warn"))
    return found


def _sensitive(r: Assess, words: Language) -> list[Block]:
    """How far the verdicts move with the values of the deck."""
    if not r.sensitivity:
        return []
    found: list[Block] = [Heading(words("Sensitivity of the verdicts"), 2)]
    moved = [
        (
            m.key,
            f"{cell(m.base)} {m.unit}".strip(),
            f"{m.low:.4g} to {m.high:.4g}",
            _both(m.tilt_low, m.tilt_high),
            cell(m.tilt_turns, ""),
            _both(m.rocking_low, m.rocking_high),
            cell(m.rocking_turns, ""),
        )
        for m in r.sensitivity
        if m.dem_base is None
    ]
    head: tuple[str, ...] = (
        "key",
        "value",
        "varied",
        "margin of limit analysis",
        "verdict changes at",
        "margin of rocking",
        "verdict changes at",
    )
    found.append(Table(head, moved, (2.2, 1.1, 1.3, 1.3, 0.9, 1.3, 0.9)))
    shaken = [
        (
            m.key,
            f"{cell(m.base)} {m.unit}",
            f"{m.low:.3g} to {m.high:.3g}",
            cell(m.dem_base),
            _both(m.dem_low, m.dem_high),
            cell(m.dem_turns, ""),
        )
        for m in r.sensitivity
        if m.dem_base is not None
    ]
    if shaken:
        found.append(
            Words(
                "Values that affect only discrete elements: displacement of the blocks, divided by the "
                "displacement that counts as collapse."
            )
        )
        head = ("key", "value", "moved", "at the value", "varied", "rotates at")
        found.append(Table(head, shaken, (2.2, 1.2, 1.6, 1.0, 1.6, 1.0)))
    return found


def _advice(r: Assess, words: Language) -> list[Block]:
    """What to do: the interventions of an assessment side by side."""
    if r.advice is None:
        return []
    rows = [
        (
            one.name,
            size_told(one) if one.meets_target else one.reason,
            cell(one.capacity_after, ""),
            one.next_mechanism,
            r.advice.rocking.get(one.name, ""),
        )
        for one in r.advice.interventions
    ]
    head = ("intervention", "least size", "capacity after [g]", "then governs", "rocking under the hazard")
    return [Heading(words("Strengthening"), 2), Words(r.advice.statement), Table(head, rows, (1.4, 2.4, 0.8, 3.2, 1.2))]


def _both(low: float | None, high: float | None) -> str:
    return f"{cell(low, '?')} to {cell(high, '?')}" if low is not None or high is not None else ""


def _value(words: Language, value: float | None, unit: str) -> str:
    return "" if value is None else words.quantity(value, unit)


def _building(run: Stored, deck: dict[str, Any], drawings: Figures, words: Language) -> list[Block]:
    """The drawings, its dimensions, and the properties that the analyses used."""
    used = {key for a in run.analyses for key in a["assumptions"]}
    rows = [p for p in deck.get("properties", []) if p["table"] != "motion" and _counts(p, used)]
    found: list[Block] = [Heading(words("Building"))] if rows or drawings or deck.get("dimensions") else []
    # The section often fills a page: the front before it fills the page of the contents.
    plan = (deck["resolved"].get("structure") or {}).get("kind") == "building"
    ahead = [] if plan else [d for d in drawings if d[0] == ELEVATION]
    found += [Figure(f"figures/{name}", caption) for name, caption in [*ahead, *(d for d in drawings if d not in ahead)]]
    if deck.get("dimensions"):
        sizes = [(name_of(words, d["name"]), words.quantity(d["length_m"], "m")) for d in deck["dimensions"]]
        found.append(Table(_heads(words, "dimension", "length"), sizes, (3.0, 1.0)))
    for label, tables in GROUPS:
        if own := [p for p in rows if p["table"].split(".")[0] in tables]:
            found += [Heading(words(label), 2), _properties(own, words)]
    return found


def _counts(p: dict[str, Any], used: set[str]) -> bool:
    """Whether a property belongs into the report: what the deck gives, of material and joints only what an analysis used."""
    table = p["table"].split(".")[0]
    if (table, p["key"]) in (("structure", "kind"), ("structure", "block")):
        return False
    if table in ("material", "joints"):
        return f"{table}.{p['key']}" in used or (p["key"] == "types" and p["from"] == "deck")
    return bool(p["from"] != "default")


def _without_keys(text: str, keys: set[str]) -> str:
    """A sentence with the keys of the deck in words: "contact tolerance" for contact_tolerance."""
    return re.sub(r"`?([a-z]+(?:_[a-z]+)+)`?", lambda found: found[1].replace("_", " ") if found[1] in keys else found[0], text)


def _defaults(deck: dict[str, Any], words: Language) -> list[Block]:
    """Properties of the building that the deck leaves at their defaults."""
    rows = [p for p in deck.get("properties", []) if p["from"] == "default" and p["table"] != "motion"]
    return [Heading(words("Properties at their defaults")), _properties(rows, words)] if rows else []


def label_of(words: Language, table: str, key: str) -> str:
    """A key of the deck in words: "compressive strength"; "spans 2: clear span" for a key within another table."""
    parts = []
    for part in table.split(".")[1:]:
        name, _, number = part.partition(" ")
        parts.append(f"{words(name.replace('_', ' '))} {number}".strip())
    label = (LABELS.get(key) if words.code == "en" else None) or words(key.replace("_", " "))
    return words.pair(" ".join(parts), label) if parts else label


def _properties(rows: list[dict[str, Any]], words: Language) -> Table:
    """Label, value and origin of each; in English also what it means."""

    def value(p: dict[str, Any]) -> str:
        v = p["value"]
        if isinstance(v, float) or (isinstance(v, int) and not isinstance(v, bool)):
            return words.quantity(float(v), p["unit"], given=True)
        if isinstance(v, list) and v and all(isinstance(x, float) for x in v):
            return "; ".join(words.quantity(x, p["unit"], given=True) for x in v[:MOST_SHOWN])
        return words(str(v).replace("-", " ")) if isinstance(v, str) and p["key"] != "file" else cell(v)

    english = words.code == "en"
    told = [
        (label_of(words, p["table"], p["key"]), value(p), *((p["about"].replace("`", ""),) if english else ()), words(p["from"]))
        for p in rows
    ]
    head = _heads(words, "property", "value", *(("meaning",) if english else ()), "from")
    return Table(head, told, (1.8, 1.4, 3.6, 0.7) if english else (2.6, 2.4, 1.0))


def _hazard(run: Stored, deck: dict[str, Any], words: Language) -> list[Block]:
    rows = [p for p in deck.get("properties", []) if p["table"] == "motion"]
    if not rows:
        return []
    found: list[Block] = [Heading(words("Hazard")), *(Words(text, "", _foreign(words)) for text in deck.get("conditions", []))]
    for a in run.analyses:
        if a["kind"] == "assess" and a["results"]:
            h = run.results_of(a["name"], Assess).hazard
            text = (
                f"{h.told[:1].upper()}{h.told[1:]}. Static strategies use the constant acceleration "
                f"{h.peak_ground_acceleration_g:.3g} g, {h.peak_told}."
            )
            if h.pulse_amplitude_g is not None and h.pulse_period_s is not None:
                text += f" The primary impulse is a sine with an amplitude of {h.pulse_amplitude_g:.3g} g and a period of {h.pulse_period_s:.3g} s."
            found.append(Words(text, lang=_foreign(words)))
    return [*found, _properties(rows, words)]


def _analysis(run: Stored, a: dict[str, Any], figures: Figures, words: Language) -> list[Block]:
    """One analysis: its answer, warnings, figures, forces and stresses."""
    how = next(
        (run.results_of(b["name"], Assess).parts.get(a["name"], "") for b in run.analyses if b["kind"] == "assess" and b["results"]), ""
    ).partition(": ")[2]
    foreign = _foreign(words)
    deck = run.summary["deck"]
    keys = {p["key"] for p in deck.get("properties", [])}
    folder = f"{Path(deck['path']).parent}/"
    found: list[Block] = [Heading(title_of(words, a["name"], a["kind"]))]
    if how:
        found.append(Words(f"{words.pair(words('Settings'), how)}."))
    if a["status"] != "ok":
        found.append(Words(f"{a['status']}: {a['reason']}", "bad", foreign))
    if a["answer"] and a["kind"] != "assess":
        found.append(Words(_engineering(a["answer"]), "answer", foreign))
    warnings = [w.replace(folder, "") + ("" if w.endswith((".", "!", "?")) else ".") for w in a["warnings"]]
    found += [Words(words.pair(words("Warning"), _without_keys(w, keys)), "warn", foreign) for w in warnings]
    found += [Figure(f"figures/{name}", caption) for name, caption in figures]
    found += _stresses(run, a, words)
    found += [table for kind, name, table in _own_tables(run, words) if name == a["name"]]
    return found


def _engineering(answer: str) -> str:
    """A sentence of an analysis with pressures in MPa: 8e+06 Pa is 8 MPa."""
    answer = answer.replace("kg/m^3", "kg/m³")
    return re.sub(r"\b(\d[\d.]*e\+0*[4-9]|\d{5,}(?:\.\d+)?) Pa\b", lambda found: f"{float(found[1]) / 1e6:.3g} MPa", answer)


def _stresses(run: Stored, a: dict[str, Any], words: Language) -> list[Block]:
    """Forces beside stresses: the joints of greatest compression, by the part of them that the force presses evenly."""
    there = run.arrays.get(a["name"], {})
    state = next((s for s in ("central", "collapse", "least") if f"{s}_point" in there and "joint_p" in there), "")
    if not state or "joint_name" not in there:
        return []
    point, p, q = (run.array(a["name"], name) for name in (f"{state}_point", "joint_p", "joint_q"))
    if f"{state}_normal" in there:
        normal = run.array(a["name"], f"{state}_normal")
    elif "envelope_normal" in there and np.isfinite(capacity := run.array(a["name"], "capacity")).any():
        normal = run.array(a["name"], "envelope_normal")[int(np.nanargmin(capacity))]
    else:
        return []
    depth = (run.summary["deck"].get("drawing") or {}).get("depth_m")
    if depth is None or normal.ndim != 1 or len(normal) != len(p) or len(point) != len(p):
        return []
    names, rows = run.array(a["name"], "joint_name"), []
    edges = np.minimum(np.hypot(*(point - p).T), np.hypot(*(point - q).T))
    for j in np.argsort(-np.nan_to_num(normal / np.maximum(edges, EDGE)))[:MOST_JOINTS]:
        edge = float(edges[j])
        if not normal[j] > 0.0 or not np.isfinite(edge):
            continue
        stress = words("hinge") if edge < EDGE else words.quantity(float(normal[j]) / (2.0 * edge * depth), "Pa")
        name = names[j].decode() if isinstance(names[j], bytes) else str(names[j])
        place = f"{words.number(0.5 * float(p[j, 0] + q[j, 0]))}; {words.number(0.5 * float(p[j, 1] + q[j, 1]))}"
        long = float(np.hypot(*(q[j] - p[j])))
        rows.append(
            (
                joint_of(words, name),
                place,
                words.quantity(long, "m"),
                words.quantity(float(normal[j]), "N"),
                "< 1 mm" if edge < EDGE else words.quantity(edge, "m"),
                stress,
            )
        )
    if not rows:
        return []
    head = _heads(words, "joint", "x; y [m]", "length", "compression", "distance to the edge", "mean stress")
    said = {"central": "of the most central thrust line", "collapse": "at collapse", "least": "of the least thrust"}[state]
    return [
        Heading(f"{words('Forces and stresses')} {words(said)}", 2),
        Words(
            words(
                "The joints with the greatest stress. Mean stress: compressive force / (2 x distance of the force from "
                "the nearer edge x depth)."
            )
        ),
        Table(head, rows, (2.0, 1.2, 0.9, 1.1, 1.2, 1.1)),
    ]


def _factors(run: Stored, deck: dict[str, Any], words: Language) -> list[Block]:
    """Partial and confidence factors of all analyses, and a remark where all are 1."""
    rows, values = [], []
    for a, keys in zip(run.analyses, deck["resolved"].get("analysis", []), strict=False):
        title, r = title_of(words, a["name"], a["kind"]), run[a["name"]]
        for key, label in FACTORS.items():
            if isinstance(found := (keys.get("factors") or {}).get(key), int | float):
                rows.append((title, words(label), words.given(float(found))))
                values.append(float(found))
        for key, label in SERVICE.items():
            if isinstance(found := (keys.get("serviceability") or {}).get(key), int | float):
                rows.append((title, words(label), words.given(float(found))))
        for label, found in (
            ("confidence factor", getattr(r, "confidence_factor", None)),
            ("confidence factor", getattr(getattr(r, "verification", None), "confidence_factor", None)),
            ("behaviour factor", getattr(r, "behaviour_factor", None)),
        ):
            if isinstance(found, int | float):
                rows.append((title, words(label), words.given(float(found))))
                values.append(float(found))
    remark = words(
        "All partial factors are 1: loads and strengths are characteristic values. The result includes no safety margin of a code."
    )
    told: list[Block] = [Heading(words("Partial and confidence factors"))]
    if rows:
        told.append(Table(_heads(words, "analysis", "factor", "value"), rows, (2.4, 2.4, 1.0)))
    if all(value == 1.0 for value in values):
        told.append(Words(remark, "warn"))
    return told


def _assumed(run: Stored, words: Language) -> list[Block]:
    """Of each analysis the properties that its result rests on."""
    found: list[Block] = []
    for a in run.analyses:
        rows = [
            (
                label_of(words, k.rpartition(".")[0], k.rpartition(".")[2]),
                words.quantity(float(s["value"]), s["unit"], given=True) if isinstance(s["value"], int | float) else cell(s["value"]),
                words(s["from"]) + (f", {words('some differ')}" if s["exceptions"] else ""),
            )
            for k, s in a["assumptions"].items()
        ]
        if rows:
            found += [
                Heading(title_of(words, a["name"], a["kind"]), 2),
                Table(_heads(words, "property", "value", "from"), rows, (2.6, 1.6, 1.2)),
            ]
    return [Heading(words("Properties that each result depends on")), *found] if found else []


def _own_tables(run: Stored, words: Language) -> list[tuple[str, str, Table]]:
    """Results that are told as open tables beside their answer: the checks of codes."""
    found = []
    for a in run.analyses:
        r = run[a["name"]]
        checks = getattr(r, "checks", None)
        if isinstance(checks, dict):
            rows = [
                (
                    n,
                    _value(words, c.demand, c.unit),
                    _value(words, c.capacity, c.unit),
                    words(c.verdict) if c.verdict else "",
                    f"{f'Not applicable: {c.reason}. ' if c.reason else ''}{c.source}{f'. {c.note}' if c.note else ''}. For: {c.scope}",
                )
                for n, c in checks.items()
            ]
            found.append(
                (
                    "checks",
                    a["name"],
                    Table(_heads(words, "check", "demand", "capacity", "verdict", "clause"), rows, (1.8, 1.0, 1.0, 0.8, 3.6)),
                )
            )
        if walls := getattr(r, "walls", None) if a["kind"] == "local-mechanism" else None:
            head = _heads(words, "wall", "rotates about the foot of storey", "alpha_0", "a_0*", "d_0*", "margin")
            tried = [
                (
                    w.wall,
                    str(w.storey),
                    words.number(w.multiplier),
                    words.quantity(w.activation_acceleration_g, "g"),
                    words("none") if w.zero_displacement_m is None else words.quantity(w.zero_displacement_m, "m"),
                    _value(words, w.margin, ""),
                )
                for w in walls
            ]
            found.append(("walls", a["name"], Table(head, tried, (1.8, 1.6, 1.0, 1.0, 1.0, 1.0))))
    return found


def _limits(run: Stored, words: Language) -> list[Block]:
    """Assumptions and limits of each kind of analysis."""
    seen = dict.fromkeys(a["kind"] for a in run.analyses)
    rows = [(title_of(words, kind, kind), words(valid.assumes), words(valid.limits)) for kind in seen if (valid := validity_of(kind))]
    if not rows:
        return []
    return [
        Heading(words("Limits of validity")),
        Table(_heads(words, "analysis", "assumptions", "limits of validity"), rows, (1.3, 2.6, 3.6)),
    ]


def _bibliography(run: Stored, deck: dict[str, Any], words: Language) -> list[Block]:
    """Standards with their clauses, and the publications of the methods."""
    used = {key for a in run.analyses for key in a["assumptions"]}
    sources = [p["source"] for p in deck.get("properties", []) if p["source"] and (p["table"] == "motion" or _counts(p, used))]
    for a in run.analyses:
        checks = getattr(run[a["name"]], "checks", None)
        sources += [clause_of(c.source) for c in checks.values() if c.source] if isinstance(checks, dict) else []
        if (verified := getattr(run[a["name"]], "verification", None)) is not None:
            sources += sorted({f"{verified.code}: {c.clause.replace('; ', ', ')}" for c in verified.checks})
    trains = [keys["train"] for keys in deck["resolved"].get("analysis", []) if isinstance(keys.get("train"), str)]
    found = references([a["kind"] for a in run.analyses], sources, trains)
    return [Heading(words("Bibliography")), *(Words(one) for one in found)] if found else []


def _numbers(run: Stored, hidden: set[str], words: Language) -> list[Block]:
    found: list[Block] = [Heading(words("All numbers"))]
    for a in run.analyses:
        rows = [
            (k, v, unit, about)
            for k, v, unit, about in numbers(run[a["name"]])
            if not (a["name"] in hidden and (k.startswith("checks.") or k == "walls"))
        ]
        if a["kind"] == "assess":
            rows = [
                row for row in rows if row[0].split(".")[0] in ("overall", "hazard", "least_margin", "least_margin_strategy", "budget_s")
            ]
        if rows:
            found += [Heading(a["name"], 2), Table(_heads(words, "key", "value", "unit", "meaning"), rows, (2.2, 1.8, 0.7, 3.2))]
    return found if len(found) > 1 else []


def _repeat(run: Stored, deck: dict[str, Any], made: dict[str, Any], words: Language) -> list[Block]:
    lines = [f"extrados run {deck['path'] or 'deck.toml'}"]
    parts = [n for b in run.analyses if b["kind"] == "assess" and b["results"] for n in run.results_of(b["name"], Assess).parts]
    lines += [(f"extrados run {n}.toml        # the deck is in the folder assess: copy it beside the original deck first") for n in parts]
    files = run.summary.get("files", {})
    sums = [
        (name, files[name]) for name in (STORE, *sorted(n for n in files if n.endswith(".csv") or n.startswith("assess/"))) if name in files
    ]
    settings = {k: v for k, v in deck["resolved"].items() if isinstance(v, dict) and k not in ("structure", "material", "joints", "motion")}
    settings |= {a["name"]: keys for a, keys in zip(run.analyses, deck["resolved"].get("analysis", []), strict=False)}
    found: list[Block] = [
        Heading(words("To repeat it")),
        Code("\n".join(lines)),
        Table(
            (),
            [
                ("version", f"{made['version']} {made['commit']}"),
                ("compiler", made["compiler"]),
                ("deck", f"{deck['path']}, sha256 {deck['sha256']}"),
            ],
            (1.0, 5.0),
        ),
        Words(words("Checksums (sha256) of the files in the folder of this report, from {file}:", file=SUMMARY)),
        Table(("file", "sha256"), sums, (1.6, 5.0)),
    ]
    rows = flat(settings)
    if rows:
        found += [
            Heading(words("Settings of the analyses, with their defaults, in SI units"), 2),
            Table(("key", "value"), rows, (2.4, 4.0)),
        ]
    return found


def numbers(results: ResultModel, prefix: str = "") -> list[tuple[str, str, str, str]]:
    """Key, value, unit and meaning of all results."""
    rows = []
    for name, field in type(results).model_fields.items():
        if name not in results.model_fields_set:
            continue
        told, value = fact_of(prefix + (field.alias or name), field), getattr(results, name)
        if isinstance(value, ResultModel):
            rows += numbers(value, f"{told.key}.")
        elif isinstance(value, dict) and any(isinstance(v, ResultModel) for v in value.values()):
            for key, inner in value.items():
                rows += numbers(inner, f"{told.key}.{key}.")
        else:
            rows.append((told.key, cell(value), told.unit, told.about))
    return rows


def flat(values: dict[str, Any], prefix: str = "") -> list[tuple[str, str]]:
    """Keys, dotted, and values of tables."""
    rows = []
    for key, value in values.items():
        if isinstance(value, dict):
            rows += flat(value, f"{prefix}{key}.")
        else:
            rows.append((prefix + key, cell(value)))
    return [row for row in rows if row[1] not in ("", "none")]


def cell(value: Any, nothing: str = "none") -> str:
    """A value as a table shows it; long lists by their first values."""
    if isinstance(value, float):
        return f"{value:.5g}" if value == value else nothing
    if isinstance(value, list) and value and isinstance(value[0], dict | ResultModel):
        shown = " | ".join(cell(v) for v in value[:MOST_ROWS])
        return shown + (f" | ... ({len(value)})" if len(value) > MOST_ROWS else "")
    if isinstance(value, list):
        shown = ", ".join(cell(v) for v in value[:MOST_SHOWN])
        return shown + (f", ... ({len(value)})" if len(value) > MOST_SHOWN else "")
    if isinstance(value, dict | ResultModel):
        return "; ".join(f"{k} {cell(v)}" for k, v in value.items())
    return nothing if value is None else str(value)
