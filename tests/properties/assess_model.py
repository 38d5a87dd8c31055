"""Random rows, verdicts and results for the models of assess."""

import re

import numpy as np
from hypothesis import HealthCheck, Phase, settings
from hypothesis import strategies as st

from extrados.analyses.assess import strategies
from extrados.analyses.assess.conclusion import conclude
from extrados.analyses.assess.work import Work
from extrados.analyses.context import Context
from extrados.decks.reader import make_deck
from extrados.results.assess import Assess, Reason, StrategyVerdict
from extrados.results.codes import Check
from extrados.results.model import Result
from extrados.results.verdict import Verdict
from trials import count_of

QUICK = settings(
    max_examples=count_of(500, 200),
    database=None,
    deadline=None,
    derandomize=True,
    suppress_health_check=list(HealthCheck),
    phases=(Phase.explicit, Phase.generate, Phase.shrink),
)


OUTCOMES = ("stands", "collapses", "cannot-stand", "open", "not-applicable")


BOUNDS = st.sampled_from([None, "exact", "upper", "lower"])


FACTORS = st.integers(1, 80).map(lambda k: k / 20.0)


NAMES = [s.name for s in strategies.ALL]


@st.composite
def rows(draw: st.DrawFn) -> StrategyVerdict:
    """A row of the table: one that was asked with any verdict, or one without a result."""
    strategy = strategies.of(draw(st.sampled_from(NAMES)))
    status = draw(st.sampled_from(["ok", "ok", "ok", "refused", "failed", "left out"]))
    outcome = draw(st.sampled_from(OUTCOMES)) if status == "ok" else "not-applicable"
    margin = low = high = None
    if outcome in ("stands", "collapses", "open") and draw(st.booleans()):
        above = 1.0 if outcome == "stands" else 0.0 if outcome == "collapses" else draw(st.sampled_from([0.0, 1.0]))
        margin = round(above + draw(st.integers(1, 19)) / 20.0 * (3.0 if above else 1.0), 4)
        if draw(st.booleans()):
            margin, low, high = None, margin, round(margin + 0.1, 4)
    elif outcome == "cannot-stand":
        margin = 0.0
    return StrategyVerdict(
        strategy=strategy.name,
        label=strategy.label,
        part=None,
        status=status,
        reason="" if status == "ok" else "no wish",
        axis=strategy.axis,
        demand=0.2 if status == "ok" else None,
        capacity=draw(FACTORS) if status == "ok" else None,
        unit="g",
        outcome=outcome,
        bound=None,
        violated=[],
        margin=margin,
        margin_at_least=low,
        margin_below=high,
        parameters="",
        assumes="",
        statement=f"The verdict of {strategy.label}.",
    )


TABLES = st.lists(rows(), max_size=9, unique_by=lambda row: row.strategy)


DECK = make_deck(
    {
        "structure": {"kind": "arch", "radius": 5.0, "thickness": 0.8, "embrace": 150.0, "voussoirs": 9},
        "motion": {"kind": "sine-pulse", "amplitude": "0.2 g", "period": 0.4},
        "analysis": [{"kind": "assess"}],
    }
)


CONTEXT = Context(DECK, 1)


def concluded(table: list[StrategyVerdict], results: dict[str, Result] | None = None) -> Assess:
    """What an assessment makes of rows, and results, that it did not ask for."""
    work = Work(CONTEXT, DECK.analyses[0])
    work.rows, work.results = {row.strategy: row for row in table}, results or {}
    result = Result("assess")
    conclude(work, result)
    assert not work.not_done, work.not_done  # a rule that fails is a fault, though the others go on
    return result.results


@st.composite
def checks(draw: st.DrawFn) -> dict[str, Check]:
    """Rules of codes, some of them alternatives, some without a demand or beyond their scope."""
    names = draw(
        st.lists(
            st.sampled_from(["NTC linear", "NTC activation", "NTC", "slenderness", "overturning", "q"]), min_size=1, max_size=6, unique=True
        )
    )
    found = {}
    for name in names:
        capacity, demand = draw(FACTORS), draw(st.none() | FACTORS)
        code = draw(st.sampled_from(["NTC 2018", "NTC 2018", "ASCE 41", "EN 1998-1", ""]))
        verdict = "" if demand is None else "holds" if capacity > demand else "fails"
        found[name] = Check(
            capacity=capacity,
            demand=demand,
            unit=draw(st.sampled_from(["g", "m"])),
            verdict=draw(st.sampled_from([verdict] * 4 + ["not-applicable"])),
            source="",
            note="",
            code=code,
            quantity="",
            limit_state="",
            scope="",
            alternative=draw(st.sampled_from(["", "SLV"])),
            reason="",
        )
    return found


def stated(found: Reason) -> None:
    """Each number in the text of a reason is one of its numbers, as it is or in percent, or the size of a perturbation."""
    given = [v * factor for v in found.numbers.values() if v is not None for factor in (1.0, 100.0)]
    for word in re.findall(r"(?<![\w.^])\d+(?:\.\d+)?(?:e[+-]?\d+)?(?= (?:%|g\b|m\b|Pa\b|rad\b)|\.\d*$|$)", found.text):
        value = float(word)
        must = any(abs(value - v) <= 0.5 * 10.0 ** np.floor(np.log10(max(abs(v), 1e-9))) / 10.0 + 1e-9 for v in given)
        assert must, f"{found.rule}: {word} in its text, not among {found.numbers}: {found.text}"


def decided(verdict: Verdict, outcome: str, violated: list[str]) -> None:
    """An outcome that no violated condition stands beside."""
    want = "open" if violated and outcome in ("stands", "collapses") else outcome
    assert (verdict.outcome, verdict.violated) == (want, violated) and all(text in verdict.statement for text in violated)
