"""What the report of a run says, in order: the answer, the building, the hazard, every strategy, its limits, and how to
repeat it. From stored results only."""

import re
from pathlib import Path
from typing import Any

from extrados.results.assess import Assess
from extrados.results.codes import Checked
from extrados.results.explain import fact_of
from extrados.results.fields import ResultModel
from extrados.results.store import STORE, SUMMARY, Stored
from extrados.results.strengthen import size_told
from extrados.results.validity import validity_of
from extrados.results.verdict import OUTCOMES, outcome_words
from extrados.show.document import Block, Code, Document, Figure, Heading, Table, Words
from extrados.show.opening import governing_figure, opening

Figures = list[tuple[str, str]]
#: Values of a list that are shown, and rows of a list of tables
MOST_SHOWN, MOST_ROWS = 12, 4


def told(run: Stored, drawn: dict[str, Figures], building: tuple[str, str] | None, day: str) -> Document:
    """The whole report; drawn: figures with captions by analysis; building: its drawing; day: of the results."""
    deck, made = run.summary["deck"], run.summary["extrados"]
    title = heading(deck)
    facts = [("Building", kind)] if (kind := kind_of(deck)) else []
    facts += [(label, deck[key]) for label, key in (("Project", "project"), ("Author", "author")) if deck.get(key)]
    facts += [
        ("Date", deck.get("date") or day),
        ("Deck", f"{deck['path'] or 'from Python'} (sha256 {deck['sha256'][:16]})"),
    ]
    facts += [("Made by", f"extrados {made['version']} {made['commit']}".strip())]
    if code := _code_of(run):
        facts.insert(len(facts) - 3, ("Code", code))
    first = governing_figure(run, drawn, building)
    blocks: list[Block] = []
    if deck.get("note"):
        blocks.append(Words(_flowing(deck["note"])))
    blocks += _verdicts(run)
    blocks += _building(
        deck, building if building is None or first is None or first.name != f"figures/{building[0]}" else None
    )
    blocks += _hazard(run, deck)
    hidden = {name for _, name, _ in _own_tables(run)}
    whole = any(a["kind"] == "assess" and a["results"] for a in run.analyses)
    parts: list[Block] = []  # of an assessment: the strategies one by one, which paper does not hold
    for a in run.analyses:
        figures = [f for f in drawn.get(a["name"], []) if first is None or first.name != f"figures/{f[0]}"]
        where = parts if whole and a["kind"] != "assess" else blocks
        where += _analysis(run, a, figures)
    blocks += _limits(run)
    annex = [*parts, *_defaults(deck), *_numbers(run, hidden), *_repeat(run, deck, made)]
    foot = f"{title}. extrados {made['version']} {made['commit']}, deck {deck['sha256'][:16]}"
    return Document(title, facts, blocks, foot, opening(run, drawn, building), annex)


def _code_of(run: Stored) -> str:
    """The code of the report, where an analysis applies one."""
    return next((r.code for a in run.analyses if isinstance(r := run[a["name"]], Checked) and r.code), "")


def heading(deck: dict[str, Any]) -> str:
    """The title of a deck, else the name of its file."""
    return str(deck.get("title") or Path(deck["path"]).stem or "extrados run")


def kind_of(deck: dict[str, Any]) -> str:
    """The kind of structure in words, "" of a deck without one."""
    structure = deck["resolved"].get("structure") or {}
    return str(structure.get("kind", "")).replace("-", " ")


def _flowing(text: str) -> str:
    """A note of a deck without the ends of its lines, which are those of the file; an empty line parts paragraphs."""
    return "\n".join(" ".join(part.split()) for part in re.split(r"\n\s*\n", text))


def _verdicts(run: Stored) -> list[Block]:
    found: list[Block] = [Heading("Answer")]
    for a in run.analyses:
        if a["kind"] == "assess" and a["results"]:
            found += _assessed(run, a["name"])
            return found
    rows = []
    for a in run.analyses:
        v = a["verdict"]
        if v:
            rows.append(
                (
                    a["name"],
                    outcome_words(v["outcome"], isinstance(run[a["name"]], Checked)),
                    cell(v["demand"]),
                    cell(v["capacity"]),
                    v["unit"],
                    cell(v["ratio"]),
                    v["statement"],
                )
            )
        else:
            rows.append((a["name"], a["status"], "", "", "", "", a["reason"]))
    head = ("analysis", "verdict", "demand", "capacity", "unit", "ratio", "in words")
    return [*found, Table(head, rows, (1.3, 0.9, 0.8, 0.8, 0.7, 0.7, 3.6))]


def _assessed(run: Stored, name: str) -> list[Block]:
    """The overall answer of an assessment: its table, its reasons."""
    r = run[name]
    rows = []
    for v in r.verdicts:
        factor = v.margin_told("")
        if v.status == "ok":
            rows.append(
                (v.label, v.verdict_words, cell(v.demand, ""), cell(v.capacity, ""), v.unit, factor, v.statement)
            )
        else:
            rows.append((v.label, v.status, "", "", "", "", v.reason))
    found: list[Block] = [Words(r.statement, "answer")]
    found.append(
        Table(
            ("strategy", "verdict", "demand", "capacity", "unit", "margin", "in words"),
            rows,
            (1.5, 0.9, 0.8, 0.85, 0.9, 0.9, 3.6),
        )
    )
    found.append(
        Words(
            "The margin is the critical scale factor of the hazard: below 1 the strategy gives collapse under the hazard itself."
        )
    )
    found.append(Words(f"{r.collapse_probability.statement} {r.collapse_probability.method}"))
    found += _advice(r)
    if r.reasons:
        found.append(Heading("Why they differ", 2))
        labels = {v.strategy: v.label for v in r.verdicts}
        pairs = [
            (one.rule, one.text, "; ".join(f"{labels[a]} and {labels[b]}" for a, b in one.explains))
            for one in r.reasons
        ]
        found.append(Table(("rule", "reason, with the numbers that show it", "explains"), pairs, (1.2, 4.6, 2.4)))
    if r.unexplained:
        labels = {v.strategy: v.label for v in r.verdicts}
        text = "; ".join(f"{labels[a]} and {labels[b]}" for a, b in r.unexplained)
        found.append(Words(f"No rule has found a reason why these differ: {text}.", "bad"))
    if r.sensitivity:
        found.append(Heading("Sensitivity of the verdicts", 2))
        rows = [
            (m.key, f"{cell(m.base)} {m.unit}".strip(), f"{m.low:.4g} to {m.high:.4g}", _both(m.tilt_low, m.tilt_high), cell(m.tilt_turns, ""),
             _both(m.rocking_low, m.rocking_high), cell(m.rocking_turns, ""))
            for m in r.sensitivity if m.dem_base is None
        ]  # fmt: skip
        head = (
            "key",
            "value",
            "varied",
            "margin of limit analysis",
            "verdict changes at",
            "margin of rocking",
            "verdict changes at",
        )
        found.append(Table(head, rows, (2.2, 1.1, 1.3, 1.3, 0.9, 1.3, 0.9)))
        shaken = [
            (m.key, f"{cell(m.base)} {m.unit}", f"{m.low:.3g} to {m.high:.3g}", cell(m.dem_base), _both(m.dem_low, m.dem_high), cell(m.dem_turns, ""))
            for m in r.sensitivity if m.dem_base is not None
        ]  # fmt: skip
        if shaken:
            found.append(
                Words(
                    "Values that only discrete elements consider: displacement of their blocks over that of collapse."
                )
            )
            head = ("key", "value", "moved", "at the value", "varied", "turns at")
            found.append(Table(head, shaken, (2.2, 1.2, 1.6, 1.0, 1.6, 1.0)))
    if r.probes:
        found.append(Heading("Further runs", 2))
        rows = [(p.strategy, p.changed, OUTCOMES[p.outcome], cell(p.value, "")) for p in r.probes]
        found.append(
            Table(
                ("analysis", "difference from the deck", "verdict", "demand over capacity"), rows, (1.2, 4.0, 1.0, 1.2)
            )
        )
    if r.not_done:
        found.append(Words("Not done, or not decided: " + "; ".join(r.not_done) + ".", "warn"))
    return found


def _advice(r: Assess) -> list[Block]:
    """What to do: the interventions of an assessment side by side."""
    if r.advice is None:
        return []
    rows = [
        (one.name, size_told(one) if one.meets_target else one.reason, cell(one.capacity_after, ""), one.next_mechanism,
         r.advice.rocking.get(one.name, ""))
        for one in r.advice.interventions
    ]  # fmt: skip
    head = ("intervention", "least size", "capacity after [g]", "then governs", "rocking under the hazard")
    return [Heading("Strengthening", 2), Words(r.advice.statement), Table(head, rows, (1.4, 2.4, 0.8, 3.2, 1.2))]


def _both(low: float | None, high: float | None) -> str:
    return f"{cell(low, '?')} to {cell(high, '?')}" if low is not None or high is not None else ""


def _building(deck: dict[str, Any], drawing: tuple[str, str] | None) -> list[Block]:
    properties = deck.get("properties", [])
    given = any(p["from"] != "default" and p["table"] != "motion" for p in properties)
    found: list[Block] = [Heading("Building")] if given or drawing else []
    if drawing:
        found.append(Figure(f"figures/{drawing[0]}", drawing[1], 0.65))
    if deck.get("dimensions"):
        found.append(
            Table(
                ("dimension", "length [m]"),
                [(d["name"], f"{d['length_m']:.4g}") for d in deck["dimensions"]],
                (3.0, 1.0),
            )
        )
    for heading, tables in (
        ("Geometry as the deck gives it", ("structure",)), ("Materials and joints", ("material", "materials", "joints")),
        ("Supports, ties and the state at the start", ("supports", "ties", "dampers", "hinges", "initial")),
        ("Code and site", ("code",)),
    ):  # fmt: skip
        rows = [p for p in properties if p["table"].split(".")[0] in tables and p["from"] != "default"]
        if rows:
            found += [Heading(heading, 2), _properties(rows)]
    return found


def _defaults(deck: dict[str, Any]) -> list[Block]:
    """Properties of the building that the deck leaves at their defaults."""
    rows = [p for p in deck.get("properties", []) if p["from"] == "default" and p["table"] != "motion"]
    return [Heading("Properties at their defaults"), _properties(rows)] if rows else []


def _properties(rows: list[dict[str, Any]]) -> Table:
    told = [
        (f"{p['table']}.{p['key']}", cell(p["value"]), p["unit"] if isinstance(p["value"], int | float) else "",
         f"{p['about']}{f' ({p_source})' if (p_source := p['source']) else ''}", p["from"])
        for p in rows
    ]  # fmt: skip
    return Table(
        ("key", "value", "unit", "meaning, and the source of its rule", "from"), told, (1.7, 1.6, 0.7, 3.6, 0.7)
    )


def _hazard(run: Stored, deck: dict[str, Any]) -> list[Block]:
    rows = [p for p in deck.get("properties", []) if p["table"] == "motion"]
    if not rows:
        return []
    found: list[Block] = [Heading("Hazard"), *(Words(text) for text in deck.get("conditions", []))]
    for a in run.analyses:
        if a["kind"] == "assess" and a["results"]:
            h = run[a["name"]].hazard
            text = f"{h.told[:1].upper()}{h.told[1:]}. Strategies of a constant acceleration take {h.peak_ground_acceleration_g:.3g} g, {h.peak_told}."
            if h.pulse_amplitude_g is not None and h.pulse_period_s is not None:
                text += f" The primary impulse has {h.pulse_amplitude_g:.3g} g over {h.pulse_period_s:.3g} s."
            found.append(Words(text))
    return [*found, _properties(rows)]


def _analysis(run: Stored, a: dict[str, Any], figures: Figures) -> list[Block]:
    words = next(
        (run[b["name"]].parts.get(a["name"], "") for b in run.analyses if b["kind"] == "assess" and b["results"]), ""
    )
    valid = validity_of(a["kind"])
    assumes = valid.assumes if valid else ""
    label, _, how = words.partition(": ")
    named = (
        f"{label[:1].upper()}{label[1:]}" + (f" ({a['name']})" if label != a["name"] else "") if label else a["name"]
    )
    heading = "Comparison of the strategies" if a["kind"] == "assess" else named
    found: list[Block] = [Heading(heading)]
    if how:
        found.append(Words(f"Settings: {how}."))
    if assumes:
        found.append(Words(f"Assumptions: {assumes}"))
    if a["status"] != "ok":
        found.append(Words(f"{a['status']}: {a['reason']}", "bad"))
    if a["answer"] and a["kind"] != "assess":
        found.append(Words(a["answer"], "answer"))
    found += [Words(f"Warning: {w}", "warn") for w in a["warnings"]]
    found += [Figure(f"figures/{name}", caption) for name, caption in figures]
    found += [table for kind, name, table in _own_tables(run) if name == a["name"]]
    if a["assumptions"]:
        rows = [
            (k, cell(s["value"]), s["unit"], s["from"] + (", some differ" if s["exceptions"] else ""))
            for k, s in a["assumptions"].items()
        ]
        found += [
            Heading("Assumptions of the building", 2),
            Table(("key", "value", "unit", "from"), rows, (2.6, 1.6, 1.0, 1.2)),
        ]
    return found


def _own_tables(run: Stored) -> list[tuple[str, str, Table]]:
    """Results that are told as open tables beside their answer: the checks of codes."""
    found = []
    for a in run.analyses:
        r = run[a["name"]]
        checks = getattr(r, "checks", None)
        if isinstance(checks, dict):
            rows = [
                (
                    n,
                    cell(c.demand, ""),
                    cell(c.capacity, ""),
                    c.unit,
                    c.verdict,
                    f"{f'Not applicable: {c.reason}. ' if c.reason else ''}{c.source}{f'. {c.note}' if c.note else ''}. For: {c.scope}",
                )
                for n, c in checks.items()
            ]
            found.append(
                (
                    "checks",
                    a["name"],
                    Table(("check", "demand", "capacity", "unit", "", "clause"), rows, (1.8, 0.8, 0.8, 0.6, 0.7, 3.6)),
                )
            )
        if walls := getattr(r, "walls", None) if a["kind"] == "local-mechanism" else None:
            head = ("wall", "turns at the foot of storey", "alpha_0", "a_0* [g]", "d_0* [m]", "margin")
            rows = [
                (w.wall, str(w.storey), f"{w.multiplier:.4g}", f"{w.activation_acceleration_g:.4g}",
                 "none" if w.zero_displacement_m is None else f"{w.zero_displacement_m:.3g}", "" if w.margin is None else f"{w.margin:.3g}")
                for w in walls
            ]  # fmt: skip
            found.append(("walls", a["name"], Table(head, rows, (1.8, 1.6, 1.0, 1.0, 1.0, 1.0))))
    return found


def _limits(run: Stored) -> list[Block]:
    seen = dict.fromkeys(a["kind"] for a in run.analyses)
    rows = [(kind, valid.limits) for kind in seen if (valid := validity_of(kind))]
    return [Heading("Limits of validity"), Table(("analysis", "limits of validity"), rows, (1.2, 5.0))] if rows else []


def _numbers(run: Stored, hidden: set[str]) -> list[Block]:
    found: list[Block] = [Heading("All numbers")]
    for a in run.analyses:
        rows = [
            (k, v, unit, about)
            for k, v, unit, about in numbers(run[a["name"]])
            if not (a["name"] in hidden and (k.startswith("checks.") or k == "walls"))
        ]
        if a["kind"] == "assess":
            rows = [
                row
                for row in rows
                if row[0].split(".")[0] in ("overall", "hazard", "least_margin", "least_margin_strategy", "budget_s")
            ]
        if rows:
            found += [Heading(a["name"], 2), Table(("key", "value", "unit", "meaning"), rows, (2.2, 1.8, 0.7, 3.2))]
    return found if len(found) > 1 else []


def _repeat(run: Stored, deck: dict[str, Any], made: dict[str, Any]) -> list[Block]:
    lines = [f"extrados run {deck['path'] or 'deck.toml'}"]
    parts = [n for b in run.analyses if b["kind"] == "assess" and b["results"] for n in run[b["name"]].parts]
    lines += [f"extrados run {n}.toml        # of assess/, put beside the deck" for n in parts]
    files = run.summary.get("files", {})
    sums = [
        (name, files[name])
        for name in (STORE, *sorted(n for n in files if n.endswith(".csv") or n.startswith("assess/")))
        if name in files
    ]
    settings = {
        k: v
        for k, v in deck["resolved"].items()
        if isinstance(v, dict) and k not in ("structure", "material", "joints", "motion")
    }
    settings |= {a["name"]: keys for a, keys in zip(run.analyses, deck["resolved"].get("analysis", []), strict=False)}
    found: list[Block] = [
        Heading("To repeat it"), Code("\n".join(lines)),
        Table((), [("version", f"{made['version']} {made['commit']}"), ("compiler", made["compiler"]), ("deck", f"{deck['path']}, sha256 {deck['sha256']}")], (1.0, 5.0)),
        Words(f"Checksums (sha256) of the files beside this report, as {SUMMARY} holds them:"),
        Table(("file", "sha256"), sums, (1.6, 5.0)),
    ]  # fmt: skip
    rows = flat(settings)
    if rows:
        found += [
            Heading("Settings of the analyses, with their defaults, in SI", 2),
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
